"""Closed forms under constraints: against each other, the numeric systems, and textbooks."""

import random
import re
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import codegen
from eom.derivations.verification import DerivationError
from eom.errors import InputError
from eom.exact.identity import equal
from eom.multibody import (
    Body,
    Distance,
    Equation,
    Joint,
    Load,
    Motion,
    Rolling,
    SpeedEquation,
    Tree,
    absolute_angles,
    closed_form,
    compare,
    derive,
    tree_page,
)
from eom.multibody.closed import METHODS
from tests.eom.multibody.bound_forms import (
    SCENES,
    A,
    J,
    Omega,
    R,
    a,
    bead,
    free_disc,
    g,
    knife_edge,
    l,
    m,
    m1,
    m2,
    m3,
    r,
    rolling_disc,
    sleigh,
    slider_crank,
    t,
    w,
)


def values_of(form, system, seed):
    """Random numbers for everything; dependent speeds as they follow."""
    generator = random.Random(seed)
    values = {q.symbol: generator.uniform(0.4, 1.1) for q in (*system.states, *system.parameters)}
    values[t] = 0.3
    prescribed = {}
    for d in form.prescribed:
        prescribed[d.symbol] = float(d.expression.xreplace({**values, **prescribed}))
    values |= prescribed
    for d in (*form.placed, *form.followers):
        values[d.symbol] = float(d.expression.xreplace(values))
    return values


def numbers(system, values):
    """Rates and outputs by the generated code."""
    compiled = codegen.compile(system, "numpy")
    x = np.array([values[q.symbol] for q in system.states])
    p = np.array([values[q.symbol] for q in system.parameters])
    args = (values[t], x, p, np.empty(0))
    return compiled.rhs(*args), compiled.outputs(*args)


@pytest.mark.parametrize("name", SCENES)
def test_accelerations_and_multipliers_are_those_of_the_numeric_system(name):
    """By another way: articulated bodies, and multipliers from (J M^-1 J^T)."""
    given = SCENES[name]()
    form = compare(given).forms[0]
    system = derive(given, ["constraint_forces"], multipliers=True, invariants=False)
    for seed in range(3):
        values = values_of(form, system, seed)
        rates, outputs = numbers(system, values)
        theirs = dict(zip((q.symbol for q in system.states), rates, strict=True))
        ours = [float(x.xreplace(values)) for x in form.solved]
        expected = [theirs[u.symbol] for u in form.speeds]
        assert ours == pytest.approx(expected, rel=1e-12, abs=1e-12)
        moved = [float(x.xreplace(values)) for x in form.kinematics]
        assert moved == pytest.approx(
            [theirs[q.symbol] for q in form.coordinates], rel=1e-12, abs=1e-12
        )
        forces = dict(zip((o.symbol for o in system.outputs), outputs, strict=True))
        for d in form.reactions:
            assert float(d.expression.xreplace(values)) == pytest.approx(
                forces[d.symbol], rel=1e-11, abs=1e-12
            )


def test_a_closed_form_compiles_and_keeps_its_constraints():
    form = closed_form(slider_crank(), coordinates=absolute_angles(slider_crank()))
    p = {"r": 0.2, "l": 0.6, "m2": 1.5, "m3": 1.0, "J": 0.08, "g": 9.81}
    theta = 0.6
    pin = float(np.arcsin(-0.2 * np.sin(theta) / 0.6))
    piston = 0.2 * np.cos(theta) + 0.6 * np.cos(pin)
    start = {"theta_crank": theta, "theta_pin": pin, "q_piston": piston, "theta_crank_dot": 12.0}
    run = codegen.simulate(form.system, start, (0, 0.5), parameters=p, rtol=1e-11)
    height = 0.2 * np.sin(run["theta_crank"]) + 0.6 * np.sin(run["theta_pin"])
    assert np.abs(height).max() < 1e-9


