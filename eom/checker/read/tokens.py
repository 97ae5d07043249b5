r"""Formulas as tokens: every token with its span, macros expanded within a budget.

Text (``\text{...}``), names of environments and of operators are one token each; comments and what
only moves or colours things leave no token but a space. A token that comes out of a macro has the
span of the call.

Usual spellings as the ones that the grammar knows, token by token; every token keeps its place.

``{a \over b}``, ``\SI{5}{\kilogram}``, ``\frac{\dd x}{\dd t}``, ``\boldsymbol\times``, ``\big/``,
``\eqno(3)``, arrays with relations at the left of a column. A pass is tokens -> tokens.
"""

from __future__ import annotations

import re
import unicodedata
from collections import deque
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass, replace

from eom.checker.read import latex
from eom.checker.read.spans import Source, Span, reading_error

MAX_FORMULA = 100_000
"""Most characters of one formula."""
MAX_TOKENS = 20_000
"""Most tokens of one formula, after macros are expanded."""
MAX_EXPANSION_DEPTH = 40


@dataclass(frozen=True)
class Token:
    r"""A piece of a formula.

    ``kind``: "letter", "number", "command", "char", "words", "begin", "end", "operator" (the name of
    an upright operator), "row" (``\\``), "quad", "mark" (a combining accent), "tag", "parameter"
    (``#1`` in a macro), "stop". ``spaced``: space or thin space stands before it; ``lined``: a line
    ends before it. ``extra``: the column specification of an array.
    """

    kind: str
    text: str
    span: Span
    spaced: bool = False
    lined: bool = False
    extra: str = ""

    def is_char(self, text: str) -> bool:
        """Whether this is a character of the keyboard, such as ``{``."""
        return self.kind == "char" and self.text == text

    def is_command(self, *names: str) -> bool:
        """Whether this is one of some commands."""
        return self.kind == "command" and self.text in names

    def stands_in(self, commands: Container[str], characters: Container[str]) -> bool:
        """Whether this is one of some commands or one of some characters."""
        return self.text in {"command": commands, "char": characters}.get(self.kind, ())

    @property
    def is_relation(self) -> bool:
        """Whether this is a relation, alone or the first character of one."""
        return self.stands_in(latex.RELATION_COMMANDS, latex.RELATION_CHARACTERS)


@dataclass(frozen=True)
class Macro:
    """A command of the writer: number of arguments, default of the first, body."""

    name: str
    arity: int
    body: tuple[Token, ...]
    default: tuple[Token, ...] | None = None


_LEXEME = re.compile(
    r"""(?P<space>\s+) | (?P<comment>%[^\n]*)
    | \\(?P<command>[A-Za-z@]+\*?|.|\n)
    | (?P<number>[0-9]+(?:\.[0-9]+)?|\.[0-9]+)
    | (?P<parameter>\#[1-9]) | (?P<char>.)""",
    re.VERBOSE | re.DOTALL,
)
_ROW_GAP = re.compile(r"\*?\s*(?:\[\s*-?[0-9.]+\s*[a-z]{2}\s*\])?")
_BOXED_FORMULA = re.compile(r"\s*\{\s*(\$)[^$]+(\$)\s*\}")
_OPTION = re.compile(r"\s*\[[^\[\]{}]*\]")
_STARRED = frozenset(
    {"operatorname", "tag", "hspace", "vspace", "DeclareMathOperator", "vb", "va", "vu"}
)


def tokenize(
    source: Source, body: str, start: int = 0, macros: Mapping[str, Macro] | None = None
) -> list[Token]:
    """Return the tokens of ``body``, which begins at ``start`` in its source; the last is "stop".

    Raises `ReadingError` for what is too long, is no text, or does not end.
    """
    if len(body) > MAX_FORMULA:
        what = f"a formula of {len(body)} characters is too long"
        raise reading_error(source, Span(start, start + 1), what, expected=f"at most {MAX_FORMULA}")
    tokens = _Scanner(source, body, start).tokens()
    if macros:
        tokens = _expand(source, tokens, macros)
    tokens = respelt(tokens)
    if len(tokens) > MAX_TOKENS:
        what = f"a formula of {len(tokens)} signs is too long"
        raise reading_error(source, tokens[0].span, what, expected=f"at most {MAX_TOKENS}")
    end = start + len(body.rstrip())
    return [*tokens, Token("stop", "", Span(end, end + 1))]


