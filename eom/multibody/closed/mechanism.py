"""A tree over polynomials: links with their geometry, the speeds, and how symbols change in time.

Shared by the three methods: the description of the tree and the table of joints, nothing that a
method derives. Every body is a link of its own; a link's vectors are in the axes of its joint's frame F,
from the origin of F. Rotations take components before to components after.

Coordinates in place of those of the joints: which they may be, and what their rates are called.

What closed forms and SymPy's mechanics take from a description; whatever else it says is refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError, near_matches
from eom.multibody.algebra.scalars import is_zero, negative
from eom.multibody.algebra.spatial import (
    IDENTITY,
    ZERO,
    Matrix,
    SpatialVector,
    Vector,
    matrix_of,
    plus,
    product,
    times,
    transposed,
)
from eom.multibody.algebra.values import is_number
from eom.multibody.closed.polynomials import Algebra, Polynomial, Scalar
from eom.multibody.model.attachments import Load
from eom.multibody.model.bodies import GROUND, Body, Joint, Placement
from eom.multibody.model.joints import QUATERNION, Setting
from eom.multibody.model.model import Tree
from eom.quantities import TIME, Quantity
from eom.system import as_expression

Expr = Any

MOST = 12
"""Speeds beyond which nobody reads a closed form."""


@dataclass(frozen=True)
class Link:
    """A body and the joint that leads to it.

    ``position``: of the origin of F, in the parent's axes, from the parent's origin; ``rotation`` from
    the parent's axes. ``subspace``: what each speed of the joint adds to the motion of F. ``inertia``:
    about the centre of mass. ``seat``: rotation from F to the body's axes; ``origin``: of the body.
    """

    name: str
    joint: Joint
    parent: int
    position: Vector
    rotation: Matrix
    subspace: tuple[SpatialVector, ...]
    mass: Scalar
    centre: Vector
    inertia: Matrix
    seat: Matrix
    origin: Vector
    start: int

    @property
    def speeds(self) -> range:
        """The numbers of its joint's speeds among those of all joints."""
        return range(self.start, self.start + len(self.joint.speeds))

    def point(self, position: Vector) -> Vector:
        """Return a point of the body (from its origin, in its axes) from the origin of F."""
        return plus(self.origin, times(transposed(self.seat), position))


@dataclass(frozen=True)
class Pull:
    """A load in scalars: ``point`` from the origin of F, in its axes."""

    link: int
    force: Vector
    torque: Vector
    point: Vector
    grounded: bool


