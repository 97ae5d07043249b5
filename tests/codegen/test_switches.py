"""Branches in method taylor: closed forms, SciPy with short steps, double changes within a step, rest."""

import itertools
import math
import shutil
import subprocess

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate

import codegen
from codegen import Event
from codegen.derivatives.taylor import prepare
from codegen.ir.program import RATES
from codegen.loops import taylor, taylor_lanes
from codegen.native import native
from eom.system import System

pytestmark = [pytest.mark.sparse, pytest.mark.skipif(not native.compiler(), reason="runs C")]
x, v, a, y, z, mu = sp.symbols("x v a y z mu", real=True)
ROOTS = sp.symbols("r1:6", real=True)
ONE = sp.Integer(1)
PRODUCT = sp.prod([a - r for r in ROOTS])
COMPILED = {}


def compiled(name, rates, **others):
    if name not in COMPILED:
        COMPILED[name] = codegen.compile(System.from_rates(name, rates, **others), "c")
    return COMPILED[name]


def polynomial():
    """The modulus and the sign of a polynomial of time, which series of low order have exactly."""
    rates = {a: ONE, y: sp.Abs(PRODUCT), z: sp.sign(PRODUCT)}
    return compiled("polynomial", rates)


def friction():
    return compiled("friction", {x: v, v: -x - mu * sp.sign(v)})


def spring():
    return compiled("spring", {x: v, v: -sp.Max(-1, sp.Min(1, x)) + sp.sin(3 * a) / 2, a: ONE})


def run(system, start, span, parameters=None, rtol=1e-13, **options):
    found = codegen.simulate(system, start, span, parameters, "taylor", rtol, **options)
    assert found.success, found.message
    return found


# --- closed forms ---------------------------------------------------------------------------------


@pytest.mark.sparse(1)
@pytest.mark.parametrize("often", [1, 20])
@pytest.mark.parametrize("rtol", [1e-6, 1e-10, 2.0**-52])
def test_modulus_of_a_sine(often, rtol):
    """The integral of |sin(n a)| is 2/n an arch, and (1 - cos(n a)) / n from its beginning."""
    system = compiled(f"arches{often}", {a: ONE, y: sp.Abs(sp.sin(often * a))})
    for end in (3.0, 50.0, -20.0):
        arches, rest = divmod(often * abs(end), math.pi)
        exact = math.copysign((2 * arches + 1 - math.cos(rest)) / often, end)
        found = run(system, [0.0, 0.0], (0, end), rtol=rtol)
        assert abs(found.y_stop[1] - exact) < 30 * rtol * abs(exact) + 1e-13
        assert found.rejected == 0 or often > 1


@pytest.mark.parametrize("rtol", [1e-8, 1e-13])
def test_swings_with_dry_friction_lose_as_much_every_time(rtol):
    """At the times n pi the oscillator turns, 2 mu nearer to the middle (v = 0 at the start, too)."""
    times = np.pi * np.arange(1, 7)
    found = run(friction(), [10.0, 0.0], (0, 19), [0.3], rtol, t_eval=times)
    exact = (-1.0) ** np.arange(1, 7) * (10 - 0.6 * np.arange(1, 7))
    assert np.max(np.abs(found["x"] - exact)) < 50 * rtol
    assert found.steps < 60


@pytest.mark.slow
@settings(max_examples=40)
@given(
    st.lists(st.integers(1, 999), min_size=5, max_size=5, unique=True),
    st.sampled_from([1.0, 1e-3]),
    st.sampled_from([1e-6, 1e-13]),
)
def test_no_change_of_sign_is_passed_over(thousandths, width, rtol):
    """Five zeros of a polynomial of degree five: the whole run would be one step."""
    roots = [k / 1000 * width for k in thousandths]
    found = run(polynomial(), [0.0, 0.0, 0.0], (0, 1), roots, rtol)
    power = np.poly1d(roots, r=True)
    ends = [0.0, *sorted(roots), 1.0]
    parts = [power.integ()(q) - power.integ()(p) for p, q in itertools.pairwise(ends)]
    signs = sum((-1) ** (k + 1) * (q - p) for k, (p, q) in enumerate(itertools.pairwise(ends)))
    np.testing.assert_allclose(found.y_stop[1], sum(map(abs, parts)), rtol=1e-11)
    np.testing.assert_allclose(found.y_stop[2], signs, atol=1e-12)
    assert found.rejected == 0


