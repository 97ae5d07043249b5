"""Assumptions are tested on numbers: what contradicts them is refused, and what does not is not."""

import math

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import eom
from codegen.frontend.structure import Guard
from eom.errors import AssumptionError, InputError
from eom.quantities import Assumption, Quantity
from eom.system import System

BODY = Guard.of(eom.free_rigid_body())
moment = st.floats(1e-6, 1e6)


@given(moment, moment, moment)
def test_moments_pass_exactly_where_the_triangle_inequality_holds(a, b, c):
    values = {"I1": a, "I2": b, "I3": c}
    gap = min(a + b - c, b + c - a, c + a - b) / max(a, b, c)
    if gap > 1e-8:
        BODY.check(values)
    elif gap < -1e-8:
        with pytest.raises(AssumptionError, match="physical_inertia"):
            BODY.check(values)


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_rounding_is_forgiven_at_every_scale(scale):
    BODY.check({"I1": 0.1 * scale, "I2": 0.2 * scale, "I3": (0.1 + 0.2) * scale})
    with pytest.raises(AssumptionError):
        BODY.check({"I1": 0.1 * scale, "I2": 0.2 * scale, "I3": 0.300001 * scale})


@pytest.mark.parametrize("value", [0.0, -0.0, -1.0, math.nan, -math.inf])
def test_what_must_be_positive_is(value):
    with pytest.raises(InputError, match="I2 is not positive") as error:
        BODY.check({"I2": value})
    assert "principal moment of inertia about b2" in error.value.where


def test_conditions_wait_for_all_their_values():
    BODY.check({"I1": 1.0, "I3": 100.0})
    BODY.check({})


def test_unknown_names_are_refused_with_a_near_match():
    with pytest.raises(InputError, match="unknown name 'omega1'") as error:
        BODY.check({"omega1": 1.0})
    assert "omega_1" in error.value.hint


def test_a_value_that_must_vanish_has_no_slack_of_its_own():
    with pytest.raises(AssumptionError, match="principal_axes"):
        BODY.check({"J12": 1e-300})
    BODY.check({"J12": 0.0, "J23": -0.0})


def test_nan_contradicts_every_condition():
    with pytest.raises(AssumptionError):
        BODY.check({"J12": math.nan})


def test_the_spinner_is_flat_at_most():
    guard = Guard.of(eom.lecture_torque().system())
    guard.check({"I1": 1.0, "I2": 2.0})
    with pytest.raises(AssumptionError) as error:
        guard.check({"I1": 1.0, "I2": 2.1})
    assert "I2 does not exceed 2 I1" in str(error.value)
    guard.check({"I1": 1.0, "I3": 1.0})
    with pytest.raises(AssumptionError, match="symmetric"):
        guard.check({"I1": 1.0, "I3": 1.1})


def test_assumptions_without_conditions_say_nothing():
    x = sp.Symbol("x", real=True)
    system = System(
        "plain", (Quantity(x),), (-x,),
        assumptions=(Assumption("rigid", "words"), Assumption("true", "zero", vanish=(sp.Integer(0),))),
    )  # fmt: skip
    guard = Guard.of(system)
    assert guard.conditions == ()
    guard.check({"x": 1e300})
