"""The fuzzer itself: it finds what is wrong, tells the smallest part, and draws the same again."""

import dataclasses

import pytest

from benchmarks import fuzz
from benchmarks.expressions import FUNCTIONS, INTEGERS, context, draw, points
from benchmarks.fuzz import Findings, Unit, check
from codegen.ops import OPS, TRUTH_VALUES
from codegen.targets import numpy_

COUNT = 12


@pytest.fixture(scope="module")
def unit():
    return Unit.of(3, 100, COUNT)


def test_nothing_is_found_where_nothing_is_wrong(unit):
    found = Findings()
    check(unit, ["numpy"], found)
    assert found.different == []
    assert found.compared["numpy"] > COUNT
    assert found.compared["folding"] > COUNT
    assert found.compared["lowering"] > COUNT
    assert found.compared["numpy, to the last bit"] > 0


def test_a_wrong_template_is_found_and_named(monkeypatch):
    wrong = numpy_.TEMPLATES | {"tanh": numpy_.TEMPLATES["tan"]}
    monkeypatch.setattr(numpy_, "TEMPLATES", wrong)
    tree = next(t for t in Unit.of(3, 0, 40).trees if "tanh" in t.operations())
    unit = dataclasses.replace(Unit.of(3, 0, 1), trees=[tree], program=fuzz.built([tree]), first=17)
    found = Findings()
    check(unit, ["numpy"], found)
    assert found.different
    assert "seed 3, index 17" in found.different[0]
    smallest = found.different[0].split("by itself: ")[1]
    assert smallest.startswith("tanh(")


def test_a_wrong_folding_is_found(monkeypatch, unit):
    wrong = fuzz.built([*unit.trees[1:], unit.trees[0]])
    found = Findings()
    check(dataclasses.replace(unit, program=wrong), [], found)
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
    assert set(INTEGERS) & set(OPS) <= drawn


def test_targets_that_do_not_work_here_are_named(monkeypatch):
    def broken(program, layout):
        raise OSError("no such machine")

    monkeypatch.setitem(fuzz.TARGETS, "abacus", broken)
    working, others = fuzz.targets_here()
    assert "numpy" in working
    assert others == ["abacus: no such machine"]
