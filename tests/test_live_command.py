"""`eom live` on the command line."""

import os
import subprocess
import sys

import pytest
from click.testing import CliRunner

from eom.__main__ import main


def test_it_writes_one_page(tmp_path):
    file = tmp_path / "pages" / "wheel.html"
    done = CliRunner().invoke(main, ["live", "lecture-wheel", "--out", str(file)])
    assert done.exit_code == 0, done.output
    assert done.output.startswith(f"wrote {file} (")
    assert file.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert [p.name for p in file.parent.iterdir()] == ["wheel.html"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["t-handle", "--out", "x.pdf"], "expected: FILE.html"),
        (["no-such-scene", "--out", "x.html"], "unknown scene"),
    ],
)
def test_what_cannot_be_is_one_message_and_no_file(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(main, ["live", *arguments])
    assert done.exit_code == 2
    assert words in " ".join(done.output.split())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_bytes_do_not_depend_on_the_order_of_sets(tmp_path):
    made = []
    for seed in ("1", "2"):
        file = tmp_path / f"{seed}.html"
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        command = [sys.executable, "-m", "eom", "live", "double-pendulum", "--out", str(file)]
        subprocess.run(command, check=True, capture_output=True, env=environment)
        made.append(file.read_bytes())
    assert made[0] == made[1]
