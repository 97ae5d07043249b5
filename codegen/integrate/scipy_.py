"""SciPy's integrators over the compiled functions, stopped by the same rules as the generated."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from codegen.compiled import Compiled
from codegen.derivative import dependence
from codegen.integrate.trajectory import Array, Problem, Stop, Trajectory
from codegen.lower import RATES

METHODS = ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")
PARTS = 8
REPORT_EVERY = 100

IMPLICIT = ("Radau", "BDF")
SPARSE_FROM = 100
SPARSE_SHARE = 0.2
"""Implicit methods are told which rates can depend on which states, for systems of so many states or
more where that is at most this share of all pairs: differences are then taken of many columns at once,
and factorisations are sparse. One thread, chains of stiff springs: 200 states 1.3 to 1.8 times as fast, 400
states 2.4 to 3.8 times. The compiled Jacobian gains no more, and takes longer to make than a run."""

Inputs = Callable[[float], Array]


def integrate(
    compiled: Compiled, problem: Problem, method: str, inputs: Inputs | None = None
) -> Trajectory:
    """Integrate with one of `METHODS`. ``inputs``: values of the inputs over time, if not held."""
    return _Run(compiled, problem, method, inputs).run()


def _sparsity(compiled: Compiled) -> Any:
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


class _Run:
    """One run: SciPy's solver steps, this looks at what it did."""

    def __init__(
        self, compiled: Compiled, problem: Problem, method: str, inputs: Inputs | None
    ) -> None:
        self.problem = problem
        self.singular_function = compiled.functions.get("singularities")
        self.coordinates = compiled.layout.coordinates
        self.rhs = compiled.rhs
        self.sparsity = _sparsity(compiled) if method in IMPLICIT else None
        self.inputs = inputs
        self.method = method
        self.evaluations = 0
        self.broken = -1
        """Number of a rate that was not finite in the step that is tried, or -1."""
        self.steps = 0
        self.times = [problem.t_span[0]]
        self.points = [problem.x0]
        self.interpolants: list[Any] = []
        self.grid_values: list[Array] = []
        self.next = 0
        self.singular = self._singularities(problem.t_span[0], problem.x0)
        self.closest = np.abs(self.singular)

    def _u(self, t: float) -> Array:
        return self.problem.inputs if self.inputs is None else self.inputs(t)

    def _slope(self, t: float, x: Array) -> Array:
        self.evaluations += 1
        slope = self.rhs(t, x, self.problem.parameters, self._u(t))
        finite = np.isfinite(slope)
        if not finite.all():
            self.broken = int(np.argmin(finite))
        return slope

    def _singularities(self, t: float, x: Array) -> Array:
        if self.singular_function is None:
            return np.empty(0)
        return self.singular_function(float(t), x, self.problem.parameters, self._u(t))

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
            solver = self._solver()
            while solver.status == "running":
                stop = self._step(solver)
                if stop is not None:
                    return self._finish(stop, self.points[-1])
        return self._finish(Stop("end", end), self.points[-1])

    def _solver(self) -> Any:
        from scipy import integrate as si

        problem = self.problem
        options: dict[str, Any] = {
            "rtol": problem.rtol,
            "atol": problem.atol,
            "max_step": problem.max_step,
        }
        if self.sparsity is not None:
            options["jac_sparsity"] = self.sparsity
        if problem.first_step:
            span = abs(problem.t_span[1] - problem.t_span[0])
            options["first_step"] = min(problem.first_step, span)
        return getattr(si, self.method)(
            self._slope, problem.t_span[0], problem.x0, problem.t_span[1], **options
        )

    def _step(self, solver: Any) -> Stop | None:
        """Take one step; return why the run has to stop, if it has to."""
        if self.steps >= self.problem.max_steps:
            return Stop("max_steps", solver.t)
        self.broken = -1
        try:
            solver.step()
        except ValueError:  # implicit methods refuse a matrix that is not finite
            if self.broken < 0:
                raise
            return self._failure(solver)
        except RuntimeError:  # a sparse matrix without an inverse
            return self._failure(solver)
        stuck = solver.t == self.times[-1]  # LSODA goes on for ever where time does not
        if stuck or solver.status == "failed" or not np.all(np.isfinite(solver.y)):
            return self._failure(solver)
        self.steps += 1
        if self.steps % REPORT_EVERY == 0:
            self.problem.report(solver.t)
        dense = solver.dense_output()
        where = self._find_singular(solver, dense)
        t, x = (solver.t, solver.y.copy()) if where is None else (where[0], dense(where[0]))
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
        return None if where is None else Stop("singular", t, where[1])

    def _failure(self, solver: Any) -> Stop:
        if self.broken >= 0:
            return Stop("not finite", self.times[-1], self.broken)
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
            self.grid_values.append(self.problem.x0 if dense is None else dense(grid[self.next]))
            self.next += 1

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
            rejected=0,
            solution=solution,
        )
