"""Closed loops: symbolic laws against matrix exponentials, single runs, and each other."""

import numpy as np
import pytest
import sympy as sp
from scipy.linalg import expm

import codegen
import eom
from eom.errors import InputError

X, V, U = sp.symbols("x v u", real=True)
K, D, KI = sp.symbols("k d k_i", real=True)
GAINS = {"k": 4.0, "d": 3.0, "k_i": 2.0}
CART = eom.System.from_rates(
    "cart", {X: V, V: U}, inputs=[U], outputs={"error": 1 - X}, invariants={"none": V - V}
)


def closed(**more):
    error = sp.Symbol("error")  # an output, by its name alone
    return CART.with_control({"u": K * error - D * sp.Symbol("v") + KI * sp.Symbol("z")},
                             {"z": error}, **more)  # fmt: skip


def exact(t, start=(0.3, 0.0, 0.0)):
    A = np.zeros((4, 4))
    A[0, 1], A[1], A[2] = 1, (-4, -3, 2, 4), (-1, 0, 0, 1)
    return (expm(t * A) @ [*start, 1])[:3]


@pytest.mark.parametrize("target", ["c", "numpy"])
def test_a_linear_loop_with_an_integrator_is_the_matrix_exponential(target):
    system = codegen.compile(closed(), target)
    run = codegen.simulate(system, {"x": 0.3, "v": 0}, (0, 5), GAINS, rtol=1e-11)
    assert run.y[:, -1] == pytest.approx(exact(5), abs=1e-9)
    assert run["u"] == pytest.approx(
        4 * (1 - run["x"]) - 3 * run["v"] + 2 * run["z"], rel=1e-13, abs=1e-13
    )


def test_a_loop_starts_where_a_quantity_says_or_the_user():
    z = eom.Quantity(sp.Symbol("z", real=True), "m s", default=0.7)
    loop = CART.with_control({U: -K * X - D * V + KI * z.symbol}, {z: -1.0 * z.symbol})
    assert loop.states[-1].unit == "m s"
    compiled = codegen.compile(loop, "numpy")
    for given, first in (({}, 0.7), ({"z": 0.2}, 0.2)):
        run = codegen.simulate(compiled, {"x": 1, "v": 0, **given}, (0, 1), GAINS)
        assert run["z"][0] == first
    with pytest.raises(InputError, match="missing initial value: v"):
        codegen.simulate(compiled, {"x": 1}, (0, 1), GAINS)


def test_an_ensemble_over_gains_is_its_single_runs():
    system = codegen.compile(closed())
    k = np.array([1.0, 4.0, 9.0])
    whole = codegen.ensemble(system, {"x": 0.3, "v": 0.0}, (0, 2), {**GAINS, "k": k}, t_eval=[2.0])
    for n, gain in enumerate(k):
        one = codegen.simulate(system, {"x": 0.3, "v": 0}, (0, 2), {**GAINS, "k": gain})
        assert whole.y[:, -1, n] == pytest.approx(one.y[:, -1], abs=1e-8)


def test_linear_motion_is_that_of_the_loop():
    compiled = codegen.compile(closed(), "numpy")
    found = codegen.linearise(compiled, [1, 0, 0], [GAINS[n] for n in closed().parameter_names])
    assert pytest.approx(np.array([[0, 1, 0], [-4, -3, 2], [-1, 0, 0]])) == found.A


def test_saturation_is_found_as_a_kink_and_jumps_are_events():
    law = eom.saturate(-K * X - D * V, -1, 1)
    loop = CART.with_control({"u": law})
    fine = codegen.simulate(loop, {"x": 5, "v": 0}, (0, 8), {"k": 4, "d": 3}, rtol=1e-12)
    other = codegen.simulate(
        loop, {"x": 5, "v": 0}, (0, 8), {"k": 4, "d": 3}, "scipy:DOP853", rtol=1e-12
    )
    assert fine.y[:, -1] == pytest.approx(other.y[:, -1], abs=1e-10)
    assert fine["u"].min() == -1.0
    first = -3 * fine["v"] - 4 * fine["x"]
    assert fine["u"] == pytest.approx(np.clip(first, -1, 1), abs=1e-12)


def test_saturation_of_numbers():
    assert [eom.saturate(n, -1, 1) for n in (3, -3)] == [1, -1]
    assert eom.saturate(sp.Rational(1, 3), -1, 1) == sp.Rational(1, 3)
    with pytest.raises(InputError, match="wrong order"):
        eom.saturate(X, 1, -1)


