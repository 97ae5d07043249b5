"""Rotations made of turns, against SciPy's, and as functions of time against their own series."""

import itertools
import math
import random

import pytest

from eom.exact import series
from eom.exact.series import Series
from eom.fields import Field
from eom.worlds.generators import any_turn, fixed_turn, worlds
from eom.worlds.shapes import Draw
from eom.worlds.turning import about_axis, angle, composed, reversed_, sequence
from eom.worlds.worlds import SEQUENCES, closure

SEEDS = range(4)


def draw_of(seed):
    return Draw(Field(0), random.Random(seed))


def start(matrix):
    return [[float(e.coefficients[0]) for e in row] for row in matrix]


def radians(a):
    """The angle whose half has this sine and cosine at t = 0."""
    return 2 * math.atan2(float(a.half_sine.coefficients[0]), float(a.half_cosine.coefficients[0]))


def close(a, b):
    flat = [[float(x) for row in m for x in row] for m in (a, b)]
    return max(abs(x - y) for x, y in zip(*flat, strict=True)) < 1e-12


def angles_of(draw):
    return [angle(draw.series(), draw.number()) for _ in range(3)]


@pytest.mark.parametrize("axes", SEQUENCES.values())
def test_sequences_are_those_of_scipy(axes):
    """Intrinsic turns of vectors are the transpose of the matrix of components."""
    Rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    for seed in SEEDS:
        turns = angles_of(draw_of(seed))[: len(axes)]
        found = sequence(axes)(turns)
        letters = "".join("XYZ"[int(a) - 1] for a in axes)
        wanted = Rotation.from_euler(letters, [radians(a) for a in turns])
        assert close(start(found.matrix), wanted.as_matrix().T)
        w, x, y, z = (float(q.coefficients[0]) for q in found.quaternion)
        assert close(Rotation.from_quat([x, y, z, w]).as_matrix(), wanted.as_matrix())


def test_turns_about_an_axis_are_those_of_scipy():
    Rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    for seed in SEEDS:
        found = about_axis(angles_of(draw_of(seed)))
        axis = [float(a.coefficients[0]) for a in found.axis]
        wanted = Rotation.from_rotvec([radians(found.angle) * a for a in axis])
        assert close(start(found.matrix), wanted.as_matrix().T)
        w, x, y, z = (float(q.coefficients[0]) for q in found.quaternion)
        sine = math.sin(radians(found.angle) / 2)
        wanted = [math.cos(radians(found.angle) / 2), *(sine * a for a in axis)]
        assert close([[w, x, y, z]], [wanted])


@pytest.mark.parametrize("seed", SEEDS)
def test_a_rotation_and_the_one_back_are_none(seed):
    draw = draw_of(seed)
    there = composed(any_turn(draw), any_turn(draw, sequence("213")))
    both = composed(there, reversed_(there))
    values = [1, 0, 0, 0]
    assert all(
        q.coefficients == series.constant(q.field, v, len(q.coefficients)).coefficients
        for q, v in zip(both.quaternion, values, strict=True)
    )
    assert start(both.matrix) == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


@pytest.mark.parametrize("seed", SEEDS)
def test_matrix_and_quaternion_change_together(seed):
    """At every order: the matrix of the quaternion, with q0 of any sign, is the matrix."""
    draw = draw_of(seed)
    for found in (any_turn(draw), composed(any_turn(draw), any_turn(draw, sequence("321")))):
        q0, *v = found.quaternion
        square = series.dot(v, v)
        skew = series.skew((v[0], v[1], v[2]))
        for i, j in itertools.product(range(3), repeat=2):
            entry = (v[i] * v[j] - q0 * skew[i][j]).scaled(2)
            entry = entry + q0 * q0 - square if i == j else entry
            assert (entry - found.matrix[i][j]).is_zero


def test_what_is_fixed_stays_and_what_is_not_does_not():
    draw = draw_of(1)
    assert all(e.derivative().is_zero for row in fixed_turn(draw).matrix for e in row)
    assert not any(e.derivative().is_zero for row in any_turn(draw).matrix for e in row)


def test_half_angles_are_halves():
    a = angle(Series(Field(0), (2, 3, 5, 7, 1)), 3)
    assert (a.sine - (a.half_sine * a.half_cosine).scaled(2)).is_zero
    assert (a.sine * a.sine + a.cosine * a.cosine).coefficients == (1, 0, 0, 0, 0)
    rate = a.value.derivative()
    assert (a.half_sine.derivative() - (a.half_cosine * rate).scaled(Field(0).of(1, 2))).is_zero


@pytest.mark.parametrize("name", ["sequence_321", "sequence_232"])
def test_both_rotations_of_b_are_made_of_turns(name):
    for w in worlds([name], 3):
        for base in ("I", "A"):
            turn = w.turn("B", base)
            assert turn.axes == SEQUENCES[name]
            assert len(turn.turns) == 3
            entries = zip(turn.matrix, w.rotation("B", base), strict=True)
            assert all((a - b).is_zero for r, s in entries for a, b in zip(r, s, strict=True))
        assert (
            w.turn("A", "I").quaternion[0].coefficients
            != w.turn("B", "I").quaternion[0].coefficients
        )
        back = w.turn("I", "A").quaternion
        assert all(
            (a + b).is_zero for a, b in zip(back[1:], w.turn("A", "I").quaternion[1:], strict=True)
        )


@pytest.mark.parametrize(
    "names", [(), ("rotors",), ("torque_free",), ("spin_312",), ("A_fixed_in_body",)]
)
def test_every_frame_has_a_quaternion(names):
    (w,) = worlds(closure(names), 1)
    for frame, base in itertools.permutations(w.frames, 2):
        q = w.turn(frame, base).quaternion
        total = series.total([x * x for x in q])
        assert (total - series.constant(w.field, 1, len(total.coefficients))).is_zero
