"""The passes that every compiled program goes through, as a table, and how they are applied.

Common factors of sums: a * b + a * c becomes a * (b + c), and a / d + b / d becomes (a + b) / d.

Cut a program by binding time: what is known early is computed once and kept in an array.

Parameters are known before a run, time before a call, states and inputs in the call. A value that
depends on parameters alone belongs to the first stage, one that depends on time and parameters to
the second.

The order of instructions: the same ones, so that fewer values wait at a time.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, reduce
from types import MappingProxyType
from typing import NamedTuple

from codegen.frontend.layout import Layout
from codegen.frontend.lower import lower_system, nodes
from codegen.frontend.structure import Structure, fit
from codegen.ir import compile_progress
from codegen.ir.fold import ALGEBRAIC, RULE_SETS
from codegen.ir.ops import LEAVES, OPS, Instruction, cost_of
from codegen.ir.passes import needed, prune, pruned
from codegen.ir.program import BINDING, Builder, Name, Program, bindings
from codegen.passes.chains import (
    SUMS,
    Recipe,
    add_terms,
    chains,
    inner,
    multiply,
    rebuild,
    share_products,
    share_sums,
)
from codegen.passes.gather import gather
from codegen.passes.stable import rewritten, rewritten_freely
from codegen.passes.strength import reduce_strength, rescale
from eom.errors import unknown_name
from eom.system import System

MAX_SHARE = 0.85
"""Pressure must fall at least to this share: a little less of it changes C code by luck alone."""
CALL_COST = 20
"""Operations of so many additions are calls of a library."""


def pressure(program: Program) -> int:
    """Return the largest number of values of operations that wait for a later use.

    Results wait until the end, since they are stored there; leaves stand in memory.
    """
    size = len(program.instructions)
    last = list(range(size))
    for k, instruction in enumerate(program.instructions):
        for a in instruction.args:
            last[a] = k
    for group in program.results.values():
        for k in group:
            last[k] = size
    ends = [0] * (size + 1)
    live = most = 0
    for k, instruction in enumerate(program.instructions):
        live -= ends[k]
        if instruction.op in OPS:
            live += 1
            ends[last[k]] += last[k] > k
            most = max(most, live)
            live -= last[k] == k
    return most


def schedule(program: Program) -> Program:
    """Return the program in an order of much less pressure, or as it is.

    Law: the same instructions in another valid order; values are the same bit for bit. Functions
    of a library come first with what they need, because a call leaves no value in a register;
    then, of the instructions whose operands are there, always one that ends the waiting of most
    values, the earliest of these (greedy list scheduling).
    """
    other = reordered(program, _Scheduler(program).order())
    return other if pressure(other) <= MAX_SHARE * pressure(program) else program


class _Scheduler:
    """What each instruction waits for, and how many uses of each value are still to come."""

    def __init__(self, program: Program) -> None:
        self.program = program
        size = len(program.instructions)
        self.operands = [tuple(dict.fromkeys(i.args)) for i in program.instructions]
        self.users: list[list[int]] = [[] for _ in range(size)]
        for k, operands in enumerate(self.operands):
            for a in operands:
                self.users[a].append(k)
        self.uses = [len(users) for users in self.users]
        for group in program.results.values():
            for k in group:
                self.uses[k] += 1
        self.waiting = [len(operands) for operands in self.operands]
        self.ready: list[tuple[int, int]] = []
        self.done = [False] * size

    def order(self) -> list[int]:
        """Return the numbers of the instructions in their new order."""
        instructions = self.program.instructions
        first = self._before_calls()
        order = [k for k, i in enumerate(instructions) if i.op not in OPS or k in first]
        for k in order:
            self._finish(k)
        while self.ready:
            growth, k = heapq.heappop(self.ready)
            if self.done[k]:
                continue
            if growth != self._growth(k):
                heapq.heappush(self.ready, (self._growth(k), k))
                continue
            order.append(k)
            self._finish(k)
        return order

    def _before_calls(self) -> set[int]:
        """Return the functions of a library and all that they need."""
        instructions = self.program.instructions
        found: set[int] = set()
        for k in range(len(instructions) - 1, -1, -1):
            op = instructions[k].op
            if k in found or (op in OPS and OPS[op].cost >= CALL_COST):
                found.add(k)
                found.update(self.operands[k])
        return found

    def _growth(self, k: int) -> int:
        """Return by how much more values wait after an instruction than before it."""
        instructions = self.program.instructions
        return 1 - sum(self.uses[a] == 1 and instructions[a].op in OPS for a in self.operands[k])

    def _finish(self, k: int) -> None:
        """Mark an instruction as done; those whose turn may have come get (another) place in line."""
        self.done[k] = True
        for a in self.operands[k]:
            self.uses[a] -= 1
            if self.uses[a] == 1:
                for user in self.users[a]:
                    self._queue(user)
        for user in self.users[k]:
            self.waiting[user] -= 1
            self._queue(user)

    def _queue(self, k: int) -> None:
        if not self.done[k] and not self.waiting[k]:
            heapq.heappush(self.ready, (self._growth(k), k))


def without_unused(program: Program) -> Program:
    """Return the program without what no result needs; unlike `passes.prune` it folds nothing."""
    order = sorted(needed(program, program.results))
    return program if len(order) == len(program.instructions) else reordered(program, order)


def reordered(program: Program, order: list[int]) -> Program:
    """Return the program with the instructions of ``order``, each after its operands."""
    new = {k: n for n, k in enumerate(order)}
    instructions = tuple(
        Instruction(op, tuple(new[a] for a in args), value)
        for op, args, value in (program.instructions[k] for k in order)
    )
    return Program(
        instructions,
        MappingProxyType({g: tuple(new[k] for k in r) for g, r in program.results.items()}),
        MappingProxyType({new[k]: n for k, n in program.names.items() if k in new}),
        program.rules,
    )


CONSTANT, CLOCK = "constant", "clock"
"""Leaves of a later stage: slots of the array that an earlier one fills."""


@dataclass(frozen=True)
class Cut:
    """A program in two: ``early`` fills an array, ``late`` reads it through leaves ``leaf``.

    ``early`` has one group of results, called ``leaf``. ``values``: for each slot the number that
    its value had in the whole program.
    """

    leaf: str
    early: Program
    late: Program
    values: tuple[int, ...]


def by_parameters(program: Program, groups: Iterable[str] | None = None) -> Cut:
    """Cut off what depends on parameters alone; the later stage reads no parameter.

    Law: in exact arithmetic and in floating point, ``late`` after ``early`` gives the values of
    ``program``. Only what ``groups`` of results (all if None) need is kept.
    """
    return _without_parameters(program, None if groups is None else tuple(groups))


@lru_cache(maxsize=16)
def _without_parameters(program: Program, groups: tuple[str, ...] | None) -> Cut:
    return _cut(prune(program, groups), CONSTANT, {"parameter"})


def by_time(program: Program) -> Cut:
    """Cut off what depends on time and earlier stages alone, time itself left where it is.

    The law is that of `by_parameters`.
    """
    return _cut(program, CLOCK, ())


def reciprocals(program: Program) -> Program:
    """Divide by numbers and by values of parameters by multiplying with a reciprocal, made once.

    Law: equal in exact arithmetic; a second rounding adds half a unit in the last place.
    """
    known = bindings(program)
    early = BINDING[CONSTANT]
    b = Builder(program.rules)
    new: list[int] = []
    for k, (op, args, _) in enumerate(program.instructions):
        if op == "div" and known[args[0]] > early >= known[args[1]]:
            new.append(b.add("mul", new[args[0]], b.add("div", b.const(1), new[args[1]])))
        else:
            new.append(b.again(program.instructions[k], new))
        if k in program.names:
            b.name(new[k], program.names[k])
    return prune(b.program({g: [new[k] for k in r] for g, r in program.results.items()}))


def _uncut(program: Program, leaf: str) -> Cut:
    return Cut(leaf, Program((), {leaf: ()}, rules=program.rules), program, ())


def _cut(program: Program, leaf: str, moved: Collection[str]) -> Cut:
    """Cut at the binding of ``leaf``; leaves in ``moved`` go through the array, others stay."""
    known = bindings(program)
    level = BINDING[leaf]
    early = {
        k
        for k, (op, _, _) in enumerate(program.instructions)
        if 0 < known[k] <= level and (op in moved or op not in LEAVES)
    }
    if not early:
        return _uncut(program, leaf)
    used = {a for k, i in enumerate(program.instructions) if k not in early for a in i.args}
    used |= {k for results in program.results.values() for k in results}
    slots = {k: slot for slot, k in enumerate(sorted(early & used))}
    if not slots:
        return _uncut(program, leaf)
    instructions: list[Instruction] = []
    new: dict[int, int] = {}
    for k, (op, args, value) in enumerate(program.instructions):
        if k in slots:
            made = Instruction(leaf, (), slots[k])
        elif k not in early:
            made = Instruction(op, tuple([new[a] for a in args]), value)
        else:
            continue
        new[k] = len(instructions)
        instructions.append(made)
    results = {g: tuple(new[k] for k in r) for g, r in program.results.items()}
    names = {new[k]: name for k, name in program.names.items() if k in new and k not in slots}
    late = pruned(instructions, results, names, program.rules)
    early_results = {leaf: tuple(slots)}
    before = pruned(program.instructions, early_results, program.names, program.rules)
    return Cut(leaf, before, late, tuple(slots))


Factor = tuple[int, int]
"""Number of a value, and its exponent: 1 or -1."""


class Product(NamedTuple):
    """A term of a sum: ``sign`` times the product of ``factors``; ``number`` if that exists."""

    sign: int
    factors: tuple[Factor, ...]
    number: int | None = None


def factor_sums(program: Program) -> Program:
    """Return the program with common factors taken out of sums.

    Law: equal in exact arithmetic; values change by rounding, relative to the largest term of a
    sum. In each sum the factor that saves most is taken out again and again, from the products
    and quotients that serve this sum alone (greedy; ties go to what is known last, so that the
    rest is known early, then to the earliest value).
    """
    search = _Search(program)
    for root, terms in chains(program, SUMS).items():
        products = [search.product(k, sign) for k, sign in terms]
        reduced = search.reduce(products)
        if reduced is not None:
            search.sums[root] = reduced
    if not search.sums:
        return program
    return rebuild(program, {k: _recipe(terms) for k, terms in search.sums.items()})


class _Search:
    """Sums with their terms taken apart; those that came out of brackets are numbered on."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.inside = inner(program, ("mul", "div", "add", "sub"))
        self.binding = bindings(program)
        self.sums: dict[int, list[Product]] = {}
        self.next = len(program.instructions)

    def product(self, root: int, sign: int) -> Product:
        """Take a term apart, through products and quotients that serve it alone."""
        factors: list[Factor] = []
        stack: list[Factor] = [(root, 1)]
        while stack:
            k, exponent = stack.pop()
            op, args, value = self.program.instructions[k]
            if op in {"mul", "div"} and exponent == 1 and k in self.inside:
                stack += [(args[1], -1 if op == "div" else 1), (args[0], 1)]
            elif op == "const" and isinstance(value, Fraction) and value == 1 and exponent == 1:
                continue
            else:
                factors.append((k, exponent))
        return Product(sign, tuple(factors), root)

    def reduce(self, products: list[Product]) -> list[Product] | None:
        """Take common factors out of a sum; None if there are none."""
        terms: dict[int, Product] = dict(enumerate(products))
        holders: dict[Factor, set[int]] = {}
        for n, product in terms.items():
            for f in self._saving(product):
                holders.setdefault(f, set()).add(n)
        heap = [self._rank(f, n) for f, n in holders.items() if len(n) > 1]
        heapq.heapify(heap)
        changed = False
        while heap:
            rank = heapq.heappop(heap)
            factor = rank[2:]
            now = holders[factor]
            if len(now) > 1 and rank != self._rank(factor, now):
                heapq.heappush(heap, self._rank(factor, now))
            elif len(now) > 1:
                self._take_out(factor, sorted(now), terms, holders)
                changed = True
        return list(terms.values()) if changed else None

    @staticmethod
    def _saving(product: Product) -> set[Factor]:
        """Return the factors without which a term needs an operation less: not d of d / a."""
        above = sum(exponent > 0 for _, exponent in product.factors)
        return {f for f in product.factors if f[1] < 0 or above > 1}

    def _rank(self, factor: Factor, holders: set[int]) -> tuple[int, int, int, int]:
        number, exponent = factor
        saved = (len(holders) - 1) * OPS["mul" if exponent > 0 else "div"].cost
        known = self.binding[number] if number < len(self.binding) else 3
        return (-saved, -known, number, exponent)

    def _take_out(
        self,
        factor: Factor,
        group: Sequence[int],
        terms: dict[int, Product],
        holders: dict[Factor, set[int]],
    ) -> None:
        rest = []
        for n in group:
            sign, factors, _ = terms[n]
            for f in factors:
                holders.get(f, set()).discard(n)
            at = factors.index(factor)
            rest.append(Product(sign, factors[:at] + factors[at + 1 :]))
            if n != group[0]:
                del terms[n]
        bracket = self.next
        self.next += 1
        self.sums[bracket] = self.reduce(rest) or rest
        terms[group[0]] = Product(1, (factor, (bracket, 1)))


