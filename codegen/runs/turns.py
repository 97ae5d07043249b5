"""Whole turns of angles along a run: what a quaternion does not know, counted from sample to sample.

Of the angles of a sequence (`eom.system.SequenceAngles`) a state tells the first and the third up to whole
turns. Here they become continuous functions of time, from values between -pi and pi at the first sample.
Between two samples the change of each is known but for a multiple of 2 pi: it is that nearest to zero,
where the body turns little and the angles by less than a right angle. Else what is known between the
samples decides: dense output, or the cubic through states and rates at both (Hairer, Norsett and Wanner,
Solving Ordinary Differential Equations I (1993), sect. II.6), at `PARTS` points, and at as many between two
of these, where an angle still changes by more.

Next to a singular configuration the two angles change by half a turn in no time, and on it they are
not defined one by one, but the one plus or less the other is: with a, b the axes of the first and the third
turn and c the sign of a.b, psi + c phi has the rate omega.(a + c b)/(1 + |a.b|), at most sqrt(2) |omega|.
So the third angle follows from this sum, where all three are asked for; the first goes the shorter way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled
from codegen.compiling.signals import Inputs
from codegen.frontend.layout import names_of
from codegen.ir.groups import OUTPUTS, RATES
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
WIDEST = 4.0
"""Turn of the body (rad) between two samples that a cubic through states and rates follows."""
BLOCK = 1024
"""Stretches that are looked at together."""


@dataclass(frozen=True)
class Sampled:
    """A run at its samples; ``signals``: the function of the inputs, where they are not held."""

    compiled: Compiled
    problem: Problem
    trajectory: Trajectory
    signals: Inputs | None

    def evaluate(self, group: str, t: Array, y: Array) -> Array:
        """Return a group of results at times (K,) and states (n, K)."""
        u = self.problem.inputs if self.signals is None else self.signals.along(t)
        return self.compiled.functions[group](t, y, self.problem.parameters, u)


def counted(run: Sampled, outputs: Mapping[str, Array]) -> tuple[dict[str, Array], str]:
    """Return outputs with angles that are continuous in time, and a notice where turns are not known."""
    found, notices = dict(outputs), []
    for angles in run.compiled.system.angles:
        if len(run.trajectory.t) > 1 and any(n in outputs for n in angles.winding):
            with np.errstate(all="ignore"):  # of states that are not finite
                turned, notice = _continuous(_Wound.of(run, angles), outputs)
            found |= turned
            notices += [notice] if notice else []
    return found, "; ".join(notices)


@dataclass(frozen=True)
class _Wound:
    """The angles of one sequence that were asked for, by name, and how much the body turns between samples.

    ``rates`` (n, N): of the states; ``turn`` (N - 1,): in rad, at least about that.
    """

    run: Sampled
    angles: SequenceAngles
    names: tuple[str, ...]
    rates: Array
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
        return cls(run, angles, names, rates, turn)

    def between(self, k: NDArray[np.intp], part: Array) -> Array:
        """Return the angles (a, K) at parts, 0 to 1, of the stretches behind the samples ``k``."""
        made = self.run.trajectory
        h = made.t[k + 1] - made.t[k]
        t = np.where(part < 1, made.t[k] + part * h, made.t[k + 1])
        states = self._cubic(k, part, h) if made.solution is None else made.solution(t)
        values = self.run.evaluate(OUTPUTS, t, np.ascontiguousarray(states))
        return values[[self.run.compiled.layout.results[OUTPUTS].index(n) for n in self.names]]

    def _cubic(self, k: NDArray[np.intp], part: Array, h: Array) -> Array:
        y, f, s = self.run.trajectory.y, self.rates, part
        slopes = s * (1 - s) * h * ((1 - s) * f[:, k] - s * f[:, k + 1])
        blend = s * s * (3 - 2 * s)
        return np.asarray(y[:, k] + blend * (y[:, k + 1] - y[:, k]) + slopes)

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

    def looked(self, k: NDArray[np.intp], low: Array, high: Array, level: int) -> Array:
        """Return the changes (a, K) over stretches from ``low`` to ``high``, by what is between."""
        parts = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, PARTS + 1)
        values = self.between(np.repeat(k, PARTS + 1), parts.ravel())
        values = values.reshape(len(values), *parts.shape)
        change = self.changes(values[..., :-1], values[..., 1:])
        turn = self.turn[k] * (high - low) / PARTS
        far = self.far(change, turn[:, None])
        if level < LEVELS and far.any():
            i, j = np.nonzero(far)
            change[:, i, j] = self.looked(k[i], parts[i, j], parts[i, j + 1], level + 1)
        return np.asarray(change.sum(axis=-1))

    def far(self, change: Array, turn: Array) -> NDArray[np.bool_]:
        """Return whether stretches are too long to be sure: by the changes, and the turn of the body."""
        return np.asarray((turn > SMALL) | (np.abs(change).max(axis=0) > FAR))


def _continuous(wound: _Wound, outputs: Mapping[str, Array]) -> tuple[dict[str, Array], str]:
    """Return the outputs that jump without their jumps, from the first sample on."""
    values = np.array([outputs[n] for n in wound.names])
    change = wound.changes(values[:, :-1], values[:, 1:])
    far = np.flatnonzero(wound.far(change, wound.turn))
    for some in np.split(far, range(BLOCK, len(far), BLOCK)):
        zero = np.zeros(len(some))
        change[:, some] = wound.looked(some, zero, zero + 1, 1)
    path = values[:, :1] + np.concatenate(
        [np.zeros((len(values), 1)), change.cumsum(axis=1)], axis=1
    )
    exact = values + TURN * np.round((path - values) / TURN)
    widest, solution = np.max(wound.turn), wound.run.trajectory.solution
    return (
        {n: exact[k] for k, n in enumerate(wound.names) if n in wound.angles.winding},
        _told(wound, float(widest)) if solution is None and widest > WIDEST else "",
    )


def _told(wound: _Wound, widest: float) -> str:
    asked = " and ".join(n for n in wound.names if n in wound.angles.winding)
    return (
        f"whole turns of {asked} are not known: the body turns by {widest:.3g} rad between stored times, "
        f"more than {WIDEST:g}; store more, or dense_output=True"
    )
