"""A call of ``rhs`` from Python, eight states: its time, and beside the cheapest call of NumPy."""

from __future__ import annotations

from collections.abc import Callable
from timeit import Timer
from typing import Any

import numpy as np
import sympy as sp

from benchmarks.native_rates import Points, Rates, sampler
from benchmarks.pairs import Pairs, Sample, paired, settled
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen import Compiled
from codegen import compile as compile_system
from codegen.native import native
from eom.system import System

LONGEST_SECONDS = 1.5e-6
LARGEST_RATIO = 2.0
"""Of ``rhs`` to ``np.add(x, x, out=out)``, which takes about a third of a microsecond."""
CALLS = 2000
MASSES = 4

FORMS = {
    "8 states, new array": "rhs(t, x, p, u)",
    "8 states, out=out": "rhs(t, x, p, u, out=out)",
}
YARDSTICK = "np.add(x, x, out=out)"


def chain() -> System:
    """Return four masses between springs and dampers, pushed at one end: eight states."""
    q, v = sp.symbols(f"q1:{MASSES + 1}"), sp.symbols(f"v1:{MASSES + 1}")
    k, d, m, push = sp.symbols("k d m F")
    rates: dict[Any, Any] = dict(zip(q, v, strict=True))
    for i in range(MASSES):
        left = (q[i - 1], v[i - 1]) if i else (0, 0)
        right = (q[i + 1], v[i + 1]) if i + 1 < MASSES else (0, 0)
        pull = k * (left[0] - 2 * q[i] + right[0]) + d * (left[1] - 2 * v[i] + right[1])
        rates[v[i]] = (pull + (push if i == 0 else 0)) / m
    return System.from_rates("chain", rates, inputs=[push])


def measure(settings: Settings) -> Section:
    """Return one row a form of the call."""
    compiled = compile_system(chain(), "c")
    points = Points.of(compiled)
    in_c = min(sampler(Rates.generated(compiled), points)() for _ in range(50))
    rows = tuple(_row(what, code, compiled, points, in_c, settings) for what, code in FORMS.items())
    return Section(f"from Python: rhs | {YARDSTICK}", rows)


def _row(
    what: str, code: str, compiled: Compiled, points: Points, in_c: float, settings: Settings
) -> Row:
    names = {"np": np, "rhs": compiled.rhs, "t": 0.0, "x": points.x[0].copy(), "p": points.p}
    names |= {"u": points.u, "out": points.dx}
    ours, theirs = _sampler(code, names), _sampler(YARDSTICK, names)
    count = 50 if settings.quick else 200
    value, limit, target = _judged(settings.quick)
    pairs = settled(lambda: paired(ours, theirs, count), value, limit)
    mine, other = (time_text(s) for s in pairs.best)
    mine += f" ({pairs.best[0] / in_c:.0f} x {time_text(in_c)} in C)"
    if native.python_headers() is None:
        return Row(f"{what}, without Python.h", mine, other, f"{pairs.ratio:.2f}")
    return Row(what, mine, other, f"{pairs.ratio:.2f}", target, value(pairs) <= limit)


def _judged(quick: bool) -> tuple[Callable[[Pairs], float], float, str]:
    """Return what is judged, its limit and how that reads: a ratio if quick, else the time."""
    if quick:
        return _ratio, LARGEST_RATIO, f"ratio <= {LARGEST_RATIO}"
    return _least, LONGEST_SECONDS, f"<= {time_text(LONGEST_SECONDS)}"


def _ratio(pairs: Pairs) -> float:
    return pairs.ratio


def _least(pairs: Pairs) -> float:
    return pairs.best[0]


def _sampler(code: str, names: dict[str, Any]) -> Sample:
    timer = Timer(code, globals=names)
    return lambda: timer.timeit(CALLS) / CALLS
