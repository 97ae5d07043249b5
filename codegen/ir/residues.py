"""Values of programs modulo a large prime, at random points: exact randomised tests of what a program is.

Sums, products and quotients are exact in the field. Sine and cosine of one argument are a point of the
circle, (1 - u^2, 2 u)/(1 + u^2), u a random number for each argument; those of sums and doubles are so by
the theorems of addition. Every other operation is an unknown function, one random number for each list of
arguments that it meets: what holds of it holds whatever its values are.

Two rational functions of degree d that differ agree at a random point with a chance of at most d / p
(Schwartz and Zippel); `degree` bounds d for a program, arguments of unknown functions that meet by chance
included. The prime p is above 2**529, so that a program of degree 2**200 differs from another but for one
point in 2**329. It is the first after the digits of pi, so that no number that people write, as powers of
two or ten or one less than such, is zero or small in the field by its form.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

from codegen.ir.ops import OPS, Instruction
from codegen.ir.passes import Slot
from codegen.ir.program import Program
from eom.fields import ARITHMETIC, LARGE_RESIDUES, Singular, sum_of_angles

FIELD = LARGE_RESIDUES
PRIME = FIELD.prime
NOT_A_NUMBER = None
Residue = int | None
"""None for 0/0, which stands for NaN in programs."""
DOUBLINGS = 3
"""An argument is this many halves above that of which the point of the circle is drawn."""
LARGEST = 2**200
"""Of degrees that are distinguished."""


class RandomPoint:
    """Residues of leaves and of unknown functions, drawn at first use; the same seed gives the same."""

    def __init__(self, seed: int) -> None:
        self._draw = random.Random(seed)  # noqa: S311 - reproducible points, no secrets
        self._known: dict[object, int] = {}
        self._circle: dict[int, tuple[int, int]] = {0: (1, 0)}

    def draw(self) -> int:
        """Return a residue that is not zero."""
        return self._draw.randrange(1, PRIME)

    def circle(self, angle: int) -> tuple[int, int]:
        """Return (cosine, sine) of an angle."""
        angle %= PRIME
        lower = angle
        for _ in range(2 * DOUBLINGS):
            if lower in self._circle:
                break
            if PRIME - lower in self._circle:
                c, s = self._circle[PRIME - lower]
                self._circle[lower] = c, PRIME - s
                break
            lower = lower * HALF % PRIME
        else:
            lower = angle * HALF**DOUBLINGS % PRIME
            u = self.draw()
            self._circle[lower] = FIELD.circle(u)
        while lower != angle:
            c, s = self._circle[lower]
            lower = 2 * lower % PRIME
            self._circle[lower] = (c * c - s * s) % PRIME, 2 * c * s % PRIME
        return self._circle[angle]

    def leaf(self, op: str, slot: object) -> int:
        """Return the residue of a leaf of a program."""
        return self._unknown((op, slot))

    def values(self, program: Program, given: Mapping[Slot, int]) -> list[Residue]:
        """Return the residue of each instruction; ``given`` overrides leaves that are read by slot.

        Raises `Singular` where a divisor vanishes.
        """
        values: list[Residue] = []
        turns: dict[int, tuple[int, int]] = {}
        for instruction in program.instructions:
            op, args, _ = instruction
            operands = [values[a] for a in args]
            if op not in OPS:
                values.append(self._leaf(instruction, given))
            elif op == "select":
                values.append(self._chosen(*operands))
            elif None in operands:
                values.append(NOT_A_NUMBER)
            elif op in _CIRCLE:
                values.append(_CIRCLE[op](*self._turn(program, args[0], values, turns)) % PRIME)
            else:
                values.append(self._value(instruction, [v for v in operands if v is not None]))
        return values

    def _leaf(self, instruction: Instruction, given: Mapping[Slot, int]) -> int:
        if instruction.op == "const":
            assert isinstance(instruction.value, Fraction)
            return int(FIELD.of(instruction.value))
        known = given.get((instruction.op, instruction.slot))
        return self.leaf(instruction.op, instruction.slot) if known is None else known

    def _chosen(self, condition: Residue, one: Residue, other: Residue) -> Residue:
        """Return either of two that are equal, the one that is a number, or an unknown function."""
        if one == other or None in (one, other):
            return other if one is None else one
        return None if condition is None else self._unknown(("select", condition, one, other))

    def _turn(
        self,
        program: Program,
        angle: int,
        values: Sequence[Residue],
        known: dict[int, tuple[int, int]],
    ) -> tuple[int, int]:
        """Return (cosine, sine) of an instruction's value: of sums by the theorems of addition."""
        stack = [angle]
        while stack:
            k = stack[-1]
            op, args, _ = program.instructions[k]
            summands = args if op in _SENSES else ()
            missing = [a for a in summands if a not in known]
            if missing and k not in known:
                stack += missing
                continue
            stack.pop()
            if summands:
                signed = zip((known[a] for a in summands), _SENSES[op], strict=True)
                known[k] = sum_of_angles(((*turn, sense) for turn, sense in signed), FIELD.reduce)
            elif k not in known:
                known[k] = self.circle(values[k] or 0)
        return known[angle]

    def _value(self, instruction: Instruction, operands: Sequence[int]) -> Residue:
        op, _, data = instruction
        if op == "div" and not any(operands):
            return NOT_A_NUMBER
        if op in {"div", *ARITHMETIC}:
            return int(FIELD.operated(op, *operands))
        key = sorted(operands) if OPS[op].commutative else operands
        return self._unknown((op, data, *key))

    def _unknown(self, key: object) -> int:
        if key not in self._known:
            self._known[key] = self.draw()
        return self._known[key]


