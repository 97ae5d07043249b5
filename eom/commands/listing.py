"""What there is: `eom list`."""

from __future__ import annotations

import click

from eom import catalogue


@click.command("list")
def list_names() -> None:
    """List the scenes and derivations that ship with the package."""
    from rich.console import Console
    from rich.table import Table

    from eom import derivations

    table = Table(box=None, show_header=False, pad_edge=False)
    for group, titles in {"Scenes": catalogue.titles(), **derivations.titles()}.items():
        table.add_row(f"[bold]{group}[/bold]")
        for name, title in titles.items():
            table.add_row(f"  {name}", title)
        table.add_row()
    Console(soft_wrap=True).print(table)
    click.echo("Try: eom derive bicycle-wheel, or: eom run bicycle-wheel --out wheel")
    click.echo("or:  eom derive euler-equations --notation underline --as html > euler.html")
    click.echo("or:  eom generate t-handle --closed-form --out handle")
