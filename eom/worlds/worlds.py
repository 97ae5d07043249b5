"""Exact random worlds, in which a statement of mechanics is true or false.

A world is a finite set of point masses with random data from an exact field; their motion is a
truncated power series in time, so that derivatives are exact. Frames turn by random rotations,
angular velocity is read off them, internal forces obey the third law as far as it is assumed, and
external forces follow from Newton's second law. Nothing that is to be proved is built in.

A false statement of degree d holds in one world modulo a 61-bit prime with a chance of at most
d / 2**61 (Schwartz and Zippel). What holds for every finite set of masses and is linear in sums over
them holds for a continuum, whose integrals are limits of such sums.

Gravity of a distant centre on a body, from the law of inverse squares, to second order in its size.

With R the distance of the centre of mass C, u the unit vector from the attracting centre to C and p a
place from C, powers of the distance are R^2 + 2 R u.p + p.p raised to a half, expanded by the binomial
series in p / R. Nothing is known here of moments of inertia.

Values of attitude coordinates in a world: angles of turns, principal axes, Euler parameters.
"""

from __future__ import annotations

import dataclasses
import operator
import random
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, reduce
from itertools import product
from typing import Any

from eom.errors import InputError, unknown_name
from eom.exact import series
from eom.exact.series import LENGTH, Matrix, Series, Vector
from eom.fields import Field
from eom.worlds.turning import (
    Angle,
    Quaternion,
    Turned,
    about_axis,
    angle,
    composed,
    in_turn,
    reversed_,
    turned,
)

SLOPE = "|"
"""What parts the name of a function from the coordinates by which it is differentiated."""
DEGREE = 3
"""Degree of functions at most, and how many powers of one coordinate they have."""


def _named_angle(world: World, name: str) -> Angle:
    if name not in world.angles:
        raise unknown_name("angle", name, world.angles, "worlds without a rotation sequence")
    return world.angles[name]


def _free_angle(world: World, name: str) -> Angle:
    generator = world.free("angle", name)
    value = Series(world.field, tuple(world.field.draw(generator) for _ in range(LENGTH)))
    return angle(value, world.field.draw(generator))


def _principal_angle(world: World, frame: str, base: str) -> Angle:
    found = world.turn(frame, base).angle
    if found is None:
        raise InputError("this rotation was not drawn by its axis", got=f"from {base} to {frame}")
    return found


def axes_of(axes: str) -> str:
    """Return the axes of turns in the order about moving ones: of "space123" they are "321"."""
    digits = axes.removeprefix("space").removeprefix("body")
    return digits[::-1] if axes.startswith("space") else digits


def sequence_of(axes: str) -> str:
    """Return the assumption of worlds by which the angles of a sequence exist."""
    return f"sequence_{axes_of(axes)}"


def _turn_angle(world: World, place: str, axes: str, frame: str, base: str) -> Angle:
    """Return an angle of a sequence; turns about fixed axes are those about moving ones backwards."""
    fixed = axes.startswith("space")
    turns = world.turn(frame, base).turns
    count = len(axes_of(axes))
    if not turns or world.axes != axes_of(axes) or place not in ("1", "2", "3")[:count]:
        got = f"angle {place} of {axes} from {base} to {frame}"
        raise InputError("there is no such angle beside the others", got=got)
    return turns[count - int(place) if fixed else int(place) - 1]


ANGLES: dict[str, Callable[..., Angle]] = {
    "angle": _named_angle,
    "free_angle": _free_angle,
    "principal_angle": _principal_angle,
    "turn_angle": _turn_angle,
}
"""Quantities that are angles."""


def _any_angle(world: World, kind: str, name: str) -> Angle:
    quarter = world.field.draw(world.free("quarter", kind, name))
    return angle(world.primitive(kind, (name,)), quarter)


TURNING: dict[str, Callable[..., Angle]] = {
    **ANGLES,
    "scalar": lambda world, name: _any_angle(world, "scalar", name),
    "coordinate": lambda world, name: _any_angle(world, "coordinate", name),
}
"""Quantities that have a sine and a cosine, those that may be angles among them."""


