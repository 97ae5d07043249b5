"""The method taylor beside heyoka, which integrates by Taylor series that LLVM compiles."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from benchmarks.pairs import paired, seconds, settled
from benchmarks.peers import absent, missing
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen import Compiled, Result, simulate
from codegen import compile as compile_system
from eom.system import TIME, System

Array = NDArray[np.float64]
TOLERANCES = (1e-6, 1e-9, 1e-12, 2.0**-52)
LARGEST_RATIO = 0.7
RUNS_A_SAMPLE = 10
ROUNDING = 2e-12
"""Errors below this, relative to the largest state, are rounding in either program."""


@dataclass(frozen=True)
class Task:
    """Rates by state, over SymPy symbols, the start, and the end time."""

    name: str
    rates: Mapping[Any, Any]
    start: tuple[float, ...]
    end: float
    compared: float
    """Where errors are taken: at the end, or before where the motion is chaotic."""


def tasks() -> list[Task]:
    """Return the torque-free body, and the scenes whose times the design notes list."""
    return [torque_free(), spinner(), heavy_top(), gravity_gradient()]


def torque_free() -> Task:
    """Euler's equations whose solution is sn, cn, dn of parameter 0.51."""
    a, b, c = sp.symbols("y1:4", real=True)
    rates = {a: b * c, b: -a * c, c: sp.Float(-0.51) * a * b}
    return Task("torque-free", rates, (0.0, 1.0, 1.0), 1000.0, 1000.0)


def spinner() -> Task:
    """A body of revolution with a moment about one transverse axis, in spin and two angles."""
    theta, psi, rate, turn = sp.symbols("theta psi rate turn", real=True)
    spin, transverse, moment = 20, sp.Rational(12, 100), sp.Rational(1, 2)
    sine, cosine = sp.sin(theta), sp.cos(theta)
    momentum = sp.Rational(6, 100) * spin
    rates = {
        theta: rate,
        psi: turn,
        rate: (moment - momentum * turn * cosine + transverse * turn**2 * sine * cosine) / transverse,
        turn: (momentum * rate - 2 * transverse * turn * rate * sine) / (transverse * cosine),
    }  # fmt: skip
    return Task("3-1-2 spinner", rates, (0.1, 0.0, 0.0, 0.2), 10.0, 10.0)


def heavy_top() -> Task:
    """Euler's equations and a quaternion under gravity, the moment about the fixed point."""
    w, q = sp.symbols("w1:4", real=True), sp.symbols("q0:4", real=True)
    vertical = _vertical(q)
    torque = (2 * vertical[1], -2 * vertical[0], 0)
    start = (0.1, 0.2, 20.0, float(np.cos(0.3)), float(np.sin(0.3)), 0.0, 0.0)
    inertia = (1, 1, sp.Rational(3, 10))
    return Task("heavy top", {**_euler(w, inertia, torque), **_quaternion(q, w)}, start, 20.0, 20.0)


def gravity_gradient() -> Task:
    """A satellite on a circular orbit, 100 times round, in an inertial quaternion."""
    w, q = sp.symbols("w1:4", real=True), sp.symbols("q0:4", real=True)
    n = sp.Float(0.00113)
    inertia = (10, 12, 7)
    c, s = sp.cos(n * TIME), sp.sin(n * TIME)
    rows = _rotation(q)
    r = [row[0] * c + row[1] * s for row in rows]
    cross = [r[(i + 1) % 3] * r[(i + 2) % 3] * (inertia[(i + 2) % 3] - inertia[(i + 1) % 3])
             for i in range(3)]  # fmt: skip
    rates = {**_euler(w, inertia, [3 * n**2 * x for x in cross]), **_quaternion(q, w)}
    end = float(200 * np.pi / 0.00113)
    start = (1e-4, 2e-4, 0.00113, 1.0, 0.0, 0.0, 0.0)
    return Task("gravity gradient", rates, start, end, end / 50)


def _euler(w: Sequence[Any], inertia: Sequence[Any], torque: Sequence[Any]) -> dict[Any, Any]:
    found = {}
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        found[w[i]] = ((inertia[j] - inertia[k]) * w[j] * w[k] + torque[i]) / inertia[i]
    return found


def _quaternion(q: Sequence[Any], w: Sequence[Any]) -> dict[Any, Any]:
    """Return q w / 2 with w in the body."""
    a, b, c, d = q
    x, y, z = w
    products = (
        -b * x - c * y - d * z,
        a * x + c * z - d * y,
        a * y + d * x - b * z,
        a * z + b * y - c * x,
    )
    return {s: p / 2 for s, p in zip(q, products, strict=True)}  # fmt: skip


