"""Syntax trees in a short notation, to write expected ones by hand.

Symbols by name, ``*`` before a bold one, other styles as ``rm:``, ``cal:``, ``bb:``; accents as
``vec(r)``; scripts in braces: ``r{_C ^T}``, on the left ``h{<I}`` above, ``R{,A}`` below; products
``[a b]``, ``[a x b]``, ``[a . b]``; sums ``[a + b]``; brackets as they are, ``⟦ ⟧`` for braces;
relations ``a = b``; ``D(r)/t@I`` a derivative in frame I; ``int_B(f; m)``; ``a / b`` on the line,
``frac(a, b)``; what is missing ``?``.
"""

from eom.checker.read import syntax as s

STYLES = {"": "", "bold": "*", "roman": "rm:", "calligraphic": "cal:", "blackboard": "bb:"}
OPERATORS = {"": " ", "dot": " . ", "cross": " x ", "tensor": " (x) ", "circle": " o "}


def shape(node):
    return _ROWS[type(node).__name__](node)


def _scripts(node, **named):
    found = {sign: getattr(node, name) for name, sign in named.items()}
    inside = " ".join(sign + shape(n) for sign, n in found.items() if n is not None)
    return f"{{{inside}}}" if inside else ""


def _script(node):
    return shape(node.base) + _scripts(node, sub="_", sup="^", presub=",", presup="<")


def _addition(node):
    text = ""
    for sign, term in zip(node.signs, node.terms, strict=True):
        text += (f" {sign} " if text else sign) + shape(term)
    return f"[{text}]"


def _chain(items, signs):
    text = shape(items[0])
    for sign, item in zip(signs, items[1:], strict=True):
        name = sign if isinstance(sign, str) else sign.name
        text += f" {name} {shape(item)}"
    return text


def _sequence(node):
    text = shape(node.items[0])
    for sep, item in zip(node.separators, node.items[1:], strict=True):
        text += {"quad": " ~ ", "": " ", ",": ", "}.get(sep, f" {sep} ") + shape(item)
    return text


def _product(node):
    return (
        "["
        + OPERATORS.get(node.operator, f" {node.operator} ").join(map(shape, node.factors))
        + "]"
    )


def _derivative(node):
    sign = {"d": "D", "partial": "P"}[node.sign]
    order = shape(node.order) if node.order else ""
    operand = f"({shape(node.operand)})" if node.operand else ""
    below = ",".join(map(shape, node.variables))
    return f"{sign}{order}{operand}/{below}" + (f"@{shape(node.frame)}" if node.frame else "")


def _integral(node):
    bounds = _scripts(node, lower="_", upper="^")
    inside = shape(node.integrand) if node.integrand else ""
    return f"{node.sign}{bounds}({inside}; {' '.join(map(shape, node.variables))})"


def _table(rows):
    return " // ".join(" & ".join(map(shape, row)) for row in rows)


def _group(node):
    opening, closing = (node.open or "⟦"), (node.close or "⟧")
    return opening + shape(node.body) + closing


_ROWS = {
    "Number": lambda n: n.text,
    "Symbol": lambda n: STYLES.get(n.style, n.style + ":") + n.name,
    "Words": lambda n: n.sign or repr(n.text),
    "Dots": lambda n: "...",
    "Blank": lambda n: "_",
    "Missing": lambda n: "?",
    "Marks": lambda n: "!" + "!".join(n.names),
    "Accent": lambda n: f"{n.mark}({shape(n.base)})",
    "Scripts": _script,
    "Over": lambda n: f"over({shape(n.base)}, {shape(n.above) if n.above else shape(n.below)})",
    "Operation": lambda n: f"<{n.name}>",
    "Group": _group,
    "Evaluated": lambda n: f"at({shape(n.base)}{_scripts(n, sub='_', sup='^')})",
    "Braced": lambda n: f"{n.mark}({shape(n.body)}; {shape(n.label) if n.label else ''})",
    "Boxed": lambda n: f"box({shape(n.body)})",
    "Struck": lambda n: f"struck({shape(n.body)})",
    "Addition": _addition,
    "Product": _product,
    "Quotient": lambda n: f"[{shape(n.left)} / {shape(n.right)}]",
    "Fraction": lambda n: f"frac({shape(n.above)}, {shape(n.below)})",
    "Root": lambda n: f"root({shape(n.body)})",
    "Call": lambda n: f"{n.function}{_scripts(n, sub='_', sup='^')} {shape(n.argument)}",
    "Section": lambda n: (
        f"[{shape(n.operand)} {n.operator}]" if n.left else f"[{n.operator} {shape(n.operand)}]"
    ),
    "BigOperator": lambda n: f"{n.sign}{_scripts(n, lower='_', upper='^')}({shape(n.body)})",
    "Differential": lambda n: f"d({shape(n.variable)})",
    "Integral": _integral,
    "Derivative": _derivative,
    "Matrix": lambda n: f"{n.environment}({_table(n.rows)})",
    "Cases": lambda n: f"cases({_table(n.rows)})",
    "Relation": lambda n: _chain(n.members, n.signs),
    "Sequence": _sequence,
    "Implication": lambda n: _chain(n.items, n.signs),
    "Rows": lambda n: " // ".join(map(shape, n.rows)),
}
assert set(_ROWS) == {
    name
    for name, kind in vars(s).items()
    if isinstance(kind, type) and issubclass(kind, s.Node) and kind not in {s.Node, s.Sign}
}
