"""Where the trajectories of an ensemble start: arrays by name or in order, or a sampler."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Protocol, runtime_checkable

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.frontend.layout import names_of
from codegen.frontend.structure import Condition
from codegen.ir.identity import SameObject
from codegen.native.trajectory import Array
from eom.errors import AssumptionError, InputError, shown, unknown_name
from eom.system import System


@runtime_checkable
class Samples(Protocol):
    """Values by name for the trajectories of any range, always the same: `Sampler`, or your own."""

    @property
    def names(self) -> Sequence[str]:
        """States and parameters that get values."""

    def __len__(self) -> int:
        """Return how many there are."""

    def sample(self, first: int, last: int) -> Mapping[str, Array]:
        """Return arrays (last - first,) for the trajectories from ``first`` to before ``last``."""


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


def check(compiled: Compiled, x: Array, p: Array, u: Array, first: int) -> None:
    """Test states (n, N), parameters and inputs against what the system assumes.

    Raises `AssumptionError` for the first trajectory that contradicts, `InputError` for parameters
    that must be positive and are not.
    """
    layout, guard = compiled.layout, compiled.guard
    columns = dict(zip(names_of(layout.states), x, strict=True))
    columns |= dict(zip(names_of(layout.parameters), p, strict=True))
    columns |= dict(zip(names_of(layout.inputs), u, strict=True))
    known = _completed(compiled, columns)
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
        where=f"trajectory {first + at}",
        got=", ".join(f"{n} = {v!r}" for n, v in got.items()),
        expected=f"{condition.expression} {'= 0' if condition.is_zero else '>= 0'}",
        hint="derive the system again without this assumption, or correct the values",
    )


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
        columns = np.stack(np.broadcast_arrays(*(np.atleast_1d(known[n]) for n in order)))
        found: Array = compiled.rhs(0.0, np.zeros((1, columns.shape[1])), columns)[0]
        return found

    return at