@dataclass(frozen=True)
class Mechanism:
    """Links, and symbols with their rates.

    ``speeds``: of all joints, in order; ``free``: those that have equations, ``forced``: those that
    are prescribed. ``accelerations``: their derivatives. ``joint_speeds``: each joint's own speed over
    ``speeds``; the same unless other coordinates were chosen. ``basis``: for each speed, how fast it
    moves the coordinates. ``coordinates``: joint's coordinates over the chosen ones.
    """

    tree: Tree
    algebra: Algebra
    links: tuple[Link, ...]
    coordinates: tuple[Scalar, ...]
    variables: tuple[Quantity, ...]
    speeds: tuple[Quantity, ...]
    accelerations: tuple[Expr, ...]
    free: tuple[int, ...]
    basis: tuple[Mapping[Expr, Scalar], ...]
    joint_speeds: tuple[Scalar, ...]
    gravity: Vector
    pulls: tuple[Pull, ...]
    offsets: Mapping[Expr, Scalar] = field(default_factory=lambda: {TIME: 1})
    """What changes without speeds: time, and coordinates that constraints move."""
    even: frozenset[int] = frozenset()
    """Prescribed speeds that are constant."""
    followers: Mapping[int, Scalar] = field(default_factory=dict)
    """Generators that are speeds which follow others, or are not chosen, over those."""
    named: frozenset[Expr] = frozenset()
    """Speeds whose names were chosen."""

    @cached_property
    def rates(self) -> dict[Expr, Scalar]:
        """How each coordinate and each speed changes in time."""
        found: dict[Expr, Scalar] = dict(self.offsets)
        for u, column in zip(self.speeds, self.basis, strict=True):
            speed = self.algebra.atom(u.symbol)
            for q, rate in column.items():
                found[q] = found.get(q, 0) + speed * rate
        for k, (u, a) in enumerate(zip(self.speeds, self.accelerations, strict=True)):
            found[u.symbol] = 0 if k in self.even else self.algebra.atom(a)
        return found

    def lift(self, x: Any) -> Scalar:
        """Return a value of the description, speeds that follow others over those."""
        return followed(self.algebra, self.algebra.lift(x), self.followers)

    @property
    def forced(self) -> tuple[int, ...]:
        """The numbers of the prescribed speeds that are no constants."""
        return tuple(k for k in range(len(self.speeds)) if k not in self.free)

    def rate(self, x: Scalar) -> Scalar:
        """Return the derivative in time."""
        return self.algebra.along(x, self.rates)

    def rate_of(self, v: Vector) -> Vector:
        """Return the derivatives of components in time."""
        return [self.rate(x) for x in v]

    @property
    def frozen(self) -> dict[int, Scalar]:
        """Generators of coordinates that move and are looked at in one place, with their values there."""
        places = {
            self.algebra.named(c.symbol): self.algebra.lift(joint.motion.position[k])
            for joint in self.tree.ordered
            if joint.motion is not None
            for k, c in enumerate(joint.coordinates)
            if is_number(joint.motion.position[k]) and not locked(joint, k)
        }
        found = {}
        for g, e in enumerate(list(self.algebra.generators)):
            used = e.free_symbols & places.keys()
            if used:
                put = e.xreplace({q: as_expression(places[q]) for q in used})
                found[g] = self.algebra.lift(put)
        return found

    def in_place(self, x: Scalar) -> Scalar:
        """Return a scalar where coordinates are that are looked at in one place."""
        return self.algebra.replaced(x, self.frozen)

    @cached_property
    def _numbers(self) -> dict[int, int]:
        return {self.algebra.index(u.symbol): k for k, u in enumerate(self.speeds)}

    def part(self, x: Scalar, speed: int) -> Scalar:
        """Return the derivative of ``x`` by a speed."""
        index = self.algebra.index(self.speeds[speed].symbol)
        return x.partial(index) if isinstance(x, Polynomial) else 0

    def part_of(self, v: Vector, speed: int) -> Vector:
        """Return the derivatives of components by a speed."""
        return [self.part(x, speed) for x in v]

    def own(self, link: Link) -> list[Scalar]:
        """Return the speeds of a link's joint over the chosen speeds."""
        return [self.joint_speeds[k] for k in link.speeds]

    def rotors(self) -> list[tuple[Link, Scalar, Scalar]]:
        """Return joint speeds that move a rotor: link, inertia, speed."""
        return [
            (link, self.algebra.lift(J), u)
            for link in self.links
            for J, u in zip(link.joint.armature, self.own(link), strict=True)
            if not is_zero(J) and not is_zero(u)
        ]

    @cached_property
    def rotations(self) -> list[Matrix]:
        """From the ground's axes to those of each link."""
        found: list[Matrix] = []
        for link in self.links:
            before = found[link.parent] if link.parent >= 0 else IDENTITY
            found.append(product(link.rotation, before))
        return found

    def in_joints(self) -> Iterator[tuple[Joint, int, str, Scalar]]:
        """Yield joint, number of its speed, source and value: pulls of springs and dampers, and forces.

        Springs and dampers resist, so that their values stand beside those of inertia.
        """
        start, lift = 0, self.lift
        for link in self.links:
            joint = link.joint
            paired = joint.row.paired(joint.attitude)
            for k, s in enumerate(link.speeds):
                c = paired[k]
                if c is not None:
                    stretch = self.coordinates[start + c] - lift(joint.rest[k])
                    yield joint, s, "spring", lift(joint.stiffness[k]) * stretch
                yield joint, s, "damper", lift(joint.damping[k]) * self.joint_speeds[s]
                motor = self.algebra.atom(joint.motors[k].symbol) if joint.motors else 0
                yield joint, s, "applied", motor + lift(joint.force[k])
            start += len(joint.coordinates)

    def pull_of(self, pull: Pull) -> tuple[Vector, Vector]:
        """Return force and torque of a load in the axes of its link."""
        if not pull.grounded:
            return pull.force, pull.torque
        C = self.rotations[pull.link]
        return times(C, pull.force), times(C, pull.torque)

    def moves(self, k: int, link: int) -> bool:
        """Return whether link ``k`` is carried by, or is, the link."""
        while k >= 0 and k != link:
            k = self.links[k].parent
        return k == link


