"""Torques that act together: sums, what stays constant, names that formulas may use, pictures."""

import pytest
import sympy as sp

import codegen
from eom.errors import InputError
from eom.exact.identity import equal
from eom.kinematics.coordinates import attitude
from eom.mechanics import torques
from eom.mechanics.rigidbody import OMEGA, principal_inertia
from eom.scenes.assembly import torques_of
from eom.scenes.scene import Scene
from eom.views.draw.picture import Arrow
from eom.views.live.scenes import subject_of
from eom.views.tree.sketches import FORCE, TORQUE, sketch

TOP = {"mass": 2.0, "gravity": 10.0, "centre_of_mass": [0.0, 0.0, 0.2]}
ORBIT = {"orbital_rate": 0.5}
NAMED = {"weight": TOP, "gravity_gradient": ORBIT}
DAMPED = ["-k*omega_1", "-k*omega_2", "M"]
NUMBERS = {"k": 0.3, "M": 0.2}


def scene(chosen="quaternion", **data):
    return Scene(**{
        "body": {"moments": [1.0, 2.0, 2.5]},
        "attitude": chosen,
        "initial": {"omega_1": 0.3, "omega_2": 0.1, "omega_3": 2.0},
        "initial_attitude": {"sequence": "3-2-1", "degrees": [20, 30, 40]},
        **data,
    })  # fmt: skip


def torque_in(given):
    system = given.full_system
    return [system.expand(next(d.expression for d in system.outputs if d.name == f"torque_{k}"))
            for k in (1, 2, 3)]  # fmt: skip


@pytest.mark.parametrize("name", NAMED)
@pytest.mark.parametrize("chosen", ["quaternion", "3-2-1"])
def test_the_torque_is_the_sum(name, chosen):
    """Exactly, and rates follow: J omega' + omega x J omega is the sum."""
    alone = torque_in(scene(chosen, torque={name: NAMED[name]}))
    applied = torque_in(scene(chosen, torque={"components": DAMPED}, parameters=NUMBERS))
    both = scene(chosen, torque={name: NAMED[name], "components": DAMPED}, parameters=NUMBERS)
    assert all(equal(x, a + b) for x, a, b in zip(torque_in(both), alone, applied, strict=True))
    J, system = principal_inertia()[0], both.full_system
    rates = sp.Matrix([system.expand(r) for r in system.rates[:3]])
    turning = OMEGA.column.cross(J * OMEGA.column)
    assert all(equal(x, y) for x, y in zip(J * rates + turning, torque_in(both), strict=True))


def test_what_comes_with_each_is_kept():
    C, J = attitude("quaternion").matrix, principal_inertia()[0]
    M = sp.Symbol("M", real=True)
    gradient, couple = torques.gravity_gradient(C, J), torques.applied((0, 0, M))
    for whole in (gradient + couple, couple + gradient):
        assert whole.assumptions == gradient.assumptions
        assert whole.frame_rate == gradient.frame_rate
        assert whole.frame_rate_in_A == gradient.frame_rate_in_A
        assert whole.potential == gradient.potential
        assert whole.reference_point == "centre of mass"
    twice = torques.weight(C) + torques.weight(C)
    assert twice.parameters == torques.weight(C).parameters
    assert equal(twice.potential, 2 * torques.weight(C).potential)
    assert (couple + couple).reference_point == ""


@pytest.mark.parametrize("name", NAMED)
def test_energy_stays_where_the_rest_does_no_work(name):
    """The sum is asked, not a list of kinds: a gyroscopic couple leaves the energy, damping does not."""
    gyroscopic = ["b*omega_2", "-b*omega_1", 0]
    for components, numbers, stays in (
        (gyroscopic, {"b": 0.4}, name == "weight"),
        (DAMPED, NUMBERS, False),
        (["0", 0, 0], {}, True),
    ):
        system = scene(torque={name: NAMED[name], "components": components}, parameters=numbers)
        assert ("E" in system.full_system.invariant_names) == stays
        assert "q_norm" in system.full_system.invariant_names


