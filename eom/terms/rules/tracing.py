"""What a rule is called, and which of them, on which statements, have changed a term.

A rule with a name notes, when it changes something, that it did, and on what it rests; whoever applies
rules within `traced` can tell afterwards.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field

from eom.terms.terms import Equation, Term

Rule = Callable[[Term], Term]


@dataclass
class Trace:
    """What rules have done.

    ``words``: the names of those that changed something, each once; ``known``: the statements used;
    ``products``: of what is shown not to be negative, products whose sum it is.
    """

    words: dict[str, None] = field(default_factory=dict)
    known: dict[Equation, None] = field(default_factory=dict)
    products: tuple[tuple[Term, ...], ...] = ()


_TRACE: ContextVar[Trace | None] = ContextVar("trace", default=None)


@contextmanager
def traced() -> Iterator[Trace]:
    """Collect what is applied within."""
    token = _TRACE.set(Trace())
    try:
        found = _TRACE.get()
        assert found is not None
        yield found
    finally:
        _TRACE.reset(token)


def rest_on(statement: Equation) -> None:
    """Note that a rule has used a statement."""
    trace = _TRACE.get()
    if trace is not None:
        trace.known[statement] = None


def noted(words: str) -> None:
    """Note that a rule of this name has been applied."""
    trace = _TRACE.get()
    if trace is not None:
        trace.words[words] = None


def certified(products: tuple[tuple[Term, ...], ...]) -> None:
    """Note the products whose sum is said not to be negative."""
    trace = _TRACE.get()
    if trace is not None:
        trace.products = products


@dataclass(frozen=True)
class Named:
    """A rule with its name in ``words``."""

    words: str
    change: Rule

    def __call__(self, term: Term) -> Term:
        """Apply the rule, and note it where it changes something."""
        new = self.change(term)
        if new != term:
            noted(self.words)
        return new


def named(words: str, change: Rule) -> Rule:
    """Return a rule under a name."""
    return Named(words, change)
