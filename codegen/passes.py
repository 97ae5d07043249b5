"""Passes from program to program; each states its law and leaves a verified program."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from types import MappingProxyType

from codegen.ops import OPS, Instruction
from codegen.program import Builder, Program


def needed(program: Program, groups: Iterable[str]) -> set[int]:
    """Return the numbers of all values that ``groups`` of results depend on."""
    found = {k for g in groups for k in program.results[g]}
    for k in range(len(program.instructions) - 1, -1, -1):
        if k in found:
            found.update(program.instructions[k].args)
    return found


def prune(program: Program, groups: Iterable[str] | None = None) -> Program:
    """Keep only ``groups`` of results (all if None) and what they need. Values do not change."""
    kept = list(program.results if groups is None else groups)
    order = sorted(needed(program, kept))
    new = {old: k for k, old in enumerate(order)}
    instructions = [
        Instruction(i.op, tuple([new[a] for a in i.args]), i.value)
        for i in map(program.instructions.__getitem__, order)
    ]
    results = {g: tuple(new[k] for k in program.results[g]) for g in kept}
    names = {new[k]: name for k, name in program.names.items() if k in new}
    return Program(tuple(instructions), MappingProxyType(results), MappingProxyType(names))


def specialise(program: Program, values: Mapping[int, float], count: int) -> Program:
    """Fix parameter slots (of ``count``) to numbers, fold what becomes constant, and prune.

    Values do not change in exact arithmetic. The remaining parameters close ranks, in order.
    """
    slots = {old: new for new, old in enumerate(k for k in range(count) if k not in values)}

    def leaf(instruction: Instruction) -> Instruction:
        if instruction.op != "parameter":
            return instruction
        slot = int(instruction.value or 0)
        if slot in values:
            return Instruction("const", (), Fraction(values[slot]))
        return Instruction("parameter", (), slots[slot])

    return prune(_copy(program, range(len(program.instructions)), program.results, leaf))


def _copy(
    program: Program,
    keep: Iterable[int],
    results: Mapping[str, tuple[int, ...]],
    leaf: Callable[[Instruction], Instruction] = lambda instruction: instruction,
) -> Program:
    """Build the instructions ``keep`` anew, leaves mapped by ``leaf``; names go along."""
    b = Builder()
    new: dict[int, int] = {}
    for k in keep:
        op, args, _ = instruction = program.instructions[k]
        if op in OPS:
            new[k] = b.add(op, *(new[a] for a in args))
        else:
            mapped = leaf(instruction)
            new[k] = b.leaf(mapped.op, mapped.value)
    for k, name in program.names.items():
        if k in new:
            b.name(new[k], name)
    return b.program({g: [new[k] for k in r] for g, r in results.items()})
