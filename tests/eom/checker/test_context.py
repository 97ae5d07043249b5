"""What a note has assumed, remarks on its lines, and slips that are carried forward."""

import json

import pytest

from eom.checker.judge.consequences import follows
from eom.checker.judge.notes import understand
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.note.remarks import KINDS, NOUNS
from eom.checker.note.review import review
from eom.checker.prose_claims.assumptions import NOTE, PARAGRAPH, SECTION, letters, said
from eom.checker.read.documents import read_document
from eom.worlds.worlds import ASSUMPTIONS, closure
from tests.clock import growth_within
from tests.eom.checker.test_claims import claimed

STEADY = ("constant_mass",)
BOLD = parse_lexicon(
    r"""
preset = "physics-bold"
[symbols]
'k' = { is = "scalar k", unit = "N/m" }
'\kappa' = { is = "scalar kappa", unit = "N m s" }
"""
)
ARROW = parse_lexicon(
    r"""
preset = "arrow-tilde"
[points]
'Q' = "O"
[symbols]
'\vec H_Q' = "angular_momentum body O"
'\vec\rho' = "position dm O"
"""
)


def reviewed(note, lexicon=BOLD):
    document = read_document(note)
    return review(document, understand(document, lexicon), STEADY)


def lines(note, lexicon=BOLD):
    """Verdict, kinds and lines of remarks, by the line of the formula."""
    return {
        r.understood.formula.piece.line: (r.verdict.verdict, {m.kind: m.line for m in r.remarks})
        for r in reviewed(note, lexicon)
        if r.verdict.claims
    }


# -- words ----------------------------------------------------------------------------------------

WORDS = {
    "The body is rigid.": ("rigid",),
    "We write it in a body-fixed frame.": ("body_frame",),
    "Take moments about the centre of mass.": ("about_centre",),
    "Take moments about its center of mass.": ("about_centre",),
    "the point $O$ is the mass centre": ("about_centre",),
    "Let $O$ be fixed in space": ("O_fixed_in_space",),
    "where $Q$ is fixed in it": ("O_fixed_in_body",),
    "the point $O$ is inertially fixed, and": ("O_fixed_in_space",),
    "There is no external torque.": ("torque_free",),
    "torque-free motion": ("torque_free",),
    "in principal axes": ("principal_axes",),
    "an axisymmetric body": ("symmetric",),
    "By Newton's second law": ("newton_2",),
    "by Newton’s 2<sup>nd</sup> law": ("newton_2",),
    "from Newton's third law": ("third_law_weak",),
    "the strong form of Newton's third law": ("third_law_strong", "third_law_weak"),
    "its mass is constant": ("constant_mass",),
    "a thin rod": ("thin_rod",),
    "It carries two reaction wheels.": ("rotors",),
    "unit vectors fixed in it": ("body_frame",),
    "its central principal moments": ("principal_axes",),
    # denied, or of something else
    "The body is not rigid.": (),
    "a non-rigid body": (),
    "It need not be axisymmetric.": (),
    "any system (not necessarily rigid)": (),
    "no moment of inertia is known": (),
    "The price is fixed.": (),
}


@pytest.mark.parametrize("text", WORDS)
def test_words_state_assumptions(text):
    found = {n for s in said(read_document(text).pieces) for n in s.names}
    assert found == set(WORDS[text])


SCOPED = r"""
# One

Suppose the body is axisymmetric. If there is no torque,

$$a = b$$

then all is well. It is a rigid body.

A new paragraph.

# Two: torque-free motion

Henceforth, principal axes.

# Three
"""


def test_how_far_words_reach():
    document = read_document(SCOPED)
    kinds = {s.text: s.scope for s in said(document.pieces)}
    assert kinds == {
        "axisymmetric": SECTION,
        "no torque": PARAGRAPH,
        "rigid": NOTE,
        "torque-free": SECTION,
        "principal axes": NOTE,
    }
    ends = {s.text: document.pieces[s.stop - 1].line for s in said(document.pieces)}
    headings = [p.line for p in document.pieces if p.kind == "heading"]
    assert ends["axisymmetric"] < headings[1] <= ends["torque-free"] < headings[2] <= ends["rigid"]


