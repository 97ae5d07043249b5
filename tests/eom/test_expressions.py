"""Parts of expressions: each once, however they nest."""

import sympy as sp

from eom.expressions import is_over, nodes, objects

X, Y, T = sp.symbols("x y t", real=True)


def shared(depth):
    """Return an expression of few objects that is written with 2^depth letters."""
    made = X
    for _ in range(depth):
        made = sp.Add(made, made, Y, evaluate=False)
    return made


def test_objects_are_all_parts():
    e = sp.sin(X * Y) ** 2 + sp.Piecewise((X, X > Y), (sp.Rational(3, 7), True)) / (X * Y)
    assert set(objects(e)) == set(nodes([e])) == set(sp.preorder_traversal(e))


def test_what_is_shared_is_gone_through_once():
    e = shared(200)
    assert len(objects(e)) == 1 + 3 * 200
    assert is_over(e, {X, Y})
    assert not is_over(e, {X})


def test_an_expression_over_known_symbols_has_no_function_of_time():
    f = sp.Function("f")(T)
    assert not is_over(X + f, {X, T})
    assert not is_over(X + f.diff(T), {X, T})
    assert not is_over("x", {X})
    assert is_over(sp.Integer(2), set())