class Trigonometry:
    """Sines and cosines in an algebra; nothing gets a name."""

    def __init__(self, algebra: Algebra) -> None:
        self.algebra = algebra

    def sin(self, x: Scalar) -> Scalar:
        """Return the sine."""
        return self.algebra.turned(x)[0] if isinstance(x, Polynomial) else self._number(sp.sin, x)

    def cos(self, x: Scalar) -> Scalar:
        """Return the cosine."""
        return self.algebra.turned(x)[1] if isinstance(x, Polynomial) else self._number(sp.cos, x)

    def sqrt(self, x: Scalar) -> Scalar:
        """Raise `InputError`: nothing here has a length."""
        raise InputError("closed forms hold no lengths of springs", got=str(x))

    def _number(self, function: Any, x: Scalar) -> Scalar:
        return self.algebra.lift(function(as_expression(x)))

    def keep(self, letter: str, part: str, suffix: str, value: Scalar) -> Scalar:  # noqa: ARG002
        """Return the value: nothing gets a name."""
        return value


def mechanism(
    tree: Tree,
    coordinates: Mapping[Expr, Expr] | None = None,
    names: Mapping[Expr, Expr] | None = None,
    rates: bool = False,
) -> Mechanism:
    """Return a tree over polynomials, its constraints left aside.

    ``coordinates``: other coordinates, for each coordinate that is replaced an expression over the
    new ones. ``names``: symbols in place of those of coordinates and speeds. ``rates``: whether every
    speed is to be the rate of a coordinate, where angles allow it. Raises `InputError` for
    systems with too many speeds, coordinates that do not fit, and whatever the tree says beyond
    `eom.multibody.closed.mechanism.KNOWN` and constraints.
    """
    refuse_unknown(tree, "a closed form", frozenset({"constraints"}))
    builder = _Building(tree, dict(coordinates or {}), dict(names or {}), rates)
    links = tuple(builder.link(joint) for joint in tree.ordered)
    return builder.finish(links)


