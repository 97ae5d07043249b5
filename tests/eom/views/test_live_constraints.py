"""Live pages under constraints: their scripts in Node.js against interpreter, C target and `assemble`."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

import codegen
import eom
from codegen.ir.interpret import Point, interpret_exactly
from codegen.loops import projection
from codegen.native import native
from codegen.passes.pipeline import specialised
from codegen.targets import javascript
from eom.multibody import assemble
from eom.multibody.files.scene import TreeScene
from eom.scenes import catalogue
from eom.views.live.fittings import KINDS
from eom.views.live.page import page
from tests import node
from tests.eom.rows import only
from tests.eom.views.live_pages import BOUND, SUPPORTED, data_of, run, subject, text_of

needs_node = pytest.mark.skipif(not node.NODE, reason="no Node.js")
needs_both = pytest.mark.skipif(not (node.NODE and native.compiler()), reason="no Node.js or no C")

START = (
    "give([motion.message, Object.fromEntries(motion.values), motion.left().map((c) => c.left)]);"
)


def drawn_of(name):
    about = subject(name)
    return about.variants[about.choice].drawn


def test_every_ready_scene_has_a_live_page():
    assert sorted(SUPPORTED) == sorted(catalogue.names())
    texts = {n: Path(catalogue.path_of(n)).read_text(encoding="utf-8") for n in catalogue.names()}
    bound = [n for n, text in texts.items() if tomllib.loads(text).get("constraints")]
    assert sorted(BOUND) == sorted(bound)


@needs_node
@pytest.mark.parametrize("name", only(BOUND, "rolling-ellipsoid"))
def test_rates_and_derivatives_of_constraints_are_those_of_the_interpreter(name):
    """At random states, on the constraints and off them."""
    program, layout = projection.extended(*specialised(drawn_of(name)), drawn_of(name).maintained)
    scene, draw = eom.load_scene(name), np.random.default_rng(7)
    near = {**scene.numbers, **scene.start}
    points = []
    for _ in range(20):
        x = [near.get(q.name, 0.0) + draw.uniform(-0.3, 0.3) for q in layout.states]
        p = [near.get(q.name, 0.0) * draw.uniform(0.9, 1.1) for q in layout.parameters]
        points.append((0.0, x, p, []))
    text = javascript.module(program, layout)
    groups = ("rates", projection.GROUP)
    found = node.run([node.Job(text, g, points, len(layout.results[g])) for g in groups])
    for group, rows in zip(groups, found, strict=True):
        for (t, x, p, u), row in zip(points, rows, strict=True):
            exact = interpret_exactly(program, Point(t, x, p, u))[group]
            size = max(1.0, *(abs(float(e)) for e in exact))
            assert np.max(np.abs(row - np.array([float(e) for e in exact]))) <= 1e-12 * size


@needs_both
@pytest.mark.parametrize("name", only(BOUND, "slider-crank", "rolling-disc"))
def test_pages_end_where_simulate_ends_and_stay_on_the_constraints(name):
    """The scene's own system, whose independent speeds may be others."""
    scene = eom.load_scene(name)
    system = scene.of_tree(scene.tree, ())
    kept = codegen.simulate(
        codegen.compile(system, "c"), {n: scene.start[n] for n in system.state_names}, (0, 3),
        {n: scene.numbers[n] for n in system.parameter_names}, method="DOP853", rtol=1e-12, t_eval=[0, 3],
    )  # fmt: skip
    assert kept.success, kept.message
    got = run(text_of(name), """
        let worst = 0;
        for (let k = 1; k <= 180; k += 1) {
          motion.advance(k / 60);
          motion.left().forEach((c) => { worst = Math.max(worst, Math.abs(c.left)); });
        }
        const states = Object.fromEntries(motion.names.STATES.map((n, k) => [n, motion.states[k]]));
        give([motion.message, motion.stopped, worst, states]);
    """)  # fmt: skip
    message, stopped, worst, states = got
    assert (message, stopped) == ("", "")
    assert worst < 1e-12
    known = {
        **dict(zip(kept.names, kept.y[:, -1], strict=True)),
        **{n: kept[n][-1] for n in kept.outputs},
    }
    assert set(states) <= set(known)
    assert max(abs(states[n] - known[n]) / max(1.0, abs(known[n])) for n in states) < 1e-8


