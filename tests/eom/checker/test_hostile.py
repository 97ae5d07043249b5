"""The whole checker on hostile input: verdicts or one clear error, in bounded time and memory."""

import random

import pytest
from click.testing import CliRunner

from benchmarks import hostile
from eom.checker.mean.lexicon_files import preset
from tests.eom.rows import but


@pytest.mark.slow
def test_hostile_inputs_of_all_kinds():
    found = hostile.run(80, seed=3)
    assert found.failures == []
    assert found.outcomes.total() == 80
    assert found.verdicts.total() > 50


@pytest.mark.parametrize("kind", but(hostile.MAKERS, "large"))
def test_each_kind(kind):
    rng = random.Random(kind)
    found = hostile.Found()
    for _ in range(2 if kind == "large" else 4):
        hostile.check(kind, *hostile.MAKERS[kind][1](rng), found)
    assert found.failures == []


@pytest.mark.parametrize("text", [*hostile.POWERS, *hostile.MARKUP])
def test_what_is_listed(text):
    found = hostile.Found()
    data = text if text in hostile.MARKUP else f"$${text} = \\omega_1$$"
    hostile.check("listed", data.encode(), preset("hughes"), found)
    assert found.failures == []


@pytest.mark.parametrize(
    "text",
    [
        r"\frac{{}^{ }d\mathbf{b}_2}{dt} = u_3\mathbf{b}_1",
        r"2_{ } = \frac{m}{12}",
        r"\dot{\vec{r}}_{P/O} = \dot{\vec{r Q}_{ }/O}",
    ],
)
@pytest.mark.parametrize("name", ["kane", "underline-bullet", "arrow-tilde"])
def test_empty_labels_found_by_it(text, name):
    found = hostile.Found()
    hostile.check("listed", f"$${text}$$".encode(), preset(name), found)
    assert found.failures == []


def test_a_failure_and_a_delay_are_found(monkeypatch):
    found = hostile.Found()
    monkeypatch.setattr(hostile, "verdict", lambda *_: 1 / 0)
    hostile.check("x", b"$a=b$", preset("hughes"), found)
    assert "ZeroDivisionError" in found.failures[0]

    def endless(*_):
        while True:
            pass

    monkeypatch.setattr(hostile, "verdict", endless)
    monkeypatch.setattr(hostile, "MAX_SECONDS", 0.1)
    hostile.check("x", b"$a=b$", preset("hughes"), found)
    assert "more than 0.1 s" in found.failures[1]


def test_the_command():
    run = CliRunner().invoke(hostile.main, ["20"])
    assert run.exit_code == 0
    assert "0 failures in 20" in run.output
