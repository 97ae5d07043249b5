"""Equations and derivations: `eom derive`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from eom.commands.keeping import PROGRAM, is_kept, kept
from eom.commands.options import option, options, read_as
from eom.commands.paging import style_of, write_page
from eom.commands.shared import print_equations, scene_of, waiting_for
from eom.errors import InputError, printable, unknown_name
from eom.scenes import catalogue

if TYPE_CHECKING:
    from eom.derivations.derived import Derived
    from eom.multibody import Tree
    from eom.opening import AnyScene


@click.command()
@click.argument("name", metavar="NAME")
@option(
    "style",
    default=None,
    metavar="text|latex|markdown|html",
    help="Format; html for derivations and methods alone.  [default: text]",
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
    "--form",
    default=None,
    metavar="full|handout",
    help="Derivations: everything, or one page with the results and the reasons of the key steps.  "
    "[default: full]",
)
@click.option(
    "--figures/--no-figures",
    default=None,
    help="Derivations, as LaTeX, HTML or Markdown: sketches of frames and bodies where they are "
    "introduced.  [default: figures in LaTeX and HTML]",
)
@click.option(
    "--out",
    default=None,
    metavar="FILE",
    help="Derivations: write a file, .txt, .tex, .pdf (by LaTeX), .md or .html; its ending is the format.",
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
@option(
    "rename",
    help="With --method: another name of a coordinate or speed, e.g. q_crank=phi.  [may be repeated]",
)
@click.option(
    "--attitude",
    default=None,
    metavar="SEQUENCE",
    help="With --method: angles in place of quaternions, e.g. 3-1-2.",
)
@click.option(
    "--independent",
    multiple=True,
    metavar="SPEED",
    help="With --method, under constraints: a speed that keeps its equation.  [may be repeated; default: "
    "those that leave the simplest equations]",
)
@click.option(
    "--rates",
    is_flag=True,
    default=None,
    help="With --method: speeds are rates of coordinates, also of planar, spherical and free joints, not "
    "components of velocities.",
)
@click.option(
    "--run",
    "running",
    is_flag=True,
    default=None,
    help="A program in Python: run it, as python FILE.py does, and print its derivations.",
)
@options("lenient", "floating")
def derive(
    name: str,
    style: str | None,
    explain: bool | None,
    notation: str | None,
    steps: bool | None,
    form: str | None,
    figures: bool | None,
    out: str | None,
    lexicon: bool | None,
    method: str | None,
    absolute: bool | None,
    named: tuple[str, ...],
    attitude: str | None,
    independent: tuple[str, ...],
    rates: bool | None,
    running: bool | None,
) -> None:
    """Derive NAME and print it: the equations of motion of a scene, or a derivation step by step.

    NAME is the name of a ready scene or derivation (see: eom list) or a file: .toml, .urdf, .xml; a note
    (.md, .tex, .ipynb) whose every line eom check judges true, as a derivation; a program with derivations
    of your own (.py), by --run alone.
    """
    wishes = _wishes(named, attitude, independent, rates)
    page: Options = {"--notation": notation, "--steps": steps, "--form": form, "--out": out}
    page |= {"--figures": figures, "--lexicon": lexicon}
    if not name.lower().endswith(PROGRAM):
        _refuse(name, "programs in Python", {"--run": running})
    if (own := is_kept(name)) or _is_derivation(name):
        _refuse(name, _TREES, {**wishes, "--method": method, "--absolute": absolute})
        _refuse(name, "scenes", {"--explain": explain})
        _refuse(name, "robots from .urdf and .xml files", read_as())
        made = partial(kept, name, bool(running)) if own else partial(_shipped, name)
        _give(_page(made, _asked(name, style, page)), out)
    else:
        _refuse(name, "derivations", page)
        if method is None:
            _refuse(name, "closed forms, by --method", {"--absolute": absolute, **wishes})
            print_equations(scene_of(name), style or "text", explain is not False)
        else:
            _refuse(name, "equations without --method", {"--explain": explain})
            click.echo(_closed_form(name, method, style or "text", bool(absolute), wishes))


_TREES = "scenes of many bodies"


def _wishes(
    named: tuple[str, ...], attitude: str | None, independent: tuple[str, ...], rates: bool | None
) -> dict[str, object]:
    """Return what is wished of a closed form alone, by its option; None where it is not given."""
    more = {"--independent": independent or None, "--rates": rates}
    return {"--name": named or None, "--attitude": attitude, **more}


def tree_of(name: str, attitude: str | None, what: str) -> Tree:
    """Return the tree of a scene; ``what`` needs one. Raises `InputError` for other scenes."""
    from eom.multibody.closed import with_attitude

    scene = scene_of(name)
    tree = scene.tree
    if tree is None:
        hint = f"leave out {what}" if what.startswith("--") else 'model = "tree" makes one'
        raise InputError(f"{what} is for {_TREES}", where=name, hint=hint)
    refuse_control(scene, name, what)
    return with_attitude(tree, attitude) if attitude else tree


def refuse_control(scene: AnyScene, name: str, what: str) -> None:
    """Raise `InputError` for a scene with laws of control; ``what`` is of the open loop."""
    if scene.control.laws:
        raise InputError(
            "the closed form is that of the open loop: laws of control are no part of it",
            where=f"{name}: {what}",
            hint=f"leave out {what}, or [control]",
        )


def _angles(name: str, tree: Tree) -> dict[Any, Any]:
    from eom.multibody import absolute_angles

    angles = absolute_angles(tree)
    if not angles:
        raise InputError(
            "no angles that hang on others about parallel axes",
            where=f"{name}: --absolute",
            hint="leave out --absolute",
        )
    return angles


def _closed_form(
    name: str, method: str, style: str, absolute: bool, wishes: Mapping[str, Any]
) -> str:
    """Return the page of a tree's closed form; ``wishes``: by option."""
    from eom.multibody import tree_page

    with waiting_for("deriving"):
        tree = tree_of(name, wishes["--attitude"], "--method")
        return tree_page(
            tree, method, style, coordinates=_angles(name, tree) if absolute else None,
            names=named_pairs(name, wishes["--name"] or ()),
            independent=wishes["--independent"] or (), rates=bool(wishes["--rates"]),
        )  # fmt: skip


