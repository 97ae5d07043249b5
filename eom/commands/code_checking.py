"""`eom check --code`: a function for the rates of a system, in Python or C, run apart and compared.

Python: ``f(t, y, p)`` returns the rates, or ``f(t, y)`` with the scene's numbers built in. C:
``void f(double t, const double *y, const double *p, double *dy)``. ``y``: the states, ``p``: parameters
followed by inputs, both in the order of the system. The code runs in a process of its own with limits of
time and memory, in a private folder that is removed; C is compiled there. That is no sandbox: foreign code
can read what its user can read.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eom.errors import InputError

if TYPE_CHECKING:
    from eom.checker.code import CodeReport, Point
    from eom.checker.model import Model

SECONDS = 20
MAX_SOURCE = 1_000_000
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,63}")
_ENVIRONMENT = ("PATH", "LANG", "LC_ALL", "SYSTEMROOT")

_DRIVER = """\
#include <math.h>
#include <stdio.h>

void @NAME@(double t, const double *y, const double *p, double *dy);

int main(int argc, char **argv) {
  double t, y[@N@ + 1], p[@M@ + 1], dy[@N@ + 64];
  FILE *in = argc > 2 ? fopen(argv[1], "rb") : 0;
  FILE *out = in ? fopen(argv[2], "wb") : 0;
  if (!out) return 1;
  while (fread(&t, sizeof t, 1, in) == 1 && fread(y, sizeof(double), @N@, in) == @N@
         && fread(p, sizeof(double), @M@, in) == @M@) {
    for (int k = 0; k < @N@ + 64; ++k) dy[k] = NAN;
    @NAME@(t, y, p, dy);
    fwrite(dy, sizeof(double), @N@, out);
  }
  return fclose(out) != 0;
}
"""


def check_code(target: str, system: Any, *, seconds: int = SECONDS, seed: int = 0) -> CodeReport:
    """Compare ``FILE.py:FUNCTION`` or ``FILE.c:FUNCTION`` with a system.

    ``system``: a `System`, `Scene` or `Model`, or the name of one, or a scene file. Raises `InputError`
    for code that cannot be run, and for systems that are not known.
    """
    from eom.checker.code import compare, points
    from eom.checker.model import model_from

    file, name = _parsed(target)
    model = model_from(system)
    at = points(model, seed=seed)
    if file.suffix == ".c":
        return compare(model, at, _from_c(file, name, at, seconds))
    rows, arguments = _from_python(file, name, at, seconds)
    if arguments == 2:
        at = points(model, seed=seed, fixed=_built_in(model))
        rows, _ = _from_python(file, name, at, seconds)
    return compare(model, at, rows)


def _built_in(model: Model) -> dict[str, float]:
    """Return the numbers that a function without parameters must have built in: the scene's."""
    if not model.values:
        raise InputError(
            "f(t, y) needs a scene, whose numbers it has built in",
            got=model.name,
            hint="f(t, y, p)",
        )
    return dict(model.values)


def run(target: str, system: str, as_json: bool = False) -> tuple[str, int]:
    """Return what `eom check --code` prints, and its exit status: 1 where something is wrong.

    Raises `InputError` for what cannot be checked.
    """
    report = check_code(target, system)
    text = json.dumps(data_of(report), indent=2) if as_json else text_of(report)
    return text, int(not report.is_right)


def text_of(report: CodeReport) -> str:
    """Return a report as text."""
    lines = [f"y = {', '.join(report.states)}", f"p = {', '.join(report.parameters)}"]
    if report.is_right:
        lines.append(f"right: all {len(report.states)} rates agree to {report.digits:.1f} digits")
    lines += [f"wrong: {m.text}" for m in report.mistakes]
    return "\n".join(lines)


def data_of(report: CodeReport) -> dict[str, Any]:
    """Return a report as data for JSON."""
    mistakes = [
        {"output": m.output, "kind": m.kind, "text": m.text, "term": m.term}
        for m in report.mistakes
    ]
    return {
        "schema": "eom-code-check/1",
        "system": report.name,
        "states": list(report.states),
        "parameters": list(report.parameters),
        "right": report.is_right,
        "digits": report.digits,
        "mistakes": mistakes,
    }


def _parsed(target: str) -> tuple[Path, str]:
    """Return file and function of ``FILE:FUNCTION``."""
    path, _, name = target.rpartition(":")
    file = Path(path)
    if not path or not _NAME.fullmatch(name) or file.suffix not in {".py", ".c"}:
        raise InputError(
            "no code to check", got=target, expected="FILE.py:FUNCTION or FILE.c:FUNCTION"
        )
    if not file.is_file():
        raise InputError("no such file", got=path)
    if file.stat().st_size > MAX_SOURCE:
        raise InputError("a source file is too long", got=path, expected=f"{MAX_SOURCE} bytes")
    return file.resolve(), name


