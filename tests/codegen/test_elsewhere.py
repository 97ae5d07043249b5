import numpy as np
import pytest
import sympy as sp
from sympy.physics import mechanics as me
from sympy.physics.biomechanics import TendonForceLengthDeGroote2016
from sympy.physics.mechanics import (
    KanesMethod,
    LagrangesMethod,
    Lagrangian,
    Particle,
    Point,
    ReferenceFrame,
    dynamicsymbols,
)
from sympy.physics.mechanics.models import multi_mass_spring_damper, n_link_pendulum_on_cart
from sympy.utilities.exceptions import ignore_warnings

import codegen
import eom
from codegen.frontend.from_sympy_mechanics import as_system
from eom.errors import InputError
from eom.rotations import quaternion_product
from eom.typeset.printing import show

q, u = dynamicsymbols("q u")
m, g, l = sp.symbols("m g l", positive=True)


def numbers(system, seed=2):
    rng = np.random.default_rng(seed)
    groups = system.states, system.parameters, system.inputs
    return [rng.uniform(0.5, 1.5, len(group)) for group in groups]


def expected(states, right, mass, system, values):
    """M^-1 f by SymPy's own numbers."""
    x, p, inputs = values
    names = [*system.state_names, *(k.name for k in system.parameters)]
    names += [k.name for k in system.inputs]
    known = dict(zip(names, [*x, *p, *inputs], strict=True))
    everything = sp.Matrix.hstack(sp.Matrix(mass), sp.Matrix(right))
    functions = sorted(
        everything.atoms(sp.Derivative) | everything.atoms(sp.core.function.AppliedUndef),
        key=lambda f: -f.count_ops() - isinstance(f, sp.Derivative),
    )
    spelt = {f: spell(f) for f in functions}
    numeric = everything.xreplace({f: known[n] for f, n in spelt.items() if n in known})
    numeric = numeric.xreplace({s: known[s.name] for s in numeric.free_symbols})
    filled = np.array(numeric, dtype=float)
    return np.linalg.solve(filled[:, :-1], filled[:, -1])


def spell(f):
    if isinstance(f, sp.Derivative):
        return f"{spell(f.expr)}_{'d' * sum(int(k) for _, k in f.variable_count)}ot"
    return f.func.__name__


@pytest.mark.sparse(3)
@pytest.mark.parametrize("links", [1, 2, 4])
@pytest.mark.parametrize("target", ["numpy", "auto"])
def test_kanes_method(links, target):
    kane = n_link_pendulum_on_cart(links)
    compiled = codegen.compile(kane, target)
    system = compiled.system
    values = numbers(system)
    wanted = expected([*kane.q, *kane.u], kane.forcing_full, kane.mass_matrix_full, system, values)
    assert np.allclose(compiled.rhs(0.0, *values), wanted, rtol=1e-12)
    assert system.input_names == ("F",)


def test_a_mechanics_system():
    chain = multi_mass_spring_damper(3, True, True)
    compiled = codegen.compile(chain, "numpy")
    kane = chain.eom_method if hasattr(chain, "eom_method") else chain
    values = numbers(compiled.system)
    wanted = expected(None, kane.forcing_full, kane.mass_matrix_full, compiled.system, values)
    assert np.allclose(compiled.rhs(0.0, *values), wanted, rtol=1e-12)


def lagrange():
    N, O = ReferenceFrame("N"), Point("O")
    O.set_vel(N, 0)
    P = O.locatenew("P", l * sp.sin(q) * N.x - l * sp.cos(q) * N.y)
    P.set_vel(N, P.pos_from(O).dt(N))
    bob = Particle("bob", P, m)
    bob.potential_energy = -m * g * l * sp.cos(q)
    return LagrangesMethod(Lagrangian(N, bob), [q])


def test_lagranges_method():
    method = lagrange()
    method.form_lagranges_equations()
    system = as_system(method, "pendulum")
    assert system.state_names == ("q", "q_dot")
    x, p, _ = numbers(system)
    named = dict(zip((k.name for k in system.parameters), p, strict=True))
    rates = codegen.compile(system, "numpy").rhs(0.0, x, p)
    assert np.allclose(rates, [x[1], -named["g"] / named["l"] * np.sin(x[0])], rtol=1e-13)


