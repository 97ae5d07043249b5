"""Derivatives of programs with many exact numbers: as with parameters, finite, of like size and work."""

from fractions import Fraction

import numpy as np
import pytest

from codegen.derivatives.derivative import JACOBIAN, ORDERS, jacobian
from codegen.derivatives.forms import COEFFICIENT_BITS
from codegen.ir import scalars
from codegen.ir.interpret import Point, interpret
from codegen.ir.program import RATES, Builder
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.recursion.lumped_tree import lumped_tree
from eom.multibody.recursion.recursions import forward_dynamics
from tests.clock import growth_in_calls
from tests.eom.multibody.trees import state, tree

WIDTH = 3


def lifting(b, known, as_constants):
    """Numbers as constants of the program or as its parameters, kept in ``known``; signs are structure."""

    def lifted(number):
        if number in (0, 1, -1):
            return number
        if as_constants:
            return scalars.constant(b, number)
        return scalars.Scalar(b, b.leaf("parameter", known.setdefault(number, len(known))))

    return lifted


def levels(count, as_constants=True):
    """Values mixed level by level with fractions of ever other denominators, and the parameters."""
    b, known = Builder(), {}
    lifted = lifting(b, known, as_constants)
    x = scalars.scalars(b, "state", WIDTH)
    for k in range(count):
        sums = [
            sum(
                lifted(Fraction(i + j + 2 * k + 2, 3 * i + 5 * j + 7 * k + 11)) * x[j]
                for j in range(WIDTH)
            )
            for i in range(WIDTH)
        ]
        x = [sums[0] * sums[0], *map(scalars.sin, sums[1:])]
    return scalars.program(b, {RATES: x}), known


def dynamics(given, as_constants):
    """The program of forward dynamics of a tree, and the parameters."""
    b, known = Builder(), {}
    work = Numbers(scalars.sin, scalars.cos)
    lumped = lumped_tree(given, lifting(b, known, as_constants), work)
    n, m = (sum(len(part(j)) for j in given.ordered) for part in (_coordinates, _speeds))
    x = scalars.scalars(b, "state", n + m)
    tau = scalars.scalars(b, "input", m)
    return scalars.program(b, {RATES: forward_dynamics(lumped, x[:n], x[n:], tau, work)}), known


def _coordinates(joint):
    return joint.coordinates


def _speeds(joint):
    return joint.speeds


def entries(found, x, known):
    """The entries by their places."""
    point = Point(x=x, p=[float(n) for n in known], u=[0.5] * len(x))
    return dict(zip(found.pattern, interpret(found.program, point)[JACOBIAN], strict=True))


def assert_same(numbers, parameters, x, mode, ratio):
    """The derivatives are the same to 1e-12 of the largest, finite, and cost at most ``ratio`` as much."""
    (one, none), (other, known) = numbers, parameters
    assert none == {}
    assert known
    found, expected = (jacobian(p, RATES, modes=(mode,)) for p in (one, other))
    ours, theirs = entries(found, x, none), entries(expected, x, known)
    largest = max(map(abs, theirs.values()))
    assert np.isfinite(list(ours.values())).all()
    for place in ours.keys() | theirs.keys():
        difference = abs(ours.get(place, 0.0) - theirs.get(place, 0.0))
        assert difference <= 1e-12 * largest, place
    assert found.program.cost() <= ratio * expected.program.cost()


@pytest.mark.sparse(1)
@pytest.mark.parametrize("mode", ORDERS)
def test_numbers_that_meet_level_by_level(mode):
    """With denominators cleared level by level, numbers pass 1e308 here."""
    assert_same(levels(60), levels(60, as_constants=False), (0.3, 0.4, 0.5), mode, 1.0)


def test_constants_of_a_derivative_stay_short():
    """However deep the program: products of two numbers are constants, products of many are not."""
    for count in (10, 60):
        program = jacobian(levels(count)[0], RATES, modes=("forward",)).program
        constants = [i.value for i in program.instructions if i.op == "const"]
        own = max(7 * count, 2**COEFFICIENT_BITS).bit_length() + 2
        assert max(max(abs(c.numerator), c.denominator) for c in constants).bit_length() <= 2 * own


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "count", "kinds"),
    [
        (2, 3, ("revolute", "prismatic", "universal")),
        (7, 3, ("revolute", "prismatic", "universal")),
        (0, 3, ("spherical", "cylindrical", "helical")),
        (3, 3, ("spherical", "cylindrical", "helical")),
    ],
)
def test_trees_with_numbers_and_with_parameters(seed, count, kinds):
    given = tree(seed, count, kinds=kinds)
    x = [float(v) for group in state(given, seed) for v in group]
    assert_same(dynamics(given, True), dynamics(given, False), x, "forward", 1.5)


def differentiated(count):
    return jacobian(levels(count)[0], RATES, modes=("mixed",)).program


@pytest.mark.slow
def test_size_and_work_are_linear_in_the_depth():
    assert differentiated(40).cost() <= 2.1 * differentiated(20).cost()
    assert growth_in_calls(2.4, differentiated, 20, 40)
