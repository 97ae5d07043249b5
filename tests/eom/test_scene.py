"""Scenes: the smallest system, its trajectory beside the full one, and one clear error a mistake."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp

import codegen
from eom.errors import AssumptionError, InputError
from eom.exact.identity import equal
from eom.scenes import catalogue, start
from eom.scenes.reduce import cost
from eom.scenes.scene import Scene
from eom.scenes.scene_files import MAX_FILE_BYTES
from tests.eom.rows import every

MOMENTS = {"moments": [1.0, 2.0, 2.5]}
WHEEL = {"moments": [0.06, 0.12]}
TOP = {"mass": 1.0, "gravity": 10.0, "centre_of_mass": [0.0, 0.0, 0.2]}


def rates_of(system):
    return {n: system.expand(r) for n, r in zip(system.state_names, system.rates, strict=True)}


@pytest.mark.parametrize("name", catalogue.single())
def test_ready_scene_is_whole(name):
    scene = Scene.ready(name)
    system = scene.derive()
    assert system.title == scene.title
    assert set(scene.initial_values()) == set(system.state_names)
    assert set(scene.parameter_values()) == set(system.parameter_names)
    available = {*system.state_names, *system.output_names, *system.parameter_names}
    assert set(scene.outputs) <= available
    assert str(cost(system)) in str(scene.explain())


SMALL = {
    # name: (scene, states, parameters, reasons that explain() must give)
    "free body without attitude": (
        {"body": MOMENTS},
        ("omega_1", "omega_2", "omega_3"),
        ("I1", "I2", "I3"),
        ["tau_1 = 0, tau_2 = 0, tau_3 = 0"],
    ),
    "attitude asked for but no output needs it": (
        {"body": MOMENTS, "attitude": "quaternion", "outputs": ["omega_1"]},
        ("omega_1", "omega_2", "omega_3"),
        ("I1", "I2", "I3"),
        ["q0, q1, q2, q3"],
    ),
    "cyclic angle of a sequence": (
        {"body": MOMENTS, "attitude": "3-1-3", "outputs": ["tilt"]},
        ("omega_1", "omega_2", "omega_3", "theta", "phi"),
        ("I1", "I2", "I3"),
        ["psi"],
    ),
    "columns of the direction cosines": (
        {"body": MOMENTS, "attitude": "dcm", "outputs": ["tilt"]},
        ("omega_1", "omega_2", "omega_3", "C13", "C23", "C33"),
        ("I1", "I2", "I3"),
        ["C11, C12, C21, C22, C31, C32"],
    ),
    "symmetric free body keeps its spin": (
        {"body": {"moments": [2.0, 2.0, 1.0]}},
        ("omega_1", "omega_2"),
        ("I1", "I3", "omega_3"),
        ["I1 == I2", "omega_3", "first integrals"],
    ),
    "sphere with one direction": (
        {"body": {"moments": [2.0, 2.0, 2.0]}, "attitude": "dcm", "outputs": ["C11"]},
        ("C11", "C21", "C31"),
        ("omega_1", "omega_2", "omega_3"),
        ["I1 == I2, I1 == I3", "omega_1, omega_2, omega_3"],
    ),
    "top: column of the vertical alone": (
        {
            "body": {"moments": [1.0, 1.0, 0.3]},
            "attitude": "dcm",
            "torque": {"weight": TOP},
            "outputs": ["tilt"],
        },
        ("omega_1", "omega_2", "C13", "C23", "C33"),
        ("I1", "I3", "m", "g", "r3", "omega_3"),
        ["tau_3 = 0", "I1 == I2", "omega_3"],
    ),
    "spinner without the cyclic angles": (
        {"model": "spinner", "body": WHEEL, "outputs": ["theta"]},
        ("theta", "theta_dot", "psi_dot"),
        ("I1", "I2", "C"),
        ["M1 = 0, M2 = 0, M3 = 0", "psi, phi", "C"],
    ),
    "spinner with its spin angle": (
        {"model": "spinner", "body": WHEEL, "outputs": ["phi"]},
        ("theta", "phi", "theta_dot", "psi_dot"),
        ("I1", "I2", "C"),
        ["psi"],
    ),
    "spinner with a torque about the axle": (
        {
            "model": "spinner",
            "body": WHEEL,
            "outputs": ["theta"],
            "torque": {"components": [0, "-c*C", 0]},
            "parameters": {"c": 0.1},
        },
        ("theta", "theta_dot", "psi_dot", "C"),
        ("I1", "I2", "c"),
        ["M1 = 0, M3 = 0"],
    ),
    "an output of parameters alone": (
        {
            "body": MOMENTS,
            "torque": {"components": ["k", 0, 0]},
            "parameters": {"k": 0.1},
            "outputs": ["torque_1"],
        },
        ("omega_1", "omega_2", "omega_3"),
        ("I1", "I2", "I3", "k"),
        ["tau_2 = 0, tau_3 = 0"],
    ),
}


@pytest.mark.parametrize("name", SMALL)
def test_smallest_system(name):
    description, states, parameters, reasons = SMALL[name]
    scene = Scene(**description)
    system = scene.derive()
    assert system.state_names == states
    assert system.parameter_names == parameters
    text = str(scene.explain())
    assert all(reason in text for reason in reasons)


def test_operations_are_counted_down():
    """By hand, with the common products shared: the lecture's wheel, free, has 18 operations."""
    free = Scene(model="spinner", body=WHEEL, outputs=["theta"])
    heavy = Scene(
        model="spinner",
        body=WHEEL,
        torque={"components": ["-M1", "-k*C", "k*t"]},
        parameters={"M1": 1, "k": 1},
    )
    assert free.explain().after == cost(free.derive())
    assert free.explain().after < free.explain().before
    assert free.explain().after < heavy.explain().after
    saved = sum(r.saved for r in free.explain().reductions)
    assert saved == free.explain().before - free.explain().after
    euler = Scene(body=MOMENTS)
    # omega_j omega_k (I_j - I_k) / I_i: difference, two products, a quotient as two, three times
    assert euler.explain().after <= 18
    sphere = Scene(body={"moments": [2, 2, 2]}, attitude="dcm", outputs=["C11"])
    # three rows of omega_j C_k - omega_k C_j: two products, a sum and a sign
    assert sphere.explain().after <= 12


