"""Special motions of one rigid body in small numbers, as exact worlds: where general claims fail.

A body is six masses on its principal axes with given moments of inertia; it turns with an angular
velocity that is given, or that follows from Euler's equations without torque (Hughes, Spacecraft
Attitude Dynamics, 1986, ch. 4). Forces on the masses follow from Newton's second law, so the torque of
every motion is what that motion needs. Units are any that fit together.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from eom.exact import series
from eom.exact.series import LENGTH, Matrix, Series, Vector
from eom.fields import RATIONALS
from eom.worlds.turning import Turned
from eom.worlds.worlds import World

Numbers = tuple[int, int, int]

BODIES: dict[str, tuple[Numbers, tuple[str, ...]]] = {
    "three different principal moments": ((2, 3, 4), ()),
    "other principal moments": ((9, 5, 6), ()),
    "an axis of inertial symmetry, prolate": ((3, 3, 2), ("symmetric",)),
    "an axis of inertial symmetry, oblate": ((3, 3, 4), ("symmetric",)),
    "a spherical body": ((2, 2, 2), ("symmetric",)),
    "a plane body": ((1, 2, 3), ()),
    "a thin rod": ((1, 1, 0), ("thin_rod",)),
}
"""Principal moments of inertia, and assumptions that hold for them."""

WHOLE: dict[str, tuple[Numbers, tuple[str, ...]]] = {
    "three different principal moments, of whole masses": ((6, 8, 10), ()),
}
"""A body for examples alone: its six masses are whole numbers."""

ORDINARY_FIRST = ("three different principal moments", "other principal moments")
ORDINARY = frozenset({*ORDINARY_FIRST, *WHOLE})
"""Bodies of no special shape."""

RATES: tuple[Numbers, ...] = (
    (0, 0, 0),
    (1, 0, 0),
    (0, 1, 0),
    (0, 0, 1),
    (1, 1, 0),
    (0, 1, 1),
    (1, 2, 3),
)
"""Components of omega at t = 0: at rest, about a principal axis, in a principal plane, any other."""

FREE, STEADY, DRIVEN, GROWING = "no torque", "constant rates", "rates that change", "speeding up"

TURNED = ((3, 4, 0), (-4, 3, 0), (0, 0, 5))
"""Five times the axes of a frame that is not that of the principal axes."""

CENTRE = frozenset({"O_fixed_in_body", "about_centre"})
POINTS: dict[str, frozenset[str]] = {
    "O is C, which rests": CENTRE | {"O_fixed_in_space", "O_at_origin", "C_at_rest"},
    "O is C, which accelerates": CENTRE,
    "O is fixed in space, C moves": frozenset({"O_fixed_in_space"}),
    "O is a pivot, fixed in the body and in space": frozenset(
        {"O_fixed_in_body", "O_fixed_in_space", "O_at_origin"}
    ),
    "O moves": frozenset(),
}
"""Where the reference point is, and which assumptions that fulfils."""

FIRST_CASES = 24
"""So many of the first ones have the centre of mass at rest as reference point."""

ALWAYS = frozenset(
    {"constant_mass", "newton_2", "third_law_weak", "third_law_strong", "rigid", "body_frame"}
)
"""What holds in all of these worlds."""


@dataclass(frozen=True)
class Special:
    """A world with what is assumed in it, its case in words, and its data by the names of quantities.

    ``degenerate``: a body of special shape, or one at rest, of which a writer may not have thought.
    """

    world: World
    assumed: frozenset[str]
    words: str
    data: tuple[tuple[str, str], ...]
    degenerate: bool = False


def specials() -> Iterator[Special]:
    """Yield all special motions, the simplest first; each is made once."""
    return (_special(*case) for case in _cases())


def revealing(names: frozenset[str]) -> Iterator[Special]:
    """Yield motions in which some assumptions hold and little vanishes: those that reveal most first."""
    for case in _revealing():
        _, assumed = _assumed(*case)
        if names <= assumed:
            yield _special(*case)


Case = tuple[str, Numbers, str, str, bool]
"""Body, rates at t = 0, kind of motion, reference point, whether B is turned from the principal axes."""


@cache
def _cases() -> tuple[Case, ...]:
    return tuple(_all())


def _all() -> Iterator[Case]:
    rest, *others = POINTS
    first, *bodies = BODIES
    for body in (first, *bodies):
        for rates in RATES:
            for kind in _KINDS if body == first else (FREE, STEADY):
                if _possible(body, rates, kind):
                    yield body, rates, kind, rest, False
    for where in others:
        for kind in _KINDS:
            yield first, RATES[-1], kind, where, False
    for rates in RATES[1:5]:
        for kind in (FREE, STEADY):
            yield first, rates, kind, rest, True


@cache
def _revealing() -> tuple[Case, ...]:
    """Return cases in which all rates differ, with all reference points: in principal axes first."""
    first, *others = (*ORDINARY_FIRST, *WHOLE, *(b for b in BODIES if "symmetry" in b))
    cases = [(body, DRIVEN, turned) for turned in (False, True) for body in (first, *WHOLE)]
    cases += [(b, kind, False) for kind in (FREE, STEADY) for b in (first, *others)]
    return tuple(
        (body, RATES[-1], kind, where, turned) for body, kind, turned in cases for where in POINTS
    )


def _possible(body: str, rates: Numbers, kind: str) -> bool:
    """Return whether a motion differs from others and is determined: a free rod is not."""
    rod = not all(BODIES[body][0])
    return not (kind == FREE and rod) and not (kind in {STEADY, GROWING} and not any(rates))


@cache
def _special(body: str, rates: Numbers, kind: str, where: str, turned: bool) -> Special:
    moments, _ = {**BODIES, **WHOLE}[body]
    omega, assumed = _assumed(body, rates, kind, where, turned)
    world = _world(moments, omega, where, turned)
    words = f"{body}, {kind}, {where}" + (", axes not principal" if turned else "")
    degenerate = body not in ORDINARY or not any(rates)
    return Special(world, assumed, words, _data(world), degenerate)


@cache
def _assumed(
    body: str, rates: Numbers, kind: str, where: str, turned: bool
) -> tuple[Vector, frozenset[str]]:
    """Return the angular velocity of a motion, and the assumptions that hold in it."""
    moments, more = {**BODIES, **WHOLE}[body]
    omega = _KINDS[kind](moments, rates)
    free = not any(c for s in _torque(moments, omega) for c in s.coefficients)
    assumed = ALWAYS | POINTS[where]
    if not turned:
        assumed |= {"thin_rod"} if "thin_rod" in more else {"principal_axes", *more}
    if free:
        assumed |= {"torque_free"}
    return omega, frozenset(assumed)


# -- rates ----------------------------------------------------------------------------------------


def _constant(values: tuple[Any, ...]) -> Vector:
    x, y, z = (series.constant(RATIONALS, RATIONALS.of(v), LENGTH) for v in values)
    return (x, y, z)


def _steady(_: Numbers, rates: Numbers) -> Vector:
    return _constant(rates)


def _linear(rates: Numbers, growth: Numbers) -> Vector:
    time = Series(RATIONALS, (0, RATIONALS.of(1), *(0,) * (LENGTH - 2)))
    return series.add(_constant(rates), series.scale(time, _constant(growth)))


def _driven(_: Numbers, rates: Numbers) -> Vector:
    return _linear(rates, (2, -1, 1))


def _growing(_: Numbers, rates: Numbers) -> Vector:
    """Return rates that grow in proportion: the axis stays."""
    return _linear(rates, rates)


def _free(moments: Numbers, rates: Numbers) -> Vector:
    """Return the rates without torque, order by order: I_1 omega_1' = (I_2 - I_3) omega_2 omega_3."""
    found = [[RATIONALS.of(r)] for r in rates]
    for n in range(LENGTH - 1):
        new = []
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            product = sum(found[i][m] * found[j][n - m] for m in range(n + 1))
            new.append((moments[i] - moments[j]) * product * RATIONALS.of(1, moments[k] * (n + 1)))
        for row, value in zip(found, new, strict=True):
            row.append(value)
    x, y, z = (Series(RATIONALS, tuple(row)) for row in found)
    return (x, y, z)


