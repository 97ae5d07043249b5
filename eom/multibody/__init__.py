"""Many bodies: trees of joints, their recursions, and the systems that they give."""

from eom.multibody.attachments import Rotor, Spring
from eom.multibody.base import BaseParameters, base_parameters
from eom.multibody.closed import (
    ClosedForm,
    Comparison,
    absolute_angles,
    closed_form,
    compare,
    tree_page,
)
from eom.multibody.consistent import Assembly, assemble
from eom.multibody.constraints import (
    Coupling,
    Distance,
    Equation,
    Loop,
    Rolling,
    Skate,
    SpeedEquation,
)
from eom.multibody.dependence import Examination, examine
from eom.multibody.derive import derive
from eom.multibody.model import GROUND, Body, Constraint, Joint, Load, Motion, Placement, Tree
from eom.multibody.points import Point
from eom.multibody.reactions import Reaction, reaction
from eom.multibody.regressor import Regressor, regressor

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
    "Joint",
    "Load",
    "Loop",
    "Motion",
    "Placement",
    "Point",
    "Reaction",
    "Regressor",
    "Rolling",
    "Rotor",
    "Skate",
    "SpeedEquation",
    "Spring",
    "Tree",
    "absolute_angles",
    "assemble",
    "base_parameters",
    "closed_form",
    "compare",
    "derive",
    "examine",
    "reaction",
    "regressor",
    "tree_page",
]
