"""What acts on trees in animations: as the scene says, where it says."""

import numpy as np
import pytest

import codegen
from eom import load_scene
from eom.commands.simulating import job_of
from eom.multibody.files.scene import TreeScene
from eom.views.animation.acting import group, words
from eom.views.animation.animation import animation_of
from eom.views.animation.bodies import Drawing, ManyBodies
from eom.views.animation.figures import shapes_of_file
from eom.views.animation.tracks import matrices, turned
from eom.views.draw.picture import Arrow
from eom.views.draw.placing import overlaps
from eom.views.live.scenes import subject_of
from eom.views.tree.sketches import TreeAtStart, sketch


def animated(name, seconds=0.5):
    def integrate(prepared):
        return job_of(prepared, "auto", ()).integrate(lambda _: None)

    scene = load_scene(name) if isinstance(name, str) else name
    robot = shapes_of_file(name) if isinstance(name, str) else None
    return animation_of(scene, integrate, seconds=seconds, robot=robot)


def found(animation, name, kind):
    return next(a for a in animation.tracks.acting if (a.name, a.kind) == (name, kind))


def test_weights_act_at_centres_of_mass_downwards():
    animation = animated("double-pendulum")
    known = load_scene("double-pendulum").numbers
    weights = [a for a in animation.tracks.acting if a.kind == "weight"]
    assert len(weights) == len(animation.tracks.bodies) == 2
    sizes = np.array([np.linalg.norm(a.values[0]) for a in weights])
    masses = sizes / known["g"]
    middle = sum(m * a.places for m, a in zip(masses, weights, strict=True)) / masses.sum()
    assert middle == pytest.approx(animation.tracks.centre, abs=1e-12)
    for a in weights:
        assert np.ptp(a.values, axis=0) == pytest.approx(0, abs=0)


def test_joints_act_as_their_laws_say_along_their_axes():
    animation, scene = animated("rotary-pendulum"), load_scene("rotary-pendulum")
    track = next(b for b in animation.tracks.bodies if b.name == "rod")
    pin = found(animation, "joint pin on rod", "torque")
    relative = track.omega - next(b for b in animation.tracks.bodies if b.name == "arm").omega
    assert pin.values == pytest.approx(-scene.numbers["c"] * relative, abs=1e-12)


def test_loads_turn_with_their_bodies():
    animation = animated("quadrotor")
    thrust = found(animation, "load on motor1", "force")
    assert np.linalg.norm(thrust.values, axis=1) == pytest.approx(1.962, rel=1e-12)
    body = next(b for b in animation.tracks.bodies if b.name == "motor1")
    up = turned(body.quaternions, np.broadcast_to([0.0, 0.0, 1.0], (len(animation.times), 3)))
    assert thrust.values == pytest.approx(1.962 * up, abs=1e-9)


def rate(values, times):
    """The rate by differences of the eighth order, in the middle of the times."""
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    step = times[1] - times[0]
    return sum(w * values[k : len(values) - 8 + k] for k, w in enumerate(weights)) / step


@pytest.mark.parametrize(
    "name",
    [
        "rolling-disc",
        "rolling-ellipsoid",
        pytest.param("whipple-bicycle", marks=pytest.mark.slow),
        "quadrotor",
    ],
)
def test_what_acts_from_outside_changes_the_momentum(name):
    """Euler's laws of bodies that nothing but weights, loads and contacts holds: no joint to the ground."""
    animation = animated(name, 0.3)
    tracks, known = animation.tracks, load_scene(name).numbers
    within = ("joint", "reaction of")  # from one body on another
    acting = [a for a in tracks.acting if not a.name.startswith(within)]
    force = sum(a.values for a in acting if a.kind != "torque")
    moment = sum(np.cross(a.places - tracks.centre, a.values) for a in acting if a.kind != "torque")
    moment = moment + sum(a.values for a in acting if a.kind == "torque")
    mass = sum(np.linalg.norm(a.values[0]) for a in acting if a.kind == "weight") / known["g"]
    t, inner = animation.times, slice(4, -4)
    size = np.abs(force).max() + mass * known["g"]
    assert rate(tracks.momentum, t) == pytest.approx(moment[inner], abs=1e-6 * size)
    assert mass * rate(rate(tracks.centre, t), t) == pytest.approx(force[8:-8], abs=2e-5 * size)


LINKAGE = {
    "four-bar-linkage": ("rocker", "constraint pin on rocker", "F_rocker_"),
    "slider-crank": ("piston", "constraint wrist on piston", "F_piston_"),
}


