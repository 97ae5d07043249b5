"""Linear motion about equilibria and steady motions: matrices with names, eigenvalues, stability.

    point = equilibrium(compiled, guess, parameters)
    near = linearise_about(compiled, point)
    print(near.A, near.states, near.eigenvalues, near.stability.kind, near.agreement)

``agreement`` says how far a complex step with 50 digits, which uses no rule of differentiation, is from the
matrices. Along a trajectory `codegen.linearise` is quicker.

The complex step: Im f(x + i h) / h = f'(x) + O(h^2): nothing is subtracted, so that h may be so small that
the error is that of the arithmetic (Squire and Trapp, SIAM Review 40, 1998, p. 110). Operations that are no
analytic functions are extended by f(a + i b) = f(a) + i (f(a + b) - f(a - b))/2, which with so many digits
leaves more than double precision has; at a corner, where the three values do not lie on a line, there is
none. No rule of `codegen.derivatives.derivative` is used.

Which small deviations keep the constraints, and what the others are by these: a deviation of the states
that keeps functions G constant satisfies dG dx = 0, and what follows from it along the motion, dG A dx = 0
and so on: for a constraint of places its rate is found by itself. All of dG counts, also its part by the
coordinates of a constraint on speeds: without that, terms in proportion to the speed of the steady motion
would be lost (Meijaard, Papadopoulos, Ruina, Schwab, Proc. R. Soc. A 463, 2007, p. 1955). Unit quaternions
may deviate by three small angles.

Compiled Jacobians and linearisation: A, B, C, D of a system at a point or along a trajectory.

``compiled.jacobian("states")`` (the same as `compiled_jacobian`) gives the sparse Jacobian of the
rates as a function; ``compiled.jacobian("parameters", "outputs")`` that of the outputs by the
parameters. `linearise` gives the dense matrices of the linear system about a point, or about every
point of a trajectory in one call::

    run = simulate(compiled, initial, (0, 10), parameters)
    linear = linearise(compiled, run.y, parameters, t=run.t)      # linear.A[:, :, k] at run.t[k]

Rows and columns go as the names that `Linear` holds. Derivatives are taken of the program, not by
differences; where an operation has none (a corner, a tie) see `codegen.derivatives.derivative`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import mpmath
import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.compiling.checked import Values
from codegen.compiling.compiled import Compiled, compiled_of, kept_jacobian
from codegen.compiling.sampled import refuse
from codegen.frontend.attitude import quaternions_of
from codegen.frontend.layout import names_of
from codegen.frontend.notebook import listed, matrix, table
from codegen.ir.interpret import Point
from codegen.ir.ops import OPS, SOLVE, Instruction, Op, row_of
from codegen.ir.passes import needed
from codegen.ir.program import INVARIANTS, OUTPUTS, RATES, Program
from codegen.linearisation.unknowns import Equilibrium, leaves_of, maintained, tangents
from eom.errors import InputError, near_matches, typed, unknown_name
from eom.system import System


@dataclass(frozen=True, repr=False)
class Linear:
    """A linear system dx' = A dx + B du, dy = C dx + D du about a point, or about N points.

    Parameters
    ----------
    A : array
        (n, n), with a last axis of N about N points, as the others.
    B : array
        (n, m).
    C : array
        (o, n).
    D : array
        (o, m).
    states, inputs, outputs : tuple of str
        Their names, in the order of rows and columns.

    Notes
    -----
    ``A`` (n, n), ``B`` (n, m), ``C`` (o, n), ``D`` (o, m), for n states, m inputs, o outputs. Units
    are those of the system.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def __repr__(self) -> str:
        """Name states, inputs and outputs; the matrices are fields."""
        named = (("states", self.states), ("inputs", self.inputs), ("outputs", self.outputs))
        texts = [f"{kind} {listed(names)}" for kind, names in named if names]
        count = f", about {self.A.shape[2]} points" if self.A.ndim == 3 else ""
        return f"{type(self).__name__}({'; '.join(texts)}{count})"

    def _repr_html_(self) -> str:
        """Return what a notebook displays: the matrices, with the names of their rows and columns."""
        shown = [
            matrix(self.A, self.states, self.states, "A"),
            matrix(self.B, self.states, self.inputs, "B"),
            matrix(self.C, self.outputs, self.states, "C"),
            matrix(self.D, self.outputs, self.inputs, "D"),
        ]
        return "".join(shown) or table([(repr(self),)])


