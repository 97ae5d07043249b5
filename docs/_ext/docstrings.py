"""Docstrings as they are written in the code, made safe for reStructuredText.

The house writes plain sentences with names in backticks; signs that mean something else to
reStructuredText, as in ``|q|`` or ``f*g``, are taken as they stand. What is called most has sections,
as numpydoc writes them, which Sphinx's napoleon reads.
"""

import re
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.ext.napoleon import Config, NumpyDocstring

_SPANS = re.compile(r"(``.+?``|`[^`]+`)")
_ALIAS = re.compile(r"TypeAliasForwardRef\('(\w+)'\)")
_SIGNS = re.compile(r"(\*|\||(?<=\w)_(?!\w))")


_HEADING = re.compile(r"^(Parameters|Returns)\n-+$", re.MULTILINE)
_SECTIONS = Config(napoleon_google_docstring=False, napoleon_use_rtype=True)


def _escaped(line: str) -> str:
    pieces = _SPANS.split(line)
    pieces[::2] = [_SIGNS.sub(r"\\\1", piece) for piece in pieces[::2]]
    return "".join(pieces)


def as_written(
    _app: Sphinx, _what: str, _name: str, _object: Any, _options: Any, lines: list[str]
) -> None:
    """Escape lines outside of examples, in place."""
    example = False
    for k, line in enumerate(lines):
        example = line.lstrip().startswith(">>>") or (example and bool(line.strip()))
        indented = line.startswith("    ")
        if not example and not indented:
            lines[k] = _escaped(line)


def in_fields(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Make fields of the sections of a docstring, in place; others are left as they are."""
    if _HEADING.search("\n".join(lines)):
        lines[:] = NumpyDocstring(lines, _SECTIONS, app, what, name, obj, options).lines()


def bare_aliases(_app: Sphinx, tree: nodes.document) -> None:
    """Show names of types that stand for others as names, in place."""
    for text in list(tree.findall(nodes.Text)):
        if "TypeAliasForwardRef" in text:
            text.parent.replace(text, nodes.Text(_ALIAS.sub(r"\1", text)))


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to autodoc."""
    app.connect("autodoc-process-docstring", as_written)
    app.connect("autodoc-process-docstring", in_fields)
    app.connect("doctree-read", bare_aliases)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
