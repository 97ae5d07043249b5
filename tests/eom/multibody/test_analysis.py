"""Symbolic analysis against textbooks: tops, hoops, discs; what is no such system is refused."""

import numpy as np
import pytest
import sympy as sp

import codegen
from eom.derivations.verification import DerivationError
from eom.errors import InputError
from eom.exact.identity import equal
from eom.multibody import (
    Body,
    Joint,
    Lagrangian,
    Motion,
    Placement,
    Tree,
    absolute_angles,
    analysis_page,
    closed_form,
    conserved_quantities,
    cyclic_coordinates,
    equations_of,
    lagrangian,
    linearised,
    routh,
    small_motion,
    stability,
    steady_motion,
)
from eom.multibody.analysis import conserved as conserved_module
from eom.multibody.analysis import steady as steady_module
from eom.multibody.analysis.tidy import condition, tidy
from tests.eom.multibody.bound_forms import (
    Omega,
    R,
    bead,
    g,
    l,
    m,
    r,
    rolling_disc,
    sleigh,
    slider_crank,
    t,
)

I1, I3, k = sp.symbols("I1 I3 k", positive=True)
theta, psi, phi, alpha, beta = sp.symbols("theta psi phi alpha beta", real=True)
theta_dot, psi_dot, phi_dot = sp.symbols("theta_dot psi_dot phi_dot", real=True)
s = sp.Symbol("s")
NAMES = {"q_yaw": "psi", "q_lean": "theta", "q_spin": "phi"}


def top(dissipation=0, forces=None):
    """The heavy top by Euler's angles: Goldstein, Classical Mechanics (2002), sec. 5.7."""
    kinetic = I1 * (theta_dot**2 + psi_dot**2 * sp.sin(theta) ** 2) / 2
    kinetic += I3 * (phi_dot + psi_dot * sp.cos(theta)) ** 2 / 2
    rates = {psi: psi_dot, theta: theta_dot, phi: phi_dot}
    potential = m * g * l * sp.cos(theta)
    return Lagrangian("top", rates, kinetic, potential, dissipation, forces or {})


def gimballed_top():
    """The same top by angles about x and y, which are regular where it is upright."""
    bodies = [Body("outer"), Body("inner"), Body("top", m, (0, 0, l), (I1, I1, I3), about="origin")]
    joints = [
        Joint("alpha", "revolute", "ground", "outer", "x"),
        Joint("beta", "revolute", "outer", "inner", "y"),
        Joint("phi", "revolute", "inner", "top", "z"),
    ]
    return Tree("gimballed_top", bodies, joints, gravity=(0, 0, -g))


def pendulum(**options):
    hinge = Joint("hinge", "revolute", "ground", "bob", "x", **options)
    return Tree("pendulum", [Body("bob", m, (0, 0, -l))], [hinge], gravity=(0, 0, -g))


def hoop():
    return lagrangian(bead(Motion(Omega * t)), names={"q_swing": "theta"})


def refused(call, words):
    with pytest.raises(InputError, match=words):
        call()


# -- cyclic coordinates and Routh ------------------------------------------------------------------


def test_momenta_of_the_top():
    """Goldstein, Classical Mechanics (2002), sec. 5.7: I1 b and I1 a."""
    found = cyclic_coordinates(top())
    assert [c.coordinate for c in found] == [psi, phi]
    about_vertical, about_axis = (c.momentum for c in found)
    spin = phi_dot + psi_dot * sp.cos(theta)
    assert equal(about_axis, I3 * spin)
    assert equal(about_vertical, I1 * psi_dot * sp.sin(theta) ** 2 + I3 * spin * sp.cos(theta))
    assert all(c.conserved for c in found)