def test_disc_as_in_textbooks():
    """Lean by moments about the contact, normal force by Newton; McDonald and McDonald, physics/0008227."""
    names = {"q_yaw": "psi", "q_lean": "theta", "q_spin": "phi"}
    form = closed_form(rolling_disc(), "kane", names=names)
    psi, theta, phi = sp.symbols("psi_dot theta_dot phi_dot", real=True)
    q = sp.Symbol("theta", real=True)
    assert [u.symbol for u in form.speeds] == [psi, theta, phi]
    assert form.common_factors == (m * r**2 / 4, m * r / 4, m * r**2 / 2)
    s, c = sp.sin(q), sp.cos(q)
    # 5/4 m r^2 theta'' = m g r sin + 3/2 m r^2 psi' phi' cos + 5/4 m r^2 psi'^2 sin cos
    lean = m * g * r * s + m * r**2 * (
        sp.Rational(3, 2) * psi * phi * c + sp.Rational(5, 4) * psi**2 * s * c
    )
    assert equal(form.mass_matrix[1, 1], sp.Rational(5, 4) * m * r**2)
    assert equal(form.forcing[1], lean)
    height = next(d for d in form.multipliers if d.symbol.name == "lambda_floor_z")
    acceleration = form.accelerations[1]
    assert equal(height.expression, m * g - m * r * (acceleration * s + theta**2 * c))


def test_the_bead_by_lagrange_with_its_normal_forces():
    """Goldstein, Classical Mechanics (2002), prob. 2.18; the radial force by Newton's law in the hoop."""
    motion = Motion((sp.Symbol("alpha", real=True),), (Omega,), (0,))
    given = replace(bead(motion), inputs=(sp.Symbol("alpha", real=True), Omega))
    form = closed_form(given, names={"q_swing": "theta"})
    theta, rate = sp.symbols("theta theta_dot", real=True)
    s, c = sp.sin(theta), sp.cos(theta)
    spin = form.prescribed[1].symbol
    assert form.prescribed[1].expression == Omega
    assert [(d.symbol.name, d.expression) for d in form.placed] == [("q_radius", R), ("q_side", 0)]
    assert equal(form.solved[0], spin**2 * s * c - g / R * s)
    radial, lateral = (d.expression for d in form.multipliers)
    assert equal(radial, -m * (R * rate**2 + R * spin**2 * s**2 + g * c))
    assert equal(lateral, 2 * m * R * spin * rate * c)
    assert form.common_factors == (R * m,)


def test_a_prescribed_rate_is_written_as_such():
    motion = Motion((A * sp.sin(w * t),))
    text = tree_page(bead(motion), "lagrange", names={"q_swing": "theta", "u_hoop": "Omega"})
    assert "Ω(t)     = A w cos(w t)" in text
    assert "R θ̈ − R sin(θ) cos(θ) Ω² + g sin(θ)" in text
    assert "q̇_hoop" not in text
    spun = Motion((Omega * t,))
    assert "Ω²" in tree_page(bead(spun), "lagrange", names={"q_swing": "theta"})


def test_chaplygin_s_sleigh():
    """m v' = m a w^2, (J + m a^2) w' = -m a v w: Bloch, Nonholonomic Mechanics and Control (2003), 1.7."""
    form = closed_form(sleigh(), "kane", names={"v_s_1": "v", "u_s": "omega"})
    v, omega = sp.symbols("v omega", real=True)
    assert equal(form.solved[0], a * omega**2)
    assert equal(form.solved[1], -m * a * v * omega / (J + m * a**2))
    assert equal(form.reactions[0].expression, m * v * omega * J / (J + m * a**2))


