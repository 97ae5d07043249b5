"""What is checked: files, the notes of a folder, texts, single formulas."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from eom.checker.read.documents import KINDS, Document, load, read_document
from eom.checker.read.places import printable
from eom.errors import InputError

TEXT_KINDS = ("markdown", "latex", "notebook", "formula")
"""What a text that is no file may be."""
MAX_FILES = 100_000
MAX_NAME = 4096


@dataclass(frozen=True)
class Text:
    """A text that is no file, with a name for messages."""

    text: str
    name: str = ""


Note = Path | Text

_SIGNS = re.compile(r"[=<>\\$]")
_DOLLARS = re.compile(r"\$|\\\(|\\\[|\\begin\{(?:equation|align|gather|multline|eqnarray|math)|\n")
_LATEX = re.compile(r"\\documentclass|\\begin\s*\{document\}")
_NOTEBOOK = re.compile(r'\s*\{.*"cells"\s*:', re.DOTALL)


def is_file(word: str) -> bool:
    """Tell whether a word names a file or folder rather than a formula.

    It does if there is one of this name, if it ends in a suffix of `KINDS`, and if it has none of the
    signs = < > $ and backslash.
    """
    if "\n" in word or "\0" in word or len(word) > MAX_NAME:
        return False
    path = Path(word)
    try:
        there = path.exists()
    except OSError:
        there = False
    return there or path.suffix.lower() in KINDS or not _SIGNS.search(word)


def note_of(note: str | Path) -> Note:
    """Return the note that a word, a text or a path stands for."""
    return Path(note) if isinstance(note, Path) or is_file(note) else Text(note)


def notes_of(notes: Iterable[Note]) -> list[Note]:
    """Return notes with the files of folders in place of the folders, in order."""
    return [n for note in notes for n in (_files(note) if isinstance(note, Path) else [note])]


def _files(path: Path) -> list[Note]:
    """Return a file itself, or the notes of a folder and its folders.

    Hidden ones and links that lead out of the folder are left out. Raises `InputError` for a folder
    with too many.
    """
    if not path.is_dir():
        return [path]
    found: list[Note] = []
    root = path.resolve()
    for folder, folders, names in os.walk(path):
        folders[:] = sorted(f for f in folders if not f.startswith("."))
        own = (Path(folder) / n for n in sorted(names) if not n.startswith("."))
        found += [p for p in own if p.suffix.lower() in KINDS and _inside(p, root)]
        if len(found) > MAX_FILES:
            raise InputError("too many files", where=str(path), expected=f"at most {MAX_FILES}")
    return found


def _inside(path: Path, root: Path) -> bool:
    return path.is_file() and (not path.is_symlink() or path.resolve().is_relative_to(root))


def document_of(note: Note, kind: str = "") -> Document:
    """Return a note in pieces; ``kind``: of a text, "" for what it looks like. Raises `InputError`."""
    if isinstance(note, Path):
        if not note.is_file():
            raise _no_file(note)
        return load(note)
    kind = kind or looks_like(note.text)
    text = note.text.strip("\n") if kind == "formula" else note.text
    return read_document(text, kind, name_of(note))


def _no_file(path: Path) -> InputError:
    if path.exists():
        return InputError("this is not a file", where=printable(str(path)))
    hint = "a formula has one of the signs = < > $ and backslash"
    return InputError("no such file or folder", where=printable(str(path)), hint=hint)


def name_of(note: Note) -> str:
    """Return the name of a note for messages."""
    return str(note) if isinstance(note, Path) else note.name or _called(note.text)


def _called(text: str) -> str:
    return "formula" if looks_like(text) == "formula" else "text"


def looks_like(text: str) -> str:
    """Return the kind of a text: a notebook, a LaTeX document, a note with formulas, one formula."""
    text = text.strip("\n")
    for pattern, kind in ((_NOTEBOOK, "notebook"), (_LATEX, "latex"), (_DOLLARS, "markdown")):
        if (pattern.match if kind == "notebook" else pattern.search)(text):
            return kind
    return "formula"
