"""A rigid body with yaw, pitch, roll as functions of time; with the controller, the torque it asks for."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    case,
    central,
    constant,
    cos,
    cut,
    der,
    draw,
    function,
    number,
    omega,
    path,
    rigid,
    sin,
    t,
    turn,
)

_rng = draw("control")
psi, theta, phi = (function(_rng) for _ in range(3))
C = cut(turn(1, phi) * turn(2, theta) * turn(3, psi))
w = omega(C)
w_ = cut(C * w)
u = path(_rng)
c, s = cos, sin
dpsi, dtheta, dphi = (a.diff(t) for a in (psi, theta, phi))


# half-angle product of the three turns, the scalar first
def _times(p, q):
    a, b = sp.Matrix(p[1:]), sp.Matrix(q[1:])
    return [cut(p[0] * q[0] - a.dot(b)), *cut(p[0] * b + q[0] * a + a.cross(b))]


def _half(axis, angle):
    q = [cos(angle / 2), 0, 0, 0]
    q[axis] = sin(angle / 2)
    return q


q = _times(_times(_half(3, psi), _half(2, theta)), _half(1, phi))
dq = [x.diff(t) for x in q]
along = q[1] * w_[0] + q[2] * w_[1] + q[3] * w_[2]
body = rigid(_rng, C, path(_rng))
G, m = body.centre, body.mass
F, M = body.outer, body.torque(G)
I = body.inertia(G)
h = I * w
Q = G + C.T * sp.Matrix([number(_rng) for _ in range(3)])
arm = Q - G
x = path(_rng)
rolled = central(_rng, C, x)
A = constant(C * rolled.inertia(rolled.centre) * C.T)
tau = C * rolled.torque(rolled.centre)
squares = sum(A[k, k] * w_[k] ** 2 for k in range(3))
spun = w_.dot(A * w_)
second = (A[2, 2] - A[0, 0]) * w_[0] * w_[2]

# under the controller, what Euler's equation leaves for the rate
k = abs(number(_rng))
Ib, w0 = constant(C * I * C.T), constant(w_)
damped = Ib.LUsolve(-k * w0 - w0.cross(Ib * w0))
energy_rate = w0.dot(Ib * damped)
square_rate = 2 * (Ib * w0).dot(Ib * damped)

CASES = {
    "E1": case(
        (C, turn(3, psi) * turn(2, theta) * turn(1, phi)),
        corrected=[(C, turn(1, phi) * turn(2, theta) * turn(3, psi))],
    ),
    "E2": case((u, C * (C * u)), corrected=[(u, C.T * (C * u))]),
    "E3": case(
        (w_[0], dphi - dpsi * s(theta)),
        (w_[1], dtheta * c(phi) + dpsi * c(theta) * s(phi)),
        (w_[2], dtheta * s(phi) + dpsi * c(theta) * c(phi)),
        corrected=[
            (w_[0], dphi - dpsi * s(theta)),
            (w_[1], dtheta * c(phi) + dpsi * c(theta) * s(phi)),
            (w_[2], -dtheta * s(phi) + dpsi * c(theta) * c(phi)),
        ],
    ),
    "E4": case((dq[0], -along / 2)),
    "E5": case(
        (dq[2], (q[0] * w_[1] + q[1] * w_[0] - q[1] * w_[2]) / 2),
        corrected=[(dq[2], (q[0] * w_[1] + q[3] * w_[0] - q[1] * w_[2]) / 2)],
    ),
    "E6": case((sum(x**2 for x in q), 1)),
    "E7": case(
        ((1 - q[0] ** 2).diff(t), q[0] * along / 2),
        corrected=[((1 - q[0] ** 2).diff(t), q[0] * along)],
    ),
    "E8": case((m * G.diff(t, 2), F)),
    "E9": case((I * der(w) + w.cross(I * w), M)),
    "E10": case((der(h, C), M + w.cross(h)), corrected=[(der(h, C), M - w.cross(h))]),
    "E11": case((A[0, 0] * w_[0].diff(t), (A[1, 1] - A[2, 2]) * w_[1] * w_[2] + tau[0])),
    "E12": case(
        (A[1, 1] * w_[1].diff(t), second - tau[1]),
        corrected=[(A[1, 1] * w_[1].diff(t), second + tau[1])],
    ),
    "E13": case((squares.diff(t), 2 * tau.dot(w_)), (squares, spun)),
    "E14": case((M, body.torque(Q) + arm.cross(F))),
    "E15": case((M, body.torque(Q) - arm.cross(F)), corrected=[(M, body.torque(Q) + arm.cross(F))]),
    "E16": case((Q.diff(t, 2), G.diff(t, 2) + der(w).cross(arm) + w.cross(w.cross(arm)))),
    "E17": case(
        ((Q.diff(t, 2) - G.diff(t, 2)).dot(arm), w.cross(arm).dot(w.cross(arm))),
        corrected=[((Q.diff(t, 2) - G.diff(t, 2)).dot(arm), -w.cross(arm).dot(w.cross(arm)))],
    ),
    "E18": case((energy_rate, -k * w0.dot(w0))),
    "E19": case(
        (square_rate, -k * (Ib * w0).dot(w0)), corrected=[(square_rate, -2 * k * (Ib * w0).dot(w0))]
    ),
    "i21": case((Ib * damped + w0.cross(Ib * w0), -k * w0)),
    "i24": case((body.momentum(G), h)),
}
