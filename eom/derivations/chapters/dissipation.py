"""Dissipation of energy at constant angular momentum: an exact model, and the energy sink (001)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from eom.derivations.chapters.rotation import explicit, name_spin, principal_matrix
from eom.derivations.conditions import let, so
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.exact.algebra import gather
from eom.mechanics import dissipation as model
from eom.mechanics import steady
from eom.mechanics.freebody import AXIAL, MOMENTS, TRANSVERSE, H, T
from eom.mechanics.rigidbody import OMEGA, angular_momentum
from eom.system import System
from eom.terms.rules import (
    Rule,
    apply,
    at,
    chain,
    combine,
    commute,
    components,
    compute,
    constants,
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
    scalars_in,
    symmetric,
    transport,
    triple_zero,
    use,
)
from eom.terms.rules.inferences import characteristic, entry, equal, solved
from eom.terms.terms import (
    Equation,
    Term,
    add,
    column,
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
    carried_out = _in_axes(d)
    _energies(d, carried_out)
    excess = _major_axis(d).equation
    system = model.viscous_slug()
    _stability(d, _equations(d, system, carried_out))
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
        "the magnitude of the whole momentum is constant",
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


# -- in principal axes -----------------------------------------------------------------------


def _in_axes(d: Derivation) -> Rule:
    """Name moments and rates in principal axes; return the rule that carries out components."""
    d.only("principal_with_slug")
    slug = "of the body without the slug"
    part = (J_BODY, model.SLUG, f" {slug}")
    diagonal = principal_matrix(d, J, MOMENTS, label="J-principal", part=part)
    columns = [
        explicit(d, vector, name, "B", f"component of {words} along b{{k}}")
        for vector, name, words in ((W, "omega", "omega"), (SIGMA, "sigma", "sigma"))
    ]
    lines = [diagonal.equation, *columns]
    letters = [use(d.definition_of(s), backwards=True) for s in (model.SLUG, model.DAMPING)]
    rules = (*(use(line) for line in lines), *letters, compute())
    return lambda term: apply(rules, term)


def _energies(d: Derivation, carried_out: Rule) -> None:
    """Write energy and momentum by components."""
    scalars = (scalars_in("B"), components("B"), carried_out)
    turning = use(d.recall("slug-omega").equation)
    d.show(
        Equation(T_ROT, expr(model.slug_energy())),
        "the energy by components",
        use(d.recall("energy").equation),
        dyads_of_sphere,
        turning,
        *scalars,
        label="energy-components",
    )
    h = angular_momentum(sp.diag(*MOMENTS), OMEGA) + model.slug_momentum()
    d.show(
        Equation(column(H_C, "B"), entries(sp.Matrix(h.column))),
        "the momentum by components",
        use(d.recall("momentum").equation),
        dyads_of_sphere,
        components("B"),
        carried_out,
        label="momentum-components",
    )
    d.show(
        Equation(dot(H_C, H_C), expr(h.dot(h))),
        "its square",
        scalars_in("B"),
        components("B"),
        use(d.recall("momentum-components").equation),
        compute(),
        label="momentum-square",
    )
    d.name_scalar(ENERGY, T_ROT, "energy of rotation of body and slug", label="T")
    d.name_scalar(SQUARE, dot(H_C, H_C), "square of their angular momentum", label="Q")


# -- the major-axis rule ---------------------------------------------------------------------


def _major_axis(d: Derivation) -> Chain:
    """Write the energy above that of a spin with the same momentum as a sum of squares."""
    squares = model.excess_energy(3)
    lines = ("T", "energy-components", "Q", "momentum-square")
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
        put_in(*(d.recall(name).equation for name in lines)),
        label="excess",
    )


# -- equations of motion and stability -------------------------------------------------------


def _equations(d: Derivation, system: System, carried_out: Rule) -> list[Chain]:
    """Derive the rates in principal axes from the balances of body and slug."""
    moving = dict(zip(STATES, RATES, strict=True))
    for symbol, rate in moving.items():
        d.name_scalar(rate, der(expr(symbol)), f"rate of {symbol}")
    columns = []
    for vector, name in ((W, "omega"), (SIGMA, "sigma")):
        made = d.start(der(column(vector, "B"))).then(
            f"rates of the components of {name}",
            use(d.recall(f"column-of-{name}").equation),
            compute(moving),
            label=f"rates-of-{name}",
        )
        columns.append(use(made.equation))
    body = d.recall("body-euler")
    slug = d.recall("slug-rate").infer(
        "which is the viscous torque on the slug", equal(), d.recall("slug"), label="slug-in-B"
    )
    rows = (*columns, carried_out)
    rates = [
        line
        for balance, name, first in ((body, "body", 0), (slug, "slug", 3))
        for line in _rows(d, balance, name, RATES[first : first + 3], rows)
    ]
    for line, rate in zip(rates, system.rates, strict=True):
        d.check(Equation(line.equation.left, expr(system.expand(rate))), "the system has the same")
    return rates


def _rows(
    d: Derivation, balance: Chain, name: str, unknowns: Sequence[Expr], rows: Sequence[Rule]
) -> list[Chain]:
    """Write a balance by components, and solve each row for a rate."""
    tidy = entrywise(lambda e: gather(e, (*STATES, *RATES)))
    written = d.in_components(
        balance, "B", f"the balance of the {name} in components in B", label=f"{name}-in-columns"
    ).both("by components", lambda t: apply((*rows, tidy), t), label=f"{name}-by-components")
    before = [d.recall(f"{s}-rate").equation for s in OMEGA.components] if name == "slug" else []
    words = "solved, with the rate of the body" if before else "solved for the rate"
    return [
        written.infer(f"row {k}", entry(k, tidy), label=f"{name}-row-{k}").infer(
            words,
            solved(expr(unknown), put_in(*before), entrywise(lambda e: gather(e, STATES))),
            label=f"{str(unknown).removesuffix('_dot')}-rate",
        )
        for k, unknown in enumerate(unknowns, 1)
    ]


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
    ):
        d.letter(symbol, words)
    lost = _lost(d)
    _effective(d, lost)
    _nutation(d)


def _lost(d: Derivation) -> Chain:
    """Derive that the energy T falls at the power that is lost."""
    power = d.name_scalar(
        POWER, expr(-model.energy_rate()), "power that is lost in the film", label="power"
    )
    rate = d.name_scalar(ENERGY_RATE, der(expr(ENERGY)), "rate of T", label="T-rate")
    slip, torque = (
        d.recall("column-of-sigma").equation,
        use(d.definition_of(model.DAMPING), backwards=True),
    )
    return d.show(
        Equation(expr(ENERGY_RATE), expr(-POWER)),
        "the energy falls at this power, while h_C is constant. Of a quasi-rigid body, the energy "
        "sink, that alone is assumed",
        use(rate.equation),
        use(d.recall("T").equation),
        use(d.recall("energy-rate").equation),
        scalars_in("B"),
        components("B"),
        use(slip),
        torque,
        compute(),
        put_in(power.equation),
        label="energy-sink",
    )


def _nutation(d: Derivation) -> None:
    """Derive the rate of the angle from the momentum to the axis."""
    energy = model.energy_at_nutation().xreplace(LETTERS)
    d.name_scalar(
        NUTATION_RATE,
        expr(-POWER / sp.Derivative(energy, model.NUTATION)),
        "the energy sink: a symmetric body has the energy T over the angle theta from h to the "
        "axis, and T' = -P is (dT/dtheta) theta'",
        label="sink",
    ).then(
        "carried out: the angle falls if I_a > I_t, to spin about the axis of a disc, and grows if "
        "I_a < I_t, to the flat spin of a rod",
        entrywise(lambda e: sp.factor(e.doit()), "derivative"),
        label="sink-nutation",
    )
    d.check(
        Equation(expr(NUTATION_RATE), expr(model.nutation_rate().xreplace(LETTERS))),
        "the library has the same",
    )


def _effective(d: Derivation, lost: Chain) -> None:
    """Derive the rate of the effective moment of inertia."""
    square = d.start(der(expr(SQUARE))).then(
        "the square of the momentum is constant",
        use(d.recall("Q").equation),
        use(d.recall("magnitude").equation),
        label="Q-constant",
    )
    d.name_scalar(H, expr(sp.sqrt(SQUARE)), "magnitude of the angular momentum", label="H")
    constant = d.start(der(expr(H))).then(
        "and so is the magnitude",
        use(d.recall("H").equation),
        chain(d.scalars),
        use(square.equation),
        constants(square.equation),
        distribute,
        label="magnitude-constant",
    )
    moment = d.name_scalar(
        EFFECTIVE, expr(H**2 / (2 * ENERGY)), "effective moment of inertia", label="effective"
    )
    rate = d.name_scalar(EFFECTIVE_RATE, der(expr(EFFECTIVE)), "rate of I_e")
    d.start(expr(EFFECTIVE_RATE)).then(
        "its rate, as H is constant",
        use(rate.equation),
        use(moment.equation),
        chain(d.scalars),
        constants(constant.equation),
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
