"""From the tree of a formula to its statements: chains of typed values with their relations.

A formula holds several: rows, items beside each other, the sides of an implication, labels of braces.
A chain that begins with its relation continues one of the formula before. What cannot be elaborated
leaves a finding with its place; the rest of the formula is judged all the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from eom.check.elaborate import elaborator
from eom.check.elaborator import Elaborator
from eom.check.lexicon import Lexicon
from eom.check.looks import Look, labels, seen
from eom.check.places import NOWHERE, Span
from eom.check.syntax import (
    Boxed,
    Braced,
    Cases,
    Group,
    Implication,
    Matrix,
    Missing,
    Node,
    Relation,
    Rows,
    Sequence,
    Symbol,
    Words,
)
from eom.check.trees import walk
from eom.check.values import UNDECIDED, Finding, Refusal, Value, rate, refuse, same
from eom.terms import Term
from eom.vocabulary import position

EQUALITIES = frozenset({"=", ":=", "=:", "equiv"})
COMPARISONS = frozenset({"<", ">", "<=", ">=", "!=", "<<", ">>", "approx", "simeq"})
STATEMENT, DEFINITION, CONSTANT, SAME_POINT = "statement", "definition", "constant", "same point"


@dataclass(frozen=True)
class Claim:
    """A chain: ``members`` joined by ``relations``.

    ``kind``: "statement"; "definition": the first member is new, its look is ``defines``;
    "constant": the only member does not change; "same point": the member, a position, is zero.
    ``side``: of an implication, "if" or "then"; ``words``: what stands before it in the formula;
    ``continues``: the first member is that of the formula before; ``scalars``: what the symbols of
    SymPy stand for.
    """

    members: tuple[Value, ...]
    relations: tuple[str, ...]
    kind: str = STATEMENT
    side: str = ""
    words: str = ""
    defines: Look | None = None
    continues: bool = False
    scalars: Mapping[Any, Term] = field(default_factory=dict)
    span: Span = NOWHERE


@dataclass(frozen=True)
class Elaborated:
    """What a formula states: claims, findings, words beside them, and definitions up to its end.

    ``findings`` are of chains that have no claim; ``equation`` tells whether there is any relation.
    """

    claims: tuple[Claim, ...] = ()
    findings: tuple[Finding, ...] = ()
    remarks: tuple[str, ...] = ()
    definitions: Mapping[Look, Value] = field(default_factory=dict)
    equation: bool = False


@dataclass(frozen=True)
class _Chain:
    """A relation with what stands about it."""

    tree: Relation
    side: str = ""
    words: str = ""


def elaborate(
    tree: Node,
    lexicon: Lexicon,
    definitions: Mapping[Look, Value] | None = None,
    before: tuple[Claim, ...] = (),
) -> Elaborated:
    """Return the statements of a formula at a place of a note.

    ``lexicon``: what holds there; ``definitions``: what the note has defined above; ``before``: the
    claims of the formula before, which a leading sign of equality continues.
    """
    known = dict(definitions or {})
    claims: list[Claim] = []
    findings: list[Finding] = []
    remarks: list[str] = []
    equation = False
    for item in _items(tree, "", remarks):
        equation = True
        try:
            found = _claims(item, elaborator(lexicon, known), (*before, *claims))
        except Refusal as refusal:
            findings.append(refusal.finding)
            continue
        claims += found
        for claim in found:
            if claim.kind == DEFINITION and claim.defines is not None:
                known[claim.defines] = claim.members[1]
    return Elaborated(tuple(claims), tuple(findings), tuple(remarks), known, equation)


# -- dividing ------------------------------------------------------------------------------------


def _items(node: Node, side: str, remarks: list[str]) -> Iterator[_Chain]:
    """Yield the chains of a tree in order; words go to the chain after them."""
    if isinstance(node, Boxed) or (isinstance(node, Group) and node.open in {"", "."} and _is_statement(node.body)):
        yield from _items(node.body, side, remarks)
    elif isinstance(node, Rows):
        for row in node.rows:
            yield from _items(row, side, remarks)
    elif isinstance(node, Cases | Matrix):
        for cells in node.rows:
            for cell in cells:
                yield from _items(cell, side, remarks)
    elif isinstance(node, Implication):
        yield from _implied(node, remarks)
    elif isinstance(node, Sequence):
        yield from _beside(node, side, remarks)
    elif isinstance(node, Relation):
        yield _Chain(node, side)
        yield from _braces(node, side)
    elif isinstance(node, Words):
        remarks.append(node.text.strip())


def _is_statement(node: Node) -> bool:
    return isinstance(node, Relation | Rows | Sequence | Implication | Boxed | Cases)


def _implied(node: Implication, remarks: list[str]) -> Iterator[_Chain]:
    arrows = [s.name for s in node.signs]
    for k, item in enumerate(node.items):
        premise = k < len(arrows) and arrows[k] == "implies"
        reason = k > 0 and arrows[k - 1] in {"implied by", "because"}
        led = k > 0 and arrows[k - 1] == "implies"
        side = "if" if (premise and not led) or reason else "then" if led else ""
        yield from _items(item, side, remarks)


def _beside(node: Sequence, side: str, remarks: list[str]) -> Iterator[_Chain]:
    words = ""
    for item in node.items:
        if isinstance(item, Words):
            words = item.text.strip()
            remarks.append(words)
            continue
        for chain in _items(item, side, remarks):
            yield replace(chain, words=chain.words or words)
        words = ""


def _braces(node: Relation, side: str) -> Iterator[_Chain]:
    """Yield what labels of braces say: that what they span is the label."""
    for found in walk(node):
        if isinstance(found, Braced) and found.label is not None:
            if seen(found.label) is not None and not isinstance(found.label, Words):
                if not _is_word(found.label):
                    yield _Chain(_labelled(found), side, "brace")


def _is_word(node: Node) -> bool:
    return isinstance(node, Symbol) and node.style == "roman" and len(node.name) > 1


def _labelled(node: Braced) -> Relation:
    from eom.check.syntax import Sign

    assert node.label is not None
    return Relation((node.body, node.label), (Sign("=", span=node.span),), span=node.span)


# -- chains --------------------------------------------------------------------------------------


def _claims(chain: _Chain, e: Elaborator, before: tuple[Claim, ...]) -> list[Claim]:
    """Return what a chain says. Raises `Refusal`."""
    signs = tuple(s.name for s in chain.tree.signs)
    unknown = next((s for s in chain.tree.signs if s.name not in EQUALITIES | COMPARISONS), None)
    if unknown is not None:
        raise refuse(UNDECIDED, "a relation without a meaning", unknown.span, unknown.name)
    points = _points(chain, e)
    if points is not None:
        return [points]
    nodes = list(chain.tree.members)
    constant = _is_constant(nodes[-1])
    if constant:
        nodes.pop()
    elif isinstance(nodes[-1], Missing):
        nodes.pop()
        signs = signs[:-1]
    new = _new(nodes, signs, e)
    values = [e.value(n) for n in nodes[int(new is not None or isinstance(nodes[0], Missing)) :]]
    if new is not None:
        claims = [_definition(chain, e, new, nodes[0].span, values, signs)]
    elif isinstance(nodes[0], Missing):
        claims = [_continued(chain, e, values, signs, before)]
    else:
        relations = signs[: len(values) - 1]
        claims = [_claim(chain, e, _agreeing(e, values), relations)] if relations else []
    if constant:
        steady = rate(values[-1], e.lexicon.notation.dot, 1, chain.tree.span)
        claims.append(replace(_claim(chain, e, [steady], ()), kind=CONSTANT))
    return claims


def _claim(chain: _Chain, e: Elaborator, values: list[Value], relations: tuple[str, ...]) -> Claim:
    return Claim(
        tuple(values),
        relations,
        side=chain.side,
        words=chain.words,
        scalars=e.scalars,
        span=chain.tree.span,
    )


def _agreeing(e: Elaborator, values: list[Value]) -> list[Value]:
    """Return the members in one shape; every link is compared, and the ends.

    Raises `Refusal` at the first link whose sides are of different kinds, frames or dimensions.
    """
    notation = e.lexicon.notation
    shaped = [values[0]]
    for value in values[1:]:
        a, b = same(notation, shaped[-1], value)
        shaped[-1] = a
        shaped.append(b)
    first = next((v for v in shaped if not v.is_zero), shaped[0])
    return [same(notation, first, v)[1] for v in shaped]


def _continued(
    chain: _Chain,
    e: Elaborator,
    values: list[Value],
    signs: tuple[str, ...],
    before: tuple[Claim, ...],
) -> Claim:
    """Return a chain whose first member is that of a chain before, the last one that fits."""
    heads = [c for c in before if c.members and c.kind != SAME_POINT]
    if not heads:
        raise refuse(UNDECIDED, "a relation continues nothing", chain.tree.span)
    refusals = []
    for claim in reversed(heads):
        try:
            members = _agreeing(e, [replace(claim.members[0], span=chain.tree.span), *values])
        except Refusal as refusal:
            refusals.append(refusal)
            continue
        e.scalars.update({s: t for s, t in claim.scalars.items() if s not in e.scalars})
        return replace(_claim(chain, e, members, signs), continues=True)
    raise refusals[-1]


# -- definitions, constants, points ----------------------------------------------------------------


def _new(nodes: list[Node], signs: tuple[str, ...], e: Elaborator) -> Look | None:
    """Return the look of the left side if the chain defines it: it is free, or left to the note."""
    if not signs or signs[0] not in {"=", ":=", "equiv"} or len(nodes) < 2:
        return None
    node = nodes[0]
    inner = node.body if isinstance(node, Group) and node.open == "[" else node
    found = seen(inner)
    if found is None or found.dots:
        return None
    look = e.lexicon.notation.plain(found.with_label() or found.look)
    entry = e.lexicon.find(look, e.indices)
    if look in e.definitions:
        return None
    if entry is None:
        bare = e.lexicon.find(found.look, e.indices) if found.raised else None
        return look if signs[0] == ":=" and bare is None and not _reads(e, inner) else None
    return look if entry.meaning.quantity == "defined" else None


def _reads(e: Elaborator, node: Node) -> bool:
    try:
        e.value(node)
    except Refusal:
        return False
    return True


def _definition(
    chain: _Chain,
    e: Elaborator,
    look: Look,
    span: Span,
    values: list[Value],
    signs: tuple[str, ...],
) -> Claim:
    meaning = replace(_agreeing(e, values)[0], span=span)
    members = _agreeing(e, [meaning, *values])
    return replace(_claim(chain, e, members, signs), kind=DEFINITION, defines=look)


_CONSTANTS = ("const", "constant", "konst")


def _is_constant(node: Node) -> bool:
    text = node.text if isinstance(node, Words) else ""
    if isinstance(node, Symbol) and node.style == "roman":
        text = node.name
    return text.strip(" .()").casefold() in _CONSTANTS


def _points(chain: _Chain, e: Elaborator) -> Claim | None:
    """Return the claim that two points are the same, if both sides are points and nothing else."""
    members, signs = chain.tree.members, chain.tree.signs
    if len(members) != 2 or signs[0].name not in {"=", "equiv"}:
        return None
    names = [e.lexicon.points.get(labels(m)) for m in members]
    if None in names or any(_means(e, m) for m in members):
        return None
    term = position(str(names[0]), str(names[1]))
    value = Value(term, term.kind, span=chain.tree.span)
    return replace(_claim(chain, e, [value], ()), kind=SAME_POINT)


def _means(e: Elaborator, node: Node) -> bool:
    found = seen(node)
    return found is not None and e.lexicon.find(found.look, e.indices) is not None
