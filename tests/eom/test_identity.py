"""Exact randomised equality: true identities are accepted and every small mutant is refused."""

from __future__ import annotations

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.exact.identity import equal, vanishes
from eom.mechanics.rigidbody import is_invariant
from eom.quantities import Quantity
from eom.system import System
from tests.draws import examples

x, y, z, k, m = sp.symbols("x y z k m", real=True)
sin, cos, tan, exp, sqrt = sp.sin, sp.cos, sp.tan, sp.exp, sp.sqrt

IDENTITIES = {
    "Pythagoras": (sin(x) ** 2 + cos(x) ** 2, sp.Integer(1)),
    "double angle": (sin(2 * x), 2 * sin(x) * cos(x)),
    "triple angle": (cos(3 * x), 4 * cos(x) ** 3 - 3 * cos(x)),
    "sum of angles": (sin(x + 2 * y), sin(x) * cos(2 * y) + cos(x) * sin(2 * y)),
    "tangent": (tan(x) * cos(x), sin(x)),
    "pole": (1 / cos(x) ** 2 - tan(x) ** 2, sp.Integer(1)),
    "partial fractions": (1 / (x * (x + 1)), 1 / x - 1 / (x + 1)),
    "negative angle": (sin(x - y), -sin(y - x)),
    "cosecant": (sp.csc(x) * sin(x) + sp.sec(y) * cos(y) + sp.cot(x) * tan(x), sp.Integer(3)),
    "unknown function": (sp.tanh(x) * (sp.tanh(x) + y), sp.tanh(x) ** 2 + y * sp.tanh(x)),
    "root as unknown": (sqrt(x + y) * y, y * sqrt(x + y)),
    "floats": (0.5 * x + 0.5 * x, x),
    "binomial": ((x + y) ** 5, sp.expand((x + y) ** 5)),
}


@pytest.mark.parametrize("name", IDENTITIES)
def test_identities_are_accepted(name):
    left, right = IDENTITIES[name]
    assert equal(left, right)
    assert vanishes(left - right, seed=7)


MUTANTS = [
    (sin(x) ** 2 - cos(x) ** 2, 1),
    (sin(2 * x), sin(x) * cos(x)),
    (sin(2 * x), 2 * sin(x) * sin(x)),
    (sin(x + y), sin(x) * cos(y) - cos(x) * sin(y)),
    (cos(3 * x), 4 * cos(x) ** 3),
    (cos(3 * x), 4 * cos(x) ** 3 - 3 * sin(x)),
    (tan(x), sin(x)),
    (tan(x), cos(x) / sin(x)),
    (1 / x, 1 / (x + 1)),
    (x, x + sp.Rational(1, 10**12)),
    (exp(x), exp(y)),
    (sin(x), x),
    (x**y, x**z),
    (sin(x * y), sin(x) * y),
    (sp.pi, 3),
]


@pytest.mark.parametrize(("left", "right"), MUTANTS)
def test_mutants_are_refused(left, right):
    assert not equal(sp.sympify(left), sp.sympify(right))


coefficient = st.integers(-3, 3).filter(bool)
trig = st.sampled_from([sin(x), cos(x), sin(2 * y), cos(x + y), tan(y), x, z])
polynomials = st.lists(st.tuples(coefficient, trig, trig), min_size=2, max_size=4).map(
    lambda terms: [c * a * b for c, a, b in terms]
)


@examples(60)
@given(terms=polynomials, edit=st.sampled_from(["sign", "factor", "drop"]), data=st.data())
def test_single_edits_of_random_expressions_are_found(terms, edit, data):
    """The oracle is the edited term itself: the difference is a multiple of it, and not zero."""
    j = data.draw(st.integers(0, len(terms) - 1))
    factor = {"sign": -1, "factor": 2, "drop": 0}[edit]
    mutant = [t * factor if i == j else t for i, t in enumerate(terms)]
    original = sp.Add(*terms)
    assert equal(original, sp.expand(sp.Add(*reversed(terms)), trig=True))
    assert not equal(original, sp.Add(*mutant))


