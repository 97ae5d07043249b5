"""The passes that every compiled program goes through, as a table, and how they are applied."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from codegen.chains import share_products, share_sums
from codegen.factoring import factor_sums
from codegen.fold import ALGEBRAIC, RULE_SETS
from codegen.layout import Layout
from codegen.lower import lower_system
from codegen.ops import OPS, Instruction
from codegen.passes import prune
from codegen.program import Name, Program, bindings
from codegen.schedule import schedule, without_unused
from codegen.strength import reduce_strength
from codegen.structure import Structure, fit
from eom.errors import unknown_name
from eom.system import System


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
WORTHWHILE = 0.98
"""Another round follows where one leaves at most this share of the cost."""

STRENGTH = Pass("strength reduced", reduce_strength, f"{REAL}, as `strength.REDUCTIONS` says")
ORDER = Pass("ordered for registers", schedule, "the same values bit for bit", exact=True)

PASSES = (*ROUND, STRENGTH, ORDER)
"""All passes, in their order."""


def steps(program: Program) -> Iterator[tuple[Pass, Program]]:
    """Apply the passes to a program that is one function; yield each that changed it.

    A result that costs more, altogether or in what varies with states, inputs and time, is
    dropped. Where the program's rules are exact, passes that are not are left out.
    """
    if program.rules is ALGEBRAIC:
        for _ in range(MAX_ROUNDS):
            before = program
            for p in ROUND:
                after = _cheaper(program, p)
                if after is not program:
                    program = after
                    yield p, program
            if program.cost() > WORTHWHILE * before.cost():
                break
        after = _cheaper(program, STRENGTH)
        if after is not program:
            program = after
            yield STRENGTH, program
    after = ORDER.run(program)
    if after is not program:
        yield ORDER, after


def _cheaper(program: Program, p: Pass) -> Program:
    result = p.run(program)
    if result is program:
        return program
    result = without_unused(result)
    before, after = costs(program), costs(result)
    better = after != before and all(a <= b for a, b in zip(after, before, strict=True))
    return result if better else program


def costs(program: Program) -> tuple[int, int]:
    """Return the cost, and the cost of what does not depend on constants and parameters alone."""
    both = [
        (OPS[i.op].cost, when > 1)
        for i, when in zip(program.instructions, bindings(program), strict=True)
        if i.op in OPS
    ]
    return sum(cost for cost, _ in both), sum(cost for cost, late in both if late)


def optimise(program: Program) -> Program:
    """Apply the passes to each group of results alone, since each becomes a function of its own.

    Law: results are equal in exact arithmetic, and the same bit for bit where the program's rules
    are exact; no group costs more than before.
    """
    return join({g: _optimised(prune(program, [g])) for g in program.results})


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
) -> tuple[Program, Layout]:
    """Return program and layout with what is fixed compiled in, as `compile` describes it."""
    return fitted(system, Structure.of(system, parameters, states, inputs))


def fitted(
    system: System, structure: Structure, rules: str = "algebraic"
) -> tuple[Program, Layout]:
    """Return the program that is compiled, and its layout.

    Raises `InputError` for an unknown set of rules.
    """
    if rules not in RULE_SETS:
        raise unknown_name("set of rules", rules, RULE_SETS)
    program, layout = fit(lower_system(system, RULE_SETS[rules]), system, structure)
    return optimise(program), layout
