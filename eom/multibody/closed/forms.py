"""The closed form of a tree by one method, several of them side by side, and the system that they give.

Angles about parallel axes: their sums are the angles against the ground.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom.derivations.verification import DerivationError
from eom.errors import InputError, typed, unknown_name
from eom.errors import shown as shown_value
from eom.exact.identity import equal, vanishes
from eom.multibody.algebra.scalars import is_zero, negative, sub
from eom.multibody.algebra.spatial import Vector, plus, product, times, transposed
from eom.multibody.closed.bonds import Bonds, Bound, bonds, bound
from eom.multibody.closed.factors import quotient, shared_factor, solved_by_groups
from eom.multibody.closed.lagrange import Kane, Lagrange, NewtonEuler
from eom.multibody.closed.mechanism import Link, Mechanism, locked, mechanism
from eom.multibody.closed.polynomials import Scalar, terms_of
from eom.multibody.closed.readable import (
    KINDS,
    Part,
    Writer,
    by_motion,
    factor,
    parts,
)
from eom.multibody.model.bodies import Joint
from eom.multibody.model.constraints import Rolling
from eom.multibody.model.joints import QUATERNION, SEQUENCE_TO
from eom.multibody.model.model import Tree
from eom.multibody.model.names import inputs_of, singularities_of, symbols_of
from eom.quantities import TIME, Definition, Quantity, Singularity
from eom.system import System, as_expression
from eom.typeset.blocks import shown

Expr = Any

METHODS: dict[str, tuple[str, Callable[[Mechanism], Any]]] = {
    "lagrange": ("Lagrange", Lagrange),
    "kane": ("Kane", Kane),
    "newton-euler": ("Newton-Euler", NewtonEuler),
}
"""Titles and steps of the methods."""
EQUATIONS = "equations"
"""The style of the equations alone, as LaTeX."""


@dataclass(frozen=True)
class Term:
    """A term of one equation: ``coefficient`` times ``factor``.

    ``equation``: the speed that the equation belongs to. ``kind``: a row of
    `eom.multibody.closed.readable.KINDS`. ``factor``: an acceleration, a product of speeds, or 1.
    ``origins``: what each step of the method gave to the coefficient.
    """

    equation: Expr
    kind: str
    factor: Expr
    coefficient: Expr
    origins: tuple[tuple[str, Expr], ...] = ()

    @property
    def expression(self) -> Expr:
        """The term: its coefficient times its factor."""
        return self.coefficient * self.factor


LONGEST = 1_000
"""Products in all coefficients together, beyond which nobody would read a closed form."""


@dataclass(frozen=True)
class ClosedForm:
    """The equations of motion of a tree: the terms on the left add to those on the right (applied).

    Parameters
    ----------
    tree : Tree
        Whose equations they are.
    method : str
        The row of `METHODS`.
    coordinates : tuple of Quantity
        Those with equations.
    speeds : tuple of Quantity
        Those with equations.
    accelerations : tuple of expressions
        The speeds' rates, as symbols.
    kinematics : tuple of expressions
        Rates of the coordinates.
    prescribed : tuple of Definition
        What the symbols of prescribed coordinates, speeds and accelerations stand for.
    terms : tuple of Term
        Of all equations, generalised forces (N m or N).
    write : Writer
        How coefficients are written.

    Notes
    -----
    SI units; frames and signs are those of `Joint`. Where a speed is the rate of a coordinate, its
    equation is the one that Lagrange's method gives for it.
    """

    tree: Tree
    method: str
    coordinates: tuple[Quantity, ...]
    speeds: tuple[Quantity, ...]
    accelerations: tuple[Expr, ...]
    kinematics: tuple[Expr, ...]
    prescribed: tuple[Definition, ...]
    terms: tuple[Term, ...]
    steps: Any = field(repr=False, compare=False)
    """The method at work, whose intermediate results the pages show."""
    write: Writer = field(repr=False, compare=False)
    followers: tuple[Definition, ...] = ()
    """Speeds that constraints determine, over those with equations."""
    multipliers: tuple[Definition, ...] = ()
    """Forces and torques of constraints, over coordinates, speeds and accelerations."""
    placed: tuple[Definition, ...] = ()
    """Coordinates that closures give outright; they are put in wherever else they stood."""

    @property
    def bonds(self) -> Bonds | None:
        """The constraints, solved; None of a tree without."""
        return self.steps.bonds if isinstance(self.steps, Bound) else None

    @property
    def whole(self) -> Mechanism:
        """The mechanism with all its speeds, those that follow others too."""
        found: Mechanism = self.steps.mechanism if self.bonds is None else self.bonds.whole
        return found

    def of(self, equation: Expr, kind: str = "") -> tuple[Term, ...]:
        """Return the terms of one equation.

        Parameters
        ----------
        equation : expression
            The symbol of its speed.
        kind : str, optional
            Such as ``inertial`` or ``gravity``; all unless given.

        Returns
        -------
        tuple of Term
            Their sum is zero.
        """
        return tuple(t for t in self.terms if t.equation == equation and kind in {"", t.kind})

    @cached_property
    def mass_matrix(self) -> Expr:
        """The coefficients of the accelerations, symmetric, of shape (n, n) for n speeds."""
        known = {(t.equation, t.factor): t.coefficient for t in self.terms if t.kind == "inertial"}
        rows = [
            [known.get((u.symbol, a), sp.S.Zero) for a in self.accelerations] for u in self.speeds
        ]
        return sp.ImmutableMatrix(rows)

    def column(self, *kinds: str) -> Expr:
        """Return the sums of the terms of some ``kinds``, one a speed: a column (n, 1).

        Parameters
        ----------
        kinds : str
            Such as ``inertial`` or ``gravity``.

        Returns
        -------
        matrix
            The sums of the terms of these kinds, one a speed: (n, 1).
        """
        return sp.ImmutableMatrix(
            [
                sp.Add(*(t.expression for k in kinds for t in self.of(u.symbol, k)))
                for u in self.speeds
            ]
        )

    @property
    def forcing(self) -> Expr:
        """What the mass matrix times the accelerations equals: a column (n, 1)."""
        left = [k for k, kind in KINDS.items() if kind.left and k != "inertial"]
        right = [k for k, kind in KINDS.items() if not kind.left]
        return sp.ImmutableMatrix(self.column(*right) - self.column(*left))

    @cached_property
    def solved(self) -> tuple[Expr, ...]:
        """The accelerations, by Cramer's rule for each group of equations that hang together."""
        found = solved_by_groups(self.mass_matrix, self.forcing)
        return tuple(found[k] for k in range(len(self.speeds)))

    @cached_property
    def reactions(self) -> tuple[Definition, ...]:
        """The multipliers with the accelerations put in: forces and torques by the state alone.

        Raises `InputError` where one is no expression, as its mass matrix is singular everywhere.
        """
        known = dict(zip(self.accelerations, self.solved, strict=True))
        return tuple(
            Definition(d.quantity, sp.factor_terms(d.expression.xreplace(known)))
            for d in self.multipliers
        )

    @cached_property
    def common_factors(self) -> tuple[Expr, ...]:
        """What all terms of each equation share and what never vanishes: numbers and parameters."""
        moving = {q.symbol for q in (*self.coordinates, *self.speeds)} | {TIME}
        moving |= {*self.accelerations, *(d.symbol for d in self.prescribed)}
        moving |= {i.symbol for i in inputs_of(self.tree)}
        shared = (
            shared_factor([t.coefficient for t in self.of(u.symbol)], moving) for u in self.speeds
        )
        decimal = self.tree.numbers == "decimals"  # of which fractions would not be read again
        return tuple(f.as_coeff_Mul()[1] if decimal else f for f in shared)

    @cached_property
    def divided(self) -> tuple[Term, ...]:
        """The terms, each divided by the common factor of its equation."""
        factors = {u.symbol: f for u, f in zip(self.speeds, self.common_factors, strict=True)}
        return tuple(
            replace(t, coefficient=quotient(t.coefficient, factors[t.equation]), origins=())
            for t in self.terms
        )

    @cached_property
    def system(self) -> System:
        """The equations as a `System` with a mass matrix; right for small trees."""
        n = len(self.coordinates)
        rates = (*self.kinematics, *self.forcing)
        mass = sp.ImmutableMatrix(sp.diag(sp.eye(n), self.mass_matrix)) if self.speeds else None
        inputs = inputs_of(self.tree)
        defined = [d.symbol for d in self.prescribed]
        own = [q.symbol for q in (*self.coordinates, *self.speeds, *inputs)]
        everything = [*rates, *(mass if mass is not None else ())]
        everything += [d.expression for d in self.prescribed]
        free = set().union(*(e.free_symbols for e in everything)) - {*own, *defined, TIME}
        described = {p.symbol: p for p in self.tree.parameters}
        return System(
            name=self.tree.name,
            states=(*self.coordinates, *self.speeds),
            rates=rates,
            mass_matrix=mass,
            parameters=tuple(described.get(s, Quantity(s)) for s in sorted(free, key=str)),
            inputs=inputs,
            definitions=self.prescribed,
            singularities=(*self._singularities(), *self._dependent()),
            numbers=self.tree.numbers,
        )

    def _singularities(self) -> Iterator[Singularity]:
        """Yield those of the coordinates, under the names that were chosen."""
        for s in singularities_of(self.tree):
            named = self.whole.algebra.named
            yield replace(s, expression=named(s.expression), coordinate=named(s.coordinate))

    def _dependent(self) -> Iterator[Singularity]:
        """Yield where speeds no longer follow from the independent ones."""
        for x in self.bonds.divisors if self.bonds else ():
            meaning = "the independent speeds no longer determine the others; choose others"
            symbol = min(x.free_symbols & self.whole.rates.keys(), key=str)
            yield Singularity(x, symbol, meaning)

    def show(self, style: str = "text") -> str:
        """Return the derivation as a page, its ``style`` text, latex, markdown or html.

        Parameters
        ----------
        style : str, default "text"
            ``text``, ``latex``, ``markdown`` or ``html``.

        Returns
        -------
        str
            The derivation as a page.

        Raises
        ------
        InputError
            For other styles.
        """
        return str(shown(self, style))

    def latex(self) -> str:
        """Return the equations as LaTeX: one aligned display."""
        return str(shown(self, EQUATIONS))

    def _repr_markdown_(self) -> str:
        return self.show("markdown")


