"""A body with symmetric rotors fixed in it.

Convention: J is the inertia of body and rotors together about the common centre of mass, rotors
held fast, in B; it holds their masses, transverse and axial moments. Rotor k turns at Omega_k
relative to the body about the unit vector a_k, so that h = J omega + sum of Js_k Omega_k a_k
(Hughes, Spacecraft Attitude Dynamics, 1986, ch. 6); p_k = Js_k (a_k . omega + Omega_k).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.errors import InputError, unknown_name
from eom.exact.algebra import explicit_rates, gather
from eom.exact.identity import vanishes
from eom.kinematics.coordinates import Attitude
from eom.kinematics.frames import FirstDerivative, Vector, first_derivative, unit_vector, vector
from eom.mass.inertia import physical
from eom.mechanics.freebody import TRANSVERSE
from eom.mechanics.rigidbody import (
    OMEGA,
    angular_momentum,
    momentum_outputs,
    principal_inertia,
    rotation,
    scalar,
    with_body,
    with_outputs,
)
from eom.quantities import Assumption, Definition, Quantity
from eom.system import System, as_expression

Expr = Any

OMEGA_DOT = tuple(sp.Symbol(f"omega_dot_{k}", real=True) for k in (1, 2, 3))


@dataclass(frozen=True)
class Rotor:
    """Rotor ``k`` (1, 2, ...) about the unit vector ``axis`` of B, driven as `DRIVES` says."""

    k: int
    axis: Vector
    drive: str

    @property
    def inertia(self) -> Quantity:
        """Moment of inertia about its axis, Js_k."""
        return self._quantity("Js", "kg m^2", "moment of inertia of rotor {} about its axis")

    @property
    def momentum(self) -> Quantity:
        """Absolute axial momentum p_k = Js_k (a_k . omega + Omega_k)."""
        return self._quantity(
            "p", "N m s", "angular momentum of rotor {} about its axis, in inertial space"
        )

    @property
    def speed(self) -> Quantity:
        """Rate relative to the body, Omega_k."""
        return self._quantity(
            "Omega", "rad/s", "rate of rotor {} about its axis, relative to the body", "\\Omega"
        )

    @property
    def torque(self) -> Quantity:
        """Torque of the motor on the rotor about its axis; the body feels its opposite."""
        return self._quantity("u", "N m", "motor torque of the body on rotor {}")

    def _quantity(self, letter: str, unit: str, meaning: str, latex: str = "") -> Quantity:
        sign_known = {"positive": True} if letter == "Js" else {"real": True}
        symbol = sp.Symbol(f"{letter}_{self.k}", **sign_known)
        return Quantity(symbol, unit, meaning.format(self.k), f"{latex or letter}_{self.k}")

    @property
    def turns_freely(self) -> bool:
        """Whether its axial momentum is a state; its speed is given otherwise."""
        return DRIVES[self.drive].state

    @property
    def relative_rate(self) -> Expr:
        """Omega_k over the states and parameters of the system."""
        return DRIVES[self.drive].relative_rate(self)

    @property
    def motor_torque(self) -> Expr:
        """The motor's torque where the axial momentum is a state."""
        return self.torque.symbol if DRIVES[self.drive].motor else sp.Integer(0)


def _from_momentum(rotor: Rotor) -> Expr:
    return rotor.momentum.symbol / rotor.inertia.symbol - rotor.axis.dot(OMEGA)


@dataclass(frozen=True)
class Drive:
    """What is known of a rotor: whether p_k is a state, a motor torque acts, and what Omega_k is."""

    state: bool
    motor: bool
    relative_rate: Callable[[Rotor], Expr]


DRIVES: Mapping[str, Drive] = {
    "motor": Drive(True, True, _from_momentum),
    "free": Drive(True, False, _from_momentum),
    "constant": Drive(False, False, lambda rotor: rotor.speed.symbol),
    "locked": Drive(False, False, lambda rotor: sp.Integer(0)),
}
"""Motor torque u_k as an input; no torque about the axis; constant Omega_k; Omega_k = 0."""


