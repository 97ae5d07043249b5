"""Rewriting rules of vector mechanics: from a term to an equal one.

A rule is a function ``Term -> Term`` that knows one law; a derivation applies rules and gives the
reason. Rules know no physics beyond the calculus of vectors, sums and derivatives: everything else
enters through `use`, which replaces one side of an established statement by the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import reduce as fold
from typing import Any

import sympy as sp

from eom.terms import (
    INDICES,
    INERTIAL,
    SCALAR,
    VECTOR,
    Equation,
    Term,
    add,
    atom,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    inner,
    labels_of,
    make,
    matmul,
    mul,
    nodes,
    number,
    outer,
    outer_column,
    rebuild,
    relabel,
    replace,
    tilde,
    zero,
)
from eom.transport import time_derivative
from eom.vocabulary import definition, omega

Rule = Callable[[Term], Term]

_BILINEAR = frozenset({"dot", "cross", "outer", "matmul", "inner", "outer_column"})
_LINEAR = frozenset({"der", "sum", "integral", "column", "tilde", "transpose"})


def until_stable(rule: Rule) -> Rule:
    """Apply ``rule`` to all nodes again and again until nothing changes."""

    def repeated(term: Term) -> Term:
        for _ in range(50):
            new = replace(term, rule)
            if new == term:
                return term
            term = new
        raise AssertionError("a rule does not come to an end")

    return repeated


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
    coefficient, rest = _coefficient(node.args[0])
    return node if coefficient == 1 else mul(expr(coefficient), rebuild(node, [rest]))


def _distribute(node: Term) -> Term:
    if node.head not in {*_BILINEAR, *_LINEAR, "mul"}:
        return node
    spread = _spread(node)
    if spread is not node or node.head == "mul":
        return spread
    return _factors_out(node) if node.head in _BILINEAR else _number_out(node)


distribute = until_stable(_distribute)
"""Products, sums, integrals and derivatives are linear: a x (b + c) = a x b + a x c."""


def _product_rule(node: Term) -> Term:
    if node.head != "der":
        return node
    (inside,) = node.args
    if inside.head in _BILINEAR or inside.head == "mul":
        args = inside.args
        varied = (
            [*args[:k], _rate(a, node.data[0]), *args[k + 1 :]] for k, a in enumerate(args)
        )
        return add(*(rebuild(inside, v) for v in varied))
    if inside.head == "expr" and inside.data[0].is_number:
        return zero(node.kind)
    return node


def _rate(term: Term, frame: str) -> Term:
    if term.head == "expr" and term.data[0].is_number:
        return zero(term.kind)
    return der(term, frame or INERTIAL)


def _differentiate(node: Term) -> Term:
    if node.head == "der" and node.args[0].head == "add":
        return _spread(node)
    return _product_rule(node)


differentiate = until_stable(_differentiate)
"""The product rule, term by term: (a x b)' = a' x b + a x b'."""


def _under_the_sum(node: Term) -> Term:
    if node.head == "der" and node.args[0].head in {"sum", "integral"}:
        inside = node.args[0]
        return make(inside.head, (der(inside.args[0], node.data[0]),), inside.data)
    return node


differentiate_under = until_stable(_under_the_sum)
"""The derivative of a sum (integral) is the sum (integral) of the derivatives."""


def _parallel(node: Term) -> Term:
    """a x a = 0, also with scalar factors."""
    if node.head != "cross":
        return node
    bare = [a.args[-1] if a.head == "mul" else a for a in node.args]
    return zero(VECTOR) if bare[0] == bare[1] else node


parallel: Rule = lambda term: replace(term, _parallel)  # noqa: E731 - a rule is a value


def _depends(term: Term, index: str) -> bool:
    return index in labels_of(term)


def _take_out(node: Term) -> Term:
    """Move what does not depend on the index out of a sum or integral."""
    if node.head not in {"sum", "integral"}:
        return node
    index = "dm" if node.head == "integral" else node.data[0]
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
    if last.head not in _BILINEAR:
        return node
    a, b = last.args
    if not _depends(b, index):
        return rebuild(last, [rebuild(node, [mul(*scalars, a)]), b])
    if not _depends(a, index):
        return rebuild(last, [a, rebuild(node, [mul(*scalars, b)])])
    return node


take_out = until_stable(_take_out)
"""What does not depend on the index comes out of a sum: sum m_i a x b_i = a x sum m_i b_i."""