def test_states_and_rates_of_functions_with_prescribed_motion():
    drive, t = dynamicsymbols("drive"), dynamicsymbols._t
    rates = (
        u,
        -g / l * sp.sin(q) - drive.diff(t, 2) * sp.cos(q) + drive + sp.sin(3 * sp.Symbol("t")),
    )
    system = as_system(([q, u], rates))
    assert system.state_names == ("q", "u")
    assert system.input_names == ("drive", "drive_ddot")
    got = codegen.compile(system, "numpy").rhs(0.4, (0.3, 0.7), (9.8, 2.0), (0.1, -0.5))
    assert np.allclose(
        got, [0.7, -4.9 * np.sin(0.3) + 0.5 * np.cos(0.3) + 0.1 + np.sin(1.2)], rtol=1e-14
    )


def test_mass_matrix_and_forces_over_plain_symbols():
    x, v = sp.symbols("x v")
    compiled = codegen.compile(([x, v], [[1, 0], [0, m]], [v, -g * x]), "numpy")
    assert compiled.rhs(0.0, [1.0, 2.0], [3.0, 4.0]).tolist() == [2.0, -0.75]


class Derivable:
    def derive(self):
        """Like a scene."""


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (3, "not a system"),
        (Derivable(), r"derive\(\) of a scene"),
        ("x", "not a system"),
        (([q], [u], [u], [u]), "not a system"),
        ((q, [u]), "states are not a list"),
        (([q], ["u"]), "rates are not expressions"),
        (([q], [sp.Function("f")(q)]), "not a function of time"),
        (([sp.Symbol("q"), q], [u, u]), "two variables"),
        (lagrange(), "form_lagranges_equations"),
    ],
)
def test_what_is_no_system_is_refused(given, words):
    with pytest.raises(InputError, match=words):
        codegen.compile(given, "numpy")


def test_kanes_method_without_equations_is_refused():
    N = ReferenceFrame("N")
    bare = KanesMethod(N, [q], [u], kd_eqs=[q.diff() - u])
    with pytest.raises(InputError, match="kanes_equations"):
        codegen.compile(bare)


def quaternion_kane(slip=0):
    """A free body by Kane's method, its quaternion and body rates functions of time."""
    e, w = dynamicsymbols("e0:4"), dynamicsymbols("w1:4")
    A, B, C = sp.symbols("A B C", positive=True)
    turn = quaternion_product(e, (0, *w))
    J = sp.diag(A, B, C)
    spin = -sp.Matrix(w).cross(J * sp.Matrix(w))
    mass = sp.diag(sp.eye(4), J)
    stated = eom.BodyAttitude(w, "quaternion", e, inertia=J, torque=(slip, 0, 0))
    return ([*e, *w], mass, [*(r / 2 for r in turn), *spin]), stated


def test_attitudes_are_stated_over_functions_of_time():
    given, stated = quaternion_kane()
    compiled = codegen.compile(given, "numpy", attitudes=[stated])
    start = dict(zip(compiled.system.state_names, (1, 0, 0, 0, 0.1, 0.2, 1.0), strict=True))
    result = codegen.simulate(compiled, start, (0, 3), {"A": 1.0, "B": 2.0, "C": 4.0})
    assert result.method == "closed form: free body"
    bare = codegen.compile(given, "numpy")
    assert bare.layout.attitudes == ()
    again = codegen.compile(bare.system, "numpy", attitudes=compiled.system.attitudes)
    assert again.system == compiled.system


def test_false_attitudes_are_refused():
    given, stated = quaternion_kane(slip=1)
    with pytest.raises(InputError, match="component 1"):
        codegen.compile(given, "numpy", attitudes=[stated])


def test_joints_method_is_its_method():
    with ignore_warnings(DeprecationWarning):
        wall, cart = me.Body("wall"), me.Body("cart", mass=m)
        joints = me.JointsMethod(wall, me.PrismaticJoint("rail", wall, cart, q, u))
    cart.apply_force(-g * q * wall.x)
    with pytest.raises(InputError, match="form_eoms"):
        as_system(joints)
    with ignore_warnings(DeprecationWarning):
        joints = me.JointsMethod(wall, me.PrismaticJoint("track", wall, cart, q, u))
    joints.form_eoms()
    system = as_system(joints)
    values = {"g": 3.0, "m": 4.0}
    p = [values[n] for n in system.parameter_names]
    assert codegen.compile(system, "numpy").rhs(0.0, [2.0, 0.5], p).tolist() == [0.5, -1.5]


