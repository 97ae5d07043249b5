"""Runge-Kutta methods: coefficients against the theory, the loop in C against SciPy's and the exact."""

from fractions import Fraction
from functools import cache, partial

import mpmath
import numpy as np
import pytest
import scipy.integrate as si
import sympy as sp
from scipy.integrate._ivp import dop853_coefficients as published

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.compiling.compiled import generate
from codegen.integrate import scipy_
from codegen.loops import runge_kutta, running, tableaux, taylor, written
from codegen.loops.tableaux import DOP853, DP5, TSIT5
from codegen.native import native
from codegen.native.trajectory import Problem
from eom.errors import InputError
from eom.quantities import TIME
from eom.system import System

pytestmark = pytest.mark.sparse

INTEGRATORS = [row.name for row in written.ROWS if row.name != "none"]
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


# --- the tables of order 5(4) ---------------------------------------------------------------------

PAIRS = {"DP5": (DP5, Fraction(0)), "Tsit5": (TSIT5, Fraction(2, 10**14))}
"""Tables, and how far the order conditions may be off: not at all where numbers are rational."""


def rows_of(tableau):
    """Stages, error weights and interpolant as rational numbers: those of DP5, else the doubles'."""
    if tableau is DP5:
        stages, error, dense = tableaux.DP5_STAGES, tableaux.DP5_ERROR, tableaux.DP5_DENSE
        return [*map(tableaux.exact, stages)], tableaux.exact(error), tableaux.exact(dense)
    parts = ([*tableau.stages], [tableau.error_high], [*tableau.dense])
    stages, error, dense = ([tuple(map(Fraction, row)) for row in part] for part in parts)
    return stages, error[0], dense[0]


def exact_weight(tree, rows):
    """What `weight` gives, in rational arithmetic."""
    values = [Fraction(1)] * len(rows)
    for part in tree:
        inner = exact_weight(part, rows)
        sums = [sum((a * v for a, v in zip(row, inner, strict=False)), Fraction(0)) for row in rows]
        values = [v * s for v, s in zip(values, sums, strict=True)]
    return values


def condition(weights, tree, rows):
    return sum(w * v for w, v in zip(weights, exact_weight(tree, rows), strict=False))


@pytest.fixture(params=PAIRS)
def pair(request):
    return PAIRS[request.param]


def test_order_conditions_of_the_pairs_hold_in_rational_arithmetic(pair):
    """Order 5 of the method, and 4 of its error estimate; not one more of either."""
    tableau, allowed = pair
    rows, error, _ = rows_of(tableau)
    for order in range(1, 6):
        for tree in trees(order):
            off = condition(rows[tableau.main_stages], tree, rows) - Fraction(1, density(tree))
            assert abs(off) <= allowed
            assert order == 5 or abs(condition(error, tree, rows)) <= allowed
    assert max(abs(condition(error, t, rows)) for t in trees(5)) > 1e-5
    sixth = [condition(rows[6], t, rows) - Fraction(1, density(t)) for t in trees(6)]
    assert max(map(abs, sixth)) > 1e-5


def test_nodes_of_the_pairs_are_the_sums_of_their_rows(pair):
    tableau, allowed = pair
    rows, _, _ = rows_of(tableau)
    nodes = (
        tableaux.exact(tableaux.DP5_NODES)
        if tableau is DP5
        else [Fraction(c) for c in tableau.nodes]
    )
    assert max(abs(sum(row) - c) for row, c in zip(rows, nodes, strict=True)) <= allowed


def test_interpolants_of_the_pairs_are_of_order_4(pair):
    """b(theta) . Phi(tree) = theta^n / density(tree): Hairer, Norsett and Wanner, (II.6.11)."""
    tableau, allowed = pair
    rows, _, dense = rows_of(tableau)
    b = [*rows[6], Fraction(0)]
    for part in (Fraction(1, 7), Fraction(1, 2), Fraction(5, 6)):
        cubic, steep = part * part * (3 - 2 * part), part * (1 - part)
        of_step = [cubic * w + steep * steep * d for w, d in zip(b, dense, strict=True)]
        of_step[0] += steep * (1 - part)
        of_step[6] -= steep * part
        for order in range(1, 5):
            for tree in trees(order):
                off = condition(of_step, tree, rows) - part**order / density(tree)
                assert abs(off) <= 4 * allowed, (part, tree)
        last = (condition(of_step, t, rows) - part**5 / density(t) for t in trees(5))
        assert max(map(abs, last)) > 1e-6


