"""Which arguments of a program bound the steps of its series, and by how much they may move.

Each operation that is no polynomial and changes with time has a row in `codegen.watch.reach`. Some rows are
spared: where the partner of a rule holds an operation with a row that bounds at least as much (the
exponential in the derivative of erf, the root in that of asin). A product of so many equal factors that its
degree is the order of the series or more is a power, and is treated as one: its highest coefficients are
not seen. Programs of other polynomials have no limits.

How flat is flat enough is a matter of what a value is multiplied by on its way to the rates: by numbers and
parameters, which are followed (`gains`), and by values that change, for which `MARGIN` is left.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce

from codegen.derivatives.taylor import Prepared, Series
from codegen.ir import scalars
from codegen.ir.groups import RATES
from codegen.ir.interpret import Point, interpret
from codegen.ir.ops import Instruction
from codegen.ir.program import Builder, Program
from codegen.ir.scalars import Scalar
from codegen.watch.reach import ROWS, moved

MARGIN = 40
"""Natural logarithm of what values that change may multiply a flat one by, and of one over the sizes of
states, together: 2e17. Beyond the limit of the tolerance, whose logarithm is twice the order at most."""
BOUNDS = "bounds"
"""Group of results: how far each argument may move."""
_BY_PARTNER = frozenset({"erf", "erfc", "asin", "acos", "asinh", "acosh"})
_OF_PARTNER: Mapping[str, str] = {"hypot": "sqrt", "atan2": "log"}
"""Operations of the sum of two squares, their partner, with the row that it has then."""
_EVERYWHERE_VISIBLE = frozenset({"sin", "cos", "div"})
"""Operations whose series shows at any point what comes: neither flat anywhere nor with a branch."""
_ALIKE: Mapping[str, str] = {"cos": "sin", "sinh": "sin", "cosh": "sin", "expm1": "exp"}
"""Operations with the same limit as another one."""
_AWAY_FROM_ZERO = frozenset({"div", "log", "sqrt"})
"""Operations whose argument moves by a share of its distance from zero at most."""
_ANGLES = frozenset({"sin", "cos"})
_INCLUDED_FROM = 7
"""Order from which the limit of an angle is more than any movement that keeps its sine from zero."""


@dataclass(frozen=True)
class Limit:
    """The argument ``series`` of the value ``of`` moves by the row ``op``, read at ``args``, at most.

    ``exponent``: of a power that was written as products; the row has it beside ``args``.
    """

    series: Series
    of: Series
    op: str
    args: tuple[Series, ...]
    exponent: Fraction | None = None


def limits(prepared: Prepared, order: int) -> tuple[Limit, ...]:
    """Return the limits of a program whose series have an order, each argument and row once."""
    found: dict[tuple[Series, str, Fraction | None], Limit] = {}
    for limit in (*_of_operations(prepared), *_of_products(prepared, order)):
        key = (limit.series, _ALIKE.get(limit.op, limit.op), limit.exponent)
        found.setdefault(key, limit)
    return _without_included(prepared, tuple(found.values()), order)


def _without_included(
    prepared: Prepared, found: tuple[Limit, ...], order: int
) -> tuple[Limit, ...]:
    r"""Leave out the limits of angles whose sine or cosine w is kept from zero by another limit.

    w stays within 3/4 of itself then: in the half plane of its sign, so that the real part of the angle
    stays between two zeros of w, less than pi from where it was; and \|w\| <= 7/4 bounds the imaginary
    part by asinh(7/4), as \|w\|^2 = w(x)^2 + sinh(y)^2 at x + iy. That is a movement of 3.42 at most,
    and sines allow half the order.
    """
    if order < _INCLUDED_FROM:
        return found
    kept = {_angle(prepared, x.series) for x in found if x.op in _AWAY_FROM_ZERO}
    return tuple(x for x in found if x.op not in _ANGLES or x.series not in kept)


def _angle(prepared: Prepared, n: Series) -> Series | None:
    """Return the angle of whose sine or cosine a value is a multiple that stands still."""
    while True:
        op, args, _ = prepared.program.instructions[n]
        if op in _ANGLES:
            return args[0]
        moving = [a for a in args if prepared.varies[a]]
        if (
            op not in {"mul", "neg", "div"}
            or len(moving) != 1
            or (op, moving[0]) == ("div", args[-1])
        ):
            return None
        n = moving[0]


def is_checked(prepared: Prepared, found: Sequence[Limit]) -> bool:
    """Tell whether the slope is tested after every step: where a value may be flat, or have a branch."""
    return any(prepared.program.instructions[x.of].op not in _EVERYWHERE_VISIBLE for x in found)


def _of_operations(prepared: Prepared) -> list[Limit]:
    found = []
    for n, (op, args, _) in enumerate(prepared.program.instructions):
        if not prepared.varies[n] or op not in ROWS or op in _BY_PARTNER:
            continue
        partner = prepared.partner(n)
        if op in _OF_PARTNER:
            found.append(Limit(partner, n, _OF_PARTNER[op], (partner,)))
        elif op == "pow":
            found += _of_power(prepared, n)
        else:
            moving = args[ROWS[op].moving[0]]
            found += [Limit(moving, n, op, args)] if prepared.varies[moving] else []
    return found


def _of_power(prepared: Prepared, n: Series) -> list[Limit]:
    """Return the limit of a power; whole ones have it by their partner, which is of products."""
    args, partner = prepared.program.instructions[n].args, prepared.partner(n)
    if prepared.varies[args[1]]:
        return [Limit(partner, n, "exp", (partner,))]
    return [Limit(args[0], n, "pow", args)] if partner == n else []


def _of_products(prepared: Prepared, order: int) -> list[Limit]:
    """Return the limits of powers that are products."""
    powers: dict[Series, tuple[Series, int]] = {}
    for n, (op, args, _) in enumerate(prepared.program.instructions):
        powers[n] = (n, 1)
        if op == "mul" and prepared.varies[n]:
            (one, first), (other, second) = (powers[a] for a in args)
            if one == other:
                powers[n] = (one, first + second)
    found = ((n, base, degree) for n, (base, degree) in powers.items() if degree >= order)
    return [Limit(base, n, "pow", (base,), Fraction(degree)) for n, base, degree in found]


def again(prepared: Prepared) -> tuple[Builder, list[int]]:
    """Return a builder with the values of a program, and their numbers in it."""
    b = Builder(prepared.program.rules)
    new: list[int] = []
    for instruction in prepared.program.instructions:
        new.append(b.again(instruction, new))
    return b, new


def bounds(prepared: Prepared, order: int) -> tuple[tuple[Limit, ...], Program]:
    """Return the arguments that have limits, and a program of these, its group `BOUNDS`."""
    found, (b, new) = limits(prepared, order), again(prepared)
    return found, b.program({BOUNDS: built(b, new, prepared, found, order)})


def is_analytic(prepared: Prepared, order: int, point: Point) -> bool:
    """Tell whether every operation is analytic where its argument is at a point: each may move.

    Law: if so, and the rates are finite there, the solution goes on, whatever its coefficients are in
    double precision. False says nothing.
    """
    _, program = bounds(prepared, order)
    return all(far > 0 for far in interpret(program, point)[BOUNDS])


def longest(
    b: Builder, new: Sequence[int], prepared: Prepared, found: Sequence[Limit], order: int
) -> int:
    """Return the longest step that arguments allow which are linear in time, as a value of ``b``."""
    slopes = _slopes(b, new, prepared)
    bounds = built(b, new, prepared, found, order)
    steps = (
        Scalar(b, bound) / abs(slopes[x.series]) for bound, x in zip(bounds, found, strict=True)
    )
    shortest: Scalar = reduce(scalars.minimum, steps)
    return shortest.number


def _slopes(b: Builder, new: Sequence[int], prepared: Prepared) -> dict[Series, Scalar]:
    """Return the slopes of values that are linear in time: linear operations are followed."""
    found: dict[Series, Scalar] = {}
    zero = scalars.constant(b, 0)
    for k, (op, args, _) in enumerate(prepared.program.instructions):
        moving = [a for a in args if a in found]
        if op == "time":
            found[k] = scalars.constant(b, 1)
        elif op in {"add", "sub", "neg"} and moving:
            found[k] = scalars.apply(op, *(found.get(a, zero) for a in args))
        elif op in {"mul", "div"} and len(moving) == 1:
            both = (found[a] if a in found else Scalar(b, new[a]) for a in args)
            found[k] = scalars.apply(op, *both)
    return found


def built(
    b: Builder, new: Sequence[int], prepared: Prepared, found: Sequence[Limit], order: int
) -> list[int]:
    """Return how far each argument may move, as values of ``b``, where ``new`` numbers those of order 0."""
    flat = [x.of for x in found if ROWS[x.op].quiet]
    gain = gains(b, new, prepared, flat)
    return [_built(b, new, x, gain.get(x.of), order).number for x in found]


def _built(b: Builder, new: Sequence[int], x: Limit, gain: Scalar | None, order: int) -> Scalar:
    args = [Scalar(b, new[a]) for a in x.args]
    if x.exponent is not None:
        args.append(scalars.constant(b, x.exponent))
    depth = scalars.constant(b, 2 * order + MARGIN)
    if gain is not None and gain != 1:
        depth = depth + scalars.log(scalars.maximum(gain, 1))
    limit: Scalar = moved(x.op, args, order, depth)
    return limit


def gains(
    b: Builder, new: Sequence[int], prepared: Prepared, wanted: Sequence[Series]
) -> dict[Series, Scalar]:
    """Return the largest product of values that stand still, on any way from a value to the rates.

    Values that change, on the way, count as one; so do the slopes of operations.
    """
    if not wanted:
        return {}
    instructions, one = prepared.program.instructions, scalars.constant(b, 1)
    found: dict[Series, Scalar] = dict.fromkeys(prepared.program.results[RATES], one)
    backwards = range(len(instructions) - 1, min(wanted) - 1, -1)
    for n in (*backwards, *backwards):  # twice: partners stand behind what they are partners of
        gain = found.get(n, one)
        ways = [*_factors(b, new, prepared, instructions[n]), (prepared.partner(n), None)]
        for a, factor in ways:
            through = gain if factor is None else gain * abs(factor)
            known = found.get(a, through)
            found[a] = known if known == through else scalars.maximum(known, through)
    return {n: found.get(n, one) for n in wanted}


def _factors(
    b: Builder, new: Sequence[int], prepared: Prepared, instruction: Instruction
) -> list[tuple[Series, Scalar | None]]:
    """Return the arguments that change, each with what stands still and multiplies it."""
    op, args, _ = instruction
    moving = [a for a in args if prepared.varies[a]]
    still = [a for a in args if not prepared.varies[a]]
    if op == "mul" and still:
        return [(a, Scalar(b, new[still[0]])) for a in moving]
    if op == "div" and still and args[1] == still[-1] and moving:
        return [(moving[0], 1 / Scalar(b, new[args[1]]))]
    return [(a, None) for a in moving]
