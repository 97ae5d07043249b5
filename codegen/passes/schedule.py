"""The order of instructions: the same ones, so that fewer values wait at a time."""

from __future__ import annotations

import heapq
from types import MappingProxyType

from codegen.ir.ops import OPS, Instruction
from codegen.ir.passes import needed
from codegen.ir.program import Program

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
