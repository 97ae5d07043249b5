"""Points of bodies: position, velocity and acceleration in the ground's axes, as outputs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from eom.errors import InputError, near_matches, typed_fields
from eom.multibody.algebra import values
from eom.multibody.algebra.scalars import Scalar, Work
from eom.multibody.algebra.spatial import ZERO, Vector, cross, plus, times, transposed
from eom.multibody.model import checks
from eom.multibody.recursion.motion import Scalars, motion
from eom.multibody.recursion.quantities import Flow
from eom.multibody.recursion.recursions import accelerated
from eom.multibody.recursion.skeleton import Skeleton

QUANTITIES = {
    "position": ("x", "m"),
    "velocity": ("v", "m/s"),
    "acceleration": ("a", "m/s^2"),
}
"""What can be told of a point: letter and unit."""


@typed_fields
@dataclass(frozen=True)
class Point:
    """A point of a body that is told: outputs ``x_<name>_1`` to 3, ``v_...`` and ``a_...``.

    Position (m), velocity (m/s) and acceleration (m/s^2) from the ground's origin, in the ground's axes.
    ``body``: its name, or the ground. ``position``: in the body's axes, from its origin (m).
    ``quantities``: keys of `QUANTITIES`. Raises `InputError` for others.

    >>> Point("tip", "rod", (0, 0, -1), ("velocity",)).names
    ('v_tip_1', 'v_tip_2', 'v_tip_3')
    """

    name: str
    body: str
    position: Any = ZERO
    quantities: tuple[str, ...] = tuple(QUANTITIES)

    def __post_init__(self) -> None:
        where = f"point {self.name!r}"
        checks.name(self.name, where)
        object.__setattr__(self, "position", values.triple(self.position, f"{where}: position"))
        object.__setattr__(self, "quantities", tuple(self.quantities))
        for name in self.quantities:
            if name not in QUANTITIES:
                raise InputError(
                    f"unknown quantity {name!r}", where=where, expected=", ".join(QUANTITIES)
                )

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the outputs."""
        letters = (QUANTITIES[q][0] for q in self.quantities)
        return tuple(f"{letter}_{self.name}_{k}" for letter in letters for k in (1, 2, 3))


def point(
    given: Point,
    tree: Skeleton,
    flow: Flow,
    speeds: tuple[Scalars, Scalars],
    lift: Callable[[Any], Scalar],
    work: Work,
) -> dict[str, Vector]:
    """Return what is told of a point, by quantity.

    ``speeds``: those of the joints, and their rates. On the ground a point is at rest. Raises
    `InputError` for an unknown body.
    """
    if given.body not in tree.seats:
        raise InputError(
            f"unknown body {given.body!r}",
            where=f"point {given.name!r}",
            hint=near_matches(given.body, tree.seats),
        )
    seat = tree.seats[given.body]
    r = seat.point([lift(x) for x in given.position])
    if seat.part < 0:
        known = {"position": r, "velocity": ZERO, "acceleration": ZERO}
        return {name: known[name] for name in given.quantities}
    (R, x), (w, v) = flow.poses[seat.part], flow.velocities[seat.part]
    back = transposed(R)
    found: dict[str, Vector] = {
        "position": plus(x, times(back, r)),
        "velocity": times(back, plus(v, cross(w, r))),
    }
    if "acceleration" in given.quantities:
        u, udot = speeds
        moved = motion(flow.placed, u, work)
        alpha, a = accelerated(tree, flow.placed, moved, udot, work)[seat.part]
        turning = plus(cross(alpha, r), moved[seat.part].square.times(r))
        found["acceleration"] = plus(times(back, plus(a, turning)), tree.gravity)
    return {name: found[name] for name in given.quantities}
