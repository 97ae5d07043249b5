r"""Worked examples: numbers in the place of quantities, units said or those of SI, rounded as they stand.

A number that a symbol is given is kept for the lines behind it. In a chain such as
``L = I\omega = 0.09\cdot 50 = 4.5`` every number has to be what stands before it, to half a unit of its
last digit; a decimal in the place of what is no given number is known to half a unit of its own last
digit, as 0.577 for tan 30 deg. What has no number is judged as if the numbers were not there. A number
that is wrong defines nothing: what stands before it in the chain does. A number that was worked out is
forgotten when one that it was worked out from is given anew.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import sympy as sp

from eom.checker.mean.dimensions import Dimension
from eom.checker.mean.elaborator import MAX_DEPTH, Elaborator, number
from eom.checker.mean.numbers import (
    RADIANS,
    TURN,
    TURNED,
    TURNS,
    Expr,
    Kept,
    Measure,
    Used,
    kept,
    key,
    last_digit,
    measured,
    number_only,
    primed,
    unit_of,
)
from eom.checker.mean.values import ILL_FORMED, UNDECIDED, WRONG, Finding, Refusal, Value
from eom.checker.read.grammar import read_formula
from eom.checker.read.spans import Span
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import Look
from eom.checker.read.syntax import Addition, Node, Number, Product, Symbol, transform, walk
from eom.errors import InputError

SIGNS = frozenset({"=", ":=", "=:", "equiv", "approx", "simeq"})
DIGITS, SHOWN = 30, 4
MAX_SHIFT = 4
"""Powers of ten between units of the same quantity, less than this."""
SLACK = sp.Rational(1000001, 1000000)
"""How much wider than half a digit a rounding may be."""

GIVEN_NUMBER = "a number that is given; nothing here determines it"
"""What is said of a number that nothing else gives."""
ANOTHER = "the number is another one"
"""What is said of a number that is not what stands before it."""


@dataclass(frozen=True)
class Worked:
    """What is left without numbers, a finding if a number is wrong or only given, and what is known now."""

    rest: Statement | None
    finding: Finding | None
    numbers: Mapping[Look, Value]


def worked(s: Statement, e: Elaborator) -> Worked | None:
    """Return what a statement with numbers says; None for one that is no worked example."""
    if len(s.members) < 2 or {g.name for g in s.signs} - SIGNS:
        return None
    pure = [measured(m, lambda _: None) for m in s.members]
    literal = [p is not None and p.value != 0 for p in pure]
    data = _Data(e)
    full = [measured(m, data.value) for m in s.members]
    used = tuple(data.used.items())
    if not any(literal) or not _is_example(s, pure, full, literal):
        return None
    rest = [m for m, own in zip(s.members, literal, strict=True) if not own]
    plain = tuple(replace(g, name="=") for g in s.signs[: len(rest) - 1])
    left = replace(s, members=tuple(rest), signs=plain) if len(rest) > 1 else None
    finding, compared = _judged(s, e, full, data)
    if finding is None and not compared:
        finding = Finding(UNDECIDED, GIVEN_NUMBER, s.span)
    taken = _taken(s, pure, full, finding, data)
    return Worked(left, finding, _learned(s, e, taken, used, data))


def given(s: Statement, e: Elaborator) -> Mapping[Look, Value]:
    """Return the number that a symbol is given, as it stands."""
    for symbol, other in (s.members[:2], s.members[1::-1]):
        found, value = primed(symbol), measured(other, lambda _: None)
        if found is not None and not found.raised and value is not None:
            turn = _turn(symbol, e) or TURN
            return kept(found.look, found.dots, value.value.subs(TURN, turn), sp.Integer(0))
    return {}


class _Data:
    """The numbers that a note has given; ``shifted``: one of them, moved by its rounding."""

    def __init__(self, e: Elaborator) -> None:
        self.known = e.definitions
        self.lexicon = e.lexicon
        self.open: set[Look] = set()
        self.used: dict[Look, Expr] = {}
        self.shifted: Look | None = None
        self.turn: Expr = RADIANS

    def value(self, look: Look) -> Expr | None:
        if not self.holds(look):
            return self._by_formula(look)
        value, off = (t.data[0] for t in self.known[look].term.args)
        self.used[look] = value
        return value + off if look == self.shifted else value

    def holds(self, look: Look) -> bool:
        """Return whether a number is known, and what it was worked out from was not given anew."""
        found = self.known.get(look)
        return isinstance(found, Kept) and all(
            k not in self.known or (self.holds(k) and self.known[k].term.args[0].data[0] == x)
            for k, x in found.used
        )

    def _by_formula(self, look: Look) -> Expr | None:
        """Return the number of what the lexicon says by a formula."""
        plain = replace(look, accents=tuple(a for a in look.accents if a != "number"))
        entry = self.lexicon.find(plain)
        if entry is None or entry.meaning.quantity != "equals":
            return self._by_system(look)
        if look in self.open or len(self.open) >= MAX_DEPTH:
            return None
        self.open.add(look)
        found = measured(_parsed(entry.meaning.formula), self.value)
        self.open.remove(look)
        return None if found is None else found.value

    def _by_system(self, look: Look) -> Expr | None:
        """Return the number that the note's system gives a quantity by those of its parameters alone."""
        model, name = self.lexicon.system, self._in_system(replace(look, accents=()))
        if model is None or name is None:
            return None
        given = [k for k in self.known if k.accents == ("number",) and self.holds(k)]
        named = {self._in_system(replace(k, accents=())): k for k in given}
        found = model.constant(name, look.accents.count("dot"))
        needed = {str(x): x for x in found.free_symbols} if found is not None else {}
        if found is None or not needed or not needed.keys() <= named.keys():
            return None
        return found.subs({x: self.value(named[n]) for n, x in needed.items()})

    def _in_system(self, look: Look) -> str | None:
        entry = self.lexicon.find(look)
        return entry.meaning.labels[0] if entry and entry.meaning.quantity == "system" else None

    def off(self, *nodes: Node) -> Expr:
        """Return how far formulas may be apart by roundings of given numbers, in both sides at once."""
        total = sp.Integer(0)
        for look in (k for k in self.known if "number" in k.accents):
            value, off = (t.data[0] for t in self.known[look].term.args)
            if off != 0:
                moved = [self._moved(n, look, value, value + off) for n in nodes]
                total += abs(moved[0] - sum(moved[1:]))
        return total

    def _moved(self, node: Node, look: Look, value: Expr, to: Expr) -> Expr:
        """Return what a formula changes by where a given number does, also where it is written out."""
        centre, self.shifted = measured(node, self.value), look
        other = measured(transform(node, lambda n: _exchanged(n, value, to)), self.value)
        self.shifted = None
        return other.value - centre.value if other and centre else sp.Integer(0)

    def rounding(self, node: Node) -> Expr:
        """Return how far a number that is computed may be off by decimals in it that nobody has given."""
        centre, total = measured(node, lambda _: None), sp.Integer(0)
        if centre is None or last_digit(node) is not None:
            return total
        given = [v.term.args[0].data[0] for k, v in self.known.items() if "number" in k.accents]
        for decimal in {n for n in walk(node) if isinstance(n, Number) and "." in n.text}:
            if not any(_same_digits(sp.Rational(decimal.text), g) for g in given):
                other = measured(_shifted(node, decimal), lambda _: None)
                total += abs(other.value - centre.value) if other else 0
        return total


