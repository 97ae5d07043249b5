"""Straight-line programs: an instruction's number is its variable.

A `Program` is a tuple of instructions, each over earlier ones, and named groups of results. The
`Builder` folds constants exactly and numbers values: equal instructions are one.

Switching functions: values by whose signs the branches of a program choose.

The groups of results that the program of a system has.

Values as keys of caches by what they are, not by what they hold.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from types import MappingProxyType
from typing import Generic, NamedTuple, TypeVar

from codegen.ir import compile_progress, fold
from codegen.ir.linsolve import Shape
from codegen.ir.ops import (
    INTEGER_FIRST,
    LEAVES,
    OPS,
    SOLVE,
    VARIADIC,
    WITH_DATA,
    Data,
    Instruction,
    cost_of,
    instruction_of,
)
from eom.tables import Table

RATES, OUTPUTS, INVARIANTS, SINGULARITIES = "rates", "outputs", "invariants", "singularities"
GROUPS = (RATES, OUTPUTS, INVARIANTS, SINGULARITIES)
"""Groups of results of a lowered system."""
SAMPLES = "samples"
"""One more where laws are sampled: what their inputs, and the states of the control, become."""


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
    rules: fold.RuleSet = fold.ALGEBRAIC
    """The laws that it was folded by, and that passes may use."""

    def __post_init__(self) -> None:
        verify(self)

    def __str__(self) -> str:
        """Return one instruction a line, then the results."""
        lines = [f"{k} = {_text(i)}" for k, i in enumerate(self.instructions)]
        lines += [f"{g}: {' '.join(map(str, r))}" for g, r in self.results.items()]
        return "\n".join(lines)

    def cost(self) -> int:
        """Return the sum of the operations' costs, in additions."""
        return sum(map(cost_of, self.instructions))

    def counts(self) -> dict[str, int]:
        """Return how often each operation occurs, leaves left out, in the order of the table."""
        present = Counter(i.op for i in self.instructions)
        return {op: present[op] for op in OPS if op in present}


def _text(instruction: Instruction) -> str:
    if instruction.op in LEAVES:
        return (
            instruction.op if instruction.value is None else f"{instruction.op} {instruction.value}"
        )
    value = instruction.value
    data = repr(value.label) if isinstance(value, Table) else value
    if isinstance(data, Shape):
        data = f"{data.size}x{data.size}"
    return f"{instruction.op} {'' if data is None else f'{data} '}{' '.join(map(str, instruction.args))}"


_ARITIES = {name: row.arity for name, row in OPS.items()}
_FURTHER = {*WITH_DATA, *INTEGER_FIRST, *SOLVE}
"""Operations of which more is to be said than how many arguments they have."""


def verify(program: Program) -> None:
    """Assert that a program is well formed; a failure is a defect of a pass, not of an input."""
    if not any(program.instructions is known for known in tuple(_VERIFIED)):
        _verify_instructions(program)
        _VERIFIED.append(program.instructions)
    size = len(program.instructions)
    assert all(0 <= r < size for group in program.results.values() for r in group)


_VERIFIED: deque[tuple[Instruction, ...]] = deque(maxlen=8)
"""The latest instructions that are well formed: passes make several programs of the same ones.

Other threads append, so that a copy is looked through.
"""


def _verify_instructions(program: Program) -> None:
    for k, (op, args, value) in enumerate(program.instructions):
        arity = _ARITIES.get(op)
        if arity is None:
            assert op in LEAVES, (k, op)
            assert not args, (k, op)
            assert (value is None) == (op in {"pi", "time"}), (k, op)
            continue
        assert arity == len(args) or arity == VARIADIC, (k, op)
        for a in args:
            assert 0 <= a < k, (k, op, args)
        if op not in _FURTHER:
            assert value is None, (k, op)
            continue
        assert (value is None) != (op in WITH_DATA), (k, op)
        if op in INTEGER_FIRST:
            order = fold.constant(program, args[0])
            assert order is not None, (k, op)
            assert order.denominator == 1, (k, op)
            assert order >= 0, (k, op)
        elif op in SOLVE:
            _verify_solve(program, k)


def _verify_solve(program: Program, k: int) -> None:
    op, args, value = program.instructions[k]
    inner = program.instructions[args[0]]
    if isinstance(value, Shape):
        assert len(args) == value.entries, k
    elif op == "back":
        assert isinstance(inner.value, Shape), k
        assert len(args) == 1 + inner.value.size, k
    else:
        assert inner.op == "back", k
        assert isinstance(value, int), k
        assert 0 <= value < len(inner.args) - 1, k


