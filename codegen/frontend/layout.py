"""What the arrays of a compiled system hold: names and units of each slot, and how they are checked.

Values of a program as short texts, for errors.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from codegen.frontend.attitude import Stated, stated_of
from codegen.ir.ops import LEAVES
from codegen.ir.passes import needed
from codegen.ir.program import (
    GROUPS,
    INVARIANTS,
    OUTPUTS,
    RATES,
    SAMPLES,
    SINGULARITIES,
    Program,
)
from eom.errors import InputError, near_matches, shown, unknown_name
from eom.quantities import Quantity, Sampling
from eom.system import System
from eom.tables import Table
from eom.units import number_in

V = TypeVar("V")


class Slope(NamedTuple):
    """What a state is the derivative of, and by what: names of a state, and of a parameter or a state.

    By a state that is by its first value.
    """

    of: str
    by: str
    by_parameter: bool


@dataclass(frozen=True)
class Layout:
    """Names and units of states, parameters, inputs and of each group of results.

    ``states``, ``parameters``, ``inputs``: quantities in the order of the arrays ``x``, ``p``, ``u``.
    """

    name: str
    title: str
    states: tuple[Quantity, ...]
    parameters: tuple[Quantity, ...]
    inputs: tuple[Quantity, ...]
    results: Mapping[str, tuple[str, ...]]
    """Names of the results by group."""
    coordinates: tuple[int, ...] = ()
    """For each singularity the number of the state that it is about, or -1."""
    described: Mapping[str, tuple[Quantity, ...]] = field(default_factory=dict)
    """Quantities of the groups of results that have units: outputs and invariants."""

    patterns: Mapping[str, tuple[tuple[int, int], ...]] = field(default_factory=dict)
    """Place (row, column) of each entry of a Jacobian, by the group that it is in the end of."""

    attitudes: tuple[Stated, ...] = ()
    """What the system states of its bodies."""

    winding: tuple[str, ...] = ()
    """Names of the outputs that jump by whole turns (`eom.system.SequenceAngles`)."""

    slopes: Mapping[str, Slope] = field(default_factory=dict)
    """The states that are derivatives of others, by name (`codegen.sensitivities`)."""

    @classmethod
    def of(cls, system: System) -> Layout:
        """Return the layout of a system.

        Parameters
        ----------
        system : System
            Whose quantities get places in arrays.

        Returns
        -------
        Layout
            In the order of the system.
        """
        results = {
            RATES: system.state_names,
            OUTPUTS: system.output_names,
            INVARIANTS: system.invariant_names,
            SINGULARITIES: tuple(str(s.expression) for s in system.singularities),
        }
        assert tuple(results) == GROUPS
        if system.sampled:
            results[SAMPLES] = system.held
        title = system.title or system.name
        number = {q.symbol: k for k, q in enumerate(system.states)}
        coordinates = tuple(number.get(s.coordinate, -1) for s in system.singularities)
        return cls(
            system.name,
            title,
            system.states,
            system.parameters,
            system.inputs,
            results,
            coordinates,
            {
                OUTPUTS: tuple(d.quantity for d in system.outputs),
                INVARIANTS: tuple(d.quantity for d in system.invariants),
                SAMPLES: tuple(
                    _when(d.quantity, s, d in s.laws) for s in system.sampled for d in s.rows
                ),
            },
            attitudes=stated_of(system),
            winding=tuple(n for a in system.angles for n in a.winding),
        )

    def without(self, fixed: Collection[str]) -> Layout:
        """Return the layout without parameters that are fixed to numbers.

        Parameters
        ----------
        fixed : collection of str
            Their names.

        Returns
        -------
        Layout
            The others keep their order.
        """
        return replace(self, parameters=tuple(q for q in self.parameters if q.name not in fixed))

    def quantities(self) -> dict[str, tuple[Quantity, ...]]:
        """Return by kind (state, parameter, input, output, invariant) what has a name and a unit."""
        results = {
            kind: tuple(q for q in self.described.get(group, ()) if q.name in self.results[group])
            for kind, group in (("output", OUTPUTS), ("invariant", INVARIANTS))
        }
        given = {"state": self.states, "parameter": self.parameters, "input": self.inputs}
        return {**given, **results}

    @property
    def known(self) -> tuple[Quantity, ...]:
        """All that has a name and a unit."""
        return tuple(q for group in self.quantities().values() for q in group)

    @property
    def winds(self) -> tuple[str, ...]:
        """Names of the outputs that jump by whole turns, of those that are there."""
        return tuple(n for n in self.results.get(OUTPUTS, ()) if n in self.winding)

    @property
    def sizes(self) -> dict[str, int]:
        """Number of results of each group, the empty ones left out."""
        return {g: len(names) for g, names in self.results.items() if names}


def _when(quantity: Quantity, sampling: Sampling, waits: bool) -> Quantity:
    """Return a quantity that is held, with when it changes in its meaning."""
    delay = f", in effect {sampling.delay!r} s later" if waits and sampling.delay else ""
    return replace(quantity, meaning=f"evaluated every {sampling.period!r} s{delay}")


def names_of(quantities: Sequence[Quantity]) -> tuple[str, ...]:
    """Return the names of quantities."""
    return tuple(q.name for q in quantities)


def in_si(values: Any, quantities: Sequence[Quantity]) -> Any:
    """Return values by name in SI: texts with units, as "30 deg", converted, others as they are.

    Raises `InputError` for texts that are no numbers, unknown units, and other dimensions than the
    quantities have.
    """
    if not isinstance(values, Mapping) or not any(isinstance(v, str) for v in values.values()):
        return values
    units = {q.name: q.unit for q in quantities}
    return {n: number_in(v, units.get(n, ""), f"value of {n}") for n, v in values.items()}


def completed(values: Any, quantities: Sequence[Quantity]) -> Any:
    """Return values by name in SI, with defaults where there are none; values in order as they are."""
    values = in_si(values, quantities)
    standing = {q.name: q.default for q in quantities if q.default is not None}
    if not standing or not (values is None or isinstance(values, Mapping)):
        return values
    return standing | dict(values or {})


def settled(initial: Any, parameters: Any, quantities: Sequence[Quantity]) -> tuple[Any, Any]:
    """Return initial values and parameters, with those of states that are held among the latter.

    What is given of a held state among the initial values counts: a run starts there. ``quantities``: the
    parameters. Values in order have no such state among them, and stay.
    """
    held = {q.name for q in quantities if q.held}
    moved = {n: v for n, v in initial.items() if n in held} if isinstance(initial, Mapping) else {}
    if not moved:
        return initial, parameters
    if not isinstance(parameters, Mapping):
        names = names_of(quantities)
        values = [] if parameters is None else to_array(parameters, names, "parameter").tolist()
        parameters = dict(zip(names, values, strict=False))
    return {n: v for n, v in initial.items() if n not in held}, {**parameters, **moved}


def to_array(
    values: Mapping[str, float] | Sequence[float] | NDArray[np.float64] | None,
    names: Sequence[str],
    kind: str,
) -> NDArray[np.float64]:
    """Return values by name, or in order, as an array; every name needs a finite number.

    Raises `InputError` for unknown, missing and non-finite values and for wrong lengths.
    """
    if isinstance(values, Mapping):
        values = in_order(values, names, kind)
    try:
        array = np.array([] if values is None else values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{kind}s are not numbers", got=shown(values)) from None
    if array.shape != (len(names),):
        raise InputError(
            f"wrong number of {kind}s",
            got=f"shape {array.shape}",
            expected=f"{len(names)}: {', '.join(names)}" if names else "none",
            hint=f"give them by name: {{{names[0]!r}: ...}}" if len(names) else "",
        )
    for name, value in zip(names, array, strict=True):
        if not np.isfinite(value):
            raise InputError(f"{kind} {name} is not finite", got=value)
    return array


def in_order(values: Mapping[str, V], names: Sequence[str], kind: str) -> list[V]:
    """Return values by name in the order of the names.

    ``kind``: state, parameter, input. Raises `InputError` for unknown and missing names, with all of both.
    """
    unknown = [n for n in values if n not in names]
    missing = [n for n in names if n not in values]
    if any(not isinstance(n, str) for n in unknown):
        raise unknown_name(kind, next(n for n in unknown if not isinstance(n, str)), names)
    wrong = (("unknown", "", [repr(n) for n in unknown]), ("missing", ":", missing))
    parts = [
        f"{what} {kind}{'s' if len(found) > 1 else ''}{sign} {', '.join(found)}"
        for what, sign, found in wrong
        if found
    ]
    if parts:
        hint = near_matches(unknown[0], names) if unknown else ""
        raise InputError("; ".join(parts), hint=hint)
    return [values[n] for n in names]


MAX_EXCERPT = 120
"""Characters of an expression in an error."""


def excerpt(program: Program, layout: Layout, number: int) -> str:
    """Return a value of a program as text in the names of the layout, cut where it is long."""
    kinds = {"state": layout.states, "parameter": layout.parameters, "input": layout.inputs}
    texts: dict[int, str] = {}
    for k in sorted(needed(Program(program.instructions, {"": (number,)}), [""])):
        op, args, value = program.instructions[k]
        if k in program.names and k != number:
            text = program.names[k].name
        elif op in kinds and isinstance(value, int):
            text = kinds[op][value].name
        elif op in LEAVES:
            text = op if value is None else str(value)
        else:
            label = f"{value.label} " if isinstance(value, Table) else ""
            text = f"{op}({label}{', '.join(texts[a] for a in args)})"
        texts[k] = text if len(text) <= MAX_EXCERPT else f"{text[: MAX_EXCERPT - 3]}..."
    return texts[number]