def test_the_table_of_dp5_is_that_of_scipy():
    rk45 = si.RK45
    for row, theirs in zip(DP5.stages[:6], rk45.A, strict=True):
        np.testing.assert_array_equal(row, theirs[: len(row)])
    np.testing.assert_array_equal(DP5.stages[6], rk45.B)
    np.testing.assert_array_equal(DP5.nodes[:6], rk45.C)
    np.testing.assert_array_equal(np.abs(DP5.error_high), np.abs(rk45.E))
    ours = scipy_._with_tableau(DP5)
    np.testing.assert_allclose(ours.P, rk45.P, rtol=1e-14, atol=1e-14)


# --- the loop -------------------------------------------------------------------------------------

y1, y2, y3, k = sp.symbols("y1 y2 y3 k", real=True)
RIGID = System.from_rates("rigid", {y1: y2 * y3, y2: -y1 * y3, y3: -sp.Rational(51, 100) * y1 * y2})
PENDULUM = System.from_rates(
    "pendulum", {y1: y2, y2: -sp.sin(y1)}, invariants={"E": y2**2 / 2 - sp.cos(y1)}
)
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


PEERS = {"DOP853": "DOP853", "DP5": "RK45", "Tsit5": scipy_._with_tableau(TSIT5)}
"""Methods of the generated loop, and the same in SciPy's."""
methods_in_c = pytest.mark.parametrize("method", PEERS)


def scipy_reference(system, x0, parameters, span, rtol=1e-9, method="DOP853", **options):
    f = compile_system(system, "numpy").rhs
    p = np.array(parameters) if parameters else None
    return si.solve_ivp(
        lambda t, x: f(t, x, p), span, x0, method=PEERS[method], rtol=rtol, atol=1e-3 * rtol,
        **options,
    )  # fmt: skip


@pytest.mark.sparse(4)
@needs_compiler
@pytest.mark.parametrize(
    ("method", "rtol"),
    [(m, r) for m in PEERS for r in (1e-4, 1e-7, 1e-10, 1e-12) if m == "DOP853" or r > 1e-8],
)
def test_steps_and_states_are_those_of_scipy(problem, rtol, method):
    system, x0, p, span = problem
    ours = simulate(compile_system(system, "c"), x0, span, p, method, rtol, 1e-3 * rtol)
    theirs = scipy_reference(system, x0, p, span, rtol, method)
    assert abs(ours.steps - (len(theirs.t) - 1)) <= max(1, 0.01 * ours.steps)
    assert abs(ours.nfev - theirs.nfev) <= 24 + 0.02 * theirs.nfev
    np.testing.assert_allclose(ours.y[:, -1], theirs.y[:, -1], rtol=300 * rtol, atol=300 * rtol)
    assert ours.t[0] == span[0]
    assert ours.t[-1] == span[1]
    assert ours.status == 0
    assert np.all(np.diff(ours.t) * np.sign(span[1] - span[0]) > 0)


@needs_compiler
@methods_in_c
def test_the_first_steps_are_the_same_to_rounding(method):
    ours = simulate(compile_system(RIGID, "c"), (0.0, 1.0, 1.0), (0, 5), None, method, 1e-8, 1e-11)
    theirs = scipy_reference(RIGID, (0.0, 1.0, 1.0), (), (0, 5), 1e-8, method)
    few = 4 if method == "DOP853" else 3  # where the estimate of the second step is not rounding
    np.testing.assert_allclose(ours.t[:few], theirs.t[:few], rtol=1e-11)
    np.testing.assert_allclose(ours.y[:, :few], theirs.y[:, :few], rtol=1e-11, atol=1e-14)


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
    for method in PAIRS:  # six an attempt, none for interpolants
        run = simulate(
            compile_system(RIGID, "c"), (0.0, 1.0, 1.0), (0, 20), None, method, dense_output=True
        )
        assert run.nfev == 2 + 6 * (run.steps + run.rejected)


