"""The contract between deriving and computing: one frozen system of equations of motion.

A `System` holds plain SymPy symbols and expressions over them, no ``Function('x')(t)`` and no
``Derivative``. ``codegen`` reads this module, `eom.tables` (curves that stand in expressions) and
`eom.errors`, and nothing else of ``eom``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError

Expr = Any  # a SymPy expression; SymPy ships no types

TIME = sp.Symbol("t", real=True)


def as_expression(value: Any) -> Expr:
    """Return a number or SymPy expression as a SymPy expression; text is never read as one.

    Raises `InputError` for everything else, strings above all.
    """
    try:
        return sp.sympify(value, strict=True)
    except sp.SympifyError:
        raise InputError(
            "not a number or a SymPy expression",
            got=f"{type(value).__name__} {value!r}"[:200],
            hint="build expressions from SymPy symbols; formulas as text belong in a scene",
        ) from None


@dataclass(frozen=True)
class Quantity:
    """A symbol with its SI unit, a one-line meaning and its LaTeX form.

    ``symbol``: of SymPy, as a rule with ``real=True``. ``unit``: as text, for example kg m^2 or rad/s;
    ``1`` or nothing where there is none. ``meaning``, ``latex``: for pages; nothing is computed from them.
    """

    symbol: Expr
    unit: str = ""
    meaning: str = ""
    latex: str = ""

    @property
    def name(self) -> str:
        """The symbol's name."""
        return str(self.symbol.name)

    @property
    def description(self) -> str:
        """The meaning, with the unit in brackets."""
        return self.meaning + (f" [{self.unit}]" if self.unit not in {"", "1"} else "")


@dataclass(frozen=True)
class Definition:
    """A named expression: an intermediate, an output or a constant of the motion.

    ``quantity``: the name, with its SI unit. ``expression``: over states, parameters, inputs, time and
    definitions before it.
    """

    quantity: Quantity
    expression: Expr

    @property
    def name(self) -> str:
        """The name of the quantity that is defined."""
        return self.quantity.name

    @property
    def symbol(self) -> Expr:
        """The symbol of the quantity that is defined."""
        return self.quantity.symbol


@dataclass(frozen=True)
class Singularity:
    """A configuration in which the chosen coordinates fail: ``expression`` is zero there.

    ``expression``: over states, parameters, inputs and time; its absolute value is the distance from the
    configuration, in its own unit. ``coordinate`` is the state to name in a report (the middle angle of a
    rotation sequence). ``meaning``: what happens there.
    """

    expression: Expr
    coordinate: Expr
    meaning: str = ""


@dataclass(frozen=True)
class Assumption:
    """What was assumed, as data that can be tested on numbers.

    Every expression of ``vanish`` is zero and every one of ``nonnegative`` is at least zero when
    the assumption holds. The expressions may use symbols that the system no longer has, so that
    values given for them can be tested against what was assumed. ``meaning``: in words. What has no
    expressions is stated and not tested.
    """

    name: str
    meaning: str
    vanish: tuple[Expr, ...] = ()
    nonnegative: tuple[Expr, ...] = ()
    tolerance: float = 1e-9
    """How far from holding values may be, relative to the largest of them."""


