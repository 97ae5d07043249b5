"""``python -m benchmarks.mutants``: every single edit of every verified step, judged and checked.

An edit is really false when 60-digit numerics on smooth motions say so (`tests.eom.oracle`). The
command fails where less than 99 % of the false edits are rejected, or a true one is.
"""

from __future__ import annotations

import multiprocessing
import random
import sys

import click
from rich.console import Console
from rich.table import Table

from eom.derivations import derive, names
from tests.eom.mutants import Count, edits_of
from tests.eom.own_derivations import OWN

COLUMNS = {
    "really false": ("false, rejected", "false, accepted", "false, undecided"),
    "rejected": ("false, rejected", "false, undecided"),
    "true": ("true, accepted", "true, rejected", "true, undecided"),
    "accepted": ("true, accepted",),
    "sign undecided": ("true, undecided",),
    "ill-formed": ("ill-formed",),
    "no value": ("without a value",),
    "broken": ("broken",),
}
"""Column of the table, and the outcomes that it counts."""


@click.command()
@click.argument("chosen", nargs=-1)
@click.option("--most", type=int, help="Judge at most so many edits of a derivation, at random.")
@click.option("--jobs", type=click.IntRange(1), default=1, show_default=True, help="Processes.")
def main(chosen: tuple[str, ...], most: int | None, jobs: int) -> None:
    """Judge every edit of the derivations CHOSEN, or of all that ship and of those that tests make."""
    count = Count()
    parts = [(name, most, k, jobs) for name in chosen or (*names(), *OWN) for k in range(jobs)]
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        for (name, *_), found in zip(parts, pool.imap(_judged, parts), strict=True):
            count.include(found)
            click.echo(f"{name}: {count.total.total()} edits so far", err=True)
            for line in found.wrong:
                click.echo(line, err=True)
    Console(width=110).print(_table(count))
    for line in count.wrong:
        click.echo(line)
    sys.exit(count.missed)


def _judged(part: tuple[str, int | None, int, int]) -> Count:
    """Judge every so many-th edit of a derivation, or of some of them drawn at random."""
    name, most, first, step = part
    made = OWN[name]().finish() if name in OWN else derive(name)
    edits = list(edits_of([made]))
    if most is not None and most < len(edits):
        edits = random.Random(name).sample(edits, most)
    count = Count()
    for one in edits[first::step]:
        count.add(*one)
    return count


def _table(count: Count) -> Table:
    table = Table("edit", "all", *COLUMNS)
    rows = {**count.by_kind, "all": count.total}
    for kind, found in rows.items():
        cells = (sum(found[o] for o in outcomes) for outcomes in COLUMNS.values())
        table.add_row(kind, str(found.total()), *map(str, cells))
    return table


if __name__ == "__main__":
    main()
