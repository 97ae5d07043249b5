r"""Atoms of a formula: letters, fonts, accents, labels; a table gives what reads each command.

Brackets of all sizes, bars, braces, matrices and other environments.
"""

from __future__ import annotations

from collections.abc import Callable

from eom.checker.read import latex, prefixes
from eom.checker.read.scripts import (
    argument,
    braced,
    evaluated,
    font_switch,
    is_tight,
    script_argument,
    stacked,
    styled,
    with_font,
    with_left,
)
from eom.checker.read.spans import Span
from eom.checker.read.stream import Stream
from eom.checker.read.syntax import (
    Accent,
    Blank,
    Boxed,
    Braced,
    Cases,
    Differential,
    Dots,
    Fraction,
    Group,
    Marks,
    Matrix,
    Missing,
    Node,
    Number,
    Operation,
    Over,
    Root,
    Rows,
    Scripts,
    Section,
    Struck,
    Symbol,
    Words,
)
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
    with p.nested():
        p.integrals = 0
        style = font_switch(p)
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
    body = with_font(body, style)
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


Read = Callable[[Stream], Node]


def _leaf(made: Callable[[str, Span], Node]) -> Read:
    """Return what reads one token."""

    def read(p: Stream) -> Node:
        token = p.take()
        return made(token.text, token.span)

    return read


def _operation(p: Stream) -> Node:
    """Read an operator that has no left operand: a place holder, or what lacks an operand."""
    before = p.tokens[p.place - 1] if p.place else None
    token = p.token
    opened = before is None or (before.kind == "char" and before.text in "([{|,")
    opened = opened or (before is not None and before.is_command("lbrace", "{", "langle", "left"))
    if not opened:
        raise p.unread()
    name = latex.PRODUCT_COMMANDS[p.take().text]
    if p.closes() or p.token.is_char(","):
        if name == "dot":
            return Blank(span=token.span)
        return Operation(name, span=token.span)
    section = Section(p.run(), name, left=False, span=p.since(token.span))
    if not p.closes():
        raise p.unread()
    return section


def _font(p: Stream) -> Node:
    token = p.take()
    style = latex.FONTS[token.text]
    word = _word(p)
    if word and (len(word[0]) > 1 or style != ""):
        p.place = word[1]
        return Symbol(word[0], style, span=p.since(token.span))
    return styled(braced(argument(p)), style)


def _word(p: Stream) -> tuple[str, int] | None:
    """Return the letters and digits in braces that make one upright name, and the place behind."""
    place = p.place
    if not p.token.is_char("{"):
        single = p.token.kind in {"letter", "number"} and len(p.token.text) == 1
        return (p.token.text, place + 1) if single else None
    text = ""
    for token in p.tokens[place + 1 : place + 40]:
        if token.is_char("}"):
            return (text, place + len(text) + 2) if text and _one_each(p, place, text) else None
        if token.kind not in {"letter", "number"} or len(token.text) != 1:
            return None
        text += token.text
    return None


def _one_each(p: Stream, place: int, text: str) -> bool:
    return p.tokens[place + len(text) + 1].is_char("}")


def _accent(p: Stream) -> Node:
    token = p.take()
    if token.text == "accentset":
        above = argument(p)
        return stacked(above, argument(p), p.since(token.span))
    return Accent(latex.ACCENTS[token.text], argument(p), span=p.since(token.span))


def _root(p: Stream) -> Node:
    token = p.take()
    degree = None
    if p.token.is_char("["):
        with p.nested():
            opened = p.take()
            degree = p.statements()
            p.expect("]", opened)
    return Root(argument(p), degree, span=p.since(token.span))


def _boxed(p: Stream) -> Node:
    token = p.take()
    return Boxed(argument(p), span=p.since(token.span))


def _struck(p: Stream) -> Node:
    token = p.take()
    to = argument(p) if token.text == "cancelto" else None
    return Struck(argument(p), to, span=p.since(token.span))


def _brace(p: Stream) -> Node:
    token = p.take()
    body, label = argument(p), None
    if p.token.is_char("_") or p.token.is_char("^"):
        p.take()
        label = script_argument(p)
    return Braced(body, label, token.text, span=p.since(token.span))


def _stack(p: Stream) -> Node:
    token = p.take()
    first = script_argument(p)
    base = _base_or_operation(p)
    span = p.since(token.span)
    if token.text == "underset":
        if isinstance(first, Marks) and first.names == ("sim",):
            return Accent("undertilde", base, span=span)
        return Over(base, None, first, span=span)
    return stacked(first, base, span)


def _base_or_operation(p: Stream) -> Node:
    """Read the base of a stack, which may be an operator alone."""
    braced = p.token.is_char("{")
    token = p.ahead(1) if braced else p.token
    name = latex.PRODUCT_COMMANDS.get(token.text, "") if token.kind == "command" else ""
    if name and (not braced or p.ahead(2).is_char("}")):
        p.place += 3 if braced else 1
        return Operation(name, span=token.span)
    return argument(p)


