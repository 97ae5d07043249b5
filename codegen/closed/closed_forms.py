"""Closed forms of compiled systems: taken where the rates are proved to be those of the form.

`find` reads a system with the values of its parameters and its initial state, and returns the motion
as a function of time where one of `ROWS` fits. Two or three states alone are looked at as they are; all
else is what the system states (`eom.system.BodyAttitude`). That every rate is that of the form, with these
numbers, is an identity modulo a prime (`codegen.closed.held`): a torque that is there is a torque, however
small and wherever it acts. The principal axes of
an inertia matrix are found in fractions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from codegen.closed import spinner, top_recognition
from codegen.closed.angles import Angles, Sequence3, angles
from codegen.closed.bilinear import triad
from codegen.closed.bodies import (
    Matrix,
    Spinning,
    attitude_at,
    bodies,
    inertia,
    moves,
    positive_definite,
)
from codegen.closed.exact import CHUNK, LENGTH, form_of
from codegen.closed.heavy_top import top_form
from codegen.closed.held import Held, fraction, held, states_of
from codegen.closed.phase_unwrapping import own_axes, winding
from codegen.closed.polhode import Frame, context, number, polhode
from codegen.compiling.compiled import Compiled
from codegen.frontend.layout import names_of
from codegen.ir.residues import PRIME, RandomPoint
from codegen.native.trajectory import Problem
from eom.errors import InputError
from eom.rotations import quaternion_product

Array = NDArray[np.float64]
WHERE = "closed form"
FARTHEST = 1e15
"""Phases beyond this, in radians, are refused."""


class Motion(Protocol):
    """States over time, computed for few times at once; made of the operations of `codegen.ir.tracing`."""

    @property
    def fastest(self) -> float:
        """The greatest of the rates of its phases, rad/s."""

    def __call__(self, t: Any) -> Sequence[Any]:
        """Return one array a state for the times since the initial state."""


@dataclass(frozen=True)
class Closed:
    """A motion in closed form.

    ``name``: of the kind; ``meaning``: what it is and by which functions. ``states(times)``: times
    (N,), s, from that of the initial state on, of either sign, to states (n, N) in the order of the
    system. Raises `InputError` for times that are not finite and phases beyond 1e15 rad.
    """

    name: str
    meaning: str
    states: Callable[[Array], Array]
    motion: Motion
    names: tuple[str, ...]
    """Of the states."""


@dataclass(frozen=True)
class Evaluated:
    """A motion over arrays of times, in parts that stay in the cache."""

    motion: Motion
    count: int
    """Number of states."""

    def __call__(self, times: Array) -> Array:
        """Return states (n, N) at times (N,)."""
        t = np.asarray(times, dtype=np.float64)
        longest = float(np.abs(t).max(initial=0.0))
        if not longest * self.motion.fastest <= FARTHEST:
            raise InputError(
                "time too long: phases lose their digits, or it is not finite",
                where=WHERE,
                got=f"{longest:g} s at {self.motion.fastest:g} rad/s",
                expected=f"at most {FARTHEST:g} rad",
            )
        states = np.empty((self.count, t.size))
        for k in range(0, t.size, CHUNK):
            part = slice(k, k + CHUNK)
            for row, values in zip(states, self.motion(t[part]), strict=True):
                row[part] = values
        return states


@dataclass(frozen=True)
class Rates:
    """Angular velocity, or three quantities with such rates, along axes of their own."""

    form: Any
    axes: Axes
    order: tuple[int, ...]
    """For each state the number of its component."""

    @property
    def fastest(self) -> float:
        """See `Motion`."""
        return float(self.form.fastest)

    def __call__(self, t: Any) -> Sequence[Any]:
        """See `Motion`."""
        rows = self.axes.to_body(list(self.form(t)))
        return [rows[k] for k in self.order]


@dataclass(frozen=True)
class Alone:
    """Two or three states whose rates are products of the others, with the coefficients."""

    coefficients: tuple[Fraction, Fraction, Fraction]


def _alone(held: Held) -> Alone | None:
    """y1' = a y2 y3, and so on, of three states; of two, y1' = a y2, y2' = b y1: then y3 is 1."""
    n = held.count
    if n not in (2, 3):
        return None
    rows = [[float(j != k) for j in range(n)] for k in range(n)]

    def residuals(point: RandomPoint) -> list[int]:
        x = states_of(point, n)
        rates = held.residues(point, x)
        c = [held.residues(point, [int(v) for v in row], [k])[0] for k, row in enumerate(rows)]
        others = [math.prod(x[j] for j in range(n) if j != k) for k in range(n)]
        return [(r - a * v) % PRIME for r, a, v in zip(rates, c, others, strict=True)]

    if not held.proved(residuals):
        return None
    c = [held.rate_numbers(row, [k])[0] for k, row in enumerate(rows)]
    return Alone((c[0], c[1], c[2] if n == 3 else Fraction(0)))


