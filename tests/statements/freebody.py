"""The body without torque: constants, ellipsoids, stability, Poinsot, precession."""

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

import codegen
import eom
from eom.mechanics import freebody
from eom.mechanics.rigidbody import free_rigid_body
from eom.rotations import matrix_of_quaternion
from tests.statements.table import same, says

POLHODES = "notebooks/lecture-000-polhodes.ipynb"
TUTORIAL = "docs/tutorial.md"
FREE = free_rigid_body()
W = sp.Matrix([q.symbol for q in FREE.states])
I = sp.Matrix([q.symbol for q in FREE.parameters])
RATES = sp.Matrix(FREE.rates)
H = sp.Matrix([a * b for a, b in zip(I, W, strict=True)])
A, B, C = sp.symbols("a b c", positive=True)
RISING = dict(zip(I, (A, A + B, A + B + C), strict=True))
"""Moments of which the second is the intermediate one."""
HANDLE, NEAR = (1.5e-4, 4.0e-4, 5.2e-4), (0.05, 10.0, 0.05)
BOOK = eom.Scene(
    body={"solid": "box", "mass": 0.5, "size": {"a": 0.24, "b": 0.16, "c": 0.02}},
    outputs=["omega_1", "omega_2", "omega_3"],
    initial={"omega_1": 0.01, "omega_2": 10.0, "omega_3": 0.0},
)


def along(f):
    """Return the rate of an expression along the motion."""
    return sum(sp.diff(f, w) * r for w, r in zip(W, RATES, strict=True))


def roots(axis, moments):
    """Return the eigenvalues of the rates linearised at a spin about an axis."""
    spin = {w: (sp.Symbol("nu", positive=True) if k == axis else 0) for k, w in enumerate(W, 1)}
    return list(RATES.jacobian(W).subs(spin).subs(moments).eigenvals())


def motion(moments, start, times):
    """Return angular velocities and attitudes of a free body."""
    return codegen.free_motion(moments, start)(np.asarray(times, dtype=float))


def inertial(q, vectors):
    """Return vectors, in components of the body, in inertial ones."""
    return np.array(
        [np.array(matrix_of_quaternion(a)).T @ v for a, v in zip(q.T, vectors.T, strict=True)]
    )


@says(TUTORIAL, "Energy `T` and the magnitude `H` of the angular momentum stay the same.")
@says(POLHODES, "Without torque the energy of rotation is constant.")
@says("derive torque-free-motion T-constant", "the energy of rotation is constant")
@says(
    "derive torque-free-motion magnitude",
    "its magnitude is constant in every frame, though it may turn in B",
)
def energy_and_size_of_momentum_are_constant_and_the_momentum_turns_in_the_body():
    assert same(along(H.dot(H)), 0)
    assert same(along(H.dot(W) / 2), 0)
    assert not same(along(H[0]), 0)


@says(
    TUTORIAL,
    r"seen from the turning book, the momentum turns away at the rate $-\omega\times J\omega$",
)
@says("derive euler-equations omega-rates-equal", "omega x omega = 0")
def momentum_seen_from_the_body_turns_away():
    assert same(H.applyfunc(along), -W.cross(H))
    assert same(W.cross(W), sp.zeros(3, 1))


@says(
    TUTORIAL,
    "About the first and third axes a small disturbance stays small; about the second it grows to the "
    "size of the spin itself.",
)
def the_book_is_unstable_about_its_second_axis_alone():
    moments = [float(BOOK.parameter_values()[f"I{k}"]) for k in (1, 2, 3)]
    for axis in range(3):
        start = np.where(np.arange(3) == axis, 10.0, 0.01)
        omega, _ = motion(moments, start, np.linspace(0, 5, 2001))
        others = abs(np.delete(omega, axis, axis=0)).max()
        assert others > 9 if axis == 1 else others < 0.03


