"""A line as an equation between members that are sums: its terms, and what they count.

The terms of both sides add up to the residual; a term with a slip in it changes the residual by itself,
whatever the others do. So slips in several terms are found by adding the numbers that they have in a model.

What a note writes with: symbols, labels and marks that may have been meant at a place of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from eom.checker.judge.inequalities import ORDERS
from eom.checker.judge.judge import models_of
from eom.checker.judge.models import Models
from eom.checker.judge.notes import Understood
from eom.checker.mean.claims import CONSTANT, DEFINITION, EQUALITIES, STATEMENT, Claim, without_root
from eom.checker.mean.dimensions import Dimension
from eom.checker.mean.elaborate import RULES
from eom.checker.mean.elaborator import Elaborator
from eom.checker.mean.lexicon import AXES, Lexicon
from eom.checker.mean.values import Refusal, Value, mixed, overdot
from eom.checker.read.grammar import read_formula
from eom.checker.read.paths import Path, at, find, operands
from eom.checker.read.statements import Statement, says_constant, single_statements
from eom.checker.read.symbol_shape import DOTS, Labels, labels, seen
from eom.checker.read.syntax import (
    Accent,
    Addition,
    BigOperator,
    Boxed,
    Call,
    Derivative,
    Differential,
    Group,
    Integral,
    Marks,
    Node,
    Number,
    Product,
    Quotient,
    Scripts,
    Symbol,
    children,
    walk,
)
from eom.errors import InputError
from eom.terms.terms import COLUMN, INDICES, VECTOR, zero
from eom.worlds.worlds import SEQUENCES

Signature = tuple[str, int, Dimension | None]
"""Shape, density and dimension: what may be added has the same."""

_SYMBOLS = (Symbol, Scripts, Accent)


@dataclass(frozen=True)
class Remembering(Elaborator):
    """An elaborator that works out every node once; trees that differ in one place share all others.

    Symbols are known again wherever they stand.
    """

    worked: dict[tuple[object, ...], tuple[Node, Value | Refusal]] = field(
        default_factory=dict, repr=False
    )

    def value(self, node: Node) -> Value:
        """Return the typed value of a node. Raises `Refusal`."""
        known = node if isinstance(node, _SYMBOLS) else id(node)
        key = (known, self.depth, tuple(self.indices.items()))
        if key not in self.worked:
            try:
                self.worked[key] = (node, super().value(node))
            except Refusal as refusal:
                self.worked[key] = (node, refusal)
        found = self.worked[key][1]
        if isinstance(found, Refusal):
            raise found
        return found


@dataclass(frozen=True)
class Addend:
    """A term of a member: its sign, its place within the member, and whether a sum holds it."""

    member: int
    sign: int
    node: Node
    path: Path = ()
    summed: bool = False


@dataclass(frozen=True)
class Member:
    """A member: its place in the tree of the formula, or the value of one that stands elsewhere."""

    number: int
    addends: tuple[Addend, ...] = ()
    path: Path | None = None
    value: Value | None = None


@dataclass(frozen=True)
class Line:
    """The members of a wrong claim; ``claim`` and its number among those of the formula."""

    tree: Node
    members: tuple[Member, ...]
    claim: Claim
    number: int
    elaborator: Elaborator

    def models(self, given: Iterable[str] = ()) -> Models:
        """Return models in which terms that were made of this line have values as well."""
        return models_of(self.claim, given, self.elaborator.scalars)


def line(understood: Understood, claim: Claim) -> Line | None:
    """Return the line of a claim, or None where it is no chain that can be edited."""
    reading = understood.formula.reading
    if reading is None or claim.kind not in {STATEMENT, DEFINITION, CONSTANT}:
        return None
    statement = statement_of(understood, claim)
    if statement is None or not {s.name for s in statement.signs} <= EQUALITIES | ORDERS:
        return None
    number = next(k for k, c in enumerate(understood.claims) if c is claim)
    members = tuple(_members(reading.tree, statement, claim))
    if len(members) < 2 or all(m.path is None for m in members):
        return None
    known = understood.around.definitions
    e = Remembering(understood.lexicon, RULES, known, claim.indices, dict(claim.scalars))
    notation = understood.lexicon.notation
    members = tuple(
        m if m.value is None else replace(m, value=mixed(notation, m.value)) for m in members
    )
    return Line(reading.tree, members, claim, number, e)


def statement_of(understood: Understood, claim: Claim) -> Statement | None:
    """Return the statement that a claim was made from: the one that stands where it stands."""
    parts = [p for s in understood.formula.statements for p in (*(c for _, c in s.conditions), s)]
    singles = [one for part in parts for one in single_statements(part) if one.span == claim.span]
    same = [c for c in understood.claims if c.span == claim.span]
    k = next((k for k, c in enumerate(same) if c is claim), 0)
    return singles[min(k, len(singles) - 1)] if singles else None


def _members(tree: Node, statement: Statement, claim: Claim) -> Iterator[Member]:
    if claim.kind == CONSTANT:
        yield from _steady(tree, statement, claim)
        return
    for k, node in enumerate(statement.members):
        if k == 0 and claim.kind == DEFINITION:
            continue
        if k == 0 and statement.continues:
            if claim.members:
                yield Member(0, value=claim.members[0])
            continue
        path = find(tree, node)
        yield Member(k, tuple(_addends(node, k)), path)


def _steady(tree: Node, statement: Statement, claim: Claim) -> Iterator[Member]:
    """Yield what is said to be constant, whose terms count by their rates, and zero."""
    named = says_constant(statement.members[-1])
    node = statement.members[-2 if named else -1]
    yield Member(0, tuple(_addends(node, 0)), find(tree, node))
    yield Member(1, value=replace(claim.members[0], term=zero(claim.members[0].term.kind)))


def _addends(node: Node, member: int, path: Path = ()) -> Iterator[Addend]:
    if isinstance(node, Boxed) or (isinstance(node, Group) and node.open == ""):
        yield from _addends(node.body, member, (*path, ("body", ())))
    elif isinstance(node, Addition) and set(node.signs) <= {"", "+", "-"}:
        for k, (sign, term) in enumerate(zip(node.signs, node.terms, strict=True)):
            yield Addend(member, -1 if sign == "-" else 1, term, (*path, ("terms", (k,))), True)
    else:
        yield Addend(member, 1, node, path)


# -- values --------------------------------------------------------------------------------------


def valued(e: Elaborator, node: Node) -> Value | None:
    """Return the value of a node as it is compared, or None where it has none."""
    try:
        return mixed(e.lexicon.notation, e.value(node))
    except Refusal:
        return None


def worth(line: Line, node: Node) -> Value | None:
    """Return what a term counts in a line: its value; in one that something is constant, its rate."""
    value = valued(line.elaborator, node)
    if value is None or line.claim.kind != CONSTANT:
        return value
    alone = sum(len(m.addends) for m in line.members) == 1
    notation = line.elaborator.lexicon.notation
    try:
        return mixed(
            notation, overdot(notation, without_root(value) if alone else value, 1, node.span)
        )
    except Refusal:
        return None


def signature(value: Value) -> Signature | None:
    """Return shape, density and dimension; None for a zero, which fits everywhere."""
    if value.is_zero:
        return None
    return value.shape, value.density, value.dimension


def alike(value: Value | None, new: Value | None) -> bool:
    """Return whether two values are written by the same term."""
    return value is not None and new is not None and value.term == new.term


def agrees(own: Signature | None, kind: Signature) -> bool:
    """Return whether what has one signature may stand beside what has another."""
    if own is None:
        return True
    same = own[:2] == kind[:2]
    return same and (own[2] is None or kind[2] is None or own[2] == kind[2])


PENALTIES: dict[str, float] = {
    "constant_mass": 0.1,
    "newton_2": 0.1,
    "third_law_weak": 0.1,
    "third_law_strong": 0.1,
    "rigid": 0.15,
    "body_frame": 0.15,
    "one_particle": 0.3,
    "about_centre": 0.35,
    "O_fixed_in_body": 0.4,
    "O_fixed_in_space": 0.5,
    "C_at_rest": 0.5,
    "spin_312": 0.1,
    **dict.fromkeys(SEQUENCES, 0.1),
    "rotors": 0.1,
    "viscous_slug": 0.1,
    "principal_axes": 0.4,
    "A_fixed_in_body": 0.6,
    "OA_at_centre": 0.6,
    "no_torque_2": 0.6,
    "no_torque_3": 0.6,
}
UNUSUAL = 1.5
"""What an assumption weighs that is not in the table."""


def penalty(names: Iterable[str], stated: frozenset[str]) -> float:
    """Return what assumptions weigh that the note has not stated."""
    return sum(PENALTIES.get(n, UNUSUAL) for n in names if n not in stated)


# -- what a note writes with -----------------------------------------------------------------------


SYMBOLS = 48
"""Symbols of the note that are tried at most."""
NEAR, VECTORS = 10, 5
"""Factors around a line, and vectors, that are tried as lost ones at most."""


def palette(understood: Understood, line: Line) -> Palette:
    """Return what may have been meant in a line."""
    lexicon = understood.lexicon
    written = list(_written(understood))
    trees = [*written, *_entries(understood)]
    known = list(dict.fromkeys(n for t in trees for n in symbols(t)))
    own = [at(line.tree, m.path) for m in line.members if m.path is not None]
    factors = list(dict.fromkeys(f for t in own for f in _factors(t)))
    akin = (n for k in written[:1] for s in symbols(k) for n in _akin(s))
    quantities = tuple(dict.fromkeys(n for n in (*akin, *known) if _is_quantity(n)))[:SYMBOLS]
    return Palette(
        symbols=quantities,
        quantities={n: meant(lexicon, n) for n in quantities},
        written=frozenset(n for t in written for n in symbols(t)),
        factors=tuple(factors)[:12],
        near=tuple(n for n in quantities if n not in factors)[:NEAR],
        vectors=tuple(n for n in quantities if _shape(line, n) in {VECTOR, COLUMN})[:VECTORS],
        omegas=tuple(n for n in known if is_omega(lexicon, n))[:3],
        labels=tuple(_rows(lexicon, trees)),
        frames=tuple(_frames(lexicon, trees)),
        marks=_marks(lexicon, trees),
        skew=lexicon.notation.skew,
    )


def around(understood: Understood) -> Iterator[Node]:
    """Yield the trees of a note, the closest first, the line's own before all, then of its lexicon."""
    yield from _written(understood)
    yield from _entries(understood)


