"""The heavy symmetric top: constants, effective potential, nutation, steady precession, sleeping top.

Source: Goldstein, Poole, Safko, Classical Mechanics (2002), 5.7; Landau and Lifshitz, Mechanics (1976),
section 35. Letters are theirs.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.exact.identity import vanishes
from eom.terms.rules import (
    Rule,
    along_turned,
    chain,
    collect,
    compute,
    differentiate,
    distribute,
    dyads,
    entrywise,
    orthonormal,
    put_in,
    slopes,
    use,
)
from eom.terms.rules.inferences import factor_zero, signs, solved, special
from eom.terms.terms import Equation, add, cross, der, dot, expr, mul, number, partial
from eom.terms.vocabulary import omega, position, quantity, unit, velocity

Expr = Any
AXIS = unit("F", 3)
KINETIC = quantity("kinetic_energy", "top")


def heavy_symmetric_top() -> Derived:
    """Derive the motion of a symmetric top in uniform gravity about a point of its axis."""
    d = Derivation("heavy-symmetric-top", "The heavy symmetric top", "Spinning bodies")
    top = Top(d)
    top.kinematics()
    top.energies()
    top.momenta()
    top.potential()
    top.nutation()
    top.bounds()
    top.precession()
    top.sleeping()
    return d.finish()


def cubic(u: Expr, a: Expr, b: Expr, alpha: Expr, beta: Expr) -> Expr:
    """Return (du/dt)^2 as a cubic of u, the cosine of the inclination (Goldstein 5.62)."""
    return (1 - u**2) * (alpha - beta * u) - (b - a * u) ** 2


class Top:
    """The chapter, part by part, with its symbols."""

    def __init__(self, d: Derivation) -> None:
        self.d = d
        self.m, self.g, self.l, self.I1, self.I3 = d.constants(
            m="mass of the top",
            g="acceleration of gravity, downwards",
            l="distance of the centre of mass from the fixed point, along the axis",
            I_1="moment of inertia about any axis across the axis of symmetry, through the fixed point",
            I_3="moment of inertia about the axis of symmetry",
        )
        self.phi, self.phi_dot, _ = d.coordinate("phi", "angle of precession")
        tilt = "angle from the vertical to the axis"
        self.theta, self.theta_dot, self.theta_ddot = d.coordinate("theta", tilt)
        self.psi, self.psi_dot, _ = d.coordinate("psi", "angle of the spin about the axis")
        self.weight = self.m * self.g * self.l

    @property
    def slope(self) -> Rule:
        """The rule that carries out partial derivatives."""
        return slopes(self.d.scalars, self.d.own)

    def named(self, *symbols: Any) -> Rule:
        """Return the rule that puts in what defines symbols."""
        return put_in(*(self.d.definition_of(s) for s in symbols))

    def known(self, *labels: str) -> list[Equation]:
        """Return lines by their labels."""
        return [self.d.recall(label).equation for label in labels]

    # -- frames and energies ---------------------------------------------------------------------

    def kinematics(self) -> None:
        """Define the angles, and derive how the top turns and where its centre goes."""
        d = self.d
        d.frame("D", self.phi)
        d.frame("F", self.theta, axis=1, base="D")
        d.frame("G", self.psi, base="F")
        across = self.I1 - self.m * self.l**2
        d.body("top", self.m, self.l * AXIS, "G", (across, across, self.I3))
        self._velocity(self._rate())

    def _rate(self) -> Chain:
        """Derive the angular velocity along the axes of E."""
        d = self.d
        turns = [omega("D", "I"), omega("F", "D"), omega("G", "F")]
        return (
            d.law(Equation(omega("G"), add(*turns)), "angular velocities add", label="turns")
            .then(
                "precession about the vertical, nutation about the line of nodes, spin about the axis",
                *(use(d.definition_of(t)) for t in turns),
                label="omega-turns",
            )
            .then(
                "the vertical lies in the plane of f2 and f3",
                along_turned(d.own, "F"),
                chain(d.scalars),
                distribute,
                collect,
                label="omega",
            )
        )

    def _velocity(self, rate: Chain) -> None:
        """Derive the velocity of the centre of mass."""
        d = self.d
        turning = d.law(
            Equation(der(AXIS), cross(omega("G"), AXIS)),
            "the axis is fixed in the top and turns with it",
            label="axis-turns",
        )
        fixed = Equation(der(expr(self.l)), number(0))
        d.start(velocity("top")).then(
            "the centre of mass lies on the axis, at a constant distance",
            use(d.definition_of(position("top"))),
            differentiate,
            use(d.given(fixed, "the top is rigid", label="rigid").equation),
            use(turning.equation),
            use(rate.equation),
            distribute,
            orthonormal("F"),
            distribute,
            label="velocity",
        )

    def energies(self) -> None:
        """Derive kinetic and potential energy by the angles and their rates."""
        d = self.d
        s, c = sp.sin(self.theta), sp.cos(self.theta)
        energy = d.define(KINETIC, "of the centre of mass, and of the turn about it", label="T")
        across = self.I1 * (self.theta_dot**2 + self.phi_dot**2 * s**2) / 2
        d.show(
            Equation(KINETIC, expr(across + self.I3 * (self.psi_dot + self.phi_dot * c) ** 2 / 2)),
            "in the axes of the top; m l^2 and the moment about the centre of mass add up to I_1",
            use(energy.equation),
            *map(use, self.known("velocity", "omega")),
            along_turned(d.own, "G"),
            distribute,
            dyads,
            distribute,
            orthonormal("G"),
            compute(),
            label="T-angles",
        )
        height = dot(unit("I", 3), position("top"))
        self.V = d.let("V", self.m * self.g * height, "potential energy")
        d.start(expr(self.V)).then(
            "the height of the centre of mass is l cos theta",
            use(d.definition_of(self.V)),
            use(d.definition_of(position("top"))),
            along_turned(d.own, "F"),
            distribute,
            orthonormal("F"),
            compute(),
            label="V",
        )

    # -- constants -------------------------------------------------------------------------------

    def momenta(self) -> None:
        """Derive Lagrange's equations, two of which say that a momentum is constant."""
        d, c = self.d, sp.cos(self.theta)
        T, V = (line.right.expression for line in self.known("T-angles", "V"))
        self.L = d.let("L", T - V, "Lagrangian, kinetic less potential energy")
        self.p_phi = d.let("p_phi", partial(self.L, self.phi_dot), "momentum of precession")
        self.p_psi = d.let("p_psi", partial(self.L, self.psi_dot), "momentum of the spin")
        pairs = ((self.phi, expr(self.p_phi)), (self.psi, expr(self.p_psi)))
        momentum = partial(self.L, self.theta_dot)
        for angle, p in (*pairs, (self.theta, momentum)):
            law, words = (
                Equation(der(p), partial(self.L, angle)),
                f"Lagrange's equation for {angle}",
            )
            d.determine(law, angle, reason=words, label=f"lagrange-{angle}")
        for angle, p in pairs:
            d.recall(f"lagrange-{angle}").then(
                f"{angle} does not stand in the Lagrangian: its momentum is constant",
                self.slope,
                label=f"{p.expression}-constant",
            )
        d.start(expr(self.p_psi)).then(
            "I_3 times the angular velocity about the axis",
            use(d.definition_of(self.p_psi)),
            self.slope,
            entrywise(sp.factor),
            label="p_psi",
        )
        along = self.I1 * self.phi_dot * sp.sin(self.theta) ** 2 + self.p_psi * c
        d.show(
            Equation(expr(self.p_phi), expr(along)),
            "the angular momentum along the vertical",
            use(d.definition_of(self.p_phi)),
            put_in(*self.known("p_psi")),
            self.slope,
            label="p_phi",
        )
        for q, rate, words in (("phi", self.phi_dot, "precession"), ("psi", self.psi_dot, "spin")):
            line = d.recall(f"p_{q}")
            line.infer(f"solved for the {words}", solved(expr(rate)), label=f"{q}-rate")

    def potential(self) -> None:
        """Derive the energy by the momenta, the motion in the effective potential, and that E stays."""
        d, p_phi, p_psi = self.d, self.p_phi, self.p_psi
        s, c = sp.sin(self.theta), sp.cos(self.theta)
        self.E = d.let("E", add(KINETIC, expr(self.V)), "energy")
        self.Ve = d.let(
            "V_eff",
            (p_phi - p_psi * c) ** 2 / (2 * self.I1 * s**2) + self.weight * c,
            "effective potential: of gravity, with the energy of precession",
        )
        whole = self.I1 * self.theta_dot**2 / 2 + self.Ve + p_psi**2 / (2 * self.I3)
        d.show(
            Equation(expr(self.E), expr(whole)),
            "the energy by both momenta: what is left is a motion of theta alone",
            use(d.definition_of(self.E)),
            *map(use, self.known("T-angles")),
            put_in(d.definition_of(self.Ve), *self.known("V", "p_phi", "p_psi")),
            label="E",
        )
        self._one_dimensional()
        d.recall("E").both(
            "the rate of the energy, as both momenta are constant, is zero",
            der,
            self.named(self.Ve),
            chain(d.scalars),
            *map(use, self.known("p_phi-constant", "p_psi-constant")),
            put_in(*self.known("theta-rate")),
            entrywise(lambda e: sp.Integer(0) if vanishes(e) else e),
            label="energy-constant",
        )

    def _one_dimensional(self) -> None:
        d = self.d
        moved = (
            d.recall("lagrange-theta")
            .both(
                "the slopes of the Lagrangian, the spin by its momentum",
                self.slope,
                self.slope,
                put_in(*self.known("psi-rate")),
                entrywise(lambda e: sp.factor(sp.expand(e))),
                label="theta-equation",
            )
            .both(
                "carried out, the precession by the momenta",
                chain(d.scalars),
                put_in(*self.known("phi-rate")),
                label="theta-motion",
            )
        )
        force = d.show(
            Equation(-partial(self.Ve, self.theta), moved.equation.right),
            "which is the force of the effective potential",
            self.named(self.Ve),
            self.slope,
            label="force",
        )
        moved.then(
            "so theta moves as a point mass in this potential",
            use(force.equation, backwards=True),
            label="one-dimensional",
        )
        moved.infer(
            "solved for the acceleration", solved(expr(self.theta_ddot)), label="theta-rate"
        )

    # -- nutation --------------------------------------------------------------------------------

    def nutation(self) -> None:
        """Derive the cubic of u = cos theta that is the square of its rate."""
        d = self.d
        energy = (2 * self.E - self.p_psi**2 / self.I3) / self.I1
        self.a = d.let("a", self.p_psi / self.I1, "momentum of the spin over I_1")
        self.b = d.let("b", self.p_phi / self.I1, "momentum of precession over I_1")
        self.alpha = d.let("alpha", energy, "twice the energy without that of the spin, over I_1")
        self.beta = d.let("beta", 2 * self.weight / self.I1, "twice m g l over I_1")
        self.u = d.let("u", sp.cos(self.theta), "cosine of the inclination")
        u_dot = d.let("u_dot", der(expr(self.u)), "rate of u")
        rate = d.start(expr(u_dot)).then(
            "differentiate",
            use(d.definition_of(u_dot)),
            self.named(self.u),
            chain(d.scalars),
            label="u-rate",
        )
        right = cubic(self.u, self.a, self.b, self.alpha, self.beta)
        d.show(
            Equation(expr(u_dot**2), expr(right)),
            "the energy by u: the square of its rate is a cubic",
            put_in(rate.equation),
            self.named(self.a, self.b, self.alpha, self.beta, self.u),
            put_in(*self.known("E")),
            self.named(self.Ve),
            label="cubic",
        ).infer(
            "so u moves where the cubic is not negative",
            signs(expr(right), (expr(u_dot**2),)),
            label="allowed",
        )

    def bounds(self) -> None:
        """Derive the ends of the cubic, the sense of precession, and how a top that is let go nods."""
        d, a, b, alpha, beta = self.d, self.a, self.b, self.alpha, self.beta
        self.w, u0 = d.constants(w="any number", u_0="cosine of the inclination where it is let go")
        w = self.w
        d.show(
            Equation(
                expr(cubic(w, a, b, alpha, beta)),
                expr((1 - w) * (1 + w) * (alpha - beta * w) - (b - a * w) ** 2),
            ),
            "at w = 1 and at w = -1 the cubic is minus a square: where it is positive in between, two "
            "of its roots lie there, and the axis nods between both",
            label="ends",
        )
        d.show(
            Equation(expr(self.phi_dot), expr((b - a * self.u) / (1 - self.u**2))),
            "the precession by u: of one sense, unless b - a u has a root between the bounds, where the "
            "path of the axis has loops; with the root at a bound it has cusps",
            self.named(a, b, self.u),
            put_in(*self.known("phi-rate")),
            label="precession-u",
        )
        d.show(
            Equation(
                expr(cubic(w, a, a * u0, beta * u0, beta)),
                expr((u0 - w) * (beta * (1 - w**2) - a**2 * (u0 - w))),
            ),
            "let go with nothing but spin, b = a u_0 and alpha = beta u_0: u_0 is the upper bound, with "
            "cusps, and the bracket gives the lower one; a fast top nods little, as a^2 is large",
            label="let-go",
        )

    # -- steady precession -----------------------------------------------------------------------

    def precession(self) -> None:
        """Derive the rates at which a top precesses without nutation."""
        d, I1, I3 = self.d, self.I1, self.I3
        tilt, rate = d.constants(theta_0="constant inclination", Omega="constant precession")
        c = sp.cos(tilt)
        words = "angular velocity about the axis with which the top precesses steadily"
        spin = d.let("omega_3", (I1 * rate * c + self.weight / rate) / I3, words)
        still = {self.theta: tilt, self.phi_dot: rate, self.theta_dot: 0, self.p_psi: I3 * spin}
        d.recall("theta-equation").infer(
            "no nutation: inclination and precession are constant, and p_psi is I_3 omega_3",
            special(still, chain({})),
            label="steady",
        ).infer(
            "where the axis is not vertical the bracket is zero: a quadratic for the precession",
            factor_zero(sp.sin(tilt)),
            label="quadratic",
        )
        other = self.weight / (I1 * rate * c)
        d.show(
            Equation(expr(I1 * other**2 * c - I3 * spin * other + self.weight), number(0)),
            "its other root: the product of both is m g l/(I_1 cos theta_0). With fast spin one is slow, "
            "near m g l/(I_3 omega_3), and one fast, near I_3 omega_3/(I_1 cos theta_0)",
            self.named(spin),
            label="other-root",
        )
        least = expr(I3**2 * spin**2 - 4 * I1 * self.weight * c)
        shown = d.show(
            Equation(least, expr((I1 * rate * c - self.weight / rate) ** 2)),
            "the discriminant is a square",
            self.named(spin),
            label="discriminant",
        )
        shown.infer(
            "so steady precession takes at least this spin; with the axis below the horizontal any "
            "spin will do",
            signs(least, (shown.equation.right,)),
            label="least-spin",
        )

    # -- the sleeping top ------------------------------------------------------------------------

    def sleeping(self) -> None:
        """Derive when a top that spins upright stays there."""
        d, a, beta, w = self.d, self.a, self.beta, self.w
        d.show(
            Equation(
                expr(cubic(w, a, a, beta, beta)), expr((1 - w) ** 2 * (beta * (1 + w) - a**2))
            ),
            "upright p_phi = p_psi and E is that of the spin and m g l, so b = a and alpha = beta: "
            "w = 1 is a double root of the cubic, the third root is a^2/beta - 1",
            label="sleeping",
        )
        excess = expr(self.p_psi**2 - 4 * self.I1 * self.weight)
        moment, height = expr(self.I1), expr(beta)
        conditions = [
            d.suppose(Equation(term, number(0), ">="), words, label=label)
            for term, words, label in (
                (excess, "let the top spin fast", "fast"),
                (moment, "moments of inertia are not negative", "moment"),
                (height, "let it stand above the fixed point", "above"),
            )
        ]
        third = expr(a**2 / beta - 2)
        factors = (excess, expr(self.I1**-2), expr(1 / beta))
        d.show(
            Equation(third, mul(*factors)),
            "how far the third root lies above one",
            self.named(a, beta),
            label="third-root",
        ).infer(
            "it lies above one, where no motion is: u cannot leave 1, the top sleeps. If it spins more "
            "slowly the root lies below one, and the top falls to it and comes back",
            signs(third, factors),
            *conditions,
            label="sleeping-stable",
        )
