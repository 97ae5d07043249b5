"""Dissipation of energy at constant angular momentum: an exact model, and the energy sink (001)."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations.chapters.rotation import name_spin
from eom.derivations.conditions import let, so
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.kinematics.frames import Vector, first_derivative, time_derivative, vector
from eom.mechanics import dissipation as model
from eom.mechanics import steady
from eom.mechanics.freebody import AXIAL, MOMENTS, TRANSVERSE, H, T
from eom.mechanics.rigidbody import OMEGA, angular_momentum
from eom.system import System
from eom.terms.rules import (
    apply,
    at,
    combine,
    commute,
    determinants,
    differentiate,
    differentiate_in,
    differentiate_terms,
    distribute,
    dyads,
    entrywise,
    order_dots,
    parallel,
    put_in,
    regroup,
    symmetric,
    transport,
    triple_zero,
    use,
)
from eom.terms.rules.inferences import characteristic, equal, solved
from eom.terms.terms import (
    Equation,
    Term,
    add,
    der,
    dot,
    entries,
    expr,
    mul,
    number,
    zero,
)
from eom.terms.vocabulary import omega, quantity

Expr = Any
W, SIGMA, W_SLUG = omega("B"), omega("S", "B"), omega("S")
H_C, H_SLUG = quantity("angular_momentum", "body", "C"), quantity("slug_momentum")
J, J_S, DAMPING = (quantity("inertia", "C"), quantity("slug_inertia"), quantity("slug_damping"))
SPHERE = mul(J_S, quantity("identity"))
J_BODY = add(J, -SPHERE)
T_ROT = quantity("rotational_energy", "body", "C")
STATES = (*OMEGA.components, *model.SIGMA.components)
RATES = tuple(sp.Symbol(f"{s}_dot", real=True) for s in STATES)
SQUARE = sp.Symbol("Q", real=True)
COEFFICIENTS = sp.symbols("p_0:5", real=True)
NUTATION_RATE = sp.Symbol("theta_dot", real=True)
EFFECTIVE, EFFECTIVE_RATE = sp.symbols("I_e I_e_dot", real=True)
ENERGY, POWER, ENERGY_RATE = sp.symbols("T P T_dot", real=True)
LETTERS = {
    TRANSVERSE: sp.Symbol("I_t", positive=True),
    AXIAL: sp.Symbol("I_a", positive=True),
    model.POWER: POWER,
    T: ENERGY,
}
"""What the energy sink is written with."""


def energy_dissipation() -> Derived:
    """Derive that H stays while T falls in a body with a viscous slug, and the major-axis rule."""
    d = Derivation(
        "energy-dissipation", "Energy dissipation and the major-axis rule", "Torque-free motion"
    )
    _balance(d)
    _energy(d)
    excess = _major_axis(d).equation
    system = model.viscous_slug()
    rates = _equations(d, system)
    _stability(d, rates)
    _energy_sink(d)
    sink = d.recall("sink-nutation").equation.right.expression
    d.stands.update(
        {
            **{f"h_{k}": None for k in (1, 2, 3)},
            "sigma": SIGMA,
            "dissipation": expr(POWER),
            "excess_energy": excess.left,
            "nutation_rate": expr(NUTATION_RATE),
        }
    )
    return d.finish(equations=system, excess_energy=excess.right.expression, nutation_rate=sink)


# -- body and slug ---------------------------------------------------------------------------


def _balance(d: Derivation) -> None:
    d.only("viscous_slug")
    d.name_scalar(model.SLUG, J_S, "moment of inertia of the spherical slug")
    d.name_scalar(
        model.DAMPING, DAMPING, "viscous torque on the slug for each unit of relative rate"
    )
    d.law(Equation(der(H_C), zero("vector")), "no torque acts from outside", label="H-constant")
    d.law(Equation(der(H_SLUG), -(DAMPING * SIGMA)), "the viscous torque on the slug", label="slug")
    turning = d.law(Equation(W_SLUG, add(SIGMA, W)), "angular velocities add", label="slug-omega")
    slug = d.law(
        Equation(H_SLUG, dot(SPHERE, W_SLUG)),
        "momentum of a rigid body, of a sphere with the same inertia about all axes",
        label="slug-sphere",
    ).then(
        "the slug turns with the body, and in it",
        use(turning.equation),
        distribute,
        dyads,
        label="slug-momentum",
    )
    parts = d.law(
        Equation(H_C, add(dot(J_BODY, W), H_SLUG)),
        "momenta add: of the body, with its own inertia, and of the slug",
        label="momentum-parts",
    )
    parts.then("with the slug's momentum", use(slug.equation), label="momentum")
    d.start(der(dot(H_C, H_C))).then(
        "the magnitude of the whole is constant",
        differentiate,
        use(d.recall("H-constant").equation),
        label="magnitude",
    )
    d.given(
        Equation(der(J, "B"), zero("dyadic")),
        "the inertia of the whole is constant in B, as the slug is a sphere",
        label="J-constant",
    )
    d.given(Equation(der(J_S), number(0)), "and that of the slug is constant", label="J_s-constant")
    _slug_rate(d, slug)
    _body_rate(d, parts)


def _slug_constant(d: Derivation) -> tuple[Any, ...]:
    """Return the rules of a rate in which the slug's inertia is constant."""
    return (differentiate, use(d.recall("J_s-constant").equation), distribute)


