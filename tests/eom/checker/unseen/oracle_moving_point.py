"""A body that changes its shape, and a rigid one; Q moves at will, or with the body."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    Masses,
    attitude,
    case,
    der,
    draw,
    number,
    omega,
    path,
    rigid,
    t,
)

_rng = draw("moving point")
any_ = Masses((2, 3, 5), tuple(path(_rng) for _ in range(3)))
Q, G, m = path(_rng), any_.centre, any_.mass
H, h, M = any_.absolute(Q), any_.momentum(Q), any_.torque(Q)
arm = G - Q
C = attitude(_rng)
w = omega(C)
x = path(_rng)
body = rigid(_rng, C, x)
q = x + C.T * sp.Matrix([number(_rng) for _ in range(3)])
IQ, c = body.inertia(q), body.centre
gyro = IQ * der(w, C) + w.cross(IQ * w)
still = rigid(_rng, C)
J = still.inertia(0 * x)
IG = body.inertia(c)
lever = c - q

CASES = {
    "E1": case((any_.over(lambda r: r - Q), m * arm)),
    "E2": case((H, any_.over(lambda r: (r - Q).cross(der(r))))),
    "E3": case((h, any_.over(lambda r: (r - Q).cross(der(r - Q))))),
    "i6": case((any_.places[0], Q + (any_.places[0] - Q))),
    "E4": case((H, h + m * arm.cross(der(Q)))),
    "E7": case(
        (der(H), M + der(Q).cross(m * der(G))), corrected=[(der(H), M - der(Q).cross(m * der(G)))]
    ),
    "E8": case((der(h), M - m * arm.cross(Q.diff(t, 2)))),
    "i10": case(
        (der(any_.momentum(G)), any_.torque(G)), (der(any_.momentum(0 * Q)), any_.torque(0 * Q))
    ),
    "E10": case(
        (M, any_.torque(G) + any_.outer.cross(arm)),
        corrected=[(M, any_.torque(G) + arm.cross(any_.outer))],
    ),
    "E11": case(
        (H, any_.momentum(G) + arm.cross(m * der(G))),
        (h, any_.momentum(G) + m * arm.cross(der(arm))),
    ),
    "E12": case((body.momentum(q), IQ * w)),
    "E16": case((J * der(w, C) + w.cross(J * w), still.torque(0 * x))),
    "E17": case((gyro + body.mass * (c - q).cross(q.diff(t, 2)), body.torque(q))),
    "E18": case(
        (body.energy, body.mass * der(q).dot(der(q)) / 2 + w.dot(IQ * w) / 2),
        corrected=[(body.energy, body.mass * der(c).dot(der(c)) / 2 + w.dot(IG * w) / 2)],
    ),
    "E5": case(
        (any_.over(lambda r: (r - Q).cross(der(Q))), arm.cross(der(Q))),
        corrected=[(any_.over(lambda r: (r - Q).cross(der(Q))), m * arm.cross(der(Q)))],
    ),
    "E6": case((H - h, m * der(Q).cross(arm)), corrected=[(H - h, m * arm.cross(der(Q)))]),
    "E9": case(
        (der(any_.momentum(G)), M + arm.cross(any_.outer)),
        corrected=[(der(any_.momentum(G)), M - arm.cross(any_.outer))],
    ),
    "E13": case(
        (IQ * w, IG * w + body.mass * lever.cross(lever.cross(w))),
        corrected=[(IQ * w, IG * w + body.mass * lever.cross(w.cross(lever)))],
    ),
    "E14": case((der(lever), lever.cross(w)), corrected=[(der(lever), w.cross(lever))]),
    "E15": case(
        (lever.diff(t, 2), der(w, C).cross(der(lever)) + w.cross(w.cross(lever))),
        corrected=[(lever.diff(t, 2), der(w, C).cross(lever) + w.cross(w.cross(lever)))],
    ),
    "E19": case(
        (body.energy, body.mass * der(c).dot(der(c)) / 2 + w.dot(body.momentum(c))),
        corrected=[(body.energy, body.mass * der(c).dot(der(c)) / 2 + w.dot(body.momentum(c)) / 2)],
    ),
}
