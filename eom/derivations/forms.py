"""The forms of a derivation as a page: in full, its statements alone, or as a handout of one page."""

from __future__ import annotations

from collections.abc import Sequence

from eom.derivations import showing
from eom.derivations.handout import handout
from eom.derivations.showing import FORMATS, Drawn, Shown, check_choices
from eom.derivations.wording import notation_of, spelt
from eom.errors import InputError, unknown_name
from eom.typeset import pages
from eom.typeset.notation import notation_named

FORMS = ("full", "handout")
"""What a page holds: every step and the result, or what fits on one page."""


def show_derivation(
    derivation: Shown,
    style: str = "text",
    notation: str = "arrow",
    steps: bool = True,
    *,
    form: str = "full",
    drawn: Sequence[Drawn] = (),
) -> str:
    """Return a derivation as one document; ``steps=False``: the last statement of each chain alone.

    style: a row of `eom.derivations.showing.FORMATS`; notation: one of `eom.typeset.notation.NOTATIONS` or
    its aliases; form: one of `FORMS`; drawn: pictures, each shown where it is introduced, in the full form.
    Raises `InputError` for others, and for a handout without steps.
    """
    check_choices(style, notation)
    if form not in FORMS:
        raise unknown_name("form", form, FORMS)
    chosen = notation_of(derivation, notation_named(notation))
    derivation = spelt(derivation, chosen)
    if form == "full":
        return FORMATS[style](list(showing.blocks(derivation, chosen, steps, drawn)))
    if not steps:
        raise InputError("a handout has steps", hint="leave out --no-steps, or --form handout")
    blocks = list(handout(derivation, chosen))
    return pages.latex_handout(blocks) if style == "latex" else FORMATS[style](blocks)
