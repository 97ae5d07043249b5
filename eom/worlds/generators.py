"""Draw random worlds: places of masses, motions and forces, restricted by named assumptions.

Random motions of a rigid body; those that need no torque about an axis are solved for.

The condition alone is used, evaluated on the masses, coefficient by coefficient of the motion.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

from eom.exact import series
from eom.exact.series import LENGTH, Matrix, Series, Vector
from eom.fields import RESIDUES, Field, Singular, solve
from eom.worlds.shapes import (
    SYMMETRIES,
    Draw,
    Point,
    Weighted,
    along,
    any_body,
    central,
    mirrored,
    shape,
)
from eom.worlds.turning import (
    Angle,
    Build,
    Turned,
    about_axis,
    angle,
    composed,
    elementary,
    reversed_,
    sequence,
    turned,
)
from eom.worlds.worlds import SEQUENCES, Rotor, Slug, World, closure


@dataclass(frozen=True)
class Stage:
    """What forces and reference points are added to: masses and places, frames and angles.

    ``frames``: those turned from I; ``relative``: other rotations that were drawn, from the second
    frame to the first.
    """

    masses: tuple[Series, ...]
    places: tuple[Vector, ...]
    frames: Turns
    angles: Angles
    points: dict[str, Vector]
    rotors: tuple[Rotor, ...] = ()
    slug: Slug | None = None
    relative: Mapping[tuple[str, str], Turned] = field(default_factory=dict)


def _build_of(assumed: frozenset[str]) -> Build:
    """Return how the frame B turns: by a sequence that is assumed, or about any axis."""
    axes = next((a for name, a in SEQUENCES.items() if name in assumed), "")
    return sequence(axes) if axes else about_axis


def _frames(
    draw: Draw, assumed: frozenset[str], B: Turned | None = None
) -> tuple[Turns, dict[tuple[str, str], Turned]]:
    """Return the frames A and B; by a sequence, B is turned from I, and from A, by other angles.

    By turns about one axis A is turned from I so, too.
    """
    build = _build_of(assumed)
    if B is None and "fixed_axis" not in assumed and any(n in assumed for n in ABOUT_ONE_AXIS):
        return _about_one_axis(draw, build)
    still = {"fixed_axis", "first_turn"} & assumed
    if B is None and build is not about_axis and still:
        B = _first_turn(draw, assumed, build)
    B = B or (axial_turn(draw, assumed) if still else any_turn(draw, build))
    if build is about_axis:
        return {"A": any_turn(draw), "B": B}, {}
    from_A = any_turn(draw, build)
    return {"A": composed(B, reversed_(from_A)), "B": B}, {("B", "A"): from_A}


ABOUT_ONE_AXIS = frozenset(name for name, axes in SEQUENCES.items() if len(axes) == 1)


def _about_one_axis(draw: Draw, build: Build) -> tuple[Turns, dict[tuple[str, str], Turned]]:
    """Return the frame A turned from I, B from A, and so B from I by the sum of both angles."""
    field, (first, second) = draw.field, (draw.series(), draw.series())
    p, q = draw.number(), draw.number()
    both = field.reduce((p + q) * field.inverse(1 - p * q))
    A, from_A, B = (
        build([angle(value, quarter)])
        for value, quarter in ((first, p), (second, q), (first + second, both))
    )
    return {"A": A, "B": B}, {("B", "A"): from_A}


def _particles(draw: Draw, assumed: frozenset[str]) -> Stage:
    """Masses that move at will."""
    n = 1 if "one_particle" in assumed else draw.generator.randint(2, 5)
    if "constant_mass" in assumed:
        masses = tuple(series.constant(draw.field, draw.mass(), LENGTH) for _ in range(n))
    else:
        masses = tuple(draw.changing_mass() for _ in range(n))
    frames, relative = _frames(draw, assumed)
    places, points = _settled(draw, assumed, masses, [draw.vector() for _ in range(n)])
    return Stage(masses, places, frames, {}, points, relative=relative)


def _settled(
    draw: Draw, assumed: frozenset[str], masses: Sequence[Series], places: Sequence[Vector]
) -> tuple[tuple[Vector, ...], dict[str, Vector]]:
    """Return places and reference points; all is moved where the centre of mass has to rest."""
    reference, rest = _reference(draw, assumed), draw.fixed(draw.point())
    if "O_fixed_in_space" in assumed:
        reference = draw.fixed((0, 0, 0)) if "O_at_origin" in assumed else rest
    centre = series.centre(masses, places)
    pinned = "about_centre" in assumed and "O_fixed_in_space" in assumed
    if pinned or "C_at_rest" in assumed:
        goal = reference if pinned else draw.fixed(draw.point())
        shift = series.subtract(goal, centre)
        places = [series.add(p, shift) for p in places]
        centre = series.centre(masses, places)
    if "about_centre" in assumed:
        reference = centre
    return tuple(places), {"O": reference, "C": centre}


def _rigid(draw: Draw, assumed: frozenset[str]) -> Stage:
    """One rigid body; its frame is B, or C for the 3-1-2 sequence, or unknown."""
    points = tuple(shape(draw, assumed))
    angles: Angles = {}
    free = free_attitude(draw, points, _build_of(assumed)) if "torque_free" in assumed else None
    frames, relative = _frames(draw, assumed, free)
    attitude = draw.rotation()
    if "spin_312" in assumed:
        frames, angles = spin_312(draw, points, assumed)
        attitude = frames["C"].matrix
    elif "body_frame" in assumed:
        attitude = frames["B"].matrix
    if "A_fixed_in_body" in assumed:
        frames["A"] = composed(frames["B"], fixed_turn(draw))
        relative = {}
    stage = _placed(draw, assumed, Body(points, attitude), frames, angles)
    return replace(stage, relative=relative)


def _placed(
    draw: Draw, assumed: frozenset[str], body: Body, frames: Turns, angles: Angles
) -> Stage:
    """Let one point of the body move along a path, and carry the others with it."""
    centre = body.centre(draw.field)
    about_centre = "about_centre" in assumed
    pivot = centre if about_centre else _pivot(draw, assumed, centre)
    body_fixed = about_centre or "O_fixed_in_body" in assumed
    still = draw.fixed((0, 0, 0)) if "O_at_origin" in assumed else draw.fixed(draw.point())
    anchor, path = draw.point(), draw.vector()
    if body_fixed and "O_uniform" in assumed:
        anchor, path = pivot, _reference(draw, assumed)
    if "C_at_rest" in assumed:
        anchor, path = centre, draw.fixed(draw.point())
    if body_fixed and "O_fixed_in_space" in assumed:
        anchor, path = pivot, still

    marked = {n: draw.point() for n in ("OA", "OB") if f"{n}_fixed_in_space" in assumed}
    for place in marked.values():
        anchor, path = place, draw.fixed(draw.point())

    def carried(point: Point) -> Vector:
        return series.add(path, body.carried(draw, along(draw.field, point, anchor, -1)))

    reference = _reference(draw, assumed)
    if "O_fixed_in_space" in assumed:
        reference = still
    if body_fixed:
        reference = carried(pivot)
    points = {"O": reference, "C": carried(centre)}
    points |= {name: carried(marked.get(name) or draw.point()) for name in ("OA", "OB")}
    if "OA_at_centre" in assumed:
        points["OA"] = points["C"]
    masses = tuple(series.constant(draw.field, m, LENGTH) for m, _ in body.points)
    return Stage(masses, tuple(carried(p) for _, p in body.points), frames, angles, points)


def _reference(draw: Draw, assumed: frozenset[str]) -> Vector:
    """Return the path of a reference point that moves at will, or uniformly."""
    x, y, z = draw.vector()
    return (_even(x), _even(y), _even(z)) if "O_uniform" in assumed else (x, y, z)


def _pivot(draw: Draw, assumed: frozenset[str], centre: Point) -> Point:
    """Return the place of O in the body: for principal axes on one of those through the centre of mass.

    A body that has them at O alone has them at the origin of its places.
    """
    x, y, z = draw.point()
    if "principal_at_O" in assumed:
        axes = [k for name, k in SYMMETRIES.items() if name in assumed]
        axis = axes[0] if axes else draw.generator.randrange(3)
        along_axis: Point = (x * (axis == 0), x * (axis == 1), x * (axis == 2))
        central = bool(axes) or "principal_axes" in assumed
        x, y, z = along(draw.field, centre, along_axis, 1) if central else (0, 0, 0)
    return (x, y, centre[2] if "plane_body" in assumed else z)


def _with_rotors(draw: Draw, assumed: frozenset[str]) -> Stage:
    """A carrier that is fixed in B, and rotors of four or eight masses each."""
    frames, relative = _frames(draw, assumed)
    B = frames["B"].matrix
    weighted = [(m, draw.fixed(p)) for m, p in any_body(draw)]
    rotors = []
    for _ in range(1 if "one_rotor" in assumed else draw.generator.randint(1, 3)):
        base, centre = draw.fixed_rotation(), draw.fixed(draw.point())
        angle = draw.series()
        if "steady_rotors" in assumed:
            angle = _even(angle)
        cosine, sine = draw.field.circle(draw.number())
        turn = elementary(2, *series.sine_cosine(angle, sine, cosine))
        to_B = series.transpose(series.product(turn, base))
        ring = _ring(draw)
        members = tuple(range(len(weighted), len(weighted) + len(ring)))
        weighted += [(m, series.add(centre, series.apply(to_B, draw.fixed(p)))) for m, p in ring]
        inertia = draw.field.reduce(sum(m * (p[0] ** 2 + p[1] ** 2) for m, p in ring))
        rotors.append(Rotor((base[2][0], base[2][1], base[2][2]), inertia, angle, members))
    path = draw.vector()
    to_I = series.transpose(B)
    masses = tuple(series.constant(draw.field, m, LENGTH) for m, _ in weighted)
    moving = [series.add(path, series.apply(to_I, p)) for _, p in weighted]
    places, points = _settled(draw, assumed, masses, moving)
    return Stage(masses, places, frames, {}, points, tuple(rotors), relative=relative)


def _with_slug(draw: Draw, assumed: frozenset[str]) -> Stage:
    """A body, and a slug of six equal masses on three axes, both about one centre of mass."""
    body = central(draw)
    mass, a = draw.mass(), draw.number()
    slug = mirrored(draw.field, [(mass, (a, 0, 0)), (mass, (0, a, 0)), (mass, (0, 0, a))])
    damping = draw.number()
    B, S = viscous_pair(draw, body, slug, damping)
    path = draw.vector()
    moving = [
        series.add(path, series.apply(series.transpose(C), draw.fixed(p)))
        for part, C in ((body, B.matrix), (slug, S.matrix))
        for _, p in part
    ]
    masses = tuple(series.constant(draw.field, m, LENGTH) for m, _ in (*body, *slug))
    places, points = _settled(draw, assumed, masses, moving)
    inertia = draw.field.reduce(4 * mass * a * a)
    members = tuple(range(len(body), len(body) + len(slug)))
    frames = {"A": any_turn(draw), "B": B, "S": S}
    return Stage(masses, places, frames, {}, points, slug=Slug(inertia, damping, members))


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


@lru_cache(maxsize=1024)
def world(assumptions: frozenset[str], seed: int, field: Field = RESIDUES) -> World:
    """Return the world of a seed; a singular draw is repeated with the next one.

    Raises `InputError` for assumptions that are unknown or cannot stand together.
    """
    assumed = closure(assumptions)
    for attempt in range(100):
        text = f"{sorted(assumed)} {seed} {attempt}"
        draw = Draw(field, random.Random(text), seed)  # noqa: S311 - reproducible
        try:
            return _build(draw, assumed, seed)
        except Singular:
            continue
    raise AssertionError("no regular world in 100 draws")


def built(assumptions: Iterable[str], draw: Draw) -> World:
    """Return the world that a draw makes. Raises `Singular` for some draws."""
    return _build(draw, closure(assumptions), draw.turn)


def _build(draw: Draw, assumed: frozenset[str], seed: int) -> World:
    make = _particles
    if "rigid" in assumed:
        make = _rigid
    if "rotors" in assumed:
        make = _with_rotors
    if "viscous_slug" in assumed:
        make = _with_slug
    stage = make(draw, assumed)
    internal = _internal_forces(draw, assumed, stage.places)
    origin = draw.fixed((0, 0, 0))
    identity = tuple(draw.fixed(tuple(int(i == j) for j in range(3))) for i in range(3))  # type: ignore[arg-type]
    return World(
        draw.field,
        seed,
        {"I": identity, **{name: turn.matrix for name, turn in stage.frames.items()}},
        {"OI": origin, **stage.points},
        stage.masses,
        stage.places,
        _external_forces(draw, assumed, stage, internal),
        internal,
        stage.angles,
        stage.rotors,
        stage.slug,
        {**{(name, "I"): turn for name, turn in stage.frames.items()}, **stage.relative},
        assumed,
    )


def worlds(assumptions: Iterable[str], count: int, field: Field = RESIDUES) -> Iterator[World]:
    """Yield ``count`` independent worlds under ``assumptions``."""
    assumed = closure(assumptions)
    return (world(assumed, seed, field) for seed in range(count))


Turns = dict[str, Turned]
Angles = dict[str, Angle]


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
            r = self.carried(draw, along(draw.field, p, centre, -1))
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
    are linear in accelerations; its slopes by them are those of its value at t = 0 by accelerations there.
    """
    current, field = list(unknown), draw.field
    slopes = _slopes(field, current, residual)
    for n in range(LENGTH - 2):
        factor = (n + 2) * (n + 1) // 2
        rows = [[field.reduce(factor * a) for a in row] for row in slopes]
        base = _tried(current, residual, n, [0] * len(current))
        found = solve(rows, [field.reduce(-b) for b in base], field)
        current = [_with(s, n + 2, v) for s, v in zip(current, found, strict=True)]
    return current


