"""What the documents show works: blocks of the README, notebooks."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
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


@pytest.mark.parametrize(
    "notebook", sorted((ROOT / "notebooks").glob("*.ipynb")), ids=lambda p: p.stem
)
def test_notebook_runs_and_keeps_its_outputs(notebook, tmp_path):
    """In a process of its own: the kernel's machinery warns about itself."""
    code = (
        "import sys, nbformat, nbclient\n"
        "nb = nbformat.read(sys.argv[1], 4)\n"
        "kept = [bool(c.outputs) for c in nb.cells if c.cell_type == 'code']\n"
        "assert sum(kept) >= len(kept) - 1, 'outputs are not kept'\n"
        "nbclient.NotebookClient(nb, timeout=120, kernel_name='python3').execute()\n"
    )
    environment = {**os.environ, "IPYTHONDIR": str(tmp_path), "JUPYTER_RUNTIME_DIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", code, str(notebook)],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr[-3000:]
