"""Results as files, tables, pictures and animations, and what notebooks display."""

import importlib
import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from codegen import Result, simulate
from codegen.frontend import notebook
from codegen.runs import export
from eom.errors import InputError
from eom.opening import load_scene
from eom.system import System

Y, V = sp.symbols("y v", real=True)
OSCILLATOR = System.from_rates(
    "oscillator", {Y: V, V: -Y}, outputs={"twice": 2 * Y}, invariants={"E": (Y**2 + V**2) / 2}
)


@pytest.fixture(scope="module")
def run():
    compiled = codegen.compile(OSCILLATOR, "auto")
    return simulate(compiled, [1, 0], (0, 10), method="DOP853", rtol=1e-6, dense_output=True,
                    events={"top": Y})  # fmt: skip


@pytest.fixture(scope="module")
def top():
    scene = load_scene("heavy-top")
    return simulate(scene.derive(), scene.initial_values(), (0, 2), scene.parameter_values(),
                    method="DOP853")  # fmt: skip


def same(a, b):
    for name in ("t", "y", "y_stop"):
        assert getattr(a, name).tobytes() == getattr(b, name).tobytes()
    for name in ("status", "message", "notice", "why", "method", "names", "left_out", "steps", "rejected",
                 "nfev", "t_stop", "seconds", "margin", "units"):  # fmt: skip
        assert getattr(a, name) == getattr(b, name), name
    assert {n: v.tobytes() for n, v in a.outputs.items()} == {
        n: v.tobytes() for n, v in b.outputs.items()
    }
    assert {n: (d.start, d.largest, d.size, d.over_time.tobytes()) for n, d in a.drift.items()} == {
        n: (d.start, d.largest, d.size, d.over_time.tobytes()) for n, d in b.drift.items()
    }
    assert {
        n: (e.t.tobytes(), e.y.tobytes(), e.direction.tolist()) for n, e in a.events.items()
    } == {n: (e.t.tobytes(), e.y.tobytes(), e.direction.tolist()) for n, e in b.events.items()}


def test_what_was_saved_is_read_to_the_last_bit(run, top, tmp_path):
    for k, one in enumerate((run, top)):
        again = Result.load(one.save(tmp_path / f"{k}.npz"))
        same(again, one)
        same(Result.load(again.save(tmp_path / f"again{k}.npz")), one)
        assert not again.sol
        with pytest.raises(InputError, match="does not know what it came from"):
            again.accuracy()
    assert top.units["omega_1"] == "rad/s"
    with np.load(tmp_path / "1.npz", allow_pickle=False) as archive:
        assert archive["tilt"].tobytes() == top["tilt"].tobytes()


def test_states_that_kept_their_initial_values_have_columns(tmp_path):
    """Whoever reads a table finds every state of the scene in it, those among the parameters, too."""
    scene = load_scene("bicycle-wheel")
    made = simulate(scene.derive(), scene.initial_values(), (0, 1), scene.parameter_values(),
                    method="DOP853")  # fmt: skip
    assert (made.held, made.units["C"]) == ({"C": scene.parameter_values()["C"]}, "rad/s")
    table = np.genfromtxt(made.save(tmp_path / "run.csv"), delimiter=",", names=True)
    assert table.dtype.names == ("t", *made.names, "C", *made.outputs)
    np.testing.assert_array_equal(table["C"], made["C"])
    again = Result.load(made.save(tmp_path / "run.npz"))
    np.testing.assert_array_equal(again["C"], made["C"])


def test_a_file_never_runs_anything(run, tmp_path):
    """A pickled object, other texts, missing and misshapen arrays, no archive: one clear error each."""

    class Bomb:
        def __reduce__(self):
            return (pytest.fail, ("it was unpickled",))

    file = run.save(tmp_path / "run.npz")
    with np.load(file, allow_pickle=False) as archive:
        arrays = dict(archive)
    about = json.loads(str(arrays["eom.about"]))
    wrong = [
        {**arrays, "y": np.array([Bomb()], dtype=object)},
        {**arrays, "eom.about": np.array([Bomb()], dtype=object)},
        {**arrays, "eom.about": np.array("{")},
        {**arrays, "eom.about": np.array(json.dumps({**about, "format": 2}))},
        {**arrays, "eom.about": np.array(json.dumps([1]))},
        {**arrays, "y": arrays["y"][:-1]},
        {**arrays, "y": np.array(["a"] * len(arrays["t"]))},
        {n: v for n, v in arrays.items() if n != "eom.y_stop"},
        {n: v for n, v in arrays.items() if n != "eom.about"},
    ]
    for found in wrong:
        np.savez(tmp_path / "wrong.npz", **found)
        with pytest.raises(InputError, match="the file is no result"):
            Result.load(tmp_path / "wrong.npz")
    (tmp_path / "text.npz").write_text("no archive")
    (tmp_path / "empty.npz").write_bytes(b"")
    for name in ("text.npz", "empty.npz", "not there.npz", "."):
        with pytest.raises(InputError, match=r"the file (is no result|cannot be read)"):
            Result.load(tmp_path / name)


