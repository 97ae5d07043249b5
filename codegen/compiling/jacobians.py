"""Programs of derivatives: groups of results differentiated by all slots of some kinds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from codegen.derivatives.derivative import JACOBIAN, UNIT, Jacobian, derive, identity
from codegen.frontend.layout import Layout
from codegen.ir.groups import INVARIANTS, OUTPUTS, RATES
from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import Program
from codegen.passes.pipeline import formed, join, optimise
from eom.errors import unknown_name

KINDS: Mapping[str, str] = {
    "states": "state",
    "parameters": "parameter",
    "inputs": "input",
    "time": "time",
}
"""What can be differentiated by, and the slots that hold it."""


VALUES = "values"
"""The one group of a program whose Jacobian is compiled."""


def differentiated(
    program: Program, layout: Layout, of: tuple[str, ...], by: tuple[str, ...]
) -> Jacobian:
    """Return values and derivatives of groups of results, by all slots of some kinds."""
    together = tuple(k for group in of for k in program.results[group])
    values = prune(replace(program, results={VALUES: together}))
    columns = [
        {Instruction(KINDS[kind], (), None if kind == "time" else k): UNIT}
        for kind in by
        for k in range(slots(layout, kind))
    ]
    return derive(values, VALUES, identity(values, VALUES), columns)


def with_jacobians(
    program: Program, layout: Layout, by: Sequence[str], stable: bool = False
) -> tuple[Program, Layout]:
    """Return program and layout with one more group of results a kind of variables in ``by``.

    The group ``rates_by_states`` (and so on) holds the rates and then the entries of their
    Jacobian that are not zero everywhere; ``layout.patterns`` says where these stand. Raises
    `InputError` for other words than those of `KINDS`.
    """
    for kind in by:
        if kind not in KINDS:
            raise unknown_name("kind of variable", kind, KINDS)
    programs = {group: prune(program, [group]) for group in program.results}
    results, patterns = dict(layout.results), dict(layout.patterns)
    for kind in dict.fromkeys(by):
        group = f"{RATES}_by_{kind}"
        derived = differentiated(program, layout, (RATES,), (kind,))
        programs[group] = optimise(one_group(formed(derived.program, stable), group))
        entries = (f"d{r}_{c}" for r, c in derived.pattern)
        results[group], patterns[group] = (*layout.results[RATES], *entries), derived.pattern
    return join(programs), replace(layout, results=results, patterns=patterns)


def slots(layout: Layout, kind: str) -> int:
    """Return how many variables of a kind there are."""
    sizes = {
        "states": len(layout.states),
        "parameters": len(layout.parameters),
        "inputs": len(layout.inputs),
        "time": 1,
    }
    return sizes[kind]


def layout_of_derivatives(layout: Layout, suffix: str, names: tuple[str, ...]) -> Layout:
    """Return the layout of a program that has derivatives alone."""
    results = {JACOBIAN: names, OUTPUTS: (), INVARIANTS: ()}
    return replace(layout, name=f"{layout.name}_{suffix}", results=results, coordinates=())


def one_group(program: Program, group: str) -> Program:
    """Put the results before the entries of their Jacobian, as one group."""
    together = (*program.results[VALUES], *program.results[JACOBIAN])
    return replace(program, results={group: together})
