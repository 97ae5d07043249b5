"""DOP853: its coefficients against the theory, and the loop in C against SciPy's and the exact."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import scipy.integrate as si
import sympy as sp
from scipy.integrate._ivp import dop853_coefficients as published

import eom
from codegen import compile as compile_system
from codegen import native, simulate
from codegen.integrate import runge_kutta
from codegen.integrate.dop853 import DOP853
from codegen.integrate.trajectory import Problem
from eom.system import TIME, System

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="tests C itself")

STAGES = DOP853.main_stages
A = np.zeros((16, 16))
for row, weights in enumerate(DOP853.stages):
    A[row, : len(weights)] = weights
B = A[STAGES, :STAGES]
C = np.array(DOP853.nodes, dtype=float)


# --- the table -----------------------------------------------------------------------------------


def test_each_node_is_the_sum_of_its_row():
    np.testing.assert_allclose(A.sum(axis=1), C, atol=3e-14)


def trees(order):
    """Rooted trees of ``order`` vertices, each as the sorted tuple of its subtrees."""
    if order == 1:
        return [()]
    return sorted(set(forests(order - 1)))


def forests(size, largest=None):
    """Multisets of rooted trees with ``size`` vertices in all."""
    if size == 0:
        yield ()
        return
    for part in range(min(size, largest or size), 0, -1):
        for tree in trees(part):
            for rest in forests(size - part, part):
                yield tuple(sorted((tree, *rest)))


def vertices(tree):
    return 1 + sum(map(vertices, tree))


def density(tree):
    value = vertices(tree)
    for part in tree:
        value *= density(part)
    return value


def weight(tree, matrix):
    """The product over subtrees of the sums that the order condition prescribes, a stage each."""
    value = np.ones(len(matrix))
    for part in tree:
        value = value * (matrix @ weight(part, matrix))
    return value


def test_the_number_of_rooted_trees_is_the_known_one():
    """Sequence A000081 of the OEIS; it guards the generator of the order conditions."""
    assert [len(trees(n)) for n in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]


@pytest.mark.parametrize("order", range(1, 9))
def test_all_order_conditions_up_to_order_8_hold(order):
    """b . Phi(tree) = 1 / density(tree): Hairer, Norsett and Wanner (1993), theorem II.2.13."""
    main = A[:STAGES, :STAGES]
    for tree in trees(order):
        assert B @ weight(tree, main) == pytest.approx(1 / density(tree), abs=2e-14), tree


def test_order_9_does_not_hold():
    """The conditions can fail: order 8 is the method's, so some tree of 9 vertices does."""
    main = A[:STAGES, :STAGES]
    worst = max(abs(B @ weight(t, main) - 1 / density(t)) for t in trees(9))
    assert worst > 1e-6


def test_error_estimates_are_of_order_5_and_3():
    """The weights are differences of methods of order 8 and 5, 8 and 3: sums that vanish."""
    main = A[: STAGES + 1, : STAGES + 1]
    high, low = np.array(DOP853.error_high), np.array(DOP853.error_low)
    for weights, order in ((high[:STAGES], 5), (low[:STAGES], 3)):
        for n in range(1, order + 1):
            for tree in trees(n):
                assert weights @ weight(tree, main[:STAGES, :STAGES]) == pytest.approx(0, abs=2e-14)
        last = max(abs(weights @ weight(t, main[:STAGES, :STAGES])) for t in trees(order + 1))
        assert last > 1e-7
    assert high[STAGES] == low[STAGES] == 0


def test_quadrature_conditions_hold_to_the_last_bits():
    """b . c^k = 1 / (k + 1), in exact arithmetic with the stored doubles."""
    b, c = [Fraction(v) for v in B], [Fraction(float(v)) for v in C[:STAGES]]
    for k in range(8):
        error = sum(bi * ci**k for bi, ci in zip(b, c, strict=True)) - Fraction(1, k + 1)
        assert abs(error) < Fraction(1, 10**14)