@dataclass(frozen=True)
class System:
    """Equations of motion: ``mass_matrix * d(states)/dt = rates``, or ``d(states)/dt = rates``.

    ``states``, ``parameters``, ``inputs``: quantities, in the order of every array of values.
    ``definitions``: named intermediates, each over the symbols before it.
    ``rates``: one expression a state. ``mass_matrix``: symmetric SymPy matrix, or None for identity.
    ``outputs``, ``invariants``: named expressions; invariants are constant along every solution.
    ``singularities``, ``assumptions``: see their types. ``maintained``: names of invariants onto which
    integration brings the state back unless told otherwise. ``time``: the symbol of time. Units are SI;
    angles are in radians.

    Shapes, for n states: ``states`` and ``rates`` (n,), ``mass_matrix`` (n, n). Frames and signs are said
    by the meanings of the quantities. Two systems are equal if all but their titles are.

    Raises `InputError` for repeated names, free symbols without a meaning, or wrong lengths.
    """

    name: str
    states: tuple[Quantity, ...]
    rates: tuple[Expr, ...]
    parameters: tuple[Quantity, ...] = ()
    inputs: tuple[Quantity, ...] = ()
    time: Expr = TIME
    definitions: tuple[Definition, ...] = ()
    mass_matrix: Expr | None = None
    outputs: tuple[Definition, ...] = ()
    invariants: tuple[Definition, ...] = ()
    singularities: tuple[Singularity, ...] = ()
    assumptions: tuple[Assumption, ...] = ()
    maintained: tuple[str, ...] = ()
    title: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        _check_names(self)
        _check_shapes(self)
        _check_symbols(self)

    @classmethod
    def from_rates(
        cls,
        name: str,
        rates: Mapping[Expr, Expr],
        *,
        inputs: Iterable[Expr] = (),
        time: Expr = TIME,
        outputs: Mapping[str, Expr] | None = None,
        invariants: Mapping[str, Expr] | None = None,
    ) -> System:
        """Return a system of ``{state symbol: rate}``; what else is free becomes a parameter.

        ``rates``: one expression a state, in the order of the states. ``inputs``: symbols of inputs.
        ``time``: the symbol of time, SymPy's real ``t``. ``outputs``, ``invariants``: expressions by name;
        that an invariant is constant is not tested. Parameters are in the order of their names. Any
        consistent units. Raises `InputError` for text in place of expressions, and as `System` does.

        >>> y1, y2, k = sp.symbols("y1 y2 k")
        >>> System.from_rates("oscillator", {y1: y2, y2: -k * y1}).parameter_names
        ('k',)
        """
        inputs = tuple(inputs)
        named = [_named(group or {}) for group in (outputs, invariants)]
        expressions = [as_expression(rate) for rate in rates.values()]
        everything = [*expressions, *(d.expression for group in named for d in group)]
        free = set().union(*(e.free_symbols for e in everything)) - {*rates, *inputs, time}
        return cls(
            name=name,
            states=tuple(Quantity(s) for s in rates),
            rates=tuple(expressions),
            parameters=tuple(Quantity(s) for s in sorted(free, key=lambda s: str(s.name))),
            inputs=tuple(Quantity(s) for s in inputs),
            time=time,
            outputs=named[0],
            invariants=named[1],
        )

    def __repr__(self) -> str:
        """Name what there is; `eom.printing.show` writes it out."""
        groups = {
            "states": self.state_names,
            "parameters": self.parameter_names,
            "inputs": self.input_names,
            "outputs": self.output_names,
            "invariants": self.invariant_names,
        }
        named = [f"{kind} {', '.join(names)}" for kind, names in groups.items() if names]
        return f"System({self.name!r}: {'; '.join(named)})"

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of the states, in order."""
        return tuple(q.name for q in self.states)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters, in order."""
        return tuple(q.name for q in self.parameters)

    @property
    def input_names(self) -> tuple[str, ...]:
        """Names of the inputs, in order."""
        return tuple(q.name for q in self.inputs)

    @property
    def output_names(self) -> tuple[str, ...]:
        """Names of the outputs, in order."""
        return tuple(d.name for d in self.outputs)

    @property
    def invariant_names(self) -> tuple[str, ...]:
        """Names of the constants of the motion, in order."""
        return tuple(d.name for d in self.invariants)

    @cached_property
    def _full_definitions(self) -> dict[Expr, Expr]:
        full: dict[Expr, Expr] = {}
        for definition in self.definitions:
            full[definition.symbol] = definition.expression.xreplace(full)
        return full

    def expand(self, expression: Expr) -> Expr:
        """Return ``expression`` over states, parameters, inputs and time alone.

        Raises `InputError` for what is no expression, text above all.
        """
        return as_expression(expression).xreplace(self._full_definitions)

    def rate_of(self, expression: Expr) -> Expr:
        """Return the time derivative of ``expression`` along the motion, by the chain rule.

        Raises `InputError` where the system has a mass matrix: its rates are not explicit.
        """
        if self.mass_matrix is not None:
            raise InputError("rate_of needs explicit rates", where=self.name, got="a mass matrix")
        full = self.expand(expression)
        terms = [
            full.diff(q.symbol) * self.expand(r)
            for q, r in zip(self.states, self.rates, strict=True)
        ]
        return sp.Add(*terms, full.diff(self.time))


@dataclass(frozen=True)
class Charts:
    """One motion in two sets of coordinates, and what takes each to the other.

    ``first``: in angles, ``second``: without their singularity; its first singularity expression is
    zero where it hands back. ``forth``: states of ``first``, outputs the states of ``second`` in
    order; ``back`` the other way, with the parameters ``branch`` (sign of the singular function) and
    ``first_angle``, and as last outputs the third angle that fits that, and |singular function|.
    The first three states of ``second`` are the angular velocity. ``angles``: places of the three
    angles among the states of ``first``; ``symmetric``: whether the first and last axis are the
    same, and the singular function is the sine of the second angle, not the cosine. ``enter``:
    |singular function| at which angles are left.
    """

    first: System
    second: System
    forth: System
    back: System
    angles: tuple[int, int, int]
    symmetric: bool
    enter: float


