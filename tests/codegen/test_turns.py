"""Angles of a quaternion along runs: beside runs in angles, through singular ones, over many turns."""

import math
import re
import subprocess
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.compiling.compiled import generate
from codegen.native import native
from codegen.runs import turns
from eom.errors import InputError
from eom.kinematics.coordinates import SEQUENCES, quaternion_of_sequence, rotation_sequence
from eom.kinematics.frames import vector
from eom.rotations import matrix_of_quaternion
from eom.scenes.scene import Scene
from tests import node

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")
needs_node = pytest.mark.skipif(node.NODE is None, reason="needs Node.js")
PSI, THETA, PHI = sp.symbols("psi theta phi", real=True)
NAMES = ("psi", "theta", "phi")


def scene_of(sequence="3-2-1", start=(0.1, 0.2, 0.3), omega=(0.3, 0.1, -0.2), **more):
    data = {
        "body": {"moments": (1.0, 2.0, 2.5)},
        "attitude": sequence,
        "initial": dict(zip(("omega_1", "omega_2", "omega_3"), omega, strict=True)),
        "initial_attitude": {"sequence": sequence, "radians": start},
        "outputs": NAMES,
    }
    return Scene(**{**data, **more})


def run_of(scene, t, method="auto", target="python", **options):
    """All of a scene, by plain Python where nothing else is said: nothing is compiled for long."""
    made = codegen.compile(scene.derive(), target)
    known = scene.initial_values(), (float(t[0]), float(t[-1])), scene.parameter_values()
    options.setdefault("inputs", scene.input_values())
    return codegen.simulate(made, *known, method, 1e-12, t_eval=t, **options)


def rebuilt(sequence, run):
    """How far C of the angles is from C of the quaternion, at all samples."""
    rotation = rotation_sequence(sequence)
    C = sp.lambdify(rotation.angles, rotation.matrix, "numpy")
    rows = zip(run.y.T, *(run[n] for n in NAMES), strict=True)
    places = [run.names.index(f"q{k}") for k in range(4)]
    found = [np.array(C(*angles)) - matrix_of_quaternion(y[places] / np.linalg.norm(y[places]))
             for y, *angles in rows]  # fmt: skip
    return np.abs(np.array(found).astype(float)).max()


@pytest.mark.sparse(3)
@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angles_are_those_of_a_run_in_angles(sequence):
    start = (0.1, 1.2, 0.3) if sequence[0] == sequence[-1] else (0.1, 0.2, 0.3)
    t = np.linspace(0, 1.5, 7)
    own = run_of(scene_of(sequence, start), t, "DOP853")
    over = run_of(scene_of(sequence, start, integrate="quaternion"), t, "DOP853")
    for name in NAMES:
        np.testing.assert_allclose(over[name], own[name], rtol=0, atol=1e-10)
    assert rebuilt(sequence, over) < 1e-14
    assert over.notice == ""


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_a_steady_turn_through_the_singular_angles_is_continuous_where_it_can_be(sequence):
    """About the second axis, a little beside: the outer angles jump by half a turn."""
    axis = int(sequence[2])
    omega = [1e-3 * (k + 1) for k in range(3)]
    omega[axis - 1] = 1.0
    start = (0.3, 0.7, 0.0)
    scene = scene_of(sequence, start, omega, integrate="quaternion", body={"moments": (1, 1, 1)})
    run = run_of(scene, np.linspace(0, 30, 400), "DOP853")
    assert run.status == 0
    assert rebuilt(sequence, run) < 1e-13
    proper = sequence[0] == sequence[-1]
    assert np.ptp(run["theta"]) == pytest.approx(math.pi, abs=0.1)
    i, j, _ = map(int, sequence.split("-"))
    sine = np.sin(run["theta"]) * (1 if (j - i) % 3 == 1 else -1)
    side = np.cos(run["theta"]) if proper else sine
    total = run["psi"] + np.sign(side) * run["phi"]
    same = np.sign(side[1:]) == np.sign(side[:-1])
    assert np.abs(np.diff(total)[same]).max() < 30 / 400 * math.sqrt(2) * 1.1


