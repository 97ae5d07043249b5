"""Runs that start late: as many digits as from zero, by every method, or a refusal."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from codegen import compile as compile_system
from codegen import ensemble, simulate
from codegen.compiling.events import Event
from codegen.integrate import fleet, sundials
from codegen.integrate.methods import METHODS, OF_ATTITUDE
from codegen.native import native
from eom.errors import InputError
from eom.quantities import TIME
from eom.rotations import quaternion_product
from eom.system import BodyAttitude, System

pytestmark = [
    pytest.mark.sparse,
    pytest.mark.skipif(not native.compiler(), reason="tests C itself"),
]

t = TIME
x, v, k, a, b, c = sp.symbols("x v k a b c", real=True)
STARTS = (1.7e9, -1e12, 1e16, 1e17, -1e17)
WITHOUT = OF_ATTITUDE if sundials.available() else (*OF_ATTITUDE, *METHODS[-2:])
PLAIN = tuple(m for m in METHODS if m not in WITHOUT)
LENGTH = 16.0  # what doubles at 1e17 are apart


def system(name, force):
    return System.from_rates(name, {x: v, v: -k * x + force})


OSCILLATOR = compile_system(system("oscillator", 0), "c" if native.compiler() else "numpy")
ROW = {a: 3.3, b: 0.7, c: 0.3}
FORCED = {
    "phase": sp.sin(a * t + b) + sp.cos(t / 3) * sp.tan(sp.sin(t)),
    "tangent": sp.exp(-(sp.tan(c * t + b) ** 2)),
    "saw": sp.Mod(t, 3) / 4 + (t * c - sp.floor(t * c)),
    "two of time": sp.sin((a * t + b) / 2 - (t - c) / 7 + x),
    "pulse": 20 * sp.exp(-(((t - b) * 5) ** 2)),
    "window": (sp.tanh(10 * (t - b)) - sp.tanh(10 * (t - b - 1))) / 2,
    "pieces": sp.Piecewise((1, (t > b + 2) & (t < b + 3)), (0, True)),
}
"""Forces; `b` is one second after the start in those about a time."""
NEAR = ("pulse", "window", "pieces")


def reference(force, values, t0, grid):
    """Integrate over the time since ``t0``, which the force has with 40 digits: no `codegen` in it."""
    shifted = sp.lambdify((t, x, a, b, c), force, "mpmath")
    with mpmath.workdps(40):
        numbers = [mpmath.mpf(n) for n in values.values()]

        def rates(tau, y):
            with mpmath.workdps(40):
                now = mpmath.mpf(t0) + mpmath.mpf(float(tau))
                return [y[1], -y[0] + float(shifted(now, mpmath.mpf(float(y[0])), *numbers))]

        options = {"rtol": 1e-11, "atol": 1e-12, "max_step": 0.3, "t_eval": grid}
        return solve_ivp(rates, (0, grid[-1]), [1, 0], "DOP853", **options).y


@pytest.mark.sparse(4)
@pytest.mark.parametrize("method", PLAIN)
def test_an_autonomous_system_is_the_same_at_any_time(method):
    early = simulate(OSCILLATOR, [1, 0], (0, LENGTH), [1], method, 1e-6)
    for t0 in STARTS:
        late = simulate(OSCILLATOR, [1, 0], (t0, t0 + LENGTH), [1], method, 1e-6)
        assert late.status == 0
        assert late.t_stop == t0 + LENGTH
        assert (late.t[0], late.t[-1]) == (t0, t0 + LENGTH)
        assert np.array_equal(late.y, early.y)
        assert ("taken for 16 s" in late.notice) == (abs(t0) > 1e13)


@pytest.mark.parametrize("method", PLAIN)
def test_backwards_and_at_times_that_are_neighbours(method):
    t0 = 1.7e9
    grid = t0 - np.array([0.0, 2.0**-22, 2.0**-21, 0.1, 3.0])  # doubles there are 2^-22 apart
    run = simulate(
        OSCILLATOR, [1, 0], (t0, t0 - 3), [1], method, 1e-6, t_eval=grid, dense_output=True
    )
    assert np.array_equal(run.t, grid)
    expected = np.cos(grid - t0), -np.sin(grid - t0)
    assert np.abs(run.y - expected).max() < 1e-3
    assert np.abs(run.sol(grid) - expected).max() < 1e-3
    assert run.sol.t_min == t0 - 3
    assert run.y[1, 1:3] == pytest.approx([2.0**-22, 2.0**-21], rel=1e-3)


@pytest.mark.sparse(only=("saw", "tangent", "pieces"))
@pytest.mark.parametrize("force", FORCED)
def test_forces_of_time_keep_their_digits(force):
    compiled, grid = (
        compile_system(system(force.replace(" ", "_"), FORCED[force]), "c"),
        np.arange(1.0, 5),
    )
    for t0 in (1.7e9, -1e12):
        values = ROW | ({b: t0 + 1} if force in NEAR else {})
        expected = reference(FORCED[force], values, t0, grid)
        p = {str(s): n for s, n in values.items() if str(s) in compiled.system.parameter_names}
        for method in ("auto", "DOP853", "scipy:LSODA"):
            run = simulate(
                compiled, [1, 0], (t0, t0 + 4), {"k": 1} | p, method, 1e-11, t_eval=t0 + grid
            )
            assert run.status == 0
            assert np.abs(run.y - expected).max() < 2e-9, (t0, method)
            assert not run.notice


@pytest.mark.slow
def test_every_method_reads_phases():
    forced = compile_system(system("forced", sp.sin(a * t)), "c")
    with mpmath.workdps(40):
        phase = float(mpmath.mpf(3.3) * mpmath.mpf(1.7e9) % (2 * mpmath.pi))
    shifted = compile_system(system("shifted", sp.sin(a * t + b)), "c")
    for method in PLAIN:
        late = simulate(forced, [1, 0], (1.7e9, 1.7e9 + 5), {"k": 1, "a": 3.3}, method, 1e-6)
        early = simulate(shifted, [1, 0], (0, 5), {"k": 1, "a": 3.3, "b": phase}, method, 1e-6)
        assert late.status == early.status == 0
        assert np.abs(late.y_stop - early.y_stop).max() < 2e-4, method


@pytest.mark.sparse(only=("auto",))
@pytest.mark.parametrize("method", ["rkmk", "splitting", "auto"])
def test_bodies_turn_as_they_do_at_zero(method):
    w, q = sp.symbols("w1:4", real=True), sp.symbols("q0:4", real=True)
    torque = sp.Matrix([0, 0, sp.cos(3 * t) / 10])
    I = sp.diag(2, 3, 4)
    slope = I.inv() * (torque - sp.Matrix(w).cross(I * sp.Matrix(w)))
    turn = quaternion_product(q, (0, *w))
    rates = dict(zip(w, slope, strict=True)) | {q[i]: turn[i] / 2 for i in range(4)}
    stated = BodyAttitude(w, "quaternion", q, inertia=I, torque=torque)
    body = compile_system(System.from_rates("body", rates, attitudes=[stated]), "c")
    start = [0.1, 0.2, 0.3, 1, 0, 0, 0]
    t0 = 2 * np.pi / 3 * 2**31  # a start in a round phase, but for its rounding
    phase = float(3 * sp.Rational(t0) - 2 * sp.pi.evalf(60) * 2**31)
    early = simulate(body, start, (phase / 3, phase / 3 + 4), (), method)
    late = simulate(body, start, (t0, t0 + 4), (), method)
    assert late.status == early.status == 0
    assert np.abs(late.y_stop - early.y_stop).max() < 1e-7
    assert np.abs(late.y_stop - early.y_stop).max() < 1e-3 * np.abs(late.y_stop - start).max()


def test_events_are_found_in_time_since_the_start():
    for t0, span in ((1.7e9, 10.0), (-1e12, 10.0)):
        events = [Event(x, name="zero"), Event(t - t0 - 4.25, terminal=True, name="alarm")]
        run = simulate(OSCILLATOR, [1, 0], (t0, t0 + span), [1], events=events)
        assert (run.status, run.t_stop) == (2, t0 + 4.25)
        assert f"t = {t0 + 4.25!r} s" in run.message
        assert run.events["zero"].y[1] == pytest.approx([-1], abs=1e-9)
        assert run.y_stop == pytest.approx([np.cos(4.25), -np.sin(4.25)], abs=1e-8)


def test_an_epoch_gives_times_digits_of_their_own():
    forced = compile_system(system("forced", sp.sin(a * t)), "c")
    values = {"k": 1, "a": 3.3}
    with mpmath.workdps(40):
        phase = float(mpmath.mpf(3.3) * mpmath.mpf(1e17) % (2 * mpmath.pi))
    shifted = compile_system(system("shifted", sp.sin(a * t + b)), "c")
    run = simulate(forced, [1, 0], (0, 10), values, t_eval=[0.1, 10], epoch=1e17)
    early = simulate(shifted, [1, 0], (0, 10), values | {"b": phase}, t_eval=[0.1, 10])
    assert run.t.tolist() == [0.1, 10.0]
    assert np.abs(run.y - early.y).max() < 1e-8
    both = simulate(forced, [1, 0], (1e6, 1e6 + 1), values, epoch=1.7e9)
    whole = simulate(forced, [1, 0], (1.7e9 + 1e6, 1.7e9 + 1e6 + 1), values)
    assert np.array_equal(both.y_stop, whole.y_stop)
    with pytest.raises(InputError, match="epoch is not finite"):
        simulate(forced, [1, 0], (0, 1), values, epoch=float("nan"))


@pytest.mark.slow
def test_time_that_is_not_resolved_is_refused_or_reported():
    chirp = compile_system(system("chirp", sp.sin(t**2)), "c")
    smooth = compile_system(system("smooth", sp.log(t) / 100 + sp.exp(-t / 10**9)), "c")
    for method in PLAIN:
        with pytest.raises(InputError, match="starts so late"):
            simulate(chirp, [1, 0], (1e17, 1e17 + 16), [1], method)
    assert "rounded to 2.4e-07 s" in simulate(chirp, [1, 0], (1.7e9, 1.7e9 + 1e-3), [1]).notice
    assert not simulate(smooth, [1, 0], (1.7e9, 1.7e9 + 10), [1]).notice


def test_inputs_that_are_functions_get_the_time_of_the_system():
    u = sp.Symbol("u", real=True)
    driven = System.from_rates("driven", {x: v, v: -x + u}, inputs=[u])
    seen = []

    def force(now):
        seen.append(now)
        return now - 1.7e9

    run = simulate(
        driven, [0, 0], (1.7e9, 1.7e9 + 3), method="scipy:DOP853", inputs={"u": force}, rtol=1e-8
    )
    assert min(seen) == 1.7e9
    assert run.y_stop[0] == pytest.approx(3 - np.sin(3), abs=1e-4)
    assert "have it rounded" in run.notice
    with pytest.raises(InputError, match="starts so late"):
        simulate(driven, [0, 0], (1e17, 1e17 + 16), inputs={"u": force})


@pytest.mark.sparse(1)
@pytest.mark.parametrize("method", ["taylor", "DOP853"])
def test_ensembles_keep_their_digits(method):
    forced = compile_system(system("forced", sp.sin(a * t)), "c")
    speeds, t0 = np.array([1.1, 3.3, 1.1, 0.7]), 1.7e9
    many = ensemble(
        forced, [1, 0], (t0, t0 + 5), {"k": 1, "a": speeds}, method, t_eval=[t0 + 2, t0 + 5]
    )
    assert many.t.tolist() == [t0 + 2, t0 + 5]
    assert many.t_stop.tolist() == [t0 + 5] * 4
    for k, speed in enumerate(speeds):
        one = simulate(
            forced, [1, 0], (t0, t0 + 5), {"k": 1, "a": speed}, "taylor", t_eval=[t0 + 2, t0 + 5]
        )
        assert np.abs(many.y[:, :, k] - one.y).max() < 1e-8
    plain = ensemble(OSCILLATOR, {"x": [1.0, 2.0], "v": 0}, (1e17, 1e17 + 16), [1], method)
    assert plain.y_stop[0] == pytest.approx(np.cos(16) * np.array([1, 2]), abs=1e-7)
    assert "16 s apart" in plain.notice


def test_written_loops_go_to_the_end_that_doubles_say():
    """The loops themselves, over absolute time: they end where both parts of the time are there."""
    for method in ("taylor", "DOP853"):
        shared = fleet.Shared(
            (1e17, 1e17 + 16),
            np.empty(0),
            1e-9,
            np.full(2, 1e-12),
            1e-6,
            np.array([1e17 + 16]),
            np.inf,
            10**6,
        )
        runs = fleet.build(OSCILLATOR, method, 1e-9).run(
            shared, np.array([[1.0], [0.0]]), np.array([1.0])
        )
        assert runs.y_stop[0, 0] == pytest.approx(np.cos(16), abs=1e-7), method
