"""A point mass: momentum, angular momentum about any point, energy, components (002: 3.1-3.4)."""

from __future__ import annotations

from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.terms.rules import (
    by_way_of,
    combine,
    commute,
    components,
    differentiate,
    distribute,
    inside,
    order_dots,
    regroup,
    scalars_in,
    seen_from,
    transport,
    unfold,
    use,
    vanish,
)
from eom.terms.terms import Equation, add, column, der, mul, number, zero
from eom.terms.vocabulary import mass, position, quantity, velocity

M, FORCE = mass("P"), quantity("force", "P")
NEWTON = Equation(FORCE, mul(M, der(velocity("P"))))
LOCAL = der(position("P"), "A")
SPLIT = Equation(position("P"), add(position("O"), position("P", "O")))


def point_mass() -> Derived:
    """Derive momentum, both angular momenta about any point O, the power, and component forms."""
    d = Derivation("point-mass", "Dynamics of a point mass", "Particles")
    _momentum(d)
    _angular_momentum(d)
    _energy(d)
    _components(d)
    return d.finish()


def _momentum(d: Derivation) -> None:
    d.only("one_particle", "newton_2", "constant_mass")
    law = d.law(NEWTON, "Newton's second law", label="newton", states=["002:E1"])
    d.given(Equation(der(M), number(0)), "the mass is constant", label="constant-mass")
    momentum = d.define(
        quantity("linear_momentum", "P"), "linear momentum", label="momentum", states=["002:E2"]
    )
    momentum.both(
        "differentiate; the mass is constant, and m r'' is the force",
        der,
        differentiate,
        vanish(der(M)),
        use(law.equation, backwards=True),
        label="force-is-momentum-rate",
        states=["002:E2"],
    )


def _angular_momentum(d: Derivation) -> None:
    d.only("one_particle")
    split = d.law(SPLIT, "position by way of O", label="split")
    absolute = d.define(
        quantity("absolute_angular_momentum", "P", "O"),
        "absolute angular momentum about O",
        label="H-definition",
        states=["002:E3"],
    )
    expanded = absolute.then("p = m r'", unfold("linear_momentum"), distribute).then(
        "r = r_O + rho; derivative and product are linear",
        inside("der", use(split.equation)),
        distribute,
        label="H",
        states=["002:E3"],
    )
    relative = d.define(
        quantity("angular_momentum", "P", "O"),
        "relative angular momentum about O",
        label="h-definition",
        states=["002:E4"],
    )
    known = use(relative.equation, backwards=True)
    expanded.then("name the second term", known, label="H-and-h", states=["002:E4"])
    d.assume("O_fixed_in_space")
    d.given(Equation(velocity("O"), zero("vector")), "O is inertially fixed", label="O-fixed")
    expanded.then(
        "no distinction about a fixed point", vanish(velocity("O")), known, label="H-is-h"
    )


def _energy(d: Derivation) -> None:
    d.only("one_particle", "newton_2", "constant_mass")
    energy = d.define(quantity("kinetic_energy", "P"), "kinetic energy", label="energy")
    energy.both(
        "differentiate; the mass is constant",
        der,
        differentiate,
        vanish(der(M)),
        commute,
        combine,
    ).then(
        "m r'' is the force: the energy changes at the power of the force",
        regroup(M),
        use(NEWTON, backwards=True),
        label="power",
    )


def _components(d: Derivation) -> None:
    d.only("one_particle", "newton_2", "constant_mass", "O_fixed_in_space")

    def state(chain: Chain, label: str) -> None:
        d.in_components(chain, "I", "components in I", label=label, states=["002:E5"])

    state(d.recall("newton"), "newton-I")
    state(d.recall("momentum"), "momentum-I")
    rate = d.start(der(position("P"))).then(
        "r = r_O + rho, and O is inertially fixed: both rates are the same",
        use(d.recall("split").equation),
        differentiate,
        use(d.recall("O-fixed").equation),
        distribute,
        label="rate-about-O",
    )
    about = d.recall("h-definition").then(
        "so with the velocity in I", use(rate.equation, backwards=True), label="h-fixed"
    )
    state(about, "h-I")
    d.recall("energy").then(
        "components in I", scalars_in("I"), components("I"), label="energy-I", states=["002:E5"]
    )
    d.only("one_particle")
    seen = d.recall("momentum").then(
        "the transport theorem for a frame A that turns", transport("A")
    )
    seen.both(
        "components in I, by way of those in A",
        lambda t: column(t, "I"),
        by_way_of("A"),
        components("A"),
        label="momentum-A",
    )
    _in_turning_frame(d)


def _in_turning_frame(d: Derivation) -> None:
    d.only("one_particle", "newton_2")
    force = d.recall("newton").then(
        "the second derivative as seen from A", seen_from("A"), combine, label="force-A-terms"
    )
    d.in_components(force, "A", "components in A", label="force-A")
    for label, quantity_of in (("h-A", "h-definition"), ("energy-A", "energy")):
        seen = d.recall(quantity_of).then(
            "velocities as seen from A", seen_from("A"), order_dots(LOCAL), combine
        )
        if label == "h-A":
            d.in_components(seen, "A", "components in A", label=label)
        else:
            seen.then("components in A", scalars_in("A"), components("A"), label=label)
