"""What a command runs for a scene: its system, or its two charts with hand-over, behind one interface."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from eom.commands.shared import EVERY, compiled_of, events_of, waiting_for
from eom.errors import InputError

if TYPE_CHECKING:
    from codegen import Compiled, Result
    from codegen.runs.charts import CompiledCharts
    from eom.opening import AnyScene
    from eom.scenes.scene import Scene
    from eom.system import System

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Job:
    """A scene that is ready to run.

    ``system``: whose states and outputs the result has; ``files``: the generated code by name;
    ``integrate``: the run, for a function that is told the progress; ``handed``: whether angles are
    handed over; ``noted``: what was told when it was compiled.
    """

    scene: AnyScene
    system: System
    files: Mapping[str, str]
    integrate: Callable[[Progress], Result]
    handed: bool
    noted: str = ""

    def requested_names(self) -> list[str]:
        """Return what is asked for that varies."""
        known = (*self.system.state_names, *self.system.output_names)
        return [n for n in self.scene.requested if n in known]

    def not_needed(self) -> list[str]:
        """Return the states that the system has neither as states nor, constant, as parameters."""
        kept = {*self.system.state_names, *self.system.parameter_names}
        return [n for n in self.scene.full_system.state_names if n not in kept]


def job_of(
    scene: AnyScene, target: str, project: tuple[str, ...], events: tuple[str, ...] = ()
) -> Job:
    """Return the job of a scene. Raises `InputError` for what does not go together."""
    if scene.model == "tree" or not scene.integration.handover:
        return _in_one(scene, target, project, events)
    if events:
        raise InputError(
            "events are not found where angles are handed over",
            where="--event",
            got=", ".join(events),
            hint='--no-handover, or attitude = "quaternion"',
        )
    return _with_handover(scene, target, project)


def _times(scene: AnyScene) -> list[float]:
    plan = scene.integration
    return [*(plan.t_end * k / (plan.points - 1) for k in range(plan.points - 1)), plan.t_end]


def _in_one(scene: AnyScene, target: str, project: tuple[str, ...], events: tuple[str, ...]) -> Job:
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

    return Job(
        scene, scene.derive(), compiled.files, integrate, handed=False, noted=compiled.notice
    )


def _with_handover(scene: Scene, target: str, project: tuple[str, ...]) -> Job:
    from codegen.runs import handover
    from codegen.runs.charts import compile_charts
    from eom.scenes.handover import charts, numbers

    if project:
        raise InputError(
            "states are not projected where angles are handed over",
            where="--project",
            got=", ".join(project),
            hint='--no-handover, or attitude = "quaternion"',
        )
    found = charts(scene)
    initial, parameters = numbers(scene, found)
    with waiting_for("compiling"):
        made = compile_charts(found, target)
    if made.first.notice:
        click.echo(f"note: {made.first.notice}", err=True)
    plan = scene.integration

    def integrate(progress: Progress) -> Result:
        return handover.simulate(
            made,
            initial,
            (0.0, plan.t_end),
            parameters,
            plan.method,
            plan.rtol,
            plan.atol,
            _times(scene),
            inputs={n: v.value for n, v in scene.inputs.items() if n in found.first.input_names},
            max_step=plan.max_step or math.inf,
            max_steps=plan.max_steps,
            progress=progress,
        )

    return Job(scene, found.first, _files(made), integrate, handed=True, noted=made.first.notice)


def _files(made: CompiledCharts) -> Mapping[str, str]:
    """Return the C files of a pair of charts, or the modules where there is no compiler."""
    from codegen.runs import handover_c

    if made.first.target == "c":
        return handover_c.files(made)
    compiled: tuple[Compiled, ...] = (made.first, made.second, made.forth, made.back)
    return {name: text for c in compiled for name, text in c.files.items()}