def _recipe(terms: Sequence[Product]) -> Recipe:
    """Build the sum of ``terms`` from all their factors, or from the terms that exist."""
    parts = [((t.number, 1),) if t.number is not None else t.factors for t in terms]

    def build(b: Builder, new: Sequence[int]) -> int:
        numbers = iter(new)
        built = [
            (_product(b, [(next(numbers), e) for _, e in part]), t.sign)
            for t, part in zip(terms, parts, strict=True)
        ]
        return add_terms(b, built)

    return Recipe(tuple(k for part in parts for k, _ in part), build)


def _product(b: Builder, factors: Sequence[Factor]) -> int:
    above = [f for f in factors if f[1] > 0] or [(b.const(1), 1)]
    below = [k for k, exponent in factors if exponent < 0]
    return reduce(lambda x, y: b.add("div", x, y), below, multiply(b, above))


@dataclass(frozen=True)
class Pass:
    """A pass with its name in reports and its law."""

    name: str
    run: Callable[[Program], Program]
    law: str
    exact: bool = False
    """Whether results stay the same bit for bit, for NaN and infinities too."""


REAL = "equal in exact arithmetic, up to rounding in double precision"

ROUND = (
    Pass("partial products shared", share_products, REAL),
    Pass("common factors taken out", factor_sums, REAL),
    Pass("partial sums shared", share_sums, REAL),
)
"""Each of these makes work for the others: they are repeated while the cost falls."""

