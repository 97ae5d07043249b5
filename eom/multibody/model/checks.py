"""What names, inertias and axes of bodies and joints must be; every error names the part at fault."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from eom.errors import InputError
from eom.multibody.algebra.scalars import is_zero, mul, sub, total
from eom.multibody.algebra.spatial import Matrix, Vector, product, transposed
from eom.multibody.algebra.values import Value, is_number

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
SLACK = Fraction(1, 10**9)
"""Of rounded inertias, relative to their size."""


def name(given: Any, where: str) -> None:
    """Raise `InputError` unless a name can be part of a symbol's."""
    if not isinstance(given, str) or not _NAME.fullmatch(given):
        raise InputError(
            "not a name", where=where, got=given, expected="a letter, then letters, digits and _"
        )


def central(J: Matrix, C: Matrix, mass: Value, centre: Vector, point: Vector) -> Matrix:
    """Return J, given about ``point`` in axes by C, about the centre of mass in the body's axes."""
    turned = product(transposed(C), product(J, C))
    d = [sub(p, c) for p, c in zip(point, centre, strict=True)]
    square = total(mul(x, x) for x in d)

    def entry(i: int, j: int) -> Value:
        steiner = sub(square if i == j else 0, mul(d[i], d[j]))
        return sub(turned[i][j], mul(mass, steiner))

    return tuple(tuple(entry(min(i, j), max(i, j)) for j in range(3)) for i in range(3))


def body(mass: Value, J: Matrix, where: str) -> None:
    """Raise `InputError` for a negative mass, or an inertia (about the centre) that no body has."""
    if (is_number(mass) and mass < 0) or getattr(mass, "is_negative", None) is True:
        raise InputError("mass is negative", where=where, got=mass, expected="at least 0 (kg)")
    if not all(is_number(x) for row in J for x in row):
        return
    half = Fraction(J[0][0] + J[1][1] + J[2][2]) / 2
    S = [[(half if i == j else 0) - J[i][j] for j in range(3)] for i in range(3)]
    size = max(abs(x) for row in J for x in row)
    if any(minor < -SLACK * size**order for order, minor in _minors(S)):
        raise InputError(
            "no body has this inertia about its centre of mass",
            where=where,
            got=[[float(x) for x in row] for row in J],
            expected="no principal moment above the sum of the others (triangle inequality)",
            hint="J12 = -integral of r1 r2 dm; check the signs, and the point that it is about",
        )
    if is_number(mass) and mass == 0 and size > 0:
        raise InputError("a body without mass has no inertia", where=where, got=float(size))


def _minors(S: Sequence[Sequence[Any]]) -> Iterable[tuple[int, Any]]:
    """Yield the principal minors with their orders: none is negative for second moments of mass."""
    for i in range(3):
        yield 1, S[i][i]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        yield 2, S[i][i] * S[j][j] - S[i][j] * S[j][i]
    cofactors = (S[1][1] * S[2][2] - S[1][2] * S[2][1],
                 S[1][2] * S[2][0] - S[1][0] * S[2][2],
                 S[1][0] * S[2][1] - S[1][1] * S[2][0])  # fmt: skip
    yield 3, sum(a * b for a, b in zip(S[0], cofactors, strict=True))


def not_parallel(axis: Vector, other: Vector, where: str) -> None:
    """Raise `InputError` for two unit vectors along one line."""
    cosine = total(mul(a, b) for a, b in zip(axis, other, strict=True))
    if is_number(cosine) and abs(cosine) > 1 - SLACK:
        raise InputError("the two axes are parallel", where=where, got=float(cosine))


def joint(given: Any) -> None:
    """Raise `InputError` for springs where no coordinate is, and motion that does not fit."""
    where = f"joint {given.name!r}"
    paired = given.row.paired(given.attitude)
    for k, (stiffness, coordinate) in enumerate(zip(given.stiffness, paired, strict=True)):
        if coordinate is None and not is_zero(stiffness):
            raise InputError(
                "a spring needs a coordinate whose rate is the speed",
                where=f"{where}: speed {given.speeds[k].name}",
                hint="use a load or an applied force",
            )
    if given.row.axes == 2:
        not_parallel(given.axis, given.second_axis, where)
    if given.motion is not None:
        _motion(given, where, paired)


def _motion(given: Any, where: str, paired: Sequence[int | None]) -> None:
    counts = [len(m) for m in (given.motion.position, given.motion.rate, given.motion.acceleration)]
    if None in paired or any(n != len(paired) for n in counts):
        raise InputError(
            "prescribed motion needs one expression a coordinate, each the integral of a speed",
            where=where,
            got=f"{counts[0]} for {given.kind}",
            expected=len(paired) if None not in paired else "a joint of one or two coordinates",
        )
