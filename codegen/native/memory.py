"""How much memory a process can still have, as far as the system says."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

PROCESS, GROUPS = Path("/proc"), Path("/sys/fs/cgroup")
LIMITS = {
    "": ("memory.max", "memory.current", "inactive_file"),
    "memory": ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
}
"""Of groups of processes, by the name of their controller in versions 2 and 1 of Linux: files of the limit
and of the use, and what of the use can be given up, in memory.stat."""


def available() -> float:
    """Return the bytes that this process can still have, swap among them; infinity where nothing says."""
    return max(0.0, min((*_machine(), *_groups(), *_own()), default=math.inf))


def _machine() -> Iterator[float]:
    """Yield what is free in the machine, or else all that it has."""
    try:
        rows = _rows(PROCESS / "meminfo")
        yield 1024 * (rows["MemAvailable:"] + rows.get("SwapFree:", 0))
    except (OSError, ValueError, KeyError):
        with suppress(AttributeError, ValueError, OSError):  # of a system without such a number
            yield os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def _rows(file: Path) -> dict[str, int]:
    """Return a table of names and numbers."""
    words = (line.split() for line in file.read_text(encoding="ascii").splitlines())
    return {row[0]: int(row[1]) for row in words if len(row) > 1}


def _groups() -> Iterator[float]:
    """Yield what is left of the limits of the groups that the process is in."""
    with suppress(OSError):
        for line in (PROCESS / "self" / "cgroup").read_text(encoding="utf-8").splitlines():
            _, controllers, place = line.split(":", 2)
            for name in {*controllers.split(",")} & LIMITS.keys():
                for folder in (GROUPS / name / place.strip("/"), GROUPS / name):
                    limit, use, freed = LIMITS[name]
                    with suppress(OSError, ValueError, KeyError):  # no such file, or no limit
                        most = int((folder / limit).read_text())
                        used = int((folder / use).read_text())
                        yield most - used + _rows(folder / "memory.stat")[freed]


def _own() -> Iterator[float]:
    """Yield what is left of the limit of the process itself."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        most, _ = resource.getrlimit(resource.RLIMIT_AS)
        if most != resource.RLIM_INFINITY:
            pages = int((PROCESS / "self" / "statm").read_text().split()[0])
            yield most - pages * resource.getpagesize()
