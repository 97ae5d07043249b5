"""Random exact worlds as models: for claims about mechanics in general.

A claim that holds under some assumptions holds under more; so the search in worlds starts from the
largest sets that can stand together, shrinks each to a smallest one, and leaves out one member of it at a
time to find others (a hitting-set tree: R. Reiter, "A theory of diagnosis from first principles", 1987).
What holds in three worlds modulo a 61-bit prime is false by chance about once in 2**50.

Contexts: what a world must hold so that the quantities of a claim have values. Levels, in which repairs
are looked for: from what derivations usually assume to special motions. A repair that holds under some
assumptions holds under more; so it is looked for where much is assumed, and judged afterwards.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import islice
from typing import Any, ClassVar

import sympy as sp

from eom.checker.judge.coordinates import addends, share
from eom.checker.judge.models import ENOUGH, Cases, Drawn, Models, Said, Search, equations
from eom.checker.mean.claims import Claim
from eom.checker.mean.values import atoms_in
from eom.errors import InputError
from eom.exact.numbers import SIGNED
from eom.exact.series import Series
from eom.fields import RESIDUES, Field, Singular
from eom.terms.terms import Equation, Term, expr, mul, nodes, number
from eom.terms.terms import replace as rewritten
from eom.worlds.evaluate import Evaluator, flat, half_powers, is_signed, subsets
from eom.worlds.generators import worlds
from eom.worlds.worlds import (
    ASSUMPTIONS,
    GENERAL,
    MOMENT,
    OPEN,
    SEQUENCES,
    World,
    closure,
    sequence_of,
)

TRIALS = 12
"""Worlds that are drawn at most, where a claim is undefined in some."""
FREELY = frozenset({"coordinate", "free_angle"})
"""Quantities that move in any way."""
SIGNED_TRIALS = 40
"""Worlds that are drawn at most, where signs and branches matter."""
OUTFLOW = "what leaves a body whose mass changes, and with which velocity, is not known here"
BOUND = "it may follow from the laws of motion, which have no such functions here"
MAX_ROOTS = 3
"""Square roots in a claim at most, whose signs are looked at."""
MAX_TESTS = 160
"""Sets of assumptions that are tried at most for one claim."""
NUMBERINGS = 3
"""How many ways to number free indices are looked at."""
UNBOUND = FREELY | {"scalar", "function", "vector"}
"""Quantities of which no assumption says anything."""

MASSES = (("mass",), ("total_mass",))
"""How the atoms of masses begin."""

SPECIAL = frozenset(
    {"thin_rod", "one_particle", "rotors", "viscous_slug", "spin_312", "first_turn", *SEQUENCES}
)
"""Assumptions that belong to a context, or to a family of degenerate bodies."""

MENTIONS: dict[str, frozenset[str]] = {
    "A_fixed_in_body": frozenset({"A"}),
    "unit_eigenvectors": frozenset({"eigenvectors"}),
    "OA_at_centre": frozenset({"OA"}),
    "OA_fixed_in_space": frozenset({"OA"}),
    "OB_fixed_in_space": frozenset({"OB"}),
    "about_centre": frozenset({"O"}),
    "O_fixed_in_body": frozenset({"O"}),
    "O_fixed_in_space": frozenset({"O"}),
    "O_at_origin": frozenset({"O"}),
    "O_uniform": frozenset({"O"}),
    "principal_at_O": frozenset({"O", "inertia"}),
    "symmetric_1": frozenset({"inertia"}),
    "symmetric_2": frozenset({"inertia"}),
    "plane_body": frozenset({"inertia"}),
    "fixed_axis": frozenset({"angular_velocity"}),
    "one_rotor": frozenset({"rotor_axis"}),
    "steady_turn": frozenset({"angular_velocity"}),
    "steady_rotors": frozenset({"rotor_speed"}),
    "exhaust_at_rest": frozenset({OPEN}),
    "exhaust_with_body": frozenset({OPEN}),
}
"""Assumptions that say nothing unless labels or quantities stand in the claim."""

RARE = (
    *("plane_body", "fixed_axis", "one_rotor", "steady_rotors"),
    *("symmetric_1", "symmetric_2", "O_uniform", "steady_turn"),
    *("OA_fixed_in_space", "OB_fixed_in_space"),
)
"""Assumptions that are tried where nothing else makes a claim true."""

SHAPES = frozenset({"plane_body"})
"""Those on the shape of a body, which no line about its motion means."""

AXIAL = frozenset({"fixed_axis", "steady_turn"})
"""Those on the axis of a rotation, which no line about any attitude means."""

ATTITUDES = frozenset(
    "rotation euler_parameter euler_vector rodrigues modified_rodrigues shadow_rodrigues".split()
)

GEOMETRY = frozenset({"inertia", "position", "unit", "identity", "mass", "total_mass", "scalar"})
"""Quantities of a line about the shape of a body."""

CHANCE = frozenset(
    name
    for name, row in ASSUMPTIONS.items()
    if (row.kind != GENERAL or row.joins) and not any(MOMENT in j for j in row.joins)
)
"""Assumptions under which something is zero; the others say of what kind a body, a frame, a law is."""

MODELS = (("spin_312",), ("rotors",), ("viscous_slug",))
"""Contexts that assume something of the body, which a claim about its masses rests on."""

CONTEXTS: tuple[tuple[str, ...], ...] = (
    (),
    ("rigid",),
    ("spin_312",),
    ("rotors",),
    ("viscous_slug",),
)
"""Worlds in which more and more quantities exist; the first where all of a claim do is taken."""

_USUAL = ("body_frame", "newton_2", "third_law_strong")

_PRINCIPAL = (*_USUAL, "about_centre", "principal_axes")

LEVELS: tuple[tuple[str, ...], ...] = (
    _USUAL,
    (*_USUAL, "about_centre"),
    (*_USUAL, "one_rotor"),
    (*_USUAL, "O_fixed_in_body"),
    (*_USUAL, "O_fixed_in_body", "O_fixed_in_space"),
    (*_PRINCIPAL, "C_at_rest"),
    (*_PRINCIPAL, "A_fixed_in_body", "OA_at_centre", "no_torque_2"),
    (*_PRINCIPAL, "symmetric", "no_torque_2", "no_torque_3"),
    (*_USUAL, "about_centre", "torque_free", "principal_axes", "A_fixed_in_body"),
)
"""Sets of assumptions, the usual ones first; what cannot stand with the rest is left out."""


def apart(claim: Claim) -> Claim | None:
    """Return a claim that names nothing of what moves as one that does not know it; None for others."""
    assert claim.moving is not None
    own, used = claim.moving.own, dict[Any, Term]()
    terms = [m.term for m in claim.members]
    labels: set[Any] = set()
    while terms:
        parts = [n for t in terms for n in nodes(t)]
        labels.update(*(n.data[1:] for n in parts if n.head == "atom"))
        symbols = {s for n in parts if n.head == "expr" for s in n.data[0].free_symbols}
        new = {s: t for s, t in claim.scalars.items() if s in symbols and s not in used}
        used |= new
        terms = [*new.values()]
    unknowns = (claim.scalars[s].data[1] for law in own.laws for s in law.unknowns)
    named = labels.intersection((*unknowns, *own.frames, *own.points, *own.bodies))
    return None if named else replace(claim, moving=None, scalars=used)


@dataclass
class InWorld(Drawn):
    """A world; ``labels``: free indices of what is looked at."""

    evaluator: Evaluator
    labels: frozenset[str] = frozenset()

    def agrees(self, said: Said) -> bool:
        """Return whether an equation holds, for all free indices."""
        return self.evaluator.holds(said)

    def values(self, term: Term) -> list[int] | None:
        """Return the components at t = 0, for each numbering of the free indices."""
        if term.is_zero:
            return [0]
        if not self.evaluator.labels(term) <= self.labels | {"dm"} and self._indices(term):
            return None
        if self.evaluator.world.field == SIGNED:
            return None
        try:
            numberings = islice(self.evaluator.numberings(self.labels), NUMBERINGS)
            return [_first(s) for env in numberings for s in flat(self.evaluator.value(term, env))]
        except (InputError, Singular, KeyError):
            return None

    def _indices(self, term: Term) -> bool:
        """Whether a term has indices of its own; one that this world has nothing for has some."""
        free = self.evaluator.labels(term) - self.labels
        try:
            return bool(next(iter(self.evaluator.numberings(free)), {}))
        except InputError:
            return True


def _first(value: Series) -> int:
    if not value.coefficients:
        raise InputError("too many time derivatives")
    return int(value.coefficients[0])


@dataclass(frozen=True)
class Worlds(Models):
    """Random exact worlds, restricted by named assumptions."""

    undefined: ClassVar[str] = "it has no value for any body and motion that was tried"
    order: ClassVar[Iterable[str]] = tuple(ASSUMPTIONS)

    @cached_property
    def said(self) -> tuple[Equation, ...]:
        """The equations that the claim says."""
        found, moving = equations(self.claim), self.claim.moving
        return found if moving is None else tuple(moving.spelt(q, self.scalars) for q in found)

    @cached_property
    def terms(self) -> list[Term]:
        """Every term of the equations, and what symbols stand for."""
        return [*(t for q in self.said for t in (q.left, q.right)), *self.scalars.values()]

    @property
    def names_scalars(self) -> bool:  # type: ignore[override]
        """Whether the claim says of a free scalar what it is, by others that are free."""
        return self.claim.moving is None and self._scalars() == "named"

    def _scalars(self) -> str:
        """Return whether a claim between free scalars names some, or ties angles to others; else ""."""
        sides = [n for q in self.said for t in (q.left, q.right) for n in nodes(t)]
        meanings = self.scalars.values()
        plain = all(n.head in {"expr", "add", "mul", "zero"} for n in sides)
        rows = [[(s, atoms_in(s, self.scalars)) for s in (q.left, q.right)] for q in self.said]
        atoms = [a for row in rows for _, side in row for a in side]
        if not plain or not meanings or any(a.data[0] != "scalar" for a in atoms):
            return ""
        alone = (
            len(own) == 1 and not own & other and self._meaning(side) in own
            for row in rows
            for (side, own), (_, other) in (row, row[::-1])
        )
        tied = any(a != b for (_, a), (_, b) in rows) and all(m.head == "atom" for m in meanings)
        angles = any(n.head == "expr" and n.data[0].has(sp.sin, sp.cos) for n in sides)
        return "named" if any(alone) or (tied and not angles) else "tied" if tied else ""

    def _meaning(self, side: Term) -> Term | None:
        return self.scalars.get(side.data[0]) if side.head == "expr" else None

    def own(self, context: tuple[str, ...]) -> frozenset[str]:
        """Return a model of the body, where the claim is not about frames and angles alone."""
        body = {"body", "dm", "system", "inertia", "mass", "total_mass"}
        about = context in MODELS and labels_in(self.terms) & body
        return frozenset(context if about else ())

    def rank(self, names: tuple[str, ...]) -> tuple[Any, ...]:
        """Return what sets are sorted by."""
        return len(names), names

    def contexts(self) -> Iterator[tuple[str, ...]]:
        """Yield worlds in which more and more quantities exist."""
        return contexts(self.terms)

    def closed(self, names: Iterable[str]) -> frozenset[str]:
        """Return names with all that they need."""
        return closure(names)

    @cached_property
    def roots(self) -> frozenset[Any]:
        """What stands under square roots: half of all worlds have no root of each."""
        inside = (n for t in self.terms for n in nodes(t) if n.head == "expr")
        return frozenset(p.base for n in inside for p in half_powers(n.data[0]))

    def draw(self, names: frozenset[str]) -> Iterator[InWorld]:
        """Yield worlds under a closed set."""
        if self.signed:
            for world in self._worlds(names, SIGNED_TRIALS, SIGNED):
                yield InWorld(names, world.seed, Evaluator(world, self._meanings))
            return
        for world in self._worlds(names, TRIALS << min(len(self.roots), MAX_ROOTS)):
            yield InWorld(names, world.seed, Evaluator(world, self._meanings))

    @cached_property
    def _meanings(self) -> Mapping[Any, Term]:
        """What symbols stand for, partial derivatives carried out where the note says what moves."""
        moving = self.claim.moving
        return self.scalars if moving is None else moving.meanings(self.scalars)

    def _worlds(
        self, names: frozenset[str], count: int, field: Field = RESIDUES
    ) -> Iterator[World]:
        """Return worlds, with what moves in the note's own way."""
        moving = self.claim.moving
        drawn = worlds if moving is None else moving.drawn
        return drawn(sorted(names), count, field)

    @cached_property
    def signed(self) -> bool:
        """Whether the claim has functions that no field has but that of numbers with a sign."""
        found = (n for t in self.terms for n in nodes(t) if n.head == "expr")
        return any(is_signed(n.data[0], self.scalars) for n in found)

    def cases(self, names: frozenset[str]) -> Cases | None:
        """Return what is found among numbers with a sign, None where other fields know all functions.

        Raises `InputError` where there is no value.
        """
        if not self.signed:
            return None
        if names not in self._cases:
            self._cases[names] = self._found(names)
        if len(self._cases[names]) < ENOUGH:
            raise InputError(self.undefined)
        return self._cases[names]

    @cached_property
    def _cases(self) -> dict[frozenset[str], Cases]:
        return {}

    def _found(self, names: frozenset[str]) -> Cases:
        found = []
        for drawn in self.draw(names):
            with suppress(Singular):
                true = all(map(drawn.agrees, self.said))
                met = tuple(sorted(drawn.evaluator.branches.items(), key=str))
                found.append((drawn.seed, true, met))
        return tuple(found)

    def needs(self, name: str) -> frozenset[str]:
        """Return an assumption with all that it needs."""
        return _needed(name)

    def rests_on(self, names: Iterable[str]) -> tuple[str, ...]:
        """Return the assumptions, none for a claim between free quantities alone."""
        sides = (t for q in self.said for t in (q.left, q.right))
        kinds = {a.data[0] for t in sides for a in atoms_in(t, self.scalars)}
        return () if kinds <= UNBOUND else tuple(names)

    def doubt(self) -> str:
        """Say that what is false may be true of open systems, with roots of other signs, of one motion."""
        if self._changes_mass():
            return OUTFLOW
        cases = self.cases(Search(self).base[1])
        bound = not self._kinds() <= UNBOUND
        if cases and (bound or any(true for _, true, _ in cases)):
            return BOUND if bound else self.branch(cases)
        loose = "" if self.claim.moving is not None else self._loose()
        if loose:
            return loose
        if cases is not None:
            return self.branch(cases)
        if len(self.roots) > MAX_ROOTS or any(map(self._with_signs, subsets(self.roots))):
            return "this rests on the signs of its roots"
        return ""

    def _loose(self) -> str:
        """Say that quantities may be tied to each other by what nothing here says."""
        if self._scalars() == "tied":
            return "nothing here says what these letters are"
        if "expr" not in self._rated_sides and self._of_a_motion():
            return "no system says how these coordinates move"
        if "expr" not in self._rated_sides and self._is_law():
            return "this may be a law for quantities that are any, and nothing here ties to others"
        return ""

    def is_open(self) -> bool:
        """Return whether a claim has roots and no other factor of a side makes it true."""
        factors = (number(-1), number(2), number(1, 2))
        return bool(self.roots) and not self.signed and not any(map(self._with_factor, factors))

    def _with_factor(self, factor: Term) -> bool:
        """Return whether the claim holds with a factor on its last side, or does so under something."""
        *before, last = self.claim.members
        scaled = replace(self.claim, members=(*before, replace(last, term=mul(factor, last.term))))
        search = Search(replace(self, claim=scaled))
        return search.holds(search.base[1]) or bool(search.sets())

    def _changes_mass(self) -> bool:
        """Return whether the claim has the rate of a mass."""
        found = (n for t in (*self.terms, *self.scalars.values()) for n in nodes(t))
        inside = (n.args[0].data for n in found if n.head == "der")
        return any(data[:1] in MASSES and data[1:] != (OPEN,) for data in inside)

    def _of_a_motion(self) -> bool:
        """Return whether the claim says how coordinates move, which no law of the note's gives."""
        found = {a.data[0] for t in self.terms for a in atoms_in(t, self.scalars)}
        free = found & FREELY and found <= FREELY | {"scalar"}
        return bool(free) and "atom" in self._rated_sides

    def _is_law(self) -> bool:
        """Return whether quantities that are any may be tied to each other by more than kinematics."""
        for q in self.said:
            left, right = (atoms_in(side, self.scalars) for side in (q.left, q.right))
            kinds = {a.data[0] for a in left | right}
            if not kinds <= FREELY | {"scalar", "vector", "function"}:
                continue
            if "function" in kinds:
                law = left != right and not share(left, right, FREELY)
            else:
                law = self._gives(q, alone=left != right)
            if law:
                return True
        return False

    def _gives(self, equation: Equation, *, alone: bool) -> bool:
        """Return whether an equation with rates may be a law that gives one of its quantities.

        A law gives a highest rate that is a term by itself, or, where ``alone``, what stands in one way:
        as itself or as one of its rates. Where nothing is given, rates are compared with each other
        and with what they are rates of: that is kinematics, which no law can make otherwise.
        """
        terms = [*addends(equation.left), *addends(equation.right)]
        there = [self._ways(t) for t in terms]
        ways = frozenset().union(*there)
        orders = {a: max(len(frames) for b, frames in ways if b == a) for a, _ in ways}
        if not any(orders.values()):
            return False
        if alone and any(sum(a == b for b, _ in ways) == 1 for a in orders):
            return True
        highest = [{a for a, frames in own if len(frames) == orders[a] > 0} for own in there]
        by_itself = [
            {a for a, frames in self._factored(t) if len(frames) == orders[a]} for t in terms
        ]
        return any(
            sum(a in own for own in highest) == 1
            for own, given in zip(highest, by_itself, strict=True)
            for a in own & given
        )

    def _ways(self, term: Term) -> frozenset[tuple[Term, tuple[str, ...]]]:
        """Return the quantities of a term, each with the frames in which it is differentiated there."""
        if term.head == "atom":
            return frozenset({(term, ())})
        inside: Iterable[Term] = term.args
        if term.head == "expr":
            inside = (self.scalars[s] for s in term.data[0].free_symbols if s in self.scalars)
        found = frozenset().union(*map(self._ways, inside))
        return frozenset((a, (*f, term.data[0])) for a, f in found) if term.head == "der" else found

    def _factored(self, term: Term) -> Iterator[tuple[Term, tuple[str, ...]]]:
        """Yield the same of quantities, or of their rates, that multiply the rest of a term."""
        for factor in self._factors(term):
            if [p.head for p in self._factors(_rated(factor))] == ["atom"]:
                yield from self._ways(factor)

    @cached_property
    def _rated_sides(self) -> frozenset[str]:
        return frozenset(self._rated(s) for q in self.said for s in (q.left, q.right))

    def _rated(self, side: Term) -> str:
        """Return "atom" for zero, a coordinate, a multiple of a time derivative of one, else "".

        The same of what laws make of coordinates is "expr".
        """
        factors = list(self._factors(side))
        moving = [p for p in factors if p.data[:1] != ("scalar",)]
        if len(moving) != 1 or (len(factors) > 1 and moving[0].head != "der"):
            return "atom" if side.is_zero else ""
        inner = _rated(moving[0])
        named = inner.head == "expr" and inner.data[0] in self.scalars
        heads = [p.head for p in self._factors(inner)]
        return "expr" if named and heads == ["expr"] else "atom" if heads == ["atom"] else ""

    def _factors(self, term: Term) -> Iterator[Term]:
        """Yield what a product multiplies, numbers left out; sums as they are."""
        if term.head == "mul":
            yield from (f for a in term.args for f in self._factors(a))
        elif term.head == "expr":
            parts = (f for f in sp.Mul.make_args(term.data[0]) if not f.is_number)
            yield from (self.scalars.get(f.as_base_exp()[0], expr(f)) for f in parts)
        else:
            yield term

    def _with_signs(self, negative: frozenset[Any]) -> bool:
        """Return whether the claim holds in the first world where it has a value, by other roots."""

        def turned(term: Term) -> Term:
            if term.head != "expr":
                return term
            found = {p for p in half_powers(term.data[0]) if p.base in negative}
            return expr(term.data[0].xreplace({p: -p for p in found if p.exp.p % 2}))

        said = [Equation(rewritten(q.left, turned), rewritten(q.right, turned)) for q in self.said]
        scalars = {s: rewritten(t, turned) for s, t in self.scalars.items()}
        for drawn in replace(self, scalars=scalars).draw(Search(self).base[1]):
            with suppress(Singular):
                return all(map(drawn.agrees, said))
        return False

    def smallest(self, search: Search, base: frozenset[str]) -> Iterator[frozenset[str]]:
        """Yield smallest sets below every largest one; with rare ones where there are no others."""
        if self.signed:
            return
        names = [n for n in self._applicable() if n not in RARE]
        rows = (names[k:] + names[:k] for k in range(len(names)))
        found = False
        for inside in self._below(search, base, rows):
            found = True
            yield inside
        if not found:
            yield from self.rarest(search, base)

    def rarest(self, search: Search, base: frozenset[str]) -> Iterator[frozenset[str]]:
        """Yield smallest sets with assumptions that are tried last, as `smallest` does."""
        names = self._applicable()
        rare = [n for n in names if n in RARE]
        usual = [n for n in names if n not in RARE]
        yield from self._below(search, base, ([name, *rare, *usual] for name in rare))

    def _below(
        self, search: Search, base: frozenset[str], rows: Iterable[list[str]]
    ) -> Iterator[frozenset[str]]:
        """Yield smallest sets below the largest ones, filled up in the order of each row."""
        found, seen = set[frozenset[str]](), set[frozenset[str]]()

        def below(names: frozenset[str]) -> Iterator[frozenset[str]]:
            if names in seen or search.tests >= MAX_TESTS:
                return
            seen.add(names)
            inside = next((s for s in found if s <= names), None)
            if inside is None:
                if not search.holds(names):
                    return
                inside = self.shrunk(names, base, search.counts)
                if inside not in found:
                    yield inside
                found.add(inside)
            for name in sorted(inside - base):
                yield from below(self.without(names, name))

        for row in rows:
            new = next((n for n in row if n not in base), "")
            if not new or new in filled(base, [new]):
                yield from below(filled(base, row))

    def _kinds(self) -> set[str]:
        """Return the names of the quantities that the claim has."""
        return {a.data[0] for t in self.terms for a in atoms_in(t, self.scalars)}

    def _applicable(self) -> list[str]:
        """Return the assumptions that say something of what the claim is about."""
        labels = labels_in(self.terms)
        wanted = (n for n in ASSUMPTIONS if n not in SPECIAL)
        names = [n for n in wanted if MENTIONS.get(n, frozenset()) <= labels]
        kinds = self._kinds()
        unmeant = (SHAPES if kinds - GEOMETRY else frozenset()) | (
            AXIAL if kinds & ATTITUDES else frozenset()
        )
        return [n for n in names if n not in unmeant]

    def levels(self, terms: Sequence[Term]) -> Iterator[tuple[Drawn, Drawn]]:
        """Yield worlds where terms have values: without more than is given, and one of each level.

        None where what may stand for a term has none beside the line.
        """
        own = [*terms, *(a for t in terms for a in atoms_in(t, self.scalars))]
        labels = labels_in(own)
        known: Iterable[tuple[str, ...]] = ()
        with suppress(InputError):
            known = list(contexts(own))
        for context in known:
            try:
                base = closure([*self.given, *context])
            except InputError:
                continue
            free = self.at(base, terms)
            if free is None:
                continue
            for names in dict.fromkeys(filled(base, relevant(n, labels)) for n in LEVELS):
                there = self.at(names, terms)
                if there is not None:
                    yield free, there
            return

    def at(self, names: frozenset[str], terms: Sequence[Term]) -> Drawn | None:
        """Return the first world under some assumptions where all terms have a value, or None."""
        for drawn in islice(self.draw(names), 4):
            try:
                labels = frozenset[str]().union(*map(drawn.evaluator.labels, terms))
            except InputError:
                return None
            found = replace(drawn, labels=labels)
            if all(found.number(t) is not None for t in terms):
                return found
        return None


