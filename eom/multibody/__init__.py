"""Many bodies: trees of joints, their recursions, and the systems that they give."""

from eom.multibody.derive import derive
from eom.multibody.model import GROUND, Body, Joint, Load, Motion, Placement, Rotor, Spring, Tree
from eom.multibody.points import Point

__all__ = [
    "GROUND",
    "Body",
    "Joint",
    "Load",
    "Motion",
    "Placement",
    "Point",
    "Rotor",
    "Spring",
    "Tree",
    "derive",
]
