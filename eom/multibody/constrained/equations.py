"""The scalar equations of constraints: a table from each kind to its relations.

Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), sec. 9.4, has the joints as
products of directions; wheels: see `eom.multibody.constrained.relations`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from eom.multibody.algebra.scalars import (
    Dual,
    DualWork,
    Scalar,
    add,
    is_zero,
    mul,
    parts,
    reciprocal,
    sub,
    total,
)
from eom.multibody.algebra.spatial import (
    IDENTITY,
    Vector,
    cross,
    dot,
    keep_vector,
    times,
    transposed,
)
from eom.multibody.algebra.values import is_number, unit
from eom.multibody.constrained.relations import (
    Apart,
    Contact,
    Edge,
    PointKinematics,
    Relation,
    Rod,
    Roll,
    Scene,
    Square,
    Sum,
)
from eom.multibody.model.constraints import (
    Coupling,
    Distance,
    Equation,
    KnifeEdge,
    Loop,
    Rolling,
    SpeedEquation,
)
from eom.multibody.model.model import Constraint, Tree
from eom.multibody.recursion.motion import coordinate_rates
from eom.quantities import TIME


@dataclass(frozen=True)
class Component:
    """One scalar equation: its constraint, the letter of its multiplier, what that is, the relation."""

    constraint: str
    letter: str
    unit: str
    meaning: str
    relation: Relation

    @property
    def name(self) -> str:
        """How reports name it."""
        return f"{self.constraint!r}{' ' * bool(self.letter)}{self.letter}"


def components(tree: Tree, scene: Scene) -> list[Component]:
    """Return the equations of all constraints, in order; drifts need a scene with speeds."""
    return [row for c in tree.constraints for row in _ROWS[type(c)](c, tree, scene)]


Rows = Iterable[Component]


def _force(name: str, letter: str, what: str, relation: Relation) -> Component:
    return Component(name, letter, "N", f"force of {name} {what}", relation)


def _torque(name: str, letter: str, what: str, relation: Relation) -> Component:
    return Component(name, letter, "N m", f"torque of {name} {what}", relation)


# --- loops -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Cut:
    """A cut joint: its frames on both bodies, and a triad (a, b, c) of its axis, in the joint."""

    loop: Loop
    scene: Scene
    first: PointKinematics
    second: PointKinematics
    triad: tuple[Vector, Vector, Vector]

    def on_first(self, axis: Vector) -> Vector:
        return self._carried(axis, self.first, self.loop.on_first.rotation)

    def on_second(self, axis: Vector) -> Vector:
        return self._carried(axis, self.second, self.loop.on_second.rotation)

    def _carried(self, axis: Vector, spot: PointKinematics, rotation: Any) -> Vector:
        C = [self.scene.vector(row) for row in rotation]
        found = spot.direction(times(transposed(C), axis))
        return keep_vector(self.scene.work, "direction", self.loop.name, found)


def _loop(loop: Loop, tree: Tree, scene: Scene) -> Rows:  # noqa: ARG001
    first = scene.spot(loop.first, loop.on_first.position)
    second = scene.spot(loop.second, loop.on_second.position)
    axis = loop.axis if loop.row.axes else (0, 0, 1)
    cut = _Cut(loop, scene, first, second, _triad(scene, axis))
    for closed in CLOSED[loop.kind]:
        yield from closed(cut)


def _triad(scene: Scene, axis: Any) -> tuple[Vector, Vector, Vector]:
    """Return a unit vector and two across it: exact along a coordinate axis."""
    a = scene.vector(axis)
    along = [k for k in range(3) if not is_zero(axis[k])]
    if len(along) == 1:
        k = along[0]
        return a, IDENTITY[(k + 1) % 3], IDENTITY[(k + 2) % 3]
    if is_number(axis[0]) and is_number(axis[1]) and is_number(axis[2]):
        least = min(range(3), key=lambda k: abs(axis[k]))
        b: Any = unit(cross(axis, IDENTITY[least]), "axis")
    else:
        least = next(k for k in range(3) if k not in along)
        b = IDENTITY[least]
    b = scene.vector(b)
    return a, b, cross(a, b)


def _together(cut: _Cut) -> Rows:
    """The two origins coincide: along the axes of the ground."""
    ground = cut.scene.ground()
    for letter, e in zip("xyz", IDENTITY, strict=True):
        relation = Apart(e, ground, cut.first, cut.second)
        yield _force(
            cut.loop.name, letter, f"on {cut.loop.second}, along {letter} of the ground", relation
        )


def _across(cut: _Cut) -> Rows:
    """The second origin stays on the axis of the first."""
    for letter, e in zip("12", cut.triad[1:], strict=True):
        relation = Apart(cut.on_first(e), cut.first, cut.first, cut.second)
        yield _force(cut.loop.name, letter, f"on {cut.loop.second}, across its axis", relation)


def _level(cut: _Cut) -> Rows:
    """The second origin stays in the plane of the first."""
    relation = Apart(cut.on_first(IDENTITY[2]), cut.first, cut.first, cut.second)
    yield _force(cut.loop.name, "n", f"on {cut.loop.second}, along the normal", relation)


def _parallel(cut: _Cut) -> Rows:
    """The axis of the second stays parallel to that of the first."""
    a, b, c = cut.triad
    for letter, e in zip(("t1", "t2"), (b, c), strict=True):
        alike = cut.on_first(a), cut.on_second(a)
        relation = Square(cut.on_first(e), cut.first, alike[1], cut.second, alike=alike)
        yield _torque(cut.loop.name, letter, f"on {cut.loop.second}, across its axis", relation)


def _locked(cut: _Cut) -> Rows:
    """No turn about the axis either."""
    _, b, c = cut.triad
    alike = cut.on_first(b), cut.on_second(b)
    relation = Square(cut.on_first(c), cut.first, alike[1], cut.second, alike=alike)
    yield _torque(cut.loop.name, "t3", f"on {cut.loop.second}, about its axis", relation)


def _crossed(cut: _Cut) -> Rows:
    """The two axes of a universal joint keep their angle."""
    first, second = (cut.scene.vector(a) for a in (cut.loop.axis, cut.loop.second_axis))
    relation = Square(
        cut.on_first(first), cut.first, cut.on_second(second), cut.second, dot(first, second)
    )
    yield _torque(cut.loop.name, "t", f"on {cut.loop.second}, across both axes", relation)


CLOSED: dict[str, tuple[Callable[[_Cut], Rows], ...]] = {
    "spherical": (_together,),
    "revolute": (_together, _parallel),
    "universal": (_together, _crossed),
    "cylindrical": (_across, _parallel),
    "prismatic": (_across, _parallel, _locked),
    "planar": (_level, _parallel),
    "fixed": (_together, _parallel, _locked),
}
"""What each kind of joint takes away."""


# --- rods, wheels, knife edges ----------------------------------------------------------------------


def _distance(rod: Distance, tree: Tree, scene: Scene) -> Rows:  # noqa: ARG001
    first, second = (
        scene.spot(body, point)
        for body, point in ((rod.first, rod.first_point), (rod.second, rod.second_point))
    )
    length = scene.arithmetic.lift(rod.length)
    inverse = scene.work.keep("inverse_length", rod.name, "", reciprocal(length))
    what = f"on {rod.second}, away from {rod.first}"
    yield _force(rod.name, "", what, Rod(first, second, length, inverse))


def _rolling(wheel: Rolling, tree: Tree, scene: Scene) -> Rows:  # noqa: ARG001
    contact = _contact(wheel, scene)
    n = contact.normal
    t1, t2 = (scene.vector(t) for t in plane_directions(wheel.normal))
    height = dot(n, scene.vector(wheel.origin))
    plain = wheel.normal == (0, 0, 1)
    letters = "xyz" if plain else ("t1", "t2", "n")
    texts = [f"on {wheel.body} along {x} of the ground" for x in "xyz"]
    if not plain:
        texts = [f"on {wheel.body} {x}" for x in ("in the plane", "in the plane", "by the plane")]
    for letter, text, t, level in zip(
        letters, texts, (t1, t2, n), (None, None, height), strict=True
    ):
        yield _force(wheel.name, letter, text, Roll(contact, t, level))


def _contact(wheel: Rolling, scene: Scene) -> Contact:
    centre = scene.spot(wheel.body, wheel.centre)
    radius, n = scene.arithmetic.lift(wheel.radius), scene.vector(wheel.normal)
    if wheel.axis is None:
        return Contact(centre, radius, n, n, None)
    work = scene.work
    a = centre.direction(scene.vector(wheel.axis))
    a = keep_vector(work, "direction", wheel.name, a)
    inverse = reciprocal(scene.arithmetic.sqrt(sine_square(wheel, scene)))
    inverse = work.keep("lean_inverse", wheel.name, "", inverse)
    return Contact(centre, radius, n, a, inverse, oblateness(wheel, scene))


def oblateness(wheel: Rolling, scene: Scene) -> Scalar:
    """Return 1 - (half axis / radius)^2: 1 of a wheel, below zero where the body is longer than thick."""
    if is_zero(wheel.half_axis):
        return 1
    lift = scene.arithmetic.lift
    share = mul(lift(wheel.half_axis), reciprocal(lift(wheel.radius)))
    return scene.work.keep("oblateness", wheel.name, "", sub(1, mul(share, share)))


def sine_square(wheel: Rolling, scene: Scene) -> Scalar:
    """Return 1 - w (n . a)^2 (`Contact`), which is zero where a wheel lies flat."""
    centre = scene.spot(wheel.body, wheel.centre)
    a = centre.direction(scene.vector(wheel.axis))
    m = scene.work.keep("lean", wheel.name, "", dot(scene.vector(wheel.normal), a))
    return sub(1, mul(oblateness(wheel, scene), mul(m, m)))


def plane_directions(normal: Any) -> tuple[Any, Any]:
    """Return two directions that make a right-handed triad with a unit normal: x, y for z."""
    if all(map(is_zero, normal[:2])):
        return (1, 0, 0), (0, 1, 0) if normal[2] == 1 else (0, -1, 0)
    across = [k for k in range(3) if is_zero(normal[k])]
    if across:
        second = IDENTITY[across[-1]]
        return tuple(cross(second, normal)), second
    first = unit(cross((0, 1, 0), normal), "normal")
    return first, unit(cross(normal, first), "normal")


def _knife_edge(edge: KnifeEdge, tree: Tree, scene: Scene) -> Rows:  # noqa: ARG001
    spot = scene.spot(edge.body, edge.point)
    e = keep_vector(
        scene.work, "direction", edge.name, spot.direction(scene.vector(edge.direction))
    )
    yield _force(edge.name, "", f"on {edge.body}, across the edge", Edge(e, spot))


# --- equations of the user ---------------------------------------------------------------------------


def _coupling(gear: Coupling, tree: Tree, scene: Scene) -> Rows:
    numbers = {j.name: s.start for j, _, s in _numbered(tree)}
    lift = scene.arithmetic.lift
    row = {numbers[name]: lift(ratio) for name, ratio in gear.ratios}
    relation = Sum(None, dict(sorted(row.items())), 0, 0)
    yield Component(gear.name, "", "", f"generalised force of the coupling {gear.name}", relation)


def _numbered(tree: Tree) -> Iterable[tuple[Any, slice, slice]]:
    """Yield each joint with the places of its coordinates and speeds."""
    first = start = 0
    for joint in tree.ordered:
        c, s = len(joint.coordinates), len(joint.speeds)
        yield joint, slice(first, first + c), slice(start, start + s)
        first, start = first + c, start + s


def _symbols(tree: Tree, quantities: str) -> list[Any]:
    return [x.symbol for j in tree.ordered for x in getattr(j, quantities)]


def _equation(given: Equation, tree: Tree, scene: Scene) -> Rows:
    """The rate of phi is the sum of phi_q N u, plus phi_t."""
    coordinates = _symbols(tree, "coordinates")
    lift = scene.arithmetic.lift
    slopes = {k: sp.diff(given.expression, c) for k, c in enumerate(coordinates)
              if given.expression.has(c)}  # fmt: skip
    gradient = {k: lift(_plain(e)) for k, e in slopes.items()}
    rate = sp.diff(given.expression, TIME)
    relation = Sum(
        lift(given.expression),
        _over_speeds(gradient, scene),
        lift(_plain(rate)),
        None if scene.u is None else _bend([*slopes.items()], rate, gradient, coordinates, scene),
    )
    yield Component(given.name, "", "", f"multiplier of the equation {given.name}", relation)


def _plain(e: Any) -> Any:
    """Return whole and rational numbers as plain ones."""
    return (
        Fraction(int(e.p), int(e.q))
        if e.is_Rational and not e.is_Integer
        else (int(e) if e.is_Integer else e)
    )


def _over_speeds(gradient: dict[int, Scalar], scene: Scene) -> dict[int, Scalar]:
    """Return the coefficients of speeds in gradient . N u, by one unit speed after the other."""
    found: dict[int, Scalar] = {}
    for part in scene.lumped.parts:
        mine = range(part.coordinates.start, part.coordinates.stop)
        if not any(k in gradient for k in mine):
            continue
        own = scene.q[part.coordinates]
        place = part.kind.place(part.setting, own, scene.work)
        for n, s in enumerate(range(part.speeds.start, part.speeds.stop)):
            units = [int(n == k) for k in range(part.speeds.stop - part.speeds.start)]
            rates = part.kind.rates(part.setting, own, units, place)
            found[s] = total(
                mul(gradient[k], x) for k, x in zip(mine, rates, strict=True) if k in gradient
            )
    return found


def _bend(
    slopes: Sequence[tuple[int, Any]],
    rate: Any,
    gradient: dict[int, Scalar],
    coordinates: Sequence[Any],
    scene: Scene,
) -> Scalar:
    """Return phi'' without u': gradient . N' u + q'^T phi_qq q' + 2 phi_qt q' + phi_tt."""
    lift, u = scene.arithmetic.lift, scene.u
    assert u is not None
    moving = coordinate_rates(scene.lumped, scene.q, u, scene.work)
    found: Scalar = lift(_plain(sp.diff(rate, TIME)))
    for k, drift in _map_drifts(scene, moving, {k for k, _ in slopes}):
        found = add(found, mul(gradient[k], drift))
    for k, slope in slopes:
        found = add(found, mul(mul(2, lift(_plain(sp.diff(slope, TIME)))), moving[k]))
        for n, c in enumerate(coordinates):
            if slope.has(c):
                second = lift(_plain(sp.diff(slope, c)))
                found = add(found, mul(second, mul(moving[k], moving[n])))
    return found


