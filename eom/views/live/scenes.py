"""What a live page needs of a scene, whatever its model."""

from __future__ import annotations

from eom.errors import InputError
from eom.multibody.files.scene import TreeScene
from eom.opening import AnyScene
from eom.views.live.one_body import of_body
from eom.views.live.subject import Subject
from eom.views.live.trees import of_tree


def subject_of(scene: AnyScene) -> Subject:
    """Return what a page about a scene needs.

    Raises `InputError` for sampled laws of control, and as the scene's derivation does.
    """
    control = scene.control
    if control.period is not None and control.laws:
        raise InputError(
            "a live page holds no sampled laws of control",
            where=f"{scene.name}: [control] period",
            got=f"{control.period}",
            hint="eom animate shows its motion with the scene's numbers",
        )
    return of_tree(scene) if isinstance(scene, TreeScene) else of_body(scene)
