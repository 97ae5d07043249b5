"""How much work Taylor coefficients take."""

from __future__ import annotations

from codegen.derivatives.taylor import Prepared
from codegen.ir.ops import OPS

_FEW = frozenset({"add", "sub", "neg", "abs", "min", "max", "select", "item"})
"""Operations of which each coefficient is one operation, whatever the order."""


def operations(prepared: Prepared, order: int) -> int:
    """Return about how many operations all coefficients up to an order take."""
    pairs = zip(prepared.program.instructions, prepared.varies, strict=True)
    total = 0
    for (op, args, _), varies in pairs:
        if op in OPS and varies:
            is_product = op not in _FEW and sum(prepared.varies[a] for a in args) > (op == "mul")
            total += order * order * max(1, len(args) - 1) if is_product else order
    return total
