"""Passes keep values: prune, specialise, constants."""

from fractions import Fraction

import mpmath
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import eom
from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir import passes
from codegen.ir.interpret import Point, interpret, interpret_exactly

x, y, p, q, r = sp.symbols("x y p q r", real=True)
GROUPS = {
    "f": [x * p + sp.sin(y * q), x],
    "g": [sp.sqrt(2) * sp.pi * r + x / p, sp.Piecewise((p, x < q), (y, True))],
    "h": [],
}
POINT = Point(0.0, [0.3, -1.2], [1.5, 0.7, -0.4])


@pytest.fixture
def program():
    return lower_expressions(GROUPS, (x, y), (p, q, r))


@pytest.mark.parametrize("groups", [None, ["f"], ["g"], ["h"], ["g", "f"], []])
def test_prune_keeps_values_and_nothing_else(program, groups):
    small = passes.prune(program, groups)
    names = list(GROUPS) if groups is None else groups
    assert list(small.results) == names
    whole, part = interpret(program, POINT), interpret(small, POINT)
    assert part == {g: whole[g] for g in names}
    needed = {k for group in small.results.values() for k in group}
    needed |= {a for i in small.instructions for a in i.args}
    assert needed == set(range(len(small.instructions)))


def test_prune_twice_is_prune_once(program):
    once = passes.prune(program, ["g"])
    assert str(passes.prune(once)) == str(once)


def test_prune_keeps_the_names_of_what_stays():
    program = lower_system(eom.gravity_gradient_satellite())
    small = passes.prune(program, ["rates"])
    assert {n.name for n in small.names.values()} <= {n.name for n in program.names.values()}
    assert "radial_1" in {n.name for n in small.names.values()}


def specialised(program, values, count):
    """Fix parameter slots to numbers; those that are left close ranks."""
    rest = [k for k in range(count) if k not in values]
    leaves = {("parameter", old): ("parameter", new) for new, old in enumerate(rest)}
    numbers = {("parameter", k): Fraction(v) for k, v in values.items()}
    return passes.substitute(program, leaves | numbers)


@settings(max_examples=50)
@given(
    st.dictionaries(st.integers(0, 2), st.sampled_from([0.0, 1.0, -1.0, 0.1, 2.0, 1e300, -7.25]))
)
def test_specialised_programs_have_the_values_of_the_general_one(values):
    program = lower_expressions(GROUPS, (x, y), (p, q, r))
    special = specialised(program, values, 3)
    given_ = [values.get(k, POINT.p[k]) for k in range(3)]
    rest = [v for k, v in enumerate(POINT.p) if k not in values]
    whole = interpret_exactly(program, Point(0.0, POINT.x, given_))
    part = interpret_exactly(special, Point(0.0, POINT.x, rest))
    for group, numbers in whole.items():
        for a, b in zip(numbers, part[group], strict=True):
            undefined = mpmath.isnan(a) and values.get(0) == 0
            assert a == b or abs(a - b) <= 1e-45 * abs(a) or undefined
    slots = {i.value for i in special.instructions if i.op == "parameter"}
    assert slots <= set(range(len(rest)))
    assert special.cost() <= program.cost()


def test_fixed_parameters_are_exact_and_fold(program):
    special = specialised(program, {0: 0.1}, 3)
    constants = {i.value for i in special.instructions if i.op == "const"}
    assert sp.Rational(0.1) in {sp.Rational(c.numerator, c.denominator) for c in constants}
    everything = specialised(program, {0: 1.0, 1: 0.0, 2: 0.0}, 3)
    assert not any(i.op == "parameter" for i in everything.instructions)
    assert "mul" not in everything.counts()


@pytest.mark.parametrize(
    ("exponent", "expected"),
    [
        (2.0, {"mul": 1}),
        (-3.0, {"mul": 2, "div": 1}),
        (1.5, {"mul": 1, "sqrt": 1}),
        (-0.5, {"div": 1, "sqrt": 1}),
        (1.0, {}),
        (0.3, {"pow": 1}),
        (200.0, {"pow": 1}),
    ],
)
def test_exponents_that_are_fixed_become_products(exponent, expected):
    program = lower_expressions({"f": [x**p]}, [x], [p])
    special = specialised(program, {0: exponent}, 1)
    assert special.counts() == expected
    (value,) = interpret_exactly(special, Point(x=[1.7]))["f"]
    with mpmath.workdps(50):
        assert abs(value - mpmath.mpf(1.7) ** mpmath.mpf(exponent)) < 1e-40 * value
