"""Exact randomised equality: tell whether an expression vanishes for all values of its symbols.

Expressions are evaluated in the integers modulo the prime 2**61 - 1 at random points. Sine and
cosine of integer combinations of angles are rational functions of the half-angle tangents
(s = 2 tau/(1 + tau^2), c = (1 - tau^2)/(1 + tau^2)), so that trigonometric identities are decided
exactly; every other function is an independent unknown of its arguments. A false identity of
total degree d survives one point with a chance of at most d / 2**61 (Schwartz and Zippel).
No ``simplify`` is involved and the time is linear in the size of the expression.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from typing import Any

import sympy as sp

from eom.exact.series import PRIME, Field, Singular
from eom.expressions import as_expression

Expr = Any
FIELD = Field(PRIME)


def vanishes(expression: Expr, *, points: int = 3, seed: int = 0) -> bool:
    """Tell whether ``expression`` is zero for all values of its symbols.

    True is certain up to the bound of the module's text. False is certain for rational
    functions of symbols, sines and cosines; for others it may also mean "not decided".

    >>> x = sp.Symbol("x")
    >>> vanishes(sp.sin(2 * x) - 2 * sp.sin(x) * sp.cos(x)), vanishes(sp.sin(x) - x)
    (True, False)
    """
    full = as_expression(expression)
    return zero_at_random_points(lambda point: point.value(full), points, seed)


def zero_at_random_points(residual: Callable[[RandomPoint], int], points: int, seed: int) -> bool:
    """Tell whether a residual is zero modulo `PRIME` at random points; it raises `Singular` at others."""
    generator = random.Random(seed)  # noqa: S311 - reproducible points, no secrets
    found = 0
    for _ in range(20 * points):
        try:
            if residual(RandomPoint(generator)) != 0:
                return False
        except Singular:
            continue
        found += 1
        if found == points:
            return True
    return False


def equal(left: Expr, right: Expr, *, seed: int = 0) -> bool:
    """Tell whether two expressions, or two matrices entry by entry, are equal everywhere.

    >>> t = sp.Symbol("t")
    >>> equal(sp.cos(t) ** 2, 1 - sp.sin(t) ** 2)
    True
    """
    if isinstance(left, sp.MatrixBase):
        return bool(left.shape == right.shape) and all(
            vanishes(a - b, seed=seed) for a, b in zip(left, right, strict=True)
        )
    return vanishes(left - right, seed=seed)


class RandomPoint:
    """Values modulo the prime, drawn on first use, of symbols, angles and unknown functions.

    ``definitions``: symbols that stand for expressions, and have their values. ``field``: with the prime.
    """

    def __init__(
        self,
        generator: random.Random,
        definitions: Mapping[Expr, Expr] | None = None,
        field: Field = FIELD,
    ) -> None:
        self.generator, self.field, self.prime = generator, field, field.prime
        self.definitions = definitions or {}
        self.memo: dict[Expr, int] = {}
        self.half_tangent: dict[Expr, int] = {}

    def value(self, expression: Expr) -> int:
        """Evaluate with an explicit stack, each distinct node once."""
        stack = [expression]
        while stack:
            node = stack[-1]
            if node in self.memo:
                stack.pop()
                continue
            missing = [a for a in self._operands(node) if a not in self.memo]
            if missing:
                stack.extend(missing)
                continue
            self.memo[node] = self._apply(node) % self.prime
            stack.pop()
        return self.memo[expression]

    def _operands(self, node: Expr) -> tuple[Expr, ...]:
        """Children that must be known first; arguments of functions stay symbolic."""
        if node in self.definitions:
            return (self.definitions[node],)
        if isinstance(node, sp.Pow):
            return (node.as_base_exp()[0],)
        return tuple(node.args) if isinstance(node, sp.Add | sp.Mul) else ()

    def _apply(self, node: Expr) -> int:
        if node in self.definitions:
            return self.memo[self.definitions[node]]
        for kind, rule in _RULES:
            if isinstance(node, kind):
                return rule(self, node)
        return self._draw()

    def _draw(self) -> int:
        return self.generator.randrange(1, self.prime)

    def inverse(self, value: int) -> int:
        """Return the reciprocal. Raises `Singular` for zero."""
        return int(self.field.inverse(value))

    def rotation(self, angle: Expr) -> tuple[int, int]:
        """Return (cosine, sine) of an integer combination of angles, by addition theorems."""
        cosine, sine, p = 1, 0, self.prime
        for base, count in _angle_terms(angle):
            if base not in self.half_tangent:
                self.half_tangent[base] = self._draw()
            tau = self.half_tangent[base]
            scale = self.inverse(1 + tau * tau)
            c, s = (1 - tau * tau) * scale % p, 2 * tau * scale % p
            s = s if count > 0 else -s
            for _ in range(abs(count)):
                cosine, sine = (cosine * c - sine * s) % p, (sine * c + cosine * s) % p
        return cosine, sine

    def power(self, node: Expr) -> int:
        """Integer powers exactly; a fractional one as powers of an unknown root.

        The root is drawn at random, so that only identities in it as an unknown are seen.
        """
        base, exponent = node.as_base_exp()
        if exponent.is_Integer:
            value = self.memo[base]
            n = int(exponent)
            return pow(value if n >= 0 else self.inverse(value), abs(n), self.prime)
        return self._draw()


def _angle_terms(angle: Expr) -> list[tuple[Expr, int]]:
    terms = []
    for term in sp.Add.make_args(angle):
        coefficient, base = term.as_coeff_Mul()
        if coefficient.is_Integer and abs(int(coefficient)) <= 64:
            terms.append((base, int(coefficient)))
        else:
            terms.append((term, 1))
    return terms


_TRIGONOMETRIC: dict[Any, Callable[[RandomPoint, int, int], int]] = {
    sp.sin: lambda p, c, s: s,
    sp.cos: lambda p, c, s: c,
    sp.tan: lambda p, c, s: s * p.inverse(c),
    sp.cot: lambda p, c, s: c * p.inverse(s),
    sp.sec: lambda p, c, s: p.inverse(c),
    sp.csc: lambda p, c, s: p.inverse(s),
}


def _rational(point: RandomPoint, node: Expr) -> int:
    return int(node.p) * point.inverse(int(node.q))


def _float(point: RandomPoint, node: Expr) -> int:
    return _rational(point, sp.Rational(node))


def _trigonometric(point: RandomPoint, node: Expr) -> int:
    return _TRIGONOMETRIC[type(node)](point, *point.rotation(node.args[0]))


_RULES: tuple[tuple[Any, Callable[[RandomPoint, Any], int]], ...] = (
    (sp.Rational, _rational),
    (sp.Float, _float),
    (sp.Add, lambda p, n: sum(p.memo[a] for a in n.args)),
    (sp.Mul, lambda p, n: _product(p.prime, (p.memo[a] for a in n.args))),
    (sp.Pow, lambda p, n: p.power(n)),
    (tuple(_TRIGONOMETRIC), _trigonometric),
)


def _product(prime: int, values: Any) -> int:
    result = 1
    for value in values:
        result = result * value % prime
    return result
