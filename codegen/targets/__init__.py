"""Targets: each writes a program in one language, by a table of templates and one loop.

In: programs and layouts. Out: texts in C, NumPy, Python and JavaScript.
Imports: `codegen.frontend`, `codegen.ir`, `codegen.passes`, `codegen.watch`, `eom.errors`,
`eom.limits`, `eom.quantities`, `eom.tables`.
"""

from __future__ import annotations

import importlib.abc
import importlib.util
import linecache
from types import ModuleType


class _TextLoader(importlib.abc.InspectLoader):
    """Load a module from a text that this package has generated itself."""

    def __init__(self, text: str) -> None:
        self.text = text

    def get_source(self, fullname: str) -> str:  # noqa: ARG002
        return self.text


def load_module(text: str, name: str) -> ModuleType:
    """Return a module made from generated text; tracebacks show its lines."""
    loader = _TextLoader(text)
    spec = importlib.util.spec_from_loader(f"eom_generated_{name}", loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    linecache.cache[f"<{spec.name}>"] = (
        len(text),
        None,
        text.splitlines(keepends=True),
        f"<{spec.name}>",
    )
    loader.exec_module(module)
    return module
