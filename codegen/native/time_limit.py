"""Runs that are given up after a time."""

from __future__ import annotations

import time
from collections.abc import Callable


class TooLongError(Exception):
    """A run was given up."""


def watch(limit: float) -> Callable[[float], None]:
    """Return what progress is told to: it gives up ``limit`` seconds (processor) after its first call.

    Compilation is over then. Raises `TooLongError`.
    """
    began: list[float] = []

    def told(_: float) -> None:
        now = time.process_time()
        if not began:
            began.append(now)
        if now - began[0] > limit:
            raise TooLongError

    return told
