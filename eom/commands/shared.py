"""What several commands have in common: their arguments, scenes with options, progress.

Events of `eom simulate`: how they are spelt, and how what was found is printed.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.errors import InputError, printable

if TYPE_CHECKING:
    from codegen import Compiled, Event, Result
    from eom.opening import AnyScene
    from eom.system import System

Rows = list[tuple[str, str]]

QUIET_SECONDS = 0.5
"""Work that is shorter shows no progress bar."""

READING = {"lenient": "eom.lenient", "floating": "eom.floating"}
"""Options of reading a robot, by where the context of a command keeps them for `scene_of`."""


def _kept(context: click.Context, option: click.Parameter, given: bool) -> None:
    context.meta[READING[str(option.name)]] = given


def reading_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of reading a robot to a command that opens scenes by `scene_of`."""
    lenient = click.option(
        "--lenient",
        is_flag=True,
        expose_value=False,
        callback=_kept,
        help="Of a .urdf or .xml file: mend what no body or tree is, and print what was done.",
    )
    floating = click.option(
        "--floating",
        is_flag=True,
        expose_value=False,
        callback=_kept,
        help="Of a .urdf or .xml file: free the root link of the ground.",
    )
    return lenient(floating(command))


def read_as() -> dict[str, bool | None]:
    """Return the options of reading a robot by name: True where they were given, else None."""
    meta = click.get_current_context().meta
    return {f"--{name}": meta.get(key) or None for name, key in READING.items()}


