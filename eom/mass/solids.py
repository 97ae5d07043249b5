"""Named uniform solids, surfaces and rods: regions of space, and their inertia by integration.

Every axis of symmetry is b3. Positions are measured from a natural point of the solid: the apex of
a cone, the centre of the base of a pyramid, the corner with the right angle of a tetrahedron.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import sympy as sp

from eom.errors import InputError, typed, unknown_name
from eom.mass.properties import MassProperties
from eom.mass.regions import Region, properties, simplex

Expr = Any
Place = tuple[Expr, Expr, Expr]

CENTRE = "centre of mass"
MASS = sp.Symbol("mass", positive=True)


@dataclass(frozen=True)
class Solid:
    """The region that a solid of given sizes covers once, and its named points.

    ``sizes``: names, in m; ``points``: reference points in the coordinates of the region, beside
    the centre of mass; ``smaller``: pairs of sizes of which the first must be less than the second.
    """

    sizes: tuple[str, ...]
    region: Region
    points: Mapping[str, Place] = field(default_factory=dict)
    smaller: tuple[tuple[str, str], ...] = ()


def _size(name: str) -> Expr:
    return sp.Symbol(name, positive=True)


_ANGLE, _ZENITH, _S, _T, _W = (
    sp.Symbol(n, nonnegative=True) for n in ("angle", "zenith", "s", "t", "w")
)
_A, _B, _C, _LENGTH, _HEIGHT, _RADIUS, _INNER, _OUTER, _BASE, _TOP, _RING, _TUBE = (
    _size(n)
    for n in "a b c length height radius inner_radius outer_radius base_radius top_radius "
    "ring_radius tube_radius".split()
)
_0, _1, _HALF = sp.S.Zero, sp.S.One, sp.S.Half


def _around(radius: Expr, third: Expr) -> Place:
    """The position at a distance ``radius`` from the axis b3."""
    return radius * sp.cos(_ANGLE), radius * sp.sin(_ANGLE), third


def _on_sphere(radius: Expr) -> Place:
    return _around(radius * sp.sin(_ZENITH), radius * sp.cos(_ZENITH))


_TURN = (_ANGLE, _0, 2 * sp.pi)
_OUT = (_S, _0, _1)
_UP = (_W, _0, _1)
_ALONG = (_W, -_HALF, _HALF)
_BETWEEN = (_S, _INNER, _OUTER)
_BALL = (_ZENITH, _0, sp.pi)
_UPPER = (_ZENITH, _0, sp.pi / 2)
_CORNER: Place = (_0, _0, _0)
_NARROW = _BASE + (_TOP - _BASE) * _W
_HOLLOW = (("inner_radius", "outer_radius"),)
_RIM = _RING + _S * sp.cos(_T)

SOLIDS: dict[str, Solid] = {
    "box": Solid(
        ("a", "b", "c"),
        Region((_A * _S, _B * _T, _C * _W), ((_S, -_HALF, _HALF), (_T, -_HALF, _HALF), _ALONG)),
        {"corner": (-_A / 2, -_B / 2, -_C / 2)},
    ),
    "cylinder": Solid(
        ("radius", "length"),
        Region(_around(_RADIUS * _S, _LENGTH * _W), (_TURN, _OUT, _ALONG)),
        {"base": (_0, _0, -_LENGTH / 2)},
    ),
    "hollow cylinder": Solid(
        ("inner_radius", "outer_radius", "length"),
        Region(_around(_S, _LENGTH * _W), (_TURN, _BETWEEN, _ALONG)),
        {"base": (_0, _0, -_LENGTH / 2)},
        _HOLLOW,
    ),
    "elliptical cylinder": Solid(
        ("a", "b", "length"),
        Region(
            (_A * _S * sp.cos(_ANGLE), _B * _S * sp.sin(_ANGLE), _LENGTH * _W),
            (_TURN, _OUT, _ALONG),
        ),
        {"base": (_0, _0, -_LENGTH / 2)},
    ),
    "cylindrical shell": Solid(
        ("radius", "length"),
        Region(_around(_RADIUS, _LENGTH * _W), (_TURN, _ALONG)),
        {"base": (_0, _0, -_LENGTH / 2)},
    ),
    "cone": Solid(
        ("radius", "height"),
        Region(_around(_RADIUS * _W * _S, _HEIGHT * _W), (_TURN, _OUT, _UP)),
        {"apex": _CORNER, "base": (_0, _0, _HEIGHT)},
    ),
    "conical shell": Solid(
        ("radius", "height"),
        Region(_around(_RADIUS * _W, _HEIGHT * _W), (_TURN, _UP)),
        {"apex": _CORNER, "base": (_0, _0, _HEIGHT)},
    ),
    "frustum": Solid(
        ("base_radius", "top_radius", "height"),
        Region(_around(_NARROW * _S, _HEIGHT * _W), (_TURN, _OUT, _UP)),
        {"base": _CORNER, "top": (_0, _0, _HEIGHT)},
    ),
    "sphere": Solid(
        ("radius",),
        Region(_on_sphere(_RADIUS * _S), (_TURN, _BALL, _OUT)),
        {"pole": (_0, _0, _RADIUS)},
    ),
    "hollow sphere": Solid(
        ("inner_radius", "outer_radius"),
        Region(_on_sphere(_S), (_TURN, _BALL, _BETWEEN)),
        smaller=_HOLLOW,
    ),
    "spherical shell": Solid(
        ("radius",), Region(_on_sphere(_RADIUS), (_TURN, _BALL)), {"pole": (_0, _0, _RADIUS)}
    ),
    "hemisphere": Solid(
        ("radius",),
        Region(_on_sphere(_RADIUS * _S), (_TURN, _UPPER, _OUT)),
        {"base": _CORNER, "pole": (_0, _0, _RADIUS)},
    ),
    "hemispherical shell": Solid(
        ("radius",),
        Region(_on_sphere(_RADIUS), (_TURN, _UPPER)),
        {"base": _CORNER, "pole": (_0, _0, _RADIUS)},
    ),
    "ellipsoid": Solid(
        ("a", "b", "c"),
        Region(
            tuple(n * p for n, p in zip((_A, _B, _C), _on_sphere(_S), strict=True)),
            (_TURN, _BALL, _OUT),
        ),
    ),
    "torus": Solid(
        ("ring_radius", "tube_radius"),
        Region(_around(_RIM, _S * sp.sin(_T)), (_TURN, (_T, _0, 2 * sp.pi), (_S, _0, _TUBE))),
        smaller=(("tube_radius", "ring_radius"),),
    ),
    "rod": Solid(
        ("length",),
        Region((_0, _0, _LENGTH * _W), (_ALONG,)),
        {"end": (_0, _0, -_LENGTH / 2)},
    ),
    "ring": Solid(("radius",), Region(_around(_RADIUS, _0), (_TURN,)), {"rim": (_RADIUS, _0, _0)}),
    "disc": Solid(
        ("radius",),
        Region(_around(_RADIUS * _S, _0), (_TURN, _OUT)),
        {"rim": (_RADIUS, _0, _0)},
    ),
    "annulus": Solid(
        ("inner_radius", "outer_radius"),
        Region(_around(_S, _0), (_TURN, _BETWEEN)),
        {"rim": (_OUTER, _0, _0)},
        _HOLLOW,
    ),
    "semicircular disc": Solid(
        ("radius",),
        Region(_around(_RADIUS * _S, _0), ((_ANGLE, _0, sp.pi), _OUT)),
        {"base": _CORNER},
    ),
    "elliptical disc": Solid(
        ("a", "b"),
        Region((_A * _S * sp.cos(_ANGLE), _B * _S * sp.sin(_ANGLE), _0), (_TURN, _OUT)),
    ),
    "rectangular plate": Solid(
        ("a", "b"),
        Region((_A * _S, _B * _T, _0), ((_S, -_HALF, _HALF), (_T, -_HALF, _HALF))),
        {"corner": (-_A / 2, -_B / 2, _0)},
    ),
    "triangular plate": Solid(
        ("a", "b"), simplex(_CORNER, (_A, _0, _0), (_0, _B, _0)), {"corner": _CORNER}
    ),
    "tetrahedron": Solid(
        ("a", "b", "c"),
        simplex(_CORNER, (_A, _0, _0), (_0, _B, _0), (_0, _0, _C)),
        {"corner": _CORNER},
    ),
    "triangular prism": Solid(
        ("a", "b", "length"),
        Region((_A * _S, _B * _T, _LENGTH * _W), ((_S, _0, 1 - _T), (_T, _0, _1), _ALONG)),
        {"corner": (_0, _0, -_LENGTH / 2), "edge": _CORNER},
    ),
    "pyramid": Solid(
        ("a", "b", "height"),
        Region(
            (_A * _S * (1 - _W), _B * _T * (1 - _W), _HEIGHT * _W),
            ((_S, -_HALF, _HALF), (_T, -_HALF, _HALF), _UP),
        ),
        {"base": _CORNER, "apex": (_0, _0, _HEIGHT)},
    ),
}
"""Right angles: between a and b (triangular plate, prism) and between all legs (tetrahedron).

