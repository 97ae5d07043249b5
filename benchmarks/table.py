"""What a measurement gives: rows of one table, and the table."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from rich.console import Console
from rich.table import Table

from benchmarks.settings import Settings

MARKS = {True: "[green]yes[/green]", False: "[bold red]NO[/bold red]", None: ""}


@dataclass(frozen=True)
class Row:
    """One line: what was measured, ours, what stands beside it, their ratio, and the target.

    ``met``: None where there is no target.
    """

    what: str
    ours: str
    beside: str = ""
    ratio: str = ""
    target: str = ""
    met: bool | None = None


@dataclass(frozen=True)
class Section:
    """Rows under one title."""

    title: str
    rows: tuple[Row, ...]


def table(sections: Iterable[Section]) -> Table:
    """Return the one table of all sections."""
    result = Table("measured", "ours", "beside it", "ratio", "target", "met")
    for section in sections:
        result.add_section()
        result.add_row(f"[bold]{section.title}[/bold]")
        for row in section.rows:
            cells = (row.ours, row.beside, row.ratio, row.target)
            result.add_row(f"  {row.what}", *cells, MARKS[row.met])
    return result


def missed(sections: Sequence[Section]) -> list[str]:
    """Return what missed its target."""
    return [row.what for s in sections for row in s.rows if row.met is False]


def time_text(seconds: float) -> str:
    """Return a time with three digits and a fitting unit.

    >>> time_text(3.456e-6)
    '3.46 us'
    """
    size, unit = next(
        ((s, u) for s, u in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us")) if seconds >= s), (1e-9, "ns")
    )
    return f"{seconds / size:.3g} {unit}"


def alone(measure: Callable[[Settings], Section]) -> None:
    """Run one measurement from the command line: all of it, or with ``--quick`` its short form."""
    found = [measure(Settings("--quick" in sys.argv))]
    Console(width=160).print(table(found))
    sys.exit(1 if missed(found) else 0)
