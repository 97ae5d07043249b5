"""Vector lanes: own functions in units in the last place, the bound of the interpreter, any layout."""

import math
import pickle
import shutil
import sys
import threading

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen import compile as compile_system
from codegen.compiling.checked import CheckedFunction
from codegen.compiling.compiled import BLOCK, FEWEST, LEAST_WORK, batch_kernel, divided, generate
from codegen.frontend.layout import Layout
from codegen.ir.interpret import Point, interpret, interpret_with_bound
from codegen.ir.linsolve import Shape
from codegen.ir.names import identifier
from codegen.ir.ops import OPS
from codegen.ir.program import Builder
from codegen.native import native
from codegen.passes.pipeline import specialised
from codegen.targets import lanes
from codegen.targets.lanes import LARGEST_ANGLE, ULPS, single_text
from eom.errors import InputError
from eom.system import System
from tests.codegen.scenes import SCENES
from tests.codegen.test_compiled import (
    ARITHMETIC,
    SYSTEMS,
    as_point,
    check_against_bound,
    expressions,
    extreme,
    points,
    random_values,
    several,
    system_of,
    x,
    y,
    z,
)
from tests.codegen.test_targets import SYSTEMS as OTHERS
from tests.codegen.test_targets import every_operation, hostile_system, strictly_compile
from tests.codegen.test_targets import system_of as all_operations

pytestmark = [
    pytest.mark.shipped_flags,
    pytest.mark.skipif(not native.compiler(), reason="tests C itself"),
]
COMPILERS = [n for n in ("gcc", "clang") if native.compiler() and shutil.which(n)]
WIDTHS = (2, 4, 8)


def load(program, layout, *flags):
    """The functions of a program in lanes, with the contract of shapes."""
    text = single_text(program, layout)
    library = native.load(native.compile_library(text, flags), text, flags)
    name = identifier(layout.name)
    return {
        g: CheckedFunction(g, layout, batch_kernel(library, f"{name}_{g}_lanes"))
        for g in layout.sizes
    }


def function_of(*ops):
    """A program whose outputs are operations on the first states, and its layout."""
    b = Builder()
    states = [b.leaf("state", k) for k in range(3)]
    made = [b.add(op, *states[: OPS[op].arity]) for op in ops]
    results = {"rates": states, "outputs": made, "invariants": (), "singularities": ()}
    return b.program(results), Layout.of(system_of([x] * len(made)))


# --- own functions -----------------------------------------------------------------------------------


def error_in_ulps(op, arguments, got):
    """The largest error of finite results, in units in the last place of the exact value."""
    worst = 0.0
    with mpmath.workdps(50):
        for a, value in zip(arguments, got, strict=True):
            exact = OPS[op].exact(mpmath.mp, mpmath.mpf(float(a)))
            unit = max(math.ldexp(1.0, int(mpmath.floor(mpmath.log(abs(exact), 2))) - 52), 5e-324)
            worst = max(worst, float(abs(mpmath.mpf(float(value)) - exact) / unit))
    return worst


def swept(op, count=1200):
    """Arguments that are hard for a function: everywhere, near its zeros, at its borders."""
    rng = np.random.default_rng(11)
    sign = rng.choice([-1.0, 1.0], count)
    small = sign * 10.0 ** rng.uniform(-12, 0, count)
    if op in {"sin", "cos", "tan"}:
        turns = np.unique(np.round(10.0 ** rng.uniform(0, 4.8, count))) * rng.choice([-1, 1])
        with mpmath.workdps(50):
            near = np.array([float(int(n) * mpmath.pi / 2) for n in turns])
        near = np.concatenate([near, np.nextafter(near, 0), near * (1 + 1e-9)])
        wide = sign * 10.0 ** rng.uniform(0, 5, count)
        found = np.concatenate([small, wide, rng.uniform(-7, 7, count), near])
        return found[np.abs(found) <= LARGEST_ANGLE]
    if op == "log":
        return np.concatenate(
            [
                1 + 0.4 * small,
                10.0 ** rng.uniform(-307, 308, count),
                np.abs(small),
                [5e-324, 1e-310],
            ]
        )
    if op == "tanh":
        return np.concatenate([small, rng.uniform(-25, 25, count), rng.uniform(-1, 1, count)])
    halves = (np.arange(-70, 70) + 0.5) * math.log(2)
    return np.concatenate(
        [small, rng.uniform(-708, 709.7, count), rng.uniform(-2, 2, count), halves]
    )