The frustum has its base at the origin and its top along b3; cones have their apex at the origin
and the base along b3; hemispheres bulge, and pyramids point, along b3.
"""


@typed
def mass_properties(name: str, point: str = CENTRE) -> MassProperties:
    """Return moments of mass about a named ``point``, over the symbol ``mass`` and the sizes.

    Parameters
    ----------
    name : str
        Of a uniform solid, such as ``cone`` or ``rod``.
    point : str, default "centre of mass"
        The centre of mass, or one of the solid's own such as an ``apex`` or an ``end``.

    Returns
    -------
    MassProperties
        Moments about the point (kg, m), in axes whose third is the axis of a symmetric one.

    Raises
    ------
    InputError
        For an unknown solid or point.

    Notes
    -----
    By integration, as of `eom.mass.regions.properties`.

    Examples
    --------
    >>> mass_properties("cone", "apex").centre[2]
    3*height/4
    """
    solid = _solid(name)
    if point == CENTRE:
        whole = _about_origin(name)
        return whole.shifted(whole.centre)
    if point not in solid.points:
        raise unknown_name("point", point, (CENTRE, *solid.points), f"solid {name!r}")
    return _about_origin(name).shifted(solid.points[point])


@typed
def inertia(name: str, point: str = CENTRE) -> Expr:
    """Return the inertia matrix about a named ``point``, over the symbol ``mass`` and the sizes.

    Parameters
    ----------
    name : str
        Of a uniform solid, as of `mass_properties`.
    point : str, default "centre of mass"
        As of `mass_properties`.

    Returns
    -------
    matrix
        3 x 3 (kg m^2), off-diagonal entries minus the products of inertia; axes and source as of
        `mass_properties`.

    Raises
    ------
    InputError
        For an unknown solid or point.

    Examples
    --------
    >>> inertia("rod", "end")[0, 0]
    length**2*mass/3
    """
    return central_inertia(name) if point == CENTRE else mass_properties(name, point).inertia


@lru_cache
def principal_moments(name: str) -> tuple[Expr, Expr, Expr]:
    """Return I1, I2, I3 about the centre of mass, over the symbol ``mass`` and the sizes.

    Raises `InputError` for an unknown solid, and for one whose principal axes are not b1, b2, b3.

    >>> principal_moments("cylinder")[2]
    mass*radius**2/2
    """
    J = central_inertia(name)
    if not J.is_diagonal():
        raise InputError(
            "b1, b2, b3 are no principal axes of this solid",
            got=name,
            hint="eom.mass.solids.inertia returns the whole matrix",
        )
    return J[0, 0], J[1, 1], J[2, 2]


@lru_cache
def central_inertia(name: str) -> Expr:
    """Return `inertia` about the centre of mass, kept for the next call."""
    body = properties(_solid(name).region)
    c, factor = body.first_moment, MASS / body.mass
    central = (body.second_moments - c * c.T / body.mass) * factor
    return MassProperties(MASS, sp.zeros(3, 1), central).inertia


@lru_cache
def extent(name: str) -> Expr:
    """Return the volume (m^3), area (m^2) or length (m) of a solid, surface or rod, over its sizes.

    By integration, as of `eom.mass.regions.properties`. Raises `InputError` for an unknown solid.

    >>> extent("cylinder")
    pi*length*radius**2
    """
    return properties(_solid(name).region).mass


def check_sizes(name: str, sizes: Mapping[str, float], where: str = "sizes") -> None:
    """Raise `InputError` unless ``sizes`` (m) are those of the solid, positive and possible."""
    solid = _solid(name, where)
    if set(sizes) != set(solid.sizes):
        missing = [n for n in solid.sizes if n not in sizes]
        spare = [n for n in sizes if n not in solid.sizes]
        named = ", ".join((*(f"{n} is missing" for n in missing), *(f"{n} is none" for n in spare)))
        raise InputError(
            f"the sizes of a {name} do not fit: {named}",
            where=where,
            got=", ".join(sizes) or "none",
            expected=", ".join(solid.sizes),
            hint="size = { " + ", ".join(f"{n} = 0.1" for n in solid.sizes) + " }, in m",
        )
    for size, value in sizes.items():
        if not (math.isfinite(value) and value > 0):
            raise InputError(
                f"{size} is not positive", where=where, got=value, expected="a length in m"
            )
    for small, large in solid.smaller:
        if not sizes[small] < sizes[large]:
            raise InputError(
                f"{small.replace('_', ' ')} is not less than {large.replace('_', ' ')}",
                where=where,
                got=f"{small} = {sizes[small]:g}, {large} = {sizes[large]:g}",
            )


def _solid(name: str, where: str = "") -> Solid:
    if name not in SOLIDS:
        raise unknown_name("solid", name, SOLIDS, where)
    return SOLIDS[name]


@lru_cache
def _about_origin(name: str) -> MassProperties:
    return properties(SOLIDS[name].region).of_mass(MASS)
