"""Slopes by coordinates in worlds are those of calculus, and a false rule of slopes is found out there."""

import random

import pytest
import sympy as sp

import eom
from eom.derivations.derivation import Derivation
from eom.derivations.verification import DerivationError
from eom.fields import LARGE_RESIDUES, RATIONALS, RESIDUES, Singular
from eom.terms.rules.slopes import Slopes
from eom.terms.terms import Equation, add, der, dot, expr, mul, number, partial, total, zero
from eom.terms.vocabulary import mass, position, quantity, unit, velocity
from eom.worlds.evaluate import Evaluator, NoSlope
from eom.worlds.generators import worlds
from eom.worlds.own import Furnished
from eom.worlds.varied import Dual, Duals, parts
from tests.eom import chapters, oracle

R, V = position("i"), velocity("i")
M = mass("i")


@pytest.mark.parametrize("below", [RESIDUES, LARGE_RESIDUES, RATIONALS])
def test_numbers_with_a_slope_obey_the_laws_of_derivatives(below):
    field, draw = Duals(below.prime, below), random.Random(3)
    a, b, c, d = (below.draw(draw) for _ in range(4))
    x, y = Dual(a, b), Dual(c, d)
    reduce = below.reduce
    assert parts(field.reduce(x * y)) == (reduce(a * c), reduce(a * d + b * c))
    assert parts(field.reduce(x - y)) == (reduce(a - c), reduce(b - d))
    assert parts(field.reduce(2 - x)) == (reduce(2 - a), reduce(-b))
    assert parts(field.reduce(x * field.inverse(x))) == (1, 0)
    square = field.reduce(x * x)
    assert field.reduce(field.root(square) * field.root(square)) == square
    cosine, sine = field.circle(field.quarter(x, c))
    assert parts(field.reduce(cosine * cosine + sine * sine)) == (1, 0)
    # the circle is that of half an angle: its sine changes by half the cosine
    assert parts(sine)[1] == reduce(parts(cosine)[0] * b * below.of(1, 2))
    with pytest.raises(Singular):
        field.inverse(Dual(0, b))


def one_coordinate():
    d = Derivation("own", "One", "Particles")
    q, rate, second = d.coordinate("q", "any coordinate", 2)
    m, k = d.constants(m="mass", k="number")
    return d, (q, rate, second), (m, k)


def whole(q, rate, second, m, k):
    c, s = sp.cos(q), sp.sin(q)
    return m * rate**3 * c**2 / (k + q * s) + q * sp.tan(q) * rate + second**2 * rate * q - k * s


@pytest.mark.parametrize("order", [0, 1, 2])
def test_slopes_are_those_of_calculus(order):
    d, names, (m, k) = one_coordinate()
    e = whole(*names, m, k)
    known = expr(e.diff(names[order]))
    for world in worlds((), 2):
        values = Evaluator(world, d.scalars)
        assert values.holds(Equation(partial(e, names[order]), known))
        assert not values.holds(Equation(partial(e, names[order]), 2 * known))
        assert not values.holds(Equation(partial(e, names[order]), partial(e, names[order - 1])))


def test_vectors_and_frames_change_with_the_coordinate_of_their_angle():
    d, (q, rate, _), (m, _) = one_coordinate()
    d.frame("F", 2 * q)
    d.point("P1", m * unit("F", 1))
    (world,) = Furnished(d.own, d.scalars)((), 1)
    values, second = Evaluator(world, d.scalars), unit("F", 2)
    place, speed = position("P1"), velocity("P1")
    assert values.holds(Equation(partial(unit("F", 1), q), 2 * second))
    assert values.holds(Equation(partial(place, q), 2 * m * second))
    assert values.holds(Equation(partial(speed, rate), 2 * m * second))
    assert values.holds(Equation(partial(speed, q), -4 * m * rate * unit("F", 1)))
    assert not values.holds(Equation(partial(speed, q), 4 * m * rate * unit("F", 1)))


def test_a_momentum_is_a_variable_by_itself():
    d, (q, rate, _), (m, k) = one_coordinate()
    L = d.let("L", m * rate**2 / 2 - k * q**2, "Lagrangian")
    p = d.let("p", partial(L, rate), "momentum")
    d.state(Equation(expr(p), expr(m * rate)), "its value")
    H = d.let("H", p**2 / (2 * m) + k * q**2, "Hamilton's function")
    d.state(Equation(partial(H, q), expr(2 * k * q)), "by the coordinate")
    d.state(Equation(partial(H, p), expr(p / m)), "by the momentum")
    with pytest.raises(DerivationError):
        d.state(Equation(partial(H, p), expr(2 * p / m)), "twice that")


