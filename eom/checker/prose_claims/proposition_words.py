r"""Words about motions as propositions: "the torque is zero", "the body spins about one principal axis".

A clause is read only if all of its words are known; anything else has no meaning here. Knowledge is the
tables: nouns with the quantities that they may stand for, predicates, and clauses that say it all. The
marks ``\x02n\x03`` stand for the n-th formula of the sentence.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from typing import Any

from eom.checker.prose_claims.propositions import (
    NOT_NEGATIVE,
    NOT_ZERO,
    POSITIVE,
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

FORMULA = r"\x02(\d+)\x03"


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


def _component(v: Term, k: int) -> Term:
    return dot(unit("B", k), v)


def _entry(a: int, b: int) -> Term:
    return dot(unit("B", a), dot(_I, unit("B", b)))


_ABOUT_O = "about the reference point"
NOUNS: tuple[tuple[str, tuple[tuple[Term, str], ...]], ...] = (
    (
        r"(?:external |net |applied |resultant |total )*(?:torque|moment|torques)",
        (
            (quantity("torque", "body", "C"), ""),
            (quantity("torque", "body", "O"), f"torque {_ABOUT_O}"),
        ),
    ),
    (
        r"(?:rotation(?:al)? rate|rate of rotation)",
        ((_W, ""), (dot(_W, _W), "the magnitude of the angular velocity")),
    ),
    (r"(?:angular velocity(?: vector)?|angular rates)", ((_W, ""),)),
    (r"(?:angular acceleration)", ((der(_W), ""),)),
    (
        r"(?:total )?angular momentum(?: vector)?",
        (
            (_H, ""),
            (quantity("angular_momentum", "body", "O"), f"angular momentum {_ABOUT_O}"),
        ),
    ),
    (
        r"(?:rotational (?:kinetic )?energy|kinetic energy of rotation)",
        ((quantity("rotational_energy", "body", "C"), ""),),
    ),
    (
        r"(?:total )?kinetic energy",
        (
            (quantity("rotational_energy", "body", "C"), "kinetic energy of rotation"),
            (quantity("kinetic_energy", "body"), "kinetic energy of the whole motion"),
        ),
    ),
)
"""Nouns and what they may stand for."""

# -- predicates -----------------------------------------------------------------------------------

_FRAMES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ((r" (?:in|as seen in|relative to|with respect to) (?:the )?body(?:[- ]fixed)?(?: reference)?"
      r"(?: frame| axes)?"), ("B",)),
    (r" (?:in|with respect to|relative to) (?:an? |the )?inertial(?:ly fixed)? (?:frame|space)", ("I",)),
    (r" in (?:inertial )?space", ("I",)),
    (r" in (?:all|any|every) (?:frames?|reference frames?)", ("I", "B")),
)  # fmt: skip
"""Words that say in which frame something is constant."""

_BE = r"(?:is|are|be|being|remains?|stays?|must be|will be|has to be|to be)"
_ADVERBS = (
    r"(?: (?:always|then|also|therefore|thus|identically|strictly|still|in fact|necessarily))*"
)

_CONSTANT = (
    rf"(?:{_BE}{_ADVERBS} (?:constant|conserved|unchanged|steady)(?: in time)?|does not change|"
    r"does not vary|to remain constant)"
)
_CHANGING = (
    rf"(?:{_BE}{_ADVERBS} (?:changing|varying|not constant|not conserved)|changes|varies|to change)"
)
_VANISHES = rf"(?:{_BE}{_ADVERBS} (?:zero|null|absent)|vanish(?:es)?|to vanish)"
_NOT_ZERO = (
    rf"(?:{_BE}{_ADVERBS} (?:not zero|nonzero|non-zero|different from zero)|does not vanish)"
)
_POSITIVE = rf"{_BE}{_ADVERBS} positive"
_NOT_NEGATIVE = rf"{_BE}{_ADVERBS} (?:non-?negative|never negative|not negative)"


def _constant_readings(term: Term, frames: Sequence[str]) -> list[tuple[tuple[Test, ...], str]]:
    """Return what "constant" may mean: of a vector, in the frame that is named, or in either."""
    if term.kind not in {VECTOR, DYADIC} or term == _W:
        return [((Test(der(term)),), "")]
    if len(frames) > 1:
        return [(tuple(Test(der(term, f)) for f in frames), "")]
    if frames:
        return [((Test(der(term, frames[0])),), "")]
    return [
        ((Test(der(term)),), "constant in the inertial frame"),
        ((Test(der(term, "B")),), "constant in the body frame"),
    ]


def _plain(subject: Subject, words: str, relation: str) -> Plain:
    """Return the proposition that a subject has a relation to zero."""
    found = tuple(Reading(((Test(t, relation),),), w) for t, w in subject.terms)
    return Plain(f"{subject.text} {words}", found, subject.scalars)


def _constant(subject: Subject, frames: Sequence[str]) -> Plain:
    found = tuple(
        Reading((row,), ", ".join(filter(None, (own, w))))
        for t, own in subject.terms
        for row, w in _constant_readings(t, frames)
    )
    return Plain(f"{subject.text} is constant", found, subject.scalars)


def _predicated(subject: Subject, words: str) -> Proposition | None:
    """Return what is said of a subject."""
    for pattern, frames in ((r"", ()), *_FRAMES):
        if re.fullmatch(_CONSTANT + pattern, words):
            return _constant(subject, frames)
        if re.fullmatch(_CHANGING + pattern, words):
            return Not(_constant(subject, frames))
    if re.fullmatch(_VANISHES, words):
        return _plain(subject, "is zero", "= 0")
    if re.fullmatch(_NOT_ZERO, words):
        return Not(_plain(subject, "is zero", "= 0"))
    if all(t.kind == SCALAR for t, _ in subject.terms):
        if re.fullmatch(_POSITIVE, words):
            return _plain(subject, "is positive", POSITIVE)
        if re.fullmatch(_NOT_NEGATIVE, words):
            return _plain(subject, "is not negative", NOT_NEGATIVE)
    return _of_form(subject, words)


_SYMMETRIC = rf"(?:{_BE}{_ADVERBS} )?symmetric"
_DEFINITE = rf"(?:{_BE}{_ADVERBS} )?positive[- ]definite"
_ANY = quantity("vector", "any direction")


def _of_form(subject: Subject, words: str) -> Proposition | None:
    """Return that a matrix is symmetric, or a matrix or dyadic positive definite."""
    kinds = {t.kind for t, _ in subject.terms}
    if re.fullmatch(_SYMMETRIC, words) and kinds == {MATRIX}:
        rows = tuple(Reading(((Test(t - transpose(t)),),), w) for t, w in subject.terms)
        return Plain(f"{subject.text} is symmetric", rows, subject.scalars)
    if re.fullmatch(_DEFINITE, words) and len(kinds) == 1 and kinds <= {MATRIX, DYADIC}:
        rows = tuple(Reading(((Test(_form(t), POSITIVE),),), w) for t, w in subject.terms)
        return Plain(f"{subject.text} is positive definite", rows, subject.scalars)
    return None


def _form(term: Term) -> Term:
    """Return the quadratic form of a matrix or dyadic with any vector."""
    if term.kind == DYADIC:
        return dot(_ANY, dot(term, _ANY))
    frame = next((n for n in term.data if isinstance(n, str)), "B")
    x = column(_ANY, frame)
    return inner(x, matmul(term, x))


_PARALLEL = rf"{_BE} (?:parallel to|along|aligned with|in the direction of|collinear with) (.+)"
_ACROSS = rf"{_BE} (?:perpendicular|orthogonal|normal) to (.+)"


def _related(subject: Subject, words: str, formulas: Formulas) -> Proposition | None:
    """Return that one vector is along another or across it."""
    for pattern, name, join in ((_PARALLEL, "along", cross), (_ACROSS, "across", dot)):
        match = re.fullmatch(pattern, words)
        other = _subject(match[1], formulas) if match else None
        if match is None or other is None:
            continue
        pairs = [(a, b) for a, _ in subject.terms for b, _ in other.terms]
        if any(t.kind != VECTOR for pair in pairs for t in pair):
            return None
        found = tuple(Reading(((Test(join(a, b)),),)) for a, b in pairs)
        scalars = {**subject.scalars, **other.scalars}
        return Plain(f"{subject.text} is {name} {other.text}", found, scalars)
    return None


# -- clauses --------------------------------------------------------------------------------------

_WHO = r"(?:(?:the |a |this )?(?:rigid )?(?:body|spacecraft|satellite|rotation|motion|it) )?"
_TURNS = (
    rf"{_WHO}(?:(?:is|be|only|to be) )*(?:rotating|rotates|rotate|rotation|spinning|spins|spin|turning|"
    r"turns|turn|is|occurs)"
)
_ONE = r"(?:only |just |exactly )?(?:(?:one|1|a single|a|any)(?: of the)?|(?:one|1) of its)"
_PRINCIPAL = r"principal (?:body |inertia )?ax[ie]s(?: of inertia)?"


def _about_principal(words: str) -> tuple[Reading, ...]:
    """Return "about a principal axis": along b1, b2 or b3, or omega x I omega = 0."""
    tests = [tuple(Test(_component(_W, k)) for k in pair) for pair in combinations((1, 2, 3), 2)]
    along = Reading(tuple(tests), "about b1, b2 or b3")
    return along, Reading(((Test(cross(_W, dot(_I, _W))),),), words)


def _steady_axis() -> Reading:
    return Reading(((Test(cross(_W, der(_W))),),), "about an axis that stays in the body")


@cache
def _clauses() -> tuple[tuple[re.Pattern[str], Proposition], ...]:
    """Return clauses that say it all."""
    principal = Plain("the body turns about one principal axis", _about_principal(""))
    any_axis = (*_about_principal("the axis is a principal one"), _steady_axis())
    one = Plain("the body turns about one axis", any_axis)
    still = equal("the body does not turn", _W)
    no_torque = Plain("no torque acts", tuple(Reading(((Test(t),),), w) for t, w in NOUNS[0][1]))
    pairs = list(combinations((1, 2, 3), 2))
    gaps = [_entry(a, a) - _entry(b, b) for a, b in pairs]
    axes = tuple(Test(_entry(a, b)) for a, b in pairs)
    symmetric = Plain(
        "two principal moments are equal", (Reading(tuple((*axes, Test(g)) for g in gaps)),)
    )
    sphere = equal("all principal moments are equal", *(t for t, _ in axes), *gaps)
    different = Plain(
        "the principal moments differ",
        (Reading(((*axes, *(Test(g, NOT_ZERO) for g in gaps)),)),),
    )
    moments = r"(?:the |its |all )?(?:three )?principal moments(?: of inertia)?"
    table: tuple[tuple[str, Proposition], ...] = (
        (r"(?:a|an|any|some) (?:external |net )?torque (?:acts|is applied)(?: on the body)?",
         Not(no_torque)),
        (rf"{_TURNS} about (?:only |just )?{_ONE} (?:of the )?{_PRINCIPAL}", principal),
        (rf"{_TURNS} about (?:only |just |exactly )?(?:one|1|a single) axis", one),
        (rf"{_TURNS} about more than (?:one|1|a single) ax[ie]s", Not(one)),
        (rf"{_TURNS} about more than (?:one|1|a single) {_PRINCIPAL}", Not(principal)),
        (rf"{_WHO}(?:does not (?:rotate|turn)|is not (?:rotating|turning))", still),
        ((r"(?:there is )?no (?:external |net |applied )*(?:torque|moment)s?(?: acts?| is applied)?"
          r"(?: on the body)?"), no_torque),
        (r"(?:in )?the absence of (?:an? |any |external |applied )*(?:torque|moment)s?", no_torque),
        (r"(?:the (?:body|motion) is )?torque[- ]free", no_torque),
        (rf"{_WHO}(?:is |be )?(?:(?:inertially |dynamically )?(?:axi)?symmetric(?:al)?)", symmetric),
        (rf"two (?:of the )?principal moments(?: of inertia)? {_BE} equal", symmetric),
        (rf"{_WHO}(?:is |be )(?:an? )?(?:spherical(?:ly symmetric)?(?: body)?|sphere)", sphere),
        (rf"{moments} {_BE} (?:all )?(?:equal|the same)", sphere),
        (rf"{moments} {_BE} (?:all )?(?:distinct|different)", different),
    )  # fmt: skip
    return tuple((re.compile(p), made) for p, made in table)


_OF_POINT: tuple[tuple[str, Callable[[str], tuple[tuple[Term, str], ...]]], ...] = (
    (
        rf"{_BE}(?: at)? (?:the |its )?(?:cent(?:re|er) of mass|mass cent(?:re|er)|c\.?m\.?)",
        lambda p: ((position("C", p), ""),),
    ),
    (
        rf"{_BE} (?:an? )?(?:inertially fixed|fixed in (?:inertial )?space|inertial)(?: point)?",
        lambda p: ((der(position(p, "OI")), ""),),
    ),
    (
        rf"{_BE} (?:unaccelerated|not accelerat(?:ed|ing))",
        lambda p: ((der(der(position(p, "OI"))), ""),),
    ),
    (
        rf"{_BE} fixed in (?:the body|it)",
        lambda p: ((der(position(p, "C"), "B"), ""),),
    ),
)
"""What is said of a reference point."""


def _of_point(words: str, formulas: Formulas) -> Proposition | None:
    match = re.match(rf"(?:the )?(?:(?:reference )?point )?{FORMULA} ", words)
    name = formulas.points.get(int(match[1])) if match else None
    if match is None or name is None:
        return None
    for pattern, terms in _OF_POINT:
        if re.fullmatch(pattern, words[match.end() :]):
            return equal(f"{name} {words[match.end() :]}", *(t for t, _ in terms(name)))
    return None


# -- reading --------------------------------------------------------------------------------------

_ARTICLE = r"(?:(?:the|its|any|a|an|this) )?"
_MAGNITUDE = re.compile(r"(?:the )?(?:magnitude|norm|length) of ")


def _subject(words: str, formulas: Formulas) -> Subject | None:
    """Return what a noun, a formula, or a noun with its formula stands for."""
    words = words.strip()
    size = _MAGNITUDE.match(words)
    if size:
        inside = _subject(words[size.end() :], formulas)
        vectors = inside is not None and all(t.kind == VECTOR for t, _ in inside.terms)
        if inside is None or not vectors:
            return None
        terms = tuple((dot(t, t), w) for t, w in inside.terms)
        return Subject(f"the magnitude of {inside.text}", terms, inside.scalars)
    nouns = "|".join(p for p, _ in NOUNS)
    named = re.fullmatch(rf"(?:{_ARTICLE}(?:{nouns}) )?{FORMULA}", words)
    if named:
        return formulas.subjects.get(int(named[1]))
    for pattern, terms in NOUNS:
        if re.fullmatch(_ARTICLE + pattern, words):
            return Subject(words, terms, {})
    return None


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
        if len(parts) > 1:
            found = _shared(parts, formulas)
            return None if found is None else join(found)
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
        begun = re.match(rf"(.*?) (?={_BE}\b|vanish|does not)", part)
        before = begun[1] if begun else before
    return tuple(found)


def _single(words: str, formulas: Formulas) -> Proposition | None:
    alone = re.fullmatch(
        rf"(?:{_ARTICLE}(?:{'|'.join(p for p, _ in NOUNS)}) )?(?:we have )?{FORMULA}(?: holds)?",
        words,
    )
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
    return _predicated(subject, words) or _related(subject, words, formulas)
