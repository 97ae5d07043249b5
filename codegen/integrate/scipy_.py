"""SciPy's integrators over the compiled functions, stopped by the same rules as the generated.

Implicit methods get the derivatives of the rates: their entries, or where zeros are.

Projection in Python, for methods whose loop is SciPy's, and what generated loops need from Python.

The rules are those of `codegen.loops.projection` and of `projection.c`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from codegen.compiling.compiled import Compiled, known_jacobian
from codegen.compiling.signals import Inputs
from codegen.compiling.sparse import SparseJacobian
from codegen.integrate import sundials
from codegen.integrate.watching import Cut, Watcher
from codegen.ir.passes import dependence, prune
from codegen.ir.program import INVARIANTS, RATES, SAMPLES
from codegen.loops import jumps
from codegen.loops.projection import units
from codegen.loops.samples import Schedule
from codegen.loops.tableaux import TSIT5, Tableau
from codegen.native.trajectory import Array, Problem, Stop, Trajectory

EPSILON = float(np.finfo(np.float64).eps)
SHARE, LEAST_TOLERANCE, TURNS, FARTHEST = 16, 1024 * EPSILON, 4, 0.25
"""What `projection.c` has, too. Changes of more than the last, of scaled states, are not made."""


def with_values(compiled: Compiled, problem: Problem) -> Problem:
    """Return the problem with the further parameters of `projection.extended`, from its start."""
    kept = _kept(compiled, problem, problem.inputs)
    return replace(problem, parameters=np.append(problem.parameters, kept))


def _kept(compiled: Compiled, problem: Problem, u: Array) -> Array:
    values = compiled.invariants(problem.t_span[0], problem.x0, problem.parameters, u)
    return values[_places(compiled, problem)]


def _places(compiled: Compiled, problem: Problem) -> list[int]:
    return [compiled.layout.results[INVARIANTS].index(name) for name in problem.project]


class Projector:
    """Projection over the compiled functions, as `projection.c` does it."""

    def __init__(self, compiled: Compiled, problem: Problem, inputs: Inputs | None = None) -> None:
        self.problem, self.inputs = problem, inputs
        self.places = _places(compiled, problem)
        self.jacobian = compiled.jacobian("states", INVARIANTS)
        self.kept = _kept(compiled, problem, self._u(problem.t_span[0], problem.x0))
        self.units = np.array(units(compiled.layout))
        self.allowed = max(problem.rtol, LEAST_TOLERANCE) / SHARE

    def _u(self, t: float, x: Array) -> Array:
        return self.problem.inputs if self.inputs is None else self.inputs(t, x)

    def __call__(self, t: float, x: Array) -> Array:
        """Return the state ``x``, of shape (n,), on the invariants: itself if it is there."""
        for _ in range(TURNS):
            u = self._u(t, x)
            scale = self._scale(x)
            whole, entries = self.jacobian.with_value(t, x, self.problem.parameters, u)
            value = whole[self.places]
            slopes = np.zeros(self.jacobian.shape)
            slopes[list(self.jacobian.rows), list(self.jacobian.columns)] = entries
            slopes = slopes[self.places]
            noise = 2 * EPSILON * (np.abs(value) + np.abs(slopes * x).sum(axis=1))
            change = least_change(slopes * scale, self.kept - value, noise, self.allowed)
            if change is None:
                return x
            x = x + scale * change
        return x

    def _scale(self, x: Array) -> Array:
        sizes = np.maximum(np.abs(x), self.problem.atol / self.problem.rtol)
        largest = np.zeros(self.units.max() + 1)
        np.maximum.at(largest, self.units, sizes)
        return np.asarray(largest[self.units])

    def points(self, t: Array, y: Array) -> Array:
        """Return the states ``y`` of shape (n, N) at times ``t``, each on the invariants."""
        found = [self(float(at), x) for at, x in zip(t, y.T, strict=True)]
        return np.array(found).T.reshape(y.shape)


def least_change(a: Array, left: Array, noise: Array, allowed: float) -> Array | None:
    """Return the least vector z with ``a`` z = ``left`` in the rows that count; None for none.

    ``a``: one gradient a row. ``noise``: what rounding does to each invariant. A row counts while
    noise, with its part of that of the rows before, over what is left of the row is less than
    ``allowed``; it moves where ``left`` is more than ``noise``.
    """
    if not np.any(np.abs(left) > noise):
        return None
    a, left, spread = a.copy(), left.copy(), noise.copy()
    with np.errstate(all="ignore"):
        whole = np.linalg.norm(a, axis=1)
        change, moved = np.zeros(a.shape[1]), False
        free = np.ones(len(a), dtype=bool)
        while True:
            rest = np.linalg.norm(a, axis=1)
            counts = free & (rest * allowed > spread)
            if not counts.any():
                break
            best = int(np.argmax(np.where(counts, rest / whole, -1.0)))
            free[best], square = False, rest[best] ** 2
            step = left[best] / square if abs(left[best]) > noise[best] else 0.0
            moved |= step != 0.0
            change += step * a[best]
            part = np.where(free, a @ a[best] / square, 0.0)
            left -= step * part * square
            spread += np.abs(part) * spread[best]
            a -= part[:, None] * a[best]
    small = bool(np.linalg.norm(change) < FARTHEST)
    return change if moved and small else None


METHODS = ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")
TABLEAUX = {"Tsit5": TSIT5}
"""Explicit methods that SciPy lacks and that its loop can run."""
PARTS = 8
REPORT_EVERY = 100
ATTEMPTS = 12
"""So many shorter and shorter steps, each a quarter of the one before, are tried where one overflows."""
LEAST_RTOL = 100 * 2.0**-52
"""SciPy's methods take no smaller relative tolerance; this one is taken then, and a notice says so."""

