"""Options that several commands have, as one table: a word means the same everywhere.

What is wrong with an option is told before any work: a file where a folder is needed, the other way round,
values that have no name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from pathlib import Path
from typing import Any

import click

from eom.errors import InputError, printable, spelt

Command = Callable[..., Any]


class _Seconds(click.types.FloatParamType):
    """A number of seconds, or a time in another unit, as "2 min"."""

    name = "float"

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """Return it in seconds. Raises `InputError` for what is no time."""
        from eom.units import in_unit, nearest

        found = in_unit(value, "s", param.opts[0]) if isinstance(value, str) else None
        if found is not None:
            return nearest(found)
        try:
            return float(value)
        except ValueError:
            self.fail(f"{value!r} is no time: give seconds, or a unit, as '2 min'", param, ctx)


class _Spelt(click.types.StringParamType):
    """A name among known ones, in any case; ``known`` is called when one is given."""

    def __init__(self, known: Callable[[], Iterable[str]]) -> None:
        self.known = known

    def convert(self, value: Any, *_: Any) -> Any:
        """Return it as it is known; others as they are."""
        return spelt(value, self.known())


def _methods() -> Iterable[str]:
    from codegen.integrate.methods import METHODS

    return METHODS


def _targets() -> Iterable[str]:
    from codegen.compiling.compiled import ROWS, TARGETS, UNIT

    return [*ROWS, *TARGETS, UNIT]


class Target(click.Path):
    """A file or folder to write; ``folder``: which of them."""

    def __init__(self, *, folder: bool) -> None:
        super().__init__(path_type=Path)
        self.folder = folder

    def convert(self, value: Any, param: Any, *_: Any) -> Path:
        """Return its path. Raises `InputError` where it cannot be."""
        return writable(Path(value), param.opts[0] if param else "", folder=self.folder)


def writable(path: Path, where: str, *, folder: bool) -> Path:
    """Return a path where a file, or a folder, can be written: there is none of the other kind.

    Raises `InputError` where there is, and where a folder on the way is a file.
    """
    wanted, other = ("a folder", "a file")[:: 1 if folder else -1]
    if (not path.name and not folder) or (path.exists() and path.is_dir() != folder):
        raise InputError(
            f"{wanted} is needed, and this is {other}", where=where, got=printable(path) or "nothing",
            hint=f"name {wanted} that there is, or one that is to be made",
        )  # fmt: skip
    above = next((p for p in path.parents if p.exists()), None)
    if above is not None and not above.is_dir():
        raise InputError(
            "a folder is needed, and this is a file", where=where, got=printable(above),
            hint=f"no {wanted.split()[1]} can be in it",
        )  # fmt: skip
    return path


SECONDS, METHOD, LANGUAGE = _Seconds(), _Spelt(_methods), _Spelt(_targets)
FILE, FOLDER = Target(folder=False), Target(folder=True)

VALUES = "eom.values"
"""Where the context of a command keeps what `--set` gives, for `eom.commands.shared.scene_of`."""


def _set(context: click.Context, _: click.Parameter, given: tuple[str, ...]) -> None:
    """Keep values by name. Raises `InputError` for what is none, and for names that come twice."""
    found: dict[str, str] = {}
    for text in given:
        name, sign, value = (part.strip() for part in text.partition("="))
        if not (name and sign and value):
            raise InputError(
                "not a value of a name", where=f"--set {text!r}", expected="NAME=VALUE",
                hint='as --set m=2, --set "theta=30 deg"',
            )  # fmt: skip
        if name in found:
            raise InputError(
                f"{name} is set twice", where="--set", got=f"{found[name]} and {value}"
            )
        found[name] = value
    context.meta[VALUES] = found


def _as_json(context: click.Context, _: click.Parameter, given: bool) -> bool:
    context.meta[JSON] = given
    return given


JSON = "eom.json"
"""Where the context of a command keeps whether it prints JSON, so that errors are printed so, too."""


def _kept(context: click.Context, option: click.Parameter, given: bool) -> None:
    context.meta[READING[str(option.name)]] = given


READING = {"lenient": "eom.lenient", "floating": "eom.floating"}
"""Options of reading a robot, by where the context of a command keeps them for `scene_of`."""
_OF_A_ROBOT = "Of a .urdf or .xml file:"

Row = tuple[tuple[str, ...], Mapping[str, Any]]

ROWS: Mapping[str, Row] = {
    "set": (
        ("--set", "values"),
        {
            "multiple": True,
            "metavar": "NAME=VALUE",
            "expose_value": False,
            "callback": _set,
            "help": "Another value of a parameter, an input or a state at the start, in SI or with a unit, "
            'as "theta=30 deg".  [may be repeated]',
        },
    ),
    "lenient": (
        ("--lenient",),
        {
            "is_flag": True,
            "expose_value": False,
            "callback": _kept,
            "help": f"{_OF_A_ROBOT} mend what no body or tree is, and print what was done.",
        },
    ),
    "floating": (
        ("--floating",),
        {
            "is_flag": True,
            "expose_value": False,
            "callback": _kept,
            "help": f"{_OF_A_ROBOT} free the root link of the ground.",
        },
    ),
    "method": (
        ("--method",),
        {
            "type": METHOD,
            "default": None,
            "metavar": "NAME",
            "help": "Integrator, one of those below, in any case.  [default: the scene's]",
        },
    ),
    "t_end": (
        ("--t-end", "--seconds", "t_end"),
        {
            "type": SECONDS,
            "default": None,
            "help": 'End time in seconds, or with a unit, as "2 min".  [default: the scene\'s]',
        },
    ),
    "rtol": (
        ("--rtol",),
        {
            "type": float,
            "default": None,
            "help": "Relative tolerance.  [default: the scene's]",
        },
    ),
    "points": (
        ("--points",),
        {
            "type": int,
            "default": None,
            "help": "Number of stored times.  [default: the scene's]",
        },
    ),
    "max_step": (
        ("--max-step",),
        {
            "type": SECONDS,
            "default": None,
            "help": "Longest step in seconds: a pulse or another narrow feature of the rates may be "
            "stepped over unless this is shorter.  [default: the scene's, else any]",
        },
    ),
    "max_steps": (
        ("--max-steps",),
        {
            "type": int,
            "default": None,
            "help": "Steps to try at most.  [default: the scene's]",
        },
    ),
    "integrate": (
        ("--integrate",),
        {
            "default": None,
            "metavar": "quaternion",
            "help": "Integrate a scene in angles in a quaternion, and show its angles.  [default: the "
            "scene's]",
        },
    ),
    "project": (
        ("--project",),
        {
            "multiple": True,
            "metavar": "all|NAME",
            "help": "Keep these constants of the motion after each step, as T, H or q_norm.",
        },
    ),
    "event": (
        ("--event", "events"),
        {
            "multiple": True,
            "metavar": '"EXPR [rising|falling] [stop [N]]"',
            "help": "Print when EXPR, over states, parameters, outputs and t, is zero: where it rises or "
            "falls alone, with stop also end the run there, or at the Nth.  As: --event "
            '"theta - 0.5 rising stop".',
        },
    ),
    "target": (
        ("--target",),
        {
            "type": LANGUAGE,
            "default": "auto",
            "show_default": True,
            "metavar": "c|numpy|python|jax|auto",
            "help": "What to compile for, in any case.",
        },
    ),
    "accuracy": (
        ("--accuracy/--no-accuracy", "estimated"),
        {
            "default": True,
            "help": "Estimate the error of every state by a second run of another kind.",
        },
    ),
    "jacobian": (
        ("--jacobian",),
        {
            "multiple": True,
            "metavar": "states|parameters|inputs|time",
            "help": "Also derivatives.",
        },
    ),
    "stable": (
        ("--stable",),
        {"is_flag": True, "help": "Apply every identity against cancellation."},
    ),
    "seed": (
        ("--seed",),
        {"type": int, "default": 0, "show_default": True, "help": "Of the random numbers."},
    ),
    "at": (
        ("--at", "held"),
        {
            "multiple": True,
            "metavar": "NAME=VALUE",
            "help": "A value that a state, an output or a constant of the motion must have: a number, one "
            "with a unit, or a formula over parameters, such as 90 deg or pi/2.  [default: free]",
        },
    ),
    "rename": (
        ("--name", "named"),
        {
            "multiple": True,
            "metavar": "OLD=NEW",
            "help": "Another name of a coordinate or speed, e.g. q_crank=phi.  [may be repeated]",
        },
    ),
    "style": (
        ("--as", "style"),
        {
            "default": "text",
            "show_default": True,
            "metavar": "text|latex|markdown|html",
            "help": "Format.",
        },
    ),
    "folder": (
        ("--out", "folder"),
        {"type": FOLDER, "help": "Folder to write to."},
    ),
    "file": (
        ("--out", "file"),
        {"type": FILE, "help": "File to write."},
    ),
    "json": (
        ("--json", "as_json"),
        {
            "is_flag": True,
            "is_eager": True,
            "callback": _as_json,
            "help": "Print everything as JSON.",
        },
    ),
}  # fmt: skip
"""Flags and settings of options by their names in a command."""

PLAN = ("method", "t_end", "rtol", "points", "max_step", "max_steps")
"""How a scene is integrated."""
SCENE = ("set", "lenient", "floating")
"""What goes with every scene that runs."""


def option(name: str, **changes: Any) -> Callable[[Command], Command]:
    """Return what adds an option of the table to a command; ``changes``: settings that differ there."""
    flags, settings = ROWS[name]
    return click.option(*flags, **{**settings, **changes})


def options(*names: str) -> Callable[[Command], Command]:
    """Return what adds options of the table to a command, in this order."""
    return lambda command: reduce(lambda made, name: option(name)(made), reversed(names), command)


def scene_argument(command: Command) -> Command:
    """Add the argument SCENE to a command, with the options of `SCENE`."""
    return click.argument("scene", metavar="SCENE")(options(*SCENE)(command))


def chosen_values() -> Mapping[str, str]:
    """Return what `--set` gave, by name, as it was written."""
    found: Mapping[str, str] = click.get_current_context().meta.get(VALUES, {})
    return found


def read_as() -> dict[str, bool | None]:
    """Return the options of reading a robot by name: True where they were given, else None."""
    meta = click.get_current_context().meta
    return {f"--{name}": meta.get(key) or None for name, key in READING.items()}
