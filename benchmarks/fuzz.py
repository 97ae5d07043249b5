"""``python -m benchmarks.fuzz``: random expressions, every target against the 50-digit interpreter.

Each expression is compared in five ways at several points, some of them extreme: what folding leaves
against the tree as drawn, in 50 digits; what lowering makes of it as a SymPy expression, likewise; each
target's double against the running error bound, wherever the bound holds; to the last bit, NaN
included, where all operations are correctly rounded. Where something differs, the smallest part of
the expression that differs is printed. In the end the generated texts are compared between processes
with different hash seeds.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Any

import click
import numpy as np
import sympy as sp

from benchmarks.expressions import PARAMETERS, STATES, Tree, context, draw, points
from codegen.compiled import TARGETS
from codegen.interpret import Bounded, Point, interpret, interpret_exactly, interpret_with_bound
from codegen.layout import Layout
from codegen.lower import INVARIANTS, OUTPUTS, RATES, SINGULARITIES, lower_expressions
from codegen.ops import OPS
from codegen.pipeline import optimise
from codegen.program import Builder, Program
from eom.errors import InputError
from eom.system import Quantity
from tests.codegen.digests import HASH_SEEDS, digests_apart
from tests.codegen.test_compiled import reliable

UNIT = 100
"""Expressions that are compiled together."""
POINTS = 4
SAME = 1e-35

SYMPY: dict[str, Any] = {
    "add": sp.Add, "sub": lambda a, b: a - b, "mul": sp.Mul, "div": lambda a, b: a / b,
    "neg": lambda a: -a, "sqrt": sp.sqrt, "pow": sp.Pow, "abs": sp.Abs, "min": sp.Min, "max": sp.Max,
    **{op: getattr(sp, op) for op in ("sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh "
                                      "exp log atan2 sign").split()},
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


def layout(count: int) -> Layout:
    """Return the layout of a unit of ``count`` expressions."""
    x, p = (
        tuple(Quantity(sp.Symbol(f"{letter}{k}", real=True)) for k in range(n))
        for letter, n in (("x", STATES), ("p", PARAMETERS))
    )
    names = tuple(f"f{k}" for k in range(count))
    results = {RATES: names, OUTPUTS: (), INVARIANTS: (), SINGULARITIES: ()}
    return Layout("fuzz", "fuzz", x, p, (), results)


def targets_here() -> tuple[list[str], list[str]]:
    """Return the targets that work on this machine, and why the others do not."""
    working, others = [], []
    for target in sorted(set(TARGETS) - {"auto"}):
        try:
            TARGETS[target](built([Tree("time")]), layout(1))
            working.append(target)
        except (InputError, ImportError, OSError) as error:
            others.append(f"{target}: {error}".splitlines()[0])
    return working, others


def values(target: str, program: Program, at: Sequence[Point], count: int) -> Any:
    """Return the numbers of a target, in shape (expressions, points)."""
    _, functions, _ = TARGETS[target](program, layout(count))
    t = np.array([v.t for v in at])
    x, p = np.array([v.x for v in at]).T, np.array([v.p for v in at]).T
    return functions[RATES](t, x, p)


def check(unit: Unit, targets: Iterable[str], found: Findings) -> None:
    """Compare everything about a unit."""
    bounds = [interpret_with_bound(unit.program, point)[RATES] for point in unit.at]
    sure = [reliable(unit.program, point) for point in unit.at]
    _check_building(unit, bounds, sure, found)
    doubles = [interpret(unit.program, point)[RATES] for point in unit.at]
    numbers = unit.program.results[RATES]
    rounded = [_correctly_rounded(tree) for tree in unit.trees]
    for target in targets:
        got = values(target, unit.program, unit.at, len(unit.trees))
        for j, point in enumerate(unit.at):
            for k, number in enumerate(numbers):
                value, bound = float(got[k, j]), bounds[j][k]
                if sure[j][number]:
                    good = abs(bound.value - value) <= bound.error
                    what = f"{value!r}, exactly {float(bound.value)!r}, bound {bound.error:.2g}"
                    found.judge(
                        target, good, unit, k, point, _smallest(good, target, unit, k, j, what)
                    )
                else:
                    found.left_out[target] += 1
                if rounded[k]:
                    same = np.array_equal(value, doubles[j][k], equal_nan=True)
                    what = f"{value!r}, expected {doubles[j][k]!r} to the last bit"
                    found.judge(f"{target}, to the last bit", same, unit, k, point, what)


def _correctly_rounded(tree: Tree) -> bool:
    return all(OPS[op].ulps <= 0.5 for op in tree.operations())


def _smallest(good: bool, target: str, unit: Unit, k: int, j: int, what: str) -> str:
    """Add the smallest part of the expression that differs by itself."""
    if good:
        return what
    for part in unit.trees[k].parts():
        program = built([part])
        (bound,) = interpret_with_bound(program, unit.at[j])[RATES]
        value = float(values(target, program, [unit.at[j]], 1)[0, 0])
        if reliable(program, unit.at[j])[program.results[RATES][0]] and not (
            abs(bound.value - value) <= bound.error
        ):
            return f"{what}\n  by itself: {part} = {value!r}, exactly {float(bound.value)!r}"
    return what


def _check_building(
    unit: Unit, bounds: list[list[Bounded]], sure: list[list[bool]], found: Findings
) -> None:
    """Compare folding, and lowering from SymPy, with the trees, in 50 digits at points near the base."""
    m = context()
    lowered = [_lowered(tree) for tree in unit.trees]
    numbers = unit.program.results[RATES]
    for j, point in enumerate(unit.at[: POINTS // 2]):
        folded = interpret_exactly(unit.program, point)[RATES]
        for k, tree in enumerate(unit.trees):
            exact = tree.exact(m, point)
            if not sure[j][numbers[k]] or not m.isfinite(exact):
                found.left_out["folding"] += 1
                continue
            slack = bounds[j][k].error * 2.0**-100 + SAME * (1 + abs(exact))
            what = f"{folded[k]}, exactly {exact}"
            found.judge("folding", abs(folded[k] - exact) <= slack, unit, k, point, what)
            program = lowered[k]
            if program is not None:
                (other,) = interpret_exactly(program, replace(point, x=[*point.x, point.t]))[RATES]
                what = f"{other}, exactly {exact}"
                found.judge("lowering", abs(other - exact) <= slack, unit, k, point, what)


def _lowered(tree: Tree) -> Program | None:
    """Return the program of the tree as a SymPy expression; None where it is not written so."""
    if not tree.operations() <= set(SYMPY):
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
