"""What the methods on the group of rotations share: variables, functions in C, dense output.

A system with a quaternion in the variables of a Lie group: q, and momentum in the reference frame.

A rigid body is moved by its angular momentum with components in the frame A that attitude is measured
from, pi = C^T J omega:

    dq/dt = q (0, w)/2,   w = omega - C n,   omega = J^-1 C pi,   d pi/dt = C^T tau - n x pi.

Without torque and with n = 0, pi stays as it is to the last bit, and so does H, which is its length. A
quaternion without a body keeps the other states as they are, and w is the vector part of 2 q* dq/dt.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.frontend.attitude import (
    CONSTANT_RATES,
    FRAME,
    INERTIA,
    TORQUE,
    Attitude,
    Body,
    attitude_of,
    body_rates,
)
from codegen.frontend.layout import Layout, names_of
from codegen.ir.names import comment, identifier
from codegen.ir.passes import (
    Numbers,
    copied,
    cross,
    inverse_times,
    prune,
    rotation,
    symmetric,
    times,
    total,
    transposed_times,
)
from codegen.ir.program import RATES, SINGULARITIES, Builder, Program
from codegen.loops import projection, running, samples
from codegen.loops.running import NativeMethod
from codegen.native.trajectory import Array, Held, Problem, Stepwise, Trajectory, pointer
from codegen.passes.pipeline import optimise
from codegen.targets import c
from eom.errors import InputError

SLOPES, STATES, ERRORS, ROUNDING, START, FIXED, KICK, CONSTANTS = (
    "slopes", "states", "errors", "rounding", "start", "fixed", "kick", "constants"
)  # fmt: skip


@dataclass(frozen=True)
class Variables:
    """Where the variables v beside the quaternion come from: pi first, if there is a body."""

    attitude: Attitude
    count: int
    """Number of states of the system."""

    @property
    def momentum(self) -> int:
        """Number of components of pi: 3, or 0 without a body."""
        return 3 if self.attitude.body else 0

    @property
    def number(self) -> int:
        """Number of the variables."""
        return self.momentum + len(self.attitude.others)

    @property
    def compared(self) -> list[int]:
        """The states whose errors count: q, the body rates (-1 for one that is none), the others."""
        body = self.attitude.body
        return [*self.attitude.quaternion, *(body.rates if body else ()), *self.attitude.others]


def local(program: Program, variables: Variables) -> Program:
    """Return `SLOPES`, (w, dv/dt), and `STATES` of the system over slots (q, v); `ERRORS`, `ROUNDING`.

    Law: along every solution of the system with |q| = 1, q and v that `start` gives satisfy
    dq/dt = q (0, w)/2 and the rates of v, and `STATES` gives back the states. `ERRORS`, over slots
    (q, v, a, e), are those of `Variables.compared` where q is off by the turn a and v by e, to first
    order. `ROUNDING`: what an error of |pi| in each component of pi makes of the body rates, at most.
    """
    b = Builder(program.rules)
    slots, states, turn = _changed(b, variables)
    rates = prune(program, [RATES])
    new = copied(b, rates, {("state", s): k for s, k in enumerate(states)})
    slopes = [new[k] for k in rates.results[RATES]]
    body = variables.attitude.body
    if body is None:
        q = variables.attitude.quaternion
        w, momentum = _turn_rate(b, slots[:4], [slopes[s] for s in q]), []
    else:
        w, momentum = turn, _momentum_rate(b, body, states, slots)
    others = [slopes[s] for s in variables.attitude.others]
    return optimise(
        b.program(
            {
                SLOPES: [*w, *momentum, *others],
                STATES: states,
                ERRORS: _errors(b, variables, slots),
                ROUNDING: _rounding(b, body, slots) if body else [],
            }
        )
    )


def kicks(program: Program, variables: Variables) -> Program:
    """Return `KICK`, tau and C^T tau over the slots of q, 0 to 3, and `CONSTANTS`.

    Only for a body whose torque does not depend on its rates, nor on other states. `CONSTANTS`: six
    entries of J, n, and the body rates that are constant, 0 for others.
    """
    body = variables.attitude.body
    assert body is not None
    b = Builder(program.rules)
    slots = [b.leaf("state", k) for k in range(4)]
    given = zip(variables.attitude.quaternion, slots, strict=True)
    assert {i.slot for i in body.torque.instructions if i.op == "state"} <= {
        *variables.attitude.quaternion
    }
    new = copied(b, body.torque, {("state", s): k for s, k in given})
    torque = [new[k] for k in body.torque.results[TORQUE]]
    turned = transposed_times(b, rotation(b, slots), torque)
    values = copied(b, body.values, {})
    groups = (INERTIA, FRAME, CONSTANT_RATES)
    constants = [values[k] for g in groups for k in body.values.results[g]]
    return optimise(b.program({KICK: [*torque, *turned], CONSTANTS: constants}))


def start(program: Program, variables: Variables) -> Program:
    """Return the variables v over the slots of the system, `START`; the rates that are none, `FIXED`."""
    b = Builder(program.rules)
    body = variables.attitude.body
    momentum: list[int] = []
    constants: list[int] = []
    if body is not None:
        values = copied(b, body.values, {})
        J = symmetric([values[k] for k in body.values.results[INERTIA]])
        constants = [values[k] for k in body.values.results[CONSTANT_RATES]]
        omega = body_rates(b, body.rates, constants)
        C = rotation(b, [b.leaf("state", s) for s in variables.attitude.quaternion])
        momentum = transposed_times(b, C, times(b, J, omega))
    others = [b.leaf("state", s) for s in variables.attitude.others]
    return optimise(b.program({START: [*momentum, *others], FIXED: constants}))


def _changed(b: Builder, variables: Variables) -> tuple[list[int], list[int], list[int]]:
    """Return the slots (q, v), the states of the system over them, and w of a body."""
    slots = [b.leaf("state", k) for k in range(4 + variables.number)]
    states = [b.const(0)] * variables.count
    for k, s in enumerate(variables.attitude.quaternion):
        states[s] = slots[k]
    for k, s in enumerate(variables.attitude.others):
        states[s] = slots[4 + variables.momentum + k]
    body = variables.attitude.body
    if body is None:
        return slots, states, []
    values = copied(b, body.values, {})
    C = rotation(b, slots[:4])
    J = symmetric([values[k] for k in body.values.results[INERTIA]])
    omega = inverse_times(b, J, times(b, C, slots[4:7]))
    for k, s in enumerate(body.rates):
        if s >= 0:
            states[s] = omega[k]
    n = times(b, C, [values[k] for k in body.values.results[FRAME]])
    return slots, states, [b.add("sub", w, turn) for w, turn in zip(omega, n, strict=True)]


def _momentum_rate(b: Builder, body: Body, states: Numbers, slots: Numbers) -> list[int]:
    values = copied(b, body.values, {})
    n = [values[k] for k in body.values.results[FRAME]]
    turned = _torque(b, body, states, slots)
    turning = cross(b, n, slots[4:7])
    return [b.add("sub", t, c) for t, c in zip(turned, turning, strict=True)]


def _torque(b: Builder, body: Body, states: Numbers, slots: Numbers) -> list[int]:
    """Return C^T tau."""
    new = copied(b, body.torque, {("state", s): k for s, k in enumerate(states)})
    torque = [new[k] for k in body.torque.results[TORQUE]]
    return transposed_times(b, rotation(b, slots[:4]), torque)


def _turn_rate(b: Builder, q: Numbers, slopes: Numbers) -> list[int]:
    """Return the vector part of 2 q* dq/dt."""
    turning = cross(b, q[1:], slopes[1:])
    rate = []
    for k in range(3):
        plain = b.add("mul", q[0], slopes[k + 1])
        lost = b.add("add", b.add("mul", slopes[0], q[k + 1]), turning[k])
        rate.append(b.add("mul", b.const(2), b.add("sub", plain, lost)))
    return rate


def _inertia(b: Builder, body: Body) -> list[list[int]]:
    values = copied(b, body.values, {})
    return symmetric([values[k] for k in body.values.results[INERTIA]])


def _errors(b: Builder, variables: Variables, slots: Numbers) -> list[int]:
    """Return q (0, a)/2, J^-1 (C e + (C pi) x a), and e of the others."""
    D, q = 4 + variables.number, slots[:4]
    turn = [b.leaf("state", D + k) for k in range(3)]
    off = [b.leaf("state", D + 3 + k) for k in range(variables.number)]
    half = [b.add("mul", b.const(Fraction(1, 2)), a) for a in turn]
    scalar = b.add("neg", total(b, zip(q[1:], half, strict=True)))
    vector = [
        b.add("add", b.add("mul", q[0], h), c)
        for h, c in zip(half, cross(b, q[1:], half), strict=True)
    ]
    body = variables.attitude.body
    if body is None:
        return [scalar, *vector, *off]
    C = rotation(b, q)
    turned = cross(b, times(b, C, slots[4:7]), turn)
    moved = times(b, C, off[:3])
    sums = [b.add("add", m, t) for m, t in zip(moved, turned, strict=True)]
    return [scalar, *vector, *inverse_times(b, _inertia(b, body), sums), *off[3:]]


def _rounding(b: Builder, body: Body, slots: Numbers) -> list[int]:
    J, pi = _inertia(b, body), slots[4:7]
    length = b.add("sqrt", total(b, zip(pi, pi, strict=True)))
    units = [[b.const(int(i == k)) for i in range(3)] for k in range(3)]
    inverse = [[b.add("abs", v) for v in inverse_times(b, J, unit)] for unit in units]
    rows = [b.add("add", b.add("add", x, y), z) for x, y, z in zip(*inverse, strict=True)]
    return [b.add("mul", length, row) for row in rows]


Pointer = int | None
Between = Callable[[Pointer, Pointer, int, int, int, int], None]
"""The function of the generated file that evaluates rows: parameters, inputs, count, theta, rows, x."""


def variables_of(method: str, layout: Layout) -> Variables:
    """Return the variables of a system. Raises `InputError` unless it states one unit quaternion."""
    attitude = attitude_of(layout.attitudes, len(layout.states))
    if attitude is None:
        raise InputError(
            f"method {method} needs one unit quaternion that the system states, not none or several",
            where=layout.name,
            got=", ".join(names_of(layout.states)),
            expected="four states q, scalar first, with dq/dt = q (0, omega)/2",
            hint='ask for attitude = "quaternion", state attitudes=[BodyAttitude(...)] of a system from '
            "elsewhere, or choose another method",
        )
    return Variables(attitude, len(layout.states))


@dataclass(frozen=True)
class Functions:
    """Functions of a generated file, and how many constants each of them keeps, by name."""

    text: str
    constants: dict[str, int]


def functions(prefix: str, parts: Sequence[tuple[Program, str, str]]) -> Functions:
    """Return static functions ``prefix``_name of groups of programs: (program, group, name)."""
    lines: list[str] = []
    constants = {}
    for program, group, name in parts:
        own, count = c.kernels(program, group, f"{prefix}_{name}")
        lines += own
        constants[name] = max(1, count)
    return Functions("\n".join(lines), constants)


def values(layout: Layout, suffix: str) -> dict[str, str]:
    """Return what the templates of every method need to know of a system."""
    name, singular = identifier(layout.name), len(layout.results[SINGULARITIES])
    prefix = f"{name}_{suffix}"
    text = resources.files("codegen.loops").joinpath("quaternions.c").read_text("ascii")
    return {
        "TITLE": comment(layout.title),
        "NAME": name,
        "PREFIX": prefix,
        "UPPER": prefix.upper(),
        "HEADER": f"{prefix}.h",
        "STATES": str(len(layout.states)),
        "SINGULARITIES": str(singular),
        "SINGULAR_ROOM": str(max(1, singular)),
        "COORDINATES": ", ".join(map(str, layout.coordinates)),
        "QUATERNIONS": text,
        **projection.NONE,
    }


def single_text(
    program: Program, layout: Layout, suffix: str, texts: Mapping[str, str], sampled: bool = False
) -> str:
    """Return an integrator and the functions that it calls as one text that compiles by itself.

    ``sampled``: with what stands round the loop where laws are sampled.
    """
    name = identifier(layout.name)
    rest = "".join(texts.values()).replace(f'#include "{name}.h"\n', "")
    rest = rest.replace(f'#include "{name}_{suffix}.h"\n', "")
    if sampled:
        rest = samples.around(rest, suffix, layout)
    return c.single_text(program, layout, rest) + rest


def check_sampled(method: str, layout: Layout, programs: Sequence[tuple[Program, str]]) -> None:
    """Raise `InputError` where variables of a method are made of inputs, which jump at samples.

    ``programs``: with the group, of what must not read them.
    """
    for program, name in programs:
        if any(i.op == "input" for i in prune(program, [name]).instructions):
            raise InputError(
                f"method {method} cannot change inputs on the way that its variables are made of",
                where=layout.name,
                got="sampled laws, and a momentum that reads inputs",
                hint="choose DOP853 or taylor",
            )


def between(library: ctypes.CDLL, prefix: str) -> Between:
    """Return the function that evaluates rows of dense output."""
    function: Any = getattr(library, f"{prefix}_between")
    pointer, size = ctypes.c_void_p, ctypes.c_size_t
    function.argtypes, function.restype = [pointer, pointer, size, pointer, pointer, pointer], None
    return function  # type: ignore[no-any-return]


def unbound(*_: Array) -> None:
    """Stand where `integrate` puts the dense output of a problem, which needs its parameters."""


def integrate(method: NativeMethod, evaluate: Between, problem: Problem) -> Trajectory:
    """Integrate a problem; its dense output is evaluated with its own parameters and inputs."""
    if not problem.dense_output:
        return running.integrate(method, problem)

    def solution(t: Array, h: Array, x: Array, rows: Array) -> RowSolution:
        return RowSolution(t, h, x, rows, evaluate, problem)

    made = running.integrate(replace(method, solution=solution), problem)
    if made.held is not None and made.solution is not None:
        made.solution.held = made.held
        if problem.t_eval is not None:
            made = replace(made, y=np.ascontiguousarray(made.solution(made.t)))
    return made


class RowSolution(Stepwise):
    """Partial steps on the group, evaluated in C."""

    def __init__(
        self, t: Array, h: Array, x: Array, rows: Array, evaluate: Between, problem: Problem
    ) -> None:
        super().__init__(t, h, x, rows)
        self._evaluate, self._problem = evaluate, problem
        self.held: Held | None = None
        """What inputs were held at, where they changed between steps."""

    def _within(self, k: NDArray[np.intp], since: Array) -> Array:
        if self.held is None:
            return self._under(self._problem.inputs, k, since)
        value = np.empty((len(k), self._x.shape[1]))
        inputs, which = np.unique(self.held.at(self.ts[k]), axis=1, return_inverse=True)
        for number, u in enumerate(inputs.T):
            own = which.ravel() == number
            value[own] = self._under(np.ascontiguousarray(u), k[own], since[own])
        return value

    def _under(self, u: Array, k: NDArray[np.intp], since: Array) -> Array:
        """Return the states in steps that were made under inputs ``u``."""
        theta = np.ascontiguousarray(since / self._h[k])
        rows = np.ascontiguousarray(self._rows[k])
        value = np.empty((len(k), self._x.shape[1]))
        self._evaluate(
            pointer(self._problem.parameters), pointer(u), len(k),
            theta.ctypes.data, rows.ctypes.data, value.ctypes.data,
        )  # fmt: skip
        return value