def _slopes(
    field: Field,
    current: Sequence[Series],
    residual: Callable[[Sequence[Series]], Sequence[Series]],
) -> list[list[Any]]:
    """Return the slopes of a residual at t = 0 by the coefficients 2, by trying zero and each unit."""
    n = len(current)
    base = _tried(current, residual, 0, [0] * n)
    columns = [_tried(current, residual, 0, [int(k == j) for k in range(n)]) for j in range(n)]
    return [[field.reduce(columns[j][i] - base[i]) for j in range(n)] for i in range(n)]


def _tried(
    current: Sequence[Series],
    residual: Callable[[Sequence[Series]], Sequence[Series]],
    order: int,
    values: Sequence[Any],
) -> list[Any]:
    """Return a residual's coefficient ``order`` for coefficients ``order + 2``; later ones do not count."""
    short = (Series(s.field, s.coefficients[: order + 3]) for s in current)
    tried = [_with(s, order + 2, v) for s, v in zip(short, values, strict=True)]
    return [r.coefficients[order] for r in residual(tried)]


def _with(s: Series, place: int, value: Any) -> Series:
    c = s.coefficients
    return Series(s.field, (*c[:place], value, *c[place + 1 :]))


def any_turn(draw: Draw, build: Build = about_axis) -> Turned:
    """Return a rotation from three random angles."""
    return build([angle(draw.series(), draw.number()) for _ in range(3)])