def test_effective_potential_of_the_top():
    """Goldstein (2002), sec. 5.7: (p_psi - p_phi cos)^2 / (2 I1 sin^2) + m g l cos, p_phi^2 / (2 I3)."""
    found = routh(top())
    a, b = sp.symbols("p_psi p_phi", real=True)
    expected = (a - b * sp.cos(theta)) ** 2 / (2 * I1 * sp.sin(theta) ** 2)
    expected += b**2 / (2 * I3) + m * g * l * sp.cos(theta)
    assert found.effective_potential == expected
    assert equal(found.rates[psi], (a - b * sp.cos(theta)) / (I1 * sp.sin(theta) ** 2))
    assert found.lagrangian.kinetic == I1 * theta_dot**2 / 2
    one = routh(top(), ["phi"])
    assert one.lagrangian.coordinates == (psi, theta)


def test_damping_is_told_and_stops_the_reduction():
    found = {str(c.coordinate): c for c in cyclic_coordinates(top(k * phi_dot**2 / 2))}
    assert found["psi"].conserved
    assert not found["phi"].conserved
    assert equal(found["phi"].rate, -k * phi_dot)
    assert found["phi"].reason == "damping along phi"
    refused(
        lambda: routh(top(k * phi_dot**2 / 2), ["phi"]), "not conserved(.|\n)*damping along phi"
    )
    assert set(routh(top(k * phi_dot**2 / 2)).momenta) == {psi}
    motor = cyclic_coordinates(top(forces={phi: k}))[1]
    assert motor.reason == "an applied force along phi"
    assert motor.rate == k


def test_a_coordinate_that_drops_out_is_cyclic():
    """It stands in L, and L does not depend on it: by proof, not by looking for the symbol."""
    x, u = sp.symbols("x u", real=True)
    kinetic = m * u**2 * (sp.sin(x) ** 2 + sp.cos(x) ** 2) / 2
    assert [c.coordinate for c in cyclic_coordinates(Lagrangian("hidden", {x: u}, kinetic))] == [x]
    assert cyclic_coordinates(Lagrangian("bound", {x: u}, kinetic, k * x)) == ()


def test_routh_s_reduction_keeps_gyroscopic_terms():
    """A charge in a magnetic field, L = m v^2/2 + B x y': the potential is (p - B x)^2 / (2 m)."""
    x, y, u, v, B = sp.symbols("x y u v B", real=True)
    kinetic = m * (u**2 + v**2) / 2 + B * x * v
    found = routh(Lagrangian("charge", {x: u, y: v}, kinetic))
    assert equal(found.effective_potential, (sp.Symbol("p_y", real=True) - B * x) ** 2 / (2 * m))


def test_a_wrong_reduction_is_noticed(monkeypatch):
    from eom.multibody.analysis import cyclic

    right = cyclic._solved
    monkeypatch.setattr(cyclic, "_solved", lambda *a: {q: 2 * x for q, x in right(*a).items()})
    with pytest.raises(DerivationError):
        routh(top())


# -- steady motion and stability -------------------------------------------------------------------


def test_steady_precession_of_the_top():
    """m g l = p psi' - I1 psi'^2 cos(theta), p = I3 omega_3: Goldstein (2002), sec. 5.7."""
    found = steady_motion(top())
    (condition_,) = found.conditions
    spin = phi_dot + psi_dot * sp.cos(theta)
    expected = (I3 * spin * psi_dot - I1 * psi_dot**2 * sp.cos(theta) - m * g * l) * sp.sin(theta)
    assert equal(condition_, expected)
    solved = found.solved("phi_dot")
    assert solved.conditions == ()
    near = linearised(solved)
    assert (near.zeros, near.even) == (2, True)
    square = I1**2 * psi_dot**4 - 2 * I1 * m * g * l * psi_dot**2 * sp.cos(theta) + (m * g * l) ** 2
    assert equal(near.polynomial, s**2 + square / (I1 * psi_dot) ** 2)
    # by another way: momenta kept, the effective potential is V'' / I1 deep
    left = routh(top())
    kept = {
        c.momentum: sp.Symbol(f"p_{c.coordinate}", real=True) for c in cyclic_coordinates(top())
    }
    steady = {p: e.xreplace({phi_dot: solved.values[phi_dot]}) for e, p in kept.items()}
    depth = sp.diff(left.effective_potential, theta, 2).xreplace(steady)
    assert equal(depth / I1, square / (I1 * psi_dot) ** 2)


