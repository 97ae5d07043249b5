"""What the documents show works: blocks of the README."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

from click.testing import CliRunner

from eom.__main__ import main

ROOT = Path(__file__).parents[1]
FIGURES = 5
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)


def test_python_blocks_run_one_after_the_other():
    assert blocks("python")
    code = "\n".join(blocks("python"))
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "reached t = 20" in done.stdout


def test_readme_gives_set_up_main_job_and_test_command():
    lines = [line for block in blocks("bash") for line in block.splitlines()]
    parts = "-m venv|pip install|eom run|eom plot|eom check|eom derive|eom accuracy|eom convert|-m pytest"
    assert len(lines) == len(parts.split("|"))
    assert all(part in line for part, line in zip(parts.split("|"), lines, strict=True))


def test_the_picture_of_the_readme_is_small_and_there():
    (path,) = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README)
    assert 0 < (ROOT / path).stat().st_size < 150_000


def test_every_command_that_the_readme_names_exists():
    named = set(re.findall(r"[`(/]eom\s([a-z]+)", README))
    assert {"plot", "animate", "live", "exercise", "completion", "bench"} <= named
    assert named <= set(main.commands)


def test_the_report_that_the_readme_shows_is_that_of_its_command():
    (command,), (shown,) = blocks("console"), blocks("text")
    program, *words = shlex.split(command)
    assert program.endswith("/eom")
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 1
    begin, rest = shown.strip().rsplit("...", 1)
    assert begin.rstrip() in done.output
    assert rest == ""


def rows(text):
    return [line for line in text.splitlines() if line.startswith("| ") and "---" not in line]


def test_the_figures_of_the_readme_are_five_of_those_of_the_documentation():
    page = (ROOT / "docs" / "explanation" / "figures.md").read_text(encoding="utf-8")
    head, *shown = rows(README)
    assert len(shown) == FIGURES
    assert {head, *shown} <= set(rows(page))


def test_every_file_that_the_readme_leads_to_is_there():
    leads = re.findall(r"\]\(([^)#:]+)\)", README)
    assert len(leads) >= FIGURES
    assert [path for path in leads if not (ROOT / path).is_file()] == []
