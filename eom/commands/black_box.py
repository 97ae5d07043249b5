"""Run foreign code within limits: this file is started as a process of its own, isolated (``-I``).

``black_box.py PLACE SECONDS MEMORY OUTPUT python FILE FUNCTION POINTS RESULTS``: call f(t, y, p), or
f(t, y), at points from a JSON file ``[[t, y, p], ...]``; write ``{"rows": [...]}``, a list of numbers or a
text for each, or ``{"error": text}``. ``... program FILE ARGUMENTS``: become that program. What is printed
goes to the file OUTPUT. Memory, time, files and processes are limited before anything foreign is loaded.

The code runs in a child of a warden, which ends all that descends from it and then writes to standard
output how it ended: ``{"exit": status}``, ``{"signal": number}``, ``{"late": 1}`` or ``{"crowd": 1}``. If
PLACE is ``namespace`` and Linux allows it, the warden is the first process of a PID namespace, which
nothing in it can leave or outlive (pid_namespaces(7)); else it adopts orphans (PR_SET_CHILD_SUBREAPER,
prctl(2)) and ends them by number.
"""

from __future__ import annotations

import contextlib
import ctypes
import importlib.util
import inspect
import json
import os
import resource
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

LIMITS = (
    ("RLIMIT_FSIZE", 64_000_000),
    ("RLIMIT_NOFILE", 128),
    ("RLIMIT_CORE", 0),
)
"""Bytes, files, bytes."""
MOST_PROCESSES = 64
"""At one time; more are no computation of rates, and end the code."""
LOOK_SECONDS, COUNT_SECONDS = 0.002, 0.01
NEW_USER, NEW_PID = 0x10000000, 0x20000000
PARENT_DEATH, ADOPT = 1, 36
"""Flags of unshare(2), options of prctl(2)."""


def limit(seconds: int, memory: int) -> None:
    """Limit this process and its children for good, each to so many seconds (processor) and bytes."""
    for name, wanted in (*LIMITS, ("RLIMIT_CPU", seconds), ("RLIMIT_AS", memory)):
        _, hard = resource.getrlimit(getattr(resource, name))
        low = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(getattr(resource, name), (low, low))


# -- the warden --------------------------------------------------------------------------------------


def _called(function: str, *arguments: int) -> bool:
    """Call a function of the C library; return whether there is one and it succeeds."""
    found = getattr(ctypes.CDLL(None), function, None)
    return found is not None and found(*arguments) == 0


def into_namespace() -> None:
    """Go on as the first process of a PID namespace where that is allowed; the caller waits for it."""
    user, group = os.getuid(), os.getgid()
    if not _called("unshare", NEW_PID):
        if not _called("unshare", NEW_USER | NEW_PID):
            return
        for file, text in (
            ("setgroups", "deny"), ("uid_map", f"{user} {user} 1"), ("gid_map", f"{group} {group} 1")
        ):  # fmt: skip
            with contextlib.suppress(OSError):
                Path("/proc/self", file).write_text(text, encoding="ascii")
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # the warden heeds it
    first = os.fork()
    if first:
        os.waitpid(first, 0)
        os._exit(0)
    _called("prctl", PARENT_DEATH, signal.SIGKILL)


def guarded(work: Callable[[], None], seconds: float) -> dict[str, int]:
    """Run something in a child and say how it ended; whatever descends from it is ended before that."""
    _called("prctl", ADOPT, 1)
    signal.signal(signal.SIGTERM, _given_up)
    child = os.fork()
    if not child:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        _to_the_end(work)
    try:
        return _verdict(child, seconds)
    finally:
        _end_descendants()


def _given_up(*_: Any) -> NoReturn:
    raise SystemExit


def _to_the_end(work: Callable[[], None]) -> NoReturn:
    """Do the work of the child, and end it, whatever happens."""
    status = 1
    try:
        work()
        status = 0
    finally:
        os._exit(status)


def _verdict(child: int, seconds: float) -> dict[str, int]:
    """Wait for the child while all that descends from this process is few and in time."""
    now = time.monotonic()
    deadline, count_at = now + seconds, now
    while now < deadline:
        ended, status = os.waitpid(-1, os.WNOHANG)
        if ended == child:
            code = os.waitstatus_to_exitcode(status)
            return {"exit": code} if code >= 0 else {"signal": -code}
        if now >= count_at:
            if len(_descendants()) > MOST_PROCESSES:
                return {"crowd": 1}
            count_at = now + COUNT_SECONDS
        if not ended:
            time.sleep(LOOK_SECONDS)
        now = time.monotonic()
    return {"late": 1}


