"""Motions in closed form: time for one instant, in NumPy and in C, and errors beside 50 digits.

Beside the torque-free body stands SciPy's ``ellipj`` at the same phases, which gives the angular velocity
alone, of phases that are not reduced; the short form judges by sines of as many numbers. Errors
are those at phases drawn up to 1e3 rad, and at 1e9 rad, beside Legendre's integrals and sn, cn, dn of
mpmath (`tests.codegen.test_exact`, `tests.codegen.test_closed_forms`).
"""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import partial
from typing import Any

import mpmath
import numpy as np
from scipy.special import ellipj

import codegen
import eom
from benchmarks.pairs import Pairs, paired, seconds, settled
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen.closed import closed_forms
from codegen.closed.closed_forms import Closed, find
from codegen.native import native
from codegen.native.trajectory import Problem
from eom.mechanics.rigidbody import heavy_top

SEPARATRIX = "on the separatrix"
"""Its oracle is a Taylor series, in the tests: Legendre's integrals are infinite there."""
MOMENTS = (1.5e-4, 4.0e-4, 5.2e-4)
MOTIONS = {
    "T-handle, m near 1": (MOMENTS, (0.05, 10.0, 0.05)),
    "m below 1/2": (MOMENTS, (1.0, 0.3, -2.0)),
    SEPARATRIX: ((3.0, 2.0, 1.5), (1.0, 0.3, -2.0)),
    "two equal moments": ((1.0, 1.0, 1.5), (1.0, 0.3, -2.0)),
}
BESIDE = {
    "nearly symmetric, 1e-15": ((1.0, 1 + 1e-15, 1.5), (1.0, 0.3, -2.0)),
    "1e-14 off the separatrix": ((3.0, 2.0, 1.5), (1.0, 0.3, -2.0 * (1 + 1e-14))),
    "ratio 1e-12": ((1e-12, 1.0, 1 + 1e-13), (1.0, 0.3, -2.0)),
    "ratio 1e12": ((1e12, 1.0, 1e12 + 0.5), (1e-9, 0.3, 2e-9)),
}
TOPS = {
    "top, m below 1/2": (2.0, 0.3, (0.1, 0.2, 20.0), (0.8, 0.6, 0.0, 0.0)),
    "top, m near 1": (2.0, 0.3, (0.3, 0.2, 0.4), (0.9, 0.1, 0.3, -0.2)),
}
ATTITUDE = (0.5, -0.1, 0.7, 0.5)
PARAMETER = 0.9
LONGEST_SECONDS = 1e-6
LARGEST_RATIO = 40.0
"""Of the closed form to ``np.sin``, both for one number of a long array."""
RATES, TURN = 1e-14, 1e-13
"""Largest errors: of the angular velocity beside its size, and of the attitude, rad."""
SAMPLES = 12
Oracle = Callable[..., Any]


def measure(settings: Settings) -> Section:
    """Return rows of times, and of errors in the long form."""
    rows = [row for what in (*MOTIONS, *TOPS) for row in _times(what, settings.quick)]
    if not settings.quick:
        rows += [_error(what) for what in (*MOTIONS, *BESIDE, *TOPS) if what != SEPARATRIX]
    beside = "np.sin" if settings.quick else "ellipj"
    return Section(f"closed forms, an instant | {beside}", tuple(rows))


def _closed(what: str) -> Closed:
    """Return the closed form that is found in the system."""
    if what in TOPS:
        mu, ratio, omega, q = TOPS[what]
        system, values = heavy_top("quaternion"), [1.0, 1.0, ratio, 1.0, mu, 1.0]
    else:
        moments, omega = {**MOTIONS, **BESIDE}[what]
        system, values, q = eom.free_rigid_body("quaternion"), list(moments), ATTITUDE
    compiled = codegen.compile(system, "numpy")
    start = np.array([*omega, *_unit(q)])
    nothing = np.zeros(0)
    names = compiled.layout.parameters
    assert len(names) == len(values)
    problem = Problem(start, (0.0, 1.0), np.array(values), nothing, 1e-9, start, 1e-6, 0)
    closed = find(compiled, problem)
    assert closed is not None
    return closed


def _unit(q: Any) -> Any:
    return np.array(q) / np.linalg.norm(q)


def _times(what: str, quick: bool) -> list[Row]:
    closed = _closed(what)
    t = np.linspace(-1e3, 1e3, 100_000 if quick else 1_000_000)
    forms: dict[str, Callable[[Any], Any]] = {"NumPy": closed.states}
    if native.compiler():
        forms["C"] = closed_forms.loaded(closed)
    return [_time(f"{what}, {name}", form, t, quick) for name, form in forms.items()]


def _time(what: str, form: Callable[[Any], Any], t: Any, quick: bool) -> Row:
    ours = partial(seconds, partial(form, t))
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


def _error(what: str) -> Row:
    """Return the largest errors at phases up to 1e3 rad, and those at 1e9 rad beside."""
    closed = _closed(what)
    fastest = closed.motion.fastest
    draw = random.Random(what)
    near = [draw.uniform(-1e3, 1e3) / fastest for _ in range(SAMPLES)]
    errors = [_errors(closed, what, times) for times in (near, [1e9 / fastest])]
    met = errors[0][0] <= RATES and errors[0][1] <= TURN
    ours, beside = (f"{w:.1e}, {q:.1e} rad" for w, q in errors)
    target = f"<= {RATES:g}, {TURN:g} rad"
    return Row(f"{what}: error to 1e3 rad | at 1e9 rad", ours, beside, "", target, met)


def _errors(closed: Closed, what: str, times: list[float]) -> tuple[float, float]:
    oracle, data = _oracle(what)
    forms = [closed.states, *([closed_forms.loaded(closed)] if native.compiler() else [])]
    worst = [0.0, 0.0]
    with mpmath.workdps(90):
        for t in times:
            w, q = oracle(*data, t)
            size = mpmath.sqrt(sum(v * v for v in w))
            for form in forms:
                x = form(np.array([t]))[:, 0]
                off = [mpmath.mpf(a) - b for a, b in zip(x[:3], w, strict=True)]
                turned = [
                    sum((s * mpmath.mpf(a) - b) ** 2 for a, b in zip(x[3:], q, strict=True))
                    for s in (1, -1)
                ]
                found = mpmath.sqrt(sum(v * v for v in off)) / size, 2 * mpmath.sqrt(min(turned))
                worst = [max(a, float(b)) for a, b in zip(worst, found, strict=True)]
    return worst[0], worst[1]


def _oracle(what: str) -> tuple[Oracle, tuple[Any, ...]]:
    from tests.codegen.test_closed_forms import legendre_top
    from tests.codegen.test_exact import legendre

    if what in TOPS:
        mu, ratio, omega, q = TOPS[what]
        return legendre_top, (mu, ratio, omega, _unit(q))
    moments, omega = {**MOTIONS, **BESIDE}[what]
    return legendre, (moments, omega, _unit(ATTITUDE))
