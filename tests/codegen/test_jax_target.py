"""The JAX target: numbers that the 50-digit interpreter bounds; jit, vmap and grad of them."""

import ast
import math
import subprocess
import sys

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings

import codegen
import eom
from codegen import compile as compile_system
from codegen.compiling.compiled import TARGETS, generate
from codegen.ir.interpret import Point, interpret_with_bound
from codegen.ir.names import RESERVED
from codegen.ir.ops import OPS
from codegen.targets import jax_, load_module
from codegen.targets.jax_ import _HELPERS, JAX
from eom.errors import InputError
from eom.scenes import catalogue
from tests.codegen.test_compiled import (
    as_array,
    as_point,
    check_against_bound,
    extreme,
    points,
    random_values,
    several,
    system_of,
    x,
    y,
)
from tests.codegen.test_python_target import SPECIAL, drawn, named, simple_operations
from tests.codegen.test_target_functions import ARGUMENTS, functions_of_the_first_state
from tests.codegen.test_targets import hostile_system

needs_jax = pytest.mark.skipif(not jax_.available(), reason="no JAX")
FEW = ("heavy-top", "four-bar-linkage", "quadrotor", "rolling-disc")
"""Scenes whose programs XLA compiles in seconds; all others (the largest take a minute) are `long`."""
TINIEST = 2.3e-308
"""JAX takes smaller numbers for zero on processors."""


# --- the module, without JAX ---------------------------------------------------------------------------


def text_of(system):
    compiled = compile_system(system, "numpy")
    (text,) = generate(compiled.program, compiled.layout, "jax").values()
    return text


def test_the_module_imports_jax_alone_and_is_the_same_each_time():
    text = text_of(eom.heavy_top())
    assert text.isascii()
    assert text == text_of(eom.heavy_top())
    imported = [n for n in ast.parse(text).body if isinstance(n, ast.Import | ast.ImportFrom)]
    names = [ast.unparse(n) for n in imported]
    assert names == ["import jax", "import jax.numpy as jnp"]


def test_helpers_are_written_only_where_they_are_used():
    tree = ast.parse(text_of(system_of([sp.sign(x) + sp.Min(x, y)])))
    found = [n.name for n in tree.body if isinstance(n, ast.FunctionDef) and n.name[0] == "_"]
    assert found == ["_real", "_results", "_sign", "_min"]


def test_without_jax_the_error_names_the_extra(monkeypatch):
    monkeypatch.setattr(jax_, "find_spec", lambda name: None)
    with pytest.raises(InputError, match="needs the package jax") as error:
        compile_system(eom.heavy_top(), "jax")
    assert "eom-toolkit[jax]" in error.value.hint


def test_modules_of_other_targets():
    heavy = compile_system(eom.heavy_top(), "python")
    n, m = len(heavy.layout.states), len(heavy.layout.parameters)
    got = heavy.module.rates(0.0, [0.5] * n, [1.5] * m)
    assert got == heavy.rhs(0.0, [0.5] * n, [1.5] * m).tolist()
    assert heavy.system.state_names == heavy.module.STATES
    with pytest.raises(InputError, match="no Python module") as error:
        _ = codegen.Compiled(**{**vars_of(heavy), "target": "c"}).module
    assert "'jax'" in error.value.hint


def vars_of(compiled):
    return {k: v for k, v in vars(compiled).items() if k in type(compiled).__dataclass_fields__}


# --- values ----------------------------------------------------------------------------------------------


