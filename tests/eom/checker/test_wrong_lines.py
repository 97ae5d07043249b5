"""Why other lines are wrong than equations in worlds: constants, comparisons, scalars, systems, tables."""

import re
from fractions import Fraction

import pytest
import sympy as sp

import eom
from benchmarks.checking import GIVEN
from eom.checker.judge.notes import understand
from eom.checker.judge.systems import Solutions
from eom.checker.judge.verdicts import GRAVE, verdict
from eom.checker.mean.claims import CONSTANT, Claim
from eom.checker.mean.lexicon_files import parse_lexicon, preset
from eom.checker.mean.model import load_model, model_of
from eom.checker.note.review import review
from eom.checker.read.documents import read_document
from eom.checker.repair.corrections import Suspects, suspects, workshop
from eom.checker.repair.counterexample import points
from eom.checker.repair.explaining import corrected, explain
from eom.checker.repair.lines import line
from eom.checker.report.findings import CARRIED as CARRIED_KIND
from eom.checker.report.findings import CARRIED_AND_OWN
from eom.worlds.solutions import rate
from eom.worlds.special import revealing
from tests.eom.checker.test_parameters import PLATE
from tests.eom.checker.test_systems import TOP, lexicon
from tests.eom.checker.true_lines import ARROWS, SUPERSCRIPTS
from tests.eom.rows import only
from tests.eom.test_solutions import cart


def why(text, own, given=GIVEN):
    """The first wrong claim of a formula, and why it is wrong."""
    understood = understand(read_document(f"$${text}$$"), own)[0]
    judged = next(j for j in verdict(understood, given).claims if j.verdict in GRAVE)
    return understood, judged, explain(understood, judged, given)


def reported(found):
    """What a counterexample shows as fractions: values by LaTeX, both members."""
    shown = {name: fraction(text) for name, text in found.counterexample.values}
    return shown, [fraction(text) for _, text in found.counterexample.members]


def fraction(text):
    found = re.fullmatch(r"(-?)\\frac\{(\d+)\}\{(\d+)\}", text)
    return Fraction(int(f"{found[1]}{found[2]}"), int(found[3])) if found else Fraction(text)


def holds_again(understood, correction, given=GIVEN):
    """The verdict on the note with a correction put into it."""
    source = understood.formula.piece.source.text
    start, stop = correction.span
    note = source[:start] + correction.text + source[stop:]
    return verdict(understand(read_document(note), understood.lexicon)[0], given).verdict


# -- constants -----------------------------------------------------------------------------------------


def test_what_is_not_constant_is_mended():
    understood, judged, found = why(r"C\omega_1 = \text{const}", parse_lexicon(TOP), ())
    assert judged.claim.kind == CONSTANT
    assert found.corrections[0].latex == r"C\omega_{3} = \text{const}"
    assert holds_again(understood, found.corrections[0], ()) == "holds"
    shown, (left, right) = reported(found)
    assert (left != 0, right) == (True, 0)
    assert shown["C"] > 0


def test_the_rate_of_what_is_not_constant_is_reported():
    _, _, found = why(r"A\omega_3 + h_1 = \text{const}", parse_lexicon(TOP), ())
    assert r"\omega" in found.residual or "tau" in found.residual
    heads = [head for head, _ in found.counterexample.members]
    assert heads[0].startswith(r"\frac{\mathrm{d}}{\mathrm{d} t}")


@pytest.mark.slow
def test_what_never_changes_is_no_repair():
    """A parameter, or a thing less itself, is constant and says nothing."""
    _, _, found = why(r"\vec H_C - \vec a = \text{const}", ARROWS)
    for correction in found.corrections:
        assert r"\vec H_C - \vec H_C" not in correction.latex
    _, _, found = why(r"C\omega_1 = \text{const}", parse_lexicon(TOP), ())
    assert all(r"\omega" in c.latex or "h" in c.latex for c in found.corrections)


