"""Which constraints say what others say already: rank tests at random configurations that meet them all.

A component is dependent if its row is a combination of the rows kept before it at every configuration
tried, to a relative remainder of `RANK`. It is dropped if it holds where the others do; where none of
the configurations meets all constraints, they contradict each other, or the tree cannot be assembled.

Configurations of a constrained tree in numbers: found by Levenberg's and Marquardt's iteration.

Only the geometry counts: masses, rotors, loads and springs are left out. A change of a configuration
is a vector over the speeds, q' = N(q) u for a unit of time, so that attitudes stay attitudes. Damping as
the size of what is left keeps convergence quadratic where constraints are redundant: Yamashita and
Fukushima, "On the rate of convergence of the Levenberg-Marquardt method", Computing Suppl. 15 (2001)
239-249.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError, near_matches, typed
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.algebra.spatial import ZERO, ZEROS
from eom.multibody.algebra.values import is_number
from eom.multibody.constrained.equations import Component, components
from eom.multibody.constrained.relations import Arithmetic, scene
from eom.multibody.model.bodies import Body, Joint
from eom.multibody.model.constraints import Coupling
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Tree
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.motion import coordinate_rates
from eom.quantities import TIME

TURNS = 200
SLOW, BARELY = 8, 1e-4
"""Turns that reduce what is left by no more than this share, after which the iteration ends."""
CLOSE = 1e-11
"""What may be left of a constraint, relative to the lengths of the tree (1 m at least)."""
FLOATS = Numbers(math.sin, math.cos)
Row = list[float]


@dataclass(frozen=True)
class Linear:
    """The constraints at a configuration: values (None between speeds alone), rows, offsets."""

    components: tuple[Component, ...]
    values: tuple[float | None, ...]
    rows: tuple[Row, ...]
    offsets: tuple[float, ...]

    @property
    def left(self) -> float:
        """The largest value."""
        return max((abs(v) for v in self.values if v is not None), default=0.0)


@dataclass
class Geometry:
    """A tree without masses, and the values of its symbols."""

    tree: Tree
    known: dict[Any, float]
    _fixed: dict[Any, float] = field(default_factory=dict)

    @classmethod
    def of(cls, tree: Tree, known: Mapping[Any, float]) -> Geometry:
        """Return the geometry of a tree, given values of parameters, inputs and time by symbol."""
        bare = replace(
            tree,
            bodies=tuple(Body(b.name, 1) for b in tree.bodies),
            joints=tuple(replace(j, armature=0, force=0, stiffness=0, damping=0, rest=0)
                         for j in tree.joints),
            loads=(),
            rotors=(),
            springs=(),
            gravity=ZERO,
            gravity_gradient=ZEROS,
        )  # fmt: skip
        return cls(bare, {TIME: 0.0, **known})

    @cached_property
    def lumped(self) -> LumpedTree:
        """The parts in numbers."""
        return lumped_tree(self.tree, self.lift, FLOATS)

    @cached_property
    def coordinates(self) -> list[Any]:
        """The symbols of all coordinates."""
        return [c.symbol for j in self.tree.ordered for c in j.coordinates]

    @cached_property
    def free(self) -> list[int]:
        """The numbers of the speeds whose motion is not prescribed."""
        driven = set(self.lumped.driven)
        return [k for k in range(self.lumped.speeds) if k not in driven]

    def lift(self, given: Any) -> Any:
        """Return the number that a value of the description has."""
        if is_number(given):
            return given if given in (0, 1, -1) else float(given)
        if given in self.known:
            return self.known[given]
        missing = given.free_symbols - set(self.known)
        if missing:
            raise InputError(
                "no value", where=f"tree {self.tree.name!r}",
                got=", ".join(sorted(map(str, missing))),
                hint="give numbers for what the constraints depend on",
            )  # fmt: skip
        return float(given.xreplace({s: sp.Float(self.known[s]) for s in given.free_symbols}))

    def completed(self, q: Sequence[float]) -> list[float]:
        """Return coordinates with the prescribed ones in place, and quaternions of norm 1."""
        found, k = list(q), 0
        for joint in self.tree.ordered:
            size = len(joint.coordinates)
            if joint.motion is not None:
                found[k : k + size] = [float(self.lift(x)) for x in joint.motion.position]
            elif has_quaternion(joint):
                norm = math.sqrt(sum(x * x for x in found[k + size - 4 : k + size]))
                for n in range(k + size - 4, k + size):
                    found[n] = found[n] / norm if norm else float(n == k + size - 4)
            k += size
        return found

    def linear(self, q: Sequence[float]) -> Linear:
        """Return the constraints at a configuration; rows are over all speeds."""
        self.known.update(zip(self.coordinates, q, strict=True))
        arithmetic = Arithmetic(self.lift, FLOATS, math.sqrt)
        found = tuple(components(self.tree, scene(self.lumped, q, None, arithmetic)))
        values = (c.relation.value() for c in found)
        return Linear(
            found,
            tuple(None if v is None else float(v) for v in values),
            tuple(_full(c.relation.row(), self.lumped.speeds) for c in found),
            tuple(float(c.relation.offset()) for c in found),
        )

    def moved(self, q: Sequence[float], change: Sequence[float]) -> list[float]:
        """Return a configuration after a change, given over the speeds."""
        rates = coordinate_rates(self.lumped, q, change, FLOATS)
        return self.completed([a + float(b) for a, b in zip(q, rates, strict=True)])

    def driven_speeds(self) -> dict[int, float]:
        """Return the speeds of joints whose motion is prescribed."""
        found: dict[int, float] = {}
        k = 0
        for joint in self.tree.ordered:
            if joint.motion is not None:
                found |= {k + n: float(self.lift(x)) for n, x in enumerate(joint.motion.rate)}
            k += len(joint.speeds)
        return found


def has_quaternion(joint: Joint) -> bool:
    """Return whether the last four coordinates of a joint are a quaternion."""
    return joint.row.attitude and joint.attitude == QUATERNION


def _full(row: Mapping[int, Any], size: int) -> Row:
    return [float(row.get(k, 0)) for k in range(size)]


@dataclass(frozen=True)
class Closed:
    """Where the iteration ended: configuration, constraints there, and how many turns it took."""

    q: list[float]
    at: Linear
    turns: int

    @property
    def met(self) -> bool:
        """Whether all constraints hold."""
        return self.at.left <= CLOSE * max(1.0, *map(abs, self.q), 1.0)


def closed(geometry: Geometry, q: Sequence[float], mobility: Sequence[float]) -> Closed:
    """Return the configuration near ``q`` that meets the constraints best.

    ``mobility``: how freely each speed's coordinate changes; each turn makes the least change, in
    which squares are divided by the squares of these; 0 for what stays.

    Raises `InputError` where the constraints have no derivative at ``q``.
    """
    q = geometry.completed(q)
    here = _tried(geometry, q)
    if here is None:
        raise InputError(
            "the constraints have no derivative at the start values",
            where=f"tree {geometry.tree.name!r}",
            hint="a wheel must not lie flat",
        )
    damping, slow = 1.0, 0
    for turn in range(TURNS):
        size = _norm(here)
        if size == 0.0 or slow > SLOW:
            return Closed(q, here, turn)
        trial_q = geometry.moved(
            q, _step(geometry, here, mobility, damping * min(size * size, size))
        )
        trial = _tried(geometry, trial_q)
        if trial is not None and _norm(trial) < size:
            slow = slow + 1 if _norm(trial) > size * (1 - BARELY) else 0
            q, here, damping = trial_q, trial, damping / 4
        elif damping > 1e12 or size < 1e-15:
            return Closed(q, here, turn)
        else:
            damping *= 8
    return Closed(q, here, TURNS)


def _tried(geometry: Geometry, q: Sequence[float]) -> Linear | None:
    """Return the constraints at a configuration, None where they have no derivative: a flat wheel."""
    try:
        found = geometry.linear(q)
    except InputError:
        raise
    except (ZeroDivisionError, ValueError):
        return None
    sizes = [x for row in found.rows for x in row]
    return found if all(map(math.isfinite, sizes)) else None


def _norm(at: Linear) -> float:
    found = math.sqrt(sum(v * v for v in at.values if v is not None))
    return found if math.isfinite(found) else math.inf


def _step(geometry: Geometry, at: Linear, mobility: Sequence[float], damping: float) -> Row:
    """Return the damped least change over the speeds."""
    wanted = [(row, v) for row, v in zip(at.rows, at.values, strict=True) if v is not None]
    free = [k for k in geometry.free if mobility[k]]
    rows = [[row[k] * mobility[k] for k in free] for row, _ in wanted]
    gram = [[_dot(a, b) for b in rows] for a in rows]
    largest = max((gram[i][i] for i in range(len(gram))), default=0.0)
    for i in range(len(gram)):
        gram[i][i] += damping + 1e-15 * largest + 1e-300
    y = solved(gram, [-v for _, v in wanted])
    change = [0.0] * geometry.lumped.speeds
    for n, k in enumerate(free):
        change[k] = mobility[k] * sum(row[n] * x for row, x in zip(rows, y, strict=True))
    return change


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def solved(A: Sequence[Sequence[float]], b: Sequence[float]) -> list[float]:
    """Return x with A x = b, by Gaussian elimination with partial pivoting."""
    rows = [[*map(float, row), float(y)] for row, y in zip(A, b, strict=True)]
    n = len(rows)
    for k in range(n):
        best = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[best] = rows[best], rows[k]
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            for j in range(k, n + 1):
                rows[i][j] -= factor * rows[k][j]
    x = [0.0] * n
    for k in range(n - 1, -1, -1):
        x[k] = (rows[k][n] - sum(rows[k][j] * x[j] for j in range(k + 1, n))) / rows[k][k]
    return x


def random_values(symbols: Iterable[Any], draw: random.Random) -> dict[Any, float]:
    """Return a number between 1/2 and 3/2 for each symbol."""
    return {s: draw.uniform(0.5, 1.5) for s in symbols}


RANK = 1e-8
"""Remainder of a row, relative to the row, below which it counts as dependent."""
WANTED, TRIES, VAIN = 5, 40, 12
"""Configurations that are tested, how often one is looked for, and how often while none is found."""
NOTHING = 1e-12
"""Size of a row, relative to the largest, below which it is zero but for rounding."""
NOTABLE = 1e-6
"""Coefficients of a combination that are named."""


@dataclass(frozen=True)
class Sample:
    """A configuration that meets the constraints, and its rows over the free speeds."""

    geometry: Geometry
    found: Closed

    def row(self, k: int) -> Row:
        """Return the row of a component over the free speeds."""
        return [self.found.at.rows[k][s] for s in self.geometry.free]

    @property
    def largest(self) -> float:
        """The size of the largest row."""
        return max(math.hypot(*row) for row in self.found.at.rows)

    def wanted(self, k: int) -> float:
        """Return what the row times the free speeds is to be."""
        driven = self.geometry.driven_speeds()
        given = sum(self.found.at.rows[k][s] * v for s, v in driven.items())
        return -self.found.at.offsets[k] - given


@dataclass(frozen=True)
class Examination:
    """What the rank test found: components kept, by number; those dropped, and what they depend on.

    Parameters
    ----------
    names : tuple of str
        Of all components.
    kept : tuple of ints
        Places among these.
    dropped : tuple of tuple of int, tuple of ints
        Places, with those of the components that each depends on.
    freedom : int
        How many speeds are independent.
    samples : tuple of Sample
        The configurations tested.
    """

    names: tuple[str, ...]
    kept: tuple[int, ...]
    dropped: tuple[tuple[int, tuple[int, ...]], ...]
    freedom: int
    samples: tuple[Sample, ...]

    def __str__(self) -> str:
        """Say it in words."""
        return "; ".join([f"{self.freedom} degrees of freedom in speeds", *self.remarks])

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was dropped, in words, one sentence a component."""
        return tuple(
            f"constraint {self.names[k]} "
            + (f"depends on {', '.join(self.names[i] for i in on)}" if on else "holds by itself")
            for k, on in self.dropped
        )


