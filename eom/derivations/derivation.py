"""A derivation: steps with reasons, each verified when it is made, and the result.

A chain starts from a definition, a law or an earlier statement; each further step applies rules to
its right side (`eom.terms.rules`) and is then tested on its own: exactly where both sides are plain
expressions, else in random worlds under the assumptions made so far. A step that fails, or that
nothing can decide, raises `DerivationError`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from eom.derivations.derived import Derived
from eom.derivations.reached import (
    ASSUMPTION,
    KINDS,
    RESULT,
    Path,
    is_tautology,
    meets,
    smallest,
)
from eom.derivations.refuted import disagreement
from eom.derivations.steps import Step
from eom.derivations.verification import (
    FALSE,
    IDENTITY,
    SIGN_WORLDS,
    DerivationError,
    check_signs,
    decide,
    has_meaning,
    verify,
)
from eom.errors import InputError, typed, typed_fields
from eom.expressions import as_expression
from eom.fields import RATIONALS
from eom.terms import rules
from eom.terms.own import Law, Own, OwnBody, OwnFrame
from eom.terms.rules import Rule, Trace
from eom.terms.rules.inferences import Inference
from eom.terms.terms import (
    INDICES,
    VECTOR,
    Equation,
    Term,
    add,
    as_term,
    column,
    cross,
    der,
    expr,
    mul,
    nodes,
    zero,
)
from eom.terms.vocabulary import (
    definition,
    label_words,
    omega,
    position,
    quantity,
    velocity,
)
from eom.worlds.evaluate import Evaluator
from eom.worlds.generators import worlds
from eom.worlds.own import Furnished
from eom.worlds.worlds import closure

SIGNS = "sum of products that are not negative"
"""The evidence of what follows from the signs of its factors."""

OF_NEW = "it sets what is new in it"
"""The evidence of what was computed of a quantity that nothing had been said of."""


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

    def equals(
        self, right: Any, reason: str, *, label: str = "", states: Iterable[str] = ()
    ) -> Chain:
        """State ``left = right``, the next member of the chain.

        ``right``: a term or SymPy expression; ``reason``: why, in words; ``label``, ``states``: see `then`.
        Raises `InputError` for what is neither, `DerivationError` as `then` does.
        """
        return self.then(reason, lambda _: as_term(right), label=label, states=states)

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
        unknowns: Sequence[Any] = (),
    ) -> Chain:
        """State what follows from this line, and from ``others``, by an inference.

        ``reason``: why, in words; ``inference``: a row of `eom.terms.rules.inferences`; ``label``,
        ``states``: see `then`; ``unknowns``: coordinates of which nothing was said yet, that keep this
        line from here on, as `Derivation.determine` says. Raises `InputError` where it does not apply, and
        as `then` does.
        """
        with rules.traced() as trace:
            rules.noted(inference.words)
            line = inference.conclude(self.equation, *(o.equation for o in others))
        if line == self.equation:
            raise DerivationError("a step changes nothing", where=self.maker.name, got=reason)
        path = replace(self._path(trace, *others), evidence=OF_NEW if unknowns else "")
        with self.maker.kept(line, unknowns):
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


def _is_known(term: Term, scalars: Mapping[Any, Term]) -> bool:
    """Return whether all symbols of a term, and those in what they stand for, have a meaning."""
    used = {s for n in nodes(term) if n.head == "expr" for s in n.data[0].free_symbols}
    return all(s in scalars and _is_known(scalars[s], scalars) for s in used)


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
    _drawn: tuple[tuple[Any, ...], Furnished] | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        self.only(*self.assumed)

    @typed
    def constants(self, **meanings: str) -> list[Any]:
        """Return new symbols for numbers that do not change, by their names, with what they are in words.

        ``meanings``: words by name. Raises `InputError` for a name that has another meaning.
        """
        return [self._named(n, quantity("scalar", n), words) for n, words in meanings.items()]

    @typed
    def coordinate(self, name: str, words: str, rates: int = 2) -> tuple[Any, ...]:
        """Return a new symbol for what changes with time, and those of its first ``rates`` rates.

        ``name``: of the symbol; rates are called name_dot, name_ddot; ``words``: what it is. Raises
        `InputError` for a name that has another meaning.
        """
        found = [self._named(name, quantity("coordinate", name), words)]
        for k in range(1, rates + 1):
            rate = f"{name}_{'d' * k}ot" if k > 1 else f"{name}_dot"
            words = f"{('rate', 'second rate')[k - 1] if k < 3 else f'rate number {k}'} of {name}"
            found.append(self._named(rate, der(expr(found[-1])), words))
        return tuple(found)

    def _named(self, name: str, meaning: Term, words: str) -> Any:
        symbol = sp.Symbol(name, real=True)
        self.name_scalar(symbol, meaning, words)
        return symbol

    @typed
    def let(self, name: str, value: Any, words: str) -> Any:
        """Return a new symbol that stands for a scalar made of what is known.

        ``name``: of the symbol; ``value``: a term or SymPy expression, such as a partial derivative;
        ``words``: what it is. Raises `InputError` for a name that has another meaning.
        """
        return self._named(name, as_term(value), words)

    @typed
    def frame(self, name: str, angle: Any, axis: int = 3, base: str = "I") -> None:
        """Let a new frame be turned from ``base`` about its axis ``axis`` through ``angle`` (rad).

        Raises `InputError`, a `DerivationError`, for a name that is taken or an axis other than 1, 2, 3.
        """
        self._new(name, {*self.own.frames, *"IABCS"})
        if axis not in {1, 2, 3}:
            raise DerivationError("a frame turns about an axis 1, 2 or 3", where=name, got=axis)
        row = self.own.frames[name] = OwnFrame(base, int(axis), as_expression(angle))
        words = f"frame {name} is turned from {base} about axis {axis} through {row.angle}"
        self._defined(quantity("angular_velocity", name, base), words)

    @typed
    def point(self, name: str, place: Term) -> None:
        """Let a new point have the position ``place`` from the inertial origin.

        Raises `InputError`, a `DerivationError`, for a name that is taken or a place that is no vector.
        """
        self._new(name, {*self.own.points, *"OCP", "OI", "OA", "OB", "open", "body", "system"})
        if place.kind != VECTOR:
            raise DerivationError("the place of a point is a vector", where=name, got=place.kind)
        self.own.points[name] = place
        self._defined(position(name), f"where {label_words(name)} is")

    def _defined(self, named: Term, words: str) -> None:
        """State what a new quantity is; nothing of it is kept where it has no value."""
        try:
            for world in self._worlds()(self.assumed, 1):
                Evaluator(world, self.scalars).value(named)
            self.define(named, words)
        except InputError:
            for known in (self.own.frames, self.own.points):
                known.pop(named.data[1], None)
            raise

    @typed
    def body(
        self, name: str, mass: Any, place: Term, frame: str = "", moments: Sequence[Any] = ()
    ) -> None:
        """Let a new body have its centre of mass at ``place``: a point by the same name.

        ``mass``: a number or SymPy expression; ``frame``: fixed in the body with its axes along the
        principal ones, ``moments``: those of inertia about them through the centre of mass, three; both
        are left out for a point mass. Its ``mass``, ``linear_momentum``, ``angular_momentum``,
        ``kinetic_energy`` and what `eom.terms.own.OF_BODIES` lists besides are quantities from here on.
        Raises `InputError`, a `DerivationError`, for a name that is taken, and where frame and moments do
        not fit.
        """
        if len(moments) != 3 * bool(frame):
            expected = "three moments of inertia with a frame, none without"
            raise DerivationError("these moments do not fit", where=name, expected=expected)
        self.point(name, place)
        row = OwnBody(name, as_term(mass), frame, tuple(map(as_term, moments)))
        self.own.bodies[name] = row
        self.define(quantity("mass", name), f"mass of {label_words(name)}")

    def _new(self, name: str, taken: Collection[str]) -> None:
        if name in taken or name in INDICES or not name.isidentifier():
            raise DerivationError("this name is taken, or is none", where=self.name, got=name)

    @typed
    def configure(self, *coordinates: Any) -> None:
        """Let the places of all particles be functions of ``coordinates`` (symbols), and of time.

        Their slopes are any vectors; forces of constraints do no virtual work along them. Raises
        `DerivationError` for what is no coordinate.
        """
        meanings = [self.scalars.get(s) for s in coordinates]
        for symbol, meaning in zip(coordinates, meanings, strict=True):
            if meaning is None or meaning.data[:1] != ("coordinate",):
                raise DerivationError("this is no coordinate", where=self.name, got=symbol)
        self.own.configured = tuple(str(m.data[1]) for m in meanings if m is not None)

    @typed
    def determine(
        self,
        equation: Equation,
        *unknowns: Any,
        reason: str = "law of the motion",
        **options: Any,
    ) -> Chain:
        """State a law or a constraint that motions keep from here on.

        ``equation``: the law; ``unknowns``: the coordinates (symbols) that obey it, whose highest rates
        stand linearly in it; ``reason``: in words; ``options``: see `state`. Raises `DerivationError` or
        another `InputError` where these rates cannot be had from it, or where it is at odds with a law
        before; nothing is kept then.
        """
        with self.kept(equation, unknowns):
            return self.law(equation, reason, **options)

    @contextmanager
    def kept(self, equation: Equation, unknowns: Sequence[Any]) -> Iterator[None]:
        """Return a context from which on ``unknowns``, coordinates, keep an ``equation``.

        Nothing is kept without any, and where an error is raised within. Raises `DerivationError` for
        what is no coordinate.
        """
        for symbol in unknowns:
            meaning = self.scalars.get(symbol)
            if meaning is None or meaning.data[:1] != ("coordinate",):
                expected = "a coordinate"
                raise DerivationError(
                    "a law determines coordinates", where=self.name, got=symbol, expected=expected
                )
        if not unknowns:
            yield
            return
        self.own.laws.append(Law(self._carried(equation), tuple(unknowns)))
        try:
            yield
        except InputError:
            self.own.laws.pop()
            raise

    @typed
    def rolls(self, body: str, contact: Term, *unknowns: Any, reason: str = "") -> Chain:
        """Let a body roll on what is at rest: where it touches, it does not move.

        ``body``: its name; ``contact``: the vector from its centre of mass to where it touches;
        ``unknowns``: see `determine`; ``reason``: in words. Raises `InputError` as that does, and for
        what is no body that turns.
        """
        row = self.own.bodies.get(body)
        if row is None or not row.frame:
            raise DerivationError("no body of this name turns", where=self.name, got=body)
        speed = add(velocity(body), cross(omega(row.frame), contact))
        words = reason or "it rolls: where it touches, it does not move"
        return self.determine(Equation(speed, zero(VECTOR)), *unknowns, reason=words)

    def _carry(self, term: Term) -> Term:
        """Return a term with bodies of its own spelt out and partial derivatives carried out."""
        return rules.slopes(self.scalars, self.own)(rules.spelt_out(self.own)(term))

    def _carried(self, equation: Equation) -> Equation:
        return replace(equation, left=self._carry(equation.left), right=self._carry(equation.right))

    def _worlds(self) -> Furnished:
        """Return worlds with what stands so far: the same as long as nothing new is said."""
        own = self.own
        named = (own.frames, own.points, own.bodies)
        key = (*(tuple(part.items()) for part in named), tuple(own.laws), own.configured)
        if self._drawn is None or self._drawn[0] != key:
            self._drawn = key, Furnished(own, {})
        drawn = self._drawn[1]
        for s, t in self.scalars.items():  # what is new was not there when laws were stated
            if s not in drawn.scalars:
                drawn.scalars[s] = self._carry(t)
        return drawn

    def _verified(self, equation: Equation, reason: str) -> str:
        where = f"{self.name}: {reason}"
        try:
            return self._decided(equation, self.assumed, where)
        except DerivationError as error:
            if error.what != FALSE:
                raise
            why = disagreement(self._carried(equation), self._worlds(), self.assumed)
            raise DerivationError(
                FALSE, where=where, got=error.got, expected=error.expected, hint=why
            ) from None

    def _decided(self, equation: Equation, assumed: Iterable[str], where: str) -> str:
        """Return how a line holds under assumptions. Raises `InputError` where it does not."""
        if equation.relation == ":=" and self.own.meaning(equation.left) == equation.right:
            return "definition"
        defines = equation.relation == ":="
        shown = equation if defines else self._carried(equation)
        drawn = self._worlds()
        known = self.scalars if defines else drawn.scalars
        with_own = drawn if self.own else worlds
        return verify(shown, assumed, known, where=where, drawn=with_own)

    def _needed(self, equation: Equation, reason: str, evidence: str) -> tuple[str, ...]:
        """Return a smallest set of the assumptions made so far under which a line holds.

        An exact identity is one under any of them.
        """
        relation = "=" if equation.relation == ":=" else equation.relation
        line = Equation(equation.left, equation.right, relation)

        def holds(names: Iterable[str]) -> None:
            found = evidence
            if found != IDENTITY:
                found = self._decided(line, names, f"{self.name}: {reason}")
            if found == IDENTITY and has_meaning(line, self.scalars):
                decide(line, names, self.scalars, count=1)

        return smallest(self.assumed, holds)

    @typed
    def assume(self, *names: str) -> None:
        """From here on, take ``names`` for granted. Raises `InputError` for conflicts."""
        closure((*self.assumed, *names))
        self.assumed = tuple(dict.fromkeys((*self.assumed, *names)))

    @typed
    def only(self, *names: str) -> None:
        """From here on, take ``names`` for granted and nothing else."""
        self.assumed = ()
        self.assume(*names)

    @typed
    def define(
        self, named: Term, reason: str, *, label: str = "", states: Iterable[str] = ()
    ) -> Chain:
        """State what defines a quantity of the vocabulary.

        ``named``: such as ``quantity("angular_momentum", "body", "O")``; ``reason``: in words;
        ``label``, ``states``: see `Chain.then`. Raises `InputError`, and `DerivationError` for a
        quantity without a definition.
        """
        meaning = self.own.meaning(named) or definition(named)
        if meaning is None:
            raise DerivationError("quantity without a definition", got=named.data)
        return self.state(
            Equation(named, meaning, ":="), reason, "definition", label=label, states=states
        )

    @typed
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

    @typed
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

    @typed
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
        checked = self._summed(equation, path, reason)
        evidence = self._verified(checked, reason)
        name = label or f"s{len(self.steps) + 1}"
        self._check_new(equation, name, kind)
        follows = path.sources(self.stated, f"{self.name}: {reason}") if path else ()
        step = Step(
            name,
            equation,
            reason,
            kind,
            tuple(states),
            self._needed(checked, reason, evidence),
            (path.evidence if path else "") or (SIGNS if checked != equation else evidence),
            follows,
            tuple(path.trace.words) if path else (),
        )
        self.steps.append(step)
        self.stated[equation] = name
        return Chain(self, step)

    def _summed(self, equation: Equation, path: Path | None, reason: str) -> Equation:
        """Return what is to be verified of a line; of a sign, that its left side is a sum of products."""
        products = path.trace.products if path else ()
        if not path or not products:
            return equation
        lines = [line for line, label in self.stated.items() if label in path.lines]
        check_signs(products, lines, self.scalars, f"{self.name}: {reason}")
        return Equation(equation.left, add(*(mul(*factors) for factors in products)))

    def suppose(self, equation: Equation, reason: str, **options: Any) -> Chain:
        """State a condition ``a >= 0``, which holds of some motions or bodies: of those that are meant.

        ``equation``: the condition; ``reason``: in words; ``options``: ``label``, ``states``, see `state`.
        Lines follow from it by `eom.terms.rules.inferences.signs`. Raises `DerivationError` for what is no
        such condition, or holds nowhere.
        """
        if equation.relation != ">=" or not equation.right.is_zero:
            expected = "something that is not negative, >= 0"
            raise DerivationError("this is no condition", where=self.name, expected=expected)
        if not self._is_possible(equation.left):
            raise DerivationError("no world meets this condition", where=self.name, got=reason)
        name = options.get("label") or f"s{len(self.steps) + 1}"
        self._check_new(equation, name, ASSUMPTION)
        states = tuple(options.get("states", ()))
        step = Step(name, equation, reason, ASSUMPTION, states, (), "supposed")
        self.steps.append(step)
        self.stated[equation] = name
        return Chain(self, step)

    def _is_possible(self, term: Term) -> bool:
        """Return whether a scalar is not negative in some world, whatever laws say of the motion there.

        Of letters that stand for no term nothing is known.
        """
        free, carried = Furnished(replace(self.own, laws=[]), {}), self._carry(term)
        scalars = {s: self._carry(t) for s, t in self.scalars.items()}
        free.scalars.update(scalars)
        if not _is_known(carried, scalars):
            return True
        found = (
            Evaluator(world, scalars).lowest(carried)
            for world in free(self.assumed, SIGN_WORLDS, field=RATIONALS)
        )
        return any(value >= 0 for value in found)

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

    @typed
    def start(self, term: Term) -> Chain:
        """Return a chain that transforms ``term``; it states nothing yet."""
        return Chain(self, Step("", Equation(term, term), ""))

    @typed
    def recall(self, label: str) -> Chain:
        """Return the chain of a step before by its ``label``. Raises `DerivationError` for unknown ones."""
        for step in self.steps:
            if step.label == label:
                return Chain(self, step)
        raise DerivationError("no step with this label", where=self.name, got=label)

    def chain_of(self, named: Any) -> Chain:
        """Return the chain of the line that defines a quantity or a symbol, ``named``: see `definition_of`.

        Raises `InputError` as that does.
        """
        return self.recall(self.stated[self.definition_of(named)])

    def definition_of(self, named: Any) -> Equation:
        """Return the line that defines a quantity or a symbol here.

        ``named``: a term, or a SymPy symbol. Raises `InputError`, a `DerivationError` where none does.
        """
        term = as_term(named)
        found = next((e for e in self.stated if e.left == term and e.relation == ":="), None)
        if found is None:
            raise DerivationError("nothing defines this here", where=self.name, got=named)
        return found

    def in_components(
        self, chain: Chain, frame: str, reason: str, *applied: Rule, **options: Any
    ) -> Chain:
        """Take components of both sides of ``chain`` in ``frame`` and push them inwards.

        ``reason``: in words; ``applied``: rules for the right side; ``options``: see `Chain.both`.
        """
        inwards = rules.components(frame)
        return chain.both(reason, lambda t: inwards(column(t, frame)), inwards, *applied, **options)

    @typed
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
            self.own.copy(),
            dict(self.letters),
        )
