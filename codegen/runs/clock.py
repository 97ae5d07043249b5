"""How one run keeps time: over the time since its start where that is late, given in the user's times.

What a system reads over such a time is of `codegen.runs.clock`.

Systems in time since a start, so that a run that starts late keeps its digits.

A system whose rates do not read time is the same at any time. In others a sum in which time has a part,
a t + b + y with a and b of parameters alone, becomes (a t0 + b) + (a tau + y): the first term, a phase,
is a further parameter, made with `DIGITS` digits of the two doubles that t0 is given in and rounded
once, and tau is the time since t0. Sines and cosines of such a sum are made of those of both terms, by
the theorem of addition; integer part and rest of a division (floor, mod) likewise; in a comparison
the phases of both sides are subtracted first. So nothing is rounded to the spacing of doubles at t0,
which is 2.4e-7 s in seconds since 1970.

What reads time otherwise, as sin(t^2) does, and inputs that are Python functions get the rounded sum.
Where that matters, and how much, `codegen.runs.clock` says.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from codegen.compiling.compiled import TARGETS, Compiled
from codegen.compiling.events import Event, bare, extended
from codegen.compiling.signals import Inputs
from codegen.frontend.layout import Layout, names_of
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.ops import LEAVES
from codegen.ir.passes import prune
from codegen.ir.program import Builder, Program, SameObject, bindings
from codegen.native.trajectory import Array, Problem
from eom.errors import InputError
from eom.quantities import Quantity

DIGITS = 50
"""Digits of phases at the start, beside those that its size takes."""
AT_START, CHANGE = "at start", "change"
"""Groups of the program of phases: their values at the start, and their change in one unit of time."""
_COMPARED = frozenset({"lt", "le", "eq"})
_SENSITIVE = frozenset(
    {"sin", "cos", "tan", "floor", "mod", "besselj", "bessely", "stumpff", "table", *_COMPARED}
)
"""Operations whose value depends on the absolute error of a large argument; that of the others, which
grow or end, on its relative error."""
_BOUNDED = frozenset({"tanh", "atan", "erf", "erfc", "sign", "and", "or", "not", *_SENSITIVE})
"""Operations behind which the size of an argument is gone."""


@dataclass(frozen=True)
class Relative:
    """A compiled system in time since a start.

    ``phases``: the program of what its further parameters hold, `AT_START` and `CHANGE`, over the
    parameters and two more, whose sum is the start. ``exposed``: those of them whose rounding matters.
    """

    compiled: Compiled
    phases: Program | None = None
    exposed: tuple[int, ...] = ()

    def completed(self, parameters: Array, start: tuple[float, float]) -> Array:
        """Return parameters (m,) or (m, N) with the further ones behind them."""
        if self.phases is None:
            return parameters
        if parameters.ndim == 1:
            return np.concatenate([parameters, self.values(AT_START, parameters, start)])
        different, place = np.unique(parameters, axis=1, return_inverse=True)
        columns = [self.values(AT_START, column, start) for column in different.T]
        return np.concatenate([parameters, np.array(columns).T[:, place.ravel()]])

    def values(self, group: str, parameters: Array, start: tuple[float, float]) -> Array:
        """Return a group of phases at a start that is the sum of two doubles, each rounded once."""
        assert self.phases is not None
        digits = DIGITS + round(math.log10(1.0 + max(map(abs, start))))
        point = Point(p=[*parameters.tolist(), *start])
        found = interpret_exactly(self.phases, point, digits)[group]
        return np.array([float(value) for value in found])

    def resolution(self, parameters: Array, start: tuple[float, float], length: float) -> float:
        """Return to what time, in the unit of the system, exposed phases are rounded in a run.

        ``parameters``: (m,), or (m, N) for the coarsest of N runs.
        """
        if not self.exposed:
            return 0.0
        if parameters.ndim == 2:
            columns = np.unique(parameters, axis=1).T
            return max(self.resolution(column, start, length) for column in columns)
        exposed = list(self.exposed)
        first, speed = (
            np.abs(self.values(g, parameters, start)[exposed]) for g in (AT_START, CHANGE)
        )
        with np.errstate(all="ignore"):
            size = first + speed * abs(length)
            found = np.where(speed > 0, np.spacing(size) / speed, 0.0)
        return float(np.max(np.nan_to_num(found)))


def relative(compiled: Compiled, events: tuple[Event, ...] = ()) -> Relative:
    """Return a compiled system in time since a start, made once; itself where nothing reads time.

    ``events``: what is looked for, as `codegen.compiling.events.bare` gives it, over the same time.
    """
    return _relative_once(SameObject(compiled), events)


@lru_cache(maxsize=64)
def _relative_once(key: SameObject[Compiled], events: tuple[Event, ...]) -> Relative:
    compiled = key.value
    program, layout = compiled.program, compiled.layout
    if events:
        program, layout = extended(program, layout, compiled, events)
    if not any(i.op == "time" for i in prune(program).instructions):
        return Relative(compiled)
    return _compiled(compiled, events, program, layout)


def _compiled(
    compiled: Compiled, events: tuple[Event, ...], program: Program, layout: Layout
) -> Relative:
    shift = _Shift(program, len(layout.parameters))
    shifted = shift.program_of(program.results)
    layout = replace(layout, parameters=(*layout.parameters, *_quantities(layout, shift.count)))
    target, functions, notice = TARGETS[compiled.target](shifted, layout)
    made = Compiled(
        compiled.system,
        layout,
        shifted,
        target,
        compiled.structure,
        functions,
        notice or compiled.notice,
        origin=(_again, (compiled, events)),
        stable=compiled.stable,
    )
    return Relative(made, shift.phases(), shift.exposed)


def _again(compiled: Compiled, events: tuple[Event, ...]) -> Compiled:
    return relative(compiled, events).compiled


def _quantities(layout: Layout, count: int) -> tuple[Quantity, ...]:
    """Return quantities for the further parameters, with names that nothing else has."""
    taken = {n for group in layout.results.values() for n in group}
    taken |= {*names_of(layout.parameters), *names_of(layout.states), *names_of(layout.inputs)}
    stem = "phase"
    while any(name.startswith(stem) for name in taken):
        stem += "_at_start"
    return tuple(
        Quantity(sp.Symbol(f"{stem}_{k}", real=True), "", "of time, at the start")
        for k in range(count)
    )


Early = tuple[int, int]
"""A value of the program of phases: at the start, and where one unit of time has passed."""


class _Shift:
    """The instructions of a program over time since a start.

    ``first``: of each value that parameters and time at the start have a part in, that part;
    ``moved``: the rest, in the new program. The sum of both is made where it is used.
    """

    def __init__(self, program: Program, parameters: int) -> None:
        self.program, self.parameters = program, parameters
        self.b, self.early = Builder(program.rules), Builder(program.rules)
        self.new: dict[int, int] = {}
        self.first: dict[int, Early] = {}
        self.moved: dict[int, int] = {}
        self.slots: dict[int, int] = {}
        self.changes: list[int] = []
        self.reads: dict[int, frozenset[int]] = {}
        """For each value the phases that it is made of without their size being gone."""
        self.sensitive: set[int] = set()
        self._known = bindings(program)
        for k in range(len(program.instructions)):
            self._take(k)

    @property
    def count(self) -> int:
        """How many further parameters there are."""
        return len(self.slots)

    @property
    def exposed(self) -> tuple[int, ...]:
        """The phases whose rounding at the start matters, in order."""
        return tuple(sorted(self.sensitive))

    def program_of(self, results: Mapping[str, Sequence[int]]) -> Program:
        """Return the program over time since the start."""
        made = {g: [self.value(k) for k in r] for g, r in results.items()}
        for k, name in self.program.names.items():
            if k in self.new:
                self.b.name(self.new[k], name)
        return prune(self.b.program(made))

    def phases(self) -> Program:
        """Return the program of the further parameters."""
        return prune(self.early.program({AT_START: self.slots, CHANGE: self.changes}))

    def start(self) -> Early:
        """Return the start, which is given in two, and a unit of time later."""
        parts = [self.early.leaf("parameter", self.parameters + k) for k in (0, 1)]
        start = self.early.add("add", *parts)
        return start, self.early.add("add", start, self.early.const(1))

    def early_of(self, op: str, *args: Early) -> Early:
        """Return the value of an operation at the start."""
        one, other = (self.early.add(op, *values) for values in zip(*args, strict=True))
        return one, other

    def phase(self, first: Early) -> int:
        """Return the parameter that holds a value at the start."""
        if first[0] not in self.slots:
            self.slots[first[0]] = len(self.changes)
            self.changes.append(self.early.add("sub", first[1], first[0]))
        return self.b.leaf("parameter", self.parameters + self.slots[first[0]])

    def value(self, k: int) -> int:
        """Return the number of an old value in the new program."""
        if k not in self.moved:
            return self.new[k]
        return self.b.add("add", self.phase(self.first[k]), self.moved[k])

    def is_fixed(self, k: int) -> bool:
        """Return whether a value depends on constants and parameters alone."""
        return self._known[k] <= 1

    def _take(self, k: int) -> None:
        op, args, _ = instruction = self.program.instructions[k]
        if self.is_fixed(k):
            number = self.early.again(instruction, {a: self.first[a][0] for a in args})
            self.first[k] = number, number
        rule = _SPLIT.get(op) if op == "time" or any(a in self.moved for a in args) else None
        found = rule(self, op, args) if rule else None
        if found is None:
            self.new[k] = self._copied(k)
        elif isinstance(found, int):
            self.new[k] = found
        else:
            self.first[k], self.moved[k] = found

    def _copied(self, k: int) -> int:
        op, args, _ = instruction = self.program.instructions[k]
        if op in LEAVES:
            return self.b.again(instruction, ())
        found = self.b.again(instruction, {a: self.value(a) for a in args})
        read = frozenset[int]().union(*(self._read(a) for a in args))
        if op in _SENSITIVE:
            self.sensitive |= read
        self.reads[k] = frozenset() if op in _BOUNDED else read
        return found

    def _read(self, k: int) -> frozenset[int]:
        if k not in self.moved:
            return self.reads.get(k, frozenset())
        return frozenset({self.slots[self.first[k][0]]})


Arguments = tuple[int, ...]
Found = tuple[Early, int] | int | None
"""The part at the start and the rest, or a whole value, or None where the operation is copied."""


def _of_time(s: _Shift, op: str, args: Arguments) -> Found:
    del op, args
    return s.start(), s.b.leaf("time")


def _of_sum(s: _Shift, op: str, args: Arguments) -> Found:
    """(A + x) + (B + y) = (A + B) + (x + y); what is not known at the start has no part there."""
    zeros = s.early.const(0), s.early.const(0)
    first = s.early_of(op, *(s.first.get(a, zeros) for a in args))
    rest = [s.moved[a] if a in s.moved else None if s.is_fixed(a) else s.new[a] for a in args]
    a, b = rest
    if a is None or b is None:
        one = b if a is None else a
        assert one is not None
        return first, s.b.add("neg", one) if a is None and op == "sub" else one
    return first, s.b.add(op, a, b)


def _of_negative(s: _Shift, op: str, args: Arguments) -> Found:
    return s.early_of(op, s.first[args[0]]), s.b.add(op, s.moved[args[0]])


def _of_product(s: _Shift, op: str, args: Arguments) -> Found:
    """Multiply both parts by what depends on parameters alone: c (A + x) = c A + c x."""
    one, other = args if args[0] in s.moved else args[::-1]
    if not s.is_fixed(other):
        return None
    return s.early_of(op, s.first[one], s.first[other]), s.b.add(op, s.moved[one], s.new[other])


def _of_quotient(s: _Shift, op: str, args: Arguments) -> Found:
    one, other = args
    if not s.is_fixed(other):
        return None
    return s.early_of(op, s.first[one], s.first[other]), s.b.add(op, s.moved[one], s.new[other])


def _of_phase(s: _Shift, op: str, args: Arguments) -> Found:
    """sin(A + x) = sin A cos x + cos A sin x; cos and tan likewise."""
    b, x, first = s.b, s.moved[args[0]], s.first[args[0]]
    sin_A, cos_A = (s.phase(s.early_of(f, first)) for f in ("sin", "cos"))
    sin_x, cos_x = b.add("sin", x), b.add("cos", x)
    sine = b.add("add", b.add("mul", sin_A, cos_x), b.add("mul", cos_A, sin_x))
    cosine = b.add("sub", b.add("mul", cos_A, cos_x), b.add("mul", sin_A, sin_x))
    return b.add("div", sine, cosine) if op == "tan" else {"sin": sine, "cos": cosine}[op]


def _of_integer(s: _Shift, op: str, args: Arguments) -> Found:
    """floor(A + x) = floor A + floor(A - floor A + x)."""
    first = s.first[args[0]]
    whole = s.early_of(op, first)
    rest = s.phase(s.early_of("sub", first, whole))
    return whole, s.b.add(op, s.b.add("add", rest, s.moved[args[0]]))


def _of_rest(s: _Shift, op: str, args: Arguments) -> Found:
    """mod(A + x, p) = mod(mod(A, p) + x, p)."""
    a, period = args
    if a not in s.moved or not s.is_fixed(period):
        return None
    first = s.phase(s.early_of(op, s.first[a], s.first[period]))
    return s.b.add(op, s.b.add("add", first, s.moved[a]), s.new[period])


def _of_comparison(s: _Shift, op: str, args: Arguments) -> Found:
    """A + x < B + y where (A - B) + (x - y) < 0."""
    first, moved = _parts(_of_sum(s, "sub", args))
    return s.b.add(op, s.b.add("add", s.phase(first), moved), s.b.const(0))


def _parts(found: Found) -> tuple[Early, int]:
    assert isinstance(found, tuple)
    return found


_SPLIT: Mapping[str, Callable[[_Shift, str, Arguments], Found]] = {
    "time": _of_time,
    "add": _of_sum,
    "sub": _of_sum,
    "neg": _of_negative,
    "mul": _of_product,
    "div": _of_quotient,
    "floor": _of_integer,
    **dict.fromkeys(("sin", "cos", "tan"), _of_phase),
    "mod": _of_rest,
    **dict.fromkeys(_COMPARED, _of_comparison),
}
"""What is made of an operation of which an argument has a part at the start."""


COARSEST = 1e-3
"""Part of a run that time must be resolved to, where what reads it needs its absolute value."""


def is_late(t_span: tuple[float, float]) -> bool:
    """Return whether both ends of a run are farther from zero than from each other.

    Other runs lose at most one digit of two by time that is counted from zero.
    """
    start, end = t_span
    return min(abs(start), abs(end)) > abs(end - start)


@dataclass(frozen=True)
class Clock:
    """How one run keeps time: ``epoch``, time of its zero for the rates, and ``start``.

    A run over ``t_span`` is made over times since ``start``, and given in times since ``epoch``.
    """

    relative: Relative
    epoch: float
    start: float
    t_span: tuple[float, float]

    @property
    def zero(self) -> tuple[float, float]:
        """The time at which that of the run is zero, as a sum of two."""
        return self.epoch, self.start

    def problem(self, problem: Problem) -> Problem:
        """Return a problem over the time of the run; differences of near doubles are exact."""
        return replace(
            problem,
            t_span=span_since(problem.t_span, self.start),
            t_eval=None if problem.t_eval is None else problem.t_eval - self.start,
            parameters=self.relative.completed(problem.parameters, self.zero),
            laws=tuple(
                replace(law, called=law.called and law.called.since(self.zero))
                for law in problem.laws
            ),
            start=self.start,
        )

    def signals(self, inputs: Inputs | None) -> Inputs | None:
        """Return functions of time as functions of the time of the run; the sum is rounded."""
        return None if inputs is None else inputs.since(self.zero)

    def doubt(self, parameters: Array, rtol: float, inputs: Inputs | None = None) -> str:
        """Return what a user should know of how well time is resolved in a run, or nothing.

        ``parameters``: as the user gave them, (m,), or (m, N) of N runs. Raises `InputError` where rates or
        inputs have time rounded to more than `COARSEST` of the run.
        """
        length = abs(self.t_span[1] - self.t_span[0])
        apart = float(np.spacing(max(map(abs, self.t_span))))
        reasons = [f"t_span is taken for {length:g} s long, doubles there are {apart:g} s apart"]
        unit = self.relative.resolution(parameters, self.zero, length)
        if inputs is not None:
            unit = max(unit, float(np.spacing(abs(sum(self.zero)) + length)))
        if apart <= COARSEST * length:
            reasons.clear()
        if unit > rtol * length:
            reads = "inputs that are functions of time" if inputs else "rates that need time itself"
            reasons.append(f"{reads} have it rounded to {unit:.2g} s")
        if unit > COARSEST * length:
            raise InputError(
                "the run starts so late that time is not resolved",
                got=f"{reasons[-1]}, in a run of {length:.6g} s",
                expected="time in phases a t + b, or an earlier start",
                hint="count time from a later zero",
            )
        return "; ".join(reasons)

    def times(self, t: Array, problem: Problem, *, ended: bool) -> Array:
        """Return times of a run in the user's times; ``problem`` is that of the user."""
        return user_times(t, self.start, problem.t_eval, self.t_span[1] if ended else None)


