"""How a line is reached: by which rules, from which earlier lines, under which assumptions.

A law, a definition and the meaning of an assumption are stated; every other line follows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from eom.derivations.derived import Derived
from eom.derivations.steps import Step
from eom.derivations.verification import DerivationError, plain
from eom.errors import InputError
from eom.exact.identity import vanishes
from eom.terms import rules
from eom.terms.rules import Rule, Trace
from eom.terms.terms import Equation, Term, relabel
from eom.terms.vocabulary import definition
from eom.worlds.worlds import ASSUMPTIONS, SPECIAL, closure

LAW, DEFINITION, ASSUMPTION, RESULT = "law", "definition", "assumption", "result"
KINDS = (LAW, DEFINITION, ASSUMPTION, RESULT)
"""What a line is; the first three are stated, a result follows."""


@dataclass(frozen=True)
class Path:
    """How a result was reached: the labels of its ``lines``, and the ``trace`` of its rules.

    ``evidence``: how it was verified, where that is not by worlds.
    """

    lines: tuple[str, ...]
    trace: Trace
    evidence: str = ""

    def sources(self, stated: Mapping[Equation, str], where: str) -> tuple[str, ...]:
        """Return the lines that the result follows from.

        Parameters
        ----------
        stated : mapping of Equation to str
            The labels of all lines.
        where : str
            The derivation and step, for errors.

        Returns
        -------
        tuple of str
            Labels, in order.

        Raises
        ------
        DerivationError
            Where a rule uses what no line states.
        """
        used = {label: None for label in self.lines if label}
        for statement in self.trace.known:
            label = _line_of(statement, stated)
            if label is None and definition_of(statement) is None:
                shown = f"{plain(statement.left)} = {plain(statement.right)}"
                raise DerivationError(
                    "a rule uses what no line before states",
                    where=where,
                    got=shown,
                    hint="state it first: as a law, a definition, an assumption, or a result",
                )
            used |= {} if label is None else {label: None}
        order = list(stated.values())
        return tuple(sorted(used, key=order.index))


def _line_of(statement: Equation, stated: Mapping[Equation, str]) -> str | None:
    """Return the line that states an equation: as it is, turned round, or for other indices."""
    sides = statement.left, statement.right
    for relation in ("=", ":="):
        for left, right in (sides, sides[::-1]):
            if (found := stated.get(Equation(left, right, relation))) is not None:
                return found
    return next((label for line, label in stated.items() if _instance(line, statement)), None)


def _instance(line: Equation, statement: Equation) -> bool:
    for left, right in (
        (statement.left, statement.right),
        (statement.right, statement.left),
    ):
        bound = rules.match(line.left, left, {})
        if bound is not None and relabel(line.right, bound) == right:
            return True
    return False


def definition_of(statement: Equation) -> Term | None:
    """Return the meaning that a statement gives to a quantity of the vocabulary, if it is one."""
    left = statement.left
    meaning = definition(left) if left.head == "atom" else None
    return meaning if meaning == statement.right else None


# -- what is the same ------------------------------------------------------------------------


def is_tautology(equation: Equation) -> bool:
    """Return whether both sides are the very same term."""
    return equation.relation != ">=" and equation.left == equation.right


def same(left: Term, right: Term) -> bool:
    """Return whether two terms are equal by algebra alone: order of factors, sums, explicit entries."""
    if left == right:
        return True
    tidy = [rules.combine(rules.ordered(t)) for t in (left, right)]
    if tidy[0] == tidy[1]:
        return True
    difference = rules.compute()(rules.combine(rules.ordered(rules.combine(left - right))))
    if difference.is_zero:
        return True
    found = _coefficients(difference)
    return found is not None and all(vanishes(c) for c in found)


def _coefficients(term: Term) -> list[Any] | None:
    """Return the SymPy factors of a sum by what they stand at, or its entries; None for other terms."""
    if term.head == "entries" and all(a.head == "expr" for a in term.args):
        return [a.data[0] for a in term.args]
    counted: dict[Term | None, Any] = {}
    for part in term.args if term.head == "add" else (term,):
        factor, rest = _scaled(part)
        counted[rest] = counted.get(rest, 0) + factor
    return list(counted.values())


def _scaled(term: Term) -> tuple[Any, Term | None]:
    if term.head == "expr":
        return term.data[0], None
    if term.head == "mul" and term.args[0].head == "expr":
        rest = term.args[1:]
        return term.args[0].data[0], rest[0] if len(rest) == 1 else Term("mul", rest, (), term.kind)
    return 1, term


def meets(equation: Equation, applied: Sequence[Rule]) -> bool:
    """Return whether rules lead both sides of an equation to the same."""
    return same(*(rules.apply(applied, side) for side in (equation.left, equation.right)))


# -- assumptions -----------------------------------------------------------------------------

Holds = Callable[[Iterable[str]], Any]
"""Raises `InputError` where a statement does not hold under the assumptions, or has no meaning."""


def smallest(assumed: Sequence[str], holds: Holds) -> tuple[str, ...]:
    """Return a set of assumptions none of which can be spared or weakened, the rest kept.

    Special ones are tried first. Of assumptions that need others the strongest are named.
    """
    kept = closure(assumed)
    order = sorted(kept, key=lambda a: (ASSUMPTIONS[a].kind != SPECIAL, list(ASSUMPTIONS).index(a)))
    spared = True
    while spared:
        spared = False
        for name in order:
            if name in kept and not _needed(name, kept) and _is_enough(kept - {name}, holds):
                kept, spared = kept - {name}, True
    strongest = [a for a in (*assumed, *ASSUMPTIONS) if a in kept and not _needed(a, kept)]
    return tuple(dict.fromkeys(strongest))


def _needed(name: str, kept: frozenset[str]) -> bool:
    return any(name in closure([other]) for other in kept if other != name)


def _is_enough(names: frozenset[str], holds: Holds) -> bool:
    try:
        holds(names)
    except InputError:
        return False
    return True


# -- counting --------------------------------------------------------------------------------


def asserted(derivation: Derived) -> list[Step]:
    """Return the results that no rule has reached."""
    return [s for s in derivation.steps if s.kind == RESULT and not s.by]


def refuse_asserted(derivation: Derived) -> Derived:
    """Return the derivation. Raises `DerivationError` where a result is asserted."""
    found = asserted(derivation)
    if found:
        raise DerivationError(
            "a result is stated, not derived",
            where=derivation.name,
            got=", ".join(s.label for s in found),
            expected="a rule, from lines before; laws, definitions and assumptions are stated",
        )
    return derivation
