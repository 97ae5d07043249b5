"""The contract between deriving and computing: one frozen system of equations of motion.

A `System` holds plain SymPy symbols and expressions over them, no ``Function('x')(t)`` and no
``Derivative``. ``codegen`` reads this module, `eom.tables` (curves that stand in expressions) and
`eom.errors`, and nothing else of ``eom``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom import proof
from eom.control import Spoken, as_quantity, as_state, in_order, name_of, widened
from eom.dimensions import Dimensions
from eom.displays import display
from eom.errors import InputError, entries, is_text, shown, typed, unknown_name
from eom.expressions import UNUSABLE, as_expression, free_symbols, is_over, nodes, replaced
from eom.quantities import (
    TIME,
    Assumption,
    Definition,
    Quantity,
    Sampling,
    Singularity,
    as_expressions,
    as_symbol,
    definitions_of,
    quantities_of,
)
from eom.structure import BodyAttitude, SequenceAngles, form_of
from eom.units import NONE, coherent

__all__ = (
    "TIME", "Assumption", "BodyAttitude", "Definition", "Expr", "Quantity", "Sampling",
    "SequenceAngles", "Singularity", "System", "as_expression", "nodes",
)  # fmt: skip

Expr = Any  # a SymPy expression; SymPy ships no types


def _few(names: Sequence[str], most: int = 12) -> str:
    """Return names as a text: the first few, and how many more there are."""
    rest = len(names) - most
    return ", ".join(names[:most]) + (f" and {rest} more" if rest > 0 else "")


@dataclass(frozen=True)
class System:
    """Equations of motion: ``mass_matrix * d(states)/dt = rates``, or ``d(states)/dt = rates``.

    Parameters
    ----------
    name : str
        What it is called, also in generated code.
    states : tuple of Quantity
        Quantities, in the order of every array of values, (n,); a plain symbol becomes a quantity
        without a unit.
    rates : tuple of expressions
        One expression a state, (n,).
    parameters : tuple of Quantity, optional
        Quantities in the order of arrays, too.
    inputs : tuple of Quantity, optional
        Quantities in the order of arrays, too.
    time : symbol, optional
        The symbol of time.
    definitions : tuple of Definition, optional
        Named intermediates, each over the symbols before it; these, outputs and invariants may be
        given as expressions by name.
    mass_matrix : matrix, optional
        SymPy matrix, symmetric or not, (n + m, n + m) with m multipliers; None for identity.
    outputs : tuple of Definition, optional
        Named expressions.
    invariants : tuple of Definition, optional
        Named expressions that are constant along every solution.
    singularities : tuple of Singularity, optional
        Where coordinates fail, see `Singularity`.
    assumptions : tuple of Assumption, optional
        What was assumed, see `Assumption`.
    maintained : tuple of str, optional
        Names of invariants onto which integration brings the state back unless asked not to.
    attitudes : tuple of BodyAttitude, optional
        Bodies among the states, see `BodyAttitude`; each is proved.
    angles : tuple of SequenceAngles, optional
        Outputs that jump by whole turns, see `SequenceAngles`.
    sampled : tuple of Sampling, optional
        Laws by which inputs are held between samples, see `Sampling`; what is held are inputs.
    multipliers : tuple of Definition, optional
        Named unknowns beside the rates, such as forces of constraints, each with the right side of
        its row: ``mass_matrix * (d(states)/dt, multipliers) = (rates, right sides)``; outputs alone
        may use them.
    title : str, optional
        Its heading; two systems are equal if all but their titles are.
    numbers : str, default "counts"
        What exact numbers in expressions are, a row of `NUMBERS`; the dimension of every formula is
        checked where they are counts.

    Raises
    ------
    InputError
        For repeated names, free symbols without a meaning, wrong lengths, attitudes that are not
        so, with the equation that fails, and formulas of another dimension than their quantities
        have, with the term that does not fit; what follows from no unit is not refused.

    Notes
    -----
    Units are SI; angles are in radians. Frames and signs are said by the meanings of the
    quantities.
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
    attitudes: tuple[BodyAttitude, ...] = ()
    angles: tuple[SequenceAngles, ...] = ()
    sampled: tuple[Sampling, ...] = ()
    multipliers: tuple[Definition, ...] = ()
    title: str = field(default="", compare=False)
    numbers: str = field(default="counts", compare=False)

    def __post_init__(self) -> None:
        for name, made in _FIELDS.items():
            object.__setattr__(self, name, made(getattr(self, name), f"{name} of a system"))
        _check_names(self)
        _check_shapes(self)
        _check_symbols(self)
        _check_units(self)
        _check_sampled(self)
        _check_attitudes(self)

    @classmethod
    @typed
    def from_rates(
        cls,
        name: str,
        rates: Mapping[Expr, Expr],
        *,
        inputs: Iterable[Expr] = (),
        time: Expr = TIME,
        outputs: Mapping[str, Expr] | None = None,
        invariants: Mapping[str, Expr] | None = None,
        attitudes: Sequence[BodyAttitude] = (),
    ) -> System:
        """Return a system of ``{state symbol: rate}``; what else is free becomes a parameter.

        Parameters
        ----------
        name : str
            What it is called, also in generated code.
        rates : mapping of symbols to expressions
            One a state, in the order of the states.
        inputs : iterable of symbols, optional
            Which free symbols are inputs, and not parameters.
        time : symbol, optional
            The symbol of time, SymPy's real ``t`` unless given.
        outputs : mapping of str to expressions, optional
            What else is wanted, by name.
        invariants : mapping of str to expressions, optional
            What is constant along every solution, by name; that it is so is not tested.
        attitudes : sequence of BodyAttitude, optional
            Bodies among the states, which closed forms, methods on the group of rotations and unit
            quaternions need; nobody looks for them.

        Returns
        -------
        System
            Its parameters are in the order of their names.

        Raises
        ------
        InputError
            For text in place of expressions, and as `System` does.

        Notes
        -----
        Any consistent units.

        Examples
        --------
        >>> y1, y2, k = sp.symbols("y1 y2 k")
        >>> System.from_rates("oscillator", {y1: y2, y2: -k * y1}).parameter_names
        ('k',)
        """
        inputs = tuple(q.symbol for q in quantities_of(inputs, "inputs"))
        as_symbol(time, "time"), quantities_of(rates, "states")
        named = [definitions_of(g or {}, "outputs or invariants") for g in (outputs, invariants)]
        expressions = [as_expression(rate) for rate in rates.values()]
        everything = [*expressions, *(d.expression for group in named for d in group)]
        everything += [e for a in attitudes for e in a.expressions]
        free = free_symbols(everything) - {*rates, *inputs, time}
        return cls(
            name=name,
            states=tuple(Quantity(s) for s in rates),
            rates=tuple(expressions),
            parameters=tuple(Quantity(s) for s in sorted(free, key=lambda s: str(s.name))),
            inputs=tuple(Quantity(s) for s in inputs),
            time=time,
            outputs=named[0],
            invariants=named[1],
            attitudes=tuple(attitudes),
        )

    def __repr__(self) -> str:
        """Name what there is; `eom.typeset.printing.show` writes it out."""
        groups = {
            "states": self.state_names,
            "parameters": self.parameter_names,
            "inputs": self.input_names,
            "outputs": self.output_names,
            "invariants": self.invariant_names,
        }
        named = [f"{kind} {_few(names)}" for kind, names in groups.items() if names]
        return f"System({self.name!r}: {'; '.join(named)})"

    def _repr_html_(self) -> str:
        """Return what a notebook displays: what there is, with its equations."""
        return str(display("system as page", self, "html"))

    def _repr_latex_(self) -> str:
        """Return the equations of motion as a display in LaTeX."""
        return str(display("system as page", self, "latex"))

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

    @property
    def right_sides(self) -> tuple[Expr, ...]:
        """Rates, and behind them the right sides of the multipliers: a row of the mass matrix each."""
        return (*self.rates, *(d.expression for d in self.multipliers))

    @property
    def output_quantities(self) -> tuple[Quantity, ...]:
        """The outputs, with their units, in order."""
        return tuple(d.quantity for d in self.outputs)

    @property
    def held(self) -> tuple[str, ...]:
        """Names of the inputs that sampled laws set, and of the states of these, in order."""
        return tuple(d.name for d in _laws(self))

    @cached_property
    def cyclic(self) -> tuple[str, ...]:
        """Names of the states on which no rate depends, by form."""
        used: set[Expr] = set(self.mass_matrix.free_symbols if self.mass_matrix is not None else ())
        used = used.union(*(side.free_symbols for side in self.right_sides))
        for definition in reversed(self.definitions):
            if definition.symbol in used:
                used |= definition.expression.free_symbols
        return tuple(q.name for q in self.states if q.symbol not in used)

    @cached_property
    def forms(self) -> tuple[str, ...]:
        """What each rate is in the states, by form: polynomial, rational or other; mass matrix apart."""
        states = {q.symbol for q in self.states}
        return tuple(form_of(self.expand(rate), states) for rate in self.rates)

    @cached_property
    def _full_definitions(self) -> dict[Expr, Expr]:
        full: dict[Expr, Expr] = {}
        for definition in self.definitions:
            full[definition.symbol] = replaced(definition.expression, full)
        return full

    def expand(self, expression: Expr) -> Expr:
        """Return an expression over states, parameters, inputs and time alone.

        Parameters
        ----------
        expression : expression
            May hold definitions, which are put in.

        Returns
        -------
        expression
            The same function.

        Raises
        ------
        InputError
            For what is no expression, text above all.
        """
        return replaced(as_expression(expression), self._full_definitions)

    def rate_of(self, expression: Expr) -> Expr:
        """Return the time derivative of an expression along the motion, by the chain rule.

        Parameters
        ----------
        expression : expression
            Over states, parameters, inputs, time and definitions.

        Returns
        -------
        expression
            Over the same, in its unit per unit of time.

        Raises
        ------
        InputError
            Where the system has a mass matrix: its rates are not explicit.
        """
        if self.mass_matrix is not None:
            raise InputError("rate_of needs explicit rates", where=self.name, got="a mass matrix")
        full = self.expand(expression)
        if not isinstance(full, sp.Expr):
            raise InputError("not an expression", where=self.name, got=shown(expression))
        terms = [
            full.diff(q.symbol) * self.expand(r)
            for q, r in zip(self.states, self.rates, strict=True)
        ]
        return sp.Add(*terms, full.diff(self.time))

    @typed
    def with_control(
        self,
        laws: Mapping[Any, Any],
        states: Mapping[Any, Any] | None = None,
        *,
        definitions: Mapping[Any, Any] | None = None,
        parameters: Iterable[Any] = (),
        period: float | None = None,
        delay: float = 0.0,
        rates: Mapping[Any, Any] | None = None,
        dimensions: bool = True,
    ) -> System:
        """Return the closed loop: a system in which inputs are laws over states, outputs and time.

        Parameters
        ----------
        laws : mapping of object to objects
            An expression for each input that is controlled, by its name or symbol, in its unit.
        states : mapping of object to objects, optional
            Of the control itself (an integrator, observer or filter), with their rates, a name,
            symbol or `Quantity` each; a run starts them at zero, or at the ``default`` of the
            quantity, where it gives no value by name.
        definitions : mapping of object to objects, optional
            Named expressions that laws and rates share.
        parameters : iterable, optional
            Quantities with units for some of the symbols that the system does not have; each of
            these becomes a parameter.
        period : float, optional
            Of samples (s): laws are evaluated at the start of a run and after each period, and held
            between. Then ``states`` have the expressions of their next values in place of rates,
            and laws may read the inputs that they set, as they were before.
        delay : float, default 0.0
            Values take effect so long after the sample (s), those of states at once.
        rates : mapping of object to objects, optional
            Of further states of the control, which are continuous beside a period.
        dimensions : bool, default True
            Whether laws must be of the dimensions of their inputs.

        Returns
        -------
        System
            Controlled inputs and definitions are outputs of it. Under samples what is held stays an
            input; `Sampling` says by what it is set. Invariants that an input is part of are left
            out; others hold for any law.

        Raises
        ------
        InputError
            For what is no input, names that are taken, laws of another dimension than their input,
            laws that need their own results, intermediate definitions of the system, which have no
            lasting names, a period that is not positive, and a delay that is negative, or without a
            period.

        Notes
        -----
        Expressions are over states, parameters, inputs, outputs and time of the system, and over
        what is defined here, in any order; symbols count by their names.

        Examples
        --------
        >>> x, v, u, k, d = sp.symbols("x v u k d", real=True)
        >>> cart = System.from_rates("cart", {x: v, v: u}, inputs=[u])
        >>> cart.with_control({"u": -k * x - d * v}).rate_of(v)
        -d*v - k*x
        """
        how = (laws, states or {}, rates or {}, definitions or {})
        closed = _under_control(self, how, parameters, period, delay)
        if dimensions and self.numbers != "counts":
            _check_control(self, closed)
        return closed