def _rated(term: Term) -> Term:
    """Return what a term is a time derivative of, itself where it is none."""
    while term.head == "der":
        term = term.args[0]
    return term


def relevant(names: Iterable[str], labels: Collection[str]) -> Iterator[str]:
    """Yield those assumptions that say something where some labels stand."""
    return (n for n in names if n not in MENTIONS or not MENTIONS[n].isdisjoint(labels))


def labels_in(terms: Iterable[Term]) -> frozenset[str]:
    """Return every label of terms."""
    return frozenset(str(d) for t in terms for n in nodes(t) for d in n.data if isinstance(d, str))


def contexts(terms: Sequence[Term]) -> Iterator[tuple[str, ...]]:
    """Yield the contexts in which terms may have values, the simplest first.

    Angles exist by the assumption of their sequence, a single particle by that of one. Raises `InputError`
    where a body stands beside that: all that is said of a body would be zero.
    """
    found = [n.data[2] for t in terms for n in nodes(t) if n.data[:1] == ("turn_angle",)]
    sequences = tuple(dict.fromkeys(map(sequence_of, found)))
    single = [("one_particle",)] if "P" in labels_in(terms) else []
    if single and any(_of_body(n) for t in terms for n in nodes(t)):
        raise InputError(
            "a body beside the single particle P",
            got="P",
            expected="a point of the body, such as O or C",
            hint="in [points] of the lexicon say which point of the body the note calls P: 'P' = \"O\"",
        )
    for general in [*single, *CONTEXTS]:
        yield (*sequences, *general)


def _of_body(node: Term) -> bool:
    return node.head == "atom" and (node.data[0] == "inertia" or "body" in node.data[1:])


def filled(base: frozenset[str], names: Iterable[str]) -> frozenset[str]:
    """Return a set with every name that can still stand with what is there."""
    for name in names:
        try:
            base = closure([*sorted(base), name])
        except InputError:
            continue
    return base


@cache
def _needed(name: str) -> frozenset[str]:
    return closure([name])