# -- comparisons -----------------------------------------------------------------------------------------

COMPARED = {
    r"\vec\omega\cdot[I]\vec\omega < 0": r"\vec{\omega} \cdot \left[ I \right] \vec{\omega} \ge 0",
    r"I_{1} + I_{2} \le I_{3}": r"I_{1} + I_{2} \ge I_{3}",
    r"\frac12\vec\omega\cdot[I]\vec\omega = T_{rot} \le 0": (
        r"\frac{1}{2} \vec{\omega} \cdot \left[ I \right] \vec{\omega} = T_{rot} \ge 0"
    ),
}


@pytest.mark.parametrize("text", only(COMPARED, [*COMPARED][1]))
def test_the_sign_of_order_is_turned(text):
    understood, _, found = why(text, ARROWS)
    first = found.corrections[0]
    assert first.latex == COMPARED[text]
    assert first.slip == "sign of order"
    assert holds_again(understood, first) in {"holds", "holds under"}
    assert found.residual
    assert found.blamed


@pytest.mark.slow
def test_numbers_against_a_comparison():
    _, _, found = why(r"I_{1} + I_{2} < I_{3}", ARROWS)
    shown, (left, right) = reported(found)
    assert left == shown["I_{1}"] + shown["I_{2}"]
    assert left > right
    assert max(left, right) < 20


def test_a_slip_in_a_side_of_a_comparison():
    _, _, found = why(r"I_{1} - I_{2} \ge I_{3}", ARROWS)
    assert r"I_{1} + I_{2} \ge I_{3}" in [c.latex for c in found.corrections]


# -- free scalars ----------------------------------------------------------------------------------------


def explained(note):
    return [f for f in eom.check(note, notation="physics-bold").findings if f.verdict == "wrong"]


@pytest.mark.slow
def test_an_integral_with_another_value():
    note = PLATE + r"$$\int_0^a\int_0^b \sigma x^2\,dy\,dx = \frac{\sigma a^2 b}{3}$$"
    (finding,) = explained(note)
    found = finding.explanation
    assert found.corrections[0].text == r"\frac{\sigma a^{3} b}{3}"
    assert found.residual == r"\frac{a^{3} b \sigma}{3} - \frac{a^{2} b \sigma}{3}"
    shown, (left, right) = reported(found)
    a, b, s = (shown[name] for name in ("a", "b", r"\sigma"))
    assert (left, right) == (s * a**3 * b / 3, s * a**2 * b / 3)
    start, stop = found.corrections[0].span
    assert not explained(note[:start] + found.corrections[0].text + note[stop:])


def test_the_value_itself_where_no_slip_is_known():
    (finding,) = explained(
        r"A rod of length $b$ and density $\rho$ has, where $\mu = 3\rho$, "
        r"$$\int_0^b \rho x^2 dx = \frac{\mu b^3}{6}$$"
    )
    assert finding.explanation.corrections[0].text == r"\frac{b^{3} \rho}{3}"
    assert finding.explanation.residual == r"- \frac{b^{3} \rho}{6}"


def test_numbers_alone():
    (finding,) = explained(r"$$\int_0^{2\pi}\sin^2 u\,du = 2\pi$$")
    assert finding.explanation.corrections[0].text == r"\pi"
    assert dict(finding.explanation.counterexample.members)[r"2 \pi"] == r"2 \pi"


# -- systems ---------------------------------------------------------------------------------------------


def test_a_state_at_which_a_line_fails_by_hand():
    text = r"A\dot\omega_1 = (A+C)\omega_2\omega_3 + M_1"
    _, _, found = why(text, parse_lexicon(TOP), ())
    v, (left, right) = reported(found)
    product = v[r"\omega_{2}"] * v[r"\omega_{3}"]
    assert left == v["A"] * v[r"\dot{\omega}_{1}"]
    assert right == (v["A"] + v["C"]) * product + v["M_{1}"]
    assert left == (v["A"] - v["C"]) * product + v["M_{1}"]
    assert left != right
    assert all(abs(n.numerator) < 100 and n.denominator < 100 for n in v.values())


