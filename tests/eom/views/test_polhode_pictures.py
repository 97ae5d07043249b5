"""Polhodes of pictures against the constants of the motion, classes against exact sides."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from codegen import free_motion
from codegen.closed.polhode import polhode
from eom import InputError, load_scene
from eom.mechanics.freebody import classify
from eom.views.body.free import (
    CLASSES,
    FreeBody,
    class_of,
    family,
    free_body,
    moving,
    not_free,
    polhode_points,
    principal,
    separatrix,
)
from eom.views.body.polhodes import ellipsoids, energy_axes, momentum_axes, polhodes
from eom.views.draw.picture import Curve, Marks, Surface, check
from tests.draws import examples

CLOSE = 1e-12

second_moment = st.floats(0.05, 5.0)
rate = st.floats(-20.0, 20.0).map(lambda w: 0.0 if abs(w) < 1e-3 else w)


@st.composite
def bodies(draw):
    a, b, c = (draw(second_moment) for _ in range(3))
    if draw(st.booleans()):
        b = a * (1 + draw(st.sampled_from([0.0, 1e-15, 1e-9, 1e-4])))
    omega = [draw(rate) for _ in range(3)]
    omega[draw(st.integers(0, 2))] = draw(st.floats(0.5, 20.0))
    return FreeBody((b + c, a + c, a + b), tuple(omega))


def residuals(body, points):
    """Greatest relative distance of points from both quadrics of a body."""
    J = np.array(body.moments)
    energy = (points**2 @ J) / (2 * body.energy) - 1
    momentum = (points**2 @ J**2) / body.momentum**2 - 1
    return max(np.abs(energy).max(), np.abs(momentum).max())


@examples(30)
@given(bodies())
def test_a_polhode_lies_on_both_ellipsoids(body):
    points = polhode_points(body.polhode)
    assert residuals(body, points) < CLOSE


@examples(30)
@given(bodies())
def test_the_motion_keeps_to_its_polhode_and_its_side(body):
    """The closed form in time lies on the curve without time."""
    exact = body.polhode
    if not moving(exact):
        assert len(polhode_points(exact)) == 1
        return
    curve = polhode_points(exact, 4 * 720)
    step = np.linalg.norm(np.diff(curve, axis=0), axis=1).max()
    motion = body.motion
    span = motion.period if np.isfinite(motion.period) else 5 / max(map(abs, body.omega))
    omega, _ = motion(np.linspace(0.0, span, 7))
    for w in omega.T:
        assert np.linalg.norm(curve - w, axis=1).min() <= step


@examples(30)
@given(bodies())
def test_the_family_lies_on_its_ellipsoid_and_on_its_side(body):
    for axes, form, level in (
        (momentum_axes(body), np.array(body.moments) ** 2, body.momentum**2),
        (energy_axes(body), np.array(body.moments), 2 * body.energy),
    ):
        for one in family(body.moments, axes, 2):
            points = polhode_points(one)
            assert np.abs(points**2 @ form / level - 1).max() < CLOSE
            J = np.array(body.moments)
            mid = sorted(body.moments)[1]
            sides = points**2 @ (J * (J - mid))  # H^2 - 2 T I2, sign by class
            scale = points**2 @ (J * J)
            expected = class_of(one)
            assert (expected * sides > -CLOSE * scale).all()


@examples(30)
@given(bodies())
def test_the_separatrix_lies_between_the_classes(body):
    J = np.array(body.moments)
    for curve in separatrix(body.moments, 2.0):
        energy, momentum = curve**2 @ J, curve**2 @ J**2
        mid = sorted(body.moments)[1]
        assert np.abs(energy / (4 * mid) - 1).max() < CLOSE
        assert np.abs(momentum / (4 * mid**2) - 1).max() < CLOSE


def test_equal_moments_have_no_separatrix():
    assert separatrix((1.0, 1.0, 2.0), 1.0) == ()
    assert separatrix((2.0, 2.0, 2.0), 1.0) == ()
    assert len(separatrix((1.0, 1.0 + 1e-12, 2.0), 1.0)) == 2


@pytest.mark.parametrize("offset", [-1e-9, 0.0, 1e-9])
def test_classes_on_both_sides_of_the_separatrix(offset):
    """Moments 1, 2, 3: H^2 = 4 T where 3 w3^2 = w1^2; also a part in 1e9 beside it."""
    w1 = Fraction(3, 2)
    w3 = w1 * Fraction(0.57735026918962576451).limit_denominator(10**9)
    exact = polhode((1, 2, 3), (w1, Fraction(1), w3))
    assert class_of(exact) == (1 if 3 * w3**2 > w1**2 else -1)
    on = polhode((1.0, 2.0, 6.0), (2.0, 1.0, (1 + offset) * np.sqrt(1 / 6)))
    beside = 24 * Fraction((1 + offset) * np.sqrt(1 / 6)) ** 2 - 4
    assert class_of(on) == (beside > 0) - (beside < 0)


def test_the_exact_separatrix():
    """I = 4, 5, 9: I1 d21 w1^2 = 4 w1^2, I3 d32 w3^2 = 36 w3^2, equal at w1 = 3 w3."""
    body = FreeBody((4.0, 5.0, 9.0), (3.0, 2.0, 1.0))
    exact = body.polhode
    assert exact.A == 0
    assert class_of(exact) == 0
    assert classify((4, 5, 9), (3, 2, 1)).kind == "separatrix"
    points = polhode_points(exact)
    assert residuals(body, points) < CLOSE
    assert np.allclose(points[:, 0], 3 * points[:, 2], rtol=1e-14, atol=1e-14)
    ends = points[[0, -1]]
    assert np.allclose(np.abs(ends[:, 1]), np.sqrt(2 * body.energy / 5), rtol=1e-14)
    assert ends[0, 1] * ends[1, 1] < 0
    own = [i for i in curves(polhodes(body)) if i.width == 3.0]
    assert all("separatrix" in c.label for c in own)


def curves(picture):
    items = [i for row in picture.rows for panel in row for i in panel.items]
    return [i for i in items if isinstance(i, Curve)]


def test_colours_say_the_class():
    body = free_body(load_scene("t-handle"), "polhode")
    J, mid = np.array(body.moments), sorted(body.moments)[1]
    seen = set()
    for curve in curves(polhodes(body)):
        sides = curve.points**2 @ (J * (J - mid)) / (curve.points**2 @ (J * J))
        sign = 0 if np.abs(sides).max() < CLOSE else int(np.sign(sides[0]))
        if curve.width == 3.0:  # the motion's own
            assert CLASSES[sign].words in curve.label
        else:
            assert curve.colour == CLASSES[sign].colour
            assert curve.label == CLASSES[sign].words
        seen.add(sign)
    assert seen == {1, 0, -1}


@pytest.mark.parametrize(
    ("moments", "omega", "words"),
    [
        ((2.0, 2.0, 2.0), (1.0, 2.0, 3.0), "constant angular velocity"),
        ((1.0, 2.0, 3.0), (0.0, 4.0, 0.0), "constant angular velocity"),
        ((2.0, 2.0, 3.0), (0.1, 0.2, 1.0), "about the axis of greatest moment"),
        ((2.0, 2.0, 1.0), (0.1, 0.2, 1.0), "about the axis of least moment"),
        ((1.0, 1.0 + 1e-9, 1.5), (0.1, 0.2, 1.0), "about the axis of greatest moment"),
        ((1e-3, 1.0, 1.0), (3.0, 0.2, 1.0), "about the axis of least moment"),
        ((1e-30, 2e-30, 2.5e-30), (1e-30, 2e-30, 1e-30), "about the axis of greatest moment"),
    ],
)
def test_special_bodies_are_drawn(moments, omega, words):
    body = FreeBody(moments, omega)
    for draw in (polhodes, ellipsoids):
        picture = check(draw(body))
        assert words in picture.caption
        items = [i for row in picture.rows for panel in row for i in panel.items]
        own = [i for i in items if isinstance(i, Curve | Marks) and "this motion" in i.label]
        assert all(words in i.label for i in own)
        assert own
        assert all(np.isfinite(i.vertices).all() for i in items if isinstance(i, Surface))


def test_bodies_that_have_no_polhode():
    with pytest.raises(InputError, match="at rest"):
        polhodes(FreeBody((1.0, 2.0, 2.5), (0.0, 0.0, 0.0)))
    with pytest.raises(InputError, match="exceeds the sum"):
        polhodes(FreeBody((1.0, 2.0, 4.0), (0.0, 1.0, 0.0)))
    with pytest.raises(InputError, match="not finite"):
        polhodes(FreeBody((1.0, 2.0, 2.5), (0.0, np.nan, 0.0)))


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("heavy-top", "weight"),
        ("gravity-gradient-satellite", "gravity"),
        ("lecture-wheel", "a torque acts"),
        ("double-pendulum", "a tree"),
    ],
)
def test_scenes_that_are_not_free_say_why(name, reason):
    assert reason in not_free(load_scene(name))
    with pytest.raises(InputError, match=reason):
        free_body(load_scene(name), "polhode")


def test_an_inertia_matrix_is_brought_to_principal_axes(tmp_path):
    J = np.array([[3.0, 0.4, -0.2], [0.4, 2.0, 0.1], [-0.2, 0.1, 2.5]])
    file = tmp_path / "tilted.toml"
    file.write_text(
        f'title = "Tilted"\nattitude = "quaternion"\n[body]\nmatrix = {J.tolist()}\n'
        "[initial]\nomega_1 = 1.0\nomega_2 = 0.5\nomega_3 = -2.0\n"
        "[initial_attitude]\nquaternion = [0.6, 0.0, 0.8, 0.0]\n"
    )
    body = free_body(load_scene(file), "polhode")
    moments, C = principal(J)
    w = np.array([1.0, 0.5, -2.0])
    assert np.linalg.det(C) == pytest.approx(1.0)
    assert pytest.approx(np.diag(moments), abs=1e-14) == C @ J @ C.T
    assert body.energy == pytest.approx(w @ J @ w / 2, rel=1e-14)
    assert body.momentum == pytest.approx(np.linalg.norm(J @ w), rel=1e-14)
    assert body.axis(1) == r"$\mathbf{p}_1$"
    omega, q = free_motion(body.moments, body.omega, body.attitude)(0.0)
    from eom.views.animation.tracks import matrices

    space = matrices(q).T @ omega
    s, x, y, z = 0.6, 0.0, 0.8, 0.0
    given_C = matrices([s, x, y, z])
    assert space == pytest.approx(given_C.T @ w, abs=1e-13)
