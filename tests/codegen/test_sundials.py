"""CVODE of SUNDIALS: stiff problems, generated dense and sparse Jacobians, dense output, refusals.

`test_simulation.py` runs over its methods as over all others where the extra is installed.
"""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen import compile as compile_system
from codegen import simulate
from codegen.integrate import scipy_, sundials
from codegen.integrate.sundials import Polynomial
from eom.errors import InputError
from eom.system import System

y1, y2, y3 = sp.symbols("y1 y2 y3", real=True)
ROBERTSON = System.from_rates(
    "robertson",
    {
        y1: -y1 / 25 + 10**4 * y2 * y3,
        y2: y1 / 25 - 10**4 * y2 * y3 - 3 * 10**7 * y2**2,
        y3: 3 * 10**7 * y2**2,
    },
)
VAN_DER_POL = System.from_rates("van_der_pol", {y1: y2, y2: 10**6 * (1 - y1**2) * y2 - y1})


@pytest.fixture
def extra():
    pytest.importorskip("sksundae")


def rod(count, target):
    """Heat along a rod that radiates: each cell hears of its neighbours alone."""
    cells = sp.symbols(f"T1:{count + 1}", real=True)
    k = sp.Symbol("k", real=True)
    ends = (1, *cells, 0)
    rates = {cell: k * (ends[n] - 2 * cell + ends[n + 2]) - cell**4 for n, cell in enumerate(cells)}
    return compile_system(System.from_rates("rod", rates), target)


def test_robertsons_problem_ends_at_the_published_values(extra, target):
    """Of the Test Set for IVP Solvers (Mazzia and Magherini, 2008), problem ROBER, at t = 1e11."""
    expected = (0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050)
    compiled = compile_system(ROBERTSON, target)
    run = simulate(compiled, (1, 0, 0), (0, 1e11), method="sundials:BDF", rtol=1e-8, atol=1e-18)
    np.testing.assert_allclose(run.y_stop, expected, rtol=1e-4)
    assert run.method == f"CVODE of SUNDIALS (BDF) over {target} functions"


@pytest.mark.parametrize("kind", ["BDF", "Adams"])
def test_generated_jacobians_save_evaluations(extra, monkeypatch, kind):
    problem = (
        (VAN_DER_POL, (2.0, 0.0), (0, 1e5)) if kind == "BDF" else (ROBERTSON, (1, 0, 0), (0, 1))
    )
    runs = []
    for most in (0, scipy_.JACOBIAN_UP_TO):
        monkeypatch.setattr(scipy_, "JACOBIAN_UP_TO", most)
        runs.append(simulate(*problem, method=f"sundials:{kind}", rtol=1e-7, atol=1e-10))
    plain, exact = runs
    assert plain.success
    assert exact.success
    assert exact.nfev / exact.steps < plain.nfev / plain.steps
    np.testing.assert_allclose(exact.y_stop, plain.y_stop, rtol=1e-4)


@pytest.mark.parametrize("known", [False, True])
def test_large_sparse_systems_are_solved_as_such(extra, monkeypatch, known):
    """The same motion as with full matrices; differences or the generated Jacobian fill them."""
    count = 30
    monkeypatch.setattr(scipy_, "SPARSE_FROM", count)
    compiled, start, reported = rod(count, "numpy"), np.linspace(1, 0.2, count), []
    if known:
        compiled.jacobian("states")
    solver = sundials.Solver
    monkeypatch.setattr(sundials, "Solver", lambda *a, **o: reported.append(o) or solver(*a, **o))
    runs = []
    for least in (count + 1, count):
        monkeypatch.setattr(sundials, "SPARSE_FROM", least)
        runs.append(simulate(compiled, start, (0, 0.1), {"k": 500.0}, "sundials:BDF", 1e-7))
    full, sparse = runs
    np.testing.assert_allclose(sparse.y_stop, full.y_stop, rtol=1e-6)
    assert [o.get("linsolver", "dense") for o in reported] == ["dense", "sparse"]
    assert ["jacfn" in o for o in reported] == [known, known]
    if known:
        assert sparse.nfev < 2 * sparse.steps + 20


def test_sparse_jacobians_are_filled_by_columns_with_their_diagonal(extra):
    """The third row has no entry on the diagonal, and rows come in another order than columns."""
    entries = np.array([5.0, 7.0, 11.0])
    rows, columns = (0, 0, 2), (0, 2, 0)
    reported = sundials.Derivatives(lambda t, x: entries, rows, columns, sparse=True).options(3)
    values = np.full(reported["sparsity"].nnz, np.nan)
    reported["jacfn"](0.0, np.zeros(3), np.zeros(3), values)
    matrix = reported["sparsity"]
    matrix.data[:] = values
    expected = np.zeros((3, 3))
    expected[list(rows), list(columns)] = entries
    np.testing.assert_array_equal(matrix.toarray(), expected)
    assert matrix.nnz == 5


@pytest.mark.parametrize("kind", sundials.KINDS)
def test_the_dense_output_is_that_of_the_method(extra, kind):
    """What t_eval gives comes from CVODE's own polynomial; the kept ones agree to rounding."""
    swing = System.from_rates("swing", {y1: y2, y2: -sp.sin(y1)})
    compiled, grid = compile_system(swing), np.linspace(0, 9, 200)
    options = {"method": f"sundials:{kind}", "rtol": 1e-7}
    direct = simulate(compiled, (2.0, 0.0), (0, 9), t_eval=grid, **options)
    kept = simulate(compiled, (2.0, 0.0), (0, 9), dense_output=True, **options)
    assert direct.steps == kept.steps
    np.testing.assert_allclose(kept.sol(grid), direct.y, atol=1e-13)
    assert kept.nfev == direct.nfev


@given(st.lists(st.floats(-1, 1), min_size=6, max_size=6), st.floats(-0.1, 1.1), st.floats(-9, 9))
def test_polynomials_by_values_are_exact(coefficients, part, start):
    nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(6) / 5)
    values = np.polynomial.polynomial.polyval(nodes, np.array([coefficients, coefficients[::-1]]).T)
    made = Polynomial(start, 2.0, nodes, values.T)
    for at in (part, 0.0, nodes[2], 1.0):
        exact = [
            np.polynomial.polynomial.polyval(at, c) for c in (coefficients, coefficients[::-1])
        ]
        np.testing.assert_allclose(made(start + 2 * at), exact, atol=1e-12)
    assert made(np.array([start, start + 1])).shape == (2, 2)


def test_where_the_extra_is_missing_the_message_names_it(monkeypatch):
    monkeypatch.setattr(sundials, "PACKAGE", "no_such_package")
    with pytest.raises(InputError, match="needs the package scikit-sundae") as error:
        simulate(ROBERTSON, (1, 0, 0), (0, 1), method="sundials:BDF")
    assert "eom-toolkit[sundials]" in error.value.hint


def test_projection_is_refused():
    steady = System.from_rates("steady", {y1: y2, y2: -y1}, invariants={"E": y1**2 + y2**2})
    with pytest.raises(InputError, match="sundials:BDF cannot project"):
        simulate(steady, (1, 0), (0, 1), method="sundials:BDF", project=True)
