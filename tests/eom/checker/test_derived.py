"""Our own derivations, written in every notation, are notes in which nothing is wrong."""

import pytest
from click.testing import CliRunner

import eom
from eom.__main__ import main
from eom.checker.mean.lexicon_files import lexicon_for
from eom.checker.note.derived import PRESETS, front_matter
from eom.derivations import derive
from eom.derivations.forms import show_derivation
from eom.typeset.notation import NOTATIONS
from tests.eom.rows import only

READ = (
    "point-mass", "particle-system", "transport-theorem", "tilde-identities", "rigid-body-momentum",
    "kinetic-energy", "inertia-properties", "energy-dissipation",
)  # fmt: skip
"""Derivations whose pages are judged."""
NO_BODY = "not an integral over a body"
UNSEEN = "no counterexample"
OPEN = {
    ("rigid-body-momentum", "arrow"): {
        r"\dot{\vec{p}} = \int_{B}": NO_BODY,
        r"\vec{F}_{\mathrm{ext}} \triangleq \int_{B}": NO_BODY,
        r"\vec{\tau}_{O} \triangleq \int_{B}": NO_BODY,
        r"\left[ I_{C} \right]_{B} = \begin{bmatrix} S": "symbol without a meaning",
    },
    ("rigid-body-momentum", "underline"): {
        r"\underline{p}^{\bullet} = \int_{m}": NO_BODY,
        r"\underline{f}_{\mathrm{ext}} \triangleq \int_{m}": NO_BODY,
        r"\underline{\tau}_{O} \triangleq \int_{m}": NO_BODY,
        r"\mathbf{I} = \begin{bmatrix} S": "symbol without a meaning",
    },
    ("energy-dissipation", "arrow"): {
        r"J_{s} \ge 0": UNSEEN,
        r"I_{3} - I_{1} \ge 0": "a condition",
        r"I_{3} - I_{2} \ge 0": "a condition",
        r"I_{3} + J_{s} \ge 0": UNSEEN,
        r"2 I_{1} I_{2} + I_{1} J_{s} + I_{2} J_{s} \ge 0": UNSEEN,
        "\\begin{aligned}\n & 2 J_{s}^{5}": "a condition",
        "\\begin{aligned}\n & H \\\\\n": "its roots leave open",
        "\\begin{aligned}\n & H": "its roots leave open",
    },
    ("transport-theorem", "underline"): {
        r"\dot{\mathbf{C}}_{BI} = ": "symbol without a meaning",
        "\\begin{aligned}\n\\dot{\\mathbf{v}}_{I}": "symbol without a meaning",
    },
}
"""The formulas of a page that stay undecided, by how they begin, and why: integrals of dp and of dF, which
are none of the body, letters for matrices that no line before defines, conditions, and signs that no form
shows."""


def page(name, notation):
    derivation = derive(name)
    return front_matter(derivation, notation) + show_derivation(derivation, "markdown", notation)


PAGES = [
    *((name, "arrow") for name in READ),
    *((name, n) for name in ("point-mass", "transport-theorem") for n in NOTATIONS if n != "arrow"),
    ("inertia-properties", "kane"),
    ("rigid-body-momentum", "underline"),
    ("kinetic-energy", "superscript"),
]


SHORT = (
    ("point-mass", "arrow"),
    ("point-mass", "underline"),
    ("transport-theorem", "superscript"),
    ("transport-theorem", "kane"),
)
"""Every notation once."""


@pytest.mark.parametrize(("name", "notation"), only(PAGES, *SHORT))
def test_every_line_of_a_derivation_is_found_to_hold(name, notation):
    found = eom.check(page(name, notation)).findings
    wrong = [f.latex for f in found if f.verdict in {"wrong", "ill-formed", "ambiguous"}]
    assert wrong == []
    undecided = [f for f in found if f.verdict == "undecided"]
    known = OPEN.get((name, notation), {})
    assert len(undecided) == len(known)
    for formula, (beginning, reason) in zip(undecided, known.items(), strict=True):
        assert formula.latex.startswith(beginning)
        assert formula.reason.startswith(reason)
    assert len(found) >= 20


@pytest.mark.parametrize("notation", only(NOTATIONS, "arrow"))
def test_a_changed_line_of_a_derivation_is_wrong(notation):
    text = page("point-mass", notation)
    lines = text.splitlines()
    (place,) = (k for k, line in enumerate(lines) if "\\frac{1}{2} m" in line and "aligned" not in line
                and "$$" in line and "triangleq" in line)  # fmt: skip
    lines[place] = lines[place].replace("\\frac{1}{2} m", "m")
    found = eom.check("\n".join(lines)).findings
    assert [f.verdict for f in found].count("wrong") >= 1


def test_every_notation_has_a_preset():
    assert set(PRESETS) == set(NOTATIONS)


def test_the_option_writes_front_matter_that_can_be_read():
    run = CliRunner().invoke(main, ["derive", "point-mass", "--as", "markdown", "--lexicon"])
    assert run.exit_code == 0
    assert run.stdout.startswith("+++\n[check]\n")
    assert lexicon_for(run.stdout) is not None
    refused = CliRunner().invoke(main, ["derive", "point-mass", "--lexicon"])
    assert refused.exit_code == 2
    assert "--as markdown" in refused.stderr


def test_laws_are_written_with_letters_that_have_a_meaning_before():
    """A moment of inertia that another is made of is put in, and so on."""
    text = front_matter(derive("collisions"))
    law = next(line for line in text.splitlines() if "Omega" in line and line.startswith("law"))
    assert "J" not in law
    assert lexicon_for(text) is not None


def test_what_no_front_matter_can_say_is_refused():
    run = CliRunner().invoke(main, ["derive", "virtual-work", "--as", "markdown", "--lexicon"])
    assert run.exit_code == 2
    assert "places of all masses" in run.stderr
    assert "q_1, q_2" in run.stderr


def test_a_special_body_that_words_state():
    """All mass on one line: no moment about it. Elsewhere the same line is wrong."""
    note = "+++\n[check]\npreset = 'arrow-tilde'\n[check.notation]\njuxtaposed = true\n[check.symbols]\n"
    note += "'\\vec{\\rho}' = 'position dm O'\n'I_{O}' = 'inertia O'\n+++\n\n"
    line = "\n\n$$[I_O] \\vec\\rho = \\vec 0$$\n"
    (found,) = eom.check(
        note + "The body is a thin rod, and O is its centre of mass." + line
    ).findings
    assert found.verdict == "holds under"
    assert set(found.sets[0]) == {"thin_rod", "about_centre"}
    (found,) = eom.check(note + "O is its centre of mass." + line).findings
    assert found.verdict == "wrong"
