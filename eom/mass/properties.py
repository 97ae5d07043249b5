"""Mass, centre of mass and inertia as one value: moved, turned, added, cut out.

Units: kg, kg m, kg m^2.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.expressions import as_expression
from eom.kinematics.frames import Rotation
from eom.mass.inertia import inertia_of_second_moments

Expr = Any


@dataclass(frozen=True)
class MassProperties:
    """Mass (kg), first and second moments of mass about a reference point O.

    Parameters
    ----------
    mass : expression
        In kg.
    first_moment : expression
        A column (3, 1), integral of r dm (kg m).
    second_moments : expression
        Symmetric, (3, 3), S_ij = integral of r_i r_j dm (kg m^2).

    Raises
    ------
    InputError
        For numbers that no body has.

    Notes
    -----
    r from O, components in the body's axes. Sums and differences are about the same point, in the
    same axes.

    References
    ----------
    Huygens and Steiner's theorem; lecture 002.

    Examples
    --------
    >>> near = MassProperties(1, (1, 0, 0), sp.diag(1, 0, 0))
    >>> two = near + MassProperties(1, (3, 0, 0), sp.diag(9, 0, 0))
    >>> two.centre.T, two.about_centre[2, 2]
    (Matrix([[2, 0, 0]]), 2)
    """

    mass: Expr
    first_moment: Expr
    second_moments: Expr

    def __post_init__(self) -> None:
        set_field = object.__setattr__
        set_field(self, "mass", as_expression(self.mass))
        set_field(self, "first_moment", sp.ImmutableMatrix(3, 1, list(self.first_moment)))
        set_field(self, "second_moments", sp.ImmutableMatrix(self.second_moments))
        _check_possible(self)

    @property
    def inertia(self) -> Expr:
        """The inertia matrix J (3 x 3, kg m^2) about the reference point; J12 = -integral of r1 r2 dm."""
        return _inertia(self.second_moments)

    @property
    def centre(self) -> Expr:
        """The position (3, 1) of the centre of mass (m), from the reference point."""
        return _tidied(self.first_moment / self.mass)

    @property
    def about_centre(self) -> Expr:
        """The inertia matrix I (3 x 3, kg m^2) about the centre of mass."""
        c = self.first_moment
        return _inertia(self.second_moments - c * c.T / self.mass)

    def shifted(self, r: Iterable[Expr]) -> MassProperties:
        """Return the same about another point.

        Parameters
        ----------
        r : iterable of expressions
            From the present point to that one (m); axes stay.

        Returns
        -------
        MassProperties
            About the point ``r``.

        Raises
        ------
        InputError
            For other than three components.

        References
        ----------
        Huygens and Steiner's theorem, in second moments: S' = S - c r^T - r c^T + m r r^T.
        """
        step, c, m = _column(r, "r"), self.first_moment, self.mass
        second = self.second_moments - c * step.T - step * c.T + m * step * step.T
        return MassProperties(m, _tidied(c - m * step), _tidied(second))

    def rotated(self, C_BA: Expr) -> MassProperties:
        """Return the moments in other axes.

        Parameters
        ----------
        C_BA : matrix or Rotation
            3 by 3; it takes components in A, the present axes, to components in B.

        Returns
        -------
        MassProperties
            In axes B, about the same point.

        Raises
        ------
        InputError
            For a matrix of numbers that is no rotation to within 1e-9; expressions are taken at
            their word.
        """
        C = sp.ImmutableMatrix(C_BA.matrix if isinstance(C_BA, Rotation) else C_BA)
        _check_rotation(C)
        second = C * self.second_moments * C.T
        return MassProperties(
            self.mass, (C * self.first_moment).applyfunc(sp.expand), second.applyfunc(sp.expand)
        )

    def of_mass(self, mass: Expr) -> MassProperties:
        """Return the same with the density scaled to a mass.

        Parameters
        ----------
        mass : expression
            In kg.

        Returns
        -------
        MassProperties
            With the same centre.

        Raises
        ------
        InputError
            For a mass that is not positive.
        """
        m = as_expression(mass)
        if m.is_positive is False:
            raise InputError("mass is not positive", got=m, expected="a positive number (kg)")
        factor = m / self.mass
        return MassProperties(
            m, _tidied(self.first_moment * factor), _tidied(self.second_moments * factor)
        )

    def __add__(self, other: MassProperties) -> MassProperties:
        """Join two bodies that do not overlap."""
        return self._combined(other, 1)

    def __sub__(self, other: MassProperties) -> MassProperties:
        """Cut ``other`` out. Raises `InputError` if numbers show that it is not inside."""
        return self._combined(other, -1)

    def _combined(self, other: MassProperties, sign: int) -> MassProperties:
        return MassProperties(
            self.mass + sign * other.mass,
            (self.first_moment + sign * other.first_moment).applyfunc(sp.expand),
            (self.second_moments + sign * other.second_moments).applyfunc(sp.expand),
        )


def tidy(value: Expr) -> Expr:
    """Cancel common factors of a quotient; floating-point numbers stay as they are."""
    if value.has(sp.Float):
        return sp.expand(value)
    return value if value.is_Rational else sp.cancel(value)


def _tidied(matrix: Expr) -> Expr:
    """Apply `tidy` to each entry, to equal ones once."""
    done = {entry: tidy(entry) for entry in dict.fromkeys(matrix)}
    return matrix.applyfunc(done.__getitem__)


@lru_cache
def _pattern() -> tuple[tuple[Expr, ...], Expr]:
    """Six symbols of second moments, and the inertia matrix over them."""
    S = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"S_{min(i, j)}{max(i, j)}"))
    return tuple(S), inertia_of_second_moments(S)


def _inertia(second_moments: Expr) -> Expr:
    symbols, J = _pattern()
    return _tidied(J.xreplace(dict(zip(symbols, second_moments, strict=True))))


def _column(r: Iterable[Expr], where: str) -> Expr:
    components = [as_expression(c) for c in r]
    if len(components) != 3:
        raise InputError("a position has three components", where=where, got=len(components))
    return sp.ImmutableMatrix(components)


def _check_possible(body: MassProperties) -> None:
    """Refuse numbers that no body has; symbols pass."""
    entries = (body.mass, *body.first_moment, *body.second_moments)
    if not all(e.is_number for e in entries):
        return
    if not all(e.is_finite and e.is_real for e in entries):
        raise InputError("moments of mass are not finite real numbers", got=list(entries))
    c, m = body.first_moment.evalf(30), body.mass.evalf(30)
    hint = "a part that is cut out must lie inside the body"
    if not m > 0:
        raise InputError("mass is not positive", got=f"{float(m):g} kg", hint=hint)
    central = (body.second_moments - c * c.T / m).evalf(30)
    scale = body.second_moments.evalf(30).trace()
    for rows in (r for size in (1, 2, 3) for r in combinations(range(3), size)):
        minor = central.extract(list(rows), list(rows)).det(method="berkowitz")
        if minor < -1e-9 * scale ** len(rows):
            raise InputError(
                "no body has these second moments of mass",
                got=[[float(e) for e in central.row(i)] for i in range(3)],
                expected="a positive semi-definite matrix about the centre of mass",
                hint=hint,
            )


def _check_rotation(C: Expr) -> None:
    if C.shape != (3, 3):
        raise InputError("a rotation is a 3 by 3 matrix", where="C_BA", got=C.shape)
    if all(e.is_number for e in C):
        error = max(abs(float(e)) for e in C * C.T - sp.eye(3))
        if error > 1e-9 or C.det(method="berkowitz") < 0:
            raise InputError(
                "matrix is no rotation",
                where="C_BA",
                got=f"C C^T differs from 1 by {error:g}" if error > 1e-9 else "determinant -1",
                expected="orthonormal rows, determinant 1",
            )
