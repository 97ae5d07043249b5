"""Points of bodies as outputs: against derivatives along the motion."""

import numpy as np
import pytest

import codegen
from eom.errors import InputError
from eom.multibody import Body, Joint, Point, Tree, derive
from tests.eom.multibody.trees import state, tree
from tests.eom.rows import only


def reported(compiled, x):
    return np.array(compiled.outputs(0.0, x, [], []), dtype=float)


@pytest.mark.parametrize("seed", only(range(3), 0))
def test_velocity_and_acceleration_are_rates_of_position(seed):
    """Of a random tree, loads and springs of joints acting: by central differences along the motion."""
    given = tree(seed, 3)
    system = derive(given, [Point("tip", "b2", (1, -2, 3))], invariants=False)
    assert system.output_names == tuple(f"{q}_tip_{k}" for q in "xva" for k in (1, 2, 3))
    compiled = codegen.compile(system, "numpy")
    x = np.array([float(v) for group in state(given, seed) for v in group])
    dx = compiled.rhs(0.0, x, [], [])
    h = 1e-5 / np.abs(dx).max()
    change = (reported(compiled, x + h * dx) - reported(compiled, x - h * dx)) / (2 * h)
    here = reported(compiled, x)
    scale = np.abs(change[:6]).max()
    assert here[3:] == pytest.approx(change[:6], rel=1e-6, abs=1e-6 * scale)


def test_a_point_of_a_spinning_disc_goes_round():
    """The frame of a body of revolution at an end need not turn; with a point on it, it does."""
    disc = Body("disc", 2, (0, 0, 0), (1, 1, 2))
    spin = Joint("spin", "revolute", "ground", "disc", "z")
    system = derive(Tree("t", [disc], [spin]), [Point("rim", "disc", (1, 0, 0))])
    found = reported(codegen.compile(system, "numpy"), np.array([0.5, 3.0]))
    c, s = np.cos(0.5), np.sin(0.5)
    assert found == pytest.approx([c, s, 0, -3 * s, 3 * c, 0, -9 * c, -9 * s, 0], abs=1e-14)


def test_a_point_that_falls_freely_accelerates_by_gravity():
    bodies = tree(1, 1).bodies
    system = derive(Tree("t", bodies, [Joint("j", "free", "ground", "b0")], gravity=(0, 1, -9)),
                    [Point("p", "b0", bodies[0].centre, ["acceleration"])])  # fmt: skip
    x = np.zeros(13)
    x[3], x[7:] = 1.0, (0.3, -2.0, 1.0, 0.5, 0.6, 0.7)
    assert reported(codegen.compile(system, "numpy"), x) == pytest.approx([0, 1, -9], abs=1e-13)


def test_a_point_of_what_is_fixed_to_the_ground_rests():
    given = tree(1, 1)
    weld = Joint("j", "fixed", "ground", "b0")
    bodies = [*given.bodies, *(b for b in tree(2, 2).bodies if b.name == "b1")]
    joints = [weld, Joint("k", "revolute", "ground", "b1", "x")]
    system = derive(Tree("t", bodies, joints), [Point("p", "b0", (1, 2, 3))])
    assert reported(codegen.compile(system, "numpy"), np.ones(2)).tolist() == [1, 2, 3, *[0] * 6]


def test_errors_name_the_point():
    given = tree(1, 1)
    for made, what in (
        (lambda: Point("p", "b0", quantities=["place"]), "unknown quantity 'place'"),
        (lambda: derive(given, [Point("p", "c0")]), "unknown body 'c0'"),
        (lambda: Point("p", "b0", (1, 2)), "not three components"),
    ):
        with pytest.raises(InputError, match=what) as caught:
            made()
        assert "point 'p'" in str(caught.value)