def test_matrices_are_compared_entry_by_entry():
    A = sp.Matrix([[sin(x) ** 2, x], [y, 1]])
    assert equal(A, sp.Matrix([[1 - cos(x) ** 2, x], [y, 1]]))
    assert not equal(A, sp.Matrix([[1 - cos(x) ** 2, x], [y, 2]]))
    assert not equal(A, sp.Matrix([[sin(x) ** 2, x, y, 1]]))


def test_expression_with_a_pole_everywhere_is_not_called_zero():
    hidden = (x + 1) ** 2 - x**2 - 2 * x - 1
    assert vanishes(hidden)
    assert not vanishes(1 / hidden)


def test_deep_expressions_do_not_overflow_the_stack():
    deep = x
    for _ in range(3000):
        deep = sp.Add(sp.Mul(deep, y, evaluate=False), 1, evaluate=False)
    assert not vanishes(deep)
    assert vanishes(sp.Add(deep, sp.Mul(-1, deep, evaluate=False), evaluate=False))


def oscillator(mass=None):
    return System(
        name="oscillator",
        states=(Quantity(x), Quantity(y)),
        rates=(y, -k * x / m) if mass is None else (y, -k * x),
        parameters=(Quantity(k), Quantity(m)),
        mass_matrix=mass,
    )


ENERGY = m * y**2 / 2 + k * x**2 / 2


@pytest.mark.parametrize("mass", [None, sp.diag(1, m)])
def test_energy_of_an_oscillator_and_its_mutants(mass):
    system = oscillator(mass)
    assert is_invariant(system, ENERGY)
    assert is_invariant(system, sqrt(ENERGY))
    assert is_invariant(system, sp.Integer(3))
    mutants = [m * y**2 / 2 - k * x**2 / 2, y**2 / 2 + k * x**2 / 2, m * y**2 + k * x**2 / 2]
    mutants += [m * y**2 / 2, x, ENERGY + x / 10**9]
    assert not any(is_invariant(system, mutant) for mutant in mutants)


def test_invariant_under_a_coupled_mass_matrix():
    """M q'' = -k q in first order, with coupling; momentum conjugate to the free direction."""
    mass = sp.Matrix([[2, 1, 0], [1, 3, 0], [0, 0, 1]])
    system = System(
        name="coupled",
        states=(Quantity(x), Quantity(y), Quantity(z)),
        rates=(-z, z, x + y),
        mass_matrix=sp.ImmutableMatrix(mass),
    )
    # (row 1 + row 2): 3 x' + 4 y' = 0
    assert is_invariant(system, 3 * x + 4 * y)
    assert not is_invariant(system, 3 * x + 5 * y)
    assert not is_invariant(system, 2 * x + 4 * y)


def test_singular_mass_matrix_decides_nothing():
    singular = System(
        name="singular",
        states=(Quantity(x), Quantity(y)),
        rates=(x, y),
        mass_matrix=sp.ImmutableMatrix([[1, 1], [1, 1]]),
    )
    assert not is_invariant(singular, x)


def test_explicit_time_counts():
    t = sp.Symbol("t", real=True)
    system = System.from_rates("drift", {x: sp.Integer(2)}, time=t)
    assert is_invariant(system, x - 2 * t)
    assert not is_invariant(system, x - t)


def test_same_seed_gives_the_same_answer():
    assert [vanishes(sin(x) - x, seed=s) for s in range(5)] == [False] * 5


def test_nothing_that_contains_an_input_is_constant():
    """An input may change with time: energy with a driven torque is no constant."""
    u = sp.Symbol("u", real=True)
    v = sp.Symbol("v", real=True)
    q = sp.Symbol("q", real=True)
    energy = v**2 / 2 - u * q
    driven = System.from_rates("driven", {q: v, v: u}, inputs=[u])
    steady = System.from_rates("steady", {q: v, v: u})
    assert is_invariant(steady, energy)
    assert not is_invariant(driven, energy)
