r"""Meanings of a lexicon in plain words, for those who have a note and have never seen a lexicon.

``angular_momentum body C`` is the "angular momentum of the body about the centre of mass", ``system l`` of
a pendulum its "length"; what has no words here is told as the lexicon spells it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from eom.checker.infer.letters import FORMULA, GUESSED, Draft
from eom.checker.infer.systems import USUAL, Guess
from eom.checker.mean.lexicon import MATRICES, SLOT, Meaning, meaning
from eom.errors import InputError
from eom.terms.terms import atom
from eom.terms.vocabulary import QUANTITIES, label_words, words

SYSTEM = "system "
"""How the meaning begins of a symbol that is a quantity of the note's system."""
_OWN: dict[str, str] = {
    "defined": "what the note defines it to be",
    "vectrix": "the unit vectors of frame {0}",
    "time": "time",
    "skew": "the skew matrix of a column",
    "turn": "rotation of components by a turn about axis {0}",
    "active_turn": "rotation of a vector by a turn about axis {0}",
    "quaternion": "Euler parameters of the rotation from frame {1} to {0}, the scalar first",
    "quaternion_last": "Euler parameters of the rotation from frame {1} to {0}, the scalar last",
    "velocity": "velocity of {0} from {1}, as seen in frame {2}",
    "acceleration": "acceleration of {0} from {1}, as seen in frame {2}",
    "column": "any column {0}",
    "matrix": "any matrix {0}",
    "place": "place of {0}",
    "jacobian": "slopes of the place of {0}",
    **{name: name.replace("_", " ") for name, labels in MATRICES.items() if not labels},
}
"""What the checker's own meanings are called, with their labels."""
_FRAMES = {"I": "the inertial frame", "B": "the frame of the body"}
_POINTS = {
    "C": "the centre of mass",
    "O": "the reference point",
    "OI": "the inertial origin",
    "P": "the point mass",
}
_KNOWN = frozenset({*_FRAMES, "C", "OI", "P"})
"""Names that have words of their own, whatever the note calls them."""
_EVERY = {
    **dict.fromkeys("FG", "frame"),
    **dict.fromkeys("PQ", "point"),
    **dict.fromkeys("ij", "particle"),
    **dict.fromkeys("kl", "axis"),
    "c": "coordinate",
}
"""What letters in angle brackets run over."""


@dataclass(frozen=True)
class Names:
    """What quantities are called: of the note's ``systems``, and ``labels`` of frames and points."""

    systems: tuple[Guess, ...] = ()
    labels: Mapping[str, str] = field(default_factory=dict)


_NONE = Names()


def names_of(systems: Iterable[Guess], drafts: Iterable[Draft]) -> Names:
    """Return the names that a draft has; what all know by its own words keeps these."""
    own = [d for d in drafts if d.table in {"frames", "points"}]
    labels = {d.meaning: d.latex if d.latex.isalpha() else f"${d.latex}$" for d in own}
    return Names(tuple(systems), {k: v for k, v in labels.items() if k not in _KNOWN})


def in_words(text: str, names: Names = _NONE) -> str:
    """Return an entry of a lexicon in plain words.

    >>> in_words("position C O in B component 1")
    'component 1, in the frame of the body, of the position of the centre of mass from O'
    """
    if text.startswith(SYSTEM) and names.systems:
        means = text.removeprefix(SYSTEM)
        return next((n for s in names.systems if (n := s.noun(means)) != means), means)
    try:
        found = meaning(text, "")
    except InputError:
        return text
    if found.formula:
        return f"the same as ${pattern_in_words(found.formula)}$"
    return _every(_whole(found, names), found.slots)


def _whole(found: Meaning, names: Names) -> str:
    name = found.quantity
    labels = [f"{_OWN_NAME}{names.labels[w]}" if w in names.labels else w for w in found.labels]
    if name in QUANTITIES and QUANTITIES[name].words.count("{") == len(labels):
        said = words(atom(name, *labels, kind=QUANTITIES[name].kind))
    elif name in _OWN:
        said = _OWN[name].format(*map(label_words, labels), "", "")
    else:
        return found.words
    frame = f"in frame {names.labels.get(found.frame, found.frame)}"
    if found.component:
        said = f"component {' '.join(found.component)}, {frame}, of the {said}"
    elif found.frame:
        said = f"components, {frame}, of the {said}"
    said += " for each unit of volume" if found.density else ""
    said = pattern_in_words(said)
    known = re.sub(rf"(?<!{_OWN_NAME})\b(?:frame )?\b([IB])\b(?!')", lambda m: _FRAMES[m[1]], said)
    return known.replace(_OWN_NAME, "")


_OWN_NAME = "\ue030"
"""In front of the note's own name of a frame or point, which is no word of ours."""


def _every(said: str, slots: Iterable[str]) -> str:
    """Return words with what their letters run over."""
    some = [f"{_EVERY[k]} {k}" for k in sorted(slots) if k in _EVERY]
    return f"{said}, for any {' and '.join(some)}" if some else said


def row_in_words(draft: Draft, names: Names = _NONE) -> str:
    """Return an entry of a draft in plain words: what a symbol, label or mark is."""
    if draft.table == "symbols":
        return in_words(draft.meaning, names)
    if draft.table == "points":
        return f"label of {_POINTS.get(draft.meaning, 'a point')}"
    if draft.table == "frames":
        return f"label of {_FRAMES.get(draft.meaning, 'a frame')}"
    if not draft.meaning:
        return "a label, no derivative"
    name = names.labels.get(draft.meaning, draft.meaning)
    return f"derivative in {_FRAMES.get(draft.meaning, f'frame {name}')}"


def pattern_in_words(latex: str) -> str:
    r"""Return the pattern of an entry as a symbol: without angle brackets.

    >>> pattern_in_words("n_<k>")
    'n_k'
    """
    return SLOT.sub(r"\1", latex)


def is_guess(words: str) -> bool:
    """Return whether what stands in the place of a note's words is a custom, a letter or a book."""
    return words in GUESSED or words == USUAL


def source_in_words(words: str, line: int) -> str:
    """Return where a meaning comes from: the words of a line, or why it was guessed."""
    if is_guess(words) or not line:
        return words
    return f"line {line}, {words}" if words == FORMULA else f"line {line}: '{words}'"
