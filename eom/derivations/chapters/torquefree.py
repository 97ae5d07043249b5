"""Torque-free motion: constants, ellipsoids, polhodes, stability, Poinsot, precession (000, last page)."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations.chapters.rotation import explicit, name_spin, principal_matrix
from eom.derivations.conditions import let, so
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.derivations.standing import BODY
from eom.exact.algebra import gather
from eom.mechanics import freebody, steady
from eom.mechanics.freebody import MOMENTS, herpolhode_rate
from eom.mechanics.rigidbody import OMEGA, angular_momentum, free_rigid_body
from eom.terms.rules import (
    apply,
    collect,
    components,
    compute,
    constants,
    differentiate,
    differentiate_in,
    differentiate_terms,
    distribute,
    dyads,
    entrywise,
    order_dots,
    orthonormal,
    parallel,
    put_in,
    scalars_in,
    slopes,
    swap,
    symmetric,
    transport,
    triple_zero,
    use,
)
from eom.terms.rules.inferences import (
    axes_of_components,
    characteristic,
    entry,
    equal,
    solved,
    summed,
)
from eom.terms.terms import (
    Equation,
    add,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    matmul,
    mul,
    number,
    outer,
    partial,
    tilde,
    zero,
)
from eom.terms.vocabulary import omega, quantity, unit

Expr = Any
W = omega()
J, H = quantity("inertia", "C"), quantity("angular_momentum", "body", "C")
ENERGY = quantity("rotational_energy", "body", "C")
TORQUE = quantity("torque", "body", "C")
AXES = tuple(unit("B", k) for k in (1, 2, 3))
SQUARE, H_SYMBOL, T_SYMBOL = sp.Symbol("S", positive=True), freebody.H, freebody.T
RATES = sp.symbols("omega_1_dot omega_2_dot omega_3_dot", real=True)
CONSTANT_RATES = {
    "spherical body, free": "without torque any rates of a spherical body are constant",
    "symmetric body, free": "without torque rates across the axis of a symmetric body are constant: "
    "every axis in its equator is a principal one",
    "any body, with torque": "with the torque omega x J.omega any rates of any body are constant, as "
    "those of a wheel out of balance in its bearings: constant rates need not be free ones",
}
"""Why rates are constant in the counterexamples to a claim."""
PAIRS = tuple(zip(OMEGA.components, MOMENTS, strict=True))


def torque_free_motion() -> Derived:
    """Derive the constants of torque-free motion, and what they say about it."""
    d = Derivation("torque-free-motion", "Torque-free motion of a rigid body", "Torque-free motion")
    _constants(d)
    _energy(d)
    _components(d)
    _ellipsoids(d)
    _polhode(d)
    rates = _rates(d)
    _constant_rates(d)
    _stability(d, rates)
    _poinsot(d)
    _herpolhode(d)
    _precession(d)
    d.only("torque_free", "principal_axes")
    growth = _results()
    words = {name: name.replace("about b", "about axis ") for name in growth}
    d.stands.update({**BODY, **{f"torque_{k}": None for k in (1, 2, 3)}, **words})
    return d.finish(equations=free_rigid_body("quaternion"), **growth)


def _results() -> dict[str, Expr]:
    return {
        f"squared growth rate about b{k}": steady.steady_spin(k).squared_growth_rate
        for k in (1, 2, 3)
    }


# -- constants -------------------------------------------------------------------------------


def _constants(d: Derivation) -> None:
    d.only("torque_free")
    free = d.given(
        Equation(TORQUE, zero("vector")),
        "no torque about the centre of mass",
        label="free",
        states=["000:E35"],
    )
    law = d.law(
        Equation(der(H), TORQUE),
        "the rate of the angular momentum is the torque, both about the centre of mass",
        label="law",
    )
    constant = law.then(
        "so the angular momentum is constant in I",
        use(free.equation),
        label="H-constant",
        states=["000:E35"],
    )
    d.start(der(dot(H, H))).then(
        "its magnitude is constant in every frame, though it may turn in B",
        differentiate,
        use(constant.equation),
        label="magnitude",
        states=["000:C5"],
    )


def _energy(d: Derivation) -> None:
    """Derive Euler's equation without torque, and from it that the energy is constant."""
    momentum = d.law(Equation(H, dot(J, W)), "momentum of a rigid body", label="momentum")
    fixed = d.given(
        Equation(der(J, "B"), zero("dyadic")), "J does not change in B", label="J-constant"
    )
    seen = d.start(der(H)).then(
        "the transport theorem, with h = J.omega; J does not change in B",
        transport("B"),
        use(momentum.equation),
        differentiate,
        use(fixed.equation),
        distribute,
        label="H-rate",
    )
    euler = seen.infer(
        "which is zero: Euler's equation", equal(), d.recall("H-constant"), label="euler-zero"
    ).infer("solved for the rates", solved(dot(J, der(W, "B"))), label="euler-free")
    energy = d.law(
        Equation(ENERGY, number(1, 2) * dot(W, dot(J, W))), "energy of a rigid body", label="energy"
    )
    energy.both(
        "product rule in B, where J is constant; J is symmetric",
        der,
        differentiate_in("B"),
        use(fixed.equation),
        distribute,
        symmetric(J),
        collect,
        label="T-rate",
    ).then(
        "Euler's equation; omega.(omega x h) = 0: the energy of rotation is constant",
        use(euler.equation),
        distribute,
        triple_zero(W),
        label="T-constant",
        states=["000:C6"],
    )


