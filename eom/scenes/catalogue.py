"""The scenes that ship with the package; reading their titles needs neither SymPy nor NumPy."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from eom.errors import unknown_name

TOML, URDF, MJCF = ".toml", ".urdf", ".xml"
"""How names of scene files end."""
ROBOTS = (URDF, MJCF)
"""How names of files end that other programs of robots read."""

TREE = "tree"
"""The ``model`` of scenes with many bodies, which `eom.multibody.files.scene.TreeScene` reads."""
OF_TREES = frozenset(
    "bodies constraints gravity gravity_gradient jets joint joints loads points repeat rotors "
    "springs".split()
)
"""Keys of scene files that bring what trees have; of one body, they make it a tree of one."""


def is_tree(data: Mapping[str, Any]) -> bool:
    """Tell whether what a scene file says is of a tree of bodies, or of one body that is derived as one."""
    return data.get("model") == TREE or not OF_TREES.isdisjoint(data)


def is_file(name: str) -> bool:
    """Separate files from names of scenes, problems and derivations."""
    return name.endswith((TOML, *ROBOTS)) or "/" in name


def _folder() -> Path:
    return Path(str(resources.files("eom"))) / "scenes"


def names() -> list[str]:
    """Return the names of the ready scenes, sorted.

    >>> names()[:3]
    ['bicycle-wheel', 'control-moment-gyroscope', 'double-pendulum']
    """
    return sorted(p.stem for p in _folder().glob("*.toml"))


def single() -> list[str]:
    """Return the names of the ready scenes of one body, sorted.

    >>> "heavy-top" in single(), "double-pendulum" in single()
    (True, False)
    """
    return [n for n in names() if not is_tree(_data(n))]


def titles() -> dict[str, str]:
    """Return the title of each ready scene by name."""
    return {n: _data(n)["title"] for n in names()}


def _data(name: str) -> dict[str, Any]:
    return tomllib.loads(path_of(name).read_text(encoding="utf-8"))


def path_of(name: str) -> Path:
    """Return the file of a ready scene. Raises `InputError` for other names."""
    if name not in names():
        raise unknown_name("scene", name, names())
    return _folder() / f"{name}.toml"
