"""N particles under constraints: d'Alembert's principle, Lagrange's equations, Kane's equations.

Source: Goldstein, Poole, Safko, Classical Mechanics (2002), 1.4; Kane and Levinson, Dynamics (1985),
4.4 and 6.1.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.terms.rules import (
    combine,
    differentiate,
    differentiate_under,
    distribute,
    entrywise,
    linear_slopes,
    out_of_sums,
    put_in,
    slopes,
    unfold,
    use,
)
from eom.terms.rules.inferences import solved, summed
from eom.terms.terms import (
    SCALAR,
    Equation,
    Term,
    add,
    atom,
    der,
    dot,
    expr,
    mul,
    number,
    partial,
    total,
)
from eom.terms.vocabulary import mass, position, quantity, velocity

Expr = Any
R, V, A = position("i"), velocity("i"), der(velocity("i"))
M = mass("i")
APPLIED, HELD = quantity("applied_force", "i"), quantity("constraint_force", "i")
KINETIC = quantity("kinetic_energy", "system")
_ACTIVE, _INERT = "generalised active force", "generalised inertia force"
_LINEAR = (
    "the rates of the coordinates are linear in u, with slopes W_1, W_2: such is the partial "
    "velocity of u"
)


def virtual_work() -> Derived:
    """Derive the equations of Lagrange and Kane of N particles from Newton's law."""
    d = Derivation(
        "virtual-work",
        "From d'Alembert's principle to Lagrange's and Kane's equations",
        "Particles",
    )
    work = Work(d)
    work.newton()
    for k in (1, 2):
        work.principle(k)
        work.velocities(k)
        work.kinetic(k)
    work.energies()
    for k in (1, 2):
        work.potential(k)
        work.kane(k)
    work.speeds()
    return d.finish()


