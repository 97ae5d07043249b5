"""The Python target: the same numbers as the 50-digit interpreter says, and IEEE 754 where math raises."""

import ast
import math
import subprocess
import sys

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.compiling.compiled import generate
from codegen.ir.interpret import Point, interpret
from codegen.ir.names import RESERVED, identifier
from codegen.ir.ops import OPS, SOLVE
from codegen.targets import load_module
from codegen.targets.python_ import _HELPERS, PYTHON
from eom.quantities import Definition, Quantity
from eom.system import System
from tests.codegen.test_compiled import (
    ARITHMETIC,
    SYSTEMS,
    as_array,
    as_point,
    check_against_bound,
    expressions,
    extreme,
    points,
    q,
    random_values,
    several,
    system_of,
    x,
    y,
)
from tests.codegen.test_targets import every_operation, hostile_system

drawn = expressions.map(lambda e: x if e.has(sp.besselj, sp.bessely) else e)
"""SymPy makes steps of some conditions by itself; they have no operation."""


SELECTED = [n for n in SYSTEMS if not n.startswith("free ") or n in {"free dcm", "free 3-1-2"}]
"""Every ready scene and every kind of system; of the rotation sequences, one."""


@settings(max_examples=12)
@given(several(drawn, 4, 8), several(points(extreme), 5, 5))
def test_random_expressions_stay_within_the_error_bound(exprs, values):
    compiled = compile_system(system_of(exprs), "python")
    columns = np.array(values).T
    got = compiled.outputs(columns[5], columns[:3], columns[3:5])
    for k, v in enumerate(values):
        check_against_bound(compiled.program, "outputs", as_point(v), got[:, k])
        one = compiled.outputs(v[5], v[:3], v[3:5])
        np.testing.assert_array_equal(got[:, k], one)


@settings(max_examples=12)
@given(several(ARITHMETIC, 4, 8), several(points(extreme), 6, 6))
def test_arithmetic_is_the_same_to_the_last_bit_even_where_it_overflows(exprs, values):
    compiled = compile_system(system_of(exprs), "python")
    for v in values:
        expected = interpret(compiled.program, as_point(v))["outputs"]
        np.testing.assert_array_equal(compiled.outputs(v[5], v[:3], v[3:5]), expected)


@pytest.mark.sparse(5)
@pytest.mark.parametrize("name", SELECTED)
def test_every_system_stays_within_the_error_bound(name):
    system = SYSTEMS[name]()
    compiled = compile_system(system, "python")
    checked = 0
    for seed in range(2):
        t, xs, ps, us = random_values(system, seed)
        for group, function in compiled.functions.items():
            got = function(t, xs, as_array(ps), as_array(us))
            checked += check_against_bound(compiled.program, group, Point(t, xs, ps, us), got)
    assert checked >= sum(compiled.layout.sizes.values())


# --- IEEE 754 where math raises ------------------------------------------------------------------------

SPECIAL = (0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 2.0, -3.0, 1e308, -1e308, 5e-324, 750.0, -750.0,
           math.inf, -math.inf, math.nan)  # fmt: skip


SPECIFIC = {"besselj", "bessely", "stumpff", "table"}
"""Operations with an order or with data; they have tests of their own."""


def simple_operations(row):
    """The operations of a target whose operands may be any numbers."""
    return [op for op in OPS if op in row.templates and op not in {*SPECIFIC, *SOLVE}]


def computable(expressions):
    """Expressions without the functions that some targets refuse."""
    return [e for e in expressions if not e.has(sp.besselj, sp.bessely)]