# -- in principal axes -----------------------------------------------------------------------


def _components(d: Derivation) -> None:
    d.only("torque_free", "principal_axes")
    diagonal = principal_matrix(d, J, label="J-principal").equation
    rates = explicit(d, W, "omega", "B", "component of omega along b{k}")
    d.in_components(d.recall("momentum"), "B", "components in B", label="h-in-B").then(
        "by components", use(diagonal), use(rates), compute(), label="h-columns"
    ).infer("as a vector", axes_of_components("B"), label="h", states=["000:E36"])


def _squares(d: Derivation) -> tuple[Chain, Chain]:
    """Write H^2 and T by components."""
    parts, rates, diagonal = (
        d.recall(n).equation for n in ("h-columns", "column-of-omega", "J-principal")
    )
    square = d.start(dot(H, H)).then(
        "the square of h",
        scalars_in("B"),
        components("B"),
        use(parts),
        compute(),
        label="H-squared",
        states=["000:E37"],
    )
    level = d.recall("energy").then(
        "the energy by components",
        scalars_in("B"),
        components("B"),
        use(diagonal),
        use(rates),
        compute(),
        label="T",
        states=["000:E39"],
    )
    return square, level


def _ellipsoids(d: Derivation) -> None:
    square, level = _squares(d)
    T_form, H_form = freebody.constants()
    d.check(Equation(ENERGY, expr(T_form)), "the library has the same T")
    d.check(Equation(dot(H, H), expr(H_form)), "the library has the same H^2")
    S = d.name_scalar(SQUARE, dot(H, H), "square of the magnitude of the angular momentum")
    d.name_scalar(H_SYMBOL, expr(sp.sqrt(SQUARE)), "magnitude of the angular momentum", label="H")
    T = d.name_scalar(T_SYMBOL, ENERGY, "energy of rotation")
    semi_axes = sum((w / (H_SYMBOL / moment)) ** 2 for w, moment in PAIRS)
    d.show(
        Equation(expr(semi_axes), number(1)),
        "H^2 divided by itself: the momentum ellipsoid, of semi-axes H/I1, H/I2, H/I3 in the space "
        "of rates",
        put_in(d.recall("H").equation),
        over(S, square),
        label="momentum-ellipsoid",
        states=["000:E38"],
    )
    d.show(
        Equation(expr(sum(w**2 / (2 * T_SYMBOL / moment) for w, moment in PAIRS)), number(1)),
        "T divided by itself: the energy ellipsoid, of squared semi-axes 2 T/I1, 2 T/I2, 2 T/I3",
        over(T, level),
        label="energy-ellipsoid",
        states=["000:E38"],
    )


