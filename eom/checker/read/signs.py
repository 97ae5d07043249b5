r"""Relations and arrows at the cursor, single or made of several characters, with what is above.

What stands at the cursor: operators and factors, in braces of LaTeX or without.
"""

from __future__ import annotations

from collections.abc import Callable

from eom.checker.read import latex
from eom.checker.read.derivatives import differential_ahead
from eom.checker.read.stream import Stream
from eom.checker.read.syntax import Node, Sign
from eom.checker.read.tokens import Token

_DIGRAPHS: dict[str, str] = {
    "<=>": "equivalent",
    "==>": "implies",
    ":=": ":=",
    "=:": "=:",
    "=>": "implies",
    "->": "to",
    "<=": "<=",
    ">=": ">=",
    "!=": "!=",
    "==": "=",
    "<-": "from",
}
"""Relations and arrows of several characters; the longest comes first."""
_ARROWS = frozenset(latex.ARROW_COMMANDS.values())
STACKED = frozenset({"overset", "stackrel", "underset", "stackbin"})
_DEFINING = frozenset({"def", "Delta", "triangle", "text def", "definition", "d e f"})


def relation_ahead(p: Stream) -> bool:
    """Whether a relation stands at the cursor."""
    name, _ = _sign_ahead(p)
    return bool(name) and name not in _ARROWS


def arrow_ahead(p: Stream) -> bool:
    """Whether an arrow between statements stands at the cursor."""
    name, _ = _sign_ahead(p)
    return name in _ARROWS


def take_sign(p: Stream, script: Callable[[], Node]) -> Sign:
    """Read the relation or arrow at the cursor; ``script`` reads what stands above it."""
    start = p.token.span
    if p.token.is_command(*STACKED):
        return _stacked(p, script)
    if p.token.is_command("xrightarrow", "xRightarrow"):
        name = "to" if p.token.text == "xrightarrow" else "implies"
        p.take()
        return Sign(name, script(), span=p.since(start))
    name, count = _sign_ahead(p)
    for _ in range(count):
        p.take()
    return Sign(name, span=p.since(start))


def _sign_ahead(p: Stream) -> tuple[str, int]:
    """Return the name of the sign at the cursor and its number of tokens, or ("", 0)."""
    token = p.token
    if token.kind == "command":
        return _command(p, token)
    if token.kind != "char" or token.text not in ":=<>-!":
        return "", 0
    text = token.text
    while len(text) < 3 and _adjacent(p, len(text)):
        text += p.ahead(len(text)).text
    for length in (3, 2):
        if len(text) >= length and text[:length] in _DIGRAPHS:
            return _DIGRAPHS[text[:length]], length
    return latex.RELATION_CHARACTERS.get(token.text, ""), 1


def _adjacent(p: Stream, count: int) -> bool:
    token = p.ahead(count)
    return token.kind == "char" and not token.spaced and token.text in "=<>:-"


def _command(p: Stream, token: Token) -> tuple[str, int]:
    if token.text in latex.RELATION_COMMANDS:
        name = latex.RELATION_COMMANDS[token.text]
        if token.text == "vcentcolon" and not p.ahead().is_char("="):
            return "", 0
        return name, 2 if token.text == "vcentcolon" else 1
    if token.text in latex.ARROW_COMMANDS:
        return latex.ARROW_COMMANDS[token.text], 1
    if token.text == "not" and p.ahead().is_char("="):
        return "!=", 2
    if token.text == "not" and p.ahead().is_command("in"):
        return "notin", 2
    if token.text in {"xrightarrow", "xRightarrow"}:
        return ("to" if token.text == "xrightarrow" else "implies"), 1
    if token.text in STACKED:
        return _base_of_stack(p), 1
    return "", 0


def _base_of_stack(p: Stream) -> str:
    r"""Return the relation under (or over) which something stands: the ``=`` of ``\overset{!}{=}``."""
    return _relation_at(p, p.matching(p.place + 1))


def _relation_at(p: Stream, place: int) -> str:
    """Return the relation or arrow at a place, alone or in braces, or ""."""
    token = p.tokens[place]
    if token.is_char("{") and p.matching(place) == place + 3:
        token = p.tokens[place + 1]
    if token.kind == "command":
        return latex.RELATION_COMMANDS.get(token.text, latex.ARROW_COMMANDS.get(token.text, ""))
    return latex.RELATION_CHARACTERS.get(token.text, "") if token.kind == "char" else ""


def _stacked(p: Stream, script: Callable[[], Node]) -> Sign:
    start, name = p.token.span, _base_of_stack(p)
    p.take()
    first = p.place
    above = script()
    if _relation_at(p, p.place) != name:
        raise p.unread()
    words = "".join(t.text for t in p.tokens[first : p.place] if not t.is_char("{")).strip("} .")
    p.place = p.matching(p.place)
    if name == "=" and words in _DEFINING:
        return Sign(":=", span=p.since(start))
    return Sign(name, above, span=p.since(start))


def _is_sum_sign(token: Token) -> bool:
    if token.kind == "command":
        return token.text in latex.SUM_COMMANDS
    return token.kind == "char" and token.text in latex.SUM_SIGNS


def operator_ahead(p: Stream) -> str:
    """Return the name of the product operator at the cursor, or ""."""
    token = p.token
    if token.kind == "command":
        return latex.PRODUCT_COMMANDS.get(token.text, "")
    if token.kind != "char" or relation_ahead(p):
        return ""
    name = latex.PRODUCT_CHARACTERS.get(token.text, "")
    if name == "double dot" and (p.ahead().kind in {"words", "quad", "stop", "row"} or p.script):
        return ""
    return name


def factor_ahead(p: Stream) -> bool:
    """Whether another factor follows side by side."""
    if p.closes() or (p.integrals and differential_ahead(p)):
        return False
    stacked = p.token.is_command(*STACKED)
    if stacked and (relation_ahead(p) or arrow_ahead(p)):
        return False
    return p.starts_atom() and not (p.script and bool(p.bar(p.token)))


def skip_empty(p: Stream) -> None:
    r"""Pass over ``{}`` where it only makes space; take ``{=}`` as ``=``, ``\mathbf{\cdot}`` too."""
    font = int(p.token.is_command(*latex.FONTS))
    opened, inner, behind = p.ahead(font), p.ahead(font + 1), p.ahead(font + 2)
    if opened.is_char("{") and behind.is_char("}") and not inner.is_char("}"):
        saved, p.place = p.place, p.place + font + 1
        if operator_ahead(p) or relation_ahead(p) or _is_sum_sign(inner):
            p.place += 1
            p.tokens[p.place] = inner
            return
        p.place = saved
    while p.token.is_char("{") and p.ahead().is_char("}"):
        after = p.ahead(2)
        if after.kind == "char" and after.text in "^_":
            return
        p.place += 2
