"""Torques that are small early, near the start, or where someone looks: none is overlooked."""

import random
import signal
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner

import codegen
import eom
from codegen.closed.closed_forms import find
from codegen.closed.held import Held, held
from codegen.frontend.layout import Layout, names_of, to_array
from codegen.measure.stress import forms
from codegen.measure.stress.record import SIZES, Plan
from codegen.native.trajectory import Problem
from eom.__main__ import main
from eom.commands.stressing import _material
from eom.errors import InputError
from eom.kinematics.coordinates import attitude
from eom.quantities import TIME
from eom.system import System

SECONDS = 60
"""A generous limit for what takes milliseconds, and did not end."""
M = sp.Symbol("M", real=True)
x, v, k = sp.symbols("x v k", real=True)
LATE = {
    "pulse": M * sp.exp(-(((TIME - 20) / 0.5) ** 2)),
    "window": M * (sp.tanh(10 * (TIME - 20)) - sp.tanh(10 * (TIME - 21))) / 2,
    "power of time": M * (TIME / 5) ** 401,
    "step": sp.Piecewise((0, TIME < 20), (M, True)),
}
FAR = {
    "end stop": lambda z: -M * sp.exp(50 * (z - 3)),
    "soft stop": lambda z: -M * sp.log(1 + sp.exp(100 * (z - 4))),
    "governor": lambda z: -M * (1 + sp.tanh(20 * (sp.Abs(z) - 5))) * z,
    "power": lambda z: -M * (z / 5) ** 401,
    "small power": lambda z: -M * (z / 50) ** 9,
}


def problem(compiled, start, parameters):
    layout = compiled.layout
    x0 = to_array(start, names_of(layout.states), "initial value")
    p = to_array(parameters, names_of(layout.parameters), "parameter")
    return Problem(x0, (0.0, 40.0), p, np.empty(0), 1e-9, np.full(len(x0), 1e-12), 1e-6, 0)


def form(system, start, parameters, truth=None):
    """Return the closed form of a system, which states what is true of another if one is given."""
    compiled = codegen.compile(system, "numpy")
    if truth is not None:
        layout = replace(compiled.layout, attitudes=Layout.of(truth).attitudes)
        compiled = replace(compiled, layout=layout)
    return find(compiled, problem(compiled, start, parameters))


def satellite(torque, kind=None):
    return eom.rigid_body(
        eom.principal_inertia(),
        lambda C, J: replace(
            eom.mechanics.torques.applied((torque, 0, 0), [eom.Quantity(M)]), numbers="values"
        ),
        attitude(kind) if kind else None,
    )


SPUN = {"omega_1": 0.1, "omega_2": 0.7, "omega_3": -0.3}
BODY = {"I1": 10.0, "I2": 15.0, "I3": 20.0, "M": 5.0}
TURNED = {"q0": 1.0, "q1": 0.0, "q2": 0.0, "q3": 0.0}


@pytest.mark.sparse(2)
@pytest.mark.parametrize("kind", [None, "quaternion"])
@pytest.mark.parametrize("name", [*LATE, *FAR])
def test_a_satellite_with_a_torque_has_no_closed_form(name, kind):
    torque = LATE[name] if name in LATE else FAR[name](sp.Symbol("omega_1", real=True))
    system, free = satellite(torque, kind), satellite(0 * M, kind)
    start = SPUN | (TURNED if kind else {})
    assert form(system, start, BODY) is None
    assert form(system, start, BODY, truth=free) is None
    assert form(system, start, {**BODY, "M": 0.0}) is not None
    with pytest.raises(InputError, match="stated, but not so: J d"):
        replace(system, attitudes=free.attitudes)


@pytest.mark.parametrize("name", [*LATE, *FAR])
def test_an_oscillator_with_a_force_has_no_closed_form(name):
    force = LATE[name] if name in LATE else FAR[name](x)
    system = System.from_rates("oscillator", {x: v, v: -k * x + force})
    values = {"k": 2.0, "M": 3.0}
    assert form(system, {"x": 0.5, "v": 0.1}, values) is None
    assert form(system, {"x": 0.5, "v": 0.1}, {**values, "M": 0.0}) is not None


