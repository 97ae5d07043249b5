"""Solutions of the system of a note as places where the terms of a line are numbers.

What a slip in a term does to the residual is seen at a random point of a solution as it is in a world;
so repairs of lines about a system are found by the same sums, and judged afterwards.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.checker.judge.leftover import residual
from eom.checker.judge.systems import (
    LENGTH,
    MAX_ORDER,
    TRIES,
    equations,
    given_in,
    on_solutions,
    written,
)
from eom.checker.mean.claims import Claim
from eom.checker.mean.model import Model, printed
from eom.checker.read.grammar import read_formula
from eom.checker.read.syntax import Node
from eom.checker.read.writing import latex
from eom.checker.repair.lines import Line, Place, valued
from eom.errors import InputError
from eom.fields import Singular
from eom.system import Expr
from eom.terms.terms import Term
from eom.worlds.solutions import Inconsistent, Motion, Restriction, order

SPECIAL = 6
"""Restrictions under which repairs are looked for at most, one at a time."""


@dataclass
class Solution(Place):
    """A random point of a solution; ``scalars``: what the symbols of SymPy stand for."""

    model: Model
    motion: Motion
    scalars: Mapping[Any, Term]

    def values(self, term: Term) -> list[int] | None:
        """Return the value of a scalar at t = 0, None where it has none."""
        try:
            found = self.motion.series(written(term, self.scalars, self.model))
        except (InputError, Singular, KeyError):
            return None
        return [int(found.coefficients[0])]


def solutions(line: Line, model: Model, given: Iterable[str]) -> Iterator[tuple[Place, Place]]:
    """Yield points of solutions: without more than is given, and with one restriction more each."""
    base = given_in(model, given)
    length = _length(line.claim, model)
    free = _place(line, model, base, (), length)
    if free is None:
        return
    yield free, free
    possible = [r for r in model.possible if r not in base and not r.rest]
    for one in possible[:SPECIAL]:
        special = _place(line, model, base, (one,), length)
        if special is not None:
            yield free, special


def _length(claim: Claim, model: Model) -> int:
    """Return how many coefficients a solution needs: for one derivative more than the claim has."""
    try:
        pairs = equations(claim, model)
    except InputError:
        return LENGTH
    most = max((order(e) for pair in pairs for e in pair), default=0)
    return max(min(most, MAX_ORDER) + 2, LENGTH)


def _place(
    line: Line, model: Model, given: tuple[Restriction, ...], more: tuple[Restriction, ...], n: int
) -> Place | None:
    try:
        motion = next(model.motions((*given, *more), n, TRIES), None)
    except Inconsistent:
        return None
    names = frozenset(r.name for r in more)
    return None if motion is None else Solution(names, model, motion, line.elaborator.scalars)


def moves(term: Term, line: Line, model: Model) -> bool:
    """Tell whether a scalar depends on more than the parameters of a system."""
    try:
        found = written(term, line.elaborator.scalars, model)
    except InputError:
        return True
    return bool(found.free_symbols - {q.symbol for q in model.system.parameters})


# -- what is left over ---------------------------------------------------------------------------


def remains(line: Line, near: Sequence[Node], given: Iterable[str] = ()) -> tuple[Node, ...]:
    """Return what is left over of an equation on the solutions, whole and term by term.

    ``near``: symbols of the writer, which it is written with. Nothing is where that would be long.
    """
    model = line.claim.model
    if model is None or not on_solutions(line.claim):
        return ()
    letters = _letters(line, near, model)
    found: dict[Node, None] = {}
    try:
        for pair in equations(line.claim, model):
            whole = residual(model.system, pair, given_in(model, given))
            parts = () if whole is None else (whole, *sp.Add.make_args(sp.expand(whole)))
            found |= {read_formula(_latex(part, letters)).tree: None for part in parts}
    except (InputError, Singular):
        return ()
    return tuple(found)


def _letters(line: Line, near: Sequence[Node], model: Model) -> dict[Expr, str]:
    """Return the LaTeX of the quantities of a system: as the writer has it, else as it is printed."""
    found: dict[Expr, str] = {}
    for node in near:
        value = valued(line.elaborator, node)
        with suppress(InputError):
            if value is not None:
                meant = written(value.term, line.elaborator.scalars, model)
                if meant.is_Symbol:
                    found.setdefault(meant, latex(node))
    for name, q in model.quantities.items():
        base = model.quantities.get(name.removesuffix("_dot"), q)
        if base is not q:
            found.setdefault(q.symbol, rf"\dot{{{found.get(base.symbol, printed(base))}}}")
        found.setdefault(q.symbol, model.letters.get(name, printed(q)))
    return found


def _latex(expression: Expr, letters: dict[Expr, str]) -> str:
    return str(sp.latex(expression, symbol_names=letters, fold_short_frac=False))
