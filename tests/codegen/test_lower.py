"""SymPy expressions become programs: powers, sums, deep nests, mass matrices, refusals."""

import mpmath
import pytest
import sympy as sp

from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir.interpret import Point, interpret, interpret_exactly
from codegen.ir.passes import prune
from eom.errors import InputError
from eom.quantities import Quantity
from eom.system import System

x, y, p, q = sp.symbols("x y p q", real=True)


def lowered(e):
    return lower_expressions({"f": [e]}, (x, y), (p, q))


def value(e, numbers, digits=50):
    return interpret_exactly(lowered(e), Point(0.0, numbers[:2], numbers[2:]), digits)["f"][0]


EXPONENTS = [*range(-9, 0), *range(1, 10),
             31, 32, 63, 64, 65, 100, -64, -65, sp.Rational(1, 2), sp.Rational(-1, 2),
             sp.Rational(3, 2), sp.Rational(-7, 2), sp.Rational(1, 3), sp.Rational(-5, 3),
             sp.Rational(129, 2), sp.Float(0.5), sp.Float(1.7)]  # fmt: skip


@pytest.mark.parametrize("exponent", EXPONENTS, ids=str)
def test_powers_have_their_value(exponent):
    with mpmath.workdps(50):
        n = sp.Rational(exponent)
        exact = mpmath.power(mpmath.mpf(1.3), mpmath.mpf(n.p) / n.q)
        for e in (x**exponent, y * x**exponent / y, 3 * x**exponent):
            got = value(e, [1.3, 0.7, 1.0, 1.0])
            factor = 3 if e.is_Mul else 1
            assert abs(got - factor * exact) < 1e-44 * exact


def test_small_whole_powers_are_products_and_large_ones_are_not():
    assert lowered(x**64).counts() == {"mul": 6}
    assert lowered(x**15).counts() == {"mul": 6}
    assert lowered(x**65).counts() == {"pow": 1}
    assert lowered(x**-2).counts() == {"mul": 1, "div": 1}
    assert lowered(sp.sqrt(x)).counts() == {"sqrt": 1}
    assert lowered(x ** sp.Rational(3, 2)).counts() == {"mul": 1, "sqrt": 1}


def test_products_are_one_quotient_and_sums_start_positive():
    assert lowered(x * y / (p * q)).counts() == {"mul": 2, "div": 1}
    assert lowered(-x + y).counts() == {"sub": 1}
    assert lowered(-x - y).counts() == {"add": 1, "neg": 1}
    assert lowered(2 * x + 2 * y).counts() == {"add": 1, "mul": 1}
    assert lowered(x / 2 - y / 2).counts() == {"sub": 1, "mul": 1}
    assert lowered(x / 3).counts() == {"div": 1}


def test_shared_parts_are_computed_once():
    part = sp.sin(x * y + p)
    assert lowered(part**2 + q * part + sp.exp(part)).counts()["sin"] == 1


def test_deep_expressions_need_no_recursion():
    e, depth = x, 5000
    for _ in range(depth):
        e = sp.Add(sp.Mul(sp.Rational(1, 2), e, evaluate=False), p, evaluate=False)
        hash(e)
    program = lowered(e)
    got = interpret(program, Point(0.0, [1.0, 0.0], [3.0, 0.0]))["f"][0]
    assert got == pytest.approx(6.0, abs=1e-12)
    assert len(program.instructions) < 4 * depth


@pytest.mark.parametrize(
    "e",
    [
        sp.gamma(x), sp.I * x, sp.zoo, sp.oo, -sp.oo, sp.nan, sp.zeta(x), sp.besselj(sp.Rational(1, 2), x),
        sp.Function("f")(x), sp.Derivative(sp.Function("f")(x), x), sp.Integral(x, x), sp.Symbol("u"),
        sp.re(sp.Symbol("z")), sp.DiracDelta(x), x + sp.erfi(y), sp.besselj(p, x),
        sp.besseli(1, x), sp.Matrix([x]), sp.MatrixSymbol("A", 2, 2), sp.Symbol("x"), x ** sp.Symbol("n"),
    ],
    ids=str,
)  # fmt: skip
def test_what_no_operation_computes_is_refused(e):
    with pytest.raises(InputError) as error:
        lowered(e)
    assert error.value.got


def test_a_piecewise_with_a_gap_is_refused():
    with pytest.raises(InputError, match="does not cover every case") as error:
        lowered(sp.Piecewise((x, x > 0), (y, x < -1)))
    assert "(value, True)" in error.value.hint


def test_the_name_of_the_system_is_in_the_error():
    system = System("odd", (Quantity(x),), (sp.gamma(x),))
    with pytest.raises(InputError) as error:
        lower_system(system)
    assert "odd" in error.value.where


def test_diagonal_mass_matrices_cost_one_division_a_row():
    system = System(
        "diagonal", (Quantity(x), Quantity(y)), (y, -x), (Quantity(p), Quantity(q)),
        mass_matrix=sp.ImmutableMatrix([[p, 0], [0, q]]),
    )  # fmt: skip
    assert prune(lower_system(system)).counts() == {"div": 2, "neg": 1}


@pytest.mark.parametrize(
    ("e", "expected"),
    [(-2 * x - 3 * y, 4.5), (-3 * x - 3 * y, 3.75), (-x - y, 1.25), (2 * y - 5 * x, -7.75)],
)
def test_sums_keep_their_coefficients(e, expected):
    assert value(e, (0.75, -2.0, 0.0, 0.0)) == expected
