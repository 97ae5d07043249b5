"""Which member of a chain is to blame: every link and the two ends judged apart.

In a = b = c where a = c holds and both links of b fail, b is wrong, not the result.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from eom.checker.judge.judge import WRONG, Judgement, judge
from eom.checker.mean.claims import DEFINITION, EQUALITIES, STATEMENT, Claim
from eom.checker.mean.values import ILL_FORMED
from eom.checker.read.places import Span


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
    for right where nothing tells: a slip that is carried on is one of all members behind it.
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
    whole = len(numbers) > 1 and sum(_between(claim, 0, numbers[-1], [s]) for s in lost) == len(
        lost
    )
    ends = _link(claim, numbers[0], numbers[-1], given) if whole else None
    blamed = {_place(claim, n) for n in _blamed(claim, numbers, broken, given)} | set(lost)
    return Chain(links, ends, tuple(sorted(blamed)))


def _place(claim: Claim, number: int) -> Span:
    """Return the place of a member; the first one of a continued chain stands where that begins."""
    if number == 0 and claim.previous is not None:
        return Span(claim.span.start, claim.span.start)
    return claim.members[number].span


def _between(claim: Claim, a: int, b: int, spans: Iterable[Span]) -> bool:
    """Tell whether a span lies between two members."""
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
