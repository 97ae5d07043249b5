r"""Prefix forms: sums, integrals, functions.

A sum sign takes one term. An integral takes what stands before its own differential. A function
without brackets takes numbers and one letter (and ``t`` behind it).

Derivatives by a fraction or a slash, and scripts on the left, which are their frames.

A bare operator ``\frac{d}{dt}`` takes the brackets behind it, else the factors that stand side by side.

Differentials, and how they differ from a factor d.
"""

from __future__ import annotations

from dataclasses import replace

from eom.checker.read import latex
from eom.checker.read.scripts import braced, limits, lone_d, made, with_left
from eom.checker.read.spans import Span
from eom.checker.read.stream import Stream
from eom.checker.read.syntax import (
    Addition,
    BigOperator,
    Call,
    Derivative,
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


def fraction(p: Stream) -> Node:
    """Read a fraction: a derivative where d or ∂ stands above and below."""
    token = p.take()
    if _is_derivative(p):
        return _derivative(p, token)
    above = p.argument()
    return Fraction(above, p.argument(), span=p.since(token.span))


def _is_derivative(p: Stream) -> bool:
    """Look at numerator and denominator without reading them."""
    above, below = p.place, p.matching(p.place)
    if not p.tokens[below].is_char("{"):
        return False
    sign, count = d_ahead(p, below + 1)
    if not sign or not variable_at(p, below + 1 + count):
        return False
    if not p.tokens[above].is_char("{"):
        return d_ahead(p, above)[0] == sign
    first = _behind_left_scripts(p, above + 1)
    over, width = d_ahead(p, first)
    return over == sign and _one_term(p, first + width, below - 1)


def _behind_left_scripts(p: Stream, place: int) -> int:
    """Return the place behind scripts on the left."""
    while True:
        if p.tokens[place].is_char("{") and p.tokens[place + 1].is_char("}"):
            place += 2
        elif p.tokens[place].kind == "char" and p.tokens[place].text in "^_":
            place = p.matching(place + 1)
        else:
            return place


def _one_term(p: Stream, first: int, last: int) -> bool:
    """Whether no sum and no chain stands between two places, outside of brackets and integrals."""
    depth = 0
    for k in range(first, last):
        token = p.tokens[k]
        if token.kind == "command" and token.text in latex.INTEGRALS:
            return True
        if token.kind == "char":
            depth += (token.text in "({[") - (token.text in ")}]")
            if depth == 0 and token.text in "+-=," and not _unary(p.tokens[k - 1]):
                return False
        elif token.is_command("left", "right"):
            depth += 1 if token.text == "left" else -1
        elif token.kind in {"begin", "end"}:
            depth += 1 if token.kind == "begin" else -1
    return True


def _unary(before: Token) -> bool:
    """Whether a sign behind this token has no left operand."""
    return before.kind == "command" and before.text in latex.PRODUCT_COMMANDS


def _derivative(p: Stream, token: Token) -> Node:
    opened = p.token
    with p.nested():
        braced = p.accept("{")
        sub, frame = left_scripts(p)
        sign = take_d(p)
        power = order(p)
        operand = None
        if braced:
            operand = None if p.token.is_char("}") else p.term()
            p.expect("}", opened)
    opened = p.token
    variables = []
    with p.nested():
        p.expect("{")
        while not p.token.is_char("}"):
            if d_ahead(p, p.place)[0] != sign:
                raise p.unread()
            variables.append(differential_of(p).variable)
        p.expect("}", opened)
    node = made(operand, variables, power, sign, p.since(token.span))
    node = replace(node, form="over" if operand is not None else "before")
    return with_left(node, sub, frame, node.span, outside=False)


def physics_derivative(p: Stream) -> Node:
    r"""Read ``\dv[n]{x}{t}``, ``\dv{t}`` and the same of ``\pdv``."""
    token = p.take()
    order = None
    if p.token.is_char("["):
        opened = p.take()
        with p.nested():
            order = p.statements()
        p.expect("]", opened)
    first = p.argument()
    more: list[Node] = []
    while p.token.is_char("{") and len(more) < 3:
        more.append(braced(p.argument()))
    sign = "partial" if token.text == "pdv" else "d"
    if isinstance(more[-1] if more else first, Number):
        raise p.error("a number is no variable", token)
    if not more:
        return made(None, [braced(first)], order, sign, p.since(token.span))
    return made(first, more, order, sign, p.since(token.span))


def slash_derivative(p: Stream, factors: list[Node], start: Span) -> Node | None:
    """Read ``/dt`` behind a differential or a lone d; None where it is no derivative."""
    sign, count = d_ahead(p, p.place + 1)
    if not sign or not variable_at(p, p.place + 1 + count):
        return None
    last: Node = factors[-1]
    frame: Node | None = None
    if isinstance(last, Scripts) and last.presup is not None and last.sub is last.sup is None:
        frame = last.presup
        last = last.base
    if isinstance(last, Differential) and last.sign == sign:
        operand, power = last.variable, last.order
    elif lone_d(last):
        operand, power = None, last.sup if isinstance(last, Scripts) else None
    else:
        return None
    p.take()
    below = differential_of(p).variable
    node = made(operand, [below], power, sign, last.span.join(p.since(start)))
    node = replace(node, frame=frame, form="slash")
    if operand is None:
        node = applied(p, node)
    before = factors[:-1]
    return Product((*before, node), span=p.since(start)) if before else node


def applied(p: Stream, operator: Derivative) -> Derivative:
    """Return a bare derivative applied to what follows; alone where nothing follows."""
    if p.closes() or not p.starts_atom() or (p.integrals and differential_ahead(p)):
        return operator
    with p.nested(fresh=False):
        if bracket_ahead(p):
            operand = p.scripted()
        else:
            operand = p.run()
            if p.token.is_command("times", "cdot"):
                text = "a derivative before a product without brackets takes the first factor alone"
                p.note("derivative reach", text, operator.span)
    form = "slash" if operator.form == "slash" else "before"
    span = p.since(operator.span)
    return replace(operator, operand=operand, form=form, span=span)


def bracket_ahead(p: Stream) -> bool:
    """Whether brackets or a matrix open at the cursor."""
    token = p.token
    if token.kind == "begin":
        return token.text in latex.MATRICES
    return token.is_char("(") or token.is_char("[") or token.is_command("left", *latex.SIZES)


def left_script_ahead(p: Stream) -> bool:
    """Whether scripts stand before their base: ``{}^A x``, ``^A x``."""
    token = p.token
    if token.is_char("{") and p.ahead().is_char("}"):
        token = p.ahead(2)
    return token.kind == "char" and token.text in "^_"


def left_scripts(p: Stream) -> tuple[Node | None, Node | None]:
    """Read scripts before their base: what stands below and what above."""
    found: dict[str, Node] = {}
    while left_script_ahead(p):
        if p.token.is_char("{"):
            p.place += 2
        sign = p.take()
        if sign.text in found:
            raise p.error("a second script at the same place", sign)
        found[sign.text] = p.script_argument()
    return found.get("_"), found.get("^")


def left_scripted(p: Stream) -> Node:
    """Read scripts and the base behind them."""
    start = p.token.span
    sub, sup = left_scripts(p)
    if p.token.is_char("{") and p.ahead().is_char("}"):
        p.place += 2
    if differential_ahead(p) and d_ahead(p, p.place)[0]:
        base: Node = differential_of(p)
    elif p.starts_atom():
        base = p.scripted()
    else:
        raise p.error("a script has no base here")
    return with_left(base, sub, sup, p.since(start))


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
        inverse = name.startswith("arc") or sup == _INVERSE
        argument = p.atom() if _group_ahead(p) else _bare_argument(p, inverse)
    call: Node = Call(name, argument, sub, sup, span=p.since(start.span))
    after = p.token.kind == "char" and p.token.text in "_^"
    if after:
        sub, sup = limits(p)
        call = Scripts(call, sub, sup, span=p.since(start.span))
        p.note("power of a function", "a script behind the argument is of the value", call.span)
    return call


_INVERSE = Addition((Number("1"),), ("-",))
"""The script of an inverse function."""


def _argument_ahead(p: Stream) -> bool:
    return p.starts_atom() or p.token.is_char("-") or left_script_ahead(p)


def _group_ahead(p: Stream) -> bool:
    return bracket_ahead(p) or bool(p.bar(p.token)) or p.token.is_command("lvert", "lVert", "{")


def _bare_argument(p: Stream, inverse: bool) -> Node:
    """Return an argument without brackets; that of an inverse function may be a ratio."""
    start = p.token.span
    minus = p.accept("-")
    factors = [p.factor()]
    while p.starts_atom() and not p.closes() and _goes_on(p, factors[-1]):
        factors.append(p.factor())
    node = factors[0] if len(factors) == 1 else Product(tuple(factors), span=p.since(start))
    ratio = p.ahead().kind == "number" or (inverse and not p.ahead().is_command("pi"))
    if p.token.is_char("/") and ratio:
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
