"""What systems state of their bodies: true of what is derived, refused where it is not so, and kept."""

from dataclasses import replace

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import eom
from eom import proof
from eom.errors import InputError
from eom.kinematics.coordinates import SEQUENCES, attitude
from eom.mechanics import torques
from eom.mechanics.dissipation import viscous_slug
from eom.mechanics.gyrostat import gyrostat
from eom.mechanics.rigidbody import full_inertia, rigid_body
from eom.quantities import TIME
from eom.scenes import reduce
from eom.structure import form_of
from eom.system import BodyAttitude, System
from tests.eom.rows import every

KINDS = ("quaternion", "dcm", *SEQUENCES)
w = sp.symbols("omega_1:4", real=True)
q = sp.symbols("q0:4", real=True)
FREE = eom.free_rigid_body("quaternion")
(BODY,) = FREE.attitudes


@pytest.mark.parametrize("kind", every(4, KINDS))
@pytest.mark.parametrize("derive", [eom.heavy_top, eom.gravity_gradient_satellite])
def test_every_attitude_is_stated_of_derived_bodies(derive, kind):
    (stated,) = derive(kind).attitudes
    assert stated.kind == kind
    assert stated.omega == w
    assert stated.turns == (derive is eom.gravity_gradient_satellite)
    assert stated.inertia == sp.diag(*sp.symbols("I1:4", positive=True))


DERIVED = {
    "full inertia": lambda: rigid_body(
        full_inertia(), lambda C, J: torques.weight(C), attitude("dcm")
    ),
    "wheels": lambda: gyrostat(2, drives=["motor", "constant"], attitude=attitude("quaternion")),
    "slanted wheel": lambda: gyrostat(
        axes=[(sp.Rational(3, 5), 0, sp.Rational(4, 5))], drives="free"
    ),
    "slug": lambda: viscous_slug(attitude("3-1-3")),
    "spinner": lambda: eom.lecture_torque().system(),
    "orbit": lambda: eom.gravity_gradient_satellite("dcm"),
}


@pytest.mark.parametrize("name", every(2, DERIVED))
def test_a_slip_in_any_entry_is_refused(name):
    """Every number that a statement is made of matters: one added to it is seen."""
    system = DERIVED[name]()
    (stated,) = system.attitudes
    slips = [replace(stated, omega=_plus(stated.omega, k)) for k in range(3)]
    slips += [replace(stated, torque=_plus(stated.torque, k)) for k in range(3)]
    slips += [replace(stated, inertia=stated.inertia + sp.diag(*row)) for row in sp.eye(3).tolist()]
    if stated.kind != "none":
        slips += [replace(stated, frame_rate=_plus(stated.frame_rate, k)) for k in range(3)]
        turned = stated.coordinates[1:] + stated.coordinates[:1]
        slips += [replace(stated, coordinates=turned)]
    for wrong in slips:
        with pytest.raises(InputError, match="stated, but not so"):
            replace(system, attitudes=(wrong,))


def _plus(values, k):
    return tuple(v + int(i == k) for i, v in enumerate(values))


@given(st.integers(-300, 300), st.sampled_from(range(7)))
def test_a_term_of_any_size_in_any_rate_is_refused(exponent, place):
    late = sp.Rational(10) ** exponent * sp.exp(-((TIME - 20) ** 2))
    rates = [r + late * int(k == place) for k, r in enumerate(FREE.rates)]
    with pytest.raises(InputError, match="stated, but not so"):
        replace(FREE, rates=tuple(rates), numbers="values")


@pytest.mark.parametrize("number", [2**61 - 1, 2**521 - 1, 2**607 - 1, 10**18 + 9])
def test_no_prime_that_people_know_hides_a_torque(number):
    rates = (FREE.rates[0] + number * w[1], *FREE.rates[1:])
    with pytest.raises(InputError, match="stated, but not so"):
        replace(FREE, rates=rates, numbers="values")


