"""Events in generated C: zeros of the user's expressions, by isolating the roots of polynomials.

In each step every expression is a polynomial. Method taylor has its Taylor coefficients, by the same
recurrences as those of the states; where these converge too slowly, and for other methods, it goes
through values at Chebyshev's points of the dense output, over halves of the step, and halves of these,
until it is right between the points. What values at some points may hide, a wave or a pulse between them,
is excluded by bounds: over each part the argument of every operation moves by its reach at most
(`codegen.watch.trust`, `narrow.steady`, from bounds of the states by intervals); a step whose parts are not
that short is made shorter. All polynomials have the values of the expression itself at both
ends, so that the step before and the step after agree about signs there, and nothing is lost or found
twice. With method taylor most steps are left at once, since the coefficients bound the polynomial (as
Biscani and Izzo do, Monthly Notices of the RAS 504 (2021)); the roots of the others are isolated in
Bernstein form (`roots.c`, `touches.c`), and crossings are taken to a zero of the expression itself.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache, lru_cache
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.program import Program
from codegen.loops import lookout
from codegen.native.trajectory import Array, Found, Problem
from codegen.watch.narrow import VERDICT, Steady, steady
from eom.fields import RATIONALS, solved

GROUP = "events"
"""Group of results of a program: the expressions of the events, then the sizes of their terms."""
DEGREE = 10
"""Of the polynomials through values of the dense output; it is even, so that one is in the middle."""
HALVES = 8
"""How often a step is halved at most where an expression varies too much for one polynomial."""
FLAT = 128
"""Functions within exp(-128) of a constant hide nothing: also where they are multiplied by 1e40."""
NONE = dict.fromkeys(
    ("EVENT_STATUS", "EVENT_TYPE", "EVENT_FIELDS", "EVENT_USE", "EVENT_BEGIN", "CROSSINGS", "EVENT_START",
     "EVENT_ROOM", "EVENT_JET", "EVENT_DENSE", "STOP_BEGIN", "STOP_END", "QUICK_STEP", "QUICK_SERIES"),
    "",
) | {
    "DENSE_LATER": "        if (needs_dense || possible) prepare_dense(s, k, h, x_new, u);\n"
}  # fmt: skip
"""What stands in the templates of a loop without events; `STOPPED` is then a singularity."""


def count_of(layout: Layout) -> int:
    """Return the number of events of a layout."""
    names: tuple[str, ...] = layout.results.get(GROUP, ())
    return len(names) // 2


def sizes(program: Program, layout: Layout) -> tuple[int, int]:
    """Return the number of events, and of values that their bounds keep in the structure of a loop."""
    looks = looks_of(program, layout).program
    return count_of(layout), 0 if looks is None else _kernel(looks, "")[1]


def _kernel(looks: Program, prefix: str) -> tuple[list[str], int]:
    lines, constants = lookout.kernel(looks, VERDICT, f"{prefix}_looks")
    return lines, max(1, constants)


def looks_of(program: Program, layout: Layout) -> Steady:
    """Return whether operations of the events keep their character, for the states and times of a box.

    Where they do, a polynomial of degree `DEGREE` through values of an event is near it also between these,
    or the further values that are looked at show that it is not.
    """
    values = program.results.get(GROUP, ())[: count_of(layout)]
    return _looks_once(program, values, len(layout.states))


@lru_cache(maxsize=64)
def _looks_once(program: Program, values: tuple[int, ...], n: int) -> Steady:
    return steady(program, values, n, DEGREE, FLAT)


def silent(state: Any, problem: Problem) -> str:  # noqa: ARG001 - as of all that give notices
    """Return nothing: a loop that has nothing to tell."""
    return ""


def notice(program: Program, layout: Layout) -> Callable[[Any, Problem], str]:
    """Return what warns of a run whose events may have zeros that are not found, and why."""
    labels = layout.results.get(GROUP, ())[: count_of(layout)]
    if not labels:
        return silent
    blind = [labels[m] for m in looks_of(program, layout).unbounded]
    always = [
        f"event {n} has no bounds between values: zeros in pairs may be missed" for n in blind
    ]

    def of_run(state: Any, problem: Problem) -> str:
        when = f"at t = {problem.time_text(state.quick_at)}"
        quick = f"events vary too quickly, or are not finite, {when}: zeros may be missed"
        return "; ".join([*always, *([quick] if state.quick else [])])

    return of_run


def most(layout: Layout) -> int:
    """Return for how many roots of a step there must be room; there are never more (`roots_of`)."""
    return count_of(layout) * (2 * DEGREE + 2) << HALVES


# --- texts -----------------------------------------------------------------------------------------


def of_taylor(program: Program, layout: Layout, prefix: str, order: int) -> dict[str, str]:
    """Return what the templates of method taylor need."""
    own = {
        "EVENT_POLYNOMIAL": _template("crossings_taylor.c"),
        "EVENT_BOX": _template("box_taylor.c"),
        "BINOMIALS": ", ".join(f"{math.comb(order, k)}.0" for k in range(order + 1)),
        "EVENT_OWN": f"    double event_jet[{order}][{count_of(layout)}]; /* Taylor coefficients */\n",
    }
    return _texts(program, layout, prefix, max(order, DEGREE), own)


def of_values(program: Program, layout: Layout, prefix: str) -> dict[str, str]:
    """Return what the templates of methods with other dense output need."""
    own = {
        "EVENT_POLYNOMIAL": _template("crossings_values.c"),
        "EVENT_BOX": _template("box_values.c"),
        "EVENT_OWN": "",
    }
    return _texts(program, layout, prefix, DEGREE, own)


def _texts(
    program: Program, layout: Layout, prefix: str, degree: int, own: Mapping[str, str]
) -> dict[str, str]:
    if not count_of(layout):
        return {**NONE, "STOPPED": f"{prefix.upper()}_SINGULAR"}
    nodes, rows = interpolation(DEGREE)
    looks = looks_of(program, layout).program
    lines, constants = ([], 0) if looks is None else _kernel(looks, prefix)
    values = {
        **own,
        "NAME": identifier(layout.name),
        "PREFIX": prefix,
        "UPPER": prefix.upper(),
        "STATES": str(len(layout.states)),
        "EVENT_COUNT": str(count_of(layout)),
        "EVENT_ROOM_DEGREE": str(degree),
        "EVENT_POINTS": str(DEGREE + 1),
        "EVENT_HALVES": str(HALVES),
        "NODES": ", ".join(map(repr, nodes)),
        "MATRIX": ",\n        ".join(f"{{{', '.join(map(repr, row))}}}" for row in rows),
        "ROUNDING": f"{2.0**-52 * max(sum(map(abs, row)) for row in rows):.0e}",
        "EVENT_MOST": str(most(layout)),
        "EVENT_LIST": "\n".join(f" *   {k}: {comment(text)}" for k, text in
                                enumerate(layout.results[GROUP][: count_of(layout)])),
        "PROJECT_EVENT": "    project_point(s, t, y, u);\n" if "projection" in layout.results else "",
        "ROOTS": _template("roots.c") + _template("touches.c"),
        "LOOKED": str(int(looks is not None)),
        "LOOKS": "\n".join(lines),
        "LOOKS_FIELD": f"    double of_looks[{constants}];\n" if constants else "",
        "SAMPLES": ", ".join(repr((1 - math.cos(math.pi * k / degree)) / 2) for k in range(degree + 1)),
        "LEBESGUE": repr(round(1 + 2 / math.pi * math.log(degree + 1), 3)),
    }  # fmt: skip
    places = _PLACES | (_STILL if looks is None else _QUICK)
    return {key: _filled(text, values) for key, text in places.items()}


_QUICK = {
    "QUICK_STEP": """\
        prepare_dense(s, k, h, x_new, u);
        if (is_too_quick(s, h, u)) {
            s->h = 0.5 * fabs(h);
            s->rejected += 1;
            s->after_rejection = 1;
            continue;
        }