@pytest.mark.parametrize("name", ["pulse", "window"])
def test_auto_integrates_the_late_torque(name):
    """The torque is zero to 1e-300 until it comes: then it turns the satellite."""
    compiled = codegen.compile(satellite(LATE[name]), "numpy")
    times = np.linspace(0, 40, 81)
    auto = codegen.simulate(compiled, SPUN, (0, 40), BODY, t_eval=times)
    exact = codegen.simulate(
        compiled, SPUN, (0, 40), BODY, "DOP853", rtol=1e-11, atol=1e-13, t_eval=times, max_step=0.05
    )
    free = codegen.simulate(compiled, SPUN, (0, 40), {**BODY, "M": 0.0}, t_eval=times)
    assert "closed form" not in auto.method
    assert "closed form" in free.method
    assert np.abs(free.y - exact.y).max() > 0.1


SCENE = """
title = "Satellite"
model = "rigid body"
outputs = ["omega_1", "omega_2", "omega_3"]
[body]
moments = [10.0, 15.0, 20.0]
[torque]
components = ["{torque}", 0, 0]
[initial]
omega_1 = 0.1
omega_2 = 0.7
omega_3 = -0.3
"""


@pytest.mark.parametrize(
    "torque",
    ["5*exp(-((t-20)/0.5)^2)", "5*(tanh(10*(t-20))-tanh(10*(t-21)))/2", "-(omega_1/5)^61"],
)
def test_generate_refuses_the_closed_form_of_a_late_torque(torque, tmp_path):
    path = tmp_path / "satellite.toml"
    path.write_text(SCENE.format(torque=torque), encoding="utf-8")
    words = ["generate", str(path), "--closed-form", "--out", str(tmp_path / "c")]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 2, done.output
    assert "no closed form is known" in done.output
    assert not (tmp_path / "c").exists()


@pytest.fixture
def limit():
    """Stop what does not end."""

    def stop(*_):
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(SECONDS)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


ABSURD = {
    "number": sp.Integer(2) ** -12000 * x,
    "exponential": sp.exp(-(10**4)) * x,
    "exponential of a huge number": sp.exp(-k * 10**9) * x,
    "of time": sp.exp(-((TIME - 10**5) ** 2)),
    "tower": sp.exp(sp.exp(k * 400)) * x**3,
    "power": (x / 5) ** 100_000,
}


@pytest.mark.usefixtures("limit")
@pytest.mark.parametrize("name", ABSURD)
def test_terms_of_absurd_size_are_decided_at_once(name):
    w1, w2 = sp.symbols("w1 w2", real=True)
    rates = {x: w1 * w2, w1: -x * w2, w2: -x * w1 / 2 + k * ABSURD[name]}
    system = System.from_rates("absurd", rates)
    assert form(system, [0.1, 0.2, 0.3], {"k": 1.0}) is None
    assert form(system, [0.1, 0.2, 0.3], {"k": 0.0}) is not None


@pytest.mark.usefixtures("limit")
def test_a_coefficient_that_no_double_can_be_has_no_closed_form():
    w1, w2 = sp.symbols("w1 w2", real=True)
    rates = {x: sp.Integer(2) ** -12000 * w1 * w2, w1: -x * w2, w2: -x * w1 / 2}
    assert form(System.from_rates("tiny", rates), [0.1, 0.2, 0.3], {}) is None


def test_powers_of_two_do_not_hide_in_the_field():
    """Modulo 2^521 - 1, a body with this torque would be one without."""
    torque = (M - 1) * x
    w1, w2 = sp.symbols("w1 w2", real=True)
    system = System.from_rates("hidden", {x: w1 * w2, w1: -x * w2, w2: -x * w1 / 2 + torque})
    for value in (2.0**521, 2.0**607, 2.0**-521, 1 + 2.0**-52):
        assert form(system, [0.1, 0.2, 0.3], {"M": value}) is None
    assert form(system, [0.1, 0.2, 0.3], {"M": 1.0}) is not None


def test_time_and_functions_that_cancel_by_form_leave_the_closed_form():
    w1, w2 = sp.symbols("w1 w2", real=True)
    wave = sp.sin(x) ** 2 + sp.cos(x) ** 2
    rates = {x: w1 * w2 * wave, w1: -x * w2 * (1 + TIME) / (1 + TIME), w2: -x * w1 / 2}
    rates[w1] = -x * w2 + sp.exp(TIME) * (x + w1) - sp.exp(TIME) * x - sp.exp(TIME) * w1
    assert form(System.from_rates("cancels", rates), [0.1, 0.2, 0.3], {}) is not None


