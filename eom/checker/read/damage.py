r"""A second way to read what a scan or a hurry has damaged: named rules, each reported.

The literal reading always stands; `variants` offers another one where a rule fits. No rule changes a
sign of mathematics (a dot, a factor, a term): only where a glyph stands, or what a glyph is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from eom.checker.read import latex
from eom.checker.read.grammar import Reading, read_tokens
from eom.checker.read.scripts import juxtaposed, spliced
from eom.checker.read.spans import ReadingError, Source, Span
from eom.checker.read.syntax import (
    Accent,
    Derivative,
    Differential,
    Fraction,
    Integral,
    Marks,
    Matrix,
    Node,
    Number,
    Operation,
    Over,
    Product,
    Scripts,
    Section,
    Symbol,
    transform,
)
from eom.checker.read.tokens import Token

FRAME_STYLES = frozenset({"calligraphic"})


@dataclass(frozen=True)
class Repair:
    """What was read otherwise: the name of the rule, in words, and where."""

    name: str
    text: str
    span: Span


@dataclass(frozen=True)
class Variant:
    """Another reading of a formula and the repairs that led to it."""

    reading: Reading
    repairs: tuple[Repair, ...]


Rule = Callable[[Node], Node | None]


# -- rules on the tree ---------------------------------------------------------------------------


def _left_script_on_the_line(node: Node) -> Node | None:
    r"""Read ``\mathcal{I} \omega^{\mathcal{B}}`` as a script on the left."""
    if not isinstance(node, Product) or node.operator:
        return None
    factors: list[Node] = []
    for factor in node.factors:
        before = factors[-1] if factors else None
        if _is_frame(before) and _takes_frame(factor) and isinstance(factor, Scripts):
            span = factor.span.join(before.span) if before is not None else factor.span
            factors[-1] = replace(factor, presup=before, span=span)
        else:
            factors.append(factor)
    if len(factors) == len(node.factors):
        return None
    return factors[0] if len(factors) == 1 else replace(node, factors=tuple(factors))


def _is_frame(node: Node | None) -> bool:
    return isinstance(node, Symbol) and node.style in FRAME_STYLES


def _takes_frame(node: Node) -> bool:
    return (
        isinstance(node, Scripts)
        and _is_frame(node.sup)
        and node.presup is None
        and not _is_frame(node.base)
    )


def _base_in_the_subscript(node: Node) -> Node | None:
    r"""Read ``\mathcal{I}_{\omega}^{\mathcal{B}}`` as omega with frames on both sides."""
    if not isinstance(node, Scripts) or not _is_frame(node.base) or not _is_frame(node.sup):
        return None
    if not isinstance(node.sub, Symbol | Accent) or _is_frame(node.sub) or node.presup is not None:
        return None
    return Scripts(node.sub, None, node.sup, None, node.base, span=node.span)


def _derivative_without_d(node: Node) -> Node | None:
    r"""Read ``\frac{B}{dt}`` as the derivative in frame B, applied to what follows."""
    if isinstance(node, Product) and not node.operator:
        for k, factor in enumerate(node.factors[:-1]):
            operator = _bare_operator(factor)
            if operator is not None:
                rest = node.factors[k + 1 :]
                alone = len(rest) == 1 or type(rest[0]).__name__ == "Group"
                taken = rest[0] if alone else replace(node, factors=rest)
                applied = replace(operator, operand=taken, form="before")
                left = (*node.factors[:k], applied, *(rest[1:] if alone else ()))
                return left[0] if len(left) == 1 else replace(node, factors=left)
    return None


def _bare_operator(node: Node) -> Derivative | None:
    if not isinstance(node, Fraction) or not isinstance(node.below, Differential):
        return None
    above = node.above
    upright = isinstance(above, Symbol) and above.name.isupper() and above.name.isalpha()
    if not upright:
        return None
    return Derivative(None, (node.below.variable,), frame=above, outside=True, span=node.span)


_DOTS = {"dot": 1, "ddot": 2, "dddot": 3}


def _raised_dots(node: Node) -> Node | None:
    r"""Read ``r_O \ddot{\bullet}`` as ``r_O^{\bullet\bullet}``."""
    if not isinstance(node, Product) or node.operator:
        return None
    factors: list[Node] = []
    for factor in node.factors:
        count = _bullets(factor)
        if count and factors and not _has_sup(factors[-1]):
            factors[-1] = _raised(factors[-1], Marks(("bullet",) * count, span=factor.span))
        else:
            factors.append(factor)
    if len(factors) == len(node.factors):
        return None
    return factors[0] if len(factors) == 1 else replace(node, factors=tuple(factors))


def _bullets(node: Node) -> int:
    bullet = isinstance(node, Accent) and node.base == Symbol("bullet")
    return _DOTS.get(node.mark, 0) if bullet and isinstance(node, Accent) else 0


def _has_sup(node: Node) -> bool:
    return isinstance(node, Scripts) and node.sup is not None


def _raised(node: Node, mark: Marks) -> Node:
    span = node.span.join(mark.span)
    if isinstance(node, Scripts) and node.sup is None:
        return replace(node, sup=mark, span=span)
    return Scripts(node, None, mark, span=span)


def _circle_on_an_operator(node: Node) -> Node | None:
    r"""Read ``\rho \overset{0}{\cdot}`` as ``\rho^\circ``."""
    if not isinstance(node, Product) or node.operator:
        return None
    last, before = node.factors[-1], node.factors[-2]
    zero = isinstance(last, Over) and isinstance(last.base, Operation)
    if not zero or not isinstance(last, Over) or _has_sup(before):
        return None
    names: dict[Node | None, str] = {Number("0"): "circ", Symbol("o"): "circ", Symbol("O"): "circ"}
    mark = names.get(last.above)
    if mark is None:
        return None
    raised = _raised(before, Marks((mark,), span=last.span))
    rest = node.factors[:-2]
    return replace(node, factors=(*rest, raised)) if rest else raised


def _cross_before_a_matrix(node: Node) -> Node | None:
    r"""Read ``a \times b \times`` before ``dm``, or a cross before a matrix, as ``a^\times b^\times``."""
    if isinstance(node, Integral) and isinstance(node.integrand, Section):
        section = node.integrand
        if section.operator != "cross" or not section.left:
            return None
        inner = section.operand
        crossed = isinstance(inner, Product) and inner.operator == "cross"
        parts = inner.factors if crossed and isinstance(inner, Product) else (inner,)
        factors = [f for part in parts for f in _crossed(part)]
        return replace(node, integrand=juxtaposed(factors, section.span))
    if isinstance(node, Product) and node.operator == "cross":
        many = len(node.factors) > 2 or isinstance(node.factors[-1], Matrix)
        return cross_before_column(node) if many else None
    return None


def _crossed(node: Node) -> list[Node]:
    """Return factors with a cross on the last one."""
    *first, last = spliced(node)
    return [*first, _raised(last, Marks(("times",), span=last.span))]


def cross_before_column(node: Node) -> Node | None:
    r"""Read any ``a \times b`` as ``a^\times b``: for notes whose letters are columns and matrices."""
    if isinstance(node, Product) and node.operator == "cross":
        *first, last = node.factors
        factors = [f for part in first for f in _crossed(part)]
        return juxtaposed([*factors, *spliced(last)], node.span)
    return None


RULES: tuple[tuple[str, str, Rule], ...] = (
    ("left script on the line", "a frame on the line read as a script on the left",
     _left_script_on_the_line),
    ("base in the subscript", "a quantity below its frame read as the base", _base_in_the_subscript),
    ("derivative without d", "a frame over dt read as the derivative in that frame",
     _derivative_without_d),
    ("raised dots", "dots over a bullet on the line read as bullets above", _raised_dots),
    ("circle over an operator", "a zero over a dot read as a circle above", _circle_on_an_operator),
    ("cross as a script", "a cross without a vector behind it read as a superscript",
     _cross_before_a_matrix),
)  # fmt: skip
"""Rules that fit damage alone: name, in words, what a node becomes (None: it stays)."""


def apply(
    tree: Node, rules: tuple[tuple[str, str, Rule], ...] = RULES
) -> tuple[Node, tuple[Repair, ...]]:
    """Return the tree after all rules, and what they did."""
    done: list[Repair] = []

    def rule(node: Node) -> Node:
        for name, text, change in rules:
            changed = change(node)
            if changed is not None:
                done.append(Repair(name, f"read as: {text}", node.span))
                node = changed
        return node

    return transform(tree, rule), tuple(done)


# -- rules on the tokens -------------------------------------------------------------------------


def glued_lines(tokens: list[Token]) -> tuple[list[Token], tuple[Repair, ...]]:
    """Part lines of the source that are statements of their own and were run together.

    A line is one if it holds a relation and does not begin with a relation or an operator, if the
    line before it holds one too, and if no bracket or environment is open.
    """
    found: list[Token] = []
    done: list[Repair] = []
    depth = 0
    relation = False
    for k, token in enumerate(tokens):
        starts = token.lined and depth == 0 and relation and not _goes_on(tokens[k - 1])
        starts = starts and _begins_statement(tokens, k)
        if starts:
            found.append(Token("row", "", token.span, lined=True))
            done.append(Repair("glued lines", "read as: two statements on two lines", token.span))
            relation = False
        depth += _opening(token)
        relation = relation or (depth == 0 and token.is_relation)
        found.append(token)
    return found, tuple(done)


def _opening(token: Token) -> int:
    if token.kind in {"begin", "end"}:
        return 1 if token.kind == "begin" else -1
    if token.kind == "char" and token.text in "{}()[]":
        return 1 if token.text in "{([" else -1
    return 0


_OPERATORS = frozenset({*latex.PRODUCT_COMMANDS, *latex.SUM_COMMANDS, *latex.ARROW_COMMANDS})


def _goes_on(token: Token) -> bool:
    """Whether a line cannot end with this token: an operator or a relation."""
    return token.is_relation or token.stands_in(_OPERATORS, "+-*/,^_&")


def _begins_statement(tokens: list[Token], k: int) -> bool:
    first = tokens[k]
    if first.kind not in {"letter", "number", "command"} and not first.is_char("{"):
        return False
    if first.is_relation or first.is_command(*_OPERATORS, "right"):
        return False
    depth = 0
    for token in tokens[k:]:
        if token.lined and depth == 0 and token is not first:
            return False
        if depth == 0 and token.is_relation:
            return True
        depth += _opening(token)
        if token.kind in {"row", "quad"} or depth < 0:
            return False
    return False


def variants(source: Source, tokens: list[Token]) -> tuple[Variant, ...]:
    """Return other readings of a formula than the literal one, the most repaired first; often none."""
    parted, lines = glued_lines(tokens)
    readings: list[tuple[Reading, tuple[Repair, ...]]] = []
    for candidate, done in ([(parted, lines)] if lines else []) + [(tokens, ())]:
        try:
            readings.append((read_tokens(source, list(candidate)), done))
        except ReadingError:
            continue
    found: list[Variant] = []
    for reading, done in readings:
        tree, repairs = apply(reading.tree)
        if repairs:
            found.append(Variant(replace(reading, tree=tree), (*done, *repairs)))
        if done:
            found.append(Variant(reading, done))
    return tuple(found)