_KINDS: dict[str, Callable[[Numbers, Numbers], Vector]] = {
    FREE: _free,
    STEADY: _steady,
    GROWING: _growing,
    DRIVEN: _driven,
}


def _torque(moments: Numbers, omega: Vector) -> Vector:
    """Return the torque about the centre of mass that a motion needs, in principal axes."""
    H = _momentum(moments, omega)
    x, y, z = (s.derivative() for s in H)
    return series.add((x, y, z), series.cross(omega, H))


def _momentum(moments: Numbers, omega: Vector) -> Vector:
    x, y, z = (s.scaled(RATIONALS.of(m)) for m, s in zip(moments, omega, strict=True))
    return (x, y, z)


# -- worlds ---------------------------------------------------------------------------------------


def _world(moments: Numbers, omega: Vector, where: str, turned: bool) -> World:
    masses, arms = _masses(moments)
    principal = _attitude(omega)
    frame = _turned_frame() if turned else None
    attitude = principal.matrix if frame is None else series.product(frame, principal.matrix)
    path, offset = _path(where)
    to_I = series.transpose(principal.matrix)
    pivot = series.apply(to_I, _constant((1, 0, 2)))
    origin = _constant((0, 0, 0))
    centre = series.subtract(origin, pivot) if "pivot" in where else path
    places = tuple(series.add(centre, series.apply(to_I, arm)) for arm in arms)
    points = {"C": centre, "O": centre if offset is None else offset, "OI": origin}
    forces = tuple(_needed(m, p) for m, p in zip(masses, places, strict=True))
    return World(
        RATIONALS,
        0,
        {"I": _identity(), "B": attitude},
        points,
        masses,
        places,
        forces,
        tuple(tuple(origin for _ in places) for _ in places),
        {},
        turns={} if frame is not None else {("B", "I"): principal},
    )


