"""``python -m benchmarks.waits``: how long the first result takes where nothing is in the cache.

``eom run SCENE`` as a whole, from the start of Python; and from a derived system to the end of its
first run: `simulate`, which lowers, writes, compiles and loads, beside heyoka's integrator, which LLVM
compiles, of the rates with their numbers. Each is a process and a cache folder of its own.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from time import perf_counter

from benchmarks.pairs import seconds
from benchmarks.peers import absent, measured_apart, missing
from benchmarks.runs import problems
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, alone, time_text
from codegen.native import native

SCENE = "bicycle-wheel"
TIMES = 3


def measure(settings: Settings) -> Section:  # noqa: ARG001 - all measurements are called alike
    """Return the least of a few waits for each; no targets."""
    rows = [_whole(SCENE)]
    without = missing("heyoka")
    for k, problem in enumerate(problems()):
        ours, theirs = (
            min(measured_apart("benchmarks.waits", who, str(k)) for _ in range(TIMES))
            for who in ("ours", "heyoka" if not without else "ours")
        )
        beside = ("", "") if without else (time_text(theirs), f"{ours / theirs:.2f}")
        rows.append(Row(f"{problem.name}: first run of a derived system", time_text(ours), *beside))
    if without:
        rows.append(absent("first runs", without))
    return Section("first result, nothing in the cache: ours | heyoka", tuple(rows))


def _whole(scene: str) -> Row:
    """Return the wait for a whole job, with the bytecode of modules that an installation leaves."""
    with tempfile.TemporaryDirectory() as bytecode:
        _run(scene, bytecode)
        waits = [seconds(lambda: _run(scene, bytecode)) for _ in range(TIMES)]
    return Row(f"eom run {scene}, as a whole", time_text(min(waits)))


def _run(scene: str, bytecode: str) -> None:
    kept = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(
            [sys.executable, "-m", "eom", "run", scene, "--out", f"{folder}/out"],
            env={
                **kept, native.CACHE_VARIABLE: f"{folder}/cache", "PYTHONPYCACHEPREFIX": bytecode,
            },
            stdout=subprocess.DEVNULL,
            check=True,
        )  # fmt: skip


def first(who: str, k: int) -> float:
    """Return seconds from a derived system to its first result, ours or heyoka's."""
    problem = problems()[k]
    if who == "ours":
        from codegen import simulate

        simulate.__doc__  # noqa: B018 - the import is not counted, as that of heyoka is not
        system = problem.system
        began = perf_counter()
        run = simulate(
            system, problem.start, (0.0, problem.end), problem.parameters, "taylor",
            inputs=problem.inputs,
        )  # fmt: skip
        assert run.success
        return perf_counter() - began
    import heyoka

    from benchmarks.taylor import case_of
    from codegen.measure.workprecision.programs import heyoka_builder

    case = case_of(problem)
    began = perf_counter()
    heyoka_builder(case)(1e-9).propagate_until(problem.end)
    assert heyoka.__version__
    return perf_counter() - began


if __name__ == "__main__":
    if len(sys.argv) > 2:
        print(json.dumps(first(sys.argv[1], int(sys.argv[2]))))
    else:
        alone(measure)
