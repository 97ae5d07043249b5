"""Tables in programs and targets: value, derivative, corners, ends, whole simulations, same bytes."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import eom
from codegen import compile as compile_system
from codegen import compiled_jacobian, simulate
from codegen.frontend.lower import lower_expressions
from codegen.ir.interpret import Point, interpret, interpret_exactly, interpret_with_bound

pytestmark = pytest.mark.shipped_flags

x, y = sp.symbols("x y", real=True)
ODD = [-1.0, -0.25, 0.1, 0.7, 3.0], [2.0, -1.0, 1 / 3, 1 / 3, 1e3]
TABLES = [eom.Table("curve", *ODD, kind, outside, order)
          for kind in ("linear", "cubic", "pchip") for outside in ("hold", "linear")
          for order in (0, 1, 2)]  # fmt: skip
EXTREME = [*ODD[0], -0.0, 0.0, 5e-324, math.nextafter(0.1, 0), math.nextafter(0.1, 1),
           math.nextafter(3, 4), math.nextafter(-1, -2), -1e300, 1e300, 0.5, 2.9]  # fmt: skip


def compiled_tables(target):
    outputs = {f"f{k}": t(x) for k, t in enumerate(TABLES)}
    return compile_system(eom.System.from_rates("tables", {x: -x}, outputs=outputs), target)


def test_values_are_exact_at_fifty_digits_and_doubles_within_the_bound(target):
    compiled = compiled_tables(target)
    batch = compiled.outputs(0.0, np.array([EXTREME]))
    for k, at in enumerate(EXTREME):
        exact = interpret_exactly(compiled.program, Point(x=[at]))["outputs"]
        bounds = interpret_with_bound(compiled.program, Point(x=[at]))["outputs"]
        one = compiled.outputs(0.0, [at])
        for table, e, bound, several, single in zip(
            TABLES, exact, bounds, batch[:, k], one, strict=True
        ):
            wanted = table.at(Fraction(at)) if table.degree >= 0 else Fraction(0)
            with mpmath.workdps(50):
                assert abs(e - mpmath.mpf(wanted.numerator) / wanted.denominator) <= 1e-45 * (
                    1 + abs(e)
                )
            assert abs(several - e) <= bound.error
            assert several == single


def test_what_is_not_finite_stays_so(target):
    compiled = compiled_tables(target)
    assert np.isnan(compiled.outputs(0.0, [math.nan])[[t.degree >= 0 for t in TABLES]]).all()
    for at in (math.inf, -math.inf):
        for table, value in zip(TABLES, compiled.outputs(0.0, [at]), strict=True):
            end = table.breakpoints[-1 if at > 0 else 0] + math.copysign(1, at)
            if table.flat_outside:
                assert value == float(table.at(Fraction(end)))
            else:
                assert not math.isfinite(value)


@pytest.mark.sparse(only=("numpy",))
@settings(max_examples=40)
@given(st.lists(st.floats(-3, 5), min_size=1, max_size=8))
def test_random_points_stay_within_the_bound(target, points):
    compiled = compiled_tables(target)
    got = compiled.outputs(0.0, np.array([points]))
    for k, at in enumerate(points):
        bounds = interpret_with_bound(compiled.program, Point(x=[at]))["outputs"]
        doubles = interpret(compiled.program, Point(x=[at]))["outputs"]
        for value, double, bound in zip(got[:, k], doubles, bounds, strict=True):
            assert abs(value - bound.value) <= bound.error
            assert abs(double - bound.value) <= bound.error


@pytest.mark.sparse(3)
@pytest.mark.parametrize("kind", ["linear", "cubic", "pchip"])
def test_the_jacobian_is_that_of_sympy(kind, target):
    table = eom.Table("curve", *ODD, kind)
    e = sp.sin(table(x * y)) * y
    system = eom.System.from_rates("curves", {x: e, y: table(y) ** 2})
    jacobian = compiled_jacobian(compile_system(system, target))
    for at in ((0.3, 0.9), (-4.0, 2.0), (0.0, 0.0), (3.0, 1.0)):
        numbers = dict(zip((x, y), map(sp.Rational, at), strict=True))
        expected = sp.Matrix([e, table(y) ** 2]).jacobian([x, y]).xreplace(numbers).evalf(30)
        found = jacobian.dense(0.0, at)
        np.testing.assert_allclose(
            found, np.array(expected.tolist(), dtype=float), rtol=1e-12, atol=1e-13
        )


def test_a_pendulum_with_a_measured_friction_moves_as_with_scipy(target):
    speeds, torques = [-4.0, -1.0, 0.0, 1.0, 4.0], [-0.9, -0.2, 0.0, 0.2, 0.9]
    friction = eom.Table("friction", speeds, torques, "cubic", "linear")
    system = eom.System.from_rates("pendulum", {x: y, y: -sp.sin(x) - friction(y)})
    result = simulate(
        compile_system(system, target), {"x": 2.0, "y": 0.0}, (0, 10), rtol=1e-9, atol=1e-9
    )
    spline = CubicSpline(speeds, torques)
    other = solve_ivp(lambda t, s: [s[1], -np.sin(s[0]) - spline(s[1])], (0, 10), [2.0, 0.0],
                      method="DOP853", rtol=1e-11, atol=1e-11)  # fmt: skip
    assert result.success
    np.testing.assert_allclose(result.y[:, -1], other.y[:, -1], atol=1e-6)


def test_equal_tables_are_one_and_the_text_is_the_same():
    first, second = (eom.Table("a", list(b), [1, 2, 3]) for b in ((0, 1, 2), (0.0, 1.0, 2.0)))
    program = lower_expressions({"f": [first(x) + second(x), first(x).diff(x)]}, [x])
    assert program.counts() == {"mul": 1, "table": 2}
    assert "table 'a' 0" in str(program)
    assert 'table "a\'" 0' in str(program)
    texts = [dict(compile_system(eom.System.from_rates("one", {x: t(x)}), "numpy").files)
             for t in (first, second)]  # fmt: skip
    assert texts[0] == texts[1]
    zero = lower_expressions({"f": [first.derivative.derivative(x)]}, [x])
    assert str(zero).endswith("const 0\nf: 1")


def test_tables_of_many_points_are_searched_not_scanned(target):
    """Ten thousand breakpoints: every value right, from a batch over all of them."""
    at = np.cumsum(np.random.default_rng(3).uniform(0.1, 1, 10_000))
    values = np.sin(at)
    table = eom.Table("long", at, values)
    compiled = compile_system(eom.System.from_rates("long", {x: table(x)}), target)
    middle = (at[1:] + at[:-1]) / 2
    np.testing.assert_allclose(
        compiled.rhs(0.0, middle[None, :])[0], (values[1:] + values[:-1]) / 2, atol=1e-11
    )
