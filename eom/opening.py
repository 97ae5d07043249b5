"""Scenes of every model by name or file."""

from __future__ import annotations

from pathlib import Path

from eom.errors import typed
from eom.multibody.files.scene import TreeScene
from eom.multibody.files.urdf import load_urdf
from eom.scenes import catalogue
from eom.scenes.scene import Scene
from eom.scenes.scene_files import data_of

AnyScene = Scene | TreeScene
"""A scene of one body, or of many."""


@typed
def load_scene(name: str | Path) -> AnyScene:
    """Return a ready scene by its name, or one from a file: ``.toml``, or ``.urdf`` (extra ``urdf``).

    A word that is no file is a ``name`` of a ready scene. A `Scene` has one body, a `TreeScene` many;
    both answer the same. Raises `InputError` for other names, and with the file's name for whatever is
    wrong in it.

    >>> load_scene("double-pendulum").derive().state_names
    ('q_shoulder', 'q_elbow', 'u_shoulder', 'u_elbow')
    """
    is_ready = isinstance(name, str) and not catalogue.is_file(name)
    file = catalogue.path_of(str(name)) if is_ready else Path(name)
    if file.suffix == catalogue.URDF:
        return load_urdf(file)
    tree = catalogue.is_tree(data_of(file))
    return TreeScene.from_toml(file) if tree else Scene.from_toml(file)