@cache
def spun(count, method="DOP853", rate=20.0, **options):
    """About b3, whose angle psi of the sequence 3-2-1 grows without end."""
    scene = scene_of(omega=(0.0, 0.0, rate), start=(0.5, 0.0, 0.0), integrate="quaternion",
                     body={"moments": (1, 2, 3)}, torque={"components": ("k*omega_1", 0, 0)},
                     parameters={"k": 0.0}, outputs=(*NAMES, "omega_1"))  # fmt: skip
    run = run_of(scene, np.linspace(0, 10, count), method, **options)
    return run.t, run["psi"], run.notice


@pytest.mark.sparse(5)
@pytest.mark.parametrize("dense", [False, True])
@pytest.mark.parametrize("count", [2, 30, 52, 101, 1001])
def test_turns_are_counted_however_few_times_are_stored(count, dense):
    t, psi, notice = spun(count, dense_output=dense)
    np.testing.assert_allclose(psi, 0.5 + 20 * t, rtol=0, atol=1e-8)
    assert notice == ""


@pytest.mark.parametrize("method", ["rkmk", "taylor", "auto", "scipy:LSODA"])
def test_every_method_counts_turns(method):
    t, psi, notice = spun(2, method)
    np.testing.assert_allclose(psi, 0.5 + 20 * t, rtol=0, atol=1e-8)
    assert notice == ""


def test_turns_that_nobody_knows_are_reported_and_the_attitude_is_right(monkeypatch):
    """Without dense output nothing is known between stored times."""
    known = turns.counted

    def blind(run, outputs):
        return known(replace(run, trajectory=replace(run.trajectory, solution=None)), outputs)

    monkeypatch.setattr("codegen.runs.result.counted", blind)
    t, psi, notice = spun.__wrapped__(30)
    assert "whole turns of psi and phi are not known" in notice
    np.testing.assert_allclose(np.cos(psi), np.cos(0.5 + 20 * t), rtol=0, atol=1e-8)


@pytest.mark.parametrize("dense", [False, True])
@pytest.mark.parametrize("count", [6, 501])
def test_turns_between_two_rests_are_counted(count, dense):
    """Each second the body is spun up and stopped again, so that it rests at all times of six."""
    scene = scene_of(
        omega=(0.0, 0.0, 0.0), start=(0.0, 0.0, 0.0), integrate="quaternion",
        body={"moments": (1, 1.1, 1.2)}, torque={"components": (0, 0, "M")},
        inputs={"M": {"value": 0.0}},
    )  # fmt: skip

    def pulses(t):
        return 100.0 * (int(0.2 <= t % 1 < 0.5) - int(0.5 <= t % 1 < 0.8))

    pushed = codegen.Signal(pulses, knots=[k + x for k in range(5) for x in (0.2, 0.5, 0.8)])
    t = np.linspace(0, 5, count)
    run = run_of(scene, t, "DOP853", inputs={"M": pushed}, dense_output=dense)
    assert run["psi"][-1] == pytest.approx(5 * 100 / 1.2 * 0.3**2, abs=1e-6)
    assert bool(run.sol) == dense


def test_turns_are_counted_backwards():
    scene = scene_of(omega=(0.0, 0.0, 5.0), start=(0.5, 0.0, 0.0), integrate="quaternion")
    run = run_of(scene, np.linspace(0, -10, 41), "DOP853")
    np.testing.assert_allclose(run["psi"], 0.5 + 5 * run.t, rtol=0, atol=1e-8)


def test_one_angle_alone_is_the_same():
    t = np.linspace(0, 4, 60)
    all_three = run_of(scene_of(omega=(3, 1, 2), integrate="quaternion"), t, "DOP853")
    for name in NAMES:
        alone = run_of(
            scene_of(omega=(3, 1, 2), integrate="quaternion", outputs=(name,)), t, "DOP853"
        )
        assert tuple(alone.outputs) == (name,)
        np.testing.assert_allclose(alone[name], all_three[name], rtol=0, atol=1e-9)


def test_a_close_passage_is_followed_between_samples():
    """Half a turn of psi within 1e-5 of the time between two samples, to the side where it happens."""
    for side in (1e-6, -1e-6):
        scene = scene_of(omega=(0, 1.0, 0), start=(0.0, 1.0, side), integrate="quaternion",
                         body={"moments": (1, 1, 1)})  # fmt: skip
        run = run_of(scene, np.linspace(0, 1, 6), "DOP853")
        turned = run["psi"][-1] - run["psi"][0]
        fine = run_of(scene, np.linspace(0, 1, 200), "DOP853", dense_output=True)
        assert turned == pytest.approx(fine["psi"][-1] - fine["psi"][0], abs=1e-6)
        assert abs(abs(turned) - math.pi) < 1e-4
        assert rebuilt("3-2-1", run) < 1e-14


