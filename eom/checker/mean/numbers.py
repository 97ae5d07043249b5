"""Numbers with units: what a formula of numbers amounts to in SI, and how far it may be rounded."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import sympy as sp

from eom.checker.mean.dimensions import NONE, UNITS, Dimension
from eom.checker.mean.values import Value
from eom.checker.read.symbol_shape import Look, Seen, grown, seen
from eom.checker.read.syntax import (
    Addition,
    Call,
    Fraction,
    Group,
    Marks,
    Node,
    Number,
    Product,
    Quotient,
    Root,
    Scripts,
    Symbol,
)
from eom.terms.terms import expr, table
from eom.units import read

Expr = Any

MAX_DIGITS, MAX_BITS = 40, 2000
TURN = sp.Symbol("turn", positive=True)
"""How much a turn counts: 2 pi for what is in radians, one for what is in numbers of turns."""
RADIANS, TURNS = 2 * sp.pi, sp.Integer(1)
TURNED = {"rad": RADIANS, "deg": RADIANS, "Hz": TURNS, "1": TURNS}
"""How much a turn counts for a quantity by what its unit in the lexicon begins with."""

MULTIPLES = ("n", "µ", "m", "c", "k", "M", "G")
"""The prefixes that units in notes may have."""

_NAMES = (
    *(m + unit for unit in ("m", "s", "N", "J", "W", "Pa", "Hz", "rad") for m in MULTIPLES),
    *"g mg min h day days Wh kWh MWh".split(),
)
SCALES: dict[str, tuple[Expr, str]] = {
    **{name: (read(name).factor, read(name).text) for name in _NAMES},
    "deg": (sp.pi / 180, "rad"),
    "rev": (TURN, "rad"),
    "rpm": (TURN / 60, "Hz"),
}
"""Units that are no units of SI: how many of which; turns are counted as `TURN` says."""

MICRO = "µ"
"""The prefix that is written by a letter of its own."""

NAME = re.compile("|".join(sorted({*UNITS, *SCALES}, key=len, reverse=True)))


@dataclass(frozen=True)
class Measure:
    """A number in units of SI, and its dimension if units are said."""

    value: Expr
    unit: Dimension | None = None


Known = Callable[[Look], Expr | None]


def key(look: Look, dots: int = 0) -> Look:
    """Return by what a note's definitions know the number that a symbol was given."""
    return replace(look, accents=(*look.accents, *("dot",) * dots, "number"))


Used = tuple[tuple[Look, Expr], ...]
"""Numbers that were recalled, with their values."""


@dataclass(frozen=True)
class Kept(Value):
    """A number and how far it may be rounded; ``used``: what it was worked out from."""

    used: Used = ()


def kept(look: Look, dots: int, value: Expr, off: Expr, used: Used = ()) -> Mapping[Look, Value]:
    """Return the definition of a number."""
    term = table([[expr(value)], [expr(off)]])
    return {key(look, dots): Kept(term, term.kind, NONE, used=used)}


# -- values --------------------------------------------------------------------------------------------


def measured(node: Node, known: Known) -> Measure | None:
    """Return the number that a formula amounts to; None where it holds anything without one."""
    if isinstance(node, Number):
        return Measure(sp.Rational(node.text)) if len(node.text) <= MAX_DIGITS else None
    if isinstance(node, Product):
        return _product(node, known)
    if isinstance(node, Group) and node.open in {"", "(", "["}:
        return measured(node.body, known)
    rule = next((r for kind, r in _RULES.items() if isinstance(node, kind)), None)
    found = rule(node, known) if rule is not None else None
    return _recalled(node, known) if found is None else found


def number_only(node: Node) -> bool:
    """Return whether a formula holds numbers alone."""
    return measured(node, lambda _: None) is not None


def primed(node: Node) -> Seen | None:
    """Return the symbol that a node is, with its primes as a label."""
    found = seen(node)
    label = found.with_label() if found is not None else None
    if found is None or label is None or set(label.sup) != {"prime"}:
        return found
    return replace(found, look=label, raised=found.raised[1:])


def _recalled(node: Node, known: Known) -> Measure | None:
    found = primed(node)
    if found is None or found.raised:
        return None
    value = known(key(found.look, found.dots))
    return (
        Measure(sp.pi) if value is None and found.look == Look("pi") else value and Measure(value)
    )


def _each(nodes: tuple[Node, ...], known: Known) -> list[Measure] | None:
    found = [measured(n, known) for n in nodes]
    return None if None in found else [f for f in found if f is not None]


