"""Words that point to equations: terms of them, where they hold, what they show; theorems in words."""

from __future__ import annotations

from dataclasses import replace

import pytest

from eom import check
from eom.checker.prose_claims.in_words import NOTHING, decided
from eom.checker.prose_claims.phrases import THEOREMS
from eom.checker.prose_claims.sentences import opened
from tests.eom.rows import every

TORQUE = r"$$\vec\tau_O = \dot{\vec H}_O + M\vec r_{C/O}\times\ddot{\vec R}_O \tag{3.15}$$" + "\n\n"
SYSTEM = r"""+++
[check]
preset = "arrow-tilde"
[check.points]
'O' = "O"
[check.symbols]
'\vec\tau_{<P>}' = "torque body <P>"
'\vec H_{<P>}' = "angular_momentum body <P>"
'\vec R_O' = "position O OI"
'\vec r_{C/O}' = "position C O"
'I' = "inertia C in B"
+++

"""


def claims(text: str):
    """Return what is found of the claims in words of a note."""
    return check(SYSTEM + text + "\n", kind="markdown", seconds=100.0).claims


HOLD = [
    "The second term vanishes if $O$ is inertially fixed.",
    r"The last term on the right-hand side is zero if $O$ is the centre of mass.",
    (
        r"The second term in Eq. (3.15) vanishes in two special cases: if $O$ is inertially fixed (a "
        "pivot), or if $O$ is at the center of mass."
    ),
    r"The second term is zero when $\dot{\vec R}_O = 0$.",
    "The second term vanishes if $O$ is an arbitrary fixed point.",
    r"The difference between $\vec H_O$ and $\vec H_C$ vanishes if $O$ is the centre of mass.",
    r"The distinction between $\vec\tau_C$ and $\vec\tau_O$ is zero when $O$ is at the c.m.",
]


@pytest.mark.parametrize("words", every(2, HOLD))
def test_terms_of_an_equation(words: str) -> None:
    """A term that is pointed to is what is claimed to vanish."""
    (found,) = claims(TORQUE + words)
    assert found.verdict in {"holds", "holds under"}, found.reason
    assert "body_frame" not in {n for s in found.sets for n in s}


@pytest.mark.parametrize(
    "words",
    [
        "The first term vanishes if $O$ is inertially fixed.",
        "The second term of (3.15) vanishes only if $O$ is the centre of mass.",
        pytest.param(
            r"Eq. (3.15) holds only if $O$ is the centre of mass.", marks=pytest.mark.slow
        ),
    ],
)
def test_false_claims_about_terms_are_not_said_to_hold(words: str) -> None:
    """They are wrong, or nothing is said of them."""
    assert all(f.verdict in {"wrong", "undecided"} for f in claims(TORQUE + words))


def test_a_term_that_is_not_there_is_no_claim() -> None:
    """The third of two terms is none."""
    assert not claims(TORQUE + "The third term vanishes if $O$ is inertially fixed.")


EULER = r"$$[I]\dot{\vec\omega} = -[\tilde{\vec\omega}][I]\vec\omega + \vec\tau_C"


@pytest.mark.parametrize(
    ("words", "verdict"),
    [
        ("valid if taken about the centre of mass", "holds under"),
        ("valid about the CM or a point fixed in the body and in space", "holds under"),
        ("Valid if calculated about CM or an arbitrary inertial point.", "wrong"),
        ("valid about any point", "wrong"),
    ],
)
def test_the_point_of_an_equation(words: str, verdict: str) -> None:
    """An equation about a point that is fixed in space needs that it is fixed in the body, too."""
    (beside,) = claims(EULER + rf" \quad \text{{({words})}}$$")
    assert beside.verdict == verdict, beside.reason
    (behind,) = claims(EULER + f" \\tag{{5}}$$\n\nEquation (5) is {words[0].lower()}{words[1:]}")
    assert behind.verdict == verdict, behind.reason
    if "inertial" in words:
        assert "fixed in the body as well" in beside.reason


EIGEN = r"""+++
[check]
preset = "underline-bullet"
[check.frames]
'P' = "B"
'B' = "A"
[check.symbols]
'\mathbf{E}' = "eigenvectors A B"
'\mathbf{J}_{<F>}' = "inertia O in <F>"
+++

"""
DIAGONAL = r"$$\mathbf{E}^{-1}\mathbf{J}_B\mathbf{E} = \mathbf{J}_P \tag{7}$$" + "\n\n"


@pytest.mark.parametrize(
    "words",
    [
        r"which shows that $\mathbf{E}$ is, in fact, a rotation matrix.",
        r"Equation (7) proves that the matrix $\mathbf{E}$ is orthogonal.",
    ],
)
def test_what_an_equation_does_not_show(words: str) -> None:
    """Twice a matrix of eigenvectors is one; where the note says that they are unit vectors nothing is."""
    (found,) = check(EIGEN + DIAGONAL + words, kind="markdown", seconds=100.0).claims
    assert found.verdict == "wrong"
    assert "in place of" in found.reason
    before = "The eigenvectors are normalised. So we have\n\n"
    (found,) = check(EIGEN + before + DIAGONAL + words, kind="markdown", seconds=100.0).claims
    assert found.verdict == "undecided"


@pytest.mark.parametrize(
    ("words", "need"),
    [
        ("any body moves like a particle at its centre of mass", "third_law_weak"),
        ("the center of mass moves as if all the mass were concentrated there", "third_law_weak"),
        ("internal forces cannot change the angular momentum", "third_law_strong"),
        (
            "this implies that, in translation, each body behaves as if it were a particle",
            "third_law_weak",
        ),
        (
            "hence, the centroid accelerates as though all its mass were lumped there",
            "third_law_weak",
        ),
        ("in other words, internal forces never influence the linear momentum", "third_law_weak"),
        (
            "the time derivative of the total angular momentum about the c.m. equals the net torque",
            "third_law_strong",
        ),
    ],
)
def test_theorems(words: str, need: str) -> None:
    """They hold under the laws that they rest on."""
    around = replace(NOTHING, given=("constant_mass",))
    found = decided(words, around)
    assert found is not None
    assert found.sets == (("newton_2", need),)
    assert decided(f"{words} on sundays", around) is None


def test_every_theorem_is_one() -> None:
    """Rows that would not hold would be false statements of ours."""
    from eom.checker.judge.judge import judge
    from eom.checker.mean.claims import CONSTANT, Claim
    from eom.checker.mean.values import ANY, Value

    for _, nothing in THEOREMS:
        claim = Claim((Value(nothing, nothing.kind, None, ANY),), (), CONSTANT)
        assert judge(claim, ("constant_mass",)).verdict == "holds under"


@pytest.mark.parametrize(
    ("text", "other"),
    [
        ("see Eq. (3.13) (or not)", "see Eq  [3.13] (or not)"),
        ("(7) shows it. (8) too, as (9)", "[7] shows it. [8] too, as (9)"),
        (r"from \eqref{eq:a} and", "from [eq:a]       and"),
        ("in 2021 (a year)", "in 2021 (a year)"),
    ],
)
def test_references_stay_where_they_are(text: str, other: str) -> None:
    """Every character keeps its place."""
    assert opened(text) == other
    assert len(opened(text)) == len(text)
