"""Explicit Runge-Kutta methods with their whole loop in generated C, and the way to call it."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.program import RATES, SINGULARITIES, Program, SameObject
from codegen.loops import crossings, jumps, lookout, projection, samples
from codegen.loops.tableaux import Row, Tableau
from codegen.native import native, trajectory
from codegen.native.trajectory import Array, Held, Problem, Stepwise, Stop, Trajectory, varied
from codegen.passes.pipeline import by_parameters
from codegen.targets import c

NOT_FINITE, STEP_TOO_SMALL, DONE, SINGULAR, FULL, PAUSED, EVENT = -2, -1, 0, 1, 2, 3, 5
COARSE = 6
"""Of a method with equal steps: they are too long, and the run begins again."""
THIN = 7
"""Of a method that moves momentum: it cannot resolve a body rate about an axis of small moment."""
STEPS_A_CALL, FIRST_CALL = 50_000, 256
"""Steps that generated code makes in one call, at most and at first."""
CALL_SECONDS = 0.05
"""What a call takes, about: between two calls Python sees that the user has interrupted it."""
FIRST_CAPACITY = 256


def files(
    tableau: Tableau, program: Program, layout: Layout, sampled: bool = False
) -> Mapping[str, str]:
    """Return header and source of the integrator by file name.

    ``sampled``: whether inputs change at its end, so that the rates there may be left out.
    """
    values = _values(tableau, program, layout)
    values |= _end_rates(tableau, values, sampled and not crossings.count_of(layout))
    return {
        f"{values['PREFIX']}.{kind}": fill(f"runge_kutta.{kind}", values) for kind in ("h", "c")
    }


def single_text(tableau: Tableau, program: Program, layout: Layout, sampled: bool = False) -> str:
    """Return functions and integrator as one text that compiles by itself.

    ``sampled``: with what stands round the loop where laws are sampled.
    """
    name = identifier(layout.name)
    header, source = files(tableau, program, layout, sampled).values()
    rest = (header + source).replace(f'#include "{name}.h"\n', "")
    rest = rest.replace(f'#include "{name}_{tableau.name}.h"\n', "")
    if sampled:
        prefix = f"{name}_{tableau.name}"
        rates = _rates(name, prefix, _watch(tableau, program, prefix))
        rest = samples.around(rest, tableau.name, layout, rates)
    return c.single_text(program, layout) + rest


SHARED = {"NUMBERS": "numbers.c", "START": "start.c", "EVENTS": "events.c", "STEPS": "steps.c",
          "INTERFACE": "interface.h", "OUTPUT": "output.h"}  # fmt: skip
"""What the texts of several methods have in common, by file."""


def fill(template: str, values: Mapping[str, str]) -> str:
    """Return a template of this folder with its keys replaced, those of the shared parts first."""
    text = _template(template)
    shared = {key: _template(file) for key, file in SHARED.items()}
    for key, value in {**shared, **_without_events(values), **values}.items():
        text = text.replace(f"@{key}@", value)
    return text


def _without_events(values: Mapping[str, str]) -> dict[str, str]:
    return {
        **crossings.NONE,
        "FURTHER_STATUS": "",
        "STOPPED": f"{values.get('UPPER', '')}_SINGULAR",
    }


def _template(name: str) -> str:
    return resources.files("codegen.loops").joinpath(name).read_text(encoding="ascii")


_KEEP = """\
        for (int i = 0; i < N; ++i)
            keep_jump(s, i, s->t, fabs(off[i]), s->atol[i] + s->rtol * fmax(fabs(s->x[i]), fabs(x_new[i])));
