"""The command line: list, derive, generate, accuracy, simulate, run."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom import catalogue
from eom.errors import InputError, unknown_name

if TYPE_CHECKING:
    from codegen import Compiled, Result
    from eom.scene import Scene

STOPPED, UNUSABLE = 1, 2
QUIET_SECONDS = 0.5
"""Work that is shorter shows no progress bar."""


class Commands(click.Group):
    """Turn input errors into one message and exit status 2."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except InputError as error:
            click.echo(f"error: {error}", err=True)
            ctx.exit(UNUSABLE)
        except OSError as error:
            click.echo(f"error: {error.strerror or error}", err=True)
            ctx.exit(UNUSABLE)


@click.group(
    cls=Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100}
)
@click.version_option(package_name="eom-toolkit", prog_name="eom")
def main() -> None:
    """Derive equations of motion, generate code from them, and integrate them.

    SCENE is the name of a ready scene (see: eom list) or a TOML file. Exit status: 0 done; 1 the
    run stopped before its end; 2 unusable input.
    """


scene_argument = click.argument("scene", metavar="SCENE")
target_option = click.option(
    "--target",
    default="auto",
    show_default=True,
    metavar="c|numpy|python|auto",
    help="What to compile for.",
)


@main.command("list")
def list_names() -> None:
    """List the scenes and derivations that ship with the package."""
    from rich.console import Console
    from rich.table import Table

    from eom import derivations

    table = Table(box=None, show_header=False, pad_edge=False)
    for group, titles in {"Scenes": catalogue.titles(), **derivations.titles()}.items():
        table.add_row(f"[bold]{group}[/bold]")
        for name, title in titles.items():
            table.add_row(f"  {name}", title)
        table.add_row()
    Console(soft_wrap=True).print(table)
    click.echo("Try: eom derive bicycle-wheel, or: eom run bicycle-wheel --out wheel")
    click.echo("or:  eom derive euler-equations --notation underline --as html > euler.html")


@main.command()
@click.argument("name", metavar="NAME")
@click.option(
    "--as",
    "style",
    default="text",
    show_default=True,
    metavar="text|latex|markdown|html",
    help="Format; html for derivations alone.",
)
@click.option(
    "--explain/--no-explain",
    default=None,
    help="Scenes: say what was skipped and why (text only).  [default: explain]",
)
@click.option(
    "--notation",
    default=None,
    metavar="arrow|superscript|underline|kane",
    help="Derivations: how vectors and frames are written.  [default: arrow]",
)
@click.option(
    "--steps/--no-steps",
    default=None,
    help="Derivations: every step, or the statements alone.  [default: steps]",
)
def derive(
    name: str, style: str, explain: bool | None, notation: str | None, steps: bool | None
) -> None:
    """Derive NAME and print it: the equations of motion of a scene, or a derivation step by step.

    NAME is the name of a ready scene or derivation (see: eom list) or a TOML file.
    """
    if _is_derivation(name):
        _refuse(name, "scenes", {"--explain": explain})
        _print_derivation(name, style, notation or "arrow", steps is not False)
    else:
        _refuse(name, "derivations", {"--notation": notation, "--steps": steps})
        _print_equations(_scene(name), style, explain is not False)


@main.command()
@scene_argument
@click.option(
    "--target",
    default="c",
    show_default=True,
    metavar="c|c_f32|c_lanes|numpy|python|javascript",
    help="Language.",
)
@click.option("--out", "folder", type=click.Path(path_type=Path), help="Folder to write to.")
@click.option("--fixed", is_flag=True, help="Compile in the scene's parameter values.")
@click.option("--report", is_flag=True, help="Print operations by stage and kind, and file sizes.")
@click.option("--stable", is_flag=True, help="Apply every identity against cancellation.")
@click.option(
    "--jacobian", multiple=True, metavar="states|parameters|inputs|time", help="Also derivatives."
)
def generate(
    scene: str, target: str, folder: Path | None, fixed: bool, report: bool, **options: Any
) -> None:
    """Write the equations of SCENE as C (with an integrator), or as a module.

    Targets: c; c_f32 (single precision, without the integrator); c_lanes (many points at once, in
    vectors); numpy; python (plain floats, no NumPy); javascript (for browsers and Node.js).
    --out may be left out with --report.
    """
    from codegen.compiled import generate as generate_files
    from codegen.compiled import write_files
    from codegen.linear import with_jacobians
    from codegen.pipeline import specialised
    from codegen.report import show as show_report

    if folder is None and not report:
        raise InputError("no folder to write to", expected="--out FOLDER", hint="or --report alone")
    chosen = _scene(scene)
    values = chosen.parameter_values() if fixed else {}
    if report:
        show_report(chosen.derive(), values, target)
    if folder is not None:
        made = specialised(chosen.derive(), values, stable=options["stable"])
        made = with_jacobians(*made, options["jacobian"], options["stable"])
        _report_files(write_files(generate_files(*made, target), folder))