def test_no_slope_is_told_of_what_is_no_function_of_it():
    d, (q, rate, _), (m, _) = one_coordinate()
    (world,) = worlds((), 1)
    values = Evaluator(world, d.scalars)
    for term in (partial(q, m), partial(partial(q * rate, q), rate)):
        with pytest.raises(NoSlope):
            values.value(term)


def test_a_derivative_by_what_stands_for_something_is_refused():
    d, _, (m, _) = one_coordinate()
    K = d.let("K", m + 1, "a name")
    with pytest.raises(eom.InputError, match="no variable"):
        d.state(Equation(expr(sp.Derivative(K**2, K)), expr(2 * K)), "by a name")


# -- places of masses that are functions of coordinates ----------------------------------------------


@pytest.fixture
def configured():
    d = Derivation("places", "Places by coordinates", "Particles", ("constant_mass",))
    (q, q_dot), (p, _) = (d.coordinate(n, "any coordinate", 1) for n in "qp")
    d.configure(q, p)
    return d, q, q_dot, p


def lines(q, q_dot, p):
    """What is true, and what is not, of places that are functions of two coordinates and of time."""
    along, T = partial(R, q), quantity("kinetic_energy", "system")
    middle = partial(position("C"), q)
    work = total(dot(quantity("constraint_force", "i"), along))
    momentum = total(mul(M, dot(V, along)))
    held = total(dot(quantity("constraint_force", "i"), partial(position("i", "C"), q)))
    yield Equation(partial(V, q_dot), along), True
    yield Equation(partial(V, q_dot), partial(R, p)), False
    yield Equation(partial(V, q), der(along)), True
    yield Equation(partial(V, q), der(partial(R, p))), False
    yield Equation(partial(along, p), partial(partial(R, p), q)), None
    yield Equation(partial(T, q_dot), momentum), True
    yield Equation(partial(T, q_dot), 2 * momentum), False
    yield Equation(der(partial(T, q_dot)), total(mul(M, dot(der(V), along)))), False
    yield Equation(total(mul(M, along)), mul(quantity("total_mass", "system"), middle)), True
    yield Equation(middle, zero("vector")), False
    yield Equation(partial(position("i", "O"), q), along), True
    yield Equation(partial(position("i", "C"), q), along), False
    yield Equation(partial(position("i", "C"), q), along - middle), True
    yield Equation(work, number(0)), True
    yield Equation(held, number(0)), False
    yield Equation(partial(position("O"), q), zero("vector")), True


def test_places_are_functions_of_coordinates(configured):
    d, *names = configured
    (world,) = Furnished(d.own, d.scalars)(("constant_mass",), 1)
    for line, truth in lines(*names):
        if truth is None:
            with pytest.raises(NoSlope):
                Evaluator(world, d.scalars).holds(line)
        else:
            assert Evaluator(world, d.scalars).holds(line) == truth, line


def test_worlds_and_numerics_say_the_same_of_places(configured):
    d, *names = configured
    for line, truth in lines(*names):
        if truth is None:
            with pytest.raises(oracle.Undefined):
                chapters.is_true(d, line, d.assumed)
        else:
            assert chapters.is_true(d, line, d.assumed) == truth, line
            assert chapters.judge(d, line, d.assumed) == ("accepted" if truth else "rejected")


def test_the_centre_moves_with_its_masses_where_it_is_the_reference_point(configured):
    d, q, *_ = configured
    d.assume("about_centre")
    d.state(Equation(partial(position("O"), q), partial(position("C"), q)), "they are one point")
    with pytest.raises(DerivationError):
        d.state(Equation(partial(position("O"), q), zero("vector")), "nor does it rest")


@pytest.mark.parametrize(
    ("method", "wrong"),
    [
        ("_rate", lambda _, term, __: zero(term.kind)),
        ("_rate", lambda kit, term, by: der(kit.of(term.args[0], by))),
        ("_atom", lambda _, term, __: zero(term.kind)),
    ],
)
def test_a_false_rule_of_slopes_is_found_out(configured, monkeypatch, method, wrong):
    d, q, q_dot, _ = configured
    monkeypatch.setattr(Slopes, method, wrong)
    slope = partial(V, q_dot) if method == "_rate" else partial(R, q)
    value = Slopes(d.scalars, d.own).of(slope.args[0], slope.args[1].data[0])
    with pytest.raises(DerivationError):
        d.state(Equation(add(slope, V), add(value, V)), "as the rule says")
