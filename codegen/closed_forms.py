"""Closed forms of motions that integration need not find: what `method="auto"` asks first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from codegen.compiled import Compiled
from codegen.integrate.trajectory import Array, Problem


@dataclass(frozen=True)
class Closed:
    """The motion of one problem: ``states`` takes times (N,) to states (n, N), in their order."""

    name: str
    meaning: str
    states: Callable[[Array], Array]


FORMS: tuple[Callable[[Compiled, Problem], Closed | None], ...] = ()
"""Each says whether a problem is its own; none is known yet."""


def find(compiled: Compiled, problem: Problem) -> Closed | None:
    """Return the closed form of the first that knows this system with these values, or None."""
    return next((found for form in FORMS if (found := form(compiled, problem))), None)
