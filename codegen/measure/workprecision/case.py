"""An initial value problem to be measured, and its end with known digits."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.compiling.sampled import refuse
from codegen.frontend.layout import names_of
from codegen.native.trajectory import Array
from codegen.precision import extended
from codegen.runs.simulation import simulate
from eom.errors import InputError
from eom.system import System

DIGITS = (24, 20)
"""Of the run that counts, and of the one that shows how far it can be trusted."""
MAX_EXTENDED_STEPS = 20_000
WORST = 1e-6
TIGHT = {
    False: (("DOP853", 1e-13), ("scipy:LSODA", 1e-12)),
    True: (("scipy:Radau", 1e-12), ("scipy:LSODA", 1e-12)),
}
"""Where many digits are out of reach: two methods that have nothing in common, smooth and stiff."""


@dataclass(frozen=True)
class Case:
    """A system with all numbers, from t = 0 to ``end``, in any consistent units.

    ``start``, ``parameters``, ``inputs``: values by name, of states at t = 0, of parameters, which are
    compiled in, and of inputs, which are held; ``stiff``: whether the reference is left to stiff methods.
    """

    name: str
    title: str
    system: System
    start: Mapping[str, float]
    parameters: Mapping[str, float]
    inputs: Mapping[str, float]
    end: float
    stiff: bool = False

    def compiled(self) -> Compiled:
        """Return the system, its parameters fixed, for C where there is a compiler.

        Raises `InputError` as `codegen.compile` does.
        """
        compiled = compile_system(self.system, parameters=self.parameters)
        refuse(compiled, "a comparison of methods")
        return compiled


@dataclass(frozen=True)
class Reference:
    """The end of a case as ``high`` + ``low``, shape (n,), and by how much it may be wrong itself.

    ``scale``: the largest size of each state on the way, shape (n,). ``error`` is in the measure of
    `distance`; ``how``: where the numbers come from.
    """

    high: Array
    low: Array
    scale: Array
    error: float
    how: str

    def distance(self, end: Array) -> float:
        """Return the largest difference of a state at the end over its largest size on the way.

        Parameters
        ----------
        end : array
            States at the end, (n,).

        Returns
        -------
        float
            Without a unit.
        """
        return float(np.max(np.abs((end - self.high) - self.low) / self.scale))

    def measured(self, end: Array) -> tuple[float, bool]:
        """Return the error of states at the end, and whether it is known.

        Parameters
        ----------
        end : array
            States at the end, (n,).

        Returns
        -------
        tuple of float, bool
            As of `distance`. Below the reference's own error, that one is reported.
        """
        found = self.distance(end)
        return (found, True) if found > self.error else (self.error, False)


def reference(
    case: Case, compiled: Compiled, progress: Callable[[float], None] | None = None
) -> Reference:
    """Return the end with many digits where there is a Taylor series; else by two tight runs.

    Raises `InputError` where neither comes to the end, or where it is known to less than `WORST`.
    """
    found = None if case.stiff else _extended(case, compiled, progress)
    found = found or _tight(case, compiled)
    if not found.error <= WORST:
        raise InputError(
            "no reference solution: the motion depends on its start too much",
            where=case.name,
            got=f"{found.how}; known to {found.error:.1e}",
            expected=f"an end that is known to {WORST:.0e}",
            hint="choose an earlier end time",
        )
    return found


def _extended(
    case: Case, compiled: Compiled, progress: Callable[[float], None] | None
) -> Reference | None:
    """Return the end with many digits, or None where that cannot be had."""
    layout = compiled.layout
    values = extended.Values(
        [case.start[n] for n in names_of(layout.states)],
        [case.parameters[n] for n in names_of(layout.parameters)],
        [case.inputs[n] for n in names_of(layout.inputs)],
    )
    report = progress or (lambda fraction: None)
    parts = (lambda f: report(0.6 * f), lambda f: report(0.6 + 0.4 * f))
    span, most = (0.0, case.end), MAX_EXTENDED_STEPS
    try:
        fine, coarse = (
            extended.integrate(compiled.program, layout, values, span, digits, most, part)
            for digits, part in zip(DIGITS, parts, strict=True)
        )
    except InputError:
        return None
    high = np.array([float(x) for x in fine.end])
    low = np.array([float(x - Fraction(float(x))) for x in fine.end])
    scale = _scale(np.array(fine.largest))
    pairs = zip(fine.end, coarse.end, scale, strict=True)
    own = max(float(abs(a - b)) / s for a, b, s in pairs)
    return Reference(high, low, scale, own, f"Taylor series with {DIGITS[0]} digits a step")


def _scale(largest: Array) -> Array:
    """States that are always zero are measured by the largest of all."""
    return np.where(largest > 0, largest, max(largest.max(), math.ulp(0.0)))


def _tight(case: Case, compiled: Compiled) -> Reference:
    runs = []
    for method, rtol in TIGHT[case.stiff]:
        run = simulate(
            compiled,
            case.start,
            (0.0, case.end),
            None,
            method,
            rtol,
            1e-3 * rtol,
            inputs=case.inputs,
        )
        if run.status != 0:
            raise InputError("no reference solution", where=case.name, got=run.message)
        runs.append(run)
    first, second = runs
    scale = _scale(np.abs(first.y).max(axis=1))
    own = float(np.max(np.abs(first.y_stop - second.y_stop) / scale))
    how = " and ".join(f"{method} at {rtol:.0e}" for method, rtol in TIGHT[case.stiff])
    return Reference(first.y_stop, np.zeros_like(scale), scale, own, f"{how} agree")
