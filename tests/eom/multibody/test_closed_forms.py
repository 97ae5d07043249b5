"""Closed forms by three methods: against each other, `derive`, and textbooks; changed terms are noticed."""

from dataclasses import replace
from functools import lru_cache
from xml.dom.minidom import parseString

import pytest
import sympy as sp

import codegen
from eom.derivations.verification import DerivationError
from eom.errors import InputError
from eom.exact.identity import equal
from eom.multibody import Body, Distance, Joint, Load, Motion, Placement, Rotor, Tree, derive
from eom.multibody.closed import METHODS, absolute_angles, closed_form, compare, tree_page
from eom.multibody.closed.mechanism import MOST
from eom.multibody.closed.readable import KINDS
from tests.eom.multibody.small_trees import (
    DOWN,
    I1,
    I2,
    I3,
    J1,
    J2,
    SCENES,
    A,
    F,
    M,
    Omega,
    arm,
    c,
    cart_pendulum,
    g,
    k,
    l,
    l1,
    l2,
    l3,
    m,
    m1,
    m2,
    m3,
    pendulum,
    rotating,
    spherical_pendulum,
    t,
    top,
    top_by_angles,
)
from tests.eom.multibody.trees import tree
from tests.eom.rows import every


def on_sphere(given):
    """Quaternions of norm 1, by stereographic projection: nothing else is assumed of them."""
    found = {}
    for joint in given.ordered:
        e = [q.symbol for q in joint.coordinates if q.name.startswith("e_")]
        if e:
            x = [sp.Symbol(f"p_{s.name}") for s in e[1:]]
            square = sum(s**2 for s in x)
            found[e[0]] = (1 - square) / (1 + square)
            found |= {s: 2 * p / (1 + square) for s, p in zip(e[1:], x, strict=True)}
    return found


def assert_is_derived(given, form):
    """M u' = f and q' of a closed form for the accelerations of the articulated-body recursion."""
    other, sphere = derive(given, invariants=False), on_sphere(given)
    n = len(form.coordinates)
    assert form.system.state_names == other.state_names
    rates = [other.expand(r).xreplace(sphere) for r in other.rates]
    for ours, theirs in zip(form.kinematics, rates[:n], strict=True):
        assert equal(form.system.expand(ours).xreplace(sphere), theirs)
    mass = form.system.expand(form.mass_matrix).xreplace(sphere)
    right = form.system.expand(form.forcing).xreplace(sphere)
    assert equal(mass * sp.Matrix(rates[n:]) - right, sp.zeros(len(rates) - n, 1))


@pytest.mark.parametrize("name", every(2, SCENES))
def test_the_methods_agree_with_each_other_and_with_the_recursion(name):
    comparison = compare(SCENES[name])
    assert [f.method for f in comparison.forms] == list(METHODS)
    assert comparison.differences == ()
    assert_is_derived(SCENES[name], comparison.forms[0])


@pytest.mark.parametrize("seed", [5, 6, 7, 11])
def test_the_methods_agree_on_random_trees(seed):
    """Tilted frames, loads, rotors."""
    given = tree(seed, 2)
    for form in compare(given).forms:
        assert form.mass_matrix == form.mass_matrix.T


@pytest.mark.parametrize("kind", ["universal", "planar", "helical", "spherical", "free"])
@pytest.mark.parametrize("attitude", every(3, ["quaternion", "3-1-2", "1-2-1"]))
def test_the_methods_agree_on_every_kind_of_joint(kind, attitude):
    """Quaternions and sequences too: Lagrange's method is that of Boltzmann and Hamel there."""
    given = tree(2, 1, kinds=(kind,), attitudes=(attitude,))
    for form in compare(given).forms:
        assert form.mass_matrix == form.mass_matrix.T


def test_every_method_alone_is_the_recursion():
    given = rotating()
    for method in METHODS:
        assert_is_derived(given, closed_form(given, method))


