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

from dataclasses import dataclass

from numpy.typing import ArrayLike

from codegen.compiling.checked import Array
from codegen.compiling.compiled import Compiled, kept_jacobian
from codegen.ir.program import OUTPUTS, RATES
from eom.errors import typed


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
