"""What disagrees in a false line: what is left over in its symbols, and a world in which it fails.

What is left over is worked out over coordinates, their rates and constants, with the highest rates as the
laws give them. It is told only if it has the value, in such a world, by which the sides differ there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.numbers import SIGNED
from eom.fields import Singular
from eom.terms.own import Own
from eom.terms.terms import SCALAR, Equation, Term, der, expr, nodes
from eom.terms.vocabulary import definition
from eom.worlds.evaluate import Evaluator, flat
from eom.worlds.own import Furnished

Scalars = Mapping[Any, Term]
Value = Any
"""A SymPy expression, or a 3 x 1 or 3 x 3 matrix of components in I."""
DRAWS = 12
"""Worlds among which one is looked for whose constants are all positive."""
LONG = 400
"""Operations up to which an expression that is written out is simplified, and told."""
SIMPLE = 60
"""Operations up to which SymPy's own simplification is tried, too."""
LONGEST = 20_000
"""Operations up to which one is written out."""
NEAR = 1e-9
RATES = 2
"""How often laws are differentiated for what is left over."""


def disagreement(equation: Equation, drawn: Furnished, assumptions: Iterable[str]) -> str:
    """Return what disagrees in an equation that is false, "" where nothing can be told of it.

    ``drawn``: worlds with what it is about; ``assumptions``: that are made.
    """
    shown = _counterexample(equation, drawn, tuple(assumptions))
    if shown is None:
        return ""
    kit = Written(drawn.scalars, drawn.own)
    rest = _left_over(equation, kit)
    shown = shown.with_letters(kit.made)
    if rest is None or not _agrees(rest, shown):
        return shown.words([])
    free = set().union(*(e.free_symbols for e in entries(rest)))
    return f"left less right is {_text(rest)}; {shown.words(free)}"


# -- a world in which it fails ---------------------------------------------------------------------


@dataclass(frozen=True)
class _Failing:
    """A world where the sides differ: ``evaluator`` there, ``sides`` by components at t = 0."""

    evaluator: Evaluator
    sides: tuple[list[Any], list[Any]]
    symbols: tuple[Any, ...]

    @property
    def is_plain(self) -> bool:
        """Whether no constant is negative."""
        constants = [s for s in self.symbols if _is(self.evaluator.scalars[s], "scalar")]
        return all(self.number(s) > 0 for s in constants)

    def with_letters(self, more: Scalars) -> _Failing:
        """Return the same with more letters, by their meanings."""
        known = self.evaluator.scalars
        evaluator = Evaluator(self.evaluator.world, {**known, **more})
        return replace(self, evaluator=evaluator)

    def number(self, expression: Any) -> Any:
        """Return the value of an expression at t = 0."""
        return self.evaluator.scalar(expression, {}).coefficients[0]

    def words(self, others: Iterable[Any]) -> str:
        """Return what the symbols are, ``others`` besides, and then the sides."""
        named = sorted({*self.symbols, *others}, key=sp.default_sort_key)
        values = ", ".join(f"{s} = {_short(self.number(s))}" for s in named)
        left, right = (_row([_short(v) for v in side]) for side in self.sides)
        at = f"where {values}, " if values else ""
        frame = " (components in I)" if len(self.sides[0]) > 1 else ""
        return f"{at}the left side is {left}, the right one {right}{frame}"


def _counterexample(
    equation: Equation, drawn: Furnished, assumed: tuple[str, ...]
) -> _Failing | None:
    """Return a world of real numbers where the sides differ, None where none is found."""
    first = None
    try:
        for found in _failing(equation, drawn, assumed):
            if found.is_plain:
                return found
            first = first or found
    except InputError:
        return first
    return first


def _failing(equation: Equation, drawn: Furnished, assumed: tuple[str, ...]) -> Iterator[_Failing]:
    scalars = drawn.scalars
    terms = (equation.left, equation.right)
    used = {s for t in terms for n in nodes(t) if n.head == "expr" for s in n.data[0].free_symbols}
    symbols = tuple(sorted(used & set(scalars), key=sp.default_sort_key))
    for world in drawn(assumed, DRAWS, SIGNED):
        evaluator = Evaluator(world, scalars)
        try:
            env = next(evaluator.numberings(frozenset().union(*map(evaluator.labels, terms))))
            sides = [[s.coefficients[0] for s in flat(evaluator.value(t, env))] for t in terms]
        except (Singular, IndexError, StopIteration):
            continue
        if any(abs(a - b) > NEAR for a, b in zip(*sides, strict=True)):
            yield _Failing(evaluator, (sides[0], sides[1]), symbols)


def _agrees(rest: Value, shown: _Failing) -> bool:
    """Return whether what is left over has the value by which the sides differ."""
    pairs = zip(entries(rest), *shown.sides, strict=True)
    try:
        return all(abs(shown.number(e) - (a - b)) < NEAR * (1 + abs(a)) for e, a, b in pairs)
    except (InputError, Singular, IndexError):
        return False


