"""Bodies under torque: the wheel of lecture 001, tops, discs that roll, gyrostats."""

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

import codegen
import eom
from eom import derive
from eom.mass.solids import mass_properties
from eom.mechanics.gyrostat import gyrostat
from eom.terms.terms import nodes
from tests.statements.table import same, says

WHEEL = "notebooks/lecture-001-spinning-body.ipynb"
CHECKING = "notebooks/checking.ipynb"
ANALYSIS = "docs/howto/analysis.md"
SCENE = eom.Scene.ready("lecture-wheel")
SYSTEM = SCENE.derive()
NAMES = {
    s.name: s for s in (*(q.symbol for q in SYSTEM.states), *(q.symbol for q in SYSTEM.parameters))
}
I1, I2, M1, C, THETA, PSI, TILTING = (
    NAMES[n] for n in ("I1", "I2", "M1", "C", "theta", "psi_dot", "theta_dot")
)
TILT, TURN = SYSTEM.rates[2], SYSTEM.rates[3]


def released(end, **values):
    """Return times and states (theta, psi and their rates) of the wheel, released at rest."""
    numbers = {**SCENE.parameter_values(), **values}
    put = {NAMES[n]: v for n, v in numbers.items()}
    states = [q.symbol for q in SYSTEM.states]
    rates = sp.lambdify(states, [r.subs(put) for r in SYSTEM.rates])
    start = [SCENE.initial_values()[n] for n in SYSTEM.state_names]
    return solve_ivp(
        lambda _, x: rates(*x),
        (0, end),
        start,
        "DOP853",
        np.linspace(0, end, 4001),
        rtol=1e-10,
        atol=1e-12,
    )


@says(
    WHEEL,
    "The torque does not tilt the axle, it drives the precession, and the faster the wheel spins the slower it precesses.",
)
@says(
    WHEEL,
    r"With a fast spin the first term carries everything: $\dot\psi \approx M_1/(I_2 C\cos\theta)$.",
)
def a_fast_wheel_precesses_and_the_faster_the_slower():
    put = {I1: 0.06, I2: 0.12, M1: 0.5, THETA: 0.1}
    last = np.inf
    for spin in (6, 12, 24, 48):
        steady = [
            float(x)
            for x in sp.Poly(sp.numer(sp.together(TILT.subs(put).subs(C, spin))), PSI).nroots()
        ]
        slow = min(steady, key=abs)
        assert abs(TILT.subs(put).subs({C: spin, PSI: slow})) < 1e-9
        assert 0 < slow < last
        assert abs(slow * 0.12 * spin * np.cos(0.1) / 0.5 - 1) < 1.0 / spin**2
        last = slow
    assert TILT.subs(put).subs({C: 6, PSI: 0}) < 0


@says(
    WHEEL,
    "the wheel has no precession that could balance the torque. So it begins to fall; falling makes it "
    "precess; and it rises again.",
)
@says(
    WHEEL,
    "The axle nods (nutation) while it goes around (precession): its mean rate is close to that of the steady motion.",
)
def released_it_falls_precesses_and_rises():
    run = released(10)
    theta, psi, _, turning = run.y
    lowest = theta.argmin() if theta.argmin() < 400 else np.flatnonzero(np.diff(theta) > 0)[0]
    assert np.all(np.diff(theta[:lowest]) < 0)
    assert turning[0] == 0
    assert turning[lowest] > 0.5
    assert abs(theta[lowest:800].max() - theta[0]) < 1e-4
    assert abs(psi[-1] / 10 / (0.5 / (0.12 * 6)) - 1) < 0.02


@says(
    WHEEL,
    r"No torque acts about the vertical $\mathbf a_3$ either: the component $H_3$ of the angular momentum along it is constant.",
)
@says(
    WHEEL,
    r"$C = \Omega + \dot\psi\sin\theta$ is the angular velocity of the wheel about its axle, seen from $\mathcal I$. It is constant",
)
@says("derive spinning-symmetric-body first-integral", "Omega + psi' sin theta is constant")
def constants_of_the_wheel():
    H3 = C * I2 * sp.sin(THETA) + I1 * PSI * sp.cos(THETA) ** 2
    assert same(sp.diff(H3, THETA) * TILTING + sp.diff(H3, PSI) * TURN, 0)
    spin = {o.name: SYSTEM.expand(o.expression) for o in SYSTEM.outputs}["Omega"]
    assert same(spin + PSI * sp.sin(THETA), C)
    assert not same(sp.diff(spin, THETA), 0)


@says(
    WHEEL,
    "It is about the centre of mass, where the weight itself has none: it is that of the force which holds the end of the axle.",
)
def weight_has_no_torque_about_the_centre_of_mass():
    draw = np.random.default_rng(0)
    m, r = draw.uniform(1, 2, 9), draw.normal(size=(9, 3))
    g = np.array([0, 0, -9.81])
    centre, end = m @ r / m.sum(), np.array([0.0, 0, 0])
    weight = m[:, None] * g
    np.testing.assert_allclose(np.cross(r - centre, weight).sum(axis=0), 0, atol=1e-12)
    held = -weight.sum(axis=0)  # by a force at the end of the axle
    about_end = np.cross(r - end, weight).sum(axis=0)
    np.testing.assert_allclose(np.cross(end - centre, held), about_end)
    assert np.linalg.norm(about_end) > 1