def test_every_assumption_has_words():
    assert set(NOUNS) <= set(ASSUMPTIONS)
    assert all("{" not in text.format(what="", line=0, distance="") for text in KINDS.values())
    assert letters(r"\mathcal{F}_B \equiv \bullet") == "F_B ≡ •"


# -- what follows from what ---------------------------------------------------------------------------

DYNAMICS = closure(["principal_axes", "newton_2", "third_law_strong", "constant_mass"])
EULER = r"I_1\dot\omega_1 = (I_2-I_3)\omega_2\omega_3 + N_1"
SLIP = r"I_1\dot\omega_1 = (I_3-I_2)\omega_2\omega_3 + N_1"
FOLLOWING = [
    (r"I_2\dot\omega_2 = N_2", [r"\omega_1 = 0"], True),
    (r"I_2\dot\omega_2 = N_2", [r"\omega_2 = 0"], False),
    (r"\dot\omega_1 = 0", [r"\omega_1 = 0"], True),
    (r"\omega_1 = 0", [r"\dot\omega_1 = 0"], False),
    (
        r"T = \frac12 M\mathbf V\cdot\mathbf V + \frac12 I_3\omega_3^2",
        [r"\omega_1 = 0", r"\omega_2 = 0"],
        True,
    ),
    (r"T = \frac12 M\mathbf V\cdot\mathbf V + \frac12 I_3\omega_3^2", [r"\omega_1 = 0"], False),
    (r"\dot\omega_1 = \frac{I_3-I_2}{I_1}\omega_2\omega_3 + \frac{N_1}{I_1}", [SLIP], True),
    (r"\dot\omega_1 = \frac{I_3+I_2}{I_1}\omega_2\omega_3 + \frac{N_1}{I_1}", [SLIP], False),
    (r"I_2\dot\omega_2 = (I_1-I_3)\omega_3\omega_1 + N_2", [SLIP], False),
    (r"\mathbf L\times\mathbf N = 0", [r"\mathbf N = 0"], True),
    (r"\mathbf L\times\mathbf N = 0", [r"N_1 = 0"], False),
    (EULER, [], True),
    (SLIP, [], False),
]


@pytest.mark.parametrize(("text", "premises", "expected"), FOLLOWING)
def test_consequences(text, premises, expected):
    (claim,) = claimed(text, BOLD)
    given = [c for p in premises for c in claimed(p, BOLD)]
    assert follows(claim, given, DYNAMICS) is expected


# -- remarks ------------------------------------------------------------------------------------------

EULERS = r"""
Newton's laws hold, also in the strong form of the third law.

$$I_1\dot\omega_1 = (I_2-I_3)\omega_2\omega_3 + N_1$$

Here the axes are principal axes.

$$I_2\dot\omega_2 = (I_3-I_1)\omega_3\omega_1 + N_2$$

$$\dot{\mathbf L} = 0$$

$$I_2\dot\omega_2 = (I_3-I_1)\omega_3\omega_1 + N_2$$

$$I_2\dot\omega_2 = (I_3+I_1)\omega_3\omega_1 + N_2$$

$$I_3\dot\omega_3 = (I_2-I_1)\omega_1\omega_2 + N_3$$
"""


def test_what_a_line_needs_and_the_note_says_or_not():
    assert lines(EULERS) == {
        4: ("holds under", {"stated later": 6}),
        8: ("holds under", {}),
        10: ("holds under", {"not stated": 0}),
        12: ("holds under", {"repeats": 8}),
        14: ("wrong", {"contradicts": 8}),
        16: ("wrong", {}),
    }


def test_a_remark_is_in_words():
    found = {m.kind: m.text for r in reviewed(EULERS) for m in r.remarks}
    assert found["stated later"] == "needs principal axes, stated 2 lines later"
    assert (
        found["not stated"]
        == "needs no torque about the centre of mass, which the note does not state"
    )


def test_an_assumption_that_is_not_needed():
    note = (
        "If the body is rigid, $\\int_B\\vec r\\,dm = 0$.\n\n"
        "In a rigid body $\\vec H_C = [I]\\vec\\omega$."
    )
    assert lines(note, ARROW) == {
        1: ("holds", {"not needed": 1}),
        3: ("holds under", {"not stated": 0}),
    }


