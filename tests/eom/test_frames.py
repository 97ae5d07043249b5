"""Vectors and rotations that know their frames."""

from __future__ import annotations

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.kinematics.coordinates import elementary
from eom.kinematics.frames import Rotation, tilde, unit_vector, vector
from tests.draws import examples

numbers = st.integers(-99, 99)
triples = st.tuples(numbers, numbers, numbers)


@examples(40)
@given(a=triples, b=triples)
def test_products_are_those_of_sympy_matrices(a, b):
    va, vb = vector("B", a), vector("B", b)
    assert va.cross(vb).column == sp.Matrix(a).cross(sp.Matrix(b))
    assert va.dot(vb) == sp.Matrix(a).dot(sp.Matrix(b))
    assert (va + vb).column == sp.Matrix(a) + sp.Matrix(b)
    assert (va - vb).column == sp.Matrix(a) - sp.Matrix(b)
    assert tilde(a) * sp.Matrix(b) == sp.Matrix(a).cross(sp.Matrix(b))
    assert va.scaled(3).column == 3 * sp.Matrix(a)


def test_tilde_is_skew_as_printed_in_the_lecture():
    """Lecture 000: rows (0, -a3, a2), (a3, 0, -a1), (-a2, a1, 0)."""
    a1, a2, a3 = sp.symbols("a1:4")
    assert sp.Matrix(tilde((a1, a2, a3))) == sp.Matrix([[0, -a3, a2], [a3, 0, -a1], [-a2, a1, 0]])


def test_unit_vectors_are_right_handed():
    e1, e2, e3 = (unit_vector("B", k) for k in (1, 2, 3))
    assert e1.cross(e2) == e3
    assert e2.cross(e3) == e1
    assert e3.cross(e1) == e2


@pytest.mark.parametrize("operation", ["dot", "cross", "__add__", "__sub__"])
def test_vectors_in_different_frames_do_not_mix(operation):
    with pytest.raises(InputError, match="in A and in B") as caught:
        getattr(unit_vector("A", 1), operation)(unit_vector("B", 1))
    assert "Rotation" in caught.value.hint


def test_rotations_chain_and_invert():
    a, b = sp.symbols("a b", real=True)
    C_BA, C_CB = Rotation("B", "A", elementary(3, a)), Rotation("C", "B", elementary(3, b))
    C_CA = C_CB @ C_BA
    assert (C_CA.to_frame, C_CA.from_frame) == ("C", "A")
    assert sp.simplify(sp.Matrix(C_CA.matrix) - sp.Matrix(elementary(3, a + b))) == sp.zeros(3)
    back = C_BA.inverse.apply(C_BA.apply(unit_vector("A", 1)))
    assert back.frame == "A"
    assert sp.simplify(back.column) == sp.Matrix([1, 0, 0])


def test_rotations_that_do_not_chain_are_refused():
    C_BA = Rotation("B", "A", elementary(3, sp.Symbol("a")))
    with pytest.raises(InputError, match="do not chain") as caught:
        _ = C_BA @ C_BA
    assert caught.value.got == "C_BA @ C_BA"
    with pytest.raises(InputError, match="takes components in A"):
        C_BA.apply(unit_vector("B", 1))


def test_rows_of_a_rotation_are_the_unit_vectors_of_its_frame():
    C_BA = Rotation("B", "A", elementary(3, sp.Symbol("a", real=True)))
    for k in (1, 2, 3):
        row = C_BA.inverse.apply(unit_vector("B", k)).column.T
        assert sp.Matrix(C_BA.matrix)[k - 1, :] == row


@pytest.mark.parametrize("components", [(1, 2), (1, 2, 3, 4), ()])
def test_three_components_are_needed(components):
    with pytest.raises(ValueError, match="unpack"):
        vector("B", components)