@says(
    "derive spinning-symmetric-body rate", "row 2 holds I2 dOmega/dt, which the lecture leaves out"
)
@says(
    "derive spinning-symmetric-body no-axle-term",
    "omega x h has no component along the axle, as the body is symmetric",
)
@says("derive spinning-symmetric-body J", "its inertia in B does not depend on the spin angle")
@says(
    WHEEL,
    r"its inertia matrix is $\mathrm{diag}(I_1, I_2, I_1)$ in $\mathcal B$ *although $\mathcal B$ does not turn with it*",
)
def the_rate_of_the_wheels_momentum():
    t = sp.Symbol("t", real=True)
    psi, theta, phi = (sp.Function(n)(t) for n in ("psi", "theta", "phi"))
    a, b, c = sp.symbols("a b c", positive=True)
    w = sp.Matrix([theta.diff(t), psi.diff(t) * sp.sin(theta), psi.diff(t) * sp.cos(theta)])
    turned = sp.Matrix([[sp.cos(phi), 0, -sp.sin(phi)], [0, 1, 0], [sp.sin(phi), 0, sp.cos(phi)]])
    assert same(turned.T * sp.diag(a, b, a) * turned, sp.diag(a, b, a))
    assert not same(turned.T * sp.diag(a, b, c) * turned, sp.diag(a, b, c))
    h = sp.diag(a, b, a) * (w + sp.Matrix([0, phi.diff(t), 0]))
    row = (h.diff(t) + w.cross(h))[1]
    assert same(sp.diff(sp.expand(row), phi.diff(t, 2)), b)
    assert same(w.cross(h)[1], 0)
    uneven = sp.diag(a, b, c) * (w + sp.Matrix([0, phi.diff(t), 0]))
    assert not same(w.cross(uneven)[1], 0)


@says(
    CHECKING,
    r"It is quadratic in $\dot\psi$ unless the axle is level: with a fast spin there is a second, fast "
    "precession for the same torque.",
)
@says(CHECKING, "a term is missing that is small when the spin is fast")
def there_are_two_steady_precessions():
    steady = sp.Poly(sp.expand(TILT * I1), PSI)
    assert steady.degree() == 2
    assert sp.Poly(sp.expand((TILT * I1).subs(THETA, 0)), PSI).degree() == 1
    put = {I1: 0.06, I2: 0.12, M1: 0.5, THETA: 0.4}
    shares = []
    for spin in (10, 100):
        slow, fast = sorted(map(float, steady.subs(put).subs(C, spin).as_poly(PSI).nroots()))
        assert fast > 10 * slow > 0
        missing = 0.06 * slow**2 * np.sin(0.4) * np.cos(0.4)
        shares.append(missing / 0.5)
    assert shares[1] < shares[0] / 50


def upright(_, x):
    """Return what is zero where the axle is all but vertical."""
    return x[0] - np.pi / 2 + 1e-4


upright.terminal = True


@says(WHEEL, "With `C = 6` the tilt turns back before the axle is vertical")
def the_spinning_axle_does_not_get_through_the_vertical():
    steep = {"theta": 1.5, "psi": 0.0, "theta_dot": 3.0, "psi_dot": 0.0}
    for spin, through in ((0.0, True), (6.0, False)):
        put = {NAMES[n]: v for n, v in {**SCENE.parameter_values(), "C": spin}.items()}
        states = [q.symbol for q in SYSTEM.states]
        rates = sp.lambdify(states, [r.subs(put) for r in SYSTEM.rates])

        run = solve_ivp(
            lambda _, x, f=rates: f(*x), (0, 1), [steep[n] for n in SYSTEM.state_names], rtol=1e-9,
            events=upright,
        )  # fmt: skip
        assert (len(run.t_events[0]) > 0) is through


@says(ANALYSIS, "When a sleeping top is stable")
def a_sleeping_top_is_stable_where_it_is_fast():
    scene = eom.Scene.ready("heavy-top")
    system, values = scene.derive(), scene.parameter_values()
    limit = np.sqrt(4 * values["I1"] * values["m"] * values["g"] * values["r3"]) / values["I3"]
    for factor, stable in ((0.9, False), (1.1, True)):
        put = {q.symbol: {**values, "omega_3": factor * limit}[q.name] for q in system.parameters}
        states = [q.symbol for q in system.states]
        rates = sp.lambdify(states, [system.expand(r).subs(put) for r in system.rates])
        start = [{"q0": 1.0, "omega_1": 1e-4}.get(s.name, 0.0) for s in states]
        run = solve_ivp(
            lambda _, x, f=rates: f(*x), (0, 40), start, "DOP853", rtol=1e-9, atol=1e-12
        )
        q1, q2 = (run.y[system.state_names.index(n)] for n in ("q1", "q2"))
        assert bool(2 * np.hypot(q1, q2).max() < 1e-3) is stable


