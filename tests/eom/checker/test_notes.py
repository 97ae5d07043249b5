"""Notes with their lexica: scopes, continued displays, repairs; and lexica that notes suggest."""

from pathlib import Path

import pytest

from eom.checker.infer.draft import propose
from eom.checker.judge.notes import understand
from eom.checker.mean.lexicon_files import PRESETS, lexicon_for, parse_lexicon, preset
from eom.checker.read.documents import read_document

LEXICA = Path(__file__).parent / "lexica"

NOTE = r"""
# A system

Let $\vec{p}_i = m_i\dot{\vec{R}}_i$ be the momentum of each mass.

$$\vec{H}_C = \sum_{i=1}^N m_i\vec{r}_i\times\dot{\vec{r}}_i$$

## A body

Here $\vec{H}_C$ belongs to the body.

$$\vec{H}_C = \int_B\vec{r}\times(\vec{\omega}\times\vec{r})\,dm$$
$$= [I]\vec{\omega}$$
$$\frac{I}{dt}\vec{H}_C = \frac{B}{dt}\vec{H}_C + \vec{\omega}\times\vec{H}_C$$

From now on, L is a length.

$$\vec{L} = \vec{\tau}_C$$
"""
LEXICON = r"""
preset = "arrow-tilde"
[symbols]
'\vec{p}_{<i>}' = "linear_momentum <i>"
[[scope]]
heading = "A system"
[scope.symbols]
'\vec{H}_C' = "angular_momentum system C"
[[scope]]
heading = "A body"
[scope.symbols]
'\vec{H}_C' = "angular_momentum body C"
[[scope]]
after = "From now on,  L is"
[scope.symbols]
'\vec{L}' = "position C OI"
"""


def understood(note=NOTE, lexicon=LEXICON):
    return understand(read_document(note), parse_lexicon(lexicon))


def test_every_formula_has_the_lexicon_of_its_place():
    found = understood()
    symbols = [u for u in found if u.formula.relational]
    owners = [u.claims[0].members[0].term.data[1] for u in symbols[1:3]]
    assert owners == ["system", "body"]
    assert symbols[1].headings == ("A system",)
    assert symbols[2].headings == ("A system", "A body")
    assert [c.verdict for u in symbols for c in u.claims] == ["", "", "", "", "", "wrong"]


def test_a_display_continues_the_one_before():
    continued = [c for u in understood() for c in u.claims if c.previous is not None]
    assert len(continued) == 1
    assert continued[0].members[0].term.args[0].data == ("angular_momentum", "body", "C")


def test_damage_is_read_through_and_said():
    repaired = [u for u in understood() if u.repairs]
    assert len(repaired) == 1
    assert {r.name for r in repaired[0].repairs} == {"derivative without d"}
    assert not any(c.findings for c in repaired[0].claims)


def test_a_cross_of_columns_is_read_where_nothing_else_is():
    found = understand(
        read_document(r"$$\dot{C}_{BI} = -\underline{\omega}_B\times C_{BI}$$"),
        preset("underline-bullet"),
    )
    assert [r.name for r in found[0].repairs] == ["cross of columns"]
    assert not found[0].claims[0].findings
    vectors = understand(
        read_document(r"$$\underline\omega\times\underline\omega\times\underline\omega = 0$$"),
        preset("underline-bullet"),
    )
    assert vectors[0].claims[0].verdict == "ambiguous"


def test_front_matter_is_the_lexicon_of_a_note():
    note = "+++\n[check]\npreset = 'kane'\n+++\n\n$$K = K$$\n"
    lexicon = lexicon_for(note)
    assert lexicon is not None
    (found,) = understand(read_document(note), lexicon)
    assert not found.claims[0].findings


@pytest.mark.parametrize("name", ["000", "001", "002"])
def test_the_lexica_of_the_lectures_can_be_used(name):
    lexicon = parse_lexicon((LEXICA / f"{name}.toml").read_text(encoding="utf-8"), name)
    assert lexicon.scopes
    assert all(s.entries or s.frames or s.points for s in lexicon.scopes)


# -- proposals -------------------------------------------------------------------------------------

STATED = r"""
# Spin

The inertial frame is $\mathcal{F}$. Here $\vec{u}$ is the angular velocity of the body in it, and
$\vec{q}$ points from the centre of mass to an element. The kinetic energy, $E$, is constant, and
$\vec{g}$ denotes the external torque about the mass centre. Let $\vec{f}_i$ be the external force
on mass $i$. We define $\vec{n} \triangleq M\vec{u}$.

$$\vec{H}_C = \int_B\vec{q}\times(\vec{u}\times\vec{q})\,dm$$
$$E = \frac12\vec{u}\cdot\vec{H}_C + \kappa$$
$$\dot{\vec{H}}_C = \vec{g}, \quad \vec{F} = \sum_{i=1}^N\vec{f}_i$$
"""


def test_a_lexicon_is_drafted_from_the_words_of_a_note():
    found = propose(read_document(STATED))
    meant = {d.latex: d.meaning for d in found.drafts}
    assert found.preset == "arrow-tilde"
    assert meant == {
        r"\mathcal{F}": "I",
        r"\vec{u}": "angular_velocity B I",
        r"\vec{q}": "position dm C",
        "E": "kinetic_energy body",
        r"\vec{g}": "torque body C",
        r"\vec{f}_{<i>}": "force <i>",
    }
    assert [name for name, _ in found.defined] == [r"\vec{n}"]
    assert [name for name, _ in found.unplaced] == [r"\kappa"]


def test_a_draft_is_a_lexicon_and_gives_the_note_a_meaning():
    document = read_document(STATED.replace(r" + \kappa", ""))
    lexicon = parse_lexicon(propose(document).toml)
    found = [c for u in understand(document, lexicon) for c in u.claims]
    assert found
    assert not any(c.findings for c in found)


@pytest.mark.parametrize("name", PRESETS)
def test_the_preset_of_a_note_is_found(name):
    symbols = [e.latex for e in preset(name).layers[0] if not e.slots]
    text = "\n\n".join(f"$${s} = {s}$$" for s in symbols)
    score = {p: propose_score(p, text) for p in PRESETS}
    chosen = propose(read_document(text)).preset
    assert score[chosen] == max(score.values()) == len(symbols)


def propose_score(name, text):
    """How many displays have a meaning in a preset."""
    found = understand(read_document(text), preset(name))
    return sum(not any(c.findings for c in u.claims) for u in found)
