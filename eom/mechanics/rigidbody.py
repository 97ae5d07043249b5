"""A rigid body about its centre of mass or a fixed point: momentum, energy, Euler's equations.

The equations come from h = J omega, the transport theorem and dh/dt = tau (lecture 000; lecture 001;
lecture 002 eq. 3.22-3.27, 3.36). Nothing about the motion is assumed beyond what the result lists.

Whether an expression stays constant along every solution of a system, exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.errors import InputError, shown, typed
from eom.exact.algebra import explicit_rates, gather
from eom.exact.identity import RandomPoint, zero_at_random_points
from eom.fields import PRIME, RESIDUES, solve
from eom.kinematics.coordinates import Attitude, constraint_value
from eom.kinematics.coordinates import attitude as attitude_of_name
from eom.kinematics.frames import FirstDerivative, Vector, first_derivative, vector
from eom.mass.inertia import physical
from eom.mechanics import torques
from eom.mechanics.torques import Torque
from eom.quantities import Assumption, Definition, Quantity
from eom.structure import NONE
from eom.system import BodyAttitude, System, as_expression

Expr = Any
TorqueLaw = Callable[[Expr, Expr], Torque]
"""From (C_BA or None, J) to a torque."""

OMEGA = vector("B", (sp.Symbol(f"omega_{k}", real=True) for k in (1, 2, 3)))


def principal_inertia() -> tuple[Expr, tuple[Quantity, ...]]:
    """Return diag(I1, I2, I3) and the quantities in it, for principal axes b1, b2, b3.

    The matrix is 3 x 3, of positive symbols in kg m^2, about the centre of mass or a fixed point.

    >>> principal_inertia()[0]
    Matrix([
    [I1,  0,  0],
    [ 0, I2,  0],
    [ 0,  0, I3]])
    """
    moments = tuple(
        Quantity(
            sp.Symbol(f"I{k}", positive=True),
            "kg m^2",
            f"principal moment of inertia about b{k}",
            f"I_{k}",
        )
        for k in (1, 2, 3)
    )
    return sp.ImmutableMatrix(sp.diag(*(q.symbol for q in moments))), moments


def full_inertia() -> tuple[Expr, tuple[Quantity, ...]]:
    """Return the symmetric matrix of J11, J12, ..., J33 and the six quantities in it.

    The matrix is 3 x 3, in kg m^2, in the body's axes b1, b2, b3, about the centre of mass or a fixed
    point. Off-diagonal entries are minus the products of inertia: J12 = -integral of r1 r2 dm.

    >>> full_inertia()[0]
    Matrix([
    [J11, J12, J13],
    [J12, J22, J23],
    [J13, J23, J33]])
    """
    entries = {}
    for i in (1, 2, 3):
        for j in range(i, 4):
            kind = (
                f"moment of inertia about b{i}"
                if i == j
                else f"minus the product of inertia of b{i} and b{j}"
            )
            symbol = (
                sp.Symbol(f"J{i}{j}", positive=True) if i == j else sp.Symbol(f"J{i}{j}", real=True)
            )
            entries[i, j] = Quantity(symbol, "kg m^2", kind, f"J_{{{i}{j}}}")
    J = sp.Matrix(3, 3, lambda i, j: entries[min(i, j) + 1, max(i, j) + 1].symbol)
    return sp.ImmutableMatrix(J), tuple(entries.values())


def angular_momentum(J: Expr, omega: Vector) -> Vector:
    """Return h = J omega (N m s), components in the frame of ``omega``."""
    return vector(omega.frame, J * omega.column)


def momentum_rate(J: Expr, omega: Vector, omega_dot: Sequence[Expr]) -> FirstDerivative:
    """Return dh/dt by the transport theorem: J omega_dot (local) and omega x J omega (rotation)."""
    rates = dict(zip(omega.components, omega_dot, strict=True))
    return first_derivative(angular_momentum(J, omega), omega, rates)


@typed
def euler_equations(
    J: Expr, torque: Vector, omega: Vector = OMEGA, momentum: Vector | None = None
) -> tuple[Expr | None, tuple[Expr, ...]]:
    """Return (mass matrix or None, rates) of dh/dt = torque; principal axes need no matrix.

    Parameters
    ----------
    J : matrix
        Inertia matrix, 3 x 3 (kg m^2), about the centre of mass or a fixed point, in B.
    torque : Vector
        About the same point (N m), in B.
    omega : Vector, optional
        Angular velocity of B in inertial space (rad/s), in B; each component a symbol.
    momentum : Vector, optional
        Symbols that name J omega (N m s), where the result shall use them.

    Returns
    -------
    tuple of matrix or None, tuple of Expr
        The mass matrix, 3 x 3, or None where axes are principal, and the three rates.

    Raises
    ------
    InputError
        For vectors in different frames, an inertia that is no 3 x 3 matrix, and an angular velocity
        whose components are not three symbols.

    Notes
    -----
    A full inertia matrix stays on the left and is never inverted.

    References
    ----------
    Lecture 002 eq. 3.22-3.27; Goldstein, Classical Mechanics (2002), sect. 5.5.

    Examples
    --------
    >>> J, _ = principal_inertia()
    >>> euler_equations(J, vector("B", (0, 0, 0)))[1][0]
    omega_2*omega_3*(I2 - I3)/I1
    """
    J = _inertia_matrix(J)
    if len({c for c in omega.components if isinstance(c, sp.Symbol)}) != 3:
        raise InputError("the angular velocity is not three symbols", got=omega.components)
    omega_dot = sp.symbols("omega_dot_1:4", real=True)
    rate = momentum_rate(J, omega, omega_dot)
    mass = rate.local.column.jacobian(omega_dot)
    rotation = rate.rotation if momentum is None else omega.cross(momentum)
    forces = (torque - rotation).components
    return explicit_rates(mass, (gather(f, _variables(f, mass)) for f in forces))


def _inertia_matrix(given: Any) -> Expr:
    J = as_expression(given)
    if not isinstance(J, sp.MatrixBase) or J.shape != (3, 3):
        raise InputError("the inertia is not a matrix", got=shown(given), expected="3 x 3")
    return J


def _variables(force: Expr, mass: Expr) -> list[Expr]:
    """Whatever is not in the inertia matrix counts as variable, so that moments are gathered."""
    return sorted(force.free_symbols - mass.free_symbols, key=str)


@typed
def rigid_body(
    inertia: tuple[Expr, Sequence[Quantity]],
    torque: TorqueLaw,
    attitude: Attitude | None = None,
    *,
    name: str = "rigid_body",
    title: str = "Rigid body",
) -> System:
    """Derive a rigid body's equations of motion: Euler's equations, and attitude where given.

    Parameters
    ----------
    inertia : tuple of matrix, sequence of Quantity
        From `principal_inertia` or `full_inertia`: the matrix, 3 x 3 (kg m^2), and its parameters.
    torque : callable
        From (C_BA, J) to a `Torque`, both in the body's axes B; C_BA takes components in A to
        components in B, and is None without ``attitude``.
    attitude : Attitude, optional
        Coordinates of B in the reference frame A, see `eom.kinematics.coordinates.attitude`; none
        if left out.
    name : str, default "rigid_body"
        What the system is called, also in generated code.
    title : str, default "Rigid body"
        Its heading.

    Returns
    -------
    System
        States: omega_1, omega_2, omega_3 (rad/s, of B in inertial space, components in B), then the
        coordinates of ``attitude``. Outputs and invariants hold everything that can be computed;
        `eom.scenes.scene` keeps what is asked for.

    Raises
    ------
    InputError
        For a torque that is not in B, an inertia that is no 3 x 3 matrix, and as `System` does, for
        symbols of the torque that are in none of its parameters and inputs.

    References
    ----------
    Lecture 002 eq. 3.22-3.27, 3.36; Hughes, Spacecraft Attitude Dynamics (1986), ch. 2 and 3.

    Examples
    --------
    >>> from eom.mechanics.torques import applied
    >>> M = sp.Symbol("M", real=True)
    >>> spun_up = applied((0, 0, M), inputs=(Quantity(M, "N m", "torque about b3"),))
    >>> rigid_body(principal_inertia(), lambda C, J: spun_up).rates[2]
    (M + omega_1*omega_2*(I1 - I2))/I3
    """
    J, moments = _inertia_matrix(inertia[0]), inertia[1]
    C = attitude.matrix if attitude else None
    law = torque(C, J)
    if not isinstance(law, Torque):
        raise InputError("the torque law returns no torque", got=shown(law), expected="a Torque")
    named_torque, torque_definitions = _name_components(law.components)
    named_h, h_definitions = _name_momentum(J)
    mass, rates = euler_equations(J, named_torque, momentum=named_h)
    relative = OMEGA - law.frame_rate
    if attitude:
        rates = (*rates, *attitude.rates(relative))
        if mass is not None:
            mass = sp.ImmutableMatrix(sp.diag(mass, sp.eye(len(attitude.coordinates))))
    omega = tuple(
        Quantity(w, "rad/s", f"angular velocity about b{k}", f"\\omega_{k}")
        for k, w in enumerate(OMEGA.components, 1)
    )
    system = System(
        name=name,
        title=title,
        states=(*omega, *(attitude.coordinates if attitude else ())),
        rates=rates,
        mass_matrix=mass,
        parameters=(*moments, *law.parameters),
        inputs=law.inputs,
        definitions=(*law.directions, *torque_definitions, *h_definitions),
        singularities=attitude.singularities if attitude else (),
        assumptions=(*_assumptions(J, law), *rotation(attitude)),
        numbers=law.numbers,
    )
    outputs = _outputs(J, law, named_torque, attitude)
    return with_outputs(_stated(system, J, law, attitude), outputs)


def with_body(
    system: System,
    J: Expr,
    torque: Sequence[Expr],
    attitude: Attitude | None = None,
    frame_rate: Sequence[Expr] = (0, 0, 0),
) -> System:
    """State of a system that it is a body whose angular velocity is `OMEGA`, and its attitude.

    ``torque``: J d(omega)/dt + omega x J omega, in B; ``frame_rate``: of the frame A, components in A.
    Raises `InputError` where that is not so.
    """
    body = BodyAttitude(
        OMEGA.components,
        attitude.name if attitude else NONE,
        tuple(q.symbol for q in attitude.coordinates) if attitude else (),
        tuple(frame_rate) if attitude else (0, 0, 0),
        J,
        tuple(torque),
    )
    return replace(system, attitudes=(body.over(system.expand),))


def _stated(system: System, J: Expr, law: Torque, attitude: Attitude | None) -> System:
    """State the body; its attitude only where the rate of the frame is known in the frame."""
    turning = any(c != 0 for c in law.frame_rate.components)
    if turning and law.frame_rate_in_A is None:
        return with_body(system, J, law.components.components)
    rate = law.frame_rate_in_A.components if law.frame_rate_in_A else (0, 0, 0)
    return with_body(system, J, law.components.components, attitude, rate)


def with_outputs(system: System, outputs: Sequence[Definition]) -> System:
    """Attach ``outputs``, and as invariants those of them that are constants of this motion."""
    moving = {q.symbol for q in system.states}
    constant = tuple(
        d
        for d in outputs
        if system.expand(d.expression).free_symbols & moving and is_invariant(system, d.expression)
    )
    return replace(system, outputs=tuple(outputs), invariants=constant)


def _name_components(torque: Vector) -> tuple[Vector, tuple[Definition, ...]]:
    """Name the components that are more than a symbol with a sign."""
    symbols, named = [], []
    for k, component in enumerate(torque.components, 1):
        if component.is_number or component.as_coeff_Mul()[1].is_Symbol:
            symbols.append(component)
            continue
        symbol = sp.Symbol(f"torque_{k}", real=True)
        symbols.append(symbol)
        tidy = gather(
            component, sorted((s for s in component.free_symbols if not s.is_positive), key=str)
        )
        named.append(Definition(Quantity(symbol, "N m", f"torque about b{k}", f"\\tau_{k}"), tidy))
    return vector("B", symbols), tuple(named)


def _name_momentum(J: Expr) -> tuple[Vector | None, tuple[Definition, ...]]:
    """Name h = J omega where J is full: the products with omega then stay small."""
    if J.is_diagonal():
        return None, ()
    named = tuple(
        Definition(_momentum_quantity(k), c)
        for k, c in enumerate(angular_momentum(J, OMEGA).components, 1)
    )
    return vector("B", (d.symbol for d in named)), named


def _momentum_quantity(k: int) -> Quantity:
    return Quantity(
        sp.Symbol(f"h_{k}", real=True), "N m s", f"angular momentum along b{k}", f"h_{k}"
    )


def _assumptions(J: Expr, law: Torque) -> tuple[Assumption, ...]:
    reference = law.reference_point or "centre of mass"
    about = f"J, h and torque are about the {reference}"
    point = Assumption(reference.replace(" ", "_"), about)
    rigid = Assumption("rigid", "the distance of any two points of the body is constant")
    principal: tuple[Assumption, ...] = ()
    if sp.Matrix(J).is_diagonal():
        products = tuple(sp.Symbol(f"J{i}{j}", real=True) for i, j in ((1, 2), (1, 3), (2, 3)))
        meaning = "b1, b2, b3 are principal axes of inertia"
        principal = (Assumption("principal_axes", meaning, vanish=products),)
    return (rigid, point, *principal, physical(J), *law.assumptions)


def rotation(attitude: Attitude | None) -> tuple[Assumption, ...]:
    """The coordinates describe a rotation; loose enough to go on from where a run has ended."""
    if attitude is None or not attitude.constraints:
        return ()
    vanish = tuple(e - constraint_value(n) for n, _, e in attitude.constraints)
    meaning = f"the {attitude.name} is that of a rotation"
    return (Assumption("rotation", meaning, vanish=vanish, tolerance=1e-4),)


def scalar(name: str, expression: Expr, unit: str, meaning: str, latex: str = "") -> Definition:
    """Return a named output."""
    return Definition(
        Quantity(sp.Symbol(name, real=True), unit, meaning, latex or name), expression
    )


def momentum_outputs(h: Vector, C: Expr | None, inertial: str = "a") -> list[Definition]:
    """Return the magnitude of ``h``, its components in B and, where C_BA is known, in A.

    ``inertial``: the letter of the axes of A in words.
    """
    outputs = [scalar("H", sp.sqrt(h.dot(h)), "N m s", "magnitude of the angular momentum")]
    outputs += [Definition(_momentum_quantity(k), c) for k, c in enumerate(h.components, 1)]
    if C is not None:
        outputs += [
            scalar(f"H_{k}", c, "N m s", f"angular momentum along {inertial}{k}")
            for k, c in enumerate(C.T * h.column, 1)
        ]
    return outputs


def _outputs(J: Expr, law: Torque, torque: Vector, attitude: Attitude | None) -> list[Definition]:
    h = angular_momentum(J, OMEGA)
    kinetic = OMEGA.dot(h) / 2
    outputs = [scalar("T", kinetic, "J", "kinetic energy of rotation")]
    turning = law.frame_rate.dot(h)
    if law.potential != 0 or turning != 0:
        meaning = (
            "energy" if turning == 0 else "Jacobi's integral: energy as seen in the turning frame A"
        )
        outputs.append(scalar("E", kinetic + law.potential - turning, "J", meaning))
    outputs += momentum_outputs(h, attitude.matrix if attitude else None)
    outputs += [
        scalar(f"torque_{k}", c, "N m", f"torque about b{k}", f"\\tau_{k}")
        for k, c in enumerate(torque.components, 1)
    ]
    if attitude:
        up = attitude.matrix[:, 2]
        tilt = sp.atan2(sp.sqrt(up[0] ** 2 + up[1] ** 2), up[2])
        outputs.append(scalar("tilt", tilt, "rad", "angle between b3 and a3", "\\beta"))
        outputs += [scalar(*_with_unit(c)) for c in attitude.constraints]
    return outputs


def _with_unit(constraint: tuple[str, str, Expr]) -> tuple[str, Expr, str, str]:
    name, meaning, expression = constraint
    return name, expression, "1", meaning


@typed
def free_rigid_body(attitude: str | None = None) -> System:
    """Derive the torque-free body in principal axes, with its constants T and H.

    Parameters
    ----------
    attitude : str, optional
        Coordinates of B in inertial space: ``quaternion`` (scalar first), ``dcm`` or one of the 12
        rotation sequences such as ``3-1-2``; none if left out.

    Returns
    -------
    System
        States as of `rigid_body`, in SI units. Its invariants are the kinetic energy T (J) and H (N
        m s), the magnitude of the angular momentum about the centre of mass.

    Raises
    ------
    InputError
        For other names of attitudes.

    References
    ----------
    Lecture 000; Goldstein, Classical Mechanics (2002), sect. 5.6.

    Examples
    --------
    >>> free_rigid_body().invariant_names
    ('T', 'H')
    """
    chosen = attitude_of_name(attitude) if attitude else None
    title = "Torque-free rigid body"
    return rigid_body(
        principal_inertia(),
        lambda C, J: torques.applied((0, 0, 0)),
        chosen,
        name="free_rigid_body",
        title=title,
    )


@typed
def heavy_top(attitude: str = "quaternion") -> System:
    """Derive a body with a fixed point and its centre of mass on b3, under its weight along -a3.

    Parameters
    ----------
    attitude : str, default "quaternion"
        Coordinates of B in inertial space A, as in `free_rigid_body`.

    Returns
    -------
    System
        States as of `rigid_body`. Parameters: principal moments I1, I2, I3 (kg m^2) about the fixed
        point, mass m (kg), gravity g (m/s^2), and r3 (m), the centre of mass along b3 from the
        fixed point.

    Raises
    ------
    InputError
        For other names of attitudes.

    References
    ----------
    Lecture 002 eq. 3.20; Goldstein, Classical Mechanics (2002), sect. 5.7.

    Examples
    --------
    >>> heavy_top().invariant_names  # energy, angular momentum along the vertical a3, norm
    ('E', 'H_3', 'q_norm')
    """
    return rigid_body(
        principal_inertia(),
        lambda C, J: torques.weight(C),
        attitude_of_name(attitude),
        name="heavy_top",
        title="Heavy top",
    )


@typed
def gravity_gradient_satellite(attitude: str = "quaternion") -> System:
    """Derive a satellite on a circular orbit; attitude is that in the orbit frame.

    Parameters
    ----------
    attitude : str, default "quaternion"
        Coordinates of B in A, as in `free_rigid_body`.

    Returns
    -------
    System
        States as of `rigid_body`; omega is still that in inertial space. Parameters: principal
        moments I1, I2, I3 (kg m^2) about the centre of mass, orbital rate n (rad/s).

    Raises
    ------
    InputError
        For other names of attitudes.

    Notes
    -----
    The orbit frame A: a1 radially out, a2 along the velocity, a3 the orbit normal; it turns by n
    a3. The torque is 3 n^2 a1 x (J a1), of first order in size of the body by radius of the orbit.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), sect. 8.1.

    Examples
    --------
    >>> gravity_gradient_satellite().invariant_names  # E is Jacobi's integral
    ('E', 'q_norm')
    """
    return rigid_body(
        principal_inertia(),
        torques.gravity_gradient,
        attitude_of_name(attitude),
        name="gravity_gradient_satellite",
        title="Satellite under gravity-gradient torque",
    )


def is_invariant(system: System, expression: Expr, *, points: int = 3, seed: int = 0) -> bool:
    """Return whether ``expression`` stays constant along every solution of ``system``.

    The time derivative is formed by the chain rule; where the system has a mass matrix, the
    accelerations come from solving it at each point modulo the prime. Inputs may change with time,
    so that nothing that contains one is constant.
    """
    full = system.expand(expression)
    if full.free_symbols & {q.symbol for q in system.inputs}:
        return False
    gradient = [full.diff(q.symbol) for q in system.states]
    explicit = full.diff(system.time)
    rates = [system.expand(r) for r in system.rates]
    mass = (
        None
        if system.mass_matrix is None
        else [[system.expand(e) for e in row] for row in system.mass_matrix.tolist()]
    )

    def residual(point: RandomPoint) -> int:
        velocity = [point.value(r) for r in rates]
        if mass is not None:
            velocity = solve([[point.value(e) for e in row] for row in mass], velocity, RESIDUES)
        work = sum(point.value(g) * v for g, v in zip(gradient, velocity, strict=True))
        return int(work + point.value(explicit)) % PRIME

    return zero_at_random_points(residual, points, seed)