@lru_cache(maxsize=512)
def _parsed(formula: str) -> Node:
    return read_formula(formula).tree


def _same_digits(a: Expr, b: Expr) -> bool:
    """Return whether two numbers are the same up to a power of ten, as a length in m and in cm."""
    if not (a and b.is_Rational and b):
        return False
    return any(a * p == b or a == b * p for p in (sp.Integer(10) ** n for n in range(MAX_SHIFT)))


def _exchanged(node: Node, value: Expr, to: Expr) -> Node:
    """Return another number for a decimal that has the digits of a given one."""
    if not isinstance(node, Number) or "." not in node.text:
        return node
    written = sp.Rational(node.text)
    return replace(node, text=str(written * to / value)) if _same_digits(written, value) else node


def _shifted(node: Node, decimal: Number) -> Node:
    """Return a formula with half a unit of its last digit added to a decimal."""
    wide = replace(decimal, text=f"{decimal.text}5")
    return transform(node, lambda n: wide if n == decimal else n)


def _is_example(
    s: Statement, pure: list[Measure | None], full: list[Measure | None], literal: list[bool]
) -> bool:
    """Return whether numbers are meant as values: by units, decimals, or what is known already."""
    units = any(
        p is not None and p.unit is not None and own for p, own in zip(pure, literal, strict=True)
    )
    decimals = any(
        isinstance(n, Number) and "." in n.text
        for m, own in zip(s.members, literal, strict=True)
        if own
        for n in walk(m)
    )
    recalled = any(f is not None and p is None for f, p in zip(full, pure, strict=True))
    return units or decimals or recalled or (literal.count(True) > 1 and not all(literal))


