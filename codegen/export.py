"""Save results: NumPy archives, tables, pictures; each file appears whole or not at all."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import numpy as np

from codegen.integrate.trajectory import Array
from codegen.simulation import Result
from eom.errors import InputError


def columns(result: Result) -> dict[str, Array]:
    """Return time, states and outputs by name, each of shape (N,)."""
    states = dict(zip(result.names, result.y, strict=True))
    return {"t": result.t, **states, **result.outputs}


def save(result: Result, path: str | Path) -> Path:
    """Write time, states and outputs to ``path``: a NumPy archive (.npz) or a table (.csv).

    Raises `InputError` for other endings and where the file cannot be written.
    """
    file = Path(path)
    writers: dict[str, Callable[[Result, Path], None]] = {".npz": _npz, ".csv": _csv}
    if file.suffix not in writers:
        raise InputError(
            "unknown kind of file", where=str(file), expected="a name that ends in .npz or .csv"
        )
    return _whole(file, lambda part: writers[file.suffix](result, part))


def _npz(result: Result, file: Path) -> None:
    with file.open("wb") as stream:
        np.savez(stream, **columns(result))  # type: ignore[arg-type]


def _csv(result: Result, file: Path) -> None:
    table = columns(result)
    with file.open("w", encoding="utf-8", newline="\n") as stream:
        stream.write(",".join(table) + "\n")
        for row in zip(*(c.tolist() for c in table.values()), strict=True):
            stream.write(",".join(map(repr, row)) + "\n")


def save_plot(
    result: Result, path: str | Path, names: Iterable[str], units: Mapping[str, str], title: str
) -> Path:
    """Draw ``names`` over time, quantities of one unit together, and the invariants' drift below.

    Needs Matplotlib (extra ``plot``). Raises `InputError` where it is missing or the file cannot
    be written.
    """
    file = Path(path)
    if file.suffix not in {".png", ".pdf", ".svg"}:
        raise InputError(
            "unknown kind of picture",
            where=str(file),
            expected="a name that ends in .png, .pdf or .svg",
        )
    try:
        import matplotlib as mpl
        from matplotlib.figure import Figure
    except ImportError:
        raise InputError(
            "Matplotlib is not installed", hint="pip install 'eom-toolkit[plot]'"
        ) from None
    table = columns(result)
    panels: dict[str, list[str]] = {}
    for name in names:
        panels.setdefault(units.get(name, ""), []).append(name)
    drift = result.drift
    count = len(panels) + bool(drift)
    with mpl.rc_context({"font.size": 9}):
        figure = Figure(figsize=(8, 1.2 + 2.1 * count), layout="constrained")
        axes = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
        for axis, (unit, members) in zip(axes, panels.items(), strict=False):
            for name in members:
                axis.plot(result.t, table[name], label=name, linewidth=1)
            axis.set_ylabel(f"[{unit}]" if unit not in {"", "1"} else "")
        if drift:
            for name, change in drift.items():
                scale = abs(change.start) or 1.0
                axes[-1].plot(result.t, change.over_time / scale, label=name, linewidth=1)
            axes[-1].set_ylabel("relative drift")
            axes[-1].ticklabel_format(axis="y", style="sci", scilimits=(0, 0))
        for axis in axes:
            axis.grid(visible=True, alpha=0.3)
            axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
        axes[-1].set_xlabel("t [s]")
        figure.suptitle(title)
        return _whole(file, lambda part: figure.savefig(part, format=file.suffix[1:], dpi=150))


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