def test_names_that_files_need_are_refused(tmp_path):
    own = sp.Symbol("eom.about", real=True)
    made = simulate(
        System.from_rates("odd", {own: sp.Integer(1)}), [0.0], (0, 1), method="scipy:RK45"
    )
    with pytest.raises(InputError, match="a name cannot be kept"):
        made.save(tmp_path / "odd.npz")
    with pytest.raises(InputError, match="unknown kind of file"):
        made.save(tmp_path / "odd.xlsx")


def test_tables_hold_the_same_numbers_with_units(top, monkeypatch):
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    frame, data = top.to_pandas(), top.to_xarray()
    assert isinstance(frame, pandas.DataFrame)
    assert isinstance(data, xarray.Dataset)
    assert list(frame.columns) == [*top.names, *top.held, *top.outputs]
    assert (frame.index.name, frame.index.to_numpy().tobytes()) == ("t", top.t.tobytes())
    for name in frame.columns:
        assert frame[name].to_numpy().tobytes() == top[name].tobytes()
        assert data[name].to_numpy().tobytes() == top[name].tobytes()
        assert data[name].attrs["units"] == frame.attrs["units"][name] == top.units[name]
    assert data["t"].attrs["units"] == "s"

    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    for make in (export.frame, export.dataset):
        with pytest.raises(InputError, match=r"eom-toolkit\[tables\]"):
            make(top)


def test_states_are_had_by_name_at_any_time(run, top):
    t = np.array([0.0, 1.25, 7.0])
    assert run.at(t)["y"].tobytes() == run.sol(t)[0].tobytes()
    assert run.at(1.25)["v"] == run.sol(1.25)[1]
    assert run.at(1.25)["y"] == pytest.approx(np.cos(1.25), abs=1e-5)
    with pytest.raises(InputError, match="no dense output"):
        top.at(1.0)


def test_a_result_is_drawn_by_itself_and_when_it_was_read(top, tmp_path):
    again = Result.load(top.save(tmp_path / "top.npz"))
    for one in (top, again):
        picture = one.plot("tilt", "omega_1")
        assert [row[0].axes[1].words for row in picture.rows[:2]] == [
            row[0].axes[1].words for row in top.plot("tilt", "omega_1").rows[:2]
        ]
        with pytest.raises(InputError, match="unknown state or output"):
            one.plot("tlt")


def test_a_picture_is_saved_and_goes_on_as_a_figure(run, tmp_path):
    picture = run.plot()
    for name, start in (("run.png", b"\x89PNG"), ("run.svg", b"<?xml"), ("run.pdf", b"%PDF")):
        assert picture.save(tmp_path / name, (5, 4), 60).read_bytes().startswith(start)
    assert "<html" in picture.save(tmp_path / "run.html").read_text("utf-8")
    figure = picture.figure((6, 5))
    assert figure.get_size_inches().tolist() == [6, 5]
    assert any(axes.get_lines() for axes in figure.axes)
    with pytest.raises(InputError, match="unknown kind of picture"):
        picture.save(tmp_path / "run.jpg")


def test_the_motion_of_the_body_among_the_states_is_animated(top, tmp_path):
    made = top.animate(speed=0.5)
    track = made.animation.tracks.bodies[0]
    scene = load_scene("heavy-top")
    dense = simulate(scene.derive(), scene.initial_values(), (0, 2), scene.parameter_values(),
                     method="DOP853", dense_output=True)  # fmt: skip
    q = np.array([dense.at(made.animation.times)[f"q{k}"] for k in range(4)]).T
    apart = np.minimum(np.abs(track.quaternions - q).max(), np.abs(track.quaternions + q).max())
    assert apart < 1e-6
    assert "<html" in made.write(tmp_path / "top.html").read_text("utf-8")
    assert "Heavy symmetric top" in repr(made)
    assert made._repr_html_().startswith("<iframe srcdoc=")
    with pytest.raises(InputError, match="unknown kind of file"):
        made.write(tmp_path / "top.gif")