@typed
def linearise(
    compiled: Compiled | System,
    x: Values,
    p: Values | None = None,
    u: Values | None = None,
    t: ArrayLike = 0.0,
) -> Linear:
    """Return A, B, C, D at a point, or with a last axis of N at N points, such as a trajectory.

    Parameters
    ----------
    compiled : Compiled or System
        The system, compiled at the first call unless it is; it keeps the function of the four matrices.
    x : mapping or array
        States, (n,) or (n, N); by name each a number or (N,). ``y`` of a `codegen.Result` fits as it
        is.
    p : mapping or array, optional
        Parameters, in the same shapes.
    u : mapping or array, optional
        Inputs, in the same shapes.
    t : float or array, default 0
        Time, a number or (N,). All are in the units of the system.

    Returns
    -------
    Linear
        The matrices of dx' = A dx + B du, dy = C dx + D du, and the names of their rows and columns.

    Raises
    ------
    InputError
        As the compiled functions do.

    Notes
    -----
    The matrices are the linear part about any point; that dx' = A dx + B du alone describes the motion
    holds about points at rest, see `equilibrium` and `linearise_about`. All four come from one call of
    one function.

    References
    ----------
    The derivatives are those as of `compiled_jacobian`.

    Examples
    --------
    >>> import sympy as sp, codegen, eom
    >>> y, v, F = sp.symbols("y v F", real=True)
    >>> cart = eom.System.from_rates("cart", {y: v, v: F - sp.sin(y)}, inputs=[F])
    >>> near = linearise(codegen.compile(cart, "numpy"), {"y": 0, "v": 0}, u={"F": 0})
    >>> near.A.tolist(), near.B.tolist()
    ([[0.0, 1.0], [-1.0, 0.0]], [[0.0], [1.0]])
    """
    compiled = compiled_of(compiled)
    refuse(compiled, "linear motion")
    layout = compiled.layout
    n, k = len(layout.states), len(layout.results[OUTPUTS])
    whole = kept_jacobian(compiled, (RATES, OUTPUTS), ("states", "inputs"), compiled.target)
    matrix = whole.dense(t, x, p, u)
    return Linear(
        matrix[:n, :n],
        matrix[:n, n:],
        matrix[n : n + k, :n],
        matrix[n : n + k, n:],
        tuple(q.name for q in layout.states),
        tuple(q.name for q in layout.inputs),
        layout.results[OUTPUTS],
    )


Array = NDArray[np.float64]

ERROR_FACTOR = 100.0
"""How many times its bound an eigenvalue may be off before its sign is believed."""
LEAST_ROW, DOUBT = 1e-3, 1e-6
ATTITUDES = STATES, ANGLES = ("states", "angles")
"""How deviations of unit quaternions are named."""
STABLE, UNSTABLE, OPEN = "asymptotically stable", "unstable", "undecided"


@dataclass(frozen=True)
class Stability:
    """What the linear motion says of the motion near the point.

    ``kind``: ``asymptotically stable`` if all real parts are negative beyond their error, ``unstable``
    if one is positive beyond it; else ``undecided``: zero real parts prove nothing about stability.
    ``growth``: the largest real part (1/s); ``error``: of the eigenvalue that it belongs to.
    """

    kind: str
    growth: float
    error: float


