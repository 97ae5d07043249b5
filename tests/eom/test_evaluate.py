"""Values of terms in a world, against the same worked out by hand from its masses and places."""

import pytest
import sympy as sp

from eom.errors import InputError
from eom.exact import series
from eom.exact.series import Series
from eom.terms.terms import (
    HEADS,
    Equation,
    Term,
    add,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    integral,
    inverse,
    make,
    mul,
    number,
    outer,
    total,
    transpose,
    zero,
)
from eom.terms.vocabulary import mass, position, quantity
from eom.worlds.evaluate import Evaluator
from eom.worlds.generators import world
from eom.worlds.worlds import closure

A, B, D = quantity("vector", "a"), quantity("vector", "b"), quantity("dyadic", "d")
C = quantity("rotation", "B", "I")
x, psi, theta = sp.symbols("x psi theta")
ANGLES = {psi: quantity("angle", "psi"), theta: quantity("angle", "theta"), x: dot(A, B)}


@pytest.fixture(scope="module")
def here():
    return Evaluator(world(frozenset(), 0), {x: dot(A, B)})


@pytest.fixture(scope="module")
def turning():
    return Evaluator(world(closure(["spin_312"]), 0), ANGLES)


def same(a, b):
    if isinstance(a, Series):
        return (a - b).is_zero
    return len(a) == len(b) and all(same(p, q) for p, q in zip(a, b, strict=True))


def test_sums_run_over_all_masses(here):
    w = here.world
    first = here.value(total(mul(mass("i"), position("i"))))
    by_hand = series.scale(w.masses[0], w.places[0])
    for m, p in list(zip(w.masses, w.places, strict=True))[1:]:
        by_hand = series.add(by_hand, series.scale(m, p))
    assert same(first, by_hand)
    assert same(here.value(integral(position("dm"))), by_hand)
    assert same(here.value(total(number(1))), w.constant(len(w.masses)))
    pairs = here.value(total(total(number(1), "j")))
    assert same(pairs, w.constant(len(w.masses) ** 2))


def test_products_of_dyadics(here):
    a, b, d = (here.value(t) for t in (A, B, D))
    assert same(here.value(dot(outer(A, B), A)), series.scale(series.dot(b, a), a))
    assert same(here.value(dot(A, outer(A, B))), series.scale(series.dot(a, a), b))
    assert same(here.value(dot(D, A)), series.apply(d, a))
    assert same(here.value(dot(A, D)), series.apply(series.transpose(d), a))
    assert same(here.value(dot(D, outer(A, B))), series.product(d, here.value(outer(A, B))))


def test_components_and_derivatives_in_a_frame(here):
    w = here.world
    inside = series.apply(w.rotation("B", "I"), here.value(A))
    assert same(here.value(column(A, "B")), inside)
    rate = tuple(s.derivative() for s in inside)
    assert same(here.value(der(A, "B")), series.apply(w.rotation("I", "B"), rate))
    assert same(here.value(der(A)), tuple(s.derivative() for s in here.value(A)))
    assert not same(here.value(der(A, "B")), here.value(der(A)))
    turned = here.value(column(outer(A, B), "B"))
    assert same(turned, here.value(make("outer_column", (column(A, "B"), column(B, "B")))))


def test_matrices(here):
    eye = here.value(quantity("identity_matrix"))
    assert same(here.value(C @ transpose(C)), eye)
    assert same(here.value(inverse(C)), here.value(transpose(C)))
    rows = make("rows", [column(A, "B"), column(B, "B"), column(A, "I")])
    assert same(here.value(rows)[1], here.value(column(B, "B")))
    nine = entries(sp.Matrix(3, 3, range(9)))
    assert here.value(nine)[1][2].coefficients[0] == 5
    for kind in ("scalar", "vector", "dyadic", "column", "matrix"):
        assert same(here.value(add(zero(kind), zero(kind))), here.value(zero(kind)))


