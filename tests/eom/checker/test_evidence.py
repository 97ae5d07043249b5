"""What speaks for a meaning, and what letters stand for where words give others of their kind."""

import pytest

import eom
from benchmarks.meanings import Count, quantities, report
from eom.checker.infer.books import TOPICS, candidates
from eom.checker.infer.draft import propose
from eom.checker.infer.evidence import Evidence, is_amiss, misfit
from eom.checker.infer.house import drafted as drafted_on
from eom.checker.infer.house import fit, kept
from eom.checker.infer.sayings import look_of
from eom.checker.judge.notes import understand
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import PRESETS, parse_lexicon
from eom.checker.read.documents import read_document
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import read


def drafted(text):
    """The meanings of a draft by their patterns."""
    return {d.latex: d.meaning for d in propose(read_document(text)).drafts}


def look(latex):
    """What a symbol looks like."""
    return look_of(read_formula(latex).tree)


# -- evidence ------------------------------------------------------------------------------------


def known_by(hold, **changed):
    """Evidence for four lines: F alone, F and G, F and n (the norm of F), G."""
    rows = [["F"], ["F", "G"], ["F", "n"], ["G"]]
    used = tuple({p: (p, f"meaning of {p}") for p in row} for row in rows)
    families = {p: p for p in "FGn"}
    data = {
        "used": used,
        "hold": hold,
        "families": families,
        "firm": frozenset(),
        "guessed": {},
        "meant": {},
        "bases": {},
        "preset": "kane",
    }
    return Evidence(**{**data, **changed})


def test_two_other_lines_make_a_meaning_sure():
    assert known_by((False, True, True, False)).is_sure("F", 0)
    assert not known_by((False, True, False, False)).is_sure("F", 0)
    assert not known_by((True, True, False, False)).is_sure("F", 0)


def test_symbols_of_a_family_speak_for_each_other():
    one = {"F": "force", "G": "force", "n": "n"}
    assert known_by((True, False, False, True), families=one).is_sure("F", 1)
    assert known_by((False,) * 4, families=one, firm=frozenset({"G"})).is_sure("F", 0)


def test_a_norm_is_as_sure_as_its_vector():
    found = known_by((True, True, False, False), bases={"n": frozenset({"F"})})
    assert found.is_sure("n", 2)
    assert not known_by((True, False, False, False), bases={"n": frozenset({"F"})}).is_sure("n", 2)
    whole = {"firm": frozenset("F"), "bases": {"n": frozenset("F")}}
    assert not known_by((False,) * 4, **whole).is_sure("n", 2)
    assert known_by((False,) * 4, spoken=frozenset("F"), **whole).is_sure("n", 2)


def test_kinds_are_trusted_where_each_meaning_holds_elsewhere():
    assert known_by((True, False, False, True), firm=frozenset("FG")).is_proved(1)
    assert not known_by((True, False, False, False), firm=frozenset("FG")).is_proved(1)
    assert not known_by((True, False, False, True)).is_proved(1)


def test_doubts_name_the_preset_or_why_a_meaning_was_guessed():
    (doubt,) = known_by((False,) * 4, guessed={"G": "as in the usual books"}).doubts(3)
    assert (doubt.latex, doubt.why) == ("G", "as in the usual books")
    assert known_by((False,) * 4).doubts(3)[0].why == "preset kane"


FRAMES = r"""
$\mathcal N$ is an inertial frame, $\mathcal B$ a frame fixed in the body.
$[BN]$ takes $\mathcal N$ components into $\mathcal B$ components.
$\boldsymbol\omega_{\mathcal B/\mathcal N}$ is the angular velocity of $\mathcal B$ seen from $\mathcal N$.

$$\dot{[BN]}=-[\tilde{\boldsymbol\omega}_{\mathcal B/\mathcal N}][BN]$$

$$%s=[\tilde{\boldsymbol\omega}_{\mathcal B/\mathcal N}][BN]$$
"""


def test_kinds_that_disagree_are_wrong_only_with_meanings_that_hold_elsewhere():
    line = r"\dot{\boldsymbol\omega}_{\mathcal B/\mathcal N}"
    verdicts = [f.verdict for f in eom.check(FRAMES % line).findings if f.kind == "display"]
    assert verdicts == ["holds", "ill-formed"]
    alone = FRAMES.replace(r"\dot{[BN]}=-", r"\dot{[BN]}=2") % line
    verdicts = [f.verdict for f in eom.check(alone).findings if f.kind == "display"]
    assert verdicts[1] == "undecided"


