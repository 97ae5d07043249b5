"""The size that each state is measured by, from which default absolute tolerances follow.

An absolute tolerance says which size of a state counts as zero. By default it is the relative tolerance
times `PART` of the state's scale, so that it changes with the unit that a state is written in, and a
state of size 1e-12 is held as well as one of size 1 beside it. The scale is

* of a state that starts somewhere else than at zero its first value;
* of a state that starts at zero what its rate makes of it in a time in which no group of states of one
  unit, and no growth, changes by more than its own size: found by Euler's method as an iteration
  (Picard's), so that a chain of integrators grows one link a turn;
* where nothing makes it grow, the largest scale of its unit, of which then the last digits count;
* else not known.

Where nothing makes the derivative of a state by a parameter or a first state grow
(`codegen.sensitivities`), its scale is that of the state over that of the variable, a parameter's being
its value: the absolute tolerance of dx/dp is then that of x over |p|. Its own growth goes before, so that
a small derivative keeps its digits; and no time of growth is shortened by it, as dx/dp may be much larger
than x/p (of a body that hovers x is small, and any change moves it), nor by what is small beside it.

A rate that is rounding of larger terms is no growth: what changes as a whole where the states change by
1e-6 of themselves holds no digit, or is so sensitive that it says nothing of a size. The same is asked
where a first value is below 1e-14 of others of its unit, as cos(pi/2) is.

Sources: the first step of Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993),
sect. II.4, compares sizes and rates likewise; they choose the scale of each component by hand. Tolerances
of sensitivities over the size of the parameter: Serban and Hindmarsh, CVODES: the Sensitivity-Enabled
ODE Solver in SUNDIALS (2005); Maly and Petzold, Appl. Numer. Math. 20 (1996) 57.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled
from codegen.frontend.layout import Layout
from codegen.native import native
from codegen.native.trajectory import Array

PART = 1e-3
"""What counts as zero is this part of a scale, times the relative tolerance."""
LEAST = 1e-150
"""Absolute tolerances are at least this, so that squares of errors over them are finite."""
RESIDUE = 2.0**-46
"""A first value below this part of others of its unit may be what rounding left of zero."""
ROUNDED = 2.0**-48
"""Errors below this part of the others of its unit do not count in a state that does not grow."""
MOVED, STEADY = 2.0**-20, 2.0**-8
"""A rate is more than rounding if a relative change by the first changes it by the second at most."""
LOOKS, GOLDEN = 6, 0.6180339887498949
"""Neighbours of a point at which its rates are looked at, and by what share of a turn they go on."""
DOUBTFUL = 2.0**-26
"""Growth by less than this part of others of its unit may be rounding."""
DEPTH, SHORTER, TURNS = 4, 8.0, 40
"""Iterations of Picard's; the factor by which the time is shortened, and how often at most."""

FEW = 5
"""Names that a notice lists."""

Rates = Callable[[Array, Array], Array]
"""Rates (n, N) at times (N,) and states (n, N)."""
Places = NDArray[np.intp]
Moment = tuple[Array, Array]
"""Times (N,) and states (n, N)."""


class Point(NamedTuple):
    """Where a run starts: states, parameters, inputs, and the time of the system at which t is zero."""

    states: Array
    parameters: Array
    inputs: Array
    epoch: float


@dataclass(frozen=True)
class Scales:
    """Scales (n, N) of states, NaN where none is known, and the largest of each one's unit (n, N)."""

    values: Array
    largest: Array
    grows: NDArray[np.bool_]
    """Where the scale is a first value, a growth or given, (n, N)."""

    def tolerances(self, rtol: float) -> Array:
        """Return default absolute tolerances (n, N); where no scale is known that of a scale of 1."""
        plain = PART * rtol * np.where(np.isnan(self.values), 1.0, self.values)
        rounding = np.minimum(plain, ROUNDED * self.largest)
        return np.maximum(np.where(self.grows | (self.largest == 0), plain, rounding), LEAST)


