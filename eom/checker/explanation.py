"""What is said of a wrong line: what is left over, what would make it right, and where it fails."""

from __future__ import annotations

from dataclasses import dataclass

from eom.checker.read.places import NOWHERE, Span


@dataclass(frozen=True)
class Correction:
    """A line that holds, a slip or two away from the one that is wrong.

    ``latex``: the whole line in the writer's notation; ``span``: what of the note ``text`` replaces;
    ``change``: the slip undone, in words; ``slip``: its kind, a row of a table; ``sets``: the smallest
    sets of assumptions under which the corrected line holds, none where it always does.
    """

    latex: str
    change: str
    slip: str
    span: Span = NOWHERE
    text: str = ""
    sets: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True)
class Counterexample:
    """Small numbers for which a line fails.

    ``values``: by the LaTeX of symbols; ``members``: what each member of the line then is. Both are texts,
    in any consistent units. ``assumptions``: under which the numbers stand.
    """

    values: tuple[tuple[str, str], ...]
    members: tuple[tuple[str, str], ...]
    assumptions: tuple[str, ...] = ()


@dataclass(frozen=True)
class Explanation:
    """Why a line is wrong.

    ``residual``: LaTeX of what is too much on the left side, in the writer's symbols, "" if no short one
    was found; ``blamed``: the places at fault; ``corrections``: the most plausible first;
    ``counterexample``: small numbers for which it fails, None if none was found;
    ``convention``: what other convention makes the line right, "" for none.
    """

    residual: str = ""
    blamed: tuple[Span, ...] = ()
    corrections: tuple[Correction, ...] = ()
    counterexample: Counterexample | None = None
    convention: str = ""


UNEXPLAINED = Explanation()
"""Nothing is said."""
