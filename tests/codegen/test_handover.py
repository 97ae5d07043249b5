"""Hand-over near singular angles: the same motion as in quaternions, angles that are continuous."""

import itertools
import math
import subprocess

import numpy as np
import pytest
import sympy as sp

import eom
from codegen import compile as compile_system
from codegen import handover, handover_c, native, simulate
from codegen.charts import compile_charts
from codegen.compiled import write_files
from eom.errors import InputError
from eom.handover import charts, numbers
from eom.kinematics import SEQUENCES, quaternion, quaternion_of_sequence, rotation_sequence

MATRIX_OF_Q = sp.lambdify(quaternion().symbols, quaternion().matrix)
TARGET = "c" if native.compiler() else "numpy"
TORQUE = {"components": ["k*sin(t)", 0, "-k*omega_1"]}


def matrices(sequence, result):
    angles = rotation_sequence(sequence)
    matrix = sp.lambdify(angles.angles, angles.matrix)
    return [matrix(*v) for v in zip(*(result[n] for n in ("psi", "theta", "phi")), strict=True)]


def tumbling(sequence, start=(0.4, 0.9, -0.3), omega=(1.0, -1.3, 0.8), **more):
    return eom.Scene(
        body={"moments": [1.0, 2.0, 2.5]},
        attitude=sequence,
        initial=dict(zip(("omega_1", "omega_2", "omega_3"), omega, strict=True)),
        initial_attitude={"sequence": sequence, "radians": list(start)},
        outputs=["T", "H_3"],
        **more,
    )


def run(made, scene, span, **options):
    start = {
        **scene.initial,
        **dict(zip(("psi", "theta", "phi"), scene.initial_attitude.radians, strict=True)),
    }
    start = {n: start[n] for n in made.first.layout.results["rates"]}
    values = {n: v.value for n, v in scene.parameters.items()} | dict(
        zip(("I1", "I2", "I3"), scene.body.moments, strict=False)
    )
    return handover.simulate(made, start, span, values, **{"method": "DOP853", **options})


@pytest.fixture(scope="module")
def made():
    known = {}

    def get(scene, target=TARGET):
        key = (scene.model, scene.attitude, scene.torque.model_dump_json(), scene.body.moments)
        if key not in known:
            known[key] = compile_charts(charts(scene), target)
        return known[key]

    return get


# --- the transfers --------------------------------------------------------------------------------


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_there_and_back_is_the_same_to_rounding(sequence):
    """Near and far from the singular angle; on both branches; the third angle fits the first."""
    made = compile_charts(charts(tumbling(sequence)), "python")
    symmetric = sequence[0] == sequence[-1]
    for near, branch in itertools.product((1.0, 0.1, 1e-3, 1e-6), (1.0, -1.0)):
        base = math.asin(near) if symmetric else math.acos(near)
        theta = base if branch > 0 else (-base if symmetric else math.pi - base)
        x = np.array([0.3, -0.4, 0.5, 1.1, theta, -2.0])
        q = made.forth.outputs(0.0, x, [1.0, 2.0, 2.5])
        expected = quaternion_of_sequence(sequence, x[3:])
        np.testing.assert_allclose(q, [*x[:3], *expected], rtol=0, atol=4e-16)
        back = made.back.outputs(0.0, q, [1.0, 2.0, 2.5, branch, 1.1])
        off = np.array([math.remainder(v, 2 * math.pi) for v in back[:6] - x])
        assert np.all(np.abs(off) <= 1e-15 / near)
        assert back[7] == pytest.approx(near, rel=1e-15 / near)
        assert abs(math.remainder(back[6] - x[5], 2 * math.pi)) <= 2e-15


# --- whole runs -----------------------------------------------------------------------------------


@pytest.mark.parametrize("sequence", ["3-2-1", "2-3-2"])
def test_a_tumbling_body_is_that_of_the_quaternion(made, sequence):
    scene = tumbling(sequence, torque=TORQUE, parameters={"k": 0.7})
    compiled = made(scene)
    result = run(compiled, scene, (0, 12), rtol=1e-11, dense_output=True)
    assert result.status == 0
    assert "coordinates were changed" in result.notice
    assert np.all(np.diff(result.t) > 0)
    data = scene.model_dump(exclude_unset=True) | {"attitude": "quaternion", "outputs": ()}
    other = eom.Scene(**data)
    reference = simulate(
        compile_system(other.derive(), TARGET), other.initial_values(), (0, 12),
        other.parameter_values(), rtol=1e-12, t_eval=result.t,
    )  # fmt: skip
    q = [MATRIX_OF_Q(*(reference[f"q{k}"][j] for k in range(4))) for j in range(len(result.t))]
    np.testing.assert_allclose(matrices(sequence, result), q, rtol=0, atol=1e-8)
    fine = result.sol(np.linspace(0, 12, 4001))
    assert np.abs(np.diff(fine, axis=1)).max() < 2.5
    np.testing.assert_allclose(result.sol(result.t), result.y, rtol=0, atol=1e-8)