# -- letters -------------------------------------------------------------------------------------

PARTICLES = r"""
A system of particles with masses $m_i$ at $\mathbf r_i$; $\mathbf{r}_i = \mathbf{R} + \mathbf{r}'_i$.

$$M\mathbf{R} = \sum_i m_i\mathbf{r}_i$$

$$\sum_i m_i\mathbf{r}'_i = 0$$

$$\sum_i m_i\mathbf{r}_i = M\mathbf{R} + \sum_i m_i\mathbf{r}'_i$$

$$M\mathbf{V} = \sum_i m_i\left(\mathbf{v}_i - \mathbf{v}'_i\right)$$
"""


def test_a_prime_is_a_label_where_more_lines_make_sense_so():
    found = propose(read_document(PARTICLES))
    means = {d.latex: d.meaning for d in found.drafts}
    assert means[r"\mathbf{r}_{<i>}^{\prime}"] == r"= \mathbf{r}_{<i>} - \mathbf{R}"
    assert means[r"\mathbf{v}_{<i>}^{\prime}"] == r"= \dot{\mathbf{r}_{<i>}^{\prime}}"
    assert parse_lexicon(found.toml).find(look(r"\mathbf{r}_i^{\prime}")) is not None


def test_an_empty_frame_takes_a_mark_of_the_preset_away():
    assert "prime" in parse_lexicon('preset = "physics-bold"').notation.marks
    own = parse_lexicon('preset = "physics-bold"\n[marks]\nprime = ""')
    assert "prime" not in own.notation.marks


def test_what_a_display_defines_by_a_raised_label_is_its_own_and_the_text_gives_components():
    text = r"""
$\mathbf b_1$, $\mathbf b_2$, $\mathbf b_3$ are unit vectors of the body $B$.
$\mathbf h$ is the angular momentum.

$$\mathbf{h}^* = -\dot{\mathbf{h}}$$

whose measure numbers are $h_r^* = \mathbf{h}^*\cdot\mathbf{b}_r$.
"""
    found = drafted(text)
    assert found[r"\mathbf{h}^{\ast}"] == "defined"
    assert found[r"h_{<k>}^{\ast}"] == r"= \mathbf{h}^{\ast} \cdot \mathbf{b}_{<k>}"


def test_letters_of_an_identity_beside_any_vector_are_any():
    text = r"""
For every vector $\vec u$ we have

$$\vec u\times(\vec v\times\vec w) = \vec v(\vec u\cdot\vec w) - \vec w(\vec v\cdot\vec u)$$

$$\vec u\cdot(\vec v\times\vec w) = \vec v\cdot(\vec u\times\vec w)$$
"""
    found = drafted(text)
    assert [found[rf"\vec{{{n}}}"] for n in "uvw"] == ["vector u", "vector v", "vector w"]
    assert [f.verdict for f in eom.check(text).findings if f.kind == "display"] == [
        "holds",
        "wrong",
    ]


def test_a_factor_of_a_unit_vector_is_the_component_of_what_it_gives():
    text = r"""
$\vec\omega$ is the angular velocity, $\hat b_1$, $\hat b_2$, $\hat b_3$ are unit vectors of the body.

$$\vec\omega = s\,\hat b_2$$
"""
    assert drafted(text)["s"] == r"= \vec{\omega} \cdot \hat{b}_{2}"


def test_two_labels_of_a_letter_do_not_mean_the_same():
    text = r"$\vec\omega_D$ and $\vec\omega_B$ are the angular velocities of the frame $D$ and of the body."
    assert sum("angular_velocity" in m and "<" not in k for k, m in drafted(text).items()) == 1


def test_the_moments_of_a_table_are_about_its_point_and_torques_as_their_vector():
    text = r"""
$O$ is a fixed point of the body, $\mathbf J$ the inertia matrix about $O$.

$$J_1\dot\omega_1 + (J_3-J_2)\omega_2\omega_3 = \tau_1$$
"""
    assert drafted(text)["J_{<k>}"] == "inertia O in B component <k> <k>"


