"""Claims about the system of a note: models are its solutions, and what is wrong is said in named terms.

Every symbol of the claim is a quantity of the system; time derivatives are those along its solutions.
Both sides are compared as exact series at random points (`eom.worlds.solutions`), so that an equation may
be multiplied by any factor and written in any form. What does not hold is tried under what may be assumed
of the system, the smallest sets first. A set is refused that makes something vanish which the claim itself
writes: a slip in a term is no licence to assume the term away.

The left side less the right side, with all rates written out by the system's equations, is what is left
over. If that is a multiple of a term that the writer has, the term has a wrong sign or factor, or does not
belong; else it is what is missing. Where definitions of the system have names, the form with fewer terms is
given.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import combinations, islice, pairwise
from typing import Any, ClassVar

import sympy as sp

from eom.checker.judge.coordinates import elements, equations, tells_time, written
from eom.checker.judge.models import ENOUGH, Cases, Drawn, Models, Said, Search
from eom.checker.judge.particular import EXACT, value_at
from eom.checker.judge.particular import drawn as point_of
from eom.checker.mean.claims import CONSTANT, Claim
from eom.checker.mean.dimensions import dimension
from eom.checker.mean.model import Model, imposed, is_load
from eom.errors import InputError
from eom.exact.numbers import MP
from eom.exact.series import Series
from eom.fields import RESIDUES, Singular
from eom.quantities import Definition
from eom.system import Expr, System
from eom.terms.terms import Term
from eom.worlds.solutions import (
    Inconsistent,
    Motion,
    Restriction,
    anything,
    differs,
    inexact,
    order,
    rate,
    since,
    spread,
    start,
    without_rates,
)

TRIES = 30
LENGTH = 3
"""Coefficients of every series at least, so that claims share them."""
MAX_TESTS = 200
"""Sets that are tried at most besides the empty one."""
MAX_SET, MAX_REST = 3, 2
"""Members of a set at most, and of one where something may rest."""
MAX_ORDER = 6
SPEEDS = frozenset({"rad/s", "m/s"})
SPECIAL = 6
"""Restrictions under which repairs are looked for at most, one at a time."""
MAX_OPERATIONS = 1500
MAX_TERMS = 6
MAX_SPREAD = 3000
MAX_WRITTEN = 2
MAX_TOLD = 60
"""Operations of what is said to be missing."""
MAX_NUMBER = 100
FAR = 14
"""Rank from which on a factor is no slip: the difference is reported as what is missing."""

Pair = tuple[Expr, Expr]


# -- solutions ----------------------------------------------------------------------------------------


@dataclass
class OnSolution(Drawn):
    """A random point of a solution."""

    motion: Motion
    models: Solutions

    def agrees(self, said: Said) -> bool:
        """Return whether two expressions are the same along the solution."""
        a, b = said
        return (self.motion.series(a) - self.motion.series(b)).is_zero

    def values(self, term: Term) -> list[int] | None:
        """Return the values of a scalar, or of all elements, at t = 0."""
        try:
            written_out = elements(term, self.models.scalars, self.models.model)
            found = list(map(self.motion.series, written_out))
        except (InputError, Singular, KeyError):
            return None
        return [int(f.coefficients[0]) for f in found]


def _given_parameter(pair: Pair, own: set[Expr]) -> Expr | None:
    """Return the parameter whose power one side is, where the other has others alone; None for none."""
    for (base, _), other in ((a.as_base_exp(), b) for a, b in (pair, pair[::-1])):
        if base in own and other != 0 and other.free_symbols <= own - {base}:
            return base
    return None


@dataclass(frozen=True)
class Solutions(Models):
    """Solutions of the system that a claim is about; names are those of restrictions."""

    undefined: ClassVar[str] = "it has no value at any point that was tried"

    @property
    def model(self) -> Model:
        """The system, with what may be assumed of it."""
        assert self.claim.model is not None
        return self.claim.model

    @cached_property
    def said(self) -> tuple[Pair, ...]:
        """The expressions that the claim says are equal."""
        pairs = tuple(equations(self.claim, self.model))
        orders = max((order(e) for pair in pairs for e in pair), default=0)
        if orders > MAX_ORDER:
            raise InputError("too many time derivatives", got=orders, expected=f"{MAX_ORDER}")
        return pairs

    @cached_property
    def length(self) -> int:
        """How many coefficients a solution needs: for one derivative more than the claim has."""
        with suppress(InputError):
            return max(LENGTH, *(order(e) + 2 for pair in self.said for e in pair), 0)
        return LENGTH

    @cached_property
    def held(self) -> tuple[Restriction, ...]:
        """What is given of the system, with the restrictions that some names mean."""
        named = (r for r in self.model.possible if r.name in self.given)
        return (*self.model.given, *named)

    @cached_property
    def possible(self) -> Mapping[str, Restriction]:
        """What may be assumed besides, by name; where the claim is that a parameter is zero, that."""
        found = {r.name: r for r in self.model.possible if r not in self.held}
        parameters = {q.symbol for q in self.model.system.parameters}
        stated: list[Expr] = []
        with suppress(InputError):
            stated = [s for pair in self.said if 0 in pair for s in pair if s in parameters]
        return found | {f"{s.name} = 0": Restriction(f"{s.name} = 0", zero=(s,)) for s in stated}

    @cached_property
    def signed(self) -> bool:
        """Whether the claim has functions that real numbers alone have: cases, magnitudes, signs."""
        return any(e.has(sp.Piecewise, sp.Abs, sp.sign) for pair in self.said for e in pair)

    def cases(self, names: frozenset[str]) -> Cases | None:
        """Return what is found at points in real numbers, None where other fields know all functions.

        Raises `InputError` where motions keep what points do not show.
        """
        if not self.signed:
            return None
        if any(r.held for r in self.kept(names)) or self.model.system.assumptions:
            raise InputError(self.undefined)
        values = {s: sp.S.Zero for r in self.kept(names) for s in r.zero}
        found = tuple(c for seed in range(TRIES) for c in self._at(seed, values))
        if len(found) < ENOUGH:
            raise InputError(self.undefined)
        return found

    def _at(self, seed: int, zero: Mapping[Expr, Expr]) -> Iterator[tuple[int, bool, Any]]:
        """Yield what is found at a point in real numbers, nothing where the claim has no value."""
        point = point_of(self.model, seed).moved({s: MP.mpf(0) for s in zero})
        with suppress(Singular, ZeroDivisionError):
            motion = point.motion(self.model.system, self.length)
            sides = [(value_at(motion, a), value_at(motion, b)) for a, b in self.said]
            if all(MP.im(v) == 0 for pair in sides for v in pair):
                true = all(abs(a - b) <= EXACT * max(1, abs(a), abs(b)) for a, b in sides)
                yield seed, true, tuple(sorted(motion.branches.items(), key=str))

    def kept(self, names: Iterable[str]) -> tuple[Restriction, ...]:
        """Return what is given, and what names assume besides."""
        chosen = self.closed(names)
        return (*self.held, *(r for n, r in self.possible.items() if n in chosen))

    @property
    def order(self) -> Iterable[str]:
        """What may be assumed besides."""
        return tuple(self.possible)

    def draw(self, names: frozenset[str]) -> Iterator[OnSolution]:
        """Yield points of solutions that keep restrictions."""
        try:
            for motion in self.model.motions(self.kept(names), self.length, TRIES):
                yield OnSolution(names, motion.seed, motion, self)
        except Inconsistent as error:
            raise InputError("no solution of the system keeps what is assumed") from error

    def smallest(self, search: Search, base: frozenset[str]) -> Iterator[frozenset[str]]:
        """Yield the loads that have to be absent, else sets without rest, the smallest first.

        What is absent is drawn at once; for what is held a motion is looked for.
        """
        if self.signed:
            return
        names = [n for n, r in self.possible.items() if not r.rest and self._concerns(r)]
        absent = base | {n for n in names if self._loads.issuperset(self.possible[n].symbols)}
        if absent > base and search.holds(absent):
            least = self.shrunk(absent, base, search.holds)
            if not self.empties(least):
                yield least
                return
        others = [n for n in names if n not in absent]
        yield from (base | s for s in self._small(search, others, MAX_SET))

    @cached_property
    def _loads(self) -> frozenset[Expr]:
        """The loads that are given as functions of time, with their rates."""
        states = self.model.system.states
        given = imposed(self.model.system)
        loads = [q.name for q in states if is_load(q) and q.name in given]
        named = {f"{load}{end}" for load in loads for end in ("", "_dot", "_ddot")}
        quantities = (*states, *self.model.system.inputs)
        return frozenset(q.symbol for q in quantities if q.name in named)

    @cached_property
    def _symbols(self) -> frozenset[Expr]:
        """All symbols that the claim rests on; those of the rates where it has accelerations."""
        system, todo = self.model.system, [e for pair in self.said for e in pair]
        named = {d.symbol: d.expression for d in (*system.definitions, *system.outputs)}
        found = set[Expr]()
        todo += system.rates if any(e.has(rate) for e in todo) else ()
        while todo:
            new = todo.pop().free_symbols - found
            found |= new
            todo += [named[s] for s in new if s in named and named[s] != s]
        return frozenset(found)

    def _concerns(self, r: Restriction) -> bool:
        """Return whether a claim rests on what is restricted; what is held says nothing of places."""
        speeds = {q.symbol for q in self.model.system.states if q.unit in SPEEDS}
        mentioned = {*r.zero, *r.held, *(s for pair in r.equal for s in pair)} & self._symbols
        return bool(mentioned) and (not r.held or bool(speeds & self._symbols))

    def _small(self, search: Search, names: Sequence[str], most: int) -> Iterator[frozenset[str]]:
        found: list[frozenset[str]] = []
        held = {n for n in names if self.possible[n].held}
        for chosen in (frozenset(c) for k in range(most) for c in combinations(names, k + 1)):
            if any(f <= chosen for f in found) or search.tests > MAX_TESTS:
                continue
            if len(held & chosen) > 1:
                continue
            if search.counts(chosen) and self._lacks_no_speed(chosen):
                found.append(chosen)
                yield chosen

    def _lacks_no_speed(self, names: frozenset[str]) -> bool:
        """Return whether a claim holds where what is held only does not accelerate, for an instant.

        What is missing in it is then an acceleration: it says how a steady motion is kept up. One that
        lacks a speed describes the motion wrongly. What is said to be constant is looked at in steady ones.
        """
        if self.claim.kind == CONSTANT or not any(self.possible[n].held for n in names):
            return True
        units = {q.symbol: q.unit for q in self.model.system.states}
        kept = tuple(
            replace(r, name=f"{r.name} now", now=1 + (units.get(r.held[0]) in {"rad", "m"}))
            if r.held
            else r
            for r in self.kept(names)
        )
        try:
            drawn = list(islice(self.model.motions(kept, self.length, TRIES), ENOUGH))
            apart = (m.series(a) - m.series(b) for m in drawn for a, b in self.said)
            return bool(drawn) and not any(s.coefficients[0] for s in apart)
        except (Inconsistent, Singular):
            return False

    def empties(self, names: frozenset[str]) -> bool:
        """Return whether something that the claim writes vanishes under a set alone."""
        parts = [p for pair in self.said for p in written_in(pair)]
        special, general = (next(self.draw(n), None) for n in (names, frozenset[str]()))
        if special is None or general is None:
            return True
        return any(_zero(special.motion, p) and not _zero(general.motion, p) for p in parts)

    def doubt(self) -> str:
        """Say that what differs may be equal for real numbers or in one motion, or defines a letter."""
        loose = sorted({str(a) for pair in self.said for e in pair for a in e.atoms(anything)})
        if loose:
            return f"nothing ties {', '.join(loose)} to the system"
        free = self._free_parameters()
        if free:
            return f"any value is possible of {', '.join(free)}, a parameter of the system"
        system = self.model.system
        if tells_time(self.claim, self.model):
            return "how the motion starts is not known here"
        cases = self.cases(frozenset())
        if cases is not None:
            return self.branch(cases)
        exact = not any(inexact(system, e) for pair in self.said for e in pair)
        certain = exact or any(differs(system, a, b, self.held) for a, b in self.said)
        return "" if certain else "the functions in this are not decided exactly"

    def _free_parameters(self) -> list[str]:
        """Return the parameters that all that fails gives by other parameters, as no motion does."""
        own = {q.symbol for q in self.model.system.parameters}
        found = {pair: _given_parameter(pair, own) for pair in self.said}
        failing = (p for p in found if any(found.values()) and any(self._failing(p)))
        given = {found[pair] for pair in failing}
        return [] if None in given else sorted(map(str, given))

    def why(self, search: Search) -> str:
        """Say what is wrong with the first equation that fails, and what would have to rest."""
        if self.signed:
            return ""
        rest = next(self._small(search, list(self.possible), MAX_REST), None)
        held = f"it holds if {' and '.join(self.shown(rest))}" if rest else ""
        return "; ".join(filter(None, (self._slip(), held)))

    def leaves(self) -> Expr | None:
        """Return what the one equation that fails leaves over, None where it is long."""
        if self.signed:
            return None
        failing = [p for p in self.said if next(self._failing(p), None) is not None]
        with suppress(Singular, InputError):
            found = (
                residual(self.model.system, failing[0], self.held) if len(failing) == 1 else None
            )
            return None if found is None else self.model.system.expand(found)
        return None

    def _slip(self) -> str:
        named = {s.name for pair in self.said for e in pair for s in e.free_symbols}
        any_function = named & (
            self.model.canonical - {"H"}
        )  # a random one, which nobody has written
        for pair in self.said if not any_function else ():
            apart = list(islice(self._failing(pair), ENOUGH))
            if apart:
                with suppress(Singular, InputError):
                    found = leftover(self.model.system, pair, apart, self.held)
                    return "" if found is None else self._missing(found)
                return ""
        return ""

    def _failing(self, pair: Pair) -> Iterator[Motion]:
        for drawn in self.draw(frozenset()):
            with suppress(Singular):
                if not drawn.agrees(pair):
                    yield drawn.motion

    def _missing(self, found: Leftover) -> str:
        if _size(found.term) > MAX_TOLD:
            return ""
        quantities = self.model.quantities.items()
        letters = {q.symbol: sp.Symbol(self.model.letter(n)) for n, q in quantities}
        return found.words.format(str(found.term.xreplace(letters)).replace("**", "^"))

    def levels(self, terms: Sequence[Term]) -> Iterator[tuple[Drawn, Drawn]]:  # noqa: ARG002
        """Yield points: without more than is given, and with one restriction more each."""
        unresting = [n for n, r in self.possible.items() if not r.rest][:SPECIAL]
        free = self._first(frozenset())
        if free is not None:
            yield free, free
            special = (self._first(frozenset({n})) for n in unresting)
            yield from ((free, there) for there in special if there is not None)

    def _first(self, names: frozenset[str]) -> Drawn | None:
        with suppress(InputError):
            return next(self.draw(names), None)
        return None

    def written(self, term: Term) -> Expr:
        """Return a scalar term as an expression over the system's symbols. Raises `InputError`."""
        return written(term, self.scalars, self.model)

    def moves(self, term: Term) -> bool:
        """Return whether a scalar depends on more than the parameters of the system."""
        try:
            found = self.written(term)
        except InputError:
            return True
        return bool(found.free_symbols - {q.symbol for q in self.model.system.parameters})


