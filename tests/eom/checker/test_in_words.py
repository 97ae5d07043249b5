"""Claims in words: what is read, what is wrong with numbers, what is proved, what is left alone."""

import json

import pytest
import sympy as sp

from eom.checker.note.checking import check
from eom.checker.prose_claims.in_words import decided
from eom.checker.prose_claims.phrases import Formulas, clause
from eom.checker.prose_claims.propositions import truth
from eom.checker.prose_claims.quantified import quantified
from eom.worlds.special import specials
from tests.eom.rows import every, only

NOTHING = Formulas({}, {}, {})


def claims(text):
    return check(text + "\n", notation="arrow-tilde", kind="markdown").claims


def verdicts(text):
    return [f.verdict for f in claims(text)]


PROVED = [
    "If no external torque acts, the angular momentum is constant in inertial space.",
    r"The angular momentum $\vec H_C$ is constant in the inertial frame if and only if $\vec L_C = 0$.",
    "The angular momentum is along the angular velocity only if the body spins about a principal axis.",
    r"The kinetic energy of rotation is constant if $\vec L_C\cdot\vec\omega = 0$.",
    "If the angular velocity is constant, the torque is perpendicular to the angular momentum.",
    "The torque is zero only if the rotational kinetic energy is constant.",
    "The angular momentum does not change unless a torque acts.",
    "The angular momentum is constant.",
]


@pytest.mark.parametrize("text", only(PROVED, PROVED[2], PROVED[7]))
def test_what_follows_holds_under_assumptions(text):
    (found,) = claims(text)
    assert found.verdict == "holds under"
    assert found.sets[0]


WRONG = [
    "The angular velocity is constant only if the torque is zero.",
    "The rotation rate (or so) is constant only if torque is zero AND it spins about 1 principal axis.",
    "The angular momentum is constant in the body frame if no torque acts.",
    "The torque is zero if the kinetic energy of rotation is constant.",
    "The torque is zero if and only if the magnitude of the angular momentum is constant.",
    "If the angular velocity is parallel to the angular momentum, the torque is zero.",
    r"$\vec\omega$ is constant in the body frame whenever $\vec L_C = 0$.",
]


@pytest.mark.parametrize("text", every(3, WRONG))
def test_wrong_claims_come_with_a_motion_that_fulfils_eulers_equations(text):
    (found,) = claims(text)
    assert found.verdict == "wrong"
    assert "it fails in a motion" in found.reason
    values = [v.removeprefix(r"\mathrm{diag}") for _, v in found.explanation.counterexample.values]
    moments, w, a, m = (
        sp.Matrix([sp.Rational(c) for c in v.strip("()").split(", ")]) for v in values
    )
    J = sp.diag(*moments)
    assert J * a + w.cross(J * w) == m


def test_the_motion_refutes_by_its_numbers():
    (found,) = claims("The angular velocity is constant only if the torque is zero.")
    values = dict(found.explanation.counterexample.values)
    assert values[r"\dot\omega"] == "(0, 0, 0)"
    assert values["M_C"] != "(0, 0, 0)"


TRUE = [
    "If the body is spherical, the angular momentum is along the angular velocity.",
    "If the body is spherical and the torque is zero, the angular velocity is constant.",
    "Even if no torque acts, the angular velocity is changing.",
    "In general, the angular velocity is not constant if no torque acts.",
    "The torque is parallel to the angular velocity if the body spins about a principal axis.",
    r"$\vec H_C = 0$ only if $\vec\omega = 0$.",
    "When the body is not rotating, the angular momentum vanishes.",
]


@pytest.mark.parametrize("text", every(5, TRUE))
def test_true_claims_are_not_called_wrong_where_no_proof_is_found(text):
    assert verdicts(text) == ["undecided"]


@pytest.mark.parametrize(
    "before",
    [
        "Consider a spherical body.",
        "Suppose the body spins about its axis of symmetry.",
        "Let the wheel turn at a constant rate.",
    ],
)
def test_what_a_section_may_assume_leaves_a_claim_undecided(before):
    claim = "The angular velocity is constant if no torque acts."
    assert verdicts(claim) == ["wrong"]
    assert verdicts(f"{before} {claim}") == ["undecided"]
    assert verdicts(f"# One\n\n{before}\n\n# Two\n\n{claim}") == ["wrong"]


def test_stated_assumptions_narrow_down_the_motions():
    text = "The motion is torque-free.\n\nThe angular velocity is constant only if no torque acts."
    assert verdicts(text) == ["undecided"]


