"""Many bodies: trees of joints, their recursions, and the systems that they give.

Imports: nothing of ours. The names below load on first use, as those of `eom` do.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eom.multibody.analysis import Lagrangian as Lagrangian
    from eom.multibody.analysis import analysis_page as analysis_page
    from eom.multibody.analysis import conserved_quantities as conserved_quantities
    from eom.multibody.analysis import cyclic_coordinates as cyclic_coordinates
    from eom.multibody.analysis import equations_of as equations_of
    from eom.multibody.analysis import lagrangian as lagrangian
    from eom.multibody.analysis import linearised as linearised
    from eom.multibody.analysis import routh as routh
    from eom.multibody.analysis import small_motion as small_motion
    from eom.multibody.analysis import stability as stability
    from eom.multibody.analysis import steady_motion as steady_motion
    from eom.multibody.closed import ClosedForm as ClosedForm
    from eom.multibody.closed import Comparison as Comparison
    from eom.multibody.closed import absolute_angles as absolute_angles
    from eom.multibody.closed import closed_form as closed_form
    from eom.multibody.closed import compare as compare
    from eom.multibody.closed import tree_page as tree_page
    from eom.multibody.constrained.consistent import Assembly as Assembly
    from eom.multibody.constrained.consistent import assemble as assemble
    from eom.multibody.constrained.dependence import Examination as Examination
    from eom.multibody.constrained.dependence import examine as examine
    from eom.multibody.identify.base_parameters import BaseParameters as BaseParameters
    from eom.multibody.identify.base_parameters import base_parameters as base_parameters
    from eom.multibody.identify.regressor import Regressor as Regressor
    from eom.multibody.identify.regressor import regressor as regressor
    from eom.multibody.model.attachments import Load as Load
    from eom.multibody.model.attachments import Rotor as Rotor
    from eom.multibody.model.attachments import Spring as Spring
    from eom.multibody.model.bodies import GROUND as GROUND
    from eom.multibody.model.bodies import Body as Body
    from eom.multibody.model.bodies import Joint as Joint
    from eom.multibody.model.bodies import Motion as Motion
    from eom.multibody.model.bodies import Placement as Placement
    from eom.multibody.model.constraints import Coupling as Coupling
    from eom.multibody.model.constraints import Distance as Distance
    from eom.multibody.model.constraints import Equation as Equation
    from eom.multibody.model.constraints import KnifeEdge as KnifeEdge
    from eom.multibody.model.constraints import Loop as Loop
    from eom.multibody.model.constraints import Rolling as Rolling
    from eom.multibody.model.constraints import SpeedEquation as SpeedEquation
    from eom.multibody.model.jets import Jet as Jet
    from eom.multibody.model.model import Constraint as Constraint
    from eom.multibody.model.model import Tree as Tree
    from eom.multibody.recursion.quantities import Point as Point
    from eom.multibody.system.derive import TreeFunction as TreeFunction
    from eom.multibody.system.derive import centre_of_mass as centre_of_mass
    from eom.multibody.system.derive import derive as derive
    from eom.multibody.system.derive import energies as energies
    from eom.multibody.system.derive import forward_dynamics as forward_dynamics
    from eom.multibody.system.derive import inverse_dynamics as inverse_dynamics
    from eom.multibody.system.derive import jacobian as jacobian
    from eom.multibody.system.derive import mass_matrix as mass_matrix
    from eom.multibody.system.reactions import Reaction as Reaction
    from eom.multibody.system.reactions import reaction as reaction

_HOME = {
    "Assembly": "constrained.consistent",
    "BaseParameters": "identify.base_parameters",
    "Body": "model.bodies",
    "ClosedForm": "closed",
    "Comparison": "closed",
    "Constraint": "model.model",
    "Coupling": "model.constraints",
    "Distance": "model.constraints",
    "Equation": "model.constraints",
    "Examination": "constrained.dependence",
    "GROUND": "model.bodies",
    "Jet": "model.jets",
    "Joint": "model.bodies",
    "KnifeEdge": "model.constraints",
    "Lagrangian": "analysis",
    "Load": "model.attachments",
    "Loop": "model.constraints",
    "Motion": "model.bodies",
    "Placement": "model.bodies",
    "Point": "recursion.quantities",
    "Reaction": "system.reactions",
    "Regressor": "identify.regressor",
    "Rolling": "model.constraints",
    "Rotor": "model.attachments",
    "SpeedEquation": "model.constraints",
    "Spring": "model.attachments",
    "Tree": "model.model",
    "TreeFunction": "system.derive",
    "absolute_angles": "closed",
    "analysis_page": "analysis",
    "assemble": "constrained.consistent",
    "base_parameters": "identify.base_parameters",
    "centre_of_mass": "system.derive",
    "closed_form": "closed",
    "compare": "closed",
    "conserved_quantities": "analysis",
    "cyclic_coordinates": "analysis",
    "derive": "system.derive",
    "energies": "system.derive",
    "equations_of": "analysis",
    "examine": "constrained.dependence",
    "forward_dynamics": "system.derive",
    "inverse_dynamics": "system.derive",
    "jacobian": "system.derive",
    "lagrangian": "analysis",
    "linearised": "analysis",
    "mass_matrix": "system.derive",
    "reaction": "system.reactions",
    "regressor": "identify.regressor",
    "routh": "analysis",
    "small_motion": "analysis",
    "stability": "analysis",
    "steady_motion": "analysis",
    "tree_page": "closed",
}

__all__ = list(_HOME)


def __getattr__(name: str) -> Any:
    """Import the module that holds ``name`` on first use."""
    if name not in _HOME:
        raise AttributeError(f"module 'eom.multibody' has no attribute {name!r}")
    found = globals()[name] = getattr(importlib.import_module(f"eom.multibody.{_HOME[name]}"), name)
    return found


def __dir__() -> list[str]:
    """Show the public names alone, not the folders that they come from."""
    return sorted(__all__)
