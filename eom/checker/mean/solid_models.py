r"""Uniform solids as what a note is about: moments of inertia in closed form, and integrals over the body.

A solid has no states; its mass and sizes are parameters, its moments of inertia quantities by name:
``I1``, ``I2``, ``I3`` about the centre of mass, ``J12``, ``J13``, ``J23`` the products of the matrix there
(J12 = -integral of x y dm), the same with a point's name behind it (``I1_end``, ``J12_corner``),
``centre_1`` to ``centre_3``, where the centre of mass is from the natural point of the solid, and
``density``, the mass for each unit of volume, area or length. ``x``, ``y``,
``z`` are the coordinates of an element of mass, along b1, b2, b3, from the point that the lexicon names.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from eom.errors import InputError
from eom.mass.properties import MassProperties
from eom.mass.solids import CENTRE, MASS, SOLIDS, extent, mass_properties
from eom.quantities import Definition, Quantity
from eom.system import Expr, System

COORDINATES = tuple(sp.Symbol(n, real=True) for n in "xyz")
MAX_DEGREE = 2
_DENSITIES = {1: "kg/m", 2: "kg/m^2", 3: "kg/m^3"}

SPELLINGS = {
    "mass": ("m", "M"),
    "density": (r"\rho", r"\varrho"),
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


@dataclass(frozen=True)
class Pose:
    """How a solid lies in the axes of a note, and what its sizes are measured by.

    ``turn``: rows of the matrix from components along the solid's axes to those of the note, over angles
    that are parameters; ``sizes``: expressions for sizes that are no parameters themselves;
    ``parameters``: what both are over.
    """

    turn: tuple[tuple[Expr, ...], ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    sizes: tuple[tuple[str, Expr], ...] = ()
    parameters: tuple[Quantity, ...] = ()

    @property
    def own(self) -> dict[Expr, Expr]:
        """What stands for sizes that are no parameters."""
        return {sp.Symbol(n, positive=True): e for n, e in self.sizes}

    def of(self, body: MassProperties) -> MassProperties:
        """Return mass properties in the axes and sizes of the note."""
        if self == AS_IT_IS:
            return body
        turned = body.rotated(sp.Matrix(self.turn))
        first, second = (m.xreplace(self.own) for m in (turned.first_moment, turned.second_moments))
        return MassProperties(turned.mass, first, second)


AS_IT_IS = Pose()


def solid_system(name: str, pose: Pose = AS_IT_IS) -> System:
    """Return a solid as a system without states. Raises `InputError` for unknown ones."""
    sizes = [sp.Symbol(n, positive=True) for n in SOLIDS[name].sizes]
    points = {"": CENTRE, **{tail(p): p for p in SOLIDS[name].points}}
    outputs = [
        d for end, p in points.items() for d in _moments(pose.of(mass_properties(name, p)), end)
    ]
    outputs += [
        Definition(_quantity(f"centre_{k}", "m"), c) for k, c in enumerate(_centre(name, pose), 1)
    ]
    unit = _DENSITIES[SOLIDS[name].region.dimension]
    outputs.append(Definition(_quantity("density", unit), (MASS / extent(name)).xreplace(pose.own)))
    return System(
        name=name,
        states=(),
        rates=(),
        parameters=(
            Quantity(MASS, "kg", "mass", "m"),
            *(
                Quantity(s, "m", s.name.replace("_", " "), _letter(s.name))
                for s in sizes
                if s not in pose.own
            ),
            *pose.parameters,
        ),
        inputs=tuple(Quantity(c, "m", "coordinate of an element") for c in COORDINATES),
        outputs=tuple(outputs),
    )


def tail(point: str) -> str:
    """Return how the names of moments about a point end."""
    return "" if point == CENTRE else f"_{point.replace(' ', '_')}"


def _letter(name: str) -> str:
    return SPELLINGS.get(name, (name,))[0]


def _moments(body: MassProperties, end: str) -> Iterator[Definition]:
    J = body.inertia
    for i in range(3):
        yield Definition(_quantity(f"I{i + 1}{end}", "kg m^2"), J[i, i])
        for j in range(i + 1, 3):
            yield Definition(_quantity(f"J{i + 1}{j + 1}{end}", "kg m^2"), J[i, j])


def _quantity(name: str, unit: str) -> Quantity:
    return Quantity(sp.Symbol(name, real=True), unit)


def _centre(name: str, pose: Pose) -> tuple[Expr, ...]:
    """Return the centre of mass from the natural point: none of the named points is needed for it."""
    at = next(iter(SOLIDS[name].points.items()), None)
    if at is None:
        return (sp.S.Zero,) * 3
    found = mass_properties(name, at[0]).centre
    place = sp.Matrix([c + p for c, p in zip(found, at[1], strict=True)])
    return tuple(sp.simplify(c.xreplace(pose.own)) for c in sp.Matrix(pose.turn) * place)


@lru_cache(maxsize=64)
def body_about(name: str, point: str = CENTRE) -> MassProperties:
    """Return the mass properties of a solid about a named point, kept for the next call."""
    return mass_properties(name, point or CENTRE)


def integrated(body: MassProperties, integrand: Expr) -> Expr:
    """Return the integral of a polynomial in the coordinates over the mass of a body.

    Raises `InputError` for other integrands and those of a degree above 2.
    """
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