def _prescript(p: Stream) -> Node:
    r"""Read ``\prescript{above}{below}{base}``."""
    token = p.take()
    above, below = script_argument(p), script_argument(p)
    base = braced(argument(p))
    given = [None if isinstance(s, Missing) else s for s in (below, above)]
    return with_left(base, given[0], given[1], p.since(token.span))


def _sided(p: Stream) -> Node:
    r"""Read ``\leftidx{^a_b}{base}{^c_d}``, ``\sideset{^a_b}{^c_d}{base}``."""
    token = p.take()
    left = _scripts_in_braces(p)
    if token.text == "sideset":
        right = _scripts_in_braces(p)
        base = braced(argument(p))
    else:
        base = braced(argument(p))
        right = _scripts_in_braces(p)
    span = p.since(token.span)
    if right:
        base = Scripts(base, right.get("_"), right.get("^"), span=span)
    return with_left(base, left.get("_"), left.get("^"), span)


def _scripts_in_braces(p: Stream) -> dict[str, Node]:
    found: dict[str, Node] = {}
    opened = p.expect("{")
    while p.token.kind == "char" and p.token.text in "^_":
        sign = p.take().text
        found[sign] = script_argument(p)
    p.expect("}", opened)
    return found


def _norm(p: Stream) -> Node:
    token = p.take()
    bar = "|" if token.text == "abs" else "||"
    return Group(argument(p), bar, bar, span=p.since(token.span))


def _quantity(p: Stream) -> Node:
    r"""Read ``\qty(...)``: the brackets are what shows."""
    p.take()
    return atom(p)


def _differential(p: Stream) -> Node:
    token = p.take()
    return Differential(braced(argument(p)), span=p.since(token.span))


_KINDS: dict[str, Read] = {
    "letter": _leaf(lambda text, span: Symbol(text, span=span)),
    "number": _leaf(lambda text, span: Number(text, span=span)),
    "words": _leaf(lambda text, span: Words(text, span=span)),
    "operator": _leaf(lambda text, span: Symbol(text, "roman", span=span)),
    "begin": environment,
}


_CHARACTERS: dict[str, Read] = {
    "(": group,
    "[": group,
    "{": braces,
    "|": bars,
}


_symbol = _leaf(lambda text, span: Symbol(latex.SYMBOL_ALIASES.get(text, text), span=span))

COMMANDS: dict[str, Read] = {
    **dict.fromkeys([*latex.SYMBOLS, *latex.SYMBOL_ALIASES, "partial"], _symbol),
    **dict.fromkeys(latex.FONTS, _font),
    **dict.fromkeys(latex.ACCENTS, _accent),
    **dict.fromkeys(latex.DOTS, _leaf(lambda text, span: Dots(latex.DOTS[text], span=span))),
    **dict.fromkeys(latex.FRACTIONS, prefixes.fraction),
    **dict.fromkeys(["dv", "pdv", "derivative", "odv"], prefixes.physics_derivative),
    **dict.fromkeys(["{", "lbrace", "langle", "lbrack", "lfloor", "lceil", "lparen"], group),
    **dict.fromkeys(["|", "vert", "Vert"], bars),
    **dict.fromkeys(["lvert", "lVert"], group),
    **dict.fromkeys(latex.SIZES, sized),
    **dict.fromkeys(["cancel", "bcancel", "xcancel", "cancelto", "sout"], _struck),
    **dict.fromkeys(["underbrace", "overbrace"], _brace),
    **dict.fromkeys(["overset", "stackrel", "underset"], _stack),
    **dict.fromkeys(["leftidx", "sideset"], _sided),
    **dict.fromkeys(["abs", "norm"], _norm),
    **dict.fromkeys(["va", "vu"], _accent),
    "qty": _quantity,
    "left": left,
    "sqrt": _root,
    "boxed": _boxed,
    "prescript": _prescript,
    "dd": _differential,
    "substack": substack,
}


def starts_atom(p: Stream) -> bool:
    """Whether the token at the cursor can begin a factor."""
    token = p.token
    if token.kind in {"letter", "number", "operator", "begin"}:
        return True
    if token.kind == "char":
        return token.text in "([{|"
    return token.kind == "command" and (token.text in COMMANDS or token.text in prefixes.COMMANDS)


def atom(p: Stream) -> Node:
    """Read an atom. Raises `ReadingError` where none stands."""
    token = p.token
    if token.kind in _KINDS:
        return _KINDS[token.kind](p)
    if token.kind == "char" and token.text in _CHARACTERS:
        return _CHARACTERS[token.text](p)
    if token.kind == "command" and token.text in COMMANDS:
        return COMMANDS[token.text](p)
    if token.kind == "command" and token.text in latex.PRODUCT_COMMANDS:
        return _operation(p)
    raise p.unread()
