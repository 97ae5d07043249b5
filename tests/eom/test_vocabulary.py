"""Quantities by name: their kinds, words, and definitions, against sums written out."""

import string

import pytest

from eom.derivations.verification import decide
from eom.errors import InputError
from eom.terms.terms import Equation, add, cross, der, dot, integral, mul, number, total, zero
from eom.terms.vocabulary import (
    QUANTITIES,
    definition,
    mass,
    omega,
    over_mass,
    over_parts,
    position,
    quantity,
    unit,
    velocity,
    words,
)
from eom.worlds.evaluate import Evaluator
from eom.worlds.generators import world
from eom.worlds.worlds import closure

LABELS = {
    "mass": ["i"], "position": ["i", "O"], "force": ["i"], "internal_force": ["i", "j"],
    "constraint_force": ["i"], "applied_force": ["i"],
    "angular_velocity": ["B", "I"], "unit": ["B", "2"], "rotation": ["B", "A"],
    "eigenvectors": ["A", "B"], "scalar": ["s"],
    "vector": ["v"], "fixed_vector": ["v", "B"], "dyadic": ["d"], "inertia": ["O"], "angle": ["psi"],
    "turn_angle": ["2", "321", "B", "I"], "free_angle": ["psi"], "principal_angle": ["B", "I"],
    "principal_axis": ["B", "I"], "euler_parameter": ["0", "B", "I"], "euler_vector": ["B", "I"],
    "rodrigues": ["B", "I"], "modified_rodrigues": ["B", "I"], "shadow_rodrigues": ["B", "I"],
}  # fmt: skip
WORLD_OF = {
    "angle": ["spin_312"],
    "turn": ["sequence_321"],
    "rotor": ["rotors"],
    "slug": ["viscous_slug"],
}


def labels_for(name):
    places = len({f for _, f, _, _ in string.Formatter().parse(QUANTITIES[name].words) if f})
    if name.startswith("rotor"):
        return ["k"]
    return LABELS.get(name, ["system", "O"])[:places] if places else []


@pytest.mark.parametrize("name", QUANTITIES)
def test_every_quantity_has_words_and_a_value_of_its_kind(name):
    term = quantity(name, *labels_for(name))
    assert "{" not in words(term)
    meaning = definition(term)
    assert meaning is None or meaning.kind == term.kind
    assumed = next((a for start, a in WORLD_OF.items() if name.startswith(start)), [])
    e = Evaluator(world(closure(assumed), 0), {})
    value = e.value(term, {"i": 0, "j": 1, "k": 0})
    shape = {"scalar": 0, "vector": 1, "column": 1}.get(term.kind, 2)
    for _ in range(shape):
        assert len(value) == 3
        value = value[0]
    assert value.coefficients


def test_other_names_are_refused():
    with pytest.raises(InputError, match="momentun"):
        quantity("linear_momentun", "P")


def test_words():
    assert words(position("dm", "C")) == "position of a mass element from the centre of mass"
    assert words(omega()) == "angular velocity of frame B with respect to I"
    assert words(unit("B", 2)) == "unit vector along axis 2 of frame B"


def test_sums_over_a_system_a_body_and_one_particle():
    assert over_mass("body", velocity) == integral(velocity("dm"))
    assert over_mass("system", velocity) == total(mul(mass("i"), velocity("i")))
    assert over_mass("P", velocity) == mul(mass("P"), velocity("P"))
    assert over_parts("P", velocity) == velocity("P")
    assert over_parts("system", velocity) == total(velocity("i"))
    assert over_parts("body", velocity) == total(velocity("dm"), "dm", "elements")


@pytest.mark.parametrize("name", ["total_mass", "linear_momentum", "kinetic_energy"])
def test_a_body_of_point_masses_is_a_system(name):
    assert decide(Equation(quantity(name, "body"), quantity(name, "system")), (), {})


@pytest.mark.parametrize(
    "name",
    [
        "first_moment",
        "angular_momentum",
        "absolute_angular_momentum",
        "torque",
        "rotational_energy",
    ],
)
def test_a_body_of_point_masses_is_a_system_about_any_point(name):
    equation = Equation(quantity(name, "body", "O"), quantity(name, "system", "O"))
    assert decide(equation, (), {})
    other = Equation(quantity(name, "body", "O"), quantity(name, "body", "C"))
    assert not decide(other, (), {})
    assert decide(other, ("about_centre",), {})


def test_energy_and_momentum_against_their_formulas():
    m, v = mass("P"), velocity("P")
    half = mul(number(1, 2), m, dot(v, v))
    assert decide(Equation(quantity("kinetic_energy", "P"), half), (), {})
    arm = position("P", "O")
    relative = mul(m, cross(arm, add(v, -velocity("O"))))
    assert decide(Equation(quantity("angular_momentum", "P", "O"), relative), (), {})
    absolute = mul(m, cross(arm, v))
    assert decide(Equation(quantity("absolute_angular_momentum", "P", "O"), absolute), (), {})
    assert not decide(Equation(relative, absolute), (), {})
    power = Equation(der(half), dot(quantity("force", "P"), v))
    assert decide(power, ("one_particle", "newton_2", "constant_mass"), {})
    assert decide(Equation(quantity("first_moment", "body", "C"), zero("vector")), (), {})
