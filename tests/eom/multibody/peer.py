"""The same random trees in Pinocchio: model, state, and the order of its speeds."""

from __future__ import annotations

import math
import random
from dataclasses import replace

import numpy as np

from eom.multibody.model.bodies import Body, Joint, Placement
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Tree
from tests.eom.multibody.trees import MOVING, inertia, number, state, tree, turned

SHARED = tuple(kind for kind in MOVING if kind != "cylindrical")
"""Moving joints that Pinocchio has too; fixed ones are placements there."""


def shared_tree(seed, count, kinds=SHARED):
    """A random tree of shared joints, with a body fixed to one of its bodies; and a state."""
    given = tree(seed, count, kinds=kinds, attitudes=(QUATERNION,), loads=False)
    draw = random.Random(seed + 10**6)
    q, u = ([float(x) for x in group] for group in state(given, seed))
    lump = Body("lump", 2, [number(draw) for _ in range(3)], inertia(draw))
    here, there = (Placement([number(draw) for _ in range(3)], turned(draw)) for _ in range(2))
    parent = f"b{draw.randrange(count)}"
    weld = Joint("weld", "fixed", parent, "lump", on_parent=here, on_child=there)
    joints = [replace(j, armature=0) for j in given.joints]
    return Tree(given.name, [*given.bodies, lump], [*joints, weld], gravity=given.gravity), q, u


def array(values):
    """Fractions as doubles."""
    return np.array([[float(x) for x in row] if np.ndim(row) else float(row) for row in values])


def pinocchio(pin, given):
    """The same tree in Pinocchio."""
    model = pin.Model()
    model.gravity.linear = array(given.gravity)
    numbers = {"ground": 0}
    seats = {"ground": pin.SE3.Identity()}
    makers = {
        "revolute": lambda j, a: pin.JointModelRevoluteUnaligned(a),
        "prismatic": lambda j, a: pin.JointModelPrismaticUnaligned(a),
        "helical": lambda j, a: pin.JointModelHelicalUnaligned(a, float(j.pitch)),
        "universal": lambda j, a: pin.JointModelUniversal(a, array(j.second_axis)),
        "planar": lambda j, a: pin.JointModelPlanar(),
        "spherical": lambda j, a: pin.JointModelSpherical(),
        "free": lambda j, a: pin.JointModelFreeFlyer(),
    }

    def place(p):
        return pin.SE3(array(p.rotation).T, array(p.position))

    for j in given.ordered:
        where, away = seats[j.parent] * place(j.on_parent), place(j.on_child).inverse()
        if j.kind == "fixed":
            numbers[j.child], seats[j.child] = numbers[j.parent], where * away
        else:
            made = makers[j.kind](j, array(j.axis))
            numbers[j.child] = model.addJoint(numbers[j.parent], made, where, j.name)
            seats[j.child] = away
        b = given.body[j.child]
        rigid = pin.Inertia(float(b.mass), array(b.centre), array(b.central_inertia))
        model.appendBodyToJoint(numbers[j.child], rigid, seats[j.child])
    return model


def their_state(given, q, u):
    """Coordinates and speeds as Pinocchio has them, and for each of its speeds the number of ours."""
    theirs, order, at, start = [], [], 0, 0
    for j in given.ordered:
        own = q[at : at + len(j.coordinates)]
        at += len(own)
        if j.kind == "planar":
            own = [own[0], own[1], math.cos(own[2]), math.sin(own[2])]
        elif j.kind in {"spherical", "free"}:
            own = [*own[:-4], *own[-3:], own[-4]]
        size = len(j.speeds)
        order += [start + n for n in ([3, 4, 5, 0, 1, 2] if j.kind == "free" else range(size))]
        start += size
        theirs += own
    return np.array(theirs), np.array(u)[order], order
