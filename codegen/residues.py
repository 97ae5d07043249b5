"""Values of programs modulo a large prime, at random points: exact randomised tests of what a program is.

Sums, products and quotients are exact in the field; every other operation is an unknown function, one
random number for each list of arguments that it meets. Two rational functions of degree d that differ
agree at a random point with a chance of at most d / 2**521 (Schwartz and Zippel). The prime is that
large so that rational numbers can be read off their residues: numerators and denominators of up to
260 bits, which quotients and products of doubles of usual size have.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import isqrt

from codegen.ops import OPS, Instruction
from codegen.passes import Slot
from codegen.program import Program

PRIME = 2**521 - 1
NOT_A_NUMBER = None
Residue = int | None
"""None for 0/0, which stands for NaN in programs."""


class Unlucky(Exception):
    """A divisor happened to vanish at a random point."""


class RandomPoint:
    """Residues of leaves and of unknown functions, drawn at first use; the same seed gives the same."""

    def __init__(self, seed: int) -> None:
        self._draw = random.Random(seed)  # noqa: S311 - reproducible points, no secrets
        self._known: dict[object, int] = {}

    def draw(self) -> int:
        """Return a residue that is not zero."""
        return self._draw.randrange(1, PRIME)

    def leaf(self, op: str, slot: object) -> int:
        """Return the residue of a leaf of a program."""
        return self._unknown((op, slot))

    def values(self, program: Program, given: Mapping[Slot, int]) -> list[Residue]:
        """Return the residue of each instruction; ``given`` overrides leaves that are read by slot.

        Raises `Unlucky` where a divisor vanishes.
        """
        values: list[Residue] = []
        for instruction in program.instructions:
            operands = [values[a] for a in instruction.args]
            values.append(self._value(instruction, operands, given))
        return values

    def _value(
        self, instruction: Instruction, operands: Sequence[Residue], given: Mapping[Slot, int]
    ) -> Residue:
        op, _, data = instruction
        if op == "const":
            assert isinstance(data, Fraction)
            return residue(data)
        if op not in OPS:
            known = given.get((op, instruction.slot))
            return self.leaf(op, instruction.slot) if known is None else known
        if op == "select" and None in operands[1:]:
            return next((v for v in operands[1:] if v is not None), None)
        numbers = [v for v in operands if v is not None]
        if len(numbers) < len(operands):
            return NOT_A_NUMBER
        if op == "div":
            return _quotient(*numbers)
        if op in _FIELD:
            return _FIELD[op](*numbers) % PRIME
        key = sorted(numbers) if OPS[op].commutative else numbers
        return self._unknown((op, data, *key))

    def _unknown(self, key: object) -> int:
        if key not in self._known:
            self._known[key] = self.draw()
        return self._known[key]


_FIELD: Mapping[str, Callable[..., int]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "neg": lambda a: -a,
}


def _quotient(a: int, b: int) -> Residue:
    if b == 0 and a == 0:
        return NOT_A_NUMBER
    return a * inverse(b) % PRIME


def inverse(value: int) -> int:
    """Return the inverse. Raises `Unlucky` for zero."""
    if value % PRIME == 0:
        raise Unlucky
    return pow(value, -1, PRIME)


def residue(number: Fraction | int) -> int:
    """Return the residue of a rational number.

    >>> residue(Fraction(1, 3)) * 3 % PRIME
    1
    """
    exact = Fraction(number)
    return exact.numerator * inverse(exact.denominator) % PRIME


def rational(value: int) -> Fraction | None:
    """Return the rational number of at most 260 bits above and below that has this residue, or None.

    By the extended Euclidean algorithm (Wang, 1981).

    >>> rational(residue(Fraction(-22, 7)))
    Fraction(-22, 7)
    """
    bound = isqrt(PRIME // 2)
    r0, r1, s0, s1 = PRIME, value % PRIME, 0, 1
    while r1 > bound:
        quotient = r0 // r1
        r0, r1, s0, s1 = r1, r0 - quotient * r1, s1, s0 - quotient * s1
    return Fraction(r1, s1) if s1 and abs(s1) <= bound else None


def null_vector(rows: Sequence[Sequence[int]]) -> list[int] | None:
    """Return the vector that all rows annihilate, up to a factor; None unless it is just one."""
    matrix = [[v % PRIME for v in row] for row in rows]
    width = len(matrix[0])
    pivots: list[int] = []
    for column in range(width):
        top = len(pivots)
        found = next((k for k in range(top, len(matrix)) if matrix[k][column]), None)
        if found is None:
            continue
        matrix[top], matrix[found] = matrix[found], matrix[top]
        scale = inverse(matrix[top][column])
        matrix[top] = [v * scale % PRIME for v in matrix[top]]
        for k, row in enumerate(matrix):
            if k != top and row[column]:
                factor = row[column]
                matrix[k] = [
                    (v - factor * w) % PRIME for v, w in zip(row, matrix[top], strict=True)
                ]
        pivots.append(column)
    free = [c for c in range(width) if c not in pivots]
    if len(free) != 1:
        return None
    vector = [0] * width
    vector[free[0]] = 1
    for k, column in enumerate(pivots):
        vector[column] = -matrix[k][free[0]] % PRIME
    return vector
