"""Euler's equations of a rigid body: dyadic, matrix, principal (000; 001; 002: 3.26-3.27, 3.36)."""

from __future__ import annotations

import sympy as sp

from eom.derivations.chapters.rotation import explicit, principal_matrix
from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.derivations.standing import BODY
from eom.exact.algebra import gather, gather_above
from eom.kinematics.coordinates import attitude
from eom.mechanics.rigidbody import OMEGA, principal_inertia, rigid_body
from eom.mechanics.torques import applied
from eom.quantities import Quantity
from eom.system import System
from eom.terms.rules import (
    apply,
    at,
    compute,
    differentiate,
    distribute,
    entrywise,
    parallel,
    transport,
    use,
    vanish,
)
from eom.terms.rules.inferences import entry, solved
from eom.terms.terms import (
    Equation,
    add,
    column,
    cross,
    der,
    dot,
    expr,
    matmul,
    mul,
    number,
    zero,
)
from eom.terms.vocabulary import omega, position, quantity, velocity

W = omega()
J = quantity("inertia", "C")
H, TORQUE = (quantity(n, "body", "C") for n in ("angular_momentum", "torque"))
J_B, W_B, TORQUE_B = (column(x, "B") for x in (J, W, TORQUE))
FREE = ("body_frame", "newton_2", "third_law_strong")
TAU = sp.symbols("tau_1:4", real=True)
OMEGA_DOT = sp.symbols("omega_1_dot omega_2_dot omega_3_dot", real=True)


def euler_equations() -> Derived:
    """Derive Euler's equations about the centre of mass, and in principal axes."""
    d = Derivation("euler-equations", "Euler's equations of a rigid body", "Rigid body")
    _dyadic(d)
    _matrix(d)
    _principal(d)
    _where_valid(d)
    d.only(*FREE, "principal_axes")
    d.stands.update(BODY)
    return d.finish(equations=principal_system())


def principal_system() -> System:
    """Return the equations that the last steps state, with the torque as inputs."""
    inputs = tuple(
        Quantity(t, "N m", f"torque about b{k}", f"\\tau_{k}") for k, t in enumerate(TAU, 1)
    )
    return rigid_body(
        principal_inertia(),
        lambda C, J: applied(TAU, inputs=inputs),
        attitude("quaternion"),
        name="euler_equations",
        title="Rigid body in principal axes",
    )


def _dyadic(d: Derivation) -> None:
    d.only(*FREE)
    law = d.law(
        Equation(der(H), TORQUE),
        "the rate of the angular momentum is the torque, both about the centre of mass",
        label="law",
        states=["000:E19"],
    )
    seen = d.start(der(H)).then(
        "as seen from B", transport("B"), label="transport", states=["000:E19", "002:E27"]
    )
    seen.both(
        "which is the torque", use(law.equation), label="torque-transport", states=["002:E27"]
    )
    momentum = d.law(
        Equation(H, dot(J, W)),
        "momentum of a rigid body, derived in its own chapter",
        label="momentum",
        states=["000:E20"],
    )
    _euler(d, seen, momentum, law)


def _euler(d: Derivation, seen: Chain, momentum: Chain, law: Chain) -> None:
    words = "J_C does not change in B"
    d.given(Equation(der(J, "B"), zero("dyadic")), words, label="J-constant")
    local = momentum.both(
        "differentiate in B",
        lambda t: der(t, "B"),
        differentiate,
        label="local-terms",
        states=["000:E21"],
    ).then(words, vanish(der(J, "B")), distribute, label="local", states=["000:E21"])
    d.start(der(W)).then(
        "the transport theorem", transport("B"), label="omega-rate", states=["000:E22"]
    ).then("omega x omega = 0", parallel, distribute, label="omega-rates-equal")
    d.in_components(
        d.recall("local-terms"),
        "B",
        "the same in components in B",
        label="local-terms-matrix",
        states=["000:E21"],
    )
    d.in_components(
        d.recall("local"),
        "B",
        "and where J_C does not change; omega has one rate in both frames",
        use(d.recall("omega-rates-equal").equation, backwards=True),
        label="local-matrix",
        states=["000:E21"],
    )
    seen.then(
        "with h_C = J_C.omega",
        use(local.equation),
        use(momentum.equation),
        label="rate-dyadic",
        states=["001:E1"],
    ).both("h_C' is the torque", use(law.equation)).turned(
        "Euler's equation", label="euler-dyadic", states=["000:E23", "001:E1"]
    )


def _matrix(d: Derivation) -> None:
    euler = d.recall("euler-dyadic")
    d.in_components(
        euler,
        "B",
        "components in B",
        label="euler-matrix",
        states=["001:E2", "002:E28"],
    ).infer(
        "solved for the rates",
        solved(matmul(J_B, der(W_B))),
        label="euler-rates",
        states=["000:E23", "000:E24"],
    )


