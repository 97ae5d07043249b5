"""Whether an equation follows from others: it is a sum of multiples of them and of their derivatives.

With r and s the differences of both sides (components in B), the test looks for constants c such that
r = sum of c m D s, where D is 1, d/dt or d2/dt2 and m runs over products of quantities with the right
dimension. The c are solved for in exact random worlds, with more equations than unknowns; a solution is
a certificate, up to the chance of worlds, that r = 0 wherever all s = 0. Where there is none, nothing is
said.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations_with_replacement, islice, product
from typing import Any

import sympy as sp

from eom.checker.judge.models import equations, terms_of
from eom.checker.judge.systems import Pair, Solutions
from eom.checker.mean.claims import Claim
from eom.checker.mean.dimensions import NONE, RATE, Dimension, of_quantity
from eom.errors import InputError
from eom.exact import series
from eom.exact.series import Series
from eom.fields import RESIDUES, Echelon, Singular, solve
from eom.terms.terms import INDICES, Equation, Term, nodes
from eom.terms.vocabulary import omega, position, quantity
from eom.worlds.evaluate import Env, Evaluator, flat
from eom.worlds.generators import world
from eom.worlds.solutions import Motion, anything
from eom.worlds.solutions import order as order_of

MAX_UNKNOWNS = 80
"""Multiples that are tried at most, the simplest first."""
SPARE = 8
"""Equations beyond the number of unknowns."""
MAX_WORLDS = 120
MAX_FACTORS = 2
_ORDERS = 2
"""Derivatives of a premise that are tried."""

Measured = tuple[Dimension | None, tuple[Series, ...]]
"""Some components with their dimension, None where it is unknown."""
Factor = tuple[Dimension | None, Series]


def follows(
    claim: Claim,
    premises: Sequence[Claim],
    assumed: frozenset[str],
    unknowns: int = MAX_UNKNOWNS,
) -> bool:
    """Return whether a claim is a sum of multiples of premises in the worlds of a closed set.

    ``unknowns``: multiples that are tried at most, the simplest first. What a claim says by itself follows
    from anything. False where nothing was found, or a claim has no value in these worlds.
    """
    try:
        said = _Said(claim, tuple(premises))
        return bool(said.right) and _solvable(said, assumed, unknowns)
    except InputError:
        return False


def implied_on_solutions(claim: Claim, premise: Claim) -> bool | None:
    """Return whether a claim about a system holds wherever a premise does that ties what is any to it.

    Coefficients of the functions of time that are any are chosen so that the premise holds at a point,
    which is possible where it depends on them linearly: a law of control by the motion that is desired.
    None where nothing can be chosen, and where what fails has more derivatives than the premise, which
    holds at the point alone.
    """
    try:
        first, then = (Solutions(c, c.scalars) for c in (premise, claim))
        found = {_holds_there(m, first.said, then.said) for m in _points(first, then)}
        orders = [max(order_of(e) for pair in c.said for e in pair) for c in (first, then)]
    except (InputError, Singular):
        return None
    if not found or None in found or (False in found and orders[1] > orders[0]):
        return None
    return False not in found


def _points(first: Solutions, then: Solutions) -> Iterator[Motion]:
    """Yield solutions that are long enough for both claims, and that no other claim shares."""
    length = max(first.length, then.length)
    for seed in range(MAX_WORLDS // 40):
        yield Motion(first.model.system, length, seed, first.model.given)


def _holds_there(m: Motion, premise: Sequence[Pair], claim: Sequence[Pair]) -> bool | None:
    """Return whether a claim holds at a point at which the premise is made to; None where it cannot be."""

    def apart(pairs: Sequence[Pair]) -> list[int]:
        return [int((m.series(a) - m.series(b)).coefficients[0]) for a, b in pairs]

    free = {n for pair in premise for e in pair for n in e.atoms(anything) if int(n.args[1])}
    start = apart(premise)
    columns: list[tuple[Any, int, int, list[int]]] = []
    for node, k in product(sorted(free, key=str), reversed(range(m.length))):
        old = int(m.series(node).coefficients[k])
        m.choose(node, k, old + 1)
        slope = [a - b for a, b in zip(apart(premise), start, strict=True)]
        m.choose(node, k, old)
        if any(slope) and all(node != c[0] for c in columns):
            columns.append((node, k, old, slope))
    if len(columns) != len(start):
        return None
    rows = [[c[3][r] for c in columns] for r in range(len(start))]
    steps = solve(rows, [-s for s in start], RESIDUES)
    for (node, k, old, _), step in zip(columns, steps, strict=True):
        m.choose(node, k, old + int(step))
    return None if any(apart(premise)) else not any(apart(claim))


def parts(claim: Claim, assumed: frozenset[str], count: int = 2) -> tuple[tuple[int, ...], ...]:
    """Return the components of each member at t = 0 in some worlds of a closed set.

    Raises `InputError` where the claim has no value, `Singular` where a world leaves it undefined.
    """
    found: list[list[int]] = [[] for _ in claim.members]
    for seed in range(count):
        e = Evaluator(world(assumed, seed), claim.scalars)
        free = frozenset().union(*(e.labels(m.term) for m in claim.members))
        env: Env = next(e.numberings(free), {})
        for values, member in zip(found, claim.members, strict=True):
            values += [s.coefficients[0] for s in _components(e, member.term, env)]
    return tuple(tuple(v) for v in found)


@dataclass
class _Said:
    """A claim and the premises, with what their terms are made of."""

    claim: Claim
    premises: tuple[Claim, ...]
    right: tuple[Equation, ...] = field(init=False)
    chosen: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.right = equations(self.claim)

    @cached_property
    def scalars(self) -> dict[Any, Term]:
        """What the symbols of SymPy stand for, in all claims."""
        known: dict[Any, Term] = {}
        for c in (self.claim, *self.premises):
            known |= c.scalars
        return known

    @cached_property
    def factors(self) -> tuple[tuple[Dimension | None, Term], ...]:
        """Quantities whose components may multiply a premise."""
        found: dict[Term, Dimension | None] = {}
        for term in self._terms():
            for node in nodes(term):
                if node.head == "expr":
                    found.update((e, d) for e, d in self._parts(node.data[0]))
                elif node.head == "atom" and not INDICES & node.labels:
                    found[node] = of_quantity(node.data[0])
        if any("body" in n.data or n.data[:1] == ("inertia",) for n in found if n.data):
            found |= {omega(): RATE, quantity("inertia", "C"): of_quantity("inertia")}
        return tuple((d, t) for t, d in found.items() if t.data[:1] not in _PLAIN)

    def distinct(self, factors: Sequence[Factor]) -> list[Factor]:
        """Return factors without zeros, constants and repetitions, the same ones in all worlds."""
        if not self.chosen:
            kept: dict[tuple[Any, ...], int] = {}
            for n, (_, s) in enumerate(factors):
                if any(s.coefficients) and s.coefficients[:2] != (1, 0):
                    kept.setdefault(s.coefficients, n)
            self.chosen = list(kept.values())
        return [factors[n] for n in self.chosen]

    def _terms(self) -> Iterator[Term]:
        return (t for c in (self.claim, *self.premises) for t in terms_of(c))

    def _parts(self, expression: Any) -> Iterator[tuple[Term, Dimension | None]]:
        """Yield sines and cosines, and what stands below a fraction."""
        for part in sp.preorder_traversal(expression):
            if isinstance(part, sp.sin | sp.cos):
                yield Term("expr", (), (part,)), NONE
            elif part.is_Pow and part.exp.is_Integer and part.exp < 0:
                below = part.base
                measure = of_quantity(self._name(below)) if below.is_Symbol else None
                measure = NONE if isinstance(below, sp.cos | sp.sin) else measure
                inverse = None if measure is None else measure.power(-1)
                yield Term("expr", (), (1 / below,)), inverse

    def _name(self, symbol: Any) -> str:
        """Return the quantity that a symbol is a component of."""
        inside = nodes(self.scalars[symbol]) if symbol in self.scalars else iter(())
        return next(
            (str(n.data[0]) for n in inside if n.head == "atom" and n.data[0] != "unit"), ""
        )


_PLAIN = {(n,) for n in ("unit", "identity", "identity_matrix", "rotation", "angle", "rotor_axis")}
"""Quantities that are no factors."""


def _measure(claim: Claim) -> Dimension | None:
    known = (m.dimension for m in claim.members if not m.is_zero and m.dimension is not None)
    return next(known, None)


def _solvable(said: _Said, assumed: frozenset[str], unknowns: int) -> bool:
    """Return whether the equations of enough worlds have a solution."""
    form, count = None, 0
    for seed in range(MAX_WORLDS):
        try:
            differences, multiples = _sample(said, assumed, seed, unknowns)
        except Singular:
            continue
        form = form or Echelon(RESIDUES, len(multiples))
        if form.width != len(multiples):
            return False
        for row in _equations((*multiples, *differences)):
            count += 1
            if not form.add(row):
                return False
            if count >= form.width + SPARE:
                return True
    return False


def _sample(
    said: _Said, assumed: frozenset[str], seed: int, unknowns: int
) -> tuple[tuple[Series, ...], list[Series]]:
    """Return the differences of the claim, and all multiples of the premises, in one world."""
    e = Evaluator(world(assumed, seed), said.scalars)
    wanted = _measure(said.claim)
    env: Env = next(e.numberings(_free(e, said.claim)), {})
    differences = tuple(s for q in said.right for s in _difference(e, q, env))
    factors = said.distinct([(d, s) for d, t in said.factors for s in _components(e, t, {})])
    given = [g for p in said.premises for g in _derivatives(_given(e, p, env))]
    return differences, list(islice(_multiples(wanted, given, factors), unknowns))


def _free(e: Evaluator, claim: Claim) -> frozenset[str]:
    found = (e.labels(t) for q in equations(claim) for t in (q.left, q.right))
    return frozenset().union(*found)


def _difference(e: Evaluator, q: Equation, env: Env) -> tuple[Series, ...]:
    left, right = _components(e, q.left, env), _components(e, q.right, env)
    return tuple(a - b for a, b in zip(left, right, strict=True))


def _components(e: Evaluator, term: Term, env: Env) -> tuple[Series, ...]:
    """Return the components of a value: of vectors and dyadics those in B."""
    value = e.value(term, env)
    if term.kind in {"vector", "dyadic"}:
        turn = e.world.rotation("B", "I")
        if isinstance(value[0], Series):
            value = series.apply(turn, value)
        else:
            value = series.product(series.product(turn, value), series.transpose(turn))
    return tuple(flat(value))


def _given(e: Evaluator, premise: Claim, env: Env) -> Iterator[Measured]:
    """Yield what a premise says to be zero; of parts that the claim does not number, sums."""
    free = _free(e, premise) & INDICES
    measure = _measure(premise)
    for q in equations(premise):
        if free <= set(env):
            yield measure, _difference(e, q, env)
            continue
        each = [(n, _difference(e, q, n)) for n in e.numberings(_free(e, premise))]
        yield measure, _added([s for _, s in each])
        index = min(free)
        if q.left.kind == "vector" and len(free) == 1 and index != "k":
            arms = [_components(e, position(index, "O"), n) for n, _ in each]
            crossed = [_crossed(a, s) for a, (_, s) in zip(arms, each, strict=True)]
            yield (measure.times(_ARM) if measure else None), _added(crossed)


_ARM = of_quantity("position") or NONE


def _added(values: Sequence[tuple[Series, ...]]) -> tuple[Series, ...]:
    return tuple(series.total(list(column)) for column in zip(*values, strict=True))


def _crossed(a: tuple[Series, ...], b: tuple[Series, ...]) -> tuple[Series, ...]:
    return series.cross((a[0], a[1], a[2]), (b[0], b[1], b[2]))


def _derivatives(given: Iterable[Measured]) -> Iterator[tuple[int, Measured]]:
    """Yield what is zero, and its derivatives, with their orders."""
    for now in given:
        for order in range(_ORDERS + 1):
            if any(len(s.coefficients) < 2 for s in now[1]):
                break
            yield order, now
            now = _rate(now)  # noqa: PLW2901 - the next one in the row


def _rate(now: Measured) -> Measured:
    measure, values = now
    rate = None if measure is None else measure.times(RATE)
    return rate, tuple(s.derivative() for s in values)


def _multiples(
    wanted: Dimension | None,
    given: Sequence[tuple[int, Measured]],
    factors: Sequence[Factor],
) -> Iterator[Series]:
    """Yield the multiples of the right dimension: by numbers, by one factor, by two."""
    given = sorted(given, key=lambda g: g[0])
    for count in range(MAX_FACTORS + 1):
        for chosen in combinations_with_replacement(factors, count):
            for _, (measure, parts) in given:
                if _fits(wanted, [measure, *(d for d, _ in chosen)], count):
                    for part in parts:
                        yield _product([s for _, s in chosen], part)


def _fits(wanted: Dimension | None, factors: Sequence[Dimension | None], count: int) -> bool:
    """Return whether a product may have a dimension; unknown ones are not multiplied twice."""
    if wanted is None or None in factors:
        return count < 2
    product = NONE
    for d in factors:
        product = product.times(d or NONE)
    return product == wanted


def _product(factors: Sequence[Series], start: Series) -> Series:
    for s in factors:
        start = start * s
    return start


def _equations(values: Sequence[Series]) -> Iterator[tuple[Any, ...]]:
    """Yield the coefficients of all multiples and differences, order by order."""
    return zip(*(s.coefficients for s in values), strict=False)