def test_vertical_momentum_of_a_top_stays_under_a_couple_along_the_horizontal():
    """b1, b2 components of the couple (up_2, -up_1, 0) are horizontal: H_3 stays though others do not."""
    up = ["2*q0*q1 + 2*q2*q3", "2*q0*q2 - 2*q1*q3"]
    given = scene(torque={"weight": TOP, "components": [f"M*({up[0]})", f"M*({up[1]})", 0]},
                  parameters={"M": 0.3})  # fmt: skip
    assert "H_3" in given.full_system.invariant_names


def test_a_damped_top_loses_energy_as_the_power_says():
    given = scene(torque={"weight": TOP, "components": DAMPED}, parameters={"k": 0.3, "M": 0.0})
    system = given.full_system
    run = codegen.simulate(
        codegen.compile(system, "numpy"), given.initial_values(),
        (0, 1), given.parameter_values(), method="DOP853", rtol=1e-10, outputs=["E", "omega_1", "omega_2"],
        t_eval=[k / 200 for k in range(201)],
    )  # fmt: skip
    power = -0.3 * (run["omega_1"] ** 2 + run["omega_2"] ** 2)
    work = sum((power[:-1:2] + 4 * power[1::2] + power[2::2])[k] for k in range(100)) / 600
    assert run["E"][-1] - run["E"][0] == pytest.approx(work, rel=1e-5)


def test_formulas_speak_of_what_the_scene_defines():
    size = {"radius": 0.1, "length": 0.2}
    given = scene(
        body={"solid": "cylinder", "mass": 2.0, "size": size},
        torque={"weight": TOP, "components": ["m*g*r3*radius/length", 0, "mass*I3"]},
        initial={"omega_1": "L0/I1", "omega_2": "-radius", "omega_3": 2},
        parameters={"L0": 0.5},
    )
    m, r3, I3 = (
        sp.Symbol("m", positive=True),
        sp.Symbol("r3", real=True),
        sp.Symbol("I3", positive=True),
    )
    applied = torques_of(given)["components"].components.components
    assert applied == (m * sp.Symbol("g", positive=True) * r3 / 2, 0, 2 * I3)
    I1 = given.parameter_values()["I1"]
    assert given.initial_values()["omega_1"] == pytest.approx(0.5 / I1, rel=1e-15)
    assert given.initial_values()["omega_2"] == -0.1
    assert "L0" not in given.full_system.parameter_names


def test_a_spinner_speaks_of_its_moments():
    given = Scene(
        model="spinner", body={"moments": [0.06, 0.12]}, torque={"components": [0, "M/I2", 0]},
        parameters={"M": 0.1}, initial={"Omega": "M/I1"},
    )  # fmt: skip
    assert {"I2", "M"} <= set(given.full_system.parameter_names)
    with pytest.raises(InputError, match="unknown name 'I3'"):
        Scene(model="spinner", body={"moments": [0.06, 0.12]}, torque={"components": [0, "I3", 0]})
    with pytest.raises(InputError, match="unknown name 'I3'"):
        Scene(model="spinner", body={"moments": [0.06, 0.12]}, initial={"Omega": "I3"})


def test_a_start_that_is_no_number_is_reported():
    given = scene(initial={"omega_1": "sqrt(I1 - I2)", "omega_2": 0, "omega_3": 0})
    with pytest.raises(InputError, match="no finite number"):
        given.initial_values()


def test_the_picture_draws_every_load():
    def drawn(given, colour):
        items = sketch(given).rows[0][0].items
        return [i for i in items if isinstance(i, Arrow) and i.colour == colour and i.label]

    applied = {"components": [0, 0, "M"]}
    top = scene(torque={"weight": TOP, **applied}, parameters={"M": 0.2})
    assert len(drawn(top, FORCE)) == 1
    assert len(drawn(top, TORQUE)) == 1
    assert "Its weight" in sketch(top).caption
    assert "1 components" in sketch(top).caption
    orbit = scene(torque={"gravity_gradient": ORBIT, **applied}, parameters={"M": 0.2})
    assert len(drawn(orbit, TORQUE)) == 2


def test_the_live_page_keeps_what_is_not_left_out():
    given = scene(torque={"weight": TOP, "components": DAMPED}, parameters=NUMBERS)
    subject = subject_of(given)
    assert {"m", "g", "r3", "k", "M"} <= {k.name for k in subject.knobs}
    for variant in subject.variants.values():
        names = variant.own.parameter_names
        assert ("m" in names) or not ({"k", "M"} & set(names))
