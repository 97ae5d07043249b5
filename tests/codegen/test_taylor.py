"""Taylor series: rules against mpmath, exact solutions, and the loop in C in all that it promises."""

import shutil
import subprocess

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.derivatives import taylor
from codegen.derivatives.taylor import unrolled
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.program import RATES, Builder
from codegen.loops import taylor as method
from codegen.native import native
from codegen.watch.trust import limits
from eom.errors import InputError
from eom.quantities import TIME
from eom.system import System
from tests.codegen.scenes import SCENES

pytestmark = pytest.mark.shipped_flags("slow")

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="runs C")
y1, y2, y3, k, u = sp.symbols("y1 y2 y3 k u", real=True)
RIGID = System.from_rates("rigid", {y1: y2 * y3, y2: -y1 * y3, y3: -sp.Rational(51, 100) * y1 * y2})
PENDULUM = System.from_rates("pendulum", {y1: y2, y2: -k * sp.sin(y1)})
ORDER = 20

UNARY = {
    "neg": (-2, 2), "sqrt": (0.3, 3), "exp": (-2, 2), "expm1": (-1, 1), "sin": (-3, 3), "cos": (-3, 3),
    "tan": (-1, 1), "sinh": (-2, 2), "cosh": (-2, 2), "tanh": (-1, 1), "erf": (-1, 1), "erfc": (-1, 1),
    "log": (0.3, 3), "log1p": (-0.5, 2), "asin": (-0.7, 0.7), "acos": (-0.7, 0.7), "atan": (-2, 2),
    "asinh": (-2, 2), "acosh": (1.4, 3), "atanh": (-0.7, 0.7), "abs": (0.3, 3),
}  # fmt: skip
BINARY = {"add", "sub", "mul", "div", "pow", "hypot", "atan2", "min", "max"}


def series_of(op, first, second, at, order=ORDER):
    """Coefficients of op(first + at t + t^2/2, second - t/3 ...) at t = 0: by the rules, by mpmath."""
    b = Builder()
    t = b.leaf("time")
    a = b.add("add", b.const(first), b.add("mul", b.const(at), b.add("sin", t)))
    c = b.add("add", b.const(second), b.add("mul", b.const(0.25), b.add("mul", t, b.add("cos", t))))
    arity = taylor.OPS[op].arity
    value = b.add(op, *(a, c)[:arity])
    jet = unrolled(taylor.prepare(b.program({RATES: [value]}), RATES), RATES, order)
    ours = interpret_exactly(jet, Point(0.0, [0.0]))[taylor.JET]
    with mpmath.workdps(60):
        exact = taylor.OPS[op].exact

        def f(t):
            args = (first + at * mpmath.sin(t), second + t * mpmath.cos(t) / 4)
            return exact(mpmath.mp, *args[:arity])

        theirs = mpmath.taylor(f, 0, order - 1)
        return [(o * n, e) for n, (o, e) in enumerate(zip(ours, theirs, strict=True), 1)]


def agree(pairs):
    for n, (ours, theirs) in enumerate(pairs):
        assert abs(ours - theirs) <= mpmath.mpf(10) ** -9 * (1 + abs(theirs)), n


@pytest.mark.sparse(8)
@pytest.mark.parametrize("op", UNARY)
@settings(max_examples=3)
@given(share=st.floats(0.01, 0.99), at=st.sampled_from([-0.5, 0.25, 0.75]))
def test_rules_of_one_argument_give_the_coefficients_of_mpmath(op, share, at):
    low, high = UNARY[op]
    agree(series_of(op, low + share * (high - low), 1.0, at))


@pytest.mark.parametrize("op", sorted(BINARY))
@settings(max_examples=3)
@given(first=st.floats(0.5, 2), second=st.floats(2.25, 3), at=st.sampled_from([-0.5, 0.25, 0.75]))
def test_rules_of_two_arguments_give_the_coefficients_of_mpmath(op, first, second, at):
    agree(series_of(op, first, second, at))


def test_every_rule_is_compared():
    assert set(taylor.RULES) == {*UNARY} | BINARY | {"select"}


