"""The symmetric 3-1-2 spinner without torque, by elementary functions.

A body of moments I1 about b1, b3 and I2 about its axle b2, where B turns with the axle alone (see
`eom.spinning`): states are theta, theta', psi', and psi, phi, C = phi' + psi' sin(theta) where needed.

    theta'' = psi' cos(theta) (k - psi' sin(theta)),  psi'' cos(theta) = theta' (2 psi' sin(theta) - k)

with k = C I2/I1. These rates know nothing of the body but k: the axle moves like that of a sphere of
moments I1 that has C = k, which turns about its angular momentum at a constant rate. The angle of the
sphere about the axle turns what stays in the sphere, (theta', psi' cos(theta)) at first, to what it is
in B, and phi is ahead of it by (C - k) t. Source: lecture 001; Whittaker (1937), sec. 69.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import permutations
from typing import Any

import numpy as np

from codegen.angles import Angles, Sequence3, angles, product, upright
from codegen.bodies import sine_and_cosine
from codegen.exact import Steady
from codegen.phases import Pair, grown, pair, scaled
from codegen.polhode import context, number
from codegen.probing import Probe, Sample, same, structural
from codegen.windings import Spinning

THREE_ONE_TWO = Sequence3((2, 0, 1))
PARTS = ("theta", "psi", "phi", "theta_dot", "psi_dot", "spin")
ZERO = Fraction(0)


@dataclass(frozen=True)
class Reading:
    """Numbers of the states; ``gyro``: k, or k/C where C is a state; ``spin``: C if it is none."""

    theta: int
    theta_dot: int
    psi_dot: int
    psi: int | None
    phi: int | None
    state: int | None
    gyro: Fraction
    spin: Fraction


@dataclass(frozen=True)
class Spinner:
    """Rows of the states, by name in ``rows``, of the sphere's motion and its angles."""

    form: Steady
    left: tuple[float, ...]
    right: tuple[float, ...]
    angles: Angles
    transverse: tuple[float, float]
    ahead: Pair
    spin: float
    fastest: float
    rows: tuple[str, ...]
    phi: float
    """At the start; the angle of the sphere starts at zero."""

    def __call__(self, t: Any) -> Sequence[Any]:
        """Return one row a state; see `codegen.closed_forms.Motion`."""
        _, turned = self.form(t)
        q = product(product(self.left, list(turned)), self.right)
        psi, theta, sphere = self.angles(t, q)
        c, s, cosine = self._in_sphere(q)
        x, z = self.transverse
        rows = {
            "theta": theta,
            "psi": psi,
            "phi": sphere + grown(t, self.ahead, Pair(self.phi, 0.0)),
            "theta_dot": c * x + s * z,
            "psi_dot": (c * z - s * x) / cosine,
            "spin": np.full_like(t, self.spin),
        }
        return [rows[name] for name in self.rows]

    def _in_sphere(self, q: Sequence[Any]) -> tuple[Any, Any, Any]:
        """Return cosine and sine of the sphere's angle about the axle, and the cosine of theta.

        Of alpha conj(beta), not of the angle itself, whose rounding grows with time.
        """
        sequence = self.angles.sequence
        q0, q1, q2, q3 = product(product(sequence.before, q), sequence.after)
        x, y = q0 * q1 + q3 * q2, q3 * q1 - q0 * q2
        sign = math.copysign(1.0, math.cos(self.angles.start[1]))
        size = -sign * np.hypot(x, y)
        return x / size, y / size, -2 * size


def readings(probe: Probe) -> Iterator[Reading]:
    """Yield how the states may be those of a spinner without torque."""
    n, x, r = probe.count, probe.samples[0].x, probe.samples[0].rates
    for theta, theta_dot, psi_dot in permutations(range(n), 3):
        if r[theta] != x[theta_dot] or not 3 <= n <= len(PARTS):
            continue
        rest = [k for k in range(n) if k not in (theta, theta_dot, psi_dot)]
        psi = next((k for k in rest if r[k] == x[psi_dot]), None)
        state = next((k for k in rest if not r[k]), None)
        others = [k for k in rest if k not in (psi, state)]
        if len(others) <= 1:
            gyro, spin = _constants(probe.samples[0], theta, theta_dot, psi_dot, others, state)
            found = Reading(
                theta, theta_dot, psi_dot, psi, others[0] if others else None, state, gyro, spin
            )
            if all(_holds(found, s) for s in probe.samples):
                yield found


