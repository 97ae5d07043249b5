"""Attitude kinematics against SymPy's vector module, SciPy's rotations and Poisson's equation."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation as SciPyRotation
from sympy.physics.vector import ReferenceFrame, dynamicsymbols

from eom.errors import InputError
from eom.exact.identity import equal
from eom.kinematics import coordinates as kinematics
from eom.kinematics.coordinates import SEQUENCES, attitude, rotation_sequence
from eom.kinematics.frames import tilde, vector
from tests.draws import examples
from tests.eom.rows import every

ANGLES = sp.symbols("psi theta phi", real=True)
W = sp.symbols("w1:4", real=True)
ALL = (*SEQUENCES, "quaternion", "dcm")
angle = st.floats(-10, 10)


def compact(name):
    return name.replace("-", "")


def oriented(name):
    """SymPy's frames N and B for a sequence, with its own functions of time."""
    q = dynamicsymbols("q1:4")
    N, B = ReferenceFrame("N"), ReferenceFrame("B")
    B.orient_body_fixed(N, q, compact(name))
    return N, B, q


def rates_of(chosen, omega=W):
    return chosen.rates(vector("B", omega))


def derivative(matrix, chosen):
    """d(matrix)/dt by the chain rule over the coordinates."""
    symbols = [q.symbol for q in chosen.coordinates]
    rates = rates_of(chosen)
    return matrix.applyfunc(
        lambda e: sp.Add(*(e.diff(s) * r for s, r in zip(symbols, rates, strict=True)))
    )


def unit(components):
    length = math.sqrt(sum(c * c for c in components))
    return [c / length for c in components]


def test_there_are_twelve_sequences_in_which_neighbours_differ():
    expected = {
        f"{i}-{j}-{k}" for i in (1, 2, 3) for j in (1, 2, 3) for k in (1, 2, 3) if i != j != k
    }
    assert set(SEQUENCES) == expected
    assert len(SEQUENCES) == 12


@pytest.mark.parametrize("name", SEQUENCES)
def test_matrix_is_that_of_sympy_frames(name):
    N, B, q = oriented(name)
    expected = B.dcm(N).subs(dict(zip(q, ANGLES, strict=True)))
    found = rotation_sequence(name).matrix
    assert equal(sp.Matrix(found), sp.Matrix(expected))


