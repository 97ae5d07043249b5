r"""``python -m benchmarks.correcting FOLDER --lexica FOLDER``: corrections of wrong lines, measured.

Of the displays that are wrong by ``truth.json`` (see `benchmarks.checking`), how many have the stored
correction, or a line equal to it in all worlds, as the first one, or among the first three. Lines are
equal if their members are, up to one number for all. `benchmarks.edits` measures edits of true lines.
"""

from __future__ import annotations

import json
import statistics
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import click

from benchmarks import checking
from benchmarks.checking import GIVEN, LETTERS, lexicon_of, read_truth
from benchmarks.table import time_text
from eom.checker.judge.models import Worlds, contexts
from eom.checker.judge.notes import Understood, reread, understand
from eom.checker.judge.verdicts import GRAVE, verdict
from eom.checker.mean.claims import Claim
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.values import mixed
from eom.checker.read.damage import apply
from eom.checker.read.documents import load, read_document
from eom.checker.read.grammar import read_formula
from eom.checker.repair.explaining import explain
from eom.checker.report.findings import Explanation
from eom.errors import InputError
from eom.fields import PRIME
from eom.worlds.worlds import closure

SHOWN = 3
"""Corrections among which the right one should be."""


def same(understood: Understood, one: str, other: str) -> bool:
    """Return whether two lines in the place of a formula are equal: as trees, or by members in worlds."""
    try:
        macros = understood.formula.piece.macros
        trees = [apply(read_formula(t, macros=macros).tree)[0] for t in (one, other)]
    except InputError:
        return False
    if trees[0] == trees[1]:
        return True
    found = [reread(understood, tree) for tree in trees]
    return len(found[0]) == len(found[1]) and all(
        _alike(understood, a, b) for a, b in zip(*found, strict=True)
    )


def _alike(understood: Understood, a: Claim, b: Claim) -> bool:
    if a.verdict or b.verdict or len(a.members) != len(b.members) or a.kind != b.kind:
        return a.verdict == b.verdict and a.verdict not in GRAVE and a.members == b.members
    notation = understood.lexicon.notation
    values = [[mixed(notation, m).term for m in c.members] for c in (a, b)]
    terms = [*(t for v in values for t in v), *a.scalars.values(), *b.scalars.values()]
    for context in contexts(terms):
        names = closure([*GIVEN, *context])
        places = [Worlds(c, c.scalars).at(names, v) for c, v in zip((a, b), values, strict=True)]
        if places[0] is None or places[1] is None:
            continue
        rows = [[p.number(t) for t in v] for p, v in zip(places, values, strict=True) if p]
        return _proportional(rows)
    return False


def _proportional(rows: Sequence[Sequence[int | None]]) -> bool:
    """Return whether two rows of numbers are equal up to one number that is not zero."""
    pairs = [(x, y) for x, y in zip(*rows, strict=True) if x is not None and y is not None]
    if len(pairs) < len(rows[0]):
        return False
    first = next((p for p in pairs if p[0] and p[1]), None)
    if first is None:
        return not any(map(any, pairs))
    return all((x * first[1] - y * first[0]) % PRIME == 0 for x, y in pairs)


# -- the truth -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Result:
    """A wrong line: its name, what was found, which correction is right (0: none), the time."""

    name: str
    found: Explanation
    rank: int
    seconds: float


def explained(understood: Understood) -> tuple[Explanation, float]:
    """Return why a formula is wrong: of its first wrong claim."""
    judged = next(j for j in verdict(understood, GIVEN).claims if j.verdict in GRAVE)
    start = process_time()
    return explain(understood, judged, GIVEN), process_time() - start


def rank(understood: Understood, found: Explanation, wanted: str) -> int:
    """Return the number of the first correction that is as wanted, from 1; 0 for none."""
    for k, correction in enumerate(found.corrections, 1):
        if same(understood, correction.latex, wanted):
            return k
    return 0


def truth_results(folder: Path, lexica: Path | None = None) -> Iterator[Result]:
    """Yield a result for every display that is wrong by the truth and by the checker."""
    rows = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    for name in sorted({r["id"].split(":")[0] for r in rows}):
        yield from truth_of_note(folder, name, lexica)


def truth_of_note(folder: Path, name: str, lexica: Path | None = None) -> Iterator[Result]:
    """Yield the results of one note of a folder, as `truth_results` does. Raises `InputError`."""
    entries = read_truth(folder / "truth.json")
    rows = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    stored = {r["id"]: r.get("correction") for r in rows}
    path = checking.note(folder, name)
    numbers: Counter[str] = Counter()
    for understood in understand(load(path), lexicon_of(path, lexica)):
        kind = understood.formula.piece.kind
        numbers[kind] += 1
        key = f"{name}:{LETTERS[kind]}{numbers[kind]}"
        wrong = kind == "display" and entries[key].verdict == "wrong"
        if wrong and verdict(understood, GIVEN).verdict in GRAVE:
            found, seconds = explained(understood)
            yield Result(key, found, rank(understood, found, stored[key]), seconds)


# -- lines of a note -----------------------------------------------------------------------------


def line_of(note: Sequence[str], k: int, text: str, lexicon: Lexicon) -> Understood:
    """Return a line in the place of the k-th one of a note."""
    lines = [*note[:k], text, *note[k + 1 :]]
    found = understand(read_document("\n\n".join(f"$${t}$$" for t in lines)), lexicon)
    return found[k]


# -- output --------------------------------------------------------------------------------------


@click.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--lexica", type=click.Path(path_type=Path, exists=True))
def main(folder: Path, lexica: Path | None) -> None:
    """Compare with the corrections of judged notes."""
    rows = list(truth_results(folder, lexica))
    for r in rows:
        first = r.found.corrections[0].change if r.found.corrections else "no correction"
        click.echo(f"{r.name}: rank {r.rank or 'none'}, {time_text(r.seconds)}: {first}")
    for n in (1, SHOWN):
        right = sum(0 < r.rank <= n for r in rows)
        click.echo(f"the stored correction among the first {n}: {right} of {len(rows)}")
    _times([r.seconds for r in rows])


def _times(seconds: Sequence[float]) -> None:
    if seconds:
        words = (statistics.median(seconds), max(seconds), sum(seconds))
        click.echo("processor time: median {}, worst {}, all {}".format(*map(time_text, words)))


if __name__ == "__main__":
    main()
