"""Three particles with central internal forces, any motion, and what Newton leaves as external forces."""

import sympy as sp

from tests.eom.checker.unseen.motions import (
    Masses,
    case,
    draw,
    function,
    number,
    path,
    t,
)

_rng = draw("particles")
N = range(3)
_places = tuple(path(_rng) for _ in N)
_strength = {(i, j): function(_rng) for i in N for j in range(i)}


def _inner(i, j):
    strength = _strength.get((i, j), _strength.get((j, i), 0))
    return strength * (_places[i] - _places[j])


masses = tuple(abs(number(_rng)) for _ in N)
system = Masses(masses, _places, tuple(tuple(_inner(i, j) for j in N) for i in N))
R, M = system.centre, system.mass
V = R.diff(t)
nought = sp.zeros(3, 1)


def total(rule):
    return sum((rule(i) for i in N), nought)


def number_of(rule):
    return sum(rule(i) for i in N)


r, F = system.places, [system.force(i) for i in N]
v = [x.diff(t) for x in r]
r_, v_ = [x - R for x in r], [x - V for x in v]
L, L_ = system.absolute(nought), system.momentum(R)
torque, torque_ = system.torque(nought), system.torque(R)
T = system.energy
inside = total(lambda i: masses[i] * r_[i].cross(v_[i]))
own = number_of(lambda i: masses[i] * v_[i].dot(v_[i]))

_pair = Masses(masses[:2], _places[:2])
_mu = masses[0] * masses[1] / (masses[0] + masses[1])
_f = path(_rng)  # force of 2 on 1; accelerations follow from it
_relative = _f / masses[0] + _f / masses[1]
P = total(lambda i: masses[i] * v[i])

CASES = {
    "E1": case(*((masses[i] * r[i].diff(t, 2), F[i] + sum(system.inner[i], nought)) for i in N)),
    "E2": case((M * R, total(lambda i: masses[i] * r[i]))),
    "i8": case(*((r[i], R + r_[i]) for i in N)),
    "E3": case((total(lambda i: masses[i] * r_[i]), nought)),
    "i9": case(*((system.inner[i][j], -system.inner[j][i]) for i in N for j in N)),
    "E4": case((total(lambda i: sum(system.inner[i], nought)), nought)),
    "E5": case(
        (M * V, total(lambda i: F[i])), corrected=[(M * R.diff(t, 2), total(lambda i: F[i]))]
    ),
    "E7": case((total(lambda i: masses[i] * v[i]), M * V)),
    "E10": case((L, total(lambda i: r[i].cross(masses[i] * v[i])))),
    "E12": case((L.diff(t), total(lambda i: r[i].cross(F[i])))),
    "E13": case((L, M * R.cross(V) - inside), corrected=[(L, M * R.cross(V) + inside)]),
    "E15": case((L_.diff(t), total(lambda i: r_[i].cross(F[i]))), (L_.diff(t), torque_)),
    "E16": case(
        (torque - torque_, system.outer.cross(R)),
        corrected=[(torque - torque_, R.cross(system.outer))],
    ),
    "E17": case((T, M * V.dot(V) / 2 + own / 2)),
    "E18": case((T, M * V.dot(V) / 2 + own), corrected=[(T, M * V.dot(V) / 2 + own / 2)]),
    "E21": case(
        (
            T.diff(t),
            number_of(lambda i: F[i].dot(v[i]))
            + number_of(lambda i: sum(system.inner[i], nought).dot(v[i])),
        )
    ),
    "i10": case((1 / _mu, 1 / masses[0] + 1 / masses[1])),
    "i11": case((r[0] - r[1], r_[0] - r_[1])),
    "i12": case((_mu * _relative, _f)),
    "E6": case(
        (total(lambda i: masses[i] * r_[i].diff(t, 2)), system.outer),
        corrected=[(total(lambda i: masses[i] * r[i].diff(t, 2)), system.outer)],
    ),
    "E8": case(
        *((masses[i] * v[i], masses[i] * V - masses[i] * v_[i]) for i in N),
        corrected=[(masses[i] * v[i], masses[i] * V + masses[i] * v_[i]) for i in N],
    ),
    "E9": case((P.diff(t), M * V), corrected=[(P.diff(t), M * V.diff(t))]),
    "E11": case(
        (torque, total(lambda i: F[i].cross(r[i]))),
        corrected=[(torque, total(lambda i: r[i].cross(F[i])))],
    ),
    "E14": case(
        (L_, total(lambda i: masses[i] * r_[i].cross(r_[i]))),
        corrected=[(L_, total(lambda i: masses[i] * r_[i].cross(v_[i])))],
    ),
    "E19": case(
        (T, number_of(lambda i: v[i].dot(v[i]) / 2)),
        corrected=[(T, number_of(lambda i: (masses[i] * v[i]).dot(v[i]) / 2))],
    ),
    "E20": case(
        ((M * V.dot(V) / 2).diff(t), system.outer.dot(V) / 2),
        corrected=[((M * V.dot(V) / 2).diff(t), system.outer.dot(V))],
    ),
}
