"""Save results: NumPy archives and tables; each file appears whole or not at all."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from codegen.native.trajectory import Array
from codegen.runs.result import Result
from eom.errors import InputError


def columns(result: Result) -> dict[str, Array]:
    """Return time, states and outputs by name, each of shape (N,)."""
    states = dict(zip(result.names, result.y, strict=True))
    return {"t": result.t, **states, **result.outputs}


def check_kind(table: Path) -> None:
    """Raise `InputError` if a table has an ending that cannot be written."""
    if table.suffix not in _TABLES:
        raise InputError(
            "unknown kind of file",
            where=str(table),
            expected=f"a name that ends in {' or '.join(_TABLES)}",
        )


def save(result: Result, path: str | Path) -> Path:
    """Write time, states and outputs to ``path``: a NumPy archive (.npz) or a table (.csv).

    Raises `InputError` for other endings and where the file cannot be written.
    """
    file = Path(path)
    check_kind(file)
    return whole(file, lambda part: _TABLES[file.suffix](result, part))


def _npz(result: Result, file: Path) -> None:
    with file.open("wb") as stream:
        np.savez(stream, **columns(result))  # type: ignore[arg-type]


def _csv(result: Result, file: Path) -> None:
    table = columns(result)
    with file.open("w", encoding="utf-8", newline="\n") as stream:
        stream.write(",".join(table) + "\n")
        for row in zip(*(c.tolist() for c in table.values()), strict=True):
            stream.write(",".join(map(repr, row)) + "\n")


def save_events(result: Result, path: str | Path) -> Path:
    """Write events in the order in which they happened to a table (.csv).

    Columns: number of the event from 1 on, direction (1, -1, 0), time, states.
    Raises `InputError` where the file cannot be written.
    """
    found = [(float(t), k, int(d), *map(float, y))
             for k, e in enumerate(result.events.values(), 1)
             for t, d, y in zip(e.t, e.direction, e.y.T, strict=True)]  # fmt: skip
    forward = result.t_stop >= result.t[0] if len(result.t) else True
    found.sort(key=lambda row: (row[0] if forward else -row[0], row[1]))

    def write(part: Path) -> None:
        with part.open("w", encoding="utf-8", newline="\n") as stream:
            stream.write(",".join(("event", "direction", "t", *result.names)) + "\n")
            for t, k, direction, *y in found:
                stream.write(",".join(map(repr, (k, direction, t, *y))) + "\n")

    return whole(Path(path), write)


_TABLES: dict[str, Callable[[Result, Path], None]] = {".npz": _npz, ".csv": _csv}


def whole(file: Path, write: Callable[[Path], object]) -> Path:
    """Let ``write`` write a temporary file, and rename it to ``file``: all of it appears, or nothing.

    Its folder is made. Raises `InputError` where the file cannot be written.
    """
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".eom-", dir=file.parent) as staging:
            part = Path(staging) / file.name
            write(part)
            part.replace(file)
    except OSError as error:
        raise InputError(
            "file cannot be written",
            where=str(file),
            got=error.strerror or str(error),
            hint="choose a folder that you can write",
        ) from None
    return file