@pytest.mark.parametrize("miss", [0.03, 1e-3, 1e-5])
@pytest.mark.parametrize("sense", [1, -1])
def test_a_near_miss_turns_the_angles_as_angles_alone_do(made, miss, sense):
    """Angles can pass a singularity at a distance, in small steps: whole turns are the same."""
    scene = tumbling("3-1-2", start=(0.2, 0.0, sense * miss), omega=(1.0, 0.0, 0.0))
    compiled = made(scene)
    there = run(compiled, scene, (0, sense * 8), rtol=1e-12)
    names = compiled.first.layout.results["rates"]
    start = [
        0.2 if n == "psi" else sense * miss if n == "phi" else 1.0 if n == "omega_1" else 0.0
        for n in names
    ]
    alone = simulate(
        compiled.first, start, (0, sense * 8), [1.0, 2.0, 2.5], "DOP853", 1e-12, margin=1e-9
    )
    assert alone.status == 0
    assert min(there.margin.values()) == pytest.approx(math.sin(miss), rel=0.2)
    np.testing.assert_allclose(there.y[:, -1], alone.y[:, -1], rtol=0, atol=1e-9 / miss**1.5)
    assert abs(there["psi"][-1] - 0.2) > 3.0


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("start", [0.0, math.pi / 2])
def test_straight_through_the_singularity_the_second_angle_goes_on(made, sense, start):
    """theta = t, psi and phi at rest; the singular instant is among the times; from it, too."""
    scene = tumbling("3-1-2", start=(0.3, start, 0.0), omega=(sense * 1.0, 0.0, 0.0))
    grid = sense * np.array([0.0, 1.0, math.pi / 2, 2.0, math.pi, 3 * math.pi / 2, 6.0])
    result = run(made(scene), scene, (0, sense * 6), t_eval=grid)
    assert result.t.tolist() == grid.tolist()
    np.testing.assert_allclose(result["theta"], start + np.abs(grid), rtol=0, atol=1e-7)
    np.testing.assert_allclose(result["psi"], 0.3, rtol=0, atol=1e-6)
    np.testing.assert_allclose(result["phi"], 0.0, rtol=0, atol=1e-6)


def test_constants_and_outputs_stay_across_hand_overs(made):
    scene = tumbling("3-1-2", start=(0.2, 0.0, 1e-4), omega=(1.0, 0.0, 0.0))
    result = run(made(scene), scene, (0, 30), rtol=1e-11)
    assert {"T", "H", "H_1", "H_2", "H_3"} == set(result.drift)
    assert all(d.largest < 1e-9 for d in result.drift.values())
    assert len(result["T"]) == len(result.t)
    assert result.notice.count(",") > 4


@pytest.mark.parametrize("method", ["DOP853", "scipy:LSODA"])
def test_any_method_takes_part_and_progress_is_told(made, method):
    scene = tumbling("3-1-2", start=(0.2, 0.0, 0.02), omega=(1.0, 0.0, 0.0))
    told = []
    result = run(made(scene), scene, (0, 5), method=method, rtol=1e-9, progress=told.append)
    exact = run(made(scene), scene, (0, 5), rtol=1e-12)
    np.testing.assert_allclose(result.y[:, -1], exact.y[:, -1], rtol=0, atol=1e-5)
    assert method.split(":")[-1] in result.method
    assert told == sorted(told)
    assert told[-1] == 1.0
    short = run(made(scene), scene, (0, 5), method=method, max_steps=30)
    assert short.status == -1
    assert short.steps <= 30


# --- the spinner ----------------------------------------------------------------------------------


def spinner(components, parameters=None, outputs=("theta", "T")):
    return eom.Scene(
        model="spinner",
        body={"moments": [1.0, 1.6]},
        torque={"components": components},
        parameters=parameters or {},
        outputs=list(outputs),
    )