def rotor_momentum_rate(axial: Expr, omega_dot: Sequence[Expr], p_dot: Expr) -> FirstDerivative:
    """Return d/dt of the momentum of a rotor about b1 with p_1 = ``axial``, by transport theorem.

    The moments across the axis are both It, in B as in the rotor. The component along b1 is p_dot
    alone, so that p_dot is the motor torque: symmetry makes the transport term vanish there.
    """
    b1 = unit_vector("B", 1)
    across = OMEGA - b1.scaled(OMEGA.dot(b1))
    h = across.scaled(TRANSVERSE) + b1.scaled(axial)
    moving = dict(zip((*OMEGA.components, axial), (*omega_dot, p_dot), strict=True))
    return first_derivative(h, OMEGA, moving)


def _axial(rotor: Rotor) -> Expr:
    """Return the rate of the axial momentum of a rotor."""
    return _axial_rate(rotor.motor_torque)


def _axial_rate(torque: Expr) -> Expr:
    """Solve the rotor's axial balance for the rate of its axial momentum."""
    p, p_dot = sp.symbols("p p_dot", real=True)
    balance = rotor_momentum_rate(p, OMEGA_DOT, p_dot).total.components[0] - torque
    ((rate,),) = sp.linsolve([sp.expand(balance)], [p_dot])
    return rate


def momentum(J: Expr, rotors: Sequence[Rotor]) -> Vector:
    """Return h = J omega + sum of Js_k Omega_k a_k (N m s), components in B, over the states."""
    h = angular_momentum(J, OMEGA)
    for rotor in rotors:
        h = h + rotor.axis.scaled(rotor.inertia.symbol * rotor.relative_rate)
    return h.map(lambda c: gather(c, _states(rotors)))


def kinetic_energy(J: Expr, rotors: Sequence[Rotor]) -> Expr:
    """Return T = (omega . h + sum of p_k Omega_k)/2 (J): the body's part, and each rotor's spin."""
    energy = OMEGA.dot(momentum(J, rotors))
    for r in rotors:
        energy += r.inertia.symbol * (r.axis.dot(OMEGA) + r.relative_rate) * r.relative_rate
    return gather(energy / 2, _states(rotors))


def _states(rotors: Sequence[Rotor]) -> tuple[Expr, ...]:
    return (*OMEGA.components, *(r.momentum.symbol for r in rotors if r.turns_freely))


def gyrostat(
    n: int = 1,
    *,
    axes: Sequence[Sequence[Expr]] | None = None,
    drives: Sequence[str] | str = "motor",
    inertia: tuple[Expr, Sequence[Quantity]] | None = None,
    attitude: Attitude | None = None,
    parameters: Sequence[Quantity] = (),
    name: str = "gyrostat",
    title: str = "Torque-free body with rotors",
) -> System:
    """Derive a torque-free body with ``n`` rotors; see the module for the meaning of J and h.

    ``axes``: unit vectors in B, numbers or expressions of ``parameters``; b1, b2, b3 if None.
    ``drives``: a key of `DRIVES` for all rotors or for each. ``inertia``: J, rotors held fast, as
    for `eom.mechanics.rigidbody.rigid_body`; principal axes if None. States: omega_1..3 (rad/s, in B), p_k
    (N m s) of rotors on a motor or free, then the coordinates of ``attitude``. The mass matrix is
    J less Js_k a_k a_k^T for every p_k; none where that is diagonal. Raises `InputError` for axes
    that are no unit vectors, unknown drives, and numbers of them that differ from ``n``.

    >>> gyrostat(1, drives="free").invariant_names
    ('T', 'T_omega', 'H', 'rotor_rate_1')
    """
    rotors = _rotors(n, axes, drives)
    J, moments = inertia or principal_inertia()
    h = momentum(J, rotors)
    mass, accelerations = _equations(h, rotors)
    free = [r for r in rotors if r.turns_freely]
    states = (
        *(
            Quantity(w, "rad/s", f"angular velocity about b{k}", f"\\omega_{k}")
            for k, w in enumerate(OMEGA.components, 1)
        ),
        *(r.momentum for r in free),
        *(attitude.coordinates if attitude else ()),
    )
    known = (r.inertia for r in rotors if r.drive != "locked")
    speeds = (r.speed for r in rotors if r.drive == "constant")
    system = System(
        name=name,
        title=title,
        states=states,
        rates=(*accelerations, *map(_axial, free), *(attitude.rates(OMEGA) if attitude else ())),
        mass_matrix=mass and sp.ImmutableMatrix(sp.diag(mass, sp.eye(len(states) - 3))),
        parameters=(*moments, *known, *speeds, *parameters),
        inputs=tuple(r.torque for r in free if r.drive == "motor"),
        definitions=_definitions(h),
        singularities=attitude.singularities if attitude else (),
        assumptions=_assumptions(J, h, attitude),
    )
    system = with_body(system, *_body(h, rotors), attitude)
    return with_outputs(system, _outputs(J, rotors, system, attitude))


