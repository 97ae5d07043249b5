"""Identities of vectors: cross products, dyadics, the transport theorem."""

from __future__ import annotations

from collections.abc import Callable

from eom.terms.rules.basic import apply, everywhere, until_stable
from eom.terms.rules.calculus import BILINEAR, combine, differentiate, distribute, take_out
from eom.terms.rules.tracing import Rule, named
from eom.terms.terms import (
    DYADIC,
    INDICES,
    INERTIAL,
    SCALAR,
    VECTOR,
    Term,
    add,
    cross,
    der,
    dot,
    make,
    matmul,
    mul,
    number,
    outer,
    outer_column,
    rebuild,
    replace,
    zero,
)
from eom.terms.vocabulary import omega, quantity


def _parallel(node: Term) -> Term:
    """A x a = 0, also with scalar factors."""
    if node.head != "cross":
        return node
    bare = [a.args[-1] if a.head == "mul" else a for a in node.args]
    return zero(VECTOR) if bare[0] == bare[1] else node


parallel: Rule = named("a x a = 0", everywhere(_parallel))


def _bac_cab(node: Term) -> Term:
    if node.head == "cross" and node.args[1].head == "cross":
        a, (b, c) = node.args[0], node.args[1].args
        return add(mul(dot(a, c), b), -mul(dot(a, b), c))
    return node


bac_cab: Rule = named("double cross product", everywhere(_bac_cab))
"""a x (b x c) = b (a.c) - c (a.b)."""


def _scalar_triple(node: Term) -> Term:
    if node.head == "dot" and node.kind == SCALAR and node.args[0].head == "cross":
        (a, b), c = node.args[0].args, node.args[1]
        return dot(a, cross(b, c))
    return node


scalar_triple: Rule = named("scalar triple product", everywhere(_scalar_triple))
"""(a x b).c = a.(b x c)."""


def _triple_in_order(node: Term) -> Term:
    """Write a scalar triple product with its factors in one order: a.(b x c), with its sign."""
    if node.head != "dot" or node.kind != SCALAR:
        return node
    for a, product in (node.args, node.args[::-1]):
        if product.head == "cross":
            factors = [a, *product.args]
            wanted = sorted(factors, key=repr)
            if len(set(wanted)) < 3:
                return zero(SCALAR)
            order = [wanted.index(f) for f in factors]
            odd = sum(x > y for k, x in enumerate(order) for y in order[k + 1 :]) % 2
            made = dot(wanted[0], cross(wanted[1], wanted[2]))
            return -made if odd else made
    return node


triple_in_order: Rule = named("scalar triple product", everywhere(_triple_in_order))
"""a.(b x c) = b.(c x a) = -(a.(c x b)), and zero where two factors are the same."""


def swap(first: Term, second: Term) -> Rule:
    """Return the rule first x second = -(second x first)."""
    return named(
        "a x b = -(b x a)",
        everywhere(lambda n: -cross(second, first) if n == cross(first, second) else n),
    )


def flip_crosses(inside: Callable[[Term], bool]) -> Rule:
    """Return the rule a x b = -(b x a) for the products that satisfy ``inside``."""

    def rule(node: Term) -> Term:
        return -cross(node.args[1], node.args[0]) if node.head == "cross" and inside(node) else node

    return named("a x b = -(b x a)", everywhere(rule))


_DYADIC = ("dot", quantity("identity"), outer, dot)
_MATRIX = ("inner", quantity("identity_matrix"), outer_column, matmul)


def dyadic_form(vector: Term) -> Rule:
    """Return the rule a (b.v) = (a b).v and s v = s 1.v, which lets ``vector`` stand at the end.

    Of a column it makes matrices likewise.
    """
    scalar, identity, outer_of, product = _DYADIC if vector.kind == VECTOR else _MATRIX

    def rule(node: Term) -> Term:
        if node.head != "mul":
            return node
        *scalars, last = node.args
        if node.kind != vector.kind:
            return node
        if last == vector:
            return product(mul(*scalars, identity), vector)
        for k, s in enumerate(scalars):
            if s.head == scalar and vector in s.args:
                (other,) = (
                    (a for a in s.args if a != vector) if s.args[0] != s.args[1] else (vector,)
                )
                rest = [*scalars[:k], *scalars[k + 1 :]]
                return product(mul(*rest, outer_of(last, other)), vector)
        return node

    return named("dyadic form", everywhere(rule))


