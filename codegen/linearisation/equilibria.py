"""States in which nothing changes, and steady motions, found numerically for any compiled system.

    found = equilibrium(compiled, {"theta": 0.1, "omega": 0.0}, parameters)
    trim = equilibrium(compiled, guess, parameters, free=["thrust"], hold={"height": 100.0})
    steady = equilibrium(compiled, guess, parameters, cyclic=["phi"], hold={"spin": 20.0})

Newton's method (`codegen.linearisation.equilibria`) with derivatives of the program
(`codegen.linearisation.unknowns`); where the equations leave a family of solutions open, it goes to a near
one. Unit quaternions that the system states (`eom.BodyAttitude`) stay unit ones. What is found comes with
its residual, and with the rank of the Jacobian: whether it stands alone.

What is near a guess: distances in the scales of the unknowns, points around it, whole turns.

Scales of states and inputs, what is a small change of each, come from the equations themselves. The matrix
of derivatives of rates by states is balanced by a diagonal matrix D: row and column k of D^-1 A D get equal
sums (Osborne, J. ACM 7 (1960) 338; Parlett and Reinsch, Numer. Math. 13 (1969) 293). For x' = v, v' = -w^2
x a change of v has w times the size of one of x; it does not depend on units. Each set of states that have
to do with each other keeps one factor free, which angles, else the values of a state, settle.

Newton's method for equations that may be fewer or more than the unknowns.

Each step is the shortest one that solves the linear equations (Ben-Israel, J. Math. Anal. Appl. 15, 1966,
p. 243), no longer than a radius within which the linear equations held so far, and halved until the
equations get smaller: so a search goes to a solution near its start. Unknowns are in their scales
(`codegen.linearisation.equilibria`); rows are scaled by the size that their derivatives have around the
start.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled, compiled_of
from codegen.compiling.sampled import refuse
from codegen.frontend.attitude import quaternions_of
from codegen.frontend.layout import completed, in_si, names_of, to_array
from codegen.ir.passes import dependence
from codegen.ir.program import INVARIANTS, OUTPUTS, RATES
from codegen.linearisation.unknowns import Equations, Equilibrium, maintained, together
from eom.errors import InputError, near_matches, typed, unknown_name
from eom.system import System

Array = NDArray[np.float64]

TOLERANCE = 1e-11
"""Of a residual, relative to the terms that it is made of."""
CONVERGING = 1e-4
"""How far the next step goes at most from a solution, relative to its size."""
MOST_STEPS, HALVINGS = 80, 30
FARTHEST = 1e9
"""A search that gets so far beyond its start, relative to its size, is given up."""
RADIUS = 0.2
"""Longest first step, in the scales of the unknowns."""
HELD = 0.5
"""Part of what a step was to make equations smaller by, with which its radius is doubled."""
RANK = 1e-9
"""Singular values below this, relative to the largest, count as zero."""


@dataclass(frozen=True)
class Problem:
    """Equations: ``value(z)`` is zero at a solution; ``derived(z)``: that, and its derivatives.

    ``size``: of the derivatives of each equation, as they are around the start: at a solution all
    derivatives of one may vanish.
    """

    value: Callable[[Array], Array]
    derived: Callable[[Array], tuple[Array, Array]]
    size: Array


def solve(problem: Problem, z: Array) -> Array | None:
    """Return a solution from a start; None where none is found."""
    limit = FARTHEST * (1 + _largest(z))
    radius = RADIUS
    for _ in range(MOST_STEPS):
        f, J = problem.derived(z)
        if not (np.all(np.isfinite(f)) and np.all(np.isfinite(J))):
            return None
        forward = step(problem, f, J)
        near = _largest(forward) <= CONVERGING * (1 + _largest(z))
        if near and np.all(np.abs(f) <= TOLERANCE * scale(problem, z)):
            return _polished(problem, z, f, forward)
        moved, radius = _shortened(problem, z, f, forward, radius)
        if moved is None or np.max(np.abs(moved)) > limit:
            return None
        z = moved
    return None


def _largest(a: Array) -> float:
    """Return the largest size of a number, 0 where there is none."""
    return float(np.max(np.abs(a), initial=0.0))


def step(problem: Problem, f: Array, J: Array) -> Array:
    """Return the shortest step that solves the linear equations, or comes nearest to it."""
    size = problem.size
    return np.asarray(np.linalg.lstsq(J / size[:, None], -f / size, rcond=RANK)[0])


def scale(problem: Problem, z: Array) -> Array:
    """Return the size of each equation's terms."""
    return np.asarray(problem.size * (1 + _largest(z)))


