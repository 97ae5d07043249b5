"""Fits of numbers at several points: one or two terms with factors that can be told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

from eom.checker.judge.numbers import MP, Number

RIGHT = 9.0
"""Digits from which on doubles are taken for equal: rounding in code of any order leaves more."""
LARGEST = 12
"""Numerators and denominators of factors that are told as fractions."""

FEW = 3
"""Points that are looked at first."""

_SPECIAL: tuple[tuple[str, Number], ...] = (
    ("pi/180", MP.pi / 180),
    ("180/pi", 180 / MP.pi),
    ("2*pi", 2 * MP.pi),
    ("1/(2*pi)", 1 / (2 * MP.pi)),
)


@dataclass(frozen=True)
class Fit:
    """A factor in words and as a number."""

    words: str
    value: Number


def digits(given: Sequence[Number], true: Sequence[Number], size: Sequence[Number]) -> float:
    """Return to how many digits values agree at all points, measured by ``size``; 17 at most."""
    worst = MP.mpf(0)
    for a, b, s in zip(given, true, size, strict=True):
        if not (MP.isfinite(a) and MP.isfinite(b)):
            return 0.0
        error = abs(a - b)
        worst = max(worst, error / s if s else error)
    return 17.0 if worst == 0 else min(17.0, float(-MP.log10(worst)))


def likely(values: Sequence[Number], term: Sequence[Number], size: Sequence[Number]) -> bool:
    """Tell whether a term may make the values, by the first of the points."""
    if not all(map(MP.isfinite, (*values[:FEW], *term))) or not term[0]:
        return False
    factor = values[0] / term[0]
    made = [factor * t for t in term]
    return digits(values[: len(term)], made, size[: len(term)]) >= RIGHT - 1


def fitted(values: Sequence[Number], term: Sequence[Number], size: Sequence[Number]) -> Fit | None:
    """Return the factor by which a term makes the values at all points, if it can be told."""
    weight = MP.fsum(t * t for t in term)
    if not weight or not all(map(MP.isfinite, (*values, *term))):
        return None
    factor = MP.fsum(v * t for v, t in zip(values, term, strict=True)) / weight
    fit = named(factor)
    made = [fit.value * t for t in term] if fit is not None else []
    return fit if fit is not None and digits(values, made, size) >= RIGHT else None


def paired(
    values: Sequence[Number], terms: Sequence[Sequence[Number]], size: Sequence[Number]
) -> tuple[tuple[int, Fit], tuple[int, Fit]] | None:
    """Return two terms by their places, with factors that can be told, that make the values."""
    for j, k in combinations(range(len(terms)), 2):
        solved = _solved(values[: FEW + 1], terms[j][: FEW + 1], terms[k][: FEW + 1])
        fits = [named(c) for c in solved] or [None, None]
        a, b = fits
        if a is not None and b is not None:
            made = [a.value * x + b.value * y for x, y in zip(terms[j], terms[k], strict=True)]
            if digits(values, made, size) >= RIGHT:
                return (j, a), (k, b)
    return None


def _solved(v: Sequence[Number], x: Sequence[Number], y: Sequence[Number]) -> tuple[Number, ...]:
    """Return the factors of two terms by least squares; none where the terms are as good as one."""
    xx, yy, xy = _dot(x, x), _dot(y, y), _dot(x, y)
    vx, vy = _dot(v, x), _dot(v, y)
    determinant = xx * yy - xy * xy
    if determinant <= MP.mpf(10) ** -12 * xx * yy:
        return ()
    return (vx * yy - vy * xy) / determinant, (vy * xx - vx * xy) / determinant


def _dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    return MP.fsum(x * y for x, y in zip(a, b, strict=True))


def named(factor: Number) -> Fit | None:
    """Return a number as a small fraction, or as one of the factors between units of angles."""
    if not MP.isfinite(factor) or abs(factor) > 1000:
        return None
    fraction = Fraction(float(factor)).limit_denominator(LARGEST)
    exact = MP.mpf(fraction.numerator) / fraction.denominator
    if fraction and abs(factor - exact) <= MP.mpf(10) ** -8 and abs(fraction.numerator) <= LARGEST:
        return Fit(str(fraction), exact)
    for words, value in _SPECIAL:
        if abs(factor / value - 1) <= MP.mpf(10) ** -8:
            return Fit(words, value)
        if abs(factor / value + 1) <= MP.mpf(10) ** -8:
            return Fit(f"-{words}", -value)
    return None
