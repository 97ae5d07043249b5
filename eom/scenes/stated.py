"""What is stated of the units of a scene: whether its formulas are of the dimensions of their places."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from eom.dimensions import Dimensions
from eom.quantities import TIME
from eom.scenes.parse import dimensional, parse, words


class Stated:
    """The units of what the formulas of a scene may speak of.

    ``units``: by name, also of states and of what bodies define; nothing where one is not known. ``own``:
    those of the scene's parameters and inputs. Formulas over none of these with a unit are not checked. A
    number with a decimal point may have a unit, a whole number has none. What follows from one formula
    holds for the next.
    """

    def __init__(self, units: Mapping[str, str], own: Mapping[str, str]) -> None:
        known = {**units, **own}
        self.own = {name for name, unit in own.items() if unit}
        self.symbols = {name: sp.Symbol(name, real=True) for name in known} if self.own else {}
        stated = ((s, known[name]) for name, s in self.symbols.items())
        self.known = Dimensions(stated, time=TIME)

    def check(self, formula: Any, where: str, unit: str = "", *, read: Any = None) -> None:
        """Raise `InputError` for a formula of another dimension than ``unit``, with the term at fault.

        ``unit``: nothing where it may be any; its terms must be of one dimension all the same. ``read``:
        the formula as it was read, which serves where its symbols and numbers are those that are written.
        """
        if not self.own or not isinstance(formula, str):
            return
        names = words(formula)
        if self.own.isdisjoint(names):
            return
        for name in names - {*self.symbols}:  # of unknown units
            self.symbols[name] = sp.Symbol(name, real=True)
        symbols = {self.symbols[n] for n in names}
        if read is None or "." in formula or symbols != read.free_symbols:
            read = parse(formula, self.symbols, where, unit=unit, number=dimensional)
        self.known.check(read, where, unit)
