"""Run time against error: `eom bench`."""

from __future__ import annotations

import datetime
import io
import json
import os
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import chosen_values, option, options
from eom.commands.shared import Rows, WithTable, progress_of, report_files, scene_of
from eom.errors import InputError, spelt

if TYPE_CHECKING:
    from codegen.measure.workprecision.measuring import Diagram, Plan
    from codegen.measure.workprecision.programs import Program
    from eom.problems import Problem

FIRST_SECONDS = 600.0
"""For a first result, in a process of its own."""
WIDTH = 120
"""Columns of the table at least: no cell is cut."""


def _problems() -> Rows:
    from eom.problems import names, ready

    return [(name, ready(name).title) for name in names()]


@click.command(cls=WithTable, title="Problems", rows=_problems)
@click.argument("names", metavar="[PROBLEM|SCENE]...", nargs=-1)
@options("set", "lenient", "floating")
@click.option("--all", "everything", is_flag=True, help="Every reference problem and ready scene.")
@click.option(
    "--methods",
    default=None,
    metavar="NAME,NAME,...",
    help="Only these; also solve_ivp:DOP853, solve_ivp:LSODA, solve_ivp:Radau and heyoka.",
)
@option(
    "folder",
    help="Folder for a table, a picture and all data as JSON of each problem.",
)
@option("t_end", help="End time in seconds, or with a unit.  [default: the problem's]")
@click.option("--quick", is_flag=True, help="Fewer tolerances and rounds, in seconds a problem.")
@option("seed", help="Of the order of the runs.")
@option("json", help="Print all data as JSON instead of tables.")
def bench(
    names: tuple[str, ...],
    everything: bool,
    methods: str | None,
    t_end: float | None,
    folder: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Measure run time against error of every method, beside SciPy and heyoka.

    Times are those of the integration alone, the least of repeated runs in shuffled order; +30% says
    that their median is so much more. The time to a first result is listed on its own. Errors are those
    at the end, against a solution with many digits.
    """
    from codegen.compiling.compiled import write_files
    from codegen.measure.workprecision import programs

    if not names and not everything:
        raise InputError("no problem named", expected="PROBLEM or SCENE ...", hint="or --all")
    chosen = _chosen(names, everything, t_end)
    known = [p.name for p in programs.programs([])]
    asked = [] if methods is None else [spelt(m, known) for m in methods.split(",")]
    measured = programs.programs(asked)
    if folder is not None:
        write_files({}, folder)
    about = _about(measured)
    found = [_bench(p, measured, _plan(**options), folder, about, as_json, t_end) for p in chosen]
    if as_json:
        click.echo(json.dumps({"problems": found}, indent=1))


def _chosen(names: tuple[str, ...], everything: bool, t_end: float | None) -> list[Problem]:
    """Return each problem once, in order, with the values and the end time that were given."""
    from eom import problems

    wanted = [*names, *(problems.names() if everything else [])]
    return [
        problems.from_scene(scene_of(name, t_end=t_end))
        if problems.is_scene(name)
        else problems.ready(name, chosen_values(), t_end)
        for name in dict.fromkeys(wanted)
    ]


def _plan(quick: bool, seed: int) -> Plan:
    from dataclasses import replace

    from codegen.measure.workprecision.measuring import QUICK, Plan

    return replace(QUICK if quick else Plan(), seed=seed)


def _about(measured: list[Program]) -> dict[str, Any]:
    from codegen.measure import machine

    found = machine.description(["heyoka"])
    if found["heyoka"] == "not installed" and any(p.name == "heyoka" for p in measured):
        click.echo("note: no heyoka: install it with pip install 'eom-toolkit[bench]'", err=True)
    date = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    return {"machine": found, "date": date}


def _bench(
    problem: Problem,
    measured: list[Program],
    plan: Plan,
    folder: Path | None,
    about: Mapping[str, Any],
    as_json: bool,
    t_end: float | None,
) -> Any:
    """Measure a problem, print or write what was found, and return it as data."""
    from codegen.measure.workprecision.case import Case
    from codegen.measure.workprecision.measuring import data, measure

    numbers = (problem.start, problem.parameters, problem.inputs)
    case = Case(problem.name, problem.title, problem.system, *numbers, problem.end, problem.stiff)
    with progress_of(f"measuring {problem.name}") as progress:
        first = _first_results(problem, measured, progress, t_end)
        diagram = measure(case, measured, plan, lambda f: progress(0.1 + 0.9 * f))
    lines = _print(diagram, first, quiet=as_json)
    about = {**about, "source": problem.source, "closed": problem.closed, "first_result": first}
    if folder is not None:
        report_files(_write(diagram, lines, about, folder), err=as_json)
    return json.loads(data(diagram, about))


def _first_results(
    problem: Problem,
    measured: list[Program],
    progress: Callable[[float], None],
    t_end: float | None,
) -> dict[str, dict[str, float]]:
    """Return seconds by stage in new processes, with an empty cache and with what it then holds."""
    from codegen.native import children
    from codegen.native.native import CACHE_VARIABLE

    others = "heyoka" if any(p.name == "heyoka" for p in measured) else "none"
    changes = json.dumps([dict(chosen_values()), t_end])
    command = [sys.executable, "-m", "eom.commands.first", problem.name, others, changes]
    found = {}
    with tempfile.TemporaryDirectory() as cache:
        for k, kind in enumerate(("uncached", "cached")):
            environment = {**os.environ, CACHE_VARIABLE: cache}
            done = children.finished(command, seconds=FIRST_SECONDS, environment=environment)
            if done.returncode != 0:
                reason = next(iter(done.stderr.strip().splitlines()[-1:]), "no message")
                click.echo(f"note: no time to a first result: {reason}", err=True)
                break
            found[kind] = json.loads(done.stdout.splitlines()[-1])
            progress(0.05 * (k + 1))
    return found


def _print(diagram: Diagram, first: Mapping[str, Mapping[str, float]], quiet: bool) -> str:
    """Print the table and what is to be said of it, unless quiet; return the same as text."""
    from rich.console import Console

    from codegen.measure.workprecision.measuring import comparison_lines, notes, table

    file = io.StringIO() if quiet else None
    console = Console(record=True, width=max(WIDTH, Console().width), file=file)
    console.print(table(diagram))
    for line in (*comparison_lines(diagram), *notes(diagram)):
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    for kind, laps in first.items():
        stages = ", ".join(f"{name} {1e3 * seconds:.3g} ms" for name, seconds in laps.items())
        console.print(f"first result, {kind}: {stages}", highlight=False, soft_wrap=True)
    console.print()
    return console.export_text()


def _write(diagram: Diagram, text: str, about: Mapping[str, Any], folder: Path) -> list[Path]:
    from codegen.compiling.compiled import write_files
    from codegen.measure.workprecision.measuring import data
    from eom.views.draw.saving import can_write, save
    from eom.views.time.work_precision import work_precision

    name = diagram.case.name
    files = {f"{name}.json": data(diagram, about), f"{name}.txt": text}
    written = write_files(files, folder)
    picture = folder / f"{name}.png"
    if can_write(picture):
        written.append(save(work_precision(diagram), picture))
    else:
        click.echo("note: no picture: install it with pip install 'eom-toolkit[plot]'", err=True)
    return written
