"""Every command with its words, options and tables, read off the command line: ``{command-line}``."""

from collections.abc import Iterator
from typing import ClassVar

import click
from docutils import nodes
from docutils.parsers.rst import Directive
from shown_tables import Rows, inline, table
from sphinx.application import Sphinx

from eom.__main__ import COMMANDS, main
from eom.commands.shared import WithTable


def _words(text: str) -> Iterator[nodes.Node]:
    """Yield the paragraphs of a help text."""
    for paragraph in text.replace("\b", "").split("\n\n"):
        yield nodes.paragraph("", "", *inline(" ".join(paragraph.split())))


def _options(context: click.Context) -> Rows:
    """Return what each option is called and does, as the help has it."""
    options = [p for p in context.command.params if isinstance(p, click.Option)]
    found = (p.get_help_record(context) for p in options)
    return [(f"`{name}`", meaning) for name, meaning in filter(None, found)]


def _command(name: str, command: click.Command, above: click.Context | None) -> nodes.section:
    context = click.Context(command, above, info_name=name, help_option_names=["-h", "--help"])
    title = context.command_path
    made = nodes.section("", nodes.title(title, title), ids=[nodes.make_id(title)], names=[title])
    usage = f"{title} {' '.join(command.collect_usage_pieces(context))}"
    made += nodes.literal_block(usage, usage, language="text")
    made += list(_words(command.help or ""))
    made += table(("option", "meaning"), _options(context)) if _options(context) else []
    if isinstance(command, WithTable):
        made += nodes.rubric("", command.title)
        made += table(("name", "meaning"), [(f"`{n}`", meaning) for n, meaning in command.rows()])
    return made


class CommandLine(Directive):
    """``{command-line}``."""

    option_spec: ClassVar = {}

    def run(self) -> list[nodes.Node]:
        """Return a section a command, in the order of the command line's own table."""
        above = click.Context(main, info_name="eom")
        made = [_command("eom", main, None), *(_command(c.name or "", c, above) for c in COMMANDS)]
        for section in made:
            self.state.document.note_implicit_target(section, section)
        return list(made)


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the block."""
    app.add_directive("command-line", CommandLine)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
