"""Values of a program as short texts, for errors."""

from __future__ import annotations

from codegen.frontend.layout import Layout
from codegen.ir.ops import LEAVES
from codegen.ir.passes import needed
from codegen.ir.program import Program
from eom.tables import Table

MAX_EXCERPT = 120
"""Characters of an expression in an error."""


def excerpt(program: Program, layout: Layout, number: int) -> str:
    """Return a value of a program as text in the names of the layout, cut where it is long."""
    kinds = {"state": layout.states, "parameter": layout.parameters, "input": layout.inputs}
    texts: dict[int, str] = {}
    for k in sorted(needed(Program(program.instructions, {"": (number,)}), [""])):
        op, args, value = program.instructions[k]
        if k in program.names and k != number:
            text = program.names[k].name
        elif op in kinds and isinstance(value, int):
            text = kinds[op][value].name
        elif op in LEAVES:
            text = op if value is None else str(value)
        else:
            label = f"{value.label} " if isinstance(value, Table) else ""
            text = f"{op}({label}{', '.join(texts[a] for a in args)})"
        texts[k] = text if len(text) <= MAX_EXCERPT else f"{text[: MAX_EXCERPT - 3]}..."
    return texts[number]
