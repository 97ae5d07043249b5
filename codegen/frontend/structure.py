"""Fit a system to what is known of its structure before code is generated.

Parameters that equal one another or a number, states that stay at a value, inputs that are held:
their slots disappear, and what becomes zero or equal by it is folded away.

Test at run time what was assumed when a system was derived.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from codegen.frontend.attitude import moved
from codegen.frontend.layout import Layout, to_array
from codegen.frontend.lower import lower_expressions
from codegen.ir.interpret import Point, interpret, interpret_exactly, random_point
from codegen.ir.passes import Slot, prune, substitute
from codegen.ir.program import RATES, Program
from codegen.ir.residues import vanishing
from eom.errors import AssumptionError, InputError, unknown_name
from eom.quantities import TIME, Assumption
from eom.system import System


@dataclass(frozen=True)
class Condition:
    """One testable condition of an assumption: zero, or not negative.

    ``expression``: over ``names``; ``is_zero``: whether it is to vanish, else to be at least zero;
    ``program``: what computes it.
    """

    assumption: Assumption
    expression: Any
    is_zero: bool
    names: tuple[str, ...]
    program: Program

    def check(self, values: Mapping[str, float], where: str) -> None:
        """Raise `AssumptionError` if the numbers contradict the condition.

        Parameters
        ----------
        values : mapping of str to floats
            By name.
        where : str
            For the message.

        Raises
        ------
        AssumptionError
            If the numbers contradict the condition.

        Notes
        -----
        A difference counts as zero against the largest of the values; a single value must be zero.
        """
        numbers = [float(values[n]) for n in self.names]
        found = interpret(self.program, Point(p=numbers))["value"][0]
        slack = self.assumption.tolerance * max(map(abs, numbers)) if len(numbers) > 1 else 0.0
        holds = abs(found) <= slack if self.is_zero else found >= -slack
        if holds:
            return
        raise AssumptionError(
            f"values contradict the assumption {self.assumption.name}: {self.assumption.meaning}",
            where=where,
            got=", ".join(f"{n} = {v!r}" for n, v in zip(self.names, numbers, strict=True)),
            expected=f"{self.expression} {'= 0' if self.is_zero else '>= 0'}",
            hint="derive the system again without this assumption, or correct the values",
        )


@dataclass(frozen=True)
class Guard:
    """All conditions of a system, and the names that it knows.

    ``system``: its name; ``known``: names of its states, parameters and inputs; ``conditions``: of all its
    assumptions.
    """

    system: str
    known: frozenset[str]
    positive: Mapping[str, str]
    """Meaning of each parameter that must be positive."""
    conditions: tuple[Condition, ...]

    @classmethod
    def of(cls, system: System) -> Guard:
        """Return the guard with the conditions of ``system``.

        Parameters
        ----------
        system : System
            Whose assumptions are compiled.

        Returns
        -------
        Guard
            The conditions of the system.
        """
        conditions = [
            _condition(a, e, is_zero)
            for a in system.assumptions
            for group, is_zero in ((a.vanish, True), (a.nonnegative, False))
            for e in group
            if e.free_symbols
        ]
        known = frozenset((*system.state_names, *system.parameter_names, *system.input_names))
        positive = {q.name: q.meaning for q in system.parameters if q.symbol.is_positive}
        return cls(system.name, known, positive, tuple(conditions))

    def check(self, values: Mapping[str, float], time: float | None = None) -> None:
        """Refuse values that contradict an assumption or that the system does not know.

        Parameters
        ----------
        values : mapping of str to floats
            By name.
        time : float, optional
            Where a run starts (s); without, what is assumed of the time is not tested.

        Raises
        ------
        AssumptionError
            For contradictions.
        InputError
            For unknown names and for parameters that must be positive and are not.

        Notes
        -----
        A name that the system no longer has but that an assumption speaks of is tested against it:
        a torque given to a torque-free system, a third moment of inertia to a symmetric one. Only
        conditions all of whose symbols have values are tested.
        """
        where = f"system {self.system!r}"
        spoken_of = {n for c in self.conditions for n in c.names} - {TIME.name}
        known = values if time is None else {**values, TIME.name: time}
        for name, value in values.items():
            if name not in self.known and name not in spoken_of:
                raise unknown_name("name", name, self.known, where)
            if name in self.positive and not value > 0:
                raise InputError(
                    f"parameter {name} is not positive",
                    where=f"{where}: {self.positive[name]}",
                    got=value,
                )
        for condition in self.conditions:
            if all(n in known for n in condition.names):
                condition.check(known, where)


def _condition(assumption: Assumption, expression: Any, is_zero: bool) -> Condition:
    symbols = sorted(expression.free_symbols, key=lambda s: str(s.name))
    program = lower_expressions({"value": [expression]}, [], symbols)
    return Condition(assumption, expression, is_zero, tuple(str(s.name) for s in symbols), program)


@dataclass(frozen=True)
class Structure:
    """What is fixed: numbers of parameters, parameters equal to others, held states and inputs.

    ``parameters``, ``states``, ``inputs``: values by name, in the units of the system. ``equal``: by the
    name of a parameter the name of the one that takes its place.
    """

    parameters: Mapping[str, float]
    equal: Mapping[str, str]
    states: Mapping[str, float]
    inputs: Mapping[str, float]

    @classmethod
    def of(
        cls,
        system: System,
        parameters: Mapping[str, float | str] | None = None,
        states: Mapping[str, float] | None = None,
        inputs: Mapping[str, float] | None = None,
    ) -> Structure:
        """Return what the user fixes of a system.

        Parameters
        ----------
        system : System
            Whose names are meant.
        parameters : mapping of str to float or str, optional
            As of `codegen.compile`; a string names another parameter.
        states, inputs : mapping of str to floats, optional
            As of `codegen.compile`.

        Returns
        -------
        Structure
            Checked against the system's assumptions.

        Raises
        ------
        InputError
            For unknown names, for parameters that are equal in a circle and for values that are not
            finite numbers.
        AssumptionError
            For values that contradict the system's assumptions.
        """
        given = dict(parameters or {})
        equal, numbers = _equal(system, given)
        held = {"state": dict(states or {}), "input": dict(inputs or {})}
        for name in held["input"]:
            if name in system.held:
                raise InputError(f"input {name} is set by a sampled law, and not compiled in",
                                 where=f"system {system.name!r}", got=held["input"][name])  # fmt: skip
        for kind, known in (("state", system.state_names), ("input", system.input_names)):
            _known(kind, held[kind], known, system)
            to_array(list(held[kind].values()), list(held[kind]), kind)
        found = cls(numbers, equal, held["state"], held["input"])
        Guard.of(system).check(found.completed(numbers | held["state"] | held["input"]))
        own = {n: v for n, v in numbers.items() if n in system.parameter_names}
        to_array(list(own.values()), list(own), "parameter")
        return found

    @property
    def names(self) -> tuple[str, ...]:
        """Everything that is fixed."""
        return (*self.parameters, *self.equal, *self.states, *self.inputs)

    def completed(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return values with those of everything that is fixed by them.

        Parameters
        ----------
        values : mapping of str to floats
            By name.

        Returns
        -------
        dict of str to floats
            By name, too.
        """
        known = {**self.parameters, **self.states, **self.inputs, **values}
        return known | {n: known[other] for n, other in self.equal.items() if other in known}

    def without(self, kind: str, given: Any) -> Any:
        """Return values without those that are fixed.

        Parameters
        ----------
        kind : str
            ``state``, ``parameter`` or ``input``.
        given : mapping or array
            The values; in order they stay as they are.

        Returns
        -------
        object
            In the form in which they are given.

        Raises
        ------
        InputError
            For a value that contradicts, and for every parameter that is fixed.
        """
        if not isinstance(given, Mapping):
            return given
        parameters: Mapping[str, float | str] = {**self.parameters, **self.equal}
        held = {"state": self.states, "input": self.inputs}
        fixed = held.get(kind, parameters)
        for name in given:
            if name in fixed and (kind == "parameter" or given[name] != fixed[name]):
                raise InputError(
                    f"{kind} {name} was compiled in", got=given[name], expected=fixed[name]
                )
        return {n: v for n, v in given.items() if n not in fixed}


