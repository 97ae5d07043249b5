r"""Phrases of English and what they say of a motion: points, frames, quantities, clauses, theorems.

A clause is read only if all of its words are known; anything else has no meaning here. Knowledge is the
tables: general phrases that all others are written with, nouns with the quantities that they may stand
for, points, predicates, and clauses that say it all. The marks ``\x02n\x03`` stand for the n-th formula
of the sentence.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import combinations
from typing import Any

from eom.checker.prose_claims.assumptions import inertia_entry
from eom.checker.prose_claims.propositions import (
    NOT_NEGATIVE,
    NOT_ZERO,
    POSITIVE,
    ZERO,
    All,
    AnyOf,
    Not,
    Plain,
    Proposition,
    Reading,
    Test,
    equal,
)
from eom.terms.terms import (
    DYADIC,
    MATRIX,
    SCALAR,
    VECTOR,
    Term,
    column,
    cross,
    der,
    dot,
    inner,
    matmul,
    transpose,
)
from eom.terms.vocabulary import omega, position, quantity, unit

GENERAL: dict[str, str] = {
    "formula": r"\x02(\d+)\x03",
    "article": r"(?:(?:the|its|any|a|an|this) )?",
    "a": r"(?:an? |any |the |some |every )?(?:arbitrary |any )?",
    "be": r"(?:is|are|be|being|remains?|stays?|must be|has to be|will be|to be)",
    "adverbs": (
        r"(?: (?:always|then|also|therefore|thus|identically|strictly|still|in fact|necessarily))*"
    ),
    "are": r"<be><adverbs>",
    "centre": (
        r"(?:the |its )?(?:cent(?:re|er) of (?:mass|gravity)|mass cent(?:re|er)|c\.?m\.?|c\.?g\.?|"
        r"centroid)"
    ),
    "who": r"(?:(?:the |a |this )?(?:rigid )?(?:body|spacecraft|satellite|rotation|motion|it) )?",
    "turns": (
        r"<who>(?:(?:is|be|only|to be) )*(?:rotating|rotates|rotate|rotation|spinning|spins|spin|"
        r"turning|turns|turn|is|occurs)"
    ),
    "one": r"(?:only |just |exactly )?(?:(?:one|1|a single|a|any)(?: of the)?|(?:one|1) of its)",
    "single": r"(?:one|1|a single)",
    "principal": r"principal (?:body |inertia )?ax[ie]s(?: of inertia)?",
    "moments": r"(?:the |its |all )?(?:three )?principal moments(?: of inertia)?",
    "torque": r"(?:external |net |applied |resultant |total )*(?:torque|moment)s?",
    "body": (
        r"(?:the|a|an|any|every|each) (?:rigid |deformable |flexible )?"
        r"(?:continuum|body|system|spacecraft|object|collection)"
        r"(?: of (?:point masses|particles|masses))?"
    ),
    "forces": r"(?:the |all )?(?:the )?(?:external |applied |resultant |total )*forces?(?: on it)?",
    "there": r"(?:there|(?:at|in) <centre>|(?:at|in) (?:this|that) point)",
    "if_all": (
        r"(?:if|with|as though|as if) all(?: the| of the| its)? mass(?: of the body| of it)? "
        r"(?:were |was |is )?(?:concentrated |located |lumped )?<there>"
    ),
    "pushed": r"(?:,? and(?: if)? <forces> (?:acted|were acting|acts?|were applied) <there>)?",
    "moves": r"(?:acts|moves|behaves|translates|accelerates)(?: identically| exactly| just)?",
    "like": r"(?:as if it were|as though it were|as|like|to)",
    "particle": r"(?:an?|one) (?:point[- ]mass|(?:single )?particle|mass point)(?: located)?",
    "loss": (
        r"(?:(?:in the presence of|with|under|when there is|if there is)(?: internal| any| some)? "
        r"(?:energy )?(?:dissipation|damping)|(?:if|when) (?:kinetic )?energy is dissipated)"
    ),
    "lossless": (
        r"(?:without (?:any )?(?:energy )?(?:dissipation|damping)|for a rigid body|"
        r"if the body is rigid)"
    ),
    "spin": (
        r"(?:(?:the|a|any|steady|pure|free|torque-free|uniform|simple) )*(?:rigid body )?"
        r"(?:rotation|rotations|spin|spins|spinning|motion)"
    ),
    "change": r"(?:do not|cannot|never) (?:affect|influence|change|contribute to)",
}
"""Phrases that others are written with, by the name that stands for them in angle brackets."""


@cache
def phrase(pattern: str) -> str:
    """Return a pattern with general phrases in place of their names.

    >>> phrase("about <single> axis")
    'about (?:one|1|a single) axis'
    """
    return re.sub(r"(?<!\?P)<(\w+)>", lambda m: phrase(GENERAL[m[1]]), pattern)


@dataclass(frozen=True)
class Subject:
    """What a noun or a formula stands for: terms with what they mean, "" for what everybody means."""

    text: str
    terms: tuple[tuple[Term, str], ...]
    scalars: Mapping[Any, Term]


@dataclass(frozen=True)
class Formulas:
    """The formulas of a sentence: propositions, subjects and names of points, by number."""

    propositions: Mapping[int, Proposition]
    subjects: Mapping[int, Subject]
    points: Mapping[int, str]


# -- quantities -----------------------------------------------------------------------------------

_I = quantity("inertia", "C")
_W = omega()
_H = quantity("angular_momentum", "body", "C")
_M = quantity("torque", "body", "C")
_T = quantity("rotational_energy", "body", "C")
_ABOUT_O = "about the reference point"

NOUNS: tuple[tuple[str, tuple[tuple[Term, str], ...]], ...] = (
    (r"<torque>", ((_M, ""), (quantity("torque", "body", "O"), f"torque {_ABOUT_O}"))),
    (r"(?:rotation(?:al)? rate|rate of rotation)",
     ((_W, ""), (dot(_W, _W), "the magnitude of the angular velocity"))),
    (r"(?:angular velocity(?: vector)?|angular rates)", ((_W, ""),)),
    (r"angular acceleration", ((der(_W), ""),)),
    (r"(?:total )?angular momentum(?: vector)?",
     ((_H, ""), (quantity("angular_momentum", "body", "O"), f"angular momentum {_ABOUT_O}"))),
    (r"(?:rotational (?:kinetic )?energy|kinetic energy of rotation)", ((_T, ""),)),
    (r"(?:total )?kinetic energy",
     ((_T, "kinetic energy of rotation"),
      (quantity("kinetic_energy", "body"), "kinetic energy of the whole motion"))),
)  # fmt: skip
"""Nouns and what they may stand for."""

Point = tuple[str, tuple[str, ...], Callable[[str], Term] | None]

POINTS: tuple[Point, ...] = (
    (r"<centre>", ("about_centre",), lambda p: position("C", p)),
    ((r"<a>(?:inertial|inertially fixed|fixed inertial)(?: reference)?(?: point)?|"
     r"<a>(?:fixed|stationary)(?: reference)? point|"
     r"(?:<a>point (?:that is |which is )?)?(?:inertially fixed|fixed in (?:inertial )?space)"),
     ("O_fixed_in_space",), lambda p: der(position(p, "OI"))),
    (r"unaccelerated|not accelerat(?:ed|ing)", (), lambda p: der(position(p, "OI"), times=2)),
    ((r"<a>body[- ]fixed point|<a>point of the body|"
     r"(?:<a>point (?:that is |which is )?)?fixed in (?:the body|it)"),
     ("O_fixed_in_body",), lambda p: der(position(p, "C"), "B")),
    ((r"<a>point (?:that is |which is )?fixed (?:both )?in (?:both )?the body and (?:in )?"
     r"(?:inertial )?space"), ("O_fixed_in_body", "O_fixed_in_space"), None),
    (r"(?:any|an arbitrary|every) point", (), None),
)  # fmt: skip
"""Words for a point, assumptions that say so of O, and what is zero where a point is such a one."""


def point(words: str) -> Point | None:
    """Return the row of the points that words name, None for none."""
    return next((row for row in POINTS if re.fullmatch(phrase(row[0]), words)), None)


# -- predicates -----------------------------------------------------------------------------------

_FRAMES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ((r" (?:in|as seen in|relative to|with respect to) (?:the )?body(?:[- ]fixed)?(?: reference)?"
      r"(?: frame| axes)?"), ("B",)),
    (r" (?:in|with respect to|relative to) (?:an? |the )?inertial(?:ly fixed)? (?:frame|space)", ("I",)),
    (r" in (?:inertial )?space", ("I",)),
    (r" in (?:all|any|every) (?:frames?|reference frames?)", ("I", "B")),
)  # fmt: skip
"""Words that say in which frame something is constant."""

_CONSTANT = (
    r"(?:<are> (?:constant|conserved|unchanged|steady)(?: in time)?|does not change|does not vary|"
    r"to remain constant)"
)
_CHANGING = r"(?:<are> (?:changing|varying|not constant|not conserved)|changes|varies|to change)"

Predicate = Callable[[Subject, re.Match[str], Formulas], Proposition | None]


def _constant(subject: Subject, frames: Sequence[str] = ()) -> Plain:
    found = tuple(
        Reading((row,), ", ".join(filter(None, (own, w))))
        for t, own in subject.terms
        for row, w in _constant_readings(t, frames)
    )
    return Plain(f"{subject.text} is constant", found, subject.scalars)


def _constant_readings(term: Term, frames: Sequence[str]) -> list[tuple[tuple[Test, ...], str]]:
    """Return what "constant" may mean: of a vector, in the frame that is named, or in either."""
    if term.kind not in {VECTOR, DYADIC} or term == _W:
        return [((Test(der(term)),), "")]
    if frames:
        return [(tuple(Test(der(term, f)) for f in frames), "")]
    return [
        ((Test(der(term)),), "constant in the inertial frame"),
        ((Test(der(term, "B")),), "constant in the body frame"),
    ]


def _compared(
    words: str,
    relation: str,
    kinds: frozenset[str] = frozenset(),
    made: Callable[[Term], Term] = lambda t: t,
) -> Predicate:
    """Return the predicate that what is made of a subject of certain kinds has a relation to zero."""

    def said(subject: Subject, _: re.Match[str], __: Formulas) -> Proposition | None:
        if kinds and not all(t.kind in kinds for t, _ in subject.terms):
            return None
        found = tuple(Reading(((Test(made(t), relation),),), w) for t, w in subject.terms)
        return Plain(f"{subject.text} is {words}", found, subject.scalars)

    return said


def _denied(said: Predicate) -> Predicate:
    def opposite(subject: Subject, match: re.Match[str], formulas: Formulas) -> Proposition | None:
        made = said(subject, match, formulas)
        return None if made is None else Not(made)

    return opposite


def _related(
    name: str,
    join: Callable[[Term, Term], Term],
    subject: Subject,
    match: re.Match[str],
    formulas: Formulas,
) -> Proposition | None:
    """Return that one vector is along another or across it."""
    other = _subject(match["other"], formulas)
    pairs = [(a, b) for a, _ in subject.terms for b, _ in other.terms] if other else []
    if other is None or any(t.kind != VECTOR for pair in pairs for t in pair):
        return None
    found = tuple(Reading(((Test(join(a, b)),),)) for a, b in pairs)
    scalars = {**subject.scalars, **other.scalars}
    return Plain(f"{subject.text} is {name} {other.text}", found, scalars)


def _form(term: Term) -> Term:
    """Return the quadratic form of a matrix or dyadic with any vector."""
    any_vector = quantity("vector", "any direction")
    if term.kind == DYADIC:
        return dot(any_vector, dot(term, any_vector))
    frame = next((n for n in term.data if isinstance(n, str)), "B")
    x = column(any_vector, frame)
    return inner(x, matmul(term, x))


_ZERO = _compared("zero", ZERO)
_SCALARS, _MATRICES = frozenset({SCALAR}), frozenset({MATRIX})
PREDICATES: tuple[tuple[str, Predicate], ...] = (
    *((_CONSTANT + p, lambda s, _, __, f=f: _constant(s, f)) for p, f in (("", ()), *_FRAMES)),
    *((_CHANGING + p, lambda s, _, __, f=f: Not(_constant(s, f))) for p, f in (("", ()), *_FRAMES)),
    (r"(?:<are> (?:zero|null|absent)|vanish(?:es)?|to vanish)", _ZERO),
    (r"(?:<are> (?:not zero|nonzero|non-zero|different from zero)|does not vanish)", _denied(_ZERO)),
    (r"<are> positive", _compared("positive", POSITIVE, _SCALARS)),
    (r"<are> (?:non-?negative|never negative|not negative)",
     _compared("not negative", NOT_NEGATIVE, _SCALARS)),
    (r"(?:<are> )?symmetric", _compared("symmetric", ZERO, _MATRICES, lambda t: t - transpose(t))),
    (r"(?:<are> )?positive[- ]definite",
     _compared("positive definite", POSITIVE, _MATRICES | {DYADIC}, _form)),
    (r"<be> (?:parallel to|along|aligned with|in the direction of|collinear with) (?P<other>.+)",
     partial(_related, "along", cross)),
    (r"<be> (?:perpendicular|orthogonal|normal) to (?P<other>.+)", partial(_related, "across", dot)),
)  # fmt: skip
"""What may be said of a subject."""


# -- clauses --------------------------------------------------------------------------------------


def _newton() -> Term:
    momentum = quantity("total_mass", "body") * der(position("C", "OI"), times=2)
    return momentum - quantity("external_force", "body")


def _euler() -> Term:
    return der(_H) - _M


THEOREMS: tuple[tuple[str, Term], ...] = (
    (r"(?:in translation,? )?<body> <moves> <like> <particle>(?: <there>)?(?: <if_all>)?<pushed>",
     _newton()),
    ((r"<centre>(?: of (?:the|a|any) (?:rigid )?(?:body|system))? <moves> "
     r"(?:<like> <particle>(?: <if_all>)?|<if_all>)<pushed>"), _newton()),
    (r"(?:the )?internal forces <change> (?:the motion of <centre>|the (?:total )?linear momentum)",
     _newton()),
    (r"(?:the )?internal forces <change> the (?:total )?angular momentum(?: about <centre>)?", _euler()),
    ((r"the (?:rate of change|time derivative) of (?:the )?(?:total )?angular momentum about <centre> "
     r"(?:is equal to|equals|is) the <torque>(?: about (?:it|<centre>|the same point))?"), _euler()),
)  # fmt: skip
"""Laws of mechanics in words, and what is zero by them."""


def _component(k: int) -> Term:
    return dot(unit("B", k), _W)


def _about_principal(words: str) -> tuple[Reading, ...]:
    """Return "about a principal axis": along b1, b2 or b3, or omega x I omega = 0."""
    tests = [tuple(Test(_component(k)) for k in pair) for pair in combinations((1, 2, 3), 2)]
    along = Reading(tuple(tests), "about b1, b2 or b3")
    return along, Reading(((Test(cross(_W, dot(_I, _W))),),), words)


@cache
def _clauses() -> tuple[tuple[re.Pattern[str], Proposition], ...]:
    """Return clauses that say it all."""
    steady = Reading(((Test(cross(_W, der(_W))),),), "about an axis that stays in the body")
    principal = Plain("the body turns about one principal axis", _about_principal(""))
    any_axis = (*_about_principal("the axis is a principal one"), steady)
    one = Plain("the body turns about one axis", any_axis)
    no_torque = Plain("no torque acts", tuple(Reading(((Test(t),),), w) for t, w in NOUNS[0][1]))
    pairs = list(combinations((1, 2, 3), 2))
    gaps = [inertia_entry(a, a) - inertia_entry(b, b) for a, b in pairs]
    axes = tuple(Test(inertia_entry(a, b)) for a, b in pairs)
    symmetric = Plain(
        "two principal moments are equal", (Reading(tuple((*axes, Test(g)) for g in gaps)),)
    )
    sphere = equal("all principal moments are equal", *(t for t, _ in axes), *gaps)
    different = Plain(
        "the principal moments differ",
        (Reading(((*axes, *(Test(g, NOT_ZERO) for g in gaps)),)),),
    )
    table: tuple[tuple[str, Proposition], ...] = (
        (r"(?:a|an|any|some) (?:external |net )?torque (?:acts|is applied)(?: on the body)?",
         Not(no_torque)),
        (r"<turns> about (?:only |just )?<one> (?:of the )?<principal>", principal),
        (r"<turns> about (?:only |just |exactly )?<single> axis", one),
        (r"<turns> about more than <single> ax[ie]s", Not(one)),
        (r"<turns> about more than <single> <principal>", Not(principal)),
        (r"<who>(?:does not (?:rotate|turn)|is not (?:rotating|turning))",
         equal("the body does not turn", _W)),
        (r"(?:there is )?no <torque>(?: acts?| is applied)?(?: on the body)?", no_torque),
        (r"(?:in )?the absence of (?:an? |any )*<torque>", no_torque),
        (r"(?:the (?:body|motion) is )?torque[- ]free", no_torque),
        (r"<who>(?:is |be )?(?:(?:inertially |dynamically )?(?:axi)?symmetric(?:al)?)", symmetric),
        (r"two (?:of the )?principal moments(?: of inertia)? <be> equal", symmetric),
        (r"<who>(?:is |be )(?:an? )?(?:spherical(?:ly symmetric)?(?: body)?|sphere)", sphere),
        (r"<moments> <be> (?:all )?(?:equal|the same)", sphere),
        (r"<moments> <be> (?:all )?(?:distinct|different)", different),
        *((p, equal("the law holds", term)) for p, term in THEOREMS),
    )  # fmt: skip
    return tuple((re.compile(phrase(p)), made) for p, made in table)


def _of_point(words: str, formulas: Formulas) -> Proposition | None:
    pattern = r"(?:the )?(?:(?:reference )?point )?<formula> (?P<said><be>(?: at)? (?P<which>.+))"
    match = re.fullmatch(phrase(pattern), words)
    name = formulas.points.get(int(match[1])) if match else None
    row = point(match["which"]) if match else None
    if match is None or name is None or row is None or row[2] is None:
        return None
    return equal(f"{name} {match['said']}", row[2](name))


# -- reading --------------------------------------------------------------------------------------

_ANY_NOUN = "|".join(phrase(p) for p, _ in NOUNS)
_NAMED = phrase(rf"(?:<article>(?:{_ANY_NOUN}) )?<formula>")
_ALONE = phrase(rf"(?:<article>(?:{_ANY_NOUN}) )?(?:we have )?<formula>(?: holds)?")
_MAGNITUDE = re.compile(r"(?:the )?(?:magnitude|norm|length) of ")
_DIFFERENCE = re.compile(r"(?:the )?(?:difference|distinction) between (.+?) and (.+)")


def _subject(words: str, formulas: Formulas) -> Subject | None:
    """Return what a noun, a formula, a noun with its formula, or something of these stands for."""
    words = words.strip()
    size = _MAGNITUDE.match(words)
    if size:
        inside = _subject(words[size.end() :], formulas)
        if inside is None or any(t.kind != VECTOR for t, _ in inside.terms):
            return None
        terms = tuple((dot(t, t), w) for t, w in inside.terms)
        return Subject(f"the magnitude of {inside.text}", terms, inside.scalars)
    pair = _DIFFERENCE.fullmatch(words)
    if pair:
        return _difference(_subject(pair[1], formulas), _subject(pair[2], formulas))
    named = re.fullmatch(_NAMED, words)
    if named:
        return formulas.subjects.get(int(named[1]))
    for pattern, terms in NOUNS:
        if re.fullmatch(phrase(f"<article>{pattern}"), words):
            return Subject(words, terms, {})
    return None


def _difference(first: Subject | None, second: Subject | None) -> Subject | None:
    """Return the difference of two quantities of one kind, each as everybody means it."""
    if first is None or second is None or first.terms[0][0].kind != second.terms[0][0].kind:
        return None
    term = first.terms[0][0] - second.terms[0][0]
    scalars = {**first.scalars, **second.scalars}
    return Subject(f"{first.text} - {second.text}", ((term, ""),), scalars)


def clause(words: str, formulas: Formulas) -> Proposition | None:
    """Return what a clause says, None if a word of it is not known here.

    >>> clause("the torque is zero", Formulas({}, {}, {})).text
    'the torque is zero'
    >>> clause("the torque is zero on Sundays", Formulas({}, {}, {}))
    """
    words = re.sub(r"^(?:both|either|that|then|also|even) ", "", words.strip())
    for separator, join in (
        (r",? or (?:if |when )?", AnyOf),
        (r",? (?:and|&) (?:if |when |that )?", All),
    ):
        parts = re.split(separator, words)
        found = _shared(parts, formulas) if len(parts) > 1 else None
        if found is not None:
            return join(found)
    return _single(words, formulas)


def _shared(parts: Sequence[str], formulas: Formulas) -> tuple[Proposition, ...] | None:
    """Return parts of a list; one without a subject has that of the part before."""
    found: list[Proposition] = []
    before = ""
    for part in parts:
        one = clause(part, formulas)
        for verb in ("", "is ") if one is None and before else ():
            one = one or clause(f"{before} {verb}{part}", formulas)
        if one is None:
            return None
        found.append(one)
        begun = re.match(phrase(r"(.*?) (?=<be>\b|vanish|does not)"), part)
        before = begun[1] if begun else before
    return tuple(found)


def _single(words: str, formulas: Formulas) -> Proposition | None:
    alone = re.fullmatch(_ALONE, words)
    if alone:
        return formulas.propositions.get(int(alone[1]))
    made = next((made for pattern, made in _clauses() if pattern.fullmatch(words)), None)
    made = made or _of_point(words, formulas)
    if made is not None:
        return made
    for match in re.finditer(r" ", words):
        subject = _subject(words[: match.start()], formulas)
        rest = words[match.end() :]
        found = None if subject is None else _said(subject, rest, formulas)
        if found is not None:
            return found
    return None


def _said(subject: Subject, words: str, formulas: Formulas) -> Proposition | None:
    """Return what is said of a subject; a frame may stand in front of the verb."""
    for pattern, _ in _FRAMES:
        match = re.match(pattern[1:] + " ", words)
        if match:
            words = words[match.end() :] + " " + words[: match.end() - 1]
            break
    found = ((re.fullmatch(p, words), rule) for p, rule in _predicates())
    made = (rule(subject, match, formulas) for match, rule in found if match)
    return next((m for m in made if m is not None), None)


@cache
def _predicates() -> tuple[tuple[re.Pattern[str], Predicate], ...]:
    return tuple((re.compile(phrase(p)), rule) for p, rule in PREDICATES)
