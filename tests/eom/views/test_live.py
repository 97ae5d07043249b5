"""Live pages: the very scripts of the page in Node.js against the C target, and what the page says."""

import base64
import hashlib
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import codegen
import eom
from codegen.native import native
from eom import rotations
from eom.errors import InputError
from eom.scenes.description import principal_values
from eom.scenes.scene import Scene
from eom.views.live import page as code
from eom.views.live import subject as knobs
from eom.views.live.one_body import switches_of
from eom.views.live.page import page, speed_of, written
from eom.views.live.scenes import subject_of
from tests import node
from tests.eom.rows import only
from tests.eom.views.live_pages import (
    BOUND,
    SINGLE,
    SUPPORTED,
    WHOLE,
    Elements,
    data_of,
    run,
    subject,
    text_of,
)

needs_node = pytest.mark.skipif(not node.NODE, reason="no Node.js")
needs_both = pytest.mark.skipif(not (node.NODE and native.compiler()), reason="no Node.js or no C")

FRAMES = 601
"""Ten seconds at 60 frames a second."""
PLAY = f"""
const found = [], work = [];
for (let k = 0; k < {FRAMES}; k += 1) {{
  const before = motion.evaluations;
  motion.advance((10 * k) / {FRAMES - 1});
  found.push(Array.from(motion.states));
  work.push(motion.evaluations - before);
}}
const numbers = (names) => names.map(motion.value);
const valued = (names) => Object.fromEntries(names.map((n) => [n, motion.value(n)]));
const {{STATES, PARAMETERS, INPUTS}} = motion.names;
give({{found, work, message: motion.message, stopped: motion.stopped, names: STATES, x: numbers(STATES),
      p: valued(PARAMETERS), u: valued(INPUTS)}});
"""


def in_c(system, got):
    """The same motion by the C target; its other results are not needed."""
    held = tuple(d for d in system.invariants if d.name in system.maintained)
    system = replace(system, outputs=(), invariants=held)
    times = np.linspace(0, 10, FRAMES)
    p = {n: got["p"][n] for n in system.parameter_names}
    kept = codegen.simulate(
        codegen.compile(system, "c"), got["x"], (0, 10), p, inputs=got["u"],
        method="DOP853", rtol=code.TOLERANCE, t_eval=times,
    )  # fmt: skip
    assert kept.success, kept.message
    return kept.y


def difference(got, states):
    assert not got["message"]
    assert not got["stopped"]
    return float(np.max(np.abs(np.array(got["found"]).T - states)))


# -- the motion -----------------------------------------------------------------------------------------


@needs_both
@pytest.mark.parametrize("name", only(SUPPORTED, "double-pendulum"))
def test_the_page_moves_as_the_c_target_does(name):
    got = run(text_of(name), PLAY)
    about = subject(name)
    drawn = about.variants[about.choice].drawn
    assert tuple(got["names"]) == drawn.state_names
    far = 100 if name in BOUND else 1  # a linkage turns by 180 rad
    assert difference(got, in_c(drawn, got)) < 1e-9 * far
    quick = name in {"seven-joint-arm", "walking-leg", "four-bar-linkage"}
    times = 10 if quick else 1 if name in SINGLE else 2
    assert (
        np.mean(got["work"][1:]) < 30 * times
    )  # much damping, or a crank at 20 rad/s: short steps
    assert max(got["work"][1:]) < 120 * times


def test_the_camera_follows_what_floats():
    assert "camera" not in subject("double-pendulum").shown
    assert subject("double-pendulum").follow == -1
    about = subject("quadrotor")
    assert about.follow == 0
    assert data_of(text_of("quadrotor"))["follow"] == 0
    assert 'data-show="camera" checked' in text_of("quadrotor")


@pytest.mark.slow
@needs_both
def test_every_choice_moves_as_its_own_equations_say():
    name = "t-handle"
    about = subject(name)
    for choice in ((False, True), (True, True)):  # the scene's own is tested above
        variant = about.variants[choice]
        chosen = "".join(f"motion.choose({k}, {str(on).lower()});" for k, on in enumerate(choice))
        got = run(text_of(name), chosen + PLAY)
        assert difference(got, in_c(variant.drawn, got)) < 1e-9, choice


@needs_node
def test_left_out_moves_as_zero_does():
    """Law: the smaller right-hand side at some numbers is the general one at these numbers."""
    ends = "motion.advance(5); give([...motion.view]);"
    text = text_of("t-handle")
    small = run(text, f"motion.choose(0, true); motion.choose(1, true); {ends}")
    same = "motion.set('I1', 2.75e-4); motion.set('I2', 2.75e-4);"
    general = run(text, f"motion.choose(0, false); motion.choose(1, false); {same} {ends}")
    assert np.max(np.abs(np.subtract(small, general))) < 1e-8


