"""A tree as SymPy's reference frames, points and bodies, ready for its KanesMethod and LagrangesMethod.

Symbols of coordinates, speeds and inputs become functions of time (`dynamicsymbols`). A rotation C takes
components before to components after, which is ``frame.orient_dcm(before, C)``, so that
``frame.dcm(before)`` is C. Nothing of the recursions or closed forms is used: what SymPy derives from
these bodies is a derivation of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.physics import mechanics as me

from eom.errors import InputError
from eom.exact.identity import vanishes
from eom.multibody.algebra.scalars import Numbers, is_zero
from eom.multibody.algebra.spatial import IDENTITY
from eom.multibody.closed.mechanism import refuse_unknown
from eom.multibody.model.bodies import GROUND, Joint
from eom.multibody.model.joints import QUATERNION, Setting
from eom.multibody.model.model import Tree
from eom.quantities import TIME
from eom.system import as_expression

Expr = Any
_WORK = Numbers(sp.sin, sp.cos)


@dataclass(frozen=True)
class Exported:
    """A tree in SymPy's mechanics.

    ``frame``, ``origin``: of the ground. ``frames``, ``origins``, ``centres``: of the bodies, by name,
    with their velocities in the ground set. ``q``, ``u``: functions of time; ``kinematics``: expressions
    that are zero. ``bodies``: with one more for every rotor of a joint. ``loads``: gravity, springs,
    dampers, motors and applied loads. ``names``: functions of time by the tree's symbols.
    """

    tree: Tree
    frame: Any
    origin: Any
    frames: Mapping[str, Any]
    origins: Mapping[str, Any]
    centres: Mapping[str, Any]
    q: tuple[Expr, ...]
    u: tuple[Expr, ...]
    kinematics: tuple[Expr, ...]
    bodies: tuple[Any, ...]
    loads: tuple[tuple[Any, Any], ...]
    names: Mapping[Expr, Expr]

    def timed(self, expression: Expr) -> Expr:
        """Return an expression over SymPy's functions of time.

        Parameters
        ----------
        expression : expression
            Over the tree's symbols.

        Returns
        -------
        expression
            With a function of time for each symbol of a coordinate or speed.
        """
        return _timed(expression, self.names)

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

        Raises
        ------
        InputError
            For text.
        """
        back = {v: k for k, v in self.names.items() if isinstance(v, AppliedUndef | sp.Derivative)}
        rates = {k: v for k, v in back.items() if isinstance(k, sp.Derivative)}
        found = as_expression(expression).xreplace(rates).xreplace(back)
        return found.xreplace({me.dynamicsymbols._t: TIME})

    def kane(self) -> Any:
        """Return a `KanesMethod` with its equations formed."""
        method = me.KanesMethod(
            self.frame, list(self.q), list(self.u), kd_eqs=list(self.kinematics)
        )
        method.kanes_equations(list(self.bodies), list(self.loads) or None)
        return method

    def system(self) -> Any:
        """Return a mechanics `System`; its equations are formed when it is asked to."""
        found = me.System(self.frame, self.origin)
        found.add_coordinates(*self.q)
        found.add_speeds(*self.u)
        found.add_kdes(*self.kinematics)
        found.add_bodies(*self.bodies)
        found.add_loads(*self.loads)
        return found


def to_sympy(tree: Tree) -> Exported:
    """Return a tree in SymPy's mechanics.

    Parameters
    ----------
    tree : Tree
        Bodies, joints, springs and loads; what they say beyond
        `eom.multibody.closed.mechanism.KNOWN` is refused.

    Returns
    -------
    Exported
        Frames, points, bodies and loads as SymPy has them, and ``kane()`` for its equations.

    Raises
    ------
    InputError
        For prescribed motion whose rates are no derivatives of its position, and whatever the tree
        says beyond `eom.multibody.closed.mechanism.KNOWN`.

    Notes
    -----
    Units, frames and signs are those of the tree; forces and torques act on the child, as of
    `Joint`.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> bob = Body("bob", mass=2, centre=(0, 0, -1))
    >>> to_sympy(Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -10))).kane().forcing
    Matrix([[-20*sin(q_hinge(t))]])
    """
    return _Maker(tree).make()


