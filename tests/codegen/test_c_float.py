"""Single precision: the bound of the 50-digit interpreter times 2^29, and strict compilers."""

import ctypes
import re
import shutil

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen import compile as compile_system
from codegen.compiling.compiled import generate
from codegen.ir.interpret import Point, interpret
from codegen.ir.names import C_MATH, RESERVED
from codegen.ir.program import Program
from codegen.native import native
from codegen.passes.pipeline import by_parameters, specialised
from codegen.targets import c
from codegen.targets.c import float_prefix, float_single_text, in_single_precision
from eom.system import System
from tests.codegen.test_compiled import (
    SINGLE,
    SYSTEMS,
    judged,
    points,
    random_values,
    several,
    system_of,
    x,
    y,
    z,
)
from tests.codegen.test_python_target import SELECTED, computable, drawn
from tests.codegen.test_targets import SYSTEMS as OTHERS
from tests.codegen.test_targets import every_operation, hostile_system, strictly_compile
from tests.codegen.test_targets import system_of as all_operations

pytestmark = pytest.mark.shipped_flags

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="tests C itself")
COMPILERS = [n for n in ("gcc", "clang") if native.compiler() and shutil.which(n)]


class Single:
    """A program compiled in single precision, called through ctypes."""

    def __init__(self, program, layout):
        self.program, self.layout = program, layout
        text = float_single_text(self.program, self.layout)
        self.library = native.load(native.compile_library(text), text)
        self.name = float_prefix(self.layout)

    def __call__(self, group, t, *arrays):
        values = [np.asarray(a, dtype=np.float32) for a in arrays]
        out = np.full(self.layout.sizes[group], np.nan, dtype=np.float32)
        function = getattr(self.library, f"{self.name}_{group}")
        function.argtypes = [ctypes.c_float, *[ctypes.c_void_p] * 4]
        function.restype = None
        constants = np.zeros(
            max(1, len(by_parameters(self.program, self.layout.sizes).values)), "f4"
        )
        prepare = getattr(self.library, f"{self.name}_prepare")
        prepare.argtypes = [ctypes.c_void_p] * 2
        prepare(values[1].ctypes.data, constants.ctypes.data)
        arrays = (values[0], constants, values[2], out)
        function(t, *(a.ctypes.data for a in arrays))
        return out


def single(values):
    return [float(v) for v in np.float32(values)]


def check(program, group, point, got):
    """Compare where the bound of first order holds in single precision; return how many there were."""
    every = Program(program.instructions, {"all": tuple(range(len(program.instructions)))})
    good, bounded = judged(program, point, SINGLE)
    finite = np.isfinite(interpret(every, point)["all"])
    checked = 0
    for k, value in zip(program.results[group], got, strict=True):
        if good[k] and finite[k]:
            error = abs(mpmath.mpf(float(value)) - bounded[k].value)
            assert error <= bounded[k].error, (k, value, bounded[k])
            checked += 1
    return checked


@pytest.mark.slow
@needs_compiler
@settings(max_examples=12)
@given(several(drawn, 8, 14), several(points(st.floats(-4, 4, width=32)), 6, 6))
def test_random_expressions_stay_within_the_scaled_bound(exprs, values):
    compiled = Single(*specialised(system_of(exprs), {}))
    for v in map(single, values):
        got = compiled("outputs", v[5], v[:3], v[3:5], [])
        check(compiled.program, "outputs", Point(v[5], v[:3], v[3:5]), got)


@pytest.mark.sparse(4)
@needs_compiler
@pytest.mark.parametrize("name", SELECTED)
def test_every_system_stays_within_the_scaled_bound(name):
    compiled = Single(*specialised(SYSTEMS[name](), {}))
    checked = 0
    for seed in range(2):
        t, *arrays = random_values(SYSTEMS[name](), seed)
        (t,), arrays = single([t]), [single(a) for a in arrays]
        for group in compiled.layout.sizes:
            got = compiled(group, t, *arrays)
            assert got.dtype == np.float32
            checked += check(compiled.program, group, Point(t, *arrays), got)
    assert checked >= 0.5 * sum(compiled.layout.sizes.values())


