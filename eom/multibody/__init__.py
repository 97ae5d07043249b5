"""Many bodies: trees of joints, their recursions, and the systems that they give.

Imports: nothing of ours.
"""

from eom.multibody.analysis import (
    Lagrangian,
    analysis_page,
    conserved_quantities,
    cyclic_coordinates,
    equations_of,
    lagrangian,
    linearised,
    routh,
    small_motion,
    stability,
    steady_motion,
)
from eom.multibody.closed import (
    ClosedForm,
    Comparison,
    absolute_angles,
    closed_form,
    compare,
    tree_page,
)
from eom.multibody.constrained.consistent import Assembly, assemble
from eom.multibody.constrained.dependence import Examination, examine
from eom.multibody.identify.base_parameters import BaseParameters, base_parameters
from eom.multibody.identify.regressor import Regressor, regressor
from eom.multibody.model.attachments import Load, Rotor, Spring
from eom.multibody.model.bodies import GROUND, Body, Joint, Motion, Placement
from eom.multibody.model.constraints import (
    Coupling,
    Distance,
    Equation,
    KnifeEdge,
    Loop,
    Rolling,
    SpeedEquation,
)
from eom.multibody.model.jets import Jet
from eom.multibody.model.model import Constraint, Tree
from eom.multibody.recursion.quantities import Point
from eom.multibody.system.derive import (
    TreeFunction,
    centre_of_mass,
    derive,
    energies,
    forward_dynamics,
    inverse_dynamics,
    jacobian,
    mass_matrix,
)
from eom.multibody.system.reactions import Reaction, reaction

__all__ = [
    "GROUND",
    "Assembly",
    "BaseParameters",
    "Body",
    "ClosedForm",
    "Comparison",
    "Constraint",
    "Coupling",
    "Distance",
    "Equation",
    "Examination",
    "Jet",
    "Joint",
    "KnifeEdge",
    "Lagrangian",
    "Load",
    "Loop",
    "Motion",
    "Placement",
    "Point",
    "Reaction",
    "Regressor",
    "Rolling",
    "Rotor",
    "SpeedEquation",
    "Spring",
    "Tree",
    "TreeFunction",
    "absolute_angles",
    "analysis_page",
    "assemble",
    "base_parameters",
    "centre_of_mass",
    "closed_form",
    "compare",
    "conserved_quantities",
    "cyclic_coordinates",
    "derive",
    "energies",
    "equations_of",
    "examine",
    "forward_dynamics",
    "inverse_dynamics",
    "jacobian",
    "lagrangian",
    "linearised",
    "mass_matrix",
    "reaction",
    "regressor",
    "routh",
    "small_motion",
    "stability",
    "steady_motion",
    "tree_page",
]