def _in_inertial(world: World, frame: str, parts: Sequence[Series]) -> Vector:
    return series.apply(world.rotation("I", frame), (parts[0], parts[1], parts[2]))


def _principal_axis(world: World, frame: str, base: str) -> Vector:
    axis = world.turn(frame, base).axis
    if axis is None:
        raise InputError("this rotation was not drawn by its axis", got=f"from {base} to {frame}")
    return _in_inertial(world, frame, axis)


def _parameters(below: Callable[[Quaternion], Series]) -> Callable[[World, str, str], Vector]:
    """Return the vector part of the Euler parameters over a divisor."""

    def vector(world: World, frame: str, base: str) -> Vector:
        q = world.turn(frame, base).quaternion
        scale = below(q).reciprocal()
        return _in_inertial(world, frame, series.scale(scale, (q[1], q[2], q[3])))

    return vector


def _one(q: Quaternion) -> Series:
    return series.constant(q[0].field, 1, len(q[0].coefficients))


ANGLE_PRIMITIVES: Mapping[str, Callable[..., Any]] = {
    **{kind: lambda w, *labels, kind=kind: w.angle(kind, *labels).value for kind in ANGLES},
    "principal_axis": _principal_axis,
    "euler_parameter": lambda w, k, frame, base: w.turn(frame, base).quaternion[int(k)],
    "euler_vector": _parameters(_one),
    "rodrigues": _parameters(lambda q: q[0]),
    "modified_rodrigues": _parameters(lambda q: _one(q) + q[0]),
    "shadow_rodrigues": _parameters(lambda q: q[0] - _one(q)),
}
"""Quantities without a definition in terms of others."""


def _any_series(world: World, name: str) -> Series:
    generator = world.free("gravity", name)
    draws = tuple(world.field.draw(generator) for _ in range(LENGTH))
    first = draws[0] if world.field.prime else abs(draws[0])
    return Series(world.field, (first, *draws[1:]))


def _direction(world: World) -> Vector:
    """Return a unit vector that turns at will: the third axis of a frame after two turns."""
    generator = world.free("gravity", "quarters")
    angles = [
        angle(_any_series(world, f"angle {k}"), world.field.draw(generator)) for k in range(2)
    ]
    row = in_turn(turned(k, a) for k, a in enumerate(angles)).matrix[2]
    return (row[0], row[1], row[2])


def _parameter(world: World) -> Series:
    return world.constant(_any_series(world, "parameter").coefficients[0])


def _radius(world: World) -> Series:
    return _any_series(world, "radius")


def _parts(world: World) -> list[tuple[Series, Vector, Series, Series]]:
    """Return of each mass: itself, its place p from C, 2 u.p / R and p.p / R^2."""
    direction = world.primitive("orbit_direction", ())
    nearness = world.primitive("orbit_radius", ()).reciprocal()
    found = []
    for mass, place in zip(world.masses, world.places, strict=True):
        p = series.subtract(place, world.place("C"))
        first = (series.dot(direction, p) * nearness).scaled(2)
        found.append((mass, p, first, series.dot(p, p) * nearness * nearness))
    return found


def _power(exponent: Fraction, first: Series, second: Series) -> tuple[Series, Series]:
    """Return the terms of first and second order of (1 + first + second) to a power."""
    field = first.field
    once = field.of(exponent.numerator, exponent.denominator)
    half = exponent * (exponent - 1) / 2
    twice = field.of(half.numerator, half.denominator)
    return first.scaled(once), second.scaled(once) + (first * first).scaled(twice)


def _torque(world: World) -> Vector:
    """Return the sum of p x f about C: f is -mu m (R u + p) / |R u + p|^3, and p x p vanishes."""
    direction = world.primitive("orbit_direction", ())
    parts = []
    for mass, p, first, second in _parts(world):
        change, _ = _power(Fraction(-3, 2), first, second)
        parts.append(series.scale(mass * (world.constant(1) + change), series.cross(p, direction)))
    near = world.primitive("orbit_radius", ()).reciprocal()
    factor = -(world.primitive("gravity_parameter", ()) * near * near)
    x, y, z = (series.total([p[k] for p in parts]) for k in range(3))
    return series.scale(factor, (x, y, z))