@needs_compiler
def test_the_scaled_bound_is_felt():
    """Twice the roundoff of float is too much for one rounding, and double is far better."""
    compiled = Single(*specialised(system_of([x * y, sp.sin(x) + z]), {}))
    point = Point(0.0, single([0.7, 1.9, -0.4]), [0.0, 0.0])
    got = compiled("outputs", 0.0, point.x, point.p, [])
    assert check(compiled.program, "outputs", point, got) == 2
    with pytest.raises(AssertionError):
        check(compiled.program, "outputs", point, got * np.float32(1 + 2**-19))
    double = compile_system(system_of([x * y, sp.sin(x) + z]), "c").outputs(
        0.0, point.x, [0.0, 0.0]
    )
    assert not np.array_equal(double, got.astype(float))


@pytest.mark.sparse(1)
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("name", ["all operations", "satellite", "hostile"])
def test_generated_c_passes_strict_compilers_without_a_warning(name, compiler, tmp_path):
    system = hostile_system() if name == "hostile" else OTHERS[name]()
    if name == "all operations":
        system = all_operations(computable(every_operation()))
    program, layout = specialised(system, {})
    files = generate(program, layout, "c_f32")
    strictly_compile(files, tmp_path, compiler, "-Wdouble-promotion", "-Wfloat-conversion")


@pytest.mark.parametrize("compiler", COMPILERS)
def test_both_precisions_can_be_included_together(compiler, tmp_path):
    program, layout = specialised(OTHERS["singular"](), {})
    files = {**generate(program, layout, "c"), **generate(program, layout, "c_f32")}
    headers = [name for name in files if name.endswith(".h")]
    files["both.c"] = "".join(f'#include "{h}"\n' for h in headers) + "int both;\n"
    strictly_compile(files, tmp_path, compiler)
    assert {"free_rigid_body.h", "free_rigid_body_f32.h"} <= set(headers)


# --- the rule ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("double", "single"),
    [
        ("const double a = 0.1 * pow(x[0], 2.0);", "const float a = 0.1f * powf(x[0], 2.0f);"),
        ("enum { n = 12 }; a[1 * xs]", "enum { n = 12 }; a[1 * xs]"),
        ("1e+300 + 1e-300 - 5e-324", "INFINITY + 0.0f - 0.0f"),
        ("0.30000000000000004", "0.3f"),
        ("3.141592653589793", "3.1415927f"),
        ("16777217.0", "16777216.0f"),
        ("v1_ + x2e5 + sin_ + sinx", "v1_ + x2e5 + sin_ + sinx"),
        ('"double 0.1" /* double sin */ double', '"double 0.1" /* double sin */ float'),
        ('"\\"" 1.5', '"\\"" 1.5f'),
        ('#include "sin.h"\n #include <math.h>\nsin()', '#include "sin.h"\n #include <math.h>\nsinf()'),
        ("HUGE_VAL", "HUGE_VALF"),
    ],
)  # fmt: skip
def test_tokens(double, single):
    assert in_single_precision(double) == single


@given(st.floats(0, allow_nan=False, allow_infinity=False))
def test_constants_become_the_nearest_float(value):
    text = in_single_precision(repr(value))
    with np.errstate(over="ignore"):
        expected = np.float32(value)
    if text == "INFINITY":
        assert np.isinf(expected)
    else:
        assert re.fullmatch(r"\d+(\.\d+)?(e[+-]?\d+)?f", text)
        assert np.float32(text[:-1]) == expected


def test_no_quantity_is_spelt_as_a_function_of_either_precision():
    assert {*C_MATH, *(f"{name}f" for name in C_MATH)} <= RESERVED
    called = {w for t in c.TEMPLATES.values() for w in re.findall(r"(\w+)\(", t.text)}
    bessel = {"jn", "yn"}  # of POSIX; there are none for floats
    assert {w for w in called if not w.endswith("_")} - bessel <= C_MATH


def test_long_names_keep_the_suffix_that_distinguishes_them():
    system = System.from_rates("a" * 300, {x: -x})
    files = generate(*specialised(system, {}), "c_f32")
    assert list(files) == [f"{'a' * 56}_f32.h", f"{'a' * 56}_f32.c"]
    assert c.C_FLOAT.templates["sin"].text == "sinf({0})"
