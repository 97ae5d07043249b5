"""What rules are made of: applying them everywhere, to one place, or until nothing changes.

Replacing what is known: statements, definitions, and what vanishes.

Components: from vectors to columns and matrices, and carrying explicit ones out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from typing import Any

import sympy as sp

from eom.kinematics.frames import tilde as skew
from eom.kinematics.frames import time_derivative
from eom.terms.rules.tracing import Rule, named, rest_on
from eom.terms.terms import (
    COLUMN,
    DYADIC,
    INDICES,
    SCALAR,
    Equation,
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
    relabel,
    replace,
    tilde,
    zero,
)
from eom.terms.vocabulary import definition, quantity


def everywhere(rule: Rule) -> Rule:
    """Return the rule that applies ``rule`` to every node, children first."""
    return lambda term: replace(term, rule)


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
    return reduce(lambda t, rule: rule(t), rules, term)


# -- replacing by what is known --------------------------------------------------------------


def match(pattern: Term, term: Term, bound: Mapping[str, str]) -> dict[str, str] | None:
    """Return what the free indices of ``pattern`` stand for in ``term``, or None."""
    if (pattern.head, len(pattern.args)) != (term.head, len(term.args)):
        return None
    if pattern.head == "atom":
        return _match_labels(pattern.data, term.data, dict(bound))
    if pattern.head in {"sum", "integral"}:
        return _match_sum(pattern, term, bound)
    if pattern.data != term.data:
        return None
    found: dict[str, str] | None = dict(bound)
    for p, t in zip(pattern.args, term.args, strict=True):
        found = match(p, t, found) if found is not None else None
    return found


def _match_sum(pattern: Term, term: Term, bound: Mapping[str, str]) -> dict[str, str] | None:
    """Match the summands; the indices of the sums correspond, and nothing else stands for them."""
    ours, theirs = pattern.data[0], term.data[0]
    if pattern.data[1:] != term.data[1:]:
        return None
    found = match(pattern.args[0], term.args[0], {**bound, ours: theirs})
    if found is None:
        return None
    outer = {k: v for k, v in found.items() if k != ours}
    if theirs in outer.values():
        return None
    return {**outer, **({ours: bound[ours]} if ours in bound else {})}


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


SUBSTITUTION, DEFINITION = "substitution", "definition"
"""What replacing is called."""


def use(statement: Equation, backwards: bool = False) -> Rule:
    """Return the rule that replaces the left side of ``statement`` by its right, for any index."""
    old, new = statement.left, statement.right
    if backwards:
        old, new = new, old

    def rule(node: Term) -> Term:
        found = match(old, node, {})
        if found is None:
            return node
        rest_on(statement)
        return relabel(new, found)

    return named(SUBSTITUTION, everywhere(rule))


def put(old: Term, new: Term) -> Rule:
    """Return the rule that replaces ``old``, with its very indices, by ``new``."""

    def rule(node: Term) -> Term:
        if node != old:
            return node
        rest_on(Equation(old, new))
        return new

    return named(SUBSTITUTION, everywhere(rule))


def unfold(*names: str) -> Rule:
    """Return the rule that replaces the named quantities by what defines them."""

    def rule(node: Term) -> Term:
        meaning = definition(node) if node.head == "atom" and node.data[0] in names else None
        if meaning is None:
            return node
        rest_on(Equation(node, meaning, ":="))
        return meaning

    return named(DEFINITION, everywhere(rule))


def fold_into(*quantities: Term) -> Rule:
    """Return the rule that replaces the definition of each quantity by its name."""

    def rule(node: Term) -> Term:
        for q in quantities:
            meaning = definition(q)
            found = match(meaning, node, {}) if meaning is not None else None
            if found is not None and meaning is not None:
                rest_on(Equation(q, meaning, ":="))
                return relabel(q, found)
        return node

    return named(DEFINITION, everywhere(rule))


# -- components ------------------------------------------------------------------------------


def vanish(*terms: Term) -> Rule:
    """Return the rule that puts zero for each of ``terms``."""

    def rule(node: Term) -> Term:
        if node not in terms:
            return node
        rest_on(Equation(node, zero(node.kind)))
        return zero(node.kind)

    return named(SUBSTITUTION, everywhere(rule))


def by_way_of(frame: str, to_frame: str = "I") -> Rule:
    """Return the rule [v]_I = C_IA [v]_A."""
    C = quantity("rotation", to_frame, frame)

    def rule(node: Term) -> Term:
        if node.head == "column" and node.data == (to_frame,) and node.kind == COLUMN:
            return matmul(C, column(node.args[0], frame))
        return node

    return named("rotation of components", everywhere(rule))


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
    return named("components", until_stable(lambda node: _components(frame, node)))


def scalars_in(frame: str) -> Rule:
    """Return the rule a.b = [a]^T [b] for scalar products of vectors."""

    def rule(node: Term) -> Term:
        if node.head == "dot" and node.kind == SCALAR:
            a, b = (column(x, frame) for x in node.args)
            return inner(a, b)
        return node

    return named("components", everywhere(rule))


def compute(rates: Mapping[Any, Any] | None = None) -> Rule:
    """Return the rule that carries out matrix products, sums and derivatives of explicit entries."""
    known = rates or {}

    def rule(node: Term) -> Term:
        if node.args and all(_is_explicit(a) for a in node.args) and node.head in _EXPLICIT:
            return _from_matrix(_EXPLICIT[node.head](known, *(_matrix(a) for a in node.args)))
        return node

    return named("carried out", everywhere(rule))


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


def entrywise(rule: Callable[[Any], Any], words: str = "algebra") -> Rule:
    """Return a rule on SymPy expressions, ``words``: its name, applied to every one in the term."""

    def on(node: Term) -> Term:
        return expr(rule(node.data[0])) if node.head == "expr" else node

    return named(words, everywhere(on))
