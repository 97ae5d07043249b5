"""What implicit methods are told of the derivatives of the rates: their entries, or where zeros are."""

from __future__ import annotations

from typing import Any

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.linear import known_jacobian
from codegen.compiling.sparse import SparseJacobian
from codegen.ir.groups import RATES
from codegen.ir.passes import dependence, prune

JACOBIAN_UP_TO = 100
"""Implicit methods take the generated Jacobian where the rates are so many instructions or fewer: it is
then made in 0.02 to 0.2 s, once. Robertson's problem to 1e11 by Radau at 1e-8: 16,300 evaluations by
differences, 11,500 with it, in half the time; LSODA 3,600 and 3,100, in the same time. Programs of 90
to 500 instructions of linked pendulums take 0.6 to 6 s to differentiate, and runs 0.01 to 0.1 s. Who
runs those many times calls ``compiled.jacobian("states")`` first: what is made is used."""
SPARSE_FROM = 100
SPARSE_SHARE = 0.2
"""Others are told which rates can depend on which states, for systems of so many states or
more where that is at most this share of all pairs: differences are then taken of many columns at once,
and factorisations are sparse. One thread, chains of stiff springs: 200 states 1.3 to 1.8 times as fast, 400
states 2.4 to 3.8 times. The generated Jacobian gains no more, and takes longer to make than a run."""


def jacobian_of(compiled: Compiled) -> SparseJacobian | None:
    """Return the generated Jacobian of the rates where it is soon made, or has been; else None."""
    if len(prune(compiled.program, [RATES]).instructions) > JACOBIAN_UP_TO:
        return known_jacobian(compiled)
    return compiled.jacobian("states")


def sparsity(compiled: Compiled) -> Any:
    """Return a sparse matrix with ones where a rate can depend on a state, or None if it is full."""
    n = len(compiled.layout.states)
    if n < SPARSE_FROM:
        return None
    places = sorted(dependence(compiled.program, RATES))
    if len(places) > SPARSE_SHARE * n * n:
        return None
    from scipy.sparse import csr_array

    rows, columns = zip(*places, strict=True) if places else ((), ())
    return csr_array((np.ones(len(places)), (rows, columns)), shape=(n, n))
