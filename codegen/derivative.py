"""Jacobians by differentiating a program: from instructions to instructions, sparse, value shared.

Forward accumulation: every value carries its derivatives with respect to the slots that it depends
on, as numbers of further instructions (Griewank and Walther, Evaluating Derivatives, 2nd ed., ch. 3
and 7). What is zero is never formed, equal values are one, and folding removes factors of one, so that
derivative and value share all they can. Where an operation has no derivative, at zero of a root, of a
norm or of atan2, at the ends of asin, it counts as zero, so that nothing but the mathematics at hand
can make a derivative infinite.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from codegen import fold, stumpff
from codegen.ops import OPS
from codegen.passes import needed, prune
from codegen.program import Builder, Program
from eom.errors import InputError
from eom.tables import Table

JACOBIAN = "jacobian"
Tangent = dict[int, int]
"""Numbers of the derivatives that are not zero, by slot."""
Partial = Callable[[Builder, int, Sequence[int]], tuple[int | None, ...]]
"""From the numbers of value and arguments to those of the partial derivatives; None is zero."""


@dataclass(frozen=True)
class Jacobian:
    """A program with the results of a group and the entries of their Jacobian that are not zero.

    ``pattern``: (row, column) of each entry, by rows: result and slot.
    """

    program: Program
    pattern: tuple[tuple[int, int], ...]


def jacobian(program: Program, group: str, kind: str = "state") -> Jacobian:
    """Differentiate the results ``group`` with respect to all slots of ``kind``.

    ``kind``: state, parameter, input or time. Law: the entries are the derivatives of the results
    in exact arithmetic, wherever these exist; the results themselves do not change.
    """
    b = Builder(program.rules)
    copied: dict[int, int] = {}
    tangents: dict[int, Tangent] = {}
    for k in sorted(needed(program, [group])):
        op, args, value = program.instructions[k]
        if op not in OPS:
            copied[k] = b.leaf(op, value)
            slot = value if isinstance(value, int) else 0
            tangents[k] = {slot: b.const(1)} if op == kind else {}
            continue
        copied[k] = b.add(op, *(copied[a] for a in args), value=value)
        tangents[k] = _tangent(b, op, copied[k], args, copied, tangents)
    for k, name in program.names.items():
        if k in copied:
            b.name(copied[k], name)
    rows = program.results[group]
    entries = {
        (row, slot): number
        for row, k in enumerate(rows)
        for slot, number in sorted(tangents[k].items())
    }
    whole = b.program({group: [copied[k] for k in rows], JACOBIAN: list(entries.values())})
    return Jacobian(prune(whole), tuple(entries))


def _tangent(
    b: Builder,
    op: str,
    value: int,
    args: Sequence[int],
    copied: dict[int, int],
    tangents: dict[int, Tangent],
) -> Tangent:
    """Return the chain rule's sum over the arguments that vary.

    Selections, min and max select among the derivatives: one that is not finite on the side that is
    not taken leaves no trace, as it would if it were multiplied by zero.
    """
    if op == "select":
        condition, yes, no = args
        return _selected(b, copied[condition], tangents[yes], tangents[no])
    varying = [k for k, a in enumerate(args) if tangents[a]]
    if not varying:
        return {}
    partials = PARTIALS[op](b, value, [copied[a] for a in args])
    if op in {"min", "max"} and partials[0] is not None:
        return _selected(b, partials[0], tangents[args[0]], tangents[args[1]])
    found: Tangent = {}
    for k in varying:
        partial = partials[k]
        if partial is None:
            continue
        for slot, rate in tangents[args[k]].items():
            term = b.add("mul", partial, rate)
            found[slot] = b.add("add", found[slot], term) if slot in found else term
    return {slot: number for slot, number in found.items() if not _is_zero(b, number)}


def _selected(b: Builder, condition: int, yes: Tangent, no: Tangent) -> Tangent:
    zero = b.const(0)
    found = {
        slot: b.add("select", condition, yes.get(slot, zero), no.get(slot, zero))
        for slot in sorted({*yes, *no})
    }
    return {slot: number for slot, number in found.items() if not _is_zero(b, number)}


def _is_zero(b: Builder, number: int) -> bool:
    instruction = b.instructions[number]
    return instruction.op == "const" and instruction.value == 0


def _one(b: Builder, _: int, args: Sequence[int]) -> tuple[int | None, ...]:
    return (b.const(1),) * len(args)


def _flat(_: Builder, __: int, args: Sequence[int]) -> tuple[int | None, ...]:
    return (None,) * len(args)


def _unary(rule: Callable[[Builder, int, int], int]) -> Partial:
    return lambda b, v, args: (rule(b, v, args[0]),)


def _square(b: Builder, x: int) -> int:
    return b.add("mul", x, x)


def _over(b: Builder, divisor: int, numerator: int = 1) -> int:
    return b.add("div", b.const(numerator), divisor)


def _unless_zero(b: Builder, test: int, value: int) -> int:
    """Return ``value``, or zero where ``test`` is zero."""
    return b.add("select", b.add("eq", test, b.const(0)), b.const(0), value)


def _div(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    return (_over(b, args[1]), b.add("neg", b.add("div", v, args[1])))


def _sqrt(b: Builder, v: int, _: int) -> int:
    return _unless_zero(b, v, b.add("div", b.const(1), b.add("mul", b.const(2), v)))


def _pow(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    """Y x^(y - 1) for a base that is zero, too; the exponent's derivative where the base is positive."""
    x, y = args
    lower = b.add("pow", x, b.add("sub", y, b.const(1)))
    positive = b.add("lt", b.const(0), x)
    growth = b.add("select", positive, b.add("mul", v, b.add("log", x)), b.const(0))
    return (b.add("mul", y, lower), growth)