def _known(kind: str, given: Mapping[str, object], known: Sequence[str], system: System) -> None:
    for name in given:
        if name not in known:
            raise unknown_name(kind, name, known, f"system {system.name!r}")


def _equal(
    system: System, given: Mapping[str, float | str]
) -> tuple[dict[str, str], dict[str, float]]:
    """Follow names of parameters to the one that stays, or to its number."""
    links = {n: v for n, v in given.items() if isinstance(v, str)}
    numbers = {n: v for n, v in given.items() if not isinstance(v, str)}
    _known("parameter", links, system.parameter_names, system)
    _known("parameter", dict.fromkeys(links.values()), system.parameter_names, system)
    equal = {}
    for name in links:
        chain = [name]
        while chain[-1] in links:
            chain.append(links[chain[-1]])
            if chain[-1] in chain[:-1]:
                raise InputError("parameters are equal in a circle", got=" = ".join(chain))
        if chain[-1] in numbers:
            numbers[name] = numbers[chain[-1]]
        else:
            equal[name] = chain[-1]
    return equal, numbers


def fit(program: Program, system: System, structure: Structure) -> tuple[Program, Layout]:
    """Return program and layout without what ``structure`` fixes.

    Law: the results are those of the system where its parameters, states and inputs have the
    values that are fixed; rates of held states are zero and left out. Raises `InputError` for a
    held state whose rate is not zero.
    """
    if not structure.names:
        return prune(program), Layout.of(system)
    leaves = {
        **_slots("parameter", system.parameter_names, structure.parameters, structure.equal),
        **_slots("state", system.state_names, structure.states, {}),
        **_slots("input", system.input_names, structure.inputs, {}),
    }
    fitted = substitute(program, leaves)
    layout = Layout.of(system).without({*structure.parameters, *structure.equal})
    kinds = ("state", "parameter", "input")
    layout = replace(layout, attitudes=moved(layout.attitudes, leaves, kinds))
    if not structure.states and not structure.inputs:
        return fitted, layout
    return _without_held(fitted, system, layout, structure)