@needs_jax
@pytest.mark.sparse(only=["t-handle"], slow=FEW)
@pytest.mark.parametrize("name", catalogue.names())
def test_every_scene_stays_within_the_error_bound_and_has_our_derivatives(name):
    """Values to the bound of the interpreter; derivatives by jax.jacfwd are those of the house."""
    import jax

    scene = eom.load_scene(name)
    compiled = compile_system(scene.derive(), "jax")
    for seed in range(2):
        t, xs, ps, us = random_values(compiled.system, seed)
        for group, function in compiled.functions.items():
            got = function(t, xs, as_array(ps), as_array(us))
            check_against_bound(compiled.program, group, Point(t, xs, ps, us), got)
    at = near_the_start(scene)
    with jax.enable_x64(True):
        by = jax.jacfwd(compiled.module.rhs, argnums=(1, 2))(*at)
    plain = compile_system(compiled.system, "python")
    for kind, got in zip(("states", "parameters"), map(np.asarray, by), strict=True):
        expected = plain.jacobian(kind).dense(*at)
        assert np.isfinite(expected).all()
        scale = np.abs(expected).max(initial=0.0)
        np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12 * scale)


def near_the_start(scene):
    """A point (t, x, p, u) of a scene where its states are not zero."""
    values = (scene.initial_values(), scene.parameter_values(), scene.input_values())
    xs, ps, us = (np.array([*v.values()], dtype=float) for v in values)
    return 0.3, xs + 0.01 * np.cos(np.arange(len(xs))), ps, us


@needs_jax
@pytest.mark.slow
@settings(max_examples=12)
@given(several(drawn, 4, 8), several(points(extreme), 5, 5))
def test_random_expressions_stay_within_the_error_bound(exprs, values):
    compiled = compile_system(system_of(exprs), "jax")
    columns = np.array(values).T
    got = compiled.outputs(columns[5], columns[:3], columns[3:5])
    for k, v in enumerate(values):
        if all(n == 0 or abs(n) > TINIEST for n in v):
            check_against_bound(compiled.program, "outputs", as_point(v), got[:, k])


@needs_jax
@pytest.mark.slow
def test_stumpff_and_tables_stay_within_the_error_bound():
    program, layout = functions_of_the_first_state()
    outputs = TARGETS["jax"](program, layout)[1]["outputs"]
    columns = np.array([[v, 0.0] for v in ARGUMENTS]).T
    rows = outputs(np.zeros(len(ARGUMENTS)), columns, [0.0, 0.0]).T
    for v, row in zip(ARGUMENTS, rows, strict=True):
        wanted = interpret_with_bound(program, Point(0.0, [v, 0.0], [0.0, 0.0]))["outputs"]
        for e, value in zip(wanted, row, strict=True):
            assert abs(float(value) - e.value) <= e.error + 1e-300, (v, value, e)


def function_of(op):
    names = ["a", "b", "c"][: OPS[op].arity]
    text = JAX.templates[op].text.format(*names)
    head = "import math\nimport jax\nimport jax.numpy as jnp\n"
    helpers = "\n".join(_HELPERS.values())
    return load_module(f"{head}{helpers}\ndef f({', '.join(names)}): return {text}\n", op).f


