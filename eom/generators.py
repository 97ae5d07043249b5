"""Draw random worlds: places of masses, motions and forces, restricted by named assumptions.

Several generators serve each assumption, so that no accidental symmetry of one of them passes for a
law. A motion that has to obey a condition on forces (no torque about an axis) is found coefficient
by coefficient from that condition alone, evaluated on the masses.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from eom import series
from eom.series import PRIME, Field, Matrix, Series, Singular, Vector
from eom.worlds import LENGTH, Rotor, World, closure

Point = tuple[Any, Any, Any]
Weighted = tuple[Any, Point]
"""A mass with its place in a frame that is fixed in the body."""
Turns = dict[str, Matrix]
Angles = dict[str, tuple[Series, Series, Series]]


@dataclass(frozen=True)
class Draw:
    """Random numbers of one world."""

    field: Field
    generator: random.Random
    positive: bool = False

    def number(self) -> Any:
        """Return a number that is not zero."""
        return self.field.draw(self.generator)

    def mass(self) -> Any:
        """Return a mass; its sign matters where numbers have one."""
        return abs(self.number()) if not self.field.prime else self.number()

    def point(self) -> Point:
        """Return three numbers."""
        return (self.number(), self.number(), self.number())

    def series(self) -> Series:
        """Return a random series."""
        return Series(self.field, tuple(self.number() for _ in range(LENGTH)))

    def vector(self) -> Vector:
        """Return a random vector that changes with time."""
        return (self.series(), self.series(), self.series())

    def fixed(self, point: Point) -> Vector:
        """Return three numbers as series that do not change."""
        x, y, z = (series.constant(self.field, c, LENGTH) for c in point)
        return (x, y, z)

    def rotation(self) -> Matrix:
        """Return a rotation that changes with time."""
        return series.cayley(self.vector())

    def fixed_rotation(self) -> Matrix:
        """Return a constant rotation."""
        return series.cayley(self.fixed(self.point()))

    def choose(self, *options: Callable[[Draw], list[Weighted]]) -> list[Weighted]:
        """Return what one of several generators draws."""
        return self.generator.choice(options)(self)


# -- shapes: weighted points in the body -------------------------------------------------------


def _any_body(draw: Draw) -> list[Weighted]:
    return [(draw.mass(), draw.point()) for _ in range(draw.generator.randint(4, 6))]


def _thin_rod(draw: Draw) -> list[Weighted]:
    direction, start = draw.point(), draw.point()
    return [
        (draw.mass(), _along(draw.field, start, direction, draw.number()))
        for _ in range(draw.generator.randint(2, 4))
    ]


def _along(field: Field, start: Point, direction: Point, length: Any) -> Point:
    x, y, z = (field.reduce(a + length * b) for a, b in zip(start, direction, strict=True))
    return (x, y, z)


def _moved(field: Field, bodies: Sequence[Weighted], shift: Point) -> list[Weighted]:
    return [(m, _along(field, p, shift, 1)) for m, p in bodies]


def _mirrored(field: Field, bodies: Sequence[Weighted]) -> list[Weighted]:
    """Add the point opposite each point: the centre of mass is then at the origin."""
    x = [(m, (field.reduce(-p[0]), field.reduce(-p[1]), field.reduce(-p[2]))) for m, p in bodies]
    return [*bodies, *x]


def _axis_pairs(draw: Draw) -> list[Weighted]:
    pairs = []
    for axis in range(3):
        a = draw.number()
        pairs.append((draw.mass(), tuple(a if k == axis else 0 for k in range(3))))
    return _moved(draw.field, _mirrored(draw.field, pairs), draw.point())  # type: ignore[arg-type]


def _products_cancelled(draw: Draw) -> list[Weighted]:
    """Random mirrored points, and a pair in each coordinate plane that cancels one product."""
    field = draw.field
    bodies = _mirrored(field, [(draw.mass(), draw.point()) for _ in range(2)])
    for i, j in ((0, 1), (0, 2), (1, 2)):
        product = sum(m * p[i] * p[j] for m, p in bodies)
        mass, a = draw.mass(), draw.number()
        b = field.reduce(-product * field.inverse(2 * mass * a))
        point = tuple({i: a, j: b}.get(k, 0) for k in range(3))
        bodies = [*bodies, *_mirrored(field, [(mass, point)])]  # type: ignore[list-item]
    return _moved(field, bodies, draw.point())


def _quarter_turns(draw: Draw, axis: int) -> list[Weighted]:
    """Four copies of random points, a quarter turn apart about ``axis`` (0, 1, 2)."""
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    bodies = []
    for _ in range(2):
        mass, point = draw.mass(), draw.point()
        for _ in range(4):
            turned = list(point)
            turned[i], turned[j] = draw.field.reduce(-point[j]), point[i]
            point = (turned[0], turned[1], turned[2])
            bodies.append((mass, point))
    return _moved(draw.field, bodies, draw.point())


def _equal_moments(draw: Draw, axis: int) -> list[Weighted]:
    """A body with principal axes, and a pair of masses that makes two moments equal."""
    field = draw.field
    bodies = _mirrored(field, _centred_axis_pairs(draw))
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    excess = sum(m * (p[i] ** 2 - p[j] ** 2) for m, p in bodies)
    a = draw.number()
    mass = field.reduce(excess * field.inverse(2 * a * a))
    point = tuple(a if k == j else 0 for k in range(3))
    bodies = [*bodies, *_mirrored(field, [(mass, point)])]  # type: ignore[list-item]
    return _moved(field, bodies, draw.point())


def _centred_axis_pairs(draw: Draw) -> list[Weighted]:
    result: list[Weighted] = []
    for axis in range(3):
        a = draw.number()
        result.append((draw.mass(), tuple(a if k == axis else 0 for k in range(3))))  # type: ignore[arg-type]
    return result


def _shape(draw: Draw, assumed: frozenset[str]) -> list[Weighted]:
    """Return a body for the assumptions on its inertia."""
    if "spin_312" in assumed:
        return draw.choose(lambda d: _quarter_turns(d, 1), lambda d: _equal_moments(d, 1))
    if "symmetric" in assumed:
        return draw.choose(lambda d: _quarter_turns(d, 2), lambda d: _equal_moments(d, 2))
    if "principal_axes" in assumed:
        return draw.choose(_axis_pairs, _products_cancelled)
    return _thin_rod(draw) if "thin_rod" in assumed else _any_body(draw)


# -- motions -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Body:
    """Weighted points that are fixed in a frame, with the frame's rotation C_BI."""

    points: tuple[Weighted, ...]
    attitude: Matrix

    def centre(self, field: Field) -> Point:
        """Return the centre of mass, in the frame."""
        scale = field.inverse(sum(m for m, _ in self.points))
        x, y, z = (field.reduce(scale * sum(m * p[k] for m, p in self.points)) for k in range(3))
        return (x, y, z)

    def carried(self, draw: Draw, point: Point) -> Vector:
        """Return a point of the frame from the frame's origin, in I."""
        return series.apply(series.transpose(self.attitude), draw.fixed(point))

    def torque_about_centre(self, draw: Draw) -> Vector:
        """Return the sum of r x m r'' about the centre of mass, from the masses alone."""
        centre = self.centre(draw.field)
        total: list[Vector] = []
        for m, p in self.points:
            r = self.carried(draw, _along(draw.field, p, centre, -1))
            second = tuple(s.derivative().derivative().scaled(m) for s in r)
            total.append(series.cross(r, (second[0], second[1], second[2])))
        return tuple(series.total([t[k] for t in total]) for k in range(3))  # type: ignore[return-value]


