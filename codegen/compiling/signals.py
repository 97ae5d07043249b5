"""Inputs that are Python functions of time: what they state of themselves, and how a run calls them."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from codegen.native.trajectory import Array
from eom.errors import InputError, typed_fields

UNSEEN = 0.5
"""What shows between a method's own calls counts where it exceeds their range by this part of it, ..."""
SMALL = 0.02
"""... and by this part of the range met in the whole run."""
SAMPLES = 256
"""Times over the whole span at which functions are looked at beside the method's calls; and 8 a step."""
GOLDEN = 0.381966
FINEST = 1e-6
"""Shorter parts of the whole span are not looked into."""


@typed_fields
@dataclass(frozen=True)
class Signal:
    """An input as a function of time that states where it changes suddenly, and how fast it changes.

    ``function(t)``: a number, in the unit of the input; called from Python. ``knots``: times (s) at which
    it, or a derivative, jumps: steps end there, and the function is not looked at across them.
    ``max_step`` (s): the longest step over which nothing that it does is missed, about the width of its
    narrowest pulse. With one of the two the run trusts what is stated. Without both, as for a plain
    function, the function is sampled at further points within steps and nothing is guaranteed: a pulse
    between all of these is missed, and the run's ``notice`` says that this is possible.

    Raises `InputError` for what does not take one number, knots that are not finite, and a longest step
    that is not positive.

    >>> kick = Signal(lambda t: 5.0 if 2 <= t < 2.01 else 0.0, knots=(2, 2.01))
    >>> kick(2.005), kick.is_stated
    (5.0, True)
    """

    function: Callable[[float], float]
    knots: Sequence[float] | None = None
    max_step: float | None = None

    def __post_init__(self) -> None:
        _check_arity(self.function, "the function of a Signal")
        if self.knots is not None:
            object.__setattr__(self, "knots", _knots(self.knots))
        if self.max_step is not None:
            step = _number(self.max_step)
            if step is None or not step > 0:
                raise InputError("max_step of a Signal is not positive", got=self.max_step,
                                 expected="a time in s, for example the width of a pulse")  # fmt: skip

    def __call__(self, t: float) -> float:
        """Return the value at time ``t``."""
        return self.function(t)

    @property
    def is_stated(self) -> bool:
        """Whether it says anything of itself."""
        return self.knots is not None or self.max_step is not None


def _knots(given: Sequence[float]) -> tuple[float, ...]:
    try:
        times = [float(k) for k in given]
    except (TypeError, ValueError):
        times = [math.nan]
    if not all(map(math.isfinite, times)):
        raise InputError("knots of a Signal are not times", got=repr(given)[:200],
                         expected="finite numbers, in s")  # fmt: skip
    return tuple(sorted(set(times)))


def _check_arity(function: Any, where: str) -> None:
    """Raise `InputError` for what cannot be called with one number."""
    if not callable(function):
        raise InputError(f"{where} is not a function", got=repr(function)[:200],
                         expected="a function of time")  # fmt: skip
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):  # written in C, without a signature
        return
    try:
        signature.bind(0.0)
    except TypeError:
        raise InputError(f"{where} does not take the time alone", got=f"f{signature}",
                         expected="a function of one number, f(t)") from None  # fmt: skip


def _number(value: Any) -> float | None:
    """Return a real number as a float, or None for what is none."""
    if isinstance(value, str | bytes | complex | np.complexfloating) or np.ndim(value):
        return None
    try:
        return float(value)
    except (TypeError, ValueError):
        return None


def _further(t_old: float, t: float, span: float) -> Array:
    """Return times along a step, both ends among them, with no simple ratio; more of them in a long one."""
    count = 8 + int(SAMPLES * abs(t - t_old) / span)
    places = (np.arange(count) + GOLDEN) / count
    return np.concatenate([[t_old], t_old + (t - t_old) * places, [t]])


