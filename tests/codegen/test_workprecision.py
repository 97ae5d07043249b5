"""Run time against error: references, programs, what is refused, and how it is reported."""

import importlib.util
import json
import warnings
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.integrate.methods import METHODS
from codegen.measure.workprecision import case as cases
from codegen.measure.workprecision import measuring, programs
from codegen.measure.workprecision import measuring as showing
from codegen.measure.workprecision.case import Case, Reference
from codegen.measure.workprecision.measuring import Plan, Point
from codegen.native import native
from codegen.native.children import TooLongError
from eom.errors import InputError
from eom.quantities import Quantity
from eom.system import System

x, y, k = sp.symbols("x y k", real=True)
OSCILLATOR = System.from_rates("oscillator", {x: y, y: -k * x})
CASE = Case("oscillator", "Harmonic oscillator", OSCILLATOR,
            {"x": 0.0, "y": 1.0}, {"k": 4.0}, {}, 10.0)  # fmt: skip
EXACT = np.array([np.sin(20.0) / 2, np.cos(20.0)])
QUICK = Plan((1e-4, 1e-8), 2, 5.0)


@pytest.fixture(scope="module")
def compiled():
    return CASE.compiled()


@pytest.fixture(scope="module")
def known(compiled):
    return cases.reference(CASE, compiled)


def program(name):
    (row,) = programs.programs([name])
    return row


def test_reference_has_more_digits_than_doubles(known):
    assert np.abs(known.high - EXACT).max() < 1e-15
    assert 0 < known.error < 1e-18
    assert np.all(np.abs(known.low) <= np.spacing(np.abs(known.high)) / 2)
    np.testing.assert_allclose(known.scale, [0.5, 1.0], rtol=0.05)


def test_errors_below_that_of_the_reference_are_not_reported():
    known = Reference(np.array([1.0, 2.0]), np.zeros(2), np.array([1.0, 4.0]), 1e-6, "made up")
    assert known.measured(np.array([1.0, 2.4])) == (pytest.approx(0.1), True)
    assert known.measured(np.array([1.0 + 1e-7, 2.0])) == (1e-6, False)


@pytest.mark.parametrize("stiff", [False, True])
def test_two_tight_runs_agree_with_many_digits(compiled, stiff):
    case = replace(CASE, stiff=stiff, end=2.0)
    tight, fine = cases._tight(case, compiled), cases.reference(replace(CASE, end=2.0), compiled)
    assert fine.distance(tight.high) <= 2 * tight.error < 1e-6


def test_a_case_with_branches_has_a_reference():
    system = System.from_rates("bounce", {x: y, y: -sp.Abs(x) - x})
    case = replace(CASE, system=system, parameters={}, end=2.0)
    found = cases.reference(case, case.compiled())
    assert "agree" in found.how
    assert found.error < 1e-6


def test_a_reference_that_cannot_be_had_is_refused():
    system = System.from_rates("pole", {x: x**2, y: 0 * y})
    case = replace(CASE, system=system, parameters={}, start={"x": 1.0, "y": 0.0}, end=2.0)
    with pytest.raises(InputError, match="no reference solution"):
        cases.reference(case, case.compiled())


def test_an_end_that_hangs_on_the_last_digit_of_the_start_is_refused(monkeypatch):
    """Lorenz's equations lose a digit in about 2.5 units of time; few digits, so that few do."""
    monkeypatch.setattr(cases, "DIGITS", (14, 10))
    z = sp.Symbol("z", real=True)
    rates = {x: 10 * (y - x), y: x * (28 - z) - y, z: x * y - sp.Rational(8, 3) * z}
    system = System.from_rates("lorenz", rates)
    case = replace(CASE, system=system, parameters={}, start={"x": 1.0, "y": 1.0, "z": 20.0})
    near, far = replace(case, end=1.0), replace(case, end=15.0)
    assert cases.reference(near, near.compiled()).error < 1e-8
    with pytest.raises(InputError, match="depends on its start"):
        cases.reference(far, far.compiled())