def _shortened(
    problem: Problem, z: Array, f: Array, step: Array, radius: float
) -> tuple[Array | None, float]:
    """Return the point by the longest halving of a step that makes the equations smaller.

    The step is at most ``radius`` long; it comes back twice as long where the equations got smaller as the
    linear ones said, else as long as the step that was made.
    """
    size, length = problem.size, float(np.linalg.norm(step))
    here, part = np.linalg.norm(f / size), min(1.0, radius / length) if length > 0 else 1.0
    for _ in range(HALVINGS):
        there = z + part * step
        with np.errstate(all="ignore"):
            value = np.linalg.norm(problem.value(there) / size)
        if value <= (1 - HELD * part) * here:
            return there, max(radius, 2 * part * length)
        if value <= (1 - part / 4) * here:
            return there, min(radius, part * length)
        part /= 2
    return None, radius


def _polished(problem: Problem, z: Array, f: Array, step: Array) -> Array:
    """Take one step more where that makes the residual smaller."""
    better = problem.value(z + step)
    return z + step if np.linalg.norm(better) < np.linalg.norm(f) else z


def sizes(matrices: Sequence[Array], rounding: Sequence[Array]) -> Array:
    """Return the median of the norms of each row, of those that are finite; 1 for rows of zeros.

    ``rounding``: of each equation at the same points; a row that is nothing but that counts as so large
    that its rounding is `TOLERANCE` of it: a residual of that size is zero.
    """
    norms = np.array([np.linalg.norm(J, axis=1) for J in matrices if np.all(np.isfinite(J))])
    if not norms.size:
        return np.ones(len(matrices[0]))
    found = np.median(norms, axis=0)
    found = np.where(found > 0, found, np.where(norms.max(axis=0) > 0, norms.max(axis=0), 1.0))
    known = [r for r in rounding if np.all(np.isfinite(r))]
    return np.maximum(found, np.median(known, axis=0) / TOLERANCE) if known else found


def null_space(J: Array, size: Array) -> tuple[int, Array]:
    """Return the rank of J with rows scaled by ``size``, and its null space as columns."""
    _, singular, rows = np.linalg.svd(J / size[:, None])
    rank = int(np.sum(singular > RANK * max(1.0, float(np.max(singular, initial=0.0)))))
    return rank, np.asarray(rows[rank:].T)


ALIKE = 1e-6
"""Solutions closer than this, relative to their size, are one."""
DEGENERATE = "degenerate"
CERTAIN = 1e-9
"""Where Newton's method would still go farther than this, the place of a solution is not certain."""
HIDDEN = 1e-8
"""What is larger than this, in its scale, is no error of a search: it ends where its steps are as small."""
MOST_STARTS = 100_000
FAMILY_STEP = 1e-3
"""How far along a family another member is looked for, relative to the size of the solution."""


@typed
def equilibrium(
    compiled: Compiled | System,
    guess: Mapping[str, float | str] | None = None,
    parameters: Mapping[str, float | str] | Sequence[float] | None = None,
    *,
    inputs: Mapping[str, float | str] | None = None,
    free: Iterable[str] = (),
    cyclic: Iterable[str] = (),
    hold: Mapping[str, float | str] | None = None,
    starts: int = 24,
    seed: int = 0,
    spread: float = 1.0,
) -> Equilibrium:
    """Return the solution nearest to the guess of those that are found from it and from points around it.

    Parameters
    ----------
    compiled : Compiled or System
        The system, compiled at the first call unless it is; its rates must not depend on time.
    guess : mapping, optional
        States by name, 0 where left out (1 in a quaternion's first place).
    parameters : mapping or sequence of float, optional
        Numbers by name or in order.
    inputs : mapping, optional
        Their values, 0 where left out.
    free : iterable of str, optional
        Inputs that are looked for, from the values that they have.
    cyclic : iterable of str, optional
        States that may run, on which no other rate depends.
    hold : mapping, optional
        Values of states, outputs or invariants that the solution must have; the constraints that the
        system maintains are met anyhow.
    starts : int, default 24
        How many points are tried.
    seed : int, default 0
        By which they are drawn.
    spread : float, default 1
        How far from the guess, in the scale of each state (`codegen.linearisation.equilibria`: 1 for
        angles, others by what they do beside them), in which near is meant, too.

    Returns
    -------
    Equilibrium
        States and inputs by name, and whether the solution is isolated. Values that rounding hides are
        zero; the same arguments give the same result.

    Raises
    ------
    InputError
        Where nothing is found, for unknown names, and for rates that depend on time.

    Notes
    -----
    Units are those of the system.

    References
    ----------
    Newton's method with steps of least size, Ben-Israel, J. Math. Anal. Appl. 15 (1966) 243.

    Examples
    --------
    >>> import sympy as sp, codegen, eom
    >>> q, u = sp.symbols("q u", real=True)
    >>> arm = codegen.compile(eom.System.from_rates("arm", {q: u, u: sp.cos(q) - u}), "numpy")
    >>> found = equilibrium(arm, {"q": 1.0})
    >>> found.kind, round(found.states["q"], 6)
    ('isolated', 1.570796)
    """
    compiled = compiled_of(compiled)
    refuse(compiled, "an equilibrium")
    search = _Search(compiled, guess, parameters, inputs, free, cyclic, hold)
    best: Array | None = None
    for start in search.starts(starts, seed, spread):
        if best is not None and search.near.distance(start) >= search.near.distance(best):
            break
        found = search.solved(start)
        if found is not None:
            found = search.wrapped(found)
            if best is None or search.near.distance(found) < search.near.distance(best):
                best = found
    if best is None:
        raise search.nothing(starts)
    return search.equilibrium(best)


