r"""Relations between free scalars: masses, sizes, integrals of solids, new symbols by their first equation.

A letter without an entry in the lexicon is a free scalar where the note has named it alone in a sentence
("of radius $a$"), or where it has a word as its label (``I_{\text{cyl}}``). A chain of such scalars is
no statement about a body in general; `eom.checker.judge.scalars` judges it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.checker.mean.calculus import called
from eom.checker.mean.claims import EQUALITIES, STATEMENT, Claim, Parameters, Relation, claims
from eom.checker.mean.instants import timely
from eom.checker.mean.lexicon import Entry, Lexicon, Meaning
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import Group, Integral, Node, Scripts, Symbol, Words, children, walk
from eom.terms.terms import Term, nodes

Expr = Any

_PLAIN = frozenset({"expr", "atom", "add", "mul", "dot", "inner", "matmul", "column", "entries"})


# -- reading -----------------------------------------------------------------------------------------


def named(trees: Iterable[Node]) -> frozenset[Look]:
    """Return the looks of letters that stand alone in formulas of a note."""
    found = (seen(t) for t in trees)
    return frozenset(g.look for g in found if g is not None and not g.raised and not g.dots)


def read(
    statement: Statement,
    lexicon: Lexicon,
    introduced: Collection[Look],
    relations: tuple[Relation, ...],
    *,
    defining: bool = False,
) -> tuple[Claim, ...] | None:
    """Return a statement as claims between free scalars; None where it is none."""
    if not statement.relational or statement.conditions or statement.continues:
        return None
    if any(map(called, statement.members)):
        return None
    known = {str(r.symbol) for r in relations}
    left = seen(statement.members[0]) if defining else None
    introduced = {*introduced, *([left.look] if left is not None else [])}
    looks, fresh = _free(statement.members, lexicon, introduced, known)
    found = claims(statement, _with(lexicon, looks))
    made = []
    for claim in found:
        own = _parameters(claim, statement.members, relations, fresh)
        if own is None:
            return None
        made.append(replace(claim, parameters=replace(own, defining=defining), model=None))
    return tuple(made) or None


def _free(
    members: Iterable[Node],
    lexicon: Lexicon,
    introduced: Collection[Look],
    known: Collection[str],
) -> tuple[dict[Look, None], set[Look]]:
    """Return the letters that the lexicon does not know and that are free, and those with a word below."""
    looks: dict[Look, None] = {}
    fresh: set[Look] = set()
    for node in _letters(members):
        given = seen(node)
        if given is None or given.dots or given.look.style or given.look.accents:
            continue
        whole = given.with_label()
        if any(lexicon.find(g) is not None for g in (given.look, whole) if g is not None):
            continue
        worded = _worded(node)
        if worded or given.look in introduced or given.look.text in known:
            looks[given.look] = None
            fresh |= {given.look} if worded else set()
    return looks, fresh


def _letters(members: Iterable[Node]) -> Iterator[Node]:
    stack = list(members)
    while stack:
        node = stack.pop()
        if seen(node) is not None:
            yield node
        else:
            stack += children(node)


def _worded(node: Node) -> bool:
    r"""Return whether the label below a letter is a word in upright letters: I_{\text{cyl}}."""
    below = [n.sub for n in walk(node) if isinstance(n, Scripts) and n.sub is not None]
    inside = [s.body if isinstance(s, Group) and s.open == "" else s for s in below]
    return any(
        (isinstance(s, Words) and len(s.text.strip()) > 1)
        or (isinstance(s, Symbol) and s.style == "roman" and len(s.name) > 1)
        for s in inside
    )


def _with(lexicon: Lexicon, looks: Iterable[Look]) -> Lexicon:
    """Return the lexicon that knows letters as free scalars, after everything else."""
    layer = tuple(Entry(look, Meaning("scalar", (look.text,)), look.text) for look in looks)
    return replace(lexicon, layers=(*lexicon.layers, layer))


def limited(statement: Statement) -> bool:
    """Return whether a statement has an integral with limits over a coordinate."""
    found = (n for m in statement.members for n in walk(m) if isinstance(n, Integral))
    return any(n.upper is not None and not timely(n) for n in found)


def _parameters(
    claim: Claim, members: tuple[Node, ...], relations: tuple[Relation, ...], fresh: Iterable[Look]
) -> Parameters | None:
    """Return what a claim between free scalars is made of; None if it is about anything else."""
    if claim.kind != STATEMENT or claim.findings or not EQUALITIES.issuperset(claim.relations):
        return None
    terms = [*(m.term for m in claim.members), *claim.scalars.values()]
    plain = all(n.head in _PLAIN for t in terms for n in nodes(t))
    if not plain or any(m.shape != "scalar" or m.density for m in claim.members):
        return None
    inside = [[n for n in walk(m) if isinstance(n, Integral)] for m in members]
    if any(n.upper is None for found in inside for n in found):
        return None
    looks = [seen(v) for found in inside for n in found for v in n.variables]
    names = {g.look.name for g in looks if g is not None}
    shown = [
        {x.name for x in walk(n.integrand) if isinstance(x, Symbol)} if n.integrand else names
        for found in inside
        for n in found
    ]
    own = frozenset(_symbol(Term("atom", (), ("scalar", f.text))) for f in fresh)
    return Parameters(
        relations,
        tuple(g.look.text for g in looks if g is not None),
        frozenset(m.span for m, found in zip(claim.members, inside, strict=False) if found),
        own,
        any(not letters & names for letters in shown),
    )


# -- expressions -------------------------------------------------------------------------------------


def _symbol(term: Term) -> Expr:
    """Return the one symbol for a scalar in all claims; parameters are positive."""
    atom = term.head == "atom" and term.data[0] == "scalar"
    return sp.Symbol(str(term.data[1]) if atom else repr(term), positive=True)


def _expression(term: Term, scalars: Mapping[Any, Term]) -> Expr:
    """Return a scalar as an expression in symbols that all claims share."""
    if term.head == "expr":
        free = term.data[0].free_symbols
        own = {s: _symbol(scalars[s]) for s in free if s in scalars}
        return term.data[0].xreplace(own)
    if term.head in {"add", "mul"} and all(a.kind == "scalar" for a in term.args):
        join = sp.Add if term.head == "add" else sp.Mul
        return join(*(_expression(a, scalars) for a in term.args))
    return _symbol(term)


def expressions(claim: Claim) -> tuple[Expr, ...]:
    """Return the members of a claim between free scalars."""
    return tuple(_expression(m.term, claim.scalars) for m in claim.members)
