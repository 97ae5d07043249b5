r"""Words of pictures: names as formulas, units with raised digits, and text of users as nothing but text.

In a picture's words a formula stands between dollar signs. Names and titles come from users, so that
a dollar sign of theirs is written ``\$``.
"""

from __future__ import annotations

import re
from typing import Any

import sympy as sp

from eom.typeset.boxes import row
from eom.typeset.markup import render, symbol_latex
from eom.typeset.writing import expression_pieces

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
_RAISED = str.maketrans("-0123456789", "\N{SUPERSCRIPT MINUS}⁰¹²³⁴⁵⁶⁷⁸⁹")
MOST_PARTS, DIGITS = 100, 4
"""Fractions with larger denominators are written as decimals, of some digits."""
LONGEST = 80
"""Letters of a name or title of a user's that are shown."""


def plain(text: Any) -> str:
    r"""Return text that no renderer takes for a formula, on one line.

    >>> plain("5 $ a\nline")
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
    return f"${symbol_latex(given)}$" if _NAME.fullmatch(given) else plain(given)


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
    words = re.sub(r"\^(-?\d+)", lambda found: found[1].translate(_RAISED), plain(given))
    return "" if words == "1" else words