@dataclass(frozen=True)
class Row:
    """One term of the equations by every method.

    ``equation``, ``kind``, ``factor``: as of a `Term`. ``terms``: in the order of the methods, None where a
    method has no such term.
    """

    equation: Expr
    kind: str
    factor: Expr
    terms: tuple[Term | None, ...]

    @property
    def agrees(self) -> bool:
        """Whether all methods give the same coefficient, in exact randomised arithmetic."""
        found = [sp.S.Zero if t is None else t.coefficient for t in self.terms]
        return all(equal(found[0], other) for other in found[1:])


@dataclass(frozen=True)
class Comparison:
    """Closed forms of one tree by several methods, term by term: ``forms`` in the order of the methods.

    Parameters
    ----------
    forms : tuple of ClosedForm
        In the order of the methods.
    """

    forms: tuple[ClosedForm, ...]

    @cached_property
    def rows(self) -> tuple[Row, ...]:
        """The terms, in the order of the equations and of `KINDS`."""
        found: dict[tuple[Expr, str, Expr], dict[int, Term]] = {}
        for k, form in enumerate(self.forms):
            for t in form.terms:
                found.setdefault((t.equation, t.kind, t.factor), {})[k] = t
        count = range(len(self.forms))
        rows = (Row(*key, tuple(terms.get(k) for k in count)) for key, terms in found.items())
        places = {u.symbol: k for k, u in enumerate(self.forms[0].speeds)}
        kinds = list(KINDS)
        return tuple(sorted(rows, key=lambda r: (places[r.equation], kinds.index(r.kind))))

    @cached_property
    def differences(self) -> tuple[Row, ...]:
        """The terms on which the methods differ."""
        return tuple(row for row in self.rows if not row.agrees)

    def checked(self) -> Comparison:
        """Return the comparison. Raises `DerivationError` that names the first term that differs."""
        self._check_multipliers()
        for row in self.differences:
            got = {
                form.method: str(t.coefficient if t else 0)
                for form, t in zip(self.forms, row.terms, strict=True)
            }
            raise DerivationError(
                f"the methods differ in a term ({row.kind})",
                where=f"equation of {row.equation}, coefficient of {row.factor}",
                got="; ".join(f"{m}: {c}" for m, c in got.items()),
                expected="equal coefficients",
            )
        return self

    def _check_multipliers(self) -> None:
        for found in zip(*(form.multipliers for form in self.forms), strict=True):
            if not all(equal(found[0].expression, d.expression) for d in found[1:]):
                raise DerivationError(
                    "the methods differ in a multiplier",
                    where=found[0].symbol.name,
                    got="; ".join(str(d.expression) for d in found),
                )

    def show(self, style: str = "text") -> str:
        """Return the comparison as a page, its ``style`` text, latex, markdown or html.

        Parameters
        ----------
        style : str, default "text"
            ``text``, ``latex``, ``markdown`` or ``html``.

        Returns
        -------
        str
            The comparison as a page.

        Raises
        ------
        InputError
            For other styles.
        """
        return str(shown(self, style))

    def _repr_markdown_(self) -> str:
        return self.show("markdown")