@pytest.mark.sparse(1)
@pytest.mark.parametrize("method", ["simulate", "lanes"])
@pytest.mark.parametrize("apart", [1e-1, 1e-4, 1e-7])
def test_a_double_change_in_one_step_is_seen(method, apart):
    """The modulus of (a - 1/2)(a - 1/2 - d) gains d^3 / 3, its sign loses 2 d: all else fits at the end."""
    system = compiled(
        "double", {a: ONE, y: sp.sign((a - mu) * (a - mu - z)), z: 0 * z, x: sp.sin(a)}
    )
    start = {"a": 0.0, "y": 0.0, "z": apart, "x": 0.0}
    if method == "simulate":
        found = run(system, start, (0, 1), [0.5], 1e-6)
    else:
        found = codegen.ensemble(
            system, {k: [u] * 3 for k, u in start.items()}, (0, 1), [0.5], "taylor", 1e-6
        )
        assert "lanes" in found.method
    gained = found.y_stop[list(found.names if method == "simulate" else "ayzx").index("y")]
    np.testing.assert_allclose(gained, 1 - 2 * apart, atol=1e-12)


@pytest.mark.parametrize("slope", [1.0, -1.0])
@pytest.mark.parametrize("end", [1.5, -1.5])
@pytest.mark.parametrize("begin", [0.0, 7.0])
def test_starts_on_a_switch(slope, end, begin):
    """Y' = max(x, 0), z' = sign(x), x' = s from x = 0: the side is that to which x goes."""
    system = compiled("ramp", {x: mu, y: sp.Max(x, 0), z: sp.sign(x)})
    found = run(system, [0.0, 0.0, 0.0], (begin, begin + end), [slope])
    there = slope * end
    exact = [
        there,
        max(there, 0.0) * abs(end) / 2 * math.copysign(1, end),
        math.copysign(1.5, slope),
    ]
    np.testing.assert_allclose(found.y_stop, exact, atol=1e-14)


def test_conditions_of_pieces_and_counts_of_switches():
    """A stop on one side, and a piece between two limits that hold together."""
    rates = {x: v, v: -x - 5 * sp.Piecewise((x - 1, x > 1), (0, True)),
             y: sp.Piecewise((1, sp.And(x > 0, v < 0)), (0, True))}  # fmt: skip
    system = compiled("stop", rates)
    found = run(system, [0.0, 2.0, 0.0], (0, 30), max_step=1.0)
    oracle = integrate.solve_ivp(
        lambda t, q: [q[1], -q[0] - 5 * max(q[0] - 1, 0), float(q[0] > 0 and q[1] < 0)],
        (0, 30), [0.0, 2.0, 0.0], "DOP853", rtol=1e-10, atol=1e-12, max_step=1e-2)  # fmt: skip
    np.testing.assert_allclose(found.y_stop[:2], oracle.y[:2, -1], atol=1e-7)
    assert found.y_stop[2] == pytest.approx(oracle.y[2, -1], abs=2e-2)


# --- SciPy with short steps -----------------------------------------------------------------------


@pytest.mark.sparse(1)
@pytest.mark.parametrize("begin", [(0.0, 3.0, 0.0), (0.4, 0.0, 1.0), (-2.0, -1.0, 2.0)])
def test_a_saturated_spring_that_is_driven(begin):
    def rates(t, q):
        return [q[1], -min(1, max(-1, q[0])) + math.sin(3 * q[2]) / 2, 1.0]

    found = run(spring(), begin, (0, 20))
    oracle = integrate.solve_ivp(rates, (0, 20), begin, "DOP853", rtol=1e-11, atol=1e-13,
                                 max_step=2e-2)  # fmt: skip
    np.testing.assert_allclose(found.y_stop, oracle.y[:, -1], atol=1e-6)
    back = run(spring(), found.y_stop, (20, 0))
    np.testing.assert_allclose(back.y_stop, begin, atol=1e-9)


