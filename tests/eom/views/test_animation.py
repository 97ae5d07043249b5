"""Animations: data equal to the simulation, shapes of the right size and inertia, the same bytes."""

import base64
import io
import json
import math
import re
from functools import cache

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import codegen
from eom.errors import InputError
from eom.kinematics.coordinates import attitude, elementary
from eom.mass import regions, solids
from eom.mechanics.gyrostat import gyrostat
from eom.multibody.files.scene import TreeScene
from eom.opening import load_scene
from eom.scenes import catalogue
from eom.scenes.scene import Scene
from eom.views.animation.animation import (
    animation_of,
    animation_of_motion,
    at,
    sampled,
)
from eom.views.animation.animation_page import data, page
from eom.views.animation.bodies import bodies_of, tracks_of, with_attitude
from eom.views.animation.figures import equivalent, shapes_of_file
from eom.views.animation.filming import Film, Filming, film_bytes
from eom.views.animation.tracks import continuous, matrices, of_matrices, turned
from eom.views.draw.meshes import of_solid
from tests.eom.rows import only

HOSTILE = "</script><img src=x onerror=alert(1)>\u2028{{data}} $x$ & \"'"


def integrate(scene):
    """As the commands do; one system is compiled once."""
    plan = scene.integration
    times = [*(plan.t_end * k / (plan.points - 1) for k in range(plan.points - 1)), plan.t_end]
    return codegen.simulate(
        scene.derive(),
        scene.initial_values(),
        (0.0, plan.t_end),
        scene.parameter_values(),
        plan.method,
        plan.rtol,
        t_eval=times,
        inputs=scene.input_values(),
    )


@cache
def ready(name):
    """A ready scene with attitude: what is derived of it is kept."""
    return with_attitude(load_scene(name), 2)


def simulated(scene, points=21, t_end=2.0):
    prepared = ready(scene) if isinstance(scene, str) else with_attitude(scene, points)
    plan = prepared.integration.model_copy(update={"points": points, "t_end": t_end})
    prepared = prepared.model_copy(update={"integration": plan})
    result = integrate(prepared)
    return prepared, result, tracks_of(prepared, result)


def tumbling(attitude, **changes):
    settings = {
        "name": "tumbling",
        "body": {"moments": (1.0, 2.0, 2.5)},
        "attitude": attitude,
        "initial": {"omega_1": 0.4, "omega_2": 1.0, "omega_3": 0.5},
        "integration": {"t_end": 2.0},
    }
    return Scene(**{**settings, **changes})


ANGLES = {"initial_attitude": {"sequence": "3-2-1", "radians": (0.3, -0.2, 0.5)}}


# -- poses -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["quaternion", "dcm", "3-2-1"])
def test_poses_are_the_rotations_of_the_coordinates(name):
    """C_BA of the quaternions is that of `eom.kinematics.coordinates` at the simulated coordinates."""
    _, result, tracks = simulated(tumbling(name, **ANGLES))
    chosen = attitude(name)
    found = matrices(tracks.bodies[0].quaternions)
    for k in (0, 7, 20):
        at_k = {q.symbol: float(result[q.name][k]) for q in chosen.coordinates}
        expected = np.array(chosen.matrix.xreplace(at_k).tolist(), dtype=float)
        assert np.abs(found[k] - expected).max() < 2e-9  # a dcm is orthonormal to its tolerance
    assert np.ptp(tracks.momentum, axis=0).max() < 1e-8  # nothing acts


def test_a_body_without_attitude_gets_it_integrated_along():
    """Its momentum stays in space, and its rates are those of the scene."""
    scene = tumbling("none")
    _, result, tracks = simulated(scene)
    assert np.ptp(tracks.momentum, axis=0).max() < 1e-8
    own = np.stack([result[f"omega_{k}"] for k in (1, 2, 3)], axis=-1)
    back = np.einsum("nij,nj->ni", matrices(tracks.bodies[0].quaternions), tracks.bodies[0].omega)
    assert np.abs(back - own).max() < 1e-12
    assert np.allclose(tracks.bodies[0].quaternions[0], (1, 0, 0, 0))


