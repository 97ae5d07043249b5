"""Closed forms of compiled systems: taken where the rates are proved to be those of the form.

`find` reads a system with the values of its parameters and its initial state, and returns the motion
as a function of time where one of `ROWS` fits. Two or three states alone are looked at as they are; all
else is what the system states (`eom.system.BodyAttitude`). That every rate is that of the form, with these
numbers, is an identity modulo a prime (`codegen.closed.held`): a torque that is there is a torque, however
small and wherever it acts. The principal axes of
an inertia matrix are found in fractions.

Three quantities, the rate of each a multiple of the product of the others, by sn, cn, dn.

    y1' = c1 y2 y3,  y2' = c2 y3 y1,  y3' = c3 y1 y2

Euler's equations without torque are of this form, with or without a body that has such moments of
inertia; so are two quantities that turn with a constant rate (c3 = 0). One c must have a sign of its
own: call it c2, and let |c1| y3^2 >= |c3| y1^2. Then, with E = |c2| y1^2 + |c1| y2^2 and
F = |c3| y2^2 + |c2| y3^2, which are constant,

    y1 = a1 cn u,  y2 = -sign(c1) a2 sn u,  y3 = a3 dn u,  u = u0 + p t
    a1^2 = E/|c2|,  a2^2 = E/|c1|,  a3^2 = F/|c2|,  p^2 = |c1| F
    m = |c3| E/(|c1| F),  1 - m = |c2| (|c1| y3^2 - |c3| y1^2)/(|c1| F)

All of these are computed as fractions of the data. Source: DLMF 22.13 (i).

Closed forms in C: one motion, its constants in the text, at any times in vector lanes.

The text is the program that the NumPy form leaves behind (`codegen.ir.scalars`), written by the target of
lanes: the same operations in the same order, sines and exponentials of `codegen.targets.lanes`.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import permutations
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.closed import spinner, top_recognition
from codegen.closed.angles import Angles, Sequence3, angles, own_axes, winding
from codegen.closed.elliptic import (
    Modulus,
    Pair,
    Series,
    carlson,
    pair,
    parity,
    reduced,
    scaled,
    series,
)
from codegen.closed.exact import CHUNK, LENGTH, form_of
from codegen.closed.heavy_top import top_form
from codegen.closed.held import (
    Held,
    Matrix,
    Spinning,
    attitude_at,
    bodies,
    fraction,
    held,
    inertia,
    moves,
    positive_definite,
    states_of,
)
from codegen.closed.polhode import DIGITS, Frame, context, number, polhode, root
from codegen.compiling.compiled import Compiled
from codegen.frontend.layout import Layout, names_of, to_array
from codegen.ir.names import comment, identifier
from codegen.ir.program import INVARIANTS, OUTPUTS, RATES, SINGULARITIES, Program, SameObject
from codegen.ir.residues import PRIME, RandomPoint
from codegen.ir.scalars import traced
from codegen.native import native
from codegen.native.trajectory import Problem
from codegen.targets import lanes
from codegen.targets.c import guarded
from eom.errors import InputError
from eom.quantities import TIME, Quantity
from eom.rotations import quaternion_product

Array = NDArray[np.float64]
Triple = tuple[Fraction, Fraction, Fraction]


@dataclass(frozen=True)
class Constant:
    """Quantities that do not change."""

    values: tuple[float, ...]
    fastest: float = 0.0

    def __call__(self, t: Array) -> Array:
        """Return the values at each time, (3, N)."""
        return np.stack([np.full_like(t, v) for v in self.values])


@dataclass(frozen=True)
class Triad:
    """The elliptic functions; ``places``: of y1, y2, y3 among the three; ``fastest`` phase, rad/s."""

    functions: Series
    rate: Pair
    start: Pair
    amplitudes: tuple[float, float, float]
    places: tuple[int, int, int]
    fastest: float

    def __call__(self, t: Array) -> Array:
        """Return the three quantities at the times, (3, N)."""
        u, count = reduced(t, self.rate, self.start, self.functions.period)
        sn, cn, dn, _, _ = self.functions(u)
        sign = parity(count)
        shapes = (sign * cn, sign * sn, dn)
        rows = [a * f for a, f in zip(self.amplitudes, shapes, strict=True)]
        return np.stack([rows[self.places.index(k)] for k in range(3)])


def triad(coefficients: Triple, start: Triple) -> Constant | Triad | None:
    """Return the motion from ``start``; None where it is not of this kind.

    None: no sign stands alone (the motion may grow without bounds), or c has a single entry that is
    not zero.
    """
    if not any(_rates(coefficients, start)):
        x, y, z = map(float, start)
        return Constant((x, y, z))
    order = next((o for o in permutations(range(3)) if _fits(coefficients, start, o)), None)
    return None if order is None else _triad(coefficients, start, order)


def _rates(c: Triple, y: Triple) -> list[Fraction]:
    return [c[k] * y[k - 2] * y[k - 1] for k in range(3)]


def _fits(c: Triple, y: Triple, order: Sequence[int]) -> bool:
    first, odd, last = (c[k] for k in order)
    alone = first * odd < 0 and first * last >= 0
    return alone and abs(first) * y[order[2]] ** 2 >= abs(last) * y[order[0]] ** 2


def _triad(c: Triple, y: Triple, order: tuple[int, ...]) -> Triad:
    own = context()
    first, odd, last = (abs(c[k]) for k in order)
    x1, x2, x3 = (y[k] for k in order)
    E, F = odd * x1**2 + first * x2**2, last * x2**2 + odd * x3**2
    excess = first * x3**2 - last * x1**2
    modulus = Modulus(number(own, last * E / (first * F)), number(own, odd * excess / (first * F)))
    s1, s3 = (1 if v >= 0 else -1 for v in (x1, x3))
    sense = -1 if c[order[0]] > 0 else 1
    a1, a2, a3 = (root(own, v) for v in (E / odd, E / first, F / odd))
    sine = number(own, s1 * s3 * sense * x2) / a2
    cosine = number(own, abs(x1)) / a1
    u0 = sine * carlson(cosine**2, (number(own, x3) / a3) ** 2, own.one)
    p = root(own, first * F)
    i, j, k = order
    return Triad(
        functions=series(modulus, own.zero).functions,
        rate=scaled(p),
        start=pair(u0),
        amplitudes=(float(s1 * a1), float(s1 * s3 * sense * a2), float(s3 * a3)),
        places=(i, j, k),
        fastest=float(p),
    )


WHERE = "closed form"
FARTHEST = 1e15
"""Phases beyond this, in radians, are refused."""


class Motion(Protocol):
    """States over time, computed for few times at once; made of the operations of `codegen.ir.scalars`."""

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
    for row in ROWS:
        reading = _reading(known, row)
        if reading is None:
            continue
        motion = _motion(SameObject(known), row, tuple(problem.x0.tolist()))
        first, last = problem.t_span
        if motion is not None and abs(last - first) * motion.fastest <= FARTHEST:
            names = names_of(compiled.layout.states)
            return Closed(row.name, row.meaning, Evaluated(motion, len(names)), motion, names)
    return None


@lru_cache(maxsize=64)
def _motion(known: SameObject[Held], row: Row, start: tuple[float, ...]) -> Motion | None:
    """Return the motion from an initial state by a row that has a reading; None where it has none."""
    try:
        motion: Motion | None = row.move(_reading(known.value, row), tuple(map(Fraction, start)))
    except (ArithmeticError, InputError):
        return None
    return motion


def is_known(compiled: Compiled, problem: Problem) -> bool:
    """Return whether the rates with these parameters and inputs are those of a closed form."""
    known = held(compiled, problem)
    return any(_reading(known, row) is not None for row in ROWS)


def _reading(known: Held, row: Row) -> Any:
    try:
        return known.read(row.read)
    except (ArithmeticError, InputError):
        return None


EQUAL = Fraction(1, 10**40)
"""Moments that differ by less of their size are equal; they are known to 50 digits."""


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


@lru_cache(maxsize=64)
def principal_axes(J: Matrix) -> tuple[Axes, Triple]:
    """Return principal axes, right-handed, and moments about them, of a symmetric matrix."""
    if not (J[0][1] or J[0][2] or J[1][2]):
        return Axes.own(), (J[0][0], J[1][1], J[2][2])
    own = context(DIGITS + 20)
    values, vectors = own.eigsy(own.matrix([[number(own, v) for v in row] for row in J]))
    if own.det(vectors) < 0:
        vectors = -vectors
    columns = [tuple(fraction(vectors[i, k]) for i in range(3)) for k in range(3)]
    a, b, c = (fraction(v) for v in values)
    b = a if abs(b - a) <= EQUAL * a else b
    c = b if abs(c - b) <= EQUAL * b else c
    x, y, z = ((u[0], u[1], u[2]) for u in columns)
    return Axes((x, y, z)), (a, b, c)


FLAGS = "-std=c99 -O2 (or -ffp-contract=off): sums and products must not be fused"


def files(closed: Closed, name: str) -> Mapping[str, str]:
    """Return headers and sources by file name: ``NAME_at(count, t, x)`` and the lanes behind it.

    The same motion gives the same bytes.
    """
    own, layout, program = _parts(closed, name)
    texts = lanes.files(program, layout)
    return {f"{own}.h": _header(own, closed), f"{own}.c": _source(own, closed), **texts}


def single_text(closed: Closed, name: str) -> str:
    """Return all files as one text that compiles by itself."""
    own, layout, program = _parts(closed, name)
    source = _source(own, closed)
    for header in (own, f"{own}_{lanes.SUFFIX}"):
        source = source.replace(f'#include "{header}.h"\n', "")
    return _header(own, closed) + lanes.single_text(program, layout) + source


def _parts(closed: Closed, name: str) -> tuple[str, Layout, Program]:
    own = identifier(name)
    return own, _layout(own, closed), traced(closed.motion, OUTPUTS)


def _layout(name: str, closed: Closed) -> Layout:
    """The program's one state is the time: points that differ in it are one batch."""
    time = Quantity(TIME, "s", "time since the initial state")
    groups = {RATES: (), OUTPUTS: closed.names, INVARIANTS: (), SINGULARITIES: ()}
    return Layout(name, closed.name, (time,), (), (), groups)