def _moved_alone(found: Alone, start: Sequence[Fraction]) -> Motion | None:
    x, y, z = (*start, Fraction(1))[:3]
    form = triad(found.coefficients, (x, y, z))
    order = tuple(range(len(start)))
    return None if form is None else Rates(form, Axes.own(), order)


@dataclass(frozen=True)
class Free:
    """A stated body that is proved to turn without torque, and its inertia but for a factor."""

    body: Spinning
    inertia: Matrix


def _free(held: Held) -> Free | None:
    for body in bodies(held):
        if moves(held, body):
            J = inertia(held, body.stated)
            if positive_definite(J):
                return Free(body, J)
    return None


def _moved_freely(found: Free, start: Sequence[Fraction]) -> Motion | None:
    axes, moments = principal_axes(found.inertia)
    omega = axes.from_body(found.body.omega_at(start))
    if not (found.body.quaternion or found.body.angles or found.body.stated.directions):
        return _omega_alone(found.body, axes, moments, omega)
    body = polhode(moments, omega)
    return _turned(found.body, start, form_of(body), body.frame, axes)


def _omega_alone(
    body: Spinning, axes: Axes, moments: Sequence[Fraction], omega: Sequence[Fraction]
) -> Motion | None:
    a, b, c = moments
    form = triad(((b - c) / a, (c - a) / b, (a - b) / c), (omega[0], omega[1], omega[2]))
    place = {k: component for component, k in enumerate(body.omega)}
    order = tuple(place[k] for k in range(len(place)))
    return None if form is None else Rates(form, axes, order)


@dataclass(frozen=True)
class Turned:
    """A body: states are angular velocity, quaternion and directions fixed in space."""

    form: Any
    frame: Frame
    axes: Axes
    back: tuple[float, ...]
    """The inverse of the first value of the form's quaternion, in the body."""
    start: tuple[float, ...]
    """The first quaternion."""
    fixed: tuple[tuple[float, ...], ...]
    """Directions at the start, in the body."""
    angles: Angles | None
    places: tuple[tuple[int, int], ...]
    """For each state the number of its vector (0: omega, 1: quaternion, others), and of its component."""

    @property
    def fastest(self) -> float:
        """See `Motion`."""
        return float(self.form.fastest)

    def __call__(self, t: Any) -> Sequence[Any]:
        """See `Motion`."""
        w, q = self.form(t)
        turn = [q[0], *self.axes.to_body(self.frame.listed(q[1:]))]
        vectors: list[Sequence[Any]] = [self.axes.to_body(self.frame.listed(w))]
        if self.start:
            q = quaternion_product(quaternion_product(self.start, self.back), turn)
            vectors.append(q if self.angles is None else self.angles(t, q))
        if self.fixed:
            since = quaternion_product(self.back, turn)
            vectors += [_seen(v, since) for v in self.fixed]
        return [vectors[v][k] for v, k in self.places]


