"""Terms that the difference of two rates may be made of, the likely ones first.

First the terms of the rate itself: as they are printed, then multiplied out; then those with one slip in
the place of the right ones; then terms of other rates, which are too much.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from eom.checker.code.fits import Fit
from eom.system import Expr, System

MAX_TERMS = 60
MAX_SLIPS = 600


@dataclass(frozen=True)
class Candidate:
    """A term whose multiple the difference may be.

    ``own``: a term of the rate; ``right``: the term in whose place a wrong one stands, if it is that.
    """

    expression: Expr
    own: bool = False
    right: Expr | None = None
    wrong: Expr | None = None

    def accepts(self, fit: Fit) -> bool:
        """Whether a factor makes sense: a term that stands for another one does so once."""
        return self.right is None or fit.words == "1"

    def told(self, fit: Fit) -> tuple[str, str]:
        """Return the kind of a slip and its words, for the factor of the difference."""
        if self.right is not None:
            return "wrong term", f"{self.wrong} instead of {self.right}"
        if not self.own:
            times = "" if fit.words == "1" else f"{fit.words} times "
            return "term too much", f"term too much: {times}{self.expression}"
        if fit.words == "-1":
            return "missing term", f"missing term {self.expression}"
        if fit.words == "-2":
            return "wrong sign", f"wrong sign of term {self.expression}"
        return "wrong factor", f"term {self.expression} is {_more(fit)} times what it should be"


def _more(fit: Fit) -> str:
    try:
        return str(Fraction(fit.words) + 1)
    except ValueError:
        return f"1 + {fit.words}"


def candidates(system: System, i: int) -> Iterator[Candidate]:
    """Yield what may be too much or missing in a rate, each expression once."""
    own = terms(system, system.rates[i])
    others = [t for k, r in enumerate(system.rates) if k != i for t in terms(system, r)]
    yield from (Candidate(t, own=True) for t in own)
    made = (c for t in own for c in _slips(system, t))
    yield from (c for _, c in zip(range(MAX_SLIPS), made, strict=False))
    yield from (Candidate(t) for t in dict.fromkeys(others) if t not in own)


def terms(system: System, rate: Expr) -> list[Expr]:
    """Return the terms of a rate: as it stands, multiplied out, and with definitions written out."""
    forms = (
        _distributed(rate),
        sp.expand(rate),
        _distributed(system.expand(rate)),
        sp.expand(system.expand(rate)),
    )
    found = [t for form in forms for t in sp.Add.make_args(form)]
    return [t for t in dict.fromkeys(found) if not t.is_number][:MAX_TERMS]


def _distributed(rate: Expr) -> Expr:
    """Divide every term of a numerator by the denominator, and nothing more."""
    above, below = sp.fraction(rate)
    return sp.Add(*(t / below for t in sp.Add.make_args(above)))


def _slips(system: System, term: Expr) -> Iterator[Candidate]:
    """Yield what the difference is if a term has one slip."""
    for wrong in dict.fromkeys(_changed(system, term)):
        if wrong != term and not wrong.has(sp.zoo, sp.nan):
            yield Candidate(wrong - term, right=term, wrong=wrong)


def _changed(system: System, term: Expr) -> Iterator[Expr]:
    """Yield a term with one symbol for another, one function for another, or another power."""
    variables = (*system.states, *system.parameters, *system.inputs)
    units = {q.symbol: q.unit for q in (*variables, *(d.quantity for d in system.definitions))}
    places = sorted(term.free_symbols & units.keys(), key=str)
    for a in places:
        for b, unit in units.items():
            if a != b and units[a] == unit:
                yield from _with_exchanged(term, a, b)
        yield term * a
        yield term / a
    for f in sorted(term.atoms(sp.sin, sp.cos), key=sp.default_sort_key):
        other = sp.cos if f.func is sp.sin else sp.sin
        yield term.subs(f, other(*f.args))
        yield term.subs(f, f.args[0])
        yield term / f


def _with_exchanged(term: Expr, a: Expr, b: Expr) -> Iterator[Expr]:
    """Yield a term with one symbol for another: everywhere, and exchanged."""
    yield term.xreplace({a: b})
    yield term.xreplace({a: b, b: a})
