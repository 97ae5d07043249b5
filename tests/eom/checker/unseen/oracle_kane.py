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
b3 = u[1] * b[0] - u[0] * b[1]
away = arm.dot(arm) * sp.eye(3) - arm * arm.T
moved = body.inertia(x) + body.mass * away

CASES = {
    "E1": case(*((u[k], w.dot(b[k])) for k in range(3))),
    "E2": case((w, u[0] * b[0] + u[1] * b[1] + u[2] * b[2])),
    "E3": case((al, der(w, C)), (al, du[0] * b[0] + du[1] * b[1] + du[2] * b[2])),
    "E4": case((der(b[0]), w.cross(b[0])), (der(b[0]), u[2] * b[1] - u[1] * b[2])),
    "E5": case((der(b[1]), u[2] * b[0] - u[0] * b[2]), corrected=[(der(b[1]), b2)]),
    "E7": case((der(P), der(x) + vel)),
    "E8": case(
        (P.diff(t, 2), x.diff(t, 2) + al.cross(arm) + w.cross(al.cross(arm))),
        corrected=[(P.diff(t, 2), x.diff(t, 2) + al.cross(arm) + w.cross(vel))],
    ),
    # relative to A, the angular velocity comes from the matrix between the two frames
    "E10": case((w, wA + A.T * omega(C * A.T))),
    "E12": case(
        (al, der(wA) + der(relative, A) + relative.cross(wA)),
        corrected=[(al, der(wA) + der(relative, A) + wA.cross(relative))],
    ),
    "E14": case((body.inertia(x), sum((I[k] * b[k] * b[k].T for k in range(3)), sp.zeros(3, 3)))),
    "E16": case((H, body.inertia(x) * w), (H, spun)),
    "E18": case((Ts, -der(H))),
    "i13": case(*(((C * Ts)[k], Ts.dot(b[k])) for k in range(3))),
    "E19": case(((C * Ts)[0], -I[0] * du[0] + (I[1] - I[2]) * u[1] * u[2])),
    "E20": case(
        ((C * Ts)[1], -I[1] * du[1] + (I[0] - I[2]) * u[2] * u[0]),
        corrected=[((C * Ts)[1], -I[1] * du[1] + (I[2] - I[0]) * u[2] * u[0])],
    ),
    "i16": case(((C * T + C * Ts), sp.zeros(3, 1))),
    "E22": case((T_[0] - I[0] * du[0] + (I[1] - I[2]) * u[1] * u[2], 0)),
    "E23": case(
        (T_[2] - I[2] * du[2] + (I[0] + I[1]) * u[0] * u[1], 0),
        corrected=[(T_[2] - I[2] * du[2] + (I[0] - I[1]) * u[0] * u[1], 0)],
    ),
    "E24": case((w.dot(H) / 2, sum(I[k] * u[k] ** 2 for k in range(3)) / 2)),
    "E6": case((der(b[2]), u[1] * b[0] - u[0] * b[0]), corrected=[(der(b[2]), b3)]),
    "E9": case(
        (der(P.diff(t), C), P.diff(t, 2) + w.cross(P.diff(t))),
        corrected=[(der(P.diff(t), C), P.diff(t, 2) - w.cross(P.diff(t)))],
    ),
    "E11": case((A.T * omega(C * A.T), wA - w), corrected=[(A.T * omega(C * A.T), w - wA)]),
    "E13": case((der(w, A), al - w.cross(wA)), corrected=[(der(w, A), al + w.cross(wA))]),
    "E15": case((body.inertia(P), body.inertia(x) + away), corrected=[(body.inertia(P), moved)]),
    "E17": case(
        (der(H), body.inertia(x) * al + body.inertia(x) * w),
        corrected=[(der(H), body.inertia(x) * al + w.cross(body.inertia(x) * w))],
    ),
    "E21": case(
        ((C * Ts)[2], -I[2] * u[2] + (I[0] - I[1]) * u[0] * u[1]),
        corrected=[((C * Ts)[2], -I[2] * du[2] + (I[0] - I[1]) * u[0] * u[1])],
    ),
    "E25": case(
        ((w.dot(H) / 2).diff(t), T_[0] * u[0] + T_[1] * u[1] + T_[2] * u[1]),
        corrected=[((w.dot(H) / 2).diff(t), T_.dot(u))],
    ),
}
