"""The benchmark bicycle: Meijaard, Papadopoulos, Ruina, Schwab, Proc. R. Soc. A 463 (2007), p. 1955.

The ready scene: four bodies, two wheels that roll, a nonholonomic system, linearised about straight motion.
Its parameters are from their table 1; matrices here from their eq. (6.1) to (6.4), eigenvalues from their
table 2, weave and capsize speed from their section 6.
"""

import numpy as np
import pytest

import codegen
import eom
from eom.multibody import derive
from tests.eom.rows import only

GRAVITY = 9.81
WEAVE, CAPSIZE = 4.29238253634111, 6.02426201538837
SCENE = eom.load_scene("whipple-bicycle")
M = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
K0 = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
K2 = np.array([[0, 76.59734589573222], [0, 2.65431523794604]])
C1 = np.array([[0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
LEAN_AND_STEER = ("q_frame_2", "q_steer", "w_frame_1", "u_steer")


@pytest.fixture(scope="module")
def compiled():
    speeds = ["w_frame_1", "v_frame_1", "u_steer"]
    start = {**SCENE.numbers, "z_frame": -0.3}
    return codegen.compile(derive(SCENE.tree, start=start, independent=speeds), "numpy")


def straight(compiled, speed, kept=(), check=True):
    held = {"v_frame_1": speed, "q_frame_2": 0.0, "q_steer": 0.0}
    point = codegen.equilibrium(
        compiled, {"z_frame": -0.3}, SCENE.parameter_values(), hold=held,
        cyclic=["x_frame", "y_frame", "q_frame_1", "q_hub", "q_axle"],
    )  # fmt: skip
    return codegen.linearise_about(
        compiled, point, constraints=kept,
        independent_states=LEAN_AND_STEER, check=check,
    )  # fmt: skip


@pytest.mark.parametrize("speed", only([0.0, 5.0], 5.0))
def test_matrices_of_lean_and_steer(compiled, speed):
    near = straight(compiled, speed)
    assert near.states == ("q_frame_2", "q_steer", "w_frame_1", "v_frame_1", "u_steer")
    stiffness, damping = GRAVITY * K0 + speed**2 * K2, speed * C1
    expected = np.block([[np.zeros((2, 2)), np.eye(2)],
                         [-np.linalg.solve(M, stiffness), -np.linalg.solve(M, damping)]])  # fmt: skip
    places = [near.states.index(n) for n in LEAN_AND_STEER]
    found = near.A[np.ix_(places, places)]
    assert np.max(np.abs(found - expected)) < 1e-13 * np.max(np.abs(expected))
    assert near.A[near.states.index("v_frame_1")] == pytest.approx(np.zeros(5), abs=1e-13)
    assert near.agreement < 1e-11
    assert near.point.isolated
    assert {"z_frame", "q_frame_3"} <= set(near.eliminated)


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
@pytest.mark.parametrize(("speed", "turning"), [(WEAVE, 2), (CAPSIZE, 0)])
def test_an_eigenvalue_crosses_at_the_published_speed(compiled, speed, turning):
    """A pair that swings at the weave speed, a real one at the capsize speed."""
    found = straight(compiled, speed, ["energy"], check=False).eigenvalues
    crossing = found[np.argsort(np.abs(found.real))][: max(turning, 1)]
    assert np.max(np.abs(crossing.real)) < 2e-12
    assert np.sum(np.abs(crossing.imag) > 1) == turning


@pytest.mark.slow
def test_the_linear_motion_alone_does_not_decide_with_a_free_forward_speed(compiled):
    assert straight(compiled, 5.0, check=False).stability.kind == "undecided"
