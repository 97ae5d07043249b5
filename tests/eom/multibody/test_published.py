"""Values that others have printed, for problems that others have posed."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import codegen
from eom.errors import InputError
from eom.multibody import GROUND, Body, Joint, Load, Placement, Tree, derive
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.recursion.lumped_tree import lumped_tree
from eom.multibody.recursion.recursions import forward_dynamics, inverse_dynamics, mass_matrix

FLOATS = Numbers(math.sin, math.cos)


def floats(x):
    return x if x in {0, 1, -1} else float(MOMENTS.get(x, x))


PUMA = (
    # d, a, twist, mass, centre, moments, motor's inertia, gear
    (0.672, 0, math.pi / 2, 1, (0, 0, 0), (0.35, 0.35, 0.35), 200e-6, -62.6111),
    (0, 0.4318, 0, 17.4, (-0.3638, 0.006, 0.2275), (0.13, 0.524, 0.539), 200e-6, 107.815),
    (0.15005, 0.0203, -math.pi / 2, 4.8, (-0.0203, -0.0141, 0.07), (0.066, 0.086, 0.0125), 200e-6,
     -53.7063),
    (0.4318, 0, math.pi / 2, 0.82, (0, 0.019, 0), (1.8e-3, 1.3e-3, 1.8e-3), 33e-6, 76.0364),
    (0, 0, -math.pi / 2, 0.34, (0, 0, 0), (0.3e-3, 0.4e-3, 0.3e-3), 33e-6, 71.923),
    (0, 0, 0, 0.09, (0, 0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3), 33e-6, 76.686),
)  # fmt: skip
"""Puma 560 by standard Denavit-Hartenberg parameters: Corke and Armstrong-Helouvry, A search for consensus
among model parameters reported for the PUMA 560 robot, ICRA 1994, pp. 1608-1613, as the Robotics Toolbox
for Python has them (petercorke/robotics-toolbox-python, roboticstoolbox/models/DH/Puma560.py). There
link 1 has no mass and one moment, about its joint's axis; mass on that axis and other moments do nothing.
The moments of link 3 are those of no body (0.086 > 0.066 + 0.0125), so that numbers are refused: they
enter as symbols, which stand for them in the recursions.
"""
MOMENTS = {
    sp.Symbol(f"J{k}_{n}", positive=True): value
    for k, row in enumerate(PUMA, 1)
    for n, value in enumerate(row[5])
}


VISCOUS = (1.48e-3, 0.817e-3, 1.38e-3, 71.2e-6, 82.6e-6, 36.7e-6)
DRY = (0.395, 0.126, 0.132, 11.2e-3, 9.26e-3, 3.96e-3)
"""Friction of the motors (N m s, N m), the dry one where the joint turns forwards."""


def arm(rows, letter):
    """Bodies and joints by standard Denavit-Hartenberg parameters; moments by the names of symbols."""
    bodies, joints, parent = [], [], GROUND
    for k, (d, a, twist, m, centre, _, motor, gear) in enumerate(rows, 1):
        c, s = math.cos(twist), math.sin(twist)
        back = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        seat = Placement(tuple(-back.T @ (a, 0, d)), back.tolist())
        moments = [sp.Symbol(f"{letter}{k}_{n}", positive=True) for n in range(3)]
        bodies.append(Body(f"link{k}", m, centre, moments))
        armature = gear**2 * motor
        joints.append(
            Joint(f"j{k}", "revolute", parent, f"link{k}", armature=armature, on_child=seat)
        )
        parent = f"link{k}"
    return bodies, joints


def puma():
    return arm(PUMA, "J")


def torques(u, udot, g=9.81):
    lumped = lumped_tree(Tree("puma", *puma(), gravity=(0, 0, -g)), floats, FLOATS)
    return np.array(inverse_dynamics(lumped, NOMINAL, u, udot, FLOATS), float)


NOMINAL = [0, math.pi / 4, math.pi, 0, math.pi / 4, 0]
STILL = [0.0] * 6
PRINTED = 5.01e-5
"""Four decimals are printed."""


def test_mass_matrix_of_the_puma_560():
    """Robotics Toolbox for Python, tests/test_DHRobot.py, test_inertia: at the nominal pose."""
    printed = [
        [3.6594, -0.4044, 0.1006, -0.0025, 0, 0],
        [-0.4044, 4.4137, 0.3509, 0, 0.0024, 0],
        [0.1006, 0.3509, 0.9378, 0, 0.0015, 0],
        [-0.0025, 0, 0, 0.1925, 0, 0],
        [0, 0.0024, 0.0015, 0, 0.1713, 0],
        [0, 0, 0, 0, 0, 0.1941],
    ]
    lumped = lumped_tree(Tree("puma", *puma()), floats, FLOATS)
    M = np.array(mass_matrix(lumped, NOMINAL, FLOATS), float)
    assert np.abs(M - printed).max() < PRINTED


def test_torques_of_the_puma_560():
    """The same file: test_gravload, test_itorque (inertia alone), test_coriolis (times rates)."""
    gravity = [0, 31.6399, 6.0351, 0, 0.0283, 0]
    assert torques(STILL, STILL) == pytest.approx(gravity, abs=PRINTED)
    rates = np.array([1, 2, 3, 1, 2, 3])
    inertial = [3.15, 9.4805, 3.6189, 0.1901, 0.3519, 0.5823]
    assert torques(STILL, list(rates), g=0) == pytest.approx(inertial, abs=PRINTED)
    coriolis = [
        [-0.1735, -2.0494, -0.1178, -0.0002, -0.0045, 0.0001],
        [0.6274, 1.1572, 1.9287, -0.0015, -0.0003, 0],
        [-0.3608, -0.7734, -0.0018, -0.0009, -0.0064, 0],
        [0.0011, 0.0005, -0.0001, 0.0002, 0.0002, -0.0001],
        [-0.0002, 0.0028, 0.0046, -0.0002, 0, 0],
        [0.0001, 0, 0, 0, 0, 0],
    ]
    found = torques(list(rates), STILL, g=0)
    assert found == pytest.approx(np.array(coriolis) @ rates, abs=PRINTED * rates.sum())


def test_accelerations_of_the_puma_560_with_friction():
    """The same file: test_accel, with viscous and Coulomb friction of the motors, seen through gears."""
    rates, given = (0.1, 0.2, 0.8, 0.2, 0.5, 1.0), (1.0, 3.2, 1.8, 0.1, 0.7, 4.6)
    printed = [-7.4102, -9.8432, -10.9694, -4.4314, -0.9881, 21.0228]
    bodies, joints = puma()
    rubbed = [
        replace(j, damping=row[7] ** 2 * viscous, force=torque - abs(row[7]) * dry)
        for j, row, viscous, dry, torque in zip(joints, PUMA, VISCOUS, DRY, given, strict=True)
    ]
    system = derive(Tree("puma", bodies, rubbed, gravity=(0, 0, -9.81)), invariants=False)
    parameters = [float(MOMENTS[p.symbol]) for p in system.parameters]
    compiled = codegen.compile(system, "numpy")
    found = compiled.rhs(0.0, np.array([*NOMINAL, *rates]), np.array(parameters), [])
    assert found[6:] == pytest.approx(printed, abs=PRINTED)


def test_the_published_moments_of_link_3_are_those_of_no_body():
    with pytest.raises(InputError, match="no body has this inertia"):
        Body("link3", 4.8, (-0.0203, -0.0141, 0.07), PUMA[2][5])


SIA10 = tuple(
    (d, 0, turns * math.pi / 2, m, centre, moments, motor, 1)
    for d, turns, m, centre, moments, motor in (
        (0.36, 1, 15, (0, -0.02, 0), (0.1, 0.05, 0.1), 5),
        (0, -1, 5, (0, -0.02, -0.1), (0.01, 0.1, 0.1), 5),
        (0.36, 1, 5, (0, -0.05, 0.02), (0.05, 0.01, 0.05), 3),
        (0, -1, 3, (0, 0.02, -0.15), (0.1, 0.1, 0.01), 3),
        (0.36, 1, 3, (0, -0.05, 0.01), (0.02, 0.01, 0.02), 1),
        (0, -1, 3, (0, -0.01, -0.1), (0.1, 0.1, 0.01), 1),
        (0, 0, 1, (0, 0, 0.05), (0.01, 0.01, 0.1), 1),
    )
)
"""Motoman SIA10 by standard Denavit-Hartenberg parameters, as the Kinematics and Dynamics Library poses it:
orocos/orocos_kinematics_dynamics, orocos_kdl/tests/solvertest.cpp, motomansia10dyn. The moments of link 7
are those of no body."""
MOMENTS |= {
    sp.Symbol(f"I{k}_{n}", positive=True): value
    for k, row in enumerate(SIA10, 1)
    for n, value in enumerate(row[5])
}
POSE, RATES = [0.2, 0.6, 1.0, 0.5, -1.4, 0.3, -0.8], [1.0, -2.0, 3.0, -4.0, 5.0, -6.0, 7.0]
THREE_DECIMALS = 1e-3
"""The tolerance of that file."""


def motoman(g=9.81, pushed=True):
    push = Load("link7", (10, -20, 30), (3, -4, 5), (0, 0, 0.155), "body")
    tree = Tree("sia10", *arm(SIA10, "I"), gravity=(0, 0, -g), loads=[push] if pushed else [])
    return lumped_tree(tree, floats, FLOATS)


def test_torques_and_mass_matrix_of_the_motoman_sia10():
    """FdSolverDevelopmentTest of that file: gravity, velocities alone, mass matrix, a force on the tool."""
    still = [0.0] * 7
    gravity = [0, -36.672, 4.315, -11.205, 0.757, 1.780, 0]
    velocities = [-15.523, 24.250, -6.862, 6.303, 0.110, -4.898, -0.249]
    together = [-21.252, -37.933, -2.497, -15.289, -4.646, -9.201, -5.249]
    close = {"abs": THREE_DECIMALS}
    free = motoman(pushed=False)
    assert inverse_dynamics(free, POSE, still, still, FLOATS) == pytest.approx(gravity, **close)
    weightless = motoman(0, pushed=False)
    found = inverse_dynamics(weightless, POSE, RATES, still, FLOATS)
    assert found == pytest.approx(velocities, **close)
    found = inverse_dynamics(motoman(), POSE, RATES, still, FLOATS)
    assert found == pytest.approx(together, **close)
    M = np.array(mass_matrix(free, POSE, FLOATS), float)
    printed = [
        [6.8687, -0.4333, 0.4599, 0.6892, 0.0638, -0.0054, 0.0381],
        [-0.4333, 8.8324, -0.5922, 0.7905, 0.0003, -0.0242, 0.0265],
        [0.4599, -0.5922, 3.3496, -0.0253, 0.1150, -0.0243, 0.0814],
        [0.6892, 0.7905, -0.0253, 3.9623, -0.0201, 0.0087, -0.0291],
        [0.0638, 0.0003, 0.1150, -0.0201, 1.1234, 0.0029, 0.0955],
        [-0.0054, -0.0242, -0.0243, 0.0087, 0.0029, 1.1425, 0],
        [0.0381, 0.0265, 0.0814, -0.0291, 0.0955, 0, 1.1000],
    ]
    assert np.abs(M - printed).max() < THREE_DECIMALS


def test_accelerations_of_the_motoman_sia10():
    """FdSolverConsistencyTest of that file."""
    tau = [50.0, -20.0, 10.0, 40.0, -60.0, 15.0, -10.0]
    printed = [9.486, 1.830, 4.726, 11.665, -50.108, 21.403, -0.381]
    found = forward_dynamics(motoman(), POSE, RATES, tau, FLOATS)
    assert found == pytest.approx(printed, abs=THREE_DECIMALS)