class _Building:
    def __init__(
        self, tree: Tree, chosen: dict[Expr, Expr], names: dict[Expr, Expr], rates: bool
    ) -> None:
        self.tree, self.in_rates = tree, rates
        self.own_names = frozenset(names.values())
        self.algebra = Algebra(f"tree {tree.name!r}", _with_rates(tree, names))
        self.work = Trigonometry(self.algebra)
        self.chosen = {k: as_expression(e) for k, e in chosen.items()}
        self.new = new_coordinates(tree, self.chosen)
        self.seats = {GROUND: -1}
        self.done: list[Link] = []
        self.coordinates: list[Scalar] = []
        self.joint_speeds: list[Scalar] = []
        self.speeds: list[Quantity] = []
        self.accelerations: list[Expr] = []
        self.free: list[int] = []
        self.basis: list[dict[Expr, Scalar]] = []
        self.followers: dict[int, Scalar] = {}
        self.even: list[int] = []
        self._new_speeds()

    def named(self, q: Quantity) -> Quantity:
        """Return a quantity with the name that was chosen."""
        return replace(q, symbol=self.algebra.named(q.symbol))

    def _new_speeds(self) -> None:
        for q in self.new:
            self._speed(q_dot(q), True, {q.symbol: 1})

    def _speed(self, u: Quantity, free: bool, moved: dict[Expr, Scalar]) -> None:
        if free:
            self.free.append(len(self.speeds))
        if len(self.free) > MOST:
            raise InputError(
                "too many speeds for a closed form that can be read",
                where=f"tree {self.tree.name!r}",
                expected=f"at most {MOST}",
                hint="derive(tree) has no such limit",
            )
        u = self.named(u)
        self.speeds.append(u)
        self.accelerations.append(sp.Symbol(dotted(u.name), real=True))
        self.basis.append({self.algebra.named(q): x for q, x in moved.items()})

    def vector(self, v: Vector) -> Vector:
        return [self.algebra.lift(x) for x in v]

    def matrix(self, A: Matrix) -> Matrix:
        return [self.vector(row) for row in A]

    def link(self, joint: Joint) -> Link:
        """Return the link that a joint leads to."""
        parent = self.seats[joint.parent]
        before, origin = (
            (self.done[parent].seat, self.done[parent].origin) if parent >= 0 else (IDENTITY, ZERO)
        )
        q, start = self._coordinates(joint), len(self.joint_speeds)
        setting = Setting(
            joint.name,
            tuple(tuple(self.vector(a)) for a in joint.axes),
            self.algebra.lift(joint.pitch),
            joint.attitude,
        )
        local = joint.row.place(setting, q, self.work)
        self._speeds(joint, setting, q, local)
        to_joint = product(self.matrix(joint.on_parent.rotation), before)
        arm = plus(origin, times(transposed(before), self.vector(joint.on_parent.position)))
        moved = times(transposed(to_joint), local.position)
        F = self.matrix(joint.on_child.rotation)
        made = Link(
            name=joint.child,
            joint=joint,
            parent=parent,
            position=plus(arm, moved),
            rotation=product(matrix_of(local.rotation), to_joint),
            subspace=local.subspace,
            start=start,
            **self._weight(joint, F),
        )
        self.seats[joint.child] = len(self.done)
        self.done.append(made)
        return made

    def _weight(self, joint: Joint, F: Matrix) -> dict[str, Any]:
        """Return the mass properties of a body in the axes of its joint, and where the body is there."""
        body = self.tree.body[joint.child]
        origin = [negative(x) for x in times(F, self.vector(joint.on_child.position))]
        return {
            "mass": self.algebra.lift(body.mass),
            "centre": plus(origin, times(F, self.vector(body.centre))),
            "inertia": product(F, product(self.matrix(body.central_inertia), transposed(F))),
            "seat": transposed(F),
            "origin": origin,
        }

    # -- coordinates and speeds --------------------------------------------------------------

    def _coordinates(self, joint: Joint) -> list[Scalar]:
        if joint.motion is not None:
            given = enumerate(zip(joint.coordinates, joint.motion.position, strict=True))
            q = [self.algebra.lift(p if locked(joint, k) else c.symbol) for k, (c, p) in given]
        else:
            q = [self.algebra.lift(self.chosen.get(c.symbol, c.symbol)) for c in joint.coordinates]
        self._attitude(joint)
        self.coordinates += q
        return q

    def _attitude(self, joint: Joint) -> None:
        """Choose the normal form of attitude coordinates: what rates are divided by is kept."""
        if joint.row.attitude and joint.attitude == QUATERNION:
            self.algebra.sphere(c.symbol for c in joint.coordinates[-4:])
        elif joint.row.attitude:
            first, _, third = joint.attitude.split("-")
            self.algebra.angle(joint.coordinates[-2].symbol, keep_sine=first == third)

    def _speeds(self, joint: Joint, setting: Setting, q: list[Scalar], local: Any) -> None:
        """Add the speeds of a joint, and how they move its coordinates."""
        if joint.motion is not None:
            self._prescribed(joint)
            return
        replaced = [c.symbol in self.chosen for c in joint.coordinates]
        if any(replaced):
            self.joint_speeds += [self._over_new(x) for x in q]
            return
        if self.in_rates and _by_rates(joint):
            self._rates(joint, setting, q, local)
            return
        for k, u in enumerate(joint.speeds):
            unit = [int(n == k) for n in range(len(joint.speeds))]
            rates = joint.row.rates(setting, q, unit, local)
            names = [c.symbol for c in joint.coordinates]
            moved = {c: r for c, r in zip(names, rates, strict=True) if not is_zero(r)}
            self._speed(u, True, moved)
            self.joint_speeds.append(self.algebra.atom(u.symbol))

    def _rates(self, joint: Joint, setting: Setting, q: list[Scalar], local: Any) -> None:
        """Add the rates of a joint's coordinates as speeds, and its own speeds over them."""
        moved = []
        for c in joint.coordinates:
            self._speed(q_dot(self.named(c)), True, {c.symbol: 1})
            moved.append(self.algebra.atom(self.speeds[-1].symbol))
        own = joint.row.from_rates(setting, q, moved, local)
        for u, x in zip(joint.speeds, own, strict=True):
            self.followers[self.algebra.index(self.algebra.named(u.symbol))] = x
        self.joint_speeds += own

    def _prescribed(self, joint: Joint) -> None:
        for k, u in enumerate(joint.speeds):
            if locked(joint, k):
                self.joint_speeds.append(0)
                continue
            if is_number(joint.motion.acceleration[k]) and not joint.motion.acceleration[k]:
                self.even.append(len(self.speeds))
            self._speed(u, False, {joint.coordinates[k].symbol: 1})
            self.joint_speeds.append(self.algebra.atom(u.symbol))

    def _over_new(self, q: Scalar) -> Scalar:
        rates = {n.symbol: self.algebra.atom(q_dot(n).symbol) for n in self.new}
        return self.algebra.along(q, rates)

    # -- the whole ---------------------------------------------------------------------------

    def finish(self, links: tuple[Link, ...]) -> Mechanism:
        free = [j for j in self.tree.ordered if j.motion is None]
        kept = [c for j in free for c in j.coordinates if c.symbol not in self.chosen]
        return Mechanism(
            tree=self.tree,
            algebra=self.algebra,
            links=links,
            coordinates=tuple(self.coordinates),
            variables=(*self.new, *map(self.named, kept)),
            speeds=tuple(self.speeds),
            accelerations=tuple(self.accelerations),
            free=tuple(self.free),
            basis=tuple(self.basis),
            joint_speeds=tuple(self.joint_speeds),
            gravity=self.vector(self.tree.gravity),
            pulls=tuple(self._pull(load) for load in self.tree.loads),
            even=frozenset(self.even),
            followers=self.followers,
            named=frozenset(u.symbol for u in self.speeds) & self.own_names,
        )

    def _pull(self, load: Load) -> Pull:
        link = self.done[self.seats[load.body]]
        force, torque = (self._acting(v) for v in (load.force, load.torque))
        if load.axes != GROUND:
            force, torque = (times(transposed(link.seat), v) for v in (force, torque))
        point = link.point(self.vector(load.point))
        return Pull(self.seats[load.body], force, torque, point, load.axes == GROUND)

    def _acting(self, v: Vector) -> Vector:
        """Return what acts, over the speeds that are chosen."""
        return [followed(self.algebra, x, self.followers) for x in self.vector(v)]