def named_pairs(name: str, named: Sequence[str]) -> dict[str, str]:
    """Return names in place of others. Raises `InputError` for what is no pair."""
    for pair in named:
        if pair.count("=") != 1:
            raise InputError(
                "not a new name", where=f"{name}: --name", got=pair, expected="OLD=NEW"
            )
    return {old.strip(): new.strip() for old, new in (pair.split("=") for pair in named)}


def _is_derivation(name: str) -> bool:
    """Separate derivations from scenes and files. Raises `InputError` for names of neither."""
    from eom import derivations

    if catalogue.is_file(name) or name in catalogue.names():
        return False
    if name not in derivations.names():
        raise unknown_name("scene or derivation", name, [*catalogue.names(), *derivations.names()])
    return True


def _refuse(name: str, kind: str, wishes: Mapping[str, object]) -> None:
    for given, value in wishes.items():
        if value is not None:
            raise InputError(f"{given} is for {kind}", where=name, hint=f"leave out {given}")


def _shipped(name: str) -> list[Derived]:
    from eom.derivations import derive

    return [derive(name)]


@dataclass(frozen=True)
class Asked:
    """How a derivation is to be shown (`eom.derivations.forms`); ``lexicon``: with front matter."""

    style: str
    notation: str
    steps: bool
    form: str = "full"
    lexicon: bool = False
    figures: bool = False


Options = dict[str, Any]
"""What is asked for of a page, by option; None where nothing is."""


def _asked(name: str, style: str | None, page: Options) -> Asked:
    """Return how a derivation is to be shown. Raises `InputError` for options that do not fit."""
    asked = Asked(
        _style(name, style, page["--out"]),
        page["--notation"] or "arrow",
        page["--steps"] is not False,
        page["--form"] or "full",
        bool(page["--lexicon"]),
    )
    if asked.lexicon and asked.style != "markdown":
        raise InputError("--lexicon is for Markdown", where=name, hint="give --as markdown")
    return replace(asked, figures=_with_figures(name, asked, page["--figures"]))


def _with_figures(name: str, asked: Asked, figures: bool | None) -> bool:
    """Return whether sketches are drawn. Raises `InputError` where a page has no place for them."""
    if figures and (asked.style == "text" or asked.form == "handout"):
        raise InputError(
            "no place for figures here",
            where=f"{name}: --figures",
            expected="a full page as LaTeX, HTML or Markdown",
        )
    usual = asked.style in {"latex", "html"} and asked.form == "full"
    return usual if figures is None else figures


def _style(name: str, style: str | None, out: str | None) -> str:
    """Return the format that is asked for. Raises `InputError` where a file's ending says another."""
    if out is None:
        return style or "text"
    written = style_of(out)
    if style not in {None, written}:
        raise InputError(
            "the ending of the file says another format",
            where=f"{name}: --as {style}",
            got=out,
            hint="leave out --as, or take another ending",
        )
    return written


def _page(made: Callable[[], list[Derived]], asked: Asked) -> str:
    from eom.checker.note.derived import front_matter
    from eom.derivations.forms import show_derivation
    from eom.derivations.showing import check_choices

    check_choices(asked.style, asked.notation)
    with waiting_for("deriving"):
        pages = []
        for derivation in made():
            before = front_matter(derivation, asked.notation) if asked.lexicon else ""
            figures = _drawn(derivation, asked.notation) if asked.figures else ()
            chosen = (asked.style, asked.notation, asked.steps)
            shown = show_derivation(derivation, *chosen, form=asked.form, drawn=figures)
            pages.append(before + shown)
    return "\n".join(pages)


def _drawn(derivation: Derived, notation: str) -> Sequence[Any]:
    from eom.views.body.chapters import drawn

    return drawn(derivation, notation)


def _give(page: str, out: str | None) -> None:
    """Print a page, or write it to a file."""
    if out is None:
        click.echo(page)
        return
    write_page(page, out)
    click.echo(f"wrote {printable(out)}", err=True)
