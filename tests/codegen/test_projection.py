"""Projection: invariants at rounding over long runs, the order kept, singular directions, refusals."""

import subprocess

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.compiling.compiled import generate
from codegen.integrate import methods
from codegen.integrate.scipy_ import least_change
from codegen.loops import projection, written
from codegen.native import native
from codegen.targets import packaging
from eom.errors import InputError
from eom.system import System

pytestmark = pytest.mark.sparse

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="runs C")
EPSILON = np.finfo(np.float64).eps
theta, omega = sp.symbols("theta omega", real=True)
ENERGY = {"E": omega**2 / 2 - sp.cos(theta)}
PENDULUM = System.from_rates("pendulum", {theta: omega, omega: -sp.sin(theta)}, invariants=ENERGY)
BODY = eom.free_rigid_body("quaternion")
MOMENTS = [1.0, 2.0, 3.0]
START = (0.1, 2.0, 0.3, 1.0, 0.0, 0.0, 0.0)
ABLE = [m.name for m in methods.ROWS if m.projects and m.name not in {"auto", "scipy:DOP853"}]
LOOSE = {"scipy:RK23": 1e-4, "scipy:Radau": 1e-5}


@pytest.fixture(scope="module")
def body(request):
    return {target: compile_system(BODY, target) for target in ("numpy", "auto")}


@pytest.fixture(params=[m for m in ABLE if native.compiler() or m != "taylor"])
def method(request):
    return request.param


def allowed(run, compiled, rounding=30):
    """What rounding makes of each invariant of the body: a part of |H|, T or 1."""
    size = {name: abs(drift.start) for name, drift in run.drift.items()}
    for name in ("H_1", "H_2", "H_3"):
        size[name] = size["H"]
    return {name: rounding * EPSILON * value for name, value in size.items()}


def assert_kept(run, compiled):
    for name, most in allowed(run, compiled).items():
        assert run.drift[name].largest <= most, name


# --- what it keeps --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("target", "options"),
    [("auto", "steps"), ("auto", "grid"), ("auto", "both"), ("numpy", "both")],
)
def test_all_stored_points_lie_on_all_invariants(body, method, target, options):
    compiled, grid = body[target], np.linspace(0, 6, 41)
    given_options = {"steps": {"dense_output": True}, "grid": {"t_eval": grid}}
    given_options["both"] = given_options["steps"] | given_options["grid"]
    chosen, rtol = given_options[options], LOOSE.get(method, 1e-6)
    run = simulate(compiled, START, (0, 6), MOMENTS, method, rtol, project=True, **chosen)
    plain = simulate(compiled, START, (0, 6), MOMENTS, method, rtol, **chosen)
    assert_kept(run, compiled)
    assert max(plain.drift[n].relative for n in ("T", "q_norm")) > 1000 * EPSILON
    np.testing.assert_allclose(run.y_stop, plain.y_stop, atol=300 * rtol)
    if options == "steps" or target == "numpy":
        if options == "steps":
            np.testing.assert_allclose(run.sol(run.t), run.y, atol=1e-12)
        between = (run.t[1:] + run.t[:-1]) / 2
        np.testing.assert_allclose(run.sol(between), plain.sol(between), atol=300 * rtol)


@pytest.mark.sparse(2)
def test_one_invariant_alone_leaves_the_others(body, method):
    compiled, rtol = body["auto"], LOOSE.get(method, 1e-6)
    run = simulate(compiled, START, (0, 6), MOMENTS, method, rtol, project="q_norm")
    assert run.drift["q_norm"].largest <= 8 * EPSILON
    assert run.drift["H"].relative > 100 * EPSILON


def test_the_norm_is_restored_without_a_turn_of_the_body(body):
    """One long step of DP5: the projected quaternion is the other one over its length, omega the same."""
    options = {"first_step": 0.3, "max_step": 0.3, "rtol": 1e-2, "atol": 1e-2}
    plain, run = (
        simulate(body["auto"], START, (0, 0.3), MOMENTS, "DP5", project=p, **options)
        for p in ([], ["q_norm"])
    )
    assert run.steps == plain.steps == 1
    q = plain.y_stop[3:]
    assert abs(np.linalg.norm(q) - 1) > 1e-7
    np.testing.assert_allclose(run.y_stop[3:], q / np.linalg.norm(q), atol=4 * EPSILON)
    np.testing.assert_array_equal(run.y_stop[:3], plain.y_stop[:3])


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("name", ["DOP853", "DP5", "Tsit5", "taylor"])
def test_a_hundred_thousand_steps_stay_at_rounding(body, name):
    steps, h = 100_000, 1 / 16
    options = {"rtol": 1e-5, "first_step": h, "max_step": h, "t_eval": np.arange(0, steps, 977) * h}
    run = simulate(body["auto"], START, (0, steps * h), MOMENTS, name, project=True, **options)
    assert run.success
    assert run.steps >= steps
    assert_kept(run, body["auto"])
    for drift in run.drift.values():  # a last state that lies where the first ones do: no trend
        early, late = np.abs(drift.over_time[:50]).max(), np.abs(drift.over_time[-50:]).max()
        assert late <= 4 * early + 4 * EPSILON * drift.scale


