"""The kinds of joints as a table: coordinates, speeds, place, motion subspace, kinematic map.

A joint leads from a frame P on the parent to a frame F on the child. Its coordinates give the position r
of the origin of F (in P) and the rotation ``C_FP``; its speeds u give the angular velocity of F in P and
the velocity of its origin, S u, both in the axes of F. The accelerations are S u' + S' u, where S' u, the
drift, is taken component by component in F. Featherstone, Rigid Body Dynamics Algorithms (2008), table 4.1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import sympy as sp

from eom.kinematics import coordinates as kinematics
from eom.kinematics.frames import vector
from eom.multibody.algebra.scalars import Scalar, Work, add, is_zero, mul, negative, reciprocal, sub
from eom.multibody.algebra.spatial import (
    IDENTITY,
    ZERO,
    General,
    Rotation,
    SpatialVector,
    Turn,
    Vector,
    back,
    cross,
    forward,
    keep_matrix,
    scaled,
)

QUATERNION = "quaternion"
COLUMNS = (*(SpatialVector(e, ZERO) for e in IDENTITY), *(SpatialVector(ZERO, e) for e in IDENTITY))
"""The six unit motions."""


class Letter(NamedTuple):
    """The letter of a coordinate or speed before the joint's name, what follows it, unit, meaning."""

    letter: str
    suffix: str
    unit: str
    meaning: str


class Setting(NamedTuple):
    """What a joint says of its kind: axes in P (the second after the first turn), pitch, attitude."""

    name: str
    axes: tuple[Vector, ...]
    pitch: Scalar
    attitude: str


class Relative(NamedTuple):
    """Where F is in P: position of its origin (components in P), rotations, the columns of S.

    ``trigonometry``: sine and cosine of each angle among the coordinates.
    """

    position: Vector
    rotation: Rotation
    subspace: tuple[SpatialVector, ...]
    trigonometry: tuple[tuple[Scalar, Scalar], ...] = ()


def no_drift(subspace: Sequence[SpatialVector], u: Sequence[Scalar]) -> SpatialVector:  # noqa: ARG001
    """Return the drift of a constant S."""
    return SpatialVector(ZERO, ZERO)


def same_rates(
    setting: Setting,  # noqa: ARG001
    q: Sequence[Scalar],  # noqa: ARG001
    u: Sequence[Scalar],
    place: Relative,  # noqa: ARG001
) -> list[Scalar]:
    """Return q' = u."""
    return list(u)


@dataclass(frozen=True)
class Kind:
    """One row of the table.

    ``coordinates``, ``speeds``: given the attitude. ``place(setting, q, work)``. ``rates(setting, q, u,
    place)``: q'; ``from_rates(setting, q, q', place)``: u, of angles, not of quaternions. ``axes``: how
    many the joint names. ``spins``: F turns about the one axis of S last, so that the body of revolution
    about that axis is the same in axes that do not turn.
    """

    name: str
    coordinates: Callable[[str], tuple[Letter, ...]]
    speeds: Callable[[str], tuple[Letter, ...]]
    place: Callable[[Setting, Sequence[Scalar], Work], Relative]
    rates: Callable[[Setting, Sequence[Scalar], Sequence[Scalar], Relative], list[Scalar]] = (
        same_rates
    )
    from_rates: Callable[[Setting, Sequence[Scalar], Sequence[Scalar], Relative], list[Scalar]] = (
        same_rates
    )
    drift: Callable[[Sequence[SpatialVector], Sequence[Scalar]], SpatialVector] = no_drift
    axes: int = 0
    pitch: bool = False
    attitude: bool = False
    spins: bool = False
    paired: Callable[[str], tuple[int | None, ...]] = lambda _: ()
    """For each speed the coordinate of which it is the rate, or None: there springs can be."""


def always(*letters: Letter) -> Callable[[str], tuple[Letter, ...]]:
    """Return the letters for every attitude."""
    return lambda _: letters