def _solve_motion(
    draw: Draw,
    unknown: Sequence[Series],
    residual: Callable[[Sequence[Series]], Sequence[Series]],
) -> list[Series]:
    """Find the coefficients from the third on that make ``residual`` vanish, order by order.

    Coefficient n of a residual is affine in the coefficients n + 2 of the unknowns, because forces
    are linear in accelerations.
    """
    current = list(unknown)
    for n in range(LENGTH - 2):
        current = _next_coefficients(draw.field, current, residual, n)
    return current


def _next_coefficients(
    field: Field,
    current: list[Series],
    residual: Callable[[Sequence[Series]], Sequence[Series]],
    order: int,
) -> list[Series]:
    """Solve for the coefficients ``order + 2`` by trying zero and each unit."""

    def trial(values: Sequence[Any]) -> list[Series]:
        return [_with(s, order + 2, v) for s, v in zip(current, values, strict=True)]

    def at(values: Sequence[Any]) -> list[Any]:
        return [r.coefficients[order] for r in residual(trial(values))]

    n = len(current)
    base = at([0] * n)
    columns = [at([int(k == j) for k in range(n)]) for j in range(n)]
    matrix = [[field.reduce(columns[j][i] - base[i]) for j in range(n)] for i in range(n)]
    return trial(series.solve(matrix, [field.reduce(-b) for b in base], field))


