r"""``python -m benchmarks.checking FOLDER --lexica FOLDER``: the checker against judged notes.

``FOLDER`` holds notes and ``truth.json``, a list of entries: ``id`` (``file:E1``, ``file:i1``: the n-th
display or inline formula of the note ``file``, without its suffix), ``latex``, ``verdict``, ``accept``
(verdicts that count as right). The lexicon of ``file.md`` is ``file.toml`` of the other folder, by default
what the note brings itself. An inline formula without an entry claims nothing. Every display and every
inline formula that is an equation by the truth is judged; the verdicts stand in a confusion
matrix, what is missed with its reason. A true equation that is called wrong is the worst error and
counted apart; with one the exit status is 1. Entries ``file:C1`` are claims in words (``text``, ``line``):
the finding whose sentence has most of their words is theirs, none is "not read". The truth knows fewer
verdicts: where no entry of it accepts
"ill_formed", ill-formed counts as wrong; an assumption as a definition.
"""

from __future__ import annotations

import json
import re
import statistics
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import click

from benchmarks.table import time_text
from eom.checker.judge.notes import Understood, understand
from eom.checker.judge.verdicts import NONE, verdict
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import lexicon_for, parse_lexicon
from eom.checker.note.review import Reviewed, review
from eom.checker.prose_claims.in_words import in_words
from eom.checker.read.documents import KINDS, Document, Piece, load
from eom.checker.report.findings import Finding
from eom.errors import InputError

LETTERS = {"display": "E", "inline": "i"}
"""What the number of a formula follows in the names of the truth."""
PROSE = "prose"
NOT_READ = "not read"
NO_EQUATION = "not_an_equation"
NAMES = {NONE: NO_EQUATION, "assumption": "definition", "ill-formed": "ill_formed"}
"""Our verdicts in words of the truth, where it has others; blanks are underscores."""
SILENT = ("definition", "undecided", "ambiguous")
"""What may be said of an inline formula that the truth does not list."""
SECONDS = 10.0
"""For one sentence."""
GIVEN = ("constant_mass",)
"""What all notes of the truth assume silently."""


@dataclass(frozen=True)
class Entry:
    """What the truth says of a formula, or of a claim in words that stands in a line."""

    name: str
    latex: str
    verdict: str
    accept: tuple[str, ...]
    line: int = 0


@dataclass(frozen=True)
class Result:
    """A formula or claim judged.

    Its kind ("display", "inline", "prose"), our verdict, the one that counts, the time.
    """

    entry: Entry
    kind: str
    ours: str
    counted: str
    reason: str
    seconds: float

    @property
    def right(self) -> bool:
        """Whether the verdict is one of those accepted."""
        return self.counted in self.entry.accept

    @property
    def false_alarm(self) -> bool:
        """Whether a formula that is not wrong is called wrong."""
        return self.counted in {"wrong", "ill_formed"} and not self.right


def read_truth(path: Path) -> dict[str, Entry]:
    """Return the entries by name. Raises `InputError`."""
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))
        found = [
            Entry(
                r["id"],
                r["latex"] or r.get("text", ""),
                r["verdict"],
                tuple(r["accept"]),
                r.get("line", 0),
            )
            for r in rows
        ]
        found = [e for e in found if e.latex]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError("the truth cannot be read", where=str(path), got=repr(error)) from error
    return {e.name: e for e in found}


def counted(ours: str, accepted: Iterable[str]) -> str:
    """Return our verdict in words of a truth that accepts these verdicts somewhere."""
    name = NAMES.get(ours, ours.replace(" ", "_"))
    return "wrong" if name == "ill_formed" and name not in set(accepted) else name


def note(folder: Path, name: str) -> Path:
    """Return the note of a name, whatever its kind. Raises `InputError`."""
    found = [folder / f"{name}{suffix}" for suffix in KINDS]
    path = next((p for p in found if p.is_file()), None)
    if path is None:
        raise InputError("there is no such note", where=str(folder), got=name)
    return path


def lexicon_of(path: Path, lexica: Path | None) -> Lexicon:
    """Return the lexicon of a note, from a folder of lexica or its own. Raises `InputError`."""
    if lexica is not None:
        text = (lexica / f"{path.stem}.toml").read_text(encoding="utf-8")
        return parse_lexicon(text, path.stem)
    found = lexicon_for(path.read_text(encoding="utf-8"), path)
    if found is None:
        raise InputError("this note has no lexicon", where=str(path))
    return found


def results(folder: Path, lexica: Path | None = None) -> Iterator[Result]:
    """Yield a result for each display, and each inline formula that truth or checker calls an equation.

    Verdicts are those of the report, in the light of all that the note says. The time of a formula is
    that of judging it; reading, elaboration and review of the note are shared out.
    """
    truth = read_truth(folder / "truth.json")
    for name in sorted({e.split(":")[0] for e in truth}):
        yield from of_note(folder, name, lexica)


