"""How good a run is: the error of each state, how it grows, and when no digit is left.

The error is what a second run differs by (`codegen.runs.second_run`): another kind of method, a thousandth
of the tolerance or less. Where both come to the limits of double precision, rounding that is carried along
the trajectory is the least error reported. Growth of errors and its rate come from the derivative along
the trajectory. A closed form makes no steps and sums no errors; it is good to
a few units in the last place, if the second run is not further from it than its own steps explain.

Small changes d of the states obey d' = J d with the Jacobian J of the rates along the trajectory. From
node to node they are carried by the (2, 3) Pade approximation of exp(h J), of order 5 and L-stable: stiff
changes die out as they do in truth (Hairer and Wanner, Solving Ordinary Differential Equations II (1996),
sect. IV.3). Changes are in units of the size of each state. Growth is the largest factor of any change made
at the start; its logarithm over the time is the finite-time Lyapunov exponent (Benettin, Galgani, Giorgilli
and Strelcyn, Meccanica 15 (1980) 9).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled, compiled_jacobian
from codegen.frontend.layout import Layout, names_of
from codegen.integrate.choice import CLOSED_FORM
from codegen.ir.program import RATES
from codegen.native.trajectory import Array
from codegen.precision.conditioning import Sizes, of_unit
from codegen.runs.second_run import Origin, Second, Track, second_run
from eom.errors import InputError

LOST = 0.1
"""Error over size from which on no digit is left."""
FEW, LEAST = 5.0, 2.0
"""A second run may take so many times the seconds of the first; and so many seconds in any case."""
MOST_TIMES = 2000
"""Stored times at most at which runs are compared, evenly by number."""
ENOUGH_TIMES = 65
"""Where fewer times are stored the run is made again to look at more."""
CLOSED_ULPS = 8.0
"""Rounding of a closed form, in units of 2^-53 of the largest state of its unit."""
EXPLAINED = 8.0
"""Times the errors of its steps, all in the worst sense, that the second run may be off a closed form."""
SAME = 1e-6
"""Relative difference of the ends of a run and of the same run made again, at most."""
NOISY = 8.0
"""Size over the rounding of the terms of its rate up to which a state may be made of rounding."""
DECLINE = 3.0
"""Largest error over that at the end from which on both are reported."""


@dataclass(frozen=True, repr=False)
class Accuracy:
    """How good a run is: estimated errors of its states, from its start to where it stopped.

    Parameters
    ----------
    states : tuple of str
        Their names.
    t : array
        Times at which the error was looked at, (K,).
    error : array
        Of each state, in its unit: ``error`` (n, K).
    size : array
        What it is relative to, (n,): the largest value on the way of all states of the same unit
        (by the second run), of angles 1 rad at most.
    growth : array
        The factor by which an error of the start is larger there, at most, in these relative terms,
        (K,); NaN where it is not known.
    rate : float
        Its logarithm over the time, at the end (1/s), the finite-time Lyapunov exponent.
    horizon : float
        Time (s) from which on an error is a tenth of the size, so that no digit is left; None where
        that is not so in this run.
    lost : tuple of str, optional
        States that are much smaller than others of their unit, of which no digit is left at the
        end.
    second : str, optional
        The method that was compared with.
    trouble : str, optional
        Why errors are not known, or not to the end.

    Notes
    -----
    Units are those of the system.

    References
    ----------
    Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15 (1980) 9, for the rate.
    """

    states: tuple[str, ...]
    t: Array
    error: Array
    size: Array
    growth: Array
    rate: float
    horizon: float | None
    lost: tuple[str, ...] = ()
    second: str = ""
    trouble: str = ""

    @property
    def at_end(self) -> Mapping[str, float]:
        """The estimated error of each state at the end, in its unit; NaN where it is not known."""
        last = self.error[:, -1] if self.error.size else np.full(len(self.states), np.nan)
        return dict(zip(self.states, last.tolist(), strict=True))

    @property
    def largest(self) -> Mapping[str, float]:
        """The largest estimated error of each state on the way, in its unit."""
        most = self.error.max(axis=1) if self.error.size else np.full(len(self.states), np.nan)
        return dict(zip(self.states, most.tolist(), strict=True))

    @cached_property
    def relative(self) -> Array:
        """The largest error over the size, at each time (K,)."""
        if not self.error.size:
            return np.empty(0)
        return np.asarray(np.max(self.error / self.size[:, None], axis=0))

    @property
    def known(self) -> bool:
        """Whether errors are known up to the end of the run."""
        return bool(self.error.size) and not self.trouble

    def __str__(self) -> str:
        """Say it in a sentence."""
        if not self.error.size:
            return f"not known: {self.trouble}"
        if len(self.t) == 1:
            return "the run did not leave its start"
        after = (
            f"; not known after t = {self._time(self.t[-1])} s, {self.trouble}"
            if self.trouble
            else ""
        )
        if self.horizon is not None:
            return f"no digit is left after t = {self._time(self.horizon)} s{after}"
        none = f"; no digit of {', '.join(self.lost)}" if self.lost else ""
        last, most = float(self.relative[-1]), float(self.relative.max())
        way = f", to {most:.0e} on the way" if most > DECLINE * last else ""
        where = "there" if after else "at the end"
        return f"good to about {max(last, UNIT_ROUNDOFF):.0e} {where}{way}{none}{after}"

    def _time(self, t: float) -> str:
        """Return a time to a hundredth of the run or less."""
        places = 2 - math.floor(math.log10(abs(float(self.t[-1] - self.t[0])) or 1.0))
        return f"{t:.{max(0, places)}f}"

    def __repr__(self) -> str:
        """Say it in a sentence."""
        return f"Accuracy({self})"

    @property
    def warning(self) -> str:
        """What the user has to know: that no digit is left, of all or of some states; else nothing."""
        proves = "that constants of the motion hardly drift proves nothing"
        if self.horizon is not None:
            after = f"after t = {self._time(self.horizon)} s"
            return f"{after} the states are not those of this motion; {proves}"
        return f"no digit of {', '.join(self.lost)} is left; {proves}" if self.lost else ""


@dataclass(frozen=True)
class Run:
    """What of a `codegen.Result` its accuracy is about; the fields are those of it."""

    t: Array
    y: Array
    t_stop: float
    y_stop: Array
    status: int
    steps: int
    seconds: float
    origin: object


def accuracy_of(result: Run, limit: float | None = None) -> Accuracy:
    """Return how good a run is; as `codegen.Result.accuracy`, which see."""
    origin = result.origin
    if not isinstance(origin, Origin):
        raise InputError(
            "a result that does not know what it came from",
            where="accuracy",
            expected="a result as `codegen.simulate` returns it",
            hint="ask before it is pickled or saved",
        )
    start = origin.problem.start
    found = _over_run(_since_start(result, origin) if start else result, origin, limit)
    horizon = None if found.horizon is None else start + found.horizon
    return replace(found, t=start + found.t, horizon=horizon)


def _since_start(result: Run, origin: Origin) -> Run:
    """Return a late run over the time since its start; times that were rounded are found again."""
    problem = origin.problem
    ended = result.status == 0
    stop = problem.t_span[1] if ended else result.t_stop - problem.start
    if problem.t_eval is None and not problem.events:
        made = origin.again(problem, origin.method)
        if len(made.t) == len(result.t):
            return replace(result, t=made.t, t_stop=made.stop.t)
    return replace(result, t=result.t - problem.start, t_stop=stop)


def _over_run(result: Run, origin: Origin, limit: float | None) -> Accuracy:
    """Return the accuracy over the time of the run, which is that since its start where this is late."""
    seconds = max(LEAST, FEW * result.seconds) if limit is None else limit
    track = _track(result, origin)
    if len(track.t) < 2 or track.t[-1] == track.t[0]:
        return _unmoved(origin, track, _sizes(origin.compiled.layout, track.y))
    second = second_run(origin, track, seconds)
    if isinstance(second, str):
        return _unknown(origin, _sizes(origin.compiled.layout, track.y), second)
    size = _sizes(origin.compiled.layout, second.y)
    grown = None
    if origin.is_open:
        grown = growth(
            origin.compiled, origin.problem.parameters, lambda t: origin.inputs(t, second.path),
            second.nodes, second.path, size, track.steps,
        )  # fmt: skip
    return _judged(origin, track, size, second, grown)


def _track(result: Run, origin: Origin) -> Track:
    """Return times and states to compare: stored ones, those of the run made again where they are few."""
    t, y, steps = result.t, result.y, result.steps
    if len(t) < ENOUGH_TIMES and result.t_stop != origin.problem.t_span[0]:
        t, y = _again(result, origin)
    chosen = _chosen(t)
    t, y = t[chosen], y[:, chosen]
    if not len(t) or t[-1] != result.t_stop:
        t, y = np.append(t, result.t_stop), np.column_stack([y, result.y_stop])
    if t[0] != origin.problem.t_span[0]:
        t = np.append(origin.problem.t_span[0], t)
        y = np.column_stack([origin.problem.x0, y])
    return Track(t, y, steps)


def _chosen(t: Array) -> NDArray[np.intp]:
    """Return the numbers of the times (N,) to compare at: half of them even by number, half by time."""
    if len(t) <= MOST_TIMES:
        return np.arange(len(t))
    by_number = np.linspace(0, len(t) - 1, MOST_TIMES // 2).round().astype(np.intp)
    sign = math.copysign(1.0, t[-1] - t[0])
    by_time = np.searchsorted(sign * t, sign * np.linspace(t[0], t[-1], MOST_TIMES // 2))
    return np.unique(np.concatenate([by_number, np.minimum(by_time, len(t) - 1)]))


def _again(result: Run, origin: Origin) -> tuple[Array, Array]:
    """Return more times of the same run, and its states; those that are stored, if it is not the same."""
    start = origin.problem.t_span[0]
    grid = np.linspace(start, result.t_stop, ENOUGH_TIMES)
    sign = math.copysign(1.0, result.t_stop - start)
    times = sign * np.unique(sign * np.concatenate([grid, result.t]))
    problem = replace(origin.problem, t_eval=times, dense_output=False, events=())
    made = origin.again(problem, origin.method)
    if len(made.t) != len(times) or not np.allclose(made.y[:, -1], result.y_stop, rtol=SAME):
        return result.t, result.y
    y = made.y.copy()
    places = np.searchsorted(sign * times, sign * result.t)
    y[:, places] = result.y
    return times, y


def _sizes(layout: Layout, y: Array) -> Array:
    """Return what errors of states (n, K) are relative to, (n,)."""
    finite = np.where(np.isfinite(y), np.abs(y), 0.0)
    size = of_unit(layout, finite.max(axis=1, initial=0.0))
    angle = np.array([q.unit == "rad" for q in layout.states], dtype=bool)
    size = np.where(angle, np.minimum(size, 1.0), size)
    return np.where(size > 0, size, 1.0)


def _unmoved(origin: Origin, track: Track, size: Array) -> Accuracy:
    """Return the accuracy of a run that has not left its start: the state is as it was given."""
    names = names_of(origin.compiled.layout.states)
    return Accuracy(names, track.t[:1], np.zeros((len(names), 1)), size, np.ones(1), 0.0, None)


def _unknown(origin: Origin, size: Array, trouble: str) -> Accuracy:
    names = names_of(origin.compiled.layout.states)
    none = np.empty((len(names), 0))
    return Accuracy(names, np.empty(0), none, size, np.empty(0), math.nan, None, trouble=trouble)


def _judged(
    origin: Origin, track: Track, size: Array, second: Second, grown: Growth | None
) -> Accuracy:
    """Put together what a second run differs by, what rounding makes at least, and growth."""
    t, y = second.t, track.y[:, second.which]
    factor = _growth_at(t, grown)
    apart = np.abs(y - second.y)
    apart = np.where(np.isfinite(apart), apart, np.inf)
    if origin.methods == (CLOSED_FORM,) and _is_explained(apart, second, factor, size):
        unit = of_unit(origin.compiled.layout, np.abs(y))
        error = CLOSED_ULPS * UNIT_ROUNDOFF * unit
    else:
        error = np.maximum(apart, _rounding(t, y, size, grown))
    error[:, t == origin.problem.t_span[0]] = 0.0
    elapsed = abs(float(t[-1] - t[0])) if len(t) else 0.0
    rate = math.log(factor[-1]) / elapsed if elapsed and factor[-1] > 0 else math.nan
    if grown is not None and elapsed:
        rate = float(grown.logarithm[-1]) / abs(float(grown.t[-1] - grown.t[0]))
    found = Accuracy(
        names_of(origin.compiled.layout.states), t, error, size, factor, rate, None,
        _lost(origin, second, error), second.method, second.trouble and f"{second.method} {second.trouble}",
    )  # fmt: skip
    return replace(found, horizon=_horizon(t, found.relative))


def _lost(origin: Origin, second: Second, error: Array) -> tuple[str, ...]:
    """Return states whose error is a tenth of what they are themselves, but for those that are rounding.

    A state that is zero but for rounding is not larger than the rounding of the terms of its rate.
    """
    if not second.y.size or not len(second.nodes):
        return ()
    own = np.max(np.abs(second.y), axis=1)
    sizes = Sizes(origin.compiled, RATES)
    with np.errstate(all="ignore"):
        terms = sizes.terms(
            second.nodes,
            second.path,
            origin.problem.parameters,
            origin.inputs(second.nodes, second.path),
        )
    noise = UNIT_ROUNDOFF * np.nansum(terms[:, 1:] * np.abs(np.diff(second.nodes)), axis=1)
    gone = (error[:, -1] >= LOST * own) & (own > NOISY * noise)
    return tuple(q.name for q, g in zip(origin.compiled.layout.states, gone, strict=True) if g)


def _growth_at(t: Array, grown: Growth | None) -> Array:
    """Return the growth at times, interpolated in its logarithm."""
    if grown is None:
        return np.full(len(t), np.nan)
    with np.errstate(over="ignore"):
        return np.exp(_interpolated(t, grown.t, grown.logarithm))


def _interpolated(t: Array, nodes: Array, values: Array) -> Array:
    sign = 1.0 if nodes[-1] >= nodes[0] else -1.0
    return np.interp(sign * t, sign * nodes, values)


def _rounding(t: Array, y: Array, size: Array, grown: Growth | None) -> Array:
    """Return the least error (n, K): rounding of the states, and what the rounding of steps has become."""
    least = UNIT_ROUNDOFF * np.abs(y)
    if grown is None:
        return np.asarray(least)
    rows = [_interpolated(t, grown.t, row) for row in grown.rounding]
    return np.maximum(least, np.array(rows) * size[:, None])


def _is_explained(apart: Array, second: Second, factor: Array, size: Array) -> bool:
    """Return whether errors of the steps of the second run explain how far it is from a closed form."""
    worst = np.maximum.accumulate(np.fmax(factor, 1.0))
    allowed = EXPLAINED * (second.steps + 1) * max(second.rtol, UNIT_ROUNDOFF) * worst
    return bool(np.all(apart <= allowed * size[:, None]))


def _horizon(t: Array, relative: Array) -> float | None:
    """Return when the relative error reaches `LOST`, between two times by its logarithm."""
    lost = np.flatnonzero(relative >= LOST)
    if not lost.size:
        return None
    k = int(lost[0])
    if k == 0 or not (relative[k - 1] > 0 and math.isfinite(relative[k])):
        return float(t[k])
    part = math.log(LOST / relative[k - 1]) / math.log(relative[k] / relative[k - 1])
    return float(t[k - 1] + part * (t[k] - t[k - 1]))


UNIT_ROUNDOFF = 2.0**-53
MOST_STATES = 48
"""States from which on whole matrices cost more than they show."""
GROUPS = 1500
"""Propagators that are applied one after the other; those of more nodes are multiplied beforehand."""
HUGE = 1e100
"""Size at which numbers are scaled back."""


@dataclass(frozen=True)
class Growth:
    """At nodes ``t`` (M,): the logarithm of the growth, and rounding so far (n, M) in units of the sizes.

    ``rounding``: standard deviation of what the errors of one unit roundoff of each change of a state make.
    """

    t: Array
    logarithm: Array
    rounding: Array


Inputs = Callable[[Array], Array]


def growth(
    compiled: Compiled,
    parameters: Array,
    inputs: Inputs,
    nodes: Array,
    path: Array,
    sizes: Array,
    steps: int,
) -> Growth | None:
    """Return what becomes of errors along states ``path`` (n, M) at ``nodes`` (M,); None if not known.

    ``sizes`` (n,): what errors are relative to. ``steps``: how many steps the run made that is judged:
    so often its states were rounded.
    """
    n, count = path.shape
    if count < 2 or n > MOST_STATES:
        return None
    J = compiled_jacobian(compiled, target="numpy").dense(nodes, path, parameters, inputs(nodes))
    M = _propagators(np.diff(nodes), J * sizes[None, :, None] / sizes[:, None, None])
    if not np.isfinite(M).all():
        return None
    changes = np.abs(np.diff(path, axis=1)) / sizes[:, None] * math.sqrt(count / max(1, steps))
    every = 1
    while len(M) > GROUPS:
        M, changes, every = _halved(M), _paired(changes), 2 * every
    t = np.append(nodes[: count - 1 : every], nodes[-1])
    return Growth(t, _logarithms(M), _deviations(M, UNIT_ROUNDOFF * changes))


def _halved(M: Array) -> Array:
    """Return propagators (K, n, n) over two nodes each."""
    if len(M) % 2:
        M = np.concatenate([M, np.eye(M.shape[1])[None]])
    return np.asarray(M[1::2] @ M[::2])


def _paired(changes: Array) -> Array:
    """Return roots of sums of two squares (n, K) each."""
    if changes.shape[1] % 2:
        changes = np.append(changes, np.zeros((len(changes), 1)), axis=1)
    return np.hypot(changes[:, ::2], changes[:, 1::2])


def _logarithms(M: Array) -> Array:
    """Return the logarithm of the largest sum of a row of M_k ... M_1, from the empty product on."""
    carried, scaled, found = np.eye(M.shape[1]), 0.0, [0.0]
    for m in M:
        carried = m @ carried
        size = float(np.abs(carried).sum(axis=1).max())
        found.append(scaled + math.log(size) if size > 0 else -math.inf)
        if size > HUGE or 0 < size < 1 / HUGE:
            carried, scaled = carried / size, scaled + math.log(size)
    return np.array(found)


def _deviations(M: Array, changes: Array) -> Array:
    """Return standard deviations (n, K + 1) of errors ``changes`` (n, K), all independent; at most 1.

    A root of the covariance is carried, by QR factorisation: differences of squares would lose all digits.
    """
    n = M.shape[1]
    root, found = np.zeros((n, n)), [np.zeros(n)]
    for m, change in zip(M, changes.T, strict=True):
        both = np.concatenate([(m @ root).T, np.diag(change)])
        upper: Array = np.asarray(np.linalg.qr(both, mode="r"))
        root = upper.T
        deviation = np.linalg.norm(root, axis=1)
        if deviation.max() > 1:
            root = root / np.maximum(deviation, 1.0)[:, None]
        found.append(np.minimum(deviation, 1.0))
    return np.array(found).T


def _propagators(h: Array, J: Array) -> Array:
    """Return exp(h J) from node to node, (M - 1, n, n), by J at both ends (n, n, M)."""
    Z = np.moveaxis(0.5 * (J[:, :, 1:] + J[:, :, :-1]) * h, 2, 0)
    one = np.eye(Z.shape[1])
    square = Z @ Z
    below = one - 0.6 * Z + 0.15 * square - Z @ square / 60
    try:
        return np.asarray(np.linalg.solve(below, one + 0.4 * Z + 0.05 * square))
    except np.linalg.LinAlgError:
        return np.full_like(Z, np.nan)
