"""One HTML page with a picture to turn by hand, that needs no network.

It holds plotly.js itself (some 4.8 MB); the data of the picture are small beside it. Its two scripts are
allowed by their hashes alone; the library writes its own styles and images. The page follows the
reader's choice of a light or dark theme.
"""

from __future__ import annotations

import html
import json
from functools import lru_cache

from eom.typeset.policy import INLINE, policy
from eom.views.draw import formulas
from eom.views.draw.extras import require
from eom.views.draw.picture import Picture
from eom.views.draw.printed import height_of
from eom.views.draw.turned import INCH, described

PAGE = """\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
:root {{ color-scheme: light dark; --paper: #ffffff; --ink: #222222; }}
@media (prefers-color-scheme: dark) {{ :root {{ --paper: #14171c; --ink: #e8e8e8; }} }}
html, body {{ height: 100%; margin: 0; background: var(--paper); color: var(--ink); }}
body {{ font: 16px/1.5 system-ui, sans-serif; display: flex; flex-direction: column; }}
main {{ flex: 1; display: flex; flex-direction: column; min-height: 0; }}
h1 {{ position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }}
#picture {{ flex: 1; min-height: {height:g}in; }}
p {{ margin: 0; padding: 0.5rem 1.5rem 1rem; max-width: 60rem; align-self: center; }}
</style>
<script>{library}</script>
</head>
<body>
<main>
<h1>{title}</h1>
<div id="picture" role="group" aria-label="{words}"></div>
{caption}</main>
<script type="application/json" id="data">{data}</script>
<script>{script}</script>
</body>
</html>
"""
SCRIPT = """
"use strict";
(() => {
  const media = matchMedia("(prefers-color-scheme: dark)");
  const swapped = {
    "#ffffff": "#14171c", "#222222": "#e8e8e8", "#000000": "#f2f2f2", "#dddddd": "#3a3f48",
    "#777777": "#9aa0a8", "#0072b2": "#4aa8e0",
  };
  const words = new Set(["text", "name", "legendgroup"]);
  const text = document.getElementById("data").textContent;
  const draw = () => {
    const given = JSON.parse(text, (key, value) =>
      media.matches && !words.has(key) && Object.hasOwn(swapped, value) ? swapped[value] : value);
    Plotly.react("picture", given.data, given.layout, { responsive: true, displaylogo: false });
  };
  draw();
  media.addEventListener("change", draw);
})();
"""


def page(picture: Picture, size: tuple[float, float] | None = None) -> str:
    """Return a picture as one HTML page with plotly.js in it; ``size`` in inches of 96 pixels.

    Text is escaped; the same picture gives the same page. Raises as `figure`.
    """
    made = described(picture, size)
    data = json.dumps(made, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        data = data.replace(character, f"\\u{ord(character):04x}")
    usual = INCH * sum(max(map(height_of, row)) for row in picture.rows if row)
    title = formulas.as_text(picture.title) or "Picture"
    words = formulas.as_text(picture.caption)
    return PAGE.format(
        title=html.escape(title),
        words=html.escape(words or title),
        caption=f"<p>{html.escape(words)}</p>\n" if words else "",
        height=made["layout"].get("height", usual) / INCH,
        policy=html.escape(policy([library(), SCRIPT], INLINE, "data: blob:")),
        library=library(),
        script=SCRIPT,
        data=data,
    )


@lru_cache(maxsize=1)
def library() -> str:
    """Return plotly.js as it goes into a page. Raises `InputError` where Plotly is missing."""
    require("plotly")
    from plotly.offline import get_plotlyjs

    return str(get_plotlyjs()).replace("</script", "<\\/script")
