import pickle

import mpmath
import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.frontend.layout import names_of
from codegen.frontend.lower import lower_system
from codegen.integrate import scales
from codegen.ir.ops import OPS
from codegen.ir.program import OUTPUTS, RATES
from codegen.linearisation.sensitivity import sensitivities, variational
from codegen.native import native
from eom.errors import InputError
from eom.opening import load_scene
from eom.quantities import Quantity
from eom.scenes.scene import Scene
from eom.system import System
from tests.codegen.scenes import SCENES

x, v, k, m, c, t = sp.symbols("x v k m c t", real=True)
DECAY = System.from_rates("decay", {x: -k * x})
OSCILLATOR = System.from_rates("oscillator", {x: v, v: -k / m * x}, outputs={"force": -k * x})


def test_exponential_decay(target):
    """x = x0 exp(-k t): dx/dk = -t x, dx/dx0 = exp(-k t)."""
    s = sensitivities(codegen.compile(DECAY, target), ["k"], ["x"])
    start = s.initial({"x": 3.0})
    assert start == {"x": 3.0, "dx_dk": 0.0, "dx_dx_0": 1.0}
    run = codegen.simulate(s.compiled, start, (0, 2), {"k": 0.7}, rtol=1e-11)
    assert run.success
    assert run.names == ("x", "dx_dk", "dx_dx_0")
    assert np.allclose(run["dx_dk"], -run.t * run["x"], rtol=1e-9, atol=1e-12)
    assert np.allclose(run["dx_dx_0"], np.exp(-0.7 * run.t), rtol=1e-9)


@pytest.mark.sparse(3)
@pytest.mark.parametrize("method", ["auto", "scipy:Radau", "scipy:RK45"])
def test_harmonic_oscillator_by_every_kind_of_method(target, method):
    """Derivatives of the closed form, by SymPy; the start depends on k: x(0) = 1/k."""
    s = sensitivities(codegen.compile(OSCILLATOR, target), ["k", "m"], ["v"])
    values = {k: 2.3, m: 1.7}
    start = s.initial({"x": 1 / 2.3, "v": 0.4}, {"dx_dk": -(2.3**-2)})
    parameters = {q.name: n for q, n in values.items()}
    grid = np.linspace(0, 3, 7)
    run = codegen.simulate(s.compiled, start, (0, 3), parameters, method, 1e-9, t_eval=grid)
    assert run.success, run.message
    v0, w = sp.Symbol("v0"), sp.sqrt(k / m)
    motion = sp.cos(w * t) / k + v0 / w * sp.sin(w * t)
    S = s.matrix(run.y)
    assert S.shape == (2, 3, 7)
    for row, value in enumerate((motion, motion.diff(t))):
        for column, by in enumerate((k, m, v0)):
            closed = sp.lambdify(t, value.diff(by).subs({**values, v0: 0.4}))
            assert np.allclose(S[row, column], closed(grid), rtol=1e-6, atol=1e-6)
    for by in (k, m, v0):
        name = f"dforce_d{'v_0' if by is v0 else by}"
        closed = sp.lambdify(t, (-k * motion).diff(by).subs({**values, v0: 0.4}))
        assert np.allclose(run[name], closed(grid), rtol=1e-6, atol=1e-6)


def evaluate(program, group, time, states, parameters):
    """Values of a group at the working precision of mpmath, at points that are not doubles."""
    slots = {"state": states, "parameter": parameters}
    numbers = []
    for op, args, value in program.instructions:
        if op in OPS:
            numbers.append(OPS[op].exact(mpmath, *(numbers[a] for a in args)))
        elif op == "const":
            numbers.append(mpmath.mpf(value.numerator) / value.denominator)
        else:
            numbers.append(
                time if op == "time" else mpmath.pi + 0 if op == "pi" else slots[op][value]
            )
    return [numbers[n] for n in program.results[group]]


