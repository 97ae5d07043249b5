"""At rest, at zero, near singular angles: numbers are finite wherever the exact value is.

The exact value is that of the 50-digit interpreter; where it has none, it is the limit, if the values
at points on two sides and at two distances agree. Where a mass matrix is singular, accelerations are
not determined, and there is nothing to be finite.
"""

import math

import numpy as np
import pytest
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod,
    LagrangesMethod,
    Lagrangian,
    Particle,
    Point,
    ReferenceFrame,
    RigidBody,
    dynamicsymbols,
    inertia,
)
from sympy.physics.mechanics.models import multi_mass_spring_damper, n_link_pendulum_on_cart

import codegen
from codegen.derivatives.derivative import JACOBIAN, jacobian
from codegen.frontend.from_sympy_mechanics import as_system
from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir import interpret as oracle
from codegen.ir.interpret import interpret, interpret_exactly
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Program
from eom.kinematics.coordinates import SEQUENCES, attitude
from eom.mechanics.rigidbody import full_inertia, rigid_body
from eom.mechanics.torques import gravity_gradient, weight
from eom.opening import load_scene
from eom.scenes import catalogue

LARGEST = 1e300
NEAR = (1e-8, 1e-16)


def rolling_disc():
    """SymPy's own example: a thin disc that rolls on a plane, yaw, lean and spin."""
    q, u = dynamicsymbols("q1:4"), dynamicsymbols("u1:4")
    r, m, g = sp.symbols("r m g", positive=True)
    N = ReferenceFrame("N")
    yawed = N.orientnew("Y", "Axis", [q[0], N.z])
    L = yawed.orientnew("L", "Axis", [q[1], yawed.x])
    R = L.orientnew("R", "Axis", [q[2], L.y])
    turning = R.ang_vel_in(N)
    R.set_ang_vel(N, u[0] * L.x + u[1] * L.y + u[2] * L.z)
    contact = Point("C")
    contact.set_vel(N, 0)
    centre = contact.locatenew("centre", r * L.z)
    centre.v2pt_theory(contact, N, R)
    J = inertia(L, m * r**2 / 4, m * r**2 / 2, m * r**2 / 4)
    disc = RigidBody("disc", centre, R, m, (J, centre))
    speeds = [(R.ang_vel_in(N) - turning).dot(axis) for axis in L]
    kane = KanesMethod(N, q, u, speeds)
    kane.kanes_equations([disc], [(centre, -m * g * yawed.z)])
    return kane


def spherical_pendulum():
    """Colatitude and longitude: singular where the bob hangs straight down."""
    a, b = dynamicsymbols("a b")
    m, g, l = sp.symbols("m g l", positive=True)
    N, O = ReferenceFrame("N"), Point("O")
    O.set_vel(N, 0)
    P = O.locatenew(
        "P", l * (sp.sin(a) * sp.cos(b) * N.x + sp.sin(a) * sp.sin(b) * N.y - sp.cos(a) * N.z)
    )
    P.set_vel(N, P.pos_from(O).dt(N))
    bob = Particle("bob", P, m)
    bob.potential_energy = -m * g * l * sp.cos(a)
    method = LagrangesMethod(Lagrangian(N, bob), [a, b])
    method.form_lagranges_equations()
    return method


def full(name):
    return rigid_body(full_inertia(), lambda C, J: weight(C), attitude(name), name="full")


SYSTEMS = {
    **{name: lambda name=name: load_scene(name).derive() for name in catalogue.single()},
    "pendulum": lambda: as_system(n_link_pendulum_on_cart(2)),
    "springs": lambda: as_system(multi_mass_spring_damper(2, True, True)),
    "rolling disc": lambda: as_system(rolling_disc()),
    "spherical pendulum": lambda: as_system(spherical_pendulum()),
    **{f"full, {name}": lambda name=name: full(name) for name in (*SEQUENCES, "quaternion")},
    "orbit": lambda: rigid_body(full_inertia(), gravity_gradient, attitude("3-2-1"), name="orbit"),
}
ANGLES = {"rolling disc": {"q2": math.pi / 2}, "spherical pendulum": {"a": 0.0}}
"""Singular values of the coordinates of systems that do not say them themselves."""


@pytest.fixture(scope="module", params=SYSTEMS)
def case(request):
    """A system, and the program of its rates and of their derivatives by the states."""
    system = SYSTEMS[request.param]()
    derived = jacobian(prune(lower_system(system), [RATES]), RATES).program
    return request.param, system, derived


# --- the points ---------------------------------------------------------------------------------------


def parameters(system, zero=(), equal=False):
    """Ordinary numbers, distinct, of a body that exists; those named in ``zero`` are zero."""
    found = {}
    for k, q in enumerate(system.parameters):
        moment = q.name[0] in "IJ" and q.symbol.is_positive
        product = q.name[0] == "J" and not moment
        found[q.name] = 2.0 + 0.25 * k if moment else 0.05 * (k + 1) if product else 0.5 + 0.125 * k
        if moment and equal:
            found[q.name] = 2.0
    return [0.0 if name in zero else v for name, v in found.items()]


def states(system, **given):
    return [given.get(q.name, 0.0) for q in system.states]


def moving(system, seed=1):
    draw = np.random.default_rng(seed).uniform
    return dict(
        zip(system.state_names, map(float, draw(0.2, 1.2, len(system.states))), strict=True)
    )