def test_expressions(here):
    value = here.value(x_squared := expr(x**2 / 3 - 2 / x + 1))
    ab = here.value(dot(A, B))
    one = here.world.constant(1)
    third = here.world.field.of(1, 3)
    two = here.world.constant(2)
    assert same(value, (ab * ab).scaled(third) - two * ab.reciprocal() + one)
    assert here.value(x_squared) is value


@pytest.mark.parametrize(
    "identity",
    [
        (sp.sin(psi) ** 2 + sp.cos(psi) ** 2, 1),
        (sp.sin(psi + theta), sp.sin(psi) * sp.cos(theta) + sp.cos(psi) * sp.sin(theta)),
        (
            sp.cos(2 * psi - theta),
            sp.cos(2 * psi) * sp.cos(theta) + sp.sin(2 * psi) * sp.sin(theta),
        ),
        (sp.tan(theta) * sp.cos(theta), sp.sin(theta)),
        (sp.sin(-3 * psi), 4 * sp.sin(psi) ** 3 - 3 * sp.sin(psi)),
    ],
)
def test_angles(turning, identity):
    left, right = (expr(sp.sympify(e)) for e in identity)
    assert turning.holds(Equation(left, right))
    assert not turning.holds(Equation(left, mul(number(2), right)))
    assert turning.holds(Equation(der(left), der(right)))


def test_the_rate_of_a_sine(turning):
    rate = mul(expr(sp.cos(psi)), der(expr(psi)))
    assert turning.holds(Equation(der(expr(sp.sin(psi))), rate))


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (sp.cbrt(x), "this power"),
        (sp.Symbol("q"), "meaning"),
        (sp.sin(x), "angles"),
        (sp.sin(psi / 3), "angles"),
        (sp.exp(x), "no value"),
    ],
)
def test_expressions_without_an_exact_value_are_refused(turning, wrong, says):
    with pytest.raises(InputError, match=says):
        turning.value(expr(wrong))


def test_an_equation_holds_for_every_index_or_not_at_all(here):
    n = len(here.world.masses)
    fails = [not here._agree(Equation(position("i"), position("P")), {"i": k}) for k in range(n)]
    assert fails == [False] + [True] * (n - 1)
    assert not here.holds(Equation(position("i"), position("P")))
    assert here.holds(Equation(cross(position("i", "j"), A), -cross(position("j", "i"), A)))
    assert not here.holds(Equation(position("i", "j"), position("j", "i")))


def test_every_coefficient_counts(here):
    """A vector that agrees with another at t = 0 alone is not the same."""
    turning = quantity("fixed_vector", "u", "B")
    start = entries([[expr(sp.Symbol(n))] for n in "pqr"])
    first = here.value(column(turning, "I"))
    known = {
        sp.Symbol(n): number(int(s.coefficients[0])) for n, s in zip("pqr", first, strict=True)
    }
    assert not Evaluator(here.world, known).holds(Equation(column(turning, "I"), start))


def test_every_head_has_a_rule(here):
    from eom.worlds import evaluate

    assert set(evaluate._RULES) == {*HEADS, "expr", "zero", "atom"}
    assert isinstance(here.value(Term("expr", (), (sp.Integer(3),))), Series)


def test_a_world_keeps_values_for_all_evaluators_but_those_of_symbols():
    w = world(frozenset(), 1)
    term = cross(A, total(mul(mass("i"), position("i"))))
    first = Evaluator(w, {x: dot(A, A)}).value(term)
    assert Evaluator(w, {x: dot(B, B)}).value(term, {"j": 1}) is first
    values = [Evaluator(w, {x: of}).value(mul(expr(x), A)) for of in (dot(A, A), dot(B, B))]
    assert not same(*values)


def test_a_value_does_not_depend_on_the_order_in_which_indices_are_numbered():
    w = world(frozenset(), 2)
    body = cross(position("i"), position("j"))
    one, other = ({"i": 0, "j": 1}, {"j": 1, "i": 0})
    assert Evaluator(w, {}).value(body, one) is Evaluator(w, {}).value(body, other)
    assert not same(
        Evaluator(w, {}).value(body, {"i": 1, "j": 0}), Evaluator(w, {}).value(body, one)
    )
