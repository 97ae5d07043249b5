"""Child processes that end with what they started: none outlives a command that is interrupted.

A compiler is a driver with children of its own. To end the driver alone leaves them at work, so each child
gets a process group, and the group is ended.

Runs that are given up after a time.

Work in threads that can be asked to end: loops in C read a flag at each step, those in Python ask.

An interruption reaches the main thread alone. What waits there for the others sets their flag, and they
end within a step; nothing of what they had begun is kept.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from contextvars import ContextVar

from codegen.ir import compile_progress

HEARD_SECONDS = 0.1
"""Between two times that who listens to the compilation is notified that a command goes on."""
PATIENCE_SECONDS = 0.3
"""What an interrupted process gets to end by itself."""


def finished(
    command: Sequence[str], *, seconds: float, environment: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a command, a list that no shell reads, to its end; return its status and what it printed.

    Bytes that are no UTF-8 are replaced. Raises `OSError` where it cannot be started and
    `subprocess.TimeoutExpired` after ``seconds``; then, and at an interruption, it and its children are
    ended.
    """
    return waited_for(begun(command, environment), seconds)


def begun(
    command: Sequence[str], environment: Mapping[str, str] | None = None
) -> subprocess.Popen[str]:
    """Begin a command, which goes on beside this process; whoever begins it waits for it, or ends it.

    Raises `OSError` where it cannot be started.
    """
    return subprocess.Popen(  # noqa: S603 - a list, no shell
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        errors="replace",
        env=None if environment is None else dict(environment),
        start_new_session=True,
    )


def waited_for(process: subprocess.Popen[str], seconds: float) -> subprocess.CompletedProcess[str]:
    """Return how a command that was `begun` ended; raises as `finished` does."""
    with process:
        try:
            out, err = _communicated(process, seconds)
        except BaseException:
            end(process)
            raise
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def _communicated(process: subprocess.Popen[str], seconds: float) -> tuple[str, str]:
    """Return what a process prints; whoever listens is notified now and then that it goes on."""
    end = time.monotonic() + seconds
    while compile_progress.is_heard() and (rest := end - time.monotonic()) > HEARD_SECONDS:
        try:
            return process.communicate(timeout=min(HEARD_SECONDS, rest))
        except subprocess.TimeoutExpired:
            compile_progress.beat()
    return process.communicate(timeout=end - time.monotonic())


def end(process: subprocess.Popen[str]) -> None:
    """End a process and its group: first as an interruption does, so that it ends its own children.

    Its number is taken until it is waited for.
    """
    if hasattr(os, "killpg"):
        for number in (signal.SIGINT, signal.SIGKILL):
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, number)
            with suppress(subprocess.TimeoutExpired):
                process.wait(PATIENCE_SECONDS)
    elif tree := ending(process.pid):
        with suppress(OSError, subprocess.TimeoutExpired):
            subprocess.run(tree, check=False, capture_output=True, timeout=10)  # noqa: S603 - a list
    process.kill()


def ending(number: int, system: str = sys.platform) -> list[str]:
    """Return the command that ends a process with its children where there are no groups of processes.

    >>> ending(7, "win32"), ending(7, "linux")
    (['taskkill', '/F', '/T', '/PID', '7'], [])
    """
    return ["taskkill", "/F", "/T", "/PID", str(number)] if system == "win32" else []


class TooLongError(Exception):
    """A run was given up."""


def watch(limit: float) -> Callable[[float], None]:
    """Return a listener to progress that gives up ``limit`` seconds (processor) after its first call.

    Compilation is over then. Raises `TooLongError`.
    """
    began: list[float] = []

    def progress(_: float) -> None:
        now = time.process_time()
        if not began:
            began.append(now)
        if now - began[0] > limit:
            raise TooLongError

    return progress


class Halt(Exception):
    """A piece of work was asked to end; its result is worth nothing."""


class Flag:
    """A flag that Python sets and C reads: an int that stays where it is as long as this lives."""

    def __init__(self) -> None:
        self._value = ctypes.c_int(0)

    def set(self) -> None:
        """Ask the work to end; that cannot be taken back."""
        self._value.value = 1

    @property
    def is_set(self) -> bool:
        """Whether the work was asked to end."""
        return self._value.value != 0

    @property
    def address(self) -> int:
        """Where C reads it."""
        return ctypes.addressof(self._value)


_FLAG: ContextVar[Flag] = ContextVar("flag")


def obey(flag: Flag) -> None:
    """Let what this thread does from now on end when ``flag`` is set."""
    _FLAG.set(flag)


def flag() -> Flag:
    """Return the flag of this thread; one that nobody sets where it was given none."""
    return _FLAG.get(None) or Flag()


def check() -> None:
    """Raise `Halt` if this thread was asked to end."""
    if flag().is_set:
        raise Halt
