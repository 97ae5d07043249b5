"""What scenes of one body and of many answer alike."""

import pytest

import eom
from eom.errors import InputError
from eom.scenes import catalogue

ONE, MANY = "heavy-top", "double-pendulum"


def asked(name, output):
    return eom.load_scene(name).changed(outputs=(output,))


@pytest.mark.parametrize("name", catalogue.names())
def test_numbers_and_starts_are_those_of_the_smallest_system(name):
    scene = eom.load_scene(name)
    system = scene.derive()
    known = scene.start | scene.numbers
    assert scene.initial_values() == {n: known[n] for n in system.state_names}
    assert scene.parameter_values() == {n: known[n] for n in system.parameter_names}
    assert set(scene.input_values()) == set(system.input_names)
    assert set(scene.requested_names()) <= {*system.state_names, *system.output_names}
    assert (scene.tree is None) == (name in catalogue.single()) == (not scene.is_tree)
    assert scene.bodies
    assert all(hasattr(part, "solid") for part in scene.bodies.values())
    assert scene.loads is not None


@pytest.mark.parametrize(("name", "output"), [(ONE, "omega_3"), (MANY, "u_elbow"),
                                              ("satellite-with-panels", "p_1")])  # fmt: skip
def test_a_pass_that_is_off_leaves_nothing_out(name, output):
    scene = asked(name, output)
    full = scene.full_system.state_names
    assert len(scene.derive().state_names) <= len(scene.derive(off=["outputs"]).state_names)
    assert set(scene.derive(off=["outputs", *scene._passes()]).state_names) == set(full)
    with pytest.raises(InputError, match="unknown pass 'output'") as caught:
        scene.derive(off=["output"])
    assert "outputs" in caught.value.hint


def test_the_first_integrals_of_one_body_stay_states_where_their_pass_is_off():
    free = eom.Scene.ready("t-handle").changed(body={"moments": [1, 1, 2]}, outputs=("omega_3",))
    assert "omega_1" in free.derive(off=["integrals", "outputs", "moments"]).state_names
    assert "tau_1" in free.derive(off=["torque", "outputs"]).input_names


def test_what_a_tree_leaves_out_is_reported_as_of_one_body():
    one, many = asked(ONE, "omega_3").explain(), asked("pendulum-on-cart", "u_hinge1").explain()
    why = "neither the requested outputs nor the rates that they need depend on them"
    assert why in str(one)
    assert f"q_track, u_track: {why}" in str(many)
    assert 0 < many.after < many.before


def test_attitudes_are_chosen_of_one_body_alone():
    assert eom.load_scene(ONE).in_attitude("3-1-3").attitude == "3-1-3"
    with pytest.raises(InputError, match="attitudes of a tree belong to its joints"):
        eom.load_scene(MANY).in_attitude("3-1-3")


def test_as_stated_is_in_the_coordinates_of_the_scene():
    over = eom.Scene.ready("t-handle-in-angles").changed(integrate="quaternion")
    assert over.as_stated().integrate is None
    many = eom.load_scene(MANY)
    assert many.as_stated() is many


def test_a_start_without_a_number_is_refused():
    data = eom.load_scene(MANY).model_dump(exclude_unset=True)
    length = next(n for n in data["parameters"] if n.startswith("l"))
    with pytest.raises(InputError, match="no finite number") as caught:
        eom.TreeScene(**{**data, "initial": {"q_elbow": f"log(-1.0*{length})"}})
    assert caught.value.where == "[initial] q_elbow"