def _masses(moments: Numbers) -> tuple[tuple[Series, ...], tuple[Vector, ...]]:
    """Return masses at unit distance on both sides of each axis; those that are zero are left out."""
    half = sum(moments)
    found = []
    for k in range(3):
        mass = RATIONALS.of(half - 2 * moments[k], 4)
        if mass:
            for side in (1, -1):
                arm = _constant(tuple(side * int(k == j) for j in range(3)))
                found.append((series.constant(RATIONALS, mass, LENGTH), arm))
    masses, arms = zip(*found, strict=True)
    return masses, arms


def _path(where: str) -> tuple[Vector, Vector | None]:
    """Return the path of the centre of mass, and that of O if it is another point."""
    moving = tuple(
        Series(RATIONALS, tuple(RATIONALS.of(c) for c in row))
        for row in ((1, 2, 1, 0, 0), (0, 1, -1, 1, 0), (2, 0, 3, 0, 0))
    )
    path = (moving[0], moving[1], moving[2])
    fixed = _constant((1, 1, 0))
    other = series.add(fixed, (moving[1], moving[2], moving[0]))
    return {
        "O is C, which rests": (_constant((0, 0, 0)), None),
        "O is C, which accelerates": (path, None),
        "O is fixed in space, C moves": (path, fixed),
        "O is a pivot, fixed in the body and in space": (path, _constant((0, 0, 0))),
        "O moves": (path, other),
    }[where]


def _needed(mass: Series, place: Vector) -> Vector:
    """Return the force by Newton's second law."""
    x, y, z = (mass * s.derivative().derivative() for s in place)
    return (x, y, z)


def _identity() -> Matrix:
    return tuple(_constant(tuple(int(i == j) for j in range(3))) for i in range(3))


