"""Trajectories: `eom simulate`, `eom run`."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import FILE, PLAN, option, options, scene_argument
from eom.commands.shared import (
    EVERY,
    WithTable,
    compiled_of,
    events_of,
    finite,
    methods,
    news,
    print_equations,
    progress_of,
    report_files,
    rows,
    scene_of,
    waiting_for,
)
from eom.errors import InputError

if TYPE_CHECKING:
    from rich.table import Table

    from codegen import Accuracy, Result
    from codegen.runs.pruning import Drift
    from eom.opening import AnyScene
    from eom.system import System

STOPPED = 1
"""Exit status of a run that ended before its time."""
REACHED, AT_EVENT = 0, 2
"""Of `codegen.Result.status`: what counts as done."""
CANCELS = 2.0
"""Size of the terms of a constant of the motion over its value from which on it is printed."""
ALARM, NOTE = "bold red", "yellow"
"""Colours of what is printed where no digit is left, and of other notices."""
LONGEST = 30.0
"""Seconds of a run from which on its error is not estimated: a second may take several times as long."""


Progress = Callable[[float], None]


@dataclass(frozen=True)
class Job:
    """A scene that is ready to run.

    ``system``: whose states and outputs the result has; ``files``: the generated code by name;
    ``integrate``: the run, for a function that receives the progress; ``noted``: the notice when
    it was compiled.
    """

    scene: AnyScene
    system: System
    files: Mapping[str, str]
    integrate: Callable[[Progress], Result]
    noted: str = ""

    def not_needed(self) -> list[str]:
        """Return the states that the system has neither as states nor, constant, as parameters."""
        kept = {*self.system.state_names, *self.system.parameter_names}
        return [n for n in self.scene.full_system.state_names if n not in kept]


PRINTER = "matplotlib.figure"
"""What printed pictures are drawn by, whose import takes a third of a second."""


def job_of(
    scene: AnyScene,
    target: str,
    project: tuple[str, ...],
    events: tuple[str, ...] = (),
    later: str = "",
) -> Job:
    """Return the job of a scene. Raises `InputError` for what does not go together.

    ``later``: a module that it is going to need, imported while compilers work.
    """
    import codegen

    compiled = compiled_of(scene, target, runs=not (project or events), later=later)
    plan = scene.integration
    found = events_of(events, compiled.system)

    def integrate(progress: Progress) -> Result:
        return codegen.simulate(
            compiled,
            scene.initial_values(),
            (0.0, plan.t_end),
            scene.parameter_values(),
            plan.method,
            plan.rtol,
            plan.atol,
            _times(scene),
            inputs=scene.input_values(),
            max_step=plan.max_step or math.inf,
            max_steps=plan.max_steps,
            project=EVERY in project or project or None,
            events=found,
            progress=progress,
        )

    return Job(scene, scene.derive(), compiled.files, integrate, compiled.notice)


def _times(scene: AnyScene) -> list[float]:
    plan = scene.integration
    return [*(plan.t_end * k / (plan.points - 1) for k in range(plan.points - 1)), plan.t_end]


@click.command(cls=WithTable, title="Methods", rows=methods)
@scene_argument
@options(*PLAN, "integrate", "project", "event", "target")
@option("file", help="Save to FILE.npz or FILE.csv.")
@click.option(
    "--plot",
    type=FILE,
    default=None,
    help="Draw to FILE.png, .svg or .pdf, or to FILE.html to turn by hand.",
)
@option("accuracy")
@option("json", help="Print the trajectory and all that is printed as JSON.")
def simulate(
    scene: str,
    target: str,
    file: Path | None,
    plot: Path | None,
    project: tuple[str, ...],
    events: tuple[str, ...],
    as_json: bool,
    estimated: bool,
    **plan: Any,
) -> None:
    """Integrate SCENE; print steps, time, accuracy, drift of the constants and distance from singularities.

    The accuracy is an estimate of the error of all states, relative to the size of those of one
    unit. A run that ends at an event of the kind stop ends as it should, with exit status 0. With
    --out, events are saved to FILE.events.csv: number of the event, direction, time and states.
    """
    from codegen.runs import export, second_run

    if file is not None:
        export.check_kind(file)
    if plot is not None:
        _check_picture(plot)
    chosen = scene_of(scene, **plan)
    job = job_of(chosen, target, project, events)
    result = _simulate(job)
    if estimated and result.seconds <= LONGEST:
        second_run.begin(result.origin)
    _save(job, result, file, plot, err=as_json)
    result, accuracy = _estimated(result, estimated)
    if as_json:
        click.echo(json.dumps(data(job, result, accuracy), indent=1, allow_nan=False))
    else:
        _closing(job, result, accuracy)
    _end(result)


@click.command(cls=WithTable, title="Methods", rows=methods)
@scene_argument
@option("folder", required=True)
@options(*PLAN, "integrate", "project", "event", "accuracy", "target")
def run(
    scene: str,
    folder: Path,
    target: str,
    project: tuple[str, ...],
    events: tuple[str, ...],
    estimated: bool,
    **plan: Any,
) -> None:
    """Do the whole job for SCENE: equations, generated code, trajectory and plot."""
    from codegen.compiling.compiled import write_files
    from codegen.runs import second_run
    from eom.views.draw.saving import can_write

    chosen = scene_of(scene, **plan)
    picture = folder / "trajectory.png"
    drawn = can_write(picture)
    job = job_of(chosen, target, project, events, PRINTER if drawn else "")
    print_equations(chosen, "text", explain=True)
    click.echo()
    report_files(write_files(job.files, folder))
    result = _simulate(job)
    if estimated and result.seconds <= LONGEST:
        second_run.begin(result.origin)
    _save(job, result, folder / "trajectory.npz", picture if drawn else None)
    if not drawn:
        click.echo("note: no picture: install it with pip install 'eom-toolkit[plot]'", err=True)
    _closing(job, *_estimated(result, estimated))
    _end(result)


def _estimated(result: Result, wanted: bool) -> tuple[Result, Accuracy | str]:
    """Return a run with the estimate of its error, and that, or why there is none."""
    if not wanted:
        return result, ""
    if result.seconds > LONGEST:
        took = f"{result.seconds:.3g} s"
        return (
            result,
            f"not estimated: the run took {took}, a second one may take several times that",
        )
    with waiting_for("estimating the error"):
        result = result.with_accuracy()
    return result, result.accuracy()


def _simulate(job: Job) -> Result:
    with progress_of("integrating") as progress:
        return job.integrate(progress)


def _save(
    job: Job, result: Result, file: Path | None, plot: Path | None, *, err: bool = False
) -> None:
    from codegen.runs import export

    written = []
    if file is not None:
        written.append(export.save(result, file))
        if result.events:
            written.append(export.save_events(result, file.with_suffix(".events.csv")))
    if plot is not None:
        written += _draw(job, result, plot)
    report_files(written, err=err)


def _draw(job: Job, result: Result, file: Path) -> list[Path]:
    """Draw histories; a run that stopped before there is anything to draw is reported, and not drawn."""
    from eom.views.draw.saving import save
    from eom.views.time.histories import histories_asked

    try:
        picture = histories_asked(result, job.system, job.scene.requested_names(), job.scene)
    except InputError as error:
        click.echo(f"note: no picture: {error.what}", err=True)
        return []
    if picture.notice:
        click.echo(f"note: {picture.notice}", err=True)
    return [save(picture, file)]


def _check_picture(file: Path) -> None:
    """Raise `InputError` for a kind of picture that cannot be written."""
    from eom.views.draw.saving import kind_of

    kind_of(file)


def _closing(job: Job, result: Result, accuracy: Accuracy | str) -> None:
    """Print the closing table."""
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
    table.add_row(
        "steps", f"{result.steps:,} ({result.rejected:,} rejected), {result.nfev:,} evaluations"
    )
    table.add_row("time", f"{1e3 * result.seconds:.3g} ms")
    _add_accuracy(table, accuracy)
    for name, times in rows(result):
        table.add_row(escape(name), times)
    for name, drift in result.drift.items():
        table.add_row(f"drift of {name}", _in_words(drift))
    for expression, distance in result.margin.items():
        table.add_row("singularity margin", f"|{expression}| >= {distance:.3g}")
    if notice := news(result.notice, job.noted):
        alarming = not isinstance(accuracy, str) and accuracy.warning
        table.add_row("notice", escape(notice), style=ALARM if alarming else NOTE)
    Console(soft_wrap=True).print(table)


def _add_accuracy(table: Table, accuracy: Accuracy | str) -> None:
    """Say how good the run is, against what, and how errors grow."""
    from rich.markup import escape

    if isinstance(accuracy, str):
        if accuracy:
            table.add_row("accuracy", accuracy)
        return
    against = f", by a second run with {accuracy.second}" if accuracy.second else ""
    table.add_row(
        "accuracy", escape(f"{accuracy}{against}"), style=ALARM if accuracy.warning else ""
    )
    if accuracy.growth.size and math.isfinite(accuracy.rate):
        grown = f"{accuracy.growth[-1]:.2g} times from start to end, {accuracy.rate:.2g} 1/s"
        table.add_row("errors grow", grown)


def data(job: Job, result: Result, accuracy: Accuracy | str = "") -> dict[str, Any]:
    """Return a trajectory and its notices as JSON has it; what is not finite is null."""
    rows = zip(result.names, result.y.tolist(), strict=True)
    return {
        "scene": job.scene.name,
        "status": result.status,
        "message": result.message,
        "notice": result.notice,
        "method": result.method,
        "why": result.why,
        "steps": result.steps,
        "rejected": result.rejected,
        "evaluations": result.nfev,
        "seconds": result.seconds,
        "left_out": [*job.not_needed(), *result.left_out],
        "accuracy": _judged(accuracy),
        "drift": {n: _drift(d) for n, d in result.drift.items()},
        "margin": {n: finite(m) for n, m in result.margin.items()},
        "events": {n: finite(e.t.tolist()) for n, e in result.events.items()},
        "t": finite(result.t.tolist()),
        "states": {n: finite(row) for n, row in rows},
        "held": {n: finite(value) for n, value in result.held.items()},
        "outputs": {n: finite(row.tolist()) for n, row in result.outputs.items()},
    }


def _judged(accuracy: Accuracy | str) -> dict[str, Any] | None:
    """Return an estimate as JSON has it; null where there is none."""
    if isinstance(accuracy, str):
        return {"text": accuracy} if accuracy else None
    grown = float(accuracy.growth[-1]) if accuracy.growth.size else math.nan
    return {
        "text": str(accuracy),
        "at_end": {n: finite(e) for n, e in accuracy.at_end.items()},
        "largest": {n: finite(e) for n, e in accuracy.largest.items()},
        "horizon": accuracy.horizon,
        "growth": finite(grown),
        "rate": finite(accuracy.rate),
        "lost": list(accuracy.lost),
        "second": accuracy.second,
    }


def _in_words(drift: Drift) -> str:
    """Say how far a constant wandered; where it is small beside its terms also their size."""
    of = f", of terms of {drift.size:.3g}" if drift.size > CANCELS * abs(drift.start) else ""
    return f"{drift.relative:.2e} {drift.kind}, from {drift.start:.6g}{of}"


def _drift(drift: Drift) -> dict[str, float | None]:
    numbers = {
        "start": drift.start,
        "largest": drift.largest,
        "size": drift.size,
        "relative": drift.relative,
    }
    return {name: finite(number) for name, number in numbers.items()}


def _end(result: Result) -> None:
    """End with status 1 where a run stopped early."""
    if result.status not in {REACHED, AT_EVENT}:
        sys.exit(STOPPED)
