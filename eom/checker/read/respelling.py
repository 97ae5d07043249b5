r"""Usual spellings as the ones that the grammar knows, token by token; every token keeps its place.

``{a \over b}``, ``\SI{5}{\kilogram}``, ``\frac{\dd x}{\dd t}``, ``\boldsymbol\times``, ``\big/``,
``\eqno(3)``, arrays with relations at the left of a column. A pass is tokens -> tokens.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from eom.checker.read import latex

if TYPE_CHECKING:
    from eom.checker.read.tokens import Token


def respelt(tokens: list[Token]) -> list[Token]:
    """Return the tokens of a formula in the spellings that the grammar knows."""
    for rule, names in PASSES:
        if any((t.kind in {"command", "begin"}) and t.text in names for t in tokens):
            tokens = rule(tokens)
    return tokens


def _group(tokens: list[Token], place: int) -> int:
    """Return the place behind the group or the single token that begins at a place."""
    depth = 0
    for k in range(place, len(tokens)):
        depth += tokens[k].is_char("{") - tokens[k].is_char("}")
        if depth <= 0:
            return k + 1
    return len(tokens)


def _inside(tokens: list[Token]) -> list[Token]:
    """Return a group without its braces."""
    braced = len(tokens) > 1 and tokens[0].is_char("{") and tokens[-1].is_char("}")
    return tokens[1:-1] if braced else tokens


def _char(text: str, at: Token) -> Token:
    return replace(at, kind="char", text=text, extra="")


def _braced(tokens: list[Token], at: Token) -> list[Token]:
    return [_char("{", at), *tokens, _char("}", at)]


# -- passes ---------------------------------------------------------------------------------------


def over(tokens: list[Token]) -> list[Token]:
    r"""Write ``{a \over b}`` as a fraction; without braces around it the whole formula is one."""
    while True:
        place = next((k for k, t in enumerate(tokens) if t.is_command("over")), None)
        if place is None:
            return tokens
        first, last = _around(tokens, place)
        at = tokens[place]
        above, below = tokens[first:place], tokens[place + 1 : last]
        fraction = [replace(at, text="frac"), *_braced(above, at), *_braced(below, at)]
        tokens = [*tokens[:first], *fraction, *tokens[last:]]


def _around(tokens: list[Token], place: int) -> tuple[int, int]:
    """Return where the innermost group around a place begins and ends, without its braces."""
    depth, first = 0, place
    while first > 0:
        depth += tokens[first - 1].is_char("}") - tokens[first - 1].is_char("{")
        if depth < 0:
            break
        first -= 1
    depth, last = 0, place
    while last < len(tokens):
        depth += tokens[last].is_char("{") - tokens[last].is_char("}")
        if depth < 0:
            break
        last += 1
    return first, last


def differentials(tokens: list[Token]) -> list[Token]:
    r"""Write ``\dd`` above and below a fraction as a letter, without braces around one token."""
    found: list[Token] = []
    k = 0
    while k < len(tokens):
        token = tokens[k]
        if not token.is_command(*latex.FRACTIONS):
            found.append(token)
            k += 1
            continue
        middle = _group(tokens, k + 1)
        end = _group(tokens, middle) if middle < len(tokens) else middle
        parts = [tokens[k + 1 : middle], tokens[middle:end]]
        if all(_inside(p)[:1] and _inside(p)[0].is_command("dd") for p in parts):
            parts = [_braced(_with_d(_inside(p)), token) for p in parts]
        else:
            parts = [differentials(p) for p in parts]
        found += [token, *parts[0], *parts[1]]
        k = end
    return found


def _with_d(tokens: list[Token]) -> list[Token]:
    first = replace(tokens[0], kind="letter", text="d")
    rest = tokens[1:]
    if rest and rest[0].is_char("{"):
        end = _group(rest, 0)
        rest = [*_inside(rest[:end]), *rest[end:]]
    return [first, *rest]


def empty_groups(tokens: list[Token]) -> list[Token]:
    """Leave out empty braces where a group begins, unless scripts follow: they only space."""
    found: list[Token] = []
    k = 0
    while k < len(tokens):
        pair = tokens[k : k + 3]
        empty = len(pair) == 3 and pair[0].is_char("{") and pair[1].is_char("}")
        begins = bool(found) and found[-1].is_char("{")
        if empty and begins and not (pair[2].kind == "char" and pair[2].text in "^_}"):
            k += 2
            continue
        found.append(tokens[k])
        k += 1
    return found


def bold_operators(tokens: list[Token]) -> list[Token]:
    r"""Leave out a font around an operator alone: ``\boldsymbol{\times}``."""
    found: list[Token] = []
    k = 0
    while k < len(tokens):
        token = tokens[k]
        end = _group(tokens, k + 1) if token.is_command(*latex.FONTS) else k + 1
        body = _inside(tokens[k + 1 : end])
        sign = len(body) == 1 and _is_operator(body[0])
        found += body if sign else [token]
        k = end if sign else k + 1
    return found


def _is_operator(token: Token) -> bool:
    named = (latex.PRODUCT_COMMANDS, latex.RELATION_COMMANDS, latex.SUM_COMMANDS)
    if token.kind == "command":
        return any(token.text in table for table in named)
    return token.kind == "char" and token.text in "=+-<>"


def sizes(tokens: list[Token]) -> list[Token]:
    r"""Leave out the size of a bracket, a bar or a slash: ``\bigl(``, ``\big/``, ``\middle/``."""
    pairs = zip(tokens, [*tokens[1:], None], strict=True)
    return [a for a, b in pairs if not (b is not None and _is_size(a, b))]


def _is_size(token: Token, behind: Token) -> bool:
    if token.is_command("middle"):
        return behind.is_char("/")
    shown = behind.kind == "char" and behind.text in "()[]|/"
    return token.is_command(*latex.SIZES) and (shown or behind.is_command(*latex.DELIMITERS))


def numbered(tokens: list[Token]) -> list[Token]:
    r"""Write ``\eqno(3)`` as a tag."""
    place = next((k for k, t in enumerate(tokens) if t.is_command("eqno", "leqno")), len(tokens))
    if place == len(tokens):
        return tokens
    text = "".join(t.text for t in tokens[place + 1 :] if t.kind in {"char", "letter", "number"})
    return [*tokens[:place], replace(tokens[place], kind="tag", text=text.strip("(){}"))]


def aligned_arrays(tokens: list[Token]) -> list[Token]:
    """Take arrays with a cell that begins with a relation for alignments."""
    found = list(tokens)
    opened: list[int] = []
    for k, token in enumerate(tokens):
        if token.kind == "begin":
            opened.append(k)
        elif token.kind == "end" and opened:
            first = opened.pop()
            if tokens[first].text == "array" and _relation_cell(tokens[first + 1 : k]):
                found[first] = replace(tokens[first], text="aligned", extra="")
                found[k] = replace(token, text="aligned")
    return found


def _relation_cell(tokens: list[Token]) -> bool:
    """Tell whether a cell behind the first of its row begins with a relation."""
    depth, begins = 0, False
    for token in tokens:
        depth += (token.kind == "begin") - (token.kind == "end")
        if begins and _is_relation(token):
            return True
        begins = depth == 0 and token.is_char("&")
    return False


def _is_relation(token: Token) -> bool:
    if token.kind == "command":
        return token.text in latex.RELATION_COMMANDS
    return token.kind == "char" and token.text in latex.RELATION_CHARACTERS


UNITS = frozenset({"SI", "qty", "num", "ang", "si", "unit"})


def units(tokens: list[Token]) -> list[Token]:
    r"""Write numbers of siunitx as numbers, their units as words; ``\ang`` has a degree sign."""
    found: list[Token] = []
    k = 0
    while k < len(tokens):
        token = tokens[k]
        braced = k + 1 < len(tokens) and tokens[k + 1].is_char("{")
        end = _group(tokens, k + 1) if braced else k
        two = braced and end < len(tokens) and tokens[end].is_char("{")
        if not (token.is_command(*UNITS) and braced) or (token.text == "qty" and not two):
            found.append(token)
            k += 1
            continue
        body = _inside(tokens[k + 1 : end])
        alone = token.text in {"si", "unit"}
        found += [_unit(body, token)] if alone else body
        if token.text == "ang":
            found += [_char("^", token), replace(token, text="circ")]
        if two and token.text in {"SI", "qty"}:
            last = _group(tokens, end)
            found.append(_unit(_inside(tokens[end:last]), token))
            end = last
        k = end
    return found


def _unit(tokens: list[Token], at: Token) -> Token:
    text = " ".join(t.text for t in tokens)
    return replace(at, kind="words", text=f"[{text}]")


PASSES: tuple[tuple[Callable[[list[Token]], list[Token]], frozenset[str]], ...] = (
    (units, UNITS),
    (over, frozenset({"over"})),
    (empty_groups, frozenset(latex.FRACTIONS)),
    (differentials, frozenset({"dd"})),
    (bold_operators, frozenset(latex.FONTS)),
    (sizes, frozenset({*latex.SIZES, "middle"})),
    (numbered, frozenset({"eqno", "leqno"})),
    (aligned_arrays, frozenset({"array"})),
)
"""Passes in their order, and the commands or environments without which they have nothing to do."""