LEVELS = {"V": 1, "potential_energy": 1, "E": 1, "energy": 1, "H": 1, "L": -1, "lagrangian": -1}
"""Quantities that a constant added to the potential energy changes, and how often it stands in them."""


def levelled(claim: Claim) -> Model | None:
    """Return the system with its potential energy zero where a claim has it; None where it does not say.

    The claim need not hold then, as what differs may be more than a constant.
    """
    model, zero = Solutions(claim, claim.scalars).model, sp.S.Zero
    try:
        apart = [a - b for a, b in Solutions(claim, claim.scalars).said]
        rests, ones = (
            [unrated(_raised(model, by).system, e) for e in apart] for by in (zero, sp.S.One)
        )
    except InputError:
        return None
    states = dict.fromkeys((q.symbol for q in model.system.states), zero)
    parameters = {q.symbol for q in model.system.parameters}
    for rest, one in zip(rests, ones, strict=True):
        slope = sp.expand(one - rest)
        if not slope.is_number or slope == 0:
            continue
        level = -rest.subs(states) / slope
        if level.free_symbols <= parameters and not level.has(sp.nan, sp.zoo, sp.oo):
            return _raised(model, level) if level != 0 else model
    return None


def _raised(model: Model, by: Expr) -> Model:
    """Return a system with a constant added to its potential energy."""
    s = model.system
    energies = {d.symbol for d in (*s.definitions, *s.outputs, *s.invariants) if _is_level(d)}

    def raised(d: Definition) -> Definition:
        own = d.symbol in energies and not d.expression.free_symbols & energies
        return replace(d, expression=d.expression + LEVELS[d.name] * by) if own else d

    moved = replace(
        s,
        definitions=tuple(map(raised, s.definitions)),
        outputs=tuple(map(raised, s.outputs)),
        invariants=tuple(map(raised, s.invariants)),
    )
    return replace(model, system=moved, drawn={})


