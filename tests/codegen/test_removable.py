"""Quotients that are 0/0 at zero: value, first and second derivative from 1e-300 across the cutoffs."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy as sp

from codegen import compile as compile_system
from codegen import compiled_jacobian
from codegen.derivatives.derivative import JACOBIAN, jacobian
from codegen.frontend.lower import lower_expressions
from codegen.frontend.removable_singularities import ROWS, Removable, rewrite
from codegen.ir.interpret import Point, interpret
from codegen.ir.program import RATES
from eom.system import System

pytestmark = pytest.mark.sparse

x, y, z, a = sp.symbols("x y z a", real=True)
s = sp.Symbol("s", positive=True)
UNIT = 2.0**-52

QUOTIENTS = {
    "sin": sp.sin(x) / x, "1 - cos": (1 - sp.cos(x)) / x**2, "x - sin": (x - sp.sin(x)) / x**3,
    "sinh": sp.sinh(x) / x, "cosh - 1": (sp.cosh(x) - 1) / x**2, "sinh - x": (sp.sinh(x) - x) / x**3,
    "tan": sp.tan(x) / x, "tanh": sp.tanh(x) / x, "asin": sp.asin(x) / x, "atan": sp.atan(x) / x,
    "asinh": sp.asinh(x) / x, "atanh": sp.atanh(x) / x, "expm1": (sp.exp(x) - 1) / x,
    "log1p": sp.log(1 + x) / x,
}  # fmt: skip
ENDS = {"asin": 0.98, "atanh": 0.98, "tan": 1.45, "log1p": 0.98}
BOUNDS = (2, 6, 12)
"""Units in the last place of value, first and second derivative."""


def sweep(name):
    cutoff = float(ROWS[name].cutoff)
    end = min(ENDS.get(name, math.inf), 3 * cutoff)
    sizes = np.concatenate([
        10.0 ** np.arange(-300, -20, 40), np.geomspace(1e-20, cutoff, 25),
        cutoff * (1 + np.array([-0.01, -1e-3, -1e-9, 0, 1e-9, 1e-3])), np.linspace(cutoff, end, 12),
    ])  # fmt: skip
    return np.concatenate([[0.0], sizes, -sizes])


def derivatives(e):
    """A program of e and its first two derivatives, the second from differentiating twice."""
    once = jacobian(lower_expressions({RATES: [e]}, [x]), RATES).program
    together = (*once.results[RATES], *once.results[JACOBIAN])
    twice = jacobian(replace(once, results={RATES: together}), RATES).program
    found = (*twice.results[RATES], twice.results[JACOBIAN][-1])
    return replace(twice, results={"f": found})


def exact_derivatives(e, points):
    """Value and derivatives by SymPy's own formulas, with digits for what cancels in them."""
    functions = [sp.lambdify(x, e.diff(x, k), "mpmath") for k in range(3)]
    limits = [sp.series(e, x, 0, 4).removeO().coeff(x, k) * math.factorial(k) for k in range(3)]
    rows = []
    for at in points:
        with mpmath.workdps(60 + int(6 * max(0, -math.log10(abs(at) or 1)))):
            v = mpmath.mpf(at)
            rows.append(
                [f(v) for f in functions] if at else [mpmath.mpf(str(c.n(40))) for c in limits]
            )
    return rows, [abs(float(c)) for c in limits]


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", ROWS)
def test_value_and_two_derivatives_are_right_near_and_at_zero(name):
    points = sweep(name)
    program = derivatives(QUOTIENTS[name])
    rows, limits = exact_derivatives(QUOTIENTS[name], points)
    for at, exact in zip(points, rows, strict=True):
        got = interpret(program, Point(x=[at]))["f"]
        sizes = [abs(float(exact[0])), max(abs(float(exact[1])), min(abs(at), 1) * limits[2], limits[1]),
                 max(abs(float(exact[2])), limits[2])]  # fmt: skip
        for g, e, size, units in zip(got, exact, sizes, BOUNDS, strict=True):
            assert abs(mpmath.mpf(g) - e) <= units * UNIT * size + 1e-305, (at, g, e)


