"""Principal axes of an inertia matrix, and which inertia matrices a body can have.

The rows of ``C`` are the unit vectors of the principal axes P, written in B, right-handed; it takes
components in B to components in P, and C J C^T = diag(moments) (lecture 002 eq. 3.28-3.35).
Moments in kg m^2. The mathematics is in `eom.mass.principal`.

Eigenvalues and axes of real symmetric 3 by 3 matrices: exact, to many digits, in closed form.

An axis is a unit row; the axes are the rows of a right-handed rotation C with C J C^T = diag of the
values, which rise. Values are the roots of the characteristic cubic, axes the cross products of
rows of J - value 1. The meaning for a body is in `eom.mass.principal`.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cmp_to_key
from typing import Any

import mpmath
import sympy as sp

from eom.errors import InputError
from eom.exact.identity import vanishes
from eom.exact.numbers import TOLERANCE, number, sign, tolerance
from eom.expressions import as_expression
from eom.mass.inertia import matrix_conditions
from eom.mass.properties import tidy

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

    Parameters
    ----------
    J : iterable of rows
        3 x 3 (kg m^2), off-diagonal entries minus the products of inertia.
    digits : int, default 30
        To how many digits roots are taken that are not exact, of a matrix without floats.

    Returns
    -------
    PrincipalAxes
        Principal moments by rising size, and C, 3 x 3, which takes components in the given axes B
        to components along the principal ones: C J C^T = diag(moments).

    Raises
    ------
    InputError
        For a matrix that is not 3 by 3, real, finite and symmetric, or that no body has; that of a
        thin rod or a point will do.

    Notes
    -----
    Signs: the largest component of axes 1 and 2 is positive (the first of equal ones); axis 3 makes
    them right-handed. The axes of equal moments are those nearest to b1, b2, b3.

    Floats: moments and axes are floats, to 1e-15 of the largest moment; moments are equal, and the
    matrix symmetric, within `eom.exact.numbers.TOLERANCE` of it. Integers, fractions, SymPy
    numbers: exact where an axis of B is principal or a moment rational; otherwise to ``digits``
    digits, and equal where 2 ``digits`` digits agree. Symbols: closed forms for generic values, by
    rising size, signs of the axes open; where b_k is principal, axis k stays b_k and the pair
    across it rises; two moments that are identically equal come first, unless they are known to be
    the greater.

    References
    ----------
    Lecture 002 eq. 3.28-3.35.

    Examples
    --------
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
    """Return whether an inertia matrix is positive definite, semi-definite, or that of no body.

    Parameters
    ----------
    J : iterable of rows
        As of `principal_axes`, of numbers only (kg m^2); tolerances are those, too.

    Returns
    -------
    Definiteness
        The kind, why, and the value and axis that show it. An impossible matrix is no error.

    Raises
    ------
    InputError
        As of `principal_axes`, for what is no real symmetric matrix of numbers.

    Examples
    --------
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


SAMPLE_DIGITS = 16


@dataclass(frozen=True)
class PrincipalAxes:
    """Principal ``moments`` (kg m^2) and the rotation ``C``, C_PB, from given axes to principal ones."""

    moments: tuple[Expr, Expr, Expr]
    C: Expr


def is_zero(value: Expr, slack: Expr = 0) -> bool:
    """Return whether ``value`` is zero: exactly for numbers, identically for symbols."""
    return vanishes(value) if value.free_symbols else sign(number(value), slack) == 0


# --- numbers ----------------------------------------------------------------------------------


def exact_axes(J: Expr) -> PrincipalAxes | None:
    """Return exact values and axes of a matrix of exact numbers, None where there is no root.

    There is one where an axis is given, or where a value is rational.
    """
    values = _closed_values(J)
    if values is None:
        return None
    low, mid, high = sorted(values, key=cmp_to_key(_order))
    equal = (sign(mid - low) == 0, sign(high - mid) == 0)
    return PrincipalAxes((low, mid, high), _axes(J, (low, mid, high), equal))


def _order(a: Expr, b: Expr) -> int:
    return sign(a - b)


