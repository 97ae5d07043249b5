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

from eom.checker.mean.claims import (
    EQUALITIES,
    PROPORTIONAL,
    STATEMENT,
    Claim,
    Parameters,
    Relation,
    claims,
)
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.elaborator import Elaborator
from eom.checker.mean.instants import timely
from eom.checker.mean.integrals import called
from eom.checker.mean.lexicon import Entry, Lexicon, Meaning
from eom.checker.mean.values import Refusal, Value
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import (
    Group,
    Integral,
    Node,
    Scripts,
    Symbol,
    Words,
    children,
    walk,
)
from eom.checker.read.syntax import Relation as Equation
from eom.errors import InputError
from eom.terms.terms import SCALAR, VECTOR, Term, expr, nodes
from eom.terms.terms import replace as rewritten

Expr = Any

_PLAIN = frozenset({"expr", "atom", "add", "mul", "dot", "inner", "matmul", "column", "entries"})


# -- laws --------------------------------------------------------------------------------------------

_MOVING, _STILL = "coordinate", "scalar"


def tied(lexicon: Lexicon) -> Mapping[tuple[str, ...], Value]:
    """Return what the laws of a lexicon make of free quantities, by these: each law is solved for one.

    What moves is solved for first, so that no constant does; a vector has to stand alone on one side.
    Raises `InputError` for laws that cannot be solved so.
    """
    e = elaborator(lexicon)
    solved: dict[Expr, Expr] = {}
    vectors: dict[Term, Value] = {}
    for there, law in ((part, law) for part, laws in lexicon.own_laws for law in laws):
        sides = _sides(replace(e, lexicon=there.without_system()), law)
        if len(sides) != 2 or {s.shape for s in sides} not in ({SCALAR}, {VECTOR}):
            raise InputError("a law is an equation of scalars or of vectors", got=law)
        if sides[0].shape == VECTOR:
            vectors = _with_vector(vectors, *_vector(sides, law))
            continue
        left, right = (e.expression(s.term) for s in sides)
        value = sp.together((left - right).xreplace(solved))
        symbol, found = _solved(sp.numer(value), e.scalars, law)
        solved = {s: x.xreplace({symbol: found}) for s, x in solved.items()} | {symbol: found}
    scalars = dict(e.scalars)
    rows = {
        (*scalars[s].data, ""): Value(expr(x), SCALAR, scalars=scalars) for s, x in solved.items()
    }
    scalars |= {s: expr(x) for s, x in solved.items()}
    return rows | {(*k.data, ""): replace(v, scalars=scalars) for k, v in vectors.items()}


def _sides(e: Elaborator, law: str) -> list[Value]:
    tree = read_formula(law).tree
    try:
        return [e.value(m) for m in tree.members] if isinstance(tree, Equation) else []
    except Refusal as refusal:
        found = refusal.finding
        raise InputError(
            "a law of the lexicon has no meaning in a part of the note where it holds",
            where=f"laws > {law}",
            got=f"{found.what}: {found.got}" if found.got else found.what,
            hint="a scope with a phrase holds to the end of the note, unless it has a heading as well",
        ) from None


def _solved(zero: Expr, scalars: Mapping[Expr, Term], law: str) -> tuple[Expr, Expr]:
    """Return a free quantity that a vanishing polynomial is linear in, and what it is then."""
    for quantity in (_MOVING, _STILL):
        for symbol in sorted(zero.free_symbols, key=str, reverse=True):
            slope = sp.diff(zero, symbol)
            free = symbol in scalars and scalars[symbol].data[:1] == (quantity,)
            if free and slope != 0 and not slope.has(symbol) and _alone(symbol, zero, scalars):
                return symbol, sp.cancel((slope * symbol - zero) / slope)
    raise InputError("no scalar or coordinate of the lexicon can be solved for in a law", got=law)


def _alone(symbol: Expr, zero: Expr, scalars: Mapping[Expr, Term]) -> bool:
    """Return whether no other symbol is a rate of one, and no constant is tied to what moves."""
    still = scalars[symbol].data[0] == _STILL
    others = [scalars[s] for s in zero.free_symbols if s in scalars and s != symbol]
    rates = [n for t in others for n in nodes(t) if n.head == "der" and n.args[0] == expr(symbol)]
    return not rates and (not still or all(t.data[:1] == (_STILL,) for t in others))


def _with_vector(known: Mapping[Term, Value], vector: Term, value: Value) -> dict[Term, Value]:
    """Return vectors with another one, each by those of which no law says what they are."""

    def swapped(other: Value, these: Mapping[Term, Value]) -> Value:
        return replace(
            other, term=rewritten(other.term, lambda n: these[n].term if n in these else n)
        )

    own = {vector: swapped(value, known)}
    return {k: swapped(v, own) for k, v in known.items()} | own


def _vector(sides: list[Value], law: str) -> tuple[Term, Value]:
    for one, other in (sides, sides[::-1]):
        if one.term.data[:1] == ("vector",) and one.term not in set(nodes(other.term)):
            return one.term, other
    raise InputError("no vector of the lexicon stands alone on one side of a law", got=law)


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
    known = EQUALITIES | {PROPORTIONAL}
    if claim.kind != STATEMENT or claim.findings or not known.issuperset(claim.relations):
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
