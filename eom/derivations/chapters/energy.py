"""Kinetic energy of a rigid body: its two parts, its rate, and about a fixed pivot (000)."""

from __future__ import annotations

from eom.derivations.chapters.rigid import BODY_MASS, FORCE, RHO, R, W
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.terms.rules import (
    bac_cab,
    combine,
    commute,
    components,
    differentiate,
    differentiate_in,
    differentiate_terms,
    differentiate_under,
    distribute,
    fold_into,
    inside,
    linear_in,
    order_dots,
    regroup,
    scalar_triple,
    scalars_in,
    symmetric,
    take_out,
    transport,
    triple_zero,
    use,
)
from eom.terms.terms import Equation, Term, add, cross, der, dot, integral, mul, number, zero
from eom.terms.vocabulary import position, quantity, velocity

T = quantity("kinetic_energy", "body")
ROTATION = quantity("rotational_energy", "body", "C")
H, TORQUE = (quantity(n, "body", "C") for n in ("angular_momentum", "torque"))
J, PIVOT_J = quantity("inertia", "C"), quantity("inertia", "O")


def kinetic_energy() -> Derived:
    """Derive T = M v_C.v_C / 2 + omega.I.omega / 2, its rate, and its form about a pivot."""
    d = Derivation("kinetic-energy", "Kinetic energy of a rigid body", "Rigid body")
    _koenig(d)
    _rotation(d)
    _rate(d)
    _pivot(d)
    return d.finish()


def _koenig(d: Derivation) -> None:
    """Part the energy; the body need not be rigid."""
    d.only("constant_mass")
    d.define(BODY_MASS, "mass of the body", label="mass")
    energy = d.define(T, "kinetic energy", label="T", states=["000:E26"]).then(
        "one half comes out of the integral", distribute, label="T-half", states=["000:E26"]
    )
    split = d.law(
        Equation(position("dm"), add(position("C"), R)),
        "position by way of the centre of mass",
        label="split",
        states=["000:E26"],
    )
    parted = energy.then("R = R_C + r", use(split.equation), distribute)
    sums = parted.then(
        "what is the same for all elements comes out of the integrals",
        order_dots(velocity("C")),
        take_out,
        fold_into(BODY_MASS),
        combine,
        label="T-parts",
        states=["000:E27"],
    )
    first = d.law(Equation(integral(R), zero("vector")), "r starts at the centre of mass")
    rate = first.both("differentiate", lambda t: differentiate_under(der(t)), label="r-sum-rate")
    koenig = sums.then(
        "the middle term vanishes",
        use(rate.equation),
        distribute,
        label="T-koenig",
        states=["000:E28"],
    )
    rotation = d.define(
        ROTATION, "energy of the motion about the centre of mass", label="T-rot"
    ).then("one half comes out of the integral", distribute, label="T-rot-half", states=["000:E29"])
    koenig.then(
        "name the second part",
        use(rotation.equation, backwards=True),
        label="T-sum",
        states=["000:E28"],
    )


def _rotation(d: Derivation) -> None:
    d.only("body_frame")
    fixed = d.given(
        Equation(der(R, "B"), zero("vector")), "B is fixed in the rigid body", label="rigid"
    )
    seen = d.start(der(R)).then(
        "the transport theorem", transport("B"), label="r-rate-terms", states=["000:E29"]
    )
    moved = seen.then("r is fixed in B", use(fixed.equation), distribute, label="r-rate")
    crossed = d.recall("T-rot-half").then(
        "r' = omega x r", use(moved.equation), label="T-crossed", states=["000:E30"]
    )
    outside = crossed.then(
        "(omega x r).(omega x r) = omega.(r x (omega x r)); omega comes out of the integral",
        scalar_triple,
        take_out,
        label="T-triple",
        states=["000:E32"],
    )
    dyadic = _by_inertia(d, outside, moved)
    dyadic.then(
        "components in B", scalars_in("B"), components("B"), label="T-matrix", states=["000:E33"]
    )
    whole = d.recall("T-sum").then(
        "for a rigid body", use(dyadic.equation), label="T-rigid", states=["000:E34"]
    )
    whole.then(
        "components in B",
        inside("dot", _only_omega, components("B")),
        label="T-rigid-matrix",
        states=["000:E34"],
    )


