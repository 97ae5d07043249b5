"""Claims that an equation shows of what kind a quantity is: "(5) shows that E is a rotation matrix".

It does not where the equation holds as well with twice the quantity in its place, as twice a rotation
matrix is none; nothing else is decided here.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from eom.checker.judge.judge import HOLDS, UNDER, WRONG, judge
from eom.checker.judge.notes import Understood
from eom.checker.mean.claims import Claim
from eom.checker.prose_claims.proposition_words import Subject
from eom.checker.prose_claims.quantified import Decision
from eom.terms.terms import MATRIX, VECTOR, Term, mul, number
from eom.terms.terms import replace as rewritten

KINDS: tuple[tuple[str, str, str], ...] = (
    ((r"(?:an? )?(?:proper )?rotation(?: matrix)?|(?:an? )?direction cosine matrix|"
     r"(?:an? )?(?:proper )?(?:orthogonal|orthonormal)(?: matrix)?"), MATRIX, "rotation matrix"),
    (r"(?:an? )?unit vector|normali[sz]ed|of unit (?:length|magnitude|norm)", VECTOR, "unit vector"),
)  # fmt: skip
"""Properties that twice a quantity does not have, its kind, and the property in a word."""

FREE = frozenset({"eigenvectors", "vector"})
"""Quantities that have no such property by what they mean."""

_SHOWS = re.compile(
    r"\x02(?P<number>\d+)\x03 (?:shows|proves|demonstrates|implies|means)(?: that)? "
    r"(?:the (?:matrix|vector) )?\x02(?P<subject>\d+)\x03 (?:is|must be|has to be) (?P<kind>.+)"
)
_INSERTED = re.compile(r",? (?:in fact|indeed|therefore|thus|itself|necessarily|actually)\b,?")
HINTS = re.compile(
    r"normali[sz]|orthonormal|unit (?:vector|length|norm)|right[- ]handed|orthogonal"
)
"""Words that may say elsewhere what the equation does not show."""


def numbers_in(text: str) -> tuple[int, int] | None:
    """Return the numbers of the display and the quantity that a sentence of this kind is about."""
    match = _SHOWS.fullmatch(_INSERTED.sub("", text))
    return (int(match["number"]), int(match["subject"])) if match else None


def shown(
    text: str, one: Understood, subjects: Mapping[int, Subject], given: tuple[str, ...]
) -> Decision | None:
    """Return that an equation does not show what is said, None where nothing is known."""
    match = _SHOWS.fullmatch(_INSERTED.sub("", text))
    subject = subjects.get(int(match["subject"])) if match else None
    if match is None or subject is None:
        return None
    term = subject.terms[0][0]
    kind = next((k for k in KINDS if term.kind == k[1] and re.fullmatch(k[0], match["kind"])), None)
    free = term.head == "atom" and term.data[0] in FREE
    if kind is None or not free or not one.claims or not _unmoved(one, term, given):
        return None
    name, line = subject.text, one.formula.piece.line
    reason = f"line {line} holds with 2 {name} in place of {name} as well, which is no {kind[2]}"
    return Decision(WRONG, (), reason)


def _unmoved(one: Understood, term: Term, given: tuple[str, ...]) -> bool:
    """Tell whether all claims that have a term hold, and hold no less with twice the term."""
    claims = [c for c in one.claims if _twice(c, term) != c]
    if not claims or any(c.findings or c.model is not None for c in claims):
        return False
    for claim in claims:
        before, behind = judge(claim, given), judge(_twice(claim, term), given)
        good = {before.verdict, behind.verdict} <= {HOLDS, UNDER}
        if not good or not set(before.sets) <= set(behind.sets or before.sets):
            return False
    return True


def _twice(claim: Claim, term: Term) -> Claim:
    def rule(node: Term) -> Term:
        return mul(number(2), node) if node == term else node

    members = tuple(replace(m, term=rewritten(m.term, rule)) for m in claim.members)
    return replace(claim, members=members)
