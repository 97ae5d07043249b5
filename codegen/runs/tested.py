"""Values tested against what a system assumes, quickly where they pass: `codegen.frontend.structure.Guard`.

Of many runs of one system most have the parameters of the one before, bit for bit: conditions on parameters
alone are then known to hold. The others are computed by functions of plain floats, generated of the same
programs. Where these do not say clearly that all is well, the guard itself decides, and says what is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from operator import itemgetter

import sympy as sp

from codegen.compiling.compiled import Compiled, generate
from codegen.frontend.layout import Layout, names_of
from codegen.frontend.structure import Condition
from codegen.ir.names import identifier
from codegen.ir.program import GROUPS, RATES
from codegen.native.trajectory import Array
from codegen.targets import load_module
from eom.quantities import TIME, Quantity

CLEARLY = 0.99
"""Part of what an assumption allows within which a value passes by the quick form."""


Values = Sequence[float]
Holds = Callable[[Values], bool]
"""Whether a condition holds clearly for the values of a run: states, inputs, parameters."""


class Tested:
    """The guard of a compiled system for runs that start at one ``time`` (s)."""

    def __init__(self, compiled: Compiled, time: float) -> None:
        layout, self.compiled, self.time = compiled.layout, compiled, time
        self.names = tuple(
            n for q in (layout.states, layout.inputs, layout.parameters) for n in names_of(q)
        )
        self.passed: bytes | None = None
        self.rows = tuple(_rows(compiled, self.names))
        others = {*self.names[len(layout.states) :]}
        self.of_states = all(others.isdisjoint(c.names) for c in _of_runs(compiled))

    def test(self, x: Array, u: Array, p: Array) -> None:
        """Raise `AssumptionError` or `InputError` for values that contradict what is assumed."""
        own = p.tobytes()
        is_known = own == self.passed
        if is_known and not self.rows:
            return
        values = x.tolist()
        if is_known:
            given = values if self.of_states else [*values, *u.tolist(), *p.tolist()]
            for holds in self.rows:
                if not holds(given):
                    break
            else:
                return
        known = dict(zip(self.names, [*values, *u.tolist(), *p.tolist()], strict=True))
        self.compiled.guard.check(self.compiled.structure.completed(known), self.time)
        self.passed = own


def _rows(compiled: Compiled, names: tuple[str, ...]) -> list[Holds]:
    """Return the conditions to test at each run: those on states and inputs, all of whose values are given.

    One that needs what is compiled in or the time beside these goes by the guard: it has no quick form.
    """
    found = _of_runs(compiled)
    return [_holds(c, names) if {*c.names} <= {*names} else _unknown for c in found]


def _of_runs(compiled: Compiled) -> list[Condition]:
    """Return the conditions on states and inputs, all of whose values are given."""
    layout = compiled.layout
    fixed = {*names_of(layout.parameters), *compiled.structure.names, TIME.name}
    known = fixed | {*names_of(layout.states), *names_of(layout.inputs)}
    return [c for c in compiled.guard.conditions if {*c.names} <= known and not {*c.names} <= fixed]


def _unknown(_: Values) -> bool:
    return False


def _holds(condition: Condition, names: tuple[str, ...]) -> Holds:
    """Return the quick form of a condition over values by these names; one of several has slack."""
    places, value = [names.index(n) for n in condition.names], _value(condition)
    if len(places) == 1:
        place, is_zero = places[0], condition.is_zero
        return lambda values: not is_zero and value(0.0, (), (values[place],), ())[0] >= 0.0
    pick = itemgetter(*places)
    part: float = CLEARLY * condition.assumption.tolerance

    def is_zero_clearly(values: Values) -> bool:
        numbers: Values = pick(values)
        found = value(0.0, (), numbers, ())[0]
        if -found <= part * max(numbers) >= found:  # most do, by the largest alone
            return True
        most = part * max(*numbers, -min(numbers))
        return -most <= found <= most

    def is_positive_clearly(values: Values) -> bool:
        numbers: Values = pick(values)
        most = part * max(*numbers, -min(numbers))
        return value(0.0, (), numbers, ())[0] >= -most

    return is_zero_clearly if condition.is_zero else is_positive_clearly


def _value(condition: Condition) -> Callable[..., Sequence[float]]:
    """Return the expression of a condition as a function of floats."""
    quantities = tuple(Quantity(sp.Symbol(n, real=True)) for n in condition.names)
    results = {**dict.fromkeys(GROUPS, ()), RATES: ("value",)}
    layout = Layout("condition", "condition", (), quantities, (), results)
    program = condition.program
    program = replace(program, results={RATES: program.results["value"]})
    files = generate(program, layout, "python")
    name = identifier(layout.name)
    function: Callable[..., Sequence[float]] = getattr(
        load_module(files[f"{name}.py"], name), RATES
    )
    return function
