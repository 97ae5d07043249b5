"""What acts on trees in animations: as the scene says, where it says."""

import numpy as np
import pytest

from eom import load_scene
from eom.commands.simulating import job_of
from eom.views.animation.animation import animation_of
from eom.views.animation.figures import shapes_of_file
from eom.views.draw.placing import overlaps


def animated(name, seconds=0.5):
    def integrate(prepared):
        return job_of(prepared, "auto", ()).integrate(lambda _: None)

    return animation_of(load_scene(name), integrate, seconds=seconds, robot=shapes_of_file(name))


def found(animation, name, letter):
    return next(a for a in animation.tracks.acting if (a.name, a.letter) == (name, letter))


def test_weights_act_at_centres_of_mass_downwards():
    animation = animated("double-pendulum")
    known = load_scene("double-pendulum").numbers
    weights = [a for a in animation.tracks.acting if a.letter == "mg"]
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
    pin = found(animation, "pin", "τ")
    relative = track.omega - next(b for b in animation.tracks.bodies if b.name == "arm").omega
    assert pin.values == pytest.approx(-scene.numbers["c"] * relative, abs=1e-12)


def test_loads_turn_with_their_bodies():
    animation = animated("quadrotor")
    thrust = found(animation, "motor1", "F")
    assert np.linalg.norm(thrust.values, axis=1) == pytest.approx(1.962, rel=1e-12)
    body = next(b for b in animation.tracks.bodies if b.name == "motor1")
    from eom.views.animation.tracks import turned

    up = turned(body.quaternions, np.broadcast_to([0.0, 0.0, 1.0], (len(animation.times), 3)))
    assert thrust.values == pytest.approx(1.962 * up, abs=1e-9)


def test_a_top_stands_on_its_tip():
    (figure,) = animated("heavy-top").figures.bodies
    mesh = figure.shapes[0].mesh
    assert float(np.min(mesh.vertices[:, 2])) == pytest.approx(0, abs=1e-12)
    tip = mesh.vertices[np.argmin(mesh.vertices[:, 2])]
    assert tip == pytest.approx([0, 0, 0], abs=1e-12)
    assert "tip" in figure.words
    assert animated("heavy-top").figures.ground


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
