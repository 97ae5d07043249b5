"""Differentials, and how they are told from a factor d."""

from __future__ import annotations

from eom.checker.read import latex
from eom.checker.read.forms import braced
from eom.checker.read.stream import Stream
from eom.checker.read.syntax import Differential, Node

ROMAN = frozenset({"mathrm", "rm", "mathup", "textrm", "symrm"})


_USUAL = frozenset({"m", "V", "t", "A", "S", "M"})


def d_ahead(p: Stream, place: int) -> tuple[str, int]:
    """Return the sign of a differential at a place, "d" or "partial", and its number of tokens."""
    token = p.tokens[place]
    if token.kind == "letter" and token.text == "d":
        return "d", 1
    if token.kind == "operator" and token.text == "d":
        return "d", 1
    if token.kind == "command" and token.text == "partial":
        return "partial", 1
    following = p.tokens[place : place + 4]
    texts = [t.text for t in following]
    if token.kind == "command" and token.text in ROMAN:
        if texts[1:4] == ["{", "d", "}"]:
            return "d", 4
        return ("d", 2) if texts[1:2] == ["d"] and following[1].kind == "letter" else ("", 0)
    if texts[:1] == ["{"] and token.kind == "char" and texts[1:2] and texts[1] in ROMAN:
        return ("d", 4) if texts[2:4] == ["d", "}"] else ("", 0)
    return "", 0


def variable_at(p: Stream, place: int) -> bool:
    """Whether what follows can be the variable of a differential."""
    token = p.tokens[min(place, len(p.tokens) - 1)]
    if token.kind == "letter":
        return True
    if token.kind != "command":
        return token.is_char("{") and not p.tokens[place + 1].is_char("}")
    return token.text in latex.SYMBOLS or token.text in latex.ACCENTS or token.text in latex.FONTS


def differential_ahead(p: Stream) -> bool:
    """Whether a differential stands at the cursor, and not a factor ``d``."""
    sign, count = d_ahead(p, p.place)
    if not sign:
        return p.token.is_command("dd")
    place = p.place + count
    if p.tokens[place].is_char("^"):
        place = p.matching(place + 1)
        if p.tokens[place].kind == "letter" and p.tokens[place].text == "d":
            return False
    if not variable_at(p, place):
        return slash_behind(p, place) if p.tokens[place].is_char("(") else False
    if sign == "partial" or p.token.kind != "letter":
        return not (p.integrals and sign == "partial")
    if p.integrals:
        return True
    return not p.script and _stands_alone(p, place)


def _stands_alone(p: Stream, place: int) -> bool:
    """Whether an italic d begins a differential: no factor before it, or a usual variable behind."""
    before = p.tokens[p.place - 1] if p.place else None
    if before is None or (before.kind == "char" and before.text not in ")]}"):
        return True
    symbol = before.kind in {"letter", "number"}
    shown = before.kind == "command" and before.text in latex.SYMBOLS
    if not symbol and not shown and not before.is_char(")") and not before.is_char("}"):
        return not before.is_char("]")
    return p.tokens[place].text in _USUAL or slash_behind(p, place)


def slash_behind(p: Stream, place: int) -> bool:
    """Whether a slash and another d follow shortly: ``m d v_C/dt``."""
    depth = 0
    for k in range(place, min(place + 24, len(p.tokens) - 1)):
        token = p.tokens[k]
        if token.kind == "char":
            depth += (token.text in "({[") - (token.text in ")}]")
        if depth < 0 or token.kind in {"quad", "row"}:
            return False
        if depth == 0 and token.is_char("/"):
            return bool(d_ahead(p, k + 1)[0])
        if depth == 0 and token.kind == "char" and token.text in "=+-,":
            return False
    return False


def differential_of(p: Stream) -> Differential:
    """Read a differential."""
    start = p.token.span
    if p.token.is_command("dd"):
        p.take()
        return Differential(braced(p.argument()), span=p.since(start))
    sign = take_d(p)
    power = order(p)
    return Differential(p.scripted(), power, sign, span=p.since(start))


def take_d(p: Stream) -> str:
    """Pass over the sign of a differential and return its name."""
    sign, count = d_ahead(p, p.place)
    for _ in range(count):
        p.take()
    return sign


def order(p: Stream) -> Node | None:
    """Read the power of the sign d, if there is one."""
    return p.script_argument() if p.accept("^") else None