@main.command()
@scene_argument
@target_option
@click.option("--samples", type=int, default=None, help="Random points.  [default: 200]")
@click.option("--seed", type=int, default=0, show_default=True, help="Of the random points.")
@click.option(
    "--range", "ranges", multiple=True, metavar="NAME=LOW:HIGH", help="Where; or NAME=VALUE."
)
@click.option(
    "--jacobian", multiple=True, metavar="states|parameters|inputs|time", help="Also derivatives."
)
@click.option("--stable", is_flag=True, help="Apply every identity against cancellation.")
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON.")
def accuracy(scene: str, target: str, stable: bool, as_json: bool, **options: Any) -> None:
    """Measure the error of every result of SCENE against 50 digits, and name its cause."""
    from codegen import card_text

    chosen = _scene(scene)
    values = chosen.initial_values() | chosen.parameter_values() | chosen.input_values()
    options["values"] = values | {"t": chosen.integration.t_end}
    compiled = _compile(chosen, target, stable)
    with _progress("measuring") as progress:
        card = card_text.measured(compiled, progress=progress, **options)
    card_text.show(card, as_json)


@main.command()
@scene_argument
@click.option(
    "--method", default=None, help="Integrator; see codegen.METHODS.  [default: the scene's]"
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
def simulate(scene: str, target: str, file: Path | None, plot: Path | None, **options: Any) -> None:
    """Integrate SCENE; print steps, time, drift of the constants and distance from singularities."""
    from codegen import export

    export.check_kinds(file, plot)
    chosen = _scene(scene, **options)
    result = _simulate(chosen, _compile(chosen, target))
    _save(chosen, result, file, plot)
    _closing(result)


@main.command()
@scene_argument
@click.option(
    "--out", "folder", required=True, type=click.Path(path_type=Path), help="Folder to write to."
)
@target_option
def run(scene: str, folder: Path, target: str) -> None:
    """Do the whole job for SCENE: equations, generated code, trajectory and plot."""
    from codegen import export

    chosen = _scene(scene)
    _print_equations(chosen, "text", explain=True)
    click.echo()
    compiled = _compile(chosen, target)
    _report_files(compiled.write(folder))
    result = _simulate(chosen, compiled)
    picture = folder / "trajectory.png" if export.can_draw() else None
    _save(chosen, result, folder / "trajectory.npz", picture)
    if picture is None:
        click.echo("note: no picture: install it with pip install 'eom-toolkit[plot]'", err=True)
    _closing(result)


def _is_derivation(name: str) -> bool:
    """Tell derivations from scenes and files. Raises `InputError` for names of neither."""
    from eom import derivations

    if _is_file(name) or name in catalogue.names():
        return False
    if name not in derivations.names():
        raise unknown_name("scene or derivation", name, [*catalogue.names(), *derivations.names()])
    return True


def _refuse(name: str, kind: str, options: dict[str, object]) -> None:
    for option, value in options.items():
        if value is not None:
            raise InputError(f"{option} is for {kind}", where=name, hint=f"leave out {option}")


def _print_derivation(name: str, style: str, notation: str, steps: bool) -> None:
    from eom.derivations import derive
    from eom.showing import check_choices, show_derivation

    check_choices(style, notation)
    click.echo(show_derivation(derive(name), style, notation, steps))


def _is_file(name: str) -> bool:
    return name.endswith(".toml") or "/" in name


def _scene(name: str, **options: Any) -> Scene:
    """Return a ready scene or one from a file, with the options that were given."""
    from eom.scene import Scene

    scene = Scene.from_toml(name) if _is_file(name) else Scene.ready(name)
    changed = {k: v for k, v in options.items() if v is not None}
    if not changed:
        return scene
    data = scene.model_dump(exclude_unset=True)
    data["integration"] = {**data.get("integration", {}), **changed}
    return Scene(**data)


def _print_equations(scene: Scene, style: str, explain: bool) -> None:
    from eom.printing import show

    click.echo(show(scene.derive(), style))
    if explain and style == "text":
        click.echo(f"\nLeft out\n{scene.explain()}")


def _compile(scene: Scene, target: str, stable: bool = False) -> Compiled:
    import codegen

    compiled = codegen.compile(scene.derive(), target, stable=stable)
    if compiled.notice:
        click.echo(f"note: {compiled.notice}", err=True)
    return compiled


def _simulate(scene: Scene, compiled: Compiled) -> Result:
    import codegen

    plan = scene.integration
    times = [plan.t_end * k / (plan.points - 1) for k in range(plan.points)]
    initial, parameters = scene.initial_values(), scene.parameter_values()
    with _progress("integrating") as progress:
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
            progress=progress,
        )


@contextmanager
def _progress(work: str) -> Iterator[Callable[[float], None]]:
    """Show a progress bar once the work has taken a while, on a terminal's standard error."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    bar = Progress(console=console, transient=True, disable=not console.is_terminal)
    task = bar.add_task(work, total=1.0)
    began = time.monotonic()

    def report(fraction: float) -> None:
        if not bar.live.is_started and time.monotonic() - began > QUIET_SECONDS:
            bar.start()
        bar.update(task, completed=fraction)

    try:
        yield report
    finally:
        if bar.live.is_started:
            bar.stop()


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
    _report_files(written)


def _report_files(files: list[Path]) -> None:
    for file in files:
        click.echo(f"wrote {file} ({file.stat().st_size:,} bytes)")


def _closing(result: Result) -> None:
    """Print the closing table; a run that stopped early ends with status 1."""
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_row("result", result.message)
    table.add_row("method", result.method)
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


if __name__ == "__main__":
    main(prog_name="eom")