def _is_level(d: Definition) -> bool:
    return d.name in LEVELS and dimension(d.quantity.unit) == dimension("J")


def agreeing(claim: Claim) -> int:
    """Return how many links of a chain hold at a random point; none of what has no value there."""
    models = Solutions(claim, claim.scalars)
    with suppress(InputError, Singular):
        drawn = next(models.draw(frozenset()))
        members = [m.term for m in claim.members]
        values = [drawn.number(m) for m in members]
        return sum(a == b and a is not None for a, b in pairwise(values))
    return 0


def _zero(motion: Motion, part: Expr) -> bool:
    try:
        found: Series = motion.series(part)
    except Singular:
        return False
    return found.is_zero


def written_in(pair: tuple[Expr, Expr]) -> Iterator[Expr]:
    """Yield all that a pair writes; of an expression that is to be zero, not itself and its factors."""
    for this, other in (pair, pair[::-1]):
        if other == 0:
            for factor in sp.Mul.make_args(this):
                yield from _proper(factor)
        else:
            yield from _inside(this)


def _proper(factor: Expr) -> Iterator[Expr]:
    """Yield what a factor that is to be zero is made of; of the rate of a sum the rates of its terms."""
    inner = factor.args[0] if isinstance(factor, rate) else factor
    yield from (p for a in inner.args for p in _inside(a))
    summed = isinstance(factor, rate) and spread(inner) <= MAX_SPREAD
    terms = sp.Add.make_args(sp.expand_mul(inner)) if summed else ()
    yield from (rate(t) for t in terms if len(terms) > 1)


