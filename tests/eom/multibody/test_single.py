"""Scenes of one body as trees: their closed forms against the scene's own equations."""

import random

import mpmath
import pytest
import sympy as sp

import eom
from eom.errors import InputError
from eom.exact.identity import equal
from eom.kinematics.coordinates import rotation_sequence
from eom.kinematics.frames import vector
from eom.mechanics.rigidbody import OMEGA
from eom.multibody import closed_form, lagrangian, linearised, routh, stability, steady_motion
from eom.multibody.files.single import single_tree

SPUN = {
    "model": "rigid body",
    "attitude": "quaternion",
    "body": {"matrix": [[3.0, 0.2, -0.1], [0.2, 4.0, 0.3], [-0.1, 0.3, 5.0]]},
    "torque": {"components": ("-k*omega_1", "k*omega_2*omega_3", "M")},
    "parameters": {"k": 0.3, "M": 0.2},
}
HEAVY = {
    "model": "rigid body",
    "attitude": "quaternion",
    "body": {"moments": (3.0, 4.0, 5.0)},
    "torque": {
        "weight": {"mass": 1.2, "centre_of_mass": (0.1, 0.0, 0.2)},
        "components": ("-k*omega_1", "0", "k*omega_2"),
    },
    "parameters": {"k": 0.3},
}


def second_derivatives(scene, sequence, q, rates, numbers):
    """The accelerations of the angles by the scene's own system: the rate of K(q) omega."""
    system = scene.in_attitude(sequence).full_system
    angles = rotation_sequence(sequence)
    w, psi = OMEGA.components, angles.angles
    known = dict(zip(psi, q, strict=True))
    omega = angles.angular_velocity(rates).components
    values = {s: sp.sympify(x).subs(known).evalf(40) for s, x in zip(w, omega, strict=True)}
    put = {**known, **values} | {p.symbol: numbers[p.name] for p in system.parameters}
    right = sp.Matrix([sp.N(system.expand(x).subs(put), 40) for x in system.rates])
    if system.mass_matrix is not None:
        right = sp.N(sp.Matrix(system.mass_matrix).subs(put), 40).LUsolve(right)
    moved = dict(zip(system.state_names, right, strict=True))
    return [
        sp.N(sum(sp.diff(e, s).subs(put) * moved[s.name] for s in (*w, *psi)), 30)
        for e in angles.rates(vector("B", w))
    ]


def test_a_heavy_top_has_the_effective_potential_of_the_books():
    """Goldstein, Classical Mechanics (2002), sect. 5.7; upright it sleeps where I3^2 w^2 > 4 I1 m g l."""
    tree = single_tree(eom.load_scene("heavy-top"))
    I1, I3 = sp.symbols("I1 I3", positive=True)
    m, g, r3, theta, p, b = sp.symbols("m g r3 theta p_psi p_phi")
    found = routh(lagrangian(tree)).effective_potential
    expected = m * g * r3 * sp.cos(theta) + b**2 / (2 * I3)
    expected += (p - b * sp.cos(theta)) ** 2 / (2 * I1 * sp.sin(theta) ** 2)
    assert equal(by_name(found), by_name(expected))
    tree = single_tree(eom.load_scene("heavy-top"), "1-2-3")
    sleeping = steady_motion(lagrangian(tree), {"psi": 0, "theta": 0})
    conditions = [str(by_name(c)) for c in stability(linearised(sleeping)).conditions]
    assert "I1**2*I3**2*phi_dot**2*(-4*I1*g*m*r3 + I3**2*phi_dot**2)" in conditions


def by_name(e):
    return e.xreplace({s: sp.Symbol(s.name) for s in e.free_symbols})


@pytest.mark.parametrize("scene", ["bicycle-wheel", "lecture-wheel"])
def test_a_spinner_moves_as_its_scene_does(scene):
    """The second derivative of theta, and the constants that C and psi have."""
    given = eom.load_scene(scene).as_stated()
    tree = single_tree(given)
    form = closed_form(tree, rates=True)
    system = given.full_system
    theirs = dict(zip(system.state_names, map(system.expand, system.rates), strict=True))
    spin = sp.Symbol("phi_dot", real=True)
    psi_dot, theta = sp.symbols("psi_dot theta", real=True)
    put = {sp.Symbol("C", real=True): spin + psi_dot * sp.sin(theta)}
    ours = dict(zip((u.name for u in form.speeds), form.solved, strict=True))
    for name in ("theta_dot", "psi_dot"):
        assert equal(by_name(ours[name]), by_name(theirs[name].xreplace(put))), name


def test_what_no_tree_has_is_refused():
    with pytest.raises(InputError, match="gravity gradient"):
        lagrangian(single_tree(eom.load_scene("gravity-gradient-satellite")))
    with pytest.raises(InputError, match="a spinner has its own angles"):
        single_tree(eom.load_scene("bicycle-wheel"), "3-1-3")


@pytest.mark.parametrize("sequence", ["3-1-3", "1-2-3", "3-1-2"])
@pytest.mark.parametrize("data", [SPUN, HEAVY])
def test_the_tree_moves_as_the_scene_does(data, sequence):
    scene = eom.Scene(**data)
    tree = single_tree(scene, sequence)
    form = closed_form(tree, "kane", rates=True)
    draw = random.Random(sequence)
    q, rates = ([sp.Rational(draw.randint(3, 12), 10) for _ in range(3)] for _ in range(2))
    numbers = {n: sp.Rational(str(x)) for n, x in scene.numbers.items()}
    state = dict(zip((c.symbol for c in form.coordinates), q, strict=True))
    state |= dict(zip((u.symbol for u in form.speeds), rates, strict=True))
    free = form.mass_matrix.free_symbols | form.forcing.free_symbols
    put = {**state, **{s: numbers[s.name] for s in free if s.name in numbers}}
    M, f = (sp.N(x.subs(put), 30) for x in (form.mass_matrix, form.forcing))
    assert not M.free_symbols | f.free_symbols
    theirs = second_derivatives(scene, sequence, q, rates, numbers)
    with mpmath.workdps(30):
        for a, b in zip(M.LUsolve(f), theirs, strict=True):
            assert abs(a - b) < 1e-20 * (1 + abs(b))
