"""Scenes of every model by name or file."""

from __future__ import annotations

from pathlib import Path

from eom.errors import InputError, typed
from eom.multibody.files.mjcf import load_mjcf
from eom.multibody.files.scene import TreeScene
from eom.multibody.files.urdf import load_urdf
from eom.scenes import catalogue
from eom.scenes.scene import Scene
from eom.scenes.scene_files import data_of

AnyScene = Scene | TreeScene
"""A scene of one body, or of many."""


@typed
def load_scene(name: str | Path, *, strict: bool = True, floating: bool = False) -> AnyScene:
    """Return a ready scene by its name, or one from a file.

    Parameters
    ----------
    name : str or Path
        A file: ``.toml``, ``.urdf`` (extra ``urdf``), or ``.xml`` of MuJoCo (extra ``mujoco``). A word
        that is no file is the name of a ready scene.
    strict : bool, default True
        Of a robot's file: unless it is set, what no body or tree is gets mended, and the scene's
        ``repairs`` say how, and what was left out.
    floating : bool, default False
        Of a robot's file: whether the root link is freed.

    Returns
    -------
    Scene or TreeScene
        A `Scene` has one body, a `TreeScene` many; both answer the same.

    Raises
    ------
    InputError
        For other names, with the file's name for whatever is wrong in it, and for ``strict`` and
        ``floating`` on other scenes than robots.

    Notes
    -----
    SI units, angles in radians; frames are those of the ground, the bodies and the joints.

    Examples
    --------
    >>> load_scene("double-pendulum").derive().state_names
    ('q_shoulder', 'q_elbow', 'u_shoulder', 'u_elbow')
    """
    is_ready = isinstance(name, str) and not catalogue.is_file(name)
    file = catalogue.path_of(str(name)) if is_ready else Path(name)
    if file.suffix == catalogue.URDF:
        return load_urdf(file, strict=strict, floating=floating)
    if file.suffix == catalogue.MJCF:
        return load_mjcf(file, strict=strict, floating=floating)
    if floating or not strict:
        raise InputError(
            "only robots from URDF and MJCF files are read leniently, or freed of the ground",
            where=str(name),
            hint="of other scenes write the joint of kind free",
        )  # fmt: skip
    tree = catalogue.is_tree(data_of(file))
    return TreeScene.from_toml(file) if tree else Scene.from_toml(file)
