"""Arguments and scripts: what stands in braces behind a command, below and above an atom.

Nodes made from their parts: what braces, scripts on the left and fonts do to what they hold.
"""

from __future__ import annotations

from dataclasses import replace

from eom.checker.read import latex
from eom.checker.read.spans import Span
from eom.checker.read.stream import Stream
from eom.checker.read.syntax import (
    Accent,
    Addition,
    BigOperator,
    Derivative,
    Evaluated,
    Group,
    Implication,
    Integral,
    Marks,
    Missing,
    Node,
    Number,
    Operation,
    Over,
    Product,
    Quotient,
    Relation,
    Rows,
    Scripts,
    Section,
    Sequence,
    Symbol,
    Words,
    transform,
)


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
        style = font_switch(p)
        body = Missing(span=token.span) if p.token.is_char("}") else p.statements()
        p.expect("}", token)
        return with_font(body, style)


def font_switch(p: Stream) -> str:
    r"""Read commands such as ``\rm``, and return the font that holds to the end of the group."""
    style = ""
    while p.token.is_command(*latex.SWITCHES):
        style = latex.SWITCHES[p.take().text]
    return style


def with_font(body: Node, style: str) -> Node:
    """Return what stands in a group behind a font switch."""
    return (word_of(body, style) or styled(body, style)) if style else body


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
    r"""Whether ``{}`` only spaces scripts of what stands before it: ``T^a{}_b``, ``\vec H{}'``."""
    script = p.ahead(2)
    if not (p.token.is_char("{") and p.ahead().is_char("}") and not p.token.spaced):
        return False
    if script.is_char("'"):
        return True
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


def limits(p: Stream) -> tuple[Node | None, Node | None]:
    """Read what stands below and above, in any order."""
    found: dict[str, Node] = {}
    while p.token.kind == "char" and p.token.text in "_^" and p.token.text not in found:
        sign = p.take().text
        found[sign] = script_argument(p)
    return found.get("_"), found.get("^")


def evaluated(p: Stream, base: Node, start: Span) -> Node:
    """Read the limits behind a bar; below the bar of a derivative stands its frame."""
    sub, sup = limits(p)
    if isinstance(base, Derivative) and base.frame is None and sup is None and is_frame(sub):
        return replace(base, frame=sub, span=p.since(start))
    return Evaluated(base, sub, sup, span=p.since(start))


_LOOSE = (
    *(Addition, Relation, Sequence, Product, Quotient, Section, BigOperator, Integral),
    *(Implication, Rows, Words, Operation, Missing),
)


def is_tight(node: Node) -> bool:
    """Whether a node stands as a factor without brackets, or shows its own."""
    return not isinstance(node, _LOOSE)


def is_frame(script: Node | None) -> bool:
    """Whether a script names a frame: a letter or a word, no number, no condition."""
    return isinstance(script, Symbol | Words | Scripts | Accent) or (
        isinstance(script, Product) and all(isinstance(f, Symbol) for f in script.factors)
    )


def with_scripts(base: Node, sub: Node | None, sup: Node | None, span: Span) -> Node:
    """Attach scripts; below brackets around a derivative stands its frame."""
    frame = sub if sup is None else None
    if isinstance(base, Group) and base.open == "(" and is_frame(frame):
        body = base.body
        if isinstance(body, Derivative) and body.frame is None:
            return replace(body, frame=frame, span=span)
    if isinstance(base, Scripts) and base.sub is base.sup is None:
        return replace(base, sub=sub, sup=sup, span=span)
    return Scripts(base, sub, sup, span=span)


def with_left(
    base: Node, sub: Node | None, sup: Node | None, span: Span, *, outside: bool = True
) -> Node:
    """Attach scripts on the left; above a derivative stands its frame."""
    if sub is None and sup is None:
        return base
    if isinstance(base, Derivative) and base.frame is None and sup is not None and sub is None:
        return replace(base, frame=sup, outside=outside, span=span)
    if isinstance(base, Scripts) and base.presub is base.presup is None:
        return replace(base, presub=sub, presup=sup, span=span)
    return Scripts(base, presub=sub, presup=sup, span=span)


def styled(node: Node, style: str) -> Node:
    """Give a font to all symbols that have none; bold goes over upright, digits become symbols."""

    def rule(n: Node) -> Node:
        if isinstance(n, Symbol) and (n.style == "" or (style == "bold" and n.style == "roman")):
            return replace(n, style=style)
        if isinstance(n, Number) and style not in {"", "roman"}:
            return Symbol(n.text, style, span=n.span)
        return n

    return transform(node, rule) if style else node


def braced(node: Node) -> Node:
    """Return an argument as a factor: sums and chains that only braces hold together are a group."""
    return node if is_tight(node) else Group(node, "", "", span=node.span)


def word_of(body: Node, style: str) -> Node | None:
    r"""Return the letters behind ``\rm`` as one name."""
    parts = getattr(body, "factors", ())
    if style == "roman" and parts and all(isinstance(f, Symbol) and f.style == "" for f in parts):
        return Symbol("".join(f.name for f in parts), style, span=body.span)
    return None


def stacked(above: Node, base: Node, span: Span) -> Node:
    r"""Return a base under a sign: a bullet or circle over a letter is an accent."""
    if isinstance(above, Marks) and not isinstance(base, Operation):
        names = {("bullet",): "bullet", ("circ",): "circle", ("prime",): "prime_over"}
        if above.names in names:
            return Accent(names[above.names], base, span=span)
    return Over(base, above, span=span)


def made(
    operand: Node | None, variables: list[Node], order: Node | None, sign: str, span: Span
) -> Derivative:
    """Return a derivative; the power below that repeats the order is left out."""
    if isinstance(operand, Group) and not operand.open and isinstance(operand.body, Product):
        operand = operand.body
    if len(variables) == 1 and order is not None:
        below = variables[0]
        if isinstance(below, Scripts) and below.sup == order:
            variables = [below.base if below.sub is None else replace(below, sup=None)]
    return Derivative(operand, tuple(variables), order, None, sign, span=span)


def lone_d(node: Node) -> bool:
    """Whether a factor is the d of an operator ``d/dt``."""
    base = node.base if isinstance(node, Scripts) and node.sub is None else node
    return isinstance(base, Symbol) and base.name == "d" and base.style in {"", "roman"}


def spliced(node: Node) -> list[Node]:
    """Return the factors of a product, also of one in braces of LaTeX, which show nothing."""
    body = node.body if isinstance(node, Group) and node.open == "" else node
    if isinstance(body, Product) and body.operator == "":
        return list(body.factors)
    return [node]


def juxtaposed(factors: list[Node], span: Span) -> Node:
    """Return factors side by side as one product; a single one stands alone."""
    first = spliced(factors[0])
    flat = [*first, *factors[1:]]
    return flat[0] if len(flat) == 1 else Product(tuple(flat), span=span)
