"""Every method keeps its tolerance on bodies where it is hard, or says that it does not."""

from functools import cache

import numpy as np
import pytest
import sympy as sp

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.integrate import sundials
from codegen.integrate.methods import METHODS, OF_ATTITUDE
from codegen.native import native
from eom.mechanics.rigidbody import free_rigid_body, heavy_top
from eom.quantities import TIME
from eom.rotations import quaternion_product
from eom.system import BodyAttitude, System

pytestmark = [
    pytest.mark.shipped_flags("slow"),
    pytest.mark.sparse,
    pytest.mark.skipif(not native.compiler(), reason="compares methods in C"),
]
C, S = np.cos(0.3), np.sin(0.3)
SYSTEMS = {
    "top": heavy_top,
    "symmetric top": lambda: eom.load_scene("heavy-top").derive(),
    "free": lambda: free_rigid_body("quaternion"),
}
SPIN = {"I1": 1.0, "I3": 0.3, "m": 1.0, "g": 10.0, "r3": 0.2, "omega_3": 20.0}
CASES = {
    "falls from near upright": (
        "top", (1.0, 1.0, 0.8, 1.0, 10.0, 0.2), (0, 0, 1e-3, np.cos(5e-4), np.sin(5e-4), 0, 0), 8),
    "spins fast": ("top", (1.0, 1.25, 0.3, 1.0, 10.0, 0.2), (0, 0, 20, C, S, 0, 0), 2),
    "spins fast, its rate a parameter": ("symmetric top", SPIN, (0, 0, C, S, 0, 0), 2),
    "leaves the separatrix": ("free", (1.0, 2.0, 3.0), (1e-6, 1, 1e-6, C, S, 0, 0), 15),
}  # fmt: skip
"""System, parameters, start and end."""
TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12, 1e-14)
COARSE = {"scipy:RK23": 1e-3, "scipy:BDF": 1e-6, "sundials:BDF": 1e-6, "scipy:Radau": 1e-6,
          "scipy:RK45": 1e-6, "DP5": 1e-9, "Tsit5": 1e-9}  # fmt: skip
"""The finest tolerance that is tried of methods of low order, which take very many steps."""
SMALL_BESIDE_LARGE = ("falls from near upright", "leaves the separatrix")
"""Where body rates stay so small that rounding of the momentum shows in them at the finest tolerance."""
PLACES = 5


@cache
def compiled_of(name):
    return compile_system(SYSTEMS[name](), "c")


@cache
def known(case):
    """The end, how a change of the state on the way grows up to it at most, and the largest state."""
    name, p, start, end = CASES[case]
    compiled, times = compiled_of(name), np.linspace(0, end, PLACES)
    exact = simulate(compiled, start, (0, end), p, "taylor", 2.0**-52, t_eval=times)
    size, growth = np.abs(exact.y).max(), 1.0
    for t, x in zip(times[:-1], exact.y.T, strict=False):
        for i in range(len(start)):
            moved = x + 1e-7 * size * (np.arange(len(x)) == i)
            other = simulate(compiled, moved, (t, end), p, "taylor", 1e-13).y_stop
            growth = max(growth, np.abs(other - exact.y_stop).max() / (1e-7 * size))
    return exact.y_stop, growth, size


@pytest.mark.sparse(4)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("case", CASES)
def test_an_error_is_that_of_the_tolerance_or_reported(case, method):
    """Errors are at most 1000 times the tolerance, times what the problem makes of them."""
    if method.startswith("sundials") and not sundials.available():
        pytest.skip("no scikit-sundae")
    name, p, start, end = CASES[case]
    exact, growth, size = known(case)
    for rtol in TOLERANCES:
        if rtol < COARSE.get(method, 0.0):
            continue
        run = simulate(compiled_of(name), start, (0, end), p, method, rtol, max_steps=200_000)
        error = np.abs(run.y_stop - exact).max() / size
        assert run.status == 0, (rtol, run.message)
        assert run.notice or error <= 1000 * rtol * growth, (rtol, error)
        coarser = method.startswith("scipy") and rtol < 2e-14
        hidden = method == "rkmk" and rtol < 2e-14 and case in SMALL_BESIDE_LARGE
        assert bool(run.notice) == (coarser or hidden)


def test_scipy_says_where_it_takes_a_coarser_tolerance():
    name, p, start, _ = CASES["spins fast"]
    for method in ("scipy:DOP853", "scipy:LSODA"):
        fine = simulate(compiled_of(name), start, (0, 0.1), p, method, 1e-14)
        assert "no rtol below 2.2e-14" in fine.notice
        assert not simulate(compiled_of(name), start, (0, 0.1), p, method, 1e-13).notice


X, Y = sp.symbols("x y", real=True)
Q, W = sp.symbols("q0:4", real=True), sp.symbols("w1:4", real=True)
MOMENTS = (1, sp.Rational(7, 5), 2)


def body_with(torque):
    """A rigid body of these moments under a torque about its first axis."""
    momentum = [J * rate for J, rate in zip(MOMENTS, W, strict=True)]
    turned = sp.Matrix(W).cross(sp.Matrix(momentum))
    rates = {w: ((torque if k == 0 else 0) - turned[k]) / MOMENTS[k] for k, w in enumerate(W)}
    turn = quaternion_product(Q, (0, *W))
    stated = BodyAttitude(W, "quaternion", Q, inertia=sp.diag(*MOMENTS), torque=(torque, 0, 0))
    rates |= {q: turn[k] / 2 for k, q in enumerate(Q)}
    return System.from_rates("body", rates, attitudes=[stated])


OUT_OF_DOMAIN = {
    "state": System.from_rates("state", {X: sp.Integer(-1), Y: sp.sqrt(X)}),
    "time": System.from_rates("time", {X: sp.log(1 - TIME), Y: X}),
    "body": body_with(sp.sqrt(1 - TIME)),
}
"""Rates that end at t = 1: there is no number for them beyond."""


@pytest.mark.sparse(6)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", OUT_OF_DOMAIN)
def test_no_run_goes_on_beyond_the_domain_of_its_rates(name, method):
    if method.startswith("sundials") and not sundials.available():
        pytest.skip("no scikit-sundae")
    if name != "body" and method in OF_ATTITUDE:
        pytest.skip("no attitude")
    compiled = beyond(name)
    start = (1.0, 0.2) if name != "body" else (0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0)
    for rtol in (1e-3, 1e-8):
        run = simulate(compiled, start, (0, 3), None, method, rtol, max_steps=20_000)
        assert run.status == -1
        assert run.t_stop <= 1 + 1e-6
        assert np.isfinite(run.y).all()


@cache
def beyond(name):
    return compile_system(OUT_OF_DOMAIN[name], "c")
