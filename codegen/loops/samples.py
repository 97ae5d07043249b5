"""Laws that are sampled: inputs are held between samples, at which every step ends.

A loop in C sees inputs that are held up to its end. There it asks ``next_piece`` (``samples.c``), which
moves this end to the next change of an input, evaluates the laws, those in generated C or by a call to
Python, and lets the loop go on from where it is, with the step that it had: no loop begins anew, and none
but that of equal steps is written differently. What a method keeps of the rates where a step begins is
refreshed by a row of `REFRESH`. Loops in Python keep the same time by `Schedule`.

First all laws that are due are evaluated, over the states, inputs and states of the control that were there
before; then these change, and what waited for its delay takes effect.
"""

from __future__ import annotations

import ctypes
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from codegen.frontend.layout import Layout
from codegen.ir.names import identifier
from codegen.ir.program import SAMPLES
from codegen.native.trajectory import Array, Held, Law, Problem

FAILED = 8
"""Status of a loop whose law in Python has raised something."""
SAME = 4
"""Times that are so many spacings apart are one, as in ``samples.c``."""
ROWS = 4096
"""Changes of inputs that are kept before they are taken."""

_AGAIN = """\
    if (s->rejected == o->rejected && s->h < o->h) s->h = o->h; /* a step was cut by a sample, no more */
    o->h = s->h;
"""
_RATES = """\
    {function}(s->t, s->x, {arguments}s->f{end});
    s->evaluations += 1;
    s->which = first_bad(s->f);
    if (s->which >= 0) return s->status = @UPPER@_NOT_FINITE;
"""
_SLOPES = """\
    slopes(s, s->t, s->y, u, s->f);
    s->evaluations += 1;
    for (int i = 0; i < D; ++i)
        if (!isfinite(s->f[i])) {
            s->which = 0;
            return s->status = @UPPER@_NOT_FINITE;
        }
"""
_TORQUE = """\
    @PREFIX@_kick(s->t, s->y, 1, s->of_kick, NULL, u, 1, s->torque, 1);
    s->evaluations += 1;
    s->second = 0;
    for (int i = 0; i < 6; ++i)
        if (!isfinite(s->torque[i])) {
            s->which = 0;
            return s->status = @UPPER@_NOT_FINITE;
        }
"""
_LAST = """\
    const double part = ldexp(1.0, -P);
    for (int i = 0; i < N; ++i) {
        o->least[0][i] = part * fabs(s->jet[P - 1][i]);
        o->least[1][i] = 2.0 * part * fabs(s->jet[P - 2][i]);
    }
    o->changed = 1;
"""
REFRESH: Mapping[str, str] = {
    "taylor": _LAST,
    "rkmk": _SLOPES,
    "splitting": _TORQUE,
}
"""What else the inputs change where a step begins, by method; of Runge-Kutta methods the rates."""
_EQUAL: Mapping[str, str] = {
    "MARKED": """\
    double y[10], y_low[10], t; /* where they changed: steps from there may be made again */
    long long steps;
    size_t stored, next;
""",
    "BEFORE": "",
    "MARK": """\
    for (int i = 0; i < 10; ++i) o->y[i] = s->y[i], o->y_low[i] = s->y_low[i];
    o->t = s->t, o->steps = s->steps, o->stored = out->count, o->next = out->next;
    equal_steps(o);
""",
    "EQUAL": """\
/* Steps up to the next change of the inputs are equal, and no longer than was found to be short enough. */
static void equal_steps(@PREFIX@_samples *o) {
    @PREFIX@ *s = o->s;
    const double span = fabs(s->t_end - s->t), whole = s->chosen ? 0.5 * span : span;
    s->h = span / (span / whole * larger(1.0, ceil(whole / o->h * (1.0 - 1e-12))));
}

/* Steps were too long: all since the last change of the inputs are made again. */
static void begin_again(@PREFIX@_samples *o, @PREFIX@_output *out) {
    @PREFIX@ *s = o->s;
    o->h = fabs(s->h);
    s->rejected = o->rejected + (s->steps - o->steps) + 1;
    o->rejected = s->rejected;
    s->steps = o->steps, s->t = o->t, s->t_low = 0.0, s->second = 0;
    out->count = o->stored, out->next = o->next;
    for (int i = 0; i < 10; ++i) s->y[i] = o->y[i], s->y_low[i] = o->y_low[i];
    states(s, s->y, s->x);
    @PREFIX@_kick(s->t, s->y, 1, s->of_kick, NULL, o->u, 1, s->torque, 1);
    equal_steps(o);
    s->status = @UPPER@_PAUSED;
}

""",
    "AGAIN": """\
    const long long before = o->s->steps + o->s->rejected;
    for (;;) {
        const long long tried = o->s->steps + o->s->rejected - before;
        const int status = @PREFIX@_run(o->s, o->u, out, max_steps - tried, o);
        if (status != @UPPER@_COARSE) return status;
        begin_again(o, out);
    }
""",
}
"""What a method with equal steps has besides: those between two changes are made again, if too long."""
_SERIES: Mapping[str, str] = {
    "MARKED": """\
    double least[2][N]; /* last coefficients before inputs changed, as small as for a step twice as long */
    int changed;
""",
    "DECLARED": "static inline int doubtful(@PREFIX@_samples *o, double h);\n",
    "EQUAL": """\
/* Whether the series of a step h are to be tested at its end. The last coefficients after a change of the
 * inputs may be small by chance; they are believed where those of no state have shrunk as far as for a step
 * that may be twice as long. */
static inline int doubtful(@PREFIX@_samples *o, double h) {
    const @PREFIX@ *s = o->s;
    int doubt = h > 2.0 * fabs(s->h_old);
    if (!o->changed) return doubt;
    o->changed = 0;
    for (int i = 0; i < N; ++i) {
        const double one = o->least[0][i], other = o->least[1][i];
        doubt |= !(one + other > 0.0 && fabs(s->jet[P - 1][i]) >= one && fabs(s->jet[P - 2][i]) >= other);
    }
    return doubt;
}

""",
}
"""What series have besides: whether they are believed where inputs have changed."""
_OTHERS: Mapping[str, str] = {
    "MARKED": "", "DECLARED": "", "BEFORE": _AGAIN, "MARK": "", "EQUAL": "",
    "AGAIN": "    return @PREFIX@_run(o->s, o->u, out, max_steps, o);\n",
}  # fmt: skip


