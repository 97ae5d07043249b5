"""Single edits of true equations: no true one is called wrong, hardly a false one right."""

import pytest
from click.testing import CliRunner

from benchmarks import edits
from eom.checker.judge.verdicts import Verdict
from eom.checker.read.grammar import read_formula
from eom.checker.read.writing import latex
from tests.eom.rows import only


@pytest.fixture(scope="module")
def originals():
    return list(edits.originals(edits.OWN, only=("transport",)))


def test_edits_are_single_and_different():
    tree = read_formula(r"\dot{a}_1 = 2 b_{12} \sin\theta - \frac{c}{2} u \times v").tree
    found = [latex(new) for _, new in edits.edits(tree)]
    assert len(found) == len(set(found))
    for wanted in (
        r"a_{1} = 2 b_{12} \sin{\theta} - \frac{c}{2} u \times v",
        r"\dot{a}_{1} = 2 b_{21} \sin{\theta} - \frac{c}{2} u \times v",
        r"\dot{a}_{1} = 2 b_{12} \cos{\theta} - \frac{c}{2} u \times v",
        r"\dot{a}_{1} = 2 b_{12} \sin{\theta} + \frac{c}{2} u \times v",
    ):
        tree = read_formula(wanted).tree
        assert tree in [read_formula(f).tree for f in found]


@pytest.mark.parametrize("most", only([20, 80], 20))
def test_a_sample_of_edits(originals, most):
    count = edits.run(originals, most=most, seed=2)
    assert count.total.total() == most
    assert count.alarms == 0, "\n".join(count.faults)
    assert count.false > most / 2
    assert 100 * count.caught >= 98 * count.false, "\n".join(count.faults)


def test_the_oracle_sees_what_is_false(originals):
    original = next(o for o in originals if o.name == "transport:E1")
    found = {
        latex(t): edits.outcome(original, t)[0]
        for k, t in edits.edits(original.tree)
        if k == "sign"
    }
    assert set(found.values()) == {"false, wrong"}
    same = edits.outcome(original, original.tree)[0]
    assert same == "true, holds"


def test_faults_are_counted(originals, monkeypatch):
    original = next(o for o in originals if o.name == "transport:E1")
    monkeypatch.setattr(edits, "verdict", lambda *_: Verdict("wrong"))
    count = edits.Count()
    count.add("sign", original, original.tree, None)
    assert count.alarms == 1
    assert count.missed
    monkeypatch.setattr(edits, "verdict", lambda *_: Verdict("holds"))
    kind, tree = next(e for e in edits.edits(original.tree) if e[0] == "sign")
    count.add(kind, original, tree)
    assert (count.false, count.caught) == (1, 0)


def test_the_line_before_the_edit_is_found(originals):
    original = next(o for o in originals if o.name == "transport:E1")
    _, tree = next(e for e in edits.edits(original.tree) if e[0] == "sign")
    assert edits.undone(original, tree)
    assert not edits.undone(original, original.tree)


def test_the_command():
    run = CliRunner().invoke(edits.main, ["--note", "transport", "--most", "5"])
    assert run.exit_code == 0
    assert "5 edits of true equations" in run.output
