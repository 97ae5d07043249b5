"""Inferences: what follows from whole equations, and what does not."""

import pytest
import sympy as sp

from eom.errors import InputError
from eom.terms.rules import distribute
from eom.terms.rules.inferences import (
    along_axis,
    axes_of_components,
    cancelled,
    characteristic,
    entry,
    equal,
    instance,
    renamed,
    solved,
    squares,
    summed,
)
from eom.terms.terms import (
    Equation,
    add,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    matmul,
    mul,
    number,
    tilde,
)
from eom.terms.vocabulary import omega, position, quantity, unit

A, B, V = (quantity("vector", n) for n in "abv")
x, y, lam, nu = sp.symbols("x y lambda nu", real=True)


def test_solving_a_scalar_and_a_vector_line():
    assert solved(expr(x)).conclude(Equation(expr(2 * x + y), expr(y**2))) == Equation(
        expr(x), expr(y * (y - 1) / 2)
    )
    product = (y + 1) * (y**2 + y / y)
    assert solved(expr(x)).conclude(Equation(expr(2 * x), expr(product))) == Equation(
        expr(x), expr(product / 2)
    )
    line = Equation(A, add(mul(expr(y), B), cross(A, V)))
    assert solved(B).conclude(line).right == add(
        mul(expr(1 / y), A), -mul(expr(1 / y), cross(A, V))
    )
    for bad in (Equation(expr(x**2), expr(y)), Equation(expr(y), expr(y**2))):
        with pytest.raises(InputError, match="not linear"):
            solved(expr(x)).conclude(bad)
    with pytest.raises(InputError, match="not linear"):
        solved(V).conclude(Equation(A, B))


def test_any_vector_cancels_and_no_other_does():
    line = Equation(cross(A, V), cross(B, V))
    assert cancelled(V).conclude(line) == Equation(A, B)
    any_column = column(V, "B")
    pair = [tilde(column(u, "B")) for u in (A, B)]
    product = Equation(*(matmul(t, any_column) for t in pair))
    assert cancelled(any_column).conclude(product) == Equation(*pair)
    for bad in (
        Equation(cross(A, V), dot(quantity("dyadic", "D"), V)),
        Equation(cross(V, V), cross(B, V)),
        Equation(cross(A, omega()), cross(B, omega())),
    ):
        with pytest.raises(InputError, match="cancelling does not apply"):
            cancelled(bad.left.args[1]).conclude(bad)


def test_special_cases_are_of_what_stands_for_anything():
    general = Equation(der(V), add(der(V, "B"), cross(omega(), V)))
    r = position("dm", "C")
    found = instance({V: r}).conclude(general)
    assert found == Equation(der(r), add(der(r, "B"), cross(omega(), r)))
    with pytest.raises(InputError, match="stands for anything"):
        instance({omega(): r}).conclude(general)
    about = renamed({"O": "C"}).conclude(
        Equation(quantity("inertia", "O"), quantity("inertia", "O"))
    )
    assert about.left == quantity("inertia", "C")


def test_components_rows_and_axes():
    named = Equation(column(V, "B"), entries(sp.Matrix([x, y, 0])))
    along = axes_of_components("B").conclude(named)
    assert along == Equation(V, add(mul(expr(x), unit("B", 1)), mul(expr(y), unit("B", 2))))
    assert along_axis("B", 2).conclude(named) == Equation(dot(unit("B", 2), V), expr(y))
    both = Equation(entries(sp.Matrix([y, x, 1])), entries(sp.Matrix([x, x, 2])))
    assert entry(1).conclude(both) == Equation(expr(y), expr(x))
    for bad in (along_axis("A", 1), axes_of_components("A"), entry(1)):
        with pytest.raises(InputError, match="does not apply"):
            bad.conclude(named)


def test_lines_together():
    first, second = Equation(A, B), Equation(A, V)
    assert equal().conclude(first, second) == Equation(B, V)
    with pytest.raises(InputError, match="left sides differ"):
        equal().conclude(first, Equation(B, V))
    total = summed(number(1), number(-2), applied=(distribute,)).conclude(first, second)
    assert total == Equation(add(A, mul(number(-2), A)), add(B, mul(number(-2), V)))
    with pytest.raises(InputError, match="2 factors"):
        summed(number(1), number(2)).conclude(first)


def test_sums_of_squares_are_not_negative():
    line = Equation(dot(A, A), expr(x))
    assert squares.conclude(line) == Equation(dot(A, A), number(0), ">=")


def test_characteristic_polynomial_of_the_pendulum():
    """x' = y, y' = -sin x: at rest lambda^2 + 1, upside down lambda^2 - 1."""
    lines = [
        Equation(expr(sp.Symbol("u")), expr(y)),
        Equation(expr(sp.Symbol("w")), expr(-sp.sin(x))),
    ]
    for angle, sign in ((0, 1), (sp.pi, -1)):
        found = characteristic((x, y), {x: sp.Integer(0) + angle, y: sp.Integer(0)}, lam)
        right = found.conclude(*lines).right
        assert sp.expand(right.data[0] - lam**2 - sign) == 0
    with pytest.raises(InputError, match="not steady"):
        characteristic((x, y), {x: sp.Integer(0), y: nu}, lam).conclude(*lines)