"""


def _watch(tableau: Tableau, program: Program, prefix: str) -> lookout.Lookout:
    n = len(program.results[RATES])
    return lookout.of(program, prefix, lookout.Steps(tableau, n, n, _KEEP))


def _values(tableau: Tableau, program: Program, layout: Layout) -> dict[str, str]:
    name, last = identifier(layout.name), tableau.main_stages
    singular, n = len(layout.results[SINGULARITIES]), len(layout.states)
    prefix = f"{name}_{tableau.name}"
    watch = _watch(tableau, program, prefix)
    rates = _rates(name, prefix, watch)
    main = [_stage(tableau, rates, s) for s in range(1, last)]
    dense = [
        f"        s->dense[{3 + d}][i] = h * ({_sum(row)});" for d, row in enumerate(tableau.dense)
    ]
    return {
        "TITLE": comment(layout.title),
        "METHOD": f"{tableau.name.upper()}, an explicit Runge-Kutta method of order {tableau.order},",
        "NAME": name,
        "PREFIX": prefix,
        "UPPER": prefix.upper(),
        "HEADER": f"{prefix}.h",
        "STATES": str(n),
        "SINGULARITIES": str(singular),
        "COORDINATES": ", ".join(map(str, layout.coordinates)),
        "SINGULAR_ROOM": str(max(1, singular)),
        "ORDER": str(tableau.order),
        "LAST": str(last),
        "ALL_STAGES": str(len(tableau.stages)),
        "DENSE_TERMS": str(tableau.dense_terms),
        "DENSE_SHAPE": f"[{tableau.dense_terms}][n]",
        "STACK": f"about {8 * n * (len(tableau.stages) + 8)}",
        "EVALUATIONS": str(last),
        "STAGES": "\n".join(main),
        "DENSE_COEFFICIENTS": "\n".join(dense),
        "DENSE_FACTOR": "theta" if tableau.dense_terms % 2 else "(1.0 - theta)",
        "UPDATE": _sum(tableau.stages[last]),
        "ROOT": _root(tableau.order),
        **_of_rates(rates, n, watch.width),
        **_further_stages(tableau, rates),
        **_error(tableau),
        **projection.texts(layout, prefix, projection.RUNGE_KUTTA.format(name=name, last=last)),
        **crossings.of_values(program, layout, prefix),
        **watch.texts,
    }


_AT_CHANGE = """\
        const int at_change = t_new == s->t_end; /* the rates there are those of other inputs */
        for (int i = 0; at_change && i < N; ++i) k[{last}][i] = 0.0;
        s->evaluations -= at_change;
        if (!at_change) {rates}
"""
_DENSE_AT_CHANGE = """\
        if (needs_dense || possible) {{
            if (at_change) {rates}
            s->evaluations += at_change;
            prepare_dense(s, k, h, x_new, u);
        }}