def _written(understood: Understood) -> Iterator[Node]:
    around = understood.around
    if understood.formula.reading is not None:
        yield understood.formula.reading.tree
    numbered = sorted(enumerate(around.trees), key=lambda kt: (abs(kt[0] - around.number), kt[0]))
    yield from (t for _, t in numbered[:40])


def _entries(understood: Understood) -> Iterator[Node]:
    for layer in understood.lexicon.layers:
        for entry in layer:
            if not entry.slots:
                try:
                    yield read_formula(entry.latex).tree
                except InputError:
                    continue


def symbols(tree: Node) -> Iterator[Node]:
    """Yield symbols with their accents and scripts, the outermost alone."""
    stack = [tree]
    while stack:
        node = stack.pop()
        if seen(node) is not None:
            yield node
        else:
            bound = isinstance(node, Scripts | Derivative | Integral | BigOperator | Differential)
            below = _inside(node) if bound else children(node)
            stack += reversed(below)


def _akin(node: Node) -> Iterator[Node]:
    """Yield a symbol, itself without dots, and the other components of both."""
    bare = node.base if isinstance(node, Accent) and node.mark in DOTS else node
    if isinstance(node, Scripts) and isinstance(node.base, Accent) and node.base.mark in DOTS:
        bare = replace(node, base=node.base.base)
    for one in dict.fromkeys((node, bare)):
        yield one
        if isinstance(one, Scripts) and isinstance(one.sub, Number) and one.sub.text in AXES:
            yield from (replace(one, sub=replace(one.sub, text=k)) for k in "123")


