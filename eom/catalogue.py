"""The scenes that ship with the package; reading their titles needs neither SymPy nor NumPy."""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path

from eom.errors import unknown_name

TOML, URDF = ".toml", ".urdf"
"""How names of scene files end."""


def is_file(name: str) -> bool:
    """Tell files from names of scenes, problems and derivations."""
    return name.endswith((TOML, URDF)) or "/" in name


def _folder() -> Path:
    return Path(str(resources.files("eom"))) / "scenes"


def names() -> list[str]:
    """Return the names of the ready scenes, sorted.

    >>> names()
    ['bicycle-wheel', 'double-pendulum', 'gravity-gradient-satellite', 'heavy-top', 't-handle', 't-handle-in-angles']
    """
    return sorted(p.stem for p in _folder().glob("*.toml"))


def titles() -> dict[str, str]:
    """Return the title of each ready scene by name."""
    return {n: tomllib.loads(path_of(n).read_text(encoding="utf-8"))["title"] for n in names()}


def path_of(name: str) -> Path:
    """Return the file of a ready scene. Raises `InputError` for other names."""
    if name not in names():
        raise unknown_name("scene", name, names())
    return _folder() / f"{name}.toml"
