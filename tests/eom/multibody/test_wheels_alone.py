"""Reaction wheels in a hub on its own: nothing else hangs on its joint, whatever its kind."""

import pytest
import sympy as sp

import codegen
from eom.errors import InputError
from eom.multibody import Body, Joint, Rotor, Tree, derive
from eom.multibody.files.scene import TreeScene
from eom.multibody.recursion.operation_count import savings
from eom.views.live.page import page

AXES = ("x", "y", "z")
HUB = {"mass": 5.0, "centre": [0.1, 0, 0], "moments": [4.0, 5.0, 6.0]}
KINDS = ("free", "spherical", "revolute")


def scene(kind, count, *, motor=False, **keys):
    """A hub on one joint with wheels that turn, the hub too."""
    wheel = {"body": "hub", "inertia": 0.2, "motor": motor}
    joint = {"kind": kind, "parent": "ground", "child": "hub"}
    if kind == "revolute":
        joint["axis"] = "x"
        start = {"u_base": 0.3}
    else:
        start = {"w_base_1": 0.3, "w_base_2": -0.2, "w_base_3": 0.1}
    return TreeScene(
        model="tree",
        bodies={"hub": HUB},
        joints={"base": joint},
        rotors={f"w{n}": {**wheel, "axis": n} for n in AXES[:count]},
        initial={**start, "Omega_wx": 12.0},
        integration={"t_end": 5.0, "points": 11},
        **keys,
    )


def moved(given, **inputs):
    system = given.full_system
    return codegen.simulate(
        codegen.compile(system, "numpy"), given.initial_values(), (0, 5), inputs=inputs,
        method="DOP853", rtol=1e-10,
    )  # fmt: skip


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_left_out_is_reported_any_number_of_wheels(kind, count):
    given = scene(kind, count)
    saved = savings(given.tree)
    assert 0 < saved.done < saved.without
    assert {f"Omega_w{n}" for n in AXES[:count]} <= set(given.derive().state_names)


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_energy_and_momentum_stay(kind, count):
    given = scene(kind, count)
    drift = moved(given).drift
    kept = {"energy", "L_1", "L_2", "L_3"} & set(drift)
    assert kept == ({"energy", "L_1", "L_2", "L_3"} if kind == "free" else {"energy"})
    for name in kept:
        assert drift[name].largest < 1e-8


def test_a_motor_hands_momentum_from_the_hub_to_its_wheel():
    """About a fixed axis: J_hub u' = -tau and J_wheel Omega' = tau; of a free hub momentum stays."""
    result = moved(scene("revolute", 1, motor=True), tau_wx=0.5)
    assert result["Omega_wx"][-1] == pytest.approx(12 + 0.5 * 5 / 0.2, rel=1e-9)
    assert result["u_base"][-1] == pytest.approx(0.3 - 0.5 * 5 / (4 - 0.2), rel=1e-9)
    drift = moved(scene("free", 3, motor=True), tau_wx=0.5, tau_wy=0.1, tau_wz=-0.3).drift
    assert "energy" not in drift
    assert max(drift[f"L_{k}"].largest for k in (1, 2, 3)) < 1e-8


@pytest.mark.parametrize("count", [1, 3])
def test_the_live_page_is_made(count):
    assert "tau_wx" in page(scene("free", count, motor=True))


def test_only_bodies_of_revolution_are_named_so():
    """Moments that differ are not equal because both are numbers, or both symbols."""

    def reasons(moments):
        bodies = [Body("hub", 2, (0, 0, 0), (3, 4, 5)), Body("wheel", 1, (0, 0, 0), moments)]
        joints = [Joint("a", "free", "ground", "hub"), Joint("b", "revolute", "hub", "wheel", "z")]
        return str(savings(Tree("t", bodies, joints)))

    J, K = sp.symbols("J K", positive=True)
    assert "wheel" in reasons((1, 1, 2))
    assert "wheel" in reasons((J, J, K))
    assert "wheel" not in reasons((1, sp.Rational(3, 2), 2))
    assert "wheel" not in reasons((J, K, K))


def test_a_hub_that_is_all_rotor_is_still_refused():
    """About its axis nothing is left that the joint could accelerate."""
    joint = Joint("base", "revolute", "ground", "hub", "x")
    hub, rotor = Body("hub", 1, (0, 0, 0), (2, 3, 4)), Rotor("w", "hub", "x", 2)
    with pytest.raises(InputError, match="accelerates no inertia"):
        derive(Tree("t", [hub], [joint], rotors=[rotor]))
