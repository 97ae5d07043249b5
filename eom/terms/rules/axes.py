"""The axes of a frame: orthonormal, right-handed, and components along them."""

from __future__ import annotations

import sympy as sp

from eom.terms.own import Own, OwnFrame
from eom.terms.rules.basic import everywhere, until_stable
from eom.terms.rules.tracing import Rule, named
from eom.terms.terms import (
    DYADIC,
    MATRIX,
    VECTOR,
    Term,
    add,
    dot,
    entries,
    expr,
    inner,
    matmul,
    mul,
    number,
    outer_column,
    rebuild,
    transpose,
    zero,
)
from eom.terms.vocabulary import quantity, unit


def _axis(term: Term, frame: str) -> int | None:
    """Return which axis of ``frame`` a term is."""
    if term.head == "atom" and term.data[0] == "unit" and term.data[1] == frame:
        return int(term.data[2])
    return None


def orthonormal(frame: str) -> Rule:
    """Return the rule b_i.b_j = 1 or 0, b_1 x b_2 = b_3 and so on, for the axes of ``frame``."""

    def rule(node: Term) -> Term:
        if node.head not in {"dot", "cross"} or len(node.args) != 2:
            return node
        i, j = (_axis(a, frame) for a in node.args)
        if i is None or j is None:
            return node
        if node.head == "dot":
            return number(int(i == j))
        if i == j:
            return zero(VECTOR)
        third = unit(frame, 6 - i - j)
        return third if (j - i) % 3 == 1 else -third

    return named("orthonormal axes", everywhere(rule))


def resolved(vector: Term, frame: str) -> Rule:
    """Return the rule v = (b_1.v) b_1 + (b_2.v) b_2 + (b_3.v) b_3 for ``vector``."""
    axes = [unit(frame, k) for k in (1, 2, 3)]
    along = add(*(mul(dot(b, vector), b) for b in axes))
    return named("components along the axes", lambda t: along if t == vector else t)


def by_axes(frame: str) -> Rule:
    """Return the rule that writes the column of a vector, the matrix of a dyadic, by b_i.v, b_i.J.b_j."""
    axes = [unit(frame, k) for k in (1, 2, 3)]

    def rule(node: Term) -> Term:
        if node.head != "column" or node.data != (frame,):
            return node
        (inside,) = node.args
        if inside.kind == DYADIC:
            return entries([[dot(a, dot(inside, b)) for b in axes] for a in axes])
        return entries([[dot(b, inside)] for b in axes])

    return named("components along the axes", everywhere(rule))


def along_turned(own: Own, frame: str) -> Rule:
    """Return the rule that writes axes by those of ``frame``, turned from theirs once or more.

    ``own``: says by which turns; b_1 is turned to b_1 cos + b_2 sin, and so on.
    """
    rows = {}
    while frame in own.frames:
        row = own.frames[frame]
        rows[row.base] = (frame, row)
        frame = row.base

    def rule(node: Term) -> Term:
        if node.head != "atom" or node.data[0] != "unit" or node.data[1] not in rows:
            return node
        to, row = rows[node.data[1]]
        return _before_turn(to, row, int(node.data[2]))

    return named("axes of a turned frame", until_stable(rule))


def _before_turn(frame: str, row: OwnFrame, k: int) -> Term:
    """Return axis ``k`` of the frame from which a frame is turned, by the axes of the latter."""
    if k == row.axis:
        return unit(frame, k)
    first = row.axis % 3 + 1
    second = first % 3 + 1
    cosine, sine = expr(sp.cos(row.angle)), expr(sp.sin(row.angle))
    if k == first:
        return add(mul(cosine, unit(frame, first)), -mul(sine, unit(frame, second)))
    return add(mul(sine, unit(frame, first)), mul(cosine, unit(frame, second)))


_ONE = quantity("identity_matrix")


def _double_tilde(node: Term) -> Term:
    if node.head == "matmul" and all(a.head == "tilde" for a in node.args):
        a, b = (x.args[0] for x in node.args)
        return add(outer_column(b, a), -mul(inner(a, b), _ONE))
    return node


double_tilde: Rule = named("product of two skew matrices", everywhere(_double_tilde))
"""The product of two skew matrices: tilde(a) tilde(b) = b a^T - (a^T b) 1."""

unit_entries: Rule = named(
    "carried out", everywhere(lambda n: entries(sp.eye(3)) if n == _ONE else n)
)
"""The unit matrix by its entries."""


def _rotation_products(node: Term) -> Term:
    if node.head != "matmul":
        return node
    a, b = node.args
    if a == _ONE:
        return b
    if b.head == "matmul":
        first = _rotation_products(matmul(a, b.args[0]))
        return node if first.head == "matmul" else _rotation_products(matmul(first, b.args[1]))
    if not all(x.head == "atom" and x.data[0] == "rotation" for x in (a, b)):
        return node
    if a.data[2] != b.data[1]:
        return node
    if a.data[1] == b.data[2]:
        return _ONE
    return quantity("rotation", a.data[1], b.data[2])


rotations_in_turn: Rule = named("rotations in turn", everywhere(_rotation_products))
"""C_AB C_BA = 1 and C_AB C_BC = C_AC; a product with 1 is the other factor."""


def _reversed(node: Term) -> Term:
    if node.head in {"inverse", "transpose"} and node.args[0].head == "atom":
        name, *frames = node.args[0].data
        return quantity("rotation", *frames[::-1]) if name == "rotation" else node
    return node


reversed_rotation: Rule = named("reverse rotation", everywhere(_reversed))
"""Inverse and transpose of a rotation are the reverse rotation."""


def _to_the_right(node: Term) -> Term:
    if node.head == "matmul" and node.args[0].head == "matmul":
        (a, b), c = node.args[0].args, node.args[1]
        return matmul(a, matmul(b, c))
    return node


to_the_right: Rule = named("associativity", until_stable(_to_the_right))
"""(A B) c = A (B c): the first factor can come out of an integral."""

_THROUGH = frozenset({"tilde", "transpose"})


def _through(node: Term) -> Term:
    if node.head in _THROUGH and node.args[0].head in {"sum", "integral"}:
        inside = node.args[0]
        return rebuild(inside, [rebuild(node, inside.args)])
    return node


through_sums: Rule = named("linearity", until_stable(_through))
"""The tilde, or the transpose, of a sum or integral is the sum of tildes, or transposes."""


def _transposed(node: Term) -> Term:
    if node.head != "transpose":
        return node
    (x,) = node.args
    if x.head == "add":
        return add(*map(transpose, x.args))
    if x.head == "mul":
        return mul(*x.args[:-1], transpose(x.args[-1]))
    if x.head == "outer_column":
        return outer_column(*x.args[::-1])
    if x.head == "matmul" and x.args[1].kind == MATRIX:
        return matmul(transpose(x.args[1]), transpose(x.args[0]))
    if x.head == "transpose":
        return x.args[0]
    return {_ONE: _ONE}.get(x, -x if x.head == "tilde" else node)


transposed: Rule = named("transpose of a product", until_stable(_transposed))
"""(A B)^T = B^T A^T, (a b^T)^T = b a^T, tilde(a)^T = -tilde(a)."""
