"""Rodrigues parameters from an axis and an angle that change with time."""

from tests.eom.checker.unseen.motions import (
    ONE,
    case,
    constant,
    cos,
    cut,
    draw,
    omega,
    rigid,
    sin,
    skew,
    t,
)
from tests.eom.checker.unseen.oracle_quaternions import C, Phi, a, b

q = a * sin(Phi / 2) / cos(Phi / 2)
dq = q.diff(t)
w = cut(C * omega(C))
Q, W = skew(q), skew(w)
one = 1 + q.dot(q)
body = rigid(draw("rodrigues"), C)
H_ = body.momentum(body.centre)
I = constant(C * body.inertia(body.centre) * C.T)
H = I * w


def _times(sign):
    """The matrix with a sign times the other one; on the left the factor that was inverted."""
    return C * (ONE + Q), ONE + sign * Q


torque = C * body.torque(body.centre)

CASES = {
    "E1": case((q * (1 + cos(Phi)), a * sin(Phi))),
    "i5": case(*((q[k], b[k + 1] / b[0]) for k in range(3))),
    "i6": case((q.dot(q), (1 - cos(Phi)) / (1 + cos(Phi)))),
    "E3": case((one * C, (1 - q.dot(q)) * ONE + 2 * q * q.T - 2 * Q)),
    "E4": case(_times(1), corrected=[_times(-1)]),
    "E5": case((C.T - C, 4 * Q / one)),
    "E7": case((Q * Q, q * q.T + q.dot(q) * ONE), corrected=[(Q * Q, q * q.T - q.dot(q) * ONE)]),
    "i7": case((Q * q, 0 * q)),
    "E8": case((dq, (ONE + Q + q * q.T) * w / 2)),
    "E10": case((w, 2 * (ONE + Q) * dq / one), corrected=[(w, 2 * (ONE - Q) * dq / one)]),
    "E11": case((q.dot(q).diff(t), one * q.dot(w))),
    "E12": case((C.diff(t) * C.T, -W)),
    "E13": case(((C.T * w).diff(t), C.T * w.diff(t))),
    "i9": case((C * H_, H)),
    "E14": case(
        ((C.T * H).diff(t), C.T * (H.diff(t) - W * H)),
        corrected=[((C.T * H).diff(t), C.T * (H.diff(t) + W * H))],
    ),
    "E2": case((one * sin(Phi / 2) ** 2, 1), corrected=[(one * cos(Phi / 2) ** 2, 1)]),
    "E6": case((one * C.trace(), 3 + q.dot(q)), corrected=[(one * C.trace(), 3 - q.dot(q))]),
    "E9": case(
        (2 * dq, w + q.cross(w) + q.dot(w) * w), corrected=[(2 * dq, w + q.cross(w) + q.dot(w) * q)]
    ),
    "E15": case(
        ((C.T * I * C).diff(t), C.T * (W * I + I * W) * C),
        corrected=[((C.T * I * C).diff(t), C.T * (W * I - I * W) * C)],
    ),
    "E16": case(
        (I * w.diff(t), torque - I * W * w), corrected=[(I * w.diff(t), torque - W * I * w)]
    ),
}
