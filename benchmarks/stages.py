"""Times from a scene's name to loaded code, in a process and a cache folder of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from itertools import pairwise
from time import perf_counter
from typing import Any

from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen.native import native
from codegen.targets import c
from eom.scenes import catalogue

TO_TEXT = ("derive", "lower", "generate")
TO_CODE = ("compile", "load")
STAGES = (*TO_TEXT, *TO_CODE)
"""``load`` finds the compiled library in the cache."""


def measure(settings: Settings) -> Section:  # noqa: ARG001 - all measurements are called alike
    """Return one row a ready scene; no targets."""
    rows = tuple(_row(name) for name in catalogue.single())
    return Section("from nothing: to text | to code | size", rows)


def _row(name: str) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-m", "benchmarks.stages", name],
            env={**os.environ, native.CACHE_VARIABLE: folder},
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
    found = json.loads(done.stdout)
    text, code = (
        ", ".join(f"{s} {time_text(found[s])}" for s in group) for group in (TO_TEXT, TO_CODE)
    )
    return Row(name, text, code, f"{found['bytes']} bytes", f"{found['operations']} operations")


def stages(name: str) -> dict[str, Any]:
    """Return seconds by stage, bytes of generated C and operations of the right-hand side."""
    from codegen.frontend.layout import Layout
    from codegen.frontend.lower import lower_system
    from codegen.ir.passes import prune
    from codegen.ir.program import RATES
    from eom.scenes.scene import Scene

    marks = [perf_counter()]

    def done(value: Any) -> Any:
        marks.append(perf_counter())
        return value

    system = done(Scene.ready(name).derive())
    program = done(lower_system(system))
    text = done(c.single_text(program, Layout.of(system)))
    done(native.compile_library(text))
    done(native.load(native.compile_library(text), text))
    times = [b - a for a, b in pairwise(marks)]
    operations = sum(prune(program, [RATES]).counts().values())
    sizes = {"bytes": len(text), "operations": operations}
    return dict(zip(STAGES, times, strict=True)) | sizes


if __name__ == "__main__":
    print(json.dumps(stages(sys.argv[1])))
