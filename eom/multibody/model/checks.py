"""What a description of bodies and joints must hold; every error names the part at fault."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from eom.errors import InputError, near_matches
from eom.multibody.algebra.scalars import is_zero, mul, sub, total
from eom.multibody.algebra.spatial import Matrix, Vector, product, transposed
from eom.multibody.algebra.values import Value, is_number

if TYPE_CHECKING:
    from eom.multibody.model.attachments import Rotor
    from eom.multibody.model.model import Joint, Tree

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
SLACK = Fraction(1, 10**9)
"""Of rounded inertias, relative to their size."""


def name(given: Any, where: str) -> None:
    """Raise `InputError` unless a name can be part of a symbol's."""
    if not isinstance(given, str) or not _NAME.fullmatch(given):
        raise InputError(
            "not a name", where=where, got=given, expected="a letter, then letters, digits and _"
        )


def central(J: Matrix, C: Matrix, mass: Value, centre: Vector, point: Vector) -> Matrix:
    """Return J, given about ``point`` in axes by C, about the centre of mass in the body's axes."""
    turned = product(transposed(C), product(J, C))
    d = [sub(p, c) for p, c in zip(point, centre, strict=True)]
    square = total(mul(x, x) for x in d)

    def entry(i: int, j: int) -> Value:
        steiner = sub(square if i == j else 0, mul(d[i], d[j]))
        return sub(turned[i][j], mul(mass, steiner))

    return tuple(tuple(entry(min(i, j), max(i, j)) for j in range(3)) for i in range(3))


def body(mass: Value, J: Matrix, where: str) -> None:
    """Raise `InputError` for a negative mass, or an inertia (about the centre) that no body has."""
    if (is_number(mass) and mass < 0) or getattr(mass, "is_negative", None) is True:
        raise InputError("mass is negative", where=where, got=mass, expected="at least 0 (kg)")
    if not all(is_number(x) for row in J for x in row):
        return
    half = Fraction(J[0][0] + J[1][1] + J[2][2]) / 2
    S = [[(half if i == j else 0) - J[i][j] for j in range(3)] for i in range(3)]
    size = max(abs(x) for row in J for x in row)
    if any(minor < -SLACK * size**order for order, minor in _minors(S)):
        raise InputError(
            "no body has this inertia about its centre of mass",
            where=where,
            got=[[float(x) for x in row] for row in J],
            expected="no principal moment above the sum of the others (triangle inequality)",
            hint="J12 = -integral of r1 r2 dm; check the signs, and the point that it is about",
        )
    if is_number(mass) and mass == 0 and size > 0:
        raise InputError("a body without mass has no inertia", where=where, got=float(size))


def _minors(S: Sequence[Sequence[Any]]) -> Iterable[tuple[int, Any]]:
    """Yield the principal minors with their orders: none is negative for second moments of mass."""
    for i in range(3):
        yield 1, S[i][i]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        yield 2, S[i][i] * S[j][j] - S[i][j] * S[j][i]
    cofactors = (S[1][1] * S[2][2] - S[1][2] * S[2][1],
                 S[1][2] * S[2][0] - S[1][0] * S[2][2],
                 S[1][0] * S[2][1] - S[1][1] * S[2][0])  # fmt: skip
    yield 3, sum(a * b for a, b in zip(S[0], cofactors, strict=True))


def joint(given: Joint) -> None:
    """Raise `InputError` for springs where no coordinate is, and motion that does not fit."""
    where = f"joint {given.name!r}"
    paired = given.row.paired(given.attitude)
    for k, (stiffness, coordinate) in enumerate(zip(given.stiffness, paired, strict=True)):
        if coordinate is None and not is_zero(stiffness):
            raise InputError(
                "a spring needs a coordinate whose rate is the speed",
                where=f"{where}: speed {given.speeds[k].name}",
                hint="use a load or an applied force",
            )
    if given.row.axes == 2:
        not_parallel(given.axis, given.second_axis, where)
    if given.motion is not None:
        _motion(given, where, paired)


def not_parallel(axis: Vector, other: Vector, where: str) -> None:
    """Raise `InputError` for two unit vectors along one line."""
    cosine = total(mul(a, b) for a, b in zip(axis, other, strict=True))
    if is_number(cosine) and abs(cosine) > 1 - SLACK:
        raise InputError("the two axes are parallel", where=where, got=float(cosine))


def _motion(given: Joint, where: str, paired: Sequence[int | None]) -> None:
    counts = [len(m) for m in (given.motion.position, given.motion.rate, given.motion.acceleration)]
    if None in paired or any(n != len(paired) for n in counts):
        raise InputError(
            "prescribed motion needs one expression a coordinate, each the integral of a speed",
            where=where,
            got=f"{counts[0]} for {given.kind}",
            expected=len(paired) if None not in paired else "a joint of one or two coordinates",
        )


def rotor(given: Rotor) -> None:
    """Raise `InputError` for a moment that is not positive, and for two ways to say how it spins."""
    where = f"rotor {given.name!r}"
    J = given.inertia
    if (is_number(J) and J <= 0) or getattr(J, "is_positive", None) is False:
        raise InputError("inertia is not positive", where=where, got=J, expected="kg m^2")
    driven = given.motor or given.angle or not (is_zero(given.torque) and is_zero(given.damping))
    if given.speed is not None and driven:
        raise InputError(
            "a given speed leaves no room for torque, damping, motor and angle", where=where
        )


