r"""Typed values and claims: their meaning in random worlds, and what is refused, with its place."""

import itertools
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eom.checker.mean.claims import CONSTANT, DEFINITION, EQUALITIES, SAME_POINT, claims, defined
from eom.checker.mean.lexicon_files import parse_lexicon, preset
from eom.checker.read.grammar import read_formula
from eom.checker.read.spans import ReadingError
from eom.checker.read.statements import split
from eom.derivations.verification import decide
from eom.terms.terms import Equation, column, zero
from tests.clock import calls
from tests.eom.rows import but

RIGID = ("body_frame", "newton_2", "third_law_strong")
PRINCIPAL = (*RIGID, "principal_axes")


def claimed(text, lexicon, definitions=None):
    """Claims of a formula; its statements may continue and use each other."""
    found, known = [], dict(definitions or {})
    for statement in split(read_formula(text).tree):
        new = claims(statement, lexicon, known, found)
        known |= defined(new)
        found += new
    return found


def equations(claim):
    terms = [m.term for m in claim.members]
    if claim.kind in {CONSTANT, SAME_POINT}:
        return [Equation(terms[0], zero(terms[0].kind))]
    assert set(claim.relations) <= EQUALITIES
    return [Equation(a, b) for a, b in itertools.pairwise(terms)]


def holds(text, lexicon, assumptions=()):
    found = claimed(text, lexicon)
    assert found
    assert [f for c in found for f in c.findings] == []
    return all(decide(q, assumptions, c.scalars, 2) for c in found for q in equations(c))


# -- the same law in every notation, and a slip in each --------------------------------------------

EULER = {
    "arrow-tilde": (
        r"[I]\dot{\vec\omega} + [\tilde{\vec\omega}][I]\vec\omega = \vec\tau_C",
        r"[I]\dot{\vec\omega} - [\tilde{\vec\omega}][I]\vec\omega = \vec\tau_C",
    ),
    "schaub-junkins": (
        r"[I]\dot{\boldsymbol\omega} = -[\tilde{\boldsymbol\omega}][I]\boldsymbol\omega + \mathbf{L}",
        r"[I]\dot{\boldsymbol\omega} = [\tilde{\boldsymbol\omega}][I]\boldsymbol\omega + \mathbf{L}",
    ),
    "left-superscript": (
        (
            r"\mathbb{I}_G\cdot{}^{\mathcal B}\frac{d}{dt}{}^{\mathcal I}\boldsymbol\omega^{\mathcal B}"
            r" + {}^{\mathcal I}\boldsymbol\omega^{\mathcal B}\times(\mathbb{I}_G\cdot"
            r"{}^{\mathcal I}\boldsymbol\omega^{\mathcal B}) = \mathbf{M}_G"
        ),
        (
            r"\mathbb{I}_G\cdot{}^{\mathcal B}\frac{d}{dt}{}^{\mathcal I}\boldsymbol\omega^{\mathcal B}"
            r" + {}^{\mathcal B}\boldsymbol\omega^{\mathcal I}\times(\mathbb{I}_G\cdot"
            r"{}^{\mathcal I}\boldsymbol\omega^{\mathcal B}) = \mathbf{M}_G"
        ),
    ),
    "kane": (
        r"{}^N\mathbf{H}^{B/B^*} = \mathbf{I}^{B/B^*}\cdot{}^N\boldsymbol\omega^B",
        r"{}^N\mathbf{H}^{B/B^*} = \mathbf{I}^{B/B^*}\cdot{}^B\boldsymbol\omega^N",
    ),
    "hughes": (
        r"\mathbf{I}\dot{\bm\omega} + \bm\omega^\times\mathbf{I}\bm\omega = \mathbf{g}",
        r"\mathbf{I}\dot{\bm\omega} + (\mathbf{I}\bm\omega)^\times\bm\omega = \mathbf{g}",
    ),
    "physics-bold": (
        (
            r"\frac{d\mathbf{L}}{dt} = \mathbf{J}\dot{\boldsymbol\omega} + "
            r"\boldsymbol\omega\times\mathbf{J}\boldsymbol\omega = \mathbf{N}"
        ),
        r"\frac{d\mathbf{L}}{dt} = \mathbf{J}\dot{\boldsymbol\omega} = \mathbf{N}",
    ),
    "underline-bullet": (
        (
            r"\underline{r}_\bullet^{\bullet} = \underline{r}_\bullet^{\circ} + "
            r"\underline\omega\times\underline{r}_\bullet"
        ),
        (
            r"\underline{r}_\bullet^{\bullet} = \underline{r}_\bullet^{\circ} - "
            r"\underline\omega\times\underline{r}_\bullet"
        ),
    ),
}