def _by_rates(joint: Joint) -> bool:
    """Return whether a joint's own speeds are others than the rates of its coordinates, and these do."""
    by_components = None in joint.row.paired(joint.attitude)
    return by_components and not (joint.row.attitude and joint.attitude == QUATERNION)


def locked(joint: Joint, k: int) -> bool:
    """Return whether a prescribed coordinate is a constant that does not move.

    One with a rate beside a constant place moves: that is where it is looked at.
    """
    place, *rates = (joint.motion.position[k], joint.motion.rate[k], joint.motion.acceleration[k])
    return is_number(place) and all(map(is_zero, rates))


def followed(algebra: Algebra, x: Scalar, followers: Mapping[int, Scalar]) -> Scalar:
    """Return a scalar with followers in place of their speeds.

    Raises `InputError` where it is no polynomial in them.
    """
    lost = {algebra.generators[g] for g in followers}
    for g in x.used if isinstance(x, Polynomial) else ():
        if g not in followers and algebra.generators[g].free_symbols & lost:
            raise InputError(
                "a force is no polynomial in a speed that a constraint determines",
                where=algebra.where,
                got=str(algebra.generators[g]),
                hint="choose other independent speeds",
            )
    return algebra.replaced(x, followers)


def _with_rates(tree: Tree, names: Mapping[Expr, Expr]) -> dict[Expr, Expr]:
    """Return names with those of the rates: the rate of what is called phi is called phi_dot."""
    found = dict(names)
    for j in tree.ordered:
        for u, c in zip(j.speeds, j.row.paired(j.attitude), strict=True):
            q = None if c is None else names.get(j.coordinates[c].symbol)
            if q is not None:
                found.setdefault(u.symbol, sp.Symbol(dotted(q.name), real=True))
    return found


def dotted(name: str) -> str:
    """Return the name of a rate: ``u_dot`` of ``u``, ``q_ddot`` of ``q_dot``."""
    return f"{name.removesuffix('_dot')}_ddot" if name.endswith("_dot") else f"{name}_dot"