@pytest.mark.sparse(2)
@pytest.mark.parametrize("op", ULPS)
def test_own_functions_keep_their_accuracy(op):
    outputs = load(*function_of(op))["outputs"]
    arguments = swept(op)
    states = np.zeros((3, len(arguments)))
    states[0] = arguments
    assert len(arguments) > 2000
    assert error_in_ulps(op, arguments, outputs(0.0, states, [0.0, 0.0])[0]) <= ULPS[op]


def test_the_stated_errors_leave_room_in_the_bound_of_the_interpreter():
    assert all(ulps <= OPS[op].ulps for op, ulps in ULPS.items())


SPECIAL = [0.0, -0.0, 1.0, -1.0, 0.5, -2.5, math.inf, -math.inf, math.nan, 1e-310, -5e-324, 1e300,
           4503599627370495.5, -4503599627370497.0, 0.9999999999999999, 745.5, -745.2, 710.0]  # fmt: skip
UNARY = [op for op, row in OPS.items() if row.arity == 1 and op not in {"table", "item"}]
BINARY = ["min", "max", "lt", "le", "eq", "and", "or", "mod", "hypot", "atan2", "pow", "div"]


@pytest.mark.sparse(1)
@pytest.mark.parametrize("width", WIDTHS)
def test_values_at_the_edges_are_those_of_the_table_of_operations(width):
    first, second = (v.ravel() for v in np.meshgrid(SPECIAL, SPECIAL))
    states = np.array([first, second, np.ones_like(first)])
    ops = [*UNARY, *BINARY, "select"]
    got = load(*function_of(*ops), f"-DLANES_={width}")["outputs"](0.0, states, [0.0, 0.0])
    for k, op in enumerate(ops):
        row = OPS[op]
        if op == "select":
            expected = np.where(first != 0, second, 1.0)
        elif op in {"and", "or", "not"}:
            expected = np.array([row.double(*a) for a in states[: row.arity].T])
        else:
            with np.errstate(all="ignore"):
                expected = row.double(*states[: row.arity])
        exact = row.ulps <= 0.5
        np.testing.assert_allclose(
            got[k], expected, rtol=0 if exact else 1e-15, atol=5e-324, err_msg=op
        )
        zero = (expected == 0) & (op not in {"min", "max"})  # either zero is the smaller one
        assert np.array_equal(np.signbit(got[k][zero]), np.signbit(expected[zero])), op


def test_huge_angles_are_those_of_the_library():
    """Lanes beyond the bound go to libm, whatever their neighbours do."""
    outputs = load(*function_of("sin", "cos", "tan"))["outputs"]
    angles = np.array(
        [0.3, 1e5, np.nextafter(1e5, 2e5), -1e22, 1.7e308, 2e5, 1e4, -3e5, math.inf, 2.0]
    )
    states = np.vstack([angles, angles, angles])
    got = outputs(0.0, states, [0.0, 0.0])
    assert np.isnan(got[:, 8]).all()
    for k in np.flatnonzero(np.isfinite(angles)):
        for op, value in zip(("sin", "cos", "tan"), got[:, k], strict=True):
            assert error_in_ulps(op, angles[k : k + 1], [value]) <= ULPS[op]
        alone = outputs(0.0, states[:, k : k + 1].copy(), [0.0, 0.0])
        np.testing.assert_array_equal(alone[:, 0], got[:, k])


# --- programs ----------------------------------------------------------------------------------------