def _slug_rate(d: Derivation, slug: Chain) -> None:
    sphere = d.recall("slug-sphere")
    sphere.both(
        "differentiate; the unit dyadic is the same in all frames",
        der,
        dyads_of_sphere,
        *_slug_constant(d),
        label="slug-rate-terms",
    ).infer("which is the viscous torque", equal(), d.recall("slug"), label="slug-balance")
    slug.both(
        "the slug as seen from B",
        der,
        *_slug_constant(d),
        transport("B"),
        parallel,
        distribute,
        label="slug-rate",
    )


def dyads_of_sphere(term: Term) -> Term:
    """Carry out products with the inertia of a sphere."""
    return apply((distribute, dyads, distribute), term)


def _body_rate(d: Derivation, parts: Chain) -> None:
    """Derive Euler's equation of the body, which feels the opposite viscous torque."""
    alone = parts.infer(
        "the momentum J.omega: of the whole, as if the slug did not slip",
        solved(dot(J, W), dyads, distribute),
        label="body-momentum",
    ).both(
        "its rate: the whole has no torque, and the slug has the viscous one",
        der,
        *_slug_constant(d),
        use(d.recall("H-constant").equation),
        use(d.recall("slug").equation),
        distribute,
        label="body-rate",
    )
    seen = d.start(der(dot(J, W))).then(
        "the same as seen from B, where J is constant",
        transport("B"),
        differentiate,
        use(d.recall("J-constant").equation),
        distribute,
        label="body-rate-B",
    )
    rate = d.start(der(W)).then(
        "omega has the same rate in both frames", transport("B"), parallel, label="omega-rate"
    )
    seen.infer(
        "both are the same rate",
        equal(use(rate.equation)),
        alone,
        label="body-balance",
    ).infer(
        "solved for the rates: the body feels the viscous torque, opposite to the slug's",
        solved(dot(J, der(W, "B"))),
        label="body-euler",
    )


# -- energy ----------------------------------------------------------------------------------


def _energy(d: Derivation) -> None:
    half = number(1, 2)
    of_body = half * dot(W, dot(J_BODY, W))
    of_slug = half * dot(W_SLUG, dot(SPHERE, W_SLUG))
    energy = d.law(
        Equation(T_ROT, add(of_body, of_slug)),
        "energies of two rigid bodies that turn about the centre of mass",
        label="energy-parts",
    ).then("the slug is a sphere", at(of_slug, dyads_of_sphere), label="energy")
    body, slug = energy.equation.right.args
    powers = [_body_power(d, body), _slug_power(d, slug)]
    energy.both(
        "both together",
        der,
        differentiate_terms,
        *(use(p.equation) for p in powers),
        label="both-powers",
    ).then(
        "energy falls as long as the slug slips, whatever the motion",
        distribute,
        order_dots(W),
        combine,
        label="energy-rate",
    )


def _body_power(d: Derivation, energy: Term) -> Chain:
    terms = d.start(der(energy)).then(
        "product rule in B, where J is constant; J is symmetric",
        dyads_of_sphere,
        differentiate_in("B"),
        *(use(d.recall(f"{n}-constant").equation) for n in ("J", "J_s")),
        distribute,
        symmetric(J),
        commute,
        combine,
        label="body-power-terms",
    )
    return terms.then(
        "the viscous torque on the body has power by its angular velocity",
        use(d.recall("body-euler").equation),
        distribute,
        triple_zero(W),
        commute,
        combine,
        label="body-power",
    )


def _slug_power(d: Derivation, energy: Term) -> Chain:
    return d.start(der(energy)).then(
        "the opposite one on the slug, by the angular velocity of the slug",
        *_slug_constant(d),
        commute,
        combine,
        regroup(J_S),
        use(d.recall("slug-balance").equation),
        distribute,
        use(d.recall("slug-omega").equation),
        label="slug-power",
    )


# -- the major-axis rule ---------------------------------------------------------------------


