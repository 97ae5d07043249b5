"""Explicit motions of masses as functions of time, in SymPy: the ground on which notes are judged.

Vectors are columns of components in the inertial frame; ``C`` maps components in I to components in B.
Nothing of `eom` is used.
"""

import random
from dataclasses import dataclass

import sympy as sp

t = sp.Symbol("t", real=True)
INSTANT = sp.Rational(3, 10)
DIGITS = 40
TRUE, FALSE = 1e-25, 1e-6
"""Below the one two sides are equal, above the other they differ; nothing may lie between."""
ONE = sp.eye(3)


@dataclass(frozen=True)
class Case:
    """Pairs of sides as the note has them, and as the correction has them."""

    written: tuple
    corrected: tuple = ()


def case(*pairs, corrected=()):
    return Case(pairs, tuple(corrected))


def number(rng):
    return sp.Rational(rng.choice((-1, 1)) * rng.randint(2, 9), rng.randint(4, 9))


def path(rng):
    return sp.Matrix([function(rng) for _ in range(3)])


def function(rng):
    return sum(number(rng) * t**k for k in range(4))


def vee(S):
    return sp.Matrix([S[2, 1], S[0, 2], S[1, 0]])


def skew(a):
    return sp.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def turn(axis, angle):
    """Matrix of components of a fixed vector before and after the frame turns about its axis."""
    c, s = sp.cos(angle), sp.sin(angle)
    j, k = axis % 3, (axis + 1) % 3
    C = sp.eye(3)
    C[j, j], C[k, k], C[j, k], C[k, j] = c, c, s, -s
    return C


def attitude(rng):
    return turn(1, function(rng)) * turn(2, function(rng)) * turn(3, function(rng))


def der(x, C=ONE):
    """Derivative of a vector as seen in the frame with the matrix C."""
    return x.diff(t) if C == ONE else C.T * (C * x).diff(t)


def omega(C):
    """Angular velocity of B in I, from the motion of its unit vectors."""
    rows = [C[k, :].T for k in range(3)]
    return sum((r.cross(r.diff(t)) for r in rows), sp.zeros(3, 1)) / 2


def value(x):
    """Numbers with many digits at the instant."""
    parts = x if isinstance(x, sp.MatrixBase) else sp.Matrix([sp.sympify(x)])
    return sp.Matrix(parts).applyfunc(lambda e: sp.sympify(e).subs(t, INSTANT).evalf(DIGITS))


def distance(pairs):
    """Largest difference of two sides, relative to their size."""
    worst = 0
    for left, right in pairs:
        a, b = value(left), value(right)
        size = 1 + max([abs(e) for e in a] + [abs(e) for e in b])
        worst = max([worst, *(abs(e) / size for e in a - b)])
    return worst


@dataclass(frozen=True)
class Masses:
    """Masses with their paths; ``inner``: force of j on i as ``inner[i][j]``."""

    masses: tuple
    places: tuple
    inner: tuple = ()

    @property
    def mass(self):
        return sum(self.masses)

    @property
    def centre(self):
        return self.over(lambda r: r) / self.mass

    def over(self, rule):
        """Sum of the masses times a quantity of their places."""
        parts = [m * rule(r) for m, r in zip(self.masses, self.places, strict=True)]
        return sum(parts[1:], parts[0])

    def force(self, i):
        """External force: what Newton's second law leaves for it."""
        total = self.masses[i] * self.places[i].diff(t, 2)
        return total - sum(self.inner[i], sp.zeros(3, 1)) if self.inner else total

    @property
    def outer(self):
        return sum((self.force(i) for i in range(len(self.masses))), sp.zeros(3, 1))

    def torque(self, about):
        arms = [(r - about).cross(self.force(i)) for i, r in enumerate(self.places)]
        return sum(arms, sp.zeros(3, 1))

    def momentum(self, about):
        """Angular momentum relative to a point: of the velocities relative to it."""
        return self.over(lambda r: (r - about).cross((r - about).diff(t)))

    def absolute(self, about):
        return self.over(lambda r: (r - about).cross(r.diff(t)))

    def inertia(self, about):
        return self.over(lambda r: (r - about).dot(r - about) * ONE - (r - about) * (r - about).T)

    @property
    def energy(self):
        return self.over(lambda r: r.diff(t).dot(r.diff(t))) / 2


NOWHERE = sp.zeros(3, 1)


def rigid(rng, C, origin=NOWHERE, principal=False):
    """A body that turns with a frame; ``origin``: path of the frame's origin.

    With ``principal`` the axes of the frame are principal ones at the origin, not at the centre alone.
    """
    if principal:
        ends = [[number(rng) if k == j else 0 for k in range(3)] for j in range(3)]
        points = [sp.Matrix(p) for p in ends] + [-sp.Matrix(p) / 2 for p in ends]
    else:
        points = [sp.Matrix([number(rng) for _ in range(3)]) for _ in range(4)]
    masses = tuple(abs(number(rng)) for _ in points)
    return Masses(masses, tuple(origin + C.T * p for p in points))


def draw(name):
    return random.Random(name)