def _inside(expression: Expr) -> Iterator[Expr]:
    yield from (n for n in sp.preorder_traversal(expression) if not n.is_number)


# -- what is left over --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Leftover:
    """A slip in words with a place {} for a term, and that term, in the symbols of the system."""

    words: str
    term: Expr


def leftover(
    system: System, pair: Pair, motions: Sequence[Motion], given: tuple[Restriction, ...] = ()
) -> Leftover | None:
    """Return what is wrong with an equation; None where it would be long or is not explicit.

    ``motions``: solutions at which both sides have values that differ.
    """
    left, right = pair
    constant = right == 0 and isinstance(left, rate)
    blamed = _blamed(motions, left, right)
    if blamed is not None:
        return blamed
    found = residual(system, pair, given)
    if found is None:
        return None
    return Leftover("its rate is {}" if constant else "missing on the right side: {}", found)


def residual(system: System, pair: Pair, given: tuple[Restriction, ...] = ()) -> Expr | None:
    """Return the left side less the right side on the solutions; None if it is long or not explicit."""
    if system.mass_matrix is not None or sum(map(_size, pair)) > MAX_OPERATIONS:
        return None
    equal = {b: a for r in given for a, b in r.equal} | {
        s: sp.S.Zero for r in given for s in r.zero
    }
    left, right = pair
    if max(order(left), order(right)) > MAX_WRITTEN or (left - right).has(since, start):
        return None
    forms = [_expanded(f(system, left - right).xreplace(equal)) for f in (_named, unrated)]
    found = min(forms, key=lambda f: len(sp.Add.make_args(f)))
    if found == 0 or len(sp.Add.make_args(found)) > MAX_TERMS:
        return None
    return sp.factor_terms(found) if found.is_Add else found