@says(
    ANALYSIS,
    "Upright it rolls on where v^2 > g r/3, and spins on the spot where the square of the rate is above 4 g/(5 r).",
    slow=True,
)
def a_disc_rolls_on_and_spins_on():
    scene = eom.load_scene("rolling-disc")
    system = scene.derive()
    compiled, values = codegen.compile(system), scene.parameter_values()
    r, g = values["r"], values["g"]
    start = scene.initial_values()

    def leans(**speeds):
        x = dict.fromkeys(start, 0.0) | {"z_disc": r, "e_disc_0": 1.0, "e_disc_1": 1e-5, **speeds}
        run = codegen.simulate(compiled, x, (0, 15), values, t_eval=np.linspace(0, 15, 1501))
        e = [run[f"e_disc_{k}"] for k in range(4)]
        return float(abs(2 * (e[2] * e[3] + e[0] * e[1])).max())  # how far the axle is from level

    for factor, steady in ((0.9, False), (1.1, True)):
        v = factor * np.sqrt(g * r / 3)
        assert (leans(w_disc_2=v / r) < 1e-3) is steady
        assert (leans(w_disc_3=factor * np.sqrt(4 * g / (5 * r))) < 1e-3) is steady


@says(
    "derive gyrostat dual-spin-stability",
    "A rotor that is fast enough steadies a spin about any principal axis, even the intermediate one",
)
@says(
    "derive gyrostat dual-spin-stability",
    "stable where it exceeds both I2 nu and I3 nu, or is less than both",
)
def a_rotor_steadies_any_spin():
    system = gyrostat(1, drives="free")
    rates = sp.Matrix([system.expand(r) for r in system.rates[:3]])
    w = [q.symbol for q in system.states[:3]]
    (p,) = (q.symbol for q in system.states[3:])
    moments = {q.name: q.symbol for q in system.parameters}
    body = {moments["I1"]: 2.0, moments["Js_1"]: 0.1}
    for I2_, I3_ in ((1.0, 3.0), (3.0, 4.0), (1.0, 1.5)):
        for whole in (-20.0, 0.5, 2.0, 20.0):
            nu = 1.0
            put = body | {moments["I2"]: I2_, moments["I3"]: I3_, w[0]: nu, w[1]: 0, w[2]: 0}
            put[p] = whole - (2.0 - 0.1) * nu  # h along the axis is (I1 - Js) nu + p
            J = np.array(rates.jacobian(w).subs(put).tolist(), dtype=float)
            stable = np.linalg.eigvals(J).real.max() < 1e-7
            said = whole > max(I2_, I3_) * nu or whole < min(I2_, I3_) * nu
            assert bool(stable) is said


@says("derive gyrostat no-axial-term", "no gyroscopic term acts along the axis")
@says(
    "derive gyrostat rotor-plane",
    "a rotor is symmetric about its axis: its momentum, about its own centre of mass, lies in the plane of omega and the axis",
)
@says("derive gyrostat equation-motors", "the body feels the opposite torques of the motors")
def rotors():
    a, b, spin = sp.symbols("a b Omega", real=True)
    w, axis = sp.Matrix(sp.symbols("w1:4", real=True)), sp.Matrix([1, 0, 0])
    h = sp.diag(b, a, a) * (w + spin * axis)
    assert same(h.dot(w.cross(axis)), 0)
    assert same(w.cross(h).dot(axis), 0)
    system = gyrostat(1, drives="motor")
    (u,) = (q.symbol for q in system.inputs)
    rotor, body = system.rates[3], system.expand(system.rates[0])
    assert same(sp.diff(rotor, u), 1)
    inertia = {q.name: q.symbol for q in system.parameters}
    assert same(sp.diff(body, u) * (inertia["I1"] - inertia["Js_1"]), -1)


@says(
    "derive heavy-symmetric-top T-angles",
    "m l^2 and the moment about the centre of mass add up to I_1",
)
@says(
    "derive heavy-symmetric-top omega-turns",
    "precession about the vertical, nutation about the line of nodes, spin about the axis",
)
def a_cone_on_its_apex_has_the_moment_of_its_centre_and_more():
    own, apex = mass_properties("cone"), mass_properties("cone", "apex")
    l = sp.sqrt(sum((a - b) ** 2 for a, b in zip(own.centre, apex.centre, strict=True)))
    assert same(apex.inertia[0, 0], own.inertia[0, 0] + own.mass * l**2)
    assert same(apex.inertia[2, 2], own.inertia[2, 2])
    rate = derive("heavy-symmetric-top")["omega-turns"].statement.right
    axes = {n.data[1:] for n in nodes(rate) if n.head == "atom" and n.data[0] == "unit"}
    assert axes == {("I", "3"), ("D", "1"), ("F", "3")}