def _named(group: Mapping[str, Expr]) -> tuple[Definition, ...]:
    return tuple(
        Definition(Quantity(sp.Symbol(n, real=True)), as_expression(e)) for n, e in group.items()
    )


def _check_names(system: System) -> None:
    """Names of states, parameters, inputs, time and definitions are one name space."""
    variables = [*system.states, *system.parameters, *system.inputs, Quantity(system.time)]
    groups = {
        "variable or definition": [q.name for q in variables]
        + [d.name for d in system.definitions],
        "output": [*system.state_names, *system.output_names],
        "invariant": list(system.invariant_names),
    }
    for kind, names in groups.items():
        repeated = sorted(n for n, count in Counter(names).items() if count > 1)
        if repeated:
            raise InputError(
                f"repeated {kind} name",
                where=f"system {system.name!r}",
                got=", ".join(repeated),
                expected="each name once",
            )


def _check_shapes(system: System) -> None:
    n = len(system.states)
    if len(system.rates) != n:
        raise InputError(
            "one rate a state is needed",
            where=f"system {system.name!r}",
            got=f"{len(system.rates)} rates for {n} states",
        )
    if system.mass_matrix is not None and system.mass_matrix.shape != (n, n):
        raise InputError(
            "mass matrix of the wrong shape",
            where=f"system {system.name!r}",
            got=system.mass_matrix.shape,
            expected=(n, n),
        )


def _check_symbols(system: System) -> None:
    """Every free symbol has a meaning before it is used; nothing is a function of time."""
    variables = [*system.states, *system.parameters, *system.inputs]
    known = {q.symbol for q in variables} | {system.time}
    for definition in system.definitions:
        if not _meant(definition.expression, known):
            _check_expression(system, f"definition {definition.name}", definition.expression, known)
        known.add(definition.symbol)
    named = [(f"rate of {q.name}", r) for q, r in zip(system.states, system.rates, strict=True)]
    named += [(f"output {d.name}", d.expression) for d in system.outputs]
    named += [(f"invariant {d.name}", d.expression) for d in system.invariants]
    named += [("singularity", s.expression) for s in system.singularities]
    if system.mass_matrix is not None:
        named += [("mass matrix", e) for e in system.mass_matrix]
    for where, expression in named:
        if not isinstance(expression, sp.Basic):
            _check_expression(system, where, expression, known)
    everything = nodes(expression for _, expression in named)
    if any(isinstance(e, _UNUSABLE) or (e.is_Symbol and e not in known) for e in everything):
        for where, expression in named:
            _check_expression(system, where, expression, known)


_UNUSABLE = (sp.Derivative, sp.core.function.AppliedUndef)


def _meant(expression: Expr, known: set[Expr]) -> bool:
    """Tell quickly whether an expression is one, over known symbols; small ones are the rule."""
    return isinstance(expression, sp.Basic) and not any(
        isinstance(e, _UNUSABLE) or (e.is_Symbol and e not in known) for e in nodes((expression,))
    )


def nodes(expressions: Iterable[Expr]) -> Iterator[Expr]:
    """Yield each distinct subexpression of some expressions once."""
    stack = list(expressions)
    seen = set(stack)
    while stack:
        node = stack.pop()
        yield node
        fresh = [a for a in node.args if a not in seen]
        seen.update(fresh)
        stack += fresh


def _check_expression(system: System, where: str, expression: Expr, known: set[Expr]) -> None:
    if not isinstance(expression, sp.Basic):
        raise InputError(
            "not a SymPy expression", where=f"{system.name}: {where}", got=type(expression).__name__
        )
    unknown = expression.free_symbols - known
    if unknown:
        raise InputError(
            "symbol without a meaning",
            where=f"{system.name}: {where}",
            got=", ".join(sorted(str(s) for s in unknown)),
            expected="states, parameters, inputs, time or a definition before it",
        )
    if expression.atoms(*_UNUSABLE):
        raise InputError(
            "function of time or derivative in an expression",
            where=f"{system.name}: {where}",
            got=expression,
            expected="plain symbols",
            hint="make each function a state symbol and each derivative a state or a definition",
        )