def test_a_motion_is_animated_with_its_scene_from_where_it_started():
    scene = load_scene("t-handle")
    start = {**scene.initial_values(), "omega_1": 0.2}
    one = simulate(scene.derive(), start, (0, 2), scene.parameter_values(), method="DOP853")
    with pytest.raises(InputError, match="give the scene"):
        one.animate()
    found = one.animate(scene).animation.tracks
    at_start = np.linalg.norm(found.bodies[0].omega[0])
    assert at_start == pytest.approx(np.linalg.norm(one.y[:, 0]))
    for wrong in ("t-handle", 3):
        with pytest.raises(InputError, match="not a scene"):
            one.animate(wrong)


GAINS = {"q_arm": -0.3162, "q_pin": 2.8154, "u_arm": -0.1822, "u_pin": 0.3646}


@pytest.mark.parametrize("how", ["law", "sampled law", "function"])
def test_a_closed_loop_is_animated_as_it_moved_and_not_as_its_scene_would(how):
    scene = load_scene("rotary-pendulum")
    system, inputs = scene.derive(), None
    law = -sum(k * sp.Symbol(n) for n, k in GAINS.items())
    if how == "function":
        inputs = {"tau_arm": lambda t, x: -sum(k * x[n] for n, k in GAINS.items())}
    else:
        period = 0.02 if how == "sampled law" else None
        system = system.with_control({"tau_arm": law}, period=period)
    start = {"q_arm": 0, "q_pin": 0.2, "u_arm": 0, "u_pin": 0}
    run = simulate(
        system, start, (1, 3), scene.parameter_values(), inputs=inputs, dense_output=True
    )
    made = run.animate(scene).animation
    states = run.at(made.times + 1)
    arm, rod = (body.quaternions for body in made.tracks.bodies)
    assert np.abs(states["q_pin"]).max() < 0.25
    assert np.abs(2 * np.arctan2(arm[:, 3], arm[:, 0]) - states["q_arm"]).max() < 1e-8
    up = 1 - 2 * (rod[:, 1] ** 2 + rod[:, 2] ** 2)
    assert np.abs(up - np.cos(states["q_pin"])).max() < 1e-8
    (torque,) = (a for a in made.tracks.acting if a.name == "joint on arm")
    size = np.linalg.norm(torque.values, axis=1)
    motor = -sum(k * states[n] for n, k in GAINS.items())
    if how == "sampled law":  # at 10 of 11 times between samples
        motor = motor[np.floor(np.arange(len(motor)) / 3 + 1e-9).astype(int) * 3]
    damper = scene.parameter_values()["b"] * states["u_arm"]
    agree = np.abs(size - np.abs(motor - damper)) < 1e-9
    assert agree.mean() > (0.6 if how == "sampled law" else 0.999)


def test_wheels_of_a_closed_loop_turn_by_their_speeds():
    scene = load_scene("reaction-wheels")
    system = scene.derive().with_control({"tau_wheel1": sp.sin(sp.Symbol("t")) / 100})
    start, values = scene.initial_values(), scene.parameter_values()
    run = simulate(system, start, (0, 5), values, inputs={
        n: v for n, v in scene.input_values().items() if n in system.input_names
    })  # fmt: skip
    tracks = {b.name: b for b in run.animate(scene).animation.tracks.bodies}
    within = np.linalg.norm(tracks["wheel1"].omega - tracks["hub"].omega, axis=1)
    assert within[-1] == pytest.approx(run["Omega_wheel1"][-1], rel=0.01)
    mount, turning = (tracks[n].quaternions for n in ("mount1", "wheel1"))
    dots = np.sum(mount * turning, axis=1)
    assert dots.min() < -0.9  # more than half a turn on its mount
    assert dots.max() > 0.9


def test_the_lengths_of_an_animation_are_those_of_the_run():
    scene = load_scene("double-pendulum")
    numbers = {**scene.parameter_values(), "l1": 3.0}
    run = simulate(scene.derive(), scene.initial_values(), (0, 1), numbers)
    lower = run.animate(scene).animation.tracks.bodies[1]
    assert np.linalg.norm(lower.positions, axis=1) == pytest.approx(3.0)


