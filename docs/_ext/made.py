"""Pictures and pages that a page of the documentation makes: its commands are run before the site is built.

What they write goes to the folder ``_made`` beside the pages; figures are taken from there, and pages of
their own stand in ``made`` of the site.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

PAGE = "howto/pictures.md"
FOLDER = "_made"


def make(app: Sphinx) -> None:
    """Run the page, in a process of its own. What it shows is compared with what it prints."""
    folder = Path(app.srcdir) / FOLDER
    folder.mkdir(exist_ok=True)
    command = [sys.executable, "-m", "tests.pages", str(Path(app.srcdir) / PAGE)]
    path = {"PYTHONPATH": ":".join(p for p in sys.path if p)}
    done = subprocess.run(  # noqa: S603 - the page is ours
        command, cwd=folder, env={**os.environ, **path}, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise ExtensionError(f"{PAGE}: {done.stderr}")


def publish(app: Sphinx, error: Exception | None) -> None:
    """Put the pages beside those of the site."""
    if error is None and app.builder.format == "html":
        target = Path(app.outdir) / "made"
        target.mkdir(exist_ok=True)
        for path in sorted((Path(app.srcdir) / FOLDER).glob("*.html")):
            shutil.copyfile(path, target / path.name)


def setup(app: Sphinx) -> dict[str, bool]:
    """Make before pages are read, publish at the end."""
    app.connect("builder-inited", make)
    app.connect("build-finished", publish)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
