"""A rigid body of any density: momentum, inertia, torque (000: first page; 002: 3.18-3.25)."""

from __future__ import annotations

from itertools import combinations_with_replacement
from typing import Any

import sympy as sp

from eom.derivations.chapters.particles import differentiate_constant, mean_position
from eom.derivations.chapters.rotation import explicit
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.mass.inertia import inertia_of_second_moments
from eom.terms.rules import (
    associate,
    bac_cab,
    combine,
    components,
    compute,
    differentiate,
    differentiate_under,
    distribute,
    double_tilde,
    factor_scalar,
    fold_into,
    linear_in,
    ordered,
    parallel,
    scalars_in,
    swap,
    take_out,
    transport,
    unfold,
    unit_entries,
    use,
    vanish,
)
from eom.terms.terms import (
    Equation,
    add,
    column,
    cross,
    der,
    integral,
    matmul,
    mul,
    tilde,
    total,
    zero,
)
from eom.terms.vocabulary import definition, omega, position, quantity, velocity

W = omega()
R = position("dm", "C")
RHO = position("dm", "O")
BODY_MASS = quantity("total_mass", "body")
FIRST = quantity("first_moment", "body", "O")
ACCELERATION_O = der(velocity("O"))
FORCE, MOMENTUM = (quantity(n, "body") for n in ("external_force", "linear_momentum"))


def rigid_momentum() -> Derived:
    """Derive linear and angular momentum of a rigid continuum, and its inertia, about any point."""
    d = Derivation("rigid-body-momentum", "Momentum and inertia of a rigid body", "Rigid body")
    _linear(d)
    _about_origin(d)
    _about_centre(d)
    J = _inertia_matrix(d)
    _about_body_point(d)
    _torque(d)
    d.stands_for("J", column(quantity("inertia", "C"), "B"))
    return d.finish(J=J)


def _linear(d: Derivation) -> None:
    d.only("rigid", "newton_2", "third_law_weak")
    d.define(BODY_MASS, "mass of the body", label="mass").both(
        "it is constant, as the mass of each element is",
        der,
        differentiate_under,
        differentiate,
        label="mass-constant",
    )
    centre = d.law(
        Equation(mul(BODY_MASS, position("C")), integral(position("dm"))),
        "the centre of mass",
        label="centre",
        states=["002:E20"],
    )
    mean_position(d, centre, BODY_MASS, ["002:E20"])
    _force(d, centre)


def _force(d: Derivation, centre: Chain) -> None:
    """Derive the motion of the centre of mass from Newton's law for every element."""
    d.law(
        Equation(der(MOMENTUM), total(der(quantity("linear_momentum", "dm")), "dm", "elements")),
        "momenta add, and so do their rates",
        label="momentum-elements",
        states=["002:E19"],
    )
    d.define(FORCE, "external force on all elements", label="force-elements", states=["002:E19"])
    rate = d.define(MOMENTUM, "linear momentum", label="momentum").both(
        "differentiate; the mass of each element is constant",
        der,
        differentiate_under,
        label="momentum-rate",
        states=["002:E19"],
    )
    force = d.law(
        Equation(FORCE, rate.equation.right),
        "Newton's laws for every element: internal forces cancel",
        label="force",
        states=["002:E19"],
    )
    centre.both(
        "differentiate twice",
        lambda t: differentiate_constant(der(t, times=2)),
        differentiate_constant,
        use(force.equation, backwards=True),
        label="motion-of-centre",
        states=["002:E22", "002:C3"],
    )


def _about_origin(d: Derivation) -> None:
    """Part the angular momentum about the inertial origin; the body need not be rigid."""
    d.only("constant_mass")
    start = d.define(
        quantity("absolute_angular_momentum", "body", "OI"),
        "angular momentum about the inertial origin",
        label="H-origin",
        states=["000:E1"],
    )
    split = d.law(
        Equation(position("dm"), add(position("C"), R)),
        "position by way of the centre of mass",
        label="split",
        states=["000:E2", "000:E26"],
    )
    parted = (
        start.then("R = R_C + r", use(split.equation), label="H-inserted", states=["000:E3"])
        .then("multiply out", distribute, label="H-terms", states=["000:E4"])
        .then(
            "what is the same for all elements comes out of the integrals",
            take_out,
            fold_into(BODY_MASS),
            label="H-parted",
            states=["000:E4"],
        )
    )
    _two_parts(d, parted)


