"""The 3-1-2 spinning symmetric rigid body of lecture 001, derived frame by frame.

Frames: I inertial; A after psi about the third axis; B after theta about the first axis; C is
fixed in the body and turns about b2 relative to B with the spin rate Omega. The body is symmetric
about b2, so that its inertia is diag(I1, I2, I1) in B as well as in C, for every spin angle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp

from eom.dimensions import kind_of_numbers
from eom.errors import typed_fields
from eom.exact.algebra import gather
from eom.kinematics.coordinates import elementary
from eom.kinematics.frames import (
    FirstDerivative,
    Rotation,
    Vector,
    first_derivative,
    time_derivative,
    unit_vector,
)
from eom.mechanics.rigidbody import angular_momentum, momentum_outputs, scalar, with_outputs
from eom.quantities import Assumption, Quantity, Singularity
from eom.system import BodyAttitude, System, as_expression

Expr = Any

PSI, THETA, PHI = (sp.Symbol(n, real=True) for n in ("psi", "theta", "phi"))
PSI_DOT, THETA_DOT, OMEGA = (sp.Symbol(n, real=True) for n in ("psi_dot", "theta_dot", "Omega"))
PSI_DDOT, THETA_DDOT, OMEGA_DOT = (
    sp.Symbol(n, real=True) for n in ("psi_ddot", "theta_ddot", "Omega_dot")
)
SPIN = sp.Symbol("C", real=True)
I1, I2 = (sp.Symbol(n, positive=True) for n in ("I1", "I2"))

RATES = {
    PSI: PSI_DOT,
    THETA: THETA_DOT,
    PHI: OMEGA,
    PSI_DOT: PSI_DDOT,
    THETA_DOT: THETA_DDOT,
    OMEGA: OMEGA_DOT,
}


@typed_fields
@dataclass(frozen=True)
class SpinningSymmetricBody:
    """The derivation of lecture 001 for a torque given by its components in B.

    Parameters
    ----------
    torque : tuple of expression, expression, expression
        Components (M1, M2, M3) (N m) along b1, b2, b3 about the reference point, expressions of
        parameters, inputs, time and the states theta, psi, phi, theta_dot, psi_dot, C, Omega.
    parameters : tuple of Quantity, optional
        Quantities in the torque that are constant.
    inputs : tuple of Quantity, optional
        Quantities in it that are given from outside.
    potential : expression, default 0
        Energy (J) whose loss is the work of the torque; without one that of a constant M1 is M1
        theta.
    reference_point : str, default "centre of mass"
        What momentum and torque are about, in words: the centre of mass, or a fixed point on the
        axle.
    numbers : str, optional
        What exact numbers in the torque are, a row of `eom.system.NUMBERS`; values where one stands
        alone, unless it is said.

    Raises
    ------
    InputError
        For what is no expression.

    Notes
    -----
    Frames: I inertial; A after psi about the third axis; B after theta about the first axis; the
    body's own frame turns about b2 relative to B by phi, at the rate Omega. Moments of inertia (kg
    m^2) about the reference point: I2 about the axle b2, I1 across it. Angles in rad, rates in
    rad/s.

    References
    ----------
    Lecture 001.

    Examples
    --------
    >>> SpinningSymmetricBody((0, 0, 0)).accelerations[1]
    (-C*I2*theta_dot + 2*I1*psi_dot*theta_dot*sin(theta))/(I1*cos(theta))
    """

    torque: tuple[Expr, Expr, Expr]
    parameters: tuple[Quantity, ...] = ()
    inputs: tuple[Quantity, ...] = ()
    potential: Expr = 0
    reference_point: str = "centre of mass"
    numbers: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "torque", tuple(map(as_expression, self.torque)))
        object.__setattr__(self, "potential", as_expression(self.potential))
        object.__setattr__(self, "numbers", self.numbers or kind_of_numbers(self.torque))

    @property
    def C_AI(self) -> Rotation:
        """First turn: psi about the third axis."""
        return Rotation("A", "I", elementary(3, PSI))

    @property
    def C_BA(self) -> Rotation:
        """Second turn: theta about the first axis."""
        return Rotation("B", "A", elementary(1, THETA))

    @property
    def C_BI(self) -> Rotation:
        """Both turns, one after the other."""
        return self.C_BA @ self.C_AI

    @property
    def omega_BI(self) -> Vector:
        """Angular velocity of B in I: psi' a3 + theta' b1, components in B."""
        return self.C_BA.apply(unit_vector("A", 3).scaled(PSI_DOT)) + unit_vector("B", 1).scaled(
            THETA_DOT
        )

    @property
    def omega_CB(self) -> Vector:
        """Angular velocity of the body frame C in B: Omega b2."""
        return unit_vector("B", 2).scaled(OMEGA)

    @property
    def omega_CI(self) -> Vector:
        """Angular velocity of the body in I, by addition, components in B."""
        return self.omega_BI + self.omega_CB

    @property
    def inertia(self) -> Expr:
        """Inertia matrix (3 x 3, kg m^2) about the reference point, in B: diag(I1, I2, I1)."""
        return sp.ImmutableMatrix(sp.diag(I1, I2, I1))

    @property
    def h_G(self) -> Vector:
        """Angular momentum about the reference point (N m s), components in B."""
        return angular_momentum(self.inertia, self.omega_CI)

    @cached_property
    def momentum_rate(self) -> FirstDerivative:
        """Inertial derivative of h_G by the transport theorem, the term I2 dOmega/dt kept."""
        return first_derivative(self.h_G, self.omega_BI, RATES)

    @property
    def spin(self) -> Expr:
        """Omega + psi' sin(theta): the body's angular velocity about its axle b2, named C."""
        return self.omega_CI.components[1]

    @cached_property
    def spin_rate(self) -> Expr:
        """dC/dt from row 2, in which the transport term vanishes: I2 dC/dt = M2."""
        row = self.momentum_rate.total.components[1]
        rate_of_spin = time_derivative(self.spin, RATES)
        inertia = row.diff(OMEGA_DOT) / rate_of_spin.diff(OMEGA_DOT)
        rest = sp.expand(row - inertia * rate_of_spin)
        return self._over_spin(self.torque[1] - rest) / inertia

    @cached_property
    def accelerations(self) -> tuple[Expr, Expr]:
        """Theta'' and psi'' from rows 1 and 3, each linear in one of them, over C not Omega."""
        rows = self.momentum_rate.total.components
        return (
            self._solve_row(rows[0], self.torque[0], THETA_DDOT),
            self._solve_row(rows[2], self.torque[2], PSI_DDOT),
        )

    def _over_spin(self, expression: Expr) -> Expr:
        """Replace Omega by C - psi' sin(theta)."""
        return as_expression(expression).xreplace({OMEGA: SPIN - (self.spin - OMEGA)})

    def _solve_row(self, row: Expr, torque: Expr, unknown: Expr) -> Expr:
        coefficient = row.diff(unknown)
        rest = self._over_spin(as_expression(torque) - row.xreplace({unknown: sp.Integer(0)}))
        tidy = gather(rest, (THETA_DOT, PSI_DOT))
        return tidy / coefficient

    @property
    def first_integral(self) -> Expr | None:
        """Omega + psi' sin(theta), a constant if M2 is zero; None otherwise."""
        return self.spin if self.spin_rate == 0 else None

    def system(
        self, name: str = "spinner", title: str = "3-1-2 spinning symmetric rigid body"
    ) -> System:
        """Return the equations of motion, over the states theta, psi, phi, theta', psi', C.

        Parameters
        ----------
        name : str, default "spinner"
            What the system is called, also in generated code.
        title : str, default "3-1-2 spinning symmetric rigid body"
            Its heading.

        Returns
        -------
        System
            Over the states theta, psi, phi, theta', psi', C. Singular where cos(theta) = 0.

        Raises
        ------
        InputError
            As `System` does, for symbols of the torque that are in none of ``parameters`` and
            ``inputs``.
        """
        theta_ddot, psi_ddot = self.accelerations
        Omega = self._over_spin(OMEGA)
        equations = {
            Quantity(THETA, "rad", "tilt of the axle, about b1", "\\theta"): THETA_DOT,
            Quantity(PSI, "rad", "precession angle, about a3", "\\psi"): PSI_DOT,
            Quantity(PHI, "rad", "spin angle, about b2", "\\phi"): Omega,
            Quantity(THETA_DOT, "rad/s", "tilt rate", "\\dot{\\theta}"): theta_ddot,
            Quantity(PSI_DOT, "rad/s", "precession rate", "\\dot{\\psi}"): psi_ddot,
            Quantity(
                SPIN, "rad/s", "angular velocity of the body about its axle b2", "C"
            ): self.spin_rate,
        }
        system = System(
            name=name,
            title=title,
            states=tuple(equations),
            rates=tuple(equations.values()),
            parameters=(*self._moments, *self.parameters),
            inputs=self.inputs,
            singularities=(
                Singularity(
                    self._determinant, THETA, "the axle b2 is parallel to a3: psi and phi coincide"
                ),
            ),
            assumptions=self._assumptions(),
            attitudes=(self._attitude,),
            numbers=self.numbers,
        )
        return with_outputs(system, self._outputs())

    @property
    def _moments(self) -> tuple[Quantity, Quantity]:
        """The moments of inertia."""
        across = f"moment of inertia about b1 and b3, through the {self.reference_point}"
        along = "moment of inertia about the axle b2"
        return Quantity(I1, "kg m^2", across, "I_1"), Quantity(I2, "kg m^2", along, "I_2")

    @property
    def _determinant(self) -> Expr:
        """Triple product of the turn axes a3, b1, b2; psi, theta and phi fail where it is zero."""
        a3 = self.C_BA.apply(unit_vector("A", 3))
        return a3.dot(unit_vector("B", 1).cross(unit_vector("B", 2)))

    @property
    def _attitude(self) -> BodyAttitude:
        """The body with components in B, in which its inertia is that of every spin angle."""
        return BodyAttitude(
            omega=self.omega_CI.map(self._over_spin).components,
            kind="3-1-2",
            coordinates=(PSI, THETA, PHI),
            inertia=self.inertia,
            torque=tuple(self._over_spin(m) for m in self.torque),
            unspun=True,
        )

    def _assumptions(self) -> tuple[Assumption, ...]:
        point = self.reference_point
        named = f"{point} G" if point == "centre of mass" else f"{point}, which is on the axle"
        about = f"inertia, momentum and torque are about the {named}"
        return (
            Assumption("rigid", "the distance of any two points of the body is constant"),
            Assumption(point.replace(" ", "_"), about),
            Assumption(
                "symmetric",
                "b2 is an axis of inertial symmetry: I1 = I3",
                vanish=(I1 - sp.Symbol("I3", positive=True),),
            ),
            Assumption(
                "physical_inertia",
                "I2 does not exceed 2 I1 (triangle inequality)",
                nonnegative=(2 * I1 - I2,),
            ),
        )

    def _outputs(self) -> Sequence[Any]:
        h = self.h_G.map(self._over_spin)
        kinetic = self._over_spin(self.omega_CI.dot(self.h_G) / 2)
        m1, m2, m3 = (self._over_spin(m) for m in self.torque)
        outputs = [
            scalar(
                "Omega",
                self._over_spin(OMEGA),
                "rad/s",
                "spin rate of the body in B, about b2",
                "\\Omega",
            ),
            scalar("T", kinetic, "J", "kinetic energy of rotation"),
        ]
        if self.potential != 0:
            meaning = "kinetic energy of rotation and potential energy"
            outputs.append(scalar("E", kinetic + self.potential, "J", meaning))
        elif m1 != 0 and THETA not in m1.free_symbols:
            meaning = "kinetic energy less the work of the torque about b1 in turning through theta"
            outputs.append(scalar("E", kinetic - m1 * THETA, "J", meaning))
        C_BI = self.C_BI.matrix
        outputs += momentum_outputs(h, C_BI, "i")
        outputs += [
            scalar(f"torque_{k}", m, "N m", f"torque about b{k}", rf"\tau_{k}")
            for k, m in enumerate((m1, m2, m3), 1)
        ]
        outputs.append(scalar("axle_1", C_BI[1, 0], "1", "component of the axle b2 along i1"))
        outputs.append(scalar("axle_2", C_BI[1, 1], "1", "component of the axle b2 along i2"))
        outputs.append(scalar("axle_3", C_BI[1, 2], "1", "component of the axle b2 along i3"))
        return outputs


def lecture_torque() -> SpinningSymmetricBody:
    """Return the body of lecture 001 with its torque -M1 b1, M1 (N m) a parameter.

    Source: lecture 001; frames and symbols as in `SpinningSymmetricBody`.

    >>> lecture_torque().h_G.components[1]
    I2*(Omega + psi_dot*sin(theta))
    """
    M1 = Quantity(sp.Symbol("M1", real=True), "N m", "torque about -b1", "M_1")
    return SpinningSymmetricBody((-M1.symbol, sp.Integer(0), sp.Integer(0)), parameters=(M1,))