SUNDIALS = {f"CVODE {kind}": kind for kind in sundials.KINDS}
"""Methods of SUNDIALS that this loop drives likewise."""
IMPLICIT = ("Radau", "BDF", "LSODA", *SUNDIALS)
WITH_SPARSITY = ("Radau", "BDF", *SUNDIALS)
MULTISTEP = ("BDF", "LSODA")
"""Methods of SciPy that carry values of earlier steps along, which a projection would contradict."""


def integrate(
    compiled: Compiled, problem: Problem, method: str, inputs: Inputs | None = None
) -> Trajectory:
    """Integrate with a method of the tables; ``inputs``: their values over time, if not held."""
    if problem.laws:
        problem = replace(problem, inputs=problem.inputs.copy())
        inputs = inputs and inputs.over(problem.inputs)
    return _Run(compiled, problem, method, inputs).run()


def _solver_class(method: str) -> Any:
    from scipy import integrate as si

    return _with_tableau(TABLEAUX[method]) if method in TABLEAUX else getattr(si, method)


@cache
def _with_tableau(tableau: Tableau) -> Any:
    """Return SciPy's RK45 with the coefficients of another method of order 5(4), six stages."""
    from scipy import integrate as si

    count = tableau.main_stages
    rows = [(*row, *[0.0] * (count - len(row))) for row in tableau.stages]
    weights, first, last = np.array([*rows[count], 0.0]), *np.eye(count + 1)[[0, -1]]
    quartic = np.array(tableau.dense[0])
    powers = (
        first,
        3 * weights - 2 * first - last + quartic,
        -2 * weights + first + last - 2 * quartic,
        quartic,
    )
    table = {
        "A": np.array(rows[:count])[:, : count - 1],
        "B": weights[:-1],
        "C": np.array(tableau.nodes[:count], dtype=np.float64),
        "E": np.array(tableau.error_high),
        "P": np.column_stack(powers),
    }
    return type(tableau.name, (si.RK45,), table)


@dataclass(frozen=True)
class _Bent:
    """An interpolant and a cubic that takes its end elsewhere, the slopes of both ends kept."""

    dense: Any
    start: float
    end: float
    change: Array

    def __call__(self, t: Any) -> Array:
        part = (np.asarray(t) - self.start) / (self.end - self.start)
        weight = part * part * (3 - 2 * part)
        return np.asarray(self.dense(t) + np.multiply.outer(self.change, weight))


