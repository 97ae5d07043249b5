"""Systems that words describe: what is composed of parts, and what must not be read as a system."""

import tomllib
from pathlib import Path

import pytest
import sympy as sp

import eom
from eom.checker.infer.composed import rows
from eom.checker.infer.draft import meanings, propose
from eom.checker.infer.plans import plan
from eom.checker.infer.setups import setup
from eom.checker.infer.systems import guesses
from eom.checker.infer.trials import Part
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document


def read(text):
    part = Part((), read_document(text))
    return setup(part.text, part.document, part.said)


def model(text):
    (row, *_) = rows(read(text))
    return next(guesses(row, (), "", "", turned=False)).model()


def energies(text):
    """Kinetic and potential energy of the system that a text describes, in the letters of the text."""
    found = model(text)
    values = {d.name: d.expression for d in (*found.system.definitions, *found.system.outputs)}
    (row, *_) = rows(read(text))
    real = {"real": True}
    letters = {sp.Symbol(t.means, **real): sp.Symbol(t.latex, **real) for t in row.bound}
    return tuple(sp.expand(values[name].subs(letters)) for name in "TV")


def formula(text):
    expression = sp.sympify(text)
    real = {s: sp.Symbol(s.name, real=True) for s in expression.free_symbols}
    return sp.expand(expression.xreplace(real))


SENTENCES = tomllib.loads(
    (Path(__file__).parent / "composed_systems.toml").read_text(encoding="utf-8")
)
COMPOSED = {row["name"]: row for row in SENTENCES["system"]}
UNKNOWN = {row["name"]: row["text"] for row in SENTENCES["unknown"]}


@pytest.mark.parametrize("name", COMPOSED)
def test_a_system_is_composed_of_the_parts_that_words_name(name):
    row = COMPOSED[name]
    given = {sp.Symbol("phi_dot", real=True): sp.Symbol("w", real=True)}
    for found, key in zip(energies(row["text"]), ("kinetic", "potential"), strict=True):
        assert sp.simplify((found - formula(row[key])).xreplace(given)) == 0


@pytest.mark.parametrize("name", UNKNOWN)
def test_what_is_not_understood_leaves_the_system_unknown(name):
    """Or known up to there: what lines behind it say of the system is unsure."""
    found = read(UNKNOWN[name])
    assert found is None or rows(found) == () or found.until > 0


TROLLEY = r"""
The trolley rolls on a straight horizontal rail. The bar hangs by one end from a pin on the trolley. A
buffer (spring and dashpot in parallel) connects the trolley to the stop.

| symbol | meaning | unit |
|---|---|---|
| $M$ | mass of the trolley | kg |
| $m$ | mass of the bar (slender, uniform) | kg |
| $b$ | length of the bar | m |
| $k$, $c$ | buffer stiffness, buffer damping | N/m, Ns/m |
| $s$ | trolley travel, positive to the right | m |
| $\beta$ | angle of the bar from the downward vertical | rad |
| $P$ | horizontal drive force on the trolley | N |
| $T$, $V$ | kinetic and potential energy | J |

$$ T = \frac12(M+m)\dot s^2 + \frac12 m b\dot s\dot\beta\cos\beta + \frac16 m b^2\dot\beta^2 $$

$$ V = \frac12 k s^2 - \frac12 m g b\cos\beta $$

$$ \frac{d}{dt}(T+V) = P\dot s - c\dot s^2 $$

$$ \frac13 m b^2\ddot\beta + \frac12 m b\ddot s\cos\beta + \frac12 m g b\sin\beta = 0 $$

$$ (M+m)\ddot s + \frac12 m b\left(\ddot\beta\cos\beta - \dot\beta^2\sin\beta\right) - c\dot s + k s = P $$
"""


def test_a_trolley_with_a_buffer_is_read_and_its_lines_are_judged():
    report = eom.check(TROLLEY)
    found = [f.verdict for f in report.findings if f.kind == "display"]
    assert found == [*["holds"] * 4, "wrong"]
    said = str(report.drafts[0])
    read = (
        "system read from lines 2 to 3: the trolley moves along a horizontal line; the bar swings"
    )
    assert said.startswith(read)
    assert "The trolley rolls on a straight horizontal rail" in said


def test_a_composed_system_reads_back_from_the_draft():
    document = read_document(TROLLEY)
    draft = propose(document)
    again, drafted = parse_lexicon(draft.toml), meanings(document).lexicon
    assert [t.look for one in draft.systems for t in one.ties]
    for tie in draft.systems[0].ties:
        assert again.find(tie.look).meaning == drafted.find(tie.look).meaning


CHANGED = r"""A cart of mass $m$ slides without friction on a straight horizontal track. A spring of
stiffness $k$ connects it to a wall. $x$ is its displacement.

$$ m\ddot x + k x = 0 $$

$$ V = \frac12 k x^2 $$

$$ \dot x = x $$

Now the spring is replaced by another one.

$$ V = \frac14 k x^4 $$
"""


def test_lines_behind_words_that_change_a_system_are_not_called_wrong():
    found = [f for f in eom.check(CHANGED).findings if f.kind == "display"]
    assert [f.verdict for f in found] == ["holds", "holds", "wrong", "unsure"]
    assert "the system is as before line 10" in found[3].reason


def test_parts_that_are_joined_are_told_apart():
    found = plan(read(COMPOSED["two on a spring"]["text"]))
    assert found.springs == {"spring": ("block_1", "block_2")}
    assert set(found.guides) == {"block_1", "block_2"}


def test_a_letter_for_the_inertia_of_a_uniform_disc_is_what_its_shape_gives():
    disc = r"A light string runs over a uniform disc of mass $a$, radius $r$ and moment of inertia $I$. "
    (row, *_) = rows(read(f"{disc} Masses $m$ and $M$ hang from its ends."))
    assert "J_disc" in {t.means for t in row.bound if t.latex == "I"}
    assert row.table["values"]["J_disc"]["is"] == row.table["bodies"]["disc"]["moments"][0]


@pytest.mark.parametrize(
    ("words", "turns"),
    [
        ("the downward vertical", (0,)),
        ("the upward vertical", (1,)),
        ("the vertical", (0, 1)),
        ("the horizontal", (2, 3)),
    ],
)
def test_words_say_from_where_an_angle_is_counted(words, turns):
    bob = r"A bob of mass $m$ hangs from a pivot on a massless rod of length $l$."
    (row, *_) = rows(read(rf"{bob} $\theta$ is the angle of the rod from {words}."))
    assert row.turns == turns