def runge_kutta(program, states, parameters, steps=2, h=0.125):
    """The classical method; its map of first to last states is differentiated by its own steps."""
    x = list(states)
    for n in range(steps):

        def f(a, slope=None, n=n, x=x):
            at = x if slope is None else [xi + h * a * si for xi, si in zip(x, slope, strict=True)]
            return evaluate(program, RATES, mpmath.mpf(h * (n + a)), at, parameters)

        k1 = f(0)
        k2 = f(0.5, k1)
        k3 = f(0.5, k2)
        k4 = f(1, k3)
        slopes = zip(x, k1, k2, k3, k4, strict=True)
        x = [xi + h / 6 * (a + 2 * b + 2 * d + e) for xi, a, b, d, e in slopes]
    return x


@pytest.mark.sparse(only=("lecture-wheel", "t-handle"))
@pytest.mark.parametrize("name", SCENES)
def test_ready_scenes_against_differences_of_their_motions_at_high_precision(name):
    """Differences of width 1e-25 in 60 digits, of the very steps that carry the sensitivities."""
    scene = load_scene(name)
    system = scene.derive()
    program = lower_system(system)
    n, count = len(system.states), len(system.parameters)
    with mpmath.workdps(60):
        first = [mpmath.mpf(a) + 0.1 for a in scene.initial_values().values()]
        p = [mpmath.mpf(a) for a in scene.parameter_values().values()]
        columns = [*range(count), *(None for _ in range(n))]
        extended = variational(program, n, columns)
        units = [[mpmath.mpf(i == j) for i in range(n)] for j in range(n)]
        start = [*first, *[mpmath.mpf(0)] * (n * count), *(e for unit in units for e in unit)]
        whole = runge_kutta(extended, start, p)
        plain = runge_kutta(program, first, p)
        outputs = evaluate(program, OUTPUTS, mpmath.mpf(1), plain, p)
        slopes = evaluate(extended, OUTPUTS, mpmath.mpf(1), whole, p)
        assert slopes[: len(outputs)] == outputs
        width = mpmath.mpf(10) ** -25
        for j in range(count + n):
            moved = [a + width * (i == j) for i, a in enumerate([*p, *first])]
            other = runge_kutta(program, moved[count:], moved[:count])
            changed = evaluate(program, OUTPUTS, mpmath.mpf(1), other, moved[:count])
            differences = [(b - a) / width for a, b in zip(plain, other, strict=True)]
            differences += [(b - a) / width for a, b in zip(outputs, changed, strict=True)]
            found = whole[n * (1 + j) : n * (2 + j)]
            found += slopes[len(outputs) * (1 + j) : len(outputs) * (2 + j)]
            for a, b in zip(found, differences, strict=True):
                assert abs(a - b) <= mpmath.mpf(10) ** -18 * (1 + abs(b))


@pytest.mark.sparse(only=("numpy",))
def test_constants_of_the_motion_and_names_remain(target):
    scene = Scene.ready("heavy-top")
    compiled = codegen.compile(scene.derive(), target)
    parameter, state = compiled.layout.parameters[0], compiled.layout.states[-1]
    s = sensitivities(compiled, [parameter.name], [state.name])
    assert s.variables == (parameter.name, f"{state.name}_0")
    q = s.compiled.layout.states[len(compiled.layout.states)]
    assert q.name == f"d{s.states[0]}_d{parameter.name}"
    assert q.unit == f"{compiled.layout.states[0].unit}/({parameter.unit})"
    values = scene.initial_values()
    run = codegen.simulate(s.compiled, s.initial(values), (0, 0.5), scene.parameter_values())
    assert run.success
    assert set(run.drift) == set(compiled.layout.results["invariants"])
    assert all(d.relative < 1e-6 for d in run.drift.values())
    again = pickle.loads(pickle.dumps(s.compiled))
    assert names_of(again.layout.states) == names_of(s.compiled.layout.states)
    assert str(again.program) == str(s.compiled.program)


