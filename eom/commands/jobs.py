"""What a command runs for a scene: its system, compiled, and the run with the scene's numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from eom.commands.shared import EVERY, compiled_of, events_of

if TYPE_CHECKING:
    from codegen import Result
    from eom.opening import AnyScene
    from eom.system import System

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Job:
    """A scene that is ready to run.

    ``system``: whose states and outputs the result has; ``files``: the generated code by name;
    ``integrate``: the run, for a function that receives the progress; ``noted``: the notice when
    it was compiled.
    """

    scene: AnyScene
    system: System
    files: Mapping[str, str]
    integrate: Callable[[Progress], Result]
    noted: str = ""

    def not_needed(self) -> list[str]:
        """Return the states that the system has neither as states nor, constant, as parameters."""
        kept = {*self.system.state_names, *self.system.parameter_names}
        return [n for n in self.scene.full_system.state_names if n not in kept]


def job_of(
    scene: AnyScene, target: str, project: tuple[str, ...], events: tuple[str, ...] = ()
) -> Job:
    """Return the job of a scene. Raises `InputError` for what does not go together."""
    import codegen

    compiled = compiled_of(scene, target)
    plan = scene.integration
    found = events_of(events, compiled.system)

    def integrate(progress: Progress) -> Result:
        return codegen.simulate(
            compiled,
            scene.initial_values(),
            (0.0, plan.t_end),
            scene.parameter_values(),
            plan.method,
            plan.rtol,
            plan.atol,
            _times(scene),
            inputs=scene.input_values(),
            max_step=plan.max_step or math.inf,
            max_steps=plan.max_steps,
            project=EVERY in project or project or None,
            events=found,
            progress=progress,
        )

    return Job(scene, scene.derive(), compiled.files, integrate, compiled.notice)


def _times(scene: AnyScene) -> list[float]:
    plan = scene.integration
    return [*(plan.t_end * k / (plan.points - 1) for k in range(plan.points - 1)), plan.t_end]