class _Scanner:
    """One pass over the characters of a formula."""

    def __init__(self, source: Source, body: str, start: int) -> None:
        self.source, self.body, self.start = source, body, start
        self.place = 0
        self.spaced = self.lined = False
        self.found: list[Token] = []

    def tokens(self) -> list[Token]:
        while self.place < len(self.body):
            match = _LEXEME.match(self.body, self.place)
            assert match is not None
            first, self.place = self.place, match.end()
            _READ[str(match.lastgroup)](self, match[str(match.lastgroup)], first)
        return self.found

    def span(self, first: int) -> Span:
        return Span(self.start + first, self.start + self.place)

    def add(self, kind: str, text: str, first: int, extra: str = "") -> None:
        self.found.append(Token(kind, text, self.span(first), self.spaced, self.lined, extra))
        self.spaced = self.lined = False

    def space(self, text: str, _: int) -> None:
        self.spaced = True
        self.lined = self.lined or "\n" in text

    def plain(self, kind: str, text: str, first: int) -> None:
        self.add(kind, text, first)

    def command(self, name: str, first: int) -> None:
        starred = name.endswith("*") and len(name) > 1
        if starred and name[:-1] not in _STARRED:
            self.place -= 1
        name = name[:-1] if starred else name
        if name == "\\":
            gap = _ROW_GAP.match(self.body, self.place)
            self.place = gap.end() if gap else self.place
            self.add("row", "", first)
        elif name in latex.SPACES or name in latex.IGNORED or name.isspace():
            self.spaced = True
        elif name in latex.IGNORED_WITH_ARGUMENT:
            self.option()
            self.argument(first)
            self.spaced = True
        elif name in latex.TRANSPARENT_SECOND:
            self.option()
            self.argument(first)
        else:
            self.named(name, first)

    def named(self, name: str, first: int) -> None:
        if name in latex.QUADS:
            self.add("quad", "", first)
        elif name in {"fbox", "framebox"} and self.unfenced():
            self.add("command", "boxed", first)
        elif name in latex.TEXTS:
            self.add("words", self.argument(first), first)
        elif name in {"begin", "end"}:
            self.environment(name, first)
        elif name in {"operatorname", "mathop@"}:
            self.add("operator", _bare(self.argument(first)), first)
        elif name == "tag":
            self.add("tag", self.argument(first), first)
        else:
            self.add("command", name, first)

    def unfenced(self) -> bool:
        """Blank the dollars of a formula that fills the box that follows; False where there is none."""
        match = _BOXED_FORMULA.match(self.body, self.place)
        if match is None:
            return False
        blank = self.body[: match.start(1)] + " " + self.body[match.end(1) : match.start(2)]
        self.body = blank + " " + self.body[match.end(2) :]
        return True

    def environment(self, kind: str, first: int) -> None:
        name = self.argument(first).strip().removesuffix("*")
        extra = ""
        if kind == "begin" and (name in latex.MATRICES or name in latex.WITH_SPECIFICATION):
            self.option()
            if name in latex.WITH_SPECIFICATION:
                extra = self.argument(first)
        self.add(kind, name, first, extra)

    def option(self) -> None:
        """Pass over an option in square brackets."""
        match = _OPTION.match(self.body, self.place)
        self.place = match.end() if match else self.place

    def argument(self, first: int) -> str:
        """Return the raw text of the argument in braces that follows, or of a single character."""
        while self.place < len(self.body) and self.body[self.place].isspace():
            self.place += 1
        if not self.body.startswith("{", self.place):
            self.place += 1
            single = self.body[self.place - 1 : self.place]
            if single in {"\\", "", "}"}:
                raise reading_error(
                    self.source, self.span(first), "an argument in braces is missing"
                )
            return single
        begin, depth, place = self.place + 1, 0, self.place
        while place < len(self.body):
            c = self.body[place]
            depth += (c == "{") - (c == "}")
            if depth == 0:
                self.place = place + 1
                return self.body[begin:place]
            place += 2 if c == "\\" else 1
        self.place = min(begin, len(self.body))
        raise reading_error(self.source, self.span(first), "this has no closing brace")

    def char(self, c: str, first: int) -> None:
        if c in latex.PLAIN_CHARACTERS:
            c = latex.PLAIN_CHARACTERS[c]
        if c.isspace():
            self.spaced = True
        elif c in latex.CHARACTERS:
            self.add("command", latex.CHARACTERS[c], first)
        elif c in latex.SUPERSCRIPTS or c in latex.SUBSCRIPTS:
            self.small_script(c, first)
        elif c in latex.COMBINING:
            self.add("mark", latex.COMBINING[c], first)
        elif c == "." and self.body.startswith("..", self.place):
            self.place += 2
            self.add("command", "dots", first)
        elif c == "~":
            self.spaced = True
        elif c == "°":
            self.add("char", "^", first)
            self.add("command", "circ", first)
        elif c.isascii():
            self.ascii(c, first)
        else:
            self.other(c, first)

    def ascii(self, c: str, first: int) -> None:
        if not c.isprintable():
            raise reading_error(self.source, self.span(first), f"character {c!r} in a formula")
        for one in c:
            self.add("letter" if one.isalpha() else "char", one, first)

    def small_script(self, c: str, first: int) -> None:
        """Read a run of raised or lowered digits as one script in braces."""
        raised = c in latex.SUPERSCRIPTS
        table = latex.SUPERSCRIPTS if raised else latex.SUBSCRIPTS
        text = table[c]
        while self.place < len(self.body) and self.body[self.place] in table:
            text += table[self.body[self.place]]
            self.place += 1
        self.add("char", "^" if raised else "_", first)
        self.add("char", "{", first)
        for part in re.findall(r"[0-9]+|.", text):
            kind = "number" if part.isdigit() else "letter" if part.isalpha() else "char"
            self.add(kind, part, first)
        self.add("char", "}", first)

    def other(self, c: str, first: int) -> None:
        """Read a letter beyond ASCII: with its accents apart, mathematical alphabets as fonts."""
        apart = unicodedata.normalize("NFKD", c)
        letter, marks = apart[0], apart[1:]
        if len(apart) > 4 or any(m not in latex.COMBINING for m in marks):
            raise reading_error(self.source, self.span(first), f"character {c!r} in a formula")
        if letter not in latex.CHARACTERS and not letter.isalpha():
            raise reading_error(self.source, self.span(first), f"character {c!r} in a formula")
        if "BOLD" in unicodedata.name(c, ""):
            self.add("command", "mathbf", first)
        if letter in latex.CHARACTERS:
            self.add("command", latex.CHARACTERS[letter], first)
        else:
            self.add("letter", letter, first)
        for m in marks:
            self.add("mark", latex.COMBINING[m], first)