def scales(
    rates: Rates,
    units: Sequence[str],
    start: Array,
    t_span: tuple[float, float],
    otherwise: Array | None = None,
) -> Scales:
    """Return the scales of states that start at ``start`` (n, N) and run over ``t_span`` (s).

    ``units``: of each state; of those without one, "", nobody knows whether they can be compared, and
    each has a time of its own. ``otherwise`` (n, N): scales of states that do not grow, 0 for none.
    No column depends on another one.
    """
    size = np.abs(start)
    largest = _largest(units, size)
    small = size <= RESIDUE * largest
    if not small.any():
        return Scales(size, largest, ~small)
    alone = np.array([u == "" for u in units])[:, None]
    bounds = np.where(alone, size, largest)
    wanted = np.asarray(small.any(axis=0))
    beside = np.zeros_like(size) if otherwise is None else _largest(units, otherwise)
    grown = _growth(rates, start, (bounds, largest, beside), t_span, wanted)
    own = np.where(small, np.where(grown > 0, np.maximum(grown, size), 0.0), size)
    if otherwise is not None:
        own = np.where(own > 0, own, otherwise)
    shared = _largest(units, own)
    known = np.where(shared > 0, shared, np.nan)
    return Scales(np.where(own > 0, own, known), shared, own > 0)


class Slopes(NamedTuple):
    """Where derivatives are among states: their places, those of what is differentiated, and by what.

    ``by``: places among the states, followed by the parameters, and by what is not known. ``own``: the
    places of the states that are no derivatives.
    """

    place: Places
    of: Places
    by: Places
    own: Places


def slopes_of(layout: Layout) -> Slopes | None:
    """Return where derivatives are among the states of a layout; None without any.

    Those whose state was left out are not among them.
    """
    number = {q.name: k for k, q in enumerate(layout.states)}
    known = [(k, s) for n, k in number.items() if (s := layout.slopes.get(n)) and s.of in number]
    if not known:
        return None
    below = {q.name: k for k, q in enumerate(layout.parameters, len(number))}
    last = len(number) + len(below)
    by = [(below if s.by_parameter else number).get(s.by, last) for _, s in known]
    own = [k for n, k in number.items() if n not in layout.slopes]
    columns = [k for k, _ in known], [number[s.of] for _, s in known], by, own
    return Slopes(*(np.array(column, dtype=np.intp) for column in columns))


def of_slopes(
    rates: Rates, layout: Layout, start: Point, t_span: tuple[float, float]
) -> Array | None:
    """Return the scales (n, N) of derivatives among the states, should they not grow; None without any.

    ``start``: states (n, N), parameters (m,) or (m, N). 0 of states that are no derivatives, and where a
    scale is not known or what is differentiated was left out.
    """
    slopes = slopes_of(layout)
    if slopes is None:
        return None
    own, whole = slopes.own, start.states

    def alone(t: Array, x: Array) -> Array:
        everything = whole.copy()
        everything[own] = x
        return np.asarray(rates(t, everything)[own])

    known = np.full_like(whole, np.nan)
    known[own] = scales(alone, [layout.states[k].unit for k in own], whole[own], t_span).values
    return over_variables(slopes, layout, known, start.parameters)


def over_variables(slopes: Slopes, layout: Layout, known: Array, parameters: Array) -> Array:
    """Return the scales (n, N) of states over those of variables; 0 where one is not known.

    ``known`` (n, N): scales of states, NaN for none. A parameter (m,) or (m, N) has that of its size, or
    the largest of its unit where that is zero.
    """
    count = known.shape[1]
    values = np.abs(parameters)
    values = values[:, None] if values.ndim == 1 else values
    sizes = np.broadcast_to(values, (len(values), count))
    if (sizes == 0).any():
        units = [q.unit or f"of {q.name} alone" for q in layout.parameters]
        sizes = np.where(sizes > 0, sizes, _largest(units, sizes))
    scale = np.vstack([known, sizes, np.full((1, count), np.nan)])
    found = np.zeros_like(known)
    with np.errstate(all="ignore"):
        found[slopes.place] = scale[slopes.of] / scale[slopes.by]
    return np.where(np.isfinite(found), found, 0.0)


def _largest(units: Sequence[str], size: Array) -> Array:
    """Return the largest size of a state of the same unit, (n, N)."""
    number = {unit: k for k, unit in enumerate(dict.fromkeys(units))}
    group = np.array([number[u] for u in units], dtype=np.intp)
    largest = np.zeros((len(number), size.shape[1]))
    np.maximum.at(largest, group, size)
    return np.asarray(largest[group])


