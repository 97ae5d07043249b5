"""Powers of two wander from results to where they cost less: into factors that many terms share.

(a x + b y) / 2 and (c x - d y) / 2 become a x' + b y' and c x' - d y' with x' = x / 2, y' = y / 2,
as the halves of angular velocities in the rates of a quaternion. Multiplying by a power of two is
exact, so that values do not change but where they over- or underflow.
"""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from codegen.ir.ops import LEAVES
from codegen.ir.passes import prune
from codegen.ir.program import Builder, Program, bindings
from codegen.passes.gather import EARLY

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
