"""Sensitivities of motions: states together with their derivatives by parameters and first states.

Along a solution of x' = f(t, x, p) the derivatives S = dx/dp obey the variational equations
S' = (df/dx) S + df/dp with S(0) = dx(0)/dp; by a first state, df/dp is zero and S(0) a unit vector
(Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, 2nd ed., sect. I.14; Dickinson
and Gelinas, J. Comput. Phys. 21 (1976) 123). Both are one system here, so that every method
integrates it, controls the error of S too, and shares between f and its derivatives what it can.
Where the rates jump (sign, conditions on the states), S jumps as well, and this is not followed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from codegen.compiling.compiled import TARGETS, Compiled, compile
from codegen.compiling.sampled import refuse
from codegen.derivatives.derivative import JACOBIAN, UNIT, Seeds, derive
from codegen.frontend.layout import Layout, Slope, names_of
from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import GROUPS, INVARIANTS, OUTPUTS, RATES, SINGULARITIES, Program
from codegen.runs.arguments import numbers
from eom.errors import InputError, typed, unknown_name
from eom.quantities import Quantity
from eom.system import System

Array = NDArray[np.float64]
Values = Mapping[str, float]

ALL = "all"
_DIFFERENTIATED = (RATES, OUTPUTS)


@dataclass(frozen=True)
class Sensitivities:
    """A compiled system over states and sensitivities, for `codegen.simulate` as it is.

    Parameters
    ----------
    compiled : Compiled
        Its states are x, then, variable by variable, the derivatives of all states, named
        ``dtheta_dI1`` or, by a first state, ``dtheta_dpsi_0``; its outputs are those of the system
        and their derivatives, named alike.
    states : tuple of str
        Names of x.
    variables : tuple of str
        What is differentiated by, first states with ``_0`` behind the name.

    Notes
    -----
    Units are those of a state over those of a variable.

    References
    ----------
    Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sect. I.14.
    """

    compiled: Compiled
    states: tuple[str, ...]
    variables: tuple[str, ...]

    @typed
    def initial(self, values: Values, slopes: Values | None = None) -> dict[str, float]:
        """Return the first values of everything from those of the states x, by name.

        Parameters
        ----------
        values : mapping of str to float
            Of the states x, by name.
        slopes : mapping of str to float, optional
            Derivatives of first values that depend on parameters, by name (``dpsi_dI1``); zero
            without.

        Returns
        -------
        dict of str to floats
            The first values of everything, by name.

        Raises
        ------
        InputError
            For other names.
        """
        given = dict(slopes or {})
        full = {n: float(values[n]) for n in self.states if n in values}
        for variable in self.variables:
            for state in self.states:
                name = _named(state, variable)
                full[name] = float(given.pop(name, variable == _first(state)))
        for name in given:
            raise unknown_name("sensitivity", name, list(full))
        for name in values:
            if name not in self.states:
                raise unknown_name("state", name, self.states)
        return full

    def matrix(self, y: ArrayLike) -> Array:
        """Return S in shape (states, variables), or (states, variables, N) at N points.

        Parameters
        ----------
        y : array
            Values of all states, (n,) or (n, N), as of a `codegen.Result`.

        Returns
        -------
        array
            S in shape (states, variables), or (states, variables, N) at N points.

        Raises
        ------
        InputError
            For other shapes.
        """
        values = numbers(y, "y")
        n, m = len(self.states), len(self.variables)
        if values.ndim not in {1, 2} or values.shape[0] != n * (1 + m):
            raise InputError("y has the wrong shape", got=values.shape, expected=(n * (1 + m), "N"))
        shaped: Array = np.swapaxes(values[n:].reshape(m, n, *values.shape[1:]), 0, 1)
        return shaped


@typed
def sensitivities(
    system: Compiled | System | Any,
    parameters: Sequence[str] = (),
    initial_states: Sequence[str] = (),
) -> Sensitivities:
    """Return a system extended by the derivatives of its states by parameters and first states.

    Parameters
    ----------
    system : Compiled or System or what SymPy has
        A compiled system, whose target is kept, or what `codegen.compile` takes.
    parameters : sequence of str, optional
        Names of parameters to differentiate by.
    initial_states : sequence of str, optional
        Names of states, by whose first values to differentiate.

    Returns
    -------
    Sensitivities
        The extended system, compiled, its start values, and its derivatives as a matrix.

    Raises
    ------
    InputError
        For names that the system does not have (a parameter that was compiled in is no parameter any
        more), for repeated ones, and where a name would mean two things.

    Notes
    -----
    Units are those of a state over those of a variable. A run that is given no absolute tolerance
    holds each derivative by its own size, or, where nothing moves it at first, by the size of the
    state over that of the variable (a parameter's value).

    References
    ----------
    Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sect. I.14.

    Examples
    --------
    >>> import sympy as sp, codegen
    >>> x, k = sp.symbols("x k", real=True)
    >>> decay = codegen.compile(System.from_rates("decay", {x: -k * x}), "numpy")
    >>> S = sensitivities(decay, ["k"])
    >>> run = codegen.simulate(S.compiled, S.initial({"x": 1}), (0, 1), {"k": 2}, "scipy:DOP853")
    >>> round(float(S.matrix(run.y)[0, 0, -1]), 6)  # dx/dk = -t exp(-k t)
    -0.135335
    """
    compiled = system if isinstance(system, Compiled) else compile(system)
    refuse(compiled, "sensitivities")
    layout = compiled.layout
    _known("parameter", parameters, names_of(layout.parameters))
    _known("state", initial_states, names_of(layout.states))
    variables = (*parameters, *map(_first, initial_states))
    if not variables:
        raise InputError("no variables", where=layout.name,
                         expected="names of parameters or of states")  # fmt: skip
    extended = _extended(compiled, tuple(parameters), tuple(initial_states))
    return Sensitivities(extended, names_of(layout.states), variables)


def _known(kind: str, names: Sequence[str], known: Sequence[str]) -> None:
    for k, name in enumerate(names):
        if name not in known:
            raise unknown_name(kind, name, known)
        if name in names[:k]:
            raise InputError(f"{kind} given twice", got=name)


def _first(state: str) -> str:
    return f"{state}_0"


def _named(value: str, variable: str) -> str:
    return f"d{value}_d{variable}"


def _extended(
    compiled: Compiled, parameters: tuple[str, ...], initial_states: tuple[str, ...]
) -> Compiled:
    """Compile the system with the variational equations; pickles by its arguments."""
    slots = [names_of(compiled.layout.parameters).index(name) for name in parameters]
    columns = [*slots, *(None for _ in initial_states)]
    program = variational(compiled.program, len(compiled.layout.states), columns)
    layout = _layout(compiled.layout, parameters, initial_states)
    used, functions, notice = TARGETS[compiled.target](program, layout)
    return Compiled(
        compiled.system,
        layout,
        program,
        used,
        compiled.structure,
        functions,
        compiled.notice or notice,
        (_extended, (compiled, parameters, initial_states)),
    )


def variational(program: Program, states: int, columns: Sequence[int | None]) -> Program:
    """Return the program of a system with its variational equations.

    ``columns``: one a variable, the slot of the parameter, or None for a first state. The state
    ``states * (1 + j) + i`` is the derivative of state i by variable j. Rates and outputs are
    followed by their derivatives, variable by variable. Law: these are the derivatives along the
    direction of states and parameter; the results of the program do not change.
    """
    seeds: Seeds = [
        {
            **{_state(i): _state(states * (1 + j) + i) for i in range(states)},
            **({} if slot is None else {Instruction("parameter", (), slot): UNIT}),
        }
        for j, slot in enumerate(columns)
    ]
    sizes = {g: len(program.results[g]) for g in GROUPS}
    together = {ALL: tuple(k for g in GROUPS for k in program.results[g])}
    rows = [{k: UNIT} for k in range(sum(sizes[g] for g in _DIFFERENTIATED))]
    derived = derive(replace(program, results=together), ALL, rows, seeds)
    zero = len(derived.program.instructions)
    numbers = dict(zip(derived.pattern, derived.program.results[JACOBIAN], strict=True))
    results: dict[str, tuple[int, ...]] = {}
    start = 0
    for g in GROUPS:
        places = range(start, start + sizes[g])
        values = [derived.program.results[ALL][k] for k in places]
        if g in _DIFFERENTIATED:
            values += [numbers.get((k, j), zero) for j in range(len(columns)) for k in places]
        results[g] = tuple(values)
        start += sizes[g]
    instructions = (*derived.program.instructions, Instruction("const", (), Fraction(0)))
    return prune(Program(instructions, results, derived.program.names))


def _state(slot: int) -> Instruction:
    return Instruction("state", (), slot)


def _layout(layout: Layout, parameters: tuple[str, ...], initial_states: tuple[str, ...]) -> Layout:
    """Return the layout of the extended system; raises `InputError` where names clash."""
    by_name = {q.name: q for q in layout.parameters}
    variables = [by_name[name] for name in parameters]
    by_name = {q.name: q for q in layout.states}
    variables += [
        replace(by_name[name], symbol=sp.Symbol(_first(name), real=True)) for name in initial_states
    ]
    states = (*layout.states, *(_rate(q, v) for v in variables for q in layout.states))
    by = [*((n, True) for n in parameters), *((n, False) for n in initial_states)]
    slopes_of = {
        _rate(q, v).name: Slope(q.name, *what)
        for v, what in zip(variables, by, strict=True)
        for q in layout.states
    }
    outputs = layout.results[OUTPUTS]
    slopes = tuple(_named(name, v.name) for v in variables for name in outputs)
    names = [*names_of((*states, *layout.parameters, *layout.inputs)), *outputs, *slopes]
    for name in names:
        if names.count(name) > 1 and names.index(name) < len(layout.states) * (1 + len(variables)):
            raise InputError("a name would mean two things", where=layout.name, got=name)
    results = {
        RATES: names_of(states),
        OUTPUTS: (*outputs, *slopes),
        INVARIANTS: layout.results[INVARIANTS],
        SINGULARITIES: layout.results[SINGULARITIES],
    }
    title = f"{layout.title}, with sensitivities"
    name = f"{layout.name}_sensitivities"
    return replace(layout, name=name, title=title, states=states, results=results, slopes=slopes_of)


def _rate(state: Quantity, variable: Quantity) -> Quantity:
    """Return the quantity d(state)/d(variable)."""
    above, below = (q.unit or "1" for q in (state, variable))
    return Quantity(
        sp.Symbol(_named(state.name, variable.name), real=True),
        above if below == "1" else f"{above}/({below})",
        f"derivative of {state.name} by {variable.name}",
    )