def test_a_parameter_that_rates_do_not_read_has_zero_sensitivities(target):
    system = System.from_rates("still", {x: v, v: 0 * k}, outputs={"weight": k * m})
    s = sensitivities(codegen.compile(system, target), ["m"], ["x"])
    run = codegen.simulate(s.compiled, s.initial({"x": 1, "v": 2}), (0, 1), {"k": 3, "m": 4})
    assert np.all(run["dx_dm"] == 0)
    assert np.all(run["dx_dx_0"] == 1)
    assert np.allclose(run["dweight_dm"], 3)


def test_refused():
    compiled = codegen.compile(OSCILLATOR, "numpy")
    for arguments, message in [
        ((["q"],), "unknown parameter"),
        (([], ["k"]), "unknown state"),
        ((["k", "k"],), "given twice"),
        (([],), "no variables"),
    ]:
        with pytest.raises(InputError, match=message):
            sensitivities(compiled, *arguments)
    with pytest.raises(InputError, match="unknown parameter"):
        sensitivities(codegen.compile(OSCILLATOR, "numpy", {"k": 2.0}), ["k"])
    s = sensitivities(compiled, ["k"])
    with pytest.raises(InputError, match="dx_dm"):
        s.initial({"x": 1, "v": 0}, {"dx_dm": 1})
    with pytest.raises(InputError, match="unknown state"):
        s.initial({"y": 1})
    with pytest.raises(InputError, match="wrong shape"):
        s.matrix(np.zeros(3))
    clash = System.from_rates("clash", {x: -k * x, sp.Symbol("dx_dk"): x})
    with pytest.raises(InputError, match="two things"):
        sensitivities(codegen.compile(clash, "numpy"), ["k"])


# --- default tolerances of sensitivities -----------------------------------------------------------

w, p, e = sp.symbols("w p e", real=True)
needs_compiler = pytest.mark.skipif(not native.compiler(), reason="counts the steps of loops in C")


def tolerances_of(s, start, values, span=(0.0, 5.0), rtol=1e-9):
    """Default absolute tolerances by name, and what is reported."""
    layout = s.compiled.layout
    x, p = (
        np.array([float(given[q.name]) for q in group])
        for given, group in ((s.initial(start), layout.states), (values, layout.parameters))
    )
    found, reported = scales.of_run(
        s.compiled, scales.Point(x, p, np.zeros(0), 0.0), span, rtol, None
    )
    return dict(zip(names_of(layout.states), found, strict=True)), reported


def test_what_nothing_moves_has_the_tolerance_of_its_state_over_the_variable(target):
    """Of x by z(0), of which x knows nothing, and by m, which is read nowhere."""
    system = System.from_rates("apart", {x: v, v: -k * x, w: -w}, outputs={"weight": m})
    s = sensitivities(codegen.compile(system, target), ["m"], ["w"])
    found, reported = tolerances_of(s, {"x": 3.0, "v": 2.0, "w": 1e-7}, {"k": 2.0, "m": 1e12})
    assert not reported
    assert found["dx_dw_0"] == pytest.approx(1e-12 * 3.0 / 1e-7)
    assert found["dv_dw_0"] == pytest.approx(1e-12 * 2.0 / 1e-7)
    assert found["dw_dm"] == pytest.approx(1e-12 * 1e-7 / 1e12)


def test_a_parameter_that_is_zero_has_the_largest_size_of_its_unit_or_none():
    known = [Quantity(q, "m", "length") for q in (x, k, m)] + [Quantity(c, "1/s", "rate")]
    system = System("offset", tuple(known[:1]), (c * (k + m - x),), tuple(known[1:]))
    s = sensitivities(codegen.compile(system, "numpy"), ["k", "m"], ["x"])
    layout, start = s.compiled.layout, np.array([[2.0], [0.0], [0.0], [1.0]])

    def at(*values):
        return scales.Point(start, np.array([*values, 1.0]), np.zeros(0), 0.0)

    def rates(values):
        return lambda t, y: s.compiled.batch()(t, y, np.array([*values, 1.0]), np.zeros(0))

    for values, sizes in (((0.0, 5.0), [0, 0.4, 0.4, 1]), ((0.0, 0.0), [0, 0, 0, 1])):
        found = scales.of_slopes(rates(values), layout, at(*values), (0.0, 1.0))
        np.testing.assert_allclose(found[:, 0], sizes)
    plain = codegen.compile(system, "numpy").layout
    assert scales.of_slopes(rates((1.0, 1.0)), plain, at(1.0, 1.0), (0.0, 1.0)) is None