def test_a_spinner_turns_by_its_spin_too():
    _, result, tracks = simulated("lecture-wheel", 2001)
    track = tracks.bodies[0]
    turns = [(3, "psi"), (1, "theta"), (2, "phi")]
    C = sp.eye(3)
    for axis, name in turns:
        C = elementary(axis, float(result[name][-1])) * C
    assert np.abs(matrices(track.quaternions[-1]) - np.array(C.tolist(), dtype=float)).max() < 1e-12
    assert np.abs(rate(track, tracks.times) - track.omega[1:-1]).max() < 1e-4


def rate(track, times):
    """Angular velocity, components in A, by central differences of 2 dq q*."""
    q, dt = track.quaternions, times[1] - times[0]
    change = (q[2:] - q[:-2]) / (2 * dt)
    s, v, ds, dv = q[1:-1, :1], q[1:-1, 1:], change[:, :1], change[:, 1:]
    return 2 * (s * dv - ds * v - np.cross(dv, v))


def test_a_double_pendulum_is_where_its_angles_say():
    _, result, tracks = simulated("double-pendulum", 41)
    upper, lower = tracks.bodies
    q1, q2 = result["q_shoulder"], result["q_elbow"]
    elbow = np.stack(
        [-np.sin(q1), 0 * q1, -np.cos(q1)], axis=-1
    )  # rods hang along -z, turn about y
    assert np.abs(lower.positions - elbow).max() < 1e-12
    tip = elbow + 0.8 * np.stack([-np.sin(q1 + q2), 0 * q1, -np.cos(q1 + q2)], axis=-1)
    assert np.abs(at(lower, (0, 0, -0.8)) - tip).max() < 1e-12
    assert not upper.positions.any()


def test_a_free_tree_keeps_its_momentum_and_turns_at_its_rates():
    _, _, tracks = simulated("floating-tree", 501, 0.5)
    assert np.ptp(tracks.momentum, axis=0).max() < 1e-8
    for track in tracks.bodies:
        assert np.abs(rate(track, tracks.times) - track.omega[1:-1]).max() < 2e-4


@pytest.mark.slow
def test_speeds_that_constraints_eliminate_are_known():
    """A disc that rolls: the point that touches the ground is at rest."""
    _, _, tracks = simulated("rolling-disc", 2001)
    (track,) = tracks.bodies
    axle = np.einsum("nij,i->nj", matrices(track.quaternions), np.array([0.0, 1.0, 0.0]))
    down = np.array([0.0, 0.0, -1.0]) + axle * axle[:, 2:]
    contact = 0.4 * down / np.linalg.norm(down, axis=1, keepdims=True)
    velocity = (track.positions[2:] - track.positions[:-2]) / (tracks.times[2] - tracks.times[0])
    assert np.abs(velocity + np.cross(track.omega, contact)[1:-1]).max() < 1e-4


def test_driven_joints_and_rotors_move():
    """A turntable at a given speed carries a body with a rotor at a given speed."""
    scene = TreeScene(
        name="turntable",
        bodies={name: {"mass": 1.0, "moments": (1, 1, 1)} for name in ("table", "arm")},
        joints={
            "table": {"kind": "revolute", "parent": "ground", "child": "table",
                      "motion": {"position": "w*t"}},
            "arm": {"kind": "revolute", "parent": "table", "child": "arm", "axis": "x"},
        },
        rotors={"wheel": {"body": "arm", "inertia": 0.1, "axis": "x", "speed": 3.0}},
        parameters={"w": 0.5},
        initial={"u_arm": 0.2},
        integration={"t_end": 1.0},
    )  # fmt: skip
    _, _, tracks = simulated(scene, 201, 1.0)
    table, arm, wheel = tracks.bodies
    assert np.allclose(table.omega, (0, 0, 0.5))
    assert table.quaternions[-1] == pytest.approx((math.cos(0.25), 0, 0, math.sin(0.25)))
    for track in (arm, wheel):
        assert np.abs(rate(track, tracks.times) - track.omega[1:-1]).max() < 1e-4
    assert np.linalg.norm(wheel.omega - arm.omega, axis=1) == pytest.approx(3.0)