@pytest.mark.parametrize("name", LINKAGE)
def test_a_loop_pulls_at_the_body_behind_it_with_what_its_joint_does_not_give(name):
    """Newton's law of the body that closes the loop; what its other joint gives, the reactions say."""
    body, words, joint = LINKAGE[name]
    base = load_scene(name)
    scene = base.model_copy(
        update={"outputs": (*base.outputs, *(f"{joint}{k}" for k in (1, 2, 3)))}
    )
    results = []

    def integrate(prepared):
        results.append(job_of(prepared, "auto", ()).integrate(lambda _: None))
        return results[-1]

    animation = animation_of(scene, integrate, seconds=0.3)
    pull = found(animation, words, "reaction")
    weight = found(animation, f"weight on {body}", "weight")
    support = np.stack([results[-1][f"{joint}{k}"] for k in (1, 2, 3)], axis=-1)
    mass = np.linalg.norm(weight.values[0]) / base.numbers["g"]
    taken = mass * rate(rate(weight.places, animation.times), animation.times)
    given = (pull.values + weight.values + support)[8:-8]
    assert taken == pytest.approx(given, abs=1e-4 * np.abs(pull.values).max())


@pytest.mark.parametrize(
    "name", ["double-pendulum", "slider-crank", "foucault-pendulum", "rotary-pendulum"]
)
def test_reactions_of_joints_are_those_that_are_derived(name):
    """Against the outputs of the system, which come from its symbolic accelerations."""
    base = load_scene(name)
    joints = [j.name for j in base.tree.ordered if j.kind not in {"fixed", "free"}]
    outputs = tuple(f"F_{j}_{k}" for j in joints for k in (1, 2, 3))
    results = []

    def integrate(prepared):
        results.append(job_of(prepared, "auto", ()).integrate(lambda _: None))
        return results[-1]

    asked = base.model_copy(update={"outputs": (*base.outputs, *outputs)})
    acting = {
        a.name: a
        for a in animation_of(asked, integrate, seconds=0.2).tracks.acting
        if a.kind == "joint"
    }
    assert acting
    for joint in joints:
        values = np.stack([results[-1][f"F_{joint}_{k}"] for k in (1, 2, 3)], axis=-1)
        child = next(j.child for j in base.tree.joints if j.name == joint)
        drawn = acting.get(f"reaction of {joint} on {child}")
        if drawn is None:
            assert values == pytest.approx(0, abs=1e-9)
        else:
            assert drawn.values == pytest.approx(values, abs=1e-8 * max(np.abs(values).max(), 1.0))


def bob(**more):
    """A mass on a sphere of freedom: what acts on it is what moves it."""
    body = {"mass": 2.0, "moments": (0.1, 0.1, 0.1)}
    joint = {"kind": "free", "parent": "ground", "child": "bob"}
    given = {"initial": {"x_joint": 0.7, "v_joint_2": 0.4, "w_joint_3": 1.0}, **more}
    return TreeScene(
        bodies={"bob": body}, joints={"joint": joint}, integration={"t_end": 1.0}, **given
    )


def test_springs_and_dampers_between_points_pull_along_their_line():
    spring = {"first": "ground", "second": "bob", "second_point": [0, 0.1, 0], "stiffness": 5.0,
              "length": 0.3, "damping": 0.6}  # fmt: skip
    animation = animated(bob(springs={"s": spring}))
    (pull,) = animation.tracks.acting
    assert (pull.name, pull.kind, pull.letter) == ("spring s on bob", "force", "$F_{s}$")
    length = np.linalg.norm(pull.places, axis=1)
    t = animation.times
    tension = 5.0 * (length[4:-4] - 0.3) + 0.6 * rate(length, t)
    expected = -tension[:, None] * pull.places[4:-4] / length[4:-4, None]
    assert pull.values[4:-4] == pytest.approx(expected, abs=1e-8)
    assert 2.0 * rate(rate(animation.tracks.bodies[0].positions, t), t) == pytest.approx(
        pull.values[8:-8], abs=1e-4
    )


