"""Trajectories: `eom simulate`, `eom run`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.jobs import Job, job_of
from eom.commands.occurring import event_option, rows
from eom.commands.shared import (
    WithTable,
    handover_option,
    methods,
    print_equations,
    progress_of,
    project_option,
    report_files,
    scene_argument,
    scene_of,
    target_option,
)
from eom.errors import InputError

if TYPE_CHECKING:
    from codegen import Result

STOPPED = 1
"""Exit status of a run that ended before its time."""
REACHED, AT_EVENT = 0, 2
"""Of `codegen.Result.status`: what counts as done."""
MOST_CHANGES = 6
"""Times of changes of chart that are told."""


@click.command(cls=WithTable, title="Methods", rows=methods)
@scene_argument
@click.option(
    "--method", default=None, help="Integrator, one of those below.  [default: the scene's]"
)
@click.option(
    "--t-end", type=float, default=None, help="End time in seconds.  [default: the scene's]"
)
@click.option(
    "--rtol", type=float, default=None, help="Relative tolerance.  [default: the scene's]"
)
@click.option(
    "--points", type=int, default=None, help="Number of stored times.  [default: the scene's]"
)
@click.option(
    "--max-steps", type=int, default=None, help="Steps to try at most.  [default: the scene's]"
)
@project_option
@handover_option
@event_option
@target_option
@click.option(
    "--out",
    "file",
    type=click.Path(path_type=Path),
    default=None,
    help="Save to FILE.npz or FILE.csv.",
)
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
    default=None,
    help="Draw to FILE.png, .svg or .pdf, or to FILE.html to turn by hand.",
)
def simulate(
    scene: str,
    target: str,
    file: Path | None,
    plot: Path | None,
    project: tuple[str, ...],
    events: tuple[str, ...],
    **options: Any,
) -> None:
    """Integrate SCENE; print steps, time, drift of the constants and distance from singularities.

    A run that ends at an event of the kind stop ends as it should, with exit status 0. With --out, events
    are saved to FILE.events.csv: number of the event, direction, time and states.
    """
    from codegen import export

    if file is not None:
        export.check_kind(file)
    if plot is not None:
        _check_picture(plot)
    chosen = scene_of(scene, **options)
    job = job_of(chosen, target, project, events)
    result = _simulate(job)
    _save(job, result, file, plot)
    _closing(job, result)


@click.command()
@scene_argument
@click.option(
    "--out", "folder", required=True, type=click.Path(path_type=Path), help="Folder to write to."
)
@project_option
@handover_option
@target_option
def run(
    scene: str, folder: Path, target: str, project: tuple[str, ...], handover: bool | None
) -> None:
    """Do the whole job for SCENE: equations, generated code, trajectory and plot."""
    from codegen.compiled import write_files
    from eom.views.saving import can_write

    chosen = scene_of(scene, handover=handover)
    job = job_of(chosen, target, project)
    print_equations(chosen, "text", explain=True)
    click.echo()
    report_files(write_files(job.files, folder))
    result = _simulate(job)
    picture = folder / "trajectory.png"
    drawn = can_write(picture)
    _save(job, result, folder / "trajectory.npz", picture if drawn else None)
    if not drawn:
        click.echo("note: no picture: install it with pip install 'eom-toolkit[plot]'", err=True)
    _closing(job, result)


def _simulate(job: Job) -> Result:
    with progress_of("integrating") as progress:
        return job.integrate(progress)


def _save(job: Job, result: Result, file: Path | None, plot: Path | None) -> None:
    from codegen import export

    written = []
    if file is not None:
        written.append(export.save(result, file))
        if result.events:
            written.append(export.save_events(result, file.with_suffix(".events.csv")))
    if plot is not None:
        written += _draw(job, result, plot)
    report_files(written)


def _draw(job: Job, result: Result, file: Path) -> list[Path]:
    """Draw histories; a run that stopped before there is anything to draw is told of, and not drawn."""
    from eom.views.histories import histories_asked
    from eom.views.saving import save

    try:
        picture = histories_asked(result, job.system, job.requested_names(), job.scene)
    except InputError as error:
        click.echo(f"note: no picture: {error.what}", err=True)
        return []
    return [save(picture, file)]


def _check_picture(file: Path) -> None:
    """Raise `InputError` for a kind of picture that cannot be written."""
    from eom.views.saving import kind_of

    kind_of(file)


def _changes(result: Result) -> str:
    """Say how often and when angles were handed over to the quaternion and taken back."""
    times = ", ".join(f"{t:.6g}" for t in result.changes[:MOST_CHANGES])
    more = ", ..." if len(result.changes) > MOST_CHANGES else ""
    return f"{len(result.changes):,}, at t = {times}{more} s" if times else "none"


def _closing(job: Job, result: Result) -> None:
    """Print the closing table; a run that stopped early ends with status 1."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_row("result", escape(result.message))
    table.add_row("method", result.method)
    if result.why:
        table.add_row("chosen because", result.why)
    if left_out := [*job.not_needed(), *result.left_out]:
        table.add_row("left out", f"{', '.join(left_out)}: no output needs them")
    if job.handed:
        table.add_row("changes of chart", _changes(result))
    table.add_row(
        "steps", f"{result.steps:,} ({result.rejected:,} rejected), {result.nfev:,} evaluations"
    )
    table.add_row("time", f"{1e3 * result.seconds:.3g} ms")
    for name, times in rows(result):
        table.add_row(escape(name), times)
    for name, drift in result.drift.items():
        kind = "relative" if drift.scale == abs(drift.start) else "absolute"
        table.add_row(f"drift of {name}", f"{drift.relative:.2e} {kind}, from {drift.start:.6g}")
    for expression, distance in result.margin.items():
        table.add_row("singularity margin", f"|{expression}| >= {distance:.3g}")
    Console(soft_wrap=True).print(table)
    if result.status not in {REACHED, AT_EVENT}:
        sys.exit(STOPPED)