def over(name: Chain, value: Chain) -> Any:
    """Return the rule that puts in what the line ``value`` says of the quantity that ``name`` names."""
    return put_in(name.equation, value.equation)


def _polhode(d: Derivation) -> None:
    for k in (1, 2, 3):
        conic = freebody.projection(k)
        i, j = conic.axes
        d.recall("H-squared").infer(
            f"omega_{k} eliminated from both constants: the polhode as seen along b{k}, an ellipse "
            f"if I{k} is the greatest or the least moment, a hyperbola if it is the intermediate one",
            summed(
                number(1),
                expr(-2 * MOMENTS[k - 1]),
                applied=(distribute, entrywise(lambda e: gather(e, OMEGA.components))),
                words="elimination",
            ),
            d.recall("T"),
            label=f"polhode-{k}",
        )
        a, b = conic.coefficients
        square = a * OMEGA.components[i - 1] ** 2 + b * OMEGA.components[j - 1] ** 2
        level = add(dot(H, H), -(expr(2 * MOMENTS[k - 1]) * ENERGY))
        d.check(Equation(level, expr(square)), "the library has the same conic")
        d.check(
            Equation(expr(conic.level), expr(H_SYMBOL**2 - 2 * MOMENTS[k - 1] * T_SYMBOL)), "level"
        )


def _rates(d: Derivation) -> list[Chain]:
    """Solve Euler's equation without torque for the rates of the components."""
    known = dict(zip(OMEGA.components, RATES, strict=True))
    for symbol, rate in known.items():
        d.name_scalar(rate, der(expr(symbol)), f"rate of {symbol}", label=f"{symbol}-rate")
    rates = d.recall("column-of-omega").equation
    moving = d.start(der(column(W, "B"))).then(
        "rates of the components", use(rates), compute(known), label="rate-column"
    )
    tidy = entrywise(lambda e: gather(e, OMEGA.components))
    known_columns = (
        use(d.recall("J-principal").equation),
        use(moving.equation),
        use(rates),
        compute(),
        tidy,
    )
    d.in_components(d.recall("euler-free"), "B", "components in B", label="euler-in-B")
    written = d.recall("euler-in-B").both(
        "by components", lambda t: apply(known_columns, t), label="euler-columns"
    )
    return [
        written.infer(f"row {k}", entry(k, tidy), label=f"euler-{k}").infer(
            f"divided by I{k}", solved(expr(RATES[k - 1]), tidy), label=f"rate-{k}"
        )
        for k in (1, 2, 3)
    ]


def _constant_rates(d: Derivation) -> None:
    """The claim of 000 that rates are constant only without torque and about one principal axis."""
    for k, (w, b) in enumerate(zip(OMEGA.components, AXES, strict=True), 1):
        along = mul(expr(w), b)
        d.start(cross(along, dot(J, along))).then(
            f"where omega lies along the principal axis b{k}, omega x J.omega is zero: free rates "
            "are constant there",
            distribute,
            use(d.recall(f"principal-axis-{k}").equation),
            distribute,
            parallel,
            label=f"along-axis-{k}",
            states=["000:C2", "000:C3"],
        )
    for k, (case, motion) in enumerate(steady.constant_rate_counterexamples().items(), 1):
        rates, inertia = entries(motion.omega.column), entries(sp.Matrix(motion.inertia))
        d.start(matmul(tilde(rates), matmul(inertia, rates))).then(
            CONSTANT_RATES[case],
            compute(),
            entrywise(lambda e: gather(e, OMEGA.components)),
            label=f"constant-rates-{k}",
            states=["000:C2", "000:C3", "000:C4"],
        )
        d.check(
            Equation(d.steps[-1].statement.right, entries(motion.torque.column)),
            "the library needs the same torque",
        )