_SENSES: Mapping[str, tuple[int, ...]] = {"add": (1, 1), "sub": (1, -1), "neg": (-1,)}


def vanishing(program: Program, group: str, other: str = "") -> list[bool]:
    """Return of each result of a group whether it is zero or the result of the ``other`` group, everywhere.

    True is proved, but for the chance that the module states; what is zero by laws of functions that the
    field does not know counts as not. So does what has no value at all.
    """
    found: list[bool] = [True] * len(program.results[group])
    if degree(program) > LARGEST:
        return [False] * len(found)
    for seed in range(POINTS):
        values = _somewhere(program, seed)
        left = [values[k] for k in program.results[group]]
        right = [values[k] for k in program.results[other]] if other else [0] * len(left)
        pairs = zip(found, left, right, strict=True)
        found = [so_far and a is not None and a == b for so_far, a, b in pairs]
    return found


POINTS, TRIES = 3, 20
"""Random points of a proof, and how many are tried where a divisor vanishes by chance."""


def _somewhere(program: Program, seed: int) -> list[Residue]:
    for k in range(TRIES):
        try:
            return RandomPoint(seed * TRIES + k).values(program, {})
        except Singular:
            continue
    return [NOT_A_NUMBER] * len(program.instructions)


_CIRCLE: Mapping[str, Callable[[int, int], int]] = {
    "cos": lambda c, s: c,
    "sin": lambda c, s: s,
    "tan": lambda c, s: s * FIELD.inverse(c),
}
HALF = FIELD.inverse(2)


def degree(program: Program) -> int:
    """Return a bound of the degree of what is tested where results are compared: see the module.

    Of numerator and denominator of any value in states, time and unknown functions, times twice the
    square of the number of values, for pairs of arguments that meet.
    """
    bounds: list[tuple[int, int]] = []
    summands: list[int] = []
    for op, args, _ in program.instructions:
        summands.append(sum(summands[a] for a in args) if op in _SENSES else 1)
        angles = summands[args[0]] if op in _CIRCLE else 0
        bounds.append(_degree(op, [bounds[a] for a in args], angles))
    largest = max((n + d for n, d in bounds), default=0)
    return 2 * largest * (len(bounds) + 1) ** 2


def _degree(op: str, operands: Sequence[tuple[int, int]], angles: int) -> tuple[int, int]:
    """Return bounds of the degrees of numerator and denominator; ``angles``: summands of an argument."""
    if op in {"const", "pi", "parameter", "input"}:
        return 0, 0
    if op in {"add", "sub"}:
        (a, b), (c, d) = operands
        return max(a + d, c + b), b + d
    if op in {"mul", "div"}:
        (a, b), (c, d) = operands
        return (a + c, b + d) if op == "mul" else (a + d, b + c)
    if op in {"neg", "select"}:
        return max((n, max(d for _, d in operands)) for n, _ in [*operands, (1, 0)])
    circle = angles * 2 ** (2 * DOUBLINGS + 1)
    return (circle, circle) if angles else (1, 0)