def _first_turn(draw: Draw, assumed: frozenset[str], build: Build) -> Turned:
    """Return a sequence of turns of which the first alone goes on."""
    by = _even(draw.series()) if "steady_turn" in assumed else draw.series()
    others = [draw.fixed(draw.point())[0] for _ in range(2)]
    return build([angle(value, draw.number()) for value in (by, *others)])


def axial_turn(draw: Draw, assumed: frozenset[str]) -> Turned:
    """Return a rotation about an axis that is constant, at a constant rate where that is assumed."""
    first, second = (angle(draw.fixed(draw.point())[0], draw.number()) for _ in range(2))
    by = _even(draw.series()) if "steady_turn" in assumed else draw.series()
    return about_axis([first, second, angle(by, draw.number())])


def _even(value: Series) -> Series:
    """Return what grows at a constant rate, from the same start."""
    return Series(value.field, (*value.coefficients[:2], *(0,) * (LENGTH - 2)))


def fixed_turn(draw: Draw) -> Turned:
    """Return a constant rotation."""
    return about_axis([angle(draw.fixed(draw.point())[0], draw.number()) for _ in range(3)])


def free_attitude(draw: Draw, points: tuple[Weighted, ...], build: Build = about_axis) -> Turned:
    """Return a rotation under which the masses need no torque."""
    quarters = [draw.number() for _ in range(3)]

    def attitude(motion: Sequence[Series]) -> Turned:
        return build([angle(m, q) for m, q in zip(motion, quarters, strict=True)])

    def residual(motion: Sequence[Series]) -> Sequence[Series]:
        return Body(points, attitude(motion).matrix).torque_about_centre(draw)

    return attitude(_solve_motion(draw, draw.vector(), residual))


