"""Inertia of each solid of the catalogue by integration over its own coordinates (002: 3.19-3.34)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.derivations.verification import carried_out
from eom.exact.identity import vanishes
from eom.expressions import as_expression, free_symbols
from eom.mass.properties import MassProperties
from eom.mass.regions import Region, X, properties
from eom.mass.solids import CENTRE, MASS, SOLIDS, mass_properties
from eom.terms.rules import Rule, determinants, entrywise, put_in
from eom.terms.terms import Equation, entries, expr

Expr = Any
PREFIX = "inertia-of-"
FIRST = sp.Matrix([sp.Symbol(f"c_{k}", real=True) for k in (1, 2, 3)])
SECOND = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"S_{min(i, j) + 1}{max(i, j) + 1}", real=True))
PLACE = tuple(sp.Symbol(f"r_{k}", real=True) for k in (1, 2, 3))
PAIRS = tuple((i, j) for i in range(3) for j in range(i, 3))
CONTENT = {1: "length", 2: "area", 3: "volume"}
LETTERS = {
    "mass": "m",
    "radius": "R",
    "inner_radius": "R_i",
    "outer_radius": "R_o",
    "base_radius": "R_b",
    "top_radius": "R_t",
    "ring_radius": "R",
    "tube_radius": "r",
    "height": "h",
    "length": "L",
    "angle": "phi",
    "zenith": "theta",
}
"""The letters of mass, sizes and angles on a page."""


def tidied(value: Expr) -> Expr:
    """Return an expression or a matrix in factors where a denominator holds letters or a sum is over pi."""
    if isinstance(value, sp.MatrixBase):
        return value.applyfunc(tidied)
    divided = any(p.exp.is_negative and p.free_symbols for p in value.atoms(sp.Pow))
    if divided:
        return sp.factor(value)
    return sp.factor_terms(value) if value.has(sp.pi) else value


def names() -> dict[str, str]:
    """Return the name of each derivation with that of its solid."""
    return {PREFIX + solid.replace(" ", "-"): solid for solid in SOLIDS}


def in_letters(value: Expr) -> Expr:
    """Return an expression or a matrix with a letter for each mass, size and angle."""
    known = [s for s in value.atoms(sp.Symbol) if s.name in LETTERS]
    return value.xreplace({s: sp.Symbol(LETTERS[s.name], **s.assumptions0) for s in known})


def solid_inertia(solid: str) -> Derived:
    """Derive mass, centre of mass and inertia about every named point of a uniform solid."""
    name = PREFIX + solid.replace(" ", "-")
    d = Derivation(name, f"Inertia of the {solid}", "Inertia of solids")
    region = SOLIDS[solid].region
    _letters(d, region)
    _element(d, region)
    whole = _moments(d, region)
    return d.finish(**_about_points(d, solid, whole))


def _letters(d: Derivation, region: Region) -> None:
    """Say what the symbols are: sizes by their names, coordinates, parameters."""
    for k, x in enumerate(X, 1):
        d.letter(x, f"coordinate along axis {k}")
    for parameter in region.parameters:
        d.letter(in_letters(parameter), "parameter of the points of the solid")
    ends = free_symbols(as_expression(e) for bound in region.bounds for e in bound[1:])
    inside = free_symbols(map(as_expression, region.position))
    for size in (ends | inside) - set(region.parameters):
        named = size.name in LETTERS
        words = str(size).replace("_", " ") if named else _along(size, region)
        d.letter(in_letters(size), words)
    d.letter(in_letters(MASS), "mass")


def _along(size: Expr, region: Region) -> str:
    """Return what a size without a name of its own is: of an ellipse half of its axis."""
    places = ((k, as_expression(x)) for k, x in enumerate(region.position, 1))
    k, place = next((k, x) for k, x in places if size in x.free_symbols)
    return f"{'half the size' if place.has(sp.sin, sp.cos) else 'size'} along axis {k}"


def _moments(d: Derivation, region: Region) -> MassProperties:
    """State content, first and second moments as integrals."""
    body = properties(region)
    whole = body.of_mass(MASS)
    kind = CONTENT[region.dimension]
    d.show(
        Equation(
            expr(_integral(region, sp.Integer(1))), expr(sp.factor_terms(in_letters(body.mass)))
        ),
        f"the {kind}",
        integrals,
        label=kind,
    )
    density = in_letters(MASS) / sp.factor_terms(in_letters(body.mass))
    for k, x in enumerate(X):
        integral, value = density * _integral(region, x), whole.first_moment[k]
        _name(d, FIRST[k], integral, value, f"first moment of the mass: integral of {x} dm")
    for i, j in PAIRS:
        integral = density * _integral(region, X[i] * X[j])
        factors = f"{X[i]}^2" if i == j else f"{X[i]} {X[j]}"
        words = f"second moment of the mass: integral of {factors} dm"
        _name(d, SECOND[i, j], integral, whole.second_moments[i, j], words)
    return whole


def _name(d: Derivation, symbol: Expr, integral: Expr, value: Expr, words: str) -> None:
    """Let ``symbol`` stand for a moment, and derive its value; what vanishes by form needs no words."""
    value = tidied(in_letters(value))
    name = d.name_scalar(symbol, expr(integral), words, label=f"{symbol}-integral")
    if integral != value:
        d.show(
            Equation(expr(symbol), expr(value)),
            "carried out",
            put_in(name.equation),
            integrals,
            label=str(symbol),
        )


integrals: Rule = entrywise(carried_out, "integration")
"""Integrals carried out; every antiderivative is differentiated again."""


def _element(d: Derivation, region: Region) -> None:
    place = in_letters(sp.Matrix(region.position))
    d.state(
        Equation(entries(sp.Matrix(X)), entries(place), ":="),
        "coordinates of the points of the solid: " + ", ".join(map(_range, region.bounds)),
        "definition",
        label="coordinates",
    )
    slopes = place.jacobian([in_letters(p) for p in region.parameters])
    content = CONTENT[region.dimension]
    if region.dimension == 3:
        shown = _volume_element(region)
        matrix = _right_handed(slopes, shown)
        words = f"the element of {content}: the determinant of the slopes of the coordinates"
    else:
        shown = _volume_element(region) ** 2
        matrix = (slopes.T * slopes).applyfunc(lambda e: sp.trigsimp(sp.expand(e)))
        words = f"the element of {content}, squared: Gram's determinant of the coordinates"
    d.show(
        Equation(expr(shown), expr(sp.Determinant(sp.ImmutableMatrix(matrix)))),
        words,
        determinants,
        label="element",
    )


def _right_handed(slopes: Expr, element: Expr) -> Expr:
    """Return the slopes with the parameters in an order in which their determinant is the element."""
    same = vanishes(slopes.det(method="berkowitz") - element)
    return slopes if same else slopes.extract([0, 1, 2], [1, 0, 2])


def _range(bound: tuple[Expr, Expr, Expr]) -> str:
    parameter, start, end = (_spelt(in_letters(e)) for e in bound)
    return f"{parameter} from {start} to {end}"


def _volume_element(region: Region) -> Expr:
    """Return the element of volume, area or length in its short form, its sums those of the coordinates."""
    places = [in_letters(as_expression(x)) for x in region.position]
    known = sorted({a for x in places for a in x.atoms(sp.Add)}, key=str)
    factors = sp.Mul.make_args(sp.factor(in_letters(region.element)))
    return sp.Mul(*(_by_known(f, known) for f in factors))


def _by_known(factor: Expr, known: Sequence[Expr]) -> Expr:
    """Return a power of a sum as one of a known sum, where they are equal but for the sign."""
    base, power = factor.as_base_exp()
    for other in known if base.is_Add and power.is_Integer else ():
        for sign in (1, -1):
            if sp.expand(base - sign * other) == 0:
                return sign**power * other**power
    return factor


def _integral(region: Region, f: Expr) -> Expr:
    """Return the integral of ``f`` over the region, not carried out."""
    integrand = in_letters(region.at(f)) * _volume_element(region)
    bounds = (tuple(map(in_letters, bound)) for bound in region.bounds)
    return sp.Integer(0) if integrand == 0 else sp.Integral(integrand, *bounds)


def _values(d: Derivation) -> Rule:
    """Return the rule that puts in the values of all moments; zero integrals are their definitions."""
    symbols = [*FIRST, *(SECOND[i, j] for i, j in PAIRS)]
    labels = {step.label for step in d.steps}
    known = (str(s) if str(s) in labels else f"{s}-integral" for s in symbols)
    return put_in(*(d.recall(label).equation for label in known))


def _place(r: Expr) -> str:
    return "(" + ", ".join(map(_spelt, r)) + ")"


def _spelt(value: Expr) -> str:
    """Return an expression as words spell it, a sum from its number on."""
    numbered = value.is_Add and value.args[0].is_Number
    spelt = sp.sstr(value, order="none" if numbered else None)
    return str(spelt).replace("**", "^").replace("*", " ")


def _about_points(d: Derivation, solid: str, whole: MassProperties) -> dict[str, Expr]:
    """Derive the inertia matrix about the centre of mass and each named point."""
    found: dict[str, Expr] = {}
    values = _values(d)
    for point in (CENTRE, *SOLIDS[solid].points):
        moved = mass_properties(solid, point)
        r = tidied(in_letters(whole.centre - moved.centre))
        inertia = tidied(in_letters(sp.ImmutableMatrix(moved.inertia)))
        shifted = MassProperties(in_letters(MASS), FIRST, SECOND).shifted(sp.Matrix(PLACE)).inertia
        shifted = shifted.xreplace(dict(zip(PLACE, r, strict=True)))
        where = "the centre of mass" if point == CENTRE else f"the point {point}"
        d.show(
            Equation(entries(shifted), entries(sp.Matrix(inertia))),
            f"inertia matrix about {where}, at {_place(r)}: the trace of the second moments times the "
            "unit matrix, less their matrix, moved there",
            values,
            label=f"inertia-{point.replace(' ', '-')}",
        )
        found[f"J about {where}"] = sp.Matrix(inertia)
        d.stands_for(f"J about {where}", f"inertia matrix about {where}")
    return found
