"""Compiled Jacobians and linearisation: A, B, C, D of a system at a point or along a trajectory.

``compiled.jacobian("states")`` (the same as `compiled_jacobian`) gives the sparse Jacobian of the
rates as a function; ``compiled.jacobian("parameters", "outputs")`` that of the outputs by the
parameters. `linearise` gives the dense matrices of the linear system about a point, or about every
point of a trajectory in one call::

    run = simulate(compiled, initial, (0, 10), parameters)
    p = [parameters[q.name] for q in compiled.layout.parameters]
    linear = linearise(compiled, run.y, p, t=run.t)      # linear.A[:, :, k] at run.t[k]

Rows and columns go as the names that `Linear` holds. Derivatives are taken of the program, not by
differences; where an operation has none (a corner, a tie) see `codegen.derivatives.derivative`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.compiling.compiled import TARGETS, Compiled
from codegen.compiling.sparse import SparseJacobian
from codegen.derivatives.derivative import JACOBIAN, UNIT, Jacobian, derive, identity
from codegen.frontend.layout import Layout
from codegen.ir.groups import INVARIANTS, OUTPUTS, RATES
from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import Program
from codegen.passes.pipeline import formed, join, optimise
from eom.errors import typed, unknown_name

Array = NDArray[np.float64]

KINDS: Mapping[str, str] = {
    "states": "state",
    "parameters": "parameter",
    "inputs": "input",
    "time": "time",
}
"""What can be differentiated by, and the slots that hold it."""
VALUES = "values"
"""The one group of a program whose Jacobian is compiled."""


@typed
def compiled_jacobian(
    compiled: Compiled, by: str = "states", of: str = RATES, target: str = ""
) -> SparseJacobian:
    """Return the compiled derivatives of a group of results by states, parameters, inputs or time.

    ``of``: rates, outputs, invariants or singularities. ``by``: states, parameters, inputs or time.
    ``target``: that of ``compiled`` if left out. The same arguments give the same object again, at once:
    ``compiled`` keeps it. Raises `InputError` for other words and for groups that the system does not
    have.

    Accuracy: derivatives are exact up to rounding, as no differences are taken. Units are those of the
    results over those of the variables.
    Source: Griewank and Walther, Evaluating Derivatives (2008), ch. 9 and 10: elimination of inner values.

    >>> import sympy as sp, codegen, eom
    >>> y, v, k = sp.symbols("y v k", real=True)
    >>> oscillator = eom.System.from_rates("oscillator", {y: v, v: -k * y})
    >>> compiled_jacobian(codegen.compile(oscillator, "numpy")).dense(0, [1, 0], [4])
    array([[ 0.,  1.],
           [-4.,  0.]])
    """
    if by not in KINDS:
        raise unknown_name("kind of variable", by, KINDS)
    if of not in compiled.layout.sizes:
        raise unknown_name("group of results", of, compiled.layout.sizes)
    if target and target not in TARGETS:
        raise unknown_name("target", target, TARGETS)
    return _kept(compiled, (of,), (by,), target or compiled.target)


def known_jacobian(compiled: Compiled) -> SparseJacobian | None:
    """Return the Jacobian of the rates by the states if ``compiled`` keeps it already, else None."""
    found = compiled.derived.get((compiled.target, RATES, "states"))
    return found if isinstance(found, SparseJacobian) else None


def _kept(
    compiled: Compiled, of: tuple[str, ...], by: tuple[str, ...], target: str
) -> SparseJacobian:
    """Return the derivatives of groups by kinds of variables, from what ``compiled`` keeps."""
    key = (target, *of, *by)
    if key not in compiled.derived:
        compiled.derived[key] = _derived(compiled, of, by, target)
    found = compiled.derived[key]
    assert isinstance(found, SparseJacobian)
    return found


def _derived(
    compiled: Compiled, of: tuple[str, ...], by: tuple[str, ...], target: str
) -> SparseJacobian:
    layout = compiled.layout
    derived = _differentiated(compiled.program, layout, of, by)
    results = tuple(n for group in of for n in layout.results[group])
    names = (*results, *(f"d{r}_{c}" for r, c in derived.pattern))
    own = _layout(layout, "_".join((*of, "by", *by)), names)
    whole = optimise(_one_group(formed(derived.program, compiled.stable), JACOBIAN))
    _, functions, _ = TARGETS[target](whole, own)
    return SparseJacobian(
        (len(results), sum(_count(layout, kind) for kind in by)),
        tuple(r for r, _ in derived.pattern),
        tuple(c for _, c in derived.pattern),
        functions[JACOBIAN],
        whole,
        own,
        derived.mode,
    )


def _differentiated(
    program: Program, layout: Layout, of: tuple[str, ...], by: tuple[str, ...]
) -> Jacobian:
    """Return values and derivatives of groups of results, by all slots of some kinds."""
    together = tuple(k for group in of for k in program.results[group])
    values = prune(replace(program, results={VALUES: together}))
    columns = [
        {Instruction(KINDS[kind], (), None if kind == "time" else k): UNIT}
        for kind in by
        for k in range(_count(layout, kind))
    ]
    return derive(values, VALUES, identity(values, VALUES), columns)


def with_jacobians(
    program: Program, layout: Layout, by: Sequence[str], stable: bool = False
) -> tuple[Program, Layout]:
    """Return program and layout with one more group of results a kind of variables in ``by``.

    The group ``rates_by_states`` (and so on) holds the rates and then the entries of their
    Jacobian that are not zero everywhere; ``layout.patterns`` says where these stand. Raises
    `InputError` for other words than those of `KINDS`.
    """
    for kind in by:
        if kind not in KINDS:
            raise unknown_name("kind of variable", kind, KINDS)
    programs = {group: prune(program, [group]) for group in program.results}
    results, patterns = dict(layout.results), dict(layout.patterns)
    for kind in dict.fromkeys(by):
        group = f"{RATES}_by_{kind}"
        derived = _differentiated(program, layout, (RATES,), (kind,))
        programs[group] = optimise(_one_group(formed(derived.program, stable), group))
        entries = (f"d{r}_{c}" for r, c in derived.pattern)
        results[group], patterns[group] = (*layout.results[RATES], *entries), derived.pattern
    return join(programs), replace(layout, results=results, patterns=patterns)


def _count(layout: Layout, kind: str) -> int:
    sizes = {
        "states": len(layout.states),
        "parameters": len(layout.parameters),
        "inputs": len(layout.inputs),
        "time": 1,
    }
    return sizes[kind]


def _layout(layout: Layout, suffix: str, names: tuple[str, ...]) -> Layout:
    results = {JACOBIAN: names, OUTPUTS: (), INVARIANTS: ()}
    return replace(layout, name=f"{layout.name}_{suffix}", results=results, coordinates=())


def _one_group(program: Program, group: str) -> Program:
    """Put the results before the entries of their Jacobian, as one group."""
    together = (*program.results[VALUES], *program.results[JACOBIAN])
    return replace(program, results={group: together})


@dataclass(frozen=True)
class Linear:
    """A linear system dx' = A dx + B du, dy = C dx + D du about a point, or about N points.

    ``A`` (n, n), ``B`` (n, m), ``C`` (o, n), ``D`` (o, m), with a last axis of N about N points, for n
    states, m inputs, o outputs. ``states``, ``inputs``, ``outputs``: their names, in the order of rows
    and columns. Units are those of the system.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


