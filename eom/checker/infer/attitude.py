r"""What words say of attitude coordinates: sequences of angles, and components of quaternions.

"the 3-2-1 angles $\psi$, $\theta$, $\phi$", "yaw $\psi$, pitch $\theta$ and roll $\phi$",
"the 3-1-3 sequence: $\phi$ about z, $\theta$ about the line of nodes, $\psi$ about z'": angles belong to
a sequence only where words name it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from eom.checker.infer.sayings import LIST, MARK, Mention, Prose
from eom.checker.read.symbol_shape import Look

COLUMNS = frozenset(
    "quaternion quaternion_last euler_vector rodrigues modified_rodrigues shadow_rodrigues "
    "principal_axis".split()
)
"""Quantities that are written as plain letters by some, as marked ones by others."""

_NUMBERS = re.compile(r"\b([123])\s?[-–—]\s?([123])\s?[-–—]\s?([123])\b|\b([123])([123])([123])\b")
_LETTERS = re.compile(r"\b([xyzXYZ])\s?[-–—]?\s?([xyzXYZ])\s?[-–—]?\s?([xyzXYZ])\b")
_YAW = (
    (
        re.compile(
            r"yaw\W+(?:⟦\d+⟧\W+)?(?:and )?pitch\W+(?:⟦\d+⟧\W+)?(?:and )?roll", re.IGNORECASE
        ),
        "321",
    ),
    (re.compile(r"roll\W+(?:and )?pitch\W+(?:and )?yaw", re.IGNORECASE), "space123"),
)
_FIXED = re.compile(
    r"space[- ](?:fixed|three|two|axes|order)|fixed axes|extrinsic|\bspace\b", re.IGNORECASE
)
_ANGLES = re.compile(r"angle|rotation|sequence|turn", re.IGNORECASE)
_NAMED = re.compile(rf"\b(yaw|heading|pitch|roll|bank)(?: angle)?\s+({MARK})", re.IGNORECASE)
_TURNS = {"yaw": 1, "heading": 1, "pitch": 2, "roll": 3, "bank": 3}
_LISTS = re.compile(LIST)
_ABOUT = re.compile(rf"({MARK})\s+(?:\([^)]*\)\s+)?(?:about|around)\b")


def angles(text: Prose) -> Iterator[tuple[Look, str, str, int]]:
    """Yield the angles of sequences that words name, with what they mean, the words and their line."""
    for k, sentence in enumerate(text.sentences):
        window = " ".join(text.sentences[k : k + 2])
        for part in (*re.split(r"[;,] (?=the \d-)", sentence), window):
            several = " ".join(text.sentences[k : k + 3]) if part is window else part
            axes, of = _turn_by_turn(text, several)
            if not axes:
                axes = _sequence(part)
                of = _of(text, part) if axes else ()
            if of:
                for number, mention in enumerate(of, 1):
                    words = text.shown(sentence)[-70:]
                    yield mention.look, f"turn_angle {number} {axes} B I", words, mention.line


_ORDINALS = {"first": "1", "second": "2", "third": "3", "x": "1", "y": "2", "z": "3"}
_ONE_BY_ONE = re.compile(
    rf"({MARK})[^⟦]{{0,40}}?\babout\s+(?:the\s+)?(?:(?:new|final|carried|rotated|body|resulting|inertial)\s+)*"
    r"(first|second|third|[xyz123])(?:[- ]|'+\s?)ax[ie]s",
    re.IGNORECASE,
)
"""An angle with the axis about which it turns, where a sequence is told turn by turn."""


def _turn_by_turn(text: Prose, words: str) -> tuple[str, tuple[Mention, ...]]:
    """Return the axes and the angles of three turns that are told one after the other."""
    found = [(text.marked(m[1])[0], m[2].lower()) for m in _ONE_BY_ONE.finditer(words)]
    axes = "".join(_ORDINALS.get(a, a) for _, a in found)
    of = tuple(m for m, _ in found)
    whole = len(axes) == 3 and axes[0] != axes[1] != axes[2] and all(_is_angle(m.look) for m in of)
    return (axes, of) if whole else ("", ())


def _of(text: Prose, words: str) -> tuple[Mention, ...]:
    """Return the three angles that words list: by their names, in order, or each with its axis."""
    named = {_TURNS[m[1].lower()]: text.marked(m[2])[0] for m in _NAMED.finditer(words)}
    if set(named) == {1, 2, 3}:
        return tuple(named[k] for k in (1, 2, 3))
    lists = [text.marked(m[0]) for m in _LISTS.finditer(words)]
    about = tuple(text.marked(m[1])[0] for m in _ABOUT.finditer(words))
    for of in (*lists, about):
        if len({m.look for m in of}) == len(of) == 3 and all(_is_angle(m.look) for m in of):
            return of
    return ()


_TURNED = re.compile(
    rf"\b(?:turn|lean|rotate|spin|tilt|roll)(?:s|ed)?\b[^.;⟦]{{0,30}}?({MARK})\s+(?:about|around)\b",
    re.IGNORECASE,
)


def turned(text: Prose) -> Iterator[Look]:
    r"""Yield letters that words call the angle of a turn: "leans by $\theta$ about the first axis"."""
    for sentence in text.sentences:
        for match in _TURNED.finditer(sentence):
            look = text.marked(match[1])[0].look
            if _is_angle(look):
                yield look


_AXIS = rf"about\s+(?:(?!{MARK})[^.;])*?({MARK})"
_BY = rf"(?:through|by|of)\s+(?:(?!{MARK})[^.;])*?\bangle\s+({MARK})"
_ONE_TURN = re.compile(
    rf"\b(?:turn|turned|rotation|rotated|rotates|turns)\b(?:(?!{MARK})[^.;])*?"
    rf"(?:\b(?P<a>{_AXIS})(?:(?!{MARK})[^.;])*?\b{_BY}|\b(?P<b>{_BY})(?:(?!{MARK})[^.;])*?\b{_AXIS})",
    re.IGNORECASE,
)
_SOME_AXIS = re.compile(r"\b(?:unit|axis|direction|euler\S*|column)\b", re.IGNORECASE)
_FRAME_AXIS = re.compile(r"\b(?:first|second|third|common|[xyz123])\b(?=[^⟦]*$)", re.IGNORECASE)


def single_turns(text: Prose) -> Iterator[tuple[Look, str, str, int]]:
    """Yield the axis and the angle of one turn: "a turn about the unit vector $n$ through $a$"."""
    for sentence in text.sentences:
        match = _ONE_TURN.search(sentence)
        if match is None:
            continue
        marks_ = text.marked(match[0])
        axis, angle = marks_ if match["a"] else reversed(marks_)
        about = match[0].split("about", 1)[1].split("⟦")[0]
        if not _SOME_AXIS.search(about) or _FRAME_AXIS.search(about) or axis.look.sub:
            continue
        if angle.look.accents or angle.look.style or angle.look.sub:
            continue
        words = text.shown(match[0])[-70:]
        yield axis.look, "principal_axis B I in B", words, axis.line
        yield angle.look, "principal_angle B I", words, angle.line


_LETTERS_OF_ANGLES = frozenset(
    "alpha beta gamma delta phi varphi theta vartheta psi chi eta xi mu nu kappa lambda sigma".split()
)


def _is_angle(look: Look) -> bool:
    """Return whether a symbol looks like an angle: a plain small Greek letter that is usual for one."""
    return not look.accents and not look.style and look.name in _LETTERS_OF_ANGLES


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