@dataclass(frozen=True, repr=False)
class LinearMotion(Linear):
    """A linear motion dz' = A dz + B du, dy = C dz + D du; ``states`` are the names of z.

    Parameters
    ----------
    point : Equilibrium
        About which.
    agreement : float
        The largest difference to a complex step, relative to the largest entry of its row (at least
        a thousandth of the largest of all rows); NaN where that could not be made.
    eliminated : mapping of str to mapping of str to floats, optional
        What other states are by these, {state: {state: factor}}.
    dropped : tuple of str, optional
        Cyclic states, which nothing depends on.
    hidden : int, default 0
        How many constraints follow from those that were given.
    redundant : tuple of str, optional
        Those given that say nothing new.
    doubtful : tuple of str, optional
        States by their rates, and outputs, that differ by more than `DOUBT`: they have no
        derivative there, but a corner.

    Notes
    -----
    The others are as of `Linear`, with A (k, k) for k independent states. Units are those of the
    system.
    """

    point: Equilibrium
    agreement: float
    eliminated: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    dropped: tuple[str, ...] = ()
    hidden: int = 0
    redundant: tuple[str, ...] = ()
    doubtful: tuple[str, ...] = ()

    @cached_property
    def _eigen(self) -> tuple[NDArray[np.complex128], Array]:
        return eigenvalues(self.A)

    @property
    def eigenvalues(self) -> NDArray[np.complex128]:
        """The eigenvalues of A (1/s), largest real part first, (k,)."""
        return self._eigen[0]

    @property
    def errors(self) -> Array:
        """How far each eigenvalue may be off by rounding (1/s), (k,)."""
        return self._eigen[1]

    @cached_property
    def stability(self) -> Stability:
        """What the eigenvalues say."""
        return stability(*self._eigen)


@typed
def linearise_about(
    compiled: Compiled | System,
    point: Equilibrium,
    *,
    constraints: Iterable[str] = (),
    independent_states: Iterable[str] = (),
    attitude: str = STATES,
    check: bool = True,
) -> LinearMotion:
    """Return the linear motion about a point that `codegen.equilibrium` found, by independent states.

    Parameters
    ----------
    compiled : Compiled or System
        The system.
    point : Equilibrium
        Of the same system.
    constraints : iterable of str, optional
        Invariants or outputs that keep their values, beside the constraints that the system maintains;
        what follows from them along the motion is kept, too.
    independent_states : iterable of str, optional
        States to be kept.
    attitude : str, default "states"
        How unit quaternions are told: ``states``, of which one is lost, or ``angles``, three small ones
        (rad) about the body's axes, ``angle_<state>``.
    check : bool, default True
        Whether `agreement` is computed.

    Returns
    -------
    LinearMotion
        Matrices, eigenvalues and stability. Cyclic states are left out.

    Raises
    ------
    InputError
        For unknown names, and a point of another system.

    Notes
    -----
    Units are those of the system, eigenvalues are in 1/s.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), app. A, on the stability of linear systems; the check:
    Squire and Trapp, SIAM Review 40 (1998) 110.

    Examples
    --------
    >>> import sympy as sp, codegen, eom
    >>> q, u = sp.symbols("q u", real=True)
    >>> arm = codegen.compile(eom.System.from_rates("arm", {q: u, u: -sp.sin(q) - 2 * u}), "numpy")
    >>> near = linearise_about(arm, codegen.equilibrium(arm, {"q": 3.0}))
    >>> near.stability.kind, [round(float(value.real), 6) for value in near.eigenvalues]
    ('unstable', [0.414214, -2.414214])
    """
    compiled = compiled_of(compiled)
    layout, cyclic = compiled.layout, point.cyclic
    x, u, p = _arrays(compiled, point)
    full = _whole(compiled, x, u, p)
    if attitude not in ATTITUDES:
        raise unknown_name("attitude", attitude, ATTITUDES)
    fours = _quaternions(compiled, point)
    turned = fours if attitude == ANGLES else []
    unit = [] if attitude == ANGLES else fours
    free = free_states(x, full.states, cyclic, turned)
    given = (constraints,) if isinstance(constraints, str) else tuple(constraints)
    names = tuple(dict.fromkeys((*maintained(compiled), *given)))
    G = _slopes(compiled, names, x, u, p)
    G = np.vstack([G, _norms(x, unit)])
    labels = [*names, *(f"norm of {', '.join(full.states[k] for k in four)}" for four in unit)]
    basis, redundant = closed(G @ free.T, free.dynamics(full.A))
    preferred = _preferred(independent_states, free.names, layout.name)
    kept, eliminated = independent(free, basis, preferred)
    apart = (
        _differences(compiled, full, x, u, p)
        if check
        else np.full(len(full.A) + len(full.C), np.nan)
    )
    return LinearMotion(
        kept.dynamics(full.A), kept.S @ full.B, full.C @ kept.T, full.D,
        kept.names, full.inputs, full.outputs, point,
        _largest(apart),
        eliminated, cyclic, len(basis) - len(G) + len(redundant),
        tuple(labels[k] for k in redundant),
        _doubtful(full, apart) if check else (),
    )  # fmt: skip


