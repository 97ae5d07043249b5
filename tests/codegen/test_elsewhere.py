import numpy as np
import pytest
import sympy as sp
from sympy.physics import mechanics as me
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