def test_on_the_singular_angle_itself_numbers_are_finite_and_their_difference_is_right():
    scene = scene_of(omega=(0, 0, 0), start=(0.7, math.pi / 2, 0.2), integrate="quaternion")
    run = run_of(scene, [0.0, 1.0], "DOP853")
    assert np.isfinite([run[n] for n in NAMES]).all()
    np.testing.assert_allclose(run["psi"] - run["phi"], 0.5, rtol=0, atol=1e-15)
    assert rebuilt("3-2-1", run) < 1e-15


@needs_compiler
def test_every_kind_of_run_shows_the_same_angles():
    """Inputs that are functions, projection, a late start, methods by groups, closed forms."""
    t = np.linspace(0, 2, 21)
    free = scene_of(omega=(2, 3, 1), integrate="quaternion")
    expected = run_of(free, t, "DOP853", "c")
    for method, options in {"taylor": {}, "auto": {}, "rkmk": {}, "splitting": {},
                            "DOP853": {"project": True}}.items():  # fmt: skip
        found = run_of(free, t, method, "c", **options)
        for name in NAMES:
            np.testing.assert_allclose(
                found[name], expected[name], rtol=0, atol=1e-8, err_msg=method
            )
    torque = {"components": ("M", 0, "-0.1*omega_3")}
    pushed = scene_of(omega=(2, 3, 1), integrate="quaternion", torque=torque,
                      inputs={"M": {"value": 0.5}})  # fmt: skip
    held = run_of(pushed, t, "DOP853", "c")
    called = run_of(pushed, t, "DOP853", "c", inputs={"M": lambda t: 0.5})
    assert np.abs(called["psi"] - held["psi"]).max() < 1e-9
    late = run_of(pushed, t + 1.7e9, "DOP853", "c")
    assert np.abs(late["psi"] - held["psi"]).max() < 2e-5  # times are rounded to 2.4e-7 s


@needs_compiler
def test_events_are_found_on_angles():
    scene = scene_of(omega=(0, 0, 2.0), start=(0.5, 0.1, 0.0), integrate="quaternion")
    t = np.linspace(0, 8, 81)
    events = {"psi": sp.sin(PSI - 1), "theta": THETA - sp.Rational(1, 20)}
    run = run_of(scene, t, "taylor", "c", events=events)
    for name, event in events.items():
        dense = run_of(scene, np.linspace(0, 8, 4001), "taylor", "c")
        values = sp.lambdify(sp.Symbol(name, real=True), event)(dense[name])
        places = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))
        assert len(places) == len(run.events[name])
        np.testing.assert_allclose(run.events[name].t, dense.t[places] + 1e-3, rtol=0, atol=1.1e-3)
    with pytest.raises(InputError, match="branch"):
        run_of(scene, t, "taylor", "c", events=[PSI - 1])


MAIN = """
#include "scene.h"
#include <stdio.h>
int main(void) {
    double t, x[7], p[@P@], y[3], last[3] = {0, 0, 0};
    scene_constants c;
    for (int k = 0; k < @P@; ++k) if (scanf("%lf", p + k) != 1) return 1;
    scene_prepare(p, &c);
    while (scanf("%lf", &t) == 1) {
        for (int k = 0; k < 7; ++k) if (scanf("%lf", x + k) != 1) return 1;
        scene_outputs(t, x, &c, NULL, y);
        for (int k = 0; k < 3; ++k) last[k] = k == 1 ? y[k] : scene_nearest_angle(y[k], last[k]);
        printf("%.17g %.17g %.17g\\n", last[0], last[1], last[2]);
    }
    return 0;
}
"""


def samples():
    """A run in which angles turn many times, its states at times, and its parameters in order."""
    scene = scene_of("3-1-3", (0.1, 1.0, 0.3), omega=(4, 1, 6), integrate="quaternion")
    run = run_of(scene, np.linspace(0, 10, 400), "DOP853", "numpy")
    assert np.ptp(run["phi"]) > 20
    values = scene.parameter_values()
    system = scene.derive()
    return system, run, [values[n] for n in system.parameter_names]


