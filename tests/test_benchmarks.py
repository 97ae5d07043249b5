"""Benchmarks with peers: what is missing is said, and what both can be asked is right."""

import importlib
import math
import subprocess

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import __main__ as report
from benchmarks import chains, compile_time, peers, pendulum, sympy_mechanics, through_jax
from benchmarks.__main__ import Measurement
from benchmarks.articulated import accelerations, chain
from benchmarks.settings import Settings
from benchmarks.table import Row, Section
from codegen.ir.interpret import Point, interpret
from codegen.ir.program import RATES
from codegen.native import native

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="times C itself")


@pytest.fixture
def alone(monkeypatch):
    """No peer is installed."""
    for module in (chains, pendulum):
        monkeypatch.setattr(module, "missing", lambda *names: names)
    monkeypatch.setattr(chains, "BODIES", (2,))
    monkeypatch.setattr(chains, "DERIVED", (2, 4))


@needs_compiler
def test_without_peers_ours_is_measured_and_the_others_are_named(alone):
    section = chains.measure(Settings())
    assert [r.what for r in section.rows[:2]] == [
        f"{n} bodies: description to program" for n in (2, 4)
    ]
    assert section.rows[1].met
    assert section.rows[3].what == "2 bodies"
    assert [r.what for r in section.rows[4:]] == ["casadi", "pin"]
    assert all("missing: install the extra bench" in r.beside for r in section.rows[4:])
    assert all(r.met is None for r in section.rows[3:])


@needs_compiler
def test_a_pendulum_without_pydy(alone):
    found = pendulum.whole(1)
    assert set(found) == {"derive", "ours", "call"}
    stages = pendulum.stages(1)
    assert set(stages) == {*pendulum.STAGES, "operations"}


def test_peers_are_named_by_their_distributions():
    assert set(peers.missing(*peers.MODULES)) <= set(peers.MODULES)
    assert all(name in peers.versions() for name in peers.MODULES)


def test_the_recursion_on_floats_and_as_a_program_is_the_same():
    count = 3
    x, u = np.linspace(-1.0, 1.2, 2 * count), np.array([0.3, -0.7, 1.1])
    q, rates = list(x[:count]), list(x[count:])
    expected = accelerations(chain(count), q, rates, list(u), math.sin, math.cos)
    found = interpret(chains.program(count), Point(x=x, u=u))[RATES]
    np.testing.assert_allclose(found, [*rates, *expected], rtol=1e-12)


def test_the_recursion_is_newtons_law_for_one_body_that_hangs():
    """One link about a horizontal axis through its joint: J q'' = torque - the moment of weight."""
    tree = chain(1)
    (body,), (joint,) = tree.bodies, tree.joints
    m, c = float(body.mass), [float(x) for x in body.centre]
    moment = float(body.inertia[2][2]) + m * (c[0] ** 2 + c[1] ** 2)
    q, rate, torque = 0.4, -1.3, 0.7
    (found,) = accelerations(tree, [q], [rate], [torque], math.sin, math.cos)
    turn = np.array([[math.cos(q), math.sin(q), 0], [-math.sin(q), math.cos(q), 0], [0, 0, 1]])
    weight = turn @ np.array(joint.on_parent.rotation) @ np.array([0.0, 0.0, -m * 9.81])
    expected = (torque + np.cross(c, weight)[2]) / moment
    assert found == pytest.approx(expected, rel=1e-13)


@pytest.mark.slow
def test_the_short_forms_judge_counts_alone():
    quick = Settings(quick=True)
    for section in (chains.measure(quick), compile_time.measure(quick)):
        assert all(row.met for row in section.rows)


@pytest.mark.parametrize(
    ("module", "test", "kinds"),
    [
        pytest.param(
            "test_kane",
            "test_aux",
            {"KanesMethod", "KanesMethod, 2 auxiliary speeds"},
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "test_kane2",
            "test_aux_dep",
            {"KanesMethod, 3 dependent speeds, 3 auxiliary speeds"},
            marks=pytest.mark.slow,
        ),
        ("test_kane", "test_two_dof", {"KanesMethod"}),
        ("test_lagrange", "test_nonminimal_pendulum", {"LagrangesMethod, 1 multipliers"}),
    ],
)
def test_systems_of_sympy_s_own_tests_have_its_rates(module, test, kinds):
    recorder = sympy_mechanics.Recorder()
    with recorder.watching():
        getattr(importlib.import_module(f"sympy.physics.mechanics.tests.{module}"), test)()
    assert {b.kind for b in recorder.built} == kinds
    for built in recorder.built:
        assert sympy_mechanics.error(built, states=1) <= sympy_mechanics.LARGEST


