"""The header of a report: machine, Python, compiler and versions."""

from __future__ import annotations

import os
import platform
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from benchmarks import peers
from codegen import native

PACKAGES = ("eom-toolkit", "sympy", "numpy", "scipy")


def header() -> str:
    """Return what has to be known to compare the figures with others."""
    packages = ", ".join(f"{name} {_version(name)}" for name in PACKAGES)
    python = f"{platform.python_implementation()} {platform.python_version()}"
    lines = {
        "machine": f"{_processor()}, {os.cpu_count()} processors, {platform.system()}{_load()}",
        "Python": f"{python}, {packages}",
        "compiler": _compiler(),
        "peers": peers.versions(),
    }
    return "\n".join(f"{key + ':':<10}{value}" for key, value in lines.items())


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "?"


def _processor() -> str:
    file = Path("/proc/cpuinfo")
    lines = file.read_text("utf-8", "replace").splitlines() if file.is_file() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{models[0] if models else platform.processor()} ({platform.machine()})"


def _load() -> str:
    return f", load {os.getloadavg()[0]:.2f}" if hasattr(os, "getloadavg") else ""


def _compiler() -> str:
    command = native.compiler()
    if not command:
        return "none"
    done = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    first = next(iter(done.stdout.splitlines()), Path(command[0]).name)
    return f"{first}; {' '.join((*native.FLAGS, *native.NATIVE_FLAGS))}"
