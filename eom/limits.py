"""A deadline for a piece of work: what may take long asks whether the time is used up.

Seconds are of processor time: what is found does not depend on what else the machine does.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from math import inf
from time import process_time

_END: ContextVar[tuple[float, str]] = ContextVar("end", default=(inf, ""))


class Overdue(Exception):
    """The time for a piece of work is used up; says which time."""


@contextmanager
def deadline(seconds: float, work: str) -> Iterator[None]:
    """Give ``seconds`` to what is done inside; an outer deadline that ends sooner still holds.

    Raises `Overdue` from the first `check` after it.
    """
    words = f"{work} takes more than {seconds:g} s"
    token = _END.set(min(_END.get(), (process_time() + seconds, words)))
    try:
        yield
    finally:
        _END.reset(token)


def check() -> None:
    """Raise `Overdue` if the time is used up."""
    end, words = _END.get()
    if process_time() > end:
        raise Overdue(words)
