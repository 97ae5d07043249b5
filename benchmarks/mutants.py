"""``python -m benchmarks.mutants``: every single edit of every verified step, judged and checked.

An edit is really false when 60-digit numerics on smooth motions say so (`tests.eom.oracle`). The
command fails where less than 99 % of the false edits are rejected, or a true one is.
"""

from __future__ import annotations

import random
import sys

import click
from rich.console import Console
from rich.table import Table

from eom.derivations import derive, names
from tests.eom.mutants import Count, edits_of

COLUMNS = {
    "really false": ("false, rejected", "false, accepted", "false, undecided"),
    "rejected": ("false, rejected", "false, undecided"),
    "true": ("true, accepted", "true, rejected", "true, undecided"),
    "accepted": ("true, accepted",),
    "sign undecided": ("true, undecided",),
    "ill-formed": ("ill-formed",),
    "no value": ("without a value",),
}
"""Column of the table, and the outcomes that it counts."""


@click.command()
@click.argument("chosen", nargs=-1)
@click.option("--most", type=int, help="Judge at most so many edits of a derivation, at random.")
def main(chosen: tuple[str, ...], most: int | None) -> None:
    """Judge every edit of the derivations CHOSEN, or of all."""
    count = Count()
    for name in chosen or names():
        edits = list(edits_of([derive(name)]))
        if most is not None and most < len(edits):
            edits = random.Random(name).sample(edits, most)
        for one in edits:
            count.add(*one)
        click.echo(f"{name}: {count.total.total()} edits so far", err=True)
    Console(width=110).print(_table(count))
    for line in count.wrong:
        click.echo(line)
    sys.exit(count.missed)


def _table(count: Count) -> Table:
    table = Table("edit", "all", *COLUMNS)
    rows = {**count.by_kind, "all": count.total}
    for kind, found in rows.items():
        cells = (sum(found[o] for o in outcomes) for outcomes in COLUMNS.values())
        table.add_row(kind, str(found.total()), *map(str, cells))
    return table


if __name__ == "__main__":
    main()
