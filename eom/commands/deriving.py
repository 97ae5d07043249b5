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
@click.option(
    "--lexicon/--no-lexicon",
    default=None,
    help="Derivations as Markdown: front matter that says what symbols mean, so that eom check can "
    "judge the page, also after changes.  [default: no-lexicon]",
)
def derive(
    name: str,
    style: str,
    explain: bool | None,
    notation: str | None,
    steps: bool | None,
    lexicon: bool | None,
) -> None:
    """Derive NAME and print it: the equations of motion of a scene, or a derivation step by step.

    NAME is the name of a ready scene or derivation (see: eom list) or a file: .toml, .urdf.
    """
    if _is_derivation(name):
        _refuse(name, "scenes", {"--explain": explain})
        if lexicon and style != "markdown":
            raise InputError("--lexicon is for Markdown", where=name, hint="give --as markdown")
        _print_derivation(name, style, notation or "arrow", steps is not False, bool(lexicon))
    else:
        _refuse(
            name, "derivations", {"--notation": notation, "--steps": steps, "--lexicon": lexicon}
        )
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


def _print_derivation(name: str, style: str, notation: str, steps: bool, lexicon: bool) -> None:
    from eom.checker.derived import front_matter
    from eom.derivations import derive
    from eom.showing import check_choices, show_derivation

    check_choices(style, notation)
    derivation = derive(name)
    before = front_matter(derivation, notation) if lexicon else ""
    click.echo(before + show_derivation(derivation, style, notation, steps))