MAX_ROUNDS = 4
WORTHWHILE = 0.95
"""Another round follows where one leaves at most this share of the cost."""

INVERT = Pass("divisors known early inverted once", reciprocals, f"{REAL}: one more rounding")
GATHER = Pass("early factors gathered", gather, REAL)
"""What these two add is computed once, with the parameters; each call does less."""

STRENGTH = Pass("strength reduced", reduce_strength, f"{REAL}, as `strength.REDUCTIONS` says")
SCALES = Pass("powers of two moved", rescale, "the same values but for overflow and underflow")
ORDER = Pass("ordered for registers", schedule, "the same values bit for bit", exact=True)

PASSES = (INVERT, GATHER, *ROUND, STRENGTH, SCALES, ORDER)
"""All passes; early factors are gathered once more before the scales."""
BEFORE, AFTER = (INVERT, GATHER), (STRENGTH, GATHER, SCALES)
MOST_PASSES = len(BEFORE) + MAX_ROUNDS * len(ROUND) + len(AFTER)
"""Applied to one group of results at most, the order left out."""


def steps(program: Program) -> Iterator[tuple[Pass, Program]]:
    """Apply the passes to a program that is one function; yield each that changed it.

    A result that costs more in what varies with states, inputs and time is dropped. Where the
    program's rules are exact, passes that are not are left out.
    """
    if program.rules is ALGEBRAIC:
        size = len(program.instructions)
        program = yield from _applied(program, BEFORE, size)
        for left in reversed(range(MAX_ROUNDS)):
            before = program
            program = yield from _applied(program, ROUND, size)
            if program.cost() > WORTHWHILE * before.cost():
                compile_progress.done(size * len(ROUND) * left)
                break
        program = yield from _applied(program, AFTER, size)
    after = ORDER.run(program)
    if after is not program:
        yield ORDER, after


