"""One slip in a line without which it would follow: a sign, a number, a letter or a power too many.

Every part of a side is asked what it would have to be multiplied by for the line to hold. Where that is
a number, or a number times a quotient of letters or of functions of angles, the same at all points, the
line has a slip there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction

import sympy as sp

from eom.checker.consequence.jets import STAYS, Equal, Expr, Together, is_component, jet, letter
from eom.checker.consequence.rules import MP, POINTS, Number, Point, Rules, agrees, points
from eom.checker.consequence.whole import FACTOR as WRITTEN
from eom.errors import InputError
from eom.limits import check

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


View = Callable[[Equal], Equal]
"""What is asked of an equation in the place of itself: itself, or its derivative by the time."""


def slip(
    q: Equal, at: Sequence[Point], letters: frozenset[Expr] = frozenset(), view: View = lambda q: q
) -> Slip | None:
    """Return the simplest slip without which an equation would hold at points; None for none.

    ``letters``: what may stand in the place of one of its own.
    """
    loose = points(Rules())
    if len(at) < POINTS:
        return None
    if q.whole is not None:
        return _of_whole(q, q.whole, at, letters) if view(q) is q else None
    found = []
    values = _values([*_atoms(q), *letters], at)
    for side, path, part in _parts(q):
        check()
        try:
            needed = _needed(view(_put(q, side, path, part * FACTOR)), at)
        except (InputError, ZeroDivisionError, ValueError, TypeError):
            continue
        for factor in _factors(needed, values) if needed else ():
            mended = _put(q, side, path, part * factor)
            if agrees(view(mended), at) and not agrees(view(mended), loose):
                found.append(Slip(part, factor, mended))
                break
    return min(found, key=_simplicity, default=None)


def _of_whole(
    q: Equal, whole: Together, at: Sequence[Point], letters: frozenset[Expr]
) -> Slip | None:
    """Return the simplest slip in what is written of an equation with vectors, one for all components."""
    sides = (s for e in whole.equations for s in (e.left, e.right))
    key = ("slip", whole.link, tuple(at[0].rules.normal(s)[0] for s in sides))
    if key not in whole.memo:
        atoms = [
            a
            for a in (*_atoms(q), *letters)
            if not any(
                is_component(s) or whole.is_entry(s.name.split("|")[0]) for s in a.free_symbols
            )
        ]
        whole.memo[key] = min(_written(whole, atoms, at), key=_simplicity, default=None)
    known: Slip | None = whole.memo[key]
    return known


def _written(whole: Together, atoms: Sequence[Expr], at: Sequence[Point]) -> Iterator[Slip]:
    """Yield slips in the parts of what is written."""
    values = _values(atoms, at)
    for latex, read in whole.scaled():
        equations = [_put_in(e, FACTOR) for e in read]
        needed: list[Number] = []
        with suppress(InputError, ZeroDivisionError, ValueError, TypeError):
            fixed = [e for e in equations if not {FACTOR} & (e.left - e.right).free_symbols]
            if len(fixed) < len(equations) and all(agrees(e, at) for e in fixed):
                needed = next((n for e in equations if e not in fixed if (n := _needed(e, at))), [])
        for factor in _factors(needed, values) if needed else ():
            mended = [_put_in(e, factor) for e in read]
            if _mends(mended, at):
                yield Slip(jet(latex, 0, STAYS), factor, _summed(mended))
                break


def _put_in(e: Equal, factor: Expr) -> Equal:
    return Equal(e.left.xreplace({SCALE: factor}), e.right.xreplace({SCALE: factor}))


def _mends(equations: Sequence[Equal], at: Sequence[Point]) -> bool:
    """Return whether all components agree at points, and not by themselves."""
    loose = points(Rules())
    with suppress(InputError, ZeroDivisionError, ValueError, TypeError):
        return all(agrees(e, at) for e in equations) and not all(
            agrees(e, loose) for e in equations
        )
    return False


def _summed(equations: Sequence[Equal]) -> Equal:
    """Return components as one equation, for what it rests on."""
    return Equal(
        sp.Add(*(k * e.left for k, e in enumerate(equations, 1))),
        sp.Add(*(k * e.right for k, e in enumerate(equations, 1))),
    )


SCALE = jet(WRITTEN.text, 0, STAYS)
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


FACTOR = sp.Dummy("factor")


def _needed(q: Equal, at: Sequence[Point]) -> list[Number]:
    """Return what a factor has to be at points; nothing where an equation is not linear in it."""
    found = []
    for p in at:
        values = []
        for k in TRIED:
            p.values[FACTOR] = MP.mpf(k)
            values.append(p.of(q.left) - p.of(q.right))
        root = _root(values)
        if root is None:
            return []
        found.append(root)
    return found


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


Values = Mapping[Expr, Sequence[Number]]
"""What letters and functions are at points, none of them nothing there."""


def _values(atoms: Iterable[Expr], at: Sequence[Point]) -> Values:
    known = {}
    for a in (sp.S.One, *sorted(set(atoms), key=str)):
        with suppress(InputError, ZeroDivisionError, ValueError, TypeError):
            known[a] = [p.of(a) for p in at]
    return {a: v for a, v in known.items() if all(v)}


def _factors(needed: Sequence[Number], values: Values) -> Iterator[Expr]:
    """Yield numbers, and numbers times quotients of letters and functions, that are what is needed."""
    if all(abs(n - 1) < TINY for n in needed):
        return
    number = _number(needed)
    if number is not None:
        yield number
        return
    alike: dict[tuple[float, ...], list[Expr]] = {}
    for a, v in values.items():
        alike.setdefault(_direction(v), []).append(a)
    for b, v in values.items():
        product = [n * y for n, y in zip(needed, v, strict=True)]
        for a in alike.get(_direction(product), ()):
            number = _number([x / y for x, y in zip(product, values[a], strict=True)], most=2)
            if number is not None and a != b:
                yield number * a / b


def _direction(values: Sequence[Number]) -> tuple[float, ...]:
    """Return what rows of values have in common that are multiples of one another, to a few digits."""
    first = values[0]
    return tuple(float(f"{float(MP.re(v / first)):.9e}") for v in values)


def _atoms(q: Equal) -> frozenset[Expr]:
    """Return letters, and functions of letters."""
    inside = {e for side in (q.left, q.right) for e in sp.preorder_traversal(side)}
    angles = {e.args[0] for e in inside if isinstance(e, sp.sin | sp.cos | sp.tan)}
    letters = {e for e in inside if e.is_Symbol and letter(e) and e not in angles}
    return frozenset({*letters, *(f(a) for a in angles for f in (sp.sin, sp.cos))})


def _number(values: Sequence[Number], most: int = MAX_NUMBER) -> Expr | None:
    """Return the small rational that all values are, but 0 and 1 by itself; None for none."""
    first = values[0]
    if any(abs(v - first) > TINY * abs(first) for v in values) or abs(MP.im(first)) > 1e-20:
        return None
    near = Fraction(float(MP.re(first))).limit_denominator(most)
    small = abs(near.numerator) <= most and near != 0
    if not small or abs(first - MP.mpf(near.numerator) / near.denominator) > 1e-20:
        return None
    return sp.Rational(near.numerator, near.denominator)
