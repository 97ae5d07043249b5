"""Chunks of an ensemble on disk, with a manifest: a run that broke off goes on where it stopped.

A folder holds ``ensemble.json`` (what it is of), ``manifest/`` (one record a finished chunk, with the
checksum of its numbers), and the data: one Zarr group of arrays with the trajectories as last axis, or
one Parquet file a chunk with a row a trajectory. Records are written last, and appear whole or not at
all: a chunk without a record, or whose numbers do not have its checksum, is computed anew. What says what
the store is of, and what describes its arrays, is written anew where it is damaged: records show by the
fingerprint whether chunks are of this ensemble.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from codegen.ensembles.sampler import Population
from codegen.ensembles.work_units import Columns, Piece, Plan, counted, run
from eom.errors import InputError, unknown_name

INTEGERS = ("status", "which", "steps", "rejected", "continued")
"""Columns of 32 bits; the others are doubles."""


@dataclass(frozen=True)
class Contents:
    """What a store is of: ``fingerprint`` covers all that results depend on; ``rows``: names by column."""

    fingerprint: str
    count: int
    chunk: int
    times: tuple[float, ...]
    rows: Mapping[str, tuple[str, ...]]
    format: str

    def shape(self, column: str) -> tuple[int, ...]:
        """Return the shape of a column without its last axis."""
        if column not in self.rows:
            return ()
        rows = (len(self.rows[column]),)
        return (*rows, len(self.times)) if column in {"y", "outputs"} else rows

    def size(self, number: int) -> int:
        """Return the number of trajectories of a chunk."""
        return min(self.chunk, self.count - number * self.chunk)

    @property
    def columns(self) -> list[str]:
        """Columns that hold anything."""
        every = [*self.rows, "t_stop", *INTEGERS]
        return [c for c in every if 0 not in self.shape(c)]


class Store(ABC):
    """Chunks in a folder; picklable, so that workers write and read by themselves."""

    def __init__(self, folder: Path, contents: Contents) -> None:
        self.folder, self.contents = folder, contents

    @abstractmethod
    def create(self) -> list[str]:
        """Make what must be there before the first chunk; return which files were damaged, and mended."""

    @abstractmethod
    def put(self, number: int, columns: Columns) -> None:
        """Write the columns of a chunk."""

    @abstractmethod
    def get(self, number: int) -> Columns:
        """Read what `put` wrote; anything may be raised where it is damaged."""

    def record(self, number: int) -> Path:
        """Return where the record of a chunk is."""
        return self.folder / "manifest" / f"{number:09d}.json"

    def write(self, number: int, columns: Columns) -> None:
        """Write a chunk, then its record. Raises `InputError` where that is not possible."""
        with writing(self.folder):
            kept = {c: columns[c] for c in self.contents.columns}
            self.put(number, kept)
            record = {
                "chunk": number,
                "trajectories": self.contents.size(number),
                "sha256": checksum(kept),
                "fingerprint": self.contents.fingerprint,
            }
            write_whole(self.record(number), json.dumps(record) + "\n")

    def read(self, number: int) -> Columns | None:
        """Return the columns of a finished chunk; None where it is missing or damaged."""
        try:
            record = json.loads(self.record(number).read_text(encoding="utf-8"))
            columns = dict(self.get(number))
            expected = {"fingerprint": self.contents.fingerprint, "sha256": checksum(columns)}
            if any(record[k] != v for k, v in expected.items()):
                return None
        except Exception:  # damaged data may raise anything in its reader
            return None
        size = self.contents.size(number)
        for column in self.contents.rows:
            columns.setdefault(column, np.empty((*self.contents.shape(column), size)))
        return columns


class ZarrStore(Store):
    """One Zarr array a column, its chunks those of the ensemble."""

    @cached_property
    def _group(self) -> Any:
        import zarr

        return zarr.open_group(self.folder / "data.zarr", mode="r+")

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle without the open group."""
        return (type(self), (self.folder, self.contents))

    def create(self) -> list[str]:
        """Make empty arrays, and say what their rows are; descriptions that do not fit are replaced."""
        import zarr

        c, path = self.contents, self.folder / "data.zarr"
        mended = _without(path, partial(_is_group, path))
        group = zarr.open_group(path, mode="a")
        group.attrs.update(
            {"times": list(c.times), "rows": {k: list(v) for k, v in c.rows.items()}}
        )
        for column in c.columns:
            mended += _without(path / column, self._describes(group, column))
            if not (path / column / "zarr.json").exists():
                group.create_array(column, **self._description(column))
        return mended

    def _description(self, column: str) -> dict[str, Any]:
        """Return shape, shape of a chunk and kind of number of a column's array."""
        shape, kind = self.contents.shape(column), "int32" if column in INTEGERS else "float64"
        chunks = (*shape, self.contents.chunk)
        return {"shape": (*shape, self.contents.count), "chunks": chunks, "dtype": kind}

    def _describes(self, group: Any, column: str) -> Callable[[], bool]:
        """Return what says whether the array of a column is there as it should be."""

        def fits() -> bool:
            array = group[column]
            expected = self._description(column).items()
            return all(np.all(getattr(array, name) == value) for name, value in expected)

        return fits

    def _place(self, number: int) -> tuple[Any, slice]:
        first = number * self.contents.chunk
        return ..., slice(first, first + self.contents.size(number))

    def put(self, number: int, columns: Columns) -> None:
        """Write whole chunks of the arrays: no other chunk shares a file with them."""
        for name, values in columns.items():
            self._group[name][self._place(number)] = values

    def get(self, number: int) -> Columns:
        """Read them."""
        return {c: self._group[c][self._place(number)] for c in self.contents.columns}


