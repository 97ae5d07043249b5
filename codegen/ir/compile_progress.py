"""How far a compilation is: its stages, and the share of each, reported from inside long loops.

Who listens is a matter of context, as deadlines are: the passes between go from program to program, and
know nothing of it. Where nobody listens nothing is counted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

Listener = Callable[[str, float], None]
"""Called with the name of a stage and the share of it that is done, 0 to 1."""

STAGES = ("lowering", "stable forms", "passes", "text", "compiler")
"""The stages of a compilation in order; the last is that of C, or Python's."""

EVERY = 1024
"""Calls of `done` between two times that the listener is called, ..."""
STEP = 0.01
"""... unless the share has grown by so much."""


class _Refused(BaseException):
    """What a listener raised, which no handler of errors on the way takes for one of its own."""

    def __init__(self, reason: BaseException) -> None:
        self.reason = reason


class _Listening:
    """A listener, and how far the stage is that was reported to it: units of work, and their number."""

    def __init__(self, listener: Listener) -> None:
        self.listener = listener
        self.stage, self.work, self.done = "", 1.0, 0.0
        self.calls, self.share = 0, 0.0

    def begin(self, stage: str, work: float) -> None:
        self.stage, self.work, self.done = stage, max(1.0, work), 0.0
        self.report(0.0)

    def go_on(self, units: float) -> None:
        self.calls += 1
        self.done = min(self.done + units, self.work)
        share = self.done / self.work
        if self.calls >= EVERY or share >= self.share + STEP:
            self.report(share)

    def report(self, share: float) -> None:
        """Call the listener, to which nothing is reported of what it compiles itself."""
        self.calls, self.share = 0, share
        token = _LISTENING.set(None)
        try:
            self.listener(self.stage, share)
        except BaseException as reason:
            raise _Refused(reason) from None
        finally:
            _LISTENING.reset(token)


_LISTENING: ContextVar[_Listening | None] = ContextVar("listening", default=None)


@contextmanager
def to(listener: Listener | None) -> Iterator[None]:
    """Report to ``listener`` the stages of what is done inside; None: nobody, whoever listens outside.

    Raises what the listener raises.
    """
    token = _LISTENING.set(None if listener is None else _Listening(listener))
    reason: BaseException | None = None
    try:
        yield
    except _Refused as refused:
        reason = refused.reason
    finally:
        _LISTENING.reset(token)
    if reason is not None:
        raise reason


@contextmanager
def stage(name: str, work: Callable[[], float] = lambda: 1.0) -> Iterator[None]:
    """Report that a stage begins and, unless it fails, that it ends; ``work``: its number of units."""
    listening = _LISTENING.get()
    if listening is None:
        yield
        return
    listening.begin(name, work())
    yield
    listening.report(1.0)


def done(units: float = 0.0) -> None:
    """Report now and then that so many more units of the stage are done, or just that it goes on."""
    listening = _LISTENING.get()
    if listening is not None:
        listening.go_on(units)


def beat() -> None:
    """Report at once that the stage goes on."""
    listening = _LISTENING.get()
    if listening is not None:
        listening.report(listening.share)


def is_heard() -> bool:
    """Return whether somebody listens."""
    return _LISTENING.get() is not None


Fitted = Callable[[Any, Any], None]
"""Called with a program and its layout, when they are there and nothing of them is written yet."""
_FITTED: ContextVar[Fitted | None] = ContextVar("fitted", default=None)


@contextmanager
def beside(work: Fitted) -> Iterator[None]:
    """Let ``work`` begin what goes on beside the compiler of the first system compiled inside."""
    token = _FITTED.set(work)
    try:
        yield
    finally:
        _FITTED.reset(token)


def fitted(program: Any, layout: Any) -> None:
    """Say that a program is there."""
    work = _FITTED.get()
    if work is not None:
        _FITTED.set(None)
        work(program, layout)
