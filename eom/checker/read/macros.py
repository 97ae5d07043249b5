r"""The writer's own commands: ``\newcommand``, ``\def``, ``\DeclareMathOperator``, ``\let``.

Definitions are taken out of the text (blanked, so that places stay) and kept with where they stand;
a formula sees those before it. Delimited parameters of ``\def`` are not read.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from eom.checker.read.places import ReadingError, Source, Span, reading_error
from eom.checker.read.tokens import Macro, Token, tokenize

MAX_MACROS = 2000
_DEFINITION = re.compile(
    r"\\(?P<how>(?:re|provide|New|Renew|Provide|Declare)?(?:new)?"
    r"(?:command|DocumentCommand|RobustCommand|MathOperator)|[gex]?def|let)(?P<star>\*?)(?![A-Za-z])\s*"
    r"(?:\{\s*\\(?P<braced>[A-Za-z]+|.)\s*\}|\\(?P<bare>[A-Za-z]+|.))\s*"
)
_ARITY = re.compile(r"\s*\[\s*([0-9])\s*\]\s*")
_PARAMETERS = re.compile(r"\s*((?:#[1-9])*)\s*")
_TARGET = re.compile(r"=?\s*(?:\\([A-Za-z]+|.)|([^\s\\]))")


@dataclass(frozen=True)
class Defined:
    """A definition, and the offset behind which it holds."""

    macro: Macro
    stop: int


@dataclass(frozen=True)
class Definitions:
    """The text without its definitions, the definitions, and what is wrong with some."""

    text: str
    macros: tuple[Defined, ...]
    errors: tuple[ReadingError, ...]


def collect(source: Source, text: str) -> Definitions:
    """Return the definitions of ``text``, which has the places of its source."""
    found: list[Defined] = []
    errors: list[ReadingError] = []
    pieces: list[str] = []
    place = 0
    while (match := _DEFINITION.search(text, place)) is not None:
        span = Span(match.start(), match.end())
        try:
            if len(found) >= MAX_MACROS:
                raise reading_error(source, span, "too many definitions")
            defined = _defined(source, text, match)
            found.append(defined)
            stop = defined.stop
        except ReadingError as error:
            errors.append(error)
            stop = match.end()
        pieces += [text[place : match.start()], blank(text[match.start() : stop])]
        place = stop
    return Definitions("".join([*pieces, text[place:]]), tuple(found), tuple(errors))


def blank(text: str) -> str:
    """Return spaces for all characters but line ends."""
    return re.sub(r"[^\n]", " ", text)


def before(defined: tuple[Defined, ...], offset: int) -> Mapping[str, Macro]:
    """Return what holds at an offset; the last definition of a name counts."""
    return {d.macro.name: d.macro for d in defined if d.stop <= offset}


def _defined(source: Source, text: str, match: re.Match[str]) -> Defined:
    name, how = match["braced"] or match["bare"], match["how"]
    if how == "let":
        return _alias(source, text, match, name)
    place = match.end()
    arity, default = 0, None
    if how.endswith("def"):
        parameters = _PARAMETERS.match(text, place)
        assert parameters is not None
        arity, place = len(parameters[1]) // 2, parameters.end()
    elif how.endswith("DocumentCommand"):
        signature, place = _braced(source, text, place, match)
        arity = len(re.findall(r"[mo]", text[signature.start : signature.stop]))
    elif (count := _ARITY.match(text, place)) is not None:
        arity, place = int(count[1]), count.end()
        if text.startswith("[", place):
            close = text.find("]", place)
            close = place if close < 0 else close
            default = tuple(tokenize(source, text[place + 1 : close], place + 1)[:-1])
            place = close + 1
    inside, stop = _braced(source, text, place, match)
    body = text[inside.start : inside.stop]
    if how == "DeclareMathOperator":
        tokens = [Token("operator", re.sub(r"\\[A-Za-z]+|[\\{}\s,]", "", body), inside)]
    else:
        tokens = tokenize(source, body, inside.start)[:-1]
    return Defined(Macro(name, arity, tuple(tokens), default), stop)


def _alias(source: Source, text: str, match: re.Match[str], name: str) -> Defined:
    r"""Read ``\let\a\b``: what the target means now is kept."""
    target = _TARGET.match(text, match.end())
    span = Span(match.start(), match.end())
    if target is None:
        raise reading_error(source, span, rf"\let\{name} has no target")
    kind, word = ("command", target[1]) if target[1] else ("letter", target[2])
    token = Token(kind, word, Span(target.start(), target.end()), extra="primitive")
    return Defined(Macro(name, 0, (token,)), target.end())


def _braced(source: Source, text: str, place: int, match: re.Match[str]) -> tuple[Span, int]:
    """Return the span within the braces at a place, and what is behind them."""
    while place < len(text) and text[place].isspace():
        place += 1
    depth, start = 0, place
    while place < min(len(text), start + 20_000):
        c = text[place]
        depth += (c == "{") - (c == "}")
        if depth == 0:
            break
        place += 2 if c == "\\" else 1
    if depth or not text.startswith("{", start):
        span = Span(match.start(), match.end())
        raise reading_error(source, span, "this definition has no body in braces")
    return Span(start + 1, place), place + 1