def combine(term: Term) -> Term:
    """Add like terms."""

    def gather(node: Term) -> Term:
        if node.head != "add":
            return node
        counted: dict[Term, Any] = {}
        for t in node.args:
            coefficient, rest = _coefficient(t)
            counted[rest] = counted.get(rest, 0) + coefficient
        return add(*(mul(expr(c), rest) for rest, c in counted.items()))

    return replace(term, gather)


def _coefficient(term: Term) -> tuple[Any, Term]:
    if term.head == "mul" and term.args[0].head == "expr" and term.args[0].data[0].is_Rational:
        return term.args[0].data[0], mul(*term.args[1:])
    return sp.Integer(1), term


def _bac_cab(node: Term) -> Term:
    if node.head == "cross" and node.args[1].head == "cross":
        a, (b, c) = node.args[0], node.args[1].args
        return add(mul(dot(a, c), b), -mul(dot(a, b), c))
    return node


bac_cab: Rule = lambda term: replace(term, _bac_cab)  # noqa: E731
"""a x (b x c) = b (a.c) - c (a.b)."""


def _scalar_triple(node: Term) -> Term:
    if node.head == "dot" and node.args[0].head == "cross":
        (a, b), c = node.args[0].args, node.args[1]
        return dot(a, cross(b, c))
    return node


scalar_triple: Rule = lambda term: replace(term, _scalar_triple)  # noqa: E731
"""(a x b).c = a.(b x c)."""


def swap(first: Term, second: Term) -> Rule:
    """Return the rule first x second = -(second x first)."""
    return lambda term: replace(
        term, lambda n: -cross(second, first) if n == cross(first, second) else n
    )


def flip_crosses(inside: Callable[[Term], bool]) -> Rule:
    """Return the rule a x b = -(b x a) for the products that satisfy ``inside``."""

    def rule(node: Term) -> Term:
        return -cross(node.args[1], node.args[0]) if node.head == "cross" and inside(node) else node

    return lambda term: replace(term, rule)


def dyadic_form(vector: Term) -> Rule:
    """Return the rule a (b.v) = (a b).v and s v = s 1.v, which lets ``vector`` stand at the end."""
    identity = atom("identity", kind="dyadic")

    def rule(node: Term) -> Term:
        if node.head != "mul":
            return node
        *scalars, last = node.args
        if last == vector:
            return dot(mul(*scalars, identity), vector)
        for k, s in enumerate(scalars):
            if s.head == "dot" and vector in s.args:
                (other,) = (a for a in s.args if a != vector) if s.args[0] != s.args[1] else (vector,)
                rest = [*scalars[:k], *scalars[k + 1 :]]
                return dot(mul(*rest, outer(last, other)), vector)
        return node

    return lambda term: replace(term, rule)


def factor_right(vector: Term, head: str = "dot") -> Rule:
    """Return the rule A.v + B.v = (A + B).v for ``vector``."""

    def rule(node: Term) -> Term:
        if node.head != "add":
            return node
        split = [_ends_with(t, vector, head) for t in node.args]
        if any(s is None for s in split):
            return node
        return make(head, (add(*(s for s in split if s is not None)), vector))

    return lambda term: replace(term, rule)


def _ends_with(term: Term, vector: Term, head: str) -> Term | None:
    """Return A of A.v or of s (A.v)."""
    scalars, last = (term.args[:-1], term.args[-1]) if term.head == "mul" else ((), term)
    if last.head == head and last.args[1] == vector:
        return mul(*scalars, last.args[0])
    return None


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

    return lambda term: replace(term, rule)


def transport(to_frame: str = "B", from_frame: str = "I") -> Rule:
    """Return the transport theorem: A-derivative of v = B-derivative of v + omega x v."""
    w = omega(to_frame, from_frame)

    def rule(node: Term) -> Term:
        if node.head == "der" and node.data == (from_frame,) and node.kind == VECTOR:
            (v,) = node.args
            return add(der(v, to_frame), cross(w, v))
        return node

    return lambda term: rule(term) if term.head == "der" else replace(term, rule)


def vanish(*terms: Term) -> Rule:
    """Return the rule that puts zero for each of ``terms``."""
    return lambda term: replace(term, lambda n: zero(n.kind) if n in terms else n)


def _depth(term: Term) -> int:
    return 1 + _depth(term.args[0]) if term.head == "der" else 0