def of_note(folder: Path, name: str, lexica: Path | None = None) -> Iterator[Result]:
    """Yield the results of one note of a folder, as `results` does. Raises `InputError`."""
    truth = read_truth(folder / "truth.json")
    accepted = {v for e in truth.values() for v in e.accept}
    start = perf_counter()
    path = note(folder, name)
    document = load(path)
    found = understand(document, lexicon_of(path, lexica))
    share = (perf_counter() - start) / max(len(found), 1)
    verdicts, times = [], []
    for understood in found:
        start = perf_counter()
        verdicts.append(verdict(understood, GIVEN))
        times.append(perf_counter() - start + share)
    start = perf_counter()
    placed = review(document, found, GIVEN, verdicts)
    share = (perf_counter() - start) / max(len(found), 1)
    pairs = _paired(name, found, truth)
    for (entry, understood), here, spent in zip(pairs, placed, times, strict=True):
        ours, seconds = here.verdict, spent + share
        word = counted(ours.verdict, accepted)
        kind = understood.formula.piece.kind
        if kind == "display" or {entry.verdict, word} != {NO_EQUATION}:
            yield Result(entry, kind, ours.verdict, word, ours.reason, seconds)
    said = [e for e in truth.values() if e.name.startswith(f"{name}:C")]
    if said:
        yield from _in_words(document, placed, said, accepted)


def _in_words(
    document: Document,
    placed: Sequence[Reviewed],
    said: Sequence[Entry],
    accepted: Iterable[str],
) -> Iterator[Result]:
    """Yield the results of the claims in words of a note; they share the time."""
    start = perf_counter()
    stated = [r.stated for r in placed]
    found = in_words(document, [r.understood for r in placed], stated, GIVEN, SECONDS)
    seconds = (perf_counter() - start) / len(said)
    yield from (_of_claim(entry, found, accepted, seconds) for entry in said)


def _of_claim(
    entry: Entry, found: Sequence[Finding], accepted: Iterable[str], seconds: float
) -> Result:
    """Return the result of a claim in words: of the finding in its line with most of its words."""
    words = _words(entry.latex)
    near = [f for f in found if abs(f.line - entry.line) <= 1]
    best = max(near, key=lambda f: len(words & _words(f.latex)), default=None)
    if best is None or 2 * len(words & _words(best.latex)) < len(words):
        return Result(entry, PROSE, NOT_READ, NOT_READ, "", seconds)
    return Result(entry, PROSE, best.verdict, counted(best.verdict, accepted), best.reason, seconds)


def _words(text: str) -> set[str]:
    return set(re.findall(r"[a-z0-9]+", text.lower()))


def _paired(
    name: str, found: Sequence[Understood], truth: dict[str, Entry]
) -> Iterator[tuple[Entry, Understood]]:
    """Yield formulas with their entries. Raises `InputError` where the note is not that of the truth."""
    numbers: Counter[str] = Counter()
    for understood in found:
        piece = understood.formula.piece
        numbers[piece.kind] += 1
        key = f"{name}:{LETTERS[piece.kind]}{numbers[piece.kind]}"
        if key not in truth and piece.kind == "inline":
            yield Entry(key, piece.body, NO_EQUATION, (NO_EQUATION, *SILENT)), understood
            continue
        if key not in truth or _letters(truth[key].latex) != _letters(piece.body):
            raise _other(key, truth.get(key), piece)
        yield truth[key], understood


def _letters(text: str) -> str:
    return re.sub(r"\W", "", text)


def _other(key: str, entry: Entry | None, piece: Piece) -> InputError:
    return InputError(
        "the note is not that of the truth",
        where=f"{key}, line {piece.line}",
        got=piece.body.strip(),
        expected=entry.latex if entry else "no such entry",
    )


# -- output --------------------------------------------------------------------------------------


def matrix(rows: Sequence[Result]) -> list[str]:
    """Return the lines of the confusion matrix: what is true downwards, our verdict across."""
    counts = Counter((r.entry.verdict, r.ours) for r in rows)
    across = sorted({ours for _, ours in counts})
    width = max(len(true) for true, _ in counts) + 2
    lines = [" " * width + "  ".join(across)]
    for true in sorted({t for t, _ in counts}):
        cells = (str(counts[true, ours] or ".").rjust(len(ours)) for ours in across)
        lines.append(true.ljust(width) + "  ".join(cells))
    return lines


def report(rows: Sequence[Result]) -> Iterator[str]:
    """Yield the lines of the report of all results."""
    for kind in (*LETTERS, PROSE):
        some = [r for r in rows if r.kind == kind]
        equations = [r for r in some if r.entry.verdict != NO_EQUATION or kind == "display"]
        if some:
            right = sum(r.right for r in equations)
            yield f"{kind}: {right} of {len(equations)} within the accepted verdicts"
            yield from ("  " + line for line in matrix(some))
    for title, chosen in (
        ("true, but called wrong", [r for r in rows if r.false_alarm]),
        ("missed otherwise", [r for r in rows if not r.right and not r.false_alarm]),
    ):
        yield f"{title}: {len(chosen)}"
        yield from (f"  {line}" for r in chosen for line in _missed(r))
    yield _times([r.seconds for r in rows])


def _missed(r: Result) -> list[str]:
    accept = " or ".join(r.entry.accept)
    why = [f"    {line.strip()}" for line in r.reason.splitlines()[:1]]
    return [f"{r.entry.name}: {r.ours}, not {accept}: {r.entry.latex[:90]}", *why]


def _times(seconds: Sequence[float]) -> str:
    if not seconds:
        return "nothing judged"
    middle, worst = statistics.median(seconds), max(seconds)
    words = (time_text(middle), time_text(worst), time_text(sum(seconds)))
    return "time of a formula: median {}, worst {}; all {}".format(*words)


@click.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--lexica", type=click.Path(path_type=Path, exists=True), help="Folder of lexica.")
def main(folder: Path, lexica: Path | None) -> None:
    """Judge all notes of a folder; exit with 1 where a true equation is called wrong."""
    rows = list(results(folder, lexica))
    for line in report(rows):
        click.echo(line)
    sys.exit(1 if any(r.false_alarm for r in rows) else 0)


if __name__ == "__main__":
    main()