@dataclass(frozen=True)
class _Passage:
    """A way over a change of piece: its length, how far the change is, and how far that may be off (s)."""

    length: float
    edge: float
    off: float


class _Run:
    """One run: SciPy's solver steps, this looks at what it did."""

    def __init__(
        self, compiled: Compiled, problem: Problem, method: str, inputs: Inputs | None
    ) -> None:
        self.problem, self.end = problem, problem.t_span[1]
        self.schedule: Schedule | None = None
        if problem.laws:
            self.schedule = Schedule(problem, compiled.functions.get(SAMPLES), problem.inputs)
            self.schedule.change(problem.t_span[0], problem.x0)
            self.end = self.schedule.next()
        """The end of what is done with inputs that are held: of the run, or the next change of one."""
        self.singular_function = compiled.functions.get("singularities")
        self.coordinates = compiled.layout.coordinates
        self.rhs = compiled.rhs
        known = inputs is None or not inputs.of_state  # else rates depend on states in Python, too
        self.jacobian = jacobian_of(compiled) if known and method in IMPLICIT else None
        self.sparsity = sparsity(compiled) if known and method in WITH_SPARSITY else None
        self.inputs = inputs
        self.projector = Projector(compiled, problem, inputs) if problem.project else None
        self.method = method
        self.evaluations = 0
        self.broken = -1
        """Number of a rate that was not finite in the step that is tried, or -1."""
        self.steep = -1
        """Number of a rate whose derivatives were not finite when last computed, or -1."""
        self.steps = self.rejected = self.attempts = 0
        watcher = Watcher(compiled, problem, inputs)
        self.watcher = None if watcher.is_idle else watcher
        self.last = self.usual = 0.0
        """Lengths of the last step, and of the last that no bound made shorter."""
        self.times = [problem.t_span[0]]
        self.points = [problem.x0]
        self.jumps = jumps.Jumps(problem)
        self.here = problem.t_span[0], problem.x0
        """Where the next step starts."""
        self.interpolants: list[Any] = []
        self.grid_values: list[Array] = []
        self.next = 0
        self.singular = self._singularities(problem.t_span[0], problem.x0)
        self.closest = np.abs(self.singular)

    def _u(self, t: float, x: Array) -> Array:
        return self.problem.inputs if self.inputs is None else self.inputs(t, x)

    def _slope(self, t: float, x: Array) -> Array:
        self.evaluations += 1
        slope = self.rhs(t, x, self.problem.parameters, self._u(t, x))
        finite = np.isfinite(slope)
        if not finite.all():
            self.broken = int(np.argmin(finite))
        return slope

    def _entries(self, t: float, x: Array) -> Array:
        """Return the entries of the Jacobian of the rates; they count as one evaluation."""
        assert self.jacobian is not None
        self.evaluations += 1
        entries = self.jacobian(float(t), x, self.problem.parameters, self._u(t, x))
        finite = np.isfinite(entries)
        self.steep = -1 if finite.all() else self.jacobian.rows[int(np.argmin(finite))]
        return entries

    def _derivatives(self, t: float, x: Array) -> Any:
        assert self.jacobian is not None
        entries, known = self._entries(t, x), self.jacobian
        if self.sparsity is not None:
            from scipy.sparse import csc_array

            return csc_array((entries, (known.rows, known.columns)), shape=known.shape)
        matrix = np.zeros(known.shape)
        matrix[known.rows, known.columns] = entries
        return matrix

    def _singularities(self, t: float, x: Array) -> Array:
        if self.singular_function is None:
            return np.empty(0)
        return self.singular_function(float(t), x, self.problem.parameters, self._u(t, x))

    def run(self) -> Trajectory:
        problem = self.problem
        start, end = problem.t_span
        first = self._slope(start, problem.x0)
        if not np.all(np.isfinite(first)):
            return self._finish(
                Stop("not finite", start, int(np.argmin(np.isfinite(first)))), problem.x0
            )
        if np.any(self.closest <= problem.margin):
            return self._finish(Stop("singular", start, int(np.argmin(self.closest))), problem.x0)
        self._store_grid(start, None)
        with np.errstate(all="ignore"):
            self.solver = self._solver(start, problem.x0, problem.first_step)
            while self.solver.status == "running" or self._changes():
                stop = self._step(self.solver)
                if stop is not None:
                    return self._finish(stop, self.points[-1])
        return self._finish(Stop("end", end), self.points[-1])

    def _changes(self) -> bool:
        """Change inputs at the end of a piece, and begin the next; False at the end of the run."""
        if self.schedule is None or self.end == self.problem.t_span[1]:
            return False
        t, x = self.end, self.here[1]
        self.schedule.change(t, x)
        self.here, self.end = (t, x), self.schedule.next()
        self.singular = self._singularities(t, x)
        self.closest = np.fmin(self.closest, np.abs(self.singular))
        if self.watcher is not None and self.inputs is not None:
            self.inputs.forget()
        carried = (
            self.method in MULTISTEP or self.method in SUNDIALS
        )  # they begin with the lowest order
        self.solver = self._solver(t, x, None if carried else self.usual or None)
        return True

    def _solver(self, t: float, x: Array, step: float | None) -> Any:
        """Return a solver that starts at time ``t`` in the state ``x``, with a first step if given."""
        problem, end = self.problem, self.end
        options: dict[str, Any] = {
            "rtol": max(problem.rtol, 0.0 if self.method in SUNDIALS else LEAST_RTOL),
            "atol": problem.atol,
            "max_step": problem.max_step,
        }
        if self.inputs is not None:
            options["max_step"] = min(problem.max_step, self.inputs.max_step)
        if step:
            options["first_step"] = min(step, abs(end - t))
        if self.method in SUNDIALS:
            return self._sundials(t, x, options)
        if self.jacobian is not None:
            options["jac"] = self._derivatives
        elif self.sparsity is not None:
            options["jac_sparsity"] = self.sparsity
        return _solver_class(self.method)(self._slope, t, x, end, **options)

    def _sundials(self, t: float, x: Array, options: dict[str, Any]) -> sundials.Solver:
        problem, known, n = self.problem, self.jacobian, len(self.problem.x0)
        pattern = self.sparsity if n >= sundials.SPARSE_FROM else None
        if known is not None:
            given = sundials.Derivatives(
                self._entries, known.rows, known.columns, sparse=pattern is not None
            )
            options |= given.options(n)
        elif pattern is not None:
            rows, columns = pattern.nonzero()
            options |= sundials.sparse_options(sundials.by_columns(rows, columns, n), n)
        kind = SUNDIALS[self.method]
        return sundials.Solver(kind, self._slope, (t, self.end), x, problem.dense_output, **options)

    def _step(self, solver: Any) -> Stop | None:
        """Take one step; return why the run has to stop, if it has to."""
        if self.steps + self.rejected >= self.problem.max_steps:
            return Stop("max_steps", solver.t)
        edge = self._look_ahead(solver)
        if not self._advances(solver):
            return self._failure(solver) if self._gives_up() else None
        dense = self._interpolant(solver)
        if self.broken >= 0:
            shorter = 0.25 * abs(solver.t - solver.t_old)
            return None if self._tries(shorter) else self._failure(solver)
        self.attempts = 0
        cut = self._cut(solver, dense)
        if cut is not None:
            self._begin_again(cut)
            return None
        stop = self._taken(solver, dense)
        if stop is None:
            self._go_on(solver, edge)
        return stop

    def _taken(self, solver: Any, dense: Any) -> Stop | None:
        """Keep what a step brought; return why the run has to stop, if it has to."""
        self.steps += 1
        if self.steps % REPORT_EVERY == 0:
            self.problem.report(solver.t)
        if self.projector is not None:
            dense = self._projected(solver, dense)
        where = self._find_singular(solver, dense)
        t, x = (float(solver.t), solver.y.copy()) if where is None else self._at(where[0], dense)
        if where is not None:
            self.closest = np.minimum(self.closest, np.abs(self._singularities(t, x)))
        self._store_grid(t, dense)
        if self.problem.t_eval is not None and not self.problem.dense_output:
            self.times.clear()  # the last step is all that goes on being needed
            self.points.clear()
        self.times.append(t)
        self.points.append(x)
        if self.problem.dense_output:
            self.interpolants.append(dense)
        self.here = t, x
        self.jumps.step(x)
        if where is None and self._is_left(solver):
            return Stop("left", t)
        return None if where is None else Stop("singular", t, where[1])

    def _look_ahead(self, solver: Any) -> float:
        """Bound the step by what time alone brings; return how far it is to where a piece changes, or 0."""
        if self.watcher is None:
            return 0.0
        length, edge = self.watcher.clear(solver.t, self.last)
        self._bound(solver, solver.t + solver.direction * length)
        return edge

    def _bound(self, solver: Any, t: float) -> None:
        """Let no step of a solver go beyond ``t``, nor beyond the end."""
        end = self.end
        solver.t_bound = end if solver.direction * (end - t) <= 4 * math.ulp(end) else t
        if self.method == "LSODA":
            solver._lsoda_solver._integrator.rwork[0] = solver.t_bound

    def _cut(self, solver: Any, dense: Any) -> Cut | None:
        if self.watcher is None:
            return None
        return self.watcher.cut(solver.t_old, solver.t, (self.here[1], solver.y), dense)

    def _gives_up(self) -> bool:
        """Return whether a step that failed is final.

        Where values are watched, numbers that overflow beyond a wall are first avoided by shorter steps.
        """
        if self.watcher is None or self.broken < 0:
            return True
        usual = self.last or 1e-3 * self.watcher.span
        return not self._tries(usual * 0.25 ** (self.attempts + 1))

    def _tries(self, length: float) -> bool:
        """Begin the step again with a shorter one (s); return whether there were not too many already."""
        if self.attempts >= ATTEMPTS:
            return False
        self.attempts += 1
        self._begin_again(Cut(length))
        return True

    def _interpolant(self, solver: Any) -> Any:
        """Return the polynomial of the last step; ``broken`` says where it is not finite.

        Methods of high order call the rates inside the step for it, where they need not be finite though
        both ends are.
        """
        self.broken = -1
        return solver.dense_output()

    def _begin_again(self, cut: Cut) -> None:
        """Start anew where the last step did, with a shorter one, or behind a change of piece."""
        t, x = self.here
        self.rejected += 1
        if not cut.passage:
            self.solver = self._solver(t, x, cut.length)
            return
        half = 0.5 * cut.length
        self._pass_over(_Passage(cut.length, half, half), t, x, self.usual)

    def _pass_over(self, passage: _Passage, t: float, x: Array, step: float) -> None:
        """Go on behind a change of piece, with a step (s) from there."""
        along = self.solver.direction * passage.length
        if self.solver.direction * (self.end - t - along) <= 0:
            return
        before = self._slope(t, x)
        after = self._slope(t + along, x + along * before)
        jump = np.where(np.isfinite(after), after - before, 0.0)
        beyond = x + along * (before + (1 - passage.edge / passage.length) * jump)
        self.jumps.jump(t, beyond, passage.off * np.abs(jump))
        self.here = t + along, beyond
        self.solver = self._solver(t + along, beyond, step)

    def _go_on(self, solver: Any, edge: float) -> None:
        """After a step: the solver knows of the end again, and starts anew behind a change of piece.

        ``edge``: how far that is from the begin of the step, or 0.
        """
        self.last = abs(solver.t - solver.t_old)
        if self.watcher is None:
            cut = self.schedule is not None and solver.t == self.end
            self.usual = max(self.usual, self.last) if cut else self.last
            return
        at_bound = solver.t == solver.t_bound != self.end
        self.usual = self.last if not at_bound else max(self.usual, self.last)
        if at_bound and edge:
            unit = self.watcher.unit(solver.t)
            left = min(max(edge - self.last, 0.0), 8 * unit)
            step = min(self.usual, abs(self.end - solver.t))
            passage = _Passage(8 * unit, left, 2 * unit)
            self._pass_over(passage, float(solver.t), solver.y.copy(), step)
        elif at_bound:
            solver.status = "running"

    def _advances(self, solver: Any) -> bool:
        self.broken = -1
        try:
            solver.step()
        except (
            ValueError
        ):  # implicit methods refuse a matrix that is not finite: of rates, or of a tiny step
            return False
        except RuntimeError:  # a sparse matrix without an inverse
            return False
        stuck = solver.t == self.times[-1]  # LSODA goes on for ever where time does not
        return not stuck and solver.status != "failed" and bool(np.all(np.isfinite(solver.y)))

    def _is_left(self, solver: Any) -> bool:
        watch = self.problem.watch if self.steps % self.problem.watch_every == 0 else None
        return watch is not None and watch(solver.t, solver.y.copy(), solver.t - solver.t_old)

    def _failure(self, solver: Any) -> Stop:
        if max(self.broken, self.steep) >= 0:
            which = self.broken if self.broken >= 0 else self.steep
            return Stop("not finite", self.times[-1], which)
        slope = self._slope(float(solver.t), solver.y)
        finite = np.isfinite(slope) & np.isfinite(solver.y)
        if finite.all() and self._non_finite_ahead(solver):
            finite = np.isfinite(self.ahead)
        kind = "step" if finite.all() else "not finite"
        return Stop(kind, self.times[-1], int(np.argmin(finite)))

    def _non_finite_ahead(self, solver: Any) -> bool:
        """Look past the step that failed: a pole shows as numbers that are not finite."""
        step = 100 * abs(np.nextafter(solver.t, solver.t_bound) - solver.t)
        slope = self._slope(float(solver.t), solver.y)
        t = float(solver.t + solver.direction * step)
        self.ahead = self._slope(t, solver.y + solver.direction * step * slope)
        return not np.all(np.isfinite(self.ahead))

    def _find_singular(self, solver: Any, dense: Any) -> tuple[float, int] | None:
        """Return time and number of the first singularity within the margin in this step."""
        before, after = self.singular, self._singularities(solver.t, solver.y)
        self.singular = after
        if not len(after):
            return None
        self.closest = np.minimum(self.closest, np.abs(after))
        parts = self._parts_to_search(before, after, solver.y - self.points[-1])
        if not parts:
            return None
        return self._scan(solver.t_old, solver.t, dense, before, parts)

    def _parts_to_search(self, before: Array, after: Array, change: Array) -> int:
        """Return in how many parts to search a step, 0 if singularities are far."""
        near, moved = np.minimum(np.abs(before), np.abs(after)), np.abs(after - before)
        close = near < np.maximum(0.1, 2 * self.problem.margin)
        turned = max((abs(float(change[k])) for k in self.coordinates if k >= 0), default=0.0)
        if not np.any(close | (near < 2 * moved) | ~np.isfinite(after)) and turned < 0.5:
            return 0
        return PARTS + int(min(PARTS * turned, 1e6))

    def _scan(
        self, t_old: float, t_new: float, dense: Any, before: Array, parts: int
    ) -> tuple[float, int] | None:
        left = t_old
        for right in np.linspace(t_old, t_new, parts + 1)[1:]:
            here = self._singularities(right, dense(right))
            self.closest = np.minimum(self.closest, np.abs(here))
            hit = ((here > 0) != (before > 0)) | (np.abs(here) <= self.problem.margin)
            found = [
                (self._bisect(left, float(right), dense, int(k), float(before[k])), int(k))
                for k in np.flatnonzero(hit)
            ]
            if found:
                return min(found, key=lambda pair: abs(pair[0] - t_old))
            left, before = right, here
        return None

    def _bisect(self, low: float, high: float, dense: Any, k: int, before: float) -> float:
        for _ in range(60):
            middle = 0.5 * (low + high)
            value = self._singularities(middle, dense(middle))[k]
            if (value > 0) != (before > 0) or abs(value) <= self.problem.margin:
                high = middle
            else:
                low = middle
        return float(high)

    def _store_grid(self, t: float, dense: Any) -> None:
        grid, direction = (
            self.problem.t_eval,
            np.sign(self.problem.t_span[1] - self.problem.t_span[0]),
        )
        while grid is not None and self.next < len(grid) and direction * (grid[self.next] - t) <= 0:
            at = float(grid[self.next])
            self.grid_values.append(self.problem.x0 if dense is None else self._at(at, dense)[1])
            self.next += 1

    def _at(self, t: float, dense: Any) -> tuple[float, Array]:
        """Return time and state of a point to be stored."""
        x = dense(t)
        return t, x if self.projector is None else self.projector(t, x)

    def _projected(self, solver: Any, dense: Any) -> Any:
        """Bring the solver's state onto the invariants; return the interpolant of its last step."""
        assert self.projector is not None
        x = self.projector(float(solver.t), solver.y)
        if x is solver.y:
            return dense
        bent = _Bent(dense, float(solver.t_old), float(solver.t), x - solver.y)
        solver.y, solver.f = x, self._slope(float(solver.t), x)
        return bent

    def _finish(self, stop: Stop, x: Array) -> Trajectory:
        grid = self.problem.t_eval
        t = np.array(self.times) if grid is None else grid[: self.next].copy()
        points = self.points if grid is None else self.grid_values
        solution = None
        if self.problem.dense_output and self.interpolants:
            from scipy.integrate import OdeSolution

            solution = OdeSolution(np.array(self.times), self.interpolants)
        return Trajectory(
            t=t,
            y=np.array(points).T.reshape(len(self.problem.x0), len(t)),
            stop=stop,
            state_at_stop=np.array(x),
            closest=tuple(float(v) for v in self.closest),
            evaluations=self.evaluations,
            steps=self.steps,
            rejected=self.rejected,
            solution=solution,
            notice=self._notice(),
            held=None if self.schedule is None else self.schedule.held(),
        )

    def _notice(self) -> str:
        jumped = jumps.notice(self.jumps, self.problem)
        if self.method in SUNDIALS or self.problem.rtol >= LEAST_RTOL:
            return jumped
        least = f"SciPy's methods take no rtol below {LEAST_RTOL:.2g}: that was taken"
        return f"{least}; {jumped}" if jumped else least


