"""Formulas of many books: the right tree, written and read again, and no token without effect."""

from functools import cache

from eom.checker.read.grammar import read_formula, read_tokens
from eom.checker.read.spans import Source
from eom.checker.read.statements import split
from eom.checker.read.syntax import walk
from eom.checker.read.tokens import spelling, tokenize
from eom.checker.read.writing import latex
from eom.errors import InputError
from tests.eom.checker.formulas import BOOKS, SCANS
from tests.eom.checker.shape import shape

ALL = {**BOOKS, "scans": SCANS}


@cache
def trees():
    """The tree of every formula."""
    return {text: read_formula(text).tree for rows in ALL.values() for text, _ in rows}


def test_tree_is_that_of_the_mathematics():
    rows = [row for book in ALL.values() for row in book]
    found = [(text, shape(trees()[text])) for text, _ in rows]
    assert found == rows


def test_what_is_written_reads_again():
    assert [text for text, tree in trees().items() if read_formula(latex(tree)).tree != tree] == []


def without_effect(token):
    """Braces, sizes and alignment show nothing; a point or comma may end a formula."""
    if token.kind == "command":
        return token.text in {"left", "right", "big", "Big"}
    return token.kind in {"quad", "stop"} or (token.kind == "char" and token.text in "{}&.,")


def tokens_that_do_not_count(text):
    """Tokens without which a formula is the same one."""
    source = Source(text)
    tokens = tokenize(source, text)
    for k, token in enumerate(tokens):
        if without_effect(token) or token.kind == "tag":
            continue
        try:
            other = read_tokens(source, tokens[:k] + tokens[k + 1 :]).tree
        except InputError:
            continue
        if other == trees()[text]:
            yield spelling([token])


def test_every_token_counts():
    """A formula that lacks a token is refused, or is another one."""
    assert [(text, t) for text in trees() for t in tokens_that_do_not_count(text)] == []


def test_spans_lie_within_those_of_the_parents():
    for text, tree in trees().items():
        assert 0 <= tree.span.start < tree.span.stop <= len(text), text
        for node in walk(tree):
            assert 0 <= node.span.start <= node.span.stop <= len(text) + 1, text


def test_leaves_stand_where_their_spans_say():
    text = r"m_i \ddot{\mathbf r}_O = \omega + 2.5\,\text{if}"
    leaves = {n.name: n.span for n in walk(read_formula(text).tree) if type(n).__name__ == "Symbol"}
    assert text[slice(*leaves["m"])] == "m"
    assert text[slice(*leaves["omega"])] == r"\omega"
    assert text[slice(*leaves["O"])] == "O"
    number = next(n for n in walk(read_formula(text).tree) if type(n).__name__ == "Number")
    assert text[slice(*number.span)] == "2.5"


def test_books_are_many():
    assert sum(map(len, BOOKS.values())) >= 80
    assert all(split(read_formula(text).tree) for rows in BOOKS.values() for text, _ in rows)
