"""Statements in words on the stability of spins and the sense of precession.

Sentences are recognised as wholes, by the tables here, and judged by the linearised equations: the free
rigid body (`eom.mechanics.steady`), the body with a viscous slug (`eom.mechanics.dissipation`), the
symmetric body in free precession (`eom.mechanics.freebody`; Hughes, Spacecraft Attitude Dynamics, 1986,
ch. 4 and 5). The sign that decides is the same for all moments in one order, so one body stands for all.

Theorems of mechanics in words: "the centre of mass moves as if all mass were concentrated there".

Each row of the table is a way to say an equation; the judge says under which assumptions it holds.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache

from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER, WRONG, judge
from eom.checker.mean.claims import Claim
from eom.checker.mean.values import ANY, Value
from eom.checker.prose_claims.quantified import Decision
from eom.checker.report.findings import Counterexample
from eom.mechanics.dissipation import damped_stability, nutation_trend
from eom.mechanics.freebody import precession
from eom.mechanics.steady import spin_stability
from eom.terms.terms import Term, der
from eom.terms.vocabulary import position, quantity

RANKS: dict[str, int] = {
    **dict.fromkeys(("smallest", "least", "minimum", "minimal", "minor", "min"), 1),
    **dict.fromkeys(("intermediate", "middle", "medium"), 2),
    **dict.fromkeys(("largest", "greatest", "maximum", "maximal", "major", "max"), 3),
}
"""Words for a principal moment among three different ones, and its place by size."""

MOMENTS = (2, 3, 4)
"""Principal moments of inertia of the body that stands for all with three different ones."""
SHAPES = {"prolate": (3, 2), "oblate": (3, 4)}
"""Moments across and along the axis of symmetry."""
KINDS = {
    **dict.fromkeys(("stable", "directionally stable"), True),
    **dict.fromkeys(("unstable", "not stable"), False),
}
SENSES = {"direct": "direct", "prograde": "direct", "retrograde": "retrograde"}

_RANK = rf"({'|'.join(RANKS)})"
_INERTIA = r"(?: (?:principal )?(?:moment of inertia|inertia|principal moment))?"
_AXIS = (
    r"(?:the|its|an?) (?:ax[ie]s (?:of|with) (?:the )?)?"
    rf"{_RANK}{_INERTIA}(?:(?: ax[ie]s)? and(?: the)? {_RANK}{_INERTIA})?"
)
_TURNING = (
    r"(?:(?:the|a|any|steady|pure|free|torque-free|uniform|simple) )*(?:rigid body )?"
    r"(?:rotation|rotations|spin|spins|spinning|motion)"
)
_SPIN = rf"{_TURNING}(?: of (?:a|the) (?:rigid )?body)?"
_KIND = rf"(?:is|are)(?: always| also)? ({'|'.join(sorted(KINDS, key=len, reverse=True))})"
_LOSS = (
    r"(?:in the presence of|with|under|when there is|if there is)(?: internal| any| some)? "
    r"(?:energy )?(?:dissipation|damping)|(?:if|when) (?:kinetic )?energy is dissipated"
)
_RIGID_BODY = (
    r"(?:without (?:any )?(?:energy )?(?:dissipation|damping)|"
    r"for a rigid body|if the body is rigid)"
)
_TAIL = rf"(?:,? (?:({_LOSS})|({_RIGID_BODY})))?"

_SPINS = re.compile(
    rf"(?:({_LOSS}),? |({_RIGID_BODY}),? )?(only )?{_SPIN} about {_AXIS}(?: ax[ie]s)? {_KIND}{_TAIL}"
)
_SYMMETRIC = re.compile(
    rf"(?:({_LOSS}),? |({_RIGID_BODY}),? )?{_TURNING}"
    rf"(?: of an? ({'|'.join(SHAPES)})(?: (?:axi)?symmetric)?(?: rigid)? "
    rf"(?:body|spacecraft|satellite)) about its (?:axis of symmetry|symmetry axis) {_KIND}{_TAIL}"
)
_PRECESSION = re.compile(
    rf"(?:the )?(?:(?:free|torque-free) )?precession of an? ({'|'.join(SHAPES)})(?: (?:axi)?symmetric)?"
    rf"(?: rigid)? (?:body|spacecraft|satellite) is ({'|'.join(SENSES)})"
)

_RIGID = ("rigid", "torque_free", "three different principal moments of inertia")
_QUASI = (
    "no torque acts from outside",
    "energy is lost inside",
    "three different principal moments of inertia",
)
_FREE = ("rigid", "torque_free", "symmetric")
_LOSING = ("no torque acts from outside", "energy is lost inside", "an axis of inertial symmetry")


def stability(sentence: str) -> Decision | None:
    """Return the verdict on a sentence in small letters; None where it is none of these statements.

    >>> stability("rotation about the intermediate axis is stable").verdict
    'wrong'
    >>> stability("spin about the axis of minimum inertia is unstable with energy dissipation").verdict
    'holds under'
    """
    words = re.sub(r"^(?:note that|hence|thus|therefore|so),? ", "", sentence)
    for pattern, rule in (
        (_SPINS, _of_spins),
        (_SYMMETRIC, _of_symmetric),
        (_PRECESSION, _of_sense),
    ):
        match = pattern.fullmatch(words)
        if match is not None:
            return rule(match)
    return None


def _of_spins(match: re.Match[str]) -> Decision:
    lost, kept, only, first, second, kind, lost_after, kept_after = match.groups()
    ranks = {RANKS[r] for r in (first, second) if r}
    said = KINDS[kind]
    others = {1, 2, 3} - ranks if only else set[int]()
    claimed = dict.fromkeys(ranks, said) | dict.fromkeys(others, not said)

    def wrong(loses: bool) -> list[int]:
        return [r for r, stable in sorted(claimed.items()) if _stable(r, loses) != stable]

    return _chosen(
        [
            (_RIGID, [f"the spin about b{r} is {_kind(r, False)}" for r in wrong(False)]),
            (_QUASI, [f"the spin about b{r} is {_kind(r, True)}" for r in wrong(True)]),
        ],
        bool(lost or lost_after),
        bool(kept or kept_after),
        _body(next(iter(wrong(bool(lost or lost_after))), min(ranks))),
    )


def _chosen(
    bodies: Sequence[tuple[tuple[str, ...], list[str]]],
    loses: bool,
    rigid: bool,
    body: Counterexample,
) -> Decision:
    """Return the verdict for the rigid body and the one that loses energy, by which of them is meant.

    What is wrong for one and right for the other is undecided where the sentence names neither.
    """
    names, against = bodies[int(loses)]
    if not against:
        return Decision(UNDER, (names,))
    other, against_other = bodies[1]
    if loses or rigid or against_other:
        return Decision(WRONG, (), against[0], body)
    reason = f"{against[0]} for a rigid body; it is right where {' and '.join(other[:2])}"
    return Decision(UNDECIDED, (), reason, body)


@cache
def _kind(rank: int, loses: bool) -> str:
    return damped_stability(MOMENTS, rank) if loses else spin_stability(MOMENTS, rank).kind


def _stable(rank: int, loses: bool) -> bool:
    return _kind(rank, loses) == "stable"


def _body(rank: int) -> Counterexample:
    spin = tuple(int(k == rank) for k in (1, 2, 3))
    values = ((r"I_C", rf"\mathrm{{diag}}{MOMENTS}"), (r"\omega", str(spin)))
    return Counterexample(values, ())


def _of_symmetric(match: re.Match[str]) -> Decision:
    lost, kept, shape, kind, lost_after, kept_after = match.groups()
    across, along = SHAPES[shape]
    rigid, quasi = spin_stability((across, across, along), 3).kind, nutation_trend(across, along)
    rows = [
        (names, [] if (found == "stable") == KINDS[kind] else [f"it is {found}"])
        for names, found in ((_FREE, rigid), (_LOSING, quasi))
    ]
    return _chosen(rows, bool(lost or lost_after), bool(kept or kept_after), _symmetric_body(shape))


def _of_sense(match: re.Match[str]) -> Decision:
    shape, sense = match.groups()
    across, along = SHAPES[shape]
    found = precession(across, along, (1, 0, 1)).sense
    if found == SENSES[sense]:
        return Decision(UNDER, (_FREE,))
    return Decision(WRONG, (), f"it is {found}", _symmetric_body(shape))


def _symmetric_body(shape: str) -> Counterexample:
    across, along = SHAPES[shape]
    return Counterexample(((r"I_C", rf"\mathrm{{diag}}({across}, {across}, {along})"),), ())


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
