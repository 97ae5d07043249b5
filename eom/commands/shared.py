"""What several commands have in common: scenes with options, progress, numbers as JSON.

Events of `eom simulate`: how they are spelt, and how what was found is printed.
"""

from __future__ import annotations

import importlib
import math
import re
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eom.commands.options import chosen_values, read_as
from eom.errors import InputError, near_matches, printable, spelt, unknown_name

if TYPE_CHECKING:
    from codegen import Compiled, Event, Result
    from eom.opening import AnyScene
    from eom.system import System

Rows = list[tuple[str, str]]

QUIET_SECONDS = 0.5
"""Work that is shorter shows no progress bar."""

EVERY = "all"
"""The word for every constant of the motion."""


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

    Options of reading a robot and values to set are those of the command. What lenient reading did goes to
    standard error.
    """
    from eom.multibody.files.scene import repair_notes
    from eom.opening import load_scene

    asked = read_as()
    scene = load_scene(name, strict=not asked["--lenient"], floating=bool(asked["--floating"]))
    for line in repair_notes(getattr(scene, "repairs", ())):
        click.echo(f"note: {line}", err=True)
    if values := chosen_values():
        try:
            scene = scene.with_values(values)
        except InputError as error:
            raise error.at(f"{name}: --set: {error.where}") from None
    changed = {k: v for k, v in options.items() if v is not None}
    if "method" in options:
        _check_method(scene, name, options["method"])
    if not changed:
        return scene
    own = {k: changed.pop(k) for k in _OF_THE_SCENE if k in changed}
    if changed:
        own["integration"] = {**scene.integration.model_dump(exclude_unset=True), **changed}
    try:
        return scene.changed(**own)
    except InputError as error:
        section, _, key = error.where.rpartition(".")
        if section != "integration" or key not in options:
            raise
        raise error.at(f"--{key.replace('_', '-')}") from None


def _check_method(scene: AnyScene, name: str, given: str | None) -> None:
    """Raise `InputError`, before any work, for a method of an option or of a scene file that is none."""
    from codegen.integrate.methods import METHODS

    method = given or scene.integration.method
    if spelt(method, METHODS) not in METHODS:
        where = "--method" if given else f"{name}: [integration] method"
        raise unknown_name("method", method, METHODS, where)


_OF_THE_SCENE = ("integrate",)
"""Options that are keys of the scene itself, and not of its integration."""


def methods() -> Rows:
    """Return names and meanings of the methods of `codegen.simulate`."""
    from codegen.integrate.methods import ROWS

    return [(row.name, row.meaning) for row in ROWS]


_HTML = (
    "html is for derivations, and for scenes of many bodies with --method; eom live and eom animate write "
    "scenes as pages"
)


def print_equations(scene: AnyScene, style: str, explain: bool) -> None:
    """Print the equations of a scene and, if asked for, what they leave out."""
    from eom.typeset.printing import FORMATS, show

    if style not in FORMATS:
        raise InputError(
            f"equations of a scene are not written as {style}", where=f"{scene.name}: --as",
            expected=", ".join(FORMATS), hint=_HTML if style == "html" else near_matches(style, FORMATS),
        )  # fmt: skip
    with waiting_for("deriving"):
        shown = show(scene.derive(), style)
        left_out = scene.explain() if explain and style == "text" else ""
    click.echo(shown)
    if explain and style == "text":
        click.echo(f"\nLeft out\n{left_out}")


def news(notice: str, noted: str) -> str:
    """Return the part of a notice that was not printed before."""
    return notice.replace(noted, "", 1).removeprefix("; ") if noted else notice


def compiled_of(
    scene: AnyScene, target: str, stable: bool = False, *, runs: bool = False, later: str = ""
) -> Compiled:
    """Return a scene compiled; what the user should know about it goes to standard error.

    ``runs``: whether it is integrated as the scene says; its loop is then compiled meanwhile. ``later``: a
    module that is imported while compilers work.
    """
    import codegen
    from codegen.ir import compile_progress
    from codegen.native import native
    from codegen.runs.prepared import loop_of

    plan = scene.integration
    beside = compile_progress.beside(loop_of(plan.method, plan.rtol)) if runs else nullcontext()
    if target in {"c", "auto"}:
        native.begin_extension()  # works while the system is derived
    with waiting_for("deriving") as show, beside:
        compiled = codegen.compile(
            scene.derive(), target, stable=stable, progress=compiling(show, later)
        )
    if compiled.notice:
        click.echo(f"note: {compiled.notice}", err=True)
    return compiled


def compiling(show: Callable[[str], None], later: str = "") -> Callable[[str, float], None]:
    """Return what `codegen.compile` reports its progress to, for the line that `waiting_for` shows.

    ``later``: a module that is going to be used, imported in a thread once compilers are waited for.
    """
    threads = [threading.Thread(target=_imported, args=(later,), daemon=True)] if later else []

    def report(stage: str, share: float) -> None:
        show(f"compiling: {stage} {share:.0%}")
        if stage == "compiler" and threads:
            threads.pop().start()

    return report


def _imported(module: str) -> None:
    with suppress(Exception):  # is raised again where it is used
        importlib.import_module(module)


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
    """Return data as JSON has them, at all depths: null where numbers are not finite, rows as lists."""
    if isinstance(values, Mapping):
        return {name: finite(v) for name, v in values.items()}
    if isinstance(values, list | tuple):
        return [finite(v) for v in values]
    if values is None or isinstance(values, str | bool | int):
        return values
    return float(values) if math.isfinite(values) else None


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