def _commute(node: Term) -> Term:
    if node.head == "dot" and node.kind == SCALAR and _depth(node.args[0]) < _depth(node.args[1]):
        return dot(node.args[1], node.args[0])
    return node


commute: Rule = lambda term: replace(term, _commute)  # noqa: E731
"""a.b = b.a, with the higher derivative first."""


def _regroup(factor: Term, side: int) -> Rule:
    def rule(node: Term) -> Term:
        if node.head == "mul" and factor in node.args and node.args[-1].head in _BILINEAR:
            rest, sides = list(node.args[:-1]), list(node.args[-1].args)
            rest.remove(factor)
            sides[side] = mul(factor, sides[side])
            return mul(*rest, rebuild(node.args[-1], sides))
        return node

    return lambda term: replace(term, rule)


def regroup(factor: Term) -> Rule:
    """Return the rule s (a.b) = (s a).b, and so for every product, for the scalar ``factor``."""
    return _regroup(factor, 0)


def regroup_right(factor: Term) -> Rule:
    """Return the rule s (a x b) = a x (s b), and so for every product, for the scalar ``factor``."""
    return _regroup(factor, 1)


def product_with_sum(node: Term) -> Term:
    """Return a x sum b_j as sum a x b_j, where the second factor is a sum."""
    if node.head in _BILINEAR and node.args[1].head in {"sum", "integral"}:
        a, s = node.args
        return rebuild(s, [rebuild(node, [a, s.args[0]])])
    return node


into_sums = until_stable(product_with_sum)
"""a x sum b_j = sum a x b_j."""


def by_way_of(frame: str, to_frame: str = "I") -> Rule:
    """Return the rule [v]_I = C_IA [v]_A."""
    C = atom("rotation", to_frame, frame, kind="matrix")

    def rule(node: Term) -> Term:
        if node.head == "column" and node.data == (to_frame,):
            return matmul(C, column(node.args[0], frame))
        return node

    return lambda term: replace(term, rule)


def at(target: Term, *rules: Rule) -> Rule:
    """Return ``rules`` applied to the occurrences of ``target`` alone."""
    return lambda term: replace(term, lambda n: apply(rules, n) if n == target else n)


def inside(head: str, *rules: Rule) -> Rule:
    """Return ``rules`` applied within the nodes of one head."""

    def rule(node: Term) -> Term:
        return apply(rules, node) if node.head == head else node

    return lambda term: replace(term, rule)


def apply(rules: Iterable[Rule], term: Term) -> Term:
    """Apply rules one after the other."""
    return fold(lambda t, rule: rule(t), rules, term)


# -- replacing by what is known --------------------------------------------------------------


def match(pattern: Term, term: Term, bound: Mapping[str, str]) -> dict[str, str] | None:
    """Return what the indices of ``pattern`` stand for in ``term``, or None."""
    if (pattern.head, len(pattern.args)) != (term.head, len(term.args)):
        return None
    found = dict(bound)
    if pattern.head == "atom":
        return _match_labels(pattern.data, term.data, found)
    if pattern.head in {"sum", "integral"}:
        if pattern.data[1:] != term.data[1:]:
            return None
        found[pattern.data[0]] = term.data[0]
    elif pattern.data != term.data:
        return None
    for p, t in zip(pattern.args, term.args, strict=True):
        next_found = match(p, t, found)
        if next_found is None:
            return None
        found = next_found
    return found


def _match_labels(
    pattern: tuple[Any, ...], term: tuple[Any, ...], found: dict[str, str]
) -> dict[str, str] | None:
    if pattern[0] != term[0] or len(pattern) != len(term):
        return None
    for p, t in zip(pattern[1:], term[1:], strict=True):
        wanted = found.setdefault(p, t) if p in INDICES and t in {*INDICES, "P"} else p
        if wanted != t:
            return None
    return found


def use(statement: Equation, backwards: bool = False) -> Rule:
    """Return the rule that replaces the left side of ``statement`` by its right, for any index."""
    old, new = statement.left, statement.right
    if backwards:
        old, new = new, old

    def rule(node: Term) -> Term:
        found = match(old, node, {})
        return node if found is None else relabel(new, found)

    return lambda term: replace(term, rule)


def put(old: Term, new: Term) -> Rule:
    """Return the rule that replaces ``old``, with its very indices, by ``new``."""
    return lambda term: replace(term, lambda n: new if n == old else n)


