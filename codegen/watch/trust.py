r"""Which arguments of a program bound the steps of its series, and by how much they may move.

Each operation that is no polynomial and changes with time has a row in `codegen.watch.trust`. Some rows are
spared: where the partner of a rule holds an operation with a row that bounds at least as much (the
exponential in the derivative of erf, the root in that of asin). A product of so many equal factors that its
degree is the order of the series or more is a power, and is treated as one: its highest coefficients are
not seen. Programs of other polynomials have no limits.

How flat is flat enough is a matter of what a value is multiplied by on its way to the rates: by numbers and
parameters, which are followed (`gains`), and by values that change, for which `MARGIN` is left.

How far the argument of an operation may move: one row for each that is not a polynomial.

A series in time of f(u(t)), or a step of a Runge-Kutta method, sees f near u_0 alone. If the argument
moves further than f keeps its character, what was seen says nothing: tanh is flat far from 0, exp is
nothing far below it, a quotient has a pole. A row says three things, for arguments with the values
``args`` of which the moving ones move by at most ``d`` in all, in any direction of the complex plane:

- ``bound(args, d)``: a bound of \|f\| on that disc, infinite where it may hold a singularity. With it
  Cauchy's estimate bounds each coefficient of f about u_0 by bound / d^n.
- ``reach(args, order)``: how far the coefficients below ``order`` may be trusted. Law: for movements up to
  it, all terms \|f_n\| d^n from n = ``order`` on add up to at most `HONEST` times the larger of the two
  before, so that what is cut off cannot be large where what is seen is small. No scale enters: the law
  holds for exp(-100) as for exp(100).
- ``quiet(args, depth)``: how far the argument may move while f stays within exp(-``depth``) of a constant;
  negative where it does not even at u_0. Where f is that flat, no step need follow it. None: f is flat
  nowhere.

A step is trusted where each argument moves by at most the larger of reach and quiet (see `moved`). The
rows are written over scalars, so that every target can have them; ``order`` is a number that is known
when the code is made. Which use: method taylor takes S = \|u_1\| h + \|u_2\| h^2 + ... for the movement,
from the coefficients of the argument; an explicit Runge-Kutta method of order q may take ``reach`` of
order q and the movement \|du/dt\| h, with an interval for du/dt where u is a function of time alone.

Sums, products and negation are polynomials of degree one or two in their arguments. `PIECES` have no
series: steps end where they change (`codegen.ir.program`). Linear systems are rational functions, whose
coefficients show the nearest pole; no bound of a determinant is made. Estimates by Cauchy: Ahlfors,
Complex Analysis, 3rd ed. (1979), sect. 4.2.3; functions: DLMF, chapters 4, 7, 10.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial, reduce
from typing import Any

from codegen.derivatives.taylor import Prepared, Series
from codegen.ir import scalars
from codegen.ir.interpret import Point, interpret
from codegen.ir.ops import BLOCKS, TRUTH_VALUES, Instruction
from codegen.ir.program import RATES, Builder, Program
from codegen.ir.scalars import Plain, Scalar, apply, maximum, minimum, where
from eom.errors import InputError

HONEST = 8
"""What is cut off within the reach, at most, over the larger of the last two terms that are seen."""
SHARE = Fraction(3, 4)
"""Of the distance to a singularity: terms of a geometric series beyond n add up to three times the n-th."""

Term = Any
"""A scalar; what its operators return."""
Args = Sequence[Scalar]
Bound = Callable[[Args, Scalar], Term]
Reach = Callable[[Args, int], Term]
Quiet = Callable[[Args, Scalar], Term]


@dataclass(frozen=True)
class Row:
    """What is known of one operation; ``moving``: the arguments whose movement, added up, is meant."""

    bound: Bound
    reach: Reach
    quiet: Quiet | None = None
    moving: tuple[int, ...] = (0,)


POLYNOMIALS = frozenset({"add", "sub", "neg", "mul"})
PIECES = frozenset({*TRUTH_VALUES, "abs", "sign", "min", "max", "select", "floor", "mod", "table"})
"""Operations that are put together of pieces, or constant between jumps."""
LINEAR_SYSTEMS = frozenset({*BLOCKS, "item"})


def _of(x: Scalar, value: Plain) -> Term:
    return scalars.constant(x.builder, value)


def _pi(x: Scalar) -> Term:
    return Scalar(x.builder, x.builder.leaf("pi"))


def _left(radius: Scalar, d: Scalar) -> Term:
    """What is left of a radius, zero beyond: its inverse is infinite there."""
    return maximum(radius - d, 0)


def _inside(value: Scalar, radius: Scalar, d: Scalar) -> Term:
    """The value where d is less than the radius, infinite elsewhere."""
    return where(d < radius, value, 1 / _left(radius, d))


def _share(radius: Callable[[Args], Scalar]) -> Reach:
    return lambda a, order: radius(a) * SHARE


def _half_order(a: Args, order: int) -> Term:
    """Terms of entire functions of order one and type one, as of exp: d^n / n!."""
    return _of(a[0], Fraction(order, 2))


# -- distances to the nearest singularity --------------------------------------------------------------


def _from_zero(a: Args) -> Term:
    return abs(a[0])


def _of_divisor(a: Args) -> Term:
    return abs(a[1])


def _from_minus_one(a: Args) -> Term:
    return abs(1 + a[0])


def _to_ones(a: Args) -> Term:
    """From -1 and 1, from between them."""
    return maximum(1 - abs(a[0]), 0)


def _above_one(a: Args) -> Term:
    return maximum(a[0] - 1, 0)


def _from_units(a: Args) -> Term:
    """From i and -i."""
    return scalars.sqrt(1 + a[0] * a[0])


def _from_odd_quarters(a: Args) -> Term:
    """From the odd multiples of pi/2, on the real axis."""
    return scalars.asin(abs(scalars.cos(a[0])))


def _from_half_turns(a: Args) -> Term:
    """From the poles i pi/2 and -i pi/2 of tanh."""
    return scalars.sqrt(a[0] * a[0] + _pi(a[0]) * _pi(a[0]) / 4)


def _norm(a: Args) -> Term:
    """Of (x, y): x + i y and x - i y must not vanish."""
    return apply("hypot", a[0], a[1])


# -- bounds on discs -----------------------------------------------------------------------------------


def _tan_bound(a: Args, d: Scalar) -> Term:
    r"""\|sin z\| <= cosh d; \|cos z\| >= sin of what is left of the distance to its zero."""
    return scalars.cosh(d) / scalars.sin(_left(_from_odd_quarters(a), d))


def _tanh_bound(a: Args, d: Scalar) -> Term:
    r"""1 + 1/(0.9 distance to the poles): \|tanh z\|^2 = 1 - cos(2y)/(sinh(x)^2 + cos(y)^2)."""
    return 1 + Fraction(10, 9) / _left(_from_half_turns(a), d)


def _log_bound(radius: Callable[[Args], Scalar], a: Args, d: Scalar) -> Term:
    r"""\|log(1 + w)\| <= -log(1 - \|w\|), as the coefficients of the latter are the moduli."""
    r = radius(a)
    return abs(scalars.log(r)) + scalars.log(1 / _left(_of(r, 1), d / r))


def _pow_bound(a: Args, d: Scalar) -> Term:
    """A power of the largest or the smallest modulus on the disc."""
    x, y = abs(a[0]), a[1]
    grows = (x + d) ** y
    falls = _left(x, d) ** minimum(y, 0)
    return where(y < 0, falls, where(_is_whole(y), grows, _inside(grows, x, d)))


def _is_whole(y: Scalar) -> Term:
    return scalars.equal(apply("floor", y), y)


def _asin_bound(a: Args, d: Scalar) -> Term:
    """The coefficients about 0 are positive: no modulus exceeds the value at the modulus."""
    return _inside(scalars.asin(minimum(abs(a[0]) + d, 1)), _to_ones(a), d)


def _atan_bound(a: Args, d: Scalar) -> Term:
    """The slope is at most 1/(rho - s)^2 after a movement s, by the distances to both poles."""
    rho = _from_units(a)
    return abs(scalars.atan(a[0])) + d / (rho * _left(rho, d))


def _asinh_bound(a: Args, d: Scalar) -> Term:
    """The slope is at most 1/(rho - s)."""
    rho = _from_units(a)
    return abs(scalars.asinh(a[0])) + scalars.log(1 / _left(_of(rho, 1), d / rho))


def _acosh_bound(a: Args, d: Scalar) -> Term:
    """The slope is at most 1/sqrt(2 (rho - s)): its integral is at most sqrt(2 rho)."""
    rho = _above_one(a)
    return _inside(scalars.acosh(a[0]) + scalars.sqrt(2 * rho), rho, d)


def _atanh_bound(a: Args, d: Scalar) -> Term:
    """As for asin; atanh(r) = log((1 + r)/(1 - r))/2."""
    return scalars.log(2 / _left(_to_ones(a), d)) / 2


def _erf_bound(a: Args, d: Scalar) -> Term:
    r"""1 + (2/sqrt pi) \|y\| exp(y^2 - x^2), with the largest exponent on the disc (DLMF 7.2.1)."""
    x = abs(a[0])
    exponent = where(x < 2 * d, d * d - x * x / 2, -(x - d) * (x - d))
    return 1 + 2 / scalars.sqrt(_pi(x)) * d * scalars.exp(exponent)


def _bessely_bound(a: Args, d: Scalar) -> Term:
    """Both integrals of DLMF 10.9.7; the second is largest at the smallest real part."""
    n, x = a
    nearest = apply("bessely", n, maximum(x - d, 0))
    return _inside(scalars.exp(d) + 1 + abs(nearest), x, d)


def _norm_log_bound(a: Args, d: Scalar) -> Term:
    """The angle is half the difference of the logarithms of x + i y and x - i y."""
    r = _norm(a)
    return _pi(r) + scalars.log(1 / _left(_of(r, 1), d / r))


# -- reaches ---------------------------------------------------------------------------------------------


def _tanh_reach(a: Args, order: int) -> Term:
    """Near 0 the nearest poles decide all; far from it tanh is exp(-2u) beside a constant."""
    return minimum(_from_half_turns(a) / 2, Fraction(order, 4))


def _erf_reach(a: Args, order: int) -> Term:
    """The exponent u^2 of the derivative moves by 2 u d + d^2: by a quarter of the order."""
    quarter = Fraction(order, 4)
    return quarter / (abs(a[0]) + scalars.sqrt(a[0] * a[0] + quarter))


def _pow_reach(a: Args, order: int) -> Term:
    """Coefficients n and n + 1 have the ratio (y - n)/((n + 1) u_0); low whole powers end early."""
    x, y = a
    ratio = maximum(1, abs(y - (order - 1)) / order)
    ends = apply("and", apply("and", _is_whole(y), y >= 0), y < order)
    far = abs(x) * SHARE / ratio
    return where(ends, _of(x, Fraction(10) ** 300), far)


def _bessely_reach(a: Args, order: int) -> Term:
    return minimum(abs(a[1]) * SHARE, Fraction(order, 2))


def _stumpff_reach(a: Args, order: int) -> Term:
    """As of cos at the root of the argument: this moves by half the order at most."""
    half = Fraction(order, 2)
    return half * half + half * 2 * scalars.sqrt(abs(a[1]))


# -- where functions are flat ----------------------------------------------------------------------------


def _exp_quiet(a: Args, depth: Scalar) -> Term:
    return -a[0] - depth


def _tanh_quiet(a: Args, depth: Scalar) -> Term:
    r"""\|tanh z - 1\| <= 2 exp(-2x)/(1 - exp(-2x)) <= 4 exp(-2x) where 2x > log 2."""
    return abs(a[0]) - depth / 2 - Fraction(7, 10)


def _pow_quiet(a: Args, depth: Scalar) -> Term:
    """A whole positive power is small about zero."""
    x, y = a
    small = scalars.exp(-depth / maximum(y, 1)) - abs(x)
    return where(apply("and", _is_whole(y), y >= 1), small, -1)


def _erf_quiet(a: Args, depth: Scalar) -> Term:
    r"""The largest exponent on the disc, of `_erf_bound`, is below -``depth``, and d is a factor."""
    x = abs(a[0])
    deep = depth + scalars.log(1 + 2 * x)
    near = minimum(x - scalars.sqrt(deep), x / 2)
    rest = x * x / 2 - deep
    return maximum(near, where(4 * deep <= x * x, scalars.sqrt(maximum(rest, 0)), -1))


ROWS: Mapping[str, Row] = {
    "exp": Row(lambda a, d: scalars.exp(a[0] + d), _half_order, _exp_quiet),
    "expm1": Row(lambda a, d: 1 + scalars.exp(a[0] + d), _half_order, _exp_quiet),
    "sin": Row(lambda a, d: scalars.cosh(d), _half_order),
    "cos": Row(lambda a, d: scalars.cosh(d), _half_order),
    "sinh": Row(lambda a, d: scalars.cosh(abs(a[0]) + d), _half_order),
    "cosh": Row(lambda a, d: scalars.cosh(abs(a[0]) + d), _half_order),
    "tan": Row(_tan_bound, _share(_from_odd_quarters)),
    "tanh": Row(_tanh_bound, _tanh_reach, _tanh_quiet),
    "log": Row(partial(_log_bound, _from_zero), _share(_from_zero)),
    "log1p": Row(partial(_log_bound, _from_minus_one), _share(_from_minus_one)),
    "sqrt": Row(lambda a, d: _inside(scalars.sqrt(a[0] + d), a[0], d), _share(_from_zero)),
    "div": Row(lambda a, d: abs(a[0]) / _left(abs(a[1]), d), _share(_of_divisor), moving=(1,)),
    "pow": Row(_pow_bound, _pow_reach, _pow_quiet),
    "hypot": Row(lambda a, d: _inside(_norm(a) + d, _norm(a), d), _share(_norm), moving=(0, 1)),
    "atan2": Row(_norm_log_bound, _share(_norm), moving=(0, 1)),
    "asin": Row(_asin_bound, _share(_to_ones)),
    "acos": Row(lambda a, d: _pi(d) / 2 + _asin_bound(a, d), _share(_to_ones)),
    "atan": Row(_atan_bound, _share(_from_units)),
    "asinh": Row(_asinh_bound, _share(_from_units)),
    "acosh": Row(_acosh_bound, _share(_above_one)),
    "atanh": Row(_atanh_bound, _share(_to_ones)),
    "erf": Row(_erf_bound, _erf_reach, _erf_quiet),
    "erfc": Row(lambda a, d: 1 + _erf_bound(a, d), _erf_reach, _erf_quiet),
    "besselj": Row(lambda a, d: scalars.exp(d), _half_order, moving=(1,)),
    "bessely": Row(_bessely_bound, _bessely_reach, moving=(1,)),
    "stumpff": Row(lambda a, d: apply("stumpff", a[0], -(abs(a[1]) + d)), _stumpff_reach, moving=(1,)),
}  # fmt: skip
"""What is known of each operation that has a scale or a radius of its own.

