"""Some steps of a derivation: which are chosen, and how they are shown."""

import pytest

import eom
from eom.checker.report.findings import Graded, report_lines, text


def labels(excerpt):
    return [step.label for step in excerpt.steps]


@pytest.fixture(scope="module")
def euler():
    return eom.derive("euler-equations")


def test_a_range_has_both_ends_and_keeps_the_order(euler):
    every = [step.label for step in euler.steps]
    first, last = every.index("law"), every.index("euler-dyadic")
    assert labels(euler.part("law", ..., "euler-dyadic")) == every[first : last + 1]
    assert labels(euler.part("euler-dyadic", "law")) == ["law", "euler-dyadic"]
    assert labels(euler.part(..., "local")) == every[: every.index("local") + 1]
    assert labels(euler.part("euler-3", ...)) == every[every.index("euler-3") :]
    assert labels(euler.part(...)) == every


def test_ranges_and_labels_go_together_and_count_once(euler):
    some = euler.part("law", ..., "torque-transport", "law", "euler-1")
    assert labels(some) == ["law", "transport", "torque-transport", "euler-1"]


def test_an_unknown_label_is_an_error_with_the_labels(euler):
    with pytest.raises(eom.InputError, match="euler-dyadic"):
        euler.part("euler-diadic")


def test_steps_keep_their_numbers_reasons_and_assumptions(euler):
    whole = euler._repr_markdown_()
    some = euler.part("momentum", ..., "local")
    shown = some._repr_markdown_()
    for line in shown.splitlines():
        assert line in whole or line.startswith("*Assumed from here on")
    assert "**4.** Momentum of a rigid body" in shown
    assert "the frame $B$ is fixed in the body" in shown  # said, though step 1 said so before
    assert "**3.**" not in shown
    assert "**8.**" not in shown


def test_the_first_line_of_a_chain_has_its_left_side(euler):
    """Step 2 continues step 1; alone, it needs a left side of its own."""
    alone = str(euler.part("transport"))
    assert "H⃗̇_C = " in alone


def test_an_excerpt_shows_itself_in_a_chosen_notation(euler):
    assert r"\underline{" in euler.part("law", notation="underline")._repr_markdown_()
    assert "LaTeX" not in str(euler.part("law"))


class Printer:
    def __init__(self):
        self.words = ""

    def text(self, words):
        self.words += words


def test_a_report_prints_itself_as_the_command_line_does():
    report = eom.check(r"\tau_1 = \omega_1", notation="arrow-tilde")
    printer = Printer()
    report._repr_pretty_(printer, False)
    assert printer.words == str(report)
    assert str(report) == "\n".join(
        text(line) for line in report_lines(Graded(report.name, report))
    )
