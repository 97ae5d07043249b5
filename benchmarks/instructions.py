"""Instructions a call, counted by valgrind where it is installed."""

from __future__ import annotations

import platform
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from benchmarks.native_rates import HERE, Rates
from codegen.native import native

FEW, MANY = 1_000, 3_000
TIMEOUT_SECONDS = 120
KNOWN = {"x86_64": ("-mno-avx512f",), "AMD64": ("-mno-avx512f",)}
"""Flags that keep to the instructions that valgrind knows, by machine."""


def available() -> bool:
    """Return whether instructions can be counted here."""
    return shutil.which("valgrind") is not None


def text(rates: Rates) -> str:
    """Return the count of `per_call` for the table."""
    count = per_call(rates)
    return "? instructions" if count is None else f"{count} instructions"


def per_call(rates: Rates) -> int | None:
    """Return the instructions of one call and its loop; None where they cannot be counted."""
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        return None
    flags = (*rates.flags, *KNOWN.get(platform.machine(), ()))
    library = native.compile_library(rates.text, flags)
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "counter"
        command = [*native.require_compiler(), "-O2", "-o", str(program), str(HERE / "counter.c")]
        if subprocess.run([*command, "-ldl"], capture_output=True, check=False).returncode:
            return None
        run = [valgrind, "--tool=callgrind", "--callgrind-out-file=/dev/null", str(program)]
        few, many = (
            _total([*run, str(library), rates.symbol, rates.prepare, str(k)]) for k in (FEW, MANY)
        )
    return None if few is None or many is None else round((many - few) / (MANY - FEW))


def _total(command: list[str]) -> int | None:
    """Return the instructions of a whole run; None where valgrind gives up."""
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        errors="replace",
        timeout=TIMEOUT_SECONDS,
        check=False,
    )
    found = re.search(r"Collected\s*:\s*(\d+)", done.stderr)
    return int(found[1]) if found and done.returncode == 0 else None
