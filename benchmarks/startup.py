"""Start-up of the command line: ``eom list`` in a new process."""

from __future__ import annotations

import importlib.util
import subprocess
import sys

from benchmarks.pairs import seconds
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text

LONGEST_SECONDS = 1.0
RUNS = 5


def measure(settings: Settings) -> Section:  # noqa: ARG001 - all measurements are called alike
    """Return the least time of a few runs, beside that of Python alone."""
    title = "start-up: eom list | python -c pass"
    if importlib.util.find_spec("eom.__main__") is None:
        return Section(title, (Row("eom list", "there is no eom/__main__.py"),))
    ours, bare = (
        min(seconds(lambda: _run(arguments)) for _ in range(RUNS))  # noqa: B023 - called at once
        for arguments in (("-m", "eom", "list"), ("-c", "pass"))
    )
    times = time_text(ours), time_text(bare), f"{ours / bare:.1f}"
    target = f"<= {time_text(LONGEST_SECONDS)}"
    return Section(title, (Row("eom list", *times, target, ours <= LONGEST_SECONDS),))


def _run(arguments: tuple[str, ...]) -> None:
    subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True)
