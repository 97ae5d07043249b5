"""Docstrings as they are written in the code, made safe for reStructuredText.

The house writes plain sentences with names in backticks; signs that mean something else to
reStructuredText, as in ``|q|`` or ``f*g``, are taken as they stand. What is called most has sections,
as numpydoc writes them, which Sphinx's napoleon reads.
"""

import re
from typing import Any

from sphinx.application import Sphinx
from sphinx.ext.napoleon import Config, NumpyDocstring
from sphinx.util.inspect import TypeAliasForwardRef

import codegen
import eom

_SPANS = re.compile(r"(``.+?``|`[^`]+`)")
_SIGNS = re.compile(r"(\*|\||(?<=\w)_(?!\w))")
_TYPE = re.compile(r"^(:type \w+: )(.+)$")
_NAMES = re.compile(
    rf"\b({'|'.join(n for n in {*eom.__all__, *codegen.__all__} if n[0].isupper())})\b"
)
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


def _in_words(found: re.Match[str]) -> str:
    """Return a type as it is told: names of the packages lead to them, other words to nothing."""
    words = _NAMES.sub(r"`\1`", found[2])
    return found[1] + (words if words != found[2] else f"*{words}*")


def in_fields(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Make fields of the sections of a docstring, in place; others are left as they are."""
    if _HEADING.search("\n".join(lines)):
        made = NumpyDocstring(lines, _SECTIONS, app, what, name, obj, options).lines()
        lines[:] = [_TYPE.sub(_in_words, line) for line in made]


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to autodoc, and let it write names of types that stand for others as names."""
    TypeAliasForwardRef.__repr__ = lambda alias: str(alias.name)
    app.connect("autodoc-process-docstring", as_written)
    app.connect("autodoc-process-docstring", in_fields)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
