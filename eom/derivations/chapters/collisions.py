"""Collisions: impulse, momentum, coefficient of restitution, energy that is lost; a rod that is struck.

Source: Goldstein, Poole, Safko, Classical Mechanics (2002), ch. 1 and 3; Greenwood, Principles of Dynamics
(1988), 4.4 and 8.2; Routh, Dynamics of a System of Rigid Bodies, elementary part (1905), art. 91.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.terms.rules import Rule, entrywise, put_in
from eom.terms.rules.inferences import integrated, signs, solved
from eom.terms.terms import Equation, der, expr, number
from eom.terms.vocabulary import quantity

Expr = Any
P, FORCE = quantity("linear_momentum", "system"), quantity("external_force", "system")
H, TORQUE = quantity("angular_momentum", "body", "C"), quantity("torque", "body", "C")
FACTORS = entrywise(sp.factor)


def collisions() -> Derived:
    """Derive what bodies do when they hit each other, and when they are struck."""
    d = Derivation("collisions", "Collisions and blows", "Particles")
    _impulse(d)
    pair = Pair(d)
    pair.velocities()
    pair.impulse()
    pair.energy()
    rod = Rod(d)
    rod.free()
    rod.hanging()
    return d.finish()


def _impulse(d: Derivation) -> None:
    """Derive that momentum changes by the impulse, and angular momentum by that of the torque."""
    d.only("newton_2", "third_law_weak", "constant_mass")
    d.law(
        Equation(der(P), FORCE),
        "the rate of the momentum is the external force: internal ones cancel",
        label="momentum-rate",
    ).infer(
        "momentum changes by the impulse, the integral of the external force over the time of the blow",
        integrated(),
        label="impulse",
    )
    d.only("newton_2", "third_law_strong", "constant_mass")
    d.law(
        Equation(der(H), TORQUE),
        "the rate of the angular momentum is the torque, both about the centre of mass",
        label="spin-rate",
    ).infer(
        "angular momentum changes by the integral of the torque", integrated(), label="spin-impulse"
    )
    d.only()


class Pair:
    """Two bodies that meet head-on, with the symbols of it."""

    def __init__(self, d: Derivation) -> None:
        self.d = d
        self.m1, self.m2, self.e, self.v1, self.v2 = d.constants(
            m_1="mass of the first body",
            m_2="mass of the second body",
            e="coefficient of restitution",
            v_1="velocity of the first body before",
            v_2="velocity of the second body before",
        )
        (self.u1,), (self.u2,) = (
            d.coordinate(f"u_{k}", f"velocity of the {word} body after", 0)
            for k, word in ((1, "first"), (2, "second"))
        )
        self.apart = self.v1 - self.v2

    def velocities(self) -> None:
        """Derive both velocities after the blow."""
        d, m1, m2 = self.d, self.m1, self.m2
        momentum = d.determine(
            Equation(expr(m1 * self.u1 + m2 * self.u2), expr(m1 * self.v1 + m2 * self.v2)),
            self.u1,
            reason="no impulse acts from outside: the momentum stays",
            label="momentum",
        )
        restitution = d.determine(
            Equation(expr(self.u2 - self.u1), expr(self.e * self.apart)),
            self.u2,
            reason="Newton's law of impact: they part e times as fast as they met; 1 is elastic, 0 plastic",
            label="restitution",
        )
        other = restitution.infer("the second velocity", solved(expr(self.u2)), label="u_2-by-u_1")
        first = momentum.both(
            "put into the momentum", put_in(other.equation), label="momentum-u_1"
        ).infer("solved for the first velocity", solved(expr(self.u1)), label="u_1")
        other.then("and the second one", put_in(first.equation), FACTORS, label="u_2")

    def impulse(self) -> None:
        """Derive the impulse between both."""
        d, m1, m2 = self.d, self.m1, self.m2
        self.mu = d.let("m_r", m1 * m2 / (m1 + m2), "reduced mass")
        known = (put_in(*(d.recall(label).equation for label in ("u_1", "u_2"))), self.reduced)
        d.show(
            Equation(expr(m2 * (self.u2 - self.v2)), expr(self.mu * (1 + self.e) * self.apart)),
            "the impulse on the second body: that of a plastic blow and e times as much",
            *known,
            label="impulse-between",
        )

    @property
    def reduced(self) -> Rule:
        """The rule that puts in the reduced mass."""
        return put_in(self.d.definition_of(self.mu))

    def energy(self) -> None:
        """Derive the energy that is lost, and that it is not negative."""
        d, m1, m2, e = self.d, self.m1, self.m2, self.e
        before = (m1 * self.v1**2 + m2 * self.v2**2) / 2
        after = (m1 * self.u1**2 + m2 * self.u2**2) / 2
        lost = d.let("D", before - after, "kinetic energy that is lost")
        shown = d.show(
            Equation(expr(lost), expr(self.mu * (1 - e**2) * self.apart**2 / 2)),
            "energy is lost from the motion against each other alone; none of it where e is 1, all of it "
            "where e is 0",
            put_in(d.definition_of(lost)),
            put_in(*(d.recall(label).equation for label in ("u_1", "u_2"))),
            self.reduced,
            label="energy-lost",
        )
        conditions = [
            d.suppose(Equation(expr(s), number(0), ">="), words, label=label)
            for s, words, label in (
                (self.mu, "masses are positive, and so is the reduced one", "masses"),
                (1 - e**2, "let e be at most one", "e-range"),
            )
        ]
        shown.infer(
            "so no energy is gained: e cannot exceed one without a store of it",
            signs(
                expr(lost),
                (expr(self.mu), expr(1 - e**2), expr(self.apart**2), number(1, 2)),
            ),
            *conditions,
            label="no-gain",
        )


class Rod:
    """A uniform rod that is struck across, with the symbols of it."""

    def __init__(self, d: Derivation) -> None:
        self.d = d
        self.m, self.l, self.P = d.constants(
            m="mass of the rod", l="length of the rod", P="impulse of the blow, across the rod"
        )
        words = "moment of inertia of the rod about its centre of mass"
        self.J = d.let("J", self.m * self.l**2 / 12, words)

    def law(self, left: Expr, right: Expr, of: Expr, reason: str, label: str) -> Equation:
        """State a balance, and solve it for what it determines."""
        line = self.d.determine(Equation(expr(left), expr(right)), of, reason=reason, label=label)
        return line.infer("solved", solved(expr(of)), label=f"{label}-solved").equation

    def free(self) -> None:
        """Derive how a free rod moves off, which point stays at rest, and the energy that it gets."""
        d, m, J, P = self.d, self.m, self.J, self.P
        (a,) = d.constants(a="distance of the blow from the centre of mass")
        (v,) = d.coordinate("v", "velocity of the centre of mass after the blow", 0)
        (w,) = d.coordinate("omega", "angular velocity of the rod after the blow", 0)
        known = put_in(
            self.law(m * v, P, v, "the rod was at rest: its momentum is the impulse", "rod"),
            self.law(J * w, P * a, w, "its angular momentum is that of the impulse", "rod-spin"),
        )
        b = d.let("b", J / (m * a), "distance of another point from the centre, on the other side")
        at_rest = put_in(d.definition_of(b))
        d.show(
            Equation(expr(v - w * b), number(0)),
            "the velocity of that point: it stays at rest, the blow turns the rod about it",
            known,
            at_rest,
            label="at-rest",
        )
        d.show(
            Equation(expr(a * b), expr(self.l**2 / 12)),
            "both distances are exchangeable: struck there, the rod turns about the point of the former "
            "blow; a rod that is struck a sixth of its length from its centre turns about its end",
            at_rest,
            put_in(d.definition_of(J)),
            label="exchange",
        )
        d.show(
            Equation(expr(m * v**2 / 2 + J * w**2 / 2), expr(P * (v + w * a) / 2)),
            "the energy is the impulse times half the velocity of the point that is struck",
            known,
            label="rod-energy",
        )

    def hanging(self) -> None:
        """Derive where a rod on a pivot has to be struck so that the pivot feels nothing."""
        d, m, l, P = self.d, self.m, self.l, self.P
        J_O = d.let(
            "J_O", self.J + m * (l / 2) ** 2, "moment of inertia about an end, by parallel axes"
        )
        d.show(
            Equation(expr(J_O), expr(m * l**2 / 3)),
            "both together",
            put_in(d.definition_of(J_O), d.definition_of(self.J)),
            label="end",
        )
        (h,) = d.constants(h="distance of the blow from the pivot at an end of the rod")
        (turn,) = d.coordinate("Omega", "angular velocity of the rod on its pivot", 0)
        (R,) = d.coordinate("R", "impulse of the pivot, along the blow", 0)
        known = put_in(
            self.law(
                J_O * turn, P * h, turn, "about the pivot its own impulse has no moment", "pivot"
            ),
            self.law(m * turn * l / 2, P + R, R, "momentum is from both impulses", "pivot-impulse"),
        )
        d.show(
            Equation(expr(R), expr(P * (3 * h - 2 * l) / (2 * l))),
            "the pivot pushes with the blow beyond two thirds of the length, against it before: struck "
            "there, at the centre of percussion, it feels nothing",
            known,
            put_in(d.definition_of(J_O), d.definition_of(self.J)),
            label="percussion",
        )
