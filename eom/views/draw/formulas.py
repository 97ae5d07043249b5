r"""Words of pictures: plain text with formulas between dollar signs, for every renderer.

Formulas are in that part of TeX which pictures need: Greek letters, indices, exponents, ``\mathbf``,
``\mathrm``, dots and hats. Names and titles come from users: their text goes through `plain` or `short`
first, names through `name`, expressions through `formula`.
"""

from __future__ import annotations

import html
import re
import unicodedata
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.typeset.boxes import GREEK_NAMES, row
from eom.typeset.markup import ACCENTS, greek, render, symbol_latex
from eom.typeset.writing import expression_pieces

_DOLLAR = re.compile(r"(?<!\\)\$")
_WORDS = re.compile(r"(?:\$(?:\\.|[^$])*\$|\\.|[^\s$]|\$)+")
_TAG = re.compile(r"<(/?)(sub|sup|b|i)>")
_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[{}^_]|\s+|.", re.DOTALL)

SYMBOLS = {
    **{name: greek(name) for name in GREEK_NAMES},
    "varepsilon": "\u03b5",
    "varphi": "\u03c6",
    "phi": "\u03d5",
    "cdot": "\u00b7",
    "times": "\u00d7",
    "pm": "\u00b1",
    "leq": "\u2264",
    "geq": "\u2265",
    "approx": "\u2248",
    "infty": "\u221e",
    "circ": "\u00b0",
    "bullet": "\u2022",
    "degree": "\u00b0",
    "partial": "\u2202",
    "sqrt": "\u221a",
    "to": "\u2192",
    "perp": "\u22a5",
    "parallel": "\u2225",
    "prime": "\u2032",
    "quad": "\u2003",
    ",": "\u2009",
    ";": "\u2005",
    " ": " ",
    "!": "",
    "left": "",
    "right": "",
}
"""Commands that stand for a character; of ``\\left`` and ``\\right`` the bracket alone is left."""
STYLES = {"mathbf": "b", "boldsymbol": "b", "mathit": "i", "mathrm": "", "text": "", "mathsf": ""}
LEVELS = {"_": "sub", "^": "sup"}
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
_RAISED = str.maketrans("-0123456789", "\N{SUPERSCRIPT MINUS}⁰¹²³⁴⁵⁶⁷⁸⁹")
MOST_PARTS, DIGITS = 100, 4
"""Fractions with larger denominators are written as decimals, of some digits."""
LONGEST = 80
"""Letters of a name or title of a user's that are shown."""


@dataclass(frozen=True)
class Span:
    """A piece of text; a formula without its dollar signs, or plain characters as they are read."""

    text: str
    formula: bool


def plain(text: str) -> str:
    r"""Return the words of a picture that show any text as it is: dollar signs do not open formulas.

    >>> plain("5 $ or 6 $")
    '5 \\$ or 6 \\$'
    """
    return clean(text).replace("$", r"\$")


def clean(text: str) -> str:
    """Return text with what cannot be shown (control characters, lone surrogates) as U+FFFD."""
    return "".join(
        "\ufffd" if unicodedata.category(c) in {"Cc", "Cs", "Cn"} and c != "\n" else c for c in text
    )


def short(text: Any) -> str:
    r"""Return text that no renderer takes for a formula, on one line, and no longer than a title may be.

    >>> short("5 $ a\nline")
    '5 \\$ a line'
    """
    words = " ".join(str(text).split())
    shown = "".join(c for c in words if c.isprintable())
    cut = shown if len(shown) <= LONGEST else shown[: LONGEST - 1] + "…"
    return cut.replace("$", r"\$")


def name(given: str) -> str:
    r"""Return the name of a quantity, a body or a joint as a formula; other text as it is.

    >>> name("theta_dot"), name("a < b")
    ('$\\dot{\\theta}$', 'a < b')
    """
    return f"${symbol_latex(given)}$" if _NAME.fullmatch(given) else short(given)


def formula(value: Any, otherwise: str) -> str:
    r"""Return an expression as a formula, or other words where it is too long to stand at an arrow.

    >>> formula(-sp.Symbol("M1"), "torque")
    '$-M_{1}$'
    """
    long = [r for r in value.atoms(sp.Rational) if r.q > MOST_PARTS]
    short = value.xreplace({r: sp.Float(r, DIGITS) for r in long})
    found = render(row(*expression_pieces(short)), "latex")
    return f"${found}$" if len(found) <= LONGEST else otherwise


def unit(given: str) -> str:
    """Return a unit with raised digits.

    >>> unit("kg m^2/s^2"), unit("1")
    ('kg m²/s²', '')
    """
    words = re.sub(r"\^(-?\d+)", lambda found: found[1].translate(_RAISED), short(given))
    return "" if words == "1" else words