def _product(node: Product, known: Known) -> Measure | None:
    if node.operator not in {"", "dot", "cross", "asterisk"}:
        return None
    changed = [seen(f) for f in node.factors]
    if len(changed) == 2 and changed[0] == Seen(Look("Delta")) and changed[1] is not None:
        value = known(key(grown(changed[1]), changed[1].dots))
        return None if value is None else Measure(value)
    count = len(node.factors)
    while count > 1 and _isunit_of(node.factors[count - 1], last=count == len(node.factors)):
        count -= 1
    inside = _each(node.factors[:count], known)
    if inside is None:
        return None
    said = unit_of(node.factors[count:]) if count < len(node.factors) else (sp.Integer(1), None)
    if said is None:
        return None
    scale, unit = said
    value = sp.Mul(*(m.value for m in inside)) * scale
    units = [m.unit for m in inside if m.unit is not None] + ([unit] if unit is not None else [])
    total = None if not units else NONE
    for one in units:
        total = one if total is None else total.times(one)
    return Measure(value, total)


def _isunit_of(factor: Node, last: bool) -> bool:
    """Tell whether a factor may be of a unit; a mu is so before others alone."""
    found = list(_letters(factor, 1))
    return None not in found and not (last and found[-1] is not None and found[-1][0].name == MICRO)


def _sum(node: Addition, known: Known) -> Measure | None:
    inside = _each(node.terms, known)
    if inside is None or set(node.signs) - {"", "+", "-"}:
        return None
    signed = (-m.value if s == "-" else m.value for s, m in zip(node.signs, inside, strict=True))
    return Measure(sp.Add(*signed), next((m.unit for m in inside if m.unit is not None), None))


def _ratio(node: Fraction | Quotient, known: Known) -> Measure | None:
    pair = (node.above, node.below) if isinstance(node, Fraction) else (node.left, node.right)
    if isinstance(node, Quotient) and (below := unit_of((pair[1],))) is not None:
        above = measured(pair[0], known)
        if above is not None and (above.unit is not None or number_only(pair[0])):
            per = (above.unit or NONE).times(below[1].power(-1))
            return Measure(above.value / below[0], per)
    inside = _each(pair, known)
    if inside is None or inside[1].value == 0:
        return None
    above_unit, below_unit = (m.unit for m in inside)
    known_units = above_unit is not None or below_unit is not None
    unit = (above_unit or NONE).times((below_unit or NONE).power(-1)) if known_units else None
    return Measure(inside[0].value / inside[1].value, unit)


def _power(node: Scripts, known: Known) -> Measure | None:
    if node.sup is None:
        return None
    plain = node.sub is node.presub is node.presup is None
    base = measured(node.base if plain else replace(node, sup=None), known)
    if base is None:
        return None
    if isinstance(node.sup, Marks):
        return Measure(base.value * sp.pi / 180, NONE) if node.sup.names == ("circ",) else None
    exponent = measured(node.sup, known)
    if exponent is None or not exponent.value.is_Rational or _is_large(base.value, exponent.value):
        return None
    unit = None if base.unit is None else base.unit.power(exponent.value)
    return Measure(base.value**exponent.value, unit)


def _is_large(base: Expr, exponent: Expr) -> bool:
    """Return whether a power would take many digits."""
    bits = max((max(abs(n.p), n.q).bit_length() for n in base.atoms(sp.Rational)), default=1)
    return bool(bits * max(abs(exponent.p), exponent.q) > MAX_BITS or base.count_ops() > MAX_BITS)


def _root(node: Root, known: Known) -> Measure | None:
    inside = measured(node.body, known) if node.degree is None else None
    return None if inside is None else Measure(sp.sqrt(inside.value))


_INVERSES = {
    **dict.fromkeys(("arcsin", "asin"), sp.asin),
    **dict.fromkeys(("arccos", "acos"), sp.acos),
    **dict.fromkeys(("arctan", "atan"), sp.atan),
}
_FUNCTIONS = {
    **{
        name: getattr(sp, name)
        for name in ("sin", "cos", "tan", "cot", "sinh", "cosh", "tanh", "exp")
    },
    **_INVERSES,
    "ln": sp.log,
}


def _call(node: Call, known: Known) -> Measure | None:
    inside = measured(node.argument, known)
    function = _FUNCTIONS.get(node.function)
    power = sp.Integer(1) if node.sup is None else getattr(measured(node.sup, known), "value", None)
    if inside is None or function is None or node.sub is not None or power is None:
        return None
    if power == -1:
        inverse = _INVERSES.get("a" + node.function)
        return None if inverse is None else Measure(inverse(inside.value))
    return Measure(function(inside.value) ** power)


_RULES: dict[type, Callable[[Any, Known], Measure | None]] = {
    Addition: _sum,
    Fraction: _ratio,
    Quotient: _ratio,
    Scripts: _power,
    Root: _root,
    Call: _call,
}


# -- units ---------------------------------------------------------------------------------------------


