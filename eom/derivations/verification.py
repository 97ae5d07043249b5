"""Whether a statement holds: as an exact identity, by its form, or in exact random worlds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.identity import vanishes
from eom.exact.integrals import antiderivative
from eom.exact.numbers import SIGNED
from eom.fields import RATIONALS, Singular
from eom.terms import rules
from eom.terms.terms import MATRIX, SCALAR, Equation, Term, nodes
from eom.terms.vocabulary import definition
from eom.worlds.evaluate import Evaluator, is_signed
from eom.worlds.generators import worlds
from eom.worlds.worlds import World

RELATIONS = ("=", ":=", ">=")
"""Equal, defined as, not negative."""

WORLDS = 3
"""Worlds in which every step must hold."""

SIGN_WORLDS = 30
"""Worlds in which a false sign may show: it is right by chance in half of them."""

SIGNED_TRIALS = 40
"""Worlds of numbers with a sign that are drawn where there are logarithms: they need positive ones."""

IDENTITY = "exact identity"
"""The evidence of what holds whatever the symbols stand for."""

FALSE = "the step is false"
"""What the error says of a statement that a world refutes."""

Scalars = Mapping[Any, Term]
Names = tuple[str, ...]
Drawn = Callable[..., Iterator[World]]
"""What draws worlds, as `eom.worlds.generators.worlds` does."""


class DerivationError(InputError):
    """Refuse a step of a derivation that is false, or cannot be decided.

    An `InputError` with the same parts.
    """


def verify(
    equation: Equation,
    assumptions: Iterable[str],
    scalars: Scalars,
    *,
    where: str = "",
    count: int = WORLDS,
    drawn: Drawn = worlds,
) -> str:
    """Return how ``equation`` was verified. Raises `DerivationError` if it fails or is undecided."""
    if equation.left.kind != equation.right.kind:
        kinds = f"{equation.left.kind} = {equation.right.kind}"
        raise DerivationError("the two sides are of different kinds", where=where, got=kinds)
    if equation.relation not in RELATIONS:
        raise DerivationError("unknown relation", where=where, got=equation.relation)
    if equation.relation == ":=":
        return _verify_definition(equation, scalars, where)
    if equation.relation == ">=":
        return _verify_sign(equation, scalars, tuple(assumptions), where, drawn)
    if is_plain(equation):
        if _is_identity(equation, scalars):
            return IDENTITY
        holds = has_meaning(equation, scalars) and decide(
            equation, assumptions, scalars, count, drawn
        )
    else:
        holds = decide(equation, assumptions, scalars, count, drawn)
    if not holds:
        raise DerivationError(
            FALSE,
            where=where,
            got=f"{plain(equation.left)} = {plain(equation.right)}",
            expected=f"to hold under {', '.join(assumptions) or 'no assumption'}",
        )
    return f"held in {count} random worlds"


def decide(
    equation: Equation,
    assumptions: Iterable[str],
    scalars: Scalars,
    count: int = WORLDS,
    drawn: Drawn = worlds,
) -> bool:
    """Return whether an equation holds in ``count`` worlds; worlds where it is undefined are skipped."""
    found = 0
    signed = any(
        is_signed(e, scalars)
        for side in (equation.left, equation.right)
        for e in written(side, scalars)
    )
    draws = drawn(assumptions, SIGNED_TRIALS, SIGNED) if signed else drawn(assumptions, 4 * count)
    for world in draws:
        try:
            if not Evaluator(world, scalars).holds(equation):
                return False
        except Singular:
            continue
        found += 1
        if found == count:
            return True
    raise DerivationError("the statement is undefined in every world that was drawn")


def written(term: Term, scalars: Scalars) -> Iterator[Any]:
    """Yield the SymPy expressions in a term, and in what their symbols stand for."""
    for node in nodes(term):
        if node.head == "expr":
            yield node.data[0]
            for s in node.data[0].free_symbols & scalars.keys():
                yield from written(scalars[s], scalars)


def is_plain(equation: Equation) -> bool:
    """Return whether both sides are made of SymPy expressions alone."""
    parts = [n for side in (equation.left, equation.right) for n in nodes(side)]
    return all(n.args or n.head in {"expr", "zero"} for n in parts) and not any(
        n.head in {"der", "partial", "sum", "integral", "column", "start", "since", "at"}
        for n in parts
    )


def has_meaning(equation: Equation, scalars: Scalars) -> bool:
    """Return whether every symbol stands for a quantity of the worlds."""
    return _symbols(equation) <= set(scalars)


def is_of_quantities(equation: Equation, scalars: Scalars) -> bool:
    """Return whether symbols stand in an equation, and each for a quantity of the worlds."""
    return bool(_symbols(equation)) and has_meaning(equation, scalars)


def _symbols(equation: Equation) -> set[Any]:
    parts = (*nodes(equation.left), *nodes(equation.right))
    return {s for n in parts if n.head == "expr" for s in n.data[0].free_symbols}


def _is_identity(equation: Equation, scalars: Scalars) -> bool:
    """Return whether both sides are equal for all values; named expressions are put in."""
    known = {s: m.data[0] for s, m in scalars.items() if m.head == "expr"}
    pairs = zip(_entries(equation.left), _entries(equation.right), strict=True)
    return all(
        vanishes(carried_out(in_full(a, known)) - carried_out(in_full(b, known))) for a, b in pairs
    )


def in_full(e: Any, known: Mapping[Any, Any]) -> Any:
    """Return an expression with what its symbols stand for put in, and what stands in that.

    Raises `InputError` for a derivative by a symbol that stands for something.
    """
    given = {v for n in e.atoms(sp.Derivative) for v in n.variables} & known.keys()
    if given:
        raise InputError("a derivative by what is no variable", got=", ".join(map(str, given)))
    while e.free_symbols & known.keys():
        e = e.xreplace(known)
    return e


def _entries(term: Term) -> list[Any]:
    """Return the entries of a term of SymPy expressions, its products carried out."""
    if term.head == "zero":
        return [sp.Integer(0)] * (9 if term.kind == MATRIX else 3)
    done = rules.compute()(term)
    return [done.data[0]] if done.head == "expr" else [a.data[0] for a in done.args]


def carried_out(expression: Any) -> Any:
    """Carry out derivatives, determinants and integrals; antiderivatives are differentiated again."""
    slopes = expression.replace(lambda n: isinstance(n, sp.Derivative), lambda n: n.doit())
    known = slopes.replace(
        lambda n: isinstance(n, sp.Determinant), lambda n: n.arg.det(method="berkowitz")
    )
    return known.replace(lambda n: isinstance(n, sp.Integral), _integrated)


def _integrated(integral: Any) -> Any:
    value = carried_out(integral.function)
    for x, start, end in integral.limits:
        inside = antiderivative(sp.expand(value), x)
        if inside is None or not vanishes(inside.diff(x) - value):
            raise DerivationError("an integral cannot be decided", got=integral)
        value = inside.xreplace({x: end}) - inside.xreplace({x: start})
    return value


def _verify_definition(equation: Equation, scalars: Scalars, where: str) -> str:
    """A definition is that of the vocabulary, the meaning of a symbol, or names new symbols."""
    left, right = equation.left, equation.right
    if left.head == "atom":
        sound = definition(left) == right
    else:
        symbols = [n.data[0] for n in nodes(left) if n.head == "expr"]
        known = [scalars[s] for s in symbols if s in scalars]
        sound = all(s.is_Symbol for s in symbols) and left.head in {"expr", "entries"}
        sound = sound and (known == [right] if known else is_plain(equation))
    if not sound:
        raise DerivationError("this does not define its left side", where=where, got=plain(left))
    return "definition"


def _verify_sign(
    equation: Equation, scalars: Scalars, assumptions: Names, where: str, drawn: Drawn
) -> str:
    """Not negative by its form, sums of products of masses and squares; or negative in a world."""
    if equation.left.kind == SCALAR and equation.right.is_zero:
        if not_negative(rules.ordered(equation.left), scalars):
            return "sum of squares"
        if not has_meaning(equation, scalars):
            raise DerivationError(
                "the sign cannot be decided", where=where, got=plain(equation.left)
            )
        for world in drawn(assumptions, SIGN_WORLDS, field=RATIONALS):
            value = Evaluator(world, scalars).lowest(equation.left)
            if value < 0:
                raise DerivationError(FALSE, where=where, got=f"{plain(equation.left)} = {value}")
        if decide(Equation(equation.left, equation.right), assumptions, scalars, drawn=drawn):
            return f"zero in {WORLDS} random worlds"
    raise DerivationError("the sign cannot be decided", where=where, got=plain(equation.left))


def not_negative(term: Term, scalars: Scalars) -> bool:
    """Return whether the form of ``term`` shows that it cannot be negative.

    Of a symbol that stands for a quantity it is known that it is real, whatever its own assumptions say.
    """
    if term.head == "expr":
        known = term.data[0].free_symbols & set(scalars)
        real = {s: sp.Dummy(real=True) for s in known}
        return bool(term.data[0].xreplace(real).is_nonnegative)
    if term.head == "mul":
        return all(not_negative(a, scalars) or term.args.count(a) % 2 == 0 for a in term.args)
    if term.head in {"add", "sum", "integral"}:
        return all(not_negative(a, scalars) for a in term.args)
    if term.head in {"dot", "inner"} and term.kind == SCALAR:
        return term.args[0] == term.args[1]
    return term.head == "atom" and term.data[0] in {"mass", "total_mass"}


_REAL = (sp.Add, sp.Mul, sp.Symbol, sp.Rational, sp.sin, sp.cos)


def _is_square(factor: Term) -> bool:
    """Return whether this is an even power of what is real wherever it is defined."""
    e = factor.data[0] if factor.head == "expr" else sp.S.One
    return bool(e.is_Pow and e.exp.is_Integer and e.exp % 2 == 0) and all(
        isinstance(n, _REAL) or (n.is_Pow and n.exp.is_Integer) for n in sp.preorder_traversal(e)
    )


def check_signs(
    products: Iterable[Sequence[Term]], known: Iterable[Equation], scalars: Scalars, where: str
) -> None:
    """Raise `DerivationError` unless every product is of what cannot be negative.

    ``known``: lines that say ``a >= 0``; powers of their left sides count, too.
    """
    signed = [line.left for line in known if line.relation == ">="]

    def is_signed(factor: Term) -> bool:
        base = factor
        if factor.head == "expr" and factor.data[0].is_Pow and factor.data[0].exp.is_Integer:
            base = Term("expr", (), (factor.data[0].base,))
        known = factor in signed or base in signed
        return known or _is_square(factor) or not_negative(factor, scalars)

    for factor in (f for product in products for f in product):
        if not is_signed(factor):
            raise DerivationError("the sign cannot be decided", where=where, got=plain(factor))


def plain(term: Term) -> str:
    """Return a term as plain text for messages."""
    from eom.typeset.notation import PLAIN, write

    return write(term, PLAIN)
