"""The verdict on a formula of a note: its claims judged one by one, the gravest of them first.

Which member of a chain is to blame: every link and the two ends judged apart.

In a = b = c where a = c holds and both links of b fail, b is wrong, not the result.

Sets of assumptions that make a claim hold by chance are not what the writer means. A slip in a term is no
slip where the term vanishes: with the wrong sign before the Coriolis term an
acceleration is right for a particle at the origin. So a set of assumptions does not count under which
written terms vanish because a point is a special one or something rests, while others stay that are not
equal by themselves ("h = a + b = a" says that b vanishes, and counts). Nor does a set under which all
sides vanish, unless the line says that something is zero: then any factor may be lost. Nor one that
brings the model of another note with it, as the 3-1-2 angles do, of which the lexicon knows nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice, pairwise

from eom.checker.judge.consequences import implied_on_solutions
from eom.checker.judge.coordinates import addends, on_solutions
from eom.checker.judge.judge import (
    HOLDS,
    UNDECIDED,
    UNDER,
    WRONG,
    Judgement,
    judge,
    rarely,
    row_of,
)
from eom.checker.judge.laws import free_alone, own
from eom.checker.judge.models import equations
from eom.checker.judge.notes import Understood
from eom.checker.judge.special import condition
from eom.checker.judge.worlds import CHANCE, MODELS, Worlds
from eom.checker.mean.claims import DEFINITION, EQUALITIES, STATEMENT, Claim
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.roles import ASSUMPTION, CONDITIONS, INTRODUCED, LAW, RECALLED
from eom.checker.mean.values import AMBIGUOUS, ILL_FORMED
from eom.checker.read.spans import Span
from eom.errors import InputError
from eom.fields import Singular
from eom.terms.terms import VECTOR, Equation, Term, add, mul, nodes, zero
from eom.worlds.evaluate import Evaluator, flat
from eom.worlds.worlds import closure

GRAVE = frozenset({WRONG, ILL_FORMED})
"""Findings that settle a claim without worlds."""

LAWS = (("newton_2",), ("third_law_weak",), ("third_law_strong",))
"""Sets of assumptions that make of what is recalled a law: it needs itself alone."""

NONE = "no claim"
"""The verdict on a formula that claims nothing: a symbol, an expression, words."""

UNMET = "it does not hold without its condition, and no motion is known here that fulfils that"
"""Why a claim beside a condition of its own is undecided as long as nobody has looked for such worlds."""

ORDER = (WRONG, ILL_FORMED, AMBIGUOUS, UNDECIDED, UNDER, HOLDS, DEFINITION, ASSUMPTION)
"""Verdicts, the gravest first."""


@dataclass(frozen=True)
class Judged:
    """A claim with its judgement, the verdict on it, and why it is wrong or undecided.

    ``chain``: the links of a chain that is wrong or ill-formed, apart.
    """

    claim: Claim
    judgement: Judgement
    verdict: str
    reason: str = ""
    chain: Chain | None = None


@dataclass(frozen=True)
class Verdict:
    """The verdict on a formula, why if it is undecided or wrong, and what was found of each claim."""

    verdict: str
    reason: str = ""
    claims: tuple[Judged, ...] = ()


def verdict(understood: Understood, given: Iterable[str] = ()) -> Verdict:
    """Return the verdict on a formula under what is ``given``: the gravest one of its claims."""
    error = understood.formula.error
    if error is not None:
        return Verdict(UNDECIDED, f"not read: {error}")
    given = (*given, *understood.lexicon.assume)
    judged = tuple(_judged(c, given, understood) for c in understood.claims)
    judged = _of_one_model(judged, given, understood)
    judged = _lettered(_conditional(_following(judged)), understood)
    judged = tuple(_with_chain(j, given) if j.verdict in GRAVE else j for j in judged)
    found = {j.verdict: j.reason for j in reversed(judged)}
    gravest = next((v for v in ORDER if v in found), NONE)
    return Verdict(gravest, found.get(gravest, ""), judged)


def _with_chain(judged: Judged, given: tuple[str, ...]) -> Judged:
    """Return what is wrong with its special case, if it has one, and the links of its chain."""
    return replace(_with_case(judged, given), chain=judge_chain(judged.claim, given))


def _with_case(judged: Judged, given: tuple[str, ...]) -> Judged:
    """Return what is wrong with the special case in which it holds."""
    if judged.verdict != WRONG or judged.claim.findings or judged.judgement.special:
        return judged
    case = condition(judged.claim, (*given, *judged.judgement.context))
    return replace(judged, judgement=replace(judged.judgement, special=case)) if case else judged


def _of_one_model(
    judged: tuple[Judged, ...], given: tuple[str, ...], understood: Understood
) -> tuple[Judged, ...]:
    """Return what was judged, where one claim is about a model all of them in that: a line is of one body.

    Sets of assumptions that exclude the model would say that the line holds nowhere.
    """
    models = {j.judgement.context for j in judged} & set(MODELS)
    if len(models) != 1:
        return judged
    (model,) = models

    def again(one: Judged) -> Judged:
        if one.verdict != UNDER or any(_together(model, s) for s in one.judgement.sets):
            return one
        found = _judged(one.claim, (*given, *model), understood)
        reason = f"it fails where the rest of the line has a meaning: {', '.join(model)}"
        return replace(found, reason=reason) if found.verdict == WRONG else found

    return tuple(map(again, judged))


def _together(model: tuple[str, ...], names: tuple[str, ...]) -> bool:
    """Return whether assumptions can stand together with a model."""
    try:
        closure((*model, *names))
    except InputError:
        return False
    return True


def _following(judged: tuple[Judged, ...]) -> tuple[Judged, ...]:
    """Return what was judged; a law in front of an arrow is assumed, and what follows from it holds."""
    found = list(judged)
    for k, (law, then) in enumerate(pairwise(judged)):
        pair = (law.claim, then.claim)
        open_ = all(j.verdict == UNDECIDED and not j.claim.findings for j in (law, then))
        if then.claim.joined != "implies" or not open_ or not all(map(on_solutions, pair)):
            continue
        holds = implied_on_solutions(then.claim, law.claim)
        if holds is not None:
            said = HOLDS if holds else WRONG
            why = "" if holds else "it does not follow from what stands in front of the arrow"
            found[k] = replace(law, verdict=ASSUMPTION, reason="")
            made = replace(then.judgement, verdict=said, reason=why)
            found[k + 1] = replace(then, judgement=made, verdict=said, reason=why)
    return tuple(found)


def _lettered(judged: tuple[Judged, ...], understood: Understood) -> tuple[Judged, ...]:
    """Return what was judged; undecided what fails with letters that need not be energies.

    Where no words say that one is something else, only what has other dimensions.
    """
    letters = understood.doubtful
    if not letters:
        return judged
    said, names = any(letters.values()), ", ".join(sorted(letters))
    return tuple(
        replace(j, verdict=UNDECIDED, reason=f"it fails with the energy of the system for {names}")
        if j.verdict in GRAVE and (said or j.claim.verdict == WRONG)
        else j
        for j in judged
    )


def _conditional(judged: tuple[Judged, ...]) -> tuple[Judged, ...]:
    """Return what was judged, but undecided what is false without a condition that stands before it."""
    conditions = [j for j in judged if CONDITIONS.get(j.claim.role) == ASSUMPTION]
    if all(j.judgement.verdict == HOLDS for j in conditions):
        return judged
    return tuple(
        replace(j, verdict=UNDECIDED, reason=UNMET)
        if j.verdict == WRONG and not j.claim.role and not j.claim.findings
        else j
        for j in judged
    )


def _judged(claim: Claim, given: tuple[str, ...], understood: Understood) -> Judged:
    """Return the verdict on a claim: by its findings, else in worlds, else by its role.

    What is left of a claim with a place that has no meaning may still be wrong. Of a chain that is
    assumed the first link is; what goes on with it is worked out, and judged.
    """
    worked = _worked(claim) if understood.role in {ASSUMPTION, LAW} else None
    if worked is not None:
        found = meant(judge(worked, given), worked, understood.lexicon, given)
        if found.verdict in {HOLDS, UNDER, WRONG}:
            return Judged(claim, found, found.verdict, found.reason)
    found = Judgement(claim.verdict) if claim.verdict in GRAVE else judge(claim, given)
    found = meant(found, claim, understood.lexicon, given)
    if claim.verdict and found.verdict != WRONG:
        found = replace(found, verdict=claim.verdict)
    if found.verdict == claim.verdict:
        return Judged(claim, found, claim.verdict, _why(claim))
    if found.verdict == WRONG and understood.role != ASSUMPTION and _gives(claim):
        return Judged(claim, found, UNDECIDED, "a number that is given; nothing here determines it")
    alone = free_alone(claim) if found.verdict == WRONG and not own(claim) else ""
    if alone:
        return Judged(claim, found, UNDECIDED, f"nothing here says what {alone} is")
    role = DEFINITION if claim.kind == DEFINITION else CONDITIONS.get(claim.role, understood.role)
    return Judged(claim, found, _played(role, claim, found), found.reason)


def _worked(claim: Claim) -> Claim | None:
    """Return the chain behind the first link where no member of it is a letter or a number alone."""
    members = claim.members[1:]
    if len(members) < 2 or claim.findings or claim.kind != STATEMENT:
        return None
    if not EQUALITIES.issuperset(claim.relations) or any(map(_lone, (m.term for m in members))):
        return None
    return replace(claim, members=members, relations=claim.relations[1:])


def _lone(term: Term) -> bool:
    """Tell whether a term is a quantity, a letter or a number by itself."""
    atomic = term.head == "expr" and (term.data[0].is_Symbol or term.data[0].is_number)
    return atomic or term.is_zero or term.head in {"atom", "der"}


def _played(role: str, claim: Claim, found: Judgement) -> str:
    """Return the verdict on a claim that was judged and that plays a role.

    An assumption need not be true. A definition of what is known already may be wrong. What is
    recalled is judged, but for a law, which is one of the assumptions. What gives a vector by its own
    components defines those.
    """
    equation = EQUALITIES.issuperset(claim.relations)
    if role == ASSUMPTION or (role == DEFINITION and not equation):
        return ASSUMPTION
    if role == LAW and found.verdict == WRONG and claim.moving is None and own(claim):
        return ASSUMPTION
    if found.verdict == HOLDS and (role == INTRODUCED or _resolves(claim)):
        return DEFINITION
    if role in {RECALLED, INTRODUCED} and found.sets and set(found.sets) <= set(LAWS):
        return ASSUMPTION
    return DEFINITION if role == DEFINITION and found.verdict in {HOLDS, UNDER} else found.verdict


_ANGLES = frozenset({"angle", "turn_angle", "free_angle", "principal_angle"})


def _gives(claim: Claim) -> bool:
    """Whether a line only gives an angle by a number that is not zero."""
    expressions = [m.term.data[0] for m in claim.members if m.term.head == "expr"]
    if len(expressions) != 2 or claim.role or claim.kind != STATEMENT:
        return False
    symbols = [x for x in expressions if x.is_Symbol and x in claim.scalars]
    numbers = [x for x in expressions if x.is_number and x != 0]
    meant = [claim.scalars[x] for x in symbols]
    return bool(numbers) and any(t.head == "atom" and t.data[0] in _ANGLES for t in meant)


def _resolves(claim: Claim) -> bool:
    """Whether an equation gives a vector by its own column of components and unit vectors."""
    if claim.kind != STATEMENT or len(claim.members) != 2:
        return False
    left, right = (m.term for m in claim.members)
    columns = {n.args[0] for n in nodes(right) if n.head == "column"}
    atoms = {n for n in nodes(right) if n.head == "atom" and n.data[0] != "unit"}
    return left.head == "atom" and left.kind == VECTOR and columns == atoms == {left}


def _why(claim: Claim) -> str:
    """Return the gravest finding in words."""
    finding = next(f for f in claim.findings if f.verdict == claim.verdict)
    facts = (("got", finding.got), ("expected", finding.expected))
    return "; ".join([finding.what, *(f"{name} {text}" for name, text in facts if text)])


@dataclass(frozen=True)
class Chain:
    """Judgements of the links in order and of the two ends, and the places of members to blame.

    ``links``: numbers of two neighbours of the claim, and the judgement; a member that findings have
    taken out has none. ``ends``: None where one of them is such a member.
    """

    links: tuple[tuple[int, int, Judgement], ...]
    ends: Judgement | None
    blamed: tuple[Span, ...]


def judge_chain(claim: Claim, given: Iterable[str] = ()) -> Chain | None:
    """Return the links of a chain of equations under what is ``given``; None for a single equation.

    The first member of a definition stands for the second and is left out. The first member is taken
    for right where nothing decides: a slip that is carried on is one of all members behind it.
    """
    first = int(claim.kind == DEFINITION)
    numbers = range(first, len(claim.members))
    lost = tuple(f.span for f in claim.findings if f.verdict in {WRONG, ILL_FORMED})
    chained = claim.kind in {STATEMENT, DEFINITION} and EQUALITIES.issuperset(claim.relations)
    if not chained or not numbers or len(numbers) + len(lost) < 3:
        return None
    given = tuple(given)
    pairs = [(a, a + 1) for a in numbers[:-1] if not _between(claim, a, a + 1, lost)]
    links = tuple((a, b, _link(claim, a, b, given)) for a, b in pairs)
    broken = [b for _, b, link in links if link.verdict == WRONG]
    whole = len(numbers) > 1 and all(_between(claim, 0, numbers[-1], [s]) for s in lost)
    ends = _link(claim, numbers[0], numbers[-1], given) if whole else None
    blamed = {_place(claim, n) for n in _blamed(claim, numbers, broken, given)} | set(lost)
    return Chain(links, ends, tuple(sorted(blamed)))


def _place(claim: Claim, number: int) -> Span:
    """Return the place of a member; the first one of a continued chain stands where that begins."""
    if number == 0 and claim.previous is not None:
        return Span(claim.span.start, claim.span.start)
    return claim.members[number].span


def _between(claim: Claim, a: int, b: int, spans: Iterable[Span]) -> bool:
    """Return whether a span lies between two members."""
    start, stop = _place(claim, a).stop, _place(claim, b).start
    return any(start <= s.start < stop for s in spans)


def _link(claim: Claim, a: int, b: int, given: tuple[str, ...]) -> Judgement:
    """Return the judgement of one equation between two members."""
    members = (claim.members[a], claim.members[b])
    one = replace(claim, members=members, relations=("=",), kind=STATEMENT, findings=())
    return judge(one, given)


def _blamed(
    claim: Claim, numbers: Sequence[int], broken: Sequence[int], given: tuple[str, ...]
) -> list[int]:
    """Return the numbers of members to blame for links that fail; ``broken``: their right members.

    Broken links part the chain into runs of members that agree. A run that agrees with the first one
    is right; all others are to blame.
    """
    starts = [numbers[0], *broken, numbers[-1] + 1]
    runs = [range(a, b) for a, b in pairwise(starts)]
    wrong = (r for r in runs[1:] if _link(claim, numbers[0], r[0], given).verdict == WRONG)
    return [n for run in wrong for n in run]


# -- sets that count -------------------------------------------------------------------------------


_WORLDS = 2
RESTING = CHANCE | {"O_fixed_in_body", "symmetric_1", "symmetric_2"}
"""Assumptions under which terms vanish that a slip may stand in."""
KINDS = frozenset({"symmetric"})
"""What kind a body is of: by itself it is meant, but not what vanishes only together with others."""

_BEGINS: dict[str, str] = {
    "spin_312": "angle",
    "rotors": "rotor_",
    "viscous_slug": "slug_",
}
"""Models of a body, and how the quantities begin that a note has where it is about one."""


def meant(found: Judgement, claim: Claim, lexicon: Lexicon, given: Iterable[str] = ()) -> Judgement:
    """Return a judgement without the sets under which the claim holds by chance; wrong without any."""
    equation = EQUALITIES.issuperset(claim.relations) and row_of(claim) is Worlds
    if found.verdict != UNDER or not found.sets or not equation:
        return found
    base = closure([*given, *found.context])
    strange = {m for m in _BEGINS if m not in base and not _named(lexicon, _BEGINS[m])}

    def kept(sets: Iterable[tuple[str, ...]]) -> tuple[tuple[str, ...], ...]:
        return tuple(
            s
            for s in sets
            if not strange & closure(s)
            and not any(_empties(claim, q, base, s) for q in equations(claim))
            and not _silences(claim, base, s)
        )

    sets = kept(found.sets) or kept(rarely(claim, given))
    return replace(found, verdict=UNDER if sets else WRONG, sets=sets)


def _named(lexicon: Lexicon, begins: str) -> bool:
    """Return whether a lexicon has a quantity of a model."""
    layers = (*lexicon.layers, *(s.entries for s in lexicon.scopes))
    return any(e.meaning.quantity.startswith(begins) for layer in layers for e in layer)


def _empties(claim: Claim, equation: Equation, base: frozenset[str], names: Iterable[str]) -> bool:
    """Return whether terms of an equation vanish under a set alone, and two or more others do not."""
    signed = [*_addends(equation.left), *(-t for t in _addends(equation.right))]
    names = frozenset(names)
    resting = names & RESTING or names & KINDS
    if len(signed) < 3 or not resting:
        return False
    try:
        without = closure([*base, *(names - resting)])
        before = _zeros(claim, signed, without)
        if resting <= KINDS:
            before |= _zeros(claim, signed, closure([*base, *resting]))
        after = _zeros(claim, signed, closure([*base, *names]))
        if after <= before or len(signed) - len(after) < 2:
            return False
        if _holds(claim, equation, base):
            return False
        kept = [t for k, t in enumerate(signed) if k not in after]
        return not _holds(claim, Equation(add(*kept), zero(equation.left.kind)), without)
    except InputError:
        return False


def _silences(claim: Claim, base: frozenset[str], names: Iterable[str]) -> bool:
    """Return whether all sides of a claim vanish under a set alone, though it says so of none."""
    sides = [t for q in equations(claim) for t in (q.left, q.right)]
    if any(t.is_zero for t in sides):
        return False
    try:
        if len(_zeros(claim, sides, closure([*base, *names]))) < len(sides):
            return False
        return len(_zeros(claim, sides, base)) < len(sides)
    except InputError:
        return False


def _holds(claim: Claim, equation: Equation, names: frozenset[str]) -> bool:
    drawn = islice(Worlds(claim, claim.scalars).draw(names), _WORLDS)
    return all(one.agrees(equation) for one in drawn)


def _addends(term: Term) -> Iterator[Term]:
    """Yield the terms of a sum; factors before brackets go to each."""
    for one in addends(term):
        if one.head == "mul" and one.args[-1].head == "add":
            yield from (mul(*one.args[:-1], a) for a in _addends(one.args[-1]))
        elif not one.is_zero:
            yield one


def _zeros(claim: Claim, terms: list[Term], names: frozenset[str]) -> frozenset[int]:
    """Return the numbers of the terms that are zero in every world drawn. Raises `InputError`."""
    found, left = frozenset(range(len(terms))), _WORLDS
    for one in Worlds(claim, claim.scalars).draw(names):
        with suppress(Singular):
            found &= {k for k, term in enumerate(terms) if _is_zero(one.evaluator, term)}
            left -= 1
        if not left:
            break
    return found


def _is_zero(e: Evaluator, term: Term) -> bool:
    """Return whether a term is zero for all free indices."""
    numberings = e.numberings(e.labels(term))
    return all(s.is_zero for env in numberings for s in flat(e.value(term, env)))
