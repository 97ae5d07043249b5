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

from codegen.frontend import lower as massmatrix
from codegen.ir import linsolve
from codegen.ir.interpret import Point
from codegen.ir.linsolve import Shape
from codegen.ir.ops import OPS, SOLVE, TRUTH_VALUES, Instruction, row_of
from codegen.ir.program import Builder
from eom.tables import OUTSIDE, Table

STATES, PARAMETERS = 3, 2
DIGITS = 50
LARGEST = 1e8
"""Magnitude of the value of a subexpression at its base point."""
TRIES = 20
DEPTHS = (2, 3, 3, 4, 4, 5)

COMPARISONS = ("lt", "le", "eq")
JUNCTIONS = ("and", "or", "not")
ARITHMETIC = ("add", "sub", "mul", "div", "neg")
SOLUTION = "solution"
"""One unknown of a linear system; it becomes the operations that `codegen.frontend.lower` chooses."""
INTEGERS: dict[str, tuple[int, int]] = {"besselj": (0, 4), "bessely": (0, 4), "stumpff": (1, 5)}
"""Operations whose first operand is an integer constant, and its range."""
FUNCTIONS = tuple(op for op in OPS if op not in {*ARITHMETIC, *TRUTH_VALUES, "select", *SOLVE})
DRAWN = (ARITHMETIC, FUNCTIONS, FUNCTIONS, ARITHMETIC, ("select",), ("select", "table", SOLUTION))
SIZES = (2, 2, 3, 3, 4, 9)
"""Rows of matrices: the largest is beyond what becomes straight-line code."""

CONSTANTS = (
    *(Fraction(k) for k in (-3, -1, 0, 1, 2, 7)),
    *(Fraction(a, b) for a, b in ((1, 3), (-7, 5), (1, 2), (22, 7), (-1, 1000))),
    Fraction(0.1),
    Fraction(1e-9),
)
TABLE_KINDS = ("linear", "cubic", "pchip")
SPECIAL = (0.0, -0.0, 1.0, -1.0, 0.5, -2.0, 1e-300, 5e-324, 1e20, -1e160, 1.7e308)


@dataclass(frozen=True)
class Tree:
    """An operation on trees, or a leaf with its slot or constant.

    ``leaf``: also the table of a ``table``; of a `SOLUTION` the number of the unknown, its operands
    are the matrix by rows and the right-hand side.
    """

    op: str
    args: tuple[Tree, ...] = ()
    leaf: Fraction | int | Table | None = None

    def __str__(self) -> str:
        """Return nested calls; x, p: states and parameters by number."""
        if self.op in {"state", "parameter"}:
            return f"{self.op[0] if self.op == 'parameter' else 'x'}{self.leaf}"
        if self.op == "const":
            return str(self.leaf)
        args = ", ".join(map(str, self.args))
        if self.leaf is not None:
            return f"{self.op}[{self.leaf}]({args})"
        return f"{self.op}({args})" if args else self.op

    def parts(self) -> Iterator[Tree]:
        """Return this tree and all below it, the small ones first."""
        for a in self.args:
            yield from a.parts()
        yield self

    def operations(self) -> set[str]:
        """Return the names of the operations in it."""
        return {part.op for part in self.parts() if part.args}

    def build(self, b: Builder) -> int:
        """Append the tree to a program that is being built."""
        numbers = [a.build(b) for a in self.args]
        if self.op == SOLUTION:
            assert isinstance(self.leaf, int)
            return massmatrix.solve(b, *_system(numbers))[self.leaf]
        if numbers:
            return b.add(self.op, *numbers, value=self.leaf)
        return b.leaf(self.op, self.leaf)

    def exact(self, m: Any, point: Point) -> Any:
        """Return the value in the mpmath context ``m``; NaN where it is not a real number."""
        if self.args:
            return self.of(m, [a.exact(m, point) for a in self.args])
        return _leaf(m, self, point)

    def of(self, m: Any, values: list[Any]) -> Any:
        """Return the value of the operation from the values of its operands."""
        if self.op == SOLUTION:
            return _solution(m, values)[self.leaf]
        row = row_of(Instruction(self.op, (), self.leaf))
        return _real(m, lambda: row.exact(m, *values))