def test_a_law_whose_states_do_not_say_where_bodies_are_is_refused():
    scene = eom.Scene(
        body={"moments": [2, 3, 4]}, torque={"components": ["u", 0, 0]}, inputs={"u": 0},
        outputs=["omega_1", "omega_2", "omega_3"], initial={"omega_1": 0, "omega_2": 1, "omega_3": 0},
    )  # fmt: skip
    numbers = scene.initial_values(), (0, 1), scene.parameter_values()
    run = simulate(scene.derive(), *numbers, inputs={"u": np.sin})
    with pytest.raises(InputError, match="where bodies are"):
        run.animate(scene)


# --- what notebooks display ------------------------------------------------------------------------


def parsed(html):
    """The elements of a piece of HTML that is XML as well."""
    return ElementTree.fromstring(f"<div>{html}</div>")


def test_everything_that_users_hold_has_a_short_text_and_a_page(run, top):
    compiled = codegen.compile(OSCILLATOR, "numpy")
    linear = codegen.linearise(compiled, [1, 0])
    many = codegen.ensemble(
        compiled, {"y": np.linspace(0, 1, 3), "v": 0.0}, (0, 1), t_eval=[0.5, 1]
    )
    scene = load_scene("satellite-with-panels")
    report = codegen.accuracy(compiled, samples=20)
    for made in (OSCILLATOR, compiled, run, top, linear, many, scene, scene.derive(), report):
        assert len(repr(made)) < 500
        assert len(made._repr_html_()) < 60_000
        assert len(made._repr_html_()) > 200
    assert "<td>y&#x27;</td>" in report._repr_html_()
    for made in (run, top, linear, many, report):
        parsed(made._repr_html_())
    assert run._repr_html_().count("<svg") == 3
    assert r"\frac{\mathrm{d}}{\mathrm{d}t} y &= v" in OSCILLATOR._repr_latex_()
    assert "<math" in OSCILLATOR._repr_html_()
    assert len(repr(run.accuracy())) < 200


def test_a_notice_is_in_the_text_and_on_the_page():
    rest = simulate(OSCILLATOR, [0, 0], (0, 1), method="DOP853")
    assert "notice: no scale is known for y, v" in repr(rest)
    assert "no scale is known for y, v" in rest._repr_html_()


def test_texts_of_users_are_quoted():
    odd = sp.Symbol("<b>&", real=True)
    made = simulate(
        System.from_rates("<i>", {odd: sp.Integer(1)}), [0.0], (0, 1), method="scipy:RK45"
    )
    assert "<b>" not in made._repr_html_()
    assert "&lt;b&gt;&amp;" in made._repr_html_()


@pytest.mark.parametrize(
    "y",
    [
        np.sin(np.linspace(0, 9, 5000)),
        np.zeros(3),
        np.array([1.0, np.nan, 3.0, 4.0]),
        np.array([1e300, -1e300]),
        np.linspace(5, 5 + 1e-15, 10),
    ],
)
def test_a_line_over_time_stays_in_its_frame(y):
    svg = notebook.sparkline(np.arange(len(y), dtype=float), y)
    numbers = [float(v) for v in re.findall(r"-?\d+\.\d", parsed(svg)[0][0].get("d"))]
    assert all(0 <= v <= notebook.WIDE for v in numbers[::2])
    assert all(0 <= v <= notebook.HIGH for v in numbers[1::2])
    assert len(svg) < 5000


def test_a_line_over_no_time_is_none():
    assert notebook.sparkline(np.array([1.0]), np.array([2.0])) == ""
    assert notebook.sparkline(np.array([1.0, 2.0]), np.array([np.nan, 2.0])) == ""


def test_a_system_does_wherever_a_compiled_one_does():
    point = eom.equilibrium(OSCILLATOR)
    (only,) = eom.equilibria(OSCILLATOR)
    assert only.states == point.states
    near = eom.linearise_about(OSCILLATOR, point)
    assert near.A.tolist() == eom.linearise(OSCILLATOR, [0, 0]).A.tolist()
    assert eom.compiled_jacobian(OSCILLATOR).dense(0, [0, 0], []).tolist() == near.A.tolist()
    assert isinstance(eom.accuracy(OSCILLATOR, samples=3), eom.AccuracyReport)
    with pytest.raises(InputError, match="compiled is of the wrong type"):
        eom.linearise("oscillator", [0, 0])


def test_one_import_is_enough(tmp_path):
    assert eom.simulate is codegen.simulate
    assert eom.Result is Result
    files = eom.generate(OSCILLATOR, tmp_path, target="python", jacobian=["states"])
    assert {p.name for p in tmp_path.iterdir()} == set(files)
    with pytest.raises(InputError, match="write_fmu"):
        eom.generate(OSCILLATOR, tmp_path, "fmu")
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        _ = eom.simulat
