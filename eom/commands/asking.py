"""Questions to the writer of a note at a terminal: `eom check NOTE --ask`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING

import click

from eom.commands.shared import waiting_for
from eom.errors import InputError, printable

if TYPE_CHECKING:
    from eom.checker.infer.draft import Proposal
    from eom.checker.note.checking import Whole
    from eom.checker.read.documents import Note
    from eom.checker.report.findings import Settings
    from eom.checker.report.questions import Question

MAX_QUESTIONS = 12
END = "q"
"""The answer that ends the questions."""
HOW = (
    "Answer with a number; Enter leaves a symbol open, q ends. Other words are a meaning as a lexicon\n"
    "spells it: scalar q (any number), defined (by the line that has the symbol alone on the left)."
)


def lexicon_asked(notes: Sequence[Note], settings: Settings) -> Settings:
    """Ask what the symbols of a note mean, write its lexicon, and return settings that name it.

    What was left open stays so: a guess is no answer. Where nothing is said nothing is written; what was
    said is written also where the questions are interrupted, which then goes on as `KeyboardInterrupt`.
    Raises `InputError` for more than one note, for what is no file, where there is a lexicon already, and
    where none can be written.
    """
    from codegen.compiling.compiled import write_files
    from eom.checker.note.checking import judged_note

    note = notes[0]
    if len(notes) != 1 or not isinstance(note, Path) or not note.is_file():
        raise InputError("questions are about one file", where="--ask", expected="a note")
    if settings.lexicon or settings.notation:
        raise InputError("what a lexicon or notation says is not asked", where="--ask")
    target = _target(note)
    with waiting_for("check"):
        whole = judged_note(note, settings)
    first = whole.known.draft
    if first is None:
        raise _known(whole.known.origin)
    if not whole.questions:
        click.echo("nothing is open that an answer would decide", err=True)
        return settings
    draft, interrupted = _interview(whole, first)
    if draft is first:
        click.echo("nothing was said: no lexicon is written", err=True)
    else:
        try:
            write_files({target.name: draft.toml}, target.parent)
        except OSError:
            click.echo(draft.toml, err=True)  # what was said is not lost
            raise
        click.echo(f"wrote {printable(target)}", err=True)
        settings = replace(settings, lexicon=str(target))
    if interrupted:
        raise KeyboardInterrupt
    return settings


def _target(note: Path) -> Path:
    """Return where the lexicon of a note goes. Raises `InputError` where it is, or cannot be written."""
    target = note.with_name(f"{note.stem}.lexicon.toml")
    if target.exists() or target.is_symlink():
        raise _known(str(target))
    if not os.access(target.parent, os.W_OK):
        raise InputError(
            "no lexicon can be written beside the note", where="--ask", got=printable(target.parent),
            expected="a folder that can be written to", hint="copy the note to one",
        )  # fmt: skip
    return target


def _known(origin: str) -> InputError:
    return InputError(
        "this note has a lexicon", where="--ask", got=printable(origin),
        hint="change that file, or move it away",
    )  # fmt: skip


def _interview(whole: Whole, draft: Proposal) -> tuple[Proposal, bool]:
    """Return the draft with what was said, of symbols left open without their guesses; whether interrupted.

    It is the same draft where nothing was said. After an answer the questions that are left are put anew.
    """
    from eom.checker.infer import asking

    silent = {q.latex: q for q in whole.questions}
    left = list(whole.questions[:MAX_QUESTIONS])
    click.echo(f"{len(left)} symbol{'s' * (len(left) > 1)} to ask for.\n{HOW}", err=True)
    said, passed, interrupted = draft, set[str](), False
    while left:
        question = left.pop(0)
        passed.add(question.latex)
        try:
            answer = _asked(question, said)
        except KeyboardInterrupt:
            interrupted, answer = True, None
        if answer is None:
            break
        if answer is not said:
            said = answer
            silent.pop(question.latex, None)
            names = {q.latex for q in left} - passed
            again = asking.questions(whole.open, said, whole.held)
            left = [q for q in again if q.latex in names]
    if said is draft:
        return draft, interrupted
    return reduce(asking.left_open, silent.values(), said), interrupted


def _asked(question: Question, draft: Proposal) -> Proposal | None:
    """Return the draft with the answer to a question; None where there are to be no more.

    Raises `KeyboardInterrupt` where it is interrupted.
    """
    click.echo(f"\n{printable(str(question))}", err=True)
    if not question.candidates:
        click.echo("  (nothing that is known here fits)", err=True)
    for number, candidate in enumerate(question.candidates, 1):
        click.echo(f"  {number}  {printable(str(candidate))}", err=True)
    while True:
        try:
            said = click.prompt("  meaning", default="", show_default=False, err=True).strip()
        except click.Abort as end:
            click.echo(err=True)
            if isinstance(end.__context__, KeyboardInterrupt):
                raise KeyboardInterrupt from None
            return None
        if said.lower() == END:
            return None
        if not said:
            return draft
        try:
            return _answered(question, draft, said)
        except InputError as error:
            click.echo(str(error), err=True)


def _answered(question: Question, draft: Proposal, said: str) -> Proposal:
    """Return the draft with a meaning by its number, or in words. Raises `InputError`."""
    from eom.checker.infer.asking import answered
    from eom.checker.mean.lexicon_files import parse_lexicon

    latex, meaning = question.latex, said
    if said.lstrip("+-").isdecimal():
        if not said.isdecimal() or not 0 < int(said) <= len(question.candidates):
            most = len(question.candidates)
            expected = f"1 to {most}" if most else "words: no meanings are shown"
            raise InputError("no such number", got=said, expected=expected)
        chosen = question.candidates[int(said) - 1]
        latex, meaning = chosen.latex, chosen.meaning
    found = answered(draft, latex, meaning)
    parse_lexicon(found.toml)
    return found
