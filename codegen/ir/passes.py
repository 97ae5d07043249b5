"""Passes from program to program; each states its law and leaves a verified program.

Columns and matrices of values in programs that are being built: by their instruction numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import compress
from types import MappingProxyType

from codegen.ir.fold import RuleSet
from codegen.ir.ops import OPS, Instruction, instruction_of
from codegen.ir.program import Builder, Name, Program

Slot = tuple[str, int]
"""A leaf that reads an array: state, parameter or input, and the place in it."""


def needed(program: Program, groups: Iterable[str]) -> set[int]:
    """Return the numbers of all values that ``groups`` of results depend on."""
    return set(_needed(program.instructions, [program.results[g] for g in groups]))


def _needed(instructions: Sequence[Instruction], results: Collection[tuple[int, ...]]) -> list[int]:
    """Return the numbers of all that results depend on, in order."""
    size = max(map(max, filter(None, results)), default=-1) + 1
    found = bytearray(size)
    for k in (k for result in results for k in result):
        found[k] = 1
    for k in range(size - 1, -1, -1):
        if found[k]:
            for a in instructions[k][1]:
                found[a] = 1
    return list(compress(range(size), found))


def dependence(program: Program, group: str, kind: str = "state") -> set[tuple[int, int]]:
    """Return (result, slot) wherever a result can depend on a slot; nothing is differentiated.

    Law: it covers the pattern of every Jacobian of the group.
    """
    reads: dict[int, frozenset[int]] = {}
    for k in sorted(needed(program, [group])):
        instruction = program.instructions[k]
        own = frozenset([instruction.slot]) if instruction.op == kind else frozenset()
        reads[k] = own.union(*(reads[a] for a in instruction.args))
    return {(row, slot) for row, k in enumerate(program.results[group]) for slot in reads[k]}


def prune(program: Program, groups: Iterable[str] | None = None) -> Program:
    """Keep only ``groups`` of results (all if None) and what they need. Values do not change.

    A program of which nothing is left out is returned as it is.
    """
    kept = list(program.results if groups is None else groups)
    order = _needed(program.instructions, [program.results[g] for g in kept])
    if len(order) == len(program.instructions) and kept == list(program.results):
        return program
    results = {g: program.results[g] for g in kept}
    return _restricted(order, program.instructions, results, program.names, program.rules)


def pruned(
    instructions: Sequence[Instruction],
    results: Mapping[str, tuple[int, ...]],
    names: Mapping[int, Name],
    rules: RuleSet,
) -> Program:
    """Return the program of what results need of some instructions, which are valid as they are."""
    order = _needed(instructions, results.values())
    return _restricted(order, instructions, results, names, rules)


def _restricted(
    order: Sequence[int],
    instructions: Sequence[Instruction],
    results: Mapping[str, tuple[int, ...]],
    names: Mapping[int, Name],
    rules: RuleSet,
) -> Program:
    """Return the program of the instructions ``order``, numbered anew."""
    new = [-1] * len(instructions)
    for k, old in enumerate(order):
        new[old] = k
    made: list[Instruction] = []
    for old in order:
        instruction = instructions[old]
        op, args, value = instruction
        if len(args) == 2:  # most instructions, in half the time
            x, y = args
            instruction = instruction_of((op, (new[x], new[y]), value))
        elif args:
            instruction = instruction_of((op, tuple([new[a] for a in args]), value))
        made.append(instruction)
    left = {g: tuple([new[k] for k in r]) for g, r in results.items()}
    named = {new[k]: name for k, name in names.items() if new[k] >= 0}
    return Program(tuple(made), MappingProxyType(left), MappingProxyType(named), rules)


def depth_first(program: Program) -> Program:
    """Order what results need by the result that needs it first, leaves before everything.

    Values do not change; what is used late is computed late, so that fewer values wait at a time.
    """
    order = [k for k in sorted(needed(program, program.results)) if _is_leaf(program, k)]
    placed = set(order)
    for result in (k for group in program.results.values() for k in group):
        stack = [result]
        while stack:
            k = stack[-1]
            waiting = [a for a in program.instructions[k].args if a not in placed]
            if waiting and k not in placed:
                stack.extend(reversed(waiting))
                continue
            stack.pop()
            if k not in placed:
                placed.add(k)
                order.append(k)
    return _copy(program, order, program.results)


def _is_leaf(program: Program, k: int) -> bool:
    return program.instructions[k].op not in OPS


def substitute(program: Program, leaves: Mapping[Slot, Slot | Fraction]) -> Program:
    """Read other slots, or numbers, instead of some slots; fold what becomes equal; prune.

    Law: the new program has the values that the old one has where the old slots hold what the new
    ones or the numbers give.
    """

    def leaf(instruction: Instruction) -> Instruction:
        if not isinstance(instruction.value, int):
            return instruction
        new = leaves.get((instruction.op, instruction.value))
        if isinstance(new, Fraction):
            return Instruction("const", (), new)
        return Instruction(new[0], (), new[1]) if new else instruction

    return prune(_copy(program, range(len(program.instructions)), program.results, leaf))


def _copy(
    program: Program,
    keep: Iterable[int],
    results: Mapping[str, tuple[int, ...]],
    leaf: Callable[[Instruction], Instruction] = lambda instruction: instruction,
) -> Program:
    """Build the instructions ``keep`` anew, leaves mapped by ``leaf``; names go along."""
    b = Builder(program.rules)
    new: dict[int, int] = {}
    for k in keep:
        op, args, data = instruction = program.instructions[k]
        if op in OPS:
            new[k] = b.add(op, *(new[a] for a in args), value=data)
        else:
            mapped = leaf(instruction)
            new[k] = b.leaf(mapped.op, mapped.value)
    for k, name in program.names.items():
        if k in new:
            b.name(new[k], name)
    return b.program({g: [new[k] for k in r] for g, r in results.items()})


Numbers = Sequence[int]
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
"""Places of the six entries of a symmetric matrix."""


def symmetric(entries: Numbers) -> list[list[int]]:
    """Return the rows of the symmetric matrix of six entries."""
    where = {pair: k for k, pair in enumerate(PAIRS)}
    return [[entries[where[min(i, j), max(i, j)]] for j in range(3)] for i in range(3)]


def total(b: Builder, terms: Iterable[tuple[int, int]]) -> int:
    """Return the sum of products of two."""
    value = b.const(0)
    for x, y in terms:
        value = b.add("add", value, b.add("mul", x, y))
    return value


def times(b: Builder, matrix: Sequence[Numbers], vector: Numbers) -> list[int]:
    """Return a matrix times a column."""
    return [total(b, zip(row, vector, strict=True)) for row in matrix]


def cross(b: Builder, x: Numbers, y: Numbers) -> list[int]:
    """Return the cross product."""
    order = ((1, 2), (2, 0), (0, 1))
    return [b.add("sub", b.add("mul", x[i], y[j]), b.add("mul", x[j], y[i])) for i, j in order]


def copied(b: Builder, program: Program, given: Mapping[Slot, int]) -> list[int]:
    """Append a program with ``given`` values in place of some slots; return the new numbers."""
    new: list[int] = []
    for instruction in program.instructions:
        known = None if instruction.args else given.get((instruction.op, instruction.slot))
        new.append(b.again(instruction, new) if known is None else known)
    return new


def transposed_times(b: Builder, matrix: Sequence[Numbers], vector: Numbers) -> list[int]:
    """Return the transpose of a matrix times a column."""
    return times(b, list(zip(*matrix, strict=True)), vector)


def inverse_times(b: Builder, matrix: Sequence[Numbers], vector: Numbers) -> list[int]:
    """Return the solution y of matrix y = vector for a symmetric matrix of order 3, by cofactors.

    A diagonal matrix, which shows in its instructions, takes a division each.
    """
    if all(_is_zero(b, matrix[i][j]) for i, j in PAIRS if i != j):
        return [b.add("div", v, matrix[k][k]) for k, v in enumerate(vector)]
    cofactors = [cross(b, matrix[i], matrix[j]) for i, j in ((1, 2), (2, 0), (0, 1))]
    determinant = total(b, zip(matrix[0], cofactors[0], strict=True))
    entries = [[b.add("div", c, determinant) for c in row] for row in cofactors]
    return times(b, entries, vector)


def _is_zero(b: Builder, number: int) -> bool:
    op, _, value = b.instructions[number]
    return op == "const" and not value


def rotation(b: Builder, q: Numbers) -> list[list[int]]:
    """Return C = 1 + 2 (q q^T - q.q 1 - q0 tilde(q)), which takes components in A to the body."""
    q0, *v = q
    twice = [b.add("mul", b.const(2), x) for x in v]

    def entry(i: int, j: int) -> int:
        if i == j:
            k, m = (n for n in range(3) if n != i)
            squares = total(b, ((twice[k], v[k]), (twice[m], v[m])))
            return b.add("sub", b.const(1), squares)
        k = 3 - i - j
        turn = b.add("mul", q0, twice[k])
        plus = (j - i) % 3 == 1
        return b.add("add" if plus else "sub", b.add("mul", twice[i], v[j]), turn)

    return [[entry(i, j) for j in range(3)] for i in range(3)]
