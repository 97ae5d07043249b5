"""Compiled Jacobians and linearisation: A, B, C, D of a system at a point or along a trajectory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.compiled import TARGETS, Compiled, Function
from codegen.derivative import JACOBIAN, colouring, jacobian
from codegen.layout import Layout
from codegen.lower import INVARIANTS, OUTPUTS, RATES
from codegen.passes import prune
from codegen.program import Program
from codegen.stable import rewritten, rewritten_freely
from eom.errors import unknown_name

Array = NDArray[np.float64]

KINDS: Mapping[str, str] = {
    "states": "state",
    "parameters": "parameter",
    "inputs": "input",
    "time": "time",
}
"""What can be differentiated by, and the slots that hold it."""


@dataclass(frozen=True)
class SparseJacobian:
    """The derivatives of one group of results, and the results with them, from one function.

    ``rows``, ``columns``: place of each entry that is not zero everywhere. A call gives these
    entries, in shape (entries,) for one point or (entries, N) for N points.
    """

    shape: tuple[int, int]
    rows: tuple[int, ...]
    columns: tuple[int, ...]
    function: Function
    program: Program

    def __call__(
        self, t: ArrayLike, x: ArrayLike, p: ArrayLike | None = None, u: ArrayLike | None = None
    ) -> Array:
        """Return the entries. Raises `InputError` for wrong shapes and types."""
        return self.with_value(t, x, p, u)[1]

    def with_value(
        self, t: ArrayLike, x: ArrayLike, p: ArrayLike | None = None, u: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Return the results and the entries; both from one evaluation."""
        everything = self.function(t, x, p, u)
        return everything[: self.shape[0]], everything[self.shape[0] :]

    def dense(
        self, t: ArrayLike, x: ArrayLike, p: ArrayLike | None = None, u: ArrayLike | None = None
    ) -> Array:
        """Return the whole matrix, in shape ``shape`` or (*shape, N)."""
        entries = self(t, x, p, u)
        whole = np.zeros((*self.shape, *entries.shape[1:]))
        whole[list(self.rows), list(self.columns)] = entries
        return whole

    def sparse(
        self, t: float, x: ArrayLike, p: ArrayLike | None = None, u: ArrayLike | None = None
    ) -> Any:
        """Return the matrix at one point as a SciPy CSR array."""
        from scipy.sparse import csr_array

        entries = self(t, x, p, u)
        return csr_array((entries, (list(self.rows), list(self.columns))), shape=self.shape)

    @cached_property
    def colours(self) -> dict[int, int]:
        """A colour for each column; columns of one colour share no row."""
        return colouring(zip(self.rows, self.columns, strict=True))


def compiled_jacobian(
    compiled: Compiled, by: str = "states", of: str = RATES, target: str = ""
) -> SparseJacobian:
    """Differentiate a group of results (``rates``, ``outputs``, ...) by states, inputs, ...

    ``by``: states, parameters, inputs or time. ``target``: that of ``compiled`` if left out.
    Raises `InputError` for other words and for groups that the system does not have.

    Accuracy: derivatives are exact up to rounding, as no differences are taken.
    """
    if by not in KINDS:
        raise unknown_name("kind of variable", by, KINDS)
    if of not in compiled.layout.sizes:
        raise unknown_name("group of results", of, compiled.layout.sizes)
    derived = jacobian(prune(compiled.program, [of]), of, KINDS[by])
    stable = rewritten if compiled.stable else rewritten_freely
    form = stable(derived.program).program
    sizes = {
        "states": len(compiled.layout.states),
        "parameters": len(compiled.layout.parameters),
        "inputs": len(compiled.layout.inputs),
        "time": 1,
    }
    results = compiled.layout.results[of]
    names = (*results, *(f"d{r}_{c}" for r, c in derived.pattern))
    layout = _layout(compiled.layout, f"{of}_by_{by}", names)
    program = _one_group(form, of)
    _, functions, _ = TARGETS[target or compiled.target](program, layout)
    return SparseJacobian(
        (len(results), sizes[by]),
        tuple(r for r, _ in derived.pattern),
        tuple(c for _, c in derived.pattern),
        functions[JACOBIAN],
        form,
    )


def _layout(layout: Layout, suffix: str, names: tuple[str, ...]) -> Layout:
    results = {JACOBIAN: names, OUTPUTS: (), INVARIANTS: ()}
    return replace(layout, name=f"{layout.name}_{suffix}", results=results, coordinates=())


def _one_group(program: Program, of: str) -> Program:
    """Put the results before the entries of their Jacobian."""
    together = (*program.results[of], *program.results[JACOBIAN])
    return replace(program, results={JACOBIAN: together})


@dataclass(frozen=True)
class Linear:
    """dx' = A dx + B du, dy = C dx + D du about a point; names in the order of rows and columns."""

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def linearise(
    compiled: Compiled,
    x: ArrayLike,
    p: ArrayLike | None = None,
    u: ArrayLike | None = None,
    t: ArrayLike = 0.0,
) -> Linear:
    """Return A, B, C, D at a point, or with a last axis of N at N points, such as a trajectory.

    Shapes: ``x`` (n,) or (n, N), and so for ``p``, ``u``, ``t``. Raises `InputError` as the
    compiled functions do.
    """

    def matrix(of: str, by: str) -> Array:
        rows = len(compiled.layout.results[of])
        columns = len(compiled.layout.states if by == "states" else compiled.layout.inputs)
        if not rows or not columns:
            return np.zeros((rows, columns))
        return compiled_jacobian(compiled, by, of).dense(t, x, p, u)

    names = compiled.layout
    return Linear(
        matrix(RATES, "states"),
        matrix(RATES, "inputs"),
        matrix(OUTPUTS, "states"),
        matrix(OUTPUTS, "inputs"),
        tuple(q.name for q in names.states),
        tuple(q.name for q in names.inputs),
        names.results[OUTPUTS],
    )