@needs_jax
@pytest.mark.slow
@pytest.mark.parametrize("op", simple_operations(JAX))
def test_values_at_the_edges_are_those_of_the_table_of_operations(op):
    import jax

    row = OPS[op]
    values = [v for v in SPECIAL if v == 0 or not abs(v) < TINIEST]
    count = len(values) ** min(row.arity, 2)
    places = [(k % len(values), k // len(values)) for k in range(count)]
    args = [[values[a], values[b % len(values)], -7.5][: row.arity] for a, b in places]
    with jax.enable_x64(True):
        got = np.asarray(jax.jit(function_of(op))(*np.array(args).T), dtype=float)
    with np.errstate(all="ignore"):
        expected = np.array([np.ravel(row.double(*(np.array([a]) for a in v)))[0] for v in args])
    for v, a, e in zip(args, got, expected.astype(float), strict=True):
        assert a == pytest.approx(e, rel=1e-15, abs=TINIEST, nan_ok=True), v
        if op not in {"min", "max"}:
            assert math.isnan(a) or math.copysign(1, a) == math.copysign(1, e), v


ELEMENTARY = [op for op in simple_operations(JAX) if OPS[op].ulps >= 4 and OPS[op].arity == 1]


@needs_jax
@pytest.mark.slow
@pytest.mark.parametrize("op", ELEMENTARY)
def test_functions_are_as_accurate_as_the_table_says(op):
    """Those of XLA lose up to 250 units in the last place (sinh, cosh, atanh, log1p): not ours."""
    import jax

    row = OPS[op]
    at = np.concatenate(
        [np.linspace(-6.5, 6.5, 401), *(s * np.geomspace(1e-12, 700, 200) for s in (1, -1))]
    )
    with jax.enable_x64(True):
        got = np.asarray(jax.jit(function_of(op))(at))
    worst = 0.0
    with mpmath.workdps(40):
        for v, a in zip(map(mpmath.mpf, at), got, strict=True):
            exact = row.exact(mpmath.mp, v)
            if np.isfinite(a) and isinstance(exact, mpmath.mpf) and abs(exact) > TINIEST:
                scale = row.scale(mpmath.mp, exact, v) if row.scale else abs(exact)
                worst = max(worst, float(abs(a - exact) / scale) * 2.0**52)
    assert 0.3 < worst <= row.ulps


@needs_jax
@pytest.mark.slow
def test_reserved_and_hostile_names_give_right_numbers():
    rng = np.random.default_rng(2)
    system = named([*sorted(RESERVED), *_HELPERS, "_math"])
    values = rng.normal(size=len(system.states))
    expected = np.sin(np.roll(values, -1)) + 2 * values
    np.testing.assert_allclose(compile_system(system, "jax").rhs(0.0, values), expected, rtol=1e-14)
    hostile = hostile_system()
    n = len(hostile.states)
    xs, ps = rng.normal(size=n), rng.normal(size=n)
    expected = np.sin(np.roll(xs, -1)) * ps + np.sign(xs)
    got = compile_system(hostile, "jax").rhs(0.0, xs, ps)
    np.testing.assert_allclose(got, expected, rtol=1e-14)


# --- transformations -------------------------------------------------------------------------------------


@needs_jax
@pytest.mark.slow
def test_what_is_not_a_number_in_the_branch_that_is_not_taken_does_not_reach_the_gradient():
    """Zero times infinity is NaN: jnp.where alone would give NaN here. The last one is what is left."""
    import jax

    p = sp.Symbol("p", real=True)
    exprs = [
        sp.Piecewise((sp.sqrt(x), x > 0), (y, True)),
        sp.Piecewise((sp.log(x) / x, x > 0), (x * y, True)),
        sp.Piecewise((x**p, x > 0), (x, True)),
        sp.Piecewise((sp.acos(x), sp.Abs(x) < 1), (x**2, True)),
        sp.sin(x) / x,
        (1 - sp.cos(x)) / x**2,
    ]
    product = [sp.Piecewise((x * sp.sqrt(x), x > 0), (y, True))]
    compiled = compile_system(system_of(exprs), "jax")
    ours = compile_system(system_of(exprs), "python").jacobian("states", "outputs")
    with jax.enable_x64(True):
        forwards = jax.jit(jax.jacfwd(compiled.module.outputs, argnums=1))
        backwards = jax.jit(jax.jacrev(compiled.module.outputs, argnums=1))
        for value in (0.0, -2.0, 0.5, 3.0):
            at, held = np.array([value, 0.7, 0.0]), np.array([0.3, 0.2])
            expected = ours.dense(0.0, at, held)
            ahead = forwards(0.0, at, held, np.zeros(0))
            np.testing.assert_allclose(ahead, expected, rtol=1e-12, atol=1e-15)
            back = np.asarray(backwards(0.0, at, held, np.zeros(0)))
            np.testing.assert_allclose(back, expected, rtol=1e-12, atol=1e-15)
        outputs = compile_system(system_of(product), "jax").module.outputs
        at = np.array([-2.0, 0.7, 0.0]), held, np.zeros(0)
        assert np.asarray(jax.jacfwd(outputs, argnums=1)(0.0, *at)).tolist() == [[0.0, 1.0, 0.0]]
        assert np.isnan(jax.jacrev(outputs, argnums=1)(0.0, *at)[0, 0])


@needs_jax
@pytest.mark.slow
def test_the_precision_is_that_of_the_arguments():
    import jax
    import jax.numpy as jnp

    module = compile_system(eom.heavy_top(), "jax").module
    n, m = len(module.STATES), len(module.PARAMETERS)
    for there in (False, True):
        with jax.enable_x64(there):
            single = module.rhs(0.0, jnp.full(n, 0.5, jnp.float32), jnp.full(m, 1.5, jnp.float32))
            assert single.dtype == jnp.float32
            whole = module.rhs(0, jnp.ones(n, int), jnp.ones(m, int))
            assert whole.dtype == (jnp.float64 if there else jnp.float32)
    with jax.enable_x64(True):
        text = str(jax.make_jaxpr(module.rhs)(0.0, np.full(n, 0.5), np.full(m, 1.5), np.zeros(0)))
    assert "f32" not in text.replace("f32[0]", "")


@needs_jax
@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [n if n in FEW else pytest.param(n, marks=pytest.mark.long) for n in catalogue.names()]
)
def test_vmap_over_ten_thousand_points_is_our_batch(name):
    import jax

    scene = eom.load_scene(name)
    compiled, ours = compile_system(scene.derive(), "jax"), compile_system(scene.derive())
    t, xs, ps, us = near_the_start(scene)
    rng = np.random.default_rng(3)
    many = xs[:, None] + rng.uniform(-0.01, 0.01, (len(xs), 10_000))
    with jax.enable_x64(True):
        mapped = jax.jit(jax.vmap(compiled.module.rhs, (None, 1, None, None), 1))
        got = np.asarray(mapped(t, many, ps, us))
    expected = ours.batch()(t, many, ps, us)
    assert np.isfinite(expected).all()
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())


