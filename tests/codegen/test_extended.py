"""Solutions with many digits against closed forms, and the reference problems as data."""

import sys
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.ir.interpret import constants
from codegen.precision import extended
from eom import problems
from eom.errors import InputError
from eom.quantities import TIME, Quantity
from eom.system import System
from tests.codegen.scenes import SCENES
from tests.conftest import TARGETS

x, y, z = sp.symbols("x y z", real=True)


def end_of(system, start, end, digits=24, parameters=(), max_steps=10_000):
    compiled = codegen.compile(system, "numpy")
    values = extended.Values(start, parameters, ())
    span = (0.0, end)
    return extended.integrate(
        compiled.program, compiled.layout, values, span, digits, max_steps
    ), compiled


def number(fraction):
    return mpmath.mpf(fraction.numerator) / fraction.denominator


@pytest.mark.parametrize("end", [20.0, -3.0])
def test_torque_free_rates_are_sn_cn_dn(end):
    problem = problems.ready("detest-b5")
    solution, compiled = end_of(problem.system, list(problem.start.values()), end)
    (m,) = {abs(v) for v in constants(compiled.program).values() if 0.5 < abs(v) < 0.52}
    with mpmath.workdps(40):
        for value, name in zip(solution.end, ("sn", "cn", "dn"), strict=True):
            exact = mpmath.ellipfun(name, mpmath.mpf(end), m=mpmath.mpf(m))
            assert abs(number(value) - exact) < 1e-22


SMOOTH = {
    "quotient, root": ({x: sp.sqrt(x) / (1 + TIME)}, (1.0,), lambda t: (1 + mpmath.log(1 + t) / 2) ** 2),
    "power": ({x: x ** sp.Rational(3, 2)}, (1.0,), lambda t: 1 / (1 - t / 2) ** 2),
    "tangent": ({x: 1 + x**2 + 0 * y, y: 0 * y}, (0.0, 1.0), mpmath.tan),
    "exponential": ({x: sp.exp(-x)}, (0.0,), lambda t: mpmath.log(1 + t)),
    "sine of time": ({x: sp.sin(TIME) * sp.cos(TIME)}, (0.0,), lambda t: mpmath.sin(t) ** 2 / 2),
}  # fmt: skip


@pytest.mark.parametrize("case", SMOOTH)
def test_functions_have_all_their_digits(case):
    rates, start, exact = SMOOTH[case]
    solution, _ = end_of(System.from_rates("s", rates), start, 0.75)
    with mpmath.workdps(40):
        assert abs(number(solution.end[0]) - exact(mpmath.mpf(0.75))) < 1e-22


def test_solutions_of_linear_systems():
    """A mass matrix that depends on the state: (1 + x^2) x' = 1, so that x + x^3/3 = t."""
    system = System(
        name="m",
        states=tuple(Quantity(s) for s in (x, y)),
        rates=(sp.Integer(1), x),
        mass_matrix=sp.ImmutableMatrix([[1 + x**2, 0], [0, 2 + sp.sin(x)]]),
    )
    solution, _ = end_of(system, (0.0, 0.0), 2.0)
    found = solution.end[0]
    assert abs(found + found**3 / 3 - 2) < Fraction(1, 10**22)


@pytest.mark.parametrize("digits", [12, 18, 24])
def test_digits_are_what_a_step_keeps(digits):
    """The error follows the digits asked for, up to the growth of the solution over the steps."""
    solution, _ = end_of(System.from_rates("s", {x: y, y: -x}), (0.0, 1.0), 30.0, digits)
    with mpmath.workdps(40):
        error = abs(number(solution.end[0]) - mpmath.sin(30))
    assert 0 < error < 10.0 ** (1 - digits)


def _factor(compiled, base, n):
    """base^-n, of which the part that is no power of two is rounded to a double, where there is one."""
    known = [mpmath.mpf(k) for k in constants(compiled.program).values() if k != n]
    sizes = [k for k in known if sys.float_info.min <= abs(k) < mpmath.inf]
    scales = [k for k in sizes if mpmath.frexp(abs(k))[0] == 0.5]
    rest = [k for k in sizes if k not in scales]
    factor = base**-n
    for rounded in rest:
        exact = factor / (scales[0] ** n if scales else 1)
        assert abs(abs(rounded) / exact - 1) < 2.0**-53
        factor *= abs(rounded) / exact
    return factor


HIGH = {
    "a small constant": (sp.Integer(5), 401),
    "a constant below all doubles": (sp.Integer(7), 401),
    "a large constant": (sp.Rational(1, 5), 401),
    "a constant above all doubles": (sp.Rational(1, 7), 401),
}


@pytest.mark.parametrize("case", HIGH)
def test_constants_have_all_their_digits_whatever_their_size(case):
    """x' = -(x/a)^n from a: (x/a)^(1 - n) = 1 + (n - 1) t/a."""
    a, n = HIGH[case]
    rate = -((x / a) ** n)
    solution, compiled = end_of(System.from_rates("s", {x: rate}), (float(a),), float(a) / 64)
    with mpmath.workdps(60):
        start, factor = mpmath.mpf(float(a)), _factor(compiled, mpmath.mpf(a.p) / a.q, n)
        power = start ** (1 - n) + (n - 1) * factor * mpmath.mpf(float(a) / 64)
        exact = power ** (mpmath.mpf(1) / (1 - n))
        assert abs(number(solution.end[0]) / exact - 1) < 1e-21
        assert abs(exact / start - 1) > 1e-3


