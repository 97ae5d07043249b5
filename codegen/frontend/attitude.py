"""What a compiled system knows of its bodies: stated by the system, over the slots of its arrays.

`Stated` is what `eom.system.BodyAttitude` says, lowered to a program and led through every pass that
changes slots; the system has proved it. `attitude_of` makes of it what the methods on the group of
rotations need: the one quaternion q, scalar first, and the body with

    dq/dt = q (0, omega - C(q) n)/2,   J d omega/dt = -omega x J omega + tau,   C(q) v = q* v q.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from codegen.frontend.lower import lowering_of
from codegen.ir.fold import ALGEBRAIC
from codegen.ir.passes import PAIRS, Slot, dependence, needed, prune, substitute
from codegen.ir.program import Builder, Program, bindings
from eom.system import BodyAttitude, System

NONE, QUATERNION, DCM = "none", "quaternion", "dcm"
OMEGA, FRAME, INERTIA, TORQUE, CONSTANT_RATES = (
    "omega", "frame", "inertia", "torque", "constant rates",
)  # fmt: skip
Triple = tuple[int, int, int]
Four = tuple[int, int, int, int]


@dataclass(frozen=True)
class Stated:
    """A body among the states, see `eom.system.BodyAttitude`.

    ``coordinates``: numbers of the states, -1 for those that are left out; ``sequence``: axes of angles, 0
    to 2. ``directions``: triples of states that are fixed directions, columns of direction cosines among
    them. ``values``: groups `OMEGA`, `FRAME`, `INERTIA` (six entries, or none) and `TORQUE`.
    """

    kind: str
    coordinates: tuple[int, ...]
    sequence: tuple[int, ...]
    unspun: bool
    directions: tuple[Triple, ...]
    values: Program

    @property
    def omega(self) -> tuple[int, ...]:
        """For each component of the angular velocity the number of the state that it is; -1 for others."""
        entries = [self.values.instructions[k] for k in self.values.results[OMEGA]]
        return tuple(e.slot if e.op == "state" else -1 for e in entries)

    @property
    def states(self) -> set[int]:
        """All states that are a part of it."""
        return {k for k in (*self.omega, *self.coordinates) if k >= 0}.union(*self.directions)

    def reads(self, group: str, kind: str = "state") -> set[int]:
        """Return the slots of leaves that a group of values depends on.

        Parameters
        ----------
        group : str
            `OMEGA`, `FRAME`, `INERTIA` or `TORQUE`.
        kind : str, default "state"
            Of leaf: ``state``, ``parameter``, ``input`` or ``time``.

        Returns
        -------
        set of ints
            Counted from 0 among those of the kind.
        """
        return {slot for _, slot in dependence(self.values, group, kind)}


def stated_of(system: System) -> tuple[Stated, ...]:
    """Return what a system states of its bodies, over its slots."""
    if not system.attitudes:
        return ()
    number = {q.symbol: k for k, q in enumerate(system.states)}
    lowering = lowering_of(system, ALGEBRAIC)
    used = {s for a in system.attitudes for e in a.expressions for s in e.free_symbols}
    for definition in reversed(system.definitions):
        if definition.symbol in used:
            used |= definition.expression.free_symbols
    for definition in system.definitions:
        if definition.symbol in used:
            lowering.define(definition)
    groups = {}
    for k, a in enumerate(system.attitudes):
        inertia = () if a.inertia is None else [a.inertia[i, j] for i, j in PAIRS]
        parts = {OMEGA: a.omega, FRAME: a.frame_rate, INERTIA: inertia, TORQUE: a.torque or ()}
        for name, values in parts.items():
            groups[f"{name} {k}"] = [lowering.lower(v, f"attitude {k + 1}") for v in values]
    program = lowering.b.program(groups)
    return tuple(
        _stated(a, k, program, [number.get(c, -1) for c in a.coordinates], number)
        for k, a in enumerate(system.attitudes)
    )


def _stated(
    a: BodyAttitude, k: int, program: Program, places: list[int], number: Mapping[object, int]
) -> Stated:
    own = {f"{name} {k}": name for name in (OMEGA, FRAME, INERTIA, TORQUE)}
    part = prune(program, own)
    values = replace(part, results={own[g]: r for g, r in part.results.items()})
    directions = [tuple(number[v] for v in d) for d in a.directions]
    return Stated(
        a.kind,
        tuple(places),
        tuple(axis - 1 for axis in a.sequence),
        a.unspun,
        tuple((x, y, z) for x, y, z in (*directions, *_columns(a.kind, places))),
        values,
    )


def _columns(kind: str, places: Sequence[int]) -> list[tuple[int, ...]]:
    """Return the columns of direction cosines that are whole."""
    columns = [tuple(places[k::3]) for k in range(3)] if kind == DCM else []
    return [c for c in columns if min(c) >= 0]


def moved(
    stated: Iterable[Stated], leaves: Mapping[Slot, Slot | Fraction], kinds: Collection[str]
) -> tuple[Stated, ...]:
    """Return what stays where slots of some ``kinds`` become ``leaves``, and the others of these go.

    Law: what holds of a system with its slots holds of it with numbers, or other slots, in their place, and
    of the part of it whose rates depend on no state that goes.
    """
    found = (_moved(a, leaves, kinds) for a in stated)
    return tuple(a for a in found if a is not None)


def _moved(
    a: Stated, leaves: Mapping[Slot, Slot | Fraction], kinds: Collection[str]
) -> Stated | None:
    def stays(group: str) -> bool:
        return all((kind, slot) in leaves for kind in kinds for slot in a.reads(group, kind))

    def place(k: int) -> int:
        new = leaves.get(("state", k))
        return new[1] if isinstance(new, tuple) else -1

    if not stays(OMEGA):
        return None
    body = stays(INERTIA) and stays(TORQUE)
    groups = [OMEGA, FRAME, INERTIA, TORQUE]
    results = {g: a.values.results[g] if body or g in (OMEGA, FRAME) else () for g in groups}
    found = replace(
        a,
        coordinates=tuple(map(place, a.coordinates)),
        directions=tuple(
            (place(x), place(y), place(z))
            for x, y, z in a.directions
            if min(place(x), place(y), place(z)) >= 0
        ),
        values=substitute(replace(a.values, results=results), leaves),
    )
    if found.kind == QUATERNION and min(found.coordinates) < 0:
        return replace(found, kind=NONE, coordinates=())
    return found


@dataclass(frozen=True)
class Body:
    """A rigid body among the rates of a system.

    ``rates``: the state of each body rate, -1 where it is constant. ``values``: a program of the
    parameters alone, with groups `INERTIA` (J11, J12, J13, J22, J23, J33, in any unit),
    `CONSTANT_RATES` (of the rates that are constant, 0 for others) and `FRAME` (n, components in A).
    ``torque``: a program of the slots of the system, group `TORQUE`, components in the body frame,
    in the unit of J. ``of_rates``: components that depend on the body rates. ``zero``: those that
    vanish.
    """

    rates: Triple
    values: Program
    torque: Program
    of_rates: tuple[bool, bool, bool]
    zero: tuple[bool, bool, bool]


@dataclass(frozen=True)
class Attitude:
    """The quaternion among the states, scalar first, and the body that has this attitude, if any.

    ``others``: the states that are neither.
    """

    quaternion: Four
    body: Body | None
    others: tuple[int, ...]


def attitude_of(stated: Iterable[Stated], count: int) -> Attitude | None:
    """Return the attitude among ``count`` states, or None unless one quaternion is stated."""
    found = [a for a in stated if a.kind == QUATERNION]
    if len(found) != 1:
        return None
    a, b, c, d = found[0].coordinates
    body = _body(found[0])
    taken = {a, b, c, d, *(body.rates if body else ())}
    return Attitude((a, b, c, d), body, tuple(k for k in range(count) if k not in taken))


def _body(a: Stated) -> Body | None:
    """Return the body; None where J, n or a rate that is no state depends on more than parameters."""
    values, omega = a.values, a.omega
    known = bindings(values)
    steady = [k for k, s in zip(values.results[OMEGA], omega, strict=True) if s < 0]
    early = [*steady, *values.results[INERTIA], *values.results[FRAME]]
    if not values.results[INERTIA] or max(omega) < 0 or any(known[k] > 1 for k in early):
        return None
    torque = prune(values, [TORQUE])
    moving = dependence(torque, TORQUE)
    rates = {s for s in omega if s >= 0}
    p, q, r = (any((k, s) in moving for s in rates) for k in range(3))
    entries = [torque.instructions[k] for k in torque.results[TORQUE]]
    x, y, z = (e.op == "const" and not e.value for e in entries)
    i, j, k = omega
    return Body((i, j, k), _of_parameters(values, omega), torque, (p, q, r), (x, y, z))


def _of_parameters(values: Program, omega: Sequence[int]) -> Program:
    """Return inertia, rate of the frame and the body rates that are constant; see `Body`."""
    groups = (INERTIA, FRAME, OMEGA)
    wanted = sorted(needed(values, groups))
    b = Builder(values.rules)
    new: dict[int, int] = {}
    for k in wanted:
        new[k] = b.again(values.instructions[k], new)
    steady = [
        b.const(0) if s >= 0 else new[k] for k, s in zip(values.results[OMEGA], omega, strict=True)
    ]
    made = {g: [new[k] for k in values.results[g]] for g in (INERTIA, FRAME)}
    return prune(b.program({**made, CONSTANT_RATES: steady}))


def body_rates(b: Builder, states: Sequence[int], constants: Sequence[int]) -> list[int]:
    """Return the body rates over the slots of the system."""
    return [b.leaf("state", s) if s >= 0 else c for s, c in zip(states, constants, strict=True)]


def quaternions_of(stated: Iterable[Stated]) -> list[tuple[int, ...]]:
    """Return the states of every unit quaternion, scalar first."""
    return [a.coordinates for a in stated if a.kind == QUATERNION]