def _judged(
    s: Statement, e: Elaborator, full: list[Measure | None], data: _Data
) -> tuple[Finding | None, bool]:
    """Return what is wrong with numbers, and whether any was compared, however much a turn counts."""
    clash = _clash(s)
    if clash is not None:
        return clash, True
    found = []
    for data.turn in _turns(s, e):
        here = [f and replace(f, value=f.value.subs(TURN, data.turn)) for f in full]
        found.append(_compared(s, e, here, data))
    return next((f for f in found if f[0] is None), found[0])


def _turns(s: Statement, e: Elaborator) -> tuple[Expr, ...]:
    """Return how much a turn may count in a chain: by the units of its quantities, or both."""
    found = {_turn(m, e) for m in s.members} - {None}
    if any(n == Symbol("rad", "roman") for m in s.members for n in walk(m)):
        found.add(RADIANS)
    return tuple(sorted(found, key=str)) or (RADIANS, TURNS)


def _turn(node: Node, e: Elaborator) -> Expr | None:
    """Return how much a turn counts for a quantity, None for what is not known."""
    symbol = primed(node)
    entry = e.lexicon.find(symbol.look, e.indices) if symbol is not None else None
    if entry is None:
        return None
    if entry.meaning.quantity in {"angular_velocity", "free_angle", "turn_angle", "rotor_speed"}:
        return RADIANS
    return TURNED.get(re.split("[ /]", entry.meaning.unit)[0])


def _clash(s: Statement) -> Finding | None:
    """Return the finding that numbers with units of different dimensions are added."""
    for node in (n for m in s.members for n in walk(m) if isinstance(n, Addition)):
        units = [u for t in node.terms if (u := _said(t)) is not None]
        other = next((u for u in units if u != units[0]), None)
        if other is not None and len(units) == len(node.terms):
            return Finding(
                ILL_FORMED, "terms of different dimensions", node.span, other.words, units[0].words
            )
    return None


def _said(term: Node) -> Dimension | None:
    """Return the dimension of one number with its unit; None where factors may have left out theirs."""
    numbers = [n for n in walk(term) if isinstance(n, Number)]
    found = measured(term, lambda _: None) if len(numbers) == 1 or _raised(term) else None
    return None if found is None else found.unit


def _raised(term: Node) -> bool:
    """Tell whether a term is one number with a unit that has powers."""
    factors = term.factors if isinstance(term, Product) else ()
    return bool(factors) and isinstance(factors[0], Number) and unit_of(factors[1:]) is not None


def _compared(
    s: Statement, e: Elaborator, full: list[Measure | None], data: _Data
) -> tuple[Finding | None, bool]:
    """Return what is wrong with the first number that is, and whether any was compared."""
    compared = False
    for k, (node, here) in enumerate(zip(s.members, full, strict=True)):
        if here is None:
            continue
        unfit = _unfit(s, e, k, here)
        if unfit is not None:
            return unfit, True
        before = [(m, f) for m, f in zip(s.members[:k], full[:k], strict=True) if f is not None]
        if not before:
            continue
        compared = True
        own = last_digit(node) or sp.Integer(0)
        put = own + data.rounding(node)
        sides = ((own if number_only(m) else put, m, f) for m, f in (before[0], before[-1]))
        if not any(_near(here, off + data.off(m, node), f, m, data) for off, m, f in sides):
            return _other(node, here, before[-1][1], data.turn), True
    return None, compared