@says(
    TUTORIAL,
    "About the first and the second one it grows in proportion to the time, at a rate that is itself small",
)
@says(
    TUTORIAL,
    "seen from the book, the angular velocity goes around the third axis with the rate `omega_3` times "
    "$(I_1 - I_3)/I_1$",
)
def a_square_book_leaves_the_axes_of_its_square_slowly():
    t, slow = np.array([0.0, 2.5, 5.0]), 0.01
    I1, I3 = 0.0024, 0.0048
    omega, _ = motion((I1, I1, I3), (10.0, 0.0, slow), t)
    np.testing.assert_allclose(
        omega[0] + 1j * omega[1], 10 * np.exp(1j * slow * (I3 - I1) / I1 * t)
    )
    assert abs(abs(omega[1][2]) / abs(omega[1][1]) - 2) < 1e-3


@says(
    POLHODES,
    r"Around $\hat b_1$ and $\hat b_3$, the axes of the least and of the greatest moment, the curves close "
    "tightly: start near such an axis and you stay near it.",
)
def a_start_near_an_outer_axis_stays_near_it():
    for axis in (0, 2):
        start = np.where(np.arange(3) == axis, 10.0, 0.05)
        omega, _ = motion(HANDLE, start, np.linspace(0, 1000, 20001))
        assert abs(np.delete(omega, axis, axis=0)).max() < 0.15


@says(
    POLHODES,
    "start near that axis and the curve leads away from it, half around the body, to the opposite end of "
    "the axis.",
)
@says(POLHODES, "near the intermediate one it leads to the other end of that axis and back")
def from_near_the_intermediate_axis_the_polhode_leads_to_its_other_end():
    period = codegen.free_motion(HANDLE, NEAR).period
    omega, _ = motion(HANDLE, NEAR, np.linspace(0, period, 4001))
    directions = omega / np.linalg.norm(omega, axis=0)
    assert directions[1].max() > 0.9999
    assert directions[1].min() < -0.9999
    np.testing.assert_allclose(omega[:, -1], omega[:, 0], atol=1e-9)


@says(POLHODES, r"If $I_1$ is the least moment, both coefficients are positive")
@says(POLHODES, "The first coefficient is negative, the second one positive: hyperbolas.")
@says(
    "derive torque-free-motion polhode-1",
    "an ellipse if I1 is the greatest or the least moment, a hyperbola if it is the intermediate one",
)
@says(
    "derive torque-free-motion polhode-2",
    "an ellipse if I2 is the greatest or the least moment, a hyperbola if it is the intermediate one",
)
@says(
    "derive torque-free-motion polhode-3",
    "an ellipse if I3 is the greatest or the least moment, a hyperbola if it is the intermediate one",
)
def polhodes_are_hyperbolas_along_the_intermediate_axis_alone():
    for axis in (1, 2, 3):
        i, j = (k for k in (1, 2, 3) if k != axis)
        level = H.dot(H) - 2 * I[axis - 1] * H.dot(W) / 2
        over = [sp.factor(sp.diff(level, W[k - 1], 2).subs(RISING)) for k in (i, j)]
        assert not level.has(W[axis - 1]) or same(sp.diff(level, W[axis - 1]), 0)
        signs = [sp.sign(x) for x in over]
        assert signs == {1: [1, 1], 2: [-1, 1], 3: [-1, -1]}[axis]


@says(
    POLHODES,
    r"$\lambda^2$ is positive where $I_1 < I_2 < I_3$ or the other way round: about the intermediate axis alone.",
)
@says(
    "derive torque-free-motion growth-1",
    "grows as exp(lambda t) if I1 is the intermediate moment, as lambda^2 is positive then, and oscillates if it is the greatest or the least",
)
@says(
    "derive torque-free-motion growth-2",
    "grows as exp(lambda t) if I2 is the intermediate moment, as lambda^2 is positive then, and oscillates if it is the greatest or the least",
)
@says(
    "derive torque-free-motion growth-3",
    "grows as exp(lambda t) if I3 is the intermediate moment, as lambda^2 is positive then, and oscillates if it is the greatest or the least",
)
@says(
    "derive torque-free-motion growth-2",
    "Its roots: zero, as nu is free, and two opposite ones.".replace("Its", "its"),
)
def a_deviation_grows_about_the_intermediate_axis_alone():
    for order in (I, I[::-1]):
        moments = dict(zip(order, (A, A + B, A + B + C), strict=True))
        for axis in (1, 2, 3):
            found = [r for r in roots(axis, moments) if r != 0]
            assert len(found) == 2
            assert same(sum(found), 0)
            assert sp.sign(sp.factor(found[0] ** 2)) == (1 if axis == 2 else -1)