"""


def _end_rates(tableau: Tableau, values: Mapping[str, str], sampled: bool) -> dict[str, str]:
    """Return how the rates at the end of a step are found.

    Where inputs change there, it is for dense output alone; that needs a method whose estimate of the error
    does not read them, and nothing that is watched.
    """
    last = tableau.main_stages
    at, before, after = (values[k] for k in ("RATES_AT", "RATES_WITH", "RATES_END"))
    rates = f"{at}(t_new, x_new, {before}k[{last}]{after});"
    read = any(len(row) > last and row[last] for row in (tableau.error_high, tableau.error_low))
    if not sampled or read or values["WIDTH"] != "N":
        return {"END_RATES": f"        {rates}\n"}
    return {
        "END_RATES": _AT_CHANGE.format(last=last, rates=rates),
        "DENSE_LATER": _DENSE_AT_CHANGE.format(rates=rates),
    }


def _root(order: int) -> str:
    return "sqrt(sqrt(sqrt(error)))" if order == 8 else f"pow(error, 1.0 / {order}.0)"


class _Rates(NamedTuple):
    """How the rates are called: the function, its arguments before the array of results, and behind."""

    name: str
    before: str
    after: str


def _of_rates(rates: _Rates, n: int, width: int) -> dict[str, str]:
    return {
        "WIDTH": "W" if width else "N",
        "RATES_ROOM": str(n + width),
        "RATES_AT": rates.name,
        "RATES_WITH": rates.before,
        "RATES_END": rates.after,
    }


def _rates(name: str, prefix: str, watch: lookout.Lookout) -> _Rates:
    if not watch.width:
        return _Rates(f"{name}_rates", "&s->constants, u, ", "")
    return _Rates(f"{prefix}_watched", "1, s->of_watched, NULL, u, 1, ", ", 1")


_IN_WORDS = {
    0: "no further evaluation",
    1: "one more evaluation",
    2: "two more evaluations",
    3: "three more evaluations",
}


def _further_stages(tableau: Tableau, rates: _Rates) -> dict[str, str]:
    """Return how the stages that dense output alone needs are computed, and what they cost."""
    further = range(tableau.main_stages + 1, len(tableau.stages))
    lines = ["    double y[N];", *(_stage(tableau, rates, s) for s in further)]
    lines += [f"    s->evaluations += {len(further)};"]
    none = "    (void)u; /* the stages of the step are enough */"
    return {
        "DENSE_STAGES": "\n".join(lines) if further else none,
        "DENSE_COST": _IN_WORDS.get(len(further), f"{len(further)} more evaluations"),
    }


def _error(tableau: Tableau) -> dict[str, str]:
    """Return the sums of the error estimates, and the error: the norm of one, or of their mixture."""
    estimates = {"high": tableau.error_high, "low": tableau.error_low}
    used = {name: row for name, row in estimates.items() if row}
    indent = "            "
    terms = [f"{indent}const double e_{n} = scale * ({_sum(row)});" for n, row in used.items()]
    terms += [f"{indent}{n} += e_{n} * e_{n};" for n in used]
    mixed = "high > 0.0 ? fabs(h) * high / sqrt((high + 0.01 * low) * N) : high"
    return {
        "ERROR_SUMS": ", ".join(f"{n} = 0.0" for n in used),
        "ERROR_TERMS": "\n".join(terms),
        "ERROR": mixed if tableau.error_low else "fabs(h) * sqrt(high / N)",
    }


def _sum(row: Row) -> str:
    return " + ".join(f"{weight!r} * k[{j}][i]" for j, weight in enumerate(row) if weight).replace(
        "+ -", "- "
    )


def _stage(tableau: Tableau, rates: _Rates, s: int) -> str:
    indent = "        " if s < tableau.main_stages else "    "
    return (
        f"{indent}for (int i = 0; i < N; ++i) y[i] = s->x[i] + h * ({_sum(tableau.stages[s])});\n"
        f"{indent}{rates.name}(s->t + {tableau.nodes[s]!r} * h, y, {rates.before}k[{s}]{rates.after});"
    )


@cache
def _structures(
    prefix: str,
    n: int,
    room: int,
    terms: int,
    constants: int,
    events: tuple[int, int],
    watched: tuple[tuple[str, Any], ...],
    width: int,
) -> tuple[type[ctypes.Structure], type[ctypes.Structure]]:
    """Mirror the two structures of runge_kutta.h."""
    double: Any = ctypes.c_double
    vector: Any = double * n
    state: list[tuple[str, Any]] = [
        (f, double)
        for f in ("t", "t_end", "h", "h_max", "rtol", "margin", "t_low", "t_old", "h_old")
    ]
    state += [(f, vector) for f in ("atol", "x", "x_low")]
    state += [("f", double * (n + width)), ("x_old", vector)]
    state += [("dense", vector * terms), ("singular", double * room), ("closest", double * room)]
    state += [(f, ctypes.c_longlong) for f in ("steps", "rejected", "evaluations")]
    state += [(f, ctypes.c_int) for f in ("status", "which", "after_rejection")]
    state += [("constants", double * constants), *watched]
    state += crossings.fields(events, 0)
    return structures(prefix, state)


def structures(
    prefix: str, state: Sequence[tuple[str, Any]]
) -> tuple[type[ctypes.Structure], type[ctypes.Structure]]:
    """Return the structure of an integrator from its fields, and that of its output."""
    output: list[tuple[str, Any]] = [(f, ctypes.c_void_p) for f in ("t", "x", "dense", "grid")]
    output += [(f, ctypes.c_size_t) for f in ("capacity", "count", "grid_count", "next")]
    kinds = (
        type(f"{prefix}{suffix}", (ctypes.Structure,), {"_fields_": f})
        for suffix, f in (("", state), ("_output", output))
    )
    first, second = kinds
    return first, second


@dataclass(frozen=True)
class NativeMethod:
    """An integrator compiled for one system: functions, structures, and what its dense output is.

    ``terms``: coefficients a state and step; ``solution(t, h, x, coefficients)`` evaluates them.
    """

    terms: int
    solution: Callable[[Array, Array, Array, Array], Any]
    start: Any
    run: Any
    state: type[ctypes.Structure]
    output: type[ctypes.Structure]
    library: ctypes.CDLL
    most_events: int = 0
    """What a step may find, where there are events."""
    notice: Callable[[Any, Problem], str] = crossings.silent
    """The notice of a run, from the state of the integrator at its end."""
    sampled: samples.Functions | None = None
    """What stands round the loop, where it was built for laws that are sampled."""
    overflows: Callable[[Any], bool] = lambda state: False
    """Whether Taylor coefficients where it stopped are not finite, those of the first order apart."""

    @cached_property
    def quick(self) -> Quick | None:
        """The quick way, where there is one."""
        extension = native.extension()
        return None if extension is None else Quick(self, extension.begun)


@lru_cache(maxsize=4)
def _text_once(
    tableau: Tableau, program: SameObject[Program], layout: SameObject[Layout], sampled: bool
) -> str:
    return single_text(tableau, program.value, layout.value, sampled)


def begin(tableau: Tableau, program: Program, layout: Layout) -> None:
    """Begin to compile what `build` needs, see `codegen.native.native.ahead`."""
    text = _text_once(tableau, SameObject(program), SameObject(layout), False)
    native.ahead(text, native.flags_for_steps(len(program.instructions)))


def build(
    tableau: Tableau, program: Program, layout: Layout, sampled: bool = False
) -> NativeMethod:
    """Compile the integrator of a system for this machine. Raises `CompilerError` if that fails."""
    text = _text_once(tableau, SameObject(program), SameObject(layout), sampled)
    flags = native.flags_for_steps(len(program.instructions))
    prefix = f"{identifier(layout.name)}_{tableau.name}"
    n, singular = len(layout.states), len(layout.results[SINGULARITIES])
    constants = max(1, len(by_parameters(program, layout.sizes).values))
    events, room = crossings.sizes(program, layout), crossings.most(layout)
    terms = tableau.dense_terms
    watch = _watch(tableau, program, prefix)
    state, output = _structures(
        prefix, n, max(1, singular), terms, constants, events, watch.fields, watch.width
    )
    start, run, library = loaded(text, flags, prefix, state)
    return NativeMethod(
        terms, DenseSolution, start, run, state, output, library, room,
        crossings.notice(program, layout),
        samples.functions(library, prefix) if sampled else None,
    )  # fmt: skip


def loaded(
    text: str, flags: Sequence[str], prefix: str, state: type[ctypes.Structure]
) -> tuple[Any, Any, ctypes.CDLL]:
    """Compile and load an integrator; return its two functions and the library."""
    library = native.load(native.compile_library(text, flags), text, flags)
    size = getattr(library, f"{prefix}_size")
    size.restype = ctypes.c_size_t
    assert size() == ctypes.sizeof(state)
    start, run = getattr(library, f"{prefix}_start"), getattr(library, f"{prefix}_run")
    start.argtypes = [ctypes.c_void_p] * 3
    run.argtypes = [*[ctypes.c_void_p] * 3, ctypes.c_longlong]
    return start, run, library


def integrate(method: NativeMethod, problem: Problem) -> Trajectory:
    """Integrate a problem; stop at its end, at a singular configuration, or where numbers fail."""
    quick = method.quick
    ready = None if quick is None else quick.prepared(problem)
    if ready is not None:
        return ready.integrate(problem.x0, problem.parameters, problem.inputs, problem.atol)
    s = method.state(
        t=problem.t_span[0], t_end=problem.t_span[1], rtol=problem.rtol, margin=problem.margin
    )
    s.h, s.h_max = problem.first_step or 0.0, problem.max_step
    s.x[:], s.atol[:] = problem.x0.tolist(), problem.atol.tolist()
    store, clock = _Store(method, problem), _Clock()
    store.finder.attach(s, method.most_events)
    loop = _loop(method, problem, s, store)
    return _to_its_end(method, problem, s, store, clock, loop, clock.timed(loop.start))


def _to_its_end(
    method: NativeMethod,
    problem: Problem,
    s: Any,
    store: _Store,
    clock: _Clock,
    loop: _Plain | samples.Driver,
    status: int,
) -> Trajectory:
    """Go on with a run that has begun."""
    look = problem.watch_every if problem.watch else problem.max_steps
    most = min(FIRST_CALL, STEPS_A_CALL)
    while status in {PAUSED, FULL}:
        left = problem.max_steps - s.steps - s.rejected
        if left <= 0:
            break
        store.finder.empty(s)
        if not store.make_room():
            return store.trajectory(s, Stop("memory", s.t), problem, clock.seconds)
        attempts = min(most, left, look - s.steps - s.rejected)
        status = clock.timed(loop.run, attempts)
        most = _next_call(most, clock.last)
        if status == COARSE and store.begins_again(s, problem):
            status = clock.timed(loop.start)
        problem.report(s.t)
        if problem.watch and status == PAUSED and s.steps + s.rejected >= look:
            look += problem.watch_every
            if problem.watch(s.t, np.array(s.x[:]), s.h_old):
                return store.trajectory(s, Stop("left", s.t), problem, clock.seconds)
    store.held = loop.held()
    overflows = status in {NOT_FINITE, STEP_TOO_SMALL} and method.overflows(s)
    stop = Stop(_STOPS[status], s.t, s.which, overflows)
    return store.trajectory(s, stop, problem, clock.seconds)


WORDS_OF_OUTPUT = 8
"""Words of the structure of an output."""


class Quick:
    """The first call of a method, and a run that ends in it: what is done by name elsewhere, by place.

    The structures of integrator and output are one array of doubles, new for each run: runs may be made in
    several threads.
    """

    def __init__(self, method: NativeMethod, begun: Callable[..., Any]) -> None:
        self.method, self.begun, state = method, begun, method.state
        self.start, self.run = (
            ctypes.cast(f, ctypes.c_void_p).value for f in (method.start, method.run)
        )
        self.size = ctypes.sizeof(state) // 8
        at = {
            n: getattr(state, n).offset // 8 for n in ("t", "t_end", "rtol", "margin", "h", "h_max")
        }
        self.t, self.t_end, self.rtol, self.margin, self.h, self.h_max = at.values()
        self.x, self.atol, self.closest = (_places(state, n) for n in ("x", "atol", "closest"))
        self.counts = state.steps.offset
        assert [getattr(state, n).offset - self.counts for n in _COUNTED] == [0, 8, 16, 24, 28]
        self.tells = hasattr(state, "off_at") or method.notice is not crossings.silent
        self.n = self.x.stop - self.x.start
        self.template = np.zeros(self.size + WORDS_OF_OUTPUT)

    def takes(self, problem: Problem) -> bool:
        """Return whether nothing is looked for on the way."""
        if problem.dense_output or problem.events or problem.laws:
            return False
        if problem.t_eval is not None and not problem.t_eval.size:
            return False
        return problem.watch is None or problem.watch_every > FIRST_CALL

    def prepared(self, problem: Problem, **made: Any) -> Prepared | None:
        """Return its runs of problems like this one but for their values; None where it does not `takes` it.

        ``made``: fields of their trajectories beside what is found.
        """
        if not self.takes(problem):
            return None
        memory = self.template.copy()
        (memory[self.t], memory[self.t_end]), memory[self.rtol] = problem.t_span, problem.rtol
        memory[self.margin], memory[self.h_max] = problem.margin, problem.max_step
        memory[self.h] = problem.first_step or 0.0
        return Prepared(self, problem, memory, made)

    def further(
        self,
        problem: Problem,
        memory: Array,
        rows: tuple[Array, Array],
        status: int,
        seconds: float,
    ) -> Trajectory:
        """Go on where the first call did not end a run, or ended it otherwise than at an end."""
        method = self.method
        s = method.state.from_buffer(memory.data)
        output = method.output.from_buffer(memory.data, 8 * self.size)
        store, clock = _Store(method, problem, (*rows, output)), _Clock()
        clock.seconds = clock.last = seconds
        loop = _Plain(method, problem, s, store)
        problem.report(s.t)
        if status == COARSE and store.begins_again(s, problem):
            status = clock.timed(loop.start)
        return _to_its_end(method, problem, s, store, clock, loop, status)


@dataclass(frozen=True)
class Prepared:
    """Runs by a `Quick` of one problem whose values change: ``memory`` is filled but for these."""

    quick: Quick
    problem: Problem
    memory: Array
    said: Mapping[str, Any]

    @cached_property
    def _made(self) -> Trajectory:
        return varied(_MADE, **self.said)

    @cached_property
    def _room(self) -> tuple[int, int]:
        """Where states begin if the start is to be the first row, else -1; steps of the first call."""
        first = self.quick.x.start if self.problem.t_eval is None else -1
        return first, min(FIRST_CALL, STEPS_A_CALL, self.problem.max_steps)

    def integrate(
        self,
        x0: Array,
        parameters: Array,
        inputs: Array,
        atol: Array,
        onward: Callable[[Problem], Problem] | None = None,
    ) -> Trajectory:
        """Integrate with these values; ``onward``: makes the problem of a run that its first call does not end."""
        quick, problem, memory = self.quick, self.problem, self.memory.copy()
        grid, (first, attempts) = problem.t_eval, self._room
        memory[quick.x], memory[quick.atol] = x0, atol
        t, x = rows_of(grid, quick.n)
        began = time.perf_counter()
        status, kept, steps, rejected, evaluations, which, time_of_stop = quick.begun(
            quick.start, quick.run, memory, parameters, inputs, t, x, grid, first, quick.counts, attempts
        )  # fmt: skip
        seconds = time.perf_counter() - began
        if quick.tells or status not in _ENDED:
            whole = varied(problem, x0=x0, parameters=parameters, inputs=inputs, atol=atol)
            whole = whole if onward is None else onward(whole)
            found = quick.further(whole, memory, (t, x), status, seconds)
            return varied(found, **self.said) if self.said else found
        if kept < len(t):
            t, x = t[:kept].copy(), x[:kept]
        return varied(
            self._made, t=t, y=x.T.copy(), state_at_stop=memory[quick.x].copy(),
            stop=varied(_ENDED[status], t=time_of_stop, which=which),
            closest=tuple(memory[quick.closest].tolist()) if problem.singularities else (),
            steps=steps, rejected=rejected, evaluations=evaluations, seconds=seconds,
        )  # fmt: skip


def _places(state: Any, name: str) -> slice:
    field = getattr(state, name)
    return slice(field.offset // 8, (field.offset + field.size) // 8)


_COUNTED = ("steps", "rejected", "evaluations", "status", "which")
_ENDED = {DONE: Stop("end", 0.0), SINGULAR: Stop("singular", 0.0)}
_MADE = Trajectory(
    np.empty(0),
    np.empty((0, 0)),
    Stop("end", 0.0),
    np.empty(0),
    (),
    evaluations=0,
    steps=0,
    rejected=0,
)
"""What a run that ends in its first call has in common with others."""


class _Plain:
    """The loop of a method whose inputs are held all the way."""

    def __init__(self, method: NativeMethod, problem: Problem, s: Any, store: _Store) -> None:
        self.method, self.s, self.o = method, ctypes.addressof(s), ctypes.addressof(store.output)
        self.p, self.u = trajectory.pointer(problem.parameters), trajectory.pointer(problem.inputs)

    def start(self) -> int:
        return int(self.method.start(self.s, self.p, self.u))

    def run(self, attempts: int) -> int:
        return int(self.method.run(self.s, self.u, self.o, attempts))

    def held(self) -> None:
        return None


def _loop(method: NativeMethod, problem: Problem, s: Any, store: _Store) -> _Plain | samples.Driver:
    if not problem.laws:
        return _Plain(method, problem, s, store)
    assert method.sampled is not None
    return samples.Driver(method.sampled, problem, s, store.output)


class _Clock:
    """Seconds in generated code, in all and in the last call."""

    def __init__(self) -> None:
        self.seconds = self.last = 0.0

    def timed(self, function: Callable[..., int], *args: object) -> int:
        """Call a function and add its time."""
        began = time.perf_counter()
        status = function(*args)
        self.last = time.perf_counter() - began
        self.seconds += self.last
        return status


def _next_call(most: int, seconds: float) -> int:
    """Return how many steps the next call may make; what is computed does not depend on it."""
    return min(STEPS_A_CALL, 2 * most) if seconds < CALL_SECONDS else max(1, most // 2)


_STOPS = {
    DONE: "end",
    SINGULAR: "singular",
    EVENT: "event",
    NOT_FINITE: "not finite",
    STEP_TOO_SMALL: "step",
    COARSE: "coarse",
    THIN: "thin",
    PAUSED: "max_steps",
    FULL: "max_steps",
}


def rows_of(grid: Array | None, n: int) -> tuple[Array, Array]:
    """Return room for times and states (n,); without a grid the first row is for the start."""
    room = 1 + FIRST_CAPACITY if grid is None else len(grid) or 1
    return np.empty(room), np.empty((room, n))


class _Store:
    """Growing arrays of times, states and, where asked for, interpolants."""

    def __init__(
        self,
        method: NativeMethod,
        problem: Problem,
        begun: tuple[Array, Array, Any] | None = None,
    ) -> None:
        """Begin, or go on with times, states and the structure of output of a run that has ``begun``."""
        self.n, self.finder = len(problem.x0), crossings.Finder(problem)
        self.terms, self.solution, self.notice = method.terms, method.solution, method.notice
        self.grid = None if problem.dense_output else problem.t_eval
        self.dense_output = problem.dense_output
        self.held: Held | None = None
        self.head = int(self.grid is None)
        if begun is not None:
            self.t, self.x, self.output = begun
            return
        self.t, self.x = rows_of(self.grid, self.n)
        if self.head:
            self.t[0], self.x[0] = problem.t_span[0], problem.x0
        capacity = len(self.t) - self.head
        self.dense = np.empty((capacity if self.dense_output else 0, self.terms, self.n))
        self.output = method.output(capacity=capacity)
        if self.grid is not None:
            self.output.grid, self.output.grid_count = (
                trajectory.pointer(self.grid) or self.t.ctypes.data,
                len(self.grid),
            )
        self._point()

    def _point(self) -> None:
        self.output.t = self.t[self.head :].ctypes.data
        self.output.x = self.x[self.head :].ctypes.data
        self.output.dense = self.dense.ctypes.data if self.dense_output else None

    def make_room(self) -> bool:
        """Double the arrays if they are full; False if there is no memory for that."""
        if self.grid is not None or self.output.count < self.output.capacity:
            return True
        try:
            self.t, self.x = trajectory.doubled(self.t), trajectory.doubled(self.x)
            if self.dense_output:
                self.dense = trajectory.doubled(self.dense)
        except MemoryError:
            return False
        self.output.capacity = len(self.dense) if self.dense_output else len(self.t) - self.head
        self._point()
        return True

    def begins_again(self, s: Any, problem: Problem) -> bool:
        """Forget a run whose equal steps were too long; True if the next ones are few enough.

        C says the next length, with a minus, in ``h``.
        """
        self.output.count = self.output.next = 0
        s.t, s.x[:], s.steps = problem.t_span[0], problem.x0.tolist(), 0
        length = abs(problem.t_span[1] - problem.t_span[0])
        return bool(length <= -s.h * (problem.max_steps - s.rejected))

    def trajectory(self, s: Any, stop: Stop, problem: Problem, seconds: float) -> Trajectory:
        """Return what was stored; without a grid the start is the first point."""
        count = self.output.count
        self.finder.empty(s)
        t, x = self.t[: self.head + count], self.x[: self.head + count]
        solution = None
        if self.dense_output:
            h = np.diff(t)
            if count:
                h[-1] = s.h_old
            solution = self.solution(t.copy(), h, x.copy(), self.dense[:count].copy())
            if problem.t_eval is not None:
                direction = np.sign(problem.t_span[1] - problem.t_span[0])
                reached = s.steps > 0 or stop.kind == "end"
                t = problem.t_eval[reached & (direction * (problem.t_eval - s.t) <= 0)]
                x = solution(t).T
        return Trajectory(
            t=t.copy(),
            y=np.array(x.T, order="C"),
            stop=stop,
            state_at_stop=np.array(s.x[:]),
            closest=tuple(s.closest[: problem.singularities]),
            evaluations=s.evaluations,
            steps=s.steps,
            rejected=s.rejected,
            solution=solution,
            seconds=seconds,
            found=self.finder.found() if problem.events else None,
            held=self.held,
            notice="; ".join(filter(None, (self.notice(s, problem), _of_jumps(s, problem)))),
        )


def _of_jumps(s: Any, problem: Problem) -> str:
    return jumps.notice(s, problem) if hasattr(s, "off_at") else ""


class DenseSolution(Stepwise):
    """Polynomials of a tableau's interpolant."""

    def _within(self, k: NDArray[np.intp], since: Array) -> Array:
        theta = (since / self._h[k])[:, None]
        terms = self._rows[k]
        value = terms[:, -1] * (theta if terms.shape[1] % 2 else 1 - theta)
        for j in range(terms.shape[1] - 2, -1, -1):
            value = (value + terms[:, j]) * (1 - theta if j % 2 else theta)
        return np.asarray(value + self._x[k])
