"""What there is: `eom list`."""

from __future__ import annotations

import json

import click

from eom.commands.options import option
from eom.scenes import catalogue

WIDE = 120
"""Columns where nobody looks at a terminal: a name and its title stay on one line."""


@click.command("list")
@option("json", help="Print names and titles as JSON.")
def list_names(as_json: bool) -> None:
    """List the scenes and derivations that ship with the package."""
    from eom import derivations

    if as_json:
        scenes = [{"name": n, "title": t} for n, t in catalogue.titles().items()]
        groups = derivations.titles().items()
        derived = [{"name": n, "title": t, "group": g} for g, row in groups for n, t in row.items()]
        click.echo(json.dumps({"scenes": scenes, "derivations": derived}, indent=2))
    else:
        _print()


def _print() -> None:
    from rich.console import Console
    from rich.table import Table

    from eom import derivations

    table = Table(box=None, show_header=False, pad_edge=False)
    for group, titles in {"Scenes": catalogue.titles(), **derivations.titles()}.items():
        table.add_row(f"[bold]{group}[/bold]")
        for name, title in titles.items():
            table.add_row(f"  {name}", title)
        table.add_row()
    console = Console(soft_wrap=True)
    Console(soft_wrap=True, width=console.width if console.is_terminal else WIDE).print(table)
    click.echo("Try: eom derive bicycle-wheel, or: eom run bicycle-wheel --out wheel")
    click.echo("or:  eom derive euler-equations --notation underline --as html > euler.html")
    click.echo("or:  eom generate t-handle --closed-form --out handle")
