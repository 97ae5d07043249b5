"""Pictures as data, and their renderers: Matplotlib for print, pages to turn by hand.

In: panels of marks. Out: PNG, SVG, PDF, HTML, what notebooks display.
Imports: `codegen.runs`, `eom.displays`, `eom.errors`, `eom.mass`, `eom.typeset`.
"""

from __future__ import annotations

from eom.typeset.blocks import shown
from eom.views.draw.picture import Picture


@shown.register
def _in_a_notebook(picture: Picture, style: str) -> object:
    """Return what IPython displays; renderers are imported where they draw."""
    from eom.views.draw.printed import bundle

    del style
    return bundle(picture)