def test_laws_read_outputs_and_each_other_in_any_order():
    a, b = sp.symbols("a b", real=True)
    two = eom.System("two", [X, V], [V, a + b], inputs=[a, b], outputs={"push": a + X},
                     definitions={"half": a / 2})  # fmt: skip
    loop = two.with_control({"b": -sp.Symbol("push") - 2 * sp.Symbol("shared"), "a": -V},
                            definitions={"shared": a * X})  # fmt: skip
    assert sp.expand(loop.rate_of(V) - (-V - (-V + X) - 2 * (-V * X))) == 0
    assert [d.name for d in loop.definitions] == ["a", "half", "shared", "b"]
    assert loop.output_names == ("push", "shared", "b", "a")
    assert loop.inputs == ()


def test_invariants_with_the_input_in_them_do_not_outlive_it():
    energy = {"with_u": V**2 / 2 - U * X, "free": sp.Symbol("c")}
    held = eom.System.from_rates("fall", {X: V, V: U}, inputs=[U], invariants=energy)
    assert held.with_control({"u": -X}).invariant_names == ("free",)


def test_a_mass_matrix_has_ones_for_states_of_the_control():
    M = sp.Matrix([[1, 0], [0, 2]])
    heavy = eom.System("heavy", [X, V], [V, U], inputs=[U], mass_matrix=M)
    loop = heavy.with_control({"u": -X + sp.Symbol("z")}, {"z": -X})
    assert loop.mass_matrix == sp.diag(1, 2, 1)
    run = codegen.simulate(codegen.compile(loop, "numpy"), {"x": 1, "v": 0}, (0, 3), rtol=1e-11)
    A = np.array([[0, 1, 0], [-0.5, 0, 0.5], [-1, 0, 0]])
    assert run.y[:, -1] == pytest.approx(expm(3 * A) @ [1, 0, 0], abs=1e-9)


@pytest.mark.parametrize(("laws", "states", "message"), [
    ({"w": X}, {}, "unknown input 'w'"),
    ({"u": "-x"}, {}, "not a number or a SymPy expression"),
    ({"u": sp.Symbol("accel")}, {}, "need their own results"),
    ({"u": sp.Symbol("u")}, {}, "need their own results"),
    ({"u": sp.Symbol("inner")}, {}, "intermediate definition"),
    ({"u": 0}, {"x": 1}, "this name is taken"),
    ({"u": 0}, {"accel": 1}, "this name is taken"),
    ({"u": sp.Function("f")(sp.Symbol("t", real=True))}, {}, "function of time"),
])  # fmt: skip
def test_what_is_no_law_is_refused(laws, states, message):
    system = eom.System("s", [X, V], [V, U], inputs=[U], definitions={"inner": X + 1},
                        outputs={"accel": U})  # fmt: skip
    with pytest.raises(InputError, match=message):
        system.with_control(laws, states)


ONE = {
    "body": {"moments": (12, 14, 8)}, "attitude": "quaternion", "outputs": ("q1", "u_1", "raw"),
    "torque": {"components": ("u_1", "-d*omega_2", "-d*omega_3")},
    "parameters": {"k": 1, "d": {"value": 4, "unit": "N m s"}, "M": 0.3},
    "control": {"laws": {"u_1": "saturate(raw, -M, M)"},
                "definitions": {"raw": "-k*q0*q1 - d*omega_1 - 0.1*z"},
                "states": {"z": {"rate": "q0*q1 + raw - u_1", "unit": "s"}}},
    "initial": {"omega_1": 0.1, "omega_2": 0, "omega_3": 0},
    "initial_attitude": {"sequence": "3-2-1", "degrees": (0, 0, 60)},
}  # fmt: skip


def test_a_scene_of_one_body_is_the_loop_that_python_makes():
    scene = eom.Scene(**ONE)
    system = scene.derive()
    assert system.input_names == ()
    assert "z" in system.state_names
    assert scene.initial_values()["z"] == 0.0
    assert {"u_1", "raw"} <= {*system.output_names}
    open_loop = scene.changed(control={}, parameters={"d": 4}, outputs=("q1",))
    z = sp.Symbol("z")
    q0, q1, w = sp.symbols("q0 q1 omega_1")
    raw = -sp.Symbol("k") * q0 * q1 - sp.Symbol("d") * w - z / 10
    law = eom.saturate(raw, -sp.Symbol("M"), sp.Symbol("M"))
    by_hand = open_loop.full_system.with_control({"u_1": law}, {"z": q0 * q1 + raw - law})
    ends = []
    for made in (system, by_hand):
        values = scene.initial_values(), (0, 20), scene.parameter_values()
        x0 = {n: values[0].get(n, 0.0) for n in made.state_names}
        p = {n: {**scene.numbers, **values[2]}[n] for n in made.parameter_names}
        compiled = codegen.compile(made, "numpy")
        ends.append(codegen.simulate(compiled, x0, (0, 20), p, rtol=1e-10)["q1"][-1])
    assert ends[0] == pytest.approx(ends[1], abs=1e-8)