class Work:
    """The chapter, part by part, with its symbols."""

    def __init__(self, d: Derivation) -> None:
        self.d = d
        first, second = (
            d.coordinate(f"q_{k}", f"{word} coordinate", 1)
            for k, word in ((1, "any"), (2, "any other"))
        )
        self.q = {1: first[0], 2: second[0]}
        self.rate = {1: first[1], 2: second[1]}
        self.force: dict[int, Expr] = {}
        self.active: dict[int, Expr] = {}
        self.inert: dict[int, Expr] = {}
        d.configure(*self.q.values())
        d.letter(sp.Symbol("u"), "any speed in which the rates of the coordinates are linear")

    def slope(self, k: int) -> Term:
        """Return the slope of the place of a particle by a coordinate."""
        return partial(R, expr(self.q[k]))

    def newton(self) -> None:
        """State Newton's law, with the forces of constraints apart."""
        d = self.d
        d.only("newton_2", "constant_mass")
        d.given(Equation(der(M), number(0)), "masses are constant", label="masses")
        d.define(APPLIED, "all forces on a particle but that of the constraints", label="applied")
        d.law(Equation(add(APPLIED, HELD), mul(M, A)), "Newton's second law", label="newton").infer(
            "solved for the force of the constraints", solved(HELD), label="held"
        )

    def principle(self, k: int) -> None:
        """Derive d'Alembert's principle along a coordinate."""
        d = self.d
        along = self.slope(k)
        ideal = d.given(
            Equation(total(dot(HELD, along)), number(0)),
            "the constraints do no virtual work: along a coordinate at one instant none of their power "
            "is seen, however they move",
            label=f"ideal-{k}",
        )
        force = self.force[k] = d.let(f"Q_{k}", total(dot(APPLIED, along)), "generalised force")
        ideal.both(
            "with Newton's law",
            lambda t: distribute(use(d.recall("held").equation)(t)),
            label=f"virtual-work-{k}",
        ).infer(
            "d'Alembert's principle: applied forces and masses times accelerations do the same work",
            solved(total(dot(APPLIED, along))),
            label=f"dalembert-{k}",
        )
        d.recall(f"dalembert-{k}").both(
            "the left side is the generalised force",
            use(d.definition_of(force), backwards=True),
            label=f"force-{k}",
        )

    def inertia(self, k: int) -> Term:
        """Return the work of masses times accelerations along a coordinate."""
        return total(mul(M, dot(A, self.slope(k))))

    # -- Lagrange --------------------------------------------------------------------------------

    def velocities(self, k: int) -> None:
        """Derive that dots cancel, and that both derivatives may be exchanged."""
        d, q, rate = self.d, self.q[k], self.rate[k]
        by = slopes(d.scalars, d.own)
        d.start(partial(V, rate)).then(
            "the velocity is linear in the rates, with the slopes of the place: the dots cancel",
            by,
            label=f"dots-{k}",
        )
        d.start(partial(V, q)).then(
            "the slope of the velocity is the rate of the slope", by, label=f"exchange-{k}"
        )

    def kinetic(self, k: int) -> None:
        """Derive both slopes of the kinetic energy, and Lagrange's equation."""
        d, q, rate, along = self.d, self.q[k], self.rate[k], self.slope(k)
        by = (unfold("kinetic_energy"), slopes(d.scalars, d.own))
        momentum = d.show(
            Equation(partial(KINETIC, rate), total(mul(M, dot(V, along)))),
            "the slope of the kinetic energy by the rate",
            *by,
            label=f"momentum-{k}",
        )
        other = d.show(
            Equation(partial(KINETIC, q), total(mul(M, dot(V, der(along))))),
            "and by the coordinate",
            *by,
            label=f"slope-{k}",
        )
        momentum.both(
            "the rate of the former: masses are constant",
            der,
            differentiate_under,
            differentiate,
            use(d.recall("masses").equation),
            distribute,
            label=f"momentum-rate-{k}",
        ).infer(
            "less the latter: masses times accelerations along the coordinate are left",
            summed(number(1), number(-1), applied=(distribute, combine)),
            other,
            label=f"inertia-{k}",
        ).then(
            "which is the generalised force: Lagrange's equation",
            use(d.recall(f"force-{k}").equation, backwards=True),
            label=f"lagrange-{k}",
        )

    # -- with a potential ------------------------------------------------------------------------

    def energies(self) -> None:
        """Name the potential, a function of the coordinates, and the Lagrangian."""
        d = self.d
        variables = [f"coordinate {q}" for q in self.q.values()]
        self.V = d.let(
            "V",
            atom("function", "V", *variables, kind=SCALAR),
            "potential of a part of the forces, a function of the coordinates",
        )
        self.L = d.let("L", add(KINETIC, -expr(self.V)), "Lagrangian")

    def potential(self, k: int) -> None:
        """Derive Lagrange's equation where a part of the forces has a potential."""
        d, q, rate = self.d, self.q[k], self.rate[k]
        rest = d.let(
            f"P_{k}",
            add(expr(self.force[k]), partial(self.V, q)),
            "generalised force of what has no potential",
        )
        by = (use(d.definition_of(self.L)), linear_slopes, slopes(d.scalars, d.own), distribute)
        momentum = d.show(
            Equation(partial(self.L, rate), partial(KINETIC, rate)),
            "the potential does not depend on rates",
            *by,
            label=f"momentum-L-{k}",
        )
        d.show(
            Equation(
                add(der(partial(self.L, rate)), -partial(self.L, q)),
                expr(rest),
            ),
            "Lagrange's equation with the Lagrangian: forces with a potential do not stand on the right",
            use(momentum.equation),
            use(d.definition_of(rest)),
            use(d.definition_of(self.L)),
            linear_slopes,
            use(self.separated(k)),
            distribute,
            label=f"lagrange-L-{k}",
        )

    def separated(self, k: int) -> Equation:
        """Return Lagrange's equation solved for the generalised force."""
        return (
            self.d.recall(f"lagrange-{k}")
            .turned("turned round", label=f"lagrange-turned-{k}")
            .equation
        )

    # -- Kane ------------------------------------------------------------------------------------

    def kane(self, k: int) -> None:
        """Derive Kane's equation where the speeds are the rates of the coordinates."""
        d = self.d
        along = partial(V, self.rate[k])
        active = self.active[k] = d.let(f"F_{k}", total(dot(APPLIED, along)), _ACTIVE)
        inert = self.inert[k] = d.let(f"G_{k}", -total(mul(M, dot(A, along))), _INERT)
        d.chain_of(inert).infer(
            "the sum in it", solved(total(mul(M, dot(A, along)))), label=f"inert-sum-{k}"
        )
        dots = use(d.recall(f"dots-{k}").equation)
        other = d.start(expr(inert)).then(
            "with the slope of the place",
            use(d.definition_of(inert)),
            dots,
            label=f"inert-{k}",
        )
        d.start(expr(active)).then(
            "the partial velocity is the slope of the place; d'Alembert's principle",
            use(d.definition_of(active)),
            dots,
            use(d.recall(f"dalembert-{k}").equation),
            label=f"active-{k}",
        ).infer(
            "Kane's equation: generalised active and inertia forces balance",
            summed(number(1), number(1), applied=(combine,)),
            other,
            label=f"kane-{k}",
        )

    def speeds(self) -> None:
        """Derive Kane's equation for any speed on which the rates of the coordinates depend."""
        d = self.d
        weights = {
            k: d.coordinate(f"W_{k}", f"slope of the rate of q_{k} by a speed u", 0)[0]
            for k in (1, 2)
        }
        along = add(*(mul(expr(w), partial(V, self.rate[k])) for k, w in weights.items()))
        active = d.let("F_u", total(dot(APPLIED, along)), _ACTIVE)
        inert = d.let("G_u", -total(mul(M, dot(A, along))), _INERT)
        by_coordinates = [
            *(use(d.definition_of(self.active[k]), backwards=True) for k in (1, 2)),
            *(use(d.recall(f"inert-sum-{k}").equation) for k in (1, 2)),
        ]
        parts = [
            d.start(expr(whole)).then(
                words,
                use(d.definition_of(whole)),
                distribute,
                out_of_sums(d.scalars),
                *by_coordinates,
                label=f"{whole}",
            )
            for whole, words in ((active, _LINEAR), (inert, "and the same of the inertia force"))
        ]
        balances = [d.recall(f"kane-{k}") for k in (1, 2)]
        solutions = [
            b.infer("solved", solved(expr(self.active[k])), label=f"balance-{k}")
            for k, b in enumerate(balances, 1)
        ]
        parts[0].infer(
            "Kane's equation for any speed: one for each speed that is free",
            summed(
                number(1),
                number(1),
                applied=(put_in(*(s.equation for s in solutions)), entrywise(sp.expand)),
            ),
            parts[1],
            label="kane",
        )