def test_rods_pull_at_both_ends():
    scene = TreeScene(
        bodies={n: {"mass": 1.0, "moments": (0.1, 0.1, 0.1)} for n in "ab"},
        joints={n: {"kind": "free", "parent": "ground", "child": n} for n in "ab"},
        constraints={"rod": {"kind": "distance", "first": "a", "second": "b", "length": 1.0}},
        initial={"x_b": 1.0, "v_b_2": 2.0},
        keep=["v_b_2"],
        integration={"t_end": 1.0},
    )
    first, second = animated(scene).tracks.acting
    assert (first.name, second.name) == ("constraint rod on a", "constraint rod on b")
    assert first.values == pytest.approx(-second.values, abs=1e-12)
    assert np.linalg.norm(first.values, axis=1) == pytest.approx(0.5 * 4.0, rel=1e-9)  # m v^2 / 2 l
    way = second.places - first.places
    assert np.cross(way, second.values) == pytest.approx(0, abs=1e-9)
    assert np.einsum("ni,ni->n", way, second.values).max() < 0


def test_rotors_turn_their_bodies_the_other_way():
    animation = animated("reaction-wheels", 2.0)
    motor = found(animation, "rotor wheel1 on mount1", "torque")
    assert np.linalg.norm(motor.values, axis=1) == pytest.approx(0.008, rel=1e-12)


def test_jets_push_against_what_they_throw_out():
    animation, known = animated("rocket", 1.0), load_scene("rocket").numbers
    (thrust,) = (a for a in animation.tracks.acting if a.name.startswith("jet"))
    nose = animation.tracks.bodies[0]
    axis = turned(nose.quaternions, np.broadcast_to([0.0, 0.0, 1.0], (len(animation.times), 3)))
    size = np.linalg.norm(thrust.values, axis=1)
    assert np.einsum("ni,ni->n", axis, thrust.values) == pytest.approx(size, rel=1e-9)
    assert size[0] == pytest.approx(known["mu"] * known["v"], rel=1e-9)


def test_a_gradient_of_gravity_pulls_and_turns():
    """Of a body on a circular orbit: 3 n^2 r x J r about its centre of mass (Hughes 1986, sect. 8.1)."""
    n, J = 0.3, np.diag([0.1, 0.2, 0.25])
    scene = bob(gravity_gradient=[[2 * n * n, 0, 0], [0, -n * n, 0], [0, 0, -n * n]],
                initial={"w_joint_3": 0.1, "w_joint_1": 0.4, "x_joint": 0.5})  # fmt: skip
    bodies = {"bob": {"mass": 2.0, "moments": tuple(J.diagonal())}}
    animation = animated(TreeScene(**{**scene.model_dump(exclude_unset=True), "bodies": bodies}))
    torque = found(animation, "gradient of gravity on bob", "torque")
    (track,) = animation.tracks.bodies
    C = matrices(track.quaternions)
    r = C @ np.array([1.0, 0.0, 0.0])
    expected = np.einsum("nij,ni->nj", C, 3 * n * n * np.cross(r, r @ J))
    assert torque.values == pytest.approx(expected, abs=1e-12)
    pull = found(animation, "weight on bob", "weight")
    x, y, z = track.positions.T
    assert pull.values == pytest.approx(2.0 * n * n * np.stack([2 * x, -y, -z], axis=-1), abs=1e-12)


@pytest.mark.parametrize("name", ["heavy-top", "bicycle-wheel"])
def test_a_fixed_point_gives_what_the_weight_does_not(name):
    """Newton's law of the centre of mass, by differences; the moment about the point is the weight's."""
    animation = animated(name)
    weight, reaction = (found(animation, *asked) for asked in (
        ("weight", "weight"), ("reaction of the fixed point", "reaction")))  # fmt: skip
    assert not np.any(reaction.places)
    mass = load_scene(name).torque.weight.mass
    taken = mass * rate(rate(weight.places, animation.times), animation.times)
    given = (weight.values + reaction.values)[8:-8]
    assert taken == pytest.approx(given, abs=1e-5 * np.abs(weight.values).max())
    assert animation.tracks.torque == pytest.approx(
        np.cross(weight.places, weight.values), abs=1e-9
    )


def test_a_top_stands_on_its_tip():
    (figure,) = animated("heavy-top").figures.bodies
    mesh = figure.shapes[0].mesh
    assert float(np.min(mesh.vertices[:, 2])) == pytest.approx(0, abs=1e-12)
    tip = mesh.vertices[np.argmin(mesh.vertices[:, 2])]
    assert tip == pytest.approx([0, 0, 0], abs=1e-12)
    assert "tip" in figure.words
    animation = animated("heavy-top")
    feet = [float(np.min(s.mesh.vertices[:, 2])) for s in animation.figures.ground]
    assert animation.view.ground == pytest.approx(min(feet), abs=1e-12)  # it stands on the ground


def test_a_robot_stands_on_a_plate_at_the_height_of_its_base():
    ground = animated("seven-joint-arm").figures.ground
    lowest = min(float(np.min(s.mesh.vertices[:, 2])) for s in ground)
    assert -0.02 < lowest <= 0