def _energy(world: World) -> Series:
    """Return the sum of -mu m / |R u + p|."""
    parts = []
    for mass, _, first, second in _parts(world):
        one, two = _power(Fraction(-1, 2), first, second)
        parts.append(mass * (world.constant(1) + one + two))
    near = world.primitive("orbit_radius", ()).reciprocal()
    whole: Series = world.primitive("gravity_parameter", ()) * near * series.total(parts)
    return -whole


PRIMITIVES: Mapping[str, Callable[..., Any]] = {
    "gravity_parameter": _parameter,
    "orbit_radius": _radius,
    "orbit_direction": _direction,
    "gravity_torque": _torque,
    "gravity_energy": _energy,
}
"""Quantities of a body near a distant attracting centre."""


SEQUENCES: dict[str, str] = {
    f"sequence_{axes}": axes
    for axes in "1 2 3 12 13 21 23 31 32 121 123 131 132 212 213 231 232 312 313 321 323".split()
}
"""Assumptions that say by which turns B is reached, with their axes; fewer than three: special motions."""


FREE_FRAME = re.compile("[D-HJ-Z][0-9]*")
"""Names of frames that nothing else in a world depends on."""
FREE_POINT = re.compile("free[A-Za-z0-9]*|open")
"""Names of points that nothing else depends on; one is the body whose mass changes."""
FIXED_POINT = re.compile("in([A-Z][0-9]*?)([0-9])")
"""Names of points that are fixed in a frame, as inA1; those of B move with the body."""

OPEN = "open"
"""The label of a body, apart from all others, whose mass changes."""

GENERAL, SPECIAL = "general", "special"
"""Kinds of assumptions: what a text takes for granted or states once; a special body, load or motion."""

MOMENT = "moment "
"""What stands before the number of an axis in the name of the moment of inertia about it."""


@dataclass(frozen=True)
class Restriction:
    """What an assumption says, and which others it needs or cannot stand with.

    ``kind``: `GENERAL` or `SPECIAL`; ``joins``: labels of what coincides by it, which nobody means who
    names all of them: points, frames ("frame A"), moments of inertia about axes ("moment 1").
    """

    meaning: str
    needs: tuple[str, ...] = ()
    excludes: tuple[str, ...] = ()
    kind: str = GENERAL
    joins: tuple[str, ...] = ()