@typed
def equilibria(
    compiled: Compiled | System,
    guess: Mapping[str, float | str] | None = None,
    parameters: Mapping[str, float | str] | Sequence[float] | None = None,
    *,
    inputs: Mapping[str, float | str] | None = None,
    free: Iterable[str] = (),
    cyclic: Iterable[str] = (),
    hold: Mapping[str, float | str] | None = None,
    starts: int = 24,
    seed: int = 0,
    spread: float = 1.0,
) -> tuple[Equilibrium, ...]:
    """Return all solutions that are found from so many points, each once; see `equilibrium`.

    Parameters
    ----------
    compiled : Compiled
        As of `equilibrium`.
    guess : mapping of str to float or str, optional
        Where the search begins, as of `equilibrium`; other starts lie around it.
    parameters : mapping of str to float or str or sequence of floats, optional
        As of `equilibrium`.
    inputs : mapping of str to float or str, optional
        As of `equilibrium`.
    free : iterable of str, optional
        As of `equilibrium`.
    cyclic : iterable of str, optional
        As of `equilibrium`.
    hold : mapping of str to float or str, optional
        As of `equilibrium`.
    starts : int, default 24
        As of `equilibrium`.
    seed : int, default 0
        As of `equilibrium`.
    spread : float, default 1.0
        As of `equilibrium`.

    Returns
    -------
    tuple of Equilibrium
        Each solution once, nearest to the guess first; angles are within half a turn of it where
        that changes nothing. Of families, single members are returned. None of this says that there
        are no others.

    Raises
    ------
    InputError
        As `equilibrium` raises it.

    Notes
    -----
    For units and source see `equilibrium`.

    Examples
    --------
    >>> import sympy as sp, codegen, eom
    >>> x = sp.Symbol("x", real=True)
    >>> logistic = codegen.compile(eom.System.from_rates("logistic", {x: x * (1 - x)}), "numpy")
    >>> [round(found.states["x"], 6) for found in equilibria(logistic, {"x": 0.9})]
    [1.0, 0.0]
    """
    compiled = compiled_of(compiled)
    refuse(compiled, "an equilibrium")
    search = _Search(compiled, guess, parameters, inputs, free, cyclic, hold)
    found: list[Array] = []
    for start in search.starts(starts, seed, spread):
        z = search.solved(start)
        if z is None:
            continue
        z = search.wrapped(z)
        if not any(_alike(z, other) for other in found):
            found.append(z)
    if not found:
        raise search.nothing(starts)
    steady = [search.equilibrium(z) for z in sorted(found, key=search.near.distance)]
    families = [e for e in steady if e.kind == "family"][:1]
    return tuple(e for e in steady if e.kind != "family" or e in families)


def _alike(a: Array, b: Array) -> bool:
    return _largest(a - b) <= ALIKE * (1 + _largest(a))


