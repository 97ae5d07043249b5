"""What a user gives of a run, checked and put in order: states, parameters, inputs, tolerances."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from codegen.compiling import events as looked_for
from codegen.compiling import sampled
from codegen.compiling.compiled import Compiled
from codegen.compiling.events import Event
from codegen.compiling.sampled import Sampled
from codegen.compiling.signals import Inputs, reads_state
from codegen.frontend.layout import completed, in_si, names_of, settled, to_array
from codegen.integrate import scales as sizes_of
from codegen.native.trajectory import Array, Law
from codegen.runs import arguments, pruning
from eom.errors import InputError

Values = Mapping[str, float | str] | Sequence[float] | Array | None
InputValue = float | str | Callable[..., float] | Sampled
InputsGiven = Mapping[str, InputValue] | Callable[..., Any] | Sampled


def in_si_of(compiled: Compiled, *values: Any) -> tuple[Any, ...]:
    """Return values by name in SI: those that are texts with units are converted."""
    return tuple(in_si(v, compiled.layout.known) for v in values)


class Given(NamedTuple):
    """What a user gives of a run, in order: states, parameters, held inputs, and what changes these."""

    part: pruning.Part
    laws: tuple[Law, ...]
    x0: Array
    values: Array
    held: Array
    signals: Inputs | None

    def point(self, since: float, start: float) -> sizes_of.Point:
        """Return where the run begins, behind the first samples."""
        if not self.laws:
            return sizes_of.Point(self.x0, self.values, self.held, since)
        at = (since + start, self.x0, self.values)
        first = sampled.first_inputs(self.part.compiled, self.laws, at, self.held)
        return sizes_of.Point(self.x0, self.values, first, since)


def given_of(
    compiled: Compiled,
    values: tuple[Values, Values, InputsGiven],
    outputs: Sequence[str] | None,
    events: Sequence[Event],
    span: tuple[float, float],
    since: float,
) -> Given:
    """Return what is given of a run: of ``values`` the initial ones, parameters and inputs.

    Symbolic laws among inputs are compiled with the system. ``since``: the time at which its own is zero.
    """
    compiled, rest, functions = sampled.split(compiled, values[2])
    initial, parameters = settled(*values[:2], compiled.layout.parameters)
    initial, parameters, rest = in_si_of(compiled, initial, parameters, rest)
    part = _part(compiled, outputs, events, rest, bool(functions))
    laws = sampled.laws_of(part.compiled, functions)
    sampled.check_laws(laws, span)
    initial, rest = sampled.start_values(part.compiled, initial, rest)
    if functions:
        names = names_of(part.compiled.layout.inputs)
        rest = {**{names[k]: 0.0 for law in laws if law.called for k in law.applied}, **rest}
    return Given(part, laws, *_numbers(part, initial, parameters, rest, span[0] + since))


def part_of(
    compiled: Compiled,
    outputs: Sequence[str] | None,
    events: Sequence[Event],
    given: InputsGiven,
) -> pruning.Part:
    """Return what of a system is integrated under these inputs."""
    compiled, rest, functions = sampled.split(compiled, given)
    return _part(compiled, outputs, events, rest, bool(functions))


def _part(
    compiled: Compiled,
    outputs: Sequence[str] | None,
    events: Sequence[Event],
    inputs: Mapping[str, InputValue] | Callable[..., Any],
    called: bool,
) -> pruning.Part:
    """Return what the outputs, and the expressions of events, need of a system.

    That is all of it where a Python function reads states, ``called`` at samples or always: nobody knows
    which; and where laws are sampled.
    """
    if outputs is not None and (called or compiled.system.sampled):
        pruning.part(compiled, outputs)  # the names are known
        outputs = None
    functions = [inputs] if callable(inputs) else inputs.values()
    if outputs is None or any(reads_state(f, "an input") for f in functions if callable(f)):
        return pruning.part(compiled, None)
    return pruning.part(compiled, [*outputs, *looked_for.states_of(compiled, events)])


def _numbers(
    part: pruning.Part, initial: Values, parameters: Values, inputs: InputsGiven, time: float
) -> tuple[Array, Array, Array, Inputs | None]:
    """Return initial state, parameters, held inputs, and the function of all if one is a function."""
    held, signals = _inputs(part.compiled, inputs)
    x0 = _start(part.compiled, part.start(initial))
    return x0, _parameters(part.compiled, parameters, x0, held, time), held, signals


def _start(compiled: Compiled, initial: Values) -> Array:
    states = compiled.layout.states
    free = completed(compiled.structure.without("state", initial), states)
    return to_array(free, names_of(states), "initial value")


def _inputs(compiled: Compiled, given: InputsGiven) -> tuple[Array, Inputs | None]:
    """Return held values and, if any input is a function, the function of all inputs."""
    names, states = names_of(compiled.layout.inputs), names_of(compiled.layout.states)
    if callable(given):
        if not names:
            raise InputError("the system has no inputs", got="a function of all inputs")
        held = np.zeros(len(names))
        return held, Inputs(held, names, given, states)
    inputs = compiled.structure.without("input", given)
    functions = {n: v for n, v in inputs.items() if callable(v)}
    values = {n: (0.0 if callable(v) else v) for n, v in inputs.items()}
    held = to_array(values, names, "input")
    return held, Inputs(held, names, functions, states) if functions else None


def _parameters(
    compiled: Compiled, parameters: Values, x0: Array, held: Array, time: float
) -> Array:
    """Return the parameters in order; test all values, and the time, against what the system assumes."""
    layout = compiled.layout
    names = names_of(layout.parameters)
    given = completed(
        compiled.structure.without("parameter", parameters), compiled.layout.parameters
    )
    spoken = given if isinstance(given, Mapping) else {}
    kept = {n: v for n, v in spoken.items() if n in names}
    known = dict(zip(names_of(layout.states), x0, strict=True))
    known |= dict(zip(names_of(layout.inputs), held, strict=True))
    if spoken != kept:
        compiled.guard.check(compiled.structure.completed({**known, **spoken}))
    values = to_array(kept if isinstance(given, Mapping) else given, names, "parameter")
    everything = {**known, **spoken, **dict(zip(names, values, strict=True))}
    compiled.guard.check(compiled.structure.completed(everything), time)
    return values


def smallest(
    given: Given, atol: ArrayLike | None, since: float, span: tuple[float, float], rtol: float
) -> tuple[Array, str]:
    """Return absolute tolerances, given or by the scales of the states, and which scales are not known."""
    if atol is None:
        point = given.point(since, span[0])
        return sizes_of.of_run(given.part.compiled, point, span, rtol, given.signals)
    return arguments.tolerances(atol, len(given.x0)), ""
