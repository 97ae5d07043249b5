"""Why lines are wrong: repairs of mutants, residuals, counterexamples, conventions; and what is refused."""

import re
from fractions import Fraction

import pytest

from benchmarks.checking import GIVEN, same
from benchmarks.edits import Original, undone
from benchmarks.edits import edits as tree_edits
from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.judge.notes import reread, understand
from eom.checker.judge.verdicts import GRAVE, verdict
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document
from eom.checker.read.grammar import read_formula
from eom.checker.read.paths import NOTHING, at, find, places, put, set_down
from eom.checker.read.writing import latex
from eom.checker.repair.explaining import explain
from eom.checker.repair.lines import Palette
from eom.checker.repair.slips import SLIPS, edits
from eom.checker.report.findings import UNEXPLAINED
from tests.eom.checker.true_lines import ARROWS, NOTES, UNDERLINES
from tests.eom.rows import every

LINES = [(lexicon, note, k) for lexicon, note in NOTES for k in range(len(note))]


def explained(understood):
    """Why a formula is wrong: of its first wrong claim."""
    judged = next(j for j in verdict(understood, GIVEN).claims if j.verdict in GRAVE)
    return explain(understood, judged, GIVEN)


def line_of(note, k, text, lexicon):
    """A line in the place of the k-th one of a note."""
    lines = [*note[:k], text, *note[k + 1 :]]
    found = understand(read_document("\n\n".join(f"$${t}$$" for t in lines)), lexicon)
    return found[k]


def wrong(text, lexicon=ARROWS):
    """The first formula of a note, and why its first wrong claim is wrong."""
    understood = understand(read_document(f"$${text}$$"), lexicon)[0]
    return understood, explained(understood)


@pytest.mark.parametrize(("lexicon", "note", "k"), LINES)
def test_lines_are_true(lexicon, note, k):
    assert verdict(line_of(note, k, note[k], lexicon), GIVEN).verdict in {HOLDS, UNDER}


def test_nothing_is_said_of_a_true_line():
    understood = line_of(NOTES[0][1], 0, NOTES[0][1][0], ARROWS)
    (judged,) = verdict(understood, GIVEN).claims
    assert explain(understood, judged, GIVEN) == UNEXPLAINED


# -- repairs -------------------------------------------------------------------------------------

REPAIRS = {
    "a dot on one of two terms": (
        r"[I]\vec\omega + \vec\omega\times[I]\vec\omega = \vec\tau_C",
        r"[I]\dot{\vec\omega} + \vec\omega\times[I]\vec\omega = \vec\tau_C",
    ),
    "four dots": (
        (
            r"\vec H_O = \int_B\vec R_C\times\vec R_C\,dm + \int_B\vec r\,dm\times\vec R_C"
            r" + \vec R_C\times\int_B\vec r\,dm + \int_B\vec r\times\vec r\,dm"
        ),
        (
            r"\vec H_O = \int_B\vec R_C\times\dot{\vec R}_C\,dm + \int_B\vec r\,dm\times\dot{\vec R}_C"
            r" + \vec R_C\times\int_B\dot{\vec r}\,dm + \int_B\vec r\times\dot{\vec r}\,dm"
        ),
    ),
    "tildes at two places": (
        r"\vec H_C = \left(\int_B -[\vec r][\vec r]\,dm\right)\vec\omega",
        r"\vec H_C = \left(\int_B -[\tilde{\vec r}][\tilde{\vec r}]\,dm\right)\vec\omega",
    ),
    "slips on both sides": (
        r"[I]\vec\omega = -[\dot{\vec\omega}][I]\vec\omega + \vec\tau_C",
        r"[I]\dot{\vec\omega} = -[\tilde{\vec\omega}][I]\vec\omega + \vec\tau_C",
    ),
    "a term of the transport theorem": (
        r"\dot{\vec a} = \frac{^B d\vec a}{dt}",
        r"\dot{\vec a} = \frac{^B d\vec a}{dt} + \vec\omega\times\vec a",
    ),
}


@pytest.mark.parametrize("name", every(2, REPAIRS))
def test_the_most_plausible_repair_is_what_was_meant(name):
    text, meant = REPAIRS[name]
    understood, found = wrong(text)
    assert same(understood, found.corrections[0].latex, meant)


def test_every_correction_holds_as_it_stands_in_the_note():
    """What replaces the place in the note is read again and judged by itself."""
    for text in (REPAIRS["slips on both sides"][0], r"\vec H_C = [I]\dot{\vec\omega}"):
        understood, found = wrong(text)
        source = understood.formula.piece.source.text
        assert found.corrections
        for correction in found.corrections:
            (start, stop), new = correction.span, correction.text
            note = source[:start] + new + source[stop:]
            (again,) = understand(read_document(note), ARROWS)
            assert verdict(again, GIVEN).verdict in {HOLDS, UNDER}, note
            assert same(understood, again.formula.piece.body, correction.latex)
            for names in correction.sets:
                assert verdict(again, (*GIVEN, *names)).verdict == HOLDS


