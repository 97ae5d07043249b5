"""Cutting by binding time: the stages together compute what the whole does, bit for bit."""

import shutil
import subprocess

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings

import eom
from codegen import compile as compile_system
from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir.interpret import Point, interpret, interpret_exactly, random_point
from codegen.ir.ops import LEAVES
from codegen.ir.program import RATES
from codegen.native import native
from codegen.passes.pipeline import CLOCK, CONSTANT, by_parameters, by_time, reciprocals
from eom.opening import load_scene
from eom.system import System
from tests.codegen.scenes import SCENES
from tests.codegen.test_compiled import TIME, expressions, modest, p, points, q, x, y, z

PROGRAMS = {n: lambda n=n: lower_system(load_scene(n).derive()) for n in SCENES}


def staged(program, point):
    """Evaluate by three stages."""
    first = by_parameters(program)
    constants = interpret(first.early, Point(p=point.p))[CONSTANT]
    second = by_time(first.late)
    clock = interpret(second.early, Point(t=point.t, constants=constants))[CLOCK]
    late = Point(t=point.t, x=point.x, u=point.u, constants=constants, clock=clock)
    return interpret(second.late, late)


def same(left, right):
    return all(np.array_equal(left[g], right[g], equal_nan=True) for g in (*left, *right))


@pytest.mark.parametrize("name", PROGRAMS)
def test_stages_compute_what_the_whole_does(name):
    program = PROGRAMS[name]()
    point = random_point(program, 3)
    assert same(staged(program, point), interpret(program, point))


@settings(max_examples=60)
@given(expressions, points(modest))
def test_stages_of_random_expressions(e, v):
    program = lower_expressions({"f": [e]}, (x, y, z), (p, q, TIME))
    point = Point(x=v[:3], p=v[3:])
    assert same(staged(program, point), interpret(program, point))


@pytest.mark.sparse(2)
@pytest.mark.parametrize("name", PROGRAMS)
def test_early_stages_know_no_state_and_late_ones_no_parameter(name):
    cut = by_parameters(PROGRAMS[name]())
    assert {i.op for i in cut.early.instructions} & set(LEAVES) <= {"parameter", "const", "pi"}
    assert "parameter" not in {i.op for i in cut.late.instructions}


def test_what_is_hoisted_is_gone_from_each_call():
    a, b = sp.symbols("a b", positive=True)
    system = System.from_rates(
        "driven", {x: sp.sin(a * b) * x + sp.cos(a * TIME) * sp.exp(b)}, time=TIME
    )
    cut = by_parameters(lower_system(system), [RATES])
    assert cut.early.counts() == {"mul": 1, "sin": 1, "exp": 1}
    timed = by_time(cut.late)
    assert timed.early.counts() == {"mul": 2, "cos": 1}
    assert timed.late.counts() == {"add": 1, "mul": 1}


def test_reciprocals_leave_no_division_by_parameters():
    a, b = sp.symbols("a b", positive=True)
    program = lower_expressions({"f": [x / a, y / (a + b), a / b, x / y]}, (x, y), (a, b))
    changed = reciprocals(program)
    late = by_parameters(changed).late
    assert late.counts() == {"mul": 2, "div": 1}
    point = Point(x=(0.3, 0.7), p=(1.1, 2.3))
    before, after = (interpret_exactly(q, point)["f"] for q in (program, changed))
    assert all(abs(m - n) < 1e-48 for m, n in zip(before, after, strict=True))


@pytest.mark.parametrize("columns", ["all alike", "each its own"])
def test_batches_prepare_anew_where_parameters_or_times_differ(columns, target):
    a, b = sp.symbols("a b", positive=True)
    rates = {x: sp.sin(a * b) * x + sp.cos(a * TIME) * sp.exp(b)}
    f = compile_system(System.from_rates("driven", rates, time=TIME), target).rhs
    many = 5
    states = np.linspace(0.1, 0.9, many)[None, :]
    times, parameters = 0.7, np.array([1.2, 0.4])
    if columns == "each its own":
        times = np.linspace(0, 1, many)
        parameters = np.outer(parameters, 1 + np.arange(many) / 10)
    found = f(times, states, parameters)
    t, p_ = np.broadcast_to(times, many), np.broadcast_to(parameters.reshape(2, -1), (2, many))
    single = [f(float(t[k]), states[:, k].copy(), p_[:, k].copy())[0] for k in range(many)]
    np.testing.assert_array_equal(found[0], single)


def test_quick_calls_follow_parameters_that_change_in_place(target):
    f = compile_system(eom.free_rigid_body(), target).rhs
    state, moments = np.array([1.0, 2.0, 3.0]), np.array([1.0, 1.5, 2.0])
    first = f(0.0, state, moments).copy()
    moments[:] = [2.0, 1.5, 1.0]
    second = f(0.0, state, moments)
    np.testing.assert_array_equal(second, f(0.0, state, np.array([2.0, 1.5, 1.0])))
    assert not np.array_equal(first, second)
    np.testing.assert_array_equal(first, f(0.0, state, [1.0, 1.5, 2.0]))


@pytest.mark.skipif(not (shutil.which("gcc") and native.compiler()), reason="no gcc")
def test_parameters_where_constants_belong_do_not_compile(tmp_path):
    compiled = compile_system(eom.free_rigid_body(), "c")
    compiled.write(tmp_path)
    call = "void g(const double *p, double *y) { free_rigid_body_rates(0, y, p, NULL, y); }"
    wrong = f'#include "free_rigid_body.h"\n{call}\n'
    (tmp_path / "wrong.c").write_text(wrong)
    done = subprocess.run(
        ["gcc", "-Werror", "-c", "wrong.c"], cwd=tmp_path, capture_output=True, check=False
    )
    assert done.returncode != 0
    assert b"incompatible" in done.stderr
