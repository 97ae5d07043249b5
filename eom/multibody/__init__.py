"""Many bodies: trees of joints, their recursions, and the systems that they give."""

from eom.multibody.derive import derive
from eom.multibody.model import GROUND, Body, Joint, Load, Motion, Placement, Tree
from eom.multibody.reactions import Reaction, reaction

__all__ = [
    "GROUND",
    "Body",
    "Joint",
    "Load",
    "Motion",
    "Placement",
    "Reaction",
    "Tree",
    "derive",
    "reaction",
]
