"""Each display of the lectures, read from LaTeX, is stated by the steps with its tag; its edits are not."""

from collections import Counter
from dataclasses import replace

import pytest

from eom.derivations import derive
from eom.derivations.corrections import CLAIMS, NOTES
from eom.derivations.forms import show_derivation
from eom.derivations.lectures import DISPLAYS, NO_EQUATION, equation_map
from eom.terms.terms import Term, add, mul, number
from eom.typeset.boxes import GREEK_NAMES
from tests.eom.derivations.statements import is_stated, links, same, sides_of

LECTURES = list(DISPLAYS)


@pytest.fixture(scope="module")
def steps():
    """The sides of the steps of each display, by its identifier."""
    return {
        i: [sides_of(derive(name), derive(name)[label]) for name, label in entry.steps]
        for i, entry in equation_map().items()
    }


@pytest.mark.parametrize("lecture", LECTURES)
def test_every_display_is_stated(lecture, steps):
    count, found = links(lecture)
    assert count == DISPLAYS[lecture]
    assert [link.display for link in found if not is_stated(link, steps[link.display])] == []
    named = {f"{lecture}:E{k}" for k in range(1, count + 1)} - set(NO_EQUATION)
    assert {link.display for link in found} == named


@pytest.mark.parametrize("lecture", LECTURES)
def test_an_edited_display_is_not_stated(lecture, steps):
    """The right side with its sign changed, doubled, and with something added."""
    missed, counted = [], Counter()
    for link in links(lecture)[1]:
        for what, edit in EDITS.items():
            right = replace(link.right, term=edit(link.right.term))
            said = same(link.right, right) or same(link.left, right)
            if said or link.left.term.is_zero:  # nothing is also twice nothing
                continue
            counted[what] += 1
            if is_stated(replace(link, right=right), steps[link.display]):
                missed.append((link.display, what))
    assert missed == []
    assert min(counted.values()) > 10


def _more(term):
    """A side with itself and a number, a vector or a matrix that has nothing to do with it."""
    extra = {
        "scalar": Term("atom", (), ("scalar", "any other"), "scalar"),
        "vector": Term("atom", (), ("vector", "any other"), "vector"),
    }.get(term.kind)
    return mul(number(3), term) if extra is None else add(term, extra)


EDITS = {
    "sign": lambda term: -term,
    "double": lambda term: mul(number(2), term),
    "more": _more,
}


def test_steps_of_other_displays_do_not_state_a_display(steps):
    """Labels are not what is compared: with the steps of the display before, few are stated."""
    found = links("002")[1]
    others = [f"002:E{k}" for k in range(1, 40)]
    before = dict(zip(others[1:], others, strict=False))
    stated = [k for k in found if k.display in before and is_stated(k, steps[before[k.display]])]
    assert len(stated) < 0.2 * len(found)


@pytest.mark.parametrize("what", [NOTES, CLAIMS], ids=["displays", "claims"])
def test_reasons_of_corrections_are_printed(what):
    printed = {}
    for identifier, entry in equation_map().items():
        for name, _ in entry.steps if identifier in what else ():
            if name not in printed:
                printed[name] = " ".join(show_derivation(derive(name)).split())
    missing = [
        i
        for i, note in what.items()
        if not any(_in(note, printed[name]) for name, _ in equation_map()[i].steps)
    ]
    assert missing == []


def _in(note, page):
    """Whether the words of a note stand on a page; letters are set as mathematics there."""
    spoken = (w for w in note.replace(",", " ").split() if w not in GREEK_NAMES)
    words = [w for w in spoken if w.isalpha() and len(w) > 3]
    return sum(w in page for w in words) > 0.9 * len(words) and " ".join(words[-2:-1]) in page
