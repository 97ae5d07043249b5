"""Rotors in bodies: the same motion as a body on a joint, conservation, given speeds, errors."""

import numpy as np
import pytest
import sympy as sp

import codegen
from eom.errors import InputError
from eom.exact.identity import equal
from eom.mechanics.rigidbody import is_invariant
from eom.multibody import Body, Jet, Joint, Placement, Rotor, Tree, derive

J, c = sp.symbols("J c", positive=True)
WELD = Joint("weld", "fixed", "ground", "hub")
AXIS = (2, -3, 6)  # of length 7
HUB = Body("hub", 5, (sp.Rational(1, 10), 0, 0), (4, 5, 6))
BASE = Joint("base", "free", "ground", "hub", attitude="3-1-2")
ARM = Joint("hinge", "revolute", "hub", "arm", "x", on_parent=Placement((0, 1, 0)), stiffness=2)


def whole(rotor, bodies=(HUB,), joints=(BASE,)):
    return Tree("gyrostat", bodies, joints, rotors=(rotor,))


def evaluated(system, values):
    compiled = codegen.compile(system, "numpy")
    x = np.array([values[n] for n in system.state_names])
    rates = compiled.rhs(0.3, x, [], [0.7] * len(system.inputs))
    return dict(zip(system.state_names, rates, strict=True))


def drawn(names, seed=4):
    return dict(zip(names, np.random.default_rng(seed).uniform(-1, 1, len(names)), strict=True))


@pytest.mark.parametrize("damping", [0, sp.Rational(1, 5)])
def test_a_rotor_is_a_wheel_on_a_joint(damping):
    """Of a hub with an arm; the wheel's transverse moments and mass belong to the hub of the rotor."""
    arm = Body("arm", 1, (0, 1, 0), (1, 1, 2))
    one, across = sp.Rational(1, 2), sp.Rational(1, 3)
    at = (sp.Rational(1, 5), sp.Rational(-1, 10), sp.Rational(3, 10))
    wheel = Body("wheel", 2, (0, 0, 0), (across, across, one))
    joint = Joint("spin", "revolute", "hub", "wheel", "z",
                  on_parent=Placement(at), damping=damping, motor=True)  # fmt: skip
    other = derive(Tree("bodies", [HUB, arm, wheel], [BASE, ARM, joint]))
    lump = Body("lump", 2, (0, 0, 0), (across, across, one))
    weld = Joint("weld", "fixed", "hub", "lump", on_parent=Placement(at))
    rotor = Rotor("spin", "lump", "z", one, damping=damping, motor=True, angle=True)
    ours = derive(Tree("rotor", [HUB, arm, lump], [BASE, ARM, weld], rotors=[rotor]))
    values = drawn(other.state_names)
    values["Omega_spin"] = values["u_spin"] + values["w_base_3"]
    expected, found = evaluated(other, values), evaluated(ours, values)
    for name in set(expected) & set(found):
        assert found[name] == pytest.approx(expected[name], rel=1e-13, abs=1e-13), name
    assert found["Omega_spin"] == pytest.approx(
        expected["u_spin"] + expected["w_base_3"], rel=1e-13
    )
    assert len(ours.definitions) < len(other.definitions)


def test_energy_and_momentum_are_conserved_exactly():
    system = derive(whole(Rotor("wheel", "hub", AXIS, J)))
    assert {"energy", "p_1", "L_1", "L_3"} <= set(system.invariant_names)
    for definition in system.invariants:
        if definition.name in {"energy", "L_2"}:
            assert is_invariant(system, definition.expression, points=1), definition.name


def test_a_motor_turns_the_whole_only_against_the_rotor():
    """Momentum, the rotor's included, stays and is an invariant; energy does not and is none."""
    system = derive(whole(Rotor("wheel", "hub", AXIS, J, damping=c, motor=True)), ["energies"])
    assert system.invariant_names == ("p_1", "p_2", "p_3", "L_1", "L_2", "L_3")
    for definition in system.invariants:
        if definition.name in {"p_1", "L_1", "L_3"}:
            assert is_invariant(system, definition.expression, points=1), definition.name
    kinetic = next(d for d in system.outputs if d.name == "kinetic_energy")
    assert not is_invariant(system, kinetic.expression, points=1)