def test_what_is_read_does_not_depend_on_the_initial_state_and_is_read_once(monkeypatch):
    compiled = codegen.compile(eom.free_rigid_body("quaternion"), "numpy")
    moments = {"I1": 1.0, "I2": 1.5, "I3": 2.0}
    count = []
    proved = Held.proved
    monkeypatch.setattr(Held, "proved", lambda self, f: count.append(1) or proved(self, f))
    for speed in (0.1, 1.0, 3.0):
        start = {"omega_1": speed, "omega_2": 0.1, "omega_3": 0.2, **TURNED}
        assert find(compiled, problem(compiled, start, moments)).name == "free body"
    assert len(count) == 2  # of the rates, and that moments are constants
    assert held(compiled, problem(compiled, start, moments)).attitudes == compiled.layout.attitudes


@pytest.mark.slow
def test_many_bodies_cost_no_proof(monkeypatch):
    """Of a system that is no single body nothing is evaluated."""
    monkeypatch.setattr(Held, "values", lambda *_: pytest.fail("evaluated"))
    scene = eom.load_scene("floating-tree")
    compiled = codegen.compile(scene.derive(), "numpy")
    start, values = scene.initial_values(), scene.parameter_values()
    assert compiled.layout.attitudes
    assert find(compiled, problem(compiled, start, values)) is None


# --- the check of `eom stress` --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def material():
    return _material()


PULSE = 1 + sp.exp(-(((TIME - 5) / 2) ** 2))
ROTATION = {x: v * sp.cos(TIME), v: -x * sp.cos(TIME)}
PRODUCTS = {x: v * k * PULSE, v: -x * k, k: x * v}


@pytest.mark.parametrize("rates", [ROTATION, PRODUCTS, {x: v * PULSE, v: -x}])
def test_a_coefficient_that_varies_is_none(rates):
    """Two or three states alone, and at every instant of the form of a free body."""
    system = System.from_rates("varied", rates)
    assert form(system, dict.fromkeys(system.state_names, 0.5), {}) is None


@pytest.mark.parametrize("symbol", ["m", "I1", "I3"])
def test_a_parameter_that_varies_is_none(symbol):
    """Of a top every parameter stands in the rates; what holds at each instant is no top."""
    system = eom.heavy_top("quaternion")
    a, b, p = sp.symbols(f"I1 I2 {symbol}", positive=True)
    assert {a, b, p} <= {q.symbol for q in system.parameters}
    rates = [system.expand(r).subs(b, a) for r in system.rates]
    varied = System.from_rates(
        "top", {q.symbol: r.subs(p, p * PULSE) for q, r in zip(system.states, rates, strict=True)}
    )
    start = dict(zip(system.state_names, (0.0, 0.0, 9.0, 0.8, 0.6, 0.0, 0.0), strict=True))
    numbers = {"I1": 0.5, "I3": 0.2, "m": 1.0, "g": 9.81, "r3": 0.3}
    assert form(system, start, {**numbers, "I2": 0.5}) is not None
    assert form(varied, start, numbers, system) is None


@pytest.mark.slow
def test_random_terms_are_never_overlooked(material):
    figures = forms.perturbed_forms(
        material, Plan(replace(SIZES["quick"], forms=60), seed=7)
    ).figures
    assert [f.value for f in figures] == [0, 0], figures
    assert "of 19 whose form" in figures[0].what


def test_the_check_sees_a_form_that_is_taken_wrongly(material, monkeypatch):
    monkeypatch.setattr(Held, "proved", lambda *_: True)
    figures = forms.perturbed_forms(material, Plan(replace(SIZES["quick"], forms=10))).figures
    assert figures[1].value > 0
    assert not figures[1].passed


def test_the_check_sees_a_form_that_is_lost(material, monkeypatch):
    monkeypatch.setattr(Held, "proved", lambda *_: False)
    assert (
        not forms.perturbed_forms(material, Plan(replace(SIZES["quick"], forms=1)))
        .figures[0]
        .passed
    )


def test_perturbations_are_of_all_sizes_and_the_same_each_time():
    system = eom.free_rigid_body("quaternion")
    numbers = (1.0, 2.0, 3.0)[: len(system.parameters)]
    known = forms.Known("body", system, Layout.of(system), numbers, ())
    first, again = ([forms.perturbed(known, random.Random(s))[1] for s in range(30)] for _ in "ab")
    assert first == again
    assert len(set(first)) == 30