@pytest.mark.parametrize("name", every(4, SEQUENCES))
@settings(deadline=None, max_examples=10)
@given(angles=st.tuples(angle, angle, angle))
def test_matrix_is_the_transpose_of_scipy_s_intrinsic_rotation(name, angles):
    """SciPy's matrix takes components in B to components in A; upper case means body axes."""
    letters = "".join("XYZ"[int(c) - 1] for c in compact(name))
    expected = SciPyRotation.from_euler(letters, angles).as_matrix().T
    found = rotation_sequence(name).matrix.subs(dict(zip(ANGLES, angles, strict=True)))
    assert np.allclose(np.array(found, dtype=float), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", SEQUENCES)
def test_angular_velocity_is_that_of_sympy_frames(name):
    N, B, q = oriented(name)
    t = dynamicsymbols._t
    rates = sp.symbols("r1:4", real=True)
    plain = {**dict(zip([x.diff(t) for x in q], rates, strict=True))}
    place = dict(zip(q, ANGLES, strict=True))
    expected = B.ang_vel_in(N).to_matrix(B).subs(plain).subs(place)
    found = rotation_sequence(name).angular_velocity(rates)
    assert found.frame == "B"
    assert equal(sp.Matrix(found.components), sp.Matrix(expected))


@pytest.mark.parametrize("name", every(4, SEQUENCES))
def test_rates_are_the_kinematic_equations_of_sympy(name):
    from sympy.physics.vector import kinematic_equations

    t = dynamicsymbols._t
    q, u = dynamicsymbols("q1:4"), dynamicsymbols("u1:4")
    residuals = kinematic_equations(u, q, "body", compact(name))
    solution = sp.solve(residuals, [x.diff(t) for x in q], dict=True)[0]
    plain = dict(zip([*q, *u], [*ANGLES, *W], strict=True))
    for x, rate in zip(q, rates_of(rotation_sequence(name)), strict=True):
        assert equal(rate, solution[x.diff(t)].subs(plain))


@pytest.mark.parametrize("name", ALL)
def test_rates_satisfy_poisson_s_equation(name):
    """For a quaternion this holds whatever its norm, as both sides are quadratic in it."""
    chosen = attitude(name)
    C = sp.Matrix(chosen.matrix)
    assert equal(derivative(C, chosen), -sp.Matrix(tilde(W)) * C)


@pytest.mark.parametrize("name", SEQUENCES)
def test_rates_invert_the_angular_velocity(name):
    chosen = rotation_sequence(name)
    back = chosen.angular_velocity(rates_of(chosen))
    assert all(equal(a, b) for a, b in zip(back.components, W, strict=True))


@pytest.mark.parametrize("name", SEQUENCES)
def test_singular_exactly_where_the_turn_axes_are_dependent(name):
    """The singularity and the determinant of the rates differ by a sign at most."""
    chosen = rotation_sequence(name)
    (singularity,) = chosen.singularities
    rates = sp.symbols("r1:4", real=True)
    columns = sp.Matrix(chosen.angular_velocity(rates).components).jacobian(rates)
    determinant = columns.det(method="berkowitz")
    assert equal(determinant, singularity.expression) or equal(determinant, -singularity.expression)
    assert singularity.coordinate == ANGLES[1]
    proper = compact(name)[0] == compact(name)[2]
    roots, regular = (0, sp.pi), (sp.pi / 2, sp.Integer(1))
    if not proper:
        roots, regular = (sp.pi / 2, -sp.pi / 2), (sp.Integer(0), sp.Integer(1))
    assert all(singularity.expression.subs(ANGLES[1], a) == 0 for a in roots)
    assert all(singularity.expression.subs(ANGLES[1], a) != 0 for a in regular)


@pytest.mark.parametrize("name", SEQUENCES)
def test_rates_are_poles_at_the_singularity_and_nowhere_else(name):
    chosen = rotation_sequence(name)
    denominators = {sp.fraction(sp.together(r))[1] for r in rates_of(chosen)} - {1}
    (singularity,) = chosen.singularities
    assert denominators
    for d in denominators:
        assert d.free_symbols == {ANGLES[1]}
        assert equal(d, singularity.expression) or equal(d, -singularity.expression)


@pytest.mark.parametrize("name", SEQUENCES)
def test_matrix_is_a_proper_rotation(name):
    C = sp.Matrix(rotation_sequence(name).matrix)
    assert equal(C * C.T, sp.eye(3))
    assert equal(C.det(method="berkowitz"), sp.Integer(1))


def test_elementary_matrices_as_printed():
    """Diebel, Representing Attitude (2006), eq. 9-11; lecture 001 for the first axis."""
    x = ANGLES[0]
    c, s = sp.cos(x), sp.sin(x)
    expected = {
        1: [[1, 0, 0], [0, c, s], [0, -s, c]],
        2: [[c, 0, -s], [0, 1, 0], [s, 0, c]],
        3: [[c, s, 0], [-s, c, 0], [0, 0, 1]],
    }
    for axis, rows in expected.items():
        assert sp.Matrix(kinematics.elementary(axis, x)) == sp.Matrix(rows)


def test_quaternion_matrix_is_that_of_sympy_frames():
    q = dynamicsymbols("q0:4")
    N, B = ReferenceFrame("N"), ReferenceFrame("B")
    B.orient_quaternion(N, q)
    chosen = kinematics.quaternion()
    expected = B.dcm(N).subs(dict(zip(q, chosen.symbols, strict=True)))
    assert equal(sp.Matrix(chosen.matrix), sp.Matrix(expected))


@examples(30)
@given(components=st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: math.hypot(*q) > 1e-3))
def test_quaternion_matrix_is_the_transpose_of_scipy_s(components):
    q = unit(components)
    chosen = kinematics.quaternion()
    found = chosen.matrix.subs(dict(zip(chosen.symbols, q, strict=True)))
    expected = SciPyRotation.from_quat(q, scalar_first=True).as_matrix().T
    assert np.allclose(np.array(found, dtype=float), expected, rtol=0, atol=1e-14)


