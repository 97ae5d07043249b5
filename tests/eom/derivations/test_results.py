"""Results are written in the letters of their page, with its marks, and are what they stand for."""

import pytest
import sympy as sp

from eom.derivations import derive, showing, standing
from eom.derivations.derivation import Derivation
from eom.derivations.verification import DerivationError
from eom.derivations.wording import frames_of, named, notation_of, points_of, spelt, terms_of
from eom.system import System
from eom.terms.terms import Term, dot, expr, nodes
from eom.terms.vocabulary import quantity, unit
from eom.typeset.blocks import Bullets, Display, Paragraph
from eom.typeset.boxes import (
    Accent,
    Fence,
    Form,
    Formula,
    Fraction,
    Grid,
    Operator,
    Row,
    Scripts,
    Symbol,
)
from eom.typeset.expressions import expression_box
from eom.typeset.markup import render
from eom.typeset.notation import NOTATIONS, notation_named, term_box
from tests.eom.rows import derivations

RATES = {"dot", "ddot"}
"""Marks for rates of what is listed; others are marks of the letter itself."""
SAME = {"identity_matrix": "identity"}
"""The unit dyadic and the matrix of its components have one letter."""
PLAIN = {"t", r"\pi"}
"""Letters that no page explains."""


def is_unit(box):
    """Whether a symbol is that of a unit: one upright letter."""
    return box.style == "roman" and len(box.name) == 1


def opened(box):
    """The boxes of a formula."""
    return expression_box(box.value, box.names) if isinstance(box, Formula) else box


def inner(box):
    """What is within a box that is no letter by itself."""
    if isinstance(box, Row):
        return box.items
    if isinstance(box, Fence):
        return (box.inner,)
    if isinstance(box, Fraction):
        return (box.above, box.below)
    if isinstance(box, Form):
        return box.parts
    return tuple(b for row in box.rows for b in row) if isinstance(box, Grid) else ()


def without_power(box):
    """A letter without its exponent, and the exponent; brackets without the frame beside them."""
    rest = (
        box.base if box.sub is None or isinstance(box.base, Fence) else Scripts(box.base, box.sub)
    )
    return (rest,) if box.sup is None else (rest, box.sup)


def strangers(box, listed):
    """The letters in a box that are not listed, as LaTeX."""
    box = opened(box)
    if render(box, "latex") in listed:
        return []
    if isinstance(box, Scripts) and (box.sup is not None or isinstance(box.base, Fence)):
        return [s for part in without_power(box) for s in strangers(part, listed)]
    if isinstance(box, Accent) and box.mark in RATES:
        return strangers(box.base, listed)
    if isinstance(box, Symbol) and (not box.name.isalpha() or is_unit(box)):
        return []
    if isinstance(box, Symbol | Scripts | Accent):
        return [render(box, "latex")]
    return [s for part in inner(box) for s in strangers(part, listed)]


def page_of(name, notation):
    d = derive(name)
    chosen = notation_of(d, notation_named(notation))
    return spelt(d, chosen), chosen


def letters(d, chosen):
    """The letters in the list of symbols of a page."""
    boxes = [box for box, _ in showing.symbols(d, chosen)]
    is_defined = (isinstance(b, Row) and Operator(":=") in b.items for b in boxes)
    return [opened(b.items[0] if cut else b) for b, cut in zip(boxes, is_defined, strict=True)]


def shown(d, chosen):
    """The formulas of the results of a page, and the letters in their words."""
    for block in showing.results(d, chosen):
        if isinstance(block, Display):
            for line in block.lines:
                yield from (b for b in (line.left, *line.right) if b is not None)
                yield from in_words(line.words)
        elif isinstance(block, Bullets):
            for name, words in block.items:
                assert not isinstance(name, str)
                yield from () if name is None else (name,)
                yield from in_words(words)
        elif isinstance(block, Paragraph):
            yield from in_words(block.words)


def in_words(words):
    return () if isinstance(words, str) else (w for w in words if not isinstance(w, str))


@pytest.mark.parametrize("name", derivations())
def test_every_letter_of_a_result_is_listed_with_its_mark(name):
    for notation in NOTATIONS:
        d, chosen = page_of(name, notation)
        listed = {render(box, "latex") for box in letters(d, chosen)} | PLAIN
        found = terms_of(d)
        columns = {n for n in found if n.head == "column"}  # of which the list has an example
        listed |= {render(term_box(n, chosen), "latex") for n in columns}
        listed |= {render(chosen.frame(f), "latex") for f in frames_of(found)}
        listed |= {render(chosen.point(p), "latex") for p in points_of(found)}
        assert [s for box in shown(d, chosen) for s in strangers(box, listed)] == []


@pytest.mark.parametrize("name", derivations())
def test_no_letter_is_the_name_that_a_program_knows(name):
    for notation in NOTATIONS:
        for box in letters(*page_of(name, notation)):
            base = box.base if isinstance(box, Scripts) else box
            assert not (isinstance(base, Symbol) and base.style == "roman" and len(base.name) > 1)


@pytest.mark.parametrize("name", derivations())
def test_a_letter_of_a_page_and_its_result_names_one_thing(name):
    for notation in NOTATIONS:
        d, chosen = page_of(name, notation)
        found = {}
        for one in named(d, chosen):
            thing = (SAME.get(one.thing[0], one.thing[0]), *one.thing[1:])
            assert found.setdefault(render(one.box, "latex"), thing) == thing
        for letter, _, q in standing.listed(d, chosen):
            known = found.get(render(letter, "latex") if letter else q.latex)
            assert known is None or known[-1] in names_of(q, d, chosen)