def test_absolute_angles_give_the_same_motion():
    """Accelerations of theta1 and theta2 are those of the joint angles, added."""
    given = pendulum(2)
    form = closed_form(given, coordinates=absolute_angles(given))
    other = derive(given, invariants=False)
    q1, q2, u1, u2 = (s.symbol for s in other.states)
    theta = [s.symbol for s in form.system.states]
    change = dict(zip(theta, (q1, q1 + q2, u1, u1 + u2), strict=True))
    a1, a2 = (other.expand(r) for r in other.rates[2:])
    residual = form.mass_matrix * sp.Matrix([a1, a1 + a2]) - form.forcing
    moved = residual.xreplace(change)
    assert equal(moved, sp.zeros(2, 1))


# -- textbooks ---------------------------------------------------------------------------------


def terms(form):
    return {(t.equation.name, t.kind, str(t.factor)): t.coefficient for t in form.terms}


def test_double_pendulum_over_absolute_angles_as_in_textbooks():
    """Point masses: Landau and Lifshitz, Mechanics (1976), sec. 5, problem 1, term by term."""
    given = pendulum(2)
    form = closed_form(given, coordinates=absolute_angles(given))
    x, y = (q.symbol for q in form.coordinates)
    assert terms(form) == {
        ("theta_j1_dot", "inertial", "theta_j1_ddot"): J1 + l1**2 * (m1 + m2),
        ("theta_j1_dot", "inertial", "theta_j2_ddot"): l1 * l2 * m2 * sp.cos(x - y),
        ("theta_j1_dot", "centrifugal", "theta_j2_dot**2"): l1 * l2 * m2 * sp.sin(x - y),
        ("theta_j1_dot", "gravity", "1"): g * l1 * (m1 + m2) * sp.sin(x),
        ("theta_j2_dot", "inertial", "theta_j1_ddot"): l1 * l2 * m2 * sp.cos(x - y),
        ("theta_j2_dot", "inertial", "theta_j2_ddot"): J2 + l2**2 * m2,
        ("theta_j2_dot", "centrifugal", "theta_j1_dot**2"): -l1 * l2 * m2 * sp.sin(x - y),
        ("theta_j2_dot", "gravity", "1"): g * l2 * m2 * sp.sin(y),
    }


def test_two_link_arm_as_in_craig():
    """Craig, Introduction to Robotics (2005), sec. 6.7: point masses at the ends of the links."""
    bodies = [Body("one", m1, (l1, 0, 0)), Body("two", m2, (l2, 0, 0))]
    joints = [
        Joint("a", "revolute", "ground", "one", "z", motor=True),
        Joint("b", "revolute", "one", "two", "z", motor=True, on_parent=Placement((l1, 0, 0))),
    ]
    form = closed_form(Tree("arm", bodies, joints, gravity=(0, -g, 0)))
    qa, qb = (q.symbol for q in form.coordinates)
    ua, ub = (u.symbol for u in form.speeds)
    s2, c2, h = sp.sin(qb), sp.cos(qb), m2 * l1 * l2
    assert form.mass_matrix == sp.Matrix(
        [
            [l1**2 * (m1 + m2) + 2 * h * c2 + l2**2 * m2, h * c2 + l2**2 * m2],
            [h * c2 + l2**2 * m2, l2**2 * m2],
        ]
    )
    assert form.column("centrifugal") == sp.Matrix([-h * s2 * ub**2, h * s2 * ua**2])
    assert form.column("coriolis") == sp.Matrix([-2 * h * s2 * ua * ub, 0])
    weight = l2 * m2 * g * sp.cos(qa + qb)
    assert form.column("gravity") == sp.Matrix([weight + (m1 + m2) * l1 * g * sp.cos(qa), weight])


