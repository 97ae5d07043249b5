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
    "E6": case((h.diff(t), M)),
    "E7": case(
        (h.diff(t), der(h, C) - w.cross(h)), corrected=[(h.diff(t), der(h, C) + w.cross(h))]
    ),
    "E8": case((J * der(w, C) + w.cross(J * w), M)),
    # a column times the cross of a matrix has no meaning; nor is it what is left without the mark
    "E9": case(
        (Jb * w_.diff(t) + Jb * w_, C * M),
        corrected=[(Jb * w_.diff(t) + skew(w_) * Jb * w_, C * M)],
    ),
    "E10": case(_euler(0, 1, 2)),
    "E11": case(_euler(1, 2, 0, -1), corrected=[_euler(1, 2, 0)]),
    "E12": case(_euler(2, 0, 1)),
    "E13": case((body.energy, w.dot(J * w) / 2)),
    "E14": case(
        (body.energy, m * der(r).dot(der(r)) / 2 + w.dot(J * w) / 2),
        corrected=[(body.energy, m * der(r).dot(der(r)) / 2 + w.dot(IC * w) / 2)],
    ),
    "E15": case((body.energy.diff(t), w.dot(M))),
    "E16": case(
        (r.diff(t, 2), der(w, C).cross(r) + w.cross(r)),
        corrected=[(r.diff(t, 2), der(w, C).cross(r) + w.cross(w.cross(r)))],
    ),
}
