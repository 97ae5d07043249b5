"""Ensembles: each trajectory as `simulate` has it, the same bits in any division, no failure lost."""

import ctypes
import math
import shutil
import subprocess
import time

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ellipj

import codegen
import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.derivatives.taylor import prepare
from codegen.integrate import fleet
from codegen.ir.names import identifier
from codegen.ir.program import RATES
from codegen.loops import taylor, taylor_lanes
from codegen.native import native
from eom.errors import AssumptionError, InputError
from eom.quantities import TIME
from eom.system import System
from tests.clock import within

pytestmark = pytest.mark.sparse

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="runs C")
y1, y2, y3, k, u = sp.symbols("y1 y2 y3 k u", real=True)
RIGID = System.from_rates("rigid", {y1: y2 * y3, y2: -y1 * y3, y3: -sp.Rational(51, 100) * y1 * y2})
PENDULUM = System.from_rates("pendulum", {y1: y2, y2: -k * sp.sin(y1)})
GROWING = System.from_rates("growing", {y1: y1**2})
KINKED = System.from_rates("kinked", {y1: sp.Abs(y2), y2: -y1 - sp.sin(TIME) * k})
LINEAR = eom.free_rigid_body("3-2-1")
"""With equal moments omega is constant; omega_2 alone turns theta at a constant rate."""
RNG = np.random.default_rng(5)
FIRST_DRAWS = RNG.bit_generator.state


@pytest.fixture(autouse=True)
def _draws_from_the_start():
    """Let no test's draws depend on which tests ran before."""
    RNG.bit_generator.state = FIRST_DRAWS


def scattered(scene, count, share=0.2):
    """The states of a scene with each changed by a part of itself; quaternions stay units."""
    start = scene.initial_values()
    found = {n: v * (1 + share * RNG.uniform(-1, 1, count)) for n, v in start.items()}
    q = [n for n in start if n in {"q0", "q1", "q2", "q3"}]
    norm = np.sqrt(sum(found[n] ** 2 for n in q)) if q else 1.0
    return found | {n: found[n] / norm for n in q}


def column(values, j):
    return {n: float(v[j] if np.ndim(v) else v) for n, v in values.items()}


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("name", ["heavy-top", "lecture-wheel"])
@pytest.mark.parametrize("method", ["taylor", "DOP853"])
def test_every_trajectory_is_that_of_simulate(name, method):
    scene = eom.load_scene(name)
    compiled = scene_once(name)
    start, p, times = scattered(scene, 11), scene.parameter_values(), [0.5, 1.0, 2.0]
    found = codegen.ensemble(compiled, start, (0, 2), p, method, 1e-7, t_eval=times)
    assert ("lanes" in found.method) == (method == "taylor")
    for j in range(11):
        run = simulate(compiled, column(start, j), (0, 2), p, method, 1e-7, t_eval=times)
        assert fleet.STATUS[found.status[j]] == {0: "end", 1: "singular"}[run.status]
        assert abs(found.t_stop[j] - run.t_stop) < 1e-6
        reached = len(run.t)
        scale = np.abs(run.y_stop).max()
        assert np.abs(found.y[:, :reached, j] - run.y).max(initial=0) < 1e-6 * scale
        assert np.isnan(found.y[:, reached:, j]).all()
        for output in found.outputs:
            np.testing.assert_allclose(
                found[output][:reached, j], run[output], rtol=1e-7, atol=1e-8
            )
    assert set(found.drift) == set(compiled.layout.results["invariants"])
    assert all(d.maximum[0] < 1e-5 for d in found.drift.values())


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("rtol", [1e-6, 1e-9, 1e-12, 2.0**-52])
def test_error_is_that_of_the_exact_solution(rtol):
    m = RNG.uniform(0.1, 0.9, 50)
    system = System.from_rates("elliptic", {y1: y2 * y3, y2: -y1 * y3, y3: -k * y1 * y2})
    start = {"y1": 0.0, "y2": 1.0, "y3": 1.0}
    found = codegen.ensemble(compile_system(system, "c"), start, (0, 20), {"k": m}, rtol=rtol)
    sn, cn, dn, _ = ellipj(20.0, m)
    assert found.success
    assert np.abs(found.y_stop - [sn, cn, dn]).max() < 30 * rtol + 2e-14