def spun(speed, seconds):
    """A slow body with a wheel."""
    return TreeScene(
        name="satellite",
        bodies={"hub": {"mass": 1.0, "moments": (2, 3, 4)}},
        joints={"hub": {"kind": "spherical", "parent": "ground", "child": "hub"}},
        rotors={"wheel": {"body": "hub", "inertia": 1e-6, "axis": (0.6, 0, 0.8)}},
        initial={"w_hub_3": 0.01, "Omega_wheel": speed},
        integration={"t_end": seconds},
    )


@pytest.mark.parametrize(("speed", "slower"), [(40.0, 1), (4000.0, 1e4), (4e6, 1e7)])
def test_a_wheel_too_fast_to_be_seen_is_shown_slower_and_said_to_be(speed, slower):
    shown = animation_of(spun(speed, 60.0), integrate)
    hub, wheel = shown.tracks.bodies
    assert (hub.slower, wheel.slower) == (0, slower)
    assert len(shown.times) < 20_000
    steps = 2 * np.arccos(np.abs(np.sum(wheel.quaternions[1:] * wheel.quaternions[:-1], axis=1)))
    within = np.linalg.norm(wheel.omega - hub.omega, axis=1)
    assert within == pytest.approx(speed, rel=1e-3)
    assert slower * steps.mean() / (shown.times[1] - shown.times[0]) == pytest.approx(
        speed, rel=0.03
    )
    said = [n for n in shown.notes if "slower" in n]
    told = f"wheel: shown turning {slower:.0f} times slower, too fast to be seen otherwise"
    assert said == ([told] if slower > 1 else [])


def test_a_wheel_on_a_hinge_is_shown_slower_where_no_equation_reads_its_angle():
    data = {
        "bodies": {"hub": {"mass": 1.0, "moments": (2, 3, 4)},
                   "wheel": {"mass": 1.0, "moments": (0.02, 0.03, 0.02)}},
        "joints": {"hub": {"kind": "spherical", "parent": "ground", "child": "hub"},
                   "axle": {"kind": "revolute", "parent": "hub", "child": "wheel", "axis": "y"}},
        "initial": {"w_hub_3": 0.01, "u_axle": 500.0},
        "integration": {"t_end": 60.0},
    }  # fmt: skip
    shown = animation_of(TreeScene(**data), integrate)
    hub, wheel = shown.tracks.bodies
    assert hub.slower == 0
    assert wheel.slower > 1
    assert np.linalg.norm(wheel.omega, axis=1) == pytest.approx(500, rel=1e-2)
    axes = [turned(b.quaternions, np.broadcast_to([0.0, 1.0, 0.0], (len(shown.times), 3)))
            for b in (hub, wheel)]  # fmt: skip
    assert axes[0] == pytest.approx(axes[1], abs=1e-9)
    assert any("wheel: shown turning" in n for n in shown.notes)
    data["bodies"]["wheel"]["moments"] = (0.02, 0.03, 0.04)
    with pytest.raises(InputError, match="too many turns"):
        animation_of(TreeScene(**data), integrate)


quaternions = st.lists(st.floats(-1, 1).filter(lambda x: abs(x) > 1e-3), min_size=4, max_size=4)


