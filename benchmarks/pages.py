"""How long formulas and lines of the pages of derivations are, and how many pages of PDF they take."""

from __future__ import annotations

import re
import unicodedata

from eom.commands.paging import pdf
from eom.derivations import derive, names
from eom.derivations.derived import Derived

_DISPLAY = re.compile(r"\\begin\{align\*\}(.*?)\\end\{align\*\}", re.DOTALL)
_COUNT = re.compile(rb"/Type\s*/Pages\b[^>]*?/Count\s+(\d+)|/Count\s+(\d+)[^>]*?/Type\s*/Pages\b")


def formula_lines(derivation: Derived, notation: str = "arrow") -> list[str]:
    """Return every line of a formula of the steps, as LaTeX."""
    steps = derivation.page("latex", notation).partition(r"\subsection*{Result}")[0]
    found = _DISPLAY.findall(steps)
    lines = (line for shown in found for line in shown.strip().split("\\\\\n"))
    return [line.rpartition("\n")[2].strip() for line in lines]


def longest_line(page: str) -> int:
    """Return the length of the longest line, in letters: marks on letters take no room."""
    return max(sum(not unicodedata.combining(c) for c in line) for line in page.splitlines())


def longest_formula(*, matrices: bool) -> tuple[int, str]:
    """Return the length of the longest line of a formula of all derivations, and where it is."""
    return max(
        (len(line), name)
        for name in names()
        for line in formula_lines(derive(name))
        if ("matrix}" in line) == matrices
    )


def pdf_pages(latex: str) -> int:
    """Return how many pages a document has. Raises `InputError` where LaTeX makes none."""
    plain = "\\pdfobjcompresslevel=0\n" + latex
    return max(int(a or b) for a, b in _COUNT.findall(pdf(plain)))
