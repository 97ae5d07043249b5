"""Herpolhodes, cones and paths on the sphere against exact radii, constants and integrated motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eom import InputError, Scene, load_scene
from eom.kinematics.coordinates import attitude
from eom.mechanics.freebody import herpolhode as exact_herpolhode
from eom.views.animation.tracks import matrices
from eom.views.body.cones import cones, free_cones
from eom.views.body.frame_sketches import after_turns
from eom.views.body.free import FreeBody, free_body
from eom.views.body.poinsot import herpolhode, traced
from eom.views.body.rotating import sphere, symmetry_of, turning
from eom.views.draw.picture import Arrow, Curve, Surface, check

GENERAL = FreeBody((1.0, 2.0, 2.6), (0.5, 0.3, 1.0), (0.6, 0.0, 0.8, 0.0), "General")
SEPARATRIX = FreeBody((4.0, 5.0, 9.0), (3.0, 2.0, 1.0))
MOMENTS = [
    GENERAL,
    SEPARATRIX,
    FreeBody((4.0, 5.0, 9.0), (-3.0, 2.0, 1.0)),
    FreeBody((9.0, 5.0, 4.0), (1.0, -2.0, 3.0)),
    FreeBody((2.0, 2.0, 3.0), (0.5, 0.2, 1.0)),
    FreeBody((3.0, 1.2, 3.0), (0.5, 1.0, 0.2)),
    FreeBody((1.0, 1.0 + 1e-9, 1.5), (0.1, 0.2, 1.0)),
]


@pytest.fixture(scope="module")
def top():
    return turning(load_scene("heavy-top"), 1.0, 100)


def items(picture, kind):
    found = [i for row in picture.rows for panel in row for i in panel.items]
    return [i for i in found if isinstance(i, kind)]


@pytest.mark.parametrize("body", MOMENTS)
def test_the_herpolhode_stays_in_its_plane_between_its_circles(body):
    path = traced(body)
    height = 2 * body.energy / body.momentum
    assert np.abs(path.space[:, 2] / height - 1).max() < 1e-12
    found = exact_herpolhode(body.moments, body.omega)
    radius = np.hypot(path.space[:, 0], path.space[:, 1])
    slack = 1e-7 * np.linalg.norm(body.omega)  # near zero the radius is the root of a difference
    assert radius.max() <= float(found.outer) + slack
    assert radius.min() >= float(found.inner) - slack
    assert radius.max() == pytest.approx(float(found.outer), rel=2e-3)


def test_the_separatrix_is_drawn_from_end_to_end():
    for body in MOMENTS[1:4]:
        path = traced(body)
        radius = np.hypot(path.space[:, 0], path.space[:, 1])
        greatest = radius.max()
        assert radius[0] < 1e-3 * greatest
        assert radius[-1] < 1e-3 * greatest
        assert np.argmax(radius) == pytest.approx(len(radius) / 2, abs=3)


@pytest.mark.parametrize("body", MOMENTS)
def test_the_frame_is_right_handed_with_the_momentum_upright(body):
    path = traced(body)
    assert path.frame @ path.frame.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(path.frame) == pytest.approx(1.0)
    C = matrices(body.attitude)
    momentum = C.T @ np.multiply(body.moments, body.omega)
    assert path.frame @ momentum == pytest.approx([0, 0, body.momentum], abs=1e-11)
    assert path.first == pytest.approx(C @ path.frame.T, abs=1e-13)
    start = np.array(body.omega) @ path.first
    assert start[0] >= 0
    assert start[1] == pytest.approx(0.0, abs=1e-12 * np.linalg.norm(start))


@pytest.mark.parametrize("body", MOMENTS)
def test_the_cones_touch_along_omega(body):
    picture = check(free_cones(body))
    omega = next(i for i in items(picture, Arrow) if "omega" in i.words)
    way = omega.end / np.linalg.norm(omega.end)
    edges = [c.points for c in items(picture, Curve)]
    assert len(edges) == 2
    for edge in edges:
        assert np.linalg.norm(edge, axis=1) == pytest.approx(np.ones(len(edge)))
        step = np.linalg.norm(np.diff(edge, axis=0), axis=1).max()
        assert np.linalg.norm(edge - way, axis=1).min() <= step
    assert {s.label for s in items(picture, Surface)} == {"body cone", "space cone"}


@pytest.mark.parametrize("moments", [(2.0, 2.0, 3.0), (2.0, 2.0, 1.1)])
def test_the_cones_of_a_symmetric_body_are_circular(moments):
    """Angles to H and to the axis as in Goldstein: tan of them is known from J."""
    body = FreeBody(moments, (0.3, 0.4, 1.2))
    across, along = 0.5, 1.2
    nutation = np.arctan2(moments[0] * across, moments[2] * along)
    opening = np.arctan2(across, along)
    body_edge, space_edge = (c.points for c in items(free_cones(body), Curve))
    assert np.arccos(space_edge[:, 2]) == pytest.approx(abs(nutation - opening), abs=1e-7)
    axis = next(i for i in items(free_cones(body), Arrow) if "{b}" in i.words).end
    cosines = body_edge @ (axis / np.linalg.norm(axis))
    assert np.arccos(cosines) == pytest.approx(opening, abs=1e-7)
    ends = space_edge[[0, -1]]
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)  # once around


def test_steady_spin_has_no_cone_but_an_axis():
    picture = free_cones(FreeBody((1.0, 2.0, 2.5), (0.0, 2.0, 0.0)))
    assert not items(picture, Surface)
    assert len(items(picture, Arrow)) == 2
    assert "constant" in picture.caption
    construction = check(herpolhode(FreeBody((2.0, 2.0, 2.0), (1.0, 2.0, 0.5))))
    assert "herpolhode" not in {c.label for c in items(construction, Curve)}


def test_a_body_at_rest_has_no_cone():
    still = FreeBody((1.0, 2.0, 2.5), (0.0, 0.0, 0.0))
    with pytest.raises(InputError, match="at rest"):
        free_cones(still)
    with pytest.raises(InputError, match="at rest"):
        herpolhode(still)


def test_poinsots_ellipsoid_touches_the_plane():
    """The greatest height of the ellipsoid is that of the plane, at the tip of omega."""
    picture = herpolhode(GENERAL)
    plane, solid = items(picture, Surface)
    height = 2 * GENERAL.energy / GENERAL.momentum
    assert plane.vertices[:, 2] == pytest.approx(height)
    assert solid.vertices[:, 2].max() <= height * (1 + 1e-12)
    assert solid.vertices[:, 2].max() == pytest.approx(height, rel=5e-3)


def test_matrices_of_quaternions_are_those_of_the_derivations():
    q = np.array([0.1, -0.5, 0.7, 0.5])
    q /= np.linalg.norm(q)
    written = attitude("quaternion")
    numbers = dict(zip([c.symbol for c in written.coordinates], q, strict=True))
    expected = np.array(written.matrix.xreplace(numbers).evalf(), float)
    assert matrices(q) == pytest.approx(expected, abs=1e-14)


def integrated(motion, torque, moments):
    """Integrate Euler's equations with C by SciPy, to the last time; return omega and C."""
    J = np.array(moments)

    def rates(t, y):
        w, C = y[:3], y[3:].reshape(3, 3)
        spin = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        return np.concatenate([(torque(t, w, C) - np.cross(w, J * w)) / J, (-spin @ C).ravel()])

    start = np.concatenate([motion.omega[0], motion.C[0].ravel()])
    run = solve_ivp(rates, (0, motion.t[-1]), start, method="DOP853", rtol=1e-12, atol=1e-13)
    return run.y[:3, -1], run.y[3:, -1].reshape(3, 3)


