"""A gyrostat: a carrier and two rotors, each a ring of masses that turns about an axis of the carrier."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    Masses,
    attitude,
    case,
    cut,
    der,
    draw,
    function,
    number,
    omega,
    path,
    t,
    turn,
)

_rng = draw("gyrostat")
C = attitude(_rng)
w = omega(C)
x = path(_rng)


def _rotor():
    """Masses in the carrier, the moment of inertia about the axis, the axis, and the spin."""
    base = turn(1, number(_rng)) * turn(3, number(_rng))
    angle, mass, a, b = function(_rng), abs(number(_rng)), number(_rng), number(_rng)
    middle = sp.Matrix([number(_rng) for _ in range(3)])
    S = cut(turn(3, angle) * base)
    ring = [(a, b, 1), (-b, a, 1), (-a, -b, 1), (b, -a, 1)]
    places = [middle + S.T * sp.Matrix(p) for p in ring]
    return [(mass, p) for p in places], 4 * mass * (a**2 + b**2), base[2, :].T, angle.diff(t)


_rotors = [_rotor() for _ in range(2)]
_carrier = [(abs(number(_rng)), sp.Matrix([number(_rng) for _ in range(3)])) for _ in range(3)]
_all = [*_carrier, *(part for rotor in _rotors for part in rotor[0])]
body = Masses(tuple(m for m, _ in _all), tuple(cut(x + C.T * p) for _, p in _all))
G = body.centre
h, M, IG = body.momentum(G), body.torque(G), body.inertia(G)
s = [cut(C.T * rotor[2]) for rotor in _rotors]
J = [rotor[1] for rotor in _rotors]
spin = [rotor[3] for rotor in _rotors]
hs = J[0] * spin[0] * s[0] + J[1] * spin[1] * s[1]
ds = J[0] * spin[0].diff(t) * s[0] + J[1] * spin[1].diff(t) * s[1]
_ring = Masses(body.masses[3:7], body.places[3:7])
h1 = s[0].dot(_ring.momentum(_ring.centre))
turned = J[0] * spin[0] * s[0].cross(w) + J[1] * spin[1] * s[1].cross(w)
still = (der(s[0], C), 0 * w)

CASES = {
    "E1": case((h, IG * w + hs)),
    "E2": case((hs, hs)),
    "E3": case(still, (der(s[0]), s[0].cross(w)), corrected=[still, (der(s[0]), w.cross(s[0]))]),
    "E4": case((der(h), M)),
    "E5": case((der(h), der(h, C) + w.cross(h))),
    "E6": case(
        (IG * der(w, C) + ds + w.cross(IG * w), M),
        corrected=[(IG * der(w, C) + ds + w.cross(IG * w + hs), M)],
    ),
    "E7": case((der(hs, C), ds)),
    "E9": case((der(hs), ds + turned), corrected=[(der(hs), ds - turned)]),
    "E10": case((h1, J[0] * (spin[0] + s[0].dot(w)))),
    "E12": case(
        ((J[0] * spin[0] ** 2).diff(t), J[0] * spin[0] * spin[0].diff(t)),
        corrected=[((J[0] * spin[0] ** 2).diff(t), 2 * J[0] * spin[0] * spin[0].diff(t))],
    ),
    "E15": case((h.dot(h).diff(t), 2 * h.dot(M))),
    "E16": case((der(h, C), M + w.cross(h)), corrected=[(der(h, C), M - w.cross(h))]),
    "E8": case(
        (IG * der(w, C) + der(hs, C) + w.cross(IG * w) + hs.cross(w), M),
        corrected=[(IG * der(w, C) + der(hs, C) + w.cross(IG * w) + w.cross(hs), M)],
    ),
    "E11": case(
        (h1.diff(t), J[0] * (spin[0].diff(t) + s[0].dot(w))),
        corrected=[(h1.diff(t), J[0] * (spin[0].diff(t) + s[0].dot(der(w, C))))],
    ),
    "E13": case(
        (w.dot(h), w.dot(IG * w) + 2 * hs.dot(w)), corrected=[(w.dot(h), w.dot(IG * w) + hs.dot(w))]
    ),
    "E14": case(
        (s[0].dot(h).diff(t), s[0].dot(M) + h.dot(s[0].cross(w))),
        corrected=[(s[0].dot(h).diff(t), s[0].dot(M) + h.dot(w.cross(s[0])))],
    ),
}