def _with(s: Series, place: int, value: Any) -> Series:
    c = s.coefficients
    return Series(s.field, (*c[:place], value, *c[place + 1 :]))


def _free_attitude(draw: Draw, points: tuple[Weighted, ...]) -> Matrix:
    """Return a rotation under which the masses need no torque."""

    def residual(gibbs: Sequence[Series]) -> Sequence[Series]:
        x, y, z = gibbs
        return Body(points, series.cayley((x, y, z))).torque_about_centre(draw)

    x, y, z = _solve_motion(draw, draw.vector(), residual)
    return series.cayley((x, y, z))


_TURNS_312 = (("A", "I", 2, "psi"), ("B", "A", 0, "theta"), ("C", "B", 1, "phi"))
"""Frame, the one before, axis (from 0), angle."""


def _elementary(axis: int, sine: Series, cosine: Series) -> Matrix:
    """Return the passive rotation about one axis."""
    one, zero = cosine.scaled(0), cosine.scaled(0)
    one = Series(one.field, (1, *one.coefficients[1:]))
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    rows = [[zero, zero, zero] for _ in range(3)]
    rows[axis][axis] = one
    rows[i][i] = rows[j][j] = cosine
    rows[i][j], rows[j][i] = sine, -sine
    return tuple(tuple(row) for row in rows)


def _sequence(draw: Draw, motion: Sequence[Series], start: Sequence[Any]) -> tuple[Turns, Angles]:
    """Return the frames and angles of the 3-1-2 sequence; ``start``: tangents of half the angles."""
    frames: Turns = {}
    angles: Angles = {}
    previous: Matrix | None = None
    for (frame, _, axis, name), angle, tau in zip(_TURNS_312, motion, start, strict=True):
        scale = draw.field.inverse(1 + tau * tau)
        sine, cosine = series.sine_cosine(
            angle, draw.field.reduce(2 * tau * scale), draw.field.reduce((1 - tau * tau) * scale)
        )
        turn = _elementary(axis, sine, cosine)
        previous = turn if previous is None else series.product(turn, previous)
        frames[frame] = previous
        angles[name] = (angle, sine, cosine)
    return frames, angles


def _spin_312(
    draw: Draw, points: tuple[Weighted, ...], assumed: frozenset[str]
) -> tuple[Turns, Angles]:
    """Return frames and angles; those that a missing torque determines are solved for."""
    motion = [draw.series() for _ in _TURNS_312]
    start = [draw.number() for _ in _TURNS_312]
    wanted = [(2, 1)] * ("no_torque_2" in assumed) + [(0, 2)] * ("no_torque_3" in assumed)

    def residual(values: Sequence[Series]) -> Sequence[Series]:
        trial = list(motion)
        for (place, _), value in zip(wanted, values, strict=True):
            trial[place] = value
        frames, _ = _sequence(draw, trial, start)
        torque = Body(points, frames["C"]).torque_about_centre(draw)
        in_B = series.apply(frames["B"], torque)
        return [in_B[axis] for _, axis in wanted]

    solved = _solve_motion(draw, [motion[place] for place, _ in wanted], residual)
    for (place, _), value in zip(wanted, solved, strict=True):
        motion[place] = value
    return _sequence(draw, motion, start)


# -- worlds ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Stage:
    """What forces and reference points are added to: masses and places, frames and angles."""

    masses: tuple[Series, ...]
    places: tuple[Vector, ...]
    frames: Turns
    angles: Angles
    points: dict[str, Vector]
    rotors: tuple[Rotor, ...] = ()


