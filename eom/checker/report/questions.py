r"""What would have to be said of a note's symbols for more of its lines to be decided."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Candidate:
    """A meaning that a symbol may have, as an entry of a lexicon.

    ``latex``: its pattern; ``meaning``: in words of a lexicon; ``why``: what speaks for it.
    """

    latex: str
    meaning: str
    why: str

    def __str__(self) -> str:
        """Return the meaning with what speaks for it."""
        return f"{self.meaning} ({self.why})"


@dataclass(frozen=True)
class Question:
    """A symbol whose meaning is open.

    ``latex``: the symbol; ``lines``: numbers of the lines that hang on it, from 1; ``candidates``: what it
    may mean, the likeliest first; ``guess``: what it was taken to mean, unconfirmed; "" for nothing.
    """

    latex: str
    lines: tuple[int, ...]
    candidates: tuple[Candidate, ...] = ()
    guess: str = ""

    def __str__(self) -> str:
        """Return the question in words."""
        numbers = ", ".join(map(str, self.lines[:SHOWN])) + ", ..." * (len(self.lines) > SHOWN)
        lines = f"line {numbers}" if len(self.lines) == 1 else f"lines {numbers}"
        taken = f", taken for {self.guess}" if self.guess else ""
        return f"what is {self.latex}{taken}? ({lines})"


SHOWN = 6
"""Lines of a question that are told."""
