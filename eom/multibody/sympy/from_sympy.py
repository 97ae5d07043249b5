"""A mechanics System of SymPy, with its joints and bodies, as a tree.

SymPy's functions of time become symbols: coordinates and speeds those of the tree's joints, others
inputs. `codegen.frontend.from_sympy_mechanics.as_system` takes equations that SymPy has formed; here the
bodies themselves are taken over. In SymPy ``B.dcm(A)`` takes components in A to components in B, as
``C_BA`` here.

How the kinds of joints of SymPy's mechanics are read: a row a class.

A row takes the reader (which keeps the names of coordinates and speeds), the joint, and its name, bodies
and placements as they are in a tree.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.physics import mechanics as me

from eom.errors import InputError
from eom.exact.identity import vanishes
from eom.kinematics.coordinates import SEQUENCES, rotation_sequence
from eom.kinematics.frames import vector
from eom.multibody.model.attachments import Load
from eom.multibody.model.bodies import GROUND, Body, Joint, Placement
from eom.multibody.model.model import Tree
from eom.quantities import TIME

Expr = Any


@dataclass(frozen=True)
class Imported:
    """A tree, and what SymPy's functions of time are in it.

    ``names``: coordinates, speeds and other functions, over the tree's symbols. A speed of SymPy that the
    tree has in other axes is an expression.
    """

    tree: Tree
    names: Mapping[Expr, Expr]

    def plain(self, expression: Expr) -> Expr:
        """Return an expression of SymPy's mechanics over the tree's symbols.

        Parameters
        ----------
        expression : expression
            Over functions of time.

        Returns
        -------
        expression
            With a symbol for each of them.
        """
        return _exchanged(sp.sympify(expression, strict=True), self.names)


def tree_from_sympy(system: Any, name: str = "system") -> Imported:
    """Return the tree of a `sympy.physics.mechanics.System` whose bodies hang on joints.

    Parameters
    ----------
    system : sympy.physics.mechanics.System
        With its joints; units, frames and signs stay as they are there. The ground is the rigid
        body whose frame is the system's (``System.from_newtonian``).
    name : str, default "system"
        What the tree is called.

    Returns
    -------
    Imported
        The tree, and which symbol of it stands for which function of time.

    Raises
    ------
    InputError
        For constraints, auxiliary or dependent variables, kinds of joints that trees do not have,
        and points or frames that are fixed to no body.

    Examples
    --------
    >>> ground, bob = me.RigidBody("ground"), me.RigidBody("bob", mass=2)
    >>> system = me.System.from_newtonian(ground)
    >>> system.add_joints(me.PinJoint("hinge", ground, bob, joint_axis=ground.x))
    >>> joint = tree_from_sympy(system, "pendulum").tree.joints[0]
    >>> joint.name, joint.kind, joint.child
    ('hinge', 'revolute', 'bob')
    """
    if not isinstance(system, me.System):
        raise InputError(
            "not a mechanics System", got=type(system).__name__, expected="sympy's System with joints",
            hint="codegen.compile takes KanesMethod and LagrangesMethod with their equations",
        )  # fmt: skip
    return _Reader(system, name).read()


def placement_from_sympy(frame: Any, point: Any, body_frame: Any, origin: Any) -> Placement:
    """Return where a frame and a point are on a body with that frame and origin.

    Raises `InputError` for those that are not fixed to it.
    """
    where = f"frame {frame}, point {point}"
    position = [_constant(x, where) for x in point.pos_from(origin).to_matrix(body_frame)]
    turned = frame.dcm(body_frame).tolist()
    return Placement(position, [[_constant(x, where) for x in row] for row in turned])


def body_from_sympy(body: Any) -> Body:
    """Return a `RigidBody` or `Particle` with its origin at the centre of mass.

    Raises `InputError` for masses that change, and potential energies.
    """
    where = f"body {body.name!r}"
    if body.potential_energy != 0:
        raise InputError(
            "potential energy of a body", where=where, got=body.potential_energy,
            expected="forces as loads, or apply_uniform_gravity",
        )  # fmt: skip
    mass = _constant(body.mass, where)
    if not isinstance(body, me.RigidBody):
        return Body(body.name, mass)
    inertia = body.central_inertia.to_matrix(body.frame).tolist()
    return Body(body.name, mass, (0, 0, 0), [[_constant(x, where) for x in row] for row in inertia])


def _constant(e: Expr, where: str) -> Expr:
    """Return an expression of parameters. Raises `InputError` for what changes."""
    found = sp.sympify(e, strict=True)
    if _moving(found):
        raise InputError(
            "changes in time", where=where, got=found, expected="numbers and parameters"
        )
    return found


@dataclass
class _Reader:
    system: Any
    name: str
    names: dict[Expr, Expr] = field(default_factory=dict)
    inputs: dict[Expr, Expr] = field(default_factory=dict)
    frames: dict[Any, Any] = field(default_factory=dict)
    """The frame of each body; of a particle that of the joint that leads to it."""

    def read(self) -> Imported:
        _refuse_constraints(self.system)
        self.ground = self._ground()
        self.frames = {b: b.frame for b in self.system.bodies if isinstance(b, me.RigidBody)}
        joints = [self._joint(j) for j in self.system.joints]
        self._kinematics()
        loads = self._loads()
        gravity, loads = self._gravity(loads)
        bodies = [body_from_sympy(b) for b in self.system.bodies if b is not self.ground]
        applied = tuple(self._load(x) for x in loads if self._acts(x))
        tree = Tree(
            self.name,
            tuple(bodies),
            tuple(joints),
            gravity=gravity,
            loads=applied,
            inputs=tuple(self.inputs.values()),
        )
        return Imported(tree, dict(self.names) | self.inputs)

    def _ground(self) -> Any:
        for body in self.system.bodies:
            if isinstance(body, me.RigidBody) and body.frame == self.system.frame:
                return body
        raise InputError(
            "no body is the ground", where=self.name,
            hint="make the system by System.from_newtonian(wall), and join the others to the wall",
        )  # fmt: skip

    # -- joints ------------------------------------------------------------------------------

    def _joint(self, joint: Any) -> Joint:
        kind = KINDS.get(type(joint).__name__)
        where = f"joint {joint.name!r}"
        if kind is None:
            raise InputError(
                "no such joint in trees", where=where, got=type(joint).__name__,
                expected=", ".join(KINDS),
            )  # fmt: skip
        if joint.child is self.ground:
            raise InputError(
                "the joint leads to the ground", where=where, hint="exchange parent and child"
            )
        self._particle(joint.child, joint.child_interframe, True, where)
        self._particle(joint.parent, joint.parent_interframe, False, where)
        made: Joint = kind(self, joint, self._placements(joint))
        return made

    def _particle(self, body: Any, frame: Any, leads: bool, where: str) -> None:
        """Give a particle the frame of the joint that leads to it."""
        if isinstance(body, me.RigidBody):
            return
        if not leads:
            raise InputError(
                "a particle carries a joint", where=where, got=body.name,
                hint="make it a RigidBody with a frame and no inertia",
            )  # fmt: skip
        self.frames[body] = frame

    def _placements(self, joint: Any) -> dict[str, Any]:
        return {
            "name": joint.name,
            "parent": GROUND if joint.parent is self.ground else joint.parent.name,
            "child": joint.child.name,
            "on_parent": self._placed(joint.parent, joint.parent_point, joint.parent_interframe),
            "on_child": self._placed(joint.child, joint.child_point, joint.child_interframe),
        }

    def _placed(self, body: Any, point: Any, interframe: Any) -> Placement:
        origin = self.system.fixed_point if body is self.ground else body.masscenter
        return placement_from_sympy(interframe, point, self.frames[body], origin)

    def name_states(self, joint: Any, made: Joint, speeds: Iterable[Expr]) -> None:
        """Note what the coordinates and speeds of a joint are called."""
        t = me.dynamicsymbols._t
        coordinates = [c.symbol for c in made.coordinates]
        for q, u, ours, rate in zip(
            joint.coordinates, joint.speeds, coordinates, speeds, strict=True
        ):
            self.names[q] = ours
            self.names[u] = self.names[q.diff(t)] = rate

    def _kinematics(self) -> None:
        """Refuse kinematic equations other than those of the joints."""
        expected = {k for j in self.system.joints for k in j.kdes if k != 0}
        given = {k for k in self.system.kdes if k != 0}
        if given != expected and {-k for k in given} != expected:
            raise InputError(
                "kinematic differential equations other than u = q' of the joints",
                where=self.name, got=", ".join(sorted(map(str, given ^ expected))),
            )  # fmt: skip

    # -- loads -------------------------------------------------------------------------------

    def _loads(self) -> list[Any]:
        found = list(self.system.loads)
        for actuator in self.system.actuators:
            found += actuator.to_loads()
        return found

    def _acts(self, load: Any) -> bool:
        """Return whether a load acts on what can move."""
        fixed = {self.ground.masscenter, self.system.fixed_point, self.system.frame}
        return (load.point if isinstance(load, me.Force) else load.frame) not in fixed

    def _gravity(self, loads: list[Any]) -> tuple[tuple[Expr, ...], list[Any]]:
        """Return the acceleration by which every mass has its weight, and the loads that are left."""
        heavy = [b for b in self.system.bodies if b is not self.ground and b.mass != 0]
        forces = [x for x in loads if isinstance(x, me.Force)]
        first = [x for x in forces if heavy and x.point == heavy[0].masscenter]
        for candidate in first:
            g = [x / heavy[0].mass for x in candidate.vector.to_matrix(self.system.frame)]
            weights = [self._weight(b, g, forces) for b in heavy]
            if any(g) and not any(map(_moving, g)) and None not in weights:
                left = [x for x in loads if not any(x is w for w in weights)]
                wall = self._weight(self.ground, g, [x for x in left if isinstance(x, me.Force)])
                return tuple(g), [x for x in left if x is not wall]
        return (0, 0, 0), loads

    def _weight(self, body: Any, g: list[Expr], forces: list[Any]) -> Any:
        for x in forces:
            if x.point == body.masscenter:
                components = x.vector.to_matrix(self.system.frame)
                pairs = zip(components, g, strict=True)
                if all(vanishes(f - body.mass * a) for f, a in pairs):
                    return x
        return None

    def _load(self, load: Any) -> Load:
        if isinstance(load, me.Force):
            body, point = self._fixed_on(load.point)
            axes, force = self._vector(load.vector, body)
            return Load(body.name, force=force, point=point, axes=axes)
        body = self._turning_with(load.frame)
        axes, torque = self._vector(load.vector, body)
        return Load(body.name, torque=torque, axes=axes)

    def _fixed_on(self, point: Any) -> tuple[Any, list[Expr]]:
        """Return the body that a point is fixed to, and where it is there."""
        for body, frame in self.frames.items():
            try:
                position = point.pos_from(body.masscenter)
                found = list(position.to_matrix(frame))
            except ValueError:
                continue
            if not any(map(_moving, found)) and body is not self.ground:
                return body, found
        raise InputError(
            "a force acts at a point that is fixed to no body", where=self.name, got=point
        )

    def _turning_with(self, frame: Any) -> Any:
        for body, own in self.frames.items():
            if frame == own:
                return body
        for joint in self.system.joints:
            for body, fixed in (
                (joint.parent, joint.parent_interframe),
                (joint.child, joint.child_interframe),
            ):
                if frame == fixed and body is not self.ground:
                    return body
        raise InputError(
            "a torque acts on a frame that is fixed to no body", where=self.name, got=frame
        )

    def _vector(self, v: Any, body: Any) -> tuple[str, list[Expr]]:
        """Return axes and components: the body's own if the vector is given in them."""
        own = self.frames[body]
        in_body = bool(v.args) and all(frame == own for _, frame in v.args)
        components = v.to_matrix(own if in_body else self.system.frame)
        return "body" if in_body else GROUND, [self._translated(x) for x in components]

    def _translated(self, e: Expr) -> Expr:
        for f in sorted(e.atoms(AppliedUndef, sp.Derivative), key=str):
            if f in self.names or f in self.inputs:
                continue
            inner = f.expr if isinstance(f, sp.Derivative) else f
            if inner in self.names:
                raise InputError("a load depends on accelerations", where=self.name, got=f)
            if [str(a) for a in inner.args] != [TIME.name]:
                raise InputError("not a function of time alone", where=self.name, got=f)
            if isinstance(f, sp.Derivative):
                raise InputError(
                    "a load depends on the derivative of an input", where=self.name, got=f,
                    hint="give the derivative a name of its own",
                )  # fmt: skip
            self.inputs[f] = sp.Symbol(f.func.__name__, real=True)
        return _exchanged(e, dict(self.names) | self.inputs)