@typed
def examine(tree: Tree, start: Mapping[str, float] | None = None) -> Examination:
    """Return which components of a tree's constraints are independent.

    Parameters
    ----------
    tree : Tree
        With constraints.
    start : mapping of str to floats, optional
        Numbers by name for parameters, inputs and coordinates; what is left out is drawn at random,
        always the same.

    Returns
    -------
    Examination
        How many degrees of freedom there are, and which components of constraints depend on which.

    Raises
    ------
    InputError
        Where constraints cannot be met together, where they contradict each other in their rates,
        and where they leave no motion.

    Notes
    -----
    SI units; a row counts as dependent by a remainder of `RANK` relative to its size.

    Examples
    --------
    >>> from eom.multibody import Body, Distance, Joint
    >>> bead = Body("bead", mass=1, inertia=(1, 1, 1))
    >>> rods = (Distance("rod", "ground", "bead", 2), Distance("same", "ground", "bead", 2))
    >>> free = Joint("free", "free", "ground", "bead")
    >>> print(examine(Tree("rod", (bead,), (free,), constraints=rods)))
    5 degrees of freedom in speeds; constraint 'same' depends on 'rod'
    """
    samples = _regular(_samples(tree, dict(start or {})))
    parts = samples[0].found.at.components
    kept: list[int] = []
    dropped = []
    for k in range(len(parts)):
        if any(_remainder(s, k, kept) > RANK for s in samples):
            kept.append(k)
            continue
        coefficients = [_combination(s, k, kept) for s in samples]
        on = tuple(i for n, i in enumerate(kept) if any(abs(c[n]) > NOTABLE for c in coefficients))
        dropped.append((k, on))
        _consistent(samples, k, kept, coefficients, on)
    freedom = len(samples[0].geometry.free) - len(kept)
    names = tuple(c.name for c in parts)
    if freedom == 0 and not _driven(tree):
        raise InputError(
            "the constraints leave no motion",
            where=f"tree {tree.name!r}",
            got=f"{len(kept)} independent constraints on {len(kept)} speeds: "
            + ", ".join(names[k] for k in kept),
        )
    return Examination(names, tuple(kept), tuple(dropped), freedom, samples)


