"""Instructions of generated right-hand sides beside hand-written C, and the overhead of a call.

Counts do not depend on the machine's mood; they need valgrind. The overhead of a call is what a
call from Python takes more than the function alone in C.
"""

from __future__ import annotations

from timeit import Timer

import numpy as np

from benchmarks import instructions
from benchmarks.calls import CALLS, chain
from benchmarks.native_rates import HANDWRITTEN, Points, Rates, sampler
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen import compile as compile_system
from codegen.native import native
from eom.scenes.scene import Scene

LARGEST_RATIO = 1.0
QUICK_RATIO = 1.15
"""The short form guards against regressions, whatever compiler there is."""
LONGEST_OVERHEAD = 0.5e-6
REPEATS = 200


def measure(settings: Settings) -> Section:
    """Return one row a scene that is written by hand, and one for the overhead unless quick."""
    rows = [] if settings.quick else [_overhead()]
    if not instructions.available():
        rows.append(Row("instructions", "not counted", "valgrind is missing"))
    else:
        limit = QUICK_RATIO if settings.quick else LARGEST_RATIO
        rows += [_row(name, limit) for name in HANDWRITTEN]
    return Section("instructions a call: generated | hand-written", tuple(rows))


def _row(name: str, limit: float) -> Row:
    compiled = compile_system(Scene.ready(name).derive(), "c")
    ours = instructions.per_call(Rates.generated(compiled))
    theirs = instructions.per_call(Rates.handwritten(name))
    if ours is None or theirs is None:
        return Row(name, "not counted", "valgrind does not know this machine's instructions")
    ratio = ours / theirs
    return Row(name, str(ours), str(theirs), f"{ratio:.3f}", f"<= {limit}", ratio <= limit)


def _overhead() -> Row:
    compiled = compile_system(chain(), "c")
    what = "overhead of a call from Python, 8 states"
    if native.python_headers() is None:
        return Row(what, "not measured", "Python.h is missing")
    points = Points.of(compiled)
    x, out = points.x[0].copy(), np.empty(points.x.shape[1])
    names = {"rhs": compiled.rhs, "x": x, "p": points.p, "u": points.u, "out": out}
    timer = Timer("rhs(0.0, x, p, u, out=out)", globals=names)
    call = min(timer.timeit(CALLS) for _ in range(REPEATS)) / CALLS
    inside = min(sampler(Rates.generated(compiled), points)() for _ in range(REPEATS))
    target = f"<= {time_text(LONGEST_OVERHEAD)}"
    cells = (time_text(call - inside), f"{time_text(inside)} in C")
    return Row(what, *cells, "", target, call - inside <= LONGEST_OVERHEAD)