def _closed_values(J: Expr) -> tuple[Expr, Expr, Expr] | None:
    """Values where a given axis is principal, or one of them rational; otherwise None."""
    k = _lone_axis(J)
    if k is not None:
        i, j = (n for n in range(3) if n != k)
        return J[k, k], *_pair(J[i, i] + J[j, j], J[i, i] * J[j, j] - J[i, j] ** 2)
    if not all(e.is_Rational for e in J):
        return None
    cubic = J.charpoly()
    rational = next(iter(cubic.as_expr().as_poly(cubic.gen).ground_roots()), None)
    if rational is None:
        return None
    _, trace, minors, _ = cubic.all_coeffs()
    rest = -trace - rational
    return rational, *_pair(rest, minors - rational * rest)


def _lone_axis(J: Expr) -> int | None:
    """Index of a given axis that is principal: the other entries of its row are zero."""
    return next((k for k in (2, 1, 0) if all(is_zero(J[k, n]) for n in range(3) if n != k)), None)


def _pair(total: Expr, product: Expr) -> tuple[Expr, Expr]:
    """The lesser and the greater of two numbers from their sum and product."""
    root = sp.sqrt(sp.expand(total**2 - 4 * product))
    return sp.expand((total - root) / 2), sp.expand((total + root) / 2)


def numeric_axes(J: Expr, digits: int, equal_below: Expr) -> PrincipalAxes:
    """Return values, by mpmath's symmetric QR, and axes of a matrix of numbers to ``digits`` digits.

    Values are equal where they differ by at most the part ``equal_below`` of the largest, which is
    not less than 10^(-2 digits); the working precision leaves enough digits past such a gap.
    """
    precision = 3 * digits + 30
    J = J.evalf(precision)
    with mpmath.workdps(precision):
        rows = [[mpmath.mpf(sp.Float(e, precision)) for e in row] for row in J.tolist()]
        values = sorted(mpmath.eigsy(mpmath.matrix(rows), eigvals_only=True))
        low, mid, high = (sp.Float(v, precision) for v in values)
    slack = equal_below * max(abs(low), abs(high))
    gaps = (mid - low, high - mid)
    first = gaps[0] <= gaps[1]
    closest = [high - low <= slack or nearer for nearer in (first, not first)]
    equal = [c and bool(gap <= slack) for c, gap in zip(closest, gaps, strict=True)]
    C = _axes(J, (low, mid, high), equal)
    noise = sp.Float(10) ** (-digits - 20)
    C = C.applyfunc(lambda e: sp.Float(e, digits) if abs(e) > noise else sp.Integer(0))
    a, b, c = (sp.Float(m, digits) for m in (low, mid, high))
    return PrincipalAxes((a, b, c), C)


def _axes(J: Expr, moments: Sequence[Expr], equal: Sequence[bool]) -> Expr:
    """Rows of C; ``equal``: whether moments 1 and 2, and 2 and 3, are."""
    if all(equal):
        return sp.ImmutableMatrix(sp.eye(3))
    if any(equal):
        across = _axis(J, moments[2 if equal[0] else 0])
        k = _leading(across)
        pair = (row.applyfunc(sp.radsimp) for row in _nearest_pair(across, k))
        rows = [*pair, across] if equal[0] else [across, *pair]
        return sp.ImmutableMatrix.vstack(*rows)
    first, second, third = (_axis(J, m) for m in moments)
    sense = sign(sp.sign(first.cross(second).dot(third).evalf(40)))
    return sp.ImmutableMatrix.vstack(first, second, sense * third)


def _axis(J: Expr, moment: Expr) -> Expr:
    """Unit row of the axis of a simple value, its largest component positive."""
    long = max(_normals(J - moment * sp.eye(3)), key=lambda v: v.dot(v).evalf(40))
    unit = long / sp.sqrt(sp.expand(long.dot(long)))
    return unit * sign(sp.sign(unit[_leading(unit)].evalf(40)))


def _normals(singular: Expr) -> list[Expr]:
    """Cross products of rows, all along the vector that ``singular`` takes to zero."""
    rows = [singular.row(k) for k in range(3)]
    return [rows[(k + 1) % 3].cross(rows[(k + 2) % 3]).applyfunc(sp.expand) for k in range(3)]


def _leading(row: Expr) -> int:
    """Index of the largest component, of the first among those that are equal."""
    sizes = [abs(e.evalf(40)) for e in row]
    return next(k for k, size in enumerate(sizes) if size >= max(sizes) * (1 - TOLERANCE))