def _rotation(q: Sequence[Any]) -> list[list[Any]]:
    """From the frame at rest to the body."""
    a, b, c, d = q
    return [
        [a**2 + b**2 - c**2 - d**2, 2 * (b * c + a * d), 2 * (b * d - a * c)],
        [2 * (b * c - a * d), a**2 - b**2 + c**2 - d**2, 2 * (c * d + a * b)],
        [2 * (b * d + a * c), 2 * (c * d - a * b), a**2 - b**2 - c**2 + d**2],
    ]


def _vertical(q: Sequence[Any]) -> list[Any]:
    return [row[2] for row in _rotation(q)]


@dataclass(frozen=True)
class Contest:
    """One task in both programs, and its end as heyoka computes it in extended precision."""

    task: Task
    compiled: Compiled
    rates: list[tuple[Any, Any]]
    reference: Array

    def ours(self, rtol: float, end: float) -> Result:
        """Return the end by `codegen.simulate`."""
        span = (0.0, end)
        run = simulate(self.compiled, self.task.start, span, None, "taylor", rtol, t_eval=[end])
        assert run.success, run.message
        return run

    def theirs(self, rtol: float) -> Callable[[float], Array]:
        """Return what integrates by heyoka; the compilation is done."""
        heyoka: Any = importlib.import_module("heyoka")
        start = list(map(float, self.task.start))
        integrator = heyoka.taylor_adaptive(self.rates, start, tol=rtol)

        def run(end: float) -> Array:
            integrator.time = 0.0
            integrator.state[:] = start
            integrator.propagate_until(end)
            return np.array(integrator.state)

        return run

    def error(self, end: Array) -> float:
        """Return the largest difference from the reference, relative to the largest state."""
        return float(np.abs(end - self.reference).max() / np.abs(self.reference).max())


def contest(task: Task) -> Contest:
    """Return a task in both programs, and its end by heyoka in extended precision."""
    heyoka: Any = importlib.import_module("heyoka")
    doubles = {s: sp.N(r, 15) for s, r in task.rates.items()}
    system = System.from_rates(task.name.replace(" ", "_").replace("-", "_"), doubles)
    names = {TIME: heyoka.time}
    rates = [(heyoka.expression(str(s)), heyoka.from_sympy(r, names)) for s, r in doubles.items()]
    start = np.array(task.start, dtype=np.longdouble)
    fine = heyoka.taylor_adaptive(rates, start, fp_type=np.longdouble)
    fine.propagate_until(np.longdouble(task.compared))
    return Contest(task, compile_system(system, "c"), rates, np.array(fine.state, dtype=float))


def measure(settings: Settings) -> Section:
    """Return time of the integration alone, and error, of each task at each tolerance."""
    title = "simulate, method taylor | heyoka"
    without = missing("heyoka")
    if without:
        return Section(title, (absent("Taylor series", without),))
    chosen = tasks()[:1] if settings.quick else tasks()
    contests = [contest(task) for task in chosen]
    return Section(
        title, tuple(r for c in contests for t in TOLERANCES for r in _rows(c, t, settings))
    )


def _rows(contest: Contest, rtol: float, settings: Settings) -> tuple[Row, Row]:
    task, run = contest.task, contest.theirs(rtol)
    ours, theirs = (
        contest.error(contest.ours(rtol, task.compared).y_stop),
        contest.error(run(task.compared)),
    )
    count = 3 if settings.quick else 7
    pairs = settled(
        lambda: paired(
            lambda: min(contest.ours(rtol, task.end).seconds for _ in range(RUNS_A_SAMPLE)),
            lambda: min(seconds(lambda: run(task.end)) for _ in range(RUNS_A_SAMPLE)),
            count,
        ),
        lambda p: p.ratio,
        LARGEST_RATIO,
    )
    what = f"{task.name}, {rtol:.0e}"
    times = (time_text(s) for s in pairs.best)
    quick = pairs.ratio <= LARGEST_RATIO
    met = ours <= max(theirs, ROUNDING)
    return (
        Row(f"{what}: time", *times, f"{pairs.ratio:.2f}", f"<= {LARGEST_RATIO}", quick),
        Row(f"{what}: error", f"{ours:.1e}", f"{theirs:.1e}", "", f"<= heyoka's, or {ROUNDING:.0e}", met),
    )  # fmt: skip