_BEFORE = """\
typedef struct @PREFIX@_samples_ @PREFIX@_samples;
#ifdef __GNUC__
__attribute__((noinline)) /* what is called once a piece leaves the loop its registers */
#endif
static int next_piece(@PREFIX@_samples *o, const @PREFIX@_output *out);
@DECLARED@"""
_ASKS: Sequence[tuple[str, str]] = (
    ("@PREFIX@_output *o, long long max_steps)",
     "@PREFIX@_output *o, long long max_steps, @PREFIX@_samples *around)"),
    ("    while (s->t != s->t_end || s->t_low != 0.0) {\n",
     "    while (s->t != s->t_end || s->t_low != 0.0 || next_piece(around, o)) {\n"),
    ("    }\n    return s->status = @UPPER@_DONE;\n}\n", "    }\n    return s->status;\n}\n"),
)  # fmt: skip
"""What changes in a loop that goes on at its end, and into what."""
_BESIDES: Mapping[str, Mapping[str, str]] = {"taylor": _SERIES, "splitting": _EQUAL}
_DOUBT = (
    "h_abs > 2.0 * fabs(s->h_old);", "doubtful(around, smaller(h_abs, fabs(rest)));"
)  # fmt: skip


def around(loop: str, method: str, layout: Layout, rates: Sequence[str] = ()) -> str:
    """Return the ``loop`` of a method, header and source, as one that goes on from sample to sample.

    ``rates``: as of `text`.
    """
    prefix = f"{identifier(layout.name)}_{method}"

    declared = _BESIDES.get(method, {}).get("DECLARED", "")

    def named(part: str) -> str:
        part = part.replace("@DECLARED@", declared)
        return part.replace("@PREFIX@", prefix).replace("@UPPER@", prefix.upper())

    for before, after in (*_ASKS, *((_DOUBT,) if method == "taylor" else ())):
        assert named(before) in loop
        loop = loop.replace(named(before), named(after))
    start = loop.index(named("int @PREFIX@_run("))
    return loop[:start] + named(_BEFORE) + loop[start:] + text(method, layout, rates)