def test_spatial_arm_has_the_products_of_textbooks():
    """Inertia about the vertical: masses at the distances (l2/2) c2 and l2 c2 + l3 c23."""
    form = closed_form(arm())
    q2, q3 = (q.symbol for q in form.coordinates[1:])
    c2, c23 = sp.cos(q2), sp.cos(q2 + q3)
    expected = A + I3 + l2**2 * (m2 + 4 * m3) * c2**2 / 4 + 2 * l2 * l3 * m3 * c2 * c23
    assert form.mass_matrix[0, 0] == expected + l3**2 * m3 * c23**2
    assert form.mass_matrix[1, 2] == l2 * l3 * m3 * sp.cos(q3) + l3**2 * m3


def test_cart_and_pendulum():
    form = closed_form(cart_pendulum(), "kane")
    x, q = (s.symbol for s in form.coordinates)
    v, u = (s.symbol for s in form.speeds)
    tau = form.system.inputs[0].symbol
    assert form.mass_matrix == sp.Matrix(
        [[M + m, -l * m * sp.cos(q)], [-l * m * sp.cos(q), l**2 * m]]
    )
    assert form.forcing == sp.Matrix(
        [tau - k * x - c * v - l * m * u**2 * sp.sin(q), -g * l * m * sp.sin(q)]
    )


def test_spherical_pendulum():
    """Goldstein, Classical Mechanics (2002), ch. 1: m l^2 sin^2 and its centrifugal term."""
    form = closed_form(spherical_pendulum(), "newton-euler")
    theta = form.coordinates[1].symbol
    s, c = sp.sin(theta), sp.cos(theta)
    found = terms(form)
    assert found["u_azimuth", "inertial", "u_azimuth_dot"] == l**2 * m * s**2
    assert found["u_azimuth", "coriolis", "u_azimuth*u_polar"] == 2 * l**2 * m * s * c
    assert found["u_polar", "centrifugal", "u_azimuth**2"] == -(l**2) * m * s * c
    assert len(found) == 5


def test_top_by_angles_and_by_euler_s_equations():
    """Goldstein, Classical Mechanics (2002), sec. 5.7: I1 s^2 + I3 c^2 about the tip; Euler's equations."""
    form = closed_form(top_by_angles())
    theta = form.coordinates[1].symbol
    s, c, whole = sp.sin(theta), sp.cos(theta), I1 + l**2 * m
    assert form.mass_matrix == sp.Matrix(
        [[I3 * c**2 + whole * s**2, 0, I3 * c], [0, whole, 0], [I3 * c, 0, I3]]
    )
    euler = terms(closed_form(top("quaternion")))
    assert euler["w_tip_1", "coriolis", "w_tip_2*w_tip_3"] == -I1 + I3 - l**2 * m
    assert euler["w_tip_3", "inertial", "w_tip_3_dot"] == I3
    assert len(euler) == 7


def test_prescribed_spin_gives_a_skew_matrix_of_gyroscopic_terms():
    """A point on a turning table: 2 m Omega, Coriolis' force seen from the table."""
    joints = [
        Joint("spin", "revolute", "ground", "table", "z", motion=Motion(Omega * t**2)),
        Joint("p", "planar", "table", "puck"),
    ]
    speeds = [
        Joint("x", "prismatic", "table", "slide", "x"),
        Joint("y", "prismatic", "slide", "puck", "y"),
    ]
    given = Tree("table", [Body("table"), Body("slide"), Body("puck", m)], [joints[0], *speeds])
    for method in METHODS:
        form = closed_form(given, method)
        u = {u.symbol: 1 for u in form.speeds}
        spin, rate = (d.symbol for d in form.prescribed[1:])
        assert form.column("gyroscopic").jacobian(list(u)) == 2 * m * spin * sp.Matrix(
            [[0, -1], [1, 0]]
        )
        x, y = (q.symbol for q in form.coordinates)
        assert form.column("prescribed") == -m * spin**2 * sp.Matrix([x, y]) + m * rate * sp.Matrix(
            [-y, x]
        )