@cache
def swing(times):
    """The pendulum's angle from (2, 0), in 30 digits."""
    with mpmath.workdps(30):
        f = mpmath.odefun(lambda t, y: [y[1], -mpmath.sin(y[0])], 0, [2, 0])
        return [f(t)[0] for t in times]


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize(("method", "order"), [("DOP853", 8), ("DP5", 5), ("Tsit5", 5)])
@pytest.mark.parametrize("project", [False, True])
def test_halving_fixed_steps_divides_the_error_by_two_to_the_order(method, order, project):
    """At t = 4 of the pendulum; projection onto its energy takes nothing from the order."""
    compiled = compile_system(PENDULUM, "c")
    exact = swing((4.0,))
    errors, count = [], 8 if order == 8 else 64
    for n in (count, 2 * count, 4 * count):
        options = {"rtol": 1e3, "first_step": 4 / n, "max_step": 4 / n, "project": project}
        run = simulate(compiled, (2.0, 0.0), (0, 4), method=method, **options)
        assert run.steps == n
        errors.append(float(abs(mpmath.mpf(run.y[0, -1]) - exact[0])))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > order - 0.6)
    assert np.all(orders < order + 1.6)


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize(("method", "order"), [("DOP853", 7), ("DP5", 4), ("Tsit5", 4)])
@pytest.mark.parametrize("project", [False, True])
def test_interpolants_keep_their_order(method, order, project):
    """The error between steps: order + 1 as long as it is that of one step, as with DOP853."""
    compiled = compile_system(PENDULUM, "c")
    times = np.linspace(0.05, 3.95, 23)
    exact = np.array([float(angle) for angle in swing(tuple(times))])
    errors, count = [], 8 if order == 7 else 32
    for n in (count, 2 * count):
        h = 4 / n
        options = {"rtol": 1e3, "first_step": h, "max_step": h, "project": project}
        run = simulate(compiled, (2.0, 0.0), (0, 4), method=method, dense_output=True, **options)
        errors.append(np.max(np.abs(run.sol(times)[0] - exact)))
        np.testing.assert_allclose(run.sol(run.t), run.y, rtol=1e-13, atol=1e-13)
    assert order - 0.6 < np.log2(errors[0] / errors[1]) < order + 2.6


@needs_compiler
@methods_in_c
def test_dense_output_is_that_of_scipy(problem, method):
    system, x0, p, span = problem
    rtol = 1e-8 if method == "DOP853" else 1e-6
    ours = simulate(compile_system(system, "c"), x0, span, p, method, rtol, dense_output=True)
    theirs = scipy_reference(system, x0, p, span, rtol, method, dense_output=True)
    times = np.linspace(*span, 211)
    scale = 1 + np.abs(theirs.sol(times)).max()
    np.testing.assert_allclose(ours.sol(times), theirs.sol(times), rtol=0, atol=300 * rtol * scale)
    single = ours.sol(times[17])
    assert single.shape == (len(x0),)
    np.testing.assert_array_equal(single, ours.sol(times)[:, 17])
    np.testing.assert_allclose(ours.sol(ours.t), ours.y, rtol=1e-13, atol=1e-13)


@needs_compiler
def test_long_runs_outgrow_every_buffer_and_keep_everything():
    """More than FIRST_CAPACITY and more than STEPS_A_CALL steps, with dense output."""
    compiled = compile_system(PENDULUM, "c")
    n = 52_345
    assert n > running.STEPS_A_CALL > running.FIRST_CAPACITY
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
    monkeypatch.setattr(running, "STEPS_A_CALL", 3)
    monkeypatch.setattr(running, "FIRST_CAPACITY", 2)
    parts = simulate(compiled, (0.0, 1.0, 1.0), (0, 50), method="DOP853", dense_output=True)
    np.testing.assert_array_equal(parts.t, whole.t)
    np.testing.assert_array_equal(parts.y, whole.y)
    np.testing.assert_allclose(parts.sol(whole.t), whole.y, atol=1e-14)


@needs_compiler
def test_the_structures_of_python_are_those_of_c():
    """Sizes agree for several numbers of states and singularities, or build would stop."""
    systems = (GROWTH, RIGID, eom.free_rigid_body("3-1-2"), eom.free_rigid_body("dcm"))
    for system, tableau in zip(systems, (DP5, TSIT5, DOP853, DP5), strict=True):
        compiled = compile_system(system, "c")
        method = runge_kutta.build(tableau, compiled.program, compiled.layout)
        n = len(compiled.layout.states)
        problem = Problem(
            np.full(n, 0.5), (0.0, 1e-3), np.ones(len(system.parameters)), np.empty(0),
            1e-9, np.full(n, 1e-12), 1e-6, len(system.singularities),
        )  # fmt: skip
        assert running.integrate(method, problem).stop.kind == "end"


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