@needs_compiler
def test_generated_c_shows_the_same_angles(tmp_path):
    system, run, p = samples()
    made = codegen.compile(system, "c")
    for name, text in generate(made.program, made.layout, "c").items():
        (tmp_path / name).write_text(text)
    (tmp_path / "main.c").write_text(MAIN.replace("@P@", str(len(p))))
    flags = ["-std=c99", "-O1", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror"]
    sources = [str(tmp_path / "scene.c"), str(tmp_path / "main.c")]
    program = str(tmp_path / "main")
    subprocess.run([*native.compiler(), *flags, *sources, "-o", program, "-lm"], check=True)
    rows = [" ".join(f"{v!r}" for v in p)]
    rows += [
        " ".join(f"{float(v)!r}" for v in (t, *x)) for t, x in zip(run.t, run.y.T, strict=True)
    ]
    done = subprocess.run(
        [program], input="\n".join(rows), capture_output=True, text=True, check=True
    )
    found = np.array([list(map(float, line.split())) for line in done.stdout.splitlines()])
    np.testing.assert_allclose(found.T, [run[n] for n in NAMES], rtol=0, atol=1e-12)


@needs_node
def test_generated_javascript_shows_the_same_angles():
    system, run, p = samples()
    made = codegen.compile(system, "numpy")
    (text,) = generate(made.program, made.layout, "javascript").values()
    assert "export function nearestAngle(angle, previous)" in text
    text += """
let last = [0, 0, 0];
export function shown(t, x, p, u) {
  const y = outputs(t, x, p, u, [0, 0, 0]);
  last = [nearestAngle(y[0], last[0]), y[1], nearestAngle(y[2], last[2])];
  return last;
}
"""
    at = [(t, x, p, []) for t, x in zip(run.t, run.y.T, strict=True)]
    (found,) = node.run([node.Job(text, "shown", at, 3)])
    np.testing.assert_allclose(found.T, [run[n] for n in NAMES], rtol=0, atol=1e-12)


def test_what_has_no_such_angles_gets_no_function():
    for scene in (scene_of(), scene_of(integrate="quaternion", outputs=("theta",))):
        made = codegen.compile(scene.derive(), "python")
        for target in ("c", "javascript"):
            texts = "".join(generate(made.program, made.layout, target).values())
            assert not re.search("nearest_?angle", texts, re.IGNORECASE)


def test_a_run_that_stops_at_a_singular_angle_says_what_happened_and_the_way_out():
    run = run_of(scene_of(omega=(0, 1.0, 0), start=(0, 1.0, 0)), np.linspace(0, 1, 5), "DOP853")
    assert run.status == 1
    assert run.message.startswith("stopped at t = 0.57079")
    assert "theta = 1.57079" in run.message
    assert "cos(theta) = 0" in run.message
    assert 'integrate = "quaternion"' in run.message


def test_a_spinner_that_stops_names_its_way_out():
    start = {"theta": 1.0, "psi": 0.0, "theta_dot": 1.0, "psi_dot": 0.0, "C": 0.0}
    body = {"moments": (1.0, 1.5)}
    scene = Scene(model="spinner", body=body, outputs=("theta", "psi"), initial=start)
    run = run_of(scene, np.linspace(0, 1, 5), "DOP853")
    assert run.status == 1
    assert 'model = "rigid body" with attitude = "3-1-2"' in run.message


def test_the_rule_of_the_sum_is_the_rate_of_the_angles():
    """d(psi + c phi)/dt = omega.(a + c b)/(1 + |a.b|), on random attitudes of all sequences."""
    generator, w = np.random.default_rng(3), (0.3, -0.7, 0.5)
    for sequence in SEQUENCES:
        rotation = rotation_sequence(sequence)
        rates = sp.lambdify(rotation.angles, rotation.rates(vector("B", w)), "math")
        for _ in range(5):
            angles = generator.uniform(0.2, 1.2, size=3)
            psi, _, phi = rates(*angles)
            C = np.array(matrix_of_quaternion(quaternion_of_sequence(sequence, angles)))
            i, _, k = (n - 1 for n in rotation.axes)
            a, b = C[:, i], np.eye(3)[k]
            c = math.copysign(1.0, a @ b)
            assert psi + c * phi == pytest.approx(np.array(w) @ (a + c * b) / (1 + abs(a @ b)))
    assert turns.SMALL * math.sqrt(2) < math.pi
