"""What a unit holds, as data: variables with value references, start values, programs, sampled laws.

Value references are those of ``unit.c``: time, states, their derivatives, parameters, inputs, outputs,
constants of the motion, event indicators, in this order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled, kept_jacobian
from codegen.compiling.sampled import start_values
from codegen.compiling.sparse import SparseJacobian
from codegen.frontend.layout import Layout, completed, names_of, to_array
from codegen.integrate import scales
from codegen.ir.passes import dependence, needed, prune
from codegen.ir.program import (
    INVARIANTS,
    OUTPUTS,
    RATES,
    Builder,
    Program,
    switches,
)
from codegen.native.trajectory import Law
from codegen.passes.pipeline import join
from codegen.runs import arguments
from eom.errors import InputError, shown
from eom.quantities import Quantity
from eom.units import read

Array = NDArray[np.float64]

INDICATORS = "indicators"
"""The group of results whose signs choose the branches of the rates."""
TIME, STATE, RATE, PARAMETER, INPUT, HELD, OUTPUT, INVARIANT, INDICATOR = (
    "time", "state", "rate", "parameter", "input", "held", "output", "invariant", "indicator",
)  # fmt: skip


class Variable(NamedTuple):
    """A variable of a unit.

    ``reference``: its value reference; ``kind``: state, rate and so on; ``number``: its place among
    those of its kind; ``start``: the value that it begins with, where it can be set.
    """

    reference: int
    kind: str
    number: int
    name: str
    unit: str
    meaning: str
    start: float | None = None


@dataclass(frozen=True)
class Unit:
    """A system with the values that it starts from, ready to be written as a unit.

    ``x``, ``p``, ``u``: start values; ``smallest``: absolute over relative tolerance of each state;
    ``rtol``: of the integrator inside; ``t_span``: of the default experiment.
    """

    compiled: Compiled
    x: Array
    p: Array
    u: Array
    smallest: Array
    rtol: float
    t_span: tuple[float, float]

    @cached_property
    def parts(self) -> tuple[Program, Layout]:
        """Program and layout with the event indicators as one more group of results."""
        program, layout = self.compiled.program, self.compiled.layout
        looks = _indicators(program)
        names = tuple(f"indicator_{k + 1}" for k in range(len(looks.results[INDICATORS])))
        whole = join({g: prune(program, [g]) for g in program.results} | {INDICATORS: looks})
        return whole, replace(layout, results={**layout.results, INDICATORS: names})

    @cached_property
    def jacobian(self) -> SparseJacobian:
        """Derivatives of rates and outputs by states and inputs."""
        return kept_jacobian(self.compiled, self.differentiated, ("states", "inputs"), "numpy")

    @property
    def differentiated(self) -> tuple[str, ...]:
        """The groups of results that have derivatives."""
        return (RATES, OUTPUTS) if self.compiled.layout.results[OUTPUTS] else (RATES,)

    @cached_property
    def laws(self) -> tuple[Law, ...]:
        """The sampled laws, with the places of the inputs that they set."""
        inputs = names_of(self.compiled.layout.inputs)
        return tuple(
            Law.of(
                s.period,
                s.delay,
                [inputs.index(d.name) for d in s.laws],
                stepped=tuple(inputs.index(d.name) for d in s.states),
            )
            for s in self.compiled.system.sampled
        )

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """All variables, in the order of their value references; no two have one name."""
        taken: set[str] = set()
        found = []
        for reference, row in enumerate(_rows(self)):
            name = plain(row.name)
            while name in taken:
                name = f"{name} ({row.kind})"
            taken.add(name)
            meaning, measure = plain(row.meaning), plain(row.unit)
            found.append(
                row._replace(reference=reference, name=name, meaning=meaning, unit=measure)
            )
        return tuple(found)

    def of(self, *kinds: str) -> tuple[Variable, ...]:
        """Return the variables of some kinds, in order."""
        return tuple(v for v in self.variables if v.kind in kinds)

    def dependencies(self, group: str, row: int) -> tuple[int, ...]:
        """Return the value references that a result depends on: time, states and inputs from outside."""
        places = self.of(STATE), self.of(INPUT, HELD)
        found = [
            places[k][slot]
            for k, kind in enumerate(("state", "input"))
            for result, slot in sorted(self._reads[group, kind])
            if result == row
        ]
        timed = [v for v in self.of(TIME) if group in self._timed]
        return tuple(v.reference for v in (*timed, *found) if v.kind != HELD)

    @cached_property
    def _reads(self) -> Mapping[tuple[str, str], set[tuple[int, int]]]:
        program = self.compiled.program
        groups = (RATES, OUTPUTS)
        return {(g, k): dependence(program, g, k) for g in groups for k in ("state", "input")}

    @cached_property
    def _timed(self) -> set[str]:
        program = self.compiled.program
        return {
            g
            for g in (RATES, OUTPUTS)
            if any(program.instructions[k].op == "time" for k in needed(program, [g]))
        }


def unit(
    compiled: Compiled,
    initial: Any,
    parameters: Any = None,
    inputs: Any = None,
    t_span: tuple[float, float] = (0.0, 10.0),
    rtol: float = 1e-9,
) -> Unit:
    """Return a unit that starts from values by name, as those of `codegen.simulate`.

    Raises `InputError` for unknown and missing names, for inputs that are functions of time, and for a
    tolerance that is not between 0 and 1.
    """
    layout, (begin, end) = compiled.layout, arguments.span(t_span)
    if begin >= end:
        raise InputError("an experiment ends before it begins", got=t_span)
    if not 0.0 < rtol < 1.0:
        raise InputError("rtol is no tolerance", got=rtol, expected="between 0 and 1")
    initial, inputs = start_values(compiled, initial, inputs or {})
    _refuse_functions(inputs)
    kinds = (("state", initial, layout.states), ("parameter", parameters, layout.parameters),
             ("input", inputs, layout.inputs))  # fmt: skip
    x, p, u = (to_array(completed(v, q), names_of(q), kind) for kind, v, q in kinds)
    point = scales.Point(x, p, u, 0.0)
    absolute, _ = scales.of_run(compiled, point, (begin, end), rtol, None)
    return Unit(compiled, x, p, u, absolute / rtol, rtol, (begin, end))


def plain(text: str) -> str:
    r"""Return a text in one line, of characters that XML takes.

    >>> plain("angle\n\x00of tilt")
    'angle of tilt'
    """
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def _refuse_functions(inputs: Any) -> None:
    values = inputs.values() if isinstance(inputs, Mapping) else [inputs]
    if any(map(callable, values)):
        raise InputError(
            "the inputs of a unit come from outside: they start from numbers",
            got=shown(inputs),
            hint="give a number each, or make the function of time a formula of the system",
        )


def _indicators(program: Program) -> Program:
    """Return the program of the values by whose signs the rates choose their branches."""
    rates = prune(program, [RATES])
    b, new = Builder(program.rules), list[int]()
    for instruction in rates.instructions:
        new.append(b.again(instruction, new))
    varies: list[bool] = []
    for op, args, _ in b.instructions:
        varies.append(op in {"time", "state", "input"} or any(varies[a] for a in args))
    return prune(b.program({INDICATORS: switches(b, varies)}))


def _per_second(unit: str) -> str:
    try:
        return read(f"({unit or '1'})/s").text
    except InputError:
        return f"({unit})/s"


def _rows(unit: Unit) -> list[Variable]:
    """Return the variables without their value references."""
    layout, held = unit.compiled.layout, unit.compiled.system.held
    rows = [Variable(0, TIME, 0, "time", "s", "time")]
    rows += _given(STATE, layout.states, unit.x)
    for k, q in enumerate(layout.states):
        name, meaning = f"der({q.name})", f"time derivative of {q.name}"
        rows.append(Variable(0, RATE, k, name, _per_second(q.unit), meaning))
    rows += _given(PARAMETER, layout.parameters, unit.p)
    for row in _given(INPUT, layout.inputs, unit.u):
        rows.append(row._replace(kind=HELD) if row.name in held else row)
    for kind, group in ((OUTPUT, OUTPUTS), (INVARIANT, INVARIANTS)):
        known = {q.name: (q.unit, q.meaning) for q in layout.described.get(group, ())}
        for k, name in enumerate(layout.results[group]):
            rows.append(Variable(0, kind, k, name, *known.get(name, ("", ""))))
    for k, name in enumerate(unit.parts[1].results[INDICATORS]):
        meaning = "a branch of the rates changes where its sign does"
        rows.append(Variable(0, INDICATOR, k, name, "", meaning))
    return rows


def _given(kind: str, quantities: Sequence[Quantity], values: Array) -> list[Variable]:
    return [
        Variable(0, kind, k, q.name, q.unit, q.meaning, float(v))
        for k, (q, v) in enumerate(zip(quantities, values, strict=True))
    ]