@given(st.lists(quaternions, min_size=2, max_size=6))
def test_quaternions_are_continuous_and_those_of_their_matrices(rows):
    q = continuous(rows)
    assert np.linalg.norm(q, axis=1) == pytest.approx(1)
    assert np.all(np.einsum("ij,ij->i", q[1:], q[:-1]) >= 0)
    again = of_matrices(matrices(q))
    assert np.abs(matrices(again) - matrices(q)).max() < 1e-12
    assert np.abs(np.abs(np.einsum("ij,ij->i", again, q)) - 1).max() < 1e-12


def test_springs_and_rods_without_mass_are_lines_between_points():
    """Two blobs on a rod without mass, one on a spring from the ground."""
    scene = TreeScene(
        name="dumb-bell",
        bodies={name: {"mass": 1.0, "moments": (1, 1, 1)} for name in ("one", "two")},
        joints={name: {"kind": "free", "parent": "ground", "child": name} for name in ("one", "two")},
        constraints={"rod": {"kind": "distance", "first": "one", "second": "two", "length": "l"}},
        springs={"coil": {"first": "ground", "second": "one", "stiffness": 2.0,
                          "first_point": (0, 0, 3)}},
        parameters={"l": 2.0},
        initial={"x_two": 2.0, "v_one_2": 0.3},
        integration={"t_end": 1.0},
    )  # fmt: skip
    animation = animation_of(scene, integrate)
    coil, rod = animation.figures.links
    assert (coil.bodies, rod.bodies) == ((-1, 0), (0, 1))
    assert coil.points[0].tolist() == [0, 0, 3]
    one, two = animation.tracks.bodies
    apart = at(two, rod.points[1]) - at(one, rod.points[0])
    assert np.linalg.norm(apart, axis=1) == pytest.approx(2.0)
    assert len(data(animation)["links"]) == 2


# -- shapes ----------------------------------------------------------------------------------------


SIZES = {"a": 0.6, "b": 0.4, "c": 0.3, "length": 1.0, "height": 0.7, "radius": 0.3, "inner_radius": 0.2,
         "outer_radius": 0.4, "base_radius": 0.4, "top_radius": 0.2, "ring_radius": 0.5,
         "tube_radius": 0.1}  # fmt: skip


@pytest.mark.parametrize("name", [n for n, s in solids.SOLIDS.items() if s.region.dimension == 3])
def test_meshes_bound_the_volume_of_their_solids(name):
    region = solids.SOLIDS[name].region
    sizes = {n: SIZES[n] for n in solids.SOLIDS[name].sizes}
    values = {sp.Symbol(n, positive=True): v for n, v in sizes.items()}
    exact = float(regions.properties(region).mass.xreplace(values))
    mesh = of_solid(name, sizes)
    assert mesh.closed
    assert 0.97 * exact < mesh.volume < exact * (1 + 1e-12)
    assert all(np.unique(f).size == 3 for f in mesh.faces)


@pytest.mark.parametrize("name", [n for n, s in solids.SOLIDS.items() if s.region.dimension < 3])
def test_thin_solids_have_meshes_too(name):
    mesh = of_solid(name, {n: SIZES[n] for n in solids.SOLIDS[name].sizes})
    assert 0.1 < mesh.extent < 1
    assert np.isfinite(mesh.vertices).all()


spreads = st.tuples(*(st.sampled_from((0.02, 0.3, 1.0, 4.0)) for _ in range(3)))


@given(spreads, st.floats(0.1, 50), quaternions)
def test_equivalent_bodies_have_the_inertia(spread, mass, q):
    p = np.array(spread)
    R = matrices(continuous([q]))[0]
    J = R.T @ np.diag(p.sum() - p) @ R
    found = equivalent(J, mass)
    known = {sp.Symbol(n, positive=True): v for n, v in (*found.sizes.items(), ("mass", mass))}
    own = np.array(solids.central_inertia(found.solid).xreplace(known).tolist(), dtype=float)
    assert np.abs(found.axes @ own @ found.axes.T - J).max() < 1e-6 * np.abs(J).max()


