"""A derivation: steps with reasons, each verified when it is made, and the result.

A chain starts from a definition, a law or an earlier statement; each further step applies rules to
its right side (`eom.rules`) and is then tested on its own: exactly where both sides are plain
expressions, else in random worlds under the assumptions made so far. A step that fails, or that
nothing can decide, raises `DerivationError`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from eom import rules
from eom.errors import InputError
from eom.evaluate import Evaluator
from eom.generators import worlds
from eom.identity import vanishes
from eom.integrals import antiderivative
from eom.rules import Rule
from eom.series import Singular
from eom.system import System
from eom.terms import MATRIX, SCALAR, Equation, Term, column, expr, nodes
from eom.vocabulary import definition
from eom.worlds import ASSUMPTIONS, closure

RELATIONS = ("=", ":=", ">=")
"""Equal, defined as, not negative."""

WORLDS = 3
"""Worlds in which every step must hold."""

Scalars = Mapping[Any, Term]


class DerivationError(InputError):
    """A step is false, or cannot be decided."""


@dataclass(frozen=True)
class Step:
    """A verified statement: its reason, where the lectures state it, and what it rests on.

    ``kind``: definition, law or result; ``states``: the equations of the lectures that it states;
    ``evidence``: how it was verified.
    """

    label: str
    statement: Equation
    reason: str
    kind: str = "result"
    states: tuple[str, ...] = ()
    assumptions: tuple[str, ...] = ()
    evidence: str = ""


@dataclass(frozen=True)
class Derivation:
    """A derivation with its verified steps and its result as SymPy objects by name."""

    name: str
    title: str
    group: str
    steps: tuple[Step, ...]
    scalars: Scalars
    result: Mapping[str, Any]

    def __getitem__(self, label: str) -> Step:
        """Return the step with a label. Raises `KeyError`."""
        for step in self.steps:
            if step.label == label:
                return step
        raise KeyError(label)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Every assumption that some step makes, in the order of their first use."""
        return tuple(dict.fromkeys(a for s in self.steps for a in s.assumptions))

    @property
    def system(self) -> System | None:
        """The equations of motion among the results, if there are any."""
        return next((r for r in self.result.values() if isinstance(r, System)), None)

    def _repr_markdown_(self) -> str:
        from eom.showing import show_derivation

        return show_derivation(self, "markdown")


@dataclass(frozen=True)
class Chain:
    """An established statement that further rules can be applied to."""

    maker: Maker
    step: Step

    @property
    def equation(self) -> Equation:
        """The statement."""
        return self.step.statement

    def then(
        self, reason: str, *applied: Rule, label: str = "", states: Iterable[str] = ()
    ) -> Chain:
        """State ``left = rules(right)``. Raises `DerivationError` if nothing changes or it is false."""
        new = rules.apply(applied, self.equation.right)
        if new == self.equation.right:
            raise DerivationError("a step changes nothing", where=self.maker.name, got=reason)
        relation = "=" if self.equation.relation == ":=" else self.equation.relation
        return self.maker.state(
            Equation(self.equation.left, new, relation), reason, label=label, states=states
        )

    def both(
        self,
        reason: str,
        operation: Callable[[Term], Term],
        *applied: Rule,
        label: str = "",
        states: Iterable[str] = (),
    ) -> Chain:
        """Do the same to both sides; ``applied`` are rules for the new right side."""
        left = operation(self.equation.left)
        right = rules.apply(applied, operation(self.equation.right))
        if Equation(left, right) == self.equation:
            raise DerivationError("a step changes nothing", where=self.maker.name, got=reason)
        return self.maker.state(Equation(left, right), reason, label=label, states=states)

    def turned(self, reason: str, *, label: str = "", states: Iterable[str] = ()) -> Chain:
        """State ``right = left``."""
        sides = Equation(self.equation.right, self.equation.left)
        return self.maker.state(sides, reason, label=label, states=states)