def turn(work: Work, name: str, axis: Vector, s: Scalar, c: Scalar) -> Turn | General:
    """Return the turn about a unit vector, which is the same in both frames.

    Euler's theorem: C = c 1 + (1 - c) a a^T - s tilde(a) (Hughes, sect. 2.2).
    """
    for k in range(3):
        others = [axis[n] for n in range(3) if n != k]
        if all(map(is_zero, others)):
            return Turn(k, s, c) if axis[k] == 1 else Turn(k, negative(s), c)
    x, y, z = axis
    tilde = [[0, negative(z), y], [z, 0, negative(x)], [negative(y), x, 0]]
    rest = work.keep("place", name, "", sub(1, c))

    def entry(i: int, j: int) -> Scalar:
        diagonal = c if i == j else 0
        return sub(add(diagonal, mul(rest, mul(axis[i], axis[j]))), mul(s, tilde[i][j]))

    C = [[entry(i, j) for j in range(3)] for i in range(3)]
    return General(keep_matrix(work, "place", name, C))


def _angle(work: Work, name: str, q: Scalar, suffix: str = "") -> tuple[Scalar, Scalar]:
    return (
        work.keep("s", name, suffix, work.sin(q)),
        work.keep("c", name, suffix, work.cos(q)),
    )


def _fixed(setting: Setting, q: Sequence[Scalar], work: Work) -> Relative:  # noqa: ARG001
    return Relative(ZERO, (), ())


def _revolute(setting: Setting, q: Sequence[Scalar], work: Work) -> Relative:
    (axis,) = setting.axes
    trig = _angle(work, setting.name, q[0])
    return Relative(
        ZERO, (turn(work, setting.name, axis, *trig),), (SpatialVector(axis, ZERO),), (trig,)
    )


def _prismatic(setting: Setting, q: Sequence[Scalar], work: Work) -> Relative:  # noqa: ARG001
    (axis,) = setting.axes
    return Relative(scaled(q[0], axis), (), (SpatialVector(ZERO, axis),))


def _cylindrical(setting: Setting, q: Sequence[Scalar], work: Work) -> Relative:
    (axis,) = setting.axes
    trig = _angle(work, setting.name, q[0])
    columns = (SpatialVector(axis, ZERO), SpatialVector(ZERO, axis))
    return Relative(scaled(q[1], axis), (turn(work, setting.name, axis, *trig),), columns, (trig,))


def _helical(setting: Setting, q: Sequence[Scalar], work: Work) -> Relative:
    (axis,) = setting.axes
    trig = _angle(work, setting.name, q[0])
    column = SpatialVector(axis, scaled(setting.pitch, axis))
    return Relative(
        scaled(mul(setting.pitch, q[0]), axis),
        (turn(work, setting.name, axis, *trig),),
        (column,),
        (trig,),
    )


def _universal(setting: Setting, q: Sequence[Scalar], work: Work) -> Relative:
    first, second = setting.axes
    trig = tuple(_angle(work, setting.name, angle, str(k + 1)) for k, angle in enumerate(q))
    turns = tuple(
        turn(work, setting.name, axis, *t) for axis, t in zip(setting.axes, trig, strict=True)
    )
    columns = (SpatialVector(turns[1].forward(first), ZERO), SpatialVector(second, ZERO))
    return Relative(ZERO, turns, columns, trig)


def _universal_drift(subspace: Sequence[SpatialVector], u: Sequence[Scalar]) -> SpatialVector:
    """Return u1 times the rate of the first column, C e1 by the second turn: u2 (C e1) x e2."""
    first, second = (column.angular for column in subspace)
    return SpatialVector(scaled(mul(u[0], u[1]), cross(first, second)), ZERO)


def _planar(setting: Setting, q: Sequence[Scalar], work: Work) -> Relative:
    s, c = _angle(work, setting.name, q[2])
    columns = (COLUMNS[3], COLUMNS[4], COLUMNS[2])
    return Relative((q[0], q[1], 0), (Turn(2, s, c),), columns, ((s, c),))


def _planar_rates(
    setting: Setting,  # noqa: ARG001
    q: Sequence[Scalar],  # noqa: ARG001
    u: Sequence[Scalar],
    place: Relative,
) -> list[Scalar]:
    x, y, _ = back(place.rotation, (u[0], u[1], 0))
    return [x, y, u[2]]


def _planar_from_rates(
    setting: Setting,  # noqa: ARG001
    q: Sequence[Scalar],  # noqa: ARG001
    rates: Sequence[Scalar],
    place: Relative,
) -> list[Scalar]:
    x, y, _ = forward(place.rotation, (rates[0], rates[1], 0))
    return [x, y, rates[2]]


