"""How a line of a derivation holds: its own bodies spelt out, in worlds with what it has of its own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from eom.derivations.derived import Derived
from eom.derivations.verification import IDENTITY, decide, is_of_quantities, is_plain, verify
from eom.errors import InputError
from eom.terms import rules
from eom.terms.own import Own
from eom.terms.rules import Rule
from eom.terms.terms import Equation, Term
from eom.worlds.evaluate import NoSlope
from eom.worlds.generators import worlds
from eom.worlds.own import Furnished
from eom.worlds.worlds import closure


@dataclass
class Deciding:
    """What decides lines where symbols stand for ``scalars``; both grow with the derivation.

    ``own``: its frames, points, bodies and laws.
    """

    own: Own
    scalars: Mapping[Any, Term]
    _drawn: dict[bool, tuple[tuple[Any, ...], Furnished]] = field(default_factory=dict)

    def carry(self, term: Term) -> Term:
        """Return a term with bodies of its own spelt out and partial derivatives carried out."""
        return rules.slopes(self.scalars, self.own)(self._spell(term))

    @property
    def _spell(self) -> Rule:
        return rules.spelt_out(self.own)

    def carried(self, equation: Equation) -> Equation:
        """Return a line with both sides carried out."""
        return replace(equation, left=self.carry(equation.left), right=self.carry(equation.right))

    def worlds(self, *, lawful: bool = True) -> Furnished:
        """Return worlds with what stands so far: the same as long as nothing new is said.

        ``lawful``: whether the derivation's own laws hold in them.
        """
        own = self.own if lawful else replace(self.own, laws=[])
        named = (own.frames, own.points, own.bodies)
        key = (*(tuple(part.items()) for part in named), tuple(own.laws), own.configured)
        if lawful not in self._drawn or self._drawn[lawful][0] != key:
            self._drawn[lawful] = key, Furnished(own, {})
        drawn = self._drawn[lawful][1]
        for s, t in self.scalars.items():  # what is new was not there when laws were stated
            if s not in drawn.scalars:
                drawn.scalars[s] = self.carry(t)
        return drawn

    def decided(self, equation: Equation, assumed: Iterable[str], where: str = "") -> str:
        """Return how a line holds under assumptions. Raises `InputError` where it does not.

        Partial derivatives are what worlds say of them, where they can; what the rules of derivatives make
        of a line is asked of plain expressions, and where worlds know no slope.
        """
        if equation.relation == ":=":
            known = self.own.meaning(equation.left) == equation.right
            return "definition" if known else self._verified(equation, self.scalars, assumed, where)
        drawn, carried = self.worlds(), self.carried(equation)
        left, right = (self._spell(t) for t in (equation.left, equation.right))
        spelt = replace(equation, left=left, right=right)
        scalars = {s: self._spell(t) for s, t in self.scalars.items()}
        if spelt == carried and scalars == drawn.scalars:
            return self._verified(carried, drawn.scalars, assumed, where)
        names = tuple(assumed)
        evidence = ""
        if is_plain(carried):
            evidence = self._verified(carried, drawn.scalars, names, where)
        try:
            found = self._verified(spelt, scalars, names, where)
        except NoSlope:
            return evidence or self._verified(carried, drawn.scalars, names, where)
        return evidence or found

    def _verified(
        self, equation: Equation, scalars: Mapping[Any, Term], assumed: Iterable[str], where: str
    ) -> str:
        with_own = self.worlds() if self.own else worlds
        return verify(equation, assumed, scalars, where=where, drawn=with_own)


def surplus(derivation: Derived) -> Iterator[tuple[str, str]]:
    """Yield labels of steps with an assumption that each names though it holds without that."""
    lines, scalars = Deciding(derivation.own, derivation.scalars), derivation.scalars
    for step in derivation.steps:
        line = step.statement
        for spared in step.assumptions if line.relation != ":=" else ():
            rest = closure(step.assumptions) - {spared}
            try:
                if lines.decided(line, rest) == IDENTITY and is_of_quantities(line, scalars):
                    decide(line, rest, scalars, count=1)  # its symbols, too, have to exist
            except InputError:
                continue
            yield step.label, spared