`hypot` and `atan2` are written for movements of x and y, added up. A power whose exponent moves is
exp(y log x) and moves as the argument of that."""


def moved(op: str, args: Args, order: int, depth: Plain | Scalar | None = None) -> Term:
    """Return how far the argument of an operation may move in a step: reach, or quiet if that is more."""
    row = ROWS[op]
    reach = row.reach(args, order)
    if depth is None or row.quiet is None:
        return reach
    deep = depth if isinstance(depth, Scalar) else _of(reach, depth)
    return maximum(reach, row.quiet(args, deep))


def _evaluated(build: Callable[[Sequence[Scalar]], Scalar], numbers: Sequence[float]) -> float:
    b = Builder()
    given = [scalars.constant(b, n) if isinstance(n, int) else Scalar(b, b.leaf("parameter", k))
             for k, n in enumerate(numbers)]  # fmt: skip
    program = scalars.program(b, {"value": [build(given)]})
    return interpret(program, Point(p=[float(n) for n in numbers]))["value"][0]


def _row(op: str) -> Row:
    if op not in ROWS:
        raise InputError("no reach of this operation", got=op, expected=f"one of {', '.join(ROWS)}")
    return ROWS[op]


def bound_of(op: str, args: Sequence[float], d: float) -> float:
    """Return the bound of an operation as a number; whole numbers of ``args`` are constants.

    Raises `InputError` for an operation without a row, as do the others.
    """
    row = _row(op)
    return _evaluated(lambda a: row.bound(a[:-1], a[-1]), [*args, float(d)])


def reach_of(op: str, args: Sequence[float], order: int) -> float:
    """Return the reach of an operation as a number."""
    row = _row(op)
    return _evaluated(lambda a: row.reach(a, order), args)


def quiet_of(op: str, args: Sequence[float], depth: float) -> float | None:
    """Return how far an operation stays flat as a number, None where it is flat nowhere."""
    quiet = _row(op).quiet
    return quiet and _evaluated(lambda a: quiet(a[:-1], a[-1]), [*args, float(depth)])


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
    """Return whether the slope is tested after every step: where a value may be flat, or have a branch."""
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
    """Return whether every operation is analytic where its argument is at a point: each may move.

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
