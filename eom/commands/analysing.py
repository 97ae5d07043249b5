"""eom analyse: cyclic coordinates, steady motions, stability and conserved quantities, as formulas."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from eom.commands.deriving import named_pairs, refuse_control, tree_of
from eom.commands.shared import scene_argument, scene_of, waiting_for
from eom.errors import InputError

if TYPE_CHECKING:
    from eom.multibody.model.model import Tree


@click.command("analyse")
@scene_argument
@click.option(
    "--at",
    "held",
    multiple=True,
    metavar="NAME=VALUE",
    help="A value of a coordinate or speed in the steady motion: a number or a formula over parameters. "
    "[may be repeated; default: free]",
)
@click.option(
    "--solve",
    multiple=True,
    metavar="NAME",
    help="Solve a condition of the steady motion for this.  [may be repeated]",
)
@click.option(
    "--small",
    default=3,
    show_default=True,
    help="Order of the equations for small changes; 0: none.",
)
@click.option(
    "--rates", default=2, show_default=True, help="Of conserved quantities: degree in the rates."
)
@click.option(
    "--harmonics",
    default=2,
    show_default=True,
    help="Of conserved quantities: degree in sines and cosines.",
)
@click.option(
    "--name",
    "named",
    multiple=True,
    metavar="OLD=NEW",
    help="Another name of a coordinate or speed, e.g. q_crank=phi.  [may be repeated]",
)
@click.option(
    "--attitude",
    default=None,
    metavar="SEQUENCE",
    help="Angles in place of quaternions, e.g. 3-1-2.",
)
@click.option(
    "--as",
    "style",
    default="text",
    show_default=True,
    metavar="text|latex|markdown|html",
    help="Format.",
)
def analyse(
    scene: str,
    held: Sequence[str],
    solve: Sequence[str],
    small: int,
    rates: int,
    harmonics: int,
    named: Sequence[str],
    attitude: str | None,
    style: str,
) -> None:
    """Analyse SCENE in symbols: what is cyclic, steady, stable, conserved.

    For small scenes of one body or many. Attitudes are by angles; their rates are the speeds. Numbers of
    one steady motion: eom linearise.
    """
    from eom.multibody.analysis import analysis_page
    from eom.multibody.model.names import symbols_of
    from eom.scenes.parse import parse

    tree = _tree(scene, attitude)
    stated = scene_of(scene).as_stated().parameter_values()
    positive = [str(name) for name, x in stated.items() if x > 0]
    known = {s.name: s for s in symbols_of(tree)}
    values = {}
    for pair in held:
        name, equals, text = pair.partition("=")
        if not equals:
            raise InputError("not a value", where=f"{scene}: --at", got=pair, expected="NAME=VALUE")
        values[name.strip()] = parse(text, known, f"{scene}: --at {name}")
    with waiting_for("analysing"):
        page = analysis_page(
            tree, style, names=named_pairs(scene, named), values=values, solve=list(solve),
            order=small, rates=rates, harmonics=harmonics, positive=positive,
        )  # fmt: skip
    click.echo(page)


def _tree(name: str, attitude: str | None) -> Tree:
    """Return the tree of a scene of one body or many."""
    from eom.multibody.files.single import single_tree
    from eom.scenes.scene import Scene

    scene = scene_of(name)
    if not isinstance(scene, Scene):
        return tree_of(name, attitude, "eom analyse")
    refuse_control(scene, name, "eom analyse")
    return single_tree(scene, attitude or "")
