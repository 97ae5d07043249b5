from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.compiling.compiled import compiled_jacobian, generate
from codegen.compiling.sparse import KINDS, with_jacobians
from codegen.derivatives.derivative import ORDERS
from codegen.ir.names import identifier
from codegen.linearisation.linear_motion import linearise
from codegen.passes.pipeline import specialised
from codegen.targets import load_module
from eom.errors import InputError
from eom.opening import load_scene
from eom.quantities import Definition, Quantity
from eom.scenes.scene import Scene
from eom.system import System
from tests.codegen.scenes import SCENES

x, v, m, k, c, f = sp.symbols("x v m k c f", real=True)


def oscillator():
    """A damped mass on a spring that stiffens, with a force as input and its power as output."""
    return System(
        name="oscillator",
        states=(Quantity(x, "m", "place"), Quantity(v, "m/s", "velocity")),
        rates=(v, (f - c * v - k * x - x**3) / m),
        parameters=tuple(Quantity(s, "1", "parameter") for s in (m, k, c)),
        inputs=(Quantity(f, "N", "force"),),
        outputs=(Definition(Quantity(sp.Symbol("power", real=True), "W", "power"), f * v),),
    )


P = (2.0, 3.0, 0.5)
TARGETS = ["c", "numpy"]


@pytest.fixture(scope="module", params=TARGETS)
def compiled(request):
    try:
        return codegen.compile(oscillator(), request.param)
    except InputError:
        pytest.skip("no C compiler")


def test_entries_have_their_places(compiled):
    J = compiled_jacobian(compiled)
    assert list(zip(J.rows, J.columns, strict=True)) == [(0, 1), (1, 0), (1, 1)]
    value, entries = J.with_value(0.0, (0.5, -1.0), P, (7.0,))
    assert np.allclose(value, compiled.rhs(0.0, (0.5, -1.0), P, (7.0,)), rtol=1e-15)
    assert np.allclose(entries, [1, -(3 + 3 * 0.25) / 2, -0.25], rtol=1e-15)
    dense = J.dense(0.0, (0.5, -1.0), P, (7.0,))
    assert np.array_equal(dense, J.sparse(0.0, (0.5, -1.0), P, (7.0,)).toarray())
    assert dense.shape == J.shape == (2, 2)
    assert J.colours == {0: 1, 1: 0}


def test_a_batch_is_its_columns_one_by_one(compiled):
    J = compiled_jacobian(compiled)
    points = np.random.default_rng(3).normal(size=(2, 9))
    batch = J.dense(0.0, points, P, (7.0,))
    assert batch.shape == (2, 2, 9)
    for n in range(9):
        one = J.dense(0.0, np.ascontiguousarray(points[:, n]), P, (7.0,))
        assert np.allclose(batch[..., n], one, rtol=1e-15)


def test_linearisation_is_that_of_the_textbook(compiled):
    linear = linearise(compiled, (0.5, -1.0), P, (7.0,))
    assert np.allclose(linear.A, [[0, 1], [-(3 + 0.75) / 2, -0.25]])
    assert np.allclose(linear.B, [[0], [0.5]])
    assert np.allclose(linear.C, [[0, 7]])
    assert np.allclose(linear.D, [[-1]])
    assert (linear.states, linear.inputs, linear.outputs) == (("x", "v"), ("f",), ("power",))


def test_along_a_trajectory_there_is_one_more_axis(compiled):
    path = np.random.default_rng(5).normal(size=(2, 4))
    linear = linearise(compiled, path, P, (7.0,))
    assert linear.A.shape == (2, 2, 4)
    assert linear.C.shape == (1, 2, 4)


def test_parameters_and_time(compiled):
    J = compiled_jacobian(compiled, "parameters")
    at = (0.5, -1.0), P, (7.0,)
    rate = compiled.rhs(0.0, *at)[1]
    assert np.allclose(J.dense(0.0, *at)[1], [-rate / 2, -0.25, 0.5])
    assert compiled_jacobian(compiled, "time").rows == ()


@pytest.mark.parametrize("by", KINDS)
def test_against_differences(by):
    scene = Scene.ready("gravity-gradient-satellite")
    compiled = codegen.compile(scene.derive(), "numpy")
    states = np.array(list(scene.initial_values().values()))
    p = np.array(list(scene.parameter_values().values()))
    J = compiled_jacobian(compiled, by).dense(0.0, states, p)
    base = {"states": states, "parameters": p, "inputs": np.empty(0), "time": np.zeros(1)}[by]
    for column in range(len(base)):
        width = 1e-6 * max(1e-3, abs(base[column]))
        sides = []
        for s in (1, -1):
            moved = base.copy()
            moved[column] += s * width
            args = {"states": (0.0, moved, p), "parameters": (0.0, states, moved)}
            sides.append(compiled.rhs(*args.get(by, (moved[0], states, p))))
        slope = (sides[0] - sides[1]) / (2 * width)
        assert np.allclose(J[:, column], slope, rtol=1e-6, atol=1e-9 * (1 + np.abs(slope).max()))


