"""A body that takes in or loses mass: Meshchersky's equation, thrust, two special cases.

Source: Greenwood, Principles of Dynamics (1988), ch. 4.
"""

from __future__ import annotations

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.terms.rules import combine, differentiate, distribute, less, use
from eom.terms.rules.inferences import equal, solved
from eom.terms.terms import Equation, add, der, mul, zero
from eom.terms.vocabulary import mass, quantity, velocity

M, FORCE, V = mass("open"), quantity("force", "open"), velocity("open")
RELATIVE = quantity("exhaust_velocity", "open")


def variable_mass() -> Derived:
    """Derive the motion of a body whose mass changes, from the momentum that goes with its mass."""
    d = Derivation("variable-mass", "A body whose mass changes", "Particles")
    _thrust(d)
    _special(d)
    return d.finish()


def _thrust(d: Derivation) -> None:
    d.only("newton_2")
    law = d.law(
        Equation(der(mul(M, V)), add(FORCE, mul(der(M), add(V, RELATIVE)))),
        "the momentum of what is in the body changes by the force, and by the momentum of what goes in "
        "or out, whose velocity is that of the body and the relative one",
        label="momentum",
    )
    rate = d.start(der(mul(M, V))).then("product rule", differentiate, label="momentum-rate")
    law.infer(
        "both are the same rate; the term with the velocity of the body stands on both sides and is "
        "taken away",
        equal(distribute, less(mul(der(M), V))),
        rate,
        label="balance",
    ).turned(
        "mass times acceleration is the force and the thrust, the rate of the mass times its relative "
        "velocity: a rocket, whose mass falls, is driven against the stream",
        label="meshchersky",
    )


def _special(d: Derivation) -> None:
    d.only("newton_2", "exhaust_with_body")
    along = d.given(
        Equation(RELATIVE, zero("vector")),
        "what goes in or out has the velocity of the body",
        label="with-body",
    )
    d.recall("meshchersky").then(
        "there is no thrust: sand that trickles out of a cart does not drive it",
        use(along.equation),
        distribute,
        label="no-thrust",
    )
    d.only("newton_2", "exhaust_at_rest")
    still = d.given(
        Equation(RELATIVE, -V),
        "what goes in or out is at rest in space, as snow on a sledge",
        label="at-rest",
    )
    braked = d.recall("momentum").then(
        "it has no momentum: the law is that of the whole momentum",
        use(still.equation),
        combine,
        distribute,
        label="whole-momentum",
    )
    braked.infer("with the product rule", equal(), d.recall("momentum-rate")).turned(
        "turned round", label="whole-momentum-rate"
    ).infer(
        "solved for mass times acceleration: mass at rest that is taken in acts as a brake",
        solved(mul(M, der(V))),
        label="brake",
    )
