"""Chains: which member is to blame, and what the links and the two ends say."""

import pytest

from eom.checker.judge.judge import HOLDS, UNDER, WRONG
from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import judge_chain, verdict
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document

LEXICON = parse_lexicon(
    r"""
preset = 'arrow-tilde'
[symbols]
'\vec a' = 'vector a'
'\vec b' = 'vector b'
'\vec c' = 'vector c'
'\vec d' = 'defined'
"""
)
AB, BA = r"\vec a\times\vec b", r"\vec b\times\vec a"
AB_, BA_ = f"-{AB}", f"-{BA}"

CASES = {
    "the middle": ((AB, BA, BA_), [WRONG, WRONG], HOLDS, [1]),
    "the last": ((AB, BA_, BA), [HOLDS, WRONG], WRONG, [2]),
    "two that agree": ((AB, BA, AB_, BA_), [WRONG, HOLDS, WRONG], HOLDS, [1, 2]),
    "carried on": ((AB, BA, AB_), [WRONG, HOLDS], WRONG, [1, 2]),
    "ill-formed middle": ((AB, r"\vec a\cdot\vec b", BA_), [], HOLDS, [1]),
    "ill-formed end": ((AB, BA_, r"\vec a\cdot\vec b"), [HOLDS], None, [2]),
    "none": ((AB, BA_, AB), [HOLDS, HOLDS], HOLDS, []),
    "with an assumption": (
        (r"\vec H_C", r"[I]\vec\omega", r"\vec\omega[I]", r"[I]\vec\omega"),
        None,
        UNDER,
        [2],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_member_to_blame(name):
    members, links, ends, blamed = CASES[name]
    text = " = ".join(members)
    (claim,) = understand(read_document(text, "formula"), LEXICON)[0].claims
    found = judge_chain(claim)
    if links is not None:
        assert [j.verdict for _, _, j in found.links] == links
    assert (found.ends and found.ends.verdict) == ends
    places = [sum(len(m) + 3 for m in members[:k]) for k in range(len(members))]
    numbers = [sum(p <= span.start for p in places) - 1 for span in found.blamed]
    assert numbers == blamed


def test_a_definition_and_a_continued_chain():
    note = f"$$\\vec d = {AB} = {BA} = {BA_}$$\n$$= {BA} = {AB}$$"
    first, second = understand(read_document(note), LEXICON)
    found = verdict(first).claims[0].chain
    assert (found.ends.verdict, len(found.links), len(found.blamed)) == (HOLDS, 2, 1)
    assert first.formula.piece.source.text[slice(*found.blamed[0])] == BA
    found = verdict(second).claims[0].chain
    assert ([j.verdict for _, _, j in found.links], found.ends.verdict) == ([WRONG, WRONG], HOLDS)
    assert second.formula.piece.source.text[slice(*found.blamed[0])] == BA


def test_a_single_equation_is_no_chain():
    (single,) = understand(read_document(f"{AB} = {BA}", "formula"), LEXICON)
    assert judge_chain(single.claims[0]) is None
    assert verdict(single).claims[0].chain is None