def test_the_sleeping_top():
    """omega_3^2 > 4 I1 m g l / I3^2: Kibble and Berkshire, Classical Mechanics (2004), ch. 12."""
    given = lagrangian(
        gimballed_top(), names={"q_alpha": "alpha", "q_beta": "beta", "q_phi": "phi"}
    )
    near = linearised(steady_motion(given, {"alpha": 0, "beta": 0}))
    verdict = stability(near)
    assert not verdict.asymptotic
    assert verdict.zeros == 1
    weaker, stronger = verdict.conditions
    assert equal(weaker, I3**2 * phi_dot**2 - 2 * I1 * m * g * l)
    assert equal(stronger, phi_dot**2 * (I3**2 * phi_dot**2 - 4 * I1 * m * g * l))


def test_bead_on_a_turning_hoop():
    """theta = 0 is stable iff Omega^2 < g/R; cos(theta) = g/(R Omega^2): Strogatz (2015), sec. 3.5."""
    given = hoop()
    (condition_,) = steady_motion(given).conditions
    assert equal(condition_, m * R * (g - R * Omega**2 * sp.cos(theta)) * sp.sin(theta))
    low = stability(linearised(steady_motion(given, {"theta": 0})))
    assert low.conditions == (g - R * Omega**2,)
    assert stability(linearised(steady_motion(given, {"theta": sp.pi}))).never
    side = linearised(steady_motion(given).solved("g"))
    assert equal(side.polynomial, s**2 + Omega**2 * sp.sin(theta) ** 2)


def test_steady_turns_of_the_disc():
    """g sin + (3/2) r phi' psi' cos + (5/4) r psi'^2 sin cos = 0: moments about the contact."""
    form = closed_form(rolling_disc(), names=NAMES)
    assert equations_of(form).occurring == (theta,)
    (found,) = steady_motion(form).conditions
    S, C = sp.sin(theta), sp.cos(theta)
    expected = (
        g * S
        + sp.Rational(3, 2) * r * phi_dot * psi_dot * C
        + sp.Rational(5, 4) * r * psi_dot**2 * S * C
    )
    assert equal(found, -m * r * expected)


def test_a_disc_rolls_upright_where_it_is_fast():
    """v^2 > g r / 3 straight on, n^2 > 4 g / (5 r) on the spot: Routh (1905), art. 244."""
    form = closed_form(rolling_disc(), "kane", names=NAMES)
    straight = stability(linearised(steady_motion(form, {"theta": 0, "psi_dot": 0})))
    assert straight.conditions == (3 * r * phi_dot**2 - g,)
    spinning = stability(linearised(steady_motion(form, {"theta": 0, "phi_dot": 0})))
    assert spinning.conditions == (5 * r * psi_dot**2 - 4 * g,)
    assert straight.zeros == spinning.zeros == 2


def test_linear_motion_is_that_of_numbers():
    """Of the turning disc: roots of the polynomial and eigenvalues of the compiled system."""
    form = closed_form(rolling_disc(), names=NAMES)
    found = linearised(steady_motion(form).solved("phi_dot"))
    p = {m: 2.0, g: 9.81, r: 0.4, theta: 0.3, psi_dot: 1.7}
    spin = float(found.about.values[phi_dot].xreplace(p))
    roots = np.roots([float(c.xreplace(p)) for c in found.coefficients])
    system = form.system
    point = {"theta": 0.3, "psi_dot": 1.7, "phi_dot": spin, "q_z": 0.4 * np.cos(0.3)}
    x = np.array([point.get(n, 0.0) for n in system.state_names])
    compiled = codegen.compile(system, "numpy")
    values = np.array([float(p[q.symbol]) for q in system.parameters])
    jacobian = np.empty((len(x), len(x)))
    for j in range(len(x)):
        step = np.zeros(len(x))
        step[j] = 1e-5
        ahead, behind = (compiled.rhs(0.0, x + d, values, np.empty(0)) for d in (step, -step))
        jacobian[:, j] = (np.asarray(ahead) - np.asarray(behind)) / 2e-5
    eigenvalues = np.linalg.eigvals(jacobian)
    for root in roots:
        assert np.abs(eigenvalues - root).min() < 1e-4 * abs(root)


