"""Method taylor on rates that are sharp but smooth, against SciPy with steps that see everything."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import codegen
from codegen.derivatives.taylor import prepare
from codegen.ir.program import RATES
from codegen.loops import taylor, taylor_lanes
from codegen.native import native
from codegen.precision.extended import Values, integrate
from codegen.watch.trust import limits
from eom.quantities import TIME
from eom.system import System

pytestmark = [
    pytest.mark.shipped_flags("slow"),
    pytest.mark.skipif(not native.compiler(), reason="runs C"),
]
t, (x, v, w, p, q) = TIME, sp.symbols("x v w p q", real=True)
R = sp.Rational


def pulse(f, at, width):
    return f((t - at) / width)


def gauss(s):
    return sp.exp(-(s**2))


def kick(at):
    return 20 * pulse(gauss, at, R(1, 50))


def window(at):
    return (sp.tanh(10 * (t - at)) - sp.tanh(10 * (t - at - 1))) / 2


def satellite(torque):
    """Euler's equations of the moments (10, 15, 20)."""
    return {x: -v * w / 2 + torque / 10, v: 2 * w * x / 3, w: -x * v / 4}


def arms(friction):
    """Two equal arms without gravity; springs, and friction in the second joint."""
    c, s = sp.cos(q), sp.sin(q)
    torque = -2 * friction - q
    m, n = 3 + 2 * c, 1 + c
    f, g = s * w * (2 * v + w) - p, -s * v**2 + torque
    det = m - n * n
    return {p: v, q: w, v: (f - n * g) / det, w: (m * g - n * f) / det}


CASES = {
    "friction-100": ({x: v, v: -x - sp.tanh(100 * v) / 2}, (3, 0), (0, 6), 0.01),
    "friction-30": ({x: v, v: -x - sp.tanh(30 * v) / 2}, (3, 0), (0, 6), 0.02),
    "floor": ({x: v, v: 100 * sp.log(1 + sp.exp(-100 * x)) - 10}, (5, 0), (0, 3), 0.008),
    "floor-log1p": (
        {x: v, v: 50 * sp.codegen.cfunctions.log1p(sp.exp(-40 * x)) - 10}, (5, 0), (0, 3), 0.008,
    ),
    "kick": ({x: v, v: -sp.sin(x) + kick(2)}, (1, 0), (0, 5), 0.008),
    "kicks": ({x: v, v: -x + sum(kick(k) for k in (1, 2, 3, 5))}, (1, 0), (0, 6), 0.008),
    "kick-late": ({x: v, v: -x / 100 + kick(1000)}, (1, 0), (996, 1004), 0.008),
    "kick-backwards": ({x: v, v: -sp.sin(x) + kick(2)}, (1, 0), (4, 0), 0.008),
    "satellite": (satellite(window(20)), (0, 0.01, 1), (0, 30), 0.05),
    "satellite-gauss": (satellite(pulse(gauss, 20, R(1, 2))), (0.1, 0.2, 0.5), (0, 40), 0.05),
    "window-50": (
        {x: v, v: -sp.sin(x) + sp.tanh(50 * (t - 2)) / 2 - sp.tanh(50 * (t - 3)) / 2},
        (1, 0), (0, 5), 0.015,
    ),
    "erf": ({x: v, v: -x + sp.erf(40 * (t - 3)) - sp.erf(40 * (t - R(7, 2)))}, (1, 0), (0, 6), 0.015),
    "fermi": ({x: v, v: -x + 1 / (1 + sp.exp(40 * (t - 3)))}, (1, 0), (0, 6), 0.015),
    "sech": ({x: v, v: -x + 9 / sp.cosh(60 * (t - 3)) ** 2}, (1, 0), (0, 6), 0.008),
    "root-of-tanh": ({x: v, v: -x + sp.sqrt(R(101, 100) + sp.tanh(50 * (t - 3)))}, (1, 0), (0, 6), 0.008),
    "lorentz": ({x: v, v: -x + 5 / (1 + (100 * (t - 3)) ** 2)}, (1, 0), (0, 6), 0.008),
    "atan": ({x: v, v: -x - sp.atan(100 * v)}, (3, 0), (0, 6), 0.01),
    "wall": ({x: v, v: x**-12 - 1}, (3, -4), (0, 3), 0.008),
    "morse": ({x: v, v: -20 * (1 - sp.exp(10 - 10 * x)) * sp.exp(10 - 10 * x)}, (3, -8), (0, 1), 0.005),
    "exponential": ({x: v, v: sp.exp(-30 * x) - 1}, (3, -9), (0, 2), 0.005),
    "power-61": ({x: v, v: -((x / 5) ** 61)}, (0, 6), (0, 2), 0.01),
    "power-201": ({x: v, v: -x - (x / 2) ** 201}, (0, 3), (0, 3), 0.003),
    "power-of-cosine": ({x: v, v: -x + 30 * sp.cos(t) ** 400}, (1, 0), (1, 5), 0.015),
    "arms": (arms(sp.tanh(30 * w)), (0.5, 1, 0, 0), (0, 5), 0.01),
}  # fmt: skip
"""Rates, start, span, and the longest step of the reference."""


