"""Strength reduction: expensive operations by cheaper ones that have the same value.

Each row of `REDUCTIONS` says what it finds, its law with the rounding that it costs, and whether it
is applied unless asked for: a reduction that may lose more than a few units in the last place, or
that overflows where the original does not, is not.

Powers of two wander from results to where they cost less: into factors that many terms share.

(a x + b y) / 2 and (c x - d y) / 2 become a x' + b y' and c x' - d y' with x' = x / 2, y' = y / 2,
as the halves of angular velocities in the rates of a quaternion. Multiplying by a power of two is
exact, so that values do not change but where they over- or underflow.
"""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from codegen.ir.ops import LEAVES
from codegen.ir.passes import prune
from codegen.ir.program import Builder, Program, bindings
from codegen.passes.chains import Recipe, rebuild, uses
from codegen.passes.gather import EARLY

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


_ROUNDS = 8


def rescale(program: Program) -> Program:
    """Move multiplications by powers of two into operands where that leaves fewer.

    Law: equal in exact arithmetic, and in floating point barring overflow and underflow.
    """
    for _ in range(_ROUNDS):
        plan = _best(program)
        if plan is None:
            return program
        program = _rebuild(program, plan)
    return program


@dataclass(frozen=True)
class _Plan:
    """What is computed ``scale`` times as large: in place, or by one more multiplication."""

    scale: Fraction
    results: frozenset[int]
    """Products with a power of two that become signs at most."""
    inside: frozenset[int]
    explicit: frozenset[int]
    chosen: Mapping[int, int]
    """For a product that is scaled inside: position of the factor that is."""

    @property
    def gain(self) -> int:
        return len(self.results) - len(self.explicit)


def _best(program: Program) -> _Plan | None:
    view = _View.of(program)
    groups: dict[Fraction, list[int]] = {}
    for k, (op, args, _) in enumerate(program.instructions):
        numbers = [program.instructions[a] for a in args]
        for value in (i.value for i in numbers if op == "mul" and i.op == "const"):
            if _is_power(value) and view.binding[k] > EARLY:
                groups.setdefault(abs(_exact(value)), []).append(k)
    together = [view.plan(scale, tuple(found)) for scale, found in sorted(groups.items())]
    alone = [view.plan(s, (k,)) for s, found in sorted(groups.items()) for k in found]
    best = max([*together, *alone], key=lambda p: p.gain, default=None)
    return best if best is not None and best.gain > 0 else None


def _is_power(value: object) -> bool:
    size = abs(_exact(value))
    n = size.numerator * size.denominator
    return size != 1 and n > 0 and n & (n - 1) == 0


def _exact(value: object) -> Fraction:
    return value if isinstance(value, Fraction) else Fraction(0)


class _Downwards:
    """Numbers of values that are visited from the largest down, each once."""

    def __init__(self, first: Sequence[int]) -> None:
        self.first = frozenset(first)
        self.heap = [-k for k in first]
        heapq.heapify(self.heap)

    def __bool__(self) -> bool:
        return bool(self.heap)

    def pop(self) -> int:
        """Return the largest number, and forget it."""
        k = heapq.heappop(self.heap)
        while self.heap and self.heap[0] == k:
            heapq.heappop(self.heap)
        return -k

    def push(self, numbers: Sequence[int], wants: Counter[int]) -> None:
        """Add numbers, all smaller than those popped, and count that they are wanted."""
        wants.update(numbers)
        for k in numbers:
            heapq.heappush(self.heap, -k)


