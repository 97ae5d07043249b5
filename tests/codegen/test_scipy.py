"""What implicit methods of SciPy are told of a system: which rates can depend on which states."""

import numpy as np
import pytest
import sympy as sp

from codegen import compile, simulate
from codegen.integrate import scipy_
from eom.system import System

CELLS = 60


@pytest.fixture(scope="module")
def rod():
    """Heat along a rod that radiates: each cell hears of its neighbours alone."""
    cells = sp.symbols(f"T1:{CELLS + 1}", real=True)
    k = sp.Symbol("k", real=True)
    ends = (1, *cells, 0)
    rates = {cell: k * (ends[n] - 2 * cell + ends[n + 2]) - cell**4 for n, cell in enumerate(cells)}
    return compile(System.from_rates("rod", rates), "numpy")


@pytest.mark.parametrize("method", scipy_.IMPLICIT)
def test_sparse_differences_give_the_same_motion_with_fewer_evaluations(rod, method, monkeypatch):
    start = np.linspace(1, 0.2, CELLS)
    runs = []
    for least in (CELLS + 1, CELLS):
        monkeypatch.setattr(scipy_, "SPARSE_FROM", least)
        runs.append(
            simulate(rod, start, (0, 0.1), {"k": 500.0}, f"scipy:{method}", 1e-8, t_eval=[0.05])
        )
    full, sparse = runs
    assert full.success
    assert sparse.success
    np.testing.assert_allclose(sparse.y, full.y, rtol=1e-6)
    assert sparse.nfev <= full.nfev
    sparsity = scipy_._sparsity(rod)
    assert sparsity.nnz == 3 * CELLS - 2


def test_full_and_small_systems_are_left_alone():
    x = sp.symbols("x1:4", real=True)
    small = System.from_rates("small", dict(zip(x, x, strict=True)))
    assert scipy_._sparsity(compile(small, "numpy")) is None
    many = sp.symbols(f"x1:{scipy_.SPARSE_FROM + 1}", real=True)
    full = System.from_rates("full", {s: -s - sum(many) for s in many})
    assert scipy_._sparsity(compile(full, "numpy")) is None
