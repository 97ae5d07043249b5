"""Questions to the writer of a note at a terminal: `eom check NOTE --ask`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING

import click

from eom.errors import InputError, printable

if TYPE_CHECKING:
    from eom.checker.infer.draft import Proposal
    from eom.checker.read.documents import Note
    from eom.checker.report.findings import Settings
    from eom.checker.report.questions import Question

MAX_QUESTIONS = 12
END = "q"
"""The answer that ends the questions."""


def lexicon_asked(notes: Sequence[Note], settings: Settings) -> Settings:
    """Ask what the symbols of a note mean, write its lexicon, and return settings that name it.

    What was left open stays so: a guess is no answer. Where nothing is said nothing is written. Raises
    `InputError` for more than one note, for what is no file, and where there is a lexicon already.
    """
    from codegen.compiling.compiled import write_files
    from eom.checker.infer.draft import proposed
    from eom.checker.note.checking import check_note
    from eom.checker.read.documents import document_of

    note = notes[0]
    if len(notes) != 1 or not isinstance(note, Path) or not note.is_file():
        raise InputError("questions are about one file", where="--ask", expected="a note")
    if settings.lexicon or settings.notation:
        raise InputError("what a lexicon or notation says is not asked", where="--ask")
    target = note.with_name(f"{note.stem}.lexicon.toml")
    report = check_note(note, settings)
    if target.exists() or not report.lexicon.startswith("draft"):
        raise InputError(
            "this note has a lexicon", where="--ask", got=printable(report.lexicon),
            hint="change that file, or move it away",
        )  # fmt: skip
    first = proposed(document_of(note, settings.kind))
    draft = _interview(report.questions[:MAX_QUESTIONS], first)
    if draft is first:
        click.echo("nothing was said: no lexicon is written", err=True)
        return settings
    write_files({target.name: draft.toml}, target.parent)
    click.echo(f"wrote {printable(target)}", err=True)
    return replace(settings, lexicon=str(target))


def _interview(questions: Sequence[Question], draft: Proposal) -> Proposal:
    """Return the draft with what was said; of symbols left open, without their guesses.

    It is the same draft where nothing was said.
    """
    from eom.checker.infer.asking import left_open

    said, silent = draft, list(questions)
    for question in questions:
        answer = _asked(question, said)
        if answer is None:
            break
        if answer is not said:
            silent.remove(question)
        said = answer
    return draft if said is draft else reduce(left_open, silent, said)


def _asked(question: Question, draft: Proposal) -> Proposal | None:
    """Return the draft with the answer to a question; None where there are to be no more."""
    click.echo(str(question))
    for number, candidate in enumerate(question.candidates, 1):
        click.echo(f"  {number}  {candidate}")
    while True:
        try:
            said = click.prompt("  meaning", default="", show_default=False).strip()
        except click.Abort:
            return None
        if said == END:
            return None
        if not said:
            return draft
        try:
            return _answered(question, draft, said)
        except InputError as error:
            click.echo(str(error))


def _answered(question: Question, draft: Proposal, said: str) -> Proposal:
    """Return the draft with a meaning by its number, or in words. Raises `InputError`."""
    from eom.checker.infer.asking import answered
    from eom.checker.mean.lexicon_files import parse_lexicon

    latex, meaning = question.latex, said
    if said.isdecimal():
        if not 0 < int(said) <= len(question.candidates):
            raise InputError(
                "no such number", got=said, expected=f"1 to {len(question.candidates)}"
            )
        chosen = question.candidates[int(said) - 1]
        latex, meaning = chosen.latex, chosen.meaning
    found = answered(draft, latex, meaning)
    parse_lexicon(found.toml)
    return found
