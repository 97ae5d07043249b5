"""States in which nothing changes, and steady motions, found numerically for any compiled system.

    found = equilibrium(compiled, {"theta": 0.1, "omega": 0.0}, parameters)
    trim = equilibrium(compiled, guess, parameters, free=["thrust"], hold={"height": 100.0})
    steady = equilibrium(compiled, guess, parameters, cyclic=["phi"], hold={"spin": 20.0})

Newton's method (`codegen.newton`) with derivatives of the program (`codegen.tangents`); where the equations
leave a family of solutions open, it goes to a near one. Unit quaternions among the states
(`codegen.quaternions`) stay unit ones. What is found is told with its residual, and with the rank of the
Jacobian: whether it stands alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from codegen import newton
from codegen.compiled import Compiled
from codegen.derivative import dependence
from codegen.layout import names_of, to_array
from codegen.lower import INVARIANTS, OUTPUTS, RATES
from codegen.quaternions import candidates
from codegen.unknowns import Equations, maintained
from eom.errors import InputError, near_matches, unknown_name

Array = NDArray[np.float64]

ALIKE = 1e-6
"""Solutions closer than this, relative to their size, are one."""
DEGENERATE = "degenerate"
CERTAIN = 1e-9
"""Where Newton's method would still go farther than this, the place of a solution is not certain."""
NEAR, NEAR_POINTS = 0.3, 6
"""How far from the guess derivatives are looked at for their size, and at how many points."""
FAMILY_STEP = 1e-3
"""How far along a family another member is looked for, relative to the size of the solution."""


