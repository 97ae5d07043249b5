"""Whether formulas are of one dimension, given those of some of their symbols.

What is not known is worked out where it follows: in ``k*x + F`` the unit of k is that of F by that of x.
Dimensions are products of powers, so that each sum, and each function of a number, gives linear equations
in the exponents, which are solved exactly, one after another; the first that contradicts what was known
before names the term that does not fit (Kennedy, Programming Languages and Dimensions, PhD thesis,
Cambridge 1996, sections 2 and 3, with rational exponents).

Exact numbers are counts, which have no unit, as factors; a number that is a whole term, or has a decimal
point (a SymPy Float), may be a value whose unit is not stated: then nothing follows. So may a term that
is a number of time alone, as a pulse or a sine. Zero is of every dimension.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.units import BASE, Dimension, read

Expr = Any
Powers = dict[Any, Fraction]
"""A product of powers of base units, by name, and of symbols of unknown dimension."""

_ONE = Fraction(1)
_PLAIN: Powers = {}


def powers_of(dimension: Dimension) -> Powers:
    """Return a dimension as a product of powers."""
    return {n: e for n, e in zip(BASE, dimension, strict=True) if e}


def kind_of_numbers(expressions: Iterable[Expr]) -> str:
    """Return what exact numbers in expressions are: values where one is a whole term, else counts.

    >>> kind_of_numbers([sp.Integer(3), 2 * sp.Symbol("M")]), kind_of_numbers([2 * sp.Symbol("M")])
    ('values', 'counts')
    """
    terms = (t for e in expressions for t in sp.Add.make_args(sp.sympify(e, strict=True)))
    return "values" if any(t.is_number and not t.is_zero for t in terms) else "counts"


class _MisfitError(Exception):
    """What does not fit: the term, its dimension, that which it should have, and as what."""

    def __init__(self, term: Expr, found: Powers, expected: Powers, beside: str) -> None:
        super().__init__(term)
        self.term, self.found, self.expected, self.beside = term, found, expected, beside


class Dimensions:
    """The dimensions of symbols, as far as they are stated or follow.

    ``units``: of symbols, as text (`eom.units`); nothing where one is not stated. ``counts``: whether exact
    numbers have no unit; else they may be values. ``time``: its symbol, if there is one; functions may be
    of it alone, as sin(2*t), where the rate is a number without its unit. `check` raises `InputError` for
    a formula that does not fit, and adds what follows from one that does.
    """

    def __init__(
        self, units: Iterable[tuple[Expr, str]], *, counts: bool = True, time: Expr = None
    ) -> None:
        self.counts, self.time = counts, time
        self.stated = {symbol: _powers(unit) for symbol, unit in units if unit}
        self._solved: dict[Expr, Powers] = {}
        self._memo: dict[Expr, Powers | None] = {}

    def check(self, formula: Expr, where: str, unit: str = "", *, of: Powers | None = None) -> None:
        """Raise `InputError` where a formula is of no dimension, or of another than that of ``unit``.

        ``of``: the dimension it must have, instead, as by `of_symbol`.
        """
        expected = _powers(unit) if unit else of
        try:
            self._fit(formula, expected)
        except _MisfitError as misfit:
            raise self._error(misfit, where, formula, unit) from None

    def row(
        self, entries: Sequence[Expr], factors: Sequence[Powers], right: Expr, where: str
    ) -> None:
        """Raise `InputError` unless entries times factors, and the right side, are of one dimension."""
        known = self.of(right)
        for entry, factor in zip(entries, factors, strict=True):
            if entry == 0:
                continue
            if known is not None:
                self.check(entry, where, of=_times(known, factor, -_ONE))
            elif (own := self.of(entry)) is not None:
                known = _times(own, factor, _ONE)
        if known is not None:
            self.check(right, where, of=known)

    def of_symbol(self, symbol: Expr, over: Powers | None = None) -> Powers:
        """Return the dimension of a symbol, divided by another one."""
        found = self.stated.get(symbol)
        found = {symbol: _ONE} if found is None else found
        return _times(found, over, -_ONE) if over else found

    def of(self, formula: Expr) -> Powers | None:
        """Return the dimension of a formula; None where nothing is known of it."""
        try:
            return self._of(formula)
        except _MisfitError as misfit:
            raise self._error(misfit, "", formula) from None

    # -- formulas --

    def _fit(self, formula: Expr, expected: Powers | None) -> None:
        if expected is None:
            self._of(formula)
            return
        terms = formula.args if formula.is_Add else (formula,)
        for term in terms:
            own = self._term(term)
            self._agree(term, None if self._varies(term, own) else own, expected, "")

    def _term(self, term: Expr) -> Powers | None:
        """Return the dimension of a term of a sum; a number may be a value, of any."""
        return None if term.is_number else self._of(term)

    def _varies(self, term: Expr, own: Powers | None) -> bool:
        """Return whether a term is a number that varies with time, and may be a value as others are."""
        return own == _PLAIN and term.free_symbols == {self.time}

    def _of(self, formula: Expr) -> Powers | None:
        """Return the dimension of a formula, children first, each once; None where it may be any."""
        memo, stack = self._memo, [formula]
        while stack:
            node = stack[-1]
            if node in memo:
                stack.pop()
                continue
            waiting = [a for a in node.args if a not in memo]
            if waiting and not node.is_Symbol:
                stack += waiting
                continue
            stack.pop()
            memo[node] = self._rule(node)
        return memo[formula]

    def _rule(self, node: Expr) -> Powers | None:
        if node.is_Symbol:
            return self.of_symbol(node)
        if node.is_number:
            return _PLAIN if _is_count(node) and (self.counts or node == -1) else None
        if node.is_Mul:
            return self._product(node)
        rule = _RULES.get(node.func)
        return None if rule is None else rule(self, node)

    def _product(self, node: Expr) -> Powers | None:
        found: Powers = {}
        for factor in node.args:
            own = self._memo[factor]
            if own is None:
                return None
            found = _times(found, own, _ONE) if own else found
        return found

    def sum(self, node: Expr) -> Powers | None:
        """Return the dimension of a sum, or of the larger of several; None where none is known."""
        known: Powers | None = None
        first, varies = None, False
        for term in node.args:
            own = self._term(term)
            if self._varies(term, own):
                varies = True
            elif known is None:
                known, first = own, term
            elif own is not known:
                self._agree(term, own, known, str(first))
        return _PLAIN if known is None and varies else known

    def power(self, node: Expr) -> Powers | None:
        """Return the dimension of a power; exponents, and bases of exponents that vary, are numbers."""
        base, exponent = node.args
        own = self._memo[base]
        if exponent.is_Rational or exponent.is_Float:
            number = Fraction(int(exponent.p), int(exponent.q)) if exponent.is_Rational else None
            number = Fraction(float(exponent)) if number is None else number
            return None if own is None else {s: e * number for s, e in own.items()}
        self._agree(exponent, self._memo[exponent], _PLAIN, "")
        if exponent.is_number:
            return None
        self._agree(base, own, _PLAIN, "")
        return _PLAIN

    def plain(self, node: Expr) -> Powers | None:
        """Return no dimension, for a function whose arguments have none."""
        for argument in node.args:
            if argument.free_symbols != {self.time}:
                beside = f"argument of {node.func.__name__}"
                self._agree(argument, self._memo[argument], _PLAIN, beside)
        return _PLAIN

    def ratio(self, node: Expr) -> Powers | None:
        """Return no dimension, for a function whose arguments have one dimension."""
        self.sum(node)
        return _PLAIN

    # -- equations --

    def _agree(
        self, term: Expr, found: Powers | None, expected: Powers | None, beside: str
    ) -> None:
        """Make two dimensions one. Raises `_MisfitError` where they are not."""
        if found is None or expected is None or found == expected:
            return
        rest = self._reduced(_times(found, expected, -_ONE))
        if not rest:
            return
        unknown = [s for s in rest if not isinstance(s, str)]
        if not unknown:
            raise _MisfitError(term, found, expected, beside)
        pivot = min(unknown, key=lambda s: str(s.name))
        share = -1 / rest.pop(pivot)
        made = {s: e * share for s, e in rest.items()}
        for symbol, own in self._solved.items():
            if pivot in own:
                self._solved[symbol] = self._put(own, pivot, made)
        self._solved[pivot] = made

    def _reduced(self, powers: Powers) -> Powers:
        """Return a product with what is known of its symbols put in."""
        for symbol in [s for s in powers if s in self._solved]:
            powers = self._put(powers, symbol, self._solved[symbol])
        return powers

    @staticmethod
    def _put(powers: Powers, symbol: Expr, made: Powers) -> Powers:
        rest = dict(powers)
        return _times(rest, made, rest.pop(symbol))

    def _error(self, misfit: _MisfitError, where: str, formula: Expr, unit: str = "") -> InputError:
        found, expected = (self._words(p) for p in (misfit.found, misfit.expected))
        if unit and not misfit.beside and read(unit).dimension.words == expected != unit:
            expected = f"{unit}, which is {expected}"
        beside = f", as {_short(misfit.beside)}" if misfit.beside else ""
        is_part = formula != misfit.term
        inside = f", in {_short(str(formula))}" if is_part else ""
        return InputError(
            "the dimension of a term does not fit",
            where=where,
            got=f"{_short(str(misfit.term))}, in {found}{inside}",
            expected=f"{expected}{beside}",
            hint="whole numbers and fractions have no unit: a value that has one is a parameter with its "
            "unit, or has a decimal point, as 2.0; leave units out where they are not known",
        )

    def _words(self, powers: Powers) -> str:
        known = self._reduced(powers)
        unit = Dimension(*(known.get(n, Fraction(0)) for n in BASE)).words
        unknown = {s: e for s, e in known.items() if not isinstance(s, str)}
        rest = " ".join(
            f"[{s}]" if e == 1 else f"[{s}]^({e})" for s, e in sorted(unknown.items(), key=str)
        )
        return (f"{rest} {unit}" if unit != "1" else rest) if rest else unit


def _powers(unit: str) -> Powers:
    return powers_of(read(unit).dimension)


def _times(a: Powers, b: Powers, power: Fraction) -> Powers:
    """Return a product: ``a`` times a power of ``b``."""
    found = dict(a)
    for s, e in b.items():
        rest = found.get(s, 0) + e * power
        if rest:
            found[s] = rest
        else:
            found.pop(s, None)
    return found


def _is_count(number: Expr) -> bool:
    """Return whether a number is exact, and neither zero nor infinite."""
    return bool(number != 0 and number.is_finite is not False and not number.has(sp.Float))


LONGEST = 80
"""Characters of a term in an error."""


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def _branches(known: Dimensions, node: Expr) -> Powers | None:
    """Return the dimension of the values of a case distinction."""
    found: Powers | None = None
    for value, _ in node.args:
        own = known._term(value)
        if found is None:
            found = own
        else:
            known._agree(value, own, found, "")
    return found


_Rule = Callable[[Dimensions, Any], Powers | None]
_NUMERIC = (
    "sin cos tan cot sec csc asin acos atan acot sinh cosh tanh coth asinh acosh atanh exp log erf erfc"
).split()
_RULES: Mapping[Any, _Rule] = {
    sp.Add: Dimensions.sum,
    sp.Min: Dimensions.sum,
    sp.Max: Dimensions.sum,
    sp.Mod: Dimensions.sum,
    sp.Pow: Dimensions.power,
    sp.Abs: lambda known, node: known._memo[node.args[0]],
    sp.sign: lambda *_: _PLAIN,
    sp.Heaviside: lambda *_: _PLAIN,
    sp.atan2: Dimensions.ratio,
    sp.Piecewise: _branches,
    **{getattr(sp, name): Dimensions.plain for name in _NUMERIC},
}
"""What each function makes of the dimensions of its arguments; others may make anything of them."""