def spans(text: str) -> list[Span]:
    r"""Return plain text and formulas in turn; a dollar sign without a partner is a character.

    >>> [(s.text, s.formula) for s in spans(r"rate $\omega_1$ [rad/s]")]
    [('rate ', False), ('\\omega_1', True), (' [rad/s]', False)]
    """
    pieces = _DOLLAR.split(clean(text))
    if len(pieces) % 2 == 0:
        return [Span(text.replace(r"\$", "$"), formula=False)]
    found = [
        Span(piece if k % 2 else piece.replace(r"\$", "$"), formula=k % 2 == 1)
        for k, piece in enumerate(pieces)
    ]
    return [span for span in found if span.text]


def wrapped(text: str, letters: float) -> str:
    r"""Return words in lines of at most ``letters`` where there are spaces, formulas kept whole.

    >>> wrapped(r"rate $\omega_1 + 1$ of the body", 12)
    'rate $\\omega_1 + 1$\nof the body'
    """
    lines, width = [""], 0
    for word in _WORDS.findall(text):
        size = len(as_text(word))
        if lines[-1] and width + 1 + size > letters:
            lines.append(word)
            width = size
        else:
            lines[-1] = f"{lines[-1]} {word}".strip()
            width += size + 1
    return "\n".join(lines)


def as_html(text: str) -> str:
    r"""Return words as HTML with ``sub``, ``sup``, ``b`` and ``i`` alone, all else escaped.

    >>> as_html(r"$\dot{\omega}_1$ < 2")
    '<i>\u03c9\u0307</i><sub>1</sub> &lt; 2'
    """
    return "".join(
        _formula(s.text) if s.formula else html.escape(s.text).replace("\n", "<br>")
        for s in spans(text)
    )


def as_text(text: str) -> str:
    r"""Return words without markup, for titles of windows and descriptions.

    >>> as_text(r"$\omega_1$ of body")
    '\u03c9_1 of body'
    """
    marked = as_html(text).replace("<sub>", "_").replace("<sup>", "^").replace("<br>", "\n")
    return html.unescape(re.sub(r"</?(?:sub|sup|b|i)>", "", marked))


Run = tuple[str, str, str]


def as_runs(text: str) -> list[Run]:
    r"""Return words as runs: text, its style ("", "i" or "b") and level ("", "sub" or "sup").

    >>> as_runs(r"$\omega_1$ [rad/s]")
    [('\u03c9', 'i', ''), ('1', '', 'sub'), (' [rad/s]', '', '')]
    """
    first, *parts = _TAG.split(as_html(text).replace("<br>", " "))
    made = [(first, "", "")]
    styles, levels = [""], [""]
    for closed, tag, piece in zip(parts[::3], parts[1::3], parts[2::3], strict=True):
        within = levels if tag in LEVELS.values() else styles
        if closed:
            within.pop()
        else:
            within.append(tag)
        made.append((piece, styles[-1], levels[-1]))
    return [(html.unescape(piece), style, level) for piece, style, level in made if piece]


def _formula(source: str) -> str:
    parts, rest = _sequence([t for t in _TOKEN.findall(source) if not t.isspace()], "")
    return parts + html.escape("".join(rest))


def _sequence(tokens: list[str], end: str) -> tuple[str, list[str]]:
    """Return the HTML of tokens up to ``end``, and what follows it."""
    made = ""
    while tokens and tokens[0] != end:
        piece, tokens = _one(tokens)
        made += piece
    return made, tokens[1:]


def _one(tokens: list[str]) -> tuple[str, list[str]]:
    """Return the HTML of one token or group, and what follows it."""
    first, rest = tokens[0], tokens[1:]
    name = first[1:] if first.startswith("\\") else ""
    if first == "{":
        return _sequence(rest, "}")
    if first in LEVELS and rest:
        inner, rest = _one(rest)
        return f"<{LEVELS[first]}>{inner}</{LEVELS[first]}>", rest
    if name in ACCENTS and rest:
        inner, rest = _one(rest)
        at = inner.rfind("</") if inner.endswith(">") else len(inner)
        return inner[:at] + ACCENTS[name][1] + inner[at:], rest
    if name in STYLES and rest:
        return _styled(rest, STYLES[name])
    character = SYMBOLS.get(name, name) if name else first
    shown = html.escape(character.replace("-", "\u2212"))
    return (f"<i>{shown}</i>" if character.isalpha() and len(character) == 1 else shown), rest


def _styled(tokens: list[str], tag: str) -> tuple[str, list[str]]:
    inner, rest = _one(tokens)
    inner = re.sub(r"</?i>", "", inner)
    return (f"<{tag}>{inner}</{tag}>" if tag else inner), rest
