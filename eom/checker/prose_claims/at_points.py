"""Claims on the points about which an equation is valid: "(5) holds if taken about the centre of mass".

The quantities of the equation that are about a point are taken about O, and judged in worlds where O is
the point that the words name. An equation with a slip stands for its most plausible repair.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from eom.checker.judge.judge import UNDER, WRONG, judge_within
from eom.checker.judge.notes import Understood
from eom.checker.judge.verdicts import GRAVE, verdict
from eom.checker.mean.claims import EQUALITIES, STATEMENT, Claim
from eom.checker.prose_claims.quantified import Decision
from eom.checker.repair.corrections import corrections, workshop
from eom.checker.repair.lines import line
from eom.errors import InputError
from eom.terms.terms import Term, atom, nodes
from eom.terms.terms import replace as rewritten
from eom.worlds.worlds import closure

_CENTRE = (
    r"(?:the |its )?(?:cent(?:re|er) of (?:mass|gravity)|mass cent(?:re|er)|c\.?m\.?|c\.?g\.?)"
)
_A = r"(?:an? |any |the |some |every )?(?:arbitrary |any )?"
POINTS: tuple[tuple[str, tuple[str, ...]], ...] = (
    (_CENTRE, ("about_centre",)),
    (rf"{_A}(?:inertial|inertially fixed|fixed|fixed inertial|stationary)(?: reference)? point",
     ("O_fixed_in_space",)),
    (rf"{_A}point (?:that is |which is )?(?:inertially fixed|fixed in (?:inertial )?space)",
     ("O_fixed_in_space",)),
    (rf"{_A}(?:body[- ]fixed point|point (?:that is |which is )?(?:fixed in|of) the body)",
     ("O_fixed_in_body",)),
    ((rf"{_A}point (?:that is |which is )?fixed (?:both )?in (?:both )?the body and (?:in )?"
     r"(?:inertial )?space"), ("O_fixed_in_body", "O_fixed_in_space")),
    (r"(?:any|an arbitrary|every) point", ()),
)  # fmt: skip
"""Words for a point, and what they say of O."""

_ABOUT = re.compile(
    r"\x02(?P<number>\d+)\x03 holds (?:(?:if|when|provided) )?(?:it is |they are |both are )?"
    r"(?:(?:calculated|taken|computed|evaluated|written|expressed|formed|derived) )?"
    r"(?:about|with respect to|relative to) (?P<points>.+)"
)
_QUANTITIES = frozenset({"torque", "inertia", "angular_momentum", "absolute_angular_momentum"})
_LAWS = ("body_frame", "newton_2", "third_law_strong")
_PLACES = frozenset({"about_centre", "O_fixed_in_space", "O_at_origin", "C_at_rest"})
"""What a note may state of the points, and the words of the claim say otherwise."""


def number_in(text: str) -> int | None:
    """Return the number of the display that a sentence of this kind is about, else None."""
    match = _ABOUT.fullmatch(text)
    return int(match["number"]) if match and _points(match["points"]) is not None else None


def at_points(
    text: str, one: Understood, stated: Iterable[str], given: tuple[str, ...]
) -> Decision | None:
    """Return the verdict on "this holds about such points"; ``one``: what the sentence is about."""
    match = _ABOUT.fullmatch(text)
    points = _points(match["points"]) if match else None
    claim = _claim(one, given, frozenset(stated))
    if points is None or claim is None:
        return None
    known = [n for n in stated if n not in _PLACES]
    decided = [_at(claim, words, names, known, given) for words, names in points]
    if any(d is None for d in decided):
        return None
    found = [d for d in decided if d is not None]
    return next((d for d in found if d.verdict == WRONG), found[0])


def _points(words: str) -> list[tuple[str, tuple[str, ...]]] | None:
    """Return what each of the points says, None if one of them is not known here."""
    found = []
    for part in re.split(r",? or (?:about |with respect to |relative to )?", words):
        names = next((n for p, n in POINTS if re.fullmatch(p, part.strip())), None)
        if names is None:
            return None
        found.append((part.strip(), names))
    return found


def _claim(one: Understood, given: tuple[str, ...], stated: frozenset[str]) -> Claim | None:
    """Return what a display says with all its points called O; of one with a slip, what was meant."""
    judged = verdict(one, given).claims
    if len(judged) != 1:
        return None
    claim = judged[0].claim
    if judged[0].verdict in GRAVE:
        wrong = line(one, claim)
        found = corrections(one, workshop(one, wrong, given), given, stated) if wrong else []
        if not found:
            return None
        claim = found[0].claim
    plain = claim.kind == STATEMENT and EQUALITIES.issuperset(claim.relations) and claim.members
    if claim.findings or claim.model is not None or not plain:
        return None
    terms = [*(m.term for m in claim.members), *claim.scalars.values()]
    names = {n.data[0] for t in terms for n in nodes(t) if n.head == "atom"}
    return _about_o(claim) if names & _QUANTITIES and "position" not in names else None


def _about_o(claim: Claim) -> Claim:
    def rule(term: Term) -> Term:
        about = term.head == "atom" and term.data[0] in _QUANTITIES and term.data[-1] == "C"
        return atom(*term.data[:-1], "O", kind=term.kind) if about else term

    members = tuple(replace(m, term=rewritten(m.term, rule)) for m in claim.members)
    scalars = {s: rewritten(t, rule) for s, t in claim.scalars.items()}
    return replace(claim, members=members, scalars=scalars)


def _at(
    claim: Claim, words: str, names: tuple[str, ...], known: list[str], given: tuple[str, ...]
) -> Decision | None:
    """Return whether a claim holds about one point, None where no world tells."""
    for assumed in _largest([*_LAWS, *names], known):
        found = judge_within(claim, assumed, given)
        if found.verdict == WRONG:
            return Decision(WRONG, (), _failing(claim, words, assumed, given))
        if found.sets:
            return Decision(UNDER, found.sets)
        return Decision(found.verdict, (), found.reason)
    return None


def _largest(names: list[str], known: list[str]) -> Iterator[frozenset[str]]:
    """Yield what is assumed: with all that is known if that can stand together, else without."""
    for more in (known, []):
        try:
            yield closure([*names, *more])
        except InputError:
            continue


def _failing(claim: Claim, words: str, assumed: frozenset[str], given: tuple[str, ...]) -> str:
    """Return that a claim fails about a point, and what else that needs to be."""
    for more, told in (
        ("O_fixed_in_body", "fixed in the body"),
        ("O_fixed_in_space", "fixed in space"),
    ):
        try:
            wider = closure([*assumed, more])
        except InputError:
            continue
        if more not in assumed and judge_within(claim, wider, given).verdict != WRONG:
            return f"about {words} it fails, unless that is {told} as well"
    return f"about {words} it fails"