@says(POLHODES, r"small deviations grow as $e^{\lambda t}$")
@says(
    "notebooks/generating-c.ipynb",
    "Near the intermediate axis errors grow like $e^{6t}$ (lecture 000) until the body flips",
)
def small_deviations_grow_at_the_rate_of_the_linear_motion():
    numbers = dict(zip(I, HANDLE, strict=True)) | {sp.Symbol("nu", positive=True): 10.0}
    rate = max(sp.re(r.subs(numbers)) for r in roots(2, {}))
    omega, _ = motion(HANDLE, (1e-6, 10.0, 1e-6), [0.5, 1.0])
    grown = np.log(np.linalg.norm(omega[[0, 2], 1]) / np.linalg.norm(omega[[0, 2], 0])) / 0.5
    assert abs(grown - rate) < 0.01
    assert abs(rate - 6) < 0.5


@says(POLHODES, r"$\omega_2$ stays near 10 rad/s, then turns over within a fraction of a second")
@says(
    POLHODES, "It waits near the other end of the intermediate axis, where the rates hardly change"
)
def the_handle_flips_in_less_than_a_second():
    t = np.linspace(0, codegen.free_motion(HANDLE, NEAR).period, 40001)
    omega, _ = motion(HANDLE, NEAR, t)
    turning = abs(omega[1]) < 8.0
    assert 0.1 < turning.mean() * t[-1] / 2 < 1.0
    changes = np.linalg.norm(np.diff(omega, axis=1), axis=0)
    assert changes[omega[1][1:] < -9.99].max() < changes.max() / 5


@says(POLHODES, r"The projection of $\vec\omega$ on it is constant")
@says(
    "derive torque-free-motion invariable-plane",
    "as h is constant, the tip of omega stays in a plane normal to h: the invariable plane",
)
def angular_velocity_stays_in_the_invariable_plane():
    omega, q = motion(HANDLE, NEAR, np.linspace(0, 20, 401))
    momentum, tip = (inertial(q, v) for v in (np.array(HANDLE)[:, None] * omega, omega))
    np.testing.assert_allclose(momentum, momentum[:1].repeat(401, 0), atol=1e-13)
    along_h = tip @ momentum[0] / np.linalg.norm(momentum[0])
    assert np.ptp(along_h) < 1e-9
    assert np.ptp(tip, axis=0).min() > 0.01


@says(POLHODES, "The polhode is a closed curve.")
@says(POLHODES, "The herpolhode in general is not")
def the_polhode_closes_and_the_herpolhode_does_not():
    free = codegen.free_motion(HANDLE, NEAR)
    omega, q = motion(HANDLE, NEAR, np.arange(8) * free.period)
    np.testing.assert_allclose(omega, omega[:, :1].repeat(8, 1), atol=1e-8)
    tips = inertial(q, omega)
    gaps = np.linalg.norm(tips[1:] - tips[0], axis=1)
    assert gaps.min() > 1e-3


@says(
    POLHODES,
    "Throw it so that it turns end over end about the third axis, and it twists by half a turn on the way",
)
def the_racket_twists_by_half_a_turn():
    least, middle = 1.0, 10.0
    moments = (least, middle, least + middle)  # a flat body: handle along b1, face normal to b3
    free = codegen.free_motion(moments, (0.0, 10.0, 0.01))
    _, q = free(np.array([0.0, free.period / 2]))
    axis = inertial(q, np.array([[0.0, 1, 0]] * 2).T)
    assert axis[0] @ axis[1] < -0.99


