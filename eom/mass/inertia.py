"""The second moment of mass: from momentum to the inertia matrix, and which ones a body can have.

Signs: the off-diagonal entries of an inertia matrix are minus the products of inertia,
J12 = -integral of r1 r2 dm (lecture 000, [I_C]; lecture 002 eq. 3.24).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.kinematics.frames import vector
from eom.quantities import Assumption

Expr = Any

_R = tuple(sp.Symbol(f"r_{k}", real=True) for k in (1, 2, 3))
_OMEGA = tuple(sp.Symbol(f"w_{k}", real=True) for k in (1, 2, 3))


def integrate_over_mass(polynomial: Expr, second_moments: Expr) -> Expr:
    """Replace each product r_i r_j of ``polynomial`` by its integral over the mass.

    ``second_moments``: symmetric matrix S with S_ij = integral of r_i r_j dm. The polynomial must
    be homogeneous of degree two in the position symbols.
    """
    terms = sp.Poly(polynomial, *_R).terms()
    total = sp.Integer(0)
    for powers, coefficient in terms:
        i, j = (k for k, power in enumerate(powers) for _ in range(power))
        total += coefficient * second_moments[i, j]
    return total


def inertia_of_second_moments(second_moments: Expr) -> Expr:
    """Return J of h = integral of r x (omega x r) dm = J omega (lecture 002 eq. 3.22-3.24).

    >>> inertia_of_second_moments(sp.diag(*sp.symbols("a b c")))[0, 0]
    b + c
    """
    r, omega = vector("B", _R), vector("B", _OMEGA)
    momentum = r.cross(omega.cross(r))
    h = sp.Matrix([integrate_over_mass(sp.expand(c), second_moments) for c in momentum.components])
    return sp.ImmutableMatrix(h.jacobian(_OMEGA).applyfunc(sp.expand))


def second_moments_of_inertia(J: Expr) -> Expr:
    """Return S with S_ij = integral of r_i r_j dm, the inverse of `inertia_of_second_moments`."""
    symbols = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"S_{min(i, j)}{max(i, j)}"))
    unknowns = sorted(symbols.free_symbols, key=str)
    equations = list(inertia_of_second_moments(symbols) - J)
    (solution,) = sp.linsolve(equations, unknowns)
    return sp.ImmutableMatrix(symbols.xreplace(dict(zip(unknowns, solution, strict=True))))


def principal_conditions(moments: Sequence[Expr]) -> tuple[Expr, ...]:
    """Return what is not negative for principal moments: the sum of two less the third.

    These are the second moments of mass themselves, times two.
    """
    S = second_moments_of_inertia(sp.diag(*moments))
    return tuple(sp.expand(2 * S[k, k]) for k in range(3))


def matrix_conditions(J: Expr) -> tuple[Expr, ...]:
    """Return the principal minors of the second moments of mass; none of them is negative."""
    S = second_moments_of_inertia(J)
    rows = [c for size in (1, 2, 3) for c in combinations(range(3), size)]
    return tuple(S.extract(list(r), list(r)).det(method="berkowitz") for r in rows)


def physical(J: Expr) -> Assumption:
    """Return the assumption that a body with the inertia matrix ``J`` can exist."""
    if sp.Matrix(J).is_diagonal():
        conditions = principal_conditions([J[k, k] for k in range(3)])
    else:
        conditions = matrix_conditions(J)
    return Assumption(
        "physical_inertia",
        "no moment of inertia exceeds the sum of the other two (triangle inequality)",
        nonnegative=conditions,
    )


def check_principal_moments(moments: Sequence[float], where: str) -> None:
    """Raise `InputError` unless a body can have these principal moments of inertia (kg m^2)."""
    given = ", ".join(f"I{k} = {m:g}" for k, m in enumerate(moments, 1))
    for k, moment in enumerate(moments):
        if not moment > 0:
            raise InputError(
                f"moment of inertia I{k + 1} is not positive",
                where=where,
                got=given,
                expected="three positive numbers",
            )
    for k, moment in enumerate(moments):
        rest = sum(moments) - moment
        if moment > rest * (1 + 1e-12):
            raise InputError(
                f"no body has these moments of inertia: I{k + 1} exceeds the sum of the other two",
                where=where,
                got=given,
                expected=f"I{k + 1} <= {rest:g} (triangle inequality)",
            )


def check_matrix(J: Sequence[Sequence[float]], where: str) -> None:
    """Raise `InputError` unless ``J`` is symmetric, positive definite and the inertia of a body."""
    exact = sp.Matrix([[sp.Rational(str(e)) for e in row] for row in J])
    if exact != exact.T:
        raise InputError(
            "inertia matrix is not symmetric",
            where=where,
            got=[list(r) for r in J],
            expected="J12 = J21, J13 = J31, J23 = J32",
        )
    if not exact.is_positive_definite:
        raise InputError(
            "inertia matrix is not positive definite", where=where, got=[list(r) for r in J]
        )
    slack = -sp.Rational(1, 10**12) * exact.trace()
    for size, condition in zip((1, 1, 1, 2, 2, 2, 3), matrix_conditions(exact), strict=True):
        if condition < slack * exact.trace() ** (size - 1):
            raise InputError(
                "no body has this inertia matrix: its principal moments violate the triangle inequality",
                where=where,
                got=[list(r) for r in J],
                expected="trace(J)/2 * 1 - J positive semi-definite",
                hint="check the signs of the off-diagonal entries: J12 = -integral of r1 r2 dm",
            )