@needs_compiler
@settings(max_examples=5)
@given(data=st.data())
def test_no_bit_depends_on_neighbours_chunks_or_threads(data):
    compiled = compiled_once(PENDULUM)
    count = data.draw(st.integers(1, 700))
    order = data.draw(st.permutations(range(count)))
    x, p = RNG.normal(size=(2, count)), RNG.uniform(0.5, 2, (1, count))
    first = codegen.ensemble(compiled, x, (0, 5), p, t_eval=[1, 5], threads=1)
    chunk, threads = data.draw(st.sampled_from([256, 512])), data.draw(st.integers(1, 4))
    other = codegen.ensemble(
        compiled, x[:, order], (0, 5), p[:, order], t_eval=[1, 5], chunk=chunk, threads=threads
    )
    for name, values in first.columns.items():
        np.testing.assert_array_equal(values[..., order], other.columns[name])


COMPILED = {}


def compiled_once(system):
    if system.name not in COMPILED:
        COMPILED[system.name] = compile_system(system, "c")
    return COMPILED[system.name]


def scene_once(name):
    if name not in COMPILED:
        COMPILED[name] = compile_system(eom.load_scene(name).derive(), "c")
    return COMPILED[name]


def lanes_text(compiled, rtol=1e-4):
    prepared = prepare(compiled.program, RATES, compiled.layout)
    order = taylor.order_of(rtol)
    return taylor_lanes.single_text(prepared, compiled.program, compiled.layout, order)


def shared(n, t_span=(0.0, 5.0), t_eval=(), **others):
    given = {"max_step": math.inf, "max_steps": 10**6, **others}
    grid = np.array(t_eval, dtype=float)
    return fleet.Shared(t_span, np.zeros(0), 1e-9, np.full(n, 1e-12), 1e-6, grid, **given)


@pytest.mark.sparse(only=("pendulum",))
@needs_compiler
@pytest.mark.parametrize("system", [PENDULUM, LINEAR], ids=lambda s: s.name)
def test_no_bit_depends_on_the_width_of_vectors(system):
    compiled = compiled_once(system)
    text = lanes_text(compiled)
    n, m = len(compiled.layout.states), len(compiled.layout.parameters)
    x, p = RNG.normal(size=(n, 37)), RNG.uniform(0.9, 1.1, (m, 37))
    found = []
    for width in (2, 4, 8):
        flags = (*taylor_lanes.FLAGS, f"-DLANES_={width}", "-Wno-psabi")
        library = ctypes.CDLL(str(native.compile_library(text, flags)))
        run = fleet.runner(getattr(library, f"{identifier(system.name)}_taylor_lanes_run"))
        assert getattr(library, f"{identifier(system.name)}_taylor_lanes_lanes")() == width
        found.append(run(shared(n, t_eval=[0.0, 2.0, 5.0]), x, p))
    for other in found[1:]:
        np.testing.assert_array_equal(found[0].y, other.y)
        np.testing.assert_array_equal(found[0].steps, other.steps)


