"""Base inertial parameters: the fewest combinations of parameters that the motion of a tree shows.

Columns of the regressor that are combinations of those before them (from the ground outwards; in a body J,
then h, then m) are left out, their parameters join the others. Which do is found by exact elimination at
random states, not by rules; the result is that of Gautier and Khalil, IEEE Trans. Robotics and Automation
6(3), 1990, p. 368, up to the choice of what stays. Coefficients are polynomials in symbols of the geometry.

Geometry of trees that is exactly orthonormal, where floats hold it to rounding.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import Any

import sympy as sp

from eom.errors import InputError, typed
from eom.exact.rings import ARITHMETIC, Evaluation
from eom.fields import Field, Operators, reduced
from eom.multibody.algebra.spatial import IDENTITY, Matrix, Vector, dot, product, transposed
from eom.multibody.algebra.values import Value, is_number
from eom.multibody.identify.regressor import Parameter, bones_of, entries, parameters_of
from eom.multibody.model.bodies import Body, Joint, Placement
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Tree
from eom.rotations import cosines, parameters, quaternion_product
from eom.system import as_expression

LARGEST = 10**6
"""Largest denominator of the half-angle tangents of a rotation that takes the place of a rounded one."""


def orthonormal(tree: Tree) -> Tree:
    """Return a tree whose rotations and axes in numbers are exactly orthonormal.

    Those that are, quarter turns above all, stay; others are replaced by rational ones within 1e-6,
    the same for the same numbers: angles that are no multiples of a right angle may change by that.
    """
    return replace(tree, joints=tuple(_joint(j) for j in tree.joints))


def symbols_of(tree: Tree) -> list[Any]:
    """Return the symbols of geometry and gravity, by name."""
    found: set[Any] = set()
    for x in [*tree.gravity, *(x for j in tree.joints for x in _given(j))]:
        if not is_number(x):
            found |= x.free_symbols
    return sorted(found, key=lambda s: str(s.name))


def _given(j: Joint) -> list[Value]:
    found = [*(x for a in j.axes for x in a), j.pitch]
    for place in (j.on_parent, j.on_child):
        found += [*place.position, *(x for row in place.rotation for x in row)]
    return found


def _joint(joint: Joint) -> Joint:
    return replace(
        joint,
        axis=unit(joint.axis),
        second_axis=unit(joint.second_axis),
        on_parent=_placement(joint.on_parent),
        on_child=_placement(joint.on_child),
    )


def _placement(place: Placement) -> Placement:
    return replace(place, rotation=rotation(place.rotation))


def unit(a: Vector) -> Vector:
    """Return a rational unit vector near one of numbers, by its projection from the far pole."""
    if not all(map(is_number, a)) or dot(a, a) == 1:
        return a
    k = max(range(3), key=lambda n: abs(a[n]))
    sign = 1 if a[k] > 0 else -1
    flat = [Fraction(Fraction(x) / (1 + abs(a[k]))).limit_denominator(LARGEST) for x in a]
    square = sum(x * x for n, x in enumerate(flat) if n != k)
    found: list[Any] = [2 * x / (1 + square) for x in flat]
    found[k] = sign * (1 - square) / (1 + square)
    return found


def rotation(C: Matrix) -> Matrix:
    """Return a rational rotation near one of numbers."""
    if not all(is_number(x) for row in C for x in row):
        return C
    if all(x == e for a, b in zip(product(C, transposed(C)), IDENTITY, strict=True)
           for x, e in zip(a, b, strict=True)):  # fmt: skip
        return C
    found = parameters(C)
    largest = Fraction(max(found, key=abs))
    q = [Fraction(p / largest).limit_denominator(LARGEST) for p in found]
    square = dot(q, q)
    return [[x / square for x in row] for row in cosines(q)]


Expr = Any

PRIME = 2**1279 - 1
"""Large enough for products of many doubles as fractions."""
FIELD = Field(PRIME)
DEGREES = 3
"""Highest degree of coefficients, as polynomials in symbols of the geometry, that is tried."""
LARGEST_DENOMINATOR = 10**9
"""Coefficients with larger ones are written as floats: the geometry is given by floats."""
SPARE = 6
"""Equations beyond the number of columns, so that chance does not lower the rank."""


@dataclass(frozen=True)
class BaseParameters:
    """The base parameters of a tree: the fewest combinations of inertial parameters that its motion shows.

    Parameters
    ----------
    combinations : mapping of str to expressions
        By the name of the column that each is the factor of: sums over symbols with the names of
        the columns.
    dropped : tuple of str
        Columns that are zero: parameters that the motion never shows.
    columns : tuple of Parameter
        Parameters, in the order of pi.

    Notes
    -----
    tau = sum of these columns of Y times the combinations. Units are those of `Regressor`.
    """

    combinations: Mapping[str, Expr]
    dropped: tuple[str, ...]
    columns: tuple[Parameter, ...]

    @property
    def count(self) -> int:
        """How many there are: the rank of the regressor."""
        return len(self.combinations)

    def values(self, given: Sequence[Any]) -> tuple[Any, ...]:
        """Return their values for values of all parameters.

        Parameters
        ----------
        given : sequence
            One a parameter, in the order of ``columns``.

        Returns
        -------
        tuple
            One a combination, in their order.

        Raises
        ------
        InputError
            For text in place of numbers and expressions, and for too few or too many.
        """
        if len(given) != len(self.columns):
            raise InputError(
                "one value a column is needed", got=len(given), expected=len(self.columns)
            )
        pairs = zip(self.columns, given, strict=True)
        known = {sp.Symbol(c.name, real=True): as_expression(v) for c, v in pairs}
        return tuple(e.xreplace(known) for e in self.combinations.values())


@typed
def base_parameters(
    tree: Tree,
    *,
    armature: bool = False,
    damping: bool = False,
    coulomb: bool = False,
    seed: int = 0,
) -> BaseParameters:
    """Return the base parameters of a tree; masses and inertias of the tree do not matter.

    Parameters
    ----------
    tree : Tree
        Its masses and inertias do not matter, its geometry does.
    armature, damping, coulomb : bool, default False
        Whether these are parameters of each joint, too.
    seed : int, default 0
        Of the random states at which the regressor is eliminated, exactly; the result does not
        depend on it but with negligible probability.

    Returns
    -------
    BaseParameters
        Combinations of parameters that motion depends on, and which drop out. Units are those of
        `Regressor`.

    Raises
    ------
    InputError
        For geometry that is no rational function of symbols, or gives coefficients of a degree
        above `DEGREES`.

    Notes
    -----
    Rotations and axes that floats hold only to rounding are taken as exactly orthonormal ones
    nearby.

    References
    ----------
    Gautier and Khalil, IEEE Trans. Robotics and Automation 6(3), 1990.

    Examples
    --------
    >>> from eom.multibody import Joint
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> pendulum = Tree("pendulum", (Body("bob", 1),), (hinge,), gravity=(0, 0, -9.81))
    >>> base_parameters(pendulum).combinations
    {'J_bob_11': J_bob_11, 'h_bob_2': h_bob_2, 'h_bob_3': h_bob_3}
    """
    tree = orthonormal(_bare(tree))
    columns = parameters_of(tree, armature=armature, damping=damping, coulomb=coulomb)
    symbols = symbols_of(tree)
    draw = random.Random(seed)  # noqa: S311 - reproducible points
    sample = _sample(tree, columns, symbols, draw)
    dependent = [c for c in range(len(columns)) if c not in sample.pivots]
    support = [(p, c) for k, p in enumerate(sample.pivots) for c in dependent if sample.rows[k][c]]
    found = _coefficients(tree, columns, symbols, sample, support, draw)
    named = [sp.Symbol(c.name, real=True) for c in columns]
    combinations = {
        columns[p].name: named[p] + sp.Add(*(f * named[c] for (q, c), f in found.items() if q == p))
        for p in sample.pivots
    }
    shown = {c for _, c in support}
    dropped = tuple(columns[c].name for c in dependent if c not in shown)
    return BaseParameters(combinations, dropped, columns)


def _bare(tree: Tree) -> Tree:
    """Return a tree of the same geometry and gravity, without what the columns do not depend on."""
    return replace(
        tree,
        bodies=tuple(Body(b.name, mass=1) for b in tree.bodies),
        joints=tuple(
            replace(j, stiffness=0, rest=0, damping=0, armature=0, force=0) for j in tree.joints
        ),
        loads=(),
        springs=(),
        rotors=(),
    )


@dataclass(frozen=True)
class _Sample:
    """A regressor at random states, reduced: with the values that symbols of the geometry had."""

    values: Mapping[Expr, int]
    rows: list[list[int]]
    pivots: list[int]

    def entry(self, pivot: int, column: int) -> int:
        return self.rows[self.pivots.index(pivot)][column]


def _sample(
    tree: Tree, columns: Sequence[Parameter], symbols: Sequence[Expr], draw: random.Random
) -> _Sample:
    values = {s: draw.randrange(2, PRIME) for s in symbols}
    rows: list[list[int]] = []
    while len(rows) < len(columns) + SPARE:
        work = Angles(draw)
        lumped = bones_of(tree, lambda x: _lifted(x, values, tree.name), work)
        if not lumped.speeds:
            break
        state = _state(tree, draw)
        signs = [draw.choice((-1, 1)) for _ in state[1]]
        Y = entries(tree, lumped, state, columns, work, signs)
        rows += [[residue(column[r]) for column in Y] for r in range(lumped.speeds)]
    reduced_rows, pivots = reduced(rows, FIELD)
    return _Sample(values, reduced_rows, pivots)


def _lifted(x: Any, values: Mapping[Expr, int], name: str) -> Any:
    """Return 0, 1, -1 as they are, other numbers and expressions as residues."""
    if is_number(x):
        return x if x in (0, 1, -1) else Residue(residue(x))
    return Residue(_Geometry(values, name).value(x))


class _Geometry(Evaluation):
    """Residues of expressions that are rational in symbols of the geometry of a tree."""

    rows, ring = ARITHMETIC, FIELD

    def __init__(self, values: Mapping[Expr, int], name: str) -> None:
        self.memo, self.name = dict(values), name

    def other(self, node: Expr) -> int:
        """Refuse what is not rational."""
        raise InputError(
            "base parameters need geometry that is rational in its symbols",
            where=f"tree {self.name!r}", got=node, hint="give angles and roots as numbers",
        )  # fmt: skip


def _state(tree: Tree, draw: random.Random) -> tuple[list[Any], list[Any], list[Any]]:
    """Return random coordinates (quaternions of norm 1), speeds and accelerations."""
    q: list[Any] = []
    for joint in tree.ordered:
        own: list[Any] = [Residue(draw.randrange(PRIME)) for _ in joint.coordinates]
        if joint.row.attitude and joint.attitude == QUATERNION:
            turn = own[-4:]
            norm = sum(x * x for x in turn)
            own[-4:] = [x / norm for x in quaternion_product(turn, turn)]
        q += own
    speeds = [s for j in tree.ordered for s in j.speeds]
    u, udot = ([Residue(draw.randrange(PRIME)) for _ in speeds] for _ in range(2))
    return q, u, udot


def _coefficients(
    tree: Tree,
    columns: Sequence[Parameter],
    symbols: Sequence[Expr],
    first: _Sample,
    support: Sequence[tuple[int, int]],
    draw: random.Random,
) -> dict[tuple[int, int], Expr]:
    """Return the coefficients as polynomials of the lowest degree that fits, and one sample more."""
    samples = [first]
    for degree in range(DEGREES + 1) if symbols else (0,):
        monomials = _monomials(symbols, degree)
        while len(samples) < len(monomials) + (1 if symbols else 0):
            samples.append(_sample(tree, columns, symbols, draw))
        found = _fitted(monomials, samples, support)
        if found is not None:
            return found
    raise InputError(
        "coefficients of base parameters are no small polynomials in the geometry",
        where=f"tree {tree.name!r}", got=", ".join(map(str, symbols)),
        hint="give some of these symbols as numbers",
    )  # fmt: skip


def _monomials(symbols: Sequence[Expr], degree: int) -> list[Expr]:
    return [
        sp.Mul(*c) for d in range(degree + 1) for c in combinations_with_replacement(symbols, d)
    ]


def _fitted(
    monomials: Sequence[Expr], samples: Sequence[_Sample], support: Sequence[tuple[int, int]]
) -> dict[tuple[int, int], Expr] | None:
    """Return polynomials through all samples; None where one of them has none with small fractions."""
    rows = [
        [*map(_Geometry(s.values, "").value, monomials), *(s.entry(p, c) for p, c in support)]
        for s in samples
    ]
    solved, pivots = reduced(rows, FIELD)
    n = len(monomials)
    if pivots != list(range(n)):
        return None
    found = {}
    for k, place in enumerate(support):
        numbers = [FIELD.fraction(solved[i][n + k]) for i in range(n)]
        if any(x is None for x in numbers):
            return None
        terms = [_number(x) * m for x, m in zip(numbers, monomials, strict=True) if x]
        found[place] = sp.Add(*terms)
    return found


def _number(x: Fraction) -> Expr:
    """Return a fraction; as a float if it comes from floats."""
    if x.denominator > LARGEST_DENOMINATOR:
        return sp.Float(float(x))
    return sp.Rational(x.numerator, x.denominator)


# -- residues as scalars of the recursions -------------------------------------------------------------


class Residue(Operators):
    """A number modulo `PRIME`, with the operators of a field; plain numbers may stand beside it."""

    __slots__ = ("value",)

    def __init__(self, value: int) -> None:
        self.value = value % PRIME

    def operated(self, op: str, *operands: Any) -> Residue:
        """Return the result of an operation in the field."""
        return Residue(FIELD.operated(op, *map(residue, operands)))


def residue(x: Any) -> int:
    """Return a scalar or an exact number as a residue."""
    if type(x) is Residue:
        return x.value
    return x if type(x) is int else int(FIELD.of(x))


class Angles:
    """Sines and cosines of residues: those of a random point of the circle, the same for the same angle."""

    def __init__(self, draw: random.Random) -> None:
        self._draw = draw
        self._known: dict[int, tuple[int, int]] = {}

    def _point(self, x: Any) -> tuple[int, int]:
        key = residue(x)
        if key not in self._known:
            self._known[key] = FIELD.circle(self._draw.randrange(2, PRIME))
        return self._known[key]

    def sin(self, x: Any) -> Residue:
        """Return the sine of an angle."""
        return Residue(self._point(x)[1])

    def cos(self, x: Any) -> Residue:
        """Return the cosine of an angle."""
        return Residue(self._point(x)[0])

    def sqrt(self, x: Any) -> Residue:
        """Refuse: residues have no roots of their own."""
        raise InputError("lengths of springs have no exact values", got=repr(x))

    def keep(self, letter: str, part: str, suffix: str, value: Any) -> Any:  # noqa: ARG002
        """Return the value."""
        return value