def _moving(e: Expr) -> bool:
    """Return whether an expression changes in time."""
    e = sp.sympify(e, strict=True)
    return bool(e.atoms(AppliedUndef, sp.Derivative)) or me.dynamicsymbols._t in e.free_symbols


def _exchanged(e: Expr, names: Mapping[Expr, Expr]) -> Expr:
    """Exchange derivatives before functions, and time."""
    rates = {k: v for k, v in names.items() if isinstance(k, sp.Derivative)}
    return e.xreplace(rates).xreplace(dict(names)).xreplace({me.dynamicsymbols._t: TIME})


def _refuse_constraints(system: Any) -> None:
    for what in ("holonomic_constraints", "nonholonomic_constraints", "q_dep", "u_dep", "u_aux"):
        found = list(getattr(system, what))
        if found:
            raise InputError(
                f"a System with {what.replace('_', ' ')}", got=", ".join(map(str, found)),
                expected="independent coordinates and speeds of joints",
            )  # fmt: skip
    if not system.joints:
        raise InputError(
            "a System without joints", expected="bodies joined by SymPy's joints",
            hint="codegen.compile takes the equations that it forms",
        )  # fmt: skip


def _axis(joint: Any, v: Any) -> tuple[Expr, ...]:
    return tuple(v.normalize().to_matrix(joint.parent_interframe))