REFUSED = {
    "unknown kind": ({"kind": "quaternions"}, "unknown kind of attitude"),
    "three of four": ({"coordinates": q[:3]}, "wrong number of coordinates"),
    "one left out": ({"coordinates": (None, *q[1:])}, "coordinates are missing"),
    "no state": ({"coordinates": (*q[:3], sp.Symbol("I1", positive=True))}, "are no states"),
    "torque alone": ({"inertia": None}, "belong together"),
    "not symmetric": ({"inertia": sp.Matrix(3, 3, range(9))}, "not symmetric"),
    "two by two": ({"inertia": sp.eye(2)}, "wrong shape"),
    "unknown symbol": ({"torque": (0, 0, sp.Symbol("tau"))}, "symbol without a meaning"),
    "not fixed": ({"directions": [w]}, "direction fixed in space"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_statements_that_do_not_fit_are_refused(case):
    change, words = REFUSED[case]
    with pytest.raises(InputError, match=words):
        replace(FREE, attitudes=(replace(BODY, **change),))


def test_text_is_no_statement():
    with pytest.raises(InputError, match="not a number or a SymPy expression"):
        BodyAttitude(("omega_1", "omega_2", "omega_3"))
    with pytest.raises(InputError, match="three components"):
        BodyAttitude(w[:2])


# --- passes -------------------------------------------------------------------------------------


def test_a_constant_rate_becomes_a_parameter_of_the_statement():
    system = eom.Scene.ready("heavy-top").derive()
    (stated,) = system.attitudes
    assert "omega_3" in system.parameter_names
    assert stated.omega == w
    assert stated.inertia[1, 1] == stated.inertia[0, 0] == sp.Symbol("I1", positive=True)


def test_columns_of_direction_cosines_stay_and_parts_of_quaternions_do_not():
    top = eom.heavy_top("dcm")
    (stated,) = reduce.prune(top, ["omega_1"]).attitudes
    there = [k for k, c in enumerate(stated.coordinates) if c is not None]
    assert there == [2, 5, 8]
    (bare,) = reduce.prune(eom.free_rigid_body("quaternion"), ["omega_1"]).attitudes
    assert (bare.kind, bare.coordinates, bare.inertia) == ("none", (), BODY.inertia)


def test_a_cyclic_angle_may_be_left_out():
    (stated,) = reduce.prune(eom.heavy_top("3-1-3"), ["theta"]).attitudes
    assert stated.coordinates == (None, *sp.symbols("theta phi", real=True))
    (tilt,) = reduce.prune(eom.SpinningSymmetricBody((0, 0, 0)).system(), ["theta"]).attitudes
    assert tilt.coordinates == (None, sp.Symbol("theta", real=True), None)
    assert tilt.unspun


def test_passes_that_leave_the_motion_alone_prove_nothing_again(monkeypatch):
    system = eom.free_rigid_body("3-2-1")
    monkeypatch.setattr(proof, "_prove", lambda *_: pytest.fail("proved again"))
    assert replace(system, outputs=(), invariants=(), title="other").attitudes == system.attitudes


def test_trees_state_the_attitude_of_every_free_joint():
    system = eom.load_scene("satellite-with-panels").derive()
    (stated,) = system.attitudes
    assert stated.kind == "quaternion"
    assert {str(c) for c in stated.coordinates} <= set(system.state_names)
    assert eom.load_scene("double-pendulum").derive().attitudes == ()


# --- forms --------------------------------------------------------------------------------------


def test_cyclic_states_and_forms_of_rates():
    a, b = sp.symbols("a b", real=True)
    system = System.from_rates("s", {a: b**2, b: 1 / b + TIME, q[0]: sp.sin(b)})
    assert system.cyclic == ("a", "q0")
    assert system.forms == ("polynomial", "rational", "other")
    assert eom.heavy_top("3-1-3").cyclic == ("psi",)
    assert form_of(sp.exp(a), {b}) == "polynomial"
