"""Why a line is wrong: what is left over, what would make it right, where it fails, which convention.

Lines that are right in another convention: what symbols of attitude mean is exchanged all over.

Three questions of convention are no errors: whether a rotation matrix turns frames or vectors, whether
a sequence is one about moving or fixed axes, whether the scalar of a quaternion stands first or last.

Words for a slip that was undone: which, where in a chain or table, what stands there, what was meant.

A repair put into the text of the note: what is replaced by what, in the writer's own LaTeX.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

from eom.checker.judge.inequalities import ORDERS
from eom.checker.judge.judge import HOLDS, UNDER, judge
from eom.checker.judge.models import Drawn
from eom.checker.judge.notes import Understood, reread
from eom.checker.judge.verdicts import GRAVE, Judged
from eom.checker.mean.lexicon import Lexicon, Meaning
from eom.checker.read.grammar import read_tokens
from eom.checker.read.paths import NOTHING, Path, at, common
from eom.checker.read.spans import NOWHERE, ReadingError, Source, Span
from eom.checker.read.syntax import Addition, Matrix, Missing, Node
from eom.checker.read.tokens import tokenize
from eom.checker.read.writing import latex
from eom.checker.repair.candidates import Candidate, Workshop, leftover
from eom.checker.repair.corrections import Verified, corrections, workshop
from eom.checker.repair.counterexample import counterexample
from eom.checker.repair.lines import Line, line, penalty
from eom.checker.repair.orders import between_scalars, unordered
from eom.checker.repair.reasons import sentence
from eom.checker.repair.slips import Change, Option
from eom.checker.report.findings import UNEXPLAINED, Correction, Counterexample, Explanation


def explain(
    understood: Understood, judged: Judged, given: Iterable[str] = (), stated: Iterable[str] = ()
) -> Explanation:
    """Return why a claim of a formula is wrong or ill-formed; nothing is said of other claims.

    ``given``: assumed without being said; ``stated``: what the note has assumed so far, which makes
    repairs that need it more plausible.
    """
    if judged.verdict not in GRAVE:
        return UNEXPLAINED
    given, stated = tuple(given), tuple(stated)
    places = judged.chain.blamed if judged.chain is not None else ()
    scalars = between_scalars(understood, judged.claim)
    compared = scalars or unordered(understood, judged.claim, given)
    if compared is not None:
        first = next((c.change for c in compared.corrections), "")
        return replace(compared, reason=first or _left(compared.residual))
    numbers = [f.instead for f in judged.claim.findings if f.instead is not None]
    if numbers:
        right = tuple(_exchanged(understood, numbers))
        return Explanation(blamed=tuple(span for span, _ in numbers), corrections=right)
    wrong = line(understood, judged.claim)
    if wrong is None:
        return Explanation(blamed=places or tuple(f.span for f in judged.claim.findings))
    shop = workshop(understood, wrong, given)
    found = corrections(understood, shop, given, stated)
    ranked = found[0].ranked if found else None
    candidate = ranked.candidate if ranked is not None else None
    model = ranked.model if ranked is not None else next((p for _, p in shop.levels), None)
    residual = leftover(shop, candidate, model) if model is not None else ""
    return Explanation(
        residual=residual,
        blamed=blamed(wrong, candidate) if candidate is not None else places,
        corrections=tuple(_correction(understood, wrong, v) for v in found),
        counterexample=_fails(shop, candidate, model, given) if model is not None else None,
        convention=other_convention(understood, wrong.number, given),
        reason=_left(residual) if candidate is None else sentence(wrong, candidate),
    )


def _exchanged(understood: Understood, numbers: Iterable[tuple[Span, str]]) -> Iterator[Correction]:
    """Yield the line with a wrong number exchanged for the right one, if none is wrong then."""
    piece = understood.formula.piece
    for span, new in numbers:
        start, stop = span.start - piece.span.start, span.stop - piece.span.start
        text = piece.body[:start] + new + piece.body[stop:]
        tree = _reads(understood, text)
        left = [] if tree is None else [f for c in reread(understood, tree) for f in c.findings]
        if tree is not None and not any(f.instead for f in left):
            change = f"the number: ${piece.body[start:stop]}$ should be ${new}$"
            yield Correction(text.strip(), change, "number", span, new)


def _left(residual: str) -> str:
    """Return what is left over of a line that no repair was found for, in words."""
    short = 0 < len(residual) <= LONG
    return f"the left side less the right side is ${residual}$, not zero" if short else ""


def corrected(
    understood: Understood, judged: Judged, given: Iterable[str] = (), stated: Iterable[str] = ()
) -> tuple[Correction, ...]:
    """Return the repairs of a claim alone, without what else `explain` says."""
    given, stated = tuple(given), tuple(stated)
    claim = judged.claim
    apart = claim.parameters is not None or bool(ORDERS & set(claim.relations))
    wrong = None if apart or judged.verdict not in GRAVE else line(understood, claim)
    if wrong is None:
        return explain(understood, judged, given, stated).corrections
    found = corrections(understood, workshop(understood, wrong, given), given, stated)
    return tuple(_correction(understood, wrong, v) for v in found)


def _fails(
    shop: Workshop, candidate: Candidate | None, model: Drawn, given: tuple[str, ...]
) -> Counterexample | None:
    """Return small numbers for which a line fails, with what they assume beyond what is given."""
    found = counterexample(shop, candidate, model)
    if found is None:
        return None
    beyond = (n for n in found.assumptions if n not in given)
    return replace(found, assumptions=shop.line.models().rests_on(beyond))


def _correction(understood: Understood, wrong: Line, found: Verified) -> Correction:
    ranked = found.ranked
    text, span, new = rewritten(understood, wrong, ranked.candidate, ranked.tree)
    options = ranked.candidate.options
    change = "; ".join(dict.fromkeys(words(wrong, o) for o in options))
    slips = ", ".join(dict.fromkeys(c.slip.name for o in options for c in o.changes))
    return Correction(text, change, slips, span, new, found.judgement.sets)


LONG = 160
"""Characters of what is left over that a sentence contains at most."""
PLAUSIBLE = 1.5
"""Most that the assumptions may weigh under which a line holds in another convention."""


@dataclass(frozen=True)
class Convention:
    """Words for the other side of a convention, and what a meaning becomes there."""

    words: str
    change: Callable[[Meaning], Meaning]


def _transposed(meaning: Meaning) -> Meaning:
    """Exchange the frames of a rotation, and turns of frames and of vectors."""
    if meaning.quantity == "rotation":
        return replace(meaning, labels=meaning.labels[::-1])
    return replace(meaning, quantity=_TURNS.get(meaning.quantity, meaning.quantity))


_TURNS = {"turn": "active_turn", "active_turn": "turn"}


def _order(meaning: Meaning) -> Meaning:
    """Exchange turns about moving and fixed axes."""
    if meaning.quantity != "turn_angle":
        return meaning
    place, axes, *frames = meaning.labels
    fixed = axes.startswith("space")
    other = axes.removeprefix("space") if fixed else "space" + axes.removeprefix("body")
    return replace(meaning, labels=(place, other, *frames))


_SCALARS = {"quaternion": "quaternion_last", "quaternion_last": "quaternion"}


def _scalar(meaning: Meaning) -> Meaning:
    """Exchange columns of Euler parameters with the scalar first and last."""
    return replace(meaning, quantity=_SCALARS.get(meaning.quantity, meaning.quantity))


CONVENTIONS: tuple[Convention, ...] = (
    Convention("all rotation matrices transposed (active and passive exchanged)", _transposed),
    Convention("turns about fixed and moving axes exchanged", _order),
    Convention("the scalar of quaternions at the other end", _scalar),
)
"""Every convention, with what it changes."""


def changed(lexicon: Lexicon, convention: Convention) -> Lexicon:
    """Return a lexicon whose meanings are those of the other convention."""
    layers = tuple(
        tuple(replace(entry, meaning=convention.change(entry.meaning)) for entry in layer)
        for layer in lexicon.layers
    )
    return lexicon if layers == lexicon.layers else replace(lexicon, layers=layers)


def other_convention(understood: Understood, number: int, given: Iterable[str] = ()) -> str:
    """Return in which other conventions a wrong claim of a formula is right, "" for none.

    ``number``: of the claim. What the note itself has defined stays as it was defined. A line without
    rates is often right by each of two conventions; both are given.
    """
    given = tuple(given)
    right = [c.words for c in CONVENTIONS if _right(understood, number, c, given)]
    return f"right in the other convention: {', or: '.join(right)}" if right else ""


def _right(
    understood: Understood, number: int, convention: Convention, given: tuple[str, ...]
) -> bool:
    """Return whether a claim is right in another convention that changes what it says."""
    reading = understood.formula.reading
    lexicon = changed(understood.lexicon, convention)
    if reading is None or lexicon is understood.lexicon:
        return False
    claims = reread(replace(understood, lexicon=lexicon), reading.tree)
    claim = claims[number] if number < len(claims) else None
    before = understood.claims[number]
    if claim is None or claim.verdict or claim.kind != before.kind:
        return False
    same = claim.members == before.members and claim.scalars == before.scalars
    if same and not before.verdict:
        return False
    found = judge(claim, given)
    least = min((penalty(s, frozenset(given)) for s in found.sets), default=0.0)
    return found.verdict == HOLDS or (found.verdict == UNDER and least <= PLAUSIBLE)


SIDES = 2
"""Members of an equation; those of a longer chain are counted."""


def words(line: Line, option: Option) -> str:
    """Say what was undone."""
    return "; ".join(
        f"{c.slip.words}{_member(line, option)}{_said(option, c)}" for c in option.changes
    )


def _said(option: Option, change: Change) -> str:
    """Say where a term was changed, what stands there and what was meant."""
    place = _cell(option.addend.node, change.paths[0])
    if change.added:
        return f": ${change.added}${place}"
    if option.appended:
        return f": ${'-' if option.sign < 0 else '+'} {tight(change.new)}$"
    if isinstance(change.new, Missing):
        return f"{place}: ${latex(option.addend.node)}$"
    if option.sign != option.addend.sign:
        return f"{place}: before ${latex(option.addend.node)}$"
    return f"{place}: ${latex(change.old)}$ should be ${latex(change.new)}$"


def _member(line: Line, option: Option) -> str:
    """Name the member of a chain, as it is counted in the line."""
    written = [m.number for m in line.members if m.path is not None]
    place = written.index(option.addend.member) + 1
    return f" in member {place}" if len(written) > SIDES else ""


def _cell(root: Node, path: Path) -> str:
    """Name the row of the innermost table around a place, and the column where there are several."""
    for k in range(len(path) - 1, -1, -1):
        name, numbers = path[k]
        table = at(root, path[:k])
        if isinstance(table, Matrix) and name == "rows" and len(numbers) == SIDES:
            row, column = numbers
            wide = len(table.rows[0]) > 1
            return f" in row {row + 1}" + (f", column {column + 1}" if wide else "")
    return ""


Placed = tuple[Span, str]


def rewritten(
    understood: Understood, line: Line, candidate: Candidate, tree: Node
) -> tuple[str, Span, str]:
    """Return the whole line, the place of the note that changes, and what stands there then.

    The writer's own LaTeX stays where nothing changes, if it reads as the repaired tree; else the line
    is written anew.
    """
    piece = understood.formula.piece
    body, offset = piece.body, piece.span.start
    changes = sorted(c for o in candidate.options for c in _changes(line, o, piece.source.text))
    inside = [c for c in changes if offset <= c[0].start and c[0].stop <= offset + len(body)]
    if inside and len(inside) == len(changes) and piece.source.text[offset:][: len(body)] == body:
        text = body
        for span, new in reversed(inside):
            text = text[: span.start - offset] + new + text[span.stop - offset :]
        if understood.repairs or _reads(understood, text) == tree:
            span = Span(inside[0][0].start, max(c[0].stop for c in inside))
            end = len(text) - (len(body) - (span.stop - offset))
            return text.strip(), span, text[span.start - offset : end]
    whole = at(line.tree, common([m.path for m in line.members if m.path is not None]))
    return (
        latex(tree),
        whole.span,
        latex(at(tree, common([m.path for m in line.members if m.path]))),
    )


def _reads(understood: Understood, text: str) -> Node | None:
    """Return the tree of a text in the place of the formula."""
    source = Source(text)
    try:
        return read_tokens(source, tokenize(source, text, 0, understood.formula.piece.macros)).tree
    except ReadingError:
        return None


def _changes(line: Line, option: Option, source: str) -> Iterator[Placed]:
    """Yield what an option changes, place by place."""
    member = next(m for m in line.members if m.number == option.addend.member)
    base: Path = (*(member.path or ()), *option.addend.path)
    if option.appended:
        here = at(line.tree, base)
        sign = "-" if option.sign < 0 else "+"
        yield Span(here.span.stop, here.span.stop), f" {sign} {tight(option.node)}"
        return
    if option.node is NOTHING:
        yield from _dropped(line, base)
        return
    if option.sign != option.addend.sign:
        yield from _flipped(line, option, base, source)
        return
    for change in option.changes:
        for path in change.paths:
            old = at(line.tree, (*base, *path))
            text = "" if isinstance(change.new, Missing) else _like(old, change.new)
            yield _with_font(old.span, source), text


_FONT = re.compile(r"\\(?:boldsymbol|math[a-z]+|bm|mathbf|boldmath)\s*(\{?)\s*\Z")


def _with_font(span: Span, source: str) -> Span:
    """Return a place with the command for the font of a letter around it."""
    before = _FONT.search(source[max(0, span.start - 20) : span.start])
    if before is None:
        return span
    start = span.start - (len(before[0]))
    if not before[1]:
        return Span(start, span.stop)
    end = span.stop + len(source[span.stop :]) - len(source[span.stop :].lstrip())
    return Span(start, end + 1) if source[end : end + 1] == "}" else span


def tight(node: Node) -> str:
    """Return the LaTeX of a term behind a sign."""
    text = latex(node)
    return rf"\left( {text} \right)" if isinstance(node, Addition) else text


_COMMAND = re.compile(r"\\[A-Za-z]+\Z")


def _like(old: Node, new: Node) -> str:
    """Write a node for the place of another one; a letter behind a command needs a blank."""
    text = latex(new)
    return f"{text} " if old != new and _COMMAND.search(text) else text


def _dropped(line: Line, path: Path) -> Iterator[Placed]:
    parent = at(line.tree, path[:-1])
    if isinstance(parent, Addition) and path:
        k = path[-1][1][0]
        term = parent.terms[k]
        start = parent.terms[k - 1].span.stop if k else parent.span.start
        yield Span(start, term.span.stop), ""


def _flipped(line: Line, option: Option, path: Path, source: str) -> Iterator[Placed]:
    """Yield the change of the sign before a term."""
    term = at(line.tree, path)
    if not option.addend.summed:
        yield Span(term.span.start, term.span.start), "-"
        return
    parent = at(line.tree, path[:-1])
    assert isinstance(parent, Addition)
    k = path[-1][1][0]
    start = parent.terms[k - 1].span.stop if k else parent.span.start
    gap = source[start : term.span.start]
    wanted = "-" if option.sign < 0 else "+" if k else ""
    found = next((i for i, c in enumerate(gap) if c in "+-"), None)
    if found is None:
        yield Span(term.span.start, term.span.start), wanted
    else:
        yield Span(start + found, start + found + 1), wanted


def blamed(line: Line, candidate: Candidate) -> tuple[Span, ...]:
    """Return the places at fault: of what a repair changes."""
    found = []
    for option in candidate.options:
        member = next(m for m in line.members if m.number == option.addend.member)
        base: Path = (*(member.path or ()), *option.addend.path)
        spans = [at(line.tree, (*base, *p)).span for c in option.changes for p in c.paths]
        found += [s for s in spans if s != NOWHERE]
    return tuple(sorted(set(found)))
