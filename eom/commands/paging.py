"""Pages that are written to a file, the kind by its ending; PDF by LaTeX."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

from eom.errors import InputError

STYLES = {
    ".txt": "text",
    ".tex": "latex",
    ".pdf": "latex",
    ".md": "markdown",
    ".html": "html",
}
"""What is written into a file, by its ending."""
COMPILER = "pdflatex"
PATIENCE = 120.0
"""Seconds that LaTeX has for a page."""


def style_of(path: str) -> str:
    """Return the format of a file by its ending. Raises `InputError` for other endings."""
    ending = Path(path).suffix.lower()
    if ending not in STYLES:
        raise InputError(
            "unknown kind of page",
            where=path,
            got=ending or "no ending",
            expected=f"a name that ends in {', '.join(STYLES)}",
        )
    if ending == ".pdf" and shutil.which(COMPILER) is None:
        raise InputError(
            "a PDF needs LaTeX, which is not installed",
            where=path,
            hint=f"install {COMPILER} (amsmath, geometry), or write .tex",
        )
    return STYLES[ending]


def write_page(page: str, path: str) -> None:
    """Write a page to a file; a PDF is made of its LaTeX. Raises `InputError` where it cannot be."""
    file = Path(path)
    made = pdf(page) if file.suffix.lower() == ".pdf" else f"{page.rstrip()}\n".encode()
    try:
        file.write_bytes(made)
    except OSError as error:
        raise InputError(
            "the page cannot be written", where=path, got=error.strerror or str(error)
        ) from None


def pdf(latex: str) -> bytes:
    """Return a LaTeX document as PDF. Raises `InputError` where LaTeX does not make one."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "page.tex"
        source.write_text(latex, encoding="utf-8")
        command = [
            COMPILER,
            "-interaction=nonstopmode",
            "-halt-on-error",
            "-no-shell-escape",
            source.name,
        ]
        try:
            done = subprocess.run(  # noqa: S603 - a fixed command on a file of our own
                command, cwd=folder, capture_output=True, timeout=PATIENCE, check=False
            )
        except subprocess.TimeoutExpired:
            raise InputError("LaTeX does not end", got=f"more than {PATIENCE:g} s") from None
        if done.returncode != 0:
            said = done.stdout.decode(errors="replace").splitlines()
            why = next((line for line in said if line.startswith("!")), "no reason")
            raise InputError("LaTeX makes no PDF of this page", got=why)
        return source.with_suffix(".pdf").read_bytes()