def test_no_names_overlap_in_films():
    from matplotlib.figure import Figure

    from eom.views.animation import filming

    animation = animated("seven-joint-arm")
    film = filming.Filming(animation, filming.Film())
    for place in (0.0, len(animation.times) - 1.0):
        figure = Figure(figsize=(6.4, 4.8), dpi=100)
        filming.draw(film, place, figure)
        assert overlaps(figure) == []


@pytest.mark.parametrize("name", ["rolling-disc", "four-bar-linkage", "reaction-wheels", "rocket"])
def test_live_pages_draw_the_same_vectors(name):
    """The vectors of a live page, outputs of its system, are those of the animation, from arrays."""
    scene = load_scene(name)
    about = subject_of(scene)
    variant = about.variants[about.choice]
    compiled = codegen.compile(variant.drawn, "python")
    given = {n: v.value for n, v in scene.inputs.items()}
    start = {**scene.start, **scene.numbers}
    state = np.array([start[n] for n in variant.drawn.state_names])
    parameters = np.array([start[n] for n in variant.drawn.parameter_names])
    inputs = np.array([given.get(n, 0.0) for n in variant.drawn.input_names])
    values = np.asarray(compiled.outputs(0.0, state, parameters, inputs))
    vectors = values[-6 * len(variant.vectors) :].reshape(-1, 2, 3)
    animation = animated(name, 0.1)
    drawn = {(a.name, a.kind): a for a in animation.tracks.acting}
    acting = [(v, x) for v, x in zip(variant.vectors, vectors, strict=True) if v.source != "motion"]
    assert {(words(v), group(v)) for v, x in acting if np.any(np.abs(x[0]) > 1e-12)} <= set(drawn)
    for vector, (value, place) in acting:
        if (words(vector), group(vector)) in drawn:
            shown = drawn[words(vector), group(vector)]
            size = np.abs(shown.values).max()
            assert shown.values[0] == pytest.approx(value, abs=1e-9 * size)
            assert shown.places[0] == pytest.approx(place, abs=1e-9)
    tracks = {b.name: b for b in animation.tracks.bodies}
    for vector, (value, place) in zip(variant.vectors, vectors, strict=True):
        if vector.kind == "omega":
            assert tracks[vector.body].omega[0] == pytest.approx(value, abs=1e-9)
            assert tracks[vector.body].positions[0] == pytest.approx(place, abs=1e-9)
        elif vector.kind == "momentum":
            assert animation.tracks.momentum[0] == pytest.approx(value, abs=1e-9)
            assert animation.tracks.centre[0] == pytest.approx(place, abs=1e-9)


def test_what_rolls_touches_its_plane_in_animations_and_sketches():
    for name, body in (
        ("whipple-bicycle", "rear"),
        ("rolling-ellipsoid", "egg"),
        ("rolling-disc", "disc"),
    ):
        scene = load_scene(name)
        start = TreeAtStart(ManyBodies(scene))
        for spokes in (True, False):
            shapes, _ = Drawing(scene, {}, spokes=spokes).own(scene.tree.body[body])
            vertices = np.concatenate([s.mesh.vertices for s in shapes])
            place = start.bodies[body]
            normal = np.array([float(x) for x in scene.tree.constraints[0].normal])
            lowest = float((place.origin @ normal + vertices @ place.C @ normal).min())
            assert lowest == pytest.approx(0.0, abs=0.02 * np.ptp(vertices))


def test_sketches_draw_the_torque_of_a_gradient():
    n = 0.3
    scene = bob(gravity_gradient=[[2 * n * n, 0, 0], [0, -n * n, 0], [0, 0, -n * n]],
                initial_attitude={"joint": {"sequence": "3-2-1", "degrees": [30, 0, 0]}})  # fmt: skip
    data = {**scene.model_dump(exclude_unset=True), "initial": {}}
    data["bodies"] = {"bob": {"mass": 2.0, "moments": (0.1, 0.2, 0.25)}}
    items = sketch(TreeScene(**data)).rows[0][0].items
    (couple,) = (i for i in items if isinstance(i, Arrow) and i.label == "torque")
    way = (couple.end - couple.start) / np.linalg.norm(couple.end - couple.start)
    assert way == pytest.approx(
        [0, 0, -1], abs=1e-9
    )  # J_2 > J_1 turns axis 1 to the attracting centre
    assert "gradient" in sketch(TreeScene(**data)).caption
