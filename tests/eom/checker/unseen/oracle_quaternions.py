"""An axis and an angle as functions of time; the matrix is that of Rodrigues' rotation of vectors."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    ONE,
    case,
    cos,
    cut,
    draw,
    function,
    omega,
    sin,
    skew,
    t,
)

_rng = draw("quaternions")
azimuth, height, Phi = (function(_rng) for _ in range(3))
a = sp.Matrix(
    [
        cos(azimuth) * cos(height),
        sin(azimuth) * cos(height),
        sin(height),
    ]
)
# the body is turned by Phi about a: v' = v cos + a x v sin + a (a.v)(1 - cos); C takes it back
turned = cos(Phi) * ONE + sin(Phi) * skew(a) + (1 - cos(Phi)) * a * a.T
C = turned.T
w = cut(C * omega(C))
e, n = a * sin(Phi / 2), cos(Phi / 2)
de, dn = e.diff(t), n.diff(t)
W = skew(w)
symmetric = (n**2 - e.dot(e)) * ONE + 2 * e * e.T
b, db = [n, *e], [dn, *de]
w1, w2, w3 = w


def _rate(k, first, second, third):
    return db[k], (first + second + third) / 2


table = sp.Matrix(
    [
        [b[0], -b[1], -b[2], -b[3]],
        [b[1], b[0], -b[3], b[2]],
        [b[2], b[3], b[0], -b[1]],
        [b[3], -b[2], b[1], b[0]],
    ]
)

CASES = {
    "E1": case((e.dot(e), sin(Phi / 2) ** 2), (2 * n**2 - 1, cos(Phi))),
    "E2": case((e.dot(e) + n**2, 1)),
    "E4": case((C, symmetric + 2 * n * skew(e)), corrected=[(C, symmetric - 2 * n * skew(e))]),
    "E5": case((de, (n * ONE + skew(e)) * w / 2)),
    "E6": case((dn, e.dot(w) / 2), corrected=[(dn, -e.dot(w) / 2)]),
    "E7": case((w, 2 * (n * ONE - skew(e)) * de - 2 * e * dn)),
    "E10": case((C * e, e)),
    "E11": case((C.trace(), 4 * n**2 + 1), corrected=[(C.trace(), 4 * n**2 - 1)]),
    "E13": case((C.diff(t), W * C), corrected=[(C.diff(t), -W * C)]),
    "i4": case((C * C.T, ONE)),
    "E14": case((sum(x**2 for x in b), 1)),
    "E15": case((db[0], -(b[1] * w1 + b[2] * w2 + b[3] * w3) / 2)),
    "E16": case(
        _rate(1, b[0] * w1, -b[2] * w3, b[3] * w2),
        corrected=[_rate(1, b[0] * w1, -b[3] * w2, b[2] * w3)],
    ),
    "E17": case(_rate(2, b[3] * w1, b[0] * w2, -b[1] * w3)),
    "E18": case(_rate(3, -b[2] * w1, b[1] * w2, b[0] * w3)),
    "i6": case((sp.Matrix(b).T * sp.Matrix(b), 1)),
    "E19": case((sp.Matrix(db), table * sp.Matrix([0, w1, w2, w3]) / 2)),
    "E3": case((2 * e.dot(e), 1 + cos(Phi)), corrected=[(2 * e.dot(e), 1 - cos(Phi))]),
    "E8": case((w, 2 * (n * de - dn * e)), corrected=[(w, 2 * (n * de - dn * e - skew(e) * de))]),
    "E9": case((n * dn + e.dot(e), 0), corrected=[(n * dn + e.dot(de), 0)]),
    "E12": case((C.T - C, 2 * n * skew(e)), corrected=[(C.T - C, 4 * n * skew(e))]),
    "E20": case(
        (w1, 2 * (-b[1] * db[0] + b[0] * db[1] + b[2] * db[2] - b[2] * db[3])),
        corrected=[(w1, 2 * (-b[1] * db[0] + b[0] * db[1] + b[3] * db[2] - b[2] * db[3]))],
    ),
    "E21": case(
        (C[0, 1], 2 * (b[1] * b[2] - b[0] * b[3])),
        corrected=[(C[0, 1], 2 * (b[1] * b[2] + b[0] * b[3]))],
    ),
}