def points(name, system):
    """(what, point): zero states, zero parameters, equal moments, near singular angles."""
    free = [q.name for q in system.parameters if not q.symbol.is_positive]
    unit = {q: 1.0 for q in system.state_names if q == "q0"}  # the attitude of no rotation
    forces = [0.0] * len(system.inputs)

    def at(x, p):
        return oracle.Point(0.0, x, p, forces)

    ordinary, still = parameters(system), states(system, **unit)
    yield "zero", at(states(system), ordinary)
    yield "at rest", at(still, ordinary)
    yield "zero, equal moments", at(still, parameters(system, free, equal=True))
    yield (
        "moving, equal moments",
        at(states(system, **moving(system)), parameters(system, equal=True)),
    )
    for zero in ([n] for n in free):
        yield f"at rest, {zero[0]} = 0", at(still, parameters(system, zero))
        yield (
            f"moving, {zero[0]} = 0",
            at(states(system, **moving(system)), parameters(system, zero)),
        )
    yield "moving, all zero", at(states(system, **moving(system)), parameters(system, free))
    for angle, singular in singular_angles(name, system).items():
        for distance in NEAR:
            for side in (-1, 1):
                near = {angle: singular + side * distance}
                what = f"{angle} = {near[angle]!r}"
                yield f"{what}, else at rest", at(states(system, **near), ordinary)
                yield what, at(states(system, **{**moving(system), **near}), ordinary)


def singular_angles(name, system):
    """The coordinate of each singularity, and the value near zero at which it is singular."""
    found = dict(ANGLES.get(name, {}))
    for s in system.singularities:
        found[s.coordinate.name] = 0.0 if s.expression.has(sp.sin) else math.pi / 2
    return found


# --- the judgement --------------------------------------------------------------------------------------


def failures(program, point, system=None, got=None):
    """(group, number) of results that are not finite although the exact value, or limit, is."""
    got = interpret(program, point) if got is None else got
    if all(math.isfinite(v) for values in got.values() for v in values):
        return []
    if system is not None and is_singular(system, point):
        return []
    exact = interpret_exactly(program, point)
    bad = []
    for group, values in exact.items():
        for k, (value, double) in enumerate(zip(values, got[group], strict=True)):
            if not math.isfinite(double) and not abs(value) > LARGEST:  # NaN is not greater
                finite = not math.isnan(float(value)) or limit_exists(program, point, group, k)
                bad += [(group, k)] if finite else []
    return bad


def is_singular(system, point):
    """Return whether the mass matrix is singular, in 50 digits."""
    if system.mass_matrix is None:
        return False
    groups = system.states, system.parameters, system.inputs
    numbers = zip(groups, (point.x, point.p, point.u), strict=True)
    known = {
        q.symbol: sp.Rational(v) for group, v in numbers for q, v in zip(group, v, strict=True)
    }
    for definition in system.definitions:
        known[definition.symbol] = definition.expression.xreplace(known)
    matrix = system.mass_matrix.xreplace(known).evalf(50)
    return abs(matrix.det()) < 1e-40


def limit_exists(program, point, group, k):
    """Return whether the values agree at two distances in three directions, two of them opposite."""
    rng = np.random.default_rng(7)
    one = prune(Program(program.instructions, {"f": (program.results[group][k],)}))
    numbers = [*point.x, *point.p, *point.u]
    n, m = len(point.x), len(point.x) + len(point.p)
    first, second = rng.uniform(-1, 1, (2, len(numbers)))
    values = []
    for direction in (first, -first, second):
        for size in (1e-9, 1e-10):
            v = [a + size * d for a, d in zip(numbers, direction, strict=True)]
            near = oracle.Point(point.t, v[:n], v[n:m], v[m:])
            values.append(float(interpret_exactly(one, near)["f"][0]))
    spread = max(values) - min(values)
    return all(map(math.isfinite, values)) and spread <= 1e-5 * (1 + abs(values[0]))


@pytest.mark.sparse(2)
def test_values_and_derivatives_are_finite_where_the_exact_ones_are(case):
    name, system, program = case
    found = {what: failures(program, point, system) for what, point in points(name, system)}
    assert {what: bad for what, bad in found.items() if bad} == {}


@pytest.mark.sparse(7)
def test_near_singular_angles_are_tried(case):
    name, system, _ = case
    expected = name in ANGLES or bool(system.singularities)
    assert any("1e-08" in what or "1.57" in what for what, _ in points(name, system)) == expected


@pytest.mark.sparse(only=("numpy",))
def test_compiled_numbers_are_finite_too(target):
    """What the interpreter promises, a target keeps: ready scenes and a body of full inertia."""
    for name in (*catalogue.single(), "full, 3-1-2", "pendulum"):
        system = SYSTEMS[name]()
        compiled = codegen.compile(system, target)
        program = prune(compiled.program, [RATES])
        for what, point in points(name, system):
            got = compiled.rhs(point.t, point.x, point.p, point.u)
            assert failures(program, point, system, {RATES: list(got)}) == [], (name, what)


def test_the_judgement_finds_what_is_lost():
    """(x^2 + x)/x has the limit 1 at zero, x/|x| has none, and 1/x is infinite."""
    x = sp.Symbol("x", real=True)
    program = lower_expressions({RATES: [(x**2 + x) / x, x / sp.Abs(x), 1 / x, x]}, [x])
    assert failures(program, oracle.Point(x=[0.0])) == [(RATES, 0)]
    assert failures(program, oracle.Point(x=[0.5])) == []
    assert failures(program, oracle.Point(x=[0.5]), got={RATES: [math.nan] * 4}) == [
        (RATES, k) for k in range(4)
    ]
    assert JACOBIAN in jacobian(program, RATES).program.results