def _factor(vector: Term, head: str, place: int) -> Rule:
    def rule(node: Term) -> Term:
        if node.head != "add":
            return node
        split = [(_other_side(t, vector, head, place), t) for t in node.args]
        sides = [s for s, _ in split if s is not None]
        if len(sides) < 2:
            return node
        pair = [add(*sides), vector] if place == 1 else [vector, add(*sides)]
        return add(*(t for s, t in split if s is None), make(head, pair))

    return named("common factor", everywhere(rule))


def factor_right(vector: Term, head: str = "dot") -> Rule:
    """Return the rule A.v + B.v = (A + B).v for ``vector``."""
    return _factor(vector, head, 1)


def factor_left(vector: Term, head: str = "cross") -> Rule:
    """Return the rule v x a + v x b = v x (a + b) for ``vector``."""
    return _factor(vector, head, 0)


def _other_side(term: Term, vector: Term, head: str, place: int) -> Term | None:
    """Return s a of s (a.v), or of s (v.a) for place 0."""
    scalars, last = (term.args[:-1], term.args[-1]) if term.head == "mul" else ((), term)
    if last.head == head and last.args[place] == vector:
        return mul(*scalars, last.args[1 - place])
    return None


def transport(to_frame: str = "B", from_frame: str = "I") -> Rule:
    """Return the transport theorem: A-derivative of v = B-derivative of v + omega x v."""
    w = omega(to_frame, from_frame)

    def rule(node: Term) -> Term:
        if node.head == "der" and node.data == (from_frame,) and node.kind == VECTOR:
            (v,) = node.args
            return add(der(v, to_frame), cross(w, v))
        return node

    return named(
        "transport theorem",
        lambda term: rule(term) if term.head == "der" else replace(term, rule),
    )


def _depth(term: Term) -> int:
    return 1 + _depth(term.args[0]) if term.head == "der" else 0


def _commute(node: Term) -> Term:
    if node.head == "dot" and node.kind == SCALAR and _depth(node.args[0]) < _depth(node.args[1]):
        return dot(node.args[1], node.args[0])
    return node


commute: Rule = named("a.b = b.a", everywhere(_commute))
"""a.b = b.a, with the higher derivative first."""


def _ordered(node: Term) -> Term:
    if node.head not in {"dot", "cross"} or len({a.kind for a in node.args}) > 1:
        return node
    a, b = sorted(node.args, key=repr)
    if node.kind == DYADIC or (a, b) == node.args:
        return node
    return dot(a, b) if node.head == "dot" else -cross(a, b)


def _from_points(node: Term) -> Term:
    """The position of a fixed point from an element is minus that of the element from it."""
    if node.head == "atom" and node.data[0] == "position":
        _, of, origin = node.data
        if origin in INDICES and of not in INDICES:
            return -quantity("position", origin, of)
    return node


def _from_itself(node: Term) -> Term:
    if node.head == "atom" and node.data[0] == "position" and node.data[1] == node.data[2]:
        return zero(VECTOR)
    return node


def _no_turn(node: Term) -> Term:
    if node.head == "atom" and node.data[0] == "angular_velocity" and node.data[1] == node.data[2]:
        return zero(VECTOR)
    return node


no_turn_in_itself: Rule = named("no turning in itself", everywhere(_no_turn))
"""The angular velocity of a frame with respect to itself is zero."""

from_itself: Rule = named("no distance from itself", everywhere(_from_itself))
"""The position of a point from itself is zero."""


def _in_order(term: Term) -> Term:
    ordering = everywhere(_ordered)
    return distribute(ordering(distribute(everywhere(_from_points)(term))))