def names_of(q, d, chosen):
    """What a quantity of a system is called on a page."""
    meanings = (t for s, t in d.scalars.items() if s.name == q.name)
    term = next(meanings, d.stands.get(q.name))
    if not isinstance(term, Term):
        return {q.name}
    own = {s.name for n in nodes(term) if n.head == "expr" for s in n.data[0].free_symbols}
    return {q.name, standing.named_by(q.name, term, chosen), *map(str, term.data), *own}


def test_a_letter_that_is_not_listed_is_found():
    d, chosen = page_of("euler-equations", "arrow")
    listed = {render(box, "latex") for box in letters(d, chosen)}
    b1 = Scripts(Symbol("b"), Symbol("1"))
    assert strangers(b1, listed) == ["b_{1}"]
    assert strangers(Scripts(Accent("hat", Symbol("b")), Symbol("1")), listed) == []
    assert strangers(Formula(sp.Symbol("I1") * sp.Symbol("J") ** 2), listed) == ["J"]


@pytest.mark.parametrize("name", derivations())
def test_what_is_left_out_is_there(name):
    d = derive(name)
    systems = [value for value in d.result.values() if isinstance(value, System)]
    names = {q.name for system in systems for q in standing.quantities(system)}
    assert {n for n, term in d.stands.items() if term is None} <= names


# -- what they say ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "notation", "wanted"),
    [
        ("rigid-body-momentum", "arrow", "[I_C]_B = [[S\u2082\u2082"),
        ("rigid-body-momentum", "underline", "I = [[S\u2082\u2082"),
        ("gyrostat", "arrow", "h\u2081 = (I\u2081 \u2212 I_(s,1))"),
        ("gyrostat", "arrow", "I_(s,2)  moment of inertia of rotor 2 about its axis"),
        ("gyrostat", "superscript", "M_(a,1)  motor torque of the body on rotor 1"),
        ("gyrostat", "arrow", "\u03a9\u2081 + \u03c9\u2081   = p\u2081/I_(s,1)"),
        ("torque-free-motion", "arrow", "angular momentum along \u00ee\u2081"),
        ("spinning-symmetric-body", "arrow", "angular momentum along \u00ee\u2081"),
        ("spinning-symmetric-body", "underline", "about the centre of mass \u2022"),
        ("energy-dissipation", "arrow", "T \u2212 Q/(2 (I\u2083 + J\u209b)) = "),
        ("euler-equations", "kane", "M\u2081 := b\u0302\u2081"),
        ("euler-equations", "arrow", "d/dt \u03b2\u2080 = "),
        ("tilde-identities", "underline", "a^\u00d7 = [[0"),
    ],
)
def test_results_have_the_letters_of_the_page(name, notation, wanted):
    assert wanted in derive(name).page("text", notation)


def test_one_letter_is_the_energy():
    page = derive("energy-dissipation").page("text", "arrow")
    for other in ("E  ", "K  "):
        assert f"\n  {other}" not in page


def test_what_a_page_does_not_speak_of_is_left_out():
    page = derive("torque-free-motion").page()
    assert "tilt" not in page
    assert "q_norm" in derive("torque-free-motion").system.invariant_names
    assert "norm of the quaternion" not in page
    assert "tilt" in derive("torque-free-motion").system.output_names


def test_results_are_what_they_stand_for():
    d = Derivation("t", "t", "t")
    d.only("principal_axes")
    J, w = quantity("inertia", "C"), quantity("angular_velocity", "B", "I")
    for k, symbols in enumerate(
        zip(*(sp.symbols(n, real=True) for n in ("I1:4", "w1:4")), strict=True), 1
    ):
        b = unit("B", k)
        for s, meaning in zip(symbols, (dot(b, dot(J, b)), dot(b, w)), strict=True):
            d.name_scalar(s, meaning, "a component")
    I1, w1 = (next(s for s in d.scalars if s.name == n) for n in ("I1", "w1"))
    d.stands_for("h", dot(unit("B", 1), quantity("angular_momentum", "body", "C")))
    assert d.finish(h=I1 * w1).result["h"] == I1 * w1
    with pytest.raises(DerivationError, match="what a result stands for"):
        d.finish(h=2 * I1 * w1)


def test_a_vector_stands_for_its_magnitude():
    d = derive("euler-equations")
    assert "|H\u20d7_C|" in d.page()
    claims = list(standing.claims(d.stands, {"H": sp.Symbol("H")}))
    assert claims[0].right == expr(sp.Symbol("H") ** 2)


def test_rates_of_rotors_in_space_are_their_rates_and_the_bodys():
    system = derive("gyrostat").system
    values = {o.name: system.expand(o.expression) for o in system.outputs}
    for k in (1, 2):
        body = next(q.symbol for q in system.states if q.name == f"omega_{k}")
        assert sp.simplify(values[f"rotor_rate_{k}"] - values[f"Omega_{k}"] - body) == 0


def test_a_system_of_ones_own_keeps_its_letters():
    d = Derivation("t", "t", "t")
    x = sp.Symbol("x", real=True)
    page = d.finish(motion=System.from_rates("decay", {x: -x})).page()
    assert "d/dt x = \u2212x" in page
