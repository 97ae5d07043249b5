"""Values that others have printed, for problems that others have posed."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import codegen
from eom.errors import InputError
from eom.multibody import GROUND, Body, Joint, Placement, Tree, derive
from eom.multibody.recursions import inverse_dynamics, mass_matrix
from eom.multibody.scalars import Numbers
from eom.multibody.skeleton import skeleton

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


def puma():
    bodies, joints, parent, named = [], [], GROUND, list(MOMENTS)
    for k, (d, a, twist, m, centre, _, motor, gear) in enumerate(PUMA, 1):
        c, s = math.cos(twist), math.sin(twist)
        back = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        seat = Placement(tuple(-back.T @ (a, 0, d)), back.tolist())
        bodies.append(Body(f"link{k}", m, centre, named[3 * k - 3 : 3 * k]))
        joints.append(
            Joint(f"j{k}", "revolute", parent, f"link{k}", armature=gear**2 * motor, on_child=seat)
        )
        parent = f"link{k}"
    return bodies, joints


def torques(u, udot, g=9.81):
    bones = skeleton(Tree("puma", *puma(), gravity=(0, 0, -g)), floats, FLOATS)
    return np.array(inverse_dynamics(bones, NOMINAL, u, udot, FLOATS), float)


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
    bones = skeleton(Tree("puma", *puma()), floats, FLOATS)
    M = np.array(mass_matrix(bones, NOMINAL, FLOATS), float)
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