def _largest(apart: Array) -> float:
    """Return the largest of what could be compared; NaN where nothing could."""
    known = apart[np.isfinite(apart)]
    return float(known.max(initial=0.0)) if known.size or not apart.size else float("nan")


def _doubtful(full: Linear, apart: Array) -> tuple[str, ...]:
    names = zip((*full.states, *full.outputs), apart, strict=True)
    return tuple(n for n, far in names if not far <= DOUBT)


def _arrays(compiled: Compiled, point: Equilibrium) -> tuple[Array, Array, Array]:
    refuse(compiled, "linear motion")
    layout = compiled.layout
    groups = (
        ("states", point.states, layout.states),
        ("inputs", point.inputs, layout.inputs),
        ("parameters", point.parameters, layout.parameters),
    )
    found = []
    for kind, given, known in groups:
        if tuple(given) != names_of(known):
            raise InputError(f"a point of another system: its {kind}", got=", ".join(given),
                             expected=", ".join(names_of(known)))  # fmt: skip
        found.append(np.array([*given.values()], dtype=np.float64))
    x, u, p = found
    return x, u, p


def _quaternions(compiled: Compiled, point: Equilibrium) -> list[tuple[int, ...]]:
    names = names_of(compiled.layout.states)
    found = quaternions_of(compiled.layout.attitudes)
    free = [f for f in found if not any(names[k] in point.cyclic for k in f)]
    for four in found:
        part = [names[k] in point.cyclic for k in four]
        if any(part) and not all(part):
            raise InputError("part of a quaternion is cyclic", got=", ".join(names[k] for k in four),
                             hint="all four of its states run, or none")  # fmt: skip
    return free


def _preferred(given: Iterable[str], known: Sequence[str], where: str) -> tuple[str, ...]:
    names = (given,) if isinstance(given, str) else tuple(given)
    for name in names:
        if name not in known:
            raise unknown_name("state", name, known, f"system {where!r}")
    return names


def _whole(compiled: Compiled, x: Array, u: Array, p: Array) -> Linear:
    """Return A, B, C, D by all states."""
    layout, n = compiled.layout, x.size
    point = Point(0.0, list(x), list(p), list(u))
    _, J = tangents(compiled.program, _groups(compiled), leaves_of(n, u.size), point)
    return Linear(
        J[:n, :n], J[:n, n:], J[n:, :n], J[n:, n:],
        names_of(layout.states), names_of(layout.inputs), layout.results[OUTPUTS],
    )  # fmt: skip


def _groups(compiled: Compiled) -> list[str]:
    return [g for g in (RATES, OUTPUTS) if g in compiled.program.results]


def _slopes(compiled: Compiled, names: Sequence[str], x: Array, u: Array, p: Array) -> Array:
    """Return the derivatives of invariants and outputs by the states."""
    results = compiled.layout.results
    groups = [g for g in (OUTPUTS, INVARIANTS) if results[g]]
    known = [n for g in groups for n in results[g]]
    for name in names:
        if name not in known:
            raise InputError(
                "unknown constraint", where=f"system {compiled.layout.name!r}", got=name,
                expected="an invariant or an output", hint=near_matches(name, known),
            )  # fmt: skip
    if not names:
        return np.zeros((0, x.size))
    point = Point(0.0, list(x), list(p), list(u))
    _, J = tangents(compiled.program, groups, leaves_of(x.size, 0), point)
    return J[[known.index(name) for name in names]]