_READ = {
    "space": _Scanner.space,
    "comment": _Scanner.space,
    "command": _Scanner.command,
    "number": lambda self, text, first: self.plain("number", text, first),
    "parameter": lambda self, text, first: self.plain("parameter", text[1], first),
    "char": _Scanner.char,
}


def _bare(text: str) -> str:
    """Return the name in the argument of an operator, without fonts and spaces."""
    return re.sub(r"\\[A-Za-z]+|\\.|[{}\s]", "", text)


# -- macros --------------------------------------------------------------------------------------


def _expand(source: Source, tokens: list[Token], macros: Mapping[str, Macro]) -> list[Token]:
    """Replace the writer's commands until none is left; the work is bounded."""
    waiting = deque((t, 0) for t in tokens)
    found: list[Token] = []
    work = 0
    while waiting:
        token, depth = waiting.popleft()
        primitive = token.kind != "command" or token.extra == "primitive"
        if primitive or token.text not in macros:
            found.append(token)
            continue
        macro = macros[token.text]
        new = _called(source, token, macro, waiting)
        work += len(new) + 1
        if depth >= MAX_EXPANSION_DEPTH or work > MAX_TOKENS:
            what = rf"the macro \{token.text} expands without end, or to too much"
            raise reading_error(source, token.span, what)
        waiting.extendleft((t, depth + 1) for t in reversed(new))
    return found


