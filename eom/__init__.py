"""Derive the equations of motion of rigid bodies with SymPy, compile and integrate them.

The names below load on first use, so that the command line starts fast. Those of `codegen` are found
here too, so that one import is enough for everything: ``eom.simulate`` is ``codegen.simulate``.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from eom import displays

if TYPE_CHECKING:
    from eom.checker.note.checking import check as check
    from eom.checker.note.grading import check_files as check_files
    from eom.derivations import derive as derive
    from eom.derivations.derivation import Derivation as Derivation
    from eom.derivations.derived import Derived as Derived
    from eom.errors import AssumptionError as AssumptionError
    from eom.errors import InputError as InputError
    from eom.expressions import saturate as saturate
    from eom.mechanics.rigidbody import euler_equations as euler_equations
    from eom.mechanics.rigidbody import free_rigid_body as free_rigid_body
    from eom.mechanics.rigidbody import full_inertia as full_inertia
    from eom.mechanics.rigidbody import gravity_gradient_satellite as gravity_gradient_satellite
    from eom.mechanics.rigidbody import heavy_top as heavy_top
    from eom.mechanics.rigidbody import principal_inertia as principal_inertia
    from eom.mechanics.rigidbody import rigid_body as rigid_body
    from eom.mechanics.spinning import SpinningSymmetricBody as SpinningSymmetricBody
    from eom.mechanics.spinning import lecture_torque as lecture_torque
    from eom.multibody.files.scene import TreeScene as TreeScene
    from eom.opening import load_scene as load_scene
    from eom.quantities import Assumption as Assumption
    from eom.quantities import Definition as Definition
    from eom.quantities import Quantity as Quantity
    from eom.quantities import Singularity as Singularity
    from eom.scenes.scene import Scene as Scene
    from eom.system import BodyAttitude as BodyAttitude
    from eom.system import System as System
    from eom.tables import Table as Table

__version__ = "0.1.0"
"""The version of both packages, `eom` and `codegen`, as text: major.minor.patch."""

_HOME = {
    "check": "checker.note.checking",
    "check_files": "checker.note.grading",
    "Derivation": "derivations.derivation",
    "Derived": "derivations.derived",
    "derive": "derivations",
    "AssumptionError": "errors",
    "InputError": "errors",
    "euler_equations": "mechanics.rigidbody",
    "free_rigid_body": "mechanics.rigidbody",
    "full_inertia": "mechanics.rigidbody",
    "gravity_gradient_satellite": "mechanics.rigidbody",
    "heavy_top": "mechanics.rigidbody",
    "principal_inertia": "mechanics.rigidbody",
    "rigid_body": "mechanics.rigidbody",
    "Scene": "scenes.scene",
    "TreeScene": "multibody.files.scene",
    "load_scene": "opening",
    "saturate": "expressions",
    "SpinningSymmetricBody": "mechanics.spinning",
    "lecture_torque": "mechanics.spinning",
    "Assumption": "quantities",
    "BodyAttitude": "system",
    "Definition": "quantities",
    "Quantity": "quantities",
    "Singularity": "quantities",
    "System": "system",
    "Table": "tables",
}

displays.register({
    "system as page": "eom.typeset.printing:notebook",
    "accuracy as page": "codegen.precision.accuracy_report:notebook",
    "result as histories": "eom.views.time.histories:of_result",
    "result as animation": "eom.views.animation.of_results:animated",
    "picture as file": "eom.views.draw.saving:save",
    "picture as figure": "eom.views.draw.printed:figure",
})  # fmt: skip

__all__ = [*_HOME, "__version__"]  # noqa: PLE0604 - all entries are strings


def __getattr__(name: str) -> Any:
    """Import the module that holds ``name`` on first use; names of `codegen` are found by its own."""
    if name in _HOME:
        found = getattr(importlib.import_module(f"eom.{_HOME[name]}"), name)
    elif not name.startswith("_") and name in _numerical().__all__:
        found = getattr(_numerical(), name)
    else:
        raise AttributeError(f"module 'eom' has no attribute {name!r}")
    globals()[name] = found
    return found


def _numerical() -> Any:
    """Return the package that compiles and integrates, which nothing below the front door knows."""
    return importlib.import_module("codegen")


def __dir__() -> list[str]:
    return sorted({*__all__, *_numerical().__all__})
