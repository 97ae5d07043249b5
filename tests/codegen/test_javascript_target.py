"""The JavaScript target, in Node.js: the numbers that the 50-digit interpreter bounds."""

import json
import math
import re

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings

import eom
from codegen import compile as compile_system
from codegen.compiling.compiled import generate
from codegen.ir.interpret import Point, interpret
from codegen.ir.names import RESERVED, comment
from codegen.ir.ops import OPS
from codegen.targets import javascript, python_
from codegen.targets.javascript import JAVASCRIPT
from eom.errors import InputError
from tests import node
from tests.codegen.test_compiled import (
    ARITHMETIC,
    SYSTEMS,
    as_point,
    check_against_bound,
    extreme,
    points,
    random_values,
    several,
    system_of,
    x,
    y,
)
from tests.codegen.test_python_target import SELECTED, SPECIAL, drawn, named, simple_operations
from tests.codegen.test_targets import hostile_system

needs_node = pytest.mark.skipif(not node.NODE, reason="no Node.js")


def program_and_module(system):
    compiled = compile_system(system, "numpy")
    (text,) = generate(compiled.program, compiled.layout, "javascript").values()
    return compiled, text


def evaluate(system, group, at):
    """Return the program and the values, (points, k), of one group."""
    compiled, text = program_and_module(system)
    (got,) = node.run([node.Job(text, group, at, compiled.layout.sizes[group])])
    return compiled.program, got


@needs_node
@settings(max_examples=12)
@given(several(drawn, 8, 16), several(points(extreme), 8, 8))
def test_random_expressions_stay_within_the_error_bound(exprs, values):
    at = [(v[5], v[:3], v[3:5], []) for v in values]
    program, got = evaluate(system_of(exprs), "outputs", at)
    for v, row in zip(values, got, strict=True):
        check_against_bound(program, "outputs", as_point(v), row)


@pytest.mark.slow
@needs_node
@settings(max_examples=12)
@given(several(ARITHMETIC, 8, 16), several(points(extreme), 8, 8))
def test_arithmetic_is_the_same_to_the_last_bit_even_where_it_overflows(exprs, values):
    at = [(v[5], v[:3], v[3:5], []) for v in values]
    program, got = evaluate(system_of(exprs), "outputs", at)
    for v, row in zip(values, got, strict=True):
        np.testing.assert_array_equal(row, interpret(program, as_point(v))["outputs"])


@pytest.mark.slow
@needs_node
def test_every_system_stays_within_the_error_bound():
    """One process for all of them."""
    compiled, jobs = [], []
    for name in SELECTED:
        system = SYSTEMS[name]()
        numpy, text = program_and_module(system)
        at = [random_values(system, seed) for seed in range(1, 3)]
        for group, size in numpy.layout.sizes.items():
            compiled.append((numpy, group))
            jobs.append(node.Job(text, group, at, size))
    for (numpy, group), job, got in zip(compiled, jobs, node.run(jobs), strict=True):
        checked = 0
        for (t, xs, ps, us), row in zip(job.points, got, strict=True):
            checked += check_against_bound(numpy.program, group, Point(t, xs, ps, us), row)
        assert checked >= job.size, numpy


# --- helper functions ----------------------------------------------------------------------------------


def module_of(op):
    """A module whose one function f is the template of an operation over x[0], x[1], ..."""
    text = JAVASCRIPT.templates[op].text.format(*(f"x[{k}]" for k in range(operands(op))))
    helpers = "\n".join(JAVASCRIPT.helpers.values())
    return f"{helpers}\nexport function f(t, x, p, u) {{ return [{text}]; }}\n"


def operands(op):
    return len(set(re.findall(r"\{(\d)\}", JAVASCRIPT.templates[op].text)))