def _regular(samples: Sequence[Sample]) -> tuple[Sample, ...]:
    """Return the configurations at which most rows are independent; the others are singular."""
    ranks = [len(independent_rows(s)) for s in samples]
    return tuple(s for s, rank in zip(samples, ranks, strict=True) if rank == max(ranks))


def _driven(tree: Tree) -> bool:
    """Return whether time or a prescribed motion moves the tree."""
    given = [x for c in tree.constraints for x in c.values if not is_number(x)]
    return any(j.motion is not None for j in tree.joints) or any(x.has(TIME) for x in given)


def _symbols(tree: Tree) -> list[Any]:
    """Return the symbols that the geometry depends on, beside coordinates and speeds, by name."""
    moving = {q.symbol for j in tree.joints for q in (*j.coordinates, *j.speeds)} | {TIME}
    found = {s for x in _geometry(tree) if not is_number(x) for s in x.free_symbols}
    return sorted(found - moving, key=lambda s: str(s.name))


def _geometry(tree: Tree) -> Iterable[Any]:
    for j in tree.joints:
        yield from (*(x for a in j.axes for x in a), j.pitch)
        for place in (j.on_parent, j.on_child):
            yield from (*place.position, *(x for row in place.rotation for x in row))
        if j.motion is not None:
            yield from (*j.motion.position, *j.motion.rate)
    for c in tree.constraints:
        yield from c.values


