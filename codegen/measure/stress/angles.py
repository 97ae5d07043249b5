"""Rotation angles next to their singular configuration: a passage at a known distance.

A torque-free body is set at its closest approach, the second angle at a distance c from the singular
one and turning past it, and followed backwards in closed form to where the run begins. An error of
rtol in the angles is one of up to rtol / c in the attitude, where c is the cosine or sine of the second
angle that the rates are divided by; away from there it is rtol a step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from codegen.closed.exact import free_motion
from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.ir.program import SINGULARITIES
from codegen.measure.stress.growth import turn_between
from codegen.measure.stress.record import EPSILON, Figure, Findings, Material, Plan
from codegen.measure.stress.workers import Collector, Run, tolerance_of
from codegen.native.trajectory import Array
from codegen.runs.prepared import DEFAULT_MARGIN
from codegen.runs.result import Result
from eom.errors import InputError
from eom.rotations import cosines, quaternion_product

MOMENTS = (1.0, 2.0, 3.0)
BEFORE = 1.0
"""Seconds from the start to the closest approach, and from there to the end."""
TIMES = np.array([0.0, 2 * BEFORE])
DISTANCES = tuple(10.0**-k for k in range(1, 11))
SMALL_MARGIN = 1e-12
MARGIN_PART = 0.1
"""By which part of the distance the reported margin may differ from it, beside the errors of the steps: it
is reported over steps, and these come near enough."""
STOP_SLACK = 1e-3
SINGULAR, UNMET = "is singular", "cannot be met"
"""Parts of the messages of `codegen.simulate`."""


@dataclass(frozen=True)
class Sequence:
    """Axes of three turns, the singular second angle, rates at the approach, and angles from C_BA."""

    axes: tuple[int, int, int]
    singular: float
    omega: tuple[float, float, float]
    angles: Callable[[Array], tuple[float, float, float]]

    def quaternion(self, angles: Array) -> Array:
        """Return quaternions (4, ...) of angles (3, ...)."""
        q = _turn(self.axes[0], angles[0])
        for axis, angle in zip(self.axes[1:], angles[1:], strict=True):
            q = np.stack(quaternion_product(q, _turn(axis, angle)))
        return q


def _turn(axis: int, angle: Array) -> Array:
    half = np.asarray(angle) / 2
    q = np.zeros((4, *half.shape))
    q[0], q[axis] = np.cos(half), np.sin(half)
    return q


def _321(C: Array) -> tuple[float, float, float]:
    second = math.atan2(-C[0, 2], math.hypot(C[0, 0], C[0, 1]))
    return math.atan2(C[0, 1], C[0, 0]), second, math.atan2(C[1, 2], C[2, 2])


def _313(C: Array) -> tuple[float, float, float]:
    second = math.atan2(math.hypot(C[2, 0], C[2, 1]), C[2, 2])
    return math.atan2(C[2, 0], -C[2, 1]), second, math.atan2(C[0, 2], C[1, 2])


SEQUENCES = {
    "3-2-1": Sequence((3, 2, 1), math.pi / 2, (0.4, 0.0, 1.0), _321),
    "3-1-3": Sequence((3, 1, 3), 0.0, (0.0, 1.0, 0.4), _313),
}
"""One whose outer axes differ, singular where a cosine is zero, and one whose outer axes agree."""


@dataclass(frozen=True)
class Passage:
    """States at the start, and omega (3,) and attitude (4,) at the end, of a passage at a distance."""

    sequence: Sequence
    distance: float
    start: Array
    omega: Array
    attitude: Array


def passage(sequence: Sequence, distance: float) -> Passage:
    """Return a passage; its end is that of the rounded start."""
    sign = -1.0 if sequence.singular else 1.0
    closest = np.array([0.0, sequence.singular + sign * distance, 0.0])
    w, q = free_motion(MOMENTS, sequence.omega, sequence.quaternion(closest))(-BEFORE)
    angles: Array = np.array(sequence.angles(np.array(cosines(q))))
    end = free_motion(MOMENTS, w, sequence.quaternion(angles))(2 * BEFORE)
    return Passage(sequence, distance, np.concatenate([w, angles]), *end)


def near_singular_angles(material: Material, plan: Plan) -> Findings:
    """Pass the singular configuration of each sequence at each distance, with every method."""
    found = Collector()
    parameters = dict(zip(("I1", "I2", "I3"), MOMENTS, strict=True))
    for name, system in material.in_angles.items():
        if name not in SEQUENCES:
            raise InputError("sequence without a passage", got=name, expected=", ".join(SEQUENCES))
        compiled = compile_system(system, parameters=parameters)
        for k, distance in enumerate(DISTANCES):
            way = passage(SEQUENCES[name], distance)
            for method in plan.methods:
                _pass(compiled, way, f"{name} at {distance:.0e}", method, plan, found)
            plan.progress((k + 1) / len(DISTANCES))
    return found.findings()


def _pass(
    compiled: Compiled, way: Passage, where: str, method: str, plan: Plan, found: Collector
) -> None:
    """Run with a margin smaller than the distance, and with the usual one; append what is found."""
    rtol = tolerance_of(method)
    for margin, judge in ((SMALL_MARGIN, _through), (DEFAULT_MARGIN, _documented)):
        run = Run(compiled, way.start, TIMES, limit=plan.size.limit, margin=margin)
        result = found.result(run, method, rtol, where)
        if result is not None:
            found.figures += judge(compiled, way, f"{where}: {method}", result, rtol)


def _through(_: Compiled, way: Passage, what: str, result: Result, rtol: float) -> list[Figure]:
    """The run comes to the end with the error that it may have, and reports how near it was.

    Where the rounding of an angle is more, beside the distance, than a coarser tolerance, it may also end
    and say that this tolerance cannot be met.
    """
    if result.status != 0:
        noisy = EPSILON < rtol < EPSILON * abs(way.start[4]) / way.distance
        unmet = noisy and result.status < 0 and UNMET in result.message
        near = result.status == 1 and _blurred(way, result, rtol, SMALL_MARGIN)
        value = 0.0 if unmet or near else math.inf
        return [Figure(f"{what}: passes, or says why not", value, 0.0, result.message)]
    end = way.sequence.quaternion(result.y_stop[3:])[:, None]
    error = float(turn_between(end, way.attitude[:, None])[0])
    bound = rtol * (result.steps + 1 / way.distance)
    (margin,) = result.margin.values()
    note = f"{result.steps} steps, margin {margin:.3e}"
    apart, allowed = abs(margin - way.distance), MARGIN_PART * way.distance + result.steps * rtol
    return [
        Figure(f"{what}: error", error, bound, note),
        Figure(f"{what}: margin less distance", apart, allowed, note),
    ]


def _blurred(way: Passage, result: Result, rtol: float, margin: float) -> bool:
    """Whether the errors of the steps decide on which side of the margin the body passes."""
    return abs(way.distance - margin) <= STOP_SLACK * margin + result.steps * rtol


def _documented(
    compiled: Compiled, way: Passage, what: str, result: Result, rtol: float
) -> list[Figure]:
    """With the usual margin the run stops at it, before the approach, where the approach is nearer."""
    if _blurred(way, result, rtol, DEFAULT_MARGIN):
        return [Figure(f"{what}: says how it ends", float(result.status < 0), 0.0, result.message)]
    if way.distance > DEFAULT_MARGIN:
        return [Figure(f"{what}: goes on", float(result.status != 0), 0.0, result.message)]
    if result.status != 1 or SINGULAR not in result.message or result.t_stop > BEFORE:
        return [Figure(f"{what}: stops", math.inf, 0.0, result.message)]
    reached = abs(float(compiled.functions[SINGULARITIES](result.t_stop, result.y_stop, [], [])[0]))
    value = abs(reached / DEFAULT_MARGIN - 1)
    return [Figure(f"{what}: stops at the margin", value, STOP_SLACK, result.message)]
