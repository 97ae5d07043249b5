"""Parameters of trees that no body can have are refused where numbers come in."""

import pytest
import sympy as sp

import codegen
from eom.errors import InputError
from eom.multibody import Body, Joint, Rotor, Tree, derive

m, J, K, P, l, g, k = sp.symbols("m J K P l g k", real=True)
START = {"q_lift": 0.1, "u_lift": 0.0}
VALUES = {"m": 1.0, "J": 0.5, "K": 0.6, "l": 1.0, "g": 9.81, "k": 0.0}


def arm(inertia=(J, K, 0), **more):
    joints = [Joint("lift", "revolute", "ground", "bob", "y", stiffness=k)]
    body = Body("bob", m, (0, 0, -l), inertia, **more)
    return codegen.compile(derive(Tree("arm", [body], joints, gravity=(0, 0, -g))), "numpy")


def run(compiled, **changed):
    known = {n: v for n, v in (VALUES | changed).items() if n in compiled.system.parameter_names}
    return codegen.simulate(compiled, START, (0, 0.1), known)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"m": -1.0}, "mass of body bob is not negative"),
        ({"J": -0.5}, "triangle inequality"),
        ({"J": 2.0}, "triangle inequality"),
    ],
)
def test_what_no_body_has_is_refused(changed, message):
    compiled = arm(inertia=(J, K, sp.Rational(1, 5)))
    assert run(compiled).status == 0
    with pytest.raises(InputError, match=message):
        run(compiled, **changed)
    many = {
        n: [v, changed.get(n, v)] for n, v in VALUES.items() if n in compiled.system.parameter_names
    }
    with pytest.raises(InputError, match=message):
        codegen.ensemble(compiled, START, (0, 0.1), many)
    names = compiled.system.parameter_names
    values = {n: v for n, v in (VALUES | changed).items() if n in names}
    with pytest.raises(InputError, match=message):
        codegen.compile(compiled.system, "numpy", values)


def test_what_bodies_may_have_is_not():
    """Plates, rods and points lie on the border; stiffness and places may be negative."""
    plate = arm(inertia=(J, K, J + K))
    assert run(plate, J=0.1, K=0.2).status == 0
    rod = arm(inertia=(J, J, 0))
    assert run(rod, l=-1.0, k=-2.0).status == 0
    assert run(rod, J=0.0).status == 0
    full = arm(inertia=((J, P, 0), (P, K, 0), (0, 0, J + K)))
    known = VALUES | {"P": 0.54}
    assert codegen.simulate(full, START, (0, 0.1), known).status == 0
    with pytest.raises(InputError, match="triangle"):
        codegen.simulate(full, START, (0, 0.1), known | {"P": 0.56})


def test_an_inertia_about_another_point_is_tested_about_the_centre():
    about = arm(inertia=(J, J, sp.Rational(1, 100)), about="origin")
    assert run(about, J=1.01).status == 0
    with pytest.raises(InputError, match="about its centre of mass"):
        run(about, J=0.9)


def test_rotors_have_no_negative_moment():
    joints = [Joint("base", "revolute", "ground", "hub", "z")]
    rotor = Rotor("wheel", "hub", inertia=J, motor=True)
    hub = Body("hub", 1, inertia=(1, 1, 1))
    compiled = codegen.compile(derive(Tree("hub", [hub], joints, rotors=[rotor])), "numpy")
    with pytest.raises(InputError, match="inertia of rotor wheel is not negative"):
        codegen.simulate(compiled, dict.fromkeys(compiled.system.state_names, 0.0), (0, 1),
                         {"J": -0.1}, inputs={"tau_wheel": 0.0})  # fmt: skip


def test_a_part_without_mass_is_reported():
    found = run(arm(inertia=(J, J, 0)), m=0.0, J=0.0)
    assert found.status == -1
    assert "parts without mass" in found.message
