"""The 3-1-2 spinning symmetric body, line by line as in lecture 001."""

from __future__ import annotations

import sympy as sp

from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.derivations.standing import IN_SPACE, MOMENTUM, Stands
from eom.mechanics import spinning
from eom.mechanics.spinning import (
    I1,
    I2,
    OMEGA,
    OMEGA_DOT,
    PHI,
    PSI,
    PSI_DDOT,
    PSI_DOT,
    THETA,
    THETA_DDOT,
    THETA_DOT,
    SpinningSymmetricBody,
)
from eom.terms.rules import (
    by_axes,
    components,
    compute,
    distribute,
    entrywise,
    orthonormal,
    put_in,
    transport,
    use,
)
from eom.terms.rules.inferences import along_axis, solved
from eom.terms.terms import Equation, add, column, cross, der, dot, entries, expr, mul, number
from eom.terms.vocabulary import omega, quantity, unit

H, TORQUE = (quantity(n, "body", "C") for n in ("angular_momentum", "torque"))
J = quantity("inertia", "C")
B1, B2, B3 = (unit("B", k) for k in (1, 2, 3))
A3 = unit("A", 3)
AXLE = spinning.SPIN
"""The angular velocity about the axle; the scene's state C, a letter that frame and centre have here."""
_CALLED: Stands = {
    **MOMENTUM,
    **IN_SPACE,
    "T": quantity("rotational_energy", "body", "C"),
    **{f"torque_{k}": dot(unit("B", k), TORQUE) for k in (1, 2, 3)},
    **{f"axle_{k}": dot(unit("I", k), B2) for k in (1, 2, 3)},
    "I3": dot(B3, dot(J, B3)),
    "h_G": column(H, "B"),
    "rate": column(der(H), "B"),
}
"""What the results and the quantities of the system are."""
ONE_FRACTION = entrywise(lambda e: sp.together(sp.expand(e)))


def spinning_symmetric_body() -> Derived:
    """Derive lecture 001: frames, momentum, its rate with the term in dOmega/dt kept, and the motion."""
    d = Derivation(
        "spinning-symmetric-body", "The 3-1-2 spinning symmetric body", "Spinning bodies"
    )
    body = spinning.lecture_torque()
    d.only("spin_312")
    _name_angles(d)
    _frames(d, body)
    _momentum(d, body)
    _momentum_rate(d, body)
    _motion(d, body)
    d.stands.update(_CALLED)
    return d.finish(
        equations=body.system(), h_G=body.h_G.column, rate=body.momentum_rate.total.column
    )


def _name_angles(d: Derivation) -> None:
    turns = ((PSI, "psi", "first"), (THETA, "theta", "second"), (PHI, "phi", "third"))
    for symbol, name, turn in turns:
        d.name_scalar(symbol, quantity("angle", name), f"angle of the {turn} turn")
    for symbol, of, words in (
        (PSI_DOT, PSI, "rate of psi"),
        (THETA_DOT, THETA, "rate of theta"),
        (OMEGA, PHI, "spin rate of the body in B, the rate of phi"),
        (PSI_DDOT, PSI_DOT, "second derivative of psi"),
        (THETA_DDOT, THETA_DOT, "second derivative of theta"),
        (OMEGA_DOT, OMEGA, "rate of the spin rate"),
    ):
        d.name_scalar(symbol, der(expr(of)), words)


