"""Processes that whoever started them ends: an interruption from the keyboard does not reach them."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker


@contextmanager
def not_interrupted() -> Iterator[None]:
    """Let processes that are started inside not be interrupted: whoever started them ends them.

    An interruption from the keyboard goes to all processes of the terminal; one that is still loading its
    modules would print a traceback. Here it arrives at the end of the block.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # which lets interruptions through when it starts
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def interruptible() -> None:
    """Let this process be interrupted again, which `not_interrupted` started."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