def test_a_free_body_turns_as_integrated():
    motion = turning(load_scene("t-handle"), 2.0, 50)
    omega, C = integrated(motion, lambda *_: np.zeros(3), motion.free.moments)
    assert motion.omega[-1] == pytest.approx(omega, abs=1e-8)
    assert motion.C[-1] == pytest.approx(C, abs=1e-8)


def test_a_top_turns_as_integrated(top):
    scene, motion = load_scene("heavy-top"), top

    def weight(t, w, C):
        return np.cross([0, 0, 0.2], C @ [0, 0, -10.0])

    omega, C = integrated(motion, weight, scene.body.moments)
    assert motion.free is None
    assert motion.symmetry == 2
    assert motion.omega[-1] == pytest.approx(omega, abs=1e-6)
    assert motion.C[-1] == pytest.approx(C, abs=1e-7)


def test_a_spinner_turns_as_integrated():
    scene = load_scene("lecture-wheel")
    motion = turning(scene, 1.0, 40)

    def torque(t, w, C):  # -M1 b1 of the frame that does not spin: b1 is level, across the axle
        level = np.cross(C[1], [0, 0, 1.0])
        return C @ (-0.5 * level / np.linalg.norm(level))

    first, axial = scene.body.moments
    omega, C = integrated(motion, torque, (first, axial, first))
    assert motion.omega[-1] == pytest.approx(omega, abs=1e-6)
    assert motion.C[-1] == pytest.approx(C, abs=1e-6)


