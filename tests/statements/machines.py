"""Trees, control, orbits, and what runs of them tell."""

import tomllib

import numpy as np
import sympy as sp

import codegen
import eom
from codegen.frontend.lower import lower_system
from eom.mechanics.rigidbody import free_rigid_body
from eom.multibody import (
    Body,
    Joint,
    Lagrangian,
    Loop,
    Placement,
    Tree,
    cyclic_coordinates,
    examine,
)
from eom.scenes import catalogue
from tests.statements.table import same, says

MANY = "notebooks/many-bodies.ipynb"
BODIES = "docs/howto/many-bodies.md"
WORK = "notebooks/work-precision.ipynb"
ACCURACY = "docs/explanation/accuracy.md"
CONTROL = "docs/howto/control.md"
PENDULUM = eom.load_scene("double-pendulum")
HIGH = PENDULUM.initial_values() | {"q_shoulder": 2.0, "q_elbow": 2.5}


def pendulum(start, end, **options):
    """Return a run of the double pendulum, by its Taylor series."""
    return codegen.simulate(
        PENDULUM.derive(),
        start,
        (0, end),
        PENDULUM.parameter_values(),
        **{"rtol": 1e-12, **options},
    )


@says(
    MANY,
    "Energy is constant to the last digits, and still nobody can say where the pendulum will be in an hour: differences grow by a factor of e in less than a second.",
)
@says(MANY, "it soon moves in a way that nobody would call periodic")
@says(MANY, "Start it again, a millionth of a radian aside")
@says(ACCURACY, "Its energy is constant to eleven digits, and proves nothing")
def the_double_pendulum_forgets_its_start():
    t = np.linspace(0, 20, 201)
    one = pendulum(HIGH, 20, t_eval=t)
    other = pendulum(HIGH | {"q_elbow": 2.5 + 1e-6}, 20, t_eval=t)
    apart = abs(one["q_elbow"] - other["q_elbow"])
    early = (t > 2) & (t < 8)
    assert 1 < np.polyfit(t[early], np.log(apart[early]), 1)[0] < 2  # e-fold in less than a second
    assert apart.max() > 1
    assert one.drift["energy"].relative < 1e-11
    gentle = pendulum(PENDULUM.initial_values() | {"q_elbow": -0.5 + 1e-6}, 20, t_eval=t)
    same_start = pendulum(PENDULUM.initial_values(), 20, t_eval=t)
    assert abs(gentle["q_elbow"] - same_start["q_elbow"]).max() < 1e-4  # not so where it swings low


@says(MANY, "At rest it carries the weight of both rods, 14.7 N.")
def the_shoulder_carries_both_rods():
    data = PENDULUM.model_dump(exclude_unset=True)
    held = eom.TreeScene(**{**data, "outputs": ("q_shoulder", "F_shoulder_3")})
    run = codegen.simulate(
        codegen.compile(held.derive(), "numpy"), dict.fromkeys(held.initial_values(), 0.0), (0, 0.1),
        held.parameter_values(), "scipy:DOP853",
    )  # fmt: skip
    np.testing.assert_allclose(run["F_shoulder_3"], 14.7, atol=0.05)


@says(
    MANY,
    "The second bracket is the acceleration of the elbow, across the lower rod: a part along the circle, a part towards its centre.",
)
def the_acceleration_of_the_elbow():
    t, l1 = sp.symbols("t l1", positive=True)
    q, p = sp.Function("q")(t), sp.Function("p")(t)  # shoulder and elbow
    elbow = l1 * sp.Matrix([sp.sin(q), -sp.cos(q)])
    across = sp.Matrix([sp.cos(q + p), sp.sin(q + p)])  # to the side to which the rod swings
    bracket = q.diff(t, 2) * sp.cos(p) + q.diff(t) ** 2 * sp.sin(p)
    assert same(elbow.diff(t, 2).dot(across), l1 * bracket)


