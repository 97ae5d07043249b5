r"""``python -m benchmarks.checking FOLDER [--lexica FOLDER | --bare | --formulas]``: judged notes.

``FOLDER`` holds notes and ``truth.json``, a list of entries, one for each formula: ``id`` (``file:E1``,
``file:i1``: the n-th display or inline formula of the note ``file``, without its suffix) or ``note`` and
``index`` (a file, and the number of a display in it); ``latex``; ``verdict``; ``accept`` or ``also_accept``
(verdicts that count as right); of wrong ones ``correction``, ``other_corrections``, ``wrong_term`` and
``missing_term``. Entries ``file:C1`` are claims in words (``text``, ``line``): the finding whose sentence
has most of their words is theirs, none is "not read". The lexicon of ``file.md`` is ``file.toml`` or
``file.lexicon.toml`` of the other folder, by default of ``FOLDER/lexica``, or what the note brings itself.

Judged is what the report of `eom.check` says. Where some inline formulas have entries, those without
claim nothing. The verdicts stand in a confusion matrix, what is missed with its reason. A true equation
that is called wrong is the worst error and counted apart, also where the corrections stand in place of
the wrong lines; with one the exit status is 1. The truth may know fewer verdicts: where no entry of it
accepts "ill_formed", ill-formed counts as wrong; an assumption as a definition.

A wrong line is found for the right reason where a correction of the truth is among those offered, or a
place that is blamed lies in the term that is wrong. Corrections are the same if the lines are equal in
all worlds: their members, up to one number for all.

With ``--bare`` a note is judged with nothing but itself, without the lexicon in its head: meanings are
found from its words, letters and types. Lines that are unsure count as not decided, and as not found.
With ``--wordless`` the words of a note are taken out as well, symbols and formulas stay.
With ``--meanings`` what symbols were taken to mean is counted (`benchmarks.meanings`).
With ``--formulas`` every line of the truth is judged by itself, without a note; ``--strict`` counts what is
unsure as wrong.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time
from typing import Any

import click

from benchmarks.meanings import counted as counted_meanings
from benchmarks.meanings import report as report_meanings
from benchmarks.table import time_text
from eom.checker.infer.draft import propose
from eom.checker.judge.coordinates import on_solutions
from eom.checker.judge.judge import models_of
from eom.checker.judge.notes import Understood, reread, understand
from eom.checker.judge.verdicts import GRAVE, NONE
from eom.checker.judge.worlds import Worlds, contexts
from eom.checker.mean.claims import Claim
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import lexicon_for, parse_lexicon
from eom.checker.mean.values import mixed
from eom.checker.note.checking import check_document, check_note
from eom.checker.read.damage import apply
from eom.checker.read.documents import KINDS, Document, Piece, Text, load
from eom.checker.read.grammar import read_formula
from eom.checker.report.findings import (
    GIVEN,
    UNEXPLAINED,
    UNSURE,
    Explanation,
    Finding,
    Settings,
)
from eom.errors import InputError
from eom.fields import PRIME
from eom.worlds.worlds import closure

LETTERS = {"display": "E", "inline": "i"}
"""What the number of a formula follows in the names of the truth."""
PROSE = "prose"
NOT_READ = "not read"
NO_EQUATION = "not_an_equation"
NAMES = {NONE: NO_EQUATION, "assumption": "definition", "ill-formed": "ill_formed"}
"""Our verdicts in words of the truth, where it has others; blanks are underscores."""
SILENT = ("definition", "undecided", "ambiguous")
"""What may be said of an inline formula that the truth does not list."""
OPEN = frozenset({"undecided", "ambiguous", UNSURE, NONE})
TRUE = ("holds", "holds_under", "definition")
SHOWN = 3
"""Corrections among which the right one should be."""


@dataclass(frozen=True)
class Entry:
    """What the truth says of a formula, or of a claim in words that stands in a line.

    ``corrections``: lines that are right in place of a wrong one; ``terms``: what is wrong in it.
    """

    name: str
    latex: str
    verdict: str
    accept: tuple[str, ...]
    line: int = 0
    corrections: tuple[str, ...] = ()
    terms: tuple[str, ...] = ()


@dataclass(frozen=True)
class Result:
    """A formula or claim judged.

    Its kind ("display", "inline", "prose"), our verdict, the one that counts; why it is called wrong, the
    number of the first correction that is one of the truth (0: none), whether a place is rightly blamed.
    """

    entry: Entry
    kind: str
    ours: str
    counted: str
    reason: str = ""
    found: Explanation = UNEXPLAINED
    rank: int = 0
    blamed: bool = False

    @property
    def right(self) -> bool:
        """Whether the verdict is one of those accepted."""
        return self.counted in self.entry.accept

    @property
    def false_alarm(self) -> bool:
        """Whether a formula that is not wrong is called wrong."""
        return self.counted in {"wrong", "ill_formed"} and not self.right

    @property
    def wrong(self) -> bool:
        """Whether the formula is wrong by the truth."""
        return self.entry.verdict == "wrong"

    @property
    def caught(self) -> bool:
        """Whether it is wrong, and called so."""
        return self.wrong and self.ours in GRAVE


def read_truth(path: Path) -> dict[str, Entry]:
    """Return the entries by name. Raises `InputError`."""
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))
        found = [_entry(r) for r in rows]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError("the truth cannot be read", where=str(path), got=repr(error)) from error
    return {e.name: e for e in found if e.latex}


def _entry(row: dict[str, Any]) -> Entry:
    name = row["id"] if "id" in row else f"{Path(row['note']).stem}:E{row['index']}"
    corrections = (row.get("correction"), *row.get("other_corrections", ()))
    return Entry(
        name,
        row["latex"] or row.get("text", ""),
        row["verdict"],
        tuple(row["accept"] if "accept" in row else (row["verdict"], *row.get("also_accept", ()))),
        row.get("line", 0),
        tuple(c for c in corrections if c) if row["verdict"] == "wrong" else (),
        tuple(t for t in (row.get("wrong_term"), row.get("missing_term")) if t),
    )


def counted(ours: str, accepted: Iterable[str]) -> str:
    """Return our verdict in words of a truth that accepts these verdicts somewhere."""
    name = NAMES.get(ours, ours.replace(" ", "_"))
    return "wrong" if name == "ill_formed" and name not in set(accepted) else name


def note(folder: Path, name: str) -> Path:
    """Return the note of a name, whatever its kind. Raises `InputError`."""
    return _first([folder / f"{name}{suffix}" for suffix in KINDS], "note")


def _first(paths: Sequence[Path], what: str) -> Path:
    path = next((p for p in paths if p.is_file()), None)
    if path is None:
        raise InputError(f"there is no such {what}", where=str(paths[0].parent), got=paths[0].stem)
    return path


def _lexicon_file(path: Path, lexica: Path | None) -> Path | None:
    """Return the file of the lexicon of a note, None where the note brings its own."""
    own = path.parent / "lexica"
    folder = lexica or (own if own.is_dir() else None)
    if folder is None:
        return None
    names = (f"{path.stem}.toml", f"{path.stem}.lexicon.toml")
    return _first([folder / n for n in names], "lexicon")


def lexicon_of(path: Path, lexica: Path | None) -> Lexicon:
    """Return the lexicon of a note, from a folder of lexica or its own. Raises `InputError`."""
    file = _lexicon_file(path, lexica)
    if file is not None:
        return parse_lexicon(file.read_text(encoding="utf-8"), file.name, file.parent)
    found = lexicon_for(path.read_text(encoding="utf-8"), path)
    if found is None:
        raise InputError("this note has no lexicon", where=str(path))
    return found


def results(folder: Path, lexica: Path | None = None) -> Iterator[Result]:
    """Yield a result for each display, and each inline formula that truth or checker calls an equation."""
    truth = read_truth(folder / "truth.json")
    for name in sorted({e.split(":")[0] for e in truth}):
        yield from of_note(folder, name, lexica)


def of_note(
    folder: Path,
    name: str,
    lexica: Path | None = None,
    *,
    corrections: bool = False,
    wordless: bool = False,
) -> Iterator[Result]:
    """Yield the results of one note of a folder, as `results` does. Raises `InputError`.

    ``corrections``: whether those of wrong lines are compared with those of the truth; ``wordless``:
    whether the words of the note are taken out.
    """
    truth = read_truth(folder / "truth.json")
    accepted = {v for e in truth.values() for v in e.accept}
    inline = any(":i" in e for e in truth)
    path = note(folder, name)
    file = _lexicon_file(path, lexica)
    document = without_words(load(path)) if wordless else load(path)
    settings = Settings(lexicon=str(file) if file else "")
    found = check_document(document, settings, path).findings
    by_name = {f"{name}:{LETTERS[f.kind]}{f.number}": f for f in found if f.kind in LETTERS}
    pieces = list(_named(name, load(path).pieces))
    lines = (
        understand(load(path), lexicon_of(path, lexica)) if corrections else [None] * len(pieces)
    )
    for (key, piece), line in zip(pieces, lines, strict=True):
        entry, finding = _entry_of(key, piece, truth), by_name.get(key)
        ours = finding.verdict if finding else NONE
        word = counted(ours, accepted)
        judged = inline or piece.kind == "display"
        if not judged or (piece.kind != "display" and {entry.verdict, word} == {NO_EQUATION}):
            continue
        one = Result(entry, piece.kind, ours, word, finding.reason if finding else "")
        yield _compared(one, finding, line) if finding and line and one.caught else one
    said = [e for e in truth.values() if e.name.startswith(f"{name}:C")]
    words = [f for f in found if f.kind == PROSE]
    yield from (_of_claim(entry, words, accepted) for entry in said)


def without_words(document: Document) -> Document:
    """Return a document of which only formulas are left."""
    blank = (p if p.is_formula else replace(p, body=" ") for p in document.pieces)
    return replace(document, pieces=tuple(blank))


def without_lexicon(folder: Path, name: str, *, wordless: bool = False) -> Iterator[Result]:
    """Yield the results of one note with nothing but itself. Raises `InputError`."""
    with tempfile.TemporaryDirectory() as place:
        path = note(folder, name)
        text = path.read_text(encoding="utf-8")
        (Path(place) / path.name).write_text(_HEAD.sub("", text), encoding="utf-8")
        shutil.copy(folder / "truth.json", place)
        yield from of_note(Path(place), name, wordless=wordless)


def _inferred(path: Path) -> float:
    """Return the processor time in which the meanings of a note are found."""
    begun = process_time()
    propose(load(path))
    return process_time() - begun


def alone(folder: Path, *, strict: bool) -> Iterator[Result]:
    """Yield the results of all lines of the truth, each as a formula without a note."""
    for entry in read_truth(folder / "truth.json").values():
        (found,) = check_note(Text(entry.latex), Settings(kind="formula", strict=strict)).findings
        word = counted(found.verdict, entry.accept)
        yield Result(entry, "display", found.verdict, word, found.reason)


_HEAD = re.compile(r"\A\+\+\+\n.*?^\+\+\+\n", re.DOTALL | re.MULTILINE)
"""What stands in the head of a note for the checker."""


def _named(name: str, pieces: Iterable[Piece]) -> Iterator[tuple[str, Piece]]:
    """Yield the formulas of a note with their names in the truth."""
    numbers: Counter[str] = Counter()
    for piece in pieces:
        if piece.is_formula:
            numbers[piece.kind] += 1
            yield f"{name}:{LETTERS[piece.kind]}{numbers[piece.kind]}", piece


def _entry_of(key: str, piece: Piece, truth: dict[str, Entry]) -> Entry:
    """Return the entry of a formula. Raises `InputError` where the note is not that of the truth."""
    if key not in truth and piece.kind == "inline":
        return Entry(key, piece.body, NO_EQUATION, (NO_EQUATION, *SILENT))
    if key not in truth or _letters(truth[key].latex) != _letters(piece.body):
        raise _other(key, truth.get(key), piece)
    return truth[key]


def _letters(text: str) -> str:
    return re.sub(r"\W", "", re.sub(r"\\(?:label|tag)\{[^}]*\}|\\nonumber", "", text))


def _other(key: str, entry: Entry | None, piece: Piece) -> InputError:
    return InputError(
        "the note is not that of the truth",
        where=f"{key}, line {piece.line}",
        got=piece.body.strip(),
        expected=entry.latex if entry else "no such entry",
    )


def _of_claim(entry: Entry, found: Sequence[Finding], accepted: Iterable[str]) -> Result:
    """Return the result of a claim in words: of the finding in its line with most of its words."""
    words = _words(entry.latex)
    near = [f for f in found if abs(f.line - entry.line) <= 1]
    best = max(near, key=lambda f: len(words & _words(f.latex)), default=None)
    if best is None or 2 * len(words & _words(best.latex)) < len(words):
        return Result(entry, PROSE, NOT_READ, NOT_READ)
    return Result(entry, PROSE, best.verdict, counted(best.verdict, accepted), best.reason)


def _words(text: str) -> set[str]:
    return set(re.findall(r"[a-z0-9]+", text.lower()))


# -- corrections -----------------------------------------------------------------------------------


def _compared(one: Result, finding: Finding, line: Understood) -> Result:
    """Return the result of a wrong line with what is said of it, beside what the truth says."""
    found = finding.explanation
    ranks = [rank(line, found, c) for c in one.entry.corrections]
    text, start = finding.source.text, finding.span.start
    places = [(text.find(t, start, finding.span.stop), len(t)) for t in one.entry.terms]
    blamed = any(a >= 0 and s.start < a + n and s.stop > a for s in found.blamed for a, n in places)
    return replace(one, found=found, rank=min((r for r in ranks if r), default=0), blamed=blamed)


def rank(understood: Understood, found: Explanation, wanted: str) -> int:
    """Return the number of the first correction that is as wanted, from 1; 0 for none."""
    for k, correction in enumerate(found.corrections, 1):
        if same(understood, correction.latex, wanted):
            return k
    return 0


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
    if on_solutions(a) and on_solutions(b):
        drawn = [
            next(models_of(c, GIVEN).levels(v))[0] for c, v in zip((a, b), values, strict=True)
        ]
        return _proportional([[d.number(t) for t in v] for d, v in zip(drawn, values, strict=True)])
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


def corrected(folder: Path, lexica: Path | None = None) -> Iterator[Result]:
    """Yield the results of all notes with its first correction in place of each wrong display."""
    truth = read_truth(folder / "truth.json")
    with tempfile.TemporaryDirectory() as place:
        copied = Path(place) / folder.name
        shutil.copytree(folder, copied)
        for name in sorted({e.split(":")[0] for e in truth}):
            _correct(note(copied, name), truth)
        rows = [
            {"id": e.name, "latex": e.latex, "verdict": e.verdict, "accept": e.accept}
            for e in truth.values()
        ]
        (copied / "truth.json").write_text(json.dumps(rows), encoding="utf-8")
        yield from results(copied, lexica)


def _correct(path: Path, truth: dict[str, Entry]) -> None:
    """Write corrections over the wrong displays of a note, and over their entries of the truth."""
    text = path.read_text(encoding="utf-8")
    for key, piece in reversed([*_named(path.stem, load(path).pieces)]):
        entry = truth.get(key)
        if entry is None or not entry.corrections or piece.kind != "display":
            continue
        new = entry.corrections[0]
        old, put = (
            json.dumps(t)[1:-1] if path.suffix == ".ipynb" else t for t in (piece.body, new)
        )
        before, found, after = text.rpartition(old)
        if found:
            text = f"{before}{put}{after}"
            truth[key] = replace(entry, latex=new, verdict="holds", accept=TRUE)
    path.write_text(text, encoding="utf-8")


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


def summary(rows: Sequence[Result], *, repairs: bool = True) -> Iterator[str]:
    """Yield the lines of the figures of all displays; without ``repairs`` no reasons nor corrections."""
    displays = [r for r in rows if r.kind == "display"]
    wrong, caught = [r for r in displays if r.wrong], [r for r in displays if r.caught]
    passed = sum(r.counted in TRUE and not r.right for r in wrong)
    ranks = [r.rank for r in caught]
    reason = sum(bool(r.rank or r.blamed) for r in caught)
    yield f"decided: {sum(r.ours not in OPEN for r in displays)} of {len(displays)}"
    why = f"; for the right reason: {reason}" if repairs else ""
    yield f"wrong ones found: {len(caught)} of {len(wrong)}{why}"
    yield f"wrong ones passed: {passed}"
    unsure = [r for r in displays if r.ours == UNSURE]
    if unsure:
        yield f"unsure: {len(unsure)}, of which {sum(r.wrong for r in unsure)} are wrong"
    for n in (1, SHOWN) if repairs else ():
        yield f"the correction among the first {n}: {sum(0 < r <= n for r in ranks)} of {len(caught)}"
    for r in caught if repairs else ():
        if not 0 < r.rank <= SHOWN:
            yield f"  {r.entry.name}: rank {r.rank or 'none'}{', rightly blamed' * r.blamed}"
            yield from (f"    offered: {c.latex[:150]}" for c in r.found.corrections[:SHOWN])


def _missed(r: Result) -> list[str]:
    accept = " or ".join(r.entry.accept)
    why = [f"    {line.strip()}" for line in r.reason.splitlines()[:1]]
    return [f"{r.entry.name}: {r.ours}, not {accept}: {r.entry.latex[:90]}", *why]


@click.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--lexica", type=click.Path(path_type=Path, exists=True), help="Folder of lexica.")
@click.option("--only", default="", help="One note of the folder.")
@click.option("--bare", is_flag=True, help="Judge notes with nothing but themselves.")
@click.option("--wordless", is_flag=True, help="With --bare: with the words of notes taken out.")
@click.option("--meanings", is_flag=True, help="Count meanings against symbols.json.")
@click.option("--formulas", is_flag=True, help="Judge every line by itself, without a note.")
@click.option("--strict", is_flag=True, help="Count lines that are unsure as wrong.")
def main(
    folder: Path,
    lexica: Path | None,
    only: str,
    bare: bool,
    wordless: bool,
    meanings: bool,
    formulas: bool,
    strict: bool,
) -> None:
    """Judge all notes of a folder; exit with 1 where a true equation is called wrong."""
    truth = read_truth(folder / "truth.json")
    if formulas:
        begun = process_time()
        rows = list(alone(folder, strict=strict))
        click.echo("\n".join([*report(rows), *summary(rows, repairs=False)]))
        click.echo(f"processor time of a line: {time_text((process_time() - begun) / len(rows))}")
        sys.exit(any(r.false_alarm for r in rows))
    names = [only] if only else sorted({e.split(":")[0] for e in truth})
    start = process_time()
    if meanings:
        found = [c for n in names for c in counted_meanings(folder, n, note(folder, n), _HEAD)]
        click.echo("\n".join(report_meanings(found)))
        return
    if bare:
        rows = [r for name in names for r in without_lexicon(folder, name, wordless=wordless)]
        click.echo("\n".join([*report(rows), *summary(rows, repairs=False)]))
        click.echo(f"processor time of {len(names)} notes: {time_text(process_time() - start)}")
        spent = sorted(_inferred(note(folder, name)) for name in names)
        middle, worst = time_text(spent[len(spent) // 2]), time_text(spent[-1])
        click.echo(f"of which meanings of a note: {middle} in the median, {worst} at most")
        sys.exit(any(r.false_alarm for r in rows))
    rows = [r for name in names for r in of_note(folder, name, lexica, corrections=True)]
    spent = process_time() - start
    click.echo("\n".join([*report(rows), *summary(rows)]))
    again = [] if only else list(corrected(folder, lexica))
    alarms = [r for r in again if r.false_alarm]
    click.echo(f"with the corrections put in, true but called wrong: {len(alarms)}")
    click.echo("\n".join(f"  {line}" for r in alarms for line in _missed(r)), nl=bool(alarms))
    click.echo(f"processor time of {len(names)} notes: {time_text(spent)}")
    sys.exit(1 if alarms or any(r.false_alarm for r in rows) else 0)


if __name__ == "__main__":
    main()
