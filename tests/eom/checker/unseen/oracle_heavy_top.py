"""The heavy top: a body that turns about a point at rest; C.T of principal axes at the support."""

from tests.eom.checker.unseen.motions import (
    attitude,
    case,
    constant,
    cut,
    der,
    draw,
    omega,
    rigid,
    skew,
    t,
)

_rng = draw("heavy top")
C = attitude(_rng)
w = omega(C)
body = rigid(_rng, C)
r, m = body.centre, body.mass
h, M = body.momentum(0 * r), body.torque(0 * r)
J, IC = body.inertia(0 * r), body.inertia(r)
rolled = rigid(_rng, C, principal=True)
A = constant(C * rolled.inertia(0 * r) * C.T)
w_, Jb, rb = cut(C * w), cut(C * J * C.T), cut(C * r)
tau = C * rolled.torque(0 * r)


def _euler(j, k, l, sign=1):
    """The line of axis j; the moments of k and l exchanged with sign -1."""
    return A[j, j] * w_[j].diff(t) + sign * (A[l, l] - A[k, k]) * w_[k] * w_[l], tau[j]


p = body.places[0]
CASES = {
    "E1": case((h, body.over(lambda x: x.cross(x.diff(t))))),
    "E2": case((der(p), der(p, C) + w.cross(p)), (der(p), w.cross(p))),
    "E3": case((h, body.over(lambda x: x.cross(w.cross(x)))), (h, J * w)),
    "E4": case(
        (Jb, body.over(lambda x: skew(C * x) ** 2)),
        corrected=[(Jb, -body.over(lambda x: skew(C * x) ** 2))],
    ),
    "E5": case((Jb, C * IC * C.T - m * skew(rb) ** 2)),
    "E7": case((h.diff(t), M)),
    "E8": case(
        (h.diff(t), der(h, C) - w.cross(h)), corrected=[(h.diff(t), der(h, C) + w.cross(h))]
    ),
    "E9": case((J * der(w, C) + w.cross(J * w), M)),
    # a column times the cross of a matrix has no meaning; nor is it what is left without the mark
    "E10": case(
        (Jb * w_.diff(t) + Jb * w_, C * M),
        corrected=[(Jb * w_.diff(t) + skew(w_) * Jb * w_, C * M)],
    ),
    "E12": case(_euler(0, 1, 2)),
    "E13": case(_euler(1, 2, 0, -1), corrected=[_euler(1, 2, 0)]),
    "E14": case(_euler(2, 0, 1)),
    "E16": case((body.energy, w.dot(J * w) / 2)),
    "E18": case(
        (body.energy, m * der(r).dot(der(r)) / 2 + w.dot(J * w) / 2),
        corrected=[(body.energy, m * der(r).dot(der(r)) / 2 + w.dot(IC * w) / 2)],
    ),
    "E19": case((body.energy.diff(t), w.dot(M))),
    "E21": case(
        (r.diff(t, 2), der(w, C).cross(r) + w.cross(r)),
        corrected=[(r.diff(t, 2), der(w, C).cross(r) + w.cross(w.cross(r)))],
    ),
    "E6": case((h, IC * w + m * der(r).cross(r)), corrected=[(h, IC * w + m * r.cross(der(r)))]),
    "E11": case((M, C * (C * M)), corrected=[(M, C.T * (C * M))]),
    "E15": case(
        (A[0, 0] * w_[0].diff(t), (A[1, 1] - A[2, 2]) * w_[0] * w_[2] + tau[0]),
        corrected=[(A[0, 0] * w_[0].diff(t), (A[1, 1] - A[2, 2]) * w_[1] * w_[2] + tau[0])],
    ),
    "E17": case(
        (2 * rolled.energy, A[0, 0] * w_[0] ** 2 + A[1, 1] * w_[1] ** 2 + A[2, 2] * w_[2]),
        corrected=[(2 * rolled.energy, sum(A[k, k] * w_[k] ** 2 for k in range(3)))],
    ),
    "E20": case(
        (body.energy.diff(t), w.dot(J * w)),
        corrected=[(body.energy.diff(t), w.dot(J * der(w, C)))],
    ),
}