def test_a_named_solid_is_drawn_as_it_is():
    scene = tumbling(
        "none", body={"solid": "box", "mass": 2.0, "size": {"a": 0.4, "b": 0.3, "c": 0.2}}
    )
    (figure,) = bodies_of(scene).figures({}).bodies
    assert figure.shapes[0].mesh.vertices.max(axis=0) == pytest.approx((0.2, 0.15, 0.1))
    assert "box" in figure.words


URDF = """<robot name="r">
<link name="base"/>
<link name="arm-1">
<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><origin xyz="0 0 0.5" rpy="0 1.5707963267948966 0"/>
<geometry><box size="1 0.2 0.1"/></geometry></visual>
<visual><geometry><mesh filename="package://../../secret.stl"/></geometry></visual></link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm-1"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""


def test_shapes_of_a_robot_come_from_its_file(tmp_path):
    pytest.importorskip("yourdfpy")
    file = tmp_path / "r.urdf"
    file.write_text(URDF, encoding="utf-8")
    shapes = shapes_of_file(file)
    (name,) = (n for n, s in shapes.items() if s)
    figure = {f.name: f for f in bodies_of(load_scene(file)).figures(shapes).bodies}[name]
    assert figure.words == "shapes of the file"
    assert figure.shapes[0].mesh.vertices.max(axis=0) == pytest.approx((0.05, 0.1, 1.0))
    assert shapes_of_file("heavy-top") == {}


MJCF = """<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
<body name="arm" pos="0 0 1"><joint name="pin" axis="0 1 0"/>
<geom type="{}" size=".1 .2 .3" pos="0 0 .5" quat="1 0 1 0"/>
<geom type="box" size="9 9 9" group="3"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("kind", "half"),
    [
        ("box", (0.3, 0.2, 0.1)),
        ("ellipsoid", (0.3, 0.2, 0.1)),
        ("sphere", (0.1, 0.1, 0.1)),
        ("cylinder", (0.2, 0.1, 0.1)),
        ("capsule", (0.3, 0.1, 0.1)),
    ],
)
def test_geoms_of_a_model_of_mujoco_are_its_shapes(tmp_path, kind, half):
    """A quarter turn about y takes the shape's axis z to the body's x; shapes to touch are not shown."""
    pytest.importorskip("mujoco")
    file = tmp_path / "m.xml"
    file.write_text(MJCF.format(kind), encoding="utf-8")
    (shapes,) = shapes_of_file(file).values()
    every = np.concatenate([s.mesh.vertices for s in shapes])
    centre = np.array([0, 0, 0.5])
    assert every.max(axis=0) - centre == pytest.approx(half, rel=0.02)
    assert centre - every.min(axis=0) == pytest.approx(half, rel=0.02)
    figure = {f.name: f for f in bodies_of(load_scene(file)).figures(shapes_of_file(file)).bodies}
    assert figure["arm"].words == "shapes of the file"


# -- motions that are no scenes --------------------------------------------------------------------


