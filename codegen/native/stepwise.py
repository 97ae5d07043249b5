"""Dense output that is put together of steps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from codegen.native.trajectory import Array


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
