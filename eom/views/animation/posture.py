"""Where everything in a tree is over a motion: coordinates and speeds as arrays over its times."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from eom.errors import InputError
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.algebra.spatial import ZERO
from eom.multibody.algebra.values import is_number
from eom.multibody.constrained.relations import Arithmetic
from eom.multibody.model.bodies import Joint
from eom.multibody.model.model import Tree
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.quantities import Flow, flow, joint_forces
from eom.multibody.system.vectors import Moment
from eom.quantities import TIME, Definition, Quantity
from eom.system import System
from eom.views.animation.tracks import (
    LARGEST_STEP,
    STEP,
    Floats,
    Track,
    continuous,
    from_third,
    multiplied,
    of_matrices,
    turned,
)

STILL, VALUE = "eom_still", "eom_value"
"""Names that no scene has."""
MULTIPLIER = "lambda_"
"""How the names of outputs begin that are multipliers of constraints."""


def number(value: Any, known: Mapping[str, float]) -> float:
    """Return the number that a value of a description has; symbols without one count as zero.

    Raises `InputError` where it is none.
    """
    if is_number(value):
        return float(value)
    at = {s: sp.Float(known.get(s.name, 0.0)) for s in value.free_symbols}
    found = sp.sympify(value, strict=True).xreplace(at).evalf()
    if not found.is_real or not math.isfinite(found):
        raise InputError("not a number at the start", where="sketch", got=f"{value} = {found}")
    return float(found)


def numbers(values: Any, known: Mapping[str, float]) -> Floats:
    """Return numbers of a vector or a matrix."""
    if isinstance(values, list | tuple):
        return np.array([numbers(v, known) for v in values])
    return np.asarray(number(values, known))


@dataclass(frozen=True, eq=False)
class Motion:
    """All numbers of a scene by name at N times ``t`` (s), shape (N,): one number, or one for each time."""

    t: Floats
    values: Mapping[str, float | Floats]

    def series(self, name: str) -> Floats:
        """Return a number over time, shape (N,)."""
        return np.broadcast_to(np.asarray(self.values[name]), self.t.shape)

    def triple(self, letter: str) -> Floats:
        """Return three numbers that are called by a letter and 1, 2, 3, shape (N, 3)."""
        return np.stack([self.series(f"{letter}_{k}") for k in (1, 2, 3)], axis=-1)


ARRAYS = Numbers(np.sin, np.cos, np.sqrt)
"""Scalars that are arrays over time."""
STRUCTURE = (0, 1, -1)
"""Numbers that recursions leave out."""


def filled(entries: Any, count: int) -> Floats:
    """Return a vector or matrix of numbers and arrays (N,) as one array, N first."""
    if isinstance(entries, list | tuple):
        return np.stack([filled(e, count) for e in entries], axis=1)
    return np.broadcast_to(np.asarray(entries, dtype=np.float64), (count,))


@dataclass(frozen=True)
class Posture:
    """A tree whose coordinates and speeds are arrays over the times of a motion."""

    tree: Tree
    motion: Motion

    @property
    def count(self) -> int:
        """Number of times."""
        return len(self.motion.t)

    @cached_property
    def known(self) -> dict[str, Any]:
        """The values of all symbols by name; speeds that constraints eliminate are outputs."""
        return {**self.motion.values, "t": self.motion.t}

    def lift(self, given: Any) -> Any:
        """Return the number or array that a value of the description has; 0, 1 and -1 stay numbers."""
        if is_number(given):
            return int(given) if given in STRUCTURE else float(given)
        if given.is_Symbol:
            return self.known[given.name]
        at = {s.name: self.known[s.name] for s in given.free_symbols}
        changing = {n: v for n, v in at.items() if not isinstance(v, float)}
        if not changing:
            return number(given, at)
        if given not in self._lifted:
            self._lifted[given] = self._over_time(given, at, changing)
        return self._lifted[given]

    @cached_property
    def _lifted(self) -> dict[Any, Floats]:
        """The arrays of expressions that change over time."""
        return {}

    def _over_time(self, given: Any, at: Mapping[str, Any], changing: Mapping[str, Any]) -> Floats:
        """Return the values of an expression at all times, compiled: its symbols are states at rest."""
        import codegen

        moving = [n for n in changing if n != TIME.name] or [STILL]
        constant = [n for n in at if n not in changing]
        system = System(
            name="values",
            states=tuple(Quantity(sp.Symbol(n, real=True)) for n in moving),
            rates=(sp.S.Zero,) * len(moving),
            parameters=tuple(Quantity(sp.Symbol(n, real=True)) for n in constant),
            outputs=(Definition(Quantity(sp.Symbol(VALUE, real=True)), _named(given)),),
        )
        states = np.array([np.broadcast_to(at.get(n, 0.0), (self.count,)) for n in moving])
        compiled = codegen.compile(system, "numpy")
        found = compiled.outputs(
            self.motion.t, states, np.array([at[n] for n in constant], dtype=float)
        )
        return np.asarray(np.broadcast_to(found[0], (self.count,)))

    @cached_property
    def bones(self) -> LumpedTree:
        """The parts, whose frames all turn with them."""
        tree = without_forces(self.tree)
        return lumped_tree(tree, self.lift, ARRAYS, [b.name for b in tree.bodies])

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The joints that lead to parts, in order."""
        leading = {part.joint for part in self.bones.parts}
        return tuple(j for j in self.tree.ordered if j.name in leading)

    @cached_property
    def coordinates(self) -> list[Any]:
        """The coordinates of all parts."""
        rows = [
            j.motion.position if j.motion else [c.symbol for c in j.coordinates]
            for j in self.joints
        ]
        return [self.lift(v) for row in rows for v in row]

    @cached_property
    def speeds(self) -> list[Any]:
        """The speeds of all parts."""
        rows = [
            j.motion.rate or () if j.motion else [s.symbol for s in j.speeds] for j in self.joints
        ]
        return [self.lift(v) for row in rows for v in row]

    @cached_property
    def flow(self) -> Flow:
        """The motion of all parts."""
        return flow(self.bones, self.coordinates, self.speeds, ARRAYS)

    @cached_property
    def moment(self) -> Moment:
        """The tree with all that acts on it, at all times at once."""
        tau: list[Any] = []
        first = 0
        for joint in self.joints:
            q = self.coordinates[first : first + len(joint.coordinates)]
            u = self.speeds[len(tau) : len(tau) + len(joint.speeds)]
            first += len(joint.coordinates)
            held = joint.motion is not None
            tau += [0] * len(u) if held else joint_forces(joint, q, u, self.lift, ARRAYS)
        multipliers = {
            n.removeprefix(MULTIPLIER): self.motion.series(n)
            for n in self.motion.values
            if n.startswith(MULTIPLIER)
        }
        arithmetic = Arithmetic(self.lift, ARRAYS, np.sqrt)
        told = self.coordinates, self.speeds, tau, multipliers, self.prescribed
        return Moment(self.tree, arithmetic, *told)

    @cached_property
    def prescribed(self) -> dict[int, Any]:
        """The accelerations of speeds whose motion is given, by their numbers."""
        given = [
            list(j.motion.acceleration) if j.motion else [None] * len(j.speeds) for j in self.joints
        ]
        rows = enumerate(x for row in given for x in row)
        return {k: self.lift(x) for k, x in rows if x is not None}

    def pose(self, name: str) -> tuple[Floats, Floats]:
        """Return C_BA of a body, shape (N, 3, 3), and where its origin is (m), shape (N, 3)."""
        seat, N = self.bones.seats[name], self.count
        own, origin = (filled(x, N) for x in (_lists(seat.rotation), list(seat.origin)))
        if seat.part < 0:
            return own, origin
        R, x = self.flow.poses[seat.part]
        C = filled(_lists(R), N)
        return own @ C, filled(list(x), N) + np.einsum("nij,ni->nj", C, origin)

    def track(self, name: str) -> Track:
        """Return the motion of a body."""
        (C, position), part = self.pose(name), self.bones.seats[name].part
        if part < 0:
            return Track(name, position, of_matrices(C), np.zeros((self.count, 3)))
        omega = filled(list(self.flow.velocities[part].angular), self.count)
        R = filled(_lists(self.flow.poses[part][0]), self.count)
        return Track(name, position, of_matrices(C), np.einsum("nij,ni->nj", R, omega))

    def rotor(self, number: int) -> Track:
        """Return the motion of a rotor about its axis, which is the third one of its own."""
        rotor = self.tree.rotors[number]
        body, N = self.track(rotor.body), self.count
        axis = np.array([float(self.lift(a)) for a in rotor.axis])
        centre = filled([self.lift(c) for c in self.tree.body[rotor.body].centre], N)
        space = turned(body.quaternions, np.broadcast_to(axis, (N, 3)))
        if rotor.speed is None:
            along = filled(self.lift(rotor.states[-1].symbol), N)
            within = along - np.einsum("ni,ni->n", body.omega, space)
        else:
            within = filled(self.lift(rotor.speed), N)
        name = "" if rotor.speed is not None else rotor.states[0].name
        known = name in self.motion.values
        angle = self.motion.series(name) if known else _integrated(self.motion.t, within)
        slower = slowed(angle)
        angle = angle / slower
        spin = np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * np.eye(3)[2][:, None]]).T
        tilt = np.broadcast_to(from_third(axis), (N, 4))
        return Track(
            rotor.name,
            body.positions + turned(body.quaternions, centre),
            continuous(multiplied(multiplied(body.quaternions, tilt), spin)),
            body.omega + within[:, None] * space,
            slower,
        )

    def wheel(self, joint: Joint) -> Track:
        """Return the motion of a body on a hinge, drawn slower about it where it is too fast."""
        found = self.track(joint.child)
        angle = np.broadcast_to(self.lift(joint.coordinates[0].symbol), (self.count,))
        slower = slowed(angle)
        half = (angle / slower - angle) / 2
        axis = np.array([float(self.lift(a)) for a in joint.axis])
        spin = np.column_stack([np.cos(half), np.sin(half)[:, None] * axis / np.linalg.norm(axis)])
        quaternions = continuous(multiplied(found.quaternions, spin))
        return replace(found, quaternions=quaternions, slower=slower)