ASSUMPTIONS: dict[str, Restriction] = {
    "one_particle": Restriction("there is one point mass, P", (), ("rigid", "rotors")),
    "constant_mass": Restriction("each mass is constant"),
    "newton_2": Restriction("Newton's second law holds in the inertial frame I"),
    "third_law_weak": Restriction(
        "Newton's third law: the force of j on i is minus that of i on j"
    ),
    "third_law_strong": Restriction(
        "strong third law: internal forces are opposite and act along the line between the masses",
        ("third_law_weak",),
    ),
    "rigid": Restriction(
        "the distance of any two points of the body is constant", ("constant_mass",)
    ),
    "body_frame": Restriction("the frame B is fixed in the body", ("rigid",), ("spin_312",)),
    "about_centre": Restriction("the reference point O is the centre of mass C", joins=("O", "C")),
    "O_fixed_in_body": Restriction("the reference point O is fixed in the body", ("rigid",)),
    "O_fixed_in_space": Restriction("the reference point O is inertially fixed", kind=SPECIAL),
    "O_uniform": Restriction(
        "the reference point O moves uniformly",
        (),
        ("about_centre", "C_at_rest", "O_fixed_in_space"),
        kind=SPECIAL,
    ),
    "O_at_origin": Restriction(
        "the reference point O is the origin of the inertial frame",
        ("O_fixed_in_space",),
        kind=SPECIAL,
        joins=("O", "OI"),
    ),
    "C_at_rest": Restriction("the centre of mass is at rest", kind=SPECIAL),
    "principal_axes": Restriction(
        "b1, b2, b3 are principal axes at the centre of mass", ("body_frame",)
    ),
    "principal_at_O": Restriction(
        "b1, b2, b3 are principal axes at the reference point O, too, which is fixed in the body",
        ("O_fixed_in_body",),
        ("thin_rod",),
    ),
    "symmetric": Restriction(
        "b3 is an axis of inertial symmetry: I1 = I2",
        ("principal_axes",),
        kind=SPECIAL,
        joins=("moment 1", "moment 2"),
    ),
    "symmetric_1": Restriction(
        "b1 is an axis of inertial symmetry: I2 = I3",
        ("principal_axes",),
        ("symmetric", "spin_312"),
        kind=SPECIAL,
        joins=("moment 2", "moment 3"),
    ),
    "symmetric_2": Restriction(
        "b2 is an axis of inertial symmetry: I3 = I1",
        ("principal_axes",),
        ("symmetric", "symmetric_1", "spin_312"),
        kind=SPECIAL,
        joins=("moment 1", "moment 3"),
    ),
    "torque_free": Restriction(
        "the resultant torque about the centre of mass is zero",
        ("body_frame", "newton_2", "third_law_strong", "constant_mass"),
        kind=SPECIAL,
    ),
    "unit_eigenvectors": Restriction(
        "a matrix of eigenvectors is the rotation from principal axes: unit vectors, right-handed"
    ),
    "A_fixed_in_body": Restriction(
        "the frame A is fixed in the body, too",
        ("body_frame",),
        kind=SPECIAL,
        joins=("frame A", "frame B"),
    ),
    "OA_at_centre": Restriction(
        "the point OA of the body is its centre of mass", ("rigid",), joins=("OA", "C")
    ),
    **{
        f"{point}_fixed_in_space": Restriction(
            f"the point {point} of the body is inertially fixed",
            ("rigid",),
            ("C_at_rest", "O_fixed_in_space", "O_uniform", *others),
            kind=SPECIAL,
        )
        for point, others in (("OA", ("OA_at_centre",)), ("OB", ("OA_fixed_in_space",)))
    },
    "thin_rod": Restriction(
        "all mass lies on one line",
        ("body_frame",),
        ("principal_axes", "torque_free"),
        kind=SPECIAL,
    ),
    "plane_body": Restriction(
        "the body is a plane lamina: all mass lies in the plane of b1 and b2 through O",
        ("body_frame", "O_fixed_in_body"),
        ("thin_rod", "spin_312"),
        kind=SPECIAL,
    ),
    "fixed_axis": Restriction(
        "the axis about which B turns is constant, in B as in the inertial frame",
        (),
        ("torque_free", "spin_312", "viscous_slug", *SEQUENCES),
        kind=SPECIAL,
    ),
    "first_turn": Restriction(
        "of the turns by which B is reached the first alone goes on, through a changing angle",
        ("fixed_axis",),
        kind=SPECIAL,
    ),
    "steady_turn": Restriction(
        "the angular velocity of B is constant", ("fixed_axis",), kind=SPECIAL
    ),
    "spin_312": Restriction(
        "A, B, C follow from I by turns about axes 3, 1, 2 through psi, theta, phi; C is fixed in "
        "the body, whose axis of inertial symmetry is c2 = b2",
        ("rigid",),
        ("body_frame", "rotors"),
    ),
    "no_torque_2": Restriction(
        "the torque about b2 is zero", ("spin_312", "newton_2"), kind=SPECIAL
    ),
    "no_torque_3": Restriction(
        "the torque about b3 is zero", ("spin_312", "newton_2"), kind=SPECIAL
    ),
    "viscous_slug": Restriction(
        "a spherical slug turns in the body about the centre of mass, against a viscous torque; no "
        "torque acts from outside, and B is fixed in the body",
        ("constant_mass", "newton_2"),
        ("body_frame", "rigid", "spin_312", "rotors", "one_particle"),
    ),
    "rotors": Restriction(
        "rotors, symmetric about axes that are fixed in the body, turn in the body",
        ("constant_mass",),
        ("body_frame", "rigid"),
    ),
    "one_rotor": Restriction("there is one rotor", ("rotors",), joins=("rotors",)),
    "steady_rotors": Restriction(
        "the speed of each rotor relative to the body is constant", ("rotors",), kind=SPECIAL
    ),
    "exhaust_at_rest": Restriction(
        "what the open body takes in or loses is at rest in the inertial frame", kind=SPECIAL
    ),
    "exhaust_with_body": Restriction(
        "what the open body takes in or loses has the velocity of the body",
        excludes=("exhaust_at_rest",),
        kind=SPECIAL,
    ),
    **{
        name: Restriction(
            f"B follows from I, and from A, by turns about axes {', '.join(axes)}, each of the frame "
            "turned so far",
            (),
            (
                *("spin_312", "viscous_slug", *(() if len(axes) > 2 else ("torque_free",))),
                *(other for other in SEQUENCES if other != name),
            ),
        )
        for name, axes in SEQUENCES.items()
    },
}
"""Every assumption that a generator knows."""

