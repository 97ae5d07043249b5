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
PUBLIC = {
    name: f"{package.__name__}.{name}" for package in (codegen, eom) for name in package.__all__
}
_NAMES = re.compile(rf"\b({'|'.join(n for n in PUBLIC if n[0].isupper())})\b")
_ARRAY = re.compile(
    r"~?(?:numpy\.)?ndarray\[tuple\[~?(?:typing\.)?Any, \.\.\.\],"
    r" ~?(?:numpy\.)?dtype\[~?(?:\w+\.)?(?P<kind>\w+?)\d*\]\]"
)
_DOUBLES = ("float", "Any")
_NOTED = "Annotated["
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
    words = _NAMES.sub(lambda name: f"`~{PUBLIC[name[0]]}`", found[2])
    return found[1] + (words if words != found[2] else f"*{words}*")


def in_fields(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Make fields of the sections of a docstring, in place; others are left as they are."""
    if _HEADING.search("\n".join(lines)):
        made = NumpyDocstring(lines, _SECTIONS, app, what, name, obj, options).lines()
        lines[:] = [_TYPE.sub(_in_words, line) for line in made]


def plain(annotation: str) -> str:
    """Return an annotation without what only programs read of it: notes of fields, layouts of arrays."""
    while _NOTED in annotation:
        start = annotation.index(_NOTED)
        first = start + len(_NOTED)
        kind = annotation[first : _end(annotation, first, ",")]
        annotation = annotation[:start] + kind + annotation[_end(annotation, first, "]") + 1 :]
    return _ARRAY.sub(
        lambda m: "Array" if m["kind"] in _DOUBLES else f"Array of {m['kind']}", annotation
    )


def _end(text: str, start: int, mark: str) -> int:
    """Return where a mark stands behind a place and outside of brackets; the end if nowhere."""
    depth = 0
    for k, sign in enumerate(text[start:], start):
        if sign == mark and depth == 0:
            return k
        depth += (sign in "[(") - (sign in "])")
    return len(text)


def in_plain_types(app: Sphinx, *_: Any) -> None:
    """Make types of arguments plain, in place, where autodoc keeps them until they are shown."""
    for kinds in app.env.current_document.autodoc_annotations.values():
        kinds.update({name: plain(str(kind)) for name, kind in kinds.items()})


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to autodoc, and let it write names of types that stand for others as names."""
    TypeAliasForwardRef.__repr__ = lambda alias: str(alias.name)
    app.connect("autodoc-process-docstring", as_written)
    app.connect("autodoc-process-docstring", in_fields)
    app.connect("autodoc-process-signature", in_plain_types, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