class _Search:
    """What is looked for, and the way there; vectors hold the unknowns: states, then inputs."""

    def __init__(
        self,
        compiled: Compiled,
        guess: Any,
        parameters: Mapping[str, float | str] | Sequence[float] | None,
        inputs: Any,
        free: Iterable[str],
        cyclic: Iterable[str],
        hold: Any,
    ) -> None:
        self.asked = (compiled, guess, parameters, inputs, free, cyclic, hold)
        layout = compiled.layout
        self.compiled, self.name = compiled, f"system {layout.name!r}"
        states, self.inputs = names_of(layout.states), names_of(layout.inputs)
        given = completed(parameters, layout.parameters)
        guess, inputs, hold = (in_si(v, layout.known) for v in (guess, inputs, hold))
        self.p = to_array(given, names_of(layout.parameters), "parameter")
        if dependence(compiled.program, RATES, "time"):
            raise InputError("the rates depend on time: nothing is steady", where=self.name)
        free = self._names(free, "input", self.inputs)
        self.cyclic = cyclic = self._names(cyclic, "state", states)
        hold = dict.fromkeys(maintained(compiled), 0.0) | dict(hold or {})
        fours = self.fours = quaternions_of(layout.attitudes)
        self.x = _start(guess or {}, states, fours)
        acting = dict.fromkeys(self.inputs, 0.0) | dict(inputs or {})
        self.u = to_array(acting, self.inputs, "input")
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
    def first(self) -> Array:
        """The unknowns of the guess."""
        return np.concatenate([self.x, self.u])[self.unknowns]

    @cached_property
    def near(self) -> Near:
        """What is near the guess: the scale of each unknown, whole turns, signs of quaternions."""
        inside, own = {k for f in self.fours for k in f}, self.unknowns
        turning = [a or k in inside for k, a in enumerate(self.angles)]
        scales = scales_of(self.equations, self.x, self.u, turning)[own]
        fours = [[own.index(k) for k in f] for f in self.fours if {*f} <= {*own}]
        return Near(self.first, scales, [self.angles[k] for k in own], fours)

    @property
    def scales(self) -> Array:
        """The scale of each unknown."""
        return self.near.scales

    @cached_property
    def problem(self) -> Problem:
        """The equations over unknowns in their scales, with the size of derivatives around the guess."""
        draw = np.random.default_rng(0).normal(size=(NEAR_POINTS, self.first.size))
        points = [self.first, *(self.first + NEAR * draw * self.scales)]
        with np.errstate(all="ignore"):
            size = sizes(
                [self.values(z)[1] * self.scales for z in points],
                [self.equations.rounding(*self.whole(z)) for z in points],
            )

        def derived(y: Array) -> tuple[Array, Array]:
            f, J = self.values(y * self.scales)
            return f, J * self.scales

        return Problem(lambda y: self.value(y * self.scales), derived, size)

    def solved(self, z: Array) -> Array | None:
        """Return a solution from a start; None where none is found."""
        found = solve(self.problem, z / self.scales)
        return None if found is None else found * self.scales

    def starts(self, count: int, seed: int, spread: float) -> list[Array]:
        """Return the guess, the guess with speeds of zero, and points around, the nearest first."""
        if not (1 <= count <= MOST_STARTS and 0 < float(spread) < np.inf and seed >= 0):
            raise InputError(
                "unusable starts", where=self.name, got=f"starts={count}, seed={seed}, spread={spread}",
                expected=f"1 to {MOST_STARTS:,} starts, a seed from 0, a spread above 0",
            )  # fmt: skip
        still = np.where([self.speeds[k] for k in self.unknowns], 0.0, self.first)
        return self.near.starts(still, count, seed, spread)

    def wrapped(self, z: Array) -> Array:
        """Return angles and quaternions nearest to the guess where the equations hold there as well."""
        turned = self.near.turned(z)
        if np.array_equal(turned, z):
            return z
        again = self.solved(turned)
        return z if again is None or not _alike(again, turned) else again

    def exact(self, z: Array) -> Array:
        """Return a solution with zeros for values that rounding hides.

        As many of the smallest as leave the equations zero to rounding (a running error analysis says how
        much that is), of those that are small enough to be errors of the search.
        """
        size = np.abs(z) / self.scales
        order = [int(k) for k in np.argsort(size, kind="stable") if 0 < size[k] < HIDDEN]
        for count in range(len(order), 0, -1):
            other = z.copy()
            other[order[:count]] = 0.0
            with np.errstate(all="ignore"):
                left, slack = np.abs(self.value(other)), self.equations.rounding(*self.whole(other))
            if np.all(left <= slack):
                return other
        return z

    def equilibrium(self, z: Array) -> Equilibrium:
        """Return a solution with what is known of it."""
        z = self.exact(z)
        y = z / self.scales
        f, J = self.problem.derived(y)
        self._check_cyclic(z)
        x, u = self.whole(z)
        rank, null = null_space(J, self.problem.size)
        certain = np.max(np.abs(step(self.problem, f, J))) <= CERTAIN * (1 + np.max(np.abs(y)))
        kind = ("isolated" if certain else DEGENERATE) if rank == z.size else self._kind(y, null)
        worst = int(np.argmax(np.abs(f)))
        states = names_of(self.compiled.layout.states)
        rates = self.compiled.rhs(0.0, x, self.p, u)
        return Equilibrium(
            dict(zip(states, map(float, x), strict=True)),
            dict(zip(self.inputs, map(float, u), strict=True)),
            dict(zip(names_of(self.compiled.layout.parameters), map(float, self.p), strict=True)),
            float(abs(f[worst])),
            float(np.max(np.abs(f) / scale(self.problem, y))),
            self.equations.labels[worst],
            z.size,
            rank,
            kind,
            tuple(self._named(v) for v in null.T) if kind == "family" else (),
            {n: float(rates[states.index(n)]) for n in self.cyclic},
        )

    def _named(self, direction: Array) -> Mapping[str, float]:
        direction = direction * self.scales / np.linalg.norm(direction * self.scales)
        named = {self.labels[p]: float(v) for p, v in zip(self.unknowns, direction, strict=True)}
        return {n: v for n, v in named.items() if abs(v) > RANK}

    def _kind(self, y: Array, null: Array) -> str:
        """Distinguish a family from a degenerate point: along every direction there is another solution."""
        step = FAMILY_STEP * (1 + float(np.max(np.abs(y))))
        for v in null.T:
            other = solve(self.problem, y + step * v)
            if other is None or abs(float(v @ (other - y))) < step / 2:
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
                depends = np.abs(J[:, place]) > RANK * size
                if np.any(depends):
                    raise InputError(
                        f"{self.labels[place]} is not cyclic", where=self.name,
                        got=f"the rate of {self.equations.labels[int(np.argmax(depends))]} depends on it",
                        hint="hold it, or call the other state cyclic, too",
                    )  # fmt: skip
            x = x + 0.1 * draw.normal(size=x.size)

    def nothing(self, starts: int) -> InputError:
        """Return the error that nothing was found; it names states that would have to run."""
        what = "steady motion" if self.cyclic else "equilibrium"
        running = self._running()
        hint = "give a closer guess, more starts, or free an input; there may be none"
        if running:
            given = " ".join(f"--cyclic {n}" for n in running)
            hint = f"motions are steady in which {', '.join(running)} may run: {given}"
        return InputError(
            f"no {what} was found",
            where=self.name,
            got=f"{starts} starts around the guess",
            hint=hint,
        )

    def _running(self) -> tuple[str, ...]:
        """Return states of which one is steady where they run, the fewest; none where that does not help.

        They may run together where no rate of another state depends on them.
        """
        states = names_of(self.compiled.layout.states)
        own = {k for k in self.unknowns if k < len(states)}
        compiled, guess, parameters, inputs, free, cyclic, hold = self.asked
        for running in together(dependence(self.compiled.program, RATES), own):
            names = tuple(states[k] for k in running)
            other = _Search(compiled, guess, parameters, inputs, free, (*cyclic, *names), hold)
            if any(other.solved(z) is not None for z in other.starts(4, 0, 1.0)):
                return names
        return ()


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