@pytest.mark.slow
@settings(max_examples=8)
@given(several(expressions, 4, 10), several(points(extreme), 5, 11))
def test_random_expressions_stay_within_the_error_bound(exprs, values):
    program, layout = specialised(system_of(exprs), {})
    columns = np.array(values).T
    got = load(program, layout)["outputs"](columns[5], columns[:3], columns[3:5])
    for k, v in enumerate(values):
        check_against_bound(program, "outputs", as_point(v), got[:, k])


@pytest.mark.slow
@settings(max_examples=6)
@given(several(ARITHMETIC, 4, 10), several(points(extreme), 9, 9), st.sampled_from(WIDTHS))
def test_arithmetic_is_the_same_to_the_last_bit_even_where_it_overflows(exprs, values, width):
    program, layout = specialised(system_of(exprs), {})
    columns = np.array(values).T
    outputs = load(program, layout, f"-DLANES_={width}")["outputs"]
    got = outputs(columns[5], columns[:3], columns[3:5])
    for k, v in enumerate(values):
        np.testing.assert_array_equal(got[:, k], interpret(program, as_point(v))["outputs"])


READY = [*SCENES, *(f"{n}, all of it" for n in SCENES)]


def columns_of(system, seeds):
    """Random points side by side: t, x, p, u."""
    drawn = [random_values(system, seed) for seed in seeds]
    return np.array([d[0] for d in drawn]), *(np.array([d[k] for d in drawn]).T for k in (1, 2, 3))


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", [*READY, "satellite dcm"])
def test_every_system_stays_within_the_error_bound_at_every_point(name):
    program, layout = specialised(SYSTEMS[name](), {})
    functions = load(program, layout)
    t, xs, ps, us = columns_of(SYSTEMS[name](), range(3))
    checked = 0
    for group, function in functions.items():
        got = function(t, xs, ps, us)
        for k in range(3):
            point = Point(t[k], xs[:, k], ps[:, k], us[:, k])
            checked += check_against_bound(program, group, point, got[:, k])
    assert checked >= 2 * sum(layout.sizes.values())


def solution(count):
    """A program that solves a symmetric and a general system of ``count`` unknowns, by its states."""
    b = Builder()
    entries = [b.leaf("state", k) for k in range(count * count + count)]
    right = entries[count * count :]
    made = []
    for symmetric in (True, False):
        shape = Shape(count, symmetric)
        factor = b.add("factor", *entries[: shape.entries], value=shape)
        solved = b.add("back", factor, *right)
        made += [b.add("item", solved, value=k) for k in range(count)]
    states = sp.symbols(f"s0:{len(entries)}", real=True)
    system = System.from_rates(
        "solve",
        dict.fromkeys(states, sp.Integer(0)),
        outputs=dict.fromkeys(map("r{}".format, range(2 * count)), x * 0),
    )
    results = {"rates": entries, "outputs": made, "invariants": (), "singularities": ()}
    return b.program(results), Layout.of(system)


@pytest.mark.parametrize("part_lines", [400, 7])
def test_linear_systems_lane_by_lane(part_lines, monkeypatch):
    """Some lanes are positive definite, some need exchanges; parts carry whole factorisations."""
    monkeypatch.setattr(lanes, "PART_LINES", part_lines)
    program, layout = solution(3)
    rng = np.random.default_rng(4)
    states = rng.normal(size=(12, 11))
    states[0, ::2] = 0.0
    got = load(program, layout)["outputs"](0.0, states)
    for k in range(states.shape[1]):
        bounded = interpret_with_bound(program, Point(x=states[:, k]))["outputs"]
        for value, e in zip(got[:, k], bounded, strict=True):
            assert abs(value - e.value) <= e.error


