"""Many bodies: trees of joints, their recursions, and the systems that they give."""

from eom.multibody.derive import derive
from eom.multibody.model import GROUND, Body, Joint, Load, Motion, Placement, Rotor, Tree

__all__ = ["GROUND", "Body", "Joint", "Load", "Motion", "Placement", "Rotor", "Tree", "derive"]