def _header(name: str, closed: Closed) -> str:
    guard = f"{name.upper()}_H"
    rows = [f" *   {k}: {comment(n)}" for k, n in enumerate(closed.names)]
    about = [
        f"/* {comment(closed.name)}: one motion in closed form, generated by eom.",
        " *",
        " * t: count times since the initial state, s, of either sign; x: rows of count numbers,",
        " * state k at time j in x[k * count + j]:",
        *rows,
        f" * Compile with {FLAGS}.",
        " */",
    ]
    return guarded(
        guard,
        about,
        [
            f"void {name}_at(size_t count, const double *t, double *x);",
        ],
    )


def _source(name: str, closed: Closed) -> str:
    return "\n".join([
        f"/* {comment(closed.name)}: one motion in closed form, generated by eom. */",
        f'#include "{name}.h"',
        f'#include "{name}_{lanes.SUFFIX}.h"',
        "",
        f"void {name}_at(size_t count, const double *t, double *x) {{",
        "    const double start = 0.0;",
        f"    {name}_{OUTPUTS}_{lanes.SUFFIX}(count, &start, 0, t, 0, 1, &start, 0, 0, &start, 0, 0,",
        "        x, (ptrdiff_t)count, 1);",
        "}",
        "",
    ])  # fmt: skip


