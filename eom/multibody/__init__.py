"""Many bodies: trees of joints, their recursions, and the systems that they give."""

from eom.multibody.base import BaseParameters, base_parameters
from eom.multibody.derive import derive
from eom.multibody.model import GROUND, Body, Joint, Load, Motion, Placement, Tree
from eom.multibody.reactions import Reaction, reaction
from eom.multibody.regressor import Regressor, regressor

__all__ = [
    "GROUND",
    "BaseParameters",
    "Body",
    "Joint",
    "Load",
    "Motion",
    "Placement",
    "Reaction",
    "Regressor",
    "Tree",
    "base_parameters",
    "derive",
    "reaction",
    "regressor",
]
