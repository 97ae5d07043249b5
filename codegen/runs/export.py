"""Results as files and tables: NumPy archives, CSV, pandas, xarray; each file appears whole or not at all.

An archive has time, states and outputs by name, states that kept their initial values among them; the
rest stands in arrays whose names begin with `PREFIX`, and in one text in JSON among them. Nothing in it
is pickled, and nothing is unpickled.
"""

from __future__ import annotations

import importlib
import json
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from codegen.native.trajectory import Array
from eom.errors import InputError

PREFIX = "eom."
FORMAT = 1
WORDS = ("message", "method", "notice", "why")
COUNTS = ("nfev", "status", "steps", "rejected")
NUMBERS = ("t_stop", "seconds")
MAPS = ("margin", "units", "held")
"""Fields of a result by what stands for them in JSON."""


class Run(Protocol):
    """What is written of a `codegen.Result`."""

    @property
    def t(self) -> Array:
        """Stored times (s)."""
        ...

    @property
    def y(self) -> Array:
        """States."""
        ...

    @property
    def y_stop(self) -> Array:
        """States where it stopped."""
        ...

    @property
    def t_stop(self) -> float:
        """When it stopped (s)."""
        ...

    @property
    def names(self) -> tuple[str, ...]:
        """Of the states."""
        ...

    @property
    def left_out(self) -> tuple[str, ...]:
        """What was not integrated."""
        ...

    @property
    def held(self) -> Mapping[str, float]:
        """States that kept their initial values, by name."""
        ...

    @property
    def outputs(self) -> Mapping[str, Array]:
        """Outputs by name."""
        ...

    @property
    def units(self) -> Mapping[str, str]:
        """Units by name."""
        ...

    @property
    def drift(self) -> Mapping[str, Any]:
        """Of constants of the motion."""
        ...

    @property
    def events(self) -> Mapping[str, Any]:
        """What was found."""
        ...


def columns(result: Run) -> dict[str, Array]:
    """Return time, states, those that kept their first values too, and outputs, by name, each (N,)."""
    states = dict(zip(result.names, result.y, strict=True))
    held = {n: np.full(len(result.t), v) for n, v in result.held.items()}
    return {"t": result.t, **states, **held, **result.outputs}


def check_kind(table: Path) -> None:
    """Raise `InputError` if a table has an ending that cannot be written."""
    if table.suffix not in _TABLES:
        raise InputError(
            "unknown kind of file",
            where=str(table),
            expected=f"a name that ends in {' or '.join(_TABLES)}",
        )


def save(result: Run, path: str | Path) -> Path:
    """Write the columns of a result to ``path``: a NumPy archive (.npz) or a table (.csv).

    Raises `InputError` for other endings and where the file cannot be written.
    """
    file = Path(path)
    check_kind(file)
    return whole(file, lambda part: _TABLES[file.suffix](result, part))


def _npz(result: Run, file: Path) -> None:
    arrays = columns(result)
    taken = [n for n in arrays if n.startswith(PREFIX)]
    if taken:
        raise InputError("a name cannot be kept in a file", got=taken[0],
                         expected=f"names that do not begin with {PREFIX}")  # fmt: skip
    with file.open("wb") as stream:
        np.savez(stream, **arrays, **_about(result))  # type: ignore[arg-type]


def _about(result: Run) -> dict[str, Any]:
    """Return what stands beside time, states and outputs: arrays, and the rest as a text in JSON."""
    drift, events = list(result.drift.items()), list(result.events.items())
    said = {
        "format": FORMAT,
        "names": list(result.names),
        "outputs": list(result.outputs),
        "left_out": list(result.left_out),
        "drift": [[n, d.start, d.largest, d.size] for n, d in drift],
        "events": [n for n, _ in events],
        **{k: getattr(result, k) for k in (*WORDS, *COUNTS, *NUMBERS)},
        **{k: dict(getattr(result, k)) for k in MAPS},
    }
    found = {"about": np.array(json.dumps(said)), "y_stop": result.y_stop}
    found |= {f"drift.{k}": d.over_time for k, (_, d) in enumerate(drift)}
    for k, (_, e) in enumerate(events):
        found |= {f"event.{k}.{part}": getattr(e, part) for part in ("t", "y", "direction")}
    return {PREFIX + name: value for name, value in found.items()}