def test_a_gyrostat_keeps_its_momentum_in_space():
    system = gyrostat(1, drives="free", attitude=attitude("quaternion"))
    start = {"omega_1": 0.3, "omega_2": 0.2, "omega_3": 0.5, "p_1": 2.0,
             "q0": 1.0, "q1": 0.0, "q2": 0.0, "q3": 0.0}  # fmt: skip
    moments = {"I1": 1.0, "I2": 2.0, "I3": 2.5, "Js_1": 0.1}
    t = np.linspace(0, 3, 301)
    run = codegen.simulate(system, start, (0, 3), moments, t_eval=t)
    q, omega, h = (np.stack([run[n] for n in names], axis=-1) for names in (
        ("q0", "q1", "q2", "q3"), ("omega_1", "omega_2", "omega_3"), ("h_1", "h_2", "h_3")))  # fmt: skip
    animation = animation_of_motion("Gyrostat", t, q, omega, (1.0, 2.0, 2.5), momentum=h)
    assert np.ptp(animation.tracks.momentum, axis=0).max() < 1e-8
    assert (
        np.abs(rate(animation.tracks.bodies[0], t) - animation.tracks.bodies[0].omega[1:-1]).max()
        < 1e-3
    )
    assert "box" in animation.notes[0]
    assert data(animation)["count"] == 301


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"times": [0.0, 1.0, 3.0]}, "not equally far apart"),
        ({"quaternions": np.ones((3, 4))}, "unit norm"),
        ({"omega": np.ones((2, 3))}, "does not fit"),
        ({"omega": np.full((3, 3), 9.0)}, "too large a turn"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(changes, what):
    still = {"times": [0.0, 1.0, 2.0], "quaternions": [[1, 0, 0, 0]] * 3, "omega": np.zeros((3, 3))}
    with pytest.raises(InputError, match=what):
        animation_of_motion("still", **{**still, **changes}, inertia=(1, 1, 1))


# -- the page --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", only(catalogue.names(), "t-handle", "double-pendulum"))
def test_every_ready_scene_fits_into_a_page(name):
    animation = sampled(ready(name), integrate, asked=load_scene(name).requested)
    text = page(animation)
    assert len(text.encode()) < 2_000_000
    assert text == page(animation)
    data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])
    assert data["count"] == len(animation.times) >= 2
    steps = np.diff(animation.times)
    assert np.allclose(steps, steps[0])
    for body, track in zip(data["bodies"], animation.tracks.bodies, strict=True):
        q = np.frombuffer(base64.b64decode(body["quaternions"]), "<f4").reshape(-1, 4)
        assert np.abs(q - track.quaternions).max() < 1e-7
        assert np.all(np.einsum("ij,ij->i", q[1:], q[:-1]) > 0)
        turn = np.linalg.norm(track.omega, axis=1).max() * steps[0] / max(track.slower, 1)
        assert turn < 3  # less than half a turn: the shorter way is the right one
        shown = 2 * np.arccos(np.minimum(np.abs(np.einsum("ij,ij->i", q[1:], q[:-1])), 1))
        assert shown.max() < 3


def test_what_a_scene_brings_along_is_escaped():
    text = page(animation_of(tumbling("none", title=HOSTILE, description=HOSTILE), integrate))
    assert "<img" not in text
    assert text.count("<script") == text.count("</script>") == 6  # five of our own, and the data
    data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])
    assert data["title"] == data["bodies"][0]["name"] == HOSTILE
    assert re.findall(r'(?:src|href)="(?!#)', text) == []


@pytest.mark.parametrize(
    ("settings", "what"),
    [({"seconds": -1.0}, "not a positive number"), ({"speed": math.nan}, "not a positive number"),
     ({"seconds": 1e6}, "too many turns")],
)  # fmt: skip
def test_what_cannot_be_shown_is_refused(settings, what):
    with pytest.raises(InputError, match=what):
        animation_of(tumbling("none"), integrate, **settings)


def test_a_run_that_stops_is_shown_up_to_there():
    """Angles that become singular."""
    scene = tumbling("3-2-1", initial={"omega_1": 0.0, "omega_2": 1.0, "omega_3": 0.0},
                     initial_attitude={"sequence": "3-2-1", "radians": (0, 0, 0)},
                     integration={"t_end": 4.0})  # fmt: skip
    animation = animation_of(scene, integrate)
    assert 1.5 < animation.times[-1] < math.pi / 2
    assert animation.notes[0].startswith("stopped at t = 1.57")
    assert data(animation)["end"] == animation.times[-1]


# -- slides ----------------------------------------------------------------------------------------