@needs_jax
@pytest.mark.slow
@pytest.mark.parametrize("name", ["heavy-top", "quadrotor", "t-handle", "double-pendulum"])
def test_operation_by_operation_the_numbers_are_those_of_c_to_the_last_bit(name):
    """XLA alone contracts products and sums: the text has the order of operations of the others."""
    import jax

    scene = eom.load_scene(name)
    compiled, ours = compile_system(scene.derive(), "jax"), compile_system(scene.derive(), "c")
    t, xs, ps, us = near_the_start(scene)
    points = xs[:, None] + np.random.default_rng(4).uniform(-0.01, 0.01, (len(xs), 100))
    with jax.enable_x64(True):
        got = np.asarray(compiled.module.rhs(t, points, ps, us))
    np.testing.assert_array_equal(got, ours.rhs(t, points, ps, us))


@needs_jax
@pytest.mark.slow
def test_what_asks_for_another_target_takes_this_one_too():
    """Runs, our Jacobian and sensitivities, over functions of JAX."""
    scene = eom.load_scene("t-handle")
    found = []
    for target in ("jax", "numpy"):
        compiled = compile_system(scene.derive(), target)
        values = scene.initial_values(), (0, 0.2), scene.parameter_values()
        run = codegen.simulate(compiled, *values, "scipy:DOP853", rtol=1e-10)
        assert run.success
        slopes = compiled.jacobian().dense(0.0, [1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
        grown = codegen.sensitivities(compiled, ["I1"]).compiled
        n = len(grown.layout.states)
        rates = grown.rhs(0.0, np.linspace(1, 2, n), [1.0, 2.0, 3.0])
        found.append(np.concatenate([run.y[:, -1], slopes.ravel(), rates]))
    np.testing.assert_allclose(*found, rtol=1e-9, atol=1e-12)


@needs_jax
@pytest.mark.slow
def test_ten_thousand_trajectories_at_once_are_our_ensemble():
    diffrax = pytest.importorskip("diffrax")
    import jax

    scene = eom.load_scene("t-handle")
    module = compile_system(scene.derive(), "jax").module
    p = np.array([*scene.parameter_values().values()])
    first = np.array([*scene.initial_values().values()])[:, None] + np.zeros((3, 10_000))
    first[0] += np.linspace(-0.01, 0.01, 10_000)
    fleet = codegen.ensemble(
        scene.derive(), dict(zip(module.STATES, first, strict=True)), (0, 1), scene.parameter_values(),
        rtol=1e-11, keep=True,
    )  # fmt: skip

    def last(x0):
        return diffrax.diffeqsolve(
            diffrax.ODETerm(module.rhs), diffrax.Dopri8(), 0.0, 1.0, 1e-3, x0, p,
            stepsize_controller=diffrax.PIDController(rtol=1e-10, atol=1e-12),
        ).ys[0]  # fmt: skip

    with jax.enable_x64(True):
        got = np.asarray(jax.jit(jax.vmap(last, 1, 1))(first))
    np.testing.assert_allclose(got, fleet.columns["y_stop"], rtol=1e-8, atol=1e-9)


@needs_jax
@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "heavy-top",
        *(
            pytest.param(n, marks=pytest.mark.long)
            for n in ("t-handle", "double-pendulum", "rotary-pendulum")
        ),
    ],
)
def test_gradients_of_trajectories_by_diffrax_are_our_sensitivities(name):
    """Backwards through an adaptive solver, and forwards by the variational equations."""
    diffrax = pytest.importorskip("diffrax")
    import jax

    scene = eom.load_scene(name)
    first, values, inputs = scene.initial_values(), scene.parameter_values(), scene.input_values()
    compiled = compile_system(scene.derive(), "jax")
    module, end = compiled.module, 0.5
    parameters = list(module.PARAMETERS)
    s = codegen.sensitivities(compile_system(scene.derive()), parameters)
    ours = codegen.simulate(
        s.compiled, s.initial(first), (0, end), values, "DOP853", 1e-12, inputs=inputs
    )
    expected = s.matrix(ours.y)[:, :, -1]

    def last(p):
        start, u = np.array([first[n] for n in module.STATES]), np.array([*inputs.values()])
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(lambda t, x, args: module.rhs(t, x, *args)), diffrax.Dopri8(), 0.0, end, 1e-3,
            start, (p, u), stepsize_controller=diffrax.PIDController(rtol=1e-11, atol=1e-13),
        )  # fmt: skip
        return solution.ys[0]

    with jax.enable_x64(True):
        p = np.array([values[n] for n in parameters])
        got = np.asarray(jax.jit(jax.jacrev(last))(p))
        np.testing.assert_allclose(last(p), ours.y[: len(first), -1], rtol=1e-9, atol=1e-9)
    scale = np.abs(expected).max()
    np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-9 * scale)


@needs_jax
@pytest.mark.slow
def test_the_command_line_writes_a_module_that_works_by_itself(tmp_path):
    command = [sys.executable, "-m", "eom", "generate", "t-handle", "--target", "jax", "--out"]
    subprocess.run([*command, str(tmp_path)], check=True, capture_output=True)
    script = (
        "import sys; sys.path.insert(0, sys.argv[1]); import jax;"
        "jax.config.update('jax_enable_x64', True); import t_handle as m;"
        "print(jax.grad(lambda x: m.rhs(0.0, x, [1.0, 2.0, 3.0])[0])(jax.numpy.array([1.0, 2.0, 3.0])))"
    )
    run = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, check=True
    )
    assert np.fromstring(run.stdout.strip(" []\n"), sep=" ") == pytest.approx([0.0, -3.0, -2.0])
