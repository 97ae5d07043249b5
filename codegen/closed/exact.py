"""The torque-free rigid body in closed form, at any times.

Angular velocity by Jacobi's elliptic functions, attitude by theta functions:

    w1 = a1 cn u,  w2 = +-a2 sn u,  w3 = a3 dn u,  u = u0 + p t        in the frame P of `polhode`

The body is turned from the frame whose third axis is along the angular momentum H by an angle chi
about H, followed by the least turn that takes H to where it is in the body. With n = H/|H| in P

    d chi/dt = H/I3 +- B/(I3 H (1 + n3)),  n3 = c dn u

which is smooth, as n3 > 0. The integral of the elliptic function 1/(1 + c dn u), of the third kind, is
linear in u but for twice the argument of theta4(pi (u + i eta)/(2 K)) on the lattice (2 K, 4 i K'),
F(phi | m1) = eta, tan^2 phi = I1 d32/(I3 d21).

Sources: Jacobi, J. reine angew. Math. 39 (1850) 293; Whittaker, Analytical Dynamics (1937), sec. 69;
van Zon and Schofield, J. Comput. Phys. 225 (2007) 145; Celledoni, Fasso, Saefstroem and
Zanna, SIAM J. Sci. Comput. 30 (2008) 2084. They integrate the precession angle by itself, which has
no limit where the body spins about p3; the angle chi has one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.closed.elliptic import (
    Modulus,
    Pair,
    Series,
    carlson,
    first_kind,
    pair,
    parity,
    reduced,
    scaled,
    series,
)
from codegen.closed.polhode import Polhode, context, number, polhode, root
from eom.errors import InputError, typed
from eom.rotations import quaternion_product

Array = NDArray[np.float64]
Number = Any  # a mpmath real

WHERE = "torque-free body"
FARTHEST = 1e15
"""Phases beyond this, in radians, are refused: whole periods are counted in doubles."""
CHUNK = 4096
"""Times that are computed together, so that all arrays stay in the cache."""
SLACK = 1e-12
"""By which part a moment may exceed the sum of the other two, as the rest of the house allows."""
LENGTH = 1e-9
"""By how much the length of a unit quaternion may differ from 1; it is then made 1."""


class Form(Protocol):
    """A closed form in the frame P."""

    @property
    def fastest(self) -> float:
        """The greatest of the rates of its phases, rad/s."""

    @property
    def period(self) -> float:
        """Period of the angular velocity in the body; 0 if constant, infinite if there is none."""

    def __call__(self, t: Array) -> tuple[Array, Array]:
        """Return angular velocity (3, N) and a quaternion (4, N), up to a constant first turn."""


@dataclass(frozen=True)
class Steady:
    """Constant angular velocity: the quaternion is cos(w t/2), n sin(w t/2)."""

    omega: tuple[float, float, float]
    axis: tuple[float, float, float]
    fastest: float
    half_rate: Pair
    turn: Pair
    period: float = 0.0

    def __call__(self, t: Array) -> tuple[Array, Array]:
        """See `Form`."""
        angle, _ = reduced(t, self.half_rate, Pair(0.0, 0.0), self.turn)
        sine = np.sin(angle)
        omega = np.stack([np.full_like(t, w) for w in self.omega])
        return omega, np.stack([np.cos(angle), *(n * sine for n in self.axis)])


@dataclass(frozen=True)
class Periodic:
    """Angular velocity by sn, cn, dn; half of chi as a rate, a drop a half period, and theta.

    ``amplitudes``: a1, +-a2, a3; ``cosines``: of H at these, over |H|; ``sense``: see `Polhode`.
    """

    functions: Series
    rate: Pair
    start: Pair
    amplitudes: tuple[float, float, float]
    cosines: tuple[float, float, float]
    half_rate: Pair
    half_drop: Pair
    turn: Pair
    sense: int
    fastest: float
    period: float
    least: float
    """The least of the third cosine."""

    def __call__(self, t: Array) -> tuple[Array, Array]:
        """See `Form`."""
        u, count = reduced(t, self.rate, self.start, self.functions.period)
        sn, cn, dn, real, imaginary = self.functions(u)
        sign = parity(count)
        shapes = (sign * cn, sign * sn, dn)
        omega = np.stack([a * f for a, f in zip(self.amplitudes, shapes, strict=True)])
        n1, n2, n3 = (a * f for a, f in zip(self.cosines, shapes, strict=True))
        angle, _ = reduced(t, self.half_rate, Pair(0.0, 0.0), self.turn)
        if self.half_drop.high:
            drop, _ = reduced(count, self.half_drop, Pair(0.0, 0.0), self.turn)
            angle = angle + drop
        return omega, _turned(
            np.cos(angle), np.sin(angle), real, self.sense * imaginary, n1, n2, n3
        )


def _turned(
    c: Array, s: Array, real: Array, imaginary: Array, n1: Array, n2: Array, n3: Array
) -> Array:
    """Return the unit quaternion of a turn about H, then of the least turn that takes p3 to H.

    The half angle of the first is that of (c + i s)/(real + i imaginary), in size any.
    """
    a0 = 1 + n3
    c, s = c * real + s * imaginary, s * real - c * imaginary
    scale = 1 / np.sqrt((real * real + imaginary * imaginary) * (a0 * a0 + n1 * n1 + n2 * n2))
    c, s = c * scale, s * scale
    return np.stack([c * a0, c * n2 + s * n1, s * n2 - c * n1, s * a0])


def _steady(motion: Polhode) -> Form:
    own = context()
    w = [number(own, v) for v in motion.omega]
    size = own.sqrt(sum(v * v for v in w))
    x, y, z = (float(v) for v in w)
    a, b, c = (float(v / size) if size else 0.0 for v in w)
    return Steady((x, y, z), (a, b, c), float(size), scaled(size / 2), pair(2 * own.pi))


def _periodic(motion: Polhode) -> Form:
    own = context()
    (d21, d32, d31), (I1, I2, I3), sense = motion.differences, motion.moments, motion.sense
    A, B, C = motion.A, motion.B, motion.C
    squares = B / (I1 * d31), B / (I2 * d32), C / (I3 * d31)
    a1, a2, a3 = (root(own, v) for v in squares)
    modulus = Modulus(number(own, d21 * B / (d32 * C)), number(own, d31 * A / (d32 * C)))
    p = root(own, d32 * C / (I1 * I2 * I3))
    w1, w2, w3 = (number(own, v) for v in motion.omega)
    sine, cosine = sense * w2 / a2, w1 / a1
    u0 = sine * carlson(cosine**2, (w3 / a3) ** 2, own.one)
    H = root(own, motion.H2)
    third = number(own, I3)
    c = third * a3 / H
    prepared = series(modulus, _offset(motion, modulus, own))
    chi = H / third + sense * number(own, B) / (third * H * (1 + c))
    half_rate = chi / 2 + sense * p * prepared.slope
    moments = [number(own, v) for v in motion.moments]
    signed = (a1, sense * a2, a3)
    amplitudes = [float(v) for v in signed]
    cosines = [float(I * a / H) for I, a in zip(moments, signed, strict=True)]
    return Periodic(
        functions=prepared.functions,
        rate=scaled(p),
        start=pair(u0),
        amplitudes=(amplitudes[0], amplitudes[1], amplitudes[2]),
        cosines=(cosines[0], cosines[1], cosines[2]),
        half_rate=scaled(half_rate),
        half_drop=scaled(-sense * prepared.turn),
        turn=pair(2 * own.pi),
        sense=sense,
        fastest=float(max(p, abs(half_rate), a1, a2, a3)),
        period=float(4 * modulus.K / p),
        least=float(c * own.sqrt(modulus.m1)),
    )


def _offset(motion: Polhode, modulus: Modulus, own: Any) -> Number:
    """Return eta, with tan(am(eta | m1))^2 = I1 d32/(I3 d21); it matters not at m = 0."""
    if not modulus.m:
        return own.zero
    (d21, d32, _), (I1, _, I3) = motion.differences, motion.moments
    whole = I1 * d32 + I3 * d21
    return first_kind(root(own, I1 * d32 / whole), root(own, I3 * d21 / whole), modulus.m)


@dataclass(frozen=True)
class Kind:
    """A case of the motion: its name, what it is, whether it is there, and its closed form."""

    name: str
    meaning: str
    applies: Callable[[Polhode], bool]
    form: Callable[[Polhode], Form]


KINDS = (
    Kind("rest", "no angular velocity", lambda b: not any(b.omega), _steady),
    Kind("spherical", "equal moments, constant angular velocity", lambda b: not b.differences[2], _steady),
    Kind("steady", "spin about a principal axis", lambda b: b.steady, _steady),
    Kind("symmetric", "two equal moments: circular functions", lambda b: not b.differences[0], _periodic),
    Kind("separatrix", "H^2 = 2 T I2: hyperbolic functions", lambda b: not b.A, _periodic),
    Kind("greatest", "elliptic functions, about the greatest moment", lambda b: b.sense > 0, _periodic),
    Kind("least", "elliptic functions, about the least moment", lambda b: b.sense < 0, _periodic),
)  # fmt: skip
"""The first row that applies is taken; all tests are exact."""


def kind_of(body: Polhode) -> Kind:
    """Return the row of `KINDS` of a motion."""
    return next(k for k in KINDS if k.applies(body))


def form_of(body: Polhode) -> Form:
    """Return the closed form of a motion. Raises `InputError` for rates that doubles cannot hold."""
    form = kind_of(body).form(body)
    if not form.fastest < 1e250:
        raise InputError(
            "angular velocity out of range",
            where=WHERE,
            got=[float(v) for v in body.omega],
            expected="below 1e250 rad/s",
        )
    return form


@dataclass(frozen=True)
class FreeMotion:
    """A torque-free motion in closed form: call it with times; made by `free_motion`.

    Parameters
    ----------
    kind : str
        Its row of `KINDS` by name.
    meaning : str
        The same in words.
    period : float
        Of the angular velocity in the body (s); 0 where it is constant, infinite on the separatrix.
    body, form : Polhode
        The motion in the frame of the polhode.
    first : tuple of float, float, float, float
        The quaternion of a constant turn before it, scalar first.

    Notes
    -----
    Units, frames, signs and sources are those of `free_body`.
    """

    kind: str
    meaning: str
    period: float
    body: Polhode
    form: Form
    first: tuple[float, float, float, float]

    def __call__(self, t: ArrayLike) -> tuple[Array, Array]:
        """Return angular velocity and attitude at any times.

        Parameters
        ----------
        t : array
            Times of any shape (s), of either sign.

        Returns
        -------
        tuple of arrays
            Angular velocity (3, ...) in rad/s and quaternion (4, ...), scalar first, where ... is
            the shape of ``t``; see `free_body`.

        Raises
        ------
        InputError
            For times that are not finite or phases beyond `FARTHEST`.
        """
        times = _times(t, self.form.fastest)
        omega, quaternion = np.empty((3, times.size)), np.empty((4, times.size))
        flat = times.ravel()
        for k in range(0, times.size, CHUNK):
            part = slice(k, k + CHUNK)
            w, q = self.form(flat[part])
            omega[:, part] = self.body.frame.to_body(w)
            q[1:] = self.body.frame.to_body(q[1:])
            quaternion[:, part] = quaternion_product(self.first, q)
        return omega.reshape(3, *times.shape), quaternion.reshape(4, *times.shape)


@typed
def free_motion(
    moments: ArrayLike, omega0: ArrayLike, attitude0: ArrayLike = (1, 0, 0, 0)
) -> FreeMotion:
    """Return the closed form of a torque-free motion, to be called with times.

    Parameters
    ----------
    moments : array
        Three principal moments of inertia, as those of `free_body`.
    omega0 : array
        Angular velocity at t = 0, as of `free_body`.
    attitude0 : array, optional
        Unit quaternion at t = 0, as of `free_body`.

    Returns
    -------
    FreeMotion
        To be called with times; it knows the kind of the motion and its period.

    Raises
    ------
    InputError
        As of `free_body`.

    Notes
    -----
    Arguments, units, conventions, errors and source as those of `free_body`.

    Examples
    --------
    >>> free_motion((1, 2, 3), (1.0, 0.0, 1.0)).kind
    'greatest'
    >>> free_motion((1, 1, 2), (0.1, 0.0, 5.0)).kind
    'symmetric'
    """
    body = polhode(_moments(moments), _numbers("angular velocity", omega0, 3))
    start = _unit(_numbers("attitude", attitude0, 4))
    kind, form = kind_of(body), form_of(body)
    _, q = form(np.zeros(1))
    q[1:] = -body.frame.to_body(q[1:])
    w, x, y, z = (float(v[0]) for v in quaternion_product(start, q))
    return FreeMotion(kind.name, kind.meaning, form.period, body, form, (w, x, y, z))


@typed
def free_body(
    moments: ArrayLike, omega0: ArrayLike, attitude0: ArrayLike, t: ArrayLike
) -> tuple[Array, Array]:
    """Return angular velocity and attitude of a torque-free rigid body at the times ``t``, in closed form.

    Parameters
    ----------
    moments : array
        Three principal moments of inertia, kg m^2.
    omega0 : array
        Angular velocity in inertial space at t = 0, components along the principal axes, rad/s.
    attitude0 : array
        Unit quaternion at t = 0, scalar first; C_BI = (q0^2 - q.q) 1 + 2 q q^T - 2 q0 tilde(q)
        takes inertial components to the body, and dq/dt = q (0, omega)/2.
    t : array
        Times of any shape, s, of either sign.

    Returns
    -------
    tuple of arrays
        (omega, quaternion), shapes (3, ...) and (4, ...) where ... is the shape of ``t``; the
        quaternion is continuous in time. `free_motion` also gives the kind of the motion.

    Raises
    ------
    InputError
        For moments that no body has (not positive, or one above the sum of the other two by more
        than rounding, a part in 1e12), data that are not finite or of the wrong shape, an attitude
        that is not of unit length to 1e-9 (it is then made so), phases beyond 1e15 rad.

    Notes
    -----
    Both are right to some units in the last place of their size, at all times alike: the data are
    taken as exact, constants have 50 digits, phases are reduced in two doubles.

    References
    ----------
    Whittaker, Analytical Dynamics (1937), sec. 69; Jacobi, J. reine angew. Math. 39 (1850) 293;
    more in `codegen.closed.exact`.

    Examples
    --------
    >>> omega, q = free_body((1, 1, 2), (0.0, 0.0, 3.0), (1, 0, 0, 0), [0.0, 1.0])
    >>> [round(float(v), 6) for v in q[:, 1]]  # turned by 3 rad about b3
    [0.070737, 0.0, 0.0, 0.997495]
    """
    return free_motion(moments, omega0, attitude0)(t)


def _array(what: str, values: ArrayLike) -> Array:
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError, MemoryError) as error:
        raise InputError(f"{what}: not real numbers", where=WHERE, got=values) from error
    if not np.isfinite(array).all():
        raise InputError(f"{what}: not finite", where=WHERE, got=values, expected="finite numbers")
    return array


def _numbers(what: str, values: ArrayLike, count: int) -> list[float]:
    array = _array(what, values)
    if array.shape != (count,):
        raise InputError(f"{what}: wrong shape", where=WHERE, got=array.shape, expected=(count,))
    return [float(v) for v in array]


def _moments(values: ArrayLike) -> list[float]:
    moments = _numbers("moments of inertia", values, 3)
    a, b, c = sorted(moments)
    if not a > 0:
        raise InputError(
            "a moment of inertia is not positive", where=WHERE, got=moments, expected="> 0"
        )
    if c / 2 > (a / 2 + b / 2) * (1 + SLACK):
        raise InputError(
            "no body has these moments of inertia: one exceeds the sum of the other two",
            where=WHERE,
            got=moments,
            expected=f"none above {a + b:g} (triangle inequality)",
        )
    return moments


def _unit(q: list[float]) -> tuple[float, float, float, float]:
    size = float(np.linalg.norm(q))
    if abs(size - 1) > LENGTH:
        raise InputError(
            "attitude is not a unit quaternion", where=WHERE, got=f"norm {size!r}", expected=1
        )
    a, b, c, d = (v / size for v in q)
    return a, b, c, d


def _times(t: ArrayLike, fastest: float) -> Array:
    times = _array("times", t)
    longest = float(np.abs(times).max(initial=0.0))
    if longest * fastest > FARTHEST:
        raise InputError(
            "time too long: phases lose their digits",
            where=WHERE,
            got=f"{longest:g} s at {fastest:g} rad/s",
            expected=f"at most {FARTHEST:g} rad",
        )
    return times
