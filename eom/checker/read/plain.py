"""Syntax trees as plain text for a terminal: Unicode, one line, every bracket that is needed.

It is for people to read; what must read again is written by `eom.checker.read.writing`.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable
from typing import Any

from eom.checker.read import syntax as s
from eom.checker.read.latex import CHARACTERS, COMBINING

_LETTERS = {names[0]: c for c, names in reversed(CHARACTERS.items())}
_COMBINING = {name: c for c, name in reversed(COMBINING.items())}
_MARKS = {"times": "×", "bullet": "•", "circ": "∘", "prime": "′", "ast": "*"}
_PRODUCTS = {"": " ", "dot": " · ", "cross": " × ", "tensor": " ⊗ ", "double dot": " : "}
_SIGNS = {":=": "≜", "!=": "≠", "<=": "≤", ">=": "≥", "equiv": "≡", "implies": "⇒", "to": "→"}


def plain(node: s.Node) -> str:
    """Return a tree as one line of text."""
    return _TABLE[type(node).__name__](node)


def _tight(node: s.Node) -> str:
    """Write a part of a product or script: sums and chains in brackets."""
    loose = isinstance(node, s.Addition | s.Relation | s.Sequence | s.Quotient | s.Fraction)
    loose = loose or (isinstance(node, s.Product) and node.operator != "")
    return f"({plain(node)})" if loose else plain(node)


def _symbol(node: s.Symbol) -> str:
    return _LETTERS.get(node.name, node.name)


def _accent(node: s.Accent) -> str:
    base = plain(node.base)
    mark = _COMBINING.get(node.mark)
    if len(base) <= 2 and mark is not None:
        return unicodedata.normalize("NFC", base + mark)
    return f"{node.mark}({base})"


def _script(sign: str, node: s.Node | None) -> str:
    if node is None:
        return ""
    text = plain(node).replace(" ", "")
    return f"{sign}{text}" if len(text) == 1 else f"{sign}{{{text}}}"


def _scripts(node: s.Scripts) -> str:
    left = _script("^", node.presup) + _script("_", node.presub)
    if isinstance(node.sup, s.Marks) and node.sub is None:
        return f"{left}{_tight(node.base)}{plain(node.sup)}"
    return f"{left}{_tight(node.base)}{_script('_', node.sub)}{_script('^', node.sup)}"


def _addition(node: s.Addition) -> str:
    text = ""
    for sign, term in zip(node.signs, node.terms, strict=True):
        inner = f"({plain(term)})" if isinstance(term, s.Addition | s.Relation) else plain(term)
        text += f" {sign} {inner}" if text else f"{sign}{inner}"
    return text


def _chain(items: tuple[s.Node, ...], signs: tuple[s.Sign, ...]) -> str:
    parts = [plain(items[0])]
    for sign, item in zip(signs, items[1:], strict=True):
        parts += [_SIGNS.get(sign.name, sign.name), plain(item)]
    return " ".join(p for p in parts if p)


def _sequence(node: s.Sequence) -> str:
    text = plain(node.items[0])
    for separator, item in zip(node.separators, node.items[1:], strict=True):
        text += {"quad": "   ", "": " "}.get(separator, f"{separator} ") + plain(item)
    return text


def _derivative(node: s.Derivative) -> str:
    d = "∂" if node.sign == "partial" else "d"
    order = _script("^", node.order)
    frame = _script("^", node.frame)
    below = "".join(f" {d}{_tight(v)}" for v in node.variables).strip()
    operand = f" {_tight(node.operand)}" if node.operand is not None else ""
    return f"{frame}{d}{order}/{below}{order}{operand}"


def _integral(node: s.Integral) -> str:
    bounds = _script("_", node.lower) + _script("^", node.upper)
    inside = f" {plain(node.integrand)}" if node.integrand is not None else ""
    signs = {"int": "∫", "iint": "∬", "iiint": "∭", "oint": "∮"}
    return signs[node.sign] + bounds + inside + "".join(f" d{_tight(v)}" for v in node.variables)


def _big(node: s.BigOperator) -> str:
    sign = {"sum": "Σ", "prod": "Π"}.get(node.sign, node.sign)
    return f"{sign}{_script('_', node.lower)}{_script('^', node.upper)} {plain(node.body)}"


def _table(rows: tuple[tuple[s.Node, ...], ...]) -> str:
    return "; ".join(", ".join(plain(c) for c in row) for row in rows)


def _call(node: s.Call) -> str:
    scripts = _script("_", node.sub) + _script("^", node.sup)
    group = isinstance(node.argument, s.Group)
    return f"{node.function}{scripts}{'' if group else ' '}{_tight(node.argument)}"


def _section(node: s.Section) -> str:
    sign = _PRODUCTS.get(node.operator, node.operator).strip()
    return f"{plain(node.operand)} {sign}" if node.left else f"{sign} {plain(node.operand)}"


def _over(node: s.Over) -> str:
    script = node.above if node.above is not None else node.below
    return f"{plain(node.base)}[{plain(script)}]" if script is not None else plain(node.base)


_TABLE: dict[str, Callable[[Any], str]] = {
    "Number": lambda n: n.text,
    "Symbol": _symbol,
    "Words": lambda n: {"forall": "for all", "exists": "there is"}.get(n.sign, n.text.strip()),
    "Dots": lambda _: "…",
    "Blank": lambda _: "·",
    "Missing": lambda _: "",
    "Marks": lambda n: "".join(_MARKS.get(m, m) for m in n.names),
    "Accent": _accent,
    "Scripts": _scripts,
    "Over": _over,
    "Operation": lambda n: _PRODUCTS.get(n.name, n.name).strip(),
    "Group": lambda n: f"{n.open}{plain(n.body)}{n.close}" if n.open else _tight(n.body),
    "Evaluated": lambda n: f"{_tight(n.base)}|{_script('_', n.sub)}{_script('^', n.sup)}",
    "Braced": lambda n: _tight(n.body),
    "Boxed": lambda n: plain(n.body),
    "Struck": lambda n: plain(n.body),
    "Addition": _addition,
    "Product": lambda n: _PRODUCTS.get(n.operator, f" {n.operator} ").join(map(_tight, n.factors)),
    "Quotient": lambda n: f"{_tight(n.left)}/{_tight(n.right)}",
    "Fraction": lambda n: f"{_tight(n.above)}/{_tight(n.below)}",
    "Root": lambda n: f"{_script('^', n.degree)}√({plain(n.body)})",
    "Call": _call,
    "Section": _section,
    "BigOperator": _big,
    "Differential": lambda n: ("∂" if n.sign == "partial" else "d") + _tight(n.variable),
    "Integral": _integral,
    "Derivative": _derivative,
    "Matrix": lambda n: f"[{_table(n.rows)}]",
    "Cases": lambda n: f"{{{_table(n.rows)}",
    "Relation": lambda n: _chain(n.members, n.signs),
    "Sequence": _sequence,
    "Implication": lambda n: _chain(n.items, n.signs),
    "Rows": lambda n: "\n".join(map(plain, n.rows)),
}
