"""Many bodies: trees of joints, their recursions, and the systems that they give."""

from eom.multibody.closed import (
    ClosedForm,
    Comparison,
    absolute_angles,
    closed_form,
    compare,
    tree_page,
)
from eom.multibody.derive import derive
from eom.multibody.model import GROUND, Body, Joint, Load, Motion, Placement, Tree

__all__ = [
    "GROUND",
    "Body",
    "ClosedForm",
    "Comparison",
    "Joint",
    "Load",
    "Motion",
    "Placement",
    "Tree",
    "absolute_angles",
    "closed_form",
    "compare",
    "derive",
    "tree_page",
]
