"""The MATLAB target, in GNU Octave: the numbers that the 50-digit interpreter bounds."""

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings

import eom
from codegen import compile as compile_system
from codegen.compiling.compiled import generate
from codegen.ir.interpret import Point, interpret_with_bound
from codegen.ir.names import RESERVED, identifier
from codegen.ir.ops import OPS
from codegen.targets.matlab import _HELPERS, MATLAB
from eom.quantities import Definition, Quantity
from eom.system import System
from tests import octave
from tests.codegen.test_compiled import (
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
from tests.codegen.test_target_functions import ARGUMENTS, COUNT, functions_of_the_first_state
from tests.codegen.test_targets import hostile_system

needs_octave = pytest.mark.skipif(not octave.OCTAVE, reason="no GNU Octave")


def program_and_text(system):
    compiled = compile_system(system, "numpy")
    (text,) = generate(compiled.program, compiled.layout, "matlab").values()
    return compiled, text


def evaluate(system, group, at):
    """Return the program and the values, (points, k), of one group; alone they are the same."""
    compiled, text = program_and_text(system)
    ((together, alone),) = octave.run([octave.Job(text, group, at, compiled.layout.sizes[group])])
    np.testing.assert_array_equal(together, alone)
    return compiled.program, together


@needs_octave
@settings(max_examples=6)
@given(several(drawn, 8, 16), several(points(extreme), 8, 8))
def test_random_expressions_stay_within_the_error_bound(exprs, values):
    at = [(v[5], v[:3], v[3:5], []) for v in values]
    program, got = evaluate(system_of(exprs), "outputs", at)
    for v, row in zip(values, got, strict=True):
        check_against_bound(program, "outputs", as_point(v), row)


@needs_octave
@pytest.mark.slow
def test_every_system_stays_within_the_error_bound():
    """One process for all of them."""
    compiled, jobs = [], []
    for name in SELECTED:
        system = SYSTEMS[name]()
        numpy, text = program_and_text(system)
        at = [random_values(system, seed) for seed in range(1, 3)]
        for group, size in numpy.layout.sizes.items():
            compiled.append((numpy, group))
            jobs.append(octave.Job(text, group, at, size))
    for (numpy, group), job, (got, alone) in zip(compiled, jobs, octave.run(jobs), strict=True):
        np.testing.assert_array_equal(got, alone)
        checked = 0
        for (t, xs, ps, us), row in zip(job.points, got, strict=True):
            checked += check_against_bound(numpy.program, group, Point(t, xs, ps, us), row)
        assert checked >= job.size, numpy


@needs_octave
@pytest.mark.slow
def test_stumpff_and_tables_stay_within_the_error_bound():
    program, layout = functions_of_the_first_state()
    (text,) = generate(program, layout, "matlab").values()
    at = [(0.0, [v, 0.0], [0.0, 0.0], []) for v in ARGUMENTS]
    ((rows, _),) = octave.run([octave.Job(text, "outputs", at, COUNT)])
    for v, row in zip(ARGUMENTS, rows, strict=True):
        wanted = interpret_with_bound(program, Point(0.0, [v, 0.0], [0.0, 0.0]))["outputs"]
        for k, (e, value) in enumerate(zip(wanted, row, strict=True)):
            assert abs(float(value) - e.value) <= e.error + 1e-300, (v, k, value, e)


def file_of(op):
    """A file whose one function f is the template of an operation over x(1, :), x(2, :), ..."""
    text = MATLAB.templates[op].text.format(*(f"x({k + 1}, :)" for k in range(OPS[op].arity)))
    function = f"function y = f_(t, x, p, u)\n    y = double({text});\nend\n"
    head = f"function system = op_{op}()\n    system.f = @f_;\nend\n"
    return "\n".join([head, function, *MATLAB.helpers.values()])


@needs_octave
def test_values_at_the_edges_are_those_of_the_table_of_operations():
    ops = simple_operations(MATLAB)
    jobs = []
    for op in ops:
        arity = OPS[op].arity
        count = len(SPECIAL) ** min(arity, 2)
        args = [
            [SPECIAL[k % len(SPECIAL)], SPECIAL[k // len(SPECIAL)], -7.5][:arity]
            for k in range(count)
        ]
        jobs.append(octave.Job(file_of(op), "f", [(0.0, a, [], []) for a in args], 1))
    for op, job, (got, _) in zip(ops, jobs, octave.run(jobs), strict=True):
        for (_, args, _, _), (value,) in zip(job.points, got, strict=True):
            with np.errstate(all="ignore"):
                expected = np.ravel(OPS[op].double(*(np.array([a]) for a in args)))[0]
            assert value == pytest.approx(expected, rel=1e-15, abs=0.0, nan_ok=True), (op, args)
            if op not in {"min", "max"}:
                same = math.copysign(1, value) == math.copysign(1, expected)
                assert math.isnan(value) or same, (op, args)


@needs_octave
def test_reserved_and_hostile_names_give_right_numbers():
    rng = np.random.default_rng(2)
    system = named([*sorted(RESERVED), *_HELPERS, "_math"])
    values = rng.normal(size=len(system.states))
    _, got = evaluate(system, "rates", [(0.0, values, [], [])])
    np.testing.assert_allclose(got[0], np.sin(np.roll(values, -1)) + 2 * values, rtol=1e-14)
    hostile = hostile_system()
    n = len(hostile.states)
    xs, ps = rng.normal(size=n), rng.normal(size=n)
    _, got = evaluate(hostile, "rates", [(0.0, xs, ps, [])])
    np.testing.assert_allclose(got[0], np.sin(np.roll(xs, -1)) * ps + np.sign(xs), rtol=1e-14)


# --- the file --------------------------------------------------------------------------------------------


def test_helpers_have_names_that_no_quantity_gets_and_are_written_where_they_are_called():
    assert all("__" in name and "__" not in identifier(name) for name in _HELPERS)
    _, text = program_and_text(system_of([sp.Min(x, sp.sqrt(y))]))
    assert [n for n in _HELPERS if f"= {n}(" in text.replace("function y", "")] == [
        "sqrt__",
        "min__",
    ]
    assert "spread__" not in text


@needs_octave
def test_names_that_are_not_ascii_and_quotes_are_exported_as_they_are():
    theta = sp.Symbol("θ'", real=True)
    energy = Definition(Quantity(sp.Symbol('"E"\\n%d', real=True)), theta**2)
    system = System("naïve", (Quantity(theta),), (-theta,), outputs=(energy,))
    _, text = program_and_text(system)
    assert text.isascii()
    held = "m = naive_system(); f_ = @(t, x, p, u) double(strcmp(m.state_names{1}, char([206 184 39])) "
    wanted = ", ".join(f"{ord(c)}" for c in '"E"\\n%d')
    held += f"&& strcmp(m.output_names{{1}}, char([{wanted}])));"
    outer = f"function system = outer()\n    {held}\n    system.f = f_;\nend\n{text}"
    ((got, _),) = octave.run([octave.Job(outer, "f", [(0.0, [1.0], [], [])], 1)])
    assert got == 1.0


@needs_octave
@pytest.mark.slow
def test_ode45_integrates_the_file_as_it_says():
    scene = eom.load_scene("t-handle")
    compiled, text = program_and_text(scene.derive())
    first, values = (list(v.values()) for v in (scene.initial_values(), scene.parameter_values()))
    run = (
        f"    m = t_handle_system(); o = odeset('RelTol', 1e-9, 'AbsTol', 1e-11);\n    p = {values}.';\n"
        f"    [~, x] = ode45(@(t, x) m.rates(t, x, p, []), [0, 5], {first}, o);\n"
        "    system.f = @(t, x0, p, u) x(end, :).';\n"
    )
    outer = f"function system = outer()\n{run}end\n{text}"
    ((got, _),) = octave.run([octave.Job(outer, "f", [(0.0, first, [], [])], 3)])
    from codegen import simulate

    ours = simulate(compiled, first, (0, 5), values, rtol=1e-12)
    np.testing.assert_allclose(got[0], ours.y[:, -1], rtol=1e-6, atol=1e-7)
