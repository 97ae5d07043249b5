"""Broken input of all kinds: a tree or a clear error, and nothing else."""

import pytest
from click.testing import CliRunner

from benchmarks import reading
from tests.clock import growth_in_calls
from tests.eom.rows import every, only


@pytest.mark.parametrize("count", only([150, 1500], 150))
def test_broken_formulas_and_documents(count):
    found = reading.fuzz(count, seed=11)
    assert found.failures == []
    assert found.otherwise == []
    assert sum(found.read.values()) > 2 * count / 15
    assert sum(found.refused.values()) > count / 3


@pytest.mark.parametrize(("opening", "closing"), every(4, reading.REPEATED))
def test_what_is_nested_or_long_takes_time_in_proportion(opening, closing):
    def work(count):
        found = reading.Findings()
        reading.check("nested", opening * count + "x" + closing * count, found)
        assert found.failures == []

    assert growth_in_calls(6, work, 200, 1000)


def test_the_command_prints_what_it_read(tmp_path):
    (tmp_path / "n.md").write_text("$$a = b$$ and $c \\foo$", encoding="utf-8")
    run = CliRunner().invoke(reading.main, ["--notes", str(tmp_path), "--fuzz", "20"])
    assert run.exit_code == 1
    assert "1 display (1 relational), 1 inline (0 relational); 1 not read" in run.output
    assert "0 failures in 20" in run.output


def test_a_failure_is_found(monkeypatch):
    monkeypatch.setattr(reading, "read_formula", lambda _: 1 / 0)
    found = reading.Findings()
    reading.check("edited", "a", found)
    assert "ZeroDivisionError" in found.failures[0]
    with pytest.raises(SystemExit):
        reading.main(["--fuzz", "3"])