TOO_MUCH = (frozenset({"C_at_rest", "O_fixed_in_body", "O_fixed_in_space"}),)
"""Sets that leave only special motions, here those about an axis through O and C."""


def closure(assumptions: Iterable[str]) -> frozenset[str]:
    """Return the assumptions with all that they need.

    Raises `InputError` for unknown ones and for those that cannot stand together.
    """
    chosen: set[str] = set()
    waiting = list(assumptions)
    while waiting:
        name = waiting.pop()
        if name not in ASSUMPTIONS:
            raise unknown_name("assumption", name, ASSUMPTIONS)
        if name not in chosen:
            chosen.add(name)
            waiting.extend(ASSUMPTIONS[name].needs)
    for together in TOO_MUCH:
        if together <= chosen and "about_centre" not in chosen:
            raise InputError(
                "no generator knows these assumptions together", got=", ".join(sorted(together))
            )
    for name in sorted(chosen):
        for other in ASSUMPTIONS[name].excludes:
            turning = {name, "first_turn"} <= chosen & {"fixed_axis", "first_turn"}
            if other in chosen and not (turning and other in SEQUENCES):
                raise InputError("assumptions cannot stand together", got=f"{name} and {other}")
    return frozenset(chosen)


@cache
def _excluded(name: str, assumed: frozenset[str]) -> bool:
    """Return whether an assumption cannot stand together with others."""
    try:
        return not closure([*assumed, name])
    except InputError:
        return True


@dataclass(frozen=True)
class Rotor:
    """Axis (in B), inertia about it, angle, and the numbers of its masses."""

    axis: Vector
    inertia: Any
    angle: Series
    members: tuple[int, ...]


@dataclass(frozen=True)
class Slug:
    """Moment of inertia, coefficient of the viscous torque, and the numbers of its masses."""

    inertia: Any
    damping: Any
    members: tuple[int, ...]