def _near(here: Measure, own: Expr, there: Measure, node: Node, data: _Data) -> bool:
    digits = last_digit(node) or 0
    allowed = (own + digits).subs(TURN, data.turn)
    apart = sp.N(abs(here.value - there.value), DIGITS)
    scale = sp.N(abs(here.value), DIGITS)
    return bool(apart <= sp.N(allowed * SLACK + scale * sp.Rational(1, 10**20), DIGITS))


def _other(node: Node, here: Measure, there: Measure, turn: Expr) -> Finding:
    got, expected = (str(sp.N(m.value, SHOWN)) for m in (here, there))
    return Finding(WRONG, ANOTHER, node.span, got, expected, _instead(node, there.value, turn))


def _instead(node: Node, value: Expr, turn: Expr) -> tuple[Span, str] | None:
    """Return what should stand for a number that is written out, with as many decimals or two digits."""
    written = next((n for n in walk(node) if isinstance(n, Number)), None)
    if written is None or last_digit(node) is None:
        return None
    one = transform(node, lambda n: replace(written, text="1") if n is written else n)
    unit = measured(one, lambda _: None)
    if unit is None or unit.value == 0 or not (right := value / unit.value.subs(TURN, turn)) > 0:
        return None
    decimals = max(len(written.text.partition(".")[2]), 1 - math.floor(math.log10(right)))
    return written.span, f"{float(right):.{decimals}f}"


def _unfit(s: Statement, e: Elaborator, k: int, here: Measure) -> Finding | None:
    """Return the finding that a unit is that of another quantity."""
    for member in s.members[:k] if here.unit is not None else ():
        try:
            wanted = e.value(member).dimension
        except (Refusal, InputError):
            continue
        if (
            wanted is not None
            and here.unit is not None
            and wanted != here.unit
            and not number_only(member)
        ):
            return Finding(
                WRONG, "the dimensions differ", s.members[k].span, here.unit.words, wanted.words
            )
    return None


def _taken(
    s: Statement,
    pure: list[Measure | None],
    full: list[Measure | None],
    finding: Finding | None,
    data: _Data,
) -> tuple[Expr, Expr] | None:
    """Return the number that a chain gives, and how far it is rounded.

    It is the last one that is written; if that is not what stands before it, the first one, and none if
    its dimension is another one.
    """
    if finding is None or finding.verdict == UNDECIDED:
        last = max(k for k, p in enumerate(pure) if p is not None and p.value != 0)
        off = last_digit(s.members[last]) if len(s.members) > 2 else None
        return pure[last].value, off or sp.Integer(0)  # type: ignore[union-attr]
    if finding.what != ANOTHER:
        return None
    node, first = next((m, f) for m, f in zip(s.members, full, strict=True) if f is not None)
    return first.value, (last_digit(node) or 0) + data.off(node)


def _learned(
    s: Statement, e: Elaborator, taken: tuple[Expr, Expr] | None, used: Used, data: _Data
) -> Mapping[Look, Value]:
    """Return the number that symbols alone in the chain have got, rounded as it stands."""
    found: dict[Look, Value] = {}
    for member in s.members if taken is not None else ():
        symbol = primed(member)
        if symbol is None or symbol.raised or data.holds(key(symbol.look, symbol.dots)):
            continue
        turn = _turn(member, e) or TURN
        value, off = (x.subs(TURN, turn) for x in taken or ())
        found |= kept(symbol.look, symbol.dots, value, off, used)
    return found


def agreed() -> Value:
    """Return one side of what is said by numbers that agree."""
    return number(sp.Integer(1), Statement((), ()).span)
