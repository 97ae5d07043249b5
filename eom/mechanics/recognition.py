"""What a given rotation matrix is: of which sequence by which angles, or of which quaternion.

A matrix is put to numbers; every sequence then has angles that give it. Where these are symbols of
the matrix, but for signs and right angles, the reading is proven exactly.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import permutations, product
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.identity import vanishes
from eom.kinematics.coordinates import SEQUENCES, UnitQuaternion, rotation_sequence
from eom.rotations import (
    ALMOST,
    Matrix,
    angles_of_matrix,
    determinant,
    matrix_of,
    quaternion_of_matrix,
    transpose,
    unit_quaternion,
)
from eom.rotations import product as matrix_product
from eom.system import as_expression

MOST_SYMBOLS = 4
SEED = 1
TRIALS = 3


@dataclass(frozen=True)
class Turns:
    """Turns one after the other about axes of the body, each by an angle; none is by zero.

    ``axes``: 1, 2 or 3 each; ``angles`` (rad): numbers or expressions. ``transposed``: whether the
    matrix is the transpose of that, from body to reference components.
    """

    axes: tuple[int, ...]
    angles: tuple[Any, ...]
    transposed: bool = False

    def __str__(self) -> str:
        """Return it in words."""
        if not self.axes:
            return "the unit matrix"
        name = "-".join(map(str, self.axes))
        shown = ", ".join(_shown(a) for a in self.angles)
        several = len(self.axes) > 1
        what = (
            f"a {name} sequence with angles {shown}"
            if several
            else f"a turn about axis {name} by {shown}"
        )
        return f"the transpose of {what}" if self.transposed else what

    @property
    def oddity(self) -> tuple[Any, ...]:
        """What readings are put in order by: those with few turns and signs, and as they stand, first.

        Raises `InputError` for angles that are text.
        """
        signs = sum(as_expression(a).could_extract_minus_sign() for a in self.angles)
        shifts = sum(as_expression(a).is_Add for a in self.angles)
        crooked = sum(not _is_round(a) for a in self.angles)
        return (crooked, len(self.axes), shifts, signs, self.transposed, self.axes)


@dataclass(frozen=True)
class Parameters:
    """The matrix of a unit quaternion, its ``components`` given scalar first."""

    components: tuple[Any, ...]

    def __str__(self) -> str:
        """Return it in words."""
        scalar, *vector = map(_shown, self.components)
        return f"the unit quaternion with scalar part {scalar}, vector part {', '.join(vector)}"

    @property
    def oddity(self) -> tuple[Any, ...]:
        """What readings are put in order by. Raises `InputError` for components that are text."""
        signs = sum(as_expression(c).could_extract_minus_sign() for c in self.components)
        return (0, 0, 0, signs, False, ())


Reading = Turns | Parameters


def recognise(rows: Sequence[Sequence[Any]]) -> tuple[Reading, ...]:
    """Return what a rotation matrix is, the plainest reading first.

    Parameters
    ----------
    rows : sequence of rows
        Three of three, numbers or expressions over at most four symbols, taken as the matrix from
        reference to body components.

    Returns
    -------
    tuple of Reading
        What the matrix is, the plainest reading first; angles in radians. Of numbers every sequence
        is a reading.

    Raises
    ------
    InputError
        For what is no rotation, with the entry whose sign is to blame where there is one.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), ch. 2.

    Examples
    --------
    >>> c, s = sp.cos(sp.Symbol("a")), sp.sin(sp.Symbol("a"))
    >>> print(recognise([[c, -s, 0], [s, c, 0], [0, 0, 1]])[0])
    the transpose of a turn about axis 3 by a
    """
    matrix = _checked(rows)
    symbols = sorted(matrix.free_symbols, key=str)
    if not symbols:
        found: Iterator[Reading] = _of_numbers(matrix)
    elif _is_rotation(matrix):
        found = _of_angles(matrix, symbols)
    else:
        found = _of_parameters(matrix, symbols)
    readings = sorted(set(found), key=lambda r: r.oddity)
    if not readings and not _is_rotation(matrix):
        raise _refusal(matrix)
    return tuple(readings)


def _checked(rows: Sequence[Sequence[Any]]) -> Any:
    if [len(row) for row in rows] != [3, 3, 3]:
        raise InputError(
            "a matrix has three rows of three",
            where="matrix",
            got=f"{[len(r) for r in rows]} entries",
        )
    matrix = sp.ImmutableMatrix([[as_expression(x) for x in row] for row in rows])
    if len(matrix.free_symbols) > MOST_SYMBOLS:
        raise InputError(
            "too many symbols for a rotation", where="matrix",
            got=", ".join(sorted(map(str, matrix.free_symbols))), expected=f"at most {MOST_SYMBOLS}",
        )  # fmt: skip
    return matrix


# -- numbers


def _of_numbers(matrix: Any) -> Iterator[Reading]:
    """Yield every sequence with its angles; right ones stand as such."""
    numbers = _floats(matrix, {})
    if not _orthonormal(numbers):
        raise _refusal(matrix)
    for transposed in (False, True):
        C = transpose(numbers) if transposed else numbers
        for name in SEQUENCES:
            yield _turns(name, [_rounded(a) for a in angles_of_matrix(C, name)], transposed)


def _rounded(angle: float) -> Any:
    """Return an angle, a whole number of degrees as that."""
    degrees = round(math.degrees(angle))
    near = math.radians(degrees)
    return sp.pi * degrees / 180 if abs(near - angle) < ALMOST else sp.Float(angle)


def _is_round(angle: Any) -> bool:
    return not as_expression(angle).has(sp.Float)


def _shown(angle: Any) -> str:
    value = as_expression(angle)
    if value.is_number and value:
        return f"{float(value * 180 / sp.pi):.10g} deg"
    return str(value)


# -- symbols


def _is_rotation(matrix: Any) -> bool:
    """Return whether the rows are orthonormal and right-handed for all values of the symbols."""
    gram = matrix * matrix.T - sp.eye(3)
    handed = matrix.row(0).cross(matrix.row(1)) - matrix.row(2)
    return all(vanishes(e) for e in (*gram, *handed))


def _of_angles(matrix: Any, symbols: Sequence[Any]) -> Iterator[Reading]:
    """Yield sequences whose angles, at numbers, are symbols; each proven for all their values."""
    draw = _draw()
    values = {s: draw.uniform(0.2, 1.2) for s in symbols}
    numbers = _floats(matrix, values)
    for transposed in (False, True):
        given = matrix.T if transposed else matrix
        C = transpose(numbers) if transposed else numbers
        for name in SEQUENCES:
            angles = [_symbolic(a, values) for a in angles_of_matrix(C, name)]
            if None not in angles and _same(rotation_sequence(name, angles).matrix, given):
                yield _turns(name, angles, transposed)


def _symbolic(angle: float, values: dict[Any, float]) -> Any:
    """Return a whole number of right angles, or with plus or minus a symbol, that has this value."""
    for symbol, value in (*((s, v) for s, v in values.items()), (sp.Integer(0), 0.0)):
        for sign in (1, -1):
            rights = (angle - sign * value) / (math.pi / 2)
            if abs(rights - round(rights)) < ALMOST:
                return sign * symbol + sp.pi / 2 * round(rights)
    return None


def _turns(name: str, angles: Sequence[Any], transposed: bool) -> Turns:
    """Leave out turns by zero; of one turn, and none, the sign says which is the transpose."""
    kept = [(int(n), a) for n, a in zip(name.split("-"), angles, strict=True) if a != 0]
    return Turns(tuple(n for n, _ in kept), tuple(a for _, a in kept), transposed and bool(kept))


def _same(one: Any, other: Any) -> bool:
    return all(vanishes(a - b) for a, b in zip(one, other, strict=True))


# -- quaternions


def _of_parameters(matrix: Any, symbols: Sequence[Any]) -> Iterator[Reading]:
    """Yield the order and signs of four symbols that make it the matrix of a unit quaternion."""
    if len(symbols) != 4 or not all(e.is_polynomial(*symbols) for e in matrix):
        return
    point = dict(zip(symbols, map(float, _unit_point(_draw())), strict=True))
    numbers = _floats(matrix, point)
    if not _orthonormal(numbers):
        return
    found = quaternion_of_matrix(numbers)
    for order, signs in product(permutations(symbols), ((1, 1), (1, -1))):
        scalar, vector = signs
        tried = (scalar * order[0], *(vector * s for s in order[1:]))
        near = [float(t.xreplace(point)) for t in tried]
        equal = all(abs(a - b) < ALMOST for a, b in zip(near, found, strict=True))
        opposite = all(abs(a + b) < ALMOST for a, b in zip(near, found, strict=True))
        if (equal or opposite) and _same_on_sphere(matrix, tried, symbols):
            yield Parameters(tried)


def _same_on_sphere(matrix: Any, components: Sequence[Any], symbols: Sequence[Any]) -> bool:
    """Return whether two matrices of polynomials agree at random rational points of the unit sphere."""
    a, b, c, d = components
    difference = matrix - UnitQuaternion((a, b, c, d)).matrix
    draw = _draw()
    for _ in range(TRIALS):
        values = (sp.Rational(x.numerator, x.denominator) for x in _unit_point(draw))
        point = dict(zip(symbols, values, strict=True))
        if any(e.xreplace(point) != 0 for e in difference):
            return False
    return True


def _draw() -> random.Random:
    return random.Random(SEED)  # noqa: S311 - reproducible points, no secrets


def _unit_point(draw: random.Random) -> tuple[Fraction, ...]:
    """Return a rational point of the unit sphere in four dimensions, by stereographic projection."""
    return unit_quaternion([Fraction(draw.randint(1, 97), draw.randint(1, 97)) for _ in range(3)])


# -- refusals


def _floats(matrix: Any, values: dict[Any, float]) -> Matrix:
    at = {s: sp.Float(v) for s, v in values.items()}
    numbers = [complex(e.xreplace(at)) for e in matrix]
    if not all(abs(z.imag) < ALMOST and math.isfinite(z.real) for z in numbers):
        raise InputError(
            "the matrix is no rotation", where="matrix", got="an entry that is no real number"
        )
    return matrix_of([[z.real for z in numbers[3 * i : 3 * i + 3]] for i in range(3)])


def _orthonormal(numbers: Matrix) -> bool:
    gram = matrix_product(numbers, transpose(numbers))
    off = max(abs(gram[i][k] - (i == k)) for i in range(3) for k in range(3))
    return off < ALMOST and determinant(numbers) > 0


def _refusal(matrix: Any) -> InputError:
    """Return what is said of a matrix that is no rotation."""
    values = {s: 0.3 + 0.2 * n for n, s in enumerate(sorted(matrix.free_symbols, key=str))}
    numbers = _floats(matrix, values)
    blamed = [
        f"row {i + 1}, column {k + 1}"
        for i, k in product(range(3), repeat=2)
        if _orthonormal(_with_sign(numbers, i, k))
    ]
    gram = matrix_product(numbers, transpose(numbers))
    off = max(abs(gram[i][k] - (i == k)) for i in range(3) for k in range(3))
    got = "a reflection, determinant -1" if off < ALMOST else "rows that are not orthonormal"
    hint = f"with the opposite sign of {' or '.join(blamed)} it is one" if blamed else ""
    return InputError(
        "the matrix is no rotation", where="matrix", got=got,
        expected="orthonormal rows, determinant 1", hint=hint,
    )  # fmt: skip


def _with_sign(numbers: Matrix, row: int, column: int) -> Matrix:
    rows = [list(r) for r in numbers]
    rows[row][column] *= -1
    return matrix_of(rows)
