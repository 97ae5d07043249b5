"""What the documents show works: blocks of the README."""

import re
import subprocess
import sys
from pathlib import Path

from click.testing import CliRunner

from eom.__main__ import main

ROOT = Path(__file__).parents[1]
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
    parts = "-m venv|pip install|eom plot|eom run|eom derive|eom accuracy|eom check|eom convert|-m pytest"
    assert len(lines) == len(parts.split("|"))
    assert all(part in line for part, line in zip(parts.split("|"), lines, strict=True))


def test_the_picture_of_the_readme_is_small_and_there():
    (path,) = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README)
    assert 0 < (ROOT / path).stat().st_size < 150_000


def test_every_command_that_the_readme_names_exists():
    named = set(re.findall(r"[`(/]eom\s([a-z]+)", README))
    assert {"plot", "animate", "live", "exercise", "completion", "bench"} <= named
    assert named <= set(main.commands)


def test_the_report_that_the_readme_shows_is_that_of_the_checker():
    (shown,) = blocks("text")
    formula = r"I_1\dot\omega_1 = (I_3 - I_2)\omega_2\omega_3 + T_1"
    done = CliRunner().invoke(main, ["check", formula, "--notation", "kane"])
    assert done.exit_code == 1
    assert shown.strip() in done.output
