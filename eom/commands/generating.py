"""Code, and its accuracy: `eom generate`, `eom accuracy`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import option, options, scene_argument, writable
from eom.commands.shared import (
    Rows,
    WithTable,
    compiled_of,
    compiling,
    progress_of,
    report_files,
    scene_of,
    waiting_for,
)
from eom.errors import InputError, spelt

if TYPE_CHECKING:
    from codegen.loops.written import Choice
    from eom.opening import AnyScene

UNIT = ".fmu"
"""Ending of a functional mock-up unit, which is a file."""


def _integrators() -> Rows:
    from codegen.loops.written import ROWS

    return [(row.name, row.meaning) for row in ROWS]


@click.command(cls=WithTable, title="Integrators", rows=_integrators)
@scene_argument
@option(
    "target",
    default="c",
    metavar="c|c_f32|c_lanes|numpy|python|javascript|jax|matlab|fmu",
    help="Language, in any case.",
)
@click.option(
    "--integrator",
    metavar="NAME",
    help="Written beside the targets c and javascript; see below.  [default for c: dop853]",
)
@option(
    "rtol",
    help="Tolerance that taylor's order suits.  [default: the scene's]",
)
@click.option(
    "--fmi", metavar="3.0|2.0", help="Version of the standard, for the target fmu.  [default: 3.0]"
)
@click.option(
    "--platform",
    multiple=True,
    metavar="NAME",
    help="Of the target fmu: x86_64-linux, x86_64-windows, aarch64-darwin, ...  [default: this one]",
)
@option(
    "folder",
    type=click.Path(path_type=Path),
    help="Folder to write to; of the target fmu also FILE.fmu.",
)
@click.option("--fixed", is_flag=True, help="Compile in the scene's parameter values.")
@click.option("--report", is_flag=True, help="Print operations by stage and kind, and file sizes.")
@options("stable", "jacobian")
@click.option(
    "--closed-form",
    is_flag=True,
    help="Instead: the motion of the scene's values in closed form, in C, where one is known.",
)
def generate(scene: str, folder: Path | None, **given: Any) -> None:
    """Write the equations of SCENE as C (with an integrator), or as a module.

    Targets: c; c_f32 (single precision, without the integrator); c_lanes (many points at once, in
    vectors); numpy; python (plain floats, no NumPy); javascript (for browsers and Node.js); jax
    (pure functions, for jit, vmap and grad); matlab (for MATLAB and GNU Octave);
    fmu (a functional mock-up unit with its integrator, for Simulink and Modelica tools).
    --out may be left out with --report.
    """
    if folder is None and not given["report"]:
        raise InputError("no folder to write to", expected="--out FOLDER", hint="or --report alone")
    if folder is not None:
        writable(folder, "--out", folder=folder.suffix != UNIT)
    chosen = scene_of(scene, rtol=given["rtol"])
    unit = {name: given.pop(name) for name in ("fmi", "platform")}
    if given["target"] == "fmu":
        _write_fmu(chosen, folder, given, **unit)
        return
    _refuse_options(unit, f"--target {given['target']}")
    if given.pop("closed_form"):
        files = partial(_closed_form_files, chosen)
        _write_alone(files, "--closed-form", folder, given)
    else:
        _generate(chosen, folder, **given)


def _generate(
    scene: AnyScene, folder: Path | None, target: str, fixed: bool, report: bool, **options: Any
) -> None:
    from codegen import generate as generate_files
    from codegen.compiling.compiled import write_files
    from codegen.precision.accuracy_report import show_operations

    integrator, values = options["integrator"], scene.parameter_values() if fixed else {}
    if report:
        show_operations(scene.derive(), values, target, _choice(integrator, scene))
    if folder is not None:
        with waiting_for("writing code"):
            files = generate_files(
                scene.derive(), None, target, values, integrator=integrator or "",
                rtol=scene.integration.rtol, jacobian=options["jacobian"], stable=options["stable"],
            )  # fmt: skip
        report_files(write_files(files, folder))


def _write_fmu(
    scene: AnyScene,
    folder: Path | None,
    options: Mapping[str, Any],
    fmi: str | None,
    platform: Sequence[str],
) -> None:
    """Write a scene as a functional mock-up unit. Raises `InputError` for options of other targets."""
    import codegen
    from codegen.native import native

    _refuse_options(options, "--target fmu", but=("target", "rtol"))
    assert folder is not None
    how = scene.integration
    values = scene.initial_values(), scene.parameter_values(), scene.input_values()
    with waiting_for("writing the unit") as show:
        path = codegen.write_fmu(
            scene.derive(), folder, *values, (0.0, how.t_end), how.rtol, fmi or "3.0", platform or None,
            compiling(show),
        )  # fmt: skip
    report_files([path])
    if not platform and not native.compiler():
        click.echo(
            "note: no C compiler found: sources alone are in it, which not every tool compiles; "
            f"for a library {native.GET_COMPILER}", err=True,
        )  # fmt: skip


def _refuse_options(options: Mapping[str, Any], what: str, but: Sequence[str] = ()) -> None:
    """Raise `InputError` for an option that was given and does not go with another."""
    for name, value in options.items():
        if value and name not in but:
            raise InputError(
                f"--{name.replace('_', '-')} does not go with {what}",
                hint=f"leave out --{name.replace('_', '-')}",
            )


def _write_alone(
    files: Callable[[], Mapping[str, str]],
    what: str,
    folder: Path | None,
    options: Mapping[str, Any],
) -> None:
    """Write files that no option of the others changes. Raises `InputError` for such an option."""
    from codegen.compiling.compiled import write_files

    _refuse_options(options, what, but=("target",) if options["target"] == "c" else ())
    assert folder is not None
    report_files(write_files(files(), folder))


def _closed_form_files(scene: AnyScene) -> Mapping[str, str]:
    import codegen
    from codegen.closed import closed_forms

    values = scene.initial_values(), scene.parameter_values(), scene.input_values()
    with waiting_for("deriving") as show:
        compiled = codegen.compile(scene.derive(), "python", progress=compiling(show))
        show("writing code")
        closed = closed_forms.of_values(compiled, *values)
        files = closed_forms.files(closed, f"{scene.name}_closed")
    click.echo(f"{closed.name}: {closed.meaning}")
    return files


def _choice(name: str | None, scene: AnyScene) -> Choice | None:
    from codegen.loops.written import Choice

    if name is None:
        return None
    return Choice(spelt(name, [row for row, _ in _integrators()]), scene.integration.rtol)


@click.command()
@scene_argument
@options("target", "t_end")
@click.option("--samples", type=int, default=None, help="Random points.  [default: 200]")
@option("seed", help="Of the random points.")
@click.option(
    "--range", "ranges", multiple=True, metavar="NAME=LOW:HIGH", help="Where; or NAME=VALUE."
)
@options("jacobian", "stable", "json")
def accuracy(
    scene: str, target: str, t_end: float | None, stable: bool, as_json: bool, **given: Any
) -> None:
    """Measure the error of every result of SCENE against 50 digits, and name its cause."""
    from codegen.precision import accuracy_report

    chosen = scene_of(scene, t_end=t_end)
    values = chosen.initial_values() | chosen.parameter_values() | chosen.input_values()
    given["values"] = values | {"t": chosen.integration.t_end}
    compiled = compiled_of(chosen, target, stable)
    with progress_of("measuring") as progress:
        report = accuracy_report.measured(compiled, progress=progress, **given)
    accuracy_report.show(report, as_json)
