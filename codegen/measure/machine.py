"""What has to be known of a machine to compare its figures with those of others."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from codegen.native import children, native

PACKAGES = ("eom-toolkit", "sympy", "numpy", "scipy")


def description(peers: Iterable[str] = ()) -> dict[str, str]:
    """Return processor, system, load, compiler with its options, and versions of packages."""
    return {
        "processor": processor(),
        "processors": str(os.cpu_count()),
        "system": platform.system(),
        "load": f"{os.getloadavg()[0]:.2f}" if hasattr(os, "getloadavg") else "",
        "compiler": compiler(),
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        **{name: version_of(name) for name in (*PACKAGES, *peers)},
    }


def version_of(package: str) -> str:
    """Return the version of a distribution, or that it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def processor() -> str:
    """Return model and architecture."""
    file = Path("/proc/cpuinfo")
    lines = file.read_text("utf-8", "replace").splitlines() if file.is_file() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{models[0] if models else platform.processor()} ({platform.machine()})"


def compiler() -> str:
    """Return the first line of what the C compiler says of itself, and its options; or none."""
    command = native.compiler()
    if not command:
        return "none"
    try:
        done = children.finished([*command, "--version"], seconds=60)
        first = next(iter(done.stdout.splitlines()), Path(command[0]).name)
    except (OSError, subprocess.TimeoutExpired):
        first = Path(command[0]).name
    return f"{first}; {' '.join((*native.FLAGS, *native.NATIVE_FLAGS))}"