def test_sets_that_are_stated_come_first():
    alone = r"$$\vec H_Q = \int_B\vec\rho\times(\vec\omega\times\vec\rho)\,dm$$"
    for words, first in (
        ("Q is fixed in the body", "O_fixed_in_body"),
        ("Q is the centre of mass", "about_centre"),
    ):
        found = reviewed(f"{words}. Here B is a body frame.\n\n{alone}", ARROW)[-1]
        assert first in found.verdict.claims[0].judgement.sets[0]


MATCHED = {
    r"\mathbf N = 0": ("torque_free",),
    r"N_1 = 0": (),
    r"I_1 = I_2": ("symmetric",),
    r"\dot{\mathbf R} = 0": ("C_at_rest",),
    r"\omega_1 = 0": (),
}


@pytest.mark.parametrize("text", MATCHED)
def test_formulas_amount_to_assumptions_where_those_follow_back(text):
    note = f"The axes are principal axes. Suppose ${text}$. Then $\\dot{{\\mathbf L}} = 0$."
    (_, found) = reviewed(note)
    known = {"principal_axes", "newton_2", "third_law_strong"}
    missing = next(iter(found.remarks)).text if found.remarks else ""
    assert ("no torque" in missing) is (MATCHED[text] != ("torque_free",)), (known, missing)


PLANE = r"""
The axes are principal axes; Newton's laws hold, with the strong form of the third law.

## Plane motion

Suppose $\omega_1 = 0$ and $\omega_2 = 0$. Then

$$T = \frac12 M\mathbf V\cdot\mathbf V + \frac12 I_3\omega_3^2$$

$$I_3\dot\omega_3 = N_3$$

$$I_3\dot\omega_3 = N_3 + N_1$$

## Other motions

$$T = \frac12 M\mathbf V\cdot\mathbf V + \frac12 I_3\omega_3^2$$
"""


def test_lines_may_rest_on_what_a_formula_assumes():
    found = lines(PLANE)
    assert found[8] == ("holds under", {"rests on": 6})
    assert found[10] == ("holds under", {"rests on": 6})
    assert found[12][1].get("rests on", 6) == 6
    assert found[16][0] == "wrong"
    assert "rests on" not in found[16][1]


def test_a_force_law_is_a_premise():
    note = r"""
Newton's laws hold. Suppose $\mathbf F_i = -k\mathbf r_i$.

$$m_i\ddot{\mathbf r}_i = -k\mathbf r_i + \sum_j\mathbf F_{ij}$$

$$\sum_i m_i\ddot{\mathbf r}_i = -k\sum_i\mathbf r_i$$

$$\sum_i m_i\ddot{\mathbf r}_i = k\sum_i\mathbf r_i$$
"""
    found = lines(note)
    assert found[6] == ("holds under", {"rests on": 2})
    assert found[8][0] == "wrong"


def test_words_of_approximation_leave_a_line_undecided():
    slip = r"$$\mathbf N = \dot{\mathbf L} + \boldsymbol\omega\times\mathbf L$$"
    note = f"{slip}\n\n## Small angles\n\n{slip}\n\n## Exactly\n\n{slip}"
    found = lines(note)
    assert [found[n][0] for n in (1, 5, 9)] == ["wrong", "undecided", "wrong"]
    assert found[5][1]["approximate"] == 3


def test_assumptions_that_cannot_stand_together():
    note = "## One\n\nSuppose $k = 0$.\n\nLet $k = 0$.\n\n## Two\n\nSuppose $k = 0$."
    assert not any(m for r in reviewed(note) for m in r.remarks)
    note = r"Suppose $\frac{\omega_1}{\omega_2} = 1$, and let $\frac{\omega_1}{\omega_2} = 2$."
    assert [m.kind for r in reviewed(note) for m in r.remarks] == ["contradicts assumption"]
    apart = note.replace(", and let", ".\n\n## Two\n\nLet")
    assert not any(m for r in reviewed("## One\n\n" + apart) for m in r.remarks)


# -- carried forward ----------------------------------------------------------------------------------