# -- stability -------------------------------------------------------------------------------


def _stability(d: Derivation, rates: list[Chain]) -> None:
    name_spin(d)
    for k in (1, 2, 3):
        still = dict.fromkeys(OMEGA.components, sp.Integer(0))
        steady_motion = still | {OMEGA.components[k - 1]: steady.SPIN_RATE}
        _across(rates, k)
        polynomial = rates[0].infer(
            f"the rates linearised at a spin nu about b{k}: their characteristic polynomial",
            characteristic(OMEGA.components, steady_motion, steady.ROOT),
            *rates[1:],
            label=f"characteristic-{k}",
        )
        polynomial.then(
            f"its roots: zero, as nu is free, and two opposite ones. A deviation grows as "
            f"exp(lambda t) if I{k} is the intermediate moment, as lambda^2 is positive then, and "
            "oscillates if it is the greatest or the least",
            entrywise(sp.factor_terms, "common factor"),
            label=f"growth-{k}",
        )
        squared = steady.steady_spin(k).squared_growth_rate
        factors = steady.ROOT * (steady.ROOT**2 - squared)
        d.check(Equation(polynomial.equation.left, expr(factors)), "the library has the same")
    _signs(d)


def _signs(d: Derivation) -> None:
    """Derive the signs of the squared growth rates where the moments are in order."""
    I1, I2, I3 = MOMENTS
    squared = [steady.steady_spin(k).squared_growth_rate for k in (1, 2, 3)]
    given = let(
        d,
        (I2 - I1, "let I1 be the least moment", "I1-least"),
        (I3 - I2, "and I3 the greatest", "I3-greatest"),
        *((moment, "moments are not negative", f"{moment}-positive") for moment in MOMENTS),
    )
    nu = steady.SPIN_RATE**2
    given.append(so(given[:2], I3 - I1, ((I2 - I1,), (I3 - I2,)), "both together", "I3-above-I1"))
    least = ((nu, I2 - I1, I3 - I1, 1 / I2, 1 / I3),)
    greatest = ((nu, I3 - I1, I3 - I2, 1 / I1, 1 / I2),)
    middle = ((nu, I2 - I1, I3 - I2, 1 / I1, 1 / I3),)
    first, second, third = (d.recall(f"growth-{k}") for k in (1, 2, 3))
    for line, value, products, words, label in (
        (first, -squared[0], least, "-lambda^2 at the least moment: it oscillates", "least"),
        (third, -squared[2], greatest, "and at the greatest one: stable, too", "greatest"),
        (second, squared[1], middle, "lambda^2 at the third one: a deviation grows", "middle"),
    ):
        so([line, *given], value, products, words, f"{label}-sign")


def _across(rates: list[Chain], k: int) -> None:
    """Derive the second rate across the axis of spin; what is small of third order stands apart."""
    symbols = dict(zip(OMEGA.components, RATES, strict=True))
    rates[k % 3].both(
        f"differentiated once more, the other rates put in: near a spin about b{k} the first term "
        "is linear in the deviation, the other one of third order",
        der,
        compute(symbols),
        put_in(*(r.equation for r in rates)),
        entrywise(_by_monomials),
        label=f"across-{k}",
    )


def _by_monomials(e: Expr) -> Expr:
    """Write a form of the rates by their products, with factored coefficients."""
    poly = sp.Poly(sp.expand(e), *OMEGA.components)
    powers = [sp.Mul(*map(sp.Pow, poly.gens, monomial)) for monomial in poly.monoms()]
    return sp.Add(*(sp.factor(c) * p for c, p in zip(poly.coeffs(), powers, strict=True)))


# -- seen from outside -----------------------------------------------------------------------


_GRADIENT = (
    "the gradient of T over the rates is h, here along b1: the plane that touches the ellipsoid at "
    "omega is normal to h, it is the invariable plane"
)


