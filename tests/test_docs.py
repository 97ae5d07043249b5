"""The documentation: every block of every page runs, and prints what the page shows."""

import importlib.util
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from codegen.native import native
from eom.kinematics.coordinates import SEQUENCES, quaternion_of_sequence
from eom.rotations import matrix_of_quaternion
from tests.pages import Block, agrees, blocks, there

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
MADE = DOCS / "howto" / "pictures.md"
"""The page that is run where the site is built alone (`docs/_ext/made.py`), which shows what it makes."""
PAGES = sorted(
    page
    for page in DOCS.rglob("*.md")
    if page != MADE
    and any(b.language in {"python", "bash"} for b in blocks(page.read_text(encoding="utf-8")))
)
NEEDS = {
    "many-bodies": ("yourdfpy",),
    "robots": ("yourdfpy", "mujoco"),
    "from-other-programs": ("yourdfpy",),
    "monte-carlo": ("zarr",),
    "fmu": ("fmpy",),
    "jax": ("jax", "diffrax"),
    "tutorial": ("matplotlib",),
    "conventions": ("matplotlib",),
    "control": ("matplotlib",),
    "rotary-pendulum": ("matplotlib",),
    "reaction-wheels": ("matplotlib",),
    "run-many-times": ("matplotlib", "pandas", "xarray"),
}
TASKS = 10


@pytest.mark.slow
@pytest.mark.skipif(not native.compiler(), reason="pages show runs in C")
@pytest.mark.skipif(sys.platform == "win32", reason="pages run in forks of one process")
def test_blocks_of_all_pages_run_and_print_what_is_shown():
    absent = {
        name for name, modules in NEEDS.items() if not all(map(importlib.util.find_spec, modules))
    }
    pages = [str(page) for page in PAGES if page.stem not in absent]
    done = subprocess.run(
        [sys.executable, "-W", "error", str(ROOT / "tests" / "pages.py"), *pages],
        capture_output=True,
        text=True,
        check=False,
        env={
            **os.environ,
            "PYTHONPATH": str(ROOT),
            "OPENBLAS_NUM_THREADS": "1",
            "MPLBACKEND": "agg",
        },
    )
    assert done.returncode == 0, done.stderr
    reported = json.loads(done.stdout)
    assert set(reported) == set(pages)
    wrong = "\n".join(f"{page}\n{words}" for page, words in reported.items() if words)
    assert not wrong, wrong


def test_there_is_a_page_a_task_and_each_is_run():
    tasks = {page.stem for page in (DOCS / "howto").glob("*.md")} - {"index", MADE.stem}
    assert len(tasks) >= TASKS
    assert tasks <= {page.stem for page in PAGES}
    assert {"tutorial", "conventions", "verification", "accuracy", "checking"} <= {
        page.stem for page in PAGES
    }


def test_each_exercise_of_a_page_has_an_answer_that_is_run():
    asked = 0
    for page in DOCS.rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        for part in re.split(r"^#+ ", text, flags=re.MULTILINE):
            exercises = part.count("{admonition} Exercise")
            asked += exercises
            answers = re.findall(r"<details>.*?</details>", part, flags=re.DOTALL)
            assert len(answers) == exercises, page.name
            for answer in answers:
                languages = [b.language for b in blocks(answer)]
                assert {"python", "text"} <= set(languages), page.name
                assert page in PAGES
    assert asked


