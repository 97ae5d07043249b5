r"""Atoms of a formula: letters, fonts, accents, labels; a table gives what reads each command."""

from __future__ import annotations

from collections.abc import Callable

from eom.checker.read import brackets, derivatives, latex, prefixes
from eom.checker.read.scripts import argument, braced, script_argument, stacked, styled, with_left
from eom.checker.read.stream import Stream
from eom.checker.read.syntax import (
    Accent,
    Blank,
    Boxed,
    Braced,
    Differential,
    Dots,
    Group,
    Marks,
    Missing,
    Node,
    Number,
    Operation,
    Over,
    Root,
    Scripts,
    Section,
    Struck,
    Symbol,
    Words,
)


def _letter(p: Stream) -> Node:
    token = p.take()
    return Symbol(token.text, span=token.span)


def _number(p: Stream) -> Node:
    token = p.take()
    return Number(token.text, span=token.span)


def _words(p: Stream) -> Node:
    token = p.take()
    return Words(token.text, span=token.span)


def _operator(p: Stream) -> Node:
    token = p.take()
    return Symbol(token.text, "roman", span=token.span)


def _symbol(p: Stream) -> Node:
    token = p.take()
    return Symbol(latex.SYMBOL_ALIASES.get(token.text, token.text), span=token.span)


def _dots(p: Stream) -> Node:
    token = p.take()
    return Dots(latex.DOTS[token.text], span=token.span)


def _partial(p: Stream) -> Node:
    token = p.take()
    return Symbol("partial", span=token.span)


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


Read = Callable[[Stream], Node]


_KINDS: dict[str, Read] = {
    "letter": _letter,
    "number": _number,
    "words": _words,
    "operator": _operator,
    "begin": brackets.environment,
}


_CHARACTERS: dict[str, Read] = {
    "(": brackets.group,
    "[": brackets.group,
    "{": brackets.braces,
    "|": brackets.bars,
}


COMMANDS: dict[str, Read] = {
    **dict.fromkeys([*latex.SYMBOLS, *latex.SYMBOL_ALIASES], _symbol),
    **dict.fromkeys(latex.FONTS, _font),
    **dict.fromkeys(latex.ACCENTS, _accent),
    **dict.fromkeys(latex.DOTS, _dots),
    **dict.fromkeys(latex.FRACTIONS, derivatives.fraction),
    **dict.fromkeys(["dv", "pdv", "derivative", "odv"], derivatives.physics_derivative),
    **dict.fromkeys(
        ["{", "lbrace", "langle", "lbrack", "lfloor", "lceil", "lparen"], brackets.group
    ),
    **dict.fromkeys(["|", "vert", "Vert"], brackets.bars),
    **dict.fromkeys(["lvert", "lVert"], brackets.group),
    **dict.fromkeys(latex.SIZES, brackets.sized),
    **dict.fromkeys(["cancel", "bcancel", "xcancel", "cancelto", "sout"], _struck),
    **dict.fromkeys(["underbrace", "overbrace"], _brace),
    **dict.fromkeys(["overset", "stackrel", "underset"], _stack),
    **dict.fromkeys(["leftidx", "sideset"], _sided),
    **dict.fromkeys(["abs", "norm"], _norm),
    **dict.fromkeys(["va", "vu"], _accent),
    "qty": _quantity,
    "left": brackets.left,
    "sqrt": _root,
    "boxed": _boxed,
    "prescript": _prescript,
    "partial": _partial,
    "dd": _differential,
    "substack": brackets.substack,
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