def test_only_the_blamed_member_of_a_chain_changes():
    left, middle, right = (
        r"\vec a\times\vec b",
        r"\vec b\times\vec a",
        r"\vec a\times(\vec b + \vec a)",
    )
    _, found = wrong(f"{left} = {middle} = {right}")
    first = found.corrections[0]
    assert first.latex.startswith(left)
    assert first.latex.endswith(right)
    start = len(f"$${left} = ")
    assert all(start <= s.start and s.stop <= start + len(middle) for s in found.blamed)


def test_repairs_that_say_nothing_are_refused():
    for text in (
        r"\vec a = \vec a + \vec b\times\vec c",
        r"\vec a\times\vec b = \vec a\times\vec a",
    ):
        understood, found = wrong(text)
        for correction in found.corrections:
            for claim in reread(understood, read_formula(correction.latex).tree):
                assert claim.members[0].term != claim.members[1].term, correction.latex
                assert not all(m.is_zero for m in claim.members)


def test_what_always_holds_goes_before_what_needs_more():
    _, found = wrong(r"\vec H_O = \int_B(\vec R_C + \vec r)\times(\vec R_C + \vec r)\,dm")
    needs = [bool(c.sets) for c in found.corrections]
    assert needs == sorted(needs)
    assert not needs[0]


@pytest.mark.slow
def test_a_stated_assumption_makes_a_repair_more_plausible():
    text = r"\vec H_C = \int_B\vec r\times(\vec r)\,dm"
    understood = understand(read_document(f"$${text}$$ $\\vec\\omega$"), ARROWS)[0]
    (judged,) = verdict(understood, GIVEN).claims
    plain = explain(understood, judged, GIVEN)
    stated = explain(understood, judged, GIVEN, ("body_frame", "rigid"))
    assert not plain.corrections[0].sets
    ranks = [
        next((k for k, c in enumerate(e.corrections) if c.sets), len(e.corrections))
        for e in (plain, stated)
    ]
    assert ranks[1] <= ranks[0]


def originals():
    """Some of the true lines in every notation, each as it is judged in its note."""
    for lexicon, note in NOTES:
        for k in range(0, len(note), 3):
            understood = line_of(note, k, note[k], lexicon)
            yield Original(f"line {k + 1}", understood, verdict(understood, GIVEN), {}, ())


@pytest.mark.slow
def test_the_line_before_an_edit_is_among_the_corrections():
    found = []
    for number, original in enumerate(originals()):
        made = list(tree_edits(original.tree))
        _, tree = made[number * 5 % len(made)]
        if verdict(original.edited(tree), GIVEN).verdict in GRAVE:
            found.append((undone(original, tree), latex(tree)))
    assert len(found) >= 8
    assert sum(right for right, _ in found) >= 0.8 * len(found), [t for r, t in found if not r]


# -- residuals -----------------------------------------------------------------------------------

RESIDUALS = {
    r"\dot{\vec a} = \frac{^B d\vec a}{dt}": r"\vec\omega\times\vec a",
    r"\vec a\times\vec b = \vec b\times\vec a": r"2\vec a\times\vec b",
    r"\vec a\times(\vec b\times\vec c) = \vec b(\vec a\cdot\vec c) + \vec c(\vec a\cdot\vec b)": (
        r"-2\vec c(\vec a\cdot\vec b)"
    ),
}


@pytest.mark.parametrize("text", every(2, RESIDUALS))
def test_what_is_left_over_in_the_symbols_of_the_line(text):
    understood, found = wrong(text + r"$$ $\vec\omega$ $$\vec a = \vec a")
    assert same(understood, f"{found.residual} = \\vec b", f"{RESIDUALS[text]} = \\vec b")


@pytest.mark.slow
def test_the_lost_term_of_an_entry():
    lexicon = parse_lexicon("preset = 'left-superscript'\n[symbols]\n'\\Omega' = '= \\dot{\\phi}'")
    row = r"I_2(\ddot\psi\sin\theta + \dot\psi\dot\theta\cos\theta)"
    text = (
        r"\left[{}^{\mathcal I}\frac{d}{dt}{}^{\mathcal I}\mathbf h_G\right]_{\mathcal B} = "
        r"\begin{bmatrix} I_1\dot\psi^2\sin\theta\cos\theta + I_1\ddot\theta"
        r" - I_2\dot\psi(\Omega + \dot\psi\sin\theta)\cos\theta \\ " + row + r" \\"
        r" I_1\ddot\psi\cos\theta - 2I_1\dot\psi\dot\theta\sin\theta"
        r" + I_2\dot\theta(\Omega + \dot\psi\sin\theta)\end{bmatrix}_{\mathcal B}"
    )
    understood, found = wrong(text, lexicon)
    assert found.residual == latex(
        read_formula(r"\begin{bmatrix} 0 \\ I_2\dot\Omega \\ 0 \end{bmatrix}").tree
    )
    source = understood.formula.piece.source.text
    assert [source[slice(*s)] for s in found.blamed] == [row]
    assert found.corrections[0].change == r"a term was lost: $+ I_{2} \dot{\Omega}$ in row 2"
    shown = dict(found.counterexample.values)
    assert numbers(shown[r"\dot{\Omega}"]) != [0]
    assert r"\sin \theta" in shown
    assert r"\theta" not in shown