def scene_argument(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the argument SCENE to a command, with the options of reading a robot."""
    return click.argument("scene", metavar="SCENE")(reading_options(command))


class _Seconds(click.types.FloatParamType):
    """A number of seconds, or a time in another unit, as "2 min"."""

    name = "float"

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """Return it in seconds. Raises `InputError` for what is no time."""
        from eom.units import in_unit, nearest

        found = in_unit(value, "s", param.opts[0]) if isinstance(value, str) else None
        return super().convert(value, param, ctx) if found is None else nearest(found)


SECONDS = _Seconds()
"""What options of times take."""


target_option = click.option(
    "--target",
    default="auto",
    show_default=True,
    metavar="c|numpy|python|jax|auto",
    help="What to compile for.",
)
EVERY = "all"
"""The word for every constant of the motion."""
project_option = click.option(
    "--project",
    multiple=True,
    metavar="all|NAME",
    help="Keep these constants of the motion after each step, as T, H or q_norm.",
)


integrate_option = click.option(
    "--integrate",
    default=None,
    metavar="quaternion",
    help="Integrate a scene in angles in a quaternion, and show its angles.  [default: the scene's]",
)


class WithTable(click.Command):
    """A command whose help ends with a table of names and meanings, made for the help alone."""

    def __init__(self, title: str, rows: Callable[[], Rows], **settings: Any) -> None:
        super().__init__(**settings)
        self.title, self.rows = title, rows

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the table."""
        with formatter.section(self.title):
            formatter.write_dl(self.rows())
        super().format_epilog(ctx, formatter)


def scene_of(name: str, **options: Any) -> AnyScene:
    """Return a ready scene or one from a file, with the options that were given.

    What lenient reading did goes to standard error.
    """
    from eom.multibody.files.scene import repair_notes
    from eom.opening import load_scene

    asked = read_as()
    scene = load_scene(name, strict=not asked["--lenient"], floating=bool(asked["--floating"]))
    for line in repair_notes(getattr(scene, "repairs", ())):
        click.echo(f"note: {line}", err=True)
    changed = {k: v for k, v in options.items() if v is not None}
    if not changed:
        return scene
    own = {k: changed.pop(k) for k in _OF_THE_SCENE if k in changed}
    if changed:
        own["integration"] = {**scene.integration.model_dump(exclude_unset=True), **changed}
    return scene.changed(**own)


_OF_THE_SCENE = ("integrate",)
"""Options that are keys of the scene itself, and not of its integration."""


def methods() -> Rows:
    """Return names and meanings of the methods of `codegen.simulate`."""
    from codegen.integrate.methods import ROWS

    return [(row.name, row.meaning) for row in ROWS]


def print_equations(scene: AnyScene, style: str, explain: bool) -> None:
    """Print the equations of a scene and, if asked for, what they leave out."""
    from eom.typeset.printing import show

    with waiting_for("deriving"):
        shown = show(scene.derive(), style)
        left_out = scene.explain() if explain and style == "text" else ""
    click.echo(shown)
    if explain and style == "text":
        click.echo(f"\nLeft out\n{left_out}")


def news(notice: str, noted: str) -> str:
    """Return the part of a notice that was not printed before."""
    return notice.replace(noted, "", 1).removeprefix("; ") if noted else notice


def compiled_of(scene: AnyScene, target: str, stable: bool = False) -> Compiled:
    """Return a scene compiled; what the user should know about it goes to standard error."""
    import codegen

    with waiting_for("deriving") as show:
        compiled = codegen.compile(scene.derive(), target, stable=stable, progress=compiling(show))
    if compiled.notice:
        click.echo(f"note: {compiled.notice}", err=True)
    return compiled


def compiling(show: Callable[[str], None]) -> Callable[[str, float], None]:
    """Return what `codegen.compile` reports its progress to, for the line that `waiting_for` shows."""
    return lambda stage, share: show(f"compiling: {stage} {share:.0%}")


@contextmanager
def progress_of(work: str) -> Iterator[Callable[[float], None]]:
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


@contextmanager
def waiting_for(work: str) -> Iterator[Callable[[str], None]]:
    """Show that something goes on whose end nobody knows, once it has taken a while, as `progress_of`.

    Yields a function that shows what it is called with instead of ``work``. Nothing may be printed
    meanwhile: the line that is shown is written over.
    """
    from threading import Timer

    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda words: None
        return
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    bar = Progress(
        *columns, console=console, transient=True, redirect_stdout=False, redirect_stderr=False
    )
    task = bar.add_task(work, total=None)
    timer = Timer(QUIET_SECONDS, bar.start)
    timer.daemon = True
    timer.start()
    try:
        yield lambda words: bar.update(task, description=words)
    finally:
        timer.cancel()
        timer.join()  # it may be starting the bar just now
        bar.stop()


def report_files(files: list[Path], *, err: bool = False) -> None:
    """Print what was written; to standard error where the other stream holds JSON."""
    for file in files:
        click.echo(f"wrote {printable(file)} ({file.stat().st_size:,} bytes)", err=err)


def finite(values: Any) -> Any:
    """Return numbers, or nested rows of them, as JSON has them: null where they are not finite."""
    if isinstance(values, list | tuple):
        return [finite(v) for v in values]
    return float(values) if math.isfinite(values) else None


event_option = click.option(
    "--event",
    "events",
    multiple=True,
    metavar='"EXPR [rising|falling] [stop [N]]"',
    help=(
        "Print when EXPR, over states, parameters, outputs and t, is zero: where it rises or falls "
        'alone, with stop also end the run there, or at the Nth.  As: --event "theta - 0.5 rising stop".'
    ),
)
_DIRECTIONS = {"rising": 1, "falling": -1}
_END = re.compile(
    r"^(?P<text>.*?)(?:\s+(?P<direction>rising|falling))?(?:\s+(?P<stop>stop)(?:\s+(?P<times>\S+))?)?\s*$",
    re.DOTALL,
)
MOST_TIMES = 6
"""Times of an event that are listed in the closing table."""


def events_of(texts: Sequence[str], system: System) -> tuple[Event, ...]:
    """Return events from what was given, each named by its text.

    Raises `InputError` for what is no formula over the names of the system, and for other numbers of
    times than whole ones from 1 on; `codegen.simulate` raises it for what cannot be an event.
    """
    groups = (system.definitions, system.outputs, system.states, system.parameters, system.inputs)
    names = {q.name: q.symbol for group in groups for q in group}
    names = {"t": system.time, **names}
    return tuple(_event(text, names) for text in texts)


def _event(text: str, names: Mapping[str, Any]) -> Event:
    from codegen import Event
    from eom.scenes.parse import parse

    where = f"--event {text!r}"
    found = _END.match(text)
    assert found is not None
    if not found["text"].strip():
        raise InputError("an event has no expression", where=where,
                         expected='as "theta - 0.5 rising stop"')  # fmt: skip
    expression = parse(found["text"], names, where)
    return Event(expression, _DIRECTIONS.get(found["direction"], 0), _times(found, where), text)


def _times(found: re.Match[str], where: str) -> int:
    if found["times"] is None:
        return int(found["stop"] is not None)
    if not found["times"].isdecimal() or int(found["times"]) < 1:
        raise InputError("an event cannot end a run so", where=where, got=f"stop {found['times']}",
                         expected="stop, or stop and a number of times from 1 on")  # fmt: skip
    return int(found["times"])


def rows(result: Result) -> list[tuple[str, str]]:
    """Return how often each event happened, and when, for the closing table."""
    return [(f"event {name}", _listed(e.t)) for name, e in result.events.items()]


def _listed(times: Any) -> str:
    if not len(times):
        return "never"
    shown = ", ".join(f"{t:.9g}" for t in times[:MOST_TIMES])
    more = ", ..." if len(times) > MOST_TIMES else ""
    return f"{len(times):,}, at t = {shown}{more} s"
