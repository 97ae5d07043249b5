"""Which sequence, which angles, which quaternion a matrix is of."""

import itertools

import pytest
import sympy as sp

from eom.errors import InputError
from eom.exact.identity import vanishes
from eom.kinematics.coordinates import SEQUENCES, elementary, quaternion, rotation_sequence
from eom.mechanics.recognition import recognise
from tests.eom.rows import every

a, b, c = sp.symbols("a b c", real=True)


def matrix_of(reading):
    product = sp.eye(3)
    for axis, angle in zip(reading.axes, reading.angles, strict=True):
        product = elementary(axis, angle) * product
    return product.T if reading.transposed else product


@pytest.mark.parametrize("name", every(4, SEQUENCES))
@pytest.mark.parametrize("transposed", [False, True])
def test_every_sequence_is_reported_and_its_transpose(name, transposed):
    C = rotation_sequence(name, (a, b, c)).matrix
    first, *others = recognise((C.T if transposed else C).tolist())
    words = f"a {name} sequence with angles a, b, c"
    assert str(first) == ("the transpose of " + words if transposed else words)
    for reading in others:
        again = matrix_of(reading)
        assert all(vanishes(x - y) for x, y in zip(again, C.T if transposed else C, strict=True))


def test_other_spellings_and_letters_of_the_same_matrix():
    C = rotation_sequence("3-1-3", (c, b, a)).matrix
    written = C.applyfunc(lambda e: sp.expand_trig(sp.fu(e)))
    assert str(recognise(written.tolist())[0]) == "a 3-1-3 sequence with angles c, b, a"


def test_right_angles_and_signs():
    C = rotation_sequence("3-2-1", (a + sp.pi / 2, -b, c)).matrix
    assert "a 3-2-1 sequence with angles a + pi/2, -b, c" in map(str, recognise(C.tolist()))


def test_single_turns_and_the_unit_matrix():
    assert str(recognise(elementary(2, a).tolist())[0]) == "a turn about axis 2 by a"
    assert str(recognise(sp.eye(3).tolist())[0]) == "the unit matrix"
    assert str(recognise([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])[0]) == "a turn about axis 3 by 90 deg"


def test_numbers_have_degrees():
    C = rotation_sequence("3-1-2", [sp.rad(d) for d in (20, -35, 50)]).matrix.evalf()
    assert str(recognise(C.tolist())[0]) == "a 3-1-2 sequence with angles 20 deg, -35 deg, 50 deg"
    assert len(recognise(C.tolist())) == 24


def test_quaternions_whichever_way_they_are_numbered():
    q = quaternion()
    for order, transposed in itertools.product(itertools.permutations(q.symbols), (False, True)):
        C = q.matrix.xreplace(dict(zip(q.symbols, order, strict=True)))
        (found,) = recognise((C.T if transposed else C).tolist())
        scalar, *vector = order
        shown = ", ".join(f"{'-' * transposed}{s}" for s in vector)
        assert str(found) == f"the unit quaternion with scalar part {scalar}, vector part {shown}"


def test_a_quaternion_whose_norm_is_used():
    q0, q1, q2, q3 = quaternion().symbols
    C = quaternion().matrix.as_mutable()
    for k, (one, two) in enumerate(((q2, q3), (q1, q3), (q1, q2))):
        C[k, k] = 1 - 2 * (one**2 + two**2)
    (found,) = recognise(C.tolist())
    assert found.components == (q0, q1, q2, q3)


@pytest.mark.parametrize("place", list(itertools.product(range(3), range(3))))
def test_a_wrong_sign_is_found(place):
    C = rotation_sequence("3-1-2", (a, b, c)).matrix.as_mutable()
    if C[place] == 0:
        return
    C[place] *= -1
    with pytest.raises(InputError, match=f"row {place[0] + 1}, column {place[1] + 1}"):
        recognise(C.tolist())


REFUSED = {
    "reflection": ([[1, 0, 0], [0, 1, 0], [0, 0, -1]], "reflection"),
    "not unit": ([[2, 0, 0], [0, 1, 0], [0, 0, 1]], "not orthonormal"),
    "stretched by a symbol": ([[a, 0, 0], [0, 1, 0], [0, 0, 1]], "not orthonormal"),
    "two by two": ([[1, 0], [0, 1]], "three rows"),
    "complex": ([[sp.I, 0, 0], [0, 1, 0], [0, 0, 1]], "no real number"),
    "symbols": ([[sp.cos(sum(sp.symbols("k:6"))), 0, 0], [0, 1, 0], [0, 0, 1]], "too many symbols"),
}


@pytest.mark.parametrize(("rows", "words"), REFUSED.values(), ids=REFUSED)
def test_refusals(rows, words):
    with pytest.raises(InputError, match=words):
        recognise(rows)
