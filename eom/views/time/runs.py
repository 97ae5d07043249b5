"""The integrated motion of a scene of any model, for pictures of its states and outputs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from codegen import Result
    from eom.opening import AnyScene
    from eom.system import System
    from eom.views.draw.picture import Floats


def run(
    scene: AnyScene, seconds: float | None = None, points: int | None = None
) -> tuple[Result, System]:
    """Integrate a scene as `eom simulate` does; return the run and the system of its states and outputs.

    ``seconds``, ``points``: end and number of the stored times, by default the scene's own. Raises as
    derivation and `codegen.simulate` do.
    """
    plan = scene.integration
    t = np.linspace(0.0, seconds or plan.t_end, points or plan.points)
    return integrated(scene, t), scene.derive()


def integrated(scene: AnyScene, t: Floats) -> Result:
    """Return the run of a scene over the times ``t``, in the scene's own coordinates."""
    import codegen

    plan = scene.integration
    return codegen.simulate(
        codegen.compile(scene.derive()),
        scene.initial_values(),
        (float(t[0]), float(t[-1])),
        scene.parameter_values(),
        plan.method,
        plan.rtol,
        plan.atol,
        t,
        inputs=scene.input_values(),
        max_step=plan.max_step or math.inf,
        max_steps=plan.max_steps,
    )
