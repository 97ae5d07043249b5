"""A satellite of small masses on a circular orbit: the torque is that of Newton's attraction.

To first order in the size of the satellite: the masses are 1e-25 of the orbit apart, with 120 digits, and
the torque is divided by the square of that. What remains of higher orders is below 1e-24.
"""

import mpmath as mp
import sympy as sp

from tests.eom.checker.unseen.motions import (
    attitude,
    case,
    central,
    constant,
    cos,
    cut,
    der,
    draw,
    number,
    omega,
    rigid,
    rounded,
    sin,
    skew,
    t,
)

_rng = draw("gravity gradient")
mu, R = sp.Rational(7, 3), sp.Rational(5, 4)
rate = rounded(sp.sqrt(mu / R**3))
# the orbit lies in the plane of x and z; its normal is -o2, o3 points down to the planet
along = rate * t + sp.Rational(1, 7)
place = R * sp.Matrix([cos(along), 0, sin(along)])
o3 = -place / R
o1 = place.diff(t) / (R * rate)
o2 = o3.cross(o1)
orbiting = cut(sp.Matrix.hstack(o1, o2, o3).T)
C = cut(attitude(_rng) * orbiting)
Cbo = cut(C * orbiting.T)
c1, c2, c3 = (Cbo[:, k] for k in range(3))
w = cut(C * omega(C))
wbo = w - C * omega(orbiting)
body = central(_rng, C, place)
I = constant(C * body.inertia(place) * C.T)
SIZE = mp.mpf(10) ** -25


def _attraction():
    """Torque of gravity on the masses about their centre, in body axes, in units of SIZE squared."""
    with mp.workdps(120):
        here = _numbers(place)
        arms = [_numbers(r - place) for r in body.places]
        masses = [mp.mpf(m) for m in body.masses]
        centre = [
            sum(m * a[k] for m, a in zip(masses, arms, strict=True)) / sum(masses) for k in range(3)
        ]
        total = mp.matrix(3, 1)
        for m, arm in zip(masses, arms, strict=True):
            arm = mp.matrix([x - c for x, c in zip(arm, centre, strict=True)]) * SIZE  # noqa: PLW2901
            r = mp.matrix(here) + arm
            force = -_number(mu) * m * r / mp.norm(r) ** 3
            total += mp.matrix(_cross(arm, force))
        inertial = sp.Matrix([sp.Float(str(x / SIZE**2), 60) for x in total])
    return C * inertial


def _number(x):
    return mp.mpf(str(sp.N(x, 110)))


def _numbers(v):
    return [_number(e.subs(t, 0)) for e in v]


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


# about the centre of mass, where the frame need not have its origin
_centre = body.centre
_Ic = constant(C * body.inertia(_centre) * C.T)
g = _attraction()
I3 = [_Ic[k, k] for k in range(3)]
euler = _Ic * w.diff(t) + skew(w) * _Ic * w
# a body that is free but for a torque: what Euler's law says of any motion
free = rigid(_rng, C, number(_rng) * place)
If = constant(C * free.inertia(free.centre) * C.T)
gf, hf = C * free.torque(free.centre), C * free.momentum(free.centre)
down = 3 * mu / R**3
spin = free.energy - free.mass * der(free.centre).dot(der(free.centre)) / 2

CASES = {
    "E1": case((rate**2 * place, -place.diff(t, 2)), (rate**2, mu / R**3)),
    "E3": case((g, down * skew(c3) * _Ic * c3)),
    "i10": case(*((c3[k], C[k, :].dot(o3)) for k in range(3))),
    "E5": case((g[0], 3 * rate**2 * (I3[2] - I3[1]) * c3[1] * c3[2])),
    "E6": case(
        (g[1], 3 * rate**2 * (I3[2] - I3[0]) * c3[2] * c3[0]),
        corrected=[(g[1], 3 * rate**2 * (I3[0] - I3[2]) * c3[2] * c3[0])],
    ),
    "E7": case(
        (g[2], rate**2 * (I3[1] - I3[0]) * c3[0] * c3[1]),
        corrected=[(g[2], 3 * rate**2 * (I3[1] - I3[0]) * c3[0] * c3[1])],
    ),
    "E9": case((c3.dot(g), 0)),
    "E10": case((c3.dot(c3), 1), (c2.dot(c3), 0)),
    "E11": case((skew(c1) * c2, -c3), corrected=[(skew(c1) * c2, c3)]),
    "E12": case((If * w.diff(t) + skew(w) * If * w, gf)),
    "E13": case(
        (hf, If * w),
        (hf.diff(t), skew(w) * hf + gf),
        corrected=[(hf, If * w), (hf.diff(t), -skew(w) * hf + gf)],
    ),
    "E14": case((c3.diff(t), -skew(wbo) * c3)),
    "E16": case((w, wbo - rate * c2)),
    "E17": case(
        (
            2 * (free.energy - free.mass * der(free.centre).dot(der(free.centre)) / 2),
            2 * w.dot(If * w),
        ),
        corrected=[
            (
                2 * (free.energy - free.mass * der(free.centre).dot(der(free.centre)) / 2),
                w.dot(If * w),
            )
        ],
    ),
    "E2": case((rate, sp.sqrt(mu / R**2)), corrected=[(rate, sp.sqrt(mu / R**3))]),
    "E4": case((g, down * skew(_Ic * c3) * c3), corrected=[(g, down * skew(c3) * _Ic * c3)]),
    "E8": case(
        (c3.dot(_Ic * c3), I3[0] * c3[0] ** 2 + I3[1] * c3[1] ** 2 + I3[2] * c3[1] ** 2),
        corrected=[(c3.dot(_Ic * c3), sum(I3[k] * c3[k] ** 2 for k in range(3)))],
    ),
    "E15": case((c1.diff(t), -skew(w) * c1), corrected=[(c1.diff(t), -skew(wbo) * c1)]),
    "E18": case((spin.diff(t), w.diff(t).dot(gf)), corrected=[(spin.diff(t), w.dot(gf))]),
}
