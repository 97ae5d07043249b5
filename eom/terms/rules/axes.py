"""The axes of a frame: orthonormal, right-handed, and components along them."""

from __future__ import annotations

import sympy as sp

from eom.terms.rules.basic import Rule, everywhere
from eom.terms.rules.tracing import named
from eom.terms.terms import (
    DYADIC,
    VECTOR,
    Term,
    add,
    dot,
    entries,
    inner,
    mul,
    number,
    outer_column,
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


_ONE = quantity("identity_matrix")


def _double_tilde(node: Term) -> Term:
    if node.head == "matmul" and all(a.head == "tilde" for a in node.args):
        a, b = (x.args[0] for x in node.args)
        return add(outer_column(b, a), -mul(inner(a, b), _ONE))
    return node


double_tilde: Rule = named("product of two tildes", everywhere(_double_tilde))
"""The product of two skew matrices: tilde(a) tilde(b) = b a^T - (a^T b) 1."""

unit_entries: Rule = named(
    "carried out", everywhere(lambda n: entries(sp.eye(3)) if n == _ONE else n)
)
"""The unit matrix by its entries."""


def reversed_turn(frame: str, base: str) -> Rule:
    """Return the rule that writes the reverse rotation as the transpose, for one pair of frames."""
    forth, back = quantity("rotation", frame, base), quantity("rotation", base, frame)
    return named(
        "the transpose is the reverse rotation",
        everywhere(lambda n: back if n == transpose(forth) else n),
    )


def rotation_products(node: Term) -> Term:
    """Return the unit matrix for a rotation times its reverse, one rotation for two in turn."""
    if node.head != "matmul":
        return node
    a, b = node.args
    if not all(x.head == "atom" and x.data[0] == "rotation" for x in (a, b)):
        return node
    if a.data[2] != b.data[1]:
        return node
    if a.data[1] == b.data[2]:
        return quantity("identity_matrix")
    return quantity("rotation", a.data[1], b.data[2])


rotations_in_turn: Rule = named("rotations in turn", everywhere(rotation_products))
"""C_AB C_BA = 1 and C_AB C_BC = C_AC."""
