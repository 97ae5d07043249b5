"""Packages that pictures need and that are optional extras of this one."""

from __future__ import annotations

import importlib.util

from eom.errors import InputError

EXTRAS = {"matplotlib": ("Matplotlib", "plot"), "plotly": ("Plotly", "turn")}
"""Name and extra by package."""


def installed(package: str) -> bool:
    """Tell whether a package is there."""
    return importlib.util.find_spec(package) is not None


def require(package: str, where: str = "") -> None:
    """Raise `InputError` that says which extra to install where a package is missing."""
    if not installed(package):
        name, extra = EXTRAS[package]
        raise InputError(
            f"{name} is not installed", where=where, hint=f"pip install 'eom-toolkit[{extra}]'"
        )
