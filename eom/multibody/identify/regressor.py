"""Inverse dynamics as a matrix times the inertial parameters of the bodies: tau = Y(q, u, u') pi.

A body has ten parameters, about its origin and in its axes: the moments J_11 to J_33, the first moments
h_1 to h_3 and the mass m. The forces that accelerations take are linear in them; each column of Y is the
recursion with one of them put to 1 and the others to 0, so that zeros cost nothing (Atkeson, An and
Hollerbach, Int. J. Robotics Research 5(3), 1986, p. 101). Armatures, dampings and dry friction are linear,
too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from eom.errors import InputError, typed
from eom.multibody.algebra.lazy_sums import Naming, plain, used
from eom.multibody.algebra.scalars import Scalar, Work, add, is_zero, mul
from eom.multibody.algebra.spatial import (
    IDENTITY,
    ZERO,
    Inertia,
    SpatialVector,
    Vector,
    cross,
    dot,
    keep_vector,
    plus,
    times,
    transposed,
)
from eom.multibody.algebra.values import Value, is_number
from eom.multibody.model.bodies import Body
from eom.multibody.model.model import Tree
from eom.multibody.recursion.lumped_tree import BodyPlacement, Lift, LumpedTree, lumped_tree
from eom.multibody.recursion.motion import (
    STILL,
    Moving,
    Place,
    Scalars,
    Square,
    coordinate_rates,
    handed,
    keep_pair,
    motion,
    places,
    squared,
)
from eom.multibody.recursion.recursions import accelerated
from eom.quantities import TIME, Definition, Quantity
from eom.system import System

MOMENTS = tuple((i, j) for i in range(3) for j in range(i, 3))
_UNITS = {"J": "kg m^2", "h": "kg m", "m": "kg"}


@dataclass(frozen=True)
class Parameter:
    """A column of a regressor: what it is the factor of.

    ``letter``: J (kg m^2, about the origin of the body, in its axes, J12 = -integral of r1 r2 dm), h (kg
    m, mass times centre) or m (kg) of a body; ``armature``, ``damping`` or ``coulomb``, dry friction (N m
    or N), of a speed. ``owner``: the body, or the speed. ``suffix``: 11 to 33 of J, 1 to 3 of h.
    """

    name: str
    letter: str
    owner: str
    suffix: str = ""

    @property
    def unit(self) -> str:
        """The SI unit; of armature, damping and friction that depends on the speed."""
        return _UNITS.get(self.letter, "")


@dataclass(frozen=True)
class Regressor:
    """Y of a tree, in tau = Y pi: generalised forces (N m or N) linear in the parameters pi.

    Parameters
    ----------
    system : System
        Its states are those of the tree, its inputs the rates ``dot_<speed>`` of the speeds, its
        outputs the entries of Y that are not zero by structure.
    rows : tuple of str
        Names of speeds.
    columns : tuple of Parameter
        Parameters, in the order of pi; Y is (rows, columns).
    places : tuple of tuple of int, int
        (row, column) of each output.
    """

    system: System
    rows: tuple[str, ...]
    columns: tuple[Parameter, ...]
    places: tuple[tuple[int, int], ...]

    @property
    def expressions(self) -> Any:
        """Y as a SymPy matrix, every intermediate put in."""
        return sp.Matrix(
            self.array([self.system.expand(o.expression) for o in self.system.outputs])
        )

    def array(self, values: Sequence[Any]) -> list[list[Any]]:
        """Return Y as nested lists: ``values`` of the outputs in their order, others 0.

        Parameters
        ----------
        values : sequence
            Of the outputs, in their order.

        Returns
        -------
        list of list
            Y, a row a speed and a column a parameter; 0 where no output stands.
        """
        found = dict(zip(self.places, values, strict=True))
        return [
            [found.get((r, c), 0) for c in range(len(self.columns))] for r in range(len(self.rows))
        ]

    def parameters(self, tree: Tree) -> tuple[Value, ...]:
        """Return pi: the values that a ``tree`` gives the columns, in their order; no dry friction.

        Parameters
        ----------
        tree : Tree
            With numbers or symbols for its masses and inertias.

        Returns
        -------
        tuple of numbers or expressions
            pi: the value of each column, in their order; no dry friction.
        """
        return values_of(tree, self.columns)


def parameters_of(
    tree: Tree, *, armature: bool = False, damping: bool = False, coulomb: bool = False
) -> tuple[Parameter, ...]:
    """Return the columns: those of bodies from the ground outwards, then those of joints."""
    found: list[Parameter] = []
    for joint in tree.ordered:
        body = joint.child
        found += [
            Parameter(f"J_{body}_{i + 1}{j + 1}", "J", body, f"{i + 1}{j + 1}") for i, j in MOMENTS
        ]
        found += [Parameter(f"h_{body}_{k}", "h", body, str(k)) for k in (1, 2, 3)]
        found.append(Parameter(f"m_{body}", "m", body))
    speeds = [s.name for j in tree.ordered for s in j.speeds]
    for letter, wanted in (("armature", armature), ("damping", damping), ("coulomb", coulomb)):
        found += [Parameter(f"{letter}_{s}", letter, s) for s in speeds if wanted]
    return tuple(found)


def values_of(tree: Tree, columns: Sequence[Parameter]) -> tuple[Value, ...]:
    """Return the values that a tree gives the parameters, in their order: pi; it has no dry friction."""
    found: dict[tuple[str, str, str], Value] = {}
    for body in tree.bodies:
        J, h = about_origin(body)
        found[("m", body.name, "")] = body.mass
        found |= {("h", body.name, str(k + 1)): x for k, x in enumerate(h)}
        found |= {("J", body.name, f"{i + 1}{j + 1}"): J[i][j] for i, j in MOMENTS}
    for joint in tree.joints:
        for k, speed in enumerate(joint.speeds):
            found[("armature", speed.name, "")] = joint.armature[k]
            found[("damping", speed.name, "")] = joint.damping[k]
            found[("coulomb", speed.name, "")] = 0
    return tuple(found[(c.letter, c.owner, c.suffix)] for c in columns)


def about_origin(body: Body) -> tuple[list[list[Value]], list[Value]]:
    """Return the inertia about the origin and the first moment of mass, in the body's axes."""
    c, J = body.centre, body.central_inertia
    square = dot(c, c)

    def entry(i: int, j: int) -> Value:
        steiner = add(square if i == j else 0, -mul(c[i], c[j]))
        return add(J[i][j], mul(body.mass, steiner))

    return [[entry(i, j) for j in range(3)] for i in range(3)], [mul(body.mass, x) for x in c]


