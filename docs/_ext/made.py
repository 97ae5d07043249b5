"""Pictures and pages that pages of the documentation make: their blocks are run before the site is built.

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

PAGES = (
    "explanation/conventions.md",
    "howto/pictures.md",
    "howto/control.md",
    "howto/rotary-pendulum.md",
    "howto/reaction-wheels.md",
)
FOLDER = "_made"


def make(app: Sphinx) -> None:
    """Run the pages, each in a process of its own. What they show is compared with what they print."""
    folder = Path(app.srcdir) / FOLDER
    folder.mkdir(exist_ok=True)
    path = {"PYTHONPATH": ":".join(p for p in sys.path if p), "MPLBACKEND": "agg"}
    for page in PAGES:
        command = [sys.executable, "-m", "tests.pages", str(Path(app.srcdir) / page)]
        done = subprocess.run(  # noqa: S603 - the pages are ours
            command,
            cwd=folder,
            env={**os.environ, **path},
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            raise ExtensionError(f"{page}: {done.stderr}")


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
