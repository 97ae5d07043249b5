"""Draw random worlds: places of masses, motions and forces, restricted by named assumptions."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

from eom.exact import series
from eom.exact.series import LENGTH, Series, Vector
from eom.fields import PRIME, Field, Singular
from eom.worlds.motions import (
    Angles,
    Body,
    Turns,
    any_turn,
    fixed_turn,
    free_attitude,
    spin_312,
    viscous_pair,
)
from eom.worlds.shapes import Draw, Point, Weighted, along, any_body, central, mirrored, shape
from eom.worlds.turning import Build, Turned, about_axis, composed, elementary, reversed_, sequence
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
    """Return the frames A and B; by a sequence, B is turned from I, and from A, by other angles."""
    build = _build_of(assumed)
    B = B or any_turn(draw, build)
    if build is about_axis:
        return {"A": any_turn(draw), "B": B}, {}
    from_A = any_turn(draw, build)
    return {"A": composed(B, reversed_(from_A)), "B": B}, {("B", "A"): from_A}


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
    reference, rest = draw.vector(), draw.fixed(draw.point())
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
    pivot = centre if about_centre else draw.point()
    body_fixed = about_centre or "O_fixed_in_body" in assumed
    still = draw.fixed((0, 0, 0)) if "O_at_origin" in assumed else draw.fixed(draw.point())
    anchor, path = draw.point(), draw.vector()
    if "C_at_rest" in assumed:
        anchor, path = centre, draw.fixed(draw.point())
    if body_fixed and "O_fixed_in_space" in assumed:
        anchor, path = pivot, still

    def carried(point: Point) -> Vector:
        return series.add(path, body.carried(draw, along(draw.field, point, anchor, -1)))

    reference = draw.vector()
    if "O_fixed_in_space" in assumed:
        reference = still
    if body_fixed:
        reference = carried(pivot)
    points = {"O": reference, "C": carried(centre)}
    points |= {name: carried(draw.point()) for name in ("OA", "OB")}
    if "OA_at_centre" in assumed:
        points["OA"] = points["C"]
    masses = tuple(series.constant(draw.field, m, LENGTH) for m, _ in body.points)
    return Stage(masses, tuple(carried(p) for _, p in body.points), frames, angles, points)


def _with_rotors(draw: Draw, assumed: frozenset[str]) -> Stage:
    """A carrier that is fixed in B, and rotors of four or eight masses each."""
    frames, relative = _frames(draw, assumed)
    B = frames["B"].matrix
    weighted = [(m, draw.fixed(p)) for m, p in any_body(draw)]
    rotors = []
    for _ in range(draw.generator.randint(1, 3)):
        base, centre = draw.fixed_rotation(), draw.fixed(draw.point())
        angle = draw.series()
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


@lru_cache(maxsize=512)
def world(assumptions: frozenset[str], seed: int, prime: int = PRIME) -> World:
    """Return the world of a seed; a singular draw is repeated with the next one.

    Raises `InputError` for assumptions that are unknown or cannot stand together.
    """
    assumed = closure(assumptions)
    for attempt in range(100):
        text = f"{sorted(assumed)} {seed} {attempt}"
        draw = Draw(Field(prime), random.Random(text), seed)  # noqa: S311 - reproducible
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


def worlds(assumptions: Iterable[str], count: int, prime: int = PRIME) -> Iterator[World]:
    """Yield ``count`` independent worlds under ``assumptions``."""
    assumed = closure(assumptions)
    return (world(assumed, seed, prime) for seed in range(count))
