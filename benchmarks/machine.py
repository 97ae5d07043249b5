"""The header of a report: machine, Python, compiler and versions."""

from __future__ import annotations

from benchmarks import peers
from codegen.measure.machine import PACKAGES, description


def header() -> str:
    """Return what has to be known to compare the figures with others."""
    found = description()
    packages = ", ".join(f"{name} {found[name]}" for name in PACKAGES)
    load = f", load {found['load']}" if found["load"] else ""
    lines = {
        "machine": f"{found['processor']}, {found['processors']} processors, {found['system']}{load}",
        "Python": f"{found['python']}, {packages}",
        "compiler": found["compiler"],
        "peers": peers.versions(),
    }
    return "\n".join(f"{key + ':':<10}{value}" for key, value in lines.items())