def test_quantities_of_orbits_and_wheels_need_words_for_them():
    assert "orbit_radius" in dict(candidates(look("R"), "body", Lexicon())).values()
    few = candidates(look("R"), "body", Lexicon(), absent=frozenset(TOPICS))
    assert "orbit_radius" not in dict(few).values()


@pytest.mark.parametrize(
    ("text", "means"),
    [
        ("The total angular momentum about the origin is $$L = m$$", {}),
        (r"and the acceleration $$\mathbf a_C = \mathbf 0$$", {}),
    ],
)
def test_words_without_their_symbols_give_nothing(text, means):
    assert means.items() <= drafted(text).items()


def test_words_lead_to_the_left_side_of_a_display():
    text = r"""
$C$ is the mass centre.

The last sum is the angular momentum about the mass centre,

$$\mathbf K = \mathbf 0$$

and the torque about the same point

$$\mathbf Q = \mathbf 0$$
"""
    found = drafted(text)
    assert found[r"\mathbf{K}"] == "angular_momentum body C"
    assert found[r"\mathbf{Q}"] == "torque body C"


def test_one_particle_beside_others_is_a_particle_of_its_own():
    text = r"""
A system of particles with masses $m_i$.
Now one particle of mass $m_k$ is seen from a frame with origin $A$: $\vec r$ is its position from $A$.

$$m_k\ddot{\vec r} = \vec 0$$
"""
    found = drafted(text)
    assert found["m_{k}"] == "mass P"
    assert found[r"\vec{r}"].startswith("position P O")


# -- the count -----------------------------------------------------------------------------------


def test_words_of_the_truth_name_quantities():
    assert quantities({"kind": "vector", "meaning": "angular velocity of B in A"}) == (
        "angular_velocity",
    )
    assert quantities({"kind": "point", "meaning": "mass centre"}) == ()
    assert quantities({"kind": "scalar", "meaning": "what nobody knows"}) == ()


def test_the_count_tells_what_is_right_of_what():
    rows = [
        Count("n", "a", "torque", "torque body C", True, True),
        Count("n", "b", "torque", "force P", False, True),
        Count("n", "c", "torque", "", False, False),
    ]
    lines = list(report(rows))
    assert lines[1:4] == [
        "right of all: 1 of 3",
        "right of with a meaning: 1 of 2",
        "right of told as sure: 1 of 2",
    ]
    assert "n: c: no meaning" in lines[-1]


# -- misfits, displays with words, one reading for many drafts -----------------------------------


def test_words_are_doubted_only_by_misfits_that_rest_on_them():
    firm, rests, other = {"firm": frozenset("FG")}, frozenset("F"), frozenset("G")
    assert not known_by((False,) * 4, fails=(rests, rests), **firm).is_sure("F", 0)
    assert known_by((False,) * 4, fails=(rests, other), **firm).is_sure("F", 0)
    agreed = {**firm, "agreed": frozenset("F")}
    assert known_by((False,) * 4, fails=(rests, rests), **agreed).is_sure("F", 0)


def test_a_misfit_rests_on_the_symbols_without_which_the_rest_fits():
    lexicon = parse_lexicon(
        r"""
[symbols]
'\vec F' = "external_force body"
'\vec p' = "linear_momentum body"
'\vec v' = "velocity C OI I"
'm' = "total_mass body"
""",
        "a lexicon",
    )
    note = read_document("$$\\vec F = m\\vec v$$\n\n$$\\vec p + m\\dot{\\vec v} = \\vec F$$")
    first, second = (misfit(one, lexicon) for one in understand(note, lexicon))
    assert r"\vec F" in first
    assert r"\vec F" not in second
    assert r"\vec p" in second


def test_a_sentence_that_takes_a_quantity_names_the_display_behind_it():
    note = (
        "Take the angular momentum about the origin $O$.\n\n$$\\vec J_O = \\vec a \\times \\vec b$$"
    )
    assert drafted(note)[r"\vec{J}_{O}"].startswith("angular_momentum body")
    assert r"\vec{J}_{O}" not in drafted(note.replace("Take", "Forget"))


