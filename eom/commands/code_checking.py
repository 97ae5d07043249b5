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
import stat
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eom.checker.read.spans import printable
from eom.errors import InputError

if TYPE_CHECKING:
    from eom.checker.code.comparison import CodeReport, Point
    from eom.checker.mean.model import Model

SECONDS = 20
PLACE = "namespace"
"""Where the warden of foreign code stands, where the system allows it: see `black_box`."""
GRACE, END_SECONDS = 10, 0.4
"""Seconds that the warden may take beyond those of the code; how long it may take to end all when asked."""
MEMORY, COMPILER_MEMORY = 4_000_000_000, 1_500_000_000
"""Bytes of a process of the code, and of one of the compiler."""
MAX_SOURCE, MAX_RESULT = 1_000_000, 16_000_000
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
    from eom.checker.code.comparison import compare, points
    from eom.checker.mean.model import model_from

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
        _run(["python", str(file), name, str(source), str(target)], folder, seconds)
        found = _answer(_read(target), len(at))
    if found is None:
        raise InputError("the code ended without a result", where=str(file), got=name)
    if isinstance(found, str):
        raise InputError("the code cannot be run", where=str(file), got=found)
    failed = next((r for r in found[0] if isinstance(r, str)), None)
    if failed is not None:
        hint = "f(t, y, p) or f(t, y), which returns one rate a state"
        raise InputError(
            "the code fails at a point", where=f"{file}: {name}", got=failed, hint=hint
        )
    return [row for row in found[0] if not isinstance(row, str)], found[1]


def _read(file: Path, most: int = MAX_RESULT) -> bytes:
    """Return what foreign code left in a file, nothing where it is none or longer than ``most`` bytes.

    It may have put something else in its place: a link, a pipe that nobody writes to, a folder.
    """
    flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK
    try:
        number = os.open(file, flags)
    except OSError:
        return b""
    try:
        status = os.fstat(number)
        if not stat.S_ISREG(status.st_mode) or status.st_size > most:
            return b""
        with os.fdopen(number, "rb", closefd=False) as opened:
            return opened.read(most)
    finally:
        os.close(number)


Answer = tuple[list[list[float] | str], int]


def _answer(data: bytes, points: int) -> Answer | str | None:
    """Return rows and number of arguments, the error in words, or None: what comes back proves nothing.

    The code runs in the process that writes it, and may have written it itself.
    """
    try:
        found = json.loads(data)
    except (ValueError, RecursionError):
        return None
    if not isinstance(found, dict):
        return None
    if isinstance(found.get("error"), str):
        return _printable(found["error"])
    rows, arguments = found.get("rows"), found.get("arguments")
    if not isinstance(rows, list) or len(rows) != points or type(arguments) is not int:
        return None
    checked = [_row(row) for row in rows]
    return (
        None
        if any(row is None for row in checked)
        else ([r for r in checked if r is not None], arguments)
    )


def _row(row: object) -> list[float] | str | None:
    """Return a row of numbers, or the words in place of one; None for anything else."""
    if isinstance(row, str):
        return _printable(row)
    if not isinstance(row, list) or any(type(v) not in {int, float} for v in row):
        return None
    try:
        return [float(v) for v in row]
    except OverflowError:
        return None


def _printable(text: str) -> str:
    """Return text of foreign code without what could steer a terminal, at most 300 characters of it."""
    return printable(text)[:300]


_VERDICT = ("exit", "signal", "late", "crowd")
ENDED = {
    "late": "the code takes too long",
    "crowd": "the code starts too many processes",
    "": "the code ended its warden",
}
"""What is said where code was ended, or ended what watches it."""


def _run(arguments: list[str], folder: str, seconds: int) -> None:
    """Run the black box, and raise `InputError` unless what it guards ends well, in time and alone."""
    kind, value = _guarded(arguments, folder, seconds, MEMORY, os.devnull)
    if kind in ENDED:
        expected = f"at most {seconds} s" if kind == "late" else ""
        raise InputError(ENDED[kind], expected=expected)
    if value:
        raise InputError("the code ended with an error", got=_ending(kind, value))


def _guarded(
    arguments: list[str], folder: str, seconds: int, memory: int, output: str
) -> tuple[str, int]:
    """Run the black box; return how what it guards ended: a word of its verdict, and a number.

    Nothing that it started is left, also where this is interrupted.
    """
    box = str(Path(__file__).with_name("black_box.py"))
    process = subprocess.Popen(  # noqa: S603 - our own file; no shell
        [sys.executable, "-I", box, PLACE, str(seconds), str(memory), output, *arguments],
        cwd=folder,
        env=_environment(folder),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    with process:
        try:
            answer, _ = process.communicate(timeout=seconds + GRACE)
        except BaseException as error:
            _end(process)
            if not isinstance(error, subprocess.TimeoutExpired):
                raise
            return "", 0
    return _verdict(answer)


def _verdict(answer: bytes) -> tuple[str, int]:
    """Return the word and the number of a verdict; no word where it is none."""
    try:
        ((kind, value),) = json.loads(answer[:100]).items()
    except (ValueError, AttributeError, RecursionError):
        return "", 0
    is_one = kind in _VERDICT and type(value) is int and 0 <= value < 256
    return (kind, value) if is_one else ("", 0)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the warden, who then ends what it guards; its number is taken until it is waited for."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(END_SECONDS)


def _ending(kind: str, value: int) -> str:
    known = kind == "signal" and value in {s.value for s in signal.Signals}
    return signal.Signals(value).name if known else f"{kind} status {value}"


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
        program = _compiled(file, name, n, m, folder, seconds)
        _run(["program", program, str(source), str(target)], folder, seconds)
        data = _read(target)
    values = struct.unpack(f"{len(data) // 8}d", data[: len(data) // 8 * 8])
    if len(values) != n * len(at):
        raise InputError("the code ended without a result", where=str(file), got=name)
    return [list(row) for row in _rows(values, n)]


def _rows(values: Sequence[float], n: int) -> Iterator[Sequence[float]]:
    yield from (values[k : k + n] for k in range(0, len(values), n))


def _compiled(file: Path, name: str, n: int, m: int, folder: str, seconds: int) -> str:
    """Compile a function and what calls it, within limits too: a text may make a compiler work for ever."""
    from codegen.native.native import require_compiler

    driver, program = Path(folder, "driver.c"), str(Path(folder, "program"))
    text = _DRIVER.replace("@NAME@", name).replace("@N@", str(n)).replace("@M@", str(m))
    driver.write_text(text, encoding="ascii")
    command = [*require_compiler(), "-O1", "-w", "-o", program, str(driver), str(file), "-lm"]
    said = Path(folder, "messages")
    kind, value = _guarded(["program", *command], folder, seconds, COMPILER_MEMORY, str(said))
    if kind in ENDED:
        raise InputError(
            "the compiler takes too long" if kind == "late" else "the compiler was ended",
            where=str(file),
            expected=f"at most {seconds} s",
        )
    if value or not Path(program).is_file():
        message = _read(said).decode("utf-8", "replace").replace(folder, "").strip()
        got = "\n".join(map(printable, message[:1000].splitlines())) or _ending(kind, value)
        raise InputError("the code does not compile", where=str(file), got=got)
    return program
