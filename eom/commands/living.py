"""Live pages: `eom live`."""

from __future__ import annotations

from pathlib import Path

import click

from eom.commands.shared import report_files, scene_argument, scene_of
from eom.errors import InputError


@click.command()
@scene_argument
@click.option(
    "--out", "file", required=True, type=click.Path(path_type=Path), help="Page: FILE.html."
)
def live(scene: str, file: Path) -> None:
    """Write SCENE as one page that integrates its equations where it is looked at.

    The page needs no network: sliders change numbers, boxes leave parts out, and equations and generated
    right-hand side change with them. Scenes under constraints have no live page.
    """
    from codegen.compiling.compiled import write_files
    from eom.views.live.page import page

    if file.suffix != ".html":
        raise InputError("a page is HTML", where="--out", got=str(file), expected="FILE.html")
    report_files(write_files({file.name: page(scene_of(scene))}, file.parent))
