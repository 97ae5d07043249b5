"""Every derivation by name: the results of the lectures, step by step.

Titles are read without SymPy; a derivation is made, and each of its steps verified, when it is asked
for.

Imports: `eom.errors`, `eom.exact`, `eom.expressions`, `eom.fields`, `eom.quantities`, `eom.system`,
`eom.terms`, `eom.terms.rules`, `eom.typeset`, `eom.worlds`.
"""

from __future__ import annotations

import importlib
from functools import lru_cache
from typing import TYPE_CHECKING

from eom.errors import InputError, near_matches, typed

if TYPE_CHECKING:
    from eom.derivations.derived import Derived

_MAKERS = {
    "point-mass": ("pointmass", "point_mass", "Particles", "Dynamics of a point mass"),
    "particle-system": (
        "particles",
        "particle_system",
        "Particles",
        "Dynamics of a system of point masses",
    ),
    "variable-mass": ("variablemass", "variable_mass", "Particles", "A body whose mass changes"),
    "rocket-equation": (
        "rocket",
        "rocket_equation",
        "Particles",
        "The rocket: Tsiolkovsky's logarithm",
    ),
    "collisions": ("collisions", "collisions", "Particles", "Collisions and blows"),
    "virtual-work": (
        "virtualwork",
        "virtual_work",
        "Particles",
        "From d'Alembert's principle to Lagrange's and Kane's equations",
    ),
    "transport-theorem": (
        "rotation",
        "transport_theorem",
        "Rotation",
        "Derivatives as seen from a turning frame",
    ),
    "tilde-identities": (
        "rotation",
        "tilde_identities",
        "Rotation",
        "The cross product as a matrix",
    ),
    "rigid-body-momentum": (
        "rigid",
        "rigid_momentum",
        "Rigid body",
        "Momentum and inertia of a rigid body",
    ),
    "euler-equations": (
        "euler",
        "euler_equations",
        "Rigid body",
        "Euler's equations of a rigid body",
    ),
    "kinetic-energy": ("energy", "kinetic_energy", "Rigid body", "Kinetic energy of a rigid body"),
    "inertia-properties": (
        "inertia",
        "inertia_properties",
        "Inertia",
        "Properties of the inertia matrix",
    ),
    "torque-free-motion": (
        "torquefree",
        "torque_free_motion",
        "Torque-free motion",
        "Torque-free motion of a rigid body",
    ),
    "energy-dissipation": (
        "dissipation",
        "energy_dissipation",
        "Torque-free motion",
        "Energy dissipation and the major-axis rule",
    ),
    "spinning-symmetric-body": (
        "spinner",
        "spinning_symmetric_body",
        "Spinning bodies",
        "The 3-1-2 spinning symmetric body",
    ),
    "heavy-symmetric-top": (
        "heavytop",
        "heavy_symmetric_top",
        "Spinning bodies",
        "The heavy symmetric top",
    ),
    "gyrostat": (
        "gyrostat",
        "gyrostat_momentum",
        "Spinning bodies",
        "A gyrostat: a body with any number of rotors",
    ),
    "gravity-gradient-stability": (
        "gravitygradient",
        "gravity_gradient_stability",
        "Spacecraft",
        "Stability under the gravity gradient",
    ),
}
"""Name: module, function, group, title."""

SOLIDS = (
    "box", "rectangular plate", "triangular plate", "triangular prism", "tetrahedron", "pyramid",
    "rod", "ring", "disc", "annulus", "semicircular disc", "elliptical disc",
    "cylinder", "elliptical cylinder", "hollow cylinder", "cylindrical shell",
    "cone", "frustum", "conical shell", "sphere", "hollow sphere", "spherical shell", "hemisphere",
    "hemispherical shell", "ellipsoid", "torus",
)  # fmt: skip
"""The solids of the catalogue, in reading order."""


def _solid_names() -> dict[str, str]:
    return {"inertia-of-" + solid.replace(" ", "-"): solid for solid in SOLIDS}


def titles() -> dict[str, dict[str, str]]:
    """Return the title of each derivation, by group and name."""
    groups: dict[str, dict[str, str]] = {}
    for name, (_, _, group, title) in _MAKERS.items():
        groups.setdefault(group, {})[name] = title
    groups["Inertia of solids"] = {n: f"Inertia of the {s}" for n, s in _solid_names().items()}
    return groups


def names() -> list[str]:
    """Return the names of all derivations.

    >>> names()[:2]
    ['point-mass', 'particle-system']
    """
    return [*_MAKERS, *_solid_names()]


@typed
def derive(name: str) -> Derived:
    """Return a derivation by its ``name``, every step verified when it is made.

    Parameters
    ----------
    name : str
        One of those that ``eom list`` prints: chapters of the lectures, and ``inertia-of-`` a solid.

    Returns
    -------
    Derived
        The steps by their labels, each with its statement and reason. The same object is returned
        again.

    Raises
    ------
    InputError
        For unknown names.

    Notes
    -----
    Frames, units and sources stand in the steps.

    Examples
    --------
    >>> derive("point-mass")["newton"].reason
    "Newton's second law"
    """
    return _derived(name)


@lru_cache(maxsize=64)
def _derived(name: str) -> Derived:
    """Make a derivation. Raises `DerivationError` for one that asserts a result."""
    from eom.derivations.reached import refuse_asserted

    return refuse_asserted(_made(name))


def _made(name: str) -> Derived:
    solids = _solid_names()
    if name in solids:
        module = importlib.import_module("eom.derivations.chapters.solids")
        made: Derived = module.solid_inertia(solids[name])
        return made
    if name not in _MAKERS:
        hint = near_matches(name, names()) or "eom list names them"
        raise InputError(f"unknown derivation {name!r}", hint=hint)
    module_name, function, _, _ = _MAKERS[name]
    module = importlib.import_module(f"eom.derivations.chapters.{module_name}")
    result: Derived = getattr(module, function)()
    return result