def _samples(tree: Tree, start: dict[str, float]) -> tuple[Sample, ...]:
    """Return configurations that meet the constraints; raise `InputError` if there is none."""
    symbols = _symbols(tree)
    coordinates = [c for j in tree.ordered for c in j.coordinates]
    draw = random.Random(1)  # noqa: S311 - examples, no secrets
    found: list[Sample] = []
    worst: Sample | None = None
    for k in range(TRIES):
        values = random_values(symbols, draw)
        values |= {s: start[str(s)] for s in symbols if str(s) in start}
        spread = 0.0 if k == 0 else 0.2
        q = [
            start[c.name] + draw.uniform(-spread, spread)
            if c.name in start
            else draw.uniform(-1.5, 1.5)
            for c in coordinates
        ]
        geometry = Geometry.of(tree, values)
        sample = Sample(geometry, closed(geometry, q, [1.0] * geometry.lumped.speeds))
        if sample.found.met:
            found.append(sample)
        elif worst is None or sample.found.at.left < worst.found.at.left:
            worst = sample
        if len(found) == WANTED or (not found and k + 1 == VAIN):
            break
    if not found:
        assert worst is not None
        raise not_met(tree, worst.found)
    return tuple(found)


def not_met(tree: Tree, found: Closed) -> InputError:
    """Return the error that names the constraints that cannot be met."""
    left = [
        (c.name, v)
        for c, v in zip(found.at.components, found.at.values, strict=True)
        if v is not None and abs(v) > 1e-3 * found.at.left
    ]
    return InputError(
        "no configuration was found that meets the constraints: they contradict each other, "
        "or lengths do not reach",
        where=f"tree {tree.name!r}",
        got=", ".join(f"{name} left by {v:.3g}" for name, v in left),
        hint="give start values nearer to an assembled configuration, or correct the lengths",
    )