@says(MANY, "the equations grow in proportion to the number of bodies")
@says(
    BODIES,
    "the recursion of articulated bodies, whose length grows with the number of bodies and not with its cube",
)
def equations_grow_with_the_number_of_bodies():
    cart = tomllib.loads(catalogue.path_of("pendulum-on-cart").read_text(encoding="utf-8"))
    counts = [
        len(lower_system(eom.TreeScene(**{**cart, "repeat": {"links": n}}).derive()).instructions)
        for n in (3, 6, 12)
    ]
    first, second = np.diff(counts) / (3, 6)
    assert abs(second / first - 1) < 0.05


@says(BODIES, "the matrix is n² (3 **r** **r**ᵀ − 1) with **r** the direction from the Earth")
@says(BODIES, "A satellite alone stays at the origin, so a spherical joint is enough")
def the_gradient_of_gravity_on_a_circular_orbit():
    x = sp.Matrix(sp.symbols("x1:4", real=True))
    mu, R = sp.symbols("mu R", positive=True)
    gravity = -mu * x / sp.sqrt(x.dot(x)) ** 3
    at = dict(zip(x, (R * sp.Rational(3, 5), R * sp.Rational(4, 5), 0), strict=True))
    direction = sp.Matrix([sp.Rational(3, 5), sp.Rational(4, 5), 0])
    n2 = mu / R**3
    assert same(gravity.jacobian(x).subs(at), n2 * (3 * direction * direction.T - sp.eye(3)))
    # seen from a point that falls, the force on a body whose mass lies about it evenly is zero
    m, r = np.ones(2), np.array([[1.0, 2, 3], [-1, -2, -3]])
    gradient = np.array((3 * direction * direction.T - sp.eye(3)).tolist(), dtype=float)
    np.testing.assert_allclose((m[:, None] * (r @ gradient)).sum(axis=0), 0)


@says(BODIES, "What a rocket of constant radii of gyration must do, it does")
def jet_damping():
    t, k2, d = sp.symbols("t k2 d", positive=True)
    # what leaves at distance d takes angular momentum dm d^2 w with it: (m k^2 w)' = m' d^2 w
    mass = sp.Function("m")(t)
    rate = sp.Function("w")(t)
    left = sp.diff(mass * k2 * rate, t) - mass.diff(t) * d**2 * rate
    claimed = mass ** (d**2 / k2 - 1)
    assert same(sp.simplify(left.subs(rate, claimed).doit() / claimed), 0)
    burning = "(100 - 5*t)"
    scene = eom.TreeScene(
        bodies={
            "rocket": {"mass": burning, "moments": [f"{burning}*1.44"] * 2 + [f"{burning}*0.02"]}
        },
        joints={"rocket": {"kind": "free", "parent": "ground", "child": "rocket"}},
        jets={"nozzle": {"body": "rocket", "velocity": [0, 0, -2000], "point": [0, 0, -2]}},
        initial={"w_rocket_1": 0.1},
    )
    compiled = codegen.compile(scene.derive(), "numpy")
    run = codegen.simulate(compiled, scene.initial_values(), (0, 10), method="scipy:DOP853")
    assert np.isclose(run["w_rocket_1"][-1], 0.1 * 0.5 ** (4 / 1.44 - 1), rtol=1e-6)
    assert run["w_rocket_1"][-1] < 0.1