def spin(compiled, values, span, **options):
    start = {"theta": 0.1, "psi": 0.5, "phi": -0.4, "theta_dot": 1.0, "psi_dot": 0.02, "C": 0.05}
    start |= options.pop("start", {})
    names = compiled.first.layout.results["rates"]
    values = {"I1": 1.0, "I2": 1.6, **values, **start}
    known = {n: values[n] for n in (q.name for q in compiled.first.layout.parameters)}
    options = {"method": "DOP853", **options}
    result = handover.simulate(compiled, {n: start[n] for n in names}, span, known, **options)
    return result, known, start


@pytest.mark.parametrize(
    ("components", "values"),
    [((0, "k*cos(t)", 0), {"k": 0.1}), (("-k", 0, 0), {"k": 0.1}), ((0, 0, 0), {})],
)
def test_the_rates_of_the_spinner_are_taken_over(made, components, values):
    """Beside the angles alone, which pass at a distance of some hundredths."""
    made = made(spinner(components, values))
    result, known, start = spin(made, values, (0, 3), rtol=1e-12)
    names = made.first.layout.results["rates"]
    alone = simulate(
        made.first, {n: start[n] for n in names}, (0, 3), known, "DOP853", 1e-12, margin=1e-8
    )
    assert "changed 2 times" in result.notice
    assert min(result.margin.values()) < 0.1
    np.testing.assert_allclose(result.y[:, -1], alone.y[:, -1], rtol=0, atol=1e-7)
    assert all(d.relative < 1e-9 for d in result.drift.values())


def test_a_torque_without_direction_stops_the_spinner(made):
    """At theta = 90 degrees exactly nothing tells where b1 points; without torque it passes."""
    straight = {"psi_dot": 0.0, "C": 0.0}
    pushed = made(spinner(("-k", 0, 0), {"k": 0.1}))
    result, _, _ = spin(pushed, {"k": 0.1}, (0, 3), start=straight)
    assert result.status == 1
    assert "no direction" in result.message
    assert result["theta"][-1] == pytest.approx(math.pi / 2, abs=1e-5)
    free = made(spinner((0, 0, 0)))
    result, _, _ = spin(free, {}, (0, 3), start=straight, rtol=1e-11)
    assert result.status == 0
    assert result["theta"][-1] == pytest.approx(3.1, abs=1e-7)
    assert result["psi"][-1] == pytest.approx(0.5, abs=1e-6)
    assert result["theta_dot"][-1] == pytest.approx(1.0, abs=1e-9)


def test_coordinates_without_singular_angles_are_refused():
    with pytest.raises(InputError, match="Euler angles"):
        charts(eom.Scene.ready("heavy-top"))


# --- in C -----------------------------------------------------------------------------------------

MAIN = """
#include "scene_handover.h"
#include <stdio.h>
#include <string.h>
int main(void) {
    static scene_handover s;
    static double t[4000], x[4000 * @N@];
    const double p[] = {@P@}, start[] = {@X@}, grid[] = {@GRID@};
    scene_handover_output o = {t, x, NULL, 4000, 0, 0, 0};
    if (!@STEPS@) o.grid = grid, o.grid_count = sizeof grid / sizeof *grid;
    s.t = 0.0, s.t_end = @END@, s.rtol = 1e-11, s.atol = 1e-14, s.margin = 1e-6;
    memcpy(s.x, start, sizeof start);
    int status = scene_handover_start(&s, p, NULL);
    do status = scene_handover_run(&s, NULL, &o, 7);
    while (status == SCENE_HANDOVER_PAUSED);
    printf("%d %lld %.17g\\n", status, s.changes, s.closest);
    for (size_t k = 0; k < o.count; ++k) {
        printf("%.17g", t[k]);
        for (int i = 0; i < @N@; ++i) printf(" %.17g", x[k * @N@ + (size_t)i]);
        printf("\\n");
    }
    return 0;
}
"""


def in_c(compiled, folder, start, parameters, end, grid):
    """Compile the generated files with every warning an error, and run them."""
    values = {"N": len(start), "P": parameters, "X": start, "GRID": grid or [0.0], "END": [end]}
    text = MAIN.replace("@STEPS@", str(int(grid is None)))
    for key, given in values.items():
        listed = str(given) if key == "N" else ", ".join(repr(float(v)) for v in given)
        text = text.replace(f"@{key}@", listed)
    written = write_files({**handover_c.files(compiled), "main.c": text}, folder)
    sources = [str(f) for f in written if f.suffix == ".c"]
    flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    subprocess.run(
        [*native.compiler(), *flags, *sources, "-o", str(folder / "run"), "-lm"], check=True
    )
    printed = subprocess.run(
        [str(folder / "run")], check=True, capture_output=True, text=True, timeout=60
    )
    head, *rows = printed.stdout.splitlines()
    table = np.array([[float(v) for v in row.split()] for row in rows]).T
    status, changes, closest = head.split()
    return int(status), int(changes), float(closest), table[0], table[1:]


@pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")
@pytest.mark.parametrize(
    ("start", "omega", "end"),
    [((0.2, 0.0, 1e-3), (1.0, 0.0, 0.0), 9.0), ((0.2, 0.0, 1e-3), (1.0, 0.0, 0.0), -9.0),
     ((0.3, 0.0, 0.0), (1.0, 0.0, 0.0), 6.0), ((0.3, math.pi / 2, 0.0), (1.0, 0.2, 0.1), 6.0)],
)  # fmt: skip
def test_c_follows_the_same_angles(made, tmp_path, start, omega, end):
    scene = tumbling("3-1-2", start=start, omega=omega)
    compiled = made(scene)
    grid = np.linspace(0, end, 24).tolist()
    expected = run(compiled, scene, (0, end), rtol=1e-11, atol=1e-14, t_eval=grid)
    names = ("psi", "theta", "phi", "omega_1", "omega_2", "omega_3")
    given = dict(zip(names, (*start, *omega), strict=True))
    x = [given[n] for n in compiled.first.layout.results["rates"]]
    status, changes, closest, t, y = in_c(compiled, tmp_path, x, [1.0, 2.0, 2.5], end, grid)
    assert status == 0
    assert f"changed {changes} times" in expected.notice
    assert t.tolist() == grid
    assert closest <= 2 * min(expected.margin.values()) + 1e-6
    np.testing.assert_allclose(y, expected.y, rtol=0, atol=1e-5)


@pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")
def test_c_stores_every_step_in_order(made, tmp_path):
    scene = tumbling("3-1-2", start=(0.2, 0.0, 0.02), omega=(1.0, 0.0, 0.0))
    names = made(scene).first.layout.results["rates"]
    x = [{"psi": 0.2, "phi": 0.02, "omega_1": 1.0}.get(n, 0.0) for n in names]
    status, changes, _, t, y = in_c(made(scene), tmp_path, x, [1.0, 2.0, 2.5], 9.0, None)
    assert (status, changes) == (0, 6)
    assert np.all(np.diff(t) > 0)
    assert t[-1] == 9.0
    psi = y[list(names).index("psi")]
    assert np.abs(np.diff(psi)).max() < 1.0


@pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")
def test_c_files_are_the_same_each_time(made):
    compiled = made(tumbling("3-1-2"))
    assert handover_c.files(compiled) == handover_c.files(compiled)
    assert "scene_handover.h" in handover_c.files(compiled)


# --- scenes ---------------------------------------------------------------------------------------


def test_a_scene_asks_for_it_and_gives_the_numbers():
    data = tumbling("3-1-2", torque=TORQUE, parameters={"k": 0.7}).model_dump(exclude_unset=True)
    scene = eom.Scene(**data, integration={"handover": True})
    found = charts(scene)
    initial, parameters = numbers(scene, found)
    assert scene.integration.handover
    assert not eom.Scene(**data).integration.handover
    assert initial == {
        "omega_1": 1.0,
        "omega_2": -1.3,
        "omega_3": 0.8,
        "psi": 0.4,
        "theta": 0.9,
        "phi": -0.3,
    }
    assert parameters == {"I1": 1.0, "I2": 2.0, "I3": 2.5, "k": 0.7}
    result = handover.simulate(
        compile_charts(found, "numpy"), initial, (0, 0.5), parameters, "DOP853"
    )
    assert result.status == 0


WHEEL = {"theta": 0.1, "psi": 0.0, "phi": 0.3, "theta_dot": 0.0, "psi_dot": 0.0, "C": 6.0}


def test_the_spin_of_a_wheel_is_a_number_of_both_charts():
    """C is constant: a parameter in angles, and there no state; in the quaternion it is omega_2."""
    data = eom.Scene.ready("bicycle-wheel").model_dump(exclude_unset=True)
    wheel = eom.Scene(**{**data, "initial": WHEEL})
    initial, parameters = numbers(wheel, charts(wheel))
    assert initial == {n: v for n, v in WHEEL.items() if n != "C"}
    assert parameters == {"I1": 0.06, "I2": 0.12, "M1": 0.5, "C": 6.0}