@dataclass(frozen=True)
class World:
    """Masses, places, forces, frames and points; vectors are components in I."""

    field: Field
    seed: int
    frames: Mapping[str, Matrix]
    points: Mapping[str, Vector]
    masses: tuple[Series, ...]
    places: tuple[Vector, ...]
    forces: tuple[Vector, ...]
    internal: tuple[tuple[Vector, ...], ...]
    angles: Mapping[str, Angle]
    rotors: tuple[Rotor, ...] = ()
    slug: Slug | None = None
    turns: Mapping[tuple[str, str], Turned] = dataclasses.field(default_factory=dict)
    assumed: frozenset[str] = frozenset()
    memo: dict[Any, Any] = dataclasses.field(default_factory=dict, compare=False, repr=False)
    """What has been found in this world, values of terms without symbols among it."""
    rebuild: Callable[[World], World] | None = dataclasses.field(
        default=None, compare=False, repr=False
    )
    """What puts on a world all that stands on its coordinates; None where nothing does."""

    @property
    def axes(self) -> str:
        """The axes of the sequence by which B is reached, or nothing."""
        return next((t.axes for t in self.turns.values() if t.axes), "")

    def constant(self, value: Any) -> Series:
        """Return a series that does not change."""
        return series.constant(self.field, value, LENGTH)

    def count(self, over: str) -> int:
        """Return how many terms a sum has. Raises `InputError` for rotors where there are none."""
        if over != "rotors":
            return len(self.masses)
        if not self.rotors:
            raise InputError("there are no rotors in this world", expected="the assumption rotors")
        return len(self.rotors)

    def rotor(self, k: int) -> Rotor:
        """Return a rotor. Raises `InputError` where there are none."""
        self.count("rotors")
        return self.rotors[k]

    def rotation(self, to_frame: str, from_frame: str) -> Matrix:
        """Return the matrix from components in one frame to those in another."""
        key = ("C", to_frame, from_frame)
        if key not in self.memo:
            a, b = self._frame(to_frame), self._frame(from_frame)
            self.memo[key] = series.product(a, series.transpose(b))
        result: Matrix = self.memo[key]
        return result

    def _frame(self, name: str) -> Matrix:
        return self.frames[name] if name in self.frames else self._free_frame(name).matrix

    def _free_frame(self, name: str) -> Turned:
        """Return a frame that turns as it likes. Raises `InputError` for names of no such frame."""
        other = name == "C" and _excluded("spin_312", self.assumed)
        if not other and not FREE_FRAME.fullmatch(name):
            raise unknown_name("frame", name, [*self.frames, *"DEFGHJKLMNPQRSTUVWXYZ"])
        key = ("frame", name)
        if key not in self.memo:
            self.memo[key] = about_axis([_free_angle(self, f"{name}{k}") for k in range(3)])
        result: Turned = self.memo[key]
        return result

    def turn(self, frame: str, base: str) -> Turned:
        """Return the rotation from one frame to another. Raises `InputError` for unknown frames."""
        if (frame, base) in self.turns:
            return self.turns[frame, base]
        if (base, frame) in self.turns:
            return reversed_(self.turns[base, frame])
        if base == "I":
            return self._free_frame(frame)
        if frame == "I":
            return reversed_(self._free_frame(base))
        return composed(reversed_(self.turn(base, "I")), self.turn(frame, "I"))

    def angle(self, kind: str, *labels: str) -> Angle:
        """Return an angle by its quantity and labels. Raises `InputError` where there is none."""
        key = (kind, *labels, "angle")
        if key not in self.memo:
            self.memo[key] = TURNING[kind](self, *labels)
        result: Angle = self.memo[key]
        return result

    def primitive(self, name: str, labels: Sequence[Any]) -> Any:
        """Return the value of a quantity that has no definition."""
        key = (name, *labels)
        if key not in self.memo:
            self.memo[key] = _PRIMITIVES[name](self, *labels)
        return self.memo[key]

    def place(self, label: Any) -> Vector:
        """Return the absolute position of a particle by number, or of a point by name."""
        if isinstance(label, int):
            return self.places[label]
        if label == "P":
            return self.places[0]
        return self.points[label] if label in self.points else self._free_point(str(label))

    def _free_point(self, name: str) -> Vector:
        """Return a point that moves as it likes, or one that is fixed in a frame.

        Raises `InputError` for names of no such point.
        """
        placed = FIXED_POINT.fullmatch(name)
        if placed is None and not FREE_POINT.fullmatch(name):
            raise unknown_name("point", name, self.points)
        key = ("point", name)
        if key not in self.memo:
            self.memo[key] = (
                _free_vector(self, key) if placed is None else self._fixed_point(*placed.groups())
            )
        result: Vector = self.memo[key]
        return result

    def _fixed_point(self, frame: str, number: str) -> Vector:
        """Return a point of a frame whose origin moves as it likes, of I rests, of a body moves with it."""
        generator = self.free("point", frame, number)
        x, y, z = (self.constant(self.field.draw(generator)) for _ in range(3))
        origin = self.points["OI"] if frame == "I" else _free_vector(self, ("origin", frame))
        if frame == "B" and ("body_frame" in self.assumed or "A" not in self.frames):
            origin = self.points["C"]
        return series.add(origin, series.apply(self.rotation("I", frame), (x, y, z)))

    def free(self, *name: Any) -> random.Random:
        """Return a generator for a quantity that nothing restricts."""
        return random.Random(f"{self.seed} {name}")  # noqa: S311 - reproducible, no secret


