"""Angles over a quaternion: the attitude rebuilt from them, and scenes that show them."""

import itertools
import math

import numpy as np
import pytest
import sympy as sp

import eom
from eom.errors import InputError
from eom.kinematics.coordinates import (
    SEQUENCES,
    quaternion,
    quaternion_of_sequence,
    rotation_sequence,
)
from eom.mechanics.sequence_angles import over_quaternion
from eom.rotations import matrix_of_quaternion
from eom.scenes.scene import Scene

Q = quaternion().symbols
EXACT = [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, -1), (1, 1, 1, 1), (1, -1, 1, -1)]


def turned(sequence, angles):
    """C from the elementary turns: an oracle that knows nothing of quaternions."""
    C = np.eye(3)
    for axis, a in zip(map(int, sequence.split("-")), angles, strict=True):
        i, j = axis % 3, (axis + 1) % 3
        turn = np.eye(3)
        turn[i, i] = turn[j, j] = math.cos(a)
        turn[i, j], turn[j, i] = math.sin(a), -math.sin(a)
        C = turn @ C
    return C


@pytest.fixture(scope="module")
def functions():
    made = {}
    for name in SEQUENCES:
        found = rotation_sequence(name).principal_of_quaternion(Q)
        made[name] = sp.lambdify(Q, found, "math")
    return made


def singular(sequence):
    return (0.0, math.pi) if sequence[0] == sequence[-1] else (math.pi / 2, -math.pi / 2)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_the_attitude_is_that_of_the_angles_also_where_they_are_singular(functions, sequence):
    generator = np.random.default_rng(1)
    attitudes = [*generator.normal(size=(20, 4)), *map(np.array, EXACT)]
    near = itertools.product((0.3, -2.0), singular(sequence), (0.0, 1e-9, 1e-5), (1.1, -2.8))
    attitudes += [np.array(quaternion_of_sequence(sequence, (a, b + d, c))) for a, b, d, c in near]
    for q in attitudes:
        for scale in (1, -1, 1e3):
            angles = functions[sequence](*(scale * q))
            C = np.array(matrix_of_quaternion(q / np.linalg.norm(q)))
            np.testing.assert_allclose(turned(sequence, angles), C, rtol=0, atol=4e-15)
            assert all(-math.pi <= a <= math.pi for a in angles)
            lowest = 0 if sequence[0] == sequence[-1] else -math.pi / 2
            assert lowest <= angles[1] <= lowest + math.pi


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angles_come_back(functions, sequence):
    lowest = 0 if sequence[0] == sequence[-1] else -math.pi / 2
    for angles in ((0.4, lowest + 0.5, -1.2), (-3.1, lowest + 2.9, 3.0), (2.0, lowest + 1e-3, 1.0)):
        q = quaternion_of_sequence(sequence, angles)
        np.testing.assert_allclose(functions[sequence](*q), angles, rtol=0, atol=2e-12)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_formulas_in_angles_are_the_same_over_the_quaternion(sequence):
    rotation = rotation_sequence(sequence)
    psi, theta, phi = rotation.angles
    formula = sp.cos(theta) * sp.Symbol("k") + sp.sin(psi - 2 * phi) + theta**2 + sp.cos(psi) ** 2
    lowest = 0 if sequence[0] == sequence[-1] else -math.pi / 2
    angles = (0.4, lowest + 0.5, -1.2)
    q = dict(zip(Q, quaternion_of_sequence(sequence, angles), strict=True))
    over = over_quaternion(formula, rotation, Q, "here")
    assert not over.free_symbols & set(rotation.angles)
    expected = formula.subs(dict(zip(rotation.angles, angles, strict=True)))
    assert abs(float((over.subs(q) - expected).subs(sp.Symbol("k"), 2).evalf())) < 1e-14


