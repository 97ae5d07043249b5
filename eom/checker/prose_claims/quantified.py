"""Claims in words with a condition: "A only if B", "A if and only if B", "A unless B", "A is constant".

A sentence is read only where all of its words are known (`phrases`); others are left alone.
What is read is an implication between propositions. It is wrong where a special motion
(`eom.worlds.special`) fulfils all that the note has assumed, the condition in every reading, and the
conclusion in none; it holds where it follows from linear consequences (`consequences.follows`), and is
undecided otherwise: that no counterexample was found proves nothing.

Whether an implication between propositions is proved: premise and opposite conclusion contradict.

Equations that are said to hold must give one that is said to fail, by sums of multiples
(`consequences.follows`); nothing else counts as a proof.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from eom.checker.judge.consequences import follows
from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER, WRONG, judge
from eom.checker.mean.claims import CONSTANT, Claim
from eom.checker.mean.values import ANY, Value
from eom.checker.prose_claims.assumptions import EQUATIONS, vanishing
from eom.checker.prose_claims.phrases import Formulas, clause, phrase
from eom.checker.prose_claims.propositions import (
    NOT_NEGATIVE,
    POSITIVE,
    ZERO,
    All,
    Literal,
    Not,
    Plain,
    Proposition,
    Test,
    alternatives,
    plains,
    text,
    truth,
)
from eom.checker.report.findings import Counterexample
from eom.errors import InputError
from eom.terms.terms import SCALAR, Term, der, dot
from eom.terms.vocabulary import omega, position, quantity
from eom.worlds.special import FIRST_CASES, Special, specials
from eom.worlds.worlds import ASSUMPTIONS, closure


@dataclass(frozen=True)
class Implication:
    """What follows from what; ``premise``: None where nothing is assumed."""

    premise: Proposition | None
    conclusion: Proposition


@dataclass(frozen=True)
class Quantified:
    """A sentence as implications that are all claimed.

    ``kind``: a row of `CONNECTIVES`, "always" or "" for a claim without a condition; ``rests``: words in it
    rest on what stands before, or say what may be ("even if").
    """

    kind: str
    implications: tuple[Implication, ...]
    rests: bool = False


@dataclass(frozen=True)
class Decision:
    """A verdict with sets of assumptions, a reason, and a motion that refutes the claim."""

    verdict: str
    sets: tuple[tuple[str, ...], ...] = ()
    reason: str = ""
    counterexample: Counterexample | None = None


# -- reading --------------------------------------------------------------------------------------

BOTH, IF, ONLY_IF, UNLESS = "if and only if", "if", "only if", "unless"

CONNECTIVES: tuple[tuple[str, str], ...] = (
    (r"(?P<a>.+?),? (?:if,? and only if,?|iff|exactly when|exactly if) (?P<b>.+)", BOTH),
    (r"(?P<b>.+) is (?:a )?necessary and sufficient(?: condition)? for (?P<a>.+)", BOTH),
    (r"(?P<a>.+?),? only (?:if|when) (?P<b>.+)", ONLY_IF),
    (r"(?P<b>.+) is (?:a )?necessary(?: condition)? for (?P<a>.+)", ONLY_IF),
    (r"(?P<b>.+) is (?:a )?sufficient(?: condition)? for (?P<a>.+)", IF),
    (r"(?P<a>.+?),? unless (?P<b>.+)", UNLESS),
    (r"(?:even )?(?:if|when|whenever) (?P<b>[^,]+?),? then (?P<a>.+)", IF),
    (r"(?:even )?(?:if|when|whenever|provided that|as long as) (?P<b>[^,]+), (?P<a>.+)", IF),
    (r"(?P<b>(?:in )?the absence of [^,]+), (?P<a>.+)", IF),
    (r"(?P<b>.+?) (?:implies|means)(?: that)? (?P<a>.+)", IF),
    (r"(?P<a>.+?),? (?:if|when|whenever|provided(?: that)?|as long as) (?P<b>.+)", IF),
    (r"(?P<a>.+?) (?P<b>in the absence of .+)", IF),
)
"""Sentences with a condition, the first that fits: ``a`` is claimed under ``b``."""
_UNDER = re.compile(r"(even )?(?:(?:if|when|whenever) )?(?P<b>[^,]+), (?:then )?(?P<rest>.+)")
"""A condition in front of a claim that has one of its own."""

_PLAIN = re.compile(
    r"(?:note that|we see that|it is clear that|clearly|obviously|moreover|"
    r"furthermore|also|in fact|conversely|for (?:a|any|every) rigid body|"
    r"regardless of the (?:choice of )?(?:reference )?frame(?: choice)?|recall that|of course),? "
)
"""Words in front of a claim that change nothing."""
_RESTING = re.compile(
    r"(?:in other words|hence|thus|therefore|so|consequently|it follows that|that is|"
    r"however|but|and|in general|generally|(?P<refers>(?:(?:this|it|which|that|the above|"
    r"this relation(?:ship)?|this equation) (?:implies|means|shows|says|states|tells us)|"
    r"\x02\d+\x03 (?:says|shows|states|tells us))(?: that)?)),? "
)
"""Words in front of a claim that rest on what stands before."""
_INSERTED = re.compile(
    r",? (?:in translation|in fact|indeed|of course|for example|in particular|itself|actually)\b,?(?= )"
)
_ALWAYS = re.compile(r"\b(?:always|never)\b|\bfor (?:all|any|every)\b")


def stages(sentence: str) -> Iterator[tuple[str, bool, bool]]:
    """Yield a sentence without more and more of the words in front of its claim.

    To each comes whether what was left out rests on what stands before, and whether it refers to that.
    """
    words, rests, refers = _INSERTED.sub("", sentence.replace(" ,", ",")).strip(), False, False
    while True:
        yield words, rests, refers
        lead = _PLAIN.match(words) or _RESTING.match(words)
        if lead is None:
            return
        rests = rests or lead.re is _RESTING
        refers = refers or bool(lead.groupdict().get("refers"))
        words = words[lead.end() :]


def quantified(sentence: str, formulas: Formulas) -> Quantified | None:
    """Return what a sentence claims, None where it has words that are not known here.

    ``sentence``: small letters, formulas as marks, without brackets and full stop.

    >>> quantified("the torque is zero only if the angular momentum is constant", Formulas({}, {}, {})).kind
    'only if'
    """
    *_, (words, rests, _) = stages(sentence)
    rests = rests or "even " in words
    return _conditional(words, formulas, rests) or _unconditional(words, formulas, rests)


def _conditional(words: str, formulas: Formulas, rests: bool) -> Quantified | None:
    """Return a claim with a condition, or with two of them."""
    for pattern, kind in CONNECTIVES:
        match = re.fullmatch(pattern, words)
        found = None if match is None else _implications(kind, match.groupdict(), formulas)
        if found:
            return Quantified(kind, found, rests)
    match = _UNDER.fullmatch(words)
    first = None if match is None else clause(match["b"], formulas)
    if match is None or first is None:
        return None
    inner = _conditional(match["rest"], formulas, rests)
    if inner is None:
        return None
    more = [
        Implication(first if i.premise is None else All((first, i.premise)), i.conclusion)
        for i in inner.implications
    ]
    return replace(inner, implications=tuple(more))


def _implications(
    kind: str, parts: Mapping[str, str], formulas: Formulas
) -> tuple[Implication, ...]:
    a, b = (clause(_finite(parts[n]), formulas) for n in "ab")
    if a is None or b is None:
        return ()
    rows = {IF: ((b, a),), ONLY_IF: ((a, b),), BOTH: ((b, a), (a, b)), UNLESS: ((Not(b), a),)}
    return tuple(Implication(p, q) for p, q in rows[kind])


def _finite(words: str) -> str:
    """Return "the torque to be zero" as "the torque is zero", without a leading "that"."""
    words = re.sub(r"^(?:the condition |the fact )?(?:that )?", "", words)
    return re.sub(r" to (be|vanish|remain)\b", lambda m: _VERBS[m[1]], words)


_VERBS = {"be": " is", "vanish": " vanishes", "remain": " remains"}


def _unconditional(words: str, formulas: Formulas, rests: bool) -> Quantified | None:
    """Return a claim that something is constant, positive or symmetric; zero only if "always" so."""
    always = _ALWAYS.search(words) is not None
    made = clause(words, formulas)
    if made is None or any(isinstance(p, Not) for p in _parts(made)):
        return None
    said = {t for p in plains(made) for r in p.readings for row in r.rows for t in row}
    decisive = all(t.relation in {POSITIVE, NOT_NEGATIVE} or t.term.head in _DECISIVE for t in said)
    if not (decisive or always) or not _VERB.search(words):
        return None
    return Quantified("always" if always else "", (Implication(None, made),), rests)


_DECISIVE = frozenset({"der", "add"})
_VERB = re.compile(
    phrase(r" (?:is|are|remains?|stays?|does|always|equals|<moves>|<change>)(?: |$)")
)


def _parts(one: Proposition) -> Iterator[Proposition]:
    yield one
    if not isinstance(one, Plain):
        for part in (one.part,) if isinstance(one, Not) else one.parts:
            yield from _parts(part)


# -- judging --------------------------------------------------------------------------------------

KNOWN_ATOMS = frozenset(
    "position angular_velocity unit identity identity_matrix rotation inertia torque angular_momentum "
    "absolute_angular_momentum kinetic_energy mass rotational_energy linear_momentum first_moment "
    "total_mass force external_force".split()
)
"""Quantities that have a value of their own in special motions."""
KNOWN_LABELS = frozenset({"I", "B", "O", "C", "OI", "body", "system", "dm", "i", "1", "2", "3"})


def decide(one: Quantified, stated: Iterable[str], given: Iterable[str], open_: bool) -> Decision:
    """Return the verdict on a claim where a note has stated some assumptions.

    ``open_``: the note may have assumed more than is known, so that nothing is called wrong.
    """
    names = frozenset(stated) | frozenset(given)
    decided = [_decided(i, names, tuple(given), one, open_) for i in one.implications]
    worst = min(decided, key=lambda d: _WORST.index(d.verdict))
    if worst.verdict != UNDER:
        return worst
    sets = [s for d in decided for s in d.sets[:1]]
    return replace(worst, sets=(tuple(dict.fromkeys(n for s in sets for n in s)),))


_WORST = (WRONG, UNDECIDED, UNDER, HOLDS)


def _decided(
    one: Implication, names: frozenset[str], given: tuple[str, ...], whole: Quantified, open_: bool
) -> Decision:
    if one.premise is None:
        found = _alone(one.conclusion, given)
        if found.verdict in {HOLDS, UNDER} or whole.kind != "always":
            return found
    against, tried = _against(one, names, FIRST_CASES)
    if one.premise is not None and (against is None or against.degenerate):
        proved = proved_under(one.premise, one.conclusion, given)
        if proved is not None:
            return Decision(UNDER if proved else HOLDS, (proved,) if proved else ())
    if against is None or against.degenerate:
        against, tried = _against(one, names)
    if against is None:
        reason = f"no counterexample in {tried} special motions" if tried else _UNTRIED
        return Decision(UNDECIDED, (), reason)
    example, reason = _example(one, against), _failing(one, against)
    generic = any(isinstance(p, Not) for p in _parts(one.conclusion))
    if against.degenerate or generic or open_ or whole.rests:
        return Decision(UNDECIDED, (), f"unless more is assumed, {reason}", example)
    return Decision(WRONG, (), reason, example)


_UNTRIED = "no motion is known here in which the condition holds"


def _against(
    one: Implication, names: frozenset[str], count: int | None = None
) -> tuple[Special | None, int]:
    """Return a motion where the premise is true and the conclusion false, and how many were tried.

    One of a body without equal moments that is not at rest is returned if there is any.
    """
    premise = one.premise or All(())
    if not all(map(_known, plains(All((premise, one.conclusion))))):
        return None, 0
    tried, kept = 0, None
    for special in islice(specials(), count):
        if names <= special.assumed and truth(premise, special.world) is True:
            tried += 1
            if truth(one.conclusion, special.world) is False:
                kept = kept or special
                if not special.degenerate:
                    return special, tried
    return kept, tried


def _known(one: Plain) -> bool:
    """Return whether a proposition is about quantities that special motions know."""
    tests = [t.term for r in one.readings for row in r.rows for t in row]
    return all(_sound(t) for t in (*tests, *one.scalars.values()))


def _sound(term: Term) -> bool:
    if term.head == "atom":
        return term.data[0] in KNOWN_ATOMS and KNOWN_LABELS.issuperset(map(str, term.data[1:]))
    return all(map(_sound, term.args))


def _failing(one: Implication, special: Special) -> str:
    condition = "" if one.premise is None else f"although {text(one.premise)}, "
    return f"it fails in a motion ({special.words}): {condition}not {text(one.conclusion)}"


def _example(one: Implication, special: Special) -> Counterexample:
    """Return the motion in numbers."""
    premise = () if one.premise is None else ((rf"\text{{{_safe(text(one.premise))}}}", "true"),)
    conclusion = ((rf"\text{{{_safe(text(one.conclusion))}}}", "false"),)
    return Counterexample(special.data, (*premise, *conclusion))


def _safe(words: str) -> str:
    return re.sub(r"[\\{}$]", "", words)


# -- claims without a condition ----------------------------------------------------------------------


def _alone(one: Proposition, given: tuple[str, ...]) -> Decision:
    """Return what the judge says of a claim without a condition, in its best reading."""
    parts = one.parts if isinstance(one, All) else (one,)
    found = []
    for part in parts:
        if not isinstance(part, Plain):
            return Decision(UNDECIDED, (), "no way is known to judge this")
        readings = [_judged(part, r.rows, r.words, given) for r in part.readings]
        found.append(max(readings, key=lambda d: _WORST.index(d.verdict)))
    worst = min(found, key=lambda d: _WORST.index(d.verdict))
    if worst.verdict not in {HOLDS, UNDER}:
        return Decision(UNDECIDED, (), worst.reason or "it does not hold under what is known")
    sets = tuple(s for d in found for s in d.sets)
    reasons = "; ".join(dict.fromkeys(d.reason for d in found if d.reason))
    sets = tuple(s for s in sets if s)
    return Decision(worst.verdict, sets if len(found) == 1 else sets[:1], reasons)


def _judged(
    one: Plain, rows: Sequence[Sequence[Test]], words: str, given: tuple[str, ...]
) -> Decision:
    """Return the judgement on a reading of one row."""
    if len(rows) != 1:
        return Decision(UNDECIDED)
    judged = [judge(_claim(t, one.scalars), given) for t in rows[0]]
    worst = min(judged, key=lambda j: _WORST.index(j.verdict))
    more = (words,) if words else ()
    sets = tuple((*s, *more) for s in worst.sets) or ((more,) if more else ())
    verdict = UNDER if worst.verdict == HOLDS and more else worst.verdict
    return Decision(verdict, sets, worst.reason)


def _claim(test: Test, scalars: Mapping[Any, Term]) -> Claim:
    """Return what a test says as a claim; its dimension is open."""
    term = test.term
    if test.relation == ZERO:
        value = Value(term, term.kind, None, ANY)
        return Claim((value,), (), CONSTANT, scalars=scalars)
    relation = {POSITIVE: ">", NOT_NEGATIVE: ">="}.get(test.relation)
    if relation is None or term.kind != SCALAR:
        raise InputError("no claim says this", got=test.relation)
    return replace(vanishing(term, scalars), relations=(relation,))


BASES: tuple[tuple[str, ...], ...] = (
    (),
    ("body_frame",),
    ("newton_2", "third_law_strong"),
    ("body_frame", "newton_2", "third_law_strong"),
    ("body_frame", "newton_2", "third_law_strong", "about_centre"),
    ("body_frame", "newton_2", "third_law_strong", "O_fixed_in_space"),
)
"""Assumptions under which a proof is looked for, the fewest first."""


def proved_under(
    premise: Proposition, conclusion: Proposition, given: tuple[str, ...]
) -> tuple[str, ...] | None:
    """Return what an implication needs besides where it is proved: assumptions and readings; or None.

    What cannot be proved where much is assumed is not tried with less. A conclusion that needs no premise
    about a certain point is not proved by it.
    """
    if all(_assuming(premise, conclusion, given, base) is None for base in BASES[-2:]):
        return None
    for base in BASES:
        found = _assuming(premise, conclusion, given, base)
        idle = base in BASES[-2:] and _assuming(All(()), conclusion, given, base) is not None
        if found is not None and not idle:
            return found
    return None


def _assuming(
    premise: Proposition, conclusion: Proposition, given: tuple[str, ...], base: tuple[str, ...]
) -> tuple[str, ...] | None:
    """Return what a proof under some assumptions needs: those beyond what is given, and readings."""
    try:
        assumed = closure([*given, *base])
        needed = closure(base) - closure(given)
    except InputError:
        return None
    words = _under(premise, conclusion, assumed)
    spare = {m for n in needed for m in closure((n,)) - {n}}
    return None if words is None else (*(n for n in ASSUMPTIONS if n in needed - spare), *words)


def _under(
    premise: Proposition, conclusion: Proposition, assumed: frozenset[str]
) -> tuple[str, ...] | None:
    """Return the readings in which premise and opposite conclusion contradict each other, or None."""
    words: dict[str, None] = {}
    for held in alternatives(premise, True):
        for denied in alternatives(conclusion, False):
            ways = sorted(((*p, *q) for p in held for q in denied), key=_own_readings)
            chosen = next((w for w in ways if _contradictory(w, assumed)), None)
            if chosen is None:
                return None
            words.update(dict.fromkeys(x.words for x in chosen if x.words))
    return tuple(words)


def _own_readings(literals: Sequence[Literal]) -> int:
    """Return how many literals have to be read in a way of their own."""
    return sum(bool(x.words) for x in literals)


def _contradictory(literals: Sequence[Literal], assumed: frozenset[str]) -> bool:
    """Return whether the equations that are said to hold give one that is said to fail."""
    held = [x for x in literals if x.positive]
    assumed = _drawn(held, assumed)
    premises = [
        vanishing(term, x.scalars)
        for x in held
        for t in x.row
        if t.relation == ZERO
        for term in _forms(t.term)
    ]
    for x in literals:
        if not x.positive and all(t.relation == ZERO for t in x.row):
            goals = [[vanishing(f, x.scalars) for f in _forms(t.term)] for t in x.row]
            if all(any(follows(g, premises, assumed) for g in forms) for forms in goals):
                return True
    return False


def _drawn(held: Sequence[Literal], assumed: frozenset[str]) -> frozenset[str]:
    """Return what is assumed, with what literals say in the words of worlds and that needs no more."""
    for x in held:
        said = {_unsigned(t.term) for t in x.row if t.relation == ZERO}
        for name, terms in EQUATIONS.items():
            if said == set(map(_unsigned, terms)):
                try:
                    wider = closure([*assumed, name])
                except InputError:
                    continue
                assumed = wider if wider - assumed == {name} else assumed
    return assumed


def _unsigned(term: Term) -> Term:
    """Return the vector from one point to another as that between them in order of names."""
    between = term.head == "atom" and term.data[0] == "position"
    return position(*sorted(map(str, term.data[1:]))) if between else term


def _forms(term: Term) -> tuple[Term, ...]:
    """Return a term, and what is zero exactly when it is: a body has an inverse inertia."""
    if term in {der(omega()), der(omega(), "B")}:
        return (term, dot(quantity("inertia", "C"), term))
    return (term,)
