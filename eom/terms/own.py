"""What a derivation defines of its own: frames, points, bodies and laws, beside the vocabulary."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from eom.terms.terms import Equation, Term, add, cross, der, dot, expr, mul, number, outer, zero
from eom.terms.vocabulary import ORIGIN, omega, position, quantity, unit, velocity


@dataclass(frozen=True)
class OwnFrame:
    """A frame that is turned from ``base`` about its axis ``axis`` (1, 2, 3) through ``angle`` (rad)."""

    base: str
    axis: int
    angle: Any

    @property
    def rate(self) -> Term:
        """The angular velocity against ``base``."""
        return mul(der(expr(self.angle)), unit(self.base, self.axis))


@dataclass(frozen=True)
class OwnBody:
    """A rigid body by its ``name``, which is its centre of mass, too.

    ``mass``; ``frame`` that is fixed in it and has its principal axes, ``moments`` about these; both are
    empty of a point mass.
    """

    name: str
    mass: Term
    frame: str = ""
    moments: tuple[Term, ...] = ()

    @property
    def inertia(self) -> Term:
        """The inertia dyadic about the centre of mass."""
        axes = (unit(self.frame, k) for k in (1, 2, 3))
        parts = [mul(J, outer(e, e)) for J, e in zip(self.moments, axes, strict=False)]
        return add(*parts) if parts else zero("dyadic")

    @property
    def spin(self) -> Term:
        """The angular momentum about the centre of mass."""
        return dot(self.inertia, omega(self.frame)) if self.moments else zero("vector")

    @property
    def energy_of_spin(self) -> Term:
        """The kinetic energy of the rotation."""
        return number(1, 2) * dot(omega(self.frame), self.spin) if self.moments else zero("scalar")

    def momentum_about(self, point: str, speed: Term) -> Term:
        """Return the angular momentum about a point.

        Parameters
        ----------
        point : str
            Its name.
        speed : Term
            The velocity of the centre of mass.

        Returns
        -------
        Term
            In N m s.
        """
        if point == self.name:
            return self.spin
        return add(cross(position(self.name, point), mul(self.mass, speed)), self.spin)


Meaning = Callable[..., Term]
OF_BODIES: dict[str, Meaning] = {
    "mass": lambda b: b.mass,
    "linear_momentum": lambda b: mul(b.mass, velocity(b.name)),
    "angular_momentum": lambda b, o: b.momentum_about(o, der(position(b.name, o))),
    "absolute_angular_momentum": lambda b, o: b.momentum_about(o, velocity(b.name)),
    "kinetic_energy": lambda b: add(
        number(1, 2) * b.mass * dot(velocity(b.name), velocity(b.name)), b.energy_of_spin
    ),
    "weight": lambda b: mul(b.mass, quantity("gravity")),
    "weight_torque": lambda b, o: cross(position(b.name, o), b.mass * quantity("gravity")),
    "weight_energy": lambda b, o: -mul(b.mass, dot(quantity("gravity"), position(b.name, o))),
}
"""What quantities of the vocabulary are of a body of one's own, by its name and a point.

Those of a rigid body are by the motion of its centre of mass and the rotation about it, as the
derivations "rigid-body-momentum" and "kinetic-energy" show for any body.
"""


@dataclass(frozen=True)
class Law:
    """An ``equation`` that motions are to obey, and the ``unknowns``: coordinates by which they do."""

    equation: Equation
    unknowns: tuple[Any, ...]


@dataclass
class Own:
    """What a derivation has of its own.

    ``frames`` by name; ``points`` by name, with their positions from the inertial origin; ``bodies`` by
    the names of their centres; ``laws``; ``configured``: names of the coordinates of which the places of
    all particles are functions.
    """

    frames: dict[str, OwnFrame] = field(default_factory=dict)
    points: dict[str, Term] = field(default_factory=dict)
    bodies: dict[str, OwnBody] = field(default_factory=dict)
    laws: list[Law] = field(default_factory=list)
    configured: tuple[str, ...] = ()

    def copy(self) -> Own:
        """Return the same, apart."""
        parts = dict(self.frames), dict(self.points), dict(self.bodies), list(self.laws)
        return Own(*parts, self.configured)

    def __bool__(self) -> bool:
        return bool(self.frames or self.points or self.laws or self.configured)

    def turns(self, frame: str) -> Iterator[tuple[Any, Term]]:
        """Return, one by one, the turns by which a frame is reached from its ground.

        Parameters
        ----------
        frame : str
            Its name.

        Returns
        -------
        iterator of tuples
            Angle (rad) and axis of each.
        """
        while frame in self.frames:
            row = self.frames[frame]
            yield row.angle, unit(row.base, row.axis)
            frame = row.base

    def ground(self, frame: str) -> str:
        """Return the frame, not of these, from which a frame is turned.

        Parameters
        ----------
        frame : str
            Its name.

        Returns
        -------
        str
            Its name, such as ``I``.
        """
        while frame in self.frames:
            frame = self.frames[frame].base
        return frame

    def turning(self, frame: str) -> Term:
        """Return the angular velocity of a frame against its ground.

        Parameters
        ----------
        frame : str
            Its name.

        Returns
        -------
        Term
            One term a turn (rad/s).
        """
        parts = [mul(der(expr(angle)), axis) for angle, axis in self.turns(frame)]
        return add(*parts) if parts else zero("vector")

    def place(self, point: str) -> Term | None:
        """Return the position of a point from the inertial origin.

        Parameters
        ----------
        point : str
            Its name.

        Returns
        -------
        Term
            None for one that is none of these.
        """
        return zero("vector") if point == ORIGIN else self.points.get(point)

    def meaning(self, term: Term) -> Term | None:
        """Return what a quantity is of what is defined here, None for all else.

        Parameters
        ----------
        term : Term
            The place of a point, the angular velocity of a frame against the one that it is turned
            from, or a quantity of a body.

        Returns
        -------
        Term
            What it is of what is defined here; None for all else.
        """
        if term.head != "atom":
            return None
        name, *labels = term.data
        if name == "position":
            return self.points.get(labels[0]) if labels[1] == ORIGIN else None
        if name == "angular_velocity":
            frame = self.frames.get(labels[0])
            return None if frame is None or frame.base != labels[1] else frame.rate
        body = self.bodies.get(labels[0]) if name in OF_BODIES else None
        return None if body is None else OF_BODIES[name](body, *labels[1:])
