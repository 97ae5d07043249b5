"""The passes that every compiled program goes through, as a table, and how they are applied."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from codegen.chains import share_products, share_sums
from codegen.factoring import factor_sums
from codegen.ops import OPS, Instruction
from codegen.passes import prune
from codegen.program import Name, Program, bindings
from codegen.strength import reduce_strength


@dataclass(frozen=True)
class Pass:
    """A pass with its name in reports and its law."""

    name: str
    run: Callable[[Program], Program]
    law: str


ROUND = (
    Pass("partial products shared", share_products, "equal in exact arithmetic"),
    Pass("common factors taken out", factor_sums, "equal in exact arithmetic"),
    Pass("partial sums shared", share_sums, "equal in exact arithmetic"),
)
"""Each of these makes work for the others: they are repeated while the cost falls."""

MAX_ROUNDS = 4

LAST = (
    Pass(
        "strength reduced",
        reduce_strength,
        "equal in exact arithmetic; the rounding of each reduction is in its table",
    ),
)


def steps(program: Program) -> Iterator[tuple[str, Program]]:
    """Apply the passes to a program that is one function; yield each that made it cheaper.

    A result that costs more, altogether or in what varies with states, inputs and time, is
    dropped.
    """
    for _ in range(MAX_ROUNDS):
        before = program
        for p in ROUND:
            after = _cheaper(program, p)
            if after is not program:
                program = after
                yield p.name, program
        if program is before:
            break
    for p in LAST:
        after = _cheaper(program, p)
        if after is not program:
            program = after
            yield p.name, program


def _cheaper(program: Program, p: Pass) -> Program:
    result = p.run(program)
    if result is program:
        return program
    result = prune(result)
    before, after = costs(program), costs(result)
    better = after != before and all(a <= b for a, b in zip(after, before, strict=True))
    return result if better else program


def costs(program: Program) -> tuple[int, int]:
    """Return the cost, and the cost of what does not depend on constants and parameters alone."""
    known = bindings(program)
    late = (
        OPS[i.op].cost
        for i, when in zip(program.instructions, known, strict=True)
        if when > 1 and i.op in OPS
    )
    return program.cost(), sum(late)


def optimise(program: Program) -> Program:
    """Apply the passes to each group of results alone, since each becomes a function of its own.

    Law: results are equal in exact arithmetic; no group costs more than before.
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
    return Program(tuple(numbers), MappingProxyType(results), MappingProxyType(names))
