"""Rigid bodies in the rates of a system: which states are angular velocity, quaternion, or directions.

A reading names no state: kinematics and Euler's equations are identities that rates fulfil at random
points, or do not. Angular velocity may have components that are numbers: first integrals that
became parameters.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, permutations
from typing import Any

from codegen.exactlinear import nullspace
from codegen.polhode import context, number
from codegen.probing import DIGITS, SAME, Probe, Sample, fraction, same, structural

Component = int | Fraction
"""Of the angular velocity: the number of a state, or a constant."""
Omega = tuple[Component, Component, Component]
Matrix = tuple[tuple[Fraction, ...], ...]
Quadratic = tuple[dict[tuple[int, int], Fraction], ...]
"""For each of three rates its coefficients by pair of the three quantities, i <= j."""

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
ZERO, ONE = Fraction(0), Fraction(1)
MOST_STATES = 16
"""Larger systems are not read: there are too many choices."""


@dataclass(frozen=True)
class Attitude:
    """Angular velocity, the quaternion's states if there is one, and triples of fixed directions."""

    omega: Omega
    quaternion: tuple[int, ...]
    directions: tuple[tuple[int, int, int], ...] = ()
    angles: tuple[int, ...] = ()
    axes: tuple[int, ...] = ()
    """Numbers of the states that are angles, and the body axes that these turn about, 0 to 2."""

    @property
    def states(self) -> set[int]:
        """All states that it reads."""
        own = {w for w in self.omega if isinstance(w, int)}
        return own.union(self.quaternion, self.angles, *self.directions)