def test_both_loops_make_the_same_steps(body):
    one, other = (
        simulate(body[t], START, (0, 6), MOMENTS, "DP5", 1e-6, project=True) for t in body
    )
    assert one.steps == other.steps
    np.testing.assert_allclose(one.y_stop, other.y_stop, rtol=1e-9, atol=1e-11)


def test_backwards_and_forth(body, method):
    rtol = LOOSE.get(method, 1e-7)
    there = simulate(body["auto"], START, (3, 0), MOMENTS, method, rtol, project=True)
    back = simulate(body["auto"], there.y_stop, (0, 3), MOMENTS, method, rtol, project=True)
    np.testing.assert_allclose(back.y_stop, START, atol=300 * rtol)
    assert_kept(back, body["auto"])


@pytest.mark.parametrize("target", ["auto", "numpy"])
def test_stops_lie_on_the_invariants_and_where_they_did(target):
    compiled = compile_system(eom.free_rigid_body("3-2-1"), target)
    start, options = (0.3, 2.0, 0.4, 0.1, 0.3, 0.2), {"rtol": 1e-7, "margin": 0.2}
    ends = [
        simulate(compiled, start, (0, 40), MOMENTS, "DP5", project=p, **options)
        for p in (False, True)
    ]
    assert [run.status for run in ends] == [1, 1]
    assert ends[0].t_stop == pytest.approx(ends[1].t_stop, rel=1e-5)
    for name in ("T", "H"):
        assert ends[1].drift[name].relative < 20 * EPSILON < ends[0].drift[name].relative


# --- singular directions --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("target", "rtol"),
    [("numpy", 1e-6)] + [("auto", r) for r in (2.0**-52, 1e-12, 1e-6) if native.compiler()],
)
def test_spins_about_an_axis_and_next_to_it(body, target, rtol):
    """The gradients of T, H and the components of H are parallel there, or some are zero."""
    for axis in range(3):
        for beside in (0.0, 1e-12, 1e-9, 1e-6, 1e-3):
            x0 = np.array([beside, beside / 2, beside, 1, 0, 0, 0])
            x0[axis] = 2.0
            plain, run = (
                simulate(body[target], x0, (0, 5), MOMENTS, "DOP853", rtol, project=p)
                for p in (False, True)
            )
            assert run.success
            apart = np.abs(run.y_stop - plain.y_stop).max()
            assert apart <= 20 * max(rtol, 16 * EPSILON), (axis, beside)
            assert_kept(run, body[target])


@pytest.mark.parametrize("x0", [(0.0, 0.0), (1e-9, 0.0), (1e-4, 0.0), (np.pi, 0.0), (1e-300, 0.0)])
def test_places_of_rest_have_no_gradient_and_are_left_alone(x0):
    """The energy is stationary there: rounding in it says nothing about the angle."""
    plain, run = (
        simulate(PENDULUM, x0, (0, 20), method="DOP853", rtol=1e-10, project=p)
        for p in (False, True)
    )
    assert run.success
    growth = 1e9 if x0[0] > 3 else 1.0  # e^20 next to the unstable rest
    np.testing.assert_allclose(run.y_stop, plain.y_stop, atol=1e-9 * x0[0] + 1e-16 * growth)


def test_a_body_at_rest_stays_at_rest(body):
    for compiled in body.values():
        run = simulate(compiled, [0, 0, 0, 1, 0, 0, 0], (0, 9), MOMENTS, "DP5", project=True)
        np.testing.assert_array_equal(run.y_stop, [0, 0, 0, 1, 0, 0, 0])


@pytest.mark.parametrize("name", ["DOP853", "scipy:DOP853"])
def test_an_invariant_that_is_a_number_changes_nothing(name):
    still = System.from_rates("still", {theta: omega, omega: 1}, invariants={"two": sp.Integer(2)})
    plain, run = (
        simulate(still, (1.0, 0.0), (0, 5), method=name, project=p) for p in (False, True)
    )
    np.testing.assert_array_equal(run.y, plain.y)