def _called(
    source: Source, call: Token, macro: Macro, waiting: deque[tuple[Token, int]]
) -> list[Token]:
    """Return the body of a macro with its arguments, which are taken from what waits."""
    arguments: list[list[Token]] = []
    span = call.span
    if macro.default is not None:
        if waiting and waiting[0][0].is_char("["):
            waiting.popleft()
            taken, span = _until(source, call, waiting, "]")
            arguments.append(taken)
        else:
            arguments.append(list(macro.default))
    while len(arguments) < macro.arity:
        taken, span = _argument(source, call, waiting)
        arguments.append(taken)
    span = call.span.join(span)
    new: list[Token] = []
    for t in macro.body:
        if t.kind == "parameter":
            new += arguments[int(t.text) - 1] if int(t.text) <= len(arguments) else []
        elif "#" in t.text and t.kind in {"words", "operator", "tag"}:
            new.append(replace(t, text=_filled(t.text, arguments), span=span))
        else:
            new.append(replace(t, span=span))
    return [replace(new[0], spaced=call.spaced, lined=call.lined), *new[1:]] if new else []


def _filled(text: str, arguments: list[list[Token]]) -> str:
    for k, argument in enumerate(arguments, 1):
        text = text.replace(f"#{k}", spelling(argument))
    return text[:1000]


def _argument(
    source: Source, call: Token, waiting: deque[tuple[Token, int]]
) -> tuple[list[Token], Span]:
    """Return an argument and where it ends: a group without its braces, or one token."""
    if not waiting:
        raise reading_error(source, call.span, rf"\{call.text} lacks an argument")
    first = waiting.popleft()[0]
    return _until(source, call, waiting, "}") if first.is_char("{") else ([first], first.span)


def _until(
    source: Source, call: Token, waiting: deque[tuple[Token, int]], closing: str
) -> tuple[list[Token], Span]:
    taken: list[Token] = []
    depth = 0
    while waiting:
        token = waiting.popleft()[0]
        if depth == 0 and token.is_char(closing):
            return taken, token.span
        depth += token.is_char("{") - token.is_char("}")
        taken.append(token)
    raise reading_error(source, call.span, rf"an argument of \{call.text} does not end")


def spelling(tokens: Iterable[Token]) -> str:
    """Return tokens as LaTeX, for messages and text."""
    parts = []
    for t in tokens:
        text = {"command": f"\\{t.text} ", "words": f"\\text{{{t.text}}}", "row": r"\\"}.get(
            t.kind, t.text
        )
        parts.append((" " if t.spaced else "") + text)
    return "".join(parts).strip()


def respelt(tokens: list[Token]) -> list[Token]:
    """Return the tokens of a formula in the spellings that the grammar knows."""
    for rule, names in PASSES:
        if any((t.kind in {"command", "begin"}) and t.text in names for t in tokens):
            tokens = rule(tokens)
    if any(t.kind == "words" for t in tokens):
        return _rewritten(bracketed_words(tokens), _in_words)
    return tokens


_PROPORTIONAL = re.compile(
    r"((is|are|be) )?(directly )?proportional to|(varies|vary|goes|go)( directly)? as",
    re.IGNORECASE,
)