def test_reduced_rates_are_the_full_ones_with_the_assumptions_put_in():
    scene = Scene(**SMALL["top: column of the vertical alone"][0])
    full, small = rates_of(scene.full_system), rates_of(scene.derive())
    I1, I2 = sp.symbols("I1 I2", positive=True)
    for name, rate in small.items():
        assert equal(rate, full[name].subs(I2, I1))


TRAJECTORIES = {
    "top": {
        "body": {"moments": [1.0, 1.0, 0.3]},
        "attitude": "dcm",
        "torque": {"weight": TOP},
        "outputs": ["tilt", "omega_1"],
        "initial": {"omega_1": 0.1, "omega_2": 0.2, "omega_3": 20.0},
        "initial_attitude": {"sequence": "3-1-3", "radians": [0.1, 0.6, 0.2]},
    },
    "free symmetric body": {
        "body": {"solid": "cylinder", "mass": 2.0, "size": {"radius": 0.1, "length": 0.5}},
        "attitude": "3-2-1",
        "outputs": ["theta", "phi", "omega_2"],
        "initial": {"omega_1": 0.3, "omega_2": 0.2, "omega_3": 3.0},
        "initial_attitude": {"sequence": "3-2-1", "degrees": [10, 20, 30]},
    },
    "spinner": {
        "model": "spinner",
        "body": WHEEL,
        "torque": {"components": ["-M1*cos(theta)", 0, 0]},
        "parameters": {"M1": 0.5},
        "outputs": ["theta", "Omega", "axle_3"],
        "initial": {
            "theta": 0.3,
            "psi": 0,
            "phi": 0,
            "theta_dot": 0,
            "psi_dot": 0.9,
            "Omega": 20.0,
        },
    },
    "driven body": {
        "body": {"matrix": [[2, 0.1, 0.2], [0.1, 2.5, -0.3], [0.2, -0.3, 3]]},
        "attitude": "quaternion",
        "torque": {"components": ["k*sin(3*t)", "-k*omega_2", "u"]},
        "parameters": {"k": 0.4},
        "inputs": {"u": 0.1},
        "outputs": ["omega_3", "T"],
        "initial": {"omega_1": 0.3, "omega_2": 0.2, "omega_3": 1.0},
        "initial_attitude": {"quaternion": [0.5, 0.5, 0.5, 0.5]},
    },
    "satellite": {
        "body": {"moments": [7.0, 7.0, 12.0]},
        "attitude": "quaternion",
        "torque": {"gravity_gradient": {"orbital_rate": 0.5}},
        "outputs": ["tilt", "omega_3"],
        "initial": {"omega_1": 0.1, "omega_2": 0.2, "omega_3": 0.5},
        "initial_attitude": {"sequence": "3-2-1", "degrees": [10, 5, 0]},
    },
}


