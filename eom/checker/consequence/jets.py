"""Letters as symbols: constants, functions of time, their derivatives, and what is equal to what."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, MutableMapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Protocol

import sympy as sp

Expr = Any
TIME = sp.Symbol("t", real=True)


@dataclass(frozen=True)
class Letter:
    """A letter of a note, or one of its derivatives by the time; ``kind``: `STAYS`, `CHANGES`, `MAY`."""

    name: str
    order: int
    kind: str

    @property
    def moving(self) -> bool:
        """Whether it has derivatives."""
        return self.kind != STAYS


STAYS, CHANGES, MAY = "", "t", "q"
"""Letters of constants, letters with dots, and those that change only where they are given by such."""


_BETWEEN = "|"


@lru_cache(maxsize=4096)
def jet(name: str, order: int = 0, kind: str = CHANGES) -> Expr:
    """Return the symbol of a letter, or of its derivative; constants have none."""
    return sp.Symbol(_BETWEEN.join((name, "'" * order, kind)), real=True)


def lettered(symbols: Iterable[Expr]) -> dict[Expr, Letter]:
    """Return the symbols that are letters of a note, with what they stand for."""
    return {s: known for s in symbols if (known := letter(s)) is not None}


def derived(symbol: Expr, order: int) -> Expr:
    """Return the symbol of a derivative of a letter, of which any symbol is given."""
    known = letter(symbol)
    assert known is not None
    return jet(known.name, order, known.kind)


@lru_cache(maxsize=4096)
def letter(symbol: Expr) -> Letter | None:
    """Return what a symbol stands for, None for all but letters of a note."""
    parts = symbol.name.rsplit(_BETWEEN, 2) if symbol.is_Symbol else []
    return Letter(parts[0], len(parts[1]), parts[2]) if len(parts) == 3 else None


AXIS = "turn"
"""Name of the angular velocity of axes that turn."""


def is_component(symbol: Expr) -> bool:
    """Return whether a letter is a component of a vector or matrix."""
    known = letter(symbol)
    return known is not None and bool(_COMPONENT.search(known.name))


_COMPONENT = re.compile(r" [123]{1,2}$")


def rate(e: Expr) -> Expr:
    """Return the derivative by the time of an expression in letters, or that it is to be worked out."""
    if e.has(partial, timed):
        return timed(e)
    parts = [e.diff(TIME)]
    for s in e.free_symbols:
        known = letter(s)
        if known is not None and known.moving:
            parts.append(e.diff(s) * derived(s, known.order + 1))
    return sp.Add(*parts)


class Together(Protocol):
    """A statement with vectors, of which an equation is one component."""

    @property
    def link(self) -> int:
        """Which of the links of a chain it is."""

    @property
    def memo(self) -> MutableMapping[Any, Any]:
        """What was found of it."""

    @property
    def equations(self) -> tuple[Equal, ...]:
        """All components."""

    def scaled(self) -> Iterator[tuple[str, tuple[Equal, ...]]]:
        """Yield its parts in LaTeX, and the components with a factor at them."""

    def is_entry(self, name: str) -> bool:
        """Return whether a letter is an entry of a column or matrix of any size."""


@dataclass(frozen=True)
class Equal:
    """Two sides that a formula says are equal, in letters."""

    left: Expr
    right: Expr
    near: bool = False
    """Whether they are so for small motions alone."""
    whole: Together | None = field(default=None, compare=False, repr=False)
    """The statement that this is a part of, where vectors stand in it."""

    @property
    def letters(self) -> frozenset[Expr]:
        """The symbols of both sides."""
        return frozenset(s for e in (self.left, self.right) for s in e.free_symbols if letter(s))


class partial(sp.Function):  # type: ignore[misc]  # noqa: N801 - it is printed as it is called
    """The derivative of an expression by one of its letters, worked out once all letters are known."""


class timed(sp.Function):  # type: ignore[misc]  # noqa: N801
    """The derivative by the time of an expression with such derivatives."""
