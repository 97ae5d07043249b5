"""Quotients of polynomials in sines and cosines as short formulas, and their signs.

Numerator and denominator are brought to normal forms in which of each angle the sine or the cosine is
kept; what both share is divided out, and the shortest way is taken. The result is tested against what
was given, by `eom.exact.identity`, which knows nothing of these ways.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from typing import Any

import sympy as sp

from eom.derivations.verification import DerivationError
from eom.exact.identity import equal, vanishes
from eom.multibody.closed.polynomials import Algebra
from eom.multibody.closed.readable import Writer

Expr = Any
MOST_ANGLES = 3
"""Angles up to which both ways of each are tried."""


def tidy(given: Expr) -> Expr:
    """Return an expression in a short form; zero if it vanishes.

    >>> x, I = sp.symbols("x I", positive=True)
    >>> tidy((I * sp.sin(x) ** 2 + I * sp.cos(x) ** 2 - I * sp.cos(x)) / (2 * I * sp.sin(x) ** 2))
    1/(2*(cos(x) + 1))
    """
    given = sp.sympify(given, strict=True)
    if vanishes(given):
        return sp.S.Zero
    if not given.free_symbols:
        return given
    found = min(_ways(given), key=lambda e: (int(sp.count_ops(e)), str(e)))
    if not equal(found, given):
        raise DerivationError("a rearranged formula has another value", got=found)
    return found


def _ways(given: Expr) -> Iterator[Expr]:
    numerator, denominator = sp.fraction(sp.together(given))
    first = Algebra()
    for part in (numerator, denominator):
        first.lift(part)
    angles = [g.args[0] for g in first.generators if isinstance(g, sp.sin)]
    count = len(angles) if len(angles) <= MOST_ANGLES else 0
    for kept in product((False, True), repeat=count):
        algebra = Algebra()
        for angle, sine in zip(angles, kept, strict=False):
            algebra.angle(angle, keep_sine=sine)
        over = _cancelled(algebra, numerator, denominator)
        write = Writer(algebra)
        above, below = (write(algebra.lift(x)) for x in over)
        yield above / below
        yield _shared(above / below)


def stand_ins(functions: Iterable[Expr]) -> dict[Expr, Expr]:
    """Return symbols in place of functions, the same ones in the same order each time."""
    return {f: sp.Dummy("z", dummy_index=k) for k, f in enumerate(functions)}


def _shared(e: Expr) -> Expr:
    """Return a sum with what all its terms share in front; arguments of sines stay as they are."""
    names = stand_ins(sorted(e.atoms(sp.sin, sp.cos), key=str))
    return sp.factor_terms(e.xreplace(names)).xreplace({v: k for k, v in names.items()})


def _cancelled(algebra: Algebra, numerator: Expr, denominator: Expr) -> tuple[Expr, Expr]:
    """Return normal forms without what both share, the generators as independent symbols."""
    forms = [algebra.expression(algebra.lift(x)) for x in (numerator, denominator)]
    names = stand_ins(g for g in algebra.generators if not g.is_Symbol)
    back = {v: k for k, v in names.items()}
    plain = [f.xreplace(names) for f in forms]
    if not forms[1].free_symbols:
        return forms[0] / forms[1], sp.S.One
    above, below = sp.fraction(sp.cancel(plain[0] / plain[1]))
    return above.xreplace(back), below.xreplace(back)


def signed_factors(given: Expr) -> list[tuple[Expr, bool]] | int:
    """Return the factors that decide the sign of an expression, or the sign where that is known.

    Each factor with whether its square stands there, which may be zero all the same. Factors that are
    positive by what is known of their symbols are left out; a product is positive if it is without them.

    >>> m, x = sp.symbols("m", positive=True), sp.Symbol("x", real=True)
    >>> signed_factors(m * (x - m) ** 3), signed_factors(-m)
    ([(-m + x, False)], -1)
    """
    numerator, denominator = sp.fraction(sp.together(given))
    sign, found = 1, []
    for part in (numerator, denominator):
        number, factors = sp.factor_list(part)
        sign *= 1 if number > 0 else -1 if number < 0 else 0
        for base, power in factors:
            known = _sign(base)
            if known:
                sign *= known ** int(power)
            else:
                found.append((base, power % 2 == 0))
    if not found or not sign:
        return sign
    if sign < 0:
        first = next((k for k, (_, even) in enumerate(found) if not even), None)
        if first is None:
            return [(sp.S.NegativeOne, False), *found]
        found[first] = (sp.expand(-found[first][0]), False)
    return found


def _sign(e: Expr) -> int:
    if e.is_positive:
        return 1
    return -1 if e.is_negative else 0


def condition(given: Expr) -> Expr | bool:
    """Return what must be positive for ``given`` to be so, in short; a truth where that is known."""
    factors = signed_factors(tidy(given))
    if isinstance(factors, int):
        return factors > 0
    return sp.Mul(*(tidy(f) ** (2 if even else 1) for f, even in factors))


def determinant(rows: Sequence[Sequence[Expr]]) -> Expr:
    """Return a determinant without division."""
    return sp.Matrix([list(r) for r in rows]).det(method="berkowitz")
