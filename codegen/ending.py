"""How a run ended, in words: when, which quantity failed, and what to do about it."""

from __future__ import annotations

import math

from codegen.compiled import Compiled
from codegen.integrate.trajectory import Trajectory
from codegen.layout import names_of


def message(compiled: Compiled, trajectory: Trajectory, max_steps: int) -> str:
    """Return when a run ended, why, and what to do about it; of events see `codegen.simulation`."""
    stop, names = trajectory.stop, names_of(compiled.layout.states)
    at = f"stopped at t = {stop.t:.9g} s"
    if stop.kind == "end":
        return f"reached t = {stop.t:.9g} s"
    if stop.kind == "singular":
        singularity = compiled.system.singularities[stop.which]
        if singularity.coordinate.name not in names:
            return f"{at}: {singularity.expression} = 0 is singular: {singularity.meaning}"
        angle = trajectory.state_at_stop[names.index(singularity.coordinate.name)]
        return (
            f"{at}: {singularity.coordinate} = {angle:.9g} rad ({math.degrees(angle):.6f} deg) "
            f"is singular, {singularity.expression} = 0: {singularity.meaning}"
        )
    if stop.kind == "not finite":
        return f"{at}: {names[stop.which]} or its rate is not finite (NaN or infinity) beyond it"
    if stop.kind == "step":
        return (
            f"{at}: the step fell below the resolution of time; the tolerance cannot be met there, "
            "or the rates on both sides of a jump lead back to it (friction at rest)"
        )
    if stop.kind == "memory":
        return f"{at}: no memory for more steps; give t_eval to store less"
    return (
        f"{at}: all of max_steps = {max_steps:,} were tried; look for a jump in the rates "
        "(friction, sign) or stiffness, or raise max_steps"
    )
