"""One slip in a line without which it would follow: a sign, a number, a letter or a power too many.

Every part of a side is asked what it would have to be multiplied by for the line to hold. Where that is
a number, or a number times a quotient of letters or of functions of angles, the same at all points, the
line has a slip there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import permutations

import sympy as sp

from eom.checker.consequence.letters import Equal, Expr, is_component, jet, letter
from eom.checker.consequence.rules import MP, POINTS, Number, Point, Rules, agrees, points
from eom.checker.consequence.whole import FACTOR, Whole
from eom.errors import InputError

MAX_NUMBER = 12
"""Numerator and denominator of a number that a slip may change."""
MAX_PARTS = 60


@dataclass(frozen=True)
class Slip:
    """A part of a line that would have to be multiplied by something for the line to hold."""

    part: Expr
    factor: Expr
    mended: Equal

    @property
    def plain(self) -> bool:
        """Whether a sign or a number alone is wrong."""
        return bool(self.factor.is_number)


def slip(q: Equal, rules: Rules, letters: frozenset[Expr] = frozenset()) -> Slip | None:
    """Return the simplest slip without which an equation would follow by rules; None for none.

    ``letters``: what may stand in the place of one of its own.
    """
    at, loose = points(rules), points(Rules())
    if q.whole is not None:
        return _of_whole(q, q.whole, at, letters)
    found = []
    for side, path, part in _parts(q):
        try:
            needed = [_needed(q, side, path, p) for p in at]
        except (InputError, ZeroDivisionError, ValueError, TypeError):
            continue
        if None in needed:
            continue
        for factor in _factors([n for n in needed if n is not None], [*_atoms(q), *letters], at):
            mended = _put(q, side, path, part * factor)
            if agrees(mended, at) and not agrees(mended, loose):
                found.append(Slip(part, factor, mended))
                break
    return min(found, key=_simplicity, default=None)


def _of_whole(q: Equal, whole: Whole, at: Sequence[Point], letters: frozenset[Expr]) -> Slip | None:
    """Return the simplest slip in what is written of an equation with vectors, the same for all components."""
    if len(at) < POINTS:
        return None
    rules = at[0].rules
    sides = (s for e in whole.equations for s in (e.left, e.right))
    key = ("slip", whole.link, tuple(rules.normal(s)[0] for s in sides))
    if key not in whole.memo:
        whole.memo[key] = _slip_of(whole, [*_atoms(q), *letters], at)
    known: Slip | None = whole.memo[key]
    return known


def _slip_of(whole: Whole, atoms: Sequence[Expr], at: Sequence[Point]) -> Slip | None:
    found: list[Slip] = []
    atoms = [a for a in atoms if not any(map(is_component, a.free_symbols))]
    for written, equations in whole.scaled():
        factors: Iterator[Expr] = iter(())
        with suppress(InputError, ZeroDivisionError, ValueError, TypeError):
            needed = [n for p in at if (n := _factor(equations, p)) is not None]
            if len(needed) == len(at):
                factors = _factors(needed, atoms, at)
        for factor in factors:
            mended = tuple(
                replace(e, left=_scaled(e.left, factor), right=_scaled(e.right, factor))
                for e in equations
            )
            if _mends(mended, at):
                part = jet(written, moving=False)
                found.append(Slip(part, factor, _summed(mended)))
                break
    return min(found, key=_simplicity, default=None)


def _scaled(e: Expr, factor: Expr) -> Expr:
    return e.xreplace({SCALE: factor})


def _mends(equations: Sequence[Equal], at: Sequence[Point]) -> bool:
    """Return whether all components agree at points, and not by themselves."""
    loose = points(Rules())
    return all(agrees(e, at) for e in equations) and not all(agrees(e, loose) for e in equations)


def _summed(equations: Sequence[Equal]) -> Equal:
    """Return components as one equation, for what it rests on."""
    return Equal(
        sp.Add(*(k * e.left for k, e in enumerate(equations, 1))),
        sp.Add(*(k * e.right for k, e in enumerate(equations, 1))),
    )


def _factor(equations: Sequence[Equal], at: Point) -> Number | None:
    """Return by what a part of components has to be multiplied at a point; None for no such."""
    for e in equations:
        if SCALE in e.letters:
            values = []
            for k in TRIED:
                put = {SCALE: sp.Integer(k)}
                values.append(at.of(e.left.xreplace(put)) - at.of(e.right.xreplace(put)))
            if any(abs(v) > TINY for v in values):
                return _root(values)
        elif not _agrees_at(e, at):
            return None
    return None


def _agrees_at(e: Equal, at: Point) -> bool:
    a, b = at.sides(e)
    return bool(abs(a - b) <= TINY * (abs(a) + abs(b)))


SCALE = jet(FACTOR.text, moving=False)
"""The factor at a part of what is written."""


def _simplicity(s: Slip) -> tuple[bool, bool, int]:
    return not s.plain, s.factor != -1, (s.part * s.factor).count_ops()


Path = tuple[int, ...]


def _parts(q: Equal) -> Iterator[tuple[str, Path, Expr]]:
    """Yield the parts of both sides, with their places; no numbers and no exponents."""
    left = MAX_PARTS
    for side in ("left", "right"):
        todo: list[tuple[Path, Expr]] = [((), getattr(q, side))]
        while todo and left:
            path, part = todo.pop()
            if part.is_number:
                continue
            left -= 1
            yield side, path, part
            inside = part.args[:1] if part.is_Pow else part.args
            todo += [((*path, k), a) for k, a in enumerate(inside)]


def _put(q: Equal, side: str, path: Path, new: Expr) -> Equal:
    """Return an equation with another part in a place."""

    def put(e: Expr, path: Path) -> Expr:
        if not path:
            return new
        args = list(e.args)
        args[path[0]] = put(args[path[0]], path[1:])
        return e.func(*args)

    return replace(q, **{side: put(getattr(q, side), path)})


def _needed(q: Equal, side: str, path: Path, at: Point) -> Number | None:
    """Return by what a part has to be multiplied at a point; None where the line is not linear in it."""
    part = getattr(q, side)
    for k in path:
        part = part.args[k]
    values = []
    for k in TRIED:
        changed = _put(q, side, path, part * k)
        values.append(at.of(changed.left) - at.of(changed.right))
    return _root(values)


TRIED = (2, 3, 5, 7)


def _root(values: Sequence[Number]) -> Number | None:
    """Return where (a + b k) / (1 + c k) with these values vanishes; None where it is no such function."""
    steps = [
        (TRIED[n] - TRIED[0], TRIED[n] * values[n] - TRIED[0] * values[0], values[n] - values[0])
        for n in (1, 2, 3)
    ]
    (p, q, r), (s, t, u), _ = steps
    below = q * s - p * t
    if abs(below) < TINY * (abs(q * s) + abs(p * t)):
        return None
    b, c = (q * u - r * t) / below, (p * u - r * s) / below
    if any(abs(b * x - c * y - z) > TINY * (abs(b * x) + abs(c * y) + abs(z)) for x, y, z in steps):
        return None
    a = values[0] * (1 + c * TRIED[0]) - b * TRIED[0]
    return -a / b if abs(b) > TINY * abs(a) else None


TINY = MP.mpf(10) ** -20
ROUGH = 1e-9
"""Relative error of plain numbers, by which quotients are told apart before all digits are asked."""


def _factors(
    needed: Sequence[Number], atoms: Sequence[Expr], at: Sequence[Point]
) -> Iterator[Expr]:
    """Yield numbers, and numbers times quotients of letters and functions, that are what is needed."""
    number = _number(needed)
    if number is not None:
        yield number
        return
    atoms = [sp.S.One, *sorted(set(atoms), key=str)]
    values = {a: [p.of(a) for p in at] for a in atoms}
    first, second = ({a: complex(v[k]) for a, v in values.items()} for k in (0, 1))
    steps = complex(needed[0]), complex(needed[1])
    for a, b in permutations(atoms, 2):
        near = steps[0] * first[b] * second[a], steps[1] * second[b] * first[a]
        if abs(near[0] - near[1]) > ROUGH * abs(near[0]):
            continue
        rest = [n * y / x for n, x, y in zip(needed, values[a], values[b], strict=True)]
        number = _number(rest, most=2)
        if number is not None:
            yield number * a / b


def _atoms(q: Equal) -> frozenset[Expr]:
    """Return letters, and functions of letters."""
    inside = {e for side in (q.left, q.right) for e in sp.preorder_traversal(side)}
    angles = {e.args[0] for e in inside if isinstance(e, sp.sin | sp.cos | sp.tan)}
    letters = {e for e in inside if e.is_Symbol and letter(e) and e not in angles}
    return frozenset({*letters, *(f(a) for a in angles for f in (sp.sin, sp.cos))})


def _number(values: Sequence[Number], most: int = MAX_NUMBER) -> Expr | None:
    """Return the small rational that all values are, but 0 and 1 by itself; None for none."""
    first = values[0]
    if (
        any(abs(v - first) > TINY * abs(first) for v in values)
        or abs(MP.im(first)) > 1e-20
    ):
        return None
    near = Fraction(float(MP.re(first))).limit_denominator(most)
    small = abs(near.numerator) <= most and near != 0
    if not small or abs(first - MP.mpf(near.numerator) / near.denominator) > 1e-20:
        return None
    return sp.Rational(near.numerator, near.denominator)
