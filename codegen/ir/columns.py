"""Columns and matrices of values in programs that are being built: by their instruction numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction

from codegen.ir.passes import Slot
from codegen.ir.program import Builder, Program

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


def copied_at(b: Builder, program: Program, given: Mapping[Slot, int]) -> list[int]:
    """Append a program with whole numbers in place of some slots; return the new numbers."""
    return copied(b, program, {slot: b.const(Fraction(v)) for slot, v in given.items()})


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
