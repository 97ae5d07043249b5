r"""What would have to be said of a note's symbols for more of its lines to be decided."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Candidate:
    """A meaning that a symbol may have, as an entry of a lexicon.

    It may be given to `eom.check` as an answer.

    ``latex``: its pattern; ``meaning``: as a lexicon spells it; ``why``: what speaks for it; ``words``: the
    meaning in plain words.
    """

    latex: str
    meaning: str
    why: str
    words: str = ""

    def __str__(self) -> str:
        """Return the meaning with what speaks for it."""
        return f"{self.words or self.meaning} ({self.why})"


@dataclass(frozen=True)
class Question:
    """A symbol whose meaning is open: say it in the note, in a lexicon, or by ``answers`` of `eom.check`.

    ``latex``: the symbol; ``lines``: numbers of the lines that hang on it, from 1; ``candidates``: what it
    may mean, the likeliest first; ``guess``: what it was taken to mean, unconfirmed, as a lexicon spells
    it; "" for nothing; ``taken``: the same in plain words; ``holds``: numbers of lines that hold with it.
    """

    latex: str
    lines: tuple[int, ...]
    candidates: tuple[Candidate, ...] = ()
    guess: str = ""
    taken: str = ""
    holds: tuple[int, ...] = ()

    @property
    def confirmed(self) -> bool:
        """Whether so many lines hold with what the symbol was taken to mean that it need not be said."""
        return len(self.holds) >= CONFIRMED

    def __str__(self) -> str:
        """Return the question in words."""
        numbers = ", ".join(map(str, self.lines[:SHOWN])) + ", ..." * (len(self.lines) > SHOWN)
        lines = f"line {numbers}" if len(self.lines) == 1 else f"lines {numbers}"
        taken = f", taken for {self.taken or self.guess}" if self.guess else ""
        return f"what is {self.latex}{taken}? ({lines})"


@dataclass(frozen=True)
class Taken:
    """A meaning that was taken from a note unconfirmed.

    ``latex``: the symbol, "" where it is about the note as a whole; ``words``: the meaning in plain words;
    ``why``: the words of the note and their line, or why it was guessed, and which lines hold with it.
    """

    latex: str
    words: str
    why: str

    def __str__(self) -> str:
        """Return the meaning with its evidence."""
        of = f"{self.latex}: " if self.latex else ""
        return f"{of}{self.words} ({self.why})"


CONFIRMED = 2
"""Lines that hold with a guess, by which it is taken for granted."""
SHOWN = 6
"""Lines of a question that are told."""
