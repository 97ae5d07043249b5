"""Theorems of mechanics in words: "the centre of mass moves as if all mass were concentrated there".

Each row of the table is a way to say an equation; the judge says under which assumptions it holds.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from eom.checker.judge.judge import HOLDS, UNDER, judge
from eom.checker.mean.claims import Claim
from eom.checker.mean.values import ANY, Value
from eom.checker.prose_claims.quantified import Decision
from eom.terms.terms import Term, der
from eom.terms.vocabulary import position, quantity

_MASS = quantity("total_mass", "body")
_CENTRE = r"(?:the |its )?(?:cent(?:re|er) of mass|mass cent(?:re|er)|c\.?m\.?|centroid)"
_BODY = (
    r"(?:the|a|an|any|every|each) (?:rigid |deformable |flexible )?"
    r"(?:continuum|body|system|spacecraft|object|collection)(?: of (?:point masses|particles|masses))?"
)
_FORCES = r"(?:the |all )?(?:the )?(?:external |applied |resultant |total )*forces?(?: on it)?"
_THERE = rf"(?:there|(?:at|in) {_CENTRE}|(?:at|in) (?:this|that) point)"
_IF_ALL = (
    rf"(?:if|with|as though|as if) all(?: the| of the| its)? mass(?: of the body| of it)? "
    rf"(?:were |was |is )?(?:concentrated |located |lumped )?{_THERE}"
)
_PUSHED = rf"(?:,? and(?: if)? {_FORCES} (?:acted|were acting|acts?|were applied) {_THERE})"
_POINT_MASS = r"(?:point[- ]mass|particle|single particle|mass point)"
_INTERNAL = r"(?:the )?internal forces"

Equation = tuple[Term, Term]


def _momentum(point: str) -> Equation:
    return der(quantity("angular_momentum", "body", point)), quantity("torque", "body", point)


_NEWTON: Equation = (
    _MASS * der(position("C", "OI"), times=2),
    quantity("external_force", "body"),
)

THEOREMS: tuple[tuple[str, Equation], ...] = (
    (
        (rf"(?:in translation,? )?{_BODY} (?:acts|moves|behaves|translates)"
         r"(?: identically| exactly| just)? (?:as|like|to|as if it were|as though it were)"
         rf" (?:a|one) {_POINT_MASS}(?: located)?"
         rf"(?: {_THERE})?(?: {_IF_ALL})?{_PUSHED}?"),
        _NEWTON,
    ),
    (
        (rf"{_CENTRE}(?: of (?:the|a|any) (?:rigid )?(?:body|system))? (?:moves|accelerates|behaves) "
         rf"(?:as|like)(?: if it were)? a {_POINT_MASS}(?: {_IF_ALL})?{_PUSHED}?"),
        _NEWTON,
    ),
    (
        (rf"{_CENTRE}(?: of (?:the|a|any) (?:rigid )?(?:body|system))? (?:moves|accelerates|behaves) "
         rf"{_IF_ALL}{_PUSHED}?"),
        _NEWTON,
    ),
    (
        (rf"{_INTERNAL} (?:do not|cannot|never) (?:affect|influence|change) "
         rf"(?:the motion of {_CENTRE}|the (?:total )?linear momentum)"),
        _NEWTON,
    ),
    (
        (rf"{_INTERNAL} (?:do not|cannot|never) (?:affect|influence|change|contribute to) "
         rf"the (?:total )?angular momentum(?: about {_CENTRE})?"),
        _momentum("C"),
    ),
    (
        (r"the (?:rate of change|time derivative) of (?:the )?(?:total )?angular momentum about "
         rf"{_CENTRE} (?:is equal to|equals|is) the (?:total |resultant |net )?(?:external )?"
         rf"(?:torque|moment)(?: about (?:it|{_CENTRE}|the same point))?"),
        _momentum("C"),
    ),
)  # fmt: skip
"""Sentences in small letters, and the two sides of what they say."""

_LEADS = re.compile(
    r"(?:(?:this|it|which|that|the above|this relation(?:ship)?|this equation|\x02\d+\x03) "
    r"(?:implies|means|shows|says|states|tells us)(?: that)?,?|"
    r"in other words,?|hence,?|thus,?|therefore,?|note that,?|so,?|clearly,?|that is,?) "
)
_INSERTED = re.compile(r",? ?(?:in translation|in fact|of course|for example|in particular),? ")


def theorem(sentence: str, given: Iterable[str]) -> Decision | None:
    """Return the verdict on a sentence in small letters that says a theorem, else None.

    >>> theorem("any body moves as a point mass located at its centre of mass", ()).verdict
    'holds under'
    """
    words = sentence.replace(" ,", ",")
    lead = _LEADS.match(words)
    while lead is not None:
        words = words[lead.end() :]
        lead = _LEADS.match(words)
    words = _INSERTED.sub(" ", words).strip()
    for pattern, (left, right) in THEOREMS:
        if re.fullmatch(pattern, words):
            sides = tuple(Value(t, t.kind, None, ANY) for t in (left, right))
            found = judge(Claim(sides, ("=",)), given)
            return Decision(found.verdict, found.sets) if found.verdict in {HOLDS, UNDER} else None
    return None