def test_what_laws_share_has_a_unit_and_a_meaning_where_it_says_so():
    told = {"formula": ONE["control"]["definitions"]["raw"], "unit": "N m", "meaning": "asked for"}
    scene = eom.Scene(**{**ONE, "control": {**ONE["control"], "definitions": {"raw": told}}})
    (raw,) = (q for q in scene.derive().output_quantities if q.name == "raw")
    assert (raw.unit, raw.meaning) == ("N m", "asked for")
    plain = eom.Scene(**ONE).derive()
    assert plain.rates == scene.derive().rates
    units = {"M": {"value": 0.3, "unit": "N m"}, **{n: ONE["parameters"][n] for n in ("k", "d")}}
    control = {**ONE["control"], "definitions": {"raw": {**told, "unit": "kg"}}}
    with pytest.raises(InputError, match="dimension"):
        eom.Scene(**{**ONE, "parameters": units, "control": control}).derive()


def tree(**control):
    rod = {"mass": "m", "centre": (0, 0, "-l/2"), "moments": ("m*l**2/12", "m*l**2/12", 0)}
    hinge = {"kind": "revolute", "parent": "ground", "child": "rod", "axis": "x", "motor": True}
    return eom.TreeScene(bodies={"rod": rod}, joints={"hinge": hinge}, gravity=(0, 0, "-g"),
                         parameters={"m": 1, "l": 2, "g": 9.81, "k": 3}, control=control,
                         initial={"q_hinge": 0.4})  # fmt: skip


def test_a_tree_is_held_by_its_motor_and_reads_its_energy():
    weight = "-m*g*l/2*sin(q_hinge)"
    laws = {"tau_hinge": f"-({weight}) - k*u_hinge - 0*kinetic_energy - z"}
    scene = tree(laws=laws, states={"z": "kinetic_energy - z"})
    system = scene.derive()
    assert scene.initial_values() == {"q_hinge": 0.4, "u_hinge": 0.0, "z": 0.0}
    run = codegen.simulate(codegen.compile(system, "numpy"), scene.initial_values(), (0, 5),
                           scene.parameter_values())  # fmt: skip
    assert run["q_hinge"] == pytest.approx(0.4, abs=1e-9)


@pytest.mark.parametrize(("control", "message"), [
    ({"laws": {"tau_hinge": "-kk*q_hinge"}}, "unknown name 'kk'"),
    ({"laws": {"tau": "-k*q_hinge"}}, "no formula uses 'tau'"),
    ({"laws": {"tau_hinge": "-k*z"}, "states": {"k": "1"}}, "unknown name 'z'|used twice"),
    ({"laws": {"tau_hinge": "k"}, "states": {"q_hinge": "1"}}, "used twice"),
    ({"laws": {"tau_hinge": "k*__import__(1)"}}, "cannot be read"),
    ({"law": {"tau_hinge": "k"}}, "unknown key 'law'"),
])  # fmt: skip
def test_what_a_file_may_not_say_is_refused_when_it_is_read(control, message):
    with pytest.raises(InputError, match=message):
        tree(**control)


# -- Python functions of time and state ----------------------------------------------------------

PENDULUM = eom.System.from_rates(
    "pendulum", {X: V, V: U - sp.sin(X)}, inputs=[U], outputs={"speed": V}
)


def feedback(t, x):
    return -2 * x["v"] - 3 * x["x"] + np.sin(t)


@pytest.fixture(scope="module")
def pendulum():
    return codegen.compile(PENDULUM, "numpy")


@pytest.fixture(scope="module")
def by_law():
    law = PENDULUM.with_control({"u": -2 * V - 3 * X + sp.sin(PENDULUM.time)})
    return codegen.simulate(codegen.compile(law, "numpy"), [1, 0], (0, 5), rtol=1e-11)


@pytest.mark.parametrize(
    "method", ["auto", "DP5", "Tsit5", "scipy:Radau", "scipy:BDF", "scipy:LSODA"]
)
def test_a_function_of_time_and_state_is_the_symbolic_law(pendulum, by_law, method):
    run = codegen.simulate(pendulum, [1, 0], (0, 5), method=method, inputs={"u": feedback})
    assert run.y[:, -1] == pytest.approx(by_law.y[:, -1], abs=1e-7)
    assert "how smooth it is in the states is not known" in run.notice