def run(system, scene, t_end=2.0):
    start = {**scene_start(scene), **scene_constants(scene)}
    compiled = codegen.compile(system, "numpy")
    result = codegen.simulate(
        compiled,
        {n: start[n] for n in system.state_names},
        (0.0, t_end),
        {n: start[n] for n in system.parameter_names},
        method="scipy:DOP853",
        rtol=1e-11,
        t_eval=np.linspace(0, t_end, 21),
        inputs={n: scene.inputs[n].value for n in system.input_names},
    )
    assert result.success
    return result


def scene_start(scene):
    from eom.scenes import start

    return start.states(scene, scene.full_system)


def scene_constants(scene):
    from eom.scenes import start

    return start.constants(scene)


@pytest.mark.parametrize("name", every(2, TRAJECTORIES))
def test_reduced_system_moves_as_the_full_one(name):
    scene = Scene(**TRAJECTORIES[name])
    small, full = scene.derive(), scene.full_system
    a, b = run(small, scene), run(full, scene)
    common = [n for n in scene.outputs if n not in small.parameter_names]
    assert common
    for output in common:
        scale = 1 + np.abs(b[output]).max()
        assert np.allclose(a[output], b[output], rtol=0, atol=2e-8 * scale)
        assert np.ptp(b[output]) > 1e-3 * scale
    assert all(d.relative < 1e-7 for d in a.drift.values())
    assert len(small.states) <= len(full.states)


def test_initial_values_come_from_outputs_angles_and_names():
    scene = Scene(**TRAJECTORIES["spinner"])
    C = 20.0 + 0.9 * math.sin(0.3)
    assert scene.parameter_values()["C"] == pytest.approx(C, rel=1e-15)
    top = Scene(**TRAJECTORIES["top"])
    assert top.initial_values()["C33"] == pytest.approx(math.cos(0.6), rel=1e-14)
    body = Scene(**TRAJECTORIES["free symmetric body"])
    assert body.initial_values()["theta"] == pytest.approx(math.radians(20), rel=1e-15)
    assert body.parameter_values()["I1"] == pytest.approx(2 * (3 * 0.1**2 + 0.5**2) / 12)


def test_solid_as_a_spinner_turns_its_axis_to_the_axle():
    solid = {"solid": "cylinder", "mass": 3.0, "size": {"radius": 0.2, "length": 0.1}}
    values = Scene(model="spinner", body=solid, initial={"C": 1}).parameter_values()
    assert values["I2"] == pytest.approx(3 * 0.2**2 / 2)
    assert values["I1"] == pytest.approx(3 * (3 * 0.2**2 + 0.1**2) / 12)


@pytest.mark.parametrize("centre", [(0.0, 0.0, 1.0), (0.3, 0.0, 0.4), (0.1, -0.2, 0.5)])
def test_inertia_of_a_solid_under_its_weight_is_about_the_fixed_point(centre):
    """Its energy in turning is that of its centre of mass and that of turning about this."""
    cylinder = {"solid": "cylinder", "mass": 2.0, "size": {"radius": 0.1, "length": 0.6}}
    weight = {"weight": {"mass": 2.0, "centre_of_mass": centre}}
    scene = Scene(body=cylinder, torque=weight, attitude="quaternion")
    known = start.constants(scene)
    across = 2 * (0.1**2 / 4 + 0.6**2 / 12)
    central = np.diag([across, across, 2 * 0.1**2 / 2])
    J = np.diag([known.get(f"I{k}", known.get(f"J{k}{k}")) for k in (1, 2, 3)])
    for i, j in ((1, 2), (1, 3), (2, 3)):
        J[i - 1, j - 1] = J[j - 1, i - 1] = known.get(f"J{i}{j}", 0.0)
    for omega in np.eye(3)[:, None] + np.eye(3)[None]:
        for w in omega:
            moving = 2 * np.sum(np.cross(w, centre) ** 2) / 2 + w @ central @ w / 2
            assert w @ J @ w / 2 == pytest.approx(moving, rel=1e-14)
    assert set(known) >= set(scene.full_system.parameter_names)


def test_user_parameter_may_be_called_like_an_unused_torque_component():
    scene = Scene(
        body=MOMENTS,
        torque={"components": ["tau_3", 0, 0]},
        parameters={"tau_3": 0.5},
        initial={"omega_1": 0, "omega_2": 0, "omega_3": 1},
    )
    assert run(scene.derive(), scene).success


def guard_of(scene):
    return codegen.compile(scene.derive(), "numpy").guard


