"""Passes that make a system smaller without changing what is asked of it.

Each pass is a function from a system to a system, its law in the docstring; `Reduction` records
what it left out, why, and the operations that are saved in each evaluation of the rates.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import sympy as sp

from eom.errors import unknown_name
from eom.exact.algebra import operations
from eom.mechanics.rigidbody import is_invariant
from eom.proof import coupled
from eom.quantities import Assumption, Definition, Quantity, Sampling
from eom.structure import kept, substituted
from eom.system import System, as_expression

Expr = Any


@dataclass(frozen=True)
class Reduction:
    """``what`` was left out of a system, ``why``, and the operations ``saved``, if they were counted."""

    what: str
    why: str = ""
    saved: int | None = None

    def __str__(self) -> str:
        reason = f": {self.why}" if self.why else ""
        return f"- {self.what}{reason}" + (
            "" if self.saved is None else f" ({_counted(self.saved)} saved)"
        )


@dataclass(frozen=True)
class Explanation:
    """The ``reductions`` in order, with the operations of the rates ``before`` and ``after``.

    ``general``: in words, what the operations before are of.
    """

    reductions: tuple[Reduction, ...]
    before: int
    after: int
    general: str = "of the general rates"

    def __str__(self) -> str:
        """Return one line a reduction, then the totals."""
        total = f"{self.before} operations an evaluation {self.general}, {self.after} of these"
        return "\n".join([*map(str, self.reductions), total])


def _counted(operations: int) -> str:
    return f"{operations} operation{'' if operations == 1 else 's'}"


Pass = Callable[[System], tuple[System, Sequence[str], str]]
"""Returns a smaller system, the names of what it leaves out, and why."""


class Step(NamedTuple):
    """``what`` a pass left out, ``why``, and the systems ``before`` and ``after`` it."""

    what: str
    why: str
    before: System
    after: System


def reduced(
    system: System, passes: Mapping[str, Pass], off: Collection[str] = ()
) -> tuple[System, tuple[Step, ...]]:
    """Return a system after all passes that are not ``off``, in order, and what each left out.

    Raises `InputError` for names of no pass.
    """
    steps = []
    for name in off:
        if name not in passes:
            raise unknown_name("pass", name, passes, "off")
    for name, apply in passes.items():
        if name not in off:
            smaller, what, why = apply(system)
            steps.append(Step(", ".join(what), why, system, smaller))
            system = smaller
    return system, tuple(steps)


def reductions(steps: Iterable[Step]) -> tuple[Reduction, ...]:
    """Return the steps that left something out, with the operations that each saved."""
    return tuple(Reduction(s.what, s.why, cost(s.before) - cost(s.after)) for s in steps if s.what)


def _names(system: System) -> tuple[str, ...]:
    return (*system.state_names, *system.parameter_names, *system.input_names)


def only(requested: Sequence[str], reached: Callable[[System], Reach]) -> Pass:
    """Return the pass that leaves out what ``requested`` names do not need."""

    def apply(system: System) -> tuple[System, Sequence[str], str]:
        smaller = prune(system, requested, reached)
        left = _names(smaller)
        lost = [n for n in _names(system) if n not in left]
        return (
            smaller,
            lost,
            "neither the requested outputs nor the rates that they need depend on them",
        )

    return apply


def cost(system: System) -> int:
    """Count the operations of one evaluation of the rates, shared ones once."""
    needed = _used_definitions(system, system.rates)
    matrix = () if system.mass_matrix is None else tuple(system.mass_matrix)
    return operations([*(d.expression for d in needed), *system.rates, *matrix])


def substitute(system: System, values: Mapping[Expr, Expr]) -> System:
    """Replace symbols everywhere; those replaced leave the variables."""

    def over(expression: Expr) -> Expr:
        return as_expression(expression).xreplace(dict(values))

    def named(group: tuple[Definition, ...]) -> tuple[Definition, ...]:
        return tuple(replace(d, expression=over(d.expression)) for d in group)

    def sampled(group: tuple[Sampling, ...]) -> tuple[Sampling, ...]:
        return tuple(replace(s, laws=named(s.laws), states=named(s.states)) for s in group)

    def keep(group: tuple[Quantity, ...]) -> tuple[Quantity, ...]:
        return tuple(q for q in group if q.symbol not in values)

    return replace(
        system,
        rates=tuple(over(r) for r in system.rates),
        mass_matrix=None if system.mass_matrix is None else over(system.mass_matrix),
        parameters=keep(system.parameters),
        inputs=keep(system.inputs),
        definitions=named(system.definitions),
        outputs=named(system.outputs),
        invariants=named(system.invariants),
        singularities=tuple(
            replace(s, expression=over(s.expression)) for s in system.singularities
        ),
        assumptions=tuple(
            replace(
                a, vanish=tuple(map(over, a.vanish)), nonnegative=tuple(map(over, a.nonnegative))
            )
            for a in system.assumptions
        ),
        attitudes=substituted(system.attitudes, values),
        sampled=sampled(system.sampled),
    )


def fold_definitions(system: System) -> System:
    """Inline the definitions that became a number, or a symbol with a factor or sign."""
    trivial: dict[Expr, Expr] = {}
    kept = []
    for definition in system.definitions:
        expression = definition.expression.xreplace(trivial)
        if expression.is_number or expression.as_coeff_Mul()[1].is_Symbol:
            trivial[definition.symbol] = expression
        else:
            kept.append(replace(definition, expression=expression))
    return replace(substitute(system, trivial), definitions=tuple(kept))


def constant_states(system: System) -> tuple[Quantity, ...]:
    """Return the states whose rate is identically zero; at least one other state remains.

    With a mass matrix only states that stand alone in their row count.
    """
    constant = tuple(
        q
        for k, (q, rate) in enumerate(zip(system.states, system.rates, strict=True))
        if system.expand(rate) == 0 and coupled(system.mass_matrix, k) == [k]
    )
    return constant if len(constant) < len(system.states) else ()


def freeze(system: System, states: Iterable[Quantity]) -> System:
    """Turn states with zero rate into parameters: first integrals replace them."""
    frozen = tuple(states)
    moving = _symbols(system.states) - _symbols(frozen)
    known = {e for a in system.attitudes for v in a.expressions for e in v.free_symbols}
    keep = [k for k, q in enumerate(system.states) if q not in frozen]
    parameters = [
        replace(q, meaning=f"{q.meaning} (constant of the motion)", held=True) for q in frozen
    ]
    assumptions = [
        Assumption(f"constant_{q.name}", f"{q.name} keeps its initial value: its rate is zero")
        for q in frozen
    ]
    return replace(
        system,
        states=tuple(system.states[k] for k in keep),
        rates=tuple(system.rates[k] for k in keep),
        mass_matrix=_extract(system.mass_matrix, keep),
        parameters=(*system.parameters, *parameters),
        invariants=(),
        assumptions=(*system.assumptions, *assumptions),
        attitudes=kept(system.attitudes, moving, known),
    )


Reach = Callable[[Expr], set[Expr]]
"""Returns the variables that an expression over definitions depends on."""


def expanded(system: System) -> Reach:
    """Return the reach by expansion, which finds what cancels."""
    return lambda expression: set(system.expand(expression).free_symbols)


def by_name(system: System) -> Reach:
    """Return the reach by names alone: a long chain of definitions costs no more than reading it."""
    depends: dict[Expr, set[Expr]] = {}

    def reach(expression: Expr) -> set[Expr]:
        return set().union(*(depends.get(s, {s}) for s in expression.free_symbols))

    for d in system.definitions:
        depends[d.symbol] = reach(d.expression)
    return reach


def prune(
    system: System, requested: Iterable[str], reached: Callable[[System], Reach] = expanded
) -> System:
    """Keep the states, definitions, outputs, parameters and inputs that ``requested`` names need.

    A state is needed if a requested quantity or the rate of a needed state depends on it, as ``reached``
    shows, also by way of a sampled law. Law: what is kept has the same values along every motion.
    """
    names = set(requested)
    reach = through_samples(system, reached(system))
    outputs = tuple(d for d in system.outputs if d.name in names)
    wanted = {q.symbol for q in system.states if q.name in names}
    wanted = wanted.union(*(reach(d.expression) for d in outputs))
    keep = _closure(system, wanted, reach) or _closure(system, {system.states[0].symbol}, reach)
    states = tuple(system.states[k] for k in keep)
    lost = _symbols(system.states) - _symbols(states)
    invariants = tuple(d for d in system.invariants if not reach(d.expression) & lost)
    singular = tuple(s for s in system.singularities if not reach(s.expression) & lost)
    rates = tuple(system.rates[k] for k in keep)
    matrix = _extract(system.mass_matrix, keep)
    needed = [*rates, *(matrix or ()), *(d.expression for d in (*outputs, *invariants))]
    read = set().union(*(reach(e) for e in needed))
    sampled = tuple(s for s in system.sampled if read & {*s.symbols})
    needed += [e for s in sampled for d in s.rows for e in (d.symbol, d.expression)]
    definitions = _used_definitions(system, needed)
    needed += [*(d.expression for d in definitions), *(s.expression for s in singular)]
    used = _symbols(states).union(*(e.free_symbols for e in needed))
    known = {*used, system.time, *(d.symbol for d in definitions)}
    return replace(
        system,
        states=states,
        rates=rates,
        mass_matrix=matrix,
        parameters=tuple(q for q in system.parameters if q.symbol in used),
        inputs=tuple(q for q in system.inputs if q.symbol in used),
        definitions=definitions,
        outputs=outputs,
        invariants=invariants,
        singularities=singular,
        maintained=tuple(n for n in system.maintained if n in {d.name for d in invariants}),
        attitudes=kept(system.attitudes, _symbols(states), known),
        sampled=sampled,
    )


def through_samples(system: System, reach: Reach) -> Reach:
    """Return the reach that goes on from what is held between samples to all that its laws read."""
    laws = [({*s.symbols}, set().union(*(reach(d.expression) for d in s.rows)))
            for s in system.sampled]  # fmt: skip
    if not laws:
        return reach

    def further(expression: Expr) -> set[Expr]:
        found, waiting = reach(expression), list(laws)
        while met := [law for law in waiting if law[0] & found]:
            waiting = [law for law in waiting if not law[0] & found]
            found = found.union(*(held | read for held, read in met))
        return found

    return further


def _extract(matrix: Expr | None, keep: list[int]) -> Expr | None:
    """Rows and columns of the kept states; an identity is no matrix at all."""
    if matrix is None:
        return None
    part = sp.ImmutableMatrix(matrix.extract(keep, keep))
    return None if part == sp.eye(len(keep)) else part


def find_invariants(system: System, candidates: Iterable[Definition]) -> System:
    """Attach those candidates that the system can compute and that are constants of its motion.

    The candidates are over variables alone, not over definitions.
    """
    states = _symbols(system.states)
    known = states | _symbols(system.parameters) | _symbols(system.inputs) | {system.time}
    known -= {symbol for s in system.sampled for symbol in s.symbols}
    found = tuple(
        c
        for c in candidates
        if c.expression.free_symbols <= known
        and c.expression.free_symbols & states
        and is_invariant(system, c.expression)
    )
    return replace(system, invariants=found)


def _symbols(quantities: Iterable[Quantity]) -> set[Expr]:
    return {q.symbol for q in quantities}


def _closure(system: System, wanted: set[Expr], reach: Reach) -> list[int]:
    """Indices of the states that ``wanted`` symbols depend on through the rates."""
    index = {q.symbol: k for k, q in enumerate(system.states)}
    matrix = system.mass_matrix
    stack = [index[s] for s in wanted if s in index]
    found: set[int] = set()
    while stack:
        k = stack.pop()
        if k in found:
            continue
        found.add(k)
        block = coupled(matrix, k)
        rows = [] if matrix is None else [e for j in block for e in matrix.row(j)]
        read = (reach(e) for e in (*(system.rates[j] for j in block), *rows))
        stack += [*block, *(index[s] for s in set().union(*read) if s in index)]
    return sorted(found)


def _used_definitions(system: System, expressions: Iterable[Expr]) -> tuple[Definition, ...]:
    used = set().union(*(as_expression(e).free_symbols for e in expressions))
    kept = []
    for definition in reversed(system.definitions):
        if definition.symbol in used:
            kept.append(definition)
            used |= definition.expression.free_symbols
    return tuple(reversed(kept))