def _map_drifts(
    scene: Scene, moving: Sequence[Scalar], wanted: set[int]
) -> Iterable[tuple[int, Scalar]]:
    """Yield N' u of the wanted coordinates, by numbers that carry their rates."""
    work = DualWork(scene.work)
    assert scene.u is not None
    for part in scene.lumped.parts:
        mine = range(part.coordinates.start, part.coordinates.stop)
        if wanted.isdisjoint(mine):
            continue
        own = [Dual(scene.q[k], moving[k]) for k in mine]
        place = part.kind.place(part.setting, own, work)
        rates = part.kind.rates(part.setting, own, scene.u[part.speeds], place)
        yield from ((k, parts(x)[1]) for k, x in zip(mine, rates, strict=True) if k in wanted)


def _speed_equation(given: SpeedEquation, tree: Tree, scene: Scene) -> Rows:
    speeds, lift = _symbols(tree, "speeds"), scene.arithmetic.lift
    slopes = {k: sp.diff(given.expression, u) for k, u in enumerate(speeds)
              if given.expression.has(u)}  # fmt: skip
    rest = given.expression.xreplace(dict.fromkeys(speeds, sp.Integer(0)))
    relation = Sum(
        None,
        {k: lift(_plain(e)) for k, e in slopes.items()},
        lift(_plain(rest)),
        None if scene.u is None else _along(given.expression, tree, scene),
    )
    yield Component(given.name, "", "", f"multiplier of the equation {given.name}", relation)


def _along(expression: Any, tree: Tree, scene: Scene) -> Scalar:
    """Return the rate of an expression with the speeds held."""
    lift, u = scene.arithmetic.lift, scene.u
    assert u is not None
    moving = coordinate_rates(scene.lumped, scene.q, u, scene.work)
    found: Scalar = lift(_plain(sp.diff(expression, TIME)))
    for k, c in enumerate(_symbols(tree, "coordinates")):
        if expression.has(c):
            found = add(found, mul(lift(_plain(sp.diff(expression, c))), moving[k]))
    return found


_ROWS: dict[type[Constraint], Callable[[Any, Tree, Scene], Rows]] = {
    Loop: _loop,
    Distance: _distance,
    Rolling: _rolling,
    KnifeEdge: _knife_edge,
    Coupling: _coupling,
    Equation: _equation,
    SpeedEquation: _speed_equation,
}
"""The relations of each kind of constraint."""
