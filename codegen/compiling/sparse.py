"""Sparse Jacobians as functions.

Programs of derivatives: groups of results differentiated by all slots of some kinds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.compiling.checked import Values
from codegen.derivatives.derivative import JACOBIAN, UNIT, Jacobian, colouring, derive, identity
from codegen.frontend.layout import Layout
from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import INVARIANTS, OUTPUTS, RATES, Program
from codegen.passes.pipeline import formed, join, optimise
from eom.errors import unknown_name

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SparseJacobian:
    """The derivatives of one group of results, and the results with them, from one function.

    Parameters
    ----------
    shape : tuple of int, int
        (results, variables).
    rows, columns : tuple of ints
        Place of each entry that is not zero everywhere.
    layout : Layout
        The order of arrays.

    Notes
    -----
    A call gives these entries, in shape (entries,) for one point or (entries, N) for N points.
    Units are those of the results over those of the variables. How it is made: see
    `codegen.compiled_jacobian`.
    """

    shape: tuple[int, int]
    rows: tuple[int, ...]
    columns: tuple[int, ...]
    function: Callable[..., Array]
    """``(t, x, p, u)`` to results and entries, one after the other."""
    program: Program
    """One group, `codegen.derivatives.derivative.JACOBIAN`: the results, then the entries."""
    layout: Layout
    mode: str
    """The accumulation that was cheapest: forward, reverse or mixed."""

    def __call__(
        self, t: ArrayLike, x: Values, p: Values | None = None, u: Values | None = None
    ) -> Array:
        """Return the entries that are not zero everywhere, (entries,) or (entries, N).

        Parameters
        ----------
        t : array
            Time, as of `Function`.
        x, p, u : mapping or array
            States, parameters and inputs, as of `Function`.

        Returns
        -------
        array
            (entries,) or (entries, N), in the order of ``rows`` and ``columns``.

        Raises
        ------
        InputError
            For wrong shapes and types.
        """
        return self.with_value(t, x, p, u)[1]

    def with_value(
        self, t: ArrayLike, x: Values, p: Values | None = None, u: Values | None = None
    ) -> tuple[Array, Array]:
        """Return results and entries of one evaluation.

        Parameters
        ----------
        t : array
            Time, as of `Function`.
        x, p, u : mapping or array
            States, parameters and inputs, as of `Function`.

        Returns
        -------
        tuple of arrays
            Results, (k,) or (k, N), and entries, (entries,) or (entries, N).

        Raises
        ------
        InputError
            For wrong shapes and types.
        """
        everything = self.function(t, x, p, u)
        return everything[: self.shape[0]], everything[self.shape[0] :]

    def dense(
        self, t: ArrayLike, x: Values, p: Values | None = None, u: Values | None = None
    ) -> Array:
        """Return the whole matrix, with its zeros.

        Parameters
        ----------
        t : array
            Time, as of `Function`.
        x, p, u : mapping or array
            States, parameters and inputs, as of `Function`.

        Returns
        -------
        array
            In shape ``shape``, or with a last axis of N at N points.

        Raises
        ------
        InputError
            For wrong shapes and types.
        """
        entries = self(t, x, p, u)
        whole = np.zeros((*self.shape, *entries.shape[1:]))
        whole[list(self.rows), list(self.columns)] = entries
        return whole

    def sparse(self, t: float, x: Values, p: Values | None = None, u: Values | None = None) -> Any:
        """Return the matrix at one point as a SciPy CSR array.

        Parameters
        ----------
        t : float
            Time, a number.
        x, p, u : mapping or array
            States, parameters and inputs, as of `Function`, of one point.

        Returns
        -------
        scipy.sparse.csr_array
            Of shape ``shape``.

        Raises
        ------
        InputError
            For wrong shapes.
        """
        from scipy.sparse import csr_array

        entries = self(t, x, p, u)
        return csr_array((entries, (list(self.rows), list(self.columns))), shape=self.shape)

    @cached_property
    def colours(self) -> dict[int, int]:
        """A colour for each column; columns of one colour share no row."""
        return colouring(zip(self.rows, self.columns, strict=True))


KINDS: Mapping[str, str] = {
    "states": "state",
    "parameters": "parameter",
    "inputs": "input",
    "time": "time",
}
"""What can be differentiated by, and the slots that hold it."""


VALUES = "values"
"""The one group of a program whose Jacobian is compiled."""


def differentiated(
    program: Program, layout: Layout, of: tuple[str, ...], by: tuple[str, ...]
) -> Jacobian:
    """Return values and derivatives of groups of results, by all slots of some kinds."""
    together = tuple(k for group in of for k in program.results[group])
    values = prune(replace(program, results={VALUES: together}))
    columns = [
        {Instruction(KINDS[kind], (), None if kind == "time" else k): UNIT}
        for kind in by
        for k in range(slots(layout, kind))
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
        derived = differentiated(program, layout, (RATES,), (kind,))
        programs[group] = optimise(one_group(formed(derived.program, stable), group))
        entries = (f"d{r}_{c}" for r, c in derived.pattern)
        results[group], patterns[group] = (*layout.results[RATES], *entries), derived.pattern
    return join(programs), replace(layout, results=results, patterns=patterns)


def slots(layout: Layout, kind: str) -> int:
    """Return how many variables of a kind there are."""
    sizes = {
        "states": len(layout.states),
        "parameters": len(layout.parameters),
        "inputs": len(layout.inputs),
        "time": 1,
    }
    return sizes[kind]


def layout_of_derivatives(layout: Layout, suffix: str, names: tuple[str, ...]) -> Layout:
    """Return the layout of a program that has derivatives alone."""
    results = {JACOBIAN: names, OUTPUTS: (), INVARIANTS: ()}
    return replace(layout, name=f"{layout.name}_{suffix}", results=results, coordinates=())


def one_group(program: Program, group: str) -> Program:
    """Put the results before the entries of their Jacobian, as one group."""
    together = (*program.results[VALUES], *program.results[JACOBIAN])
    return replace(program, results={group: together})
