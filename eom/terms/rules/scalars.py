"""SymPy scalars within terms: what is put in for their symbols, like terms, constants, dyads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from eom.terms.rules.basic import entrywise, everywhere, until_stable
from eom.terms.rules.tracing import Rule, named, rest_on
from eom.terms.terms import (
    DYADIC,
    SCALAR,
    VECTOR,
    Equation,
    Term,
    add,
    der,
    dot,
    expr,
    mul,
    number,
    rebuild,
    zero,
)
from eom.terms.vocabulary import quantity


def put_in(*lines: Equation) -> Rule:
    """Return the rule that replaces symbols in expressions by what ``lines`` say of them.

    A line may name a symbol, ``s := term``, and another one state that term by an expression.
    """
    known = {line.left: line for line in lines}

    def rule(node: Term) -> Term:
        if node.head != "expr":
            return node
        values = _values(node.data[0].free_symbols, known)
        return expr(node.data[0].xreplace(values)) if values else node

    return named("substitution", until_stable(rule))


def _values(symbols: set[Any], known: Mapping[Term, Equation]) -> dict[Any, Any]:
    """Return the expressions for symbols, and note the lines that give them."""
    found = {}
    for s in symbols:
        used, term = [], expr(s)
        while term in known and known[term] not in used:
            used.append(known[term])
            term = known[term].right
        if used and term.head == "expr":
            found[s] = term.data[0]
            for line in used:
                rest_on(line)
    return found


def constants(*lines: Equation) -> Rule:
    """Return the rule that constants have no rate, and come out of one; ``lines``: der(s) = 0 for each."""
    known = {line.left.args[0]: line for line in lines}

    def fixed(factor: Term) -> bool:
        symbols = [expr(s) for s in factor.data[0].free_symbols] if factor.head == "expr" else []
        if factor.head != "expr" or any(s not in known for s in symbols):
            return False
        for s in symbols:
            rest_on(known[s])
        return True

    def rule(node: Term) -> Term:
        if node.head != "der":
            return node
        (inside,) = node.args
        if fixed(inside):
            return zero(node.kind)
        if inside.head == "expr":
            still = {s for s in inside.data[0].free_symbols if expr(s) in known}
            factor, rest = inside.data[0].as_independent(*(inside.data[0].free_symbols - still))
            parted = factor != 1 and fixed(expr(factor))
            return mul(expr(factor), rebuild(node, [expr(rest)])) if parted else node
        if inside.head == "mul" and fixed(inside.args[0]):
            return mul(inside.args[0], rebuild(node, [mul(*inside.args[1:])]))
        return node

    return named("constants", everywhere(rule))


def chain(scalars: Mapping[Any, Term]) -> Rule:
    """Return the chain rule for rates of expressions: f' = sum of (df/ds) s' over the symbols in f.

    ``scalars``: what symbols stand for; numbers have no rate, and a rate with a symbol is written by it.
    """
    symbols = {t.args[0]: s for s, t in scalars.items() if t.head == "der" and t.kind == SCALAR}

    def rate(s: Any) -> Term:
        meaning = scalars.get(s)
        if meaning is not None and meaning.data[:1] == ("scalar",):
            return number(0)
        return expr(symbols[expr(s)]) if expr(s) in symbols else der(expr(s))

    def rule(node: Term) -> Term:
        if node.head != "der" or node.args[0].head != "expr":
            return node
        inside = node.args[0].data[0]
        if inside.is_Symbol:
            return rate(inside)
        ordered = sorted(inside.free_symbols, key=sp.default_sort_key)
        return add(number(0), *(mul(expr(inside.diff(s)), rate(s)) for s in ordered))

    return named("chain rule", everywhere(rule))


def initial_values(scalars: Mapping[Any, Term]) -> Rule:
    """Return the rule that writes an expression at the start by the initial values of its symbols.

    ``scalars``: what symbols stand for; numbers are what they are at any time.
    """
    first = {t.args[0]: s for s, t in scalars.items() if t.head == "start" and t.kind == SCALAR}
    numbers = {s: s for s, t in scalars.items() if t.data[:1] == ("scalar",)}

    def rule(node: Term) -> Term:
        if node.head != "start" or node.args[0].head != "expr":
            return node
        inside = node.args[0].data[0]
        values = {s: first.get(expr(s), numbers.get(s)) for s in inside.free_symbols}
        return node if None in values.values() else expr(inside.xreplace(values))

    return named("initial values", everywhere(rule))


def out_of_sums(scalars: Mapping[Any, Term]) -> Rule:
    """Return the rule that numbers and coordinates, as ``scalars`` names them, come out of sums."""

    def rule(node: Term) -> Term:
        if node.head not in {"sum", "integral"} or node.args[0].head != "mul":
            return node
        factor, *rest = node.args[0].args
        symbols = factor.data[0].free_symbols if factor.head == "expr" else {None}
        if any(s not in scalars or scalars[s].data[:1] not in _ONE_FOR_ALL for s in symbols):
            return node
        return mul(factor, rebuild(node, [mul(*rest)]))

    return named("constants out of sums", everywhere(rule))


_ONE_FOR_ALL = (("scalar",), ("coordinate",))


def _collect(node: Term) -> Term:
    if node.head != "add":
        return node
    counted: dict[Term | None, Any] = {}
    for part in node.args:
        factor, rest = _scaled(part)
        counted[rest] = counted.get(rest, 0) + factor
    return add(
        zero(node.kind),
        *(expr(c) if rest is None else mul(expr(c), rest) for rest, c in counted.items()),
    )


def _scaled(term: Term) -> tuple[Any, Term | None]:
    """Return the SymPy factor of a term, and the rest, None where there is none."""
    if term.head == "expr":
        return term.data[0], None
    if term.head == "mul" and term.args[0].head == "expr":
        return term.args[0].data[0], mul(*term.args[1:])
    return sp.Integer(1), term


collect: Rule = named("like terms", everywhere(_collect))
"""Add like terms, whatever expressions stand before them."""

determinants: Rule = entrywise(
    lambda e: e.replace(lambda n: isinstance(n, sp.Determinant), lambda n: n.arg.det()),
    "determinant",
)
"""Determinants carried out."""

_IDENTITY = quantity("identity")


def _dyads(node: Term) -> Term:
    if node.head != "dot" or node.kind != VECTOR:
        return node
    a, b = node.args
    if a.kind == DYADIC:
        if a == _IDENTITY:
            return b
        return mul(dot(a.args[1], b), a.args[0]) if a.head == "outer" else node
    if b == _IDENTITY:
        return a
    return mul(dot(a, b.args[0]), b.args[1]) if b.head == "outer" else node


dyads: Rule = named("dyads", everywhere(_dyads))
"""1.v = v and (a b).v = a (b.v)."""