def lagranges_method(tree: Tree) -> Any:
    """Return SymPy's `LagrangesMethod` of a tree, its equations formed; all forces are loads.

    Parameters
    ----------
    tree : Tree
        Of joints whose speeds are rates of coordinates.

    Returns
    -------
    sympy.physics.mechanics.LagrangesMethod
        Its equations formed; all forces are loads.

    Raises
    ------
    InputError
        For joints whose speeds are no rates of coordinates.

    Notes
    -----
    Units, frames and signs are those of the tree.

    References
    ----------
    Goldstein, Classical Mechanics (2002), ch. 1.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> bob = Body("bob", mass=2, centre=(0, 0, -1))
    >>> lagranges_method(Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -10))).mass_matrix
    Matrix([[2]])
    """
    for joint in tree.ordered:
        if None in joint.row.paired(joint.attitude):
            raise InputError(
                "Lagrange's method needs speeds that are rates of coordinates",
                where=f"joint {joint.name!r}", got=joint.kind,
                hint="use joints about single axes; closed_form has Boltzmann and Hamel's equations",
            )  # fmt: skip
    made = _Maker(tree, rates=True).make()
    kinetic = me.kinetic_energy(made.frame, *made.bodies)
    method = me.LagrangesMethod(
        kinetic,
        list(made.q),
        forcelist=list(made.loads),
        frame=made.frame,
        bodies=list(made.bodies),
    )
    method.form_lagranges_equations()
    return method