def _growth(
    rates: Rates,
    start: Array,
    bounds: tuple[Array, Array, Array],
    t_span: tuple[float, float],
    wanted: NDArray[np.bool_],
) -> Array:
    """Return how far each state goes at first, (n, N); 0 where it does not, or by rounding alone.

    ``bounds``: by how much a state may change, the largest of its unit, beside which it may be rounding,
    and what its growth may change by at least. ``wanted`` (N,): the columns that need it; the others are
    not waited for.
    """
    allowed, largest, beside = bounds
    direction = np.sign(t_span[1] - t_span[0])
    with np.errstate(all="ignore"):
        slope = rates(np.full(start.shape[1], t_span[0]), start)
        length = _at_most(slope, allowed, t_span)
        for _ in range(TURNS):
            slopes = _iterated(rates, (start, slope, largest), t_span, direction * length)
            slope, fits = slopes[0], _fits(slopes, length, allowed, beside) | ~wanted
            if fits.all():
                break
            length = np.where(fits, length, length / SHORTER)
        return _first_growth(slopes, np.where(fits, length, 0.0))


def _first_growth(slopes: Array, length: Array) -> Array:
    """Return the growth of each state in the first iteration in which it has one, (n, N), or 0."""
    grown: Array = np.zeros_like(slopes[0])
    for slope in slopes:
        new = length * np.abs(slope)
        grown += np.where((grown == 0) & np.isfinite(new), new, 0.0)
    return grown


def _is_doubtful(growth: Array, largest: Array) -> NDArray[np.bool_]:
    """Return where a growth may be rounding: small beside others of its unit, or beside nothing."""
    return np.asarray((growth > 0) & (growth <= DOUBTFUL * np.where(largest > 0, largest, np.inf)))


def _without_rounding(rates: Rates, at: Moment, slope: Array, beside: tuple[Array, Array]) -> Array:
    """Return rates at a moment, 0 where they are rounding: that has no part in any growth.

    ``beside``: the length (N,) of growth, and the largest of each unit.
    """
    length, largest = beside
    doubtful = _is_doubtful(length * np.abs(slope), largest)
    if not doubtful.any():
        return slope
    return np.where(doubtful & ~_steady(rates, *at, slope), 0.0, slope)


def _at_most(slope: Array, largest: Array, t_span: tuple[float, float]) -> Array:
    """Return a time (N,) in which rates as at first change no group by much more than its size.

    It may be longer than the run; where all groups with a size are at rest it is that of the run.
    """
    pace = np.max(np.where(largest > 0, np.abs(slope) / largest, 0.0), axis=0)
    span = abs(t_span[1] - t_span[0])
    return np.where((pace > 0) & np.isfinite(SHORTER / pace), SHORTER / pace, span)


def _iterated(
    rates: Rates, begun: tuple[Array, Array, Array], t_span: tuple[float, float], step: Array
) -> Array:
    """Return the rates in Picard's iteration, each with Euler's rule, without those that are rounding.

    ``begun``: states and rates at the start, and the largest of each unit. Times are those of the run:
    where the step is longer they are its end.
    """
    start, slope, largest = begun
    begin, end = np.full(len(step), t_span[0]), t_span[1]
    then = np.where(np.abs(step) < abs(end - begin), begin + step, end)
    beside = np.abs(step), largest
    slopes = [_without_rounding(rates, (begin, start), slope, beside)]
    for _ in range(DEPTH - 1):
        moment = then, start + step * slopes[-1]
        slopes.append(_without_rounding(rates, moment, rates(*moment), beside))
    return np.array(slopes)


def _fits(slopes: Array, length: Array, largest: Array, beside: Array) -> NDArray[np.bool_]:
    """Return of each column whether the time is short: no state changes its growth by more than itself.

    What changes it by less than ``beside`` does not count.
    """
    allowed = largest + length * np.abs(slopes[:-1])
    change = length * np.abs(np.diff(slopes, axis=0))
    short = (change <= allowed) | (change <= beside)
    return np.asarray(np.all(short | (allowed == 0), axis=(0, 1)))


def _steady(rates: Rates, t: Array, x: Array, slope: Array) -> NDArray[np.bool_]:
    """Return where rates hold at least a few digits: `LOOKS` neighbours of a point agree with it."""
    steady = np.ones(x.shape, dtype=np.bool_)
    for look in range(1, LOOKS + 1):
        apart = 2.0 * ((GOLDEN * look * np.arange(1, len(x) + 1)) % 1.0) - 1.0
        change = np.abs(rates(t, x * (1.0 + MOVED * apart[:, None])) - slope)
        steady &= change <= STEADY * np.abs(slope)
    return steady


