"""A line as an equation between members that are sums: its terms, what they are worth in a world.

The terms of both sides add up to the residual; a term with a slip in it changes the residual by itself,
whatever the others do. So slips in several terms are found by adding numbers.

Worlds in which repairs are looked for: from what derivations usually assume to special motions.

A repair that holds under some assumptions holds under more; so it is looked for where much is assumed,
and judged afterwards.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from eom.checker.judge.inequalities import ORDERS
from eom.checker.judge.judge import contexts
from eom.checker.judge.notes import Understood
from eom.checker.mean.claims import (
    CONSTANT,
    DEFINITION,
    EQUALITIES,
    STATEMENT,
    Claim,
    _is_constant,
    _single,
    _square,
)
from eom.checker.mean.dimensions import Dimension
from eom.checker.mean.elaborate import RULES
from eom.checker.mean.elaborator import Elaborator
from eom.checker.mean.values import Refusal, Value, mixed, overdot
from eom.checker.read.paths import Path, find
from eom.checker.read.statements import Statement
from eom.checker.read.syntax import Accent, Addition, Boxed, Group, Node, Scripts, Symbol
from eom.errors import InputError
from eom.exact.series import Series
from eom.fields import PRIME, Singular
from eom.terms.terms import Term, zero
from eom.worlds.evaluate import Evaluator
from eom.worlds.generators import world
from eom.worlds.worlds import SEQUENCES, closure

Signature = tuple[str, int, Dimension | None]
"""Shape, density and dimension: what may be added has the same."""

_WEIGHTS = tuple(pow(3, 1000 + 17 * k, PRIME) for k in range(64))
SYMBOLS = (Symbol, Scripts, Accent)
NUMBERINGS = 3
"""How many ways to number free indices are looked at."""


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
        known = node if isinstance(node, SYMBOLS) else id(node)
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


def line(understood: Understood, claim: Claim) -> Line | None:
    """Return the line of a claim, or None where it is no chain that can be edited."""
    reading = understood.formula.reading
    if reading is None or claim.kind not in {STATEMENT, DEFINITION, CONSTANT}:
        return None
    statement = _statement(understood, claim)
    if statement is None or not {s.name for s in statement.signs} <= EQUALITIES | ORDERS:
        return None
    number = next(k for k, c in enumerate(understood.claims) if c is claim)
    members = tuple(_members(reading.tree, statement, claim))
    if len(members) < 2 or all(m.path is None for m in members):
        return None
    scalars = dict(claim.scalars)
    e = Remembering(understood.lexicon, RULES, understood.around.definitions, scalars=scalars)
    notation = understood.lexicon.notation
    members = tuple(
        m if m.value is None else replace(m, value=mixed(notation, m.value)) for m in members
    )
    return Line(reading.tree, members, claim, number, e)


def _statement(understood: Understood, claim: Claim) -> Statement | None:
    """Return the statement that a claim was made from: the one that stands where it stands."""
    parts = [p for s in understood.formula.statements for p in (*(c for _, c in s.conditions), s)]
    singles = [one for part in parts for one in _single(part) if one.span == claim.span]
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
    named = _is_constant(statement.members[-1])
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
        return mixed(notation, overdot(notation, _square(value) if alone else value, 1, node.span))
    except Refusal:
        return None


def signature(value: Value) -> Signature | None:
    """Return shape, density and dimension; None for a zero, which fits everywhere."""
    if value.is_zero:
        return None
    return value.shape, value.density, value.dimension


def agrees(own: Signature | None, kind: Signature) -> bool:
    """Tell whether what has one signature may stand beside what has another."""
    if own is None:
        return True
    same = own[:2] == kind[:2]
    return same and (own[2] is None or kind[2] is None or own[2] == kind[2])


@dataclass
class Place(ABC):
    """Where terms are numbers: all components and numberings mixed into one, modulo a prime.

    ``names``: what is assumed there.
    """

    names: frozenset[str]
    known: dict[Term, int | None] = field(default_factory=dict, kw_only=True)

    def number(self, term: Term) -> int | None:
        """Return the number of a term, None where it has none in this world."""
        if term not in self.known:
            self.known[term] = self._number(term)
        return self.known[term]

    def _number(self, term: Term) -> int | None:
        values = self.values(term)
        if values is None:
            return None
        return sum(w * v for w, v in zip(_WEIGHTS, values, strict=False)) % PRIME

    @abstractmethod
    def values(self, term: Term) -> list[int] | None:
        """Return the components of a term at t = 0, None where it has none."""


@dataclass
class InWorld(Place):
    """A world; ``labels``: free indices of the line."""

    evaluator: Evaluator
    labels: frozenset[str]

    def values(self, term: Term) -> list[int] | None:
        """Return the components at t = 0, for each numbering of the free indices."""
        if term.is_zero:
            return [0]
        if not self.evaluator.labels(term) <= self.labels | {"dm"} and self._indices(term):
            return None
        found: list[int] = []
        try:
            for k, env in enumerate(self.evaluator.numberings(self.labels)):
                if k == NUMBERINGS:
                    break
                found += [_first(s) for s in _flat(self.evaluator.value(term, env))]
        except (InputError, Singular, KeyError):
            return None
        return found

    def _indices(self, term: Term) -> bool:
        """Whether a term has indices of its own; one that this world has nothing for has some."""
        free = self.evaluator.labels(term) - self.labels
        try:
            return bool(next(iter(self.evaluator.numberings(free)), {}))
        except InputError:
            return True


def _first(value: Series) -> int:
    if not value.coefficients:
        raise InputError("more derivatives than a world holds")
    first: int = value.coefficients[0]
    return first


def _flat(value: object) -> list[Series]:
    if isinstance(value, Series):
        return [value]
    return [s for part in value for s in _flat(part)]  # type: ignore[attr-defined]


def place(
    names: frozenset[str], scalars: Mapping[object, Term], terms: Iterable[Term]
) -> Place | None:
    """Return the first world under some assumptions where all terms have a value, or None."""
    terms = list(terms)
    for seed in range(4):
        try:
            evaluator = Evaluator(world(names, seed), scalars)
            labels = frozenset().union(*(evaluator.labels(t) for t in terms))
        except InputError:
            return None
        found = InWorld(names, evaluator, labels)
        if all(found.number(t) is not None for t in terms):
            return found
    return None


LEVELS: tuple[tuple[str, ...], ...] = (
    ("body_frame", "newton_2", "third_law_strong", "about_centre"),
    ("body_frame", "newton_2", "third_law_strong", "O_fixed_in_body", "O_fixed_in_space"),
    ("body_frame", "newton_2", "third_law_strong", "about_centre", "principal_axes", "C_at_rest"),
    (
        *("body_frame", "newton_2", "third_law_strong", "about_centre", "principal_axes"),
        *("A_fixed_in_body", "OA_at_centre", "no_torque_2"),
    ),
    (
        *("body_frame", "newton_2", "third_law_strong", "about_centre", "principal_axes"),
        *("symmetric", "no_torque_2", "no_torque_3"),
    ),
    (
        *("body_frame", "newton_2", "third_law_strong", "about_centre", "torque_free"),
        *("principal_axes", "A_fixed_in_body"),
    ),
)
"""Sets of assumptions, the usual ones first; what cannot stand with the rest is left out."""

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


def places(
    given: Iterable[str], scalars: dict[object, Term], terms: list[Term]
) -> Iterator[tuple[Place, Place]]:
    """Yield worlds where the terms have values: without more than is given, and one of each level."""
    given = tuple(given)
    for context in contexts([*terms, *scalars.values()]):
        try:
            base = closure([*given, *context])
        except InputError:
            continue
        free = place(base, scalars, terms)
        if free is None:
            continue
        done: set[frozenset[str]] = set()
        for level in LEVELS:
            names = filled(base, level)
            if names not in done:
                done.add(names)
                there = place(names, scalars, terms)
                if there is not None:
                    yield free, there
        return


def filled(base: frozenset[str], level: Iterable[str]) -> frozenset[str]:
    """Return a set with every name of a level that can stand with it."""
    for name in level:
        try:
            base = closure([*sorted(base), name])
        except InputError:
            continue
    return base