def test_damped_motion_has_hurwitz_s_conditions():
    """s^3 + a s^2 + b s + c: a > 0, a b > c, c > 0, by a spring, a damper and a third state."""
    a, b, c = sp.symbols("a b c", real=True)
    found = list(steady_module._hurwitz([sp.S.One, a, b, c]))
    assert [sp.expand(x) for x in found] == [a, a * b - c, c]
    four = [sp.expand(x) for x in steady_module._interlaced([sp.S.One, a, b])]
    assert four == [1, 2, a, a, b]
    bob = pendulum(damping=k)
    verdict = stability(linearised(steady_motion(lagrangian(bob), {"q_hinge": 0})))
    assert verdict.asymptotic
    assert verdict.conditions == ()
    assert stability(linearised(steady_motion(lagrangian(bob), {"q_hinge": sp.pi}))).never


def test_chaplygin_s_sleigh_is_stable_forwards():
    """Its turning dies out as v > 0, the runner behind the centre: Bloch (2003), sec. 1.7."""
    form = closed_form(sleigh(), names={"v_s_1": "v", "u_s": "omega"})
    found = stability(linearised(steady_motion(form, {"omega": 0})))
    assert found.asymptotic
    assert found.conditions == (sp.Symbol("v", real=True),)
    assert found.zeros == 1


# -- small changes -----------------------------------------------------------------------------------


def test_small_angles_of_the_pendulum():
    given = lagrangian(pendulum(), names={"q_hinge": "theta"})
    acceleration = sp.Symbol("theta_ddot", real=True)
    (third,) = small_motion(given, 3).equations
    assert equal(third, m * l**2 * acceleration + m * g * l * (theta - theta**3 / 6))
    (first,) = small_motion(given, 2).equations
    assert equal(first, m * l**2 * acceleration + m * g * l * theta)
    (upright,) = small_motion(given, 1, {"theta": sp.pi}).equations
    assert equal(upright, m * l**2 * acceleration - m * g * l * theta)


def test_small_motion_differs_from_the_whole_by_the_next_order():
    equations = equations_of(hoop())
    for order in (1, 2, 3, 4):
        (kept,) = small_motion(equations, order).equations
        e = sp.Symbol("e", positive=True)
        moving = (*equations.occurring, *equations.speeds, *equations.accelerations)
        left = (equations.residuals[0] - kept).xreplace({q: e * q for q in moving})
        assert sp.limit(left / e**order, e, 0) == 0


# -- conserved quantities ----------------------------------------------------------------------------


def test_the_top_has_three_constants():
    found = conserved_quantities(top())
    assert [c.degree for c in found] == [1, 1, 2]
    spin = phi_dot + psi_dot * sp.cos(theta)
    assert equal(found[0].expression, spin)
    assert equal(
        found[2].expression,
        I1 * (theta_dot**2 + psi_dot**2 * sp.sin(theta) ** 2) + 2 * m * g * l * sp.cos(theta),
    )


def test_the_oscillator_in_a_plane_has_fradkin_s_tensor():
    """x'_i x'_j + k x_i x_j, and the angular momentum: Fradkin, Am. J. Phys. 33 (1965) 207."""
    x, y, u, v = sp.symbols("x y u v", real=True)
    plane = Lagrangian("plane", {x: u, y: v}, (u**2 + v**2) / 2, k * (x**2 + y**2) / 2)
    found = [c.expression for c in conserved_quantities(plane)]
    assert [sp.expand(e) for e in found] == [
        u * -y + v * x, k * x**2 + u**2, k * x * y + u * v, k * y**2 + v**2,
    ]  # fmt: skip


