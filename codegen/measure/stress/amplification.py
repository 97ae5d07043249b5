"""What a small error of a state becomes later: the propagator of a case, by differences.

M(t) = d x(t)/d x(0) in units of the size of each state, from runs whose starts differ by a part in 1e6.
An error made at s is M(t) M(s)^-1 times as large at t, and M(s)^-1 times if it is carried back to 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.measure.stress.record import ABSOLUTE
from codegen.measure.stress.running import MAX_STEPS, Refusal, Run, attempt
from codegen.measure.workprecision.case import Case
from codegen.native.trajectory import Array

CHANGE = 1e-6
FINE = 1e-12
NODES = 8
UNKNOWN = 1e5
"""Amplification beyond which differences tell nothing more."""


@dataclass(frozen=True)
class Amplification:
    """Sizes of the states (n,), and what an error of one step of 1 rtol, anywhere, costs at most.

    ``forward``: at the end; ``back``: at the start, after the way back. Both are in units of rtol and
    of the sizes, for a local error of at most rtol (|x| + 1e-3).
    """

    sizes: Array
    forward: float
    back: float


def amplification(
    case: Case, compiled: Compiled, end: float, limit: float, max_steps: int = MAX_STEPS
) -> Amplification | str:
    """Return the amplification of a case until ``end``; or why it cannot be had."""
    method = "scipy:Radau" if case.stiff else "DOP853"
    nodes = np.linspace(0.0, end, NODES + 1)
    x0 = np.array([case.start[q.name] for q in compiled.system.states])
    free = {q.name: case.parameters[q.name] for q in compiled.layout.parameters}

    def run(start: Array, times: Array) -> Array | str:
        settings = Run(compiled, start, times, case.inputs, free, limit=limit, max_steps=max_steps)
        found = attempt(settings, method, FINE)
        if isinstance(found, Refusal):
            return found.reason
        return found.y if found.status == 0 else found.message

    plain = run(x0, nodes)
    if isinstance(plain, str):
        return plain
    sizes = sizes_of(plain)
    M = _propagator(run, plain, nodes, sizes)
    if isinstance(M, str):
        return M
    found = _bounds(M, sizes)
    if found.back < UNKNOWN:
        return found
    return _without_inverses(run, plain, nodes, sizes)


Runner = Callable[[Array, Array], Array | str]


def sizes_of(states: Array) -> Array:
    """Return the largest size of each state (n, N); states that are always zero have that of all."""
    largest = np.abs(states).max(axis=1)
    return np.where(largest > 0, largest, largest.max() or 1.0)


def _propagator(run: Runner, plain: Array, times: Array, sizes: Array) -> Array | str:
    """Return M (nodes, n, n) from the first of some times on; ``plain``: states at these."""
    columns = []
    for i, size in enumerate(sizes):
        moved = plain[:, 0].copy()
        moved[i] += CHANGE * size
        states = run(moved, times)
        if isinstance(states, str):
            return states
        columns.append((states - plain) / (CHANGE * sizes[:, None]))
    return np.array(columns).transpose(2, 1, 0)


def _without_inverses(run: Runner, plain: Array, nodes: Array, sizes: Array) -> Amplification | str:
    """Start at every node anew, where errors die out so far that M has no inverse; nothing comes back."""
    allowed = 1 + ABSOLUTE / sizes
    forward = float(allowed.max())
    for k in range(len(nodes) - 1):
        M = _propagator(run, plain[:, [k, -1]], nodes[[k, -1]], sizes)
        if isinstance(M, str):
            return M
        forward = max(forward, float((np.abs(M[-1]) @ allowed).max()))
    return Amplification(sizes, forward, np.inf)


def _bounds(M: Array, sizes: Array) -> Amplification:
    """Take the largest sum of a row: an error in each state, all in the worst sense."""
    allowed = 1 + ABSOLUTE / sizes
    with np.errstate(all="ignore"):
        inverses = [_inverse(m) for m in M]
        forward = max(float((np.abs(M[-1] @ v) @ allowed).max()) for v in inverses)
        back = max(float((np.abs(v) @ allowed).max()) for v in inverses)
    return Amplification(sizes, forward, back)


def _inverse(m: Array) -> Array:
    try:
        inverse: Array = np.asarray(np.linalg.inv(m), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.full_like(m, np.inf)
    return inverse