def test_motion_without_a_finite_rate_stops_as_before():
    x, v = sp.symbols("x v", real=True)
    fall = System.from_rates("fall", {x: v, v: -1 / x**2}, invariants={"E": v**2 / 2 - 1 / x})
    ends = [simulate(fall, (1.0, 0.0), (0, 5), method="DOP853", project=p) for p in (False, True)]
    assert [run.status for run in ends] == [-1, -1]
    assert ends[0].t_stop == pytest.approx(ends[1].t_stop, abs=1e-4)
    assert np.all(np.isfinite(ends[1].y))


# --- the least change -------------------------------------------------------------------------------

numbers = st.floats(-1, 1, allow_subnormal=False)


@given(
    st.integers(1, 4).flatmap(
        lambda rows: st.lists(
            st.lists(numbers, min_size=6, max_size=6), min_size=rows, max_size=rows
        )
    ),
    st.lists(numbers, min_size=4, max_size=4),
)
def test_the_change_is_the_least_one(rows, left):
    """That of the pseudo-inverse wherever the rows are well apart."""
    a = np.array(rows) + np.eye(len(rows), 6) * 4
    wanted = 0.01 * np.array(left[: len(rows)])
    found = least_change(a, wanted, np.full(len(a), 1e-16), 1e-3)
    exact = np.linalg.pinv(a) @ wanted
    np.testing.assert_allclose(np.zeros(6) if found is None else found, exact, atol=1e-14)


@given(st.lists(numbers, min_size=5, max_size=5), st.floats(-2, 2), st.floats(-0.01, 0.01))
def test_parallel_and_zero_gradients_count_once(row, factor, off):
    first = np.array([1.0, *row])
    a = np.array([first, factor * first, 0 * first])
    found = least_change(a, off * np.array([1, factor, 0]), 1e-16 * np.array([1, 2, 1]), 1e-3)
    exact = off * first / (first @ first)
    np.testing.assert_allclose(np.zeros(6) if found is None else found, exact, atol=1e-13)


def test_numbers_that_are_not_finite_change_nothing():
    for bad in (np.nan, np.inf):
        a = np.array([[1.0, bad], [bad, bad]])
        assert least_change(a, np.array([1e-3, 1e-3]), np.array([bad, bad]), 1e-3) is None
        found = least_change(np.eye(2), np.array([bad, 1e-3]), np.full(2, 1e-16), 1e-3)
        assert found is None or np.all(np.isfinite(found))


def test_a_change_beyond_the_reach_of_a_linear_step_is_not_made():
    assert least_change(np.eye(2), np.array([0.5, 0.5]), np.full(2, 1e-16), 1e-3) is None


# --- names and files ---------------------------------------------------------------------------------


def test_unknown_invariants_are_refused():
    with pytest.raises(InputError, match="unknown invariant 'E1'"):
        simulate(PENDULUM, (1.0, 0.0), (0, 1), project="E1")
    nothing = System.from_rates("nothing", {theta: omega, omega: -theta})
    with pytest.raises(InputError, match="nothing to project onto"):
        simulate(nothing, (1.0, 0.0), (0, 1), project=True)


@pytest.mark.parametrize("name", ["scipy:BDF", "scipy:LSODA"])
def test_methods_that_remember_earlier_steps_refuse(name):
    with pytest.raises(InputError, match=f"method {name} cannot project") as error:
        simulate(PENDULUM, (1.0, 0.0), (0, 1), method=name, project=True)
    assert "DOP853" in error.value.expected


def test_nothing_is_added_where_nothing_is_projected():
    compiled = compile_system(BODY, "numpy")
    plain = generate(compiled.program, compiled.layout, "c")
    assert not any("project_point" in text for text in plain.values())


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("name", [row.name for row in written.ROWS if row.name != "none"])
def test_files_with_a_projection_pass_strict_compilers(name, tmp_path):
    compiled = compile_system(BODY, "numpy")
    program, layout = projection.extended(compiled.program, compiled.layout, ("T", "q_norm"))
    assert [q.name for q in layout.parameters[3:]] == ["T_kept", "q_norm_kept"]
    for file, text in generate(program, layout, "c", written.Choice(name, 1e-6)).items():
        (tmp_path / file).write_text(text)
    flags = ("-std=c99", *packaging.WARNINGS, "-Wconversion", "-Werror", "-O2")
    source = f"free_rigid_body_{name}.c"
    command = [*native.compiler(), *flags, "-c", source, "-o", "loop.o"]
    subprocess.run(command, cwd=tmp_path, check=True)
