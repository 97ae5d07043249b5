"""A system of N point masses, for any N: momentum, angular momentum, torque (002: 3.5-3.17)."""

from __future__ import annotations

import sympy as sp

from eom.derivations.chapters.pointmass import SPLIT
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.terms.rules import (
    combine,
    differentiate,
    differentiate_under,
    distribute,
    factor_scalar,
    fold_into,
    from_itself,
    inside,
    into_sums,
    parallel,
    put,
    regroup_right,
    seen_from,
    symmetrise,
    take_out,
    transport,
    unfold,
    use,
    vanish,
)
from eom.terms.rules.inferences import divided, renamed, solved
from eom.terms.terms import Equation, Term, add, cross, der, mul, number, relabel, total, zero
from eom.terms.vocabulary import mass, position, quantity, velocity

EXTERNAL = quantity("external_force", "system")
MOMENTUM = quantity("linear_momentum", "system")
FIRST = quantity("first_moment", "system", "O")
TORQUE = quantity("torque", "system", "O")
H, h = (quantity(n, "system", "O") for n in ("absolute_angular_momentum", "angular_momentum"))
TOTAL_MASS = quantity("total_mass", "system")
INTERNAL = quantity("internal_force", "i", "j")
OPPOSITE = quantity("internal_force", "j", "i")
RESULTANT = add(quantity("force", "i"), total(INTERNAL, "j"))
TOTAL = sp.Symbol("m", real=True)
SPLIT_I = Equation(relabel(SPLIT.left, {"P": "i"}), relabel(SPLIT.right, {"P": "i"}))


def particle_system() -> Derived:
    """Derive the laws of momentum and angular momentum of any number of point masses."""
    d = Derivation("particle-system", "Dynamics of a system of point masses", "Particles")
    _newton(d)
    _centre_of_mass(d)
    _absolute_momentum(d)
    _torque(d)
    _rotating_frame(d)
    return d.finish()


def _newton(d: Derivation) -> None:
    d.only("newton_2", "constant_mass")
    one = Equation(RESULTANT, mul(mass("i"), der(velocity("i"))))
    law = d.law(one, "Newton's second law for each mass", label="newton", states=["002:E6"])
    d.given(Equation(der(mass("i")), number(0)), "each mass is constant", label="constant-masses")
    law.both(
        "sum over all masses", lambda t: distribute(total(t)), label="newton-sum", states=["002:E6"]
    )
    d.assume("third_law_weak")
    third = d.law(Equation(OPPOSITE, -INTERNAL), "Newton's third law", label="third-law")
    cancel = d.start(total(total(INTERNAL, "j"))).then(
        "half the sum over both orders; opposite forces cancel",
        symmetrise("i", "j"),
        put(third.equation.left, third.equation.right),
        combine,
        distribute,
        label="internal-forces",
    )
    external = d.define(EXTERNAL, "total external force")
    d.recall("newton-sum").both(
        "internal forces cancel",
        lambda t: use(external.equation, backwards=True)(use(cancel.equation)(t)),
        label="external-force",
    )


def _centre_of_mass(d: Derivation) -> None:
    d.only("constant_mass")
    d.define(TOTAL_MASS, "total mass", label="total-mass").both(
        "it is constant, as each mass is", der, differentiate_constant, label="total-mass-constant"
    )
    weighted = total(mul(mass("i"), position("i")))
    centre = d.law(
        Equation(mul(TOTAL_MASS, position("C")), weighted),
        "the centre of mass",
        label="centre",
        states=["002:E7"],
    )
    mean_position(d, centre, TOTAL_MASS, ["002:E7"])
    twice = centre.both(
        "differentiate twice; masses are constant",
        lambda t: differentiate_constant(der(t, times=2)),
        differentiate_constant,
        label="centre-acceleration",
    )
    d.assume("newton_2", "third_law_weak")
    force = use(d.recall("external-force").equation, backwards=True)
    twice.then(
        "the sum is the external force",
        force,
        label="motion-of-centre",
        states=["002:E8", "002:E9"],
    )
    _momentum(d, centre)


def mean_position(d: Derivation, centre: Chain, mass: Term, states: list[str]) -> None:
    """Derive the place of the centre of mass as a quotient: the mean of all places."""
    centre.infer(
        "divided by the whole mass: the mean position, each place weighted by the mass there",
        divided(position("C")),
        d.name_scalar(TOTAL, mass, "mass of all together", label="m"),
        label="mean-position",
        states=states,
    )


def _momentum(d: Derivation, centre: Chain) -> None:
    """Derive the momentum of the system by the motion of its centre of mass."""
    d.define(
        quantity("linear_momentum", "i"),
        "linear momentum of each mass",
        label="momentum-i",
        states=["002:E9"],
    )
    p = d.define(MOMENTUM, "linear momentum of the system", label="momentum")
    once = centre.both(
        "differentiate", lambda t: differentiate_constant(der(t)), differentiate_constant
    )
    named = p.then(
        "the centre of mass",
        use(once.equation, backwards=True),
        label="momentum-of-centre",
        states=["002:E9"],
    )
    named.both(
        "differentiate again",
        der,
        differentiate_constant,
        use(d.recall("motion-of-centre").equation),
        label="momentum-rate",
        states=["002:E9"],
    )


def differentiate_constant(term: Term) -> Term:
    """Differentiate sums and products with constant masses."""
    fixed = [der(mass(i)) for i in ("i", "P", "dm")]
    fixed += [der(quantity("total_mass", who)) for who in ("system", "body")]
    for rule in (differentiate_under, differentiate, vanish(*fixed), distribute, combine):
        term = rule(term)
    return term