def text(method: str, layout: Layout, rates: Sequence[str] = ()) -> str:
    """Return what a loop asks at samples, as C.

    ``rates``: of Runge-Kutta methods the function, its arguments before the results, and those behind.
    """
    name = identifier(layout.name)
    prefix = f"{name}_{method}"
    generated = bool(layout.results.get(SAMPLES))
    sample = f"{name}_{SAMPLES}(t, o->s->x, &o->s->constants, o->u, o->values);"
    refresh = REFRESH.get(method) or _RATES.format(
        function=rates[0], arguments=rates[1], end=rates[2]
    )
    values = {
        **_OTHERS,
        **_BESIDES.get(method, {}),
        "REFRESH": refresh,
        "SAMPLE": sample if generated else "return 1;",
        "SAMPLE_ONLY": sample if generated else "",
        "INPUTS": str(len(layout.inputs)),
        "NAME": name,
        "PREFIX": prefix,
        "UPPER": prefix.upper(),
    }
    whole = resources.files("codegen.loops").joinpath("samples.c").read_text("ascii")
    for key, value in values.items():
        whole = whole.replace(f"@{key}@", value)
    return whole


MANY_PLAIN: Mapping[str, str] = {
    "MANY_FUNCTIONS": "",
    "MANY_BEGIN": "",
    "MANY_START": "@PREFIX@_start(&s, p, o->u)",
    "MANY_GOES_ON": "status == @UPPER@_PAUSED",
    "MANY_RUN": "@PREFIX@_run(&s, o->u, &stored",
    "MANY_TAKE": "",
    "MANY_END": "",
}
"""What stands in the loop over many trajectories."""
MANY_SAMPLED: Mapping[str, str] = {
    "MANY_FUNCTIONS": """\
enum { CHANGES = 64 };

/* Store what trajectory j holds at the points of the grid before a time. */
static size_t store_held(const job_ *o, size_t j, size_t next, double until, const double *u) {
    for (; next < o->grid_count && o->grid[next] < until; ++next)
        for (size_t i = 0; i < @INPUTS@; ++i) o->held_at[(next * @INPUTS@ + i) * o->count + j] = u[i];
    return next;
}

""",
    "MANY_BEGIN": """\
        double u[@INPUTS@], held[@INPUTS@], rows[CHANGES * (@INPUTS@ + 1)];
        size_t next = 0;
        for (int i = 0; i < @INPUTS@; ++i) u[i] = held[i] = o->u[i];
        @PREFIX@_samples around;
        memset(&around, 0, sizeof around);
        around.s = &s, around.p = p, around.u = u, around.values = o->law_values, around.rows = rows;
        around.laws = o->laws, around.count = (long long)o->law_count, around.room = CHANGES;
""",
    "MANY_START": "@PREFIX@_start_sampled(&around, &stored)",
    "MANY_GOES_ON": "(status == @UPPER@_PAUSED || status == @UPPER@_FULL)",
    "MANY_RUN": "@PREFIX@_run_sampled(&around, &stored",
    "MANY_TAKE": """\
            for (long long r = 0; r < around.kept; ++r) {
                const double *row = rows + r * (@INPUTS@ + 1);
                next = store_held(o, j, next, row[0], held);
                for (int i = 0; i < @INPUTS@; ++i) held[i] = row[i + 1];
            }
            around.kept = 0;
""",
    "MANY_END": """\
        store_held(o, j, next, HUGE_VAL, held);
        if (status == @UPPER@_FULL) status = @UPPER@_PAUSED;
""",
}
"""The same where laws are sampled."""


# --- calls from Python -----------------------------------------------------------------------------

_Call = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double)
_INTEGERS = (
    "whole", "taken", "applied", "due", "waits", "count", "all", "room", "first", "last_in", "last_out",
)  # fmt: skip


