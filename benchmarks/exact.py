"""The torque-free body in closed form: time for one instant, angular velocity and attitude.

Beside it SciPy's ``ellipj`` at the same phases, which gives the angular velocity alone, of phases that
are not reduced; the short form judges by sines of as many numbers.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.special import ellipj

from benchmarks.pairs import Pairs, paired, seconds, settled
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen import free_motion

MOMENTS = (1.5e-4, 4.0e-4, 5.2e-4)
MOTIONS = {
    "T-handle, m near 1": (MOMENTS, (0.05, 10.0, 0.05)),
    "m below 1/2": (MOMENTS, (1.0, 0.3, -2.0)),
    "on the separatrix": ((3.0, 2.0, 1.5), (1.0, 0.3, -2.0)),
    "two equal moments": ((1.0, 1.0, 1.5), (1.0, 0.3, -2.0)),
}
PARAMETER = 0.9
LONGEST_SECONDS = 1e-6
LARGEST_RATIO = 40.0
"""Of the closed form to ``np.sin``, both for one number of a long array."""


def measure(settings: Settings) -> Section:
    """Return one row a kind of motion."""
    beside = "np.sin" if settings.quick else "ellipj"
    rows = tuple(_row(what, settings.quick) for what in MOTIONS)
    return Section(f"torque-free body, an instant in NumPy | {beside}", rows)


def _row(what: str, quick: bool) -> Row:
    motion = free_motion(*MOTIONS[what])
    t = np.linspace(-1e3, 1e3, 100_000 if quick else 1_000_000)
    ours = partial(seconds, partial(motion, t))
    theirs = partial(seconds, partial(np.sin, t) if quick else partial(ellipj, t, PARAMETER))
    value, limit = (_ratio, LARGEST_RATIO) if quick else (partial(_least, t.size), LONGEST_SECONDS)
    pairs = settled(lambda: paired(ours, theirs, 7), value, limit)
    mine, other = (time_text(s / t.size) for s in pairs.best)
    target = f"ratio <= {limit:g}" if quick else f"<= {time_text(limit)}"
    return Row(what, mine, other, f"{pairs.ratio:.2f}", target, value(pairs) <= limit)


def _ratio(pairs: Pairs) -> float:
    return pairs.ratio


def _least(count: int, pairs: Pairs) -> float:
    return pairs.best[0] / count