def _two_parts(d: Derivation, parted: Chain) -> None:
    first = d.law(
        Equation(integral(R), zero("vector")),
        "r starts at the centre of mass",
        label="first-moment-zero",
        states=["000:E5"],
    )
    moving = first.both("differentiate", lambda t: differentiate_under(der(t)), label="its-rate")
    named = parted.then(
        "two terms vanish",
        use(first.equation),
        use(moving.equation),
        distribute,
        label="H-origin-parts",
        states=["000:E6"],
    )
    spin = d.define(
        quantity("angular_momentum", "body", "C"),
        "angular momentum about the centre of mass",
        label="h-centre",
        states=["000:E7"],
    )
    named.then(
        "motion of the centre and spin about it",
        use(spin.equation, backwards=True),
        label="H-and-h",
    )


def _about_centre(d: Derivation) -> None:
    d.only("body_frame")
    rigid = d.given(
        Equation(der(R, "B"), zero("vector")),
        "the body is rigid, and B and C are fixed in it",
        label="rigid",
        states=["000:E9"],
    )
    seen = d.start(der(R)).then("the transport theorem", transport("B"), label="r-rate-terms")
    moved = seen.then(
        "r does not change in B",
        use(rigid.equation),
        distribute,
        label="r-rate",
        states=["000:E10"],
    )
    spin = d.recall("h-centre").then(
        "r' = omega x r", use(moved.equation), label="h-crossed", states=["000:E11", "000:E32"]
    )
    turned = spin.then("omega x r = -r x omega", swap(W, R), distribute)
    d.in_components(
        turned,
        "B",
        "components in B; omega comes out of the integral",
        associate,
        take_out,
        label="h-tilde",
        states=["000:E14"],
    )
    to_dyadic(spin, "C", label="h-inertia", states=("000:E15", "000:E20"))
    d.in_components(
        d.recall("h-inertia"),
        "B",
        "in components in B, as the lecture writes it: the inertia matrix times the column of omega",
        label="h-inertia-matrix",
        states=["000:E15", "000:E20"],
    )


PLACES = {"C": "r", "O": "rho"}
"""How reasons spell the position of an element from a point."""


def to_dyadic(spin: Chain, about: str, *, label: str, states: tuple[str, ...] = ()) -> Chain:
    """Write the integral of r x (omega x r) dm as J . omega."""
    r = PLACES[about]
    parted = spin.then(
        f"{r} x (omega x {r}) = omega ({r}.{r}) - {r} ({r}.omega)", bac_cab, label=f"{label}-parted"
    )
    return parted.then(
        "linear in omega: the integral is the inertia dyadic",
        linear_in(W),
        fold_into(quantity("inertia", about)),
        label=label,
        states=states,
    )


def inertia_by_definition(
    d: Derivation, about: str, label: str, frame: str = "B", **options: Any
) -> Chain:
    """Write the inertia matrix in a frame by the definition of the dyadic."""
    dyadic = quantity("inertia", about)
    if Equation(dyadic, definition(dyadic) or dyadic, ":=") not in d.stated:
        d.define(dyadic, "inertia dyadic")
    return d.start(column(dyadic, frame)).then(
        f"components in {frame} of the definition",
        unfold("inertia"),
        components(frame),
        scalars_in(frame),
        label=label,
        **options,
    )


def inertia_by_tildes(
    d: Derivation, written: Chain, about: str, frame: str = "B", **options: Any
) -> Chain:
    """Write the inertia matrix as minus the integral of the squared skew matrix."""
    r, spelt = column(position("dm", about), frame), PLACES.get(about)
    x = f"[{spelt}]_{frame}"
    product = f" is {x} {x}^T less {x}^T {x} times the unit matrix" if spelt else ", written out"
    return d.show(
        Equation(written.equation.left, -integral(matmul(tilde(r), tilde(r)))),
        f"the product of two skew matrices{product}: minus the integrand",
        use(written.equation),
        double_tilde,
        distribute,
        **options,
    )


def _inertia_matrix(d: Derivation) -> sp.Matrix:
    d.only("body_frame")
    written = inertia_by_definition(d, "C", "J-matrix")
    inertia_by_tildes(d, written, "C", label="J-tilde", states=["000:E15"])
    known = explicit(d, R, "r", "B", "component of r along b{k}")
    written.then(
        "by components",
        use(known),
        unit_entries,
        compute(),
        label="J-entries",
        states=["000:E16"],
    )
    S = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"S_{min(i, j) + 1}{max(i, j) + 1}", real=True))
    for i, j in combinations_with_replacement(range(3), 2):
        product = f"r_{i + 1} r_{j + 1}" if i < j else f"r_{i + 1}^2"
        d.letter(S[i, j], f"integral of {product} dm over the body")
    return sp.Matrix(inertia_of_second_moments(S))


def _about_body_point(d: Derivation) -> None:
    """The same about a point O that is fixed in the body."""
    d.only("rigid")
    first = d.define(
        quantity("first_moment", "body", "O"),
        "first moment of mass about O",
        label="first-moment",
        states=["002:E21"],
    )
    _first_moment_of_centre(d, first)
    momentum = d.define(
        quantity("angular_momentum", "body", "O"),
        "angular momentum about O",
        label="h",
        states=["002:E23"],
    )
    seen = momentum.then(
        "the transport theorem", transport("B"), label="h-transport", states=["002:E23"]
    )
    _inertia_about_body_point(d, seen)