def test_slides_show_the_motion_and_are_the_same_bytes():
    image = pytest.importorskip("PIL.Image")
    pytest.importorskip("matplotlib")
    animation = animation_of(tumbling("none", title=HOSTILE), integrate)
    film = Film(width=160, height=120, fps=4, length=0.5)
    first = film_bytes(animation, ".gif", film)
    assert first == film_bytes(animation, ".gif", film)
    picture = image.open(io.BytesIO(first))
    assert (picture.size, picture.n_frames) == ((160, 120), 3)
    shown = []
    for k in range(picture.n_frames):
        picture.seek(k)
        shown.append(np.asarray(picture.convert("RGB"), dtype=int))
    assert np.abs(shown[0] - shown[2]).max() > 50


def test_pictures_of_a_film_are_at_the_right_times():
    animation = animation_of(tumbling("none"), integrate, speed=0.5)
    filming = Filming(animation, Film(fps=10, length=3.0))
    assert filming.count == 31
    step = animation.times[1] - animation.times[0]
    assert filming.moment(30) * step == pytest.approx(1.5)
    assert Filming(animation, Film(fps=10, length=99.0)).count == 41
    long = animation_of(tumbling("none"), integrate, speed=0.01)
    with pytest.raises(InputError, match="too many pictures"):
        film_bytes(long, ".gif", Film(fps=50, length=99.0))


# -- the camera ------------------------------------------------------------------------------------------

THROWN = {
    "bodies": {"stick": {"mass": 1, "solid": "box", "size": {"a": 1, "b": 0.2, "c": 0.2}},
               "knob": {"mass": 0.1, "solid": "box", "size": {"a": 0.1, "b": 0.1, "c": 0.1}}},
    "joints": {"thrown": {"kind": "free", "parent": "ground", "child": "stick"},
               "pin": {"kind": "revolute", "parent": "stick", "child": "knob",
                       "on_parent": {"position": (0.5, 0, 0)}}},
    "gravity": (0, 0, -10),
    "initial": {"v_thrown_1": 20, "v_thrown_3": 10, "w_thrown_3": 2},
}  # fmt: skip


def thrown(seconds, follow=None):
    scene = TreeScene(**THROWN, integration={"t_end": seconds})
    return animation_of(scene, integrate, follow=follow)


def test_the_camera_goes_with_a_body_where_the_motion_goes_far():
    near, far = thrown(0.1).view, thrown(2.0)
    assert near.follow == -1
    assert far.view.follow == 0
    assert far.view.radius < 1.2
    assert far.view.centre == pytest.approx([0, 0, 0])
    assert data(far)["follow"] == 0
    filming = Filming(far, Film())
    places = [filming.camera(k).place for k in (0.0, 100.0)]
    way = far.tracks.bodies[0].positions
    assert places[1] - places[0] == pytest.approx(way[100] - way[0])
    for k in (0, 100, 200):
        assert filming.camera(k).view.flat(way[k][None])[0] == pytest.approx([0, 0], abs=1e-12)


def test_the_camera_goes_with_the_body_that_is_named_or_stays():
    assert thrown(2.0, "knob").view.follow == 1
    whole = thrown(2.0, "none").view
    assert whole.follow == -1
    assert whole.radius > 20
    filming = Filming(thrown(2.0, "none"), Film())
    assert filming.camera(0.0).place == pytest.approx(filming.camera(50.0).place)
    with pytest.raises(InputError, match="unknown body 'knbo'"):
        thrown(2.0, "knbo")


def test_squares_of_the_ground_stay_where_they_are_as_the_camera_goes():
    """Of the lines below what is seen at two times those of both lie on each other."""
    from eom.views.animation import filming as films

    filming = Filming(thrown(2.0), Film(length=2.0))
    view = filming.animation.view
    cell = 3.2 * view.radius / 12
    feet = [films.foot_of(filming, k) for k in (0.0, 100.0)]
    steps = (feet[1] - feet[0]) / cell
    assert steps == pytest.approx(np.round(steps), abs=1e-9)
    assert abs(steps[0]) > 10
