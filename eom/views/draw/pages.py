"""A page of HTML as one file: template, style, scripts of `eom/views/web`, and data; it asks for nothing.

Scripts and style are allowed by their hashes alone, so that nothing else on the page can run. The same
parts give the same bytes.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib import resources

INLINE = "'unsafe-inline'"
"""For styles that a library of the page writes itself."""
_MARK = re.compile(r"\{\{(\w+)\}\}")


@cache
def web(name: str) -> str:
    """Return a file of `eom/views/web`."""
    return resources.files("eom.views").joinpath("web", name).read_text(encoding="utf-8")


def as_json(value: object) -> str:
    """Return JSON that cannot end the element of a page that it stands in."""
    text = json.dumps(value, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def page(
    name: str,
    parts: Mapping[str, str],
    data: object,
    scripts: Sequence[str],
    images: str = "",
    styles: str = "",
) -> str:
    """Return the page of the template and style ``name`` of `eom/views/web`.

    ``parts``: HTML by the marks of the template; ``data``: what its scripts read; ``images``: where these
    may come from; ``styles``: what is allowed beside the page's own style (`policy`).
    """
    own = [s.replace("</script", "<\\/script") for s in scripts]
    style = web(f"{name}.css")
    marks = {
        **parts,
        "style": style,
        "policy": html.escape(policy(own, styles or hashed(style), images)),
        "data": as_json(data),
        "scripts": "\n".join(f"<script>{s}</script>" for s in own),
    }
    return _MARK.sub(lambda found: marks[found[1]], web(f"{name}.html"))


# -- what a page may do --------------------------------------------------------------------------------


def policy(scripts: Iterable[str], style: str, images: str = "") -> str:
    """Return the policy of a page with these scripts: nothing is asked for from elsewhere.

    ``style``: the source that is allowed, `hashed` of a text or `INLINE`. ``images``: where they may come
    from, as ``data: blob:``; nowhere unless it is said. Source: W3C, Content Security Policy Level 3.
    """
    allowed = " ".join(map(hashed, scripts))
    parts = [
        "default-src 'none'",
        f"script-src {allowed}",
        f"style-src {style}",
        *([f"img-src {images}"] if images else []),
        "base-uri 'none'",
        "form-action 'none'",
    ]
    return "; ".join(parts)


def hashed(text: str) -> str:
    """Return the source that stands for one text in a policy."""
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"