def _in_words(tokens: list[Token], k: int, done: list[Token]) -> Replaced:
    r"""Write what words say as a unit or a relation: ``\text{is proportional to}``."""
    said = " ".join(tokens[k].text.split()) if tokens[k].kind == "words" else ""
    if not _PROPORTIONAL.fullmatch(said):
        return _unit_in_words(tokens, k, done)
    while done and done[-1].kind == "quad":
        done.pop()
    end = next((n for n in range(k + 1, len(tokens)) if tokens[n].kind != "quad"), len(tokens))
    return [replace(tokens[k], kind="command", text="propto")], end


_UNIT = re.compile(
    r"([nµμmckMG]?(m|s|N|J|W|Pa|Hz|rad)|[km]?g|[kM]?Wh|deg|rev|rpm|min|h|days?|[\s/^0-9·-])+"
)


def _unit_in_words(tokens: list[Token], k: int, done: list[Token]) -> Replaced:
    r"""Write a unit in words behind a number in upright letters: ``3\,\text{m/s}``."""
    token, before = tokens[k], done[-1] if done else None
    behind = before is not None and (before.kind == "number" or before.is_char("}"))
    if token.kind != "words" or not behind or not _UNIT.fullmatch(token.text.strip() or "?"):
        return None
    found: list[Token] = []
    for part in re.findall(r"[A-Za-zµμ]+|-?[0-9]+|[/^]", token.text):
        if part.isalpha():
            letters = [replace(token, kind="letter", text=letter) for letter in part]
            found += [replace(token, kind="command", text="mathrm"), _char("{", token)]
            found += [*letters, _char("}", token)]
        elif part in "/^":
            found.append(_char(part, token))
        else:
            found.append(replace(token, kind="number", text=part))
    return found, k + 1


def bracketed_words(tokens: list[Token]) -> list[Token]:
    r"""Leave out a bracket whose other half stands in words: ``\text{(drawn from } X)``."""
    opened: list[tuple[int, str]] = []
    dropped: set[int] = set()
    for k, token in enumerate(tokens):
        stretched = k > 0 and tokens[k - 1].is_command("left", "right")
        shown = token.kind == "words" or (token.kind == "char" and not stretched)
        for one in re.findall(r"[()\[\]]", token.text) if shown else ():
            if one in "([":
                opened.append((k, one))
            elif opened:
                other, _ = opened.pop()
                mixed = {tokens[other].kind, token.kind} == {"words", "char"}
                dropped |= {n for n in (other, k) if mixed and tokens[n].kind == "char"}
    return [t for k, t in enumerate(tokens) if k not in dropped]


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
    first = place - _within(reversed(tokens[:place]), "}", "{")
    return first, place + _within(tokens[place:], "{", "}")


def _within(tokens: Iterable[Token], opening: str, closing: str) -> int:
    """Return how many tokens stand before the brace that closes what is open already."""
    depth = count = 0
    for token in tokens:
        depth += token.is_char(opening) - token.is_char(closing)
        if depth < 0:
            break
        count += 1
    return count


Replaced = tuple[list[Token], int] | None
"""What stands instead from a place on, and where that ends; None where the token stays."""


def _rewritten(
    tokens: list[Token], rule: Callable[[list[Token], int, list[Token]], Replaced]
) -> list[Token]:
    """Return the tokens with what a rule replaces; it sees them, a place, and what stands before."""
    found: list[Token] = []
    k = 0
    while k < len(tokens):
        new, k = rule(tokens, k, found) or ([tokens[k]], k + 1)
        found += new
    return found


def differentials(tokens: list[Token]) -> list[Token]:
    r"""Write ``\dd`` above and below a fraction as a letter, without braces around one token."""
    return _rewritten(tokens, _differential)


def _differential(tokens: list[Token], k: int, _: list[Token]) -> Replaced:
    token = tokens[k]
    if not token.is_command(*latex.FRACTIONS):
        return None
    middle = _group(tokens, k + 1)
    end = _group(tokens, middle) if middle < len(tokens) else middle
    parts = [tokens[k + 1 : middle], tokens[middle:end]]
    if all(_inside(p)[:1] and _inside(p)[0].is_command("dd") for p in parts):
        parts = [_braced(_with_d(_inside(p)), token) for p in parts]
    else:
        parts = [differentials(p) for p in parts]
    return [token, *parts[0], *parts[1]], end


