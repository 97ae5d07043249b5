"""Size and cost of generated code before anything is compiled: what each stage leaves to do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from codegen.compiling.compiled import generate
from codegen.frontend.lower import lower_system
from codegen.frontend.structure import Structure, fit
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Program
from codegen.loops.written import Choice
from codegen.passes.pipeline import formed, optimise, pressure, steps
from eom.system import System


@dataclass(frozen=True)
class Stage:
    """Operations of the right-hand side after a stage, and their cost in additions.

    ``pressure``: the largest number of values that wait for a later use.
    """

    name: str
    operations: int
    cost: int | None = None
    pressure: int | None = None


@dataclass(frozen=True)
class Report:
    """Stages of the right-hand side, its operations by kind, and the sizes of the files in bytes."""

    stages: tuple[Stage, ...]
    kinds: Mapping[str, int]
    sizes: Mapping[str, int]


def report(
    system: System,
    parameters: Mapping[str, float],
    target: str = "c",
    integrator: Choice | None = None,
) -> Report:
    """Return what generating code for ``system`` gives, with ``parameters`` fixed to numbers.

    Raises `InputError` as `codegen.compile` does.
    """
    structure = Structure.of(system, parameters)
    lowered = lower_system(system)
    folded, layout = fit(lowered, system, structure)
    final = prune(folded, [RATES])
    stages = [
        Stage("as written, every definition put in", tree_operations(system)),
        _stage("equal values shared, constants folded", prune(lowered, [RATES])),
        *([_stage("parameter values compiled in", final)] if structure.names else []),
    ]
    met: set[str] = set()
    kept = formed(folded, stable=False)
    final = prune(kept, [RATES])
    stages.append(_stage("forms that keep digits", final))
    for p, program in steps(final):
        stages.append(_stage(f"{p.name}, again" if p.name in met else p.name, program))
        met.add(p.name)
        final = program
    files = generate(optimise(kept), layout, target, integrator)
    sizes = {name: len(text.encode()) for name, text in files.items()}
    return Report(tuple(stages), final.counts(), sizes)


def _stage(name: str, program: Program) -> Stage:
    return Stage(name, sum(program.counts().values()), program.cost(), pressure(program))


def tree_operations(system: System) -> int:
    """Count operations of the right-hand side if nothing were shared; linear in distinct nodes."""
    known: dict[Any, int] = {}
    for definition in system.definitions:
        known[definition.symbol] = _operations(definition.expression, known)
    mass = () if system.mass_matrix is None else tuple(system.mass_matrix)
    return sum(_operations(e, known) for e in (*system.rates, *mass))


def _operations(expression: Any, known: dict[Any, int]) -> int:
    stack = [expression]
    while stack:
        node = stack[-1]
        if node in known:
            stack.pop()
            continue
        waiting = [a for a in node.args if a not in known]
        if waiting:
            stack.extend(waiting)
            continue
        own = len(node.args) - 1 if isinstance(node, sp.Add | sp.Mul) else int(bool(node.args))
        known[node] = own + sum(known[a] for a in node.args)
        stack.pop()
    return known[expression]


def show(
    system: System,
    parameters: Mapping[str, float],
    target: str,
    integrator: Choice | None = None,
) -> None:
    """Print what code generation leaves to compute; nothing is compiled."""
    from rich.console import Console
    from rich.table import Table

    found = report(system, parameters, target, integrator)
    titles = ("right-hand side", "operations", "cost in additions", "live")
    stages = Table(*titles, box=None, pad_edge=False)
    for stage in found.stages:
        numbers = (stage.operations, stage.cost, stage.pressure)
        stages.add_row(stage.name, *("" if n is None else f"{n:,}" for n in numbers))
    console = Console(soft_wrap=True)
    console.print(stages)
    console.print("kinds: " + ", ".join(f"{n} {op}" for op, n in found.kinds.items()))
    for name, size in found.sizes.items():
        console.print(f"{name}: {size:,} bytes")