NEAR, NEAR_POINTS = 0.3, 6
"""How far from the guess, in scales, derivatives are looked at for their size, and at how many points."""
WIDEST = 2
"""Deviation of the farthest points around a guess, in scales."""


def scales_of(equations: Equations, x: Array, u: Array, turning: Sequence[bool]) -> Array:
    """Return the scale of each state and input (see `state_scales`), from the rates around a guess.

    ``turning``: whether each is an angle, or part of a quaternion. How far around depends on the scales:
    they are made twice, first of points that are as far as the guess is from zero.
    """
    guess, n = np.concatenate([x, u]), x.size
    scale = np.where(turning, 1.0, np.abs(guess))
    for _ in range(2):
        size = np.median(np.abs(_derivatives(equations, guess, scale, n)), axis=0)
        states = state_scales(size[:, :n], x, turning[:n])
        terms = np.linalg.norm(size[:, :n] * states, axis=1)
        scale = np.concatenate([states, input_scales(size[:, n:], terms, u)])
    return scale


def _derivatives(equations: Equations, guess: Array, scale: Array, n: int) -> Array:
    """Return derivatives of the rates by states and inputs at points around a guess, (points, n, m)."""
    draw = np.random.default_rng(0).normal(size=(NEAR_POINTS, guess.size))
    points = [guess, *(guess + NEAR * draw * scale)]
    with np.errstate(all="ignore"):
        found = [equations.rates(z[:n], z[n:]) for z in points]
    finite = [J for J in found if np.all(np.isfinite(J))]
    return np.array(finite or [np.zeros_like(found[0])])