@needs_compiler
@pytest.mark.parametrize("method", ["DOP853", "taylor"])
def test_rounding_in_the_rates_of_sensitivities_forces_no_steps(method):
    """dv/dp starts with sin^2 + cos^2 - 1 and is moved later: as many steps as with given tolerances."""
    rates = {
        x: v,
        v: w - p * (sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1) + p * w * v,
        w: -sp.sin(x) - p * v / 8,
    }
    s = sensitivities(codegen.compile(System.from_rates("rounded", rates), "c"), ["p"], ["x", "v"])
    places = np.linspace(0.3, 1.5, 13)
    assert any(np.sin(at) ** 2 + np.cos(at) ** 2 != 1 for at in places)
    for at in places:
        start = s.initial({"x": at, "v": 0.0, "w": 0.0})
        own, given = (
            codegen.simulate(s.compiled, start, (0, 5), {"p": 0.7}, method, 1e-10, atol)
            for atol in (None, 1e-13)
        )
        assert not own.notice
        assert own.steps + own.rejected < 1.5 * (given.steps + given.rejected), at
        np.testing.assert_allclose(own.y[:, -1], given.y[:, -1], rtol=1e-7, atol=1e-8)


@needs_compiler
@pytest.mark.parametrize("size", [1e-150, 1e-12, 1.0, 1e9])
def test_small_sensitivities_keep_their_digits_in_any_unit_of_the_parameter(size):
    """x = cos t, v = -sin t; y' = a v + e p x, w' = y: dy/dp = e sin t, dw/dp = e (1 - cos t).

    Small as y is (a = 0), and small beside y over p (a = 1).
    """
    y, a = sp.symbols("y a", real=True)
    rates = {x: v, v: -x, y: a * v + e * p * x, w: y}
    s = sensitivities(codegen.compile(System.from_rates("small", rates), "c"), ["p"])
    t, first = np.linspace(0, 6, 25), s.initial({"x": 1.0, "v": 0.0, "y": 0.0, "w": 0.0})
    for unit in (1.0, 1e-9, 1e12):
        for large in (0.0, 1.0):
            values = {"p": unit, "e": size / unit, "a": large}
            run = codegen.simulate(s.compiled, first, (0, 6), values, "DOP853", 1e-9, t_eval=t)
            slope, summed = size / unit * np.sin(t), size / unit * (1 - np.cos(t))
            assert np.abs(run["dy_dp"] - slope).max() < 1e-7 * np.abs(slope).max()
            assert np.abs(run["dw_dp"] - summed).max() < 1e-7 * np.abs(summed).max()
            assert run.steps < 60


@needs_compiler
@pytest.mark.slow
def test_what_hovers_is_followed_in_a_few_steps():
    """A quadrotor at rest: rounding of its weight less its thrust, and derivatives much larger than x/p."""
    scene = load_scene("quadrotor")
    s = sensitivities(
        codegen.compile(scene.derive(), "c"),
        [*scene.parameter_values()], [*scene.initial_values()],
    )  # fmt: skip
    run = codegen.simulate(
        s.compiled, s.initial(scene.initial_values()), (0, 0.15), scene.parameter_values(), "DOP853", 1e-12,
        inputs=scene.input_values(),
    )  # fmt: skip
    assert run.success
    assert run.steps < 30


