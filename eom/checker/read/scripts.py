"""Arguments and scripts: what stands in braces behind a command, below and above an atom."""

from __future__ import annotations

from dataclasses import replace

from eom.checker.read import latex
from eom.checker.read.forms import is_frame, with_scripts
from eom.checker.read.places import Span
from eom.checker.read.stream import Stream
from eom.checker.read.syntax import Accent, Derivative, Evaluated, Marks, Missing, Node, Number


def argument(p: Stream) -> Node:
    """Read an argument: a group in braces, or a single atom."""
    token = p.token
    with p.nested():
        if token.is_char("{"):
            p.take()
            if p.token.is_char("}"):
                raise p.error("an argument is empty", token)
            body = p.statements()
            p.expect("}", token)
            return body
        if token.kind == "number":
            first = p.digit()
            return Number(first.text, span=first.span)
        return p.atom()


def script_argument(p: Stream) -> Node:
    """Read what stands in a script: signs alone are `Marks`, anything else an expression."""
    token = p.token
    if not token.is_char("{"):
        name = _mark(p)
        if name:
            return Marks((name,), span=p.take().span)
        return argument(p)
    end = p.matching(p.place) - 1
    with p.nested(script=True):
        p.take()
        names: list[str] = []
        saved = p.place
        while p.place < end and (name := _mark(p)):
            names.append(name)
            p.place += 1
        if names and p.place == end:
            p.expect("}", token)
            return Marks(tuple(names), span=p.since(token.span))
        p.place = saved
        body = Missing(span=token.span) if p.token.is_char("}") else p.statements()
        p.expect("}", token)
        return body


def _mark(p: Stream) -> str:
    token = p.token
    if token.kind == "command":
        return latex.SCRIPT_MARKS.get(token.text, "")
    return latex.SCRIPT_CHARACTERS.get(token.text, "") if token.kind == "char" else ""


def scripted(p: Stream) -> Node:
    """Read an atom with primes, scripts, combining accents and a bar with limits."""
    start = p.token.span
    base = p.atom()
    sub: Node | None = None
    sup: Node | None = None

    def whole() -> Node:
        return with_scripts(base, sub, sup, p.since(start)) if sub or sup else base

    while True:
        token = p.token
        if token.kind == "mark":
            base, sub, sup = Accent(p.take().text, whole(), span=p.since(start)), None, None
        elif token.is_char("^") or token.is_char("'"):
            if sup is not None:
                base, sub, sup = whole(), None, None
            sup = _primes(p) if token.is_char("'") else _script(p)
        elif token.is_char("_"):
            if sub is not None:
                base, sub, sup = whole(), None, None
            sub = _script(p)
        elif _empty_braces_behind(p):
            p.place += 2
        elif _bar_with_limits(p):
            base, sub, sup = _evaluated(p, whole(), start), None, None
        else:
            return whole()


def _script(p: Stream) -> Node:
    p.take()
    return script_argument(p)


def _primes(p: Stream) -> Node:
    start = p.token.span
    count = 0
    while p.accept("'"):
        count += 1
    return Marks(("prime",) * count, span=p.since(start))


def _empty_braces_behind(p: Stream) -> bool:
    r"""Whether ``{}`` only spaces scripts of what stands before it: ``T^a{}_b``."""
    script = p.ahead(2)
    if not (p.token.is_char("{") and p.ahead().is_char("}") and not p.token.spaced):
        return False
    if not (script.is_char("^") or script.is_char("_")):
        return False
    after = p.matching(min(p.place + 3, len(p.tokens) - 1))
    saved, p.place = p.place, after
    base = p.starts_atom() or p.token.is_char("^") or p.token.is_char("_")
    p.place = saved
    return not base


def _bar_with_limits(p: Stream) -> bool:
    at = 1 if p.token.is_command(*latex.SIZES) else 0
    token, after = p.ahead(at), p.ahead(at + 1)
    return p.bar(token) == "|" and not p.bars and (after.is_char("_") or after.is_char("^"))


def _evaluated(p: Stream, base: Node, start: Span) -> Node:
    if p.token.is_command(*latex.SIZES):
        p.take()
    p.take()
    return evaluated(p, base, start)


def evaluated(p: Stream, base: Node, start: Span) -> Node:
    """Read the limits behind a bar; below the bar of a derivative stands its frame."""
    limits: dict[str, Node] = {}
    while p.token.kind == "char" and p.token.text in "_^" and p.token.text not in limits:
        sign = p.token.text
        limits[sign] = _script(p)
    sub, sup = limits.get("_"), limits.get("^")
    if isinstance(base, Derivative) and base.frame is None and sup is None and is_frame(sub):
        return replace(base, frame=sub, span=p.since(start))
    return Evaluated(base, sub, sup, span=p.since(start))
