"""Sparse Jacobians as functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.derivatives.derivative import colouring
from codegen.frontend.layout import Layout
from codegen.ir.program import Program

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SparseJacobian:
    """The derivatives of one group of results, and the results with them, from one function.

    ``shape``: (results, variables). ``rows``, ``columns``: place of each entry that is not zero everywhere.
    A call gives these entries, in shape (entries,) for one point or (entries, N) for N points. Units are
    those of the results over those of the variables. How it is made: see `codegen.compiled_jacobian`.
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
        self, t: ArrayLike, x: ArrayLike, p: ArrayLike | None = None, u: ArrayLike | None = None
    ) -> Array:
        """Return the entries that are not zero everywhere, (entries,) or (entries, N).

        ``t``, ``x``, ``p``, ``u``: as of `Function`. Raises `InputError` for wrong shapes and types.
        """
        return self.with_value(t, x, p, u)[1]

    def with_value(
        self, t: ArrayLike, x: ArrayLike, p: ArrayLike | None = None, u: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Return results, (k,) or (k, N), and entries, (entries,) or (entries, N), of one evaluation.

        ``t``, ``x``, ``p``, ``u``: as of `Function`. Raises `InputError` for wrong shapes and types.
        """
        everything = self.function(t, x, p, u)
        return everything[: self.shape[0]], everything[self.shape[0] :]

    def dense(
        self, t: ArrayLike, x: ArrayLike, p: ArrayLike | None = None, u: ArrayLike | None = None
    ) -> Array:
        """Return the whole matrix, in shape ``shape`` or (*shape, N).

        ``t``, ``x``, ``p``, ``u``: as of `Function`. Raises `InputError` for wrong shapes and types.
        """
        entries = self(t, x, p, u)
        whole = np.zeros((*self.shape, *entries.shape[1:]))
        whole[list(self.rows), list(self.columns)] = entries
        return whole

    def sparse(
        self, t: float, x: ArrayLike, p: ArrayLike | None = None, u: ArrayLike | None = None
    ) -> Any:
        """Return the matrix at one point as a SciPy CSR array.

        ``t``, ``x``, ``p``, ``u``: as of `Function`, of one point. Raises `InputError` for wrong shapes.
        """
        from scipy.sparse import csr_array

        entries = self(t, x, p, u)
        return csr_array((entries, (list(self.rows), list(self.columns))), shape=self.shape)

    @cached_property
    def colours(self) -> dict[int, int]:
        """A colour for each column; columns of one colour share no row."""
        return colouring(zip(self.rows, self.columns, strict=True))
