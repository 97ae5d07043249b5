"""Laws of the writer's own: lines that say what a free scalar means for the motion.

The torque of a controller, M = -k w, or the velocity of a disc that rolls, v = w x R b3, are true of one
motion and of no other; no mechanics says what k and R are before that line does. So the first line that
has such a scalar on some of its sides alone, and quantities of the motion on the others, is an assumption,
and what comes behind it with the same scalar is judged by what follows from it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import sympy as sp

from eom.checker.judge.consequences import follows
from eom.checker.judge.coordinates import addends
from eom.checker.judge.judge import HOLDS, Judgement, judge
from eom.checker.judge.models import CHANCE, atoms_in
from eom.checker.mean.claims import EQUALITIES, STATEMENT, Claim
from eom.terms.terms import Term, add, mul, number, zero
from eom.terms.terms import replace as rewritten

SCALAR = "scalar"
"""Quantity of the vocabulary that is free for the writer."""
STILL = frozenset({SCALAR, "angle", "turn_angle", "free_angle", "principal_angle"})
"""Quantities whose functions are known: a line between them alone says nothing of a motion."""
FACTORS = (-1, 2, sp.Rational(1, 2))
"""What a term may have to be multiplied by where a line does not follow from a law."""


def own(claim: Claim) -> frozenset[str]:
    """Return the free scalars that stand on some sides of a claim alone, beside quantities of motion."""
    plain = claim.kind == STATEMENT and EQUALITIES.issuperset(claim.relations)
    if not plain or claim.parameters is not None or claim.findings or len(claim.members) < 2:
        return frozenset()
    sides = [atoms_in(m.term, claim.scalars) for m in claim.members]
    free = [_free(s) for s in sides]
    others = [a for s, f in zip(sides, free, strict=True) if not f for a in s]
    moving = any(a.data[0] not in STILL for a in others)
    return frozenset.union(*free) - frozenset.intersection(*free) if moving else frozenset()


def firsts(found: Iterable[Sequence[Claim]]) -> Iterator[bool]:
    """Yield for the claims of each formula whether it is the first to tie a free scalar to the motion.

    A scalar that stands in a line before, but for lines between free scalars alone, is known already.
    """
    known: frozenset[str] = frozenset()
    for claims in found:
        said = [c for c in claims if c.parameters is None]
        yield any(own(c) - known for c in said if not c.role)
        known |= {n for c in said for m in c.members for n in _free(atoms_in(m.term, c.scalars))}


def refuted(claim: Claim, laws: Sequence[Claim], assumed: frozenset[str]) -> bool:
    """Return whether a claim is false where laws hold: with another factor of one term it follows.

    If both were true, the term would be zero; so it is made sure that this does not follow as well.
    """
    return any(
        follows(other, laws, assumed) and not follows(term, laws, assumed)
        for other, term in _variants(claim)
    )


def settled(claim: Claim, laws: Sequence[Claim], given: Iterable[str] = ()) -> Judgement | None:
    """Return the judgement on a claim in which what laws give is put in place of what they give it for.

    None where that is not everywhere possible: then nothing is known.
    """
    made = claim
    for law in laws:
        made = _put(made, law)
    if made is claim:
        return None
    given_for = frozenset().union(
        *(atoms_in(side, law.scalars) for law in laws for side in _solved(law)[:1])
    )
    left = frozenset().union(*(atoms_in(m.term, made.scalars) for m in made.members))
    return judge(made, given) if given_for and not given_for & left else None


def _solved(law: Claim) -> tuple[Term, ...]:
    """Return what a law is solved for, and what it gives for that; nothing where it is not solved."""
    if len(law.members) != 2:
        return ()
    left, right = (m.term for m in law.members)
    plain = left.head == "atom" or (left.head == "der" and left.args[0].head == "atom")
    return (
        (left, right)
        if plain and not atoms_in(left, law.scalars) & atoms_in(right, law.scalars)
        else ()
    )


def _put(claim: Claim, law: Claim) -> Claim:
    """Return a claim with what a law gives in place of what it is solved for."""
    solved = _solved(law)
    clash = any(claim.scalars.get(s, t) != t for s, t in law.scalars.items())
    if not solved or clash:
        return claim
    made = exchanged(claim, *solved)
    if made.members == claim.members and made.scalars == dict(claim.scalars):
        return claim
    return replace(made, scalars={**law.scalars, **made.scalars}, previous=None)


def exchanged(claim: Claim, old: Term, new: Term) -> Claim:
    """Return a claim with another term in place of one, wherever that stands."""

    def rule(node: Term) -> Term:
        return new if node == old else node

    members = tuple(replace(m, term=rewritten(m.term, rule)) for m in claim.members)
    scalars = {s: rewritten(t, rule) for s, t in claim.scalars.items()}
    return replace(claim, members=members, scalars=scalars)


def slipped(claim: Claim, given: Iterable[str] = ()) -> bool:
    """Return whether a claim is exactly true with another factor of one term: no approximation of it."""
    return any(_exact(judge(other, given)) for other, _ in _variants(claim))


def _exact(found: Judgement) -> bool:
    return found.verdict == HOLDS or any(not CHANCE.intersection(s) for s in found.sets)


def _variants(claim: Claim) -> Iterator[tuple[Claim, Claim]]:
    """Yield a claim of two sides with another factor of one term, and that this term is zero."""
    if len(claim.members) != 2:
        return
    left, right = (m.term for m in claim.members)
    terms = [*addends(left), *(-t for t in addends(right))]
    for k, term in enumerate(terms):
        others = [t for n, t in enumerate(terms) if n != k]
        for factor in FACTORS:
            yield _zero([*others, mul(number(factor), term)], claim), _zero([term], claim)


def _zero(terms: Sequence[Term], claim: Claim) -> Claim:
    """Return the claim that a sum is zero."""
    first = claim.members[0]
    both = (replace(first, term=add(*terms)), replace(first, term=zero(first.term.kind)))
    return replace(claim, members=both, relations=("=",), previous=None)


def _free(atoms: frozenset[Term]) -> frozenset[str]:
    """Return the names of the free scalars among quantities."""
    return frozenset(str(a.data[1]) for a in atoms if a.data[0] == SCALAR)