@pytest.mark.slow
def test_a_long_function_is_split_and_stays_the_same(monkeypatch):
    system = OTHERS["satellite"]()
    program, layout = specialised(system, {})
    whole = load(program, layout)["rates"]
    monkeypatch.setattr(lanes, "PART_LINES", 5)
    assert "kernel_3(" in single_text(program, layout)
    t, xs, ps, us = columns_of(system, range(13))
    np.testing.assert_array_equal(
        load(program, layout)["rates"](t, xs, ps, us), whole(t, xs, ps, us)
    )


def test_the_same_input_gives_the_same_bytes():
    system = OTHERS["all operations"]()
    assert single_text(*specialised(system, {})) == single_text(*specialised(system, {}))


# --- layouts of arrays -------------------------------------------------------------------------------


def forced():
    """Time, states, parameters and inputs, each in a stage of its own and together."""
    u, v, m, k = sp.symbols("u v m k", real=True)
    t = sp.Symbol("t", real=True)
    return System.from_rates(
        "forced",
        {
            x: y * sp.cos(m * t) + u / k,
            y: -m * sp.sin(x) * k + v * sp.exp(-t),
            z: sp.log(2 + x * x) - z,
        },
        inputs=(u, v),
        outputs={"energy": y**2 / 2 - m * sp.cos(x), "constant": sp.Integer(7), "drive": u * m},
    )


@pytest.fixture(scope="module")
def compiled():
    return compile_system(forced(), "c")


@pytest.fixture(scope="module")
def by_width(compiled):
    return {w: load(compiled.program, compiled.layout, f"-DLANES_={w}") for w in WIDTHS}


def drawn(n, seed=5):
    rng = np.random.default_rng(seed)
    return rng.normal(size=n), *(rng.normal(size=(k, n)) for k in (3, 2, 2))


@pytest.mark.sparse(1)
@pytest.mark.parametrize("count", [0, 1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 63, 1000])
def test_every_number_of_points_and_lanes_gives_the_same_bits(by_width, compiled, count):
    arguments = drawn(count)
    for group in compiled.functions:
        first, *others = (by_width[w][group](*arguments) for w in WIDTHS)
        for other in others:
            np.testing.assert_array_equal(first, other)
        np.testing.assert_allclose(
            first, compiled.functions[group](*arguments), rtol=1e-13, atol=1e-15
        )


LAYOUTS = {
    "C": lambda a: a,
    "Fortran": np.asfortranarray,
    "reversed": lambda a: a[::-1, ::-1].copy()[::-1, ::-1],
    "every other": lambda a: np.repeat(np.repeat(a, 2, 0), 2, 1)[::2, ::2],
    "inside a larger array": lambda a: np.pad(a, 3)[3:-3, 3:-3],
}


@pytest.mark.parametrize("out", LAYOUTS)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_arrays_may_lie_in_any_way(by_width, layout, out):
    t, *arrays = drawn(29)
    change = LAYOUTS[layout]
    for function in (by_width[8]["rates"], by_width[2]["rates"]):
        expected = function(t, *arrays)
        result = LAYOUTS[out](np.full((3, 29), np.nan))
        time = change(t[None, :])[0]
        assert function(time, *(change(a) for a in arrays), out=result) is result
        np.testing.assert_array_equal(result, expected)


def test_what_all_points_share_has_no_columns(by_width):
    t, xs, ps, us = drawn(29)
    for function in (by_width[w]["rates"] for w in WIDTHS):
        for shared in range(16):
            args = [a[..., 0] if shared >> k & 1 else a for k, a in enumerate((t, xs, ps, us))]
            if shared == 15:
                args[1] = xs
            broad = [np.broadcast_to(a if a.ndim > (k > 0) else a[..., None], b.shape)
                     for k, (a, b) in enumerate(zip(args, (t, xs, ps, us), strict=True))]  # fmt: skip
            whole = function(*(np.ascontiguousarray(b) for b in broad))
            np.testing.assert_array_equal(function(*args), whole)
            np.testing.assert_array_equal(function(*broad), whole)


