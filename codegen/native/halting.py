"""Work in threads that can be told to end: loops in C read a flag at each step, those in Python ask.

An interruption reaches the main thread alone. What waits there for the others sets their flag, and they
end within a step; nothing of what they had begun is kept.
"""

from __future__ import annotations

import ctypes
from contextvars import ContextVar


class Halt(Exception):
    """A piece of work was told to end; its result is worth nothing."""


class Flag:
    """A flag that Python sets and C reads: an int that stays where it is as long as this lives."""

    def __init__(self) -> None:
        self._value = ctypes.c_int(0)

    def set(self) -> None:
        """Tell the work to end; that cannot be taken back."""
        self._value.value = 1

    @property
    def is_set(self) -> bool:
        """Whether the work was told to end."""
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
    """Raise `Halt` if this thread was told to end."""
    if flag().is_set:
        raise Halt