@typed
def closed_form(
    tree: Tree,
    method: str = "lagrange",
    *,
    coordinates: Mapping[Expr, Expr] | None = None,
    names: Mapping[str, str] | None = None,
    independent: Sequence[str] = (),
    rates: bool = False,
) -> ClosedForm:
    """Return the equations of motion of a small tree as a person would write them.

    Parameters
    ----------
    tree : Tree
        A small one, of any joints; SI units.
    method : str, default "lagrange"
        A row of `METHODS`.
    coordinates : mapping of expression to expressions, optional
        Other coordinates in place of the joints', as expressions over new symbols
        (`absolute_angles`).
    names : mapping of str to str, optional
        Others for coordinates and speeds, by the names that they have; the rate of what is called
        phi is called phi_dot.
    independent : sequence of str, optional
        Names of the speeds that stay under constraints, by default those that leave the simplest
        equations.
    rates : bool, default False
        Also of joints whose speeds are components of velocities (planar, spherical and free ones;
        not in quaternions) the speeds are the rates of their coordinates.

    Returns
    -------
    ClosedForm
        The equations term by term, each with the step that it comes from. Under constraints,
        Lagrange's equations get multipliers and are combined so that these drop out, Kane's are
        those of nonholonomic speeds.

    Raises
    ------
    InputError
        For an unknown method, constraints that cannot be solved, and for a tree whose closed form
        nobody would read.

    Notes
    -----
    SI units; frames and signs are those of `Joint`.

    References
    ----------
    Goldstein, Classical Mechanics (2002), ch. 1; Kane and Levinson, Dynamics: Theory and
    Applications (1985); Wittenburg, Dynamics of Multibody Systems (2008).

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> m, l, g = sp.symbols("m l g", positive=True)
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> bob = Body("bob", mass=m, centre=(0, 0, -l))
    >>> pendulum = Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -g))
    >>> form = closed_form(pendulum, names={"q_hinge": "theta"})
    >>> form.mass_matrix[0], form.forcing[0]
    (l**2*m, -g*l*m*sin(theta))
    """
    return _forms(tree, (method,), Wishes(coordinates, names, tuple(independent), rates))[0]


