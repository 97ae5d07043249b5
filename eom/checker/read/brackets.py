"""Brackets of all sizes, bars, braces, matrices and other environments."""

from __future__ import annotations

from eom.checker.read import latex
from eom.checker.read.places import Span
from eom.checker.read.scripts import evaluated, is_tight, styled, word_of
from eom.checker.read.stream import Stream
from eom.checker.read.syntax import Cases, Fraction, Group, Matrix, Missing, Node, Rows
from eom.checker.read.tokens import Token

MAX_CELLS = 4000


def group(p: Stream) -> Node:
    """Read brackets that are not stretched; a half-open interval may end in another one."""
    token = p.take()
    opening = (
        latex.DELIMITERS.get(token.text, token.text) if token.kind == "command" else token.text
    )
    return _rest(p, token, opening)


def _rest(p: Stream, token: Token, opening: str) -> Node:
    with p.nested():
        if opening in {"|", "||"}:
            p.bars = [opening]
        if p.closes() and p.bars:
            raise p.error("nothing stands between these bars", token)
        body = p.statements() if not p.closes() else Missing(span=p.token.span)
        if p.token.is_command(*latex.SIZES):
            p.take()
        closing = _delimiter(p)
        wanted = {")", "]"} if opening in "([" else {latex.PAIRS[opening]}
        if closing not in wanted:
            shown = f"'{latex.PAIRS[opening]}' is missing here, opened in "
            raise p.error(shown + p.source.place(token.span))
        p.take()
    return Group(body, opening, closing, span=p.since(token.span))


def _delimiter(p: Stream) -> str:
    """Return the delimiter at the cursor, or ""."""
    token = p.token
    if token.kind == "command":
        return latex.DELIMITERS.get(token.text, "")
    return token.text if token.kind == "char" and token.text in "()[]|.<>/" else ""


def bars(p: Stream) -> Node:
    """Read what stands between two bars."""
    token = p.take()
    return _rest(p, token, "|" if token.is_char("|") or token.is_command("vert") else "||")


def sized(p: Stream) -> Node:
    r"""Read brackets behind ``\big`` and its kin."""
    p.take()
    token = p.token
    opening = _delimiter(p)
    if opening not in latex.PAIRS:
        raise p.error("an opening bracket is expected here")
    p.take()
    return _rest(p, token, opening)


def left(p: Stream) -> Node:
    r"""Read ``\left( ... \right)``; one side may be a point, which shows nothing."""
    start = p.take()
    opening = _delimiter(p)
    if not opening:
        raise p.error(r"a bracket is expected behind \left")
    p.take()
    with p.nested():
        body = p.statements() if not p.closes() else Missing(span=p.token.span)
        if not p.token.is_command("right"):
            what = rf"\right is missing here, for \left in {p.source.place(start.span)}"
            raise p.error(what) if p.token.kind == "stop" else p.unread()
        p.take()
        closing = _delimiter(p)
        if not closing:
            raise p.error(r"a bracket is expected behind \right")
        p.take()
    return _paired(p, body, opening, closing, start.span)


def _paired(p: Stream, body: Node, opening: str, closing: str, start: Span) -> Node:
    span = p.since(start)
    rows = _rows_of(body)
    if rows is not None and (opening, closing) in {("{", "."), (".", "}")}:
        return Cases(rows, "left" if opening == "{" else "right", span=span)
    if opening == "." and closing == "|":
        return evaluated(p, body, start)
    return Group(body, opening, closing, span=span)


def _rows_of(body: Node) -> tuple[tuple[Node, ...], ...] | None:
    """Return the rows of a table or alignment that a single brace holds together."""
    if isinstance(body, Matrix) and body.environment in {"array", "matrix"}:
        return body.rows
    return tuple((r,) for r in body.rows) if isinstance(body, Rows) else None


def braces(p: Stream) -> Node:
    r"""Read braces of LaTeX, which show nothing; a font switch and ``\over`` act within them."""
    token = p.take()
    style = ""
    with p.nested():
        p.integrals = 0
        while p.token.is_command(*latex.SWITCHES):
            style = latex.SWITCHES[p.take().text]
        if p.token.is_char("}"):
            p.take()
            if p.starts_atom():
                return p.scripted()
            raise p.error("something is missing behind empty braces", token)
        body = p.statements()
        if p.token.is_command("over"):
            p.take()
            if p.closes():
                raise p.error("an argument is empty")
            body = Fraction(body, p.statements(), span=p.since(token.span))
        p.expect("}", token)
    if style:
        body = word_of(body, style) or styled(body, style)
    if is_tight(body):
        return body
    return Group(body, "", "", span=p.since(token.span))


def environment(p: Stream) -> Node:
    """Read an environment: a matrix, cases, or an alignment within a formula."""
    token = p.take()
    name = token.text
    if name in latex.MATRICES:
        rows = _cells(p, token)
        return Matrix(rows, _plain(name), token.extra, span=p.since(token.span))
    if name in latex.CASES:
        return Cases(_cells(p, token), latex.CASES[name], span=p.since(token.span))
    if name not in latex.ALIGNMENTS:
        raise p.error(f"unknown environment {name!r}", token)
    with p.nested():
        found: list[Node] = []
        while p.token.kind not in {"end", "stop"}:
            if p.token.kind == "row":
                p.take()
            elif p.token.kind == "quad":
                p.place += 1
            else:
                found.append(p.statements())
                if p.token.kind not in {"row", "end", "stop"}:
                    raise p.unread()
        _end(p, token)
    return found[0] if len(found) == 1 else Rows(tuple(found), span=p.since(token.span))


def _plain(name: str) -> str:
    """Return the usual environment that looks the same."""
    name = name.replace("NiceMatrix", "matrix").replace("NiceArray", "matrix")
    return (
        {"tabular": "array"}.get(name, name.replace("small", ""))
        if name != "smallmatrix"
        else "matrix"
    )


def substack(p: Stream) -> Node:
    """Read lines over each other in a script."""
    start = p.take()
    opened = p.expect("{")
    with p.nested(script=True):
        found = [p.statements()] if p.token.kind != "row" else []
        while p.token.kind == "row":
            p.take()
            found.append(p.statements())
        if any(isinstance(f, Missing) for f in found) or not found:
            raise p.error("a line is empty")
        p.expect("}", opened)
    if len(found) == 1:
        return found[0]
    return Rows(tuple(found), span=p.since(start.span))


def _cells(p: Stream, token: Token) -> tuple[tuple[Node, ...], ...]:
    rows: list[tuple[Node, ...]] = []
    count = 0
    with p.nested():
        while p.token.kind not in {"end", "stop"}:
            row = [_cell(p)]
            while p.accept("&"):
                row.append(_cell(p))
            rows.append(tuple(row))
            count += len(row)
            if p.token.kind == "row":
                p.take()
            elif p.token.kind != "end" or count > MAX_CELLS:
                raise p.unread()
        _end(p, token)
    return tuple(rows)


def _cell(p: Stream) -> Node:
    while p.token.kind == "quad":
        p.place += 1
    return Missing(span=p.token.span) if p.closes() else p.statements()


def _end(p: Stream, token: Token) -> None:
    if p.token.kind != "end" or p.token.text != token.text:
        what = rf"\end{{{token.text}}} is missing here, for \begin in "
        raise p.error(what + p.source.place(token.span))
    p.take()