def _turning(kind: str) -> Any:
    """Return how joints along or about one axis are read."""

    def read(reader: Any, joint: Any, placed: dict[str, Any]) -> Joint:
        made = Joint(kind=kind, axis=_axis(joint, joint.joint_axis), **placed)
        reader.name_states(joint, made, [u.symbol for u in made.speeds])
        return made

    return read


def _welded(reader: Any, joint: Any, placed: dict[str, Any]) -> Joint:  # noqa: ARG001
    return Joint(kind="fixed", **placed)


def _planar(reader: Any, joint: Any, placed: dict[str, Any]) -> Joint:
    """SymPy turns about the first axis and moves along the second and third; a tree z, x and y."""
    cyclic = ((0, 1, 0), (0, 0, 1), (1, 0, 0))
    for side in ("on_parent", "on_child"):
        C = sp.Matrix(cyclic) * sp.Matrix(placed[side].rotation)
        placed[side] = Placement(placed[side].position, C.tolist())
    made = Joint(kind="planar", **placed)
    x, y, q = (c.symbol for c in made.coordinates)
    v1, v2, u = (s.symbol for s in made.speeds)
    s, c = sp.sin(q), sp.cos(q)
    rates = (u, c * v1 - s * v2, s * v1 + c * v2)
    for theirs, speed, ours, rate in zip(
        joint.coordinates, joint.speeds, (q, x, y), rates, strict=True
    ):
        reader.names[theirs] = ours
        reader.names[speed] = reader.names[theirs.diff(me.dynamicsymbols._t)] = rate
    return made