def _integrated(t: Floats, rate: Floats) -> Floats:
    """Return the integral of a rate from the first time, shape (N,), by trapezoids."""
    return np.concatenate([[0.0], np.cumsum(np.diff(t) * (rate[1:] + rate[:-1]) / 2)])


def slowed(angle: Floats) -> float:
    """Return the power of ten by which an angle (rad), shape (N,), is divided so that its turns are seen.

    It is 1 unless the angle goes from one time to the next by more than can be shown.
    """
    most = float(np.abs(np.diff(angle)).max(initial=0.0))
    return 1.0 if most <= LARGEST_STEP else 10.0 ** math.ceil(math.log10(most / STEP))


def _named(given: Any) -> Any:
    """Return an expression over symbols that are told apart by their names alone; time stays."""
    own = {s: sp.Symbol(s.name, real=True) for s in given.free_symbols if s != TIME}
    return sp.sympify(given, strict=True).xreplace(own)


def without_forces(tree: Tree) -> Tree:
    """Return a tree with what its motion is read from alone: no forces, springs and constraints."""
    return replace(
        tree,
        joints=tuple(
            replace(j, force=0, stiffness=0, damping=0, rest=0, motor=False) for j in tree.joints
        ),
        rotors=tuple(replace(r, torque=0, damping=0, motor=False) for r in tree.rotors),
        loads=(),
        springs=(),
        constraints=(),
        inputs=(),
        jets=tuple(replace(jet, velocity=ZERO) for jet in tree.jets),
    )


def _lists(rows: Any) -> list[list[Any]]:
    return [list(row) for row in rows]
