"""What integrators take and give: a `Problem` and a `Trajectory`, the same for all methods.

Dense output that is put together of steps.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


T = TypeVar("T")
_new, _put = object.__new__, object.__setattr__


def varied(value: T, **changes: Any) -> T:
    """Return a frozen value with fields changed: `dataclasses.replace` of classes that check nothing.

    Runs of a few microseconds are made of these; this takes a tenth of the time.
    """
    made = _new(type(value))
    _put(made, "__dict__", value.__dict__ | changes)
    return made


MAX_STEPS = 10_000_000
"""Steps that are tried unless more are asked for: a run that chatters ends."""


@dataclass(frozen=True)
class Filter:
    """Which zeros of an expression count: those of ``direction`` 1 up, -1 down, 0 all.

    At the ``terminal``-th of them the run ends, never if that is 0.
    """

    direction: int = 0
    terminal: int = 0


@dataclass(frozen=True)
class Found:
    """Zeros of the expressions of events, in order: times (K,), states (K, n), ``which`` (K,) event.

    ``direction`` (K,): 1 up, -1 down, 0 where zero is touched, in the direction of integration.
    """

    t: Array
    x: Array
    which: NDArray[np.int32]
    direction: NDArray[np.int32]


class Called(Protocol):
    """A law in Python: what gives a function f(t, x, out) of time (s) and states (n,) for each run."""

    def fresh(self) -> Callable[[float, Array, Array], None]:
        """Return the function for one run, which puts a value for each input of the law into ``out``."""
        ...

    def since(self, zero: tuple[float, ...]) -> Called:
        """Return the same over a time that is zero at ``zero``, a sum."""
        ...


@dataclass(frozen=True)
class Law:
    """A law that is evaluated with a ``period`` (s), the first time at the start of a run.

    Its values take effect ``whole`` periods and ``rest`` (s) later. ``applied``: numbers of the inputs that
    it sets, ``stepped``: of those that are its own states, which change at the sample itself. ``called``:
    the law in Python; None where it is generated, the next rows of the group of samples.
    """

    period: float
    whole: int
    rest: float
    applied: tuple[int, ...]
    stepped: tuple[int, ...] = ()
    called: Called | None = None

    @classmethod
    def of(cls, period: float, delay: float, applied: Sequence[int], **more: Any) -> Law:
        """Return a law with a ``delay`` (s); one of whole periods but for rounding ends at samples."""
        periods = delay / period
        whole = round(periods)
        if abs(periods - whole) > 4 * math.ulp(max(periods, 1.0)):
            whole = math.floor(periods)
            return cls(period, whole, delay - whole * period, tuple(applied), **more)
        return cls(period, whole, 0.0, tuple(applied), **more)

    def time(self, start: float, k: int) -> float:
        """Return the time of sample ``k`` of a run since ``start``, rounded twice."""
        return start + k * self.period

    def effect(self, start: float, k: int) -> float:
        """Return the time at which the values of sample ``k`` take effect."""
        return self.time(start, k + self.whole) + self.rest


@dataclass(frozen=True)
class Held:
    """What inputs were held at: ``u`` (K, m) from the times ``t`` (K,) on, the first of them the start."""

    t: Array
    u: Array

    def at(self, times: Array) -> Array:
        """Return the inputs (m, N) at times (N,), where they change those from there on."""
        rows = np.searchsorted(self.t, times, side="right") - 1
        return np.ascontiguousarray(self.u[np.maximum(rows, 0)].T)


@dataclass(frozen=True)
class Problem:
    """An initial value problem with everything checked.

    ``inputs``: values at which the inputs are held. ``margin``: distance from a singularity at
    which to stop. ``t_eval``: times to store in the direction of integration, or None for every
    step. ``project``: names of the invariants that the states are brought back onto after each
    step. ``progress(fraction)``: called now and then. ``watch(t, x, h)``: called after every
    ``watch_every`` tried steps with the state and the last step; the run ends where it is true.
    """

    x0: Array
    t_span: tuple[float, float]
    parameters: Array
    inputs: Array
    rtol: float
    atol: Array
    margin: float
    singularities: int
    t_eval: Array | None = None
    dense_output: bool = False
    first_step: float | None = None
    max_step: float = math.inf
    max_steps: int = MAX_STEPS
    project: tuple[str, ...] = ()
    progress: Callable[[float], None] | None = None
    watch: Callable[[float, Array, float], bool] | None = None
    watch_every: int = 1
    events: tuple[Filter, ...] = ()
    """What is looked for at zeros of expressions: by number, as their loop has them."""
    laws: tuple[Law, ...] = ()
    """What sets inputs at samples; ``inputs`` are those before the first one."""
    start: float = 0.0
    """Time that stands as zero: all times are since then."""

    def time_text(self, t: float, digits: int = 9) -> str:
        """Return a time as text, with its unit: all digits where the run starts late."""
        return f"{self.start + t!r} s" if self.start else f"{t:.{digits}g} s"

    def report(self, t: float) -> None:
        """Report the progress at time ``t``."""
        if self.progress is not None:
            start, end = self.t_span
            self.progress(min(1.0, max(0.0, (t - start) / (end - start))))


@dataclass(frozen=True)
class Stop:
    """Why and when a run stopped.

    Parameters
    ----------
    kind : str
        ``end``, ``singular``, ``event``, ``not finite``, ``step``, ``coarse``, ``thin``,
        ``max_steps``, ``memory`` or ``left``, where the run's ``watch`` says so.
    t : float
        The time, in the unit of the system (s).
    which : int, default -1
        Number of the singularity, of the event, or of the state that is not finite; -1 for none.
    overflows : bool, default False
        Whether the rates are finite there, and further Taylor coefficients are not, so that no
        series says how the solution goes on.
    """

    kind: str
    t: float
    which: int = -1
    overflows: bool = False


@dataclass(frozen=True)
class Trajectory:
    """Times (N,), states (n, N), how the run stopped, and what it cost.

    ``seconds``: of the integration alone, where generated code does all of it; else None.
    """

    t: Array
    y: Array
    stop: Stop
    state_at_stop: Array
    closest: tuple[float, ...]
    """Least distance from each singularity over all steps."""
    evaluations: int
    steps: int
    rejected: int
    solution: Any = None
    seconds: float | None = None
    method: str = ""
    """What integrated, where that was found out on the way."""
    why: str = ""
    """Why that was chosen."""
    notice: str = ""
    """What the user should know of the run."""
    methods: tuple[str, ...] = ()
    """Names of the methods that were chosen, in order."""
    found: Found | None = None
    """Events, where a problem has some."""
    passed: bool = False
    """Whether a method went on where another was stuck and the rates may be singular."""
    held: Held | None = None
    """What inputs were held at, where laws are sampled."""


class Stepwise(ABC):
    """The interpolant of a whole run: ``sol(t)`` has shape (n,) or (n, len(t)), as SciPy's.

    ``t`` (N + 1,): ends of the steps; ``h`` (N,): their lengths; ``x`` (N + 1, n): states at the ends;
    ``rows``: what is kept of each step.
    """

    def __init__(self, t: Array, h: Array, x: Array, rows: Array) -> None:
        self.ts = t
        self.t_min, self.t_max = min(t[0], t[-1]), max(t[0], t[-1])
        self._h, self._x, self._rows = h, x, rows

    def __call__(self, t: float | Sequence[float] | Array) -> Array:
        """Evaluate; times outside the run are extrapolated from the nearest step."""
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        count = len(self._rows)
        if not count:
            values = np.repeat(self._x[:1], len(times), axis=0)
        else:
            forward = self.ts[-1] >= self.ts[0]
            nodes, wanted = (self.ts, times) if forward else (-self.ts, -times)
            k = np.clip(np.searchsorted(nodes, wanted, side="left") - 1, 0, count - 1)
            values = self._within(k, times - self.ts[k])
        return values[0] if np.ndim(t) == 0 else values.T

    @abstractmethod
    def _within(self, k: NDArray[np.intp], since: Array) -> Array:
        """Return the states (len(k), n) in the steps ``k``, at times ``since`` their starts."""


def pointer(array: Array) -> int | None:
    """Return where C finds the numbers of an array, None where there are none."""
    return array.ctypes.data if array.size else None


def doubled(array: Array) -> Array:
    """Return an array with the same rows, and room for as many more."""
    larger = np.empty((2 * len(array), *array.shape[1:]))
    larger[: len(array)] = array
    return larger
