"""What can be asked of a tree by name, and the smallest system that gives it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from eom.multibody.algebra.light import used
from eom.multibody.model.model import Tree
from eom.multibody.recursion.points import Point
from eom.multibody.recursion.tally import Savings
from eom.multibody.system.reactions import Reaction, drives_of, of_all
from eom.multibody.system.told import OUTPUTS
from eom.quantities import Definition
from eom.structure import kept as kept_attitudes
from eom.system import System

GROUPS: dict[str, tuple[str, ...]] = {
    "energies": ("kinetic_energy", "potential_energy"),
    "momentum": tuple(f"{letter}_{k}" for letter in "pL" for k in (1, 2, 3)),
    "centre_of_mass": tuple(f"centre_{k}" for k in (1, 2, 3)),
}
"""Names of the outputs that a row of `eom.multibody.system.told.OUTPUTS` gives."""


FORCES, LAMBDA = "constraint_forces", "lambda_"
"""The row whose outputs depend on the constraints, and how their names begin."""
REACTIONS, DRIVES, POINTS = "reactions", "drives", "points"
"""Words for outputs whose names depend on the tree: of joints, of prescribed motions, of points."""
Source = str | Reaction | Point


@dataclass(frozen=True)
class Choice:
    """What can be asked of a tree and of points of its bodies, by name."""

    tree: Tree
    points: tuple[Point, ...] = ()

    @cached_property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """The names that each word stands for; those of `FORCES` are the derived system's."""
        return {
            **GROUPS,
            FORCES: (),
            REACTIONS: tuple(n for r in of_all(self.tree) for n in r.names),
            DRIVES: tuple(d.name for j in self.tree.ordered for d in drives_of(j)),
            POINTS: tuple(n for p in self.points for n in p.names),
        }

    @cached_property
    def sources(self) -> dict[str, Source]:
        """What gives each output: a row of `OUTPUTS`, a reaction, a point."""
        found: dict[str, Source] = {}
        for row in OUTPUTS:
            found |= dict.fromkeys(self.groups[row], row)
        for reaction in of_all(self.tree):
            found |= dict.fromkeys(reaction.names, reaction)
        for point in self.points:
            found |= dict.fromkeys(point.names, point)
        return found

    @property
    def everything(self) -> tuple[Source, ...]:
        """All that can be asked for."""
        return (*OUTPUTS, *self.points)

    def needed(self, wanted: Sequence[str]) -> tuple[Source, ...]:
        """Return what gives the names and words that are asked for."""
        names = [n for w in wanted for n in self.groups.get(w, (w,))]
        forces = (FORCES,) if any(map(self._of_forces, wanted)) else ()
        given = (self.sources[n] for n in names if n in self.sources)
        return tuple(dict.fromkeys((*forces, *given)))

    def names(self, wanted: Sequence[str], system: System) -> tuple[str, ...]:
        """Return what is asked for with words written out."""
        forces = tuple(n for n in system.output_names if n.startswith(LAMBDA))
        known = {**self.groups, FORCES: forces}
        return tuple(dict.fromkeys(n for w in wanted for n in known.get(w, (w,))))

    def is_known(self, name: str) -> bool:
        """Tell whether a name beside those of states can be asked for."""
        return name in self.groups or name in self.sources or self._of_forces(name)

    def known(self) -> tuple[str, ...]:
        """Return all names beside those of states."""
        return (*self.groups, *self.sources)

    def _of_forces(self, name: str) -> bool:
        """Tell whether a name begins as the multipliers of a constraint do; or all are meant."""
        begins = tuple(f"{LAMBDA}{c.name}" for c in self.tree.constraints)
        return name == FORCES or name.startswith(begins)


@dataclass(frozen=True)
class Saved:
    """What was left out of a tree's equations: operations by structure, states that nothing needs.

    ``savings``: the operations. ``states``: names of those left out. ``notes``: what a file said that is
    not used.
    """

    savings: Savings
    states: tuple[str, ...]
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        lines = [f"- {reason}" for reason in self.savings.reasons]
        if self.states:
            lines.append(f"- {', '.join(self.states)}: no output needs them")
        lines += [f"- {note}" for note in self.notes]
        total = (
            f"{self.savings.without} operations an evaluation without, {self.savings.done} of these"
        )
        return "\n".join([*lines, total])


def smallest(system: System, requested: Sequence[str]) -> System:
    """Leave out the states, outputs and definitions that ``requested`` names do not depend on.

    Law: what is kept has the same values along every motion. Dependence is that of names: nothing
    is expanded, so that a long chain of definitions costs no more than reading it.
    """
    depends = _dependence(system)
    outputs = tuple(d for d in system.outputs if d.name in requested)
    wanted = {q.symbol for q in system.states if q.name in requested}
    wanted |= {s for d in outputs for s in _reached(d.expression, depends)}
    kept = _closure(system, wanted, depends)
    if not kept:
        kept = _closure(system, {system.states[0].symbol}, depends)
    if len(kept) == len(system.states) and len(outputs) == len(system.outputs):
        return system
    return _restricted(system, kept, outputs, depends)


def _restricted(
    system: System,
    kept: Sequence[int],
    outputs: tuple[Definition, ...],
    depends: dict[Any, set[Any]],
) -> System:
    states = {system.states[k].symbol for k in kept}
    lost = {q.symbol for q in system.states} - states
    rates = tuple(system.rates[k] for k in kept)
    invariants = tuple(d for d in system.invariants if not _reached(d.expression, depends) & lost)
    singular = tuple(s for s in system.singularities if not _reached(s.expression, depends) & lost)
    results = [*rates, *(d.expression for d in (*outputs, *invariants))]
    definitions = used(system.definitions, results)
    everything = [*results, *(d.expression for d in definitions)]
    free = set().union(
        *(e.free_symbols for e in everything), *(s.expression.free_symbols for s in singular)
    )
    known = {*free, *states, *(d.symbol for d in definitions)}
    return replace(
        system,
        states=tuple(system.states[k] for k in kept),
        rates=rates,
        parameters=tuple(q for q in system.parameters if q.symbol in free),
        inputs=tuple(q for q in system.inputs if q.symbol in free),
        definitions=definitions,
        outputs=outputs,
        invariants=invariants,
        singularities=singular,
        maintained=tuple(n for n in system.maintained if n in {d.name for d in invariants}),
        attitudes=kept_attitudes(system.attitudes, states, known),
    )


def _dependence(system: System) -> dict[Any, set[Any]]:
    """Return the variables that each definition depends on."""
    found: dict[Any, set[Any]] = {}
    for d in system.definitions:
        found[d.symbol] = _reached(d.expression, found)
    return found


def _reached(expression: Any, depends: dict[Any, set[Any]]) -> set[Any]:
    reached: set[Any] = set()
    for s in expression.free_symbols:
        reached |= depends.get(s, {s})
    return reached


def _closure(system: System, wanted: set[Any], depends: dict[Any, set[Any]]) -> list[int]:
    """Return the places of the states that ``wanted`` symbols depend on through the rates."""
    index = {q.symbol: k for k, q in enumerate(system.states)}
    stack = [index[s] for s in wanted if s in index]
    found: set[int] = set()
    while stack:
        k = stack.pop()
        if k not in found:
            found.add(k)
            stack += [index[s] for s in _reached(system.rates[k], depends) if s in index]
    return sorted(found)
