"""Sizes of terms: what a constant of the motion is small beside, and drift relative to it."""

import copy
import pickle

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.compiling.compiled import compile as compile_system
from codegen.ir import interpret
from codegen.ir.program import INVARIANTS
from codegen.precision.conditioning import Sizes, scale_of, sizes_program
from eom.mechanics.rigidbody import free_rigid_body
from eom.system import System

x, y, v, k = sp.symbols("x y v k", real=True)


def size(expression, at):
    system = System.from_rates("one", {x: 0 * x, y: 0 * y}, invariants={"c": expression})
    compiled = compile_system(system, "numpy")
    empty = np.empty((0, 1))
    return Sizes(compiled).terms(np.zeros(1), np.array(at, dtype=float)[:, None], empty, empty)[
        0, 0
    ]


@pytest.mark.parametrize(
    ("expression", "at", "expected"),
    [
        (x - y, (1.0, 1.0), 2.0),
        (x**2 + y**2, (3.0, 4.0), 25.0),
        ((x - y) * (x + y), (2.0, 2.0), 16.0),
        (x * (y - 1) - 3, (2.0, 1.0), 7.0),
        ((x - 1) / y, (1.0, -4.0), 0.5),
        (sp.sqrt(x**2 + y**2) - 5, (3.0, 4.0), 10.0),
        (sp.cos(x) - y, (0.0, 1.0), 2.0),
        (sp.Piecewise((x - y, x > 0), (10 * y, True)), (1.0, 1.0), 2.0),
        (sp.sin(x) / y, (0.0, 1.0), 0.0),
        (-sp.Abs(x - y), (5.0, 5.0), 10.0),
    ],
)  # fmt: skip
def test_the_size_of_a_sum_is_the_sum_of_the_sizes(expression, at, expected):
    assert size(expression, at) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("seed", range(4))
def test_no_result_is_larger_than_its_size(seed):
    compiled = compile_system(free_rigid_body("quaternion"), "numpy")
    point = interpret.random_point(compiled.program, seed)
    values = interpret.interpret(compiled.program, point)[INVARIANTS]
    sizes = interpret.interpret(sizes_program(compiled.program, INVARIANTS), point)[INVARIANTS]
    assert len(sizes) == len(values)
    for value, own in zip(values, sizes, strict=True):
        assert abs(value) <= own * (1 + 1e-14)


def test_a_closure_that_is_zero_but_for_rounding_has_next_to_no_drift():
    """Closed by start values to 4e-16, and drifting by less: not by 14 %."""
    closure = {"closure": sp.cos(x) - y}
    system = System.from_rates("closure", {x: v, y: -sp.sin(x) * v, v: 0 * v}, invariants=closure)
    start = {"x": 0.7, "y": float(np.cos(0.7)) + 4e-16, "v": 1.0}
    drift = codegen.simulate(system, start, (0, 2), method="DOP853", rtol=1e-12).drift["closure"]
    assert drift.start != 0
    assert drift.kind == "relative"
    assert drift.size == pytest.approx(2 * np.cos(0.7), rel=0.5)
    assert drift.relative < 1e-10


def test_terms_that_are_rounding_themselves_are_measured_by_states_of_their_unit():
    """A pendulum of two axes that swings in one plane: momentum about the other axis is noise."""
    system = System.from_rates("planes", {x: v, v: -x, y: 0 * y}, invariants={"p": x * y})
    run = codegen.simulate(system, {"x": 1.0, "v": 0.0, "y": 1e-17}, (0, 5), method="DOP853")
    assert run.drift["p"].relative < 1e-15
    assert run.drift["p"].scale == pytest.approx(1.0, rel=0.1)


def test_where_everything_is_zero_drift_is_absolute():
    system = System.from_rates("rest", {x: 0 * x, y: 0 * y}, invariants={"c": x * y})
    drift = codegen.simulate(system, [0, 0], (0, 1), method="DOP853").drift["c"]
    assert (drift.kind, drift.scale, drift.relative) == ("absolute", 1.0, 0.0)


def test_terms_that_are_wrong_do_not_hide_that_they_are():
    terms, change = np.array([[1.0, 50.0]]), np.array([[0.0, 49.0]])
    assert scale_of(terms, change, 0 * terms).tolist() == [1.0]


def test_an_ensemble_measures_drift_as_single_runs_do():
    radius = {"zero": x**2 + v**2 - sp.Rational(1, 4)}
    system = System.from_rates("circle", {x: v, v: -x}, invariants=radius)
    compiled = compile_system(system)
    if compiled.target != "c":
        pytest.skip("ensembles run in C")
    given = {"x": [0.3, 0.5, 1.5], "v": [0.4, 0.0, 0.0]}
    found = codegen.ensemble(compiled, given, (0, 10), method="DOP853", rtol=1e-6, keep=True)
    for n in range(3):
        start = {name: values[n] for name, values in given.items()}
        one = codegen.simulate(compiled, start, (0, 10), method="DOP853", rtol=1e-6, t_eval=[0, 10])
        assert found.columns["drift"][0, n] == pytest.approx(one.drift["zero"].relative, rel=1e-6)


def test_the_size_is_found_once_and_goes_with_copies():
    radius = {"zero": x**2 + v**2 - sp.Rational(1, 4)}
    system = System.from_rates("circle", {x: v, v: -x}, invariants=radius)
    run = codegen.simulate(system, [0.3, 0.4], (0, 10), method="DOP853")
    for other in (pickle.loads(pickle.dumps(run)), copy.copy(run), copy.deepcopy(run)):
        assert other.drift["zero"] == run.drift["zero"]
        assert other.drift["zero"].size == run.drift["zero"].size
        assert other.drift["zero"].terms is None or other is not run