@needs_compiler
def test_a_chain_that_starts_at_rest_costs_no_more_than_with_given_tolerances():
    """The double pendulum let go, by all its parameters and first states, against a run at 1e-13."""
    scene = load_scene("double-pendulum")
    s = sensitivities(
        codegen.compile(scene.derive(), "c"),
        [*scene.parameter_values()], [*scene.initial_values()],
    )  # fmt: skip
    start, values = s.initial(scene.initial_values()), scene.parameter_values()
    close, own, given = (
        codegen.simulate(s.compiled, start, (0, 1), values, "DOP853", rtol, atol)
        for rtol, atol in ((1e-13, None), (1e-9, None), (1e-9, 1e-12))
    )
    assert own.steps < 1.5 * given.steps
    sizes = np.array([abs(q) for q in [*values.values(), *scene.initial_values().values()]])
    sizes[sizes == 0] = 1.0
    exact, found = (s.matrix(run.y[:, -1]) * sizes for run in (close, own))
    assert np.abs(found - exact).max() < 1e-7 * np.abs(exact).max()


@needs_compiler
@pytest.mark.parametrize("name", ["heavy-top", "double-pendulum", "t-handle"])
def test_tolerances_in_c_are_the_same_to_the_last_bit(name, monkeypatch):
    """Parameters of zero, first states of zero and all sizes, both directions of time."""
    scene, draw = load_scene(name), np.random.default_rng(5)
    compiled = codegen.compile(scene.derive(), "c")
    values = [np.array([*v.values()]) for v in (scene.initial_values(), scene.parameter_values())]
    s = sensitivities(compiled, [*scene.parameter_values()], [*scene.initial_values()])
    n, none, quick = len(values[0]), np.zeros(0), 0
    for turn in range(30):
        start = np.array([*s.initial(dict(zip(s.states, values[0], strict=True))).values()])
        start[:n] *= draw.choice([0.0, 1.0, 1e-17, 1e-9, 1e200, -3.0], n)
        parameters = values[1] * draw.choice([0.0, 1.0, 1e9, 1e-12], len(values[1]))
        span = (0.0, 3.0) if turn % 2 else (3.0, -1e5)
        point = scales.Point(start, parameters, none, 0.25)
        found = scales.of_run(s.compiled, point, span, 1e-9, None)
        of_many = scales.quickly(s.compiled, span, 1e-9, point.epoch)
        quick += of_many is not None and of_many(start, parameters, none) is not None
        with monkeypatch.context() as without:
            without.setattr(native, "_extension", lambda: None)
            plain = scales.of_run(s.compiled, point, span, 1e-9, None)
        assert found[0].tobytes() == plain[0].tobytes()
        assert found[1] == plain[1]
    assert native.python_headers() is None or quick == 30


@needs_compiler
def test_each_trajectory_of_an_ensemble_has_scales_by_its_own_parameters():
    """Spring constants a factor of 1e12 apart: dx/dk = -t sin(w t)/(2 w), w^2 = k; dx/dw(0) is zero."""
    rates = {x: v / m, v: -k * x / m, w: -w / m}
    s = sensitivities(codegen.compile(System.from_rates("many", rates), "c"), ["k", "m"], ["w"])
    sizes = np.array([1e-6, 1.0, 1e6])
    start = s.initial({"x": 1.0, "v": 0.0, "w": 1e-3})
    fleet = codegen.ensemble(
        s.compiled, start, (0, 2), {"k": sizes, "m": 1.0 + 0 * sizes}, "DOP853", 1e-10, t_eval=[2.0]
    )
    for j, size in enumerate(sizes):
        run = codegen.simulate(s.compiled, start, (0, 2), {"k": size, "m": 1.0}, "DOP853", 1e-10)
        root = np.sqrt(size)
        slope = -2 * np.sin(2 * root) / (2 * root)
        most = 1e-7 * min(2.0, 1 / root)
        assert abs(fleet["dx_dk"][-1, j] - slope) < most
        assert abs(run["dx_dk"][-1] - slope) < most
        assert fleet["dx_dw_0"][-1, j] == run["dx_dw_0"][-1] == 0