def _slots(
    kind: str, names: Sequence[str], numbers: Mapping[str, float], equal: Mapping[str, str]
) -> dict[Slot, Slot | Fraction]:
    """Return what takes the place of each slot; the slots that stay close ranks, in order."""
    rest = [n for n in names if n not in numbers and n not in equal]
    place = {n: (kind, k) for k, n in enumerate(rest)}
    return {
        (kind, k): Fraction(float(numbers[n])) if n in numbers else place[equal.get(n, n)]
        for k, n in enumerate(names)
    }


def _without_held(
    program: Program, system: System, layout: Layout, structure: Structure
) -> tuple[Program, Layout]:
    names = system.state_names
    held = [k for k, n in enumerate(names) if n in structure.states]
    rest = [k for k in range(len(names)) if k not in held]
    _check_held(program, system, layout, structure, held)
    results = dict(program.results)
    results[RATES] = tuple(program.results[RATES][k] for k in rest)
    place = {k: n for n, k in enumerate(rest)}
    smaller = replace(
        layout,
        states=tuple(q for q in layout.states if q.name not in structure.states),
        inputs=tuple(q for q in layout.inputs if q.name not in structure.inputs),
        results={**layout.results, RATES: tuple(names[k] for k in rest)},
        coordinates=tuple(place.get(k, -1) for k in layout.coordinates),
    )
    if not rest:
        raise InputError("no state is left", where=f"system {system.name!r}", got=", ".join(names))
    return prune(replace(program, results=results)), smaller


def _check_held(
    program: Program, system: System, layout: Layout, structure: Structure, held: Sequence[int]
) -> None:
    """Refuse held states whose rates are not zero."""
    rates = program.results[RATES]
    only = prune(replace(program, results={RATES: tuple(rates[k] for k in held)}))
    found = first_not_zero(only, RATES)
    if found is None:
        return
    which, value = found
    name = system.state_names[held[which]]
    rest = [n for n in system.state_names if n not in structure.states]
    inputs = [n for n in system.input_names if n not in structure.inputs]
    alone = prune(replace(only, results={RATES: (only.results[RATES][which],)}))
    known = {"state": rest, "input": inputs}
    varying = [
        known[i.op][i.value]
        for i in alone.instructions
        if i.op in known and isinstance(i.value, int)
    ]
    raise InputError(
        f"state {name} does not stay at {structure.states[name]!r}: its rate is not zero",
        where=f"system {layout.name!r}",
        got=f"d({name})/dt = {_rate(system, held[which])}, for example {float(value):.3g}",
        expected="a rate that is zero at all values of what is not held",
        hint=f"the rate depends on {', '.join(varying)}: hold these too" if varying else "",
    )


def _rate(system: System, k: int) -> str:
    if system.mass_matrix is not None:
        return "a solution with the mass matrix"
    return str(system.rates[k])[:200]


def first_not_zero(program: Program, group: str) -> tuple[int, Any] | None:
    """Return place of the first result that is not proved to be zero, and its value at some point.

    What folds to zero is zero; the rest is decided modulo a prime (`codegen.ir.residues`).
    """
    zero = vanishing(program, group)
    if all(zero):
        return None
    k = zero.index(False)
    return k, interpret_exactly(program, random_point(program, 0))[group][k]