def unfold(*names: str) -> Rule:
    """Return the rule that replaces the named quantities by what defines them."""

    def rule(node: Term) -> Term:
        if node.head == "atom" and node.data[0] in names:
            return definition(node) or node
        return node

    return lambda term: replace(term, rule)


def fold_into(*quantities: Term) -> Rule:
    """Return the rule that replaces the definition of each quantity by its name."""

    def rule(node: Term) -> Term:
        for q in quantities:
            meaning = definition(q)
            if meaning is not None and match(meaning, node, {}) is not None:
                return q
        return node

    return lambda term: replace(term, rule)


# -- components ------------------------------------------------------------------------------


def _components(frame: str, node: Term) -> Term:
    """Push the taking of components inwards by one operation."""
    if node.head != "column" or node.data != (frame,):
        return node
    (x,) = node.args
    if x.head in {"add", "sum", "integral"}:
        return rebuild(x, [column(a, frame) for a in x.args])
    if x.head == "mul":
        return mul(*x.args[:-1], column(x.args[-1], frame))
    if x.head == "cross":
        return matmul(tilde(column(x.args[0], frame)), column(x.args[1], frame))
    if x.head == "outer":
        return outer_column(column(x.args[0], frame), column(x.args[1], frame))
    if x.head == "dot" and x.args[0].kind != VECTOR:
        return matmul(column(x.args[0], frame), column(x.args[1], frame))
    if x.head == "der" and x.data == (frame,):
        return der(column(x.args[0], frame))
    if x == atom("identity", kind="dyadic"):
        return atom("identity_matrix", kind="matrix")
    return node


def components(frame: str) -> Rule:
    """Return the rule for components: [a x b] = tilde[a] [b], [J.v] = [J][v], [B-d v/dt] = d[v]/dt."""
    return until_stable(lambda node: _components(frame, node))


def scalars_in(frame: str) -> Rule:
    """Return the rule a.b = [a]^T [b] for scalar products of vectors."""

    def rule(node: Term) -> Term:
        if node.head == "dot" and node.kind == SCALAR:
            a, b = (column(x, frame) for x in node.args)
            return inner(a, b)
        return node

    return lambda term: replace(term, rule)


def compute(rates: Mapping[Any, Any] | None = None) -> Rule:
    """Return the rule that carries out matrix products, sums and derivatives of explicit entries."""
    known = rates or {}

    def rule(node: Term) -> Term:
        if node.args and all(_is_explicit(a) for a in node.args) and node.head in _EXPLICIT:
            return _from_matrix(_EXPLICIT[node.head](known, *(_matrix(a) for a in node.args)))
        return node

    return lambda term: replace(term, rule)


def _is_explicit(term: Term) -> bool:
    return term.head == "expr" or (
        term.head == "entries" and all(a.head == "expr" for a in term.args)
    )


def _matrix(term: Term) -> Any:
    if term.head == "expr":
        return term.data[0]
    n = len(term.args) // 3
    values = [a.data[0] for a in term.args]
    return sp.Matrix(3, n, values)


def _from_matrix(value: Any) -> Term:
    return entries(value) if isinstance(value, sp.MatrixBase) else expr(value)


def _skew(_: Any, a: Any) -> Any:
    from eom.frames import tilde as skew

    return sp.Matrix(skew(a))


def _rates(rates: Mapping[Any, Any], a: Any) -> Any:
    if isinstance(a, sp.MatrixBase):
        return a.applyfunc(lambda e: time_derivative(e, rates))
    return time_derivative(a, rates)


_EXPLICIT: dict[str, Callable[..., Any]] = {
    "add": lambda _, *args: fold(lambda a, b: a + b, args),
    "mul": lambda _, *args: fold(lambda a, b: a * b, args),
    "matmul": lambda _, a, b: a * b,
    "tilde": _skew,
    "transpose": lambda _, a: a.T,
    "inner": lambda _, a, b: (a.T * b)[0],
    "outer_column": lambda _, a, b: a * b.T,
    "der": _rates,
}


def entrywise(rule: Callable[[Any], Any]) -> Rule:
    """Return a rule on SymPy expressions, applied to every one in the term."""

    def on(node: Term) -> Term:
        return expr(rule(node.data[0])) if node.head == "expr" else node

    return lambda term: replace(term, on)


def contains(term: Term, part: Term) -> bool:
    """Tell whether ``part`` occurs in ``term``."""
    return any(n == part for n in nodes(term))