def test_claims_that_rest_on_what_stands_before_are_not_called_wrong():
    text = "Therefore, the angular velocity is constant only if the torque is zero."
    assert verdicts(text) == ["undecided"]


@pytest.mark.parametrize(
    "text",
    [
        "The torque is zero.",
        "The torque is zero only if the wheels are locked.",
        "The angular velocity is nearly constant if the torque is zero.",
        "The angular velocity may change even if no torque acts.",
        "If the torque is zero, the angular velocity of the rotor is constant.",
        "In this case the angular momentum is constant if the torque is zero.",
        r"Suppose that $\vec L_C = 0$ and the angular velocity is constant.",
        "if if if only if only if",
    ],
)
def test_sentences_with_other_words_are_left_alone(text):
    assert verdicts(text) == []


def test_two_conditions_and_both_directions():
    one = quantified(
        "if no torque acts, the angular velocity is constant if and only if the body is spinning about a "
        "principal axis",
        NOTHING,
    )
    assert one.kind == "if and only if"
    assert len(one.implications) == 2


def test_what_depends_on_the_reading_is_open():
    turning = clause("the body is rotating about one axis", NOTHING)
    across = next(
        s
        for s in specials()
        if "constant rates" in s.words and dict(s.data)[r"\omega"] == "(1, 1, 0)"
    )
    along = next(
        s
        for s in specials()
        if "constant rates" in s.words and dict(s.data)[r"\omega"] == "(1, 0, 0)"
    )
    assert truth(turning, across.world) is None
    assert truth(turning, along.world) is True


STABILITY = {
    "rotation about the axis of intermediate moment of inertia is unstable": "holds under",
    "rotation about the intermediate axis is stable": "wrong",
    "rotations about the axes of maximum and minimum inertia are stable": "holds under",
    "spin about the axis of minimum inertia is unstable with energy dissipation": "holds under",
    "spin about the minor axis is stable in the presence of energy dissipation": "wrong",
    "spin about the minor axis is unstable": "undecided",
    "without dissipation, spin about the minor axis is unstable": "wrong",
    "only spin about the major axis is stable with energy dissipation": "holds under",
    "with energy dissipation, spin of a prolate body about its axis of symmetry is unstable": "holds under",
    "spin of an oblate body about its symmetry axis is unstable": "wrong",
    "the torque-free precession of an oblate body is retrograde": "holds under",
    "precession of a prolate body is retrograde": "wrong",
    "note that pure spin about the axes of least and greatest inertia is always stable": "holds under",
    "in general, rotation about the middle axis is stable": "wrong",
    "this implies that rotation about the middle axis is stable": "undecided",
    "for a rigid body, spin about the minor axis is unstable": "wrong",
    "the free precession of an oblate spacecraft is prograde": "wrong",
}


@pytest.mark.parametrize("text", every(3, STABILITY))
def test_stability_by_the_linearised_equations(text):
    assert decided(text).verdict == STABILITY[text]


@pytest.mark.parametrize(
    "text",
    [
        "rotation about the intermediate axis is stable on tuesdays",
        "spin of a prolate body about its minor axis is stable",
        "rotation about its axis of symmetry is stable",
    ],
)
def test_spins_of_bodies_that_are_not_known_are_left_alone(text):
    assert decided(text) is None


def test_stability_of_other_bodies_is_not_judged():
    claim = "Rotation about the intermediate axis is stable."
    assert verdicts(claim) == ["wrong"]
    assert verdicts(f"A fast wheel is mounted in it. {claim}") == ["undecided"]


def test_reports_distinguish_claims_from_equations():
    from eom.checker.read.documents import read_document
    from eom.checker.report.findings import Graded, report_lines, rows, text, to_json
    from eom.checker.report.page import page

    note = r"""A line: $\vec H_C = I_C\vec\omega$.

The angular velocity is constant only if the torque is zero <b>.
"""
    report = check(note, notation="arrow-tilde", kind="markdown")
    assert [f.kind for f in report.findings] == ["inline", "prose"]
    (claim,) = report.claims
    assert claim.line == 3
    assert claim in report.faults
    graded = Graded("n.md", report)
    printed = [text(line) for line in report_lines(graded)]
    assert printed[-1].startswith("  1 equation and 1 claim in words: 1 wrong")
    data = json.loads(to_json([graded]))
    assert [f["kind"] for f in data["notes"][0]["findings"]] == ["inline", "prose"]
    assert rows([graded])[0]["equations"] == 1
    shown = page(read_document(note), report)
    assert 'href="#prose-1"' in shown
    assert 'id="prose-1"' in shown
    assert "<b>" not in shown