@pytest.mark.parametrize(("at", "branch"), [(0.5, mpmath.sin), (1.5, lambda t: t * t)])
def test_a_constant_exponent_and_a_selection(at, branch):
    piece = sp.Piecewise((sp.sin(TIME), TIME < 1), (TIME**2, True))
    system = System.from_rates("s", {y1: (2 + sp.cos(TIME)) ** k + piece})
    prepared = taylor.prepare(compile_system(system, "numpy").program, RATES)
    jet = unrolled(prepared, RATES, ORDER)
    ours = interpret_exactly(jet, Point(at, [0.0], [1.7]))[taylor.JET]
    with mpmath.workdps(60):
        theirs = mpmath.taylor(lambda t: (2 + mpmath.cos(t)) ** 1.7 + branch(t), at, ORDER - 1)
    agree([(o * n, e) for n, (o, e) in enumerate(zip(ours, theirs, strict=True), 1)])
    assert prepared.has_branches


def test_solutions_of_linear_systems_are_differentiated():
    """A(t) x = f(t) with a symmetric and another matrix, against mpmath's solution."""
    from codegen.ir.linsolve import Shape

    for symmetric in (True, False):
        b = Builder()
        t = b.leaf("time")
        e, s, c = b.add("exp", t), b.add("sin", t), b.add("cos", t)
        entries = (b.add("add", b.const(3), s), c, b.add("add", b.const(2), e))
        if not symmetric:
            entries = (entries[0], c, e, entries[2])
        factor = b.add("factor", *entries, value=Shape(2, symmetric))
        back = b.add("back", factor, e, b.const(1))
        program = b.program(
            {RATES: [b.add("item", back, value=1)]}
        )  # the other entry is needed too
        jet = unrolled(taylor.prepare(program, RATES), RATES, 12)
        ours = interpret_exactly(jet, Point(0.0, [0.0]))[taylor.JET]

        def exact(t, symmetric=symmetric):
            other = mpmath.cos(t) if symmetric else mpmath.exp(t)
            rows = [[3 + mpmath.sin(t), mpmath.cos(t)], [other, 2 + mpmath.exp(t)]]
            return mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix([mpmath.exp(t), 1]))[1]

        with mpmath.workdps(60):
            theirs = mpmath.taylor(exact, 0, 11)
        agree([(o * n, e) for n, (o, e) in enumerate(zip(ours, theirs, strict=True), 1)])


def test_a_product_with_a_constant_costs_one_multiplication_an_order():
    system = System.from_rates("s", {y1: k * u * y1}, inputs=[u])
    jet = unrolled(taylor.prepare(compile_system(system, "numpy").program, RATES), RATES, ORDER)
    assert jet.counts().get("add", 0) == 0
    assert jet.counts()["mul"] <= 2 * ORDER + 1


# --- the method ------------------------------------------------------------------------------------


def exact(t):
    with mpmath.workdps(30):
        m = mpmath.mpf("0.51")
        return np.array([float(mpmath.ellipfun(f, t, m=m)) for f in ("sn", "cn", "dn")])


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize(
    ("rtol", "end", "allowed"),
    [(1e-6, 20, 1e-6), (1e-9, 20, 1e-9), (1e-12, 1000, 1e-9), (2.0**-52, 20, 2e-14),
     (2.0**-52, 1000, 1e-12), (2.0**-52, -1000, 1e-12)],
)  # fmt: skip
def test_the_reference_of_a_rigid_body_is_met(rtol, end, allowed):
    run = simulate(RIGID, (0.0, 1.0, 1.0), (0, end), None, "taylor", rtol)
    assert run.success
    assert f"order {method.order_of(rtol)} " in run.method
    np.testing.assert_allclose(run.y_stop, exact(end), rtol=0, atol=allowed)


def test_the_order_follows_from_the_tolerance():
    assert [method.order_of(r) for r in (1e3, 1e-6, 1e-9, 1e-12, 2.0**-52, 1e-30)] == [
        5, 12, 16, 19, 27, 27,
    ]  # fmt: skip


@pytest.mark.sparse(only=("lecture-wheel", "t-handle"))
@needs_compiler
@pytest.mark.parametrize("name", SCENES)
def test_ready_scenes_agree_with_dop853(name):
    scene = eom.load_scene(name)
    compiled = compile_system(scene.derive(), "c")
    end = min(scene.integration.t_end, 5000.0)
    times = np.linspace(0, end, 7)
    p, given_inputs = scene.parameter_values(), scene.input_values()
    start = scene.initial_values()
    ours = simulate(
        compiled, start, (0, end), p, "taylor", 1e-11, inputs=given_inputs, t_eval=times
    )
    fine = simulate(
        compiled, start, (0, end), p, "DOP853", 1e-13, inputs=given_inputs, t_eval=times
    )
    scale = 1 + np.abs(fine.y).max()
    np.testing.assert_allclose(ours.y, fine.y, rtol=0, atol=2e-8 * scale)
    assert ours.status == fine.status == 0