def test_results_may_replace_the_states(by_width):
    t, xs, ps, us = drawn(29)
    for function in (by_width[w]["rates"] for w in WIDTHS):
        expected = function(t, xs, ps, us)
        for array in (xs.copy(), np.asfortranarray(xs)):
            function.kernel(t, array, ps, us, array)  # below the check that would copy
            np.testing.assert_array_equal(array, expected)
        shifted = np.zeros((3, 30))
        shifted[:, :29] = xs
        function(t, shifted[:, :29], ps, us, out=shifted[:, 1:])
        np.testing.assert_array_equal(shifted[:, 1:], expected)


def test_points_that_are_not_finite_leave_their_neighbours_alone(by_width):
    t, xs, ps, us = drawn(29)
    for function in (by_width[w]["rates"] for w in WIDTHS):
        expected = function(t, xs, ps, us)
        bad = xs.copy()
        bad[0, 3::7], bad[1, 4::7], bad[0, 5::7] = np.nan, np.inf, 1e300
        got = function(t, bad, ps, us)
        same = np.all(bad == xs, axis=0)
        assert same.sum() > 10
        np.testing.assert_array_equal(got[:, same], expected[:, same])
        assert np.isnan(got[1, 3::7]).all()


# --- threads -----------------------------------------------------------------------------------------


@pytest.mark.sparse(1)
@pytest.mark.parametrize("threads", [1, 2, 3, 5, None])
def test_results_do_not_depend_on_the_number_of_threads(compiled, threads):
    n = 5 * LEAST_WORK // 20 + 37  # more than five shares of any of its groups
    t, xs, ps, us = drawn(n)
    for group in compiled.functions:
        expected = compiled.batch(group, 1)(t, xs, ps, us)
        batch = compiled.batch(group, threads)
        assert (batch.form, batch.notice) == ("lanes", "")
        np.testing.assert_array_equal(batch(t, xs, ps, us), expected)
        out = np.empty_like(expected, order="F")
        assert batch(t, xs, ps, us, out=out) is out
        np.testing.assert_array_equal(out, expected)
    shared = compiled.batch("rates", threads)(0.5, xs, ps[:, 0], us[:, 0])
    np.testing.assert_array_equal(shared, compiled.batch("rates", 1)(0.5, xs, ps[:, 0], us[:, 0]))