def _system(given: list[Any]) -> tuple[list[list[Any]], list[Any]]:
    """Return matrix and right-hand side from the operands of a `SOLUTION`."""
    size = next(n for n in SIZES if n * (n + 1) == len(given))
    return [given[i * size : (i + 1) * size] for i in range(size)], given[size * size :]


def _solution(m: Any, values: list[Any]) -> Any:
    matrix, right = _system(values)
    shape = Shape(len(right), symmetric=False)
    entries = [entry for row in matrix for entry in row]
    return linsolve.back_exact(m, linsolve.factor_exact(m, shape, *entries), *right)


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
    """Return the base point of a unit, half as many others of modest size, then extreme ones.

    Of the modest ones every other is near the base point. The extreme ones are the base point with
    one or two numbers replaced: where most are extreme, few expressions have a value.
    """
    draw = random.Random(f"{seed} points {unit}")
    base, *found = [_modest(draw) for _ in range(1 + count // 2)]
    found[::2] = [[v * draw.uniform(0.9, 1.1) for v in base] for _ in found[::2]]
    for _ in range(1 + count // 2, count):
        numbers = list(base)
        for k in draw.sample(range(len(base)), draw.choice((1, 1, 2))):
            numbers[k] = draw.choice(SPECIAL)
        found.append(numbers)
    return [Point(v[0], v[1:4], v[4:6]) for v in (base, *found)][:count]


def _modest(draw: random.Random) -> list[float]:
    return [draw.choice((-1, 1)) * draw.uniform(0.05, 3.0) for _ in range(6)]


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
            op = self.source.choice(self.source.choice(DRAWN))
            tree, value = self._operation(op, depth - 1)
            if self.m.isfinite(value) and abs(value) < LARGEST:
                return tree, value
        return self._with_value(self._leaf())

    def _operation(self, op: str, depth: int) -> tuple[Tree, Any]:
        leaf: Table | int | None = None
        if op == SOLUTION:
            parts, leaf = self._linear_system(min(depth, 2))
        elif op == "select":
            parts = [self._condition(depth), *(self._value(depth) for _ in range(2))]
        elif op in INTEGERS:
            order = Tree("const", (), Fraction(self.source.randint(*INTEGERS[op])))
            parts = [self._with_value(order), self._value(depth)]
        else:
            leaf = self._table() if op == "table" else None
            parts = [self._value(depth) for _ in range(OPS[op].arity)]
        return self._joined(op, parts, leaf)

    def _linear_system(self, depth: int) -> tuple[list[tuple[Tree, Any]], int]:
        """Return matrix and right-hand side, and the number of an unknown; half are symmetric."""
        size = self.source.choice(SIZES)
        depth = depth if size < max(SIZES) else 0
        rows = [[self._value(self._at_most(depth)) for _ in range(size)] for _ in range(size)]
        if self.source.random() < 0.5:
            rows = [[rows[min(i, j)][max(i, j)] for j in range(size)] for i in range(size)]
        right = [self._value(self._at_most(depth)) for _ in range(size)]
        return [*(entry for row in rows for entry in row), *right], self.source.randrange(size)

    def _at_most(self, depth: int) -> int:
        return self.source.choice((0, 0, 0, depth))

    def _table(self) -> Table:
        count = self.source.randint(2, 6)
        at = sorted(self.source.sample(range(-12, 13), count))
        values = [self.source.choice((0.0, self.source.uniform(-3, 3))) for _ in at]
        words = self.source.choice(TABLE_KINDS), self.source.choice(list(OUTSIDE))
        order = self.source.choice((0, 0, 1))
        return Table("curve", tuple(v / 4 for v in at), tuple(values), *words, order)

    def _condition(self, depth: int) -> tuple[Tree, Any]:
        if depth and self.source.random() < 0.3:
            op = self.source.choice(JUNCTIONS)
            parts = [self._condition(depth - 1) for _ in range(OPS[op].arity)]
        else:
            op = self.source.choice(COMPARISONS)
            parts = [self._value(max(depth - 1, 0)) for _ in range(2)]
        return self._joined(op, parts)

    def _joined(
        self, op: str, parts: list[tuple[Tree, Any]], leaf: Table | int | None = None
    ) -> tuple[Tree, Any]:
        tree = Tree(op, tuple(t for t, _ in parts), leaf)
        return tree, tree.of(self.m, [v for _, v in parts])

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
