"""How notes are checked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eom.opening import AnyScene
    from eom.system import System


GIVEN = ("constant_mass",)
"""What is assumed without being said, unless something else is given."""
FORMULA_SECONDS = 10.0
NOTE_SECONDS = 300.0


@dataclass(frozen=True)
class Settings:
    """How notes are checked.

    ``notation``: a preset, ``lexicon``: a TOML file, "" for neither; ``given``: assumptions made without
    being said; ``kind``: of texts that are no files, see `read_document`, "" for what they look like;
    ``system``: what scalar lines are about, a name, a scene file or an object, None for what the note says;
    ``seconds`` of processor time: for the meaning of a formula, and again for its judgement;
    ``note_seconds``: for a note.
    """

    notation: str = ""
    lexicon: str = ""
    given: tuple[str, ...] = GIVEN
    kind: str = ""
    system: str | System | AnyScene | None = None
    seconds: float = FORMULA_SECONDS
    note_seconds: float = NOTE_SECONDS