@pytest.mark.slow
def test_the_table_of_sequences_is_that_of_the_turns():
    """Its rates are those with which the axes of the body turn as the angular velocity says."""
    spec = importlib.util.spec_from_file_location("shown_tables", DOCS / "_ext" / "shown_tables.py")
    tables = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tables)
    _, rows = tables.TABLES["sequences"]
    made = rows()
    assert [row[0] for row in made] == list(SEQUENCES)
    angles, omega, h = {"psi": 0.3, "theta": 0.7, "phi": -0.4}, (0.5, -0.8, 1.1), 1e-6
    for name, _, *rates, _ in made:
        known = {**angles, **{f"omega_{k}": w for k, w in enumerate(omega, 1)}}
        speeds = []
        for text in rates:
            read = sp.sympify(text.strip("`").replace("psi'", "psi_rate"))
            speeds.append(float(read.subs({**known, "psi_rate": (speeds or [0])[0]})))
        C, later = (
            np.array(
                matrix_of(name, [a + h * s for a, s in zip(angles.values(), moved, strict=True)])
            )
            for moved in ((0, 0, 0), speeds)
        )
        skew = -(later - C) / h @ C.T
        np.testing.assert_allclose((skew[2, 1], skew[0, 2], skew[1, 0]), omega, atol=1e-5)


def matrix_of(name, angles):
    """Return C of a sequence by numbers, from its quaternion."""
    return matrix_of_quaternion(quaternion_of_sequence(name, angles))


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("error 3e-07", "error 3e-07", True),
        ("error 3e-07", "error 4e-07", False),
        ("tilt 0.618067738 rad", "tilt 0.618067739 rad", True),
        ("tilt 0.618067738 rad", "tilt 0.618067838 rad", False),
        ("drift 8.0e-16", "drift 1.2e-15", True),
        ("drift 8.0e-16", "drift 1.2e-11", False),
        ("time  0.05 ms", "time 7.25 ms", True),
        ("wrote x (1,234 bytes)", "wrote x (91 bytes)", True),
        ("steps 1,234", "steps 1,235", True),
        ("steps 1,234", "steps 2,345", False),
        ("a\n...\nd", "a\nb\nc\nd", True),
        ("a\n...\nd", "a\nb\nc", False),
        ("omega_1 = 2", "omega_2 = 2", False),
        ("two  words", "two words", True),
        ("all of it", "all of it, and more", False),
    ],
)
def test_what_is_shown_is_compared_by_words_and_digits(shown, printed, same):
    assert agrees(shown, printed) is same


def test_blocks_are_found_with_their_files_and_lines():
    page = (
        "# Page\n\n```python\nx = 1\n```\n\n```{admonition} Note\n:class: tip\n\nwords\n```\n\n"
        "```{code-block} toml\n:caption: a.toml\n\nb = 2\n```\n\n```{shown-table} books\n```\n"
    )
    assert list(blocks(page)) == [
        Block("python", "", "x = 1\n", 3),
        Block("toml", "a.toml", "b = 2\n", 13),
    ]


@pytest.mark.parametrize(("module", "run"), [("sympy", 4), ("no_such_module", 2)])
def test_blocks_of_programs_that_are_absent_are_passed_over_with_what_they_print(module, run):
    page = (
        f"```{{code-block}} python\n:class: with-{module}\n\nprint(1)\n```\n\n```text\n1\n```\n\n"
        "```python\nprint(2)\n```\n\n```text\n2\n```\n"
    )
    found = list(blocks(page))
    assert [b.needs for b in found] == [module, "", "", ""]
    assert found[0].text == "print(1)\n"
    assert list(there(iter(found))) == found[-run:]


@pytest.mark.parametrize(
    ("page", "words"),
    [
        ("```python\nprint(1 + 1)\n```\n\n```text\n3\n```\n", "page.md, line 5"),
        ("```bash\neom list nothing\n```\n", "exit status 2"),
        ("```console\nrm -rf build\n```\n", "page.md, line 1"),
        ("```python\n1 / 0\n```\n", "ZeroDivisionError"),
    ],
)
def test_a_page_that_shows_something_else_fails(page, words, tmp_path):
    path = tmp_path / "page.md"
    path.write_text(page, encoding="utf-8")
    command = [sys.executable, str(ROOT / "tests" / "pages.py"), str(path)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, cwd=tmp_path, env=environment
    )
    assert done.returncode == 1
    assert words in done.stderr
