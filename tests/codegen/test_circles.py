"""Sines and cosines of many angles together: the cut of the program, and the C function's accuracy."""

import ctypes
import math
import subprocess

import mpmath
import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point, interpret
from codegen.ir.passes import prune
from codegen.ir.program import RATES
from codegen.native import native
from codegen.targets.c_helpers import BLOCK, CIRCLE, MANY_ANGLES, TURNED, circles
from eom.quantities import Quantity
from eom.system import System

pytestmark = pytest.mark.shipped_flags

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="tests C itself")
ULPS = 1.0


def angles(count):
    x = sp.symbols(f"x1:{count + 1}", real=True)
    rates = [sp.sin(2 * a) + x[k - 1] * sp.cos(a) for k, a in enumerate(x)]
    rates[0] += sp.sin(sp.cos(x[-1]))
    return System("angles", tuple(map(Quantity, x)), tuple(rates))


def test_the_cut_has_the_same_values():
    program = prune(lower_system(angles(5)), [RATES])
    cut = circles(program)
    x = [0.3, -1.2, 2.0, 5.5, -0.1]
    given = interpret(cut.angles, Point(x=x))[TURNED]
    assert sorted(given) == sorted([*x, *(2 * a for a in x)])
    given += [0.0] * (cut.room - len(given))
    assert cut.room % BLOCK == 0
    turned = [*np.sin(given), *np.cos(given)]
    expected = interpret(program, Point(x=x))[RATES]
    assert interpret(cut.late, Point(x=x, turned=turned))[RATES] == expected
    ops = [i.op for i in cut.late.instructions]
    assert (ops.count("sin"), ops.count("cos")) == (1, 0)  # the sine of a cosine is left


def test_few_angles_are_left_to_the_library():
    assert MANY_ANGLES > 2
    assert circles(prune(lower_system(angles(1)), [RATES])) is None


def hard():
    """Angles near zeros and extremes of both functions, at every size, and special ones."""
    draw = np.random.default_rng(3)
    near = [np.nextafter(k * np.pi / 2, s) for k in range(-60, 60) for s in (-9e9, 9e9)]
    quarter = [(2 * k + 1) * np.pi / 4 for k in range(-30, 30)]
    large = [*draw.uniform(-1e5, 1e5, 3000), *draw.uniform(-1e300, 1e300, 20), 1e5, -1e5]
    small = [*(10.0 ** draw.uniform(-320, 0, 500)), 5e-324, -5e-324]
    return np.array([*near, *quarter, *large, *small, *draw.uniform(-7, 7, 3000)])


def errors(found, exact):
    """Errors in units in the last place of the exact value."""
    return [
        abs(float((mpmath.mpf(float(f)) - e) / mpmath.mpf(math.ulp(float(e)))))
        for f, e in zip(found, exact, strict=True)
    ]


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("flags", [(), ("-O1",), ("-ffp-contract=fast",)], ids=str)
def test_errors_are_within_a_unit_in_the_last_place(flags):
    x = hard()
    x = np.concatenate([x, np.zeros(-len(x) % BLOCK)])
    text = f"#include <math.h>\n{CIRCLE}\n"
    text += "void f(int n, const double *a, double *r) { circle_(n, a, r); }\n"
    library = native.load(native.compile_library(text, flags), text, flags)
    r = np.empty(2 * len(x))
    library.f(len(x), x.ctypes.data_as(ctypes.c_void_p), r.ctypes.data_as(ctypes.c_void_p))
    with mpmath.workdps(400):
        exact = [mpmath.mpf(float(a)) for a in x]
        sines, cosines = map(mpmath.sin, exact), map(mpmath.cos, exact)
        assert max(errors(r[: len(x)], sines)) <= ULPS
        assert max(errors(r[len(x) :], cosines)) <= ULPS


@needs_compiler
def test_special_angles():
    rhs = codegen.compile(
        System(
            "s", tuple(map(Quantity, x := sp.symbols("x1:9", real=True))), tuple(map(sp.sin, x))
        ),
        "c",
    ).rhs
    with np.errstate(invalid="ignore"):
        found = rhs(0.0, np.array([0.0, -0.0, np.inf, -np.inf, np.nan, 1e22, -1e-310, 0.5]))
    assert math.copysign(1, found[0]) == 1
    assert math.copysign(1, found[1]) == -1
    assert np.isnan(found[2:5]).all()
    assert found[5] == math.sin(1e22)
    assert found[6] == -1e-310
    assert found[7] == pytest.approx(math.sin(0.5), rel=3e-16)


@needs_compiler
def test_the_text_gives_no_warning_where_the_function_is_replaced(tmp_path):
    text = f"#include <math.h>\n{CIRCLE}\nvoid f(double *a) {{ circle_(4, a, a + 4); }}\n"
    for more in (["-ffast-math"], ["-O3"], []):
        strict = [
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Wconversion",
            "-pedantic",
            "-Werror",
            "-fsyntax-only",
        ]
        subprocess.run(
            [*native.compiler(), *strict, *more, "-xc", "-"], input=text.encode(), check=True
        )
