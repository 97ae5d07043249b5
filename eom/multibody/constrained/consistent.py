"""Consistent start values: coordinates that meet the constraints, then speeds that do."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from eom.errors import InputError, typed, unknown_name
from eom.multibody.constrained.dependence import (
    Closed,
    Geometry,
    Linear,
    Row,
    Sample,
    closed,
    examine,
    has_quaternion,
    independent_rows,
    not_met,
    solved,
)
from eom.multibody.model.model import Tree
from eom.multibody.model.names import symbols_of
from eom.quantities import TIME
from eom.system import System

NOTABLE = 1e-12
"""Changes, relative to the size of a value (1 at least), that are reported."""


@dataclass(frozen=True)
class Assembly:
    """Consistent values by name, of all coordinates and speeds, and how they differ from those given.

    Parameters
    ----------
    values : mapping of str to floats
        Coordinates (rad, m) and speeds (rad/s, m/s) by name.
    changes : mapping of str to floats
        Those that were changed notably, by how much.
    turns : int
        Of Newton's iteration.
    left : float
        The largest constraint that is left (m or 1).
    """

    values: Mapping[str, float]
    changes: Mapping[str, float]
    turns: int
    left: float

    def __str__(self) -> str:
        """Say what was changed."""
        if not self.changes:
            return "start values meet the constraints as they are"
        changes = ", ".join(f"{name} by {x:.6g}" for name, x in self.changes.items())
        return f"changed: {changes}"

    def start(self, system: System) -> dict[str, float]:
        """Return the values of the states of a ``system``, by name.

        Parameters
        ----------
        system : System
            Of the tree that was assembled.

        Returns
        -------
        dict of str to floats
            The values of its states, by name, in SI units.
        """
        return {name: self.values[name] for name in system.state_names}


@typed
def assemble(
    tree: Tree,
    values: Mapping[str, float],
    *,
    weights: Mapping[str, float] | None = None,
    keep: Collection[str] = (),
    time: float = 0.0,
) -> Assembly:
    """Return start values that meet the constraints, from approximate ones.

    Parameters
    ----------
    tree : Tree
        With constraints.
    values : mapping of str to floats
        Numbers by name, of parameters and of coordinates and speeds; of these zero where left out,
        for a quaternion the unit.
    weights : mapping of str to floats, optional
        By name of a speed; what has a larger one changes less, and so does its coordinate (1 unless
        given).
    keep : collection of str, optional
        Names of speeds, or of coordinates whose rate is a speed, that must not change.
    time : float, default 0.0
        At which prescribed motions and constraints are taken (s).

    Returns
    -------
    Assembly
        Start values that meet the constraints, and by how much each was changed. In SI units.

    Raises
    ------
    InputError
        For unknown names, where no configuration is found near the values, where constraints meet
        with the wrong side (an axis turned round), and in singular configurations.

    Notes
    -----
    Coordinates change least in each turn of Newton's iteration; of all speeds that meet the
    constraints there, the nearest are returned.

    References
    ----------
    Newton's method with steps of least size, Ben-Israel, J. Math. Anal. Appl. 15 (1966) 243.

    Examples
    --------
    >>> from eom.multibody import Body, Distance, Joint
    >>> bead = Body("bead", mass=1, inertia=(1, 1, 1))
    >>> rod = Distance("rod", "ground", "bead", 2)
    >>> tree = Tree("rod", (bead,), (Joint("free", "free", "ground", "bead"),), constraints=(rod,))
    >>> print(assemble(tree, {"x_free": 1.0, "v_free_1": 3.0, "v_free_2": 1.0}))
    changed: x_free by 1, v_free_1 by -3
    """
    geometry, q, u = _given(tree, values, time)
    mobility = _mobility(tree, weights or {}, keep)
    found = closed(geometry, q, mobility[0])
    if not found.met:
        raise not_met(tree, found)
    _upright(found)
    _regular(tree, values, Sample(geometry, found))
    speeds = _speeds(Sample(geometry, found), u, mobility[1])
    names = [*(c.name for j in tree.ordered for c in j.coordinates),
             *(s.name for j in tree.ordered for s in j.speeds)]  # fmt: skip
    before, after = [*geometry.completed(q), *u], [*found.q, *speeds]
    changes = {
        n: b - a
        for n, a, b in zip(names, before, after, strict=True)
        if abs(b - a) > NOTABLE * max(1.0, abs(a))
    }
    everything = dict(zip(names, after, strict=True))
    return Assembly(everything, changes, found.turns, found.at.left)


def _given(tree: Tree, values: Mapping[str, float], time: float) -> tuple[Geometry, Row, Row]:
    """Return the geometry with numbers, coordinates and speeds as they are given."""
    coordinates = [c.name for j in tree.ordered for c in j.coordinates]
    speeds = [s.name for j in tree.ordered for s in j.speeds]
    for name, x in values.items():
        if not math.isfinite(x):
            raise InputError(
                "not a finite number", where=f"tree {tree.name!r}: value of {name}", got=x
            )
    moving = {*coordinates, *speeds}
    symbols = symbols_of(tree)
    allowed = {*moving, *map(str, symbols)}
    for name in values:
        if name not in allowed:
            raise unknown_name("name", name, sorted(allowed), f"tree {tree.name!r}")
    known: dict[Any, float] = {s: float(values[str(s)]) for s in symbols if str(s) in values}
    geometry = Geometry.of(tree, {**known, TIME: time})
    units = {j.coordinates[-4].name for j in tree.joints if has_quaternion(j)}
    q = [float(values.get(c, float(c in units))) for c in coordinates]
    return geometry, q, [float(values.get(s, 0.0)) for s in speeds]


def _mobility(tree: Tree, weights: Mapping[str, float], keep: Collection[str]) -> tuple[Row, Row]:
    """Return how freely coordinates and speeds change, one number a speed."""
    known = {s.name for j in tree.joints for s in j.speeds}
    allowed = known | {name for name, _ in _paired(tree)}
    for name in (*weights, *keep):
        if name not in (known if name in weights else allowed):
            raise unknown_name("speed or coordinate", name, sorted(allowed), "weights and keep")
    for name, x in weights.items():
        if not x > 0:
            raise InputError("the weight is not positive", where=f"weight of {name}", got=x)
    held = {s for c, s in _paired(tree) if c in keep}
    names = [s.name for j in tree.ordered for s in j.speeds]
    free = [1.0 / weights.get(name, 1.0) for name in names]
    return (
        [0.0 if name in held else x for name, x in zip(names, free, strict=True)],
        [0.0 if name in keep else x for name, x in zip(names, free, strict=True)],
    )


def _paired(tree: Tree) -> Iterable[tuple[str, str]]:
    """Yield the names of coordinates, with those of the speeds that are their rates."""
    for joint in tree.ordered:
        for k, c in enumerate(joint.row.paired(joint.attitude)):
            if c is not None:
                yield joint.coordinates[c].name, joint.speeds[k].name


def _upright(found: Closed) -> None:
    """Raise `InputError` where an axis meets its partner turned round: the equations allow that."""
    for c in found.at.components:
        side = c.relation.side()
        if side is not None and side < 0:
            raise InputError(
                "the joint that closes the loop is turned round: its axes are opposite",
                where=f"constraint {c.constraint!r}",
                hint="give start values nearer to the assembled configuration",
            )


def _regular(tree: Tree, values: Mapping[str, float], sample: Sample) -> None:
    """Raise `InputError` where fewer constraints are independent than elsewhere."""
    here = independent_rows(sample)
    usual = examine(tree, values).kept
    if len(here) < len(usual):
        parts = sample.found.at.components
        raise InputError(
            "singular configuration: constraints are dependent here that are independent elsewhere",
            where=f"tree {tree.name!r}",
            got=", ".join(parts[k].name for k in usual if k not in here),
            hint="start from another configuration; what follows from here is not determined",
        )


def _speeds(sample: Sample, u: Row, mobility: Row) -> Row:
    """Return the speeds nearest to ``u`` that meet the constraints."""
    geometry, found = sample.geometry, sample.found
    kept = independent_rows(sample)
    driven = geometry.driven_speeds()
    start = [driven.get(k, x) for k, x in enumerate(u)]
    at: Linear = found.at
    free = [k for k in geometry.free if mobility[k]]
    rows = [[at.rows[i][k] * mobility[k] for k in free] for i in kept]
    left = [-at.offsets[i] - math.fsum(a * b for a, b in zip(at.rows[i], start, strict=True))
            for i in range(len(at.rows))]  # fmt: skip
    gram = [[math.fsum(a * b for a, b in zip(x, y, strict=True)) for y in rows] for x in rows]
    try:
        y = solved(gram, [left[i] for i in kept])
    except ZeroDivisionError:
        y = [math.nan]
    result = list(start)
    for n, k in enumerate(free):
        result[k] += mobility[k] * math.fsum(row[n] * x for row, x in zip(rows, y, strict=False))
    size = max(1.0, *map(abs, result))
    for i, row in enumerate(at.rows):
        rest = at.offsets[i] + math.fsum(a * b for a, b in zip(row, result, strict=True))
        if not abs(rest) <= 1e-9 * size * max(1.0, math.hypot(*row)):
            raise InputError(
                "no speeds meet the constraints here",
                where=f"constraint {at.components[i].name}",
                got=f"left by {rest:.3g}",
                hint="keep fewer speeds, or leave this configuration: it may be singular",
            )
    return result