@dataclass
class _Maker:
    tree: Tree
    rates: bool = False
    """Whether speeds are written as rates of coordinates."""
    names: dict[Expr, Expr] = field(default_factory=dict)
    kinematics: list[Expr] = field(default_factory=list)
    bodies: list[Any] = field(default_factory=list)
    loads: list[tuple[Any, Any]] = field(default_factory=list)

    def make(self) -> Exported:
        refuse_unknown(self.tree, "SymPy's mechanics")
        self.N, self.O = me.ReferenceFrame("N"), me.Point("O")
        self.O.set_vel(self.N, 0)
        self.frames = {GROUND: self.N}
        self.origins = {GROUND: self.O}
        self.centres: dict[str, Any] = {}
        self._variables()
        for joint in self.tree.ordered:
            self._joint(joint)
        for load in self.tree.loads:
            self._load(load)
        free = [j for j in self.tree.ordered if j.motion is None]
        return Exported(
            tree=self.tree, frame=self.N, origin=self.O, frames=self.frames,
            origins=self.origins, centres=self.centres,
            q=tuple(self.names[c.symbol] for j in free for c in j.coordinates),
            u=tuple(self.names[s.symbol] for j in free for s in j.speeds),
            kinematics=tuple(self.kinematics), bodies=tuple(self.bodies), loads=tuple(self.loads),
            names=self.names,
        )  # fmt: skip

    def timed(self, e: Any) -> Expr:
        """Return a value of the description with functions of time."""
        return _timed(e, self.names)

    # -- variables ---------------------------------------------------------------------------

    def _variables(self) -> None:
        t = me.dynamicsymbols._t
        for quantity in self.tree.inputs:
            self.names[quantity.symbol] = me.dynamicsymbols(quantity.name)
        for joint in self.tree.ordered:
            if joint.motion is not None:
                self._prescribed(joint)
                continue
            for quantity in (*joint.coordinates, *joint.speeds, *joint.motors):
                self.names[quantity.symbol] = me.dynamicsymbols(quantity.name)
            if self.rates:
                pairs = zip(joint.coordinates, joint.speeds, strict=True)
                self.names |= {u.symbol: self.names[q.symbol].diff(t) for q, u in pairs}

    def _prescribed(self, joint: Joint) -> None:
        motion = joint.motion
        for k, (q, u) in enumerate(zip(joint.coordinates, joint.speeds, strict=True)):
            x, v, a = (
                as_expression(given[k])
                for given in (motion.position, motion.rate, motion.acceleration)
            )
            if not (vanishes(x.diff(TIME) - v) and vanishes(v.diff(TIME) - a)):
                raise InputError(
                    "SymPy needs prescribed motion as a function of time with its derivatives",
                    where=f"joint {joint.name!r}", got=f"{x}, {v}, {a}",
                )  # fmt: skip
            self.names[q.symbol], self.names[u.symbol] = self.timed(x), self.timed(v)

    # -- frames and points -------------------------------------------------------------------

    def _joint(self, joint: Joint) -> None:
        parent, body = self.frames[joint.parent], self.tree.body[joint.child]
        P = _fixed(f"{joint.name}_P", parent, self._matrix(joint.on_parent.rotation))
        base = self._point(f"{joint.name}_P", joint.parent, joint.on_parent.position)
        q = [self.names[c.symbol] for c in joint.coordinates]
        u = [self.names[s.symbol] for s in joint.speeds]
        local = joint.row.place(self._setting(joint), q, _WORK)
        F = self._turned(joint, P, q, local)
        angular, linear = (
            sum((speed * _vector(column[k], F) for speed, column in zip(u, local.subspace, strict=True)),
                me.Vector(0))
            for k in (0, 1)
        )  # fmt: skip
        F.set_ang_vel(P, angular)
        B = _fixed(joint.child, F, self._matrix(joint.on_child.rotation).T)
        step = self.vector(local.position, P)
        end = base.locatenew(f"{joint.name}_F", step)
        carried = base.vel(self.N) + (parent.ang_vel_in(self.N) ^ step)
        end.set_vel(self.N, carried + linear)
        origin = end.locatenew(joint.child, -self.vector(joint.on_child.position, B))
        origin.v2pt_theory(end, self.N, B)
        self.frames[joint.child], self.origins[joint.child] = B, origin
        self._body(body, B, origin)
        if joint.motion is None:
            self._rates(joint, q, u, local)
            self._act(joint, F, end, q, u, local.subspace)

    def _turned(self, joint: Joint, P: Any, q: list[Expr], local: Any) -> Any:
        """Return the frame F of a joint, by SymPy's own turns about axes where these are exact."""
        turns = _turns(joint, q)
        if turns is None or any(not vanishes(sum(x * x for x in a) - 1) for a, _ in turns):
            C = sp.eye(3)
            for turn in local.rotation:
                C = self._matrix(turn.matrix) * C
            F = me.ReferenceFrame(f"{joint.name}_F")
            F.orient_dcm(P, C)
            return F
        frame = P
        for k, (axis, angle) in enumerate(turns, 1):
            before, frame = frame, me.ReferenceFrame(f"{joint.name}_turn{k}")
            frame.orient_axis(before, self.vector(axis, before), angle)
        return frame if turns else _fixed(f"{joint.name}_F", P, sp.eye(3))

    def _setting(self, joint: Joint) -> Setting:
        axes = tuple(tuple(_exact(x) for x in axis) for axis in joint.axes)
        return Setting(joint.name, axes, _exact(joint.pitch), joint.attitude)

    def _matrix(self, A: Any) -> Expr:
        return sp.Matrix(3, 3, [self.timed(x) for row in A for x in row])

    def vector(self, v: Sequence[Any], frame: Any) -> Any:
        """Return a vector with these components."""
        return _vector([self.timed(x) for x in v], frame)

    def _point(self, name: str, body: str, position: Sequence[Any]) -> Any:
        """Return a point that is fixed on a body, with its velocity."""
        frame, origin = self.frames[body], self.origins[body]
        found = origin.locatenew(name, self.vector(position, frame))
        found.v2pt_theory(origin, self.N, frame)
        return found

    def _body(self, body: Any, frame: Any, origin: Any) -> None:
        G = origin.locatenew(f"{body.name}_G", self.vector(body.centre, frame))
        G.v2pt_theory(origin, self.N, frame)
        self.centres[body.name] = G
        J = [[self.timed(x) for x in row] for row in body.central_inertia]
        dyadic = me.inertia(frame, J[0][0], J[1][1], J[2][2], J[0][1], J[1][2], J[0][2])
        mass = self.timed(body.mass)
        self.bodies.append(me.RigidBody(body.name, G, frame, mass, (dyadic, G)))
        weight = mass * self.vector(self.tree.gravity, self.N)
        if weight != 0:
            self.loads.append((G, weight))

    def _rates(self, joint: Joint, q: list[Expr], u: list[Expr], local: Any) -> None:
        """Add q' - N u = 0."""
        if self.rates:
            return
        t = me.dynamicsymbols._t
        rates = joint.row.rates(self._setting(joint), q, u, local)
        self.kinematics += [x.diff(t) - as_expression(r) for x, r in zip(q, rates, strict=True)]

    # -- forces ------------------------------------------------------------------------------

    def _act(
        self, joint: Joint, F: Any, end: Any, q: list[Expr], u: list[Expr], columns: Sequence[Any]
    ) -> None:
        """Add what acts in a joint, on the child and back on the parent, and its rotors."""
        forces = [self._force(joint, k, q, u[k]) for k in range(len(u))]
        self._rotors(joint, u)
        if all(x == 0 for x in forces):
            return
        torque, force = self._wrench(columns, forces, F)
        beside = self.origins[joint.parent].locatenew(
            f"{joint.name}_reaction", end.pos_from(self.origins[joint.parent])
        )
        arm = beside.pos_from(self.origins[joint.parent])
        carrier = self.frames[joint.parent]
        beside.set_vel(
            self.N, self.origins[joint.parent].vel(self.N) + (carrier.ang_vel_in(self.N) ^ arm)
        )
        pairs = [(F, torque), (carrier, -torque), (end, force), (beside, -force)]
        self.loads += [(at, load) for at, load in pairs if load != 0 and at is not self.N]

    def _force(self, joint: Joint, k: int, q: list[Expr], u: Expr) -> Expr:
        """Return the generalised force of motor, damper and spring, and what is applied."""
        total = self.timed(joint.force[k]) - self.timed(joint.damping[k]) * u
        if joint.motors:
            total += self.names[joint.motors[k].symbol]
        c = joint.row.paired(joint.attitude)[k]
        if c is not None:
            total -= self.timed(joint.stiffness[k]) * (q[c] - self.timed(joint.rest[k]))
        return total

    def _wrench(self, columns: Sequence[Any], forces: list[Expr], F: Any) -> tuple[Any, Any]:
        """Return torque and force in F that do the work of generalised forces: S (S^T S)^-1 Q."""
        S = sp.Matrix([[as_expression(x) for x in column.six] for column in columns]).T
        six = S * (S.T * S).applyfunc(sp.trigsimp).inv() * sp.Matrix(forces)
        return _vector(six[:3], F), _vector(six[3:], F)

    def _rotors(self, joint: Joint, u: list[Expr]) -> None:
        """Add a body that turns (or moves) at a joint's speed and has the rotor's inertia alone."""
        for k, J in enumerate(joint.armature):
            if is_zero(J):
                continue
            name = f"{joint.name}_rotor{k + 1}"
            R, at = me.ReferenceFrame(name), me.Point(name)
            R.orient_axis(self.N, self.N.x, 0)
            R.set_ang_vel(self.N, u[k] * self.N.x)
            at.set_vel(self.N, 0)
            inertia = me.inertia(self.N, self.timed(J), 0, 0)
            self.bodies.append(me.RigidBody(name, at, R, 0, (inertia, at)))

    def _load(self, load: Any) -> None:
        axes = self.N if load.axes == GROUND else self.frames[load.body]
        force, torque = (self.vector(v, axes) for v in (load.force, load.torque))
        if force != 0:
            at = self._point(f"load{len(self.loads)}", load.body, load.point)
            self.loads.append((at, force))
        if torque != 0:
            self.loads.append((self.frames[load.body], torque))