""",
    "DENSE_LATER": "        (void)needs_dense;\n",
    "EVENT_START": """\
    start_events(s, u);
    @PREFIX@_looks_constants(p, 1, s->of_looks);
""",
    "QUICK_SERIES": "            if (shorter == 1.0 && is_too_quick(s, h, u)) shorter = 0.5;\n",
}
"""What makes a step shorter in which events vary too quickly for all its parts."""
_STILL = {**{k: NONE[k] for k in _QUICK}, "EVENT_START": "    start_events(s, u);\n"}
"""The same for events that are polynomials."""
_PLACES = {
    "EVENT_STATUS": '    @UPPER@_EVENT = 5,           /* terminal event number "which" is at time t */\n',
    "EVENT_USE": """\
 *
 * Events, zeros of expressions, are reported in found[found_room], which is the caller's, with at least
 * @UPPER@_EVENTS_A_STEP places; found_count is 0 at first. Where too few are left run returns
 * FULL: read them, and set found_count to 0. event_direction[k] is 1 or -1 for crossings upwards or
 * downwards in the direction of integration alone, 0 for all zeros; the run ends at the event_stop[k]-th
 * of them, never if that is 0. The events are
@EVENT_LIST@
""",
    "EVENT_TYPE": """\
enum { @UPPER@_EVENTS_A_STEP = @EVENT_MOST@ };
/* Event number which at time t and state x; direction 1 up, -1 down, 0 where zero is touched. */
typedef struct {
    double t, x[@STATES@];
    int which, direction;
} @PREFIX@_event;

