"""Hand-over near singular angles: the same motion as in quaternions, angles that are continuous."""

import gc
import itertools
import math
import subprocess
import weakref

import numpy as np
import pytest
import sympy as sp

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.compiling.compiled import write_files
from codegen.loops.written import Choice
from codegen.native import native
from codegen.precision.extended import Values
from codegen.precision.extended import integrate as integrate_exactly
from codegen.runs import handover, handover_c
from codegen.runs.charts import Between, compile_charts
from eom.errors import InputError
from eom.kinematics.coordinates import (
    SEQUENCES,
    quaternion,
    quaternion_of_sequence,
    rotation_sequence,
)
from eom.scenes.handover import charts, numbers

MATRIX_OF_Q = sp.lambdify(quaternion().symbols, quaternion().matrix)
TARGET = "python"
"""Of most runs: they are short, and nothing is compiled for them."""
IN_C = "c" if native.compiler() else "numpy"
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
        law = scene.torque.model_dump_json()
        key = (scene.model, scene.attitude, law, scene.body.moments, target)
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


@pytest.mark.parametrize(("sequence", "target"), [("3-2-1", IN_C), ("2-3-2", TARGET)])
def test_a_tumbling_body_is_that_of_the_quaternion(made, sequence, target):
    scene = tumbling(sequence, torque=TORQUE, parameters={"k": 0.7})
    compiled = made(scene, target)
    result = run(compiled, scene, (0, 12), rtol=1e-11, dense_output=True)
    assert result.status == 0
    assert "coordinates were changed" in result.notice
    assert np.all(np.diff(result.t) > 0)
    data = scene.model_dump(exclude_unset=True) | {"attitude": "quaternion", "outputs": ()}
    other = eom.Scene(**data)
    reference = simulate(
        compile_system(other.derive(), target), other.initial_values(), (0, 12),
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
#include <stdlib.h>
#define N (int)(sizeof s.x / sizeof *s.x)
static double number(void) {
    double x;
    if (scanf("%lf", &x) != 1) exit(9);
    return x;
}
int main(void) {
    static scene_handover s;
    static double t[4000], x[4000 * 16], grid[4000], p[16], u[16];
    scene_handover_output o = {t, x, NULL, 4000, 0, 0, 0};
    s.t = 0.0, s.t_end = number(), s.rtol = number(), s.atol = 1e-3 * s.rtol, s.margin = 1e-6;
    for (int i = 0; i < N; ++i) s.x[i] = number();
    for (int i = 0, count = (int)number(); i < count; ++i) p[i] = number();
    for (int i = 0, count = (int)number(); i < count; ++i) u[i] = number();
    o.grid_count = (size_t)number();
    for (size_t i = 0; i < o.grid_count; ++i) grid[i] = number();
    if (o.grid_count) o.grid = grid;
    int status = scene_handover_start(&s, p, u);
    do status = scene_handover_run(&s, u, &o, 7);
    while (status == SCENE_HANDOVER_PAUSED);
    printf("%d %lld %.17g\\n", status, s.changes, s.closest);
    for (size_t k = 0; k < o.count; ++k) {
        printf("%.17g", t[k]);
        for (int i = 0; i < N; ++i) printf(" %.17g", x[k * (size_t)N + (size_t)i]);
        printf("\\n");
    }
    return 0;
}
"""


def built_in(compiled, folder, integrator="dop853", rtol=1e-11):
    """Compile the generated files with every warning an error."""
    files = handover_c.files(compiled, Choice(integrator, rtol))
    written = write_files({**files, "main.c": MAIN}, folder)
    sources = [str(f) for f in written if f.suffix == ".c"]
    flags = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    subprocess.run(
        [*native.compiler(), *flags, *sources, "-o", str(folder / "run"), "-lm"], check=True
    )
    return folder / "run"


@pytest.fixture(scope="module", params=["dop853", "taylor"])
def free(made, tmp_path_factory, request):
    """The program of a free body in 3-1-2 angles."""
    return built_in(made(tumbling("3-1-2")), tmp_path_factory.mktemp("free"), request.param)


def in_c(program, start, parameters, inputs, end, grid, rtol=1e-11):
    """Run a program; every step is stored where the grid is empty."""
    given = [end, rtol, *start]
    for group in (parameters, inputs, grid):
        given += [len(group), *group]
    printed = subprocess.run(
        [str(program)], check=True, capture_output=True, text=True, timeout=60,
        input=" ".join(repr(v) for v in given),
    )  # fmt: skip
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
def test_c_follows_the_same_angles(made, free, start, omega, end):
    scene = tumbling("3-1-2", start=start, omega=omega)
    compiled = made(scene)
    grid = np.linspace(0, end, 24).tolist()
    expected = run(compiled, scene, (0, end), rtol=1e-11, atol=1e-14, t_eval=grid)
    names = ("psi", "theta", "phi", "omega_1", "omega_2", "omega_3")
    given = dict(zip(names, (*start, *omega), strict=True))
    x = [given[n] for n in compiled.first.layout.results["rates"]]
    status, changes, closest, t, y = in_c(free, x, [1.0, 2.0, 2.5], [], end, grid)
    assert status == 0
    assert f"changed {changes} times" in expected.notice
    assert t.tolist() == grid
    assert closest <= 2 * min(expected.margin.values()) + 1e-6
    np.testing.assert_allclose(y, expected.y, rtol=0, atol=1e-5)


@pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")
def test_c_stores_every_step_in_order(made, free):
    scene = tumbling("3-1-2", start=(0.2, 0.0, 0.02), omega=(1.0, 0.0, 0.0))
    names = made(scene).first.layout.results["rates"]
    x = [{"psi": 0.2, "phi": 0.02, "omega_1": 1.0}.get(n, 0.0) for n in names]
    status, changes, _, t, y = in_c(free, x, [1.0, 2.0, 2.5], [], 9.0, [])
    assert (status, changes) == (0, 6)
    assert np.all(np.diff(t) > 0)
    assert t[-1] == 9.0
    psi = y[list(names).index("psi")]
    assert np.abs(np.diff(psi)).max() < 1.0


@pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")
@pytest.mark.parametrize(
    ("sequence", "omega", "k"),
    [("3-1-2", (1.0, 0.02, 0.1), 0.1), ("3-1-3", (-1.0, 0.01, 0.02), 0.02)],
)
def test_taylor_in_c_is_right_to_rounding_through_singularities(made, tmp_path, sequence, omega, k):
    """Beside a solution in the quaternion with 30 digits."""
    scene = tumbling(sequence, (0.2, 0.9, 0.02), omega, torque=TORQUE, parameters={"k": k})
    compiled, end = made(scene), 40.0
    initial, known = numbers(scene, charts(scene))
    x, p = list(initial.values()), list(known.values())
    program = built_in(compiled, tmp_path, "taylor", 2.0**-52)
    status, changes, _, _, y = in_c(program, x, p, [], end, [end], 2.0**-52)
    assert status == 0
    assert changes >= 12
    forth = compiled.forth.layout
    q = compiled.forth.outputs(0.0, x, [known[n.name] for n in forth.parameters])
    own = [known.get(n.name, 1.0) for n in compiled.second.layout.parameters]
    second = compiled.second
    exact = integrate_exactly(
        second.program, second.layout, Values(q, own, ()), (0.0, end), 30, 500
    )
    names = [n.name for n in second.layout.states]
    of_q = [float(exact.end[names.index(f"q{k}")]) for k in range(4)]
    result = dict(zip((s.name for s in compiled.first.layout.states), y, strict=True))
    (matrix,) = matrices(sequence, result)
    np.testing.assert_allclose(matrix, MATRIX_OF_Q(*of_q), rtol=0, atol=5e-14)


@pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")
def test_near_the_singularity_angles_are_followed_within_the_steps(made, tmp_path):
    """Many pieces belong to one step of a series: the nearer the pass, the more of them."""
    compiled = made(tumbling("3-1-2"))
    program = built_in(compiled, tmp_path, "taylor")
    names = compiled.first.layout.results["rates"]
    stored = []
    for miss in (1e-2, 1e-5):
        x = [{"psi": 0.2, "phi": miss, "omega_1": 1.0}.get(n, 0.0) for n in names]
        status, changes, _, t, y = in_c(program, x, [1.0, 2.0, 2.5], [], 3.0, [])
        assert (status, changes) == (0, 2)
        assert np.all(np.diff(t) > 0)
        assert np.abs(np.diff(y[list(names).index("psi")])).max() < 1.0
        stored.append(len(t))
    assert stored[1] >= stored[0] + 10


def test_c_files_are_the_same_each_time(made):
    compiled = made(tumbling("3-1-2"))
    for choice in (None, Choice("taylor", 1e-12)):
        assert handover_c.files(compiled, choice) == handover_c.files(compiled, choice)
        assert "scene_handover.h" in handover_c.files(compiled, choice)
    by_default = handover_c.files(compiled)
    assert by_default == handover_c.files(compiled, Choice())
    assert "scene_dop853.c" in by_default


@pytest.mark.parametrize(
    ("name", "expected"), [("none", "needs an integrator"), ("euler", "unknown integrator")]
)
def test_c_files_need_an_integrator(made, name, expected):
    with pytest.raises(InputError, match=expected):
        handover_c.files(made(tumbling("3-1-2")), Choice(name))


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


# --- what `codegen.simulate` takes ----------------------------------------------------------------

LOOPS = {"start": (0.2, 0.0, 0.02), "omega": (1.0, 0.0, 0.0)}
"""A body that passes near the singular angle again and again."""


def counted(monkeypatch):
    """Count what each part stores: (chart is the second, points, points of dense output)."""
    found, before = [], handover.simulate_one

    def counting(compiled, *words, **options):
        result = before(compiled, *words, **options)
        dense = 0 if not result.sol else len(result.sol.ts)
        found.append((compiled.layout.name.endswith("quaternion"), len(result.t), dense))
        return result

    monkeypatch.setattr(handover, "simulate_one", counting)
    return found


def test_no_more_is_stored_than_asked_for(made, monkeypatch):
    """However many steps there are: `PIECE` of them at a time, near the singular angle alone."""
    scene = tumbling("3-1-2", **LOOPS)
    grid = np.linspace(0, 60, 7)
    whole = run(made(scene), scene, (0, 60), t_eval=grid, rtol=1e-11)
    monkeypatch.setattr(handover, "PIECE", 2)
    found = counted(monkeypatch)
    result = run(made(scene), scene, (0, 60), t_eval=grid, rtol=1e-11)
    assert result.steps > 500
    assert len(found) > len(result.changes) + 15
    assert sum(points for _, points, _ in found) == len(grid)
    assert max(dense for second, _, dense in found if second) == 3
    assert not any(dense for second, _, dense in found if not second)
    assert not result.sol
    assert len(result.changes) == len(whole.changes) > 30
    np.testing.assert_allclose(result.changes, whole.changes, rtol=0, atol=1e-7)
    np.testing.assert_allclose(result.y, whole.y, rtol=0, atol=1e-6)
    every = run(made(scene), scene, (0, 20), rtol=1e-11, dense_output=True)
    assert np.all(np.diff(every.t) > 0)
    np.testing.assert_allclose(every.sol(grid[:3]), whole.y[:, :3], rtol=0, atol=1e-6)


def test_a_motion_that_stays_near_the_singular_angle_is_not_kept(made, monkeypatch):
    """The dense output of a piece is gone when the next but one begins."""
    scene = tumbling("3-2-1", start=(0.3, math.pi / 2 - 0.09, 0.0), omega=(2.0, 0.0, 0.0))
    monkeypatch.setattr(handover, "PIECE", 20)
    found = counted(monkeypatch)
    kept, alive, before = [], [], handover.simulate_one

    def watching(*words, **options):
        if len(kept) % 8 == 7:
            gc.collect()
            alive.append(sum(there() is not None for there in kept))
        result = before(*words, **options)
        kept.append(weakref.ref(result.sol))
        return result

    monkeypatch.setattr(handover, "simulate_one", watching)
    result = run(made(scene), scene, (0, 10), t_eval=[0.0, 1.0, 2.0], max_step=0.02)
    assert (result.status, result.changes, result.t.tolist()) == (0, (), [0.0, 1.0, 2.0])
    assert len(found) == len(kept) >= 25
    assert max(dense for _, _, dense in found) == 21
    assert len(alive) >= 3
    assert max(alive) <= 2
    assert result.y_stop[list(result.names).index("phi")] == pytest.approx(20, abs=1e-6)


def test_steps_and_tolerances_are_taken_as_for_one_chart(made, monkeypatch):
    scene = tumbling("3-1-2", **LOOPS)
    names = made(scene).first.layout.results["rates"]
    exact = run(made(scene), scene, (0, 5), rtol=1e-13).y[:, -1]
    fine = [1e-12] * len(names)
    coarse = [1e-2 if n == "psi" else 1e-12 for n in names]
    ends = {}
    for name, atol in (("fine", fine), ("number", 1e-12), ("coarse", coarse)):
        result = run(made(scene), scene, (0, 5), rtol=1e-10, atol=atol, method="scipy:DOP853")
        ends[name] = (result.steps, np.abs(result.y[:, -1] - exact).max())
    assert ends["fine"] == ends["number"]
    assert ends["coarse"][0] < ends["fine"][0]
    assert ends["fine"][1] < 1e-7
    short = run(made(scene), scene, (0, 5), max_step=0.01)
    assert short.steps >= 500
    seen, before = [], handover.simulate_one

    def watching(*words, **options):
        seen.append(options["first_step"])
        return before(*words, **options)

    monkeypatch.setattr(handover, "simulate_one", watching)
    first = run(made(scene), scene, (0, 5), first_step=1e-3)
    assert seen == [1e-3] + [None] * (len(seen) - 1)
    assert len(seen) > 3
    assert first.steps > 0


def test_tolerances_go_over_to_the_other_chart(made):
    compiled = made(tumbling("3-1-2"))
    values = {
        "psi": 1e-3,
        "theta": 1e-5,
        "phi": 1e-4,
        "omega_1": 1.0,
        "omega_2": 2.0,
        "omega_3": 3.0,
    }
    names = compiled.first.layout.results["rates"]
    between = Between(compiled, {"I1": 1.0, "I2": 2.0, "I3": 2.5}, 1e-6)
    found = between.tolerances(np.array([values[n] for n in names]))
    assert found.tolist() == [1.0, 2.0, 3.0, 1e-5, 1e-5, 1e-5, 1e-5]


def test_outputs_that_are_not_named_are_left_out(made):
    scene = tumbling("3-1-2", **LOOPS)
    every = run(made(scene), scene, (0, 5))
    some = run(made(scene), scene, (0, 5), outputs=["T", "psi"])
    assert set(every.outputs) == {"T", "H_3"}
    assert set(some.outputs) == {"T"}
    assert some.names == every.names
    np.testing.assert_array_equal(some.y, every.y)
    np.testing.assert_array_equal(some["T"], every["T"])


@pytest.mark.parametrize(
    ("options", "expected"),
    [({"atol": [1.0, 2.0]}, "atol does not fit"), ({"outputs": ["Tee"]}, "unknown state or output"),
     ({"max_step": 0.0}, "max_step is not positive"), ({"first_step": -1.0}, "first_step"),
     ({"t_eval": [3.0, 9.0]}, "t_eval does not fit"), ({"max_steps": 0}, "max_steps"),
     ({"inputs": {"push": 1.0}}, "unknown input"), ({"rtol": 0.0}, "rtol"), ({"margin": 0.0}, "margin")],
)  # fmt: skip
def test_bad_arguments_are_refused(made, options, expected):
    scene = tumbling("3-1-2")
    with pytest.raises(InputError, match=expected):
        run(made(scene), scene, (0, 5), **options)
    with pytest.raises(InputError, match="time interval"):
        run(made(scene), scene, (5, 5))


# --- torques of all kinds -------------------------------------------------------------------------


def in_quaternions(scene, result, end, **inputs):
    """Attitude matrices at the points of a result, from the same scene in a quaternion."""
    data = scene.model_dump(exclude_unset=True) | {"attitude": "quaternion", "outputs": ()}
    other = eom.Scene(**data)
    found = simulate(
        compile_system(other.derive(), TARGET), other.initial_values(), (0, end),
        other.parameter_values(), "DOP853", 1e-12, t_eval=result.t, **inputs,
    )  # fmt: skip
    return [MATRIX_OF_Q(*(found[f"q{k}"][j] for k in range(4))) for j in range(len(result.t))]


PUSHED = {"torque": {"components": ["push", "0.2*turn", 0]}, "inputs": {"push": 0.0, "turn": 0.5}}
TORQUES = {
    "heavy top": {"torque": {"weight": {"mass": 1.0, "gravity": 4.0, "centre_of_mass": [0.1, 0, 0.3]}}},
    "gravity gradient": {"torque": {"gravity_gradient": {"orbital_rate": 1.1}}},
    "inputs": PUSHED,
}  # fmt: skip


@pytest.mark.parametrize("name", TORQUES)
@pytest.mark.parametrize("sequence", ["3-2-1", "3-1-3"])
def test_torques_that_depend_on_attitude_or_inputs(made, name, sequence):
    """Inputs as numbers and as Python functions; each beside the same scene in a quaternion."""
    omega = (0.1, 1.3, 0.05) if sequence == "3-2-1" else (-1.3, 0.1, 0.05)
    scene = tumbling(sequence, start=(0.4, 0.9, 0.05), omega=omega, **TORQUES[name])
    found = charts(scene)
    initial, parameters = numbers(scene, found)
    inputs = {"inputs": {"push": lambda t: 0.7 * math.sin(2 * t), "turn": 0.5}}
    options = inputs if name == "inputs" else {}
    result = handover.simulate(
        made(scene), initial, (0, 8), parameters, "DOP853", 1e-11,
        t_eval=np.linspace(0, 8, 30), **options,
    )  # fmt: skip
    assert result.status == 0
    assert len(result.changes) >= 2
    expected = in_quaternions(scene, result, 8, **options)
    np.testing.assert_allclose(matrices(sequence, result), expected, rtol=0, atol=1e-7)


@pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")
def test_inputs_in_c_are_those_of_the_first_chart(made, tmp_path):
    scene = tumbling("3-2-1", start=(0.4, 0.9, 0.05), omega=(0.1, 1.3, 0.05), **PUSHED)
    compiled = made(scene)
    initial, parameters = numbers(scene, charts(scene))
    held = {"push": 0.3, "turn": -0.8}
    grid = np.linspace(0, 8, 20).tolist()
    expected = handover.simulate(
        compiled, initial, (0, 8), parameters, "DOP853", 1e-11, 1e-14, grid, inputs=held
    )
    order = compiled.first.layout.inputs
    program = built_in(compiled, tmp_path)
    status, changes, _, _, y = in_c(
        program, list(initial.values()), list(parameters.values()),
        [held[q.name] for q in order], 8.0, grid,
    )  # fmt: skip
    assert (status, changes) == (0, len(expected.changes))
    assert changes >= 2
    np.testing.assert_allclose(y, expected.y, rtol=0, atol=1e-6)


@pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")
def test_the_error_of_a_run_in_two_charts_is_estimated_by_another_method():
    scene = eom.load_scene("t-handle-in-angles")
    found = charts(scene)
    start, values = numbers(scene, found)
    made, times = compile_charts(found), np.linspace(0, 0.2, 70)
    run = handover.simulate(made, start, (0, 0.2), values, "DOP853", rtol=1e-7, t_eval=times)
    exact = handover.simulate(made, start, (0, 0.2), values, "taylor", rtol=1e-12)
    assert run.changes
    accuracy = run.accuracy()
    assert accuracy.second == "taylor"
    true = abs(run.y_stop - exact.y_stop)
    estimate = np.array(list(accuracy.at_end.values()))
    assert (estimate < 3 * true + 1e-13).all()
    assert (true < 3 * estimate + 1e-13).all()
    assert np.isnan(accuracy.rate)