def _particles(draw: Draw, assumed: frozenset[str]) -> Stage:
    """Masses that move at will."""
    n = 1 if "one_particle" in assumed else draw.generator.randint(2, 5)
    if "constant_mass" in assumed:
        masses = tuple(series.constant(draw.field, draw.mass(), LENGTH) for _ in range(n))
    else:
        masses = tuple(draw.series() for _ in range(n))
    places = tuple(draw.vector() for _ in range(n))
    frames = {name: draw.rotation() for name in ("A", "B")}
    return Stage(masses, places, frames, {}, _reference_points(draw, assumed, masses, places))


def _centre(masses: Sequence[Series], places: Sequence[Vector]) -> Vector:
    scale = series.total(list(masses)).reciprocal()
    x, y, z = (
        series.total([m * p[k] for m, p in zip(masses, places, strict=True)]) * scale
        for k in range(3)
    )
    return (x, y, z)


def _reference_points(
    draw: Draw, assumed: frozenset[str], masses: Sequence[Series], places: Sequence[Vector]
) -> dict[str, Vector]:
    """Points for particles that move at will."""
    centre = _centre(masses, places)
    reference = draw.vector()
    if "O_fixed_in_space" in assumed:
        reference = draw.fixed(draw.point())
    if "O_at_origin" in assumed:
        reference = draw.fixed((0, 0, 0))
    if "about_centre" in assumed:
        reference = centre
    return {"O": reference, "C": centre}


def _rigid(draw: Draw, assumed: frozenset[str]) -> Stage:
    """One rigid body; its frame is B, or C for the 3-1-2 sequence, or unknown."""
    points = tuple(_shape(draw, assumed))
    frames: Turns = {"A": draw.rotation(), "B": draw.rotation()}
    angles: Angles = {}
    if "spin_312" in assumed:
        frames, angles = _spin_312(draw, points, assumed)
        body = Body(points, frames["C"])
    elif "torque_free" in assumed:
        body = Body(points, _free_attitude(draw, points))
    else:
        body = Body(points, draw.rotation())
    if "body_frame" in assumed:
        frames["B"] = body.attitude
    if "A_fixed_in_body" in assumed:
        frames["A"] = series.product(draw.fixed_rotation(), body.attitude)
    return _placed(draw, assumed, body, frames, angles)


def _placed(
    draw: Draw, assumed: frozenset[str], body: Body, frames: Turns, angles: Angles
) -> Stage:
    """Let one point of the body move along a path, and carry the others with it."""
    centre = body.centre(draw.field)
    about_centre = "about_centre" in assumed
    pivot = centre if about_centre else draw.point()
    body_fixed = about_centre or "O_fixed_in_body" in assumed
    still = draw.fixed((0, 0, 0)) if "O_at_origin" in assumed else draw.fixed(draw.point())
    anchor, path = draw.point(), draw.vector()
    if "C_at_rest" in assumed:
        anchor, path = centre, draw.fixed(draw.point())
    if body_fixed and "O_fixed_in_space" in assumed:
        anchor, path = pivot, still

    def carried(point: Point) -> Vector:
        return series.add(path, body.carried(draw, _along(draw.field, point, anchor, -1)))

    reference = draw.vector()
    if "O_fixed_in_space" in assumed:
        reference = still
    if body_fixed:
        reference = carried(pivot)
    points = {"O": reference, "C": carried(centre)}
    points |= {name: carried(draw.point()) for name in ("OA", "OB")}
    masses = tuple(series.constant(draw.field, m, LENGTH) for m, _ in body.points)
    return Stage(masses, tuple(carried(p) for _, p in body.points), frames, angles, points)


