"""Samples of states and parameters by seed and number: trajectory k is the same in any division.

Random numbers are counter-based (Philox 4x64-10: Salmon, Moraes, Dror and Shaw, Parallel random
numbers: as easy as 1, 2, 3, SC 2011): the numbers of trajectory k stand at places k c to k c + c - 1
of the sequence of the seed, where c counters serve one trajectory. They can be had from any k on
without those before.

Distributions in words, as ``normal(0, 0.1)``: the same on the command line and in files.

Where the trajectories of an ensemble start: arrays by name or in order, or a sampler.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, Protocol, runtime_checkable

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.frontend.layout import completed, in_si, names_of
from codegen.frontend.structure import Condition
from codegen.ir.program import SameObject
from codegen.native.trajectory import Array
from eom.errors import AssumptionError, InputError, shown, typed, typed_fields, unknown_name
from eom.quantities import TIME
from eom.system import System
from eom.units import in_unit, nearest


@runtime_checkable
class Samples(Protocol):
    """Values by name for the trajectories of any range, always the same: `Sampler`, or your own."""

    @property
    def names(self) -> Sequence[str]:
        """States and parameters that get values."""

    def __len__(self) -> int:
        """Return how many there are."""

    def sample(self, first: int, last: int) -> Mapping[str, Array]:
        """Return the samples of some trajectories, by name.

        Parameters
        ----------
        first, last : int
            Numbers of the first trajectory and of that behind the last.

        Returns
        -------
        mapping of str to array
            Arrays (last - first,) by name.
        """


Many = Mapping[str, ArrayLike] | ArrayLike | Samples | None


@dataclass(frozen=True)
class Population:
    """All trajectories: ``columns`` (N,) or () by name, from number ``offset`` on, and a sampler.

    ``states``, ``parameters``: the names in the order of the arrays of the compiled system.
    """

    states: tuple[str, ...]
    parameters: tuple[str, ...]
    columns: Mapping[str, Array]
    count: int
    sampler: Samples | None = None
    offset: int = 0

    def part(self, first: int, last: int) -> Population:
        """Return what the trajectories from ``first`` to before ``last`` need."""
        columns = {n: (c[first - self.offset : last - self.offset] if c.ndim else c)
                   for n, c in self.columns.items()}  # fmt: skip
        return replace(self, columns=columns, offset=first)

    def draw(self, first: int, last: int) -> tuple[Array, Array]:
        """Return states (n, last - first) and parameters (m,), or (m, last - first) if one varies.

        Raises `InputError` for values of a sampler that are not finite.
        """
        known = dict(self.part(first, last).columns)
        if self.sampler is not None:
            known |= _drawn(self.sampler, first, last)
        shape = (last - first,)
        x = np.stack([np.broadcast_to(known[n], shape) for n in self.states])
        p = [known[n] for n in self.parameters]
        if any(v.ndim for v in p):
            p = [np.broadcast_to(v, shape) for v in p]
        return x, np.array(p, dtype=np.float64)


def _drawn(sampler: Samples, first: int, last: int) -> dict[str, Array]:
    found = {}
    for name, values in sampler.sample(first, last).items():
        array = np.asarray(values, dtype=np.float64)
        if array.shape != (last - first,):
            got = f"shape {array.shape}"
            raise InputError(
                f"sampler: {name} has the wrong shape", got=got, expected=(last - first,)
            )
        _finite(name, array, first)
        found[name] = array
    return found


def population(compiled: Compiled, initial: Many, parameters: Many) -> Population:
    """Return all trajectories; whatever has no second axis is the same for all.

    Raises `InputError` for unknown and missing names, wrong shapes, values that are not finite, and
    for no trajectory at all.
    """
    layout = compiled.layout
    states, others = names_of(layout.states), names_of(layout.parameters)
    sampler = initial if isinstance(initial, Samples) else None
    drawn = set(sampler.names) if sampler else set()
    for name in sorted(drawn - {*states, *others}):
        raise unknown_name("state or parameter", name, (*states, *others), "sampler")
    if isinstance(parameters, Samples):
        raise InputError("parameters are a sampler", hint="give one sampler of both as initial")
    columns = {} if sampler else _columns(compiled, "state", initial, states)
    columns |= _columns(compiled, "parameter", parameters, [n for n in others if n not in drawn])
    standing = [q for q in (*layout.states, *layout.parameters) if q.name not in drawn]
    columns = {n: np.asarray(c, dtype=np.float64) for n, c in completed(columns, standing).items()}
    missing = [n for n in (*states, *others) if n not in columns and n not in drawn]
    if missing:
        raise InputError(f"missing states or parameters: {', '.join(missing)}")
    sizes = {n: len(c) for n, c in columns.items() if c.ndim}
    if sampler is not None:
        sizes["sampler"] = len(sampler)
    if len(set(sizes.values())) > 1:
        got = ", ".join(f"{n}: {k}" for n, k in sizes.items())
        raise InputError("numbers of trajectories differ", got=got)
    count = next(iter(sizes.values()), 1)
    if count == 0:
        raise InputError("there are no trajectories", got="0 samples", expected="one or more")
    return Population(states, others, columns, count, sampler)


def _columns(compiled: Compiled, kind: str, values: Any, names: Sequence[str]) -> dict[str, Array]:
    """Return arrays () or (N,) by name."""
    if values is None:
        values = {}
    if not isinstance(values, Mapping):
        values = _rows(kind, values, names)
    held = compiled.structure.states if kind == "state" else compiled.structure.parameters
    values = in_si(values, compiled.layout.known)
    found = {}
    for name, value in values.items():
        array = _numbers(kind, name, value)
        if kind == "state" and name in held and np.all(array == held[name]):
            continue
        if name in held:
            raise InputError(f"{kind} {name} was compiled in", expected=held[name])
        if name not in names:
            raise unknown_name(kind, name, names, f"system {compiled.layout.name!r}")
        found[name] = array
    return found


def _rows(kind: str, values: ArrayLike, names: Sequence[str]) -> dict[str, ArrayLike]:
    array = _numbers(kind, "s", values, 2)
    if array.ndim == 0 or len(array) != len(names):
        expected = f"({len(names)},) or ({len(names)}, N): {', '.join(names)}"
        raise InputError(f"{kind}s have the wrong shape", got=array.shape, expected=expected)
    return dict(zip(names, array, strict=True))


def _numbers(kind: str, name: str, value: Any, axes: int = 1) -> Array:
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{kind} {name}: not numbers", got=shown(value)) from None
    if array.ndim > axes:
        expected = "a number, or one a trajectory: (N,)"
        raise InputError(f"{kind} {name} has the wrong shape", got=array.shape, expected=expected)
    if array.ndim < 2:
        _finite(name, array, 0)
    return array


def _finite(name: str, array: Array, first: int) -> None:
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        where = f"trajectory {first + int(bad[0])}" if array.ndim else ""
        got = array.reshape(-1)[bad[0]]
        raise InputError(f"value of {name} is not finite", where=where, got=got)


def check(compiled: Compiled, x: Array, p: Array, u: Array, first: int, time: float = 0.0) -> None:
    """Test states (n, N), parameters and inputs against what the system assumes at a time (s).

    Raises `AssumptionError` for the first trajectory that contradicts, `InputError` for parameters
    that must be positive and are not.
    """
    layout, guard = compiled.layout, compiled.guard
    columns = dict(zip(names_of(layout.states), x, strict=True))
    columns |= dict(zip(names_of(layout.parameters), p, strict=True))
    columns |= dict(zip(names_of(layout.inputs), u, strict=True))
    known = _completed(compiled, columns) | {TIME.name: np.asarray(time)}
    for name, meaning in guard.positive.items():
        bad = np.flatnonzero(~(np.asarray(known.get(name, 1.0)) > 0))
        if bad.size:
            where = f"trajectory {first + int(bad[0])}: {meaning}"
            raise InputError(f"parameter {name} is not positive", where=where)
    for condition, values in _conditions(SameObject(compiled)):
        if all(n in known for n in condition.names):
            _hold(condition, values(known), known, first)


def _completed(compiled: Compiled, columns: Mapping[str, Array]) -> dict[str, Array]:
    structure = compiled.structure
    fixed = {**structure.parameters, **structure.states, **structure.inputs}
    known = {n: np.asarray(v) for n, v in fixed.items()} | dict(columns)
    return known | {n: known[o] for n, o in structure.equal.items() if o in known}


def _hold(condition: Condition, found: Array, known: Mapping[str, Array], first: int) -> None:
    numbers = [np.abs(known[n]) for n in condition.names]
    slack = condition.assumption.tolerance * np.maximum.reduce(np.broadcast_arrays(*numbers)) \
        if len(numbers) > 1 else 0.0  # fmt: skip
    holds = np.abs(found) <= slack if condition.is_zero else found >= -slack
    bad = np.flatnonzero(~holds)
    if not bad.size:
        return
    at = int(bad[0])
    got = {n: float(np.broadcast_to(known[n], found.shape)[at]) for n in condition.names}
    raise AssumptionError(
        f"values contradict the assumption {condition.assumption.name}: {condition.assumption.meaning}",
        where=f"trajectory {first + at}", got=", ".join(f"{n} = {v!r}" for n, v in got.items()),
        expected=f"{condition.expression} {'= 0' if condition.is_zero else '>= 0'}",
        hint="derive the system again without this assumption, or correct the values",
    )  # fmt: skip


Evaluate = Callable[[Mapping[str, Array]], Array]


@lru_cache(maxsize=16)
def _conditions(key: SameObject[Compiled]) -> tuple[tuple[Condition, Evaluate], ...]:
    """Return the conditions of a system, each with a function of arrays."""
    return tuple((c, _evaluate(c)) for c in key.value.guard.conditions)


def _evaluate(condition: Condition) -> Evaluate:
    symbol = sp.Symbol("condition_")
    system = System.from_rates("condition", {symbol: condition.expression})
    compiled = compile_system(system, "numpy")
    order = names_of(compiled.layout.parameters)

    def at(known: Mapping[str, Array]) -> Array:
        rows = np.broadcast_arrays(np.zeros(1), *(np.atleast_1d(known[n]) for n in order))
        columns = np.stack(rows)[1:]
        still = np.zeros((1, columns.shape[1]))
        found: Array = compiled.rhs(float(known[TIME.name]), still, columns)[0]
        return found

    return at


A_COUNTER = 4
"""Numbers of 64 bits that one counter gives."""
Names = str | tuple[str, ...]


class Distribution(Protocol):
    """What `Sampler` takes: ``values(u)`` makes values (size, N) of numbers (draws, N) in (0, 1)."""

    @property
    def draws(self) -> int:
        """How many random numbers it takes."""

    @property
    def size(self) -> int:
        """How many names it gives values to."""

    def values(self, u: Array) -> Array:
        """Return values (size, N) for numbers ``u`` (draws, N) inside (0, 1).

        Parameters
        ----------
        u : array
            Numbers (draws, N) inside (0, 1).

        Returns
        -------
        array
            Values (size, N).
        """


MOST_AT_ONCE = 10**8
"""Samples that are drawn in one call."""


@typed_fields
@dataclass(frozen=True)
class Uniform:
    """Between two limits, ``low`` and ``high``, each value as likely as the other.

    Parameters
    ----------
    low, high : float
        The limits, in the unit of what is sampled.
    draws : int
        Random numbers that it takes: one.
    size : int
        How many names it is for: one.

    Raises
    ------
    InputError
        For limits that are not finite or not in order.
    """

    low: float
    high: float
    draws: int = field(default=1, init=False)
    size: int = field(default=1, init=False)

    def __post_init__(self) -> None:
        """Refuse limits that are not in order."""
        if not -math.inf < float(self.low) <= float(self.high) < math.inf:
            raise InputError("limits do not fit", got=(self.low, self.high), expected="low <= high")

    def values(self, u: Array) -> Array:
        """Return values (1, N) for numbers ``u`` (1, N) inside (0, 1).

        Parameters
        ----------
        u : array
            Numbers (1, N) inside (0, 1).

        Returns
        -------
        array
            Values (1, N) between the bounds.
        """
        return self.low + (self.high - self.low) * u


@typed_fields
@dataclass(frozen=True)
class Normal:
    """The normal distribution of a ``mean`` and a standard ``deviation``.

    Parameters
    ----------
    mean, deviation : float, default 0.0
        In the unit of what is sampled.
    draws : int
        Random numbers that it takes: one.
    size : int
        How many names it is for: one.

    Raises
    ------
    InputError
        For what is not finite, and a negative deviation.

    Notes
    -----
    In the unit of what is sampled; by the inverse of its distribution function.
    """

    mean: float = 0.0
    deviation: float = 1.0
    draws: int = field(default=1, init=False)
    size: int = field(default=1, init=False)

    def __post_init__(self) -> None:
        """Refuse what is no mean and no deviation."""
        if not (math.isfinite(self.mean) and 0 <= float(self.deviation) < math.inf):
            got = (self.mean, self.deviation)
            raise InputError("wrong mean or deviation", got=got, expected="finite, deviation >= 0")

    def values(self, u: Array) -> Array:
        """Return values (1, N) for numbers ``u`` (1, N) inside (0, 1).

        Parameters
        ----------
        u : array
            Numbers (1, N) inside (0, 1).

        Returns
        -------
        array
            Values (1, N) below which so large a share of the distribution lies.
        """
        found: Array = self.mean + self.deviation * ndtri(u)
        return found


@dataclass(frozen=True)
class UniformQuaternion:
    """Every attitude as likely as the other; for four names, scalar first.

    Parameters
    ----------
    draws : int
        Random numbers that it takes: three.
    size : int
        How many names it is for: four, scalar first.

    Notes
    -----
    A quaternion of unit norm.

    References
    ----------
    Shoemake, Uniform random rotations, in Graphics Gems III (1992).
    """

    draws: int = field(default=3, init=False)
    size: int = field(default=4, init=False)

    def values(self, u: Array) -> Array:
        """Return unit quaternions (4, N) for numbers ``u`` (3, N) inside (0, 1).

        Parameters
        ----------
        u : array
            Numbers (3, N) inside (0, 1).

        Returns
        -------
        array
            Unit quaternions (4, N), scalar first.
        """
        one, other = np.sqrt(1.0 - u[0]), np.sqrt(u[0])
        a, b = 2.0 * math.pi * u[1], 2.0 * math.pi * u[2]
        return np.stack([other * np.cos(b), one * np.sin(a), one * np.cos(a), other * np.sin(b)])


@typed_fields
@dataclass(frozen=True)
class Grid:
    """A ``count`` of values from ``low`` to ``high`` at equal distances, both included.

    Parameters
    ----------
    low, high : float
        The first and the last value.
    count : int
        How many there are, at equal distances.
    draws : int
        Random numbers that it takes: none.
    size : int
        How many names it is for: one.

    Raises
    ------
    InputError
        For limits that are not finite, and fewer than one value.

    Notes
    -----
    In the unit of what is sampled; grids of several names are crossed.
    """

    low: float
    high: float
    count: int
    draws: int = field(default=0, init=False)
    size: int = field(default=1, init=False)

    def __post_init__(self) -> None:
        """Refuse empty grids."""
        whole = isinstance(self.count, int) and self.count >= 1
        if not (whole and math.isfinite(self.low) and math.isfinite(self.high)):
            raise InputError("wrong grid", got=self, expected="finite limits, one value or more")

    def values(self, u: Array) -> Array:
        """Return the values (1, N) of places ``u`` (1, N), counted from 0.

        Parameters
        ----------
        u : array
            Places (1, N), counted from 0.

        Returns
        -------
        array
            The values (1, N), in the unit of what is sampled.
        """
        return self.low + (self.high - self.low) * (u / max(1, self.count - 1))


Value = Distribution | float


@typed_fields
@dataclass(frozen=True)
class Sampler:
    """Samples of states and parameters by name, ``count`` of them, a pure function of ``seed`` and number.

    Parameters
    ----------
    values : mapping
        For a name a number or a distribution, for four names `UniformQuaternion`. The first grid
        changes slowest.
    count : int, default 0
        Of samples; with grids it may be left out: each combination once. More samples go through
        the combinations again.
    seed : int, default 0
        Of random numbers.

    Raises
    ------
    InputError
        For what does not fit.

    Notes
    -----
    Units are those of what is sampled.

    References
    ----------
    Salmon, Moraes, Dror and Shaw, Parallel random numbers: as easy as 1, 2, 3, SC 2011.

    Examples
    --------
    >>> Sampler({"k": Grid(1, 2, 3), "mass": 5.0}).sample(0, 3)
    {'k': array([1. , 1.5, 2. ]), 'mass': array([5., 5., 5.])}
    """

    values: Mapping[Names, Value]
    count: int = 0
    seed: int = 0

    def __post_init__(self) -> None:
        """Check the names and the count."""
        for names, value in self.values.items():
            size = 1 if isinstance(value, int | float) else getattr(value, "size", None)
            if not isinstance(size, int) or not (size == 1 or hasattr(value, "values")):
                raise InputError(
                    "not a distribution", where=str(names), got=shown(value),
                    expected="a number, Uniform, Normal, Grid or the like",
                )  # fmt: skip
            if len(_tuple(names)) != size:
                raise InputError(
                    "names do not fit the distribution", got=names, expected=f"{size} of them"
                )
        taken = [n for names in self.values for n in _tuple(names)]
        if len(set(taken)) < len(taken):
            raise InputError("a name has two distributions", got=", ".join(taken))
        for what, value in (("count", self.count), ("seed", self.seed)):
            if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**64:
                raise InputError(f"{what} is not a whole number from 0 to 2^64 - 1", got=value)
        count = self.count or math.prod(grid.count for grid in self._grids)
        if count > sys.maxsize:
            raise InputError("too many samples", got=count, expected=f"at most {sys.maxsize}")

    def __len__(self) -> int:
        """Return the number of samples."""
        if self.count or not self._grids:
            return self.count
        return math.prod(grid.count for grid in self._grids)

    @property
    def names(self) -> tuple[str, ...]:
        """Everything that gets values."""
        return tuple(n for names in self.values for n in _tuple(names))

    @property
    def _grids(self) -> list[Grid]:
        return [v for v in self.values.values() if isinstance(v, Grid)]

    @typed
    def sample(self, first: int, last: int) -> dict[str, Array]:
        """Return the samples from number ``first`` to before ``last``, arrays (last - first,).

        Parameters
        ----------
        first, last : int
            Numbers of the first trajectory and of that behind the last.

        Returns
        -------
        dict of str to array
            Arrays (last - first,) by name; the same numbers give the same values.

        Raises
        ------
        InputError
            For numbers below zero or out of order, and for more than `MOST_AT_ONCE`.
        """
        if not 0 <= first <= last <= first + MOST_AT_ONCE:
            raise InputError(
                "no such samples", got=f"{first} to {last}",
                expected=f"whole numbers in order, at most {MOST_AT_ONCE:,} at once",
            )  # fmt: skip
        u = self._uniform(first, last)
        places = _places(np.arange(first, last), self._grids)
        found: dict[str, Array] = {}
        row = 0
        for names, value in self.values.items():
            if isinstance(value, int | float):
                rows = np.full((1, last - first), float(value))
            elif isinstance(value, Grid):
                rows = value.values(next(places)[None])
            else:
                rows = value.values(u[row : row + value.draws])
                row += value.draws
            found.update(zip(_tuple(names), rows, strict=True))
        return found

    def _uniform(self, first: int, last: int) -> Array:
        """Return numbers inside (0, 1), one row a draw."""
        draws = sum(v.draws for v in self.values.values() if not isinstance(v, int | float))
        if not draws:
            return np.empty((0, last - first))
        counters = -(-draws // A_COUNTER)
        bits = np.random.Philox(key=self.seed, counter=first * counters)
        width = counters * A_COUNTER
        rows = bits.random_raw((last - first) * width).reshape(last - first, width)[:, :draws].T
        return ((rows >> np.uint64(12)).astype(np.float64) + 0.5) * 2.0**-52


def _places(numbers: NDArray[np.int64], grids: Sequence[Grid]) -> Iterator[Array]:
    """Yield for each grid the place of every sample in it."""
    size = math.prod(g.count for g in grids)
    for grid in grids:
        size //= grid.count
        yield (numbers // size % grid.count).astype(np.float64)


def _tuple(names: Names) -> tuple[str, ...]:
    return (names,) if isinstance(names, str) else tuple(names)


_CALL = re.compile(r"\s*([a-z]+)\s*(?:\(([^()]*)\))?\s*")


@dataclass(frozen=True)
class Kind:
    """A row: how a distribution is written, what it is, and what makes it of its numbers."""

    usage: str
    meaning: str
    make: Callable[..., Value]

    @property
    def name(self) -> str:
        """The word before the bracket."""
        return self.usage.partition("(")[0]

    @property
    def numbers(self) -> int:
        """How many numbers it takes."""
        return len([n for n in self.usage.partition("(")[2].rstrip(")").split(",") if n])


def _grid(low: float, high: float, count: float) -> Grid:
    return Grid(low, high, int(count) if count.is_integer() else -1)


KINDS = (
    Kind("uniform(LOW, HIGH)", "each value between as likely as the other", Uniform),
    Kind("normal(MEAN, DEVIATION)", "the normal distribution", Normal),
    Kind("grid(LOW, HIGH, COUNT)", "equal distances; grids of several names are crossed", _grid),
    Kind("attitude()", "of q0,q1,q2,q3: each attitude as likely as the other", UniformQuaternion),
)


def distribution(given: str | float, where: str, unit: str = "") -> Value:
    """Return a distribution, or the number that stands for all.

    ``unit``: of what is sampled, nothing where it is not known; numbers may have others, as in
    ``normal(30 deg, 1 deg)``. Raises `InputError` for what is neither, with ``where`` it stands, and for
    values of another dimension.
    """
    if isinstance(given, int | float) and not isinstance(given, bool):
        return float(given)
    number = _number(given, unit, where) if isinstance(given, str) else None
    if number is not None:
        return number
    call = _CALL.fullmatch(given) if isinstance(given, str) else None
    if call is None:
        expected = "a number or " + ", ".join(kind.usage for kind in KINDS)
        raise InputError("not a distribution", where=where, got=given, expected=expected)
    kind = next((kind for kind in KINDS if kind.name == call[1]), None)
    if kind is None:
        raise unknown_name("distribution", call[1], [kind.name for kind in KINDS], where)
    numbers = (
        [_number(word, unit, where) for word in (call[2] or "").split(",")]
        if (call[2] or "").strip()
        else []
    )
    if len(numbers) != kind.numbers or None in numbers:
        raise InputError(
            "not the numbers of a distribution", where=where, got=given, expected=kind.usage
        )
    try:
        return kind.make(*numbers)
    except InputError as error:
        raise InputError(error.what, where=where, got=given, expected=error.expected) from None


def _number(text: str, unit: str, where: str) -> float | None:
    measured = in_unit(text, unit, where)
    if measured is not None:
        return nearest(measured)
    try:
        return float(text)
    except ValueError:
        return None


def names(text: str, where: str) -> Names:
    """Return a name, or several that are parted by commas. Raises `InputError` for an empty one."""
    found = tuple(name.strip() for name in text.split(","))
    if not all(found):
        raise InputError(
            "a name is missing", where=where, got=text, expected="NAME or NAME,NAME,..."
        )
    return found[0] if len(found) == 1 else found


def sampler_of(
    values: Mapping[str, str | float], count: int, seed: int, units: Mapping[str, str] | None = None
) -> Sampler:
    """Return the sampler of distributions in words by name, or by names parted by commas.

    ``units``: of what is sampled, by name, as far as they are known. Raises `InputError` for what cannot be
    read, for values of another dimension, and for names that do not fit.
    """
    own = units or {}
    found = {
        names(name, name): distribution(given, name, own.get(name, ""))
        for name, given in values.items()
    }
    return Sampler(found, count, seed)
