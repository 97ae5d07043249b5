"""What is known of a system's structure: which states are the attitude of which body, and its momentum.

A derivation states it, or the user does; `eom.proof` proves it where the `System` is made, and every pass
keeps of it what stays true. Nobody behind looks for it again.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from eom.errors import InputError, entries, is_text, shown
from eom.expressions import as_expression

Expr = Any
Triple = tuple[Expr, Expr, Expr]

NONE, QUATERNION, DCM = "none", "quaternion", "dcm"
COUNTS = {NONE: 0, QUATERNION: 4, DCM: 9}
"""Number of coordinates by kind; a sequence of angles has three."""
STILL: Triple = (sp.Integer(0),) * 3


@dataclass(frozen=True)
class BodyAttitude:
    """A body B among the states: its angular velocity, its attitude in a frame A, its inertia and torque.

    Parameters
    ----------
    omega : three expressions
        Angular velocity of B (rad/s), three components in B: states, or expressions.
    kind : str, default "none"
        ``quaternion`` (scalar first), ``dcm`` (C_BA, which takes components in A to components in
        B, row by row), a sequence of angles such as ``3-1-2``, or ``none``.
    coordinates : tuple of expressions, optional
        The states that are that attitude, in order; None for an angle or direction cosine that the
        system does without.
    frame_rate : three expressions, optional
        n, the angular velocity of A in the frame in which that of B is omega (rad/s), three
        components in A: coordinates move by omega - C_BA n.
    inertia : expression, optional
        J, (3, 3), in kg m^2, of J d(omega)/dt + omega x J omega = tau; both or none of J and tau,
        in any common unit.
    torque : three expressions, optional
        tau (N m), three components in B.
    directions : tuple of three expressions, optional
        Triples of states that are components in B of vectors with d(v)/dt = -omega x v, which stand
        still where omega is measured from.
    unspun : bool, default False
        Whether omega, J and tau have components along the axes before the last turn of the
        sequence, as for a body of revolution about the axis of that turn; the balance is then taken
        in these axes.
    body : str, optional
        Its name.

    Raises
    ------
    InputError
        For what are no expressions, or not three.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), ch. 2 and 3.
    """

    omega: Triple
    kind: str = NONE
    coordinates: tuple[Expr | None, ...] = ()
    frame_rate: Triple = STILL
    inertia: Expr | None = None
    torque: Triple | None = None
    directions: tuple[Triple, ...] = ()
    unspun: bool = False
    body: str = ""

    def __post_init__(self) -> None:
        keep = object.__setattr__
        for name in ("omega", "frame_rate", "torque"):
            given = getattr(self, name)
            if given is not None or name != "torque":
                keep(self, name, _triple(given, name))
        listed = entries(self.directions, "directions")
        keep(self, "directions", tuple(_triple(d, "direction") for d in listed))
        for c in (coordinates := tuple(entries(self.coordinates, "coordinates"))):
            if not (c is None or isinstance(c, sp.Symbol | AppliedUndef)):
                raise InputError("a coordinate is no state", got=shown(c), expected="a symbol")
        keep(self, "coordinates", coordinates)
        if self.inertia is not None:
            keep(self, "inertia", _matrix(self.inertia))
        if not (is_text(self.kind) and is_text(self.body) and isinstance(self.unspun, bool)):
            raise InputError(
                "kind and body of an attitude are texts, unspun is True or False",
                got=", ".join(map(shown, (self.kind, self.body, self.unspun))),
            )

    @property
    def sequence(self) -> tuple[int, ...]:
        """The axes of a sequence of angles, 1 to 3; nothing for other kinds."""
        return () if self.kind in COUNTS else tuple(map(int, self.kind.split("-")))

    @property
    def turns(self) -> bool:
        """Whether the frame that attitude is measured in turns."""
        return any(n != 0 for n in self.frame_rate)

    @property
    def expressions(self) -> tuple[Expr, ...]:
        """All expressions but for coordinates."""
        inertia = () if self.inertia is None else tuple(self.inertia)
        fixed = (v for direction in self.directions for v in direction)
        return (*self.omega, *self.frame_rate, *inertia, *(self.torque or ()), *fixed)

    def over(self, change: Callable[[Expr], Expr]) -> BodyAttitude:
        """Return the same with all its expressions changed.

        Parameters
        ----------
        change : callable
            From an expression to an expression.

        Returns
        -------
        BodyAttitude
            A coordinate that is no symbol then is left out.
        """
        inertia = None if self.inertia is None else self.inertia.applyfunc(change)
        return replace(
            self,
            omega=_each(change, self.omega),
            coordinates=tuple(
                None if c is None or not change(c).is_Symbol else change(c)
                for c in self.coordinates
            ),
            frame_rate=_each(change, self.frame_rate),
            inertia=inertia,
            torque=None if self.torque is None else _each(change, self.torque),
            directions=tuple(_each(change, d) for d in self.directions),
        )

    def within(self, states: Collection[Expr], known: Collection[Expr]) -> BodyAttitude | None:
        """Return what can be said of it over known symbols.

        Parameters
        ----------
        states : collection of expressions
            Those of them that are states.
        known : collection of expressions
            All symbols that may stand in it.

        Returns
        -------
        BodyAttitude
            None where omega is not known. Angles that others do without may be missing; of a
            quaternion nothing may be, of direction cosines any column.
        """

        def are(values: Iterable[Expr]) -> bool:
            return all(v.free_symbols <= set(known) for v in values)

        if not are(self.omega):
            return None
        whole = self.inertia is not None and are((*self.inertia, *(self.torque or ())))
        less = replace(
            self,
            coordinates=tuple(c if c in states else None for c in self.coordinates),
            inertia=self.inertia if whole else None,
            torque=self.torque if whole else None,
            directions=tuple(d for d in self.directions if set(d) <= set(states)),
        )
        if less.determined and are(less.frame_rate):
            return less
        return replace(less, kind=NONE, coordinates=(), frame_rate=STILL, unspun=False)

    @property
    def determined(self) -> bool:
        """Whether the rates of the coordinates that are there follow from these alone."""
        there = [c is not None for c in self.coordinates]
        if not any(there):
            return self.kind == NONE
        if self.kind == QUATERNION or self.turns:
            return all(there)
        if self.kind == DCM:
            columns = [there[k::3] for k in range(3)]
            return all(all(column) or not any(column) for column in columns)
        return there[1] and (self.unspun or there[2])


@dataclass(frozen=True)
class SequenceAngles:
    """Outputs that are the angles of a rotation sequence over a unit quaternion among the states.

    ``names``: of the three outputs, in the order of the turns; the first and the third are between -pi
    and pi, and jump by whole turns, which who has their values at many times can undo. ``sequence``:
    as ``3-2-1``. ``quaternion``: names of the four states, scalar first.
    """

    names: tuple[str, str, str]
    sequence: str
    quaternion: tuple[str, str, str, str]

    @property
    def axes(self) -> tuple[int, ...]:
        """The axes of the turns, 1 to 3."""
        return tuple(map(int, self.sequence.split("-")))

    @property
    def winding(self) -> tuple[str, str]:
        """Names of the two outputs that jump by whole turns."""
        return self.names[0], self.names[2]


def _matrix(given: Any) -> Expr:
    rows = given.tolist() if isinstance(given, sp.MatrixBase) else entries(given, "inertia")
    if not all(isinstance(row, Iterable) for row in rows):
        raise InputError("an inertia is a list of rows", got=shown(given))
    made = [[as_expression(v) for v in entries(row, "inertia")] for row in rows]
    if [len(row) for row in made] != [3, 3, 3]:
        raise InputError("the inertia has the wrong shape", got=shown(given), expected="3 x 3")
    return sp.ImmutableMatrix(made)


def _triple(given: Any, name: str) -> Triple:
    values = tuple(as_expression(v) for v in entries(given, name))
    if len(values) != 3:
        raise InputError(f"{name} has three components", got=len(values), expected=3)
    a, b, c = values
    return a, b, c


def _each(change: Callable[[Expr], Expr], values: Iterable[Expr]) -> Triple:
    a, b, c = (change(v) for v in values)
    return a, b, c


def kept(
    attitudes: Iterable[BodyAttitude], states: Collection[Expr], known: Collection[Expr]
) -> tuple[BodyAttitude, ...]:
    """Return what stays of attitudes where only ``known`` symbols do; see `BodyAttitude.within`."""
    found = (a.within(states, known) for a in attitudes)
    return tuple(a for a in found if a is not None)


def substituted(
    attitudes: Iterable[BodyAttitude], values: Mapping[Expr, Expr]
) -> tuple[BodyAttitude, ...]:
    """Return attitudes with symbols replaced."""
    return tuple(a.over(lambda e: e.xreplace(dict(values))) for a in attitudes)


POLYNOMIAL, RATIONAL, OTHER = "polynomial", "rational", "other"


def form_of(expression: Expr, variables: Collection[Expr]) -> str:
    """Return what an expression is in ``variables``: polynomial, rational or other, by its form.

    >>> x = sp.Symbol("x")
    >>> form_of(x**3 / (1 + x), {x}), form_of(sp.sin(x), {x})
    ('rational', 'other')
    """
    if expression.is_polynomial(*variables):
        return POLYNOMIAL
    return RATIONAL if expression.is_rational_function(*variables) else OTHER
