"""Scene files of every model: TOML within limits, and findings of pydantic as one readable error."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, get_args

import pydantic

from eom.errors import InputError, entries, near_matches, quoted

MAX_FILE_BYTES = 1_000_000


def data_of(file: Path) -> dict[str, Any]:
    """Return what a TOML file says; its ``name`` is the file's unless it has one.

    Raises `InputError` with the file's name for a file that cannot be read.
    """
    text = text_of(file, "*.toml")
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # a huge integer, deep nesting
        raise InputError("not a valid TOML file", where=str(file), got=str(error)) from None
    data.setdefault("name", file.stem)
    return data


def text_of(file: Path, pattern: str) -> str:
    """Return the text of a file; ``pattern``: files whose names are near matches."""
    if not file.is_file():
        known = [p.name for p in file.parent.glob(pattern)] if file.parent.is_dir() else []
        raise InputError("no such scene file", where=str(file), hint=near_matches(file.name, known))
    if file.stat().st_size > MAX_FILE_BYTES:
        raise InputError(
            "scene file is too large", where=str(file), expected=f"at most {MAX_FILE_BYTES} bytes"
        )
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("scene file cannot be read", where=str(file), got=str(error)) from None


@contextmanager
def in_file(file: Path) -> Iterator[None]:
    """Put the file's name before the place of errors."""
    try:
        yield
    except InputError as error:
        where = f"{file}: {error.where}" if error.where else str(file)
        raise type(error)(
            error.what, where=where, got=error.got, expected=error.expected, hint=error.hint
        ) from None


def limited(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parts of a scene, lists as lists. Raises `InputError` for what may have no end."""
    kinds = (str, bytes, type, Mapping, pydantic.BaseModel)
    return {
        k: entries(v, k) if isinstance(v, Iterable) and not isinstance(v, kinds) else v
        for k, v in data.items()
    }


def readable(error: pydantic.ValidationError, model: type[pydantic.BaseModel]) -> InputError:
    """Turn the first finding about ``model`` into one error; count the others."""
    findings = error.errors(include_url=False)
    ours = [f["ctx"]["error"] for f in findings if "error" in f.get("ctx", {})]
    if ours and isinstance(ours[0], InputError):
        return ours[0]
    first, *others = sorted(findings, key=lambda f: f["type"] != "extra_forbidden")
    place = ".".join(str(part) for part in first["loc"])
    more = f" (and {len(others)} more)" if others else ""
    if first["type"] == "extra_forbidden":
        key = str(first["loc"][-1])
        return InputError(
            f"unknown key {key!r}{more}",
            where=place,
            hint=near_matches(key, _keys_at(model, first["loc"][:-1])),
        )
    if first["type"] == "missing":
        last = first["loc"][-1]
        what = f"missing key {last!r}" if isinstance(last, str) else "too few values"
        return InputError(f"{what}{more}", where=place)
    expected = re.sub("^(Input should be|Value error, expected) ", "", first["msg"])
    return InputError(
        f"unusable value{more}", where=place, got=quoted(first["input"]), expected=expected
    )


def _keys_at(model: type[pydantic.BaseModel], place: tuple[int | str, ...]) -> list[str]:
    """Field names of the part at ``place``; keys of tables by name are passed over."""
    for step in place:
        field = model.model_fields.get(str(step))
        if field is not None:
            model = next(_models(field.annotation), model)
    return list(model.model_fields)


def _models(annotation: Any) -> Iterator[type[pydantic.BaseModel]]:
    """Yield the parts that an annotation speaks of."""
    if isinstance(annotation, type) and issubclass(annotation, pydantic.BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from _models(inner)
