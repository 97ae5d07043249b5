"""Integrals by SymPy in Cartesian or other coordinates than those of the note; theorems on masses."""

import mpmath as mp
import sympy as sp

from tests.eom.checker.unseen.motions import (
    Masses,
    attitude,
    case,
    draw,
    integral,
    number,
    number_with_digits,
)

_rng = draw("solids")
a, b, c, h, R, rho, L = (abs(number(_rng)) for _ in range(7))
x, y, z, r = sp.symbols("x y z r", real=True)
m = sp.Rational(7, 5)


def box(f, p, q, k):
    """Integral over a box about the origin."""
    inside = sp.integrate(f, (x, -p / 2, p / 2), (y, -q / 2, q / 2), (z, -k / 2, k / 2))
    return sp.simplify(inside)


def disc(power):
    """Integral of a power of the distance over a disc of radius a, as rings."""
    return sp.integrate(2 * sp.pi * r * r**power, (r, 0, a))


_cylinder = m / (sp.pi * a**2 * h)
# slices: each a disc, about its own diameter, moved away from the middle
_slice = sp.integrate(sp.pi * a**4 / 4 + sp.pi * a**2 * z**2, (z, -h / 2, h / 2))
_sphere = m / (sp.Rational(4, 3) * sp.pi * R**3)
_discs = sp.integrate(sp.pi * (R**2 - z**2) ** 2 / 2, (z, -R, R))
_box = m / (a * b * c)
rod = sp.integrate(m / L * x**2, (x, -L / 2, L / 2))
end = sp.integrate(m / L * x**2, (x, 0, L))
steiner = m * L**2 / 12 + m * (L / 2) ** 2
mass = _cylinder * disc(0) * h
Ixx, Iyy, Izz = (_box * box(f, a, b, c) for f in (y**2 + z**2, x**2 + z**2, x**2 + y**2))
about_z = rho * box(x**2 + y**2, a, b, c)

_points = [sp.Matrix([number(_rng) for _ in range(3)]) for _ in range(4)]
body = Masses((2, 3, 4, 1), tuple(_points))
d = body.centre - 0 * body.centre
I, IP, M = body.inertia(body.centre), body.inertia(0 * d), body.mass
A = attitude(_rng)
I_ = Masses(body.masses, tuple(A * p for p in _points))
moved = I_.inertia(I_.centre)
unit = sp.eye(3)


def _strip(y):
    """The moment about the edge of a strip of the disc at the distance y from the line to the edge."""
    radius = number_with_digits(a)
    half = mp.sqrt(radius**2 - y**2)
    return 2 * half * (y - radius) ** 2 + 2 * half**3 / 3


edge = _cylinder * h * integral(_strip, -a, a)
# points of the ring about the z-axis, at the angle x
ring = sp.integrate(m / (2 * sp.pi) * (sp.cos(x) ** 2 + sp.sin(x) ** 2) * a**2, (x, 0, 2 * sp.pi))

CASES = {
    "E1": case(
        (about_z, sp.integrate(rho * c * (x**2 + y**2), (y, -b / 2, b / 2), (x, -a / 2, a / 2)))
    ),
    "E2": case((rod, m * L**2 / 12)),
    "E3": case(
        (end, steiner), (end, m * L**2 / 4), corrected=[(end, steiner), (end, m * L**2 / 3)]
    ),
    "E4": case((rho * h * disc(0), sp.pi * rho * a**2 * h), (mass, m)),
    "E5": case(
        (_cylinder * h * disc(2), _cylinder * h * disc(1)),
        (_cylinder * h * disc(2), m * a**2 / 2),
        corrected=[
            (_cylinder * h * disc(2), _cylinder * h * 2 * sp.pi * sp.integrate(r**3, (r, 0, a))),
            (_cylinder * h * disc(2), m * a**2 / 2),
        ],
    ),
    "E6": case((_cylinder * _slice, m * (3 * a**2 + h**2) / 12)),
    "E9": case((Ixx + Iyy + Izz, 2 * _box * box(x**2 + y**2 + z**2, a, b, c))),
    "E10": case(
        (3 * rho * _discs, 2 * rho * sp.integrate(4 * sp.pi * r**4, (r, 0, R))),
        (3 * rho * _discs, sp.Rational(8, 5) * sp.pi * rho * R**5),
    ),
    "i14": case(
        (rho * sp.integrate(sp.pi * (R**2 - z**2), (z, -R, R)), 4 * sp.pi * rho * R**3 / 3)
    ),
    "E11": case(
        (_sphere * _discs, 2 * m * R**2 / 3), corrected=[(_sphere * _discs, 2 * m * R**2 / 5)]
    ),
    "E12": case(
        (Ixx, m * (b**2 + c**2) / 12),
        (Iyy, m * (a**2 + c**2) / 12),
        (Izz, m * (a**2 - b**2) / 12),
        corrected=[
            (Ixx, m * (b**2 + c**2) / 12),
            (Iyy, m * (a**2 + c**2) / 12),
            (Izz, m * (a**2 + b**2) / 12),
        ],
    ),
    "E13": case(
        (IP, I + M * (d.dot(d) * unit + d * d.T)),
        corrected=[(IP, I + M * (d.dot(d) * unit - d * d.T))],
    ),
    "E15": case((IP.trace(), 2 * body.over(lambda p: p.dot(p)))),
    "E16": case((moved, A.T * I * A), corrected=[(moved, A * I * A.T)]),
    "E7": case(
        (edge, _cylinder * h * disc(2) + m * a**2),
        (edge, sp.Rational(5, 4) * m * a**2),
        corrected=[
            (edge, _cylinder * h * disc(2) + m * a**2),
            (edge, sp.Rational(3, 2) * m * a**2),
        ],
    ),
    "E8": case((ring, m * a), corrected=[(ring, m * a**2)]),
    "E14": case(
        (I, IP + M * (d.dot(d) * unit - d * d.T)),
        corrected=[(I, IP - M * (d.dot(d) * unit - d * d.T))],
    ),
}
