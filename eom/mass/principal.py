"""Principal axes of an inertia matrix, and which inertia matrices a body can have.

The rows of ``C`` are the unit vectors of the principal axes P, written in B, right-handed; it takes
components in B to components in P, and C J C^T = diag(moments) (lecture 002 eq. 3.28-3.35).
Moments in kg m^2. The mathematics is in `eom.mass.symmetric`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.numbers import TOLERANCE, number, sign, tolerance
from eom.mass.inertia import matrix_conditions
from eom.mass.symmetric import PrincipalAxes, exact_axes, is_zero, numeric_axes, symbolic_axes
from eom.system import as_expression

__all__ = ["KINDS", "Definiteness", "PrincipalAxes", "definiteness", "principal_axes"]

Expr = Any

WHERE = "inertia matrix"
DIGITS, FLOAT_DIGITS = 30, 20


@dataclass(frozen=True)
class Definiteness:
    """What an inertia matrix is, and the principal axis that shows it.

    ``kind``: positive definite, positive semi-definite or impossible. ``reason``: the condition
    that is violated or only just met; empty if positive definite. ``value``: what decides by its
    sign (kg m^2), the least moment, or the sum of two less the third. ``axis``: unit vector in B,
    about which the moment is least or, where the triangle inequality fails, greatest.
    """

    kind: str
    reason: str
    value: Expr
    axis: tuple[Expr, Expr, Expr]


@dataclass(frozen=True)
class Kind:
    """A kind of matrix: ``value`` of the rising moments has ``sign``; ``witness`` is an index."""

    kind: str
    reason: str
    value: Callable[[Sequence[Expr]], Expr]
    sign: int
    witness: int


def _least(moments: Sequence[Expr]) -> Expr:
    return moments[0]


def _slack(moments: Sequence[Expr]) -> Expr:
    return moments[0] + moments[1] - moments[2]


TRIANGLE = "a moment exceeds the sum of the other two (triangle inequality)"
KINDS = (
    Kind("impossible", "a moment of inertia is negative", _least, -1, 0),
    Kind("impossible", TRIANGLE, _slack, -1, 2),
    Kind("positive semi-definite", "no mass off an axis: a thin rod or a point", _least, 0, 0),
    Kind("positive definite", "", _least, 1, 0),
)
"""Kinds of matrix; the first whose sign is found is the one."""


def principal_axes(J: Iterable[Iterable[Expr]], digits: int = DIGITS) -> PrincipalAxes:
    """Return principal moments by rising size, and the rotation to their axes.

    ``J``: 3 x 3 (kg m^2), off-diagonal entries minus the products of inertia. C, 3 x 3, takes components in
    the given axes B to components along the principal ones, and C J C^T = diag(moments).

    Signs: the largest component of axes 1 and 2 is positive (the first of equal ones); axis 3 makes
    them right-handed. The axes of equal moments are those nearest to b1, b2, b3.

    Floats: moments and axes are floats, to 1e-15 of the largest moment; moments are equal, and the
    matrix symmetric, within `eom.exact.numbers.TOLERANCE` of it. Integers, fractions, SymPy numbers: exact
    where an axis of B is principal or a moment rational; otherwise to ``digits`` digits, and equal
    where 2 ``digits`` digits agree. Symbols: closed forms for generic values, by rising size, signs
    of the axes open; where b_k is principal, axis k stays b_k and the pair across it rises; two
    moments that are identically equal come first, unless they are known to be the greater. Raises
    `InputError` for a matrix that is not 3 by 3, real, finite and symmetric, or that no body has;
    that of a thin rod or a point will do. Source: lecture 002 eq. 3.28-3.35.

    >>> principal_axes([[3, 1, 0], [1, 3, 0], [0, 0, 3]]).moments
    (2, 3, 4)
    """
    matrix = _matrix(J)
    if matrix.free_symbols:
        _refuse_known_signs(matrix)
        return symbolic_axes(matrix)
    found, slack = _decomposed(matrix, _checked_digits(digits))
    verdict = _verdict(found, slack)
    if verdict.kind == "impossible":
        quantity = "sum of two less the third" if verdict.reason == TRIANGLE else "least moment"
        raise InputError(
            f"no body has this inertia matrix: {verdict.reason}",
            where=WHERE,
            got=f"{quantity} {float(verdict.value):g}, seen about the axis {_shown(verdict.axis)}",
            expected="no negative moment, none greater than the sum of the other two",
            hint="check the signs of the off-diagonal entries: J12 = -integral of r1 r2 dm",
        )
    return _as_floats(found) if tolerance(matrix) else found


def definiteness(J: Iterable[Iterable[Expr]]) -> Definiteness:
    """Tell whether an inertia matrix is positive definite, semi-definite, or that of no body.

    Returns also why, and the axis that shows it. ``J``: as of `principal_axes`, of numbers only (kg
    m^2), as are tolerances, errors (`InputError`) and source; an impossible matrix is no error.

    >>> definiteness([[0, 0, 0], [0, 2, 0], [0, 0, 2]]).kind
    'positive semi-definite'
    """
    matrix = _matrix(J)
    if matrix.free_symbols:
        raise InputError("definiteness needs numbers", where=WHERE, got=matrix.tolist())
    found = _verdict(*_decomposed(matrix, DIGITS))
    if not tolerance(matrix):
        return found
    a, b, c = map(float, found.axis)
    return Definiteness(found.kind, found.reason, float(found.value), (a, b, c))


def _verdict(found: PrincipalAxes, slack: Expr) -> Definiteness:
    exact = [sp.Rational(m) if m.is_Float else m for m in found.moments]
    scale = slack * max(abs(m.evalf(20)) for m in exact)
    values = [kind.value(exact) for kind in KINDS]
    signs = zip(KINDS, values, strict=True)
    found_kind, value = next((k, v) for k, v in signs if sign(v, scale) == k.sign)
    a, b, c = found.C.row(found_kind.witness)
    return Definiteness(found_kind.kind, found_kind.reason, value, (a, b, c))


def _decomposed(matrix: Expr, digits: int) -> tuple[PrincipalAxes, Expr]:
    """Moments and axes, and the part of the largest moment below which a number is zero."""
    J = matrix.applyfunc(lambda e: number(e, WHERE))
    J = sp.ImmutableMatrix((J + J.T) / 2)
    if tolerance(matrix):
        return numeric_axes(J, FLOAT_DIGITS, TOLERANCE), TOLERANCE
    exact = exact_axes(J)
    if exact is not None:
        return exact, sp.Integer(0)
    found = numeric_axes(J, digits, sp.Rational(1, 10 ** (2 * digits)))
    return found, sp.Rational(1, 10**digits)


def _as_floats(found: PrincipalAxes) -> PrincipalAxes:
    """Python floats for moments, rounding below zero left out; 53 bits for the rotation."""
    low, mid, high = (max(float(m), 0.0) for m in found.moments)
    return PrincipalAxes((low, mid, high), found.C.applyfunc(lambda e: sp.Float(float(e))))


def _shown(axis: Sequence[Expr]) -> str:
    return f"({', '.join(f'{float(c):.3g}' for c in axis)})"


def _matrix(J: Any) -> Expr:
    """The matrix as given, checked but for what depends on its moments."""
    try:
        rows = J.tolist() if isinstance(J, sp.MatrixBase) else [list(row) for row in J]
    except TypeError:
        raise InputError("not a matrix", where=WHERE, got=J, expected="three rows") from None
    if [len(row) for row in rows] != [3, 3, 3]:
        got = f"rows of {[len(row) for row in rows]} entries"
        raise InputError("an inertia matrix is 3 by 3", where=WHERE, got=got)
    matrix = sp.ImmutableMatrix(3, 3, [_entry(e) for row in rows for e in row])
    scale = tolerance(matrix) * max((abs(e) for e in matrix if e.is_number), default=0)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if not is_zero(matrix[i, j] - matrix[j, i], scale):
            raise InputError(
                "inertia matrix is not symmetric",
                where=WHERE,
                got=f"J{i + 1}{j + 1} = {matrix[i, j]}, J{j + 1}{i + 1} = {matrix[j, i]}",
                expected="J12 = J21, J13 = J31, J23 = J32",
            )
    return matrix


def _entry(value: Any) -> Expr:
    """A real entry as it is; numbers are checked by `eom.exact.numbers.number`."""
    entry = as_expression(value)
    if not (isinstance(entry, sp.Expr) and entry.free_symbols):
        number(entry, WHERE)
    elif entry.is_real is False or entry.is_finite is False:
        raise InputError("not a finite real number", where=WHERE, got=value)
    return entry


def _checked_digits(digits: int) -> int:
    if isinstance(digits, bool) or not isinstance(digits, int) or not 15 <= digits <= 1000:
        raise InputError("wrong number of digits", where=WHERE, got=digits, expected="15 to 1000")
    return digits


def _refuse_known_signs(J: Expr) -> None:
    if any(c.is_negative for c in (*J.diagonal(), *matrix_conditions(J))):
        raise InputError(
            "no body has this inertia matrix, whatever its symbols are",
            where=WHERE,
            got=J.tolist(),
            expected="trace(J)/2 * 1 - J positive semi-definite",
        )