def system_of(name):
    return System.from_rates("sharp_" + name.replace("-", "_"), CASES[name][0])


def start_of(name):
    return {s.name: float(a) for s, a in zip(CASES[name][0], CASES[name][1], strict=True)}


def reference(name):
    """The end, and the largest size of each state, by DOP853 of SciPy."""
    rates, start, span, longest = CASES[name]
    f = sp.lambdify((t, tuple(rates)), list(rates.values()), ["scipy", "numpy"])
    with np.errstate(all="ignore"):
        found = solve_ivp(f, span, np.array(start, float), "DOP853", rtol=1e-12, atol=1e-14,
                          max_step=longest)  # fmt: skip
    assert found.status == 0
    return found.y[:, -1], np.abs(found.y).max(axis=1)


def run(name, rtol=1e-9, **options):
    span = CASES[name][2]
    return codegen.simulate(system_of(name), start_of(name), span, None, "taylor", rtol, **options)


@pytest.mark.sparse(2)
@pytest.mark.parametrize("name", CASES)
def test_errors_are_near_the_tolerance(name):
    end, size = reference(name)
    for rtol, largest in ((1e-6, 1e-5), (1e-11, 1e-9)):
        found = run(name, rtol)
        assert found.success, found.message
        assert np.max(np.abs(found.y[:, -1] - end) / size) <= largest


@pytest.mark.sparse(1)
@pytest.mark.parametrize("rtol", [0.1, 1e-3, 2.0**-52])
def test_the_coarsest_and_the_finest_tolerance(rtol):
    end, size = reference("kick")
    found = run("kick", rtol)
    assert found.success, found.message
    assert np.max(np.abs(found.y[:, -1] - end) / size) <= 10 * rtol + 1e-10


def test_an_event_on_a_pulse_that_is_over_within_a_plain_step():
    event = codegen.Event(v - R(1, 2), name="fast")
    found = run("kick-late", events=[event]).events["fast"].t
    seen = run("kick-late", events=[event], max_step=0.01).events["fast"].t
    assert len(found) == len(seen) > 0
    assert np.allclose(found, seen, rtol=0, atol=1e-7)


@pytest.mark.slow
def test_lanes_take_the_same_care():
    """Each trajectory beside the one that is integrated alone; the kick comes at a time of its own."""
    at = sp.Symbol("at", real=True)
    system = System.from_rates("kicked", {x: v, v: -sp.sin(x) - sp.tanh(60 * v) / 9 + kick(at)})
    compiled = codegen.compile(system, "c")
    times = np.linspace(1, 4, 19)
    start = np.tile([[1.0], [0.0]], 19)
    found = codegen.ensemble(compiled, start, (0, 5), {"at": times}, "taylor", 1e-10)
    assert found.counts == {"end": 19}
    for k in (0, 7, 18):
        alone = codegen.simulate(compiled, start[:, k], (0, 5), {"at": times[k]}, "taylor", 1e-10)
        assert np.allclose(found.columns["y_stop"][:, k], alone.y[:, -1], rtol=0, atol=1e-7)


def test_the_reference_with_many_digits_sees_pulses():
    compiled = codegen.compile(system_of("kick"), "numpy")
    values = Values([1.0, 0.0], [], [])
    found = integrate(compiled.program, compiled.layout, values, (0.0, 5.0), 20, 1000)
    assert np.allclose([float(a) for a in found.end], reference("kick")[0], rtol=0, atol=1e-9)


@pytest.mark.sparse(1)
@pytest.mark.parametrize("rtol", [1e-6, 1e-9, 1e-12])
def test_pulses_after_a_long_quiet_time(rtol):
    """Their integrals, from 1000 s before to 10 s behind them and back."""
    s = t - 1000
    pulses = {x: gauss(50 * s), v: 1 / (1 + (100 * s) ** 2), w: sp.tanh(50 * (s + 1)) - sp.tanh(50 * s),
              p: sp.exp(-((20 * s) ** 8)), q: sp.exp(-40 * s**2) * sp.cos(80 * s)}  # fmt: skip
    system = codegen.compile(System.from_rates("quiet", pulses), "c")
    root = math.sqrt(math.pi)
    peak = 2 * math.gamma(9 / 8) / 20
    lorentz = (math.atan(1000) + math.atan(100000)) / 100
    whole = [root / 50, lorentz, 2.0, peak, root / math.sqrt(40) * math.exp(-40)]
    for span in ((0, 1010), (1010, 0)):
        found = codegen.simulate(system, [0.0] * 5, span, None, "taylor", rtol)
        assert found.success, found.message
        sign = 1 if span[1] else -1
        assert np.allclose(found.y[:, -1], sign * np.array(whole), rtol=0, atol=10 * rtol)