def _by_inertia(d: Derivation, outside: Chain, moved: Chain) -> Chain:
    """Write the energy of rotation by the inertia dyadic."""
    spin = d.define(H, "angular momentum about the centre of mass", label="h-definition").then(
        "r' = omega x r", use(moved.equation), label="h"
    )
    half = outside.then(
        "the integral is h_C",
        use(spin.equation, backwards=True),
        label="T-h",
        states=["000:E33"],
    )
    momentum = spin.then(
        "r x (omega x r) = omega (r.r) - r (r.omega)", bac_cab, label="h-parted"
    ).then(
        "linear in omega: the integral is the inertia dyadic",
        linear_in(W),
        fold_into(J),
        label="h-J",
    )
    return half.then("h_C = J_C.omega", use(momentum.equation), label="T-J")


def _only_omega(term: Term) -> Term:
    """Take components of omega.J.omega, and leave other products alone."""
    return scalars_in("B")(term) if term.args[0] == W else term


def _rate(d: Derivation) -> None:
    d.only("body_frame", "newton_2", "third_law_strong")
    motion = Equation(mul(BODY_MASS, der(velocity("C"))), FORCE)
    d.law(motion, "motion of the centre of mass", label="motion")
    translation = mul(number(1, 2), BODY_MASS, dot(velocity("C"), velocity("C")))
    constant = d.recall("mass").both(
        "it is constant, as the mass of each element is",
        der,
        differentiate_under,
        differentiate,
        label="mass-constant",
    )
    translated = (
        d.start(der(translation))
        .then(
            "product rule; the mass is constant",
            differentiate,
            use(constant.equation),
            commute,
            combine,
        )
        .then(
            "the power of the force at the centre of mass",
            regroup(BODY_MASS),
            use(motion),
            label="power-translation",
        )
    )
    turning = _rate_of_rotation(d)
    d.recall("T-rigid").both(
        "the energy changes at the power of force and torque; internal forces do no work",
        der,
        differentiate_terms,
        use(translated.equation),
        use(turning.equation),
        label="power",
    )


def _rate_of_rotation(d: Derivation) -> Chain:
    constant = d.given(
        Equation(der(J, "B"), zero("dyadic")), "J_C does not change in B", label="J-constant"
    )
    local = d.start(der(mul(number(1, 2), dot(W, dot(J, W))))).then(
        "product rule in B, where J_C is constant; it is symmetric",
        differentiate_in("B"),
        use(constant.equation),
        distribute,
        symmetric(J),
        combine,
        label="rotation-rate",
    )
    euler = Equation(dot(J, der(W, "B")), add(TORQUE, -cross(W, dot(J, W))))
    d.law(euler, "Euler's equation, derived in its own chapter", label="euler")
    return local.then(
        "Euler's equation; omega.(omega x h_C) = 0",
        use(euler),
        distribute,
        triple_zero(W),
        distribute,
        label="power-rotation",
    )


def _pivot(d: Derivation) -> None:
    d.only("body_frame", "O_fixed_in_body", "O_fixed_in_space")
    turned = _velocity_about_pivot(d)
    d.recall("T-half").then("R' = omega x rho", use(turned.equation), label="T-pivot-crossed").then(
        "(omega x rho).(omega x rho) = omega.(rho x (omega x rho)); omega comes out of the integral",
        scalar_triple,
        take_out,
    ).then("the integral is J_O.omega", bac_cab, linear_in(W), fold_into(PIVOT_J), label="T-pivot")


def _velocity_about_pivot(d: Derivation) -> Chain:
    """Derive the velocity of every element of a body that turns about a fixed point."""
    split = d.law(
        Equation(position("dm"), add(position("O"), RHO)), "position by way of the pivot O"
    )
    still = d.given(Equation(velocity("O"), zero("vector")), "the pivot is fixed in space")
    fixed = d.given(Equation(der(RHO, "B"), zero("vector")), "and in the body, as B is")
    return (
        d.start(velocity("dm"))
        .then(
            "R = R_O + rho, and O is at rest", use(split.equation), distribute, use(still.equation)
        )
        .then(
            "the transport theorem; rho does not change in B, every element turns about the pivot",
            transport("B"),
            use(fixed.equation),
            distribute,
            label="pivot-velocity",
        )
    )
