r"""Formulas as MathML for a page: converted by latex2mathml, then rebuilt from elements that are allowed.

The converter passes on what stands in ``\text`` and knows commands that set attributes; nothing of its
output is trusted. What cannot be converted is shown as it stands, as code.
"""

from __future__ import annotations

import html
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Sequence

from eom.checker.read.places import Span

MAX_LENGTH = 20_000
"""Longer formulas are shown as code."""

ELEMENTS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(
        "math mrow mfrac msqrt mroot mstyle msub msup msubsup munder mover munderover mmultiscripts "
        "mprescripts none mtable mtr mtd menclose mpadded mphantom mi mn mtext mspace".split(),
        (),
    ),
    "math": ("display",),
    "mi": ("mathvariant",),
    "mn": ("mathvariant",),
    "mo": (
        "stretchy",
        "fence",
        "separator",
        "accent",
        "form",
        "movablelimits",
        "minsize",
        "maxsize",
    ),
    "mover": ("accent",),
    "munder": ("accentunder",),
    "mfrac": ("linethickness",),
    "mstyle": ("displaystyle", "scriptlevel"),
    "mspace": ("width",),
    "mtable": ("columnalign", "rowspacing", "columnspacing"),
    "mtd": ("columnalign",),
    "menclose": ("notation",),
}
"""Elements of MathML that a page may hold, and their attributes."""

PARTS = {
    **dict.fromkeys(("mfrac", "msub", "msup", "munder", "mover", "mroot"), 2),
    **dict.fromkeys(("msubsup", "munderover"), 3),
}
"""Number of parts of an element that must have all of them."""

MARK = "blamed"
"""Class of what is at fault; the only class that is let through."""

THIN = "\u2009"
"""Space around the name of a function."""

_PLAIN = re.compile(r"[A-Za-z0-9 .,%#()-]*")
_SAFE = {"<": "\ue010", ">": "\ue011", "&": "\ue012"}
"""Characters that the converter does not escape, and what stands for them while it works."""
_BRACE = re.compile(r"\\.|[{}]", re.DOTALL)
_ROWS = re.compile(r"\\begin\{(\w+\*?)\}")
_SPELLINGS: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (re.compile(pattern), text)
    for pattern, text in (
        (r"\\prescript\s*\{([^{}]*)\}\s*\{([^{}]*)\}", r"{}^{\1}_{\2}"),
        (r"\\(?:label|ref|eqref)\s*\{[^{}]*\}", ""),
        (r"\\tag\*?\s*\{([^{}]*)\}", r"\\qquad\\text{(\1)}"),
        (r"\\(begin|end)\{(?:aligned|align\*?|alignat\*?|gathered|eqnarray\*?)\}", r"\\\1{split}"),
        (r"\\(?:notag|nonumber|displaystyle|limits|nolimits)(?![A-Za-z])", ""),
        (r"\\(?:href|style|cssId|class|unicode|require)\s*\{[^{}]*\}", ""),
        (r"\\begin\{(\w*matrix)\}", r"{\\begin{\1}"),
        (r"\\end\{(\w*matrix)\}", r"\\end{\1}}"),
        (r"\\bm(?![A-Za-z])", r"\\boldsymbol"),
        (r"\\coloneqq(?![A-Za-z])", ":="),
    )
)
"""Commands that the converter does not know, or that have no business on the page."""


def mathml(
    latex: str, *, display: bool = False, blamed: Iterable[Span] = (), marked: bool = False
) -> str:
    """Return a formula as an element of HTML: MathML, or its source as code where that fails.

    ``blamed``: places in ``latex`` to mark; a place that is no term of its own is left unmarked.
    ``marked``: whether to mark all of it.
    """
    if marked:
        blamed = [Span(0, len(latex))]
    for spans in (sorted(blamed), []):
        converted = None
        if len(latex) <= MAX_LENGTH and all(map(_balanced, _parts(latex, spans))):
            converted = _converted(_with_marks(latex, spans), display)
        if converted is not None and converted.count(f'class="{MARK}">') >= len(spans):
            return converted
    return f"<code>{html.escape(latex.strip())}</code>"


def _parts(latex: str, spans: Iterable[Span]) -> Iterator[str]:
    """Yield the formula and what is to be marked in it."""
    yield latex
    yield from (latex[s.start : s.stop] for s in spans)


def _balanced(latex: str) -> bool:
    """Tell whether every brace has its partner."""
    depth = 0
    for brace in _BRACE.findall(latex):
        depth += {"{": 1, "}": -1}.get(brace, 0)
        if depth < 0:
            return False
    return depth == 0


def _with_marks(latex: str, spans: Sequence[Span]) -> str:
    r"""Return the formula with ``\class`` around the places."""
    kept = "&" if "&" in latex and (r"\\" in latex or r"\begin" in latex) else ""
    pieces, place = [], 0
    for span in spans:
        start, stop = max(span.start, place), min(span.stop, len(latex))
        inner = _safe(latex[start:stop], kept)
        pieces += [_safe(latex[place:start], kept), rf"{{\class{{{MARK}}}{{{inner}}}}}"]
        place = stop
    return "".join([*pieces, _safe(latex[place:], kept)])


def _safe(latex: str, kept: str) -> str:
    for pattern, text in _SPELLINGS:
        latex = pattern.sub(text, latex)
    return "".join(c if c in kept else _SAFE.get(c, c) for c in latex)


def _converted(latex: str, display: bool) -> str | None:
    from latex2mathml.converter import convert

    try:
        text = convert(_aligned(latex), display="block" if display else "inline")
        root = ET.fromstring(text)  # noqa: S314 - no "<" of the note is left in it
    except Exception:  # whatever a note makes the converter raise, the source is shown
        return None
    built = _built(root)
    return None if built is None or "\\" in built else built


def _aligned(latex: str) -> str:
    """Return the body of an environment of rows with a beginning and an end."""
    bare = "&" in latex or r"\\" in latex
    return rf"\begin{{split}}{latex}\end{{split}}" if bare and not _ROWS.search(latex) else latex


def _built(root: ET.Element) -> str | None:
    """Return the text of an element, with what is allowed alone; None for one that is not."""
    names = [e.tag.rpartition("}")[2] for e in root.iter()]
    if any(name not in ELEMENTS for name in names):
        return None
    if any(len(e) != PARTS.get(n, len(e)) for e, n in zip(root.iter(), names, strict=True)):
        return None
    for element, name in zip(root.iter(), names, strict=True):
        element.tag = name
        kept = ELEMENTS.get(name, ())
        wanted = {k: v for k, v in element.attrib.items() if k in kept and _PLAIN.fullmatch(v)}
        if name == "mrow" and element.get("class") == MARK:
            wanted["class"] = MARK
        element.attrib.clear()
        element.attrib.update(wanted)
        element.text, element.tail = _restored(element.text), _restored(element.tail)
        if name == "mi" and element.text in _SAFE:
            element.tag = "mo"
        elif name == "mi" and element.text and len(element.text) > 1 and element.text.isalpha():
            element.text = f"{THIN}{element.text}{THIN}"
    return ET.tostring(root, encoding="unicode")


def _restored(text: str | None) -> str | None:
    for sign, stand_in in _SAFE.items():
        text = text.replace(stand_in, sign) if text else text
    return text