def _norms(x: Array, fours: Sequence[Sequence[int]]) -> Array:
    rows = np.zeros((len(fours), x.size))
    for row, four in zip(rows, fours, strict=True):
        row[list(four)] = x[list(four)]
    return rows


def _differences(compiled: Compiled, full: Linear, x: Array, u: Array, p: Array) -> Array:
    """Return how far a complex step is from the derivatives, for each row relative to its largest.

    Rows that vanish do so to the rounding of terms that cancel: sizes are at least `LEAST_ROW` of the
    largest.
    """
    ours = np.block([[full.A, full.B], [full.C, full.D]])
    point = Point(0.0, list(x), list(p), list(u))
    leaves = leaves_of(x.size, u.size)
    other = complex_step(compiled.program, _groups(compiled), leaves, point)
    known = np.where(np.isfinite(other), np.abs(other), 0.0)
    size = np.max(known, axis=1, initial=0.0, keepdims=True)
    size = np.maximum(size, LEAST_ROW * np.max(size, initial=0.0))
    apart = np.abs(ours - other) / np.where(size > 0, size, 1.0)
    return np.asarray(np.max(apart, axis=1, initial=0.0))


def eigenvalues(A: Array) -> tuple[NDArray[np.complex128], Array]:
    """Return the eigenvalues, largest real part first, and how far rounding may put each off.

    A is taken as known to its rounding. The error of an eigenvalue is that of the smallest group of those
    next to it that stands apart from the others (`_error`): of itself alone where it is simple, of all that
    are one but for rounding where it is multiple; defective ones are known to a part of the digits.
    """
    from scipy.linalg import eig, schur

    if not A.size:
        return np.zeros(0, dtype=np.complex128), np.zeros(0)
    found: NDArray[np.complex128] = eig(A, right=False)
    values = np.array(sorted(found, key=lambda value: (-value.real, abs(value.imag), -value.imag)))
    T, Z = schur(A, output="complex")
    off = float(np.finfo(float).eps * np.linalg.norm(A))
    return values, np.array([_error(T, Z, value, off) for value in values])


def _error(T: Array, Z: Array, value: complex, off: float) -> float:
    """Return how far an eigenvalue of the Schur form Z T Z* is off by what is at most ``off`` in norm.

    The first k of a reordered form, with p the norm of their spectral projector, have eigenvalues of
    T11 + F, |F| <= p off (1 + 2 p off / (sep - 2 p off)), where sep(T11, T22) > 4 p off (Stewart, SIAM
    Review 15, 1973, p. 727; in the basis in which T12 = 0). So far the group stands apart. Those of
    M + F are within (|M| + |M + F|)^(1 - 1/k) |F|^(1/k) of those of M (Elsner, Linear Algebra Appl. 71,
    1985, p. 77), of which M is T11 about its mean. LAPACK's trsen estimates p from above and sep.
    """
    from scipy.linalg.lapack import ztrsen

    n = len(T)
    order = np.argsort(np.abs(np.diag(T) - value), kind="stable")
    group, most = T, off
    for k in range(1, n):
        first = np.isin(np.arange(n), order[:k])
        form, _, _, _, s, sep, _ = ztrsen(first, T, Z, job="B", lwork=2 * k * (n - k))
        moved = off / s
        if sep > 4 * moved:
            group, most = form[:k, :k], moved * (1 + 2 * moved / (sep - 2 * moved))
            break
    k = len(group)
    about = group - np.mean(np.diag(group)) * np.eye(k)
    return float((2 * np.linalg.norm(about, 2) + most) ** (1 - 1 / k) * most ** (1 / k))


def stability(values: NDArray[np.complex128], errors: Array) -> Stability:
    """Return what eigenvalues and their errors say; with care about zero real parts."""
    if not values.size:
        return Stability(OPEN, 0.0, 0.0)
    bounds = ERROR_FACTOR * errors
    first = int(np.argmax(values.real))
    kind = OPEN
    if np.any(values.real > bounds):
        kind = UNSTABLE
    elif np.all(values.real < -bounds):
        kind = STABLE
    return Stability(kind, float(values.real[first]), float(errors[first]))