def _poinsot(d: Derivation) -> None:
    """Poinsot: the ellipsoid of energy rolls on a plane that is fixed in space."""
    d.only("torque_free")
    momentum = d.recall("momentum").equation
    plane = d.start(dot(W, H)).then(
        "h = J.omega: the projection of omega on h",
        use(momentum),
        fold_energy(d),
        label="plane",
    )
    rate = plane.both(
        "which is constant, as T is",
        der,
        differentiate,
        distribute,
        use(d.recall("T-constant").equation),
        label="plane-constant",
    )
    rate.both(
        "as h is constant, the tip of omega stays in a plane normal to h: the invariable plane",
        lambda t: apply((differentiate, use(d.recall("H-constant").equation)), t),
        label="invariable-plane",
    )
    _rolling(d)


def _rolling(d: Derivation) -> None:
    """Derive that the ellipsoid touches the plane, and does not slip on it."""
    contact = quantity("scalar", "s")
    d.start(cross(W, mul(contact, W))).then(
        "the point of the body at s omega lies on the axis of turning and has no velocity: the "
        "ellipsoid rolls without slip",
        distribute,
        parallel,
        label="no-slip",
    )
    d.assume("principal_axes")
    level = d.recall("T").equation.right
    for k, w in enumerate(OMEGA.components, 1):
        d.show(
            Equation(partial(level, expr(w)), dot(AXES[k - 1], H)),
            _GRADIENT if k == 1 else f"likewise along b{k}",
            slopes(d.scalars, d.own),
            use(d.recall("h").equation),
            distribute,
            orthonormal("B"),
            label=f"normal-{k}",
        )


def fold_energy(d: Derivation) -> Any:
    """Return the rule omega.J.omega = 2 T."""
    twice = d.recall("energy").infer(
        "twice the energy", solved(dot(W, dot(J, W))), label="twice-energy"
    )
    return use(twice.equation)


def _by_products(e: Expr) -> Expr:
    """Gather products of the rates, and factor their coefficients."""
    return sp.Add(*map(sp.factor, sp.Add.make_args(gather(e, OMEGA.components))))


def _herpolhode(d: Derivation) -> None:
    d.only("torque_free", "principal_axes")
    h = angular_momentum(sp.diag(*MOMENTS), OMEGA)
    rho = OMEGA - h.scaled(OMEGA.dot(h) / h.dot(h))
    swept = sp.factor(herpolhode_rate() * sp.sqrt(h.dot(h)) * rho.dot(rho))
    seen = d.start(der(W)).then(
        "the transport theorem; omega x omega = 0",
        transport("B"),
        parallel,
        distribute,
        label="omega-rate",
    )
    moving = d.recall("rate-column").then(
        "with Euler's equations",
        put_in(*(d.recall(f"rate-{k}").equation for k in (1, 2, 3))),
        label="rate-column-free",
    )
    d.letter(quantity("vector", "rho"), "part of omega across h")
    d.start(dot(H, cross(W, der(W)))).then(
        "the tip turns about h at the rate (rho x rho').h/(H (rho.rho)), where rho is the part of "
        "omega across h: the herpolhode",
        use(seen.equation),
        scalars_in("B"),
        components("B"),
        use(d.recall("h-columns").equation),
        use(moving.equation),
        use(d.recall("column-of-omega").equation),
        compute(),
        entrywise(_by_products),
        label="herpolhode",
    )
    d.check(Equation(d.steps[-1].statement.left, expr(swept)), "the library has the same rate")


# -- the symmetric body ----------------------------------------------------------------------


def _precession(d: Derivation) -> None:
    d.only("torque_free", "symmetric")
    It, Ia = sp.symbols("I_t I_a", positive=True)
    b3 = AXES[2]
    d.name_scalar(It, dot(AXES[0], dot(J, AXES[0])), "moment across the axis of symmetry")
    d.name_scalar(Ia, dot(b3, dot(J, b3)), "moment about the axis of symmetry")
    momentum = _symmetric_momentum(d, It, Ia)
    angle = _turning(d, momentum)
    constant = _spin(d, momentum, angle)
    _body_cone(d, momentum, constant)


