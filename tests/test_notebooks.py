"""Notebooks run, keep what they say, ask exercises that can be judged, and are tidy."""

import ast
import difflib
import itertools
import json
import os
import re
import subprocess
import sys

import nbformat
import pytest

from codegen.native import native
from tests import notebook_exercises as exercising
from tests.pages import agrees

ROOT = exercising.ROOT
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
GOOD = {"holds", "holds under", "definition", "assumption"}
LARGEST = 600_000
LAST = 3
"""Exercises with which a notebook ends."""
everyone = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)


def read(path):
    return nbformat.read(path, 4)


def test_there_are_the_seven_notebooks():
    assert {p.stem for p in NOTEBOOKS} == {
        "checking",
        "generating-c",
        "lecture-000-polhodes",
        "lecture-001-spinning-body",
        "lecture-002-particles-to-euler",
        "many-bodies",
        "work-precision",
    }


def run(path, folder):
    """In a process of its own: the kernel's machinery warns about itself."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
    program = [sys.executable, exercising.__file__, str(path), str(folder)]
    done = subprocess.run(program, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.slow
@everyone
@pytest.mark.skipif(
    not native.compiler(), reason="what the notebooks keep was made with a compiler"
)
def test_a_notebook_runs_says_what_it_kept_and_its_answers_are_judged(path, tmp_path):
    found = run(path, tmp_path)
    for number, (kept, now) in enumerate(zip(found["kept"], found["now"], strict=True), 1):
        assert now == kept, f"cell {number} says something else than it kept"
    judged = found["verdicts"]
    assert len(judged) == 2 * len(exercising.exercises(read(path)))
    for attempt, answer in zip(judged[::2], judged[1::2], strict=True):
        assert "wrong" in attempt, "the slip is not found"
        assert answer, "the answer is not read"
        assert set(answer) <= GOOD, "the answer is not true"
    assert len(found["solutions"]) == LAST
    for shown, printed in found["solutions"]:
        assert agrees(shown, printed), printed


@everyone
def test_there_are_exercises_and_the_attempt_is_a_slip_in_the_answer(path):
    found = exercising.exercises(read(path))
    assert found
    for _, attempt, answer in found:
        spelt = [re.sub(r"[\s$]", "", text) for text in (attempt, answer)]
        assert spelt[0] != spelt[1]
        assert difflib.SequenceMatcher(None, *spelt).ratio() > 0.9


@everyone
def test_a_notebook_ends_with_three_exercises_of_which_one_is_worth_thinking_about(path):
    cells = read(path).cells
    assert [len(exercising.solutions(cell)) for cell in cells[-LAST:]] == [1] * LAST
    assert not any(exercising.solutions(cell) for cell in cells[:-LAST])
    worth = [cell for cell in cells[-LAST:] if "### Worth thinking about" in cell.source]
    assert len(worth) == 1
    for cell in cells[-LAST:]:
        question = cell.source.split("<details>")[0]
        assert "?" in question or "judged" in question
        assert "## To try" not in cell.source


@everyone
def test_outputs_are_kept_without_errors_warnings_or_paths(path):
    code = [c for c in read(path).cells if c.cell_type == "code"]
    assert [c.execution_count for c in code] == list(range(1, len(code) + 1))
    assert sum(bool(c.outputs) for c in code) >= len(code) / 2
    for output in (o for c in code for o in c.outputs):
        said = json.dumps(output)
        assert output.output_type != "error"
        assert output.get("name") != "stderr", said
        assert not re.search(r"/(tmp|home|root|work|usr)/|0x[0-9a-f]{6}", said), said[:300]


@everyone
def test_a_notebook_is_tidy(path):
    """No times, no machine; the same bytes for the same results."""
    notebook = read(path)
    assert set(notebook.metadata) == {"kernelspec"}
    assert [c.id for c in notebook.cells] == [
        f"cell-{k:02}" for k in range(1, len(notebook.cells) + 1)
    ]
    for cell in notebook.cells:
        assert set(cell.metadata) <= {"tags"}
        assert set(cell.metadata.get("tags", [])) <= {exercising.runner().MEASURED}
    assert path.stat().st_size < LARGEST


@everyone
def test_headings_are_in_order_with_one_title(path):
    cells = read(path).cells
    assert cells[0].source.startswith("# ")
    text = "\n".join(c.source for c in cells if c.cell_type == "markdown")
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    levels = [len(m) for m in re.findall(r"^(#+) ", text, flags=re.MULTILINE)]
    assert levels.count(1) == 1
    assert all(b <= a + 1 for a, b in itertools.pairwise(levels))


def test_runs_are_the_same_to_the_byte_but_for_what_is_measured():
    """Tidying what is tidy changes nothing."""
    for path in NOTEBOOKS:
        notebook = read(path)
        before = nbformat.writes(notebook)
        exercising.runner().tidy(notebook)
        assert nbformat.writes(notebook) == before


EXERCISE = """Which?