def test_momentum_is_constant_under_a_given_speed_but_not_of_a_mass_that_changes():
    t = sp.Symbol("t", real=True)
    system = derive(whole(Rotor("wheel", "hub", AXIS, 2, speed=sp.sin(2 * t))))
    L = next(d for d in system.invariants if d.name == "L_1")
    assert is_invariant(system, L.expression, points=1)
    growing = Body("hub", 5 + t, (0, 0, 0), (4, 5, 6))
    rain = Jet("rain", "hub", (0, 0, -3))
    assert derive(Tree("growing", (growing,), (BASE,), jets=(rain,))).invariant_names == ()


def test_a_given_speed_is_a_wheel_of_that_relative_speed():
    """With the torque that a rotor of its own speed needs to keep that relative speed."""
    t = sp.Symbol("t", real=True)
    speed = sp.sin(2 * t)
    given = derive(whole(Rotor("wheel", "hub", AXIS, sp.Rational(1, 2), speed=speed)))
    free = derive(whole(Rotor("wheel", "hub", AXIS, sp.Rational(1, 2), motor=True)))
    values = drawn(given.state_names)
    found = evaluated(given, values)
    a = np.array(AXIS) / 7
    w, dw = (np.array([d[f"w_base_{n}"] for n in (1, 2, 3)]) for d in (values, found))
    values["Omega_wheel"] = np.sin(0.6) + a @ w
    torque = 0.5 * (2 * np.cos(0.6) + a @ dw)
    x = np.array([values[n] for n in free.state_names])
    rates = codegen.compile(free, "numpy").rhs(0.3, x, [], [torque])
    for name, rate in zip(free.state_names, rates, strict=True):
        if name in found:
            assert rate == pytest.approx(found[name], rel=1e-12, abs=1e-12), name


def test_a_level_gyroscope_precesses_steadily():
    """On a pivot, its momentum h along axis 1 and level: it turns about the vertical with m g l / h."""
    body = Body("frame", 2, (1, 0, 0), (1, 2, 3))
    joint = Joint("pivot", "spherical", "ground", "frame")
    rotor = Rotor("rotor", "frame", "x", sp.Rational(1, 2))
    system = derive(Tree("top", [body], [joint], gravity=(0, 0, -10), rotors=[rotor]))
    speed, weight, arm = 50.0, 20.0, 1.0
    values = dict.fromkeys(system.state_names, 0.0) | {"e_pivot_0": 1.0, "Omega_rotor": speed}
    values["w_pivot_3"] = weight * arm / (0.5 * speed)
    found = evaluated(system, values)
    assert [found[f"w_pivot_{n}"] for n in (1, 2, 3)] == pytest.approx([0, 0, 0], abs=1e-14)
    values["w_pivot_3"] = 0.0
    assert evaluated(system, values)["w_pivot_2"] == pytest.approx(weight * arm / 4)


def test_errors_name_the_rotor():
    for rotor, what in (
        (lambda: Rotor("r", "hub", inertia=0), "not positive"),
        (lambda: Rotor("r", "hub", inertia=-J), "not positive"),
        (lambda: Rotor("r", "hub", inertia=1, speed=3, motor=True), "leaves no room"),
        (lambda: whole(Rotor("r", "hup", inertia=1)), "unknown body"),
        (lambda: derive(whole(Rotor("r", "hub", inertia=1), joints=[WELD])), "moves nothing"),
    ):
        with pytest.raises(InputError, match=what) as caught:
            rotor()
        assert "'r'" in str(caught.value)


def test_a_rotor_at_rest_is_no_more_than_its_body():
    """Zero speed given: the same equations as without it."""
    plain = derive(Tree("gyrostat", [HUB], [BASE]))
    with_rotor = derive(whole(Rotor("r", "hub", inertia=1, speed=0)))
    assert plain.state_names == with_rotor.state_names
    for a, b in zip(plain.rates, with_rotor.rates, strict=True):
        assert equal(plain.expand(a), with_rotor.expand(b))