def _nearest_pair(axis: Expr, k: int) -> tuple[Expr, Expr]:
    """Two unit rows across ``axis``: b_(k+1) and b_(k+2), tilted as b_k is to reach ``axis``."""
    b = [sp.eye(3).row(n) for n in range(3)]
    tilt = (b[k] + axis) / (1 + axis[k])
    i, j = (k + 1) % 3, (k + 2) % 3
    return b[i] - axis[i] * tilt, b[j] - axis[j] * tilt


# --- symbols ----------------------------------------------------------------------------------


def symbolic_axes(J: Expr) -> PrincipalAxes:
    """Return closed forms of values and axes for generic values of the symbols.

    By the trigonometric solution of the cubic (Smith, 1961, Comm. ACM 4, 168), its angle by atan2.
    """
    k = _lone_axis(J)
    if k is not None:
        return _plane(J, k)
    q = tidy(J.trace() / 3)
    B = J - q * sp.eye(3)
    squared, half = sp.Add(*(e**2 for e in B)) / 6, B.det(method="berkowitz") / 2
    if vanishes(squared**3 - half**2):
        return _symmetric(B, q)
    p = sp.sqrt(squared)
    angle = sp.atan2(sp.sqrt(squared**3 - half**2), half) / 3
    low, mid, high = (q + 2 * p * sp.cos(angle + k * 2 * sp.pi / 3) for k in (1, -1, 0))
    first, second = _generic_axes(J, (low, mid))
    C = sp.ImmutableMatrix.vstack(first, second, first.cross(second))
    return PrincipalAxes((low, mid, high), C)


def _plane(J: Expr, k: int) -> PrincipalAxes:
    """Values and axes where axis ``k`` is principal: the pair across it by a turn about it."""
    i, j = (n for n in range(3) if n != k)
    moments, C = [J[n, n] for n in range(3)], sp.eye(3)
    if not is_zero(J[i, j]):
        moments[i], moments[j] = _pair(J[i, i] + J[j, j], J[i, i] * J[j, j] - J[i, j] ** 2)
        turn = sp.atan2(-2 * J[i, j], J[j, j] - J[i, i]) / 2
        C[i, i] = C[j, j] = sp.cos(turn)
        C[i, j], C[j, i] = sp.sin(turn), -sp.sin(turn)
    a, b, c = moments
    return PrincipalAxes((a, b, c), sp.ImmutableMatrix(C))


def _symmetric(B: Expr, mean: Expr) -> PrincipalAxes:
    """Two values identically equal: B, whose trace is zero, has the roots 2 t, -t, -t."""
    t = tidy((B**3).trace() / (B**2).trace())
    projector = (B + t * sp.eye(3)).applyfunc(tidy) / (3 * t)
    k = next(n for n in range(3) if not vanishes(projector[n, n]))
    axis = projector.row(k) / sp.sqrt(projector[k, k])
    pair = _nearest_pair(axis, k)
    equal, single = tidy(mean - t), tidy(mean + 2 * t)
    if t.is_negative:
        return PrincipalAxes((single, equal, equal), sp.ImmutableMatrix.vstack(axis, *pair))
    return PrincipalAxes((equal, equal, single), sp.ImmutableMatrix.vstack(*pair, axis))


def _generic_axes(J: Expr, moments: Sequence[Expr]) -> list[Expr]:
    """Unit rows along that cross product of rows which is not zero at a sample point."""
    columns = _sample_columns(J)
    rows = []
    for moment, k in zip(moments, columns, strict=False):
        shifted = J - moment * sp.eye(3)
        v = shifted.row((k + 1) % 3).cross(shifted.row((k + 2) % 3))
        rows.append(v / sp.sqrt(v.dot(v)))
    return rows


def _sample_columns(J: Expr) -> list[int]:
    """For each moment the k whose components are farthest from zero, in all axes and in its own."""
    generator = random.Random(0)  # noqa: S311 - reproducible points, no secrets
    symbols = sorted(J.free_symbols, key=str)
    for _ in range(20):
        point = {s: sp.Rational(generator.randrange(10**5, 10**6), 10**6) for s in symbols}
        value = J.subs(point)
        if all(e.is_number and e.is_real for e in value):
            C = numeric_axes(value, SAMPLE_DIGITS, TOLERANCE).C.applyfunc(abs)
            return [max(range(3), key=lambda k: (min(C.col(k)), C[n, k])) for n in range(3)]
    return [2, 2, 2]