BODY = {"body": {"moments": (1.0, 2.0, 2.5)}}
START = {"omega_1": 0.1, "omega_2": 0.2, "omega_3": 0.3}
ANGLES = {"psi": 0.1, "theta": 0.2, "phi": 0.3}
BAD = {
    "unknown sequence": ({"attitude": "quaternion", "angles": "3-3-1"}, "unknown rotation sequence"),
    "angles of angles": ({"attitude": "3-2-1", "angles": "3-1-3"}, "the attitude is a quaternion"),
    "no attitude": ({"angles": "3-1-3"}, "the attitude is a quaternion"),
    "integrate what": ({"attitude": "3-2-1", "integrate": "foo"}, "unusable value"),
    "nothing in angles": ({"integrate": "quaternion"}, "only the angles"),
    "in a quaternion already": ({"attitude": "quaternion", "integrate": "quaternion"}, "only the angles"),
    "two angles": ({"attitude": "3-2-1", "integrate": "quaternion", "initial": {"psi": 0, "phi": 1}},
                   "three angles"),
    "twice": ({"attitude": "3-2-1", "integrate": "quaternion", "initial": ANGLES,
               "initial_attitude": {"degrees": (0, 0, 0), "sequence": "3-2-1"}}, "given once"),
    "whole turns": ({"attitude": "3-2-1", "integrate": "quaternion",
                     "torque": {"components": ("-psi", 0, 0)}}, "whole turns of psi"),
    "half turns": ({"attitude": "3-2-1", "integrate": "quaternion",
                    "torque": {"components": ("sin(phi/2)", 0, 0)}}, "whole turns of phi"),
    "no start": ({"attitude": "3-2-1", "integrate": "quaternion", "initial": START},
                 "missing initial value: psi, theta, phi"),
    "the old key": ({"attitude": "3-2-1", "integration": {"handover": True}}, 'integrate = "quaternion"'),
    "the old key, off": ({"attitude": "3-2-1", "integration": {"handover": False}}, "handed over"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_is_one_clear_error(case):
    data, words = BAD[case]
    with pytest.raises(InputError, match=words):
        Scene(**BODY, **data).initial_values()


def test_the_start_is_given_in_angles_or_as_any_attitude():
    scenes = [
        Scene(**BODY, attitude="3-2-1", integrate="quaternion", **given)
        for given in (
            {"initial": {**START, **ANGLES}},
            {"initial": START, "initial_attitude": {"sequence": "3-2-1", "radians": (0.1, 0.2, 0.3)}},
            {"initial": START,
             "initial_attitude": {"quaternion": quaternion_of_sequence("3-2-1", (0.1, 0.2, 0.3))}},
        )
    ]  # fmt: skip
    first, *others = (s.initial_values() for s in scenes)
    q = quaternion_of_sequence("3-2-1", (0.1, 0.2, 0.3))
    assert first == pytest.approx({**START, **{f"q{k}": v for k, v in enumerate(q)}})
    assert all(o == pytest.approx(first, abs=1e-15) for o in others)
    assert scenes[0].requested == (*START, *ANGLES)
    shown = Scene(**BODY, attitude="quaternion", angles="3-1-3")
    assert shown.requested == (*START, "q0", "q1", "q2", "q3", *ANGLES)


def test_a_scene_that_needs_no_attitude_has_none():
    scene = Scene(**BODY, attitude="3-2-1", integrate="quaternion", outputs=("T",), initial=START)
    assert scene.derive().state_names == tuple(START)


def test_a_torque_by_angles_is_singular_where_it_has_no_direction():
    torque = {"components": ("sin(psi)", "cos(theta)", 0)}
    scene = Scene(**BODY, attitude="3-2-1", integrate="quaternion", torque=torque)
    (found,) = scene.full_system.singularities
    q = dict(zip(Q, quaternion_of_sequence("3-2-1", (0.4, 0.5, -1.2)), strict=True))
    assert abs(float(found.expression.subs(q))) == pytest.approx(math.cos(0.5))
    smooth = Scene(**BODY, attitude="3-2-1", integrate="quaternion",
                   torque={"components": (0, "cos(theta)", 0)})  # fmt: skip
    assert not smooth.full_system.singularities


def test_the_ready_scene_is_shown_in_its_angles():
    scene = eom.load_scene("t-handle-in-angles")
    assert scene.attitude == "3-2-1"
    assert scene.coordinates == "quaternion"
    assert {"psi", "theta", "phi"} <= set(scene.derive().output_names)