def _constants(
    s: Sample, theta: int, theta_dot: int, psi_dot: int, others: Sequence[int], state: int | None
) -> tuple[Fraction, Fraction]:
    sine, cosine = sine_and_cosine(s.x[theta])
    gyro = s.rates[theta_dot] / (s.x[psi_dot] * cosine) + s.x[psi_dot] * sine
    spin = s.rates[others[0]] + s.x[psi_dot] * sine if others else ZERO
    return (gyro / s.x[state] if state is not None else gyro), spin


def _holds(found: Reading, s: Sample) -> bool:
    """Whether all rates are those of the spinner at a sample."""
    x, r = s.x, s.rates
    sine, cosine = sine_and_cosine(x[found.theta])
    k = found.gyro * (x[found.state] if found.state is not None else 1)
    spin = x[found.state] if found.state is not None else found.spin
    turn, tilt = x[found.psi_dot], x[found.theta_dot]
    expected = [
        (found.theta, tilt, ZERO),
        (found.theta_dot, turn * cosine * k, -turn * cosine * turn * sine),
        (found.psi_dot, 2 * tilt * turn * sine / cosine, -k * tilt / cosine),
        (found.psi, turn, ZERO),
        (found.phi, spin, -turn * sine),
        (found.state, ZERO, ZERO),
    ]
    return all(place is None or same(r[place], a + b, abs(a) + abs(b)) for place, a, b in expected)


@structural
def _reading(probe: Probe) -> Reading | None:
    return next(readings(probe), None)


def spinner(probe: Probe) -> Spinner | None:
    """Return the motion of a spinner without torque; None where the system is none."""
    found = _reading(probe)
    return None if found is None else _prepared(found, probe.start)


def _prepared(found: Reading, x: Sequence[Fraction]) -> Spinner | None:
    own = context()
    spin = x[found.state] if found.state is not None else found.spin
    k = found.gyro * (spin if found.state is not None else 1)
    _, cosine = sine_and_cosine(x[found.theta])
    if not cosine:
        return None
    h = (x[found.theta_dot], k, x[found.psi_dot] * cosine)
    size = own.sqrt(number(own, h[0] ** 2 + h[1] ** 2 + h[2] ** 2))
    axis = [number(own, v) / size for v in h] if size else [own.zero, own.zero, own.one]
    psi, theta = float(x[found.psi]) if found.psi is not None else 0.0, float(x[found.theta])
    start = product(
        (math.cos(psi / 2), 0.0, 0.0, math.sin(psi / 2)),
        (math.cos(theta / 2), math.sin(theta / 2), 0.0, 0.0),
    )
    turn = upright([float(v) for v in axis])
    form = Steady((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), float(size), scaled(size / 2), pair(2 * own.pi))
    left, right = product(start, turn), (turn[0], *(-v for v in turn[1:]))
    shown = angles(THREE_ONE_TWO, Spinning(form), (left, right), (psi, theta, 0.0), start)
    if shown is None:
        return None
    ahead = scaled(number(own, spin - k))
    numbers = (found.theta, found.psi, found.phi, found.theta_dot, found.psi_dot, found.state)
    names = {n: name for n, name in zip(numbers, PARTS, strict=True) if n is not None}
    return Spinner(
        form=form,
        left=left,
        right=right,
        angles=shown,
        transverse=(float(h[0]), float(h[2])),
        ahead=ahead,
        spin=float(spin),
        fastest=float(max(size, abs(number(own, spin - k)))),
        rows=tuple(names[n] for n in range(len(x))),
        phi=float(x[found.phi]) if found.phi is not None else 0.0,
    )
