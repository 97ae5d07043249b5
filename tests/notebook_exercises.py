"""Run a notebook with its hidden answers in place of the reader's attempts; a program of its own.

An exercise is a Markdown cell with an answer between <details> and </details>, and after it a code cell
``attempt = r"..."`` whose last line is a call that judges the attempt. The program prints JSON: what the
cells said and what they say now, and the verdicts on every attempt and every answer.
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
    """Return the hidden answers of a Markdown cell: the displays of each."""
    hidden = _HIDDEN.findall(cell.source) if cell.cell_type == "markdown" else []
    return ["\n\n".join(_DISPLAY.findall(text)) for text in hidden]


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
    """Return the notebook with cells that judge answers; where its own cells and the verdicts stand."""
    places = {place: answer for place, _, answer in exercises(notebook)}
    cells, own, judged = [], [], []
    for k, cell in enumerate(notebook.cells):
        own.append(len(cells))
        cells.append(cell)
        if k in places:
            judged += [len(cells), len(cells) + 2]
            cells += judging(cell, places[k])
    notebook.cells = cells
    return own, judged


def main(path, folder):
    run = runner()
    notebook = run.read(path)
    kept = [run.said(c) if c.cell_type == "code" else [] for c in notebook.cells]
    own, judged = with_answers(notebook)
    run.execute(notebook, Path(folder))
    cells = notebook.cells
    verdicts = [json.loads(cells[k].outputs[0].text) for k in judged]
    run.tidy(notebook)
    now = [run.said(cells[k]) if cells[k].cell_type == "code" else [] for k in own]
    print(json.dumps({"kept": kept, "now": now, "verdicts": verdicts}))


if __name__ == "__main__":
    main(*sys.argv[1:])
