"""Solutions as series: against derivatives by SymPy, closed forms and constants of the motion."""

import pytest
import sympy as sp

from eom.errors import InputError
from eom.fields import PRIME, RESIDUES, Singular
from eom.mechanics.rigidbody import free_rigid_body, heavy_top
from eom.mechanics.spinning import lecture_torque
from eom.quantities import Quantity
from eom.system import System
from eom.worlds.solutions import (
    ENDLESS,
    Inconsistent,
    Motion,
    Restriction,
    differs,
    inexact,
    order,
    rate,
    real_point,
    spread,
    without_rates,
)

x, v, k, m, a = sp.symbols("x v k m a", real=True)
SPRING = System.from_rates("spring", {x: v, v: -k * x / m})


def test_coefficients_are_those_of_the_closed_form():
    motion = Motion(SPRING, 6, 1)
    square = motion.series(k / m).coefficients[0]
    x0, v0 = (motion.series(s).coefficients[0] for s in (x, v))
    expected = [x0, v0, -square * x0, -square * v0, square**2 * x0, square**2 * v0]
    factorials = [1, 1, 2, 6, 24, 120]
    found = motion.series(x).coefficients
    assert found == tuple(
        e * RESIDUES.inverse(f) % PRIME for e, f in zip(expected, factorials, strict=True)
    )


@pytest.mark.parametrize("made", [lambda: heavy_top("3-1-3"), lecture_torque().system])
def test_second_rates_are_those_by_the_chain_rule(made):
    system = made()
    motion = Motion(system, 4, 0)
    for q in system.states:
        by_chain_rule = system.rate_of(system.rate_of(q.symbol))
        difference = motion.series(rate(rate(q.symbol))) - motion.series(by_chain_rule)
        assert difference.is_zero
    assert all(motion.series(rate(d.expression)).is_zero for d in system.invariants)


def cart():
    """A pendulum on a cart, with its mass matrix; its energy and momentum are constant."""
    x, th, v, w = sp.symbols("x theta v w", real=True)
    M, m, g, l = sp.symbols("M m g l", positive=True)
    matrix = sp.eye(4)
    matrix[2, 2], matrix[3, 3] = M + m, m * l**2
    matrix[2, 3] = matrix[3, 2] = m * l * sp.cos(th)
    rates = (v, w, m * l * w**2 * sp.sin(th), -m * g * l * sp.sin(th))
    energy = (M + m) * v**2 / 2 + m * l * v * w * sp.cos(th) + m * l**2 * w**2 / 2
    system = System(
        name="cart",
        states=tuple(map(Quantity, (x, th, v, w))),
        rates=rates,
        parameters=tuple(map(Quantity, (M, m, g, l))),
        mass_matrix=sp.ImmutableMatrix(matrix),
    )
    return system, energy - m * g * l * sp.cos(th), (M + m) * v + m * l * w * sp.cos(th)


def test_a_mass_matrix_is_solved():
    system, energy, momentum = cart()
    motion = Motion(system, 4, 0)
    assert motion.series(rate(energy)).is_zero
    assert motion.series(rate(momentum)).is_zero
    assert not motion.series(rate(energy - momentum * system.states[2].symbol)).is_zero
    rows = sp.Matrix(system.mass_matrix) * sp.Matrix([rate(q.symbol) for q in system.states])
    for row, right in zip(rows, system.rates, strict=True):
        assert (motion.series(row) - motion.series(right)).is_zero


def test_quaternions_have_unit_norm_and_angles_identities():
    top = heavy_top()
    motion = Motion(top, 3, 0)
    square = sp.Add(*(q.symbol**2 for q in top.states if q.name.startswith("q")))
    assert (motion.series(square) - motion.constant(1)).is_zero
    spinner = Motion(lecture_torque().system(), 3, 0)
    theta = sp.Symbol("theta", real=True)
    assert spinner.series(sp.sin(theta) ** 2 + sp.cos(theta) ** 2 - 1).is_zero
    half = 2 * sp.sin(theta / 2) * sp.cos(theta / 2) - sp.sin(theta)
    assert spinner.series(half).is_zero
    assert not spinner.series(sp.sin(theta) - theta).is_zero


def test_restrictions_hold_or_are_refused():
    body = free_rigid_body()
    names = {q.name: q.symbol for q in (*body.states, *body.parameters)}
    w1, w2, w3 = (names[f"omega_{n}"] for n in (1, 2, 3))
    equal = Restriction("I1 = I2", equal=((names["I1"], names["I2"]),))
    assert Motion(body, 3, 0, (equal,)).series(rate(w3)).is_zero
    rest = Restriction("omega_3 = 0", zero=(w3,))
    with pytest.raises(Inconsistent):
        Motion(body, 3, 0, (rest,))
    assert Motion(body, 3, 0, (equal, rest)).series(w3).is_zero
    assert not Motion(body, 3, 0, (rest, Restriction("", zero=(w1,)))).series(w2).is_zero
    steady = Motion(SPRING, 3, 0, (Restriction("x constant", held=(x,)),))
    assert steady.series(v).is_zero
    assert steady.series(k).is_zero
    with pytest.raises(Inconsistent):
        Motion(SPRING, 3, 0, (Restriction("time stands", held=(SPRING.time,)),))


def test_what_has_no_value():
    motion = Motion(SPRING, 2, 0)
    with pytest.raises(InputError, match="no value"):
        motion.series(sp.gamma(x))
    with pytest.raises(InputError, match="no sum of angles"):
        motion.series(sp.sin(x / 3))
    with pytest.raises(InputError, match="no exact value"):
        motion.series(x ** (k / m))
    with pytest.raises(InputError, match="more derivatives"):
        motion.series(rate(rate(rate(x))))
    with pytest.raises(Singular):
        motion.series(1 / (x - x * k / k + 0 * v + sp.sin(v) ** 2 + sp.cos(v) ** 2 - 1))


def test_roots_and_inverse_functions_are_decided_by_numbers():
    energy = sp.sqrt(m * v**2 + k * x**2)
    assert inexact(SPRING, energy)
    assert not inexact(SPRING, energy**2)
    assert Motion(SPRING, 3, 1).series(rate(energy**2)).is_zero
    assert differs(SPRING, rate(energy), x)
    assert not differs(SPRING, rate(energy), sp.Integer(0))
    assert not differs(SPRING, sp.atan2(v, x), sp.atan2(v * 2, x * 2))
    assert without_rates(SPRING, rate(rate(x))) == -k * x / m
    top = heavy_top()
    point = real_point(top, 0)
    assert sum(point[q.symbol] ** 2 for q in top.states if q.name.startswith("q")) == 1


def test_orders_and_spreads():
    assert order(rate(x + rate(v))) == 2
    assert spread((x + v) * (k + m + a)) == 6
    assert spread((x + v) ** 3) == 8
    assert spread((x + v) ** 1000) == ENDLESS