def attitude_at(found: Attitude, x: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """Return the quaternion at states: its own states, or of angles, then a unit to the last digit."""
    if not found.angles:
        return tuple(x[k] for k in found.quaternion)
    q: Sequence[Fraction] = (ONE, ZERO, ZERO, ZERO)
    for k, axis in zip(found.angles, found.axes, strict=True):
        own = context()
        own.dps = DIGITS
        quarter = fraction(own.tan(number(own, x[k]) / 4)) if x[k] else ZERO
        below = 1 + quarter**2
        turn = [(1 - quarter**2) / below, ZERO, ZERO, ZERO]
        turn[1 + axis] = 2 * quarter / below
        q = product(q, turn)
    return tuple(q)


def value(component: Component, x: Sequence[Fraction]) -> Fraction:
    """Return a component of the angular velocity at states."""
    return x[component] if isinstance(component, int) else component


def product(p: Sequence[Any], q: Sequence[Any]) -> list[Any]:
    """Return the product p q of quaternions, scalar first."""
    (a, b, c, d), (w, x, y, z) = p, q
    return [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y + c * w + d * x - b * z,
        a * z + d * w + b * y - c * x,
    ]


def quaternions(probe: Probe) -> Iterator[Attitude]:
    """Yield the quaternions among the states, scalar first: dq/dt = q (0, omega)/2."""
    n = probe.count
    for four in combinations(range(n), 4):
        if not all(_keeps_length(four, s) for s in probe.samples):
            continue
        for order in permutations(four):
            omega = _turning(probe, order)
            if omega is not None:
                yield Attitude(omega, order)


def _keeps_length(four: Sequence[int], s: Sample) -> bool:
    terms = [s.x[k] * s.rates[k] for k in four]
    return same(sum(terms, ZERO), ZERO, sum(map(abs, terms), ZERO))


def _turning(probe: Probe, order: Sequence[int]) -> Omega | None:
    """Return what 2 q^-1 dq/dt is: states, or constants."""
    rates = []
    for s in probe.samples:
        q, r = [s.x[k] for k in order], [s.rates[k] for k in order]
        size = sum((v * v for v in q), ZERO)
        back = [q[0], *(-v for v in q[1:])]
        rates.append([2 * v / size for v in product(back, r)[1:]])
    return _omega(probe, rates)


def _component(probe: Probe, values: Sequence[Fraction]) -> Component | None:
    """Return the state that has these values at the samples, or the constant that they are."""
    pairs = list(zip(values, probe.samples, strict=True))
    for k in range(probe.count):
        if all(same(v, s.x[k], s.x[k]) for v, s in pairs):
            return k
    first = values[0]
    small = all(abs(v) <= SAME for v in values)
    if small:
        return ZERO
    return first if all(same(v, first, first) for v in values) else None


SEQUENCES = tuple(
    (i, j, k) for i in range(3) for j in range(3) for k in range(3) if j not in (i, k)
)
MOST_WITH_ANGLES = 8


def rotation_angles(probe: Probe) -> Iterator[Attitude]:
    """Yield three rotation angles of any sequence among the states, with the angular velocity."""
    if probe.count > MOST_WITH_ANGLES:
        return
    s = probe.samples[0]
    x, rates = [float(v) for v in s.x], [float(v) for v in s.rates]
    waves = [(math.sin(v), math.cos(v)) for v in x]
    for order in permutations(range(probe.count), 3):
        for axes in SEQUENCES:
            near = _angular_velocity(order, axes, waves, rates)
            if sum(any(math.isclose(w, v, rel_tol=1e-9) for v in x) for w in near) >= 2:
                omega = _turned_by(probe, order, axes)
                if omega is not None:
                    yield Attitude(omega, (), (), order, axes)


def _angular_velocity(
    order: Sequence[int],
    axes: Sequence[int],
    waves: Sequence[tuple[Any, Any]],
    rates: Sequence[Any],
) -> list[Any]:
    """Return the angular velocity in the body: each turn's, seen after those that follow."""
    w: list[Any] = [0, 0, 0]
    for k, axis in zip(order, axes, strict=True):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        s, c = waves[k]
        w[i], w[j] = c * w[i] + s * w[j], c * w[j] - s * w[i]
        w[axis] += rates[k]
    return w


def _turned_by(probe: Probe, order: Sequence[int], axes: Sequence[int]) -> Omega | None:
    values = []
    for s in probe.samples:
        waves = [sine_and_cosine(v) for v in s.x]
        values.append(_angular_velocity(order, axes, waves, s.rates))
    return _omega(probe, values)


def sine_and_cosine(x: Fraction) -> tuple[Fraction, Fraction]:
    """Return both to `DIGITS` digits."""
    own = context()
    own.dps = DIGITS
    angle = number(own, x)
    return fraction(own.sin(angle)), fraction(own.cos(angle))


def _omega(probe: Probe, values: Sequence[Sequence[Fraction]]) -> Omega | None:
    a, b, c = (_component(probe, [v[i] for v in values]) for i in range(3))
    return None if a is None or b is None or c is None else (a, b, c)


def directions(
    probe: Probe, omega: Omega, rest: Sequence[int]
) -> list[tuple[int, int, int]] | None:
    """Divide states into vectors that stand still in space: dv/dt = -omega x v; None if not all are."""
    left, found = list(rest), []
    while left:
        three = next(
            (t for t in permutations(left, 3) if left[0] in t and _is_fixed(probe, omega, t)), None
        )
        if three is None:
            return None
        found.append(three)
        left = [k for k in left if k not in three]
    return found


def _is_fixed(probe: Probe, omega: Omega, three: Sequence[int]) -> bool:
    for s in probe.samples:
        w, v = [value(c, s.x) for c in omega], [s.x[k] for k in three]
        for i, k in enumerate(three):
            terms = v[i - 2] * w[i - 1], v[i - 1] * w[i - 2]
            if not same(s.rates[k], terms[0] - terms[1], abs(terms[0]) + abs(terms[1])):
                return False
    return True


def turning_directions(probe: Probe) -> Iterator[Attitude]:
    """Yield the readings of all states as angular velocity and fixed directions, without quaternion.

    One component of the angular velocity may be constant.
    """
    everything = set(range(probe.count))
    for three in permutations(range(probe.count), 3):
        if three[0] != min(three) or not _keeps_length(three, probe.samples[0]):
            continue
        for omega in _turns_of(probe, three, everything - set(three)):
            left = everything - set(three) - {w for w in omega if isinstance(w, int)}
            others = (
                directions(probe, omega, sorted(left)) if _is_fixed(probe, omega, three) else None
            )
            if others is not None:
                yield Attitude(omega, (), (three, *others))


def _turns_of(probe: Probe, three: Sequence[int], rest: set[int]) -> Iterator[Omega]:
    """Yield what the angular velocity may be by the rates of a direction in the first sample."""
    x, rates = probe.samples[0].x, probe.samples[0].rates
    yield from permutations(sorted(rest), 3)
    for a in range(3):
        i, j = (a + 1) % 3, (a + 2) % 3
        for p, q in permutations(sorted(rest), 2):
            constant = (rates[three[i]] + x[three[a]] * x[q]) / x[three[j]]
            omega: list[Component] = [ZERO, ZERO, ZERO]
            omega[a], omega[i], omega[j] = constant, p, q
            yield omega[0], omega[1], omega[2]


@structural
def quadratic(probe: Probe, three: tuple[int, ...]) -> Quadratic | None:
    """Return the rates of three states where they are quadratic forms in these states; else None."""
    base = list(map(float, probe.samples[0].x))

    def at(*ones: int) -> list[Fraction]:
        x = list(base)
        for i, k in enumerate(three):
            x[k] = float(ones.count(i) > 0)
        rates = probe.rates(x)
        return [rates[k] for k in three]

    single = [at(i) for i in range(3)]
    forms: list[dict[tuple[int, int], Fraction]] = [{} for _ in three]
    for i, j in PAIRS:
        both = single[i] if i == j else at(i, j)
        for r, form in enumerate(forms):
            form[i, j] = both[r] - (ZERO if i == j else single[i][r] + single[j][r])
    found = tuple(forms)
    return found if _agrees(probe, three, found) else None


def _agrees(probe: Probe, three: Sequence[int], forms: Quadratic) -> bool:
    for s in probe.samples:
        w = [s.x[k] for k in three]
        for k, form in zip(three, forms, strict=True):
            terms = [c * w[i] * w[j] for (i, j), c in form.items()]
            if not same(s.rates[k], sum(terms, ZERO), sum(map(abs, terms), ZERO)):
                return False
    return True


def bilinear(forms: Quadratic) -> tuple[Fraction, Fraction, Fraction] | None:
    """Return c1, c2, c3 where the rates are c1 y2 y3, c2 y3 y1, c3 y1 y2; None otherwise."""
    others = ((1, 2), (0, 2), (0, 1))
    size = max(abs(c) for f in forms for c in f.values())
    alone = all(
        same(c, ZERO, size)
        for f, own in zip(forms, others, strict=True)
        for pair, c in f.items()
        if pair != own
    )
    a, b, c = (f[own] for f, own in zip(forms, others, strict=True))
    return (a, b, c) if alone else None


def inertia(forms: Quadratic) -> Matrix | None:
    """Return J, but for a factor, if J dw/dt = -w x (J w) for these rates; None otherwise.

    The equations are linear in the six entries of J, which must be positive definite.
    """
    rows = [
        [_equation(forms, pair, i, entry) for entry in PAIRS] for pair in PAIRS for i in range(3)
    ]
    basis = nullspace(rows, SAME)
    if len(basis) != 1:
        return None
    entries = dict(zip(PAIRS, basis[0], strict=True))
    trace = entries[0, 0] + entries[1, 1] + entries[2, 2]
    if not trace:
        return None
    J = tuple(tuple(entries[min(i, j), max(i, j)] / trace for j in range(3)) for i in range(3))
    return J if positive_definite(J) else None


def _equation(forms: Quadratic, pair: tuple[int, int], i: int, entry: tuple[int, int]) -> Fraction:
    """Coefficient of an entry of J in component i of J Q(w) + w x (J w), at the product of a pair."""

    def J(a: int, b: int) -> int:
        return int((min(a, b), max(a, b)) == entry)

    total = sum((J(i, k) * forms[k][pair] for k in range(3)), ZERO)
    for (a, b), sign in (((i - 2) % 3, (i - 1) % 3), 1), (((i - 1) % 3, (i - 2) % 3), -1):
        for k in range(3):
            if (min(a, k), max(a, k)) == pair:
                total += sign * J(b, k)
    return total


def positive_definite(J: Matrix) -> bool:
    """Return whether the leading minors are positive."""
    (a, b, c), (_, d, e), (_, _, f) = J
    two = a * d - b * b
    return a > 0 and two > 0 and a * (d * f - e * e) - b * (b * f - e * c) + c * (b * e - d * c) > 0


@structural
def free_inertia(probe: Probe, omega: Omega) -> Matrix | None:
    """Return J, but for a factor, of a body without torque that turns with omega; None otherwise."""
    moving = [(i, k) for i, k in enumerate(omega) if isinstance(k, int)]
    rows: dict[int, Callable[[], Matrix | None]] = {
        3: lambda: _of_three(probe, [k for _, k in moving]),
        2: lambda: _of_two(probe, omega),
        0: lambda: _diagonal(ONE, ONE, ONE),
    }
    return rows[len(moving)]() if len(moving) in rows else None


def _of_three(probe: Probe, states: Sequence[int]) -> Matrix | None:
    forms = quadratic(probe, tuple(states))
    return None if forms is None else inertia(forms)


def _of_two(probe: Probe, omega: Omega) -> Matrix | None:
    """One component s is constant: the others turn at (1 - I3/I1) s in the body, I1 = I2."""
    axis = next(i for i, w in enumerate(omega) if not isinstance(w, int))
    s, i, j = value(omega[axis], ()), omega[axis - 2], omega[axis - 1]
    if not isinstance(i, int) or not isinstance(j, int):
        return None
    rate = probe.samples[0].rates[i] / probe.samples[0].x[j]
    for sample in probe.samples:
        turned = (sample.rates[i], rate * sample.x[j]), (sample.rates[j], -rate * sample.x[i])
        if not all(same(a, b, b) for a, b in turned):
            return None
    if not s:
        return None if rate else _diagonal(ONE, ONE, ONE)
    moments = [ONE, ONE, ONE]
    moments[axis] = 1 - rate / s
    return _diagonal(*moments) if moments[axis] > 0 else None


def _diagonal(a: Fraction, b: Fraction, c: Fraction) -> Matrix:
    return (a, ZERO, ZERO), (ZERO, b, ZERO), (ZERO, ZERO, c)