@says(
    WORK,
    r"where an energy is off by $\Delta E$, the state is off by $\Delta E/|\nabla E|$ at least, to first order.",
)
@says(WORK, "an error *along* the motion, a wrong time, does not change the energy at all")
@says(ACCURACY, "It bounds the error from below, by way of the gradient of the constant")
@says(
    ACCURACY,
    "a state may move along the surface on which all of them are constant, and the drift does not see that",
)
def what_drift_of_energy_tells_of_the_error():
    t = np.linspace(0, 5, 51)
    run = pendulum(PENDULUM.initial_values(), 5, t_eval=t)
    rough = pendulum(PENDULUM.initial_values(), 5, t_eval=t, method="DP5", rtol=1e-4)
    system, values = PENDULUM.derive(), PENDULUM.parameter_values()
    energy = next(system.expand(d.expression) for d in system.invariants if d.name == "energy")
    put = {q.symbol: values[q.name] for q in system.parameters}
    states = [q.symbol for q in system.states]
    f = sp.lambdify(states, energy.subs(put))
    gradient = sp.lambdify(states, [sp.diff(energy.subs(put), x) for x in states])
    off = abs(f(*rough.y) - f(*run.y))
    slope = np.linalg.norm(np.array(np.broadcast_arrays(*gradient(*run.y))), axis=0)
    error = np.linalg.norm(rough.y - run.y, axis=0)
    seen = off > 1e-8
    assert seen.sum() > 20
    assert np.all(error[seen] > 0.98 * off[seen] / slope[seen])
    late = np.roll(run.y, 3, axis=1)[:, 3:]  # right motion, wrong time
    assert abs(f(*late) - f(*run.y[:, 3:])).max() < 1e-9
    assert np.linalg.norm(late - run.y[:, 3:], axis=0).min() > 0.01


@says(
    ACCURACY,
    "An error in the constants changes the time between flips, so the end is known to fewer digits than the drift suggests.",
)
def constants_set_the_time_between_flips():
    moments, start = (1.5e-4, 4.0e-4, 5.2e-4), np.array([0.05, 10.0, 0.05])
    free, moved = (codegen.free_motion(moments, s) for s in (start, start * (1, 1 + 1e-6, 1)))
    relative = abs(moved.period / free.period - 1)
    assert 1e-8 < relative < 1e-4
    end = abs(free(np.array([100.0]))[0] - moved(np.array([100.0]))[0]).max() / 10
    assert end > 10e-6


@says(
    CONTROL,
    "About the third axis they are the roots of s^2 + 5/8 s + 1/16, by hand: -1/8 and -1/2.",
)
def the_regulated_satellite_about_its_third_axis():
    s = sp.Symbol("s")
    k, d, moment = 1, 5, 8
    # small turn a: q3 = a/2 and omega_3 = a', so that 8 a'' = -k a/2 - d a'
    found = sp.roots(moment * s**2 + d * s + sp.Rational(k, 2), s)
    assert set(found) == {-sp.Rational(1, 8), -sp.Rational(1, 2)}
    assert (
        sp.expand(
            8 * (s**2 + sp.Rational(5, 8) * s + sp.Rational(1, 16))
            - moment * s**2
            - d * s
            - sp.Rational(k, 2)
        )
        == 0
    )


@says(CONTROL, "which then decays as exp(-4 t) (1 + 4 t)")
def an_error_under_computed_torque():
    t = sp.Symbol("t", positive=True)
    e = sp.exp(-4 * t) * (1 + 4 * t)
    assert same(e.diff(t, 2) + 8 * e.diff(t) + 16 * e, 0)
    assert (e.subs(t, 0), e.diff(t).subs(t, 0)) == (1, 0)


@says(
    "docs/howto/reaction-wheels.md",
    "(for this pyramid three quarters of the component along its axle)",
)
@says("eom/scenes/reaction-wheels.toml", "rise of the axles, 35.26 degrees")
def each_wheel_gives_three_quarters():
    beta = eom.load_scene("reaction-wheels").parameter_values()["beta"]
    assert abs(np.degrees(beta) - 35.26) < 0.01
    c, s = np.cos(beta), np.sin(beta)
    axles = np.array([[c, 0, s], [0, c, s], [-c, 0, s], [0, -c, s]])
    torque = np.array([0.3, -1.0, 0.6])
    given = sum(a * 0.75 * (a @ torque) for a in axles)
    np.testing.assert_allclose(given, torque)