Control = tuple[Mapping[Any, Any], Mapping[Any, Any], Mapping[Any, Any], Mapping[Any, Any]]
"""Laws, states of the control with their rates or next values, further states, definitions."""


def _under_control(
    system: System, control: Control, parameters: Iterable[Any], period: float | None, delay: float
) -> System:
    laws, states, rates, definitions = control
    held = {q.name: q for q in system.inputs if q.name not in system.held}
    by_name = {name_of(key): law for key, law in laws.items()}
    for name in by_name:
        if name not in held:
            raise unknown_name("input", name, held, f"laws of control of {system.name!r}")
    if delay and period is None:
        raise InputError("a delay of laws that are not sampled", where=f"control of {system.name!r}",
                         got=shown(delay), hint="give the period of the samples, too")  # fmt: skip
    moved = {as_state(key): e for key, e in rates.items()}
    own = {as_state(key): e for key, e in states.items()}
    shared = {as_quantity(key): e for key, e in definitions.items()}
    variables = (*system.states, *system.parameters, *system.inputs, Quantity(system.time))
    known = {d.name: d.expression for d in system.outputs}
    known |= {q.name: q.symbol for q in variables}
    hidden = {d.name for d in system.definitions} - {*known}
    where = f"control of {system.name!r}"
    spoken = Spoken(where, known, (*moved, *own, *shared), parameters, hidden)
    rows = (*shared.items(), *((held[n], law) for n, law in by_name.items()))
    made = tuple(Definition(q, spoken.over(e)) for q, e in rows)
    along, next_ = ({q: spoken.over(e) for q, e in g.items()} for g in (moved, own))
    gains = tuple(spoken.gains.values())
    if period is None:
        return _closed(system, made, {**next_, **along}, gains)
    steps = tuple(Definition(q, e) for q, e in next_.items())
    sampling = Sampling(made[len(shared) :], steps, period, delay)
    return _sampled(system, made[: len(shared)], along, sampling, gains)


