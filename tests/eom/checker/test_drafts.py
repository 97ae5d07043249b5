"""Drafts and questions of every kept note: valid TOML, the same meanings when read back."""

import tomllib
from pathlib import Path

import pytest

from eom.checker.infer.asking import answered, left_open
from eom.checker.infer.draft import meanings
from eom.checker.infer.shown import operands_of
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.note.checking import judged_document
from eom.checker.read.documents import KINDS, load
from eom.checker.read.statements import read
from eom.checker.report.findings import Settings

SETS = Path(__file__).parents[3] / "benchmarks" / "notes"
NOTES = sorted(
    path
    for name in ("first", "second", "third", "fourth", "fifth", "sixth", "seventh")
    for path in (SETS / name).iterdir()
    if path.suffix in KINDS and path.suffix != ".py"
)
QUICK = NOTES[:1]
SHOWN = 3
"""Questions of a note, and candidates of each, that are answered."""


def said(lexicon, formulas):
    """Return what the symbols of formulas mean, what parts say, and which systems there are."""
    looks = {k for f in formulas for k in operands_of(f, lexicon)}
    found = {k: lexicon.find(k) for k in looks}
    scopes = [
        (s.heading, [(e.latex, e.meaning) for e in s.entries], bool(s.system))
        for s in lexicon.scopes
    ]
    return (
        {k: f.meaning for k, f in found.items() if f is not None},
        lexicon.frames,
        lexicon.points,
        lexicon.notation.marks,
        scopes,
        lexicon.system is not None,
    )


def kept(draft):
    """Return the lexicon that a draft is when it is written down and read again."""
    tomllib.loads(draft.toml)
    return parse_lexicon(draft.toml)


@pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=() if p in QUICK else pytest.mark.slow) for p in NOTES],
    ids=lambda p: f"{p.parent.name}-{p.stem}",
)
def test_a_draft_is_read_back_to_the_same_meanings_and_so_are_answers(path):
    document = load(path)
    formulas = read(document)
    known = meanings(document)
    assert known.draft is not None
    assert said(kept(known.draft), formulas) == said(known.lexicon, formulas)
    asked = judged_document(document, Settings()).questions
    hanging = [len(q.lines) for q in asked]
    assert hanging == sorted(hanging, reverse=True)
    for question in asked[:SHOWN]:
        assert question.lines
        for one in question.candidates[:SHOWN]:
            lexicon = kept(answered(known.draft, one.latex, one.meaning))
            assert lexicon.layers
        kept(left_open(known.draft, question))
