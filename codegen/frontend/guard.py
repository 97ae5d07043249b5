"""Test at run time what was assumed when a system was derived."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from codegen.frontend.lower import lower_expressions
from codegen.ir.interpret import Point, interpret
from codegen.ir.program import Program
from eom.errors import AssumptionError, InputError, unknown_name
from eom.quantities import Assumption
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

        ``values``: by name; ``where``: for the message.
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
        """Return the guard with the conditions of ``system``."""
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

    def check(self, values: Mapping[str, float]) -> None:
        """Refuse ``values`` by name that contradict an assumption or that the system does not know.

        A name that the system no longer has but that an assumption speaks of is tested against
        it: a torque given to a torque-free system, a third moment of inertia to a symmetric one.
        Only conditions all of whose symbols have values are tested.

        Raises `AssumptionError` for contradictions, `InputError` for unknown names and for
        parameters that must be positive and are not.
        """
        where = f"system {self.system!r}"
        spoken_of = {n for c in self.conditions for n in c.names}
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
            if all(n in values for n in condition.names):
                condition.check(values, where)


def _condition(assumption: Assumption, expression: Any, is_zero: bool) -> Condition:
    symbols = sorted(expression.free_symbols, key=lambda s: str(s.name))
    program = lower_expressions({"value": [expression]}, [], symbols)
    return Condition(assumption, expression, is_zero, tuple(str(s.name) for s in symbols), program)