def _check_control(system: System, closed: System) -> None:
    """Check the dimensions of what a control adds to a system whose own numbers may be values."""
    gains = {q.symbol for q in closed.parameters if q.unit} - {q.symbol for q in system.parameters}
    if not gains:
        return
    before = {d.symbol for d in (*system.definitions, *_laws(system))}
    own = [*closed.states, *closed.parameters, *closed.inputs]
    own += [d.quantity for d in closed.definitions]
    stated = [*((q.symbol, q.unit) for q in own), (system.time, "s")]
    known = Dimensions(stated, counts=False, time=system.time)
    second = known.of_symbol(system.time)
    for d in (*closed.definitions, *_laws(closed)):
        if d.symbol not in before and free_symbols((d.expression,)) & gains:
            known.check(d.expression, f"control of {d.name}", of=known.of_symbol(d.symbol))
    added = slice(len(system.states), None)
    for q, rate in zip(closed.states[added], closed.rates[added], strict=True):
        if free_symbols((rate,)) & gains:
            known.check(rate, f"rate of {q.name}", of=known.of_symbol(q.symbol, second))


def _laws(system: System) -> tuple[Definition, ...]:
    """Return what is held between samples, with the law of each."""
    return tuple(d for s in system.sampled for d in s.rows)


# -- closed loops --------------------------------------------------------------------------------