def _turns(joint: Joint, q: list[Expr]) -> list[tuple[Sequence[Any], Expr]] | None:
    """Return the turns of a joint about unit vectors, one after the other; None for a quaternion."""
    if joint.row.attitude:
        if joint.attitude == QUATERNION:
            return None
        axes = [IDENTITY[int(n) - 1] for n in joint.attitude.split("-")]
        return list(zip(axes, q[-3:], strict=True))
    if joint.kind == "planar":
        return [((0, 0, 1), q[2])]
    turning = joint.row.spins or joint.kind == "universal"
    return list(zip(joint.axes, q, strict=False)) if turning else []


def _fixed(name: str, before: Any, C: Expr) -> Any:
    """Return a frame that is fixed in another; C takes components in that to components in it."""
    found = me.ReferenceFrame(name)
    found.orient_dcm(before, C)
    found.set_ang_vel(before, me.Vector(0))
    return found


def _vector(v: Sequence[Any], frame: Any) -> Any:
    parts = zip(v, (frame.x, frame.y, frame.z), strict=True)
    return sum((as_expression(x) * e for x, e in parts), me.Vector(0))


def _exact(x: Any) -> Any:
    """Return a fraction as SymPy's; whole numbers stay, as they are structure."""
    return sp.Rational(x.numerator, x.denominator) if isinstance(x, Fraction) else x


def _timed(e: Any, names: Mapping[Expr, Expr]) -> Expr:
    given = as_expression(_exact(e))
    return given.xreplace(dict(names)).xreplace({TIME: me.dynamicsymbols._t})