@needs_node
@pytest.mark.parametrize("name", only(SINGLE, "t-handle", "t-handle-in-angles"))
def test_it_starts_where_the_scene_starts(name):
    scene = eom.Scene.ready(name)
    got = run(
        text_of(name),
        "give(Object.fromEntries(motion.names.STATES.map((n) => [n, motion.value(n)])));",
    )
    for state, value in scene.initial_values().items():
        if state in got:
            assert got[state] == pytest.approx(value, abs=1e-15)
    if "q0" in got:
        q = [got[f"q{k}"] for k in range(4)]
        assert math.hypot(*q) == pytest.approx(1, abs=1e-15)
    if name == "t-handle-in-angles":
        C = rotations.matrix_of_quaternion([math.cos(math.pi / 360), math.sin(math.pi / 360), 0, 0])
        assert np.allclose(rotations.matrix_of_quaternion(q), C, atol=1e-15)


@needs_node
def test_vectors_that_are_drawn_belong_together():
    """H = C^T J C omega in space, 2 T = omega . H, and the torque is the rate of H."""
    program = """
    motion.choose(0, false); motion.set("tau_2", 2e-4);
    const now = (t) => { motion.advance(t); return Array.from(motion.view); };
    give([now(0.5), now(0.5 + 1e-4), motion.inertia()]);
    """
    before, after, J = run(text_of("t-handle"), program)
    C, omega, H, torque = (np.array(before[a:b]) for a, b in ((0, 9), (9, 12), (12, 15), (15, 18)))
    C = C.reshape(3, 3)
    assert np.allclose(C.T @ np.array(J) @ C @ omega, H, rtol=1e-12)
    rate = (np.array(after[12:15]) - H) / 1e-4
    assert np.allclose(rate, torque, atol=1e-6)


@needs_node
def test_a_body_that_cannot_be_is_refused_and_the_motion_stays():
    program = """
    motion.advance(1);
    const before = Array.from(motion.states), was = motion.time;
    const said = [motion.set("I3", 5.6e-4), motion.message, motion.time === was];
    motion.advance(2);
    const moves = motion.time;
    const again = [motion.set("I3", 5.4e-4), motion.message, motion.time];
    const zero = [motion.set("I1", 0), motion.message];
    give({said, moves, again, zero});
    """
    got = run(text_of("t-handle"), program)
    accepted, message, stays = got["said"]
    assert not accepted
    assert stays
    assert "I3 = 0.00056 exceeds I1 + I2 = 0.00055 (triangle inequality)" in message
    assert got["moves"] == 2
    assert got["again"] == [True, "", 0]
    assert got["zero"] == [False, "I1 must be above zero"]


@needs_node
def test_moments_that_become_one_take_their_mean_and_get_their_values_back():
    program = """
    const moments = () => ["I1", "I2", "I3"].map((n) => motion.values.get(n));
    const seen = [];
    const choose = (on) => { motion.choose(1, on); seen.push([motion.message, ...moments()]); };
    choose(true); choose(false); choose(true);
    motion.set("I1", 4e-4); choose(false);
    motion.original(); seen.push(["", ...moments()]);
    give(seen);
    """
    own = ["", 1.5e-4, 4e-4, 5.2e-4]
    mean = ["", 2.75e-4, 2.75e-4, 5.2e-4]
    assert run(text_of("t-handle"), program) == [mean, own, mean, ["", 4e-4, 2.75e-4, 5.2e-4], own]


@needs_node
def test_too_few_steps_are_reported_and_a_run_may_go_on():
    got = run(
        text_of("t-handle"),
        "give([motion.advance(1, 3), motion.time > 0, motion.advance(1), motion.time]);",
    )
    assert got == [False, True, True, 1]


@needs_node
def test_a_singular_attitude_ends_the_run_with_its_meaning():
    got = run(
        text_of("lecture-wheel"),
        "motion.set('theta', Math.PI / 2); motion.advance(1); give([motion.time, motion.stopped]);",
    )
    assert got[0] == 0
    assert "psi and phi coincide" in got[1]


quaternions = st.tuples(*[st.floats(-1, 1)] * 4).map(
    lambda q: (
        np.array(q if math.hypot(*q) > 1e-3 else (0, 0, 1, 0))
        / (math.hypot(*q) if math.hypot(*q) > 1e-3 else 1)
    )
)