JACOBIAN_UP_TO = 100
"""Implicit methods take the generated Jacobian where the rates are so many instructions or fewer: it is
then made in 0.02 to 0.2 s, once. Robertson's problem to 1e11 by Radau at 1e-8: 16,300 evaluations by
differences, 11,500 with it, in half the time; LSODA 3,600 and 3,100, in the same time. Programs of 90
to 500 instructions of linked pendulums take 0.6 to 6 s to differentiate, and runs 0.01 to 0.1 s. Who
runs those many times calls ``compiled.jacobian("states")`` first: what is made is used."""
SPARSE_FROM = 100
SPARSE_SHARE = 0.2
"""Others are given which rates can depend on which states, for systems of so many states or
more where that is at most this share of all pairs: differences are then taken of many columns at once,
and factorisations are sparse. One thread, chains of stiff springs: 200 states 1.3 to 1.8 times as fast, 400
states 2.4 to 3.8 times. The generated Jacobian gains no more, and takes longer to make than a run."""


def jacobian_of(compiled: Compiled) -> SparseJacobian | None:
    """Return the generated Jacobian of the rates where it is soon made, or has been; else None."""
    if len(prune(compiled.program, [RATES]).instructions) > JACOBIAN_UP_TO:
        return known_jacobian(compiled)
    return compiled.jacobian("states")


def sparsity(compiled: Compiled) -> Any:
    """Return a sparse matrix with ones where a rate can depend on a state, or None if it is full."""
    n = len(compiled.layout.states)
    if n < SPARSE_FROM:
        return None
    places = sorted(dependence(compiled.program, RATES))
    if len(places) > SPARSE_SHARE * n * n:
        return None
    from scipy.sparse import csr_array

    rows, columns = zip(*places, strict=True) if places else ((), ())
    return csr_array((np.ones(len(places)), (rows, columns)), shape=(n, n))
