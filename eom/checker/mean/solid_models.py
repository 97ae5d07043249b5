r"""Uniform solids as what a note is about: moments of inertia in closed form, and integrals over the body.

A solid has no states; its mass and sizes are parameters, its moments of inertia quantities by name:
``I1``, ``I2``, ``I3`` about the centre of mass, ``J12``, ``J13``, ``J23`` the products of the matrix there
(J12 = -integral of x y dm), the same with a point's name behind it (``I1_end``, ``J12_corner``), and
``centre_1`` to ``centre_3``, where the centre of mass is from the natural point of the solid. ``x``, ``y``,
``z`` are the coordinates of an element of mass, along b1, b2, b3, from the point that the lexicon names.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import sympy as sp

from eom.errors import InputError
from eom.mass.properties import MassProperties
from eom.mass.solids import CENTRE, MASS, SOLIDS, mass_properties
from eom.quantities import Definition, Quantity
from eom.system import Expr, System

COORDINATES = tuple(sp.Symbol(n, real=True) for n in "xyz")
MAX_DEGREE = 2

SPELLINGS = {
    "mass": ("m", "M"),
    "radius": ("R",),
    "inner_radius": ("R_i", "R_1"),
    "outer_radius": ("R_o", "R_2"),
    "base_radius": ("R_b", "R_1"),
    "top_radius": ("R_t", "R_2"),
    "ring_radius": ("R",),
    "tube_radius": ("r",),
    "height": ("h", "H"),
    "length": ("L", "l", r"\ell", "h", "H"),
}
"""Usual letters of mass and sizes, the first as they are printed."""


def solid_system(name: str) -> System:
    """Return a solid as a system without states. Raises `InputError` for unknown ones."""
    sizes = [sp.Symbol(n, positive=True) for n in SOLIDS[name].sizes]
    points = {"": CENTRE, **{f"_{p.replace(' ', '_')}": p for p in SOLIDS[name].points}}
    outputs = [d for tail, p in points.items() for d in _moments(mass_properties(name, p), tail)]
    outputs += [
        Definition(_quantity(f"centre_{k}", "m"), c) for k, c in enumerate(_centre(name), 1)
    ]
    return System(
        name=name,
        states=(),
        rates=(),
        parameters=(
            Quantity(MASS, "kg", "mass", "m"),
            *(Quantity(s, "m", s.name.replace("_", " "), _letter(s.name)) for s in sizes),
        ),
        inputs=tuple(Quantity(c, "m", "coordinate of an element") for c in COORDINATES),
        outputs=tuple(outputs),
    )


def _letter(name: str) -> str:
    return SPELLINGS.get(name, (name,))[0]


def _moments(body: MassProperties, tail: str) -> Iterator[Definition]:
    J = body.inertia
    for i in range(3):
        yield Definition(_quantity(f"I{i + 1}{tail}", "kg m^2"), J[i, i])
        for j in range(i + 1, 3):
            yield Definition(_quantity(f"J{i + 1}{j + 1}{tail}", "kg m^2"), J[i, j])


def _quantity(name: str, unit: str) -> Quantity:
    return Quantity(sp.Symbol(name, real=True), unit)


def _centre(name: str) -> tuple[Expr, ...]:
    """Return the centre of mass from the natural point: none of the named points is needed for it."""
    at = next(iter(SOLIDS[name].points.items()), None)
    if at is None:
        return (sp.S.Zero,) * 3
    found = mass_properties(name, at[0]).centre
    return tuple(sp.simplify(c + p) for c, p in zip(found, at[1], strict=True))


@lru_cache(maxsize=64)
def _about(name: str, point: str) -> MassProperties:
    return mass_properties(name, point)


def integrated(name: str, point: str, integrand: Expr) -> Expr:
    """Return the integral of a polynomial in the coordinates over the mass of a solid.

    Raises `InputError` for other integrands and those of a degree above 2.
    """
    body = _about(name, point or CENTRE)
    try:
        polynomial = sp.Poly(integrand, *COORDINATES)
    except sp.PolynomialError:
        raise InputError("this is no polynomial of the coordinates", got=integrand) from None
    if polynomial.total_degree() > MAX_DEGREE:
        raise InputError("an integral of a high power", got=integrand, expected="degree 2 at most")
    return sp.Add(*(c * _moment(body, powers) for powers, c in polynomial.terms()))


def _moment(body: MassProperties, powers: tuple[int, ...]) -> Expr:
    """Return the integral of x^a y^b z^c dm."""
    axes = [k for k, power in enumerate(powers) for _ in range(power)]
    if not axes:
        return body.mass
    return body.first_moment[axes[0]] if len(axes) == 1 else body.second_moments[axes[0], axes[1]]