def _inside(node: Node) -> tuple[Node, ...]:
    return tuple(n for _, n in operands(node))


def _is_quantity(node: Node) -> bool:
    given = seen(node)
    return given is not None and given.look.name.isalpha() and not isinstance(node, Group)


def _shape(line: Line, node: Node) -> str:
    """Return the shape of a symbol, "" where it has no value."""
    value = valued(line.elaborator, node)
    return "" if value is None else value.shape


def meant(lexicon: Lexicon, node: Node) -> str:
    """Return the quantity that a symbol without dots stands for as a whole, "" where that is not known."""
    given = seen(node)
    for look in (given.with_label(), given.look) if given is not None and not given.dots else ():
        found = lexicon.find(look) if look is not None else None
        if found is not None:
            return "" if found.meaning.component else found.meaning.quantity
    return ""


def is_omega(lexicon: Lexicon, node: Node) -> bool:
    """Return whether a symbol is an angular velocity as a vector, without dots."""
    return meant(lexicon, node) == "angular_velocity"


def _factors(tree: Node) -> Iterator[Node]:
    """Yield what stands as a factor: symbols, numbers apart, functions, derivatives, brackets."""
    for node in walk(tree):
        if isinstance(node, Product | Quotient):
            parts = node.factors if isinstance(node, Product) else (node.left, node.right)
            yield from (p for p in parts if _is_factor(p))
    yield from (n for n in symbols(tree) if _is_quantity(n))


def _is_factor(node: Node) -> bool:
    return (_is_quantity(node) or isinstance(node, Call | Group | Derivative)) and not isinstance(
        node, Number
    )


