"""What the resolution of time makes of a jump of the rates, against the tolerance.

A jump of the rates by J is found between two neighbouring doubles; where between them, no double shows.
With the rates before it up to there, and those behind it from there on, a state is off by J d at most. d is
how far the jump may be from where it is taken to be: two spacings of doubles, or half of what a method
passes over. J is known from the rates on both sides, whatever it depends on. Such an error is carried
along, so that it counts against what the state is from there on: where J d exceeds atol + rtol |x| all the
way, the tolerance is not met, and the run says so.
"""

from __future__ import annotations

import ctypes
from importlib import resources
from typing import Any

import numpy as np

from codegen.native.trajectory import Array, Problem


def held(count: int) -> str:
    """Return the fields of a generated loop that meets jumps, as C; of so many values."""
    return (
        f"    double off[{count}], allowed[{count}], off_at[{count}]; "
        "/* what placing a jump may change, what may be off, when */\n"
    )


def begin(count: int) -> str:
    """Return what sets them, as C."""
    return f"    for (int i = 0; i < {count}; ++i) s->off[i] = s->off_at[i] = 0.0, s->allowed[i] = 1.0;\n"


def fields(count: int) -> tuple[tuple[str, Any], ...]:
    """Mirror them."""
    return tuple((name, ctypes.c_double * count) for name in ("off", "allowed", "off_at"))


def functions(prefix: str) -> str:
    """Return what such a loop calls, as C."""
    text = resources.files("codegen.loops").joinpath("jumps.c").read_text("ascii")
    return text.replace("@PREFIX@", prefix)


class Jumps:
    """The same for loops in Python: ``off``, ``allowed``, ``off_at`` (n,), in units of states and time."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.off, self.off_at = np.zeros((2, len(problem.x0)))
        self.allowed = np.ones(len(problem.x0))

    def jump(self, t: float, x: Array, off: Array) -> None:
        """Take in a jump at ``t`` that may put the states ``x`` off by so much."""
        allowed = self._allowed(x)
        worse = off * self.allowed > self.off * allowed
        self.off = np.where(worse, np.fmax(self.off, off), self.off)
        self.off_at = np.where(worse, t, self.off_at)
        self.allowed = np.where(worse, allowed, np.fmax(self.allowed, allowed))

    def step(self, x: Array) -> None:
        """Take in the states at the end of a step."""
        self.allowed = np.fmax(self.allowed, self._allowed(x))

    def _allowed(self, x: Array) -> Array:
        return np.asarray(self.problem.atol + self.problem.rtol * np.abs(x))


def notice(state: Any, problem: Problem) -> str:
    """Return the notice of a run, or nothing; ``state`` has the fields."""
    off, allowed, at = (np.array(getattr(state, name)) for name in ("off", "allowed", "off_at"))
    share = np.divide(off, allowed, out=np.zeros_like(off), where=off > allowed)
    worst = int(np.argmax(share))
    if not share[worst]:
        return ""
    return (
        f"the rates jump so far at t = {problem.time_text(float(at[worst]))} that the resolution of time "
        f"there may change a state by {share[worst]:.2g} times what the tolerance allows"
    )