DIGITS = 50
STEP_DIGITS = 20
"""The step is 10 to minus this: its square, and what differences lose, are below 1e-29."""
_ANALYTIC = frozenset({
    "add", "sub", "mul", "div", "neg", "sqrt", "pow", "sin", "cos", "tan", "atan", "sinh", "cosh",
    "tanh", "asinh", "exp", "log", "log1p", "expm1", *SOLVE,
})  # fmt: skip
"""Operations whose row at any precision holds for complex numbers as it is."""


def complex_step(
    program: Program, groups: Sequence[str], by: Sequence[Instruction], point: Point
) -> Array:
    """Return the derivatives of groups of results, one after the other, by leaves: (results, leaves).

    ``by``: instructions of states, inputs, parameters or time, without operands. NaN where an operation
    has no value or a corner.
    """
    m = mpmath.mp.clone()
    m.dps = DIGITS
    step = m.mpf(10) ** -STEP_DIGITS
    order = sorted(needed(program, list(groups)))
    places = [k for group in groups for k in program.results[group]]
    columns = [_values(m, program, order, point, leaf, step) for leaf in by]
    found = np.array(
        [[float(m.im(column[k]) / step) for column in columns] for k in places], dtype=np.float64
    )
    return found.reshape(len(places), len(by))


def _values(
    m: Any,
    program: Program,
    order: Sequence[int],
    point: Point,
    seed: Instruction,
    step: Any,
) -> Mapping[int, Any]:
    values: dict[int, Any] = {}
    for k in order:
        instruction = program.instructions[k]
        if instruction.op in OPS:
            args = [values[a] for a in instruction.args]
            values[k] = _operation(m, row_of(instruction), args)
        else:
            values[k] = _leaf(m, instruction, point)
            if instruction == seed:
                values[k] = m.mpc(values[k], step)
    return values


def _leaf(m: Any, instruction: Instruction, point: Point) -> Any:
    if instruction.op == "const":
        number: Any = instruction.value
        return m.mpf(number.numerator) / number.denominator
    return +m.pi if instruction.op == "pi" else m.mpf(point.slot(instruction))


def _operation(m: Any, row: Op, args: list[Any]) -> Any:
    """Return a value; real where all operands are, so that what does not vary stays exact."""
    varies = row.name in SOLVE or any(isinstance(a, m.mpc) for a in args)
    try:
        if row.name in _ANALYTIC or not varies:
            return row.exact(m, *args)
        if row.name == "select":
            return row.exact(m, m.re(args[0]), *args[1:])
        return _extended(m, row, args)
    except (ValueError, ZeroDivisionError, OverflowError):
        return m.nan


def _extended(m: Any, row: Op, args: list[Any]) -> Any:
    here = [m.re(a) for a in args]
    value = row.exact(m, *here)
    above, below = (
        row.exact(m, *(a + sign * m.im(b) if isinstance(b, m.mpc) else a
                       for a, b in zip(here, args, strict=True)))
        for sign in (1, -1)
    )  # fmt: skip
    most = max(abs(m.im(a)) for a in args)
    if abs(above + below - 2 * value) > most * m.sqrt(most):  # in proportion to the step: a corner
        return m.nan
    return m.mpc(value, (above - below) / 2)


SPAN = 1e-9
"""Rows that differ relatively less than this from combinations of others are combinations of them."""
NOISE = 1e-12
"""What follows along the motion counts from this on, relative to the matrix of the motion."""


@dataclass(frozen=True)
class Deviations:
    """Deviations dx = T dz of the states, dz = S dx; ``names`` of dz. S T = 1."""

    T: Array
    S: Array
    names: tuple[str, ...]

    def dynamics(self, A: Array) -> Array:
        """Return the matrix of dz by that of dx."""
        return np.asarray(self.S @ A @ self.T)


