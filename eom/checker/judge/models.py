"""Models in which claims are judged: one protocol, which judgements, repairs and counterexamples ask.

A row of the protocol (`Models`) draws models under names of assumptions; in each of them (`Drawn`) terms
have values, and what a claim says holds or does not. `eom.checker.judge.worlds.Worlds` are random exact
worlds, for claims about mechanics in general; `eom.checker.judge.systems.Solutions` are those of the
system that a note is about; `eom.checker.judge.scalars.Scalars` are numbers for letters that no world
knows.

Equations of magnitudes: both sides squared where each is seen to be nothing below zero.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

from eom.checker.mean.claims import CONSTANT, DEFINITION, EQUALITIES, SAME_POINT, Claim
from eom.checker.mean.values import squared
from eom.errors import InputError
from eom.fields import PRIME, Singular
from eom.limits import Overdue
from eom.terms.terms import Equation, Term, zero

ENOUGH = 3
"""Models in which a claim has to hold."""
NO_BODY = "no body or motion is known here that has all these quantities"
SOME = "it holds for some values of these letters and not for others; a sign or a range decides"
_WEIGHTS = tuple(pow(3, 1000 + 17 * k, PRIME) for k in range(64))

Cases = tuple[tuple[int, bool, tuple[Any, ...]], ...]
"""Of models: seed, whether a claim holds, and which of the cases that it or a definition names applied."""
Said = Any
"""One equation that a claim says, in the form that its models compare."""


@dataclass
class Drawn(ABC):
    """A model that was drawn; ``names``: what is assumed in it, ``seed``: what it was drawn from."""

    names: frozenset[str]
    seed: int
    known: dict[Term, int | None] = field(default_factory=dict, kw_only=True)

    def number(self, term: Term) -> int | None:
        """Return all components of a term mixed into one number modulo a prime, None for none."""
        if term not in self.known:
            values = self.values(term)
            mixed = zip(_WEIGHTS, values or (), strict=False)
            self.known[term] = None if values is None else sum(w * v for w, v in mixed) % PRIME
        return self.known[term]

    def scalar(self, term: Term) -> int | None:
        """Return the value of a scalar at t = 0, None where it has none."""
        values = self.values(term)
        return values[0] if values and len(values) == 1 else None

    def values(self, term: Term) -> list[int] | None:  # noqa: ARG002
        """Return the components of a term at t = 0, None where it has none in the field."""
        return None

    @abstractmethod
    def agrees(self, said: Said) -> bool:
        """Return whether two sides are the same at all times. Raises `Singular`, `InputError`."""


@dataclass(frozen=True)
class Models(ABC):
    """What models of a claim are, and what may be assumed of them.

    ``scalars``: what the symbols of SymPy stand for; ``given``: names that hold without being said.
    """

    claim: Claim
    scalars: Mapping[Any, Term]
    given: tuple[str, ...] = ()

    undefined: ClassVar[str] = "it has no value"
    """What is said of a claim without a value in all models that were drawn."""
    names_scalars = False
    """Whether the claim is about free scalars alone: it says what they are."""

    @property
    @abstractmethod
    def said(self) -> tuple[Said, ...]:
        """The equations that the claim says. Raises `InputError` for other relations."""

    @property
    @abstractmethod
    def order(self) -> Iterable[str]:
        """Everything that may be assumed, the most special last."""

    def contexts(self) -> Iterator[tuple[str, ...]]:
        """Yield what may have to be assumed so that the claim has a value, the simplest first."""
        yield ()

    def closed(self, names: Iterable[str]) -> frozenset[str]:
        """Return those names that may be assumed, with all that they need. Raises `InputError`."""
        return frozenset(self.order).intersection(names)

    @abstractmethod
    def draw(self, names: frozenset[str]) -> Iterator[Drawn]:
        """Yield models under a closed set. Raises `InputError` where there can be none."""

    @abstractmethod
    def smallest(self, search: Search, base: frozenset[str]) -> Iterator[frozenset[str]]:
        """Yield sets beyond a base under which the claim holds, each of them a smallest one."""

    def cases(self, names: frozenset[str]) -> Cases | None:  # noqa: ARG002 - rows may do without
        """Return what was found in each of many models where signs and branches matter, else None."""
        return None

    def missed(self, cases: Cases) -> str:
        """Return the condition of a case that applied in none of many models, "" for no such."""
        met = {pair for _, _, own in cases for pair in own}
        wanted = {(node, k) for node, _ in met for k in range(len(node.args))} - met
        return min((str(node.args[k][1]) for node, k in wanted), default="")

    def branch(self, cases: Cases) -> str:
        """Return why a claim may hold though it is not seen to: "" where it fails in a whole case."""
        missed = self.missed(cases)
        if missed and all(true for _, true, _ in cases):
            return f"no values are known here for which a case applies: {missed}"
        groups = ([true for _, true, m in cases if m == met] for _, _, met in cases)
        return "" if any(len(g) >= ENOUGH and not any(g) for g in groups) else SOME

    def levels(self, terms: Sequence[Term]) -> Iterator[tuple[Drawn, Drawn]]:  # noqa: ARG002
        """Yield models where terms have values: without more than is given, and one of each level."""
        return iter(())

    def needs(self, name: str) -> frozenset[str]:
        """Return an assumption with all that it needs."""
        return frozenset({name})

    def own(self, context: tuple[str, ...]) -> frozenset[str]:  # noqa: ARG002 - rows may do without
        """Return what a context assumes of the body that the claim is about."""
        return frozenset()

    def rank(self, names: tuple[str, ...]) -> tuple[Any, ...]:
        """Return what sets are sorted by, those of one rank as they were found."""
        return (len(names),)

    def empties(self, names: frozenset[str]) -> bool:  # noqa: ARG002
        """Return whether something that the claim writes vanishes under a set alone."""
        return False

    def rests_on(self, names: Iterable[str]) -> tuple[str, ...]:
        """Return those of assumptions that can say something of what the claim is about."""
        return tuple(names)

    def doubt(self) -> str:
        """Say why what does not hold in these models may hold for real numbers, "" for no doubt."""
        return ""

    def is_open(self) -> bool:
        """Return whether what fails under all that is known may hold under something else."""
        return False

    def why(self, search: Search) -> str:  # noqa: ARG002
        """Say what is wrong with what does not hold, or what it needs beyond sets; "" if not known."""
        return ""

    def shown(self, names: frozenset[str]) -> tuple[str, ...]:
        """Return a set without what its other members need, in order."""
        needed = {n for name in names for n in self.needs(name) - {name}}
        return tuple(name for name in self.order if name in names - needed)

    def without(self, names: frozenset[str], name: str) -> frozenset[str]:
        """Return a closed set without an assumption and all that need it."""
        return frozenset(n for n in names if name not in self.needs(n))

    def shrunk(
        self, names: frozenset[str], base: frozenset[str], holds: Callable[[frozenset[str]], bool]
    ) -> frozenset[str]:
        """Leave out of a closed set what something does not need to hold, the most special first."""
        for name in reversed([n for n in self.order if n in names - base]):
            fewer = self.without(names, name)
            if name in names and base <= fewer and holds(fewer):
                names = fewer
        return names


@dataclass
class Search:
    """What has been tried for one claim; ``seeds``: of models where it is false, by what they assume."""

    models: Models
    known: dict[frozenset[str], bool] = field(default_factory=dict)
    seeds: dict[frozenset[str], int] = field(default_factory=dict)
    tests: int = 0
    stopped: bool = False

    @cached_property
    def base(self) -> tuple[tuple[str, ...], frozenset[str]]:
        """The first context in which the claim has a value, and all that holds there.

        Raises `InputError` where there is none.
        """
        why: InputError | None = None
        for context in self.models.contexts():
            try:
                names = self.models.closed([*self.models.given, *context])
                self._true_in(names, 1)
            except InputError as error:
                why = why or error
                continue
            return context, names
        raise why or InputError(NO_BODY)

    def holds(self, names: frozenset[str]) -> bool:
        """Return whether the claim holds in every model drawn under a closed set."""
        if names not in self.known:
            self.tests += 1
            try:
                self.known[names] = self._true_in(names, ENOUGH)
            except InputError:  # they cannot stand together, or leave the claim undefined
                self.known[names] = False
        return self.known[names]

    def counts(self, names: frozenset[str]) -> bool:
        """Return whether the claim holds under a set, and not because what it writes vanishes."""
        return self.holds(names) and not self.models.empties(names)

    def _true_in(self, names: frozenset[str], count: int) -> bool:
        cases = self.models.cases(names)
        if cases is not None:
            against = [seed for seed, true, _ in cases if not true]
            self.seeds |= {names: against[0]} if against else {}
            return not against and not self.models.missed(cases)
        defined = 0
        for model in self.models.draw(names):
            try:
                true = all(model.agrees(s) for s in self.models.said)
            except Singular:
                continue
            if not true:
                self.seeds[names] = model.seed
                return False
            defined += 1
            if defined == count:
                return True
        raise InputError(self.models.undefined)

    def sets(self) -> tuple[frozenset[str], ...]:
        """Return the smallest sets beyond the base; what is found when time is up is kept.

        Raises `Overdue` where nothing is: that no set is found proves nothing then.
        """
        _, base = self.base
        found: list[frozenset[str]] = []
        try:
            found.extend(self.models.smallest(self, base))
        except Overdue:
            if not found:
                raise
            self.stopped = True
        return tuple(s - base for s in found if not any(t < s for t in found))


# -- worlds ----------------------------------------------------------------------------------------


def terms_of(claim: Claim) -> list[Term]:
    """Return every member of a claim, and what its symbols stand for."""
    return [*(m.term for m in claim.members), *claim.scalars.values()]


# -- equations --------------------------------------------------------------------------------------


def equations(claim: Claim) -> tuple[Equation, ...]:
    """Return the equations that a claim says. Raises `InputError` for other relations."""
    terms = [m.term for m in claim.members]
    if claim.kind in {CONSTANT, SAME_POINT}:
        return (Equation(terms[0], zero(terms[0].kind)),)
    others = [r for r in claim.relations if r not in EQUALITIES]
    if others:
        raise InputError("only equations between these are judged", got=others[0])
    start = 1 if claim.kind == DEFINITION else 0
    pairs = zip(terms[start:], terms[start + 1 :], strict=False)
    return tuple(squared(Equation(a, b)) for a, b in pairs)