def _major_axis(d: Derivation) -> Chain:
    """Write the energy above that of a spin with the same momentum as a sum of squares."""
    h = angular_momentum(sp.diag(*MOMENTS), OMEGA) + model.slug_momentum()
    squares = model.excess_energy(3)
    for k, moment in enumerate(MOMENTS, 1):
        d.letter(moment, f"principal moment of inertia about b{k} of the body without the slug")
    energy = d.name_scalar(
        ENERGY,
        expr(model.slug_energy()),
        "energy of body and slug in principal axes of the body",
        label="energy-components",
    )
    square = d.name_scalar(
        SQUARE, expr(h.dot(h)), "square of their angular momentum", label="momentum-components"
    )
    return d.show(
        Equation(
            expr(ENERGY - SQUARE / (2 * (MOMENTS[2] + model.SLUG))),
            expr(sp.Add(*(c * base**2 for c, base in squares))),
        ),
        "the energy above that of a spin about b3 with the same momentum, squares completed: if I3 "
        "is the greatest moment, no factor is negative, and the least energy is in that spin with "
        "the slug at rest. As energy falls as long as the slug slips and momentum stays, the motion "
        "ends in a steady spin, and of these it is the one without energy to lose: the major-axis "
        "rule",
        put_in(energy.equation, square.equation),
        label="excess",
    )


# -- equations of motion and stability -------------------------------------------------------


def _equations(d: Derivation, system: System) -> list[Chain]:
    """State the rates in principal axes, and show that they obey the balances of momentum."""
    found = []
    for symbol, rate, solution in zip(STATES, RATES, system.rates, strict=True):
        found.append(
            d.name_scalar(
                rate,
                expr(system.expand(solution)),
                f"rate of {symbol}: the balances of body and slug in principal axes, solved",
                label=f"{symbol}-rate",
            )
        )
    known = put_in(*(line.equation for line in found))
    moving = dict(zip(STATES, RATES, strict=True))
    slug = model.slug_momentum()
    whole = angular_momentum(sp.diag(*MOMENTS), OMEGA) + slug
    viscous = model.SIGMA.scaled(-model.DAMPING)
    for h, torque, words, label in (
        (whole, vector("B", (0, 0, 0)), "they keep the momentum of the whole", "whole"),
        (slug, viscous, "and the slug's rate is the viscous torque", "slug"),
    ):
        d.show(
            Equation(entries(_rate(h, moving).column), entries(sp.Matrix(torque.column))),
            f"{words}: its rate in B and omega x h put together",
            known,
            label=f"{label}-in-axes",
        )
    power = viscous.dot(model.SIGMA)
    rates = dict(zip((q.symbol for q in system.states), system.rates, strict=True))
    d.check(Equation(expr(time_derivative(model.slug_energy(), rates)), expr(power)), "its energy")
    d.check(Equation(expr(model.energy_rate()), expr(power)), "its rate of energy")
    return found


def _rate(h: Vector, moving: dict[Expr, Expr]) -> Vector:
    """Return the inertial rate of a vector in B, the rates of its components by their names."""
    return first_derivative(h, OMEGA, moving).total


def _stability(d: Derivation, rates: list[Chain]) -> None:
    name_spin(d)
    for axis in (1, 2, 3):
        across = [k for k in range(6) if k % 3 != axis - 1]
        spin = dict.fromkeys(STATES, sp.Integer(0)) | {STATES[axis - 1]: steady.SPIN_RATE}
        first, *others = (rates[k] for k in across)
        first.infer(
            f"the rates across the axis linearised at a spin nu about b{axis}, where those along it "
            "have no part: characteristic polynomial",
            characteristic([STATES[k] for k in across], spin, steady.ROOT, cleared=True),
            *others,
            label=f"characteristic-{axis}",
        )
    _routh_hurwitz(d)


def _routh_hurwitz(d: Derivation) -> None:
    """Decide about the signs of the real parts for the spin about b3; the others by renaming."""
    polynomial = sp.Poly(d.recall("characteristic-3").equation.right.data[0], steady.ROOT)
    named = [
        d.name_scalar(
            p,
            expr(sp.factor(polynomial.coeff_monomial(steady.ROOT**n))),
            f"coefficient of lambda^{n} for the spin about b3",
            label=f"coefficient-{n}",
        )
        for n, p in enumerate(COEFFICIENTS)
    ]
    p0, p1, p2, p3, p4 = COEFFICIENTS
    I1, I2, I3 = MOMENTS
    Js, c, nu = model.SLUG, model.DAMPING, steady.SPIN_RATE
    first, second = I3 - I1, I3 - I2
    slow = 2 * Js**5 * c**2 * nu**4 * (I3 + Js) * (I3 - I1 - I2) ** 2
    fast = Js**3 * c**4 * nu**2 * (I3 + Js) * (2 * I1 * I2 + I1 * Js + I2 * Js)
    determinant = d.show(
        Equation(
            expr(sp.Determinant(sp.ImmutableMatrix([[p3, p1, 0], [p4, p2, p0], [0, p3, p1]]))),
            expr(
                slow * (I2 * first + I1 * second) + fast * ((I1 + Js) * first + (I2 + Js) * second)
            ),
        ),
        "Hurwitz's third determinant: positive if I3 is the greatest moment, negative if it is the "
        "least. For the greatest one all coefficients are positive, too: every root has a negative real "
        "part, the spin is stable. For the least one some root has a positive real part, and so for "
        "the intermediate one, where p_0 is negative: of the three spins that about the greatest "
        "moment alone is stable, for every slug and film",
        determinants,
        put_in(*(line.equation for line in named)),
        label="hurwitz",
    )
    _hurwitz_sign(d, determinant)


