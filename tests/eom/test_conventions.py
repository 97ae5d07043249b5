"""Conventions of books: SciPy's rotations as the oracle, and there and back."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from eom.errors import InputError
from eom.kinematics.coordinates import SEQUENCES, quaternion, rotation_sequence
from eom.rotations import angles_of_matrix, matrix_of_quaternion, quaternion_of_matrix
from eom.scenes.conventions import (
    BOOKS,
    CHOICES,
    HOUSE,
    Convention,
    attitude_of_angles,
    attitude_of_matrix,
    attitude_of_quaternion,
    book,
    changed,
    of_scene,
    state,
)
from eom.scenes.scene import Scene
from tests.eom.rows import every

ANGLE = st.floats(-3.1, 3.1)
ANGLES = st.tuples(ANGLE, ANGLE, ANGLE)
AXES = st.sampled_from(["enu", "nwu", "ned", "wsu", "esd", "unw"])
BODIES = st.sampled_from(["flu", "frd", "rfu", "bru", "dfr"])
CONVENTIONS = st.builds(
    Convention,
    *(st.sampled_from(sorted(allowed)) for allowed in CHOICES.values()),
    reference=AXES,
    body=BODIES,
    sequence=st.sampled_from(SEQUENCES),
)


def scipy_word(sequence, order):
    word = "".join("XYZ"[int(axis) - 1] for axis in sequence.split("-"))
    return word if order == "body" else word.lower()


@given(ANGLES, st.sampled_from(SEQUENCES), st.sampled_from(["body", "space"]))
def test_scipy_agrees(angles, sequence, order):
    """SciPy's matrices are active, its quaternions have the scalar last."""
    convention = Convention("active", order, "last", sequence=sequence)
    stated = state(attitude_of_angles(angles, convention), convention)
    other = Rotation.from_euler(scipy_word(sequence, order), angles)
    assert np.allclose(stated.matrix, other.as_matrix(), atol=1e-13)
    q = other.as_quat()
    assert min(np.abs(np.array(stated.quaternion) - s * q).max() for s in (1, -1)) < 1e-13
    again = Rotation.from_euler(scipy_word(sequence, order), stated.angles)
    assert np.allclose(again.as_matrix(), stated.matrix, atol=1e-8)


@given(ANGLES, CONVENTIONS, CONVENTIONS)
def test_there_and_back_whichever_way_it_is_written(angles, source, target):
    C = attitude_of_angles(angles, source)
    stated = state(C, target)
    for again in (
        attitude_of_matrix(stated.matrix, target),
        attitude_of_quaternion(stated.quaternion, target),
        attitude_of_angles(stated.angles, target),
    ):
        assert np.allclose(again, C, atol=1e-8)


@pytest.mark.parametrize("second", [0.0, math.pi / 2, -math.pi / 2, math.pi])
def test_parallel_axes_still_give_the_matrix(second):
    for sequence in SEQUENCES:
        C = attitude_of_angles((0.3, second, -0.8), Convention(sequence=sequence))
        again = attitude_of_angles(angles_of_matrix(C, sequence), Convention(sequence=sequence))
        assert np.allclose(again, C, atol=1e-12), sequence


@given(ANGLES)
def test_the_house_is_that_of_the_kinematics(angles):
    coordinates = rotation_sequence("3-2-1")
    at = dict(zip(coordinates.angles, angles, strict=True))
    C = attitude_of_angles(angles)
    assert np.allclose(C, np.array(coordinates.matrix.xreplace(at), dtype=float), atol=1e-13)
    q = quaternion()
    at = dict(zip(q.symbols, quaternion_of_matrix(C), strict=True))
    assert np.allclose(C, np.array(q.matrix.xreplace(at), dtype=float), atol=1e-13)


def test_heading_in_both_worlds():
    """A heading of 30 degrees from north is a yaw of 60 degrees from east, nose up is a negative pitch."""
    C = attitude_of_angles([math.radians(a) for a in (30, 10, 0)], book("aircraft"))
    assert np.allclose(np.degrees(state(C, book("ros")).angles), [0, -10, 60])


