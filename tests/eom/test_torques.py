"""Torques against their potentials, against sums over point masses and published formulas."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from eom.exact.identity import equal
from eom.kinematics.coordinates import SEQUENCES, attitude
from eom.mechanics import torques
from eom.mechanics.rigidbody import full_inertia, principal_inertia
from tests.eom.rows import only

n = sp.Symbol("n", positive=True)


def expanded(torque):
    """Components and potential with the named directions put in."""
    named = {d.symbol: d.expression for d in torque.directions}
    return (
        sp.Matrix([sp.sympify(c).xreplace(named) for c in torque.components.components]),
        sp.sympify(torque.potential).xreplace(named),
    )


def power_of_potential(chosen, potential, omega):
    """d(potential)/dt while B turns at ``omega`` relative to A."""
    from eom.kinematics.frames import vector

    rates = chosen.rates(vector("B", omega))
    symbols = [q.symbol for q in chosen.coordinates]
    return sp.Add(*(potential.diff(s) * r for s, r in zip(symbols, rates, strict=True)))


LAWS = {
    "weight": torques.weight,
    "weight off axis": lambda C: torques.weight(C, (True, True, True)),
    "gravity gradient": lambda C: torques.gravity_gradient(C, principal_inertia()[0]),
    "gravity gradient, full inertia": lambda C: torques.gravity_gradient(C, full_inertia()[0]),
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", only([*SEQUENCES[::4], "quaternion", "dcm"], "dcm"))
def test_work_of_the_torque_is_the_loss_of_potential(law, name):
    chosen = attitude(name)
    torque, potential = expanded(LAWS[law](chosen.matrix))
    omega = sp.symbols("w1:4", real=True)
    loss = -power_of_potential(chosen, potential, omega)
    assert equal(torque.dot(sp.Matrix(omega)), loss)
    assert torque != sp.zeros(3, 1)


def test_torque_is_minus_the_slope_of_the_potential_numerically():
    """Turn B a little about each of its axes and difference the potential."""
    chosen = attitude("3-2-1")
    torque, potential = expanded(torques.gravity_gradient(chosen.matrix, full_inertia()[0]))
    J, _ = full_inertia()
    numbers = {
        J[0, 0]: 7,
        J[1, 1]: 10,
        J[2, 2]: 12,
        J[0, 1]: 0.5,
        J[0, 2]: -0.3,
        J[1, 2]: 0.2,
        n: 1.1,
    }
    symbols = [q.symbol for q in chosen.coordinates]
    V = sp.lambdify(symbols, potential.subs(numbers), "numpy")
    M = sp.lambdify(symbols, list(torque.subs(numbers)), "numpy")
    from scipy.spatial.transform import Rotation as SciPyRotation

    base = SciPyRotation.from_euler("ZYX", [0.4, 0.5, -0.7])
    step = 1e-5

    def energy(vector):
        turned = base * SciPyRotation.from_rotvec(vector)
        return V(*turned.as_euler("ZYX"))

    slopes = [(energy(step * e) - energy(-step * e)) / (2 * step) for e in np.eye(3)]
    assert np.allclose(M(0.4, 0.5, -0.7), -np.array(slopes), rtol=1e-7, atol=1e-8)


def test_gravity_gradient_is_the_published_formula():
    """Hughes (1986), sect. 8.1: 3 n^2 a1 x J a1, with a1 the first column of C."""
    chosen = attitude("dcm")
    J, _ = full_inertia()
    torque, potential = expanded(torques.gravity_gradient(chosen.matrix, J))
    a = sp.Matrix(chosen.matrix)[:, 0]
    assert equal(torque, 3 * n**2 * a.cross(sp.Matrix(J) * a))
    # The potential is that of the formula up to a multiple of a1.a1 = 1.
    rest = sp.expand(potential - sp.Rational(3, 2) * n**2 * (a.T * sp.Matrix(J) * a)[0])
    constant = rest.subs({a[0]: 1, a[1]: 0, a[2]: 0})
    assert equal(rest, constant * a.dot(a))


def test_gravity_gradient_is_that_of_point_masses_far_away():
    """Sum mu r x R/|R|^3 over a cloud; the difference falls off as size over distance."""
    generator = np.random.default_rng(3)
    mass = generator.uniform(1, 2, 12)
    r = generator.normal(size=(12, 3))
    r -= (mass[:, None] * r).sum(0) / mass.sum()
    J = sum(m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p in zip(mass, r, strict=True))
    a = np.array([2.0, -1.0, 2.0]) / 3
    symbolic, _ = full_inertia()
    C = sp.Matrix(3, 3, lambda i, j: sp.Float(a[i]) if j == 0 else 0)
    torque, _ = expanded(torques.gravity_gradient(C, symbolic))
    numbers = {symbolic[i, j]: J[i, j] for i in range(3) for j in range(3)} | {n: 1.0}
    found = np.array(torque.subs(numbers), dtype=float).ravel()
    errors = []
    for distance in (1e3, 1e4):
        places = distance * a + r
        force = (
            -(distance**3) * mass[:, None] * places / np.linalg.norm(places, axis=1)[:, None] ** 3
        )
        errors.append(np.linalg.norm(np.cross(r, force).sum(0) - found))
    assert errors[0] < 1e-1
    assert errors[1] < errors[0] / 5


def test_weight_is_the_first_moment_in_the_field():
    chosen = attitude("dcm")
    torque = torques.weight(chosen.matrix, (True, True, True))
    found, potential = expanded(torque)
    m, g, r1, r2, r3 = (q.symbol for q in torque.parameters)
    arm = sp.Matrix([r1, r2, r3])
    down = -sp.Matrix(chosen.matrix) * sp.Matrix([0, 0, 1])
    assert equal(found, arm.cross(m * g * down))
    height = (sp.Matrix(chosen.matrix).T * arm)[2]
    assert equal(potential, m * g * height)
    assert torque.reference_point == "fixed point"


def test_weight_names_only_the_offsets_that_matter():
    torque = torques.weight(attitude("dcm").matrix)
    assert [q.name for q in torque.parameters] == ["m", "g", "r3"]
    assert expanded(torque)[0][2] == 0


def test_directions_are_named_unless_they_are_symbols_already():
    assert torques.weight(attitude("dcm").matrix).directions == ()
    named = torques.weight(attitude("quaternion").matrix).directions
    assert [d.name for d in named] == ["up_1", "up_2", "up_3"]


def test_orbit_frame_turns_about_its_normal():
    chosen = attitude("dcm")
    law = torques.gravity_gradient(chosen.matrix, principal_inertia()[0])
    named = {d.symbol: d.expression for d in law.directions}
    rate = sp.Matrix([c.xreplace(named) for c in law.frame_rate.components])
    assert rate == n * sp.Matrix(chosen.matrix)[:, 2]
    assert {a.name for a in law.assumptions} == {"circular_orbit", "small_body"}


def test_applied_torque_is_what_was_given():
    k = sp.Symbol("k")
    assert torques.applied((k, 0, 1)).components.components == (k, 0, 1)
    assert torques.applied((0, 0, 0)).potential == 0
