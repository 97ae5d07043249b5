"""The fuzzer itself: it finds what is wrong, reports the smallest part, and draws the same again."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from benchmarks import fuzz, fuzz_targets
from benchmarks.expressions import (
    FUNCTIONS,
    INTEGERS,
    SIZES,
    TABLE_KINDS,
    Tree,
    context,
    draw,
    points,
)
from benchmarks.fuzz import Findings, Unit, check
from codegen.compiling.compiled import ROWS
from codegen.ir.interpret import Point
from codegen.ir.ops import OPS, TRUTH_VALUES
from codegen.native import native
from codegen.targets import numpy_
from tests.codegen.test_compiled import SINGLE

COUNT = 12
TWO = Tree("const", (), Fraction(2))
X = Tree("state", (), 0)
BESSEL = Tree("besselj", (TWO, X))


@pytest.fixture(scope="module")
def unit():
    return Unit.of(3, 100, COUNT)


def test_nothing_is_found_where_nothing_is_wrong(unit):
    found = Findings()
    check(unit, ["numpy"], found)
    assert found.different == []
    assert found.compared["numpy"] > 0.7 * COUNT * fuzz.POINTS
    assert found.compared["folding"] > 0.7 * COUNT * fuzz.MODEST
    assert found.compared["lowering"] > 0.5 * COUNT * fuzz.MODEST
    assert found.compared["numpy, to the last bit"] > 0


def test_a_wrong_template_is_found_and_named(monkeypatch):
    wrong = numpy_.TEMPLATES | {"tanh": numpy_.TEMPLATES["tan"]}
    monkeypatch.setattr(numpy_, "TEMPLATES", wrong)
    tree = next(t for t in Unit.of(3, 0, 40).trees if "tanh" in t.operations())
    unit = replace(Unit.of(3, 0, 1), trees=[tree], program=fuzz.built([tree]), first=17)
    found = Findings()
    check(unit, ["numpy"], found)
    assert found.different
    assert "seed 3, index 17" in found.different[0]
    smallest = found.different[0].split("by itself: ")[1]
    assert smallest.startswith("tanh(")


def test_a_wrong_folding_is_found(monkeypatch, unit):
    wrong = fuzz.built([*unit.trees[1:], unit.trees[0]])
    found = Findings()
    check(replace(unit, program=wrong), [], found)
    assert any(text.startswith("folding: ") for text in found.different)


def test_expressions_are_the_same_each_time_and_finite_at_the_base():
    m = context()
    base = points(5, 2, 4)[0]
    assert points(5, 2, 4) == points(5, 2, 4)
    for k in range(30):
        tree = draw(5, k, base, m)
        assert str(tree) == str(draw(5, k, base, m))
        assert m.isfinite(tree.exact(m, base))


def test_every_operation_is_drawn():
    m = context()
    base = points(0, 0, 1)[0]
    drawn = set().union(*(draw(0, k, base, m).operations() for k in range(600)))
    assert drawn >= {*FUNCTIONS, *TRUTH_VALUES, "add", "sub", "mul", "div", "neg", "select"}
    assert drawn >= {"table", "solution"}
    assert set(INTEGERS) & set(OPS) <= drawn


def test_targets_that_do_not_work_here_are_named(monkeypatch):
    def broken(program, layout):
        raise OSError("no such machine")

    monkeypatch.setitem(fuzz_targets.TARGETS, "abacus", broken)
    working, others = fuzz.targets_here()
    assert "numpy" in working
    assert {line.split(": ")[0] for line in others} | set(working) == {*ROWS, "abacus"}
    assert "abacus: no such machine" in others


def test_what_a_target_refuses_is_counted_and_the_rest_compared():
    trees = [BESSEL, Tree("add", (X, Tree("besselj", (TWO, TWO)))), Tree("sin", (X,))]
    unit = replace(Unit.of(3, 0, 1), trees=trees, program=fuzz.built(trees))
    found = Findings()
    check(unit, ["numpy", "python"], found)
    assert found.different == []
    assert found.refused == {"python, besselj": 1}  # J_2(2) is a number already
    assert 0 < found.compared["python"] < found.compared["numpy"]


def test_points_beyond_single_precision_are_left_out():
    fits = Point(0.1, [0.0, 1.0, 1e-300], [2.0, 3.0])
    huge = [
        replace(fits, t=1e300),
        replace(fits, x=[1e39, 0.0, 0.0]),
        replace(fits, p=[0.0, -1e40]),
    ]
    (kept,) = fuzz_targets.rounded("c_f32", [huge[0], fits, *huge[1:]])
    assert (kept.t, kept.x[2]) == (float(np.float32(0.1)), 0.0)
    assert fuzz_targets.rounded("python", [*huge, fits]) == [*huge, fits]


@pytest.mark.slow
@pytest.mark.skipif(not native.compiler(), reason="tests C itself")
def test_single_precision_is_compared_in_its_own_bound(unit):
    found = Findings()
    check(unit, ["c_f32"], found)
    assert found.different == []
    assert found.compared["c_f32"] > 2 * COUNT
    double = Findings()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fuzz_targets, "PRECISIONS", {"c_f32": replace(SINGLE, scale=1.0)})
        check(unit, ["c_f32"], double)
    assert double.different


def test_linear_systems_of_every_size_and_tables_of_every_kind_are_drawn():
    m, base = context(), points(0, 0, 1)[0]
    parts = [p for k in range(900) for p in draw(0, k, base, m).parts()]
    systems = [p for p in parts if p.op == "solution"]
    assert {len(s.args) for s in systems} == {n * (n + 1) for n in SIZES}
    assert {p.leaf.kind for p in parts if p.op == "table"} == set(TABLE_KINDS)
    programs = [fuzz.built([s]).counts() for s in systems[:40]]
    assert any("back" in counts for counts in programs)
    assert any("back" not in counts for counts in programs)


def test_a_linear_system_has_the_exact_solution_of_its_operands():
    m, base = context(), points(0, 0, 1)[0]
    rows = (TWO, X, X, X, TWO, TWO)  # 2 a + x b = 2, x a + x b = 2
    a, b = (Tree("solution", rows, k).exact(m, base) for k in range(2))
    x = m.mpf(base.x[0])
    assert abs(2 * a + x * b - 2) < 1e-45
    assert abs(x * a + x * b - 2) < 1e-45
