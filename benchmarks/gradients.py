"""The target jax beside C: rates of many points, a Jacobian, and how long the first call waits.

Each time on the same arrays in double precision. JAX's calls are compiled (jit) and waited for; ours run in
vector lanes and threads. ``python -m benchmarks.gradients``.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.pairs import paired
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, alone, time_text
from codegen import compile as compile_system
from codegen.native.native import CACHE_VARIABLE
from codegen.targets import jax_
from eom.opening import load_scene

SCENES = ("t-handle", "heavy-top", "double-pendulum", "reaction-wheels", "seven-joint-arm")
POINTS = 10_000
CALLS = 20
PAIRS = 15
LARGEST_DIFFERENCE = 1e-9


def measure(settings: Settings) -> Section:
    """Return three rows a scene: many points, a Jacobian, the first call."""
    title = f"C | JAX: rates of {POINTS} points, a Jacobian, first call"
    if not jax_.available():
        return Section(title, (Row("JAX", "not measured", "jax missing: install the extra jax"),))
    scenes = SCENES[:2] if settings.quick else SCENES
    return Section(title, tuple(row for name in scenes for row in _rows(name)))


def _rows(name: str) -> Iterator[Row]:
    import jax

    scene = load_scene(name)
    x, p, u = (
        np.array([*v.values()], dtype=float)
        for v in (scene.initial_values(), scene.parameter_values(), scene.input_values())
    )
    many = x[:, None] + np.random.default_rng(1).uniform(-0.01, 0.01, (len(x), POINTS))
    with jax.enable_x64(True):
        system = scene.derive()
        with _empty_cache():
            began = perf_counter()
            ours = compile_system(system, "c")
            ours.rhs(0.0, x, p, u)
            first = perf_counter() - began
        began = perf_counter()
        module = compile_system(system, "jax").module
        one = jax.jit(module.rhs)
        one(0.0, x, p, u).block_until_ready()
        theirs = perf_counter() - began
        batch, jacobian = ours.batch(), ours.jacobian()
        mapped = jax.jit(jax.vmap(module.rhs, (None, 1, None, None), 1))
        slopes = jax.jit(jax.jacfwd(module.rhs, argnums=1))
        yield _row(
            f"{name}, points", lambda: batch(0.0, many, p, u), lambda: mapped(0.0, many, p, u)
        )
        yield _row(
            f"{name}, Jacobian", lambda: jacobian.dense(0.0, x, p, u), lambda: slopes(0.0, x, p, u)
        )
    yield Row(f"{name}, first call", time_text(first), time_text(theirs), f"{first / theirs:.2f}")


@contextmanager
def _empty_cache() -> Iterator[None]:
    """Compile what is compiled meanwhile."""
    before = os.environ.get(CACHE_VARIABLE)
    with tempfile.TemporaryDirectory() as folder:
        os.environ[CACHE_VARIABLE] = folder
        yield
    if before is None:
        del os.environ[CACHE_VARIABLE]
    else:
        os.environ[CACHE_VARIABLE] = before


def _row(what: str, ours: Callable[[], Any], theirs: Callable[[], Any]) -> Row:
    """Return times a call, side by side. Raises `AssertionError` where results differ."""
    expected = ours()
    difference = np.abs(np.asarray(theirs()) - expected).max() / max(1.0, np.abs(expected).max())
    assert difference < LARGEST_DIFFERENCE, (what, difference)
    pairs = paired(_timed(ours), _timed(lambda: theirs().block_until_ready()), PAIRS)
    first, second = pairs.typical
    return Row(what, time_text(first), time_text(second), f"{pairs.ratio:.2f}")


def _timed(call: Callable[[], Any]) -> Callable[[], float]:
    def sample() -> float:
        began = perf_counter()
        for _ in range(CALLS):
            call()
        return (perf_counter() - began) / CALLS

    return sample


if __name__ == "__main__":
    alone(measure)