NAMES = [row.name for row in programs.programs()]


def test_every_method_and_its_peers_are_measured():
    assert NAMES[: len(METHODS)] == list(METHODS)
    assert {"solve_ivp:DOP853", "solve_ivp:LSODA", "solve_ivp:Radau", "heyoka"} <= set(NAMES)
    with pytest.raises(InputError, match="did you mean heyoka"):
        programs.programs(["DOP853", "heyoca"])


@pytest.mark.parametrize("name", [n for n in NAMES if n in METHODS or n.startswith("solve_ivp")])
def test_programs_integrate_the_same_case(name, known, compiled):
    try:
        run = program(name).prepare(CASE, compiled, 1e-6)
        end = run(np.inf)
    except InputError:
        pytest.skip("does not apply, and says so")
    assert known.distance(end.y) < 1e-2
    assert end.seconds > 0


def test_heyoka_integrates_the_same_case(known, compiled):
    pytest.importorskip("heyoka")
    end = program("heyoka").prepare(CASE, compiled, 1e-9)(np.inf)
    assert known.distance(end.y) < 1e-7
    assert end.steps > 1


def test_absent_heyoka_is_said(monkeypatch, compiled):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda n, *a: None if n == "heyoka" else find(n, *a)
    )
    diagram = measuring.measure(CASE, [program("heyoka")], QUICK)
    assert diagram.points == ()
    (absence,) = diagram.absent
    assert absence.reason == "heyoka is not installed"


def test_the_lambdified_function_is_the_system():
    """With definitions, parameters, inputs and a mass matrix, against the compiled one."""
    u = sp.Symbol("u", real=True)
    system = System(
        name="m",
        states=(Quantity(x), Quantity(y)),
        parameters=(Quantity(k),),
        inputs=(Quantity(u),),
        rates=(y, -k * x + u),
        mass_matrix=sp.ImmutableMatrix([[2, 0], [0, 1 + x**2]]),
    )
    case = replace(CASE, system=system, inputs={"u": 0.5})
    point = np.array([0.3, -0.7])
    ours = codegen.compile(system, "numpy").rhs(0.0, point, [4.0], [0.5])
    np.testing.assert_allclose(programs.lambdified(case)(0.0, point), ours, rtol=1e-14)
    with pytest.raises(InputError, match=r"mass matrix|not installed"):
        programs.heyoka_builder(case)


STIFF = System.from_rates("stiff", {x: -1e6 * (x - sp.cos(y)), y: 1 + 0 * y})


@pytest.mark.parametrize("name", ["scipy:DOP853", "solve_ivp:DOP853"])
def test_runs_that_take_too_long_are_given_up(name):
    case = replace(CASE, system=STIFF, parameters={}, start={"x": 0.0, "y": 0.0}, stiff=True)
    run = program(name).prepare(case, case.compiled(), 1e-6)
    with pytest.raises(TooLongError):
        run(0.05)


def test_a_diagram_has_every_point_and_says_what_is_missing():
    rows = programs.programs(["DOP853", "solve_ivp:DOP853", "solve_ivp:LSODA"])
    fractions = []
    plan = replace(QUICK, tolerances=(1e-4, 1e-8, 2.0**-52))
    diagram = measuring.measure(CASE, rows, plan, fractions.append)
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    by_name = {
        n: [p for p in diagram.points if p.program == n] for n in showing.names(diagram.points)
    }
    assert list(by_name) == [row.name for row in rows]
    for points in by_name.values():
        assert [p.rtol for p in points] == list(plan.tolerances[: len(points)])
        assert points[0].error > points[-1].error
        assert all(0 < p.seconds <= p.median and p.runs >= plan.rounds for p in points)
    assert len(by_name["DOP853"]) + sum(a.program == "DOP853" for a in diagram.absent) >= 3
    refused = {a.program: a for a in diagram.absent}
    assert "rtol" in refused["solve_ivp:DOP853"].reason, "SciPy would raise the tolerance"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        text = showing.data(diagram, {"date": "today"})
    data = json.loads(text)
    assert data["schema"] == showing.SCHEMA
    assert data["date"] == "today"
    assert len(data["points"]) == len(diagram.points)
    assert data["plan"]["seed"] == 0


