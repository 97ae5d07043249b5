"""The same problem once more: by a method that has nothing in common with the first, and finer.

Two runs of one method agree where both are blind; so the second method comes from another family, with a
thousandth of the tolerance or less, absolute tolerances by the size that each state turned out to have, and
no step longer than a small part of the run. Of the methods that are left the first that gets to the end
counts.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled
from codegen.compiling.signals import Followed, Inputs
from codegen.integrate import choice, methods
from codegen.integrate.choice import Task
from codegen.integrate.methods import can_project, integrator_of
from codegen.ir.program import SameObject
from codegen.loops.taylor import order_of
from codegen.native.children import TooLongError, watch
from codegen.native.native import CompilerError
from codegen.native.trajectory import Array, Problem, Trajectory
from codegen.precision.conditioning import of_unit
from eom.errors import InputError

FAMILIES: Mapping[str, str] = {
    "DOP853": "Runge-Kutta of order 8",
    "scipy:DOP853": "Runge-Kutta of order 8",
    "DP5": "Runge-Kutta of order 5",
    "Tsit5": "Runge-Kutta of order 5",
    "scipy:RK45": "Runge-Kutta of order 5",
    "scipy:LSODA": "several steps",
    "scipy:BDF": "several steps",
    "sundials:BDF": "several steps",
    "sundials:Adams": "several steps",
}
"""What methods have in common; a method that is not listed is its own family."""
IMPLICIT = ("scipy:Radau", "scipy:BDF", "scipy:LSODA", "sundials:BDF")
ABSOLUTE = 1e-3
"""Absolute tolerance over the relative one times the size of a state."""
NOISE = 2.0**-56
"""Part of the largest state of its unit below which a state may be rounding: it is not resolved further."""
LONGEST_PART = {True: 1 / 128, False: 1 / 512}
"""Steps are at most this part of the run, implicit ones (each of which costs more) and others."""
LEGS = 32
"""Times at which a method is stopped whose interpolant is less accurate than its steps."""
SAME = 1e-6
"""Part of the run by which the second may stop earlier: at a singular configuration, or where both fail."""
KEPT = 20_000_000
"""Numbers of dense output that are kept at most."""


BETWEEN = 4
"""Points of a step at which the Jacobian is looked at."""
MOST_NODES = 100_000
"""Such points, in all."""


@dataclass(frozen=True)
class Candidate:
    """A method for the second run, its tolerance over that of the first, and the least that it keeps.

    Series are often a thousand times better than their tolerance: in C, where that costs little, what they
    are compared with is finer than that. ``legs``: whether its interpolant is less accurate than its steps.
    """

    method: str
    finer: float
    least: float
    legs: bool = False


CANDIDATES = (
    Candidate("taylor", 1e-5, 2.0**-52),
    Candidate("DOP853", 1e-5, 1e-14),
    Candidate("scipy:LSODA", 1e-3, 1e-13),
    Candidate("scipy:Radau", 1e-3, 1e-12, legs=True),
)


@dataclass(frozen=True, eq=False)
class Origin:
    """What a result came from: enough to run it again, in another way.

    ``methods``: those that integrated, by their names or ``closed form``.
    """

    compiled: Compiled
    problem: Problem
    signals: Inputs | None
    method: str
    methods: tuple[str, ...]
    held: Followed | None = None
    """The inputs along the run, where laws are sampled."""

    def again(self, problem: Problem, method: str) -> Trajectory:
        """Integrate a changed problem by a method."""
        return integrator_of(Task(self.compiled, problem, self.signals), method)[0](problem)

    def inputs(self, t: Array, y: Array) -> Array:
        """Return the inputs at times (K,) in states (n, K): (m,) if they are held, else (m, K)."""
        known = self.held or self.signals
        return self.problem.inputs if known is None else known.along(t, y)

    @property
    def is_open(self) -> bool:
        """Whether the derivatives of the compiled rates by the states are all there are."""
        return not self.problem.laws and (self.signals is None or not self.signals.of_state)


@dataclass(frozen=True)
class Track:
    """A trajectory to be judged: times (K,), states (n, K) at these, and steps that were made."""

    t: Array
    y: Array
    steps: int


@dataclass(frozen=True)
class Second:
    """What the second run gave: states ``y`` (n, K) at times ``t`` (K,), and where its steps went.

    ``which`` (K,): their numbers among the times of the track. ``nodes`` (M,), ``path`` (n, M): ends of its
    steps and points between them, empty where they were too many to keep. ``trouble``: why it has not
    come as far as the first.
    """

    method: str
    rtol: float
    which: NDArray[np.intp]
    t: Array
    y: Array
    nodes: Array
    path: Array
    steps: int
    trouble: str = ""


Runner = Callable[[Origin, Problem, Candidate, Array], Second]


def begin(origin: object) -> None:
    """Begin to compile the loop of the second run, beside all that is done before `second_run`.

    ``origin``: that of a result; nothing is begun where it is none.
    """
    if not isinstance(origin, Origin) or origin.problem.laws or origin.compiled.target != "c":
        return
    compiled = origin.compiled
    for first in _candidates(origin):
        if first.method != "taylor" or _has_series(origin):
            rtol = max(first.finer * origin.problem.rtol, first.least)
            methods.begin(compiled.program, compiled.layout, first.method, rtol)
            return


def _candidates(origin: Origin) -> list[Candidate]:
    """Return what may make the second run, in order: methods of other families than the first."""
    used = {FAMILIES.get(m, m) for m in origin.methods}
    found = [c for c in CANDIDATES if FAMILIES.get(c.method, c.method) not in used]
    if any(m in IMPLICIT for m in origin.methods):
        return [c for c in found if c.method != "taylor"]
    return found


def second_run(origin: Origin, track: Track, limit: float) -> Second | str:
    """Return the second run over the times of a track, or why there is none.

    ``limit``: seconds of processor time for all that is tried.
    """
    candidates = _candidates(origin)
    reasons: list[str] = []
    partial: list[Second] = []
    end = time.process_time() + limit
    for k, candidate in enumerate(candidates):
        left = (end - time.process_time()) / (1 if k == len(candidates) - 1 else 2)
        found = _tried(origin, track, candidate, max(left, limit / 8))
        if isinstance(found, str):
            reasons.append(f"{candidate.method} {found}")
        elif found.trouble:
            partial.append(found)
        else:
            return found
    if partial:
        return max(partial, key=lambda s: len(s.t))
    return "; ".join(reasons) or "no other method applies"


def _tried(origin: Origin, track: Track, candidate: Candidate, limit: float) -> Second | str:
    """Return the run of one candidate, or why there is none."""
    if candidate.method == "taylor" and not _has_series(origin):
        return "does not apply"
    problem = _finer(origin.problem, track, candidate, _units(origin, track))
    problem = replace(problem, progress=watch(limit))
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            run = _in_legs if candidate.legs and not problem.laws else _at_once
            return run(origin, problem, candidate, track.t)
    except TooLongError:
        return f"takes more than {limit:.2g} s"
    except (InputError, CompilerError) as error:
        return f"refuses: {error.what}"


def _has_series(origin: Origin) -> bool:
    """Return whether the rates have a Taylor series of a reasonable length, in C."""
    if origin.signals is not None or origin.compiled.target != "c":
        return False
    return choice.series_cost(SameObject(origin.compiled), order_of(2.0**-52)) <= choice.LONGEST


def _units(origin: Origin, track: Track) -> tuple[Array, Array]:
    """Return the largest size of each state and of those of its unit, (n,)."""
    finite = np.where(np.isfinite(track.y), np.abs(track.y), 0.0)
    own = finite.max(axis=1, initial=0.0)
    return own, of_unit(origin.compiled.layout, own)


def _finer(
    problem: Problem, track: Track, candidate: Candidate, sizes: tuple[Array, Array]
) -> Problem:
    """Return the problem of the second run, from the start to the last time of a track."""
    own, unit = sizes
    rtol = max(candidate.finer * problem.rtol, candidate.least)
    by_size = np.maximum(ABSOLUTE * rtol * own, NOISE * unit)
    scaled = problem.atol * min(1.0, rtol / problem.rtol)
    span = float(problem.t_span[0]), float(track.t[-1])
    part = LONGEST_PART[candidate.method in IMPLICIT] * abs(span[1] - span[0])
    longest = min(problem.max_step, max(part, abs(span[1] - span[0]) / max(track.steps, 1)))
    return replace(
        problem,
        t_span=span,
        rtol=rtol,
        atol=np.where(by_size > 0, np.minimum(scaled, by_size), scaled),
        margin=0.5 * problem.margin,
        t_eval=None,
        dense_output=True,
        first_step=None,
        max_step=min(longest, part),
        project=problem.project if can_project(candidate.method) else (),
        watch=None,
        events=(),
    )


def _at_once(origin: Origin, problem: Problem, candidate: Candidate, times: Array) -> Second:
    """Run with dense output, or with the times alone where that would be too large."""
    most = max(1000, KEPT // (32 * len(problem.x0)))
    dense = replace(problem, max_steps=min(problem.max_steps, most))
    made = origin.again(dense, candidate.method)
    which, none = np.arange(len(times)), (times[:0], made.y[:, :0])
    if made.stop.kind == "max_steps" and made.steps + made.rejected >= most:
        bare = replace(problem, t_eval=times, dense_output=False)
        made = origin.again(bare, candidate.method)
        return _second(candidate, problem, (which, times), made, made.y, none)
    reached = _within(times, problem, made)
    states = np.asarray(made.solution(times[:reached])) if made.solution else made.y[:, :0]
    if reached and times[reached - 1] == made.stop.t:
        states[:, -1] = made.state_at_stop
    nodes = _between(made)
    return _second(candidate, problem, (which, times), made, states, nodes)


def _within(times: Array, problem: Problem, made: Trajectory) -> int:
    """Return how many of the times a run has reached."""
    direction = math.copysign(1.0, problem.t_span[1] - problem.t_span[0])
    return int(np.count_nonzero(direction * (times - made.stop.t) <= 0))


def _second(
    candidate: Candidate,
    problem: Problem,
    at: tuple[NDArray[np.intp], Array],
    made: Trajectory,
    states: Array,
    nodes: tuple[Array, Array],
) -> Second:
    """Return what a run gave, at the first of the numbers and times ``at``."""
    kind, (start, end) = made.stop.kind, problem.t_span
    close = abs(made.stop.t - end) <= SAME * abs(end - start)
    trouble = "" if kind == "end" or close else f"stops at t = {made.stop.t:.6g} s ({kind})"
    count = states.shape[1]
    which, t = at[0][:count], at[1][:count]
    return Second(candidate.method, problem.rtol, which, t, states, *nodes, made.steps, trouble)


def _between(made: Trajectory) -> tuple[Array, Array]:
    """Return ends of steps and points between them, and states there; none where they are too many."""
    t = made.t
    parts = min(BETWEEN, MOST_NODES // max(1, len(t)))
    if parts < 1 or made.solution is None or len(t) < 2:
        return t[:0], made.y[:, :0]
    inner = t[:-1, None] + np.diff(t)[:, None] * (np.arange(parts) / parts)
    nodes = np.concatenate([inner.ravel(), t[-1:]])
    path = np.asarray(made.solution(nodes))
    path[:, ::parts] = made.y
    return nodes, path


def _in_legs(origin: Origin, problem: Problem, candidate: Candidate, times: Array) -> Second:
    """Run from time to time, so that states at these are ends of steps."""
    which = np.unique(np.linspace(0, len(times) - 1, LEGS + 1).round().astype(int))
    chosen = times[which]
    start, t, x = problem.t_span[0], [problem.t_span[0]], problem.x0
    nodes, path, states, steps, last = [np.array(t)], [x[:, None]], [], 0, None
    for at in chosen.tolist():
        if at != start:
            leg = replace(problem, x0=x, t_span=(start, at), dense_output=False)
            last = origin.again(leg, candidate.method)
            nodes.append(last.t[1:])
            path.append(last.y[:, 1:])
            steps += last.steps
            if last.stop.kind != "end":
                break
            start, x = at, last.state_at_stop
        states.append(x)
    assert last is not None
    whole = np.array(states).T.reshape(len(x), len(states))
    joined = np.concatenate(nodes), np.concatenate(path, axis=1)
    return replace(_second(candidate, problem, (which, chosen), last, whole, joined), steps=steps)