def _rotors(
    n: int, axes: Sequence[Sequence[Expr]] | None, drives: Sequence[str] | str
) -> tuple[Rotor, ...]:
    if isinstance(n, bool) or not isinstance(n, int) or n < 0 or (axes is None and n > 3):
        expected = "0 to 3, or a whole number of rotors with their axes"
        raise InputError("wrong number of rotors", where="gyrostat", got=n, expected=expected)
    directions = [unit_vector("B", k) for k in range(1, n + 1)] if axes is None else _axes(axes)
    chosen = [drives] * n if isinstance(drives, str) else list(drives)
    if not len(directions) == len(chosen) == n:
        got = f"{len(directions)} axes and {len(chosen)} drives"
        raise InputError(f"{n} rotors need {n} axes and drives", where="gyrostat", got=got)
    for drive in chosen:
        if drive not in DRIVES:
            raise unknown_name("drive", str(drive), DRIVES, where="gyrostat")
    return tuple(Rotor(k, a, d) for k, (a, d) in enumerate(zip(directions, chosen, strict=True), 1))


def _axes(axes: Sequence[Sequence[Expr]]) -> list[Vector]:
    directions = []
    for k, components in enumerate(axes, 1):
        if len(components) != 3 or not _is_one(sum(as_expression(c) ** 2 for c in components)):
            raise InputError(
                f"axis of rotor {k} is no unit vector",
                where="gyrostat",
                got=components,
                hint="divide it by its length, or write it by cosines and sines of angles",
            )
        directions.append(vector("B", components))
    return directions


def _is_one(square: Expr) -> bool:
    """Identically one, or a number that is one but for rounding."""
    excess = square - 1
    if excess.is_number:
        return bool(excess.is_finite and abs(excess.evalf(30)) < 1e-12)
    return vanishes(excess)


def _equations(h: Vector, rotors: Sequence[Rotor]) -> tuple[Expr | None, tuple[Expr, ...]]:
    """(Mass matrix or None, rates) of dh/dt = 0, with h named in omega x h."""
    moving = dict(zip(OMEGA.components, OMEGA_DOT, strict=True))
    moving |= {r.momentum.symbol: _axial(r) for r in rotors if r.turns_freely}
    local = first_derivative(h, OMEGA, moving).local
    named = vector("B", (d.symbol for d in _definitions(h)))
    mass = local.column.jacobian(OMEGA_DOT)
    at_rest = local.map(lambda c: c.xreplace(dict.fromkeys(OMEGA_DOT, sp.Integer(0))))
    return explicit_rates(mass, (at_rest + OMEGA.cross(named)).scaled(-1).components)