@typed
def regressor(
    tree: Tree, *, armature: bool = False, damping: bool = False, coulomb: bool = False
) -> Regressor:
    """Return Y of a tree as a system to compile; masses and inertias of the tree do not matter.

    Parameters
    ----------
    tree : Tree
        Its masses and inertias do not matter, its geometry does.
    armature : bool, default False
        Whether there are columns for inertias of motors (kg m^2 or kg).
    damping : bool, default False
        Whether there are columns for viscous friction (N m s or N s/m).
    coulomb : bool, default False
        Whether there are columns for dry friction (N m or N); at a speed u it takes the force
        coulomb sign(u), none at rest.

    Returns
    -------
    Regressor
        Y of tau = Y pi, as a system to compile. Gravity is in it; loads, springs, rotors, applied
        forces and motors are not.

    Raises
    ------
    InputError
        For prescribed motions, jets, a gradient of gravity and names in use.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 5, whose inverse dynamics is linear in
    the inertias; Atkeson, An and Hollerbach, Int. J. Robotics Research 5(3), 1986.

    Examples
    --------
    >>> from eom.multibody import Body, Joint, Tree
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> Y = regressor(Tree("pendulum", (Body("bob", 1),), (hinge,), gravity=(0, 0, -9.81)))
    >>> [Y.columns[c].name for _, c in Y.places]
    ['J_bob_11', 'h_bob_2', 'h_bob_3']
    """
    for joint in tree.joints:
        if joint.motion is not None:
            raise InputError(
                "prescribed motion has no place in a regressor", where=f"joint {joint.name!r}",
                hint="leave it out: accelerations are inputs here",
            )  # fmt: skip
    if tree.jets or any(not is_zero(x) for row in tree.gravity_gradient for x in row):
        what = "a jet" if tree.jets else "a gradient of gravity"
        raise InputError(
            f"{what} has no place in a regressor", where=f"tree {tree.name!r}",
            hint="leave it out: gravity is uniform here, and masses are constant",
        )  # fmt: skip
    coordinates = [c for j in tree.ordered for c in j.coordinates]
    speeds = [s for j in tree.ordered for s in j.speeds]
    states, inputs = (*coordinates, *speeds), [_acceleration(s) for s in speeds]
    work = Naming([*(q.name for q in (*states, *inputs)), TIME.name, *_symbols(tree)])
    q, u = ([work.atom(x.symbol) for x in group] for group in (coordinates, speeds))
    udot = [work.atom(i.symbol) for i in inputs]
    columns = parameters_of(tree, armature=armature, damping=damping, coulomb=coulomb)
    lumped = bones_of(tree, work.atom, work)
    signs = [work.atom(sp.sign(s.symbol)) for s in speeds]
    Y = entries(tree, lumped, (q, u, udot), columns, work, signs)
    rows = [s.name for s in speeds]
    found = {
        (r, c): y for c, column in enumerate(Y) for r, y in enumerate(column) if not is_zero(y)
    }
    rates = [*coordinate_rates(lumped, q, u, work), *udot]
    outputs = [_output(rows[r], columns[c], y) for (r, c), y in found.items()]
    system = _system(tree, states, inputs, rates, outputs, work)
    return Regressor(system, tuple(rows), columns, tuple(found))


