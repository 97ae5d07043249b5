"""Narrow features of rates: which arguments are watched so that no step passes over one.

A Runge-Kutta method knows the rates at its stages alone. A pulse between two of them, a wall, a window of
a Piecewise leaves no trace in its estimate of the error. What gives them away is not the rate but the
*argument* of an operation: the exponent of a Gaussian moves by hundreds while exp of it stays 0. So the
steps of every method are bounded by how far arguments move, by the table `codegen.watch.trust`:

- Arguments of time and parameters alone have bounds over a step *ahead* of it, by intervals
  (`codegen.watch.intervals`): a proof. The group `AHEAD` says of two times whether every such operation
  keeps its character between them, and whether every condition, table and whole number stays on one piece.
- Arguments that states enter are `WATCHED` at the stages, beside the rates, at no further evaluation.
  Their bounds over the step follow from these values and the steepest slope beside each gap; the group
  `VERDICT` gives the share of the step that they allow, and whether a piece changes.

sin and cos, sqrt, hypot and inverse sines are not watched: whatever they hide shows at every place, as
oscillation or as a kink. Nor are divisors and logarithms whose arguments depend on states through sines
and cosines alone, as those of kinematics and mass matrices: they have no scale beside the radian, and
configurations where they vanish are singularities of the system.

Pivots of positive definite mass matrices are watched like other divisors where lengths or quaternions
enter. They cannot vanish, but may come as near to zero as they like: a mass that slides past the axis of a
light hinge has m q^2 + J, which is as narrow as sqrt(J/m), and a rolling disc that all but falls flat turns
in no time. Watching costs little where nothing happens: one look at the stages shows that bounds are
within what is always allowed, and of divisors and the like the way towards zero alone counts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

from codegen.ir import scalars
from codegen.ir.ops import OPS, Instruction
from codegen.ir.passes import needed, prune
from codegen.ir.program import RATES, Builder, Program
from codegen.ir.scalars import Scalar, apply, maximum, minimum, where
from codegen.watch import trust
from codegen.watch.intervals import Interval, bounds, number_of_piece
from eom.tables import Table

AHEAD, WATCHED, VERDICT = "ahead", "watched", "verdict"
"""Groups of results of the three programs."""
MARGIN = 23
"""Below the relative tolerance by exp(-23) = 1e-10, what an operation still varies by is nothing: also
where its value is multiplied by so large a number."""
ORDER = 16
"""What `reach` is taken of: about the number of stages of order 8, and not its order, since a feature need
not be resolved in a step to be seen in it; the estimate of the error does the rest."""
_ALGEBRAIC = frozenset({"div", "log", "log1p", "pow", "atan", "asinh", "atanh", "atan2", "bessely"})
_ENTIRE = frozenset({"exp", "expm1", "tanh", "sinh", "cosh", "erf", "erfc"})
_POLES = frozenset({"div", "log"})
_GROW_UPWARDS = frozenset({"exp", "expm1"})
_LARGEST = Fraction(10) ** 300
_POWER_FROM = 8
"""Degree from which products of equal factors are watched as a power."""
FIXED, TIMED, MOVING = 0, 1, 2
Argument = int | Fraction
"""Number of a value of the program, or an exponent that is known."""


@dataclass(frozen=True)
class Watch:
    """An operation and the values that it is watched by.

    Pieces: ``sign`` of one value, ``floor`` of it, ``table`` with its data.
    """

    op: str
    args: tuple[Argument, ...]
    table: Table | None = None

    @property
    def is_piece(self) -> bool:
        """Whether it is a value whose piece must not change."""
        return self.op not in trust.ROWS

    @property
    def moving(self) -> tuple[int, ...]:
        """Places of the arguments whose movement counts."""
        return (0,) if self.is_piece else trust.ROWS[self.op].moving


@dataclass(frozen=True)
class Narrow:
    """What is watched of a program of rates, as programs; each None where there is nothing.

    ``ahead``: slots of state are now, the earlier and the later end, the depth; results: whether the
    operations keep their character, and whether pieces stay. ``watched``: the rates, then columns of
    watched values. ``verdict``: slots of state are the value now, the least and the largest of each
    column, and the depth behind; results: shares of the ``guards``, whether the ``pieces`` stay.
    """

    ahead: Program | None
    watched: Program | None
    verdict: Program | None
    columns: int = 0
    guards: int = 0
    pieces: int = 0
    guarded: int = 0
    """Columns of the guards, which come first."""
    soon: tuple[tuple[float, float], ...] = ()
    """For each of these a movement that is always allowed: a share of the value, or so much of it."""
    to_zero: tuple[bool, ...] = ()
    """For each of these whether its way towards zero alone counts."""


NOTHING = Narrow(None, None, None)


@lru_cache(maxsize=64)
def narrow(program: Program, moving_inputs: bool = False) -> Narrow:
    """Return what is watched of the rates of a program; ``moving_inputs``: inputs vary with time."""
    program = prune(program, [RATES])
    b = Builder(program.rules)
    copy: list[int] = []
    for i in program.instructions:
        copy.append(b.again(i, copy))
    copied = b.program({RATES: [copy[k] for k in program.results[RATES]]})
    when = _when(copied, moving_inputs)
    guards = _guards(copied, when)
    pieces = _pieces(b, copied)
    whole = b.program(copied.results)
    when = _when(whole, moving_inputs)
    timed = [w for w in (*guards, *pieces) if _latest(w, when) == TIMED]
    later = [w for w in guards if _latest(w, when) == MOVING and _may_hide(w, whole)]
    later += [w for w in pieces if _latest(w, when) == MOVING]
    ahead, unbounded = _ahead(whole, timed)
    later += unbounded
    if not later:
        return replace(NOTHING, ahead=ahead)
    return _of_states(
        whole, ahead, [w for w in later if not w.is_piece], [w for w in later if w.is_piece]
    )


def _when(program: Program, moving_inputs: bool) -> list[int]:
    """Return for each value whether it is fixed, moves with time alone, or with states."""
    leaf = {"time": TIMED, "state": MOVING, "input": MOVING if moving_inputs else FIXED}
    found: list[int] = []
    for op, args, _ in program.instructions:
        found.append(max((leaf.get(op, FIXED), *(found[a] for a in args))))
    return found


def _latest(watch: Watch, when: Sequence[int]) -> int:
    return max(when[a] for k in watch.moving if isinstance(a := watch.args[k], int))


# --- what is watched ------------------------------------------------------------------------------


def _powers(program: Program) -> dict[int, tuple[int, int]]:
    """Return base and exponent of each value that is a product of equal factors."""
    found: dict[int, tuple[int, int]] = {}
    for k, (op, args, _) in enumerate(program.instructions):
        if op == "mul":
            (x, n), (y, m) = (found.get(a, (a, 1)) for a in args)
            if x == y:
                found[k] = (x, n + m)
    return found


def _guards(program: Program, when: Sequence[int]) -> list[Watch]:
    """Return the operations with a scale of their own whose argument moves, each once."""
    powers, found = _powers(program), []
    inner = {a for k in powers for a in program.instructions[k].args if a in powers}
    for k, (op, args, _) in enumerate(program.instructions):
        if when[k] == FIXED:
            continue
        if op == "div" and args[1] in powers:
            base, n = powers[args[1]]
            found.append(Watch("pow", (base, Fraction(-n))))
        elif op == "div":
            found.append(Watch(op, (Fraction(1), args[1])))
        elif op in _ALGEBRAIC | _ENTIRE:
            found.append(Watch(op, args))
        elif k in powers and k not in inner and powers[k][1] >= _POWER_FROM:
            found.append(Watch("pow", (powers[k][0], Fraction(powers[k][1]))))
    return [w for w in dict.fromkeys(found) if _latest(w, when) > FIXED]


def _may_hide(watch: Watch, program: Program) -> bool:
    """Return whether an operation has a scale beside the radian (see the head of this module)."""
    if watch.op in _ENTIRE or (watch.op == "pow" and _degree(watch) >= _POWER_FROM):
        return True
    own = [a for k in watch.moving if isinstance(a := watch.args[k], int)]
    by_angle = set(own)
    for k in range(max(own), -1, -1):
        op, args, _ = program.instructions[k]
        if k in by_angle and op == "state":
            return True
        if k in by_angle and op not in {"sin", "cos"}:
            by_angle.update(args)
    return False


def _degree(watch: Watch) -> Fraction:
    exponent = watch.args[1]
    return exponent if isinstance(exponent, Fraction) else Fraction(0)


_DIFFERENCES = frozenset({"min", "max", "lt", "le"})


def _pieces(b: Builder, program: Program) -> list[Watch]:
    """Return the values whose piece must not change within a step; differences are added to ``b``."""
    found = []
    for op, args, value in program.instructions:
        if op in {"abs", "sign"}:
            found.append(Watch("sign", (args[0],)))
        elif op in _DIFFERENCES:
            found.append(Watch("sign", (b.add("sub", *args),)))
        elif op == "floor":
            found.append(Watch("floor", (args[0],)))
        elif op == "mod":
            found.append(Watch("floor", (b.add("div", *args),)))
        elif isinstance(value, Table):
            found.append(Watch("table", args, value))
    return list(dict.fromkeys(found))


# --- time alone -----------------------------------------------------------------------------------


def _ahead(program: Program, timed: Sequence[Watch]) -> tuple[Program | None, list[Watch]]:
    """Return the program that says of two times whether anything of time alone changes between.

    With it what has no bounds ahead, and is watched at the stages like what states enter.
    """
    b = Builder(program.rules)
    now, low, high, depth = scalars.scalars(b, "state", 4)
    wanted = sorted(needed(replace(program, results={AHEAD: _numbers(timed)}), [AHEAD]))
    at_now = bounds(program, b, lambda i: _leaf(b, i, Interval(now, now)), wanted)
    over = bounds(program, b, lambda i: _leaf(b, i, Interval(low, high)), wanted)
    found = {False: scalars.constant(b, 1), True: scalars.constant(b, 1)}
    unbounded = []
    for w in timed:
        first = [i for a in w.args if (i := _interval(b, at_now, a))]
        spread = [i for a in w.args if (i := _interval(b, over, a))]
        if len(first) < len(w.args) or len(spread) < len(w.args):
            unbounded.append(w)
            continue
        holds = (
            _same(w, spread[0])
            if w.is_piece
            else _share(w, [i.low for i in first], spread, depth) >= 1
        )
        found[w.is_piece] = apply("and", found[w.is_piece], holds)
    if len(unbounded) == len(timed):
        return None, unbounded
    return prune(scalars.program(b, {AHEAD: [found[False], found[True]]})), unbounded


def _numbers(watched: Sequence[Watch]) -> tuple[int, ...]:
    return tuple(a for w in watched for a in w.args if isinstance(a, int))


def _leaf(b: Builder, instruction: Instruction, time: Interval) -> Interval | None:
    if instruction.op == "time":
        return time
    if instruction.op == "state":
        return None
    value = Scalar(b, b.leaf(instruction.op, instruction.value))
    return Interval(value, value)


def _interval(b: Builder, known: dict[int, Interval | None], a: Argument) -> Interval | None:
    if isinstance(a, Fraction):
        value = scalars.constant(b, a)
        return Interval(value, value)
    return known[a]


# --- any values over a box ------------------------------------------------------------------------


@dataclass(frozen=True)
class Steady:
    """Whether values keep their character over a box, as a program; None where all are polynomials.

    Slots of state are the least and the largest of each of the ``n`` states in turn, then of time. The
    result, of the group `VERDICT`: whether each operation's argument moves by its reach at most about the
    middle. ``unbounded``: those of the values, by place, in which something has no bounds.
    """

    program: Program | None
    unbounded: tuple[int, ...] = ()


def steady(program: Program, values: Sequence[int], n: int, order: int, depth: int) -> Steady:
    """Return what says whether ``values`` of a program vary as a polynomial of an order may show."""
    whole = prune(replace(program, results={VERDICT: tuple(values)}))
    when = _when(whole, moving_inputs=False)
    b = Builder(program.rules)
    found = bounds(whole, b, lambda i: _in_box(b, i, n), range(len(whole.instructions)))
    holds, open_ones = scalars.constant(b, 1), set()
    for w, place in _all_guards(whole, when):
        over = [i for a in w.args if (i := _interval(b, found, a))]
        if len(over) < len(w.args):
            open_ones.add(place)
            continue
        middle = [(i.low + i.high) / 2 for i in over]
        share = _share(w, middle, over, scalars.constant(b, depth), order)
        holds = apply("and", holds, share >= 1)
    open_ones.update(k for k, i in enumerate(whole.instructions) if _is_blind(i, when, k))
    unbounded = [m for m, k in enumerate(whole.results[VERDICT]) if _reads(whole, k) & open_ones]
    if holds == 1:
        return Steady(None, tuple(unbounded))
    return Steady(prune(scalars.program(b, {VERDICT: [holds]})), tuple(unbounded))


def _in_box(b: Builder, instruction: Instruction, n: int) -> Interval:
    op, _, value = instruction
    if op in {"state", "time"}:
        k = value if isinstance(value, int) and op == "state" else n
        return Interval(*(Scalar(b, b.leaf("state", 2 * k + end)) for end in (0, 1)))
    leaf = Scalar(b, b.leaf(op, value))
    return Interval(leaf, leaf)


def _all_guards(program: Program, when: Sequence[int]) -> list[tuple[Watch, int]]:
    """Return every operation that may hide something and whose argument moves, and its place."""
    powers, found = _powers(program), []
    inner = {a for k in powers for a in program.instructions[k].args if a in powers}
    for k, (op, args, _) in enumerate(program.instructions):
        if op == "div":
            found.append((Watch(op, (Fraction(1), args[1])), k))
        elif op in trust.ROWS and not _shows(program, k):
            exponent = program.instructions[args[-1]].value if op == "pow" else None
            known = (args[0], exponent) if isinstance(exponent, Fraction) else args
            found.append((Watch(op, known), k))
        elif k in powers and k not in inner and powers[k][1] >= _POWER_FROM:
            found.append((Watch("pow", (powers[k][0], Fraction(powers[k][1]))), k))
    return [(w, k) for w, k in found if _latest(w, when) > FIXED]


_SHOWN = frozenset({"sqrt", "hypot", "asin", "acos", "acosh"})
"""Functions whose kinks show at every place."""


def _shows(program: Program, k: int) -> bool:
    """Whether an operation hides nothing: roots, and low powers, have no scale of their own."""
    op, args, _ = program.instructions[k]
    exponent = program.instructions[args[-1]].value
    low = isinstance(exponent, Fraction) and 0 < exponent < _POWER_FROM
    return op in _SHOWN or (op == "pow" and low)


def _is_blind(instruction: Instruction, when: Sequence[int], k: int) -> bool:
    """Whether an operation that moves is no polynomial and has no reach."""
    op = instruction.op
    return when[k] > FIXED and op in OPS and op not in {*trust.ROWS, *trust.POLYNOMIALS}


def _reads(program: Program, result: int) -> set[int]:
    """Return the values that one is made of."""
    found = {result}
    for k in range(result, -1, -1):
        if k in found:
            found.update(program.instructions[k].args)
    return found


# --- laws of one operation ------------------------------------------------------------------------


def _share(
    watch: Watch,
    now: Sequence[Scalar],
    over: Sequence[Interval],
    depth: Scalar,
    order: int = ORDER,
) -> Scalar:
    """Return the share of a movement that an operation allows, 1 or more where it allows all of it.

    It does where the argument moves by its reach at most, and where the function is flat all the way.
    """
    now, over = [_finite(x) for x in now], [Interval(_finite(i.low), _finite(i.high)) for i in over]
    moves = [_movement(watch, now, over[k], k) for k in watch.moving]
    allowed, least = (
        trust.moved(watch.op, now, order, depth),
        trust.ROWS[watch.op].reach(now, order),
    )
    movement = sum(moves[1:], start=moves[0])
    share = where(movement <= least, 1, minimum(allowed / movement, Fraction(15, 16)))
    quiet = _QUIET.get(watch.op, trust.ROWS[watch.op].quiet)
    if quiet is None:
        return share
    ends = [[*now], [*now]]
    for k in watch.moving:
        ends[0][k], ends[1][k] = over[k].low, over[k].high
    flat = apply("and", quiet(ends[0], depth) >= 0, quiet(ends[1], depth) >= 0)
    if not _is_one_sided(watch):
        same = over[0].low * over[0].high > 0
        small = (
            now[1] >= 1 if watch.op == "pow" else None
        )  # a whole power that is small is so through zero
        flat = apply("and", flat, same if small is None else apply("or", same, small))
    return where(flat, 1, share)


def _finite(x: Scalar) -> Scalar:
    """Return a value without infinities: what overflows is far from whatever it moves to."""
    return maximum(minimum(x, _LARGEST), -_LARGEST)


def _movement(watch: Watch, now: Sequence[Scalar], over: Interval, k: int) -> Scalar:
    """Return how far an argument moves to where its function grows; away from there it hides nothing."""
    x = now[k]
    up: Scalar = over.high - x
    down: Scalar = x - over.low
    if watch.op in _GROW_UPWARDS:
        return up
    if watch.op == "log1p":
        return down
    if watch.op in {"sinh", "cosh"}:
        outwards: Scalar = maximum(abs(over.low), abs(over.high)) - abs(x)
        return outwards
    to_zero = where(x < 0, up, down)
    if watch.op in _POLES:
        return to_zero
    both = maximum(up, down)
    return where(now[1] < 0, to_zero, both) if watch.op == "pow" else both


def _quotient_quiet(a: Sequence[Scalar], depth: Scalar) -> Scalar:
    """A quotient is nothing where its divisor is large."""
    far: Scalar = abs(a[1]) - abs(a[0]) * scalars.exp(depth)
    return far


def _power_quiet(a: Sequence[Scalar], depth: Scalar) -> Scalar:
    """A negative power is nothing far from zero; others as in `reach`."""
    x, y = a
    positive = trust.ROWS["pow"].quiet
    assert positive is not None
    far = abs(x) - scalars.exp(depth / maximum(-y, Fraction(1, 8)))
    return where(y < 0, far, positive(a, depth))


_QUIET: Mapping[str, trust.Quiet] = {"div": _quotient_quiet, "pow": _power_quiet}
"""Where quotients and negative powers are flat, which is of use over a whole step alone."""


def _is_one_sided(watch: Watch) -> bool:
    """Whether a function that is flat at two places is flat between them, also across zero."""
    return watch.op in {"exp", "expm1"} or (watch.op == "pow" and _degree(watch) > 0)


def _same(watch: Watch, over: Interval) -> Scalar:
    """Return whether a value stays on one piece between its bounds."""
    if watch.op == "sign":
        return scalars.equal(over.low < 0, over.high < 0)
    if watch.op == "floor":
        return scalars.equal(apply("floor", over.low), apply("floor", over.high))
    assert watch.table is not None
    return scalars.equal(*(number_of_piece(watch.table, x) for x in (over.low, over.high)))


# --- what states enter ----------------------------------------------------------------------------


def _of_states(
    program: Program, ahead: Program | None, guards: Sequence[Watch], pieces: Sequence[Watch]
) -> Narrow:
    own, other = _numbers(guards), _numbers(pieces)
    rates = program.results[RATES]
    watched = prune(replace(program, results={WATCHED: (*rates, *own, *other)}))
    b = Builder(program.rules)
    columns = len(own) + len(other)
    *slots, depth = scalars.scalars(b, "state", 3 * columns + 1)
    places = iter(zip(slots[::3], slots[1::3], slots[2::3], strict=True))
    shares = []
    for w in guards:
        now, over = [], []
        for a in w.args:
            if isinstance(a, Fraction):
                value = scalars.constant(b, a)
                x, low, high = value, value, value
            else:
                x, low, high = next(places)
            now.append(x)
            over.append(Interval(low, high))
        shares.append(_share(w, now, over, depth))
    stays = []
    for w in pieces:
        _, low, high = next(places)
        stays.append(_same(w, Interval(low, high)))
    verdict = scalars.program(b, {VERDICT: [*shares, *stays]})
    each = [w for w in guards for a in w.args if isinstance(a, int)]
    soon, to_zero = tuple(map(_soon, each)), tuple(map(_to_zero, each))
    return Narrow(
        ahead, watched, verdict, columns, len(guards), len(pieces), len(own), soon, to_zero
    )


SOON: Mapping[str, tuple[float, float]] = {
    "div": (float(trust.SHARE), 0.0),
    "log": (float(trust.SHARE), 0.0),
    "exp": (0.0, ORDER / 2),
    "expm1": (0.0, ORDER / 2),
    "sinh": (0.0, ORDER / 2),
    "cosh": (0.0, ORDER / 2),
    "tanh": (0.0, 0.78),
    "atan": (0.0, float(trust.SHARE)),
    "asinh": (0.0, float(trust.SHARE)),
}
"""Lower bounds of the reach of operations, as a share of the argument, and as a number: most steps pass by
these alone. Others, here, have none."""


def _soon(watch: Watch) -> tuple[float, float]:
    exponent = watch.args[-1]
    if watch.op == "pow" and isinstance(exponent, Fraction):
        return trust.reach_of("pow", [1.0, float(exponent)], ORDER) * 0.99, 0.0
    return SOON.get(watch.op, (0.0, 0.0))


def _to_zero(watch: Watch) -> bool:
    """Return whether an operation counts what moves towards zero alone (see `_movement`)."""
    return watch.op in _POLES or (watch.op == "pow" and _degree(watch) < 0)


assert {*_ALGEBRAIC, *_ENTIRE} <= {*OPS}