def _frames(d: Derivation, body: SpinningSymmetricBody) -> None:
    d.state(
        Equation(quantity("rotation", "B", "A"), entries(body.C_BA.matrix)),
        "the turn through theta about a1 = b1",
        "law",
        label="C_BA",
        states=["001:E6"],
    )
    turns = (
        (omega("A", "I"), expr(PSI_DOT) * A3, "A turns about a3", "omega-A"),
        (omega("B", "A"), expr(THETA_DOT) * B1, "B turns about b1", "omega-B"),
        (omega("C", "B"), expr(OMEGA) * B2, "the body turns about b2", "omega-C"),
    )
    laws = []
    for left, right, reason, label in turns:
        states = ["001:E7"] if label == "omega-C" else []
        laws.append(d.law(Equation(left, right), reason, label=label, states=states).equation)
    added = d.law(
        Equation(omega("B"), add(omega("A", "I"), omega("B", "A"))), "angular velocities add"
    )
    named = added.then(
        "by the turns", *(use(law) for law in laws), label="omega-BI", states=["001:E7"]
    )
    in_B = [
        d.law(Equation(column(v, "B"), entries(e)), "an axis in B").equation
        for v, e in (
            (A3, body.C_BA.matrix * sp.Matrix([0, 0, 1])),
            (B1, sp.Matrix([1, 0, 0])),
            (B2, sp.Matrix([0, 1, 0])),
        )
    ]
    _written(d, named.equation, in_B, body.omega_BI.column, "omega-BI-columns", ["001:E7"])
    total = d.law(
        Equation(omega("C"), add(omega("B"), omega("C", "B"))), "the body's own angular velocity"
    )
    both = total.then("by the turns", use(named.equation), use(laws[2]), label="omega-CI")
    _written(d, both.equation, in_B, body.omega_CI.column, "omega-CI-columns", [])


def _written(
    d: Derivation,
    equation: Equation,
    axes: list[Equation],
    result: sp.Matrix,
    label: str,
    states: list[str],
) -> None:
    """Take components in B and check that they are those of the derived body."""
    left = column(equation.left, "B")
    d.start(left).then(
        "components in B",
        use(equation),
        components("B"),
        *(use(a) for a in axes),
        compute(),
        label=label,
        states=states,
    )
    d.check(Equation(left, entries(result)), "the equations of motion have the same")


def _momentum(d: Derivation, body: SpinningSymmetricBody) -> None:
    for symbol, axis, words in (
        (I1, B1, "moment of inertia about b1, and about b3"),
        (I2, B2, "moment of inertia about the axle b2"),
    ):
        d.name_scalar(symbol, dot(axis, dot(J, axis)), words)
    eigen = [
        d.given(
            Equation(dot(J, b), mul(expr(moment), b)),
            f"b{k} is a principal axis"
            + ("; the moments across the axle are equal" if k == 3 else ""),
            label=f"principal-axis-{k}",
        ).equation
        for k, (b, moment) in enumerate(((B1, I1), (B2, I2), (B3, I1)), 1)
    ]
    J_B = d.start(column(J, "B")).then(
        "the body is symmetric about b2: its inertia in B does not depend on the spin angle",
        by_axes("B"),
        *(use(e) for e in eigen),
        distribute,
        orthonormal("B"),
        compute(),
        label="J",
    )
    d.check(Equation(column(J, "B"), entries(body.inertia)), "the library has the same")
    J_B.both("and is constant there", der, compute(), label="J-constant")
    momentum = d.law(Equation(H, dot(J, omega("C"))), "momentum of a rigid body", label="momentum")
    columns = d.in_components(
        momentum, "B", "components in B", label="h-columns", states=["001:E8"]
    )
    columns.then(
        "by components",
        use(J_B.equation),
        use(d.recall("omega-CI-columns").equation),
        compute(),
        label="h",
        states=["001:E8"],
    )
    d.check(Equation(column(H, "B"), entries(body.h_G.column)), "the equations have the same")