def test_slider_crank_over_absolute_angles():
    """sin(theta_pin) = -r/l sin(theta): the rod's rate, and the kinetic energy of all three by it."""
    given = slider_crank()
    form = closed_form(given, coordinates=absolute_angles(given))
    crank, rod = sp.symbols("theta_crank theta_pin", real=True)
    u = form.speeds[0].symbol
    follows = {d.symbol.name: d.expression for d in form.followers}
    ratio = -r * sp.cos(crank) / (l * sp.cos(rod))
    assert equal(follows["theta_pin_dot"], ratio * u)
    piston = -r * sp.sin(crank) - l * sp.sin(rod) * ratio
    assert equal(follows["u_piston"], piston * u)
    x = -r * sp.sin(crank) - l / 2 * sp.sin(rod) * ratio
    y = r * sp.cos(crank) + l / 2 * sp.cos(rod) * ratio
    inertia = J + m2 * (x**2 + y**2 + l**2 / 12 * ratio**2) + m3 * piston**2
    assert equal(form.mass_matrix[0, 0], inertia)
    assert form.bonds.idle == ("'wrist' z", "'wrist' t1", "'wrist' t2")
    assert form.bonds.divisors == (sp.cos(rod),)
    assert m1 not in form.mass_matrix.free_symbols


@pytest.mark.parametrize("method", METHODS)
def test_independent_speeds_can_be_chosen(method):
    given = slider_crank()
    angles = absolute_angles(given)
    form = closed_form(given, method, coordinates=angles, independent=["u_piston"])
    assert [u.name for u in form.speeds] == ["u_piston"]
    other = closed_form(given, method, coordinates=angles)
    slope = next(d.expression for d in other.followers if d.symbol.name == "u_piston")
    slope = sp.diff(slope, other.speeds[0].symbol)
    assert equal(form.mass_matrix[0] * slope**2, other.mass_matrix[0])


def test_a_speed_equation_with_a_rest_and_forces_over_speeds_that_follow():
    """x' = 2 y' + v0: drag on x acts on y; three methods, each by its way."""
    x, y, k = sp.symbols("u_x u_y k", real=True)
    bodies = [Body("along", 1), Body("puck", m)]
    joints = [
        Joint("x", "prismatic", "ground", "along", "x"),
        Joint("y", "prismatic", "along", "puck", "y"),
    ]
    drag = Load("puck", force=(-k * x**2, -k * y, 0))
    belt = SpeedEquation("belt", x - 2 * y - Omega)
    given = Tree("belt", bodies, joints, loads=[drag], constraints=[belt])
    form = compare(given, independent=["u_y"]).forms[0]
    assert equal(form.solved[0], (-k * y - 2 * k * (2 * y + Omega) ** 2) / (4 + 5 * m))
    rough = replace(given, loads=[Load("puck", (sp.Abs(x), 0, 0))])
    refused(lambda: closed_form(rough, independent=["u_y"]), "no polynomial")


def test_decimals_stay_decimals():
    """Also where they stand alone, and what is divided out has no numbers of theirs."""
    rim = Rolling("floor", "disc", 0.35, axis="y")
    heavy = Body("disc", 2.3, inertia=(0.05, 0.1, 0.05))
    free = Joint("disc", "free", "ground", "disc", attitude="3-1-2")
    given = Tree("disc", [heavy], [free], gravity=(0, 0, -9.81), constraints=[rim])
    for text in (tree_page(given, "all"), closed_form(given).latex()):
        assert "9.81" in text or "22.563" in text or "7.89705" in text
        assert not [n for n in re.findall(r"\d+", text) if len(n) > 8]
    assert all(f == 1 for f in closed_form(given).common_factors)


def test_names_reach_everything():
    form = closed_form(knife_edge(), names={"q_turn": "theta", "u_y": "v"})
    held = {
        s.name for e in (*form.mass_matrix, *form.forcing, *form.kinematics) for s in e.free_symbols
    }
    held |= {
        s.name for d in (*form.followers, *form.multipliers) for s in d.expression.free_symbols
    }
    assert "theta" in held
    assert not held & {"q_turn", "u_turn", "u_y"}
    assert [u.name for u in form.speeds] == ["u_x", "theta_dot"]
    assert "v" in {d.symbol.name for d in form.followers}