@dataclass(frozen=True)
class _View:
    program: Program
    uses: Counter[int]
    binding: Sequence[int]

    @classmethod
    def of(cls, program: Program) -> _View:
        uses = Counter(a for i in program.instructions for a in i.args)
        uses.update(k for r in program.results.values() for k in r)
        return cls(program, uses, bindings(program))

    def plan(self, scale: Fraction, results: tuple[int, ...]) -> _Plan:
        """Follow the scale from the products ``results`` down to where it has to be paid.

        Values are visited from the last one down, those that it reaches and no others, as long as
        less is paid than saved.
        """
        wants: Counter[int] = Counter()
        common = self._common(results)
        left, inside, explicit, chosen = set(), set(), set[int](), {}
        waiting = _Downwards(results)
        while waiting and len(explicit) < len(results):
            k = waiting.pop()
            op, args, _ = self.program.instructions[k]
            partly = wants[k] < self.uses[k]
            if k in waiting.first and partly:  # one that is wanted scaled alone keeps its number
                left.add(k)
                waiting.push((self._other(k),), wants)
            if not wants[k] or self.binding[k] <= EARLY:
                continue
            if partly or op not in {"add", "sub", "neg", "mul", "div"}:
                explicit.add(k)
                continue
            inside.add(k)
            if op == "mul":
                chosen[k] = self._factor(args, common)
            taken = (args[chosen[k]],) if op == "mul" else args[:1] if op == "div" else args
            waiting.push(taken, wants)
        return _Plan(scale, frozenset(left), frozenset(inside), frozenset(explicit), chosen)

    def _other(self, k: int) -> int:
        """The operand of a product with a number that is not the number."""
        a, c = self.program.instructions[k].args
        return c if self.program.instructions[a].op == "const" else a

    def _factor(self, args: Sequence[int], common: Counter[int]) -> int:
        """Choose the factor that takes the scale: one known early, or the one that is shared most."""
        if self.binding[args[0]] <= EARLY or self.binding[args[1]] <= EARLY:
            return int(self.binding[args[0]] > EARLY)
        first, second = (self._served(a, common) for a in args)
        return int(second > first)

    def _served(self, k: int, common: Counter[int]) -> int:
        """Return how many terms one scaled copy of a factor serves."""
        leaf = self.program.instructions[k].op in LEAVES
        return common[k] if leaf or common[k] == self.uses[k] else 0

    def _common(self, results: tuple[int, ...]) -> Counter[int]:
        """Count the factors of the terms of all sums below ``results``."""
        stack, seen, found = [self._other(k) for k in results], set(), Counter[int]()
        while stack:
            k = stack.pop()
            op, args, _ = self.program.instructions[k]
            if k in seen:
                continue
            seen.add(k)
            if op in {"add", "sub", "neg"}:
                stack += args
            elif op == "mul":
                found.update(args)
        return found


def _sign(b: Builder, program: Program, k: int, grown: Callable[[int], int]) -> int:
    """Return what is left of a product with plus or minus the scale."""
    a, c = program.instructions[k].args
    number, other = (a, c) if program.instructions[a].op == "const" else (c, a)
    value = grown(other)
    return value if _exact(program.instructions[number].value) > 0 else b.add("neg", value)


def _rebuild(program: Program, plan: _Plan) -> Program:
    b = Builder(program.rules)
    scale = b.const(plan.scale)
    new: list[int] = []
    scaled: dict[int, int] = {}

    def grown(k: int) -> int:
        return scaled[k] if k in scaled else b.add("mul", scale, new[k])

    for k, instruction in enumerate(program.instructions):
        op, args, _ = instruction
        if k in plan.inside:
            place = plan.chosen.get(k, 0)
            taken = {place} if op in {"mul", "div"} else set(range(len(args)))
            scaled[k] = b.add(op, *(grown(a) if n in taken else new[a] for n, a in enumerate(args)))
            new.append(-1)
            continue
        if k in plan.results:
            new.append(_sign(b, program, k, grown))
        else:
            new.append(b.again(instruction, new))
        if k in plan.explicit:
            scaled[k] = b.add("mul", scale, new[k])
        if k in program.names:
            b.name(new[k], program.names[k])
    return prune(b.program({g: [new[k] for k in r] for g, r in program.results.items()}))