@needs_compiler
@pytest.mark.parametrize("span", [(0.0, 6.0), (6.0, 0.0)])
def test_dense_output_is_as_good_as_the_steps(span):
    run = simulate(RIGID, exact(span[0]), span, None, "taylor", 1e-13, dense_output=True)
    times = np.linspace(*span, 61)
    np.testing.assert_allclose(run.sol(times), np.array([exact(t) for t in times]).T, atol=1e-12)
    np.testing.assert_allclose(run.sol(run.t), run.y, rtol=0, atol=1e-14)


@needs_compiler
def test_a_series_that_ends_by_chance_is_not_believed():
    """y' = sin(t^8): at t = 0 all coefficients from order 10 to 24 are zero."""
    system = System.from_rates("flat", {y1: sp.sin(TIME**8)})
    run = simulate(system, (0.0,), (0, 3), None, "taylor", 1e-12)
    integral = mpmath.quad(lambda t: mpmath.sin(t**8), np.linspace(0, 3, 400))
    assert run.y_stop[0] == pytest.approx(float(integral), abs=1e-10)
    assert run.rejected > 0


@needs_compiler
def test_kinks_are_met_closely():
    """y' = |sin t| has the integral 4 over two half periods; y'' = -sign(y) is made of parabolas."""
    system = System.from_rates("kinked", {y1: sp.Abs(sp.sin(TIME)), y2: y3, y3: -sp.sign(y2)})
    run = simulate(system, (0.0, 0.5, 0.0), (0.5, 0.5 + 2 * np.pi), None, "taylor", 1e-10)
    assert run.y_stop[0] == pytest.approx(4, abs=1e-8)
    rest = (2 * np.pi) % 4  # the period is 4 for an amplitude of one half
    assert run.y_stop[1] == pytest.approx(-0.5 + (rest - 2) ** 2 / 2, abs=1e-7)


@needs_compiler
@pytest.mark.parametrize(
    ("rate", "op"),
    [(sp.floor(y1), "floor"), (sp.besselj(0, y1), "besselj"), (sp.Mod(y1, 2), "mod")],
)
def test_what_has_no_series_is_refused(rate, op, monkeypatch):
    compiled = compile_system(System.from_rates("rough", {y1: rate + k}), "numpy")
    monkeypatch.setattr(native, "compile_library", lambda *_: pytest.fail("compiled"))
    with pytest.raises(InputError, match=f"no Taylor series of {op}") as error:
        simulate(compiled, (0.5,), (0, 1), [1.0], "taylor")
    assert "y1" in error.value.got


@needs_compiler
def test_rough_functions_of_parameters_are_no_obstacle():
    system = System.from_rates("steps", {y1: sp.floor(k) * y1})
    run = simulate(system, (1.0,), (0, 1), [2.5], "taylor", 1e-12)
    assert run.y_stop[0] == pytest.approx(np.exp(2), rel=1e-11)