def test_assumptions_are_tested_on_numbers():
    """Values for what was left out are refused if they contradict the reason."""
    scene = Scene(body={"moments": [2.0, 2.0, 1.0]})
    guard = guard_of(scene)
    guard.check({"I1": 2.0, "I3": 1.0, "omega_3": 1.0})
    for values in ({"I1": 2.0, "I2": 2.1}, {"tau_2": 0.1}, {"I1": 2.0, "I3": 4.5}, {"J12": 0.1}):
        with pytest.raises(AssumptionError):
            guard.check(values)
    names = {a.name for a in scene.derive().assumptions}
    assert {"rigid", "principal_axes", "torque_free", "I1 == I2", "constant_omega_3"} <= names


def test_spinner_assumptions_are_tested_on_numbers():
    scene = Scene(
        model="spinner", body=WHEEL, torque={"components": ["-M1", 0, 0]}, parameters={"M1": 1}
    )
    guard = guard_of(scene)
    guard.check({"M1": 5.0, "M2": 0.0, "I1": 0.06, "I3": 0.06})
    for values in ({"M2": 0.1}, {"I1": 0.06, "I3": 0.07}, {"I1": 0.05, "I2": 0.12}):
        with pytest.raises(AssumptionError):
            guard.check(values)


RIGID = {"body": MOMENTS}
QUATERNION = {**RIGID, "attitude": "quaternion"}
STILL = {"omega_1": 0, "omega_2": 0, "omega_3": 0}
IDENTITY = {f"C{i}{j}": float(i == j) for i in (1, 2, 3) for j in (1, 2, 3)}