@typed
def compare(
    tree: Tree,
    methods: Iterable[str] = tuple(METHODS),
    *,
    coordinates: Mapping[Expr, Expr] | None = None,
    names: Mapping[str, str] | None = None,
    independent: Sequence[str] = (),
    rates: bool = False,
) -> Comparison:
    """Return the closed forms of a tree by several methods, their agreement verified term by term.

    Parameters
    ----------
    tree : Tree
        As of `closed_form`.
    methods : iterable of str, optional
        Rows of `METHODS`.
    coordinates, names, independent, rates : mapping of expression to expressions, optional
        As of `closed_form`.

    Returns
    -------
    Comparison
        The forms side by side; that they agree is verified term by term, of multipliers of
        constraints, too.

    Raises
    ------
    DerivationError
        If two methods differ.
    InputError
        As `closed_form`.

    Notes
    -----
    Units, frames, signs and sources are those of `closed_form`.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> bob = Body("bob", mass=2, centre=(0, 0, -1))
    >>> found = compare(Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -10)))
    >>> [(row.kind, str(row.terms[0].expression)) for row in found.rows]
    [('inertial', '2*u_hinge_dot'), ('gravity', '20*sin(q_hinge)')]
    """
    wishes = Wishes(coordinates, names, tuple(independent), rates)
    return Comparison(_forms(tree, tuple(methods), wishes)).checked()