def test_a_constant_spin_has_no_rate():
    spin = Joint("spin", "revolute", "ground", "table", "z", motion=Motion(Omega * t))
    slides = [
        Joint("x", "prismatic", "table", "slide", "x"),
        Joint("y", "prismatic", "slide", "puck", "y"),
    ]
    given = Tree("table", [Body("table"), Body("slide"), Body("puck", m)], [spin, *slides])
    form = closed_form(given)
    x, y = (q.symbol for q in form.coordinates)
    speed = form.prescribed[1].symbol
    assert form.column("prescribed") == -m * speed**2 * sp.Matrix([x, y])
    assert form.prescribed[2].expression == 0


def test_a_place_that_is_looked_at_while_it_turns():
    """Foucault: the Earth turns at a rate, and is where its angle is zero; all methods, and `derive`."""
    rate, lat = sp.symbols("n lat", positive=True)
    motion = Motion((0,), (rate,), (0,))
    axis = (0, sp.cos(lat), sp.sin(lat))
    earth = Joint("earth", "revolute", "ground", "earth", axis, motion=motion)
    wire = Joint("wire", "universal", "earth", "bob", "y", second_axis="x")
    bodies = [Body("earth"), Body("bob", m, (0, 0, -l))]
    given = Tree("foucault", bodies, [earth, wire], gravity=DOWN)
    form = compare(given).forms[0]
    assert_is_derived(given, form)
    spin = form.prescribed[1].symbol
    assert spin in form.forcing.free_symbols
    assert not form.forcing.free_symbols & {form.prescribed[0].symbol}


def test_gyroscopic_terms_do_no_work():
    form = closed_form(rotating())
    work = sum(u.symbol * x for u, x in zip(form.speeds, form.column("gyroscopic"), strict=True))
    assert form.column("gyroscopic") != sp.zeros(2, 1)
    assert equal(work, 0)


def test_a_locked_joint_is_a_constant():
    given = replace(
        pendulum(2), joints=(pendulum(2).joints[0], replace(pendulum(2).joints[1], motion=0))
    )
    form = compare(given).forms[0]
    assert form.prescribed == ()
    assert equal(form.mass_matrix, sp.Matrix([[J1 + J2 + l1**2 * m1 + m2 * (l1 + l2) ** 2]]))


def test_inputs_and_applied_forces_stand_on_the_right():
    form = closed_form(arm())
    names = {s.name for s in form.column("applied").free_symbols}
    assert {"F", "tau_waist", "tau_elbow"} <= names
    assert form.system.input_names == ("tau_waist", "tau_shoulder", "tau_elbow", "F")
    assert F in {i.symbol for i in form.system.inputs}
    assert not KINDS["applied"].left


def test_square_roots_in_a_description_are_squared():
    """A joint tilted by 30 degrees: sqrt(3)/2 twice is 3/4."""
    r = sp.sqrt(3) / 2
    tilted = Placement(
        (0, 0, 0), ((1, 0, 0), (0, r, sp.Rational(1, 2)), (0, -sp.Rational(1, 2), r))
    )
    bodies = [Body("a", m, (0, 0, -l), (I1, I2, I3)), Body("b", m, (0, 0, -l), (I1, I2, I3))]
    joints = [Joint("ja", "revolute", "ground", "a", "y"),
              Joint("jb", "fixed", "a", "b", on_parent=tilted)]  # fmt: skip
    form = compare(Tree("tilted", bodies, joints, DOWN)).forms[2]
    assert form.mass_matrix[0].equals(I2 + (3 * I2 + I3) / 4 + l**2 * m * (1 + sp.Rational(3, 4)))


def test_a_closed_form_compiles_to_the_rates_of_the_recursion():
    given = pendulum(2)
    names = ("J1", "J2", "g", "l1", "l2", "m1", "m2")
    values = dict(zip(names, (0.1, 0.2, 9.8, 1.0, 0.7, 2.0, 1.5), strict=True))
    found = []
    for system in (closed_form(given).system, derive(given)):
        parameters = [values[n] for n in system.parameter_names]
        compiled = codegen.compile(system, "numpy")
        found.append(compiled.rhs(0.0, [0.3, -0.8, 1.1, 0.4], parameters))
    assert found[0] == pytest.approx(found[1], rel=1e-12)


