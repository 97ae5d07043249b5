"""External torque on a rigid body: none, applied, weight about a fixed point, gravity gradient.

Torques are derived by integrating r x (force on dm) over the body. All components are in the body
frame B; ``C`` takes components in the reference frame A to B.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from eom.dimensions import kind_of_numbers
from eom.errors import InputError
from eom.kinematics.frames import Vector, unit_vector, vector
from eom.mass.inertia import integrate_over_mass, second_moments_of_inertia
from eom.quantities import Assumption, Definition, Quantity

Expr = Any


ZERO = sp.Integer(0)
AT_REST = vector("B", (0, 0, 0))


@dataclass(frozen=True)
class Torque:
    """Torque about the reference point, in B, with what comes with it.

    ``components``: of the torque (N m), in B. ``potential``: energy (J) whose loss is the work of the
    torque, or zero. ``frame_rate``: angular velocity (rad/s) in inertial space of the frame A that
    attitude is measured from, in B; ``frame_rate_in_A``: the same in A. ``parameters``, ``inputs``: the
    quantities in it. ``directions``: components in B of the axes of A that matter, as definitions.
    ``assumptions``: under which it holds. ``numbers``: what exact numbers in it are, a row of
    `eom.system.NUMBERS`; values where one stands alone, unless it is said. ``reference_point``: what
    momentum and torque are about; empty for a couple, which is the same about every point.

    Torques about one point add up. Raises `InputError` where they are about different points, or their
    frames A turn differently.

    >>> (weight(sp.eye(3)) + applied((0, 0, -sp.Symbol("M")))).components.components[2]
    -M
    """

    components: Vector
    potential: Expr = ZERO
    frame_rate: Vector = AT_REST
    parameters: tuple[Quantity, ...] = ()
    inputs: tuple[Quantity, ...] = ()
    directions: tuple[Definition, ...] = ()
    assumptions: tuple[Assumption, ...] = ()
    reference_point: str = ""
    frame_rate_in_A: Vector | None = None
    numbers: str = ""

    def __post_init__(self) -> None:
        found = self.numbers or kind_of_numbers(self.components.components)
        object.__setattr__(self, "numbers", found)

    def __add__(self, other: Torque) -> Torque:
        """Return the sum: components and potentials are added, what comes with each is kept."""
        if not isinstance(other, Torque):
            return NotImplemented
        based = [t for t in (self, other) if t.reference_point or t.frame_rate != AT_REST]
        point = _only("torques about different points", [t.reference_point for t in based], "")
        turning = _only("frames A turn differently", map(_rates, based), (AT_REST, None))
        return Torque(
            self.components + other.components,
            self.potential + other.potential,
            turning[0],
            _each(self.parameters, other.parameters),
            _each(self.inputs, other.inputs),
            _each(self.directions, other.directions),
            _each(self.assumptions, other.assumptions),
            point,
            turning[1],
            other.numbers if self.numbers == "counts" else self.numbers,
        )

    def inlined(self) -> Torque:
        """Return the same torque with the components of directions put in, none of them named."""
        over = {d.symbol: d.expression for d in self.directions}
        return replace(
            self,
            components=self.components.map(lambda c: sp.sympify(c, strict=True).xreplace(over)),
            potential=sp.sympify(self.potential, strict=True).xreplace(over),
            directions=(),
        )


def _rates(torque: Torque) -> tuple[Vector, Vector | None]:
    return torque.frame_rate, torque.frame_rate_in_A


def _each(first: tuple[Any, ...], second: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(dict.fromkeys((*first, *second)))


def _only(what: str, given: Iterable[Any], default: Any) -> Any:
    """Return what is the same of all torques, or the default. Raises `InputError` if it is not."""
    found = list(dict.fromkeys(given)) or [default]
    if len(found) > 1:
        raise InputError(
            what,
            where="torque",
            got=" and ".join(map(str, found)),
            hint="weight is about a fixed point, gravity gradient about the centre of mass on an "
            "orbit; a scene file takes gravity_gradient, 3 x 3, beside a weight",
        )
    return found[0]


def applied(
    components: Sequence[Expr], parameters: Sequence[Quantity] = (), inputs: Sequence[Quantity] = ()
) -> Torque:
    """Return a torque given by its ``components`` in B (N m); all zero means torque-free.

    Parameters
    ----------
    components : sequence of expressions
        Three, in B (N m); all zero means torque-free.
    parameters : sequence of Quantity, optional
        Quantities of the symbols in it that are constant.
    inputs : sequence of Quantity, optional
        Quantities of those that are given from outside.

    Returns
    -------
    Torque
        A couple, the same about every point; torques are added with ``+``.

    Raises
    ------
    InputError
        For text in place of expressions.

    Examples
    --------
    >>> applied((0, 0, -sp.Symbol("M"))).components.components
    (0, 0, -M)
    """
    return Torque(vector("B", components), parameters=tuple(parameters), inputs=tuple(inputs))


def _positive(name: str, unit: str, meaning: str, latex: str = "") -> Quantity:
    return Quantity(sp.Symbol(name, positive=True), unit, meaning, latex)


def _direction(
    name: str, C: Expr, axis: int, meaning: str
) -> tuple[Vector, tuple[Definition, ...]]:
    """Components in B of axis ``axis`` of A; named unless each is a single symbol already."""
    column = vector("B", C * unit_vector("A", axis).column)
    if all(c.is_Symbol for c in column.components):
        return column, ()
    symbols = [sp.Symbol(f"{name}_{k}", real=True) for k in (1, 2, 3)]
    named = tuple(
        Definition(Quantity(s, "1", f"component along b{k} of {meaning}", f"{name}_{k}"), c)
        for k, (s, c) in enumerate(zip(symbols, column.components, strict=True), 1)
    )
    return vector("B", symbols), named


def weight(C: Expr, offset: Sequence[bool] = (False, False, True)) -> Torque:
    """Return the torque of weight about a fixed point: integral of r x (-g a3) dm = m r_C x (-g a3).

    Parameters
    ----------
    C : matrix
        C_BA, 3 x 3, takes components in A to components in B.
    offset : sequence of bool, optional
        Along which body axes the centre of mass lies off the fixed point.

    Returns
    -------
    Torque
        In B (N m). Parameters: ``r1``, ``r2``, ``r3`` in metres, mass m in kg, g in m/s^2.

    Notes
    -----
    Gravity acts along -a3. The integrand is linear in r, so that the first moment m r_C replaces
    the integral of r dm.

    References
    ----------
    Lecture 002 eq. 3.20.

    Examples
    --------
    >>> from eom.kinematics.coordinates import attitude
    >>> weight(attitude("dcm").matrix).components.components
    (C23*g*m*r3, -C13*g*m*r3, 0)
    """
    m = _positive("m", "kg", "mass")
    g = _positive("g", "m/s^2", "acceleration of gravity, along -a3")
    arms = [
        Quantity(
            sp.Symbol(f"r{k}", real=True),
            "m",
            f"centre of mass along b{k}, from the fixed point",
            f"r_{k}",
        )
        for k in (1, 2, 3)
    ]
    up, named = _direction("up", C, 3, "the upward vertical a3")
    first_moment = vector(
        "B", (m.symbol * q.symbol * int(on) for q, on in zip(arms, offset, strict=True))
    )
    gravity = up.scaled(-g.symbol)
    return Torque(
        components=first_moment.cross(gravity),
        potential=-first_moment.dot(gravity),
        parameters=(m, g, *(q for q, on in zip(arms, offset, strict=True) if on)),
        directions=named,
        reference_point="fixed point",
    )


def gravity_gradient(C: Expr, J: Expr) -> Torque:
    """Return the gravity-gradient torque (N m) on a circular orbit of rate ``n`` (rad/s).

    Parameters
    ----------
    C : matrix
        C_BA, 3 x 3, from the orbit frame A to the body's axes B.
    J : matrix
        Inertia matrix about the centre of mass in B, 3 x 3 (kg m^2).

    Returns
    -------
    Torque
        In B (N m), on a circular orbit of rate ``n`` (rad/s), which is its parameter.

    Notes
    -----
    A is the orbit frame: a1 radially out, a2 along the velocity, a3 the orbit normal; its angular
    velocity is n a3. The inverse-square attraction of dm at R a1 + r is expanded to first order in
    r/R, and integrated: with mu/R^3 = n^2 the torque is 3 n^2 a1 x (J a1).

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), sect. 8.1.

    Examples
    --------
    >>> from eom.kinematics.coordinates import attitude
    >>> I1, I2, I3 = sp.symbols("I1:4", positive=True)
    >>> gravity_gradient(attitude("dcm").matrix, sp.diag(I1, I2, I3)).components.components[0]
    -3*C21*C31*I2*n**2 + 3*C21*C31*I3*n**2
    """
    n = _positive("n", "rad/s", "orbital rate")
    radial, named_radial = _direction("radial", C, 1, "the outward radial a1")
    normal, named_normal = _direction("normal", C, 3, "the orbit normal a3")
    a = vector("B", sp.symbols("a_1:4", real=True))
    torque, potential = _gradient_of_attraction(a, n.symbol, J)
    here = dict(zip(a.components, radial.components, strict=True))
    return Torque(
        components=torque.map(lambda c: c.xreplace(here)),
        potential=potential.xreplace(here),
        frame_rate=normal.scaled(n.symbol),
        frame_rate_in_A=unit_vector("A", 3).scaled(n.symbol),
        parameters=(n,),
        reference_point="centre of mass",
        directions=(*named_radial, *named_normal),
        assumptions=(
            Assumption("circular_orbit", "the orbit is circular and not disturbed by the attitude"),
            Assumption("small_body", "the body is small beside the orbit: first order in r/R"),
        ),
    )


def _gradient_of_attraction(a: Vector, n: Expr, J: Expr) -> tuple[Vector, Expr]:
    """Integrate r x f and the potential over the body, for the unit vector ``a`` from the attractor.

    With lengths in units of R, dm at a + e r has the potential energy -n^2 / |a + e r| dm; the
    torque needs its gradient to first order in e, the energy its second order.
    """
    r = vector("B", sp.symbols("r_1:4", real=True))
    e = sp.Symbol("e", real=True)
    S = second_moments_of_inertia(J)
    x = vector("B", sp.symbols("x_1:4", real=True))
    energy = -(n**2) / sp.sqrt(x.dot(x))
    force = x.map(lambda c: -energy.diff(c))
    unit = {a.dot(a): sp.Integer(1)}

    def order(expression: Expr, k: int) -> Expr:
        moved = expression.xreplace(
            {
                xi: ai + e * ri
                for xi, ai, ri in zip(x.components, a.components, r.components, strict=True)
            }
        )
        term = moved.diff(e, k).subs(e, 0) / sp.factorial(k)
        return sp.expand(term.subs(unit))

    linear_force = force.map(lambda c: order(c, 1))
    torque = r.cross(linear_force).map(lambda c: integrate_over_mass(sp.expand(c), S))
    energy_second = integrate_over_mass(order(energy, 2), S)
    isotropic = energy_second.subs(dict.fromkeys(a.components, 0))
    return torque.map(sp.expand), sp.expand(energy_second - isotropic)
