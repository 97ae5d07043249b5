"""Bodies as regions of space, and what integration over their mass gives: mass, centre, inertia.

A region is covered once by a map from one, two or three parameters to positions: a rod, a surface
or plate, a solid. Units: lengths in m; density in kg/m, kg/m^2 or kg/m^3.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import sympy as sp

from eom.errors import InputError, unknown_name
from eom.exact.integrals import Bound, definite
from eom.expressions import as_expression
from eom.mass.properties import MassProperties

Expr = Any

X = tuple(sp.Symbol(name, real=True) for name in "xyz")
"""The coordinates over which densities and the integrands of moments are written."""


@dataclass(frozen=True)
class Region:
    """A map from parameters to positions that covers a body once, and its density.

    Parameters
    ----------
    position : tuple of expression, expression, expression
        Three expressions over the parameters and sizes, components in the body's axes.
    bounds : tuple of Bound
        (parameter, from, to), the innermost integral first, so that limits may depend on later
        parameters.
    density : expression, optional
        Over the coordinates `X` and sizes, 1 if left out.

    Raises
    ------
    InputError
        Where these do not fit.

    Notes
    -----
    In any consistent units: lengths (m), and mass by volume, area or length as the dimension is
    three, two or one.
    """

    position: tuple[Expr, Expr, Expr]
    bounds: tuple[Bound, ...]
    density: Expr = sp.S.One

    def __post_init__(self) -> None:
        set_field = object.__setattr__
        set_field(self, "position", tuple(map(_exact, self.position)))
        set_field(self, "bounds", tuple(tuple(map(_exact, b)) for b in self.bounds))
        set_field(self, "density", _exact(self.density))
        _check_form(self)

    @property
    def dimension(self) -> int:
        """3 for a solid, 2 for a surface or plate, 1 for a rod."""
        return len(self.bounds)

    @property
    def parameters(self) -> tuple[Expr, ...]:
        """The parameters of the map, innermost integral first."""
        return tuple(parameter for parameter, _, _ in self.bounds)

    @property
    def sizes(self) -> tuple[Expr, ...]:
        """All symbols that are neither parameters nor coordinates, sorted by name."""
        free = set().union(*(e.free_symbols for b in self.bounds for e in b))
        free |= set().union(*(p.free_symbols for p in self.position)) - set(self.parameters)
        free |= self.density.free_symbols - set(X)
        return tuple(sorted(free - set(self.parameters), key=str))

    @cached_property
    def element(self) -> Expr:
        """Volume, area or length a unit of the parameters, not negative where the map is proper.

        The determinant of the Jacobian matrix for solids, the root of Gram's determinant else; its
        sign is the one that makes it positive halfway between the bounds, at sizes near 1.
        """
        jacobian = sp.Matrix(self.position).jacobian(self.parameters)
        if self.dimension == 3:
            root = reduce_circles(jacobian.det(method="berkowitz"))
        else:
            gram = (jacobian.T * jacobian).applyfunc(reduce_circles)
            root = _square_root(reduce_circles(gram.det(method="berkowitz")))
        return sp.expand(root * _sign_halfway(root, self.bounds))

    @cached_property
    def _mass_element(self) -> Expr:
        return self.at(self.density) * self.element

    def at(self, f: Expr) -> Expr:
        """Return a function of the place as one of the region's parameters.

        Parameters
        ----------
        f : expression
            Over the coordinates `X`.

        Returns
        -------
        expression
            Over the parameters.

        Raises
        ------
        InputError
            For what is no expression.
        """
        places = dict(zip(X, self.position, strict=True))
        return as_expression(f).xreplace(places)

    def moment(self, f: Expr) -> Expr:
        """Return the integral of a function of the place over the mass.

        Parameters
        ----------
        f : expression
            Over the coordinates `X`.

        Returns
        -------
        expression
            The integral of ``f`` dm, exact.

        Examples
        --------
        >>> u = sp.Symbol("u", positive=True)
        >>> Region((u, 0, 0), ((u, 0, 2),)).moment(X[0] ** 2)
        8/3
        """
        value = self.at(f) * self._mass_element
        for bound in self.bounds:
            value = definite(value, bound)
        return sp.expand(value)


def properties(region: Region) -> MassProperties:
    """Return mass and moments of ``region`` about the origin of its coordinates.

    Parameters
    ----------
    region : Region
        The body as a map from parameters to places, with its density.

    Returns
    -------
    MassProperties
        About the origin of its coordinates. Units (kg, m where the region has them), shapes and
        axes as of `MassProperties`; the integrals are exact.

    Raises
    ------
    InputError
        For a region of numbers alone that `check` refuses; sizes in symbols are checked by that
        function when their values are known.

    Examples
    --------
    >>> u, v, a = (sp.Symbol(n, positive=True) for n in "uva")
    >>> square = Region((a * u, a * v, 0), ((u, 0, 1), (v, 0, 1)))
    >>> properties(square).about_centre[2, 2]
    a**4/6
    """
    if not region.sizes:
        check(region, {})
    first = [region.moment(x) for x in X]
    second = {(i, j): region.moment(X[i] * X[j]) for i in range(3) for j in range(i, 3)}
    S = sp.Matrix(3, 3, lambda i, j: second[min(i, j), max(i, j)])
    return MassProperties(region.moment(1), first, S)


def simplex(*corners: Sequence[Expr]) -> Region:
    """Return the rod, triangle or tetrahedron with two, three or four ``corners``.

    Parameters
    ----------
    corners : sequences of expressions
        Two, three or four points, each of three coordinates, in any consistent units, along the
        body's axes.

    Returns
    -------
    Region
        Of density 1; `MassProperties.of_mass` scales what is computed of it.

    Raises
    ------
    InputError
        For another number of corners or of coordinates.

    Examples
    --------
    >>> properties(simplex((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))).mass
    1/6
    """
    if not 2 <= len(corners) <= 4 or any(len(c) != 3 for c in corners):
        raise InputError(
            "a simplex has two to four corners of three coordinates each", got=list(corners)
        )
    first, *rest = (sp.Matrix([_exact(e) for e in corner]) for corner in corners)
    parameters = [sp.Symbol(f"s_{k}", nonnegative=True) for k in range(1, len(corners))]
    position = first
    bounds: list[Bound] = []
    for k, (corner, s) in enumerate(zip(rest, parameters, strict=True)):
        position = position + s * (corner - first)
        bounds.append((s, sp.S.Zero, 1 - sp.Add(*parameters[k + 1 :])))
    a, b, c = position
    return Region((a, b, c), tuple(bounds))


def _exact(value: Expr) -> Expr:
    """Read decimal numbers as the fractions that they are written as."""
    expression = as_expression(value)
    return expression.xreplace({f: sp.Rational(str(f)) for f in expression.atoms(sp.Float)})


def reduce_circles(expression: Expr) -> Expr:
    """Expand, and use sin^2 + cos^2 = 1 for each angle where that leaves fewer terms."""
    best = sp.expand(expression)
    angles = {f.args[0] for f in best.atoms(sp.sin, sp.cos)}
    for angle in sorted(angles, key=sp.default_sort_key):
        s, c = sp.sin(angle), sp.cos(angle)
        candidates = (best, _without_powers(best, s, c), _without_powers(best, c, s))
        best = min(candidates, key=lambda e: len(sp.Add.make_args(e)))
    return best


def _without_powers(expression: Expr, drop: Expr, keep: Expr) -> Expr:
    powers = [p for p in expression.atoms(sp.Pow) if p.base == drop and p.exp.is_Integer]
    return sp.expand(
        expression.xreplace(
            {p: (1 - keep**2) ** (p.exp // 2) * drop ** (p.exp % 2) for p in powers if p.exp > 1}
        )
    )


def _square_root(square: Expr) -> Expr:
    """Take factors of even power out of the root, of either sign."""
    if square == 0:
        return sp.S.Zero
    over, under = (sp.factor_list(part) for part in sp.fraction(sp.together(square)))
    factors = [*over[1], *((base, -power) for base, power in under[1])]
    outside = sp.Mul(*(base ** (power // 2) for base, power in factors))
    inside = sp.Mul(over[0] / under[0], *(base for base, power in factors if power % 2))
    return outside * sp.sqrt(sp.expand(inside))


def _sign_halfway(root: Expr, bounds: tuple[Bound, ...]) -> int:
    """The sign of ``root`` at an inner point of the bounds; 1 where it cannot be known."""
    free = sorted(root.free_symbols.union(*(e.free_symbols for b in bounds for e in b)), key=str)
    values = {s: sp.Float(1 + k / 7) for k, s in enumerate(free)}
    for parameter, start, end in reversed(bounds):
        values[parameter] = (sp.Rational(5, 8) * start + sp.Rational(3, 8) * end).xreplace(values)
    return -1 if root.xreplace(values).evalf().is_negative else 1


def _check_form(region: Region) -> None:
    if len(region.position) != 3 or not 1 <= len(region.bounds) <= 3:
        raise InputError(
            "a region has three coordinates and one to three parameters",
            got=f"{len(region.position)} coordinates, {len(region.bounds)} bounds",
        )
    inner: set[Expr] = set()
    for bound in region.bounds:
        if len(bound) != 3 or not isinstance(bound[0], sp.Symbol) or bound[0] in inner:
            raise InputError(
                "a bound is (parameter, from, to), each parameter once",
                where="bounds",
                got=bound,
            )
        inner.add(bound[0])
        used = inner & (bound[1].free_symbols | bound[2].free_symbols)
        infinite = any(limit.has(sp.oo, -sp.oo, sp.zoo, sp.nan) for limit in bound[1:])
        if used or infinite:
            raise InputError(
                f"impossible limits of {bound[0]}",
                where="bounds",
                got=bound,
                expected="finite, over sizes and the parameters of later (outer) bounds",
            )
    astray = region.density.free_symbols & (inner - set(X))
    if astray:
        raise InputError(
            f"density over the parameter {min(map(str, astray))}",
            where="density",
            got=region.density,
            expected="an expression over the coordinates eom.mass.regions.X and sizes",
        )


def check(region: Region, sizes: Mapping[str, float]) -> None:
    """Raise `InputError` if ``region`` is impossible at numeric ``sizes``, by name.

    Sampled on a grid with the corners: bounds that are reversed, no volume, area or length, a map
    that turns inside out or covers a place twice, a density that is negative or no number.
    """
    exact = _exact_sizes(region, sizes)
    grid = list(_grid(region, exact))
    values = [_at(region.element.xreplace(exact), point, "element") for point in grid]
    largest = max(map(abs, values))
    if largest == 0:
        raise InputError(f"region has no {_MEASURE[region.dimension]}", where=_place(grid[0]))
    turned = [p for p, value in zip(grid, values, strict=True) if value < -1e-9 * largest]
    if turned:
        both = max(values) > 1e-9 * largest
        raise InputError(
            "the map turns inside out: it covers part of the region twice"
            if both
            else "the orientation of the map is reversed at these sizes",
            where=_place(turned[0]),
            got=f"{min(values):g} and {max(values):g} {_MEASURE[region.dimension]} a unit of "
            f"{', '.join(map(str, region.parameters))}",
            expected="no sign change within the bounds" if both else "a positive one",
            hint="" if both else "swap two vertices, or measure one parameter the other way",
        )
    places = [
        [_at(x.xreplace(exact), point, "position") for x in region.position] for point in grid
    ]
    _check_density(region, exact, grid, places)
    _check_covered_once(region, grid, places)


_MEASURE = {3: "volume", 2: "area", 1: "length"}
_FRACTIONS = (0.0, 0.19, 0.31, 0.5, 0.69, 0.81, 1.0)
"""Of the way between the bounds; some lie half a range apart, so that a second turn is seen."""


def _exact_sizes(region: Region, sizes: Mapping[str, float]) -> dict[Expr, Expr]:
    known = {s.name: s for s in region.sizes}
    for name, value in sizes.items():
        if name not in known:
            raise unknown_name("size", name, known, "sizes")
        if not math.isfinite(value) or (known[name].is_positive and value <= 0):
            expected = "a positive number" if known[name].is_positive else "a finite number"
            raise InputError("impossible size", where=name, got=value, expected=expected)
    missing = [name for name in known if name not in sizes]
    if missing:
        raise InputError(f"missing size: {', '.join(missing)}", where="sizes")
    return {known[n]: sp.Rational(str(value)) for n, value in sizes.items()}


def _grid(region: Region, exact: dict[Expr, Expr]) -> Iterator[dict[Expr, float]]:
    """Yield points of the parameters, from the outermost integral inwards."""
    widest: dict[Expr, float] = {}
    bounds = [(p, a.xreplace(exact), b.xreplace(exact)) for p, a, b in reversed(region.bounds)]
    for fractions in product(_FRACTIONS, repeat=len(bounds)):
        point: dict[Expr, float] = {}
        for fraction, (parameter, low, high) in zip(fractions, bounds, strict=True):
            start, end = (_at(e, point, f"bound of {parameter}") for e in (low, high))
            if end < start - 1e-9 * widest.get(parameter, 0.0):
                raise InputError(
                    f"bounds of {parameter} are reversed",
                    where=_place(point) or f"bounds of {parameter}",
                    got=f"from {start:g} to {end:g}",
                    expected="from <= to",
                )
            widest[parameter] = max(widest.get(parameter, 0.0), end - start)
            point[parameter] = start + fraction * (end - start)
        yield point
    empty = [p for p, width in widest.items() if width == 0]
    if empty:
        raise InputError(
            f"region has no {_MEASURE[region.dimension]}",
            where=f"bounds of {empty[0]}",
            got="from and to are equal",
        )


def _check_density(
    region: Region,
    exact: dict[Expr, Expr],
    grid: list[dict[Expr, float]],
    places: list[list[float]],
) -> None:
    density = region.at(region.density).xreplace(exact)
    values = [_at(density, point, "density") for point in grid]
    largest = max(map(abs, values))
    lowest = min(range(len(values)), key=values.__getitem__)
    if values[lowest] < -1e-12 * largest or largest == 0:
        raise InputError(
            "density is negative" if largest else "density is zero everywhere",
            where=_place(dict(zip(X, places[lowest], strict=True))),
            got=f"{region.density} = {values[lowest]:g}",
            expected="a density that is not negative in the region, and positive somewhere",
        )


def _check_covered_once(
    region: Region, grid: list[dict[Expr, float]], places: list[list[float]]
) -> None:
    """Compare the positions of inner points; on the boundary a map may meet itself."""
    ranges = [(min(column), max(column)) for column in zip(*places, strict=True)]
    seen: dict[tuple[float, ...], dict[Expr, float]] = {}
    fractions = product(_FRACTIONS, repeat=region.dimension)
    for inside, point, place in zip(fractions, grid, places, strict=True):
        if {0.0, 1.0} & set(inside):
            continue
        key = tuple(
            round((x - low) / (high - low), 9) if high > low else 0.0
            for x, (low, high) in zip(place, ranges, strict=True)
        )
        if key in seen:
            raise InputError(
                "the map covers a place twice",
                where=_place(dict(zip(X, place, strict=True))),
                got=f"{_place(seen[key])} and {_place(point)}",
                expected="one point of the parameters for each place",
            )
        seen[key] = point


def _at(expression: Expr, point: Mapping[Expr, float], what: str) -> float:
    value = expression.xreplace({s: sp.Float(v) for s, v in point.items()})
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise InputError(f"{what} is not a finite real number", where=_place(point), got=value)
    return number


def _place(point: Mapping[Expr, float]) -> str:
    return ", ".join(f"{s} = {v:.6g}" for s, v in point.items())
