"""A rigid satellite under the torque of gravity on a circular orbit: small motions and their stability.

Source: Hughes, Spacecraft Attitude Dynamics (1986), ch. 9, whose angles and ratios of inertia these are;
DeBra and Delp, Rigid body attitude stability and natural frequencies in a circular orbit (1961).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import sympy as sp

from eom.derivations.conditions import let, so
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.exact.algebra import gather, gather_above
from eom.kinematics.frames import time_derivative
from eom.terms.rules import (
    along_turned,
    by_axes,
    chain,
    collect,
    compute,
    distribute,
    dyads,
    entrywise,
    orthonormal,
    put_in,
    resolved,
    transport,
    use,
)
from eom.terms.rules.inferences import (
    along_axis,
    equal,
    exponential,
    linearised,
    signs,
    solved,
)
from eom.terms.terms import Equation, add, column, cross, der, dot, expr, mul
from eom.terms.vocabulary import omega, quantity, unit

Expr = Any
BODY = "craft"
H, J = quantity("angular_momentum", BODY, BODY), quantity("inertia", "C")
DOWN = unit("D", 3)
AXES = tuple(unit("G", k) for k in (1, 2, 3))
PLACES = (1, 2, 3)


def gravity_gradient_stability() -> Derived:
    """Derive when a satellite that keeps one side to the Earth does so stably."""
    d = Derivation(
        "gravity-gradient-stability", "Stability under the gravity gradient", "Spacecraft"
    )
    craft = Craft(d)
    craft.frames()
    craft.momentum()
    craft.torque()
    craft.rows()
    craft.small_motions()
    craft.characteristic()
    craft.pitch()
    craft.roll_and_yaw()
    craft.region()
    return d.finish()


class Craft:
    """The chapter, part by part, with its symbols."""

    def __init__(self, d: Derivation) -> None:
        self.d = d
        self.n, *self.I = d.constants(
            n="rate of the orbit",
            **{f"I_{k}": f"principal moment of inertia about g{k}" for k in PLACES},
        )
        self.eta, self.eta_dot = d.coordinate("eta", "way along the orbit, as an angle", 1)
        angles = (("phi", "roll"), ("theta", "pitch"), ("psi", "yaw"))
        self.angles = [d.coordinate(name, f"angle of {words}") for name, words in angles]
        self.rates = {q: r for row in self.angles for q, r in pairwise(row)}

    def line(self, label: str) -> Equation:
        """Return a line by its label."""
        return self.d.recall(label).equation

    # -- kinematics ------------------------------------------------------------------------------

    def frames(self) -> None:
        """Define the orbit frame D and the turns from it to the body."""
        d = self.d
        d.determine(
            Equation(der(expr(self.eta)), expr(self.n)),
            self.eta,
            reason="the orbit is a circle",
            label="orbit",
        )
        d.frame("D", -self.eta, axis=2)
        (phi, *_), (theta, *_), (psi, *_) = self.angles
        for name, angle, axis, base in (
            ("K", psi, 3, "D"),
            ("F", theta, 2, "K"),
            ("G", phi, 1, "F"),
        ):
            d.frame(name, angle, axis, base)
        (m, r) = d.constants(m="mass", r="radius of the orbit")
        d.body(BODY, m, -r * DOWN, "G", self.I)
        turns = [omega("D", "I"), omega("K", "D"), omega("F", "K"), omega("G", "F")]
        d.law(
            Equation(omega("G"), add(*turns)),
            "angular velocities add: of the orbit frame, whose third axis points down and whose second "
            "one is against the orbit normal, then yaw, pitch and roll",
            label="turns",
        ).then(
            "along the axes of the body",
            *(use(d.definition_of(t)) for t in turns),
            chain(d.scalars),
            put_in(d.definition_of(self.eta_dot), self.line("orbit")),
            along_turned(d.own, "G"),
            distribute,
            collect,
            label="omega-turns",
        )
        self.omega = self._along(omega("G"), "omega", "angular velocity", "turns")
        self.down = self._along(DOWN, "c", "direction down", "")
        self.spins = [d.let(f"{w}_dot", der(expr(w)), f"rate of {w}") for w in self.omega]

    def _along(self, vector: Any, letter: str, words: str, source: str) -> list[Expr]:
        """Name the components of a vector in the body, and write them by the angles."""
        d = self.d
        found = []
        for k, axis in enumerate(AXES, 1):
            s = d.let(f"{letter}_{k}", dot(axis, vector), f"component of the {words} along g{k}")
            known = [use(self.line("omega-turns"))] if source else []
            d.start(expr(s)).then(
                f"the {words} along g{k}, by the angles",
                use(d.definition_of(s)),
                *known,
                along_turned(d.own, "G"),
                distribute,
                orthonormal("G"),
                compute(),
                entrywise(sp.expand),
                label=f"{letter}-{k}",
            )
            found.append(s)
        return found

    # -- Euler's equations -----------------------------------------------------------------------

    def momentum(self) -> None:
        """Derive the rate of the momentum by components in the body."""
        d = self.d
        named = d.start(omega("G")).then(
            "by its components",
            resolved(omega("G"), "G"),
            *(use(d.definition_of(w), backwards=True) for w in self.omega),
            label="omega",
        )
        h = d.define(H, "angular momentum of the craft about its centre of mass", label="h")
        columns = d.start(column(H, "G")).then(
            "by components: G has the principal axes",
            by_axes("G"),
            use(h.equation),
            use(named.equation),
            distribute,
            dyads,
            distribute,
            orthonormal("G"),
            compute(),
            label="h-columns",
        )
        turning = d.start(column(omega("G"), "G")).then(
            "by components",
            by_axes("G"),
            *(use(d.definition_of(w), backwards=True) for w in self.omega),
            label="omega-columns",
        )
        seen = d.start(der(H)).then("the transport theorem", transport("G"), label="h-rate")
        rates = dict(zip(self.omega, self.spins, strict=True))
        d.in_components(
            seen,
            "G",
            "by components",
            use(columns.equation),
            use(turning.equation),
            compute(rates),
            entrywise(lambda e: gather(e, self.omega)),
            label="h-rate-columns",
        )

    def torque(self) -> None:
        """State the torque of gravity, of any body and of the craft, and take its components."""
        d, down = self.d, DOWN
        d.assume("body_frame")
        u, J = quantity("orbit_direction"), quantity("inertia", "C")
        mu, radius = (
            d.let(name, quantity(*of), words)
            for name, of, words in (
                ("mu", ("gravity_parameter",), "gravitational parameter of the Earth"),
                ("R", ("orbit_radius",), "distance from the centre of the Earth"),
            )
        )
        d.law(
            Equation(
                quantity("gravity_torque"), mul(expr(3 * mu / radius**3), cross(u, dot(J, u)))
            ),
            "gravity falls off as the square of the distance: its torque on any body, to second order "
            "in the size of the body",
            label="gravity",
        )
        d.only()
        pull = cross(down, dot(d.own.bodies[BODY].inertia, down))
        (phi, *_), (theta, *_), (psi, *_) = self.angles
        d.determine(
            Equation(der(H), mul(expr(3 * self.n**2), pull)),
            phi,
            theta,
            psi,
            reason="the torque of gravity on the craft: mu/R^3 is n^2 on a circular orbit",
            label="law",
        )
        d.start(down).then(
            "by its components",
            resolved(down, "G"),
            *(use(d.definition_of(c), backwards=True) for c in self.down),
            label="down",
        )

    def rows(self) -> None:
        """Derive Euler's equations about the principal axes."""
        d = self.d
        law, down = (self.line(label) for label in ("law", "down"))
        for k, axis in enumerate(AXES, 1):
            side = d.recall("h-rate-columns").infer(
                f"row {k}", along_axis("G", k), label=f"h-rate-{k}"
            )
            pull = d.start(dot(axis, der(H))).then(
                f"the torque about g{k}",
                use(law),
                use(down),
                distribute,
                dyads,
                distribute,
                orthonormal("G"),
                distribute,
                orthonormal("G"),
                compute(),
                entrywise(sp.factor),
                label=f"torque-{k}",
            )
            tidy = entrywise(lambda e: gather(e, self.omega))
            side.infer("Euler's equation with this torque", equal(tidy), pull, label=f"euler-{k}")

    # -- small motions ---------------------------------------------------------------------------

    def small_motions(self) -> None:
        """Derive the linear equations of small roll, pitch and yaw."""
        d = self.d
        words = ("roll", "pitch", "yaw")
        self.small = [
            d.coordinate(f"alpha_{k}", f"small {word}") for k, word in enumerate(words, 1)
        ]
        pairs = zip(self.angles, self.small, strict=True)
        deviations = {q: x for row, new in pairs for q, x in zip(row, new, strict=True)}
        still = dict.fromkeys(deviations, sp.Integer(0))
        by_angles = [
            *(d.recall(f"omega-{k}") for k in PLACES),
            *(d.recall(f"c-{k}") for k in PLACES),
        ]
        tidy = entrywise(lambda e: gather_above(e, [x for row in self.small for x in row]))
        for k, (word, (_, _, second)) in enumerate(zip(words, self.small, strict=True), 1):
            d.recall(f"euler-{k}").infer(
                f"linearised: the equation of small {word}",
                linearised(self._rest, deviations, still),
                *by_angles,
                label=f"small-{k}",
                unknowns=(self.small[k - 1][0],),
            ).infer("divided by the moment", solved(expr(second), tidy), label=f"rate-{k}")

    def _rest(self, lines: Sequence[Equation]) -> Expr:
        """Return left less right of Euler's equation, the first line, by the angles of the others."""
        row, *others = lines
        values = {e.left.expression: e.right.expression for e in others}
        for w, rate in zip(self.omega, self.spins, strict=True):
            values[rate] = time_derivative(values[w], self.rates)
        return (row.left.expression - row.right.expression).xreplace(values)

    def characteristic(self) -> None:
        """Derive the characteristic polynomials, of pitch alone and of roll with yaw."""
        d, n = self.d, self.n
        I1, I2, I3 = self.I
        (self.root,) = d.constants(**{"lambda": "root: the motion goes like exp(lambda t)"})
        self.k1 = d.let("k_1", (I2 - I3) / I1, "ratio of moments of inertia for roll")
        self.k3 = d.let("k_3", (I2 - I1) / I3, "ratio of moments of inertia for yaw")
        (a1, v1, s1), _, (a3, v3, s3) = self.small
        by_ratios = put_in(d.definition_of(self.k1), d.definition_of(self.k3))
        rolls = [
            (s1, -4 * n**2 * self.k1 * a1 + n * (1 - self.k1) * v3, "rate-1", "roll"),
            (s3, -(n**2) * self.k3 * a3 - n * (1 - self.k3) * v1, "rate-3", "yaw"),
        ]
        lines = [
            d.show(
                Equation(expr(left), expr(right)),
                f"{word} by the ratios of inertia",
                by_ratios,
                put_in(self.line(label)),
                label=word,
            )
            for left, right, label, word in rolls
        ]
        motions = [{x: 0, v: 1, a: 2} for x, v, a in self.small]
        d.recall("rate-2").infer(
            "pitch is alone", exponential([motions[1]], self.root), label="pitch"
        )
        lines[0].infer(
            "roll and yaw together",
            exponential([motions[0], motions[2]], self.root),
            lines[1],
            label="roll-yaw",
        )

    # -- stability -------------------------------------------------------------------------------

    def pitch(self) -> None:
        """Derive that pitch is stable where the axis down has less inertia than that of roll."""
        I1, I2, I3 = self.I
        *self.positive, self.slim = let(
            self.d,
            *((J, "moments of inertia are not negative", f"{J}-positive") for J in self.I),
            (I1 - I3, "let I_1 be no less than I_3", "slim"),
        )
        squared = 3 * self.n**2 * (I1 - I3) / I2
        factors = (expr(3 * self.n**2), expr(I1 - I3), expr(1 / I2))
        self.d.recall("pitch").infer(
            "then -lambda^2 is not negative: pitch oscillates, at the rate n sqrt(3 (I_1 - I_3)/I_2)",
            signs(expr(squared), factors),
            self.slim,
            self.positive[1],
            label="pitch-stable",
        )

    def roll_and_yaw(self) -> None:
        """Derive the three conditions on a biquadratic whose roots are all on the imaginary axis."""
        d, n, k1, k3, root = self.d, self.n, self.k1, self.k3, self.root
        b = d.let("s", n**2 * (1 + 3 * k1 + k1 * k3), "coefficient of lambda^2")
        c = d.let("w", 4 * n**4 * k1 * k3, "what is free of lambda")
        whole = self.line("roll-yaw")
        d.show(
            Equation(whole.left, expr(root**4 + b * root**2 + c)),
            "a quadratic for lambda^2",
            use(whole),
            put_in(d.definition_of(b), d.definition_of(c)),
            label="biquadratic",
        )
        self._necessary()
        self._sufficient(b, c)
        d.show(
            Equation(expr(b**2 - 4 * c), expr(n**4 * ((1 + 3 * k1 + k1 * k3) ** 2 - 16 * k1 * k3))),
            "so roll and yaw are stable where k_1 k_3 > 0, 1 + 3 k_1 + k_1 k_3 > 0, and the square of "
            "the latter exceeds 16 k_1 k_3: the regions of Lagrange and of DeBra and Delp",
            put_in(d.definition_of(b), d.definition_of(c)),
            label="regions",
        )

    def _necessary(self) -> None:
        """Derive the conditions from two oscillations."""
        d, root = self.d, self.root
        p, q = d.constants(p="square of a rate", q="square of another rate")
        d.show(
            Equation(
                expr((root**2 + p) * (root**2 + q)), expr(root**4 + (p + q) * root**2 + p * q)
            ),
            "with two oscillations lambda^2 is -p and -q: the sum p + q is s, the product p q is w",
            label="oscillations",
        )
        words = "squares of real rates are not negative"
        both = let(d, *((s, words, f"{s}-positive") for s in (p, q)))
        for value, products, label in (
            (p + q, ((expr(p),), (expr(q),)), "sum"),
            (p * q, ((expr(p), expr(q)),), "product"),
        ):
            both[0].infer(
                f"so {'s' if label == 'sum' else 'w'} is not negative",
                signs(expr(value), *products),
                both[1],
                label=f"{label}-sign",
            )
        square = (p + q) ** 2 - 4 * p * q
        d.show(
            Equation(expr(square), expr((p - q) ** 2)),
            "and s^2 - 4 w is a square",
            label="discriminant",
        ).infer(
            "so it is not negative",
            signs(expr(square), (expr((p - q) ** 2),)),
            label="discriminant-sign",
        )

    def _sufficient(self, b: Expr, c: Expr) -> None:
        """Derive that a quadratic with these signs has no positive root, and real ones."""
        d = self.d
        (x,) = d.constants(x="any number, for lambda^2")
        d.show(
            Equation(expr(4 * (x**2 + b * x + c)), expr((2 * x + b) ** 2 - (b**2 - 4 * c))),
            "conversely, the square completed: the roots for lambda^2 are real if s^2 - 4 w is not "
            "negative",
            label="completed",
        )
        conditions = let(d, *((s, f"let {s} be not negative", f"{s}-positive") for s in (b, c, x)))
        conditions[0].infer(
            "and none of them is positive: -lambda^2 is the square of a rate",
            signs(expr(x**2 + b * x + c), (expr(x**2),), (expr(b), expr(x)), (expr(c),)),
            *conditions[1:],
            label="no-positive-root",
        )

    def region(self) -> None:
        """Derive that a body whose axes have moments in the order of Lagrange is stable."""
        d, k1, k3 = self.d, self.k1, self.k3
        I1, I2, I3 = self.I
        known = [
            *self.positive,
            self.slim,
            *let(
                d,
                (I2 - I1, "let I_2 be no less than I_1", "flat"),
                (I1 + I3 - I2, "no moment of inertia exceeds the sum of the others", "triangle"),
            ),
        ]
        apart = (I1 - I3, I1 + I3 - I2, 1 / I1, 1 / I3)
        for value, products, words, label in (
            (k3, ((I2 - I1, 1 / I3),), "then the ratio for yaw is not negative", "k_3"),
            (k1 - k3, (apart,), "nor is that for roll less: pitch is stable", "k_1-k_3"),
            (k1, ((k1 - k3,), (k3,)), "so both are not negative", "k_1"),
            (k1 * k3, ((k1, k3),), "and their product", "k_1 k_3"),
        ):
            known.append(so(known, value, products, words, f"{label}-sign"))
        self._lagrange(known)

    def _lagrange(self, known: list[Chain]) -> None:
        """Derive the third condition in Lagrange's region."""
        d, k1, a = self.d, self.k1, self.k3
        apart, least = k1 - a, (1 + 3 * k1 + k1 * a) ** 2 - 16 * k1 * a
        parts = (
            ((a - 1) ** 2 + a) * (1 + 7 * a + a**2),
            2 * apart * (3 + 2 * a + 6 * a**2 + a**3),
            apart**2 * (3 + a) ** 2,
        )
        shown = d.show(
            Equation(expr(least), expr(sp.Add(*parts))),
            "the third condition by k_3 and k_1 - k_3",
            label="lagrange-terms",
        )
        first = [
            (f, *more)
            for f in ((a - 1) ** 2, a)
            for more in ((sp.S.One,), (sp.Integer(7), a), (a, a))
        ]
        second = [(sp.Integer(n), apart, *(a,) * k) for k, n in enumerate((6, 4, 12, 2))]
        so(
            [shown, *known],
            least,
            (*first, *second, (parts[2],)),
            "and the discriminant: with I_2 >= I_1 >= I_3, the axis of most inertia across the orbit and "
            "that of least along the vertical, roll, pitch and yaw are all stable: Lagrange's region",
            "lagrange",
        )