def independent_rows(sample: Sample) -> list[int]:
    """Return the components whose rows do not follow from those before, at one configuration."""
    kept: list[int] = []
    for k in range(len(sample.found.at.rows)):
        if _remainder(sample, k, kept) > RANK:
            kept.append(k)
    return kept


def _remainder(sample: Sample, k: int, kept: Sequence[int]) -> float:
    """Return what is left of a row beside the kept ones, relative to the row."""
    row = sample.row(k)
    size = math.hypot(*row)
    if size <= NOTHING * sample.largest:
        return 0.0
    rest = row
    for base in _orthonormal([sample.row(i) for i in kept]):
        rest = _without(rest, base)
    return math.hypot(*rest) / size


def _orthonormal(rows: Sequence[Row]) -> list[Row]:
    """Gram and Schmidt, twice."""
    found: list[Row] = []
    for row in rows:
        rest = row
        for _ in range(2):
            for base in found:
                rest = _without(rest, base)
        size = math.hypot(*rest)
        if size > NOTHING:
            found.append([x / size for x in rest])
    return found


def _without(row: Row, base: Row) -> Row:
    part = math.fsum(x * y for x, y in zip(row, base, strict=True))
    return [x - part * y for x, y in zip(row, base, strict=True)]


def _combination(sample: Sample, k: int, kept: Sequence[int]) -> Row:
    """Return the coefficients of the kept rows that give a dependent one."""
    rows = [sample.row(i) for i in kept]
    row = sample.row(k)
    gram = [[math.fsum(x * y for x, y in zip(a, b, strict=True)) for b in rows] for a in rows]
    for i in range(len(gram)):
        gram[i][i] *= 1 + 1e-14
    return solved(gram, [math.fsum(x * y for x, y in zip(a, row, strict=True)) for a in rows])


def _consistent(
    samples: Sequence[Sample],
    k: int,
    kept: Sequence[int],
    coefficients: Sequence[Row],
    on: Sequence[int],
) -> None:
    """Raise `InputError` where the rates of dependent components contradict each other."""
    for sample, row in zip(samples, coefficients, strict=True):
        wanted = math.fsum(c * sample.wanted(i) for i, c in zip(kept, row, strict=True))
        size = abs(sample.wanted(k)) + abs(wanted)
        if abs(wanted - sample.wanted(k)) > NOTABLE * size and size > RANK:
            parts: Sequence[Component] = sample.found.at.components
            raise InputError(
                "constraints contradict each other",
                where=f"constraint {parts[k].name}",
                got=f"a rate of {sample.wanted(k):.6g}",
                expected=f"{wanted:.6g}, by {', '.join(parts[i].name for i in on) or 'nothing'}",
            )


# --- independent speeds ------------------------------------------------------------------------------


