"""Numerical stability: `eom stress`.

Random scenes: bodies of all symmetries, torques from a grammar, all attitudes, hard starts.

A scene is named by a seed, a number and how many kinds there are. Its kind, the number modulo that,
decides what is derived and compiled: attitude, shape of the inertia, formulas of the torque. All numbers
belong to the scene. The same names give the same scene.
"""

from __future__ import annotations

import datetime
import io
import math
import random
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import METHOD, option
from eom.commands.shared import Rows, WithTable, progress_of, report_files
from eom.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from codegen.measure.stress.checks import Outcome
    from codegen.measure.stress.record import Check, Material, Plan, Trial
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
    "--method",
    "methods",
    type=METHOD,
    multiple=True,
    metavar="M",
    help="Only this method; repeatable.",
)
@click.option("--quick", is_flag=True, help="Fewer and shorter runs: about two minutes.")
@click.option(
    "--full", is_flag=True, help="1e6 rotations, whole problems, 1000 scenes: half an hour."
)
@option(
    "folder",
    help="Folder for the table as stress.txt and all figures as stress.json.",
)
@option("seed", help="Of starts and scenes.")
@option("json", help="Print all figures as JSON, not the table.")
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
    from codegen.measure.stress import checks

    made, plan = checks.chosen(names), _plan(methods, **options)
    if folder is not None:
        write_files({}, folder)
    material = _material()
    outcomes = [_measured(check, material, plan) for check in made]
    text = _print(outcomes, plan, quiet=as_json)
    data = checks.data(outcomes, plan, _about())
    if folder is not None:
        files = {"stress.json": data, "stress.txt": text}
        report_files(write_files(files, folder), err=as_json)
    if as_json:
        click.echo(data, nl=False)
    if not checks.all_passed(outcomes):
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
    from codegen.measure.stress.checks import Outcome

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

    from codegen.measure.stress import checks

    file = io.StringIO() if quiet else None
    console = Console(record=True, width=max(WIDTH, Console().width), file=file)
    console.print(checks.table(outcomes, plan))
    for line in checks.lines(outcomes):
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    return console.export_text()


ATTITUDES = ("none", "quaternion", "dcm", "3-2-1", "3-1-3", "1-2-3", "2-1-2", "3-1-2", "1-3-1")
ANGLE = {"quaternion": "q1", "dcm": "C23"}
"""What a spring pulls on; the sine of the second angle in all sequences."""


@dataclass(frozen=True)
class Term:
    """A term of a torque about axis k: its formula with {k} and {angle}, and its parameters.

    Each is drawn times a scale: M (moment times rate squared), c (moment times rate), J (moment),
    w (rate), or 1.
    """

    formula: str
    scales: tuple[tuple[str, str], ...]
    needs_attitude: bool = False


TERMS = (
    Term("M{k}", (("M{k}", "M"),)),
    Term("A{k}*sin(f{k}*t + e{k})", (("A{k}", "M"), ("f{k}", "w"), ("e{k}", "1"))),
    Term("-c{k}*omega_{k}", (("c{k}", "c"),)),
    Term("-d{k}*omega_{k}*abs(omega_{k})", (("d{k}", "J"),)),
    Term("-b{k}*sign(omega_{k})", (("b{k}", "M"),)),
    Term("-s{k}*{angle}", (("s{k}", "M"),), needs_attitude=True),
)
COUNTS = (0, 0, 1, 1, 2)
"""How many terms a component has."""
SPECIAL = ("components", "components", "components", "weight", "gravity_gradient")


@dataclass(frozen=True)
class Kind:
    """What is compiled once: attitude, torque, its components, whether the inertia is a full matrix."""

    attitude: str
    torque: str
    terms: tuple[tuple[Term, ...], ...]
    full: bool


def kind(seed: int, number: int) -> Kind:
    """Return a kind of scene; the first ones go through the attitudes."""
    draw = random.Random(f"kind {seed} {number}")  # noqa: S311 - reproducible scenes
    attitude = ATTITUDES[number % len(ATTITUDES)]
    torque = draw.choice(SPECIAL) if attitude != "none" else "components"
    usable = [t for t in TERMS if attitude != "none" or not t.needs_attitude]
    terms = tuple(tuple(draw.sample(usable, draw.choice(COUNTS))) for _ in range(3))
    return Kind(attitude, torque, terms, full=draw.random() < 0.25)


def draw_scene(seed: int, number: int, kinds: int) -> Case:
    """Return scene ``number`` as a case; ``title`` says what was drawn."""
    from codegen.measure.workprecision.case import Case
    from eom.problems import from_scene
    from eom.scenes.scene import Scene

    scene = Scene(**description(seed, number, kinds))
    problem = from_scene(scene)
    numbers = (problem.start, problem.parameters, problem.inputs)
    return Case(problem.name, scene.description, problem.system, *numbers, problem.end)


