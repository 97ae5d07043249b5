"""What a scene file may say, read off the models that check it: ``{scene-file} one`` or ``tree``."""

import typing
from collections.abc import Iterator
from types import NoneType
from typing import Any, ClassVar

import pydantic
from docutils import nodes
from docutils.parsers.rst import Directive
from shown_tables import Rows, inline, table
from sphinx.application import Sphinx

from eom.multibody.files.description import TreeDescription
from eom.scenes.description import MEASURED, Description, Formula, Number, Triple

MODELS = {"one": Description, "tree": TreeDescription}
SCALARS = (
    (Formula, "number or formula"),
    (Number, "number"),
    *((kind, f"{words} ({unit})") for kind, words, unit in MEASURED),
)
PLAIN = {str: "text", bool: "true or false", int: "whole number", float: "number"}
COUNTS = {2: "two", 3: "three", 4: "four"}


def _words(kind: Any) -> str:
    """Return what a value may be, in words."""
    for known, words in SCALARS:
        if kind == known:
            return words
    if kind == Triple:
        return "three numbers"
    if isinstance(kind, type) and issubclass(kind, pydantic.BaseModel):
        return "table: " + ", ".join(f"`{n}`" for n in kind.model_fields)
    return PLAIN.get(kind) or _of_generic(typing.get_origin(kind), typing.get_args(kind))


def _of_generic(origin: Any, inner: tuple[Any, ...]) -> str:
    if origin is typing.Annotated:
        return _words(inner[0])
    if origin is typing.Literal:
        return " or ".join(f"`{value}`" for value in inner)
    if origin is tuple and inner[-1] is Ellipsis:
        return f"list of {_words(inner[0])}"
    if origin is tuple:
        return f"{COUNTS[len(inner)]} of {_words(inner[0])}"
    if origin is dict:
        return f"by name: {_words(inner[1])}"
    return ", or ".join(dict.fromkeys(_words(k) for k in inner if k is not NoneType))


def _part(annotation: Any) -> tuple[type[pydantic.BaseModel] | None, bool]:
    """Return the model of a section, if it is one, and whether there is one a name."""
    origin, inner = typing.get_origin(annotation), typing.get_args(annotation)
    if isinstance(annotation, type) and issubclass(annotation, pydantic.BaseModel):
        return annotation, False
    if origin is dict:
        return _part(inner[1])[0], True
    if origin is typing.Annotated or (origin is not None and NoneType in inner):
        return _part(inner[0])
    return None, False


def sections(model: type[pydantic.BaseModel], name: str = "") -> Iterator[tuple[str, Any, Rows]]:
    """Yield sections of a file: name, model, and a row a key."""
    rows, below = [], []
    for key, field in model.model_fields.items():
        part, by_name = _part(field.annotation)
        if part is not None and (not name or not by_name):
            below.append((part, f"{name}.{key}".strip(".") + (".NAME" if by_name else "")))
            continue
        default = field.get_default(call_default_factory=True)
        usual = "" if default in (None, "", (), {}) else f"`{_toml(default)}`"
        rows.append(
            (f"`{key}`", _words(field.annotation), "required" if field.is_required() else usual)
        )
    yield name, model, rows
    for part, inner in below:
        yield from sections(part, inner)


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return (
        f'"{value}"'
        if isinstance(value, str)
        else str(list(value) if isinstance(value, tuple) else value)
    )


class SceneFile(Directive):
    """``{scene-file} one|tree``."""

    required_arguments = 1
    option_spec: ClassVar = {}

    def run(self) -> list[nodes.Node]:
        """Return a heading in words, the model's own words and a table, a section."""
        made: list[nodes.Node] = []
        for name, model, rows in sections(MODELS[self.arguments[0]]):
            title = f"[{name}]" if name else "before the first section"
            made.append(
                nodes.paragraph("", "", nodes.literal(title, title), classes=["scene-section"])
            )
            text = (model.__doc__ or "").replace("``", "`")
            made += [
                nodes.paragraph("", "", *inline(" ".join(t.split()))) for t in text.split("\n\n")
            ]
            made.append(table(("key", "value", "default"), rows))
        return made


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the block."""
    app.add_directive("scene-file", SceneFile)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