@dataclass(frozen=True)
class Equilibrium:
    """A state with zero rates, or a steady motion.

    ``states``, ``inputs``, ``parameters``: values by name. ``residual``: the largest rate that should be
    zero, in its unit, that of the state ``worst``; ``relative``: the same by the terms that it is made of.
    ``unknowns``, ``rank``: of the equations. ``kind``: ``isolated`` if the rank is full; ``family`` if
    other solutions lie beside it, along ``directions`` (by name, one mapping a dimension); else
    ``degenerate``: it stands alone as far as was seen, but few of its digits are certain.
    ``rates``: of the cyclic states, which may run, by name.
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


def equilibrium(
    compiled: Compiled,
    guess: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | Sequence[float] | None = None,
    *,
    inputs: Mapping[str, float] | None = None,
    free: Iterable[str] = (),
    cyclic: Iterable[str] = (),
    hold: Mapping[str, float] | None = None,
    starts: int = 24,
    seed: int = 0,
    spread: float = 1.0,
) -> Equilibrium:
    """Return the first solution that is found: from the guess, else from points around it.

    ``guess``: states by name, 0 where left out (1 in a quaternion's first place). ``parameters``:
    numbers by name or in order. ``inputs``: their values, 0 where left out; those in ``free`` are looked
    for, from there. ``cyclic``: states that may run, on which no other rate depends. ``hold``: values of
    states, outputs or invariants that the solution must have; the constraints that the system maintains
    are met anyhow. ``starts``, ``seed``, ``spread``: how many points are tried, drawn how, how far from
    the guess (by its size, at least 1). The same arguments give the same result. Units are those of the
    system. Raises `InputError` where nothing is found, for unknown names, and for rates that depend on
    time. Source: Newton's method with steps of least size, Ben-Israel, J. Math. Anal. Appl. 15 (1966)
    243.

    >>> import sympy as sp, codegen, eom
    >>> q, u = sp.symbols("q u", real=True)
    >>> arm = codegen.compile(eom.System.from_rates("arm", {q: u, u: sp.cos(q) - u}), "numpy")
    >>> found = equilibrium(arm, {"q": 1.0})
    >>> found.kind, round(found.states["q"], 6)
    ('isolated', 1.570796)
    """
    search = _Search(compiled, guess, parameters, inputs, free, cyclic, hold)
    for start in search.starts(starts, seed, spread):
        found = search.solve(start)
        if found is not None:
            return search.told(search.wrapped(found))
    raise search.nothing(starts)


def equilibria(
    compiled: Compiled,
    guess: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | Sequence[float] | None = None,
    *,
    inputs: Mapping[str, float] | None = None,
    free: Iterable[str] = (),
    cyclic: Iterable[str] = (),
    hold: Mapping[str, float] | None = None,
    starts: int = 24,
    seed: int = 0,
    spread: float = 1.0,
) -> tuple[Equilibrium, ...]:
    """Return all solutions that are found from so many points, each once; see `equilibrium`.

    Arguments, units, errors (`InputError`) and source as there.
    Nearest to the guess first; angles are within half a turn of it where that changes nothing. Of families,
    single members are told. None of this says that there are no others.

    >>> import sympy as sp, codegen, eom
    >>> x = sp.Symbol("x", real=True)
    >>> logistic = codegen.compile(eom.System.from_rates("logistic", {x: x * (1 - x)}), "numpy")
    >>> [round(found.states["x"], 6) for found in equilibria(logistic, {"x": 0.9})]
    [1.0, 0.0]
    """
    search = _Search(compiled, guess, parameters, inputs, free, cyclic, hold)
    found: list[Array] = []
    for start in search.starts(starts, seed, spread):
        z = search.solve(start)
        if z is None:
            continue
        z = search.wrapped(z)
        if not any(_alike(z, other) for other in found):
            found.append(z)
    if not found:
        raise search.nothing(starts)
    told = [search.told(z) for z in sorted(found, key=search.distance)]
    families = [e for e in told if e.kind == "family"][:1]
    return tuple(e for e in told if e.kind != "family" or e in families)


def _alike(a: Array, b: Array) -> bool:
    return bool(np.max(np.abs(a - b), initial=0.0) <= ALIKE * (1 + np.max(np.abs(a), initial=0.0)))


class _Search:
    """What is looked for, and the way there; vectors hold the unknowns: states, then inputs."""

    def __init__(
        self,
        compiled: Compiled,
        guess: Mapping[str, float] | None,
        parameters: Mapping[str, float] | Sequence[float] | None,
        inputs: Mapping[str, float] | None,
        free: Iterable[str],
        cyclic: Iterable[str],
        hold: Mapping[str, float] | None,
    ) -> None:
        layout = compiled.layout
        self.compiled, self.name = compiled, f"system {layout.name!r}"
        states, self.inputs = names_of(layout.states), names_of(layout.inputs)
        self.p = to_array(parameters, names_of(layout.parameters), "parameter")
        if dependence(compiled.program, RATES, "time"):
            raise InputError("the rates depend on time: nothing is steady", where=self.name)
        free = self._names(free, "input", self.inputs)
        self.cyclic = cyclic = self._names(cyclic, "state", states)
        hold = dict.fromkeys(maintained(compiled), 0.0) | dict(hold or {})
        fours = [orders[0] for orders in candidates(compiled.program, len(states))]
        self.x = _start(guess or {}, states, fours)
        self.u = to_array(
            dict.fromkeys(self.inputs, 0.0) | dict(inputs or {}), self.inputs, "input"
        )
        held = self._held(hold, states, cyclic)
        moving = [n for n in states if n not in held and n not in cyclic]
        self.labels = [*states, *self.inputs]
        self.unknowns = [self.labels.index(n) for n in (*moving, *free)]
        conditions = {n: v for n, v in hold.items() if n not in states}
        units = [f for f in fours if set(f) & {states.index(n) for n in moving}]
        rows = [k for k, n in enumerate(states) if n not in cyclic]
        self.equations = Equations(compiled, self.p, rows, conditions, units)
        self.speeds = [q.unit.endswith("/s") for q in layout.states] + [False] * len(self.inputs)
        self.angles = [q.unit == "rad" for q in layout.states] + [False] * len(self.inputs)
        if not self.unknowns:
            raise InputError(
                "nothing is left to be found", where=self.name, hint="hold fewer states"
            )

    def _names(self, given: Iterable[str], kind: str, known: Sequence[str]) -> tuple[str, ...]:
        names = (given,) if isinstance(given, str) else tuple(given)
        for name in names:
            if name not in known:
                raise unknown_name(kind, name, known, self.name)
        return names

    def _held(
        self, hold: Mapping[str, float], states: Sequence[str], cyclic: Sequence[str]
    ) -> set[str]:
        """Put held states to their values and return their names. Raises `InputError`."""
        results = self.compiled.layout.results
        known = (*states, *results[OUTPUTS], *results[INVARIANTS])
        for name, value in hold.items():
            if name not in known:
                raise InputError(
                    f"{name!r} cannot be held", where=self.name, got=name,
                    expected="a state, an output or an invariant", hint=near_matches(name, known),
                )  # fmt: skip
            if not np.isfinite(value):
                raise InputError("not a finite number", where=f"{self.name}: {name}", got=value)
            if name in cyclic:
                raise InputError("a cyclic state is not held", where=self.name, got=name)
            if name in states:
                self.x[states.index(name)] = value
        return set(hold) & set(states)

    def starts(self, count: int, seed: int, spread: float) -> Iterable[Array]:
        """Yield the guess, the guess with speeds of zero, then points around that."""
        if not isinstance(count, int) or count < 1 or not spread > 0:
            raise InputError("starts and spread are not positive", got=(count, spread))
        first = np.concatenate([self.x, self.u])[self.unknowns]
        yield first
        still = np.where([self.speeds[k] for k in self.unknowns], 0.0, first)
        if count > 1:
            yield still
        draw = np.random.default_rng(seed)
        for _ in range(count - 2):
            yield still + spread * draw.normal(size=first.size) * np.maximum(np.abs(still), 1.0)

    def whole(self, z: Array) -> tuple[Array, Array]:
        """Return states and inputs."""
        both = np.concatenate([self.x, self.u])
        both[self.unknowns] = z
        return both[: self.x.size], both[self.x.size :]

    def value(self, z: Array) -> Array:
        """Return what should be zero."""
        return self.equations.value(*self.whole(z))

    def values(self, z: Array) -> tuple[Array, Array]:
        """Return what should be zero, and its derivatives by the unknowns."""
        f, J = self.equations(*self.whole(z))
        return f, J[:, self.unknowns]

    @cached_property
    def problem(self) -> newton.Problem:
        """The equations, with the size of their derivatives by all states and inputs around the guess."""
        first = np.concatenate([self.x, self.u])
        draw = np.random.default_rng(0).normal(size=(NEAR_POINTS, first.size))
        points = [first, *(first + NEAR * draw * np.maximum(np.abs(first), 1.0))]
        n = self.x.size
        with np.errstate(all="ignore"):
            size = newton.sizes([self.equations(z[:n], z[n:])[1] for z in points])
        return newton.Problem(self.value, self.values, size)

    def solve(self, z: Array) -> Array | None:
        """Return a solution from a start; None where none is found."""
        return newton.solve(self.problem, z)

    def wrapped(self, z: Array) -> Array:
        """Return angles within half a turn of the guess where the equations hold there as well."""
        first = np.concatenate([self.x, self.u])[self.unknowns]
        turns = np.ceil((z - first) / (2 * np.pi) - 0.5)
        turned = z - 2 * np.pi * np.where([self.angles[k] for k in self.unknowns], turns, 0.0)
        if np.array_equal(turned, z):
            return z
        again = self.solve(turned)
        return z if again is None or not _alike(again, turned) else again

    def distance(self, z: Array) -> float:
        """Return how far a solution is from the guess."""
        return float(np.linalg.norm(z - np.concatenate([self.x, self.u])[self.unknowns]))

    def told(self, z: Array) -> Equilibrium:
        """Return a solution with what is known of it."""
        f, J = self.values(z)
        self._check_cyclic(z)
        x, u = self.whole(z)
        rank, null = newton.null_space(J, self.problem.size)
        certain = np.max(np.abs(newton.step(self.problem, f, J))) <= CERTAIN * (
            1 + np.max(np.abs(z))
        )
        kind = ("isolated" if certain else DEGENERATE) if rank == z.size else self._kind(z, null)
        worst = int(np.argmax(np.abs(f)))
        states = names_of(self.compiled.layout.states)
        rates = self.compiled.rhs(0.0, x, self.p, u)
        return Equilibrium(
            dict(zip(states, map(float, x), strict=True)),
            dict(zip(self.inputs, map(float, u), strict=True)),
            dict(zip(names_of(self.compiled.layout.parameters), map(float, self.p), strict=True)),
            float(abs(f[worst])),
            float(np.max(np.abs(f) / newton.scale(self.problem, z))),
            self.equations.labels[worst],
            z.size,
            rank,
            kind,
            tuple(self._named(v) for v in null.T) if kind == "family" else (),
            {n: float(rates[states.index(n)]) for n in self.cyclic},
        )

    def _named(self, direction: Array) -> Mapping[str, float]:
        named = {self.labels[p]: float(v) for p, v in zip(self.unknowns, direction, strict=True)}
        return {n: v for n, v in named.items() if abs(v) > newton.RANK}

    def _kind(self, z: Array, null: Array) -> str:
        """Tell a family from a degenerate point: along every direction there is another solution."""
        step = FAMILY_STEP * (1 + float(np.max(np.abs(z))))
        for v in null.T:
            other = self.solve(z + step * v)
            if other is None or abs(float(v @ (other - z))) < step / 2:
                return DEGENERATE
        return "family"

    def _check_cyclic(self, z: Array) -> None:
        """Raise `InputError` where an equation depends on a state that was said to be cyclic."""
        draw = np.random.default_rng(0)
        x, u = self.whole(z)
        places = [names_of(self.compiled.layout.states).index(n) for n in self.cyclic]
        for _ in range(3):
            J = self.equations(x, u)[1]
            size = np.max(np.abs(J), axis=1, initial=1e-300)
            for place in places:
                depends = np.abs(J[:, place]) > newton.RANK * size
                if np.any(depends):
                    raise InputError(
                        f"{self.labels[place]} is not cyclic",
                        where=self.name,
                        got=f"the rate of {self.equations.labels[int(np.argmax(depends))]} depends on it",
                        hint="hold it, or call the other state cyclic, too",
                    )
            x = x + 0.1 * draw.normal(size=x.size)

    def nothing(self, starts: int) -> InputError:
        """Return the error that nothing was found."""
        what = "steady motion" if self.cyclic else "equilibrium"
        return InputError(
            f"no {what} was found", where=self.name, got=f"{starts} starts around the guess",
            hint="give a closer guess, more starts, or free an input; there may be none",
        )  # fmt: skip


def _start(
    guess: Mapping[str, float], states: Sequence[str], fours: Sequence[Sequence[int]]
) -> Array:
    for name in guess:
        if name not in states:
            raise unknown_name("state", name, states)
    x = to_array(dict.fromkeys(states, 0.0) | dict(guess), states, "state")
    for four in fours:
        if not any(x[k] for k in four):
            x[min(four)] = 1.0
    return x
