"""A point in a frame that moves at will, and an arm of two links as complex numbers would have it."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    attitude,
    case,
    cos,
    cut,
    der,
    draw,
    function,
    number,
    omega,
    path,
    sin,
    skew,
    t,
)

_rng = draw("arm")
C = attitude(_rng)
station = attitude(_rng)
R = C.T  # columns: axes of the tool
w = omega(C)
wT = cut(C * w)
O, P = path(_rng), path(_rng)
inside = cut(C * (P - O))
arm = P - O
still, moving = R * inside.diff(t), R * inside.diff(t, 2)


def _acceleration(coriolis):
    return (
        O.diff(t, 2)
        + moving
        + coriolis * w.cross(still)
        + der(w).cross(arm)
        + w.cross(w.cross(arm))
    )


one, two = function(_rng), function(_rng)
l1, l2, Fx, Fy = (abs(number(_rng)) for _ in range(4))
elbow = sp.Matrix([l1 * cos(one), l1 * sin(one)])
tip = elbow + l2 * sp.Matrix([cos(one + two), sin(one + two)])
x, y = tip
v = tip.diff(t)
rates = sp.Matrix([one.diff(t), two.diff(t)])
c1, s1, c12, s12 = cos(one), sin(one), cos(one + two), sin(one + two)
J = sp.Matrix([[-l1 * s1 - l2 * s12, -l2 * s12], [l1 * c1 + l2 * c12, l2 * c12]])
# a joint's torque is the moment of the force about it
moments = sp.Matrix([x * Fy - y * Fx, (x - elbow[0]) * Fy - (y - elbow[1]) * Fx])
sweep = x * v[1] - y * v[0]

CASES = {
    "E1": case((P, R * inside + O)),
    "E2": case((inside, R.T * P - O), corrected=[(inside, R.T * (P - O))]),
    "E3": case((R, station.T * (station * R))),
    "E4": case((C, station * (C * station.T)), corrected=[(C, (C * station.T) * station)]),
    "E5": case((R * R.T, sp.eye(3)), (R.T, C)),
    "E6": case((R.diff(t), skew(w) * R)),
    "E7": case((R.diff(t), skew(wT) * R), corrected=[(R.diff(t), R * skew(wT))]),
    "E8": case((w, R * wT)),
    "E9": case((skew(w), R.T * skew(wT) * R), corrected=[(skew(w), R * skew(wT) * R.T)]),
    "E10": case((P.diff(t), O.diff(t) + still + w.cross(arm))),
    "E11": case((P.diff(t, 2), _acceleration(1)), corrected=[(P.diff(t, 2), _acceleration(2))]),
    "E12": case((x, l1 * c1 + l2 * c12), (y, l1 * s1 + l2 * s12)),
    "E13": case((v[0], -l1 * s1 * rates[0] - l2 * s12 * (rates[0] + rates[1]))),
    "E14": case(
        (v[1], l1 * c1 * rates[0] + l2 * c12 * rates[1]),
        corrected=[(v[1], l1 * c1 * rates[0] + l2 * c12 * (rates[0] + rates[1]))],
    ),
    "E15": case((v, J * rates)),
    "E16": case((v, J * rates)),
    "E17": case((J.det(), l1 * l2 * s1), corrected=[(J.det(), l1 * l2 * sin(two))]),
    "E18": case((x**2 + y**2, l1**2 + l2**2 + 2 * l1 * l2 * cos(two))),
    "E19": case(
        (l1 * l2 * cos(two), x**2 + y**2 - l1**2 - l2**2),
        corrected=[(2 * l1 * l2 * cos(two), x**2 + y**2 - l1**2 - l2**2)],
    ),
    "E20": case((x * v[0] + y * v[1], -l1 * l2 * sin(two) * rates[1])),
    "E21": case(
        (sweep, tip.dot(tip) * rates[0] + (l2**2 + l1 * l2 * cos(two)) * two),
        corrected=[(sweep, tip.dot(tip) * rates[0] + (l2**2 + l1 * l2 * cos(two)) * rates[1])],
    ),
    "E22": case((moments, J.T * sp.Matrix([Fx, Fy]))),
    "E23": case(
        (moments[1], l2 * (c12 * Fy + s12 * Fx)),
        corrected=[(moments[1], l2 * (c12 * Fy - s12 * Fx))],
    ),
    "i17": case((elbow[0] / l1, c1)),
    "i18": case((y - elbow[1], l2 * s12)),
}