BINDING = {
    "parameter": 1,
    "constant": 1,
    "time": 2,
    "clock": 2,
    "state": 3,
    "input": 3,
    "turned": 3,
    "factor": 3,
}
"""When leaves are known: 1 with the parameters, 2 with the time, 3 in each call; others always.

Factorisations are made in each call: they are no numbers that an array could keep."""


def bindings(program: Program) -> list[int]:
    """Return when each value is known: 0 always, 1 with parameters, 2 with time, 3 with states."""
    known: list[int] = []
    for op, args, _ in program.instructions:
        when = BINDING.get(op, 0)
        for a in args:
            if known[a] > when:  # noqa: PLR1730 - in half the time
                when = known[a]
        known.append(when)
    return known


_COMMUTATIVE = frozenset(name for name, row in OPS.items() if row.commutative)


class Builder:
    """Append instructions; equal ones are shared and constants are folded exactly."""

    def __init__(self, rules: fold.RuleSet = fold.ALGEBRAIC) -> None:
        self.rules = rules
        self.instructions: list[Instruction] = []
        self.names: dict[int, Name] = {}
        self.binding: list[int] = []
        """When values are known: 0 always, 1 with parameters, 2 with time, 3 with states and inputs."""
        self._numbers: dict[tuple[str, tuple[int, ...], Data], int] = {}
        self._constants: dict[tuple[int, int], int] = {}

    def leaf(self, op: str, value: Data = None) -> int:
        """Return the number of a leaf."""
        return self._number(op, (), value)

    def const(self, value: Fraction | float) -> int:
        """Return the number of an exact constant; a float is the dyadic fraction that it is."""
        ratio = value.as_integer_ratio()  # of ints: their hash is found at once
        known = self._constants.get(ratio)
        if known is None:
            known = self._constants[ratio] = self.leaf("const", Fraction(value))
        return known

    def add(self, op: str, *args: int, value: Data = None) -> int:
        """Return the number of the value of ``op`` on ``args``, folded by `codegen.ir.fold`.

        ``value``: the data of an operation that has some.
        """
        compile_progress.done()
        if op in _COMMUTATIVE and args[0] > args[1]:
            args = (args[1], args[0])
        folded = fold.fold(self, op, args, self.rules)
        return self._number(op, args, value) if folded is None else folded

    def again(self, instruction: Instruction, new: Mapping[int, int] | Sequence[int]) -> int:
        """Append an instruction of another program, its arguments renumbered by ``new``."""
        op, args, value = instruction
        if op in LEAVES:
            return self.leaf(op, value)
        return self.add(op, *(new[a] for a in args), value=value)

    def unfolded(self, op: str, *args: int) -> int:
        """Return the number of the value of ``op`` on ``args`` as it is written."""
        return self._number(op, args)

    def find(self, instruction: Instruction) -> int | None:
        """Return the number of an instruction that exists already, or None."""
        return self._numbers.get(instruction)

    def name(self, number: int, name: Name) -> None:
        """Call a value by ``name`` unless it has one; leaves keep their own."""
        if self.instructions[number].op not in LEAVES:
            self.names.setdefault(number, name)

    def _number(self, op: str, args: tuple[int, ...], value: Data = None) -> int:
        known = self._numbers.get((op, args, value))
        if known is None:
            known = len(self.instructions)
            instruction = instruction_of((op, args, value))
            self._numbers[instruction] = known
            self.instructions.append(instruction)
            binding = self.binding
            when = BINDING.get(op, 0)
            for a in args:
                if binding[a] > when:  # noqa: PLR1730 - in half the time
                    when = binding[a]
            binding.append(when)
        return known

    def program(self, results: Mapping[str, Iterable[int]]) -> Program:
        """Freeze what was built, with ``results`` by group."""
        groups = {g: tuple(r) for g, r in results.items()}
        return Program(
            tuple(self.instructions),
            MappingProxyType(groups),
            MappingProxyType(dict(self.names)),
            self.rules,
        )


_DIFFERENCES = frozenset({"min", "max", "lt", "le", "eq"})
"""Operations that choose by the sign of the difference of their arguments."""


def switches(b: Builder, varies: Sequence[bool]) -> list[int]:
    """Return the switching functions of what was built, each once; differences are added to it.

    ``varies``: whether a value changes with time. That of a difference is not known: it may still.
    """
    found = []
    for op, args, _ in tuple(b.instructions):
        if not any(varies[a] for a in args):
            continue
        if op in {"abs", "sign"}:
            found.append(args[0])
        elif op in _DIFFERENCES:
            found.append(b.add("sub", *args))
    return list(dict.fromkeys(found))


T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class SameObject(Generic[T]):
    """A value as a key by identity, kept alive while it is in a cache."""

    value: T

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SameObject) and other.value is self.value

    def __hash__(self) -> int:
        return id(self.value)