CARRIED = r"""
Newton's laws hold, and the axes are principal axes.

$$\vec\tau_C = \frac{{}^B d}{dt}\vec H_C - \vec\omega\times\vec H_C$$

$$\vec\tau_C = [I]\dot{\vec\omega} - \vec\omega\times[I]\vec\omega$$

$$\vec H_C = 2[I]\vec\omega$$

$$T_{rot} = \frac12\vec\omega\cdot 2[I]\vec\omega$$

$$T_{rot} = \frac13\vec\omega\cdot 2[I]\vec\omega$$

$$\vec H_C = [I]\vec\omega$$

$$\vec H_C\cdot\vec\omega = 2\vec\omega\cdot[I]\vec\omega$$
"""


def test_one_slip_is_one_finding():
    found = {r.understood.formula.piece.line: r for r in reviewed(CARRIED, ARROW)}
    wrong = {n: r.carried for n, r in found.items() if r.verdict.verdict == "wrong"}
    assert wrong == {4: 0, 6: 4, 8: 0, 10: 8, 12: 0, 16: 8}
    assert found[14].verdict.verdict == "holds under"
    assert [m.line for m in found[6].remarks if m.kind == "carried"] == [4]


SCALARS = r"""
Principal axes; Newton's laws and the strong form of the third law hold.

$$I_1\dot\omega_1 = (I_3-I_2)\omega_2\omega_3 + N_1$$

$$\dot\omega_1 = \frac{I_3-I_2}{I_1}\omega_2\omega_3 + \frac{N_1}{I_1}$$

$$\dot\omega_1 = \frac{I_3+I_2}{I_1}\omega_2\omega_3 + \frac{N_1}{I_1}$$

$$I_2\dot\omega_2 = (I_1-I_3)\omega_3\omega_1 + N_2$$

$$I_1\omega_1\dot\omega_1 = (I_3-I_2)\omega_1\omega_2\omega_3 + N_1\omega_1$$

$$I_1\ddot\omega_1 = (I_3-I_2)(\dot\omega_2\omega_3 + \omega_2\dot\omega_3) + \dot N_1$$
"""


OWN = r"""
$$\frac{{}^B d}{dt}\vec H_C = \dot{\vec H}_C$$

$$\dot{\vec H}_C = \frac{{}^B d}{dt}\vec H_C - \vec\omega\times\vec H_C$$

$$\dot{\hat b}_2 = \omega_3\hat b_1 - \omega_1\hat b_3$$

$$I_{33}\dot\omega_3 = (I_{11} + I_{22})\omega_1\omega_2 + L_3$$
"""


def test_another_slip_of_the_same_term_is_not_carried():
    found = reviewed("The axes are principal axes.\n" + OWN, ARROW)
    assert [(r.verdict.verdict, r.carried) for r in found] == [("wrong", 0)] * 4


def test_slips_of_scalar_lines_by_factors_and_rates():
    found = {r.understood.formula.piece.line: r.carried for r in reviewed(SCALARS)}
    assert found == {4: 0, 6: 4, 8: 0, 10: 0, 12: 4, 14: 4}


