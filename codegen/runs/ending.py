"""How a run ended, in words: when, which quantity failed, and what to do about it."""

from __future__ import annotations

import math
from collections.abc import Sequence

from codegen.compiling.compiled import Compiled
from codegen.frontend.layout import names_of
from codegen.native.trajectory import Problem, Trajectory


def message(
    compiled: Compiled, trajectory: Trajectory, problem: Problem, events: Sequence[str]
) -> str:
    """Return when a run ended, why, and what to do about it; ``events``: what they are called."""
    stop, names = trajectory.stop, names_of(compiled.layout.states)
    at = f"stopped at t = {problem.told(stop.t)}"
    if stop.kind == "end":
        return f"reached t = {problem.told(problem.t_span[1])}"
    if stop.kind == "event":
        return f"{at}: event {events[stop.which]}"
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
        told = f"{at}: {names[stop.which]} or its rate is not finite (NaN or infinity) beyond it"
        if stop.t != problem.t_span[0]:
            return told
        return f"{told} (a division by zero at the start: parts without mass?)"
    if stop.kind in _WORDS:
        return f"{at}: {_WORDS[stop.kind].format(max_steps=f'{problem.max_steps:,}')}"
    return (
        f"{at}: all of max_steps = {problem.max_steps:,} were tried; look for a jump in the rates "
        "(friction, sign) or stiffness, or raise max_steps"
    )


_WORDS = {
    "step": (
        "the step fell below the resolution of time; the tolerance cannot be met there, "
        "or the rates on both sides of a jump lead back to it (friction at rest)"
    ),
    "coarse": (
        "equal steps that keep the relative tolerance are more than max_steps = {max_steps}; "
        "raise rtol or max_steps, or choose a method whose steps change"
    ),
    "thin": (
        "about an axis of small moment the rate follows from the momentum with a rounding error "
        "above its tolerance; give atol for it, or choose splitting or taylor"
    ),
    "memory": "no memory for more steps; give t_eval to store less",
}
"""What is said of kinds of stops that need nothing from the system."""
