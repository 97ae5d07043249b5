"""Run foreign code within limits: this file is started as a process of its own, isolated (``-I``).

``black_box.py python FILE FUNCTION POINTS RESULTS``: call f(t, y, p), or f(t, y), at points from a JSON
file ``[[t, y, p], ...]``; write ``{"rows": [...]}``, a list of numbers or a text for each, or ``{"error":
text}``. ``black_box.py program FILE ARGUMENTS``: become that program. Memory, time, files and processes are
limited before anything foreign is loaded; what is printed goes nowhere.
"""

from __future__ import annotations

import contextlib
import importlib.util
import inspect
import json
import os
import resource
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

LIMITS = (
    ("RLIMIT_CPU", 30),
    ("RLIMIT_AS", 4_000_000_000),
    ("RLIMIT_FSIZE", 64_000_000),
    ("RLIMIT_NOFILE", 128),
    ("RLIMIT_CORE", 0),
)
"""Seconds, bytes, bytes, files, bytes."""


def limit(seconds: int) -> None:
    """Limit this process for good."""
    for name, value in LIMITS:
        wanted = seconds if name == "RLIMIT_CPU" else value
        _, hard = resource.getrlimit(getattr(resource, name))
        low = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(getattr(resource, name), (low, low))


def function_of(file: str, name: str) -> Callable[..., Any]:
    """Load a function from a file; modules beside the file can be imported."""
    sys.dont_write_bytecode = True
    sys.path.append(str(Path(file).parent))
    spec = importlib.util.spec_from_file_location("code_under_test", file)
    if spec is None or spec.loader is None:
        raise ImportError(f"not a Python file: {file}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return getattr(module, name)  # type: ignore[no-any-return]


def rows_of(function: Callable[..., Any], points: list[Any]) -> list[Any]:
    """Return the values at every point, or the error there as a text."""
    array = _array()
    wanted = len(_positional(function))
    rows: list[Any] = []
    for t, y, p in points:
        arguments = (t, array(y), array(p))[: 2 if wanted == 2 else 3]
        try:
            rows.append([float(v) for v in function(*arguments)])
        except Exception as error:  # whatever foreign code raises
            rows.append(f"{type(error).__name__}: {error}"[:300])
    return rows


def _positional(function: Callable[..., Any]) -> list[str]:
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    parameters = inspect.signature(function).parameters.values()
    return [p.name for p in parameters if p.kind in kinds and p.default is p.empty]


def _array() -> Callable[[list[float]], Any]:
    try:
        import numpy
    except ImportError:
        return list
    return lambda values: numpy.array(values, dtype=float)


def arguments_of(function: Callable[..., Any]) -> int:
    """Return how many arguments a function must be given."""
    return len(_positional(function))


def main(arguments: list[str]) -> None:
    """Do what the arguments say."""
    kind, seconds, *rest = arguments
    limit(int(seconds))
    if kind == "program":
        os.execv(rest[0], rest)  # noqa: S606 - the program that was compiled for this
    file, name, source, target = rest
    with Path(os.devnull).open("w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    try:
        found = function_of(file, name)
        points = json.loads(Path(source).read_text(encoding="utf-8"))
        result = {"rows": rows_of(found, points), "arguments": arguments_of(found)}
    except BaseException as error:  # SystemExit too
        result = {"error": f"{type(error).__name__}: {error}"[:300]}
    Path(target).write_text(json.dumps(result), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
