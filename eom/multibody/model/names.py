"""The names of a tree: what has one before a derivation, what its symbols are, what must hold of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.kinematics.coordinates import rotation_sequence
from eom.mass.inertia import physical
from eom.multibody.algebra.values import is_number
from eom.multibody.model.bodies import Body
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Tree
from eom.quantities import TIME, Assumption, Quantity, Singularity
from eom.structure import COUNTS
from eom.system import BodyAttitude, Expr


def states_of(tree: Tree, dependent: Iterable[int] = ()) -> tuple[Quantity, ...]:
    """Return coordinates and speeds that are free, without those that follow."""
    free = [j for j in tree.ordered if j.motion is None]
    speeds = [s for j in tree.ordered for s in j.speeds]
    followed = {speeds[k] for k in dependent}
    kept = (s for j in free for s in j.speeds if s not in followed)
    rotors = (s for r in tree.rotors for s in r.states)
    return (*(c for j in free for c in j.coordinates), *kept, *rotors)


def attitudes_of(tree: Tree, states: Iterable[Quantity]) -> tuple[BodyAttitude, ...]:
    """Return the attitudes of bodies on their parents, whose coordinates and speeds are ``states``."""
    moving = {q.symbol for q in states}
    found = []
    for joint in tree.ordered:
        if not joint.row.attitude:
            continue
        count = COUNTS.get(joint.attitude, 3)
        turned = tuple(c.symbol for c in joint.coordinates[-count:])
        omega = tuple(s.symbol for s in joint.speeds[:3])
        if {*turned, *omega} <= moving:
            a, b, c = omega
            found.append(BodyAttitude((a, b, c), joint.attitude, turned, body=joint.child))
    return tuple(found)


def inputs_of(tree: Tree) -> tuple[Quantity, ...]:
    """Return motors and given inputs."""
    motors = [m for j in tree.ordered for m in j.motors if j.motion is None]
    return (*motors, *(m for r in tree.rotors for m in r.motors), *tree.inputs)


def named_of(tree: Tree) -> list[Quantity]:
    """Return everything that has a name before the derivation."""
    symbols = [Quantity(s) for s in symbols_of(tree)]
    driven = [q for j in tree.ordered if j.motion is not None for q in (*j.coordinates, *j.speeds)]
    return [*states_of(tree), *inputs_of(tree), *driven, *symbols, Quantity(TIME)]


def symbols_of(tree: Tree) -> list[Expr]:
    """Return the free symbols of a description, by name."""
    return symbols_in([*values_of(tree), *(x for c in tree.constraints for x in c.values)])


def symbols_in(values: Iterable[Any]) -> list[Expr]:
    """Return the free symbols of some values, by name."""
    found: set[Expr] = set()
    for given in values:
        if not is_number(given):
            found |= given.free_symbols
    return sorted(found, key=lambda s: str(s.name))


def values_of(tree: Tree) -> Iterable[Any]:
    """Yield every value of a description."""
    yield from tree.gravity
    yield from (x for row in tree.gravity_gradient for x in row)
    for part in (*tree.bodies, *tree.joints, *tree.loads, *tree.springs, *tree.rotors, *tree.jets):
        yield from part.values


def parameters_of(tree: Tree) -> tuple[Quantity, ...]:
    """Return the symbols that are nothing else, as they are described."""
    moving = [q for j in tree.ordered for q in (*j.coordinates, *j.speeds)]
    moving += [s for r in tree.rotors for s in r.states]
    other = {q.symbol for q in (*moving, *inputs_of(tree))} | {TIME}
    described = {p.symbol: p for p in tree.parameters}
    return tuple(described.get(s, Quantity(s)) for s in symbols_of(tree) if s not in other)


def singularities_of(tree: Tree) -> tuple[Singularity, ...]:
    """Return where the angles of sequences fail, and where bodies that lose mass have none left."""
    found: list[Singularity] = [s for body in tree.bodies for s in _used_up(body)]
    for joint in tree.ordered:
        if joint.row.attitude and joint.attitude != QUATERNION and joint.motion is None:
            angles = [c.symbol for c in joint.coordinates[-3:]]
            way = f'attitude = "quaternion" and angles = "{joint.attitude}" of joint {joint.name}'
            singular = rotation_sequence(joint.attitude, angles).singularities
            found += [replace(s, hint=f"{way} go through it") for s in singular]
    return tuple(found)


def _used_up(body: Body) -> Iterable[Singularity]:
    """Yield where mass or moments of inertia of a body that change in time are zero."""
    J = body.central_inertia
    sizes = [("mass", body.mass), *((f"moment of inertia {k + 1}", J[k][k]) for k in range(3))]
    for what, size in sizes:
        if TIME in getattr(size, "free_symbols", ()):
            meaning = f"{what} of body {body.name} is used up"
            yield Singularity(size, TIME, meaning, "end the run before")


_SLACK = 1e-12
"""Of conditions on moments, relative to the largest of the values that they are made of."""


def assumptions(tree: Tree) -> tuple[Assumption, ...]:
    """Return that masses are not negative, and that moments of inertia obey the triangle inequality.

    What changes in time is tested where a run starts.

    One for each body, and each rotor, of which parameters decide that; numbers were tested when the tree
    was made. A guard tests them on values (`codegen.frontend.structure`), those of ensembles, too.
    """
    found = [a for body in tree.bodies for a in _of_body(body)]
    for rotor in tree.rotors:
        found += _not_negative(rotor.inertia, f"rotor {rotor.name}", "inertia")
    for constraint in tree.constraints:
        for word in ("radius", "length"):
            size = getattr(constraint, word, 1)
            found += _not_negative(size, f"constraint {constraint.name}", word)
    return tuple(found)


def _not_negative(given: Any, where: str, what: str) -> list[Assumption]:
    if is_number(given) or not isinstance(given, sp.Expr):
        return []
    meaning = f"{what} of {where} is not negative"
    return [Assumption(f"{what}_not_negative", meaning, nonnegative=(given,), tolerance=0.0)]


def _of_body(body: Body) -> list[Assumption]:
    found = _not_negative(body.mass, f"body {body.name}", "mass")
    J = body.central_inertia
    if all(is_number(x) for row in J for x in row):
        return found
    inertia = sp.ImmutableMatrix([[sp.sympify(x, strict=True) for x in row] for row in J])
    allowed = physical(inertia).nonnegative
    meaning = (
        f"no moment of inertia of body {body.name} about its centre of mass exceeds the sum of the "
        "other two (triangle inequality)"
    )
    return [
        *found,
        Assumption("physical_inertia", meaning, nonnegative=allowed, tolerance=_SLACK),
    ]
