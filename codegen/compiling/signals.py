"""Inputs that are Python functions of time and state: what they state, and how a run calls them."""

from __future__ import annotations

import contextlib
import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from codegen.native.trajectory import Array
from eom.errors import InputError, typed_fields, unknown_name

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

    Parameters
    ----------
    function : callable
        Of the time, f(t), or of time and states, f(t, x), as of `codegen.simulate`; it returns a
        number, in the unit of the input, and is called from Python.
    knots : sequence of floats, optional
        Times (s) at which it, or a derivative, jumps: steps end there, and the function is not
        looked at across them.
    max_step : float, optional
        The longest step (s) over which nothing that it does is missed, about the width of its
        narrowest pulse.

    Raises
    ------
    InputError
        For what takes neither, knots that are not finite, and a longest step that is not positive.

    Notes
    -----
    With one of the two the run trusts what is stated. Without both, as for a plain function, the
    function is sampled at further points within steps and nothing is guaranteed: a pulse between
    all of these is missed, and the run's ``notice`` says that this is possible.

    Examples
    --------
    >>> kick = Signal(lambda t: 5.0 if 2 <= t < 2.01 else 0.0, knots=(2, 2.01))
    >>> kick(2.005), kick.is_stated
    (5.0, True)
    """

    function: Callable[..., float]
    knots: Sequence[float] | None = None
    max_step: float | None = None

    def __post_init__(self) -> None:
        reads_state(self.function, "the function of a Signal")
        if self.knots is not None:
            object.__setattr__(self, "knots", _knots(self.knots))
        if self.max_step is not None:
            step = _number(self.max_step)
            if step is None or not step > 0:
                raise InputError("max_step of a Signal is not positive", got=self.max_step,
                                 expected="a time in s, for example the width of a pulse")  # fmt: skip

    def __call__(self, t: float, *x: Mapping[str, float]) -> float:
        """Return the value at a time.

        Parameters
        ----------
        t : float
            In seconds.
        x : mapping of str to floats
            The states by name, where the function takes them.

        Returns
        -------
        float
            In the unit of the input.
        """
        return self.function(t, *x)

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


def reads_state(function: Any, where: str) -> bool:
    """Return whether a function takes time and states, f(t, x), and not the time alone, f(t).

    Its signature decides: what can be called with one argument is f(t), whatever has a default beside it.
    Raises `InputError` for what is neither.
    """
    function = function.function if isinstance(function, Signal) else function
    if not callable(function):
        raise InputError(f"{where} is not a function", got=repr(function)[:200],
                         expected="a function of time, or of time and states")  # fmt: skip
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):  # written in C, without a signature
        return False
    for taken in (1, 2):
        with contextlib.suppress(TypeError):
            signature.bind(*[0.0] * taken)
            return taken == 2
    raise InputError(f"{where} takes neither the time alone nor time and states",
                     got=f"f{signature}", expected="f(t) or f(t, x)")  # fmt: skip


class State(dict[str, float]):
    """The states by name, in their order, as a function of an input gets them."""

    def __missing__(self, name: str) -> float:
        """Raise `InputError` for what is no state."""
        raise unknown_name("state", str(name), [*self], "a function of an input")


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


Given = Mapping[str, Any] | Callable[..., Any]


class Followed(Protocol):
    """Inputs that change along a run."""

    def along(self, times: Array, states: Array) -> Array:
        """Return values (m, K) at times (K,) in ``states`` (n, K)."""
        ...


class Inputs:
    """All inputs of a run over time and states: held values, and functions that are called.

    ``knots``: times at which steps must end; ``max_step``: the longest step (s); ``blind``: names of
    functions that state nothing; ``of_state``: whether one reads the states.
    """

    def __init__(
        self,
        held: Array,
        names: Sequence[str],
        given: Given,
        states: Sequence[str],
        zero: tuple[float, ...] = (),
        watched: bool = True,
    ) -> None:
        """``given``: functions by name, or one of all inputs; ``states``: names, in order.

        ``zero``: the time of the functions at which that of the run is zero, as a sum. ``watched``: whether
        what they give is remembered for `hides`.
        """
        self.held, self.names, self.states, self._given = held, tuple(names), tuple(states), given
        self.zero, self.all = zero, given if callable(given) else None
        functions = dict.fromkeys(self.names, given) if callable(given) else given
        reads = {n: reads_state(f, f"input {n}") for n, f in functions.items()}
        self.of_state, self._all_reads = any(reads.values()), all(reads.values())
        own = {} if callable(given) else functions
        self.functions = [(self.names.index(n), f, reads[n]) for n, f in own.items()]
        signals = [f for f in functions.values() if isinstance(f, Signal)]
        knots = {k for f in signals for k in f.knots or ()}
        self.knots = sorted(math.fsum((k, *(-z for z in zero))) for k in knots)
        self.max_step = min(
            (f.max_step for f in signals if f.max_step is not None), default=math.inf
        )
        self.blind = tuple(n for n, f in functions.items() if not getattr(f, "is_stated", False))
        self._places = [
            self.names.index(n)
            for n, f in functions.items()
            if watched and getattr(f, "knots", None) is None
        ]
        self._calls: list[tuple[float, Array]] = []
        self._least = self._most = np.empty(0)

    def __call__(self, t: float, x: Array) -> Array:
        """Return the values (m,) of all inputs at time ``t`` in the state ``x`` (n,).

        Raises `InputError` for what is no number.
        """
        at = math.fsum((*self.zero, t)) if self.zero else t
        state = State(zip(self.states, x.tolist(), strict=True)) if self.of_state else None
        if self.all is not None:
            now = self._of_all(at, self.all(at, state) if self._all_reads else self.all(at))
        else:
            now = self.held.copy()
            for k, function, reads in self.functions:
                value = function(at, state) if reads else function(at)
                now[k] = value if type(value) is float else self._as_number(value, k, at)
        if self._places:
            self._calls.append((t, now[self._places]))
        return now

    def single(self, t: float, x: Array, out: Array) -> None:
        """Put the value of the only function into ``out``, as a call does with less around it."""
        k, function, reads = self.functions[0]
        at = math.fsum((*self.zero, t)) if self.zero else t
        state = (State(zip(self.states, x.tolist(), strict=True)),) if reads else ()
        value = function(at, *state)
        out[0] = value if type(value) is float else self._as_number(value, k, at)

    def _as_number(self, value: Any, k: int, at: float) -> float:
        number = _number(value)
        if number is None:
            raise InputError(
                "an input does not return a number",
                where=f"input {self.names[k]} at t = {at:.9g} s",
                got=repr(value)[:200],
                expected="a real number",
            )
        return number

    def _of_all(self, at: float, values: Any) -> Array:
        """Return what one function of all inputs gave, by name or in order, in order."""
        where = f"the function of all inputs at t = {at:.9g} s"
        listed = values if np.ndim(values) == 1 else None
        if isinstance(values, Mapping):
            for name in values:
                if name not in self.names:
                    raise unknown_name("input", str(name), self.names, where)
            listed = [values.get(n) for n in self.names]
        if listed is None or len(listed) != len(self.names):
            raise InputError("not a value for each input", where=where, got=repr(values)[:200],
                             expected=f"{', '.join(self.names)}, by name or in order",
                             hint=f'a function of one: inputs={{"{self.names[0]}": f}}')  # fmt: skip
        return np.array([self._as_number(v, k, at) for k, v in enumerate(listed)])

    def over(self, held: Array) -> Inputs:
        """Return the same beside other held values (m,), which may change on the way."""
        return Inputs(held, self.names, self._given, self.states, self.zero)

    def since(self, zero: tuple[float, ...]) -> Inputs:
        """Return the same over a time that is zero at ``zero``, a sum, which is rounded."""
        return Inputs(self.held, self.names, self._given, self.states, (*self.zero, *zero))

    def forget(self) -> None:
        """Take the next calls for the first ones of a run."""
        self._calls.clear()
        self._least = self._most = np.empty(0)

    def along(self, times: Array, states: Array) -> Array:
        """Return values (m, K) at times (K,) in ``states`` (n, K); no call counts as the method's own."""
        calls, self._calls = self._calls, []
        found = [self(t, x) for t, x in zip(times.tolist(), states.T, strict=True)]
        values = np.array(found).reshape(len(times), len(self.held)).T
        self._calls = calls
        return values

    def hides(self, t_old: float, t: float, span: float, dense: Callable[[Array], Array]) -> bool:
        """Return whether further values along a step show what the method's own calls in it did not.

        ``dense``: the states (n, K) at times (K,) of the step.
        """
        if not self._places or abs(t - t_old) <= FINEST * span:
            self._calls.clear()
            return False
        low, high = min(t_old, t), max(t_old, t)
        own = [v for at, v in self._calls if low <= at <= high]
        times = _further(t_old, t, span)
        more = self.along(times, np.asarray(dense(times)))[self._places]
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
            f"{names} {are} that cannot be looked into: a pulse between the sampled times is missed"
            f"{self._in_state}; state its knots or longest step by codegen.Signal"
        )

    @property
    def _in_state(self) -> str:
        return ", and how smooth it is in the states is not known" if self.of_state else ""
