"""Cut a program by binding time: what is known early is computed once and kept in an array.

Parameters are known before a run, time before a call, states and inputs in the call. A value that
depends on parameters alone belongs to the first stage, one that depends on time and parameters to
the second.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import lru_cache

from codegen.ir.ops import LEAVES, Instruction
from codegen.ir.passes import prune
from codegen.ir.program import BINDING, Builder, Program, bindings

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


def _cut(program: Program, leaf: str, moved: Collection[str]) -> Cut:
    """Cut at the binding of ``leaf``; leaves in ``moved`` go through the array, others stay."""
    known = bindings(program)
    level = BINDING[leaf]
    early = {
        k
        for k, (op, _, _) in enumerate(program.instructions)
        if 0 < known[k] <= level and (op in moved or op not in LEAVES)
    }
    used = {a for k, i in enumerate(program.instructions) if k not in early for a in i.args}
    used |= {k for results in program.results.values() for k in results}
    slots = {k: slot for slot, k in enumerate(sorted(early & used))}
    if not slots:
        return Cut(leaf, Program((), {leaf: ()}, rules=program.rules), program, ())
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
    late = prune(Program(tuple(instructions), results, names, program.rules))
    before = Program(program.instructions, {leaf: tuple(slots)}, program.names, program.rules)
    return Cut(leaf, prune(before), late, tuple(slots))