@needs_node
@settings(max_examples=1)
@given(
    st.lists(quaternions, min_size=40, max_size=40),
    st.lists(st.tuples(*[st.floats(0.1, 10)] * 3), min_size=40, max_size=40),
)
def test_rotations_of_the_page_are_those_of_eom(turns, diagonals):
    turns = [*turns, *np.eye(4)]
    matrices = [[x for row in rotations.matrix_of_quaternion(q) for x in row] for q in turns]
    tensors = []
    for q, d in zip(turns, diagonals, strict=False):
        C = np.array(rotations.matrix_of_quaternion(q))
        tensors.append((C.T @ np.diag(d) @ C).tolist())
    program = f"""
    give({{turns: {json.dumps(matrices)}.map((C) => [...EOM_ROTATIONS.ofMatrix(C)]),
          axes: {json.dumps(tensors)}.map((J) => EOM_ROTATIONS.principal(J))}});
    """
    got = run(text_of("t-handle"), program)
    for q, found in zip(turns, got["turns"], strict=True):
        assert abs(np.dot(q, found)) == pytest.approx(1, abs=1e-14)
    for J, found in zip(tensors, got["axes"], strict=True):
        R = np.array(rotations.matrix_of_quaternion(found["axes"])).T  # columns: the axes
        assert np.allclose(R @ np.diag(found["moments"]) @ R.T, J, atol=1e-12)


# -- the page ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", only(WHOLE, "t-handle", "double-pendulum"))
def test_pages_are_small_and_complete(name):
    text = text_of(name)
    assert len(text.encode()) < 2e6
    data, found = data_of(text), Elements(text)
    templates = {a["id"] for a, _ in found.all("template")}
    for chosen in data["equations"].values():
        named = [*chosen["statements"].values(), chosen["components"]]
        assert {n for n in named if n} <= templates
    assert set(data["equations"]) == set(data["variants"])
    for knob in data["knobs"]:
        assert knob["low"] <= knob["value"] <= knob["high"]
    labelled = {a["for"] for a, _ in found.all("label") if "for" in a}
    ranges = {a["id"] for a, _ in found.all("input") if a["type"] == "range"}
    assert ranges == labelled


def test_what_is_left_out_costs_nothing():
    data = data_of(text_of("t-handle"))
    operations = {key: chosen["after"] for key, chosen in data["equations"].items()}
    assert operations == {"00": 21, "10": 18, "01": 15, "11": 11}
    generated = {key: v["operations"] for key, v in data["variants"].items()}
    assert generated["11"] < generated["10"] < generated["00"]
    statements = [data["equations"][key]["statements"]["kane"] for key in ("00", "10")]
    assert statements[0] != statements[1]


def test_the_same_scene_gives_the_same_bytes():
    again = page(eom.load_scene("t-handle"))
    assert again == text_of("t-handle")


def test_only_scripts_and_styles_of_the_page_may_run():
    found = Elements(text_of("t-handle"))
    (policy,) = [a["content"] for a, _ in found.all("meta") if "http-equiv" in a]
    texts = [t for a, t in found.all("script") if a.get("type") != "application/json"] + [
        t for _, t in found.all("style")
    ]
    assert len(texts) == 6
    for text in texts:
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy
    assert "unsafe" not in policy
    assert policy.startswith("default-src 'none'")


EVIL = '</script></template><script>alert(1)</script><img src=x onerror="alert(2)">\u2028${`'


def test_hostile_words_stay_words():
    scene = Scene(
        name=EVIL, title=EVIL, description=EVIL, body={"moments": (1.0, 2.0, 2.5)},
        torque={"components": ("-c*omega_1", "k*omega_3", 0)},
        parameters={
            "c": {"value": 0.1, "unit": "N m s", "meaning": EVIL},
            "k": {"value": 1.0, "meaning": "'\"><b>"},
        },
        initial={"omega_1": 1.0, "omega_2": 0.0, "omega_3": 0.1},
    )  # fmt: skip
    text = page(scene)
    found = Elements(text)
    assert len(found.all("script")) == 6
    assert found.all("img") == found.all("b") == []
    assert [t for _, t in found.all("title")] == [EVIL]
    assert data_of(text)["name"] == EVIL
    switches = [s["words"] for s in data_of(text)["switches"]]
    assert f"c = 0: no {EVIL}" in switches
    if node.NODE:
        assert run(text, "motion.advance(1); give(motion.time);") == 1


