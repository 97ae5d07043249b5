"""Where the meanings of a note's symbols come from: a preset, a file, the note itself, or a draft."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import (
    lexicon_found,
    lexicon_of,
    lexicon_text,
    parse_lexicon,
    preset,
)
from eom.checker.mean.propose import Proposal, propose
from eom.checker.read.documents import Document
from eom.checker.read.front import in_yaml
from eom.errors import InputError
from eom.limits import Overdue

DRAFT = "draft"


@dataclass(frozen=True)
class Meanings:
    """A lexicon, where it comes from in words, and the draft if it is one."""

    lexicon: Lexicon
    origin: str
    draft: Proposal | None = None


def meanings(
    document: Document, path: Path | None = None, notation: str = "", lexicon: str = ""
) -> Meanings:
    """Return the meanings of a note's symbols: what is asked for, else what the note says, else a draft.

    ``path``: where the note stands; ``notation``: a preset; ``lexicon``: a TOML file. Raises `InputError`
    for those that cannot be used.
    """
    if notation and lexicon:
        raise InputError(
            "a notation and a lexicon exclude each other", hint="a lexicon may name its preset"
        )
    if notation:
        return Meanings(preset(notation), f"preset {notation}")
    if lexicon:
        return Meanings(
            parse_lexicon(lexicon_text(Path(lexicon)), lexicon, Path(lexicon).parent), lexicon
        )
    found = lexicon_found(_front(document), path)
    if found is not None:
        return Meanings(found[1], found[0])
    return _drafted(document)


def _front(document: Document) -> str:
    """Return the front matter as the head of a note, if a table of it is meant for the checker."""
    if in_yaml(document.front):
        return f"---\n{document.front}\n---\n"
    toml = any(line.strip().startswith(("[check", "check")) for line in document.front.splitlines())
    return f"+++\n{document.front}\n+++\n" if toml else ""


def _drafted(document: Document) -> Meanings:
    """Return the draft of the lexicon; entries that cannot be used are left out."""
    proposal = proposed(document)
    data: dict[str, dict[str, str]] = {}
    for draft in proposal.drafts:
        data.setdefault(draft.table, {})[draft.latex] = draft.meaning
    lexicon, _ = lexicon_of({"preset": proposal.preset, **data}, DRAFT)
    return Meanings(lexicon, f"{DRAFT} on preset {proposal.preset}", proposal)


def proposed(document: Document) -> Proposal:
    """Return the draft of a lexicon. Raises `InputError` for a note that takes too long."""
    try:
        return propose(document)
    except (Overdue, RecursionError):
        raise InputError(
            "no notation can be proposed for this note in time",
            where=document.name,
            hint="name one: --notation",
        ) from None