class ParquetStore(Store):
    """One file a chunk: a column a quantity, lists over the stored times."""

    def create(self) -> list[str]:
        """Nothing must be there."""
        return []

    def _file(self, number: int) -> Path:
        return self.folder / f"chunk-{number:09d}.parquet"

    def _names(self, column: str) -> list[str]:
        """Return what the rows of a column are called in the table."""
        suffix = {"y_stop": "_stop", "drift": "_drift"}.get(column, "")
        return [f"{n}{suffix}" for n in self.contents.rows.get(column, ())] or [column]

    def put(self, number: int, columns: Columns) -> None:
        """Write the table under another name, then rename it."""
        import pyarrow as pa
        from pyarrow import parquet

        first = number * self.contents.chunk
        arrays: dict[str, Any] = {
            "trajectory": np.arange(first, first + self.contents.size(number))
        }
        for column, values in columns.items():
            rows = values if column in self.contents.rows else values[None]
            for name, row in zip(self._names(column), rows, strict=True):
                flat = pa.array(np.ascontiguousarray(row.T).reshape(-1))
                lists = row.ndim == 2
                arrays[name] = pa.FixedSizeListArray.from_arrays(flat, len(row)) if lists else flat
        with temporary(self._file(number)) as file:
            parquet.write_table(pa.table(arrays), file)

    def get(self, number: int) -> Columns:
        """Read the table."""
        from pyarrow import parquet

        table = parquet.ParquetFile(self._file(number)).read()
        columns = {}
        for column in self.contents.columns:
            rows = []
            for name in self._names(column):
                values = table[name].combine_chunks()
                lists = len(self.contents.shape(column)) == 2
                flat = (values.flatten() if lists else values).to_numpy(zero_copy_only=False)
                rows.append(flat.reshape(len(table), -1).T if lists else flat)
            columns[column] = np.stack(rows) if column in self.contents.rows else rows[0]
        return columns


FORMATS: Mapping[str, tuple[type[Store], str]] = {
    "zarr": (ZarrStore, "zarr"),
    "parquet": (ParquetStore, "pyarrow"),
}
"""What writes each format, and the package that it needs."""


def _is_group(path: Path) -> bool:
    import zarr

    zarr.open_group(path, mode="r")
    return True


def _without(path: Path, is_whole: Callable[[], bool]) -> list[str]:
    """Remove the description of a group or array of Zarr unless it is whole; return its name then.

    The numbers stay: whether they are right their checksums show.
    """
    file = path / "zarr.json"
    if not file.exists():
        return []
    with suppress(Exception):  # damaged data may raise anything in its reader
        if is_whole():
            return []
    file.unlink()
    return [str(file)]


def opened(folder: str | Path, contents: Contents) -> tuple[Store, str]:
    """Make or open the store of an ensemble; say what was damaged in it, and mended.

    Raises `InputError` for an unknown format, a missing package, a folder that cannot be written, and
    one that holds another ensemble.
    """
    if contents.format not in FORMATS:
        raise unknown_name("format", contents.format, FORMATS)
    kind, package = FORMATS[contents.format]
    if find_spec(package) is None:
        raise InputError(
            f"format {contents.format} needs {package}", hint="pip install 'eom-toolkit[ensemble]'"
        )
    path = Path(folder).absolute()
    with writing(path):
        (path / "manifest").mkdir(parents=True, exist_ok=True)
        store = kind(path, contents)
        mended = [*_claim(store), *store.create()]
    names = ", ".join(str(Path(m).relative_to(path)) for m in mended)
    return store, f"damaged and written anew in the store: {names}" if names else ""