@pytest.mark.parametrize("name", EULER)
def test_a_law_holds_in_every_notation_and_its_slip_does_not(name):
    right, wrong = EULER[name]
    assert holds(right, preset(name), RIGID)
    assert not holds(wrong, preset(name), RIGID)


SCALARS = {
    "arrow-tilde": r"I_{11}\dot\omega_1 = (I_{22} - I_{33})\omega_2\omega_3 + L_1",
    "schaub-junkins": r"I_{22}\dot\omega_2 = (I_{33} - I_{11})\omega_3\omega_1 + L_2",
    "left-superscript": r"I_3\dot\omega_3 + (I_2 - I_1)\omega_1\omega_2 = M_3",
    "kane": r"I_1\dot u_1 = (I_2 - I_3)u_2u_3 + T_1",
    "hughes": r"\dot\omega_2 = \frac{(I_3 - I_1)\omega_3\omega_1 + g_2}{I_2}",
    "physics-bold": r"\dot L_1 + \omega_2L_3 - \omega_3L_2 = \tau_1",
}


@pytest.mark.parametrize("name", SCALARS)
def test_scalar_laws_hold_in_principal_axes_alone(name):
    assert holds(SCALARS[name], preset(name), PRINCIPAL)
    if "L_3" not in SCALARS[name]:
        assert not holds(SCALARS[name], preset(name), RIGID)


ARROWS = parse_lexicon(
    r"""
preset = 'arrow-tilde'
[symbols]
'\vec a' = 'vector a'
'\vec b' = 'vector b'
'\vec c' = 'vector c'
'a_{<k>}' = '= \hat{b}_<k> \cdot \vec a'
's' = 'scalar s'
'k' = 'defined'
'H' = '= |\vec H_C|'
'S' = 'skew'
'\vec f(\vec r)' = 'force dm per volume'
'\sigma' = {is = 'mass dm per volume', function = true}
"""
)
TRUE = {
    r"\vec a\times(\vec b\times\vec c) = \vec b(\vec a\cdot\vec c) - \vec c(\vec a\cdot\vec b)": (),
    r"\vec a\times\vec b = [\tilde{\vec a}]\vec b = [\vec a]_\times\vec b = \vec a^\times\vec b": (),
    r"S(\vec a)\vec b = -S(\vec b)\vec a": (),
    r"S(\vec a) = \begin{bmatrix}0&-a_3&a_2\\a_3&0&-a_1\\-a_2&a_1&0\end{bmatrix}": (),
    r"\vec a^T[I]\vec b = \vec b^T[I]\vec a, \quad [I]^T = [I], \quad [I][I]^{-1}\vec a = \vec a": (),
    r"\mathrm{tr}[I] = 2\int_B \vec r\cdot\vec r\,dm = I_{11} + I_{22} + I_{33} = \sum_{k=1}^3 I_{kk}": (),
    r"M\vec R_C = \int_B\vec R\,dm = \int_B\vec R\,\sigma(\vec r)\,dV, \quad \int_B\vec r\,dm = 0": (),
    r"\ddot{\vec R} = \frac{d^2\vec R}{dt^2} = \frac{^Id}{dt}\frac{^Id\vec R}{dt}": (),
    r"\vec F = \int_B\vec f(\vec r)\,dV": (),
    r"|\vec a\times\vec b|^2 = |\vec a|^2|\vec b|^2 - (\vec a\cdot\vec b)^2": (),
    r"T_{\text{rot}} = \tfrac12\vec\omega\cdot\vec H_C = \frac{1}{2}\vec\omega^T[I]\vec\omega": RIGID,
    r"\vec H_C\cdot\hat b_1 = I_{11}\omega_1 + I_{12}\omega_2 + I_{13}\omega_3": RIGID,
    r"\vec H_C = \text{constant} \quad \vec L_C = 0": ("torque_free",),
    r"\dot{\vec R}_C \equiv \frac{^Bd\vec R_C}{dt} + \vec\omega\times\vec R_C": (),
}


