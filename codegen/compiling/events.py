"""Events: zeros of expressions over the quantities of a system, found along a run.

An event is given as SciPy's are, by an expression instead of a function, so that generated code can
find it: every zero in a step, however many, in order of time (`codegen.loops.crossings`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

import sympy as sp

from codegen.compiling.compiled import Compiled
from codegen.derivatives.taylor import BRANCHES
from codegen.frontend.layout import Layout
from codegen.frontend.lower import Lowering
from codegen.ir.ops import TRUTH_VALUES
from codegen.ir.passes import prune
from codegen.ir.program import Builder, Program, bindings
from codegen.loops.crossings import GROUP
from codegen.native.trajectory import Array, Filter, Found
from codegen.passes.pipeline import formed, join, optimise
from eom.errors import InputError, typed_fields
from eom.system import System, as_expression

Expr = Any
if TYPE_CHECKING:
    _Alone: TypeAlias = Any  # SymPy has no types for checkers
else:
    _Alone = sp.Basic
_JUMPS = BRANCHES | TRUTH_VALUES | {"floor", "mod"}
_MOVES = 2
"""Binding of what varies with time or states."""


@typed_fields
@dataclass(frozen=True)
class Event:
    """A zero of ``expression``, over states, parameters, inputs, time, definitions and outputs.

    Parameters
    ----------
    expression : expression
        Over states, parameters, inputs, time, definitions and outputs, in any consistent units.
    direction : int, default 0
        1 for zeros at which it increases in the direction of integration, -1 for those at which it
        decreases, 0 for all; zeros that are touched and not crossed count for 0 alone.
    terminal : bool or int, default False
        Whether the run ends there, or at the how manyth.
    name : str, optional
        By default the expression.

    Raises
    ------
    InputError
        For what is no expression, no direction or no number of times.

    Notes
    -----
    A zero at the start is reported, as a crossing towards where the expression goes, but does not
    end the run.

    Examples
    --------
    >>> height = sp.Symbol("height", real=True)
    >>> Event(height, direction=-1, terminal=True, name="landing").label
    'landing'
    """

    expression: Expr
    direction: int = 0
    terminal: bool | int = False
    name: str = ""

    def __post_init__(self) -> None:
        if not isinstance(as_expression(self.expression), sp.Expr):
            raise InputError("an event is not an expression that can be zero", got=self.expression,
                             hint="give the difference of both sides: x - 1 for x = 1")  # fmt: skip
        if self.direction not in {-1, 0, 1}:
            raise InputError("an event has no such direction", got=self.direction,
                             expected="1 (up), -1 (down) or 0 (all)")  # fmt: skip
        if self.terminal < 0:
            raise InputError("an event cannot end a run so", got=f"terminal = {self.terminal}",
                             expected="True, False or a number of times")  # fmt: skip

    @property
    def label(self) -> str:
        """The name, or the expression as text."""
        return self.name or str(self.expression)


@dataclass(frozen=True)
class Occurrences:
    """Where an event happened: times ``t`` (K,), states ``y`` (n, K).

    ``direction`` (K,): 1, -1, or 0 where zero was touched.
    """

    t: Array
    y: Array
    direction: Any

    def __len__(self) -> int:
        return len(self.t)


Given = Sequence[Event | Expr] | Mapping[str, Event | Expr] | Event | _Alone | None


def checked(given: Given) -> tuple[Event, ...]:
    """Return events from what a user gives: events or expressions, one, in order, or by name.

    Raises `InputError` as `Event` does, and for repeated names.
    """
    if given is None:
        return ()
    if isinstance(given, Mapping):
        named = [(n, e if isinstance(e, Event) else Event(e)) for n, e in given.items()]
        found = [replace(e, name=n) for n, e in named]
    else:
        alone = isinstance(given, Event | sp.Basic | str)
        items: Sequence[Any] = [given] if alone else given  # type: ignore[assignment]
        found = [e if isinstance(e, Event) else Event(e) for e in items]
    labels = [e.label for e in found]
    for label in labels:
        if labels.count(label) > 1:
            raise InputError("two events have one name", got=label, hint="give each its own name")
    return tuple(found)


def filters(events: Sequence[Event]) -> tuple[Filter, ...]:
    """Return what a loop needs to know of events beside their expressions."""
    return tuple(Filter(e.direction, int(e.terminal)) for e in events)


def bare(events: Sequence[Event]) -> tuple[Event, ...]:
    """Return of events what generated code depends on: the expressions, and what they are called."""
    return tuple(Event(e.expression, name=e.label) for e in events)


def states_of(compiled: Compiled, events: Sequence[Event]) -> list[str]:
    """Return the names of the states that the expressions of events read."""
    system = compiled.system
    read = {s for e in events for s in _expanded(system, e).free_symbols}
    return [q.name for q in compiled.layout.states if q.symbol in read]


def _expanded(system: System, event: Event) -> Expr:
    """Return the expression without outputs and definitions; in sines angles go on without jumps.

    Law: sin(x + 2 pi n) = sin(x) for whole n, and so for cos.
    """
    outputs = {d.symbol: d.expression for d in system.outputs}
    whole = system.expand(as_expression(event.expression).xreplace(outputs))
    turns = {n: sp.Integer(0) for n in whole.atoms(sp.floor)}
    smooth = {
        f: f.xreplace({n: zero for n, zero in turns.items() if _is_turns(f.args[0], n)})
        for f in whole.atoms(sp.sin, sp.cos)
        if turns
    }
    return whole.xreplace(smooth)


def _is_turns(angle: Expr, n: Expr) -> bool:
    """Return whether a whole number stands in an angle as a factor of whole turns alone."""
    return bool((sp.expand(angle).coeff(n) / (2 * sp.pi)).is_Integer)


def extended(
    program: Program, layout: Layout, compiled: Compiled, events: Sequence[Event]
) -> tuple[Program, Layout]:
    """Return program and layout with one more group of results, the expressions of events.

    ``program``, ``layout``: of ``compiled``, or with further parameters and groups. Raises
    `InputError` for symbols that the system does not have, for what does not vary, and for branches.
    """
    b = Builder(program.rules)
    lowering = Lowering(b, _slots(b, layout, compiled), f"system {layout.name!r}")
    numbers = []
    for event in events:
        expression = _expanded(compiled.system, event)
        _check_symbols(expression, event, lowering, layout)
        number = lowering.lower(expression, f"event {event.label}")
        _check_values(b.program({GROUP: [number]}), event, layout)
        numbers.append(number)
    numbers += _sizes(b, numbers)
    whole = optimise(formed(prune(b.program({GROUP: numbers})), compiled.stable))
    groups = {group: prune(program, [group]) for group in program.results}
    labels = [e.label for e in events]
    results = {**layout.results, GROUP: (*labels, *(f"terms of {n}" for n in labels))}
    return join({**groups, GROUP: whole}), replace(layout, results=results)


def _slots(b: Builder, layout: Layout, compiled: Compiled) -> dict[Expr, int]:
    """Return what each symbol is: a slot, or the number that was compiled in."""
    system, fixed = compiled.system, compiled.structure
    slots = {system.time: b.leaf("time")}
    for op, group in (
        ("state", layout.states),
        ("parameter", layout.parameters),
        ("input", layout.inputs),
    ):
        slots |= {q.symbol: b.leaf(op, k) for k, q in enumerate(group)}
    numbers = {**fixed.parameters, **fixed.states, **fixed.inputs}
    quantities = {q.name: q.symbol for q in (*system.states, *system.parameters, *system.inputs)}
    for name, value in numbers.items():
        if name in quantities:
            slots[quantities[name]] = b.const(Fraction(float(value)))
    for name, other in fixed.equal.items():
        slots[quantities[name]] = slots[quantities[other]]
    return slots


def _check_symbols(expression: Expr, event: Event, lowering: Lowering, layout: Layout) -> None:
    unknown = sorted(str(s) for s in expression.free_symbols if s not in lowering.memo)
    if unknown:
        names = [str(s) for s in lowering.memo if getattr(s, "is_Symbol", False)]
        raise InputError(
            "an event has a symbol without a meaning",
            where=f"system {layout.name!r}, event {event.label}",
            got=", ".join(unknown),
            expected=f"{', '.join(sorted(set(names)))}, definitions or outputs",
            hint="take the system's own symbols: eom's are real, sp.Symbol(name, real=True)",
        )


def _check_values(program: Program, event: Event, layout: Layout) -> None:
    program = prune(program)
    moving = bindings(program)
    where = f"system {layout.name!r}, event {event.label}"
    if moving[program.results[GROUP][0]] < _MOVES:
        raise InputError("an event does not vary with time", where=where, got=event.expression)
    for (op, _, _), when in zip(program.instructions, moving, strict=True):
        if op in _JUMPS and when >= _MOVES:
            raise InputError(
                "an event has a branch",
                where=where,
                got=op,
                expected="a smooth expression",
                hint="give one event a branch: x - 1 and x + 1 for abs(x) - 1; "
                "of an angle the sine: sin(psi - 1)",
            )


def _sizes(b: Builder, numbers: Sequence[int]) -> list[int]:
    """Return values for the sizes of terms, times the rounding error of one a bound of that of a sum.

    That of a sum is the sum of those of its terms, that of a product the product; that of a function with
    slopes of at most 1 its value and that of its argument; others are the absolute value.
    """
    parts = set(numbers)
    for k in range(len(b.instructions) - 1, -1, -1):
        if k in parts and b.instructions[k].op in {*_SUMS, *_FLAT}:
            parts.update(b.instructions[k].args)
    size: dict[int, int] = {}
    for k in sorted(parts):
        op, args, _ = b.instructions[k]
        if op in _SUMS:
            sizes = [size[a] for a in args]
            size[k] = sizes[0] if len(sizes) == 1 else b.add(_SUMS[op], *sizes)
        elif op in _FLAT:
            size[k] = b.add("add", b.add("abs", k), size[args[0]])
        else:
            size[k] = b.add("abs", k)
    return [size[k] for k in numbers]


_SUMS = {"add": "add", "sub": "add", "neg": "neg", "mul": "mul"}
"""Operations, and what gives the size of their values from those of their arguments."""
_FLAT = frozenset({"sin", "cos", "atan", "tanh", "asinh", "erf"})


def occurrences(events: Sequence[Event], found: Found | None) -> dict[str, Occurrences]:
    """Return what was found by the names of the events."""
    if found is None:
        return {}
    rows = {e.label: found.which == k for k, e in enumerate(events)}
    return {
        label: Occurrences(found.t[own], found.x[own].T.copy(), found.direction[own])
        for label, own in rows.items()
    }
