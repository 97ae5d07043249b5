"""What targets share: a program becomes assignments whose right-hand sides are small expressions.

A value that is used once and has no name is written where it is used, as long as the line stays
short; everything else is assigned to a variable. The order of operations never changes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import NamedTuple

from codegen.frontend.layout import Layout
from codegen.ir import compile_progress
from codegen.ir.interpret import constants
from codegen.ir.linsolve import Shape
from codegen.ir.names import HELPERS, comment, identifiers
from codegen.ir.ops import BLOCKS, OPS, Instruction
from codegen.ir.program import Name, Program
from codegen.passes.pipeline import Cut
from eom.quantities import Quantity
from eom.tables import Table

MAX_INLINE = 72
MAX_READS = 2
"""Processors take one operand from memory for nothing; more reads than this are a load of their own."""
EVERY_NUMBER = "number"
ATOM = 100
_COMMUTATIVE = frozenset(name for name, row in OPS.items() if row.commutative)


class Template(NamedTuple):
    """How an operation is written.

    ``text``: format string over the operands, and the name of the ``data`` of the operation if it has
    some. ``power``: how tightly the result binds. ``needs``:
    how tightly each operand must bind so as not to be put in brackets.
    """

    text: str
    power: int = ATOM
    needs: tuple[int, ...] = ()


class Line(NamedTuple):
    """An assignment: variable, expression, comment.

    ``room``: not 0 for an array of so many numbers, whose ``expression`` is the whole statement.
    """

    variable: str
    expression: str
    comment: str = ""
    room: int = 0


@dataclass(frozen=True)
class Body:
    """The inside of a function: lines in order, then one expression a result."""

    lines: tuple[Line, ...]
    results: tuple[str, ...]


class Part(NamedTuple):
    """Some lines of a body, with what they load from earlier parts and store for later ones.

    ``loads``, ``stores``: lines whose variables are carried from part to part, with their slots.
    """

    lines: tuple[Line, ...]
    loads: tuple[tuple[Line, int], ...]
    stores: tuple[tuple[Line, int], ...]


_WORD = re.compile(r"[A-Za-z_]\w*")


def split(body: Body, most: int) -> tuple[list[Part], int]:
    """Return the lines in parts of at most ``most``, and the length of the array carried along.

    The results belong to the last part.
    """
    groups = [body.lines[k : k + most] for k in range(0, len(body.lines), most)]
    home = {line.variable: (k, line) for k, lines in enumerate(groups) for line in lines}
    needed: list[list[Line]] = []
    for k, lines in enumerate(groups):
        texts = [line.expression for line in lines]
        texts += body.results if k == len(groups) - 1 else ()
        words = dict.fromkeys(w for text in texts for w in _WORD.findall(text))
        needed.append([home[w][1] for w in words if w in home and home[w][0] < k])
    slots: dict[str, int] = {}
    room = 0
    for line in (line for lines in needed for line in lines):
        if line.variable not in slots:
            slots[line.variable] = room
            room += max(1, line.room)
    parts = [
        Part(
            lines,
            tuple((line, slots[line.variable]) for line in needed[k]),
            tuple((line, slots[line.variable]) for line in lines if line.variable in slots),
        )
        for k, lines in enumerate(groups)
    ]
    return parts, max(1, room)


def infix(symbol: str, power: int) -> Template:
    """Return the template of a binary operator that groups to the left."""
    return Template(f"{{0}} {symbol} {{1}}", power, (power, power + 1))


def call(name: str, arity: int = 1) -> Template:
    """Return the template of a function call."""
    return Template(f"{name}({', '.join(f'{{{k}}}' for k in range(arity))})")


def calls(name: str, operations: str) -> dict[str, Template]:
    """Return templates of function calls, by operation; ``{}`` in ``name`` stands for it."""
    return {op: call(name.format(op), OPS[op].arity) for op in operations.split()}


ARITHMETIC = {
    "add": infix("+", 10),
    "sub": infix("-", 10),
    "mul": infix("*", 20),
    "div": infix("/", 20),
    "neg": Template("-{0}", 15, (20,)),
}
"""What most languages write alike."""


Names = Mapping[str, Sequence[Name]]
"""What the slots of each kind of leaf are called; an empty name leaves the slot without a variable."""


def leaf_names(layout: Layout) -> Names:
    """Return the names of states, parameters and inputs."""
    return {
        "state": [_name(q) for q in layout.states],
        "parameter": [_name(q) for q in layout.parameters],
        "input": [_name(q) for q in layout.inputs],
    }


def with_slots_of(cut: Cut, program: Program, names: Names) -> Names:
    """Return ``names`` and those of the slots of ``cut``, which was made from ``program``."""
    slots = []
    for k in cut.values:
        op, _, value = program.instructions[k]
        listed = names.get(op, ())
        known = listed[value] if listed and isinstance(value, int) else None
        slots.append(known or program.names.get(k, Name("")))
    return {**names, cut.leaf: slots}


def _name(quantity: Quantity) -> Name:
    return Name(quantity.name, quantity.description)


def render(
    program: Program,
    group: str,
    names: Names,
    templates: Mapping[str, Template],
    slots: Mapping[str, str],
    number: Mapping[str, str] = {},
    data: Mapping[Table, str] = {},
) -> Body:
    """Render one group of results of a pruned program.

    ``slots``: how a slot of each kind of leaf is read, for example ``"x[{0}]"``. ``number``: how
    special numbers are written (``inf``, ``-inf``, ``nan``), and under `EVERY_NUMBER` a format string
    for whatever is written in its place. ``data``: names of the tables, as
    `table_names` gives them.
    """
    return _Renderer(program, group, names, templates, slots, number, data).body()


Tables = Mapping[Table, str]


def table_names(*programs: Program) -> Tables:
    """Return a name for each table of some programs, in order; no variable is called like it."""
    tables = [i.value for p in programs for i in p.instructions if isinstance(i.value, Table)]
    return {table: f"table_{k}_" for k, table in enumerate(dict.fromkeys(tables), 1)}


class _Renderer:
    def __init__(
        self,
        program: Program,
        group: str,
        names: Names,
        templates: Mapping[str, Template],
        slots: Mapping[str, str],
        number: Mapping[str, str],
        data: Mapping[Table, str],
    ) -> None:
        self.data = data
        self.program = program
        self.group = group
        self.templates = templates
        self.slots = slots
        self.special = number
        self.constants = constants(program)
        self.uses = self._count_uses()
        self.variables = self._name_variables(names)
        self.text: dict[int, tuple[str, int]] = {}
        self.lines: list[Line] = []
        self.temporaries = 0

    def _count_uses(self) -> list[int]:
        uses = [0] * len(self.program.instructions)
        for k, instruction in enumerate(self.program.instructions):
            if k not in self.constants:
                for a in instruction.args:
                    uses[a] += 1
        for k in self.program.results[self.group]:
            uses[k] += 1
        return uses

    def _name_variables(self, names: Names) -> dict[int, Line]:
        """Variables of the leaves that are read and of the values that have a name."""
        wanted: list[tuple[int, str, str, str]] = []
        for k, (op, _, value) in enumerate(self.program.instructions):
            if op in names and isinstance(value, int) and names[op][value].name:
                name, note = names[op][value]
                wanted.append((k, name, self.slots[op].format(value), note))
        wanted += [
            (k, n.name, "", n.comment)
            for k, n in sorted(self.program.names.items())
            if k not in self.constants and self.program.instructions[k].op in OPS
        ]
        spelt = identifiers((name for _, name, _, _ in wanted), HELPERS)
        return {k: Line(s, e, comment(c)) for (k, _, e, c), s in zip(wanted, spelt, strict=True)}

    def body(self) -> Body:
        for k, instruction in enumerate(self.program.instructions):
            compile_progress.done(1)
            if k in self.constants:
                self.text[k] = self._number(self.constants[k])
            elif instruction.op in OPS:
                self._operation(k, instruction)
            elif instruction.op == "time":
                self.text[k] = (self.slots["time"], ATOM)
            elif k in self.variables:
                self._assign(k, self.variables[k].expression)
            else:
                self._read(k)
        results = tuple(self.text[k][0] for k in self.program.results[self.group])
        return Body(tuple(self.lines), results)

    def _number(self, value: float) -> tuple[str, int]:
        text = self.special.get(repr(value), repr(value))
        if EVERY_NUMBER in self.special:
            return (self.special[EVERY_NUMBER].format(text), ATOM)
        return (text, ATOM) if value >= 0 or text != repr(value) else (f"({text})", ATOM)

    def _operation(self, k: int, instruction: Instruction) -> None:
        op, args, data = instruction
        if op in BLOCKS:
            self._block(k)
            return
        form, power, needs = self.templates[op]
        if op in _COMMUTATIVE and _binds_less(needs, self.text[args[0]][1], self.text[args[1]][1]):
            args = args[::-1]  # b * c * a for a * (b * c), the same to the last bit
        operands = map(self._operand, args, needs or repeat(0))
        name = self.data[data] if isinstance(data, Table) else data
        self._write(k, form.format(*operands, data=name), power)

    def _block(self, k: int) -> None:
        """Write the statement of a factorisation or a solution, which is an array."""
        op, args, shape = self.program.instructions[k]
        given = args if isinstance(shape, Shape) else args[1:]
        if not isinstance(shape, Shape):
            shape = self.program.instructions[args[0]].value
        assert isinstance(shape, Shape)
        n = shape.size
        room = 1 + n + n * n if op == "factor" else n
        self.temporaries += 1
        variable = f"v{self.temporaries}_"
        text = self.templates[op].text.format(
            v=variable, n=n, room=room, symmetric=int(shape.symmetric), factor=self.text[args[0]][0],
            entries=", ".join(self._operand(a, 0) for a in given),
        )  # fmt: skip
        self.lines.append(Line(variable, text, "", room))
        self.text[k] = (variable, ATOM)

    def _operand(self, k: int, need: int) -> str:
        text, power = self.text[k]
        return text if power >= need else f"({text})"

    def _read(self, k: int) -> None:
        """Read a slot without a name where it is used; more than `MAX_READS` times, keep it."""
        op, _, slot = self.program.instructions[k]
        text = self.slots[op].format(slot)
        if self.uses[k] > MAX_READS:
            self._assign(k, text)
        else:
            self.text[k] = (text, ATOM)

    def _write(self, k: int, text: str, power: int) -> None:
        """Keep the text for its one place, or assign it."""
        if k in self.variables or self.uses[k] != 1 or len(text) > MAX_INLINE:
            self._assign(k, text)
        else:
            self.text[k] = (text, power)

    def _assign(self, k: int, text: str) -> None:
        line = self.variables.get(k)
        self.temporaries += line is None
        variable = line.variable if line else f"v{self.temporaries}_"
        self.lines.append(Line(variable, text, line.comment if line else ""))
        self.text[k] = (variable, ATOM)


def _binds_less(needs: Sequence[int], first: int, second: int) -> bool:
    """Return whether the second operand would need brackets and the first would not."""
    return len(needs) == 2 and needs[0] <= second < needs[1] <= first
