"""Solve M x = f inside a program: blocks apart, small ones unrolled, larger ones by a factorisation.

The matrix is never inverted symbolically. States that no entry of M couples are solved apart. A small
block that is symmetric, as the mass matrices of mechanics are, becomes straight-line code, L D L^T
without exchanges, which is stable where it is positive definite; any other, and one with a zero on its
diagonal, becomes the operations of `codegen.ir.linsolve`, which exchange rows where a pivot is small.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from codegen.ir.linsolve import Shape
from codegen.ir.passes import prune
from codegen.ir.program import Builder
from codegen.ir.residues import vanishing

UNROLLED = 8
"""Largest block that becomes straight-line code."""

SINGULAR = Fraction(1, 2**50)
"""A pivot of straight-line code that is smaller, relative to its diagonal entry, has no right digit."""

Matrix = Sequence[Sequence[int]]


def solve(b: Builder, matrix: Matrix, right: Sequence[int]) -> list[int]:
    """Append the solution; ``matrix`` and ``right`` hold numbers of values.

    Law: matrix times solution is the right-hand side. Where straight-line code meets a matrix that is
    singular, or all but singular, to double precision, the solution is NaN.
    """
    x = list(right)
    for block in _blocks(b, matrix):
        part = [[matrix[i][j] for j in block] for i in block]
        loads = [right[i] for i in block]
        for i, number in zip(block, _solve_block(b, part, loads), strict=True):
            x[i] = number
    return x


def _blocks(b: Builder, matrix: Matrix) -> Iterator[list[int]]:
    """Yield the sets of rows that entries which are not zero connect."""
    n = len(matrix)
    left = dict.fromkeys(range(n))
    while left:
        block, stack = [], [next(iter(left))]
        del left[stack[0]]
        while stack:
            i = stack.pop()
            block.append(i)
            linked = [j for j in left if _is_entry(b, matrix[i][j]) or _is_entry(b, matrix[j][i])]
            for j in linked:
                del left[j]
            stack += linked
        yield sorted(block)


def _is_entry(b: Builder, number: int) -> bool:
    instruction = b.instructions[number]
    return instruction.op != "const" or instruction.value != 0


def _solve_block(b: Builder, matrix: Matrix, right: Sequence[int]) -> list[int]:
    n = len(right)
    symmetric = _symmetric(b, matrix)
    full = all(_is_entry(b, matrix[i][i]) for i in range(n))
    if n == 1 or (n <= UNROLLED and symmetric and full):
        return _unrolled(b, matrix, right)
    shape = Shape(n, symmetric)
    factor = b.add("factor", *(matrix[i][j] for i, j in shape.places), value=shape)
    solution = b.add("back", factor, *right)
    return [b.add("item", solution, value=k) for k in range(n)]


def _symmetric(b: Builder, matrix: Matrix) -> bool:
    """Tell whether a matrix is proved to be symmetric, modulo a prime (`codegen.ir.residues`)."""
    n = len(matrix)
    pairs = [(matrix[i][j], matrix[j][i]) for i in range(n) for j in range(i)]
    pairs = [(one, other) for one, other in pairs if one != other]
    if not pairs:
        return True
    program = prune(b.program({"one": [p[0] for p in pairs], "other": [p[1] for p in pairs]}))
    return all(vanishing(program, "one", "other"))


def _unrolled(b: Builder, matrix: Matrix, right: Sequence[int]) -> list[int]:
    """Append the solution of a symmetric system, by L D L^T without square roots or exchanges.

    Golub and Van Loan, Matrix Computations, 4th ed., algorithm 4.1.2, rows in an order that fills in
    little. Zeros are folded away.
    """
    order = _order(b, matrix)
    a = [[matrix[i][j] for j in order] for i in order]
    n = len(order)
    lower = [[b.const(0)] * n for _ in range(n)]
    pivots: list[int] = []
    for j in range(n):
        scaled = [b.add("mul", lower[j][k], pivots[k]) for k in range(j)]
        for i in range(j, n):
            entry = a[i][j]
            for k in range(j):
                entry = b.add("sub", entry, b.add("mul", lower[i][k], scaled[k]))
            if i == j:
                pivots.append(_guarded(b, entry, a[j][j]))
            else:
                lower[i][j] = b.add("div", entry, pivots[j])
    x = [right[i] for i in order]
    for i in range(n):
        for k in range(i):
            x[i] = b.add("sub", x[i], b.add("mul", lower[i][k], x[k]))
    x = [b.add("div", xi, d) for xi, d in zip(x, pivots, strict=True)]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] = b.add("sub", x[i], b.add("mul", lower[k][i], x[k]))
    return [x[order.index(i)] for i in range(n)]


def _guarded(b: Builder, pivot: int, diagonal: int) -> int:
    """Return the pivot, NaN where it has no right digit; one that is the entry itself needs no test."""
    if pivot == diagonal:
        return pivot
    least = b.add("mul", b.const(SINGULAR), b.add("abs", diagonal))
    large = b.add("lt", least, b.add("abs", pivot))
    return b.add("select", large, pivot, b.add("div", b.const(0), b.const(0)))


def _order(b: Builder, matrix: Matrix) -> list[int]:
    """Return the rows in the order of least degree (Tinney and Walker, 1967), ties by number."""
    n = len(matrix)
    near: dict[int, set[int]] = {i: set() for i in range(n)}
    for i in range(n):
        for j in range(n):
            if i != j and _is_entry(b, matrix[i][j]):
                near[i].add(j)
                near[j].add(i)
    order: list[int] = []
    while near:
        i = min(near, key=lambda k: (len(near[k]), k))
        order.append(i)
        linked = near.pop(i)
        for j in linked:
            near[j] = (near[j] | linked) - {i, j}
    return order