def test_constraints_between_speeds_and_sums_of_angles():
    energy = conserved_quantities(closed_form(rolling_disc(), names=NAMES))
    S, C = sp.sin(theta), sp.cos(theta)
    expected = (
        5 * r * theta_dot**2
        + 6 * r * (phi_dot + psi_dot * S) ** 2
        + r * psi_dot**2 * C**2
        + 8 * g * C
    )
    assert len(energy) == 1
    assert equal(energy[0].expression, expected)
    bodies = [Body("a", m, (0, 0, -l)), Body("b", m, (0, 0, -l))]
    end = Placement((0, 0, -l))
    joints = [
        Joint("a", "revolute", "ground", "a", "x"),
        Joint("b", "revolute", "a", "b", "x", on_parent=end),
    ]
    double = Tree("double", bodies, joints)
    degrees = [c.degree for c in conserved_quantities(lagrangian(double), harmonics=1)]
    assert degrees == [1, 2]


def test_angles_that_are_constant():
    """Down a slope: m u^2 / 2 - m g x sin(tilt), the sine of a parameter."""
    x, u, tilt = sp.symbols("x u tilt", real=True)
    slope = Lagrangian("slope", {x: u}, m * u**2 / 2, -m * g * x * sp.sin(tilt))
    (found,) = conserved_quantities(slope)
    assert equal(found.expression, u**2 - 2 * g * x * sp.sin(tilt))


def test_speeds_that_do_not_change():
    x, u = sp.symbols("x u", real=True)
    assert [c.expression for c in conserved_quantities(Lagrangian("free", {x: u}, u**2 / 2))] == [u]


def test_what_is_damped_keeps_nothing():
    given = lagrangian(pendulum(damping=k))
    assert conserved_quantities(given) == ()
    assert conserved_quantities(lagrangian(pendulum()), rates=1) == ()


def test_a_constant_that_changes_is_noticed():
    equations = equations_of(lagrangian(pendulum()))
    with pytest.raises(DerivationError, match="changes"):
        conserved_module._proved(equations, equations.speeds[0] ** 2)


def test_energies_of_trees_are_those_of_their_equations():
    """The bead's holonomic constraints are put in; every equation is compared with the closed form."""
    found = hoop()
    assert equal(found.kinetic, m * R**2 * (theta_dot**2 + Omega**2 * sp.sin(theta) ** 2) / 2)
    assert equal(
        found.energy,
        m * R**2 * (theta_dot**2 - Omega**2 * sp.sin(theta) ** 2) / 2 - m * g * R * sp.cos(theta),
    )
    assert conserved_quantities(found)[0].degree == 2


# -- refusals and pages ------------------------------------------------------------------------------


def test_refusals():
    x, u, w = sp.symbols("x u w", real=True)
    free = Lagrangian("free", {x: u}, m * u**2 / 2)
    refused(lambda: lagrangian(rolling_disc()), "between speeds(.|\n)*floor_x")
    refused(lambda: lagrangian(sleigh()), "between speeds|no rates")
    ball = Tree("ball", [Body("b", 1, inertia=(1, 1, 1))], [Joint("f", "spherical", "ground", "b")])
    refused(lambda: lagrangian(ball), "no rates of coordinates")
    refused(lambda: lagrangian(slider_crank()), "a closed chain")
    planar = Tree("puck", [Body("b", 1, inertia=(1, 1, 1))], [Joint("f", "planar", "ground", "b")])
    assert [str(c.coordinate) for c in cyclic_coordinates(lagrangian(planar))] == [
        "x_f",
        "y_f",
        "q_f",
    ]
    refused(lambda: lagrangian(pendulum(motor=True)), "inputs drive(.|\n)*tau_hinge")
    refused(lambda: lagrangian(bead(Motion(sp.sin(t)))), "time enters")
    refused(lambda: routh(top(), ["theta"]), "not cyclic")
    refused(lambda: routh(top(), ["chi"]), "no such coordinate(.|\n)*phi, psi, theta")
    refused(lambda: routh(top(), []), "no coordinate is named")
    refused(lambda: routh(free), "nothing is left")
    refused(lambda: routh(lagrangian(pendulum())), "no momentum is conserved")
    refused(lambda: steady_motion(top(), {"chi": 0}), "no such coordinate or speed")
    refused(lambda: steady_motion(top(), {"psi": 0}), "do not depend on it")
    refused(lambda: steady_motion(top(), {"theta_dot": 1}), "not be constant")
    refused(
        lambda: steady_motion(Lagrangian("fall", {x: u}, u**2 / 2, x)), "no such motion is steady"
    )
    refused(lambda: steady_motion(top()).solved("theta"), "no condition is linear")
    refused(lambda: small_motion(top(), 0), "order is no whole number from 1")
    refused(lambda: small_motion(top(), True), "order")
    refused(lambda: small_motion(routh(top()).lagrangian, 2), "no series")
    refused(lambda: conserved_quantities(top(), rates=-1), "rates is no whole number")
    refused(lambda: conserved_quantities(top(), rates=6, harmonics=9), "too large")
    refused(
        lambda: conserved_quantities(Lagrangian("e", {x: u}, u**2 / 2, sp.exp(x))), "no quotients"
    )
    refused(lambda: Lagrangian("e", {}, 1), "symbols")
    refused(lambda: Lagrangian("e", {x: x}, 1), "each once")
    refused(lambda: Lagrangian("e", {x: u}, u**3), "degree two")
    refused(lambda: Lagrangian("e", {x: u}, sp.sqrt(1 + u**2)), "degree two")
    refused(lambda: Lagrangian("e", {x: u}, u**2, forces={w: 1}), "at no coordinate")
    refused(lambda: Lagrangian("e", [x, u], u**2), "wrong type")


