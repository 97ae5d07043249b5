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


def test_the_scene_of_the_readme_runs(tmp_path):
    (text,) = blocks("toml")
    (tmp_path / "plate.toml").write_text(text, encoding="utf-8")
    words = ["simulate", str(tmp_path / "plate.toml"), "--plot", str(tmp_path / "plate.png")]
    done = CliRunner().invoke(main, words, catch_exceptions=False)
    assert done.exit_code == 0, done.output
    assert (tmp_path / "plate.png").is_file()


def test_readme_gives_set_up_main_job_and_test_command():
    lines = [line for block in blocks("bash") for line in block.splitlines()]
    assert len(lines) == 8
    assert lines[0].startswith("python3 -m venv")
    assert "eom run" in lines[2]
    assert "eom accuracy" in lines[3]
    assert "eom derive" in lines[4]
    assert "eom check" in lines[5]
    assert "eom convert" in lines[6]
    assert "pytest" in lines[7]


def test_the_report_that_the_readme_shows_is_that_of_the_checker():
    (shown,) = blocks("text")
    formula = r"I_1\dot\omega_1 = (I_3 - I_2)\omega_2\omega_3 + T_1"
    done = CliRunner().invoke(main, ["check", formula, "--notation", "kane"])
    assert done.exit_code == 1
    assert shown.strip() in done.output