class _Law(ctypes.Structure):
    """Mirror of a law in samples.c."""

    _fields_ = [
        *((f, ctypes.c_double) for f in ("period", "rest", "next", "effect")),
        *((f, ctypes.c_longlong) for f in _INTEGERS),
        ("places", ctypes.c_void_p),
        ("waiting", ctypes.c_void_p),
        ("call", _Call),
    ]


@cache
def _samples(size: int) -> Any:
    """Mirror the structure of so many bytes round a loop; what a method has besides is its own."""
    fields: list[tuple[str, Any]] = [
        (f, ctypes.c_void_p) for f in ("s", "p", "u", "values", "rows", "laws")
    ]
    fields += [(f, ctypes.c_longlong) for f in ("count", "room", "kept", "only")]
    fields += [(f, ctypes.c_double) for f in ("start", "end", "last", "h")]
    fields += [("rejected", ctypes.c_longlong)]
    known = ctypes.sizeof(type("Known", (ctypes.Structure,), {"_fields_": fields}))
    fields += [("besides", ctypes.c_char * (size - known))]
    return type("Samples", (ctypes.Structure,), {"_fields_": fields})


@dataclass(frozen=True)
class Functions:
    """The loop of a method with what stands round it: two functions and a structure."""

    start: Any
    run: Any
    structure: Any


def functions(library: ctypes.CDLL, prefix: str) -> Functions:
    """Return what a library has for laws that are sampled."""
    size = getattr(library, f"{prefix}_samples_size")
    size.restype = ctypes.c_size_t
    structure = _samples(size())
    assert size() == ctypes.sizeof(structure)
    start, run = (getattr(library, f"{prefix}_{f}_sampled") for f in ("start", "run"))
    start.argtypes = [ctypes.c_void_p] * 2
    run.argtypes = [*[ctypes.c_void_p] * 2, ctypes.c_longlong]
    return Functions(start, run, structure)


@dataclass(frozen=True)
class Laws:
    """Laws as C reads them; ``values``: room for what they give, ``kept``: what must live as long.

    Those that are generated are the first.
    """

    array: Any
    values: Array
    kept: tuple[Any, ...]


def laws_of(
    laws: Sequence[Law], span: float, made: Callable[[Law, Array], Any] | None = None
) -> Laws:
    """Return laws as C reads them, for a run over ``span`` (s).

    ``made``: gives the call of one in Python, which is told where its values go.
    """
    array, kept, first = (_Law * len(laws))(), list[Any](), 0
    values = np.zeros(max(1, sum(len(law.applied) + len(law.stepped) for law in laws)))
    for row, law in zip(array, laws, strict=True):
        count, states = len(law.applied), len(law.stepped)
        places = np.array([*law.applied, *law.stepped], dtype=np.int64)
        room = 2 + min(law.whole, math.ceil(span / law.period))  # no more samples than there are
        waiting = np.zeros(room * max(count, 1))
        row.period, row.rest, row.whole = law.period, law.rest, law.whole
        row.count, row.all, row.room, row.first = count, count + states, room, first
        row.waits = int(law.whole > 0 or law.rest > 0)
        row.places, row.waiting = places.ctypes.data, waiting.ctypes.data
        kept += [places, waiting]
        if law.called is not None and made is not None:
            row.call = made(law, values[first : first + count])
        first += count + states
    return Laws(array, values, tuple(kept))


