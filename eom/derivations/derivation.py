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

from eom.derivations import standing
from eom.derivations.deciding import Deciding
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
    is_of_quantities,
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

        Parameters
        ----------
        reason : str
            Why, in words.
        applied : Rule
            The rules (`eom.terms.rules`), in order.
        label : str, optional
            By which the line is recalled.
        states : iterable of str, optional
            Equations of a lecture that it is.

        Returns
        -------
        Chain
            It goes on from the new right side.

        Raises
        ------
        DerivationError
            If nothing changes, or the line is false or undecided.
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

        Parameters
        ----------
        right : term or expression
            The new right side.
        reason : str
            Why, in words.
        label, states : str, optional
            See `then`.

        Returns
        -------
        Chain
            It goes on from the new right side.

        Raises
        ------
        InputError
            For what is no term.
        DerivationError
            As `then` raises it.
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

        Parameters
        ----------
        reason : str
            Why, in words.
        operation : callable
            What is done, from a term to a term.
        applied : Rule
            Rules for the new right side.
        label, states : str, optional
            See `then`.

        Returns
        -------
        Chain
            It goes on from the new right side.

        Raises
        ------
        DerivationError
            As `then` raises it.
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
        """State what follows from this line, and from others, by an inference.

        Parameters
        ----------
        reason : str
            Why, in words.
        inference : Inference
            A row of `eom.terms.rules.inferences`.
        others : Chain
            Further lines that it takes.
        label, states : str, optional
            See `then`.
        unknowns : sequence of symbols, optional
            Coordinates of which nothing was said yet, that keep this line from here on, as
            `Derivation.determine` says.

        Returns
        -------
        Chain
            It goes on from what follows.

        Raises
        ------
        DerivationError
            Where the inference does not apply, and as `then` raises it.
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

        Parameters
        ----------
        reason : str
            Why, in words.
        label, states : str, optional
            See `then`.

        Returns
        -------
        Chain
            It goes on from what was left.

        Raises
        ------
        DerivationError
            As `then` raises it.
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

    Parameters
    ----------
    name : str
        How it is called in commands and files.
    title : str
        Its heading.
    group : str
        The chapter that it belongs to.
    assumed : tuple of str, optional
        Names of assumptions (`eom.worlds.worlds.ASSUMPTIONS`) to begin with.
    scalars : dict of object to Term
        What symbols stand for so far, as terms.
    steps : list of Step
        What was stated so far, in order.
    own : Own
        Its frames, points, bodies and laws.
    stated : dict of Equation to str
        The labels of steps by what they state.
    letters : dict of object to str
        What other symbols are, in words.
    stands : dict of str to Term, str or None
        What results are, by name.

    Raises
    ------
    DerivationError
        For a line that is false or undecided, which is not kept.
    InputError
        For arguments of other types, and assumptions that are unknown or at odds.

    Notes
    -----
    Quantities are in SI units.
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
    stands: dict[str, Term | str | None] = field(default_factory=dict, init=False)
    _deciding: Deciding | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        self.only(*self.assumed)

    @property
    def _lines(self) -> Deciding:
        """What decides lines, with what is declared now: a note hands over all of that at once."""
        known = self._deciding
        if known is None or known.own is not self.own or known.scalars is not self.scalars:
            known = self._deciding = Deciding(self.own, self.scalars)
        return known

    @typed
    def constants(self, **meanings: str) -> list[Any]:
        """Return new symbols for numbers that do not change, by their names, with what they are in words.

        Parameters
        ----------
        meanings : str, optional
            What each is in words, by the name of its symbol.

        Returns
        -------
        list of symbols
            New ones, in the order of their names here.

        Raises
        ------
        InputError
            For a name that has another meaning.
        """
        return [self._named(n, quantity("scalar", n), words) for n, words in meanings.items()]

    @typed
    def coordinate(self, name: str, words: str, rates: int = 2) -> tuple[Any, ...]:
        """Return a new symbol for what changes with time, and those of its first ``rates`` rates.

        Parameters
        ----------
        name : str
            Of the symbol; its rates are called name_dot, name_ddot.
        words : str
            What it is.
        rates : int, default 2
            How many rates get symbols, too.

        Returns
        -------
        tuple of symbols
            The coordinate and its rates.

        Raises
        ------
        InputError
            For a name that has another meaning.
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

        Parameters
        ----------
        name : str
            Of the symbol.
        value : term or expression
            What it stands for, such as a partial derivative.
        words : str
            What it is.

        Returns
        -------
        symbol
            It stands for the scalar in every line from here on.

        Raises
        ------
        InputError
            For a name that has another meaning.
        """
        return self._named(name, as_term(value), words)

    @typed
    def frame(self, name: str, angle: Any, axis: int = 3, base: str = "I") -> None:
        """Let a new frame be turned from ``base`` about its axis ``axis`` through ``angle`` (rad).

        Parameters
        ----------
        name : str
            Of the new frame.
        angle : number, symbol or expression
            By which it is turned (rad), right-handed.
        axis : int, default 3
            1, 2 or 3, of ``base`` and of the new frame alike.
        base : str, default "I"
            The frame that it is turned from, the inertial one by default.

        Raises
        ------
        InputError
            For what is no scalar, no name or a name that is taken, as a `DerivationError`; for an
            axis other than 1, 2, 3.
        DerivationError
            For a name that is taken.
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

        Parameters
        ----------
        name : str
            Of the new point.
        place : Term
            Its position from the inertial origin (m), a vector.

        Raises
        ------
        DerivationError
            For a name that is taken or a place that is no vector.
        """
        self._new(name, {*self.own.points, *"OCP", "OI", "OA", "OB", "open", "body", "system"})
        if place.kind != VECTOR:
            raise DerivationError("the place of a point is a vector", where=name, got=place.kind)
        self.own.points[name] = place
        self._defined(position(name), f"where {label_words(name)} is")

    def _defined(self, named: Term, words: str) -> None:
        """State what a new quantity is; nothing of it is kept where it has no value."""
        try:
            for world in self._lines.worlds()(self.assumed, 1):
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

        Parameters
        ----------
        name : str
            Of the body, and of its centre of mass as a point.
        mass : number or expression
            In kg.
        place : Term
            The position of its centre of mass from the inertial origin (m).
        frame : str, optional
            Fixed in the body with its axes along the principal ones; none for a point mass.
        moments : sequence, optional
            Those of inertia about these axes through the centre of mass (kg m^2), three; none for a
            point mass.

        Raises
        ------
        InputError
            For what is no mass or moment.
        DerivationError
            For a name that is taken, and where frame and moments do not fit.

        Notes
        -----
        Its ``mass``, ``linear_momentum``, ``angular_momentum``, ``kinetic_energy`` and what
        `eom.terms.own.OF_BODIES` lists besides are quantities from here on.
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

        Parameters
        ----------
        coordinates : symbols
            Each with a rate.

        Raises
        ------
        DerivationError
            For what is no coordinate.

        Notes
        -----
        Their slopes are any vectors; forces of constraints do no virtual work along them.
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

        Parameters
        ----------
        equation : Equation
            The law.
        unknowns : symbols
            The coordinates that obey it, whose highest rates stand linearly in it.
        reason : str, default "law of the motion"
            Why it is a law, in words.
        options : object, optional
            ``label`` and ``states``, see `state`.

        Returns
        -------
        Chain
            The line, as a chain that goes on.

        Raises
        ------
        DerivationError
            Where these rates cannot be had from it, or where it is at odds with a law before;
            nothing is kept then.

        Notes
        -----
        Worlds obey it from here on, so that lines which follow from it hold.
        """
        with self.kept(equation, unknowns):
            return self.law(equation, reason, **options)

    @contextmanager
    def kept(self, equation: Equation, unknowns: Sequence[Any]) -> Iterator[None]:
        """Return a context from which on ``unknowns``, coordinates, keep an ``equation``.

        Parameters
        ----------
        equation : Equation
            What is kept.
        unknowns : sequence of symbols
            Coordinates that keep it; without any, nothing is kept.

        Returns
        -------
        context manager
            Where an error is raised within it, nothing is kept.

        Raises
        ------
        DerivationError
            For what is no coordinate.
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
        self.own.laws.append(Law(self._lines.carried(equation), tuple(unknowns)))
        try:
            yield
        except InputError:
            self.own.laws.pop()
            raise

    @typed
    def rolls(self, body: str, contact: Term, *unknowns: Any, reason: str = "") -> Chain:
        """Let a body roll on what is at rest: where it touches, it does not move.

        Parameters
        ----------
        body : str
            Its name.
        contact : Term
            The vector from its centre of mass to where it touches (m).
        unknowns : symbols
            See `determine`.
        reason : str, optional
            In words; there is a sentence of its own.

        Returns
        -------
        Chain
            The line that the velocity of the point that touches is zero.

        Raises
        ------
        DerivationError
            As `determine` raises it, and for what is no body that turns.
        """
        row = self.own.bodies.get(body)
        if row is None or not row.frame:
            raise DerivationError("no body of this name turns", where=self.name, got=body)
        speed = add(velocity(body), cross(omega(row.frame), contact))
        words = reason or "it rolls: where it touches, it does not move"
        return self.determine(Equation(speed, zero(VECTOR)), *unknowns, reason=words)

    def _verified(self, equation: Equation, reason: str) -> str:
        where, lines = f"{self.name}: {reason}", self._lines
        try:
            return lines.decided(equation, self.assumed, where)
        except DerivationError as error:
            if error.what != FALSE:
                raise
            why = disagreement(lines.carried(equation), lines.worlds(), self.assumed)
            raise DerivationError(
                FALSE, where=where, got=error.got, expected=error.expected, hint=why
            ) from None

    def _needed(self, equation: Equation, reason: str, evidence: str) -> tuple[str, ...]:
        """Return a smallest set of the assumptions made so far under which a line holds.

        An exact identity is one under any of them.
        """
        relation = "=" if equation.relation == ":=" else equation.relation
        line = Equation(equation.left, equation.right, relation)

        def holds(names: Iterable[str]) -> None:
            found = evidence
            if found != IDENTITY:
                found = self._lines.decided(line, names, f"{self.name}: {reason}")
            if found == IDENTITY and is_of_quantities(line, self.scalars):
                decide(line, names, self.scalars, count=1)

        return smallest(self.assumed, holds)

    @typed
    def assume(self, *names: str) -> None:
        """From here on, take assumptions for granted, too.

        Parameters
        ----------
        names : str
            Of assumptions that worlds know, such as ``constant_mass``.

        Raises
        ------
        InputError
            For unknown ones, and for conflicts.
        """
        closure((*self.assumed, *names))
        self.assumed = tuple(dict.fromkeys((*self.assumed, *names)))

    @typed
    def only(self, *names: str) -> None:
        """From here on, take these assumptions for granted and no other.

        Parameters
        ----------
        names : str
            As of `assume`.

        Raises
        ------
        InputError
            As `assume` raises it.
        """
        self.assumed = ()
        self.assume(*names)

    @typed
    def define(
        self, named: Term, reason: str, *, label: str = "", states: Iterable[str] = ()
    ) -> Chain:
        """State what defines a quantity of the vocabulary.

        Parameters
        ----------
        named : Term
            Such as ``quantity("angular_momentum", "body", "O")``.
        reason : str
            In words.
        label : str, optional
            By which the line is recalled.
        states : iterable of str, optional
            Equations of a lecture that it is.

        Returns
        -------
        Chain
            The line ``named := meaning``, as a chain that goes on.

        Raises
        ------
        InputError
            For a line that does not hold.
        DerivationError
            For a quantity without a definition.
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

        Parameters
        ----------
        symbol : symbol
            What stands for it from here on.
        meaning : Term
            A scalar, such as ``quantity("coordinate", "q")``.
        reason : str
            In words.
        options : object, optional
            ``label`` and ``states``, see `state`.

        Returns
        -------
        Chain
            The line that defines the symbol.

        Raises
        ------
        DerivationError
            For a symbol with another meaning, or one that its meaning holds.
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
        """Say what a symbol is that stands for no term, or a quantity that reasons alone speak of.

        Parameters
        ----------
        symbol : symbol or Term
            Such as a parameter of a shape; of words alone ``quantity("vector", "rho")``.
        words : str
            What it is.
        """
        self.letters[symbol] = words

    @typed
    def stands_for(self, name: str, term: Term | str | None) -> None:
        """Say what a result is, or a quantity of a system among the results: so pages write it.

        Parameters
        ----------
        name : str
            Of the result, of the quantity, or a letter in the words of a system, such as the axis
            ``a1`` where the derivation has another name for it.
        term : Term, str or None
            As a term; a vector stands for its magnitude. Or what it is in words; None of what the
            derivation does not speak of, which its page then leaves out.

        Notes
        -----
        `finish` verifies it, where all symbols of the result have a meaning, under what is then assumed.
        """
        self.stands[name] = term

    @typed
    def law(self, equation: Equation, reason: str, **options: Any) -> Chain:
        """State a law; it, too, has to hold in the worlds.

        Parameters
        ----------
        equation : Equation
            The law.
        reason : str
            In words.
        options : object, optional
            ``label`` and ``states``, see `state`.

        Returns
        -------
        Chain
            The line, as a chain that goes on.

        Raises
        ------
        DerivationError
            For a line that does not hold in all worlds.
        """
        return self.state(equation, reason, "law", **options)

    def given(self, equation: Equation, reason: str, **options: Any) -> Chain:
        """State what an assumption means as a formula; it has to hold in the worlds.

        Parameters
        ----------
        equation : Equation
            What the assumption means.
        reason : str
            In words.
        options : object, optional
            ``label`` and ``states``, see `state`.

        Returns
        -------
        Chain
            The line, as a chain that goes on.

        Raises
        ------
        DerivationError
            For a line that does not hold in the worlds of what is assumed.
        """
        return self.state(equation, reason, "assumption", **options)

    def show(self, equation: Equation, reason: str, *applied: Rule, **options: Any) -> Chain:
        """State an equation, both sides of which rules lead to the same.

        Parameters
        ----------
        equation : Equation
            The line.
        reason : str
            Why it holds, in words.
        applied : Rule
            The rules (`eom.terms.rules`), in order, for both sides.
        options : object, optional
            ``label`` and ``states``, see `state`.

        Returns
        -------
        Chain
            The line, as a chain that goes on.

        Raises
        ------
        DerivationError
            Where the rules do not lead both sides to the same.
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

        Parameters
        ----------
        equation : Equation
            The line.
        reason : str
            Why it holds, in words.
        kind : str, default "result"
            ``law``, ``definition``, ``assumption``, or ``result``.
        label : str, optional
            By which it is recalled.
        states : iterable of str, optional
            Equations of a lecture that it is.
        path : path, optional
            How a result was reached.

        Returns
        -------
        Chain
            The line, as a chain that goes on.

        Raises
        ------
        DerivationError
            For a line that is false, undecided, trivial or stated before, for a label that is taken
            and for other kinds.
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

        Parameters
        ----------
        equation : Equation
            A condition ``a >= 0``.
        reason : str
            In words.
        options : object, optional
            ``label`` and ``states``, see `state`.

        Returns
        -------
        Chain
            The condition, from which lines follow by `eom.terms.rules.inferences.signs`.

        Raises
        ------
        DerivationError
            For what is no such condition, or holds nowhere.
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
        free, carried = self._lines.worlds(lawful=False), self._lines.carry(term)
        if not _is_known(carried, free.scalars):
            return True
        found = (
            Evaluator(world, free.scalars).lowest(carried)
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
        """Return a chain that transforms ``term``; it states nothing yet.

        Parameters
        ----------
        term : Term
            The left side of what comes.

        Returns
        -------
        Chain
            It states nothing until it is told what the term equals.
        """
        return Chain(self, Step("", Equation(term, term), ""))

    @typed
    def recall(self, label: str) -> Chain:
        """Return the chain of a step before.

        Parameters
        ----------
        label : str
            Of the step.

        Returns
        -------
        Chain
            It goes on from the step's right side.

        Raises
        ------
        DerivationError
            For unknown ones.
        """
        for step in self.steps:
            if step.label == label:
                return Chain(self, step)
        raise DerivationError("no step with this label", where=self.name, got=label)

    def chain_of(self, named: Any) -> Chain:
        """Return the chain of the line that defines a quantity or a symbol, ``named``: see `definition_of`.

        Parameters
        ----------
        named : term or symbol
            A quantity or a symbol that is defined here, see `definition_of`.

        Returns
        -------
        Chain
            The line that defines it, as a chain that goes on.

        Raises
        ------
        InputError
            As `definition_of` raises it.
        """
        return self.recall(self.stated[self.definition_of(named)])

    def definition_of(self, named: Any) -> Equation:
        """Return the line that defines a quantity or a symbol here.

        Parameters
        ----------
        named : term or symbol
            A quantity, or a symbol that stands for one.

        Returns
        -------
        Equation
            The line ``named := meaning``.

        Raises
        ------
        InputError
            For what is neither.
        DerivationError
            Where no line defines it.
        """
        term = as_term(named)
        found = next((e for e in self.stated if e.left == term and e.relation == ":="), None)
        if found is None:
            raise DerivationError("nothing defines this here", where=self.name, got=named)
        return found

    def in_components(
        self, chain: Chain, frame: str, reason: str, *applied: Rule, **options: Any
    ) -> Chain:
        """Take components of both sides of a chain in a frame and push them inwards.

        Parameters
        ----------
        chain : Chain
            Between vectors or dyadics.
        frame : str
            Whose axes components are along.
        reason : str
            In words.
        applied : Rule
            Rules for the right side.
        options : object, optional
            ``label`` and ``states``, see `Chain.both`.

        Returns
        -------
        Chain
            The line between columns or matrices.

        Raises
        ------
        DerivationError
            As `Chain.both` raises it.
        """
        inwards = rules.components(frame)
        return chain.both(reason, lambda t: inwards(column(t, frame)), inwards, *applied, **options)

    @typed
    def check(self, equation: Equation, reason: str) -> None:
        """Verify a statement without adding it: that a result is what the steps lead to.

        Parameters
        ----------
        equation : Equation
            The statement.
        reason : str
            What it is, in words.

        Raises
        ------
        DerivationError
            For one that does not hold.
        """
        self._verified(equation, reason)

    def finish(self, **result: Any) -> Derived:
        """Return the derivation, finished.

        Parameters
        ----------
        result : object, optional
            What it gives by name, such as a system.

        Returns
        -------
        Derived
            Frozen; nothing can be stated any more.

        Raises
        ------
        DerivationError
            For a result that is not what it stands for.
        """
        for line in standing.claims(self.stands, result):
            if has_meaning(line, self.scalars):
                self.check(line, "what a result stands for")
        return Derived(
            self.name,
            self.title,
            self.group,
            tuple(self.steps),
            dict(self.scalars),
            result,
            self.own.copy(),
            dict(self.letters),
            dict(self.stands),
        )
