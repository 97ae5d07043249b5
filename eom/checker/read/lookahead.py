"""What stands at the cursor: operators and factors, in braces of LaTeX or without."""

from __future__ import annotations

from eom.checker.read import latex, signs
from eom.checker.read.differentials import differential_ahead
from eom.checker.read.stream import Stream
from eom.checker.read.tokens import Token


def _is_sum_sign(token: Token) -> bool:
    if token.kind == "command":
        return token.text in latex.SUM_COMMANDS
    return token.kind == "char" and token.text in latex.SUM_SIGNS


def operator_ahead(p: Stream) -> str:
    """Return the name of the product operator at the cursor, or ""."""
    token = p.token
    if token.kind == "command":
        return latex.PRODUCT_COMMANDS.get(token.text, "")
    if token.kind != "char" or signs.relation_ahead(p):
        return ""
    name = latex.PRODUCT_CHARACTERS.get(token.text, "")
    if name == "double dot" and (p.ahead().kind in {"words", "quad", "stop", "row"} or p.script):
        return ""
    return name


def factor_ahead(p: Stream) -> bool:
    """Whether another factor follows side by side."""
    if p.closes() or (p.integrals and differential_ahead(p)):
        return False
    stacked = p.token.is_command(*signs.STACKED)
    if stacked and (signs.relation_ahead(p) or signs.arrow_ahead(p)):
        return False
    return p.starts_atom() and not (p.script and bool(p.bar(p.token)))


def skip_empty(p: Stream) -> None:
    r"""Pass over ``{}`` where it only makes space; take ``{=}`` as ``=``, ``\mathbf{\cdot}`` too."""
    font = int(p.token.is_command(*latex.FONTS))
    opened, inner, behind = p.ahead(font), p.ahead(font + 1), p.ahead(font + 2)
    if opened.is_char("{") and behind.is_char("}") and not inner.is_char("}"):
        saved, p.place = p.place, p.place + font + 1
        if operator_ahead(p) or signs.relation_ahead(p) or _is_sum_sign(inner):
            p.place += 1
            p.tokens[p.place] = inner
            return
        p.place = saved
    while p.token.is_char("{") and p.ahead().is_char("}"):
        after = p.ahead(2)
        if after.kind == "char" and after.text in "^_":
            return
        p.place += 2
