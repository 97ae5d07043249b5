"""Inertia of each solid of the catalogue by integration over its own coordinates (002: 3.19-3.34)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from eom.derivation import Derivation, Maker
from eom.frames import tilde
from eom.regions import Region, X, properties
from eom.solids import MASS, SOLIDS, mass_properties
from eom.terms import Equation, entries, expr

Expr = Any
PREFIX = "inertia-of-"
CONTENT = {1: "length", 2: "area", 3: "volume"}


def names() -> dict[str, str]:
    """Return the name of each derivation with that of its solid."""
    return {PREFIX + solid.replace(" ", "-"): solid for solid in SOLIDS}


def solid_inertia(solid: str) -> Derivation:
    """Derive mass, centre of mass and inertia about every named point of a uniform solid."""
    name = PREFIX + solid.replace(" ", "-")
    d = Maker(name, f"Inertia of the {solid}", "Inertia of solids")
    region = SOLIDS[solid].region
    _element(d, region)
    content = properties(region).mass
    whole = properties(region).of_mass(MASS)
    d.state(
        Equation(_integral(region, sp.Integer(1)), expr(content)),
        f"the {CONTENT[region.dimension]}",
        label="content",
    )
    first = [[MASS / content * _plain(region, x)] for x in X]
    d.state(
        Equation(entries(sp.Matrix(first)), entries(whole.first_moment)),
        "first moments of the mass, from the origin of the solid's coordinates",
        label="first-moments",
    )
    second = sp.Matrix(3, 3, lambda i, j: MASS / content * _plain(region, X[i] * X[j]))
    d.state(
        Equation(entries(second), entries(whole.second_moments)),
        "second moments",
        label="second-moments",
    )
    S = sp.Matrix(whole.second_moments)
    d.state(
        Equation(entries(sp.eye(3) * S.trace() - S), entries(sp.Matrix(whole.inertia))),
        "the inertia matrix about that origin: J = tr(S) 1 - S",
        label="inertia-origin",
    )
    return d.finish(**_about_points(d, solid, whole))


def _element(d: Maker, region: Region) -> None:
    jacobian = sp.Matrix(region.position).jacobian(region.parameters)
    gram = (jacobian.T * jacobian).det(method="berkowitz")
    d.state(
        Equation(expr(region.element**2), expr(gram)),
        f"the element of {CONTENT[region.dimension]}, squared: Gram's determinant of the coordinates",
        label="element",
    )


def _plain(region: Region, f: Expr) -> Expr:
    """Return the unevaluated integral of ``f`` over the region."""
    return sp.Integral(region.at(f) * region.element, *region.bounds)


def _integral(region: Region, f: Expr) -> Any:
    return expr(_plain(region, f))


def _about_points(d: Maker, solid: str, whole: Any) -> dict[str, Expr]:
    """State the matrix about the centre of mass and each named point by the parallel-axis theorem."""
    found: dict[str, Expr] = {}
    points: Sequence[str] = ("centre of mass", *SOLIDS[solid].points)
    for point in points:
        moved = mass_properties(solid, point)
        step = whole.centre - moved.centre
        c, r = tilde(whole.first_moment), tilde(step)
        shifted = whole.inertia + r * c + c * r - MASS * r * r
        d.state(
            Equation(entries(sp.Matrix(shifted)), entries(sp.Matrix(moved.inertia))),
            f"about the point {point}: J + r~ c~ + c~ r~ - m r~ r~"
            if point != "centre of mass"
            else "about the centre of mass: J + r~ c~ + c~ r~ - m r~ r~",
            label=f"inertia-{point.replace(' ', '-')}",
        )
        found[point] = moved.inertia
    return {f"J about {point}": J for point, J in found.items()}