def of_values(
    compiled: Compiled,
    initial: Mapping[str, float],
    parameters: Mapping[str, float],
    inputs: Mapping[str, float],
) -> Closed:
    """Return the closed form of a system with numbers by name.

    Raises `InputError` where none is known, and for names that do not fit.
    """
    layout = compiled.layout
    x = to_array(initial, names_of(layout.states), "initial value")
    p = to_array(parameters, names_of(layout.parameters), "parameter")
    u = to_array(inputs, names_of(layout.inputs), "input")
    found = find(compiled, Problem(x, (0.0, 1.0), p, u, 1e-9, np.full(len(x), 1e-12), 1e-6, 0))
    if found is None:
        kinds = dict.fromkeys(row.name for row in ROWS)
        raise InputError(
            "no closed form is known for this system with these values",
            where=layout.name,
            expected=f"one of: {', '.join(kinds)}",
        )
    return found


def loaded(closed: Closed, name: str = "closed_form") -> Callable[[ArrayLike], Array]:
    """Compile and load the motion; return the function of times (N,) that gives states (n, N).

    Raises `CompilerError` where there is no compiler.
    """
    text = single_text(closed, name)
    library = native.load(native.compile_library(text), text)
    function = getattr(library, f"{identifier(name)}_at")
    function.argtypes = [ctypes.c_size_t, ctypes.c_void_p, ctypes.c_void_p]
    function.restype = None

    def at(times: ArrayLike) -> Array:
        t = np.ascontiguousarray(times, dtype=np.float64)
        x = np.empty((len(closed.names), t.size))
        function(t.size, t.ctypes.data, x.ctypes.data)
        return x

    return at