@typed
def linearise(
    compiled: Compiled,
    x: ArrayLike,
    p: ArrayLike | None = None,
    u: ArrayLike | None = None,
    t: ArrayLike = 0.0,
) -> Linear:
    """Return A, B, C, D at a point, or with a last axis of N at N points, such as a trajectory.

    Shapes: ``x`` (n,) or (n, N), and so for ``p``, ``u``, ``t``: the ``y``, ``t`` and parameters
    of a `codegen.Result` fit as they are. All four come from one call of one function, which is
    compiled at the first use and kept by ``compiled``. They are the linear part about any point;
    that dx' = A dx + B du alone describes the motion holds about points at rest. ``x``: states, ``p``:
    parameters, ``u``: inputs, ``t``: time, in the units of the system.
    Raises `InputError` as the compiled functions do. Source: as of `compiled_jacobian`.

    >>> import sympy as sp, codegen, eom
    >>> y, v, F = sp.symbols("y v F", real=True)
    >>> cart = eom.System.from_rates("cart", {y: v, v: F - sp.sin(y)}, inputs=[F])
    >>> near = linearise(codegen.compile(cart, "numpy"), [0, 0], u=[0])
    >>> near.A.tolist(), near.B.tolist()
    ([[0.0, 1.0], [-1.0, 0.0]], [[0.0], [1.0]])
    """
    layout = compiled.layout
    n, k = len(layout.states), len(layout.results[OUTPUTS])
    whole = _kept(compiled, (RATES, OUTPUTS), ("states", "inputs"), compiled.target)
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
