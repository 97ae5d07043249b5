"""What implicit methods of SciPy are given of a system: derivatives, or which rates hear of which state."""

import numpy as np
import pytest
import sympy as sp

from codegen import compile, simulate
from codegen.integrate import scipy_
from eom.mechanics import dissipation
from eom.quantities import TIME
from eom.system import System

pytestmark = pytest.mark.sparse

CELLS = 60


@pytest.fixture(scope="module")
def rod():
    """Heat along a rod that radiates: each cell hears of its neighbours alone."""
    cells = sp.symbols(f"T1:{CELLS + 1}", real=True)
    k = sp.Symbol("k", real=True)
    ends = (1, *cells, 0)
    rates = {cell: k * (ends[n] - 2 * cell + ends[n + 2]) - cell**4 for n, cell in enumerate(cells)}
    return compile(System.from_rates("rod", rates), "numpy")


@pytest.mark.parametrize("method", ["Radau", "BDF"])
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
    sparsity = scipy_.sparsity(rod)
    assert sparsity.nnz == 3 * CELLS - 2


@pytest.mark.slow
def test_full_and_small_systems_are_left_alone():
    x = sp.symbols("x1:4", real=True)
    small = System.from_rates("small", dict(zip(x, x, strict=True)))
    assert scipy_.sparsity(compile(small, "numpy")) is None
    many = sp.symbols(f"x1:{scipy_.SPARSE_FROM + 1}", real=True)
    full = System.from_rates("full", {s: -s - sum(many) for s in many})
    assert scipy_.sparsity(compile(full, "numpy")) is None


# --- generated Jacobians ------------------------------------------------------------------------------

y1, y2, y3 = sp.symbols("y1 y2 y3", real=True)
ROBERTSON = System.from_rates(
    "robertson",
    {
        y1: -y1 / 25 + 10**4 * y2 * y3,
        y2: y1 / 25 - 10**4 * y2 * y3 - 3 * 10**7 * y2**2,
        y3: 3 * 10**7 * y2**2,
    },
    invariants={"whole": y1 + y2 + y3},
)
VAN_DER_POL = System.from_rates("van_der_pol", {y1: y2, y2: 10**6 * (1 - y1**2) * y2 - y1})
SLUG = dissipation.viscous_slug()
SLUG_VALUES = [1.0, 1.5, 2.0, 0.1, 1e4]
STIFF = {
    "robertson": (ROBERTSON, (1.0, 0.0, 0.0), (0, 1e11), (), 1e-14),
    "van der pol": (VAN_DER_POL, (2.0, 0.0), (0, 1e6), (), 1e-10),
    "slug": (SLUG, (0.3, 1.0, 0.5, 0.1, -0.1, 0.2), (0, 50), SLUG_VALUES, 1e-10),
}


def solutions(name, method, target, monkeypatch, rtol=1e-7):
    """Runs by differences and by the generated Jacobian."""
    system, start, span, p, atol = STIFF[name]
    compiled = compile(system, target)
    runs = []
    for most in (0, scipy_.JACOBIAN_UP_TO):
        with monkeypatch.context() as patch:
            patch.setattr(scipy_, "JACOBIAN_UP_TO", most)
            runs.append(simulate(compiled, start, span, p, f"scipy:{method}", rtol, atol=atol))
    return runs


@pytest.mark.sparse(2)
@pytest.mark.parametrize("method", ["Radau", "LSODA"])
@pytest.mark.parametrize("name", STIFF)
def test_generated_jacobians_save_evaluations_and_change_no_result(
    name, method, target, monkeypatch
):
    plain, exact = solutions(name, method, target, monkeypatch)
    assert plain.success
    assert exact.success
    assert exact.nfev / exact.steps < plain.nfev / plain.steps
    assert exact.nfev < plain.nfev or name == "van der pol"  # whose steps change
    np.testing.assert_allclose(exact.y_stop, plain.y_stop, rtol=1e-3, atol=1e-4)


def test_robertsons_problem_ends_at_the_published_values(target):
    """Of the Test Set for IVP Solvers (Mazzia and Magherini, 2008), problem ROBER, at t = 1e11."""
    system, start, span, p, _ = STIFF["robertson"]
    expected = (0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050)
    for method in ("Radau", "BDF", "LSODA"):
        run = simulate(compile(system, target), start, span, p, f"scipy:{method}", 1e-7, atol=1e-16)
        np.testing.assert_allclose(run.y_stop, expected, rtol=3e-4)
        assert run.drift["whole"].relative < 1e-12


def test_a_derivative_that_is_not_finite_ends_the_run_with_its_reason(target):
    """The rate of y1 is finite at y1 = 0, its derivative by y1 is not."""
    steep = System.from_rates("steep", {y1: -(y1 ** sp.Rational(1, 3)), y2: -y2})
    for method in ("Radau", "BDF", "LSODA"):
        run = simulate(compile(steep, target), (1.0, 1.0), (0, 3), None, f"scipy:{method}", 1e-6)
        assert run.status == -1
        assert run.t_stop == pytest.approx(1.5, abs=0.01)


def test_large_programs_are_differentiated_on_demand_alone(rod, monkeypatch):
    """Once the Jacobian is made it is used, as a sparse matrix where few rates hear of few states."""
    assert scipy_.jacobian_of(compile(ROBERTSON, "numpy")).shape == (3, 3)
    assert scipy_.jacobian_of(rod) is None
    start, values = np.linspace(1, 0.2, CELLS), {"k": 500.0}
    plain = simulate(rod, start, (0, 0.1), values, "scipy:Radau", 1e-8)
    fresh = compile(rod.system, "numpy")
    assert scipy_.jacobian_of(fresh) is None
    made = fresh.jacobian("states")
    assert scipy_.jacobian_of(fresh) is made
    for least in (CELLS + 1, CELLS):
        monkeypatch.setattr(scipy_, "SPARSE_FROM", least)
        run = simulate(fresh, start, (0, 0.1), values, "scipy:Radau", 1e-8)
        np.testing.assert_allclose(run.y_stop, plain.y_stop, rtol=1e-7)
        assert run.nfev < plain.nfev


def test_rates_that_are_not_finite_within_a_step_leave_no_hole_in_it():
    """DOP853 of SciPy calls the rates at a tenth of a step for its polynomial alone: there is none here."""
    gap = System.from_rates(
        "gap", {y1: sp.sqrt((TIME - sp.Rational(1, 10)) ** 2 - sp.Rational(1, 10**16))}
    )
    times = np.linspace(0, 2, 41)
    for more in ({"t_eval": times}, {"dense_output": True}):
        run = simulate(
            compile(gap, "numpy"),
            (1.0,),
            (0, 2),
            None,
            "scipy:DOP853",
            1e-2,
            1.0,
            first_step=1.0,
            **more,
        )
        kept = run.y if "t_eval" in more else run.sol(times)
        assert run.rejected == 1
        np.testing.assert_allclose(kept[0], 1 + _parabola(times), rtol=1e-2)


def _parabola(t):
    """Return the integral of |t - 0.1| from 0."""
    return 0.005 + 0.5 * (t - 0.1) * np.abs(t - 0.1)
