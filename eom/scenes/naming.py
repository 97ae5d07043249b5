"""Names that users may give to parameters and inputs."""

from __future__ import annotations

import keyword
import re
import unicodedata
from collections.abc import Collection, Iterable

from eom.errors import InputError
from eom.scenes import parse

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
_C_KEYWORDS = (
    "auto break case char const continue default do double else enum extern float for goto if inline int "
    "long register restrict return short signed sizeof static struct switch typedef union unsigned void "
    "volatile while"
)
RESERVED = frozenset(
    {*_C_KEYWORDS.split(), *keyword.kwlist, *parse.FUNCTIONS, *parse.CONSTANTS, "t"}
)


def check_names(names: Iterable[str], where: str) -> None:
    """Raise `InputError` for names that cannot be used in formulas and every generated language."""
    for name in names:
        if not _NAME.fullmatch(name):
            spelt = spelling(name)
            raise InputError(
                f"name {name!r} cannot be used",
                where=where,
                expected="a letter, then letters, digits and underscores; 64 characters at most",
                hint=f"write {spelt}" if _NAME.fullmatch(spelt) else "spell it in letters",
            )
        if name in RESERVED:
            raise InputError(
                f"name {name!r} is reserved",
                where=where,
                expected="a name that is no keyword of C or Python and no function of formulas",
                hint=f"write {name}_0",
            )


def check_used(names: Iterable[str], used: Collection[str], hint: str) -> None:
    """Raise `InputError` for the first parameter or input that no formula uses."""
    for name in names:
        if name not in used:
            where = "[parameters] or [inputs]"
            raise InputError(f"no formula uses {name!r}", where=where, hint=hint)


def spelling(name: str) -> str:
    """Spell a name in ASCII letters: Greek letters in words, primes as time derivatives.

    >>> spelling("ψ'"), spelling("Ω''"), spelling("a-b")
    ('psi_dot', 'Omega_ddot', 'a_b')
    """
    primes = len(name) - len(name.rstrip("'′’"))
    letters = "".join(_letter(c) for c in name[: len(name) - primes])
    dots = "_" + "d" * (primes - 1) + "dot" if primes else ""
    return re.sub(r"[^A-Za-z0-9_]", "_", letters) + dots


def _letter(character: str) -> str:
    words = unicodedata.name(character, "").split()
    if words[:1] != ["GREEK"] or "LETTER" not in words:
        return character
    spelt = words[words.index("LETTER") + 1].lower()
    return spelt.capitalize() if "CAPITAL" in words else spelt