def _with_rotors(draw: Draw, assumed: frozenset[str]) -> Stage:
    """A carrier that is fixed in B, and rotors of four or eight masses each."""
    B = draw.rotation()
    weighted = [(m, draw.fixed(p)) for m, p in _any_body(draw)]
    rotors = []
    for _ in range(draw.generator.randint(1, 3)):
        base, centre = draw.fixed_rotation(), draw.fixed(draw.point())
        angle, tau = draw.series(), draw.number()
        scale = draw.field.inverse(1 + tau * tau)
        turn = _elementary(2, *series.sine_cosine(angle, 2 * tau * scale, (1 - tau * tau) * scale))
        to_B = series.transpose(series.product(turn, base))
        ring = _ring(draw)
        weighted += [(m, series.add(centre, series.apply(to_B, draw.fixed(p)))) for m, p in ring]
        inertia = draw.field.reduce(sum(m * (p[0] ** 2 + p[1] ** 2) for m, p in ring))
        rotors.append(Rotor((base[2][0], base[2][1], base[2][2]), inertia, angle))
    path = draw.vector()
    to_I = series.transpose(B)
    places = tuple(series.add(path, series.apply(to_I, p)) for _, p in weighted)
    masses = tuple(series.constant(draw.field, m, LENGTH) for m, _ in weighted)
    points = _reference_points(draw, assumed, masses, places)
    return Stage(masses, places, {"A": draw.rotation(), "B": B}, {}, points, tuple(rotors))


def _ring(draw: Draw) -> list[Weighted]:
    """Four masses a quarter turn apart about axis 3, twice."""
    bodies: list[Weighted] = []
    for _ in range(2):
        mass, (x, y, z) = draw.mass(), draw.point()
        bodies += [(mass, p) for p in ((x, y, z), (-y, x, z), (-x, -y, z), (y, -x, z))]
    return bodies


def _internal_forces(
    draw: Draw, assumed: frozenset[str], places: Sequence[Vector]
) -> tuple[tuple[Vector, ...], ...]:
    """Return the force on i by j, as far as the third law restricts it."""
    n = len(places)
    nought = draw.fixed((0, 0, 0))
    table = [[nought for _ in range(n)] for _ in range(n)]
    for i in range(n):
        for j in range(i):
            if "third_law_strong" in assumed:
                force = series.scale(draw.series(), series.subtract(places[i], places[j]))
            else:
                force = draw.vector()
            opposite = (-force[0], -force[1], -force[2])
            table[i][j] = force
            table[j][i] = opposite if "third_law_weak" in assumed else draw.vector()
    return tuple(tuple(row) for row in table)


def _external_forces(
    draw: Draw, assumed: frozenset[str], stage: Stage, internal: Sequence[Sequence[Vector]]
) -> tuple[Vector, ...]:
    """Return m r'' less the internal forces, or anything where the second law is not assumed."""
    if "newton_2" not in assumed:
        return tuple(draw.vector() for _ in stage.places)
    forces = []
    for mass, place, row in zip(stage.masses, stage.places, internal, strict=True):
        needed = [mass * s.derivative().derivative() for s in place]
        x, y, z = (needed[k] - series.total([f[k] for f in row]) for k in range(3))
        forces.append((x, y, z))
    return tuple(forces)


@lru_cache(maxsize=512)
def world(assumptions: frozenset[str], seed: int, prime: int = PRIME) -> World:
    """Return the world of a seed; a singular draw is repeated with the next one.

    Raises `InputError` for assumptions that are unknown or cannot stand together.
    """
    assumed = closure(assumptions)
    for attempt in range(100):
        text = f"{sorted(assumed)} {seed} {attempt}"
        draw = Draw(Field(prime), random.Random(text))  # noqa: S311 - reproducible, no secret
        try:
            return _build(draw, assumed, seed)
        except Singular:
            continue
    raise AssertionError("no regular world in 100 draws")


def _build(draw: Draw, assumed: frozenset[str], seed: int) -> World:
    make = _particles
    if "rigid" in assumed:
        make = _rigid
    if "rotors" in assumed:
        make = _with_rotors
    stage = make(draw, assumed)
    internal = _internal_forces(draw, assumed, stage.places)
    origin = draw.fixed((0, 0, 0))
    identity = tuple(draw.fixed(tuple(int(i == j) for j in range(3))) for i in range(3))  # type: ignore[arg-type]
    return World(
        draw.field,
        seed,
        {"I": identity, **stage.frames},
        {"OI": origin, **stage.points},
        stage.masses,
        stage.places,
        _external_forces(draw, assumed, stage, internal),
        internal,
        stage.angles,
        stage.rotors,
    )


def worlds(assumptions: Iterable[str], count: int, prime: int = PRIME) -> Iterator[World]:
    """Yield ``count`` independent worlds under ``assumptions``."""
    assumed = closure(assumptions)
    return (world(assumed, seed, prime) for seed in range(count))