def _marks(lexicon: Lexicon, trees: Iterable[Node]) -> tuple[str, ...]:
    """Return the raised marks of derivatives that the note uses."""
    used = {m for t in trees for n in walk(t) if isinstance(n, Marks) for m in n.names}
    return tuple(m for m in lexicon.notation.marks if m in used)


# -- labels --------------------------------------------------------------------------------------


def _rows(lexicon: Lexicon, trees: Iterable[Node]) -> Iterator[tuple[Node, ...]]:
    """Yield the labels of scripts that the note uses, those of one kind together."""
    found = dict.fromkeys(n for t in trees for n in leaves(t))
    indices = {(name,): name for name in INDICES - {"dm"}}
    axes = {(name,): name for name in set(AXES) - {"1", "2", "3"}}
    for names in (lexicon.points, lexicon.frames, indices, axes):
        row = tuple(n for n in found if labels(n) in names)
        if len(row) > 1:
            yield row


def leaves(tree: Node) -> Iterator[Node]:
    """Yield the scripts of a tree, and the symbols in them."""
    for node in walk(tree):
        if isinstance(node, Scripts):
            scripts = (node.sub, node.sup, node.presub, node.presup)
            for script in (s for s in scripts if s is not None):
                yield script
                yield from (n for n in walk(script) if isinstance(n, Symbol))


def _frames(lexicon: Lexicon, trees: list[Node]) -> list[Node]:
    """Return a label for each frame, as the note writes it: of derivatives first."""
    written = [n.frame for t in trees for n in walk(t) if isinstance(n, Derivative) and n.frame]
    written += [n for t in trees for n in leaves(t)]
    return list(_named(lexicon.frames, written).values())[:4]


def _named(frames: Mapping[Labels, str], written: Iterable[Node]) -> dict[str, Node]:
    found: dict[str, Node] = {}
    for node in written:
        name = frames.get(labels(node))
        if name is not None:
            found.setdefault(name, node)
    for given, name in frames.items():
        if name not in found and len(given) == 1 and given[0].isalpha():
            found[name] = Symbol(given[0])
    return found


Offer = tuple[Node, float]
"""What may have been meant, and what is added to the weight of the slip."""


@dataclass(frozen=True)
class Palette:
    """What a note writes with: symbols and labels that may have been meant, the closest first.

    ``quantities``: what they stand for; ``written``: those that stand in the note itself; ``marks``:
    raised marks that are derivatives;
    ``skew``: accents of skew matrices; ``labels``: rows of labels that may stand for each other (points,
    frames, axes, indices); ``frames``: of derivatives; ``factors``: of the line itself; ``near``: others
    that stand around it; ``vectors``: of the line and around it; ``omegas``: angular velocities.
    """

    symbols: tuple[Node, ...] = ()
    quantities: Mapping[Node, str] = field(default_factory=dict)
    written: frozenset[Node] = frozenset()
    factors: tuple[Node, ...] = ()
    near: tuple[Node, ...] = ()
    vectors: tuple[Node, ...] = ()
    omegas: tuple[Node, ...] = ()
    labels: tuple[tuple[Node, ...], ...] = ()
    frames: tuple[Node, ...] = ()
    marks: tuple[str, ...] = ()
    skew: tuple[str, ...] = ()


# -- labels ----------------------------------------------------------------------------------------


def relabelled(script: Node, palette: Palette) -> Iterator[Node]:
    """Yield scripts with one label exchanged."""
    if isinstance(script, Number) and script.text.isdigit():
        yield from (replace(script, text=text) for text in _digits(script.text))
    for row in palette.labels:
        if script in row:
            yield from (other for other in row if other != script)
    if isinstance(script, Product | Quotient):
        parts = script.factors if isinstance(script, Product) else (script.left, script.right)
        for k, part in enumerate(parts):
            others = (n for n in relabelled(part, palette) if n not in parts)
            yield from (_reparted(script, (*parts[:k], n, *parts[k + 1 :])) for n in others)
        if len(parts) == 2:
            yield _reparted(script, (parts[1], parts[0]))


def _digits(text: str) -> Iterator[str]:
    """Yield numbers of axes with one digit exchanged, and two digits the other way round."""
    for k, digit in enumerate(text):
        others = (o for o in "123" if digit in "123" and o != digit)
        yield from (text[:k] + o + text[k + 1 :] for o in others)
    if len(text) == 2:
        yield text[::-1]


def _reparted(script: Node, parts: tuple[Node, ...]) -> Node:
    if isinstance(script, Quotient):
        return replace(script, left=parts[0], right=parts[1])
    return Product(parts, span=script.span)
