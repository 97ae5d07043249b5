"""Named uniform solids and their principal moments of inertia, by integration over the solid.

Every solid is centred at its centre of mass, with principal axes along b1, b2, b3 and any axis of
symmetry along b3.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from eom.errors import unknown_name
from eom.inertia import inertia_of_second_moments

Expr = Any

_A, _S, _W = (sp.Symbol(n, positive=True) for n in ("angle", "s", "w"))


def _size(name: str) -> Expr:
    return sp.Symbol(name, positive=True)


@dataclass(frozen=True)
class Solid:
    """A map from parameters to positions that covers the solid once.

    ``position``: components over the parameters and sizes; ``bounds``: (parameter, from, to), the
    innermost integral first; ``axes``: which coordinates the solid extends in (a rod: one).
    """

    sizes: tuple[str, ...]
    position: tuple[Expr, Expr, Expr]
    bounds: tuple[tuple[Expr, Expr, Expr], ...]
    axes: tuple[int, ...] = (1, 2, 3)

    def integral(self, density: Expr) -> Expr:
        """Integrate ``density`` (over position) by the change of variables, one at a time."""
        extent = sp.Matrix([self.position[k - 1] for k in self.axes])
        element = extent.jacobian([b[0] for b in self.bounds]).det(method="berkowitz")
        value = sp.expand(density * element)
        for bound in self.bounds:
            value = sp.expand(sp.integrate(value, bound))
        return value


def _ring(radius: Expr) -> tuple[Expr, Expr]:
    return radius * sp.cos(_A), radius * sp.sin(_A)


_TURN = (_A, sp.Integer(0), 2 * sp.pi)
_ACROSS = (_W, sp.Rational(-1, 2), sp.Rational(1, 2))
_OUT = (_S, sp.Integer(0), sp.Integer(1))
_LENGTH, _RADIUS, _INNER, _OUTER = (
    _size(n) for n in ("length", "radius", "inner_radius", "outer_radius")
)
_U, _V = (sp.Symbol(n, positive=True) for n in ("u", "v"))
_ZENITH = (_V, sp.Integer(0), sp.pi)
_BALL = (_S * sp.sin(_V) * sp.cos(_A), _S * sp.sin(_V) * sp.sin(_A), _S * sp.cos(_V))

SOLIDS: dict[str, Solid] = {
    "box": Solid(
        ("a", "b", "c"),
        (_size("a") * _U, _size("b") * _V, _size("c") * _W),
        tuple((p, sp.Rational(-1, 2), sp.Rational(1, 2)) for p in (_U, _V, _W)),
    ),
    "cylinder": Solid(
        ("radius", "length"), (*_ring(_RADIUS * _S), _LENGTH * _W), (_OUT, _TURN, _ACROSS)
    ),
    "hollow cylinder": Solid(
        ("inner_radius", "outer_radius", "length"),
        (*_ring(_S), _LENGTH * _W),
        ((_S, _INNER, _OUTER), _TURN, _ACROSS),
    ),
    "sphere": Solid(("radius",), tuple(_RADIUS * c for c in _BALL), (_OUT, _ZENITH, _TURN)),
    "ellipsoid": Solid(
        ("a", "b", "c"),
        tuple(_size(n) * c for n, c in zip("abc", _BALL, strict=True)),
        (_OUT, _ZENITH, _TURN),
    ),
    "disc": Solid(("radius",), (*_ring(_RADIUS * _S), sp.Integer(0)), (_OUT, _TURN), (1, 2)),
}


@lru_cache
def principal_moments(name: str) -> tuple[Expr, Expr, Expr]:
    """Return I1, I2, I3 about the centre of mass, over the symbol ``mass`` and the sizes.

    Raises `InputError` for an unknown solid.

    >>> principal_moments("cylinder")[2]
    mass*radius**2/2
    """
    if name not in SOLIDS:
        raise unknown_name("solid", name, SOLIDS)
    solid = SOLIDS[name]
    mass = sp.Symbol("mass", positive=True)
    volume = solid.integral(sp.Integer(1))
    second = sp.Matrix(3, 3, lambda i, j: solid.integral(solid.position[i] * solid.position[j]))
    J = inertia_of_second_moments(second) * mass / volume
    i1, i2, i3 = (sp.cancel(J[k, k]) for k in range(3))
    return i1, i2, i3