def test_a_display_says_what_a_symbol_in_it_is():
    note = (
        r"$$\vec{a} \text{ is a vector: } [\tilde{\vec a}] = \begin{bmatrix} 0 & -a_3 & a_2 \\ "
        r"a_3 & 0 & -a_1 \\ -a_2 & a_1 & 0 \end{bmatrix}$$"
        "\n\nThen\n\n"
        r"$$\vec a \times \vec b = [\tilde{\vec a}] \vec b$$"
    )
    found = drafted(note)
    assert (found[r"\vec{a}"], found[r"\vec{b}"]) == ("vector a", "vector b")
    assert found["a_{3}"] == "vector a in B component 3"


def test_a_display_that_a_scan_damaged_gives_a_factor_of_a_unit_vector():
    note = (
        r"In the frames $\mathcal{B}$ and $\mathcal{C}$ we have"
        "\n\n"
        r"$$\mathcal{B}_{\boldsymbol{\omega}}^{\mathcal{C}} = \Omega \mathbf{b}_2$$"
        "\n\n"
        r"$${}^{\mathcal{I}}\frac{d}{dt}{}^{\mathcal{I}}\mathbf{h}_G = \mathbf{M}_G$$"
    )
    assert drafted(note)[r"\Omega"].endswith(r"\cdot \mathbf{b}_{2}")


def test_a_constant_is_no_meaning():
    assert "H" not in drafted(r"The length $H = \text{constant}$ of the vector.")


def test_frames_of_a_part_are_called_as_in_the_note():
    note = (
        "# Bodies\n\nLet $\\mathcal{F}_I$ be an inertial frame and $\\mathcal{F}_B$ the body frame.\n\n"
        "$$\\underline{r} = \\underline{\\mathcal{F}}_B^T \\underline{r}_B$$\n\n"
        "## Turning\n\nConsider two body-fixed frames, $\\mathcal{F}_A$ and $\\mathcal{F}_B$. Let "
        "$\\mathbf{C}_{BA}$ represent the rotation matrix from the former to the latter.\n\n"
        "$$\\mathbf{J}_B = \\mathbf{C}_{BA}\\mathbf{J}_A\\mathbf{C}_{AB}$$\n"
    )
    assert '"rotation A B"' not in propose(read_document(note)).toml


def test_lines_read_once_leave_the_same():
    text = (
        "$$\\vec h = \\vec r \\times m\\vec v$$\n\n$$\\vec p := m\\vec v$$\n\n$$\\vec F = \\dot{\\vec p}$$"
        "\n\n$$\\vec q = \\vec p + m\\vec r$$\n\n$$T = \\frac12 I\\omega^2$$"
    )
    formulas = read(read_document(text))
    tables = [
        {"symbols": dict(rows)}
        for rows in (
            (),
            ((r"\vec r", "position C OI"),),
            ((r"\vec r", "position C OI"), (r"\vec v", "velocity C OI I")),
            ((r"\vec v", r"= \dot{\vec r}"),),
            ((r"\vec v", r"= \dot{\vec r}"), (r"\vec r", "position C OI")),
            ((r"\vec v", r"= \dot{\vec r}"), (r"\vec r", "external_force body")),
            (
                ("m", "total_mass body"),
                (r"\vec v", "velocity C OI I"),
                (r"\vec r", "position C OI"),
            ),
            (("m", "total_mass body"), (r"\vec v", "acceleration C OI I")),
        )
    ]
    lexica = [drafted_on(name, t) for name in ("", *PRESETS) for t in tables]
    plain = [fit(formulas, lexicon) for lexicon in lexica]
    with kept():
        assert [fit(formulas, lexicon) for lexicon in lexica] == plain
    assert len(set(plain)) > 3


def test_a_line_is_amiss_whatever_its_doubtful_symbols_mean():
    lexicon = parse_lexicon(
        r"""
[symbols]
'\vec p' = "linear_momentum body"
'\vec F' = "external_force body"
'\vec v' = "velocity C OI I"
'm' = "total_mass body"
""",
        "a lexicon",
    )
    (line,) = understand(read_document("$$\\vec p + m\\dot{\\vec v} = \\vec F$$"), lexicon)
    assert is_amiss(line, lexicon, {r"\vec F"})
    assert not is_amiss(line, lexicon, {r"\vec p"})
    (fitting,) = understand(read_document("$$m\\dot{\\vec v} = \\vec F$$"), lexicon)
    assert not is_amiss(fitting, lexicon, set())