def _seen(v: Sequence[float], q: Sequence[Any]) -> list[Any]:
    """Return the components of a fixed vector ``v`` after the turn q: C(q) v."""
    a, b, c, d = q
    x, y, z = v
    return [
        (a * a + b * b - c * c - d * d) * x + 2 * ((b * c + a * d) * y + (b * d - a * c) * z),
        (a * a - b * b + c * c - d * d) * y + 2 * ((b * c - a * d) * x + (c * d + a * b) * z),
        (a * a - b * b - c * c + d * d) * z + 2 * ((b * d + a * c) * x + (c * d - a * b) * y),
    ]


def _turned(
    body: Spinning, x: Sequence[Fraction], form: Any, frame: Frame, axes: Axes
) -> Motion | None:
    q = tuple(map(float, attitude_at(body, x)))
    if q and abs(math.hypot(*q) - 1) > LENGTH:
        return None
    _, first = form(np.zeros(1))
    b0, *b = (float(v[0]) for v in first)
    back = (b0, *(-v for v in axes.to_body(frame.listed(b))))
    shown = _angles(body, x, form, (q, back), axes.turn_of(frame)) if body.angles else None
    if body.angles and shown is None:
        return None
    return Turned(
        form=form,
        frame=frame,
        axes=axes,
        back=back,
        start=q,
        fixed=tuple(tuple(float(x[k]) for k in three) for three in body.stated.directions),
        angles=shown,
        places=_places(body, len(x)),
    )


def _angles(
    body: Spinning,
    x: Sequence[Fraction],
    form: Any,
    first: tuple[Sequence[float], Sequence[float]],
    turn: Sequence[float],
) -> Angles | None:
    """Return the angles over time; None where their whole turns are not clear."""
    found = winding(form)
    if found is None:
        return None
    a, b, c, d = turn = quaternion_product(turn, own_axes(form))
    i, j, k = body.stated.sequence
    psi, theta, phi = (float(x[n]) for n in body.angles)
    left = quaternion_product(quaternion_product(*first), turn)
    turns = left, (a, -b, -c, -d)
    return angles(Sequence3((i, j, k)), found, turns, (psi, theta, phi), first[0])


def _moved_top(found: top_recognition.Reading, start: Sequence[Fraction]) -> Motion | None:
    top = top_recognition.top(found, start)
    if top is None:
        return None
    frame = Frame(found.axes, (1, 1, 1))
    return _turned(found.body, start, top_form(top), frame, Axes.own())


def _places(body: Spinning, count: int) -> tuple[tuple[int, int], ...]:
    vectors = [body.omega, body.quaternion or body.angles, *body.stated.directions]
    shown = [v for k, v in enumerate(vectors) if v or not k]
    found = {k: (i, j) for i, v in reversed(list(enumerate(shown))) for j, k in enumerate(v)}
    return tuple(found[k] for k in range(count))


@dataclass(frozen=True)
class Row:
    """A kind of closed form: its name, what it is, and what reads it.

    ``read``: from a system with its values to a reading, all rates proved, or None; ``move``: from that and
    the initial state to the motion, or None.
    """

    name: str
    meaning: str
    read: Callable[[Held], Any]
    move: Callable[[Any, Sequence[Fraction]], Motion | None]


OMEGA_ALONE = "angular velocity without torque, by Jacobi's elliptic functions"
ROWS = (
    Row("free body", OMEGA_ALONE, _alone, _moved_alone),
    Row("free body", "attitude without torque, by elliptic and theta functions", _free, _moved_freely),
    Row("heavy symmetric top", "Lagrange's top, by quotients of theta functions", top_recognition.reading,
    _moved_top), Row("symmetric spinner", "3-1-2 angles without torque, by elementary functions",
        spinner.reading, spinner.prepared),
)  # fmt: skip


