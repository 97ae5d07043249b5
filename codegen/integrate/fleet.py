"""Many trajectories of one system by one call of C, without a Python step between them.

Three kinds of generated text take the same job: Taylor series in vector lanes, and the scalar
integrators (Taylor, Runge-Kutta) in a loop.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen import native
from codegen.integrate import runge_kutta, taylor, taylor_lanes
from codegen.integrate.dop853 import DOP853
from codegen.integrate.jets import MOST_UNROLLED, operations
from codegen.integrate.trajectory import Array
from codegen.layout import Layout
from codegen.lower import RATES
from codegen.names import identifier
from codegen.program import Program
from codegen.taylor import prepare
from eom.errors import InputError

STATUS = {
    runge_kutta.DONE: "end",
    runge_kutta.SINGULAR: "singular",
    runge_kutta.NOT_FINITE: "not finite",
    runge_kutta.STEP_TOO_SMALL: "step",
    runge_kutta.PAUSED: "max_steps",
}
"""Why a trajectory stopped, by the number in `Runs.status`."""
Integers = NDArray[np.int32]


@dataclass(frozen=True)
class Shared:
    """What all trajectories have in common: times in s, tolerances, and where to stop."""

    t_span: tuple[float, float]
    inputs: Array
    rtol: float
    atol: Array
    margin: float
    t_eval: Array
    max_step: float
    max_steps: int


@dataclass(frozen=True)
class Runs:
    """Trajectories side by side: ``y`` (times, n, N), ``t_stop`` (N,), ``y_stop`` (n, N).

    ``status`` (N,): numbers of `STATUS`; ``which``: of the singularity, or of the state that is not
    finite, else -1. ``y`` is NaN at times that a trajectory did not reach.
    """

    y: Array
    t_stop: Array
    y_stop: Array
    status: Integers
    which: Integers
    steps: Integers
    rejected: Integers


Runner = Callable[[Shared, Array, Array], Runs]
"""(shared, states (n, N), parameters (m,) or (m, N)); the lock of Python is released meanwhile."""


class _Job(ctypes.Structure):
    """Mirror of job.c."""

    _fields_ = [
        *((f, ctypes.c_double) for f in ("t", "t_end", "h_max", "rtol", "margin")),
        *((f, ctypes.c_void_p) for f in ("atol", "u", "grid", "x", "p", "y", "t_stop", "x_stop")),
        *((f, ctypes.c_void_p) for f in ("room", "status", "which", "steps", "rejected")),
        *((f, ctypes.c_ssize_t) for f in ("x_row", "x_column", "p_row", "p_column")),
        *((f, ctypes.c_ssize_t) for f in ("y_row", "y_time", "stop_row")),
        *((f, ctypes.c_size_t) for f in ("count", "grid_count")),
        ("max_steps", ctypes.c_longlong),
    ]


def runner(function: Any) -> Runner:
    """Return what calls a C function of a job."""
    function.argtypes = [ctypes.c_void_p]
    function.restype = None

    def run(shared: Shared, x: Array, p: Array) -> Runs:
        n, count = x.shape
        times = len(shared.t_eval)
        x, p = np.ascontiguousarray(x), np.ascontiguousarray(p)
        runs = Runs(
            np.full((times, n, count), math.nan),
            np.empty(count),
            np.empty((n, count)),
            *(np.empty(count, dtype=np.int32) for _ in range(4)),
        )
        room, something = np.empty(times * (n + 1) + 1), np.zeros(1)
        start, end = shared.t_span
        job = _Job(t=start, t_end=end, h_max=shared.max_step, rtol=shared.rtol)
        job.margin, job.max_steps = shared.margin, shared.max_steps
        job.count, job.grid_count = count, times
        arrays = {
            "atol": shared.atol, "u": shared.inputs, "grid": shared.t_eval, "x": x, "p": p,
            "y": runs.y, "t_stop": runs.t_stop, "x_stop": runs.y_stop, "room": room,
            "status": runs.status, "which": runs.which, "steps": runs.steps,
            "rejected": runs.rejected,
        }  # fmt: skip
        for name, array in arrays.items():
            setattr(job, name, (array if array.size else something).ctypes.data)
        job.x_row, job.x_column = count, 1
        job.p_row, job.p_column = (count, 1) if p.ndim == 2 else (1, 0)
        job.y_row, job.y_time, job.stop_row = count, n * count, count
        function(ctypes.addressof(job))
        return runs

    return run