def _spherical(reader: Any, joint: Any, placed: dict[str, Any]) -> Joint:
    """Turns about fixed axes are turns about body axes in the opposite order."""
    order = [_DIGITS.get(c, c) for c in str(joint._rot_order).upper()]
    amounts = list(joint.coordinates if joint._amounts is None else joint._amounts)
    if joint._rot_type.upper() == "SPACE":
        order, amounts = order[::-1], amounts[::-1]
    attitude = "-".join(order)
    if attitude not in SEQUENCES or sorted(map(str, amounts)) != sorted(
        map(str, joint.coordinates)
    ):
        raise InputError(
            "rotation that trees do not have", where=f"joint {joint.name!r}",
            got=f"{joint._rot_type} {joint._rot_order} {amounts}",
            expected="a sequence of the three coordinates",
        )  # fmt: skip
    made = Joint(kind="spherical", attitude=attitude, **placed)
    angles = [c.symbol for c in made.coordinates]
    omega = vector("B", [s.symbol for s in made.speeds])
    rates = dict(zip(angles, rotation_sequence(attitude, angles).rates(omega), strict=True))
    ours = dict(zip(amounts, angles, strict=True))
    for q, u in zip(joint.coordinates, joint.speeds, strict=True):
        reader.names[q] = ours[q]
        reader.names[u] = reader.names[q.diff(me.dynamicsymbols._t)] = rates[ours[q]]
    return made


_DIGITS = {"X": "1", "Y": "2", "Z": "3"}

KINDS: dict[str, Any] = {
    "PinJoint": _turning("revolute"),
    "PrismaticJoint": _turning("prismatic"),
    "CylindricalJoint": _turning("cylindrical"),
    "PlanarJoint": _planar,
    "SphericalJoint": _spherical,
    "WeldJoint": _welded,
}
"""SymPy's joints by the names of their classes."""