@says(
    POLHODES,
    r"The term $\vec\omega \times [I_C]\vec\omega$ stands at a right angle to $\vec\omega$",
)
@says(POLHODES, r"A torque at a right angle to $\vec\omega$ does none either.")
@says("notebooks/generating-c.ipynb", "The products of two rates cancel")
def power_is_that_of_the_torque_along_the_rates():
    assert same(W.cross(H).dot(W), 0)
    driven = eom.derive("euler-equations").system
    torque = sp.Matrix([q.symbol for q in driven.inputs])
    moments = {q.symbol: q.symbol for q in driven.parameters}
    w = sp.Matrix([q.symbol for q in driven.states[:3]])
    power = sum(m * x * r for m, x, r in zip(moments, w, driven.rates[:3], strict=True))
    assert same(power, torque.dot(w))
    across = w.cross(sp.Matrix(sp.symbols("x y z")))
    assert same(power.subs(dict(zip(torque, across, strict=True))), 0)


@says(
    POLHODES, r"Its polhodes are circles; $\vec\omega$, $\vec H_C$ and the axis stay in one plane"
)
@says("derive torque-free-motion spin", "so the spin about the axis of symmetry is constant")
@says(
    "derive torque-free-motion precession",
    "the axis turns about h at the rate H/I_t: the space cone",
)
@says("derive torque-free-motion plane-of-h", "it lies in the plane of h and the axis")
def a_symmetric_body_precesses():
    equal = {I[1]: I[0]}
    assert same(RATES[2].subs(equal), 0)
    assert same(along(W[0] ** 2 + W[1] ** 2).subs(equal), 0)
    axis = sp.Matrix([0, 0, 1])
    assert same(W.dot(H.cross(axis)).subs(equal), 0)
    assert same(W.cross(axis), (H / I[0]).subs(equal).cross(axis))


@says(
    "derive torque-free-motion plane-of-h",
    "in the same sense (prograde) if I_a < I_t, as a rod, in the opposite sense (retrograde) if I_a > I_t, as a disc",
)
@says(
    "eom.mechanics.freebody.precession",
    "Without it the precession is direct if the body is prolate, retrograde if oblate.",
)
def a_rod_precesses_direct_and_a_disc_retrograde():
    for transverse, axial, sense in ((2.0, 0.5, 1), (1.0, 1.8, -1)):
        omega = sp.Matrix([0.3, 0, 2])
        h = sp.diag(transverse, transverse, axial) * omega
        spin = (omega - h / transverse)[2]  # what is left of omega beside a turn about h
        assert abs((omega - h / transverse)[0]) < 1e-15
        assert np.sign(float(spin)) == sense
        assert freebody.precession(transverse, axial, (0.3, 0, 2)).sense == (
            "direct" if sense > 0 else "retrograde"
        )


@says(
    "derive torque-free-motion across-1",
    "near a spin about b1 the first term is linear in the deviation, the other one of third order",
)
@says(
    "derive torque-free-motion across-2",
    "near a spin about b2 the first term is linear in the deviation, the other one of third order",
)
def across_a_spin_second_rates_have_a_linear_and_a_cubic_term():
    small = sp.Symbol("e")
    for axis in (0, 1):
        near = {w: (w if k == axis else small * w) for k, w in enumerate(W)}
        other = (axis + 1) % 3
        orders = sp.Poly(sp.expand(along(RATES[other]).subs(near, simultaneous=True)), small)
        assert {m[0] for m in orders.monoms()} == {1, 3}


@says(
    "derive torque-free-motion constant-rates-1",
    "without torque any rates of a spherical body are constant",
)
@says(
    "derive torque-free-motion constant-rates-2",
    "without torque rates across the axis of a symmetric body are constant",
)
@says(
    "derive torque-free-motion constant-rates-3",
    "with the torque omega x J.omega any rates of any body are constant",
)
@says(
    "derive torque-free-motion along-axis-1",
    "where omega lies along the principal axis b1, omega x J.omega is zero: free rates are constant there",
)
def where_rates_are_constant():
    assert same(RATES.subs({I[1]: I[0], I[2]: I[0]}), sp.zeros(3, 1))
    assert same(RATES.subs({I[1]: I[0], W[2]: 0}), sp.zeros(3, 1))
    assert not same(RATES.subs({I[1]: I[0]}), sp.zeros(3, 1))
    driven = eom.derive("euler-equations").system
    named = dict(zip((q.symbol.name for q in driven.states), W, strict=False))
    torque = dict(zip((q.symbol for q in driven.inputs), W.cross(H), strict=True))
    symbols = {s: named.get(s.name, s) for r in driven.rates[:3] for s in r.free_symbols}
    symbols |= {s: m for s in symbols for m in I if s.name == m.name}
    held = [r.subs(torque).subs(symbols) for r in driven.rates[:3]]
    assert same(held, [0, 0, 0])
    assert same(W.cross(H).subs({W[1]: 0, W[2]: 0}), sp.zeros(3, 1))