def _hurwitz_sign(d: Derivation, determinant: Chain) -> None:
    """Derive the sign of the determinant where I3 is the greatest moment."""
    I1, I2, I3 = MOMENTS
    Js, c, nu = model.SLUG, model.DAMPING, steady.SPIN_RATE
    first, second = I3 - I1, I3 - I2
    positive = (
        (s, f"{words} not negative", f"{s}-positive")
        for s, words in (
            *((moment, "a moment is") for moment in MOMENTS),
            (Js, "that of the slug is"),
        )
    )
    known = let(
        d,
        *positive,
        (first, "let I3 be the greatest moment: above I1", "I3-above-I1"),
        (second, "and above I2", "I3-above-I2"),
    )
    size, both = 2 * I1 * I2 + I1 * Js + I2 * Js, I3 + Js
    for value, products, words, label in (
        (both, ((I3,), (Js,)), "so is their sum", "I3-and-slug"),
        (size, ((2 * sp.S.One, I1, I2), (I1, Js), (I2, Js)), "and this sum", "moments-and-slug"),
    ):
        known.append(so(known, value, products, words, label))
    slow = (sp.Integer(2), Js**5, c**2, nu**4, both, (I3 - I1 - I2) ** 2)
    fast = (Js**3, c**4, nu**2, both, size)
    pairs = ((I1, first), (Js, first), (I2, second), (Js, second))
    so(
        [determinant, *known],
        determinant.equation.right.expression,
        ((*slow, I2, first), (*slow, I1, second), *((*fast, *pair) for pair in pairs)),
        "then the determinant is not negative",
        "hurwitz-sign",
    )


# -- the energy sink -------------------------------------------------------------------------


def _energy_sink(d: Derivation) -> None:
    for symbol, words in (
        (LETTERS[TRANSVERSE], "moment across the axis"),
        (LETTERS[AXIAL], "moment about the axis"),
        (model.NUTATION, "angle between h and the axis of symmetry"),
        (H, "magnitude of the angular momentum"),
    ):
        d.letter(symbol, words)
    d.name_scalar(
        POWER,
        expr(-model.energy_rate()),
        "power that is lost in the film",
        label="power",
    )
    lost = d.name_scalar(
        ENERGY_RATE,
        expr(-POWER),
        "the energy sink: a quasi-rigid body loses the power P while H is constant",
        label="energy-sink",
    )
    _nutation(d, lost)
    _effective(d, lost)


def _nutation(d: Derivation, lost: Chain) -> None:
    """Derive the rate of the angle from the momentum to the axis."""
    energy = model.energy_at_nutation().xreplace(LETTERS)
    d.name_scalar(
        NUTATION_RATE,
        expr(ENERGY_RATE / sp.Derivative(energy, model.NUTATION)),
        "a symmetric body has the energy T over the angle theta from h to the axis, so that T' = "
        "(dT/dtheta) theta'",
        label="sink",
    ).then(
        "carried out: the angle falls if I_a > I_t, to spin about the axis of a disc, and grows if "
        "I_a < I_t, to the flat spin of a rod",
        put_in(lost.equation),
        entrywise(lambda e: sp.factor(e.doit()), "derivative"),
        label="sink-nutation",
    )
    d.check(
        Equation(expr(NUTATION_RATE), expr(model.nutation_rate().xreplace(LETTERS))),
        "the library has the same",
    )


def _effective(d: Derivation, lost: Chain) -> None:
    """Derive the rate of the effective moment of inertia."""
    d.name_scalar(
        EFFECTIVE, expr(H**2 / (2 * ENERGY)), "effective moment of inertia", label="effective"
    )
    d.name_scalar(
        EFFECTIVE_RATE,
        expr(-(H**2) * ENERGY_RATE / (2 * ENERGY**2)),
        "its rate, as H is constant",
        label="effective-rate",
    ).then(
        "for any body it only grows, towards the greatest moment",
        put_in(lost.equation),
        label="sink-effective",
    )
    d.check(
        Equation(expr(EFFECTIVE_RATE), expr(model.effective_inertia_rate().xreplace(LETTERS))),
        "the same",
    )
