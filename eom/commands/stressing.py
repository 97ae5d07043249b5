"""Numerical stability: `eom stress`."""

from __future__ import annotations

import datetime
import io
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.shared import Rows, WithTable, progress_of, report_files
from eom.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from codegen.measure.stress.record import Check, Material, Plan, Trial
    from codegen.measure.stress.showing import Outcome
    from codegen.measure.workprecision.case import Case
    from eom.problems import Problem

FAILED = 1
"""Exit status where a check fails or cannot be measured."""
WIDTH = 160


def _checks() -> Rows:
    from codegen.measure.stress.checks import CHECKS

    return [(check.name, check.states) for check in CHECKS]


@click.command(cls=WithTable, title="Checks", rows=_checks)
@click.argument("names", metavar="[CHECK]...", nargs=-1)
@click.option(
    "--method", "methods", multiple=True, metavar="M", help="Only this method; repeatable."
)
@click.option("--quick", is_flag=True, help="Fewer and shorter runs: about two minutes.")
@click.option(
    "--full", is_flag=True, help="1e6 rotations, whole problems, 1000 scenes: half an hour."
)
@click.option(
    "--out",
    "folder",
    type=click.Path(path_type=Path),
    default=None,
    help="Folder for the table as stress.txt and all figures as stress.json.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Of starts and scenes.")
@click.option("--json", "as_json", is_flag=True, help="Print all figures as JSON, not the table.")
def stress(
    names: tuple[str, ...],
    methods: tuple[str, ...],
    folder: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Measure numerical stability against bounds that follow from something; a table of pass and fail.

    Without names every check is made. Exit status: 0 if all pass, 1 if one fails or cannot be
    measured, 2 for unusable input.
    """
    from codegen.compiling.compiled import write_files
    from codegen.measure.stress import showing
    from codegen.measure.stress.checks import chosen

    checks, plan = chosen(names), _plan(methods, **options)
    if folder is not None:
        write_files({}, folder)
    material = _material()
    outcomes = [_measured(check, material, plan) for check in checks]
    text = _print(outcomes, plan, quiet=as_json)
    data = showing.data(outcomes, plan, _about())
    if folder is not None:
        files = {"stress.json": data, "stress.txt": text}
        report_files(write_files(files, folder), err=as_json)
    if as_json:
        click.echo(data, nl=False)
    if not showing.all_passed(outcomes):
        sys.exit(FAILED)


def _plan(methods: tuple[str, ...], quick: bool, full: bool, seed: int) -> Plan:
    from codegen.measure.stress.record import SIZES, Plan, methods_of

    if quick and full:
        raise InputError("--quick and --full exclude each other", hint="leave one out")
    size = SIZES["quick" if quick else "full" if full else "default"]
    return Plan(size, methods_of(methods), seed)


def _material() -> Material:
    """Derive what is measured on."""
    from codegen.measure.stress.record import Material
    from eom import problems
    from eom.commands.random_scenes import draw_scene
    from eom.mechanics.rigidbody import free_rigid_body
    from eom.scenes import catalogue

    ready, scenes = catalogue.names(), catalogue.single()
    return Material(
        free_body=free_rigid_body("quaternion"),
        in_angles={name: free_rigid_body(name) for name in ("3-2-1", "3-1-3")},
        problems=tuple(_case(n) for n in problems.names() if n not in ready),
        scenes=tuple(_case(n) for n in scenes),
        draw=draw_scene,
        trials=_trials,
        closed=tuple(_closed()),
    )


def _trials() -> tuple[Trial, ...]:
    from codegen.measure.stress.record import Trial
    from eom.trials import TRIALS

    return tuple(Trial(_case_of(t.problem), t.method, t.rtol, t.solution) for t in TRIALS)


def _closed() -> Iterator[Case]:
    """Yield every kind of system that has a closed form, by kind of attitude and what is left out."""
    from codegen.measure.workprecision.case import Case
    from eom.mechanics.rigidbody import free_rigid_body, full_inertia, heavy_top, rigid_body
    from eom.mechanics.spinning import SpinningSymmetricBody
    from eom.mechanics.torques import applied
    from eom.scenes import reduce

    moments = {"I1": 1.25, "I2": 1.25, "I3": 2.0}
    matrix = {"J11": 2.0, "J12": 0.25, "J13": -0.125, "J22": 2.5, "J23": 0.0625, "J33": 1.75}
    weight = {**moments, "m": 3.0, "g": 9.81, "r3": 0.2}
    still = rigid_body(full_inertia(), lambda C, J: applied((0, 0, 0)))
    spinner = SpinningSymmetricBody((0, 0, 0)).system()
    I1, I2 = (q.symbol for q in heavy_top().parameters[:2])
    equal = [reduce.substitute(s, {I2: I1}) for s in (free_rigid_body(), heavy_top())]
    for name in ("quaternion", "dcm", "3-1-3", "3-2-1"):
        yield Case(f"free body, {name}", "", free_rigid_body(name), {}, moments, {}, 1.0)
        yield Case(f"top, {name}", "", heavy_top(name), {}, weight, {}, 1.0)
    yield Case("full inertia", "", still, {}, matrix, {}, 1.0)
    yield Case("spinner", "", spinner, {}, {"I1": 0.25, "I2": 0.5}, {}, 1.0)
    yield Case(
        "spinner, tilt alone",
        "",
        reduce.prune(spinner, ["theta"]),
        {},
        {"I1": 0.25, "I2": 0.5},
        {},
        1.0,
    )
    for system in equal:
        spun = reduce.freeze(system, reduce.constant_states(system))
        yield Case(
            f"{system.name} with constant spin", "", spun, {}, {**weight, "omega_3": 3.0}, {}, 1.0
        )


def _case(name: str) -> Case:
    from eom import problems

    return _case_of(problems.ready(name))


def _case_of(p: Problem) -> Case:
    from codegen.measure.workprecision.case import Case

    numbers = (p.start, p.parameters, p.inputs)
    return Case(p.name, p.title, p.system, *numbers, p.end, p.stiff)


def _measured(check: Check, material: Material, plan: Plan) -> Outcome:
    from codegen.measure.stress.showing import Outcome

    began = time.perf_counter()
    with progress_of(check.name) as progress:
        findings = check.run(material, replace(plan, progress=progress))
    return Outcome(check, findings, time.perf_counter() - began)


def _about() -> dict[str, Any]:
    from codegen.measure import machine

    date = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    return {"machine": machine.description(), "date": date}


def _print(outcomes: list[Outcome], plan: Plan, quiet: bool) -> str:
    """Print the table and what is to be said of it, unless quiet; return the same as text."""
    from rich.console import Console

    from codegen.measure.stress import showing

    file = io.StringIO() if quiet else None
    console = Console(record=True, width=max(WIDTH, Console().width), file=file)
    console.print(showing.table(outcomes, plan))
    for line in showing.lines(outcomes):
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    return console.export_text()