@needs_compiler
def test_inputs_that_are_functions_are_refused():
    system = System.from_rates("driven", {y1: u}, inputs=[u])
    with pytest.raises(InputError, match="Python functions"):
        simulate(system, (0.0,), (0, 1), None, "taylor", inputs={"u": np.cos})
    held = simulate(system, (0.0,), (0, 1), None, "taylor", inputs={"u": 3.0})
    assert held.y_stop[0] == pytest.approx(3, rel=1e-15)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(
    "system", [RIGID, PENDULUM, eom.free_rigid_body("3-1-2")], ids=lambda s: s.name
)
def test_generated_files_pass_strict_compilers_without_a_warning(compiler, system, tmp_path):
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    compiled = compile_system(system, "numpy")
    program, layout = compiled.program, compiled.layout
    files = {**method.files(program, layout, 8), **method.c.files(program, layout)}
    assert files == {**method.files(program, layout, 8), **method.c.files(program, layout)}
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="ascii")
    flags = [
        "-std=c99",
        "-O1",
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Wshadow",
        "-Wconversion",
        "-Werror",
    ]
    for name in files:
        if name.endswith(".c"):
            run = [compiler, *flags, "-c", str(tmp_path / name), "-o", str(tmp_path / "object.o")]
            done = subprocess.run(run, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr


# --- loops ------------------------------------------------------------------------------------------

SMOOTH = (
    sp.sqrt(2 + y1), (2 + y1) ** k, (2 + y1) ** y2, sp.exp(y2), sp.sin(y1 * y2), sp.tan(y1 / 2),
    sp.log(3 + y2),
    sp.sinh(y1), sp.tanh(y2), sp.erf(y1), sp.asin(y1 / 3), sp.acos(y2 / 3), sp.atan(y2), sp.asinh(y1),
    sp.acosh(2 + y1**2), sp.atanh(y2 / 4), sp.atan2(y1, 2 + y2), sp.Abs(y1 - 5), sp.Max(y1, y2 - 5),
    y1 / (3 + y2), sp.sqrt(y1**2 + y2**2 + 1), sp.Piecewise((y1, y2 < 9), (y2, True)), k * TIME * y1,
)  # fmt: skip
EVERY = System.from_rates("every", {y1: sum(SMOOTH) / 40, y2: -y1 + sp.cos(TIME), y3: k})
MATRIX = [[3 + sp.cos(y1), sp.sin(y2), y3], [sp.sin(y2), 4 + y1**2, k], [y3, k, 5]]
COUPLED = System(
    "coupled", (eom.quantities.Quantity(y1), eom.quantities.Quantity(y2), eom.quantities.Quantity(y3)),
    (y2, -y1, sp.sin(y1)), (eom.quantities.Quantity(k),), mass_matrix=sp.ImmutableMatrix(MATRIX),
)  # fmt: skip


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("system", [EVERY, COUPLED, RIGID, PENDULUM], ids=lambda s: s.name)
def test_the_loop_over_the_orders_follows_the_solution(system, monkeypatch):
    from codegen.frontend import lower as massmatrix

    monkeypatch.setattr(massmatrix, "UNROLLED", 0)
    compiled = compile_system(system, "c")
    assert system is not COUPLED or "factor" in compiled.program.counts()
    start, p = (0.4, 0.3, 0.2)[: len(system.states)], [1.5] * len(system.parameters)
    run = simulate(compiled, start, (0.5, 2.0), p, "taylor", 1e-12)
    fine = simulate(compiled, start, (0.5, 2.0), p, "DOP853", 1e-13)
    np.testing.assert_allclose(run.y_stop, fine.y_stop, rtol=1e-10)
    assert run.rejected == 0
    assert run.steps < 40


def test_the_length_of_the_text_does_not_depend_on_the_order():
    compiled = compile_system(eom.Scene.ready("gravity-gradient-satellite").derive(), "numpy")
    lengths = [
        len(method.files(compiled.program, compiled.layout, order)[f"{name}.c"])
        for name in ["gravity_gradient_satellite_taylor"]
        for order in (20, 24)
    ]
    assert abs(lengths[0] - lengths[1]) < 200


def test_the_limit_of_a_divisor_includes_that_of_its_angle() -> None:
    """Where cos z stays within 3/4 of cos x, z is nearer to x than sines allow from order 7 on."""
    turn, draw = np.exp(2j * np.pi * np.linspace(0, 1, 400)), np.random.default_rng(1)
    for x in draw.uniform(-np.pi / 2, np.pi / 2, 200):
        for part in (0.1, 0.5, 0.75):
            inside = np.arccos(np.cos(x) * (1 + part * turn))
            assert np.all(np.abs(inside.real) <= np.pi / 2)
            assert max(np.max(np.abs(inside - x)), np.max(np.abs(-inside - x))) < 7 / 2


@pytest.mark.parametrize(
    ("rate", "wanted"),
    [
        (k * y2 / sp.cos(y1), ["div"]),
        (y2 * sp.sin(y1) / (-3 * sp.cos(y1) / k), ["div"]),
        (sp.log(k * sp.sin(y1)), ["log"]),
        (1 / (y2 * sp.cos(y1)), ["angle", "div"]),
        (1 / (2 + sp.cos(y1)), ["angle", "div"]),
        (sp.sin(y2) / sp.cos(y1), ["angle", "div"]),
    ],
)
def test_angles_have_no_limit_beside_that_of_a_multiple_of_their_sine(
    rate: sp.Expr, wanted: list[str]
) -> None:
    """Only where the other factor stands still is the sine kept from zero; low orders allow less."""
    system = System.from_rates("angle", {y1: y2, y2: rate})
    prepared = taylor.prepare(lower_system(system), RATES)
    names = {"sin": "angle", "cos": "angle"}
    assert sorted(names.get(m.op, m.op) for m in limits(prepared, 12)) == wanted
    angles = {prepared.program.instructions[m.series].op for m in limits(prepared, 6)} & {"state"}
    assert angles
