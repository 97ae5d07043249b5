r"""Lines that nothing else decides, by what follows from the other lines of the note.

Whatever letters mean, a line that follows from earlier ones holds where these do; one that would follow
but for a slip is wrong where the others confirm what it rests on, and unsure elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from eom.checker.consequence.customs import CUSTOMS
from eom.checker.consequence.known import FIRST_ORDER, RATE, Followed
from eom.checker.consequence.letters import Letters, letters_of
from eom.checker.consequence.lines import followed
from eom.checker.consequence.slips import Slip
from eom.checker.infer.sayings import prose
from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER, WRONG
from eom.checker.judge.notes import Understood
from eom.checker.mean.lexicon import Lexicon
from eom.checker.read.documents import Document
from eom.checker.report.findings import UNSURE, Finding

FOLLOWS = "it follows from {}, whatever the letters mean"
CALCULATED = "both sides are the same, whatever the letters mean"


def decided(
    document: Document, understood: Sequence[Understood], found: Sequence[Finding], lexicon: Lexicon
) -> Iterator[Finding]:
    """Yield findings, those on displays that were left open as their consequences decide them."""
    open_ = [
        k for k, f in enumerate(found) if f.kind == "display" and f.verdict in {UNDECIDED, UNSURE}
    ]
    verdicts = [f.verdict for f in found]
    if not open_:
        yield from found
        return
    text, words = prose(document), words_before(document, understood)
    told: dict[int, Finding] = {}
    for numbers in _ranges(understood):
        if not set(numbers) & set(open_) - told.keys():
            continue
        part = [understood[n] for n in numbers]
        letters = letters_of([u.formula for u in part], text, lexicon)
        wanted = [k for k, n in enumerate(numbers) if n in open_ and n not in told]
        known = followed(
            letters, part, [verdicts[n] for n in numbers], wanted, [words[n] for n in numbers]
        )
        there = [found[n] for n in numbers]
        for k, what in known.items():
            one = found[numbers[k]]
            if what.slip is None or what.sure or one.verdict != UNSURE:
                told[numbers[k]] = _told(one, what, k, there, letters)
    yield from (told.get(n, f) for n, f in enumerate(found))


def words_before(document: Document, understood: Sequence[Understood]) -> list[str]:
    """Return for each formula the words that stand before it, from the display before on."""
    words: dict[int, str] = {}
    last: list[str] = []
    for piece in document.pieces:
        if piece.is_formula:
            words[piece.span.start] = " ".join(last)
            last = last if piece.kind == "inline" else []
        else:
            last.append(piece.body)
    return [words.get(u.formula.piece.span.start, "") for u in understood]


def _ranges(understood: Sequence[Understood]) -> Iterator[list[int]]:
    """Yield the numbers of the formulas of each part of a note, then of the whole note.

    A letter may be something else in another part: what follows within one goes first.
    """
    parts: dict[tuple[str, ...], list[int]] = {}
    for n, u in enumerate(understood):
        parts.setdefault(u.headings, []).append(n)
    if len(parts) > 1:
        yield from parts.values()
    yield list(range(len(understood)))


def _told(
    finding: Finding, what: Followed, number: int, found: Sequence[Finding], letters: Letters
) -> Finding:
    """Return a finding with what follows."""
    rests, open_ = (
        _lines(found[n].line for n in ns - {number} if n >= 0) for ns in (what.sources, what.under)
    )
    customs = " and ".join(CUSTOMS[n] for n in sorted(what.sources) if n < 0)
    if what.slip is None:
        reason = _reason(what, rests)
        if what.held:
            held = ", ".join(sorted(f"${letters.latex(s)}$" for s in what.held))
            reason = f"if {held} do{'es' * (len(what.held) == 1)} not change, {reason}"
        if customs:
            reason = f"if {customs}: {reason}"
        if open_:
            reason = f"what stands in {open_} is true: {reason}"
        verdict = UNDER if what.under or what.held or what.how in {RATE, FIRST_ORDER} else HOLDS
        return replace(finding, verdict=verdict, reason=reason)
    said = _slip(what.slip, letters)
    rests += f", if {customs}" * bool(customs and rests)
    if what.sure:
        return replace(finding, verdict=WRONG, reason=f"{said}, by {rests}" if rests else said)
    return replace(
        finding, verdict=UNSURE, reason=f"if what stands in {rests} is true, then: {said}"
    )


def _reason(what: Followed, rests: str) -> str:
    if what.how == FIRST_ORDER:
        return f"it follows from {rests} for small motions"
    if what.how == RATE:
        return (
            f"its derivative by the time follows from {rests}; what it is at one time is as it says"
        )
    if what.how:
        return f"it is the {what.how} of what moves as {rests} say{'s' * (' and ' not in rests)}"
    return FOLLOWS.format(rests) if rests else CALCULATED


def _lines(numbers: Iterable[int]) -> str:
    different = sorted(set(numbers))
    if len(different) < 2:
        return "".join(f"line {n}" for n in different)
    return f"lines {', '.join(map(str, different[:-1]))} and {different[-1]}"


def _slip(slip: Slip, letters: Letters) -> str:
    """Say what is wrong with a part, and what it should be."""
    part, factor = slip.part, slip.factor
    if factor == -1:
        return f"the sign of ${letters.latex(part)}$ is wrong"
    return f"${letters.latex(part * factor)}$, not ${letters.latex(part)}$"
