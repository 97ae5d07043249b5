"""Straight-line programs: an instruction's number is its variable.

A `Program` is a tuple of instructions, each over earlier ones, and named groups of results. The
`Builder` folds constants exactly and numbers values: equal instructions are one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from types import MappingProxyType
from typing import NamedTuple

from codegen import fold
from codegen.ops import LEAVES, OPS, Instruction


class Name(NamedTuple):
    """What a value is called in generated code, and the comment beside it."""

    name: str
    comment: str = ""


@dataclass(frozen=True, eq=False)
class Program:
    """Instructions in order, the results as groups of instruction numbers, and names of values.

    Programs compare by identity; their texts, ``str(program)``, compare by content.
    """

    instructions: tuple[Instruction, ...]
    results: Mapping[str, tuple[int, ...]]
    names: Mapping[int, Name] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        verify(self)

    def __str__(self) -> str:
        """Return one instruction a line, then the results."""
        lines = [f"{k} = {_text(i)}" for k, i in enumerate(self.instructions)]
        lines += [f"{g}: {' '.join(map(str, r))}" for g, r in self.results.items()]
        return "\n".join(lines)

    def cost(self) -> int:
        """Return the sum of the operations' costs, in additions."""
        return sum(OPS[i.op].cost for i in self.instructions if i.op in OPS)

    def counts(self) -> dict[str, int]:
        """Return how often each operation occurs, leaves left out, in the order of the table."""
        present = [i.op for i in self.instructions]
        return {op: present.count(op) for op in OPS if op in present}


def _text(instruction: Instruction) -> str:
    if instruction.op in LEAVES:
        return (
            instruction.op if instruction.value is None else f"{instruction.op} {instruction.value}"
        )
    return f"{instruction.op} {' '.join(map(str, instruction.args))}"


def verify(program: Program) -> None:
    """Assert that a program is well formed; a failure is a defect of a pass, not of an input."""
    for k, (op, args, value) in enumerate(program.instructions):
        if op in LEAVES:
            assert not args, (k, op)
            assert (value is None) == (op in {"pi", "time"}), (k, op)
        else:
            assert len(args) == OPS[op].arity, (k, op)
            assert max(args) < k, (k, op, args)
            assert min(args) >= 0, (k, op, args)
    size = len(program.instructions)
    assert all(0 <= r < size for group in program.results.values() for r in group)


_BINDING = {"parameter": 1, "time": 2, "state": 3, "input": 3}


class Builder:
    """Append instructions; equal ones are shared and constants are folded exactly."""

    def __init__(self) -> None:
        self.instructions: list[Instruction] = []
        self.names: dict[int, Name] = {}
        self.binding: list[int] = []
        """When values are known: 0 always, 1 with parameters, 2 with time, 3 with states and inputs."""
        self._numbers: dict[Instruction, int] = {}
        self._constants: dict[Fraction | float, int] = {}

    def leaf(self, op: str, value: Fraction | int | None = None) -> int:
        """Return the number of a leaf."""
        return self._number(Instruction(op, (), value))

    def const(self, value: Fraction | float) -> int:
        """Return the number of an exact constant; a float is the dyadic fraction that it is."""
        known = self._constants.get(value)
        if known is None:
            known = self._constants[value] = self.leaf("const", Fraction(value))
        return known

    def add(self, op: str, *args: int) -> int:
        """Return the number of the value of ``op`` on ``args``, folded by `codegen.fold`."""
        if OPS[op].commutative and args[0] > args[1]:
            args = (args[1], args[0])
        folded = fold.fold(self, op, args)
        return self._number(Instruction(op, args)) if folded is None else folded

    def find(self, instruction: Instruction) -> int | None:
        """Return the number of an instruction that exists already, or None."""
        return self._numbers.get(instruction)

    def name(self, number: int, name: Name) -> None:
        """Call a value by ``name`` unless it has one; leaves keep their own."""
        if self.instructions[number].op not in LEAVES:
            self.names.setdefault(number, name)

    def _number(self, instruction: Instruction) -> int:
        known = self._numbers.get(instruction)
        if known is None:
            known = len(self.instructions)
            self._numbers[instruction] = known
            self.instructions.append(instruction)
            args = instruction.args
            known_when = [self.binding[a] for a in args] or [_BINDING.get(instruction.op, 0)]
            self.binding.append(max(known_when))
        return known

    def program(self, results: Mapping[str, Iterable[int]]) -> Program:
        """Freeze what was built, with ``results`` by group."""
        groups = {g: tuple(r) for g, r in results.items()}
        return Program(
            tuple(self.instructions), MappingProxyType(groups), MappingProxyType(dict(self.names))
        )
