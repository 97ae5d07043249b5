"""Sentences with mathematics in them: letters that words spell out are set as letters.

``omega_1``, ``theta'``, ``I_t``, ``b1``, ``lambda^2``, ``dh/dt`` stand for letters, a prime for a rate; a
lone letter is one where it is known to be, and so is ``[h_C]_B``, a column of components. Between letters
``x`` is a cross product, a full stop a dot, a hyphen a minus; 0 is that of what it is equal to.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import pairwise

from eom.typeset.boxes import (
    GREEK,
    GREEK_NAMES,
    Box,
    Fence,
    Form,
    Operator,
    Row,
    Scripts,
    Sign,
    Symbol,
    accented,
    raised,
    symbol,
)

Prose = str | tuple["str | Box", ...]
"""Words, or words and formulas in turn."""

_SPELT = "|".join(sorted(GREEK_NAMES, key=len, reverse=True))
_TOKEN = re.compile(
    r"(?<![\w\\])"
    rf"(?:d(?P<above>[A-Za-z]|{_SPELT})/d(?P<below>[A-Za-z]|{_SPELT})(?![\w(])"
    r"|(?P<mass>dm)(?!\w)"
    rf"|(?P<name>\[(?:{_SPELT}|[A-Za-z])(?:_\w+)?\]_[A-Z]"
    rf"|(?:{_SPELT})(?:_\w+)?|[A-Za-z]_[A-Za-z0-9]+|[A-Za-z]\d?)"
    r"(?P<marks>'*)(?:\^(?P<power>-?\d|[Tx]\b))?(?![\w(]))"
)
_AXES = re.compile(r"[abiI][123]")
_NOUN = re.compile(r" (?!(?:turns|is|and|or|to|in|as|has|moves|stays|follows|with)\b)[a-z]{2,}")
"""What follows an article that begins a sentence, or a bracket, and no letter that does something."""
_BETWEEN = re.compile(r"[\s().,=+\-/0-9<>|]*")
_PRIME = Sign("'", "'", "mo")
_DOTS = {1: "dot", 2: "ddot"}
_SIGNS = {">=": "\u2265", "<=": "\u2264", "sqrt(": "\u221a("}
"""Signs that words spell."""
_SPELT_SIGNS = re.compile("|".join(map(re.escape, _SIGNS)))

Setting = Callable[[Box], str]
"""Writes a formula within words."""


def sentence(
    words: Prose,
    setting: Setting,
    plain: Callable[[str], str] = str,
    known: Mapping[str, Box] | None = None,
) -> str:
    """Return ``words`` with letters written by ``setting``, and all else by ``plain``."""
    parts = phrases(words, known or {}) if isinstance(words, str) else words
    return "".join(plain(p) if isinstance(p, str) else setting(p) for p in parts)


def phrases(words: str, known: Mapping[str, Box], *, apart: bool = False) -> tuple[str | Box, ...]:
    """Return words and formulas in turn; ``known``: the boxes of names, also of lone letters.

    ``apart``: signs between letters stay words, as what is so written states nothing of the page.
    Under ``h = 0`` is the zero that ``h`` can be equal to, under ``C = 1`` the unit.
    """
    found = [(m.start(), m.end(), box) for m, box in _letters(words, known)]
    found = sorted([*found, *_values(words, found, known)], key=lambda f: f[0])
    return _joined(
        words, found if apart else [f for r in _runs(words, found) for f in _whole(words, r)]
    )


def names_in(words: str, known: Mapping[str, Box]) -> Iterator[str]:
    """Yield the names that are set as letters in words, without marks and powers."""
    yield from (m["name"] for m, _ in _letters(words, known) if m["name"])


def _letters(words: str, known: Mapping[str, Box]) -> list[tuple[re.Match[str], Box]]:
    found: list[tuple[re.Match[str], Box]] = []
    for m in _TOKEN.finditer(words):
        before = found[-1][0].end() if found else None
        box = None if _is_cross(words, m, before) else _box(words, m, known)
        if box is not None:
            found.append((m, box))
    return found


_VALUE = re.compile(r" = ([01])(?![\w.]*\w)")


def _values(words: str, found: list[Found], known: Mapping[str, Box]) -> Iterator[Found]:
    """Yield 0 and 1 where they are equal to a letter, or a product of letters, that is no number."""
    starts = {end: start for start, end, _ in found}
    for m in _VALUE.finditer(words):
        start = starts.get(m.start())
        value = None if start is None else known.get(words[start : m.end()])
        while start is not None and words[:start].endswith(" x ") and start - 3 in starts:
            start = starts[start - 3]
        if value is not None and not words[:start].endswith((".", "(")):
            yield m.start(1), m.end(1), value


_FACTOR = re.compile(r"(?:(?<![\w'])[A-Za-z](?:_\w+|\d)?'*|\))$")


def _is_cross(words: str, m: re.Match[str], end: int | None) -> bool:
    """Return whether a token is the sign of a cross product: x after a letter or a bracket.

    ``end``: of the letter before.
    """
    if m[0] != "x" or words[m.start() - 1 : m.start()] != " " or words[m.end() :][:1] != " ":
        return False
    before = words[: m.start() - 1]
    return _FACTOR.search(before) is not None or end == len(before)


def _box(words: str, m: re.Match[str], known: Mapping[str, Box]) -> Box | None:
    if m["above"]:
        parts = (symbol(m["above"]), Operator("slash"), Operator("d"), symbol(m["below"]))
        of = known.get(m["above"], parts[0])
        return Row((Operator("d"), of, *parts[1:]))
    if m["mass"]:
        return Row((Operator("d"), symbol("m")))
    name, marks, power = m["name"], m["marks"], m["power"]
    if name.startswith("[") and name not in known:
        return None
    if words.rfind("[", 0, m.start()) > words.rfind("]", 0, m.start()):  # a unit
        return raised(Symbol(name, "roman"), _power(power)) if power else None
    if _is_word(words, m, known):
        return None
    lettered = "_" in name or name in GREEK_NAMES or _AXES.fullmatch(name) or power or marks
    lettered = lettered or (bool(known) and _is_capital(words, m)) or _is_beside_cross(words, m)
    if name not in known and not lettered and name.partition("_")[0] not in GREEK:
        return None
    box = known.get(name, symbol(name))
    box = known.get(f"{name}{marks}") or _rate(box, len(marks)) if marks else box
    return raised(box, _power(power)) if power else box


def _rate(box: Box, count: int) -> Box:
    """Return a letter with dots, or with primes where there is no room for dots."""
    dotted = accented(_DOTS[count], box) if count in _DOTS else None
    if dotted is not None:
        return dotted
    held = Form("braces", (box,)) if isinstance(box, Scripts) and box.sup is not None else box
    return Row((held, *[_PRIME] * count))


def _power(word: str) -> Box:
    if word == "x":
        return Operator("cross-mark")
    if word.startswith("-"):
        return Row((Operator("negative"), Symbol(word[1:])))
    return Symbol(word, "roman" if word == "T" else "italic")


def _is_beside_cross(words: str, m: re.Match[str]) -> bool:
    """Return whether a letter is a factor of a cross product or stands beside a bracket with a dot."""
    before, after = words[: m.start()], words[m.end() :]
    factor = re.match(r" x [A-Za-z(]", after) or re.search(r"(\w'*|\)) x \(?$", before)
    return factor is not None or before.endswith(").") or after.startswith(".(")


def _is_word(words: str, m: re.Match[str], known: Mapping[str, Box]) -> bool:
    """Return whether a lone letter is an article, or stands behind an apostrophe."""
    if words[m.start() - 1 : m.start()] == "'" and m.start():
        return True
    if m["name"] == "a" and not (m["power"] or m["marks"] or _is_beside_cross(words, m)):
        around = words[max(0, m.start() - 3) : m.start()], words[m.end() :]
        noun = _NOUN.match(words, m.end()) is not None
        near = around[0].rstrip().endswith(("=", "-", "+", "/", *("(" * (not noun))))
        near = near or re.search(r"\w\.$", around[0]) is not None
        near = near or around[1][:1] in {"", ".", ","} or around[1].startswith(" along ")
        return "a" not in known or not near
    begins = not m.start() and _NOUN.match(words, m.end()) is not None
    return m["name"] == "A" and (begins or words[: m.start()].endswith(". "))


def _is_capital(words: str, m: re.Match[str]) -> bool:
    """Return whether a lone capital is a letter: no word, and no unit in brackets."""
    before = words[: m.start()]
    inside = before.rfind("[") > before.rfind("]")
    return m["name"] in set("BCDEFGHJKLMNOPQRSTUVWXYZ") and not inside


Found = tuple[int, int, Box]
"""Where a letter or formula begins and ends, and what it is."""


def _joined(words: str, found: Iterable[Found]) -> tuple[str | Box, ...]:
    """Return words and formulas in turn."""
    marks = [(0, 0, None), *found, (len(words), len(words), None)]
    parts: list[str | Box] = []
    for (_, end, before), (start, _, after) in pairwise(marks):
        parts.append(_spelt(words[end:start], before, after))
        parts += [after] if after is not None else []
    return tuple(p for p in parts if p != "")


def _spelt(gap: str, before: Box | None, after: Box | None) -> str:
    """Return what stands between formulas, signs set as such.

    Behind a matrix in brackets there is no dot: such a notation writes them side by side.
    """
    beside = gap == "." and isinstance(before, Fence) and before.opening == "["
    gap = " " if beside else _signs(gap, before is not None, after is not None)
    return _SPELT_SIGNS.sub(lambda m: _SIGNS[m[0]], gap)


_WITHIN: dict[str, Box] = {
    **{f" {sign} ": Sign(latex, f" {sign} ") for sign, latex in (("<", " < "), (">", " > "))},
    **{
        f" {sign} ": Sign(latex, f" {sign} ")
        for sign, latex in (("\u2264", r" \le "), ("\u2265", r" \ge "))
    },
    " = ": Operator("="),
    " + ": Operator("plus"),
    " \u2212 ": Operator("minus"),
    " \u00b7 ": Operator("dot"),
    " \u00d7 ": Operator("cross"),
    "\u2212": Operator("negative"),
    "/": Operator("slash"),
    "(": Operator("("),
    ")": Operator(")"),
    **{f"{f} ": Row((Sign(f"\\{f}", f, "mi"), Operator("thin"))) for f in ("cos", "sin")},
    " ": Operator("thin"),
}
"""Signs that are of one formula with the letters on both sides."""
_SIGN = re.compile("|".join(map(re.escape, sorted(_WITHIN, key=len, reverse=True))))


def _runs(words: str, found: Iterable[Found]) -> list[list[Found]]:
    """Return letters, those together that have nothing but signs between them."""
    runs: list[list[Found]] = []
    for one in found:
        last = runs[-1][-1] if runs else None
        gap = words[last[1] : one[0]] if last else ""
        if last and not _SIGN.sub("", _spelt(gap, last[2], one[2])):
            runs[-1].append(one)
        else:
            runs.append([one])
    return runs


def _whole(words: str, run: list[Found]) -> list[Found]:
    """Return a run as one formula, with the brackets that it lacks from the words around it.

    Where there are none it stays apart.
    """
    items: list[Box] = [run[0][2]]
    depth = lowest = 0
    for (_, end, before), (start, _, after) in pairwise(run):
        for m in _SIGN.finditer(_spelt(words[end:start], before, after)):
            depth += {"(": 1, ")": -1}.get(m[0], 0)
            lowest = min(lowest, depth)
            items.append(_WITHIN[m[0]])
        items.append(after)
    start, end = run[0][0] + lowest, run[-1][1] + depth - lowest
    opened, closed = words[max(0, start) : run[0][0]], words[run[-1][1] : end]
    if len(run) == 1 or opened != "(" * -lowest or closed != ")" * (depth - lowest):
        return run
    brackets = [_WITHIN["("]] * -lowest, [_WITHIN[")"]] * (depth - lowest)
    return [(start, end, Row((*brackets[0], *items, *brackets[1])))]


def _signs(gap: str, before: bool, after: bool) -> str:
    gap = re.sub(r"(?<= )-(?=\d)" if not before else r"(?<= )-(?= ?\d)", "\u2212", gap)
    if before and after and _BETWEEN.fullmatch(gap.replace(" x ", " ")):
        gap = re.sub(r"(?<! )\.(?! )", " \u00b7 ", gap).replace(" x ", " \u00d7 ")
        return gap.replace("-", "\u2212")
    if after:
        gap = re.sub(r"(?<![\w)])-(?=\(?$)|(?<= )-(?= $)", "\u2212", gap)
        gap = re.sub(r"(?<=\)) x (?=\(?$)", " \u00d7 ", gap)
    if before:
        gap = re.sub(r"^ x (?=\()", " \u00d7 ", gap)
    return gap
