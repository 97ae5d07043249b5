"""The data of an explicit Runge-Kutta method with an embedded error estimate and dense output."""

from __future__ import annotations

from dataclasses import dataclass

Row = tuple[float, ...]


@dataclass(frozen=True)
class Tableau:
    """Coefficients in the order in which stages are computed.

    ``stages[s]`` weighs the slopes before stage s; row ``main_stages`` gives the new state, whose
    slope is the next stage; the rows after it serve dense output alone. ``error_high`` weighs the
    slopes for the error estimate, ``error_low`` for a second one that the first is divided by
    (Hairer, Norsett and Wanner, sect. II.10), empty where there is one alone; ``dense`` for the last
    coefficients of the interpolant. Steps are chosen as if the estimate were of order ``order``.
    """

    name: str
    order: int
    nodes: Row
    stages: tuple[Row, ...]
    main_stages: int
    error_high: Row
    dense: tuple[Row, ...]
    error_low: Row = ()

    @property
    def dense_terms(self) -> int:
        """Number of coefficients a state of the interpolant, the three of a cubic included."""
        return 3 + len(self.dense)
