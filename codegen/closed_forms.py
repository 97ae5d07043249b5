"""Closed forms of compiled systems: recognised by the structure of their rates, not by names.

`find` reads a system with the values of its parameters and its initial state, and returns the motion
as a function of time where one of `ROWS` fits. What fits does so exactly: a torque of 1e-30 beside
the others is a torque.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from codegen import bodies, tops
from codegen.angles import Angles, Sequence3, angles, product
from codegen.bilinear import triad
from codegen.bodies import Attitude, Matrix
from codegen.compiled import Compiled
from codegen.exact import CHUNK, LENGTH, form_of
from codegen.heavy_top import top_form
from codegen.integrate.trajectory import Problem
from codegen.layout import names_of
from codegen.polhode import Frame, polhode
from codegen.principal_axes import Axes, principal_axes
from codegen.probing import Probe, structural
from codegen.spinner import spinner
from codegen.taylor import BRANCHES, STEPS
from codegen.windings import own_axes, winding
from eom.errors import InputError

Array = NDArray[np.float64]
WHERE = "closed form"
PIECES = BRANCHES | STEPS | {"table", "floor", "mod"}
"""Operations by which rates may be one formula at the points that are looked at, and another elsewhere."""
FARTHEST = 1e15
"""Phases beyond this, in radians, are refused."""


class Motion(Protocol):
    """States over time, computed for few times at once; made of the operations of `codegen.tracing`."""

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


def _rates(probe: Probe) -> Motion | None:
    """Three states with quadratic rates, or two that turn with a constant rate."""
    if probe.count == 2:
        return _turning_pair(probe)
    if probe.count != 3:
        return None
    forms = bodies.quadratic(probe, (0, 1, 2))
    if forms is None:
        return None
    c = bodies.bilinear(forms)
    x, y, z = probe.start
    if c is not None:
        form = triad(c, (x, y, z))
        return None if form is None else Rates(form, Axes.own(), (0, 1, 2))
    return _about_any_axes(probe)


def _about_any_axes(probe: Probe) -> Motion | None:
    for order in ((0, 1, 2), (1, 0, 2)):
        J = bodies.free_inertia(probe, order)
        if J is not None:
            axes, moments = principal_axes(J)
            w = axes.from_body([probe.start[k] for k in order])
            a, b, c = moments
            form = triad(((b - c) / a, (c - a) / b, (a - b) / c), (w[0], w[1], w[2]))
            return None if form is None else Rates(form, axes, order)
    return None


def _turning_pair(probe: Probe) -> Motion | None:
    """y1' = a y2, y2' = b y1: as three quantities, the third of which stays 1."""
    first = probe.samples[0]
    a, b = first.rates[0] / first.x[1], first.rates[1] / first.x[0]
    for s in probe.samples:
        if s.rates != (a * s.x[1], b * s.x[0]):
            return None
    x, y = probe.start
    form = triad((a, b, Fraction(0)), (x, y, Fraction(1)))
    return None if form is None else Rates(form, Axes.own(), (0, 1))


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
            q = bodies.product(bodies.product(self.start, self.back), turn)
            vectors.append(q if self.angles is None else self.angles(t, q))
        if self.fixed:
            since = bodies.product(self.back, turn)
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


def _free_body(probe: Probe) -> Motion | None:
    for attitude in _attitudes(probe):
        J = bodies.free_inertia(probe, attitude.omega)
        if J is not None:
            return _turned_free_body(probe, attitude, J)
    return None


@structural
def _attitudes(probe: Probe) -> tuple[Attitude, ...]:
    """Return the ways to read all states as angular velocity, quaternion and directions."""
    return tuple(_readings(probe))


def _readings(probe: Probe) -> Iterator[Attitude]:
    everything = set(range(probe.count))
    for found in bodies.quaternions(probe):
        yield from _with_directions(probe, found, everything - found.states)
    for found in bodies.rotation_angles(probe):
        yield from _with_directions(probe, found, everything - found.states)
    for found in bodies.turning_directions(probe):
        if len(found.states) == probe.count:
            yield found


def _with_directions(probe: Probe, found: Attitude, rest: set[int]) -> Iterator[Attitude]:
    triples = bodies.directions(probe, found.omega, sorted(rest))
    if triples is not None:
        yield replace(found, directions=tuple(triples))


def _turned_free_body(probe: Probe, attitude: Attitude, J: Matrix) -> Motion | None:
    axes, moments = principal_axes(J)
    omega = axes.from_body([bodies.value(c, probe.start) for c in attitude.omega])
    body = polhode(moments, omega)
    return _turned(probe, attitude, form_of(body), body.frame, axes)


def _turned(probe: Probe, attitude: Attitude, form: Any, frame: Frame, axes: Axes) -> Motion | None:
    x = probe.start
    q = tuple(map(float, bodies.attitude_at(attitude, x)))
    if q and abs(math.hypot(*q) - 1) > LENGTH:
        return None
    _, first = form(np.zeros(1))
    b0, *b = (float(v[0]) for v in first)
    back = (b0, *(-v for v in axes.to_body(frame.listed(b))))
    shown = _angles(attitude, x, form, (q, back), axes.turn_of(frame)) if attitude.angles else None
    if attitude.angles and shown is None:
        return None
    return Turned(
        form=form,
        frame=frame,
        axes=axes,
        back=back,
        start=q,
        fixed=tuple(tuple(float(x[k]) for k in three) for three in attitude.directions),
        angles=shown,
        places=_places(attitude, probe.count),
    )


def _angles(
    attitude: Attitude,
    x: Sequence[Fraction],
    form: Any,
    first: tuple[Sequence[float], Sequence[float]],
    turn: Sequence[float],
) -> Angles | None:
    """Return the angles over time; None where their whole turns are not clear."""
    found = winding(form)
    if found is None:
        return None
    a, b, c, d = turn = product(turn, own_axes(form))
    i, j, k = attitude.axes
    psi, theta, phi = (float(x[n]) for n in attitude.angles)
    left = product(product(*first), turn)
    turns = left, (a, -b, -c, -d)
    return angles(Sequence3((i, j, k)), found, turns, (psi, theta, phi), first[0])


def _heavy_top(probe: Probe) -> Motion | None:
    for attitude in _attitudes(probe):
        for axis in range(3):
            top = tops.read(probe, attitude, axis)
            if top is not None:
                frame = Frame(((axis + 1) % 3, (axis + 2) % 3, axis), (1, 1, 1))
                return _turned(probe, attitude, top_form(top), frame, Axes.own())
    return None


def _places(attitude: Attitude, count: int) -> tuple[tuple[int, int], ...]:
    vectors = [attitude.omega, attitude.quaternion or attitude.angles, *attitude.directions]
    shown = [v for v in vectors if v]
    found = {
        k: (i, j)
        for i, vector in reversed(list(enumerate(shown)))
        for j, k in enumerate(vector)
        if isinstance(k, int)  # a constant component may equal the number of a state
    }
    return tuple(found[k] for k in range(count))


@dataclass(frozen=True)
class Row:
    """A kind of closed form: its name, what it is, and what reads it from a system."""

    name: str
    meaning: str
    read: Callable[[Probe], Motion | None]


ROWS = (
    Row("free body", "angular velocity without torque, by Jacobi's elliptic functions", _rates),
    Row("free body", "attitude without torque, by elliptic and theta functions", _free_body),
    Row("heavy symmetric top", "Lagrange's top, by quotients of theta functions", _heavy_top),
    Row("symmetric spinner", "3-1-2 angles without torque, by elementary functions", spinner),
)


def find(compiled: Compiled, problem: Problem) -> Closed | None:
    """Return the closed form of a system with these values, or None where none is known.

    ``problem``: initial state, times, parameters and held inputs; nothing else of it matters. None, too,
    where phases lose their digits before the end.
    """
    probe = Probe(compiled, problem)
    if len(problem.x0) > bodies.MOST_STATES or _has_pieces(probe):
        return None
    for row in ROWS:
        try:
            motion = row.read(probe)
        except (ArithmeticError, InputError):
            continue
        start, end = problem.t_span
        if motion is not None and abs(end - start) * motion.fastest <= FARTHEST:
            names = names_of(compiled.layout.states)
            return Closed(row.name, row.meaning, Evaluated(motion, len(names)), motion, names)
    return None


@structural
def _has_pieces(probe: Probe) -> bool:
    """Tell whether a rate takes another formula as the states move."""
    moving: list[bool] = []
    for op, args, _ in probe.program.instructions:
        moving.append(op in {"state", "time"} or any(moving[a] for a in args))
        if op in PIECES and moving[-1]:
            return True
    return False