@dataclass
class Maker:
    """Collects verified steps; `finish` freezes them."""

    name: str
    title: str
    group: str
    scalars: dict[Any, Term] = field(default_factory=dict)
    assumed: tuple[str, ...] = ()
    steps: list[Step] = field(default_factory=list)

    def assume(self, *names: str) -> None:
        """From here on, take ``names`` for granted. Raises `InputError` for conflicts."""
        closure((*self.assumed, *names))
        self.assumed = tuple(dict.fromkeys((*self.assumed, *names)))

    def only(self, *names: str) -> None:
        """From here on, take ``names`` for granted and nothing else."""
        self.assumed = ()
        self.assume(*names)

    def define(
        self, quantity: Term, reason: str, *, label: str = "", states: Iterable[str] = ()
    ) -> Chain:
        """State what defines a quantity of the vocabulary."""
        meaning = definition(quantity)
        if meaning is None:
            raise DerivationError("quantity without a definition", got=quantity.data)
        return self.state(
            Equation(quantity, meaning, ":="), reason, "definition", label=label, states=states
        )

    def name_scalar(self, symbol: Any, meaning: Term, reason: str, **options: Any) -> Chain:
        """Let a SymPy symbol stand for a scalar."""
        known = self.scalars.get(symbol, meaning)
        inside = {s for n in nodes(meaning) if n.head == "expr" for s in n.data[0].free_symbols}
        if known != meaning or symbol in inside:
            raise DerivationError(
                "a symbol has one meaning, without itself", where=self.name, got=symbol
            )
        self.scalars[symbol] = meaning
        return self.state(Equation(expr(symbol), meaning, ":="), reason, "definition", **options)

    def law(self, equation: Equation, reason: str, **options: Any) -> Chain:
        """State a law or the meaning of an assumption; it, too, has to hold in the worlds."""
        return self.state(equation, reason, "law", **options)

    def state(
        self,
        equation: Equation,
        reason: str,
        kind: str = "result",
        *,
        label: str = "",
        states: Iterable[str] = (),
    ) -> Chain:
        """Verify a statement and add it."""
        evidence = verify(equation, self.assumed, self.scalars, where=f"{self.name}: {reason}")
        step = Step(
            label or f"s{len(self.steps) + 1}",
            equation,
            reason,
            kind,
            tuple(states),
            self.assumed,
            evidence,
        )
        if any(step.label == s.label for s in self.steps):
            raise DerivationError("two steps with one label", where=self.name, got=step.label)
        self.steps.append(step)
        return Chain(self, step)

    def start(self, term: Term) -> Chain:
        """Return a chain that transforms ``term``; it states nothing yet."""
        return Chain(self, Step("", Equation(term, term), ""))

    def recall(self, label: str) -> Chain:
        """Return the chain of an earlier step. Raises `DerivationError` for unknown labels."""
        for step in self.steps:
            if step.label == label:
                return Chain(self, step)
        raise DerivationError("no step with this label", where=self.name, got=label)

    def in_components(
        self, chain: Chain, frame: str, reason: str, *applied: Rule, **options: Any
    ) -> Chain:
        """Take components of both sides in ``frame`` and push them inwards."""
        inwards = rules.components(frame)
        return chain.both(reason, lambda t: inwards(column(t, frame)), inwards, *applied, **options)

    def check(self, equation: Equation, reason: str) -> None:
        """Verify a statement without adding it: that a result is what the steps lead to."""
        verify(equation, self.assumed, self.scalars, where=f"{self.name}: {reason}")

    def finish(self, **result: Any) -> Derivation:
        """Return the derivation."""
        return Derivation(
            self.name, self.title, self.group, tuple(self.steps), dict(self.scalars), result
        )


