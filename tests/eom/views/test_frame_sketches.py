"""Frames after turns, arcs between their axes, the wheel, and from where they are seen."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.kinematics.coordinates import SEQUENCES, quaternion_of_sequence
from eom.rotations import matrix_of_quaternion
from eom.scenes.scene import Scene
from eom.views.body.frame_sketches import (
    ANGLES,
    after_turns,
    arc_points,
    elementary,
    frame_sketch,
    frames_of,
    sequence_of,
    wheel,
    wheel_of,
)
from eom.views.draw.picture import Arrow, Curve, Words
from eom.views.draw.viewpoint import line_of_sight
from tests.draws import examples

angles = st.tuples(*[st.floats(-3.1, 3.1)] * 3)
sequences = st.sampled_from(SEQUENCES)


def space(picture):
    return picture.rows[0][0]


def arcs(panel):
    return [i.points for i in panel.items if isinstance(i, Curve) and i.width == 1.6]


def labels(panel):
    return [
        i.words.strip("$").split(" = ") for i in panel.items if isinstance(i, Arrow) and i.words
    ]


@given(sequences, angles)
def test_the_last_frame_is_the_bodys(sequence, chosen):
    expected = matrix_of_quaternion(quaternion_of_sequence(sequence, chosen))
    np.testing.assert_allclose(after_turns(sequence, chosen)[-1], expected, atol=1e-14)


@given(st.sampled_from([1, 2, 3]), st.floats(-6.0, 6.0))
def test_each_turn_leaves_its_axis_and_is_by_the_right_hand(axis, angle):
    C = elementary(axis, angle)
    a, b = np.eye(3)[axis % 3], np.eye(3)[(axis + 1) % 3]
    np.testing.assert_allclose(C[axis - 1], np.eye(3)[axis - 1], atol=0)
    np.testing.assert_allclose(C[axis % 3], math.cos(angle) * a + math.sin(angle) * b, atol=1e-15)


@examples(40)
@given(sequences, angles)
def test_each_arc_lies_across_its_axis_and_joins_the_axis_that_it_turns(sequence, chosen):
    frames, turned = frames_of(sequence, chosen), [int(k) for k in sequence.split("-")]
    found = arcs(space(frame_sketch(sequence, chosen)))
    assert len(found) == 3
    for k, (arc, axis, angle) in enumerate(zip(found, turned, chosen, strict=True)):
        about = frames[k].axis(axis)
        np.testing.assert_allclose(arc @ about, 0, atol=1e-14)
        radius = np.linalg.norm(arc[0])
        np.testing.assert_allclose(np.linalg.norm(arc, axis=1), radius)
        first, last = arc[0] / radius, arc[-1] / radius
        moved = [n for n in (1, 2, 3) if first @ frames[k].axis(n) > 1 - 1e-12]
        assert len(moved) == 1
        np.testing.assert_allclose(last, frames[k + 1].axis(moved[0]), atol=1e-12)
        steps = np.einsum(
            "ij,ij->i", np.cross(arc[:-1], arc[1:]), about[None].repeat(len(arc) - 1, 0)
        )
        assert np.all(np.sign(steps) * np.sign(angle) >= 0)


@examples(40)
@given(sequences, st.tuples(*[st.sampled_from([0.0, 0.4, math.pi / 2, -1.0])] * 3))
def test_every_axis_of_every_frame_is_named_once(sequence, chosen):
    panel = space(frame_sketch(sequence, chosen))
    named = [label for group in labels(panel) for label in group]
    expected = {f.label(k) for f in frames_of(sequence, chosen) for k in (1, 2, 3)}
    assert len(named) == 12
    assert set(named) == expected
    letters = [i.text for i in panel.items if isinstance(i, Words)]
    assert letters == [r"$\psi$", r"$\theta$", r"$\phi$"]


def test_frames_without_turns_are_one():
    assert sorted(map(len, labels(space(frame_sketch("3-2-1", (0, 0, 0)))))) == [4, 4, 4]


@given(sequences, angles)
@examples(30)
def test_seen_along_its_axis_a_positive_turn_is_anticlockwise(sequence, chosen):
    for panel, angle in zip(frame_sketch(sequence, chosen).rows[1], chosen, strict=True):
        old, _, new, _ = (i.end for i in panel.items if isinstance(i, Arrow) and i.words)
        np.testing.assert_allclose(old, [1, 0], atol=1e-14)
        np.testing.assert_allclose(new, [math.cos(angle), math.sin(angle)], atol=1e-14)
        assert f"{math.degrees(angle):.4g}" in panel.title


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_the_arcs_are_seen_open_and_names_apart(sequence):
    panel = space(frame_sketch(sequence))
    sight = line_of_sight(panel.view)
    axes = [
        f.axis(int(k))
        for f, k in zip(frames_of(sequence, ANGLES), sequence.split("-"), strict=False)
    ]
    assert min(abs(axis @ sight) for axis in axes) > 0.35
    tips = np.array([i.end for i in panel.items if isinstance(i, Arrow) and i.words])
    flat = tips - np.outer(tips @ sight, sight)
    distances = np.linalg.norm(flat[:, None] - flat, axis=-1) + 10 * np.eye(len(flat))
    assert distances.min() > 0.2


@examples(30)
@given(angles)
def test_the_wheels_arcs_join_i_to_a_to_b_to_c(chosen):
    i, a, b, c = after_turns("3-1-2", chosen)
    found = [arc / np.linalg.norm(arc[0]) for arc in arcs(space(wheel(chosen)))]
    for arc, axis, first, last in zip(
        found, (i[2], a[0], b[1]), (i[0], a[1], b[0]), (a[0], b[1], c[0]), strict=True
    ):
        np.testing.assert_allclose(arc @ axis, 0, atol=1e-14)
        np.testing.assert_allclose(arc[[0, -1]], [first, last], atol=1e-13)


def test_the_wheel_of_a_scene_is_that_of_its_run():
    scene = Scene.ready("lecture-wheel")
    start = wheel_of(scene, 1e-6)
    assert "theta = 5.73 degrees" in start.caption
    assert wheel_of(scene).caption == wheel().caption
    with pytest.raises(InputError, match="spinner"):
        wheel_of(Scene.ready("heavy-top"), 1.0)


def test_sequences_of_scenes():
    names = ("lecture-wheel", "t-handle-in-angles", "heavy-top")
    assert [sequence_of(Scene.ready(n)) for n in names] == ["3-1-2", "3-2-1", ""]


@pytest.mark.parametrize(
    ("sequence", "chosen"),
    [
        ("3-3-1", ANGLES),
        ("3-1-2", (math.nan, 0, 0)),
        ("3-1-2", (0, 0)),
        ("3-1-2", (0, math.inf, 0)),
    ],
)
def test_what_is_no_sequence_of_three_angles_is_refused(sequence, chosen):
    with pytest.raises(InputError):
        frame_sketch(sequence, chosen)
    if sequence == "3-1-2":
        with pytest.raises(InputError):
            wheel(chosen)


def test_an_arc_leaves_out_what_is_along_its_axis():
    found = arc_points(np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 5.0]), math.pi / 2)
    np.testing.assert_allclose(found[[0, -1]], [[1, 0, 0], [0, 1, 0]], atol=1e-15)
