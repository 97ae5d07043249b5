r"""Relations between free scalars: masses, sizes, integrals of solids, new symbols by their first equation.

A letter without an entry in the lexicon is a free scalar where the note has named it alone in a sentence
("of radius $a$"), or where it has a word as its label (``I_{\text{cyl}}``). A chain of such scalars is
no statement about a body in general: what it says of a single letter is a relation that the note states,
and holds within the same heading; all else has to be an identity, by itself or with these relations.
Wrong is what differs by a number alone, and an integral whose value has no other letters and differs.
Whatever is neither is left open.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
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

IDENTITY, RESTS, NEW, FALSE, OPEN = "identity", "rests", "new", "false", "open"
"""What a link is: an identity, one with relations of the note, new, false, neither."""

DIGITS, POINTS = 50, 3
MAX_LEAVES = 400
_PLAIN = frozenset({"expr", "atom", "add", "mul", "dot", "inner", "matmul", "column", "entries"})


@dataclass(frozen=True)
class Link:
    """One step of a chain, and the number by which its sides differ if it is false by that alone."""

    kind: str
    factor: Expr = None


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
    """Return a statement as claims between free scalars; None where it is none, or stays open."""
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
    decided = bool(made) and all(verdict(links(c), c) for c in made)
    return tuple(made) if decided else None


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
    r"""Tell whether the label below a letter is a word in upright letters: I_{\text{cyl}}."""
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
    """Tell whether a statement has an integral with limits over a coordinate."""
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
        frozenset(k for k, found in enumerate(inside) if found),
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


def _ratio(a: Expr, b: Expr) -> list[Expr] | None:
    """Return a/b at random points with many digits; None where it has no value."""
    generator = random.Random("parameters")  # noqa: S311 - reproducible, no secret
    found = []
    free = sorted((a.free_symbols | b.free_symbols), key=str)
    if sum(1 for e in (a, b) for _ in sp.preorder_traversal(e)) > MAX_LEAVES:
        return None
    for _ in range(POINTS):
        at = {s: sp.Rational(generator.randrange(10**6, 3 * 10**6), 10**6 + 3) for s in free}
        values = [e.xreplace(at).evalf(DIGITS) for e in (a, b)]
        if not all(v.is_Float or v.is_Integer for v in values) or values[1] == 0:
            return None
        found.append(values[0] / values[1])
    return found


_SMALL = sp.Float(10) ** -30


def _agree(a: Expr, b: Expr) -> bool:
    if b == 0:
        a, b = b, a
    if a == 0:
        return bool(sp.expand(b) == 0)
    ratios = _ratio(a, b)
    return ratios is not None and all(abs(r - 1) < _SMALL for r in ratios)


def _factor(a: Expr, b: Expr) -> Expr:
    """Return the number that b has to be multiplied with to give a, None if there is no such number."""
    if 0 in (a, b):
        return None
    ratios = _ratio(a, b)
    if ratios is None or any(abs(r - ratios[0]) > _SMALL * abs(r) for r in ratios):
        return None
    return sp.nsimplify(ratios[0].evalf(30), rational=True, tolerance=sp.Float(10) ** -20)


# -- links -------------------------------------------------------------------------------------------


def links(claim: Claim) -> tuple[Link, ...]:
    """Return what each link of a chain is, and its first one that brings in a letter as new."""
    own: Parameters = claim.parameters  # type: ignore[assignment]
    members = expressions(claim)
    return tuple(
        _link(a, b, own, bool(own.integrals & {k, k + 1}))
        for k, (a, b) in enumerate(pairwise(members))
    )


def _link(a: Expr, b: Expr, own: Parameters, integral: bool) -> Link:
    if _agree(a, b):
        return Link(IDENTITY)
    known = {r.symbol: r.value for r in own.relations}
    left, right = a.xreplace(known), b.xreplace(known)
    if (left, right) != (a, b) and _agree(left, right):
        return Link(RESTS)
    lone = next((s for s in map(_lone, (a, b)) if s is not None), None)
    if lone is not None and lone not in known and lone not in a.free_symbols & b.free_symbols:
        return Link(NEW)
    if integral and own.constant:
        return Link(OPEN)
    factor = _factor(left, right)
    if factor is not None:
        return Link(FALSE, factor)
    return Link(FALSE if integral and _evaluates(left, right, own) else OPEN)


def _lone(side: Expr) -> Expr:
    """Return the symbol of which a side is a multiple, None for all else."""
    _, rest = side.as_coeff_Mul()
    return rest if rest.is_Symbol else None


def _evaluates(a: Expr, b: Expr, own: Parameters) -> bool:
    """Tell whether a link gives the value of an integral in the letters of the integral itself.

    What a relation makes to depend on the variable was no constant below the integral.
    """
    varying = {str(s) for r in own.relations for s in r.written.free_symbols}
    alike = (
        a.free_symbols == b.free_symbols
        or min(len(a.free_symbols - b.free_symbols), len(b.free_symbols - a.free_symbols)) == 0
    )
    return alike and len(a.free_symbols | b.free_symbols) > 1 and not varying & set(own.variables)


def verdict(found: tuple[Link, ...], claim: Claim) -> str:
    """Return "wrong", "holds", "holds under", "definition", or "" where nothing is decided."""
    kinds = [f.kind for f in found]
    own: Parameters = claim.parameters  # type: ignore[assignment]
    if FALSE in kinds:
        return "wrong"
    if OPEN in kinds or NEW in kinds[1:-1] or kinds.count(NEW) > 1:
        return ""
    if kinds == [NEW]:
        new = own.defining or _lone(expressions(claim)[0]) in own.fresh
        return "definition" if new else ""
    if NEW in kinds or RESTS in kinds:
        return "holds under"
    return "holds"


def reason(found: tuple[Link, ...]) -> str:
    """Return why a chain is wrong, or what it rests on."""
    false = next((f for f in found if f.kind == FALSE), None)
    if false is not None:
        if false.factor is None:
            return "the integral has another value"
        return f"the right side should be multiplied by {false.factor}"
    kinds = {f.kind for f in found}
    if NEW in kinds:
        return "what stands alone is what the note calls so"
    return "by relations that the note states above" if RESTS in kinds else ""


# -- relations of a note -----------------------------------------------------------------------------


@dataclass
class Known:
    """Relations that a note has stated so far, each within its heading."""

    found: list[tuple[tuple[str, ...], Relation]] = field(default_factory=list)

    def at(self, headings: tuple[str, ...]) -> tuple[Relation, ...]:
        """Return the relations that hold under some headings, each in scalars that have none."""
        here = [r for place, r in self.found if headings[: len(place)] == place]
        chosen: dict[Expr, Relation] = {}
        for r in here:
            values = {s: k.value for s, k in chosen.items()}
            value = r.value.xreplace(values)
            if r.symbol in values or r.symbol in value.free_symbols:
                continue
            own = {r.symbol: value}
            chosen = {s: replace(k, value=k.value.xreplace(own)) for s, k in chosen.items()}
            chosen[r.symbol] = replace(r, value=value)
        return tuple(chosen.values())

    def add(self, headings: tuple[str, ...], new: Iterable[Claim]) -> None:
        """Take in what claims say of single letters."""
        for claim in new:
            if claim.parameters is None or claim.role:
                continue
            found = links(claim)
            if FALSE in {f.kind for f in found}:
                continue
            members = expressions(claim)
            for k, link in enumerate(found):
                if link.kind == NEW:
                    self.found.append((headings, _relation(members, k)))


def _relation(members: tuple[Expr, ...], k: int) -> Relation:
    """Return what the link behind a member says of a letter; the end of the chain is its value."""
    a, b = members[k], members[k + 1]
    alone, other = (a, members[-1]) if _lone(a) is not None else (b, members[0])
    coefficient, symbol = alone.as_coeff_Mul()
    return Relation(symbol, other / coefficient, other)
