"""Sines and cosines of many angles, computed together before everything else.

A library computes one after the other, and each call empties the registers; side by side, compilers
compute several in one vector. Systems of many bodies have an angle a joint, all known from the start.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from codegen.ir.interpret import constants
from codegen.ir.ops import LEAVES, TURNED, Instruction
from codegen.ir.passes import prune
from codegen.ir.program import Name, Program

MANY_ANGLES = 4
"""Fewer angles are left to the library."""
BLOCK = 4
"""Angles are filled up with zeros to a multiple of so many."""
CIRCULAR = {"sin": 0, "cos": 1}
_EARLY = frozenset({*LEAVES, "add", "sub", "mul", "neg", "div"})
"""What angles are made of."""


@dataclass(frozen=True)
class Circles:
    """A program in two: ``angles``, and ``late``, which reads their sines and cosines.

    ``angles`` has one group of results, called `TURNED`. Leaf n of ``late`` is the sine of angle n, leaf
    ``room`` + n its cosine; ``names`` are those that the leaves had in the whole program.
    """

    angles: Program
    late: Program
    room: int
    names: tuple[Name, ...]


def circles(program: Program) -> Circles | None:
    """Return a program cut at the sines and cosines of its angles; None where there are few.

    Law: with the sines and cosines of the angles in its leaves, ``late`` gives the values of ``program``.
    """
    found = _found(program)
    angles = tuple(dict.fromkeys(program.instructions[k].args[0] for k in found))
    if len(angles) < MANY_ANGLES:
        return None
    room = -(-len(angles) // BLOCK) * BLOCK
    row = {angle: n for n, angle in enumerate(angles)}
    instructions = list(program.instructions)
    names = [Name("")] * (2 * room)
    for k in found:
        op, (angle,), _ = instructions[k]
        slot = CIRCULAR[op] * room + row[angle]
        instructions[k] = Instruction(TURNED, (), slot)
        names[slot] = program.names.get(k, names[slot])
    kept = {k: name for k, name in program.names.items() if k not in found}
    late = Program(tuple(instructions), program.results, MappingProxyType(kept), program.rules)
    early = Program(program.instructions, {TURNED: angles}, _NONE, program.rules)
    return Circles(prune(early), prune(late), room, tuple(names))


_NONE: Mapping[int, Name] = MappingProxyType({})


def _found(program: Program) -> dict[int, None]:
    """Return the sines and cosines of what is known from the start, in order."""
    known = constants(program)
    early: list[bool] = []
    found: dict[int, None] = {}
    for k, (op, args, _) in enumerate(program.instructions):
        early.append(op in _EARLY and all(early[a] for a in args))
        if op in CIRCULAR and k not in known and early[args[0]]:
            found[k] = None
    return found