def q_dot(q: Quantity) -> Quantity:
    """Return the rate of a chosen coordinate, as a quantity."""
    unit = {"rad": "rad/s", "m": "m/s"}.get(q.unit, "")
    return Quantity(sp.Symbol(f"{q.name}_dot", real=True), unit, f"rate of {q.name}")


def new_coordinates(tree: Tree, chosen: Mapping[Expr, Expr]) -> tuple[Quantity, ...]:
    """Return the new coordinates, in the order of those that they replace."""
    where = f"tree {tree.name!r}: coordinates"
    allowed = {
        c.symbol: c
        for j in tree.ordered
        if j.motion is None and None not in j.row.paired(j.attitude) and j.row.name != "fixed"
        for c in j.coordinates
    }
    for q in chosen:
        if q not in allowed:
            raise InputError(
                f"cannot replace {q}",
                where=where,
                expected="a coordinate whose rate is a speed, of a joint that moves freely",
                hint=near_matches(str(q), [c.name for c in allowed.values()]),
            )
    for j in tree.ordered:
        if 0 < sum(c.symbol in chosen for c in j.coordinates) < len(j.coordinates):
            raise InputError(
                "replace all coordinates of a joint or none", where=f"{where}: {j.name}"
            )
    if any(TIME in e.free_symbols for e in chosen.values()):
        raise InputError("new coordinates cannot depend on time", where=where)
    parameters = set().union(*(_constants(tree)))
    new: dict[Expr, Quantity] = {}
    for old in (o for o in allowed if o in chosen):
        for s in sorted(chosen[old].free_symbols - parameters, key=str):
            new.setdefault(s, Quantity(s, allowed[old].unit, "coordinate"))
    others = [s for s in new if s in allowed and s not in chosen]
    if others or len(new) != len(chosen):
        raise InputError(
            "new coordinates are not as many as those that they replace",
            where=where,
            got=", ".join(str(s) for s in new) or "none",
            expected=f"{len(chosen)} new symbols in place of {', '.join(map(str, chosen))}",
        )
    return tuple(new.values())


def _constants(tree: Tree) -> list[set[Expr]]:
    """Return the symbols of placements and bodies: lengths and angles that a coordinate may rest on."""
    found: list[set[Expr]] = [set()]
    for j in tree.joints:
        for place in (j.on_parent, j.on_child):
            given = (*place.position, *(x for row in place.rotation for x in row), *j.rest)
            found += [x.free_symbols for x in given if not is_number(x)]
    return found


KNOWN: dict[type, frozenset[str]] = {
    Tree: frozenset(
        {"name", "bodies", "joints", "gravity", "loads", "inputs", "parameters", "numbers"}
    ),
    Body: frozenset({"name", "mass", "centre", "inertia", "about", "axes"}),
    Joint: frozenset(
        {
            *("name", "kind", "parent", "child", "axis", "second_axis", "pitch", "attitude"),
            *("on_parent", "on_child", "stiffness", "rest", "damping", "armature", "force"),
            *("motor", "motion", "alone"),
        }
    ),
    Load: frozenset({"body", "force", "torque", "point", "axes"}),
    Placement: frozenset({"position", "rotation"}),
}
"""The fields that are used, by type."""


def refuse_unknown(tree: Tree, what: str, also: frozenset[str] = frozenset()) -> None:
    """Raise `InputError` if a tree says something that ``what`` would leave out in silence.

    ``also``: fields of a tree that it knows beyond `KNOWN`.
    """
    for part in _parts(tree):
        known = next(names for kind, names in KNOWN.items() if isinstance(part, kind))
        for f in fields(part):
            if f.name not in known | also and getattr(part, f.name) != _default(f):
                name = getattr(part, "name", "")
                raise InputError(
                    f"{what} cannot take {f.name.replace('_', ' ')} into account",
                    where=f"{type(part).__name__.lower()} {name!r}" if name else "",
                    hint="derive(tree) can",
                )


def _parts(tree: Tree) -> Iterator[Any]:
    yield tree
    yield from (*tree.bodies, *tree.joints, *tree.loads)
    for j in tree.joints:
        yield from (j.on_parent, j.on_child)


def _default(f: Any) -> Any:
    return f.default_factory() if f.default_factory is not MISSING else f.default
