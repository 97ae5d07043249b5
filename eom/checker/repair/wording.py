"""Words for a slip that was undone: which, where in a chain or table, what stands there, what was meant."""

from __future__ import annotations

from eom.checker.read.paths import Path, at
from eom.checker.read.syntax import Matrix, Missing, Node
from eom.checker.read.writing import latex
from eom.checker.repair.lines import Line
from eom.checker.repair.options import Option
from eom.checker.repair.rewriting import tight
from eom.checker.repair.slips import LOST

SIDES = 2
"""Members of an equation; those of a longer chain are counted."""


def words(line: Line, option: Option) -> str:
    """Say what was undone."""
    head = f"{option.slip.words}{_member(line, option)}"
    if option.added:
        return f"{head}: {', '.join(_added(option, cell, text) for cell, text in option.added)}"
    head += _cell(option.addend.node, option.paths[0])
    if option.slip is LOST:
        return f"{head}: ${'-' if option.sign < 0 else '+'} {tight(option.new)}$"
    if isinstance(option.new, Missing):
        return f"{head}: ${latex(option.addend.node)}$"
    if option.sign != option.addend.sign:
        return f"{head}: before ${latex(option.addend.node)}$"
    return f"{head}: ${latex(option.old)}$ should be ${latex(option.new)}$"


def _member(line: Line, option: Option) -> str:
    """Name the member of a chain, as it is counted in the line."""
    written = [m.number for m in line.members if m.path is not None]
    place = written.index(option.addend.member) + 1
    return f" in member {place}" if len(written) > SIDES else ""


def _added(option: Option, cell: tuple[int, int], text: str) -> str:
    """Say what a cell of a table lacks."""
    path = option.paths[0]
    inside = path[-1:] == (("rows", cell),)
    return f"${text}${_cell(option.addend.node, path if inside else (*path, ('rows', cell)))}"


def _cell(root: Node, path: Path) -> str:
    """Name the row of the innermost table around a place, and the column where there are several."""
    for k in range(len(path) - 1, -1, -1):
        name, numbers = path[k]
        table = at(root, path[:k])
        if isinstance(table, Matrix) and name == "rows" and len(numbers) == SIDES:
            row, column = numbers
            wide = len(table.rows[0]) > 1
            return f" in row {row + 1}" + (f", column {column + 1}" if wide else "")
    return ""