class Driver:
    """One run of a loop in C under laws that are sampled."""

    def __init__(self, functions: Functions, problem: Problem, s: Any, output: Any) -> None:
        """``s``, ``output``: the structures of the loop, which must live as long."""
        self.functions, self.s, self.output = functions, s, output
        self.error: BaseException | None = None
        self.u, self.p = problem.inputs.copy(), problem.parameters
        self.state = np.ctypeslib.as_array(s.x)
        start, end = problem.t_span
        self.laws = laws_of(problem.laws, end - start, self._called)
        self.rows = np.empty((ROWS, len(self.u) + 1))
        self.parts: list[Array] = []
        self.o = functions.structure(
            s=ctypes.addressof(s), p=self.p.ctypes.data, u=self.u.ctypes.data,
            values=self.laws.values.ctypes.data, rows=self.rows.ctypes.data,
            laws=ctypes.addressof(self.laws.array), count=len(problem.laws), room=ROWS,
        )  # fmt: skip

    def _called(self, law: Law, place: Array) -> Any:
        """Return what C calls; it puts the values of a law into their place."""
        assert law.called is not None
        function, state = law.called.fresh(), self.state

        def call(t: float) -> int:
            try:
                function(t, state, place)
            except BaseException as error:
                self.error = error  # raised when C has returned
                return 1
            return 0

        return _Call(call)

    def start(self) -> int:
        """Take the first samples, and start; return the status."""
        address = ctypes.addressof(self.o), ctypes.addressof(self.output)
        return self._checked(self.functions.start(*address))

    def run(self, attempts: int) -> int:
        """Go on for so many steps that are tried; return the status."""
        self._take()
        address = ctypes.addressof(self.o), ctypes.addressof(self.output)
        return self._checked(self.functions.run(*address, attempts))

    def _checked(self, status: int) -> int:
        if self.error is not None:
            raise self.error
        return status

    def _take(self) -> None:
        self.parts.append(self.rows[: self.o.kept].copy())
        self.o.kept = 0

    def held(self) -> Held:
        """Return what the inputs were held at."""
        self._take()
        rows = np.concatenate(self.parts)
        return Held(rows[:, 0].copy(), rows[:, 1:].copy())


def _spacing(t: float) -> float:
    return sys.float_info.epsilon * abs(t)


class Schedule:
    """The same for loops in Python: when inputs change, and what they become.

    ``generated``: f(t, x, p, u), the values of all laws that are not in Python, in order.
    """

    def __init__(self, problem: Problem, generated: Callable[..., Array] | None, u: Array) -> None:
        """``u``: the inputs (m,), which are changed in place."""
        self.laws, self.p, self.u = problem.laws, problem.parameters, u
        self.start, self.end = problem.t_span
        self.generated = generated
        self.calls = [law.called.fresh() if law.called else None for law in self.laws]
        self.taken, self.applied = [0] * len(self.laws), [0] * len(self.laws)
        self.waiting: list[list[Array]] = [[] for _ in self.laws]
        self.times: list[float] = []
        self.rows: list[Array] = []

    def next(self) -> float:
        """Return the time of the next change, or the end."""
        found = []
        for k, law in enumerate(self.laws):
            found.append(law.time(self.start, self.taken[k]))
            if self.applied[k] < self.taken[k]:
                found.append(law.effect(self.start, self.applied[k]))
        next_ = min(found)
        return next_ if next_ < self.end - SAME * _spacing(self.end) else self.end

    def change(self, t: float, x: Array) -> None:
        """Take the samples that are due, and let take effect what is due."""
        until = t + SAME * _spacing(t)
        for place, value in self._taken(t, x):
            self.u[list(place)] = value
        for k, law in enumerate(self.laws):
            while (
                self.applied[k] < self.taken[k] and law.effect(self.start, self.applied[k]) <= until
            ):
                self.u[list(law.applied)] = self.waiting[k].pop(0)
                self.applied[k] += 1
        self.times.append(t)
        self.rows.append(self.u.copy())

    def _taken(self, t: float, x: Array) -> list[tuple[tuple[int, ...], Array]]:
        """Evaluate the laws that are due; return the next states, with their places."""
        values, first, stepped = None, 0, []
        until = t + SAME * _spacing(t)
        for k, law in enumerate(self.laws):
            middle, last = first + len(law.applied), first + len(law.applied) + len(law.stepped)
            if law.time(self.start, self.taken[k]) <= until:
                call = self.calls[k]
                if call is not None:
                    out = np.empty(len(law.applied))
                    call(t, x, out)
                    self.waiting[k].append(out)
                else:
                    assert self.generated is not None
                    values = self.generated(t, x, self.p, self.u) if values is None else values
                    self.waiting[k].append(values[first:middle].copy())
                    stepped.append((law.stepped, values[middle:last].copy()))
                self.taken[k] += 1
            first = last
        return stepped

    def held(self) -> Held:
        """Return what the inputs were held at."""
        return Held(np.array(self.times), np.array(self.rows).reshape(len(self.times), -1))
