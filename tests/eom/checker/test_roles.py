"""The role of a formula by the words around it, and what it does to the verdict."""

import json

import pytest

from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import verdict
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.mean.roles import ASSUMPTION, CLAIM, DEFINITION, INTRODUCED, RECALLED, roles
from eom.checker.read.documents import read_document

SENTENCES = {
    ASSUMPTION: [
        "If $x = 0$, all is well.",
        "The spin is constant even if the torque about the axis is $x = 0$.",
        "We assume that $x = 0$.",
        "Assume: $x = 0$. Then",
        "Suppose the initial value of $y$ is $x = 0$.",
        "It is stable provided $x = 0$",
        "This vanishes for all $x \\neq 0$",
        "Consider the special case of $x = 0$ (for which $y$ is free).",
        "The rate is constant only if the body turns about one axis. (eg. $x = 0$ )",
        "It vanishes if the point is fixed (in which case $x = 0$), and",
        "It is free when the body is at rest, or if\n$x = 0$.",
        "Here $x = 0$ is assumed.",
    ],
    DEFINITION: [
        "where $x = y$ is the mass",
        "Here we define the total mass $x = y$.",
        "With $x = y$, we have",
        "We call this product $x = y$.",
        "It is measured from the point, such that $x = y$.",
    ],
    INTRODUCED: ["The energy is given by $x = y$", "which is provided by $x = y$,"],
    RECALLED: ["Because $x = y$", "B/c $x = y$", "Noting that $x = y$ from above", "using $x = y$"],
    CLAIM: [
        "$x = y$",
        "The body is rigid: $x = y$",
        "If the body is at rest, $x = y$.",
        "If the body is rigid then $x = y$.",
        "When it turns about one axis we have $x = y$.",
        "For a rigid body $x = y$.",
        "In other words, $x = y$ if the torque is zero.",
        "It is symmetric ($x = y$)",
        "An example (e.g. $x = y$) helps.",
        "the case of one mass (for which $x = y$)",
        "where all is known.\n\n$x = y$",
        "Assume it. The result is $x = y$.",
        "It is, as the angle is small, $x = y$",
    ],
}


def role_of(text):
    """The roles of the formulas of a sentence that relate something."""
    pieces = read_document("Before it, if any.\n\n" + text).pieces
    found = zip(roles(pieces), pieces, strict=True)
    return [r for r, p in found if "=" in p.body or "neq" in p.body]


@pytest.mark.parametrize("role", SENTENCES)
def test_the_words_around_a_formula_settle_its_role(role):
    assert {text: role_of(text) for text in SENTENCES[role] if role_of(text) != [role]} == {}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("If $x = 0$ and $y = 0$, then $z = 0$ and $w = 0$.", "aacc"),
        ("Let $x = 0$, $y = 1$, and $z = 2$.", "aaa"),
        ("Using $x = y$, $y = z$, and $z = w$, we find $x = w$.", "rrrc"),
        ("If $x = 0$, $y = 0$.", "ac"),
        ("If $x = 0$ (in which case $y = 0$), or if $z = 0$", "aca"),
        ("where $x = y$ is the mass, and the motion is free, thus $z = 0$", "dc"),
    ],
)
def test_lists_share_a_role(text, expected):
    document = read_document(text)
    found = roles(document.pieces)
    kinds = zip(found, document.pieces, strict=True)
    assert "".join(r[0] for r, p in kinds if p.is_formula) == expected


def test_cells_of_a_notebook_are_apart():
    texts = ("What if", "$x = 0$")
    cells = json.dumps({"cells": [{"cell_type": "markdown", "source": s} for s in texts]})
    assert set(roles(read_document(cells, "notebook").pieces)) == {CLAIM}


LEXICON = r"""
preset = 'arrow-tilde'
[symbols]
'\vec a' = 'vector a'
'\vec b' = 'vector b'
'\vec f_{<i><j>}' = 'internal_force <i> <j>'
'm' = 'total_mass system'
"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (r"It is \omega: $\omega_2 = \omega_3 = 0$.", "wrong"),
        (r"if $\omega_2 = \omega_3 = 0$", "assumption"),
        (r"for all $\vec a \neq \vec 0$", "assumption"),
        (r"if $\vec a = \vec a\cdot\vec b$", "ill-formed"),
        (r"if $\vec a = \vec q$", "undecided"),
        (r"where $m = \sum_{i=1}^N m_i$", "definition"),
        (r"where $m = 2\sum_{i=1}^N m_i$", "wrong"),
        (r"noting that $\vec f_{ij} = -\vec f_{ji}$", "assumption"),
        (r"So $\vec f_{ij} = -\vec f_{ji}$", "holds under"),
        (r"noting that $\vec a\times\vec b = -\vec b\times\vec a$", "holds"),
        (r"noting that $\vec a\times\vec b = \vec b\times\vec a$", "wrong"),
        # true under its condition, of which worlds know nothing
        (
            r"$\vec a\times\vec b = \vec b\times\vec a \quad\text{if}\quad \vec a = \vec b$",
            "undecided",
        ),
        (r"$\vec a\cdot\vec b = \vec b\cdot\vec a \quad\text{if}\quad \vec a = \vec b$", "holds"),
        (r"The vector $\vec a$", "no claim"),
        (r"$\vec a = {$", "undecided"),
    ],
)
def test_an_assumption_is_not_called_wrong_and_a_wrong_definition_is(text, expected):
    (found,) = understand(read_document(text), parse_lexicon(LEXICON))
    assert verdict(found).verdict == expected


DISPLAYS = {
    ASSUMPTION: [
        "Suppose that\n\n$$x = 0$$",
        "Assume:\n$$x = 0$$",
        "Let\n$$x = 0$$",
        "Now suppose the torque on the body is\n\n$$x = -k y$$",
        "It stays so, provided that\n$$x = 0$$",
    ],
    CLAIM: [
        "Assuming principal axes:\n\n$$x = y$$",
        "Assuming $z = 0$ we have\n\n$$x = y$$",
        "Suppose the body is symmetric, so that\n$$x = y$$",
        "If the body is rigid,\n$$x = y$$",
        "If $[I]$ is diagonal (principal coordinates):\n\n$$x = y$$",
        "Assume it.\n\nWe get\n\n$$x = y$$",
        "For a rigid body\n$$x = y$$",
        "where\n$$x = y$$",
        "Suppose that $z = 0$. Then\n\n$$x = y$$",
    ],
}


@pytest.mark.parametrize(("role", "text"), [(r, t) for r, ts in DISPLAYS.items() for t in ts])
def test_the_words_right_in_front_of_a_display_settle_its_role(role, text):
    document = read_document("Before it, if any.\n\n" + text)
    found = dict(zip((p.kind for p in document.pieces), roles(document.pieces), strict=True))
    assert found["display"] == role


def test_a_display_goes_on_with_the_assumption_before():
    document = read_document("Suppose\n\n$$x = 0$$\n\nand\n\n$$y = 0$$\n\nThen\n\n$$z = 0$$\n")
    found = zip(document.pieces, roles(document.pieces), strict=True)
    assert [r for p, r in found if p.kind == "display"] == [ASSUMPTION, ASSUMPTION, CLAIM]
