"""CVODE of SUNDIALS, by the package scikit-sundae, in the shape of SciPy's solvers.

Hindmarsh et al., "SUNDIALS: suite of nonlinear and differential/algebraic equation solvers", ACM
Transactions on Mathematical Software 31 (2005) 363-396: backward differences of order 1 to 5, or
Adams formulas of order 1 to 12, both with Newton's iteration. `codegen.integrate.scipy_` drives it
step by step, so that it stops as the other methods do. Its dense output is the method's own polynomial.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from codegen.native.trajectory import Array
from eom.errors import InputError

PACKAGE = "sksundae"
KINDS = {"BDF": 5, "Adams": 12}
"""Methods, with their highest order."""
LEAST_STEP = 10
"""A run ends where steps are fewer units in the last place of time than this, as SciPy's do."""

SPARSE_FROM = 1000
"""States from which a sparse factorisation, by SuperLU_MT, is taken where few rates depend on few
states: a rod of 400 cells takes 0.18 s with it and 0.06 s with a full matrix, of 1000 cells 0.33 s and
0.38 s, of 2000 cells 0.36 s and 1.6 s (one run at 1e-8; times scatter)."""

Entries = Callable[[float, Array], Array]


def available() -> bool:
    """Return whether the package is installed."""
    return find_spec(PACKAGE) is not None


def require(method: str) -> None:
    """Raise `InputError`, which names the extra, where the package is not installed."""
    if not available():
        raise InputError(
            f"method {method} needs the package scikit-sundae",
            got="an installation without it",
            hint="pip install 'eom-toolkit[sundials]', or choose scipy:BDF",
        )


@dataclass(frozen=True)
class Derivatives:
    """The Jacobian's entries as a function of time and state, and the place of each.

    ``sparse``: whether linear systems are to be solved by a sparse factorisation.
    """

    entries: Entries
    rows: Sequence[int]
    columns: Sequence[int]
    sparse: bool

    def options(self, n: int) -> dict[str, Any]:
        """Return what CVODE is given: how to fill its matrix of n rows, and how to solve."""
        return self._sparse(n) if self.sparse else {"jacfn": self._fill, "linsolver": "dense"}

    def _fill(self, t: float, x: Array, _: Array, matrix: Array) -> None:
        matrix[:] = 0.0
        matrix[self.rows, self.columns] = self.entries(t, x)

    def _sparse(self, n: int) -> dict[str, Any]:
        """Entries by columns; the diagonal is there, since Newton's matrix is I less a multiple."""
        places = by_columns(self.rows, self.columns, n)
        number = {place: k for k, place in enumerate(places)}
        order = [number[place] for place in zip(self.columns, self.rows, strict=True)]

        def fill(t: float, x: Array, _: Array, values: Array) -> None:
            values[:] = 0.0
            values[order] = self.entries(t, x)

        return {"jacfn": fill, **sparse_options(places, n)}


Places = Sequence[tuple[int, int]]


def by_columns(rows: Iterable[int], columns: Iterable[int], n: int) -> Places:
    """Return the places (column, row) of a matrix of n rows in order, the diagonal among them."""
    return sorted({*zip(columns, rows, strict=True), *((k, k) for k in range(n))})


def sparse_options(places: Places, n: int) -> dict[str, Any]:
    """Return what CVODE is given for a sparse matrix; differences fill it unless ``jacfn`` does."""
    from scipy.sparse import csc_array

    columns, rows = np.array(places, dtype=np.int32).T  # what SuperLU_MT reads
    pattern = csc_array((np.ones(len(places)), (rows, columns)), shape=(n, n))
    assert pattern.indices.dtype == pattern.indptr.dtype == np.int32
    return {"linsolver": "sparse", "sparsity": pattern}


class Solver:
    """CVODE with the attributes and methods of `scipy.integrate.OdeSolver` that are used here."""

    def __init__(
        self,
        kind: str,
        rates: Callable[[float, Array], Array],
        t_span: tuple[float, float],
        x0: Array,
        keep: bool,
        **options: Any,
    ) -> None:
        """``keep``: dense output must stay valid.

        ``options``: tolerances and steps, as SciPy's, and what `Derivatives` or `sparse_options` say.
        """
        from sksundae.cvode import CVODE

        def slope(t: float, x: Array, out: Array) -> None:
            out[:] = rates(t, x)

        self.t, self.t_bound = t_span
        self.t_old = self.t
        self.y, self.status = x0.copy(), "running"
        self.direction = 1.0 if self.t_bound > self.t else -1.0
        self.keep, self.order = keep, KINDS[kind]
        if np.isinf(options["max_step"]):
            options["max_step"] = 0.0
        with warnings.catch_warnings():  # that the Jacobian given is used and not differences
            warnings.filterwarnings("ignore", "Custom sparse Jacobian", UserWarning)
            self._cvode = CVODE(slope, method=kind, **options)
        self._cvode.init_step(self.t, x0)

    def step(self) -> None:
        """Take one step; ``status`` says whether it failed, or reached the end."""
        found = self._onwards()
        if found.t == self.t:  # CVODE first comes back from where a polynomial was evaluated
            found = self._onwards()
        t = float(found.t)
        short = abs(t - self.t) < LEAST_STEP * np.spacing(abs(t)) and t != self.t_bound
        if not found.success or short:
            self.status = "failed"
            return
        self.t_old, self.t, self.y = self.t, t, np.array(found.y, dtype=np.float64)
        if t == self.t_bound:
            self.status = "finished"

    def _onwards(self) -> Any:
        return self._cvode.step(self.t_bound, method="onestep", tstop=self.t_bound)

    def dense_output(self) -> Callable[[Any], Array]:
        """Return the polynomial of the last step; valid until the next one unless ``keep``."""
        return self._sampled() if self.keep else self._at

    def _at(self, t: Any) -> Array:
        if np.ndim(t):
            return np.column_stack([self._at(float(one)) for one in t])
        if t == self.t:
            return self.y.copy()
        found = self._cvode.step(float(t), method="normal", tstop=self.t_bound)
        return np.array(found.y, dtype=np.float64)

    def _sampled(self) -> Polynomial:
        nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(self.order + 1) / self.order)
        times = self.t_old + nodes * (self.t - self.t_old)
        times[-1] = self.t
        return Polynomial(self.t_old, self.t - self.t_old, nodes, np.array([*map(self._at, times)]))


AT_A_NODE = 2.0**-512
"""Distance from a node, in steps, below which a polynomial has the node's value: weights stay finite."""


@dataclass(frozen=True)
class Polynomial:
    """A polynomial by its values at Chebyshev's points of a step, in the barycentric form.

    Berrut and Trefethen, "Barycentric Lagrange interpolation", SIAM Review 46 (2004) 501-517, sect. 5.
    """

    start: float
    length: float
    nodes: Array
    values: Array

    def __call__(self, t: Any) -> Array:
        """Return the values at ``t``, of shape (n,) or (n, len(t))."""
        part = np.atleast_1d((np.asarray(t, dtype=np.float64) - self.start) / self.length)
        signs = np.where(np.arange(len(self.nodes)) % 2, -1.0, 1.0)
        signs[[0, -1]] *= 0.5
        apart = part[:, None] - self.nodes
        hit = np.abs(apart) < AT_A_NODE
        at_node = np.any(hit, axis=1, keepdims=True)
        weights = np.where(at_node, hit, signs / np.where(hit, 1.0, apart))
        found: Array = (weights @ self.values / weights.sum(axis=1)[:, None]).T
        return found[:, 0] if np.ndim(t) == 0 else found
