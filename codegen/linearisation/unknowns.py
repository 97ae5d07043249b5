"""The equations of steady states: rates that vanish, values that are held, quaternions of length 1.

Derivatives of a program at one point, by carrying them along with the values; nothing is generated.

For a single point this is sooner done than deriving and compiling a Jacobian (`linearise`), which pays
from some hundreds of points on. Partial derivatives are those of the table of operations.

A steady state, and which states may run together in a steady motion.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import mpmath
import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled
from codegen.frontend.layout import names_of
from codegen.ir.interpret import UNIT_ROUNDOFF, Point, constants, evaluated, interpret_with_bound
from codegen.ir.linsolve import Shape, whole
from codegen.ir.ops import Instruction, row_of
from codegen.ir.passes import needed, prune
from codegen.ir.program import INVARIANTS, OUTPUTS, RATES, Program


@dataclass(frozen=True)
class Equilibrium:
    """A state with zero rates, or a steady motion.

    Parameters
    ----------
    states, inputs, parameters : mapping of str to floats
        Values by name.
    residual : float
        The largest rate that should be zero, in its unit.
    relative : float
        The same by the terms that it is made of.
    worst : str
        The state whose rate that is.
    unknowns : int
        Of the equations.
    rank : int
        Of the equations.
    kind : str
        ``isolated`` if the rank is full; ``family`` if other solutions lie beside it; else
        ``degenerate``: it stands alone as far as was seen, but few of its digits are certain.
    directions : tuple of mapping of str to floats, optional
        Along which a family goes on, by name, one mapping a dimension.
    rates : mapping of str to floats, optional
        Of the cyclic states, which may run, by name.

    Notes
    -----
    Units are those of the system.
    """

    states: Mapping[str, float]
    inputs: Mapping[str, float]
    parameters: Mapping[str, float]
    residual: float
    relative: float
    worst: str
    unknowns: int
    rank: int
    kind: str
    directions: tuple[Mapping[str, float], ...] = ()
    rates: Mapping[str, float] | None = None

    @property
    def isolated(self) -> bool:
        """Whether no other solution is near."""
        return self.kind == "isolated"

    @property
    def cyclic(self) -> tuple[str, ...]:
        """The states that may run."""
        return tuple(self.rates or ())


def together(reads: Collection[tuple[int, int]], own: set[int]) -> Iterator[tuple[int, ...]]:
    """Yield states that may run together, few first: no rate of another state depends on them.

    ``reads``: (row, state) wherever a rate depends on a state; ``own``: those that are looked for. Not all
    of these are yielded at once.
    """
    sets = [c for c in (_closure(k, reads) for k in sorted(own)) if c <= own]
    for most in sorted({len(c) for c in sets}):
        running = set[int]().union(*(c for c in sets if len(c) <= most))
        if len(running) < len(own):
            yield tuple(sorted(running))


def _closure(state: int, reads: Collection[tuple[int, int]]) -> set[int]:
    """Return a state and those whose rates it has to do with, directly or by others."""
    found, stack = set[int](), [state]
    while stack:
        k = stack.pop()
        if k not in found:
            found.add(k)
            stack += [row for row, slot in reads if slot == k]
    return found


Array = NDArray[np.float64]

_LONGER = frozenset({"besselj", "bessely", "stumpff", "table", "erf", "erfc", "mod"})
"""Operations whose derivatives are computed with some digits more than doubles have."""


class Carried(NamedTuple):
    """A value and its derivatives: numbers and vectors; of linear systems, arrays and one axis more."""

    value: Any
    slope: Any


def tangents(
    program: Program, groups: Iterable[str], by: Sequence[Instruction], point: Point
) -> tuple[Array, Array]:
    """Return the results of groups, one after the other, and their derivatives: (results, leaves).

    ``by``: leaves to differentiate by. Where an operation has no value, NaN.
    """
    names = list(groups)
    units = dict(zip(by, np.eye(len(by)), strict=True))
    known = {k: Carried(np.float64(value), 0.0) for k, value in constants(program).items()}

    def leaf(instruction: Instruction) -> Carried:
        return Carried(np.float64(point.slot(instruction)), units.get(instruction, 0.0))

    with np.errstate(all="ignore"):
        carried = evaluated(program, leaf, _operation, known, sorted(needed(program, names)))
    found = [carried[k] for name in names for k in program.results[name]]
    slopes = [np.broadcast_to(c.slope, len(by)) for c in found]
    values = np.array([c.value for c in found], dtype=np.float64)
    return values, np.array(slopes, dtype=np.float64).reshape(len(found), len(by))


def _operation(instruction: Instruction, args: Sequence[Carried]) -> Carried:
    if instruction.op in _SOLVING:
        return _SOLVING[instruction.op](instruction, args)
    row = row_of(instruction)
    value = row.double(*(a.value for a in args))
    varying = [k for k, a in enumerate(args) if isinstance(a.slope, np.ndarray)]
    if not varying:
        return Carried(value, 0.0)
    m = _digits() if instruction.op in _LONGER else mpmath.fp
    try:
        partials = row.partials(m, m.mpf(value), *(m.mpf(a.value) for a in args))
        slope = sum(float(partials[k]) * args[k].slope for k in varying)
    except (ValueError, ZeroDivisionError, OverflowError, TypeError):
        slope = np.nan * args[varying[0]].slope
    return Carried(value, slope)


@lru_cache(maxsize=1)
def _digits() -> Any:
    context = mpmath.mp.clone()
    context.dps = 20
    return context


def _factor(instruction: Instruction, args: Sequence[Carried]) -> Carried:
    shape = instruction.value
    assert isinstance(shape, Shape)
    values = np.array(whole(shape, [a.value for a in args]), dtype=np.float64)
    return Carried(
        values, _stacked([c.slope for row in whole(shape, args) for c in row], values.shape)
    )


def _back(instruction: Instruction, args: Sequence[Carried]) -> Carried:  # noqa: ARG001
    """Return x = A^-1 b and dx = A^-1 (db - dA x)."""
    matrix, *right = args
    b = np.array([r.value for r in right], dtype=np.float64)
    db = _stacked([r.slope for r in right], b.shape)
    try:
        x = np.linalg.solve(matrix.value, b)
        slopes = np.broadcast_to(
            np.einsum("ijk,j->ik", matrix.slope, x), _wider(matrix.slope, db, b)
        )
        return Carried(x, np.linalg.solve(matrix.value, db - slopes))
    except np.linalg.LinAlgError:
        return Carried(np.nan * b, np.nan * db)


def _wider(dA: Array, db: Array, b: Array) -> tuple[int, int]:
    return (len(b), max(dA.shape[-1], db.shape[-1]))


def _item(instruction: Instruction, args: Sequence[Carried]) -> Carried:
    (solution,) = args
    place = instruction.slot
    return Carried(solution.value[place], solution.slope[place])


def _stacked(slopes: Sequence[Any], shape: tuple[int, ...]) -> Array:
    """Return derivatives of entries as one array, the leaves last; one zero where nothing varies."""
    count = max((len(s) for s in slopes if isinstance(s, np.ndarray)), default=1)
    return np.array([np.broadcast_to(s, count) for s in slopes]).reshape(*shape, count)


_Rule = Callable[[Instruction, Sequence[Carried]], Carried]
_SOLVING: Mapping[str, _Rule] = {
    "factor": _factor,
    "back": _back,
    "item": _item,
}


class Equations:
    """What should be zero, over all states and inputs, with derivatives.

    ``rows``: the states whose rates vanish. ``conditions``: values of outputs and invariants.
    ``units``: places of quaternions among the states.
    """

    def __init__(
        self,
        compiled: Compiled,
        p: Array,
        rows: Sequence[int],
        conditions: Mapping[str, float],
        units: Sequence[Sequence[int]],
    ) -> None:
        self.compiled, self.p, self.rows, self.units = compiled, p, list(rows), units
        states = names_of(compiled.layout.states)
        groups = {g: compiled.layout.results[g] for g in (OUTPUTS, INVARIANTS)}
        self.held = [
            (g, [n for n in names if n in conditions], [names.index(n) for n in names if n in conditions])
            for g, names in groups.items()
        ]  # fmt: skip
        self.held = [h for h in self.held if h[1]]
        self.targets = [np.array([conditions[n] for n in names]) for _, names, _ in self.held]
        self.labels = [
            *(states[k] for k in self.rows),
            *(n for _, names, _ in self.held for n in names),
            *(f"norm of {', '.join(states[k] for k in four)}" for four in units),
        ]

    def value(self, x: Array, u: Array) -> Array:
        """Return what should be zero."""
        parts = [self.compiled.rhs(0.0, x, self.p, u)[self.rows]]
        for (group, _, places), target in zip(self.held, self.targets, strict=True):
            parts.append(self.compiled.functions[group](0.0, x, self.p, u)[places] - target)
        parts.append(np.array([(x[list(four)] ** 2).sum() - 1 for four in self.units]))
        return np.concatenate(parts)

    def rates(self, x: Array, u: Array) -> Array:
        """Return the derivatives of all rates by states, then inputs."""
        point = Point(0.0, list(x), list(self.p), list(u))
        found: Array = tangents(self.compiled.program, [RATES], leaves_of(x.size, u.size), point)[1]
        return found

    def rounding(self, x: Array, u: Array) -> Array:
        """Return how much rounding may make of each equation, by a running error analysis.

        States and inputs are taken to be rounded, but for zeros. See `codegen.ir.interpret`.
        """
        point = Point(0.0, list(x), list(self.p), list(u))
        found = interpret_with_bound(self._program, point)
        own = [found[RATES][k].error for k in self.rows]
        own += [found[group][k].error for group, _, places in self.held for k in places]
        own += [4 * UNIT_ROUNDOFF] * len(self.units)
        given = np.abs(self(x, u)[1]) @ np.abs(np.concatenate([x, u]))
        return np.asarray(np.array(own) + UNIT_ROUNDOFF * given)

    @cached_property
    def _program(self) -> Program:
        return prune(self.compiled.program, [RATES, *(group for group, _, _ in self.held)])

    def __call__(self, x: Array, u: Array) -> tuple[Array, Array]:
        """Return what should be zero, and its derivatives by states, then inputs."""
        leaves = leaves_of(x.size, u.size)
        groups = [RATES, *(group for group, _, _ in self.held)]
        found, J = tangents(
            self.compiled.program, groups, leaves, Point(0.0, list(x), list(self.p), list(u))
        )
        rows, start = list(self.rows), x.size
        for group, _, places in self.held:
            rows += [start + k for k in places]
            start += len(self.compiled.program.results[group])
        norms = np.zeros((len(self.units), x.size + u.size))
        for k, four in enumerate(self.units):
            norms[k, list(four)] = 2 * x[list(four)]
        targets = [np.zeros(len(self.rows)), *self.targets]
        lengths = [(x[list(four)] ** 2).sum() - 1 for four in self.units]
        return np.append(found[rows] - np.concatenate(targets), lengths), np.vstack(
            [J[rows], norms]
        )


def maintained(compiled: Compiled) -> tuple[str, ...]:
    """Return the invariants that constraints keep at zero."""
    known = compiled.layout.results[INVARIANTS]
    return tuple(n for n in compiled.system.maintained if n in known)


def leaves_of(states: int, inputs: int) -> list[Instruction]:
    """Return the leaves of all states, then all inputs."""
    return [
        Instruction(kind, (), k)
        for kind, n in (("state", states), ("input", inputs))
        for k in range(n)
    ]