def find(compiled: Compiled, problem: Problem) -> Closed | None:
    """Return the closed form of a system with these values, or None where none is known.

    ``problem``: initial state, times, parameters and held inputs; nothing else of it matters. None, too,
    where phases lose their digits before the end.
    """
    known = held(compiled, problem)
    start = tuple(Fraction(float(v)) for v in problem.x0)
    for row in ROWS:
        try:
            reading = known.read(row.read)
            motion = None if reading is None else row.move(reading, start)
        except (ArithmeticError, InputError):
            continue
        first, last = problem.t_span
        if motion is not None and abs(last - first) * motion.fastest <= FARTHEST:
            names = names_of(compiled.layout.states)
            return Closed(row.name, row.meaning, Evaluated(motion, len(names)), motion, names)
    return None


EQUAL = Fraction(1, 10**40)
"""Moments that differ by less of their size are equal; they are known to 50 digits."""
Triple = tuple[Fraction, Fraction, Fraction]


@dataclass(frozen=True)
class Axes:
    """``columns``: unit vectors of the principal axes in the body; none where these are its own."""

    columns: tuple[Triple, ...] = ()

    @classmethod
    def own(cls) -> Axes:
        """Return the axes of the body themselves."""
        return cls()

    def to_body(self, v: Sequence[Any]) -> list[Any]:
        """Return components in the body of a vector along the principal axes."""
        if not self.columns:
            return list(v)
        c1, c2, c3 = self.columns
        rows = zip(c1, c2, c3, strict=True)
        return [float(a) * v[0] + float(b) * v[1] + float(c) * v[2] for a, b, c in rows]

    def turn_of(self, frame: Frame) -> tuple[float, float, float, float]:
        """Return the quaternion S of S v S^-1 = the components in the body of v given in ``frame``."""
        units = [[float(i == k) for i in range(3)] for k in range(3)]
        columns = [self.to_body(frame.listed(u)) for u in units]
        C = [[columns[k][i] for k in range(3)] for i in range(3)]
        trace = C[0][0] + C[1][1] + C[2][2]
        squares = [1 + trace, *(1 - trace + 2 * C[k][k] for k in range(3))]
        odd = [C[2][1] - C[1][2], C[0][2] - C[2][0], C[1][0] - C[0][1]]
        k = max(range(4), key=lambda n: squares[n])
        rows = [squares[0], *odd]
        if k:
            even = [C[k - 1][i] + C[i][k - 1] for i in range(3)]
            even[k - 1] = squares[k]
            rows = [odd[k - 1], *even]
        a, b, c, d = (v / (2 * math.sqrt(squares[k])) for v in rows)
        return a, b, c, d

    def from_body(self, v: Sequence[Fraction]) -> list[Fraction]:
        """Return components along the principal axes, exactly."""
        if not self.columns:
            return list(v)
        return [
            sum((a * b for a, b in zip(column, v, strict=True)), Fraction(0))
            for column in self.columns
        ]


def principal_axes(J: Sequence[Sequence[Fraction]]) -> tuple[Axes, Triple]:
    """Return principal axes, right-handed, and moments about them, of a symmetric matrix."""
    if not (J[0][1] or J[0][2] or J[1][2]):
        return Axes.own(), (J[0][0], J[1][1], J[2][2])
    own = context()
    own.dps += 20
    values, vectors = own.eigsy(own.matrix([[number(own, v) for v in row] for row in J]))
    if own.det(vectors) < 0:
        vectors = -vectors
    columns = [tuple(fraction(vectors[i, k]) for i in range(3)) for k in range(3)]
    a, b, c = (fraction(v) for v in values)
    b = a if abs(b - a) <= EQUAL * a else b
    c = b if abs(c - b) <= EQUAL * b else c
    x, y, z = ((u[0], u[1], u[2]) for u in columns)
    return Axes((x, y, z)), (a, b, c)