# -- constraints -----------------------------------------------------------------------------------


def on_a_circle():
    """A bob in Cartesian coordinates, by multipliers."""
    x, y = dynamicsymbols("x y")
    N, O = ReferenceFrame("N"), Point("O")
    O.set_vel(N, 0)
    P = O.locatenew("P", x * N.x + y * N.y)
    P.set_vel(N, P.pos_from(O).dt(N))
    bob = Particle("bob", P, m)
    bob.potential_energy = m * g * y
    method = LagrangesMethod(Lagrangian(N, bob), [x, y], hol_coneqs=[x**2 + y**2 - l**2])
    method.form_lagranges_equations()
    return method


def test_multipliers_are_outputs_and_constraints_are_maintained():
    compiled = codegen.compile(on_a_circle(), "numpy")
    system = compiled.system
    assert system.output_names == ("lam1",)
    assert system.maintained == ("closure_1", "closure_rate_1")
    known = {"g": 10.0, "l": 2.0, "m": 3.0}
    start = {"x": 2.0, "y": 0.0, "x_dot": 0.0, "y_dot": 0.0}
    run = codegen.simulate(compiled, start, (0, 3), known)
    theta, omega = sp.symbols("theta omega")
    pendulum = eom.System.from_rates("pendulum", {theta: omega, omega: -5 * sp.sin(theta)})
    plain = codegen.simulate(pendulum, {"theta": np.pi / 2, "omega": 0.0}, (0, 3))
    angle, rate = plain["theta"][-1], plain["omega"][-1]
    assert run["x"][-1] == pytest.approx(2 * np.sin(angle), abs=1e-6)
    # the pull in the string: m (g cos theta + l omega^2) = 2 l lam1
    pull = 3 * (10 * np.cos(angle) + 2 * rate**2)
    assert 2 * 2 * run["lam1"][-1] == pytest.approx(pull, rel=1e-6)


def test_the_multiplier_is_that_of_solve_multipliers_and_hangs_straight_down_too():
    """Where the constraint's row vanishes in one coordinate, no pivot does: rows are exchanged."""
    method = on_a_circle()
    compiled = codegen.compile(method, "numpy")
    x, y = method.q
    point = {"x": 0.0, "y": -2.0, "x_dot": 1.5, "y_dot": 0.0}
    p = {"g": 10.0, "l": 2.0, "m": 3.0}
    values = {x: 0, y: -2, x.diff(): sp.Rational(3, 2), y.diff(): 0, m: 3, g: 10, l: 2}
    (wanted,) = method.solve_multipliers(values).values()
    state = [point[n] for n in compiled.system.state_names]
    parameters = [p[n] for n in compiled.system.parameter_names]
    assert compiled.outputs(0.0, state, parameters) == pytest.approx([float(wanted)], rel=1e-15)
    assert compiled.rhs(0.0, state, parameters)[2:] == pytest.approx([0.0, 1.5**2 / 2], rel=1e-15)


def test_it_hangs_at_rest_and_swings_about_that():
    compiled = codegen.compile(on_a_circle(), "numpy")
    point = codegen.equilibrium(compiled, {"x": 0.1, "y": -0.9}, {"g": 9.0, "l": 1.0, "m": 2.0})
    near = codegen.linearise_about(compiled, point)
    assert near.states == ("x", "x_dot")
    assert np.allclose(near.A, [[0, 1], [-9, 0]], atol=1e-12)


def test_multipliers_are_printed_with_their_rows():
    text = show(as_system(on_a_circle()))
    assert "mass matrix times the rates of x_dot, y_dot, and lam1 = right sides" in text
    assert "row of lam1 = -2*x_dot**2 - 2*y_dot**2" in text


def test_starts_off_the_constraint_are_refused():
    start = {"x": 1.0, "y": 0.1, "x_dot": 0.0, "y_dot": 0.0}
    with pytest.raises(InputError, match="start values meet the constraints"):
        codegen.simulate(as_system(on_a_circle()), start, (0, 1), {"g": 1, "l": 1, "m": 1})