ordered: Rule = named("order of factors", _in_order)
"""Write products in one order: a.b = b.a, a x b = -(b x a), factors in front."""


def order_dots(first: Term) -> Rule:
    """Return the rule a.b = b.a that writes ``first`` first."""

    def rule(node: Term) -> Term:
        if node.head == "dot" and node.kind == SCALAR and node.args[1] == first:
            return dot(first, node.args[0])
        return node

    return named("a.b = b.a", everywhere(rule))


def linear_in(vector: Term) -> Rule:
    """Return the rule that lets ``vector`` stand once, at the end, behind a dyadic."""
    head = "dot" if vector.kind == VECTOR else "matmul"
    steps = (dyadic_form(vector), factor_right(vector, head), take_out, combine)
    return lambda term: apply(steps, term)


def symmetric(dyadic: Term) -> Rule:
    """Return the rule a.(J.b) = b.(J.a) for a symmetric ``dyadic``, the derivative standing last."""

    def rule(node: Term) -> Term:
        if node.head == "dot" and node.args[1].head == "dot" and node.args[1].args[0] == dyadic:
            a, b = node.args[0], node.args[1].args[1]
            if _depth(a) > _depth(b):
                return dot(b, dot(dyadic, a))
        return node

    return named("symmetry", everywhere(rule))


def triple_zero(vector: Term) -> Rule:
    """Return the rule v.(v x a) = 0."""

    def rule(node: Term) -> Term:
        if node.head == "dot" and node.args[0] == vector and node.args[1].head == "cross":
            return zero(SCALAR) if vector in node.args[1].args else node
        return node

    return named("a x a = 0", everywhere(rule))


def _regroup(factor: Term, side: int) -> Rule:
    def rule(node: Term) -> Term:
        if node.head == "mul" and factor in node.args[:-1] and node.args[-1].head in BILINEAR:
            rest, sides = list(node.args[:-1]), list(node.args[-1].args)
            rest.remove(factor)
            sides[side] = mul(factor, sides[side])
            return mul(*rest, rebuild(node.args[-1], sides))
        return node

    return named("associativity", everywhere(rule))


def regroup(factor: Term) -> Rule:
    """Return the rule s (a.b) = (s a).b, and so for every product, for the scalar ``factor``."""
    return _regroup(factor, 0)


def regroup_right(factor: Term) -> Rule:
    """Return the rule s (a x b) = a x (s b), and so for every product, for the scalar ``factor``."""
    return _regroup(factor, 1)


def _associate(node: Term) -> Term:
    if node.head == "matmul" and node.args[1].head == "matmul":
        a, (b, c) = node.args[0], node.args[1].args
        return matmul(matmul(a, b), c)
    return node


associate = named("associativity", until_stable(_associate))
"""A (B c) = (A B) c."""


def seen_from(frame: str) -> Rule:
    """Return the rule that writes inertial derivatives, innermost first, by those in ``frame``.

    The derivative of the angular velocity is the same in both frames.
    """
    w = omega(frame)

    def rule(node: Term) -> Term:
        if node.head != "der" or node.data != (INERTIAL,) or node.kind != VECTOR:
            return node
        if node.args[0] == w:
            return der(w, frame)
        parted = differentiate(distribute(node))
        return parted if parted != node else transport(frame)(node)

    return named("transport theorem", lambda term: distribute(until_stable(rule)(term)))


def factor_scalar(factor: Term) -> Rule:
    """Return the rule s a + s b = s (a + b) for the scalar ``factor`` s."""

    def rule(node: Term) -> Term:
        if node.head != "add":
            return node
        inside, rest = [], []
        for t in node.args:
            factors = list(t.args) if t.head == "mul" else [t]
            if factor in factors:
                factors.remove(factor)
                inside.append(mul(*factors) if factors else number(1))
            else:
                rest.append(t)
        return add(mul(factor, add(*inside)), *rest) if len(inside) > 1 else node

    return named("common factor", everywhere(rule))
