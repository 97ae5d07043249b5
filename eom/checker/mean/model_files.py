"""The system that a lexicon names: its table, and what the note's symbols stand for in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from eom.checker.mean.model import Model, load_model
from eom.errors import InputError, unknown_name
from eom.mass.solids import CENTRE

_KEYS: dict[str, type] = {"is": str, "attitude": str, "assume": list, "point": str, "symbols": dict}

Row = tuple[str, Any, str]
"""LaTeX, meaning, and where it stands."""


def model_in(given: Any, folder: Path | None, where: str) -> Model:
    """Return the system that a text or table names. Raises `InputError` for what is neither."""
    table = _table(given, where)
    if "is" not in table:
        raise InputError("a system has no name", where=where, expected='is = "heavy-top"')
    assume = table.get("assume", [])
    if not all(isinstance(a, str) for a in assume):
        raise InputError("not a list of assumptions", where=where, got=assume)
    point = table.get("point", CENTRE)
    return load_model(table["is"], folder, table.get("attitude", ""), assume, point)


def _table(given: Any, where: str) -> Mapping[str, Any]:
    if isinstance(given, str):
        return {"is": given}
    if not isinstance(given, Mapping):
        raise InputError("not a system", where=where, got=given, expected="a name or a table")
    for key, value in given.items():
        if key not in _KEYS:
            raise unknown_name("key", str(key), _KEYS, where)
        if not isinstance(value, _KEYS[key]):
            expected = _KEYS[key].__name__
            raise InputError("wrong type", where=f"{where} > {key}", got=value, expected=expected)
    return given


def symbols_in(given: Any, model: Model, where: str) -> tuple[list[Row], list[Row]]:
    """Return the rows of the note, and those of the usual spellings. Raises `InputError`."""
    own = [
        (latex, _meaning(value, model, f"{where} > {latex}"), f"{where} > {latex}")
        for latex, value in _table(given, where).get("symbols", {}).items()
    ]
    return own, list(_usual(model, where))


def _usual(model: Model, where: str) -> Iterator[Row]:
    for latex, name in model.spellings():
        yield latex, _spelt(model, name), where


def _meaning(value: Any, model: Model, where: str) -> Any:
    """Return a formula as it is; the name of a quantity as a meaning."""
    if isinstance(value, Mapping) or (isinstance(value, str) and value.lstrip().startswith("=")):
        return value
    if not isinstance(value, str) or value not in model.quantities:
        raise unknown_name("quantity of the system", str(value), model.quantities, where)
    return _spelt(model, value)


def _spelt(model: Model, name: str) -> Mapping[str, str]:
    return {"is": f"system {name}", "unit": model.quantities[name].unit}