def _attitude(
    setting: Setting, q: Sequence[Scalar], work: Work
) -> tuple[Rotation, tuple[tuple[Scalar, Scalar], ...]]:
    """Return the rotations of attitude coordinates, with sines and cosines of angles."""
    if setting.attitude == QUATERNION:
        known = dict(zip(_quaternion().symbols, q, strict=True))
        entries = [value(e, known) for e in _quaternion().matrix]
        C = [entries[0:3], entries[3:6], entries[6:9]]
        return (General(keep_matrix(work, "place", setting.name, C)),), ()
    trig = tuple(_angle(work, setting.name, angle, str(k + 1)) for k, angle in enumerate(q))
    axes = kinematics.rotation_sequence(setting.attitude).axes
    return tuple(Turn(axis - 1, s, c) for axis, (s, c) in zip(axes, trig, strict=True)), trig


def _attitude_rates(
    attitude: str, q: Sequence[Scalar], omega: Sequence[Scalar], place: Relative
) -> list[Scalar]:
    known: dict[Any, Scalar] = dict(zip(_OMEGA, omega, strict=True))
    if attitude == QUATERNION:
        known |= dict(zip(_quaternion().symbols, q, strict=True))
    else:
        known |= _turns(attitude, place)
    return [value(rate, known) for rate in _rates(attitude)]


def _turns(attitude: str, place: Relative) -> dict[Any, Scalar]:
    """Return sines and cosines by those of the angles of a sequence."""
    found: dict[Any, Scalar] = {}
    for angle, (s, c) in zip(_sequence(attitude).angles, place.trigonometry, strict=True):
        found |= {sp.sin(angle): s, sp.cos(angle): c}
    return found


def _angular_velocity(attitude: str, rates: Sequence[Scalar], place: Relative) -> list[Scalar]:
    """Return the angular velocity over the rates of angles, by `eom.kinematics.coordinates`."""
    known = {**_turns(attitude, place), **dict(zip(_OMEGA, rates, strict=True))}
    return [value(w, known) for w in _sequence(attitude).angular_velocity(_OMEGA).components]


_OMEGA = tuple(sp.Symbol(f"omega{k}", real=True) for k in (1, 2, 3))


@lru_cache
def _quaternion() -> kinematics.UnitQuaternion:
    return kinematics.quaternion()


@lru_cache
def _sequence(name: str) -> kinematics.RotationSequence:
    return kinematics.rotation_sequence(name)


@lru_cache
def _rates(attitude: str) -> tuple[Any, ...]:
    """Return the rates of attitude coordinates over `_OMEGA`, by `eom.kinematics.coordinates`."""
    chosen = _quaternion() if attitude == QUATERNION else _sequence(attitude)
    return tuple(chosen.rates(vector("F", _OMEGA)))


def value(expression: Any, known: dict[Any, Scalar]) -> Scalar:
    """Return a rational expression over scalars of any kind for its ``known`` parts."""
    if expression in known:
        return known[expression]
    if expression.is_Integer:
        return int(expression)
    if expression.is_Rational:
        return Fraction(int(expression.p), int(expression.q))
    parts = [value(a, known) for a in expression.args]
    if expression.is_Pow:
        power = int(expression.exp)
        result: Scalar = parts[0]
        for _ in range(abs(power) - 1):
            result = mul(result, parts[0])
        return reciprocal(result) if power < 0 else result
    combine = add if expression.is_Add else mul
    result = parts[0]
    for part in parts[1:]:
        result = combine(result, part)
    return result


def _spherical(setting: Setting, q: Sequence[Scalar], work: Work) -> Relative:
    rotation, trig = _attitude(setting, q, work)
    return Relative(ZERO, rotation, COLUMNS[:3], trig)


def _spherical_rates(
    setting: Setting, q: Sequence[Scalar], u: Sequence[Scalar], place: Relative
) -> list[Scalar]:
    return _attitude_rates(setting.attitude, q, u, place)


def _spherical_from_rates(
    setting: Setting,
    q: Sequence[Scalar],  # noqa: ARG001
    rates: Sequence[Scalar],
    place: Relative,
) -> list[Scalar]:
    return _angular_velocity(setting.attitude, rates, place)


def _free(setting: Setting, q: Sequence[Scalar], work: Work) -> Relative:
    rotation, trig = _attitude(setting, q[3:], work)
    return Relative(q[:3], rotation, COLUMNS, trig)


