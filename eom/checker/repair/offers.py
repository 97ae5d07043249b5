"""What rules of slips take and give: what a note writes with, and what may have been meant."""

from __future__ import annotations

from dataclasses import dataclass

from eom.checker.read.syntax import Node

Offer = tuple[Node, float]
"""What may have been meant, and what is added to the weight of the slip."""


@dataclass(frozen=True)
class Palette:
    """What a note writes with: symbols and labels that may have been meant, the closest first.

    ``marks``: raised marks that are derivatives; ``skew``: accents of skew matrices; ``labels``: rows of
    labels that may stand for each other (points, frames, axes, indices); ``frames``: of derivatives;
    ``factors``: of the line itself; ``near``: others that stand around it; ``vectors``: of the line and
    around it; ``omegas``: angular velocities.
    """

    symbols: tuple[Node, ...] = ()
    factors: tuple[Node, ...] = ()
    near: tuple[Node, ...] = ()
    vectors: tuple[Node, ...] = ()
    omegas: tuple[Node, ...] = ()
    labels: tuple[tuple[Node, ...], ...] = ()
    frames: tuple[Node, ...] = ()
    marks: tuple[str, ...] = ()
    skew: tuple[str, ...] = ()