# name: (scene, parts of what, where and hint that must appear)
UNUSED = {"components": [0, 0, 0]}
BAD = {
    "key of the scene": ({**RIGID, "atitude": "dcm"}, "unknown key 'atitude'", "", "attitude"),
    "key called self": ({**RIGID, "self": 1}, "unknown key 'self'", "", ""),
    "key of the body": ({"body": {"moment": [1, 2, 2]}}, "moment", "body.moment", "moments"),
    "key of the torque": (
        {**QUATERNION, "torque": {"gravity_gradiant": {}}},
        "gravity_gradiant",
        "torque",
        "gravity_gradient",
    ),
    "key of the weight": (
        {**QUATERNION, "torque": {"weight": {"mass": 1, "center_of_mass": [0, 0, 1]}}},
        "center_of_mass",
        "torque.weight",
        "centre_of_mass",
    ),
    "key of a parameter": (
        {**RIGID, "parameters": {"k": {"value": 1, "unti": "s"}}},
        "unti",
        "parameters.k",
        "unit",
    ),
    "key of the integration": (
        {**RIGID, "integration": {"tend": 1}},
        "tend",
        "integration",
        "t_end",
    ),
    "key of the attitude": (
        {**QUATERNION, "initial_attitude": {"radian": [0, 0, 0]}},
        "radian",
        "initial_attitude",
        "radians",
    ),
    "no body": ({}, "missing key 'body'", "body", ""),
    "model": ({**RIGID, "model": "spiner"}, "spinner", "model", ""),
    "output": ({**RIGID, "outputs": ["omega1"]}, "unknown output 'omega1'", "outputs", "omega_1"),
    "output of another attitude": (
        {**QUATERNION, "outputs": ["theta"]},
        "unknown output 'theta'",
        "outputs",
        "",
    ),
    "initial name": ({**RIGID, "initial": {"omga_1": 1}}, "'omga_1'", "initial", "omega_1"),
    "attitude": ({**RIGID, "attitude": "quaternions"}, "quaternions", "attitude", "quaternion"),
    "attitude of a spinner": (
        {"model": "spinner", "body": WHEEL, "attitude": "dcm"},
        "3-1-2",
        "attitude",
        "",
    ),
    "name in a formula": (
        {**RIGID, "torque": {"components": ["omega_1*kk", 0, 0]}, "parameters": {"k": 1}},
        "unknown name 'kk'",
        "components, number 1",
        "k",
    ),
    "syntax of a formula": (
        {**RIGID, "torque": {"components": [0, "1 +", 0]}},
        "expected",
        "number 2",
        "",
    ),
    "division by zero": (
        {**RIGID, "torque": {"components": [0, 0, "1/0"]}},
        "division by zero",
        "number 3",
        "",
    ),
    "code in a formula": (
        {**RIGID, "torque": {"components": ["__import__('os')", 0, 0]}},
        "cannot be read",
        "number 1",
        "",
    ),
    "two components": (
        {**RIGID, "torque": {"components": [1, 2]}},
        "too few values",
        "torque.components",
        "",
    ),
    "negative moment": ({"body": {"moments": [1, -2, 2]}}, "I2 is not positive", "[body]", ""),
    "zero moment": ({"body": {"moments": [0, 2, 2]}}, "I1 is not positive", "[body]", ""),
    "impossible moments": ({"body": {"moments": [1, 2, 4]}}, "I3 exceeds", "[body]", ""),
    "impossible spinner": (
        {"model": "spinner", "body": {"moments": [1, 2.5]}},
        "I2 exceeds",
        "[body]",
        "",
    ),
    "two moments": ({"body": {"moments": [1, 2]}}, "number of moments", "[body] moments", ""),
    "three moments of a spinner": (
        {"model": "spinner", "body": MOMENTS},
        "number of moments",
        "[body] moments",
        "",
    ),
    "infinite moment": ({"body": {"moments": [1, 2, math.inf]}}, "finite", "body.moments.2", ""),
    "moments in words": (
        {"body": {"moments": ["one", 2, 2]}},
        "a number in kg m^2, or one with a unit",
        "body.moments.0",
        "",
    ),
    "moments and matrix": (
        {"body": {**MOMENTS, "matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}},
        "exactly one description",
        "[body]",
        "",
    ),
    "no description": ({"body": {}}, "exactly one description", "[body]", ""),
    "asymmetric matrix": (
        {"body": {"matrix": [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]}},
        "not symmetric",
        "[body] matrix",
        "",
    ),
    "indefinite matrix": (
        {"body": {"matrix": [[1, 3, 0], [3, 1, 0], [0, 0, 1]]}},
        "positive definite",
        "[body] matrix",
        "",
    ),
    "impossible matrix": (
        {"body": {"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 3]]}},
        "triangle inequality",
        "[body] matrix",
        "signs",
    ),
    "flat matrix": ({"body": {"matrix": [[1, 0], [0, 1]]}}, "too few values", "body.matrix", ""),
    "matrix of a spinner": (
        {"model": "spinner", "body": {"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}},
        "symmetric",
        "[body] matrix",
        "moments",
    ),
    "solid": ({"body": {"solid": "cilinder", "mass": 1}}, "'cilinder'", "[body] solid", "cylinder"),
    "solid without mass": ({"body": {"solid": "sphere"}}, "mass", "[body] mass", ""),
    "solid with wrong sizes": (
        {"body": {"solid": "cylinder", "mass": 1, "size": {"radius": 1, "height": 1}}},
        "sizes of a cylinder",
        "[body] size",
        "",
    ),
    "negative size": (
        {"body": {"solid": "sphere", "mass": 1, "size": {"radius": -1}}},
        "greater than 0",
        "body.size.radius",
        "",
    ),
    "inside out": (
        {
            "body": {
                "solid": "hollow cylinder",
                "mass": 1,
                "size": {"inner_radius": 2, "outer_radius": 1, "length": 1},
            }
        },
        "inner radius",
        "[body] size",
        "",
    ),
    "box as a spinner": (
        {
            "model": "spinner",
            "body": {"solid": "box", "mass": 1, "size": {"a": 1, "b": 1.1, "c": 1}},
        },
        "symmetric about its axle",
        "[body] solid",
        "",
    ),
    "mass beside moments": ({"body": {**MOMENTS, "mass": 1}}, "belong to a solid", "[body]", ""),
    "torques about two points": (
        {**QUATERNION, "torque": {"gravity_gradient": {"orbital_rate": 1}, "weight": TOP}},
        "about different points",
        "torque",
        "on an orbit",
    ),
    "parameter called like one of the weight": (
        {
            **QUATERNION,
            "torque": {"weight": TOP, "components": ["g", 0, 0]},
            "parameters": {"g": 1},
        },
        "'g' is used twice",
        "[parameters]",
        "",
    ),
    "parameter called like a size": (
        {
            **QUATERNION,
            "body": {"solid": "sphere", "mass": 2.0, "size": {"radius": 0.1}},
            "torque": {"components": ["radius", 0, 0]},
            "parameters": {"radius": 1},
        },
        "'radius' is used twice",
        "[parameters]",
        "",
    ),
    "weight's offset that is zero in a formula": (
        {**QUATERNION, "torque": {"weight": TOP, "components": ["r1", 0, 0]}},
        "unknown name 'r1'",
        "[torque] components, number 1",
        "r3",
    ),
    "unknown name at the start": (
        {**RIGID, "initial": {"omega_1": "2*I4"}},
        "unknown name 'I4'",
        "[initial] omega_1",
        "I1",
    ),
    "parameter that nothing uses": (
        {**RIGID, "initial": {"omega_1": "1/I2"}, "parameters": {"k": 1}},
        "no formula uses 'k'",
        "[parameters]",
        "[initial]",
    ),
    "masses of a solid and its weight": (
        {
            **QUATERNION,
            "body": {"solid": "sphere", "mass": 2.0, "size": {"radius": 0.1}},
            "torque": {"weight": TOP},
        },
        "different masses",
        "[torque] weight",
        "",
    ),
    "weight without attitude": (
        {**RIGID, "torque": {"weight": TOP}},
        "depends on attitude",
        "attitude",
        "quaternion",
    ),
    "weight of a spinner": (
        {"model": "spinner", "body": WHEEL, "torque": {"weight": TOP}},
        "on its axle b2",
        "[torque] weight: centre_of_mass",
        "",
    ),
    "orbit of a spinner": (
        {"model": "spinner", "body": WHEEL, "torque": {"gravity_gradient": {"orbital_rate": 1}}},
        "torque components and weight",
        "[torque]",
        "",
    ),
    "orbital rate": (
        {**QUATERNION, "torque": {"gravity_gradient": {"orbital_rate": 0}}},
        "greater than 0",
        "torque.gravity_gradient.orbital_rate",
        "",
    ),
    "quaternion off unit": (
        {**QUATERNION, "initial_attitude": {"quaternion": [1, 0.1, 0, 0]}},
        "unit norm",
        "[initial_attitude]",
        "",
    ),
    "three numbers of a quaternion": (
        {**QUATERNION, "initial_attitude": {"quaternion": [1, 0, 0]}},
        "too few values",
        "initial_attitude.quaternion",
        "",
    ),
    "two attitudes": (
        {**QUATERNION, "initial_attitude": {"radians": [0, 0, 0], "degrees": [0, 0, 0]}},
        "exactly one",
        "[initial_attitude]",
        "",
    ),
    "unknown sequence": (
        {**QUATERNION, "initial_attitude": {"sequence": "3-1-1", "radians": [0, 0, 0]}},
        "'3-1-1'",
        "[initial_attitude]",
        "3-1",
    ),
    "C keyword": ({**RIGID, "parameters": {"double": 1}}, "reserved", "[parameters]", "double_0"),
    "Python keyword": ({**RIGID, "inputs": {"lambda": 1}}, "reserved", "[inputs]", "lambda_0"),
    "function name": ({**RIGID, "parameters": {"sin": 1}}, "reserved", "[parameters]", "sin_0"),
    "time": ({**RIGID, "parameters": {"t": 1}}, "reserved", "[parameters]", "t_0"),
    "Greek name": (
        {**RIGID, "parameters": {"ω": 1}},
        "cannot be used",
        "[parameters]",
        "write omega",
    ),
    "primed name": (
        {**RIGID, "parameters": {"x'": 1}},
        "cannot be used",
        "[parameters]",
        "write x_dot",
    ),
    "doubly primed name": (
        {**RIGID, "parameters": {"θ''": 1}},
        "cannot be used",
        "[parameters]",
        "theta_ddot",
    ),
    "empty name": ({**RIGID, "parameters": {"": 1}}, "cannot be used", "[parameters]", "letters"),
    "long name": ({**RIGID, "parameters": {"k" * 65: 1}}, "cannot be used", "[parameters]", ""),
    "state as a parameter": (
        {**RIGID, "torque": UNUSED, "parameters": {"omega_1": 1}},
        "used twice",
        "[parameters]",
        "",
    ),
    "moment as a parameter": (
        {**RIGID, "torque": UNUSED, "parameters": {"I1": 1}},
        "used twice",
        "[parameters]",
        "",
    ),
    "internal name as a parameter": (
        {**RIGID, "torque": UNUSED, "parameters": {"torque_1": 1}},
        "used twice",
        "[parameters]",
        "",
    ),
    "parameter without a formula": (
        {**RIGID, "parameters": {"k": 1}},
        "no formula uses 'k'",
        "",
        "",
    ),
    "parameter that no formula uses": (
        {**RIGID, "torque": {"components": ["a", 0, 0]}, "parameters": {"a": 1, "k": 1}},
        "no formula uses 'k'",
        "[parameters]",
        "",
    ),
    "truth as a number": ({**RIGID, "torque": {"components": [True, 0, 0]}}, "a formula", "", ""),
    "moment of a spinner as a parameter": (
        {"model": "spinner", "body": WHEEL, "torque": UNUSED, "parameters": {"I3": 1}},
        "used twice",
        "[parameters]",
        "",
    ),
    "parameter and input": (
        {**RIGID, "torque": UNUSED, "parameters": {"k": 1}, "inputs": {"k": 1}},
        "used twice",
        "[inputs]",
        "",
    ),
    "parameter in words": ({**RIGID, "parameters": {"k": "big"}}, "", "parameters.k", ""),
    "parameter without end": (
        {**RIGID, "parameters": {"k": math.nan}},
        "finite",
        "parameters.k",
        "",
    ),
    "parameter beyond double": (
        {**RIGID, "parameters": {"k": 10**400}},
        "number",
        "parameters.k",
        "",
    ),
    "zero end": ({**RIGID, "integration": {"t_end": 0}}, "end time is zero", "t_end", ""),
    "end not a number": (
        {**RIGID, "integration": {"t_end": math.nan}},
        "finite",
        "integration.t_end",
        "",
    ),
    "endless": ({**RIGID, "integration": {"t_end": math.inf}}, "finite", "integration.t_end", ""),
    "end in words": (
        {**RIGID, "integration": {"t_end": "soon"}},
        "number",
        "integration.t_end",
        "",
    ),
    "zero tolerance": ({**RIGID, "integration": {"rtol": 0}}, "greater", "integration.rtol", ""),
    "one point": ({**RIGID, "integration": {"points": 1}}, "2 or more", "integration.points", ""),
    "part of a point": (
        {**RIGID, "integration": {"points": 2.5}},
        "a whole number",
        "integration.points",
        "",
    ),
    "body is a number": ({"body": 3}, "a table", "body", ""),
}


def check_error(error, what, where, hint):
    text = str(error)
    assert type(error) is InputError
    assert what in f"{error.what}; expected {error.expected}"
    assert where in error.where
    assert hint in error.hint
    assert text.count("where:") == 1
    assert text.count("got:") <= 1
    assert "Value error" not in text
    assert "pydantic" not in text
    assert len(text) < 1200


@pytest.mark.parametrize("name", BAD)
def test_mistake_gives_one_clear_error(name):
    description, what, where, hint = BAD[name]
    with pytest.raises(InputError) as caught:
        Scene(**description)
    check_error(caught.value, what, where, hint)


def written(tmp_path, text, name="scene.toml"):
    file = tmp_path / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return file


@pytest.mark.parametrize(
    ("text", "what", "where"),
    [
        ("[body]\nmoments = [1, -2, 2]", "I2 is not positive", "[body]"),
        ("[body]\nmoment = [1, 2, 2]", "unknown key 'moment'", "body.moment"),
        ("[body\n", "not a valid TOML file", ""),
        ("[body]\nmoments = [1, 2, 2]\nmoments = [1, 2, 2]", "not a valid TOML file", ""),
        ("a = " + "[" * 5000, "not a valid TOML file", ""),
        ("a = " + "9" * 5000, "not a valid TOML file", ""),
        (b"\xff\xfe", "cannot be read", ""),
        (b"\0", "not a valid TOML file", ""),
        ("", "missing key 'body'", "body"),
        ("#" * (MAX_FILE_BYTES + 1), "too large", ""),
        ("self = 1\n[body]\nmoments = [1, 2, 2]", "unknown key 'self'", "self"),
        ("[body]\nmoments = 2026-01-01", "", "body.moments"),
    ],
)
def test_mistake_in_a_file_names_the_file_and_the_key(tmp_path, text, what, where):
    file = written(tmp_path, text)
    with pytest.raises(InputError) as caught:
        Scene.from_toml(file)
    check_error(caught.value, what, str(file), "")
    assert where in caught.value.where.removeprefix(str(file))


def test_missing_file_offers_its_neighbours(tmp_path):
    written(tmp_path, "", "wheel.toml")
    for name, hint in (("whel.toml", "wheel.toml"), ("no/folder.toml", ""), ("a\0b.toml", "")):
        with pytest.raises(InputError, match="no such scene file") as caught:
            Scene.from_toml(tmp_path / name)
        assert hint in caught.value.hint
    with pytest.raises(InputError, match="no such scene file") as caught:
        Scene.from_toml(tmp_path)
    assert (caught.value.got, caught.value.hint) == ("a folder", "known names: wheel.toml")
    with pytest.raises(InputError, match="no such scene file") as caught:
        Scene.from_toml(tmp_path / "no" / "folder.toml")
    assert "eom list" in caught.value.hint


def test_file_gives_its_name_to_scene_and_system(tmp_path):
    scene = Scene.from_toml(written(tmp_path, "[body]\nmoments = [1, 2, 2]", "cube.toml"))
    assert scene.name == "cube"
    assert scene.body.moments == (1.0, 2.0, 2.0)
    assert scene.derive().name == "cube"


def test_ready_scene_with_a_wrong_name():
    with pytest.raises(InputError, match="bycicle") as caught:
        Scene.ready("bycicle-wheel")
    assert "bicycle-wheel" in caught.value.hint


LATE = {
    "missing start": ({**RIGID, "initial": {"omega_1": 1}}, "omega_2, omega_3", "[initial]"),
    "output that fixes nothing": (
        {**RIGID, "initial": {**STILL, "H": 1}},
        "does not determine",
        "[initial]",
    ),
    "output with two unknowns": (
        {**RIGID, "initial": {"omega_1": 1, "T": 1}},
        "does not determine",
        "[initial]",
    ),
    "output that is not linear": (
        {**RIGID, "initial": {"omega_1": 1, "omega_2": 1, "T": 5}},
        "does not determine",
        "[initial]",
    ),
    "state through an output that does not feel it": (
        {
            "model": "spinner",
            "body": WHEEL,
            "initial": {"theta": 0.0, "psi": 0, "phi": 0, "theta_dot": 0, "C": 1, "Omega": 1},
        },
        "does not determine",
        "[initial]",
    ),
    "quaternion in parts": (
        {**QUATERNION, "initial": {**STILL, "q0": 1, "q1": 0.1, "q2": 0, "q3": 0}},
        "no rotation",
        "[initial]",
    ),
    "direction cosines": (
        {**RIGID, "attitude": "dcm", "initial": {**STILL, **IDENTITY, "C12": 0.1}},
        "no rotation",
        "[initial]",
    ),
    "attitude given twice": (
        {**QUATERNION, "initial": {**STILL, "q0": 1}, "initial_attitude": {"radians": [0, 0, 0]}},
        "given twice",
        "[initial]",
    ),
    "attitude in other coordinates": (
        {
            **RIGID,
            "attitude": "3-2-1",
            "initial": STILL,
            "initial_attitude": {"sequence": "3-1-3", "radians": [0, 0, 0]},
        },
        "other coordinates",
        "[initial_attitude]",
    ),
}


@pytest.mark.parametrize("name", LATE)
def test_mistake_in_the_start_gives_one_clear_error(name):
    description, what, where = LATE[name]
    scene = Scene(**description)
    with pytest.raises(InputError) as caught:
        scene.initial_values()
    check_error(caught.value, what, where, "")


def test_missing_value_of_a_frozen_state_is_named():
    scene = Scene(body={"moments": [2.0, 2.0, 1.0]}, initial={"omega_1": 1, "omega_2": 1})
    with pytest.raises(InputError, match="omega_3"):
        scene.parameter_values()


def test_component_numbers_are_exact():
    system = Scene(body=MOMENTS, torque={"components": [0.1, 0, 0]}).derive()
    assert sp.Rational(1, 10) in system.rates[0].atoms(sp.Rational)
    assert not any(r.atoms(sp.Float) for r in system.rates)


def test_scenes_are_frozen_values():
    a, b = Scene(**RIGID), Scene(**RIGID)
    assert a == b
    assert hash(a) == hash(b)
    with pytest.raises(ValueError, match="frozen"):
        a.attitude = "dcm"


def test_same_scene_gives_the_same_system():
    a, b = (Scene(**SMALL["top: column of the vertical alone"][0]).derive() for _ in range(2))
    assert a == b
    assert str(a.rates) == str(b.rates)


OTHER = {
    "full inertia": {
        "body": {"matrix": [[2, 0.1, 0], [0.1, 2.5, 0], [0, 0, 3]]},
        "attitude": "dcm",
        "torque": {"gravity_gradient": {"orbital_rate": 1.0}},
    },
    "angles": {
        "body": {"moments": [1, 2, 2.5]},
        "attitude": "3-1-3",
        "torque": {"components": ["-k*omega_1*t", 0, 0]},
        "parameters": {"k": 1},
    },
}


@pytest.mark.parametrize("name", [*catalogue.single(), *OTHER])
def test_no_parameter_can_take_a_name_of_the_model(name):
    """Whatever a model calls its definitions and outputs is refused as a parameter's name."""
    from eom.scenes.assembly import MODEL_NAMES

    scene = Scene(**OTHER[name]) if name in OTHER else Scene.ready(name)
    system = scene.full_system
    named = {*system.output_names, *(d.name for d in system.definitions)}
    shown = {n for a in system.angles for n in a.names}
    assert {n for n in named if not n.startswith("C_column")} <= MODEL_NAMES | shown


def test_no_parameter_can_take_the_name_of_an_angle_that_is_shown():
    scene = {"body": {"moments": (1, 2, 2.5)}, "torque": {"components": (n := "psi", 0, 0)}}
    with pytest.raises(InputError, match="used twice"):
        Scene(**scene, attitude="3-2-1", integrate="quaternion", parameters={n: 1.0})
