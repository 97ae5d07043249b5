"""Checking of hand derivations: `eom check`."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from eom.commands.options import FILE, option, writable
from eom.commands.shared import Rows, WithTable, progress_of, waiting_for
from eom.errors import InputError, printable, unknown_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eom.checker.read.documents import Note
    from eom.checker.report.findings import Graded, Line, Settings

WRONG, UNUSABLE = 1, 2
"""Exit status where something is wrong, and where a note cannot be used."""

COLOURS: dict[str, dict[str, Any]] = {
    "title": {"bold": True},
    "good": {"fg": "green"},
    "bad": {"fg": "red", "bold": True},
    "unsure": {"fg": "yellow"},
    "faint": {"dim": True},
}


def _assumptions() -> Rows:
    from eom.worlds.worlds import ASSUMPTIONS

    return [(name, row.meaning) for name, row in ASSUMPTIONS.items()]


@click.command(cls=WithTable, title="Assumptions for --given", rows=_assumptions)
@click.argument("notes", metavar="NOTE...", nargs=-1)
@click.option(
    "--notation",
    default="",
    metavar="PRESET",
    help="Meanings of symbols: arrow-tilde, left-superscript, underline-bullet, kane, "
    "schaub-junkins, hughes or physics-bold.",
)
@click.option("--lexicon", default="", metavar="FILE", help="Meanings of symbols: a TOML file.")
@click.option(
    "--system",
    metavar="SCENE",
    default=None,
    help="What scalar lines are about: a ready scene, a builtin system, a solid, or a scene file.",
)
@click.option(
    "--code",
    metavar="FILE:FUNCTION",
    default="",
    help="Check code for the rates of --system instead: FILE.py or FILE.c with f(t, y, p).",
)
@click.option(
    "--propose", is_flag=True, help="Print a draft of the note's lexicon as TOML; judge nothing."
)
@click.option(
    "--ask",
    is_flag=True,
    help="Ask what symbols mean that open lines hang on, write NOTE.lexicon.toml, and check with it.",
)
@click.option(
    "--given",
    multiple=True,
    metavar="ASSUMPTION",
    help="Assumed without being said; repeatable, none for nothing.  [default: constant_mass]",
)
@click.option(
    "--only",
    multiple=True,
    metavar="VERDICT",
    help="Print these alone: wrong, ill-formed, undecided, ...; repeatable.",
)
@click.option(
    "--strict", is_flag=True, help="Count as wrong what is so by a meaning that is only a guess."
)
@click.option("-q", "--quiet", is_flag=True, help="Print what is wrong or ill-formed alone.")
@option("json", help="Print all reports as JSON.")
@click.option(
    "--table",
    type=FILE,
    default=None,
    help="Write a row for each note to a file: CSV, or JSON if it ends in .json.",
)
@click.option(
    "--html",
    type=click.Path(path_type=Path),
    default=None,
    help="Write the report as a page: a file, for several notes a folder.",
)
@click.option(
    "--as",
    "kind",
    default="",
    metavar="markdown|latex|notebook|formula",
    help="What standard input or a text is.  [default: what it looks like]",
)
@click.option("--jobs", type=click.IntRange(0), default=0, help="Processes; 0: one a core.")
@click.option(
    "--seconds",
    type=click.FloatRange(0, min_open=True),
    default=10.0,
    show_default=True,
    help="Of processor time, for a formula; what takes longer is undecided.",
)
@click.option(
    "--note-seconds",
    type=click.FloatRange(0, min_open=True),
    default=300.0,
    show_default=True,
    help="Of processor time, for a note.",
)
def check(notes: tuple[str, ...], code: str, propose: bool, ask: bool, **options: Any) -> None:
    r"""Check hand derivations: which line is wrong, which holds, and under which assumptions.

    NOTE is a file (Markdown, LaTeX, notebook), a folder with such files, - for standard input, or a
    formula: eom check '\dot{\vec{H}}_C = \vec{L}_C' --notation arrow-tilde. A word is a file or folder
    if there is one of that name, if it ends in .md, .tex, .ipynb or the like, or if it has none of the
    signs = < > $ and backslash; else it is a formula, or a text with formulas between dollars.

    Meanings of symbols come from --notation or --lexicon; else from the note: a table check in front
    matter between lines of +++, NAME.lexicon.toml, NAME.toml or lexicon.toml beside it; else from a draft
    made of the note's words, which the output says.

    With --code a function for the rates of --system is run apart and compared: f(t, y, p) in Python,
    void f(double t, const double *y, const double *p, double *dy) in C; what is wrong is named by its
    terms.

    With --ask the symbols that most open lines hang on are asked for, one after the other: a number
    chooses one of the meanings shown, other words are a meaning of a lexicon, Enter leaves it open, q ends.
    What was said, with the rest of the draft, becomes NOTE.lexicon.toml.

    A line is unsure, and not wrong, that is wrong by a meaning of the draft which
    neither words nor another line make sure; --strict counts it as wrong.

    Exit status: 0 nothing wrong, 1 a line is wrong or ill-formed, 2 unusable input.
    """
    if bool(notes) == bool(code):
        raise click.UsageError("Missing argument 'NOTE...' (or --code), one of them.")
    if code:
        _code(code, options["system"], options["as_json"])
    if propose:
        _propose(notes, options["kind"])
        return
    settings = _settings(**options)
    if ask:
        from eom.commands.asking import lexicon_asked

        settings = lexicon_asked([_note(word) for word in notes], settings)
    only = _verdicts(options["only"])
    sources = _sources(notes)
    if options["html"] is not None:
        writable(options["html"], "--html", folder=len(sources) > 1)
    graded = _checked(sources, settings, options["jobs"])
    if options["html"] is not None:
        _write_pages(sources, graded, options["html"], options["kind"])
    if options["table"] is not None:
        _write_table(graded, options["table"])
    if options["as_json"]:
        from eom.checker.report.findings import to_json

        click.echo(to_json(graded), nl=False)
    else:
        _print(graded, only, options["quiet"])
    sys.exit(_status(graded))


def _code(target: str, system: str | None, as_json: bool) -> NoReturn:
    """Check code for the rates of a system, print what was found, and end."""
    from eom.commands.code_checking import run

    if system is None:
        raise InputError("code is checked against a system", got=target, expected="--system SCENE")
    text, status = run(target, system, as_json)
    click.echo(text)
    sys.exit(status)


def _settings(
    notation: str,
    lexicon: str,
    given: tuple[str, ...],
    kind: str,
    system: str | None,
    seconds: float,
    note_seconds: float,
    strict: bool,
    **_: Any,
) -> Settings:
    """Return the settings. Raises `InputError` for names that are none."""
    from eom.checker.read.documents import TEXT_KINDS
    from eom.worlds.worlds import closure

    if kind and kind not in TEXT_KINDS:
        raise unknown_name("kind of text", kind, TEXT_KINDS, "--as")
    if "none" in given and len(given) > 1:
        raise InputError("--given none excludes others", got=", ".join(given))
    named = () if given == ("none",) else given
    closure(named)
    from eom.checker.report.findings import GIVEN, Settings  # heavy: after what is refused

    return Settings(
        notation, lexicon, named if given else GIVEN, kind, system, seconds, note_seconds, strict
    )


def _verdicts(only: tuple[str, ...]) -> tuple[str, ...]:
    """Return the verdicts that are printed; words may be joined by hyphens or blanks."""
    from eom.checker.report.findings import ORDER

    known = {v.replace(" ", "-"): v for v in ORDER}
    wanted = [v.replace(" ", "-") for v in only]
    for verdict in wanted:
        if verdict not in known:
            raise unknown_name("verdict", verdict, known, "--only")
    return tuple(known[v] for v in wanted)


# -- checking ------------------------------------------------------------------------------------


def _note(word: str) -> Note:
    """Return the note that an argument stands for; standard input is read."""
    from eom.checker.read.documents import MAX_BYTES, Text, decoded, is_file

    if word != "-":
        text = word.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
        return Path(word) if is_file(word) else Text(text)
    data = sys.stdin.buffer.read(MAX_BYTES + 1)
    return Text(decoded(data, "standard input"), "standard input")


def _sources(words: Sequence[str]) -> list[Note]:
    """Return the notes that are named. Raises `InputError` where there are none."""
    from eom.checker.read.documents import notes_of

    notes = notes_of([_note(word) for word in words])
    if not notes:
        raise InputError("there are no notes here", got=", ".join(words), expected="Markdown, ...")
    return notes


def _checked(notes: Sequence[Note], settings: Settings, jobs: int) -> tuple[Graded, ...]:
    """Return what became of notes: one alone is checked here, many in processes."""
    if len(notes) == 1:
        from eom.checker.note.checking import grade

        with waiting_for("check"):
            return (grade(notes[0], settings),)
    from eom.checker.note.grading import check_notes

    with progress_of("check") as progress:
        return check_notes(notes, settings, jobs, progress)


def _propose(words: Sequence[str], kind: str) -> None:
    """Print the draft of a lexicon. Raises `InputError` for more than one note."""
    from eom.checker.infer.draft import proposed
    from eom.checker.read.documents import document_of, notes_of

    notes = notes_of([_note(word) for word in words])
    if len(notes) != 1:
        raise InputError("a lexicon is proposed for one note", got=f"{len(notes)} notes")
    click.echo(proposed(document_of(notes[0], kind)).toml, nl=False)


def _write_table(graded: Sequence[Graded], file: Path) -> None:
    """Write the table of all notes, whole."""
    from codegen.compiling.compiled import write_files
    from eom.checker.report.findings import to_csv, to_table_json

    as_json = file.suffix.lower() == ".json"
    text = to_table_json(graded) if as_json else to_csv(graded)
    write_files({file.name: text}, file.parent)
    click.echo(f"wrote {printable(file)}", err=True)


def _write_pages(notes: Sequence[Note], graded: Sequence[Graded], path: Path, kind: str) -> None:
    """Write the page of a note, or those of several into a folder with an index, each whole."""
    from codegen.compiling.compiled import write_files
    from eom.checker.read.documents import document_of
    from eom.checker.report.page import index, page

    several = len(notes) > 1
    files = [f"{k}-{Path(g.name).stem}.html" for k, g in enumerate(graded, 1)]
    files = files if several else [path.name]
    texts = {
        file: page(document_of(note, kind), one.report)
        for file, note, one in zip(files, notes, graded, strict=True)
        if one.report is not None
    }
    if several:
        texts["index.html"] = index(list(zip(files, graded, strict=True)))
    if texts:
        write_files(texts, path if several else path.parent)
        click.echo(f"wrote {printable(path / 'index.html' if several else path)}", err=True)


def _status(graded: Sequence[Graded]) -> int:
    """Return the exit status: that of the worst note."""
    found = {g.status for g in graded}
    return UNUSABLE if "unusable" in found else WRONG if "wrong" in found else 0


# -- printing ------------------------------------------------------------------------------------


def _print(graded: Sequence[Graded], only: Sequence[str], quiet: bool) -> None:
    """Print reports, unusable notes to standard error, and how many notes are what."""
    from eom.checker.report.findings import report_lines, total

    for k, one in enumerate(graded):
        for line in report_lines(one, only, quiet):
            _echo(line, err=one.report is None)
        if k + 1 < len(graded):
            click.echo()
    if len(graded) > 1:
        click.echo()
        _echo(total(graded))


def _echo(line: Line, err: bool = False) -> None:
    """Print a line in colours where it goes to a terminal, unless NO_COLOR is set."""
    styled = "".join(click.style(text, **COLOURS.get(style, {})) for style, text in line)
    click.echo(styled, err=err, color=False if os.environ.get("NO_COLOR") else None)
