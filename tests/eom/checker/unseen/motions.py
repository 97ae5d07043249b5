"""Explicit motions of masses as functions of time, in SymPy: the ground on which notes are judged.

Vectors are columns of components in the inertial frame; ``C`` maps components in I to components in B.
Functions of time are polynomials in t with `PLACES` decimal places, those of angles their expansions about
t = 0, where everything is compared; no more derivatives are taken than their `ORDER`. Nothing of `eom`
is used.
"""

import random
from dataclasses import dataclass

import mpmath as mp
import sympy as sp

t = sp.Symbol("t", real=True)
ORDER, PLACES, DIGITS = 3, 50, 40
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


def cut(x):
    """A polynomial in t without what is beyond the order."""
    if isinstance(x, sp.MatrixBase):
        return x.applyfunc(cut)
    terms = sp.Poly(x, t).terms()
    return sum((rounded(c) * t ** k[0] for k, c in terms if k[0] <= ORDER), sp.Integer(0))


def rounded(c):
    unit = sp.Integer(10) ** PLACES
    return sp.Rational(int(sp.floor(sp.N(c, PLACES + 20) * unit)), unit)


def constant(x):
    """The value at the instant, as a number or a matrix of numbers."""
    return (
        x.applyfunc(constant)
        if isinstance(x, sp.MatrixBase)
        else rounded(x.xreplace({t: sp.Integer(0)}))
    )


def cos(angle):
    return _expanded(angle, sp.cos)


def sin(angle):
    return _expanded(angle, sp.sin)


def _expanded(angle, function):
    """A sine or cosine by its expansion about the value of the angle at t = 0."""
    angle, x = sp.sympify(angle), sp.Symbol("x")
    first, total, power = angle.subs(t, 0), sp.Integer(0), sp.Integer(1)
    for k in range(ORDER + 1):
        slope = function(x).diff(x, k).subs(x, first) if k else function(first)
        total += rounded(slope) / sp.factorial(k) * power
        power = cut(power * (angle - first))
    return cut(total)


def skew(a):
    return sp.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def turn(axis, angle):
    """Matrix of components of a fixed vector before and after the frame turns about its axis."""
    c, s = cos(angle), sin(angle)
    j, k = axis % 3, (axis + 1) % 3
    C = sp.eye(3)
    C[j, j], C[k, k], C[j, k], C[k, j] = c, c, s, -s
    return C


def attitude(rng):
    return cut(turn(1, function(rng)) * turn(2, function(rng)) * turn(3, function(rng)))


def der(x, C=ONE):
    """Derivative of a vector as seen in the frame with the matrix C."""
    return x.diff(t) if C == ONE else C.T * cut(C * x).diff(t)


def omega(C):
    """Angular velocity of B in I, from the motion of its unit vectors."""
    rows = [C[k, :].T for k in range(3)]
    return cut(sum((r.cross(r.diff(t)) for r in rows), sp.zeros(3, 1)) / 2)


def integral(f, low, high):
    """The integral of a function of a number, as a number with many digits."""
    with mp.workdps(PLACES):
        found = mp.quad(lambda x: mp.mpf(f(x)), [number_with_digits(low), number_with_digits(high)])
        return sp.Float(str(found), DIGITS)


def number_with_digits(x):
    return mp.mpf(str(sp.N(x, PLACES)))


def value(x):
    """Numbers with many digits at the instant."""
    parts = x if isinstance(x, sp.MatrixBase) else sp.Matrix([sp.sympify(x)])
    return sp.Matrix(parts).applyfunc(
        lambda e: sp.sympify(e).xreplace({t: sp.Integer(0)}).evalf(DIGITS)
    )


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
        return cut(self.over(lambda r: r) / self.mass)

    def over(self, rule):
        """Sum of the masses times a quantity of their places."""
        parts = [m * rule(r) for m, r in zip(self.masses, self.places, strict=True)]
        return sum(parts[1:], parts[0])

    def force(self, i):
        """External force: what Newton's second law leaves for it."""
        total = self.masses[i] * self.places[i].diff(t, 2)
        return cut(total - sum(self.inner[i], sp.zeros(3, 1)) if self.inner else total)

    @property
    def outer(self):
        return sum((self.force(i) for i in range(len(self.masses))), sp.zeros(3, 1))

    def torque(self, about):
        arms = [(r - about).cross(self.force(i)) for i, r in enumerate(self.places)]
        return cut(sum(arms, sp.zeros(3, 1)))

    def momentum(self, about):
        """Angular momentum relative to a point: of the velocities relative to it."""
        return cut(self.over(lambda r: (r - about).cross((r - about).diff(t))))

    def absolute(self, about):
        return cut(self.over(lambda r: (r - about).cross(r.diff(t))))

    def inertia(self, about):
        arms = (r - about for r in self.places)
        parts = (m * (a.dot(a) * ONE - a * a.T) for m, a in zip(self.masses, arms, strict=True))
        return cut(sum(parts, sp.zeros(3, 3)))

    @property
    def energy(self):
        return cut(self.over(lambda r: r.diff(t).dot(r.diff(t))) / 2)


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
    return Masses(masses, tuple(cut(origin + C.T * p) for p in points))


def central(rng, C, origin):
    """A body whose frame has principal axes at its origin, the centre of mass."""
    ends = [sp.Matrix([number(rng) if k == j else 0 for k in range(3)]) for j in range(3)]
    places = tuple(cut(origin + sign * C.T * p) for sign in (1, -1) for p in ends)
    return Masses((2, 3, 5) * 2, places)


def draw(name):
    return random.Random(name)
