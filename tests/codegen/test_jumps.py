"""Jumps of the rates that time cannot place as closely as the tolerance asks are reported, no others."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.loops import jumps
from codegen.native import native
from codegen.native.trajectory import Problem
from codegen.runs.result import Result
from eom.system import BodyAttitude, System

pytestmark = [pytest.mark.sparse, pytest.mark.skipif(not native.compiler(), reason="methods in C")]

x, v, t = sp.symbols("x v t", real=True)
F = sp.Symbol("F", real=True)
R = sp.Rational
EXPLICIT = ("DOP853", "DP5", "Tsit5", "taylor")
METHODS = (*EXPLICIT, "scipy:RK45", "scipy:LSODA", "scipy:Radau", "sundials:BDF")
EDGE = 7 - R(1, 10**6)
"""No double holds it."""


def window(start: Any, length: Any, of: Any = t) -> Any:
    """One for so long, else zero."""
    return sp.Heaviside(of - start) - sp.Heaviside(of - start - length)


LAST = codegen.compile(
    System.from_rates("last", {x: v, v: -x + F * sp.Heaviside(t - EDGE)}, time=t)
)


def share(run: Result) -> float:
    """How far beyond the tolerance a run says that a state may be, 0 where it says nothing."""
    found = re.search(r"rates jump .* by (\S+) times", run.notice)
    return float(found[1]) if found else 0.0


def off(run: Result, force: float) -> float:
    """The error of the velocity at the end: the force acts in the last 1e-6 s."""
    return float(abs(run.y[1, -1] - (force * math.sin(1e-6) - math.sin(7.0))))


@pytest.mark.sparse(2)
@pytest.mark.parametrize("method", METHODS)
def test_what_time_does_not_place_is_reported_and_bounds_the_error(method: str) -> None:
    run = codegen.simulate(LAST, {"x": 1, "v": 0}, (0, 7), {"F": 1e6}, method, 1e-11)
    assert run.status == 0
    assert 50 < share(run) < 1000
    assert "at t = 6.999999 s" in run.notice
    allowed = 1e-11 * np.max(np.abs(run.y[1, run.t > 6.9]))
    assert off(run, 1e6) < share(run) * allowed + 1000 * 1e-11


@pytest.mark.parametrize("method", EXPLICIT[:-1])
def test_a_jump_is_placed_as_closely_as_time_allows(method: str) -> None:
    """The rates on either side are taken up to where it is: within two spacings of doubles."""
    run = codegen.simulate(LAST, {"x": 1, "v": 0}, (0, 7), {"F": 1e6}, method, 1e-12)
    assert off(run, 1e6) < 2 * np.spacing(7.0) * 1e6


@pytest.mark.parametrize("method", METHODS[:-2])
@pytest.mark.parametrize("start", [0.0, 1.0])
def test_ordinary_jumps_are_not_reported(method: str, start: float) -> None:
    """Nor those that meet a state at rest, which is larger from there on."""
    for rtol in (1e-6, 1e-9, 1e-12):
        run = codegen.simulate(LAST, {"x": start, "v": 0}, (0, 12), {"F": 100}, method, rtol)
        assert run.status == 0
        assert not share(run)


@pytest.mark.parametrize("method", ["DOP853", "taylor", "scipy:RK45"])
def test_backward_runs_report_it(method: str) -> None:
    run = codegen.simulate(LAST, {"x": 1, "v": 0}, (7, 0), {"F": 1e6}, method, 1e-12)
    assert run.status == 0
    assert share(run) > 100


@pytest.mark.parametrize("method", ["DOP853", "taylor", "scipy:LSODA"])
def test_the_size_of_a_jump_may_depend_on_the_state(method: str) -> None:
    y, s = sp.symbols("y s", real=True)
    rates = {y: s**2 * window(R(1, 3), R(1, 10**6)), s: -s / 10}
    compiled = codegen.compile(System.from_rates("of_state", rates, time=t))
    large, small = (
        codegen.simulate(compiled, {"y": 1, "s": size}, (0, 1), None, method, 1e-12)
        for size in (1e3, 1.0)
    )
    assert large.status == small.status == 0
    assert share(large) > 10
    assert not small.notice


def test_a_pulse_that_the_shortest_step_passes_over_is_reported() -> None:
    """The rates before and behind it are the same; those of the stages between are not."""
    force = 10**8 * window(5, R(1, 2**48))
    system = System.from_rates("shortest", {x: v, v: -x + force}, time=t)
    run = codegen.simulate(system, {"x": 1, "v": 0}, (0, 7), method="DOP853", rtol=1e-9)
    assert run.status == 0
    assert share(run) > 100


def test_series_report_it_of_switches_in_the_state() -> None:
    y = sp.Symbol("y", real=True)
    system = System.from_rates("crossing", {x: 1, y: F * window(R(1, 3), R(1, 10**6), x)},
                               time=t)  # fmt: skip
    large, small = (
        codegen.simulate(system, {"x": 0, "y": 1}, (0, 1), {"F": force}, "taylor", 1e-12)
        for force in (1e6, 1.0)
    )
    assert share(large) > 10
    assert not small.notice


def _turned(force: Any) -> System:
    """A free body with a torque about one axis."""
    q, w = sp.symbols("q0:4", real=True), sp.symbols("w1:4", real=True)
    h, J = R(1, 2), (2, 3, 4)
    rates = {
        q[0]: -h * (q[1] * w[0] + q[2] * w[1] + q[3] * w[2]),
        q[1]: h * (q[0] * w[0] + q[2] * w[2] - q[3] * w[1]),
        q[2]: h * (q[0] * w[1] + q[3] * w[0] - q[1] * w[2]),
        q[3]: h * (q[0] * w[2] + q[1] * w[1] - q[2] * w[0]),
        w[0]: ((J[1] - J[2]) * w[1] * w[2] + force) / J[0],
        w[1]: (J[2] - J[0]) * w[2] * w[0] / J[1],
        w[2]: (J[0] - J[1]) * w[0] * w[1] / J[2],
    }
    body = BodyAttitude(
        omega=w, kind="quaternion", coordinates=q, inertia=sp.diag(*J), torque=(force, 0, 0)
    )
    return System.from_rates("turned", rates, time=t, attitudes=(body,))


@pytest.mark.sparse(only=("splitting",))
@pytest.mark.parametrize("method", ["rkmk", "splitting"])
def test_methods_on_the_group_report_it(method: str) -> None:
    """Both pass over it by the torque on either side, and agree to what they report."""
    compiled = codegen.compile(_turned(F * window(EDGE, R(1, 10**6))))
    start = [1, 0, 0, 0, 0.1, 0.2, 0.3]
    large, small = (
        codegen.simulate(compiled, start, (0, 8), {"F": force}, method, 1e-12)
        for force in (1e6, 1.0)
    )
    assert share(large) > 100
    assert not small.notice
    other = codegen.simulate(compiled, start, (0, 8), {"F": 1e6}, "DOP853", 1e-12)
    assert np.max(np.abs(large.y[:, -1] - other.y[:, -1])) < 10 * np.spacing(7.0) * 1e6


def test_an_error_counts_against_the_state_from_there_on() -> None:
    problem = Problem(np.zeros(1), (0, 1), np.empty(0), np.empty(0), 1e-6, np.array([1e-9]), 0, 0)
    found = jumps.Jumps(problem)
    found.jump(0.25, np.array([0.0]), np.array([1e-8]))
    assert "t = 0.25 s" in jumps.notice(found, problem)
    found.step(np.array([1.0]))
    assert not jumps.notice(found, problem)
    found.jump(0.5, np.array([1e-3]), np.array([2e-9]))
    assert "t = 0.5 s" in jumps.notice(found, problem)  # small now, and it was large before
    found.jump(0.75, np.array([10.0]), np.array([3e-9]))
    assert not jumps.notice(found, problem)
