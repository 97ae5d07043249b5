"""A value of a program as a short formula, for messages: names where there are names, bounded depth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from codegen.frontend.layout import Layout
from codegen.ir.ops import LEAVES, SOLVE, Instruction
from codegen.ir.program import Program

DEPTH = 4
"""Operations below one another that are written out; those of one short sum count as one."""
MAX_LENGTH = 80
"""Longer texts are written less deep."""
CUT = "..."


class _Infix(NamedTuple):
    """How an operator is written, how tightly it binds, and what its operands must bind."""

    text: str
    power: int
    needs: tuple[int, ...]


_ATOM = 100
_INFIX: Mapping[str, _Infix] = {
    "add": _Infix("{0} + {1}", 10, (10, 10)),
    "sub": _Infix("{0} - {1}", 10, (10, 11)),
    "mul": _Infix("{0}*{1}", 20, (20, 20)),
    "div": _Infix("{0}/{1}", 20, (20, 21)),
    "neg": _Infix("-{0}", 15, (20,)),
    "pow": _Infix("{0}**{1}", 30, (31, 30)),
    "lt": _Infix("{0} < {1}", 5, (6, 6)),
    "le": _Infix("{0} <= {1}", 5, (6, 6)),
    "eq": _Infix("{0} == {1}", 5, (6, 6)),
}


def formula(program: Program, number: int, layout: Layout, depth: int = DEPTH) -> str:
    """Return the value ``number`` written over named values and at most ``depth`` levels.

    What lies deeper and has no name is written as ``...``; the value itself is always written out.
    """
    tries = [(d, False) for d in range(depth, 1, -1)] + [(d, True) for d in range(depth, 0, -1)]
    texts = [_written(program, number, layout, *t)[0] for t in tries]
    short = next((text for text in texts if len(text) <= MAX_LENGTH), None)
    return texts[-1] if short is None else short


def _written(
    program: Program, number: int, layout: Layout, depth: int, counted: bool
) -> tuple[str, int]:
    """Return the text and how tightly it binds; ``counted``: additions of one sum count, too."""
    op, args, value = instruction = program.instructions[number]
    if op in LEAVES:
        return _leaf(instruction, layout)
    steps = [int(counted or not _same_sum(program, op, a)) for a in args]
    below = [
        _operand(program, a, layout, depth - step, counted)
        for a, step in zip(args, steps, strict=True)
    ]
    if op == "mul" and args[0] == args[1]:
        return f"{_bracketed(below[0], 31)}**2", 30
    infix = _INFIX.get(op)
    if op in SOLVE:
        return f"entry {value} of the solution of a linear system", _ATOM
    if infix is None:
        return f"{op}({', '.join(text for text, _ in below)})", _ATOM
    return infix.text.format(*_in_brackets(below, infix.needs)), infix.power


def _same_sum(program: Program, op: str, operand: int) -> bool:
    return {op, program.instructions[operand].op} <= {"add", "sub"}


def _operand(
    program: Program, number: int, layout: Layout, depth: int, counted: bool
) -> tuple[str, int]:
    name = program.names.get(number)
    if name is not None:
        return name.name, _ATOM
    if depth <= 0 and program.instructions[number].op not in LEAVES:
        return CUT, _ATOM
    return _written(program, number, layout, depth, counted)


def _in_brackets(operands: Sequence[tuple[str, int]], needs: Sequence[int]) -> list[str]:
    return [_bracketed(operand, need) for operand, need in zip(operands, needs, strict=True)]


def _bracketed(operand: tuple[str, int], need: int) -> str:
    text, power = operand
    return text if power >= need else f"({text})"


def _leaf(instruction: Instruction, layout: Layout) -> tuple[str, int]:
    op, _, value = instruction
    groups = {"state": layout.states, "parameter": layout.parameters, "input": layout.inputs}
    if op in groups:
        return groups[op][instruction.slot].name, _ATOM
    if op == "const":
        assert isinstance(value, Fraction)
        text = str(value) if len(str(value)) <= 12 else f"{float(value):.6g}"
        return text, 15 if text.startswith("-") else 20 if "/" in text else _ATOM
    return {"pi": "pi", "time": "t"}.get(op, op if value is None else f"{op}{value}"), _ATOM