def _applied(
    program: Program, passes: Iterable[Pass], size: int
) -> Generator[tuple[Pass, Program], None, Program]:
    """Apply passes; yield each that made the program cheaper, and return the last program.

    ``size``: units of work that one is said to be.
    """
    for p in passes:
        after = _cheaper(program, p)
        compile_progress.done(size)
        if after is not program:
            program = after
            yield p, program
    return program


def _cheaper(program: Program, p: Pass) -> Program:
    result = p.run(program)
    if result is program:
        return program
    result = without_unused(result)
    return result if costs(result) < costs(program) else program


@lru_cache(maxsize=16)
def costs(program: Program) -> tuple[int, int]:
    """Return the cost of what does not depend on constants and parameters alone, and of all."""
    known = bindings(program)
    late = (cost_of(i) for i, when in zip(program.instructions, known, strict=True) if when > 1)
    return sum(late), program.cost()


def optimise(program: Program) -> Program:
    """Apply the passes to each group of results alone, since each becomes a function of its own.

    Law: results are equal in exact arithmetic, and the same bit for bit where the program's rules
    are exact; no group costs more than before.
    """
    parts = {g: prune(program, [g]) for g in program.results}
    work = MOST_PASSES * sum(len(part.instructions) for part in parts.values())
    with compile_progress.stage("passes", lambda: work):
        return join({g: _optimised(part) for g, part in parts.items()})


