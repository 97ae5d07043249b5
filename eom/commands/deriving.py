"""Equations and derivations: `eom derive`."""

from __future__ import annotations

from collections.abc import Mapping

import click

from eom.commands.shared import print_equations, read_as, reading_options, scene_of, waiting_for
from eom.errors import InputError, unknown_name
from eom.scenes import catalogue


@click.command()
@click.argument("name", metavar="NAME")
@click.option(
    "--as",
    "style",
    default="text",
    show_default=True,
    metavar="text|latex|markdown|html",
    help="Format; html for derivations and methods alone.",
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
@click.option(
    "--method",
    default=None,
    metavar="lagrange|kane|newton-euler|all",
    help="Scenes of many bodies, if small: the closed form step by step, term by term; all: the three "
    "methods side by side.",
)
@click.option(
    "--absolute",
    is_flag=True,
    default=None,
    help="With --method: angles about parallel axes are measured against the ground.",
)
@reading_options
def derive(
    name: str,
    style: str,
    explain: bool | None,
    notation: str | None,
    steps: bool | None,
    lexicon: bool | None,
    method: str | None,
    absolute: bool | None,
) -> None:
    """Derive NAME and print it: the equations of motion of a scene, or a derivation step by step.

    NAME is the name of a ready scene or derivation (see: eom list) or a file: .toml, .urdf, .xml.
    """
    if _is_derivation(name):
        _refuse(name, "scenes", {"--explain": explain})
        _refuse(name, "robots from .urdf and .xml files", read_as())
        _refuse(name, _TREES, {"--method": method, "--absolute": absolute})
        if lexicon and style != "markdown":
            raise InputError("--lexicon is for Markdown", where=name, hint="give --as markdown")
        _print_derivation(name, style, notation or "arrow", steps is not False, bool(lexicon))
    else:
        _refuse(
            name, "derivations", {"--notation": notation, "--steps": steps, "--lexicon": lexicon}
        )
        if method is None:
            _refuse(name, "closed forms, by --method", {"--absolute": absolute})
            print_equations(scene_of(name), style, explain is not False)
        else:
            _refuse(name, "equations without --method", {"--explain": explain})
            with waiting_for("deriving"):
                shown = _closed_form(name, method, style, bool(absolute))
            click.echo(shown)


_TREES = "scenes of many bodies"


def _closed_form(name: str, method: str, style: str, absolute: bool) -> str:
    """Return the page of a tree's closed form. Raises `InputError` for other scenes."""
    from eom.multibody import absolute_angles, tree_page

    scene = scene_of(name)
    tree = scene.tree
    if tree is None:
        raise InputError(f"--method is for {_TREES}", where=name, hint="leave out --method")
    if scene.control.laws:
        raise InputError(
            "the closed form is that of the open loop: laws of control are no part of it",
            where=f"{name}: --method",
            hint="leave out --method, or [control]",
        )
    angles = absolute_angles(tree) if absolute else {}
    if absolute and not angles:
        raise InputError(
            "no angles that hang on others about parallel axes",
            where=f"{name}: --absolute",
            hint="leave out --absolute",
        )
    return tree_page(tree, method, style, coordinates=angles or None)


def _is_derivation(name: str) -> bool:
    """Separate derivations from scenes and files. Raises `InputError` for names of neither."""
    from eom import derivations

    if catalogue.is_file(name) or name in catalogue.names():
        return False
    if name not in derivations.names():
        raise unknown_name("scene or derivation", name, [*catalogue.names(), *derivations.names()])
    return True


def _refuse(name: str, kind: str, options: Mapping[str, object]) -> None:
    for option, value in options.items():
        if value is not None:
            raise InputError(f"{option} is for {kind}", where=name, hint=f"leave out {option}")


def _print_derivation(name: str, style: str, notation: str, steps: bool, lexicon: bool) -> None:
    from eom.checker.note.derived import front_matter
    from eom.derivations import derive
    from eom.derivations.derived import check_choices, show_derivation

    check_choices(style, notation)
    with waiting_for("deriving"):
        derivation = derive(name)
        before = front_matter(derivation, notation) if lexicon else ""
        shown = before + show_derivation(derivation, style, notation, steps)
    click.echo(shown)
