"""Equations and derivations: `eom derive`."""

from __future__ import annotations

import click

from eom import catalogue
from eom.commands.shared import print_equations, scene_of
from eom.errors import InputError, unknown_name


@click.command()
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

    NAME is the name of a ready scene or derivation (see: eom list) or a file: .toml, .urdf.
    """
    if _is_derivation(name):
        _refuse(name, "scenes", {"--explain": explain})
        _print_derivation(name, style, notation or "arrow", steps is not False)
    else:
        _refuse(name, "derivations", {"--notation": notation, "--steps": steps})
        print_equations(scene_of(name), style, explain is not False)


def _is_derivation(name: str) -> bool:
    """Tell derivations from scenes and files. Raises `InputError` for names of neither."""
    from eom import derivations

    if catalogue.is_file(name) or name in catalogue.names():
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