@dataclass(frozen=True)
class Wishes:
    """What a user chooses of a closed form; see `closed_form`."""

    coordinates: Mapping[Expr, Expr] | None = None
    names: Mapping[str, str] | None = None
    independent: tuple[str, ...] = ()
    rates: bool = False


def _forms(tree: Tree, methods: Sequence[str], wishes: Wishes) -> tuple[ClosedForm, ...]:
    """Return closed forms over the same geometry, written in the same way."""
    if not methods:
        raise InputError("no method is named", got="()", expected=", ".join(METHODS))
    for method in methods:
        if method not in METHODS:
            raise unknown_name("method", method, METHODS, f"tree {tree.name!r}")
    names = chosen_names(tree, wishes.names or {})
    given = mechanism(tree, wishes.coordinates, names, wishes.rates)
    write = Writer(given.algebra, runs(given))
    if not tree.constraints:
        if wishes.independent:
            raise InputError("independent speeds of a tree without constraints",
                             where=f"tree {tree.name!r}")  # fmt: skip
        return tuple(_form(given, m, METHODS[m][1](given), write) for m in methods)
    held = bonds(given, wishes.coordinates or {}, wishes.independent, write)
    return tuple(_form(held.mechanism, m, bound(held, METHODS[m][1]), write) for m in methods)


def chosen_names(tree: Tree, names: Mapping[str, str]) -> dict[Expr, Expr]:
    """Return symbols in place of those of coordinates and speeds.

    Raises `InputError` for what is no coordinate or speed, no name, and a name that is taken.
    """
    where = f"tree {tree.name!r}: names"
    known = {x.name: x for j in tree.ordered for x in (*j.coordinates, *j.speeds)}
    taken = {*known, *(s.name for s in symbols_of(tree)), *(i.name for i in inputs_of(tree))}
    taken = (taken | {TIME.name}) - names.keys()
    found: dict[Expr, Expr] = {}
    for old, new in names.items():
        if old not in known:
            raise unknown_name("coordinate or speed", str(old), known, where)
        if not isinstance(new, str) or not new.isidentifier():
            raise InputError(
                "not a name", where=where, got=shown_value(new), expected="letters, digits, _"
            )
        if new in taken:
            raise InputError("the name is taken", where=where, got=new)
        taken.add(new)
        found[known[old].symbol] = sp.Symbol(new, real=True)
    return found


def _form(given: Mechanism, method: str, steps: Any, write: Writer) -> ClosedForm:
    found = [replace(c, value=given.in_place(c.value)) for c in steps.contributions()]
    sorted_parts = parts(given, found)
    _refuse_unreadable(given, sorted_parts.values())
    speeds = [given.speeds[k] for k in given.free]
    put = steps.bonds.in_place if isinstance(steps, Bound) else given.in_place
    terms = []
    for key, part in sorted_parts.items():
        coefficient = write(part.coefficient)
        if isinstance(steps, Bound) and vanishes(coefficient):
            continue  # over a divisor zero has no normal form
        origins = tuple((label, write(x)) for label, x in part.origins)
        symbol = speeds[key.row].symbol
        terms.append(Term(symbol, key.kind, factor(given, key.factor), coefficient, origins))
    return ClosedForm(
        tree=given.tree,
        method=method,
        coordinates=given.variables,
        speeds=tuple(speeds),
        accelerations=tuple(given.accelerations[k] for k in given.free),
        kinematics=tuple(
            given.algebra.expression(put(given.rates.get(q.symbol, 0))) for q in given.variables
        ),
        prescribed=tuple(_prescribed(given)),
        terms=tuple(terms),
        steps=steps,
        write=write,
        **(_constraint_parts(steps, write) if isinstance(steps, Bound) else {}),
    )


