"""Vectors and rotations that know their frames, so that frames cannot be mixed by mistake.

A vector is its three components in a named frame. A rotation ``C_BA`` takes components in A to
components in B: ``[v]_B = C_BA [v]_A``; its rows are the unit vectors of B, written in A.

The transport theorem: derivatives of a vector as seen from two frames, term by term.

For a vector v given by its components in B, and omega the angular velocity of B in A:
A-derivative of v = B-derivative of v + omega x v (Hughes, 1986, sect. 2.3; lectures: 000, 001,
002 eq. 3.17). Each term of the first and the second derivative is kept apart and named.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.expressions import as_expression

Expr = Any


@dataclass(frozen=True)
class Vector:
    """Components of a vector in a right-handed orthonormal frame.

    ``frame``: its name. ``components``: three expressions, along the frame's unit vectors 1, 2, 3, in any
    consistent units. Sums and products of vectors in different frames raise `InputError`.
    """

    frame: str
    components: tuple[Expr, Expr, Expr]

    def __add__(self, other: Vector) -> Vector:
        return self._combine(other, lambda a, b: a + b)

    def __sub__(self, other: Vector) -> Vector:
        return self._combine(other, lambda a, b: a - b)

    def _combine(self, other: Vector, rule: Callable[[Expr, Expr], Expr]) -> Vector:
        _same_frame(self, other)
        pairs = zip(self.components, other.components, strict=True)
        return vector(self.frame, (rule(a, b) for a, b in pairs))

    def scaled(self, factor: Expr) -> Vector:
        """Return a multiple of the vector.

        Parameters
        ----------
        factor : expression
            Of any unit.

        Returns
        -------
        Vector
            In the same frame.
        """
        return self.map(lambda c: factor * c)

    def map(self, rule: Callable[[Expr], Expr]) -> Vector:
        """Return the vector with each component changed.

        Parameters
        ----------
        rule : callable
            From an expression to an expression.

        Returns
        -------
        Vector
            In the same frame.
        """
        return vector(self.frame, (rule(c) for c in self.components))

    def dot(self, other: Vector) -> Expr:
        """Return the scalar product with another vector.

        Parameters
        ----------
        other : Vector
            In the same frame.

        Returns
        -------
        expression
            The sum of the products of components.

        Raises
        ------
        InputError
            Unless the frames are the same.
        """
        _same_frame(self, other)
        return sp.Add(*(a * b for a, b in zip(self.components, other.components, strict=True)))

    def cross(self, other: Vector) -> Vector:
        """Return the vector product, this times ``other``.

        Parameters
        ----------
        other : Vector
            In the same frame, which is right-handed.

        Returns
        -------
        Vector
            In that frame.

        Raises
        ------
        InputError
            Unless the frames are the same.

        Examples
        --------
        >>> x, y = vector("B", (1, 0, 0)), vector("B", (0, 1, 0))
        >>> x.cross(y).components
        (0, 0, 1)
        """
        _same_frame(self, other)
        return vector(self.frame, tilde(self.components) * other.column)

    @property
    def column(self) -> Expr:
        """The components as a SymPy column, 3 by 1."""
        return sp.Matrix(self.components)


@dataclass(frozen=True)
class Rotation:
    """A rotation ``matrix`` that takes components in ``from_frame`` to components in ``to_frame``.

    It is 3 x 3, and written C_BA for ``to_frame`` B and ``from_frame`` A: [v]_B = C_BA [v]_A; its rows are
    the unit vectors of B, written in A. Rotations chain by ``@``: C_CA = C_CB @ C_BA, and raise
    `InputError` where the inner frames differ.
    """

    to_frame: str
    from_frame: str
    matrix: Expr

    def __matmul__(self, other: Rotation) -> Rotation:
        """Return ``C_CA = C_CB @ C_BA``; the inner frames must agree."""
        if self.from_frame != other.to_frame:
            raise InputError(
                "rotations do not chain",
                got=f"C_{self.to_frame}{self.from_frame} @ C_{other.to_frame}{other.from_frame}",
                expected=f"a second rotation to frame {self.from_frame}",
            )
        return Rotation(
            self.to_frame, other.from_frame, sp.ImmutableMatrix(self.matrix * other.matrix)
        )

    @property
    def inverse(self) -> Rotation:
        """The rotation the other way: the transpose."""
        return Rotation(self.from_frame, self.to_frame, self.matrix.T)

    def apply(self, v: Vector) -> Vector:
        """Return a vector by its components in the other frame.

        Parameters
        ----------
        v : Vector
            Given in ``from_frame``.

        Returns
        -------
        Vector
            The same vector in ``to_frame``.

        Raises
        ------
        InputError
            For other frames.
        """
        if v.frame != self.from_frame:
            raise InputError(
                f"C_{self.to_frame}{self.from_frame} takes components in {self.from_frame}",
                got=f"components in {v.frame}",
            )
        return vector(self.to_frame, self.matrix * v.column)


def vector(frame: str, components: Iterable[Expr]) -> Vector:
    """Return a vector of three numbers or expressions, ``components`` in a ``frame`` by its name.

    Parameters
    ----------
    frame : str
        The name of the frame that components are in a base of.
    components : iterable of expressions
        Three numbers or expressions, along the first, second and third axis.

    Returns
    -------
    Vector
        In any consistent units. Vectors of different frames do not add up: a rotation has to bring
        them into one.

    Raises
    ------
    InputError
        For text in place of expressions.

    Notes
    -----
    Components are those in a ``frame``, whatever the vector is seen from.

    Examples
    --------
    >>> vector("B", (1, 0, 0)).cross(vector("B", (0, 1, 0)))
    Vector(frame='B', components=(0, 0, 1))
    """
    a, b, c = (as_expression(component) for component in components)
    return Vector(frame, (a, b, c))


def unit_vector(frame: str, axis: int) -> Vector:
    """Return the unit vector along ``axis`` (1, 2 or 3) of ``frame``."""
    return vector(frame, (int(k == axis) for k in (1, 2, 3)))


def tilde(components: Iterable[Expr]) -> Expr:
    """Return the skew matrix of a vector: ``tilde(a) b = a x b``."""
    a, b, c = components
    return sp.ImmutableMatrix([[0, -c, b], [c, 0, -a], [-b, a, 0]])


def _same_frame(a: Vector, b: Vector) -> None:
    if a.frame != b.frame:
        raise InputError(
            "vectors in different frames",
            got=f"components in {a.frame} and in {b.frame}",
            hint="express one in the other's frame by a Rotation first",
        )


Rates = Mapping[Any, Any]


@dataclass(frozen=True)
class FirstDerivative:
    """The two terms of the first derivative, as seen from A, of a vector v that is given in B.

    Source: the transport theorem, Hughes, Spacecraft Attitude Dynamics (1986), sect. 2.3.
    """

    local: Vector
    """B-derivative of v."""
    rotation: Vector
    """omega x v."""

    @property
    def total(self) -> Vector:
        """The A-derivative."""
        return self.local + self.rotation


@dataclass(frozen=True)
class SecondDerivative:
    """The terms of the second derivative; the Coriolis term collects two equal ones."""

    local: Vector
    """Second B-derivative of v."""
    coriolis: Vector
    """2 omega x (B-derivative of v)."""
    euler: Vector
    """(derivative of omega) x v."""
    centripetal: Vector
    """omega x (omega x v)."""

    @property
    def total(self) -> Vector:
        """The second A-derivative."""
        return self.local + self.coriolis + self.euler + self.centripetal


def time_derivative(expression: Expr, rates: Rates, time: Expr | None = None) -> Expr:
    """Return d(expression)/dt by the chain rule, with ``rates`` mapping symbols to their rates.

    Symbols without a rate are constant; ``time``, where given, has rate one.
    """
    terms = [as_expression(expression).diff(symbol) * rate for symbol, rate in rates.items()]
    if time is not None:
        terms.append(as_expression(expression).diff(time))
    return sp.Add(*terms)


def local_derivative(v: Vector, rates: Rates) -> Vector:
    """Return the derivative of ``v`` as seen from its own frame: that of its components."""
    return v.map(lambda component: time_derivative(component, rates))


def first_derivative(v: Vector, omega: Vector, rates: Rates) -> FirstDerivative:
    """Return the terms of the A-derivative of ``v``; ``omega`` of B in A, both given in B."""
    return FirstDerivative(local_derivative(v, rates), omega.cross(v))


def second_derivative(v: Vector, omega: Vector, rates: Rates) -> SecondDerivative:
    """Return the terms of the second A-derivative of ``v``; ``rates`` covers rates of rates too."""
    dv = local_derivative(v, rates)
    return SecondDerivative(
        local=local_derivative(dv, rates),
        coriolis=omega.cross(dv).scaled(2),
        euler=local_derivative(omega, rates).cross(v),
        centripetal=omega.cross(omega.cross(v)),
    )