# --- files of integrators ---------------------------------------------------------------------------

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror", "-O2")
PROGRAM = """
#include "free_rigid_body_{name}.h"
#include <math.h>
#include <stdio.h>

int main(void) {{
    static free_rigid_body_{name} s;
    free_rigid_body_{name}_output o = {{0}};
    static double t[4000], x[4000][3];
    const double p[] = {{1.0, 1.5, 2.0}}, x0[] = {{0.1, 2.0, 0.3}};
    for (int i = 0; i < 3; ++i) s.x[i] = x0[i], s.atol[i] = 1e-12;
    s.t_end = 5.0, s.rtol = 1e-9, s.h_max = HUGE_VAL, s.margin = 1e-6;
    o.t = t, o.x = &x[0][0], o.capacity = 4000;
    free_rigid_body_{name}_start(&s, p, NULL);
    const int status = free_rigid_body_{name}_run(&s, NULL, &o, 100000);
    printf("%d %.17g %.17g %.17g\\n", status, s.x[0], s.x[1], s.x[2]);
    return 0;
}}
"""


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("name", INTEGRATORS)
def test_a_c_user_gets_the_integrator_of_his_choice(name, tmp_path):
    """The files compile without a warning, alone, and give what `simulate` gives."""
    import subprocess

    compiled = compile_system(eom.free_rigid_body(), "c")
    package = generate(compiled.program, compiled.layout, "c", written.Choice(name, 1e-9))
    for file, text in package.items():
        (tmp_path / file).write_text(text)
    assert f"free_rigid_body_{name}.o" in package["Makefile"]
    others = {f"free_rigid_body_{m}.c" for m in INTEGRATORS if m != name}
    assert not others & set(package)
    (tmp_path / "main.c").write_text(PROGRAM.format(name=name))
    sources = ["main.c", "free_rigid_body.c", f"free_rigid_body_{name}.c"]
    command = [*native.compiler(), *STRICT, "-o", "main", *sources, "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    said = subprocess.run(["./main"], cwd=tmp_path, check=True, capture_output=True, text=True)
    status, *x = said.stdout.split()
    row = {"dop853": "DOP853", "dp5": "DP5", "tsit5": "Tsit5"}.get(name, name)
    ours = simulate(compiled, (0.1, 2.0, 0.3), (0, 5), [1.0, 1.5, 2.0], row, 1e-9, 1e-12)
    assert status == "0"
    np.testing.assert_allclose([float(v) for v in x], ours.y_stop, rtol=1e-12)


def test_a_misspelt_integrator_is_refused():
    compiled = compile_system(eom.free_rigid_body(), "numpy")
    with pytest.raises(InputError, match="unknown integrator 'tsit'"):
        written.files(written.Choice("tsit"), compiled.program, compiled.layout)


def test_tsit5_takes_inputs_that_are_functions():
    """In SciPy's loop, with the same steps: x'' = -x + cos(3 t) by an input, and written in."""
    x, v, u = sp.symbols("x v u", real=True)
    driven = System.from_rates("driven", {x: v, v: -x + u}, inputs=[u])
    written = System.from_rates("written", {x: v, v: -x + sp.cos(3 * TIME)})
    options = {"method": "Tsit5", "rtol": 1e-8}
    one = simulate(driven, (1.0, 0.0), (0, 9), inputs={"u": lambda t: np.cos(3 * t)}, **options)
    other = simulate(written, (1.0, 0.0), (0, 9), **options)
    assert abs(one.steps - other.steps) <= 2
    np.testing.assert_allclose(one.y_stop, other.y_stop, atol=1e-7)
    assert one.method.startswith("Tsit5 in the loop of SciPy")


def test_functions_that_a_loop_does_not_call_are_not_compiled_with_it():
    compiled = compile_system(eom.heavy_top(), "numpy")
    given = (compiled.program, compiled.layout)
    for write in (
        partial(runge_kutta.single_text, DOP853, *given),
        partial(taylor.single_text, *given, 12),
    ):
        whole, alone = write(), write(whole=False)
        for group in compiled.layout.sizes:
            assert whole.count(f"heavy_top_{group}_kernel(") > 0
            called = group in {"rates", "singularities"}
            assert (f"heavy_top_{group}_kernel(" in alone) == called
            assert f"heavy_top_{group}_batch(size_t count" in whole
        assert alone.count("_batch(size_t count") == len(compiled.layout.sizes)  # declared
