"""Run notebooks and keep their outputs, the same bytes for the same results.

    python notebooks/run.py [NAME ...]

runs those whose names are given, all if none are, and writes them back: outputs without times of
execution, cells numbered, metadata of the kernel's name alone. A cell with the tag ``measured`` shows
what a machine took for it; its outputs differ from run to run.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import nbclient
import nbformat

HERE = Path(__file__).parent
MEASURED = "measured"
KERNEL = {"display_name": "Python 3", "language": "python", "name": "python3"}
SECONDS = 120
"""A cell that runs longer than that is given up."""


def paths(names: list[str]) -> list[Path]:
    """Return the notebooks of some names, all if there are none."""
    return [HERE / f"{name}.ipynb" for name in names] or sorted(HERE.glob("*.ipynb"))


def read(path: Path) -> Any:
    """Return a notebook of format 4."""
    return nbformat.read(path, 4)


def execute(notebook: Any, folder: Path) -> None:
    """Run all cells, in a folder of their own. Raises `CellExecutionError` for a cell that fails.

    The kernel colours nothing, and its own files stay in the folder. Matplotlib's list of fonts is made
    beforehand, as it says so where it takes long.
    """
    importlib.import_module("matplotlib.font_manager")
    kept = {"IPYTHONDIR": folder, "JUPYTER_RUNTIME_DIR": folder}
    os.environ.update({name: str(path) for name, path in kept.items()} | {"NO_COLOR": "1"})
    client = nbclient.NotebookClient(
        notebook, timeout=SECONDS, kernel_name="python3", record_timing=False
    )
    client.execute(cwd=str(folder))


def tidy(notebook: Any) -> None:
    """Leave what is the same in every run: sources, outputs, tags."""
    notebook.metadata = nbformat.from_dict({"kernelspec": KERNEL})
    notebook.nbformat_minor = 5
    for k, cell in enumerate(notebook.cells, 1):
        cell.id = f"cell-{k:02}"
        tags = cell.metadata.get("tags", [])
        cell.metadata = nbformat.from_dict({"tags": tags} if tags else {})
        if cell.cell_type == "code":
            cell.outputs = joined(cell.outputs)


def joined(outputs: list[Any]) -> list[Any]:
    """Return outputs with neighbouring pieces of one stream in one; how they are cut is chance."""
    found: list[Any] = []
    for output in outputs:
        if "metadata" in output:
            images = {k: v for k, v in output.metadata.items() if k.startswith("image/")}
            output.metadata = nbformat.from_dict(images)
        last = found[-1] if found else {}
        if output.output_type == last.get("output_type") == "stream" and output.name == last.name:
            last.text += output.text
        else:
            found.append(output)
    return found


def said(cell: Any) -> list[Any]:
    """Return what a code cell says: streams and texts as they are; of pictures only that they are there.

    Nothing for a cell that shows what was measured.
    """
    return [] if MEASURED in cell.metadata.get("tags", []) else [_said(o) for o in cell.outputs]


def _said(output: Any) -> list[Any]:
    if output.output_type == "stream":
        return [output.name, output.text]
    kinds = sorted(output.data)
    pictured = any(kind.startswith("image/") for kind in kinds)
    return [kinds, [] if pictured else [output.data[k] for k in kinds if k in TEXTS]]


TEXTS = ("text/plain", "text/markdown", "text/latex")


def main(names: list[str]) -> None:
    """Run notebooks and write them back."""
    for path in paths(names):
        notebook = read(path)
        with tempfile.TemporaryDirectory() as folder:
            execute(notebook, Path(folder))
        tidy(notebook)
        text = json.dumps(notebook, indent=1, ensure_ascii=False, sort_keys=True)
        path.write_text(text + "\n", encoding="utf-8")
        print(f"{path.name}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