CHAINS = {
    "three in a row": (
        r"""Newton's laws hold; the axes are principal axes.
$$\vec H_C = 2[I]\vec\omega$$
$$T_{rot} = \frac12\vec\omega\cdot\vec H_C = \vec\omega\cdot[I]\vec\omega$$
$$2T_{rot} = 2\vec\omega\cdot[I]\vec\omega$$""",
        [0, 2, 2],
        [],
    ),
    "two slips, both put in": (
        r"""Newton's laws hold.
$$\vec H_C = 2[I]\vec\omega$$
$$\vec\tau_C = -\dot{\vec H}_C$$
$$\vec\tau_C = -2\left([I]\dot{\vec\omega} + \vec\omega\times[I]\vec\omega\right)$$""",
        [0, 0, 3],
        [],
    ),
    "carried, with a sign of its own": (
        r"""Newton's laws hold. B is fixed in the rigid body.
$$\vec H_C = 2[I]\vec\omega$$
$$\vec\tau_C = 2[I]\dot{\vec\omega} + \vec\omega\times2[I]\vec\omega$$
$$\vec\tau_C = 2[I]\dot{\vec\omega} - \vec\omega\times2[I]\vec\omega$$""",
        [0, 2, 2],
        [2],
    ),
    "in squares and below integrals": (
        r"""The body is rigid.
$$\dot{\vec R} = \dot{\vec R}_C - \vec\omega\times\vec r$$
$$\dot{\vec R}\cdot\dot{\vec R} = \dot{\vec R}_C\cdot\dot{\vec R}_C
 - 2\dot{\vec R}_C\cdot(\vec\omega\times\vec r) + (\vec\omega\times\vec r)\cdot(\vec\omega\times\vec r)$$
$$\vec H_C = \int_B \vec r\times\dot{\vec R}\,dm = -\int_B \vec r\times(\vec\omega\times\vec r)\,dm$$""",
        [0, 2, 2],
        [],
    ),
    "unrelated": (
        r"""The body is rigid, the axes are principal axes; Newton's laws hold.
$$\dot{\vec R} = \dot{\vec R}_C - \vec\omega\times\vec r$$
$$\vec H_C = -[I]\vec\omega$$
$$I_{11}\dot\omega_1 = (I_{22} + I_{33})\omega_2\omega_3 + L_1$$
$$I_{22}\dot\omega_2 = (I_{33} + I_{11})\omega_3\omega_1 + L_2$$
$$T_{rot} = \vec\omega\cdot[I]\vec\omega$$""",
        [0, 0, 0, 0, 0],
        [],
    ),
}


@pytest.mark.parametrize("name", CHAINS)
def test_carried_is_what_holds_with_the_slip_put_in(name):
    note, lines, own = CHAINS[name]
    found = reviewed(note, ARROW)
    assert {r.verdict.verdict for r in found} == {"wrong"}
    assert [r.carried for r in found] == lines
    both = [k for k, r in enumerate(found) if any(m.kind == "carried and own" for m in r.remarks)]
    assert both == own


def test_a_review_is_the_same_twice():
    note = CARRIED.split("$$T_{rot}", maxsplit=1)[0]
    assert reviewed(note, ARROW) == reviewed(note, ARROW)


# -- what is no claim, or a definition ------------------------------------------------------------------

OTHERS = {
    r"Let $N \to \infty$.": [],
    r"Here $\vec\omega = \omega_1\hat b_1 + \omega_2\hat b_2 + \omega_3\hat b_3$.": ["holds"],
    r"The energy is given by $T = \frac12\int_B\dot{\vec R}\cdot\dot{\vec R}\,dm$.": ["definition"],
    r"The momentum is given by $\vec H_C = [I]\vec\omega$.": ["holds under"],
    r"The momentum is given by $\vec H_C = 2[I]\vec\omega$.": ["wrong"],
}


@pytest.mark.parametrize("text", OTHERS)
def test_limits_and_what_is_given(text):
    assert [r.verdict.verdict for r in reviewed(text, ARROW) if r.verdict.claims] == OTHERS[text]


@pytest.mark.parametrize("factor", ["", "2", "-", r"\frac12"])
def test_a_vector_by_its_own_column_defines_the_column(factor):
    lexicon = parse_lexicon("preset = 'underline-bullet'")
    (found,) = reviewed(
        rf"$$\underline{{\omega}} = {factor}\underline{{\mathcal F}}_B^T\underline{{\omega}}_B$$",
        lexicon,
    )
    assert found.verdict.verdict == ("wrong" if factor else "definition")


def test_a_notebook_names_the_cell_where_something_is_stated():
    cells = [r"$$\vec H_C = [I]\vec\omega$$", "B is a body frame."]
    text = json.dumps({"cells": [{"cell_type": "markdown", "source": c} for c in cells]})
    document = read_document(text, "notebook", "n.ipynb")
    (found,) = review(document, understand(document, ARROW), STEADY)
    assert [m.kind for m in found.remarks] == ["stated elsewhere"]
    assert found.remarks[0].text.endswith("in n.ipynb, cell 2")


@pytest.mark.parametrize(
    "text", ["rigid ", "if no torque ", "$x$ rigid, ", "not fixed ", "O is a "]
)
def test_endless_prose_takes_time_in_proportion(text):
    def work(count):
        assert len(said(read_document(text * count).pieces)) <= 40

    assert growth_within(16, work, 1000, 6000)
