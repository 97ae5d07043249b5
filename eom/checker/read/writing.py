r"""Syntax trees as LaTeX: what is written reads again as the same tree.

Each row knows its own layer and those of its parts; a part that is looser than its place gets
brackets, so that changed trees can be written as well (they read again with those brackets).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from eom.checker.read import latex as tables
from eom.checker.read import syntax as s

ROWS, IMPLICATION, SEQUENCE, RELATION, SUM, LOOSE, TIGHT, RUN, ATOM = range(9)
"""Layers from loose to tight."""


def latex(node: s.Node) -> str:
    """Return a tree as LaTeX."""
    return _write(node, ROWS)


def _write(node: s.Node, layer: int) -> str:
    own = _layer(node)
    text = _TABLE[type(node).__name__](node)
    if own >= layer:
        return text
    if isinstance(node, s.Rows):
        return rf"\begin{{aligned}} {text} \end{{aligned}}"
    return rf"\left( {text} \right)"


_LAYERS: dict[str, int] = {
    "Rows": ROWS,
    "Implication": IMPLICATION,
    "Sequence": SEQUENCE,
    "Relation": RELATION,
    "Addition": SUM,
    "Section": LOOSE,
    "Quotient": RUN,
    "BigOperator": RUN,
    "Integral": RUN,
    "Derivative": RUN,
    "Call": RUN,
    "Differential": RUN,
    "Operation": RUN,
}


def _layer(node: s.Node) -> int:
    if isinstance(node, s.Product):
        if node.operator in tables.LOOSE_PRODUCTS:
            return LOOSE
        return TIGHT if node.operator else RUN
    return _LAYERS.get(type(node).__name__, ATOM)


# -- statements ----------------------------------------------------------------------------------


def _joined(items: tuple[s.Node, ...], signs: list[str], layer: int) -> str:
    parts = [_write(items[0], layer)]
    for sign, item in zip(signs, items[1:], strict=True):
        parts += [sign, _write(item, layer)]
    return " ".join(p for p in parts if p)


def _sign(node: s.Sign) -> str:
    text = s.RELATIONS.get(node.name) or s.ARROWS[node.name]
    return rf"\overset{{{latex(node.above)}}}{{{text}}}" if node.above else text


_SEPARATORS = {"quad": r"\quad"}


def _sequence(node: s.Sequence) -> str:
    return _joined(node.items, [_SEPARATORS.get(p, p) for p in node.separators], RELATION)


# -- operations ----------------------------------------------------------------------------------


_SIGNS = {"±": r"\pm", "∓": r"\mp"}


def _addition(node: s.Addition) -> str:
    parts: list[str] = []
    for k, (sign, term) in enumerate(zip(node.signs, node.terms, strict=True)):
        text = _after_sign(term, LOOSE) if sign else _write(term, LOOSE)
        last = k == len(node.terms) - 1
        parts += [_SIGNS.get(sign, sign), text if last or not _endless(term) else _bracketed(text)]
    return " ".join(p for p in parts if p)


def _bracketed(text: str) -> str:
    return rf"\left( {text} \right)"


def _product(node: s.Product) -> str:
    if not node.operator:
        return _juxtaposed(node.factors)
    loose = node.operator in tables.LOOSE_PRODUCTS
    parts = []
    for k, factor in enumerate(node.factors):
        text = _operand(factor, TIGHT if loose else RUN, first=k == 0, outer=node.operator)
        last = k == len(node.factors) - 1
        parts.append(text if last or not _spans(factor) else _bracketed(text))
    return f" {s.PRODUCTS[node.operator]} ".join(parts)


def _operand(node: s.Node, layer: int, *, first: bool, outer: str) -> str:
    """Write an operand; a product of the same layer may begin one with another operator."""
    if first and isinstance(node, s.Product) and node.operator != outer:
        return _write(node, layer - 1)
    return _write(node, layer) if first else _after_sign(node, layer)


def _after_sign(node: s.Node, layer: int) -> str:
    """Write an operand behind a sign or operator: one of its own may stand at its beginning."""
    if isinstance(node, s.Addition) and len(node.terms) == 1 and node.signs[0]:
        sign = _SIGNS.get(node.signs[0], node.signs[0])
        return f"{sign} {_after_sign(node.terms[0], RUN)}"
    if isinstance(node, s.Product) and node.operator and _layer(node) >= layer:
        first, text = node.factors[0], _write(node, layer)
        changed = _after_sign(first, _layer(node))
        plain = _operand(first, _layer(node) + 1, first=True, outer=node.operator)
        if changed != plain and text.startswith(plain) and not _spans(first):
            return changed + text[len(plain) :]
    return _write(node, layer)


def _juxtaposed(factors: tuple[s.Node, ...]) -> str:
    parts = []
    for k, factor in enumerate(factors):
        inner = isinstance(factor, s.Product) and not factor.operator
        quotient = isinstance(factor, s.Quotient) and k > 0
        text = _write(factor, ATOM if inner or quotient else RUN)
        if (k < len(factors) - 1 or isinstance(factor, s.Differential)) and not inner:
            text = _closed(factor, text)
        parts.append(text)
    return " ".join(parts)


def _closed(node: s.Node, text: str) -> str:
    """Keep a factor from taking in the next one: by braces, or brackets for a sum."""
    if _spans(node):
        return _bracketed(text)
    lone = isinstance(node, s.Symbol) and node.name in {"d", "partial"}
    lone = lone or isinstance(node, s.Differential)
    bare = isinstance(node, s.Call) and not isinstance(node.argument, s.Group)
    bare = bare or (isinstance(node, s.Derivative) and node.operand is None)
    return f"{{{text}}}" if lone or bare else text


def _numerator(node: s.Node) -> str:
    """Write what stands above; a d alone must not make a derivative."""
    text = latex(node)
    return f"{{{text}}}" if isinstance(node, s.Symbol) and node.name in {"d", "partial"} else text


def _last_part(node: s.Node) -> s.Node | None:
    """Return what stands last in a node without brackets of its own."""
    if isinstance(node, s.Product):
        return node.factors[-1]
    if isinstance(node, s.Addition):
        return node.terms[-1]
    if isinstance(node, s.BigOperator):
        return node.body
    if isinstance(node, s.Quotient):
        return node.right
    return node.argument if isinstance(node, s.Call) else None


def _spans(node: s.Node | None) -> bool:
    """Whether the operators behind a node would be read as part of it."""
    while node is not None and not isinstance(node, s.BigOperator):
        if isinstance(node, s.Integral) and not node.variables:
            return True
        node = _last_part(node)
    return node is not None


def _endless(node: s.Node | None) -> bool:
    """Whether even a sum behind a node would be read as part of it."""
    while node is not None:
        if isinstance(node, s.Integral) and not node.variables:
            return True
        node = _last_part(node)
    return False


def _quotient(node: s.Quotient) -> str:
    left = _write(node.left, RUN)
    if not isinstance(node.left, s.Product | s.Quotient) or _spans(node.left):
        left = _closed(node.left, left)
    right = _write(node.right, ATOM if isinstance(node.right, s.Product | s.Quotient) else RUN)
    lone = isinstance(node.right, s.Symbol) and node.right.name in {"d", "partial"}
    return f"{left} / {{{right}}}" if lone else f"{left} / {right}"


def _section(node: s.Section) -> str:
    sign = s.PRODUCTS[node.operator]
    if not node.left:
        return f"{sign} {_write(node.operand, RUN)}"
    loose = node.operator in tables.LOOSE_PRODUCTS
    inner = isinstance(node.operand, s.Product) and node.operand.operator != ""
    return f"{_write(node.operand, LOOSE if loose else TIGHT if inner else RUN)} {sign}"


# -- prefix forms --------------------------------------------------------------------------------


def _limits(lower: s.Node | None, upper: s.Node | None) -> str:
    text = f"_{{{_script(lower)}}}" if lower is not None else ""
    return text + (f"^{{{_script(upper)}}}" if upper is not None else "")


_MARKS = {
    "prime": r"\prime",
    "ast": r"\ast",
    "sim": r"\sim",
    "+": "+",
    "-": "-",
    "|": "|",
    "=": "=",
    "!": "!",
}


def _script(node: s.Node) -> str:
    if isinstance(node, s.Marks):
        return "".join(_MARKS.get(n, rf"\{n} ") for n in node.names).strip()
    return _letters(node) or latex(node)


def _letters(node: s.Node) -> str:
    """Write plain letters of a script beside one another, as words are; "" for anything else."""
    parts = node.factors if isinstance(node, s.Product) and not node.operator else ()
    plain = all(isinstance(p, s.Symbol) and not p.style and len(p.name) == 1 for p in parts)
    return "".join(map(latex, parts)) if plain else ""


def _big(node: s.BigOperator) -> str:
    return rf"\{node.sign}{_limits(node.lower, node.upper)} {_after_sign(node.body, LOOSE)}"


def _integral(node: s.Integral) -> str:
    sign = rf"\{node.sign}{_limits(node.lower, node.upper)}"
    inside = [] if node.integrand is None else [_write(node.integrand, SUM)]
    below = [rf"\, \mathrm{{d}} {_variable(v)}" for v in node.variables]
    return " ".join([sign, *inside, *below])


def _differential(node: s.Differential) -> str:
    sign = r"\partial" if node.sign == "partial" else r"\mathrm{d}"
    order = f"^{{{_script(node.order)}}}" if node.order is not None else ""
    return f"{sign}{order} {_variable(node.variable)}"


def _variable(node: s.Node) -> str:
    plain = isinstance(node, s.Symbol | s.Scripts | s.Accent)
    return latex(node) if plain else f"{{{latex(node)}}}"


def _derivative(node: s.Derivative) -> str:
    sign = r"\partial" if node.sign == "partial" else r"\mathrm{d}"
    order = f"^{{{_script(node.order)}}}" if node.order is not None else ""
    single = order if len(node.variables) == 1 else ""
    below = " ".join(f"{sign} {_variable(v)}{single}" for v in node.variables)
    frame = f"{{}}^{{{_script(node.frame)}}}" if node.frame is not None else ""
    behind = isinstance(node.operand, s.Group) and node.operand.open in {"(", "["}
    if node.operand is None or (behind and node.form == "before"):
        operand = f" {latex(node.operand)}" if node.operand is not None else ""
        return rf"{frame}\frac{{{sign}{order}}}{{{below}}}{operand}"
    return rf"{frame}\frac{{{sign}{order} {_write(node.operand, LOOSE)}}}{{{below}}}"


def _call(node: s.Call) -> str:
    known = node.function in tables.COMMAND_FUNCTIONS
    name = rf"\{node.function}" if known else rf"\operatorname{{{node.function}}}"
    if isinstance(node.argument, s.Differential):
        return f"{name}{_limits(node.sub, node.sup)} {{{latex(node.argument)}}}"
    argument = latex(node.argument) if _is_bare(node.argument) else _write(node.argument, 9)
    return f"{name}{_limits(node.sub, node.sup)} {argument}"


_STARTS = (s.Number, s.Symbol, s.Scripts, s.Accent, s.Fraction)


def _is_bare(node: s.Node) -> bool:
    """Whether an argument can stand without more brackets."""
    if isinstance(node, s.Addition):
        return len(node.terms) == 1 and node.signs == ("-",) and _is_bare(node.terms[0])
    if isinstance(node, s.Quotient):
        right = node.right.base if isinstance(node.right, s.Scripts) else node.right
        return isinstance(right, s.Number) and _is_bare(node.left)
    if isinstance(node, s.Product):
        return node.operator == "" and isinstance(
            node.factors[0], s.Number | s.Symbol | s.Scripts | s.Accent | s.Fraction
        )
    return _layer(node) >= RUN and not isinstance(node, s.Differential)


# -- atoms ---------------------------------------------------------------------------------------

_FONTS = {
    "bold": "mathbf",
    "roman": "mathrm",
    "calligraphic": "mathcal",
    "blackboard": "mathbb",
    "sans": "mathsf",
    "fraktur": "mathfrak",
    "typewriter": "mathtt",
}


def _symbol(node: s.Symbol) -> str:
    command = node.name in tables.SYMBOLS or node.name == "partial"
    text = rf"\{node.name}" if command else node.name
    if not node.style:
        return text if command or len(text) == 1 else rf"\mathit{{{text}}}"
    font = "boldsymbol" if node.style == "bold" and command else _FONTS[node.style]
    return rf"\{font}{{{text}}}"


def _scripts(node: s.Scripts) -> str:
    base = _base(node.base)
    left = _limits(node.presub, node.presup)
    return f"{'{}' + left if left else ''}{base}{_limits(node.sub, node.sup)}"


def _base(node: s.Node) -> str:
    text = _write(node, RUN)
    if isinstance(node, s.Symbol) and node.name in {"d", "partial"}:
        return f"{{{text}}}"
    if isinstance(node, s.Product | s.Quotient | s.BigOperator | s.Integral):
        return rf"\left( {text} \right)"
    plain = isinstance(node, s.Symbol | s.Number | s.Group | s.Accent | s.Matrix | s.Words)
    return text if plain and not (isinstance(node, s.Number) and len(text) > 1) else f"{{{text}}}"


_ACCENTS = {
    "bullet": r"\overset{\bullet}",
    "circle": r"\overset{\circ}",
    "prime_over": r"\overset{\prime}",
    "ring": r"\mathring",
    "harpoon": r"\overrightharpoon",
    "double_bar": r"\overleftrightarrow",
    "underarrow": r"\underrightarrow",
    "undertilde": r"\utilde",
}


def _accent(node: s.Accent) -> str:
    return f"{_ACCENTS.get(node.mark, chr(92) + node.mark)}{{{latex(node.base)}}}"


def _over(node: s.Over) -> str:
    name, script = ("overset", node.above) if node.above is not None else ("underset", node.below)
    assert script is not None
    return rf"\{name}{{{_script(script)}}}{{{latex(node.base)}}}"


_DELIMITERS = {
    "{": r"\{",
    "}": r"\}",
    "||": r"\|",
    "<": r"\langle",
    ">": r"\rangle",
    "⌊": r"\lfloor",
    "⌋": r"\rfloor",
    "⌈": r"\lceil",
    "⌉": r"\rceil",
}


def _group(node: s.Group) -> str:
    body = latex(node.body)
    if not node.open:
        return f"{{{body}}}"
    opening, closing = (_DELIMITERS.get(d, d) for d in (node.open, node.close))
    return rf"\left{opening} {body} \right{closing}"


def _evaluated(node: s.Evaluated) -> str:
    return rf"\left. {latex(node.base)} \right|{_limits(node.sub, node.sup)}"


def _braced(node: s.Braced) -> str:
    sign = "_" if node.mark == "underbrace" else "^"
    label = f"{sign}{{{_script(node.label)}}}" if node.label is not None else ""
    return rf"\{node.mark}{{{latex(node.body)}}}{label}"


def _struck(node: s.Struck) -> str:
    if node.to is None:
        return rf"\cancel{{{latex(node.body)}}}"
    return rf"\cancelto{{{latex(node.to)}}}{{{latex(node.body)}}}"


def _root(node: s.Root) -> str:
    degree = f"[{latex(node.degree)}]" if node.degree is not None else ""
    return rf"\sqrt{degree}{{{latex(node.body)}}}"


def _rows(rows: tuple[tuple[s.Node, ...], ...]) -> str:
    return r" \\ ".join(" & ".join(latex(c) for c in row) for row in rows)


def _matrix(node: s.Matrix) -> str:
    name = node.environment
    columns = node.columns or "c" * max((len(r) for r in node.rows), default=1)
    columns = f"{{{columns}}}" if name in tables.WITH_SPECIFICATION else ""
    return rf"\begin{{{name}}}{columns} {_rows(node.rows)} \end{{{name}}}"


def _cases(node: s.Cases) -> str:
    name = "cases" if node.side == "left" else "rcases"
    return rf"\begin{{{name}}} {_rows(node.rows)} \end{{{name}}}"


_TABLE: dict[str, Callable[[Any], str]] = {
    "Number": lambda n: n.text,
    "Symbol": _symbol,
    "Words": lambda n: rf"\{n.sign}" if n.sign else rf"\text{{{n.text}}}",
    "Dots": lambda n: rf"\{n.name}",
    "Blank": lambda _: r"\cdot",
    "Missing": lambda _: "",
    "Marks": _script,
    "Accent": _accent,
    "Scripts": _scripts,
    "Over": _over,
    "Operation": lambda n: s.PRODUCTS[n.name],
    "Group": _group,
    "Evaluated": _evaluated,
    "Braced": _braced,
    "Boxed": lambda n: rf"\boxed{{{latex(n.body)}}}",
    "Struck": _struck,
    "Addition": _addition,
    "Product": _product,
    "Quotient": _quotient,
    "Fraction": lambda n: rf"\frac{{{_numerator(n.above)}}}{{{latex(n.below)}}}",
    "Root": _root,
    "Call": _call,
    "Section": _section,
    "BigOperator": _big,
    "Differential": _differential,
    "Integral": _integral,
    "Derivative": _derivative,
    "Matrix": _matrix,
    "Cases": _cases,
    "Relation": lambda n: _joined(n.members, [_sign(x) for x in n.signs], SUM),
    "Sequence": _sequence,
    "Implication": lambda n: _joined(n.items, [_sign(x) for x in n.signs], SEQUENCE),
    "Rows": lambda n: r" \\ ".join(_write(r, IMPLICATION) for r in n.rows),
}