def _symbols(tree: Tree) -> set[str]:
    """Return the names of symbols that geometry and gravity hold."""
    given = [*tree.gravity]
    for j in tree.joints:
        given += [*(x for a in j.axes for x in a), j.pitch]
        for place in (j.on_parent, j.on_child):
            given += [*place.position, *(x for row in place.rotation for x in row)]
    return {s.name for x in given if not is_number(x) for s in x.free_symbols}


def _acceleration(speed: Quantity) -> Quantity:
    symbol = sp.Symbol(f"dot_{speed.name}", real=True)
    return Quantity(symbol, speed.unit.replace("/s", "/s^2"), f"rate of {speed.name}")


def _output(row: str, column: Parameter, value: Any) -> Definition:
    symbol = sp.Symbol(f"Y_{row}_{column.name}", real=True)
    meaning = f"force at {row} by one unit of {column.name}"
    return Definition(Quantity(symbol, "", meaning), plain(value))


def _system(
    tree: Tree,
    states: Sequence[Quantity],
    inputs: Sequence[Quantity],
    rates: Sequence[Any],
    outputs: Sequence[Definition],
    work: Naming,
) -> System:
    expressions = [plain(r) for r in rates]
    definitions = used(work.definitions, [*expressions, *(o.expression for o in outputs)])
    free: set[Any] = set().union(*(e.free_symbols for e in expressions),
                       *(d.expression.free_symbols for d in (*definitions, *outputs)))  # fmt: skip
    known = {x.symbol for x in (*states, *inputs)} | {d.symbol for d in definitions}
    described = {p.symbol: p for p in tree.parameters}
    symbols = sorted(free - known, key=lambda s: str(s.name))
    return System(
        name=f"{tree.name}_regressor",
        states=tuple(states),
        rates=tuple(expressions),
        parameters=tuple(described.get(s, Quantity(s)) for s in symbols),
        inputs=tuple(inputs),
        definitions=definitions,
        outputs=tuple(outputs),
        numbers=tree.numbers,
    )


def bones_of(tree: Tree, lift: Lift, work: Work) -> LumpedTree:
    """Return a lumped_tree in which every body is a part that turns with it."""
    every = frozenset(j.name for j in tree.joints)
    return lumped_tree(tree, lift, work, [b.name for b in tree.bodies], apart=every)


