"""Work in another process, which is ended when it takes too long; it may also crash."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any, Self

from codegen.native import children
from eom import interrupts

READY_SECONDS = 300.0
"""A new process that has not even begun by then counts as dead."""

LAST_SECONDS = 10.0
"""For a process that has closed its end to be over."""


@dataclass(frozen=True)
class Answer:
    """What became of a piece of work: ``value`` where ``trouble`` is empty."""

    value: Any
    trouble: str = ""


class Worker:
    """A process that calls ``work(argument)``, a function of a module; a new one after trouble."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        self.work = work
        self.process: Any = None
        self.connection: Connection | None = None

    def __enter__(self) -> Self:
        """Return self; the process starts with the first piece of work."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the process."""
        self._end()

    def ask(self, argument: Any, seconds: float) -> Answer:
        """Return the answer, or what went wrong: no answer in time, an exception, the process died."""
        connection = self.connection or self._begin()
        try:
            connection.send(argument)
            if not connection.poll(seconds):
                self._end()
                return Answer(None, f"no answer within {seconds:g} s")
            fine, value = connection.recv()
        except (EOFError, OSError):
            self.process.join(LAST_SECONDS)
            code = self.process.exitcode
            self._end()
            return Answer(None, f"the process died (exit code {code})")
        return Answer(value) if fine else Answer(None, value)

    def _begin(self) -> Connection:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, self.work), daemon=True)
        with interrupts.not_interrupted():
            self.process.start()
        theirs.close()
        self.connection = ours
        if ours.poll(READY_SECONDS):
            ours.recv()
        return ours

    def _end(self) -> None:
        if self.connection is not None:
            self.connection.close()
            _end(self.process)
        self.connection = None


def _end(process: Any) -> None:
    """End a process, by an interruption where it heeds one, so that it ends its own children."""
    if process.is_alive():
        os.kill(process.pid, signal.SIGINT)
    process.join(children.PATIENCE_SECONDS)
    process.kill()
    process.join()


def _serve(connection: Connection, work: Callable[[Any], Any]) -> None:
    """Answer until the other side closes, or an interruption; an exception is an answer."""
    with suppress(KeyboardInterrupt):
        interrupts.interruptible()
        _answers(connection, work)


def _answers(connection: Connection, work: Callable[[Any], Any]) -> None:
    connection.send("ready")
    while True:
        try:
            argument = connection.recv()
        except EOFError:
            return
        try:
            answer: tuple[bool, Any] = (True, work(argument))
        except Exception as error:  # whatever it is, it is told
            answer = (False, f"{type(error).__name__}: {error}")
        connection.send(answer)
