r"""Formulas as statements: what is claimed, link by link, with what it depends on.

Rows, arrows, wide spaces and commas part statements; a chain has a link for each of its signs; a
leading ``=`` continues the statement before; ``if``, ``for``, ``where`` bring conditions; an equation
number in brackets at the end is a tag.

All formulas of a document, read and split; what cannot be read carries its error.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from collections.abc import Sequence as Sequenced
from dataclasses import dataclass, field, replace

from eom.checker.read.documents import Document, Piece
from eom.checker.read.grammar import Reading, read_tokens
from eom.checker.read.spans import NOWHERE, ReadingError, Span
from eom.checker.read.symbol_shape import seen
from eom.checker.read.syntax import (
    Accent,
    Addition,
    Boxed,
    Braced,
    Cases,
    Dots,
    Group,
    Implication,
    Missing,
    Node,
    Number,
    Product,
    Relation,
    Rows,
    Scripts,
    Sequence,
    Sign,
    Symbol,
    Words,
    walk,
)
from eom.checker.read.tokens import tokenize


@dataclass(frozen=True)
class Link:
    """One step of a chain: ``left sign right``."""

    left: Node
    sign: Sign
    right: Node

    @property
    def span(self) -> Span:
        """The place from the left to the right side."""
        return self.sign.span.join(self.right.span).join(self.left.span)

    @property
    def defines(self) -> bool:
        """Whether the sign says that one side is defined by the other."""
        return self.sign.name in {":=", "=:"}


@dataclass(frozen=True)
class Statement:
    """What stands on the paper as one claim.

    ``members`` and ``signs`` of the chain; without signs it is an expression or, without members,
    words alone. ``continues``: the first member was left out and is the last one of the statement
    before. ``joined``: the arrow that leads here ("implies", ...). ``conditions``: the role ("if",
    "for", "where", "because", ...) and the statement. ``words``: other text beside it. ``row``: of an
    alignment. ``others``: what else the sign in front may continue.
    """

    members: tuple[Node, ...]
    signs: tuple[Sign, ...] = ()
    span: Span = NOWHERE
    continues: bool = False
    joined: str = ""
    conditions: tuple[tuple[str, Statement], ...] = ()
    words: tuple[str, ...] = ()
    tag: str = ""
    boxed: bool = False
    row: int = 0
    others: tuple[Node, ...] = ()

    @property
    def links(self) -> tuple[Link, ...]:
        """The steps of the chain, in order."""
        triples = zip(self.members, self.signs, self.members[1:], strict=False)
        return tuple(Link(a, s, b) for a, s, b in triples)

    @property
    def relational(self) -> bool:
        """Whether anything is claimed."""
        return bool(self.signs)


ROLES: dict[str, str] = {
    word: role
    for role, words in {
        "if": "if when whenever provided assuming assume given under",
        "iff": "iff",
        "only if": "only",
        "unless": "unless",
        "for": "for forall",
        "exists": "exists",
        "where": "where with while let",
        "because": "since because as using",
    }.items()
    for word in words.split()
}
"""The first word of a text, and the role of what follows it."""
_ALONE = {"at": "for"}
"""The same of words that announce something only by themselves."""
_LEADING = {"then": "implies", "so": "implies", "thus": "implies", "hence": "implies"}
_LEADING |= {"therefore": "therefore", "implies": "implies"}
_JOINING = frozenset({"and", "or", "also", "but", "otherwise"})


def split(
    tree: Node, previous: Sequenced[Statement] = (), tags: Iterable[str] = ()
) -> tuple[Statement, ...]:
    """Return the statements of a formula; ``previous`` are those that a leading sign may continue."""
    splitter = _Splitter()
    splitter.read(tree)
    found = splitter.finished()
    tags = list(tags)
    if found and tags:
        rows = found if len(tags) > 1 else found[-1:]
        tagged = dict(zip(range(len(found) - len(rows), len(found)), tags, strict=False))
        found = [replace(s, tag=tagged.get(k, s.tag)) for k, s in enumerate(found)]
    return tuple(_continued(found, previous))


def _continued(found: list[Statement], previous: Sequenced[Statement]) -> list[Statement]:
    """Put a member of a statement before in place of one that was left out."""
    result: list[Statement] = []
    for s in found:
        new = s
        last = (result or previous)[-1:]
        missing = s.relational and isinstance(s.members[0], Missing)
        wanted = missing or any(b.relational and _ends_open(b) for b in last)
        before = _continuable(result or previous) if wanted else []
        alone = _row_alone(result, s) if missing else None
        if alone is not None:
            new = replace(s, members=(alone, *s.members[1:]))
        elif before and missing:
            left, *others = (_last(b) for b in before)
            members = (left, *s.members[1:])
            new = replace(s, members=members, continues=True, others=tuple(others))
        elif before and s.members and _ends_open(before[0]):
            members, signs = (_last(before[0]), *s.members), (before[0].signs[-1], *s.signs)
            new = replace(s, members=members, signs=signs, continues=True)
        result.append(new)
    return [_closed(s) for s in result]


def _row_alone(result: list[Statement], s: Statement) -> Node | None:
    """Return the expression that stands in the row before by itself: a sign below it continues that."""
    last = result[-1] if result else None
    if last is None or last.relational or last.row + 1 != s.row or len(last.members) != 1:
        return None
    return None if isinstance(last.members[0], Words) else last.members[0]


def _continuable(before: Sequenced[Statement]) -> list[Statement]:
    """Return what may be continued, most likely first.

    It is the last row, behind its last arrow; what stands beside its first statement is a remark.
    """
    found: list[Statement] = []
    for s in reversed(before):
        if found and s.row != found[-1].row:
            break
        if s.relational:
            found.append(s)
            if s.joined:
                break
    found.reverse()
    return found[-1:] if found and _ends_open(found[-1]) else found


def _last(s: Statement) -> Node:
    """Return the last member that is there."""
    return s.members[-2] if _ends_open(s) and len(s.members) > 1 else s.members[-1]


def _ends_open(s: Statement) -> bool:
    return isinstance(s.members[-1], Missing)


def _closed(s: Statement) -> Statement:
    """Leave out a sign at the end that the next statement has taken over."""
    if s.relational and _ends_open(s):
        return replace(s, members=s.members[:-1], signs=s.signs[:-1])
    return s


@dataclass
class _Splitter:
    """Statements so far, and what waits for the next one."""

    found: list[Statement] = field(default_factory=list)
    joined: str = ""
    boxed: bool = False
    row: int = 0
    role: str = ""
    """Of what a text announced and what has not come yet."""
    waiting: list[tuple[str, Statement]] = field(default_factory=list)
    words: list[str] = field(default_factory=list)
    listed: list[Node] = field(default_factory=list)

    def read(self, node: Node) -> None:
        """Take in a node at the level of statements."""
        if isinstance(node, Rows | Implication | Sequence | Boxed):
            self.within(node)
        elif isinstance(node, Cases) and _relational_rows(node):
            self.cases(node)
        elif isinstance(node, Group) and (node.open == "" or isinstance(node.body, _SAYING)):
            self.read(node.body)
        elif isinstance(node, Words):
            self.text(node)
        elif isinstance(node, Relation):
            self.add(Statement(node.members, node.signs, node.span))
        elif not isinstance(node, Missing):
            self.add(Statement((node,), (), node.span))

    def within(self, node: Rows | Implication | Sequence | Boxed) -> None:
        """Take in the parts of a node that holds statements."""
        if isinstance(node, Rows):
            for row in node.rows:
                self.read(row)
                self.role = ""
                self.row += 1
        elif isinstance(node, Implication):
            self.implication(node)
        elif isinstance(node, Sequence):
            self.sequence(node)
        else:
            self.boxed = True
            self.read(node.body)
            self.boxed = False

    def implication(self, node: Implication) -> None:
        for k, item in enumerate(node.items):
            if k:
                self.flush()
                self.role = ""
                self.joined = node.signs[k - 1].name
            self.read(item)

    def cases(self, node: Cases) -> None:
        for row in node.rows:
            self.read(row[0])
            for cell in row[1:]:
                self.role = "if"
                self.read(cell)
            self.role = ""
            self.row += 1

    def sequence(self, node: Sequence) -> None:
        items, separators = list(node.items), ["", *node.separators]
        tag = _equation_number(items[-1]) if separators[-1] == "quad" and len(items) > 1 else ""
        if tag:
            items.pop()
        for k, item in enumerate(items):
            after = separators[k + 1] if k + 1 < len(items) else ""
            if separators[k] == "," and self.lists(item):
                continue
            if after == "," and _is_name(item) and not self.role:
                self.listed.append(item)
            else:
                self.read(item)
        self.flush()
        if tag and self.found:
            self.found[-1] = replace(self.found[-1], tag=tag)

    def lists(self, item: Node) -> bool:
        """Whether an item only goes on with a list of values: ``i = 1, 2, 3``."""
        if not isinstance(item, Number | Dots) and not (self.found and _after_dots(self.found[-1])):
            return False
        if not self.found or (self.role and not self.found[-1].conditions):
            return False
        target = self.found[-1]
        if target.conditions:
            role, inner = target.conditions[-1]
            inner = _extended(inner, item)
            self.found[-1] = replace(target, conditions=(*target.conditions[:-1], (role, inner)))
            return True
        if not target.relational or not isinstance(item, Number | Dots | Symbol):
            return False
        self.found[-1] = _extended(target, item)
        return True

    def text(self, node: Words) -> None:
        """Take in words: they announce a condition, join, or only comment."""
        first = (node.sign or node.text.strip(" ,.;:()").split(" ")[0]).lower().strip(",.:;")
        last = node.text.strip(" ,.;:()").split(" ")[-1].lower()
        role = ROLES.get(first) or ROLES.get(last) or _ALONE.get(node.text.strip(" ,").lower())
        if role is not None:
            self.flush()
            self.role = role
        elif first in _LEADING:
            self.joined, self.role = _LEADING[first], ""
        elif first in _JOINING:
            pass
        elif not self.role:
            self.comment(node.text)
        if role is not None and node.text.strip(" ,.;:()").lower() != first and not node.sign:
            self.comment(node.text)

    def comment(self, text: str) -> None:
        """Keep text beside the last statement, or for the next one."""
        if self.found:
            s = self.found[-1]
            self.found[-1] = replace(s, words=(*s.words, text.strip()))
        else:
            self.words.append(text.strip())

    def add(self, s: Statement) -> None:
        """Take in a statement: as a condition where words announced one."""
        if self.listed:
            span = self.listed[0].span.join(s.members[0].span)
            items = (*self.listed, s.members[0])
            left = Sequence(items, (",",) * len(self.listed), span=span)
            s = replace(s, members=(left, *s.members[1:]), span=span.join(s.span))
            self.listed = []
        if self.role:
            condition = (self.role, s)
            if self.found and not self.joined:
                before = self.found[-1]
                self.found[-1] = replace(before, conditions=(*before.conditions, condition))
            else:
                self.waiting.append(condition)
                self.role = ""
            return
        if isinstance(s.members[0], Words) and not s.relational:
            return
        words, waiting = tuple(self.words), tuple(self.waiting)
        s = replace(s, joined=self.joined, boxed=self.boxed, row=self.row)
        s = replace(s, words=words, conditions=waiting)
        self.found.append(s)
        self.joined, self.words, self.waiting = "", [], []

    def flush(self) -> None:
        """Take in names that were listed and that no relation followed."""
        names, self.listed = self.listed, []
        for name in names:
            self.add(Statement((name,), (), name.span))

    def finished(self) -> list[Statement]:
        """Return all; words or conditions that nothing follows stand alone."""
        self.flush()
        if self.words or self.waiting or (self.joined and not self.found):
            rest = Statement(
                (), (), NOWHERE, False, self.joined, tuple(self.waiting), tuple(self.words)
            )
            self.found.append(rest)
        return self.found


_SAYING = (Relation, Implication, Rows)
"""What claims something though brackets are around it."""


def _relational_rows(node: Cases) -> bool:
    return bool(node.rows) and all(isinstance(r[0], Relation | Implication) for r in node.rows)


def _is_name(node: Node) -> bool:
    if isinstance(node, Scripts | Accent):
        return _is_name(node.base)
    return isinstance(node, Symbol | Dots)


def _after_dots(s: Statement) -> bool:
    last = s.conditions[-1][1].members[-1] if s.conditions else s.members[-1] if s.members else None
    return isinstance(last, Sequence) and isinstance(last.items[-1], Dots)


def _extended(s: Statement, item: Node) -> Statement:
    last = s.members[-1]
    items = (*last.items, item) if isinstance(last, Sequence) else (last, item)
    span = last.span.join(item.span)
    whole = Sequence(items, (",",) * (len(items) - 1), span=span)
    return replace(s, members=(*s.members[:-1], whole), span=s.span.join(span))


def _equation_number(node: Node) -> str:
    """Return the number of an equation in brackets, such as (3.36a), or ""."""
    if not isinstance(node, Group) or node.open != "(":
        return ""
    body = node.body
    if isinstance(body, Number):
        return body.text
    if isinstance(body, Product) and body.operator == "" and len(body.factors) == 2:
        first, second = body.factors
        if isinstance(first, Number) and isinstance(second, Symbol):
            return first.text + second.name
        if isinstance(first, Symbol) and isinstance(second, Number):
            return first.name + second.text
    if isinstance(body, Addition) and all(isinstance(t, Number) for t in body.terms):
        return "-".join(t.text for t in body.terms if isinstance(t, Number))
    return ""


@dataclass(frozen=True)
class Formula:
    """A formula of a document: its piece, and either its reading and statements or an error."""

    piece: Piece
    reading: Reading | None
    statements: tuple[Statement, ...] = ()
    error: ReadingError | None = None

    @property
    def relational(self) -> bool:
        """Whether it claims anything; what cannot be read counts if it shows a relation."""
        if self.reading is None:
            return any(sign in self.piece.body for sign in ("=", "<", ">", "\\eq", "\\to"))
        return any(s.relational for s in self.statements)


def read(document: Document) -> tuple[Formula, ...]:
    """Read all formulas of a document in order; a display may continue the one before."""
    found: list[Formula] = []
    previous: tuple[Statement, ...] = ()
    for piece in document.formulas:
        display = piece.kind == "display"
        formula = read_piece(piece, previous if display else ())
        found.append(formula)
        if display and formula.statements:
            previous = formula.statements
    return tuple(found)


def read_piece(piece: Piece, previous: tuple[Statement, ...] = ()) -> Formula:
    """Read one formula."""
    try:
        tokens = tokenize(piece.source, piece.body, piece.span.start, piece.macros)
        reading = read_tokens(piece.source, tokens)
    except ReadingError as error:
        return Formula(piece, None, (), error)
    tags = [text for text, _ in reading.tags]
    return Formula(piece, reading, split(reading.tree, previous, tags))


def single_statements(statement: Statement) -> Iterator[Statement]:
    """Yield a statement for each of the left sides that a comma parts, then those of braces."""
    if not statement.relational or any(isinstance(m, Words) for m in statement.members[:-1]):
        return
    if len(statement.signs) > 1 and any(g.name == _PROPORTIONAL for g in statement.signs):
        yield from (one for part in _segments(statement) for one in single_statements(part))
        return
    first, last = statement.members[0], statement.members[-1]
    wordy = isinstance(last, Words) and not says_constant(last)
    if wordy or isinstance(last, Sequence):
        return
    if isinstance(first, Sequence):
        for item in first.items:
            yield replace(statement, members=(item, *statement.members[1:]))
    else:
        yield statement
    yield from _braces(statement)


_PROPORTIONAL = "propto"


def _segments(s: Statement) -> Iterator[Statement]:
    """Yield the chains between signs of proportion, and each of these with its two sides."""
    begin = 0
    for k, sign in enumerate((*s.signs, None)):
        if sign is not None and sign.name != _PROPORTIONAL:
            continue
        for a, b in ((begin, k), (k, k + 1)):
            if a < b <= len(s.signs):
                members, signs = s.members[a : b + 1], s.signs[a:b]
                yield replace(s, members=members, signs=signs, continues=s.continues and a == 0)
        begin = k + 1


def _braces(statement: Statement) -> Iterator[Statement]:
    """Yield what labels of braces say: that what they span is the label."""
    for member in statement.members[int(statement.continues) :]:
        for found in walk(member):
            label = found.label if isinstance(found, Braced) else None
            if isinstance(found, Braced) and label is not None and _is_quantity(label):
                sign = Sign("=", span=found.span)
                yield Statement((found.body, label), (sign,), found.span)


def _is_quantity(node: Node) -> bool:
    look = seen(node)
    return look is not None and not (
        look.look.style == "" and len(look.look.name) > 1 and _upright(node)
    )


def _upright(node: Node) -> bool:
    return any(isinstance(n, Symbol) and n.style == "roman" and len(n.name) > 1 for n in walk(node))


def says_constant(node: Node) -> bool:
    """Return whether the end of a statement is the word for constant."""
    text = node.text if isinstance(node, Words) else ""
    if isinstance(node, Symbol) and node.style == "roman":
        text = node.name
    return text.strip(" .()").casefold() in _CONSTANTS


_CONSTANTS = ("const", "constant", "konst")
