"""Partial derivatives of terms, over coordinates and rates, carried out.

With f(q, t): d(f')/dq' = df/dq and d(f')/dq = (df/dq)'. Source: Greenwood, Advanced Dynamics (2003), 2.1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.terms.own import Own
from eom.terms.rules.basic import everywhere, until_stable
from eom.terms.rules.tracing import Rule, named
from eom.terms.terms import (
    INERTIAL,
    SCALAR,
    Term,
    add,
    atom,
    cross,
    der,
    expr,
    mul,
    number,
    partial,
    rebuild,
    zero,
)
from eom.terms.vocabulary import ORIGIN, definition, omega, position

_PRODUCTS = frozenset({"mul", "dot", "cross", "outer", "matmul", "inner", "outer_column"})
_LINEAR = frozenset({"add", "sum", "integral", "transpose", "tilde", "entries", "column"})


@dataclass(frozen=True)
class Slopes:
    """Partial derivatives where ``scalars`` says what symbols stand for, and ``own`` what is defined.

    A symbol that is itself defined as a partial derivative, a momentum, is a variable by itself.
    """

    scalars: Mapping[Any, Term]
    own: Own

    def of(self, term: Term, by: Any) -> Term:
        """Return the derivative of ``term`` by a symbol. Raises `InputError` where it is not known."""
        if term == self.scalars.get(by):
            return number(1)
        if term.head == "expr":
            return self._expression(term.data[0], by)
        if term.head in _PRODUCTS:
            parts = (
                rebuild(term, [*term.args[:k], self.of(a, by), *term.args[k + 1 :]])
                for k, a in enumerate(term.args)
            )
            return add(*parts)
        if term.head in _LINEAR and not self._turning_column(term):
            return rebuild(term, [self.of(a, by) for a in term.args])
        row = {"zero": lambda t, _: t, "atom": self._atom, "der": self._rate}.get(term.head)
        if row is None:
            raise InputError(
                "no partial derivative is known of this",
                got=term.head,
                hint="state it by coordinates and rates first",
            )
        found: Term = row(term, by)
        return found

    def _turning_column(self, term: Term) -> bool:
        return term.head == "column" and term.data[0] in self.own.frames

    def _expression(self, e: Any, by: Any) -> Term:
        parts = [expr(e.diff(by))]
        for s in sorted(e.free_symbols - {by}, key=sp.default_sort_key):
            meaning = self.scalars.get(s)
            if meaning is not None and (
                meaning.head not in {"atom", "partial"} or meaning.data[:1] == ("function",)
            ):
                parts.append(mul(expr(e.diff(s)), self.of(meaning, by)))
        return add(*parts)

    def _atom(self, term: Term, by: Any) -> Term:
        name, *labels = term.data
        if name == "function":
            return self._function(labels, by)
        if name == "unit" and labels[0] in self.own.frames:
            turned = [
                mul(self._expression(sp.sympify(angle, strict=True), by), axis)
                for angle, axis in self.own.turns(labels[0])
            ]
            return cross(add(*turned), term)
        if name == "position" and (self._is_configured(by) or set(labels) & set(self.own.points)):
            return self._place(term, by)
        if name == "angular_velocity" and set(labels) & set(self.own.frames):
            ends = [self.own.turning(frame) for frame in labels]
            return self.of(ends[0] - ends[1], by)
        meaning = definition(term)
        return zero(term.kind) if meaning is None else self.of(meaning, by)

    def _function(self, labels: list[str], by: Any) -> Term:
        """Return the slope of a function of coordinates, by its name with a stroke and the coordinate."""
        name, *variables = labels
        meaning = self.scalars.get(by)
        along = " ".join(map(str, meaning.data)) if meaning is not None else ""
        if along not in variables:
            return number(0)
        whole, *before = name.split("|")
        label = "|".join((whole, *sorted([*before, along])))
        return atom("function", label, *variables, kind=SCALAR)

    def _is_configured(self, by: Any) -> bool:
        """Return whether the places of all particles are functions of this coordinate."""
        meaning = self.scalars.get(by)
        known = meaning is not None and meaning.data[:1] == ("coordinate",)
        return bool(known and meaning and meaning.data[1] in self.own.configured)

    def _place(self, term: Term, by: Any) -> Term:
        """Return the slope of a position: of a place that is not given by others the one that it has."""
        point, origin = term.data[1:]
        if origin != ORIGIN or self.own.place(point) is not None:
            return self.of(self._positions(point, origin), by)
        return partial(term, expr(by)) if self._is_configured(by) else zero(term.kind)

    def _positions(self, point: str, origin: str) -> Term:
        places = [self.own.place(p) for p in (point, origin)]
        first, second = (
            position(p, ORIGIN) if known is None else known
            for p, known in zip((point, origin), places, strict=True)
        )
        return first - second

    def _rate(self, term: Term, by: Any) -> Term:
        (inside,), frame = term.args, term.data[0]
        if frame not in {"", INERTIAL}:
            return self.of(der(inside) - cross(omega(frame), inside), by)
        rate = der(self.of(inside, by)) if not _constant(self.of(inside, by)) else zero(term.kind)
        base = self.scalars.get(by)
        if base is not None and base.head == "der" and base.args[0].head == "expr":
            rate = add(rate, self.of(inside, base.args[0].data[0]))
        return rate


def _constant(term: Term) -> bool:
    return term.is_zero or (term.head == "expr" and not term.data[0].free_symbols)


def _linear_slope(node: Term) -> Term:
    if node.head != "partial":
        return node
    inside, by = node.args
    if inside.head == "add":
        return add(*(partial(a, by) for a in inside.args))
    factor, rest = inside.data[0].as_coeff_Mul() if inside.head == "expr" else (sp.S.One, None)
    return node if factor == 1 else mul(expr(factor), partial(expr(rest), by))


linear_slopes: Rule = named("linearity", until_stable(_linear_slope))
"""The slope of a sum is the sum of slopes, and numbers come out."""


def spelt_out(own: Own) -> Rule:
    """Return the rule that replaces quantities of bodies of one's own by what they are."""
    return until_stable(lambda node: own.meaning(node) or node)


def slopes(scalars: Mapping[Any, Term], own: Own | None = None) -> Rule:
    """Return the rule that carries out partial derivatives by symbols.

    Raises `InputError` for those by what is itself given by other symbols.
    """
    kit = Slopes(scalars, Own() if own is None else own)

    def rule(node: Term) -> Term:
        if node.head != "partial":
            return node
        by = node.args[1].data[0] if node.args[1].head == "expr" else None
        known = scalars.get(by)
        if not isinstance(by, sp.Symbol) or (known is not None and known.head == "expr"):
            raise InputError(
                "a partial derivative by what is no variable",
                got=by,
                expected="a coordinate, a rate or a momentum",
            )
        return kit.of(node.args[0], by)

    return named("partial derivatives", everywhere(rule))
