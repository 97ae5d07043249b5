"""The calculus of sums, integrals and derivatives: linearity, the product rule, like terms."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.terms.rules.basic import everywhere, until_stable
from eom.terms.rules.tracing import Rule, named, rest_on
from eom.terms.terms import (
    INERTIAL,
    SCALAR,
    Equation,
    Term,
    add,
    der,
    expr,
    make,
    mul,
    nodes,
    number,
    rebuild,
    relabel,
    zero,
)

BILINEAR = frozenset({"dot", "cross", "outer", "matmul", "inner", "outer_column"})
"""Products that are linear in both factors."""
_LINEAR = frozenset({"der", "sum", "integral", "column", "tilde", "transpose"})


def _spread(node: Term) -> Term:
    """Write a product or a linear operation over the terms of its first argument that is a sum."""
    for place, a in enumerate(node.args):
        if a.head == "add":
            others = list(node.args)
            return add(*(rebuild(node, [*others[:place], t, *others[place + 1 :]]) for t in a.args))
    return node


def _factors_out(node: Term) -> Term:
    """Write scalar factors of the arguments of a product in front of it."""
    scalars, rest = [], []
    for a in node.args:
        inside = a.args if a.head == "mul" else (a,)
        scalars += [f for f in inside if f.kind == SCALAR]
        rest.append(mul(*(f for f in inside if f.kind != SCALAR)))
    return mul(*scalars, rebuild(node, rest)) if scalars else node


def _number_out(node: Term) -> Term:
    """Write a numerical factor of the argument of a linear operation in front of it."""
    coefficient, rest = coefficient_of(node.args[0])
    return node if coefficient == 1 else mul(expr(coefficient), rebuild(node, [rest]))


def _distribute(node: Term) -> Term:
    if node.head not in {*BILINEAR, *_LINEAR, "mul"}:
        return node
    spread = _spread(node)
    if spread is not node or node.head == "mul":
        return spread
    return _factors_out(node) if node.head in BILINEAR else _number_out(node)


distribute = named("linearity", until_stable(_distribute))
"""Products, sums, integrals and derivatives are linear: a x (b + c) = a x b + a x c."""


def _product_rule(node: Term) -> Term:
    if node.head != "der":
        return node
    (inside,) = node.args
    if inside.head in BILINEAR or inside.head == "mul":
        args = inside.args
        varied = ([*args[:k], _rate(a, node.data[0]), *args[k + 1 :]] for k, a in enumerate(args))
        return add(*(rebuild(inside, v) for v in varied))
    if inside.head == "expr" and inside.data[0].is_number:
        return zero(node.kind)
    return node


def _differentiate_terms(node: Term) -> Term:
    return _spread(node) if node.head == "der" and node.args[0].head == "add" else node


differentiate_terms = named("product rule", until_stable(_differentiate_terms))
"""The derivative of a sum of terms is the sum of their derivatives: (a + b)' = a' + b'."""


def _rate(term: Term, frame: str) -> Term:
    if term.head == "expr" and term.data[0].is_number:
        return zero(term.kind)
    return der(term, frame or INERTIAL)


def _differentiate(node: Term) -> Term:
    if node.head == "der" and node.args[0].head == "add":
        return _spread(node)
    return _product_rule(node)


differentiate = named("product rule", until_stable(_differentiate))
"""The product rule, term by term: (a x b)' = a' x b + a x b'."""


def differentiate_in(frame: str) -> Rule:
    """Return the product rule for the rate of a scalar, each factor differentiated in ``frame``."""

    def rule(node: Term) -> Term:
        if node.head == "der" and node.kind == SCALAR and node.args[0].head in {*BILINEAR, "mul"}:
            return _product_rule(make("der", node.args, (frame,)))
        return _product_rule(node)

    return named("product rule", until_stable(rule))


def _under_the_sum(node: Term) -> Term:
    if node.head == "der" and node.args[0].head in {"sum", "integral"}:
        inside = node.args[0]
        return make(inside.head, (der(inside.args[0], node.data[0]),), inside.data)
    return node