def _angular_velocity(world: World, frame: str, base: str) -> Vector:
    """Return the angular velocity of a frame in another one."""
    turning = series.angular_velocity(world.rotation(frame, base))
    return series.apply(world.rotation("I", frame), turning)


def _unit_vector(world: World, frame: str, axis: str) -> Vector:
    row = world.rotation(frame, "I")[int(axis) - 1]
    return (row[0], row[1], row[2])


def _identity(world: World) -> Matrix:
    return tuple(tuple(world.constant(int(i == j)) for j in range(3)) for i in range(3))


def _free_vector(world: World, name: Any) -> Vector:
    return _random_vector(world.field, world.free("vector", name))


def _gravity(world: World) -> Vector:
    generator = world.free("gravity", "uniform")
    x, y, z = (world.constant(world.field.draw(generator)) for _ in range(3))
    return (x, y, z)


def _function(world: World, name: str, *variables: str) -> Series:
    """Return the value of a random polynomial of coordinates ("kind name"), or of one of its slopes.

    ``name``: with the variables behind strokes by which it is differentiated.
    """
    whole, *by = name.split(SLOPE)
    values = [
        world.primitive(kind, (label,)) for kind, label in (v.split(" ", 1) for v in variables)
    ]
    generator, ring = world.free("function", whole), series.Ring(world.field, LENGTH)
    total = world.constant(0)
    for exponents in product(range(DEGREE), repeat=len(values)):
        if sum(exponents) > DEGREE:
            continue
        factor, left = world.field.draw(generator), list(exponents)
        for place in map(variables.index, by):
            factor *= left[place]
            left[place] -= 1
        if factor:
            powers = (ring.power(x, n) for x, n in zip(values, left, strict=True) if n)
            total = total + reduce(operator.mul, powers, world.constant(factor))
    return total


def _fixed_vector(world: World, name: str, frame: str) -> Vector:
    generator = world.free("fixed", name)
    x, y, z = (world.constant(world.field.draw(generator)) for _ in range(3))
    return series.apply(world.rotation("I", frame), (x, y, z))


def _spin_momentum(world: World, members: Sequence[int]) -> Vector:
    """Return the angular momentum of some masses about their own centre of mass."""
    masses = [world.masses[n] for n in members]
    return series.spin_momentum(masses, [world.places[n] for n in members])


def _slug(world: World) -> Slug:
    if world.slug is None:
        raise InputError("there is no slug in this world", expected="the assumption viscous_slug")
    return world.slug


def _eigenvectors(world: World, frame: str, principal: str) -> Matrix:
    """Return columns along the axes of a frame, exchanged and stretched unless they are unit vectors."""
    turn = world.rotation(frame, principal)
    if "unit_eigenvectors" in world.assumed:
        return turn
    generator = world.free("eigenvectors", principal)
    order = generator.sample(range(3), 3)
    scales = [world.constant(generator.choice((-3, -2, 2, 3, 5))) for _ in order]
    x, y, z = (tuple(row[n] * s for n, s in zip(order, scales, strict=True)) for row in turn)
    return (x, y, z)


def _open_mass(world: World) -> Series:
    return _random_series(world.field, world.free("mass", OPEN))


def _exhaust(world: World) -> Vector:
    """Return the velocity, relative to the open body, of what it takes in or loses."""
    if "exhaust_at_rest" in world.assumed:
        x, y, z = (-s.derivative() for s in world.place(OPEN))
        return (x, y, z)
    if "exhaust_with_body" in world.assumed:
        return (world.constant(0),) * 3
    return _free_vector(world, "exhaust")


def _open_force(world: World) -> Vector:
    """Return what acts on an open body beside the momentum of what it takes in or loses (Meshchersky)."""
    if "newton_2" not in world.assumed:
        return _free_vector(world, ("force", OPEN))
    mass, gas = _open_mass(world), _exhaust(world)
    second = (s.derivative().derivative() for s in world.place(OPEN))
    x, y, z = (mass * a - mass.derivative() * u for a, u in zip(second, gas, strict=True))
    return (x, y, z)


CONFIGURED, HELD = ("configured",), ("constraint forces",)
"""Where a world keeps the names of coordinates of which places are functions, and forces of constraints."""


