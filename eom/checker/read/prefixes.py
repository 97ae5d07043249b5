r"""Prefix forms: sums, integrals, functions.

A sum sign takes one term. An integral takes what stands before its own differential. A function
without brackets takes numbers and one letter (and ``t`` behind it).
"""

from __future__ import annotations

from dataclasses import replace

from eom.checker.read import latex
from eom.checker.read.derivatives import (
    ROMAN,
    bracket_ahead,
    d_ahead,
    differential_ahead,
    differential_of,
    left_script_ahead,
    left_scripted,
)
from eom.checker.read.stream import Stream
from eom.checker.read.syntax import (
    Addition,
    BigOperator,
    Call,
    Differential,
    Fraction,
    Integral,
    Node,
    Number,
    Product,
    Quotient,
    Scripts,
    Symbol,
)
from eom.checker.read.tokens import Token

COMMANDS = frozenset({*latex.BIG_OPERATORS, *latex.INTEGRALS, *latex.COMMAND_FUNCTIONS, "dd"})


def prefix(p: Stream) -> Node | None:
    """Read a prefix form at the cursor, or return None where there is none."""
    token = p.token
    if token.kind == "command" and token.text in latex.BIG_OPERATORS:
        return _big_operator(p)
    if token.kind == "command" and token.text in latex.INTEGRALS:
        return _integral(p)
    if function_ahead(p):
        return _call(p)
    if left_script_ahead(p):
        return left_scripted(p)
    if differential_ahead(p):
        return differential_of(p)
    return None


def limits(p: Stream) -> tuple[Node | None, Node | None]:
    """Read what stands below and above, in any order."""
    found: dict[str, Node] = {}
    while p.token.kind == "char" and p.token.text in "_^" and p.token.text not in found:
        sign = p.take().text
        found[sign] = p.script_argument()
    return found.get("_"), found.get("^")


def _big_operator(p: Stream) -> Node:
    token = p.take()
    lower, upper = limits(p)
    with p.nested(fresh=False):
        body = p.term()
    return BigOperator(
        latex.BIG_OPERATORS[token.text], body, lower, upper, span=p.since(token.span)
    )


def _integral(p: Stream) -> Node:
    token = p.take()
    sign = latex.INTEGRALS[token.text]
    lower, upper = limits(p)
    outer = p.integrals
    with p.nested(fresh=False):
        p.integrals += 1
        integrand = None if differential_ahead(p) else p.addition()
        variables: list[Node] = []
        most = {"int": 1, "oint": 1, "iint": 2}.get(sign, 3) if outer else 3
        while differential_ahead(p) and len(variables) < most:
            variables.append(differential_of(p).variable)
    if integrand is not None and not variables:
        integrand, variables = _within_fraction(p, integrand, token)
    if integrand is None and p.starts_atom() and not p.closes() and not d_ahead(p, p.place)[0]:
        text = "an integral of nothing before a factor: the factor is read outside of it"
        p.note("empty integral", text, p.since(token.span))
    span = p.since(token.span)
    return Integral(integrand, tuple(variables), lower, upper, sign, span=span)


def _within_fraction(p: Stream, integrand: Node, token: Token) -> tuple[Node | None, list[Node]]:
    r"""Take the differential out of a numerator, ``\int \frac{dm}{r}``; note where there is none."""
    factors = list(integrand.factors) if isinstance(integrand, Product) else [integrand]
    last = factors[-1]
    if isinstance(last, Fraction):
        above = last.above
        inside = list(above.factors) if isinstance(above, Product) else [above]
        if isinstance(inside[-1], Differential):
            rest = inside[:-1] or [Number("1", span=inside[-1].span)]
            over = rest[0] if len(rest) == 1 else Product(tuple(rest), span=above.span)
            factors[-1] = replace(last, above=over)
            whole: Node = factors[0]
            if isinstance(integrand, Product):
                whole = replace(integrand, factors=tuple(factors))
            return whole, [inside[-1].variable]
    p.note("no differential", "an integral without its differential", token.span)
    return integrand, []


def function_ahead(p: Stream) -> bool:
    """Whether a named function stands at the cursor."""
    token = p.token
    if token.kind == "operator":
        return token.text in latex.FUNCTIONS or _opens(p, 1)
    if token.kind != "command":
        return False
    return (
        token.text in latex.COMMAND_FUNCTIONS
        or token.text in latex.FUNCTION_ALIASES
        or bool(_upright_name(p))
    )


def _opens(p: Stream, count: int) -> bool:
    token = p.ahead(count)
    return token.is_char("(") or token.is_char("[") or token.is_command("left")


def _upright_name(p: Stream) -> str:
    r"""Return the name of a function in ``\mathrm{...}``."""
    if not p.token.is_command(*ROMAN) or not p.ahead().is_char("{"):
        return ""
    name = ""
    for k in range(2, 12):
        token = p.ahead(k)
        if token.is_char("}"):
            return name if len(name) > 1 and name in latex.FUNCTIONS else ""
        name += token.text if token.kind == "letter" else "?"
    return ""


def _call(p: Stream) -> Node:
    start = p.token
    name = _upright_name(p) if start.kind == "command" else ""
    if name:
        p.place = p.matching(p.place + 1)
    else:
        name = p.take().text
    name = latex.FUNCTION_ALIASES.get(name, name)
    sub, sup = limits(p)
    if p.closes() or not _argument_ahead(p):
        base: Node = Symbol(name, "roman", span=start.span)
        return Scripts(base, sub, sup, span=p.since(start.span)) if sub or sup else base
    with p.nested(fresh=False):
        argument = p.atom() if _group_ahead(p) else _bare_argument(p)
    call: Node = Call(name, argument, sub, sup, span=p.since(start.span))
    after = p.token.kind == "char" and p.token.text in "_^"
    if after:
        sub, sup = limits(p)
        call = Scripts(call, sub, sup, span=p.since(start.span))
        p.note("power of a function", "a script behind the argument is of the value", call.span)
    return call


def _argument_ahead(p: Stream) -> bool:
    return p.starts_atom() or p.token.is_char("-") or left_script_ahead(p)


def _group_ahead(p: Stream) -> bool:
    return bracket_ahead(p) or bool(p.bar(p.token)) or p.token.is_command("lvert", "lVert", "{")


def _bare_argument(p: Stream) -> Node:
    start = p.token.span
    minus = p.accept("-")
    factors = [p.factor()]
    while p.starts_atom() and not p.closes() and _goes_on(p, factors[-1]):
        factors.append(p.factor())
    node = factors[0] if len(factors) == 1 else Product(tuple(factors), span=p.since(start))
    if p.token.is_char("/") and p.ahead().kind == "number":
        slash = p.take()
        node = Quotient(node, p.scripted(), span=p.since(start))
        p.note("slash", "the quotient is read as within the function", slash.span)
    return Addition((node,), ("-",), span=p.since(start)) if minus else node


def _goes_on(p: Stream, last: Node) -> bool:
    """Whether the next factor belongs to an argument without brackets."""
    token = p.token
    plain = token.kind == "letter" or (token.kind == "command" and token.text in latex.SYMBOLS)
    if isinstance(last, Number):
        return plain or token.is_command(*latex.FRACTIONS)
    if isinstance(last, Fraction):
        return plain and _is_numeric(last)
    counting = isinstance(last, Symbol) and last.name in {"n", "k", "j"} and last.style == ""
    return (token.text == "t" and token.kind == "letter") or (counting and plain)


def _is_numeric(node: Node) -> bool:
    return isinstance(node, Fraction) and isinstance(node.below, Number)