def _symmetric_momentum(d: Derivation, It: Expr, Ia: Expr) -> Chain:
    b3 = AXES[2]
    across = expr(It) * quantity("identity")
    for symbol in (It, Ia):
        d.given(
            Equation(der(expr(symbol)), number(0)),
            "the moments of a rigid body are constant",
            label=f"{symbol}-constant",
        )
    shape = d.given(
        Equation(J, add(across, mul(expr(Ia - It), outer(b3, b3)))),
        "the inertia of a body with an axis of symmetry: the same about all axes across it",
        label="J-symmetric",
    )
    spin = d.recall("omega_3").equation
    return d.recall("momentum").then(
        "of such a body; omega_3 is the spin about its axis",
        use(shape.equation),
        distribute,
        dyads,
        use(spin, backwards=True),
        label="h-symmetric",
    )


def _turning(d: Derivation, momentum: Chain) -> Chain:
    """Derive that the axis turns about h at a constant angle."""
    b3 = AXES[2]
    plane = momentum.infer(
        "solved for omega: it lies in the plane of h and the axis. The body turns about h at the "
        "rate H/I_t, and about its axis besides: in the same sense (prograde) if I_a < I_t, as a "
        "rod, in the opposite sense (retrograde) if I_a > I_t, as a disc",
        solved(W, entrywise(lambda e: gather(sp.expand(e), OMEGA.components))),
        label="plane-of-h",
    )
    turning = d.law(
        Equation(der(b3), cross(W, b3)), "an axis of the body turns with omega", label="axis-turns"
    )
    cone = turning.then(
        "the axis turns about h at the rate H/I_t: the space cone",
        use(plane.equation),
        distribute,
        parallel,
        label="precession",
    )
    return d.start(der(dot(H, b3))).then(
        "at a constant angle: the projection of h on it is constant",
        differentiate,
        use(d.recall("H-constant").equation),
        use(cone.equation),
        distribute,
        triple_zero(H),
        label="nutation",
    )


def _spin(d: Derivation, momentum: Chain, angle: Chain) -> Chain:
    """Derive that the spin about the axis of symmetry is constant."""
    b3, w3 = AXES[2], OMEGA.components[2]
    along = d.start(dot(H, b3)).then(
        "this projection by its own moment",
        use(momentum.equation),
        distribute,
        orthonormal("B"),
        order_dots(b3),
        use(d.recall("omega_3").equation, backwards=True),
        entrywise(sp.expand),
        label="h-along-axis",
    )
    return (
        along.both("differentiate; the moment is constant", der, _all_constant(d))
        .infer("which is zero", equal(), angle)
        .infer(
            "so the spin about the axis of symmetry is constant",
            solved(der(expr(w3))),
            label="spin",
        )
    )


def _all_constant(d: Derivation, *more: Chain) -> Any:
    """Return the rule that the moments, and what ``more`` lines say, have no rate."""
    moments = (d.recall(f"{name}-constant").equation for name in ("I_t", "I_a"))
    return constants(*moments, *(line.equation for line in more))


def _body_cone(d: Derivation, momentum: Chain, constant: Chain) -> None:
    b3 = AXES[2]
    fixed = d.given(Equation(der(b3, "B"), zero("vector")), "the axis is fixed in B")
    local = momentum.both(
        "differentiate in B; moments and spin are constant",
        lambda t: der(t, "B"),
        differentiate_terms,
        _all_constant(d, constant),
        use(fixed.equation),
        distribute,
        label="h-symmetric-rate",
    )
    d.start(der(H)).then(
        "the transport theorem, with this h",
        transport("B"),
        use(local.equation),
        use(momentum.equation),
        distribute,
        parallel,
        label="h-rate-symmetric",
    ).infer("which is zero", equal(), d.recall("H-constant"), label="h-rate-zero").infer(
        "in the body omega turns about the axis: the body cone",
        solved(der(W, "B"), swap(W, b3), distribute),
        label="body-cone",
    )