def _descendants() -> list[int]:
    """Return the numbers of the processes that descend from this one, as /proc has them."""
    parents: dict[int, list[int]] = {}
    try:
        own = int(Path("/proc/self").readlink().name)
        numbers = [p.name for p in Path("/proc").iterdir() if p.name.isdigit()]
    except OSError:
        return []
    for number in numbers:
        with contextlib.suppress(OSError, ValueError):
            state, parent = (
                Path("/proc", number, "stat").read_text("latin-1").rpartition(")")[2].split()[:2]
            )
            if state != "Z":
                parents.setdefault(int(parent), []).append(int(number))
    found = [own]
    for process in found:
        found += parents.get(process, [])
    return found[1:]


def _end_descendants() -> None:
    """End whatever descends from this process, and wait until none is left.

    The first process of a namespace ends all others in it at once. Elsewhere those that multiply are
    stopped first: what is stopped starts nothing.
    """
    while _has_children():
        if os.getpid() == 1:
            with contextlib.suppress(OSError):
                os.kill(-1, signal.SIGKILL)
        else:
            found: list[int] = []
            while len(more := _descendants()) > len(found):
                found = more
                _signal(found, signal.SIGSTOP)
            _signal(found, signal.SIGKILL)
        time.sleep(LOOK_SECONDS)


def _signal(numbers: list[int], number: int) -> None:
    for process in numbers:
        with contextlib.suppress(OSError):
            os.kill(process, number)


def _has_children() -> bool:
    """Return whether this process has children; those that have ended are waited for."""
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        return False
    return True


# -- what it guards ----------------------------------------------------------------------------------


def function_of(file: str, name: str) -> Callable[..., Any]:
    """Load a function from a file; modules beside the file can be imported."""
    sys.dont_write_bytecode = True
    sys.path.append(str(Path(file).parent))
    spec = importlib.util.spec_from_file_location("code_under_test", file)
    if spec is None or spec.loader is None:
        raise ImportError(f"not a Python file: {file}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return getattr(module, name)  # type: ignore[no-any-return]


def rows_of(function: Callable[..., Any], points: list[Any]) -> list[Any]:
    """Return the values at every point, or the error there as a text."""
    array = _array()
    wanted = len(_positional(function))
    rows: list[Any] = []
    for t, y, p in points:
        arguments = (t, array(y), array(p))[: 2 if wanted == 2 else 3]
        try:
            rows.append([float(v) for v in function(*arguments)])
        except Exception as error:  # whatever foreign code raises
            rows.append(f"{type(error).__name__}: {error}"[:300])
    return rows


def _positional(function: Callable[..., Any]) -> list[str]:
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    parameters = inspect.signature(function).parameters.values()
    return [p.name for p in parameters if p.kind in kinds and p.default is p.empty]


def _array() -> Callable[[list[float]], Any]:
    try:
        import numpy
    except ImportError:
        return list
    return lambda values: numpy.array(values, dtype=float)


def arguments_of(function: Callable[..., Any]) -> int:
    """Return how many arguments a function must be given."""
    return len(_positional(function))


def evaluate(file: str, name: str, source: str, target: str) -> None:
    """Write the values of a function at the points of a file."""
    try:
        found = function_of(file, name)
        points = json.loads(Path(source).read_text(encoding="utf-8"))
        result = {"rows": rows_of(found, points), "arguments": arguments_of(found)}
    except BaseException as error:  # SystemExit too
        result = {"error": f"{type(error).__name__}: {error}"[:300]}
    Path(target).write_text(json.dumps(result), encoding="utf-8")


def main(arguments: list[str]) -> None:
    """Do what the arguments say."""
    place, seconds, memory, output, kind, *rest = arguments

    def work() -> None:
        with Path(output).open("wb") as file:
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)
        limit(int(seconds), int(memory))
        if kind == "program":
            os.execv(rest[0], rest)  # noqa: S606 - the compiler, or the program that it made for this
        evaluate(*rest)

    if place == "namespace":
        into_namespace()
    sys.stdout.write(json.dumps(guarded(work, float(seconds))))


if __name__ == "__main__":
    main(sys.argv[1:])
