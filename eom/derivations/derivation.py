"""A derivation: steps with reasons, each verified when it is made, and the result.

A chain starts from a definition, a law or an earlier statement; each further step applies rules to
its right side (`eom.terms.rules`) and is then tested on its own: exactly where both sides are plain
expressions, else in random worlds under the assumptions made so far. A step that fails, or that
nothing can decide, raises `DerivationError`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from eom.derivations.derived import Derived, Step
from eom.derivations.reached import KINDS, RESULT, Path, is_tautology, meets, smallest
from eom.derivations.verification import IDENTITY, DerivationError, decide, has_meaning, verify
from eom.errors import InputError, typed_fields
from eom.fields import Singular
from eom.terms import rules
from eom.terms.own import Law, Own, OwnFrame
from eom.terms.rules import Rule, Trace
from eom.terms.rules.inferences import Inference
from eom.terms.terms import (
    INDICES,
    Equation,
    Term,
    column,
    expr,
    nodes,
)
from eom.terms.vocabulary import definition
from eom.worlds.generators import worlds
from eom.worlds.own import furnished
from eom.worlds.worlds import World, closure


@dataclass(frozen=True)
class Chain:
    """An established statement that further rules can be applied to; ``maker``: of which derivation."""

    maker: Derivation
    step: Step

    @property
    def equation(self) -> Equation:
        """The statement."""
        return self.step.statement

    def then(
        self, reason: str, *applied: Rule, label: str = "", states: Iterable[str] = ()
    ) -> Chain:
        """State ``left = rules(right)``.

        ``reason``: why, in words; ``applied``: the rules (`eom.terms.rules`), in order; ``label``: by which
        the line is recalled; ``states``: equations of a lecture that it is. Raises `DerivationError` if
        nothing changes, or the line is false or undecided.
        """
        with rules.traced() as trace:
            new = rules.apply(applied, self.equation.right)
        if new == self.equation.right:
            raise DerivationError("a step changes nothing", where=self.maker.name, got=reason)
        relation = "=" if self.equation.relation == ":=" else self.equation.relation
        line, path = Equation(self.equation.left, new, relation), self._path(trace)
        return self.maker.state(line, reason, label=label, states=states, path=path)

    def _path(self, trace: Trace, *others: Chain) -> Path:
        return Path((self.step.label, *(o.step.label for o in others)), trace)

    def both(
        self,
        reason: str,
        operation: Callable[[Term], Term],
        *applied: Rule,
        label: str = "",
        states: Iterable[str] = (),
    ) -> Chain:
        """Do the same to both sides.

        ``reason``: why, in words; ``operation``: what is done, from a term to a term; ``applied``: rules
        for the new right side; ``label``, ``states``: see `then`. Raises `DerivationError` as `then` does.
        """
        with rules.traced() as trace:
            rules.noted("the same on both sides")
            left = operation(self.equation.left)
            right = rules.apply(applied, operation(self.equation.right))
        if Equation(left, right) == self.equation:
            raise DerivationError("a step changes nothing", where=self.maker.name, got=reason)
        line, path = Equation(left, right), self._path(trace)
        return self.maker.state(line, reason, label=label, states=states, path=path)

    def infer(
        self,
        reason: str,
        inference: Inference,
        *others: Chain,
        label: str = "",
        states: Iterable[str] = (),
    ) -> Chain:
        """State what follows from this line, and from ``others``, by an inference.

        ``reason``: why, in words; ``inference``: a row of `eom.terms.rules.inferences`; ``label``,
        ``states``: see `then`. Raises `InputError` where it does not apply, and as `then` does.
        """
        with rules.traced() as trace:
            rules.noted(inference.words)
            line = inference.conclude(self.equation, *(o.equation for o in others))
        if line == self.equation:
            raise DerivationError("a step changes nothing", where=self.maker.name, got=reason)
        path = self._path(trace, *others)
        return self.maker.state(line, reason, label=label, states=states, path=path)

    def turned(self, reason: str, *, label: str = "", states: Iterable[str] = ()) -> Chain:
        """State ``right = left``.

        ``reason``: why, in words; ``label``, ``states``: see `then`.
        """
        sides = Equation(self.equation.right, self.equation.left)
        with rules.traced() as trace:
            rules.noted("sides exchanged")
        path = self._path(trace)
        return self.maker.state(sides, reason, label=label, states=states, path=path)


@typed_fields
@dataclass
class Derivation:
    """Collects lines, each verified when it is made; `finish` freezes them as an `eom.Derived`.

    ``name``, ``title``, ``group``: how it is called; ``assumed``: names of assumptions
    (`eom.worlds.worlds.ASSUMPTIONS`) to begin with. Quantities are in SI units. What stands so far:
    ``scalars``, what symbols stand for, as terms; ``steps``; ``own``, its frames, points and laws;
    ``stated``, the labels of steps by what they state; ``letters``, what other symbols are. A line that
    is false or undecided raises `eom.derivations.verification.DerivationError` and is not kept; so do
    arguments of other types raise `InputError`, and assumptions that are unknown or at odds.
    """

    name: str
    title: str
    group: str
    assumed: tuple[str, ...] = ()
    scalars: dict[Any, Term] = field(default_factory=dict, init=False)
    steps: list[Step] = field(default_factory=list, init=False)
    own: Own = field(default_factory=Own, init=False)
    stated: dict[Equation, str] = field(default_factory=dict, init=False)
    letters: dict[Any, str] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self.only(*self.assumed)

    def frame(self, name: str, angle: Any, axis: int = 3, base: str = "I") -> None:
        """Let a new frame be turned from ``base`` about its axis ``axis`` through ``angle`` (rad)."""
        self._new(name, self.own.frames)
        self.own.frames[name] = OwnFrame(base, axis, angle)

    def point(self, name: str, place: Term) -> None:
        """Let a new point have the position ``place`` from the inertial origin."""
        self._new(name, self.own.points)
        self.own.points[name] = place

    def _new(self, name: str, known: Mapping[str, Any]) -> None:
        if (
            name in {*known, *"IABCOPS", "OI", "OA", "OB", "open", *INDICES}
            or not name.isidentifier()
        ):
            raise DerivationError("this name is taken, or is none", where=self.name, got=name)

    def determine(self, equation: Equation, *unknowns: Any) -> Chain:
        """State a law that motions keep from here on.

        ``equation``: the law; ``unknowns``: the coordinates (symbols) that obey it, whose highest rates
        stand linearly in it. Raises `DerivationError` or another `InputError` where these rates cannot
        be had from it, or where it is at odds with a law before; nothing is kept then.
        """
        carry = rules.slopes(self.scalars, self.own)
        kept = Equation(carry(equation.left), carry(equation.right))
        self.own.laws.append(Law(kept, unknowns))
        try:
            return self.law(equation, "law of the motion")
        except InputError:
            self.own.laws.pop()
            raise

    def _verified(
        self, equation: Equation, reason: str, assumed: Iterable[str] | None = None
    ) -> str:
        carry = rules.slopes(self.scalars, self.own)
        scalars = {s: carry(t) for s, t in self.scalars.items()}
        plainly = Equation(carry(equation.left), carry(equation.right), equation.relation)
        shown = equation if equation.relation == ":=" else plainly

        def drawn(*args: Any, **options: Any) -> Iterator[World]:
            for world in worlds(*args, **options):
                with suppress(Singular):
                    yield furnished(world, self.own, scalars)

        with_own = drawn if self.own.frames or self.own.points or self.own.laws else worlds
        where = f"{self.name}: {reason}"
        known = self.scalars if equation.relation == ":=" else scalars
        names = self.assumed if assumed is None else assumed
        return verify(shown, names, known, where=where, drawn=with_own)

    def _needed(self, equation: Equation, reason: str) -> tuple[str, ...]:
        """Return a smallest set of the assumptions made so far under which a line holds."""
        relation = "=" if equation.relation == ":=" else equation.relation
        line = Equation(equation.left, equation.right, relation)

        def holds(names: Iterable[str]) -> None:
            evidence = self._verified(line, reason, names)
            if evidence == IDENTITY and has_meaning(line, self.scalars):
                decide(line, names, self.scalars, count=1)

        return smallest(self.assumed, holds)

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
        """State what defines a quantity of the vocabulary.

        ``quantity``: such as ``quantity("angular_momentum", "body", "O")``; ``reason``: in words;
        ``label``, ``states``: see `Chain.then`. Raises `InputError`, and `DerivationError` for a
        quantity without a definition.
        """
        meaning = definition(quantity)
        if meaning is None:
            raise DerivationError("quantity without a definition", got=quantity.data)
        return self.state(
            Equation(quantity, meaning, ":="), reason, "definition", label=label, states=states
        )

    def name_scalar(self, symbol: Any, meaning: Term, reason: str, **options: Any) -> Chain:
        """Let a SymPy symbol stand for a scalar.

        ``symbol``: a SymPy symbol; ``meaning``: a term, such as ``quantity("coordinate", "q")``;
        ``reason``: in words; ``options``: see `state`. Raises `DerivationError` for a symbol with another
        meaning, or one that its meaning holds.
        """
        known = self.scalars.get(symbol, meaning)
        inside = {s for n in nodes(meaning) if n.head == "expr" for s in n.data[0].free_symbols}
        if known != meaning or symbol in inside:
            raise DerivationError(
                "a symbol has one meaning, without itself", where=self.name, got=symbol
            )
        self.scalars[symbol] = meaning
        return self.state(Equation(expr(symbol), meaning, ":="), reason, "definition", **options)

    def letter(self, symbol: Any, words: str) -> None:
        """Say what a symbol is that stands for no term: ``symbol``, a SymPy symbol, and ``words``."""
        self.letters[symbol] = words

    def law(self, equation: Equation, reason: str, **options: Any) -> Chain:
        """State a law; it, too, has to hold in the worlds.

        ``equation``: the law; ``reason``: in words; ``options``: see `state`. Raises `DerivationError`.
        """
        return self.state(equation, reason, "law", **options)

    def given(self, equation: Equation, reason: str, **options: Any) -> Chain:
        """State what an assumption means as a formula; it has to hold in the worlds.

        ``equation``: the meaning; ``reason``: in words; ``options``: see `state`. Raises `DerivationError`.
        """
        return self.state(equation, reason, "assumption", **options)

    def show(self, equation: Equation, reason: str, *applied: Rule, **options: Any) -> Chain:
        """State an equation, both sides of which rules lead to the same.

        ``equation``: the line; ``reason``: why, in words; ``applied``: the rules, in order, for both
        sides; ``options``: see `state`. Raises `DerivationError` where they do not lead there.
        """
        with rules.traced() as trace:
            reached = meets(equation, applied)
        if not reached:
            raise DerivationError("the rules do not lead here", where=self.name, got=reason)
        if not trace.words:
            trace.words["algebra"] = None
        return self.state(equation, reason, path=Path((), trace), **options)

    def state(
        self,
        equation: Equation,
        reason: str,
        kind: str = "result",
        *,
        label: str = "",
        states: Iterable[str] = (),
        path: Path | None = None,
    ) -> Chain:
        """Verify a statement and add it.

        ``equation``: the line; ``reason``: why it holds, in words; ``kind``: "law", "definition",
        "assumption", or "result"; ``label``: by which it is recalled; ``states``: equations of a lecture
        that it is; ``path``: how a result was reached. Raises `DerivationError` for a line that is false,
        undecided, trivial or stated before, for a label that is taken and for other kinds.
        """
        evidence = self._verified(equation, reason)
        name = label or f"s{len(self.steps) + 1}"
        self._check_new(equation, name, kind)
        follows = path.sources(self.stated, f"{self.name}: {reason}") if path else ()
        step = Step(
            name,
            equation,
            reason,
            kind,
            tuple(states),
            self._needed(equation, reason),
            evidence,
            follows,
            tuple(path.trace.words) if path else (),
        )
        self.steps.append(step)
        self.stated[equation] = name
        return Chain(self, step)

    def _check_new(self, equation: Equation, name: str, kind: str) -> None:
        """Refuse a label that is taken, an unknown kind, a tautology, and what stands there already."""
        if name in self.stated.values():
            raise DerivationError("two steps with one label", where=self.name, got=name)
        if kind not in KINDS:
            expected = ", ".join(KINDS)
            raise DerivationError("unknown kind", where=self.name, got=kind, expected=expected)
        if is_tautology(equation):
            raise DerivationError("a step says nothing", where=self.name, got=name)
        if kind == RESULT and equation in self.stated:
            known = self.stated[equation]
            raise DerivationError("a step changes nothing", where=self.name, got=f"as {known}")

    def start(self, term: Term) -> Chain:
        """Return a chain that transforms ``term``; it states nothing yet."""
        return Chain(self, Step("", Equation(term, term), ""))

    def recall(self, label: str) -> Chain:
        """Return the chain of a step before by its ``label``. Raises `DerivationError` for unknown ones."""
        for step in self.steps:
            if step.label == label:
                return Chain(self, step)
        raise DerivationError("no step with this label", where=self.name, got=label)

    def in_components(
        self, chain: Chain, frame: str, reason: str, *applied: Rule, **options: Any
    ) -> Chain:
        """Take components of both sides of ``chain`` in ``frame`` and push them inwards.

        ``reason``: in words; ``applied``: rules for the right side; ``options``: see `Chain.both`.
        """
        inwards = rules.components(frame)
        return chain.both(reason, lambda t: inwards(column(t, frame)), inwards, *applied, **options)

    def check(self, equation: Equation, reason: str) -> None:
        """Verify a statement without adding it: that a result is what the steps lead to.

        ``equation``: the statement; ``reason``: what it is, in words. Raises `DerivationError`.
        """
        self._verified(equation, reason)

    def finish(self, **result: Any) -> Derived:
        """Return the derivation, finished; ``result``: what it gives by name, such as a system."""
        return Derived(
            self.name,
            self.title,
            self.group,
            tuple(self.steps),
            dict(self.scalars),
            result,
            dict(self.letters),
        )