def slope_of_place(world: World, n: int, *names: str) -> Vector:
    """Return the slope of the place of a mass by a coordinate, or by one after the other: any vector."""
    key = ("place_slope", n, *sorted(names))
    if key not in world.memo:
        world.memo[key] = _free_vector(world, ("slope", n, *sorted(names)))
    found: Vector = world.memo[key]
    return found


def constraint_forces(world: World) -> list[Vector]:
    """Return forces of constraints, drawn at random; of all together none does virtual work.

    What is drawn is made orthogonal, in the sum over all masses, to the slopes of the places by each
    coordinate of which the places are functions.
    """
    if HELD not in world.memo:
        count = range(len(world.masses))
        drawn = [_free_vector(world, ("constraint", n)) for n in count]
        before: list[list[Vector]] = []
        for name in world.memo.get(CONFIGURED, ()):
            slopes = [slope_of_place(world, n, name) for n in count]
            for other in before:
                slopes = _without(slopes, other)
            before.append(slopes)
            drawn = _without(drawn, slopes)
        world.memo[HELD] = drawn
    found: list[Vector] = world.memo[HELD]
    return found


def _without(vectors: Sequence[Vector], along: Sequence[Vector]) -> list[Vector]:
    """Return vectors of all masses less their part along others, in the sum over all masses."""
    square = series.total([series.dot(a, a) for a in along])
    part = series.total([series.dot(v, a) for v, a in zip(vectors, along, strict=True)])
    factor = part * square.reciprocal()
    return [
        series.subtract(v, series.scale(factor, a)) for v, a in zip(vectors, along, strict=True)
    ]


def _particle(label: Any) -> int:
    if label == "P":
        return 0
    if not str(label).isdigit():
        raise InputError("an element stands under an integral alone", got=label)
    return int(label)


_PRIMITIVES: dict[str, Callable[..., Any]] = {
    "mass": lambda w, i: _open_mass(w) if i == OPEN else w.masses[_particle(i)],
    "position": lambda w, of, origin: series.subtract(w.place(of), w.place(origin)),
    "force": lambda w, i: _open_force(w) if i == OPEN else w.forces[_particle(i)],
    "exhaust_velocity": lambda w, _: _exhaust(w),
    "internal_force": lambda w, i, j: w.internal[i][j],
    "constraint_force": lambda w, i: constraint_forces(w)[_particle(i)],
    "place_slope": lambda w, i, name: slope_of_place(w, _particle(i), name),
    "angular_velocity": _angular_velocity,
    "unit": _unit_vector,
    "identity": _identity,
    "identity_matrix": _identity,
    "rotation": lambda w, b, a: w.rotation(b, a),
    "eigenvectors": _eigenvectors,
    **ANGLE_PRIMITIVES,
    **PRIMITIVES,
    "scalar": lambda w, name: w.constant(w.field.draw(w.free("scalar", name))),
    "coordinate": lambda w, name: _random_series(w.field, w.free("coordinate", name)),
    "function": _function,
    "vector": _free_vector,
    "gravity": _gravity,
    "fixed_vector": _fixed_vector,
    "dyadic": lambda w, name: tuple(_free_vector(w, f"{name}{k}") for k in range(3)),
    "rotor_axis": lambda w, k: series.apply(w.rotation("I", "B"), w.rotor(k).axis),
    "rotor_speed": lambda w, k: w.rotor(k).angle.derivative(),
    "rotor_momentum": lambda w, k: _spin_momentum(w, w.rotor(k).members),
    "slug_momentum": lambda w: _spin_momentum(w, _slug(w).members),
    "slug_inertia": lambda w: w.constant(_slug(w).inertia),
    "slug_damping": lambda w: w.constant(_slug(w).damping),
    "rotor_inertia": lambda w, k: w.constant(w.rotor(k).inertia),
}


def _random_series(field_: Field, generator: random.Random) -> Series:
    return Series(field_, tuple(field_.draw(generator) for _ in range(LENGTH)))


def _random_vector(field_: Field, generator: random.Random) -> Vector:
    x, y, z = (_random_series(field_, generator) for _ in range(3))
    return (x, y, z)