@needs_compiler
@pytest.mark.parametrize("compiler", [n for n in ("gcc", "clang") if shutil.which(n)])
@pytest.mark.parametrize("name", ["heavy-top", "lecture-wheel"])
def test_generated_text_has_no_warnings(compiler, name, tmp_path):
    compiled = scene_once(name)
    file = tmp_path / "lanes.c"
    file.write_text(lanes_text(compiled), encoding="ascii")
    flags = ["-std=c99", "-O0", "-Wall", "-Wextra", "-Werror", "-Wno-psabi", "-fsyntax-only"]
    done = subprocess.run(
        [compiler, *flags, str(file)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("method", ["taylor", "DOP853"])
def test_failures_are_reported_and_do_not_disturb_the_others(method):
    """Y' = y^2 is infinite at t = 1/y(0); others start at infinity of their rate, or go on."""
    start = np.where(np.arange(60) % 3 == 0, 1.0, -1.0) * RNG.uniform(0.5, 2, 60)
    start[7] = 1e200
    found = codegen.ensemble(compiled_once(GROWING), start[None], (0, 10), None, method)
    failed = start > 0
    assert set(found.counts) <= {"end", "not finite", "step"}
    assert found.counts["end"] == int((~failed).sum())
    assert not found.success
    assert found.stopped[0].tolist() == np.flatnonzero(failed).tolist()
    np.testing.assert_allclose(found.t_stop[failed], 1 / start[failed], rtol=1e-6, atol=1e-12)
    exact = start / (1 - 10 * start)
    np.testing.assert_allclose(found.y_stop[0, ~failed], exact[~failed], rtol=1e-8)
    assert "not finite" in repr(found) or "step" in repr(found)


@needs_compiler
@pytest.mark.parametrize("method", ["taylor", "DOP853"])
def test_a_run_of_too_many_steps_stops(method):
    x = RNG.normal(size=(2, 20))
    found = codegen.ensemble(compiled_once(PENDULUM), x, (0, 500), [1.0], method, max_steps=30)
    assert found.counts == {"max_steps": 20}
    assert (found.columns["steps"] + found.columns["rejected"] >= 30).all()
    assert (found.columns["steps"] <= 30).all()
    assert ((found.t_stop > 0) & (found.t_stop < 500)).all()


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("method", ["taylor", "DOP853"])
def test_a_singular_configuration_is_located_and_nothing_jumps_over_it(method):
    """Theta = theta_0 + omega_2 t meets pi/2 at a known time, and steps would grow without end."""
    theta, rate = (
        RNG.uniform(-1, 1, 40),
        np.where(RNG.random(40) < 0.2, 1e-3, RNG.uniform(0.1, 3, 40)),
    )
    theta[5] = math.pi / 2
    start = dict.fromkeys(LINEAR.state_names, 0.0) | {"theta": theta, "omega_2": rate}
    moments, times = {"I1": 1.0, "I2": 1.0, "I3": 1.0}, np.linspace(0, 20, 5)
    found = codegen.ensemble(compiled_once(LINEAR), start, (0, 20), moments, method, t_eval=times)
    hit = (math.acos(1e-6) - theta) / rate
    hit[5] = 0.0
    singular = hit < 20
    assert found.counts == {"end": int((~singular).sum()), "singular": int(singular.sum())}
    np.testing.assert_array_equal(found.status, singular)
    np.testing.assert_array_equal(found.columns["which"], np.where(singular, 0, -1))
    np.testing.assert_allclose(found.t_stop, np.where(singular, hit, 20.0), atol=1e-7)
    reached = times[:, None] <= np.where(theta == math.pi / 2, -1.0, found.t_stop)
    np.testing.assert_array_equal(np.isfinite(found["theta"]), reached)
    np.testing.assert_allclose(
        found["theta"][reached], (theta + rate * times[:, None])[reached], atol=1e-9
    )


@pytest.mark.slow
@needs_compiler
def test_kinks_are_followed():
    compiled = compiled_once(KINKED)
    """Sample 7 changes its sign twice within a step, after which the slopes fit as before."""
    x, p = RNG.normal(size=(2, 9)), RNG.uniform(0.5, 2, (1, 9))
    found = codegen.ensemble(compiled, x, (0, 6), p, "taylor")
    for j in range(9):
        run = simulate(compiled, x[:, j], (0, 6), p[:, j], "DOP853", 1e-12)
        np.testing.assert_allclose(found.y_stop[:, j], run.y_stop, rtol=1e-6, atol=1e-7)
    assert found.y_stop[0, 7] == pytest.approx(50.3824962, abs=1e-6)
    assert not found.columns["rejected"].any()


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("method", ["taylor", "DOP853"])
def test_there_and_back(method):
    x = RNG.normal(size=(2, 30))
    there = codegen.ensemble(compiled_once(PENDULUM), x, (1, 9), [2.0], method, 1e-12)
    back = codegen.ensemble(
        compiled_once(PENDULUM), there.y_stop, (9, 1), [2.0], method, 1e-12, t_eval=[9, 4, 1]
    )
    np.testing.assert_array_equal(back.y[:, 0], there.y_stop)
    np.testing.assert_allclose(back.y[:, 2], x, atol=1e-9)


@needs_compiler
def test_what_has_no_lanes_goes_one_by_one_with_the_same_result(monkeypatch):
    compiled = compiled_once(PENDULUM)
    x = RNG.normal(size=(2, 20))
    lanes = codegen.ensemble(compiled, x, (0, 5), [1.0], "taylor")
    monkeypatch.setattr(fleet, "MOST_IN_LANES", 10)
    plain = codegen.ensemble(compile_system(PENDULUM, "c"), x, (0, 5), [1.0], "taylor")
    assert "lanes" in lanes.method
    assert not lanes.notice
    assert "lanes" not in plain.method
    assert "no lanes" in plain.notice
    np.testing.assert_allclose(lanes.y_stop, plain.y_stop, atol=1e-8)


@needs_compiler
def test_auto_takes_dop853_where_a_function_has_no_series():
    system = System.from_rates("bessel", {y1: sp.besselj(1, y1) - y1})
    found = codegen.ensemble(compile_system(system, "c"), {"y1": [0.5, 1.0]}, (0, 1))
    assert found.method.startswith("DOP853")
    assert "no Taylor series of besselj" in found.notice
    run = simulate(system, {"y1": 1.0}, (0, 1))
    assert abs(found.y_stop[0, 1] - run.y_stop[0]) < 1e-9


def test_without_a_compiler_scipy_integrates():
    compiled = compile_system(PENDULUM, "numpy")
    found = codegen.ensemble(compiled, [[1.0, 0.5], [0.0, 0.1]], (0, 1), [1.0], t_eval=[0.5, 1.0])
    assert "SciPy" in found.method
    assert found.notice
    run = simulate(compiled, [0.5, 0.1], (0, 1), [1.0], t_eval=[0.5, 1.0])
    np.testing.assert_allclose(found.y[:, :, 1], run.y, rtol=1e-12)


@needs_compiler
def test_inputs_are_held_and_scalars_serve_all():
    system = System.from_rates("pushed", {y1: y2, y2: u - k * y1}, inputs=[u])
    found = codegen.ensemble(
        system, {"y1": 0.0, "y2": [0.0, 1.0, 2.0]}, (0, 3), {"k": 4.0}, inputs={"u": 2.0}
    )
    exact = 0.5 - 0.5 * math.cos(6) + np.array([0, 1, 2]) * math.sin(6) / 2
    np.testing.assert_allclose(found.y_stop[0], exact, atol=1e-8)


@needs_compiler
def test_progress_ends_at_one_and_memory_may_be_left_out():
    seen = []
    found = codegen.ensemble(
        compiled_once(PENDULUM), np.ones((2, 1000)), (0, 1), [1.0], keep=False, chunk=256,
        progress=seen.append,
    )  # fmt: skip
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert found.counts == {"end": 1000}
    with pytest.raises(InputError, match="not kept"):
        _ = found.y


@needs_compiler
def test_statistics_are_those_of_the_trajectories():
    scene = eom.Scene.ready("lecture-wheel")
    compiled = scene_once("lecture-wheel")
    start = scattered(scene, 600, 0.5)
    output = compiled.layout.results["outputs"][0]
    edges = np.linspace(-1, 1, 5)
    asked = codegen.Statistics(("theta", output), quantiles=True, edges={"theta": edges})
    given = (compiled, start, (0, 1), scene.parameter_values(), "taylor", 1e-7)
    found = codegen.ensemble(*given, t_eval=[0.5, 1.0], statistics=asked)
    bare = codegen.ensemble(*given, t_eval=[0.5, 1.0], statistics=asked, keep=False, chunk=256)
    for name in asked.names:
        values, counted = found[name], bare.statistics[name]
        np.testing.assert_array_equal(counted.mean, found.statistics[name].mean)
        np.testing.assert_allclose(counted.mean, values.mean(axis=1), rtol=1e-12)
        np.testing.assert_allclose(counted.variance, values.var(axis=1, ddof=1), rtol=1e-10)
        np.testing.assert_array_equal(counted.minimum, values.min(axis=1))
        np.testing.assert_array_equal(counted.maximum, values.max(axis=1))
        exact = np.quantile(values, [0.1, 0.5], axis=1, method="inverted_cdf").T
        np.testing.assert_allclose(counted.quantile([0.1, 0.5]), exact, rtol=1e-3)
    histogram = [np.histogram(row, edges)[0] for row in found["theta"]]
    np.testing.assert_array_equal(bare.statistics["theta"].histogram, histogram)
    largest = found.columns["drift"].max(axis=1)
    assert [d.maximum[0] for d in bare.drift.values()] == largest.tolist()


@needs_compiler
def test_lanes_are_quicker_than_one_after_the_other(monkeypatch):
    compiled, x = compiled_once(PENDULUM), RNG.normal(size=(2, 4000))
    run = fleet.build(compiled, "taylor", 1e-9).run
    monkeypatch.setattr(fleet, "MOST_IN_LANES", 1)
    plain = fleet.build(compiled, "taylor", 1e-9).run

    def seconds(function):
        begin = time.process_time()
        function(shared(2), x, np.ones(1))
        return time.process_time() - begin

    assert within(lambda: 0.8 * seconds(plain), lambda: seconds(run))


BAD = {
    "wrong length": ((np.ones((3, 4)), (0, 1), [1.0]), {}, "wrong shape"),
    "too many axes": ((np.ones((2, 4, 2)), (0, 1), [1.0]), {}, "wrong shape"),
    "not numbers": (("abc", (0, 1), [1.0]), {}, "not numbers"),
    "NaN": (([[1.0, math.nan], [0.0, 0.0]], (0, 1), [1.0]), {}, "y1 is not finite"),
    "infinite parameter": ((np.ones((2, 3)), (0, 1), {"k": [1, 2, math.inf]}), {}, "trajectory 2"),
    "none": ((np.ones((2, 0)), (0, 1), [1.0]), {}, "no trajectories"),
    "counts": ((np.ones((2, 3)), (0, 1), {"k": [1.0, 2.0]}), {}, "trajectories differ"),
    "unknown state": (({"y1": 1, "y2": 2, "y3": 3}, (0, 1), [1.0]), {}, "unknown state 'y3'"),
    "unknown parameter": ((np.ones((2, 3)), (0, 1), {"K": 1.0}), {}, "unknown parameter"),
    "missing": (({"y1": [1.0]}, (0, 1), [1.0]), {}, "missing states or parameters: y2"),
    "method": ((np.ones((2, 3)), (0, 1), [1.0], "euler"), {}, "unknown method"),
    "time": ((np.ones((2, 3)), (0, math.nan), [1.0]), {}, "time interval"),
    "t_eval": ((np.ones((2, 3)), (0, 1), [1.0]), {"t_eval": [2.0]}, "t_eval does not fit"),
    "statistics": ((np.ones((2, 3)), (0, 1), [1.0]), {"statistics": ["y9"]}, "unknown state or output"),
    "threads": ((np.ones((2, 3)), (0, 1), [1.0]), {"threads": 0}, "threads is not"),
    "chunk": ((np.ones((2, 3)), (0, 1), [1.0]), {"chunk": 1.5}, "chunk is of the wrong type"),
    "no chunk": ((np.ones((2, 3)), (0, 1), [1.0]), {"chunk": 0}, "chunk is not"),
    "client": ((np.ones((2, 3)), (0, 1), [1.0]), {"client": "me"}, "client|dask"),
    "input": ((np.ones((2, 3)), (0, 1), [1.0]), {"inputs": {"u": 1.0}}, "unknown input"),
    "rtol": ((np.ones((2, 3)), (0, 1), [1.0]), {"rtol": -1.0}, "rtol does not fit"),
}  # fmt: skip


@pytest.mark.parametrize("what", BAD)
def test_bad_input_gives_one_clear_error(what):
    arguments, others, message = BAD[what]
    with pytest.raises(InputError, match=message):
        codegen.ensemble(compile_system(PENDULUM, "numpy"), *arguments, **others)


@needs_compiler
def test_values_that_contradict_the_system_are_refused_and_located():
    scene = eom.Scene.ready("t-handle")
    system, start, p = scene.derive(), scene.initial_values(), scene.parameter_values()
    moments = np.full(5, p["I1"])
    moments[3] = p["I2"] + p["I3"] + 1.0
    with pytest.raises(AssumptionError, match="trajectory 3"):
        codegen.ensemble(system, start, (0, 1), p | {"I1": moments})
    moments[3] = -1.0
    with pytest.raises(InputError, match="I1 is not positive"):
        codegen.ensemble(system, start, (0, 1), p | {"I1": moments})
