"""A disc that turns by three angles as functions of time; its centre moves at will, or the disc rolls."""

import mpmath as mp
import sympy as sp

from tests.eom.checker.unseen.motions import (
    Masses,
    case,
    constant,
    cos,
    cut,
    der,
    draw,
    function,
    integral,
    number,
    number_with_digits,
    omega,
    path,
    sin,
    t,
    turn,
)

_rng = draw("wheel")
psi, theta, phi = (function(_rng) for _ in range(3))
B = cut(turn(1, theta) * turn(3, psi))
D = cut(turn(2, phi) * B)
b = [B[k, :].T for k in range(3)]
e3 = sp.Matrix([0, 0, 1])
wB, wD = omega(B), omega(D)
w = cut(B * wD)
c, s = cos(theta), sin(theta)
dpsi, dtheta, dphi = (a.diff(t) for a in (psi, theta, phi))
R = abs(number(_rng))


def _disc(centre):
    """Four masses on the rim, two on the axle."""
    ends = [(R, 0, 0), (-R, 0, 0), (0, 0, R), (0, 0, -R), (0, 1, 0), (0, -1, 0)]
    masses = (sp.Rational(7, 5),) * 4 + (sp.Rational(1, 3),) * 2
    return Masses(masses, tuple(cut(centre + D.T * sp.Matrix(p)) for p in ends))


body = _disc(path(_rng))
G = body.centre
h, tau = body.momentum(G), B * body.torque(G)
I = constant(B * body.inertia(G) * B.T)
It, Ia = I[0, 0], I[1, 1]
spin = body.energy - body.mass * G.diff(t).dot(G.diff(t)) / 2
turned = It * dtheta**2, Ia * (dphi + dpsi * s) ** 2
third = It * w[2].diff(t) + Ia * dtheta * w[1]
# the path of a centre whose velocity is such that the lowest point of the disc has none
centre = cut(R * wD.cross(b[2])).applyfunc(lambda f: sp.integrate(f, t))
v = cut(centre.diff(t))
x = sp.Symbol("x")
a, m = abs(number(_rng)), sp.Rational(7, 5)


def _strip(y):
    """Of a strip across the disc at the distance y from the middle: its length times the square of y."""
    return y**2 * mp.sqrt(number_with_digits(a) ** 2 - y**2)


CASES = {
    "E1": case((B, turn(1, theta) * turn(3, psi)), (B * e3, sp.Matrix([0, s, c]))),
    "E2": case((e3, c * b[2] - s * b[1]), corrected=[(e3, c * b[2] + s * b[1])]),
    "E3": case((wB, dpsi * e3 + dtheta * b[0])),
    "E4": case((wD, wB - dphi * b[1]), corrected=[(wD, wB + dphi * b[1])]),
    "E5": case((w, sp.Matrix([dtheta, dphi + dpsi * s, dpsi * c]))),
    "E6": case(
        (wB, dtheta * b[0] + dpsi * c * b[1] + dpsi * c * b[2]),
        corrected=[(wB, dtheta * b[0] + dpsi * s * b[1] + dpsi * c * b[2])],
    ),
    "E7": case((der(b[1]), wB.cross(b[1]))),
    "E8": case(
        (der(b[1]), dtheta * b[2] + dpsi * c * b[0]),
        corrected=[(der(b[1]), dtheta * b[2] - dpsi * c * b[0])],
    ),
    "E9": case(
        (
            der(wD),
            dpsi.diff(t) * e3
            + dtheta.diff(t) * b[0]
            + dphi.diff(t) * b[1]
            + wB.cross(dtheta * b[0] + dphi * b[1]),
        )
    ),
    "E10": case(
        (w[1].diff(t), dphi.diff(t) + dpsi.diff(t) * s),
        corrected=[(w[1].diff(t), dphi.diff(t) + dpsi.diff(t) * s + dpsi * dtheta * c)],
    ),
    "E11": case((h, It * (w[0] * b[0] + w[2] * b[2]) + Ia * w[1] * b[1])),
    "E12": case((der(h), der(h, B) + wD.cross(h)), corrected=[(der(h), der(h, B) + wB.cross(h))]),
    "E13": case((It * w[0].diff(t) + It * dpsi * s * w[2] - Ia * dpsi * c * w[1], tau[0])),
    "E14": case((Ia * w[1].diff(t), tau[1])),
    "E15": case(
        (third - It * dpsi * s * w[1], tau[2]), corrected=[(third - It * dpsi * s * w[0], tau[2])]
    ),
    "E16": case((body.energy, body.mass * der(G).dot(der(G)) / 2 + spin)),
    "E17": case(
        (2 * spin, turned[0] + It * dpsi**2 * c + turned[1]),
        corrected=[(2 * spin, turned[0] + It * dpsi**2 * c**2 + turned[1])],
    ),
    # in strips across one diameter and the other, for the integral over rings
    "E18": case(
        (
            m / (sp.pi * a**2) * 4 * integral(_strip, -a, a),
            sp.integrate(2 * m / a**2 * x**3, (x, 0, a)),
        ),
        (sp.integrate(2 * m / a**2 * x**3, (x, 0, a)), m * a**2 / 2),
    ),
    "E19": case((v - wD.cross(R * b[2]), sp.zeros(3, 1))),
    "E20": case((v, R * (w[1] * b[0] - w[0] * b[1]))),
    "E21": case(
        (v.dot(v), R**2 * (w[0] ** 2 + w[2] ** 2)),
        corrected=[(v.dot(v), R**2 * (w[0] ** 2 + w[1] ** 2))],
    ),
    "E22": case(
        (v.diff(t), R * der(wD).cross(b[2])),
        corrected=[(v.diff(t), R * der(wD).cross(b[2]) + R * wD.cross(wB.cross(b[2])))],
    ),
}
