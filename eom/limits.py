"""A deadline for a piece of work: what may take long asks whether the time is used up.

Seconds are of processor time: what is found does not depend on what else the machine does.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from math import inf
from threading import Lock
from time import process_time

_END: ContextVar[tuple[float, str]] = ContextVar("end", default=(inf, ""))


class Overdue(Exception):
    """The time for a piece of work is used up; says which time."""


@contextmanager
def deadline(seconds: float, work: str) -> Iterator[None]:
    """Give ``seconds`` to what is done inside; an outer deadline that ends sooner still holds.

    Raises `Overdue` from the first `check` after it.
    """
    seconds = float(seconds)
    words = f"{work} takes more than {seconds:g} s"
    token = _END.set(min(_END.get(), (process_time() + seconds, words)))
    try:
        yield
    finally:
        _END.reset(token)


SELDOM = (50_000, 20, 100)
"""Allocations between two collections of garbage, and collections of one generation for one of the next."""
_LOCK = Lock()
_FOUND: list[tuple[int, int, int]] = []
"""Thresholds from before the first of those who are inside, once for each of them."""


@contextmanager
def seldom_collected() -> Iterator[None]:
    """Look for reference cycles less often inside: work that allocates much and leaves few of them.

    References are counted all the same, and free at once what stands in no cycle. With the usual
    thresholds a fifth of a note's time goes into looking through SymPy's caches again and again.
    Threads may be inside at once: the last to leave gives back what the first found. Who collects never,
    or more seldom, is left alone.
    """
    with _LOCK:
        _FOUND.append(_FOUND[0] if _FOUND else gc.get_threshold())
        if 0 < _FOUND[0][0] < SELDOM[0]:
            gc.set_threshold(*SELDOM)
    try:
        yield
    finally:
        with _LOCK:
            found = _FOUND.pop()
            if not _FOUND:
                gc.set_threshold(*found)


def check() -> None:
    """Raise `Overdue` if the time is used up."""
    end, words = _END.get()
    if process_time() > end:
        raise Overdue(words)