def _with_d(tokens: list[Token]) -> list[Token]:
    first = replace(tokens[0], kind="letter", text="d")
    rest = tokens[1:]
    if rest and rest[0].is_char("{"):
        end = _group(rest, 0)
        rest = [*_inside(rest[:end]), *rest[end:]]
    return [first, *rest]


def empty_groups(tokens: list[Token]) -> list[Token]:
    """Leave out empty braces where a group begins, unless scripts follow: they only space."""
    return _rewritten(tokens, _empty_group)


def _empty_group(tokens: list[Token], k: int, before: list[Token]) -> Replaced:
    pair = tokens[k : k + 3]
    empty = len(pair) == 3 and pair[0].is_char("{") and pair[1].is_char("}")
    begins = bool(before) and before[-1].is_char("{")
    spaces = empty and begins and not (pair[2].kind == "char" and pair[2].text in "^_}")
    return ([], k + 2) if spaces else None


_OPERATORS = frozenset({*latex.PRODUCT_COMMANDS, *latex.RELATION_COMMANDS, *latex.SUM_COMMANDS})


def bold_operators(tokens: list[Token]) -> list[Token]:
    r"""Leave out a font around an operator alone: ``\boldsymbol{\times}``."""
    return _rewritten(tokens, _bold_operator)


def _bold_operator(tokens: list[Token], k: int, _: list[Token]) -> Replaced:
    end = _group(tokens, k + 1) if tokens[k].is_command(*latex.FONTS) else k + 1
    body = _inside(tokens[k + 1 : end])
    return (body, end) if len(body) == 1 and body[0].stands_in(_OPERATORS, "=+-<>") else None


def sizes(tokens: list[Token]) -> list[Token]:
    r"""Leave out the size of a bracket, a bar or a slash: ``\bigl(``, ``\big/``, ``\middle/``."""
    places = [k for k in range(len(tokens) - 1) if _is_size(tokens[k], tokens[k + 1])]
    points = {k + 1 for k in places if tokens[k + 1].is_char(".")}
    return [t for k, t in enumerate(tokens) if k not in points.union(places)]


def _is_size(token: Token, behind: Token) -> bool:
    if token.is_command("middle"):
        return behind.is_char("/")
    shown = behind.kind == "char" and behind.text in "()[]|/."
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
    """Return whether a cell behind the first of its row begins with a relation."""
    depth, begins = 0, False
    for token in tokens:
        depth += (token.kind == "begin") - (token.kind == "end")
        if begins and token.is_relation:
            return True
        begins = depth == 0 and token.is_char("&")
    return False


UNITS = frozenset({"SI", "qty", "num", "ang", "si", "unit"})


def units(tokens: list[Token]) -> list[Token]:
    r"""Write numbers of siunitx as numbers, their units as words; ``\ang`` has a degree sign."""
    return _rewritten(tokens, _with_unit)


def _with_unit(tokens: list[Token], k: int, _: list[Token]) -> Replaced:
    token = tokens[k]
    braced = k + 1 < len(tokens) and tokens[k + 1].is_char("{")
    end = _group(tokens, k + 1) if braced else k
    two = braced and end < len(tokens) and tokens[end].is_char("{")
    if not (token.is_command(*UNITS) and braced) or (token.text == "qty" and not two):
        return None
    body = _inside(tokens[k + 1 : end])
    found = [_unit(body, token)] if token.text in {"si", "unit"} else body
    if token.text == "ang":
        found = [*found, _char("^", token), replace(token, text="circ")]
    if two and token.text in {"SI", "qty"}:
        last = _group(tokens, end)
        return [*found, _unit(_inside(tokens[end:last]), token)], last
    return found, end


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