@pytest.mark.sparse(only=("numpy",))
def test_each_target_is_right_near_and_at_zero(target):
    e = list(QUOTIENTS.values())
    system = System.from_rates("quotients", {x: sp.Integer(0)},
                               outputs={f"f{k}": q for k, q in enumerate(e)})  # fmt: skip
    compiled = compile_system(system, target)
    slopes = compiled_jacobian(compiled, of="outputs")
    points = np.array(
        [0.0, -0.0, 5e-324, 1e-300, -1e-160, 1e-20, 1e-8, -1e-8, 1e-4, -0.01, 0.3, 0.74]
    )
    values, rates = compiled.outputs(0.0, points[None, :]), slopes.dense(0.0, points[None, :])[:, 0]
    for k, quotient in enumerate(e):
        rows, limits = exact_derivatives(quotient, points)
        for at, exact, value, rate in zip(points, rows, values[k], rates[k], strict=True):
            assert abs(value - exact[0]) <= BOUNDS[0] * UNIT * abs(exact[0])
            size = max(abs(exact[1]), min(abs(at), 1) * limits[2], limits[1])
            assert abs(rate - exact[1]) <= BOUNDS[1] * UNIT * size + 1e-305


RECOGNISED = [
    sp.sin(x) / x, x / sp.sin(x), a * sp.sin(x) / (2 * x), sp.sin(a * x) / x, sp.sin(x / 2) / x,
    sp.tan(x) ** 2 / x**2, x * sp.cot(x), x * sp.csch(x), sp.sinc(x), sp.sin(x) * sp.sin(y) / (x * y),
    (2 - 2 * sp.cos(x)) / x**2, (sp.cos(x) - 1) / x, (a * x - sp.sin(a * x)) / x**3, x / (sp.exp(x) - 1),
    (1 - sp.exp(-x)) / x, sp.log(1 + x) / x, sp.sin(2 * x - 2) / (x - 1), (x - sp.sin(x)) / x**2,
    (x + y - sp.sin(x + y)) / (x + y) ** 3, sp.asin(x) / x, sp.sin(sp.sqrt(s)) / sp.sqrt(s),
    (1 - sp.cos(sp.sqrt(s))) / s, sp.sin(sp.sqrt(x**2 + y**2)) / sp.sqrt(x**2 + y**2),
    sp.sin(sp.Abs(x)) / sp.Abs(x), sp.sqrt(sp.sin(x) / x),
]  # fmt: skip


@pytest.mark.parametrize("e", RECOGNISED, ids=str)
def test_quotients_are_recognised_and_keep_their_value(e):
    names = [x, y, a, s]
    program = lower_expressions({"f": [e]}, names)
    assert program.counts().get("stumpff", 0) > 0
    assert not sp.Mul.make_args(e) or not rewrite(e).has(sp.zoo, sp.nan)
    for values in ((0.7, -0.4, 1.3, 0.2), (5.1, 2.3, 0.4, 7.0)):
        at = dict(zip(names, map(sp.Rational, values), strict=True))
        expected = sp.N(e.xreplace(at), 30)
        (got,) = interpret(program, Point(x=values))["f"]
        if expected.is_real:
            assert got == pytest.approx(float(expected), rel=2e-15)
        else:
            assert math.isnan(got)


@pytest.mark.parametrize(
    "e",
    [sp.sin(x) / y, sp.cos(x) / x, x * sp.sin(x), sp.sin(x) / (1 + x), (2 - sp.cos(x)) / x**2,
     (x + sp.sin(x)) / x, sp.exp(x) / x, sp.sin(x) ** a / x, sp.log(x) / x, sp.sin(2 * x) / 2],
    ids=str,
)  # fmt: skip
def test_other_products_are_left_alone(e):
    assert rewrite(e) is e
    assert not e.atoms(Removable)
    assert "stumpff" not in lower_expressions({"f": [e]}, [x, y, a]).counts()


def test_poles_stay_poles():
    program = lower_expressions({"f": [sp.sin(x) / x**2, (1 - sp.cos(x)) / x**3]}, [x])
    assert interpret(program, Point(x=[0.0]))["f"] == [math.inf, math.inf]


