"""Completion of words in a shell: `eom completion`, and the words that arguments and options take."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import click
from click.shell_completion import CompletionItem, get_completion_class

from eom.errors import unknown_name
from eom.scenes import catalogue

SHELLS = ("bash", "zsh", "fish")
VARIABLE = "_EOM_COMPLETE"

Words = Callable[[], Iterable[str]]


def _derivations() -> Iterable[str]:
    from eom import derivations

    return derivations.names()


def _methods() -> Iterable[str]:
    from codegen.integrate.methods import ROWS

    return [row.name for row in ROWS]


def _presets() -> Iterable[str]:
    from eom.checker.mean.lexicon_files import PRESETS

    return PRESETS


def _slips() -> Iterable[str]:
    from eom.exercises.slips import names

    return names()


NOTATIONS = ("arrow", "superscript", "underline", "kane")

WORDS: dict[tuple[str, str], Words] = {
    ("derive", "name"): lambda: [*catalogue.names(), *_derivations()],
    ("exercise", "topic"): _derivations,
    ("check", "notation"): _presets,
    ("exercise", "slip"): _slips,
    ("", "scene"): catalogue.names,
    ("", "notation"): lambda: NOTATIONS,
    **{(command, "method"): _methods for command in ("simulate", "run", "animate")},
    ("stress", "methods"): _methods,
    ("ensemble", "method"): lambda: ("auto", "taylor", "DOP853"),
    ("derive", "method"): lambda: ("lagrange", "kane", "newton-euler", "all"),
    ("derive", "style"): lambda: ("text", "latex", "markdown", "html"),
    ("exercise", "style"): lambda: ("markdown", "moodle"),
    ("generate", "target"): lambda: ("c", "c_f32", "c_lanes", "numpy", "python", "javascript"),
    ("", "target"): lambda: ("c", "numpy", "python", "auto"),
}
"""What completes a parameter of a command, by the names of both; "" for any command."""

FILES = frozenset({"scene", "name"})
"""Parameters that may be files as well."""


def complete(
    context: click.Context, parameter: click.Parameter, start: str
) -> list[CompletionItem]:
    """Return what a word of the command line may become; for scenes files, too."""
    name = parameter.name or ""
    command = (context.info_name or "").replace("linearize", "linearise")
    words = WORDS.get((command, name)) or WORDS.get(("", name))
    found = [CompletionItem(w) for w in words() if w.startswith(start)] if words else []
    if name in FILES:
        found.append(CompletionItem(start, type="file"))
    return found


def completing(command: click.Command) -> click.Command:
    """Let the parameters of a command complete themselves, those that the table names."""
    for parameter in command.params:
        known = {(command.name or "", parameter.name or ""), ("", parameter.name or "")}
        if known & set(WORDS):
            parameter._custom_shell_complete = complete
    return command


@click.command()
@click.argument("shell", metavar="bash|zsh|fish")
@click.pass_context
def completion(context: click.Context, shell: str) -> None:
    """Print the script by which a shell completes commands, options, scenes, notations and methods.

    bash: put  eval "$(eom completion bash)"  into ~/.bashrc; zsh: the same with zsh into ~/.zshrc; fish:
    eom completion fish > ~/.config/fish/completions/eom.fish
    """
    if shell not in SHELLS:
        raise unknown_name("shell", shell, SHELLS)
    made = get_completion_class(shell)
    assert made is not None
    command = context.find_root().command
    click.echo(made(command, {}, "eom", VARIABLE).source())