def test_inertia_and_angular_velocity_turn_with_the_axes_and_products_with_their_sign():
    J = ((3.0, -0.1, -0.2), (-0.1, 4.0, -0.3), (-0.2, -0.3, 5.0))
    C = attitude_of_angles((0.0, 0.0, 0.0))
    aircraft = state(C, book("aircraft"), J, (1, 2, 3))
    assert aircraft.inertia == ((3.0, 0.1, 0.2), (0.1, 4.0, -0.3), (0.2, -0.3, 5.0))
    assert aircraft.omega == (1, -2, -3)
    plus = state(C, Convention(products="plus"), J)
    assert plus.inertia == ((3.0, 0.1, 0.2), (0.1, 4.0, 0.3), (0.2, 0.3, 5.0))


@pytest.mark.parametrize("name", every(3, BOOKS))
def test_every_book_states_every_scene_with_an_attitude(name):
    scene = Scene.ready("gravity-gradient-satellite")
    stated = of_scene(scene, book(name))
    kinetic = np.array(stated.omega) @ np.array(stated.inertia) @ np.array(stated.omega)
    assert math.isclose(kinetic, 7e-8 + 40e-8 + 12 * 1.13e-3**2, rel_tol=1e-12)
    assert np.allclose(attitude_of_matrix(stated.matrix, book(name)), of_scene(scene, HOUSE).matrix)


def test_spinner_in_angles_and_products_of_a_solid():
    assert np.allclose(of_scene(Scene.ready("lecture-wheel"), Convention(sequence="3-1-2")).angles,
                       (0.0, 0.1, 0.0))  # fmt: skip
    solid = Scene(
        name="plate", body={"matrix": [[2, -0.5, 0], [-0.5, 3, 0], [0, 0, 4]]}, attitude="3-1-3",
        initial={"omega_1": 1, "omega_2": 0, "omega_3": 0},
        initial_attitude={"sequence": "3-1-3", "degrees": [10, 20, 30]},
    )  # fmt: skip
    stated = of_scene(solid, Convention(products="plus", sequence="3-1-3"))
    assert stated.inertia[0][1] == 0.5
    assert np.allclose(np.degrees(stated.angles), (10, 20, 30))


@given(st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(x * x for x in q) > 0.01))
def test_quaternions_of_every_size_of_scalar(q):
    unit = np.array(q) / np.linalg.norm(q)
    back = np.array(quaternion_of_matrix(matrix_of_quaternion(unit)))
    assert min(np.abs(back - unit).max(), np.abs(back + unit).max()) < 1e-13
    assert back[0] >= 0


REFUSED = {
    "no choice": (lambda: Convention("forwards"), "unknown direction"),
    "left-handed": (lambda: Convention(reference="neu"), "right-handed"),
    "a letter": (lambda: Convention(body="xyz"), "f, l, u, b, r, d|forward|letters"),
    "two letters": (lambda: Convention(body="fl"), "right-handed"),
    "no sequence": (lambda: Convention(sequence="3-3-1"), "unknown rotation sequence"),
    "no book": (lambda: book("hughs"), "did you mean hughes"),
    "no field": (lambda: changed(HOUSE, {"scale": "last"}), "unknown choice"),
    "reflection": (lambda: attitude_of_matrix(np.diag([1, 1, -1])), "reflection"),
    "stretched": (lambda: attitude_of_matrix(2 * np.eye(3)), "no rotation"),
    "not a number": (lambda: attitude_of_matrix(np.full((3, 3), math.nan)), "no rotation"),
    "two rows": (lambda: attitude_of_matrix(np.eye(2)), "three rows"),
    "norm": (lambda: attitude_of_quaternion([1, 1, 0, 0]), "norm 1.414"),
    "three": (lambda: attitude_of_quaternion([1, 0, 0]), "four"),
    "infinite": (lambda: attitude_of_angles([math.inf, 0, 0]), "three finite"),
    "none": (lambda: of_scene(Scene.ready("t-handle"), HOUSE), "no attitude"),
}


@pytest.mark.parametrize(("call", "words"), REFUSED.values(), ids=REFUSED)
def test_refusals(call, words):
    with pytest.raises(InputError, match=words):
        call()