@needs_node
@pytest.mark.parametrize("name", only(BOUND, "four-bar-linkage", "rolling-ellipsoid"))
def test_the_scenes_start_is_taken_as_it_is(name):
    message, values, left = run(text_of(name), START)
    assert message == ""
    assert max(map(abs, left)) < 1e-14
    scene = eom.load_scene(name)
    for state, value in scene.start.items():
        if state in values:
            assert values[state] == pytest.approx(value, abs=1e-12)


@needs_node
@pytest.mark.parametrize(
    ("name", "changes", "keep"),
    [
        ("slider-crank", {"q_crank": 1.4}, ("q_crank", "u_crank")),
        ("slider-crank", {"l": 0.5}, ("q_crank", "u_crank")),
        ("slider-crank", {"q_piston": 0.7}, ("q_piston",)),
        ("slider-crank", {"u_piston": 1.0}, ("u_piston",)),
        ("four-bar-linkage", {"q_crank": -0.4}, ("q_crank", "u_crank")),
        ("four-bar-linkage", {"d": 1.1}, ("q_crank", "u_crank")),
    ],
)
def test_changed_numbers_are_made_consistent_as_assemble_does(name, changes, keep):
    """The nearest start where a change is kept, of all coordinates and then of all speeds."""
    scene = eom.load_scene(name)
    wanted = assemble(scene.tree, {**scene.numbers, **scene.start, **changes}, keep=keep).values
    sets = "".join(f"motion.set({json.dumps(n)}, {x});" for n, x in changes.items())
    message, values, left = run(text_of(name), sets + START)
    assert message == ""
    assert max(map(abs, left)) < 1e-13
    for state in (s for s in scene.start if s in values):
        assert values[state] == pytest.approx(wanted[state], abs=1e-10), state


@needs_node
def test_where_no_configuration_exists_the_page_says_so_and_the_motion_stays():
    program = """
    motion.advance(1);
    const before = Array.from(motion.states), said = [motion.set("d", 5), motion.message, motion.time];
    const same = before.every((x, k) => x === motion.states[k]);
    motion.advance(1.5);
    const moves = motion.time, again = [motion.set("d", 1.2), motion.message, motion.time];
    give({said, same, moves, again, start: motion.values.get("q_rocker")});
    """
    got = run(text_of("four-bar-linkage"), program)
    accepted, message, time = got["said"]
    assert (accepted, time, got["same"], got["moves"]) == (False, 1, True, 1.5)
    assert (
        "no configuration near these numbers meets the constraints: the constraint 'pin'" in message
    )
    assert got["again"] == [True, "", 0]
    start = eom.load_scene("four-bar-linkage").start["q_rocker"]
    assert got["start"] == pytest.approx(
        start, abs=1e-12
    )  # a change that is taken back leaves no trace


@needs_node
@pytest.mark.parametrize("name", only(BOUND[2:], "rolling-disc"))
def test_points_of_contact_are_on_the_plane_and_do_not_slip(name):
    """By central differences: the point of the body that touches has no velocity."""
    at = [f["at"] for f in data_of(text_of(name))["fittings"] if f["kind"] == "roll"]
    program = """
    const rolls = data.fittings.filter((f) => f.kind === "roll"), seen = [];
    for (const t of [0.5 - 1e-4, 0.5, 0.5 + 1e-4]) {
      motion.advance(t);
      seen.push([...motion.view], rolls.map((f) => motion.contact(f, [0, 0, 0])));
    }
    give(seen);
    """
    before, _, now, points, after, _ = run(text_of(name), program)
    assert len(points) == len(at)
    fittings = [f for f in data_of(text_of(name))["fittings"] if f["kind"] == "roll"]
    for f, point in zip(fittings, points, strict=True):
        normal, origin = (np.array(now[f["at"] + k : f["at"] + k + 3]) for k in (8, 11))
        assert abs(normal @ (np.array(point) - origin)) < 1e-13

        def poses(view, k=f["bodies"][0]):
            corners = np.array(view[12 * k : 12 * k + 12]).reshape(4, 3)
            return corners[0], (corners[1:] - corners[0]).T

        origin_now, axes = poses(now)
        within = axes.T @ (np.array(point) - origin_now)
        first, last = (o + A @ within for o, A in (poses(before), poses(after)))
        assert np.max(np.abs(last - first)) / 2e-4 < 1e-5