@says(
    "derive torque-free-motion momentum-ellipsoid",
    "the momentum ellipsoid, of semi-axes H/I1, H/I2, H/I3 in the space of rates",
)
@says(
    "derive torque-free-motion energy-ellipsoid",
    "the energy ellipsoid, of squared semi-axes 2 T/I1, 2 T/I2, 2 T/I3",
)
@says("derive torque-free-motion normal-1", "the gradient of T over the rates is h")
@says(
    "derive torque-free-motion no-slip",
    "the point of the body at s omega lies on the axis of turning and has no velocity",
)
def the_ellipsoids_and_how_one_rolls():
    size, energy, s = sp.symbols("H T s", positive=True)
    for k in range(3):
        at = dict.fromkeys(W, 0)
        assert same(H.dot(H).subs(at | {W[k]: size / I[k]}), size**2)
        assert same((H.dot(W) / 2).subs(at | {W[k]: sp.sqrt(2 * energy / I[k])}), energy)
        assert same(sp.diff(H.dot(W) / 2, W[k]), H[k])
    assert same(W.cross(s * W), sp.zeros(3, 1))


@says("eom.mechanics.freebody.herpolhode_rate", "It is 0/0 in steady spin, where rho = 0.")
def the_rate_of_the_herpolhode_is_undetermined_in_steady_spin():
    above, below = sp.fraction(sp.together(freebody.herpolhode_rate()))
    spin = {
        s: 0 for s in above.free_symbols | below.free_symbols if s.name in {"omega_1", "omega_2"}
    }
    assert same(above.subs(spin), 0)
    assert same(below.subs(spin), 0)
    assert not same(below, 0)


@says("eom.mechanics.freebody.Polhode", "approached and not reached on the separatrix")
def the_ends_of_the_separatrix_are_not_reached():
    moments = (1.0, 2.0, 3.0)
    squares = np.array([1 * (2 - 1.0), 0, 3 * (3 - 2.0)])  # energy and momentum of a spin about b2
    start = (np.sqrt(1 / squares[0]), 0.0, np.sqrt(1 / squares[2]))
    found = freebody.classify(moments, start)
    t = np.linspace(0, 4, 401)
    rates = sp.lambdify(W, RATES.subs(dict(zip(I, moments, strict=True))).T.tolist()[0])
    run = solve_ivp(lambda _, w: rates(*w), (0, 4), start, "DOP853", t, rtol=1e-12, atol=1e-12)
    assert found.kind == "separatrix"
    rising = abs(run.y[1])
    assert np.all(np.diff(rising) > 0)
    assert rising[-1] < found.extremes[1][1]
    assert found.extremes[1][1] - rising[-1] < 0.05


@says(
    "notebooks/checking.ipynb",
    "the angular velocity runs along the curve in which two ellipsoids cross, and is nowhere constant",
)
def the_counterexample_is_nowhere_at_rest():
    omega, _ = motion((2.0, 3.0, 4.0), (1.0, 1.0, 0.0), np.linspace(0, 30, 3001))
    rates = np.array([omega[1] * omega[2] * (3 - 4) / 2, omega[2] * omega[0] * (4 - 2) / 3,
                      omega[0] * omega[1] * (2 - 3) / 4])  # fmt: skip
    assert np.linalg.norm(rates, axis=0).min() > 0.1


@says("docs/explanation/less.md", "Without torque, angular velocity does not depend on attitude.")
def free_rates_do_not_hold_the_attitude():
    whole = free_rigid_body("quaternion")
    for rate in whole.rates[:3]:
        assert not {s.name for s in whole.expand(rate).free_symbols} & {"q0", "q1", "q2", "q3"}
    assert any("q0" in {s.name for s in r.free_symbols} for r in whole.rates[3:])
