r"""Syntax trees as boxes: their LaTeX reads again as the same tree, their MathML is for pages.

Each row knows its own layer and those of its parts; a part that is looser than its place gets
brackets, so that changed trees can be written as well (they read again with those brackets).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

from eom.checker.read import latex as tables
from eom.checker.read import syntax as s
from eom.checker.read.spans import Span
from eom.checker.read.symbol_shape import Labels, Look
from eom.typeset.boxes import (
    Accent,
    Box,
    Fence,
    Form,
    Fraction,
    Grid,
    Row,
    Scripts,
    Sign,
)
from eom.typeset.markup import render, styled

ROWS, IMPLICATION, SEQUENCE, RELATION, SUM, LOOSE, TIGHT, RUN, ATOM = range(9)
"""Layers from loose to tight."""


@dataclass(frozen=True)
class Blamed(s.Node):
    """A ``body`` that is at fault."""

    body: s.Node


def latex(node: s.Node) -> str:
    """Return a tree as LaTeX."""
    return render(box(node), "latex")


def box(node: s.Node) -> Box:
    """Return a tree as a box."""
    return _write(node, ROWS)


def at_fault(node: s.Node, spans: Iterable[Span]) -> s.Node:
    """Return a tree in which the largest parts within the ``spans`` are `Blamed`."""
    places = tuple(spans)
    found = {id(n) for n in _within(node, places)} if places else set()
    return s.transform(node, lambda n: Blamed(n, span=n.span) if id(n) in found else n)


def _within(node: s.Node, spans: tuple[Span, ...]) -> list[s.Node]:
    if any(p.start <= node.span.start < node.span.stop <= p.stop for p in spans):
        return [node]
    return [n for c in s.children(node) for n in _within(c, spans)]


def _write(node: s.Node, layer: int) -> Box:
    own = _layer(node)
    if own < layer and isinstance(node, s.Rows):
        return replace(_aligned(node), environment="aligned")
    inner = _TABLE[type(node).__name__](node)
    return inner if own >= layer else Fence(inner)


_CHARACTERS = {
    **{name: c for c, name in reversed(tables.CHARACTERS.items())},
    **dict(
        zip(
            "le ge notin subset cong leftrightarrow Leftarrow hookrightarrow div ominus boxtimes "
            "coprod bigoplus bigotimes bigcup bigcap bigwedge ast Re Im wp aleph imath jmath degree "
            "angle triangle square Box diamond emptyset varnothing complement varepsilon varpi "
            "varphi dagger ddagger prime bot odotsign earth sun clubsuit digamma quad "
            "varDelta varGamma varOmega varTheta varPhi varPsi varLambda varSigma".split(),
            "≤≥∉⊂≅↔⇐↪÷⊖⊠∐⨁⨂⋃⋂⋀∗ℜℑ℘ℵıȷ°∠△□□⋄∅∅∁εϖφ†‡′⊥⊙⊕⊙♣ϝ\u2003ΔΓΩΘΦΨΛΣ",
            strict=True,
        )
    ),
}
"""Commands as characters."""


def _mark(latex: str, tag: str = "mo") -> Sign:
    """Return a sign by its command."""
    return Sign(latex, _CHARACTERS.get(latex.removeprefix("\\"), latex.strip("\\")), tag)


def _kept(*parts: Box) -> Box:
    return Form("braces", parts)


def _spaced(*parts: Box | None) -> Box:
    return Row(tuple(p for p in parts if p is not None), " ")


def _scripted(base: Box, sub: s.Node | None, sup: s.Node | None, *, stacked: bool = False) -> Box:
    """Return a box with scripts on its right, or as it is without."""
    lower, upper = (None if n is None else _script(n) for n in (sub, sup))
    if lower is upper is None:
        return base
    return Scripts(base, sub=lower, sup=upper, stacked=stacked)


_LAYERS: dict[str, int] = {
    "Rows": ROWS,
    "Implication": IMPLICATION,
    "Sequence": SEQUENCE,
    "Relation": RELATION,
    "Addition": SUM,
    "Section": LOOSE,
    **dict.fromkeys(("Quotient", "BigOperator", "Integral", "Derivative"), RUN),
    **dict.fromkeys(("Call", "Differential", "Operation"), RUN),
}


def _layer(node: s.Node) -> int:
    if isinstance(node, Blamed):
        return _layer(node.body)
    if isinstance(node, s.Product):
        if node.operator in tables.LOOSE_PRODUCTS:
            return LOOSE
        return TIGHT if node.operator else RUN
    return _LAYERS.get(type(node).__name__, ATOM)


# -- statements ----------------------------------------------------------------------------------


def _joined(items: tuple[s.Node, ...], signs: Iterable[Box], layer: int) -> Row:
    parts = [_write(items[0], layer)]
    for sign, item in zip(signs, items[1:], strict=True):
        parts += [sign, _write(item, layer)]
    return Row(tuple(parts), " ")


def _sign(node: s.Sign) -> Box:
    sign = _mark(s.RELATIONS.get(node.name) or s.ARROWS[node.name])
    return Form("over", (sign, box(node.above))) if node.above else sign


def _sequence(node: s.Sequence) -> Box:
    room = "\u2003" if any(isinstance(n, s.Relation) for n in node.items) else "\u2009"
    signs = (Sign(p, p + room, "mtext") if p != "quad" else _QUAD for p in node.separators)
    return _joined(node.items, signs, RELATION)


_QUAD = _mark(r"\quad")


def _aligned(node: s.Rows) -> Grid:
    """Return rows that stand below one another with their relations."""
    return Grid(tuple(_cells(_write(r, IMPLICATION), r) for r in node.rows), "")


def _cells(written: Box, node: s.Node) -> tuple[Box, ...]:
    if not isinstance(node, s.Relation) or not isinstance(written, Row):
        return (written,)
    return written.items[0], Row(written.items[1:], " ")


# -- operations ----------------------------------------------------------------------------------


def _plus(sign: str) -> Sign:
    return Sign({"±": r"\pm", "∓": r"\mp"}.get(sign, sign), sign.replace("-", "−"))


def _addition(node: s.Addition) -> Box:
    parts: list[Box] = []
    for k, (sign, term) in enumerate(zip(node.signs, node.terms, strict=True)):
        written = _after_sign(term, LOOSE) if sign else _write(term, LOOSE)
        last = k == len(node.terms) - 1
        parts += [_plus(sign)] if sign else []
        parts.append(written if last or not _endless(term) else Fence(written))
    return _spaced(*parts)


def _product(node: s.Product) -> Row:
    if not node.operator:
        return _juxtaposed(node.factors)
    loose = node.operator in tables.LOOSE_PRODUCTS
    parts: list[Box] = []
    for k, factor in enumerate(node.factors):
        written = _operand(factor, TIGHT if loose else RUN, first=k == 0, outer=node.operator)
        last = k == len(node.factors) - 1
        parts += [_mark(s.PRODUCTS[node.operator])] if k else []
        parts.append(written if last or not _spans(factor) else Fence(written))
    return Row(tuple(parts), " ")


def _operand(node: s.Node, layer: int, *, first: bool, outer: str) -> Box:
    """Write an operand; a product of the same layer may begin one with another operator."""
    if first and isinstance(node, s.Product) and node.operator != outer:
        return _write(node, layer - 1)
    return _write(node, layer) if first else _after_sign(node, layer)


def _after_sign(node: s.Node, layer: int) -> Box:
    """Write an operand behind a sign or operator: one of its own may stand at its beginning."""
    if isinstance(node, s.Addition) and len(node.terms) == 1 and node.signs[0]:
        return _spaced(_plus(node.signs[0]), _after_sign(node.terms[0], RUN))
    own = _layer(node)
    product = isinstance(node, s.Product) and node.operator and own >= layer
    if isinstance(node, s.Product) and product and not _spans(node.factors[0]):
        return Row((_after_sign(node.factors[0], own), *_product(node).items[1:]), " ")
    return _write(node, layer)


def _juxtaposed(factors: tuple[s.Node, ...]) -> Row:
    parts: list[Box] = []
    for k, factor in enumerate(factors):
        inner = isinstance(factor, s.Product) and not factor.operator
        quotient = isinstance(factor, s.Quotient) and k > 0
        written = _write(factor, ATOM if inner or quotient else RUN)
        if (k < len(factors) - 1 or isinstance(factor, s.Differential)) and not inner:
            written = _closed(factor, written)
        parts.append(written)
    return Row(tuple(parts), " ")


def _is_d(node: s.Node) -> bool:
    """Whether a symbol would be read as the sign of a derivative or differential."""
    return isinstance(node, s.Symbol) and node.name in {"d", "partial"}


def _closed(node: s.Node, written: Box) -> Box:
    """Keep a factor from taking in the next one: by braces, or brackets for a sum."""
    if _spans(node):
        return Fence(written)
    bare = isinstance(node, s.Call) and not isinstance(node.argument, s.Group)
    bare = bare or (isinstance(node, s.Derivative) and node.operand is None)
    return _kept(written) if bare or _is_d(node) or isinstance(node, s.Differential) else written


def _numerator(node: s.Node) -> Box:
    """Write what stands above; a d alone must not make a derivative."""
    return _kept(box(node)) if _is_d(node) else box(node)


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


def _spans(node: s.Node | None, ends: tuple[type[s.Node], ...] = (s.BigOperator,)) -> bool:
    """Whether the operators behind a node would be read as part of it; ``ends``: nodes that do so."""
    while node is not None and not isinstance(node, ends):
        if isinstance(node, s.Integral) and not node.variables:
            return True
        node = _last_part(node)
    return node is not None


def _endless(node: s.Node | None) -> bool:
    """Whether even a sum behind a node would be read as part of it."""
    return _spans(node, ())


def _quotient(node: s.Quotient) -> Box:
    left = _write(node.left, RUN)
    if not isinstance(node.left, s.Product | s.Quotient) or _spans(node.left):
        left = _closed(node.left, left)
    right = _write(node.right, ATOM if isinstance(node.right, s.Product | s.Quotient) else RUN)
    return _spaced(left, _mark("/"), _kept(right) if _is_d(node.right) else right)


def _section(node: s.Section) -> Box:
    sign = _mark(s.PRODUCTS[node.operator])
    if not node.left:
        return _spaced(sign, _write(node.operand, RUN))
    loose = node.operator in tables.LOOSE_PRODUCTS
    inner = isinstance(node.operand, s.Product) and node.operand.operator != ""
    return _spaced(_write(node.operand, LOOSE if loose else TIGHT if inner else RUN), sign)


# -- prefix forms --------------------------------------------------------------------------------


_TIGHT = {"prime", "ast", "sim"}


def _script(node: s.Node) -> Box:
    return _letters(node) or box(node)


def _marks(node: s.Marks) -> Box:
    parts = (rf"\{n}" + " " * (n not in _TIGHT) if n.isalpha() else n for n in node.names)
    return Sign("".join(parts).strip(), "".join(_CHARACTERS.get(n, n) for n in node.names))


def _letters(node: s.Node) -> Box | None:
    """Write plain letters of a script beside one another, as words are; None for anything else."""
    parts = node.factors if isinstance(node, s.Product) and not node.operator else ()
    plain = all(isinstance(p, s.Symbol) and not p.style and len(p.name) == 1 for p in parts)
    return Row(tuple(map(box, parts))) if parts and plain else None


def _big(node: s.BigOperator) -> Box:
    sign = _scripted(_mark(rf"\{node.sign}"), node.lower, node.upper, stacked=True)
    return _spaced(sign, _after_sign(node.body, LOOSE))


def _integral(node: s.Integral) -> Box:
    sign = _scripted(_mark(rf"\{node.sign}"), node.lower, node.upper)
    inside = None if node.integrand is None else _write(node.integrand, SUM)
    thin = Sign(r"\,", "\u2009", "mtext")
    below = [part for v in node.variables for part in (thin, _D["d"], _variable(v))]
    return _spaced(sign, inside, *below)


_D = {"d": Sign(r"\mathrm{d}", "d", "normal"), "partial": Sign(r"\partial", "∂")}


def _d(node: s.Differential | s.Derivative) -> Box:
    return _scripted(_D["partial" if node.sign == "partial" else "d"], None, node.order)


def _variable(node: s.Node) -> Box:
    plain = isinstance(node, s.Symbol | s.Scripts | s.Accent)
    return box(node) if plain else _kept(box(node))


def _derivative(node: s.Derivative) -> Box:
    sign = _D["partial" if node.sign == "partial" else "d"]
    single = node.order if len(node.variables) == 1 else None
    below = _spaced(
        *(part for v in node.variables for part in (sign, _scripted(_variable(v), None, single)))
    )
    behind = isinstance(node.operand, s.Group) and node.operand.open in {"(", "["}
    apart = node.operand is None or (behind and node.form == "before")
    operand = None if node.operand is None else _write(node.operand, ROWS if apart else LOOSE)
    above = _d(node) if apart else _spaced(_d(node), operand)
    written: Box = Fraction(above, below)
    if node.frame is not None:
        written = Scripts(written, left=_script(node.frame))
    return _spaced(written, operand) if apart else written


def _call(node: s.Call) -> Box:
    known = node.function in tables.COMMAND_FUNCTIONS
    name = rf"\{node.function}" if known else rf"\operatorname{{{node.function}}}"
    argument = box(node.argument)
    if isinstance(node.argument, s.Differential):
        argument = _kept(argument)
    elif not _is_bare(node.argument):
        argument = _write(node.argument, ATOM + 1)
    function = Sign(name, f"\u2009{node.function}\u2009", "mi")
    return _spaced(_scripted(function, node.sub, node.sup), argument)


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

_FONTS = {style: command for command, style in reversed(tables.FONTS.items())}


def _symbol(node: s.Symbol) -> Box:
    command = node.name in tables.SYMBOLS or node.name == "partial"
    text = rf"\{node.name}" if command else node.name
    font = "boldsymbol" if node.style == "bold" and command else _FONTS[node.style]
    if node.style or not (command or len(text) == 1):
        text = rf"\{font}{{{text}}}"
    shown = styled(node.name, node.style)
    shown = _CHARACTERS.get(shown, shown) if command else shown
    return Sign(text, shown, "normal" if node.style == "roman" else "mi")


def _scripts(node: s.Scripts) -> Box:
    parts = (node.sub, node.sup, node.presup, node.presub)
    sub, sup, left, below = (None if n is None else _script(n) for n in parts)
    return Scripts(_base(node.base), sub, sup, left, below)


def _base(node: s.Node) -> Box:
    written = _write(node, RUN)
    if isinstance(node, s.Product | s.Quotient | s.BigOperator | s.Integral):
        return Fence(written)
    plain = isinstance(node, s.Symbol | s.Number | s.Group | s.Accent | s.Matrix | s.Words)
    long = isinstance(node, s.Number) and len(node.text) > 1
    return written if plain and not long and not _is_d(node) else _kept(written)


def _accent(node: s.Accent) -> Box:
    sign = {"bullet": r"\bullet", "circle": r"\circ", "prime_over": r"\prime"}.get(node.mark)
    return (
        Form("over", (box(node.base), _mark(sign))) if sign else Accent(node.mark, box(node.base))
    )


def _braced(node: s.Braced) -> Box:
    scripts = (node.label, None) if node.mark == "underbrace" else (None, node.label)
    return _scripted(Form(node.mark, (box(node.body),)), *scripts, stacked=True)


def _rows(rows: tuple[tuple[s.Node, ...], ...]) -> tuple[tuple[Box, ...], ...]:
    return tuple(tuple(map(box, row)) for row in rows)


def _matrix(node: s.Matrix) -> Box:
    columns = node.columns or "c" * max((len(r) for r in node.rows), default=1)
    specified = node.environment in tables.WITH_SPECIFICATION
    return Grid(_rows(node.rows), node.environment, columns if specified else "")


def _form(name: str, *parts: s.Node | None) -> Box:
    return Form(name, tuple(box(p) for p in parts if p is not None))


def _words(node: s.Words) -> Box:
    if node.sign:
        return _mark(rf"\{node.sign}")
    return Sign(rf"\text{{{node.text}}}", node.text, "mtext")


_TABLE: dict[str, Callable[[Any], Box]] = {
    "Number": lambda n: Sign(n.text, n.text, "mn"),
    "Symbol": _symbol,
    "Words": _words,
    "Dots": lambda n: _mark(rf"\{n.name}"),
    "Blank": lambda _: _mark(r"\cdot"),
    "Missing": lambda _: Row(()),
    "Marks": _marks,
    "Sign": _sign,
    "Accent": _accent,
    "Scripts": _scripts,
    "Over": lambda n: Form(
        "over" if n.above else "under", (box(n.base), _script(n.above or n.below))
    ),
    "Operation": lambda n: _mark(s.PRODUCTS[n.name]),
    "Group": lambda n: Fence(box(n.body), n.open, n.close) if n.open else _kept(box(n.body)),
    "Evaluated": lambda n: _scripted(Fence(box(n.base), ".", "|"), n.sub, n.sup),
    "Braced": _braced,
    "Boxed": lambda n: _form("boxed", n.body),
    "Struck": lambda n: _form("cancelto" if n.to else "cancel", n.body, n.to),
    "Addition": _addition,
    "Product": _product,
    "Quotient": _quotient,
    "Fraction": lambda n: Fraction(_numerator(n.above), box(n.below)),
    "Root": lambda n: _form("degree" if n.degree else "root", n.body, n.degree),
    "Call": _call,
    "Section": _section,
    "BigOperator": _big,
    "Differential": lambda n: _spaced(_d(n), _variable(n.variable)),
    "Integral": _integral,
    "Derivative": _derivative,
    "Matrix": _matrix,
    "Cases": lambda n: Grid(_rows(n.rows), "cases" if n.side == "left" else "rcases"),
    "Relation": lambda n: _joined(n.members, map(box, n.signs), SUM),
    "Sequence": _sequence,
    "Implication": lambda n: _joined(n.items, map(box, n.signs), SEQUENCE),
    "Rows": _aligned,
    "Blamed": lambda n: _form("blamed", n.body),
}


# -- looks ---------------------------------------------------------------------------------------------

_SHAPES = {"cal": "mathcal", "bb": "mathbb", "frak": "mathfrak"}


def latex_of(look: Look) -> str:
    """Return a look as LaTeX that reads as the same look."""
    style = "roman" if len(look.name) > 1 and not _is_command(look.name) else ""
    at = look.sub.index("(") if "(" in look.sub else len(look.sub)
    words, behind = _label_words(look.sub[:at]), _label_words(look.sub[at:])
    node: s.Node = s.Symbol(look.name, look.style or style)
    for accent in look.accents:
        node = s.Accent(accent, node)
    nucleus = latex(node)
    if not look.name:
        nucleus = reduce(lambda inner, accent: rf"\{accent}{{{inner}}}", look.accents, words)
        words = ""
    before = f"{{}}^{{{_label_words(look.presup)}}}" if look.presup else ""
    below = f"_{{{words}}}" if words else ""
    above = f"^{{{_label_words(look.sup)}}}" if look.sup else ""
    return before + nucleus + below + above + behind


def _is_command(name: str) -> bool:
    return name in tables.SYMBOLS or name in tables.SCRIPT_MARKS


def _label_words(words: Labels) -> str:
    return " ".join(map(_label_word, words))


def _label_word(word: str) -> str:
    for mark in "^_":
        base, found, rest = word.partition(mark)
        if found and base:
            return f"{_label_word(base)}{mark}{{{_label_word(rest)}}}"
    shape, _, letter = word.partition(" ")
    if shape in _SHAPES and letter:
        return rf"\{_SHAPES[shape]}{{{letter}}}"
    return f"\\{word}" if _is_command(word) else word
