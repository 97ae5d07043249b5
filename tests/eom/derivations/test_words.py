"""Words of derivations: each letter in them is one of the page, with the marks that formulas have."""

import re
from dataclasses import replace

import pytest

from eom.derivations import derive
from eom.derivations.showing import blocks, symbols
from eom.derivations.wording import (
    factors,
    letters_in_words,
    nameable,
    named,
    notation_of,
    terms_of,
)
from eom.terms.terms import SCALAR, VECTOR, der, nodes
from eom.terms.vocabulary import quantity
from eom.typeset.blocks import Bullets, Heading, Steps
from eom.typeset.boxes import Fence, Form, Operator, Row, Scripts, Sign, Symbol
from eom.typeset.markup import render
from eom.typeset.notation import NOTATIONS, notation_named, term_box
from tests.eom.rows import derivations

EVERYWHERE = frozenset({"t", r"\mathrm{d}m", r"\pi", "i", "j"})
"""Time, an element of mass, a number, and the particles of which assumptions speak."""
LONE = re.compile(r"(?<![\w'-])(?:[B-HJ-Zb-ce-z]|[A-Za-z]_\w+)(?![\w'-])")
"""A letter that is left as a word; a and A are articles, I may be, and d stands in d/dt."""
POWER = re.compile(r"-?\d|\\mathrm\{T\}")


def tex(box):
    return render(box, "latex")


def listed(derivation, notation):
    """Return the letters that a page lists, its frames and points, and the rates of its quantities."""
    found = set(map(tex, factors(notation).values())) | EVERYWHERE
    for box, _ in symbols(derivation, notation):
        sides = box.items[::2] if isinstance(box, Row) and Operator(":=") in box.items else (box,)
        found |= set(map(tex, sides))
    found |= {tex(one.box) for one in named(derivation, notation)}
    own = [t for t in derivation.letters if not hasattr(t, "name")]
    spoken = [*terms_of(derivation), *derivation.scalars.values(), *own]
    for n in {m for t in spoken for m in nodes(t) if m.head in {"atom", "column", "der"}}:
        rates = [der(n), der(der(n))] if n.kind in {SCALAR, VECTOR} else []
        found |= {tex(term_box(one, notation)) for one in (n, *rates)}
        found |= set("ijkn").intersection(map(str, n.data))
    return found


def strangers(box, letters):
    """Yield the letters within a box that are none of the page."""
    if tex(box) in letters or isinstance(box, Operator | Sign):
        return
    if isinstance(box, Scripts) and box.sup is not None and POWER.fullmatch(tex(box.sup)):
        bare = replace(box, sup=None)
        yield from strangers(bare if bare.sub or bare.left else bare.base, letters)
    elif isinstance(box, Row | Form | Fence):
        parts = {Row: "items", Form: "parts"}.get(type(box))
        for part in getattr(box, parts) if parts else (box.inner,):
            yield from strangers(part, letters)
    elif not (isinstance(box, Symbol) and box.name.isdigit()):
        yield tex(box)


def said(derivation, notation):
    """Yield what words there are on a page, as words and formulas in turn, up to its result."""
    for block in blocks(derivation, notation):
        if isinstance(block, Heading) and block.words == "Result":
            return
        if isinstance(block, Heading):
            yield (block.words,)
        elif isinstance(block, Bullets):
            yield from (words for _, words in block.items)
        elif isinstance(block, Steps):
            yield from (w for n in block.notes for w in (n.reason, n.remarks, n.assumed))


def at_fault(derivation, notation):
    letters = listed(derivation, notation)
    for words in said(derivation, notation):
        for part in (words,) if isinstance(words, str) else words:
            found = LONE.findall(part) if isinstance(part, str) else strangers(part, letters)
            yield from ((letter, words) for letter in found)


@pytest.mark.parametrize("name", derivations())
def test_letters_in_words_are_letters_of_the_page(name):
    derivation = derive(name)
    for notation in NOTATIONS:
        chosen = notation_of(derivation, notation_named(notation))
        assert not list(at_fault(derivation, chosen))


@pytest.mark.parametrize(
    ("words", "letter"),
    [
        ("with K.omega", "K"),
        ("the rate of u", "u"),
        ("an arrow that formulas lack: rho'' + F_2", "F_{2}"),
    ],
)
def test_letters_that_a_page_does_not_have_are_found(words, letter):
    derivation = derive("euler-equations")
    first, *others = derivation.steps
    changed = replace(derivation, steps=(replace(first, reason=words), *others))
    found = at_fault(changed, notation_named("underline"))
    assert letter in {f for f, _ in found}


def test_a_name_for_two_quantities_is_one_for_neither():
    one, two = nameable(derive("kinetic-energy")), nameable(derive("euler-equations"))
    assert one["h"] == one["h_C"] == quantity("angular_momentum", "body", "C")
    assert "h" not in two
    assert "J" not in two
    assert two["h_O"] == quantity("angular_momentum", "body", "O")


@pytest.mark.parametrize(
    ("notation", "rate", "column", "zero", "unit"),
    [
        ("arrow", "H⃗̇_C", "[H⃗_C]_B", "0⃗", "[1]"),
        ("underline", "h̲_•^•", "h_•", "0̲", "1"),
    ],
)
def test_what_is_made_of_a_quantity_has_its_marks(notation, rate, column, zero, unit):
    chosen = notation_named(notation)
    known = letters_in_words(derive("euler-equations"), chosen)
    shown = {n: render(known[n], "text") for n in ("h_C'", "[h_C]_B", "omega = 0")}
    assert shown == {"h_C'": rate, "[h_C]_B": column, "omega = 0": zero}
    turned = letters_in_words(derive("inertia-properties"), chosen)
    assert render(turned["C_BA = 1"], "text") == unit


@pytest.mark.parametrize(
    ("name", "row"),
    [
        ("virtual-work", "u +any speed in which"),
        pytest.param("torque-free-motion", "ρ⃗ +part of ω⃗ across H⃗_C$", marks=pytest.mark.slow),
        pytest.param("energy-dissipation", "b̂₃ +unit vector along axis 3", marks=pytest.mark.slow),
    ],
)
def test_letters_that_words_alone_have_are_listed(name, row):
    assert re.search(f"^ +{row}", derive(name).page("text", steps=False), re.MULTILINE)


@pytest.mark.parametrize("name", derivations())
def test_no_words_of_steps_have_marks_of_one_notation(name):
    for step in derive(name).steps:
        assert not re.search(r"\btildes?\b", " ".join((step.reason, *step.by)))
