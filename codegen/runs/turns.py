"""Whole turns of angles along a run: what a quaternion does not know, counted from sample to sample.

Of the angles of a sequence (`eom.system.SequenceAngles`) a state gives the first and the third up to whole
turns. Here they become continuous functions of time, from values between -pi and pi at the first sample.
Between two samples the change of each is known but for a multiple of 2 pi: it is that nearest to zero,
where the body turns little and the angles by less than a right angle. Else dense output is looked at at
`PARTS` points, and at as many between two of these, where an angle still changes by more. The ends of its
steps are samples too: how fast the body turned on the way cannot be seen from times that are stored. Where
there is no dense output, or no end of looking closer, turns are not known, and the run's notice says so.

Next to a singular configuration the two angles change by half a turn in no time, and on it they are
not defined one by one, but the one plus or less the other is: with a, b the axes of the first and the third
turn and c the sign of a.b, psi + c phi has the rate omega.(a + c b)/(1 + |a.b|), at most sqrt(2) |omega|.
So the third angle follows from this sum, where all three are asked for; the first goes the shorter way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled
from codegen.compiling.signals import Followed
from codegen.frontend.layout import names_of
from codegen.ir.program import OUTPUTS, RATES
from codegen.native.trajectory import Array, Problem, Trajectory
from eom.system import SequenceAngles

TURN = 2 * math.pi
SMALL = 0.5
"""Turn of the body (rad) up to which the sum of the angles cannot change by half a turn."""
FAR = math.pi / 2
"""Change of an angle (rad) from which on it is looked at between."""
PARTS = 16
LEVELS = 3
"""How often a stretch is cut into `PARTS` at most."""
BLOCK = 1024
"""Stretches that are looked at together."""


@dataclass(frozen=True)
class Sampled:
    """A run at its samples; ``signals``: the function of the inputs, where they are not held."""

    compiled: Compiled
    problem: Problem
    trajectory: Trajectory
    signals: Followed | None

    def evaluate(self, group: str, t: Array, y: Array) -> Array:
        """Return a group of results at times (K,) and states (n, K)."""
        u = self.problem.inputs if self.signals is None else self.signals.along(t, y)
        return self.compiled.functions[group](t, y, self.problem.parameters, u)


def counted(run: Sampled, outputs: Mapping[str, Array]) -> tuple[dict[str, Array], str]:
    """Return outputs with angles that are continuous in time, and a notice where turns are not known."""
    found, notices = dict(outputs), []
    wanted = [a for a in run.compiled.system.angles if any(n in outputs for n in a.winding)]
    if len(run.trajectory.t) < 2 or not wanted:
        return found, ""
    with np.errstate(all="ignore"):  # of states that are not finite
        steps, own = _at_steps(run)
        names = run.compiled.layout.results[OUTPUTS]
        values = dict(
            zip(names, steps.evaluate(OUTPUTS, steps.trajectory.t, steps.trajectory.y), strict=True)
        )
        for angles in wanted:
            turned, notice = _continuous(_Wound.of(steps, angles), values)
            found |= {n: v[own] for n, v in turned.items()}
            notices += [notice] if notice else []
    return found, "; ".join(notices)


def _at_steps(run: Sampled) -> tuple[Sampled, NDArray[np.intp]]:
    """Return a run with the ends of its steps as further samples, and where its own samples are."""
    made = run.trajectory
    nodes = np.asarray(getattr(made.solution, "ts", ()), dtype=np.float64)
    low, high = min(made.t[0], made.t[-1]), max(made.t[0], made.t[-1])
    further = np.setdiff1d(nodes[(nodes > low) & (nodes < high)], made.t)
    if not len(further):
        return run, np.arange(len(made.t))
    sign = math.copysign(1.0, made.t[-1] - made.t[0])
    t, y = np.concatenate([made.t, further]), np.column_stack([made.y, made.solution(further)])
    order = np.argsort(sign * t, kind="stable")
    own = np.flatnonzero(order < len(made.t))
    return replace(
        run, trajectory=replace(made, t=t[order], y=np.ascontiguousarray(y[:, order]))
    ), own


@dataclass(frozen=True)
class _Wound:
    """The angles of one sequence that were asked for, by name, and how much the body turns between samples.

    ``turn`` (N - 1,): in rad, by how fast the body turns at both ends.
    """

    run: Sampled
    angles: SequenceAngles
    names: tuple[str, ...]
    turn: Array

    @classmethod
    def of(cls, run: Sampled, angles: SequenceAngles) -> _Wound:
        """Return those of a run."""
        layout, made = run.compiled.layout, run.trajectory
        places = [k for k, n in enumerate(names_of(layout.states)) if n in angles.quaternion]
        rates = run.evaluate(RATES, made.t, made.y)
        size = np.linalg.norm(made.y[places], axis=0)
        speed = 2 * np.linalg.norm(rates[places], axis=0) / size
        turn = np.abs(np.diff(made.t)) * np.fmax(speed[1:], speed[:-1])
        names = tuple(n for n in angles.names if n in layout.results[OUTPUTS])
        return cls(run, angles, names, turn)

    def between(self, k: NDArray[np.intp], part: Array) -> Array:
        """Return the angles (a, K) at parts, 0 to 1, of the stretches behind the samples ``k``."""
        made = self.run.trajectory
        h = made.t[k + 1] - made.t[k]
        t = np.where(part < 1, made.t[k] + part * h, made.t[k + 1])
        values = self.run.evaluate(OUTPUTS, t, np.ascontiguousarray(made.solution(t)))
        return values[[self.run.compiled.layout.results[OUTPUTS].index(n) for n in self.names]]

    def changes(self, before: Array, after: Array) -> Array:
        """Return how the angles change by the shorter way; the third as the sum does, if all are there."""
        change = after - before
        change -= TURN * np.floor(change / TURN + 0.5)
        if len(self.names) == len(self.angles.names):
            i, j, k = self.angles.axes
            sine = np.sin(before[1]) * (1 if (j - i) % 3 == 1 else -1)
            sign = np.where((np.cos(before[1]) if i == k else sine) < 0, -1.0, 1.0)
            total = change[0] + sign * change[2]
            change[2] = sign * (total - TURN * np.floor(total / TURN + 0.5) - change[0])
        return change

    def looked(
        self, k: NDArray[np.intp], low: Array, high: Array, level: int
    ) -> tuple[Array, float]:
        """Return the changes (a, K) over stretches from ``low`` to ``high``, by what is between.

        And the largest turn (rad) between two points that could not be looked at more closely.
        """
        parts = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, PARTS + 1)
        values = self.between(np.repeat(k, PARTS + 1), parts.ravel())
        values = values.reshape(len(values), *parts.shape)
        change = self.changes(values[..., :-1], values[..., 1:])
        turn = self.turn[k] * (high - low) / PARTS
        far = self.far(change, turn[:, None])
        widest = float(turn.max())
        if level < LEVELS and far.any():
            i, j = np.nonzero(far)
            change[:, i, j], widest = self.looked(k[i], parts[i, j], parts[i, j + 1], level + 1)
        return np.asarray(change.sum(axis=-1)), widest

    def far(self, change: Array, turn: Array) -> NDArray[np.bool_]:
        """Return whether stretches are too long to be sure: by the changes, and the turn of the body."""
        return np.asarray((turn > SMALL) | (np.abs(change).max(axis=0) > FAR))


def _continuous(wound: _Wound, outputs: Mapping[str, Array]) -> tuple[dict[str, Array], str]:
    """Return the outputs that jump without their jumps, from the first sample on."""
    values = np.array([outputs[n] for n in wound.names])
    change = wound.changes(values[:, :-1], values[:, 1:])
    far, left = np.flatnonzero(wound.far(change, wound.turn)), 0.0
    if wound.run.trajectory.solution is None:
        far, left = far[:0], float(wound.turn.max())
    for first in range(0, len(far), BLOCK):
        some = far[first : first + BLOCK]
        zero = np.zeros(len(some))
        change[:, some], closer = wound.looked(some, zero, zero + 1, 1)
        left = max(left, closer)
    path = values[:, :1] + np.concatenate(
        [np.zeros((len(values), 1)), change.cumsum(axis=1)], axis=1
    )
    exact = values + TURN * np.round((path - values) / TURN)
    return (
        {n: exact[k] for k, n in enumerate(wound.names) if n in wound.angles.winding},
        _notice(wound, left),
    )


def _notice(wound: _Wound, left: float) -> str:
    """Return that whole turns are not known; nothing where they are."""
    asked = " and ".join(n for n in wound.names if n in wound.angles.winding)
    if left <= SMALL:
        return ""
    why = f"the body turns by {left:.3g} rad unseen; store more times"
    return f"whole turns of {asked} are not known: {why}"