def viscous_pair(
    draw: Draw, body: Sequence[Weighted], slug: Sequence[Weighted], damping: Any
) -> tuple[Turned, Turned]:
    """Return the rotations of a body and of its slug under the viscous torque between them.

    The conditions: the momentum of both together is constant, and that of the slug changes by
    minus ``damping`` times its angular velocity relative to the body.
    """
    quarters = [draw.number() for _ in range(6)]

    def both(motion: Sequence[Series]) -> tuple[Turned, Turned]:
        angles = [angle(m, q) for m, q in zip(motion, quarters, strict=True)]
        return about_axis(angles[:3]), about_axis(angles[3:])

    def residual(motion: Sequence[Series]) -> Sequence[Series]:
        B, S = (turn.matrix for turn in both(motion))
        h_body, h_slug = (_momentum(draw, p, C) for p, C in ((body, B), (slug, S)))
        relative = series.angular_velocity(series.product(S, series.transpose(B)))
        torque = series.apply(series.transpose(S), relative)
        rates = [h_slug[k].derivative() for k in range(3)]
        balance = [rates[k] + torque[k].scaled(damping) for k in range(3)]
        return [*balance, *(h_body[k].derivative() + rates[k] for k in range(3))]

    return both(_solve_motion(draw, (*draw.vector(), *draw.vector()), residual))