def _first_moment_of_centre(d: Derivation, first: Chain) -> None:
    relative, centre = (
        Equation(position(p, "O"), add(position(p), -position("O"))) for p in ("dm", "C")
    )
    d.law(relative, "rho = R - R_O for each element", label="relative")
    d.law(centre, "and for the centre of mass", label="relative-centre")
    first.then(
        "rho = R - R_O; the position of O comes out of the integral",
        use(relative),
        distribute,
        take_out,
        fold_into(BODY_MASS),
        label="first-moment-parted",
    ).then(
        "the integral is that of the centre of mass; the mass is a common factor",
        use(d.recall("centre").equation, backwards=True),
        factor_scalar(BODY_MASS),
        use(centre, backwards=True),
        label="first-moment-of-centre",
        states=["002:E21"],
    )


def _inertia_about_body_point(d: Derivation, seen: Chain) -> None:
    d.assume("body_frame", "O_fixed_in_body")
    fixed = d.given(
        Equation(der(RHO, "B"), zero("vector")),
        "O and B are fixed in the rigid body",
        label="rho-fixed",
    )
    crossed = seen.then(
        "rho does not change in B", vanish(fixed.equation.left), distribute, label="h-omega"
    )
    turned = crossed.then(
        "omega x rho = -rho x omega",
        swap(W, RHO),
        distribute,
        label="h-swapped",
        states=["002:E23"],
    )
    to_dyadic(crossed, "O", label="h-J", states=("002:E23",))
    d.in_components(turned, "B", "components in B", label="h-columns", states=["002:E24"]).then(
        "omega comes out of the integral", associate, take_out, label="h-matrix", states=["002:E24"]
    )
    d.in_components(d.recall("h-J"), "B", "components in B", label="h-J-matrix", states=["002:E24"])
    written = inertia_by_definition(d, "O", "J-matrix-O", states=["002:E25"])
    inertia_by_tildes(d, written, "O", label="J-tilde-O", states=["002:E25"])


def _torque(d: Derivation) -> None:
    d.only("rigid", "newton_2", "third_law_strong")
    torque = d.define(
        quantity("torque", "body", "O"),
        "external torque about O",
        label="torque",
        states=["002:E26"],
    )
    law = _law_about_any_point(d, torque)
    c = quantity("first_moment", "body", "O")
    d.assume("about_centre")
    d.given(Equation(c, zero("vector")), "O is the centre of mass", label="c-zero")
    law.then("no second term", vanish(c), distribute, label="torque-law-centre", states=["002:C4"])


def _law_about_any_point(d: Derivation, torque: Chain) -> Chain:
    """Derive the law of angular momentum about O from that about the inertial origin."""
    origin = quantity("torque", "body", "OI")
    H_origin = quantity("absolute_angular_momentum", "body", "OI")
    law = d.law(
        Equation(origin, der(H_origin)),
        "the law of angular momentum about the inertial origin: Newton's laws for every element, "
        "whose internal forces have no torque",
        label="law-origin",
    )
    relative = d.recall("relative").equation
    moved = torque.then(
        "rho = R - R_O; the position of O comes out of the sum",
        use(relative),
        distribute,
        take_out,
        fold_into(FORCE, origin),
        label="torque-moved",
    )
    h = d.recall("h").then(
        "rho = R - R_O; position and velocity of O come out of the integrals",
        use(relative),
        distribute,
        take_out,
        fold_into(BODY_MASS, H_origin),
        label="h-moved",
    )
    return _with_laws(d, torque, (moved, _rate_about_origin(d, h), law))


def _rate_about_origin(d: Derivation, h: Chain) -> Chain:
    return h.both(
        "differentiate; what stands in opposite products cancels",
        der,
        differentiate,
        differentiate_under,
        use(d.recall("mass-constant").equation),
        distribute,
        parallel,
        ordered,
        combine,
        label="h-moved-rate",
    )


def _with_laws(d: Derivation, torque: Chain, lines: tuple[Chain, ...]) -> Chain:
    h = quantity("angular_momentum", "body", "O")
    return d.show(
        Equation(torque.equation.left, add(der(h), cross(FIRST, ACCELERATION_O))),
        "the laws of momentum and of angular momentum about the origin put in: on both sides the "
        "same terms are left",
        *(use(line.equation) for line in lines),
        use(d.recall("force").equation),
        use(d.recall("first-moment-parted").equation),
        distribute,
        label="torque-law",
        states=["002:E26"],
    )
