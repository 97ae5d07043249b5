"""A repair put into the text of the note: what is replaced by what, in the writer's own LaTeX."""

from __future__ import annotations

import re
from collections.abc import Iterator

from eom.checker.judge.notes import Understood
from eom.checker.read.grammar import read_tokens
from eom.checker.read.paths import NOTHING, Path, at, common
from eom.checker.read.places import NOWHERE, ReadingError, Source, Span
from eom.checker.read.syntax import Addition, Missing, Node
from eom.checker.read.tokens import tokenize
from eom.checker.read.writing import latex
from eom.checker.repair.candidates import Candidate
from eom.checker.repair.lines import Line
from eom.checker.repair.options import Option
from eom.checker.repair.slips import LOST

Change = tuple[Span, str]


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


def _changes(line: Line, option: Option, source: str) -> Iterator[Change]:
    """Yield what an option changes, place by place."""
    member = next(m for m in line.members if m.number == option.addend.member)
    base: Path = (*(member.path or ()), *option.addend.path)
    if option.slip is LOST and option.node is option.new:
        here = at(line.tree, base)
        sign = "-" if option.sign < 0 else "+"
        yield Span(here.span.stop, here.span.stop), f" {sign} {tight(option.new)}"
        return
    if option.node is NOTHING:
        yield from _dropped(line, base)
        return
    if option.sign != option.addend.sign:
        yield from _flipped(line, option, base, source)
        return
    for path in option.paths:
        old = at(line.tree, (*base, *path))
        text = "" if isinstance(option.new, Missing) else _like(old, option.new)
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


def _dropped(line: Line, path: Path) -> Iterator[Change]:
    parent = at(line.tree, path[:-1])
    if isinstance(parent, Addition) and path:
        k = path[-1][1][0]
        term = parent.terms[k]
        start = parent.terms[k - 1].span.stop if k else parent.span.start
        yield Span(start, term.span.stop), ""


def _flipped(line: Line, option: Option, path: Path, source: str) -> Iterator[Change]:
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
        paths = option.paths if option.paths != ((),) else ((),)
        spans = [at(line.tree, (*base, *p)).span for p in paths]
        found += [s for s in spans if s != NOWHERE]
    return tuple(sorted(set(found)))
