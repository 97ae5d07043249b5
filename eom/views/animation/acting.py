"""Forces and torques on the bodies of a tree over time, from what the equations of motion are made of.

Components are in the ground's axes; which vectors there are, and on which body: see
`eom.multibody.system.vectors`. Reactions of joints are not drawn.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

import numpy as np

from eom.errors import InputError
from eom.multibody.model.model import Tree
from eom.multibody.system.vectors import (
    CONSTRAINT,
    FORCE,
    GRADIENT,
    JET,
    JOINT,
    LOAD,
    MOMENTUM,
    OMEGA,
    REACTION,
    ROTOR,
    SPRING,
    TORQUE,
    UNITS,
    WEIGHT,
    Arrow,
    Moment,
    VectorOf,
    vectors_of,
)
from eom.views.animation.posture import filled
from eom.views.animation.tracks import Acting
from eom.views.draw.formulas import name

MOST = 48
"""Arrows at most: loads come first, weights last."""
LETTERS = {
    (LOAD, FORCE): "F", (LOAD, TORQUE): r"\tau", (JET, FORCE): "F", (JOINT, FORCE): "F",
    (JOINT, TORQUE): r"\tau", (SPRING, FORCE): "F", (ROTOR, TORQUE): r"\tau", (CONSTRAINT, FORCE): "R",
    (CONSTRAINT, TORQUE): r"\tau", (GRADIENT, TORQUE): r"\tau", (REACTION, FORCE): "R",
}  # fmt: skip
"""Letters of what acts; its part of the tree is the index."""


class Style(NamedTuple):
    """How vectors are drawn that are hidden and shown together: unit, colour, and what they are."""

    unit: str
    colour: str
    words: str


STYLES = {
    "omega": Style("rad/s", "red", r"$\omega$, angular velocity"),
    "momentum": Style("N m s", "purple", "$H$, angular momentum"),
    "torque": Style("N m", "green", r"$\tau$, torque"),
    "force": Style("N", "blue", "$F$, force"),
    "reaction": Style("N", "orange", "$R$, reaction"),
    "joint": Style("N", "grey", "$R$, reaction in a joint"),
    "weight": Style("N", "sky", "$m g$, weight"),
}
"""What is drawn alike; reactions are those of constraints, and of the fixed point of one body."""
FEW = {"joint": 3}
MANY = 8
"""Vectors of one kind that are seen at first, at most."""
MOVES = {OMEGA: r"\omega", MOMENTUM: "H"}
GROUPS = {
    (LOAD, FORCE): "force", (JET, FORCE): "force", (JOINT, FORCE): "force", (SPRING, FORCE): "force",
    (CONSTRAINT, FORCE): "reaction", (WEIGHT, FORCE): "weight", (REACTION, FORCE): "joint",
}  # fmt: skip
"""What is drawn alike, and hidden and shown together, beside torques."""


def acting(tree: Tree, moment: Moment, count: int) -> tuple[Acting, ...]:
    """Return what acts on the bodies of a tree at ``count`` times. What is always zero is left out."""
    return tuple(islice(_acting(tree, moment, count), MOST))


def _acting(tree: Tree, moment: Moment, count: int) -> Iterator[Acting]:
    for vector in vectors_of(tree):
        found = _at(vector, moment) if UNITS[vector.kind] in {"N", "N m"} else None
        if found is not None:
            values, places = (filled(list(v), count) for v in found)
            if np.any(values) and np.all(np.isfinite(values)):
                yield Acting(group(vector), label(vector), words(vector), values, places)


def _at(vector: VectorOf, moment: Moment) -> Arrow | None:
    """Return a vector; no reactions where joints alone, without constraints, would move nothing."""
    try:
        with np.errstate(all="ignore"):
            return vector.at(moment)
    except InputError:
        if vector.source == REACTION:
            return None
        raise


def is_seen(kind: str, count: int) -> bool:
    """Return whether so many vectors of a kind, a key of `STYLES`, are seen at first."""
    return count <= FEW.get(kind, MANY)


def group(vector: VectorOf) -> str:
    """Return what a vector is shown and hidden with: a key of `STYLES`."""
    return GROUPS.get((vector.source, vector.kind), vector.kind)


def label(vector: VectorOf) -> str:
    r"""Return what stands at a vector, a formula: $F_{spring}$."""
    index = name(vector.name).strip("$")
    if vector.kind in MOVES:
        return f"${MOVES[vector.kind]}_{{{index}}}$" if index else f"${MOVES[vector.kind]}$"
    if vector.source == WEIGHT:
        return rf"$m_{{{index}}}\,g$"
    return f"${LETTERS[vector.source, vector.kind]}_{{{index}}}$"


def words(vector: VectorOf) -> str:
    """Return what a vector comes from, and what it acts on: spring s on rod."""
    if vector.kind in MOVES:
        whole = "angular momentum about the centre of mass of all"
        return f"angular velocity of {vector.body}" if vector.body else whole
    if vector.name == vector.body and vector.source != REACTION:
        return f"{vector.source} on {vector.body}"
    return f"{vector.source} {vector.name} on {vector.body}"