def _closed(
    system: System,
    laws: tuple[Definition, ...],
    states: Mapping[Quantity, Expr],
    gains: tuple[Quantity, ...],
) -> System:
    """Return a system with laws as definitions before what reads them, and the states of a control."""
    controlled = {d.symbol for d in laws}
    definitions = in_order((*laws, *system.definitions), system.name)
    kept = _kept(system.invariants, definitions, controlled)
    matrix = system.mass_matrix
    if matrix is not None and states:
        matrix = widened(sp.Matrix(matrix), len(system.states), len(states))
    shown = tuple(
        Definition(d.quantity, d.symbol) for d in laws if d.name not in system.output_names
    )
    return replace(
        system,
        states=(*system.states, *states),
        rates=(*system.rates, *states.values()),
        parameters=(*system.parameters, *gains),
        inputs=tuple(q for q in system.inputs if q.symbol not in controlled),
        definitions=definitions,
        mass_matrix=matrix,
        outputs=(*system.outputs, *shown),
        invariants=kept,
        maintained=tuple(n for n in system.maintained if n in {d.name for d in kept}),
    )


def _kept(
    invariants: Iterable[Definition], definitions: Iterable[Definition], controlled: Iterable[Expr]
) -> tuple[Definition, ...]:
    """Return the invariants that read nothing of what is controlled."""
    changed = {*controlled}
    for d in definitions:
        if free_symbols((d.expression,)) & changed:
            changed.add(d.symbol)
    return tuple(d for d in invariants if not free_symbols((d.expression,)) & changed)


