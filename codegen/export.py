"""Save results: NumPy archives, tables, pictures; each file appears whole or not at all."""

from __future__ import annotations

import importlib.util
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from codegen.integrate.trajectory import Array
from codegen.simulation import Result
from eom.errors import InputError


def columns(result: Result) -> dict[str, Array]:
    """Return time, states and outputs by name, each of shape (N,)."""
    states = dict(zip(result.names, result.y, strict=True))
    return {"t": result.t, **states, **result.outputs}


def check_kinds(table: Path | None, picture: Path | None) -> None:
    """Raise `InputError` if a table or a picture has an ending that cannot be written."""
    for file, endings in ((table, tuple(_TABLES)), (picture, _PICTURES)):
        if file is not None and file.suffix not in endings:
            raise InputError(
                "unknown kind of file",
                where=str(file),
                expected=f"a name that ends in {', '.join(endings[:-1])} or {endings[-1]}",
            )

    if picture is not None and not can_draw():
        raise InputError("Matplotlib is not installed", hint="pip install 'eom-toolkit[plot]'")


def can_draw() -> bool:
    """Tell whether Matplotlib (extra ``plot``) is installed."""
    return importlib.util.find_spec("matplotlib") is not None


def save(result: Result, path: str | Path) -> Path:
    """Write time, states and outputs to ``path``: a NumPy archive (.npz) or a table (.csv).

    Raises `InputError` for other endings and where the file cannot be written.
    """
    file = Path(path)
    check_kinds(file, None)
    return _whole(file, lambda part: _TABLES[file.suffix](result, part))


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

    return _whole(Path(path), write)


_TABLES: dict[str, Callable[[Result, Path], None]] = {".npz": _npz, ".csv": _csv}
_PICTURES = (".png", ".pdf", ".svg")


def save_plot(
    result: Result, path: str | Path, names: Iterable[str], units: Mapping[str, str], title: str
) -> Path:
    """Draw ``names`` over time, quantities of one unit together, and the invariants' drift below.

    Needs Matplotlib (extra ``plot``). Raises `InputError` where it is missing or the file cannot
    be written.
    """

    def draw(figure: Any) -> None:
        _draw(figure, result, names, units)
        figure.suptitle(title)

    return drawn(path, draw)


def drawn(path: str | Path, draw: Callable[[Any], None]) -> Path:
    """Write the picture that ``draw`` makes of an empty Matplotlib figure. Raises as `save_plot`."""
    file = Path(path)
    check_kinds(None, file)
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context({"font.size": 9}):
        figure = Figure(layout="constrained")
        draw(figure)
        return _whole(file, lambda part: figure.savefig(part, format=file.suffix[1:], dpi=150))


def _draw(figure: Any, result: Result, names: Iterable[str], units: Mapping[str, str]) -> None:
    """Fill a Matplotlib figure: one panel a unit, the relative drift last."""
    table = columns(result)
    panels: dict[str, dict[str, Array]] = {}
    for name in names:
        panels.setdefault(units.get(name, ""), {})[name] = table[name]
    labelled = [
        (f"[{unit}]" if unit not in {"", "1"} else "", curves) for unit, curves in panels.items()
    ]
    if result.drift:
        relative = {n: d.over_time / d.scale for n, d in result.drift.items()}
        labelled.append(("relative drift", relative))
    figure.set_size_inches(8, 1.2 + 2.1 * len(labelled))
    axes = figure.subplots(len(labelled), 1, sharex=True, squeeze=False)[:, 0]
    for axis, (label, curves) in zip(axes, labelled, strict=True):
        for name, values in curves.items():
            axis.plot(result.t, values, label=name, linewidth=1)
        axis.set_ylabel(label)
        axis.grid(visible=True, alpha=0.3)
        axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    axes[-1].set_xlabel("t [s]")


def _whole(file: Path, write: Callable[[Path], None]) -> Path:
    """Write a temporary file beside ``file`` and rename it into place."""
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
