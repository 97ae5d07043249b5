"""A note that is judged true, as a derivation whose lines are verified again; and a derivation as a note.

The note's lines become steps, each under the assumptions that its verdict needs. They are verified anew,
by `eom.Derivation`, so that a derivation rests on nothing that the reader of notes takes for granted.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import Any

import sympy as sp

from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.judge.models import equations
from eom.checker.judge.verdicts import Judged
from eom.checker.mean.claims import DEFINITION
from eom.checker.note.checking import Found, judged_note
from eom.checker.note.derived import front_matter
from eom.checker.read.documents import Document, Piece, note_of
from eom.checker.report.findings import GIVEN, Settings
from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.derivations.forms import show_derivation
from eom.derivations.reached import is_tautology
from eom.errors import InputError, typed
from eom.terms.rules import entrywise
from eom.terms.terms import Equation, Term
from eom.terms.vocabulary import definition
from eom.typeset.letters import ROLES
from eom.typeset.markup import render
from eom.typeset.notation import NOTATIONS, term_box

TRUE = frozenset({HOLDS, UNDER, "definition"})
"""Verdicts on lines that a derivation keeps."""
SILENT = frozenset({"no claim"})
"""Verdicts on displays that say nothing."""
_MARKS = re.compile(r"\*\*\d+\.\*\*|<small>.*?</small>|[*_#]+|\s*—\s*$")
"""What is around a sentence on a page, its number and the remarks of our own pages among it."""


@typed
def to_note(derivation: Derived, notation: str = "arrow") -> str:
    """Return a ``derivation`` as a note in Markdown, with front matter that says what its symbols mean.

    Parameters
    ----------
    derivation : Derived
        What is written down, its steps in order.
    notation : str, default "arrow"
        One of `eom.typeset.notation.NOTATIONS` or its aliases.

    Returns
    -------
    str
        Markdown whose lines `eom check` judges true where its reader knows them; results that are
        no steps, such as a system, are left out.

    Raises
    ------
    InputError
        For other notations, and for a derivation of the places of any masses as functions of
        coordinates (`eom.Derivation.configure`), which no lexicon says.

    Examples
    --------
    >>> from eom import derive
    >>> to_note(derive("tilde-identities")).splitlines()[1]
    '[check]'
    """
    said = replace(derivation, result={})
    return front_matter(said, notation) + show_derivation(said, "markdown", notation)


@typed
def from_note(
    note: str | Path,
    *,
    notation: str = "",
    lexicon: str | Path = "",
    given: Iterable[str] = GIVEN,
    name: str = "",
) -> Derived:
    r"""Return a note that is judged true as a derivation, each line of it verified again.

    Parameters
    ----------
    note : str or path
        As of `eom.check`.
    notation : str, optional
        As of `eom.check`.
    lexicon : str or path, optional
        As of `eom.check`.
    given : iterable of str, optional
        As of `eom.check`: what is assumed throughout.
    name : str, optional
        Of the derivation; where it is left out the first heading, as it is spelt in file names.

    Returns
    -------
    Derived
        Its steps are the lines. Those that only give a letter a meaning are no steps: where the
        letter stands, what it means is shown.

    Raises
    ------
    InputError
        For a note with a line that is not judged true, or that cannot be verified without the note.

    Examples
    --------
    >>> note = r"# Doubled" + "\n\n" + r"$$ \vec H_C + \vec H_C = 2 \vec H_C $$"
    >>> from_note(note, notation="arrow-tilde").steps[0].evidence
    'held in 3 random worlds'
    """
    settings = Settings(notation, str(lexicon), tuple(given))
    whole = judged_note(note_of(note), settings)
    title = _title(whole.document)
    d = Derivation(name or re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-"), title, "Notes")
    _declare(d, whole.found)
    for found in whole.found:
        _keep(d, found, whole.document, settings.given)
    if not d.steps:
        raise InputError("no line of this note can be kept", where=whole.document.name)
    return d.finish()


def _declare(d: Derivation, found: Iterable[Found]) -> None:
    """Let the derivation have what the note declares to move."""
    claims = (j.claim for f in found for j in f.verdict.claims)
    moving = next((c.moving for c in claims if c.moving is not None), None)
    if moving is not None:
        for symbol, meaning in moving.scalars.items():
            d.name_scalar(symbol, meaning, "letter of the note")
        d.own = moving.own.copy()


def _title(document: Document) -> str:
    """Return the first heading, the name of the file where there is none."""
    heading = next((p for p in document.pieces if p.kind == "heading"), None)
    return _sentence(heading.body) if heading is not None else Path(document.name).stem


def _keep(d: Derivation, found: Found, document: Document, given: tuple[str, ...]) -> None:
    """Add the steps that a formula says. Raises `InputError` where they are not true."""
    finding = found.finding
    where = f"{document.name}, line {finding.line}"
    if finding.kind != "display" or finding.verdict in SILENT:
        return
    if finding.verdict not in TRUE:
        raise InputError(
            f"a line that is not judged true is no step of a derivation: {finding.verdict}",
            where=where,
            got=finding.latex,
            hint=finding.reason,
        )
    words = _reason(document, found.understood.formula.piece)
    for judged in found.verdict.claims:
        assumed = _assumed(judged, given, found)
        try:
            d.only(*assumed)
            known = {m: s for s, m in d.scalars.items()}
            rows = judged.claim.scalars.items()
            spelt = {s: known.get(m) or _spelt(s, m) for s, m in rows}
            with_names = entrywise(partial(_renamed, spelt))
            for symbol, meaning in rows:
                if spelt[symbol] not in d.scalars:
                    d.name_scalar(spelt[symbol], with_names(meaning), "letter of the note")
            for s in _said(judged):
                statement = Equation(with_names(s.left), with_names(s.right), s.relation)
                if is_tautology(statement) or statement in d.stated:
                    continue  # a letter by what it means; the order of factors alone is another
                d.state(statement, words or f"line {finding.line} of the note")
        except InputError as error:
            raise InputError(
                "this line cannot be verified without the note",
                where=where,
                got=finding.latex,
                hint=f"{error.what} {error.got}".strip(),
            ) from error


def _renamed(names: Mapping[Any, Any], e: Any) -> Any:
    return e.xreplace(names)


_LETTER = re.compile(r"\\?([A-Za-z]+)(?:_\{?(\w+)\}?)?")


def _spelt(symbol: Any, meaning: Term) -> Any:
    """Return a symbol for a meaning with the letter that this is written with; else without odd signs."""
    if symbol.name.removesuffix("_dot").isalnum() or not _has_letter(meaning):
        return symbol
    letter = _LETTER.fullmatch(render(term_box(meaning, NOTATIONS["arrow"]), "latex"))
    plain = re.sub(r"[\W_]+", "", symbol.name)
    name = "_".join(filter(None, letter.groups())) if letter is not None else plain
    return sp.Symbol(name, real=True)


def _has_letter(meaning: Term) -> bool:
    """Return whether pages have a letter for a quantity; they have none for those of a note's system."""
    return meaning.head != "atom" or meaning.data[0] in ROLES


