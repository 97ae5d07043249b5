"""Trajectories of an ensemble that a Taylor series left go on, each by the rule of one run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.integrate.choice import NEXT, Task
from codegen.integrate.fleet import NUMBERS, STATUS, Built, Runner, Runs, Shared, build, problem_of
from codegen.integrate.methods import resumed
from codegen.ir.groups import SINGULARITIES
from codegen.native import halting
from codegen.native.trajectory import Array, Problem, Stop, Trajectory

STUCK = ("not finite", "step")
"""Where a Taylor series may be stuck, and another method not."""
WENT_ON, PASSED = 1, 2
"""In `Runs.continued`: another method went on; it may have passed where the rates are singular."""


def built(compiled: Compiled, method: str, rtol: float) -> Built:
    """Return what integrates many trajectories, as `fleet.build`; ``auto`` goes on where stuck."""
    found = build(compiled, method, rtol)
    if method != "auto" or not found.series:
        return found
    return replace(found, run=_going_on(found.run, compiled), text=f"{found.text}{dict(NEXT)}")


def _going_on(run: Runner, compiled: Compiled) -> Runner:
    """Return what runs Taylor series, and goes on with those trajectories where these are stuck.

    A trajectory is gone on with from where it stopped, by itself: neither its neighbours nor the division
    into chunks change a bit of it.
    """
    singularities = len(compiled.layout.results[SINGULARITIES])

    def further(shared: Shared, x: Array, p: Array) -> Runs:
        runs = run(shared, x, p)
        for j in np.flatnonzero(np.isin(runs.status, [NUMBERS[kind] for kind in STUCK])).tolist():
            halting.check()
            problem = problem_of(shared, x, p, j, singularities)
            first = _stopped(runs, problem, j)
            found = resumed(Task(compiled, problem, None), first)
            if len(found.methods) > len(first.methods):
                _put(runs, j, found, len(first.t))
        return runs

    return further


def _stopped(runs: Runs, problem: Problem, j: int) -> Trajectory:
    """Return a trajectory that stopped as a run of its own."""
    assert problem.t_eval is not None
    y = runs.y[:, :, j].T
    count = int(np.isfinite(y).all(axis=0).sum())
    stop = Stop(STATUS[int(runs.status[j])], float(runs.t_stop[j]), int(runs.which[j]))
    return Trajectory(
        t=problem.t_eval[:count],
        y=y[:, :count],
        stop=stop,
        state_at_stop=np.ascontiguousarray(runs.y_stop[:, j]),
        closest=(),
        evaluations=0,
        steps=int(runs.steps[j]),
        rejected=int(runs.rejected[j]),
        methods=("taylor",),
    )


def _put(runs: Runs, j: int, found: Trajectory, known: int) -> None:
    """Write a whole trajectory in place of its first part, of which so many times are stored."""
    runs.y[known : len(found.t), :, j] = found.y[:, known:].T
    runs.t_stop[j], runs.y_stop[:, j] = found.stop.t, found.state_at_stop
    runs.status[j], runs.which[j] = NUMBERS[found.stop.kind], found.stop.which
    runs.steps[j], runs.rejected[j] = found.steps, found.rejected
    runs.continued[j] = PASSED if found.passed else WENT_ON


def told(continued: Mapping[int, int]) -> str:
    """Return what a user should know of trajectories that were gone on with, by the number of each kind."""
    count, passed = sum(continued.values()), continued.get(PASSED, 0)
    if not count:
        return ""
    what = f"where the Taylor series was stuck another method went on (trajectories: {count:,})"
    doubt = f"; if the rates are singular there, the rest says nothing (trajectories: {passed:,})"
    return what + (doubt if passed else "")
