r"""From tokens to the syntax tree: a Pratt parser for the formulas of mechanics.

From loose to tight: arrows; items beside each other; relations; sums; dot products; cross and other
products; factors side by side, with quotients on the line. A sum sign spans one term; an integral
ends at its own differential; ``a × b c`` is ``a × (b c)``. Every token is read or is an error; levels
of a chain are read by loops, and the depth of nesting is bounded.

Source: V. R. Pratt, "Top down operator precedence", 1973 (the technique).

Rows of alignments, before parsing: what continues a row is joined to it.

In an alignment ``&`` says where things stand and not what they are, and is left out. A row continues
the one above if a bracket is open, if it begins with ``+`` or a product sign, if it begins with
``-``, or is indented by ``\quad``, and holds no relation, or if ``\right.`` and ``\left.`` stand on both
sides of the break.

Relations and arrows at the cursor, single or made of several characters, with what is above.

What stands at the cursor: operators and factors, in braces of LaTeX or without.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from eom.checker.read import atoms, latex, prefixes, scripts
from eom.checker.read.prefixes import applied, differential_ahead, slash_derivative
from eom.checker.read.scripts import juxtaposed, spliced
from eom.checker.read.spans import Source, Span, reading_error
from eom.checker.read.stream import Note, Stream
from eom.checker.read.syntax import (
    Addition,
    Derivative,
    Implication,
    Missing,
    Node,
    Number,
    Product,
    Quotient,
    Relation,
    Rows,
    Section,
    Sequence,
    Sign,
    Words,
    depth,
)
from eom.checker.read.tokens import Macro, Token, tokenize

_DIGRAPHS: dict[str, str] = {
    "<=>": "equivalent",
    "==>": "implies",
    ":=": ":=",
    "=:": "=:",
    "=>": "implies",
    "->": "to",
    "<=": "<=",
    ">=": ">=",
    "!=": "!=",
    "==": "=",
}
"""Relations and arrows of several characters; the longest comes first."""
_ARROWS = frozenset(latex.ARROW_COMMANDS.values())
STACKED = frozenset({"overset", "stackrel", "underset", "stackbin"})
_DEFINING = frozenset({"def", "Delta", "triangle", "text def", "definition", "d e f"})


def relation_ahead(p: Stream) -> bool:
    """Whether a relation stands at the cursor."""
    name, _ = _sign_ahead(p)
    return bool(name) and name not in _ARROWS


def arrow_ahead(p: Stream) -> bool:
    """Whether an arrow between statements stands at the cursor."""
    name, _ = _sign_ahead(p)
    return name in _ARROWS


def take_sign(p: Stream, script: Callable[[], Node]) -> Sign:
    """Read the relation or arrow at the cursor; ``script`` reads what stands above it."""
    start = p.token.span
    if p.token.is_command(*STACKED):
        return _stacked(p, script)
    if p.token.is_command("xrightarrow", "xRightarrow"):
        name = "to" if p.token.text == "xrightarrow" else "implies"
        p.take()
        return Sign(name, script(), span=p.since(start))
    name, count = _sign_ahead(p)
    for _ in range(count):
        p.take()
    return Sign(name, span=p.since(start))


def _sign_ahead(p: Stream) -> tuple[str, int]:
    """Return the name of the sign at the cursor and its number of tokens, or ("", 0)."""
    token = p.token
    if token.kind == "command":
        return _command(p, token)
    if token.kind != "char" or token.text not in ":=<>-!":
        return "", 0
    text = token.text
    while len(text) < 3 and _adjacent(p, len(text)):
        text += p.ahead(len(text)).text
    for length in (3, 2):
        if len(text) >= length and text[:length] in _DIGRAPHS:
            return _DIGRAPHS[text[:length]], length
    return latex.RELATION_CHARACTERS.get(token.text, ""), 1


def _adjacent(p: Stream, count: int) -> bool:
    token = p.ahead(count)
    return token.kind == "char" and not token.spaced and token.text in "=<>:-"


def _command(p: Stream, token: Token) -> tuple[str, int]:
    if token.text in latex.RELATION_COMMANDS:
        name = latex.RELATION_COMMANDS[token.text]
        if token.text == "vcentcolon" and not p.ahead().is_char("="):
            return "", 0
        return name, 2 if token.text == "vcentcolon" else 1
    if token.text in latex.ARROW_COMMANDS:
        return latex.ARROW_COMMANDS[token.text], 1
    if token.text == "not" and p.ahead().is_char("="):
        return "!=", 2
    if token.text == "not" and p.ahead().is_command("in"):
        return "notin", 2
    if token.text in {"xrightarrow", "xRightarrow"}:
        return ("to" if token.text == "xrightarrow" else "implies"), 1
    if token.text in STACKED:
        return _base_of_stack(p), 1
    return "", 0


def _base_of_stack(p: Stream) -> str:
    r"""Return the relation under (or over) which something stands: the ``=`` of ``\overset{!}{=}``."""
    return _relation_at(p, p.matching(p.place + 1))


def _relation_at(p: Stream, place: int) -> str:
    """Return the relation or arrow at a place, alone or in braces, or ""."""
    token = p.tokens[place]
    if token.is_char("{") and p.matching(place) == place + 3:
        token = p.tokens[place + 1]
    if token.kind == "command":
        return latex.RELATION_COMMANDS.get(token.text, latex.ARROW_COMMANDS.get(token.text, ""))
    return latex.RELATION_CHARACTERS.get(token.text, "") if token.kind == "char" else ""


def _stacked(p: Stream, script: Callable[[], Node]) -> Sign:
    start, name = p.token.span, _base_of_stack(p)
    p.take()
    first = p.place
    above = script()
    if _relation_at(p, p.place) != name:
        raise p.unread()
    letters = (t for t in p.tokens[first : p.place] if t.text not in latex.FONTS | {"{": ""})
    words = "".join(t.text for t in letters).strip("} .")
    p.place = p.matching(p.place)
    if name == "=" and words in _DEFINING:
        return Sign(":=", span=p.since(start))
    return Sign(name, above, span=p.since(start))


def operator_ahead(p: Stream) -> str:
    """Return the name of the product operator at the cursor, or ""."""
    token = p.token
    if token.kind == "command":
        return latex.PRODUCT_COMMANDS.get(token.text, "")
    if token.kind != "char" or relation_ahead(p):
        return ""
    name = latex.PRODUCT_CHARACTERS.get(token.text, "")
    if name == "double dot" and (p.ahead().kind in {"words", "quad", "stop", "row"} or p.script):
        return ""
    return name


def factor_ahead(p: Stream) -> bool:
    """Whether another factor follows side by side."""
    if p.closes() or (p.integrals and differential_ahead(p)):
        return False
    stacked = p.token.is_command(*STACKED)
    if stacked and (relation_ahead(p) or arrow_ahead(p)):
        return False
    return p.starts_atom() and not (p.script and bool(p.bar(p.token)))


def skip_empty(p: Stream) -> None:
    r"""Pass over ``{}`` where it only makes space; take ``{=}`` as ``=``, ``\mathbf{\cdot}`` too."""
    font = int(p.token.is_command(*latex.FONTS))
    opened, inner, behind = p.ahead(font), p.ahead(font + 1), p.ahead(font + 2)
    if opened.is_char("{") and behind.is_char("}") and not inner.is_char("}"):
        saved, p.place = p.place, p.place + font + 1
        if (
            operator_ahead(p)
            or relation_ahead(p)
            or inner.stands_in(latex.SUM_COMMANDS, latex.SUM_SIGNS)
        ):
            p.place += 1
            p.tokens[p.place] = inner
            return
        p.place = saved
    while p.token.is_char("{") and p.ahead().is_char("}"):
        after = p.ahead(2)
        if after.kind == "char" and after.text in "^_'":
            return
        p.place += 2


MAX_TREE_DEPTH = 120
"""Deepest tree: all who walk over it may use recursion."""


@dataclass(frozen=True)
class Reading:
    """A formula that has been read: tree, what was noted, tags with their places."""

    tree: Node
    notes: tuple[Note, ...] = ()
    tags: tuple[tuple[str, Span], ...] = ()


def read_formula(
    text: str | Source,
    start: int = 0,
    body: str | None = None,
    macros: Mapping[str, Macro] | None = None,
) -> Reading:
    r"""Read a formula: a text, or ``body`` that begins at ``start`` in a source.

    Raises `ReadingError` with place and caret where something cannot be read.

    >>> read_formula(r"m \dot v").tree.factors[0]
    Symbol(name='m', style='')
    """
    source = text if isinstance(text, Source) else Source(text)
    body = source.text[start:] if body is None else body
    return read_tokens(source, tokenize(source, body, start, macros))


def read_tokens(source: Source, tokens: list[Token]) -> Reading:
    """Read a formula from its tokens."""
    tags = tuple((t.text, t.span) for t in tokens if t.kind == "tag")
    parser = Parser(source, join_rows([t for t in tokens if t.kind != "tag"]))
    tree = parser.rows()
    if parser.token.kind != "stop":
        raise parser.unread()
    if depth(tree) > MAX_TREE_DEPTH:
        what = "the formula is a chain of too many different operators"
        raise reading_error(source, tree.span, what, expected=f"at most {MAX_TREE_DEPTH} levels")
    return Reading(tree, tuple(parser.notes), tags)


class Parser(Stream):
    """The levels of the grammar from rows to factors; `atoms` and `calculus` hold the rest."""

    def rows(self) -> Node:
        """Read rows up to the end of the formula or environment."""
        start = self.token.span
        found: list[Node] = []
        while True:
            self.skip_quads()
            if self.token.kind not in {"row", "end", "stop"}:
                found.append(self.statements())
            if self.token.kind != "row":
                break
            self.take()
        if not found:
            return Missing(span=start)
        return found[0] if len(found) == 1 else Rows(tuple(found), span=self.since(start))

    def statements(self) -> Node:
        """Read items joined by arrows."""
        start = self.token.span
        leading = arrow_ahead(self)
        items: list[Node] = [Missing(span=start) if leading else self.sequence()]
        arrows: list[Sign] = []
        while arrow_ahead(self):
            arrows.append(take_sign(self, self.above))
            self.skip_quads()
            items.append(Missing(span=self.token.span) if self.closes() else self.sequence())
        if not arrows:
            return items[0]
        return Implication(tuple(items), tuple(arrows), span=self.since(start))

    def above(self) -> Node:
        """Read what stands above a sign."""
        return self.script_argument()

    # items

    def sequence(self) -> Node:
        """Read items beside each other."""
        start = self.token.span
        items, separators = [self.item()], []
        while True:
            separator = self.separator()
            if separator is None or (separator != "" and self.ended()):
                self.only_at_the_end(separator)
                break
            separators.append(separator)
            items.append(self.item())
        if len(items) == 1:
            return items[0]
        return Sequence(tuple(items), tuple(separators), span=self.since(start))

    def only_at_the_end(self, separator: str | None) -> None:
        """Refuse a comma that parts nothing: it may end a row or the formula alone."""
        inside = self.closes() and self.token.kind not in {"stop", "row", "end"}
        inside = inside and not self.token.is_char("&")
        if inside and separator in {",", ";", ":", "|"}:
            raise self.error("something is missing before this")

    def skip_quads(self) -> None:
        """Pass over wide spaces."""
        while self.token.kind == "quad":
            self.place += 1

    def ended(self) -> bool:
        """Whether no further item follows."""
        return self.closes() or arrow_ahead(self)

    def separator(self) -> str | None:
        """Pass over a separator: its name, "" where words follow or end, None where there is none."""
        token = self.token
        if token.is_char(".") and self.sentence_ends():
            self.take()
            return self.separator() or "quad"
        if token.kind == "quad":
            self.skip_quads()
            return self.separator() or "quad"
        if (token.kind == "char" and token.text in ",;:") or (self.script and self.bar(token)):
            if self.bars and not self.script and self.bar(token):
                return None
            self.take()
            self.skip_quads()
            return token.text if token.kind == "char" else "|"
        if self.words_ahead() or (self.place and self.after_words()):
            return None if self.closes() or arrow_ahead(self) else ""
        return None

    def sentence_ends(self) -> bool:
        """Whether the point at the cursor ends a sentence."""
        after = self.ahead()
        return after.kind in {"stop", "row", "quad", "words", "end"} or after.is_char("}")

    def words_ahead(self) -> bool:
        """Whether text or a quantifier stands at the cursor."""
        return self.token.kind == "words" or self.token.is_command("forall", "exists")

    def after_words(self) -> bool:
        """Whether text or a quantifier stands before the cursor."""
        before = self.tokens[self.place - 1]
        return before.kind == "words" or before.is_command("forall", "exists")

    def item(self) -> Node:
        """Read a relation, an expression, or words that stand by themselves."""
        if self.words_ahead() and not self.words_are_operand():
            token = self.take()
            sign = token.text if token.kind == "command" else ""
            return Words("" if sign else token.text, sign, span=token.span)
        if self.token.kind == "char" and self.token.text in ",;":
            raise self.error("something is missing before this")
        return Missing(span=self.token.span) if self.closes() else self.relation()

    def words_are_operand(self) -> bool:
        """Whether words begin an expression: an operator, a relation or a script follows."""
        if self.token.kind != "words":
            return False
        if self.script and self.ahead().is_char("}"):
            return True
        self.place += 1
        found = (
            relation_ahead(self)
            or bool(operator_ahead(self))
            or (self.token.kind == "char" and self.token.text in "+-/^_" and not self.script)
            or self.token.is_command(*latex.SUM_COMMANDS)
        )
        self.place -= 1
        return found

    def relation(self) -> Node:
        """Read a chain of relations; members may be missing at both ends."""
        start = self.token.span
        members: list[Node] = []
        found: list[Sign] = []
        members.append(Missing(span=start) if relation_ahead(self) else self.addition())
        while relation_ahead(self):
            found.append(take_sign(self, self.above))
            self.skip_quads()
            over = self.ended() or (self.token.kind == "char" and self.token.text in ",;")
            again = relation_ahead(self)
            members.append(Missing(span=self.token.span) if over or again else self.addition())
        if not found:
            return members[0]
        if self.depth and not self.script and all(isinstance(m, Missing) for m in members):
            raise self.error("a relation without sides", self.tokens[self.place - 1])
        return Relation(tuple(members), tuple(found), span=self.since(start))

    # sums and products

    def addition(self) -> Node:
        """Read a sum of terms."""
        start = self.token.span
        terms: list[Node] = []
        found: list[str] = []
        while True:
            skip_empty(self)
            sign = self.sum_sign()
            if sign is None and terms:
                break
            found.append(sign or "")
            terms.append(self.term())
        if found == [""]:
            return terms[0]
        return Addition(tuple(terms), tuple(found), span=self.since(start))

    def sum_sign(self) -> str | None:
        """Pass over a sign of a sum and return it; None where there is none."""
        token = self.token
        name = latex.SUM_SIGNS.get(token.text) if token.kind == "char" else None
        if token.kind == "command":
            name = latex.SUM_COMMANDS.get(token.text)
        if name is None or relation_ahead(self):
            return None
        self.take()
        return name

    def term(self) -> Node:
        """Read a product with all its operators."""
        return self.chain(loose=True)

    def chain(self, *, loose: bool) -> Node:
        """Read operands joined by operators of one level; equal operators in a row make one product."""
        start = self.token.span
        operands, operator = [self.operand(loose)], ""
        while (name := operator_ahead(self)) and (name in latex.LOOSE_PRODUCTS) == loose:
            if operator and name != operator:
                operands = [self.product(operands, operator, start)]
            operator = name
            self.take()
            if self.closes() or (self.integrals and differential_ahead(self)):
                return self.section(operands, operator, start)
            operands.append(self.operand(loose))
        return self.product(operands, operator, start) if operator else operands[0]

    def operand(self, loose: bool) -> Node:
        """Read one operand of a product; a sign may stand before it."""
        if loose:
            return self.chain(loose=False)
        start = self.token.span
        sign = self.sum_sign()
        if sign is None:
            return self.run()
        with self.nested(fresh=False):
            return Addition((self.operand(loose=False),), (sign,), span=self.since(start))

    def product(self, operands: list[Node], operator: str, start: Span) -> Node:
        """Return a product; too many factors of a cross are noted."""
        span = self.since(start)
        if operator == "cross" and sum(not isinstance(o, Number) for o in operands) > 2:
            text = "a cross product of more than two factors needs brackets"
            self.note("ambiguous cross", text, span)
        return Product(tuple(operands), operator, span=span)

    def section(self, operands: list[Node], operator: str, start: Span) -> Node:
        """Return an operator whose right operand is missing."""
        whole = operands[0] if len(operands) == 1 else self.product(operands, operator, start)
        return Section(whole, operator, span=self.since(start))

    # factors side by side

    def run(self) -> Node:
        """Read factors side by side."""
        start = self.token.span
        factors = [self.factor()]
        while True:
            skip_empty(self)
            if self.token.is_char("/"):
                factors = [self.quotient(factors, start)]
            elif factor_ahead(self):
                factors += spliced(self.factor())
            else:
                break
        return juxtaposed(factors, self.since(start))

    def quotient(self, factors: list[Node], start: Span) -> Node:
        """Read what stands behind a slash; all factors before it are above."""
        derivative = slash_derivative(self, factors, start)
        if derivative is not None:
            return derivative
        left = juxtaposed(factors, self.since(start))
        slash = self.take()
        right = self.factor()
        number = isinstance(left, Number) and isinstance(right, Number)
        if not number and not self.token.spaced and not self.script and factor_ahead(self):
            text = "a quotient on the line before another factor: brackets would say what is below"
            self.note("slash", text, slash.span)
        return Quotient(left, right, span=self.since(start))

    def factor(self) -> Node:
        """Read one factor, prefix forms included."""
        node = prefixes.prefix(self)
        if node is None:
            node = self.scripted()
        if isinstance(node, Derivative) and node.operand is None:
            return applied(self, node)
        return node

    def scripted(self) -> Node:
        """Read an atom with its scripts."""
        return scripts.scripted(self)

    def atom(self) -> Node:
        """Read an atom without scripts."""
        return atoms.atom(self)

    def starts_atom(self) -> bool:
        """Whether the token at the cursor can begin a factor."""
        return atoms.starts_atom(self)

    def argument(self) -> Node:
        """Read an argument."""
        return scripts.argument(self)

    def script_argument(self) -> Node:
        """Read what stands in a script."""
        return scripts.script_argument(self)


def join_rows(tokens: list[Token]) -> list[Token]:
    """Return the tokens with joined rows; matrices and cases stay as they are."""
    tokens = [_column(tokens, k) for k in range(len(tokens))]
    joiner = _Joiner(tokens)
    for k, token in enumerate(tokens):
        joiner.read(k, token)
    return [t for k, t in enumerate(tokens) if k not in joiner.dropped]


def _column(tokens: list[Token], k: int) -> Token:
    """Return a token; the second of ``&&`` is wide space, behind which numbers and remarks stand."""
    token, after = tokens[k], tokens[min(k + 1, len(tokens) - 1)]
    second = token.is_char("&") and k > 0 and tokens[k - 1].is_char("&")
    if not second or after.is_char("&") or after.is_relation:
        return token
    return replace(token, kind="quad")


@dataclass
class _Joiner:
    tokens: list[Token]
    dropped: set[int] = field(default_factory=set)
    levels: list[tuple[bool, int]] = field(default_factory=lambda: [(True, 0)])
    """For each environment: whether it is an alignment, and how many brackets are open."""
    braces: list[int] = field(default_factory=list)

    def read(self, k: int, token: Token) -> None:
        if token.kind == "begin":
            self.levels.append((token.text in latex.ALIGNMENTS, 0))
            if self.levels[-1][0]:
                self.dropped.update(range(k + 1, self.next_of_row(k)))
        elif token.kind == "end":
            if len(self.levels) > 1:
                self.levels.pop()
        elif token.is_char("&") and self.levels[-1][0]:
            self.dropped.add(k)
        elif token.kind == "row" and self.levels[-1][0]:
            if k not in self.dropped:
                self.at_break(k)
        else:
            self.count(k, token)

    def count(self, k: int, token: Token) -> None:
        aligned, open_ = self.levels[-1]
        if k and self.tokens[k - 1].is_command("left", "right"):
            return
        if token.kind == "char" and token.text in "()[]":
            open_ += 1 if token.text in "([" else -1
        open_ += token.is_command("left") - token.is_command("right")
        self.levels[-1] = (aligned, max(open_, 0))

    def at_break(self, k: int) -> None:
        after = self.next_of_row(k)
        token = self.tokens[after]
        split = self.null_pair(k, after)
        indented = any(self.tokens[j].kind == "quad" for j in range(k + 1, after))
        joined = self.continues(after, token) or (indented and self.is_formula(after))
        if split or self.levels[-1][1] > 0 or joined:
            self.dropped.update(range(k, after))
            self.dropped.update(split)
        else:
            self.dropped.update(range(k + 1, after))

    def next_of_row(self, k: int) -> int:
        """Return the place of the first token of the row that shows something."""
        k += 1
        while True:
            token, after = self.tokens[k], self.tokens[min(k + 1, len(self.tokens) - 1)]
            if token.is_char("&") or token.kind in {"quad", "row"}:
                k += 1
            elif token.is_char("{") and after.is_char("}") and not self.is_raised(k + 2):
                k += 2
            else:
                return k

    def is_raised(self, k: int) -> bool:
        """Whether a script stands there: empty braces before it are what it belongs to."""
        return k < len(self.tokens) and (self.tokens[k].is_char("^") or self.tokens[k].is_char("_"))

    def null_pair(self, k: int, after: int) -> set[int]:
        r"""Return the places of ``\right.`` and ``\left.`` around a break, also behind an operator."""
        while k and (self.tokens[k - 1].is_char("&") or self.tokens[k - 1].kind == "quad"):
            k -= 1
        closed = (
            k >= 2 and self.tokens[k - 2].is_command("right") and self.tokens[k - 1].is_char(".")
        )
        if not closed:
            return set()
        left = after + (not self.tokens[after].is_command("left"))
        opened = left + 1 < len(self.tokens) and self.tokens[left].is_command("left")
        if opened and self.tokens[left + 1].is_char("."):
            return {k - 2, k - 1, left, left + 1}
        return set()

    def continues(self, after: int, token: Token) -> bool:
        if token.kind == "command":
            return token.text in latex.PRODUCT_COMMANDS or token.text in latex.SUM_COMMANDS
        if token.is_char("-"):
            return not self.has_relation(after)
        return token.is_char("+") or token.is_char("*") or token.is_char("/")

    def is_formula(self, k: int) -> bool:
        """Whether the row begins with a formula, and holds no relation."""
        first = self.tokens[k].kind
        return first not in {"words", "row", "end", "stop"} and not self.has_relation(k)

    def has_relation(self, k: int) -> bool:
        """Whether the row holds a relation outside of braces."""
        depth = 0
        while self.tokens[k].kind not in {"row", "end", "stop", "begin"}:
            token = self.tokens[k]
            depth += token.is_char("{") - token.is_char("}")
            if depth == 0 and token.is_relation:
                return True
            k += 1
        return False
