"""Exact randomised equality: whether an expression vanishes for all values of its symbols.

Expressions are evaluated in the integers modulo the prime 2**61 - 1 at random points. Sine and
cosine of integer combinations of angles are rational functions of the half-angle tangents
(s = 2 tau/(1 + tau^2), c = (1 - tau^2)/(1 + tau^2)), so that trigonometric identities are decided
exactly; every other function is an independent unknown of its arguments. A false identity of
total degree d survives one point with a chance of at most d / 2**61 (Schwartz and Zippel).
No ``simplify`` is involved and the time is linear in the size of the expression.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import sympy as sp

from eom.exact.rings import ARITHMETIC, FLOATS, TRIGONOMETRY, Evaluation, summands
from eom.expressions import as_expression
from eom.fields import RESIDUES, Field, Singular

Expr = Any
MAX_COUNT = 64
"""Of an angle in a sum of angles."""


def vanishes(expression: Expr, *, points: int = 3, seed: int = 0) -> bool:
    """Return whether ``expression`` is zero for all values of its symbols.

    True is certain up to the bound of the module's text. False is certain for rational
    functions of symbols, sines and cosines; for others it may also mean "not decided".

    >>> x = sp.Symbol("x")
    >>> vanishes(sp.sin(2 * x) - 2 * sp.sin(x) * sp.cos(x)), vanishes(sp.sin(x) - x)
    (True, False)
    """
    full = as_expression(expression)
    return zero_at_random_points(lambda point: point.value(full), points, seed)


def zero_at_random_points(residual: Callable[[RandomPoint], int], points: int, seed: int) -> bool:
    """Return whether a residual is zero modulo `PRIME` at random points; it raises `Singular` at others."""
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
    """Return whether two expressions, or two matrices entry by entry, are equal everywhere.

    >>> t = sp.Symbol("t")
    >>> equal(sp.cos(t) ** 2, 1 - sp.sin(t) ** 2)
    True
    """
    if isinstance(left, sp.MatrixBase):
        return bool(left.shape == right.shape) and all(
            vanishes(a - b, seed=seed) for a, b in zip(left, right, strict=True)
        )
    return vanishes(left - right, seed=seed)


class RandomPoint(Evaluation):
    """Values modulo the prime, drawn on first use, of symbols, angles and unknown functions.

    ``definitions``: symbols that stand for expressions, and have their values. ``field``: with the prime.
    A power that is no whole one is an unknown too, so that only identities in it as such are seen.
    """

    rows = ARITHMETIC | FLOATS | TRIGONOMETRY

    def __init__(
        self,
        generator: random.Random,
        definitions: Mapping[Expr, Expr] | None = None,
        field: Field = RESIDUES,
    ) -> None:
        self.generator, self.ring, self.field = generator, field, field
        self.definitions = definitions or {}
        self.memo = {}
        self.circle: dict[Expr, tuple[int, int]] = {}

    def meaning(self, symbol: Expr) -> Expr | None:
        """Return the expression that a symbol stands for."""
        return self.definitions.get(symbol)

    def other(self, node: Expr) -> int:  # noqa: ARG002
        """Draw the value of a symbol, a root or a function."""
        return int(self.field.draw(self.generator))

    def turns(self, angle: Expr) -> Iterator[tuple[int, int, int]]:
        """Yield points of the circle, and how often each is added; above `MAX_COUNT` it is a new one."""
        for base, count in summands(angle):
            if count.is_Integer and abs(int(count)) <= MAX_COUNT:
                yield *self._point(base), int(count)
            else:
                yield *self._point(count * base), 1

    def _point(self, base: Expr) -> tuple[int, int]:
        if base not in self.circle:
            self.circle[base] = self.field.circle(self.field.draw(self.generator))
        return self.circle[base]
