"""Hostile systems: their table, their references, and that the check sees what is wrong."""

import json
import math
import shutil
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from benchmarks import hostile_references
from codegen import compile as compile_system
from codegen import simulate
from codegen.measure.stress import hostile
from codegen.measure.stress.hostile_cases import FAMILIES, Hostile, cases
from codegen.measure.stress.record import FAIL, PASS, SIZES, Plan
from codegen.native import native

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="methods in C")
x, v = sp.symbols("x v", real=True)


def plan(*methods, **size):
    return Plan(replace(SIZES["quick"], limit=5.0, **size), methods)


@pytest.fixture
def alone(monkeypatch):
    """Let the check see one case only."""
    case = next(c for c in cases("friction") if c.name == "root(30 v)")
    monkeypatch.setattr(hostile, "sample", lambda apart: [case])
    monkeypatch.setattr(hostile, "RTOLS", (1e-9,))
    return case


def test_the_table_is_as_long_as_it_says_and_every_case_has_a_name_and_a_system():
    assert len({c.key for c in cases()}) == len(cases())
    assert min(Counter(c.family for c in cases()).values()) >= 20
    for case in cases():
        assert list(case.rates) == [q.symbol for q in case.system.states]
        assert len(case.start) == len(case.rates)
        assert case.span[0] != case.span[1]


def test_references_are_of_the_cases_as_they_are():
    stored = json.loads(hostile.STORE.read_text(encoding="ascii"))
    assert set(hostile.references()) == set(stored) <= {c.key for c in cases()}
    assert len(stored) >= 220
    assert {key.partition(":")[0] for key in stored} == set(FAMILIES)
    for case in cases():
        if case.key in stored:
            row, known = stored[case.key], hostile.references()[case.key]
            assert row["agreement"] <= hostile_references.AGREED
            assert known.states.shape == (len(known.times), len(case.rates))
            assert np.isfinite(known.states).all()
            assert (known.growth >= 1).all()
            assert known.times[-1] == case.span[1]


def test_an_error_is_judged_by_tolerance_growth_and_size():
    known = hostile.Known(
        np.array([1.0, 2.0]), np.array([[1.0, 1e-9], [2.0, 0.0]]), np.array([2.0, 1e-9]),
        np.array([1.0, 10.0]),
    )  # fmt: skip
    assert known.share(known.states.T, 1e-6) == 0
    off = known.states.T + np.array([[4e-3, 0.0], [0.0, 0.0]])
    assert known.share(off, 1e-6) == pytest.approx(2.0)
    late = known.states.T + np.array([[0.0, 4e-3], [0.0, 0.0]])
    assert known.share(late, 1e-6) == pytest.approx(0.2)
    small = known.states.T + np.array([[0.0, 0.0], [1e-9, 0.0]])
    assert known.share(small, 1e-6) == pytest.approx(1e3)
    assert known.share(known.states.T * math.nan, 1e-6) == math.inf


def test_what_is_said_of_a_run_is_no_silent_error():
    compiled = compile_system(cases("late")[0].system, "numpy")
    result = simulate(compiled, (1.0, 0.0), (0, 1), method="scipy:RK45")
    assert hostile.trusted(result, compiled)
    assert not hostile.trusted(replace(result, notice="few digits are left"), compiled)
    assert not hostile.trusted(replace(result, status=-1), compiled)
    cached = replace(compiled, notice="no compiler")
    assert hostile.trusted(replace(result, notice="no compiler"), cached)


def test_a_wrong_result_fails_the_check_and_a_right_one_passes_it(alone, monkeypatch):
    assert hostile.hostile(None, plan("scipy:DOP853")).verdict == PASS
    known = hostile.references()[alone.key]
    moved = replace(known, states=known.states + 2e-3 * known.growth[:, None] * known.sizes)
    monkeypatch.setattr(hostile, "references", lambda: {alone.key: moved})
    found = hostile.hostile(None, plan("scipy:DOP853"))
    assert found.verdict == FAIL
    assert found.worst.what == f"{alone.key}: scipy:DOP853 at 1e-09"


def test_a_case_without_a_reference_is_reported(alone, monkeypatch):
    monkeypatch.setattr(hostile, "references", dict)
    found = hostile.hostile(None, plan("scipy:DOP853"))
    assert not found.figures
    assert alone.key in found.absent[0]


@pytest.mark.skipif(not shutil.which("gcc"), reason="references are made by gcc")
def test_references_are_right_where_the_solution_is_known():
    decay = Hostile("decay", "test", {x: -2 * x, v: x}, (1.0, 0.0), (0.0, 2.0))
    found = hostile_references.reference(decay)
    for at, state in zip(found["times"], found["states"], strict=True):
        assert state == pytest.approx([math.exp(-2 * at), (1 - math.exp(-2 * at)) / 2], rel=4e-16)
    assert found["sizes"] == pytest.approx([1.0, (1 - math.exp(-4)) / 2])
    assert 1 <= found["growth"][-1] < 2  # no error grows; those on the way add up to about one


@pytest.mark.skipif(not shutil.which("gcc"), reason="references are made by gcc")
def test_references_end_their_steps_where_rates_jump():
    kick = sp.Piecewise(
        (10, (sp.Symbol("t", real=True) > 1) & (sp.Symbol("t", real=True) < sp.Rational(11, 10))),
        (0, True),
    )
    jump = Hostile("jump", "test", {x: kick}, (0.0,), (0.0, 2.0), knots=(1.0, 1.1))
    assert hostile_references.reference(jump)["states"][-1] == pytest.approx([1.0], rel=1e-15)


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("family", FAMILIES)
def test_the_default_method_is_not_silently_wrong(family, monkeypatch):
    known = hostile.references()
    case = next(c for c in cases(family) if c.key in known)
    monkeypatch.setattr(hostile, "sample", lambda apart: [case])
    monkeypatch.setattr(hostile, "RTOLS", (1e-9,))
    found = hostile.hostile(None, plan("auto"))
    assert all(f.passed for f in found.figures), [(f.what, f.note) for f in found.figures]
