"""A rigid body with a point P fixed in it, an intermediate frame A, and central principal axes."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    attitude,
    case,
    central,
    constant,
    cut,
    der,
    draw,
    number,
    omega,
    path,
    t,
)

_rng = draw("kane")
A = attitude(_rng)
C = attitude(_rng)
w, wA = omega(C), omega(A)
relative = w - wA
u = cut(C * w)
b = [C[k, :].T for k in range(3)]
x = path(_rng)
body = central(_rng, C, x)
arm = C.T * sp.Matrix([number(_rng) for _ in range(3)])
P = x + arm
al = der(w)
I = [constant(C * body.inertia(x) * C.T)[k, k] for k in range(3)]
H, T = body.momentum(x), body.torque(x)
Ts = -body.inertia(x) * al - w.cross(body.inertia(x) * w)
spun = sum((I[k] * u[k] * b[k] for k in range(3)), sp.zeros(3, 1))
T_, du = C * T, u.diff(t)
vel = w.cross(arm)
b2 = u[0] * b[2] - u[2] * b[0]

CASES = {
    "E1": case(*((u[k], w.dot(b[k])) for k in range(3))),
    "E2": case((w, u[0] * b[0] + u[1] * b[1] + u[2] * b[2])),
    "E3": case((al, der(w, C)), (al, du[0] * b[0] + du[1] * b[1] + du[2] * b[2])),
    "E4": case((der(b[0]), w.cross(b[0])), (der(b[0]), u[2] * b[1] - u[1] * b[2])),
    "E5": case((der(b[1]), u[2] * b[0] - u[0] * b[2]), corrected=[(der(b[1]), b2)]),
    "E6": case((der(P), der(x) + vel)),
    "E7": case(
        (P.diff(t, 2), x.diff(t, 2) + al.cross(arm) + w.cross(al.cross(arm))),
        corrected=[(P.diff(t, 2), x.diff(t, 2) + al.cross(arm) + w.cross(vel))],
    ),
    # relative to A, the angular velocity comes from the matrix between the two frames
    "E8": case((w, wA + A.T * omega(C * A.T))),
    "E9": case(
        (al, der(wA) + der(relative, A) + relative.cross(wA)),
        corrected=[(al, der(wA) + der(relative, A) + wA.cross(relative))],
    ),
    "E10": case((body.inertia(x), sum((I[k] * b[k] * b[k].T for k in range(3)), sp.zeros(3, 3)))),
    "E11": case((H, body.inertia(x) * w), (H, spun)),
    "E12": case((Ts, -der(H))),
    "i10": case(*(((C * Ts)[k], Ts.dot(b[k])) for k in range(3))),
    "E13": case(((C * Ts)[0], -I[0] * du[0] + (I[1] - I[2]) * u[1] * u[2])),
    "E14": case(
        ((C * Ts)[1], -I[1] * du[1] + (I[0] - I[2]) * u[2] * u[0]),
        corrected=[((C * Ts)[1], -I[1] * du[1] + (I[2] - I[0]) * u[2] * u[0])],
    ),
    "i13": case(((C * T + C * Ts), sp.zeros(3, 1))),
    "E15": case((T_[0] - I[0] * du[0] + (I[1] - I[2]) * u[1] * u[2], 0)),
    "E16": case(
        (T_[2] - I[2] * du[2] + (I[0] + I[1]) * u[0] * u[1], 0),
        corrected=[(T_[2] - I[2] * du[2] + (I[0] - I[1]) * u[0] * u[1], 0)],
    ),
    "E17": case((w.dot(H) / 2, sum(I[k] * u[k] ** 2 for k in range(3)) / 2)),
}