def test_the_order_of_runs_follows_the_seed(monkeypatch):
    def order(seed):
        met = []

        def collect(trial):
            met.append(trial.rtol)
            trial.seconds.append(1.0)

        monkeypatch.setattr(measuring._Trial, "collect", collect)
        plan = replace(QUICK, tolerances=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6), rounds=4, seed=seed)
        measuring.measure(CASE, [program("solve_ivp:LSODA")], plan)
        return met

    first = order(3)
    assert order(3) == first
    assert order(4) != first
    assert sorted(first[:5]) == [1e-6, 1e-5, 1e-4, 1e-3, 1e-2]


def point(error, seconds, median=None):
    return Point("p", 1e-6, error, True, seconds, median or seconds, 3, 10)


def test_the_fastest_point_at_an_error():
    points = [point(1e-3, 1.0), point(1e-6, 3.0), point(1e-9, 2.0)]
    assert measuring.fastest(points, 1e-2) == points[0]
    assert measuring.fastest(points, 1e-5) == points[2]
    assert measuring.fastest(points, 1e-12) is None
    assert showing.time_text(None) == "-"
    assert showing.time_text(point(1e-3, 2.5e-5)) == "25 us"
    assert showing.time_text(point(1e-3, 2e-3, 3e-3)) == "2 ms +50%"


def test_times_between_points():
    points = [point(1e-2, 1.0), point(1e-4, 4.0), point(1e-3, 16.0), point(1e-6, 64.0)]
    assert measuring.time_at(points, 1e-4) == pytest.approx(4.0)
    assert measuring.time_at(points, 1e-3) == pytest.approx(2.0), "half way, on the first line"
    assert measuring.time_at(points, 1e-5) == pytest.approx(16.0 * 4 ** (2 / 3))
    assert measuring.time_at(points, 1.0) == 1.0
    assert measuring.time_at(points, 1e-7) == np.inf


def test_comparisons_are_of_this_projects_fastest_method(known):
    def curve(name, factor, last):
        return [Point(name, e, e, True, factor * t, factor * t, 3, 1)
                for e, t in ((1e-3, 1.0), (1e-6, 2.0), (1e-9, 4.0), (1e-12, 8.0)) if e >= last]  # fmt: skip

    curves = [
        ("auto", 1.0, 1e-12),
        ("DOP853", 2.0, 1e-6),
        ("taylor", 3.0, 1e-12),
        ("scipy:RK45", 0.1, 1e-12),
    ]
    points = [
        p
        for c in [*curves, ("heyoka", 6.0, 1e-9), ("solve_ivp:DOP853", 600.0, 1e-3)]
        for p in curve(*c)
    ]
    found = showing.comparisons(measuring.Diagram(CASE, known, tuple(points), (), QUICK))
    assert found == {
        "heyoka": {
            "1e-03": ("DOP853", pytest.approx(1 / 3)),
            "1e-06": ("DOP853", pytest.approx(1 / 3)),
            "1e-09": ("taylor", pytest.approx(1 / 2)),
        },
        "solve_ivp:DOP853": {"1e-03": ("DOP853", pytest.approx(1 / 300))},
    }


@pytest.mark.skipif(not native.compiler(), reason="runs C")
def test_generated_c_is_faster_than_a_lambdified_function():
    """By far: 20 times is asked for, hundreds are typical."""
    rows = programs.programs(["DOP853", "solve_ivp:DOP853"])
    diagram = measuring.measure(replace(CASE, end=200.0), rows, replace(QUICK, tolerances=(1e-9,)))
    ours, theirs = diagram.points
    assert ours.error <= 2 * theirs.error
    assert theirs.seconds > 20 * ours.seconds
