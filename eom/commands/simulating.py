"""Trajectories: `eom simulate`, `eom run`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.shared import (
    EVERY,
    WithTable,
    compiled_of,
    methods,
    print_equations,
    progress_of,
    project_option,
    report_files,
    scene_argument,
    scene_of,
    target_option,
)

if TYPE_CHECKING:
    from codegen import Compiled, Result
    from eom.scene import Scene

STOPPED = 1
"""Exit status of a run that ended before its time."""


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
@target_option
@click.option(
    "--out",
    "file",
    type=click.Path(path_type=Path),
    default=None,
    help="Save to FILE.npz or FILE.csv.",
)
@click.option(
    "--plot", type=click.Path(path_type=Path), default=None, help="Draw to FILE.png, .pdf or .svg."
)
def simulate(
    scene: str,
    target: str,
    file: Path | None,
    plot: Path | None,
    project: tuple[str, ...],
    **options: Any,
) -> None:
    """Integrate SCENE; print steps, time, drift of the constants and distance from singularities."""
    from codegen import export

    export.check_kinds(file, plot)
    chosen = scene_of(scene, **options)
    result = _simulate(chosen, compiled_of(chosen, target), project)
    _save(chosen, result, file, plot)
    _closing(chosen, result)


@click.command()
@scene_argument
@click.option(
    "--out", "folder", required=True, type=click.Path(path_type=Path), help="Folder to write to."
)
@project_option
@target_option
def run(scene: str, folder: Path, target: str, project: tuple[str, ...]) -> None:
    """Do the whole job for SCENE: equations, generated code, trajectory and plot."""
    from codegen import export

    chosen = scene_of(scene)
    print_equations(chosen, "text", explain=True)
    click.echo()
    compiled = compiled_of(chosen, target)
    report_files(compiled.write(folder))
    result = _simulate(chosen, compiled, project)
    picture = folder / "trajectory.png" if export.can_draw() else None
    _save(chosen, result, folder / "trajectory.npz", picture)
    if picture is None:
        click.echo("note: no picture: install it with pip install 'eom-toolkit[plot]'", err=True)
    _closing(chosen, result)


def _simulate(scene: Scene, compiled: Compiled, project: tuple[str, ...]) -> Result:
    import codegen

    plan = scene.integration
    times = [plan.t_end * k / (plan.points - 1) for k in range(plan.points)]
    initial, parameters = scene.initial_values(), scene.parameter_values()
    with progress_of("integrating") as progress:
        return codegen.simulate(
            compiled,
            initial,
            (0.0, plan.t_end),
            parameters,
            plan.method,
            plan.rtol,
            plan.atol,
            times,
            inputs=scene.input_values(),
            max_steps=plan.max_steps,
            project=EVERY in project or project,
            progress=progress,
        )


def _save(scene: Scene, result: Result, file: Path | None, plot: Path | None) -> None:
    from codegen import export

    written = []
    if file is not None:
        written.append(export.save(result, file))
    if plot is not None:
        system = scene.derive()
        quantities = [*system.states, *(d.quantity for d in system.outputs)]
        units = {q.name: q.unit for q in quantities}
        written.append(export.save_plot(result, plot, scene.requested_names(), units, scene.title))
    report_files(written)


def _not_needed(scene: Scene) -> list[str]:
    """Return the states that the derived system has neither as states nor, constant, as parameters."""
    system = scene.derive()
    kept = {*system.state_names, *system.parameter_names}
    return [n for n in scene.full_system.state_names if n not in kept]


def _closing(scene: Scene, result: Result) -> None:
    """Print the closing table; a run that stopped early ends with status 1."""
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_row("result", result.message)
    table.add_row("method", result.method)
    if result.why:
        table.add_row("chosen because", result.why)
    if left_out := [*_not_needed(scene), *result.left_out]:
        table.add_row("left out", f"{', '.join(left_out)}: no output needs them")
    table.add_row(
        "steps", f"{result.steps:,} ({result.rejected:,} rejected), {result.nfev:,} evaluations"
    )
    table.add_row("time", f"{1e3 * result.seconds:.3g} ms")
    for name, drift in result.drift.items():
        kind = "relative" if drift.scale == abs(drift.start) else "absolute"
        table.add_row(f"drift of {name}", f"{drift.relative:.2e} {kind}, from {drift.start:.6g}")
    for expression, distance in result.margin.items():
        table.add_row("singularity margin", f"|{expression}| >= {distance:.3g}")
    Console(soft_wrap=True).print(table)
    if result.status != 0:
        sys.exit(STOPPED)