def free_states(
    x: Array, names: Sequence[str], dropped: Sequence[str], fours: Sequence[Sequence[int]] = ()
) -> Deviations:
    """Return deviations of the states but those that are dropped.

    Each of the unit quaternions ``fours`` (at rest, scalar first) has three small angles about the body's
    axes instead: dq = q (0, theta) / 2, theta = 2 vec(q* dq).
    """
    inside = {k for four in fours for k in four}
    plain = [k for k, n in enumerate(names) if n not in dropped and k not in inside]
    columns, rows = [np.eye(len(names))[:, plain]], [np.eye(len(names))[plain]]
    labels = [names[k] for k in plain]
    for four in fours:
        block = np.zeros((len(names), 3))
        block[list(four)] = _products(x[list(four)])
        columns.append(block / 2)
        rows.append(2 * block.T)
        labels += [f"angle_{names[k]}" for k in four[1:]]
    return Deviations(np.hstack(columns), np.vstack(rows), tuple(labels))


def _products(q: Array) -> Array:
    """Return the columns of q (0, e_k)."""
    a, b, c, d = q
    return np.array([[-b, -c, -d], [a, -d, c], [d, a, -b], [-c, b, a]])


def closed(G: Array, A: Array) -> tuple[Array, list[int]]:
    """Return an orthonormal basis of the rows G, G A, G A^2, ..., and the rows of G that add nothing."""
    basis = np.zeros((0, A.shape[0]))
    redundant = []
    for k, row in enumerate(G):
        longer = _with(basis, row, SPAN * float(np.linalg.norm(row)))
        if longer is None:
            redundant.append(k)
        else:
            basis = longer
    done = 0
    while done < len(basis):
        longer = _with(basis, basis[done] @ A, NOISE * float(np.linalg.norm(A)))
        basis = basis if longer is None else longer
        done += 1
    return basis, redundant


def _with(basis: Array, row: Array, least: float) -> Array | None:
    """Return a basis with what a row adds to it; None if that is no longer than ``least``."""
    rest = row - basis.T @ (basis @ row)
    rest = rest - basis.T @ (basis @ rest)
    if np.linalg.norm(rest) <= least:
        return None
    return np.vstack([basis, rest / np.linalg.norm(rest)])


def independent(
    before: Deviations, basis: Array, preferred: Sequence[str] = ()
) -> tuple[Deviations, dict[str, dict[str, float]]]:
    """Return deviations that keep the rows of a basis, by some of the names before; and the others.

    Which become dependent is chosen by the largest pivots, not among ``preferred``. They are returned
    as {dependent: {independent: factor}}. Raises `InputError` where the preferred ones are not independent.
    """
    rows, places = basis.copy(), []
    for k in range(len(rows)):
        open_ = [j for j in range(rows.shape[1]) if before.names[j] not in preferred]
        sizes = np.abs(rows[k:][:, open_])
        if not open_ or np.max(sizes) <= SPAN:
            raise InputError(
                "these states are not independent", got=", ".join(preferred),
                expected=f"{rows.shape[1] - len(rows)} that the constraints leave free",
            )  # fmt: skip
        i, j = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
        place = open_[int(j)]
        rows[[k, k + int(i)]] = rows[[k + int(i), k]]
        rows[k] /= rows[k, place]
        for other in range(len(rows)):
            if other != k:
                rows[other] -= rows[other, place] * rows[k]
        places.append(place)
    kept = [j for j in range(rows.shape[1]) if j not in places]
    T = np.zeros((rows.shape[1], len(kept)))
    T[kept, range(len(kept))] = 1.0
    for row, place in zip(rows, places, strict=True):
        T[place] = -row[kept]
    S = np.eye(rows.shape[1])[kept]
    names = tuple(before.names[j] for j in kept)
    parts = {before.names[p]: {n: float(f) for n, f in zip(names, T[p], strict=True) if abs(f) > SPAN}
            for p in sorted(places)}  # fmt: skip
    return Deviations(before.T @ T, S @ before.S, names), parts