def dependents(
    tree: Tree, found: Examination, independent: Sequence[str] | None = None
) -> tuple[int, ...]:
    """Return the numbers of the speeds that the others determine.

    ``independent``: names of those that are to stay; by default the followers of couplings are determined,
    and of the rest what keeps the equations for the others farthest from singular over the configurations
    tested. Raises `InputError` for unknown names, a wrong number of them, and speeds that do not determine
    the others.
    """
    speeds = [s for j in tree.ordered for s in j.speeds]
    free = found.samples[0].geometry.free
    if independent is not None:
        return _given(tree, found, independent, [speeds[k].name for k in free], free)
    led = _followers(tree, free)
    best = _farthest(found, [speeds[k].unit for k in free], led)
    if led and _distance(found, best) < RANK:
        best = _farthest(found, [speeds[k].unit for k in free], frozenset())
    return tuple(sorted(free[n] for n in best))


def _farthest(found: Examination, units: Sequence[str], led: frozenset[int]) -> tuple[int, ...]:
    """Return the columns that keep the equations farthest from singular, those that are ``led`` first."""
    sets = {_pivoted(s, found.kept, [1.0] * len(units), led) for s in found.samples}
    for unit in ("m/s", "rad/s"):
        liking = [1e3 if own == unit else 1.0 for own in units]
        sets.add(_pivoted(found.samples[0], found.kept, liking, led))
    return max(sorted(sets), key=lambda columns: _distance(found, columns))


def _followers(tree: Tree, free: Sequence[int]) -> frozenset[int]:
    """Return the columns of the speeds that couplings say follow."""
    led = {c.follower for c in tree.constraints if isinstance(c, Coupling)}
    owners = [j.name for j in tree.ordered for _ in j.speeds]
    return frozenset(n for n, k in enumerate(free) if owners[k] in led)


def _given(
    tree: Tree, found: Examination, names: Sequence[str], known: Sequence[str], free: Sequence[int]
) -> tuple[int, ...]:
    where = f"tree {tree.name!r}"
    for name in names:
        if name not in known:
            raise InputError(f"unknown speed {name!r}", where=where, hint=near_matches(name, known))
    if len(set(names)) != found.freedom:
        raise InputError(
            "wrong number of independent speeds",
            where=where,
            got=", ".join(names),
            expected=f"{found.freedom} of {', '.join(known)}",
        )
    columns = [n for n, name in enumerate(known) if name not in set(names)]
    if _distance(found, columns) < RANK:
        raise InputError(
            "these speeds do not determine the others",
            where=where,
            got=", ".join(names) or "none",
            hint="choose others, or leave the choice to eom",
        )
    return tuple(free[n] for n in columns)


def _pivoted(
    sample: Sample, kept: Sequence[int], liking: Sequence[float], led: frozenset[int]
) -> tuple[int, ...]:
    """Choose a column a row, by elimination with complete pivoting over scaled rows, ``led`` ones first."""
    rows = []
    for k in kept:
        row = sample.row(k)
        size = math.hypot(*row)
        rows.append([x / size for x in row])
    columns: list[int] = []
    left = list(range(len(rows)))
    while left:
        i, j = max(
            ((i, j) for i in left for j in range(len(liking)) if j not in columns),
            key=lambda place: (
                place[1] in led and abs(rows[place[0]][place[1]]) > NOTHING,
                abs(rows[place[0]][place[1]]) * liking[place[1]],
            ),
        )
        columns.append(j)
        left.remove(i)
        for n in left:
            factor = rows[n][j] / rows[i][j]
            rows[n] = [x - factor * y for x, y in zip(rows[n], rows[i], strict=True)]
    return tuple(sorted(columns))


def _distance(found: Examination, columns: Sequence[int]) -> float:
    """Return the least pivot of J_D J_D^T over the square of a row of J, over all samples."""
    least = math.inf
    for sample in found.samples:
        rows = [sample.row(k) for k in found.kept]
        cut = [[row[n] for n in columns] for row in rows]
        bases: list[Row] = []
        for row, whole in zip(cut, rows, strict=True):
            rest = row
            for _ in range(2):
                for base in bases:
                    rest = _without(rest, base)
            size = math.hypot(*rest)
            least = min(least, (size / math.hypot(*whole)) ** 2)
            if size > NOTHING:
                bases.append([x / size for x in rest])
    return least
