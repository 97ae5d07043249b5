"""What a target is: one row of tables, and the loop that all rows share.

A target is one file: a table of templates over `codegen.ir.ops`, helper functions for what the
language lacks or does otherwise than IEEE 754, and a function that writes the files. Its `Target`
becomes a row of `codegen.compiling.compiled`. CONTRIBUTING.md shows the steps on one target.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from codegen.frontend.layout import Layout, excerpt, names_of
from codegen.ir.interpret import constants
from codegen.ir.ops import OPS
from codegen.ir.passes import needed, prune
from codegen.ir.program import INVARIANTS, OUTPUTS, Program
from codegen.targets.render import Body, Tables, Template, leaf_names, render, table_names
from eom.errors import InputError
from eom.tables import Table

_WORD = re.compile(r"[A-Za-z_]\w*")


@dataclass(frozen=True)
class Target:
    """A language that programs are written in.

    ``extension``: of the file that holds the functions. ``templates``: one a primitive operation.
    ``slots``: how a slot of each kind of leaf is read. ``numbers``: how ``inf``, ``-inf`` and
    ``nan`` are written. ``files``: returns the generated files by name; the same input gives the
    same bytes. ``helpers``: functions that templates call, by name, in an order in which each uses
    earlier ones only; `identifiers` never spells a name with a leading underscore, so that such
    helpers clash with no variable. ``unsupported``: operations without a template, each with what
    to do instead; a program that holds one is refused before anything is written. ``table``: the text
    of the function of a table, from its name and the table.
    """

    name: str
    extension: str
    templates: Mapping[str, Template]
    slots: Mapping[str, str]
    numbers: Mapping[str, str]
    files: Callable[[Program, Layout], Mapping[str, str]]
    helpers: Mapping[str, str] = field(default_factory=dict)
    unsupported: Mapping[str, str] = field(default_factory=dict)
    table: Callable[[str, Table], str] | None = None


def missing(target: Target) -> list[str]:
    """Return the operations that a target neither writes nor lists as unsupported."""
    return [op for op in OPS if op not in target.templates and op not in target.unsupported]


def refuse_unsupported(target: Target, program: Program, layout: Layout) -> None:
    """Raise `InputError` if a result needs an operation that the target cannot compute.

    Values that depend on constants alone are numbers already, and are never refused.
    """
    known = constants(program)
    for group in layout.sizes:
        for k in sorted(needed(program, [group])):
            op = program.instructions[k].op
            if op in OPS and op not in target.templates and k not in known:
                name = _needing(program, layout, group, k)
                raise InputError(
                    f"target {target.name} does not compute {op}",
                    where=f"system {layout.name!r}, {name} of {group}",
                    got=excerpt(program, layout, k),
                    hint=target.unsupported.get(op, "choose another target"),
                )


def _needing(program: Program, layout: Layout, group: str, number: int) -> str:
    """Return the name of the first result of a group that depends on a value."""
    for name, k in zip(layout.results[group], program.results[group], strict=True):
        if number in needed(Program(program.instructions, {group: (k,)}), [group]):
            return name
    raise AssertionError(number)


def bodies(target: Target, program: Program, layout: Layout) -> dict[str, Body]:
    """Return the body of one function a group of results."""
    tables = table_names(program)
    how = (leaf_names(layout), target.templates, target.slots, target.numbers, tables)
    return {g: render(prune(program, [g]), g, *how) for g in layout.sizes}


def used_helpers(target: Target, written: Mapping[str, Body]) -> list[str]:
    """Return the texts of the helpers that some body calls, and of those that these call."""
    called = {word for body in written.values() for word in words(body)}
    for name in reversed(list(target.helpers)):
        if name in called:
            called.update(_WORD.findall(target.helpers[name]))
    return [text for name, text in target.helpers.items() if name in called]


def used_tables(target: Target, tables: Tables, written: Mapping[str, Body]) -> list[str]:
    """Return the texts of the functions of the tables, by name, that some body calls."""
    called = {word for body in written.values() for word in words(body)}
    named = {name: table for table, name in tables.items() if name in called}
    return [target.table(name, table) for name, table in named.items() if target.table]


def words(body: Body) -> set[str]:
    """Return the identifiers in the expressions of a body."""
    texts = (*(line.expression for line in body.lines), *body.results)
    return {word for text in texts for word in _WORD.findall(text)}


def nested(width: int) -> str:
    """Return Horner's rule over the coefficients ``c`` of a row of a table, in ``h``; NaN stays NaN."""
    text = f"c[{width - 1}]" if width > 1 else "c[0] + 0.0 * h"
    for k in range(width - 2, -1, -1):
        text = f"c[{k}] + h * {text if k == width - 2 else f'({text})'}"
    return text


def name_tables(layout: Layout) -> dict[str, tuple[Any, ...]]:
    """Return the names and patterns that a module exports, by the name of the table."""
    patterns = {f"{group.upper()}_PATTERN": places for group, places in layout.patterns.items()}
    return {
        **patterns,
        "STATES": names_of(layout.states),
        "PARAMETERS": names_of(layout.parameters),
        "INPUTS": names_of(layout.inputs),
        "OUTPUTS": layout.results[OUTPUTS],
        "INVARIANTS": layout.results[INVARIANTS],
    }
