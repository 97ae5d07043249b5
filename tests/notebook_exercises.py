"""Run a notebook with its hidden answers in place of the reader's attempts; a program of its own.

An exercise is a Markdown cell with an answer between <details> and </details>, and after it a code cell
``attempt = r"..."`` whose last line is a call that judges the attempt. A notebook ends with exercises of
another kind, whose hidden answer is a solution: a block of Python, and what it prints. The program prints
JSON: what the cells said and what they say now, the verdicts on every attempt and every answer, and what
each solution shows and prints.
"""

from __future__ import annotations

import ast
import importlib.util
import json
import re
import sys
from pathlib import Path

import nbformat

ROOT = Path(__file__).parents[1]
_HIDDEN = re.compile(r"<details>(.*?)</details>", re.DOTALL)
_SOLUTION = re.compile(r"```python\n(.*?)```\n+```text\n(.*?)```", re.DOTALL)
_DISPLAY = re.compile(r"\$\$.*?\$\$", re.DOTALL)
_VERDICTS = "print(__import__('json').dumps([f.verdict for f in Out[max(Out)].findings]))"
"""Of the report that was shown last; a notebook keeps what it shows in Out."""


def runner():
    """Return the module that runs notebooks."""
    spec = importlib.util.spec_from_file_location("run", ROOT / "notebooks" / "run.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def answers(cell):
    """Return the hidden answers of a Markdown cell that are no solutions: the displays of each."""
    hidden = [text for text in _hidden(cell) if not _SOLUTION.search(text)]
    return ["\n\n".join(_DISPLAY.findall(text)) for text in hidden]


def _hidden(cell):
    return _HIDDEN.findall(cell.source) if cell.cell_type == "markdown" else []


def solutions(cell):
    """Return the solutions of a Markdown cell: the code of each, and what it prints."""
    return [pair for text in _hidden(cell) for pair in _SOLUTION.findall(text)]


def attempt_of(cell):
    """Return the text that a cell calls ``attempt``, None if it has none."""
    if cell.cell_type != "code" or not cell.source.startswith("attempt = "):
        return None
    return ast.literal_eval(ast.parse(cell.source).body[0].value)


def exercises(notebook):
    """Return place of the attempt, attempt, answer of every exercise."""
    found = []
    for k, cell in enumerate(notebook.cells):
        for answer in answers(cell):
            following = notebook.cells[k + 1 :]
            places = [n for n, c in enumerate(following, k + 1) if attempt_of(c) is not None]
            if not places:
                raise ValueError(f"no attempt after the answer in cell {k + 1}")
            found.append((places[0], attempt_of(notebook.cells[places[0]]), answer))
    return found


def judging(cell, answer):
    """Return cells that print the verdicts on the cell's attempt, judge the answer, and print again."""
    others = ast.parse(cell.source).body[1:]
    again = "\n".join([f"attempt = {answer!r}", *(ast.unparse(line) for line in others)])
    return [nbformat.v4.new_code_cell(source) for source in (_VERDICTS, again, _VERDICTS)]


def with_answers(notebook):
    """Put cells that judge answers, and solutions, into a notebook.

    Returns where its own cells stand, the verdicts, and the solutions, each of these with what it shows.
    """
    places = {place: answer for place, _, answer in exercises(notebook)}
    cells, own, judged, solved = [], [], [], []
    for k, cell in enumerate(notebook.cells):
        own.append(len(cells))
        cells.append(cell)
        if k in places:
            judged += [len(cells), len(cells) + 2]
            cells += judging(cell, places[k])
        for code, shown in solutions(cell):
            solved.append((len(cells), shown))
            cells.append(nbformat.v4.new_code_cell(code))
    notebook.cells = cells
    return own, judged, solved


def printed(cell):
    """Return what a code cell wrote."""
    return "".join(o.text for o in cell.outputs if o.output_type == "stream")


def main(path, folder):
    run = runner()
    notebook = run.read(path)
    kept = [run.said(c) if c.cell_type == "code" else [] for c in notebook.cells]
    own, judged, solved = with_answers(notebook)
    run.execute(notebook, Path(folder))
    cells = notebook.cells
    verdicts = [json.loads(cells[k].outputs[0].text) for k in judged]
    run.tidy(notebook)
    found = [(shown, printed(cells[k])) for k, shown in solved]
    now = [run.said(cells[k]) if cells[k].cell_type == "code" else [] for k in own]
    print(json.dumps({"kept": kept, "now": now, "verdicts": verdicts, "solutions": found}))


if __name__ == "__main__":
    main(*sys.argv[1:])