differentiate_under = named("derivative under the sum", until_stable(_under_the_sum))
"""The derivative of a sum (integral) is the sum (integral) of the derivatives."""


def _depends(term: Term, index: str) -> bool:
    """Return whether a term may depend on an index; a symbol may stand for what does."""
    named = any(n.head == "expr" and n.data[0].free_symbols for n in nodes(term))
    return named or index in term.labels


def _take_out(node: Term) -> Term:
    """Move what does not depend on the index out of a sum or integral."""
    if node.head not in {"sum", "integral"}:
        return node
    index = node.data[0]
    (body,) = node.args
    factors = list(body.args) if body.head == "mul" else [body]
    free = [f for f in factors if f.kind == SCALAR and not _depends(f, index)]
    bound = [f for f in factors if f not in free]
    if bound and bound[-1].kind != SCALAR and not _depends(bound[-1], index):
        free.append(bound.pop())
    if free:
        return mul(*free, rebuild(node, [mul(*bound) if bound else number(1)]))
    return _take_side_out(node, index, bound)


def _take_side_out(node: Term, index: str, factors: list[Term]) -> Term:
    """Move a constant side of a product out; scalar factors stay with the other side."""
    *scalars, last = factors
    if last.head not in BILINEAR:
        return node
    a, b = last.args
    if not _depends(b, index):
        return rebuild(last, [rebuild(node, [mul(*scalars, a)]), b])
    if not _depends(a, index):
        return rebuild(last, [a, rebuild(node, [mul(*scalars, b)])])
    return node


take_out = named("constants out of sums", until_stable(_take_out))
"""What does not depend on the index comes out of a sum: sum m_i a x b_i = a x sum m_i b_i."""


def _gather(node: Term) -> Term:
    if node.head != "add":
        return node
    counted: dict[Term, Any] = {}
    for t in node.args:
        coefficient, rest = coefficient_of(t)
        counted[rest] = counted.get(rest, 0) + coefficient
    return add(*(mul(expr(c), rest) for rest, c in counted.items()))


combine = named("like terms", everywhere(_gather))
"""Add like terms."""


def less(term: Term) -> Rule:
    """Return the rule that takes ``term`` away; both sides of an equation stay equal."""
    return named("the same taken away", lambda t: _gather(add(t, -term)))


def fold_sum(statement: Equation) -> Rule:
    """Return the rule that names, in a sum, the terms that are the right side of ``statement``."""
    wanted = statement.right.args if statement.right.head == "add" else (statement.right,)

    def rule(node: Term) -> Term:
        if node.head != "add" or not all(t in node.args for t in wanted):
            return node
        rest_on(statement)
        return add(statement.left, *(t for t in node.args if t not in wanted))

    return named("substitution", everywhere(rule))


def coefficient_of(term: Term) -> tuple[Any, Term]:
    """Return the rational factor of a term, and the rest."""
    if term.head == "mul" and term.args[0].head == "expr" and term.args[0].data[0].is_Rational:
        return term.args[0].data[0], mul(*term.args[1:])
    return sp.Integer(1), term


def symmetrise(first: str, second: str) -> Rule:
    """Return the rule sum_ij X_ij = 1/2 sum_ij (X_ij + X_ji)."""

    def rule(node: Term) -> Term:
        if node.head == "sum" and node.args[0].head == "sum":
            inner_sum = node.args[0]
            if (node.data[0], inner_sum.data[0]) == (first, second):
                x = inner_sum.args[0]
                both = add(x, relabel(x, {first: second, second: first}))
                return mul(number(1, 2), rebuild(node, [rebuild(inner_sum, [both])]))
        return node

    return named("both orders of a double sum", everywhere(rule))


def _product_with_sum(node: Term) -> Term:
    """Return a x sum b_j as sum a x b_j, where the second factor is a sum."""
    if node.head in BILINEAR and node.args[1].head in {"sum", "integral"}:
        a, s = node.args
        if s.data[0] in a.labels:
            return node
        return rebuild(s, [rebuild(node, [a, s.args[0]])])
    return node


into_sums = named("factors into sums", until_stable(_product_with_sum))
"""a x sum b_j = sum a x b_j."""