def test_angles_have_sines_of_small_numbers():
    _, _, found = why(r"\dot\phi = C + \dot\psi\sin\theta", lexicon("spinner"), ())
    v, (left, right) = reported(found)
    sine = v[r"\sin \theta"]
    assert sine.denominator in {5, 13, 17}
    assert left == v["C"] - v[r"\dot{\psi}"] * sine
    assert right == v["C"] + v[r"\dot{\psi}"] * sine


@pytest.mark.parametrize(
    "name",
    only(["heavy-top", "spinner", "gravity-gradient-body", "gyrostat"], "spinner", "gyrostat"),
)
def test_states_keep_what_systems_assume(name):
    """Quaternions have the length one; rates are those of the system, in exact numbers."""
    model = load_model(name)
    for k, point in enumerate(points(Solutions(Claim((), model=model), {}), ())):
        for assumption in model.system.assumptions:
            own = {s for e in assumption.vanish for s in e.free_symbols}
            if own <= {q.symbol for q in model.system.states}:
                assert all(point.number(e) == 0 for e in assumption.vanish)
        for quantity, expression in zip(model.system.states, model.system.rates, strict=True):
            if model.system.mass_matrix is None:
                assert point.number(expression) == point.number(rate(quantity.symbol))
        if k == 2:
            break


def test_a_system_with_a_mass_matrix():
    system, energy, momentum = cart()
    point = next(points(Solutions(Claim((), model=model_of(system)), {}), ()))
    rates = sp.Matrix([point.number(rate(q.symbol)) for q in system.states])
    matrix = system.mass_matrix.applyfunc(point.number)
    right = sp.Matrix([point.number(r) for r in system.rates])
    assert matrix * rates == right
    assert point.number(rate(energy)) == point.number(rate(momentum)) == 0


CARRIED = r"""
$$A\dot\omega_1 = (A+C)\omega_2\omega_3 + M_1$$

$$\dot\omega_1 = \frac{A+C}{A}\omega_2\omega_3 + \frac{M_1}{A}$$

$$A\ddot\omega_1 = (A+C)(\dot\omega_2\omega_3 + \omega_2\dot\omega_3) + \dot M_1$$

$$A\omega_1\dot\omega_1 + A\omega_2\dot\omega_2 = 2C\omega_1\omega_2\omega_3 + M_1\omega_1 + M_2\omega_2$$

$$A\dot\omega_2 = (C+A)\omega_3\omega_1 + M_2$$

$$2A\dot\omega_1 = (A+C)\omega_2\omega_3 + M_1$$

$$A(\dot\omega_1 + \dot\omega_2) = (A+C)(\omega_1 + \omega_2)\omega_3 + M_1 + M_2$$
"""


def test_one_slip_about_a_system_is_one_finding():
    document = read_document(CARRIED)
    found = review(document, understand(document, parse_lexicon(TOP)), ())
    assert {r.verdict.verdict for r in found} == {"wrong"}
    lines = [r.understood.formula.piece.line for r in found]
    first, again = lines[0], lines[4]
    assert [r.carried for r in found] == [0, first, first, first, 0, first, again]
    kinds = [{m.kind for m in r.remarks} & {CARRIED_KIND, CARRIED_AND_OWN} for r in found]
    own = {CARRIED_AND_OWN}
    assert kinds == [
        set(),
        {CARRIED_KIND},
        {CARRIED_KIND},
        {CARRIED_KIND},
        set(),
        own,
        {CARRIED_KIND},
    ]


LETTERED = """
preset = 'arrow-tilde'
[symbols]
'r_{<k>}' = 'position dm O in B component <k>'
'I_C' = 'inertia O in B'
"""

# -- tables --------------------------------------------------------------------------------