def _sampled(
    system: System,
    shared: tuple[Definition, ...],
    rates: Mapping[Quantity, Expr],
    sampling: Sampling,
    gains: tuple[Quantity, ...],
) -> System:
    """Return a system under laws that are sampled; their states become inputs that are held.

    ``shared``, ``rates``: definitions, and states of the control that are continuous.
    """
    held = replace(system, inputs=(*system.inputs, *(d.quantity for d in sampling.states)))
    whole = _closed(held, shared, rates, gains)
    invariants = _kept(whole.invariants, whole.definitions, sampling.symbols)
    rows = (Definition(d.quantity, d.symbol) for d in sampling.rows)
    return replace(
        whole,
        outputs=(*whole.outputs, *(d for d in rows if d.name not in whole.output_names)),
        invariants=invariants,
        maintained=tuple(n for n in whole.maintained if n in {d.name for d in invariants}),
        sampled=(*whole.sampled, sampling),
    )


# -- fields as users write them ------------------------------------------------------------------


def _all_of(kind: type) -> Callable[[Any, str], tuple[Any, ...]]:
    """Return what makes a tuple of objects of one type, and raises `InputError` for others."""

    def made(values: Any, where: str) -> tuple[Any, ...]:
        rows = entries(values, where)
        for value in rows:
            if not (is_text(value) if kind is str else isinstance(value, kind)):
                raise InputError("of the wrong type", where=where, got=shown(value),
                                 expected="a text" if kind is str else kind.__name__)  # fmt: skip
        return tuple(rows)

    return made


def _text(value: Any, where: str) -> str:
    """Return a text that can be written. Raises `InputError` for anything else."""
    if not is_text(value):
        raise InputError("not a text", where=where, got=shown(value))
    return str(value)


