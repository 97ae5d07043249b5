"""What a method finds: parts of the equations, each with where it comes from."""

from __future__ import annotations

from dataclasses import dataclass

from eom.multibody.closed.polynomials import Scalar


@dataclass(frozen=True)
class Contribution:
    """A part of one equation.

    ``row``: number of the equation. ``source``: motion (mass times acceleration), gravity, spring,
    damper, which stand on the left, or applied, on the right. ``label``: the step that it comes from.
    """

    row: int
    source: str
    label: str
    value: Scalar
