"""Ensembles of method auto go on where a Taylor series is stuck, each trajectory as a run of its own."""

from functools import cache

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.integrate import fleet
from codegen.native import native
from eom.errors import InputError
from eom.quantities import TIME
from eom.system import System

pytestmark = pytest.mark.skipif(not native.compiler(), reason="runs C")
x, v, w = sp.symbols("x v w", real=True)
PULSE = System.from_rates("pulse", {x: v, v: -x + 5 / sp.cosh(w * (TIME - 4)) ** 2})
"""Far from the pulse the series of 1/cosh^2 overflow from the start, where w is large."""
BUMP = System.from_rates("bump", {x: v, v: -x + 3 / sp.cosh(400 * x) ** 2})
ROOT = System.from_rates("root", {x: sp.sqrt(x)})
POLE = System.from_rates("pole", {x: x**2})
GRID = np.linspace(0, 8, 5)

compiled = cache(lambda system: codegen.compile(system, "c"))


def pulses(count, method="auto", **options):
    """Every third trajectory has a narrow pulse."""
    start = {"x": np.linspace(0.5, 1, count), "v": 0.0}
    speeds = {"w": np.where(np.arange(count) % 3 == 0, 1000.0, 2.0)}
    return codegen.ensemble(
        compiled(PULSE), start, (0, 8), speeds, method, 1e-9, 1e-9, GRID, **options
    )


def same(found, other):
    return all(np.array_equal(c, other.columns[n], True) for n, c in found.columns.items())


def test_what_is_stuck_goes_on_and_nothing_else_changes():
    """What is stuck at the start is what DOP853 makes of it, to the last bit."""
    found, series, other = (pulses(30, method) for method in ("auto", "taylor", "DOP853"))
    stuck = np.arange(30) % 3 == 0
    assert found.success
    assert found.columns["continued"].tolist() == stuck.astype(int).tolist()
    assert series.counts == {"end": 20, "not finite": 10}
    assert "another method went on (trajectories: 10)" in found.notice
    assert "singular" not in found.notice
    assert series.notice == other.notice == ""
    for name in ("y", "y_stop", "t_stop", "steps"):
        mine = found.columns[name]
        np.testing.assert_array_equal(mine[..., ~stuck], series.columns[name][..., ~stuck])
        np.testing.assert_array_equal(mine[..., stuck], other.columns[name][..., stuck])
    assert not series.columns["continued"].any()


def test_each_goes_on_from_where_it_stopped_as_a_run_of_its_own():
    start = {"x": -0.1, "v": np.linspace(1.5, 2.5, 6)}
    times = np.linspace(0, 12, 49)
    plan = compiled(BUMP), start, (0, 12)
    found, series = (
        codegen.ensemble(*plan, None, method, 1e-9, 1e-9, times) for method in ("auto", "taylor")
    )
    assert set(series.counts) <= {"not finite", "step"}
    assert found.counts == {"end": 6}
    for j in range(6):
        at = float(series.t_stop[j])
        after = times[times > at]
        alone = codegen.simulate(
            compiled(BUMP), series.y_stop[:, j], (at, 12.0), None, "auto", 1e-9, 1e-9, after
        )
        assert 0 < len(after) < len(times)
        np.testing.assert_array_equal(found.y[:, times <= at, j], series.y[:, times <= at, j])
        np.testing.assert_array_equal(found.y[:, times > at, j], alone.y)
        assert found.columns["steps"][j] == series.columns["steps"][j] + alone.steps


@pytest.mark.sparse(1)
@pytest.mark.parametrize("shape", ["zarr", "parquet"])
def test_no_bit_depends_on_chunks_threads_or_a_store(shape, tmp_path):
    options = {"statistics": ["x"], "keep": True}
    one = pulses(600, chunk=768, threads=1, **options)
    parts = pulses(600, chunk=256, threads=3, **options)
    store = {"chunk": 256, "store": tmp_path, "store_format": shape, **options}
    written, read = pulses(600, **store), pulses(600, **store)
    assert read.computed == 0
    for other in (parts, written, read):
        assert same(one, other)
        assert (other.notice, other.counts) == (one.notice, {"end": 600})
        np.testing.assert_array_equal(other.statistics["x"].mean, one.statistics["x"].mean)
    with pytest.raises(InputError, match="another ensemble"):
        pulses(600, "taylor", **store)


def test_an_ensemble_without_trajectories_reports_it_too():
    found = pulses(30, statistics=["x"], keep=False)
    assert found.success
    assert "(trajectories: 10)" in found.notice


def test_what_may_be_a_singularity_is_not_passed_in_silence():
    """x' = sqrt(x) from zero has many solutions."""
    found = codegen.ensemble(compiled(ROOT), {"x": [0.0, 0.5, 1.0]}, (0, 3), atol=1e-9)
    assert found.success
    assert found.columns["continued"].tolist() == [fleet.PASSED, 0, 0]
    assert (
        "if the rates are singular there, the rest says nothing (trajectories: 1)" in found.notice
    )


def test_at_a_pole_nothing_goes_on_and_the_trajectory_stays_as_it_was():
    start = {"x": np.linspace(-1, 1, 20)}
    found, series = (
        codegen.ensemble(compiled(POLE), start, (0, 3), None, method, t_eval=[0.5, 3])
        for method in ("auto", "taylor")
    )
    assert same(found, series)
    assert set(found.counts) > {"end"}
    assert found.notice == ""


def test_steps_of_both_parts_count_towards_the_most():
    """The series tries shorter steps before it is stuck: those count."""
    tried = int(pulses(3, "taylor").columns["rejected"][0])
    found = pulses(3, max_steps=tried + 50)
    assert found.columns["continued"][0] == 1
    assert found.counts == {"end": 2, "max_steps": 1}
    assert found.columns["steps"][0] + found.columns["rejected"][0] == tried + 50


def test_a_late_start_goes_on_over_the_time_since_it():
    begin = 2.0**30
    late = System.from_rates("late", {x: v, v: -x + 5 / sp.cosh(1000 * (TIME - begin - 4)) ** 2})
    found = codegen.ensemble(
        compiled(late), {"x": [1.0], "v": 0.0}, (begin, begin + 8), None, "auto", 1e-9, 1e-9
    )
    assert found.columns["continued"].tolist() == [1]
    assert found.t_stop.tolist() == [begin + 8]
    kick = 2 * 5 / 1000 * np.array([np.sin(4.0), np.cos(4.0)])
    exact = np.array([np.cos(8.0), -np.sin(8.0)]) + kick
    np.testing.assert_allclose(found.y_stop[:, 0], exact, atol=1e-6)
