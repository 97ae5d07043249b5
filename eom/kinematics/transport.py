"""The transport theorem: derivatives of a vector as seen from two frames, term by term.

For a vector v given by its components in B, and omega the angular velocity of B in A:
A-derivative of v = B-derivative of v + omega x v (Hughes, 1986, sect. 2.3; lectures: 000, 001,
002 eq. 3.17). Each term of the first and the second derivative is kept apart and named.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.expressions import as_expression
from eom.kinematics.frames import Vector

Expr = Any
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
