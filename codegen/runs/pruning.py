"""Keep of a compiled system what requested outputs need: fewer states are then integrated.

A state is needed if a requested result, or the rate of a needed state, depends on it in the program
(`codegen.ir.passes.dependence`), after everything that is fixed was folded away. Constants of
the motion and singular configurations that need a state that is left out are left out with it.

A cyclic angle that is asked for is integrated with the rest. Gauss-Legendre quadrature of order 10
over the dense output of a run without it was tried and costs more (`benchmarks/auto.py`): in generated
C 1.7 to 2.1 times the whole run with the two cyclic angles of the bicycle wheel, as dense output alone
costs more than two rates in each stage, 1.3 times with LSODA, and 1.0 to 1.3 times over functions in NumPy.

Drift: how far constants of the motion wandered, relative to the terms that they are made of.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from codegen.compiling.compiled import TARGETS, Compiled
from codegen.compiling.signals import Followed
from codegen.frontend.attitude import moved
from codegen.frontend.layout import names_of, to_array
from codegen.ir.passes import Slot, dependence, prune, substitute
from codegen.ir.program import INVARIANTS, OUTPUTS, RATES, SINGULARITIES, Program, SameObject
from codegen.native.trajectory import Array, Problem, Trajectory
from codegen.precision import conditioning
from eom.errors import unknown_name


@dataclass(frozen=True)
class Drift:
    """How far a constant of the motion wandered from its first value, over the stored points.

    Parameters
    ----------
    start : float
        The first value, in the unit of the invariant.
    largest : float
        The largest change from it, in the same unit.

    Notes
    -----
    Value less first value. It is relative to the terms that the constant is made of, by
    `codegen.precision.conditioning`: a kinetic energy to itself, a closure of 4e-16 m, or an energy
    near zero, to what cancels in it.

    References
    ----------
    Higham, Accuracy and Stability of Numerical Algorithms (2002), sect. 4.2.
    """

    start: float
    largest: float
    over_time: Array = field(compare=False, repr=False)
    """Value less first value at each stored point, (N,)."""
    terms: Callable[[], float] | None = field(default=None, compare=False, repr=False)
    """Finds the size of the terms, when it is asked for; without it that of the first value counts."""

    @cached_property
    def size(self) -> float:
        """The size of the terms, in the unit of the invariant; zero where all of them are."""
        return abs(self.start) if self.terms is None else self.terms()

    @property
    def scale(self) -> float:
        """What the change is compared with: the size of the terms, or 1 in the unit of the invariant."""
        return self.size if self.size > 0 else 1.0

    @property
    def kind(self) -> str:
        """Whether the drift is relative, to the size of the terms, or absolute, where that is zero."""
        return "relative" if self.size > 0 else "absolute"

    @property
    def relative(self) -> float:
        """The largest change over the scale."""
        return self.largest / self.scale

    def __getstate__(self) -> dict[str, Any]:
        """Pickle and copy the size in the place of what finds it."""
        return {**self.__dict__, "size": self.size, "terms": None}


def drift_of(values: Array, terms: Callable[[], float] | None) -> Drift:
    """Return the drift of a constant of the motion from its values at the stored points."""
    if not values.size:
        return Drift(0.0, 0.0, values)
    change = values - values[0]
    return Drift(float(values[0]), float(np.max(np.abs(change))), change, terms)


@dataclass(frozen=True)
class Terms:
    """What the constants of a run are compared with; found once, when it is first asked for."""

    compiled: Compiled
    problem: Problem
    trajectory: Trajectory
    values: Array
    signals: Followed | None

    def scale(self, k: int) -> float:
        """Return that of one constant, by its number."""
        return float(self.scales[k])

    @cached_property
    def scales(self) -> Array:
        """One a constant of the motion, in its unit."""
        t, y = self.trajectory.t, self.trajectory.y
        chosen = np.unique(np.linspace(0, len(t) - 1, conditioning.POINTS).round().astype(int))
        u = self.problem.inputs
        if self.signals is not None:
            u = self.signals.along(t[chosen], y[:, chosen])
        sizes, p = conditioning.Sizes(self.compiled), self.problem.parameters
        at = t[chosen], y[:, chosen], p, u
        with np.errstate(all="ignore"):
            terms, reach = sizes.terms(*at), sizes.reach(*at)
        return conditioning.scale_of(terms, self.values[:, chosen] - self.values[:, :1], reach)


@dataclass(frozen=True)
class Part:
    """A smaller compiled system, and the names of states and constants of the motion without it."""

    whole: Compiled
    compiled: Compiled
    left_out: tuple[str, ...]

    def start(self, initial: Any) -> Any:
        """Return the initial values of what is left, of values by name or of all states in order."""
        if self.whole is self.compiled:
            return initial
        names, kept = names_of(self.whole.layout.states), names_of(self.compiled.layout.states)
        if not isinstance(initial, Mapping):
            values = to_array(initial, names, "initial value")
            return {n: v for n, v in zip(names, values.tolist(), strict=True) if n in kept}
        return {n: v for n, v in initial.items() if n in kept or n not in names}


def part(compiled: Compiled, names: Sequence[str] | None) -> Part:
    """Return what the states and outputs ``names`` need of a compiled system, made once; None: all.

    Raises `InputError` for names that are neither.
    """
    if names is None:
        return Part(compiled, compiled, ())
    known = (*names_of(compiled.layout.states), *compiled.layout.results[OUTPUTS])
    for name in names:
        if name not in known:
            raise unknown_name("state or output", name, known)
    return _part_once(SameObject(compiled), tuple(n for n in known if n in set(names)))


@lru_cache(maxsize=64)
def _part_once(key: SameObject[Compiled], names: tuple[str, ...]) -> Part:
    whole = key.value
    layout = whole.layout
    kept, results = _kept(whole.program, whole, names)
    left_out = [n for k, n in enumerate(names_of(layout.states)) if k not in kept]
    left_out += [
        n for k, n in enumerate(layout.results[INVARIANTS]) if k not in results[INVARIANTS]
    ]
    if len(kept) == len(layout.states) and len(results[OUTPUTS]) == len(layout.results[OUTPUTS]):
        return Part(whole, whole, ())
    return Part(whole, _smaller(whole, kept, results, names), tuple(left_out))


def _kept(
    program: Program, whole: Compiled, names: Collection[str]
) -> tuple[list[int], dict[str, list[int]]]:
    """Return the places of the states and of the results of each group that stay."""
    layout = whole.layout
    reads = {
        group: [{s for r, s in dependence(program, group) if r == row} for row in range(len(found))]
        if (found := layout.results[group])
        else []
        for group in (RATES, OUTPUTS, INVARIANTS, SINGULARITIES)
    }
    outputs = [k for k, n in enumerate(layout.results[OUTPUTS]) if n in names]
    stack = [k for k, n in enumerate(names_of(layout.states)) if n in names]
    stack += [s for k in outputs for s in sorted(reads[OUTPUTS][k])]
    kept: set[int] = set()
    while stack or not kept:
        k = stack.pop() if stack else 0
        if k not in kept:
            kept.add(k)
            stack += sorted(reads[RATES][k])
    results = {g: [k for k, r in enumerate(reads[g]) if r <= kept] for g in reads}
    return sorted(kept), {**results, RATES: sorted(kept), OUTPUTS: outputs}


def _smaller(
    whole: Compiled, kept: Sequence[int], results: Mapping[str, Sequence[int]], names: Sequence[str]
) -> Compiled:
    """Compile the part of a program; the states that stay close ranks, in order."""
    layout, system = whole.layout, whole.system
    places = {
        g: tuple(whole.program.results[g][k] for k in rows) for g, rows in results.items() if rows
    }
    leaves: dict[Slot, Slot | Fraction] = {
        ("state", k): ("state", new) for new, k in enumerate(kept)
    }
    program = substitute(prune(replace(whole.program, results=places)), leaves)
    place = {k: new for new, k in enumerate(kept)}
    smaller = replace(
        layout,
        states=tuple(layout.states[k] for k in kept),
        results={
            **layout.results,
            **{g: tuple(layout.results[g][k] for k in rows) for g, rows in results.items()},
        },
        coordinates=tuple(place.get(layout.coordinates[k], -1) for k in results[SINGULARITIES]),
        attitudes=moved(layout.attitudes, leaves, ("state",)),
    )
    target, functions, notice = TARGETS[whole.target](program, smaller)
    singularities = tuple(system.singularities[k] for k in results[SINGULARITIES])
    return Compiled(
        replace(system, singularities=singularities),
        smaller,
        program,
        target,
        whole.structure,
        functions,
        notice or whole.notice,
        origin=(_again, (whole, tuple(names))),
        stable=whole.stable,
    )


def _again(whole: Compiled, names: tuple[str, ...]) -> Compiled:
    return part(whole, names).compiled