@needs_node
def test_values_at_the_edges_are_those_of_the_table_of_operations():
    ops = simple_operations(JAVASCRIPT)
    jobs = []
    for op in ops:
        arity = OPS[op].arity
        count = len(SPECIAL) ** min(arity, 2)
        args = [
            [SPECIAL[k % len(SPECIAL)], SPECIAL[k // len(SPECIAL)], -7.5][:arity]
            for k in range(count)
        ]
        jobs.append(node.Job(module_of(op), "f", [(0.0, a, [], []) for a in args], 1))
    for op, job, got in zip(ops, jobs, node.run(jobs), strict=True):
        for (_, args, _, _), (value,) in zip(job.points, got, strict=True):
            with np.errstate(all="ignore"):
                expected = np.ravel(OPS[op].double(*(np.array([a]) for a in args)))[0]
            assert value == pytest.approx(expected, rel=1e-15, abs=0.0, nan_ok=True), (op, args)
            if op not in {"min", "max"}:
                same = math.copysign(1, value) == math.copysign(1, expected)
                assert math.isnan(value) or same, (op, args)


@needs_node
@pytest.mark.parametrize("op", ["erf", "erfc"])
def test_error_functions_are_right_to_a_few_units_in_the_last_place(op):
    """ERROR_ULPS is what the documentation of the target says."""
    values = [
        *np.linspace(-6.5, 6.5, 2003),
        *np.geomspace(1e-300, 1, 101),
        *np.linspace(5, 26, 401),
    ]
    values += [math.nextafter(0.5, 0), 0.5, -0.5, 1e-310, -0.0]
    (got,) = node.run([node.Job(module_of(op), "f", [(0.0, [v], [], []) for v in values], 1)])
    worst = 0.0
    with mpmath.workdps(40):
        for v, (value,) in zip(values, got, strict=True):
            exact = getattr(mpmath, op)(mpmath.mpf(float(v)))
            error = float(abs(mpmath.mpf(float(value)) - exact)) / math.ulp(float(exact))
            worst = max(worst, error)
    assert worst <= javascript.ERROR_ULPS
    assert worst >= 0.5  # it is measured
    ends = [math.inf, -math.inf, math.nan, 30.0, -30.0]
    (got,) = node.run([node.Job(module_of(op), "f", [(0.0, [v], [], []) for v in ends], 1)])
    np.testing.assert_array_equal(got[:, 0], [float(getattr(mpmath, op)(v)) for v in ends])


def test_coefficients_of_the_error_function_are_the_chebyshev_coefficients():
    """Sums over Chebyshev nodes, with 40 digits (Trefethen, Approximation Theory, ch. 3)."""
    count, middle = 64, mpmath.mpf(javascript.ERFC_MIDDLE)
    with mpmath.workdps(40):
        angles = [mpmath.pi * (k + mpmath.mpf(1) / 2) / count for k in range(count)]
        at = [middle * (1 + mpmath.cos(a)) / (1 - mpmath.cos(a)) for a in angles]
        values = [(1 + 2 * v) * mpmath.exp(v * v) * mpmath.erfc(v) for v in at]
        for j, c in enumerate(javascript.ERFC_SERIES):
            terms = (v * mpmath.cos(j * a) for v, a in zip(values, angles, strict=True))
            exact = mpmath.fsum(terms) * (2 if j else 1) / count
            assert float(exact) == pytest.approx(c, rel=1e-15, abs=1e-30)


# --- the module ----------------------------------------------------------------------------------------


@needs_node
def test_results_may_be_written_over_the_states(tmp_path):
    compiled, text = program_and_module(eom.free_rigid_body("3-1-2"))
    over = (
        text
        + "\nexport function over(t, x, p, u) { const s = x.slice(); return rates(t, s, p, u, s); }\n"
    )
    at = [(0.0, [1.0, 2.0, 3.0, 0.1, 0.2, 0.3], [1.0, 1.2, 1.5], [])]
    first, second = node.run([node.Job(over, "rates", at, 6), node.Job(over, "over", at, 6)])
    np.testing.assert_array_equal(first, second)
    np.testing.assert_allclose(first[0], compiled.rhs(*at[0][:3]), rtol=1e-14)


@needs_node
def test_reserved_and_hostile_names_give_right_numbers():
    rng = np.random.default_rng(2)
    system = named([*sorted(RESERVED), *JAVASCRIPT.helpers, "_math"])
    values = rng.normal(size=len(system.states))
    _, got = evaluate(system, "rates", [(0.0, values, [], [])])
    np.testing.assert_allclose(got[0], np.sin(np.roll(values, -1)) + 2 * values, rtol=1e-14)
    hostile = hostile_system()
    n = len(hostile.states)
    xs, ps = rng.normal(size=n), rng.normal(size=n)
    _, got = evaluate(hostile, "rates", [(0.0, xs, ps, [])])
    np.testing.assert_allclose(got[0], np.sin(np.roll(xs, -1)) * ps + np.sign(xs), rtol=1e-14)


def test_the_module_exports_names_and_sizes_and_imports_nothing():
    compiled, text = program_and_module(hostile_system())
    assert text.isascii()
    assert "</" not in text
    assert "import" not in re.sub(r"\w*import\w+|\w+import\w*|\"[^\"]*\"|//.*", "", text)
    exported = dict(re.findall(r"^export const (\w+) = (.*);$", text, re.MULTILINE))
    assert json.loads(exported["STATES"]) == list(compiled.system.state_names)
    assert json.loads(exported["PARAMETERS"]) == list(compiled.system.parameter_names)
    assert json.loads(exported["OUTPUTS"]) == list(compiled.system.output_names)
    assert json.loads(exported["SIZES"]) == compiled.layout.sizes
    assert json.loads(exported["TITLE"]) == compiled.layout.title
    assert comment(compiled.layout.title) in text


def test_a_system_is_not_compiled_for_javascript():
    with pytest.raises(InputError, match="written, and not run from Python"):
        compile_system(eom.free_rigid_body(), "javascript")


def test_helpers_of_both_modules_have_names_that_no_quantity_gets():
    for helpers in (JAVASCRIPT.helpers, python_.PYTHON.helpers):
        assert all(name.startswith("_") for name in helpers)


def test_helpers_are_written_with_those_that_they_call():
    _, text = program_and_module(system_of([sp.sign(x) + sp.Min(x, y)]))
    assert re.findall(r"^function (\w+)", text, re.MULTILINE) == ["_sign", "_min"]
