"""Runs that are prepared once and made many times: an `Integrator` has what does not depend on values.

A call takes values by name into arrays, tests them against what the system assumes, finds absolute
tolerances, and enters the loop; in generated C each of these is one call (`codegen/native/runs.c`).
What does not fit there, units in texts, functions, laws, defaults, or values that are refused, goes the
general way (`codegen.runs.given`), to the same numbers. Conditions on parameters alone are not tested
again while these stay the same, bit for bit.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from codegen.compiling import events as looked_for
from codegen.compiling.compiled import Compiled, compiled_of
from codegen.compiling.events import Event
from codegen.compiling.events import Given as EventsGiven
from codegen.frontend.layout import Layout, names_of
from codegen.integrate.choice import Decided, Task
from codegen.integrate.methods import METHODS, Native, begin, can_project, decided, integrator_of
from codegen.integrate.methods import Integrator as Loop
from codegen.integrate.scales import quickly
from codegen.ir.program import INVARIANTS, SINGULARITIES, Program
from codegen.loops.projection import chosen
from codegen.loops.running import Prepared
from codegen.native import native
from codegen.native.trajectory import Array, Problem, varied
from codegen.runs import arguments, pruning
from codegen.runs.clock import clock_of
from codegen.runs.given import (
    Given,
    InputsGiven,
    Values,
    given_of,
    part_of,
    smallest,
)
from codegen.runs.result import Found, Result, result_of
from codegen.runs.tested import Tested
from eom.errors import InputError, spelt, typed
from eom.system import System

DEFAULT_MARGIN = 1e-6
AUTO = "auto"
Progress = Callable[[float], None]


@dataclass(frozen=True)
class Asked:
    """How to integrate, checked: all arguments of a run but its values."""

    compiled: Compiled
    span: tuple[float, float]
    method: str
    rtol: float
    atol: ArrayLike | None
    grid: Array | None
    outputs: Sequence[str] | None
    dense_output: bool
    first_step: float | None
    max_step: float
    max_steps: int
    margin: float
    project: bool | str | Sequence[str] | None
    events: tuple[Event, ...]
    since: float

    def problem(self, compiled: Compiled) -> Problem:
        """Return the problem of a part of the system, without values."""
        nothing = np.empty(0)
        return Problem(
            nothing, self.span, nothing, nothing, self.rtol, nothing, self.margin,
            singularities=len(compiled.layout.results[SINGULARITIES]),
            t_eval=self.grid, dense_output=self.dense_output, first_step=self.first_step,
            max_steps=self.max_steps, max_step=self.max_step,
            project=_projected(compiled, self.project, self.method),
            events=looked_for.filters(self.events),
        )  # fmt: skip


def _projected(
    compiled: Compiled, project: bool | str | Sequence[str] | None, method: str
) -> tuple[str, ...]:
    """Return the invariants to project onto: by default those maintained, where the method can."""
    if project is not None:
        return chosen(compiled.layout, project)
    known = compiled.layout.results[INVARIANTS]
    maintained = tuple(n for n in compiled.system.maintained if n in known)
    return maintained if can_project(method) else ()


class _Ready:
    """A part of a system, and all that its runs have in common; its loop is compiled at the first."""

    def __init__(self, asked: Asked, part: pruning.Part) -> None:
        compiled = part.compiled
        self.asked, self.part, self.compiled = asked, part, compiled
        self.clock = clock_of(compiled, asked.span, asked.since, asked.events)
        self.problem = asked.problem(compiled)
        self.task = Task(compiled, self.problem, None, asked.events)
        self.names = names_of(compiled.layout.states)
        self.winding = any(a.winding for a in compiled.system.angles)
        self.fixed = self.clock is None and asked.method != AUTO and not compiled.system.sampled
        self.chooses = (
            self.clock is None
            and asked.method == AUTO
            and not (compiled.system.sampled or self.winding)
        )
        self._loop: tuple[Loop, str] | None = None
        self._quick: Prepared | None = None
        self._decided: tuple[bytes, Decided | None] = b"", None

    def loop(self, task: Task) -> tuple[Loop, str]:
        """Return what integrates a task, and its name; the same again where values do not matter."""
        if not self.fixed or task.signals is not None or task.problem.laws:
            return integrator_of(task, self.asked.method)
        return self.own_loop()

    def own_loop(self) -> tuple[Loop, str]:
        """Return the loop of all runs whose inputs are held, made once."""
        if self._loop is None:
            loop, used = integrator_of(self.task, self.asked.method)
            if isinstance(loop, Native) and not self.winding:
                self._quick = loop.quick(self.problem)
            self._loop = loop, used
        return self._loop

    def run(self, given: Given, atol: tuple[Array, str], progress: Progress | None) -> Result:
        """Integrate from what is given; ``atol``: tolerances, and what is to be said of them."""
        if given.signals is not None or given.laws or progress is not None:
            return self._in_general(given, atol, progress)
        quick, made, used = self._quick, None, ""
        began = 0.0
        if quick is not None:  # which says how long its loop takes
            made = quick.integrate(given.x0, given.values, given.held, atol[0])
            used = self.own_loop()[1]
        elif self.chooses and (decided := self._decision(given, atol[0])) is not None:
            run, used = decided
            began = time.perf_counter()
            made = run(given.x0, atol[0])
        if made is None:
            return self._in_general(given, atol, progress)
        seconds = time.perf_counter() - began if made.seconds is None else made.seconds
        found = Found(self._task, made, self.asked.method, None, ("", atol[1]), (given, atol[0]))
        return result_of(found, used, seconds, self.names, self.part.left_out)

    def _decision(self, given: Given, atol: Array) -> Decided | None:
        """Return what `auto` decides whatever the initial state, anew where other values are given."""
        values = given.values.tobytes() + given.held.tobytes()
        known, decision = self._decided
        if known != values:
            decision = decided(self._task(given, atol))
            self._decided = values, decision
        return decision

    def _problem(self, given: Given, atol: Array, progress: Progress | None = None) -> Problem:
        return varied(
            self.problem, x0=given.x0, parameters=given.values, inputs=given.held, atol=atol,
            laws=given.laws, progress=progress,
        )  # fmt: skip

    def _task(self, given: Given, atol: Array, progress: Progress | None = None) -> Task:
        problem = self._problem(given, atol, progress)
        return varied(self.task, problem=problem, signals=given.signals)

    def _in_general(
        self, given: Given, atol: tuple[Array, str], progress: Progress | None
    ) -> Result:
        asked, clock = self.asked, self.clock
        own = task = self._task(given, atol[0], progress)
        doubt = ""
        if clock is not None:
            doubt = clock.doubt(own.problem.parameters, asked.rtol, own.signals)
            moved, signals = clock.problem(own.problem), clock.signals(own.signals)
            task = Task(clock.relative.compiled, moved, signals, asked.events)
        integrate, used = self.loop(task)
        dense = varied(task.problem, dense_output=True) if self.winding else task.problem
        began = time.perf_counter()
        made = integrate(dense)
        seconds = time.perf_counter() - began if made.seconds is None else made.seconds
        if progress is not None:
            task.problem.report(made.stop.t)
        timing = None if clock is None else (clock, own.problem)
        found = Found(lambda: task, made, asked.method, timing, (doubt, atol[1]))
        return result_of(found, used, seconds, self.names, self.part.left_out)


class _Quick:
    """Values by name or in order, tested, in one call each; whatever does not fit is left to `given_of`."""

    def __init__(self, ready: _Ready, taken: Callable[..., bool]) -> None:
        asked, compiled = ready.asked, ready.compiled
        layout = compiled.layout
        self.part, self.taken = ready.part, taken
        self.states, self.parameters, self.inputs = (
            names_of(q) for q in (layout.states, layout.parameters, layout.inputs)
        )
        self.sizes = len(self.states), len(self.parameters), len(self.inputs)
        self.none = np.empty(0)
        self.tested = Tested(compiled, asked.span[0] + asked.since)
        plain = asked.atol is None
        self.scales = quickly(compiled, asked.span, asked.rtol, asked.since) if plain else None

    def given(
        self, initial: Values, parameters: Values, inputs: InputsGiven | None
    ) -> Given | None:
        """Return what is given, or None where it does not fit. Raises `AssumptionError` as `given_of`."""
        n, m, k = self.sizes
        x, p = np.empty(n), np.empty(m) if m else self.none
        u = np.empty(k) if k else self.none
        taken = self.taken
        if not (taken(initial, self.states, x) and taken(parameters, self.parameters, p)):
            return None
        if (inputs or k) and not taken(inputs, self.inputs, u):
            return None
        self.tested.test(x, u, p)
        return Given(self.part, (), x, p, u, None)

    def tolerances(self, given: Given) -> tuple[Array, str] | None:
        """Return absolute tolerances, and what is to be said of them; None where they are given."""
        scales = self.scales
        return None if scales is None else scales(given.x0, given.values, given.held)


class _Checked:
    """The arguments of a run, of the right types."""

    @typed
    def run(
        self, initial: Values, parameters: Values = None, inputs: InputsGiven | None = None
    ) -> tuple[Values, Values, InputsGiven]:
        """Return them. Raises `InputError` for others."""
        return initial, parameters, {} if inputs is None else inputs


class Integrator:
    """Runs of one system that differ in their values alone: see `codegen.integrator`, which makes it.

    ``method``, ``rtol``, ``t_span`` (s): as they were given. It may be called from several threads.
    """

    def __init__(self, asked: Asked, inputs: InputsGiven) -> None:
        self._asked, self._inputs = asked, inputs
        self.method, self.rtol, self.t_span = asked.method, asked.rtol, asked.span
        part = part_of(asked.compiled, asked.outputs, asked.events, inputs)
        self._ready = ready = _Ready(asked, part)
        extension = native.extension() if asked.compiled.target == "c" else None
        whole = part.whole is part.compiled and not asked.compiled.system.sampled
        self._quick = _Quick(ready, extension.taken) if extension is not None and whole else None

    def __repr__(self) -> str:
        """Name the system, the method and the span."""
        start, end = self.t_span
        name = self._asked.compiled.layout.name
        return f"Integrator({name!r}, {self.method}, rtol {self.rtol:g}, t from {start:g} to {end:g} s)"

    def run(
        self,
        initial: Values,
        parameters: Values = None,
        inputs: InputsGiven | None = None,
    ) -> Result:
        """Return one run, as `codegen.simulate` with the same arguments returns it.

        Parameters
        ----------
        initial : mapping or array
            Numbers by name or in order, texts with units by name.
        parameters : mapping or array, optional
            In the same forms.
        inputs : mapping, optional
            In the place of those that were given when this was made.

        Returns
        -------
        Result
            Nothing is evaluated that is not read. Units are those of the system.

        Raises
        ------
        InputError
            For unusable arguments.
        AssumptionError
            For values that contradict the system's assumptions.
        """
        return self._run(initial, parameters, inputs)

    def _prepare(self) -> Integrator:
        """Compile the loop, if the method says which it is, and return the same."""
        held = isinstance(self._inputs, Mapping) and not any(map(callable, self._inputs.values()))
        if self._ready.fixed and held:
            self._ready.own_loop()
        return self

    def _run(
        self,
        initial: Values,
        parameters: Values,
        inputs: InputsGiven | None,
        progress: Progress | None = None,
    ) -> Result:
        inputs = self._inputs if inputs is None else inputs
        quick, asked, ready = self._quick, self._asked, self._ready
        given = None if quick is None else quick.given(initial, parameters, inputs)
        if given is not None and quick is not None:
            atol = quick.tolerances(given)
        else:
            values, atol = _CHECKED.run(initial, parameters, inputs), None
            given = given_of(
                asked.compiled, values, asked.outputs, asked.events, asked.span, asked.since
            )
            if given.part.compiled is not ready.compiled:
                ready = _Ready(asked, given.part)
        if atol is None:
            atol = smallest(given, asked.atol, asked.since, asked.span, asked.rtol)
        return ready.run(given, atol, progress)


def run_of(
    prepared: Integrator,
    initial: Values,
    parameters: Values,
    inputs: InputsGiven | None,
    progress: Progress | None = None,
) -> Result:
    """Return one run of an integrator; ``progress``: called with the share that is done, 0 to 1."""
    return prepared._run(initial, parameters, inputs, progress)


def prepared(asked: Asked, inputs: InputsGiven | None) -> Integrator:
    """Return an integrator whose loop is compiled, if the method says which it is."""
    return Integrator(asked, {} if inputs is None else inputs)._prepare()


_CHECKED = _Checked()


def asked_of(
    system: System | Compiled,
    t_span: tuple[float, float] | None,
    method: str,
    rtol: float,
    atol: ArrayLike | None,
    t_eval: ArrayLike | None,
    outputs: Sequence[str] | None,
    dense_output: bool,
    first_step: float | None,
    max_step: float,
    max_steps: int,
    margin: float,
    project: bool | str | Sequence[str] | None,
    events: EventsGiven,
    epoch: float,
) -> Asked:
    """Return how to integrate. Raises `InputError` for what does not fit, whatever the values of a run."""
    found = looked_for.checked(events)
    span, relative, name = _span(t_span, t_eval), arguments.relative(rtol), spelt(method, METHODS)
    beside = None if outputs or found or project or epoch else loop_of(name, relative)
    return Asked(
        compiled_of(system, beside), span, name, relative, atol,
        None if t_eval is None else arguments.grid(t_eval, span), outputs, dense_output,
        arguments.optional(first_step, "first_step"), arguments.positive(max_step, "max_step"),
        arguments.count(max_steps), arguments.positive(margin, "margin"), project, found,
        arguments.finite(epoch, "epoch"),
    )  # fmt: skip


def loop_of(method: str, rtol: float) -> Callable[[Program, Layout], None]:
    """Return what begins to compile the loop of a method, for `codegen.ir.compile_progress.beside`."""
    return lambda program, layout: begin(program, layout, method, rtol)


def _span(t_span: tuple[float, float] | None, t_eval: ArrayLike | None) -> tuple[float, float]:
    """Return an interval of time: as given, or from the first to the last time to store."""
    if t_span is not None:
        return arguments.span(t_span)
    times = np.atleast_1d(arguments.numbers([] if t_eval is None else t_eval, "t_eval"))
    if times.size < 2:
        raise InputError(
            "no interval of time",
            got="no t_span" if t_eval is None else "no t_span, and less than two times in t_eval",
            expected="t_span, start and end, or t_eval, times to store from the start on",
        )
    return arguments.span((float(times.flat[0]), float(times.flat[-1])))
