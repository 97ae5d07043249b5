"""Runs of scenes for pictures: integrated as they say, with angles handed over where they ask for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eom.scene import Scene
from eom.views.picture import Floats

if TYPE_CHECKING:
    from codegen import Result
    from eom.opening import AnyScene
    from eom.system import System


@dataclass(frozen=True)
class Run:
    """A scene's system and its run; ``names``: what the scene asks for that varies."""

    system: System
    result: Result
    names: tuple[str, ...]


def run(scene: AnyScene, seconds: float | None = None, points: int | None = None) -> Run:
    """Return the run of a scene from t = 0, by default as long and at as many times as it says.

    Raises `InputError` as the scene and `codegen.simulate` do.
    """
    plan = scene.integration
    t = np.linspace(0.0, seconds or plan.t_end, points or plan.points)
    if isinstance(scene, Scene) and plan.handover:
        system, result = _handed_over(scene, t)
    else:
        system, result = _in_one(scene, t)
    known = {*system.state_names, *system.output_names}
    return Run(system, result, tuple(n for n in scene.requested if n in known))


def _in_one(scene: AnyScene, t: Floats) -> tuple[System, Result]:
    import codegen

    plan, system = scene.integration, scene.derive()
    result = codegen.simulate(
        system,
        scene.initial_values(),
        (0.0, float(t[-1])),
        scene.parameter_values(),
        plan.method,
        plan.rtol,
        plan.atol,
        t,
        inputs=scene.input_values(),
        max_steps=plan.max_steps,
    )
    return system, result


def _handed_over(scene: Scene, t: Floats) -> tuple[System, Result]:
    from codegen import handover
    from codegen.charts import compile_charts
    from eom.handover import charts, numbers

    found, plan = charts(scene), scene.integration
    initial, parameters = numbers(scene, found)
    result = handover.simulate(
        compile_charts(found, "auto"),
        initial,
        (0.0, float(t[-1])),
        parameters,
        plan.method,
        plan.rtol,
        plan.atol,
        t.tolist(),
        inputs={n: v.value for n, v in scene.inputs.items() if n in found.first.input_names},
        max_steps=plan.max_steps,
    )
    return found.first, result
