"""Many bodies: trees of joints, their recursions, and the systems that they give."""

from eom.multibody.constraints import (
    Coupling,
    Distance,
    Equation,
    Loop,
    Rolling,
    Skate,
    SpeedEquation,
)
from eom.multibody.derive import derive
from eom.multibody.model import GROUND, Body, Constraint, Joint, Load, Motion, Placement, Tree

__all__ = [
    "GROUND",
    "Body",
    "Constraint",
    "Coupling",
    "Distance",
    "Equation",
    "Joint",
    "Load",
    "Loop",
    "Motion",
    "Placement",
    "Rolling",
    "Skate",
    "SpeedEquation",
    "Tree",
    "derive",
]
