"""The accuracy card: what was measured of each result, as frozen data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from codegen.ir.groups import RATES
from codegen.ir.interpret import UNIT_ROUNDOFF
from codegen.precision.domain import REGIONS, Range
from eom.errors import InputError

ALL_DIGITS = 1 / UNIT_ROUNDOFF
"""Ulps from which on no digit is right."""

EXACT, ACCURATE, ILL, UNSTABLE = "exact", "accurate", "ill-conditioned", "unstable"
UNDERFLOWS, OVERFLOWS, NOT_A_NUMBER = "underflows", "overflows", "not a number"
VERDICTS = (EXACT, ACCURATE, ILL, UNDERFLOWS, OVERFLOWS, NOT_A_NUMBER, UNSTABLE)
"""From the best to the worst."""


@dataclass(frozen=True)
class Cause:
    """What a result owes its error to.

    ``formula``: where digits are lost, as text; ``digits``: how many; ``share``: of the error that comes
    from there. ``operands``, ``value``: the numbers that meet there, and what they give.
    """

    formula: str
    digits: float
    share: float
    operands: tuple[float, ...]
    value: float


@dataclass(frozen=True)
class Finding:
    """One result at one point.

    ``at``: values by name; ``how`` the point was made. ``value``: what was computed, ``exact``: the same
    with 50 digits, rounded. ``ulps``: the error, in units in the last place of the exact value;
    ``bound``: that which running error analysis allows, in ulps. ``condition``: the condition number.
    ``verdict``: one of `VERDICTS`. ``cause``: of the error, where it was looked for.
    """

    at: Mapping[str, float]
    how: str
    value: float
    exact: float
    ulps: float
    bound: float
    condition: float
    verdict: str
    cause: Cause | None


@dataclass(frozen=True)
class Row:
    """One result in one region.

    ``group``, ``result``, ``region``: their names. ``operations``: of the result. ``points``: how many
    were compared; ``typical``: the median error in ulps; ``worst``: where the error is largest;
    ``judged``: where it is largest against what condition and operations allow; ``failed``: the first
    point with an infinity or NaN for a finite value.
    """

    group: str
    result: str
    region: str
    points: int
    operations: int
    typical: float
    worst: Finding | None
    judged: Finding | None
    failed: Finding | None

    @property
    def verdict(self) -> str:
        """The worst verdict of the points that are kept."""
        kept = [f.verdict for f in (self.worst, self.judged, self.failed) if f is not None]
        return max(kept, key=VERDICTS.index, default=EXACT)


@dataclass(frozen=True)
class Gain:
    """Where a rewriting makes most difference to a result.

    ``group``, ``result``, ``region``: their names. ``at``: values by name. ``before``, ``after``: the
    error in ulps without and with it.
    """

    group: str
    result: str
    region: str
    at: Mapping[str, float]
    before: float
    after: float


@dataclass(frozen=True)
class Change:
    """A rewriting of formulas.

    ``identities``: (identity, formula that it replaces), in order. ``gains``: what results gain by it.
    """

    identities: tuple[tuple[str, str], ...]
    gains: tuple[Gain, ...]


@dataclass(frozen=True)
class Card:
    """What was measured of a compiled system: the error of each result against 50 digits.

    ``system``, ``target``, ``stable``: what was measured. ``samples``, ``seed``: as of
    `codegen.accuracy`. ``domain``: (low, high) by name, in the units of the system; ``unit``: names of
    states that are one unit quaternion. ``rows``: one a result and region. ``made``: a rewriting of this
    code; ``possible``: one that ``stable=True`` would add. Errors are in units in the last place (ulps).
    Source: Higham, Accuracy and Stability of Numerical Algorithms (2002), sect. 1.6.
    """

    system: str
    target: str
    stable: bool
    samples: int
    seed: int
    domain: Mapping[str, Range]
    unit: tuple[tuple[str, ...], ...]
    rows: tuple[Row, ...] = field(repr=False)
    made: Change
    possible: Change

    def row(self, result: str, region: str = REGIONS[0], group: str = RATES) -> Row:
        """Return the row of a ``result`` in a ``region``, of a ``group``: rates, outputs or invariants.

        ``region``: domain, zero, singular or extreme. Raises `InputError` where there is none.
        """
        for row in self.rows:
            if (row.group, row.result, row.region) == (group, result, region):
                return row
        raise InputError(
            "no such row on the accuracy card",
            got=f"{group}, {result}, {region}",
            expected="; ".join(sorted({f"{r.group}, {r.result}" for r in self.rows})),
        )

    @property
    def unstable(self) -> tuple[Row, ...]:
        """Rows whose formula loses digits that the arguments do not."""
        return tuple(r for r in self.rows if r.verdict == UNSTABLE)
