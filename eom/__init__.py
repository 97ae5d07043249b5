"""Derive the equations of motion of rigid bodies with SymPy.

The names below load on first use, so that the command line starts fast.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eom.checker.checking import check as check
    from eom.checker.grading import check_files as check_files
    from eom.derivation import Derivation as Derivation
    from eom.derivations import derive as derive
    from eom.errors import AssumptionError as AssumptionError
    from eom.errors import InputError as InputError
    from eom.multibody.scene import TreeScene as TreeScene
    from eom.opening import load_scene as load_scene
    from eom.rigidbody import euler_equations as euler_equations
    from eom.rigidbody import free_rigid_body as free_rigid_body
    from eom.rigidbody import full_inertia as full_inertia
    from eom.rigidbody import gravity_gradient_satellite as gravity_gradient_satellite
    from eom.rigidbody import heavy_top as heavy_top
    from eom.rigidbody import principal_inertia as principal_inertia
    from eom.rigidbody import rigid_body as rigid_body
    from eom.scene import Scene as Scene
    from eom.spinning import SpinningSymmetricBody as SpinningSymmetricBody
    from eom.spinning import lecture_torque as lecture_torque
    from eom.system import Assumption as Assumption
    from eom.system import BodyAttitude as BodyAttitude
    from eom.system import Definition as Definition
    from eom.system import Quantity as Quantity
    from eom.system import Singularity as Singularity
    from eom.system import System as System
    from eom.tables import Table as Table

__version__ = "0.1.0"
"""The version of both packages, `eom` and `codegen`, as text: major.minor.patch."""

_HOME = {
    "check": "checker.checking",
    "check_files": "checker.grading",
    "Derivation": "derivation",
    "derive": "derivations",
    "AssumptionError": "errors",
    "InputError": "errors",
    "euler_equations": "rigidbody",
    "free_rigid_body": "rigidbody",
    "full_inertia": "rigidbody",
    "gravity_gradient_satellite": "rigidbody",
    "heavy_top": "rigidbody",
    "principal_inertia": "rigidbody",
    "rigid_body": "rigidbody",
    "Scene": "scene",
    "TreeScene": "multibody.scene",
    "load_scene": "opening",
    "SpinningSymmetricBody": "spinning",
    "lecture_torque": "spinning",
    "Assumption": "system",
    "BodyAttitude": "system",
    "Definition": "system",
    "Quantity": "system",
    "Singularity": "system",
    "System": "system",
    "Table": "tables",
}

__all__ = [*_HOME, "__version__"]  # noqa: PLE0604 - all entries are strings


def __getattr__(name: str) -> object:
    """Import the module that holds ``name`` on first use."""
    if name not in _HOME:
        raise AttributeError(f"module 'eom' has no attribute {name!r}")
    return getattr(importlib.import_module(f"eom.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