def _size(expression: Expr) -> int:
    return int(expression.count_ops())


def unrated(system: System, expression: Expr) -> Expr:
    """Return an expression over states, parameters and inputs."""
    found = without_rates(system, expression)
    if _size(found) > MAX_OPERATIONS:
        raise InputError("too long")
    return found


def _named(system: System, expression: Expr) -> Expr:
    """Write out rates of states alone, and keep the names of definitions."""
    rates = {q.symbol: r for q, r in zip(system.states, system.rates, strict=True)}

    def plain(e: Expr) -> Expr:
        if isinstance(e, rate):
            return rates.get(e.args[0]) or without_rates(system, e)
        return e.func(*(plain(a) for a in e.args)) if e.args else e

    return plain(expression)


@lru_cache(maxsize=256)
def _expanded(expression: Expr) -> Expr:
    """Return a sum of monomials in sines, cosines and symbols, with as few squares of cosines.

    Raises `InputError` where it would be endless.
    """
    if spread(expression) > MAX_SPREAD:
        raise InputError("too long when it is multiplied out")
    found = sp.expand(sp.expand_trig(expression))
    cosines = sorted(found.atoms(sp.cos), key=sp.default_sort_key)
    return sp.expand(_reduced(found, cosines))


def _reduced(expression: Expr, cosines: list[Expr]) -> Expr:
    """Replace cos^2 by 1 - sin^2 where that cancels something."""
    for c in cosines:
        other = 1 - sp.sin(c.args[0]) ** 2
        tried = sp.expand(
            expression.replace(
                lambda e, c=c: e.is_Pow and e.base == c and e.exp.is_Integer and e.exp > 1,
                lambda e, c=c, other=other: other ** (e.exp // 2) * c ** (e.exp % 2),
            )
        )
        if len(sp.Add.make_args(tried)) < len(sp.Add.make_args(expression)):
            expression = tried
    return expression


def _blamed(motions: Sequence[Motion], left: Expr, right: Expr) -> Leftover | None:
    """Return the term of the writer of which the residual is a multiple; those on the right go first."""
    found = []
    for place, (side, sign) in enumerate(((right, -1), (left, 1))):
        for term, counted in _terms(side):
            ratio = _ratio(motions, left - right, counted)
            if ratio is not None:
                factor = 1 - sign * ratio
                found.append((_rank(factor), place, factor, term))
    if not found or min(f[0] for f in found) > FAR:
        return None
    _, _, factor, term = min(found, key=lambda f: f[:2])
    words = _WORDS.get(factor, f"this should be {factor} times as large: {{}}")
    return Leftover(words, term)


def _terms(side: Expr) -> Iterator[tuple[Expr, Expr]]:
    """Yield the terms of a side, and what each adds to it; the rate of a sum has those of the sum."""
    summed = isinstance(side, rate)
    inner = side.args[0] if summed else side
    terms = [*sp.Add.make_args(inner)]
    if spread(inner) <= MAX_SPREAD:
        terms += sp.Add.make_args(sp.expand_mul(inner))
    for term in dict.fromkeys(terms):
        if not (summed and term == inner):
            yield term, rate(term) if summed else term


_WORDS = {Fraction(-1): "wrong sign: {}", Fraction(0): "does not belong here: {}"}


def _rank(factor: Fraction) -> int:
    """Return how far from plausible a slip is: a sign, then a small factor, a term too much, others."""
    size = abs(factor.numerator) + factor.denominator
    if factor == -1:
        return 0
    return size if factor > 0 else 5 if factor == 0 else 10 + size


def _ratio(motions: Sequence[Motion], residual: Expr, term: Expr) -> Fraction | None:
    """Return the small fraction by which a term makes the residual at all points."""
    found: set[Fraction | None] = set()
    for motion in motions:
        above, below = (motion.series(e).coefficients[0] for e in (residual, term))
        if not below:
            return None
        found.add(_small(above * RESIDUES.inverse(below)))
    return found.pop() if len(found) == 1 else None


def _small(value: int) -> Fraction | None:
    """Return the fraction that an element of the field is; it and its denominator at most `MAX_NUMBER`."""
    found = RESIDUES.fraction(value, MAX_NUMBER)
    return None if found is None or abs(found) > MAX_NUMBER else found