def span_since(t_span: tuple[float, float], start: float) -> tuple[float, float]:
    """Return an interval of time, since ``start``."""
    return t_span[0] - start, t_span[1] - start


def user_times(t: Array, start: float, t_eval: Array | None, end: float | None) -> Array:
    """Return stored times since ``start`` in the user's times; ``end``: the last, where that is known."""
    if t_eval is not None:
        return t_eval[: len(t)].copy()
    found = start + t
    if end is not None and len(found):
        found[-1] = end
    return found


@dataclass(frozen=True)
class Late:
    """Dense output as a function of the user's times: ``sol(t)`` has shape (n,) or (n, len(t)).

    ``solution``: over times since ``start``.
    """

    solution: Any
    start: float

    @property
    def ts(self) -> Array:
        """The ends of the steps."""
        return np.asarray(self.start + np.asarray(self.solution.ts))

    @property
    def t_min(self) -> float:
        """The earliest time of the run."""
        return float(self.start + self.solution.t_min)

    @property
    def t_max(self) -> float:
        """The latest time of the run."""
        return float(self.start + self.solution.t_max)

    def __call__(self, t: Any) -> Array:
        """Evaluate; differences of times to the start are exact."""
        values: Array = self.solution(np.asarray(t, dtype=np.float64) - self.start)
        return values


def clock_of(
    compiled: Compiled, t_span: tuple[float, float], epoch: float, events: Sequence[Event]
) -> Clock | None:
    """Return how a run keeps time, or None for one over the time of its system."""
    start = t_span[0] if is_late(t_span) else 0.0
    if not start and not epoch:
        return None
    return Clock(relative(compiled, bare(events)), epoch, start, t_span)