def test_one_section_is_measured_alone(monkeypatch):
    rows = (Row("a thing", "1", target="0", met=False),)
    measured = Measurement(_a_section(rows), needs_compiler=False)
    others = Measurement(chains.measure, needs_compiler=False)
    monkeypatch.setattr(report, "MEASUREMENTS", (others, measured))
    found = CliRunner().invoke(report.main, ["--only", "derivations"])
    assert found.exit_code == 1
    assert "Missed: a thing." in found.output


def _a_section(rows):
    def measure(_):
        return Section("a section", rows)

    measure.__module__ = "benchmarks.derivations"
    return measure


def test_a_section_that_is_not_there_is_refused_with_those_that_are():
    found = CliRunner().invoke(report.main, ["--only", "derivation"])
    assert found.exit_code == 2
    assert "'derivations'" in found.output
    assert "'chains'" in found.output


def test_differences_to_jax_are_judged_by_the_size_of_what_is_compared():
    expected = np.array([[1.0, 0.0], [-4.0, 1e-20]])
    got = expected + np.array([[0.0, 1e-20], [4e-10, 0.0]])
    assert through_jax.worst(got, expected, axis=0) == 1.0  # of the second column, which is noise
    assert through_jax.worst(got, expected, axis=0, least=1e-6) == pytest.approx(1e-10)
    assert math.isnan(through_jax.worst(got * np.nan, expected, axis=0))
    found = {"written": 0.0, "values": 2e-14, "gradients": 1e-10, "ours": 1e-3, "theirs": 2e-3}
    written, rates, gradients = through_jax.rows("top", found)
    assert (written.met, rates.met, gradients.met, gradients.ratio) == (True, False, True, "0.5")
    assert gradients.what == "top, gradients: 1.0e-10"
    exact = {"our error": 1e-16, "their error": 2e-14, "bound": 3e-13, "within": True}
    rates = through_jax.rows("top", found | exact)[1]
    assert (rates.what, rates.ours, rates.met) == (
        "top, rates compiled: 2.0e-14",
        "error 1.0e-16",
        True,
    )
    assert not through_jax.rows("top", found | exact | {"within": False})[1].met


def test_what_jax_did_not_reach_is_told_with_what_it_reached(monkeypatch):
    def slow(command, timeout, **_):
        raise subprocess.TimeoutExpired(command, timeout, b'{"written": 0.0, "values": 0.0}\n{"gra')

    monkeypatch.setattr(through_jax.subprocess, "run", slow)
    *rates, left = through_jax.apart("top", 5.0, through_jax.STAGES)
    assert [row.met for row in rates] == [True, True]
    assert left.what == "top, gradients, many: not reached in 5 s"
    assert not left.met


def test_trajectories_in_calls_are_as_many_as_the_budget_allows(monkeypatch):
    found, seconds = through_jax.in_calls(lambda x: 2 * x, np.arange(10.0)[None, :], 4)
    assert found.tolist() == [(2 * np.arange(10.0)).tolist()]
    assert seconds > 0
    clock = iter(np.arange(0.0, 1000.0, 100.0))
    monkeypatch.setattr(through_jax, "perf_counter", lambda: next(clock))
    assert through_jax.in_calls(lambda x: x, np.zeros((1, 10)), 2)[0].shape == (1, 4)


@pytest.mark.slow
@needs_compiler
def test_gradients_through_jax_are_our_sensitivities():
    pytest.importorskip("diffrax")
    values, gradients = through_jax.compared("t-handle", ("values", "gradients"))
    assert values["written"] == 0
    assert all(row.met for row in through_jax.rows("t-handle", values | gradients))
    assert gradients["gradients"] > 0