@pytest.mark.parametrize("make", [
    lambda t, x: {"u": feedback(t, x)},
    lambda t, x: [feedback(t, x)],
    lambda t, x: np.array([feedback(t, x)]),
], ids=["by name", "a list", "an array"])  # fmt: skip
def test_one_function_of_all_inputs(pendulum, by_law, make):
    run = codegen.simulate(pendulum, [1, 0], (0, 5), inputs=make)
    assert run.y[:, -1] == pytest.approx(by_law.y[:, -1], abs=1e-8)


def test_states_that_no_output_needs_are_there_for_a_function(pendulum, by_law):
    run = codegen.simulate(pendulum, [1, 0], (0, 5), inputs={"u": feedback}, outputs=["speed"])
    assert run["speed"][-1] == pytest.approx(by_law["v"][-1], abs=1e-8)
    assert run.left_out == ()


def test_late_runs_give_functions_the_users_time(pendulum):
    late = codegen.simulate(pendulum, [1, 0], (100, 105), inputs={"u": feedback})
    early = codegen.simulate(
        pendulum, [1, 0], (0, 5), inputs={"u": lambda t, x: feedback(t + 100, x)}
    )
    assert late.y[:, -1] == pytest.approx(early.y[:, -1], abs=1e-8)


def test_accuracy_of_a_closed_loop_is_estimated_and_growth_is_not_known(pendulum, by_law):
    run = codegen.simulate(pendulum, [1, 0], (0, 5), inputs={"u": feedback}, rtol=1e-7)
    found = run.accuracy()
    assert np.all(found.error[:, -1] >= 0.1 * np.abs(run.y[:, -1] - by_law.y[:, -1]))
    assert np.all(np.isnan(found.growth))


def test_stiff_feedback_is_taken_by_an_implicit_method(pendulum):
    def hard(t, x):
        return -1e5 * x["v"] - 1e5 * x["x"]

    law = codegen.compile(PENDULUM.with_control({"u": -100000 * (V + X)}), "numpy")
    runs = [codegen.simulate(pendulum, [1, 0], (0, 5), inputs={"u": hard}, rtol=1e-7),
            codegen.simulate(law, [1, 0], (0, 5), rtol=1e-7)]  # fmt: skip
    for run in runs:
        assert run.success
        assert "stiff" in run.why
        assert run.steps < 5000
    assert runs[0]["x"][-1] == pytest.approx(runs[1]["x"][-1], rel=1e-5)


def test_the_signature_decides_what_a_function_is_of(pendulum):
    seen = []

    def of_time(t, gain=2.0):
        seen.append(gain)
        return gain * 0.0

    codegen.simulate(pendulum, [1, 0], (0, 1), inputs={"u": of_time})
    assert set(seen) == {2.0}
    with pytest.raises(InputError, match="neither the time alone nor time and states"):
        codegen.simulate(pendulum, [1, 0], (0, 1), inputs={"u": lambda t, x, p: 0.0})
    with pytest.raises(InputError, match="unknown state 'w'"):
        codegen.simulate(pendulum, [1, 0], (0, 1), inputs={"u": lambda t, x: x["w"]})


@pytest.mark.parametrize(("given", "message"), [
    (lambda t, x: {"w": 0.0}, "unknown input 'w'"),
    (lambda t, x: 0.0, "not a value for each input"),
    (lambda t, x: [0.0, 1.0], "not a value for each input"),
    (lambda t, x: {}, "does not return a number"),
    (lambda t, x: ["0"], "does not return a number"),
])  # fmt: skip
def test_what_a_function_of_all_inputs_may_not_return(pendulum, given, message):
    with pytest.raises(InputError, match=message):
        codegen.simulate(pendulum, [1, 0], (0, 1), inputs=given)


def test_a_switch_in_the_state_that_a_signal_states_nothing_of_is_resolved_by_steps():
    free = codegen.compile(eom.System.from_rates("slider", {X: V, V: U}, inputs=[U]), "numpy")
    bang = codegen.Signal(lambda t, x: -1.0 if x["x"] > 0 else 1.0, max_step=0.1)
    run = codegen.simulate(free, [1, 0], (0, 3), inputs={"u": bang}, rtol=1e-8)
    quarter = np.sqrt(2)  # then x is zero, and the force turns
    left = 3 - quarter
    assert run["x"][-1] == pytest.approx(-quarter * left + left**2 / 2, abs=1e-5)