def _constraint_parts(steps: Bound, write: Writer) -> dict[str, tuple[Definition, ...]]:
    """Return speeds that follow and multipliers, written."""
    held = steps.bonds
    pen = by_motion(held.whole, write)
    followers = (
        Definition(held.whole.speeds[k], pen(held.in_place(held.follower(k))))
        for k in held.dependent
    )
    known = {q.symbol: q for q in held.whole.variables}
    placed = tuple(Definition(known[q], write(x)) for q, x in held.placed.items())
    forces = zip(held.kept, steps.multipliers, strict=True)
    multipliers = (
        Definition(
            Quantity(
                sp.Symbol(f"lambda_{b.name}", real=True), b.component.unit, b.component.meaning
            ),
            pen(x),
        )
        for b, x in forces
    )
    return {"followers": tuple(followers), "multipliers": tuple(multipliers), "placed": placed}


def _refuse_unreadable(given: Mechanism, found: Iterable[Part]) -> None:
    size = sum(len(terms_of(part.coefficient)) for part in found)
    if size > LONGEST:
        raise InputError(
            "the closed form is too large to be read",
            where=f"tree {given.tree.name!r}",
            got=f"{size} products in its terms",
            expected=f"at most {LONGEST}",
            hint="angles against the ground may be shorter (absolute_angles; eom derive --absolute); "
            "derive(tree) names intermediates and has no such limit",
        )


def _prescribed(given: Mechanism) -> Iterable[Definition]:
    """Yield coordinates, speeds and accelerations that are prescribed."""
    numbers = {u.symbol: k for k, u in enumerate(given.speeds)}
    for joint in given.tree.ordered:
        if joint.motion is None:
            continue
        for k, (q, u) in enumerate(zip(joint.coordinates, joint.speeds, strict=True)):
            if locked(joint, k):
                continue
            place, speed = (replace(x, symbol=given.algebra.named(x.symbol)) for x in (q, u))
            number = numbers[speed.symbol]
            a = Quantity(given.accelerations[number], f"{u.unit}^2", f"rate of {speed.name}")
            yield Definition(place, as_expression(joint.motion.position[k]))
            yield Definition(speed, as_expression(joint.motion.rate[k]))
            yield Definition(a, as_expression(joint.motion.acceleration[k]))


@typed
def with_attitude(tree: Tree, attitude: str) -> Tree:
    """Return a tree whose spherical and free joints have angles of a sequence, for example 3-1-2.

    Raises `InputError` for another sequence, no such joint, and formulas over what is replaced.
    """
    turned = [j for j in tree.joints if j.row.attitude]
    if not turned:
        raise InputError("no joint has an attitude", where=f"tree {tree.name!r}", got=attitude)
    joints = tuple(replace(j, attitude=attitude) if j.row.attitude else j for j in tree.joints)
    return _reattached(tree, joints)


def _reattached(tree: Tree, joints: tuple[Joint, ...]) -> Tree:
    """Return a tree with joints of other attitudes. Raises `InputError` for formulas over what is lost."""
    found = replace(tree, joints=joints)
    lost = {q.symbol for j in tree.joints for q in j.coordinates}
    lost -= {q.symbol for j in joints for q in j.coordinates}
    used = sorted(str(s) for s in lost & set(symbols_of(tree)))
    if used:
        raise InputError(
            "formulas of the tree are over coordinates that are replaced",
            where=f"tree {tree.name!r}",
            got=", ".join(used),
        )
    return found


def in_angles(tree: Tree) -> tuple[Tree, tuple[str, ...]]:
    """Return a tree without quaternions, and the sequences of the angles in their place, in order.

    The last turn is about the axis of a wheel that rolls, or of a body of revolution, so that its angle
    drops out of the equations. Raises `InputError` for formulas over what is replaced.
    """
    turned = [j for j in tree.ordered if j.row.attitude and j.attitude == QUATERNION]
    chosen = {j.name: SEQUENCE_TO[_symmetric(tree, j)] for j in turned if j.motion is None}
    joints = (replace(j, attitude=chosen.get(j.name, j.attitude)) for j in tree.joints)
    return _reattached(tree, tuple(joints)), tuple(
        chosen[j.name] for j in turned if j.name in chosen
    )


