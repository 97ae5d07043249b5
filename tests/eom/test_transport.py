"""The transport theorem against differentiation of components in the inertial frame."""

from __future__ import annotations

import pytest
import sympy as sp
from sympy.physics.vector import ReferenceFrame, dynamicsymbols

from eom.exact.identity import equal
from eom.kinematics.coordinates import rotation_sequence
from eom.kinematics.frames import (
    first_derivative,
    local_derivative,
    second_derivative,
    time_derivative,
    vector,
)

T = sp.Symbol("t", real=True)
V = sp.symbols("v1:4", real=True)
VD = sp.symbols("vd1:4", real=True)
VDD = sp.symbols("vdd1:4", real=True)
W = sp.symbols("w1:4", real=True)
WD = sp.symbols("wd1:4", real=True)
RATES = {
    **dict(zip(V, VD, strict=True)),
    **dict(zip(VD, VDD, strict=True)),
    **dict(zip(W, WD, strict=True)),
}
# Any smooth motion: components and angles as functions of time.
MOTION = [T**2 + 1, sp.sin(T), sp.cos(2 * T) * T]
ANGLES = [T**2, 1 + T / 2, sp.sin(T) / 3]


def along(name):
    """C_BA(t), omega(t) in B, and the values of the plain symbols along the motion."""
    sequence = rotation_sequence(name)
    place = dict(zip(sequence.angles, ANGLES, strict=True))
    C = sp.Matrix(sequence.matrix).subs(place)
    rates = [a.diff(T) for a in ANGLES]
    omega = sp.Matrix(sequence.angular_velocity(rates).components).subs(place)
    values = dict(zip(V, MOTION, strict=True))
    values |= {d: x.diff(T) for d, x in zip(VD, MOTION, strict=True)}
    values |= {d: x.diff(T, 2) for d, x in zip(VDD, MOTION, strict=True)}
    values |= dict(zip(W, omega, strict=True))
    values |= {d: x.diff(T) for d, x in zip(WD, omega, strict=True)}
    return C, values


def close(left, right):
    difference = (sp.Matrix(left) - sp.Matrix(right)).subs(T, sp.Rational(7, 10)).evalf(40)
    return all(abs(d) < sp.Float("1e-30") for d in difference)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["3-1-2", "2-3-2", "1-2-3"])
def test_derivatives_are_those_taken_in_the_inertial_frame(name):
    C, values = along(name)
    v, omega = vector("B", V), vector("B", W)
    inertial = C.T * sp.Matrix(MOTION)
    first = first_derivative(v, omega, RATES).total
    second = second_derivative(v, omega, RATES).total
    assert first.frame == second.frame == "B"
    assert close(first.column.subs(values), C * inertial.diff(T))
    assert close(second.column.subs(values), C * inertial.diff(T, 2))


def test_terms_carry_their_names():
    v, omega = sp.Matrix(V), sp.Matrix(W)
    terms = second_derivative(vector("B", V), vector("B", W), RATES)
    assert terms.local.column == sp.Matrix(VDD)
    assert equal(terms.coriolis.column, 2 * omega.cross(sp.Matrix(VD)))
    assert equal(terms.euler.column, sp.Matrix(WD).cross(v))
    assert equal(terms.centripetal.column, omega.cross(omega.cross(v)))
    first = first_derivative(vector("B", V), vector("B", W), RATES)
    assert first.local.column == sp.Matrix(VD)
    assert equal(first.rotation.column, omega.cross(v))


def test_derivatives_are_those_of_sympy_frames():
    t = dynamicsymbols._t
    q, x = dynamicsymbols("q1:4"), dynamicsymbols("x1:4")
    N, B = ReferenceFrame("N"), ReferenceFrame("B")
    B.orient_body_fixed(N, q, "312")
    position = x[0] * B.x + x[1] * B.y + x[2] * B.z
    omega = B.ang_vel_in(N)
    expected = position.dt(N).dt(N).to_matrix(B)
    w = omega.to_matrix(B)
    values = dict(zip(V, x, strict=True)) | dict(zip(W, w, strict=True))
    values |= {d: e.diff(t) for d, e in zip(VD, x, strict=True)}
    values |= {d: e.diff(t, 2) for d, e in zip(VDD, x, strict=True)}
    values |= {d: e.diff(t) for d, e in zip(WD, w, strict=True)}
    found = second_derivative(vector("B", V), vector("B", W), RATES).total.column.subs(values)
    plain = {e.diff(t, k): sp.Symbol(f"s{j}_{k}") for k in (2, 1) for j, e in enumerate([*q, *x])}
    plain |= {e: sp.Symbol(f"s{j}_0") for j, e in enumerate([*q, *x])}
    assert equal(found.subs(plain), expected.subs(plain))


def test_circular_motion_has_the_centripetal_term_alone():
    terms = second_derivative(vector("B", (5, 0, 0)), vector("B", (0, 0, 2)), {})
    assert terms.total.components == (-20, 0, 0)
    assert terms.centripetal.components == (-20, 0, 0)


def test_time_derivative_is_the_chain_rule():
    a, b = sp.symbols("a b")
    f = a**2 * sp.sin(b) + T * a
    assert equal(time_derivative(f, {a: b}), 2 * a * sp.sin(b) * b + T * b)
    assert equal(time_derivative(f, {a: b}, T), 2 * a * sp.sin(b) * b + T * b + a)
    assert time_derivative(7, {a: b}) == 0
    assert local_derivative(vector("B", (a, b, 1)), {a: 3}).components == (3, 0, 0)


def test_frames_of_vector_and_angular_velocity_must_agree():
    from eom.errors import InputError

    with pytest.raises(InputError, match="different frames"):
        first_derivative(vector("A", V), vector("B", W), RATES)
