"""The symmetric 3-1-2 spinner without torque, by elementary functions.

A body of moments I1 about b1, b3 and I2 about its axle b2, where B turns with the axle alone (see
`eom.mechanics.spinning`): states are theta, theta', psi', and psi, phi, C = phi' + psi' sin(theta) where
needed.

    theta'' = psi' cos(theta) (k - psi' sin(theta)),  psi'' cos(theta) = theta' (2 psi' sin(theta) - k)

with k = C I2/I1. These rates know nothing of the body but k: the axle moves like that of a sphere of
moments I1 that has C = k, which turns about its angular momentum at a constant rate. The angle of the
sphere about the axle turns what stays in the sphere, (theta', psi' cos(theta)) at first, to what it is
in B, and phi is ahead of it by (C - k) t. Source: lecture 001; Whittaker (1937), sec. 69.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from codegen.closed.angles import Angles, Sequence3, Spinning, angles, upright
from codegen.closed.elliptic import Pair, grown, pair, scaled
from codegen.closed.exact import Steady
from codegen.closed.held import Held, moving, sine_and_cosine, states_of
from codegen.closed.polhode import context, number
from codegen.frontend.attitude import INERTIA, OMEGA, Stated
from codegen.ir.residues import FIELD, PRIME, RandomPoint
from eom.rotations import quaternion_product

AXES = (2, 0, 1)
AXLE = 3
"""Place of the moment about b2 among the entries of J."""
THREE_ONE_TWO = Sequence3(AXES)
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
    stated: Stated
    gyro: Fraction = ZERO
    spin: Fraction = ZERO


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
        """Return one row a state; see `codegen.closed.closed_forms.Motion`."""
        _, turned = self.form(t)
        q = quaternion_product(quaternion_product(self.left, list(turned)), self.right)
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
        q0, q1, q2, q3 = quaternion_product(quaternion_product(sequence.before, q), sequence.after)
        x, y = q0 * q1 + q3 * q2, q3 * q1 - q0 * q2
        sign = math.copysign(1.0, math.cos(self.angles.start[1]))
        size = -sign * np.hypot(x, y)
        return x / size, y / size, -2 * size


def reading(held: Held) -> Reading | None:
    """Return how the states are those of a stated spinner without torque; None if they are not."""
    for a in held.attitudes:
        if a.unspun and a.sequence == AXES and a.values.results[INERTIA]:
            found = _read(held, a)
            if found is not None and held.proved(partial(_residuals, held, found)):
                return _with_numbers(held, found)
    return None


def _read(held: Held, a: Stated) -> Reading | None:
    """Return the states by their places in what is stated; psi' is the one that is left."""
    psi, theta, phi = (k if k >= 0 else None for k in a.coordinates)
    theta_dot, state, _ = (k if k >= 0 else None for k in a.omega)
    known = [k for k in (psi, theta, phi, theta_dot, state) if k is not None]
    rest = [k for k in range(held.count) if k not in known]
    spins = state is not None or not moving(a.values, a.values.results[OMEGA][1:2])
    if theta is None or theta_dot is None or len(rest) != 1 or not spins:
        return None
    return Reading(theta, theta_dot, rest[0], psi, phi, state, a)


def _with_numbers(held: Held, found: Reading) -> Reading:
    J = held.constants(found.stated.values, INERTIA)
    spin = ZERO if found.state is not None else held.numbers(found.stated.values, OMEGA)[1]
    return replace(found, gyro=J[AXLE] / J[0] * (1 if found.state is not None else spin), spin=spin)


def _residuals(held: Held, found: Reading, point: RandomPoint) -> list[int]:
    """Return what is zero at a point if all rates are those of the spinner."""
    x = states_of(point, held.count)
    r = held.residues(point, x)
    J = held.values(point, found.stated.values, INERTIA, x)
    spin = held.values(point, found.stated.values, OMEGA, x)[1]
    cosine, sine = point.circle(x[found.theta])
    k = J[AXLE] * FIELD.inverse(J[0]) * spin
    turn, tilt = x[found.psi_dot], x[found.theta_dot]
    expected = [
        (found.theta, tilt),
        (found.theta_dot, turn * cosine * (k - turn * sine)),
        (found.psi_dot, tilt * (2 * turn * sine - k) * FIELD.inverse(cosine)),
        (found.psi, turn),
        (found.phi, spin - turn * sine),
        (found.state, 0),
    ]
    return [(r[place] - v) % PRIME for place, v in expected if place is not None]


def prepared(found: Reading, x: Sequence[Fraction]) -> Spinner | None:
    """Return the motion from an initial state; None where its angles are not regular."""
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
    start = quaternion_product(
        (math.cos(psi / 2), 0.0, 0.0, math.sin(psi / 2)),
        (math.cos(theta / 2), math.sin(theta / 2), 0.0, 0.0),
    )
    turn = upright([float(v) for v in axis])
    form = Steady((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), float(size), scaled(size / 2), pair(2 * own.pi))
    left, right = quaternion_product(start, turn), (turn[0], *(-v for v in turn[1:]))
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