def _assumed(judged: Judged, given: tuple[str, ...], found: Found) -> tuple[str, ...]:
    """Return what a line is true under: what is given, and the smallest set that it needs."""
    sets = judged.judgement.sets
    own = (*given, *found.understood.lexicon.assume)
    return tuple(dict.fromkeys([*own, *judged.judgement.context, *(sets[0] if sets else ())]))


def _said(judged: Judged) -> Iterator[Equation]:
    """Yield what a line says: a definition of the vocabulary, or equations, each of the first member."""
    claim = judged.claim
    if claim.relations == (">=",) and claim.members[1].is_zero:
        yield Equation(claim.members[0].term, claim.members[1].term, ">=")
        return
    links = equations(claim)
    first = links[0].left if links else None
    for k, link in enumerate(links):
        defines = k == 0 and claim.kind != DEFINITION and link.left.head == "atom"
        if defines and definition(link.left) == link.right:
            yield Equation(link.left, link.right, ":=")
        elif first is not None and first.kind == link.right.kind:
            yield Equation(first, link.right)
        else:
            yield link


def _reason(document: Document, formula: Piece) -> str:
    """Return the words in front of a formula: its sentence, as far as they are on its own lines."""
    before = document.pieces[: document.pieces.index(formula)]
    near = takewhile(lambda p: p.kind != "display", reversed(before))
    prose = next((p for p in near if p.kind in {"prose", "heading"}), None)
    lines = [_sentence(line) for line in prose.body.splitlines()] if prose is not None else []
    return next((line for line in reversed(lines) if re.search(r"\w", line)), "")


def _sentence(text: str) -> str:
    return re.sub(r"\s+", " ", _MARKS.sub(" ", text)).strip(" :.—")
