"""``python -m benchmarks.mutants``: every single edit of every verified step, judged and checked.

An edit is really false when 60-digit numerics on smooth motions say so (`tests.eom.oracle`). The
command fails where less than 99 % of the false edits are rejected, or a true one is. A whole run takes
a quarter of an hour on one core; each derivation is told when it is done, and a run that is stopped
(from the keyboard, or by the signal to terminate) prints what it has counted until then.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import random
import signal
import sys
import time
from functools import lru_cache

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


PIECES = 16
"""Pieces of a derivation, of which each is judged by one process: what a run that is stopped may lose."""


@click.command()
@click.argument("chosen", nargs=-1)
@click.option("--most", type=int, help="Judge at most so many edits of a derivation, at random.")
@click.option("--jobs", type=click.IntRange(1), default=1, show_default=True, help="Processes.")
def main(chosen: tuple[str, ...], most: int | None, jobs: int) -> None:
    """Judge every edit of the derivations CHOSEN, or of all that ship and of those that tests make."""
    asked = tuple(dict.fromkeys(chosen or (*names(), *OWN)))
    judged, left = _counted(asked, most, jobs)
    count = Count()
    for found in judged:
        count.include(found)
    Console(width=110).print(_table(count))
    for line in count.wrong:
        click.echo(line)
    if left:
        click.echo(f"Stopped before the end; not judged, or not wholly: {', '.join(left)}.")
    sys.exit(bool(count.missed or left))


def _counted(asked: tuple[str, ...], most: int | None, jobs: int) -> tuple[list[Count], list[str]]:
    """Return what became of the edits of each derivation, and which are not judged wholly."""
    judged, left, began = dict[str, Count](), list(asked), time.perf_counter()
    parts = [(name, most, k) for name in asked for k in range(PIECES)]
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with (
        contextlib.suppress(KeyboardInterrupt),
        multiprocessing.get_context("spawn").Pool(jobs, _uninterrupted) as pool,
    ):
        for (name, _, k), piece in zip(parts, pool.imap(_judged, parts), strict=True):
            judged.setdefault(name, Count()).include(piece)
            if k == PIECES - 1:
                left.remove(name)
                _tell(name, judged[name], time.perf_counter() - began)
                began = time.perf_counter()
    return list(judged.values()), left


def _uninterrupted() -> None:
    """Leave it to whoever started this process to end it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _tell(name: str, found: Count, seconds: float) -> None:
    """Say what became of the edits of a derivation, in one line, and which were judged wrongly."""
    outcomes = ", ".join(f"{n} {outcome}" for outcome, n in found.total.most_common())
    click.echo(f"{name}: {found.total.total()} edits in {seconds:.0f} s: {outcomes}", err=True)
    for line in found.wrong:
        click.echo(line, err=True)


@lru_cache(maxsize=1)
def _edits(name: str, most: int | None) -> list[tuple]:
    """Return the edits of a derivation, or some of them drawn at random."""
    made = OWN[name]().finish() if name in OWN else derive(name)
    edits = list(edits_of([made]))
    return edits if most is None or most >= len(edits) else random.Random(name).sample(edits, most)


def _judged(part: tuple[str, int | None, int]) -> Count:
    """Judge every so many-th edit of a derivation."""
    name, most, first = part
    count = Count()
    for one in _edits(name, most)[first::PIECES]:
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