def unit_of(nodes: tuple[Node, ...]) -> tuple[Expr, Dimension] | None:
    """Return how many units of SI factors in upright letters are, and their dimension."""
    scale, found, place = sp.Integer(1), NONE, 0
    letters = [p for n in nodes for p in _letters(n, 1)]
    if not letters or None in letters:
        return None
    while place < len(letters):
        word, power, count = _word(letters[place:])  # type: ignore[arg-type]
        if not NAME.fullmatch(word):
            return None
        times, base = SCALES.get(word, (sp.Integer(1), word))
        scale, found = scale * times**power, found.times(UNITS[base].power(power))
        place += count
    return scale, found


_APART = re.compile("kg|Hz|Pa|rad|[A-Za-z]")
"""Units that stand close together: Nms, kgm."""

Letter = tuple[Symbol, int]


def _word(letters: list[Letter]) -> tuple[str, int, int]:
    """Return the longest unit that letters without space between them begin with, and its power."""
    symbol, power = letters[0]
    word, best = symbol.name, (symbol.name, power, 1)
    for count, ((before, raised), (one, power)) in enumerate(pairwise(letters), 2):
        if raised != 1 or (before.span.stop != one.span.start and before.name != MICRO):
            break
        word += one.name
        best = (word, power, count) if NAME.fullmatch(word) else best
    return best


def _letters(node: Node, power: int) -> Iterator[Letter | None]:
    """Yield upright letters with their powers, None for anything else."""
    if isinstance(node, Symbol) and node.name == "mu":
        yield Symbol(MICRO, "roman", span=node.span), power
    elif isinstance(node, Symbol) and node.style == "roman":
        words = [node.name] if NAME.fullmatch(node.name) else _APART.findall(node.name)
        *before, last = words if "".join(words) == node.name else [node.name]
        yield from ((Symbol(word, "roman"), 1 if power > 0 else -1) for word in before)
        yield replace(node, name=last), power
    elif isinstance(node, Group) and node.open in {"", "("}:
        yield from _letters(node.body, power)
    elif isinstance(node, Product) and node.operator in {"", "dot"}:
        yield from (p for f in node.factors for p in _letters(f, power))
    elif isinstance(node, Quotient | Fraction):
        pair = (node.above, node.below) if isinstance(node, Fraction) else (node.left, node.right)
        yield from _letters(pair[0], power)
        yield from _letters(pair[1], -power)
    elif isinstance(node, Scripts) and node.sub is None and node.sup is not None:
        exponent = measured(node.sup, lambda _: None)
        whole = exponent is not None and exponent.value.is_Integer
        yield from (
            _letters(node.base, power * int(exponent.value)) if exponent and whole else [None]
        )
    else:
        yield None


def last_digit(node: Node) -> Expr | None:
    """Return half a unit of the last digit of a number that is written out; None for what is computed."""
    if isinstance(node, Group) and node.open in {"", "("}:
        return last_digit(node.body)
    if isinstance(node, Number):
        return sp.Rational(1, 2) / 10 ** len(node.text.partition(".")[2])
    if isinstance(node, Addition) and len(node.terms) == 1:
        return last_digit(node.terms[0])
    if isinstance(node, Quotient):
        return last_digit(node.left)
    if isinstance(node, Scripts) and node.sup == Marks(("circ",)):
        half = last_digit(node.base)
        return None if half is None else half * sp.pi / 180
    if isinstance(node, Product) and isinstance(node.factors[0], Number):
        rest = replace(node, factors=(Number("1", span=node.span), *node.factors[1:]))
        scale = measured(rest, lambda _: None)
        powers = all(
            not isinstance(f, Number | Fraction | Group) or unit_of((f,)) for f in node.factors[1:]
        )
        half = last_digit(node.factors[0])
        return half * scale.value if scale is not None and half is not None and powers else None
    return None


def is_number(node: Node) -> bool:
    """Return whether a node is made of numbers alone, with units or degrees."""
    if isinstance(node, Number):
        return True
    if isinstance(node, Symbol):
        return node.name == "pi"
    if isinstance(node, Group):
        return is_number(node.body)
    if isinstance(node, Addition):
        return all(map(is_number, node.terms))
    if isinstance(node, Fraction | Quotient):
        return all(map(is_number, _both(node)))
    if isinstance(node, Product):
        return all(map(is_number, node.factors)) or number_only(node)
    if isinstance(node, Scripts) and node.sub is None:
        return is_number(node.base) and (_degrees(node.sup) or _of_numbers(node.sup))
    return False


def _both(node: Fraction | Quotient) -> tuple[Node, Node]:
    return (node.above, node.below) if isinstance(node, Fraction) else (node.left, node.right)


def _of_numbers(node: Node | None) -> bool:
    return node is not None and is_number(node)


def _degrees(node: Node | None) -> bool:
    return isinstance(node, Marks) and node.names == ("circ",)


def in_degrees(node: Node) -> bool:
    """Return whether a number is in degrees."""
    return isinstance(node, Scripts) and _degrees(node.sup)


def is_zero(node: Node) -> bool:
    """Return whether a node is the number zero."""
    return isinstance(node, Number) and float(node.text) == 0