def _matrix(value: Any, where: str) -> Expr | None:
    """Return a matrix, also of rows, or None. Raises `InputError` for anything else."""
    if value is None or isinstance(value, sp.MatrixBase):
        return value
    try:
        return sp.Matrix([as_expressions(row, where) for row in entries(value, where)])
    except (TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("not a matrix", where=where, got=shown(value)) from None


NUMBERS: Mapping[str, str] = {
    "counts": "they have no unit, as the two in 2*m*g",
    "values": "they may be values with units that were put in, as the mass in 3*g for m = 3",
    "decimals": "as values, and are written as decimals",
}
"""What exact numbers in the expressions of a system are."""


def _numbers(value: Any, where: str) -> str:
    if not is_text(value) or value not in NUMBERS:
        raise unknown_name("kind of numbers", value, NUMBERS, where)
    return str(value)


_FIELDS: Mapping[str, Callable[[Any, str], Any]] = {
    "name": _text,
    "states": quantities_of,
    "rates": as_expressions,
    "parameters": quantities_of,
    "inputs": quantities_of,
    "time": as_symbol,
    "definitions": definitions_of,
    "mass_matrix": _matrix,
    "outputs": definitions_of,
    "invariants": definitions_of,
    "singularities": _all_of(Singularity),
    "assumptions": _all_of(Assumption),
    "maintained": _all_of(str),
    "attitudes": _all_of(BodyAttitude),
    "angles": _all_of(SequenceAngles),
    "sampled": _all_of(Sampling),
    "multipliers": definitions_of,
    "title": _text,
    "numbers": _numbers,
}
"""What makes each field of a `System` of what a user gives: (value, where it is)."""


def _check_names(system: System) -> None:
    """Names of states, parameters, inputs, time and definitions are one name space."""
    variables = [*system.states, *system.parameters, *system.inputs, Quantity(system.time)]
    groups = {
        "variable or definition": [q.name for q in variables]
        + [d.name for d in (*system.definitions, *system.multipliers)],
        "output": [*system.state_names, *system.output_names],
        "invariant": list(system.invariant_names),
    }
    for kind, names in groups.items():
        repeated = sorted(n for n, count in Counter(names).items() if count > 1)
        if repeated:
            raise InputError(
                f"repeated {kind} name", where=f"system {system.name!r}", got=", ".join(repeated),
                expected="each name once",
                hint=_hint_of_time(system) if str(system.time.name) in repeated else "",
            )  # fmt: skip


def _hint_of_time(system: System) -> str:
    return (
        f"the system's time is the symbol {system.time.name} with other assumptions: use eom.TIME in "
        "expressions, or say which symbol is time by time=..."
    )


def _check_shapes(system: System) -> None:
    n = len(system.states)
    if len(system.rates) != n:
        raise InputError(
            "one rate a state is needed",
            where=f"system {system.name!r}",
            got=f"{len(system.rates)} rates for {n} states",
        )
    size = n + len(system.multipliers)
    if system.mass_matrix is None and size > n:
        raise InputError("multipliers need a mass matrix", where=f"system {system.name!r}",
                         got=", ".join(d.name for d in system.multipliers))  # fmt: skip
    if system.mass_matrix is not None and system.mass_matrix.shape != (size, size):
        raise InputError(
            "mass matrix of the wrong shape",
            where=f"system {system.name!r}",
            got=system.mass_matrix.shape,
            expected=(size, size),
        )


def _rows(system: System) -> list[str]:
    """Return what the right side of each row is, in words."""
    rates = [f"rate of {q.name}" for q in system.states]
    return [*rates, *(f"right side of {d.name}" for d in system.multipliers)]


def _check_symbols(system: System) -> None:
    """Every free symbol has a meaning before it is used; nothing is a function of time."""
    variables = [*system.states, *system.parameters, *system.inputs]
    known = {q.symbol for q in variables} | {system.time}
    for definition in system.definitions:
        if not is_over(definition.expression, known):
            _check_expression(system, f"definition {definition.name}", definition.expression, known)
        known.add(definition.symbol)
    named = list(zip(_rows(system), system.right_sides, strict=True))
    named += [(f"invariant {d.name}", d.expression) for d in system.invariants]
    named += [("singularity", s.expression) for s in system.singularities]
    named += [(f"law of {d.name}", d.expression) for d in _laws(system)]
    if system.mass_matrix is not None:
        named += [("mass matrix", e) for e in system.mass_matrix]
    _check_all(system, named, known)
    solved = known | {d.symbol for d in system.multipliers}
    _check_all(system, [(f"output {d.name}", d.expression) for d in system.outputs], solved)


def _check_all(system: System, named: Sequence[tuple[str, Expr]], known: set[Expr]) -> None:
    """Test expressions all together first, and one by one where something is wrong."""
    for where, expression in named:
        if not isinstance(expression, sp.Basic):
            _check_expression(system, where, expression, known)
    everything = nodes(expression for _, expression in named)
    if any(isinstance(e, UNUSABLE) or (e.is_Symbol and e not in known) for e in everything):
        for where, expression in named:
            _check_expression(system, where, expression, known)


def _check_units(system: System) -> None:
    """Variables have units of SI without a factor; every formula is of the dimension of its quantity."""
    variables = [*system.states, *system.parameters, *system.inputs]
    for q in variables:
        if q.unit:
            coherent(q.unit, f"system {system.name!r}: unit of {q.name}")
    if system.numbers != "counts":
        return
    named = [*system.definitions, *system.outputs, *system.invariants]
    if any(q.unit for q in (*variables, *(d.quantity for d in named))):
        _check_dimensions(system, variables)


def _check_dimensions(system: System, variables: Sequence[Quantity]) -> None:
    """Check formulas in the order in which they are defined; a matrix row by row, by its rate.

    Time is in s, unless every unit that is stated is none: then it follows.
    """
    own = [*variables, *(d.quantity for d in (*system.definitions, *system.multipliers))]
    units = [(q.symbol, q.unit) for q in own]
    stated = (q.dimension for q in own if q.unit)
    timeless = all(d == NONE for d in stated)
    known = Dimensions([*units, (system.time, "" if timeless else "s")], time=system.time)
    second = known.of_symbol(system.time)
    for d in system.definitions:
        known.check(
            d.expression, f"definition {d.name} of {system.name}", of=known.of_symbol(d.symbol)
        )
    moved = [known.of_symbol(q.symbol, second) for q in system.states]
    moved += [known.of_symbol(d.symbol) for d in system.multipliers]
    for k, (part, rate) in enumerate(zip(_rows(system), system.right_sides, strict=True)):
        where = f"{part} of {system.name}"
        if system.mass_matrix is None:
            known.check(rate, where, of=moved[k])
        else:
            known.row(list(system.mass_matrix.row(k)), moved, rate, where)
    for d in _laws(system):
        known.check(d.expression, f"law of {d.name} of {system.name}", of=known.of_symbol(d.symbol))
    for kind, group in (("output", system.outputs), ("invariant", system.invariants)):
        for d in group:
            known.check(d.expression, f"{kind} {d.name} of {system.name}", d.quantity.unit)
    for s in system.singularities:
        known.check(s.expression, f"singularity of {system.name}")


def _check_sampled(system: System) -> None:
    """What is held between samples is an input, by one law alone; no constant of the motion reads it."""
    inputs = {q.symbol for q in system.inputs}
    held = [s for sampling in system.sampled for s in sampling.symbols]
    for symbol in held:
        if symbol not in inputs or held.count(symbol) > 1:
            raise InputError("a sampled law sets what is no input, or set by another one",
                             where=f"system {system.name!r}", got=shown(symbol),
                             expected="inputs, each with one law")  # fmt: skip
    for d in system.invariants if held else ():
        if free_symbols((system.expand(d.expression),)) & {*held}:
            raise InputError("a constant of the motion reads what is held between samples",
                             where=f"system {system.name!r}", got=d.name,
                             expected="constants that hold for any input")  # fmt: skip


def _check_attitudes(system: System) -> None:
    """Every attitude that is stated is one."""
    if system.attitudes:
        known = {q.symbol for q in (*system.states, *system.parameters, *system.inputs)}
        known |= {system.time, *(d.symbol for d in system.definitions)}
        for stated in system.attitudes:
            for expression in stated.expressions:
                _check_expression(system, "attitude", expression, known)
        proof.check(_motion(system))


def _motion(system: System) -> proof.Motion:
    """Return what of a system its attitudes are about."""
    mass = system.mass_matrix
    return proof.Motion(
        system.name,
        tuple(q.symbol for q in system.states),
        system.right_sides,
        None if mass is None else sp.ImmutableMatrix(mass),
        tuple((d.symbol, d.expression) for d in system.definitions),
        system.time,
        system.attitudes,
    )


def _check_expression(system: System, where: str, expression: Expr, known: set[Expr]) -> None:
    if not isinstance(expression, sp.Basic):
        raise InputError(
            "not a SymPy expression", where=f"{system.name}: {where}", got=type(expression).__name__
        )
    unknown = free_symbols((expression,)) - known
    if unknown:
        raise InputError(
            "symbol without a meaning",
            where=f"{system.name}: {where}",
            got=", ".join(sorted(str(s) for s in unknown)),
            expected="states, parameters, inputs, time or a definition before it",
        )
    if any(isinstance(e, UNUSABLE) for e in nodes((expression,))):
        raise InputError(
            "function of time or derivative in an expression",
            where=f"{system.name}: {where}",
            got=expression,
            expected="plain symbols",
            hint="make each function a state symbol and each derivative a state or a definition",
        )