def _body(h: Vector, rotors: Sequence[Rotor]) -> tuple[Expr, tuple[Expr, ...]]:
    """Return inertia and torque of the body in the rotors' momentum, which `_equations` balances.

    h = K omega + p, with the axial momenta that are states in p: K d(omega)/dt + omega x K omega is
    -omega x p less the motors' torques.
    """
    inertia = h.column.jacobian(OMEGA.components)
    axial = h - vector("B", inertia * OMEGA.column)
    moving = {r.momentum.symbol: _axial(r) for r in rotors if r.turns_freely}
    rates = (
        [axial.column.jacobian(list(moving)) * sp.Matrix(list(moving.values()))] if moving else []
    )
    motors = vector("B", sum(rates, sp.zeros(3, 1)))
    return inertia, tuple(sp.expand(c) for c in (OMEGA.cross(axial) + motors).scaled(-1).components)


def _definitions(h: Vector) -> tuple[Definition, ...]:
    return tuple(
        scalar(f"h_{k}", c, "N m s", f"angular momentum along b{k}", f"h_{k}")
        for k, c in enumerate(h.components, 1)
    )


def _assumptions(J: Expr, h: Vector, attitude: Attitude | None) -> tuple[Assumption, ...]:
    """The last one: J exceeds the rotors' axial moments, which are a part of it (Sylvester)."""
    without = h.column.jacobian(OMEGA.components)
    minors = tuple(without[:k, :k].det(method="berkowitz") for k in (1, 2, 3))
    products = tuple(sp.Symbol(f"J{i}{j}", real=True) for i, j in ((1, 2), (1, 3), (2, 3)))
    axes = (Assumption("principal_axes", "b1, b2, b3 are principal axes of J", vanish=products),)
    return (
        Assumption("torque_free", "no torque acts from outside"),
        Assumption("rigid", "body and rotors are rigid"),
        Assumption("centre_of_mass", "J and h are about the centre of mass, fixed in the body"),
        Assumption("symmetric_rotors", "rotors are symmetric about their axes, fixed in the body"),
        *(axes if sp.Matrix(J).is_diagonal() else ()),
        physical(J),
        Assumption("rotors_in_inertia", "J holds the rotors' axial moments", nonnegative=minors),
        *rotation(attitude),
    )


def _outputs(
    J: Expr, rotors: Sequence[Rotor], system: System, attitude: Attitude | None
) -> list[Definition]:
    h = momentum(J, rotors)
    without = h.column.jacobian(OMEGA.components)
    turning = gather(OMEGA.dot(angular_momentum(without, OMEGA)) / 2, _states(rotors))
    outputs = [
        scalar("T", kinetic_energy(J, rotors), "J", "kinetic energy of rotation"),
        scalar("T_omega", turning, "J", "part of T that is quadratic in omega", "T_\\omega"),
        *momentum_outputs(h, attitude.matrix if attitude else None),
    ]
    for rotor in rotors:
        outputs += _rotor_outputs(rotor, system)
    if attitude:
        outputs += [scalar(name, e, "1", meaning) for name, meaning, e in attitude.constraints]
    return outputs


def _rotor_outputs(rotor: Rotor, system: System) -> list[Definition]:
    """Rates of a rotor that turns freely; the torque that keeps a constant speed."""
    k, inertia = rotor.k, rotor.inertia.symbol
    if rotor.turns_freely:
        meaning = f"rate of rotor {k} about its axis, in inertial space"
        absolute = scalar(f"rotor_rate_{k}", rotor.momentum.symbol / inertia, "rad/s", meaning)
        return [Definition(rotor.speed, rotor.relative_rate), absolute]
    if rotor.drive == "locked" or system.mass_matrix is not None:
        return []
    needed = inertia * system.rate_of(rotor.axis.dot(OMEGA))
    return [scalar(f"u_{k}", needed, "N m", f"motor torque that keeps Omega_{k} constant")]
