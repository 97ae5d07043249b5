r"""Rows of alignments, before parsing: what continues a row is joined to it.

In an alignment ``&`` says where things stand and not what they are, and is left out. A row continues
the one above if a bracket is open, if it begins with ``+`` or a product sign, if it begins with
``-`` and holds no relation, or if ``\right.`` and ``\left.`` stand on both sides of the break.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from eom.checker.read import latex
from eom.checker.read.tokens import Token


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
    if not second or after.is_char("&") or _relates(after):
        return token
    return replace(token, kind="quad")


def _relates(token: Token) -> bool:
    named = token.kind == "char" and token.text in latex.RELATION_CHARACTERS
    return named or token.is_command(*latex.RELATION_COMMANDS)


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
        if split or self.levels[-1][1] > 0 or self.continues(after, token):
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
            elif token.is_char("{") and after.is_char("}"):
                k += 2
            else:
                return k

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

    def has_relation(self, k: int) -> bool:
        """Whether the row holds a relation outside of braces."""
        depth = 0
        while self.tokens[k].kind not in {"row", "end", "stop", "begin"}:
            token = self.tokens[k]
            depth += token.is_char("{") - token.is_char("}")
            if depth == 0 and _relates(token):
                return True
            k += 1
        return False
