"""How one run keeps time: over the time since its start where that is late, told in the user's times.

What a system reads over such a time is of `codegen.compiling.epoch`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.epoch import Relative, relative
from codegen.compiling.events import Event, bare
from codegen.compiling.signals import Inputs
from codegen.native.trajectory import Array, Problem
from eom.errors import InputError

COARSEST = 1e-3
"""Part of a run that time must be resolved to, where what reads it needs its absolute value."""


def is_late(t_span: tuple[float, float]) -> bool:
    """Tell whether both ends of a run are farther from zero than from each other.

    Other runs lose at most one digit of two by time that is counted from zero.
    """
    start, end = t_span
    return min(abs(start), abs(end)) > abs(end - start)


@dataclass(frozen=True)
class Clock:
    """How one run keeps time: ``epoch``, time of its zero for the rates, and ``start``.

    A run over ``t_span`` is made over times since ``start``, and told in times since ``epoch``.
    """

    relative: Relative
    epoch: float
    start: float
    t_span: tuple[float, float]

    @property
    def zero(self) -> tuple[float, float]:
        """The time at which that of the run is zero, as a sum of two."""
        return self.epoch, self.start

    def problem(self, problem: Problem) -> Problem:
        """Return a problem over the time of the run; differences of near doubles are exact."""
        return replace(
            problem,
            t_span=span_since(problem.t_span, self.start),
            t_eval=None if problem.t_eval is None else problem.t_eval - self.start,
            parameters=self.relative.completed(problem.parameters, self.zero),
            start=self.start,
        )

    def signals(self, inputs: Inputs | None) -> Inputs | None:
        """Return functions of time as functions of the time of the run; the sum is rounded."""
        return None if inputs is None else inputs.since(self.zero)

    def doubt(self, parameters: Array, rtol: float, inputs: Inputs | None = None) -> str:
        """Return what a user should know of how well time is resolved in a run, or nothing.

        ``parameters``: as the user gave them, (m,), or (m, N) of N runs. Raises `InputError` where rates or
        inputs have time rounded to more than `COARSEST` of the run.
        """
        length = abs(self.t_span[1] - self.t_span[0])
        apart = float(np.spacing(max(map(abs, self.t_span))))
        told = [f"t_span is taken for {length:g} s long, doubles there are {apart:g} s apart"]
        unit = self.relative.resolution(parameters, self.zero, length)
        if inputs is not None:
            unit = max(unit, float(np.spacing(abs(sum(self.zero)) + length)))
        if apart <= COARSEST * length:
            told.clear()
        if unit > rtol * length:
            reads = "inputs that are functions of time" if inputs else "rates that need time itself"
            told.append(f"{reads} have it rounded to {unit:.2g} s")
        if unit > COARSEST * length:
            raise InputError(
                "the run starts so late that time is not resolved",
                got=f"{told[-1]}, in a run of {length:.6g} s",
                expected="time in phases a t + b, or an earlier start",
                hint="count time from a later zero",
            )
        return "; ".join(told)

    def times(self, t: Array, problem: Problem, *, ended: bool) -> Array:
        """Return times of a run as they are told; ``problem`` is that of the user."""
        return times_told(t, self.start, problem.t_eval, self.t_span[1] if ended else None)


def span_since(t_span: tuple[float, float], start: float) -> tuple[float, float]:
    """Return an interval of time, since ``start``."""
    return t_span[0] - start, t_span[1] - start


def times_told(t: Array, start: float, t_eval: Array | None, end: float | None) -> Array:
    """Return stored times since ``start`` as they are told; ``end``: the last, where that is known."""
    if t_eval is not None:
        return t_eval[: len(t)].copy()
    found = start + t
    if end is not None and len(found):
        found[-1] = end
    return found


@dataclass(frozen=True)
class Late:
    """Dense output as a function of times that are told: ``sol(t)`` has shape (n,) or (n, len(t)).

    ``solution``: over times since ``start``.
    """

    solution: Any
    start: float

    @property
    def ts(self) -> Array:
        """The ends of the steps."""
        return np.asarray(self.start + np.asarray(self.solution.ts))

    @property
    def t_min(self) -> float:
        """The earliest time of the run."""
        return float(self.start + self.solution.t_min)

    @property
    def t_max(self) -> float:
        """The latest time of the run."""
        return float(self.start + self.solution.t_max)

    def __call__(self, t: Any) -> Array:
        """Evaluate; differences of times to the start are exact."""
        values: Array = self.solution(np.asarray(t, dtype=np.float64) - self.start)
        return values


def clock_of(
    compiled: Compiled, t_span: tuple[float, float], epoch: float, events: Sequence[Event]
) -> Clock | None:
    """Return how a run keeps time, or None for one over the time of its system."""
    start = t_span[0] if is_late(t_span) else 0.0
    if not start and not epoch:
        return None
    return Clock(relative(compiled, bare(events)), epoch, start, t_span)