def _momentum(draw: Draw, points: Sequence[Weighted], C: Matrix) -> Vector:
    """Return the angular momentum of points in a frame about their centre of mass."""
    masses = [series.constant(draw.field, m, LENGTH) for m, _ in points]
    back = series.transpose(C)
    return series.spin_momentum(masses, [series.apply(back, draw.fixed(p)) for _, p in points])


_TURNS_312 = (("A", "I", 2, "psi"), ("B", "A", 0, "theta"), ("C", "B", 1, "phi"))
"""Frame, the one before, axis (from 0), angle."""


def _spun(motion: Sequence[Series], start: Sequence[Any]) -> tuple[Turns, Angles]:
    """Return the frames and angles of the 3-1-2 sequence; ``start``: tangents of their quarters."""
    frames: Turns = {}
    angles: Angles = {}
    for (frame, before, axis, name), value, quarter in zip(_TURNS_312, motion, start, strict=True):
        angles[name] = angle(value, quarter)
        turn = turned(axis, angles[name])
        frames[frame] = composed(frames[before], turn) if before in frames else turn
    return frames, angles


def spin_312(
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
        frames, _ = _spun(trial, start)
        torque = Body(points, frames["C"].matrix).torque_about_centre(draw)
        in_B = series.apply(frames["B"].matrix, torque)
        return [in_B[axis] for _, axis in wanted]

    solved = _solve_motion(draw, [motion[place] for place, _ in wanted], residual)
    for (place, _), value in zip(wanted, solved, strict=True):
        motion[place] = value
    return _spun(motion, start)
