"""``python -m benchmarks.fuzz``: random expressions, every target against the 50-digit interpreter.

Each expression is compared in five ways at several points, some of them extreme: what folding leaves
against the tree as drawn, in 50 digits; what lowering makes of it as a SymPy expression, likewise; each
target's numbers against the running error bound of its precision, wherever the bound holds; to the
last bit, NaN included, where all operations are correctly rounded. Where something differs, the
smallest part of the expression that differs is printed. In the end the generated
texts are compared between processes with different hash seeds.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Any

import click
import mpmath
import numpy as np
import sympy as sp

from benchmarks import fuzz_targets
from benchmarks.expressions import PARAMETERS, STATES, Tree, context, draw, points
from benchmarks.fuzz_targets import precision, refused, rounded, subset, values
from codegen.frontend.lower import lower_expressions
from codegen.ir.interpret import Bounded, Point, interpret, interpret_exactly
from codegen.ir.ops import OPS
from codegen.ir.program import RATES, Builder, Program
from codegen.passes.pipeline import optimise
from eom.errors import InputError
from eom.tables import Table
from tests.codegen.digests import HASH_SEEDS, digests_apart
from tests.codegen.test_compiled import judged

UNIT = 100
"""Expressions that are compiled together."""
POINTS = 5
MODEST = 3
"""Points, and those of them that are not extreme."""
SAME = 1e-35

SYMPY: dict[str, Any] = {
    "add": sp.Add, "sub": lambda a, b: a - b, "mul": sp.Mul, "div": lambda a, b: a / b,
    "neg": lambda a: -a, "sqrt": sp.sqrt, "pow": sp.Pow, "abs": sp.Abs, "min": sp.Min, "max": sp.Max,
    **{op: getattr(sp, op) for op in ("sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh "
                                      "exp log atan2 sign").split()},
    "hypot": lambda a, b: sp.sqrt(a**2 + b**2), "erf": sp.erf, "erfc": sp.erfc, "floor": sp.floor,
    "mod": sp.Mod, "expm1": lambda a: sp.exp(a) - 1, "log1p": lambda a: sp.log(1 + a),
    "besselj": sp.besselj, "bessely": sp.bessely,
    "lt": sp.Lt, "le": sp.Le, "eq": sp.Eq, "and": sp.And, "or": sp.Or, "not": sp.Not,
    "select": lambda c, a, b: sp.Piecewise((a, c), (b, True)),
}  # fmt: skip
"""How operations are written in SymPy; others are not taken that way."""


@dataclass(frozen=True)
class Unit:
    """Expressions that are compiled together, their program, and the points."""

    seed: int
    first: int
    trees: Sequence[Tree]
    program: Program
    at: Sequence[Point]

    @classmethod
    def of(cls, seed: int, first: int, count: int) -> Unit:
        """Draw expressions ``first`` to ``first + count``; ``first`` is a multiple of `UNIT`."""
        m = context()
        at = points(seed, first // UNIT, POINTS)
        trees = [draw(seed, k, at[0], m) for k in range(first, first + count)]
        return cls(seed, first, trees, built(trees), at)


@dataclass
class Findings:
    """Numbers of comparisons by kind, and what differs, as texts."""

    compared: Counter[str] = field(default_factory=Counter)
    left_out: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    """Expressions by target and operation that it lists as unsupported."""
    different: list[str] = field(default_factory=list)

    def judge(self, kind: str, same: bool, unit: Unit, k: int, point: Point, what: str) -> None:
        """Count a comparison; describe it where it failed."""
        self.compared[kind] += 1
        if not same:
            head = f"{kind}: seed {unit.seed}, index {unit.first + k}"
            place = f"t = {point.t!r}, x = {list(point.x)!r}, p = {list(point.p)!r}"
            self.different.append(f"{head}\n  {unit.trees[k]}\n  at {place}\n  {what}")


def built(trees: Sequence[Tree]) -> Program:
    """Return the program of trees, as it is when a system is compiled."""
    b = Builder()
    for kind, count in (("state", STATES), ("parameter", PARAMETERS)):
        for k in range(count):
            b.leaf(kind, k)
    return optimise(b.program({RATES: [t.build(b) for t in trees]}))


def targets_here() -> tuple[list[str], list[str]]:
    """Return the targets that work on this machine, and why the others do not."""
    working, others = [], []
    for target in fuzz_targets.names():
        try:
            values(target, built([Tree("time")]), [Point(0.0, [0.0] * STATES, [0.0] * PARAMETERS)])
            working.append(target)
        except (InputError, ImportError, OSError) as error:
            others.append(f"{target}: {error}".splitlines()[0])
    return working, others


@dataclass(frozen=True)
class Expected:
    """What a unit is at a point: whether each result is reliable, its bound, its value in doubles."""

    point: Point
    sure: list[bool]
    bounds: list[Bounded]
    doubles: list[float]

    @classmethod
    def of(cls, program: Program, point: Point, target: str = "") -> Expected:
        """Return what a target must give, in its precision."""
        sure, bounds = judged(program, point, precision(target))
        numbers = program.results[RATES]
        doubles = interpret(program, point)[RATES]
        return cls(point, [sure[k] for k in numbers], [bounds[k] for k in numbers], doubles)


def check(unit: Unit, targets: Iterable[str], found: Findings) -> None:
    """Compare everything about a unit."""
    expected = [Expected.of(unit.program, point) for point in unit.at]
    _check_building(unit, expected[:MODEST], found)
    for target in targets:
        ops = refused(target, unit.program)
        for op in sorted(set().union(*ops)):
            found.refused[f"{target}, {op}"] += sum(op in each for each in ops)
        which = [k for k, each in enumerate(ops) if not each]
        if target in fuzz_targets.PRECISIONS:
            at = rounded(target, unit.at)
            own = [Expected.of(unit.program, point, target) for point in at]
            _check_target(unit, target, which, own, found)
        else:
            _check_target(unit, target, which, expected, found)


def _check_target(
    unit: Unit, target: str, which: Sequence[int], expected: Sequence[Expected], found: Findings
) -> None:
    """Compare the expressions ``which``, to the last bit where all operations are correctly rounded."""
    at = [e.point for e in expected]
    got = values(target, subset(unit.program, which), at) if which and at else ()
    for row, k in zip(got, which, strict=True):
        exactly = target not in fuzz_targets.PRECISIONS and _correctly_rounded(unit.trees[k])
        for value, e in zip(map(float, row), expected, strict=True):
            if e.sure[k]:
                good, what = _compared(value, e.bounds[k])
                if not good:
                    what += _smallest(target, unit.trees[k], e.point)
                found.judge(target, good, unit, k, e.point, what)
            else:
                found.left_out[target] += 1
            if exactly:
                same = np.array_equal(value, e.doubles[k], equal_nan=True)
                what = f"{value!r}, expected {e.doubles[k]!r} to the last bit"
                found.judge(f"{target}, to the last bit", same, unit, k, e.point, what)


def _correctly_rounded(tree: Tree) -> bool:
    return all(op in OPS and OPS[op].ulps <= 0.5 for op in tree.operations())


def _compared(value: float, bound: Bounded) -> tuple[bool, str]:
    """Return whether a number is within its bound, and say what was expected."""
    good = bool(abs(bound.value - mpmath.mpf(value)) <= bound.error)
    return good, f"{value!r}, exactly {float(bound.value)!r}, bound {float(bound.error):.2g}"


def _smallest(target: str, tree: Tree, point: Point) -> str:
    """Describe the smallest part of an expression that differs by itself."""
    for part in tree.parts():
        program = built([part])
        if any(refused(target, program)):
            continue
        expected = Expected.of(program, point, target)
        good, what = _compared(float(values(target, program, [point])[0, 0]), expected.bounds[0])
        if expected.sure[0] and not good:
            return f"\n  by itself: {part} = {what}"
    return ""


def _check_building(unit: Unit, expected: Sequence[Expected], found: Findings) -> None:
    """Compare folding, and lowering from SymPy, with the trees, in 50 digits."""
    m = context()
    lowered = [_lowered(tree) for tree in unit.trees]
    for e in expected:
        folded = interpret_exactly(unit.program, e.point)[RATES]
        for k, tree in enumerate(unit.trees):
            exact = tree.exact(m, e.point)
            if not e.sure[k] or not m.isfinite(exact):
                found.left_out["folding"] += 1
                continue
            slack = e.bounds[k].error * 2.0**-100 + SAME * (1 + abs(exact))
            what = f"{folded[k]}, exactly {exact}"
            found.judge("folding", abs(folded[k] - exact) <= slack, unit, k, e.point, what)
            program = lowered[k]
            if program is not None:
                at = replace(e.point, x=[*e.point.x, e.point.t])
                (other,) = interpret_exactly(program, at)[RATES]
                what = f"{other}, exactly {exact}"
                found.judge("lowering", abs(other - exact) <= slack, unit, k, e.point, what)


def _lowered(tree: Tree) -> Program | None:
    """Return the program of the tree as a SymPy expression; None where it is not written so."""
    if not tree.operations() <= {*SYMPY, "table"}:
        return None
    x = [sp.Symbol(f"x{k}", real=True) for k in range(STATES)]
    p = [sp.Symbol(f"p{k}", real=True) for k in range(PARAMETERS)]
    t = sp.Symbol("t", real=True)
    slots = {("state", k): s for k, s in enumerate(x)} | {
        ("parameter", k): s for k, s in enumerate(p)
    }
    slots |= {("time", None): t, ("pi", None): sp.pi}
    try:
        expression = _in_sympy(tree, slots)
        if expression.has(sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I):
            return None
        return lower_expressions({RATES: [expression]}, [*x, t], p)
    except (InputError, AttributeError, TypeError, ValueError, RecursionError):
        return None  # complex to SymPy, or not comparable, or too much for its Piecewise


def _in_sympy(tree: Tree, slots: dict[Any, Any]) -> Any:
    if isinstance(tree.leaf, Table):
        return tree.leaf(_in_sympy(tree.args[0], slots))
    if tree.op in OPS:
        return SYMPY[tree.op](*[_in_sympy(a, slots) for a in tree.args])
    if tree.op == "const":
        return sp.Rational(tree.leaf.numerator, tree.leaf.denominator)  # type: ignore[union-attr]
    return slots[tree.op, tree.leaf]


@click.command()
@click.option("--count", default=10_000, show_default=True, help="Number of expressions.")
@click.option("--seed", default=0, show_default=True)
@click.option("--only", type=int, help="Check the unit of this expression alone.")
def main(count: int, seed: int, only: int | None) -> None:
    """Compare every target on random expressions; exit with 1 where anything differs."""
    start = perf_counter()
    found = Findings()
    targets, others = targets_here()
    click.echo(f"targets: {', '.join(targets)}")
    for line in others:
        click.echo(f"not here: {line}")
    firsts = range(0, count, UNIT) if only is None else [only // UNIT * UNIT]
    for first in firsts:
        size = UNIT if only is not None else min(UNIT, count - first)
        check(Unit.of(seed, first, size), targets, found)
    for kind, number in sorted(found.compared.items()):
        click.echo(f"{kind}: {number} compared, {found.left_out[kind]} left out")
    for kind, number in sorted(found.refused.items()):
        click.echo(f"{kind}: refused, {number} expressions")
    one, *more = (digests_apart(s) for s in HASH_SEEDS)
    if any(other != one for other in more):
        found.different.append("texts differ between processes with different hash seeds")
    click.echo(f"generated texts: {len(one)}, in {len(HASH_SEEDS)} processes")
    for text in found.different:
        click.echo(text)
    click.echo(f"{len(found.different)} disagreements, {perf_counter() - start:.0f} s")
    sys.exit(1 if found.different else 0)


if __name__ == "__main__":
    main()