def _principal(d: Derivation) -> None:
    d.only(*FREE, "principal_axes")
    diagonal = principal_matrix(d, J, label="J-principal", states=["000:E18"]).equation
    rates = explicit(d, W, "omega", "B", "component of omega along b{k}")
    torque = explicit(d, TORQUE, "tau", "B", "component of the torque along b{k}")
    known = dict(zip(OMEGA.components, OMEGA_DOT, strict=True))
    for symbol, rate in known.items():
        d.name_scalar(rate, der(expr(symbol)), f"rate of {symbol}")
    rate_column = d.start(der(W_B)).then(
        "rates of the components of omega",
        use(rates),
        compute(known),
        label="rate-column",
    )
    by_components = (
        use(diagonal),
        use(rate_column.equation),
        use(rates),
        use(torque),
        compute(),
        entrywise(lambda e: gather(e, (*OMEGA.components, *OMEGA_DOT))),
    )
    written = d.recall("euler-matrix").both(
        "by components", lambda t: apply(by_components, t), label="euler-principal"
    )
    _rows(d, written)


def _rows(d: Derivation, written: Chain) -> None:
    """State each row, and its rate."""
    ids = (
        ("000:E25", "001:E3", "002:E37"),
        ("000:E25", "001:E4", "002:E38"),
        ("000:E25", "001:E5", "002:E39"),
    )
    system = principal_system()
    for k, states in enumerate(ids, 1):
        variables = (*OMEGA.components, *OMEGA_DOT)
        row = written.infer(
            f"row {k}",
            entry(k, entrywise(lambda e: gather(e, variables))),  # noqa: B023 - applied at once
            label=f"euler-{k}",
            states=states,
        )
        rate = row.infer(
            "solved for the rate: the equation of motion",
            solved(expr(OMEGA_DOT[k - 1]), entrywise(lambda e: gather_above(e, OMEGA.components))),
            label=f"rate-{k}",
        )
        d.check(Equation(rate.equation.left, expr(system.rates[k - 1])), "the system has the same")


def _where_valid(d: Derivation) -> None:
    """The same about any point O of the body, and about one that is fixed in space: a pivot."""
    d.only("body_frame", "newton_2", "third_law_strong", "O_fixed_in_body")
    any_point = _about_any_point(d)
    d.assume("O_fixed_in_space")
    still = d.given(
        Equation(ACCELERATION, zero("vector")), "O does not accelerate", label="O-fixed"
    )
    any_point.both(
        "about a pivot, fixed in the body and in space, Euler's equation has the form it has about "
        "the centre of mass; fixed in space alone would not do, as J_O would change in B",
        use(still.equation),
        label="euler-pivot",
        states=["000:C1"],
    )
    _passed_by(d)


def _passed_by(d: Derivation) -> None:
    """Derive the torque about a point that is fixed in space alone: Euler's equation fails there."""
    h, torque = (quantity(n, "body", "O") for n in ("angular_momentum", "torque"))
    arm, whole = position("C", "O"), quantity("total_mass", "body")
    d.only("newton_2", "third_law_strong", "constant_mass", "O_fixed_in_space")
    law = d.law(
        Equation(torque, der(h)),
        "about a point that is fixed in space the torque is the rate of the angular momentum",
        label="law-fixed-point",
    )
    constant = d.given(
        Equation(der(whole), number(0)), "the mass is constant", label="mass-constant"
    )
    rate = d.law(
        Equation(h, add(H, mul(whole, cross(arm, der(arm))))),
        "angular momentum about O: that about the centre of mass, and that of its motion",
        label="h-about-O",
    ).both(
        "differentiate",
        der,
        differentiate,
        use(constant.equation),
        parallel,
        distribute,
        label="h-about-O-rate",
    )
    law.then(
        "where the body only passes O. One that does not turn has omega = 0: every term of Euler's "
        "equation about O is zero, and this torque is not, unless its centre moves steadily or along "
        "the line to O. So the point has to be fixed in the body, too",
        use(rate.equation),
        label="passed-by",
        states=["000:C1"],
    )


ACCELERATION = der(velocity("O"))


def _about_any_point(d: Derivation) -> Chain:
    inertia, torque = quantity("inertia", "O"), quantity("torque", "body", "O")
    h, first = (quantity(n, "body", "O") for n in ("angular_momentum", "first_moment"))
    law = d.law(
        Equation(torque, add(der(h), cross(first, ACCELERATION))),
        "the law of angular momentum about any point, derived in the chapter on the rigid body",
        label="law-any-point",
    )
    momentum = d.law(
        Equation(h, dot(inertia, W)), "momentum about a point of the body", label="momentum-O"
    )
    constant = d.given(
        Equation(der(inertia, "B"), zero("dyadic")),
        "O and B are fixed in the body: J_O does not change in B",
        label="J-O-constant",
    )
    local = momentum.both(
        "differentiate in B",
        lambda t: der(t, "B"),
        differentiate,
        use(constant.equation),
        distribute,
        label="local-O",
    )
    return law.then(
        "the transport theorem, with h_O = J_O.omega",
        at(der(h), transport("B")),
        use(local.equation),
        use(momentum.equation),
        label="law-any-point-dyadic",
    ).turned(
        "about any point of the body, its acceleration counts",
        label="euler-any-point",
        states=["000:C1"],
    )