def _claim(store: Store) -> list[str]:
    """Write what the store is of, or compare with what is there; return its name if it was damaged."""
    file = store.folder / "ensemble.json"
    ours = json.loads(json.dumps(asdict(store.contents)))
    text = json.dumps(ours, indent=1) + "\n"
    if not file.exists():
        _refuse_other_chunks(store, "ensemble.json is missing")
        write_whole(file, text)
        return []
    theirs, fault = _read(file)
    if fault:
        _refuse_other_chunks(store, f"ensemble.json is damaged: {fault}")
        write_whole(file, text)
        return [str(file)]
    if theirs != ours:
        keys = [k for k in {**ours, **theirs} if theirs.get(k) != ours.get(k)]
        raise _another(store.folder, f"{', '.join(keys)} differ")
    return []


def _read(file: Path) -> tuple[dict[str, Any], str]:
    """Return what a store is of, as it is written there, and what is wrong with that, if anything."""
    try:
        found = json.loads(file.read_bytes().decode("utf-8"))
    except (ValueError, RecursionError):
        return {}, "no JSON" if file.stat().st_size else "empty"
    if not isinstance(found, dict):
        return {}, f"a {type(found).__name__} and no object"
    if not isinstance(found.get("fingerprint"), str):
        return {}, "no fingerprint"
    return found, ""


def _refuse_other_chunks(store: Store, fault: str) -> None:
    """Raise `InputError` where a chunk is of another ensemble, which nothing else says any more."""
    for record in sorted((store.folder / "manifest").glob("*.json")):
        try:
            found = json.loads(record.read_bytes())["fingerprint"]
        except (OSError, ValueError, TypeError, KeyError, RecursionError):
            continue  # a damaged record is that of a chunk to compute
        if found != store.contents.fingerprint:
            raise _another(store.folder, f"{fault}; {record.name} is of another ensemble")


def _another(folder: Path, got: str) -> InputError:
    return InputError(
        "the store holds another ensemble",
        where=str(folder),
        got=got,
        hint="choose another folder, or repeat the call that made this one",
    )


def work(store: Store, plan: Plan, some: Population, number: int) -> Piece:
    """Return a chunk: read if it is there, else computed and written."""
    found = store.read(number)
    first = number * plan.chunk
    if found is not None:
        tallies = counted(plan, found, first)
        return Piece(number, first, found if plan.columns else {}, tallies, computed=False)
    piece = run(replace(plan, columns=True), some, number)
    store.write(number, piece.columns)
    return piece if plan.columns else replace(piece, columns={})


def checksum(columns: Columns) -> str:
    """Return the SHA-256 of all numbers, column by column in the order of their names."""
    digest = hashlib.sha256()
    for name in sorted(columns):
        digest.update(f"{name}{columns[name].shape}".encode())
        digest.update(np.ascontiguousarray(columns[name]).tobytes())
    return digest.hexdigest()


@contextmanager
def temporary(file: Path) -> Iterator[str]:
    """Yield the name of a temporary file beside ``file``, which then takes its place."""
    handle, name = tempfile.mkstemp(prefix=".", suffix=".tmp", dir=file.parent)
    os.close(handle)
    try:
        yield name
        with Path(name).open("rb+") as written:
            os.fsync(written.fileno())
        Path(name).replace(file)
    finally:
        Path(name).unlink(missing_ok=True)


def write_whole(file: Path, text: str) -> None:
    """Write a text; it appears whole or not at all."""
    with temporary(file) as name:
        Path(name).write_text(text, encoding="utf-8")


@contextmanager
def writing(folder: Path) -> Iterator[None]:
    """Turn failures of the disk into one clear error."""
    try:
        yield
    except (OSError, ValueError) as error:  # a name that no file has is a ValueError
        raise InputError(
            "the store cannot be written",
            where=str(folder),
            got=getattr(error, "strerror", None) or str(error),
            hint="make room or choose a folder that you can write; finished chunks are kept",
        ) from None
