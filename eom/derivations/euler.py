"""Euler's equations of a rigid body: dyadic, matrix, principal (000; 001; 002: 3.26-3.27, 3.36)."""

from __future__ import annotations

import sympy as sp

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.derivations.rotation import explicit
from eom.exact.algebra import gather
from eom.kinematics.coordinates import attitude
from eom.mechanics.rigidbody import OMEGA, principal_inertia, rigid_body
from eom.mechanics.torques import applied
from eom.quantities import Quantity
from eom.system import System
from eom.terms.rules import (
    apply,
    compute,
    differentiate,
    distribute,
    parallel,
    put,
    transport,
    use,
    vanish,
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
    tilde,
    zero,
)
from eom.terms.vocabulary import omega, quantity, unit

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
    momentum = d.state(
        Equation(H, dot(J, W)), "momentum of a rigid body", label="momentum", states=["000:E20"]
    )
    d.law(Equation(der(J, "B"), zero("dyadic")), "J does not change in B", label="J-constant")
    local = momentum.both(
        "differentiate in B",
        lambda t: der(t, "B"),
        differentiate,
        label="local-terms",
        states=["000:E21"],
    ).then(
        "J does not change in B", vanish(der(J, "B")), distribute, label="local", states=["000:E21"]
    )
    d.start(der(W)).then(
        "the transport theorem", transport("B"), label="omega-rate", states=["000:E22"]
    ).then("omega x omega = 0", parallel, distribute, label="omega-rates-equal")
    d.state(seen.equation, "dh/dt by the transport theorem").then(
        "with h = J.omega",
        use(local.equation),
        use(momentum.equation),
        label="rate-dyadic",
        states=["001:E1"],
    ).both("dh/dt is the torque", use(law.equation)).turned(
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
    )
    rotation = matmul(tilde(W_B), matmul(J_B, W_B))
    d.state(
        Equation(matmul(J_B, der(W_B)), add(-rotation, TORQUE_B)),
        "solved for the rates",
        label="euler-rates",
        states=["000:E23", "000:E24"],
    )


def _principal(d: Derivation) -> None:
    d.only(*FREE, "principal_axes")
    matrix, moments = principal_inertia()
    for k, q in enumerate(moments, 1):
        axis = unit("B", k)
        d.name_scalar(q.symbol, dot(axis, dot(J, axis)), q.meaning)
    diagonal = Equation(J_B, entries(matrix))
    d.state(diagonal, "in principal axes J is diagonal", label="J-principal", states=["000:E18"])
    rates = explicit(d, W, "omega", "B", "component of omega along b{k}")
    torque = explicit(d, TORQUE, "tau", "B", "component of the torque along b{k}")
    known = dict(zip(OMEGA.components, OMEGA_DOT, strict=True))
    for symbol, rate in known.items():
        d.name_scalar(rate, der(expr(symbol)), f"rate of {symbol}")
    by_components = (put(J_B, entries(matrix)), use(rates), use(torque), compute(known))
    written = d.recall("euler-matrix").both(
        "by components", lambda t: apply(by_components, t), label="euler-principal"
    )
    ids = (
        ("000:E25", "001:E3", "002:E37"),
        ("000:E25", "001:E4", "002:E38"),
        ("000:E25", "001:E5", "002:E39"),
    )
    system = principal_system()
    for k, (entry, states) in enumerate(zip(written.equation.left.args, ids, strict=True)):
        tidy = gather(entry.data[0], (*OMEGA.components, *OMEGA_DOT))
        d.state(
            Equation(expr(tidy), expr(TAU[k])),
            f"row {k + 1}",
            label=f"euler-{k + 1}",
            states=states,
        )
        d.state(
            Equation(expr(OMEGA_DOT[k]), expr(system.rates[k])),
            "solved for the rate: the equations of motion",
            label=f"rate-{k + 1}",
        )


def _where_valid(d: Derivation) -> None:
    """The same about a point that is fixed both in the body and in space: a pivot."""
    pivot = ("body_frame", "newton_2", "third_law_strong", "O_fixed_in_body", "O_fixed_in_space")
    d.only(*pivot)
    inertia, torque = quantity("inertia", "O"), quantity("torque", "body", "O")
    d.state(
        Equation(add(dot(inertia, der(W, "B")), cross(W, dot(inertia, W))), torque),
        "the same about a pivot, fixed in the body and in space",
        label="euler-pivot",
        states=["000:C1"],
    )
    d.only("body_frame", "newton_2", "third_law_strong", "O_fixed_in_body")
    first = quantity("first_moment", "body", "O")
    carried = cross(first, der(quantity("position", "O", "OI"), times=2))
    d.state(
        Equation(add(dot(inertia, der(W, "B")), cross(W, dot(inertia, W)), carried), torque),
        "about any point of the body, its acceleration counts",
        label="euler-any-point",
        states=["000:C1"],
    )