def tree(given: Tree) -> None:
    """Raise `InputError` for what is no tree, naming the body or joint."""
    where = f"tree {given.name!r}"
    name(given.name, where)
    _once("body", [b.name for b in given.bodies], where)
    _once("joint", [j.name for j in given.joints], where)
    known = {b.name for b in given.bodies}
    if "ground" in known:
        raise InputError(
            "a body is called ground", where=where, hint="ground is what does not move"
        )
    for j in given.joints:
        for role, body_name, allowed in (
            ("parent", j.parent, known | {"ground"}),
            ("child", j.child, known),
        ):
            if body_name not in allowed:
                raise InputError(
                    f"unknown {role} {body_name!r}",
                    where=f"joint {j.name!r}",
                    hint=near_matches(body_name, allowed),
                )
    for load in given.loads:
        if load.body not in known:
            raise InputError(
                f"load on unknown body {load.body!r}",
                where=where,
                hint=near_matches(load.body, known),
            )
    _attached(given, known, where)
    _single_parents(given, where)
    ordered(given)
    _once("constraint", [c.name for c in given.constraints], where)
    for constraint in given.constraints:
        constraint.check(given)
    _massless(given)


def _attached(given: Tree, known: set[str], where: str) -> None:
    """Rotors and springs are on bodies that there are."""
    _once("rotor", [r.name for r in given.rotors], where)
    _once("spring", [s.name for s in given.springs], where)
    held = [("rotor", r.name, r.body, known) for r in given.rotors]
    held += [("spring", s.name, b, known | {"ground"}) for s in given.springs for b in s.bodies]
    for kind, own, body_name, allowed in held:
        if body_name not in allowed:
            raise InputError(
                f"{kind} on unknown body {body_name!r}",
                where=f"{kind} {own!r}",
                hint=near_matches(body_name, allowed),
            )
    for s in given.springs:
        if s.bodies[0] == s.bodies[1]:
            raise InputError(
                "both ends are on one body", where=f"spring {s.name!r}", got=s.bodies[0]
            )


def _once(kind: str, names: Sequence[str], where: str) -> None:
    repeated = sorted(n for n, count in Counter(names).items() if count > 1)
    if repeated:
        raise InputError(f"repeated name of a {kind}", where=where, got=", ".join(repeated))


def _single_parents(given: Tree, where: str) -> None:
    """Every body hangs on one joint."""
    leading: dict[str, list[str]] = {b.name: [] for b in given.bodies}
    for j in given.joints:
        leading[j.child].append(j.name)
    for child, names in leading.items():
        if not names:
            raise InputError(
                f"body {child!r} hangs on nothing",
                where=where,
                hint="a body that floats has a free joint to the ground",
            )
        if len(names) > 1:
            raise InputError(
                f"two joints lead to body {child!r}",
                where=where,
                got=", ".join(names),
                hint="a tree has no loops: cut one of them, and close it by a constraint (Loop)",
            )


def ordered(given: Tree) -> tuple[Joint, ...]:
    """Return the joints, each after that of its parent; raise `InputError` for a loop."""
    children: dict[str, list[Joint]] = {}
    for j in given.joints:
        children.setdefault(j.parent, []).append(j)
    found: list[Joint] = []
    stack = children.get("ground", [])[::-1]
    while stack:
        j = stack.pop()
        found.append(j)
        stack += children.get(j.child, [])[::-1]
    if len(found) < len(given.joints):
        reached = {j.name for j in found}
        lost = [j.name for j in given.joints if j.name not in reached]
        raise InputError(
            "joints that the ground does not lead to: they form a loop",
            where=f"tree {given.name!r}",
            got=", ".join(lost),
        )
    return tuple(found)


def _massless(given: Tree) -> None:
    """Raise `InputError` for a joint that moves freely and moves no mass, and is not bound to any."""
    found = moves_nothing(given, {b for c in given.constraints for b in c.bodies})
    if found is not None:
        raise InputError(
            "the joint moves no mass",
            where=f"joint {found.name!r}",
            got=f"body {found.child!r} of mass 0, and nothing heavy on it",
            hint="give it mass, or fix the joint",
        )


def moves_nothing(given: Tree, bound: Collection[str]) -> Joint | None:
    """Return a free joint that moves neither mass nor a body of ``bound``, if there is one."""
    heavy: dict[str, bool] = {}
    bodies = {b.name: b for b in given.bodies}
    children: dict[str, list[Joint]] = {}
    for j in given.joints:
        children.setdefault(j.parent, []).append(j)
    for j in reversed(ordered(given)):
        own = j.child in bound or not is_zero(bodies[j.child].mass)
        below = any(heavy[k.child] or _armed(k) for k in children.get(j.child, ()))
        heavy[j.child] = own or below
        if not heavy[j.child] and j.speeds and j.motion is None and not _armed(j):
            return j
    return None


def _armed(j: Joint) -> bool:
    return any(not is_zero(x) for x in j.armature)
