"""The passes that every compiled program goes through, as a table, and how they are applied."""

from __future__ import annotations

from codegen.chains import share_products, share_sums
from codegen.program import Program


def optimise(program):
    return share_products(share_sums(program))