def test_the_table_is_that_of_scipy():
    np.testing.assert_array_equal(A, published.A)
    np.testing.assert_array_equal(B, published.B)
    np.testing.assert_allclose(C, published.C, rtol=4e-16)
    np.testing.assert_array_equal(DOP853.error_high, published.E5)
    np.testing.assert_array_equal(DOP853.error_low, published.E3)
    np.testing.assert_array_equal(np.array(DOP853.dense), published.D)
    assert DOP853.dense_terms == 3 + len(published.D)


# --- the loop -------------------------------------------------------------------------------------

y1, y2, y3, k = sp.symbols("y1 y2 y3 k", real=True)
RIGID = System.from_rates("rigid", {y1: y2 * y3, y2: -y1 * y3, y3: -sp.Rational(51, 100) * y1 * y2})
PENDULUM = System.from_rates("pendulum", {y1: y2, y2: -sp.sin(y1)})
FORCED = System.from_rates("forced", {y1: y2, y2: -y1 + sp.cos(3 * TIME) - k * y2})
VAN_DER_POL = System.from_rates("van_der_pol", {y1: y2, y2: 5 * (1 - y1**2) * y2 - y1})
GROWTH = System.from_rates("growth", {y1: y1})
PROBLEMS = {
    "rigid": (RIGID, (0.0, 1.0, 1.0), (), (0.0, 20.0)),
    "rigid, backwards": (RIGID, (0.3, -1.0, 0.7), (), (5.0, -15.0)),
    "pendulum": (PENDULUM, (3.0, 0.0), (), (0.0, 40.0)),
    "forced": (FORCED, (1.0, 0.0), (0.1,), (1.0, 30.0)),
    "van der pol": (VAN_DER_POL, (2.0, 0.0), (), (0.0, 30.0)),
    "growth": (GROWTH, (1.0,), (), (0.0, 10.0)),
}


@pytest.fixture(params=PROBLEMS)
def problem(request):
    return PROBLEMS[request.param]


def scipy_reference(system, x0, parameters, span, rtol=1e-9, **options):
    f = compile_system(system, "numpy").rhs
    p = np.array(parameters) if parameters else None
    return si.solve_ivp(
        lambda t, x: f(t, x, p), span, x0, method="DOP853", rtol=rtol, atol=1e-3 * rtol, **options
    )


@needs_compiler
@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10, 1e-12])
def test_steps_and_states_are_those_of_scipy(problem, rtol):
    system, x0, p, span = problem
    ours = simulate(compile_system(system, "c"), x0, span, p, method="DOP853", rtol=rtol)
    theirs = scipy_reference(system, x0, p, span, rtol)
    assert abs(ours.steps - (len(theirs.t) - 1)) <= max(1, 0.01 * ours.steps)
    assert abs(ours.nfev - theirs.nfev) <= 24 + 0.02 * theirs.nfev
    np.testing.assert_allclose(ours.y[:, -1], theirs.y[:, -1], rtol=300 * rtol, atol=300 * rtol)
    assert ours.t[0] == span[0]
    assert ours.t[-1] == span[1]
    assert ours.status == 0
    assert np.all(np.diff(ours.t) * np.sign(span[1] - span[0]) > 0)


@needs_compiler
def test_the_first_steps_are_the_same_to_rounding():
    ours = simulate(compile_system(RIGID, "c"), (0.0, 1.0, 1.0), (0, 5), method="DOP853", rtol=1e-8)
    theirs = scipy_reference(RIGID, (0.0, 1.0, 1.0), (), (0, 5), 1e-8)
    np.testing.assert_allclose(ours.t[:4], theirs.t[:4], rtol=1e-11)
    np.testing.assert_allclose(ours.y[:, :4], theirs.y[:, :4], rtol=1e-11, atol=1e-14)