def test_a_constraint_that_an_input_moves_is_said_to_be_open():
    """A slider that is driven along x by a function of time: x = drive(t)."""
    x, y, drive = dynamicsymbols("x y drive")
    T = dynamicsymbols._t
    method = LagrangesMethod(
        m * (x.diff(T) ** 2 + y.diff(T) ** 2) / 2 - m * g * y, [x, y], hol_coneqs=[x - drive]
    )
    method.form_lagranges_equations()
    system = as_system(method)
    assert (system.input_names, system.invariant_names) == (("drive_ddot",), ())
    said = [a.meaning for a in system.assumptions]
    assert len(said) == 2
    assert all("neither tested nor maintained" in words for words in said)
    found = codegen.compile(system, "numpy")
    p = {"g": 9.0, "m": 2.0}
    parameters = [p[n] for n in system.parameter_names]
    assert found.rhs(0.0, [0.0] * 4, parameters, [5.0]).tolist() == [0.0, 0.0, 5.0, -9.0]
    # the force that the drive takes: m x'' + lam1 = 0
    assert found.outputs(0.0, [0.0] * 4, parameters, [5.0]).tolist() == [-10.0]


def test_control_stands_between_states_and_multipliers():
    system = as_system(on_a_circle())
    z = sp.Symbol("z", real=True)
    wider = system.with_control({}, {z: -z})
    assert wider.state_names[-1] == "z"
    values = [np.full(len(group), 0.7) for group in (wider.states, wider.parameters)]
    plain = codegen.compile(system, "numpy").rhs(0.0, values[0][:-1], values[1])
    found = codegen.compile(wider, "numpy").rhs(0.0, *values)
    assert found.tolist() == [*plain, -0.7]


def test_auxiliary_speeds_are_zero():
    """The force that an auxiliary speed brings out does no work: the equations are those without it."""
    found = []
    for with_auxiliary in (False, True):
        N, P, ua, f = ReferenceFrame("N"), Point("P"), *dynamicsymbols("u_a f")
        P.set_vel(N, u * N.x + (ua * N.y if with_auxiliary else 0))
        extra = {"u_auxiliary": [ua]} if with_auxiliary else {}
        kane = KanesMethod(N, [q], [u], kd_eqs=[q.diff() - u], **extra)
        force = (-g * q - ua * q) * N.x + f * N.y
        if not with_auxiliary:
            force = force.subs(ua, 0)
        kane.kanes_equations([Particle("p", P, m)], [(P, force)])
        found.append(as_system(kane))
    assert found[0].rates == found[1].rates
    assert found[0].mass_matrix == found[1].mass_matrix
    assert found[1].input_names == ()


# -- as they come ----------------------------------------------------------------------------------


def test_whole_matrices_as_they_come_with_states_as_a_matrix():
    kane = n_link_pendulum_on_cart(2)
    states = sp.Matrix([*kane.q, *kane.u])
    whole = as_system((states, kane.mass_matrix_full, kane.forcing_full))
    own = as_system(kane)
    assert (whole.state_names, whole.input_names) == (own.state_names, ("F",))
    values = numbers(own)
    found = [codegen.compile(s, "numpy").rhs(0.0, *values) for s in (whole, own)]
    assert np.allclose(*found, rtol=1e-13)


def test_the_rate_of_a_state_is_no_input():
    T = dynamicsymbols._t
    system = as_system(([q, u], [[1, 0], [0, m]], [u, -q.diff(T) - q]))
    assert system.input_names == ()
    assert codegen.compile(system, "numpy").rhs(0.0, [2.0, 3.0], [4.0]).tolist() == [3.0, -1.25]
    with pytest.raises(InputError, match="a rate of a state stands on the right side"):
        as_system(([q, u], [[2, 0], [0, m]], [u, -q.diff(T)]))
    with pytest.raises(InputError, match="a rate of a state"):
        as_system(([q, u], [u, u.diff(T)]))


def test_two_symbols_of_time_are_told():
    late = sp.Symbol("t", real=True)
    with pytest.raises(InputError, match="two symbols called t"):
        as_system(([q, u], [u, sp.sin(late)]))
    with pytest.raises(InputError, match=r"two symbols called t"):
        as_system(([sp.Function("q")(late), u], [u, u]))
    with pytest.raises(InputError, match=r"eom\.TIME"):
        eom.System.from_rates("late", {sp.Symbol("x"): sp.sin(sp.Symbol("t"))})


