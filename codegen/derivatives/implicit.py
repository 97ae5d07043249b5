"""Derivatives of the solutions of linear systems inside programs.

A x = f gives A dx = df - dA x. The right-hand sides r_j of that become vertices of the linearised
graph: each depends on the entries of its row and of f with the solution as weights, and the solution
depends on it by the inverse of A, whose columns are solutions for unit vectors with the factorisation
that is there (Griewank and Walther, Evaluating Derivatives, 2nd ed., sect. 15.2).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from codegen.derivatives.forms import Form, Forms, Monomial, added
from codegen.ir.linsolve import Shape
from codegen.ir.program import Program


def vertices(program: Program) -> list[int]:
    """Return a number for each value, with room before each solution for its right-hand sides.

    The last entry is the first number that is free.
    """
    numbers, room = [], 0
    for k, (op, args, _) in enumerate(program.instructions):
        room += len(args) - 1 if op == "back" else 0
        numbers.append(k + room)
    return [*numbers, len(program.instructions) + room]


def right_hand_sides(
    forms: Forms,
    program: Program,
    solution: int,
    copied: Mapping[int, int],
    numbers: Sequence[int],
    edges: Mapping[int, Mapping[int, Form]],
) -> dict[int, dict[int, Form]]:
    """Return the edges into the right-hand sides of the ``back`` instruction ``solution``.

    ``copied``: numbers in the builder of ``forms``; ``numbers``: those of `vertices`; ``edges``:
    the vertices that vary.
    """
    factor, *right = program.instructions[solution].args
    shape = program.instructions[factor].value
    assert isinstance(shape, Shape)
    b = forms.b
    x = [b.add("item", copied[solution], value=i) for i in range(shape.size)]
    rows: list[dict[int, dict[Monomial, Fraction]]] = [{} for _ in right]

    def weigh(row: int, entry: int, weight: int) -> None:
        vertex = numbers[entry]
        if vertex in edges:
            added(rows[row].setdefault(vertex, {}), forms.of(weight))

    for row, entry in enumerate(right):
        weigh(row, entry, b.const(1))
    for (i, j), entry in zip(shape.places, program.instructions[factor].args, strict=True):
        weigh(i, entry, b.add("neg", x[j]))
        if shape.symmetric and i != j:
            weigh(j, entry, b.add("neg", x[i]))
    first = numbers[solution] - shape.size
    return {first + row: dict(into) for row, into in enumerate(rows) if into}


def entry_of_solution(
    forms: Forms,
    program: Program,
    item: int,
    copied: Mapping[int, int],
    numbers: Sequence[int],
    edges: Mapping[int, Mapping[int, Form]],
) -> dict[int, Form]:
    """Return the edges from the right-hand sides to the ``item`` instruction ``item``."""
    (solution,), entry = program.instructions[item].args, program.instructions[item].slot
    b = forms.b
    factor = b.instructions[copied[solution]].args[0]
    size = len(program.instructions[solution].args) - 1
    first = numbers[solution] - size
    found: dict[int, Form] = {}
    for row in range(size):
        if first + row in edges:
            unit = (b.const(int(k == row)) for k in range(size))
            column = b.add("back", factor, *unit)
            found[first + row] = forms.of(b.add("item", column, value=entry))
    return found