""",
    "EVENT_FIELDS": """\
    @PREFIX@_event *found;
    size_t found_room, found_count;
    long long event_stop[@EVENT_COUNT@];
    int event_direction[@EVENT_COUNT@];
    int event_before[@EVENT_COUNT@], stopped, quick;
    double quick_at; /* the first of "quick" times at which events vary too quickly or are not finite */
    double event_value[2 * @EVENT_COUNT@]; /* of the expressions, and sizes of terms, where a step starts */
@LOOKS_FIELD@@EVENT_OWN@""",
    "EVENT_BEGIN": """\
#define E @EVENT_COUNT@

@LOOKS@static void start_events(@PREFIX@ *s, const double *u) {
    @NAME@_events(s->t, s->x, &s->constants, u, s->event_value);
    for (int m = 0; m < E; ++m) s->event_before[m] = 0;
    s->stopped = @UPPER@_SINGULAR;
    s->quick = 0;
}

""",
    "CROSSINGS": resources.files("codegen.loops").joinpath("crossings.c").read_text("ascii"),
    "EVENT_ROOM": """\
        if (s->found_room - s->found_count < @UPPER@_EVENTS_A_STEP) return s->status = @UPPER@_FULL;
""",
    "EVENT_JET": ", &s->event_jet[0][0]",
    "EVENT_DENSE": "1 || ",
    "STOP_BEGIN": "first_stop(s, ",
    "STOP_END": ", t_new, x_new, u)",
    "STOPPED": "s->stopped",
}
"""What stands in the templates of a loop with events."""


def _filled(text: str, values: Mapping[str, str]) -> str:
    for key, value in values.items():
        text = text.replace(f"@{key}@", value)
    return text


def _template(name: str) -> str:
    return resources.files("codegen.loops").joinpath(name).read_text("ascii")


# --- polynomials through values --------------------------------------------------------------------


@cache
def interpolation(degree: int) -> tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]:
    """Return points on [0, 1], and the matrix from values there to Bernstein coefficients.

    The points are the extrema of Chebyshev's polynomial, both ends among them; the matrix is the
    exact inverse of that of the Bernstein polynomials at the points as they are rounded.
    """
    nodes = [(1 - math.cos(math.pi * k / degree)) / 2 for k in range(degree + 1)]
    nodes[0], nodes[degree // 2], nodes[-1] = 0.0, 0.5, 1.0
    exact = [Fraction(x) for x in nodes]
    rows = [[math.comb(degree, j) * x**j * (1 - x) ** (degree - j) for j in range(degree + 1)]
            for x in exact]  # fmt: skip
    one = [[int(i == j) for j in range(degree + 1)] for i in range(degree + 1)]
    inverse = solved(rows, one, RATIONALS)
    return tuple(nodes), tuple(tuple(map(float, row)) for row in inverse)


# --- calls from Python -----------------------------------------------------------------------------


def fields(events: tuple[int, int], rows: int) -> list[tuple[str, Any]]:
    """Mirror the fields of the structure; ``events``: the `sizes`, ``rows``: orders of coefficients."""
    count, looks = events
    if not count:
        return []
    double: Any = ctypes.c_double
    integer: Any = ctypes.c_int
    return [
        ("found", ctypes.c_void_p),
        ("found_room", ctypes.c_size_t),
        ("found_count", ctypes.c_size_t),
        ("event_stop", ctypes.c_longlong * count),
        ("event_direction", integer * count),
        ("event_before", integer * count),
        ("stopped", integer),
        ("quick", integer),
        ("quick_at", double),
        ("event_value", double * (2 * count)),
        *([("of_looks", double * looks)] if looks else []),
        *([("event_jet", double * count * rows)] if rows else []),
    ]


class Finder:
    """The events of one run: where generated code puts them, and all that it has put there."""

    ROOM = 4096
    """Events that are kept before they are taken, at least."""

    def __init__(self, problem: Problem) -> None:
        self.events = problem.events
        self.parts: list[NDArray[Any]] = []
        n = len(problem.x0)
        kind = [("t", "f8"), ("x", "f8", (n,)), ("which", "i4"), ("direction", "i4")]
        self.room = np.zeros(self.ROOM if self.events else 0, np.dtype(kind))

    def attach(self, s: Any, needed: int) -> None:
        """Give the structure of an integrator the filters, and room for one step at least."""
        if self.events:
            self.room = np.zeros(max(self.ROOM, 2 * needed), self.room.dtype)
            s.found, s.found_room = self.room.ctypes.data, len(self.room)
            s.event_direction[:] = [e.direction for e in self.events]
            s.event_stop[:] = [int(e.terminal) for e in self.events]

    def empty(self, s: Any) -> None:
        """Take what was found, so that there is room again."""
        if self.events:
            self.parts.append(self.room[: s.found_count].copy())
            s.found_count = 0

    def found(self) -> Found:
        """Return all that was found, in order of time."""
        rows = np.concatenate([self.room[:0], *self.parts])
        x: Array = np.ascontiguousarray(rows["x"])
        return Found(rows["t"].copy(), x, rows["which"].copy(), rows["direction"].copy())
