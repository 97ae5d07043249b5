"""Why lines about a system are wrong: repairs of slips, and what is left over in the writer's letters."""

import random
from itertools import islice

import pytest

from eom.checker.judge.coordinates import equations
from eom.checker.judge.notes import reread, understand
from eom.checker.judge.verdicts import GRAVE, verdict
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document
from eom.checker.read.grammar import read_formula
from eom.checker.repair.explaining import explain
from eom.worlds.solutions import rate
from tests.eom.checker.system_lines import left_side, load_model, names_of, slips
from tests.eom.checker.test_systems import TOP, latex, lexicon

POINTS = 2


def wrong(text, own):
    """A formula, and why its first wrong claim is wrong; None if it is not called wrong."""
    understood = understand(read_document(f"$${text}$$"), own)[0]
    judged = next((j for j in verdict(understood).claims if j.verdict in GRAVE), None)
    return understood, explain(understood, judged) if judged is not None else None


def says(understood, text, model, left, right):
    """Whether a line says that a rate is what it is: side by side, at points of solutions."""
    (claim,) = reread(understood, read_formula(text).tree)
    (pair,) = equations(claim, model)
    points = list(islice(model.motions((), 4, 30), POINTS))
    return len(points) == POINTS and all(
        (m.series(a) - m.series(b)).is_zero
        for m in points
        for a, b in zip(pair, (left, right), strict=True)
    )


def slipped(name, count):
    """Right sides with a slip: the state, the true right side, the line."""
    model = load_model(name)
    names = names_of(model)
    generator = random.Random(name)
    for q, r in zip(model.system.states, model.system.rates, strict=True):
        if r != 0:
            for _, _, changed in slips(r, generator, count):
                yield q, r, f"{left_side(q, names)} = {latex(changed, names)}"


NAMES = ("t-handle", "lecture-wheel", "gravity-gradient-body", "viscous-slug", "gyrostat")


@pytest.mark.sparse(only=("one",), slow=("some",))
@pytest.mark.parametrize(
    ("names", "count", "enough"),
    [(NAMES, 2, 30), (NAMES[1::2], 2, 12), (NAMES[:1], 2, 3)],
    ids=["all", "some", "one"],
)
def test_the_line_itself_is_among_the_first_repairs(names, count, enough):
    rows = []
    for name in names:
        model = load_model(name)
        for q, r, line in slipped(name, count):
            understood, found = wrong(line, lexicon(name))
            if found is not None:
                shown = [c.latex for c in found.corrections]
                right = [says(understood, c, model, rate(q.symbol), r) for c in shown]
                rows.append((any(right), line, shown))
    assert len(rows) >= enough
    missed = [row[1:] for row in rows if not row[0]]
    assert len(missed) <= len(rows) / 10, missed


def test_repairs_and_residuals_are_in_the_writers_letters():
    _, found = wrong(r"A\dot\omega_1 = (A+C)\omega_2\omega_3 + M_1", parse_lexicon(TOP))
    assert found.corrections[0].latex == r"A\dot\omega_1 = (A - C)\omega_2\omega_3 + M_1"
    assert found.residual == r"- 2 C \omega_{2} \omega_{3}"
    assert len(found.blamed) == 1


def test_a_lost_term_need_not_stand_near():
    _, found = wrong(r"C\dot\omega_3 = (A - A)\omega_1", parse_lexicon(TOP))
    assert found is None  # both moments are equal in this top
    _, found = wrong(r"A\dot\omega_2 = (C-A)\omega_3\omega_1", parse_lexicon(TOP))
    assert found.corrections[0].slip == "lost term"
    assert "tau" in found.residual


@pytest.mark.slow
@pytest.mark.parametrize("name", ["t-handle", "spinner"])
def test_every_repair_holds_in_the_note(name):
    count = 0
    for _, _, line in slipped(name, 2):
        understood, found = wrong(line, lexicon(name))
        for correction in found.corrections if found is not None else ():
            source = understood.formula.piece.source.text
            start, stop = correction.span
            note = source[:start] + correction.text + source[stop:]
            (again,) = understand(read_document(note), lexicon(name))
            judged = verdict(again)
            assert judged.verdict == ("holds under" if correction.sets else "holds"), note
            count += 1
    assert count >= 5
