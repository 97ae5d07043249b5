"""Whether explicit steps are limited by stability, and for so long that implicit ones cost less.

The step h of an explicit method on y' = lambda y is bounded by h |lambda| <= S, the length of its
stability region along the negative axis: where h |lambda| is near S, for lambda an eigenvalue of the
Jacobian with negative real part, stability and not accuracy decides the step (Hairer and Wanner,
Solving Ordinary Differential Equations II, 2nd ed. (1996), sect. IV.2, where |lambda| is estimated by
the last stages). Here the eigenvalues are those of a Jacobian by differences, one call of the rates a
column: that needs nothing compiled and sees every eigenvalue, not the largest alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.integrate.scales import PART
from codegen.loops.projection import units
from codegen.native.trajectory import Array, Problem

DOP853_REACH = 6.1
"""S of DOP853: Hairer and Wanner II, sect. IV.2."""
NEAR = 0.6
"""Part of S from which on a step counts as limited. Accuracy keeps h |lambda| of Taylor series below
0.2 S at all tolerances, and of DOP853 below 0.4 S up to 1e-3 (linear oscillator)."""
DAMPED = 0.05
"""Least -Re lambda/|lambda|: implicit methods must follow what hardly decays as well."""
WORTH = {True: 200_000, False: 5_000}
"""Explicit steps, in generated C or in Python, that cost as much as a whole implicit run. Van der Pol's
oscillator, mu = 1000, to t = 2000 at 1e-9: 584,000 steps in C take 0.07 s (Taylor) to 0.17 s (DOP853),
LSODA 0.08 s, Radau 1.6 s; Robertson's problem to t = 400: 285,000 in 0.04 to 0.1 s, 0.02 s, 0.17 s."""
ROOT = math.sqrt(np.finfo(float).eps)
BDF_ANGLE = math.tan(math.radians(51.8))
"""|Im lambda|/|Re lambda| up to which BDF of order 5 is stable: Hairer and Wanner II, sect. V.2."""


@dataclass(frozen=True)
class Stiff:
    """The eigenvalue (1/s) that limits explicit steps, h |lambda|, and the steps that would be left."""

    eigenvalue: complex
    reach: float
    left: float

    @property
    def oscillates(self) -> bool:
        """Whether methods that are stable along the negative axis alone would be limited as well."""
        return abs(self.eigenvalue.imag) > BDF_ANGLE * abs(self.eigenvalue.real)

    def __str__(self) -> str:
        return (
            f"explicit steps were limited by stability, h |lambda| = {self.reach:.2g}, "
            f"with {self.left:.1e} of them to go"
        )


@cache
def taylor_reach(order: int) -> float:
    """Return S of a Taylor series: the first z > 0 with |1 - z + ... + (-z)^p/p!| > 1."""
    z, step = 1.0, 1.0 / 64
    while abs(math.fsum((-z) ** k / math.factorial(k) for k in range(order + 1))) <= 1.0:
        z += step
    return z


def promising(compiled: Compiled, problem: Problem, u: Array, worth: int) -> bool:
    """Tell whether stability may cost more than ``worth`` steps of DOP853, judged by the start alone.

    Costs as many calls of the rates as there are states where the norm of the Jacobian excludes it.
    """
    start, end = problem.t_span
    span = abs(end - start)
    changes, slopes = _differences(compiled, problem, start, problem.x0, u)
    bound = float((np.abs(slopes).T @ (1.0 / changes)).max())
    if not math.isfinite(bound) or bound * span < worth * DOP853_REACH:
        return False
    J = slopes.T / changes
    worst = _worst(J, math.copysign(1.0, end - start))
    return worst is not None and abs(worst) * span >= worth * DOP853_REACH


def limited(
    compiled: Compiled,
    problem: Problem,
    at: tuple[float, Array, float],
    u: Array,
    reach: float,
    worth: int,
) -> Stiff | None:
    """Return what limits a run whose last step was h at t and x, ``at`` = (t, x, h), or None.

    ``reach``: S of the method. None also where less than ``worth`` steps are left.
    """
    t, x, h = at
    left = abs((problem.t_span[1] - t) / h) if h else 0.0
    if left < worth:
        return None
    changes, slopes = _differences(compiled, problem, t, x, u)
    J = slopes.T / changes
    worst = _worst(J, math.copysign(1.0, h)) if np.all(np.isfinite(J)) else None
    if worst is None or abs(h * worst) < NEAR * reach:
        return None
    return Stiff(worst, abs(h * worst), left)


def _differences(
    compiled: Compiled, problem: Problem, t: float, x: Array, u: Array
) -> tuple[Array, Array]:
    """Return by how much each state is moved, about 1e-8 of its size, and in rows how the rates change."""
    rates, p, n = compiled.rhs, problem.parameters, len(x)
    moved = x + ROOT * np.maximum(np.abs(x), _least(compiled, problem, x))
    point, slopes, here = x.copy(), np.empty((n, n)), rates(t, x, p, u)
    for j in range(n):
        point[j] = moved[j]
        rates(t, point, p, u, slopes[j])
        point[j] = x[j]
    with np.errstate(invalid="ignore"):  # rates that overflow; the caller looks for them
        slopes -= here
    return moved - x, slopes


def _least(compiled: Compiled, problem: Problem, x: Array) -> Array:
    """Return for each state the size below which it is moved as one of that size.

    What counts as zero by the tolerances, or a part of the largest state of its unit: beside that a
    change of 1e-8 of a much smaller state is lost in rounding.
    """
    known = np.array(units(compiled.layout))
    largest = np.zeros(known.max(initial=0) + 1)
    np.maximum.at(largest, known, np.abs(x))
    return np.asarray(np.maximum(problem.atol / problem.rtol, PART * largest[known]))


def _worst(J: Array, direction: float) -> complex | None:
    """Return the largest eigenvalue among those of motions that decay."""
    values = np.linalg.eigvals(J)
    decaying = values[-direction * values.real > DAMPED * np.abs(values)]
    return complex(decaying[np.argmax(np.abs(decaying))]) if decaying.size else None
