"""Other programs that are measured beside this one: which of them are installed."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from benchmarks.table import Row
from codegen.native import native

MODULES = {
    "pydy": "pydy",
    "Cython": "Cython",
    "casadi": "casadi",
    "pin": "pinocchio",
    "heyoka": "heyoka",
}
"""Distributions of the extra ``bench``, and the module that each of them brings."""


def missing(*distributions: str) -> tuple[str, ...]:
    """Return those of ``distributions`` whose modules are not installed."""
    return tuple(d for d in distributions if importlib.util.find_spec(MODULES[d]) is None)


def absent(what: str, names: Sequence[str]) -> Row:
    """Return the line of the table that says what was not measured, and why."""
    return Row(what, "not measured", f"{', '.join(names)} missing: install the extra bench")


def versions() -> str:
    """Return the versions of the peers that are installed, for the header."""
    found = []
    for name in MODULES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            found.append(f"no {name}")
    return ", ".join(found)


def measured_apart(module: str, *arguments: str) -> Any:
    """Run ``python -m module`` in a process and a cache folder of its own; return what it prints.

    The last line of its output is JSON; other programs may print before it.
    """
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-m", module, *arguments],
            env={**os.environ, native.CACHE_VARIABLE: folder},
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
    return json.loads(done.stdout.splitlines()[-1])