def rotation():
    """The rotation vector r as a matrix, by Rodrigues' formula: smooth at zero in truth."""
    r = sp.Matrix([x, y, z])
    n = sp.sqrt(x**2 + y**2 + z**2)
    cross = sp.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = sp.eye(3) + sp.sin(n) / n * cross + (1 - sp.cos(n)) / n**2 * cross**2
    left = sp.eye(3) + (1 - sp.cos(n)) / n**2 * cross + (n - sp.sin(n)) / n**3 * cross**2
    return list(matrix) + list(left * r)


def test_the_rotation_formula_and_its_jacobian_are_right_at_zero(target):
    outputs = {f"f{k}": e for k, e in enumerate(rotation())}
    rates = {v: sp.Integer(0) for v in (x, y, z)}
    compiled = compile_system(System.from_rates("rotation", rates, outputs=outputs), target)
    slopes = compiled_jacobian(compiled, of="outputs")
    zero = [0.0, 0.0, 0.0]
    np.testing.assert_array_equal(compiled.outputs(0.0, zero), [*np.eye(3).ravel(), 0, 0, 0])
    generators = np.zeros((3, 3, 3))
    for k, (i, j) in enumerate([(2, 1), (0, 2), (1, 0)]):
        generators[i, j, k], generators[j, i, k] = 1, -1
    expected = np.vstack([generators.reshape(9, 3), np.eye(3)])
    np.testing.assert_array_equal(slopes.dense(0.0, zero), expected)
    for size in (1e-300, 1e-160, 1e-9, 1e-4):
        near = size * np.array([1.0, -2.0, 0.5])
        np.testing.assert_allclose(slopes.dense(0.0, near), expected, atol=5 * size + 1e-305)
    turned = compiled.outputs(0.0, [0.3, -2.0, 4.0])[:9].reshape(3, 3)
    np.testing.assert_allclose(turned @ turned.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(turned) == pytest.approx(1, rel=1e-14)


ZERO = {
    "root": (sp.sqrt(x), [0.0], [0.0]),
    "norm": (sp.sqrt(x**2 + y**2), [0.0], [0.0, 0.0]),
    "norm of three": (sp.sqrt(x**2 + y**2 + z**2), [0.0], [0.0, 0.0, 0.0]),
    "angle": (sp.atan2(y, x), [0.0], [0.0, 0.0]),
    "asin at 1": (sp.asin(1 + x), [math.pi / 2], [0.0]),
    "acos at -1": (sp.acos(x - 1), [math.pi], [0.0]),
    "power": (x ** sp.Rational(5, 3), [0.0], [0.0]),
    "modulus": (sp.Abs(x), [0.0], [0.0]),
    "tie of max": (sp.Max(x, 2 * y), [0.0], [1.0, 0.0]),
    "tie of min": (sp.Min(x, 2 * y), [0.0], [1.0, 0.0]),
    "power of a modulus": (sp.sign(x) * sp.Abs(x) ** sp.Rational(3, 2), [0.0], [0.0]),
    "quotient of norms": (x * sp.sin(sp.sqrt(x**2 + y**2)) / sp.sqrt(x**2 + y**2), [0.0], [1.0, 0.0]),
    "piece that is not taken": (sp.Piecewise((sp.sin(x) / x**2, x > 1), (y, True)), [0.0], [0.0, 1.0]),
    "least of what is infinite": (sp.Min(1 / x**2, 3), [3.0], [0.0]),
    "root of a root": (sp.sin(sp.sqrt(s)) / sp.sqrt(s), [1.0], [-1 / 6]),
}  # fmt: skip


@pytest.mark.parametrize("name", ZERO)
def test_value_and_jacobian_at_zero_are_finite_and_as_defined(name, target):
    e, value, slopes = ZERO[name]
    states = sorted(e.free_symbols, key=str)
    rates = {v: sp.Integer(0) for v in states}
    compiled = compile_system(System.from_rates(f"zero {name}", rates, outputs={"f": e}), target)
    zero = [0.0] * len(states)
    np.testing.assert_allclose(compiled.outputs(0.0, zero), value, rtol=1e-15)
    found = compiled_jacobian(compiled, of="outputs").dense(0.0, zero)
    np.testing.assert_allclose(found, [slopes], rtol=1e-15)
