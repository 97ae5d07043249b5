"""Any vectors, a frame that turns at will, a particle and a moving origin."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    ONE,
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


def _twice(change):
    return (
        der(der(u, C), C) + 2 * w.cross(der(u, C)) + change * der(w).cross(u) + w.cross(w.cross(u))
    )


CASES = {
    "E1": case((der(u), der(u, C) + w.cross(u))),
    "E2": case((der(w), der(w, C))),
    "E3": case((der(b1), b1.cross(w)), corrected=[(der(b1), w.cross(b1))]),
    "E4": case((der(u, C), der(u) + back.cross(u)), (back, -w)),
    "E6": case((P, Q + r)),
    "E7": case((der(P), der(Q) + der(r, C) + w.cross(r))),
    "E9": case((P.diff(t, 2), _acceleration(1)), corrected=[(P.diff(t, 2), _acceleration(2))]),
    "E11": case(
        (
            (Q + _fixed).diff(t, 2),
            Q.diff(t, 2) + der(w).cross(_fixed) + w.cross(w.cross(_fixed)),
        )
    ),
    "E12": case((der(u.cross(v)), der(u).cross(v) + u.cross(der(v)))),
    "E13": case((u.dot(v).diff(t), der(u, C).dot(v) + u.dot(der(v, C)))),
    "E14": case(
        (u.dot(v).diff(t), der(u).dot(v) + u.dot(der(v, C))),
        corrected=[(u.dot(v).diff(t), der(u, C).dot(v) + u.dot(der(v, C)))],
    ),
    "E16": case((u.cross(v.cross(z)), v * u.dot(z) - z * v.dot(u))),
    "E17": case((skew(ub) * skew(vb) - skew(vb) * skew(ub), skew(C * u.cross(v)))),
    "E18": case(
        (_jacobi(z.cross(v.cross(u))), 0 * u), corrected=[(_jacobi(z.cross(u.cross(v))), 0 * u)]
    ),
    "E5": case((u.diff(t, 2), _twice(0)), corrected=[(u.diff(t, 2), _twice(1))]),
    "E8": case(
        (der(r, C), der(P) - der(Q) + w.cross(r)),
        corrected=[(der(r, C), der(P) - der(Q) - w.cross(r))],
    ),
    "E10": case(
        (P.diff(t, 2), _acceleration(0) + 2 * w.cross(der(r))),
        corrected=[(P.diff(t, 2), _acceleration(2))],
    ),
    "E15": case(
        (u.dot(u).diff(t), u.dot(der(u))), corrected=[(u.dot(u).diff(t), 2 * u.dot(der(u)))]
    ),
    "E19": case(
        (u.dot(v.cross(z)), v.dot(u.cross(z))), corrected=[(u.dot(v.cross(z)), v.dot(z.cross(u)))]
    ),
    "E20": case((skew(ub) * vb, skew(vb) * ub), corrected=[(skew(ub) * vb, -skew(vb) * ub)]),
    # a matrix less a number has no meaning; nor is it true with the number times the unit matrix
    "E21": case(
        (skew(ub.cross(vb)), vb * ub.T - ub.dot(vb) * ONE),
        corrected=[(skew(ub.cross(vb)), vb * ub.T - ub * vb.T)],
    ),
}
