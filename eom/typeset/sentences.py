"""Sentences with mathematics in them: letters that words spell out are set as letters.

``omega_1``, ``theta'``, ``I_t``, ``b1`` and ``lambda^2`` stand for letters; a lone letter may be a word.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from eom.typeset.boxes import GREEK, Box, symbol

_GREEK = "|".join(sorted((*GREEK, *(g.capitalize() for g in GREEK)), key=len, reverse=True))
_LETTERS = re.compile(
    rf"(?<![\w\\])((?:{_GREEK})(?:_\w+)?|[A-Za-z]_[A-Za-z0-9]+|[bI][123]|[A-Za-z](?=\^\d))('*)(?:\^(\d))?(?![\w(])"
)
_CROSS = re.compile(rf"((?<![\w\\])(?:{_GREEK})'*) x (?=[\w(])")

Setting = Callable[[Box, str, str], str]
"""Writes a letter, its primes and its power."""


def sentence(words: str, setting: Setting, plain: Callable[[str], str] = str) -> str:
    """Return ``words`` with letters written by ``setting``, and all else by ``plain``."""
    crossed = _CROSS.sub(lambda m: f"{m[1]} \u00d7 ", words)
    found, end = [], 0
    for m in _LETTERS.finditer(crossed):
        found += [plain(crossed[end : m.start()]), setting(symbol(m[1]), m[2], m[3] or "")]
        end = m.end()
    return "".join([*found, plain(crossed[end:])])