def _absolute_momentum(d: Derivation) -> None:
    d.only()
    split = d.law(SPLIT_I, "position by way of O", label="split")
    d.define(
        quantity("absolute_angular_momentum", "i", "O"),
        "absolute angular momentum of each mass about O",
        label="H-i",
        states=["002:E10"],
    )
    definition = d.define(
        H, "absolute angular momentum about O", label="H-definition", states=["002:E10"]
    )
    expanded = (
        definition.then("p_i = m_i r_i'", unfold("linear_momentum"), distribute, label="H-masses")
        .then(
            "r_i = r_O + rho_i",
            inside("der", use(split.equation)),
            distribute,
            label="H-split",
            states=["002:E10"],
        )
        .then(
            "the velocity of O comes out of the sum", take_out, label="H-sums", states=["002:E10"]
        )
    )
    _first_moment(d)
    d.define(h, "relative angular momentum about O", label="h-definition", states=["002:E12"])
    named = expanded.then(
        "name both sums", fold_into(FIRST, h), label="H-and-h", states=["002:E12"]
    )
    d.only("about_centre")
    d.given(Equation(FIRST, zero("vector")), "O is the centre of mass", label="first-moment-zero")
    named.then("no distinction about the centre of mass", vanish(FIRST), label="H-is-h")


def _first_moment(d: Derivation) -> None:
    first = d.define(
        FIRST, "first moment of mass about O", label="first-moment", states=["002:E11"]
    )
    d.recall("split").infer(
        "solved for the place from O", solved(position("i", "O")), label="relative"
    )
    d.law(
        Equation(position("C", "O"), add(position("C"), -position("O"))),
        "and the same for the centre of mass",
        label="relative-centre",
    )
    parted = first.then(
        "rho_i = r_i - r_O; the position of O comes out of the sum",
        use(d.recall("relative").equation),
        distribute,
        take_out,
        fold_into(TOTAL_MASS),
        label="first-moment-parted",
    )
    of_centre = parted.then(
        "the sum is that of the centre of mass; M comes out",
        use(d.recall("centre").equation, backwards=True),
        factor_scalar(TOTAL_MASS),
        use(d.recall("relative-centre").equation, backwards=True),
        label="first-moment-of-centre",
        states=["002:E11"],
    )
    of_centre.infer(
        "about the centre of mass, which is at no distance from itself",
        renamed({"O": "C"}, from_itself),
        label="first-moment-vanishes",
    )


def _torque(d: Derivation) -> None:
    d.only("constant_mass")
    parted = _momentum_rate(d)
    d.assume("newton_2")
    forced = parted.then(
        "Newton's second law for each mass",
        inside("sum", regroup_right(mass("i"))),
        use(d.recall("newton").equation, backwards=True),
        distribute,
        into_sums,
        fold_into(FIRST),
        label="h-rate-forces",
        states=["002:E14"],
    )
    _strong_law(d)
    d.assume("third_law_strong")
    torque = d.define(TORQUE, "external torque about O", label="torque", states=["002:E16"])
    quiet = forced.then(
        "internal forces have no torque",
        use(d.recall("internal-torque").equation),
        use(torque.equation, backwards=True),
        label="h-rate-torque",
    )
    quiet.infer(
        "solve for the torque", solved(TORQUE), label="torque-law", states=["002:E16"]
    ).infer("about the centre of mass", renamed({"O": "C"}), label="torque-law-any").then(
        "whose first moment about itself is zero",
        use(d.recall("first-moment-vanishes").equation),
        distribute,
        label="torque-law-of-centre",
    ).turned("so no second term is left", label="torque-law-centre", states=["002:E17", "002:C4"])


def _momentum_rate(d: Derivation) -> Chain:
    """Differentiate h_O, by the accelerations of the masses and of O."""
    rate = d.recall("h-definition").both(
        "differentiate each term; masses are constant",
        der,
        differentiate_constant,
        label="h-rate-terms",
        states=["002:E13"],
    )
    crossed = rate.then("a vector crossed with itself is zero", parallel, distribute)
    relative = d.recall("relative").equation
    return crossed.then(
        "rho_i = r_i - r_O; the acceleration of O comes out of the sum",
        inside("der", use(relative)),
        distribute,
        take_out,
        label="h-rate",
        states=["002:E13"],
    )


def _strong_law(d: Derivation) -> None:
    """Show that internal forces along the connecting lines have no torque."""
    d.assume("third_law_weak")
    halved = d.start(total(total(cross(position("i", "O"), INTERNAL), "j"))).then(
        "half the sum over both orders, with f_ji = -f_ij",
        symmetrise("i", "j"),
        put(OPPOSITE, -INTERNAL),
        distribute,
        label="internal-halves",
        states=["002:E15"],
    )
    d.assume("third_law_strong")
    along = d.law(
        Equation(cross(position("i", "O"), INTERNAL), cross(position("j", "O"), INTERNAL)),
        "the force acts along the line between the masses",
        label="along",
    )
    halved.then(
        "so the terms of each pair cancel",
        put(along.equation.left, along.equation.right),
        combine,
        label="internal-torque",
        states=["002:E15"],
    )


def _rotating_frame(d: Derivation) -> None:
    d.only("newton_2", "third_law_weak", "constant_mass")
    law = d.recall("momentum-rate").turned("the law of momentum", label="momentum-law")
    law.then("as seen from B", transport("B"), label="momentum-law-B", states=["002:E18"])
    moved = d.recall("motion-of-centre").turned("motion of the centre", label="centre-law")
    seen = moved.then(
        "the transport theorem, twice",
        seen_from("B"),
        label="acceleration-terms",
    )
    seen.then(
        "equal terms together: local, Coriolis, Euler and centripetal acceleration",
        combine,
        label="acceleration-B",
        states=["002:E18"],
    )