def test_a_spinner_without_torque_is_free():
    data = load_scene("lecture-wheel").model_dump(exclude_unset=True)
    data |= {"torque": {}, "parameters": {}, "initial": {**data["initial"], "theta_dot": 0.4}}
    data["initial"]["phi"] = 0.3
    scene = Scene(**data)
    motion = turning(scene, 1.0, 10)
    body = free_body(scene, "polhode")
    assert motion.free == body
    assert body.omega[1] == pytest.approx(6.0)
    C = after_turns("3-1-2", (0.0, 0.1, 0.3))[-1]
    assert motion.C[0] == pytest.approx(C, abs=1e-14)
    in_space = C.T @ np.array(body.omega)
    level = [np.cos(0.0), np.sin(0.0), 0.0]  # theta turns about a1, which is i1 at psi = 0
    assert in_space @ level == pytest.approx(0.4)


def test_attitude_by_angles_and_a_torque_of_angles():
    """A torque in the scene's own angles keeps these; the motion is that of the integrated angles."""
    data = {
        "title": "Held", "attitude": "3-2-1", "body": {"moments": [1.0, 2.0, 2.5]},
        "torque": {"components": ["-k*phi", 0, 0]}, "parameters": {"k": 0.5},
        "initial": {"omega_1": 0.3, "omega_2": 0.1, "omega_3": 0.0},
        "initial_attitude": {"sequence": "3-2-1", "degrees": [10, 20, 30]},
    }  # fmt: skip
    motion = turning(Scene(**data), 1.0, 30)

    def spring(t, w, C):
        return np.array([-0.5 * np.arctan2(C[1, 2], C[2, 2]), 0, 0])

    omega, C = integrated(motion, spring, (1.0, 2.0, 2.5))
    assert motion.omega[-1] == pytest.approx(omega, abs=1e-7)
    assert motion.C[-1] == pytest.approx(C, abs=1e-7)


def test_paths_lie_on_the_sphere_and_a_symmetric_body_leaves_one(top):
    picture = check(sphere(top))
    (path,) = items(picture, Curve)
    assert "_3" in path.label
    assert np.linalg.norm(path.points, axis=1) == pytest.approx(np.ones(100), abs=1e-9)
    free = sphere(turning(load_scene("t-handle"), 1.0, 100))
    assert len(items(free, Curve)) == 3
    assert any("H" in a.words for a in items(free, Arrow))


def test_cones_with_a_torque_are_those_of_the_motion(top):
    motion = top
    picture = check(cones(motion))
    edge = items(picture, Curve)[1].points
    space = np.einsum("nki,nk->ni", motion.C, motion.omega)
    space /= np.linalg.norm(space, axis=1, keepdims=True)
    assert edge == pytest.approx(space)
    with pytest.raises(InputError, match="orbit"):
        cones(replace(motion, orbit=True))


def test_an_attitude_that_is_not_stated_is_reported():
    data = load_scene("t-handle").model_dump(exclude_unset=True)
    assert "states no attitude" in sphere(turning(Scene(**data), 0.1, 5)).caption
    data |= {"attitude": "quaternion", "initial_attitude": {"quaternion": [1, 0, 0, 0]}}
    assert "states no attitude" not in sphere(turning(Scene(**data), 0.1, 5)).caption


def test_trees_and_symmetry():
    with pytest.raises(InputError, match="many bodies"):
        turning(load_scene("double-pendulum"))
    assert symmetry_of((2.0, 2.0, 2.0)) is None
    assert symmetry_of((2.0, 3.0, 2.0)) == 1