def _atan2(b: Builder, _: int, args: Sequence[int]) -> tuple[int | None, ...]:
    y, x = args
    square = b.add("add", _square(b, x), _square(b, y))
    return tuple(
        _unless_zero(b, square, b.add("div", part, square)) for part in (x, b.add("neg", y))
    )


def _arc(b: Builder, x: int) -> int:
    """1 / sqrt(1 - x^2), zero at the ends."""
    root = b.add("sqrt", b.add("sub", b.const(1), _square(b, x)))
    return _unless_zero(b, root, _over(b, root))


def _acosh(b: Builder, _: int, x: int) -> int:
    below, above = b.add("sub", x, b.const(1)), b.add("add", x, b.const(1))
    root = b.add("mul", b.add("sqrt", below), b.add("sqrt", above))
    return _unless_zero(b, root, _over(b, root))


def _smaller(first: str, b: Builder, args: Sequence[int]) -> tuple[int | None, ...]:
    x, y = args if first == "min" else args[::-1]
    chosen = b.add("le", x, y)
    return (chosen, b.add("not", chosen))


def _mod(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    """1 and -floor(a/b), where a/b may have been rounded to a whole number: (a - v)/b is close to one."""
    quotient = b.add("div", b.add("sub", args[0], v), args[1])
    whole = b.add("floor", b.add("add", quotient, b.const(Fraction(1, 2))))
    return (b.const(1), b.add("neg", whole))


def _hypot(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    return tuple(_unless_zero(b, v, b.add("div", a, v)) for a in args)


def _gauss(b: Builder, x: int) -> int:
    """2 exp(-x^2) / sqrt(pi)."""
    factor = b.add("div", b.const(2), b.add("sqrt", b.leaf("pi")))
    return b.add("mul", factor, b.add("exp", b.add("neg", _square(b, x))))


def _bessel(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    """(C_{n-1} - C_{n+1})/2, and -C_1 for n = 0 (DLMF 10.6.1)."""
    kind = b.instructions[v].op
    n, x = fold.constant(b, args[0]), args[1]
    assert n is not None
    after = b.add(kind, b.const(n + 1), x)
    if n == 0:
        return (None, b.add("neg", after))
    difference = b.add("sub", b.add(kind, b.const(n - 1), x), after)
    return (None, b.add("mul", b.const(Fraction(1, 2)), difference))


def _stumpff(b: Builder, _: int, args: Sequence[int]) -> tuple[int | None, ...]:
    """(k c_{k+2} - c_{k+1})/2. Raises `InputError` beyond the largest k that is tabulated."""
    k, z = fold.constant(b, args[0]), args[1]
    assert k is not None
    if k + 2 > stumpff.LARGEST:
        raise InputError("derivative of too high an order", got=f"Stumpff function c_{k + 2}",
                         expected=f"up to c_{stumpff.LARGEST}")  # fmt: skip
    second = b.add("mul", args[0], b.add("stumpff", b.const(k + 2), z))
    difference = b.add("sub", second, b.add("stumpff", b.const(k + 1), z))
    return (None, b.add("mul", b.const(Fraction(1, 2)), difference))


def _table(b: Builder, v: int, args: Sequence[int]) -> tuple[int | None, ...]:
    table = b.instructions[v].value
    assert isinstance(table, Table)
    derived = table.derivative
    return (b.add("table", args[0], value=derived) if derived.degree >= 0 else None,)


PARTIALS: dict[str, Partial] = {
    "add": _one,
    "sub": lambda b, v, args: (b.const(1), b.const(-1)),
    "mul": lambda b, v, args: (args[1], args[0]),
    "div": _div,
    "neg": lambda b, v, args: (b.const(-1),),
    "sqrt": _unary(_sqrt),
    "pow": _pow,
    "sin": _unary(lambda b, v, x: b.add("cos", x)),
    "cos": _unary(lambda b, v, x: b.add("neg", b.add("sin", x))),
    "tan": _unary(lambda b, v, x: b.add("add", b.const(1), _square(b, v))),
    "asin": _unary(lambda b, v, x: _arc(b, x)),
    "acos": _unary(lambda b, v, x: b.add("neg", _arc(b, x))),
    "atan": _unary(lambda b, v, x: _over(b, b.add("add", b.const(1), _square(b, x)))),
    "sinh": _unary(lambda b, v, x: b.add("cosh", x)),
    "cosh": _unary(lambda b, v, x: b.add("sinh", x)),
    "tanh": _unary(lambda b, v, x: b.add("sub", b.const(1), _square(b, v))),
    "asinh": _unary(
        lambda b, v, x: _over(b, b.add("sqrt", b.add("add", b.const(1), _square(b, x))))
    ),
    "acosh": _unary(_acosh),
    "atanh": _unary(lambda b, v, x: _over(b, b.add("sub", b.const(1), _square(b, x)))),
    "exp": _unary(lambda b, v, x: v),
    "log": _unary(lambda b, v, x: _over(b, x)),
    "atan2": _atan2,
    "abs": _unary(lambda b, v, x: b.add("sign", x)),
    "sign": _flat,
    "min": lambda b, v, args: _smaller("min", b, args),
    "max": lambda b, v, args: _smaller("max", b, args),
    **dict.fromkeys(("lt", "le", "eq", "and", "or", "not"), _flat),
    "floor": _flat,
    "mod": _mod,
    "hypot": _hypot,
    "erf": _unary(lambda b, v, x: _gauss(b, x)),
    "erfc": _unary(lambda b, v, x: b.add("neg", _gauss(b, x))),
    "expm1": _unary(lambda b, v, x: b.add("exp", x)),
    "log1p": _unary(lambda b, v, x: _over(b, b.add("add", b.const(1), x))),
    "besselj": _bessel,
    "bessely": _bessel,
    "stumpff": _stumpff,
    "table": _table,
    "select": lambda b, v, args: (
        None,
        b.add("not", b.add("eq", args[0], b.const(0))),
        b.add("eq", args[0], b.const(0)),
    ),
}
"""How each operation is differentiated, by further operations."""


def columns(pattern: Iterable[tuple[int, int]]) -> dict[int, frozenset[int]]:
    """Return the rows in which each column has an entry."""
    found: dict[int, set[int]] = {}
    for row, column in pattern:
        found.setdefault(column, set()).add(row)
    return {c: frozenset(rows) for c, rows in sorted(found.items())}


def colouring(pattern: Iterable[tuple[int, int]]) -> dict[int, int]:
    """Return a colour for each column so that columns of one colour share no row.

    As many directional derivatives as there are colours give the whole matrix (Curtis, Powell and
    Reid, 1974). Greedy, the fullest columns first; ties by number.
    """
    rows = columns(pattern)
    colours: dict[int, int] = {}
    taken: list[set[int]] = []
    for c in sorted(rows, key=lambda c: (-len(rows[c]), c)):
        free = next((k for k, used in enumerate(taken) if not used & rows[c]), len(taken))
        if free == len(taken):
            taken.append(set())
        taken[free] |= rows[c]
        colours[c] = free
    return dict(sorted(colours.items()))
