"""An exercise as Markdown: lines for the student, the key for the marker."""

from __future__ import annotations

from dataclasses import replace

from eom import pages
from eom.derivation import Derivation
from eom.notation import Notation
from eom.showing import separate


def lines(derivation: Derivation, notation: Notation) -> str:
    """Return the lines of a derivation, numbered, each a display of its own with its reason."""
    plain = tuple(
        replace(s, states=(), evidence=s.kind if s.kind != "result" else "")
        for s in derivation.steps
    )
    return pages.markdown_page(separate(replace(derivation, steps=plain), notation))
