"""Random trees of bodies with exact numbers, and exact arithmetic for recursions over them."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction

from eom.kinematics.coordinates import SEQUENCES
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.model.attachments import Load
from eom.multibody.model.bodies import Body, Joint, Placement
from eom.multibody.model.joints import KINDS
from eom.multibody.model.model import Tree

MOVING = tuple(k for k in KINDS if k != "fixed")


def half(t):
    """Cosine and sine of the angle whose half has tangent t."""
    return (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)


EXACT = Numbers(lambda t: half(Fraction(t))[1], lambda t: half(Fraction(t))[0])
"""An angle is given by the tangent of its half: sine and cosine are fractions."""


def number(draw, low=-9, high=9):
    return Fraction(draw.randint(low, high), draw.choice((2, 3, 4, 5)))


def turned(draw):
    """A rotation matrix of fractions, by a quaternion of whole numbers."""
    a, b, c, d = draw.choice(
        ((1, 0, 0, 0), (1, 1, 0, 0), (1, 1, 1, 1), (2, 1, 0, 1), (1, -1, 2, 1))
    )
    n = a * a + b * b + c * c + d * d
    rows = (
        (a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)),
        (2 * (b * c - a * d), a * a - b * b + c * c - d * d, 2 * (c * d + a * b)),
        (2 * (b * d + a * c), 2 * (c * d - a * b), a * a - b * b - c * c + d * d),
    )
    return tuple(tuple(Fraction(x, n) for x in row) for row in rows)


def inertia(draw):
    """An inertia about the centre: of three point masses and a cube."""
    points = [[number(draw) for _ in range(3)] for _ in range(3)]
    J = [[Fraction(int(i == j)) for j in range(3)] for i in range(3)]
    for p in points:
        square = sum(x * x for x in p)
        for i in range(3):
            for j in range(3):
                J[i][j] += (square if i == j else 0) - p[i] * p[j]
    return J


def axis(draw):
    return draw.choice(("x", "y", "z", "-x", "-z", (1, 2, 2), (2, -3, 6)))


def joint(draw, k, parent, kinds, attitudes):
    kind = draw.choice(kinds)
    first = axis(draw)
    second = draw.choice([a for a in ("x", "y", "z") if a not in first])
    return Joint(
        f"j{k}",
        kind,
        parent,
        f"b{k}",
        axis=first,
        second_axis=second
        if isinstance(first, str)
        else (2, 1, -2)
        if first == (1, 2, 2)
        else (3, 6, 2),
        pitch=Fraction(1, 3),
        attitude=draw.choice(attitudes),
        on_parent=Placement([number(draw) for _ in range(3)], turned(draw)),
        on_child=Placement([number(draw) for _ in range(3)], turned(draw)),
        armature=draw.choice((0, 0, Fraction(1, 2))),
    )


def tree(seed, count, kinds=MOVING, attitudes=("quaternion", *SEQUENCES), loads=True):
    """A tree of ``count`` bodies; every third hangs where a random one does, the others in a chain."""
    draw = random.Random(seed)
    bodies, joints = [], []
    for k in range(count):
        parent = "ground" if k == 0 else f"b{k - 1 if draw.random() < 0.6 else draw.randrange(k)}"
        bodies.append(
            Body(f"b{k}", abs(number(draw)) + 1, [number(draw) for _ in range(3)], inertia(draw))
        )
        joints.append(joint(draw, k, parent, kinds, attitudes))
    acting = [
        Load(
            f"b{draw.randrange(count)}",
            [number(draw) for _ in range(3)],
            [number(draw) for _ in range(3)],
            [number(draw) for _ in range(3)],
            side,
        )
        for side in ("body", "ground")
    ]
    return Tree(
        f"tree{seed}",
        bodies,
        joints,
        gravity=(0, Fraction(1, 2), -9),
        loads=acting if loads else (),
    )


def state(tree, seed):
    """Coordinates (quaternions of norm 1) and speeds."""
    draw = random.Random(seed)
    q, u = [], []
    for j in tree.ordered:
        names = [c.name for c in j.coordinates]
        own = [draw.choice((-1, 1)) * Fraction(draw.randint(1, 9), 10) for _ in names]
        if any(n.startswith("e_") for n in names):
            own[-4:] = draw.choice(
                ([Fraction(n, 9) for n in (2, 4, 5, 6)], [Fraction(n, 5) for n in (4, 1, 2, -2)])
            )
        q += own
        u += [number(draw) for _ in j.speeds]
    return q, u


def unspun(part):
    """The part with a frame that turns with it."""
    return replace(part, spins=False)


def driven(part):
    """The part with a prescribed motion."""
    return replace(part, driven=True)
