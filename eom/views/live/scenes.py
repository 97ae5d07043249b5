"""What a live page needs of a scene, whatever its model."""

from __future__ import annotations

from eom.multibody.files.scene import TreeScene
from eom.opening import AnyScene
from eom.views.live.one_body import of_body
from eom.views.live.subject import Subject
from eom.views.live.trees import of_tree


def subject_of(scene: AnyScene) -> Subject:
    """Return what a page about a scene needs. Raises `InputError` as its derivation does."""
    return of_tree(scene) if isinstance(scene, TreeScene) else of_body(scene)