<details>
<summary>Answer</summary>

$$a = b$$

because, and

$$c = d$$

</details>
"""


def small(*sources):
    cells = [
        nbformat.v4.new_markdown_cell(s) if "<details>" in s else nbformat.v4.new_code_cell(s)
        for s in sources
    ]
    return nbformat.v4.new_notebook(cells=cells)


def test_an_answer_is_its_displays_and_belongs_to_the_next_attempt():
    found = exercising.exercises(
        small("x = 1", EXERCISE, "y = 2", 'attempt = "a" "=c"\nf(attempt)')
    )
    assert found == [(3, "a=c", "$$a = b$$\n\n$$c = d$$")]
    with pytest.raises(ValueError, match="no attempt after the answer in cell 1"):
        exercising.exercises(small(EXERCISE, "y = 2"))


def test_the_answer_is_judged_by_the_reader_s_own_cell():
    notebook = small(EXERCISE, 'attempt = "a"\nlimit = 3\nf(attempt, limit)', "z = 1")
    own, judged, _ = exercising.with_answers(notebook)
    sources = [c.source for c in notebook.cells]
    assert own == [0, 1, 5]
    assert judged == [2, 4]
    assert sources[3].splitlines()[1:] == ["limit = 3", "f(attempt, limit)"]
    assert (
        ast.literal_eval(sources[3].splitlines()[0].removeprefix("attempt = "))
        == "$$a = b$$\n\n$$c = d$$"
    )


SOLUTION = """How much?

<details>
<summary>Solution</summary>

Two, as $$1 + 1 = 2$$ says:

```python
print(one + 1)
```

```text
2
```

</details>
"""


def test_a_solution_is_its_code_and_what_it_prints():
    notebook = small("one = 1", SOLUTION)
    assert exercising.exercises(notebook) == []
    _, judged, solved = exercising.with_answers(notebook)
    assert (judged, solved) == ([], [(2, "2\n")])
    assert notebook.cells[2].source == "print(one + 1)\n"


@pytest.mark.slow
def test_a_small_notebook_runs_and_its_answer_is_judged(tmp_path):
    line = r"\dot\omega_1 = \frac{(I_2 %s I_3) \omega_2 \omega_3}{I_1}"
    exercise = f"<details>\n\n$${line % '-'}$$\n\n</details>"
    attempt = f"attempt = {line % '+'!r}\neom.check(attempt, system=eom.free_rigid_body())"
    notebook = small("import eom\nprint(1 + 1)", exercise, attempt)
    notebook.cells[0].outputs = [nbformat.v4.new_output("stream", name="stdout", text="2\n")]
    nbformat.write(notebook, tmp_path / "small.ipynb")
    found = run(tmp_path / "small.ipynb", tmp_path)
    assert found["now"][0] == found["kept"][0] != []
    assert found["verdicts"] == [["wrong"], ["holds"]]


def test_what_is_said_leaves_out_pictures_and_measurements():
    cell = nbformat.v4.new_code_cell("show()")
    output = nbformat.v4.new_output
    cell.outputs = [
        output("stream", name="stdout", text="3\n"),
        output("display_data", {"image/png": "AAAA", "text/plain": "a wheel"}),
        output("display_data", {"text/plain": "4"}),
    ]
    run = exercising.runner()
    pictured, plain = [["image/png", "text/plain"], []], [["text/plain"], ["4"]]
    assert run.said(cell) == [["stdout", "3\n"], pictured, plain]
    cell.metadata["tags"] = [run.MEASURED]
    assert run.said(cell) == []


def test_pieces_of_a_stream_are_joined():
    output = nbformat.v4.new_output
    pieces = [
        output("stream", name=n, text=t)
        for n, t in (("stdout", "a"), ("stdout", "b"), ("stderr", "c"))
    ]
    joined = exercising.runner().joined(pieces)
    assert [(o.name, o.text) for o in joined] == [("stdout", "ab"), ("stderr", "c")]


@everyone
def test_headings_stand_in_the_text_alone(path):
    """Those in outputs would break the order of a page's headings."""
    for cell in read(path).cells:
        for data in (o.get("data", {}) for o in cell.get("outputs", [])):
            assert not re.search(r"^#+ ", data.get("text/markdown", ""), flags=re.MULTILINE)