@needs_compiler
def test_evaluations_are_counted_as_they_happen():
    """One at the start, one for the first step, 12 an attempt; 3 more for each interpolant."""
    plain = simulate(
        compile_system(RIGID, "c"), (0.0, 1.0, 1.0), (0, 20), method="DOP853", rtol=1e-6
    )
    assert plain.nfev == 2 + 12 * (plain.steps + plain.rejected)
    dense = simulate(
        compile_system(RIGID, "c"),
        (0.0, 1.0, 1.0),
        (0, 20),
        method="DOP853",
        rtol=1e-6,
        dense_output=True,
    )
    assert dense.nfev == plain.nfev + 3 * plain.steps
    given = simulate(
        compile_system(RIGID, "c"), (0.0, 1.0, 1.0), (0, 20), method="DOP853", first_step=0.1
    )
    assert given.nfev == 1 + 12 * (given.steps + given.rejected)


@needs_compiler
def test_the_observed_order_of_fixed_steps_is_8():
    """Halving the step divides the error at t = 1 of the pendulum by 2^8."""
    compiled = compile_system(PENDULUM, "c")
    with mpmath.workdps(30):
        exact = mpmath.odefun(lambda t, y: [y[1], -mpmath.sin(y[0])], 0, [2, 0])(4)
    errors = []
    for n in (8, 16, 32):
        run = simulate(
            compiled,
            (2.0, 0.0),
            (0, 4),
            method="DOP853",
            rtol=1e3,
            first_step=4 / n,
            max_step=4 / n,
        )
        assert run.steps == n
        errors.append(float(abs(mpmath.mpf(run.y[0, -1]) - exact[0])))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 7.4)
    assert np.all(orders < 9.6)


@needs_compiler
def test_the_interpolant_is_of_order_7():
    compiled = compile_system(PENDULUM, "c")
    with mpmath.workdps(30):
        f = mpmath.odefun(lambda t, y: [y[1], -mpmath.sin(y[0])], 0, [2, 0])
        times = np.linspace(0.05, 3.95, 23)
        exact = np.array([float(f(t)[0]) for t in times])
    errors = []
    for n in (8, 16):
        h = 4 / n
        options = {"rtol": 1e3, "first_step": h, "max_step": h}
        run = simulate(compiled, (2.0, 0.0), (0, 4), method="DOP853", dense_output=True, **options)
        errors.append(np.max(np.abs(run.sol(times)[0] - exact)))
    assert 6.4 < np.log2(errors[0] / errors[1]) < 9.6


@needs_compiler
def test_dense_output_is_that_of_scipy(problem):
    system, x0, p, span = problem
    ours = simulate(
        compile_system(system, "c"), x0, span, p, method="DOP853", rtol=1e-8, dense_output=True
    )
    theirs = scipy_reference(system, x0, p, span, 1e-8, dense_output=True)
    times = np.linspace(*span, 211)
    scale = 1 + np.abs(theirs.sol(times)).max()
    np.testing.assert_allclose(ours.sol(times), theirs.sol(times), rtol=0, atol=3e-6 * scale)
    single = ours.sol(times[17])
    assert single.shape == (len(x0),)
    np.testing.assert_array_equal(single, ours.sol(times)[:, 17])
    np.testing.assert_allclose(ours.sol(ours.t), ours.y, rtol=1e-13, atol=1e-13)


