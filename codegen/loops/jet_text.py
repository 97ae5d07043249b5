"""Pieces of C text for Taylor coefficients: vectors of four numbers, expressions, lines that are needed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

_CONSTANT, _WORD = re.compile(r"\s*const \w+ (\w+) = "), re.compile(r"\w+")

DECLARATIONS = """\
/* Four numbers at once: vectors of the compiler, or what comes to the same. */
#if defined(__GNUC__)
typedef double HEAD_pack __attribute__((vector_size(32)));
#define HEAD_PACK(a, b, c, d) ((HEAD_pack){a, b, c, d})
#define HEAD_TIMES(a, b) ((a) * (b))
#define HEAD_PLUS(a, b) ((a) + (b))
#define HEAD_MORE(s, a, b) ((s) + (a) * (b))
#define HEAD_SCALED(a, factor, rest) ((a) * (factor) + (a) * (rest))
#define HEAD_BY(a, factor) ((a) * (factor))
#define HEAD_PLACE(a, n) ((a)[n])
#if defined(__clang__) || __GNUC__ >= 12
#define HEAD_CHOSEN __builtin_shufflevector
#endif
#else
typedef struct { double v[4]; } HEAD_pack;
#define HEAD_EACH(name, n, expression) \\
    static inline HEAD_pack name { HEAD_pack r; for (int n = 0; n < 4; ++n) r.v[n] = expression; return r; }
static inline HEAD_pack HEAD_PACK(double a, double b, double c, double d) {
    return (HEAD_pack){{a, b, c, d}};
}
HEAD_EACH(HEAD_TIMES(HEAD_pack a, HEAD_pack b), n, a.v[n] * b.v[n])
HEAD_EACH(HEAD_PLUS(HEAD_pack a, HEAD_pack b), n, a.v[n] + b.v[n])
HEAD_EACH(HEAD_MORE(HEAD_pack s, HEAD_pack a, HEAD_pack b), n, s.v[n] + a.v[n] * b.v[n])
HEAD_EACH(HEAD_SCALED(HEAD_pack a, double factor, double rest), n, a.v[n] * factor + a.v[n] * rest)
HEAD_EACH(HEAD_BY(HEAD_pack a, double factor), n, a.v[n] * factor)
#define HEAD_PLACE(a, n) ((a).v[n])
#endif
#ifndef HEAD_CHOSEN
#define HEAD_OF(a, b, n) ((n) < 4 ? HEAD_PLACE(a, (n) % 4) : HEAD_PLACE(b, (n) % 4))
#define HEAD_CHOSEN(a, b, i, j, k, l) \\
    HEAD_PACK(HEAD_OF(a, b, i), HEAD_OF(a, b, j), HEAD_OF(a, b, k), HEAD_OF(a, b, l))
#endif
"""
"""What every file of coefficients begins with."""


@dataclass(frozen=True)
class Text:
    """A coefficient as a C expression in brackets; an empty one is zero."""

    text: str

    def __str__(self) -> str:
        return self.text or "0.0"

    def __neg__(self) -> Text:
        return Text(f"(-{self})") if self.text else self

    def __add__(self, other: Text) -> Text:
        if not (self.text and other.text):
            return self if self.text else other
        return Text(f"({self} + {other})")

    def __sub__(self, other: Text) -> Text:
        return Text(f"({self} - {other})") if self.text and other.text else self + -other

    def __rsub__(self, other: Fraction) -> Text:
        return Text(f"({float(other)!r} - {self})")

    def __mul__(self, other: Text | Fraction) -> Text:
        factor = other if isinstance(other, Text) else Text(repr(float(other)))
        return Text(f"({self} * {factor})" if self.text and factor.text else "")


ZERO = Text("")


def four(texts: Iterable[object]) -> str:
    """Return the vector of four expressions."""
    return f"HEAD_PACK({', '.join(map(str, texts))})"


def summed(names: Sequence[str]) -> str:
    """Return the sum of vectors."""
    text = names[0]
    for name in names[1:]:
        text = f"HEAD_PLUS({text}, {name})"
    return text


def inverses(order: int, rests: bool) -> list[str]:
    """Return the lines of 1/k, and what one double lacks of it."""
    exact = [Fraction(1, max(1, k)) for k in range(order + 1)]
    lines = [
        f"static const double inverse[] = {{{', '.join(repr(float(e)) for e in exact)}}};",
    ]
    lacking = [float(e - Fraction(float(e))) for e in exact]
    rest = f"static const double rest[] = {{{', '.join(map(repr, lacking))}}};"
    return [*lines, rest] if rests else lines


def needed(lines: Sequence[str]) -> list[str]:
    """Leave out constants that no later line reads."""
    found: list[str] = []
    read: set[str] = set()
    for line in reversed(lines):
        made = _CONSTANT.match(line)
        if made is None or made[1] in read:
            found.append(line)
            read.update(_WORD.findall(line))
    return found[::-1]