# -- Python ------------------------------------------------------------------------------------------


def _from_python(
    file: Path, name: str, at: Sequence[Point], seconds: int
) -> tuple[list[list[float]], int]:
    """Return the rates at every point, and how many arguments the function takes."""
    with tempfile.TemporaryDirectory(prefix="eom-code-") as folder:
        source, target = Path(folder, "points.json"), Path(folder, "rows.json")
        source.write_text(json.dumps([[p.time, p.states, p.parameters] for p in at]))
        _run(["python", str(seconds), str(file), name, str(source), str(target)], folder, seconds)
        if not target.is_file():
            raise InputError("the code ended without a result", where=str(file), got=name)
        found = json.loads(target.read_text(encoding="utf-8"))
    if "error" in found:
        raise InputError("the code cannot be run", where=str(file), got=found["error"])
    failed = next((r for r in found["rows"] if isinstance(r, str)), None)
    if failed is not None:
        hint = "f(t, y, p) or f(t, y), which returns one rate a state"
        raise InputError(
            "the code fails at a point", where=f"{file}: {name}", got=failed, hint=hint
        )
    return found["rows"], found["arguments"]


def _run(arguments: list[str], folder: str, seconds: int) -> None:
    """Run the black box in a process group of its own; what takes too long is ended with its children."""
    command = [sys.executable, "-I", str(Path(__file__).with_name("black_box.py")), *arguments]
    process = subprocess.Popen(  # noqa: S603 - our own file; no shell
        command,
        cwd=folder,
        env=_environment(folder),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        in_time = _ends(process, seconds)
    finally:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)  # with its children, before its number is free
        process.wait()
    if not in_time:
        raise InputError("the code takes too long", expected=f"at most {seconds} s")
    if process.returncode:
        raise InputError("the code ended with an error", got=_ending(process.returncode))


def _ends(process: subprocess.Popen[bytes], seconds: int) -> bool:
    """Tell whether a process ends in time; its number stays taken."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        state = os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG)
        if state is not None:
            return True
        time.sleep(0.005)
    return False


def _ending(status: int) -> str:
    return signal.Signals(-status).name if status < 0 else f"exit status {status}"


def _environment(folder: str) -> dict[str, str]:
    kept = {k: os.environ[k] for k in _ENVIRONMENT if k in os.environ}
    threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return {**kept, **threads, "HOME": folder, "TMPDIR": folder}


# -- C -----------------------------------------------------------------------------------------------


def _from_c(file: Path, name: str, at: Sequence[Point], seconds: int) -> list[list[float]]:
    """Compile a function with a program that calls it, in a private folder, and run that."""
    n, m = len(at[0].states), len(at[0].parameters)
    with tempfile.TemporaryDirectory(prefix="eom-code-") as folder:
        source, target = Path(folder, "points.bin"), Path(folder, "rows.bin")
        numbers = [v for p in at for v in (p.time, *p.states, *p.parameters)]
        source.write_bytes(struct.pack(f"{len(numbers)}d", *numbers))
        program = _compiled(file, name, n, m, folder)
        _run(["program", str(seconds), program, str(source), str(target)], folder, seconds)
        data = target.read_bytes() if target.is_file() else b""
    values = struct.unpack(f"{len(data) // 8}d", data[: len(data) // 8 * 8])
    if len(values) != n * len(at):
        raise InputError("the code ended without a result", where=str(file), got=name)
    return [list(row) for row in _rows(values, n)]


def _rows(values: Sequence[float], n: int) -> Iterator[Sequence[float]]:
    yield from (values[k : k + n] for k in range(0, len(values), n))


def _compiled(file: Path, name: str, n: int, m: int, folder: str) -> str:
    from codegen.native import require_compiler

    driver, program = Path(folder, "driver.c"), str(Path(folder, "program"))
    text = _DRIVER.replace("@NAME@", name).replace("@N@", str(n)).replace("@M@", str(m))
    driver.write_text(text, encoding="ascii")
    command = [*require_compiler(), "-O1", "-w", "-o", program, str(driver), str(file), "-lm"]
    try:
        done = subprocess.run(  # noqa: S603 - the system's compiler; no shell
            command,
            cwd=folder,
            env=_environment(folder),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise InputError("the compiler takes too long", where=str(file)) from None
    if done.returncode:
        message = done.stderr.replace(folder, "").strip()[:1000]
        raise InputError("the code does not compile", where=str(file), got=message)
    return program
