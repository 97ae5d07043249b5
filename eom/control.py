"""Laws of control: what they may speak of, and the order in which they are evaluated."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.errors import InputError, is_text
from eom.expressions import as_expression, free_symbols, replaced
from eom.quantities import Definition, Expr, Quantity, quantities_of, quantity_of


def name_of(key: Any) -> str:
    """Return the name of what a law is for: a text, or of a symbol or quantity."""
    return key if is_text(key) else quantity_of(key, "a control").name


def as_quantity(key: Any) -> Quantity:
    """Return what a name, symbol or quantity of a control is."""
    return quantity_of(sp.Symbol(key, real=True) if is_text(key) else key, "a control")


def as_state(key: Any) -> Quantity:
    """Return a state of a control, which starts at zero unless it says otherwise."""
    found = as_quantity(key)
    found = replace(found, meaning=found.meaning or "state of the control")
    return found if found.default is not None else replace(found, default=0.0)


class Spoken:
    """What laws of control speak of by name: what is ``known``, and the control's ``own`` quantities.

    ``hidden``: names that no law may read. ``gains``: the parameters that are new, by name.
    """

    def __init__(
        self,
        where: str,
        known: Mapping[str, Expr],
        own: Sequence[Quantity],
        parameters: Iterable[Any],
        hidden: Collection[str] = (),
    ) -> None:
        self.where, self.hidden = where, hidden
        self.given = {q.name: q for q in quantities_of(parameters, "parameters of a control")}
        self.gains: dict[str, Quantity] = {}
        for q in own:
            if q.name in known:
                raise InputError("this name is taken", where=where, got=q.name,
                                 expected="new names for what the control defines")  # fmt: skip
        self.known = {**known, **{q.name: q.symbol for q in own}}

    def over(self, given: Any) -> Expr:
        """Return an expression over the symbols of the system."""
        law = as_expression(given)
        symbols = sorted(free_symbols((law,)), key=lambda s: str(s.name))
        return replaced(law, {s: self._meant(s) for s in symbols})

    def _meant(self, symbol: Expr) -> Expr:
        name = str(symbol.name)
        if name in self.known:
            return self.known[name]
        if name in self.hidden:
            raise InputError(
                "a law speaks of an intermediate definition of the system",
                where=self.where,
                got=name,
                expected="states, parameters, inputs, outputs or time",
                hint="call a gain otherwise; to read the definition, write its expression",
            )
        return self.gains.setdefault(name, self.given.get(name, Quantity(symbol))).symbol


def widened(matrix: Expr, n: int, more: int) -> Expr:
    """Return a matrix with so many rows of the identity behind its first ``n`` rows and columns."""
    A, B, C, D = matrix[:n, :n], matrix[:n, n:], matrix[n:, :n], matrix[n:, n:]
    wide, high = sp.zeros(more, B.cols), sp.zeros(C.rows, more)
    upper = sp.diag(A, sp.eye(more)).row_join(B.col_join(wide))
    return upper.col_join(C.row_join(high).row_join(D))


def in_order(rows: Sequence[Definition], where: str) -> tuple[Definition, ...]:
    """Return definitions, each behind those that it reads, otherwise in order.

    Raises `InputError` where some need each other.
    """
    missing = {d.symbol for d in rows}
    waiting = [(d, free_symbols((d.expression,)) & missing) for d in rows]
    ordered: list[Definition] = []
    while waiting:
        left = []
        for d, reads in waiting:
            if reads & missing:
                left.append((d, reads))
            else:
                ordered.append(d)
                missing.discard(d.symbol)
        if len(left) == len(waiting):
            raise InputError(
                "laws of control need their own results",
                where=where,
                got=", ".join(d.name for d, _ in left[:6]),
                expected="laws over states, or over outputs that do not depend on the controlled inputs",
                hint="a filter, a state of the control, makes a loop of laws one of states",
            )
        waiting = left
    return tuple(ordered)
