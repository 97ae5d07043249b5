"""Size and cost of generated code before anything is compiled: what each stage leaves to do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from codegen import passes
from codegen.compiled import generate, specialised
from codegen.lower import RATES, lower_system
from codegen.program import Program
from eom.system import System


@dataclass(frozen=True)
class Stage:
    """Operations of the right-hand side after a stage, and their cost in additions."""

    name: str
    operations: int
    cost: int | None = None


@dataclass(frozen=True)
class Report:
    """Stages of the right-hand side, its operations by kind, and the sizes of the files in bytes."""

    stages: tuple[Stage, ...]
    kinds: Mapping[str, int]
    sizes: Mapping[str, int]


def report(system: System, parameters: Mapping[str, float], target: str = "c") -> Report:
    """Return what generating code for ``system`` gives, with ``parameters`` fixed to numbers.

    Raises `InputError` as `codegen.compile` does.
    """
    lowered = passes.prune(lower_system(system), [RATES])
    program, layout = specialised(system, parameters)
    final = passes.prune(program, [RATES])
    names = list(system.parameter_names)
    fixed = {names.index(n): float(v) for n, v in parameters.items() if n in names}
    folded = passes.specialise(lowered, fixed, len(names))
    stages = (
        Stage("as written, every definition put in", tree_operations(system)),
        _stage("equal values shared, constants folded", lowered),
        *([_stage("parameter values compiled in", folded)] if fixed else []),
        _stage("partial sums shared", final),
    )
    files = generate(program, layout, target)
    sizes = {name: len(text.encode()) for name, text in files.items()}
    return Report(stages, final.counts(), sizes)


def _stage(name: str, program: Program) -> Stage:
    return Stage(name, sum(program.counts().values()), program.cost())


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


def show(system: System, parameters: Mapping[str, float], target: str) -> None:
    """Print what code generation leaves to compute; nothing is compiled."""
    from rich.console import Console
    from rich.table import Table

    found = report(system, parameters, target)
    stages = Table("right-hand side", "operations", "cost in additions", box=None, pad_edge=False)
    for stage in found.stages:
        stages.add_row(stage.name, f"{stage.operations:,}", f"{stage.cost:,}" if stage.cost else "")
    console = Console(soft_wrap=True)
    console.print(stages)
    console.print("kinds: " + ", ".join(f"{n} {op}" for op, n in found.kinds.items()))
    for name, size in found.sizes.items():
        console.print(f"{name}: {size:,} bytes")
