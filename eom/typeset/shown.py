"""What objects show of themselves: each kind is registered by the module that writes or draws it."""

from __future__ import annotations

from functools import singledispatch
from typing import Any


@singledispatch
def shown(given: object, style: str) -> Any:
    """Return what stands for an object in a style: a page, a formula, or what a notebook displays.

    Raises `TypeError` for kinds that no module has registered.
    """
    raise TypeError(f"nothing shows a {type(given).__name__} as {style}")
