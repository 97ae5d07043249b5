"""Random expressions over the table of operations, as trees, with their exact values.

An expression is drawn at a base point at which it is finite: an operation that has no real value
there, or a huge one, is drawn again. Trees know nothing of folding; that is what makes their values an
oracle for it.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath

from codegen.interpret import Point
from codegen.ops import OPS, TRUTH_VALUES
from codegen.program import Builder

STATES, PARAMETERS = 3, 2
DIGITS = 50
LARGEST = 1e8
"""Magnitude of the value of a subexpression at its base point."""
TRIES = 20
DEPTHS = (2, 3, 3, 4, 4, 5)

COMPARISONS = ("lt", "le", "eq")
JUNCTIONS = ("and", "or", "not")
ARITHMETIC = ("add", "sub", "mul", "div", "neg")
WITH_VALUE = {"table", "factor", "back", "item"}
"""Operations that hold more than their operands; they are not drawn."""
INTEGERS: dict[str, tuple[int, int]] = {"besselj": (0, 4), "bessely": (0, 4), "stumpff": (1, 5)}
"""Operations whose first operand is an integer constant, and its range."""
FUNCTIONS = tuple(op for op in OPS if op not in {*ARITHMETIC, *TRUTH_VALUES, "select", *WITH_VALUE})

CONSTANTS = (
    *(Fraction(k) for k in (-3, -1, 0, 1, 2, 7)),
    *(Fraction(a, b) for a, b in ((1, 3), (-7, 5), (1, 2), (22, 7), (-1, 1000))),
    Fraction(0.1),
    Fraction(1e-9),
)
SPECIAL = (0.0, -0.0, 1.0, -1.0, 0.5, -2.0, 1e-300, 5e-324, 1e20, -1e160, 1.7e308)


@dataclass(frozen=True)
class Tree:
    """An operation on trees, or a leaf with its slot or constant."""

    op: str
    args: tuple[Tree, ...] = ()
    leaf: Fraction | int | None = None

    def __str__(self) -> str:
        """Return nested calls; x, p: states and parameters by number."""
        if self.op in {"state", "parameter"}:
            return f"{self.op[0] if self.op == 'parameter' else 'x'}{self.leaf}"
        if self.op == "const":
            return str(self.leaf)
        return f"{self.op}({', '.join(map(str, self.args))})" if self.args else self.op

    def parts(self) -> Iterator[Tree]:
        """Return this tree and all below it, the small ones first."""
        for a in self.args:
            yield from a.parts()
        yield self

    def operations(self) -> set[str]:
        """Return the names of the operations in it."""
        return {part.op for part in self.parts() if part.op in OPS}

    def build(self, b: Builder) -> int:
        """Append the tree to a program that is being built."""
        if self.op in OPS:
            return b.add(self.op, *[a.build(b) for a in self.args])
        return b.leaf(self.op, self.leaf)

    def exact(self, m: Any, point: Point) -> Any:
        """Return the value in the mpmath context ``m``; NaN where it is not a real number."""
        if self.op in OPS:
            return _real(m, lambda: OPS[self.op].exact(m, *[a.exact(m, point) for a in self.args]))
        return _leaf(m, self, point)


def _leaf(m: Any, tree: Tree, point: Point) -> Any:
    if tree.op == "const":
        assert isinstance(tree.leaf, Fraction)
        return m.mpf(tree.leaf.numerator) / tree.leaf.denominator
    if tree.op == "pi":
        return +m.pi
    if tree.op == "time":
        return m.mpf(point.t)
    assert isinstance(tree.leaf, int)
    return m.mpf((point.x if tree.op == "state" else point.p)[tree.leaf])


def _real(m: Any, evaluate: Callable[[], Any]) -> Any:
    try:
        value = evaluate()
    except (ValueError, ZeroDivisionError, OverflowError):
        return m.nan
    return m.nan if isinstance(value, m.mpc) else value


def context() -> Any:
    """Return a context of `DIGITS` digits."""
    m = mpmath.mp.clone()
    m.dps = DIGITS
    return m


def points(seed: int, unit: int, count: int) -> list[Point]:
    """Return the base point of a unit, and others: some near it, some with extreme numbers."""
    draw = random.Random(f"{seed} points {unit}")
    near, others = [], []
    for k in range(count):
        numbers = [draw.choice((-1, 1)) * draw.uniform(0.05, 3.0) for _ in range(6)]
        if k % 2:
            others.append([draw.choice((*SPECIAL, v)) for v in numbers])
        else:
            near.append(numbers)
    return [Point(v[0], v[1:4], v[4:6]) for v in (*near, *others)]


@dataclass
class Draw:
    """Draws trees that are finite at a base point."""

    source: random.Random
    point: Point
    m: Any

    def tree(self) -> Tree:
        """Return a tree of a random depth."""
        return self._value(self.source.choice(DEPTHS))[0]

    def _value(self, depth: int) -> tuple[Tree, Any]:
        if depth == 0 or self.source.random() < 0.1:
            return self._with_value(self._leaf())
        for _ in range(TRIES):
            op = self.source.choice(self.source.choice((ARITHMETIC, FUNCTIONS, ("select",))))
            tree, value = self._operation(op, depth - 1)
            if self.m.isfinite(value) and abs(value) < LARGEST:
                return tree, value
        return self._with_value(self._leaf())

    def _operation(self, op: str, depth: int) -> tuple[Tree, Any]:
        if op == "select":
            parts = [self._condition(depth), *(self._value(depth) for _ in range(2))]
        elif op in INTEGERS:
            order = Tree("const", (), Fraction(self.source.randint(*INTEGERS[op])))
            parts = [self._with_value(order), self._value(depth)]
        else:
            parts = [self._value(depth) for _ in range(OPS[op].arity)]
        return self._joined(op, parts)

    def _condition(self, depth: int) -> tuple[Tree, Any]:
        if depth and self.source.random() < 0.3:
            op = self.source.choice(JUNCTIONS)
            parts = [self._condition(depth - 1) for _ in range(OPS[op].arity)]
        else:
            op = self.source.choice(COMPARISONS)
            parts = [self._value(max(depth - 1, 0)) for _ in range(2)]
        return self._joined(op, parts)

    def _joined(self, op: str, parts: list[tuple[Tree, Any]]) -> tuple[Tree, Any]:
        values = [v for _, v in parts]
        value = _real(self.m, lambda: OPS[op].exact(self.m, *values))
        return Tree(op, tuple(t for t, _ in parts)), value

    def _leaf(self) -> Tree:
        kind = self.source.choice(("state", "state", "parameter", "const", "time", "pi"))
        if kind == "const":
            return Tree("const", (), self.source.choice(CONSTANTS))
        count = {"state": STATES, "parameter": PARAMETERS}.get(kind)
        return Tree(kind, (), None if count is None else self.source.randrange(count))

    def _with_value(self, leaf: Tree) -> tuple[Tree, Any]:
        return leaf, _leaf(self.m, leaf, self.point)


def draw(seed: int, index: int, base: Point, m: Any) -> Tree:
    """Return expression ``index``, the same for the same seed and base point."""
    return Draw(random.Random(f"{seed} {index}"), base, m).tree()