def defaults(
    rates: Rates, layout: Layout, start: Point, t_span: tuple[float, float], rtol: float
) -> tuple[Array, str]:
    """Return default absolute tolerances of states (n, N) of a start, and what to report."""
    units, otherwise = [q.unit for q in layout.states], of_slopes(rates, layout, start, t_span)
    found = scales(rates, units, start.states, t_span, otherwise)
    unknown = [
        q.name for q, row in zip(layout.states, found.values, strict=True) if np.isnan(row).any()
    ]
    return found.tolerances(rtol), _notice(unknown, rtol) if unknown else ""


def of_run(
    compiled: Compiled,
    start: Point,
    t_span: tuple[float, float],
    rtol: float,
    signals: Callable[[float, Array], Array] | None,
) -> tuple[Array, str]:
    """Return default absolute tolerances (n,) of a run, and what to report.

    ``signals``: inputs over time and state, where they are functions.
    """
    quick = None if signals is not None else quickly(compiled, t_span, rtol, start.epoch)
    at_once = None if quick is None else quick(start.states, start.parameters, start.inputs)
    if at_once is not None:
        return at_once

    def rates(t: Array, x: Array) -> Array:
        now, state = start.epoch + float(t[0]), np.ascontiguousarray(x[:, 0])
        u = start.inputs if signals is None else signals(float(t[0]), state)
        return compiled.rhs(now, state, start.parameters, u)[:, None]

    columns = start._replace(states=start.states[:, None])
    found, notice = defaults(rates, compiled.layout, columns, t_span, rtol)
    return found[:, 0], notice


Quickly = Callable[[Array, Array, Array], tuple[Array, str] | None]
"""From states, parameters and inputs to tolerances and what is to be reported; None for misfits."""


def quickly(
    compiled: Compiled, t_span: tuple[float, float], rtol: float, epoch: float
) -> Quickly | None:
    """Return the same for many runs, in one call each (`codegen/native/runs.c`), to the last bit.

    ``epoch``: time of the system at which t is zero. None without C, and where derivatives stand before
    the states that they are of.
    """
    extension = native.extension() if compiled.target == "c" else None
    slopes = _derived(compiled, "slopes", lambda: slopes_of(compiled.layout))
    count = 0 if slopes is None else len(slopes.own)
    if extension is None or (slopes is not None and not np.array_equal(slopes.own, range(count))):
        return None
    units, alone = units_of(compiled)
    rates, call, layout, n = (
        compiled.rhs,
        extension.scales,
        compiled.layout,
        len(compiled.layout.states),
    )
    how = (units, alone, *t_span, epoch, rtol)

    def otherwise(at: tuple[Array, Array, Array]) -> Array | None:
        known = np.full((n, 1), np.nan)
        if slopes is None or call(rates, *at, *how, known[:count, 0], None) is None:
            return None
        return over_variables(slopes, layout, known, at[1])[:, 0]

    def tolerances(x: Array, p: Array, u: Array) -> tuple[Array, str] | None:
        found = np.empty(n)
        of_others = otherwise((x, p, u)) if count else found[:0]
        unknown = None if of_others is None else call(rates, x, p, u, *how, found, of_others)
        if not unknown:
            return None if unknown is None else (found, "")
        return found, _notice([layout.states[k].name for k in unknown], rtol)

    return tolerances


def _derived(compiled: Compiled, name: str, make: Callable[[], Any]) -> Any:
    """Return what is made of a compiled system once."""
    if (name,) not in compiled.derived:
        compiled.derived[(name,)] = make()
    return compiled.derived[(name,)]


def units_of(compiled: Compiled) -> tuple[bytes, int]:
    """Return the units of states as generated code has them, made once; see `_numbered`."""
    states = compiled.layout.states
    found: Any = _derived(compiled, "units of states", lambda: _numbered([q.unit for q in states]))
    units, alone = found
    return units, alone


def _numbered(units: Sequence[str]) -> tuple[bytes, int]:
    """Return the number of each unit as integers of C, and that of states without one, or -1."""
    number = {unit: k for k, unit in enumerate(dict.fromkeys(units))}
    return np.array([number[u] for u in units], dtype=np.intc).tobytes(), number.get("", -1)


def _notice(names: Sequence[str], rtol: float) -> str:
    few = ", ".join(names[:FEW]) + (f" and {len(names) - FEW} more" if len(names) > FEW else "")
    verb, whose = ("starts", "its") if len(names) == 1 else ("start", "their")
    return (
        f"no scale is known for {few}, which {verb} at zero and at rest: {whose} absolute tolerance "
        f"is {PART * rtol:.1e} in {whose} own unit; give atol if that is not small"
    )
