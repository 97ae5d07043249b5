"""Strength reduction: expensive operations by cheaper ones that have the same value.

Each row of `REDUCTIONS` says what it finds, its law with the rounding that it costs, and whether it
is applied unless asked for: a reduction that may lose more than a few units in the last place, or
that overflows where the original does not, is not.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from codegen.ir.program import Builder, Program
from codegen.passes.chains import Recipe, rebuild, uses

MIN_DIVISIONS = 3
"""Two divisions by one value are left alone: a reciprocal and two products save little for a rounding."""


@dataclass(frozen=True)
class Reduction:
    """``find``: other recipes for some of a program's values."""

    find: Callable[[Program], dict[int, Recipe]]
    law: str
    default: bool


def reduce_strength(program: Program, names: Iterable[str] | None = None) -> Program:
    """Return the program after the reductions ``names``, in their order (None: those by default).

    Law: that of each row of `REDUCTIONS`; the cost never rises.
    """
    chosen = [k for k, r in REDUCTIONS.items() if r.default] if names is None else names
    for name in chosen:
        recipes = REDUCTIONS[name].find(program)
        if recipes:
            reduced = rebuild(program, recipes)
            program = reduced if reduced.cost() <= program.cost() else program
    return program


def _reciprocals(program: Program) -> dict[int, Recipe]:
    divisors = Counter(i.args[1] for i in program.instructions if i.op == "div")

    def build(b: Builder, args: Sequence[int]) -> int:
        return b.add("mul", args[0], b.add("div", b.const(1), args[1]))

    return {
        k: Recipe(args, build)
        for k, (op, args, _) in enumerate(program.instructions)
        if op == "div" and divisors[args[1]] >= MIN_DIVISIONS
    }


def _of_argument(program: Program, op: str) -> dict[int, int]:
    """Return the values of ``op`` by the number of their argument."""
    return {i.args[0]: k for k, i in enumerate(program.instructions) if i.op == op}


def _multiple(program: Program, number: int) -> tuple[Fraction, int]:
    """Return c and x if a value is c x for a constant c, which is 1 otherwise."""
    factor = Fraction(1)
    while True:
        op, args, _ = program.instructions[number]
        if op == "add" and args[0] == args[1]:
            factor, number = 2 * factor, args[0]
            continue
        pairs = {"mul": (args, args[::-1]), "div": (args[::-1],)}.get(op, ())
        found = [(c, x) for c, x in pairs if program.instructions[c].op == "const"]
        value = program.instructions[found[0][0]].value if found else None
        if not isinstance(value, Fraction) or value == 0:
            return factor, number
        factor, number = (factor * value if op == "mul" else factor / value), found[0][1]


def _doubled(
    op: str, build: Callable[[Builder, Sequence[int]], int]
) -> Callable[..., dict[int, Recipe]]:
    """Find ``op`` of an argument whose half has both its sine and its cosine."""

    def find(program: Program) -> dict[int, Recipe]:
        sines, cosines = _of_argument(program, "sin"), _of_argument(program, "cos")
        halves = {_multiple(program, a): a for a in sines if a in cosines}
        found = {}
        for a, k in _of_argument(program, op).items():
            factor, x = _multiple(program, a)
            half = halves.get((factor / 2, x))
            if half is not None:
                found[k] = Recipe((sines[half], cosines[half]), build)
        return found

    return find


def _double_sine(b: Builder, args: Sequence[int]) -> int:
    return b.add("mul", b.const(2), b.add("mul", *args))


def _double_cosine(b: Builder, args: Sequence[int]) -> int:
    s, c = args
    return b.add("mul", b.add("sub", c, s), b.add("add", c, s))


def _tangents(program: Program) -> dict[int, Recipe]:
    sines, cosines = _of_argument(program, "sin"), _of_argument(program, "cos")
    return {
        k: Recipe((sines[a], cosines[a]), lambda b, args: b.add("div", *args))
        for a, k in _of_argument(program, "tan").items()
        if a in sines and a in cosines
    }


def _exponentials(program: Program) -> dict[int, Recipe]:
    counts = uses(program)

    def build(b: Builder, args: Sequence[int]) -> int:
        return b.add("exp", b.add("add", *args))

    found = {}
    for k, (op, args, _) in enumerate(program.instructions):
        powers = [program.instructions[a] for a in args if counts[a] == 1]
        if op == "mul" and len(powers) == 2 and all(p.op == "exp" for p in powers):
            found[k] = Recipe((powers[0].args[0], powers[1].args[0]), build)
    return found


REDUCTIONS: dict[str, Reduction] = {
    "reciprocal": Reduction(
        _reciprocals,
        "x / d = x (1 / d) where at least three divisions share d, 2^-1022 <= |d| <= 2^1022: "
        "at most 1 ulp more",
        default=True,
    ),
    "tangent": Reduction(
        _tangents, "tan x = sin x / cos x where both exist: a few ulps", default=True
    ),
    "sine of the double": Reduction(
        _doubled("sin", _double_sine),
        "sin 2x = 2 sin x cos x where both exist: a few ulps",
        default=True,
    ),
    "cosine of the double": Reduction(
        _doubled("cos", _double_cosine),
        "cos 2x = (cos x - sin x) (cos x + sin x) where both exist: a few ulps of 1, but any "
        "number of ulps of the value near its zeros",
        default=False,
    ),
    "exponentials": Reduction(
        _exponentials,
        "exp a exp b = exp(a + b) where nothing else needs the factors: |a + b| ulps more, and "
        "no overflow on the way",
        default=False,
    ),
}