@pytest.mark.parametrize(
    ("style", "method"),
    [("text", "all"), ("latex", "lagrange"), ("markdown", "kane"), ("html", "newton-euler")],
)
def test_pages_show_the_constraints(style, method):
    shown = tree_page(rolling_disc(), method, style)
    assert any(letter in shown for letter in ("lambda", "λ", "&#955;", "&lambda;"))
    assert "speeds that follow" in shown
    assert shown == tree_page(rolling_disc(), method, style)


def refused(call, words):
    with pytest.raises(InputError, match=words):
        call()


def test_refusals():
    refused(lambda: closed_form(free_disc("quaternion")), "square root(.|\n)*3-1-2")
    refused(lambda: closed_form(rolling_disc(), names={"q_what": "psi"}), "unknown coordinate")
    refused(lambda: closed_form(rolling_disc(), names={"q_yaw": "q_lean"}), "taken")
    refused(lambda: closed_form(rolling_disc(), names={"q_yaw": "two words"}), "not a name")
    refused(lambda: closed_form(rolling_disc(), names={"q_yaw": "m"}), "taken")
    refused(lambda: closed_form(rolling_disc(), independent=["u_what"]), "unknown independent")
    four = ["u_x", "u_y", "u_yaw", "u_lean"]
    refused(lambda: closed_form(rolling_disc(), independent=[*four, "u_z"]), "shall be independent")
    tied = replace(rolling_disc(), constraints=())
    refused(lambda: closed_form(tied, independent=["u_x"]), "without constraints")
    far = Distance("rod", "ground", "disc", 1)
    thick = Rolling("floor", "disc", r, axis="y", half_axis=l)
    refused(lambda: closed_form(replace(tied, constraints=[thick])), "square root")
    nailed = [Equation(n, sp.Symbol(f"q_{n}", real=True) - 1) for n in "xyz"]
    yaw = [Equation(n, sp.Symbol(f"q_{n}", real=True)) for n in ("yaw", "lean", "spin")]
    refused(lambda: closed_form(replace(tied, constraints=[*nailed, *yaw])), "leave no motion")
    twice = [nailed[0], Equation("again", sp.Symbol("q_x", real=True) - 2)]
    refused(lambda: closed_form(replace(tied, constraints=twice)), "cannot be met(.|\n)*again")
    assert closed_form(replace(tied, constraints=[far])).followers


def test_constraints_that_depend_on_each_other_where_they_hold():
    """x = 0 and x y = 0: two equations, of which the second says nothing where the first holds."""
    x, y = sp.symbols("q_x q_y", real=True)
    joints = [
        Joint("x", "prismatic", "ground", "along", "x"),
        Joint("y", "prismatic", "along", "across", "y"),
        Joint("turn", "revolute", "across", "puck", "z"),
    ]
    bodies = [Body("along"), Body("across"), Body("puck", m, inertia=(J, J, J))]
    held = [Equation("line", x), Equation("cross", x * y)]
    given = Tree("puck", bodies, joints, constraints=held)
    refused(lambda: closed_form(given), "depend on each other where they hold(.|\n)*derive")
    form = closed_form(replace(given, constraints=held[:1]))
    assert [u.name for u in form.speeds] == ["u_y", "u_turn"]


def test_a_changed_coefficient_is_noticed():
    found = compare(rolling_disc())
    first, *others = found.forms
    wrong = [replace(first.multipliers[0], expression=first.multipliers[0].expression * 2)]
    forms = (replace(first, multipliers=(*wrong, *first.multipliers[1:])), *others)
    with pytest.raises(DerivationError, match="multiplier"):
        replace(found, forms=forms).checked()
    term = replace(first.terms[0], coefficient=first.terms[0].coefficient + m)
    with pytest.raises(DerivationError, match="differ in a term"):
        replace(found, forms=(replace(first, terms=(term, *first.terms[1:])), *others)).checked()