@says(WORK, "The slope is the order.")
@says(WORK, r"A method of order $p$ pays a factor of $10^{1/p}$ for each further digit")
def further_digits_cost_by_the_order():
    scene = eom.Scene.ready("heavy-top")
    system, start, values = scene.derive(), scene.initial_values(), scene.parameter_values()
    exact = codegen.simulate(system, start, (0, 5), values).y[:, -1]
    for method, order in (("DP5", 5), ("DOP853", 8)):
        runs = [
            codegen.simulate(system, start, (0, 5), values, method, rtol, rtol)
            for rtol in (1e-6, 1e-9)
        ]
        errors = [abs(r.y[:, -1] - exact).max() for r in runs]
        digits = np.log10(errors[0] / errors[1])
        paid = np.log10(runs[1].steps / runs[0].steps) / digits
        assert abs(paid * order - 1) < 0.35, (method, paid * order)


@says(
    "docs/howto/analysis.md",
    "A zero root stands for a change into a steady motion nearby, which stays; it is put aside.",
)
def zero_roots_are_steady_motions_nearby():
    free = free_rigid_body()
    w = [q.symbol for q in free.states]
    nu = sp.Symbol("nu", positive=True)
    J = sp.Matrix(free.rates).jacobian(w).subs({w[0]: nu, w[1]: 0, w[2]: 0})
    (zero,) = [v for value, _, v in J.eigenvects() if value == 0]
    assert [bool(x) for x in zero[0]] == [True, False, False]
    assert all(r.subs({w[0]: 2 * nu, w[1]: 0, w[2]: 0}) == 0 for r in free.rates)


@says(
    "docs/howto/constraints.md",
    "A plane linkage with spatial pins has more conditions than it needs.",
)
def a_plane_linkage_has_more_conditions_than_it_needs():
    end = Placement((1.0, 0.0, 0.0))
    bodies = [Body(n, 1.0, (0.5, 0, 0), (0.01, 0.1, 0.1)) for n in ("crank", "coupler", "rocker")]
    joints = [
        Joint("a", "revolute", "ground", "crank", "y"),
        Joint("b", "revolute", "crank", "coupler", "y", on_parent=end),
        Joint("c", "revolute", "ground", "rocker", "y", on_parent=Placement((1.2, 0.0, 0.0))),
    ]
    pin = Loop("pin", "revolute", "coupler", "rocker", "y", on_first=end, on_second=end)
    told = str(examine(Tree("linkage", bodies, joints, constraints=[pin])))
    assert told.startswith("1 degrees of freedom")
    assert told.count("holds by itself") == 3  # of five conditions two do


@says(
    "docs/howto/analysis.md",
    "A damper (`dissipation`) or another force along a cyclic coordinate changes its momentum",
)
def cyclic_momenta_are_constant_without_forces():
    theta, psi, a, b = sp.symbols("theta psi theta_dot psi_dot", real=True)
    m, k = sp.symbols("m k", positive=True)
    kinetic = m * (a**2 + b**2 * sp.sin(theta) ** 2) / 2
    rates = {psi: b, theta: a}
    free = Lagrangian("free", rates, kinetic, m * sp.cos(theta))
    (found,) = cyclic_coordinates(free)
    assert found.coordinate == psi
    assert same(found.momentum, m * b * sp.sin(theta) ** 2)
    damped = Lagrangian("damped", rates, kinetic, m * sp.cos(theta), dissipation=k * b**2 / 2)
    (braked,) = cyclic_coordinates(damped)
    assert "does not depend" in found.reason
    assert braked.reason != found.reason


@says("docs/howto/rotary-pendulum.md", "The motor holds the rod upright, where it falls by itself.")
def the_rod_of_the_rotary_pendulum_falls_by_itself():
    scene = eom.load_scene("rotary-pendulum")
    compiled = codegen.compile(scene.derive(), "numpy")
    near = codegen.linearise(compiled, np.zeros(4), scene.parameter_values(), [0.0])
    assert np.linalg.eigvals(near.A).real.max() > 5
