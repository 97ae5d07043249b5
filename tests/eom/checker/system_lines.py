"""Lines about ready scenes and systems: their equations as LaTeX, single slips in them, and the truth.

The truth of a slip is decided by SymPy alone: the changed right side less the true one, simplified.
"""

import random

import sympy as sp

from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import verdict
from eom.checker.mean.model import load_model, printed
from eom.checker.read.documents import read_document
from eom.typeset.markup import symbol_latex


def judged(lexicon, *lines):
    """The verdicts of displayed lines."""
    document = read_document("\n\n".join(f"$${line}$$" for line in lines))
    return [verdict(u) for u in understand(document, lexicon)]


def names_of(model):
    """LaTeX of every symbol of a system; rates that are states are written as derivatives."""
    found = {}
    for name, q in model.quantities.items():
        base = name.removesuffix("_dot")
        own = rf"\dot{{{symbol_latex(base)}}}" if base != name else printed(q)
        found[q.symbol] = own
    return found


def left_side(quantity, names):
    """The time derivative of a state, as it is usually written."""
    base = quantity.name.removesuffix("_dot")
    if base != quantity.name:
        return rf"\ddot{{{symbol_latex(base)}}}"
    return rf"\dot{{{names[quantity.symbol]}}}"


def slips(expression, generator, count):
    """Yield some expressions with one slip: a sign, a factor, a term, an index, sine for cosine."""
    expression = sp.expand(expression)
    terms = sp.Add.make_args(expression)
    made = []
    for t in terms:
        rest = expression - t
        made += [("sign", t, rest - t), ("factor", t, rest + 2 * t), ("half", t, rest + t / 2)]
        if len(terms) > 1:
            made.append(("dropped", t, rest))
        made.append(("sine", t, rest + t.replace(sp.sin, sp.cos)))
        symbols = sorted(t.free_symbols, key=str)
        for a in symbols:
            for b in symbols:
                if a != b and a.name[:-1] == b.name[:-1]:
                    made.append(("index", t, rest + t.xreplace({a: b})))
    made = [m for m in made if m[2] != expression]
    return generator.sample(made, min(count, len(made)))


def is_same(model, expression, other):
    """Whether two expressions are equal as functions, what is given of the parameters put in."""
    equal = {b: a for r in model.given for a, b in r.equal}
    difference = model.system.expand(expression - other).xreplace(equal)
    if difference == 0:
        return True
    point = {
        s: sp.Rational(random.Random(str(s)).randint(10, 99), 100) for s in difference.free_symbols
    }
    return abs(difference.evalf(30, subs=point)) < 1e-20


__all__ = ["is_same", "judged", "left_side", "load_model", "names_of", "slips"]
