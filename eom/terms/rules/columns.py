"""Components: from vectors to columns and matrices, and carrying explicit ones out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import reduce
from typing import Any

import sympy as sp

from eom.kinematics.frames import tilde as skew
from eom.kinematics.transport import time_derivative
from eom.terms.rules.basic import Rule, everywhere, until_stable
from eom.terms.terms import (
    COLUMN,
    DYADIC,
    SCALAR,
    Term,
    add,
    column,
    der,
    entries,
    expr,
    inner,
    matmul,
    mul,
    outer_column,
    rebuild,
    tilde,
)
from eom.terms.vocabulary import quantity


def by_way_of(frame: str, to_frame: str = "I") -> Rule:
    """Return the rule [v]_I = C_IA [v]_A."""
    C = quantity("rotation", to_frame, frame)

    def rule(node: Term) -> Term:
        if node.head == "column" and node.data == (to_frame,) and node.kind == COLUMN:
            return matmul(C, column(node.args[0], frame))
        return node

    return everywhere(rule)


_INWARDS: dict[str, Callable[[Term, Callable[[Term], Term]], Term]] = {
    "add": lambda x, of: add(*map(of, x.args)),
    "sum": lambda x, of: rebuild(x, [of(x.args[0])]),
    "integral": lambda x, of: rebuild(x, [of(x.args[0])]),
    "mul": lambda x, of: mul(*x.args[:-1], of(x.args[-1])),
    "cross": lambda x, of: matmul(tilde(of(x.args[0])), of(x.args[1])),
    "outer": lambda x, of: outer_column(of(x.args[0]), of(x.args[1])),
}
"""How components are taken of each operation on vectors, whatever the frame."""


def _components(frame: str, node: Term) -> Term:
    """Push the taking of components inwards by one operation."""
    if node.head != "column" or node.data != (frame,):
        return node
    (x,) = node.args
    if x.head in _INWARDS:
        return _INWARDS[x.head](x, lambda part: column(part, frame))
    if x.head == "dot" and x.args[0].kind == DYADIC:
        return matmul(column(x.args[0], frame), column(x.args[1], frame))
    if x.head == "der" and x.data == (frame,):
        return der(column(x.args[0], frame))
    return _ONE if x == _UNIT_DYADIC else node


_UNIT_DYADIC, _ONE = quantity("identity"), quantity("identity_matrix")


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

    return everywhere(rule)


def compute(rates: Mapping[Any, Any] | None = None) -> Rule:
    """Return the rule that carries out matrix products, sums and derivatives of explicit entries."""
    known = rates or {}

    def rule(node: Term) -> Term:
        if node.args and all(_is_explicit(a) for a in node.args) and node.head in _EXPLICIT:
            return _from_matrix(_EXPLICIT[node.head](known, *(_matrix(a) for a in node.args)))
        return node

    return everywhere(rule)


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
    return sp.Matrix(skew(a))


def _rates(rates: Mapping[Any, Any], a: Any) -> Any:
    if isinstance(a, sp.MatrixBase):
        return a.applyfunc(lambda e: time_derivative(e, rates))
    return time_derivative(a, rates)


_EXPLICIT: dict[str, Callable[..., Any]] = {
    "add": lambda _, *args: reduce(lambda a, b: a + b, args),
    "mul": lambda _, *args: reduce(lambda a, b: a * b, args),
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

    return everywhere(on)