@needs_compiler
def test_long_runs_outgrow_every_buffer_and_keep_everything():
    """More than FIRST_CAPACITY and more than STEPS_A_CALL steps, with dense output."""
    compiled = compile_system(PENDULUM, "c")
    n = 52_345
    assert n > runge_kutta.STEPS_A_CALL > runge_kutta.FIRST_CAPACITY
    h = 1 / 64  # exact in binary, so that every step ends on a multiple
    run = simulate(
        compiled,
        (1.0, 0.0),
        (0, n * h),
        method="DOP853",
        first_step=h,
        max_step=h,
        dense_output=True,
    )
    assert run.steps == n
    np.testing.assert_array_equal(run.t, np.arange(n + 1) * h)
    energy = run.y[1] ** 2 / 2 - np.cos(run.y[0])
    assert np.max(np.abs(energy - energy[0])) < 1e-12
    middle = run.t[:-1] + h / 2
    x = run.sol(middle)
    np.testing.assert_allclose(x[1] ** 2 / 2 - np.cos(x[0]), energy[0], atol=1e-12)
    again = simulate(
        compiled, (1.0, 0.0), (0, n * h), method="DOP853", first_step=h, max_step=h, t_eval=[n * h]
    )
    np.testing.assert_array_equal(again.y[:, -1], run.y[:, -1])


@needs_compiler
def test_a_paused_run_goes_on_as_if_it_had_not_paused(monkeypatch):
    compiled = compile_system(RIGID, "c")
    whole = simulate(compiled, (0.0, 1.0, 1.0), (0, 50), method="DOP853")
    monkeypatch.setattr(runge_kutta, "STEPS_A_CALL", 3)
    monkeypatch.setattr(runge_kutta, "FIRST_CAPACITY", 2)
    parts = simulate(compiled, (0.0, 1.0, 1.0), (0, 50), method="DOP853", dense_output=True)
    np.testing.assert_array_equal(parts.t, whole.t)
    np.testing.assert_array_equal(parts.y, whole.y)
    np.testing.assert_allclose(parts.sol(whole.t), whole.y, atol=1e-14)


@needs_compiler
def test_the_structures_of_python_are_those_of_c():
    """Sizes agree for several numbers of states and singularities, or build would stop."""
    for system in (GROWTH, RIGID, eom.free_rigid_body("3-1-2"), eom.free_rigid_body("dcm")):
        compiled = compile_system(system, "c")
        method = runge_kutta.build(DOP853, compiled.program, compiled.layout)
        n = len(compiled.layout.states)
        problem = Problem(
            np.full(n, 0.5), (0.0, 1e-3), np.ones(len(system.parameters)), np.empty(0),
            1e-9, np.full(n, 1e-12), 1e-6, len(system.singularities),
        )  # fmt: skip
        assert runge_kutta.integrate(method, problem).stop.kind == "end"


@needs_compiler
def test_dense_solutions_of_runs_without_a_step_are_constant():
    t, x = np.array([2.0]), np.array([[1.0, 5.0]])
    solution = runge_kutta.DenseSolution(t, np.empty(0), x, np.empty((0, 7, 2)))
    np.testing.assert_array_equal(solution(2.0), [1.0, 5.0])
    np.testing.assert_array_equal(solution([2.0, 3.0]), [[1.0, 1.0], [5.0, 5.0]])


@needs_compiler
def test_a_grid_without_room_is_refused_before_anything_is_written():
    import ctypes

    compiled = compile_system(eom.free_rigid_body(), "c")
    method = runge_kutta.build(DOP853, compiled.program, compiled.layout)
    s = method.state(t=0.0, t_end=1.0, rtol=1e-9, margin=1e-6, h_max=np.inf)
    s.x[:], s.atol[:] = [1.0, 0.1, 0.0], [1e-12] * 3
    p = np.array([1.0, 1.5, 2.0])
    t, x, grid = np.full(4, -1.0), np.full((4, 3), -1.0), np.linspace(0, 1, 11)
    output = method.output(capacity=4, grid_count=11)
    output.t, output.x, output.grid = t.ctypes.data, x.ctypes.data, grid.ctypes.data
    method.start(ctypes.addressof(s), p.ctypes.data, None)
    too_small = 4
    assert method.run(ctypes.addressof(s), None, ctypes.addressof(output), 100) == too_small
    assert output.count == 0
    assert (t == -1).all()
    assert (x == -1).all()
