"""Switching functions: values by whose signs the branches of a program choose."""

from __future__ import annotations

from collections.abc import Sequence

from codegen.ir.program import Builder

_DIFFERENCES = frozenset({"min", "max", "lt", "le", "eq"})
"""Operations that choose by the sign of the difference of their arguments."""


def switches(b: Builder, varies: Sequence[bool]) -> list[int]:
    """Return the switching functions of what was built, each once; differences are added to it.

    ``varies``: whether a value changes with time. That of a difference is not known: it may still.
    """
    found = []
    for op, args, _ in tuple(b.instructions):
        if not any(varies[a] for a in args):
            continue
        if op in {"abs", "sign"}:
            found.append(args[0])
        elif op in _DIFFERENCES:
            found.append(b.add("sub", *args))
    return list(dict.fromkeys(found))
