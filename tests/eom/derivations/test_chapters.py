"""Chapters with frames, bodies or laws of their own: true by other means, as published, mutants found."""

import random

import pytest

from eom.derivations import derive
from eom.derivations.verification import plain
from tests.eom import oracle
from tests.eom.chapters import MOTIONS, is_true, judge
from tests.eom.mutants import judged_steps, mutants
from tests.eom.rows import only

MOST = 12
"""Edits of a chapter whose truth is asked elsewhere."""


@pytest.mark.parametrize("name", only(MOTIONS, "collisions"))
def test_every_equation_is_true_by_published_motions(name):
    d, known = derive(name), 0
    for step in judged_steps(d):
        try:
            assert is_true(d, step.statement, step.assumptions), step.label
            known += 1
        except oracle.Undefined:
            continue
    assert known > 0.7 * len(judged_steps(d)) - 3


@pytest.mark.parametrize("name", only(MOTIONS, "collisions"))
def test_edits_that_are_false_are_rejected_and_true_ones_are_not(name):
    d, draw = derive(name), random.Random(name)
    lines = [s for s in judged_steps(d) if s.statement.relation != ">="]
    edits = [
        (s, m.equation) for s in lines for m in mutants(s.statement, s.assumptions) if m.equation
    ]
    wrong, refused = [], 0
    for step, edit in draw.sample(edits, MOST):
        verdict = judge(d, edit, step.assumptions)
        refused += verdict == "rejected"
        try:
            truth = is_true(d, edit, step.assumptions)
        except oracle.Undefined:
            continue
        if (verdict, truth) in {("accepted", False), ("rejected", True)}:
            wrong.append((step.label, verdict, plain(edit.left), plain(edit.right)))
    assert wrong == []
    assert refused > MOST / 2
