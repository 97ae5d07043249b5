"""Runs by generated integrators, whatever their method: called now and then until they end.

The first call of most runs is their last: `Quick` finds by place what is found by name elsewhere.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from codegen.loops import crossings, jumps, samples
from codegen.native import native, trajectory
from codegen.native.trajectory import Array, Held, Problem, Stop, Trajectory, varied

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

    def prepared(self, problem: Problem, **said: Any) -> Prepared | None:
        """Return runs of problems like this one but for their values, or None: see `takes`.

        ``said``: fields of their trajectories beside what is found.
        """
        if not self.takes(problem):
            return None
        memory = self.template.copy()
        (memory[self.t], memory[self.t_end]), memory[self.rtol] = problem.t_span, problem.rtol
        memory[self.margin], memory[self.h_max] = problem.margin, problem.max_step
        memory[self.h] = problem.first_step or 0.0
        return Prepared(self, problem, memory, said)

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
        """Integrate with these values; ``onward``: changes the problem behind the first call."""
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
            t, x = t[:kept].copy(), x[:kept].copy()
        return varied(
            self._made, t=t, y=x.T, state_at_stop=memory[quick.x].copy(),
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