def _symmetric(tree: Tree, joint: Joint) -> int | None:
    """Return the axis, in the joint's frame, that a body rolls about or is symmetric about; or None."""
    body, F = tree.body[joint.child], [list(row) for row in joint.on_child.rotation]
    for c in tree.constraints:
        if isinstance(c, Rolling) and c.body == body.name and c.axis is not None:
            along = times(F, c.axis)
            return next((k for k in range(3) if _alone(along, k)), None)
    J = product(F, product([list(row) for row in body.central_inertia], transposed(F)))
    centre = plus(times(F, body.centre), [negative(x) for x in times(F, joint.on_child.position)])
    diagonal = all(is_zero(J[i][j]) for i in range(3) for j in range(3) if i != j)
    for k in (2, 1, 0) if diagonal else ():
        i, j = (n for n in range(3) if n != k)
        if is_zero(sub(J[i][i], J[j][j])) and is_zero(centre[i]) and is_zero(centre[j]):
            return k
    return None


def _alone(v: Vector, k: int) -> bool:
    return all(is_zero(x) for n, x in enumerate(v) if n != k)


@typed
def absolute_angles(tree: Tree) -> dict[Expr, Expr]:
    """Return coordinates that measure revolute joints with parallel axes against the ground.

    Parameters
    ----------
    tree : Tree
        Whose revolute joints hang on each other about parallel axes.

    Returns
    -------
    dict of expression to expressions
        For `closed_form(tree, coordinates=...)`: each angle ``q_<joint>`` that hangs on another
        about the same direction, and that other, over new symbols ``theta_<joint>`` (rad), which
        are measured against the ground. Empty if there is none.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> upper = Joint("upper", "revolute", "ground", "a", axis="x")
    >>> lower = Joint("lower", "revolute", "a", "b", axis="x")
    >>> absolute_angles(Tree("double", (Body("a", 1), Body("b", 1)), (upper, lower)))
    {q_upper: theta_upper, q_lower: theta_lower - theta_upper}
    """
    given = mechanism(tree)
    found: dict[Expr, Expr] = {}
    for chain in _chains(given):
        total = sp.S.Zero
        for k in chain:
            joint = given.links[k].joint
            if joint.kind != "revolute" or joint.motion is not None:
                break
            q, theta = joint.coordinates[0].symbol, sp.Symbol(f"theta_{joint.name}", real=True)
            found.setdefault(q, theta - total)  # found before: on the way to another end
            total = theta
    return found


def runs(given: Mechanism) -> tuple[tuple[Expr, ...], ...]:
    """Return the angles about parallel axes along each path, from the ground out."""
    starts = _starts(given)
    found = []
    for chain in _chains(given):
        angles = [given.algebra.expression(given.coordinates[starts[k]]) for k in chain]
        if all(a.is_Symbol for a in angles):
            found.append(tuple(angles))
    return tuple(found)


def _starts(given: Mechanism) -> list[int]:
    starts, count = [], 0
    for link in given.links:
        starts.append(count)
        count += len(link.joint.coordinates)
    return starts


def _chains(given: Mechanism) -> Iterator[list[int]]:
    """Yield the longest chains of links that turn about parallel axes, each after its carrier."""
    before: dict[int, int] = {}
    for k, link in enumerate(given.links):
        if link.joint.row.spins:
            carrier = _carrier(given, k)
            if carrier is not None:
                before[k] = carrier
    ends = [k for k in before if k not in before.values()]
    for end in ends:
        chain = [end]
        while chain[-1] in before:
            chain.append(before[chain[-1]])
        yield chain[::-1]


def _carrier(given: Mechanism, k: int) -> int | None:
    """Return the next link towards the ground that turns, if it does so about a parallel axis."""
    link = given.links[k]
    axis = _back(link, _axis(link))
    k = link.parent
    while k >= 0:
        link = given.links[k]
        if link.joint.row.spins:
            return k if _same(axis, _axis(link)) else None
        if any(any(not is_zero(x) for x in column.angular) for column in link.subspace):
            return None
        axis = _back(link, axis)
        k = link.parent
    return None


def _axis(link: Link) -> Vector:
    return link.subspace[0].angular


def _back(link: Link, v: Vector) -> Vector:
    """Return components in the parent's axes; the joint's turn leaves its axis where it is."""
    return times(transposed(link.rotation), v)


def _same(a: Vector, b: Vector) -> bool:
    differences: list[Scalar] = [sub(x, y) for x, y in zip(a, b, strict=True)]
    return all(map(is_zero, differences))