def _short(value: Any) -> str:
    return f"{float(value):.4g}"


def _row(entries: Sequence[str]) -> str:
    return entries[0] if len(entries) == 1 else f"({', '.join(entries)})"


# -- what is left over -------------------------------------------------------------------------------


def _left_over(equation: Equation, kit: Written) -> Value | None:
    """Return left less right by coordinates, rates and constants; None where that is not to be had."""
    try:
        rest = kit.value(equation.left) - kit.value(equation.right)
        found = [_short_form(kit.moving(e)) for e in entries(rest)]
    except InputError:
        return None
    return found[0] if len(found) == 1 else sp.Matrix(len(found) // 3 or 1, 3, found)


def entries(value: Value) -> list[Any]:
    """Return the components of a value, one of a scalar."""
    return list(value) if isinstance(value, sp.MatrixBase) else [sp.sympify(value, strict=True)]


def _text(value: Value) -> str:
    return _row([sp.sstr(sp.factor_terms(e)) for e in entries(value)])


def _is(term: Term, name: str) -> bool:
    return term.head == "atom" and term.data[0] == name


@dataclass
class Written:
    """Terms as SymPy expressions over the symbols of a derivation, vectors by components in I."""

    scalars: Scalars
    own: Own
    motions: dict[Any, Any] = field(default_factory=dict)
    rates: dict[Any, Any] = field(default_factory=dict)
    made: dict[Any, Term] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.rates |= {m.args[0].data[0]: s for s, m in self.scalars.items() if _is_rate(m)}

    def value(self, term: Term) -> Value:
        """Return a term. Raises `InputError` for what is nothing of these symbols."""
        if term.head not in _ROWS:
            raise InputError("not written by symbols", got=term.head)
        return _ROWS[term.head](self, term)

    def expression(self, e: Any) -> Any:
        """Return an expression with symbols that stand for others spelt out."""
        spelt = {s: self.value(m) for s, m in self.scalars.items() if e.has(s) and self._spelt(m)}
        return e.xreplace(spelt)

    def _spelt(self, meaning: Term) -> bool:
        """Return whether a symbol stands for others, or is the rate of one that does."""
        if not _is_rate(meaning):
            return _defined(meaning)
        base = self.scalars.get(meaning.args[0].data[0], _NONE)
        return base is not _NONE and self._spelt(base)

    def rate(self, e: Any) -> Any:
        """Return the time derivative of an expression."""
        moving = (s for s in e.free_symbols if not _is(self.scalars.get(s, _NONE), "scalar"))
        return sp.Add(*(e.diff(s) * self.rate_of(s) for s in moving))

    def rate_of(self, symbol: Any) -> Any:
        """Return the symbol of a rate: a new one, kept in ``made``, where the derivation has none."""
        if symbol not in self.rates:
            name = f"{symbol}_dot"
            rate = sp.Symbol(name.replace("_dot_dot", "_ddot"), real=True)
            rate = sp.Dummy(name, real=True) if rate in self.scalars else rate
            self.rates[symbol], self.made[rate] = rate, der(expr(symbol))
        return self.rates[symbol]

    def turn(self, frame: str) -> Any:
        """Return the matrix from components in a frame to those in I."""
        found = sp.eye(3)
        for row in self._rows(frame):
            found = _turned(row.axis, self.expression(sp.sympify(row.angle, strict=True))) * found
        return found

    def _rows(self, frame: str) -> Iterator[Any]:
        while frame in self.own.frames:
            yield self.own.frames[frame]
            frame = self.own.frames[frame].base
        if frame != "I":
            raise InputError("this frame turns in any way", got=frame)

    def moving(self, e: Any, laws: Iterable[Any] | None = None) -> Any:
        """Return an expression with the rates that the laws give, all or some of them."""
        if self.own.laws and not self.motions:
            for law in self.own.laws if laws is None else laws:
                self._solve(law)
        for _ in range(len(self.motions)):
            e = e.xreplace(self.motions)
        return e

    def _solve(self, law: Any) -> None:
        """Solve a law for the highest rates that stand in it of what it determines."""
        sides = [self.value(t) for t in (law.equation.left, law.equation.right)]
        rest = [_short_form(e.xreplace(self.motions)) for e in entries(sides[0] - sides[1])]
        highest = [_highest(s, self.rates, rest) for s in law.unknowns]
        found = sp.solve(rest, highest, dict=True)
        if len(found) != 1:
            raise InputError("this law is not solved", got=highest)
        motions = dict(found[0])
        for lowest in highest:
            symbol = lowest
            for _ in range(RATES):
                below, symbol = symbol, self.rate_of(symbol)
                motions[symbol] = self.rate(motions[below]).xreplace(motions)
        self.motions |= motions


_NONE = Term("none")


def _is_rate(meaning: Term) -> bool:
    """Return whether a symbol is the rate of another."""
    inside = meaning.args[0] if meaning.head == "der" else _NONE
    return inside.head == "expr" and inside.data[0].is_Symbol


def _defined(meaning: Term) -> bool:
    """Return whether a symbol stands for others, and is no variable of its own."""
    free = _is(meaning, "scalar") or _is(meaning, "coordinate")
    return not (free or _is_rate(meaning))


def _short_form(e: Any) -> Any:
    """Return an expression simplified. Raises `InputError` for a long one."""
    if e.count_ops() > LONGEST:
        raise InputError("too long")
    spelt = sp.expand(sp.expand(e).replace(_is_even, _by_sine))
    if spelt.count_ops() > LONG:
        raise InputError("too long")
    return sp.simplify(spelt) if spelt.count_ops() < SIMPLE else spelt


def _is_even(e: Any) -> bool:
    """Return whether this is a power of a cosine that has its square in it."""
    return e.is_Pow and isinstance(e.base, sp.cos) and e.exp.is_Integer and e.exp > 1


def _by_sine(e: Any) -> Any:
    """Return a power of a cosine with sines for its squares."""
    twice, once = divmod(int(e.exp), 2)
    return (1 - sp.sin(*e.base.args) ** 2) ** twice * e.base**once


def _highest(symbol: Any, rates: Mapping[Any, Any], rest: Iterable[Any]) -> Any:
    known = set().union(*(e.free_symbols for e in rest))
    chain = [symbol]
    while chain[-1] in rates:
        chain.append(rates[chain[-1]])
    return next((s for s in reversed(chain) if s in known), symbol)


def _turned(axis: int, angle: Any) -> Any:
    """Return the matrix of components after a frame has turned about one of its axes."""
    c, s = sp.cos(angle), sp.sin(angle)
    i, j = axis % 3, (axis + 1) % 3
    found = sp.eye(3)
    found[i, i], found[i, j], found[j, i], found[j, j] = c, -s, s, c
    return found


def _der(kit: Written, term: Term) -> Value:
    value, frame = kit.value(term.args[0]), term.data[0]
    if not isinstance(value, sp.MatrixBase):
        return kit.rate(value)
    if frame in {"", "I"}:
        return value.applyfunc(kit.rate)
    turn = kit.turn(frame)
    if value.shape == (3, 1):
        return turn * (turn.T * value).applyfunc(kit.rate)
    return turn * (turn.T * value * turn).applyfunc(kit.rate) * turn.T


def _atom(kit: Written, term: Term) -> Value:
    name, *labels = term.data
    if name == "unit":
        return kit.turn(labels[0])[:, int(labels[1]) - 1]
    if name == "position":
        ends = [kit.own.place(p) for p in labels]
        if None not in ends:
            return kit.value(ends[0]) - kit.value(ends[1])  # type: ignore[arg-type]
    if name == "angular_velocity":
        parts = [kit.value(kit.own.turning(frame)) for frame in labels]
        return parts[0] - parts[1]
    if name == "identity":
        return sp.eye(3)
    symbol = next((s for s, m in kit.scalars.items() if m == term), None)
    if symbol is not None:
        return symbol
    meaning = kit.own.meaning(term) or definition(term)
    if meaning is None:
        raise InputError("not written by symbols", got=name)
    return kit.value(meaning)


def _dot(kit: Written, term: Term) -> Value:
    a, b = map(kit.value, term.args)
    if term.kind == SCALAR:
        return (a.T * b)[0]
    return b.T * a if term.args[0].kind == "vector" else a * b


def _entries_of(kit: Written, term: Term) -> Value:
    values = [kit.value(a) for a in term.args]
    return sp.Matrix(3, len(values) // 3, values)


def _column(kit: Written, term: Term) -> Value:
    turn, value = kit.turn(term.data[0]), kit.value(term.args[0])
    return turn.T * value if value.shape == (3, 1) else turn.T * value * turn


def _sum(kit: Written, term: Term) -> Value:
    first, *others = (kit.value(a) for a in term.args)
    for value in others:
        first = first + value
    return first


def _product(kit: Written, term: Term) -> Value:
    first, *others = (kit.value(a) for a in term.args)
    for value in others:
        first = first * value
    return first


_ROWS: dict[str, Callable[[Written, Term], Value]] = {
    "expr": lambda kit, t: kit.expression(t.data[0]),
    "zero": lambda _, t: sp.zeros(3, 1 if t.kind in {"vector", "column"} else 3),
    "add": _sum,
    "mul": _product,
    "dot": _dot,
    "cross": lambda kit, t: kit.value(t.args[0]).cross(kit.value(t.args[1])),
    "outer": lambda kit, t: kit.value(t.args[0]) * kit.value(t.args[1]).T,
    "der": _der,
    "atom": _atom,
    "column": _column,
    "entries": _entries_of,
}
"""How each head is written."""