# -- subjects -------------------------------------------------------------------------------------------


def damped(**more):
    return Scene(
        name="damped", body={"moments": (1.0, 2.0, 2.5)}, parameters={"c": 0.1},
        initial={"omega_1": 1.0, "omega_2": 0.0, "omega_3": 0.1}, **more,
    )  # fmt: skip


def test_a_parameter_of_the_torque_can_be_left_out_where_torque_remains():
    about = subject_of(damped(torque={"components": ("-c*omega_1", 0.5, 0)}))
    assert [s.name for s in about.switches] == ["torque_free", "symmetric", "without_c"]
    without = about.variants[False, False, True].drawn
    assert "c" not in without.parameter_names
    assert (
        without.rates[0] != about.variants[True, False, False].drawn.rates[0]
        or without.rates[1] != 0
    )
    for components in (("-c*omega_1", 0, 0), ("omega_1/c", 0.5, 0)):  # nothing left; division by it
        found = switches_of(damped(torque={"components": components}))
        assert [s.name for s in found] == ["torque_free", "symmetric"]


def test_a_full_inertia_matrix_has_six_sliders_and_no_symmetry():
    matrix = ((2.0, 0.1, 0.0), (0.1, 3.0, 0.2), (0.0, 0.2, 4.0))
    start = {"omega_1": 0.1, "omega_2": 2.0, "omega_3": 0.0}
    about = subject_of(Scene(name="skew", body={"matrix": matrix}, initial=start))
    assert [k.name for k in about.knobs if k.group == "inertia"] == [
        "J11",
        "J12",
        "J13",
        "J22",
        "J23",
        "J33",
    ]
    assert [s.name for s in about.switches] == ["torque_free"]


@pytest.mark.slow
@needs_both
def test_a_full_inertia_matrix_moves_as_in_c():
    matrix = ((2.0, 0.1, 0.0), (0.1, 3.0, 0.2), (0.0, 0.2, 4.0))
    scene = Scene(
        name="skew",
        body={"matrix": matrix},
        initial={"omega_1": 0.1, "omega_2": 2.0, "omega_3": 0.0},
    )
    about = subject_of(scene)
    got = run(written(about), PLAY)
    assert difference(got, in_c(about.variants[about.choice].drawn, got)) < 1e-9


@pytest.mark.slow
@needs_both
def test_torques_that_act_together_move_as_in_c():
    """A formula of the scene's own names beside a weight, and sizes that the page's body has not."""
    scene = Scene(
        name="driven top",
        attitude="3-1-2",
        integrate="quaternion",
        body={"solid": "cylinder", "mass": 2.0, "size": {"radius": 0.1, "length": 0.2}},
        torque={
            "weight": {"mass": 2.0, "centre_of_mass": (0, 0, 0.1)},
            "components": ("-k*omega_1", "-k*omega_2*cos(psi)", "0.1*m*g*r3*radius"),
        },
        parameters={"k": 0.01},
        initial={
            "omega_1": 0,
            "omega_2": "k/I1",
            "omega_3": 2,
            "psi": 0.1,
            "theta": 0.4,
            "phi": 0,
        },
    )
    about = subject_of(scene)
    got = run(written(about), PLAY)
    assert difference(got, in_c(about.variants[about.choice].drawn, got)) < 1e-9


@pytest.mark.slow
@needs_both
def test_narrow_torques_move_the_page_as_they_do_in_c():
    """A pulse and sharp friction: neither is passed over between two frames, and both show."""
    torque = ("100*exp(-((t - 2)/0.0001)^2)", "-0.1*tanh(200*omega_2)", 0)
    start = {"omega_1": 0.0, "omega_2": 0.0, "omega_3": 0.1}
    body = {"moments": (1.0, 2.0, 2.5)}
    about = subject_of(
        Scene(name="kicked", body=body, torque={"components": torque}, initial=start)
    )
    own = about.variants[about.choice]
    got = run(written(replace(about, switches=(), variants={(): own})), PLAY)
    assert difference(got, in_c(own.drawn, got)) < 1e-9
    before, after = (got["found"][k][got["names"].index("omega_1")] for k in (60, 180))
    assert abs(before) < 1e-15
    assert after == pytest.approx(0.01 * math.sqrt(math.pi), rel=1e-2)