def test_what_was_compiled_once_is_kept(compiled, monkeypatch):
    """A second call derives, renders and compiles nothing; each target and question has its own."""
    J, linear = compiled.jacobian(), linearise(compiled, (0.5, -1.0), P, (7.0,))

    def never(*_):
        raise AssertionError("derived again")

    monkeypatch.setattr("codegen.compiling.sparse.derive", never)
    assert compiled.jacobian("states", "rates") is J is compiled_jacobian(compiled)
    assert compiled.jacobian("states", "rates").function is J.function
    again = linearise(compiled, (0.5, -1.0), P, (7.0,))
    assert all(np.array_equal(getattr(again, n), getattr(linear, n)) for n in "ABCD")
    monkeypatch.undo()
    assert compiled.jacobian("inputs") is not J
    assert compiled.jacobian("states", "outputs") is not J
    assert codegen.compile(oscillator(), compiled.target).jacobian() is not J


def test_a_trajectory_takes_one_call(compiled, monkeypatch):
    """Its states and times fit as they are, and A, B, C, D come from one evaluation."""
    run = codegen.simulate(compiled, (0.5, -1.0), (0, 1), P, inputs={"f": 7.0})
    linear = linearise(compiled, run.y, P, (7.0,), run.t)
    kept = compiled.derived
    calls = []
    for key, J in kept.items():
        counted = lambda *a, f=J.function: calls.append(a) or f(*a)  # noqa: E731
        monkeypatch.setitem(kept, key, replace(J, function=counted))
    again = linearise(compiled, run.y, P, (7.0,), run.t)
    assert len(calls) == 1
    for name, shape in {"A": (2, 2), "B": (2, 1), "C": (1, 2), "D": (1, 1)}.items():
        assert getattr(linear, name).shape == (*shape, len(run.t))
        assert np.array_equal(getattr(linear, name), getattr(again, name))
    for n in (0, len(run.t) - 1):
        x = np.ascontiguousarray(run.y[:, n])
        assert np.allclose(linear.A[..., n], linearise(compiled, x, P, (7.0,)).A, rtol=1e-14)


def test_the_mode_is_reported(compiled):
    assert compiled.jacobian().mode in ORDERS


def test_other_words_are_refused(compiled):
    with pytest.raises(InputError, match="states"):
        compiled_jacobian(compiled, "state")
    with pytest.raises(InputError, match="target"):
        compiled_jacobian(compiled, target="fortran")
    with pytest.raises(InputError, match="group of results"):
        compiled_jacobian(compiled, of="outptus")
    with pytest.raises(InputError, match="wrong shape"):
        compiled_jacobian(compiled)(0.0, (1.0,), P, (1.0,))


@pytest.mark.parametrize("name", SCENES)
def test_generated_files_may_hold_jacobians(name):
    """Rates first, then the entries; the pattern is exported, and both agree with the functions."""
    system = load_scene(name).derive()
    program, layout = with_jacobians(*specialised(system), ["states", "parameters", "states"])
    text = generate(program, layout, "numpy")[f"{identifier(layout.name)}.py"]
    module = load_module(text, "derived")
    compiled = codegen.compile(system, "numpy")
    x = np.linspace(0.2, 0.9, len(layout.states))
    p = np.linspace(0.7, 1.3, len(layout.parameters))
    for by in ("states", "parameters"):
        found = getattr(module, f"rates_by_{by}")(0.3, x, p)
        n = len(layout.states)
        np.testing.assert_allclose(found[:n], compiled.rhs(0.3, x, p), rtol=1e-13, atol=1e-15)
        matrix = compiled.jacobian(by)
        assert getattr(module, f"RATES_BY_{by.upper()}_PATTERN") == tuple(
            zip(matrix.rows, matrix.columns, strict=True)
        )
        np.testing.assert_allclose(found[n:], matrix(0.3, x, p), rtol=1e-12, atol=1e-14)


def test_jacobians_by_something_else_are_refused():
    with pytest.raises(InputError, match="kind of variable"):
        with_jacobians(*specialised(Scene.ready("t-handle").derive()), ["speeds"])
