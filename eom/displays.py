"""What shows an object, by words: pages and pictures stand above data, which know nothing of them.

The front door of the package says by texts which module shows what (`eom`); that is loaded when it is asked
for. So a system has a page in notebooks, and a result a picture, while nothing below imports what draws.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

_HOMES: dict[str, str] = {}


def register(homes: Mapping[str, str]) -> None:
    """Say what shows what: ``module:function`` by words for it."""
    _HOMES.update(homes)


def display(words: str, *given: Any, **options: Any) -> Any:
    """Return what the function that is registered for ``words`` makes of what is ``given``."""
    module, _, name = _HOMES[words].partition(":")
    return getattr(import_module(module), name)(*given, **options)