def _turned_frame() -> Matrix:
    return tuple(_constant(tuple(RATIONALS.of(c, 5) for c in row)) for row in TURNED)


def _attitude(omega: Vector) -> Turned:
    """Return the rotation from I to the principal axes by its quaternion: q' = q omega / 2, q(0) = 1.

    Hamilton's product, components of omega in the turning frame (Hughes, 1986, sec. 2.3).
    """
    q = [[RATIONALS.of(1)], [0], [0], [0]]
    w = [s.coefficients for s in omega]
    for n in range(LENGTH - 1):
        rates = [RATIONALS.of(0)] * 4
        for m in range(n + 1):
            a, b, c, d = (row[m] for row in q)
            x, y, z = (row[n - m] for row in w)
            step = (
                -b * x - c * y - d * z,
                a * x + c * z - d * y,
                a * y + d * x - b * z,
                a * z + b * y - c * x,
            )
            rates = [r + s for r, s in zip(rates, step, strict=True)]
        for row, rate in zip(q, rates, strict=True):
            row.append(rate * RATIONALS.of(1, 2 * (n + 1)))
    a, b, c, d = (Series(RATIONALS, tuple(row)) for row in q)
    return Turned(_passive(a, (b, c, d)), (a, b, c, d))


def _passive(a: Series, v: Vector) -> Matrix:
    """Return (a^2 - v.v) 1 + 2 v v^T - 2 a skew(v) (Hughes, 1986, sect. 2.2)."""
    skew = series.skew(v)
    lead = a * a - series.dot(v, v)

    def entry(i: int, j: int) -> Series:
        value = (v[i] * v[j] - a * skew[i][j]).scaled(2)
        return value + lead if i == j else value

    return tuple(tuple(entry(i, j) for j in range(3)) for i in range(3))


# -- in words -------------------------------------------------------------------------------------

NAMES = {"inertia": "I_C", "rates": r"\omega", "growth": r"\dot\omega", "torque": "M_C"}
"""LaTeX of the data of a special motion, all in the body frame at t = 0."""


def _data(world: World) -> tuple[tuple[str, str], ...]:
    """Return inertia, rates, their derivatives and torque about C at t = 0, components in B."""
    B = world.rotation("B", "I")
    centre = world.points["C"]
    arms = [series.apply(B, series.subtract(p, centre)) for p in world.places]
    forces = [series.apply(B, f) for f in world.forces]
    turns = [series.cross(a, f) for a, f in zip(arms, forces, strict=True)]
    omega = series.angular_velocity(B)
    growth = tuple(s.coefficients[1] for s in omega)
    inertia = [[_second(world, arms, i, j) for j in range(3)] for i in range(3)]
    torque = tuple(sum(t[k].coefficients[0] for t in turns) for k in range(3))
    diagonal = not any(inertia[i][j] for i in range(3) for j in range(3) if i != j)
    written = _row(tuple(inertia[k][k] for k in range(3))) if diagonal else _matrix(inertia)
    return (
        (NAMES["inertia"], rf"\mathrm{{diag}}{written}" if diagonal else written),
        (NAMES["rates"], _row(tuple(s.coefficients[0] for s in omega))),
        (NAMES["growth"], _row(growth)),
        (NAMES["torque"], _row(torque)),
    )


def _second(world: World, arms: list[Vector], i: int, j: int) -> Any:
    found = 0
    for mass, arm in zip(world.masses, arms, strict=True):
        x = [s.coefficients[0] for s in arm]
        own = sum(c * c for c in x) if i == j else 0
        found += mass.coefficients[0] * (own - x[i] * x[j])
    return found


def _row(values: tuple[Any, ...]) -> str:
    return "(" + ", ".join(str(v) for v in values) + ")"


def _matrix(rows: list[list[Any]]) -> str:
    inside = r" \\ ".join(" & ".join(str(v) for v in row) for row in rows)
    return rf"\begin{{bmatrix}} {inside} \end{{bmatrix}}"