def test_nothing_that_is_shown_vanishes_where_that_can_be():
    _, found = wrong(r"[I]\vec\omega + \vec\omega\times[I]\vec\omega = \vec\tau_C")
    shown = dict(found.counterexample.values)
    assert r"\dot{\vec{\omega}}" in shown
    assert all(any(numbers(text)) for text in shown.values())


def test_letters_of_a_label_stay_together():
    tree = read_formula(r"f_{e x t} + f_{ext}").tree
    assert latex(tree) == "f_{ext} + f_{ext}"
    assert read_formula(latex(tree)).tree == tree


# -- counterexamples -----------------------------------------------------------------------------


def numbers(text):
    """The components that a value shows, as fractions."""
    text = re.sub(r"\\frac\{(\d+)\}\{(\d+)\}", r"\1/\2", text)
    return [Fraction(n) for n in re.findall(r"-?\d+(?:/\d+)?", text)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def test_a_counterexample_can_be_checked_by_hand():
    _, found = wrong(r"\vec a\times\vec b = \vec b\times\vec a")
    values = {name: numbers(text) for name, text in found.counterexample.values}
    a, b = values[r"\vec{a}"], values[r"\vec{b}"]
    (_, left), (_, right) = found.counterexample.members
    assert numbers(left) == cross(a, b)
    assert numbers(right) == cross(b, a)
    assert numbers(left) != numbers(right)
    assert max(abs(n) for n in (*a, *b)) <= 3


def test_a_counterexample_of_components():
    text = r"I_{1}\dot\omega_1 = (I_{3} - I_{2})\omega_2\omega_3 + L_1"
    understood = understand(read_document(f"$${text}$$"), ARROWS)[0]
    found = explained(understood)
    value = {name: numbers(v)[0] for name, v in found.counterexample.values}
    (_, left), (_, right) = found.counterexample.members
    assert numbers(left)[0] == value["I_{1}"] * value[r"\dot{\omega}_{1}"]
    moment = (value["I_{3}"] - value["I_{2}"]) * value[r"\omega_{2}"] * value[r"\omega_{3}"]
    assert numbers(right)[0] == moment + value["L_{1}"]
    assert numbers(left) != numbers(right)


# -- conventions ---------------------------------------------------------------------------------

OTHER = "right in the other convention"


def test_a_line_in_the_other_convention():
    text = r"\underline{J}_B = \underline{C}_{AB}\underline{J}_A\underline{C}_{BA}"
    _, found = wrong(text, UNDERLINES)
    assert found.convention.startswith(OTHER)
    assert "active" in found.convention
    _, found = wrong(text.replace("= ", "= 2"), UNDERLINES)
    assert not found.convention
    _, found = wrong(r"\underline{a} = 2\underline{a}", UNDERLINES)
    assert not found.convention


def test_an_elementary_rotation_in_the_other_convention():
    lexicon = parse_lexicon("preset = 'left-superscript'")
    text = (
        r"{}^{\mathcal B}C^{\mathcal A} = \begin{bmatrix}1&0&0\\0&\cos\theta&-\sin\theta\\"
        r"0&\sin\theta&\cos\theta\end{bmatrix}"
    )
    assert wrong(text, lexicon)[1].convention.startswith(OTHER)
    assert not wrong(text.replace(r"0&\sin", r"0&-\sin"), lexicon)[1].convention


# -- edits ---------------------------------------------------------------------------------------


def test_edits_are_many_and_each_another_tree():
    tree = read_formula(
        r"-\dot{\vec a}_1\times\left(2\sin\theta\vec b^T + \frac{c^2}{d}\right)"
    ).tree
    x, y = (read_formula(t).tree for t in "xy")
    have = Palette(symbols=(x,), factors=(y,), skew=("tilde",), marks=("circ",))
    found = edits(tree, have)
    assert tree not in {e.tree for e in found}
    assert len({e.tree for e in found}) == len(found)
    assert [e.weight for e in found] == sorted(e.weight for e in found)
    assert len({e.slip.name for e in found}) >= 12
    assert {s.name for s in SLIPS} >= {e.slip.name for e in found}
    assert all(read_formula(latex(e.tree)).tree for e in found if e.tree is not NOTHING)


def test_paths_lead_where_they_say():
    tree = read_formula(r"a + b \cdot (c - \sin d) = \frac{e}{f}").tree
    member = tree.members[0]
    for path, node in places(member):
        assert at(member, path) is node
        assert set_down(member, path, node) == member
        whole = find(tree, node)
        assert whole is not None
        assert at(tree, whole) is node
    term = next(p for p, n in places(member) if n == read_formula("a").tree)
    assert put(member, term, NOTHING) == read_formula(r"b \cdot (c - \sin d)").tree


def test_the_same_note_gives_the_same_explanation():
    text = REPAIRS["slips on both sides"][0]
    assert wrong(text)[1] == wrong(text)[1]
    assert all(j.verdict in GRAVE for j in verdict(wrong(text)[0], GIVEN).claims)
