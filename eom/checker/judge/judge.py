"""Whether a claim holds in exact random worlds, and the smallest sets of assumptions that it needs.

A claim that holds under some assumptions holds under more; so the search starts from the largest sets
that can stand together, shrinks each to a smallest one, and leaves out one member of it at a time to
find others (a hitting-set tree: R. Reiter, "A theory of diagnosis from first principles", 1987).
What holds in `WORLDS` worlds modulo a 61-bit prime is false by chance about once in 2**50.

Equations of magnitudes: both sides squared where each is seen to be nothing below zero.

Contexts: what a world must hold so that the quantities of a claim have values.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import sympy as sp

from eom.checker.judge import systems
from eom.checker.judge.inequalities import (
    ALWAYS,
    BARELY,
    NEVER,
    ORDERS,
    SOMETIMES,
    Sign,
    difference,
    sign,
)
from eom.checker.mean import parameters
from eom.checker.mean.claims import CONSTANT, DEFINITION, EQUALITIES, SAME_POINT, Claim
from eom.errors import InputError
from eom.fields import Singular
from eom.limits import Overdue
from eom.terms.terms import SCALAR, Equation, Term, expr, nodes, zero
from eom.worlds.evaluate import Evaluator
from eom.worlds.generators import worlds
from eom.worlds.worlds import ASSUMPTIONS, SEQUENCES, closure, sequence_of

if TYPE_CHECKING:
    from eom.checker.mean.model import Model

WORLDS = 3
TRIALS = 12
"""Worlds that are drawn at most, where a claim is undefined in some."""
MAX_TESTS = 160
"""Sets of assumptions that are tried at most for one claim."""


MODELS = (("spin_312",), ("rotors",), ("viscous_slug",))
"""Contexts that assume something of the body, which a claim about its masses rests on."""

SPECIAL = frozenset({"thin_rod", "one_particle", "rotors", "viscous_slug", "spin_312", *SEQUENCES})
"""Assumptions that belong to a context, or to a family of degenerate bodies."""

MENTIONS: dict[str, frozenset[str]] = {
    "A_fixed_in_body": frozenset({"A"}),
    "unit_eigenvectors": frozenset({"eigenvectors"}),
    "OA_at_centre": frozenset({"OA"}),
    "about_centre": frozenset({"O"}),
    "O_fixed_in_body": frozenset({"O"}),
    "O_fixed_in_space": frozenset({"O"}),
    "O_at_origin": frozenset({"O"}),
}
"""Assumptions that say nothing unless a label stands in the claim."""

HOLDS, UNDER, WRONG, UNDECIDED = "holds", "holds under", "wrong", "undecided"


@dataclass(frozen=True)
class Judgement:
    """A verdict, smallest sets of assumptions, the context of the worlds, a world that refutes.

    ``verdict``: "holds", "holds under", "wrong", "definition", "undecided".
    ``sets`` are without what others need; ``complete``: whether there can be no other sets;
    ``refuted``: assumptions and seed of a world where the claim is false, none if it holds in all.
    """

    verdict: str
    sets: tuple[tuple[str, ...], ...] = ()
    context: tuple[str, ...] = ()
    refuted: tuple[tuple[str, ...], int] | None = None
    complete: bool = True
    reason: str = ""


def equations(claim: Claim) -> tuple[Equation, ...]:
    """Return the equations that a claim says. Raises `InputError` for other relations."""
    terms = [m.term for m in claim.members]
    if claim.kind in {CONSTANT, SAME_POINT}:
        return (Equation(terms[0], zero(terms[0].kind)),)
    others = [r for r in claim.relations if r not in EQUALITIES]
    if others:
        raise InputError("only equations are judged in worlds", got=others[0])
    start = 1 if claim.kind == DEFINITION else 0
    pairs = zip(terms[start:], terms[start + 1 :], strict=False)
    return tuple(squared(Equation(a, b)) for a, b in pairs)


def judge(claim: Claim, given: Iterable[str] = ()) -> Judgement:
    """Return whether a claim holds beyond what is ``given``, and under what else.

    A claim with findings is judged by what is left of it; without members it is undecided. One about the
    system of its note is judged on the solutions of that.
    Raises `eom.limits.Overdue` where time is up before anything is found.
    """
    given = tuple(given)
    elsewhere = _elsewhere(claim, given)
    if elsewhere is not None:
        return elsewhere
    if ORDERS & set(claim.relations) and len(claim.relations) == len(claim.members) - 1:
        return _ordered(claim, given)
    try:
        search = _Search(claim, equations(claim), closure(given))
        context = search.context
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))
    if context is None:
        return Judgement(UNDECIDED, reason=search.reason or "no world has these quantities")
    if not search.equations:
        return Judgement(HOLDS, context=context)
    base = search.given | closure(context)
    own = context if context in MODELS and search.about_masses else ()
    if search.holds(base):
        if search.claim.relations[:1] == (":=",) and len(search.equations) == 1:
            return Judgement(DEFINITION, context=context)
        return Judgement(UNDER if own else HOLDS, (own,) if own else (), context)
    search.run(base)
    shown = [needed_names(s | frozenset(own)) for s in search.smallest(base)]
    sets = tuple(sorted(shown, key=lambda s: (len(s), s)))
    refuted = (tuple(sorted(base)), search.seeds[base]) if base in search.seeds else None
    names = claim.kind == SAME_POINT or (not sets and search.free)
    verdict = DEFINITION if names else UNDER if sets else WRONG
    complete = search.tests < MAX_TESTS and not search.stopped
    return Judgement(verdict, sets, context, refuted, complete)


def _elsewhere(claim: Claim, given: tuple[str, ...]) -> Judgement | None:
    """Return the judgement on what no world is drawn for: free scalars, the system of a note."""
    if claim.parameters is not None:
        return _between_scalars(claim)
    if claim.model is not None and systems.on_solutions(claim):
        return _on_solutions(claim, claim.model, given)
    return None


def _between_scalars(claim: Claim) -> Judgement:
    found = parameters.links(claim)
    return Judgement(parameters.verdict(found, claim) or UNDECIDED, reason=parameters.reason(found))


def _on_solutions(claim: Claim, model: Model, given: Iterable[str]) -> Judgement:
    found = systems.decide(claim, model, given)
    defines = found.verdict == HOLDS and claim.relations[:1] == (":=",)
    verdict = DEFINITION if defines and len(claim.members) == 2 else found.verdict
    return Judgement(verdict, found.sets, reason=found.reason)


def _ordered(claim: Claim, given: tuple[str, ...]) -> Judgement:
    """Return whether a chain with signs of order holds: the worst of its links decides."""
    links = [
        replace(claim, members=claim.members[k : k + 2], relations=(relation,))
        for k, relation in enumerate(claim.relations)
    ]
    judged = [_signed(c, given) if c.relations[0] in ORDERS else judge(c, given) for c in links]
    return min(judged, key=lambda j: _WORST.index(j.verdict))


_WORST = (WRONG, UNDECIDED, UNDER, HOLDS, DEFINITION)


def _signed(link: Claim, given: tuple[str, ...]) -> Judgement:
    """Return whether one side is greater than the other in the worlds where both have a value."""
    try:
        term, strict = difference(link)
        both = (Equation(term, zero(term.kind)),)
        search = _Search(link, both, closure(given))
        context = search.context
        if context is None:
            return Judgement(UNDECIDED, reason=search.reason or "no world has these quantities")
        found = sign(term, strict, link.scalars, search.given | closure(context))
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))
    return _of_sign(found, context)


def _of_sign(found: Sign, context: tuple[str, ...]) -> Judgement:
    special = f" ({found.special})" if found.special else ""
    if found.found == NEVER:
        return Judgement(WRONG, (), context, found.where, True, "the opposite holds")
    if found.found == SOMETIMES:
        reason = f"a condition: it does not hold in all worlds{special}"
        return Judgement(UNDECIDED, (), context, found.where, True, reason)
    if found.found == BARELY and found.proved:
        return Judgement(UNDER, (), context, found.where, True, f"zero in special cases{special}")
    if found.found == ALWAYS and found.proved:
        return Judgement(HOLDS, (), context)
    reason = f"no counterexample in {found.tried} worlds" + (
        f", but equality{special}" if found.found == BARELY else ""
    )
    return Judgement(UNDECIDED, (), context, None, True, reason)


def judge_within(claim: Claim, names: Iterable[str], given: Iterable[str] = ()) -> Judgement:
    """Return whether a claim holds where much is assumed, with one smallest set of what it needs of that.

    ``names``: all that is assumed; a claim that fails under them is wrong here.
    """
    if claim.model is not None and systems.on_solutions(claim):
        decided = systems.decide_within(claim, claim.model, names, given)
        return Judgement(decided.verdict, decided.sets, complete=False, reason=decided.reason)
    try:
        search = _Search(claim, equations(claim), closure(given))
        names = closure(names)
        context = search.context
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))
    if context is None or not search.equations:
        return Judgement(UNDECIDED, reason=search.reason or "no world has these quantities")
    base = search.given | closure(context)
    own = frozenset(context if context in MODELS and search.about_masses else ())
    if search.holds(base):
        return Judgement(UNDER if own else HOLDS, (needed_names(own),) if own else (), context)
    if not base <= names or not search.holds(names):
        return Judgement(WRONG, context=context, complete=False)
    needed = search.shrunk(names, base) - base
    return Judgement(UNDER, (needed_names(needed | own),), context, complete=False)


def needed_names(names: frozenset[str]) -> tuple[str, ...]:
    """Return a set without what its other members need, in the order of the table."""
    needed = {n for name in names for n in _needed(name) - {name}}
    return tuple(name for name in ASSUMPTIONS if name in names - needed)


@dataclass
class _Search:
    """What has been tried for one claim."""

    claim: Claim
    equations: tuple[Equation, ...]
    given: frozenset[str]
    known: dict[frozenset[str], bool] = field(default_factory=dict)
    seeds: dict[frozenset[str], int] = field(default_factory=dict)
    found: set[frozenset[str]] = field(default_factory=set)
    seen: set[frozenset[str]] = field(default_factory=set)
    tests: int = 0
    stopped: bool = False
    reason: str = ""

    @cached_property
    def context(self) -> tuple[str, ...] | None:
        """The first context in which every quantity has a value."""
        for context in contexts(self.terms):
            try:
                self._true_in(closure([*self.given, *context]), 1)
            except InputError as error:
                self.reason = self.reason or str(error)
                continue
            return context
        return None

    @cached_property
    def terms(self) -> list[Term]:
        """Every term of the claim, and what its symbols stand for."""
        terms = [t for q in self.equations for t in (q.left, q.right)]
        return [*terms, *self.claim.scalars.values()]

    @cached_property
    def labels(self) -> frozenset[str]:
        """Every label of the terms."""
        return labels_in(self.terms)

    @cached_property
    def about_masses(self) -> bool:
        """Whether the claim is about a body, not about frames and angles alone."""
        return bool(self.labels & {"body", "dm", "system", "inertia", "mass", "total_mass"})

    @cached_property
    def free(self) -> bool:
        """Whether the claim is about free scalars alone: it says what they are."""
        terms = [t for q in self.equations for t in (q.left, q.right)]
        plain = all(n.head in {"expr", "add", "mul", "zero"} for t in terms for n in nodes(t))
        meanings = self.claim.scalars.values()
        return plain and bool(meanings) and all(m.data[:1] == ("scalar",) for m in meanings)

    def candidates(self) -> list[str]:
        """Return the assumptions that may matter."""
        wanted = (n for n in ASSUMPTIONS if n not in SPECIAL)
        return [n for n in wanted if n not in MENTIONS or MENTIONS[n] & self.labels]

    def holds(self, names: frozenset[str]) -> bool:
        """Tell whether all equations hold in every world drawn under a closed set."""
        if names not in self.known:
            self.tests += 1
            try:
                self.known[names] = self._true_in(names, WORLDS)
            except InputError:  # they cannot stand together, or leave the claim undefined
                self.known[names] = False
        return self.known[names]

    def _true_in(self, names: frozenset[str], count: int) -> bool:
        defined = 0
        for world in worlds(names, TRIALS):
            evaluator = Evaluator(world, self.claim.scalars)
            try:
                true = all(evaluator.holds(q) for q in self.equations)
            except Singular:
                continue
            if not true:
                self.seeds[names] = world.seed
                return False
            defined += 1
            if defined == count:
                return True
        raise InputError("the claim is undefined in every world that was drawn")

    def run(self, base: frozenset[str]) -> None:
        """Look for smallest sets below every largest one; what is found when time is up is kept.

        Raises `Overdue` where nothing is: that no set is found proves nothing then.
        """
        names = self.candidates()
        try:
            for first in range(len(names)):
                largest = _filled(base, names[first:] + names[:first])
                if largest is not None:
                    self._below(largest, base)
        except Overdue:
            if not self.found:
                raise
            self.stopped = True

    def _below(self, names: frozenset[str], base: frozenset[str]) -> None:
        if names in self.seen or self.tests >= MAX_TESTS:
            return
        self.seen.add(names)
        inside = next((s for s in self.found if s <= names), None)
        if inside is None:
            if not self.holds(names):
                return
            inside = self.shrunk(names, base)
            self.found.add(inside)
        for name in sorted(inside - base):
            self._below(_without(names, name), base)

    def shrunk(self, names: frozenset[str], base: frozenset[str]) -> frozenset[str]:
        """Leave out what is not needed, the most special first."""
        for name in reversed([n for n in ASSUMPTIONS if n in names - base]):
            fewer = _without(names, name)
            if name in names and base <= fewer and self.holds(fewer):
                names = fewer
        return names

    def smallest(self, base: frozenset[str]) -> list[frozenset[str]]:
        """Return the sets found that hold no other, beyond the base."""
        return [s - base for s in self.found if not any(t < s for t in self.found)]


def _filled(base: frozenset[str], names: list[str]) -> frozenset[str] | None:
    """Return the base with every name that can still stand with what is there."""
    chosen = base
    for name in names:
        try:
            chosen = closure([*sorted(chosen), name])
        except InputError:
            if chosen == base:
                return None
    return chosen


def _without(names: frozenset[str], name: str) -> frozenset[str]:
    """Return a closed set without an assumption and all that need it."""
    return frozenset(n for n in names if name not in _needed(n))


@cache
def _needed(name: str) -> frozenset[str]:
    """Return an assumption with all that it needs."""
    return closure([name])


def squared(equation: Equation) -> Equation:
    """Return the equation of the squares if both sides are numbers or products of roots, else itself.

    What is squared is not negative, so that neither equation says more than the other.
    """
    sides = (equation.left, equation.right)
    if any(s.kind != SCALAR or s.head not in {"expr", "zero"} for s in sides):
        return equation
    found = [_square(_expression(s)) for s in sides]
    if None in found or not any(_has_root(_expression(s)) for s in sides):
        return equation
    return Equation(expr(found[0]), expr(found[1]), equation.relation)


def _expression(term: Term) -> Any:
    return term.data[0] if term.head == "expr" else sp.Integer(0)


def _has_root(expression: Any) -> bool:
    return any(
        p.is_Pow and p.exp.is_Rational and p.exp.q == 2 for p in sp.preorder_traversal(expression)
    )


def _square(expression: Any) -> Any:
    """Return the square of a product of numbers that are not negative and roots; None for others."""
    result = sp.Integer(1)
    for factor in sp.Mul.make_args(expression):
        if factor.is_Rational and factor >= 0:
            result *= factor**2
        elif factor.is_Pow and factor.exp.is_Rational and factor.exp.q == 2:
            result *= factor.base ** (2 * factor.exp)
        elif isinstance(factor, sp.Abs):
            result *= factor.args[0] ** 2
        else:
            return None
    return result


CONTEXTS: tuple[tuple[str, ...], ...] = (
    (),
    ("rigid",),
    ("one_particle",),
    ("spin_312",),
    ("rotors",),
    ("viscous_slug",),
)
"""Worlds in which more and more quantities exist; the first where all of a claim do is taken."""


def labels_in(terms: Iterable[Term]) -> frozenset[str]:
    """Return every label of terms."""
    return frozenset(str(d) for t in terms for n in nodes(t) for d in n.data if isinstance(d, str))


def contexts(terms: Sequence[Term]) -> Iterator[tuple[str, ...]]:
    """Yield the contexts in which terms may have values, the simplest first.

    Angles exist by the assumption of their sequence, a single particle by that of one.
    """
    found = [n.data[2] for t in terms for n in nodes(t) if n.data[:1] == ("turn_angle",)]
    sequences = tuple(dict.fromkeys(map(sequence_of, found)))
    single = [("one_particle",)] if "P" in labels_in(terms) else []
    for general in [*single, *CONTEXTS]:
        yield (*sequences, *general)