class Inputs:
    """All inputs of a run over time: held values, and functions that are called.

    ``knots``: times at which steps must end; ``max_step``: the longest step (s); ``blind``: names of
    functions that state nothing.
    """

    def __init__(
        self,
        held: Array,
        names: Sequence[str],
        functions: Mapping[str, Any],
        zero: tuple[float, ...] = (),
    ) -> None:
        """``zero``: the time of the functions at which that of the run is zero, as a sum."""
        for name, f in functions.items():
            _check_arity(f, f"input {name}")
        self.held, self.names, self._given = held, tuple(names), functions
        self.zero = zero
        self.functions = [(self.names.index(n), f) for n, f in functions.items()]
        signals = [f for f in functions.values() if isinstance(f, Signal)]
        knots = {k for f in signals for k in f.knots or ()}
        self.knots = sorted(math.fsum((k, *(-z for z in zero))) for k in knots)
        self.max_step = min(
            (f.max_step for f in signals if f.max_step is not None), default=math.inf
        )
        self.blind = tuple(n for n, f in functions.items() if not getattr(f, "is_stated", False))
        self._places = [k for k, f in self.functions if getattr(f, "knots", None) is None]
        self._calls: list[tuple[float, Array]] = []
        self._least = self._most = np.empty(0)

    def __call__(self, t: float) -> Array:
        """Return the values (m,) of all inputs at time ``t``. Raises `InputError` for what is no number."""
        now = self.held.copy()
        at = math.fsum((*self.zero, t)) if self.zero else t
        for k, function in self.functions:
            value = function(at)
            number = value if type(value) is float else _number(value)
            if number is None:
                raise InputError(
                    "an input does not return a number",
                    where=f"input {self.names[k]} at t = {at:.9g} s",
                    got=repr(value)[:200],
                    expected="a real number",
                )
            now[k] = number
        if self._places:
            self._calls.append((t, now[self._places]))
        return now

    def since(self, zero: tuple[float, ...]) -> Inputs:
        """Return the same over a time that is zero at ``zero``, a sum, which is rounded."""
        return Inputs(self.held, self.names, self._given, (*self.zero, *zero))

    def forget(self) -> None:
        """Take the next calls for the first ones of a run."""
        self._calls.clear()
        self._least = self._most = np.empty(0)

    def along(self, times: Array) -> Array:
        """Return the values (m, len(times)); these calls are not the method's own."""
        calls, self._calls = self._calls, []
        values = np.array([self(t) for t in times.tolist()]).reshape(len(times), len(self.held)).T
        self._calls = calls
        return values

    def hides(self, t_old: float, t: float, span: float) -> bool:
        """Return whether further values along a step show what the method's own calls in it did not."""
        if not self._places or abs(t - t_old) <= FINEST * span:
            self._calls.clear()
            return False
        low, high = min(t_old, t), max(t_old, t)
        own = [v for at, v in self._calls if low <= at <= high]
        more = self.along(_further(t_old, t, span))[self._places]
        own += [more[:, 0], more[:, -1]]
        least, most = np.min(own, axis=0), np.max(own, axis=0)
        if not self._least.size:
            self._least, self._most = least, most
        self._least, self._most = np.minimum(self._least, least), np.maximum(self._most, most)
        allowed = UNSEEN * (most - least) + SMALL * (self._most - self._least)
        allowed += 1e-9 * np.maximum(np.abs(self._least), np.abs(self._most))
        hidden = np.any((more.max(1) > most + allowed) | (more.min(1) < least - allowed))
        if not hidden:
            self._calls = [(t, more[:, -1])]
        return bool(hidden)

    @property
    def notice(self) -> str:
        """What the user should know of functions that were trusted blindly; empty if there are none."""
        if not self.blind:
            return ""
        names = " and ".join(self.blind)
        are = "is a Python function" if len(self.blind) == 1 else "are Python functions"
        return (
            f"{names} {are} that cannot be looked into: a pulse between the sampled times is missed; "
            "state its knots or longest step by codegen.Signal"
        )