def test_slopes_of_parameters():
    """Arguments that are linear in time with slopes and shifts that are parameters."""
    k, at = sp.symbols("k at", real=True)
    rise = (sp.tanh(k * (t - at) / 3) - sp.tanh(-2 * (at - t))) * 5
    system = codegen.compile(System.from_rates("slopes", {x: rise}), "c")
    for slope, middle in ((150.0, 40.0), (-30.0, 7.0)):
        values = {"k": slope, "at": middle}
        found = codegen.simulate(system, [0.0], (0, 60), values, "taylor", 1e-9)
        ends = [
            math.copysign(1, slope) * (abs(s - middle) - 3 * math.log(2) / abs(slope))
            for s in (0, 60)
        ]
        slow = [abs(s - middle) - math.log(2) / 2 for s in (0, 60)]
        right = 5 * (ends[1] - ends[0] - slow[1] + slow[0])
        assert abs(found.y[0, -1] - right) <= 1e-6


def test_what_overflows_before_its_pulse_is_reported():
    """cosh is infinite long before 1000: the series are not numbers, which ends the run."""
    system = System.from_rates("overflow", {x: 1 / sp.cosh(50 * (t - 1000)) ** 2})
    found = codegen.simulate(system, [0.0], (0, 1010), None, "taylor", 1e-9)
    assert not found.success or abs(found.y[0, -1] - 1 / 25) <= 1e-8


# --- branch points and kinks ------------------------------------------------------------------------


def test_a_root_is_not_followed_past_its_branch_point():
    """The solution is sin t up to pi/2, and 1 from there on."""
    system = System.from_rates("branch_point", {x: sp.sqrt(1 - x**2)})
    for rtol in (1e-6, 1e-9, 1e-12):
        found = codegen.simulate(system, [0.0], (0, 3), None, "taylor", rtol)
        right = math.sin(min(found.t[-1], math.pi / 2))
        assert abs(found.y[0, -1] - right) <= 1e-5
        assert not found.success or found.t[-1] == 3


def test_a_kink_is_passed():
    """A throw with the drag v |v|, written as a root: up to the top and down."""
    system = System.from_rates("throw", {x: v, v: -10 - v * sp.sqrt(v**2)})
    rise = math.atan(1 / math.sqrt(10)) / math.sqrt(10)
    found = codegen.simulate(system, [0.0, 1.0], (0, 1), None, "taylor", 1e-10)
    fall = -math.sqrt(10) * math.tanh(math.sqrt(10) * (1 - rise))
    assert found.success, found.message
    assert abs(found.y[1, -1] - fall) <= 1e-8


# --- what it costs ----------------------------------------------------------------------------------


def prepared(rates):
    compiled = codegen.compile(System.from_rates("costs", rates), "c")
    return compiled, prepare(compiled.program, RATES, compiled.layout)


def test_polynomials_have_no_limits():
    compiled, found = prepared({x: v * x**5 - t**3, v: 3 - x / 2})
    assert limits(found, 12) == ()
    text = taylor.single_text(compiled.program, compiled.layout, 12)
    text += taylor_lanes.single_text(found, compiled.program, compiled.layout, 12)
    assert "within_reach" not in text
    assert not re.search(r"\bheld;|->held\b", text)


def test_products_of_a_degree_beyond_the_order_are_powers():
    _, found = prepared({x: v, v: -(x**20)})
    assert limits(found, 21) == ()
    assert [(m.op, m.exponent) for m in limits(found, 18)] == [("pow", 20)]


SMOOTH = {
    "pendulum": ({x: v, v: -sp.sin(x)}, (1, 0)),
    "kepler": ({x: v, p: q, v: -x * (x**2 + p**2) ** R(-3, 2), q: -p * (x**2 + p**2) ** R(-3, 2)},
               (1, 0, 0, 1.1)),
    "forced": ({x: v, v: -x + sp.sin(t) ** 2}, (1, 0)),
    "arms": (arms(w / 20), (0.5, 1, 0, 0)),
    "barometric": ({x: v, v: -R(1, 10) * v * sp.exp(-x / 8) - R(1, 10)}, (9, 0)),
}  # fmt: skip


@pytest.mark.sparse(2)
@pytest.mark.parametrize("name", SMOOTH)
def test_smooth_motions_take_the_same_steps(name, monkeypatch):
    """Beside the same code without limits, at two tolerances."""
    rates, start = SMOOTH[name]
    system = System.from_rates("smooth_" + name, rates)

    def steps(rtol):
        compiled = codegen.compile(system, "c")
        found = codegen.simulate(compiled, list(map(float, start)), (0, 10), None, "taylor", rtol)
        return found.steps

    guarded = [steps(rtol) for rtol in (1e-6, 1e-12)]
    monkeypatch.setattr("codegen.loops.jets.limits", lambda prepared, order: ())
    plain = [steps(rtol) for rtol in (1e-6, 1e-12)]
    assert all(a <= 1.1 * b + 1 for a, b in zip(guarded, plain, strict=True)), (guarded, plain)
