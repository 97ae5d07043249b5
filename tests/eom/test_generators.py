"""Bodies, motions and forces as they are drawn, from their masses and places."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eom.exact import series
from eom.exact.series import Series
from eom.fields import Field, Singular
from eom.worlds.generators import Body, free_attitude, world
from eom.worlds.shapes import Draw, along, mirrored, shape
from eom.worlds.turning import elementary
from eom.worlds.worlds import LENGTH, closure
from tests.draws import examples

SHAPES = ("rigid", "thin_rod", "principal_axes", "symmetric", "spin_312")
seeds = st.integers(0, 10**6)


def draw_of(seed, prime=0):
    return Draw(Field(prime), random.Random(seed))


def body_of(name, seed):
    for attempt in range(9):
        draw = draw_of(seed + attempt)
        try:
            points = shape(draw, closure([name]))
            return draw, points, Body(tuple(points), ()).centre(draw.field)
        except Singular:
            continue
    raise AssertionError(name)


def second_moments(points, centre):
    """The sums of m x_i x_j about the centre of mass."""
    return [
        [sum(m * (p[i] - centre[i]) * (p[j] - centre[j]) for m, p in points) for j in range(3)]
        for i in range(3)
    ]


@examples(15)
@given(seeds, st.sampled_from(SHAPES))
def test_the_centre_of_a_body_has_no_first_moment(seed, name):
    _, points, centre = body_of(name, seed)
    assert all(sum(m * (p[k] - centre[k]) for m, p in points) == 0 for k in range(3))


@examples(15)
@given(seeds, st.sampled_from(SHAPES[2:]))
def test_products_of_inertia_vanish_about_principal_axes(seed, name):
    _, points, centre = body_of(name, seed)
    S = second_moments(points, centre)
    assert S[0][1] == S[0][2] == S[1][2] == 0


@examples(15)
@given(seeds)
def test_equal_moments_where_they_are_asked_for(seed):
    for name, (i, j, k) in (("symmetric", (0, 1, 2)), ("spin_312", (0, 2, 1))):
        _, points, centre = body_of(name, seed)
        S = second_moments(points, centre)
        assert S[i][i] == S[j][j]
        assert S[k][k] != 0


def test_principal_moments_differ_unless_symmetric():
    for seed in range(20):
        _, points, centre = body_of("principal_axes", seed)
        S = second_moments(points, centre)
        if len({S[k][k] for k in range(3)}) == 3:
            return
    raise AssertionError("always symmetric")


@given(seeds)
def test_a_rod_is_straight(seed):
    _, points, _ = body_of("thin_rod", seed)
    (x, y, z), *others = [p for _, p in points]
    directions = [(a - x, b - y, c - z) for _, (a, b, c) in points[1:]]
    u = directions[0]
    for v in directions[1:]:
        assert all(u[i] * v[j] == u[j] * v[i] for i, j in ((0, 1), (0, 2), (1, 2)))
    assert others


def test_mirrored_and_along():
    field = Field(0)
    assert mirrored(field, [(2, (1, 2, 3))]) == [(2, (1, 2, 3)), (2, (-1, -2, -3))]
    assert along(field, (1, 2, 3), (1, 0, 2), 3) == (4, 2, 9)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_elementary_rotations_are_passive(axis):
    """A positive turn of the frame about an axis carries the next axis away from the one after it."""
    field = Field(0)
    sine, cosine = (series.constant(field, field.of(n, 5), LENGTH) for n in (3, 4))
    C = elementary(axis, sine, cosine)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    values = [[e.coefficients[0] for e in row] for row in C]
    assert values[axis][axis] == 1
    assert values[i][i] == values[j][j] == field.of(4, 5)
    assert (values[i][j], values[j][i]) == (field.of(3, 5), field.of(-3, 5))
    assert sum(v != 0 for row in values for v in row) == 5


@pytest.mark.parametrize("seed", range(3))
def test_free_attitude_needs_no_torque_in_any_known_coefficient(seed):
    draw = draw_of(seed, Field().prime)
    points = tuple(shape(draw, closure(["rigid"])))
    attitude = free_attitude(draw, points).matrix
    torque = Body(points, attitude).torque_about_centre(draw)
    assert all(t.is_zero and len(t.coefficients) == LENGTH - 2 for t in torque)
    assert not all(s.derivative().derivative().is_zero for row in attitude for s in row)
    kicked = tuple(
        tuple(Series(s.field, (*s.coefficients[:-1], 1)) for s in row) for row in attitude
    )
    assert not all(t.is_zero for t in Body(points, kicked).torque_about_centre(draw))


def test_forces_are_what_the_second_law_needs():
    w = world(closure(["newton_2", "third_law_weak"]), 2)
    for mass, place, force, row in zip(w.masses, w.places, w.forces, w.internal, strict=True):
        whole = force
        for f in row:
            whole = series.add(whole, f)
        needed = [mass * s.derivative().derivative() for s in place]
        assert all((a - b).is_zero for a, b in zip(whole, needed, strict=True))
    free = world(frozenset(), 2)
    assert any(
        not (f[0] - m * p[0].derivative().derivative()).is_zero
        for m, p, f in zip(free.masses, free.places, free.forces, strict=True)
    )


def test_no_mass_acts_on_itself():
    w = world(frozenset(), 1)
    assert all(w.internal[i][i][k].is_zero for i in range(len(w.masses)) for k in range(3))
    assert not any(
        f[0].is_zero for i, row in enumerate(w.internal) for j, f in enumerate(row) if i != j
    )


def test_every_motion_has_its_full_length_in_solved_worlds():
    for name in ("torque_free", "no_torque_2", "no_torque_3", "viscous_slug"):
        w = world(closure([name]), 0)
        assert all(len(s.coefficients) == LENGTH for p in w.places for s in p), name
