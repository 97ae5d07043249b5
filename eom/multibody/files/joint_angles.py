"""Angles of joints whose attitude is a quaternion, as outputs of a tree."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from eom.errors import InputError, unknown_name
from eom.kinematics.coordinates import SEQUENCES, rotation_sequence
from eom.mechanics.sequence_angles import with_angles
from eom.multibody.files.description import JointPart
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Joint, Tree
from eom.system import Quantity, System


@dataclass(frozen=True)
class JointAngles:
    """The angles of a ``sequence`` (rad) of a joint that has a quaternion, child on parent."""

    joint: Joint
    sequence: str

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What they would be called if the joint had them in the place of the quaternion."""
        return replace(self.joint, attitude=self.sequence).coordinates[-3:]

    def of(self, system: System) -> System:
        """Return a system that has them as outputs; ``system`` has the joint's quaternion."""
        q = [c.symbol for c in self.joint.coordinates[-4:]]
        return with_angles(system, rotation_sequence(self.sequence), q, self.quantities)


def angles_of(parts: Mapping[str, JointPart], tree: Tree) -> tuple[JointAngles, ...]:
    """Return the angles that joints are shown in.

    Raises `InputError` for other words than sequences, and for joints that have no quaternion.
    """
    joints = {j.name: j for j in tree.ordered}
    return tuple(_checked(joints[name], part.angles) for name, part in parts.items() if part.angles)


def _checked(joint: Joint, sequence: str) -> JointAngles:
    where = f"joint {joint.name!r}: angles"
    if sequence not in SEQUENCES:
        raise unknown_name("rotation sequence", sequence, SEQUENCES, where)
    if not joint.row.attitude or joint.attitude != QUATERNION or joint.motion is not None:
        raise InputError(
            "only a joint that moves in a quaternion has such outputs",
            where=where,
            got=f"kind {joint.kind}, attitude {joint.attitude}"
            + (", a prescribed motion" if joint.motion is not None else ""),
        )
    return JointAngles(joint, sequence)
