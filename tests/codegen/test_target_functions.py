"""Functions with an order or with data in every target: Stumpff's functions and tables."""

import math

import numpy as np
import pytest
import sympy as sp

from codegen import compile as compile_system
from codegen.compiling.compiled import TARGETS, generate
from codegen.frontend.layout import Layout
from codegen.ir.interpret import Point, interpret_with_bound
from codegen.ir.program import Builder
from codegen.ir.stumpff import LARGEST
from codegen.native import native
from eom.errors import InputError
from eom.tables import Table
from tests import node
from tests.codegen.test_c_float import Single
from tests.codegen.test_compiled import SINGLE
from tests.codegen.test_targets import system_of, x

pytestmark = pytest.mark.shipped_flags

BREAKPOINTS, VALUES = [-2, -0.5, 0.25, 1, 4], [1, -1, 0.5, 0.5, 3]
TABLES = [
    Table(f"{kind} <{outside}>", BREAKPOINTS, VALUES, kind, outside)
    for kind in ("linear", "cubic", "pchip")
    for outside in ("hold", "linear")
]
ORDERS = (1, 2, 3, 6, LARGEST)
COUNT = len(ORDERS) + 2 * len(TABLES)
ARGUMENTS = [-500.0, -30.0, -3.0, -2.0, -1.0, -0.5, -1e-9, 0.0, 1e-300, 0.3, 1.0, 2.9, 3.1, 4.0,
             7.0, 40.0, 700.0]  # fmt: skip


def functions_of_the_first_state():
    """A program whose outputs are Stumpff's functions, tables and their derivatives; its layout."""
    b = Builder()
    states = b.leaf("state", 0), b.leaf("state", 1)
    made = [b.add("stumpff", b.const(k), states[0]) for k in ORDERS]
    for table in TABLES:
        made += [b.add("table", states[0], value=t) for t in (table, table.derivative)]
    results = {"rates": states, "outputs": made, "invariants": (), "singularities": ()}
    return b.program(results), Layout.of(system_of([x] * len(made), "functions"))


def evaluations():
    """The values of each target as (name, rows by argument, scale of the bound)."""
    program, layout = functions_of_the_first_state()
    at = [(0.0, [v, 0.0], [0.0, 0.0], []) for v in ARGUMENTS]
    for target in ("numpy", "python"):
        _, functions, _ = TARGETS[target](program, layout)
        yield target, [functions["outputs"](*point[:3]) for point in at], 1.0
    if native.compiler():
        single = Single(program, layout)
        yield "c_f32", [single("outputs", *point) for point in at], SINGLE.scale
    if node.NODE:
        (text,) = generate(program, layout, "javascript").values()
        (rows,) = node.run([node.Job(text, "outputs", at, COUNT)])
        yield "javascript", rows, 1.0


def test_values_stay_within_the_error_bound_in_every_target():
    program, _ = functions_of_the_first_state()
    seen = []
    for target, rows, scale in evaluations():
        seen.append(target)
        for v, row in zip(ARGUMENTS, rows, strict=True):
            at = v if scale == 1 else float(np.float32(v))
            wanted = interpret_with_bound(program, Point(0.0, [at, 0.0], [0.0, 0.0]))["outputs"]
            for k, (e, value) in enumerate(zip(wanted, row, strict=True)):
                if scale == 1 or e.value == 0 or 1e-30 < abs(e.value) < 1e30:
                    error = abs(float(value) - e.value)
                    assert error <= scale * (e.error + 1e-300), (target, v, k, value, e)
    assert {"numpy", "python"} <= set(seen)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_raises_nothing(value):
    program, layout = functions_of_the_first_state()
    python, numpy = (
        TARGETS[t](program, layout)[1]["outputs"](0.0, [value, 0.0], [0.0, 0.0])
        for t in ("python", "numpy")
    )
    np.testing.assert_array_equal(python[len(ORDERS) :], numpy[len(ORDERS) :])
    assert np.isnan(python).all() == math.isnan(value)


@pytest.mark.parametrize("target", ["python"])
def test_bessel_functions_are_refused(target):
    with pytest.raises(InputError) as error:
        compile_system(system_of([1 + sp.besselj(2, 3 * x)]), target)
    assert error.value.got == "besselj(2, mul(x, 3))"
    assert "numpy" in error.value.hint