def test_edits_of_a_table_stay_in_the_cell_that_differs():
    text = (
        r"{}^{\mathcal B}C^{\mathcal A} = \begin{bmatrix}1&0&0\\0&\cos\theta&\cos\theta\\"
        r"0&-\sin\theta&\cos\theta\end{bmatrix}"
    )
    understood, judged, found = why(text, SUPERSCRIPTS)
    wrong = line(understood, judged.claim)
    shop = workshop(understood, wrong, GIVEN)
    table = wrong.members[1].addends[0]
    cells = {p[0][1] for o in shop.offers[table] for p in o.first.paths if p and p[0][0] == "rows"}
    assert cells <= {(1, 2)}
    assert found.corrections[0].change.endswith(
        r"in row 2, column 3: $\cos \theta$ should be $\sin \theta$"
    )


def test_a_cell_of_another_dimension_is_suspect():
    text = (
        r"[I_C] = \int_B \begin{bmatrix} r_2^2 + r_3^2 & -r_1 r_2 & -r_1 r_3 \\"
        r" -r_1 r_2 & r_1^2 + r_3^2 & -r_2 \\ -r_1 r_3 & -r_2 r_3 & r_1^2 + r_2^2 \end{bmatrix} dm"
    )
    lexicon = parse_lexicon(LETTERED)
    understood, judged, _ = why(text, lexicon)
    wrong = line(understood, judged.claim)
    (table,) = wrong.members[1].addends
    (found,) = suspects(wrong, {table: None}, ()).values()
    assert found.cells == frozenset({(1, 2)})


def test_a_place_outside_of_the_suspects_is_spared():
    one = Suspects((("body", ()),), frozenset({(0, 1)}))
    assert one.spares((("body", ()), ("rows", (0, 0)), ("terms", (1,))))
    assert not one.spares((("body", ()), ("rows", (0, 1))))
    assert not one.spares((("body", ()),))
    assert not one.spares(())


# -- examples --------------------------------------------------------------------------------


def test_special_motions_for_examples_are_in_whole_numbers():
    found = [s for _, s in zip(range(10), revealing(frozenset()), strict=False)]
    data = [dict(s.data) for s in found]
    assert all("/" not in text for d in data for text in d.values())
    names = frozenset({"principal_axes", "about_centre", "newton_2"})
    assert all(names <= s.assumed for _, s in zip(range(3), revealing(names), strict=False))


def test_principal_axis_components_in_whole_numbers():
    text = r"I_{1}\dot\omega_1 = (I_{3} - I_{2})\omega_2\omega_3 + L_1"
    _, _, found = why(text, ARROWS)
    v, (left, right) = reported(found)
    assert all(n.denominator == 1 and abs(n) <= 12 for n in v.values())
    assert left == v["I_{1}"] * v[r"\dot{\omega}_{1}"] != right


def test_corrections_alone_are_those_of_the_explanation():
    for text, own in (
        (r"\vec a\times\vec b = \vec b\times\vec a", ARROWS),
        (r"T_{rot} < 0", ARROWS),
    ):
        understood, judged, found = why(text, own)
        assert corrected(understood, judged, GIVEN) == found.corrections


# -- what holds in a special case alone ----------------------------------------------------------------


def test_a_slip_in_what_holds_in_a_special_case_alone_is_repaired_for_it():
    text = r"I_1\dot\omega_1 = (I_2 + I_3)\omega_2\omega_3"
    found = why(text, preset("kane"))[2].corrections
    assert found[0].text == r"I_{2} - I_{3}"
    assert set(found[0].sets[0]) == {"principal_axes", "torque_free"}
    assert not any("transpose" in c.change for c in found)  # of a scalar, which changes nothing


def test_a_repair_in_general_comes_before_those_of_special_cases():
    text = r"I_1\dot\omega_1 = (I_2 + I_3)\omega_2\omega_3 + T_1"
    found = why(text, preset("kane"))[2].corrections
    assert found
    assert not any("torque_free" in names for c in found for names in c.sets)
