"""Gravity on a small body near a distant centre, against the sum over its masses in doubles."""

import math

import pytest
import sympy as sp

from eom.derivations.verification import decide
from eom.fields import RATIONALS
from eom.terms.terms import Equation, add, cross, dot, expr, mul, number, zero
from eom.terms.vocabulary import quantity
from eom.worlds.generators import worlds

SMALL = 1e-4


def start(vector):
    return [float(s.coefficients[0]) for s in vector]


def exact(world):
    """Torque and energy of the body made smaller by `SMALL`, by the law of inverse squares."""
    mu, R = (
        float(world.primitive(n, ()).coefficients[0]) for n in ("gravity_parameter", "orbit_radius")
    )
    u, centre = start(world.primitive("orbit_direction", ())), start(world.place("C"))
    torque, energy = [0.0] * 3, 0.0
    for m, place in zip(world.masses, world.places, strict=True):
        mass = float(m.coefficients[0])
        p = [SMALL * (a - c) for a, c in zip(start(place), centre, strict=True)]
        far = [R * a + b for a, b in zip(u, p, strict=True)]
        distance = math.sqrt(sum(a * a for a in far))
        force = [-mu * mass * a / distance**3 for a in far]
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            torque[k] += p[i] * force[j] - p[j] * force[i]
        energy += -mu * mass / distance
        energy += mu * mass / R  # without what does not depend on the attitude
    return torque, energy


@pytest.mark.parametrize("seed", range(4))
def test_the_expansion_is_that_of_the_sum(seed):
    world = list(worlds(["constant_mass"], 5, field=RATIONALS))[seed]
    torque, energy = exact(world)
    mu, R = (
        float(world.primitive(n, ()).coefficients[0]) for n in ("gravity_parameter", "orbit_radius")
    )
    found = start(world.primitive("gravity_torque", ()))
    size = math.sqrt(sum(t * t for t in found))
    for a, b in zip(torque, found, strict=True):
        assert abs(a / SMALL**2 - b) < 1e-2 * size
    whole = float(world.primitive("gravity_energy", ()).coefficients[0])
    mass = sum(float(m.coefficients[0]) for m in world.masses)
    assert (
        abs(energy / SMALL**2 - (whole + mu * mass / R)) < 1e-2 * abs(whole + mu * mass / R) + 1e-4
    )


u, J = quantity("orbit_direction"), quantity("inertia", "C")
mu, R = sp.symbols("mu R", real=True)
SCALARS = {mu: quantity("gravity_parameter"), R: quantity("orbit_radius")}


def test_torque_and_energy_in_moments_of_inertia():
    """Hughes, sect. 8.1: 3 mu / R^3 u x J u; MacCullagh's formula for the energy."""
    torque = mul(expr(3 * mu / R**3), cross(u, dot(J, u)))
    assert decide(Equation(quantity("gravity_torque"), torque), (), SCALARS)
    assert not decide(Equation(quantity("gravity_torque"), -torque), (), SCALARS)
    assert decide(Equation(dot(quantity("gravity_torque"), u), zero("scalar")), (), SCALARS)
    assert decide(Equation(dot(u, u), number(1)), (), SCALARS)
    at_O = mul(expr(3 * mu / R**3), cross(u, dot(quantity("inertia", "O"), u)))
    assert not decide(Equation(quantity("gravity_torque"), at_O), (), SCALARS)
    assert decide(
        Equation(quantity("orbit_position"), add(mul(expr(R), u), zero("vector"))), (), SCALARS
    )
