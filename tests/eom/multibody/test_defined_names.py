"""Formulas of trees that name what bodies state: masses, moments, sizes."""

import pytest
import sympy as sp

from eom.errors import InputError
from eom.multibody.files.scene import TreeScene


def scene(**data):
    return TreeScene(**{
        "model": "tree",
        "parameters": {"m": 2.0},
        "bodies": {"hub": {"mass": "m", "moments": [4, 5, "3*m"]},
                   "rod": {"mass": 0.5, "solid": "cylinder", "size": {"radius": 0.1, "length": 1.5}}},
        "joints": {"base": {"kind": "free", "parent": "ground", "child": "hub"},
                   "hinge": {"kind": "revolute", "parent": "hub", "child": "rod"}},
        **data,
    })  # fmt: skip


def test_every_kind_of_formula_knows_what_bodies_state():
    m, t = sp.Symbol("m", real=True), sp.Symbol("t", real=True)
    tree = scene(
        loads={"jet": {"body": "hub", "force": ["mass_hub*sin(t)", "I3_hub", "length_rod"]}},
        rotors={"w": {"body": "hub", "inertia": "I1_hub/100"}},
        gravity=[0, 0, "-mass_rod/2"],
    ).tree
    assert sp.Matrix(tree.loads[0].force) == sp.Matrix([m * sp.sin(t), 3 * m, sp.Rational(3, 2)])
    assert tree.rotors[0].inertia == sp.Rational(1, 25)
    assert tree.gravity[2] == sp.Rational(-1, 4)


def test_the_start_may_be_a_momentum_over_a_moment():
    given = scene(initial={"w_base_3": "9/I3_hub", "u_hinge": "radius_rod*mass_hub"})
    assert given.initial_values()["w_base_3"] == 9 / 6
    assert given.initial_values()["u_hinge"] == pytest.approx(0.2, rel=1e-15)


def test_a_parameter_of_such_a_name_is_refused_unless_it_is_the_same():
    named = {"parameters": {"mass_hub": 2.0}}
    same = scene(**named, bodies={"hub": {"mass": "mass_hub", "moments": [4, 5, 6]}},
                 joints={"base": {"kind": "free", "parent": "ground", "child": "hub"}})  # fmt: skip
    assert same.tree.bodies[0].mass == sp.Symbol("mass_hub", real=True)
    with pytest.raises(InputError, match="a body defines this name") as caught:
        scene(parameters={"m": 2.0, "mass_rod": 1.0}, gravity=[0, 0, "mass_rod"])
    assert "[parameters]" in str(caught.value)


def test_unknown_names_offer_the_near_ones():
    with pytest.raises(InputError, match="unknown name 'mass_hup'") as caught:
        scene(gravity=[0, 0, "mass_hup"])
    assert "mass_hub" in str(caught.value)
    with pytest.raises(InputError, match="unknown name 'I1_rod'"):
        scene(initial={"u_hinge": "I1_rod"})


def test_bodies_are_stated_over_parameters_alone():
    """What one body states of another would go round in circles."""
    with pytest.raises(InputError, match="unknown name 'mass_hub'"):
        scene(bodies={"hub": {"mass": 1, "moments": ["mass_hub", 2, 2]}}, parameters={})