def test_a_start_and_a_parameter_that_are_tiny_keep_their_digits():
    k = sp.Symbol("k", real=True)
    system = System.from_rates("s", {x: k * x, y: k})
    compiled = codegen.compile(system, "numpy")
    values = extended.Values((1e-150, 0.0), (1e-200,), ())
    found = extended.integrate(compiled.program, compiled.layout, values, (0, 2e200), 24, 1000).end
    with mpmath.workdps(60):
        turn = mpmath.mpf(1e-200) * mpmath.mpf(2e200)
        assert abs(number(found[0]) / (mpmath.mpf(1e-150) * mpmath.exp(turn)) - 1) < 1e-20
        assert abs(number(found[1]) / turn - 1) < 1e-20


def test_numbers_that_are_too_far_apart_are_refused():
    with pytest.raises(InputError, match="too far apart"):
        end_of(System.from_rates("s", {x: x / sp.Integer(7) ** 20_001}), (7.0,), 0.1)


@pytest.mark.parametrize("target", [*TARGETS, "python"])
def test_numbers_beyond_doubles_go_into_the_powers_that_they_multiply(target):
    rates = {x: -((x / 7) ** 401) + (7 / x) ** 401, y: (x / 7) ** 401 * (3 * y) ** 350}
    compiled = codegen.compile(System.from_rates("s", rates), target)
    for at in (6.0, 7.0, 7.25):
        found = compiled.rhs(0.0, np.array([at, 1 / 3]), [], [])
        with mpmath.workdps(40):
            ratio, third = (mpmath.mpf(at) / 7) ** 401, (3 * mpmath.mpf(1 / 3)) ** 350
            exact = [float(1 / ratio - ratio), float(ratio * third)]
        np.testing.assert_allclose(found, exact, rtol=1e-12)


def test_what_has_no_solution_is_refused():
    with pytest.raises(InputError, match="branches"):
        end_of(System.from_rates("s", {x: abs(x) - 1}), (0.5,), 3.0)
    with pytest.raises(InputError, match="many digits"):
        end_of(System.from_rates("s", {x: x**2}), (1.0,), 2.0)
    with pytest.raises(InputError, match="many digits"):
        end_of(System.from_rates("s", {x: y, y: -x}), (0.0, 1.0), 1e6, max_steps=1000)


# --- the reference problems ------------------------------------------------------------------------------


@pytest.mark.slow
def test_every_problem_has_all_its_numbers():
    assert len({row.name for row in problems.PROBLEMS}) == len(problems.PROBLEMS)
    for name in problems.names():
        problem = problems.ready(name)
        assert tuple(problem.start) == problem.system.state_names
        assert set(problem.parameters) == set(problem.system.parameter_names)
        assert problem.source
        assert problem.end > 0
        assert all(np.isfinite([*problem.start.values(), *problem.parameters.values()]))


def test_unknown_problems():
    with pytest.raises(InputError, match="did you mean detest-b5"):
        problems.ready("detest-b4")


def test_the_free_body_is_that_of_the_closed_form():
    problem = problems.ready("free-body-attitude")
    moments, start = list(problem.parameters.values()), list(problem.start.values())
    solution, _ = end_of(problem.system, start, problem.end, parameters=moments)
    motion = codegen.free_motion(moments, start[:3], start[3:])
    omega, q = motion([problem.end])
    found = np.array([float(v) for v in solution.end])
    assert np.abs(omega[:, 0] - found[:3]).max() < 1e-14
    assert np.abs(q[:, 0] - found[3:]).max() < 1e-13


def test_known_closed_forms_are_those_that_are_tested():
    closed = {row.name for row in problems.PROBLEMS if row.closed}
    assert closed == {"detest-b5", "free-body-attitude"}


@pytest.mark.sparse(1)
@pytest.mark.parametrize(
    "name",
    [
        n
        for n in (*(p.name for p in problems.PROBLEMS), *SCENES)
        if n not in {"damped-body-stiff", "gravity-gradient-100"}
    ],
)
def test_invariants_hold_to_all_digits(name):
    """Over the first part of each problem: constants by their expressions, with many digits."""
    problem = problems.ready(name)
    system = problem.system
    parameters = [problem.parameters[n] for n in system.parameter_names]
    start = [problem.start[n] for n in system.state_names]
    solution, _ = end_of(system, start, problem.end / 50, parameters=parameters)
    symbols = [q.symbol for q in (*system.states, *system.parameters)]
    at = {
        s: sp.Float(mpmath.mpf(v), 40) for s, v in zip(symbols, [*start, *parameters], strict=True)
    }
    with mpmath.workdps(40):
        numbers = [sp.Float(number(v), 40) for v in solution.end]
    later = {**at, **dict(zip(symbols, numbers, strict=False))}
    for invariant in system.invariants:
        full = system.expand(invariant.expression)
        first, last = (full.subs(values).evalf(40) for values in (at, later))
        assert abs(last - first) < 1e-20 * max(1, abs(first))
