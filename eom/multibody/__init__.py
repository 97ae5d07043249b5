"""Many bodies: trees of joints, their recursions, and the systems that they give."""

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

__all__ = [
    "GROUND",
    "Assembly",
    "Body",
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
    "Rolling",
    "Skate",
    "SpeedEquation",
    "Tree",
    "assemble",
    "derive",
    "examine",
]
