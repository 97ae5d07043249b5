r"""What the words of a note say of its attitude coordinates: sequences of angles, quaternions, axes.

"the 3-2-1 Euler angles $\psi$, $\theta$, $\phi$", "$(\phi, \theta, \psi)$ are roll, pitch and yaw": three
angles belong to a sequence only where the words beside them name it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from eom.checker.read.documents import Piece
from eom.checker.read.looks import Look, seen
from eom.checker.read.reading import Formula
from eom.checker.read.syntax import Group, Node, Sequence

ATTITUDE_WINDOW = 110
"""Characters of prose on either side of a list of angles."""

Said = tuple[Look, str, str, int]
"""A symbol, what it means, the words that say so, their line."""

ATTITUDE_PHRASES: tuple[tuple[str, str, str], ...] = (
    ("symbols", r"shadow (?:set|parameters)", "shadow_rodrigues B I in B"),
    ("symbols", r"modified rodrigues|\bMRPs?\b", "modified_rodrigues B I in B"),
    (
        "symbols",
        r"rodrigues (?:parameters|vector)|gibbs(?:ian)? vector|\bCRPs?\b",
        "rodrigues B I in B",
    ),
    (
        "symbols",
        r"scalar part|scalar (?:euler|component of the quaternion)",
        "euler_parameter 0 B I",
    ),
    ("symbols", r"vector part", "euler_vector B I in B"),
    (
        "symbols",
        r"quaternion,? (?:\w+ )*scalar[- ](?:part |component )?last",
        "quaternion_last B I",
    ),
    ("symbols", r"scalar[- ]last quaternion", "quaternion_last B I"),
    ("symbols", r"quaternion|euler parameters", "quaternion B I"),
    (
        "symbols",
        r"(?:principal|euler|rotation) axis|axis of (?:the )?rotation|euler vector",
        "principal_axis B I in B",
    ),
    ("symbols", r"principal (?:rotation )?angle|angle of (?:the )?rotation", "principal_angle B I"),
)
"""Words that say what a symbol of attitude is, as in `eom.checker.mean.propose`."""

SCALARS = frozenset({"turn_angle", "principal_angle", "euler_parameter", "free_angle"})
COLUMNS = frozenset(
    "quaternion quaternion_last euler_vector rodrigues modified_rodrigues shadow_rodrigues "
    "principal_axis".split()
)
"""Quantities that are written as plain letters by some, as marked ones by others."""

_NUMBERS = re.compile(r"\b([123])\s?[-–—]\s?([123])\s?[-–—]\s?([123])\b|\b([123])([123])([123])\b")
_LETTERS = re.compile(r"\b([xyzXYZ])\s?[-–—]?\s?([xyzXYZ])\s?[-–—]?\s?([xyzXYZ])\b")
_YAW = (
    (re.compile(r"yaw\W+(?:and )?pitch\W+(?:and )?roll", re.IGNORECASE), "321"),
    (re.compile(r"roll\W+(?:and )?pitch\W+(?:and )?yaw", re.IGNORECASE), "space123"),
)
_FIXED = re.compile(
    r"space[- ](?:fixed|three|two|axes|order)|fixed axes|extrinsic|\bspace\b", re.IGNORECASE
)
_ANGLES = re.compile(r"angle|rotation|sequence|turn", re.IGNORECASE)
_BETWEEN = re.compile(r"^[\s,$]*(?:and|then)?[\s,$]*$")


def angles(formulas: tuple[Formula, ...]) -> Iterator[Said]:
    """Yield the angles of sequences that the words beside them name."""
    for looks, before, after, line in _lists(formulas):
        said = next(((s, text) for text in (before, after) if (s := _sequence(text))), None)
        if len(looks) == len(set(looks)) == 3 and said is not None:
            for k, look in enumerate(looks, 1):
                yield look, f"turn_angle {k} {said[0]} B I", said[1], line


def components(look: Look, meaning: str) -> Iterator[tuple[Look, str]]:
    """Yield the components that go with a letter: of a quaternion, of Rodrigues parameters."""
    quantity, *labels = meaning.split()
    if look.sub or look.sup:
        return
    bare = replace(look, accents=(), style="")
    if quantity in {"quaternion", "quaternion_last"}:
        last = quantity == "quaternion_last"
        yield replace(bare, sub=("4" if last else "0",)), f"euler_parameter 0 {' '.join(labels)}"
        yield replace(bare, sub=("<k>",)), f"euler_parameter <k> {' '.join(labels)}"
    elif quantity in COLUMNS:
        yield replace(bare, sub=("<k>",)), f"{meaning} component <k>"


def ordered(meaning: str, words: str) -> str:
    """Return the quaternion in the order that words say: the scalar first, unless it is last."""
    last = re.search(r"scalar[- ](?:part |component |element )?last|last .*\bscalar\b", words)
    return meaning.replace("quaternion ", "quaternion_last ") if last else meaning


def _sequence(words: str) -> str:
    """Return the sequence that words name, or nothing."""
    if not _ANGLES.search(words) and not any(p.search(words) for p, _ in _YAW):
        return ""
    digits = _NUMBERS.search(words)
    axes = "".join(d for d in digits.groups() if d) if digits else ""
    letters = _LETTERS.search(words)
    if not axes and letters:
        axes = "".join(str("xyz".index(c.lower()) + 1) for c in letters.groups())
    if axes and axes[0] != axes[1] != axes[2]:
        return f"space{axes}" if _FIXED.search(words) else axes
    return next((axes for pattern, axes in _YAW if pattern.search(words)), "")


def _lists(formulas: tuple[Formula, ...]) -> Iterator[tuple[list[Look], str, str, int]]:
    """Yield symbols that stand in a row in the text, with the words before and after them."""
    inline = [f for f in formulas if f.piece.kind == "inline" and f.reading is not None]
    k = 0
    while k < len(inline):
        looks = _looks(inline[k])
        first = last = inline[k].piece
        while looks and k + 1 < len(inline) and _adjoining(last, inline[k + 1].piece):
            more = _looks(inline[k + 1])
            if not more:
                break
            k, last = k + 1, inline[k + 1].piece
            looks += more
        k += 1
        if looks:
            text = first.source.text
            before = _sentence(
                text[max(0, first.span.start - ATTITUDE_WINDOW) : first.span.start], last=True
            )
            after = _sentence(text[last.span.stop : last.span.stop + ATTITUDE_WINDOW], last=False)
            yield looks, before, after, first.line


def _adjoining(a: Piece, b: Piece) -> bool:
    between = a.source.text[a.span.stop : b.span.start]
    return (
        a.source is b.source
        and _BETWEEN.match(between.replace("\\(", "").replace("\\)", "")) is not None
    )


def _looks(formula: Formula) -> list[Look]:
    """Return the symbols of a formula that is a list of them, in brackets or without."""
    node: Node | None = formula.reading.tree if formula.reading is not None else None
    if isinstance(node, Group):
        node = node.body
    items = node.items if isinstance(node, Sequence) else (node,) if node is not None else ()
    found = [seen(item) for item in items]
    return (
        [s.look for s in found if s is not None and not s.dots and not s.raised]
        if all(found)
        else []
    )


def _sentence(text: str, last: bool) -> str:
    """Return the part of a text in the sentence beside a formula."""
    plain = re.sub(r"\s+", " ", text.strip("$\\() "))
    parts = re.split(r"(?<=[.;:!?]) |\$\$", plain)
    return (parts[-1] if last else parts[0]).strip(" ,$")