@needs_node
def test_attitudes_of_trees_are_angles_on_the_page():
    """A disc that leans by another angle stands at another height, and its angle is what was asked for."""
    name = "rolling-disc"
    data = data_of(text_of(name))
    (attitude,) = data["attitudes"]
    assert attitude["sequence"] == [3, 1, 2]
    program = f"motion.set({json.dumps(attitude['knobs'][1])}, 40); {START}"
    message, values, left = run(text_of(name), program)
    assert message == ""
    assert values[attitude["knobs"][1]] == 40
    assert values["z_disc"] == pytest.approx(0.4 * np.cos(np.deg2rad(40)), abs=1e-14)
    assert max(map(abs, left)) < 1e-15


def test_fittings_are_as_their_table_says():
    data = data_of(text_of("slider-crank"))
    assert [f["kind"] for f in data["fittings"]] == ["ball", "rail", "pin"]
    assert {f["kind"] for f in data["fittings"]} <= set(KINDS)


@pytest.mark.parametrize("name", only(SUPPORTED, *BOUND[:4]))
def test_pages_are_small(name):
    assert len(text_of(name).encode()) < 2e6


@needs_node
@pytest.mark.parametrize("name", only(("sleigh", "gears", "rod", "slope"), "sleigh", "rod"))
def test_rods_knife_edges_gears_and_slopes_have_pages_too(name):
    """Constraints that no ready scene has."""
    made = {"sleigh": sleigh, "gears": gears, "rod": pendulum_on_a_rod, "slope": slope}
    message, _, left = run(page(made[name]()), f"motion.advance(1); {START}")
    assert message == ""
    assert max(map(abs, left), default=0.0) < 1e-12


@needs_node
@pytest.mark.parametrize("kind", only(("revolute", "cylindrical"), "revolute"))
def test_a_joint_that_is_turned_round_is_refused(kind):
    """As `assemble` does: opposite axes meet the equations of the joint, too."""
    scene = scene_of(
        "turned",
        {"rod": {"mass": 1.0, "centre": (0, 0, -1), "moments": (0.1, 0.1, 0.1)}},
        {"free": {"kind": "free", "parent": "ground", "child": "rod"}},
        {"hinge": {"kind": "loop", "joint": kind, "first": "ground", "second": "rod", "axis": "x"}},
    )
    program = """
    const turn = (angle) => [motion.set("attitude_free_1", angle), motion.message];
    give([motion.message, turn(180), turn(0)]);
    """
    first, (accepted, message), again = run(page(scene), program)
    assert (first, again) == ("", [True, ""])
    assert not accepted
    assert "'hinge' is turned round" in message


def scene_of(name, bodies, joints, constraints, **more):
    return TreeScene(name=name, bodies=bodies, joints=joints, constraints=constraints, **more)


def sleigh():
    return scene_of(
        "sleigh",
        {"sleigh": {"mass": 2.0, "centre": (0.3, 0, 0), "moments": (0.1, 0.1, 0.2)}},
        {"plane": {"kind": "planar", "parent": "ground", "child": "sleigh"}},
        {"edge": {"kind": "knife_edge", "body": "sleigh"}},
        initial={"v_plane_1": 1.0},
    )


def gears():
    wheel = {"mass": 1.0, "moments": (0.1, 0.1, 0.2)}
    hinge = {"kind": "revolute", "parent": "ground"}
    return scene_of(
        "gears",
        {"one": wheel, "two": wheel},
        {"first": {**hinge, "child": "one"}, "second": {**hinge, "child": "two"}},
        {"teeth": {"kind": "coupling", "ratios": {"first": 1, "second": 2}}},
        initial={"u_first": 2.0},
    )


def pendulum_on_a_rod():
    return scene_of(
        "rod",
        {"bead": {"mass": 1.0, "moments": (0.1, 0.1, 0.1)}},
        {"free": {"kind": "free", "parent": "ground", "child": "bead"}},
        {"rod": {"kind": "distance", "first": "ground", "second": "bead", "length": "l"}},
        parameters={"l": 2.0}, initial={"x_free": 1.9}, gravity=(0, 0, -9.81),
    )  # fmt: skip


def slope():
    return scene_of(
        "slope",
        {"ball": {"mass": 1.0, "moments": (0.1, 0.1, 0.1)}},
        {"free": {"kind": "free", "parent": "ground", "child": "ball"}},
        {"hill": {"kind": "rolling", "body": "ball", "radius": "r", "axis": None, "normal": (0.6, 0, 0.8)}},
        parameters={"r": 0.2}, initial={"z_free": 0.2}, gravity=(0, 0, -9.81),
    )  # fmt: skip
