"""Lines that are right in another convention: what symbols of attitude mean is exchanged all over.

Three questions of convention are no errors: whether a rotation matrix turns frames or vectors, whether
a sequence is one about moving or fixed axes, whether the scalar of a quaternion stands first or last.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from eom.checker.judge.judge import HOLDS, UNDER, judge
from eom.checker.judge.notes import Understood, reread
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.meanings import Meaning
from eom.checker.repair.levels import penalty

PLAUSIBLE = 1.5
"""Most that the assumptions may weigh under which a line holds in another convention."""


@dataclass(frozen=True)
class Convention:
    """Words for the other side of a convention, and what a meaning becomes there."""

    words: str
    change: Callable[[Meaning], Meaning]


def _transposed(meaning: Meaning) -> Meaning:
    """Exchange the frames of a rotation, and turns of frames and of vectors."""
    if meaning.quantity == "rotation":
        return replace(meaning, labels=meaning.labels[::-1])
    return replace(meaning, quantity=_TURNS.get(meaning.quantity, meaning.quantity))


_TURNS = {"turn": "active_turn", "active_turn": "turn"}


def _order(meaning: Meaning) -> Meaning:
    """Exchange turns about moving and fixed axes."""
    if meaning.quantity != "turn_angle":
        return meaning
    place, axes, *frames = meaning.labels
    fixed = axes.startswith("space")
    other = axes.removeprefix("space") if fixed else "space" + axes.removeprefix("body")
    return replace(meaning, labels=(place, other, *frames))


_SCALARS = {"quaternion": "quaternion_last", "quaternion_last": "quaternion"}


def _scalar(meaning: Meaning) -> Meaning:
    """Exchange columns of Euler parameters with the scalar first and last."""
    return replace(meaning, quantity=_SCALARS.get(meaning.quantity, meaning.quantity))


CONVENTIONS: tuple[Convention, ...] = (
    Convention("all rotation matrices transposed (active and passive exchanged)", _transposed),
    Convention("turns about fixed and moving axes exchanged", _order),
    Convention("the scalar of quaternions at the other end", _scalar),
)
"""Every convention, with what it changes."""


def changed(lexicon: Lexicon, convention: Convention) -> Lexicon:
    """Return a lexicon whose meanings are those of the other convention."""
    layers = tuple(
        tuple(replace(entry, meaning=convention.change(entry.meaning)) for entry in layer)
        for layer in lexicon.layers
    )
    return lexicon if layers == lexicon.layers else replace(lexicon, layers=layers)


def other_convention(understood: Understood, number: int, given: Iterable[str] = ()) -> str:
    """Return in which other conventions a wrong claim of a formula is right, "" for none.

    ``number``: of the claim. What the note itself has defined stays as it was defined. A line without
    rates is often right by each of two conventions; both are told.
    """
    given = tuple(given)
    right = [c.words for c in CONVENTIONS if _right(understood, number, c, given)]
    return f"right in the other convention: {', or: '.join(right)}" if right else ""


def _right(
    understood: Understood, number: int, convention: Convention, given: tuple[str, ...]
) -> bool:
    """Tell whether a claim is right in another convention that changes what it says."""
    reading = understood.formula.reading
    lexicon = changed(understood.lexicon, convention)
    if reading is None or lexicon is understood.lexicon:
        return False
    claims = reread(replace(understood, lexicon=lexicon), reading.tree)
    claim = claims[number] if number < len(claims) else None
    before = understood.claims[number]
    if claim is None or claim.verdict or claim.kind != before.kind:
        return False
    same = claim.members == before.members and claim.scalars == before.scalars
    if same and not before.verdict:
        return False
    found = judge(claim, given)
    least = min((penalty(s, frozenset(given)) for s in found.sets), default=0.0)
    return found.verdict == HOLDS or (found.verdict == UNDER and least <= PLAUSIBLE)