# -- mutants -----------------------------------------------------------------------------------


def mutated(form, index, change):
    terms = list(form.terms)
    terms[index] = replace(terms[index], coefficient=change(terms[index].coefficient))
    return replace(form, terms=tuple(terms))


CHANGES = {
    "sign": lambda e: -e,
    "factor": lambda e: 2 * e,
    "left out": lambda e: sp.S.Zero,
    "other function": lambda e: e + m1 * sp.sin(sp.Symbol("q_j2", real=True)),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_term_is_noticed_whatever_term_it_is(change):
    comparison = compare(pendulum(2, damping=c))
    first, second, third = comparison.forms
    for index, term in enumerate(second.terms):
        wrong = replace(comparison, forms=(first, mutated(second, index, CHANGES[change]), third))
        (row,) = wrong.differences
        assert (row.equation, row.kind, row.factor) == (term.equation, term.kind, term.factor)
        with pytest.raises(DerivationError, match=f"{term.kind}(.|\n)*{term.equation}"):
            wrong.checked()


def test_a_missing_and_an_additional_term_are_noticed():
    comparison = compare(pendulum(2))
    first, second, _ = comparison.forms
    short = replace(second, terms=second.terms[1:])
    assert len(replace(comparison, forms=(first, short)).differences) == 1
    assert len(replace(comparison, forms=(short, first)).differences) == 1


# -- pages -------------------------------------------------------------------------------------


@lru_cache
def page(style):
    return compared().show(style)


@lru_cache
def compared():
    return compare(cart_pendulum())


@pytest.mark.parametrize("style", ["text", "latex", "markdown", "html"])
def test_pages_show_the_steps_and_stand_side_by_side(style):
    for words in ("Lagrange", "Kane", "Newton-Euler", "Side by side", "Centrifugal", "Gravity"):
        assert words in page(style)


def test_pages_are_the_same_each_time():
    assert tree_page(cart_pendulum(), "all", "text") == page("text")
    assert "Side by side" not in tree_page(cart_pendulum(), "kane", "text")


def test_every_term_stands_in_the_table_once_a_method():
    (body,) = parseString(page("html").replace("<!DOCTYPE html>\n", "")).getElementsByTagName(
        "body"
    )
    tables = [t for t in body.getElementsByTagName("table") if t.getAttribute("class") == "aligned"]
    rows = [r for t in tables for r in t.getElementsByTagName("tr")]
    cells = [c for r in rows for c in r.getElementsByTagName("td") if c.parentNode in rows]
    assert len(rows) - len(tables) == len(compared().rows)
    assert len(cells) == 3 * len(compared().rows)
    assert page("markdown").count("\n| $") == len(compared().rows)
    assert page("latex").count(r"\\ \hline") == len(compared().rows)


def test_latex_of_the_equations():
    given = pendulum(2)
    lines = closed_form(given, coordinates=absolute_angles(given)).latex()
    assert r"(m_{1} + m_{2}) l_{1}^{2}" in lines
    assert r"\ddot{\theta}_{j,1}" in lines.replace("_{j1}", "_{j,1}").replace(
        r"_{\mathrm{j1}}", "_{j,1}"
    )
    assert r"\cos(" in lines


# -- refusals ----------------------------------------------------------------------------------


def refused(call, words):
    with pytest.raises(InputError, match=words):
        call()


def test_refusals():
    given = pendulum(2)
    q1, q2 = (j.coordinates[0].symbol for j in given.ordered)
    x, y = sp.symbols("x y", real=True)
    refused(lambda: closed_form(given, "hamilton"), "unknown method")
    refused(lambda: tree_page(given, "hamilton"), "unknown method")
    refused(lambda: tree_page(given, "all", "word"), "unknown format")
    refused(lambda: closed_form(given, coordinates={x: y}), "cannot replace x")
    refused(lambda: closed_form(given, coordinates={q1: x + y}), "not as many")
    refused(lambda: closed_form(given, coordinates={q1: q2}), "not as many")
    refused(lambda: closed_form(given, coordinates={q1: x + t}), "depend on time")
    w = top("quaternion").joints[0].coordinates[0].symbol
    refused(lambda: closed_form(top("quaternion"), coordinates={w: x}), "cannot replace e_tip_0")


def test_large_trees_are_refused_and_pointed_to_derive():
    count = MOST + 1
    bodies = [Body(f"b{n}", 1, (0, 0, -1)) for n in range(count)]
    joints = [
        Joint(f"j{n}", "revolute", f"b{n - 1}" if n else "ground", f"b{n}") for n in range(count)
    ]
    refused(lambda: closed_form(Tree("chain", bodies, joints)), "too many speeds(.|\n)*derive")


def test_what_a_closed_form_does_not_know_is_refused():
    given = pendulum(2)
    rod = Distance("rod", "ground", given.bodies[0].name, 1)
    refused(lambda: closed_form(replace(given, constraints=(rod,))), "cannot be met(.|\n)*rod")
    wheel = Rotor("wheel", given.bodies[0].name, inertia=1)
    refused(lambda: closed_form(replace(given, rotors=(wheel,))), "cannot take rotors")


def test_work_is_bounded(monkeypatch):
    monkeypatch.setattr("eom.multibody.closed.polynomials.LIMIT", 100)
    refused(lambda: closed_form(pendulum(3)), "too large(.|\n)*derive")


def test_a_tree_without_motion_has_no_equations():
    given = Tree("still", [Body("box", 1)], [Joint("nail", "fixed", "ground", "box")], DOWN)
    form = closed_form(given)
    assert form.terms == ()
    assert form.speeds == ()


SPEEDY = {"sphere": "spherical", "free": "free", "plane": "planar"}


@pytest.mark.parametrize("kind", every(2, SPEEDY))
def test_rates_of_coordinates_as_speeds(kind):
    """The three methods agree, and their equations move as those over the joint's own speeds."""
    body = Body("b", m, (0, 0, l) if kind == "sphere" else (l, 0, 0), (I1, I2, I3))
    joint = Joint(
        "j",
        SPEEDY[kind],
        "ground",
        "b",
        attitude="1-2-3",
        damping=[c] * (6 if kind == "free" else 3),
    )
    last = joint.speeds[-1].symbol
    loads = (Load("b", torque=(0, 0, -k * last), axes="body"),)
    given = Tree("given", (body,), (joint,), DOWN, loads)
    form = compare(given, rates=True).forms[0]
    own = closed_form(given, "kane")
    assert [u.name for u in form.speeds] == [f"{q.name}_dot" for q in form.coordinates]
    K = sp.Matrix(own.kinematics).jacobian([u.symbol for u in own.speeds])
    rates = sp.Matrix([u.symbol for u in form.speeds])
    q = [x.symbol for x in form.coordinates]
    w = K.LUsolve(rates)
    moved = sp.Matrix([sp.diff(x, y) for x in K for y in q]).reshape(len(K), len(q)) * rates
    turned = sp.Matrix(len(q), len(q), list(moved)) * w
    put = dict(zip((u.symbol for u in own.speeds), w, strict=True))
    point = {s: sp.Rational(n + 3, 7) for n, s in enumerate(sorted({*q, *rates}, key=str))}
    point |= {s: sp.Rational(n + 2, 3) for n, s in enumerate((m, l, I1, I2, I3, c, k, g))}
    theirs = own.mass_matrix.LUsolve(own.forcing).xreplace(put)
    expected = sp.N((K * theirs + turned).xreplace(point), 30)
    found = sp.N(form.mass_matrix.xreplace(point), 40).LUsolve(
        sp.N(form.forcing.xreplace(point), 40)
    )
    assert max(abs(a - b) for a, b in zip(found, expected, strict=True)) < 1e-20