@pytest.mark.parametrize("style", ["text", "latex", "markdown", "html"])
def test_pages(style):
    page = analysis_page(
        bead(Motion(Omega * t)), style, names={"q_swing": "theta"}, values={"theta": 0}
    )
    assert "Conserved" in page
    assert "Stability" in page
    assert page == analysis_page(
        bead(Motion(Omega * t)), style, names={"q_swing": "theta"}, values={"theta": 0}
    )


def test_pages_say_what_is_not_there():
    disc = analysis_page(rolling_disc(), names=NAMES, values={"theta": 0, "psi_dot": 0}, order=0)
    assert "No Lagrangian: a constraint between speeds" in disc
    assert "3 r φ̇² − g > 0" in disc.replace("−g + 3 r φ̇²", "3 r φ̇² − g").replace(
        "3 φ̇² r", "3 r φ̇²"
    ).replace("−g + 3 r φ̇²", "3 r φ̇² − g")
    assert "Small changes, to order" not in disc
    assert "Never stable" in analysis_page(pendulum(), values={"q_hinge": sp.pi})
    x, y, u, v = sp.symbols("x y u v", real=True)
    skid = Lagrangian("skid", {x: u, y: v}, m * (u**2 + v**2) / 2, k * x**4, k * v**2 / 2)
    damped = analysis_page(skid)
    assert "changes: damping along y" in damped
    assert "Linear motion needs values" in damped
    refused(lambda: analysis_page(pendulum(), "paper"), "unknown format")
    refused(lambda: analysis_page(pendulum(), order=-1), "below zero")


def test_decimals_stay_decimals_in_pages():
    hinge = Joint("hinge", "revolute", "ground", "bob", axis="x", damping=0.05)
    bob = Body("bob", 0.3, (0, 0, -0.7))
    page = analysis_page(
        Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -9.81)), values={"q_hinge": 0}
    )
    assert "M = [[0.147]]" in page
    assert "0.05 q̇_hinge" in page
    assert "0.147 q̈_hinge" in page


def test_signs_and_short_forms():
    x, a = sp.Symbol("x", real=True), sp.Symbol("a", positive=True)
    assert condition(a) is True
    assert condition(-a / 2) is False
    assert condition(a * (x - a) ** 3 / a**2) == x - a
    assert condition((x - a) ** 2 * -a) == -((x - a) ** 2)
    assert tidy(sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1) == 0
    assert tidy((1 - sp.cos(x) ** 2) / sp.sin(x)) == sp.sin(x)
    assert absolute_angles(pendulum()) == {}