def _optimised(program: Program) -> Program:
    for _, cheaper in steps(program):
        program = cheaper
    return program


def join(programs: Mapping[str, Program]) -> Program:
    """Return one program with the results of several; nothing is folded, equal values are one."""
    numbers: dict[Instruction, int] = {}
    names: dict[int, Name] = {}
    results: dict[str, tuple[int, ...]] = {}
    for program in programs.values():
        new: list[int] = []
        for k, (op, args, value) in enumerate(program.instructions):
            instruction = Instruction(op, tuple(new[a] for a in args), value)
            new.append(numbers.setdefault(instruction, len(numbers)))
            if k in program.names:
                names.setdefault(new[k], program.names[k])
        results |= {g: tuple(new[k] for k in r) for g, r in program.results.items()}
    (rules,) = {p.rules for p in programs.values()}
    return Program(tuple(numbers), MappingProxyType(results), MappingProxyType(names), rules)


def specialised(
    system: System,
    parameters: Mapping[str, float | str] | None = None,
    states: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
    *,
    stable: bool = False,
) -> tuple[Program, Layout]:
    """Return program and layout with what is fixed compiled in, as `compile` describes it."""
    return fitted(system, Structure.of(system, parameters, states, inputs), stable=stable)


def fitted(
    system: System, structure: Structure, rules: str = "algebraic", stable: bool = False
) -> tuple[Program, Layout]:
    """Return the program that is compiled, and its layout.

    Raises `InputError` for an unknown set of rules.
    """
    program, layout = as_written(system, structure, rules)
    return optimise(formed(program, stable)), layout


def as_written(
    system: System, structure: Structure, rules: str = "algebraic"
) -> tuple[Program, Layout]:
    """Return the program before any pass, with what is fixed compiled in, and its layout.

    Raises `InputError` for an unknown set of rules.
    """
    if rules not in RULE_SETS:
        raise unknown_name("set of rules", rules, RULE_SETS)
    with compile_progress.stage("lowering", lambda: nodes(system)):
        return fit(lower_system(system, RULE_SETS[rules]), system, structure)


def formed(program: Program, stable: bool) -> Program:
    """Return the program in forms that keep digits: all of them if ``stable``, else what is free.

    Where the program's rules are exact, it stays as it is.
    """
    if program.rules is not ALGEBRAIC:
        return program
    with compile_progress.stage("stable forms", lambda: len(program.instructions)):
        return (rewritten if stable else rewritten_freely)(program).program
