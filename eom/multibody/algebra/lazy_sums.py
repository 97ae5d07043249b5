"""Sums of products that become SymPy expressions when they are named: the scalars of large derivations.

SymPy sorts and compares what it adds and multiplies; a recursion over 100 bodies makes 40,000 sums and
products, which nobody asked to be put in order. A node holds terms (coefficient, factors) and makes one
unevaluated sum when it gets a name or becomes a factor. Coefficients are exact.

What the intermediates of a recursion are called: letter, unit, meaning with the part's name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import sympy as sp

from eom.expressions import nodes, objects
from eom.fields import Operators
from eom.multibody.algebra.values import value
from eom.quantities import Definition, Quantity

Expr = Any
Number = int | Fraction
Term = tuple[Number, tuple[Expr, ...]]
"""A coefficient, not zero, and SymPy factors."""


class Node(Operators):
    """A sum of terms. Operands are nodes and exact numbers; zero is the number 0, never a node."""

    __slots__ = ("_made", "terms")

    def __init__(self, terms: tuple[Term, ...]) -> None:
        self.terms = terms
        self._made: Expr = None

    def __repr__(self) -> str:
        return f"Node({self.expression})"

    @property
    def expression(self) -> Expr:
        """The SymPy expression, made once."""
        if self._made is None:
            self._made = _sum(self.terms)
        return self._made

    def operated(self, op: str, *operands: Any) -> Any:
        """Return the result of an operation; a product of sums makes them factors."""
        return _OPERATIONS[op](*operands)

    def __add__(self, other: Any) -> Node:  # the two that recursions ask most, without a look-up
        return _added(self, other)

    def __mul__(self, other: Any) -> Any:
        return _multiplied(self, other)

    __radd__, __rmul__ = __add__, __mul__

    @property
    def one(self) -> Term:
        """The node as one term; a sum becomes a factor."""
        return self.terms[0] if len(self.terms) == 1 else (1, (self.expression,))


def _added(x: Node, y: Any) -> Node:
    if type(y) is Node:
        return Node(x.terms + y.terms)
    return Node((*x.terms, (y, ()))) if y else x


def _subtracted(x: Any, y: Any) -> Any:
    return x + -y if type(x) is Node else -y + x


def _multiplied(x: Node, y: Any) -> Any:
    c, f = x.one
    if type(y) is Node:
        d, g = y.one
        return Node(((c * d, f + g),))
    return Node(((c * y, f),)) if y else 0


def _divided(x: Any, y: Any) -> Any:
    if type(y) is not Node:
        return x * (Fraction(1) / y)
    c, f = y.one
    below = f[0] if len(f) == 1 else _product(1, f)
    return x * Node(((Fraction(1) / c, (sp.Pow(below, -1, evaluate=False),)),))


_OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": _added,
    "sub": _subtracted,
    "mul": _multiplied,
    "div": _divided,
    "neg": lambda x: Node(tuple([(-c, f) for c, f in x.terms])),
}


def _number(c: Number) -> Expr:
    return _rational(*c.as_integer_ratio())  # whole numbers are found at once, fractions are not


@lru_cache(maxsize=4096)
def _rational(p: int, q: int) -> Expr:
    return sp.Rational(p, q)


def _product(c: Number, factors: tuple[Expr, ...]) -> Expr:
    if len(factors) == 2 and factors[0] is factors[1]:
        factors = (sp.Pow(factors[0], 2, evaluate=False),)
    if c == 1 and len(factors) == 1:
        return factors[0]
    if not factors:
        return _number(c)
    return sp.Mul._from_args(factors if c == 1 else (_number(c), *factors), True)


def _sum(terms: tuple[Term, ...]) -> Expr:
    constants = [c for c, f in terms if not f]
    if len(constants) > 1:
        terms = (*(t for t in terms if t[1]), (sum(constants), ()))
    made = tuple([_product(c, f) for c, f in terms])
    return made[0] if len(made) == 1 else sp.Add._from_args(made, True)


def lifted(given: Any) -> Any:
    """Return a number as it is, a SymPy expression as a node."""
    if isinstance(given, int | Fraction):
        return given
    coefficient, factors = given.as_coeff_mul()
    exact = value(coefficient, "coefficient")
    if isinstance(exact, int | Fraction):
        return Node(((exact, tuple(factors)),))
    return Node(((1, (given,)),))


def plain(x: Any) -> Expr:
    """Return a node or a number as a SymPy expression."""
    return x.expression if type(x) is Node else _number(x)


class Naming:
    """Names for what a recursion keeps: definitions in order, equal values under one name.

    ``taken``: names that are in use already.
    """

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self.taken = set(taken)
        self.definitions: list[Definition] = []
        self._known: dict[tuple[tuple[Expr, ...], ...], list[tuple[tuple[Term, ...], Node]]] = {}
        """By the factors of their terms: coefficients, whose hashes take long, are compared."""
        self._atoms: dict[Expr, Any] = {}

    def atom(self, given: Any) -> Any:
        """Return a value of a description as a scalar; equal ones are the same object."""
        known = self._atoms.get(given)
        if known is None:
            known = self._atoms[given] = lifted(given)
        return known

    def sin(self, x: Any) -> Any:
        """Return the sine."""
        return self.atom(value(sp.sin(plain(x)), "sine"))

    def cos(self, x: Any) -> Any:
        """Return the cosine."""
        return self.atom(value(sp.cos(plain(x)), "cosine"))

    def sqrt(self, x: Any) -> Any:
        """Return the square root."""
        return Node(((1, (sp.Pow(plain(x), sp.S.Half, evaluate=False),)),))

    def keep(self, letter: str, part: str, suffix: str, value: Any) -> Any:
        """Return the value under a name of its own, unless it is a number or has a name."""
        if type(value) is not Node:
            return value
        terms = value.terms
        if len(terms) == 1:
            c, f = terms[0]
            if len(f) == 1 and f[0].is_Symbol and c in (1, -1):  # a set would hash fractions
                return self._atoms.get(f[0], value) if c == 1 else value
        same = self._known.setdefault(tuple([f for _, f in terms]), [])
        known = next((node for given, node in same if given == terms), None)
        if known is None:
            row = LETTERS[letter]
            name = self._free(f"{row.letter}_{part}{'_' * bool(suffix)}{suffix}")
            quantity = Quantity(sp.Symbol(name, real=True), row.unit, row.meaning.format(part))
            known = self.define(quantity, value)
            same.append((terms, known))
        return known

    def define(self, quantity: Quantity, value: Any) -> Node:
        """Return a value under the name of a quantity."""
        self.definitions.append(Definition(quantity, plain(value)))
        node = self._atoms[quantity.symbol] = Node(((1, (quantity.symbol,)),))
        return node

    def _free(self, name: str) -> str:
        """Return the name, with a number if it is taken."""
        found, count = name, 1
        while found in self.taken:
            count += 1
            found = f"{name}_n{count}"
        self.taken.add(found)
        return found


def used(definitions: Iterable[Definition], results: Iterable[Expr]) -> tuple[Definition, ...]:
    """Return the definitions that results need, in order."""
    needed = set(nodes(results))
    kept = []
    for definition in reversed(list(definitions)):
        if definition.symbol in needed:
            kept.append(definition)
            needed.update([a for a in objects(definition.expression) if a.is_Symbol])
    return tuple(reversed(kept))


class Row(NamedTuple):
    """Letter in names, unit, and meaning; ``{}`` is the body or joint."""

    letter: str
    unit: str
    meaning: str


LETTERS: dict[str, Row] = {
    "s": Row("s", "1", "sine of the angle of {}"),
    "c": Row("c", "1", "cosine of the angle of {}"),
    "place": Row("C", "1", "rotation to the axes of {}"),
    "r": Row("r", "m", "position of {}, in the axes of its parent"),
    "pose": Row("R", "1", "rotation from the ground to the axes of {}"),
    "position": Row("x", "m", "position of {}, in the axes of the ground"),
    "omega": Row("omega", "rad/s", "angular velocity of {}, in its axes"),
    "omega_before": Row("omega_p", "rad/s", "angular velocity of the parent, in the axes of {}"),
    "v": Row("v", "m/s", "velocity of the origin of {}, in its axes"),
    "square": Row("W", "rad^2/s^2", "products of the angular velocity of {}, less its square"),
    "difference": Row(
        "dW", "rad^2/s^2", "differences of the squares of the angular velocity of {}"
    ),
    "relative": Row("rho", "rad/s", "what the joint adds to the motion of {}"),
    "zeta": Row("zeta", "", "acceleration of {} by velocities alone"),
    "alpha_in": Row("beta", "rad/s^2", "angular acceleration of {} without its joint's"),
    "a_in": Row("b", "m/s^2", "acceleration of the origin of {} without its joint's"),
    "alpha": Row("alpha", "rad/s^2", "angular acceleration of {}, in its axes"),
    "a": Row("a", "m/s^2", "acceleration of the origin of {} less gravity, in its axes"),
    "mass": Row("m", "kg", "mass of {}, with what is fixed to it"),
    "h": Row("h", "kg m", "first moment of mass of {} about its origin"),
    "J": Row("J", "kg m^2", "inertia of {} about its origin"),
    "dJ": Row("dJ", "kg m^2", "difference of the moments of inertia of {}"),
    "gradient": Row("G", "1/s^2", "gradient of gravity, in the axes of {}"),
    "field": Row("g", "m/s^2", "gravity at the origin of {} by its gradient, in its axes"),
    "n": Row("n", "N m", "moment on {} about its origin"),
    "f": Row("f", "N", "force on {}"),
    "n_bias": Row("n", "N m", "moment on {} and what hangs on it, by velocities and loads"),
    "f_bias": Row("f", "N", "force on {} and what hangs on it, by velocities and loads"),
    "n_free": Row("n_free", "N m", "the same with the joint free, in the axes of {}"),
    "f_free": Row("f_free", "N", "the same with the joint free, in the axes of {}"),
    "I": Row("I", "kg m^2", "articulated inertia of {}: moment by angular acceleration"),
    "H": Row("H", "kg m", "articulated inertia of {}: moment by acceleration"),
    "M": Row("M", "kg", "articulated inertia of {}: force by acceleration"),
    "composite_I": Row("I", "kg m^2", "inertia of {} and all that hangs on it, about its origin"),
    "composite_H": Row("H", "kg m", "first moments of {} and all that hangs on it"),
    "composite_M": Row("M", "kg", "mass of {} and all that hangs on it"),
    "I_free": Row("I_free", "kg m^2", "articulated inertia handed on by {}"),
    "H_free": Row("H_free", "kg m", "articulated inertia handed on by {}"),
    "M_free": Row("M_free", "kg", "articulated inertia handed on by {}"),
    "turned_I": Row("I_t", "kg m^2", "inertia handed on by {}, in the axes of its parent"),
    "turned_H": Row("H_t", "kg m", "inertia handed on by {}, in the axes of its parent"),
    "turned_M": Row("M_t", "kg", "inertia handed on by {}, in the axes of its parent"),
    "turned_n": Row("n_t", "N m", "moment handed on by {}, in the axes of its parent"),
    "turned_f": Row("f_t", "N", "force handed on by {}, in the axes of its parent"),
    "shifted_H": Row("H_s", "kg m", "inertia handed on by {}, about the origin of its parent"),
    "U": Row("U", "", "force on {} by a unit acceleration of its joint"),
    "inverse": Row("D_inv", "", "reciprocal of the inertia that the joint of {} moves"),
    "ratio": Row("K", "", "U of {} divided by the inertia that its joint moves"),
    "drive": Row("e", "", "force at the joint of {} that is left for acceleration"),
    "acceleration": Row("udot", "", "acceleration of the joint of {}"),
    "p": Row("p", "kg m/s", "momentum of {}"),
    "L": Row("L", "kg m^2/s", "angular momentum of {} about its origin"),
    "tau": Row("Q", "", "applied force or torque at the joint {}"),
    "stretch": Row("stretch", "", "coordinate of {} less its rest value"),
    "line": Row("d", "m", "second point of {} from its first, in the axes of the ground"),
    "distance": Row("l", "m", "distance of the points of {}"),
    "tension": Row("T", "N/m", "force of {} divided by the distance"),
    "entry": Row("M", "", "entry of the mass matrix"),
    "ground_axis": Row("s", "", "axis of the joint of {}, in the axes of the ground"),
    "ground_omega": Row("omega_g", "rad/s", "angular velocity of {}, in the axes of the ground"),
    "ground_alpha": Row("alpha_g", "rad/s^2", "angular acceleration of {} by velocities alone"),
    "ground_v": Row("v_g", "m/s", "velocity of the origin of {}, in the axes of the ground"),
    "ground_a": Row("a_g", "m/s^2", "acceleration of the origin of {} by velocities alone"),
    "spot": Row("x", "m", "position of a point of {}, in the axes of the ground"),
    "spot_v": Row("v_g", "m/s", "velocity of a point of {}, in the axes of the ground"),
    "spot_a": Row("a_g", "m/s^2", "acceleration of a point of {} by velocities alone"),
    "direction": Row("e", "1", "direction of the constraint {}, in the axes of the ground"),
    "lean": Row("lean", "1", "cosine between axis and normal of {}"),
    "oblateness": Row("w", "1", "one less the square of half axis by radius of {}"),
    "lean_inverse": Row("lean_inv", "1", "reciprocal of the sine between axis and normal of {}"),
    "inverse_length": Row("length_inv", "1/m", "reciprocal of the length of {}"),
    "contact": Row("arm", "m", "arm from the centre to the point of contact of {}"),
    "row": Row("Jac", "", "coefficient of a speed in the constraint {}"),
    "offset": Row("b", "", "rate of the constraint {} without speeds"),
    "drift": Row("gamma", "", "second rate of the constraint {} by velocities alone"),
    "answer": Row("Y", "", "acceleration of a joint by a unit multiplier of {}"),
    "gram": Row("G", "", "how the constraint {} moves under multipliers"),
    "pivot": Row("D", "", "pivot of {}"),
    "pivot_inverse": Row("D_inv", "", "reciprocal of a pivot of {}"),
    "factor": Row("L", "", "entry of the triangular factor of {}"),
    "solved": Row("z", "", "intermediate of the solution for {}"),
    "lambda": Row("lambda", "", "multiplier of the constraint {}"),
    "follower": Row("W", "", "dependent speed by an independent one, constraint {}"),
    "followed": Row("w0", "", "dependent speed without independent ones"),
    "follower_drift": Row("g", "", "acceleration of a dependent speed by velocities alone"),
    "wrench": Row("Y", "", "force on {} by one unit of an inertial parameter"),
    "column": Row("F", "", "force on {} by a unit acceleration of a joint"),
}
"""Rows by what the recursions call them."""