def test_quaternion_rates_are_those_of_sympy():
    from sympy.physics.vector import kinematic_equations

    t = dynamicsymbols._t
    q, u = dynamicsymbols("q0:4"), dynamicsymbols("u1:4")
    residuals = kinematic_equations(u, q, "quaternion")
    chosen = kinematics.quaternion()
    plain = dict(zip([*q, *u], [*chosen.symbols, *W], strict=True))
    solution = sp.solve(residuals, [x.diff(t) for x in q], dict=True)[0]
    norm = sum(s**2 for s in chosen.symbols)
    for x, rate in zip(q, rates_of(chosen), strict=True):
        expected = solution[x.diff(t)].subs(plain)
        found = sp.together(expected - rate)
        residue = sp.fraction(found)[0]
        assert equal(sp.rem(residue, norm - 1, chosen.symbols[0]), sp.Integer(0))


@pytest.mark.parametrize("name", ["quaternion", "dcm"])
def test_constraints_are_constant_and_true_of_the_identity(name):
    chosen = attitude(name)
    symbols = [q.symbol for q in chosen.coordinates]
    still = {"quaternion": [1, 0, 0, 0], "dcm": list(sp.eye(3))}[name]
    at_rest = dict(zip(symbols, still, strict=True))
    for constraint, _, expression in chosen.constraints:
        rate = sp.Add(
            *(expression.diff(s) * r for s, r in zip(symbols, rates_of(chosen), strict=True))
        )
        if name == "quaternion":
            assert equal(rate, sp.Integer(0))
        else:
            # columns of C: d(C^T C)/dt = -C^T tilde(w) C + C^T tilde(w) C = 0
            assert sp.expand(rate) == 0
        expected = 0 if name == "dcm" and constraint[-1] != constraint[-2] else 1
        assert expression.subs(at_rest) == expected


def test_dcm_has_all_six_constraints_and_the_quaternion_one():
    assert len(attitude("dcm").constraints) == 6
    assert len(attitude("quaternion").constraints) == 1
    assert attitude("3-1-2").constraints == ()


def test_quaternion_and_dcm_have_no_singularity():
    assert attitude("quaternion").singularities == ()
    assert attitude("dcm").singularities == ()


@pytest.mark.parametrize("name", SEQUENCES)
@settings(deadline=None, max_examples=10)
@given(angles=st.tuples(angle, angle, angle))
def test_quaternion_of_a_sequence_is_scipy_s(name, angles):
    letters = "".join("XYZ"[int(c) - 1] for c in compact(name))
    expected = SciPyRotation.from_euler(letters, angles).as_quat(scalar_first=True)
    found = np.array(kinematics.quaternion_of_sequence(name, angles))
    sign = 1 if found @ expected > 0 else -1
    assert np.allclose(found, sign * expected, rtol=0, atol=1e-14)


def test_coordinates_have_names_units_and_places():
    chosen = attitude("3-1-2")
    assert [q.name for q in chosen.coordinates] == ["psi", "theta", "phi"]
    assert [q.meaning for q in chosen.coordinates] == [
        "first angle, about axis 3",
        "second angle, about axis 1",
        "third angle, about axis 2",
    ]
    assert [q.name for q in attitude("quaternion").coordinates] == ["q0", "q1", "q2", "q3"]
    names = [q.name for q in attitude("dcm").coordinates]
    assert names == [f"C{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]
    assert {q.unit for q in attitude("dcm").coordinates} == {"1"}


@pytest.mark.parametrize("name", ALL)
def test_name_is_how_users_ask_for_it(name):
    assert attitude(name).name == name
    assert len(rates_of(attitude(name))) == len(attitude(name).coordinates)


@pytest.mark.parametrize(
    ("bad", "hint"),
    [("3-1-1", "3-1"), ("312", "3-1-2"), ("quaternio", "quaternion"), ("", ""), ("3-1-4", "3-1-2")],
)
def test_unknown_names_are_refused(bad, hint):
    with pytest.raises(InputError, match="unknown attitude") as caught:
        attitude(bad)
    assert hint in caught.value.hint
    assert "quaternion" in caught.value.expected
    assert "3-1-2" in caught.value.expected
    with pytest.raises(InputError, match="unknown rotation sequence"):
        rotation_sequence(bad)
