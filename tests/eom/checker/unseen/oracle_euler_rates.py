"""Angles 3-2-1 as functions of time; angular velocity from the motion of the unit vectors."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    case,
    cos,
    cut,
    draw,
    function,
    omega,
    sin,
    skew,
    t,
    turn,
)

_rng = draw("euler rates")
psi, theta, phi = (function(_rng) for _ in range(3))
C = cut(turn(1, phi) * turn(2, theta) * turn(3, psi))
w = cut(C * omega(C))
W = skew(w)
c, s = cos, sin
dpsi, dtheta, dphi = (a.diff(t) for a in (psi, theta, phi))
rates = sp.Matrix([dpsi, dtheta, dphi])
M2 = sp.Matrix([[c(theta), 0, s(theta)], [0, 1, 0], [-s(theta), 0, c(theta)]])
written = sp.Matrix(
    [
        [c(theta) * c(psi), c(theta) * s(psi), -s(theta)],
        [
            s(phi) * s(theta) * c(psi) - c(phi) * s(psi),
            s(phi) * s(theta) * s(psi) + c(phi) * c(psi),
            s(phi) * c(theta),
        ],
        [
            c(phi) * s(theta) * c(psi) + s(phi) * s(psi),
            c(phi) * s(theta) * s(psi) - s(phi) * c(psi),
            c(phi) * c(theta),
        ],
    ]
)
B = sp.Matrix([[-s(theta), 0, 1], [s(phi) * c(theta), c(phi), 0], [c(phi) * c(theta), -s(phi), 0]])
back = sp.Matrix(
    [
        [0, s(phi), c(phi)],
        [0, c(phi) * c(theta), -s(phi) * c(theta)],
        [c(theta), s(phi) * s(theta), c(phi) * s(theta)],
    ]
)
# how the components of a vector that does not move change when the frame turns by an angle
x = sp.Matrix([[c(phi), s(phi)], [-s(phi), c(phi)]])
M3 = sp.Matrix([[c(psi), s(psi), 0], [-s(psi), s(psi), 0], [0, 0, 1]])
M3_ = sp.Matrix([[c(psi), s(psi), 0], [-s(psi), c(psi), 0], [0, 0, 1]])
ddpsi, ddphi = dpsi.diff(t), dphi.diff(t)

CASES = {
    "i9": case((C, turn(1, phi) * turn(2, theta) * turn(3, psi))),
    "E1": case((turn(1, phi)[1:, 1:], x), (turn(1, phi)[0, :], sp.Matrix([[1, 0, 0]]))),
    "E2": case((turn(2, theta), M2), corrected=[(turn(2, theta), M2.T)]),
    "E4": case((C, written)),
    "E5": case((C * C.T, sp.eye(3))),
    "E7": case((w[0], dphi - dpsi * s(theta))),
    "E8": case(
        (w[1], dtheta * c(phi) + dpsi * c(theta) * c(phi)),
        corrected=[(w[1], dtheta * c(phi) + dpsi * c(theta) * s(phi))],
    ),
    "E9": case((w[2], -dtheta * s(phi) + dpsi * c(theta) * c(phi))),
    "E10": case((w, B * rates)),
    "E12": case((rates, back * w / c(theta))),
    "E13": case(
        (dtheta, w[1] * c(phi) + w[2] * s(phi)),
        corrected=[(dtheta, w[1] * c(phi) - w[2] * s(phi))],
    ),
    "E14": case((dphi, w[0] + (w[1] * s(phi) + w[2] * c(phi)) * s(theta) / c(theta))),
    "E17": case((C.diff(t), -W * C)),
    "E18": case((C.T.diff(t), -C.T * W), corrected=[(C.T.diff(t), C.T * W)]),
    "E19": case((W.T, W), corrected=[(W.T, -W)]),
    "E3": case((turn(3, psi), M3), corrected=[(turn(3, psi), M3_)]),
    "E6": case(
        (C.T, turn(1, phi).T * turn(2, theta).T * turn(3, psi).T),
        corrected=[(C.T, turn(3, psi).T * turn(2, theta).T * turn(1, phi).T)],
    ),
    "E11": case(
        (w.dot(w), rates.dot(rates) - dpsi * dphi * s(theta)),
        corrected=[(w.dot(w), rates.dot(rates) - 2 * dpsi * dphi * s(theta))],
    ),
    "E15": case(
        (dpsi * s(theta), w[1] * s(phi) + w[2] * c(phi)),
        corrected=[(dpsi * c(theta), w[1] * s(phi) + w[2] * c(phi))],
    ),
    "E16": case(
        (w[0].diff(t), ddphi - ddpsi * s(theta)),
        corrected=[(w[0].diff(t), ddphi - ddpsi * s(theta) - dpsi * dtheta * c(theta))],
    ),
    # a column is no matrix; nor are three of them side by side
    "E20": case((sp.Matrix.hstack(w, w, w), -C.diff(t) * C.T), corrected=[(W, -C.diff(t) * C.T)]),
}