def _momentum_rate(d: Derivation, body: SpinningSymmetricBody) -> None:
    seen = d.start(der(H)).then("the transport theorem, with omega of B", transport("B"))
    columns = d.in_components(
        seen, "B", "components in B", label="rate-columns", states=["001:E10"]
    )
    columns.then(
        "by components",
        use(d.recall("h").equation),
        use(d.recall("omega-BI-columns").equation),
        compute(spinning.RATES),
        label="rate-raw",
    )
    total = body.momentum_rate.total.map(sp.expand)
    d.recall("rate-raw").then(
        "multiplied out; row 2 holds I2 dOmega/dt, which the lecture leaves out",
        entrywise(sp.expand),
        label="rate",
        states=["001:E11"],
    )
    d.check(Equation(column(der(H), "B"), entries(total.column)), "the library has the same")
    d.start(column(cross(omega("B"), H), "B")).then(
        "the product of omega with h, by components",
        components("B"),
        use(d.recall("h").equation),
        use(d.recall("omega-BI-columns").equation),
        compute(),
        entrywise(sp.expand),
        label="cross-columns",
    ).infer(
        "row 2: omega x h has no component along the axle, as the body is symmetric",
        along_axis("B", 2),
        label="no-axle-term",
        states=["001:E12"],
    )


def _motion(d: Derivation, body: SpinningSymmetricBody) -> None:
    d.name_scalar(
        AXLE, expr(body.spin), "angular velocity of the body about its axle", label="spin"
    )
    d.only("spin_312", "newton_2", "third_law_strong")
    law = d.law(Equation(der(H), TORQUE), "the torque about the centre of mass", label="law")
    rows = [
        d.recall("rate")
        .infer(f"row {k} of the rate of h", along_axis("B", k), label=f"rate-{k}")
        .both(f"which is the torque about b{k}", use(law.equation), label=f"row-{k}-torque")
        for k in (1, 2, 3)
    ]
    _axle(d, rows[1])
    _solved(d, body, rows)


def _axle(d: Derivation, row: Chain) -> None:
    """Derive that the axle's own angular velocity is constant without torque about it."""
    own = d.start(der(expr(AXLE))).then(
        "the rate of the axle's own angular velocity",
        put_in(d.recall("spin").equation),
        compute(spinning.RATES),
        label="spin-rate",
    )
    along = d.show(
        Equation(dot(B2, TORQUE), expr(I2) * der(expr(AXLE))),
        "row 2: only the axle's own angular velocity counts",
        use(row.equation),
        use(own.equation),
        label="row-2",
    )
    d.assume("no_torque_2")
    quiet = d.given(Equation(dot(B2, TORQUE), number(0)), "no torque about the axle")
    along.both("put into row 2", use(quiet.equation), label="row-2-free").infer(
        "divided by the moment: Omega + psi' sin theta is constant",
        solved(der(expr(AXLE))),
        label="first-integral",
    )


def _solved(d: Derivation, body: SpinningSymmetricBody, rows: list[Chain]) -> None:
    """Solve both other rows for the accelerations of the angles."""
    M1 = body.parameters[0].symbol
    d.name_scalar(M1, -dot(B1, TORQUE), "torque about -b1", label="M1")
    theta, psi = body.accelerations
    own_spin = d.recall("spin").infer("solved for Omega", solved(expr(OMEGA)), label="Omega")
    with_spin = put_in(own_spin.equation)
    torque = d.recall("M1").infer("the torque about b1", solved(dot(B1, TORQUE)), label="torque-1")
    first = rows[0].both("with the torque -M_1", use(torque.equation), with_spin, label="row-1")
    first.infer(
        "row 1, solved for the tilt",
        solved(expr(THETA_DDOT), ONE_FRACTION),
        label="theta-equation",
        states=["001:E13"],
    )
    d.check(Equation(expr(THETA_DDOT), expr(theta)), "the library has the same")
    d.assume("no_torque_3")
    free = d.given(Equation(dot(B3, TORQUE), number(0)), "no torque about b3")
    rows[2].both(
        "put into row 3, with Omega by C", use(free.equation), with_spin, label="row-3"
    ).infer(
        "row 3, solved for the precession",
        solved(expr(PSI_DDOT), ONE_FRACTION),
        label="psi-equation",
        states=["001:E14"],
    )
    d.check(Equation(expr(PSI_DDOT), expr(psi)), "the library has the same")