def _free_rates(
    setting: Setting, q: Sequence[Scalar], u: Sequence[Scalar], place: Relative
) -> list[Scalar]:
    velocity = back(place.rotation, u[3:])
    return [*velocity, *_attitude_rates(setting.attitude, q[3:], u[:3], place)]


def _free_from_rates(
    setting: Setting,
    q: Sequence[Scalar],  # noqa: ARG001
    rates: Sequence[Scalar],
    place: Relative,
) -> list[Scalar]:
    velocity = forward(place.rotation, (rates[0], rates[1], rates[2]))
    return [*_angular_velocity(setting.attitude, rates[3:], place), *velocity]


def _attitude_letters(attitude: str) -> tuple[Letter, ...]:
    if attitude == QUATERNION:
        parts = ("scalar", "first", "second", "third")
        return tuple(
            Letter("e", str(k), "1", f"{part} part of the unit quaternion")
            for k, part in enumerate(parts)
        )
    return tuple(
        Letter("q", str(k + 1), "rad", f"{place} angle of the {attitude} sequence")
        for k, place in enumerate(("first", "second", "third"))
    )


_SPEEDS = tuple(
    Letter("w", str(k), "rad/s", f"angular velocity, component {k} in the child's axes")
    for k in (1, 2, 3)
)
_VELOCITIES = tuple(
    Letter("v", str(k), "m/s", f"velocity of the origin, component {k} in the child's axes")
    for k in (1, 2, 3)
)
_POSITIONS = tuple(
    Letter(x, "", "m", f"position of the origin along axis {k} of the parent's frame")
    for k, x in enumerate("xyz", 1)
)
_ANGLE = Letter("q", "", "rad", "angle")
_RATE = Letter("u", "", "rad/s", "rate of the angle")
_SLIDE = Letter("q", "", "m", "displacement")
_SPEED = Letter("u", "", "m/s", "rate of the displacement")


ALONE = {f"e{k}": f"q{k}" for k in range(4)} | {f"w{k}": f"omega_{k}" for k in (1, 2, 3)}
ALONE |= {"q1": "psi", "q2": "theta", "q3": "phi"}
"""Names of attitude and angular velocity of a body by itself (`eom.kinematics`), by letter and suffix."""


SEQUENCE_TO: dict[int | None, str] = {0: "3-2-1", 1: "3-1-2", 2: "3-1-3", None: "3-2-1"}
"""Angles by the axis, from 0, that is turned about last."""


def _numbered(letter: Letter, *suffixes: str) -> tuple[Letter, ...]:
    return tuple(letter._replace(suffix=s) for s in suffixes)


KINDS: dict[str, Kind] = {
    kind.name: kind
    for kind in (
        Kind("fixed", always(), always(), _fixed),
        Kind("revolute", always(_ANGLE), always(_RATE), _revolute,
             axes=1, spins=True, paired=lambda _: (0,)),
        Kind("prismatic", always(_SLIDE), always(_SPEED), _prismatic,
             axes=1, paired=lambda _: (0,)),
        Kind("cylindrical",
             always(_ANGLE._replace(suffix="1"), _SLIDE._replace(suffix="2")),
             always(_RATE._replace(suffix="1"), _SPEED._replace(suffix="2")),
             _cylindrical, axes=1, spins=True, paired=lambda _: (0, 1)),
        Kind("helical", always(_ANGLE), always(_RATE), _helical,
             axes=1, pitch=True, spins=True, paired=lambda _: (0,)),
        Kind("universal", always(*_numbered(_ANGLE, "1", "2")), always(*_numbered(_RATE, "1", "2")),
             _universal, drift=_universal_drift, axes=2, paired=lambda _: (0, 1)),
        Kind("planar", always(*_POSITIONS[:2], _ANGLE), always(*_VELOCITIES[:2], _RATE),
             _planar, rates=_planar_rates, from_rates=_planar_from_rates, paired=lambda _: (None, None, 2)),
        Kind("spherical", _attitude_letters, always(*_SPEEDS), _spherical, rates=_spherical_rates,
             from_rates=_spherical_from_rates, attitude=True, paired=lambda _: (None,) * 3),
        Kind("free", lambda attitude: (*_POSITIONS, *_attitude_letters(attitude)),
             always(*_SPEEDS, *_VELOCITIES), _free, rates=_free_rates,
             from_rates=_free_from_rates, attitude=True, paired=lambda _: (None,) * 6),
    )
}  # fmt: skip
"""All kinds by name."""