@given(st.integers(0, 9 * FEWEST), st.integers(1, 6))
def test_shares_cover_every_point_once_and_start_at_blocks(count, threads):
    out, starts = np.zeros((1, count)), []

    def kernel(t, x, p, u, part):
        part += 1
        starts.append((part.ctypes.data - out.ctypes.data) // 8 if part.size else 0)

    empty = np.empty(0)
    divided(kernel, threads)(np.float64(0), empty, empty, empty, out)
    assert (out == 1).all()
    assert all(s % BLOCK == 0 for s in starts)
    assert len(starts) <= threads


def test_shares_are_computed_at_the_same_time():
    """Each waits for the others; the barrier breaks if they came one after the other."""
    together = threading.Barrier(3)

    def kernel(t, x, p, u, part):
        together.wait(timeout=20)
        part += 1

    out, empty = np.zeros((1, 3 * FEWEST)), np.empty(0)
    divided(kernel, 3)(np.float64(0), empty, empty, empty, out)
    assert (out == 1).all()


def test_an_error_in_a_share_comes_out_after_all_shares_ended():
    def kernel(t, x, p, u, part):
        if part[0, 0] == 1:
            raise InputError("a share failed")
        part += 1

    out = np.zeros((1, 4 * FEWEST))
    out[0, 2 * FEWEST] = 1
    empty = np.empty(0)
    with pytest.raises(InputError, match="a share failed"):
        divided(kernel, 4)(np.float64(0), empty, empty, empty, out)
    assert out[0, [0, FEWEST, 3 * FEWEST]].tolist() == [1, 1, 1]


def test_one_point_and_the_contract_of_shapes(compiled):
    t, xs, ps, us = drawn(1)
    batch = compiled.batch()
    one = batch(t[0], xs[:, 0], ps[:, 0], us[:, 0])
    assert one.shape == (3,)
    np.testing.assert_array_equal(one, batch(t, xs, ps, us)[:, 0])
    with pytest.raises(InputError, match="x has the wrong shape"):
        batch(0.0, xs[:2], ps, us)
    with pytest.raises(InputError, match="unknown group of results"):
        compiled.batch("rate")
    for threads in (0, -1, 1.5, True):
        with pytest.raises(
            InputError, match=r"wrong number of threads|threads is of the wrong type"
        ):
            compiled.batch(threads=threads)


def test_a_batch_can_be_pickled(compiled):
    batch = compiled.batch("outputs", 2)
    arguments = drawn(20)
    copy = pickle.loads(pickle.dumps(batch))
    np.testing.assert_array_equal(copy(*arguments), batch(*arguments))
    assert repr(copy) == repr(batch) == "Batch('forced', outputs: lanes, 2 threads)"


@pytest.mark.skipif(sys.platform == "win32", reason="a script as the compiler")
def test_without_vector_extensions_the_plain_form_is_taken(monkeypatch, tmp_path):
    """A compiler that refuses vectors; the plain text compiles."""
    real = " ".join(native.require_compiler())
    script = tmp_path / "cc"
    script.write_text(
        "#!/bin/sh\nfor file; do\n"
        'case "$file" in *.c) grep -q vector_size "$file" && exit 1;; esac\n'
        f'done\nexec {real} "$@"\n'
    )
    script.chmod(0o755)
    monkeypatch.setenv("CC", str(script))
    made = compile_system(forced(), "c")
    batch = made.batch(threads=2)
    assert batch.form == "c"
    assert "the C compiler failed" in batch.notice
    arguments = drawn(3 * FEWEST)
    np.testing.assert_array_equal(batch(*arguments), made.rhs(*arguments))


@pytest.mark.parametrize("target", ["numpy", "python"])
def test_other_targets_take_their_own_form(target):
    made = compile_system(forced(), target)
    batch = made.batch(threads=2)
    assert (batch.form, batch.notice) == (
        target,
        f"target {target} has no lanes: taking its own form",
    )
    arguments = drawn(2 * FEWEST + 5)
    np.testing.assert_array_equal(batch(*arguments), made.rhs(*arguments))


# --- compilers ---------------------------------------------------------------------------------------


STRICT = [
    *(
        (name, flags)
        for name in ("all operations", "hostile")
        for flags in ((), ("-march=native",))
    ),
    ("satellite", ("-DLANES_=8", "-Wno-psabi")),
    ("satellite", ("-DLANES_=2", "-O0")),
]


@pytest.mark.sparse(only=("all operations-flags0-gcc", "satellite-flags4-gcc"))
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize(("name", "flags"), STRICT)
def test_generated_c_passes_strict_compilers_without_a_warning(name, compiler, flags, tmp_path):
    system = hostile_system() if name == "hostile" else OTHERS[name]()
    if name == "all operations":
        system = all_operations(every_operation())
    files = generate(*specialised(system, {}), "c_lanes")
    strictly_compile(files, tmp_path, compiler, *flags)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_linear_systems_pass_strict_compilers(compiler, tmp_path):
    program, layout = solution(3)
    strictly_compile(lanes.files(program, layout), tmp_path, compiler)


def test_it_can_be_linked_with_the_plain_form(tmp_path):
    program, layout = specialised(OTHERS["singular"](), {})
    files = {**generate(program, layout, "c"), **generate(program, layout, "c_lanes")}
    files = {n: t for n, t in files.items() if n.endswith(".h")}
    files["both.c"] = "".join(f'#include "{h}"\n' for h in files) + "int both;\n"
    strictly_compile(files, tmp_path, native.require_compiler()[0])
    assert {"free_rigid_body.h", "free_rigid_body_lanes.h"} <= set(files)