def description(seed: int, number: int, kinds: int) -> dict[str, Any]:
    """Return the data of a scene, as a scene file has them."""
    chosen = kind(seed, number % kinds)
    draw = random.Random(f"scene {seed} {number}")  # noqa: S311 - reproducible scenes
    size = 10 ** draw.uniform(-3, 3)
    moments = _moments(draw, size)
    omega, rate = _omega(draw)
    torque, parameters = _torque(chosen, draw, size, rate)
    data: dict[str, Any] = {
        "name": f"scene-{number % kinds}",
        "description": f"number {number}: {chosen.attitude}, {torque}, moments {moments}, omega {omega}",
        "attitude": chosen.attitude,
        "body": {"matrix": _matrix(moments)} if chosen.full else {"moments": moments},
        "torque": torque,
        "parameters": parameters,
        "initial": {f"omega_{k}": w for k, w in enumerate(omega, 1)},
        "integration": {"t_end": draw.uniform(0.3, 3.0) * 2 * math.pi / rate},
    }
    if chosen.attitude != "none":
        data["initial_attitude"] = _attitude(chosen.attitude, draw)
    return data


def _moments(draw: random.Random, size: float) -> list[float]:
    """Second moments along three axes give what a body can have; some of them are equal."""
    x, y, z = (size * 10 ** draw.uniform(-2, 0) for _ in range(3))
    shape = draw.random()
    y = x if shape < 0.25 else y
    z = x if shape < 0.05 else z
    return [y + z, x + z, x + y]


def _matrix(moments: list[float]) -> list[list[float]]:
    """Turn principal moments by half a radian about b3, then b1."""
    c, s = math.cos(0.5), math.sin(0.5)
    R = [[c, s, 0.0], [-s * c, c * c, s], [s * s, -c * s, c]]
    J = [
        [sum(R[i][m] * moments[m] * R[j][m] for m in range(3)) for j in range(3)] for i in range(3)
    ]
    return [[J[max(i, j)][min(i, j)] for j in range(3)] for i in range(3)]


def _omega(draw: random.Random) -> tuple[list[float], float]:
    """Return components, some or all of them zero or tiny, and the rate that times are measured by."""
    rate = 10 ** draw.uniform(-1, 1)
    masks: tuple[Callable[[], float], ...] = (
        lambda: draw.uniform(-1, 1), lambda: draw.uniform(-1, 1), lambda: draw.uniform(-1, 1),
        lambda: 0.0, lambda: 1e-8 * draw.uniform(-1, 1),
    )  # fmt: skip
    if draw.random() < 0.1:
        return [0.0, 0.0, 0.0], rate
    return [rate * draw.choice(masks)() for _ in range(3)], rate


def _torque(
    chosen: Kind, draw: random.Random, size: float, rate: float
) -> tuple[dict[str, Any], dict[str, float]]:
    if chosen.torque == "weight":
        arm = [draw.choice((0.0, draw.uniform(-1, 1))) for _ in range(2)]
        mass = size * rate**2 / 9.81
        return {"weight": {"mass": mass, "centre_of_mass": [*arm, 1.0]}}, {}
    if chosen.torque == "gravity_gradient":
        return {"gravity_gradient": {"orbital_rate": rate * draw.uniform(0.05, 1.0)}}, {}
    scales = {"M": size * rate**2, "c": size * rate, "J": size, "w": rate, "1": 1.0}
    angle = ANGLE.get(chosen.attitude, "sin(theta)")
    parts, parameters = [], {}
    for k, terms in enumerate(chosen.terms, 1):
        parts.append(" + ".join(t.formula.format(k=k, angle=angle) for t in terms) or "0")
        for term in terms:
            for name, scale in term.scales:
                parameters[name.format(k=k)] = scales[scale] * draw.uniform(0.01, 0.5)
    return {"components": parts}, parameters


def _attitude(name: str, draw: random.Random) -> dict[str, Any]:
    """Any turn; with angles also next to, and in, the singular configuration."""
    if name in {"quaternion", "dcm"}:
        q = [draw.gauss(0, 1) for _ in range(4)]
        norm = math.sqrt(sum(v * v for v in q))
        return {"quaternion": [v / norm for v in q]}
    singular = 0.0 if name[0] == name[-1] else math.pi / 2
    near = draw.choice((0.0, 1e-7, 1e-4, 1e-2, *[draw.uniform(0.3, 1.2)] * 6))
    angles = [draw.uniform(-3, 3), singular - near, draw.uniform(-3, 3)]
    return {"sequence": name, "radians": angles}