def test_derivatives_of_expressions_are_carried_out():
    T = dynamicsymbols._t
    given = ([q, u], [u, sp.Derivative(sp.sin(q), T) + sp.Derivative(q**2, q)])
    assert sp.simplify(as_system(given).rates[1] - sp.sympify("u*cos(q) + 2*q", {
        "u": sp.Symbol("u", real=True), "q": sp.Symbol("q", real=True)})) == 0  # fmt: skip


def test_curves_of_muscles_compile():
    curve = TendonForceLengthDeGroote2016.with_defaults(q)
    T = dynamicsymbols._t
    slope = sp.Derivative(curve, T, evaluate=False)
    compiled = codegen.compile(([q, u], [u, curve + slope]), "numpy")
    x = sp.Symbol("x")
    f = TendonForceLengthDeGroote2016.with_defaults(x).doit()
    at = {x: sp.Rational(11, 10)}
    wanted = f.subs(at) + sp.Rational(1, 2) * f.diff(x).subs(at)
    assert compiled.rhs(0.0, [1.1, 0.5])[1] == pytest.approx(float(wanted), rel=1e-13)
    plain = eom.System.from_rates("tendon", {x: -TendonForceLengthDeGroote2016.with_defaults(x)})
    assert codegen.compile(plain, "numpy").rhs(0.0, [1.1])[0] == pytest.approx(
        -float(f.subs(at)), rel=1e-13
    )


def by_hand(form):
    """SymPy's own example of a SymbolicSystem: a pendulum in x and y, and the force in its rod."""
    x, y, a, b, force = dynamicsymbols("x y a b force")
    M = sp.Matrix([[1, 0, -x / m], [0, 1, -y / m], [0, 0, l**2 / m]])
    F, kin = sp.Matrix([0, 0, a**2 + b**2 - g * y]), sp.Matrix([a, b])
    states, whole = (x, y, a, b, force), sp.diag(sp.eye(2), M)
    asked = {sp.Symbol("PE"): m * g * (l + y)}
    if form == 1:
        explicit = whole.LUsolve(kin.col_join(F))
        return me.SymbolicSystem(states, explicit, alg_con=[4], output_eqns=asked)
    if form == 2:
        right = kin.col_join(F)
        return me.SymbolicSystem(states, right, mass_matrix=whole, alg_con=[4], output_eqns=asked)
    return me.SymbolicSystem(
        states, F, mass_matrix=M, coordinate_derivatives=kin, alg_con=[2], output_eqns=asked
    )


@pytest.mark.parametrize("form", [1, 2, 3])
def test_a_symbolic_system_in_each_of_its_forms(form):
    compiled = codegen.compile(by_hand(form), "numpy")
    system = compiled.system
    assert system.state_names == ("x", "y", "a", "b")
    assert system.output_names == ("force", "PE")
    p = {"g": 10.0, "l": 2.0, "m": 3.0}
    parameters = [p[n] for n in system.parameter_names]
    state = [1.2, -1.6, 0.8, 0.6]
    pull = 3 / 4 * (1 + 16)
    expected = [0.8, 0.6, 1.2 * pull / 3, -1.6 * pull / 3]
    assert compiled.rhs(0.0, state, parameters) == pytest.approx(expected, rel=1e-14)
    assert compiled.outputs(0.0, state, parameters) == pytest.approx([pull, 12.0], rel=1e-14)


def test_an_algebraic_row_without_an_unknown_is_refused():
    x, y, force = dynamicsymbols("x y force")
    M = sp.diag(1, 1, 0)
    given = me.SymbolicSystem(
        (x, y, force), [y, force, x**2 + y**2], mass_matrix=M, alg_con=[2]
    )  # fmt: skip
    with pytest.raises(InputError, match="without an unknown of its own"):
        as_system(given)


class OwnMethod(KanesMethod):
    """A user's own."""


def test_classes_made_of_sympy_s_are_read():
    N, P = ReferenceFrame("N"), Point("P")
    P.set_vel(N, u * N.x)
    kane = OwnMethod(N, [q], [u], kd_eqs=[q.diff() - u])
    kane.kanes_equations([Particle("p", P, m)], [(P, -g * q * N.x)])
    assert as_system(kane).state_names == ("q", "u")