def read(path: str | Path) -> dict[str, Any]:
    """Return what an archive of a result holds, by the fields of `codegen.Result`.

    Raises `InputError` for a file that cannot be read, or is no such archive.
    """
    where = str(path)
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        return _fields(arrays, json.loads(str(arrays[PREFIX + "about"])))
    except OSError as error:
        raise InputError("the file cannot be read", where=where,
                         got=error.strerror or str(error)) from None  # fmt: skip
    except (KeyError, ValueError, TypeError, AttributeError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(
            "the file is no result", where=where, got=f"{type(error).__name__}: {error}"[:200],
            expected="an archive that Result.save has written",
        ) from None  # fmt: skip


def _fields(arrays: Mapping[str, Any], said: Mapping[str, Any]) -> dict[str, Any]:
    if said["format"] != FORMAT:
        raise ValueError(f"format {said['format']}, not {FORMAT}")
    t = _numbers(arrays["t"])
    rows = {n: _numbers(arrays[n], t.shape) for n in (*said["names"], *said["outputs"])}
    y = np.array([rows[n] for n in said["names"]]).reshape(-1, len(t))
    own = {name.removeprefix(PREFIX): v for name, v in arrays.items() if name.startswith(PREFIX)}
    drift = {
        str(n): {"start": float(a), "largest": float(b), "size": float(c),
                 "over_time": _numbers(own[f"drift.{k}"], t.shape)}
        for k, (n, a, b, c) in enumerate(said["drift"])
    }  # fmt: skip
    events = {
        str(n): {part: _numbers(own[f"event.{k}.{part}"]) for part in ("t", "y", "direction")}
        for k, n in enumerate(said["events"])
    }
    return {
        "t": t, "y": y, "outputs": {n: rows[n] for n in said["outputs"]}, "drift": drift, "events": events,
        "y_stop": _numbers(own["y_stop"], (len(y),)), "names": tuple(map(str, said["names"])),
        "left_out": tuple(map(str, said["left_out"])),
        **{k: str(said[k]) for k in WORDS}, **{k: int(said[k]) for k in COUNTS},
        **{k: float(said[k]) for k in NUMBERS},
        "margin": {str(n): float(v) for n, v in said["margin"].items()},
        "held": {str(n): float(v) for n, v in said["held"].items()},
        "units": {str(n): str(v) for n, v in said["units"].items()},
    }  # fmt: skip


def _numbers(array: Any, shape: tuple[int, ...] | None = None) -> Any:
    """Return an array of a file. Raises `ValueError` for one without numbers, or of another shape."""
    if array.dtype.kind not in "fi" or (shape is not None and array.shape != shape):
        raise ValueError(f"an array of {array.dtype} of shape {array.shape}")
    return array


def frame(result: Run) -> Any:
    """Return a data frame of pandas. Raises `InputError` where that is not installed."""
    pandas = _installed("pandas")
    time = pandas.Index(result.t, name="t")
    found = pandas.DataFrame({n: v for n, v in columns(result).items() if n != "t"}, index=time)
    found.attrs["units"] = dict(result.units)
    return found


def dataset(result: Run) -> Any:
    """Return a data set of xarray. Raises `InputError` where that is not installed."""
    xarray = _installed("xarray")
    units = result.units
    rows = {
        n: ("t", v, {"units": units.get(n, "")}) for n, v in columns(result).items() if n != "t"
    }
    time = {"t": ("t", result.t, {"units": units.get("t", "s")})}
    return xarray.Dataset(rows, coords=time)


def _installed(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(f"{module} is not installed",
                         hint="pip install 'eom-toolkit[tables]'") from None  # fmt: skip


def _csv(result: Run, file: Path) -> None:
    table = columns(result)
    with file.open("w", encoding="utf-8", newline="\n") as stream:
        stream.write(",".join(table) + "\n")
        for row in zip(*(c.tolist() for c in table.values()), strict=True):
            stream.write(",".join(map(repr, row)) + "\n")


def save_events(result: Run, path: str | Path) -> Path:
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


_TABLES: dict[str, Callable[[Run, Path], None]] = {".npz": _npz, ".csv": _csv}


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
