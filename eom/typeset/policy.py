"""What a page may do, as a Content-Security-Policy: its own scripts, by their hashes, and little else."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable

INLINE = "'unsafe-inline'"
"""For styles that a library of the page writes itself."""


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