def verify(
    equation: Equation,
    assumptions: Iterable[str],
    scalars: Scalars,
    *,
    where: str = "",
    count: int = WORLDS,
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
        return _verify_sign(equation, scalars, where)
    if is_plain(equation):
        if _is_identity(equation, scalars):
            return "exact identity"
        holds = _has_meaning(equation, scalars) and decide(equation, assumptions, scalars, count)
    else:
        holds = decide(equation, assumptions, scalars, count)
    if not holds:
        raise DerivationError(
            "the step is false",
            where=where,
            got=f"{plain(equation.left)} = {plain(equation.right)}",
            expected=f"to hold under {', '.join(assumptions) or 'no assumption'}",
        )
    return f"held in {count} random worlds"


def decide(
    equation: Equation, assumptions: Iterable[str], scalars: Scalars, count: int = WORLDS
) -> bool:
    """Tell whether an equation holds in ``count`` worlds; worlds where it is undefined are skipped."""
    found = 0
    for world in worlds(assumptions, 4 * count):
        try:
            if not Evaluator(world, scalars).holds(equation):
                return False
        except Singular:
            continue
        found += 1
        if found == count:
            return True
    raise DerivationError("the statement is undefined in every world that was drawn")


def is_plain(equation: Equation) -> bool:
    """Tell whether both sides are made of SymPy expressions alone."""
    parts = [n for side in (equation.left, equation.right) for n in nodes(side)]
    return all(n.args or n.head in {"expr", "zero"} for n in parts) and not any(
        n.head in {"der", "sum", "integral", "column"} for n in parts
    )


def _has_meaning(equation: Equation, scalars: Scalars) -> bool:
    """Tell whether every symbol stands for a quantity of the worlds."""
    entries = (*_entries(equation.left), *_entries(equation.right))
    return all(e.free_symbols <= set(scalars) for e in entries)


def _is_identity(equation: Equation, scalars: Scalars) -> bool:
    """Tell whether both sides are equal for all values; named expressions are put in."""
    known = {s: m.data[0] for s, m in scalars.items() if m.head == "expr"}
    pairs = zip(_entries(equation.left), _entries(equation.right), strict=True)
    return all(
        vanishes(_resolved(a.xreplace(known)) - _resolved(b.xreplace(known))) for a, b in pairs
    )


def _entries(term: Term) -> list[Any]:
    """Return the entries of a term of SymPy expressions, its products carried out."""
    if term.head == "zero":
        return [sp.Integer(0)] * (9 if term.kind == MATRIX else 3)
    done = rules.compute()(term)
    return [done.data[0]] if done.head == "expr" else [a.data[0] for a in done.args]


def _resolved(expression: Any) -> Any:
    """Carry out determinants and integrals; antiderivatives are checked by differentiating them."""
    known = expression.replace(
        lambda n: isinstance(n, sp.Determinant), lambda n: n.arg.det(method="berkowitz")
    )
    return known.replace(lambda n: isinstance(n, sp.Integral), _integrated)


def _integrated(integral: Any) -> Any:
    value = _resolved(integral.function)
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


def _verify_sign(equation: Equation, scalars: Scalars, where: str) -> str:
    """Not negative by its form: sums of products of masses and squares."""
    if not (equation.right.is_zero and not_negative(equation.left, scalars)):
        raise DerivationError("the sign cannot be decided", where=where, got=plain(equation.left))
    return "sum of squares"


def not_negative(term: Term, scalars: Scalars) -> bool:
    """Tell whether the form of ``term`` shows that it cannot be negative.

    A symbol that stands for a quantity counts for nothing, whatever its own assumptions say.
    """
    if term.head == "expr":
        unknown = not term.data[0].free_symbols & set(scalars)
        return unknown and bool(term.data[0].is_nonnegative)
    if term.head == "mul":
        return all(not_negative(a, scalars) or term.args.count(a) % 2 == 0 for a in term.args)
    if term.head in {"add", "sum", "integral"}:
        return all(not_negative(a, scalars) for a in term.args)
    if term.head in {"dot", "inner"} and term.kind == SCALAR:
        return term.args[0] == term.args[1]
    return term.head == "atom" and term.data[0] in {"mass", "total_mass"}


def plain(term: Term) -> str:
    """Return a term as plain text for messages."""
    from eom.notation import PLAIN, write

    return write(term, PLAIN)


def meaning_of(assumption: str) -> str:
    """Return an assumption in words."""
    return ASSUMPTIONS[assumption].meaning


def with_result(derivation: Derivation, **result: Any) -> Derivation:
    """Return a derivation with more results."""
    return replace(derivation, result={**derivation.result, **result})
