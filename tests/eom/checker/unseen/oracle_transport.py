"""Any vectors, a frame that turns at will, a particle and a moving origin."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    attitude,
    case,
    der,
    draw,
    number,
    omega,
    path,
    skew,
    t,
)

_rng = draw("transport")
C = attitude(_rng)
w = omega(C)
u, v, z = (path(_rng) for _ in range(3))
Q, P = path(_rng), path(_rng)
r = P - Q
b1 = C[0, :].T
ub, vb = C * u, C * v
# of I as seen from B: the frames exchanged
back = C.T * omega(C.T)


def _acceleration(coriolis):
    return (
        Q.diff(t, 2)
        + der(der(r, C), C)
        + coriolis * w.cross(der(r, C))
        + der(w).cross(r)
        + w.cross(w.cross(r))
    )


_fixed = C.T * sp.Matrix([number(_rng) for _ in range(3)])


def _jacobi(last):
    return u.cross(v.cross(z)) + v.cross(z.cross(u)) + last


CASES = {
    "E1": case((der(u), der(u, C) + w.cross(u))),
    "E2": case((der(w), der(w, C))),
    "E3": case((der(b1), b1.cross(w)), corrected=[(der(b1), w.cross(b1))]),
    "E4": case((der(u, C), der(u) + back.cross(u)), (back, -w)),
    "E5": case((P, Q + r)),
    "E6": case((der(P), der(Q) + der(r, C) + w.cross(r))),
    "E7": case((P.diff(t, 2), _acceleration(1)), corrected=[(P.diff(t, 2), _acceleration(2))]),
    "E8": case(
        (
            (Q + _fixed).diff(t, 2),
            Q.diff(t, 2) + der(w).cross(_fixed) + w.cross(w.cross(_fixed)),
        )
    ),
    "E9": case((der(u.cross(v)), der(u).cross(v) + u.cross(der(v)))),
    "E10": case((u.dot(v).diff(t), der(u, C).dot(v) + u.dot(der(v, C)))),
    "E11": case(
        (u.dot(v).diff(t), der(u).dot(v) + u.dot(der(v, C))),
        corrected=[(u.dot(v).diff(t), der(u, C).dot(v) + u.dot(der(v, C)))],
    ),
    "E12": case((u.cross(v.cross(z)), v * u.dot(z) - z * v.dot(u))),
    "E13": case((skew(ub) * skew(vb) - skew(vb) * skew(ub), skew(C * u.cross(v)))),
    "E14": case(
        (_jacobi(z.cross(v.cross(u))), 0 * u), corrected=[(_jacobi(z.cross(u.cross(v))), 0 * u)]
    ),
}