@dataclass(frozen=True)
class Near:
    """The unknowns of a guess with their scales; ``fours``: places of unit quaternions among them."""

    first: Array
    scales: Array
    angles: Sequence[bool]
    fours: Sequence[Sequence[int]]

    def distance(self, z: Array) -> float:
        """Return how far a point is from the guess, in the scales of the unknowns."""
        return float(np.linalg.norm((self._same_side(z) - self.first) / self.scales))

    def turned(self, z: Array) -> Array:
        """Return angles within half a turn of the guess, quaternions on its side."""
        turns = np.ceil((z - self.first) / (2 * np.pi) - 0.5)
        return self._same_side(z - 2 * np.pi * np.where(self.angles, turns, 0.0))

    def _same_side(self, z: Array) -> Array:
        z = z.copy()
        for four in self.fours:
            places = list(four)
            if z[places] @ self.first[places] < 0:
                z[places] *= -1
        return z

    def starts(self, still: Array, count: int, seed: int, spread: float) -> list[Array]:
        """Return the guess, ``still``, and points around that, farther and farther; the nearest first."""
        draw = np.random.default_rng(seed)
        around = [
            still + spread * WIDEST * (k + 1) / count * draw.normal(size=still.size) * self.scales
            for k in range(count - 2)
        ]
        return sorted([self.first, *[still] * (count > 1), *around], key=self.distance)


TURNS = 100
SETTLED = 1e-3
"""Change of all factors, relative, at which they are taken."""


def balanced(A: Array) -> Array:
    """Return d such that |A_kl| d_l / d_k has equal sums by rows and columns.

    ``A``: (n, n); signs and the diagonal do not matter. A state that only drives, or is only driven, gets
    what its own row or column asks for.
    """
    size = np.abs(A)
    np.fill_diagonal(size, 0.0)
    d = np.ones(len(A))
    for _ in range(TURNS):
        before = d.copy()
        for k in range(len(A)):
            row, column = size[k] @ d / d[k], np.sum(size[:, k] / d) * d[k]
            if row > 0 and column > 0:
                d[k] *= np.sqrt(row / column)
        if np.max(np.abs(d / before - 1), initial=0.0) < SETTLED:
            break
    return d


def parts(A: Array) -> list[list[int]]:
    """Return the sets of states that an entry of A, either way, connects, in order."""
    left, found = set(range(len(A))), []
    linked = (A != 0) | (A.T != 0)
    while left:
        stack, part = [min(left)], set()
        while stack:
            k = stack.pop()
            if k in left:
                left.discard(k)
                part.add(k)
                stack += [int(j) for j in np.flatnonzero(linked[k]) if j in left]
        found.append(sorted(part))
    return found


def state_scales(A: Array, x: Array, angles: Sequence[bool]) -> Array:
    """Return the scale of each state (n,): 1 for angles, others by what they do beside them.

    ``A``: sizes of the derivatives of rates by states, around ``x``. Without angles: by the values, and so
    that the scales have the geometric mean 1 at least.
    """
    d = balanced(A)
    for part in parts(A):
        own, turns = d[part], [k for k in part if angles[k]]
        if turns:
            factor = float(np.exp(-np.mean(np.log(d[turns]))))
        else:
            mean = float(np.exp(-np.mean(np.log(own))))
            factor = max(mean, float(np.max(np.abs(x[part]) / own)))
        d[part] = own * factor
    return np.where(np.asarray(angles), 1.0, d)


def input_scales(B: Array, rates: Array, u: Array) -> Array:
    """Return the scale of each input (m,): what changes some rate by the size of its terms, or its value.

    ``B``: (n, m), sizes of derivatives by inputs; ``rates``: (n,), sizes of the terms of each rate.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        change = np.where(B > 0, rates[:, None] / B, np.inf)
    least = np.min(change, axis=0, initial=np.inf)
    found: Array = np.maximum(np.abs(u), np.where(np.isfinite(least) & (least > 0), least, 1.0))
    return found