@pytest.mark.parametrize("op", simple_operations(PYTHON))
def test_values_at_the_edges_are_those_of_the_table_of_operations(op):
    """Each operation is called as the template writes it, at zeros, borders, infinities and NaN."""
    row = OPS[op]
    names = ["a", "b", "c"][: row.arity]
    text = PYTHON.templates[op].text.format(*names)
    helpers = "\n".join(_HELPERS.values())
    module = load_module(f"import math\n{helpers}\ndef f({', '.join(names)}): return {text}\n", op)
    for k in range(len(SPECIAL) ** min(row.arity, 2)):
        args = [SPECIAL[k % len(SPECIAL)], SPECIAL[k // len(SPECIAL)], -7.5][: row.arity]
        with np.errstate(all="ignore"):
            # arrays: NumPy takes a scalar power of 0.5 for a square root
            expected = np.ravel(row.double(*(np.array([a]) for a in args)))[0]
        got = module.f(*args)
        assert isinstance(got, float)
        assert got == pytest.approx(expected, rel=1e-15, abs=0.0, nan_ok=True), args
        if op not in {"min", "max"}:
            assert math.isnan(got) or math.copysign(1, got) == math.copysign(1, expected), args


def test_no_value_makes_a_function_raise():
    compiled = compile_system(system_of(every_operation_of_states()), "python")
    grid = np.array([(a, b) for a in SPECIAL for b in SPECIAL]).T
    states = np.vstack([grid, grid[:1]])
    assert compiled.outputs(0.0, states, [math.inf, 0.0]).shape[1] == len(SPECIAL) ** 2


def every_operation_of_states():
    return [e.xreplace({q: x}) for e in computable(every_operation())]


def test_whole_numbers_and_numbers_of_numpy_are_taken_as_floats():
    compiled = compile_system(system_of([x * y, x / y, sp.exp(x)]), "python")
    module = load_module(compiled.source, "whole")
    expected = module.outputs(0.0, [3.0, 2.0, 0.0], [0.0, 0.0])
    assert module.outputs(0, [3, 2, 0], [0, 0]) == expected
    got = module.outputs(0, np.array([3, 2, 0]), np.zeros(2))
    assert got == expected
    assert all(type(v) is float for v in got)
    assert math.isinf(module.outputs(0, [10**200, 10**-200, 0], [0, 0])[1])
    big = module.outputs(0, [np.float64(1e300), np.float64(1e300), 0.0], [0.0, 0.0])
    assert big == [math.inf, 1.0, math.inf]  # and no warning of NumPy


# --- the module ----------------------------------------------------------------------------------------


def test_the_module_works_where_nothing_is_installed(tmp_path):
    """-I -S: neither the current folder nor site-packages can be imported."""
    compiled = compile_system(eom.free_rigid_body("3-1-2"), "python")
    (path,) = compiled.write(tmp_path)
    script = (
        "import sys; sys.path.insert(0, sys.argv[1]); import free_rigid_body as m;"
        "print(m.rates(0, [1, 2, 3, .1, .2, .3], [1, 1.2, 1.5]), m.STATES, m.INPUTS)"
    )
    run = subprocess.run(
        [sys.executable, "-I", "-S", "-c", script, str(tmp_path)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    expected = compiled.rhs(0.0, [1, 2, 3, 0.1, 0.2, 0.3], [1, 1.2, 1.5]).tolist()
    assert run.stdout.strip() == f"{expected} {compiled.system.state_names} ()"
    tree = ast.parse(path.read_text())
    imported = [n for n in ast.walk(tree) if isinstance(n, ast.Import | ast.ImportFrom)]
    assert [ast.unparse(n) for n in imported] == ["import math"]


def test_helpers_are_written_only_where_they_are_used():
    def helpers(expression):
        source = compile_system(system_of([expression]), "python").source
        tree = ast.parse(source)
        return [n.name for n in tree.body if isinstance(n, ast.FunctionDef) and n.name[0] == "_"]

    assert helpers(x * y - 3) == []
    assert helpers(sp.sin(x) / y) == ["_div", "_sin"]
    assert helpers(sp.Min(x, sp.log(y))) == ["_log", "_min"]


def named(names):
    """A system whose states have these names; each is driven by the next."""
    states = [sp.Symbol(n, real=True) for n in names]
    rates = [sp.sin(b) + 2 * a for a, b in zip(states, [*states[1:], states[0]], strict=True)]
    return System("named", tuple(map(Quantity, states)), tuple(rates), time=sp.Symbol("_time"))


@pytest.mark.sparse(1)
@pytest.mark.parametrize("target", ["python", "numpy"])
def test_reserved_and_hostile_names_give_right_numbers(target):
    rng = np.random.default_rng(2)
    system = named([*sorted(RESERVED), *_HELPERS, "_math"])
    values = rng.normal(size=len(system.states))
    expected = np.sin(np.roll(values, -1)) + 2 * values
    got = compile_system(system, target).rhs(0.0, values)
    np.testing.assert_allclose(got, expected, rtol=1e-14)
    hostile = hostile_system()
    n = len(hostile.states)
    xs, ps = rng.normal(size=n), rng.normal(size=n)
    expected = np.sin(np.roll(xs, -1)) * ps + np.sign(xs)
    got = compile_system(hostile, target).rhs(0.0, xs, ps)
    np.testing.assert_allclose(got, expected, rtol=1e-14)


@settings(max_examples=30)
@given(st.text(max_size=20))
def test_no_name_is_spelt_as_a_helper(name):
    assert not identifier(name).startswith("_")
    assert all(helper.startswith("_") for helper in _HELPERS)


@pytest.mark.parametrize("target", ["python", "numpy"])
def test_names_that_are_not_ascii_are_exported_as_they_are(target):
    theta = sp.Symbol("θ'", real=True)
    energy = Definition(Quantity(sp.Symbol('"E"\\', real=True)), theta**2)
    system = System("naïve", (Quantity(theta),), (-theta,), outputs=(energy,))
    compiled = compile_system(system, target)
    module = load_module(compiled.source, "names")
    assert module.STATES == ("θ'",)
    assert module.OUTPUTS == ('"E"\\',)
    assert compiled.source.isascii()


def test_a_trajectory_over_python_functions_is_that_over_numpy():
    results = [
        simulate(
            compile_system(eom.free_rigid_body(), target), (0.1, 2, 0.2), (0, 3), (1, 1.2, 1.5)
        )
        for target in ("python", "numpy")
    ]
    np.testing.assert_allclose(results[0].y[:, -1], results[1].y[:, -1], rtol=1e-9)


def test_the_bound_of_the_check_is_felt():
    """A check against the bound fails for numbers that are off by a part in 10^13."""
    compiled = compile_system(system_of([sp.sin(x) * sp.exp(y)]), "python")
    point = [0.7, 1.9, -0.4, 1.3, 0.2, 5.0]
    got = compiled.outputs(point[5], point[:3], point[3:5])
    exact = mpmath.sin(0.7) * mpmath.exp(1.9)
    assert got[0] == pytest.approx(float(exact), rel=1e-15)
    with pytest.raises(AssertionError):
        check_against_bound(compiled.program, "outputs", as_point(point), got * (1 + 1e-13))


def test_the_same_system_gives_the_same_bytes():
    compiled = compile_system(eom.heavy_top(), "numpy")
    first = generate(compiled.program, compiled.layout, "python")
    again = compile_system(eom.heavy_top(), "numpy")
    assert generate(again.program, again.layout, "python") == first