def test_events_and_dense_output_beside_switches():
    """Turning points of the oscillator with friction are events where it switches."""
    system, times = friction(), np.linspace(0, 9, 91)
    found = run(system, [10.0, 0.0], (0, 9), [0.3], events=[v, Event(x, 1)], dense_output=True)
    np.testing.assert_allclose(found.t_events[0], np.pi * np.arange(3), atol=1e-12)
    half, sign = np.floor(times / np.pi), (-1.0) ** np.floor(times / np.pi)
    middle = 0.3 * sign
    exact = middle + (10 - 0.3 - 0.6 * half) * np.cos(times)
    np.testing.assert_allclose(found.sol(times)[0], exact, atol=1e-11)
    assert (np.diff(found.t) > 0).all()


# --- lanes, rest, text ----------------------------------------------------------------------------


@pytest.mark.sparse
@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
@pytest.mark.parametrize("system", [friction, spring], ids=["friction", "spring"])
def test_lanes_do_what_one_trajectory_does(system, rtol):
    built, rng = system(), np.random.default_rng(9)
    n = len(built.layout.states)
    start, p = rng.uniform(4, 9, (n, 21)), rng.uniform(0.1, 0.3, (len(built.layout.parameters), 21))
    found = codegen.ensemble(built, start, (0, 6), p, "taylor", rtol, t_eval=[2.0, 6.0])
    assert "lanes" in found.method
    assert found.success
    for j in range(21):
        one = run(built, start[:, j], (0, 6), p[:, j], t_eval=[2.0, 6.0])
        np.testing.assert_allclose(found.y[:, :, j], one.y, atol=300 * rtol)
    alone = codegen.ensemble(built, start[:, 4:5], (0, 6), p[:, 4:5], "taylor", rtol)
    np.testing.assert_array_equal(alone.y_stop[:, 0], found.y_stop[:, 4])


def test_where_both_sides_lead_back_the_run_ends_with_a_reason():
    """Coulomb friction without a model of rest; where it cannot hold the body, this goes on."""
    system = compiled("sliding", {x: -sp.sign(x) + mu})
    for start, rest in ((1.0, 2.0), (0.0, 0.0)):
        found = codegen.simulate(system, [start], (0, 5), [0.5], "taylor")
        assert found.status == -1
        assert found.t_stop == pytest.approx(rest, abs=1e-12)
        assert found.steps < 100
        assert "lead back" in found.message
    starts, holds = [[1.0, 0.25, -3.0, 0.0] * 2], [[0.5] * 4 + [-1.5] * 4]
    many = codegen.ensemble(system, starts, (0, 5), holds, "taylor")
    assert many.counts == {"step": 4, "end": 4}
    np.testing.assert_allclose(many.t_stop, [2, 0.5, 2, 0, 5, 5, 5, 5], atol=1e-12)
    np.testing.assert_allclose(many.y_stop[0, 4:], [-2.3, -2.45, -5.5, -2.5], atol=1e-12)


def test_switching_functions_are_those_that_change_with_time():
    def count(rate):
        system = codegen.compile(System.from_rates("s", {x: rate}), "numpy")
        return len(prepare(system.program, RATES).switches)

    assert count(sp.Abs(mu) * x + sp.sign(mu)) == 0
    assert count(sp.Abs(x) + sp.sign(x)) == 1
    assert count(sp.Max(x, mu) + sp.Min(x, 2 * mu)) == 2
    assert count(sp.sin(x)) == 0


@pytest.mark.parametrize("compiler", [n for n in ("gcc", "clang") if shutil.which(n)])
def test_generated_texts_have_no_warnings(compiler, tmp_path):
    built, order = friction(), taylor.order_of(1e-4)
    prepared = prepare(built.program, RATES, built.layout)
    texts = {
        "one": taylor.single_text(built.program, built.layout, order),
        "lanes": taylor_lanes.single_text(prepared, built.program, built.layout, order),
    }
    for name, text in texts.items():
        file = tmp_path / f"{name}.c"
        file.write_text(text, encoding="ascii")
        flags = ["-std=c99", "-O0", "-Wall", "-Wextra", "-Werror", "-Wno-psabi", "-fsyntax-only"]
        done = subprocess.run(
            [compiler, *flags, str(file)], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
