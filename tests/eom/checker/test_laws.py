"""Laws of the writer's own, free scalars that a note defines, and what follows from either."""

from eom.checker.judge.notes import understand
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.note.review import review
from eom.checker.read.documents import read_document

LEXICON = parse_lexicon(
    r"""
preset = "left-superscript"
[symbols]
'\mathbf{h}' = "angular_momentum body C"
'T' = "rotational_energy body C"
'k' = { is = "scalar k", unit = "N m s" }
'a' = { is = "scalar a", unit = "m" }
'b' = { is = "scalar b", unit = "m" }
'\alpha' = "free_angle alpha"
'\beta' = "free_angle beta"
'x' = "defined"
'y' = "defined"
'J' = "defined"
"""
)
W = r"{}^{\mathcal{I}}\boldsymbol{\omega}^{\mathcal{B}}"
LAW = rf"\mathbf{{M}}_G = -k\,{W}"


def verdicts(*lines):
    """Verdicts in the light of the note, of displays in the order of the lines."""
    document = read_document("\n\n".join(f"$${line}$$" for line in lines))
    found = understand(document, LEXICON)
    return [r.verdict.verdict for r in review(document, found, ("constant_mass",))]


def test_the_first_line_with_a_free_scalar_is_a_law_and_others_follow_from_it():
    power = rf"\dot{{T}} = -k\,{W}\cdot {W}"
    square = rf"\frac{{d}}{{dt}}(\mathbf{{h}}\cdot\mathbf{{h}}) = -2k\,\mathbf{{h}}\cdot {W}"
    assert verdicts(LAW, power, square) == ["assumption", "holds under", "holds under"]


def test_a_slip_behind_a_law_is_wrong_and_what_is_not_known_to_follow_is_open():
    power = rf"\dot{{T}} = -2k\,{W}\cdot {W}"
    square = rf"\frac{{d}}{{dt}}(\mathbf{{h}}\cdot\mathbf{{h}}) = -k\,\mathbf{{h}}\cdot {W}"
    other = r"\dot{T} = -k\,\mathbf{h}\cdot\mathbf{h}"
    found = verdicts(LAW, power, square, other)
    assert found[:3] == ["assumption", "wrong", "wrong"]
    assert found[3] in {"undecided", "wrong"}


def test_a_scalar_that_is_known_makes_no_law():
    assert verdicts(r"x = a\cos\alpha", r"x = b\cos\alpha")[1] == "wrong"
    lines = (r"x = a\cos\alpha + b\sin\alpha", r"\cos\alpha = \frac{a}{b}")
    assert verdicts(*lines)[1] == "wrong"


def test_what_the_note_defines_keeps_the_meaning_of_its_letters():
    lines = (
        r"x = a\cos\alpha + b\cos(\alpha + \beta)",
        r"y = a\sin\alpha + b\sin(\alpha + \beta)",
        r"x^2 + y^2 = a^2 + b^2 + 2ab\cos\beta",
        r"x^2 + y^2 = a^2 + b^2 + ab\cos\beta",
    )
    assert verdicts(*lines)[2:] == ["holds", "wrong"]


def test_the_determinant_and_the_trace_of_a_matrix_of_any_size():
    table = r"\begin{bmatrix} \cos\alpha & \sin\alpha \\ -\sin\alpha & \cos\alpha \end{bmatrix}"
    lines = (rf"J = {table}", r"\det J = 1", r"\det J = -1", r"\operatorname{tr} J = 2\cos\alpha")
    assert verdicts(*lines)[1:] == ["holds", "wrong", "holds"]
    four = r"\begin{bmatrix} 0&1&0&0\\ 1&0&0&0\\ 0&0&2&0\\ 0&0&0&3 \end{bmatrix}"
    assert verdicts(rf"J = {four}", r"\det J = -6", r"\det J = 6")[1:] == ["holds", "wrong"]
    long = r"\begin{bmatrix} a & b \end{bmatrix}"
    assert verdicts(rf"J = {long}", r"\det J = a")[1] == "ill-formed"


def test_a_wrong_sign_is_not_excused_by_a_term_that_vanishes():
    right = r"I_2\dot\omega_2 = (I_3 - I_1)\,\omega_1\omega_3 + M_2"
    free = r"I_2\dot\omega_2 = (I_3 - I_1)\,\omega_1\omega_3"
    assert verdicts(right, free) == ["holds under", "holds under"]
    assert verdicts(right.replace("+ M_2", "- M_2")) == ["wrong"]


def test_what_a_law_gives_is_put_in_its_place():
    rolls = rf"\dot{{\mathbf{{r}}}}_{{G/O}} = {W}\times a\,\mathbf{{b}}_3"
    speed = r"\dot{\mathbf{r}}_{G/O}\cdot\dot{\mathbf{r}}_{G/O} = a^2(\omega_1^2 + \omega_2^2)"
    other = speed.replace("omega_2", "omega_3")
    slow = r"\ddot{\mathbf{r}}_{G/O} = a\,\dot{\boldsymbol{\omega}}\times\mathbf{b}_3"
    slow = slow.replace(r"\dot{\boldsymbol{\omega}}", rf"\frac{{{{}}^{{\mathcal{{I}}}}d}}{{dt}}{W}")
    assert verdicts(rolls, speed, other, slow) == ["assumption", "holds under", "wrong", "wrong"]