BODY = {
    "body": {"moments": (12, 14, 8)}, "attitude": "quaternion",
    "torque": {"components": ("u_1", "-d*omega_2", "-d*omega_3")},
    "parameters": {"k": 1, "d": {"value": 4, "unit": "N m s"}, "M": 0.3, "start": 0.1},
    "control": {"laws": {"u_1": "saturate(raw, -M, M)"},
                "definitions": {"raw": "-k*q0*q1 - d*omega_1 - 0.1*z"},
                "states": {"z": {"rate": "q0*q1 + raw - u_1", "unit": "s"}}},
    "initial": {"omega_1": "start", "omega_2": 0, "omega_3": 0},
    "initial_attitude": {"sequence": "3-2-1", "degrees": (0, 0, 60)},
}  # fmt: skip
ROD = {
    "bodies": {"rod": {"mass": "m", "centre": (0, 0, "-l/2"), "moments": (1, 1, 0)}},
    "joints": {"hinge": {"kind": "revolute", "parent": "ground", "child": "rod", "axis": "x",
                         "motor": True}},
    "gravity": (0, 0, "-g"), "parameters": {"m": 1, "l": 2, "g": 9.81, "k": 3},
    "control": {"laws": {"tau_hinge": "-k*u_hinge + z"}, "states": {"z": "kinetic_energy - z"}},
    "initial": {"q_hinge": 0.4},
}  # fmt: skip


@needs_both
@pytest.mark.parametrize("scene", [lambda: Scene(**BODY), lambda: eom.TreeScene(**ROD)])
def test_laws_of_control_run_on_the_page(scene):
    """With states of their own, saturation and gains, which have sliders."""
    about = subject_of(scene())
    got = run(written(about), PLAY)
    assert difference(got, in_c(about.variants[about.choice].drawn, got)) < 1e-9
    assert "z" in got["names"]
    known = {k.name for k in about.knobs}
    assert {"k", "z"} <= known
    assert not {"u_1", "tau_hinge"} & known


@needs_both
@pytest.mark.parametrize(
    ("kind", "delay"),
    only(
        [(k, d) for k in ("body", "tree") for d in (0.0, 0.02, 0.13)], ("body", 0.0), ("tree", 0.13)
    ),
)
def test_sampled_laws_run_on_the_page_as_in_the_loop_in_c(kind, delay):
    """Steps end at samples and where their values take effect, after more than a period too."""
    more = {"period": 0.05, "delay": delay}
    if kind == "body":
        control = {
            **BODY["control"],
            **more,
            "states": {"z": {"next": "z + 0.05*q0*q1", "unit": "s"}},
        }
        scene = Scene(**{**BODY, "control": control})
    else:
        control = {
            **ROD["control"],
            **more,
            "states": {"z": {"next": "0.9*z + 0.1*kinetic_energy"}},
        }
        scene = eom.TreeScene(**{**ROD, "control": control})
    about = subject_of(scene)
    got = run(written(about), PLAY)
    assert difference(got, in_c(about.variants[about.choice].drawn, got)) < 1e-9
    assert ("z" in {k.name for k in about.knobs}, "z" in got["names"]) == (True, False)


def test_backwards_is_refused():
    scene = damped(torque={"components": ("-c*omega_1", 0, 0)}, integration={"t_end": -1.0})
    with pytest.raises(InputError, match="forward"):
        page(scene)


@pytest.mark.parametrize(
    "moments", [(1.0, 1.0, 0.3), (1.0, 2.0, 2.0), (2.0, 1.0, 2.0), (1.0, 2.0, 2.5)]
)
def test_the_switch_of_symmetry_is_about_the_moments_that_are_equal(moments):
    scene = Scene(
        name="body",
        body={"moments": moments},
        initial={"omega_1": 1.0, "omega_2": 0.0, "omega_3": 0.1},
    )
    (switch,) = [s for s in switches_of(scene) if s.name == "symmetric"]
    values = dict(zip(("I1", "I2", "I3"), principal_values(scene), strict=True))
    a, b = switch.words.removeprefix("symmetric: ").split(" = ")
    assert switch.on == (values[a] == values[b])
    assert switch.on == (len(set(moments)) < 3)


def test_sliders_hold_their_values_and_long_motions_are_shown_fast():
    for unit in ("rad", "kg", "N m", ""):
        for value in (0.0, 1e-6, 3.0, -250.0):
            quantity = eom.quantities.Quantity(eom.scenes.parse.sp.Symbol("x", real=True), unit)
            if unit != "kg" or value > 0:
                k = knobs.knob(quantity, value, "start")
                assert k.low <= value <= k.high
                assert k.low < k.high
    assert [speed_of(t) for t in (2.0, 120.0, 600.0)] == [1.0, 1.0, 10.0]