def entries(
    tree: Tree,
    lumped: LumpedTree,
    state: tuple[Scalars, Scalars, Scalars],
    columns: Sequence[Parameter],
    work: Work,
    signs: Scalars = (),
) -> list[list[Scalar]]:
    """Return the columns of Y over any scalars; ``state``: coordinates, speeds and their rates.

    ``signs``: of the speeds, for columns of dry friction.
    """
    q, u, udot = state
    at_speed = {"armature": udot, "damping": u, "coulomb": signs}
    placed = places(lumped, q, work)
    moved = motion(placed, u, work)
    felt = accelerated(lumped, placed, moved, udot, work)
    units = {}
    for joint in tree.ordered:
        seat = lumped.seats[joint.child]
        units[joint.child] = _wrenches(
            work, placed[seat.part], moved[seat.part], felt[seat.part], seat
        )
    speeds = [s.name for j in tree.ordered for s in j.speeds]
    found: list[list[Scalar]] = []
    for column in columns:
        if column.letter in _UNITS:
            k = lumped.seats[column.owner].part
            wrench = units[column.owner][(column.letter, column.suffix)]
            found.append(_inwards(placed, k, wrench, len(u), work))
        else:
            found.append(_at_speed(speeds.index(column.owner), at_speed[column.letter]))
    return found


def _at_speed(s: int, values: Scalars) -> list[Scalar]:
    return [value if k == s else 0 for k, value in enumerate(values)]


def _inwards(
    placed: Sequence[Place], k: int, force: SpatialVector, size: int, work: Work
) -> list[Scalar]:
    """Return what the joints from a part to the ground feel of a force on it."""
    tau: list[Scalar] = [0] * size
    while k >= 0:
        part = placed[k].part
        for n, column in enumerate(placed[k].subspace):
            tau[part.speeds.start + n] = dot(column.six, force.six)
        if part.parent >= 0:
            force = keep_pair(
                work, ("wrench", "wrench"), part.name, handed(work, placed[k], force, STILL)
            )
        k = part.parent
    return tau


def _wrenches(
    work: Work, place: Place, moving: Moving, felt: SpatialVector, seat: BodyPlacement
) -> dict[tuple[str, str], SpatialVector]:
    """Return what accelerates a body of each unit parameter: at the part's origin, in its axes."""
    C, name = seat.rotation, place.part.name
    plainly = C == IDENTITY
    origin = plus(
        felt.linear, plus(cross(felt.angular, seat.origin), moving.square.times(seat.origin))
    )
    a = keep_vector(work, "wrench", name, times(C, origin))
    alpha = keep_vector(work, "wrench", name, times(C, felt.angular))
    square = moving.square if plainly else squared(work, name, times(C, moving.omega))
    found = {("m", ""): SpatialVector(ZERO, a)}
    for k, e in enumerate(IDENTITY):
        pull = plus(cross(alpha, e), square.times(e))
        found["h", str(k + 1)] = SpatialVector(cross(e, a), pull)
    for i, j in MOMENTS:
        found["J", f"{i + 1}{j + 1}"] = SpatialVector(
            _turning(work, place, square, alpha, i, j), ZERO
        )
    back = transposed(C)

    def at_part(wrench: SpatialVector) -> SpatialVector:
        f = times(back, wrench.linear)
        moment = plus(times(back, wrench.angular), cross(seat.origin, f))
        return keep_pair(work, ("wrench", "wrench"), name, SpatialVector(moment, f))

    return {key: at_part(wrench) for key, wrench in found.items()}


def _turning(work: Work, place: Place, square: Square, alpha: Vector, i: int, j: int) -> Vector:
    """Return E alpha + omega x E omega of the symmetric matrix E with ones at (i, j) and (j, i)."""
    E = [[int((r, c) in {(i, j), (j, i)}) for c in range(3)] for r in range(3)]
    unit = replace(place.part, inertia=Inertia(E, (ZERO,) * 3, (ZERO,) * 3))
    return plus(times(E, alpha), square.gyroscopic(work, unit))