@pytest.mark.parametrize("text", TRUE)
def test_true_statements_hold_in_random_worlds(text):
    assert holds(text, ARROWS, TRUE[text])


FALSE = (
    r"\vec a\times(\vec b\times\vec c) = (\vec a\times\vec b)\times\vec c",
    r"\vec a\times\vec b = \vec b\times\vec a",
    r"S(\vec a)\vec b = S(\vec b)\vec a",
    r"\mathrm{tr}[I] = \int_B\vec r\cdot\vec r\,dm",
    r"M\vec R_C = \int_B\vec r\,dm",
    r"\dot{\vec R}_C = \frac{^Bd\vec R_C}{dt}",
    r"|\vec a\times\vec b|^2 = |\vec a|^2|\vec b|^2",
)


@pytest.mark.parametrize("text", FALSE)
def test_false_statements_fail(text):
    assert not holds(text, ARROWS)


# -- refusals --------------------------------------------------------------------------------------

REFUSED = {
    # a type error is ill-formed: formula, verdict, what is marked
    r"\vec a = s": ("ill-formed", "s"),
    r"[I] = \vec a": ("ill-formed", r"\vec a"),
    r"\vec a\vec b = 0": ("ill-formed", r"\vec a\vec b"),
    r"s\times\omega_1 = 0": ("ill-formed", r"s\times\omega_1"),
    r"[\dot{\vec\omega}][I]\vec\omega = 0": ("ill-formed", r"[\dot{\vec\omega}][I]"),
    r"\vec a + [I] = 0": ("ill-formed", "[I]"),
    r"\frac{s}{\vec a} = 0": ("ill-formed", r"\vec a"),
    r"\vec a\cdot[I]^{-1} = \sin\vec a": ("ill-formed", r"\vec a"),
    r"\mathrm{tr}\,\vec a = 0": ("ill-formed", r"\mathrm{tr}\,\vec a"),
    r"\frac{s}{0} = 1": ("ill-formed", "0"),
    # an error of dimensions is wrong
    r"\vec H_C = \vec\tau_C": ("wrong", r"\vec\tau_C"),
    r"\vec H_C = \int_B\vec r\times\vec r\,dm": ("wrong", r"\int_B\vec r\times\vec r\,dm"),
    r"[I]\vec\omega + \vec\omega\times[I]\vec\omega = \vec\tau_C": (
        "wrong",
        r"\vec\omega\times[I]\vec\omega",
    ),
    r"\sin\omega_1 = 0": ("wrong", r"\omega_1"),
    r"H^2 = I_{11}\omega_1^2": ("wrong", r"I_{11}\omega_1^2"),
    # what is not known decides nothing
    r"\vec q = \vec H_C": ("undecided", r"\vec q"),
    r"\vec H_C = \vec H_Q": ("undecided", r"\vec H_Q"),
    r"\frac{^Qd\vec r}{dt} = 0": ("undecided", "Q"),
    r"\vec a' = 0": ("undecided", r"\vec a'"),
    r"\int_0^1 s\,dt = 0": ("undecided", r"\int_0^1 s\,dt"),
    r"\sum_{q\in Q} s = 0": ("undecided", r"\sum_{q\in Q} s"),
    r"s^{9^{9^9}} = 1": ("undecided", r"s^{9^{9^9}}"),
    r"k = k": ("undecided", "k"),
    # two readings
    r"\vec a\times\vec b\times\vec c = 0": ("ambiguous", r"\vec a\times\vec b\times\vec c"),
    r"s \pm 1 = 0": ("ambiguous", r"s \pm 1"),
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_has_no_meaning_is_a_finding_with_its_place(text):
    verdict, place = REFUSED[text]
    (claim,) = claimed(text, ARROWS)
    assert claim.verdict == verdict, claim.findings
    marked = {text[f.span.start : f.span.stop].strip() for f in claim.findings}
    assert place in marked


def test_components_of_different_frames_do_not_meet():
    lexicon = parse_lexicon(
        "preset = 'underline-bullet'\n[symbols]\n'\\underline{J}_{<F>}' = 'inertia O in <F>'\n"
        "'\\underline{a}' = 'vector a'"
    )
    for text in (
        r"\underline{J}_B = C_{BA}\underline{J}_B C_{AB}",
        r"\underline{a}_B = C_{AB}\underline{a}_A",
        r"\underline{a}_B + \underline{a}_A = 0",
        r"\underline{a} = \mathcal{F}_B^T\underline{a}_A",
        r"\underline{J}_B = \underline{J}_A",
    ):
        assert claimed(text, lexicon)[0].verdict == "ill-formed", text
    assert holds(r"\underline{J}_B = C_{BA}\underline{J}_A C_{AB}", lexicon)
    assert holds(
        r"\underline{a} = \mathcal{F}_B^T\underline{a}_B = \mathcal{F}_A^T\underline{a}_A", lexicon
    )
    assert holds(r"\underline{a}_B = C_{BA}\underline{a}_A = C_{BI}\underline{a}_I", lexicon)
    assert holds(
        r"\underline{r}_{\bullet I}^{} = C_{IA}\underline{r}_{\bullet A}, \quad "
        r"\dot{C}_{BI} = -\underline{\omega}_B^\times C_{BI}",
        lexicon,
    )
    assert not holds(r"\dot{C}_{BI} = \underline{\omega}_B^\times C_{BI}", lexicon)


def test_the_rest_of_a_chain_is_kept_where_a_member_has_no_meaning():
    (claim,) = claimed(r"\vec H_C = \vec q = \int_B\vec r\times\dot{\vec r}\,dm", ARROWS)
    assert claim.verdict == "undecided"
    assert len(claim.members) == 2
    assert decide(equations(claim)[0], (), claim.scalars)


def test_unknown_dimensions_agree_with_all():
    free = parse_lexicon("preset = 'arrow-tilde'\n[symbols]\n'\\lambda' = 'scalar lambda'")
    (claim,) = claimed(r"[I]\vec\omega = \lambda\vec\omega", free)
    assert not claim.findings


# -- kinds of claims -------------------------------------------------------------------------------


def test_definitions_hold_from_there_on():
    found = claimed(
        r"\vec q \triangleq M\dot{\vec R}_C, \quad \dot{\vec q} = M\ddot{\vec R}_C", ARROWS
    )
    assert [c.kind for c in found] == [DEFINITION, "statement"]
    assert not any(c.findings for c in found)
    assert decide(equations(found[1])[0], ("constant_mass",), found[1].scalars)
    (again,) = claimed("k = 2 s", ARROWS)
    assert again.kind == DEFINITION
    assert claimed("k = 3 s", ARROWS, defined([again]))[0].kind == "statement"
    assert claimed(r"\vec H_C \triangleq [I]\vec\omega", ARROWS)[0].kind == "statement"


def test_constants_and_points():
    (constant,) = claimed(r"|\vec H_C| = \text{constant}", ARROWS)
    assert constant.kind == CONSTANT
    assert constant.members[0].dimension.words == "kg^2 m^4/s^3"
    assert decide(equations(constant)[0], ("torque_free",), constant.scalars)
    assert not decide(equations(constant)[0], RIGID, constant.scalars)
    points = preset("underline-bullet")
    (same,) = claimed(r"O \equiv \bullet", points)
    assert same.kind == SAME_POINT
    assert decide(equations(same)[0], ("about_centre",), {})


@pytest.mark.parametrize(
    "text",
    [
        r"\begin{aligned} \vec H_C &= \int_B\vec r\times\dot{\vec r}\,dm \\ &= [I]\vec\omega \end{aligned}",
        r"\vec H_C = \int_B\vec r\times\dot{\vec r}\,dm, \quad = [I]\vec\omega",
    ],
)
def test_a_leading_sign_continues_the_first_member(text):
    first, second = claimed(text, ARROWS)
    assert not first.findings + second.findings
    assert (first.previous, second.previous.span) == (None, first.members[-1].span)
    left, right = (m.term for m in second.members)
    assert left == column(first.members[0].term, "B")
    assert decide(Equation(left, right), RIGID, second.scalars)


def test_conditions_arrows_and_braces_are_claims_of_their_own():
    found = claimed(
        r"\vec L_C = 0 \Rightarrow \dot{\vec H}_C = 0 \quad\text{if}\quad s = 0", ARROWS
    )
    assert {(c.role, c.joined) for c in found} >= {("", ""), ("if", ""), ("", "implies")}
    whole, brace = claimed(r"H = \underbrace{|\vec H_C|}_{H} + 0", ARROWS)
    assert not whole.findings
    assert not brace.findings
    assert whole.span != brace.span
    labels = claimed(
        r"T = \underbrace{\tfrac12 M\dot{\vec R}_C\cdot\dot{\vec R}_C}_{\text{Translational}}",
        ARROWS,
    )
    assert len(labels) == 1


# -- anything at all -------------------------------------------------------------------------------

PIECES = st.sampled_from(
    r"\vec{a}|\vec{b}|[I]|s|\omega_1|=|=|+|-|\times|\cdot|\dot{s}|^T|^2|^{-1}|_B|_1|(|)|[|]|\frac{d}{dt}|"
    r"\int_B|dm|dV|\sum_{i=1}^N|m_i|\sin|\sigma(\vec r)|\vec f(\vec r)|0|1|,|\quad|\Rightarrow|"
    r"\tilde{\vec a}|"
    r"\mathrm{tr}|\begin{bmatrix}1\\2\\3\end{bmatrix}|\sqrt{s}|/|k|\triangleq|\text{if}|'".split(
        "|"
    )
)


@given(st.lists(PIECES, min_size=2, max_size=14))
def test_no_formula_breaks_the_elaboration(pieces):
    text = " ".join(pieces)
    try:
        tree = read_formula(text).tree
    except ReadingError:
        return
    for statement in split(tree):
        for claim in claims(statement, ARROWS):
            assert claim.verdict or claim.members
            for finding in claim.findings:
                assert 0 <= finding.span.start <= finding.span.stop <= len(text) + 1


HOSTILE = {
    "a power of powers": "(" * 20 + "s" + ")^{12}" * 20 + " = 1",
    "powers of a number": "(" * 20 + "3" + ")^{12}" * 20 + " = 1",
    "squares of vectors": "(" * 40 + r"\vec a" + r")^2\vec a" * 40 + r" = \vec b",
    "determinants": r"\det\begin{bmatrix}" * 8
    + "s"
    + r"&0&0\\0&s&0\\0&0&s\end{bmatrix}" * 8
    + " = s",
    "a long sum": " + ".join([r"\vec a\times\vec b"] * 3000) + r" = \vec c",
    "a long number": "1" * 5000 + " = s",
}


MOST_CALLS = 4_500_000
"""About a second."""


@pytest.mark.parametrize("name", but(HOSTILE, "a long sum"))
def test_hostile_formulas_end_soon(name):
    found = []

    def work():
        with suppress(ReadingError):
            found.extend(claimed(HOSTILE[name], ARROWS))

    assert calls(work) < MOST_CALLS
    assert all(c.verdict or c.members for c in found)


def test_meanings_in_circles_are_undecided():
    lexicon = parse_lexicon("[symbols]\n'a' = '= b + b'\n'b' = '= a'\n'c' = '= c'")
    for text in ("a = 1", "c = 1"):
        assert claimed(text, lexicon)[0].verdict == "undecided"
