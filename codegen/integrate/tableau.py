"""The data of an explicit Runge-Kutta method with an embedded error estimate and dense output."""

from __future__ import annotations

from dataclasses import dataclass

Row = tuple[float, ...]


@dataclass(frozen=True)
class Tableau:
    """Coefficients in the order in which stages are computed.

    ``stages[s]`` weighs the slopes before stage s; row ``main_stages`` gives the new state, whose
    slope is the next stage; the rows after it serve dense output alone. ``error_high`` and
    ``error_low`` weigh the slopes for the two error estimates (Hairer, Norsett and Wanner, sect.
    II.10); ``dense`` for the last coefficients of the interpolant.
    """

    name: str
    order: int
    nodes: Row
    stages: tuple[Row, ...]
    main_stages: int
    error_high: Row
    error_low: Row
    dense: tuple[Row, ...]

    @property
    def dense_terms(self) -> int:
        """Number of coefficients a state of the interpolant, the three of a cubic included."""
        return 3 + len(self.dense)
