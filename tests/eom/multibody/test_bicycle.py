"""The benchmark bicycle: Meijaard, Papadopoulos, Ruina, Schwab, Proc. R. Soc. A 463 (2007), p. 1955.

Four bodies, two wheels that roll: a nonholonomic system, linearised about straight motion. Parameters from
their table 1, matrices from their eq. (6.1) to (6.4), eigenvalues from their table 2.
"""

import math

import numpy as np
import pytest

import codegen
from eom.multibody import Body, Joint, Placement, Tree, derive
from tests.eom.rows import only

constraints = pytest.importorskip("eom.multibody.model.constraints")

WHEELBASE, TRAIL, TILT, GRAVITY = 1.02, 0.08, math.pi / 10, 9.81
M = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
K0 = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
K2 = np.array([[0, 76.59734589573222], [0, 2.65431523794604]])
C1 = np.array([[0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
LEAN_AND_STEER = ("q_base_2", "q_steer", "w_base_1", "u_steer")


def bicycle():
    """x forward, y to the right, z down; the frame's origin is the hub of the rear wheel."""
    bodies = [
        Body("frame", 85, (0.3, 0, -0.6), [[9.2, 0, 2.4], [0, 11, 0], [2.4, 0, 2.8]]),
        Body("rear", 2, inertia=(0.0603, 0.12, 0.0603)),
        Body("fork", 4, (0.9 - WHEELBASE - TRAIL, 0, -0.7),
             [[0.05892, 0, -0.00756], [0, 0.06, 0], [-0.00756, 0, 0.00708]]),
        Body("front", 3, inertia=(0.1405, 0.28, 0.1405)),
    ]  # fmt: skip
    axis = (math.sin(TILT), 0, math.cos(TILT))
    joints = [
        Joint("base", "free", "ground", "frame", attitude="3-1-2"),
        Joint("hub", "revolute", "frame", "rear", "y"),
        Joint("steer", "revolute", "frame", "fork", axis,
              on_parent=Placement((WHEELBASE + TRAIL, 0, 0.3))),
        Joint("axle", "revolute", "fork", "front", "y", on_parent=Placement((-TRAIL, 0, -0.35))),
    ]  # fmt: skip
    rolling = [
        constraints.Rolling("back", "rear", 0.3, axis="y", normal=(0, 0, -1)),
        constraints.Rolling("fore", "front", 0.35, axis="y", normal=(0, 0, -1)),
    ]
    return Tree("bicycle", bodies, joints, gravity=(0, 0, GRAVITY), constraints=rolling)


@pytest.fixture(scope="module")
def compiled():
    speeds = ["w_base_1", "v_base_1", "u_steer"]
    return codegen.compile(derive(bicycle(), start={"z_base": -0.3}, independent=speeds), "numpy")


def straight(compiled, speed, kept=(), check=True):
    held = {"v_base_1": speed, "q_base_2": 0.0, "q_steer": 0.0}
    point = codegen.equilibrium(
        compiled, {"z_base": -0.3}, hold=held,
        cyclic=["x_base", "y_base", "q_base_1", "q_hub", "q_axle"],
    )  # fmt: skip
    return codegen.linearise_about(
        compiled, point, constraints=kept,
        independent_states=LEAN_AND_STEER, check=check,
    )  # fmt: skip


@pytest.mark.parametrize("speed", only([0.0, 5.0], 5.0))
def test_matrices_of_lean_and_steer(compiled, speed):
    near = straight(compiled, speed)
    assert near.states == ("q_base_2", "q_steer", "w_base_1", "v_base_1", "u_steer")
    stiffness, damping = GRAVITY * K0 + speed**2 * K2, speed * C1
    expected = np.block([[np.zeros((2, 2)), np.eye(2)],
                         [-np.linalg.solve(M, stiffness), -np.linalg.solve(M, damping)]])  # fmt: skip
    places = [near.states.index(n) for n in LEAN_AND_STEER]
    found = near.A[np.ix_(places, places)]
    assert np.max(np.abs(found - expected)) < 1e-13 * np.max(np.abs(expected))
    assert near.A[near.states.index("v_base_1")] == pytest.approx(np.zeros(5), abs=1e-13)
    assert near.agreement < 1e-11
    assert near.point.isolated
    assert {"z_base", "q_base_3"} <= set(near.eliminated)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("speed", "eigenvalues"),
    [
        (0.0, [5.53094371765393, 3.13164324790656, -3.13164324790656, -5.53094371765393]),
        (5.0, [-0.32286642900409, -0.77534188219585 + 4.46486771378823j,
               -0.77534188219585 - 4.46486771378823j, -14.07838969279822]),
    ],
)  # fmt: skip
def test_printed_eigenvalues(compiled, speed, eigenvalues):
    """The energy is kept as well: no deviation of the forward speed."""
    found = straight(compiled, speed, ["energy"] if speed else [], check=False).eigenvalues
    found = found if speed else found[np.abs(found) > 1e-9]
    assert found == pytest.approx(np.array(eigenvalues), rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("speed", "kind"),
    [(4.29, "unstable"), (4.30, "asymptotically stable"),
     (6.02, "asymptotically stable"), (6.03, "unstable")],
)  # fmt: skip
def test_it_stands_by_itself_between_the_weave_and_the_capsize_speed(compiled, speed, kind):
    """4.292 to 6.024 m/s, the energy kept."""
    assert straight(compiled, speed, ["energy"], check=False).stability.kind == kind


@pytest.mark.slow
def test_the_linear_motion_alone_does_not_decide_with_a_free_forward_speed(compiled):
    assert straight(compiled, 5.0, check=False).stability.kind == "undecided"
